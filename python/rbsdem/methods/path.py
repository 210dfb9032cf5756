"""Times and paths: common interval, reversals, interpolation."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rbsdem._arguments import Array


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
