"""Infills of a frame after an analysis, and a check of the columns beside them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._files import data_frame
from rbsdem.model.frame import FrameMember
from rbsdem.run.frame_result import FrameResult

if TYPE_CHECKING:
    from pandas import DataFrame

#: What is said of the check.
CHECK_NOTE = (
    "A check, not a prediction: the largest horizontal force of the struts of an infill over the "
    "shear strength that the weaker column beside it has in the model. The struts act at the "
    "nodes, and the columns of the model do not feel that force; tests were not told apart by it."
)


def infills(result: FrameResult) -> DataFrame:
    """Return a table of the infills of a frame.

    Parameters
    ----------
    result : FrameResult
        The response of a frame with infills (`Frame.grid`).

    Returns
    -------
    DataFrame
        Bay and storey, the strength V of the panel, the largest horizontal force of its struts,
        their share of the storey shear in that row, and the furthest of "cracking", "cap" and
        "residual". The last three columns are a check of the columns beside it by hand
        (`CHECK_NOTE`): the column of the less shear strength, that strength (NaN where a column
        has no shear spring with one), and the force over it.
    """
    frame = result.frame
    reached: dict[str, list[str]] = {}
    for event in result.events:
        if event.group == "infill":
            reached.setdefault(event.member, []).append(event.name)
    rows: list[dict[str, Any]] = []
    for infill in frame.infilled:
        at = [frame.parts.members.index(name) for name in infill.struts]
        # The strut that rises to the right is pressed by a push to the left.
        forces = infill.slope * (result.member_axial[:, at] @ np.array([-1.0, 1.0]))
        row = int(np.abs(forces).argmax())
        shear = float(result.storey_shear[row, infill.storey - 1])
        states = [name for strut in infill.struts for name in reached.get(strut, ())]
        order = ("residual", "cap", "cracking")
        sides = [f"C-{line}-{infill.storey}" for line in (infill.bay, infill.bay + 1)]
        strengths = [_shear_strength(frame.kinds[name]) for name in sides]
        weaker = int(np.nanargmin(strengths)) if not np.isnan(strengths).all() else 0
        largest = abs(float(forces[row]))
        rows.append({
            "bay": infill.bay,
            "storey": infill.storey,
            "strength_N": infill.force,
            "largest_force_N": largest,
            "share_of_storey_shear": float(forces[row]) / shear if shear else np.nan,
            "state": next((name for name in order if name in states), ""),
            "check_column": sides[weaker],
            "check_shear_strength_N": strengths[weaker],
            "check_ratio": largest / strengths[weaker],
        })  # fmt: skip
    return data_frame(rows)


def _shear_strength(kind: FrameMember) -> float:
    """Return the largest force of the weakest shear spring of a column; NaN without one [N]."""
    springs = [spring for _, spring in kind._springs("shear")]
    return min((float(getattr(spring, "f_cap", np.nan)) for spring in springs), default=np.nan)
