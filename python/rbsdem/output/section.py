"""Figures of a section: its drawing, its diagrams and springs, the state of its layers."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Literal, get_args

import numpy as np

from rbsdem._types import Array, ArrayLike, Axes
from rbsdem.errors import InputError
from rbsdem.model.materials import Tension
from rbsdem.model.shape import Section
from rbsdem.output.style import (
    MODEL_LINE,
    TEST_LINE,
    TEST_POINTS,
    ZERO_LINE,
    AxesArray,
    Line,
    axes_or_new,
    line_of,
    new_axes,
    style,
    style_of,
)
from rbsdem.output.units import factor, labelled, paper
from rbsdem.run.column_result import ColumnResult
from rbsdem.section import shear
from rbsdem.section.criteria import buckling_strain
from rbsdem.section.curvature import Diagram, Events, strains
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.paper import SectionSprings
from rbsdem.section.shear import ShearDiagram, ShearSpring
from rbsdem.section.strength import Code, InteractionDiagram

EVENT_MARKS: dict[str, Line] = {
    "cracking": {"marker": "o", "markerfacecolor": "white"},
    "yielding": {"marker": "s", "markerfacecolor": "white"},
    "peak": {"marker": "^", "markerfacecolor": "black"},
    "ultimate": {"marker": "D", "markerfacecolor": "black"},
}
"""Markers of the events."""

#: Common look of the markers.
_MARK: Line = {"ls": "none", "color": "black", "ms": 4.5, "mew": 0.8, "zorder": 5}

_OUTLINE: Line = {"facecolor": "0.93", "edgecolor": "black", "linewidth": 0.8}
_TIE: Line = {"facecolor": "0.35", "linewidth": 0.0}
#: Depth over width from which on a section has no numbers along its width.
_NARROW = 3.0
_INSIDE: Line = {"facecolor": "0.93", "linewidth": 0.0}
_BAR: Line = {"facecolor": "black", "edgecolor": "black", "linewidth": 0.0}

_NAMES = {
    "aci318": "ACI 318-19, nominal",
    "ec2": "EN 1992-1-1, nominal",
    "joint": "joint of the model",
    None: "material laws of the section",
}

#: States of concrete from the largest elongation to the largest compression, and their fills.
_FIBRES: dict[str, Line] = {
    "open": {"facecolor": "white"},
    "compressed": {"facecolor": "0.85"},
    "past its peak": {"facecolor": "0.62"},
    "spalled, crushed": {"facecolor": "0.35"},
}
_BARS: dict[str, Line] = {
    "elastic": {"facecolor": "white"},
    "yields": {"facecolor": "0.55"},
    "beyond buckling strain": {"facecolor": "black"},
}


def moment_curvature(
    diagram: Diagram,
    *,
    idealise: Literal["caltrans", "priestley"] | None = None,
    ax: Axes | None = None,
    **line: Any,
) -> Axes:
    """Draw moment against curvature with its events, in kN m and mrad/m.

    Parameters
    ----------
    diagram : Diagram
        The diagram, as `rbsdem.section.diagram` returns it.
    idealise : {"caltrans", "priestley"}, optional
        Draw the two lines of `Diagram.idealise`, too.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    with axes_or_new(ax, (3.5, 2.8)) as drawn:
        core = {"label": "Core confined" if diagram.confined else "Not confined"}
        x, y = factor("1/m") * diagram.curvature, factor("N m") * diagram.moment
        drawn.plot(x, y, **line_of(MODEL_LINE | core, line))
        if idealise is not None:
            corners = diagram.idealise(idealise).to_pandas().to_numpy()
            drawn.plot(
                *(corners * (factor("1/m"), factor("N m"))).T,
                **TEST_LINE,
                label=idealise.capitalize(),
            )
        _draw_events(diagram.events, float(diagram.curvature[-1]), drawn)
        _dress(drawn)
        drawn.set_ylim(bottom=min(0.0, factor("N m") * float(np.min(diagram.moment))))
    return drawn


