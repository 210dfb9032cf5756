"""Cyclic loading protocol."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.errors import InputError


def protocol(
    amplitudes: ArrayLike,
    cycles: int | Sequence[int] = 1,
    repeats: int = 1,
    points: int = 25,
) -> Array:
    """Return full cycles 0, +a, 0, -a, 0 of given amplitudes.

    Parameters
    ----------
    amplitudes : array_like, shape (k,)
        Amplitude of each step of the protocol, in the unit of the driven quantity.
    cycles : int or sequence of k int, optional
        Cycles at each amplitude.
    repeats : int, optional
        How often the whole protocol is repeated.
    points : int, optional
        Points on a quarter of a cycle.

    Returns
    -------
    ndarray, shape (4 points sum(cycles) repeats + 1,)
        The path, which starts at zero.

    Raises
    ------
    InputError
        If an amplitude is not positive or a count is below 1.
    """
    steps = _core.finite_vector(np.atleast_1d(amplitudes), "amplitudes")
    several = np.atleast_1d(np.asarray(cycles))
    counts = np.array([_core.whole(count, "cycles") for count in several.tolist()], dtype=np.int32)
    if counts.size == 0 or steps.size == 0:
        raise InputError("protocol: amplitudes and cycles must not be empty")
    return _core.protocol(
        steps, counts, _core.whole(repeats, "repeats"), _core.whole(points, "points")
    )
