"""Quantities of a drawing that formulas use, in the units they are written in."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from rbsdem.errors import InputError
from rbsdem.model.materials import Bar
from rbsdem.model.shape import Section, checked_section
from rbsdem.section.curvature import carried_load, column_length

_MPA = 1.0e6
#: Bars belong to the row of the outermost ones up to the first of these shares of the distance of
#: both outermost rows, to the web from the second on; between them part of their area does.
_ROW = (0.06, 0.18)


@dataclass(frozen=True)
class Quantities:
    """A column as codes describe it: N, mm, MPa; ratios and rotations without unit.

    Attributes
    ----------
    round : bool
        Whether the section is a circle.
    width, depth, d, d2 : float
        Width, whole depth, and depths of the bars in tension and in compression from the face in
        compression [mm].
    span : float
        Shear span, from the base to the point without moment [mm].
    load : float
        Axial load, compression positive [N].
    fc, fyt : float
        Strengths of concrete and transverse bars [MPa].
    fy, fu, es : float
        Yield stress, tensile strength and modulus of the bars in tension, means by area; the
        tensile strength is NaN where a steel has none [MPa].
    fy_compression, fy_web : float
        Yield stresses of the bars in compression and between; 0 without such bars [MPa].
    tension, compression, web : float
        Areas of the bars in tension, in compression and between [mm2].
    bar : float
        Diameter of the bars [mm].
    tie_area, spacing : float
        Area of transverse bars in the direction of the shear and their spacing [mm2, mm]; 0 and
        infinite without.
    core_width, core_depth : float
        Between centre lines of the hoops [mm]; 0 without.
    corner_width : float
        Between the bars in the corners, across the width [mm]; 0 without hoops.
    legs, legs_across : float
        Legs in the direction of the depth, side by side over the width, and across it.
    hoop_ratio : float
        Volume of the transverse bars over that of the core; 0 without.
    gross_area : float
        Of the concrete [mm2].
    """

    round: bool
    width: float
    depth: float
    d: float
    d2: float
    span: float
    load: float
    fc: float
    fyt: float
    fy: float
    fu: float
    es: float
    fy_compression: float
    fy_web: float
    tension: float
    compression: float
    web: float
    bar: float
    tie_area: float
    spacing: float
    core_width: float
    core_depth: float
    corner_width: float
    legs: float
    legs_across: float
    hoop_ratio: float
    gross_area: float

    @property
    def axial_load_ratio(self) -> float:
        """N/(A_g f'c)."""
        return self.load / (self.gross_area * self.fc)

    @property
    def tie_ratio(self) -> float:
        """A_v/(b s)."""
        return self.tie_area / (self.width * self.spacing)

    @property
    def steel_ratio(self) -> float:
        """All longitudinal bars over the gross area."""
        return (self.tension + self.compression + self.web) / self.gross_area

    @property
    def slenderness(self) -> float:
        """Shear span over depth."""
        return self.span / self.depth


def quantities(section: Section, height: float, axial_load: float) -> Quantities:
    """Return the quantities of a section, height and axial load.

    Parameters
    ----------
    section : Section
        The section, with bars.
    height : float
        Shear span [m].
    axial_load : float
        Compression, from 0 to the capacity of the section [N].

    Raises
    ------
    InputError
        If a number is refused, or the section is hollow, has a flange, or has no bars near both
        faces.
    """
    checked_section(section)
    span = column_length(height, "height")
    if section.hollow:
        raise InputError("code values: the formulas are for solid sections; this one is hollow")
    if section.shape == "tee":
        raise InputError("code values: the formulas are for columns; this section has a flange")
    if not section.bars:
        raise InputError("code values: the section has no bars; give it some")
    load = carried_load(axial_load, section, tension=False)
    depth, bars = section.depth, section.bars
    rows = _rows(section)
    pulled, pressed, between = (
        [(bar, share) for bar, share in zip(bars, row, strict=True) if share > 0] for row in rows
    )
    ties, core = section.ties, section.confinement
    diameter = 1e3 * float(section.bar_diameter or 0.0)
    tie = 1e3 * ties.diameter if ties else 0.0
    core_width = 1e3 * core.width if core else 0.0
    # Depths of codes for circles are those of their bars' centroid on one side.
    round_section = section.shape == "circle"
    return Quantities(
        round=round_section,
        width=1e3 * section.width,
        depth=1e3 * depth,
        d=1e3 * (section.effective_depth if round_section else 0.5 * depth + _mean(pulled, _y)),
        d2=1e3 * (0.5 * depth + _mean(pressed, _y)),
        span=1e3 * span,
        load=load,
        fc=section.concrete_law["fc"] / _MPA,
        fyt=ties.steel.fy / _MPA if ties else 0.0,
        fy=_mean(pulled, lambda bar: bar[2].fy) / _MPA,
        fu=_mean(pulled, lambda bar: math.nan if bar[2].fu is None else bar[2].fu) / _MPA,
        es=_mean(pulled, lambda bar: bar[2].es) / _MPA,
        fy_compression=_mean(pressed, lambda bar: bar[2].fy) / _MPA,
        fy_web=_mean(between, lambda bar: bar[2].fy) / _MPA,
        tension=1e6 * _area(pulled),
        compression=1e6 * _area(pressed),
        web=1e6 * _area(between),
        bar=diameter,
        tie_area=0.25 * math.pi * tie**2 * ties.legs if ties else 0.0,
        spacing=1e3 * ties.spacing if ties else math.inf,
        core_width=core_width,
        core_depth=1e3 * core.depth if core else 0.0,
        corner_width=max(core_width - tie - diameter, 0.0),
        legs=float(ties.legs) if ties else 0.0,
        legs_across=float(ties.legs_across or 0.0) if ties else 0.0,
        hoop_ratio=core.ratio if core else 0.0,
        gross_area=1e6 * section.gross_area,
    )


_Parts = list[tuple[Bar, float]]


def _rows(section: Section) -> tuple[list[float], list[float], list[float]]:
    """Return the share of each bar in the rows in tension and in compression, and in the web."""
    heights = [bar[0] for bar in section.bars]
    low, high = min(heights), max(heights)
    if high - low <= 0.1 * section.depth:
        raise InputError("code values: the section needs bars near both faces")

    def share(distance: float) -> float:
        near, far = _ROW
        return min(max((far - distance / (high - low)) / (far - near), 0.0), 1.0)

    pulled = [share(high - y) for y in heights]
    pressed = [share(y - low) for y in heights]
    return pulled, pressed, [1.0 - a - b for a, b in zip(pulled, pressed, strict=True)]


def _y(bar: Bar) -> float:
    return bar[0]


def _area(parts: _Parts) -> float:
    return sum(share * bar[1] for bar, share in parts)


def _mean(parts: _Parts, value: Callable[[Bar], float]) -> float:
    """Return the mean of a value by area; 0 without bars."""
    if not parts:
        return 0.0
    return sum(share * bar[1] * value(bar) for bar, share in parts) / _area(parts)


def goodnight_buckling_strain(q: Quantities) -> float:
    """Return the tensile strain before bar buckling of Goodnight, Kowalsky, Nau; bridge columns.

    0.03 + 700 rho_s f_yh/E_s - 0.1 nu.
    """
    return 0.03 + 700.0 * q.hoop_ratio * q.fyt / q.es - 0.1 * q.axial_load_ratio
