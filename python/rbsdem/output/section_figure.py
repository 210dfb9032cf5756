"""Figures of a section: its drawing, and its moment-curvature diagram with the events.

In the style of `rbsdem.plot`; mm, kN m and mrad/m.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._optional import need_matplotlib
from rbsdem._views import view_of
from rbsdem.model.section import Section
from rbsdem.output.style import MODEL_LINE, TEST_LINE, axes_or_new, line_of, style
from rbsdem.section.diagram import Diagram, Events
from rbsdem.section.spring_fit import SectionSprings

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

__all__ = ["EVENT_MARKS", "draw_diagram", "draw_section", "draw_springs"]

EVENT_MARKS: dict[str, dict[str, Any]] = {
    "cracking": {"marker": "o", "markerfacecolor": "white"},
    "yielding": {"marker": "s", "markerfacecolor": "white"},
    "peak": {"marker": "^", "markerfacecolor": "black"},
    "ultimate": {"marker": "D", "markerfacecolor": "black"},
}
"""Markers of the events."""

_CONCRETE = {"facecolor": "0.93", "edgecolor": "black", "linewidth": 0.8}
_TIE = {"facecolor": "0.35", "linewidth": 0.0}
_INSIDE = {"facecolor": "0.93", "linewidth": 0.0}
_BAR = {"facecolor": "black", "edgecolor": "black", "linewidth": 0.0}


@view_of(Diagram, "plot")
def draw_diagram(diagram: Diagram, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw moment against curvature and mark the events; see `Diagram.plot`."""
    with axes_or_new(ax, (3.5, 2.8)) as drawn:
        drawn.plot(1e3 * diagram.curvature, diagram.moment / 1e3, **line_of(MODEL_LINE, line))
        _draw_events(diagram.events, float(diagram.curvature[-1]), drawn)
        _dress(drawn)
        drawn.set_ylim(bottom=min(0.0, float(np.min(diagram.moment)) / 1e3))
    return drawn


def _draw_events(
    events: Events, furthest: float, ax: Axes, names: Iterable[str] = tuple(EVENT_MARKS)
) -> None:
    for name in names:
        point = getattr(events, name)
        if point is not None and point.curvature <= furthest:
            ax.plot(
                1e3 * point.curvature,
                point.moment / 1e3,
                linestyle="none",
                color="black",
                markersize=4.5,
                markeredgewidth=0.8,
                zorder=5,
                label=name.capitalize(),
                **EVENT_MARKS[name],
            )


def _dress(ax: Axes) -> None:
    ax.set_xlim(left=0.0)
    ax.set_ylim(bottom=0.0)
    ax.set_xlabel("Curvature (mrad/m)")
    ax.set_ylabel("Moment (kN m)")
    ax.tick_params(right=True, top=True)
    ax.legend(loc="lower right", handletextpad=0.3)


@view_of(SectionSprings, "plot")
def draw_springs(springs: SectionSprings) -> Figure:
    """Draw the diagrams and the lines fitted to them; see `SectionSprings.plot`."""
    need_matplotlib()
    from matplotlib.figure import Figure  # noqa: PLC0415

    section, events = springs.section, springs.events
    with style():
        panels = 1 if springs.shear_fit is None else 2
        figure = Figure(figsize=(3.5 * panels, 2.9), layout="constrained")
        axes = figure.subplots(1, panels, squeeze=False)[0]
        if springs.shear_fit is not None:
            section.shear_diagram(
                springs.length,
                springs.axial_load,
                furthest=events.ultimate.curvature,
                confined=springs.confined,
            ).plot(axes[0], spring=springs.shear_fit)
        ax = axes[-1]
        load, last = springs.axial_load, 1.1 * events.ultimate.curvature
        found = (events.cracking, events.yielding, events.ultimate)
        line = np.array([(0.0, 0.0)] + [(1e3 * p.curvature, p.moment / 1e3) for p in found])
        ax.plot(*line.T, **TEST_LINE, label="Spring")
        curvature = last * np.linspace(0.0, 1.0, 150) ** 2
        for tension, look, label in (
            ("ts", {**MODEL_LINE, "color": "0.6"}, "Tension stiffening"),
            ("bare", MODEL_LINE, "No stiffening"),
        ):
            moment = section.moment_curvature(load, curvature, tension, springs.confined)
            ax.plot(1e3 * curvature, moment / 1e3, **look, label=label)
        _draw_events(events, last, ax, ("cracking", "yielding", "ultimate"))
        _dress(ax)
    return figure


