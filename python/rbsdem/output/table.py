"""The rows of a result as a table: of pandas, of xarray, as csv."""

from __future__ import annotations

import os
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._arguments import Array
from rbsdem._files import whole_file
from rbsdem._optional import need_pandas, need_xarray
from rbsdem._views import view_of
from rbsdem.result import Result


def quantities(result: Result) -> dict[str, Array]:
    """Return the arrays of a result in the order of the executable's csv, joints as columns."""
    known = result.energy | {"step": result.time, "top_height": result.top[:, 1]}
    if result.motion is not None:
        known["ground_acceleration"] = result.motion[:, 2]
    return {
        name: known[name] if name in known else getattr(result, name) for name in result.channels
    }


def columns(result: Result) -> dict[str, Array]:
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


@view_of(Result, "to_pandas")
def to_pandas(result: Result) -> Any:
    """Return a DataFrame with the columns of the csv."""
    frame = need_pandas().DataFrame(columns(result))
    frame.attrs["summary"] = dict(result.summary)
    return frame


@view_of(Result, "to_xarray")
def to_xarray(result: Result) -> Any:
    """Return a Dataset: rows along time (or step), joints from 1 at the ground."""
    units = {name: {"units": unit} if unit else {} for name, unit in _core.units().items()}
    arrays = quantities(result)
    along = result.channels[0]
    time = arrays.pop(along)
    variables = {
        name: ((along, "joint")[: values.ndim], values, units[name])
        for name, values in arrays.items()
    }
    return need_xarray().Dataset(
        variables,
        {
            along: (along, time, units[along]),
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
