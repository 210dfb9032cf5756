"""A response beside codes and regressions, as a figure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import plot
from rbsdem._arguments import Array
from rbsdem._views import view_of
from rbsdem.checks.code_comparison import CodeComparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Lines of the backbones, told apart in print without colour.
_LINES: dict[str, dict[str, Any]] = {
    "ASCE 41": {"linestyle": "-", "marker": "s"},
    "EC 8-3": {"linestyle": (0, (5, 1.5)), "marker": "o"},
    "Elwood": {"linestyle": (0, (1.2, 1.2)), "marker": "^"},
    "Haselton": {"linestyle": (0, (5, 1.2, 1, 1.2)), "marker": "D"},
}
#: Drifts of damage: row of the table, column of the table, label, fill.
_DAMAGE = (
    ("spalling", "model", "spalling, model", "white"),
    ("spalling", "Berry", "spalling, Berry, Eberhard", "black"),
    ("bar_buckling", "model", "bar buckling, model", "white"),
    ("bar_buckling", "Berry", "bar buckling, Berry, Eberhard", "black"),
    ("bar_buckling", "Goodnight", "bar buckling, Goodnight et al.", "0.6"),
)


@view_of(CodeComparison, "plot")
def draw(found: CodeComparison, ax: Axes | None) -> Axes:
    """Draw loops in gray, backbones in black to the positive side, damage on the axis."""
    result = found.result
    height = result.column.height
    with plot.axes_or_new(ax, (6.2, 3.4)) as drawn:
        if found.test is not None:
            d, f = found.test
            drawn.plot(100 * d / height, 1e-3 * f, **{**plot.TEST_LINE, "label": "test"})
        drift, force = 100 * result.drift, 1e-3 * result.loop_force
        drawn.plot(drift, force, color="0.6", linewidth=0.6, zorder=2.5, label="model")
        for line in found.backbones:
            drawn.plot(
                *_above_zero(100 * line.drift, 1e-3 * line.force(found.span, found.leaning)),
                color="black",
                linewidth=1.0,
                markersize=3.2,
                markerfacecolor="white",
                zorder=4,
                label=line.name,
                **_LINES[line.name],
            )
        for row, source, label, fill in _DAMAGE:
            if source in found[row]:
                drawn.plot(
                    100 * found[row][source],
                    0.0,
                    linestyle="none",
                    marker="v" if row == "spalling" else "P",
                    markersize=6.0,
                    markeredgecolor="black",
                    markerfacecolor=fill,
                    markeredgewidth=0.8,
                    zorder=5,
                    label=label,
                )
        drawn.axhline(0.0, **plot.ZERO_LINE)
        drawn.axvline(0.0, **plot.ZERO_LINE)
        drawn.margins(x=0.03, y=0.06)
        drawn.set_xlabel("Drift ratio (%)")
        drawn.set_ylabel("Base shear (kN)" if result.dynamic else "Lateral force (kN)")
        drawn.tick_params(right=True, top=True)
        drawn.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=7.5, handlelength=3.0)
    return drawn


def _above_zero(drift: Array, force: Array) -> tuple[Array, Array]:
    """Return a backbone up to where second-order moments have used up its strength."""
    below = np.flatnonzero(force < 0)
    if below.size == 0:
        return drift, force
    end = int(below[0])
    share = force[end - 1] / (force[end - 1] - force[end])
    last = drift[end - 1] + share * (drift[end] - drift[end - 1])
    return np.append(drift[:end], last), np.append(force[:end], 0.0)
