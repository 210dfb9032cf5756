"""The shear spring at the foot of a column: cracks, yields its ties, fails, and pinches.

The lines up to the largest force are published relations; what comes behind them, and the pinching,
are parameters fitted to tests (`ShearParameters`). The spring needs no decision whether a column
is critical in shear: one that yields in flexure first never leaves the lines before yield.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rbsdem.model.springs import Pinching, unchecked
from rbsdem.section.strength import shear_sizes, shear_strength_mcft, shear_strength_sezen

if TYPE_CHECKING:
    from rbsdem.model.section import Section
    from rbsdem.section.hinge import HingeJoint
    from rbsdem.section.parameters import ShearParameters

__all__ = ["cracked_shear_stiffness", "shear_limits", "shear_spring"]

_ES = 200e9

# Cracked stiffness without ties, and cracking force under tension: shares of the uncracked
# stiffness and of the yield force that keep the lines of the spring apart.
_LEAST = 0.01


def cracked_shear_stiffness(section: Section) -> float:
    """Return the shear stiffness of the truss of ties and concrete struts at 45 degrees.

    Parameters
    ----------
    section : Section
        The section.

    Returns
    -------
    float
        rho_v/(1 + 4 n rho_v) E_s b d, shear force over shear strain [N].

    Notes
    -----
    Park and Paulay (1975), Reinforced Concrete Structures, 7.5.
    """
    sizes = shear_sizes(section)
    ratio = sizes.tie_ratio
    modular = _ES / section.concrete_law["ec"]
    return ratio / (1 + 4 * modular * ratio) * _ES * sizes.width * sizes.d


def shear_spring(
    section: Section,
    length: float,
    axial_load: float,
    stiffness: float,
    given: ShearParameters,
    joint: HingeJoint | None = None,
) -> Pinching:
    """Make the shear spring of a column.

    Parameters
    ----------
    section : Section
        The section at the foot.
    length : float
        From the foot to the lateral load [m].
    axial_load : float
        Compression positive [N].
    stiffness : float
        Shear stiffness before cracking, force over strain [N].
    given : ShearParameters
        Parameters of the model.
    joint : HingeJoint, optional
        The hinge, with whose work the strength decays; without it the strength does not.

    Returns
    -------
    Pinching
        Of the slip of the whole length: cracks at the share V_c of the concrete by Sezen and Moehle
        (2004), which is that of a principal tension; goes on with `cracked_shear_stiffness`; yields
        near `rbsdem.section.strength.shear_strength_mcft`. A section that is not symmetric has a
        negative side of its own, that of the section upside down.

    Raises
    ------
    InputError
        If the length is not positive.
    """
    return _shear(section, length, axial_load, stiffness, given, joint)[0]


def shear_limits(
    section: Section,
    length: float,
    axial_load: float,
    stiffness: float,
    given: ShearParameters,
) -> dict[str, tuple[float, float]]:
    """Return least and largest values of parameters, beyond which they would change nothing.

    Parameters
    ----------
    section, length, axial_load, stiffness, given
        As for `shear_spring`.

    Returns
    -------
    dict of str to (float, float)
        By the names of `ShearParameters`.
    """
    return _shear(section, length, axial_load, stiffness, given)[1]


def _shear(
    section: Section,
    length: float,
    axial_load: float,
    stiffness: float,
    given: ShearParameters,
    joint: HingeJoint | None = None,
) -> tuple[Pinching, dict[str, tuple[float, float]]]:
    """Return the spring and the limits of its parameters."""
    turned = section.turned
    positive = _side(section, length, axial_load, stiffness, given)
    sides = [positive]
    if turned is not section:
        sides.append(_side(turned, length, axial_load, stiffness, given))
    # What both sides share is that of their mean.
    unit = sum(side.line["f_y"] * side.line["d_y"] for side in sides) / len(sides)
    ties = sum(side.ties for side in sides) / len(sides)
    f_y = sum(side.line["f_y"] for side in sides) / len(sides)
    # Few ties do not hold a crack together: what the concrete carried is soon gone.
    lasts = min(1.0, max(2.0 * ties, 0.1) ** given.endurance_ties)
    # The rule refuses what would fall faster than the spring is stiff.
    soonest = 1.01 * max(side.fastest for side in sides) / (stiffness / length * unit)
    lambda_h, s_min = _decay(sides, f_y, ties, given, joint)
    ratio = axial_load / (section.concrete.fc * section.gross_area)
    closed = math.exp(given.pinch_axial * (ratio - 0.1))
    limits = {name: _widest(side.limits[name] for side in sides) for name in positive.limits}
    limits["pinch_force"] = (0.0, 1.0 / closed)
    lines = positive.line
    if len(sides) > 1:
        lines = lines | {f"{name}_neg": value for name, value in sides[1].line.items()}
    spring = unchecked(
        Pinching,
        **lines,
        lambda_s=max(given.endurance * lasts, soonest) if given.endurance > 0.0 else 0.0,
        b0=given.b0,
        kappa_f=min(given.pinch_force * closed, 1.0),
        kappa_d=given.pinch_slip,
        lambda_h=lambda_h / unit,
        s_min=s_min,
        fade=given.fade,
    )
    return spring, limits


@dataclass(frozen=True)
class _Side:
    """The spring in one direction of loading.

    Attributes
    ----------
    line : dict of str to float
        The backbone, by the names of `Pinching`.
    ties : float
        Strength of the ties over that of the spring.
    strut : float
        f'c b d [N].
    fastest : float
        f_cap^2 (1 + d_cap/d_pc) [N2], which bounds how fast the strength may fall.
    limits : dict of str to (float, float)
        Least and largest values of parameters.
    """

    line: dict[str, float]
    ties: float
    strut: float
    fastest: float
    limits: dict[str, tuple[float, float]]


def _side(
    section: Section, length: float, axial_load: float, stiffness: float, given: ShearParameters
) -> _Side:
    """Return the spring where y > 0 is in tension."""
    sizes = shear_sizes(section)
    # A section without bars in tension, which has no strength, still needs a spring with one.
    by_theory = shear_strength_mcft(section, length, axial_load)
    least = 1e-4 * sizes.fc * sizes.gross_area
    is_round = section.ties is not None and section.ties.is_round
    shaped = given.round_strength if is_round else 1.0
    f_y = max(given.strength * shaped * by_theory, least)
    f_cap = max(given.hardening, 1.0) * f_y
    by_ties = sizes.tie_area * sizes.tie_yield * sizes.d / sizes.spacing
    by_concrete = shear_strength_sezen(section, length, axial_load) - by_ties
    f_c = min(max(by_concrete, _LEAST * f_y), 0.9 * f_y)
    whole = stiffness / length
    truss = given.cracked * cracked_shear_stiffness(section) / length
    cracked = min(max(truss, _LEAST * whole), 0.9 * whole)
    d_c = f_c / whole
    d_y = d_c + (f_y - f_c) / cracked
    # Behind yield it may not go up steeper than before.
    least_rise = 1.01 * (f_cap - f_y) / cracked
    rise = max(given.cap * length, least_rise)
    fall = given.softening * length
    if given.snap_back > 0.0:
        # What falls faster than the column above springs back has no equilibrium.
        above = 3 * section.concrete_law["ec"] * section._figures["inertia"] / length**3
        fall = max(fall, f_cap / (given.snap_back * above))
    line = {
        "d_c": d_c,
        "f_c": f_c,
        "d_y": d_y,
        "f_y": f_y,
        "d_cap": d_y + rise,
        "f_cap": f_cap,
        "d_pc": fall,
        "f_res": min(given.residual * f_cap, 0.9 * f_y),
    }
    return _Side(
        line,
        (given.round_ties if is_round else 1.0) * by_ties / f_y,
        sizes.fc * sizes.width * sizes.d,
        f_cap**2 * (1.0 + (d_y + rise) / fall),
        {
            "strength": (least / (shaped * by_theory) if by_theory > 0.0 else 0.0, math.inf),
            "hardening": (1.0, math.inf),
            "cap": (least_rise / length, math.inf),
            "residual": (0.0, 0.9 * f_y / f_cap),
            "endurance": (0.0, math.inf),
        },
    )


def _widest(ends: Iterable[tuple[float, float]]) -> tuple[float, float]:
    """Return the range that holds several."""
    lows, highs = zip(*ends, strict=True)
    return min(lows), max(highs)


def _decay(
    sides: list[_Side],
    f_y: float,
    ties: float,
    given: ShearParameters,
    joint: HingeJoint | None,
) -> tuple[float, float]:
    """Return the work of the hinge that halves what can decay [J], 0: none, and what stays."""
    if joint is None or not given.decay > 0.0:
        return 0.0, 0.0
    strut = sum(side.strut for side in sides) / len(sides)
    stays = min(0.95, given.decay_ties * ties, given.decay_strut * strut / f_y)
    # What is confined keeps the interlock of its cracks.
    shelter = math.exp(min(joint.confinement / given.decay_shelter, 50.0))
    return joint.yield_work * shelter / given.decay, stays
