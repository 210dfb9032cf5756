"""ASCE 41-17 and ACI 369.1-17: each clause a function of plain numbers (MPa, mm, N, s).

Coefficients of target displacements (7.4.3.3.2), and stiffness, shear strength and rotations of
columns and beams (chapter 10).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

# ---- 7.4.3.3.2: target displacement --------------------------------------------------------------

#: Coefficient a of C_1 by the class of the site (7.4.1.3.1).
SITES = {"A": 130.0, "B": 130.0, "C": 90.0, "D": 60.0, "E": 60.0, "F": 60.0}


def mass_factor(storeys: int, period: float) -> float:
    """Return C_m of concrete moment frames (table 7-4): 1 to two storeys or above 1 s."""
    return 1.0 if storeys <= 2 or period > 1.0 else 0.9


def inelastic_factor(strength: float, period: float, site_class: str) -> float:
    """Return C_1 = 1 + (mu_strength - 1)/(a T_e^2), T_e not below 0.2 s; 1 above 1 s.

    Parameters
    ----------
    strength : float
        mu_strength; up to 1 the frame is elastic.
    period : float
        T_e [s].
    site_class : {"A", "B", "C", "D", "E", "F"}
        Class of the site.
    """
    more = max(strength - 1.0, 0.0)
    return 1.0 if period > 1.0 else 1.0 + more / (SITES[site_class] * max(period, 0.2) ** 2)


def pinching_factor(strength: float, period: float) -> float:
    """Return C_2 = 1 + ((mu_strength - 1)/T_e)^2/800; 1 above 0.7 s."""
    more = max(strength - 1.0, 0.0)
    return 1.0 if period > 0.7 else 1.0 + (more / period) ** 2 / 800.0


def negative_slope(alpha_2: float, leaning: float, *, near_field: bool) -> float:
    """Return alpha_e = alpha_PDelta + lambda (alpha_2 - alpha_PDelta), lambda 0.8 or 0.2.

    The slopes are over the effective stiffness; `leaning` is alpha_PDelta, and lambda is 0.8 near
    a fault.
    """
    return leaning + (0.8 if near_field else 0.2) * (alpha_2 - leaning)


def largest_strength(ductility: float, slope: float, period: float) -> float:
    """Return mu_max = Delta_d/Delta_y + |alpha_e|^-h/4 with h = 1 + 0.15 ln T_e.

    Parameters
    ----------
    ductility : float
        Delta_d over Delta_y.
    slope : float
        alpha_e, not 0.
    period : float
        T_e [s].
    """
    return float(ductility + abs(slope) ** -(1.0 + 0.15 * math.log(period)) / 4.0)


# ---- chapter 10: columns -------------------------------------------------------------------------


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


def column_stiffness(axial_load_ratio: float) -> float:
    """Return E I_eff/(E_c I_g): 0.3 up to 0.1 f'c A_g, 0.7 from 0.5 on (table 10-5)."""
    return min(max(0.3 + (axial_load_ratio - 0.1), 0.3), 0.7)


def column_shear_strength(
    fc: float,
    gross_area: float,
    depth: float,
    span: float,
    load: float,
    ties: tuple[float, float, float],
    ductility: float = 1.0,
) -> float:
    """Return V_Col [N] (10.4.2.3.1, normal-weight concrete).

    k (alpha A_v f_yt d/s + 0.5 sqrt(f'c)/(M/(V d)) sqrt(1 + N/(0.5 sqrt(f'c) A_g)) 0.8 A_g), with
    M/(V d) from 2 to 4; k = 1 up to a displacement ductility of 2, 0.7 from 6 on; alpha = 1 up to
    s/d = 0.75, 0 from 1 on.

    Parameters
    ----------
    fc : float
        Strength of the concrete [MPa].
    gross_area, depth, span : float
        A_g [mm2], d and M/V [mm].
    load : float
        Compression [N].
    ties : tuple of float
        A_v [mm2], f_yt [MPa] and s [mm].
    ductility : float, optional
        Displacement over that at yield.
    """
    area, fyt, spacing = ties
    tensile = 0.5 * math.sqrt(fc)
    slender = min(max(span / depth, 2.0), 4.0)
    pressed = math.sqrt(max(1.0 + load / (tensile * gross_area), 0.0))
    concrete = tensile / slender * pressed * 0.8 * gross_area
    share = min(max((1.0 - spacing / depth) / 0.25, 0.0), 1.0)
    by_ties = share * area * fyt * depth / spacing
    return min(max(1.15 - 0.075 * ductility, 0.7), 1.0) * (by_ties + concrete)


def column_rotations(
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
        Shear at flexural yield over `column_shear_strength` at low ductility; 0.2 at least.
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
        """Return b, the rotation at the loss of the axial load, up to a ratio of 0.5."""
        return top / (5.0 + max(pressed, 0.1) / 0.8 / rho * fc / fyt) - 0.01

    b = loss(nu) if nu <= 0.5 else loss(0.5) * max(0.7 - nu, 0.0) / 0.2
    return Rotations(a, max(a, b), max(0.24 - 0.4 * nu, 0.0))


# ---- chapter 10: beams ---------------------------------------------------------------------------

#: Table 10-7, row i: a, b, IO by detailing ("C" or not), (rho - rho')/rho_bal (up to 0, from 0.5)
#: and shear (up to 0.25, from 0.5 sqrt(f'c) MPa). LS = a and CP = b.
_FLEXURE = {
    True: (
        ((0.025, 0.05, 0.010), (0.02, 0.04, 0.005)),
        ((0.02, 0.03, 0.005), (0.015, 0.02, 0.005)),
    ),
    False: (
        ((0.02, 0.03, 0.005), (0.01, 0.015, 0.0015)),
        ((0.01, 0.015, 0.005), (0.005, 0.01, 0.0015)),
    ),
}
#: Row ii, members controlled by shear: IO, LS, CP by stirrups at d/2 or closer.
_SHEAR_CONTROLLED = {True: (0.0015, 0.01, 0.02), False: (0.0015, 0.005, 0.01)}


def beam_rotations(
    bars: float, shear: float, *, conforming: bool
) -> tuple[float, float, float, float]:
    """Return a, b, IO and c of beams controlled by flexure (ASCE 41-17, table 10-7, row i).

    Parameters
    ----------
    bars : float
        (rho - rho')/rho_bal.
    shear : float
        V/(b_w d sqrt(f'c)) [sqrt(MPa)].
    conforming : bool
        Whether hoops in the hinge stand at d/3 or closer and carry 3/4 of the shear.
    """
    table = np.array(_FLEXURE[conforming])
    u, w = min(max(bars / 0.5, 0.0), 1.0), min(max((shear - 0.25) / 0.25, 0.0), 1.0)
    a, b, io = (1 - u) * ((1 - w) * table[0, 0] + w * table[0, 1]) + u * (
        (1 - w) * table[1, 0] + w * table[1, 1]
    )
    return float(a), float(b), float(io), 0.2


def shear_controlled_rotations(spacing_ratio: float) -> tuple[float, float, float]:
    """Return IO, LS and CP of beams controlled by shear (table 10-7, row ii).

    Parameters
    ----------
    spacing_ratio : float
        Spacing of the stirrups over d.
    """
    return _SHEAR_CONTROLLED[spacing_ratio <= 0.5]
