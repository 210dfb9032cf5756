"""Loops of a test and of its model as lines in a box; gallery and contact sheet draw these."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from rbsdem._arguments import Array

if TYPE_CHECKING:
    from rbsdem.curves.scores import Comparison

__all__ = ["Picture", "picture", "thinned"]

#: How far a model is drawn beyond its test: of the largest force that is in the box.
_BEYOND = 1.08
#: Largest force in the box over that of the test: beyond, nothing would be seen of the test.
_LARGEST = 2.0
#: Distance from a line at which a point is left out, in the box.
_TOLERANCE = 0.0018


@dataclass(frozen=True, eq=False)
class Picture:
    """Two lines in a box from -1 to 1 in both directions.

    Attributes
    ----------
    test, model : ndarray, shape (m, 2)
        Displacement and force over their largest; of a model far beyond its test, up to a little
        beyond the box.
    displacement, force : float
        What 1 stands for [m], [N].
    """

    test: Array
    model: Array
    displacement: float
    force: float


def picture(comparison: Comparison) -> Picture:
    """Return the lines of a comparison.

    Parameters
    ----------
    comparison : Comparison
        Displacement and forces.

    Returns
    -------
    Picture
        Without points that nobody would see.
    """
    c = comparison
    model = c.model_force[: c.rows]
    displacement = float(np.max(np.abs(c.displacement))) or 1.0
    test = float(np.max(np.abs(c.test_force))) or 1.0
    force = min(max(test, float(np.max(np.abs(model), initial=0.0))), _LARGEST * test)
    x = c.displacement / displacement
    clipped = np.clip(model / force, -_BEYOND, _BEYOND)
    return Picture(
        test=thinned(np.column_stack((x, c.test_force / force)), _TOLERANCE),
        model=thinned(np.column_stack((x[: c.rows], clipped)), _TOLERANCE),
        displacement=displacement,
        force=force,
    )


def thinned(points: Array, tolerance: float) -> Array:
    """Leave out points that lie on the straight way between their neighbours.

    Every other point at a time, so that no two neighbours go at once.

    Parameters
    ----------
    points : ndarray, shape (m, 2)
        A line.
    tolerance : float
        Distance from the way at which a point may lie; errors do not add up beyond a few of it.

    Returns
    -------
    ndarray, shape (k, 2)
        First, last and all corners are kept.
    """
    for turn in range(12):
        first = 1 + turn % 2
        inner = np.arange(first, len(points) - 1, 2)
        if not inner.size:
            break
        way = points[inner + 1] - points[inner - 1]
        out = points[inner] - points[inner - 1]
        length = np.maximum(np.hypot(*way.T), 1e-9 * tolerance)
        aside = np.abs(way[:, 0] * out[:, 1] - way[:, 1] * out[:, 0]) / length
        along = np.sum(way * out, axis=1) / length
        drop = (aside <= tolerance) & (along >= -tolerance) & (along <= length + tolerance)
        points = np.delete(points, inner[drop], axis=0)
    return points
