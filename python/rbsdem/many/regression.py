"""Straight lines and logistic curves through the points of a cloud."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbsdem._arguments import Array

_MOST_STEPS = 100
_CLOSE = 1e-10
_LONGEST = 5.0


@dataclass(frozen=True, eq=False)
class PowerLaw:
    """A response that is a power of the intensity: ln EDP = a + b ln IM, with scatter.

    Attributes
    ----------
    a, b : float
        Intercept and slope.
    sigma : float
        Standard deviation of ln EDP about the line, with n - 2 in its denominator.
    covariance : ndarray, shape (2, 2)
        Of a and b.
    """

    a: float
    b: float
    sigma: float
    covariance: Array


@dataclass(frozen=True, eq=False)
class Logistic:
    """A probability that is a logistic curve of ln IM: 1/(1 + exp(-c0 - c1 ln IM))."""

    c0: float
    c1: float

    def probability(self, log_intensity: Array) -> Array:
        """Return the probability at logarithms of the intensity."""
        from scipy import special  # noqa: PLC0415

        return np.asarray(special.expit(self.c0 + self.c1 * log_intensity))


def fit_line(x: Array, y: Array) -> PowerLaw:
    """Return the straight line of least squares through three or more points."""
    n = x.size
    middle = x.mean()
    square = float(((x - middle) ** 2).sum())
    b = float(((x - middle) * (y - y.mean())).sum() / square)
    a = float(y.mean() - b * middle)
    variance = float(((y - a - b * x) ** 2).sum() / (n - 2))
    # Of (a, b): the inverse of the normal equations times the variance.
    inverse = np.array(
        [[1 / n + middle**2 / square, -middle / square], [-middle / square, 1 / square]]
    )
    return PowerLaw(a, b, float(np.sqrt(variance)), variance * inverse)


def fit_logistic(x: Array, happened: NDArray[np.bool_]) -> Logistic:
    """Return the logistic curve of largest penalised likelihood.

    The penalty of Firth (1993) takes off the first bias, and gives an answer where no intensity has
    both outcomes.
    """
    from scipy import special  # noqa: PLC0415

    middle, spread = x.mean(), max(float(x.std()), 1e-12)
    design = np.column_stack([np.ones_like(x), (x - middle) / spread])
    y = happened.astype(float)
    at = np.zeros(2)
    for _ in range(_MOST_STEPS):
        p = special.expit(design @ at)
        w = p * (1 - p)
        information = design.T @ (w[:, None] * design)
        inverse = np.linalg.pinv(information)
        leverage = w * np.einsum("ij,jk,ik->i", design, inverse, design)
        step = inverse @ (design.T @ (y - p + leverage * (0.5 - p)))
        longest = float(np.abs(step).max())
        at = at + step * min(1.0, _LONGEST / max(longest, 1e-300))
        if longest < _CLOSE:
            break
    c1 = at[1] / spread
    return Logistic(float(at[0] - c1 * middle), float(c1))
