"""The case of a study of methods, and its settings from coarse to fine within a budget of time."""

from __future__ import annotations

import dataclasses
import math
import time as clock
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice, pairwise
from typing import Any, cast

import numpy as np

from rbsdem import _arguments
from rbsdem._package import unwarned
from rbsdem._types import Array, ArrayLike, NDArray
from rbsdem.errors import AccuracyWarning, InputError, LongRunWarning, RbsdemError, SolveError
from rbsdem.model.column import Kinematics, notes_off
from rbsdem.run.accuracy import Answer, answer_of, common_interval
from rbsdem.run.response import cyclic, time_history
from rbsdem.run.solver import IMPLICIT, IN_TIME, METHODS, Solver
from rbsdem.section.frame import Frame, Structure, checked_structure

#: Least number of times at which histories are compared; a loading with fewer is interpolated.
LEAST_ROWS = 200

#: Runs shorter than this are repeated until they take as long together [s].
SHORT = 0.05

#: Loads that only act on columns with second-order work, or whose joints open.
VERTICAL = ("vertical_acceleration", "axial_load")


@dataclass(frozen=True)
class Setting:
    """How a case is solved.

    Attributes
    ----------
    method : str
        A method of `rbsdem.time_history`, or "static".
    kinematics : str
        Level of kinematics.
    dt, tolerance : float or None
        Step [s] or tolerance, whichever the method has.
    events : str or None
        Where "rk4" changes lines: "step" or "located".
    parts : int or None
        Static: equal parts of each increment of the path; 0 where only its reversals are driven.
    rho_infinity : float or None
        Spectral radius of "hht" and "generalised_alpha"; None for the default.
    own : bool
        Whether the user gave this setting.
    """

    method: str
    kinematics: Kinematics
    dt: float | None = None
    tolerance: float | None = None
    events: str | None = None
    parts: int | None = None
    rho_infinity: float | None = None
    own: bool = False

    @property
    def solver(self) -> Solver:
        """The settings of the method."""
        names = [name for name in Solver.__annotations__ if getattr(self, name, None) is not None]
        return cast(Solver, {name: getattr(self, name) for name in names})

    @property
    def family(self) -> tuple[str, str | None, Kinematics, float | None, bool]:
        """Key of the settings that differ only in step, tolerance or parts."""
        return self.method, self.events, self.kinematics, self.rho_infinity, self.own

    @property
    def name(self) -> str:
        """The method, and whether it locates the events at which springs change lines."""
        return f"{self.method}, located" if self.events == "located" else self.method

    @property
    def value(self) -> str:
        """The step, tolerance or division of the path, in words."""
        if self.dt is not None:
            return f"dt = {self.dt:.4g} s"
        if self.tolerance is not None:
            return f"tolerance = {self.tolerance:.0e}"
        if self.parts is None:
            return "step chosen"
        if self.parts == 0:
            return "reversals only"
        return "points as given" if self.parts == 1 else f"increments in {self.parts}"

    def __str__(self) -> str:
        return ", ".join(filter(None, (self.name, self.value, self.kinematics)))


@dataclass(frozen=True, eq=False)
class MethodRun:
    """A setting with its cost and its errors, or the reason why it was not run.

    Attributes
    ----------
    setting : Setting
        The setting.
    seconds : float
        Median wall time of `repeats` runs [s]; nan if there is no answer.
    repeats : int
        Number of runs.
    status : str
        "completed", "collapsed", "failed" (`SolveError`), "refused" (`InputError`) or "skipped".
    reason : str
        Why there is no answer; the choice of method "auto" if there is one.
    response_rms, response_max : float
        Root mean square and largest difference of the top displacement (lateral force, if the
        displacement is driven) from the reference over its peak, at the times of the loading.
    moment : float
        Root mean square difference of the base moment over its peak.
    energy : float
        Difference of the energy that springs and damping have taken by the end, over its largest
        value.
    peak : float
        Relative difference of the peak response.
    error : float
        The largest of response_rms, moment, energy and peak.
    move : float
        `error` of this setting against the next finer one of its family, which a user without a
        reference would see; nan if there is no finer one.
    pareto : bool
        Whether no other setting is both faster and more accurate.
    solution : Answer or None
        The answer, if there is one.
    """

    setting: Setting
    seconds: float = math.nan
    repeats: int = 0
    status: str = "completed"
    reason: str = ""
    response_rms: float = math.nan
    response_max: float = math.nan
    moment: float = math.nan
    energy: float = math.nan
    peak: float = math.nan
    error: float = math.nan
    move: float = math.nan
    pareto: bool = False
    solution: Answer | None = None

    @property
    def answer(self) -> Answer:
        """The answer of a setting that has one."""
        assert self.solution is not None
        return self.solution


