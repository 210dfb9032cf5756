"""The function `calibrate`: search, refusals, and how well the test determines what was free.

J is the derivative of the error vector with respect to the fractions of the parameters, at the fit.
Parameters whose columns of J are almost parallel cannot be distinguished: their correlation is that
of (J'J)^-1.

The errors of a model at neighbouring points of a path are not independent, so s^2 (J'J)^-1, which
assumes that they are, would be far too small. The G half cycles of the test are taken as
independent instead: (J'J)^-1 (sum over half cycles of J_g'e_g e_g'J_g) (J'J)^-1 G/(G - 1),
the covariance for clustered errors (Liang & Zeger 1986, Biometrika 73; Cameron & Miller 2015,
Journal of Human Resources 50).
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any, Generic, TypeVar, cast

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._package import unwarned
from rbsdem._progress import progress_bar
from rbsdem._types import Array, DataFrame
from rbsdem.calibration.paths import Parameters, free_parameters
from rbsdem.calibration.search import AT_BOUND, LOSSES, Misfit, Search, Target, refused, rms
from rbsdem.curves.scores import Comparison, compare
from rbsdem.errors import InputError, warn
from rbsdem.model.column import Parameter
from rbsdem.model.frame import Structure
from rbsdem.run.result import reached_force

#: Number of random points, besides the start, at which the effect of a parameter is tried.
_LOOKS = 3


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


def undetermined(
    column: Structure,
    test: Any,
    free: Sequence[str],
    bounds: Mapping[str, Sequence[float]] | None = None,
) -> list[str]:
    """Return the parameters that a calibration would refuse: they change no force of the test.

    Parameters
    ----------
    column : Column or Frame
        The column.
    test : MeasuredTest, PeerTest, or pair of array_like of shape (m,)
        The measured loop.
    free : sequence of str
        Names of the parameters.
    bounds : mapping of str to (low, high), optional
        As for `calibrate`.

    Returns
    -------
    list of str
        Those that change no force between their bounds, from the start and from random points.

    Raises
    ------
    InputError
        For bad input.
    """
    target, parameters = Target(test), Parameters(column)
    chosen = free_parameters(parameters, free, bounds)
    with (
        unwarned(),
        Misfit(parameters.build, chosen, target, "nrmse", 1, lambda done, best: None) as misfit,
    ):
        return without_effect(misfit, _looks(misfit.start_fractions(), 0))


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
        Approximate limit for the analyses of the search. A few more show what the test determines.
    seconds : float, optional
        Wall time after which the search ends [s]; the fit then depends on the machine.

    Returns
    -------
    Calibration
        The fitted column, its parameters with standard errors and sensitivities, report and figure.
        A keyboard interrupt ends the search; the best fit so far is returned.

    Raises
    ------
    InputError
        For wrong input (unknown or repeated names, bounds that exclude the start), and for a
        parameter that changes no force of the test anywhere between its bounds.

    Warns
    -----
    AccuracyWarning
        If the test hardly determines a parameter, or does not distinguish two of them.
    """
    started = time.perf_counter()
    loss = _arguments.choice(loss, "calibrate: loss", LOSSES)
    _check(seed, jobs, evaluations, seconds)
    target = Target(test)
    parameters = Parameters(column)
    chosen = free_parameters(parameters, free, bounds)
    wanted = _arguments.boolean(progress, "calibrate: progress")
    showing = progress_bar(wanted, evaluations, "analyses")
    # Warnings about the many columns of the search do not help the user.
    with unwarned(), showing as show:
        with Misfit(parameters.build, chosen, target, loss, jobs, show) as misfit:
            start = misfit.start_fractions()
            misfit.column(start)
            refuse(misfit, without_effect(misfit, _looks(start, seed)))
            status = Search(misfit, seed, evaluations, seconds).run()
            fractions = misfit.best_fractions.copy()
            found, correlation = determine(misfit, fractions)
        fitted = cast(AnyStructure, misfit.column(fractions))
        before, after = (_compared(tried, target, column) for tried in (column, fitted))
    lines = tuple(warnings_of(found, correlation))
    for line in lines:
        warn(f"calibrate: {line}")
    return Calibration(
        column=fitted,
        start=column,
        parameters=found,
        before=before,
        after=after,
        correlation=correlation,
        status=status,
        warnings=lines,
        loss=loss,
        seed=seed,
        **{name: getattr(misfit, name) for name in ("evaluations", "failed", "refused")},
        seconds=time.perf_counter() - started,
    )


def _check(seed: int, jobs: int, evaluations: int, seconds: float | None) -> None:
    _arguments.integer(seed, "calibrate: seed", least=0)
    _arguments.integer(jobs, "calibrate: jobs", least=1)
    _arguments.integer(evaluations, "calibrate: evaluations", least=1)
    if seconds is not None:
        _arguments.number(seconds, "calibrate: seconds", above=0)


