"""Texts that leave the page and come back: case files, csv.

A case file has the groups of the page, with the values of a record in place of its name. One that
comes back is drawn again; a column whose springs are none that are drawn stays a text.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._package import unwarned
from rbsdem.errors import InputError
from rbsdem.motions.motion import GroundMotion
from rbsdem.run.case import Case, case_of_text, groups_of_text
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.frame_result import FrameResult
from rbsdem.section.frame import Frame
from rbsdem.web.state import (
    Faults,
    Group,
    completed,
    first,
    refuse_files,
    text_of,
)

#: Groups of springs, which are made again where they are those of the drawing.
_SPRINGS = ("shear", "flexure", "axial_spring", "layer_spring", "layers")
#: Keys of a column and of its drawing that are made with its springs.
_MADE = {
    "column": ("n", "mass", "lengths", "depth", "rotary_inertia", "kinematics", "model"),
    "drawing": ("height", "axial_load", "n"),
}


def namelist(case: Any, records: Mapping[str, GroundMotion]) -> str:
    """Return a case of the page as the text of a case file."""
    return case if isinstance(case, str) else text_of(completed(case), records, Faults(case))


def opened(text: object, keep: Callable[[GroundMotion, str], str]) -> dict[str, Any]:
    """Return the state of the text of a case file.

    Parameters
    ----------
    text : str
        The text.
    keep : callable
        Keeps a record that is in it, and returns its name.
    """
    try:
        if not isinstance(text, str):
            raise InputError("case: give the text of a case file")
        refuse_files(text)
        with unwarned(Warning):
            # Notes on it stand beside its loop.
            case = case_of_text(text)
            groups = _drawn_again(groups_of_text(text), case)
    except InputError as error:
        return {"faults": [{"field": "", "text": str(error)}]}
    if groups is None:
        return {"state": {"cases": [text]}}
    for name, values in groups:
        if name == "loading" and not _keep_record(values, keep):
            return {"state": {"cases": [text]}}
    return {"state": {"cases": [[list(one) for one in groups]]}}


def _keep_record(values: dict[str, Any], keep: Callable[[GroundMotion, str], str]) -> bool:
    """Put the name of a record in place of its values; return whether the page can show it."""
    values.pop("source", None)
    if values.get("drive") != "ground_acceleration":
        return values.get("drive") == "displacement"
    steps = np.diff(values.pop("time", [0.0, values.get("interval", 0.0)]))
    if "values" not in values or values.get("unit", "m/s2") != "m/s2":
        return False
    if not steps[0] > 0.0 or not np.allclose(steps, steps[0], rtol=1e-6, atol=0.0):
        return False
    motion = GroundMotion(np.array(values.pop("values")), float(steps[0]))
    values.pop("interval", None)
    values["file"] = keep(motion, "record of the file")
    return True


def _drawn_again(groups: list[Group], case: Case) -> list[Group] | None:
    """Return the groups that the page draws; None for a column that is not as it would be drawn."""
    static = ("analysis", {"method": "static"})
    groups = [one for one in groups if one != static and one[0] != "units"]
    if isinstance(case.column, Frame):
        return groups if first(groups, "frame").get("storeys") else None
    if not first(groups, "drawing") or sum(name == "loading" for name, _ in groups) != 1:
        return None
    made: list[Group] = []
    for name, values in groups:
        if name not in _SPRINGS or values.get("joint") in (0, [0]):
            own = {key: one for key, one in values.items() if key not in _MADE.get(name, ())}
            made.append((name, {"top": "free"} | own if name == "column" else own))
    try:
        again = case_of_text(text_of(made, {}, Faults(made)))
    except InputError:
        return None
    return made if again.column == case.column else None


def csv_of(result: ColumnResult | FrameResult) -> str:
    """Return the rows of a result as the executable writes them."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        rows = Path(folder) / "rows.csv"
        result.to_csv(rows)
        return rows.read_text(encoding="utf-8")
