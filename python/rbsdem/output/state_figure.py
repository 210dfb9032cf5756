"""The state of a hinge's layers at one moment, drawn on its section."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._arguments import Array
from rbsdem.checks.criteria import buckling_strain
from rbsdem.errors import InputError
from rbsdem.model.response import Response
from rbsdem.model.section import Section
from rbsdem.output.style import MODEL_LINE, ZERO_LINE, new_axes, style_of
from rbsdem.section.model import LayeredColumn

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.axes import Axes

#: States of concrete from the largest elongation to the largest compression, and their fills.
_CONCRETE: dict[str, dict[str, Any]] = {
    "open": {"facecolor": "white"},
    "compressed": {"facecolor": "0.85"},
    "past its peak": {"facecolor": "0.62"},
    "spalled, crushed": {"facecolor": "0.35"},
}
_BARS: dict[str, dict[str, Any]] = {
    "elastic": {"facecolor": "white"},
    "yields": {"facecolor": "0.55"},
    "beyond buckling strain": {"facecolor": "black"},
}


def section_state(
    result: Response, time: float, *, axes: Sequence[Axes] | None = None
) -> list[Axes]:
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
    list of matplotlib.axes.Axes
        For the section and the strains.

    Raises
    ------
    InputError
        If the column was not made from a section, the openings were not kept, or the moment is
        outside of the rows.
    """
    column = result.column
    if not isinstance(column, LayeredColumn) or column.recipe is None:
        raise InputError(
            "section_state: the column was not made from a section; Section.column makes one"
        )
    section = column.recipe.section
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
        axes[1].plot(100 * value[concrete], 1e3 * strains.position[concrete], **MODEL_LINE)
        axes[1].plot(
            100 * value[~concrete],
            1e3 * strains.position[~concrete],
            linestyle="none",
            marker="o",
            markersize=3.5,
            markerfacecolor="white",
            markeredgecolor="black",
        )
        axes[1].axvline(0.0, **ZERO_LINE)
        axes[1].set_ylim(axes[0].get_ylim())
        axes[1].set_xlabel("Strain (%), elongation positive")
        axes[1].set_ylabel("$y$ (mm)")
        axes[1].tick_params(right=True, top=True)
        drift = 100 * result.displacement[row] / column.height
        axes[0].set_title(f"drift {drift:.2f} %", fontsize=8)
    return list(axes)


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
    half = 0.5e3 * section.depth
    clip = Polygon(1e3 * section.outline(), facecolor="none", edgecolor="black", lw=0.8, zorder=3)
    ax.add_patch(clip)
    wide = 1e3 * section.width
    inner = wide - 2e3 * float(section.side_cover or 0.0)
    for part, span in (("cover", wide), ("core", inner)):
        chosen = np.flatnonzero(parts == part)
        chosen = chosen[np.argsort(places[chosen])]
        ys = 1e3 * places[chosen]
        if ys.size == 0:
            continue
        between = 0.5 * (ys[1:] + ys[:-1])
        ends = (
            (-half, half)
            if part == "cover"
            else (
                -half + 1e3 * section.cover,
                half - 1e3 * section.cover,
            )
        )
        edges = np.concatenate(([ends[0]], between, [ends[1]]))
        for low, high, strain in zip(edges[:-1], edges[1:], values[chosen], strict=True):
            state = _of_concrete(-strain, *marks[part])
            corners = [(-span / 2, low), (span / 2, low), (span / 2, high), (-span / 2, high)]
            band = Polygon(corners, zorder=1 if part == "cover" else 2, lw=0, **_CONCRETE[state])
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
        ax.add_patch(
            Circle(
                (1e3 * x, 1e3 * y), 0.5e3 * diameter, zorder=4, ec="black", lw=0.6, **_BARS[state]
            )
        )
    ax.set_xlim(-0.54 * wide, 0.54 * wide)
    ax.set_ylim(-1.08 * half, 1.08 * half)
    ax.set_aspect("equal")
    ax.set_xlabel("Width (mm)")
    ax.set_ylabel("$y$ (mm)")
    ax.legend(
        handles=[Patch(ec="black", lw=0.5, label=name, **fill) for name, fill in _CONCRETE.items()]
        + [
            Line2D([], [], marker="o", ls="", mec="black", mfc=fill["facecolor"], label=name)
            for name, fill in _BARS.items()
        ],
        loc="upper center",
        bbox_to_anchor=(0.5, -0.22),
        ncols=2,
        fontsize=6.5,
        handlelength=1.0,
    )


def _of_concrete(compression: float, peak: float, spall: float) -> str:
    if compression <= 0:
        return "open"
    if compression < peak:
        return "compressed"
    return "past its peak" if compression < spall else "spalled, crushed"
