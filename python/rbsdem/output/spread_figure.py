"""Figure of a predicted path with its band, and of a test over it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._views import view_of
from rbsdem.output.style import MODEL_LINE, TEST_LINE, axes_or_new, line_of
from rbsdem.section.spread import Spread

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_spread"]

_MEDIAN_LINE = {"color": "0.45", "linestyle": ":", "linewidth": 0.8, "zorder": 2}


@view_of(Spread, "plot")
def draw_spread(found: Spread, test: Any = None, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw forces over the path of displacement; see `Spread.plot`."""
    path = 1e3 * np.concatenate(([0.0], np.cumsum(np.abs(np.diff(found.displacement)))))
    measured = None if test is None else found.rows_of(test)
    with axes_or_new(ax, (6.0, 2.8)) as drawn:
        drawn.fill_between(
            path, found.lower / 1e3, found.upper / 1e3, color="0.86", lw=0, label="80 % band"
        )
        model = line_of({**MODEL_LINE, "label": "Prediction"}, line)
        drawn.plot(path, found.force / 1e3, **model)
        drawn.plot(path, found.median / 1e3, **_MEDIAN_LINE, label="Median of the samples")
        if measured is not None:
            drawn.plot(path, measured / 1e3, **{**TEST_LINE, "label": "Test"})
        drawn.set_xlabel("Path of displacement (mm)")
        drawn.set_ylabel("Force (kN)")
        drawn.margins(x=0.01)
        # Above the axes: the band fills them.
        drawn.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
        return drawn
