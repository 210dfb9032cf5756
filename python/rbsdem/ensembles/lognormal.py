"""Lognormal distributions fitted by maximum likelihood, many samples at once for the bootstrap.

Without scipy's optimisers, which take one sample at a time: two parameters, Newton's method on all
samples together.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbsdem._core import Array
from rbsdem._optional import need_scipy

_MOST_STEPS = 200
_CLOSE = 1e-10
#: Least spread that is told from none, as the logarithm of an intensity.
LEAST_BETA = 1e-3
#: Where the search for one ends.
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


def fit_counts(level: Array, number: NDArray[Any], failures: NDArray[Any]) -> tuple[Array, Array]:
    """Return the parameters of a fragility curve from counts at levels (Baker 2015, eq 11).

    Parameters
    ----------
    level : ndarray, shape (k,)
        Intensities.
    number, failures : ndarray, shape (..., k)
        Runs at each level, and how many of them failed.

    Returns
    -------
    tuple of ndarray, shape (...)
        Mean and standard deviation of the logarithm of the capacity, that make the binomial
        likelihood of the counts largest. NaN where all or none failed.
    """
    special = need_scipy("special")
    x = np.log(level)
    n, k = np.broadcast_arrays(np.asarray(number, float), np.asarray(failures, float))
    able = (k.sum(axis=-1) > 0) & (k.sum(axis=-1) < n.sum(axis=-1))
    shape = able.shape
    mu, beta = _first_counts(x, n, k)
    a, b = -mu / beta, 1 / beta
    steepest = 1 / LEAST_BETA
    for _ in range(_MOST_STEPS):
        z = a[..., None] + b[..., None] * x
        density = np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi)
        # Of P and 1 - P the one that is small has all its digits.
        p, q = special.ndtr(z), special.ndtr(-z)
        with np.errstate(divide="ignore", invalid="ignore"):
            pull = density * (k / p - (n - k) / q)
            weight = n * density**2 / (p * q)
        pull, weight = np.nan_to_num(pull, posinf=0, neginf=0), np.nan_to_num(weight, posinf=0)
        step = _solve(
            [weight.sum(-1), (weight * x).sum(-1), (weight * x * x).sum(-1)],
            [pull.sum(-1), (pull * x).sum(-1)],
        )
        # A step of Fisher's scoring is cut where it would turn the curve over.
        room = np.where(step[1] < 0, 0.8 * b / np.maximum(-step[1], 1e-300), 1.0)
        room = np.minimum(room, np.where(step[1] > 0, 2.0 * b / np.maximum(step[1], 1e-300), 1.0))
        room = np.minimum(room, 1.0)
        a, b = a + room * step[0], b + room * step[1]
        over = b > steepest
        a, b = np.where(over, a * steepest / b, a), np.where(over, steepest, b)
        done = np.abs(step[0]) + np.abs(step[1]) <= _CLOSE * (np.abs(a) + np.abs(b))
        if np.all(done | over | ~able):
            break
    mu, beta = -a / b, np.clip(1 / b, LEAST_BETA, MOST_BETA)
    return np.where(able, mu, np.nan).reshape(shape), np.where(able, beta, np.nan).reshape(shape)


def fit_brackets(lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the parameters of a lognormal variable that is known to lie between bounds.

    Parameters
    ----------
    lower, upper : ndarray, shape (..., n)
        Bounds of each of n values; equal bounds are the value itself, an upper bound of infinity
        a value that was not reached.

    Returns
    -------
    tuple of ndarray, shape (...)
        Mean and standard deviation of the logarithm by maximum likelihood. NaN where no value was
        reached, or where one value lies within all bounds, so that there is no spread to be found.
    """
    special = need_scipy("special")
    with np.errstate(divide="ignore"):
        low, high = np.log(lower), np.log(upper)
    exact = high - low <= 1e-12
    able = np.isfinite(high).any(axis=-1)
    able &= exact.all(axis=-1) | (low.max(axis=-1) >= high.min(axis=-1))
    # Expectation and maximisation: each bracket has the moments of the normal between its ends.
    start = np.where(np.isfinite(high), np.where(np.isfinite(low), 0.5 * (low + high), high), low)
    mu, sigma = start.mean(axis=-1), np.maximum(start.std(axis=-1), 0.1)
    for _ in range(5 * _MOST_STEPS):
        first, second = _moments(special, low, high, exact, mu[..., None], sigma[..., None])
        new = first.mean(axis=-1)
        spread = np.sqrt(
            np.maximum((second - 2 * first * new[..., None]).mean(axis=-1) + new**2, LEAST_BETA**2)
        )
        moved = np.abs(new - mu) + np.abs(spread - sigma)
        mu, sigma = new, np.minimum(spread, MOST_BETA)
        if np.all((moved <= 1e-9 * (sigma + 1e-3)) | ~able):
            break
    return np.where(able, mu, np.nan), np.where(able, sigma, np.nan)