def _draw_events(
    events: Events, furthest: float, ax: Axes, names: Iterable[str] = tuple(EVENT_MARKS)
) -> None:
    """Mark the events of a diagram up to its furthest curvature [1/m]."""
    for name in names:
        point = getattr(events, name)
        if point is not None and point.curvature <= furthest:
            at = factor("1/m") * point.curvature, factor("N m") * point.moment
            ax.plot(*at, label=name.capitalize(), **_MARK, **EVENT_MARKS[name])


def _dress(ax: Axes) -> None:
    """Give axes of moment and curvature their limits, labels and legend."""
    ax.set_xlim(left=0.0)
    ax.set_ylim(bottom=0.0)
    ax.set(xlabel=labelled("Curvature", "1/m"), ylabel=labelled("Moment", "N m"))
    ax.tick_params(right=True, top=True)
    ax.legend(loc="lower right", handletextpad=0.3)


def section_springs(springs: SectionSprings) -> Axes | AxesArray:
    """Draw the diagrams of a section and the lines of the springs (figure 2 of the paper).

    Parameters
    ----------
    springs : SectionSprings
        The springs, as `rbsdem.section.springs` returns them.

    Returns
    -------
    matplotlib.axes.Axes or ndarray of them
        Shear force against shear strain, where there is a shear diagram, and moment against
        curvature.
    """
    drawing, events = springs.section, springs.events
    with style():
        panels = 1 if springs.shear_fit is None else 2
        axes = new_axes(1, panels, (3.5 * panels, 2.9))
        assert events.ultimate is not None
        if springs.shear_fit is not None:
            given: Any = {"furthest": events.ultimate.curvature, "confined": springs.confined}
            found = shear.shear_diagram(drawing, springs.length, springs.axial_load, **given)
            shear_diagram(found, spring=springs.shear_fit, ax=axes[0])
        ax = axes[-1]
        load, last = springs.axial_load, 1.1 * events.ultimate.curvature
        points = [p for p in (events.cracking, events.yielding, events.ultimate) if p]
        along, up = factor("1/m"), factor("N m")
        x, y = zip((0.0, 0.0), *((along * p.curvature, up * p.moment) for p in points), strict=True)
        ax.plot(x, y, **TEST_LINE, label="Spring")
        curvature = last * np.linspace(0.0, 1.0, 150) ** 2
        laws: dict[Tension, Line] = {
            "ts": {"color": "0.6", "label": "Tension stiffening"},
            "bare": {"label": "No stiffening"},
        }
        for tension, look in laws.items():
            moments, _ = strains(drawing, load, curvature, tension, springs.confined)
            ax.plot(along * curvature, up * moments, **MODEL_LINE | look)
        _draw_events(events, last, ax, ("cracking", "yielding", "ultimate"))
        _dress(ax)
    return axes if panels > 1 else ax


