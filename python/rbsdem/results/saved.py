"""Reading back what `Result.save` wrote, bit for bit."""

from __future__ import annotations

import json
import os
import zipfile
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._package import extra
from rbsdem.errors import InputError
from rbsdem.model.column import without_notes
from rbsdem.results.case import case_of_text
from rbsdem.results.files import FORMAT, FORMAT_VERSION, ending_of
from rbsdem.results.result import Result

# What makes a column's text a whole case.
_LOADING = "&loading drive = 'force', values = 0, 0 /\n"


def read_result(path: str | os.PathLike[str]) -> Result:
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
    kind = ending_of(path)
    if not Path(path).is_file():
        raise InputError(f"{os.fspath(path)}: there is no such file; check the path")
    try:
        about, arrays = _read_npz(path) if kind == ".npz" else _read_netcdf(path)
        known = about["format"] == FORMAT
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile, EOFError) as error:
        raise InputError(
            f"{os.fspath(path)}: this is no saved result, or it is damaged ({error}); "
            "Result.save writes one"
        ) from error
    if not known:
        raise InputError(f"{os.fspath(path)}: this is no saved result; Result.save writes one")
    if about["format_version"] > FORMAT_VERSION:
        raise InputError(
            f"{os.fspath(path)}: written by rbsdem {about['version']} in a later format; "
            f"this is rbsdem {_core.version()}, so update it"
        )
    try:
        return _result(about, arrays)
    except (KeyError, TypeError) as error:
        raise InputError(f"{os.fspath(path)}: the file is damaged; {error} is missing") from error


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
    with extra("xarray").open_dataset(path, engine="scipy", mask_and_scale=False) as dataset:
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
        column = case_of_text(about["column"] + _LOADING).column
        case = None if about["case"] is None else case_of_text(about["case"])
    absent = dict.fromkeys(("axial_force", "rest", "state", "motion", "reached"))
    return Result(
        **{**absent, **own},
        energy=energy,
        summary=about["summary"],
        column=column,
        call=_together(about["call"], arrays),
        channels=tuple(about["channels"]),
        case=case,
    )
