"""EN 1998: each clause a function of plain numbers (MPa, mm, N, s).

Chord rotations and shear of rectangular members by EN 1998-3:2005, annex A, mean values with
gamma_el = 1; joints by EN 1998-1:2004, 5.5.3.3; target displacements by its annex B.
"""

from __future__ import annotations

import math


def confinement(
    core: tuple[float, float], spacing: float, gaps: tuple[tuple[float, float], ...]
) -> float:
    """Return alpha, the part of the core that hoops confine (EN 1998-3, A.2).

    (1 - s/2b_0)(1 - s/2h_0)(1 - sum b_i^2/(6 b_0 h_0)).

    Parameters
    ----------
    core : tuple of float
        b_0 and h_0 between centre lines of the hoops [mm].
    spacing : float
        s [mm].
    gaps : tuple of (float, float)
        Number and length of distances b_i between held bars [mm].
    """
    wide, high = core
    sides = sum(number * length**2 for number, length in gaps)
    held = max(1.0 - sides / (6.0 * wide * high), 0.0)
    for side in core:
        held *= max(1.0 - 0.5 * spacing / side, 0.0)
    return held


def ultimate_rotation(
    nu: float, steel: float, fc: float, slenderness: float, confined: float
) -> float:
    """Return theta_um, the whole chord rotation [rad] (EN 1998-3, A.1).

    Parameters
    ----------
    nu : float
        N/(b h f_c).
    steel : float
        max(0.01, omega')/max(0.01, omega).
    fc : float
        Strength of the concrete [MPa].
    slenderness : float
        L_V/h; 9 at most.
    confined : float
        alpha rho_sx f_yw/f_c.
    """
    bars, slender = (steel * fc) ** 0.225, min(9.0, slenderness) ** 0.35
    return float(0.016 * 0.3**nu * bars * slender * 25.0**confined)


def plastic_rotation(
    nu: float, steel: float, fc: float, slenderness: float, confined: float
) -> float:
    """Return theta_um,pl, its plastic part [rad] (EN 1998-3, A.3); arguments as for (A.1)."""
    bars, slender = steel**0.3, min(9.0, slenderness) ** 0.35
    return float(0.0145 * 0.25**nu * bars * fc**0.2 * slender * 25.0**confined)


def yield_rotation(
    curvature: float, span: float, depth: float, shift: float, slip: tuple[float, float, float]
) -> float:
    """Return theta_y of beams and columns [rad] (EN 1998-3, A.10b).

    phi_y (L_V + a_V z)/3 + 0.0014 (1 + 1.5 h/L_V) + phi_y d_b f_y/(8 sqrt(f_c)).

    Parameters
    ----------
    curvature : float
        phi_y [1/mm].
    span, depth : float
        L_V and h [mm].
    shift : float
        a_V z, z = d - d' where diagonal cracks come before yield, else 0 [mm].
    slip : tuple of float
        d_b [mm], f_y and f_c [MPa].
    """
    bar, fy, fc = slip
    sheared = 0.0014 * (1.0 + 1.5 * depth / span)
    pulled_out = curvature * bar * fy / (8.0 * math.sqrt(fc))
    return curvature * (span + shift) / 3.0 + sheared + pulled_out


def shear_resistance(
    strut: float,
    area: float,
    steel_ratio: float,
    slenderness: float,
    fc: float,
    ties: float,
    plastic_ductility: float = 0.0,
) -> float:
    """Return V_R, controlled by the stirrups [N] (EN 1998-3, A.12).

    Parameters
    ----------
    strut : float
        (h - x)/(2 L_V) min(N, 0.55 A_c f_c) [N].
    area : float
        A_c = b d [mm2].
    steel_ratio : float
        rho_tot, all longitudinal bars.
    slenderness : float
        L_V/h.
    fc : float
        Strength of the concrete [MPa].
    ties : float
        V_w = rho_w b z f_yw [N].
    plastic_ductility : float, optional
        mu_Delta - 1.
    """
    concrete = 0.16 * max(0.5, 100.0 * steel_ratio) * (1.0 - 0.16 * min(5.0, slenderness))
    falling = 1.0 - 0.05 * min(5.0, max(plastic_ductility, 0.0))
    return strut + falling * (concrete * math.sqrt(fc) * area + ties)


def joint_strength(
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


def shear_without_stirrups(
    fc: float, width: float, depth: float, steel_ratio: float, pressed: float
) -> float:
    """Return V_R,c [N], mean values (EN 1992-1-1, 6.2.2).

    Parameters
    ----------
    fc : float
        Strength of the concrete [MPa].
    width, depth : float
        b and d [mm].
    steel_ratio : float
        A_sl/(b d); 0.02 at most.
    pressed : float
        N/A_c [MPa]; 0.2 f_c at most.
    """
    size = min(1.0 + math.sqrt(200.0 / depth), 2.0)
    stress = 0.18 * size * (100.0 * min(steel_ratio, 0.02) * fc) ** (1.0 / 3.0)
    stress = max(stress, 0.035 * size**1.5 * math.sqrt(fc)) + 0.15 * min(pressed, 0.2 * fc)
    return float(stress * width * depth)


def target_of_one_mass(elastic: float, strength: float, period: float, corner: float) -> float:
    """Return d_t* of annex B of EN 1998-1 (B.9 to B.11), in the unit of the elastic displacement.

    Parameters
    ----------
    elastic : float
        d_et*.
    strength : float
        q_u = S_e m*/F_y*.
    period, corner : float
        T* and T_C [s]. From T_C on the displacements are equal; below it at most 3 d_et*.
    """
    if period >= corner or strength <= 1.0:
        return elastic
    reached = elastic / strength * (1.0 + (strength - 1.0) * corner / period)
    return min(max(reached, elastic), 3.0 * elastic)
