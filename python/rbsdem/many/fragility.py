"""Fragility curves, and the hazard of a site: how often a year an intensity is exceeded."""

from __future__ import annotations

import math
import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike, DataFrame, NDArray
from rbsdem.errors import InputError, warn
from rbsdem.many.inputs import limit_states
from rbsdem.many.lognormal import Bounds, bounds_of_counts, fit_bounds, fit_points
from rbsdem.many.runs import Runs
from rbsdem.run.rows import bibtex
from rbsdem.section.strength import AXIAL_FAILURE_FACTORS

#: A frequency of which more than this part comes from beyond the given points is warned of.
_BEYOND = 0.1


@dataclass(frozen=True, eq=False, init=False)
class Hazard:
    """A hazard curve, a power law between its points and beyond them.

    Parameters
    ----------
    intensities : array_like, shape (m,)
        Intensities, ascending, in the unit of the fragility: m/s2 for accelerations.
    frequencies : array_like, shape (m,)
        Mean annual frequencies of their exceedance, descending.

    Raises
    ------
    InputError
        With a line for everything that is wrong.
    """

    intensities: Array
    frequencies: Array

    def __init__(self, intensities: ArrayLike, frequencies: ArrayLike) -> None:
        im = np.array(_arguments.finite_vector(intensities, "hazard: intensities"))
        rate = np.array(_arguments.finite_vector(frequencies, "hazard: frequencies"))
        faults = []
        if im.size != rate.size or im.size < 2:
            faults.append(
                f"hazard: {im.size} intensities and {rate.size} frequencies; give two or more, one "
                "frequency for each intensity"
            )
        if not (im > 0).all() or not (np.diff(im) > 0).all():
            faults.append("hazard: intensities must be above 0 and ascend strictly")
        if not (rate > 0).all() or not (np.diff(rate) < 0).all():
            faults.append("hazard: frequencies must be above 0 and descend strictly")
        _arguments.raise_faults(faults)
        for name, values in (("intensities", im), ("frequencies", rate)):
            values.flags.writeable = False
            _arguments.put(self, **{name: values})

    def exceeded(self, intensity: ArrayLike) -> Array:
        """Return the mean annual frequency with which intensities are exceeded."""
        u = np.log(_arguments.vector(intensity, "intensity", shape="any"))
        x, y = np.log(self.intensities), np.log(self.frequencies)
        i = np.clip(np.searchsorted(x, u) - 1, 0, x.size - 2)
        slope = np.diff(y) / np.diff(x)
        return np.asarray(np.exp(y[i] + slope[i] * (u - x[i])))

    def intensity(self, exceedance: str | float | tuple[float, float]) -> float:
        """Return the intensity that is exceeded with a probability or as often as is said.

        Parameters
        ----------
        exceedance : str, float or pair of floats
            "2 % in 50 years", or the same as a pair (0.02, 50) of probability and years, whose mean
            annual frequency -ln(1 - p)/years is that of a Poisson process; "475 years", a return
            period; or a mean annual frequency.

        Warns
        -----
        AccuracyWarning
            If the intensity is beyond the points of the hazard.

        Raises
        ------
        InputError
            If a text has another form, or a number is out of its range.
        """
        rate = _annual_frequency(exceedance)
        x, y = np.log(self.intensities), np.log(self.frequencies)
        i = int(np.clip(np.searchsorted(-y, -np.log(rate)) - 1, 0, x.size - 2))
        slope = (x[i + 1] - x[i]) / (y[i + 1] - y[i])
        intensity_at = float(np.exp(x[i] + slope * (np.log(rate) - y[i])))
        if not self.frequencies[-1] <= rate <= self.frequencies[0]:
            warn(
                f"hazard: a frequency of {rate:.4g} a year is beyond its points "
                f"({self.frequencies[0]:g} to {self.frequencies[-1]:g}); the power law of the "
                "nearest two is followed",
            )
        return intensity_at

    def frequency_of(self, mu: float, beta: float) -> float:
        """Return how often a year a limit state is reached whose fragility is lognormal.

        The integral of the hazard over the density of the capacity, in closed form for each power
        law: a sum of positive terms, each taken where its digits are.

        Parameters
        ----------
        mu, beta : float
            Mean and standard deviation of the logarithm of the capacity; beta above 0.

        Warns
        -----
        AccuracyWarning
            If more than a tenth comes from intensities beyond the points of the hazard.

        Raises
        ------
        InputError
            If mu is not finite, or beta not above 0.
        """
        mu, beta = _arguments.number(mu, "hazard: mu"), _arguments.number(beta, "hazard: beta")
        if not (np.isfinite(mu) and np.isfinite(beta) and beta > 0):
            raise InputError(
                f"hazard: mu = {mu:g}, beta = {beta:g}: the capacity needs a finite mu, and a beta "
                "above 0"
            )
        from scipy import special  # noqa: PLC0415

        x, y = np.log(self.intensities), np.log(self.frequencies)
        slope = np.diff(y) / np.diff(x)

        def part(low: float, high: float, segment: int) -> float:
            start = x[segment], y[segment]
            return _part(special, low, high, (*start, slope[segment]), mu, beta)

        # The outer laws go on beyond the points.
        with np.errstate(over="ignore"):
            inside = [part(x[i], x[i + 1], i) for i in range(slope.size)]
            before, behind = part(-np.inf, x[0], 0), part(x[-1], np.inf, -1)
        total = before + sum(inside) + behind
        # The share is by intensities, not by capacities: an intensity beyond the last point also
        # reaches all capacities below that point.
        failed = special.ndtr((x[[0, -1]] - mu) / beta) * self.frequencies[[0, -1]]
        beyond = before - failed[0] + behind + failed[1]
        share = beyond / total if 0.0 < total < np.inf else float(total > 0.0)
        if share > _BEYOND:
            warn(
                f"hazard: {100 * share:.0f} % of the mean annual frequency come from "
                f"intensities beyond its points ({self.intensities[0]:g} to "
                f"{self.intensities[-1]:g}); give it a wider range",
            )
        return float(total)


