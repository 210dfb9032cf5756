"""Fragility curves: the probability of a limit state over the intensity of the motion."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _core, _views
from rbsdem._core import Array
from rbsdem._optional import need_scipy
from rbsdem.ensembles.hazard import Hazard
from rbsdem.ensembles.lognormal import LEAST_BETA, MOST_BETA, fit_brackets, fit_counts, fit_points
from rbsdem.errors import InputError

#: Bounds of a capacity that differ by less than this count as one value, their geometric mean.
NARROW = 1.05
_STEP = 1e-4


@dataclass(frozen=True, eq=False)
class Counts:
    """What a fragility was fitted to: runs at levels of intensity.

    Attributes
    ----------
    intensity : ndarray, shape (k,)
        The levels.
    failed : ndarray, shape (k, n)
        1 where a run reached the limit state, 0 where it did not, NaN where there is no run; a
        column for each record.
    paired : bool
        Whether a column is the same record at all levels. The bootstrap then draws records, else
        it draws runs at each level.
    """

    intensity: Array
    failed: Array
    paired: bool

    @property
    def number(self) -> NDArray[np.int_]:
        """Runs at each level, shape (k,)."""
        return np.asarray(np.isfinite(self.failed).sum(axis=1))

    @property
    def failures(self) -> NDArray[np.int_]:
        """Runs at each level that reached the limit state, shape (k,)."""
        return np.asarray(np.nansum(self.failed, axis=1).astype(int))

    def fit(self) -> tuple[Array, Array]:
        """Return mean and spread of the logarithm of the capacity."""
        return fit_counts(self.intensity, self.number, self.failures)

    def fit_samples(self, random: np.random.Generator, n: int) -> tuple[Array, Array]:
        """Return the same for n bootstrap samples, each of shape (n,)."""
        if not self.paired:
            share = self.failures / np.maximum(self.number, 1)
            drawn = random.binomial(self.number, share, (n, self.intensity.size))
            return fit_counts(self.intensity, self.number, drawn.astype(float))
        failed = self.failed[:, random.integers(0, self.size, (n, self.size))].transpose(1, 0, 2)
        number = np.isfinite(failed).sum(axis=-1)
        return fit_counts(self.intensity, number, np.nansum(failed, axis=-1))

    @property
    def size(self) -> int:
        """Number of records."""
        return int(self.failed.shape[1])


@dataclass(frozen=True, eq=False)
class Capacities:
    """What a fragility was fitted to: the intensity at which each record reaches the limit state.

    Attributes
    ----------
    lower, upper : ndarray, shape (n,)
        Bounds of the capacity of each record; equal where it is known, the upper one infinite
        where it was not reached.
    """

    lower: Array
    upper: Array

    @property
    def known(self) -> bool:
        """Whether all capacities are known to within 5 %."""
        return bool((self.upper <= NARROW * self.lower).all())

    @property
    def values(self) -> Array:
        """Geometric means of the bounds, shape (n,); infinite where it was not reached."""
        return np.sqrt(self.lower * self.upper)

    def fit(self) -> tuple[Array, Array]:
        """Return mean and spread of the logarithm of the capacity."""
        return self._fit(np.arange(self.size))

    def fit_samples(self, random: np.random.Generator, n: int) -> tuple[Array, Array]:
        """Return the same for n bootstrap samples of the records, each of shape (n,)."""
        return self._fit(random.integers(0, self.size, (n, self.size)))

    def _fit(self, draws: NDArray[np.int_]) -> tuple[Array, Array]:
        if self.known:
            return fit_points(self.values[draws])
        return fit_brackets(self.lower[draws], self.upper[draws])

    @property
    def size(self) -> int:
        """Number of records."""
        return self.lower.size


@dataclass(frozen=True, eq=False, repr=False)
class Fragility:
    """A lognormal fragility curve.

    Attributes
    ----------
    name : str
        The limit state.
    theta : float
        Median capacity, in the unit of the intensity (m/s2 for accelerations).
    beta : float
        Standard deviation of the logarithm of the capacity.
    covariance : ndarray, shape (2, 2)
        Of the estimates of theta and beta, from the curvature of the likelihood.
    data : Counts or Capacities
        What it was fitted to.
    intensity_name : str
        Name of the intensity, for figures.
    """

    name: str
    theta: float
    beta: float
    covariance: Array
    data: Any
    intensity_name: str = ""

    def probability(self, intensity: ArrayLike) -> Array:
        """Return the probability of the limit state at intensities."""
        special = need_scipy("special")
        with np.errstate(divide="ignore"):
            z = np.log(np.asarray(intensity, dtype=float) / self.theta) / self.beta
        return np.asarray(special.ndtr(z))

    def samples(self, n: int = 1000, seed: int = 1) -> tuple[Array, Array]:
        """Return theta and beta of bootstrap samples of the records, each of shape (n,).

        Samples that do not determine a curve are left out.
        """
        number = _core.whole(n, "n")
        if number < 10:
            raise InputError(f"samples: n = {n} must be 10 or more")
        random = np.random.default_rng(_core.whole(seed, "seed"))
        mu, beta = self.data.fit_samples(random, number)
        good = np.isfinite(mu)
        return np.exp(mu[good]), beta[good]

    def band(
        self, intensity: ArrayLike, level: float = 0.9, n: int = 1000, seed: int = 1
    ) -> tuple[Array, Array]:
        """Return the confidence band of the curve by the bootstrap.

        Parameters
        ----------
        intensity : array_like, shape (m,)
            Intensities.
        level : float, optional
            Confidence.
        n, seed : int, optional
            Number of samples, and the seed of their draws.

        Returns
        -------
        tuple of ndarray, shape (m,)
            Lower and upper bound of the probability.
        """
        if not 0 < _core.number(level, "level") < 1:
            raise InputError(f"band: level = {level} must be above 0 and below 1")
        special = need_scipy("special")
        theta, beta = self.samples(n, seed)
        with np.errstate(divide="ignore"):
            u = np.log(np.atleast_1d(np.asarray(intensity, dtype=float)))
        curves = special.ndtr((u - np.log(theta)[:, None]) / beta[:, None])
        ends = np.quantile(curves, [0.5 - level / 2, 0.5 + level / 2], axis=0)
        return ends[0], ends[1]

    def mean_annual_frequency(self, hazard: Hazard) -> float:
        """Return how often a year the limit state is reached at a site.

        Parameters
        ----------
        hazard : Hazard
            Of the same intensity, in the same unit.

        Warns
        -----
        AccuracyWarning
            If more than a tenth comes from intensities beyond the points of the hazard.
        """
        if not isinstance(hazard, Hazard):
            raise InputError(
                f"hazard = {hazard!r} must be a Hazard; Hazard(intensity, frequency) makes one"
            )
        return hazard.frequency_of(float(np.log(self.theta)), self.beta)

    def plot(self, ax: Any = None, **line: Any) -> Any:
        """Draw the curve with its band and its data; see `rbsdem.ensembles.figure`."""
        return _views.view(self, "plot", ax, **line)

    def __repr__(self) -> str:
        se = np.sqrt(np.diag(self.covariance))
        return (
            f"Fragility({self.name!r}, theta={self.theta:.4g} +- {se[0]:.2g}, "
            f"beta={self.beta:.3g} +- {se[1]:.2g})"
        )


def fit_fragility(name: str, data: Counts | Capacities, intensity_name: str = "") -> Fragility:
    """Return the lognormal curve of largest likelihood.

    Parameters
    ----------
    name : str
        The limit state.
    data : Counts or Capacities
        Runs at levels (Baker 2015, eq 11), or capacities of records: mean and standard deviation of
        their logarithms (Baker 2015, eqs 1 and 2) where all are known, else the largest likelihood
        of their bounds.
    intensity_name : str, optional
        Name of the intensity.

    Raises
    ------
    InputError
        If no run reached the limit state, or all did, at every level.
    """
    who = f"fragility of {name}: "
    if data.size < 2:
        raise InputError(f"{who}{data.size} records; give two or more")
    if isinstance(data, Counts):
        failed, runs = int(data.failures.sum()), int(data.number.sum())
        if failed in (0, runs):
            which, other = ("no run reached", "higher") if failed == 0 else ("all reached", "lower")
            raise InputError(
                f"{who}{which} the limit state, of {runs}; add {other} levels of intensity"
            )
        if (data.number > 0).sum() < 2:
            raise InputError(f"{who}one level does not give a curve; give two or more")
    elif not ((data.lower >= 0) & (data.upper >= data.lower)).all():
        raise InputError(f"{who}bounds of capacities must be 0 or more, the lower one first")
    elif not np.isfinite(data.upper).any():
        raise InputError(
            f"{who}no record reached the limit state; raise the highest level of intensity"
        )
    elif not data.known and data.lower.max() < data.upper.min():
        raise InputError(
            f"{who}all records reach the limit state between the same two levels, "
            f"{data.lower.max():.4g} and {data.upper.min():.4g}; add levels between them"
        )
    mu, beta = (float(value) for value in data.fit())
    if not np.isfinite(mu):
        raise InputError(f"{who}the data do not determine a curve; add levels of intensity")
    if isinstance(data, Counts) and beta >= MOST_BETA:
        raise InputError(
            f"{who}the share of the runs that reach it does not grow with the intensity; add "
            "levels or records"
        )
    return Fragility(
        name, float(np.exp(mu)), beta, _covariance(data, mu, beta), data, intensity_name
    )


def _covariance(data: Counts | Capacities, mu: float, beta: float) -> Array:
    """Return the covariance of theta and beta; NaN where the likelihood has no curvature."""
    theta = np.exp(mu)
    if isinstance(data, Capacities) and data.known:
        n = data.size
        return np.diag([(theta * beta) ** 2 / n, beta**2 / (2 * (n - 1))])
    if beta <= LEAST_BETA * (1 + 1e-9):
        return np.full((2, 2), np.nan)
    hessian = np.empty((2, 2))
    at = np.array([mu, beta])
    steps = _STEP * beta * np.eye(2)
    for i in range(2):
        for j in range(2):
            ends = [
                _loss(data, *(at + a * steps[i] + b * steps[j])) * a * b
                for a in (1, -1)
                for b in (1, -1)
            ]
            hessian[i, j] = sum(ends) / (4 * (_STEP * beta) ** 2)
    try:
        found = np.linalg.inv(hessian)
    except np.linalg.LinAlgError:
        return np.full((2, 2), np.nan)
    to_theta = np.diag([theta, 1.0])
    return np.asarray(to_theta @ found @ to_theta)


def _loss(data: Counts | Capacities, mu: float, beta: float) -> float:
    """Return the negative logarithm of the likelihood."""
    special = need_scipy("special")
    if isinstance(data, Counts):
        z = (np.log(data.intensity) - mu) / beta
        k, n = data.failures, data.number
        return -float((k * special.log_ndtr(z) + (n - k) * special.log_ndtr(-z)).sum())
    with np.errstate(divide="ignore"):
        low, high = ((np.log(end) - mu) / beta for end in (data.lower, data.upper))
    exact = high - low <= 1e-12 / beta
    flip = low > 0
    lo, hi = np.where(flip, -high, low), np.where(flip, -low, high)
    with np.errstate(divide="ignore", invalid="ignore"):
        top, bottom = special.log_ndtr(hi), special.log_ndtr(lo)
        between = top + np.log1p(-np.exp(np.minimum(bottom - top, 0.0)))
    point = -0.5 * low**2 - np.log(beta)
    return -float(np.where(exact, point, between).sum())