def _looks(start: Array, seed: int) -> list[Array]:
    """Return the points from which the effect of each parameter is tried."""
    return [start, *np.random.default_rng(seed).random((_LOOKS, start.size))]


def _compared(column: Structure, target: Target, start: Structure) -> Comparison:
    """Return the scores of a column; the force is NaN after the end of a failed analysis."""
    reached, _ = reached_force(column, target.displacement)
    force = np.full(target.force.size, np.nan)
    force[: reached.size] = reached
    loop = target.displacement, force
    return compare(loop, target, height=getattr(start, "height", None))


_HEAD = ["", "Unit", "Start", "Low", "High", "Fitted", "Std. error", "Effect", "Rise", "At"]

_SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio")

_LEGEND = (
    "Effect: rms change of the force over the peak, if the parameter changes by 10 % (of",
    "the distance between its bounds, if it may be 0). Rise: growth of the loss by that.",
)


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
    effect : float
        Root mean square change of the force over the measured peak, if the parameter alone changes
        by 10 % (of the distance between its bounds, if it may be 0 or negative).
    rise : float
        Increase of the loss by that change; NaN if such a column is refused.
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
    effect: float
    rise: float
    at_bound: str


#: A fit has the type of the structure that it was made for.
AnyStructure = TypeVar("AnyStructure", bound=Structure)


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
    evaluations, failed, refused : int
        Number of analyses, of those that did not reach the end of the test, and of columns that
        were refused (K_y above K_c) and cost no analysis.
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
    refused: int
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
        numbers |= {"standard_error": "{:.2g}".format, "effect": "{:.4f}".format}
        how: Any = {"formatters": numbers | {"rise": "{:+.4f}".format}, "na_rep": "-"}
        lines = [f"Fit to {self.after.name}", _text(scores, float_format="{:.4f}".format)]
        lines += [f"{self.status}: {done}", "", _text(table, index=False, header=_HEAD, **how)]
        lines += ["", *_LEGEND]
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


#: Change of a parameter for which its sensitivity is reported.
CHANGE = 0.1

#: Share of the peak force by which a parameter must change some force; otherwise it is refused.
NO_EFFECT = 1e-6

#: Root mean square change of the force over the peak, for CHANGE, below which a parameter is
#: hardly determined.
LITTLE_EFFECT = 1e-3

#: Correlation above which two parameters cannot be distinguished.
TOO_ALIKE = 0.95

#: Steps for a derivative, as shares of the distance between the bounds. The second is used if
#: nothing changes with the first.
_STEPS = 0.005, 0.05


def without_effect(misfit: Misfit, fractions: list[Array]) -> list[str]:
    """Return the names of the parameters that change no force between their bounds.

    Parameters
    ----------
    misfit : Misfit
        The misfit.
    fractions : list of ndarray, shape (p,)
        Points from which each parameter alone is moved to its bounds.
    """
    idle = list(range(len(misfit.free)))
    for base in fractions:
        base_vector = misfit.vector(base)
        if refused(base_vector):
            continue
        for i in list(idle):
            ends = [_moved(base, i, fraction) for fraction in (0.0, 0.5, 1.0)]
            for vector in misfit.vectors(ends):
                if not refused(vector) and np.max(np.abs(vector - base_vector)) > NO_EFFECT:
                    idle.remove(i)
                    break
        if not idle:
            break
    return [list(misfit.free)[i] for i in idle]


def refuse(misfit: Misfit, names: list[str]) -> None:
    """Raise `InputError` for parameters without effect."""
    if not names:
        return
    ranges = ", ".join(
        f"{name} from {misfit.free[name].low:g} to {misfit.free[name].high:g}" for name in names
    )
    largest = float(np.max(np.abs(misfit.target.displacement)))
    raise InputError(
        f"calibrate: the test cannot determine {ranges}: no force changes over displacements up "
        f"to {largest:g} m. Leave {'it' if len(names) == 1 else 'them'} out of free, or move the "
        "bounds"
    )


def determine(misfit: Misfit, fractions: Array) -> tuple[tuple[Fitted, ...], Array]:
    """Return the parameters at a fit, how well the test determines them, and their correlation.

    The correlation is NaN for a parameter with which no force changes.
    """
    size, vector = fractions.size, misfit.vector(fractions)
    jacobian = _derivatives(misfit, fractions, vector)
    seen = np.sqrt(np.mean(jacobian**2, axis=0)) > NO_EFFECT
    error, correlation = np.full(size, np.inf), np.full((size, size), np.nan)
    if seen.any():
        inverse = _inverse(jacobian[:, seen])
        spread = np.sqrt(np.diag(inverse))
        correlation[np.ix_(seen, seen)] = inverse / np.outer(spread, spread)
        covariance = _clustered(jacobian[:, seen], vector, inverse, _groups(misfit, vector))
        error[seen] = np.sqrt(np.diag(covariance))
    np.fill_diagonal(correlation, 1.0)
    found = []
    for i, ((name, one), fraction) in enumerate(zip(misfit.free.items(), fractions, strict=True)):
        value = one.at(fraction)
        bound = "low" if fraction < AT_BOUND else "high" if fraction > 1 - AT_BOUND else ""
        start = name, one.unit, one.what, one.value, one.low, one.high, value
        spread_of_value = float(error[i] * abs(one.per_fraction(value)))
        effect = _effect(misfit, fractions, i, one, vector)
        found.append(Fitted(*start, spread_of_value, *effect, bound))
    return tuple(found), correlation


