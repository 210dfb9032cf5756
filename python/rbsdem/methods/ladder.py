"""The settings to try, from coarse to fine, within a budget of wall time."""

from __future__ import annotations

import dataclasses
import math
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem.errors import InputError, RbsdemError
from rbsdem.methods.study_case import MethodRun, Setting, SolvedRun, StudyCase
from rbsdem.model.column import Column, Kinematics
from rbsdem.run.accuracy import common_interval
from rbsdem.run.result import time_history
from rbsdem.run.solver import IMPLICIT, IN_TIME, METHODS, Solver

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
        """Return what is left of a share of the budget, counted from the start [s]."""
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
        own = [Setting("static", level, parts=p) for p in parts]
        return [own, *([Setting("static", lower_level, parts=1)] for lower_level in lower)]
    found = _families(look, methods, level)
    for lower_level in lower:
        for family in _families(look, methods, lower_level):
            if family[0].events == "located" or family[0].method in ("hht", "generalised_alpha"):
                continue
            # Every second of the coarse rungs: the error is soon that of the kinematics.
            stable = [s for s in family if s.method != "rk4" or (s.dt or 0.0) <= look.limit]
            found.append(stable[1:6:2] if family[0].tolerance else stable[:5:2])
    return found


def _families(look: Probe, methods: Sequence[str], level: Kinematics) -> list[list[Setting]]:
    found = []
    if "rk4" in methods:
        for events in ("step", "located"):
            steps = list(islice(dividing_steps(look, look.limit), RK4_RUNGS))
            if events == "step" and look.regular and look.interval > steps[0]:
                # A step beyond the limit, to show what happens.
                parts = int(0.8 * round(look.interval / steps[0]))
                steps.insert(0, look.interval / max(parts, 1))
            found.append([Setting("rk4", level, dt=step, events=events) for step in steps])
    if "rk45" in methods:
        found.append([Setting("rk45", level, tolerance=10.0**-e) for e in TOLERANCES])
    if "auto" in methods:
        found.append([Setting("auto", level)])
    for method in IMPLICIT:
        if method in methods:
            halved = islice(dividing_steps(look, look.interval), IMPLICIT_RUNGS)
            found.append([Setting(method, level, dt=step) for step in halved])
    return found


#: The settings of a method that a setting of a study has; the budget and the limit of stability
#: are its own affair.
OF_SETTING = tuple(name for name in Solver.__annotations__ if name in Setting.__annotations__)


def own_setting(column: Column, given: Solver) -> Setting:
    """Return the setting that a user gives.

    Raises
    ------
    InputError
        If a keyword does not belong to a setting.
    """
    for name in given:
        if name not in OF_SETTING:
            known = ", ".join(OF_SETTING)
            raise InputError(
                f"compare_methods: setting: {name!r} is not known; it is one of {known}"
            )
    fields: dict[str, Any] = {"method": "rk4", **given}
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
        What was tried, families together, coarse settings first.
    """

    case: StudyCase
    look: Probe
    budget: Budget
    told: Callable[[str], None]
    runs: list[MethodRun] = field(default_factory=list)

    @property
    def solved(self) -> list[SolvedRun]:
        """The runs that have an answer."""
        return [run for run in self.runs if isinstance(run, SolvedRun)]

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
