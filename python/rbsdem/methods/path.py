"""Times and paths: common interval, reversals, interpolation."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rbsdem._arguments import Array


def common_interval(time: Array) -> tuple[float, bool]:
    """Return an interval that divides all intervals between the times, and whether one exists.

    If none exists, the median interval is returned.
    """
    intervals = np.diff(time)
    for parts in range(1, 21):
        base = float(intervals.min()) / parts
        # Taken from the whole length, which has more correct digits than one interval.
        base = float(time[-1] - time[0]) / max(round(float(time[-1] - time[0]) / base), 1)
        counts = intervals / base
        if np.all(np.abs(counts - np.round(counts)) <= 1e-9 * np.maximum(counts, 1.0)):
            return base, True
    return float(np.median(intervals)), False


def at_times(wanted: Array, time: Array, values: Array) -> Array:
    """Return values between rows, by the cubic through the four nearest rows."""
    if time.size < 4:
        return np.interp(wanted, time, values)
    first = np.clip(np.searchsorted(time, wanted) - 2, 0, time.size - 4)
    at = time[first[:, None] + np.arange(4)]
    result = np.zeros(wanted.size)
    for i in range(4):
        weight = np.ones(wanted.size)
        for j in range(4):
            if i != j:
                weight *= (wanted - at[:, j]) / (at[:, i] - at[:, j])
        result += weight * values[first + i]
    return result


def reversals(path: Array) -> NDArray[np.intp]:
    """Return the rows of the first and last points of a path and of those where it turns."""
    moves = np.flatnonzero(np.diff(path))
    signs = np.sign(np.diff(path)[moves])
    turns = moves[1:][signs[1:] != signs[:-1]]
    return np.unique(np.concatenate([[0], turns, [path.size - 1]]))


def along(path: Array, kept: NDArray[np.intp]) -> Array:
    """Return where the points of a path lie among those kept; 1.5 is between second and third."""
    place = np.empty(path.size)
    for leg, (first, last) in enumerate(pairwise(kept)):
        length = path[last] - path[first]
        part = path[first : last + 1] - path[first]
        place[first : last + 1] = leg + (part / length if length else 0.0)
    place[kept] = np.arange(kept.size)
    return place
