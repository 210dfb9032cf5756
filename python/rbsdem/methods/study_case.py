"""The case of a study of methods: one column under one loading, and settings to solve it by."""

from __future__ import annotations

import dataclasses
import math
import time as clock
from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any, cast

import numpy as np

from rbsdem import _arguments
from rbsdem._package import unwarned
from rbsdem._types import Array, ArrayLike, NDArray
from rbsdem.errors import AccuracyWarning, InputError, LongRunWarning, SolveError
from rbsdem.model.column import Column, Kinematics, checked_column, notes_off
from rbsdem.run.accuracy import Answer, answer_of
from rbsdem.run.result import cyclic, time_history
from rbsdem.run.solver import Solver

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
        """What settings have in common that differ only in step, tolerance or parts."""
        return self.method, self.events, self.kinematics, self.rho_infinity, self.own

    @property
    def name(self) -> str:
        """The method and where it changes lines."""
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


@dataclass(frozen=True, eq=False)
class SolvedRun(MethodRun):
    """A setting that has an answer.

    Attributes
    ----------
    answer : Answer
        Its answer.
    """

    answer: Answer = field(kw_only=True)


@dataclass(frozen=True)
class StudyCase:
    """One column under one loading.

    Attributes
    ----------
    column : Column
        The column.
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

    column: Column
    time: Array
    loads: dict[str, Array]
    initial: Mapping[str, ArrayLike] | None = None
    collapse_drift: float | None = None
    static: bool = False

    @property
    def response_name(self) -> str:
        """What the response is: "displacement", or "force" where the displacement is driven."""
        return "force" if "displacement" in self.loads else "displacement"

    def solve(self, setting: Setting, column: Column | None = None) -> Answer:
        """Return the answer of a setting, for another column if one is given."""
        column = self.column if column is None else column
        if column.kinematics != setting.kinematics:
            with notes_off():
                column = dataclasses.replace(column, kinematics=setting.kinematics)
        with unwarned(AccuracyWarning, LongRunWarning):
            if self.static:
                return self._solve_static(setting, column)
            result = time_history(column, self.time, **self.keywords(setting, column))
        return answer_of(result, self.time)

    def keywords(self, setting: Setting, column: Column) -> dict[str, Any]:
        """Return the arguments of `time_history` for a setting."""
        loads: dict[str, Any] = dict(self.loads)
        if column.kinematics == "small" and column.axial_spring is None:
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

    def _solve_static(self, setting: Setting, column: Column) -> Answer:
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
        histories = [response, result.moment[:, 0], result.energy["spring"]]
        if parts == 0:
            # A point in between lies on the straight line of its leg, at its driven value.
            place, rows = along(path, kept), np.arange(response.size)
            histories = [np.interp(place, rows, values) for values in histories]
        points = np.arange(histories[0].size, dtype=np.float64)
        status = result.summary.get("status", "completed")
        response, moment, taken = map(np.array, histories)
        return Answer(points, response, moment, taken, status)

    def run(
        self, setting: Setting, repeats: int = 1, column: Column | None = None, seconds: float = 1e9
    ) -> MethodRun:
        """Return the answer of a setting and the median of its wall times, or why it has no answer.

        Parameters
        ----------
        setting : Setting
            What to try.
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
        return SolvedRun(setting, median, len(times), answer.status, reason, answer=answer)


def study_case(
    column: Column,
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
    checked_column(column, "compare_methods: ")
    if not isinstance(initial, Mapping | None):
        raise InputError(
            f"compare_methods: initial = {_arguments.shown(initial)} must be a mapping of slips, "
            "rotations and velocities; the state in which a result ended is for time_history"
        )
    given = {name: _arguments.finite_vector(values, name) for name, values in loads.items()}
    if time is None:
        if set(given) not in ({"displacement"}, {"force"}):
            names = ", ".join(given) or "none"
            raise InputError(
                "compare_methods: without time the path is static and needs exactly one of "
                f"displacement and force; given: {names}"
            )
        if initial is not None:
            raise InputError(
                "compare_methods: initial has no meaning for a static path; give time as well"
            )
        (path,) = given.values()
        if path.size < 2:
            raise InputError("compare_methods: the path has fewer than 2 points")
        points = np.arange(float(path.size))
        return StudyCase(column, points, given, None, collapse_drift, static=True)
    if "displacement" in given:
        raise InputError(
            "compare_methods: displacement drives a static path only; remove it, or time"
        )
    if not given and not initial:
        raise InputError(
            "compare_methods: nothing moves the column; give a load or an initial state"
        )
    times = _arguments.finite_vector(time, "time")
    for name, values in given.items():
        if values.size != times.size:
            raise InputError(f"{name} has {values.size} values for {times.size} times")
    if times.size < 2 or not np.all(np.diff(times) > 0):
        raise InputError("time: give two or more, each after the one before")
    parts = -(-LEAST_ROWS // (times.size - 1))
    if parts > 1:
        place = np.arange(parts * (times.size - 1) + 1) / parts
        old = np.arange(times.size)
        given = {name: np.interp(place, old, values) for name, values in given.items()}
        times = np.interp(place, old, times)
    return StudyCase(column, times, given, initial, collapse_drift)


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