#: "2 % in 50 years", and "475 years".
_PROBABILITY = re.compile(r"\s*([\d.]+)\s*%\s*in\s*([\d.]+)\s*(?:years?|yrs?|a)?\s*", re.IGNORECASE)
_RETURN_PERIOD = re.compile(r"\s*([\d.]+)\s*(?:years?|yrs?|a)\s*", re.IGNORECASE)


def _annual_frequency(exceedance: Any) -> float:
    """Return the mean annual frequency of what `Hazard.intensity` takes."""
    who = "hazard: exceedance"
    if isinstance(exceedance, str):
        named, period = _PROBABILITY.fullmatch(exceedance), _RETURN_PERIOD.fullmatch(exceedance)
        try:
            if named is not None:
                return _annual_frequency((float(named[1]) / 100.0, float(named[2])))
            if period is not None:
                return 1.0 / _arguments.number(float(period[1]), f"{who}: years", above=0)
        except ValueError as error:
            if isinstance(error, InputError):
                raise
        raise InputError(
            f"{who} = {_arguments.shown(exceedance)} must be like '2 % in 50 years' or '475 years'"
        )
    if not isinstance(exceedance, (tuple, list)):
        return _arguments.number(exceedance, f"{who}: annual frequency", above=0)
    if len(exceedance) != 2:
        raise InputError(f"{who} has {len(exceedance)} numbers; give probability and years")
    p = _arguments.number(exceedance[0], f"{who}: probability", above=0, below=1)
    return -math.log1p(-p) / _arguments.number(exceedance[1], f"{who}: years", above=0)


def _part(
    special: Any, low: float, high: float, law: tuple[float, float, float], mu: float, beta: float
) -> float:
    """Return the integral of exp(y + s (u - x)) over the density of ln capacity, low to high.

    `law` is (x, y, s), a line of the hazard in logarithms; u = ln capacity is normal (mu, beta).
    The product is a normal density about mu + s beta^2. Where both ends lie on one side of it,
    each end is the product there times Mills' ratio, and no large exponents cancel.
    """
    x, y, s = law
    ends = [(end - mu) / beta - s * beta for end in (low, high)]
    if ends[0] < 0 < ends[1]:
        peak = y + s * (mu + 0.5 * s * beta**2 - x)
        # The centre lies between the ends: the difference of both integrals loses no digits.
        return float(np.exp(peak) * (special.ndtr(ends[1]) - special.ndtr(ends[0])))
    sign = 1.0 if ends[0] >= 0 else -1.0

    def tail(end: float, place: float) -> float:
        """Return the integral beyond an end; `place` is its distance from the centre in sigma."""
        if np.isinf(end):
            return 0.0
        product = np.exp(y + s * (end - x) - 0.5 * ((end - mu) / beta) ** 2)
        return float(0.5 * product * special.erfcx(sign * place / np.sqrt(2.0)))

    return sign * (tail(low, ends[0]) - tail(high, ends[1]))


