"""Cloud analysis: records as they are, and a regression of the response on the intensity."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array, ArrayLike, NDArray, Unpack
from rbsdem.errors import InputError
from rbsdem.many.fragility import MAKER, Fragile, Fragility, Hazard, checked_probability
from rbsdem.many.inputs import is_switch
from rbsdem.many.runs import RunOptions, Runs, make_collector, motions_by_name, own_records
from rbsdem.model.frame import Structure
from rbsdem.motions.motion import GroundMotion

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
    (b, a), covariance = np.polyfit(x, y, 1, cov=True)
    sigma = np.sqrt(((y - a - b * x) ** 2).sum() / (x.size - 2))
    return PowerLaw(float(a), float(b), float(sigma), covariance[::-1, ::-1])


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


_FEWEST = 3
_REACH = 6.0
_GRID = 2401


@dataclass(frozen=True, eq=False)
class CloudData:
    """What a fragility of a cloud was fitted to.

    Attributes
    ----------
    log_intensity : ndarray, shape (n,)
        Logarithms of the intensities.
    log_response : ndarray, shape (n,)
        Logarithms of the responses; infinite where the column collapsed.
    log_limit : float
        Logarithm of the limit state; infinite for the collapse.
    """

    log_intensity: Array
    log_response: Array
    log_limit: float

    @property
    def collapsed(self) -> NDArray[np.bool_]:
        """Which runs collapsed, shape (n,)."""
        return ~np.isfinite(self.log_response)

    @property
    def size(self) -> int:
        """Number of runs."""
        return self.log_intensity.size

    def parts(self) -> tuple[PowerLaw | None, Logistic | None]:
        """Return the line through the runs without collapse, and the curve of the collapses."""
        stands = ~self.collapsed
        line, logistic = None, None
        if np.isfinite(self.log_limit):
            line = fit_line(self.log_intensity[stands], self.log_response[stands])
        if self.collapsed.any():
            logistic = fit_logistic(self.log_intensity, self.collapsed)
        return line, logistic

    def curve(self, parts: tuple[PowerLaw | None, Logistic | None], log_intensity: Array) -> Array:
        """Return P(C) + (1 - P(C)) P(EDP > limit | no C) (Jalayer et al. 2017)."""
        from scipy import special  # noqa: PLC0415

        line, logistic = parts
        none = np.zeros_like(log_intensity)
        lost = none if logistic is None else logistic.probability(log_intensity)
        if line is None:
            return lost
        mean = line.a + line.b * log_intensity
        return np.asarray(lost + (1 - lost) * special.ndtr((mean - self.log_limit) / line.sigma))


@dataclass(frozen=True, eq=False, repr=False)
class CloudFragility(Fragility):
    """The fragility curve of a cloud, which is lognormal only where no run collapsed.

    `theta` is its median, `beta` half the distance of the logarithms of its 16 and 84 % points;
    their covariance is that of bootstrap samples.
    """

    def probability(self, intensity: ArrayLike) -> Array:
        """Return the probability of the limit state at intensities."""
        with np.errstate(divide="ignore"):
            u = np.log(np.asarray(intensity, dtype=float))
        return np.asarray(self.data.curve(self.data.parts(), u))

    def intensity(self, probability: ArrayLike) -> Array:
        """Return the intensities at which the limit state has given probabilities."""
        from scipy import optimize  # noqa: PLC0415

        p, parts = checked_probability(probability), self.data.parts()
        middle, found = float(np.log(self.theta)), np.empty(p.size)
        ends = np.array([middle - 4 * _REACH, middle + 4 * _REACH])
        reached = self.data.curve(parts, ends)
        for i, each in enumerate(p.ravel()):
            if not reached[0] < each < reached[1]:
                raise InputError(
                    f"probability = {each:g} is reached at no intensity near the runs; their "
                    f"curve goes from {reached[0]:.3g} to {reached[1]:.3g}"
                )
            found[i] = optimize.brentq(
                lambda u, each=each: float(self.data.curve(parts, np.array([u]))[0]) - each, *ends
            )
        return np.exp(found).reshape(p.shape)

    def samples(self, n: int = 1000, seed: int = 1) -> tuple[Array, Array]:
        """Return theta and beta of bootstrap samples of the runs, each of shape (n,)."""
        ends = [_theta_beta(data, data.parts()) for data in self._draws(n, seed)]
        found = np.array([end for end in ends if np.isfinite(end).all()]).reshape(-1, 2)
        return found[:, 0], found[:, 1]

    def band(
        self, intensity: ArrayLike, level: float = 0.9, n: int = 1000, seed: int = 1
    ) -> tuple[Array, Array]:
        """Return the confidence band of the curve by the bootstrap; see `Fragility.band`."""
        _arguments.number(level, "band: level", above=0, below=1)
        u = np.log(np.atleast_1d(np.asarray(intensity, dtype=float)))
        curves = [data.curve(data.parts(), u) for data in self._draws(n, seed)]
        ends = np.quantile(curves, [0.5 - level / 2, 0.5 + level / 2], axis=0)
        return ends[0], ends[1]

    def mean_annual_frequency(self, hazard: Hazard) -> float:
        """Return how often a year the limit state is reached.

        From the first point of the hazard on: below it the logistic curve of the collapses has a
        tail that no run supports.
        """
        _arguments.instance(hazard, "hazard", Hazard, MAKER)
        first = float(np.log(hazard.intensities[0]))
        u = np.linspace(first, max(first, float(np.log(self.theta))) + _REACH, 4 * _GRID)
        rate = hazard.exceeded(np.exp(u))
        middle = self.data.curve(self.data.parts(), 0.5 * (u[1:] + u[:-1]))
        return float((middle * -np.diff(rate)).sum())

    def _draws(self, n: int, seed: int) -> list[CloudData]:
        number = _arguments.integer(n, "n")
        if number < 10:
            raise InputError(f"samples: n = {n} must be 10 or more")
        random = np.random.default_rng(_arguments.integer(seed, "seed"))
        found = []
        for _ in range(number):
            draw = random.integers(0, self.data.size, self.data.size)
            drawn = self.data.log_intensity[draw], self.data.log_response[draw]
            data = CloudData(*drawn, self.data.log_limit)
            stands = np.unique(data.log_intensity[~data.collapsed])
            if stands.size >= _FEWEST or not np.isfinite(data.log_limit):
                found.append(data)
        return found


@dataclass(frozen=True, eq=False, repr=False)
class Cloud(Fragile[CloudFragility]):
    """Runs of records as they are.

    Attributes
    ----------
    runs : Runs
        All runs with their intensity, fate and measures.
    seconds : float
        Wall time.
    """

    runs: Runs
    seconds: float

    def regression(self, edp: str = "peak_drift") -> PowerLaw:
        """Return the line through ln EDP over ln IM of the runs without collapse."""
        line = self._data(edp, 1.0).parts()[0]
        assert line is not None
        return line

    def collapse_regression(self) -> Logistic:
        """Return the logistic curve of the collapses over ln IM."""
        logistic = self._data("collapse", np.inf).parts()[1]
        assert logistic is not None
        return logistic

    def fragility(self, edp: str = "peak_drift", threshold: float | None = None) -> CloudFragility:
        """Return the fragility curve of a limit state, collapses included (Jalayer et al. 2017).

        The parameters are those of `IDA.fragility`; of measures without threshold there is only
        "collapse", as the others have no size to regress.

        Raises
        ------
        InputError
            If there are too few runs for a line.
        """
        return self._one(edp, threshold)

    def _fit(self, name: str, measure: str, limit: float, beta: float | None) -> CloudFragility:
        if beta is not None:
            raise InputError(
                f"fragility of {name}: the spread of a cloud is that of its runs; leave beta out"
            )
        data = self._data(measure, limit)
        theta, beta = _theta_beta(data, data.parts())
        if not np.isfinite([theta, beta]).all():
            slope = next(part for part in data.parts() if part is not None)
            value = slope.b if isinstance(slope, PowerLaw) else slope.c1
            raise InputError(
                f"fragility of {name}: the response hardly grows with the intensity (slope "
                f"{value:.2g} over logarithms); add weaker and stronger records, as by scales"
            )
        label = self.runs.measure.label
        found = CloudFragility(name, theta, beta, np.zeros((2, 2)), data, label)
        samples = np.array(found.samples(200))
        return replace(found, covariance=np.cov(samples))

    def _data(self, measure: str, limit: float) -> CloudData:
        collapse = measure == "collapse"
        if is_switch(measure) and not collapse:
            raise InputError(f"cloud: {measure} has no size to regress; use stripes or ida")
        response = self.runs.response(measure)
        x = np.log(self.runs.intensity)
        kept = np.isinf(response) | (response > 0) | collapse
        stands = np.unique(x[kept & np.isfinite(response)])
        if not collapse and stands.size < _FEWEST:
            raise InputError(
                f"cloud: {stands.size} intensities without collapse; a line needs three or more"
            )
        if collapse and not np.isinf(response).any():
            raise InputError("cloud: no run collapsed; add stronger records, or scale them")
        with np.errstate(divide="ignore"):
            logs = np.zeros_like(response) if collapse else np.log(response)
        logs = np.where(np.isinf(response), np.inf, logs)
        return CloudData(x[kept], logs[kept], np.inf if collapse else float(np.log(limit)))

    def __repr__(self) -> str:
        return (
            f"Cloud({self.runs.measure.label}: {len(self.runs)} runs, "
            f"{int(self.runs.collapsed.sum())} collapses; {self.seconds:.3g} s)"
        )


def cloud(
    column: Structure | Sequence[Structure] | Mapping[str, Structure],
    motions: GroundMotion | Sequence[GroundMotion] | Mapping[str, GroundMotion],
    *,
    scales: ArrayLike = 1.0,
    **options: Unpack[RunOptions],
) -> Cloud:
    """Run records as they are, or by a factor of each.

    Parameters
    ----------
    column : Column or Frame, or sequence or mapping of them
        The column, or several, which are all run with every motion.
    motions : GroundMotion, or sequence or mapping of GroundMotion
        The records, many and of different strength.
    scales : array_like, shape () or (motions,), optional
        Factors of the records.
    **options
        As for `rbsdem.ida`, see `rbsdem.many.runs.RunOptions`.

    Returns
    -------
    Cloud
        Regression, fragilities, figure.

    Raises
    ------
    InputError
        Before the first run, with all that is wrong.
    """
    begin = time.perf_counter()
    found = motions_by_name(motions)
    factors = _arguments.finite_vector(scales, "scales", shape="1 or m")
    if factors.size not in (1, len(found)) or not (factors > 0).all():
        raise InputError(
            f"scales: {factors.size} factors for {len(found)} motions; give one, or one for each, "
            "above 0"
        )
    names, found = list(found), own_records(found, options)
    if factors.size > 1:
        factors = factors[[name in found for name in names]]
    options.setdefault("measures", ("peak_drift", "residual_drift", "peak_base_shear"))
    work = make_collector("cloud", column, found, **options)
    levels = np.broadcast_to((factors * work.unit)[:, None], (*work.shape, 1))
    work.run(levels.copy())
    return Cloud(work.finish(), time.perf_counter() - begin)


def _theta_beta(
    data: CloudData, parts: tuple[PowerLaw | None, Logistic | None]
) -> tuple[float, float]:
    """Return median and spread of the curve; NaN where it does not reach 16, 50 and 84 %."""
    middle = float(np.median(data.log_intensity))
    u = np.linspace(middle - _REACH, middle + _REACH, _GRID)
    p = data.curve(parts, u)
    # 15.87 and 84.13 %, so that a lognormal curve has its own spread.
    from scipy.special import ndtr  # noqa: PLC0415

    ends = ndtr(np.array([-1.0, 0.0, 1.0]))
    if not (p[0] < ends[0] and p[-1] > ends[2]) or (np.diff(p) < -1e-12).any():
        return np.nan, np.nan
    low, mid, high = np.interp(ends, p, u)
    return float(np.exp(mid)), float(0.5 * (high - low))
