"""The function `calibrate`: a search for the least error, and what the test determines.

The force of a chain of straight lines is continuous in its parameters nearly everywhere, with kinks
where a spring takes another line, and the error has several minima. So least squares
(`scipy.optimize.least_squares`) start from the best points of a Latin hypercube, with coarse finite
differences, which smooth the kinks; then finer ones from the best of them, the last with the dogleg
method, which can reach the bounds.

The errors of a model at neighbouring points of a path are not independent, so s^2 (J'J)^-1, which
assumes that they are, would be far too small. The G half cycles of the test are taken as
independent instead: (J'J)^-1 (sum over half cycles of J_g'e_g e_g'J_g) (J'J)^-1 G/(G - 1),
the covariance for clustered errors (Liang & Zeger 1986, Biometrika 73; Cameron & Miller 2015,
Journal of Human Resources 50).
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from typing import Any, Generic, TypeVar, cast

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._package import unwarned
from rbsdem._progress import progress_bar
from rbsdem._types import Array, DataFrame
from rbsdem.calibration.paths import Parameters
from rbsdem.curves.metrics import N_POINTS, PathPoints, half_cycle_numbers, work
from rbsdem.curves.scores import Comparison, compare
from rbsdem.errors import InputError, warn
from rbsdem.model.column import Parameter
from rbsdem.run.response import reached_force
from rbsdem.section.frame import Structure

#: Errors that may be minimised. In "balanced", an error of 1 in the ratio of peaks, or of energies,
#: counts as an nrmse of `RATIO_WEIGHT`.
LOSSES, RATIO_WEIGHT = ("nrmse", "balanced"), 0.5
#: Error of a refused column as a share of the measured peak: larger than that of any analysis.
REFUSED = 10.0
#: Points of the hypercube for each free parameter, the least number of points, rounds in which
#: refused points are drawn again, and descents from the best points.
SAMPLES_EACH, SAMPLES_LEAST, DRAWS, STARTS = 10, 40, 20, 6
#: Descents from the best: steps of finite differences as shares of the distance between the bounds.
COARSE, MIDDLE, FINE = 0.02, 0.005, 0.0005
#: Points that are computed at a time.
BATCH = 16
#: A fraction closer to a bound than this is taken to be on it.
AT_BOUND = 1e-3
#: Change of the force over the peak, per fraction, below which a parameter has no effect.
NO_EFFECT = 1e-6
#: Correlation above which two parameters cannot be distinguished.
TOO_ALIKE = 0.95

#: A fit has the type of the structure that it was made for.
AnyStructure = TypeVar("AnyStructure", bound=Structure)


def free_names(column: Structure) -> dict[str, Parameter | None]:
    """Return the parameters of a column that may be free, with default bounds.

    Parameters
    ----------
    column : Column or Frame
        The column.

    Returns
    -------
    dict of str to Parameter or None
        Parameters by name; None if a calibration needs given bounds, as for a stiffness of 0.
    """
    return Parameters(column).known()


def calibrate(
    column: AnyStructure,
    test: Any,
    free: Sequence[str],
    bounds: Mapping[str, Sequence[float]] | None = None,
    loss: str = "nrmse",
    seed: int = 0,
    progress: bool = False,
    jobs: int = 1,
    *,
    evaluations: int = 800,
    seconds: float | None = None,
) -> Calibration[AnyStructure]:
    """Fit parameters of a column to a measured loop.

    The column is driven through the measured displacements. The error of the force is minimised by
    a Latin hypercube over the bounds and least squares from its best points (scipy). The same input
    gives the same fit.

    Parameters
    ----------
    column : Column or Frame
        The structure to start from. A column made from a drawing offers its parameters as
        `parameters` and changes them by `with_parameters`; in any other the names are paths, in a
        frame of its kinds of members (`Frame.named_kinds`).
    test : MeasuredTest, PeerTest, or pair of array_like of shape (m,)
        The measured loop: displacement [m] and net horizontal force [N], as for `rbsdem.compare`.
    free : sequence of str
        Names of the parameters to fit, such as "flexure.k_y", "shear.k", "flexure[0].d_y" (of the
        lowest joint), "flexure[*].k_y" (a factor on all joints); `free_names` lists them.
    bounds : mapping of str to (low, high), optional
        Bounds in place of the default ones, which are a factor of 5 up and down for a spring, as
        far as its rule allows, and 20 % for lengths and loads.
    loss : {"nrmse", "balanced"}, optional
        The error that is minimised: that of the force, alone or together with the errors of peak
        force and energy.
    seed : int, optional
        Seed of the random points.
    progress : bool, optional
        Show on stderr the number of finished analyses and the best error so far.
    jobs : int, optional
        Analyses at a time, in threads. The fit does not depend on it.
    evaluations : int, optional
        Approximate limit for the analyses of the search.
    seconds : float, optional
        Wall time after which the search ends [s]; the fit then depends on the machine.

    Returns
    -------
    Calibration
        The fitted column, its parameters with standard errors, report and figure. A keyboard
        interrupt ends the search; the best fit so far is returned.

    Raises
    ------
    InputError
        For wrong input: unknown or repeated names, bounds that exclude the start.

    Warns
    -----
    AccuracyWarning
        If the test does not determine a parameter, or does not distinguish two of them.
    """
    begin = time.perf_counter()
    loss = _arguments.choice(loss, "calibrate: loss", LOSSES)
    _arguments.integer(seed, "calibrate: seed", least=0)
    _arguments.integer(jobs, "calibrate: jobs", least=1)
    _arguments.integer(evaluations, "calibrate: evaluations", least=1)
    if seconds is not None:
        _arguments.number(seconds, "calibrate: seconds", above=0)
    target, parameters = Target(test), Parameters(column)
    chosen = parameters.free(free, bounds)
    wanted = _arguments.boolean(progress, "calibrate: progress")
    showing = progress_bar(wanted, evaluations, "analyses")
    # Warnings about the many columns of the search do not help the user.
    with unwarned(), showing as show, ThreadPoolExecutor(min(jobs, os.cpu_count() or 1)) as pool:
        limits = evaluations, begin + (np.inf if seconds is None else seconds)
        run = pool.map if jobs > 1 else map
        misfit = Misfit(parameters.build, chosen, target, loss, limits, show, run)
        misfit.column(misfit.start)
        status = misfit.search(seed)
        fitted, correlation = misfit.determine()
        best = cast(AnyStructure, misfit.column(misfit.best_fractions))
        before, after = (_compared(tried, target, column) for tried in (column, best))
    lines = tuple(_warnings(fitted, correlation))
    for line in lines:
        warn(f"calibrate: {line}")
    return Calibration(
        column=best,
        start=column,
        parameters=fitted,
        before=before,
        after=after,
        correlation=correlation,
        status=status,
        warnings=lines,
        loss=loss,
        seed=seed,
        evaluations=misfit.evaluations,
        failed=misfit.failed,
        seconds=time.perf_counter() - begin,
    )


def _compared(column: Structure, target: Target, start: Structure) -> Comparison:
    """Return the scores of a column; the force is NaN after the end of a failed analysis."""
    reached, _ = reached_force(column, target.displacement)
    force = np.full(target.force.size, np.nan)
    force[: reached.size] = reached
    loop = target.displacement, force
    return compare(loop, target, height=getattr(start, "height", None))


class Target:
    """A measured loop, ready to be compared with many computed ones.

    The error is that of `rbsdem.compare`: model minus test at points spaced evenly along the path
    of displacement, over the largest measured force. Its root mean square is the nrmse.

    Attributes
    ----------
    name : str
        Name of the test.
    displacement : ndarray, shape (rows,)
        Displacement of the top, row by row [m].
    force : ndarray, shape (rows,)
        Net horizontal force [N].
    peak : float
        Largest absolute force [N].
    half_cycle : ndarray of int, shape (points,)
        Number of the half cycle to which each point belongs.
    """

    def __init__(self, test: Any) -> None:
        self.name = str(getattr(test, "name", "") or "the test")
        self.displacement, self.force = _loop(test)
        self.peak = float(np.max(np.abs(self.force)))
        if not self.peak > 0:
            raise InputError("calibrate: the force of the test is 0 in every row")
        if not np.any(np.diff(self.displacement)):
            raise InputError(
                f"calibrate: the displacement of the test is {self.displacement[0]:g} m in every "
                "row; a loop needs one that changes"
            )
        self._points = PathPoints(self.displacement, N_POINTS, "displacement")
        self._test = self._points(self.force)
        self.half_cycle = half_cycle_numbers(self.displacement)[self._points.before]

    def error(self, force: Array) -> Array:
        """Return (model - test)/peak at the points, and 1 beyond the rows that were reached.

        Parameters
        ----------
        force : ndarray, shape (m,)
            Force of the model at the first m rows [N].
        """
        reached = force.size
        if reached < self.force.size:
            force = np.concatenate((force, np.zeros(self.force.size - reached)))
        error = (self._points(force) - self._test) / self.peak
        if reached < self.force.size:
            error[~self._points.reached(reached)] = 1.0
        return error

    def ratios(self, force: Array) -> tuple[float, float]:
        """Return peak and energy of the model over those of the test, for the rows reached."""
        if force.size < 2:
            return 0.0, 0.0
        d, test = self.displacement[: force.size], self.force[: force.size]
        done = work(d, test)[-1]
        energy = float(work(d, force)[-1] / done) if done > 0 else 1.0
        largest = float(np.max(np.abs(test)))
        return (float(np.max(np.abs(force))) / largest if largest > 0 else 1.0), energy


def _loop(test: Any) -> tuple[Array, Array]:
    """Return displacement and net horizontal force of a test or of a pair of arrays."""
    if hasattr(test, "displacement") and hasattr(test, "force"):
        test = test.displacement, test.force
    try:
        displacement, force = test
    except (TypeError, ValueError):
        raise InputError(
            f"calibrate: test: a {type(test).__name__} has no displacement and force; give a "
            "measured test, or a pair of arrays [m, N]"
        ) from None
    d = _arguments.finite_vector(displacement, "calibrate: displacement of the test")
    f = _arguments.finite_vector(force, "calibrate: force of the test")
    if d.size != f.size:
        raise InputError(
            f"calibrate: the test has {d.size} displacements and {f.size} forces; they must be "
            "equal in number"
        )
    if d.size < 3:
        raise InputError(f"calibrate: the test has {d.size} rows; a loop needs at least 3")
    return d, f


class SearchStopped(Exception):  # noqa: N818 - not an error: the search may do no more
    """The search has used up its analyses or its time."""


class Misfit:
    """The error of a column as a function of the fractions of its free parameters, from 0 to 1.

    It counts the analyses and keeps the best point.

    Parameters
    ----------
    build : callable
        Makes the column from values by name, or raises `InputError`.
    free : mapping of str to Parameter
        The parameters that are free, in order.
    target : Target
        The test.
    loss : str
        One of `LOSSES`.
    limits : tuple of float, optional
        Largest number of analyses of the search, and the time of its end [s].
    show : callable, optional
        Called with the number of analyses and the best loss so far, in words, after each.
    run : callable, optional
        Maps a function over points, as ``map``.
    """

    def __init__(
        self,
        build: Callable[[Mapping[str, float]], Structure],
        free: Mapping[str, Parameter],
        target: Target,
        loss: str = "nrmse",
        limits: tuple[float, float] = (np.inf, np.inf),
        show: Callable[[int, str], None] = lambda done, best: None,
        run: Callable[..., Any] = map,
    ) -> None:
        self._build, self.free, self.target, self.loss = build, dict(free), target, loss
        self._limits, self._show, self._run = limits, show, run
        self.evaluations = self.failed = 0
        values = self.free.values()
        self.start = np.array([parameter.fraction(parameter.value) for parameter in values])
        self.best, self.best_fractions = np.inf, self.start

    def column(self, fractions: Array) -> Structure:
        """Return the column, or raise `InputError` if it is refused."""
        pairs = zip(self.free.items(), fractions, strict=True)
        return self._build({name: each.at(float(fraction)) for (name, each), fraction in pairs})

    def vectors(self, points: Sequence[Array]) -> list[Array]:
        """Return the error vectors of some points, whose mean squares are to be minimised."""
        vectors = []
        for fractions, (vector, status) in zip(points, self._run(self._solve, points), strict=True):
            vectors.append(vector)
            if status == "refused":
                continue
            self.evaluations += 1
            self.failed += status == "failed"
            if rms(vector) < self.best:
                self.best, self.best_fractions = rms(vector), np.array(fractions, dtype=float)
            self._show(self.evaluations, f"nrmse {self.best:.4f}")
        return vectors

    def _solve(self, fractions: Array) -> tuple[Array, str]:
        """Return the error vector of a point, and "completed", "failed" or "refused"."""
        try:
            force, failed = reached_force(self.column(fractions), self.target.displacement)
        except InputError:
            ratios = 2 if self.loss == "balanced" else 0
            return np.full(N_POINTS + ratios, REFUSED), "refused"
        error = self.target.error(force)
        if self.loss == "balanced":
            # Scaled so that each ratio has its share in the mean square over the points.
            ratios_off = np.array(self.target.ratios(force)) - 1.0
            error = np.concatenate((error, RATIO_WEIGHT * np.sqrt(N_POINTS) * ratios_off))
        return error, "failed" if failed else "completed"

    def search(self, seed: int) -> str:
        """Search, and return the reason for the end."""
        try:
            for fractions in self._sample(np.random.default_rng(seed)):
                self._descend(fractions, COARSE, "trf", 12)
            self._descend(self.best_fractions, MIDDLE, "trf", 12)
            self._descend(self.best_fractions, FINE, "dogbox", 20)
        except SearchStopped as stopped:
            return str(stopped)
        except KeyboardInterrupt:
            return "interrupted"
        return "converged"

    def _limited(self, points: Sequence[Array]) -> list[Array]:
        """Return error vectors, or raise `SearchStopped` if the search may do no more."""
        if self.evaluations >= self._limits[0]:
            raise SearchStopped("evaluations used up")
        if time.perf_counter() > self._limits[1]:
            raise SearchStopped("time used up")
        return self.vectors(points)

    def _sample(self, random: np.random.Generator) -> list[Array]:
        """Return the best points of a Latin hypercube, the start among its points."""
        from scipy.stats import qmc  # noqa: PLC0415

        size = len(self.free)
        wanted = max(SAMPLES_EACH * size, SAMPLES_LEAST)
        wanted = int(min(wanted, max(self._limits[0] // 4, 1))) + 1
        hypercube = qmc.LatinHypercube(size, rng=random)
        points, losses = [self.start, *hypercube.random(wanted - 1)], list[float]()
        # Refused points are drawn again, as the allowed region is not a box.
        for _ in range(DRAWS):
            while len(losses) < len(points):
                batch = points[len(losses) : len(losses) + BATCH]
                losses += [rms(vector) for vector in self._limited(batch)]
            missing = wanted - sum(loss < REFUSED for loss in losses)
            if missing <= 0:
                break
            points += list(hypercube.random(missing))
        order = [i for i in np.argsort(losses, kind="stable") if losses[i] < REFUSED]
        return [points[i] for i in order[:STARTS]]

    def _descend(self, fractions: Array, step: float, method: Any, most: int) -> None:
        """Run least squares from a point; the best point on the way is kept."""
        from scipy.optimize import least_squares  # noqa: PLC0415

        vectors: dict[bytes, Array] = {}

        def error(at: Array) -> Array:
            """Return the error vector of a point, and keep it for its Jacobian."""
            vectors[at.tobytes()] = vector = self._limited([at])[0]
            return vector

        least_squares(
            error,
            np.clip(fractions, 1e-6, 1 - 1e-6),
            jac=lambda at: self.jacobian(at, step, vectors[at.tobytes()]),
            bounds=(0.0, 1.0),
            method=method,
            max_nfev=most,
            ftol=1e-6,
            xtol=1e-5,
            # As good as the decomposition of J, which many threads of BLAS slow down. It searches
            # a plane, so it needs two parameters.
            tr_solver="lsmr" if fractions.size > 1 else "exact",
        )

    def jacobian(self, fractions: Array, step: float, base: Array) -> Array:
        """Return finite differences in a direction that stays in bounds and is not refused."""
        size = fractions.size
        steps = np.where(fractions + step <= 1.0, step, -step)
        jacobian = np.zeros((base.size, size))
        for i, vector in enumerate(self._limited(list(fractions + np.diag(steps)))):
            if refused(vector):
                steps[i] *= -1.0
                other = fractions + steps[i] * np.eye(size)[i]
                vector = self._limited([other])[0] if 0 <= other[i] <= 1 else vector  # noqa: PLW2901
            if not refused(vector):
                jacobian[:, i] = (vector - base) / steps[i]
        return jacobian

    def determine(self) -> tuple[tuple[Fitted, ...], Array]:
        """Return the parameters at the best point, with standard errors, and their correlation.

        A parameter with which no force changes goes back to its start; its correlation is NaN.
        """
        self._limits = np.inf, np.inf
        fractions = self.best_fractions.copy()
        base = self.vectors([fractions])[0]
        jacobian = self.jacobian(fractions, FINE, base)
        seen = np.sqrt(np.mean(jacobian**2, axis=0)) > NO_EFFECT
        error, correlation = np.full(fractions.size, np.inf), np.eye(fractions.size)
        correlation[~seen] = correlation[:, ~seen] = np.nan
        np.fill_diagonal(correlation, 1.0)
        if seen.any():
            covariance, inverse = self._covariance(jacobian[:, seen], base)
            spread = np.sqrt(np.diag(inverse))
            correlation[np.ix_(seen, seen)] = inverse / np.outer(spread, spread)
            error[seen] = np.sqrt(np.diag(covariance))
        back = np.where(seen, fractions, self.start)
        if not seen.all() and rms(self.vectors([back])[0]) <= self.best:
            fractions = self.best_fractions = back
        fitted = []
        for (name, each), fraction, spread in zip(self.free.items(), fractions, error, strict=True):
            value = each.at(fraction)
            bound = "low" if fraction < AT_BOUND else "high" if fraction > 1 - AT_BOUND else ""
            spread_of_value = float(spread * abs(each.per_fraction(value)))
            start = each.unit, each.what, each.value, each.low, each.high
            fitted.append(Fitted(name, *start, value, spread_of_value, bound))
        return tuple(fitted), correlation

    def _covariance(self, jacobian: Array, error: Array) -> tuple[Array, Array]:
        """Return the covariance for errors clustered by half cycles, and (J'J)^-1.

        The inverse is large but finite for parallel columns of the Jacobian. Each ratio of a
        balanced loss is a cluster of its own.
        """
        scale = np.sqrt(np.sum(jacobian**2, axis=0))
        values, vectors = np.linalg.eigh((jacobian / scale).T @ (jacobian / scale))
        inverse = (vectors / np.maximum(values, 1e-12)) @ vectors.T / np.outer(scale, scale)
        groups = self.target.half_cycle
        groups = np.append(groups, groups[-1] + 1 + np.arange(error.size - groups.size))
        several = np.unique(groups)
        if several.size <= jacobian.shape[1]:
            return np.full(inverse.shape, np.nan), inverse
        scores = np.array([error[groups == g] @ jacobian[groups == g] for g in several])
        # A product of a matrix with its transpose, so that round-off leaves no variance below 0.
        root = scores @ inverse
        return root.T @ root * (several.size / (several.size - 1.0)), inverse


def rms(vector: Array) -> float:
    """Return the loss: the root of the sum of squares over the number of points."""
    return float(np.sqrt(vector @ vector / N_POINTS))


def refused(vector: Array) -> bool:
    """Return whether a vector stands for a column that is refused."""
    return bool(vector[0] == REFUSED and vector[-1] == REFUSED)


@dataclass(frozen=True, slots=True)
class Fitted:
    """One parameter after a calibration.

    Attributes
    ----------
    name, unit, what : str
        Name, unit and meaning.
    start, low, high, value : float
        Initial value, bounds, and fitted value [unit].
    standard_error : float
        Standard error of the value [unit], from the scatter between half cycles; infinite if no
        force of the test changes with the parameter, NaN if there are too few half cycles.
    at_bound : str
        "low" or "high" if the fit ended at that bound, otherwise "".
    """

    name: str
    unit: str
    what: str
    start: float
    low: float
    high: float
    value: float
    standard_error: float
    at_bound: str


def _warnings(fitted: Sequence[Fitted], correlation: Array) -> list[str]:
    """Return a line for everything that the test does not determine."""
    lines = []
    for each in fitted:
        if np.isinf(each.standard_error):
            lines.append(
                f"{each.name}: no force of the test changes with it at the fit; other values fit "
                "just as well"
            )
        elif each.at_bound:
            lines.append(f"{each.name}: ended at its {each.at_bound} bound")
    return lines + [
        f"{fitted[j].name} and {each.name}: correlation {correlation[i, j]:+.3f}, the test does "
        "not distinguish them; fix one of them"
        for i, each in enumerate(fitted)
        for j in range(i)
        if abs(correlation[i, j]) > TOO_ALIKE
    ]


_HEAD = ["", "Unit", "Start", "Low", "High", "Fitted", "Std. error", "At"]
_SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio")


@dataclass(frozen=True, repr=False, eq=False)
class Calibration(Tabular, Generic[AnyStructure]):
    """A column fitted to a test.

    Attributes
    ----------
    column, start : Column or Frame
        The fitted column and the initial one.
    parameters : tuple of Fitted
        The parameters that were free.
    before, after : Comparison
        Scores of the two columns against the test.
    correlation : ndarray, shape (p, p)
        Correlation of the estimates.
    status : str
        "converged", "evaluations used up", "time used up" or "interrupted".
    warnings : tuple of str
        What the test does not determine.
    loss, seed : str, int
        The loss that was minimised, and the seed of the search.
    evaluations, failed : int
        Number of analyses, and of those that did not reach the end of the test.
    seconds : float
        Wall time [s].
    """

    column: AnyStructure
    start: AnyStructure
    parameters: tuple[Fitted, ...]
    before: Comparison
    after: Comparison
    correlation: Array
    status: str
    warnings: tuple[str, ...]
    loss: str
    seed: int
    evaluations: int
    failed: int
    seconds: float

    @property
    def nrmse(self) -> float:
        """Root mean square error of the force over the measured peak, after the fit."""
        return self.after.nrmse

    @property
    def values(self) -> dict[str, float]:
        """The fitted values by name."""
        return {fitted.name: fitted.value for fitted in self.parameters}

    @property
    def report(self) -> str:
        """The fit as plain text."""
        scores = data_frame(
            {
                when: {name.replace("_", " "): getattr(each, name) for name in _SCORES}
                for when, each in (("before", self.before), ("after", self.after))
            }
        )
        failed = f", {self.failed} of them not to the end" if self.failed else ""
        done = f"{self.evaluations} analyses in {self.seconds:.2f} s{failed}"
        table = self.to_pandas().drop(columns="what").replace({"unit_of_values": {"": "-"}})
        numbers = dict.fromkeys(("start", "low", "high", "value"), "{:.4g}".format)
        how: Any = {"formatters": numbers | {"standard_error": "{:.2g}".format}}
        lines = [f"Fit to {self.after.name}", _text(scores, float_format="{:.4f}".format)]
        lines += [f"{self.status}: {done}", "", _text(table, index=False, header=_HEAD, **how)]
        if len(self.parameters) > 1:
            names = list(self.values)
            lower = data_frame(np.where(np.tri(len(names)), self.correlation, np.nan))
            told = _text(lower.set_index([names]), header=False, float_format="{:+.2f}".format)
            lines += ["", "Correlation", told]
        return "\n".join([*lines, *(f"\nWarning: {line}" for line in self.warnings)])

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame with a row for each parameter: the attributes of `Fitted`."""
        frame = data_frame([asdict(fitted) for fitted in self.parameters])
        return frame.rename(columns={"unit": "unit_of_values"})


def _text(frame: DataFrame, **how: Any) -> str:
    """Return a table as text; what is not known is a dash."""
    return str(frame.to_string(**{"na_rep": "-"} | how))
