"""A drawn section cut into strips of core and of cover, with what confines the core.

Rectangles in rectangular hoops, circles and squares in a spiral; the confinement is that of Mander,
Priestley and Park (1988), ASCE Journal of Structural Engineering 114(8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rbsdem.peer.drawing import Drawing

__all__ = ["Strip", "Strips", "cut"]


@dataclass(frozen=True, slots=True)
class Strip:
    """Concrete at one depth.

    Attributes
    ----------
    y : float
        Of its centroid from mid-depth [m].
    area : float
        [m2].
    """

    y: float
    area: float


@dataclass(frozen=True, slots=True)
class Strips:
    """A section in strips.

    Attributes
    ----------
    core, cover : tuple of Strip
        Concrete within the centre lines of the transverse bars, and around them; bars are not
        deducted.
    area : float
        Of the whole section [m2].
    inertia : float
        Second moment of the whole section [m4].
    shear_area : float
        [m2].
    confining_stress : float
        Effective, along and across the loading alike, as the transverse bars yield [Pa].
    tie_ratio : float
        Volume of transverse bars over that of the core.
    """

    core: tuple[Strip, ...]
    cover: tuple[Strip, ...]
    area: float
    inertia: float
    shear_area: float
    confining_stress: float
    tie_ratio: float


def cut(drawing: Drawing, number: int) -> Strips:
    """Cut a section into strips of equal thickness across the direction of loading.

    Parameters
    ----------
    drawing : Drawing
        The section.
    number : int
        Of strips.

    Returns
    -------
    Strips
        In order of y; in each strip core and cover have centroids of their own.
    """
    width, depth = drawing.width, drawing.depth
    if drawing.shape == "circular":
        whole = _disc(depth, depth, number)
        area, inertia, form = math.pi / 4 * depth**2, math.pi / 64 * depth**4, 0.9
    else:
        whole = _box(width, depth, depth, number)
        area, inertia, form = width * depth, width * depth**3 / 12, 5 / 6
    if drawing.shape == "rectangular":
        core_width = width - 2 * drawing.side_cover - drawing.tie_diameter
        core_depth = depth - 2 * drawing.cover - drawing.tie_diameter
        core = _box(core_width, core_depth, depth, number)
        stress, ratio = _hoops(drawing, core_width, core_depth)
    else:
        diameter = depth - 2 * drawing.cover - drawing.tie_diameter
        core = _disc(diameter, depth, number)
        stress, ratio = _spiral(drawing, diameter)
    # Slivers along the rim of the core are round-off.
    least = 1e-9 * area
    return Strips(
        core=tuple(strip for strip in core if strip.area > least),
        cover=tuple(
            rest for w, c in zip(whole, core, strict=True) if (rest := _without(w, c)).area > least
        ),
        area=area,
        inertia=inertia,
        shear_area=form * area,
        confining_stress=stress,
        tie_ratio=ratio,
    )


def _edges(depth: float, number: int) -> list[float]:
    return [depth * (i / number - 0.5) for i in range(number + 1)]


def _box(width: float, own_depth: float, depth: float, number: int) -> list[Strip]:
    """Return a rectangle's share in strips of a depth that it is in the middle of."""
    ends = [min(max(y, -own_depth / 2), own_depth / 2) for y in _edges(depth, number)]
    return [Strip((low + high) / 2, (high - low) * width) for low, high in pairwise(ends)]


def _disc(diameter: float, depth: float, number: int) -> list[Strip]:
    """Return a circle's share in strips of a depth that it is in the middle of."""
    r = diameter / 2
    ends = [min(max(y, -r), r) for y in _edges(depth, number)]
    # Integrals of the chord 2 sqrt(r^2 - y^2) and of y times it.
    areas = [y * math.sqrt(r * r - y * y) + r * r * math.asin(y / r) for y in ends]
    moments = [-2 / 3 * (r * r - y * y) ** 1.5 for y in ends]
    strips = []
    for i in range(number):
        area = areas[i + 1] - areas[i]
        middle = (ends[i] + ends[i + 1]) / 2
        y = (moments[i + 1] - moments[i]) / area if area > 1e-12 * r * r else middle
        strips.append(Strip(y, max(area, 0.0)))
    return strips


def _without(whole: Strip, part: Strip) -> Strip:
    area = whole.area - part.area
    if not area > 0:
        return Strip(whole.y, 0.0)
    return Strip((whole.y * whole.area - part.y * part.area) / area, area)


def _hoops(drawing: Drawing, core_width: float, core_depth: float) -> tuple[float, float]:
    """Return the confining stress of rectangular hoops [Pa] and their volume ratio.

    Effectiveness by the parabolas between the bars around the perimeter and between the hoops.
    """
    if not drawing.tie_diameter or not drawing.tie_spacing:
        return 0.0, 0.0
    ratio = drawing.legs * math.pi / 4 * drawing.tie_diameter**2
    ratio /= drawing.tie_spacing * core_width
    area = core_width * core_depth
    if drawing.legs <= 2:
        clear = core_width - drawing.bar_diameter, core_depth - drawing.bar_diameter
        parabolas = 2 * (clear[0] ** 2 + clear[1] ** 2) / 6
    else:
        bars = max(4, drawing.restrained)
        clear_one = max(0.0, 2 * (core_width + core_depth) / bars - drawing.bar_diameter)
        parabolas = bars * clear_one**2 / 6
    gap = drawing.tie_spacing - drawing.tie_diameter
    effective = max(0.0, 1 - parabolas / area) / (1 - _bars(drawing, area))
    effective *= max(0.0, 1 - gap / (2 * core_width)) * max(0.0, 1 - gap / (2 * core_depth))
    return effective * ratio * drawing.tie_yield_stress, 2 * ratio


def _spiral(drawing: Drawing, diameter: float) -> tuple[float, float]:
    """Return the confining stress of a spiral [Pa] and its volume ratio.

    Effectiveness by the parabola between two turns: (1 - s'/(2 d_s))/(1 - rho_cc).
    """
    if not drawing.tie_diameter or not drawing.tie_spacing:
        return 0.0, 0.0
    ratio = math.pi * drawing.tie_diameter**2 / (diameter * drawing.tie_spacing)
    gap = drawing.tie_spacing - drawing.tie_diameter
    effective = max(0.0, 1 - gap / (2 * diameter))
    effective /= 1 - _bars(drawing, math.pi / 4 * diameter**2)
    return 0.5 * effective * ratio * drawing.tie_yield_stress, ratio


def _bars(drawing: Drawing, core_area: float) -> float:
    """Return the share of longitudinal bars in the core, up to the 8 % that codes allow."""
    return min(0.08, drawing.steel_area / core_area)
