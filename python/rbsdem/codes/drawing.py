"""The quantities of a drawing that formulas of codes use, in the units they are written in."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rbsdem import _core
from rbsdem.errors import InputError
from rbsdem.section.ranges import column_length
from rbsdem.section.section import Section

__all__ = ["Quantities", "quantities"]

_MPA = 1.0e6
_NEAR = 0.1  # bars within this share of the depth from the outermost ones belong to their row


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
    fc, fy, es, fyt : float
        Strengths of concrete, bars and transverse bars, modulus of the bars [MPa].
    tension, compression, web : float
        Areas of the bars in tension, in compression and between [mm2].
    bar : float
        Diameter of the bars [mm].
    tie_area, spacing : float
        Area of transverse bars in the direction of the shear and their spacing [mm2, mm]; 0 and
        infinite without.
    core_width, core_depth : float
        Between centre lines of the hoops [mm]; 0 without.
    legs, legs_across : float
        Legs in the direction of the depth and across it.
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
    fy: float
    es: float
    fyt: float
    tension: float
    compression: float
    web: float
    bar: float
    tie_area: float
    spacing: float
    core_width: float
    core_depth: float
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
        Compression positive [N].

    Raises
    ------
    InputError
        If a number is refused, or the section is hollow or has no bars near both faces.
    """
    load = _core.number(axial_load, "axial_load")
    if not math.isfinite(load):
        raise InputError(f"axial_load = {load} N must be a finite number")
    span = column_length(height, "height")
    if section.hollow:
        raise InputError("code values: the formulas are for solid sections; this one is hollow")
    if not section.bars:
        raise InputError("code values: the section has no bars; give it some")
    depth = section.depth
    outer = max(y for y, _, _ in section.bars), min(y for y, _, _ in section.bars)
    pulled = [bar for bar in section.bars if bar[0] >= outer[0] - _NEAR * depth]
    pressed = [bar for bar in section.bars if bar[0] <= outer[1] + _NEAR * depth]
    if outer[0] - outer[1] <= _NEAR * depth:
        raise InputError("code values: the section needs bars near both faces")
    areas = [sum(area for _, area, _ in bars) for bars in (section.bars, pulled, pressed)]
    whole, tension, compression = areas
    ties, core = section.ties, section.confinement
    strongest = max(pulled, key=lambda bar: bar[0])[2]
    round_section = section.shape == "circle"
    # Depths of codes for circles are those of their bars' centroid on one side.
    place = sum(y * a for y, a, _ in pulled) / tension
    opposite = sum(y * a for y, a, _ in pressed) / compression
    return Quantities(
        round=round_section,
        width=1e3 * section.width,
        depth=1e3 * depth,
        d=1e3 * (section.effective_depth if round_section else 0.5 * depth + place),
        d2=1e3 * (0.5 * depth + opposite),
        span=1e3 * span,
        load=load,
        fc=section.concrete_law["fc"] / _MPA,
        fy=strongest.fy / _MPA,
        es=strongest.es / _MPA,
        fyt=ties.steel.fy / _MPA if ties else 0.0,
        tension=1e6 * tension,
        compression=1e6 * compression,
        web=1e6 * (whole - tension - compression),
        bar=1e3 * float(section.bar_diameter or 0.0),
        tie_area=1e6 * ties.legs * 0.25 * math.pi * ties.diameter**2 if ties else 0.0,
        spacing=1e3 * ties.spacing if ties else math.inf,
        core_width=1e3 * core.width if core else 0.0,
        core_depth=1e3 * core.depth if core else 0.0,
        legs=float(ties.legs) if ties else 0.0,
        legs_across=float(ties.legs_across or 0.0) if ties else 0.0,
        hoop_ratio=core.ratio if core else 0.0,
        gross_area=1e6 * section.gross_area,
    )
