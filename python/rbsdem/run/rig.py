"""The rig of a test, which resists the motion of the top by friction.

Rollers, pins and jacks that hold the axial load P push against the motion with mu P. It is in the
force that a test measures, and in no column of a building.
"""

from __future__ import annotations

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array, ArrayLike
from rbsdem.model.column import Column
from rbsdem.model.springs import Bilinear, unchecked
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.parameters import parameters

#: Drift within which the friction grows from nothing to all of it; to turn it takes twice as much.
_TURN = 0.0005


def friction(displacement: Array, height: float) -> Array:
    """Return the friction along a path over the largest, from -1 to 1: elastic, then plastic.

    Parameters
    ----------
    displacement : ndarray, shape (m,)
        The path of the top [m].
    height : float
        Of the top [m].
    """
    spring = unchecked(Bilinear, k=1.0, d_y=1.0, k_post=0.0)
    return spring.response(displacement / (_TURN * height))


def rig_force(column: Column, displacement: ArrayLike) -> Array:
    """Return what the rig of a test adds to the lateral force of a column along a path [N].

    It is mu P against the motion, P the axial load and mu = 0.004 the parameter ``rig_friction`` of
    the layered model, all of it after a drift of 0.0005; 0 to 0.006 are best for the middle half of
    the series. Where the rig of a test is known, the parameter takes its number.

    Parameters
    ----------
    column : Column
        The column; one of the layered model has the parameter.
    displacement : array_like, shape (m,)
        Path of the top [m].

    Returns
    -------
    ndarray, shape (m,)
        Force [N].

    Raises
    ------
    InputError
        If `column` is no column, or a displacement is not finite.
    """
    _arguments.instance(column, "rig_force: column", Column, "a frame has no rig of a column")
    of = column._drawing.parameters if isinstance(column, LayeredColumn) else parameters()
    d = _arguments.finite_vector(displacement, "displacement")
    return np.asarray(of.rig_friction * abs(column.axial_load) * friction(d, column.height))