#: Bounds of a capacity that differ by less than this count as one value, their geometric mean.
NARROW = 1.05
#: Share of bootstrap samples without a curve beyond which one is warned.
_LOST = 0.1
#: Quantile of 90 % of the normal distribution.
_NINETY = 1.2816
#: Bootstrap samples at the most.
_MOST_SAMPLES = 100_000


@dataclass(frozen=True, eq=False)
class Counts:
    """Data of a fragility: runs at levels of intensity.

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

    def bounds(self) -> Bounds:
        """Return the known bounds of the capacities."""
        return bounds_of_counts(self.intensity, self.number, self.failures)

    def fit_samples(
        self, random: np.random.Generator, n: int, beta: float | None = None
    ) -> tuple[Array, Array]:
        """Return mean and spread of the logarithm for n bootstrap samples, each of shape (n,)."""
        number, drawn = self.number, None
        if self.paired:
            failed = self.failed[:, random.integers(0, self.size, (n, self.size))]
            number = np.isfinite(failed).sum(axis=-1).T
            drawn = np.nansum(failed, axis=-1).T
        else:
            share = self.failures / np.maximum(number, 1)
            drawn = random.binomial(number, share, (n, self.intensity.size))
        return fit_bounds(bounds_of_counts(self.intensity, number, drawn), beta)[:2]

    @property
    def size(self) -> int:
        """Number of records."""
        return int(self.failed.shape[1])


@dataclass(frozen=True, eq=False)
class Capacities:
    """Data of a fragility: the intensity at which each record reaches the limit state.

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

    def bounds(self) -> Bounds:
        """Return the known bounds of the capacities."""
        return self._bounds(np.arange(self.size))

    def fit_samples(
        self, random: np.random.Generator, n: int, beta: float | None = None
    ) -> tuple[Array, Array]:
        """Return mean and spread of the logarithm for n bootstrap samples, each of shape (n,)."""
        draws = random.integers(0, self.size, (n, self.size))
        if self.known and beta is None:
            return fit_points(self.values[draws])
        return fit_bounds(self._bounds(draws), beta)[:2]

    def _bounds(self, draws: NDArray[np.int_]) -> Bounds:
        """Return the bounds of the records whose places are drawn, shape (..., n)."""
        known = self.known
        ends = (self.values, self.values) if known else (self.lower, self.upper)
        with np.errstate(divide="ignore"):
            low, high = (np.log(end[draws]) for end in ends)
        return Bounds(low, high, np.ones(draws.shape))

    @property
    def size(self) -> int:
        """Number of records."""
        return self.lower.size


MAKER = "Hazard(intensities, frequencies) makes one"


