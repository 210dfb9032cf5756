"""A section cut into strips of core and of cover, with what confines the core.

Rectangles in rectangular hoops, circles and squares in a spiral; the confinement is that of Mander,
Priestley and Park (1988), ASCE Journal of Structural Engineering 114(8).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rbsdem.section.section import Section

__all__ = [
    "Strip",
    "Strips",
    "box",
    "core_diameter",
    "disc",
    "hoop_confinement",
    "spiral_confinement",
]


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

    @classmethod
    def of(
        cls,
        whole: list[Strip],
        core: list[Strip],
        confinement: tuple[float, float],
        *,
        area: float,
        inertia: float,
        shear_area: float,
    ) -> Strips:
        """Return the strips of a section and of the core in it, cut at the same depths.

        Parameters
        ----------
        whole, core : list of Strip
            Of the same length.
        confinement : (float, float)
            Confining stress [Pa] and ratio of the transverse bars.
        area, inertia, shear_area : float
            Of the whole section [m2], [m4], [m2].
        """
        # Slivers along the rim of the core are round-off.
        least = 1e-9 * area
        rest = [_without(w, c) for w, c in zip(whole, core, strict=True)]
        return cls(
            core=tuple(strip for strip in core if strip.area > least),
            cover=tuple(strip for strip in rest if strip.area > least),
            area=area,
            inertia=inertia,
            shear_area=shear_area,
            confining_stress=confinement[0],
            tie_ratio=confinement[1],
        )


def _edges(depth: float, number: int) -> list[float]:
    return [depth * (i / number - 0.5) for i in range(number + 1)]


def box(width: float, own_depth: float, depth: float, number: int) -> list[Strip]:
    """Return a rectangle's share in strips of a depth that it is in the middle of."""
    ends = [min(max(y, -own_depth / 2), own_depth / 2) for y in _edges(depth, number)]
    return [Strip((low + high) / 2, (high - low) * width) for low, high in pairwise(ends)]


def disc(diameter: float, depth: float, number: int) -> list[Strip]:
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


def hoop_confinement(
    section: Section, core_width: float, core_depth: float, restrained: int | None
) -> tuple[float, float]:
    """Return the confining stress of rectangular hoops [Pa] and their volume ratio.

    Effectiveness by the parabolas between the bars around the perimeter and between the hoops.
    """
    ties, bar = section.ties, section.bar_diameter or 0.0
    if ties is None:
        return 0.0, 0.0
    ratio = ties.legs * math.pi / 4 * ties.diameter**2
    ratio /= ties.spacing * core_width
    area = core_width * core_depth
    if ties.legs <= 2:
        clear = core_width - bar, core_depth - bar
        parabolas = 2 * (clear[0] ** 2 + clear[1] ** 2) / 6
    else:
        bars = max(4, _restrained(section) if restrained is None else restrained)
        clear_one = max(0.0, 2 * (core_width + core_depth) / bars - bar)
        parabolas = bars * clear_one**2 / 6
    gap = ties.spacing - ties.diameter
    effective = max(0.0, 1 - parabolas / area) / (1 - _bars(section, area))
    effective *= max(0.0, 1 - gap / (2 * core_width)) * max(0.0, 1 - gap / (2 * core_depth))
    return effective * ratio * ties.steel.fy, 2 * ratio


def core_diameter(section: Section) -> float:
    """Return the diameter of a round core, to the centre line of the spiral [m]."""
    return section.depth - 2 * section.cover - (section.ties.diameter if section.ties else 0.0)


def _restrained(section: Section) -> int:
    """Return how many bars the legs hold: the corners, and four for each leg beyond two."""
    if section.layout is not None:
        number = section.layout.number
    else:
        # An entry of `bars` may be a row of them.
        number = round(section.steel_area / (math.pi / 4 * section.bar_diameter**2))
    return min(number, 4 + 4 * round(section.ties.legs - 2))


def spiral_confinement(section: Section, diameter: float) -> tuple[float, float]:
    """Return the confining stress of a spiral [Pa] and its volume ratio.

    Effectiveness by the parabola between two turns: (1 - s'/(2 d_s))/(1 - rho_cc).
    """
    ties = section.ties
    if ties is None:
        return 0.0, 0.0
    ratio = math.pi * ties.diameter**2 / (diameter * ties.spacing)
    gap = ties.spacing - ties.diameter
    effective = max(0.0, 1 - gap / (2 * diameter))
    effective /= 1 - _bars(section, math.pi / 4 * diameter**2)
    return 0.5 * effective * ratio * ties.steel.fy, ratio


def _bars(section: Section, core_area: float) -> float:
    """Return the share of longitudinal bars in the core, up to the 8 % that codes allow."""
    return min(0.08, section.steel_area / core_area)
