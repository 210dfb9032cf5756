"""Limit states marked on a loop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rbsdem import plot
from rbsdem._views import view_of
from rbsdem.checks.limit_states import LimitStates

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARKERS = "os^Dv<>phX*P8"


@view_of(LimitStates, "plot")
def draw(states: LimitStates, ax: Axes | None) -> Axes:
    """Draw the loop thin and gray, and a marker for each state."""
    result = states.result
    with plot.axes_or_new(ax, (4.6, 3.4)) as drawn:
        plot.loop(result, height=result.column.height, ax=drawn, color="0.55", linewidth=0.6)
        for state, marker in zip(states, _MARKERS, strict=False):
            drawn.plot(
                1e3 * state.displacement,
                1e-3 * state.force,
                linestyle="none",
                marker=marker,
                markersize=5.0,
                markerfacecolor="white",
                markeredgecolor="black",
                markeredgewidth=0.9,
                zorder=5,
                label=state.name.replace("_", " "),
            )
        if len(states):
            drawn.legend(loc="upper left", fontsize=6.5, handletextpad=0.2, borderaxespad=0.3)
    return drawn
