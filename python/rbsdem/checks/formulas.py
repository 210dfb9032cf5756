"""Formulas of codes and regressions, and the quantities of a drawing that they use.

The functions of ASCE 41 are those of ASCE 41-17, chapter 10 (ACI 369.1-17), those of EC 8 those of
EN 1998-3:2005, annex A, for rectangles: mean values, gamma_el = 1; that code divides by 1.5 (A.1),
1.8 (A.3) and 1.15 (A.12) in primary elements.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from rbsdem.errors import InputError
from rbsdem.model.materials import Bar
from rbsdem.model.shape import Section, checked_section
from rbsdem.section.curvature import (
    carried_load,
    column_length,
    hardening_share,
    hinge_length,
    strain_penetration,
)

# ---- The quantities of a drawing that formulas of codes use, in the units they are written in ----

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


# ---- ASCE 41-17, chapter 10 (ACI 369.1-17): stiffness, shear strength, plastic rotations ---------


@dataclass(frozen=True)
class Rotations:
    """Plastic rotations of the backbone and acceptance criteria [rad].

    Attributes
    ----------
    a, b : float
        Up to the loss of lateral strength, and of the axial load.
    c : float
        Residual strength over strength.
    """

    a: float
    b: float
    c: float

    @property
    def io(self) -> float:
        """Immediate occupancy."""
        return min(0.15 * self.a, 0.005)

    @property
    def ls(self) -> float:
        """Life safety."""
        return 0.5 * self.b

    @property
    def cp(self) -> float:
        """Collapse prevention."""
        return 0.7 * self.b


def asce_41_stiffness(axial_load_ratio: float) -> float:
    """Return E I_eff/(E_c I_g): 0.3 up to 0.1 f'c A_g, 0.7 from 0.5 on (table 10-5)."""
    return min(max(0.3 + (axial_load_ratio - 0.1), 0.3), 0.7)


def asce_41_shear_strength(q: Quantities, ductility: float = 1.0) -> float:
    """Return V_Col [N] (10.4.2.3.1, normal-weight concrete).

    k (alpha A_v f_yt d/s + 0.5 sqrt(f'c)/(M/(V d)) sqrt(1 + N/(0.5 sqrt(f'c) A_g)) 0.8 A_g), with
    M/(V d) from 2 to 4; k = 1 up to a displacement ductility of 2, 0.7 from 6 on; alpha = 1 up to
    s/d = 0.75, 0 from 1 on.

    Parameters
    ----------
    q : Quantities
        The column.
    ductility : float, optional
        Displacement over that at yield.
    """
    tensile = 0.5 * math.sqrt(q.fc)
    slender = min(max(q.span / q.d, 2.0), 4.0)
    pressed = math.sqrt(max(1.0 + q.load / (tensile * q.gross_area), 0.0))
    concrete = tensile / slender * pressed * 0.8 * q.gross_area
    share = min(max((1.0 - q.spacing / q.d) / 0.25, 0.0), 1.0)
    ties = share * q.tie_area * q.fyt * q.d / q.spacing
    return min(max(1.15 - 0.075 * ductility, 0.7), 1.0) * (ties + concrete)


def asce_41_rotations(
    axial_load_ratio: float,
    tie_ratio: float,
    shear_ratio: float,
    fc: float,
    fyt: float,
    *,
    circle: bool = False,
) -> Rotations:
    """Return plastic rotations of columns not controlled by splices (tables 10-8, 10-9).

    Parameters
    ----------
    axial_load_ratio : float
        N/(A_g f'c).
    tie_ratio : float
        A_v/(b s); taken as 0.0175 at most. Below 0.0005 the relations do not apply.
    shear_ratio : float
        Shear at flexural yield over `asce_41_shear_strength` at low ductility; 0.2 at least.
    fc, fyt : float
        Strengths of concrete and ties [MPa].
    circle : bool, optional
        Table 10-9, for circles.
    """
    nu, rho, r = axial_load_ratio, min(tie_ratio, 0.0175), max(shear_ratio, 0.2)
    if circle:
        a = max(0.06 - 0.06 * nu + 1.3 * rho - 0.037 * r, 0.0)
    else:
        a = max(0.042 - 0.043 * nu + 0.63 * rho - 0.023 * r, 0.0)
    top = 0.65 if circle else 0.5

    def loss(pressed: float) -> float:
        return top / (5.0 + max(pressed, 0.1) / 0.8 / rho * fc / fyt) - 0.01

    b = loss(nu) if nu <= 0.5 else loss(0.5) * max(0.7 - nu, 0.0) / 0.2
    return Rotations(a, max(a, b), max(0.24 - 0.4 * nu, 0.0))


