"""Clauses of codes applied to the quantities of a drawing, and regressions.

The clauses themselves are in `asce_41`, `en_1998` and `aci_318`. Those of EN 1998-3 are mean
values, gamma_el = 1; that code divides by 1.5 (A.1), 1.8 (A.3) and 1.15 (A.12) in primary elements.
"""

from __future__ import annotations

import math

from rbsdem.checks import asce_41, en_1998
from rbsdem.section.curvature import hardening_share, hinge_length, strain_penetration
from rbsdem.section.quantities import Quantities

# ---- clauses of codes ----------------------------------------------------------------------------


def asce_41_shear_strength(q: Quantities, ductility: float = 1.0) -> float:
    """Return V_Col of a column, `asce_41.column_shear_strength` [N]."""
    ties = q.tie_area, q.fyt, q.spacing
    return asce_41.column_shear_strength(q.fc, q.gross_area, q.d, q.span, q.load, ties, ductility)


def ec_8_confinement(q: Quantities) -> float:
    """Return alpha of (A.2); bars at the legs of the hoops, evenly spaced, are held.

    Legs along the depth hold bars of the two faces along the width, legs across it those of the
    sides.
    """
    if not min(q.core_width, q.core_depth) > 0:
        return 0.0
    gaps = []
    for legs, length in ((q.legs, q.corner_width), (q.legs_across, q.d - q.d2)):
        number = max(legs - 1.0, 1.0)
        gaps.append((2.0 * number, length / number))
    return en_1998.confinement((q.core_width, q.core_depth), q.spacing, tuple(gaps))


def ec_8_ultimate_rotation(q: Quantities) -> float:
    """Return theta_um of a column, `en_1998.ultimate_rotation` [rad]."""
    return en_1998.ultimate_rotation(_nu(q), _steel(q), q.fc, q.slenderness, _confined(q))


def ec_8_plastic_rotation(q: Quantities) -> float:
    """Return theta_um,pl of a column, `en_1998.plastic_rotation` [rad]."""
    return en_1998.plastic_rotation(_nu(q), _steel(q), q.fc, q.slenderness, _confined(q))


def ec_8_yield_rotation(q: Quantities, *, cracked: bool) -> float:
    """Return theta_y of a column, `en_1998.yield_rotation` [rad].

    Parameters
    ----------
    q : Quantities
        The column.
    cracked : bool
        Whether diagonal cracks come before yield, which shifts the tension (a_V = 1).
    """
    shift = q.d - q.d2 if cracked else 0.0
    slip = q.bar, q.fy, q.fc
    return en_1998.yield_rotation(yield_point(q)[0], q.span, q.depth, shift, slip)


def ec_8_cracks_in_shear(q: Quantities) -> bool:
    """Return whether the shear at yield is beyond `en_1998.shear_without_stirrups`."""
    ratio, pressed = q.tension / (q.width * q.d), q.load / q.gross_area
    strength = en_1998.shear_without_stirrups(q.fc, q.width, q.d, ratio, pressed)
    return bool(strength < yield_point(q)[1] / q.span)


def ec_8_shear_resistance(q: Quantities, plastic_ductility: float = 0.0) -> float:
    """Return V_R of a column, `en_1998.shear_resistance` [N]."""
    area = q.width * q.d
    strut = (q.depth - yield_point(q)[2] * q.d) / (2.0 * q.span)
    strut *= min(q.load, 0.55 * area * q.fc)
    ties = q.tie_area / q.spacing * (q.d - q.d2) * q.fyt
    sizes = strut, area, q.steel_ratio, q.slenderness, q.fc, ties
    return en_1998.shear_resistance(*sizes, plastic_ductility)


def _nu(q: Quantities) -> float:
    """Return the axial load ratio N/(b h f_c)."""
    return q.load / (q.width * q.depth * q.fc)


def _steel(q: Quantities) -> float:
    """Return max(0.01, omega')/max(0.01, omega) with the bars between counted in tension."""
    concrete = q.width * q.d * q.fc
    pulled = (q.tension * q.fy + q.web * q.fy_web) / concrete
    return max(0.01, q.compression * q.fy_compression / concrete) / max(0.01, pulled)


def _confined(q: Quantities) -> float:
    """Return alpha rho_sx f_yw/f_c, the exponent of 25 in (A.1) and (A.3)."""
    return ec_8_confinement(q) * q.tie_ratio * q.fyt / q.fc


# ---- Yield of a rectangular section in closed form, and lengths of plastic hinges ----------------


def wall_drift_at_loss(length: float, width: float, axis: float) -> float:
    """Return the drift at which a wall that bends has lost a fifth of its strength.

    0.078 (l_w c/b^2)^-0.41, l_w c/b^2 from 5 to 55: fitted to 39 walls of 20 publications that
    bent, alone or with shear, and lost 15 % and more (`studies/walls_measured.py`); tests are
    1.02 times this, standard deviation of logarithms 0.29 with publications left out (ACI 318-19,
    18.10.6.2(b): 0.33).

    Parameters
    ----------
    length, width, axis : float
        l_w, width b of the compression zone and depth c of the neutral axis, in one unit.
    """
    slender = min(max(length * axis / width**2, 5.0), 55.0)
    return 0.078 * math.exp(-0.41 * math.log(slender))


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
    points = []
    for steel in (True, False):
        load = q.load / (area * q.fy) if steel else -q.load / (1.8 * n * area * q.fc)
        a = rho + rho2 + web + load
        b = rho + rho2 * cover + 0.5 * web * (1.0 + cover)
        if steel:
            b += load
        deep = math.sqrt((n * a) ** 2 + 2.0 * n * b) - n * a
        strain = q.fy / (q.es * (1.0 - deep) * q.d) if steel else 1.8 * q.fc / (ec * deep * q.d)
        points.append((strain if strain > 0 else math.inf, deep))
    curvature, deep = min(points)
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
        """Return factor (0.1 + nu)^0.8 (L_s/h)^power between its bounds."""
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


def goodnight_buckling_drift(q: Quantities) -> float:
    """Return the drift before bar buckling of Goodnight, Kowalsky, Nau; circular bridge columns.

    In per cent 0.9 - 3.13 nu + 142000 rho_s f_yh/E_s + 0.45 L/D.
    """
    percent = 0.9 - 3.13 * q.axial_load_ratio + 142000.0 * q.hoop_ratio * q.fyt / q.es
    return 0.01 * (percent + 0.45 * q.slenderness)
