"""Lognormal distributions fitted by maximum likelihood, many samples at once for the bootstrap.

A value is known, or known to lie between bounds; counts at levels are bounds with weights. In a and
b of z = a + b ln x the likelihood has one maximum: Newton's method on all samples together, each
step shortened until it does not go down. A fit that has no maximum, or has not come to it, is NaN.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rbsdem._types import Array, NDArray

_MOST_STEPS = 100
#: Gain of the logarithm of the likelihood that a step still promises where the search ends.
_CLOSE = 1e-18
#: Bounds closer than this share of all bounds' range count as their middle.
_NARROW = 1e-6
#: Least spread that is told from none, as the logarithm of an intensity.
LEAST_BETA = 1e-3
#: Spread at which the data are said not to grow with the intensity.
MOST_BETA = 20.0


def fit_points(values: Array) -> tuple[Array, Array]:
    """Return mean and standard deviation of logarithms (Baker 2015, eqs 1 and 2).

    Parameters
    ----------
    values : ndarray, shape (..., n)
        Samples of n positive values.

    Returns
    -------
    tuple of ndarray, shape (...)
        Mean and standard deviation, with n - 1 in its denominator.
    """
    logs = np.log(values)
    return logs.mean(axis=-1), np.maximum(logs.std(axis=-1, ddof=1), LEAST_BETA)


@dataclass(frozen=True, eq=False)
class Bounds:
    """Logarithms of bounds of values, each bound with its weight.

    Attributes
    ----------
    low, high : ndarray, shape (..., n)
        Minus infinity for a value below all that was tried, infinity for one above; equal where
        the value is known.
    weight : ndarray, shape (..., n)
        How many values have these bounds.
    """

    low: Array
    high: Array
    weight: Array

    def gap(self) -> tuple[Array, Array]:
        """Return between which logarithms one value would fit all bounds, each of shape (...).

        Bounds without weight do not count. If all bounds have a value in common, or touch, a
        distribution without spread is the likeliest, and only bounds of its median are known: the
        nearest bounds that do not touch. Else both are NaN.
        """
        kept = self.weight > 0
        low, high = np.where(kept, self.low, -np.inf), np.where(kept, self.high, np.inf)
        last, first = low.max(-1, keepdims=True), high.min(-1, keepdims=True)
        nearest = np.where(low < first, low, -np.inf).max(-1)
        furthest = np.where(high > last, high, np.inf).min(-1)
        free = (last <= first)[..., 0]
        return np.where(free, nearest, np.nan), np.where(free, furthest, np.nan)


def bounds_of_counts(level: Array, number: NDArray[Any], failures: NDArray[Any]) -> Bounds:
    """Return the bounds of capacities by counts: a failure is below its level, a survival above it.

    Parameters
    ----------
    level : ndarray, shape (k,)
        Intensities.
    number, failures : ndarray, shape (..., k)
        Runs at each level, and how many of them failed.
    """
    x = np.log(level)
    n, k = np.broadcast_arrays(np.asarray(number, float), np.asarray(failures, float))
    none = np.full_like(x, np.inf)
    low, high = np.concatenate((-none, x)), np.concatenate((x, none))
    weight = np.concatenate((k, n - k), axis=-1)
    shape = weight.shape
    return Bounds(np.broadcast_to(low, shape), np.broadcast_to(high, shape), weight)


def fit_bounds(bounds: Bounds, beta: float | None = None) -> tuple[Array, Array, Array]:
    """Return the lognormal distribution of largest likelihood.

    Parameters
    ----------
    bounds : Bounds
        Of the values.
    beta : float, optional
        The standard deviation of the logarithm, if it is stated; the mean alone is then fitted.

    Returns
    -------
    mu, beta : ndarray, shape (...)
        Mean and standard deviation of the logarithm. NaN where the likelihood has no maximum: `gap`
        says where one value could stand for all. beta is infinite where the share below a level
        does not grow with it.
    covariance : ndarray, shape (..., 2, 2)
        Of both, from the curvature of the likelihood; a stated beta has none.
    """
    ends = np.stack((bounds.low, bounds.high))
    kept = np.isfinite(ends) & (bounds.weight > 0)
    able = _able(bounds, stated=beta is not None)
    # Logarithms about their middle, in units of their range: of each sample alone.
    least = np.where(kept, ends, np.inf).min((0, -1))
    most = np.where(kept, ends, -np.inf).max((0, -1))
    able &= np.isfinite(least) & np.isfinite(most)
    middle = np.where(able, 0.5 * (least + most), 0.0)
    unit = np.where(able & (most > least), most - least, 1.0)
    low, high = (ends - middle[..., None]) / unit[..., None]
    terms = _Terms(low, high, np.where(able[..., None], bounds.weight, 0.0))
    b = np.full(able.shape, 2.0) if beta is None else unit / beta
    a = np.zeros_like(b)
    value = terms.value(a, b)
    done = ~able
    flat = np.zeros_like(done)
    for _ in range(_MOST_STEPS):
        gradient, hessian = terms.derivatives(a, b)
        if beta is None:
            step = _solve(hessian, gradient)
        else:
            step = gradient[0] / np.where(hessian[0] > 0, hessian[0], 1.0), np.zeros_like(b)
        gain = gradient[0] * step[0] + gradient[1] * step[1]
        done |= np.abs(gain) <= _CLOSE * (1.0 + np.abs(value))
        # b stays above 0, where the curve would turn over.
        share = np.where(step[1] < -0.9 * b, 0.9 * b / np.maximum(-step[1], 1e-300), 1.0)
        share = np.where(done | flat, 0.0, share)
        for _ in range(50):
            new = a + share * step[0], b + share * step[1]
            at = terms.value(*new)
            # Round-off of a sum is no descent.
            down = ~(at >= value - 1e-13 * (1.0 + np.abs(value)))
            if not down.any():
                break
            share = np.where(down, 0.5 * share, share)
        a, b, value = *new, at
        # b goes to 0: the share does not grow with the intensity.
        flat |= able & (b < unit / MOST_BETA) & (beta is None)
        if np.all(done | flat):
            break
    ok = done & able & ~flat
    mu, sigma = middle - unit * a / b, unit / b if beta is None else np.full(b.shape, beta)
    sigma = np.where(ok, sigma, np.where(flat, np.inf, np.nan))
    return np.where(ok, mu, np.nan), sigma, _covariance(terms, a, b, unit, beta is None)


def _covariance(terms: _Terms, a: Array, b: Array, unit: Array, both: bool) -> Array:
    """Return the covariance of mean and spread, from the curvature of the likelihood.

    `both`: whether both are fitted; else the spread is stated, and only the mean varies.
    """
    (h11, h12, h22), per = terms.derivatives(a, b)[1], unit / b
    with np.errstate(divide="ignore", invalid="ignore"):
        if not both:
            zero = np.zeros_like(per)
            inverse = [[per**2 / h11, zero], [zero, zero]]
        else:
            det = h11 * h22 - h12**2
            # mu = middle - unit a/b, beta = unit/b.
            by_a, by_b = (-per, np.zeros_like(per)), (per * a / b, -per / b)
            inverse = [
                [
                    (
                        h22 * by_a[i] * by_a[j]
                        - h12 * (by_a[i] * by_b[j] + by_b[i] * by_a[j])
                        + h11 * by_b[i] * by_b[j]
                    )
                    / det
                    for j in (0, 1)
                ]
                for i in (0, 1)
            ]
    return np.moveaxis(np.array(inverse), (0, 1), (-2, -1))


def _able(bounds: Bounds, *, stated: bool) -> NDArray[np.bool_]:
    """Return which likelihoods have a maximum: with a stated beta those with bounds to both sides.

    Without one, no value may be common to all bounds. The maximum may then still be where the
    share does not grow.
    """
    kept = bounds.weight > 0
    if not stated:
        return np.asarray(np.isnan(bounds.gap()[0]))
    above = (kept & np.isfinite(bounds.low)).any(-1)
    return np.asarray(above & (kept & np.isfinite(bounds.high)).any(-1))


class _Terms:
    """The logarithm of the likelihood of bounds, a function of a and b, and its derivatives."""

    def __init__(self, low: Array, high: Array, weight: Array) -> None:
        self._weight = weight
        self._exact = high - low <= _NARROW
        self._open = np.isfinite(low), np.isfinite(high)
        self._low, self._high = (
            np.where(known, end, 0.0) for known, end in zip(self._open, (low, high), strict=True)
        )
        self._point = 0.5 * (self._low + self._high)

    def value(self, a: Array, b: Array) -> Array:
        """Return the logarithm of the likelihood, shape (...)."""
        z = a[..., None] + b[..., None] * self._point
        point = np.log(b)[..., None] - 0.5 * z**2
        return self._sums((point,), (self._mass(a, b)[0],))[0]

    def derivatives(self, a: Array, b: Array) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Return the gradient (a, b), and the second derivatives with the other sign."""
        mass, u, v = self._mass(a, b)
        # Densities at the ends over the probability between them.
        with np.errstate(over="ignore", invalid="ignore"):
            upper, lower = (
                np.where(known, np.exp(-0.5 * end**2 - 0.5 * np.log(2 * np.pi) - mass), 0.0)
                for known, end in ((self._open[1], v), (self._open[0], u))
            )
        h, l = self._high, self._low  # noqa: E741
        g = upper - lower, h * upper - l * lower
        vu, ul = v * upper, u * lower
        second = (
            vu - ul + g[0] ** 2,
            h * vu - l * ul + g[0] * g[1],
            h * h * vu - l * l * ul + g[1] ** 2,
        )
        x = self._point
        z, ones = a[..., None] + b[..., None] * x, np.ones_like(x)
        per = 1.0 / b[..., None]
        g_point = -z, per - x * z
        second_point = ones, x * ones, x * x + per**2
        return self._sums(g_point, g), self._sums(second_point, second)

    def _sums(self, known: tuple[Array, ...], bounded: tuple[Array, ...]) -> tuple[Array, ...]:
        """Return weighted sums of terms: of known values, and of those between bounds."""
        pairs = zip(known, bounded, strict=True)
        terms = (np.where(self._exact, at, between) for at, between in pairs)
        return tuple((self._weight * term).sum(-1) for term in terms)

    def _mass(self, a: Array, b: Array) -> tuple[Array, Array, Array]:
        """Return ln(Phi(v) - Phi(u)) with v and u, the ends in z."""
        from scipy.special import log_ndtr  # noqa: PLC0415

        ends = [
            np.where(known, a[..., None] + b[..., None] * end, sign * np.inf)
            for known, end, sign in zip(self._open, (self._low, self._high), (-1, 1), strict=True)
        ]
        # In the tail where the digits are: both ends on the negative side.
        flip = ends[0] > 0
        first = np.where(flip, -ends[1], ends[0])
        second = np.where(flip, -ends[0], ends[1])
        with np.errstate(invalid="ignore", divide="ignore"):
            top, bottom = log_ndtr(second), log_ndtr(first)
            mass = top + np.log1p(-np.exp(np.minimum(bottom - top, 0.0)))
        u, v = (np.where(known, end, 0.0) for known, end in zip(self._open, ends, strict=True))
        return np.where(self._exact, 0.0, mass), u, v


def _solve(matrix: tuple[Array, ...], right: tuple[Array, ...]) -> tuple[Array, Array]:
    """Solve symmetric systems of two equations, given by (m11, m12, m22)."""
    a, b, c = matrix
    det = a * c - b * b
    # Where round-off has eaten the determinant a little is added to both pivots.
    more = np.where(det > 1e-12 * a * c, 0.0, 1e-6)
    a, c = a * (1.0 + more) + (a <= 0), c * (1.0 + more) + (c <= 0)
    det = a * c - b * b
    return (c * right[0] - b * right[1]) / det, (a * right[1] - b * right[0]) / det
