"""A response as table, as csv, as Dataset, and as one file that describes itself."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import atomic_write
from rbsdem._types import Array, DataFrame
from rbsdem.errors import InputError
from rbsdem.model.response import STATE_HEAD, Ended, Response, last_state

FORMAT = "rbsdem result"
FORMAT_VERSION = 1


def quantities(result: Response) -> dict[str, Array]:
    """Return the arrays of a result in the order of the executable's csv, joints as columns."""
    known = result.energy | {"step": result.time, "top_height": result.top[:, 1]}
    if result.motion is not None:
        known["ground_acceleration"] = result.motion[:, 2]
    return {
        name: known[name] if name in known else getattr(result, name) for name in result.channels
    }


def columns(result: Response) -> dict[str, Array]:
    """Return the columns of the csv: one for each value, with its unit in its name."""
    found = {}
    for name, values in quantities(result).items():
        unit = f"_{_core.units()[name]}".replace(" ", "").rstrip("_")
        if values.ndim == 1:
            found[name + unit] = values
        else:
            for at, joint in enumerate(result.column.joint_numbers):
                found[f"{name}_{joint}{unit}"] = values[:, at]
    return found


def to_pandas(result: Response) -> DataFrame:
    """Return a DataFrame with the columns of the csv."""
    import pandas  # noqa: PLC0415

    frame = pandas.DataFrame(columns(result))
    frame.attrs["summary"] = dict(result.summary)
    return frame


def to_csv(result: Response, path: str | os.PathLike[str]) -> None:
    """Write the columns with all digits, and the head of the executable's csv."""
    table = columns(result)
    about = result.summary
    title = result.case.title if result.case is not None else ""
    head = [
        f"# rbsdem {_core.version()}",
        f"# case: {title}".rstrip(),
        f"# units: SI, in the names of the columns; method: {about['method']}, "
        f"kinematics: {about['kinematics']}",
        ",".join(table),
    ]
    with atomic_write(path) as file:
        file.write(("\n".join(head) + "\n").encode())
        np.savetxt(file, np.column_stack(list(table.values())), fmt="%.17g", delimiter=",")


def save_state(result: Ended, path: str | os.PathLike[str]) -> None:
    """Write a state as text: a head, then one number a line, whole or not at all."""
    state = last_state(result)
    head = f"{STATE_HEAD}\n# version: {_core.version()}\n{state.size}\n"
    with atomic_write(path) as file:
        file.write((head + "\n".join(map(_text, state)) + "\n").encode())


def _text(number: float) -> str:
    """Return a number as the executable writes it: all digits, three for the exponent."""
    digits, _, exponent = f"{number:.16E}".partition("E")
    return f"{digits}E{int(exponent):+04d}"


def save(result: Any, path: str | os.PathLike[str]) -> None:
    """Write a result as npz, whole or not at all."""
    check_ending(path)
    about, arrays = _parts(result)
    with atomic_write(path) as file:
        np.savez_compressed(file, about=np.array(json.dumps(about)), **arrays)


def check_ending(path: str | os.PathLike[str]) -> None:
    """Raise `InputError` if the name is not that of a saved result."""
    if _arguments.path(path).suffix.lower() != ".npz":
        raise InputError(f"{os.fspath(path)}: the name of a saved result ends in .npz")


def _parts(result: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return what is written as text, and the arrays by name."""
    arrays: dict[str, Any] = {}
    about: dict[str, Any] = {"format": FORMAT, "format_version": FORMAT_VERSION}
    about |= {"version": _core.version(), "units": _core.units()}
    about |= {
        "column": result.column.to_namelist(),
        "summary": result.summary,
        "arrays": {},
        "case": None,
    }
    for field in fields(result):
        value = getattr(result, field.name)
        if isinstance(value, np.ndarray) or (value is None and field.name != "case"):
            about["arrays"][field.name] = value is not None
            arrays |= {} if value is None else {field.name: value}
        elif field.name in ("energy", "springs", "call", "channels"):
            about[field.name] = _apart(field.name, value, arrays)
        elif field.name == "case" and value is not None:
            about["case"] = value.to_namelist()
    return about, arrays


def _apart(name: str, value: Any, arrays: dict[str, Any]) -> Any:
    """Return a value for json; arrays in it are put aside under their names."""
    if isinstance(value, Mapping):
        return {key: _apart(f"{name}/{key}", each, arrays) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    return value.item() if isinstance(value, np.generic) else value
