"""The panel of a node, where beams and columns cross: its strength, and its rotational spring.

Strength of panels with hoops by class: ACI 318-19, table 18.8.4.3. ASCE 41-17, table 10-12, has the
same numbers for hoops at half of the depth of the column or closer, and lower ones for others. The
spring of a panel without hoops cracks and fails at principal tensions (Pampanin and others;
O'Reilly and Sullivan, J. Earthquake Eng. 23 (2019) 1262-1296). Panels wear with their work as the
shear springs of members do.

Beams with slabs end in nodes: width of the flange, and rigid ends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.model.materials import Ties
from rbsdem.model.shape import RectangularSection, Section, checked_section
from rbsdem.model.springs import Pinching
from rbsdem.section.curvature import carried_load
from rbsdem.section.parameters import parameters
from rbsdem.section.shear import least_endurance
from rbsdem.section.strength import nominal_moment

PanelClass = Literal["interior", "exterior", "knee"]

#: sqrt(f_c) in psi to MPa.
_PSI = 0.083
#: Shear stress over sqrt(f_c) [psi], without and with transverse beams on both sides.
_WITH_HOOPS = {"interior": (15.0, 20.0), "exterior": (12.0, 15.0), "knee": (8.0, 12.0)}
_WITHOUT_HOOPS = {"interior": (10.0, 12.0), "exterior": (6.0, 8.0), "knee": (4.0, 4.0)}

#: Principal tension at the first crack over sqrt(f_c) [MPa].
_CRACKING = 0.29
#: The same at the peak: beam bars that go through, and bars that end in hooks.
_PEAK_THROUGH, _PEAK_HOOKED = 0.42, 0.132
#: Shear strains of panels without hoops: at the first crack, at the peak, and where it ends. Those
#: with hooked bars have `_LEFT` of their strength there.
_STRAIN_CRACKED, _STRAIN_PEAK, _STRAIN_END = 0.0002, 0.0132, 0.020
_LEFT = 0.053 / 0.132
#: Pinching of the loops: force and place of the break.
_PINCHING = {"kappa_f": 0.2, "kappa_d": 0.4}

#: Twice what the hoops carry over the strength, below which fewer of them change nothing more: the
#: bars of the columns hold the panel together, and a cycle at its peak takes a seventh.
_FEWEST = 0.316

#: Plastic shear strains with hoops where the strength is lost and where the share c is left, of
#: interior panels and of others (ASCE 41-17, table 10-11, low axial load): lower bounds.
_PLASTIC = {"interior": (0.015, 0.030), "exterior": (0.010, 0.020), "knee": (0.010, 0.020)}
_RESIDUAL = 0.2


def panel_strength(
    fc: float, at: PanelClass, *, hoops: bool = True, transverse_beams: bool = False
) -> float:
    """Return the shear stress that a panel reaches [Pa].

    Parameters
    ----------
    fc : float
        Strength of the concrete [Pa].
    at : {"interior", "exterior", "knee"}
        Class: column and beam go on beyond the node, one of them ends in it, or both do.
    hoops : bool, optional
        Whether there are hoops in the panel, at half of the depth of the column or closer.
    transverse_beams : bool, optional
        Whether transverse beams cover three quarters of both sides.

    Returns
    -------
    float
        gamma sqrt(f_c): with hoops 15 sqrt(psi) for an interior panel, 12 for an exterior one, 8
        for a knee, and 20, 15, 12 between transverse beams; without hoops 10, 6, 4 and 12, 8, 4.

    Raises
    ------
    InputError
        If an argument is refused.
    """
    fc = _arguments.number(fc, "panel_strength: fc", above=0.0)
    at = _arguments.choice(at, "panel_strength: at", get_args(PanelClass))
    table = _WITH_HOOPS if hoops else _WITHOUT_HOOPS
    return _PSI * table[at][bool(transverse_beams)] * math.sqrt(fc / 1e6) * 1e6


@dataclass(frozen=True)
class JointPanel:
    """The panel of a node, from the drawing of the column and the beam that cross in it.

    Parameters
    ----------
    column, beam : RectangularSection
        Sections of the column and of the deepest beam.
    at : {"interior", "exterior", "knee"}, optional
        Class: column and beam go on beyond the node, one of them ends in it, or both do.
    hoops : Ties, optional
        Hoops in the panel; None: there are none. Those further apart than half of the depth of the
        column do not count.
    transverse_beams : bool, optional
        Whether transverse beams cover three quarters of both sides.
    eccentricity : float, optional
        From the axis of the column to that of the beam, across the frame [m].
    axial_load : float, optional
        On the panel, compression positive [N].
    beam_length, column_height : float, optional
        From the axis of the column to the point of the beam without moment, and between the points
        of the columns above and below without moment [m]. They refine the lever arm.

    Raises
    ------
    InputError
        If an argument is refused.
    """

    column: RectangularSection
    beam: RectangularSection
    at: PanelClass = "interior"
    hoops: Ties | None = None
    transverse_beams: bool = False
    eccentricity: float = 0.0
    axial_load: float = 0.0
    beam_length: float | None = None
    column_height: float | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "JointPanel")
        _arguments.choice(self.at, "JointPanel: at", get_args(PanelClass))
        for name, least in (
            ("beam_length", 0.5 * self.column.depth),
            ("column_height", self.beam.depth),
        ):
            length = getattr(self, name)
            if length is not None and not length > least:
                raise InputError(
                    f"JointPanel: {name} = {length:g} m ends inside the panel, at {least:g} m; it "
                    "goes to the point of the member without moment"
                )
        if not 2.0 * abs(self.eccentricity) < self.column.width:
            raise InputError(
                f"JointPanel: eccentricity = {self.eccentricity:g} m puts the axis of the beam "
                f"outside of the column, which is {self.column.width:g} m wide"
            )
        if self.hoops is not None:
            _arguments.instance(self.hoops, "JointPanel: hoops", Ties)
        if not self._tension_left > 0.0:
            raise InputError(
                f"JointPanel: axial_load = {self.axial_load:g} N pulls the concrete of the "
                "panel apart"
            )

    @property
    def width(self) -> float:
        """Effective width (ACI 318-19, 18.8.4.3): b + h_c, b + 2x, at most that of the column [m].

        x is the smaller distance from the side of the beam to that of the column.
        """
        column, beam = self.column, self.beam
        beside = 0.5 * (column.width - beam.width) - abs(self.eccentricity)
        return min(beam.width + column.depth, beam.width + 2.0 * max(beside, 0.0), column.width)

    @property
    def area(self) -> float:
        """Effective area of the panel, A_j [m2]."""
        return self.width * self.column.depth

    @property
    def confined(self) -> bool:
        """Whether it has hoops that count."""
        return self.hoops is not None and self.hoops.spacing <= 0.5 * self.column.depth

    @property
    def lever(self) -> float:
        """Sum of the moments of the beams at the axis over the shear force of the panel [m].

        The depth of the beam; with `beam_length` L and `column_height` H that of the free body,
        L/((L - h_c/2)/(0.9 h_b) - L/H) (Hassan and Moehle 2012, equation 2.1).
        """
        if self.beam_length is None or self.column_height is None:
            return self.beam.depth
        length = self.beam_length
        inner = (length - 0.5 * self.column.depth) / (0.9 * self.beam.depth)
        return length / (inner - length / self.column_height)

    @property
    def strength(self) -> float:
        """Shear force that the panel reaches, V_j [N]."""
        if self.confined:
            fc = self.column.concrete.fc
            return self.area * panel_strength(fc, self.at, transverse_beams=self.transverse_beams)
        through = self.at == "interior"
        return self._shear_at(_PEAK_THROUGH if through else _PEAK_HOOKED, hooked=not through)

    @property
    def moment(self) -> float:
        """Moment that the panel reaches [N m]."""
        return self.strength * self.lever

    @property
    def stiffness(self) -> float:
        """Moment over shear strain before the first crack, with G = E_c/2.4 [N m/rad]."""
        return self.column.concrete_law["ec"] / 2.4 * self.area * self.lever

    def spring(self) -> Pinching:
        """Return the rotational spring between columns and beams.

        Its cracking point is the first diagonal crack; it yields where the panel reaches its
        strength, and its cap is where it begins to lose it. Its work wears it down: the energy that
        halves its strength is the `shear_endurance` of the model, for panels whose hoops carry less
        than half of it in proportion to the square of that share, down to a tenth.
        """
        lines = self._lines()
        given = parameters()
        if not given.shear_endurance > 0.0:
            return lines
        # Few hoops do not hold a crack together.
        lasts = min(1.0, max(2.0 * self._hoops / self.strength, _FEWEST) ** 2)
        first = lines.f_c / lines.d_c if lines.d_c and lines.f_c else lines.f_y / lines.d_y
        unit = lines.f_y * lines.d_y
        soonest = lines.f_cap**2 * (1.0 + lines.d_cap / lines.d_pc) / (first * unit)
        lambda_s = least_endurance(given.shear_endurance * lasts, soonest)
        return replace(lines, lambda_s=lambda_s, fade=2.0, b0=given.shear_b0)

    @property
    def _hoops(self) -> float:
        """Shear force that the hoops carry in the depth of the beam [N]."""
        if self.hoops is None or not self.confined:
            return 0.0
        area = self.hoops.legs * math.pi * self.hoops.diameter**2 / 4.0
        return area * self.hoops.steel.fy * 0.9 * self.beam.depth / self.hoops.spacing

    def _lines(self) -> Pinching:
        """Return the spring as it is without wear."""
        peak = self.moment
        if self.hoops is not None and self.confined:
            first = self.lever * self._shear_at(_CRACKING, hooked=False)
            first = min(first, 0.9 * peak)
            cracked = first / self.stiffness
            # A truss of hoops and of concrete at 45 degrees (Park and Paulay 1975, section 7.4).
            legs = self.hoops.legs * math.pi * self.hoops.diameter**2 / 4.0
            ratio = legs / (self.width * self.hoops.spacing)
            modulus = self.hoops.steel.es
            truss = ratio * modulus / (1.0 + 4.0 * ratio * modulus / self.column.concrete_law["ec"])
            reached = min(peak / (truss * self.area * self.lever), _STRAIN_PEAK)
            reached = max(reached, 1.5 * cracked)
            lost, ended = _PLASTIC[self.at]
            return Pinching(
                d_c=cracked, f_c=first, d_y=reached, f_y=peak, d_cap=reached + lost, f_cap=peak,
                d_pc=(ended - lost) / (1.0 - _RESIDUAL), f_res=_RESIDUAL * peak, **_PINCHING,
            )  # fmt: skip
        fall = (_STRAIN_END - _STRAIN_PEAK) / (1.0 - _LEFT)
        if self.at == "interior":
            first = self.lever * self._shear_at(_CRACKING, hooked=False)
            return Pinching(
                d_c=_STRAIN_CRACKED, f_c=first, d_y=_STRAIN_PEAK, f_y=peak, d_cap=_STRAIN_END,
                f_cap=peak, d_pc=fall, f_res=_LEFT * peak, **_PINCHING,
            )  # fmt: skip
        # With hooked bars the panel reaches its strength at the first crack.
        return Pinching(
            d_y=_STRAIN_CRACKED, f_y=peak, d_cap=_STRAIN_PEAK, f_cap=peak, d_pc=fall,
            f_res=_LEFT * peak, **_PINCHING,
        )  # fmt: skip

    @property
    def _tension_left(self) -> float:
        """Share of the cracking tension that the axial load leaves."""
        fc = self.column.concrete.fc
        tension = min(_CRACKING, _PEAK_HOOKED) * math.sqrt(fc / 1e6) * 1e6
        return 1.0 + self.axial_load / (self.column.gross_area * tension)

    def _shear_at(self, kappa: float, *, hooked: bool) -> float:
        """Return the shear force at a principal tension of kappa sqrt(f_c) [N].

        By Mohr's circle, V = A p_t sqrt(1 + N/(A p_t)). Beam bars that are hooked into the panel
        press on it with V h_b/h_c in addition to the axial load.
        """
        area = self.column.gross_area if not self.confined else self.area
        tension = kappa * math.sqrt(self.column.concrete.fc / 1e6) * 1e6
        q = 0.5 * self.beam.depth / self.column.depth if hooked else 0.0
        return area * tension * (q + math.sqrt(q**2 + 1.0 + self.axial_load / (area * tension)))


def flange_width(
    web: float, thickness: float, clear_span: float, clear_distance: float, *, sides: int = 2
) -> float:
    """Return the effective width of a slab as the flange of a beam, with its web [m].

    Parameters
    ----------
    web : float
        Width of the web, b_w [m].
    thickness : float
        Thickness of the slab, h [m].
    clear_span : float
        Of the beam, l_n [m].
    clear_distance : float
        From web to web, s_w [m].
    sides : {1, 2}, optional
        Sides of the web with a slab: two of a tee, one of an L-section.

    Returns
    -------
    float
        b_w + 2 min(8 h, s_w/2, l_n/8), or b_w + min(6 h, s_w/2, l_n/12) of an L-section.

    Raises
    ------
    InputError
        If an argument is refused.

    Notes
    -----
    ACI 318-19, table 6.3.2.1. Where the slab is in tension, its bars within the same width count
    (18.7.3.2); tests have that much at 2 % drift (French and Moehle 1991).
    """
    sizes = {
        "web": web, "thickness": thickness, "clear_span": clear_span,
        "clear_distance": clear_distance,
    }  # fmt: skip
    b_w, h, l_n, s_w = (
        _arguments.number(value, f"flange_width: {name}", above=0.0)
        for name, value in sizes.items()
    )
    if _arguments.integer(sides, "flange_width: sides") not in (1, 2):
        raise InputError(f"flange_width: sides = {sides} must be 1 or 2")
    times, part = (8.0, 8.0) if sides == 2 else (6.0, 12.0)
    return b_w + sides * min(times * h, 0.5 * s_w, l_n / part)


def rigid_ends(
    columns: Section | Sequence[Section],
    beams: Section | Sequence[Section],
    *,
    axial_load: float | Sequence[float] = 0.0,
    share: float | Literal["asce"] = "asce",
) -> tuple[float, float]:
    """Return the `rigid_end` of the columns and of the beams in a node [m].

    Parameters
    ----------
    columns, beams : Section or sequence of Section
        All columns that meet in the node, and all beams.
    axial_load : float or sequence of float, optional
        Compression of the columns, of all or of each [N].
    share : float or "asce", optional
        Which part of the node is rigid in both, from 0 (members reach to the axes) to 1 (to the
        faces); by default by the rule of ASCE 41-17, 10.4.2.2.1: where the columns are stronger
        than 1.2 times the beams, the columns are rigid in the node; where they are weaker than 0.8
        times the beams, the beams are; between, half of both.

    Returns
    -------
    tuple of float
        Of the columns: a share of half the depth of the deepest beam. Of the beams: a share of half
        the depth of the deepest column.

    Raises
    ------
    InputError
        If an argument is refused.

    Notes
    -----
    Strengths are sums of the nominal moments of ACI 318-19; of members with unlike faces the means
    of both, as in a node with a beam on each side, or where the load comes from both sides.
    """
    sections = [
        [
            section if isinstance(section, Section) else checked_section(section)
            for section in ([members] if isinstance(members, Section) else members)
        ]
        for members in (columns, beams)
    ]
    if not all(sections):
        raise InputError("rigid_ends: a node has one column and one beam at least; give them")
    if share == "asce":
        loads = np.broadcast_to(axial_load, len(sections[0])).tolist()
        column = sum(map(_strength, sections[0], loads))
        beam = sum(_strength(section, 0.0) for section in sections[1])
        parts = (1.0, 0.0) if column > 1.2 * beam else (0.0, 1.0)
        if 0.8 * beam <= column <= 1.2 * beam:
            parts = (0.5, 0.5)
    else:
        part = _arguments.number(share, "rigid_ends: share", least=0.0, most=1.0)
        parts = part, part
    half = [0.5 * max(section.depth for section in members) for members in sections]
    return parts[0] * half[1], parts[1] * half[0]


@lru_cache(maxsize=1024)
def _strength(section: Section, axial_load: float) -> float:
    """Return the mean of the nominal moments to both sides [N m]."""
    moments = [
        nominal_moment(face, carried_load(axial_load, face)) for face in (section, section.mirrored)
    ]
    if not math.isfinite(sum(moments)):
        raise InputError(
            f"rigid_ends: axial_load = {axial_load:g} N is more than ACI 318-19 gives the section"
        )
    return 0.5 * sum(moments)