# ---- EN 1998-3:2005, annex A: chord rotations and shear strength of rectangular columns ----------


def ec_8_confinement(q: Quantities) -> float:
    """Return alpha of (A.2); bars at the legs of the hoops, evenly spaced, are held.

    Legs along the depth hold bars of the two faces along the width, legs across it those of the
    sides.
    """
    if not min(q.core_width, q.core_depth) > 0:
        return 0.0
    sides = 0.0
    for legs, length in ((q.legs, q.corner_width), (q.legs_across, q.d - q.d2)):
        gaps = max(legs - 1.0, 1.0)
        sides += 2.0 * gaps * (length / gaps) ** 2
    held = max(1.0 - sides / (6.0 * q.core_width * q.core_depth), 0.0)
    for core in (q.core_width, q.core_depth):
        held *= max(1.0 - 0.5 * q.spacing / core, 0.0)
    return held


def ec_8_ultimate_rotation(q: Quantities) -> float:
    """Return theta_um of (A.1), the whole chord rotation [rad]."""
    steel, slender = (_steel(q) * q.fc) ** 0.225, min(9.0, q.slenderness) ** 0.35
    return float(0.016 * 0.3 ** _nu(q) * steel * slender * 25.0 ** _confined(q))


def ec_8_plastic_rotation(q: Quantities) -> float:
    """Return theta_um,pl of (A.3), its plastic part [rad]."""
    steel, slender = _steel(q) ** 0.3, min(9.0, q.slenderness) ** 0.35
    return float(0.0145 * 0.25 ** _nu(q) * steel * q.fc**0.2 * slender * 25.0 ** _confined(q))


def ec_8_yield_rotation(q: Quantities, *, cracked: bool) -> float:
    """Return theta_y of (A.10b) [rad].

    Parameters
    ----------
    q : Quantities
        The column.
    cracked : bool
        Whether diagonal cracks come before yield, which shifts the tension (a_V = 1).
    """
    curvature = yield_point(q)[0]
    bent = curvature * (q.span + (q.d - q.d2 if cracked else 0.0)) / 3.0
    sheared = 0.0014 * (1.0 + 1.5 * q.depth / q.span)
    return bent + sheared + curvature * q.bar * q.fy / (8.0 * math.sqrt(q.fc))


def ec_8_cracks_in_shear(q: Quantities) -> bool:
    """Return whether the shear at yield is beyond V_R,c of EN 1992-1-1, 6.2.2 (mean)."""
    size = min(1.0 + math.sqrt(200.0 / q.d), 2.0)
    steel = min(q.tension / (q.width * q.d), 0.02)
    pressed = min(q.load / q.gross_area, 0.2 * q.fc)
    stress = 0.18 * size * (100.0 * steel * q.fc) ** (1.0 / 3.0)
    stress = max(stress, 0.035 * size**1.5 * math.sqrt(q.fc)) + 0.15 * pressed
    return bool(stress * q.width * q.d < yield_point(q)[1] / q.span)


def ec_8_shear_resistance(q: Quantities, plastic_ductility: float = 0.0) -> float:
    """Return V_R of (A.12), controlled by the stirrups [N].

    Parameters
    ----------
    q : Quantities
        The column.
    plastic_ductility : float, optional
        Displacement over that at yield, less one.
    """
    area = q.width * q.d
    strut = (q.depth - yield_point(q)[2] * q.d) / (2.0 * q.span)
    strut *= min(q.load, 0.55 * area * q.fc)
    concrete = 0.16 * max(0.5, 100.0 * q.steel_ratio) * (1.0 - 0.16 * min(5.0, q.slenderness))
    ties = q.tie_area / q.spacing * (q.d - q.d2) * q.fyt
    falling = 1.0 - 0.05 * min(5.0, max(plastic_ductility, 0.0))
    return strut + falling * (concrete * math.sqrt(q.fc) * area + ties)