def checked_probability(probability: ArrayLike) -> Array:
    """Return probabilities that are above 0 and below 1."""
    p = _arguments.vector(probability, "probability", shape="any")
    wrong = p[~((p > 0) & (p < 1))]
    if wrong.size:
        raise InputError(f"probability = {wrong[0]:g} must be above 0 and below 1, as 0.5")
    return p


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
        Its data.
    intensity_name : str
        Name of the intensity, for figures.
    stated : bool
        Whether beta was stated, and theta alone fitted.
    model_beta : float
        The part of beta that the model adds to that of the records, as by what is not known of
        axial failure: beta is the root of the sum of squares.
    """

    name: str
    theta: float
    beta: float
    covariance: Array
    data: Any
    intensity_name: str = ""
    stated: bool = False
    model_beta: float = 0.0

    def citation(self) -> str:
        """Return the works behind the fit as BibTeX; those of its runs are in their `citation`."""
        return bibtex({"fragility"})

    def probability(self, intensity: ArrayLike) -> Array:
        """Return the probability of the limit state at intensities."""
        from scipy import special  # noqa: PLC0415

        with np.errstate(divide="ignore"):
            u = np.log(_arguments.vector(intensity, "intensity", shape="any") / self.theta)
        return np.asarray(special.ndtr(u / self.beta))

    def intensity(self, probability: ArrayLike) -> Array:
        """Return the intensities at which the limit state has given probabilities."""
        from scipy import special  # noqa: PLC0415

        p = checked_probability(probability)
        return np.asarray(self.theta * np.exp(self.beta * special.ndtri(p)))

    def samples(self, n: int = 1000, seed: int = 1) -> tuple[Array, Array]:
        """Return theta and beta of bootstrap samples of the records, each of shape (n,).

        Samples that do not determine a curve are left out.

        Warns
        -----
        AccuracyWarning
            If these are more than a tenth.

        Raises
        ------
        InputError
            If these are more than half.
        """
        number = _arguments.integer(n, "samples: n", least=10, most=_MOST_SAMPLES)
        random = np.random.default_rng(_arguments.seed(seed))
        mu, beta = self.data.fit_samples(random, number, self.beta if self.stated else None)
        good = np.isfinite(mu)
        lost = 1.0 - float(good.mean())
        if lost > _LOST:
            text = (
                f"fragility of {self.name}: {100 * lost:.0f} % of the bootstrap samples do not "
                "determine beta; add levels or records, or state beta"
            )
            if lost > 0.5:
                raise InputError(text)
            warn(f"{text}. The others are the band")
        return np.exp(mu[good]), np.hypot(beta[good], self.model_beta)

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
        _arguments.number(level, "band: level", above=0, below=1)
        from scipy import special  # noqa: PLC0415

        theta, beta = self.samples(n, seed)
        with np.errstate(divide="ignore"):
            u = np.log(_arguments.vector(intensity, "intensity", shape="1 or m"))
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
        _arguments.instance(hazard, "hazard", Hazard, MAKER)
        return hazard.frequency_of(float(np.log(self.theta)), self.beta)

    def __repr__(self) -> str:
        se = np.sqrt(np.diag(self.covariance))
        added = f", {self.model_beta:.2g} of it by axial failure" if self.model_beta else ""
        return (
            f"Fragility({self.name!r}, theta={self.theta:.4g} +- {se[0]:.2g}, "
            f"beta={self.beta:.3g} {'stated' if self.stated else f'+- {se[1]:.2g}'}{added})"
        )


def fit_fragility(
    name: str, data: Counts | Capacities, intensity_name: str = "", beta: float | None = None
) -> Fragility:
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
    beta : float, optional
        Standard deviation of the logarithm of the capacity, stated where the data do not determine
        it; the median alone is then fitted.

    Raises
    ------
    InputError
        If no run reached the limit state, or all did, at every level, or the data do not determine
        beta: runs of which at most one level has both outcomes, and bounds that have a value in
        common, or touch. The message gives between what the median lies.
    """
    who = f"fragility of {_arguments.text(name, 'fragility: name')}: "
    _arguments.text(intensity_name, "fragility: intensity_name")
    if not isinstance(data, (Counts, Capacities)):
        raise InputError(f"{who}data = {_arguments.shown(data)} must be Counts or Capacities")
    if beta is not None:
        beta = _arguments.number(beta, f"{who}beta", above=0, hint=", as 0.4")
    _check(who, data, beta)
    if isinstance(data, Capacities) and data.known and beta is None:
        mu, spread = (float(value) for value in fit_points(data.values))
        n = data.size
        covariance = np.diag([spread**2 / n, spread**2 / (2 * (n - 1))])
    else:
        bounds = data.bounds()
        estimate = fit_bounds(bounds, beta)
        mu, spread, covariance = float(estimate[0]), float(estimate[1]), estimate[2]
        if np.isinf(spread):
            raise InputError(
                f"{who}the share of the runs that reach it does not grow with the intensity; add "
                "levels or records"
            )
        if np.isnan(mu):
            raise InputError(who + _undetermined(bounds))
    to_theta, theta = np.diag([np.exp(mu), 1.0]), float(np.exp(mu))
    covariance = np.asarray(to_theta @ covariance @ to_theta)
    stated = beta is not None
    return Fragility(name, theta, spread, covariance, data, intensity_name, stated)


def _check(who: str, data: Counts | Capacities, beta: float | None) -> None:
    """Refuse data without any curve."""
    if data.size < 2:
        raise InputError(f"{who}{data.size} records; give two or more")
    if isinstance(data, Counts):
        failed, runs = int(data.failures.sum()), int(data.number.sum())
        if failed in (0, runs):
            which, other = ("no run reached", "higher") if failed == 0 else ("all reached", "lower")
            raise InputError(
                f"{who}{which} the limit state, of {runs}; add {other} levels of intensity"
            )
        if (data.number > 0).sum() < 2 and beta is None:
            raise InputError(f"{who}one level does not give a curve; give two or more")
    elif not ((data.lower >= 0) & (data.upper >= data.lower)).all():
        raise InputError(f"{who}bounds of capacities must be 0 or more, the lower one first")
    elif not np.isfinite(data.upper).any():
        raise InputError(
            f"{who}no record reached the limit state; raise the highest level of intensity"
        )
    elif not (data.lower > 0).any():
        raise InputError(
            f"{who}all records reached the limit state at the lowest level; give lower ones"
        )


