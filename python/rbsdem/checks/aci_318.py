"""ACI 318-19: clauses that checks of frames use, as functions of plain numbers (MPa, mm, N)."""

from __future__ import annotations

import math

from rbsdem.section.strength import block_share

#: Strain of the extreme fibre in compression (22.2.2.1).
ULTIMATE_STRAIN = 0.003


def balanced_ratio(fc: float, fy: float, es: float) -> float:
    """Return the steel ratio A_s/(b d) at which bars yield as the concrete crushes (22.2).

    0.85 beta_1 (f'c/f_y) 0.003/(0.003 + f_y/E_s).

    Parameters
    ----------
    fc, fy, es : float
        Strength of the concrete, yield stress and modulus of the bars [MPa].
    """
    crushing = ULTIMATE_STRAIN / (ULTIMATE_STRAIN + fy / es)
    return 0.85 * block_share(fc) * fc / fy * crushing


def one_way_shear(fc: float, width: float, depth: float) -> float:
    """Return the least V_c of members with stirrups, 0.17 sqrt(f'c) b_w d [N] (22.5.5.1).

    Parameters
    ----------
    fc : float
        Strength of the concrete [MPa].
    width, depth : float
        b_w and d [mm].
    """
    return 0.17 * math.sqrt(fc) * width * depth


def stirrups(area: float, fyt: float, depth: float, spacing: float) -> float:
    """Return V_s = A_v f_yt d/s [N] (22.5.8.5.3).

    Parameters
    ----------
    area, fyt : float
        Area of the legs in the direction of the shear [mm2], and their yield stress [MPa].
    depth, spacing : float
        d and s [mm].
    """
    return area * fyt * depth / spacing


def wall_shear(
    fc: float, area: float, slenderness: float, tie_ratio: float, tie_yield: float
) -> float:
    """Return the nominal shear strength of a wall [N] (18.10.4.1, 18.10.4.4).

    A_cv (alpha_c sqrt(f'c) + rho_t f_yt), alpha_c from 0.25 for walls as high as 1.5 lengths to
    0.17 from 2 on, and at most 0.83 sqrt(f'c) A_cv. Clauses and numbers are from memory: check them
    with your code.

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


def wall_drift(length: float, width: float, axis: float, shear_stress: float, fc: float) -> float:
    """Return the drift capacity of a wall with special boundary elements (18.10.6.2b).

    (4 - l_w c/(50 b^2) - V_e/(0.66 sqrt(f'c) A_cv))/100 of the height, 0.015 at the least. From
    memory: check it with your code.

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