def warnings_of(found: Sequence[Fitted], correlation: Array) -> list[str]:
    """Return a line for everything that the test does not determine."""
    lines = []
    for one in found:
        if np.isinf(one.standard_error):
            lines.append(
                f"{one.name}: no force of the test changes with it at the fit; other values fit "
                "just as well"
            )
        elif one.effect < LITTLE_EFFECT:
            lines.append(
                f"{one.name}: hardly determined, {CHANGE:.0%} more or less change the force by "
                f"{one.effect:.1e} of its peak"
            )
        if one.at_bound:
            lines.append(f"{one.name}: ended at its {one.at_bound} bound")
    return lines + [
        f"{found[j].name} and {one.name}: correlation {correlation[i, j]:+.3f}, the test does not "
        "distinguish them; fix one of them"
        for i, one in enumerate(found)
        for j in range(i)
        if abs(correlation[i, j]) > TOO_ALIKE
    ]


def _moved(fractions: Array, i: int, fraction: float) -> Array:
    moved = fractions.copy()
    moved[i] = fraction
    return moved


def _derivatives(misfit: Misfit, fractions: Array, vector: Array) -> Array:
    """Return the derivative of the vector with respect to each fraction."""
    jacobian = np.zeros((vector.size, fractions.size))
    for i in range(fractions.size):
        for step in _STEPS:
            jacobian[:, i] = _derivative(misfit, fractions, vector, i, step)
            if rms(jacobian[:, i]) > NO_EFFECT:
                break
    return jacobian


def _derivative(misfit: Misfit, fractions: Array, vector: Array, i: int, step: float) -> Array:
    """Return central differences; one-sided ones at a bound or next to a refused column."""
    ends = np.clip([fractions[i] - step, fractions[i] + step], 0.0, 1.0)
    sides = [(end, misfit.vector(_moved(fractions, i, end))) for end in ends]
    known = [(end, other) for end, other in sides if not refused(other)]
    if len(known) < 2:
        known.append((fractions[i], vector))
    if len(known) < 2 or known[0][0] == known[1][0]:
        return np.zeros(vector.size)
    return np.asarray((known[1][1] - known[0][1]) / (known[1][0] - known[0][0]))


def _inverse(jacobian: Array) -> Array:
    """Return (J'J)^-1, which is large but finite for parallel columns."""
    scale = np.sqrt(np.sum(jacobian**2, axis=0))
    scaled = jacobian / scale
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    inverse = (vectors / np.maximum(values, 1e-12)) @ vectors.T
    return np.asarray(inverse / np.outer(scale, scale))


def _groups(misfit: Misfit, vector: Array) -> Array:
    """Return the half cycle of each element; each ratio of a balanced loss has one of its own."""
    groups = misfit.target.half_cycle
    extra = vector.size - groups.size
    return np.concatenate((groups, groups[-1] + 1 + np.arange(extra))) if extra else groups


def _clustered(jacobian: Array, error: Array, inverse: Array, groups: Array) -> Array:
    several = np.unique(groups)
    if several.size <= jacobian.shape[1]:
        return np.full(inverse.shape, np.nan)
    scores = np.array([error[groups == g] @ jacobian[groups == g] for g in several])
    # As a square, so that round-off leaves no variance below 0.
    root = scores @ inverse
    return root.T @ root * (several.size / (several.size - 1.0))


def _effect(
    misfit: Misfit, fractions: Array, i: int, one: Parameter, vector: Array
) -> tuple[float, float]:
    """Return change of force and growth of the loss for 10 % more or less of a parameter.

    For a parameter that may be zero or negative it is 10 % of the distance between its bounds.
    """
    value, effect, rise = one.at(fractions[i]), 0.0, math.nan
    step = CHANGE * (value if one.logarithmic else one.high - one.low)
    for end in (value - step, value + step):
        moved = _moved(fractions, i, one.fraction(min(max(end, one.low), one.high)))
        if moved[i] == fractions[i]:
            continue
        other = misfit.vector(moved)
        if not refused(other):
            effect = max(effect, rms(other - vector))
            rise = float(np.fmax(rise, rms(other) - rms(vector)))
    return effect, rise