def section(section: Section, *, ax: Axes | None = None) -> Axes:
    """Draw outline, ties and bars of a section to scale, in mm, as it lies in a beam: y > 0 is up.

    Parameters
    ----------
    section : Section
        The section.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    from matplotlib.patches import Circle, Polygon  # noqa: PLC0415

    with axes_or_new(ax, (2.6, 2.8)) as drawn:
        on_paper, unit = paper("m")
        outline = on_paper * section.outline()
        w, h = np.ptp(outline, axis=0)
        drawn.add_patch(Polygon(outline, **_OUTLINE))
        looks = ((_TIE, 2.0), (_INSIDE, 2.0), (_TIE, 2.2), (_INSIDE, 2.2))
        for line, (look, order) in zip(hoop_lines(section), looks, strict=False):
            drawn.add_patch(Polygon(on_paper * line, zorder=order, **look))
        for leg in section.inner_legs():
            drawn.add_patch(Polygon(on_paper * leg, zorder=2, **_TIE))
        if section.hollow:
            empty = {**_OUTLINE, "facecolor": "white"}
            drawn.add_patch(Polygon(on_paper * section.void(), zorder=2.4, **empty))
        for x, y, diameter in section.place_bars(section.single_bars):
            drawn.add_patch(
                Circle((on_paper * x, on_paper * y), 0.5 * on_paper * diameter, zorder=3, **_BAR)
            )
        reach_x, reach_y = 0.54 * w, 0.54 * h
        drawn.set(xlim=(-reach_x, reach_x), ylim=(-reach_y, reach_y))
        drawn.set_aspect("equal")
        drawn.set_xticks([-0.5 * w, 0.0, 0.5 * w])
        drawn.set_yticks([-0.5 * h, 0.0, 0.5 * h])
        drawn.set(xlabel=f"Width ({unit})", ylabel=f"$y$ ({unit})")
        if h > _NARROW * w:  # Numbers of a wall's width would lie on each other.
            drawn.set_xticks([])
            drawn.set(xlabel=f"Width {w:g} {unit}")
        for spine in drawn.spines.values():
            spine.set_visible(False)
    return drawn


def hoop_lines(section: Section) -> list[Array]:
    """Return the outer and inner line of the hoop [m], and those of the hoop around a void."""
    if section.ties is None:
        return []
    thickness, bend = section.ties.diameter, 0.5 * (section.bar_diameter or 0.0)
    lines = [section.hoop_line(inset, bend + thickness - inset) for inset in (0.0, thickness)]
    if not lines[0].size:  # Those of a wall are its legs.
        return []
    if section.hollow:
        lines += [section.void(section.cover + inset) for inset in (thickness, 0.0)]
    return lines


def shear_diagram(
    diagram: ShearDiagram, *, spring: ShearSpring | None = None, ax: Axes | None = None, **line: Any
) -> Axes:
    """Draw shear force against shear strain with its knee, in kN and mm/m.

    Parameters
    ----------
    diagram : ShearDiagram
        The diagram, as `rbsdem.section.shear_diagram` returns it.
    spring : ShearSpring, optional
        Draw the lines of this spring as well.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the diagram's line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    with axes_or_new(ax, (3.5, 2.8)) as drawn:
        strain = 1e3 * np.concatenate([[0.0], diagram.strain])
        force = factor("N") * np.concatenate([[0.0], diagram.force])
        drawn.plot(strain, force, **line_of(MODEL_LINE | {"label": "Section"}, line))
        marks = {"yielding": diagram.knee, "ultimate": diagram.end}
        if spring is not None:
            marks = {"yielding": spring.knee, "ultimate": spring.end}
            points = [(0.0, 0.0)] + [(p.strain, p.force) for p in (spring.knee, spring.end)]
            x, y = np.array(points).T
            drawn.plot(1e3 * x, factor("N") * y, **TEST_LINE, label="Spring")
            # A strength far above the diagram would only flatten it.
            if factor("N") * spring.strength < 1.3 * force.max():
                drawn.axhline(
                    factor("N") * spring.strength, color="0.75", linewidth=0.6, label="$V_n$"
                )
        for name, label in (("yielding", "Knee"), ("ultimate", "End")):
            point = marks[name]
            if point is not None:
                at = 1e3 * point.strain, factor("N") * point.force
                drawn.plot(*at, label=label, **_MARK, **EVENT_MARKS[name])
        drawn.set_xlim(0.0, 1.08 * strain.max())
        drawn.set_ylim(bottom=0.0)
        drawn.set(xlabel="Shear strain (mm/m)", ylabel=labelled("Shear force", "N"))
        drawn.tick_params(right=True, top=True)
        drawn.legend(loc="lower right", handletextpad=0.5)
    return drawn