@view_of(Section, "plot")
def draw_section(section: Section, ax: Axes | None = None) -> Axes:
    """Draw outline, ties and bars to scale, the tension face below; see `Section.plot`."""
    need_matplotlib()
    from matplotlib.patches import Circle, Polygon  # noqa: PLC0415

    with axes_or_new(ax, (2.6, 2.8)) as drawn:
        w, h = 1e3 * section.width, 1e3 * section.depth
        drawn.add_patch(Polygon(1e3 * section.outline(), **_CONCRETE))
        if section.ties is not None:
            _draw_ties(section, section.ties.diameter, drawn)
        if section.hollow:
            _draw_void(section, drawn)
        for x, y, diameter in section.place_bars(_single_bars(section)):
            drawn.add_patch(Circle((1e3 * x, -1e3 * y), 0.5e3 * diameter, zorder=3, **_BAR))
        reach_x, reach_y = 0.54 * w, 0.54 * h
        drawn.set_xlim(-reach_x, reach_x)
        drawn.set_ylim(-reach_y, reach_y)
        drawn.set_aspect("equal")
        drawn.set_xticks([-0.5 * w, 0.0, 0.5 * w])
        drawn.set_yticks(
            [-0.5 * h, 0.0, 0.5 * h], [f"{0.5 * h:g}", "0", f"\N{MINUS SIGN}{0.5 * h:g}"]
        )
        drawn.set_xlabel("Width (mm)")
        drawn.set_ylabel("$y$ (mm), tension below")
        for spine in drawn.spines.values():
            spine.set_visible(False)
    return drawn


def _draw_ties(section: Section, thickness: float, ax: Axes) -> None:
    """Draw hoop and inner legs as bands of their true thickness [m]."""
    from matplotlib.patches import Polygon  # noqa: PLC0415

    bend = 0.5 * (section.bar_diameter or 0.0)
    for inset, look in ((0.0, _TIE), (thickness, _INSIDE)):
        line = section.hoop_line(inset, bend + thickness - inset)
        ax.add_patch(Polygon(1e3 * line, zorder=2, **look))
    for leg in section.inner_legs():
        ax.add_patch(Polygon(1e3 * leg, zorder=2, **_TIE))


def _draw_void(section: Section, ax: Axes) -> None:
    """Draw the void with the hoop around it."""
    from matplotlib.patches import Polygon  # noqa: PLC0415

    if section.ties is not None:
        for inset, look in ((section.ties.diameter, _TIE), (0.0, _INSIDE)):
            around = section.void(section.cover + inset)
            ax.add_patch(Polygon(1e3 * around, zorder=2.2, **look))
    empty = {**_CONCRETE, "facecolor": "white"}
    ax.add_patch(Polygon(1e3 * section.void(), zorder=2.4, **empty))


def _single_bars(section: Section) -> list[tuple[float, float]]:
    """Return y and diameter of every bar [m]; an entry of `bars` may be a row of several."""
    bars = []
    for y, area, _ in section.bars:
        one = 0.25 * math.pi * (section.bar_diameter or 0.0) ** 2
        count = max(1, round(area / one)) if one > 0.0 else 1
        bars += [(y, 2.0 * math.sqrt(area / count / math.pi))] * count
    return bars
