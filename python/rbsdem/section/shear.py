"""Shear of a section: force against shear strain, and the shear spring of a column.

The section bends under a constant axial load with V = M/L; each of its layers is a cracked membrane
of the modified compression field theory (Vecchio and Collins 1986). The spring is read from the
diagram: a knee where the secant has fallen to 0.48 of the uncracked stiffness (E_c/2) A, and an end
point at the ultimate curvature of the flexural spring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.errors import InputError
from rbsdem.section.materials import tension_place
from rbsdem.section.strength import shear_strength_mcft
from rbsdem.springs import Bilinear

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rbsdem.section.shapes import Section

__all__ = [
    "KNEE",
    "ShearDiagram",
    "ShearLayers",
    "ShearPoint",
    "ShearSpring",
    "closed_form_shear",
    "fit_shear_spring",
    "shear_diagram",
]

KNEE = 0.48
"""Share of (E_c/2) A of the secant at the knee: calibrated on the four columns of table 3 of the
paper, whose shear springs have 0.41 to 0.53."""

CLOSED_FORM_FORCE = 1.86
"""Force at the knee over that of flexural cracking, M_c/L: calibrated on the same four columns."""

#: A section curvature is taken this far if none is given: strain over the depth.
_FURTHEST = 0.012

#: Share of the peak force below which a diagram is not followed to its end for a spring.
_FALLEN = 0.95


@dataclass(frozen=True, slots=True)
class ShearPoint:
    """A point of the diagram.

    Attributes
    ----------
    curvature : float
        [1/m].
    moment : float
        About mid-depth [N m].
    force : float
        Shear force, moment over length [N].
    strain : float
        Mean shear strain of the section.
    """

    curvature: float
    moment: float
    force: float
    strain: float


@dataclass(frozen=True, slots=True, eq=False)
class ShearLayers:
    """The layers of the section at the last point of a diagram, from the compression face on.

    Attributes
    ----------
    y : ndarray, shape (n,)
        From mid-depth [m].
    eps_x, eps_z : ndarray, shape (n,)
        Longitudinal and transverse strain, tension positive.
    tau : ndarray, shape (n,)
        Shear stress [Pa].
    gamma : ndarray, shape (n,)
        Shear strain.
    """

    y: Array
    eps_x: Array
    tau: Array
    gamma: Array
    eps_z: Array


@dataclass(frozen=True, eq=False)
class ShearDiagram:
    """Shear force against mean shear strain under a constant axial load.

    Attributes
    ----------
    section : Section
        The section.
    length : float
        Shear span M/V [m].
    axial_load : float
        Compression positive [N].
    curvature, moment, force, strain : ndarray, shape (n,)
        The points: curvature [1/m], moment [N m], shear force [N], shear strain.
    knee : ShearPoint or None
        Where the secant has fallen to the share of the knee; None if it stays above.
    end : ShearPoint
        The last point.
    sheared : bool
        Whether the diagram ends because a layer carries no more shear.
    lost : bool
        Whether it ends because the section no longer carries the axial load.
    layers : ShearLayers
        The layers at the last point.
    """

    section: Section
    length: float
    axial_load: float
    curvature: Array
    moment: Array
    force: Array
    strain: Array
    knee: ShearPoint | None
    end: ShearPoint
    sheared: bool
    lost: bool
    layers: ShearLayers = field(repr=False)

    @property
    def stiffness(self) -> float:
        """Shear force over strain of the uncracked concrete, (E_c/2) A [N]."""
        return 0.5 * self.section.concrete_law["ec"] * self.section.gross_area

    def plot(self, ax: Axes | None = None, *, spring: ShearSpring | None = None) -> Axes:
        """Draw the diagram with its knee, in kN and mm/m.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.
        spring : ShearSpring, optional
            Draw the lines of this spring as well.

        Returns
        -------
        matplotlib.axes.Axes
            The axes.
        """
        from rbsdem.section.shear_figure import draw_shear  # noqa: PLC0415

        return draw_shear(self, ax, spring)


@dataclass(frozen=True)
class ShearSpring:
    """The bilinear shear spring of a column, and where it comes from.

    Attributes
    ----------
    spring : Bilinear
        Stiffness [N/m], yield slip [m], stiffness after yield [N/m].
    knee, end : ShearPoint
        The two points of the diagram that its lines go through.
    strength : float
        Shear strength V_n by the simplified modified compression field theory [N].
    k_post_found : float
        Stiffness after yield before it was raised to zero or held below the first one [N/m].
    governs : bool
        Whether shear fails before the end point in flexure.
    warnings : tuple of str
        What to know before using it.
    """

    spring: Bilinear
    knee: ShearPoint
    end: ShearPoint
    strength: float
    k_post_found: float
    governs: bool
    warnings: tuple[str, ...]


def shear_diagram(
    section: Section,
    length: float,
    axial_load: float,
    curvature: ArrayLike | None = None,
    *,
    furthest: float | None = None,
    points: int = 60,
    tension: str = "ts",
    confined: bool = False,
    coupled: bool = False,
    layers: int = 80,
    knee: float = KNEE,
) -> ShearDiagram:
    """Return shear force and shear strain of a section that bends with V = M/length.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span M/V: from the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    curvature : array_like, shape (n,), optional
        Positive curvatures, rising [1/m]. By default `points` of them up to `furthest`, closer
        together at the beginning.
    furthest : float, optional
        Last curvature [1/m]; 0.012 over the depth if not given.
    points : int, optional
        How many.
    tension : {"ts", "bare", "zero"}, optional
        Tension law of the concrete.
    confined : bool, optional
        Whether the core is taken as confined.
    coupled : bool, optional
        Whether the shear changes the longitudinal stresses and so the moment: layers, axial load
        and shear are solved together. Without, the moment is that of the section in flexure.
    layers : int, optional
        Layers over the depth.
    knee : float, optional
        Share of (E_c/2) A at the knee, between 0 and 1.

    Returns
    -------
    ShearDiagram
        As far as the section carries on.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.
    """
    if curvature is None:
        points = _core.whole(points, "points")
        if points < 2:
            raise InputError(f"points = {points} must be 2 or more")
        last = _FURTHEST / section.depth
        if furthest is not None:
            last = _core.number(furthest, "furthest")
            if not 0.0 < last * section.depth <= 1.0:
                raise InputError(f"furthest = {last} 1/m must be above zero and below 1/depth")
        path = last * np.linspace(0.0, 1.0, points + 1)[1:] ** 2
    else:
        path = _core.finite_vector(curvature, "curvature")
        if path.size and np.max(path) * section.depth > 1.0:
            raise InputError(
                f"curvature: {np.max(path)} 1/m makes strains above 1 over the depth; curvatures "
                f"are in 1/m: 10 mrad/m is 0.01"
            )
    load = _core.number(axial_load, "axial_load")
    span = _core.number(length, "length")
    numbers, profile, (found, sheared, lost), ends = _core.section_shear(
        section._packed,
        load,
        span,
        tension_place(tension),
        section._confined(confined),
        _core.switch(coupled, "coupled"),
        _core.whole(layers, "layers"),
        _core.number(knee, "knee"),
        path,
    )
    return ShearDiagram(
        section,
        span,
        load,
        *(row.copy() for row in numbers),
        ShearPoint(*ends[:, 0].tolist()) if found else None,
        ShearPoint(*ends[:, 1].tolist()),
        sheared,
        lost,
        ShearLayers(*(row.copy() for row in profile)),
    )


def fit_shear_spring(
    section: Section,
    length: float,
    axial_load: float,
    ultimate_curvature: float,
    **options: Any,
) -> ShearSpring:
    """Fit the bilinear shear spring of a column with V = M/length.

    Slip is shear strain times length. The line goes through the knee of the diagram and through
    its point at the ultimate curvature, or at the shear strength if that is reached before, or at
    the peak if the moment has fallen by more than 5 per cent of it: past that the shear flow of
    the layers means little.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    ultimate_curvature : float
        Where the flexural spring has its ultimate point [1/m].
    **options
        As for `shear_diagram`: points, tension, confined, coupled, layers, knee.

    Returns
    -------
    ShearSpring
        The spring, its points, and warnings.

    Raises
    ------
    InputError
        If a value is refused, or the section does not carry shear at all.
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
    """Return stiffness and yield slip of the shear spring without analysis of the shear.

    K_y = knee E_c A/(2 L), V_y = 1.86 M_c/L; both constants are calibrated on the four columns of
    the paper only. There is no such form of the stiffness after yield.

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
        If a number is not positive.
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
