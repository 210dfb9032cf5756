"""A section cut into strips of core and of cover, with what confines the core.

The strips are those of the Fortran part (`src/section/strips.f90`), which the moment-curvature
diagram uses as well.

The confinement is that of Mander, Priestley and Park (1988), ASCE Journal of Structural Engineering
114(8), as the layered hinge takes it: the confining stress of the direction of loading alone, and
the bars that the legs hold spread evenly around the core. `src/section/confinement.f90`, which the
moment-curvature diagram uses, takes the mean of both directions and the arches between the bars of
each face. For a spiral the two differ only in the cap on the share of the bars (8 % here, 50 %
there), and single round hoops count as a spiral here. They stay apart because the parameters of the
hinge are fitted with the form used here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rbsdem import _core

if TYPE_CHECKING:
    from rbsdem.model.section import Section

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


def cut(section: Section, number: int, restrained: int | None, round_core: bool) -> Strips:
    """Return the strips of a section and what confines its core; see `Section.cut`."""
    tie = section.ties.diameter if section.ties else 0.0
    # By how much the core, between the centre lines of the hoops, is smaller than the outline.
    less = [2 * float(section.side_cover or 0.0) + tie, 2 * section.cover + tie]
    round_core = round_core or (section.ties is not None and section.ties.is_round)
    core, cover = _core.section_strips(section._statement, round_core, number)
    if round_core:
        confinement = _spiral(section, section.depth - less[1])
    else:
        confinement = _hoops(section, section.width - less[0], section.depth - less[1], restrained)
    if section.hollow:
        # The inner hoops bow into the void.
        confinement = 0.0, confinement[1]
    figures = section._figures
    # Slivers along the rim of the core are round-off.
    least = 1e-9 * figures["area"]
    return Strips(
        core=tuple(Strip(y, part) for y, part in core.T.tolist() if part > least),
        cover=tuple(Strip(y, part) for y, part in cover.T.tolist() if part > least),
        area=figures["area"],
        inertia=figures["inertia"],
        shear_area=figures["shear_area"],
        confining_stress=confinement[0],
        tie_ratio=confinement[1],
    )


def _hoops(
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
    # With two legs the four corners alone are held; from three on the bars stand for all of them.
    corners = min(max(3.0 - ties.legs, 0.0), 1.0)
    clear = core_width - bar, core_depth - bar
    parabolas = corners * 2 * (clear[0] ** 2 + clear[1] ** 2) / 6
    bars = max(4, _restrained(section) if restrained is None else restrained)
    clear_one = max(0.0, 2 * (core_width + core_depth) / bars - bar)
    parabolas += (1 - corners) * bars * clear_one**2 / 6
    gap = ties.spacing - ties.diameter
    effective = max(0.0, 1 - parabolas / area) / (1 - _bars(section, area))
    effective *= max(0.0, 1 - gap / (2 * core_width)) * max(0.0, 1 - gap / (2 * core_depth))
    return effective * ratio * ties.steel.fy, 2 * ratio


def _restrained(section: Section) -> float:
    """Return how many bars the legs hold: the corners, and four for each leg beyond two.

    A diagonal leg is a part of one, and holds that part of four bars.
    """
    if section.layout is not None:
        number = section.layout.number
    elif not section.bars:
        number = 0
    else:
        # An entry of `bars` may be a row of them.
        number = section.steel_area / (math.pi / 4 * section.bar_diameter**2)
    return min(number, 4 + 4 * (section.ties.legs - 2))


def _spiral(section: Section, diameter: float) -> tuple[float, float]:
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
