"""Shear force against shear strain of a section.

The section bends under a constant axial load with V = M/L; each of its layers is a cracked membrane
of the modified compression field theory (Vecchio and Collins 1986). The diagram has a knee where
the secant has fallen to 0.48 of the uncracked stiffness (E_c/2) A.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.materials import Tension
from rbsdem.section.ranges import column_length

if TYPE_CHECKING:
    from rbsdem.model.section import Section

__all__ = [
    "KNEE",
    "ShearDiagram",
    "ShearLayers",
    "ShearPoint",
    "shear_diagram",
]

KNEE = 0.48
"""Share of (E_c/2) A of the secant at the knee: calibrated on the four columns of table 3 of the
paper, whose shear springs have 0.41 to 0.53."""

#: Last curvature of a diagram by default, as strain over the depth.
_FURTHEST = 0.012


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
    """State of the layers at the last point of a diagram, from the compression face on.

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
        Where the secant has fallen to the given share; None if it stays above.
    end : ShearPoint
        The last point.
    sheared : bool
        Whether the diagram ends because a layer no longer carries the shear.
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


def shear_diagram(
    section: Section,
    length: float,
    axial_load: float,
    curvature: ArrayLike | None = None,
    *,
    furthest: float | None = None,
    points: int = 60,
    tension: Tension = "ts",
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
        Positive, increasing curvatures [1/m]. By default `points` curvatures up to `furthest`,
        closer together at the beginning.
    furthest : float, optional
        Last curvature [1/m]; by default 0.012 over the depth.
    points : int, optional
        Number of points if no curvatures are given.
    tension : {"ts", "bare", "zero"}, optional
        Tension law of the concrete.
    confined : bool, optional
        Whether the core is confined.
    coupled : bool, optional
        Whether the shear changes the longitudinal stresses and so the moment: layers, axial load
        and shear are then solved together. Otherwise the moment is that of the section in flexure.
    layers : int, optional
        Layers over the depth.
    knee : float, optional
        Share of (E_c/2) A at the knee, between 0 and 1.

    Returns
    -------
    ShearDiagram
        The diagram, as far as the section carries axial load and shear.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.
    """
    if curvature is None:
        points = _arguments.whole(points, "points")
        if points < 2:
            raise InputError(f"points = {points} must be 2 or more")
        last = _FURTHEST / section.depth
        if furthest is not None:
            last = _arguments.number(furthest, "furthest")
            if not 0.0 < last * section.depth <= 1.0:
                raise InputError(f"furthest = {last} 1/m must be above zero and below 1/depth")
        path = last * np.linspace(0.0, 1.0, points + 1)[1:] ** 2
    else:
        path = _arguments.finite_vector(curvature, "curvature")
        if path.size and np.max(path) * section.depth > 1.0:
            raise InputError(
                f"curvature: {np.max(path)} 1/m makes strains above 1 over the depth; curvatures "
                f"are in 1/m: 10 mrad/m is 0.01"
            )
    load = _arguments.number(axial_load, "axial_load")
    span = column_length(length, "length")
    settings = {
        "length": span,
        "axial_load": load,
        "tension": tension,
        "confined": section._confined(confined),
        "coupled": _arguments.switch(coupled, "coupled"),
        "layers": _arguments.whole(layers, "layers"),
        "knee": _arguments.number(knee, "knee"),
    }
    run = _core.section_shear(section._statement, settings, path)
    return ShearDiagram(
        section=section,
        length=span,
        axial_load=load,
        **run.points,
        knee=ShearPoint(**run.knee) if run.knee else None,
        end=ShearPoint(**run.end),
        sheared=run.sheared,
        lost=run.lost,
        layers=ShearLayers(**run.profile),
    )
