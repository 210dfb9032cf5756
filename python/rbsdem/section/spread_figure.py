"""Figure of a predicted path with its band, and of a test over it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._views import view_of
from rbsdem.plot import MODEL_LINE, TEST_LINE, axes_or_new, line_of
from rbsdem.section.spread import Spread

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_spread"]


@view_of(Spread, "plot")
def draw_spread(found: Spread, test: Any = None, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw forces over the path of displacement; see `Spread.plot`."""
    path = 1e3 * np.concatenate(([0.0], np.cumsum(np.abs(np.diff(found.displacement)))))
    with axes_or_new(ax, (6.0, 2.8)) as drawn:
        drawn.fill_between(
            path, found.lower / 1e3, found.upper / 1e3, color="0.85", lw=0, label="80 % band"
        )
        model = line_of({**MODEL_LINE, "label": "Prediction"}, line)
        drawn.plot(path, found.force / 1e3, **model)
        if test is not None:
            drawn.plot(path, np.asarray(test.force) / 1e3, **{**TEST_LINE, "label": "Test"})
        drawn.set_xlabel("Path of displacement (mm)")
        drawn.set_ylabel("Force (kN)")
        drawn.legend()
        return drawn
