"""An interaction diagram as a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

import numpy as np
from numpy.typing import ArrayLike

from rbsdem._views import view_of
from rbsdem.errors import InputError
from rbsdem.output.style import MODEL_LINE, TEST_LINE, TEST_POINTS, ZERO_LINE, axes_or_new
from rbsdem.section.interaction import Code, InteractionDiagram

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_NAMES = {
    "aci318": "ACI 318-19, nominal",
    "ec2": "EN 1992-1-1, nominal",
    "joint": "joint of the model",
    None: "own laws of the section",
}


@view_of(InteractionDiagram, "plot")
def draw(
    diagram: InteractionDiagram, ax: Axes | None, demand: ArrayLike | None, design: bool
) -> Axes:
    """Draw axial load over moment; see `InteractionDiagram.plot`."""
    marks = None if demand is None else np.atleast_2d(np.asarray(demand, dtype=np.float64))
    if marks is not None and marks.shape[1] != 2:
        raise InputError(
            f"demand has shape {marks.shape}; give a row for each demand: axial load [N], "
            "moment [N m]"
        )
    with axes_or_new(ax, (3.5, 3.4)) as drawn:
        name = _NAMES[diagram.code]
        drawn.plot(diagram.moment / 1e3, diagram.axial_load / 1e3, **MODEL_LINE, label=name)
        if design and diagram.code in get_args(Code):
            drawn.plot(
                diagram.design_moment / 1e3,
                diagram.design_axial_load / 1e3,
                **{**TEST_LINE, "color": "black"},
                label=name.replace("nominal", "design"),
            )
        if marks is not None:
            drawn.plot(np.abs(marks[:, 1]) / 1e3, marks[:, 0] / 1e3, **TEST_POINTS, label="demand")
        drawn.axhline(0.0, **ZERO_LINE)
        drawn.set_xlim(left=0.0, auto=True)
        drawn.set_xlabel("Moment (kN m)")
        drawn.set_ylabel("Axial load (kN), compression positive")
        drawn.tick_params(right=True, top=True)
        drawn.legend(loc="upper right", fontsize=7.5)
    return drawn