@dataclass(frozen=True)
class StudyCase:
    """One structure under one loading.

    Attributes
    ----------
    column : Column or Frame
        The structure.
    time : ndarray, shape (m,)
        Times of the loading [s]; for a static path the numbers of its points.
    loads : dict of ndarray, shape (m,)
        The loads by name. A static path has one of them, "force" or "displacement".
    initial : mapping or None
        State at the start, as for `time_history`.
    collapse_drift : float or None
        As for `time_history`.
    static : bool
        Whether the path is static.
    """

    column: Structure
    time: Array
    loads: dict[str, Array]
    initial: Mapping[str, ArrayLike] | None = None
    collapse_drift: float | None = None
    static: bool = False

    @property
    def response_name(self) -> str:
        """Quantity of the response: "displacement", or "force" where the displacement is driven."""
        return "force" if "displacement" in self.loads else "displacement"

    def solve(self, setting: Setting, column: Structure | None = None) -> Answer:
        """Return the answer of a setting, for another column if one is given."""
        column = self.column if column is None else column
        if column.kinematics != setting.kinematics:
            with notes_off():
                level: Any = setting.kinematics
                column = dataclasses.replace(column, kinematics=level)
        with unwarned(AccuracyWarning, LongRunWarning):
            if self.static:
                return self._solve_static(setting, column)
            result = time_history(column, self.time, **self.keywords(setting, column))
        return answer_of(result, self.time)

    def keywords(self, setting: Setting, column: Structure) -> dict[str, Any]:
        """Return the arguments of `time_history` for a setting."""
        loads: dict[str, Any] = dict(self.loads)
        if column.kinematics == "small" and not column.opens:
            # These loads would have nothing to act on and would be refused.
            loads = {name: load for name, load in loads.items() if name not in VERTICAL}
        how = {"initial": self._initial(column.n), "collapse_drift": self.collapse_drift}
        return {**loads, **setting.solver, **how}

    def _initial(self, n: int) -> Mapping[str, ArrayLike] | None:
        """Return the state at the start; where bodies are cut in two, the halves share it."""
        if self.initial is None or n == self.column.n:
            return self.initial
        parts = n // self.column.n
        return {
            name: np.repeat(np.atleast_1d(values), parts) / parts
            for name, values in self.initial.items()
        }

    def _solve_static(self, setting: Setting, column: Structure) -> Answer:
        """Return the answer at the points of the path, however it is divided."""
        (name, path), parts = next(iter(self.loads.items())), setting.parts
        kept = reversals(path)
        if parts == 0:
            driven = path[kept]
        else:
            parts = parts or 1
            fine = np.arange(parts * (path.size - 1) + 1) / parts
            driven = np.interp(fine, self.time, path)
            # The points that were given, to the last digit.
            driven[::parts] = path
        every = parts if parts and parts > 1 else None
        load: dict[str, Any] = {name: driven}
        result: Any = cyclic(column, **load, every=every, collapse_drift=self.collapse_drift)
        response = result.force if name == "displacement" else result.displacement
        histories = [response, result.base_action, result.energy["spring"]]
        if parts == 0:
            # A point in between lies on the straight line of its leg, at its driven value.
            place, rows = along(path, kept), np.arange(response.size)
            histories = [np.interp(place, rows, values) for values in histories]
        points = np.arange(histories[0].size, dtype=np.float64)
        status = result.summary.get("status", "completed")
        response, moment, taken = map(np.array, histories)
        return Answer(points, response, moment, taken, status)

    def run(
        self,
        setting: Setting,
        repeats: int = 1,
        column: Structure | None = None,
        seconds: float = 1e9,
    ) -> MethodRun:
        """Return the answer of a setting and the median of its wall times, or why it has no answer.

        Parameters
        ----------
        setting : Setting
            The setting.
        repeats : int
            Number of runs; more where they are very short.
        column : Column, optional
            Another column in place of the case's.
        seconds : float
            Wall time after which the runs are not repeated any more [s].
        """
        times = []
        begin = clock.perf_counter()
        try:
            while True:
                start = clock.perf_counter()
                answer = self.solve(setting, column)
                end = clock.perf_counter()
                times.append(end - start)
                enough = len(times) >= repeats and (repeats == 1 or end - begin > SHORT)
                if enough or end - begin > seconds:
                    break
        except InputError as error:
            return MethodRun(setting, status="refused", reason=str(error))
        except SolveError as error:
            taken = float(np.median(times or [clock.perf_counter() - begin]))
            return MethodRun(setting, taken, 1, "failed", str(error))
        median, reason = float(np.median(times)), answer.reason
        return MethodRun(setting, median, len(times), answer.status, reason, solution=answer)


