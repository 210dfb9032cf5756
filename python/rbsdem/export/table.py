"""The rows of a result as a table: of pandas, of xarray, as csv."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._core import Array
from rbsdem._files import whole_file
from rbsdem._optional import need_pandas, need_xarray
from rbsdem._views import view_of
from rbsdem.result import ENERGIES, Result

UNITS = {
    "time": "s",
    "displacement": "m",
    "force": "N",
    "top_height": "m",
    "slip": "m",
    "rotation": "rad",
    "opening": "m",
    "shear": "N",
    "moment": "N m",
    "axial_force": "N",
    "base_shear": "N",
    "base_moment": "N m",
    "rest": "rad",
    "velocity": "m/s",
    "acceleration": "m/s2",
    "ground_acceleration": "m/s2",
} | dict.fromkeys(ENERGIES, "J")
"""Units of the arrays of a result."""


def quantities(result: Result) -> dict[str, Array]:
    """Return the arrays of a result in the order of the executable's csv, joints as columns."""
    column = result.column
    known = result.energy | {"top_height": result.top[:, 1]}
    with_openings = result.rest is not None and not column.opens
    with_base = column.damped and result.dynamic
    with_motion = result.motion is not None
    if result.motion is not None:
        known["ground_acceleration"] = result.motion[:, 2]
    found = {}
    for name in _core.quantities(column.opens, with_base, with_openings, with_motion)[0]:
        plain = name.rstrip("*")
        found[plain] = known[plain] if plain in known else getattr(result, plain)
    return found


def columns(result: Result) -> dict[str, Array]:
    """Return the columns of the csv: one for each value, with its unit in its name."""
    found = {}
    for name, values in quantities(result).items():
        unit = UNITS[name].replace(" ", "")
        if name == "time" and not result.dynamic:
            found["step"] = values
        elif values.ndim == 1:
            found[f"{name}_{unit}"] = values
        else:
            for at, joint in enumerate(result.column.joint_numbers):
                found[f"{name}_{joint}_{unit}"] = values[:, at]
    return found


@view_of(Result, "to_pandas")
def to_pandas(result: Result) -> Any:
    """Return a DataFrame with the columns of the csv."""
    frame = need_pandas().DataFrame(columns(result))
    frame.attrs["summary"] = dict(result.summary)
    return frame


@view_of(Result, "to_xarray")
def to_xarray(result: Result) -> Any:
    """Return a Dataset: rows along time (or step), joints from 1 at the ground."""
    along = "time" if result.dynamic else "step"
    arrays = quantities(result)
    time = arrays.pop("time")
    variables = {
        name: ((along, "joint")[: values.ndim], values, {"units": UNITS[name]})
        for name, values in arrays.items()
    }
    return need_xarray().Dataset(
        variables,
        {
            along: (along, time, {"units": "s"} if result.dynamic else {}),
            "joint": np.array(result.column.joint_numbers),
        },
        {"program": "rbsdem", "version": _core.version(), "column": result.column.to_namelist()}
        | {name: value for name, value in result.summary.items() if not isinstance(value, dict)},
    )


@view_of(Result, "to_csv")
def to_csv(result: Result, path: str | os.PathLike[str]) -> None:
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
    with whole_file(path) as file:
        file.write(("\n".join(head) + "\n").encode())
        np.savetxt(file, np.column_stack(list(table.values())), fmt="%.17g", delimiter=",")
