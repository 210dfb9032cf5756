"""EN 1998-3:2005, annex A: chord rotations and shear strength of rectangular columns.

Mean values, gamma_el = 1; the code divides by 1.5 (A.1), 1.8 (A.3) and 1.15 (A.12) in primary
elements.
"""

from __future__ import annotations

import math

from rbsdem.checks.code_drawing import Quantities
from rbsdem.checks.flexure import yield_point

__all__ = [
    "confinement_factor",
    "plastic_rotation",
    "shear_resistance",
    "ultimate_rotation",
    "yield_rotation",
]


def confinement_factor(q: Quantities) -> float:
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


def ultimate_rotation(q: Quantities) -> float:
    """Return theta_um of (A.1), the whole chord rotation [rad]."""
    ratio = _steel(q)
    return (
        0.016
        * 0.3 ** _nu(q)
        * (ratio * q.fc) ** 0.225
        * min(9.0, q.slenderness) ** 0.35
        * 25.0 ** _confined(q)
    )


def plastic_rotation(q: Quantities) -> float:
    """Return theta_um,pl of (A.3), its plastic part [rad]."""
    return (
        0.0145
        * 0.25 ** _nu(q)
        * _steel(q) ** 0.3
        * q.fc**0.2
        * min(9.0, q.slenderness) ** 0.35
        * 25.0 ** _confined(q)
    )


def yield_rotation(q: Quantities, *, cracked: bool) -> float:
    """Return theta_y of (A.10b) [rad].

    Parameters
    ----------
    q : Quantities
        The column.
    cracked : bool
        Whether diagonal cracks come before yield, which shifts the tension (a_V = 1).
    """
    curvature = yield_point(q)[0]
    shift = q.d - q.d2 if cracked else 0.0
    return (
        curvature * (q.span + shift) / 3.0
        + 0.0014 * (1.0 + 1.5 * q.depth / q.span)
        + curvature * q.bar * q.fy / (8.0 * math.sqrt(q.fc))
    )


def cracks_in_shear(q: Quantities) -> bool:
    """Return whether the shear at yield is beyond V_R,c of EN 1992-1-1, 6.2.2 (mean)."""
    size = min(1.0 + math.sqrt(200.0 / q.d), 2.0)
    steel = min(q.tension / (q.width * q.d), 0.02)
    pressed = min(q.load / q.gross_area, 0.2 * q.fc)
    stress = 0.18 * size * (100.0 * steel * q.fc) ** (1.0 / 3.0)
    stress = max(stress, 0.035 * size**1.5 * math.sqrt(q.fc)) + 0.15 * pressed
    return stress * q.width * q.d < yield_point(q)[1] / q.span


def shear_resistance(q: Quantities, plastic_ductility: float = 0.0) -> float:
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


def _nu(q: Quantities) -> float:
    return q.load / (q.width * q.depth * q.fc)


def _steel(q: Quantities) -> float:
    """Return max(0.01, omega')/max(0.01, omega) with the bars between counted in tension."""
    concrete = q.width * q.d * q.fc
    pulled = (q.tension * q.fy + q.web * q.fy_web) / concrete
    return max(0.01, q.compression * q.fy_compression / concrete) / max(0.01, pulled)


def _confined(q: Quantities) -> float:
    return confinement_factor(q) * q.tie_ratio * q.fyt / q.fc
