"""A result in one file that describes itself, and back bit for bit."""

from __future__ import annotations

import json
import os
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import whole_file
from rbsdem._optional import need_xarray
from rbsdem._views import view_of
from rbsdem.errors import InputError
from rbsdem.model.column import Column, without_notes
from rbsdem.result import Result
from rbsdem.solve.case import Case, read_case

__all__ = ["load"]

_FORMAT = "rbsdem result"
_FORMAT_VERSION = 1

# What makes a column's text a whole case.
_LOADING = "&loading drive = 'force', values = 0, 0 /\n"


@view_of(Result, "save")
def save(result: Result, path: str | os.PathLike[str]) -> None:
    """Write a result as npz or netCDF, whole or not at all."""
    kind = _kind(path)
    about, arrays = _parts(result)
    if kind == ".npz":
        with whole_file(path) as file:
            np.savez_compressed(file, about=np.array(json.dumps(about)), **arrays)
        return
    xarray = need_xarray()
    variables = {
        # Slashes part groups in netCDF.
        name.replace("/", ":"): ([f"{name}_{axis}" for axis in range(values.ndim)], values)
        for name, values in arrays.items()
    }
    dataset = xarray.Dataset(
        {name.replace("/", ":"): value for name, value in variables.items()},
        attrs={"about": json.dumps(about), "units": json.dumps(_core.units())},
    )
    for name, variable in dataset.variables.items():
        if name in _core.units():
            variable.attrs["units"] = _core.units()[name]
    with whole_file(path) as file:
        file.write(bytes(dataset.to_netcdf(engine="scipy")))


def load(path: str | os.PathLike[str]) -> Result:
    """Read a result that `Result.save` wrote.

    Parameters
    ----------
    path : path
        The file, ``.npz`` or ``.nc``.

    Returns
    -------
    Result
        Equal to the one that was saved, bit for bit.

    Raises
    ------
    InputError
        If the file is not there, is none of these, is damaged, or was written by a later version.
    """
    kind = _kind(path)
    if not Path(path).is_file():
        raise InputError(f"{os.fspath(path)}: there is no such file; check the path")
    try:
        about, arrays = _read_npz(path) if kind == ".npz" else _read_netcdf(path)
        known = about["format"] == _FORMAT
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, EOFError) as error:
        raise InputError(
            f"{os.fspath(path)}: this is no saved result, or it is damaged ({error}); "
            "Result.save writes one"
        ) from error
    if not known:
        raise InputError(f"{os.fspath(path)}: this is no saved result; Result.save writes one")
    if about["format_version"] > _FORMAT_VERSION:
        raise InputError(
            f"{os.fspath(path)}: written by rbsdem {about['version']} in a later format; "
            f"this is rbsdem {_core.version()}, so update it"
        )
    try:
        return _result(about, arrays)
    except (KeyError, TypeError) as error:
        raise InputError(f"{os.fspath(path)}: the file is damaged; {error} is missing") from error


def _kind(path: str | os.PathLike[str]) -> str:
    kind = _arguments.path(path).suffix.lower()
    if kind not in (".npz", ".nc"):
        raise InputError(
            f"{os.fspath(path)}: the name of a saved result ends in .npz (numpy) or .nc (netCDF)"
        )
    return kind


def _parts(result: Result) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what is written as text, and the arrays by name."""
    arrays: dict[str, Any] = {}
    call = _apart("call", result.call, arrays)
    for field in fields(result):
        value = getattr(result, field.name)
        if isinstance(value, np.ndarray):
            arrays[field.name] = value
    arrays |= {f"energy/{name}": value for name, value in result.energy.items()}
    about = {
        "format": _FORMAT,
        "format_version": _FORMAT_VERSION,
        "version": _core.version(),
        "units": _core.units(),
        "channels": result.channels,
        "column": result.column.to_namelist(),
        "case": None if result.case is None else result.case.to_namelist(),
        "summary": result.summary,
        "call": call,
    }
    return about, arrays


def _apart(name: str, value: Any, arrays: dict[str, Any]) -> Any:
    """Return a value for json; arrays in it are put aside under their names."""
    if isinstance(value, Mapping):
        return {key: _apart(f"{name}/{key}", each, arrays) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    return value.item() if isinstance(value, np.generic) else value


def _together(value: Any, arrays: dict[str, Any]) -> Any:
    """Return the value that `_apart` took apart."""
    if not isinstance(value, dict):
        return value
    if set(value) == {"array"}:
        return arrays[value["array"]]
    return {key: _together(each, arrays) for key, each in value.items()}


def _read_npz(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    with open(path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    about: dict[str, Any] = json.loads(str(arrays.pop("about")))
    return about, arrays


def _read_netcdf(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    with need_xarray().open_dataset(path, engine="scipy", mask_and_scale=False) as dataset:
        arrays = {
            str(name).replace(":", "/"): np.array(variable.values, dtype=np.float64)
            for name, variable in dataset.variables.items()
        }
        about: dict[str, Any] = json.loads(dataset.attrs["about"])
    return about, arrays


def _result(about: dict[str, Any], arrays: dict[str, Any]) -> Result:
    energy = {
        name.partition("/")[2]: values
        for name, values in arrays.items()
        if name.startswith("energy/")
    }
    own = {field.name: arrays[field.name] for field in fields(Result) if field.name in arrays}
    with without_notes():
        column: Column = _case(about["column"] + _LOADING).column
        case = None if about["case"] is None else _case(about["case"])
    return Result(
        **{
            "axial_force": None,
            "rest": None,
            "state": None,
            "motion": None,
            "reached": None,
            **own,
        },
        energy=energy,
        summary=about["summary"],
        column=column,
        call=_together(about["call"], arrays),
        channels=tuple(about["channels"]),
        case=case,
    )


def _case(text: str) -> Case:
    """Return the case of a text; the reader of the program reads files."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "case.nml"
        with whole_file(path) as file:
            file.write(text.encode())
        return read_case(path)
