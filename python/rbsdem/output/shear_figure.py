"""Figure of a shear diagram with its knee, and the spring through it (the paper's figure 2, left).

In the style of `rbsdem.plot`; kN and mm/m.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._views import view_of
from rbsdem.output.section_figure import EVENT_MARKS
from rbsdem.output.style import MODEL_LINE, TEST_LINE, axes_or_new, line_of
from rbsdem.section.shear_diagram import ShearDiagram

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rbsdem.section.shear_spring import ShearSpring

__all__ = ["draw_shear"]


@view_of(ShearDiagram, "plot")
def draw_shear(
    diagram: ShearDiagram,
    ax: Axes | None = None,
    *,
    spring: ShearSpring | None = None,
    **line: Any,
) -> Axes:
    """Draw shear force against shear strain; see `ShearDiagram.plot`."""
    with axes_or_new(ax, (3.5, 2.8)) as drawn:
        strain = 1e3 * np.concatenate([[0.0], diagram.strain])
        force = np.concatenate([[0.0], diagram.force]) / 1e3
        drawn.plot(strain, force, **line_of({**MODEL_LINE, "label": "Section"}, line))
        marks = {"yielding": diagram.knee, "ultimate": diagram.end}
        if spring is not None:
            marks = {"yielding": spring.knee, "ultimate": spring.end}
            points = [(0.0, 0.0)] + [(p.strain, p.force) for p in (spring.knee, spring.end)]
            x, y = np.array(points).T
            drawn.plot(1e3 * x, y / 1e3, **TEST_LINE, label="Spring")
            # A strength far above the diagram would only flatten it.
            if spring.strength < 1.3e3 * force.max():
                drawn.axhline(spring.strength / 1e3, color="0.75", linewidth=0.6, label="$V_n$")
        for name, label in (("yielding", "Knee"), ("ultimate", "End")):
            point = marks[name]
            if point is not None:
                drawn.plot(
                    1e3 * point.strain,
                    point.force / 1e3,
                    linestyle="none",
                    color="black",
                    markersize=4.5,
                    markeredgewidth=0.8,
                    zorder=5,
                    label=label,
                    **EVENT_MARKS[name],
                )
        drawn.set_xlim(0.0, 1.08 * strain.max())
        drawn.set_ylim(bottom=0.0)
        drawn.set_xlabel("Shear strain (mm/m)")
        drawn.set_ylabel("Shear force (kN)")
        drawn.tick_params(right=True, top=True)
        drawn.legend(loc="lower right", handletextpad=0.5)
    return drawn