def ec_8_joint_strength(
    fc: float, width: float, depth: float, axial_load_ratio: float, *, exterior: bool
) -> float:
    """Return the horizontal shear at which the diagonal strut of a joint crushes [N].

    EN 1998-1:2004, 5.5.3.3: eta f_c sqrt(1 - nu_d/eta) b_j h_jc with eta = 0.6 (1 - f_c/250), and
    0.8 of it where beams do not come from both sides.

    Parameters
    ----------
    fc : float
        Strength of the concrete [MPa].
    width, depth : float
        b_j, and h_jc between the outer bars of the column [mm].
    axial_load_ratio : float
        nu_d of the column above the joint.
    exterior : bool
        Whether a side is without a beam.
    """
    eta = 0.6 * (1.0 - fc / 250.0)
    left = math.sqrt(max(1.0 - axial_load_ratio / eta, 0.0))
    return (0.8 if exterior else 1.0) * eta * fc * width * depth * left


def aci_318_wall_shear(
    fc: float, area: float, slenderness: float, tie_ratio: float, tie_yield: float
) -> float:
    """Return the nominal shear strength of a wall, ACI 318-19, 18.10.4.1 and 18.10.4.4 [N].

    A_cv (alpha_c sqrt(f'c) + rho_t f_yt), alpha_c from 0.25 for walls as high as 1.5 lengths to
    0.17 from 2 on, and at most 0.83 sqrt(f'c) A_cv.

    Parameters
    ----------
    fc : float
        Cylinder strength f'c [MPa].
    area : float
        A_cv, of length and thickness of the web [mm2].
    slenderness : float
        Height over length of the wall, h_w/l_w; M/(V l_w) for a wall with a force at its top.
    tie_ratio, tie_yield : float
        Ratio of the horizontal bars, rho_t, and their yield stress [-, MPa].
    """
    alpha = min(max(0.25 - 0.16 * (slenderness - 1.5), 0.17), 0.25)
    root = math.sqrt(fc)
    return area * min(alpha * root + tie_ratio * tie_yield, 0.83 * root)


def aci_318_wall_drift(
    length: float, width: float, axis: float, shear_stress: float, fc: float
) -> float:
    """Return the drift capacity of a wall with special boundary elements, ACI 318-19, 18.10.6.2(b).

    (4 - l_w c/(50 b^2) - V_e/(0.66 sqrt(f'c) A_cv))/100 of the height, 0.015 at the least.

    Parameters
    ----------
    length, width, axis : float
        Length of the wall l_w, width of its zone in compression b, and depth of the neutral axis c
        at the nominal moment under the axial load, in one unit.
    shear_stress, fc : float
        V_e/A_cv and the cylinder strength [MPa].
    """
    slender = length * axis / (50.0 * width**2)
    return max(0.01 * (4.0 - slender - shear_stress / (0.66 * math.sqrt(fc))), 0.015)


def wall_drift_at_loss(length: float, width: float, axis: float) -> float:
    """Return the drift at which a wall that bends has lost a fifth of its strength.

    0.078 (l_w c/b^2)^-0.41, l_w c/b^2 from 5 to 55: fitted to 39 walls of 20 publications that
    bent, alone or with shear, and lost 15 % and more (`studies/walls_measured.py`); test over this
    1.02, standard deviation of logarithms 0.29 with publications left out (ACI 318-19,
    18.10.6.2(b): 0.33).

    Parameters
    ----------
    length, width, axis : float
        As for `aci_318_wall_drift`.
    """
    slender = min(max(length * axis / width**2, 5.0), 55.0)
    return 0.078 * math.exp(-0.41 * math.log(slender))


def _nu(q: Quantities) -> float:
    return q.load / (q.width * q.depth * q.fc)


def _steel(q: Quantities) -> float:
    """Return max(0.01, omega')/max(0.01, omega) with the bars between counted in tension."""
    concrete = q.width * q.d * q.fc
    pulled = (q.tension * q.fy + q.web * q.fy_web) / concrete
    return max(0.01, q.compression * q.fy_compression / concrete) / max(0.01, pulled)


def _confined(q: Quantities) -> float:
    return ec_8_confinement(q) * q.tie_ratio * q.fyt / q.fc


# ---- Yield of a rectangular section in closed form, and lengths of plastic hinges ----------------