def interaction(
    diagram: InteractionDiagram,
    *,
    demand: ArrayLike | None = None,
    design: bool = True,
    ax: Axes | None = None,
) -> Axes:
    """Draw axial load over moment, in kN and kN m; of unlike faces both sides, with their sign.

    Parameters
    ----------
    diagram : InteractionDiagram
        The diagram, as `rbsdem.section.interaction` returns it.
    demand : array_like, shape (p, 2), optional
        Axial loads [N] and moments [N m] to mark.
    design : bool, optional
        Whether to draw the design strength of a code too.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    marks = None if demand is None else np.atleast_2d(np.asarray(demand, dtype=np.float64))
    if marks is not None and marks.shape[1] != 2:
        raise InputError(
            f"demand has shape {marks.shape}; give a row for each demand: axial load [N], "
            "moment [N m]"
        )
    with axes_or_new(ax, (3.5, 3.4)) as drawn:
        name = _NAMES[diagram.code]
        nominal = {"axial": "axial_load", "moment": "moment"}
        drawn.plot(*_outline(diagram, **nominal), **MODEL_LINE, label=name)
        if design and diagram.code in get_args(Code):
            look = TEST_LINE | {"color": "black", "label": name.replace("nominal", "design")}
            factored = {key: f"design_{value}" for key, value in nominal.items()}
            drawn.plot(*_outline(diagram, **factored), **look)
        one_side = diagram.upside_down is None
        if marks is not None:
            moments = np.abs(marks[:, 1]) if one_side else marks[:, 1]
            drawn.plot(
                factor("N m") * moments, factor("N") * marks[:, 0], **TEST_POINTS, label="demand"
            )
        drawn.axhline(0.0, **ZERO_LINE)
        if one_side:
            drawn.set_xlim(left=0.0, auto=True)
        else:
            drawn.axvline(0.0, **ZERO_LINE)
        drawn.set(
            xlabel=labelled("Moment", "N m"),
            ylabel=f"{labelled('Axial load', 'N')}, compression positive",
        )
        drawn.tick_params(right=True, top=True)
        drawn.legend(loc="upper right", fontsize=7.5)
    return drawn


def _outline(diagram: InteractionDiagram, axial: str, moment: str) -> tuple[Array, Array]:
    """Return moments and axial loads on paper, those of unlike faces around both sides."""
    m, n = getattr(diagram, moment), getattr(diagram, axial)
    other = diagram.upside_down
    if other is not None:
        m = np.concatenate((m, -getattr(other, moment)[::-1], m[:1]))
        n = np.concatenate((n, getattr(other, axial)[::-1], n[:1]))
    return factor("N m") * m, factor("N") * n


def section_state(
    result: ColumnResult, time: float, *, axes: Sequence[Axes] | AxesArray | None = None
) -> AxesArray:
    """Draw the hinge's section with its layers by state, and the strains over its depth.

    Parameters
    ----------
    result : Result
        Of a column that was made from a section, with its openings (``openings=True``).
    time : float
        The moment [s], or point of a static path; the nearest row is drawn.
    axes : sequence of 2 matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    ndarray of matplotlib.axes.Axes
        For the section and the strains.

    Raises
    ------
    InputError
        If the column was not made from a section, the openings were not kept, or the moment is
        outside of the rows.
    """
    column = result.column
    if not isinstance(column, LayeredColumn) or column.drawing is None:
        raise InputError(
            "section_state: the column was not made from a section; Section.column makes one"
        )
    section = column.drawing.section
    strains = result.strains(1)
    if not result.time[0] <= time <= result.time[-1]:
        raise InputError(
            f"time = {time:g} is outside of the rows, which hold {result.time[0]:g} to "
            f"{result.time[-1]:g}"
        )
    row = int(np.argmin(np.abs(result.time - time)))
    if axes is None:
        axes = new_axes(1, 2, (5.2, 2.8))
    elif len(axes) != 2:
        raise InputError(f"axes has {len(axes)} of them; give two, for the section and its strains")
    value = strains.value[row]
    concrete = strains.part != "bar"
    with style_of(axes[0]):
        buckles = buckling_strain(section, column)
        _draw_layers(section, (strains.position, strains.part, value), buckles, axes[0])
        axes[1].plot(100 * value[concrete], factor("m") * strains.position[concrete], **MODEL_LINE)
        mark: Line = {"ls": "none", "marker": "o", "ms": 3.5, "mfc": "white", "mec": "black"}
        axes[1].plot(100 * value[~concrete], factor("m") * strains.position[~concrete], **mark)
        axes[1].axvline(0.0, **ZERO_LINE)
        axes[1].set_ylim(axes[0].get_ylim())
        axes[1].set(xlabel="Strain (%), elongation positive", ylabel=labelled("$y$", "m"))
        axes[1].tick_params(right=True, top=True)
        drift = 100 * result.displacement[row] / column.height
        axes[0].set_title(f"drift {drift:.2f} %", fontsize=8)
    return np.asarray(axes)


def _draw_layers(
    section: Section, layers: tuple[Array, Array, Array], buckles: float, ax: Axes
) -> None:
    """Draw bands of concrete and bars; core inside, cover around it, within the outline."""
    from matplotlib.lines import Line2D  # noqa: PLC0415
    from matplotlib.patches import Circle, Patch, Polygon  # noqa: PLC0415

    places, parts, values = layers
    core = section.confinement
    cover = section.concrete_law["eps0"], section.concrete.eps_spall
    marks = {"cover": cover, "core": (core.eps_cc, core.eps_cu) if core else cover}
    on_paper, unit = paper("m")
    half = 0.5 * on_paper * section.depth
    clip = Polygon(
        on_paper * section.outline(), facecolor="none", edgecolor="black", lw=0.8, zorder=3
    )
    ax.add_patch(clip)
    wide = on_paper * np.ptp(section.outline()[:, 0])
    inner = on_paper * (section.width - 2 * float(section.side_cover or 0.0))
    for part, span in (("cover", wide), ("core", inner)):
        chosen = np.flatnonzero(parts == part)
        chosen = chosen[np.argsort(places[chosen])]
        ys = on_paper * places[chosen]
        if ys.size == 0:
            continue
        between = 0.5 * (ys[1:] + ys[:-1])
        end = half if part == "cover" else half - on_paper * section.cover
        edges = np.concatenate(([-end], between, [end]))
        for low, high, strain in zip(edges[:-1], edges[1:], values[chosen], strict=True):
            state = _of_concrete(-strain, *marks[part])
            corners = [(-span / 2, low), (span / 2, low), (span / 2, high), (-span / 2, high)]
            band = Polygon(corners, zorder=1 if part == "cover" else 2, lw=0, **_FIBRES[state])
            ax.add_patch(band)
            band.set_clip_path(clip)
    bars = np.flatnonzero(parts == "bar")
    levels, strains = places[bars], values[bars]
    singles = [(y, section.bar_diameter or 0.0) for y, _, _ in section.bars]
    for x, y, diameter in section.place_bars(singles):
        strain = strains[np.argmin(np.abs(levels - y))]
        near = min(abs(bar[0] - y) for bar in section.bars)
        steels = [steel for at, _, steel in section.bars if abs(at - y) <= near]
        yields = min(steel.fy / steel.es for steel in steels)
        state = "elastic" if abs(strain) < yields else "yields"
        if strain > buckles:
            state = "beyond buckling strain"
        at, radius = (on_paper * x, on_paper * y), 0.5 * on_paper * diameter
        ax.add_patch(Circle(at, radius, zorder=4, ec="black", lw=0.6, **_BARS[state]))
    ax.set(xlim=(-0.54 * wide, 0.54 * wide), ylim=(-1.08 * half, 1.08 * half))
    ax.set_aspect("equal")
    ax.set(xlabel=f"Width ({unit})", ylabel=f"$y$ ({unit})")
    fibres = [Patch(ec="black", lw=0.5, label=name, **fill) for name, fill in _FIBRES.items()]
    circles = [
        Line2D([], [], marker="o", ls="", mec="black", mfc=fill["facecolor"], label=name)
        for name, fill in _BARS.items()
    ]
    place: Any = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.22), "ncols": 2}
    ax.legend(handles=[*fibres, *circles], fontsize=6.5, handlelength=1.0, **place)


def _of_concrete(compression: float, peak: float, spall: float) -> str:
    """Return the state of concrete by its compressive strain, a name in `_FIBRES`."""
    if compression <= 0:
        return "open"
    if compression < peak:
        return "compressed"
    return "past its peak" if compression < spall else "spalled, crushed"