def _undetermined(bounds: Bounds) -> str:
    """Return why the data determine no curve, and between which intensities the median is."""
    low, high = (float(np.exp(end)) for end in bounds.gap())
    if np.isnan(low):
        return "the fit has not come to an end; give intensities within a few powers of ten"
    where = f"above {low:.4g}" if np.isinf(high) else f"between {low:.4g} and {high:.4g}"
    return (
        "the data do not determine beta, as a step fits them as well as any curve; the median is "
        f"{where}. Add levels there, or state beta, as fragility(..., beta=0.4)"
    )


class WithFragility(Tabular, ABC):
    """Runs that fragility curves can be fitted to, each in its own way."""

    runs: Runs

    @property
    def at_ends(self) -> tuple[WithFragility, WithFragility] | None:
        """The same runs at both ends of the interval of what the model does not know."""
        return None

    @abstractmethod
    def _data(self, measure: str, limit: float) -> Counts | Capacities:
        """Return the data of the curve of a limit state."""

    def fragility(
        self, edp: str = "collapse", threshold: float | None = None, *, beta: float | None = None
    ) -> Fragility:
        """Return the fragility curve of a limit state, of largest likelihood (Baker 2015, eq 11).

        Parameters
        ----------
        edp : str, optional
            Measure of the response, as "peak_drift"; "collapse" and limit states, as "first_yield",
            have no threshold.
        threshold : float, optional
            Value of the measure at the limit state.
        beta : float, optional
            Standard deviation of the logarithm of the capacity, stated where the runs do not
            determine it; the median alone is then fitted. Otherwise that of the records; of an IDA
            of frames that may lose axial load with that of the drift at which they do, by the
            medians at both ends of its interval.

        Raises
        ------
        InputError
            If no record reached it, or in stripes all did, or the runs do not determine beta: one
            value lies within the bounds of all capacities, or they touch; at most one level of
            stripes has both outcomes. The message gives between what the median lies.
        """
        ((name, state),) = limit_states(edp, threshold).items()
        return self._fit(name, state, beta)

    def _fit(self, name: str, state: tuple[str, float], beta: float | None) -> Fragility:
        """Return a fragility; the scatter of the drift at axial failure, if known, widens it."""
        label = self.runs.measure.label
        curve = fit_fragility(name, self._data(*state), label, beta)
        if self.at_ends is None or beta is not None:
            return curve
        thetas = []
        for end, factor in zip(self.at_ends, AXIAL_FAILURE_FACTORS, strict=True):
            try:
                thetas.append(fit_fragility(name, end._data(*state), label, curve.beta).theta)
            except InputError as error:
                raise InputError(
                    f"axial failure at {factor:g} times its drift: {error}; beta= states the "
                    "dispersion, and ida(axial_failure=False) leaves this end out"
                ) from error
        # Eight of ten drifts lie between the ends.
        added = abs(math.log(thetas[1] / thetas[0])) / (2.0 * _NINETY)
        total = math.hypot(curve.beta, added)
        scale = np.diag([1.0, curve.beta / total])
        covariance = scale @ curve.covariance @ scale
        return replace(curve, beta=total, covariance=covariance, model_beta=added)

    def fragilities(
        self,
        limits: Mapping[str, Any],
        edp: str | None = None,
        beta: Mapping[str, float] | None = None,
    ) -> dict[str, Fragility]:
        """Return the fragility curves of several limit states.

        Parameters
        ----------
        limits : mapping
            By name a threshold of `edp`, or a pair of a measure and its threshold, as
            ``{"yield": ("first_yield", None), "repair": 0.01, "collapse": ("collapse", None)}``.
        edp : str, optional
            Measure of the thresholds that come alone, by default `Runs.drift_measure`.
        beta : mapping, optional
            By name a stated beta, as for `IDA.fragility`.

        Raises
        ------
        InputError
            If a curve is not determined, or a beta belongs to no limit state.
        """
        states, stated = limit_states(edp or self.runs.drift_measure, limits), dict(beta or {})
        if unknown := stated.keys() - states.keys():
            raise InputError(
                f"beta of {', '.join(sorted(unknown))}: no such limit state; there are "
                f"{', '.join(states)}"
            )
        return {name: self._fit(name, state, stated.get(name)) for name, state in states.items()}

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each run."""
        return self.runs.to_pandas()