def study_case(
    column: Structure,
    time: ArrayLike | None,
    loads: Mapping[str, ArrayLike],
    initial: Mapping[str, ArrayLike] | None,
    collapse_drift: float | None,
) -> StudyCase:
    """Check a loading and return the case.

    Raises
    ------
    InputError
        If the loads do not go together.
    """
    checked_structure(column, "compare_methods: ")
    if not isinstance(initial, Mapping | None):
        raise InputError(
            f"compare_methods: initial = {_arguments.shown(initial)} must be a mapping of slips, "
            "rotations and velocities; the state in which a result ended is for time_history"
        )
    histories = {name: _arguments.finite_vector(values, name) for name, values in loads.items()}
    if time is None:
        if set(histories) not in ({"displacement"}, {"force"}):
            names = ", ".join(histories) or "none"
            raise InputError(
                "compare_methods: without time the path is static and needs exactly one of "
                f"displacement and force; given: {names}"
            )
        if initial is not None:
            raise InputError(
                "compare_methods: initial has no meaning for a static path; give time as well"
            )
        (path,) = histories.values()
        if path.size < 2:
            raise InputError(
                f"compare_methods: the path has too few points ({path.size}); give 2 or more"
            )
        points = np.arange(float(path.size))
        return StudyCase(column, points, histories, None, collapse_drift, static=True)
    if "displacement" in histories:
        raise InputError(
            "compare_methods: displacement drives a static path only; remove it, or time"
        )
    if not histories and not initial:
        raise InputError(
            "compare_methods: nothing moves the column; give a load or an initial state"
        )
    times = _arguments.finite_vector(time, "time")
    for name, values in histories.items():
        if values.size != times.size:
            raise InputError(f"{name} has {values.size} values for {times.size} times")
    if times.size < 2 or not np.all(np.diff(times) > 0):
        raise InputError("time: give two or more, each after the one before")
    parts = -(-LEAST_ROWS // (times.size - 1))
    if parts > 1:
        place = np.arange(parts * (times.size - 1) + 1) / parts
        old = np.arange(times.size)
        histories = {name: np.interp(place, old, values) for name, values in histories.items()}
        times = np.interp(place, old, times)
    return StudyCase(column, times, histories, initial, collapse_drift)


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


#: Levels of kinematics, each with more physics than the one before.
LEVELS: tuple[Kinematics, ...] = ("small", "pdelta", "finite")

#: Rungs of a ladder: steps are halved, tolerances divided by ten.
RK4_RUNGS, IMPLICIT_RUNGS, TOLERANCES = 7, 8, range(4, 11)

#: Cost of a step of rk45 in steps of rk4; its longest stable step as a share of that of rk4; and
#: the tolerance below which accuracy, not stability, limits the step.
PAIR_COST, PAIR_SHARE, PAIR_TOLERANCE = 7 / 4, METHODS["rk45"].limit_share, 1e-8


class Budget:
    """Wall time that may be used.

    Parameters
    ----------
    seconds : float
        The whole budget [s].
    """

    def __init__(self, seconds: float) -> None:
        self.seconds = seconds
        self.begin = clock.perf_counter()

    def used(self) -> float:
        """Return the time used so far [s]."""
        return clock.perf_counter() - self.begin

    def left(self, share: float = 1.0) -> float:
        """Return the rest of a share of the budget, counted from the start [s]."""
        return share * self.seconds - self.used()


@dataclass(frozen=True)
class Probe:
    """Costs and limits of a case in time, from a first look at it.

    Attributes
    ----------
    duration, interval : float
        Time from the first to the last row of the loading, and between two rows [s].
    regular : bool
        Whether the interval divides all intervals of the loading.
    limit : float
        Longest stable step of rk4 [s].
    explicit, implicit : float
        Wall time of a step of rk4 and of an implicit step [s]; infinite if the method fails.
    """

    duration: float
    interval: float
    regular: bool
    limit: float
    explicit: float
    implicit: float

    def seconds(self, setting: Setting) -> float:
        """Return an estimate of the wall time of a setting [s]."""
        rows = self.duration / self.interval
        if setting.method in ("auto", "rk45"):
            tolerance = setting.tolerance or 1e-6
            shortest = PAIR_SHARE * self.limit * min(math.pow(tolerance / PAIR_TOLERANCE, 0.2), 1.0)
            pair = PAIR_COST * self.explicit * max(self.duration / shortest, rows)
            if setting.method == "rk45":
                return pair
            implicit = self.implicit * rows
            return min(pair, implicit) if setting.kinematics == "finite" else implicit
        step = self.explicit if setting.method == "rk4" else self.implicit
        return step * self.duration / setting.dt if setting.dt else 0.0


def probe(case: StudyCase) -> Probe:
    """Return limit of stability and cost of a step, from short runs; of a static path nothing.

    Raises
    ------
    InputError
        If the case cannot be solved, as with an axial load above the critical one.
    """
    if case.static:
        return Probe(0.0, 1.0, True, math.inf, 0.0, 0.0)
    time = case.time
    interval, regular = common_interval(time)
    level = case.column.kinematics
    limit, explicit = interval, 0.0
    if not isinstance(case.column, Frame):  # Frames refuse explicit methods.
        first = _beginning(case, min(1e-6 * interval, time[1] - time[0]))
        keywords = first.keywords(Setting("rk4", level), case.column)
        result = time_history(first.column, first.time, **keywords)
        limit = float(result.summary["stable_step"])
        steps = min(300.0, (time[-1] - time[0]) / (0.5 * limit))
        short = _beginning(case, 0.5 * limit * max(steps, 1.0))
        explicit = _seconds(short, Setting("rk4", level, dt=0.5 * limit)) / max(steps, 1.0)
    rows = min(100, time.size - 1)
    short = _beginning(case, float(time[rows] - time[0]))
    try:
        implicit = _seconds(short, Setting("newmark", level, dt=interval)) / rows
    except RbsdemError:
        implicit = math.inf
    duration = float(time[-1] - time[0])
    return Probe(duration, interval, regular, limit, explicit, implicit)


def _beginning(case: StudyCase, duration: float) -> StudyCase:
    """Return the first part of the case, up to a duration [s]."""
    end = min(case.time[0] + duration, case.time[-1])
    kept = np.append(case.time[case.time < end], end)
    loads = {name: np.interp(kept, case.time, load) for name, load in case.loads.items()}
    return dataclasses.replace(case, time=kept, loads=loads)


def _seconds(case: StudyCase, setting: Setting) -> float:
    """Return the wall time of one run [s]."""
    begin = clock.perf_counter()
    case.solve(setting)
    return clock.perf_counter() - begin


def dividing_steps(look: Probe, longest: float) -> Iterator[float]:
    """Yield steps that divide the interval of the loading, each half of the one before.

    If no interval divides all of the loading, the steps begin at the longest.
    """
    if look.regular:
        parts = max(math.ceil(look.interval / longest * (1 - 1e-12)), 1)
        while True:
            yield look.interval / parts
            parts *= 2
    step = min(longest, look.interval)
    while True:
        yield step
        step /= 2


def ladders(case: StudyCase, look: Probe, methods: Sequence[str]) -> list[list[Setting]]:
    """Return the settings to try, a list for each family from coarse to fine.

    Levels of kinematics below that of the column have a few settings each.
    """
    level = case.column.kinematics
    lower = LEVELS[: LEVELS.index(level)]
    if case.static:
        parts = (0, 1, 2, 4, 8) if level == "finite" else (0, 1, 4)
        given_level = [Setting("static", level, parts=p) for p in parts]
        return [given_level, *([Setting("static", lower_level, parts=1)] for lower_level in lower)]
    families = _families(look, methods, level)
    for lower_level in lower:
        for family in _families(look, methods, lower_level):
            if family[0].events == "located" or family[0].method in ("hht", "generalised_alpha"):
                continue
            # Every second of the coarse rungs: the error is soon that of the kinematics.
            stable = [s for s in family if s.method != "rk4" or (s.dt or 0.0) <= look.limit]
            families.append(stable[1:6:2] if family[0].tolerance else stable[:5:2])
    return families


def _families(look: Probe, methods: Sequence[str], level: Kinematics) -> list[list[Setting]]:
    """Return the settings to try, those of one method from coarse to fine."""
    families = []
    if "rk4" in methods:
        for events in ("step", "located"):
            steps = list(islice(dividing_steps(look, look.limit), RK4_RUNGS))
            if events == "step" and look.regular and look.interval > steps[0]:
                # A step beyond the limit, to show what happens.
                parts = int(0.8 * round(look.interval / steps[0]))
                steps.insert(0, look.interval / max(parts, 1))
            families.append([Setting("rk4", level, dt=step, events=events) for step in steps])
    if "rk45" in methods:
        families.append([Setting("rk45", level, tolerance=10.0**-e) for e in TOLERANCES])
    if "auto" in methods:
        families.append([Setting("auto", level)])
    for method in IMPLICIT:
        if method in methods:
            halved = islice(dividing_steps(look, look.interval), IMPLICIT_RUNGS)
            families.append([Setting(method, level, dt=step) for step in halved])
    return families


#: Keywords of `Solver` that a setting may have; budget and limit of stability belong to the study.
OF_SETTING = tuple(name for name in Solver.__annotations__ if name in Setting.__annotations__)


def own_setting(column: Structure, settings: Solver) -> Setting:
    """Return the setting that a user gives.

    Raises
    ------
    InputError
        If a keyword does not belong to a setting.
    """
    for name in settings:
        if name not in OF_SETTING:
            known = ", ".join(OF_SETTING)
            raise InputError(
                f"compare_methods: setting: {name!r} is not known; it is one of {known}"
            )
    fields: dict[str, Any] = {"method": "rk4", **settings}
    if fields["method"] == "rk4":
        fields.setdefault("events", "step")
    return Setting(kinematics=column.kinematics, own=True, **fields)


def checked_methods(methods: Sequence[str] | None) -> tuple[str, ...]:
    """Return the methods to try; all of them if none is named.

    Raises
    ------
    InputError
        If a method is not known.
    """
    if methods is None:
        return IN_TIME
    wanted = (methods,) if isinstance(methods, str) else methods
    wanted = tuple(_arguments.several(wanted, "compare_methods: methods", "names"))
    wanted = tuple(_arguments.choice(word, "compare_methods: method", IN_TIME) for word in wanted)
    if not wanted:
        raise InputError("compare_methods: methods is empty; name one, or leave it out to try all")
    return wanted


@dataclass
class MethodRuns:
    """Settings that are tried on a case, within a budget.

    Attributes
    ----------
    case : StudyCase
        The case.
    look : Probe
        Its costs and limits.
    budget : Budget
        The wall time allowed.
    told : callable
        Told in words what is being done.
    runs : list of MethodRun
        The settings that were tried, families together, coarse settings first.
    """

    case: StudyCase
    look: Probe
    budget: Budget
    told: Callable[[str], None]
    runs: list[MethodRun] = field(default_factory=list)

    @property
    def solved(self) -> list[MethodRun]:
        """The runs that have an answer."""
        return [run for run in self.runs if run.solution]

    def predicted(self, last: MethodRun | None, setting: Setting) -> float:
        """Return an estimate of the wall time of a setting [s], if possible from a coarser run."""
        if last is None or not last.seconds > 0:
            return self.look.seconds(setting)
        coarse = last.setting
        if setting.dt and coarse.dt:
            return last.seconds * coarse.dt / setting.dt
        if setting.tolerance and coarse.tolerance:
            return last.seconds * math.pow(coarse.tolerance / setting.tolerance, 0.2)
        if setting.parts and coarse.parts:
            return last.seconds * setting.parts / coarse.parts
        return last.seconds

    def climb(self, families: list[list[Setting]], share: float, repeats: int) -> None:
        """Run all families rung by rung, coarse settings first, as far as the budget allows.

        The first setting of a family that is too expensive stands in the list with its reason; the
        finer ones do not.
        """
        runs: dict[Setting, MethodRun] = {}
        last: dict[int, MethodRun] = {}
        ended: set[int] = set()
        patience = share * self.budget.seconds / 40
        for rung in range(max(map(len, families))):
            for place, family in enumerate(families):
                if rung >= len(family) or place in ended:
                    continue
                setting = family[rung]
                self.told(str(setting))
                cost, left = self.predicted(last.get(place), setting), self.budget.left(share)
                if cost > left:
                    reason = too_expensive(cost, left)
                    runs[setting] = MethodRun(setting, status="skipped", reason=reason)
                    ended.add(place)
                    continue
                run = runs[setting] = self.case.run(setting, repeats, seconds=patience)
                if run.status != "refused":
                    last[place] = run
                elif setting.method != "rk4" or rung > 0:
                    # The first step of rk4 may be beyond the limit. Any other reason holds for
                    # finer steps too.
                    ended.add(place)
        self.runs = [runs[setting] for family in families for setting in family if setting in runs]


def too_expensive(cost: float, left: float) -> str:
    """Return the reason for not running a setting."""
    return f"would take about {cost:.2g} s; {max(left, 0):.2g} s of the budget are left for it"
