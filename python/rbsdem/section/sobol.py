"""Sobol points: samples that fill a space of three dimensions evenly."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import NormalDist

import numpy as np

from rbsdem._arguments import Array

__all__ = ["sobol"]


def sobol(number: int) -> Array:
    """Return standard normal numbers from the first Sobol points in three dimensions.

    Parameters
    ----------
    number : int
        How many points; powers of two fill the space evenly.

    Returns
    -------
    ndarray, shape (number, 3)
        Quantiles of the points (Sobol 1967; direction numbers of Joe and Kuo 2008), each in the
        middle of its cell.
    """
    bits = max(1, (number - 1).bit_length())
    normal = NormalDist()
    points = np.empty((number, 3))
    for place, first in enumerate(((), (1,), (1, 3))):
        directions = _directions(first, bits)
        x = 0
        for i in range(number):
            points[i, place] = normal.inv_cdf((x + 0.5) / 2**bits)
            x ^= directions[((~i) & (i + 1)).bit_length() - 1] if i + 1 < 2**bits else 0
    return points


def _directions(first: Sequence[int], bits: int) -> list[int]:
    """Return direction numbers of the polynomials 1, x + 1 and x^2 + x + 1."""
    numbers = list(first) or [1] * bits
    degree = len(first)
    for k in range(len(numbers), bits):
        new = numbers[k - degree] ^ (numbers[k - degree] << degree)
        if degree == 2:
            new ^= numbers[k - 1] << 1
        numbers.append(new)
    return [m << (bits - 1 - k) for k, m in enumerate(numbers[:bits])]