def _moments(
    special: Any, low: Array, high: Array, exact: NDArray[np.bool_], mu: Array, sigma: Array
) -> tuple[Array, Array]:
    """Return the first two moments of a normal variable between bounds."""
    a, b = (low - mu) / sigma, (high - mu) / sigma
    # In the tail where the digits are: both bounds on the negative side.
    flip = a > 0
    lo, hi = np.where(flip, -b, a), np.where(flip, -a, b)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        top, bottom = special.log_ndtr(hi), special.log_ndtr(lo)
        mass = top + np.log1p(-np.exp(np.minimum(bottom - top, 0.0)))
        density = [np.exp(-0.5 * end**2 - 0.5 * np.log(2 * np.pi) - mass) for end in (lo, hi)]
        ends = [np.where(np.isfinite(end), end, 0.0) for end in (lo, hi)]
        mean = density[0] - density[1]
        square = 1 + ends[0] * density[0] - ends[1] * density[1]
    # A bracket narrower than the digits of its mass is as good as its middle.
    middle = 0.5 * (np.where(np.isfinite(lo), lo, hi) + np.where(np.isfinite(hi), hi, lo))
    bad = exact | ~np.isfinite(mean) | ~np.isfinite(square) | (hi - lo < 1e-6)
    mean = np.where(bad, middle, np.clip(mean, lo, hi))
    square = np.where(bad, middle**2, np.maximum(square, mean**2))
    mean = np.where(flip, -mean, mean)
    return mu + sigma * mean, mu**2 + 2 * mu * sigma * mean + sigma**2 * square


def _first_counts(x: Array, n: Array, k: Array) -> tuple[Array, Array]:
    """Return a first guess: a straight line through the shares on probability paper."""
    special = need_scipy("special")
    share = (k + 0.5) / (n + 1)
    z = special.ndtri(np.clip(share, 1e-3, 1 - 1e-3))
    weight = np.maximum(n, 1e-9)
    total = weight.sum(-1, keepdims=True)
    xm = (weight * x).sum(-1, keepdims=True) / total
    zm = (weight * z).sum(-1, keepdims=True) / total
    sxx = (weight * (x - xm) ** 2).sum(-1)
    slope = (weight * (x - xm) * (z - zm)).sum(-1) / np.where(sxx > 0, sxx, 1.0)
    slope = np.where((slope > 0.1) & (sxx > 0), slope, 2.0)
    return (xm - zm / slope[..., None])[..., 0], 1 / slope


def _solve(matrix: list[Array], right: list[Array]) -> tuple[Array, Array]:
    """Solve symmetric systems of two equations, given by [m11, m12, m22]."""
    a, b, c = matrix
    det = a * c - b * b
    good = det > 1e-14 * a * c
    det = np.where(good, det, 1.0)
    first = np.where(good, (c * right[0] - b * right[1]) / det, 0.0)
    second = np.where(good, (a * right[1] - b * right[0]) / det, 0.0)
    return first, second