def yield_point(q: Quantities, modulus: float | None = None) -> tuple[float, float, float]:
    """Return curvature [1/mm], moment [N mm] and relative depth of the neutral axis at yield.

    Panagiotakos and Fardis 2001, eqs 1 to 6: yield of the bars in tension, or a strain of
    1.8 f'c/E_c of the concrete, whichever comes first.

    Parameters
    ----------
    q : Quantities
        The column; a rectangle.
    modulus : float, optional
        Of the concrete [MPa]; 4700 sqrt(f'c) by default.
    """
    ec = 4700.0 * math.sqrt(q.fc) if modulus is None else modulus
    area = q.width * q.d
    rho, rho2, web = (each / area for each in (q.tension, q.compression, q.web))
    n, cover = q.es / ec, q.d2 / q.d
    found = []
    for steel in (True, False):
        load = q.load / (area * q.fy) if steel else -q.load / (1.8 * n * area * q.fc)
        a = rho + rho2 + web + load
        b = rho + rho2 * cover + 0.5 * web * (1.0 + cover)
        if steel:
            b += load
        deep = math.sqrt((n * a) ** 2 + 2.0 * n * b) - n * a
        strain = q.fy / (q.es * (1.0 - deep) * q.d) if steel else 1.8 * q.fc / (ec * deep * q.d)
        found.append((strain if strain > 0 else math.inf, deep))
    curvature, deep = min(found)
    concrete = 0.5 * ec * deep**2 * (0.5 * (1.0 + cover) - deep / 3.0)
    bars = (1.0 - deep) * rho + (deep - cover) * rho2 + web * (1.0 - cover) / 6.0
    moment = q.width * q.d**3 * curvature * (concrete + 0.5 * q.es * (1.0 - cover) * bars)
    return curvature, moment, deep


def hinge_length_priestley(q: Quantities) -> float:
    """Return the hinge length of Priestley, Calvi, Kowalsky 2007 [mm].

    k L + L_sp, at least 2 L_sp; k = 0.2 (f_u/f_y - 1) up to 0.08, L_sp = 0.022 f_y d_b. NaN where
    the tensile strength of the bars is not known.
    """
    if math.isnan(q.fu):
        return math.nan
    slip = 1e6 * strain_penetration(q.fy, q.bar)
    return hinge_length(hardening_share(q.fy, q.fu), q.span, slip)


def hinge_length_paulay(q: Quantities) -> float:
    """Return the hinge length 0.08 L + 0.022 d_b f_y of Paulay, Priestley 1992 [mm]."""
    return 0.08 * q.span + 1e6 * strain_penetration(q.fy, q.bar)


# ---- Regressions on tests: Elwood and Eberhard, Haselton, Berry and Eberhard, Goodnight ----------


def elwood_eberhard_stiffness(q: Quantities) -> float:
    """Return E I_eff/(E I_g) of Elwood, Eberhard 2009, eq 18; 329 columns, 25 % scatter.

    (0.45 + 2.5 nu)/(1 + 110 (d_b/h)(h/a)), from 0.2 to 1.
    """
    ratio = (0.45 + 2.5 * q.axial_load_ratio) / (1.0 + 110.0 * q.bar / q.span)
    return min(max(ratio, 0.2), 1.0)


