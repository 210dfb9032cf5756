"""The bilinear shear spring of a column from the shear diagram of its section.

Its line goes through the knee of the diagram and through an end point at the ultimate curvature of
the flexural spring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem.errors import InputError
from rbsdem.model.springs import Bilinear
from rbsdem.section.shear_diagram import KNEE, ShearDiagram, ShearPoint, shear_diagram
from rbsdem.section.strength import shear_strength_mcft

if TYPE_CHECKING:
    from rbsdem.model.section import Section

__all__ = ["ShearSpring", "closed_form_shear", "fit_shear_spring"]

CLOSED_FORM_FORCE = 1.86
"""Force at the knee over that of flexural cracking, M_c/L: calibrated on the four columns of
table 3 of the paper."""

#: If the force at the end of the diagram is below this share of the peak, the peak is taken.
_FALLEN = 0.95


@dataclass(frozen=True)
class ShearSpring:
    """The bilinear shear spring of a column, with the points that it was fitted to.

    Attributes
    ----------
    spring : Bilinear
        Stiffness [N/m], yield slip [m], stiffness after yield [N/m].
    knee, end : ShearPoint
        The two points of the diagram through which its lines pass.
    strength : float
        Shear strength V_n by the simplified modified compression field theory [N].
    k_post_found : float
        Stiffness after yield before it was raised to zero or held below the first one [N/m].
    governs : bool
        Whether shear fails before the end point in flexure.
    warnings : tuple of str
        Remarks that a user should know.
    """

    spring: Bilinear
    knee: ShearPoint
    end: ShearPoint
    strength: float
    k_post_found: float
    governs: bool
    warnings: tuple[str, ...]


def fit_shear_spring(
    section: Section,
    length: float,
    axial_load: float,
    ultimate_curvature: float,
    **options: Any,
) -> ShearSpring:
    """Fit the bilinear shear spring of a column with V = M/length.

    Slip is shear strain times length. The line passes through the knee of the diagram and through
    its point at the ultimate curvature, or at the shear strength if that is reached before, or at
    the peak if the moment has fallen by more than 5 per cent: beyond that the shear flow of the
    layers is no longer meaningful.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    ultimate_curvature : float
        Curvature of the ultimate point of the flexural spring [1/m].
    **options
        As for `shear_diagram`: points, tension, confined, coupled, layers, knee.

    Returns
    -------
    ShearSpring
        The spring, its points, and warnings.

    Raises
    ------
    InputError
        If a value is refused, or the section carries no shear.
    """
    diagram = shear_diagram(section, length, axial_load, furthest=ultimate_curvature, **options)
    strength = shear_strength_mcft(section, length, axial_load)
    warnings = []
    end = _at_force(diagram, strength)
    governs = end is not None or diagram.sheared
    if end is not None:
        warnings.append(
            f"shear governs: its strength of {strength:.4g} N is below the "
            f"{diagram.force.max():.4g} N of flexure; the spring goes through it"
        )
    elif diagram.sheared:
        warnings.append(
            f"shear governs: a layer carries no more at {diagram.end.force:.4g} N, before the "
            f"ultimate curvature"
        )
    elif diagram.lost:
        warnings.append("shear spring: the axial load is lost before the ultimate curvature")
    end = end or _last_useful(diagram)
    if not end.strain > 0.0:
        raise InputError(
            "shear spring: the section carries no shear; check its concrete, the axial load and "
            "the length"
        )
    knee = diagram.knee
    if knee is None or knee.strain >= end.strain:
        warnings.append(
            "shear spring: no knee before its end point; one line to there, and no stiffness beyond"
        )
        knee, k_post = end, 0.0
    else:
        k_post = (end.force - knee.force) / ((end.strain - knee.strain) * length)
    k = knee.force / (knee.strain * length)
    if k_post < 0.0:
        warnings.append(
            f"shear spring: the stiffness after yield, {k_post:.4g} N/m, is negative; zero is taken"
        )
    spring = Bilinear(k=k, d_y=knee.strain * length, k_post=min(max(k_post, 0.0), 0.99 * k))
    return ShearSpring(spring, knee, end, strength, k_post, governs, tuple(warnings))


def closed_form_shear(
    section: Section, length: float, cracking_moment: float, knee: float = KNEE
) -> tuple[float, float]:
    """Return stiffness and yield slip of the shear spring without an analysis in shear.

    K_y = knee E_c A/(2 L), V_y = 1.86 M_c/L; both constants are calibrated on the four columns of
    the paper only. The stiffness after yield has no such closed form.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the lateral load [m].
    cracking_moment : float
        Of the section under its axial load [N m].
    knee : float, optional
        Share of (E_c/2) A.

    Returns
    -------
    k : float
        Stiffness [N/m].
    d_y : float
        Yield slip [m].

    Raises
    ------
    InputError
        If a value is not positive.
    """
    for name, value in (("length", length), ("cracking_moment", cracking_moment), ("knee", knee)):
        if not (math.isfinite(value) and value > 0.0):
            raise InputError(f"closed form of shear: {name} = {value} must be above zero")
    k = knee * 0.5 * section.concrete_law["ec"] * section.gross_area / length
    return k, CLOSED_FORM_FORCE * cracking_moment / length / k


def _last_useful(diagram: ShearDiagram) -> ShearPoint:
    """Return the end of the diagram, or its peak if the force has fallen well below that."""
    if not diagram.force.size or diagram.end.force >= _FALLEN * diagram.force.max():
        return diagram.end
    peak = int(np.argmax(diagram.force))
    rows = (diagram.curvature, diagram.moment, diagram.force, diagram.strain)
    return ShearPoint(*(float(row[peak]) for row in rows))


def _at_force(diagram: ShearDiagram, force: float) -> ShearPoint | None:
    """Return the first point of the diagram at a force; None if it stays below."""
    reached = np.flatnonzero(diagram.force >= force)
    if not reached.size:
        return None
    i = int(reached[0])
    rows = np.vstack([diagram.curvature, diagram.moment, diagram.force, diagram.strain])
    first = np.zeros(4) if i == 0 else rows[:, i - 1]
    share = (force - first[2]) / (rows[2, i] - first[2])
    return ShearPoint(*(first + share * (rows[:, i] - first)).tolist())
