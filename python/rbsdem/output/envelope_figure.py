"""An envelope as a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from rbsdem import plot
from rbsdem._views import view_of
from rbsdem.curves.envelope import Envelope

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rbsdem.curves.idealise import Method


@view_of(Envelope, "plot")
def draw(envelope: Envelope, ax: Axes | None, method: Method | None) -> Axes:
    """Draw an envelope in mm and kN, and its two lines dashed."""
    with plot.axes_or_new(ax) as drawn:
        x, y = envelope.displacement * 1e3, envelope.force * 1e-3
        drawn.plot(x, y, **plot.MODEL_LINE)
        if method is not None:
            lines = envelope.idealise(method)
            corners = np.array([0.0, lines.yield_displacement, lines.end_displacement])
            drawn.plot(
                corners * 1e3, lines.force(corners) * 1e-3, **plot.TEST_LINE, label=lines.source
            )
            drawn.plot(
                lines.yield_displacement * 1e3,
                lines.yield_force * 1e-3,
                **{**plot.TEST_POINTS, "color": "black"},
            )
            drawn.legend(loc="lower right")
        drawn.set_xlim(left=0.0, auto=True)
        drawn.set_ylim(bottom=0.0, auto=True)
        drawn.set_xlabel("Top displacement (mm)")
        drawn.set_ylabel("Lateral force (kN)")
    return drawn