class Haselton:
    """Haselton and others 2008, 2016: backbone of a hinge; 255 rectangular columns.

    Parameters
    ----------
    q : Quantities
        The column.
    slip : bool, optional
        Whether bars can slip out of the base.
    """

    def __init__(self, q: Quantities, slip: bool = True) -> None:
        self._q = q
        self._slip = 1.0 if slip else 0.0
        self._nu = q.axial_load_ratio
        self._ties = 0.02 + 40.0 * q.tie_ratio

    @property
    def capping_rotation(self) -> float:
        """Plastic rotation up to the cap, theta_cap,pl (2016, eq 5) [rad].

        Unlike bars in compression and in tension count with the factor of 2008,
        (max(0.01, rho' f_y/f'c)/max(0.01, rho f_y/f'c))^0.225.
        """
        q = self._q
        concrete = q.width * q.d * q.fc
        pressed, pulled = (
            max(0.01, force / concrete)
            for force in (q.compression * q.fy_compression, q.tension * q.fy)
        )
        slender = q.spacing / q.bar * math.sqrt(q.fy / 100.0) if q.tie_area > 0 else 20.0
        turned = 0.12 * (1.0 + 0.55 * self._slip) * 0.16**self._nu * self._ties**0.43
        turned *= 0.54 ** (0.01 * q.fc)
        turned *= 0.66 ** (0.1 * slender)
        turned *= 2.27 ** (10.0 * q.steel_ratio)
        return float(turned * (pressed / pulled) ** 0.225)

    @property
    def post_capping_rotation(self) -> float:
        """Rotation from the cap to no strength, theta_pc (2016, eq 8), at most 0.1 [rad]."""
        return float(min(0.76 * 0.031**self._nu * self._ties**1.02, 0.10))

    @property
    def hardening(self) -> float:
        """Moment at the cap over that at yield, M_c/M_y (2008, eq 3.17)."""
        return float(1.25 * 0.89**self._nu * 0.91 ** (0.01 * self._q.fc))

    @property
    def yield_stiffness(self) -> float:
        """E I_y/(E I_g), secant to yield (2016), from 0.2 to 0.6."""
        return self._stiffness(0.30, 0.72, 0.2, 0.6)

    @property
    def initial_stiffness(self) -> float:
        """E I_stf,40/(E I_g), secant to 40 % of yield (2016), from 0.35 to 0.8."""
        return self._stiffness(0.77, 0.43, 0.35, 0.8)

    def _stiffness(self, factor: float, power: float, least: float, most: float) -> float:
        pressed = max(0.1 + self._nu, 0.0) ** 0.80
        return float(min(max(factor * pressed * self._q.slenderness**power, least), most))


def berry_buckling_rotation(q: Quantities) -> float:
    """Return the plastic rotation at bar buckling of Berry, Eberhard 2005 [rad].

    C_0 (1 + C_1 rho_eff)/(1 + C_2 nu) (1 + C_3 L/D + C_4 d_b f_y/D).
    """
    c = (0.006, 7.190, 3.129, 0.651, 0.227) if q.round else (0.019, 1.650, 1.797, 0.012, 0.072)
    effective = q.hoop_ratio * q.fyt / q.fc
    slender = 1.0 + c[3] * q.slenderness + c[4] * q.bar * q.fy / q.depth
    return c[0] * (1.0 + c[1] * effective) / (1.0 + c[2] * q.axial_load_ratio) * slender


def berry_spalling_drift(q: Quantities) -> float:
    """Return the drift at spalling of Berry, Eberhard 2003: 1.6 % (1 - nu)(1 + L/(10 D))."""
    return 0.016 * (1.0 - q.axial_load_ratio) * (1.0 + 0.1 * q.slenderness)


def berry_buckling_drift(q: Quantities) -> float:
    """Return the drift at bar buckling of Berry, Eberhard 2003.

    3.25 % (1 + k_e rho_eff d_b/D)(1 - nu)(1 + L/(10 D)), k_e = 40, 150 for a spiral, 0 for hoops
    further apart than six diameters of a bar.
    """
    effect = 0.0
    if q.spacing <= 6.0 * q.bar:
        effect = (150.0 if q.round else 40.0) * q.hoop_ratio * q.fyt / q.fc * q.bar / q.depth
    return 0.0325 * (1.0 + effect) * (1.0 - q.axial_load_ratio) * (1.0 + 0.1 * q.slenderness)


def goodnight_buckling_strain(q: Quantities) -> float:
    """Return the tensile strain before bar buckling of Goodnight, Kowalsky, Nau; bridge columns.

    0.03 + 700 rho_s f_yh/E_s - 0.1 nu.
    """
    return 0.03 + 700.0 * q.hoop_ratio * q.fyt / q.es - 0.1 * q.axial_load_ratio


def goodnight_buckling_drift(q: Quantities) -> float:
    """Return the drift before bar buckling of Goodnight, Kowalsky, Nau; circular bridge columns.

    In per cent 0.9 - 3.13 nu + 142000 rho_s f_yh/E_s + 0.45 L/D.
    """
    percent = 0.9 - 3.13 * q.axial_load_ratio + 142000.0 * q.hoop_ratio * q.fyt / q.es
    return 0.01 * (percent + 0.45 * q.slenderness)
