"""The case of a study of methods: one column under one loading, solved by many settings."""

from __future__ import annotations

import dataclasses
import time as clock
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import AccuracyWarning, InputError, LongRunWarning, SolveError
from rbsdem.methods.answer import Run, Setting
from rbsdem.model.column import Column, checked_column, without_notes
from rbsdem.model.response import Response
from rbsdem.results.accuracy import Answer, at_times
from rbsdem.solve.analysis import cyclic, no_watch, time_history

#: Least number of times at which histories are compared; a loading with fewer is interpolated.
LEAST_ROWS = 200

#: Runs shorter than this are repeated until they take as long together [s].
SHORT = 0.05

#: Loads that only act on columns with second-order work, or whose joints open.
VERTICAL = ("vertical_acceleration", "axial_load")


@dataclass(frozen=True)
class Scene:
    """One column under one loading.

    Attributes
    ----------
    column : Column
        The column.
    time : ndarray, shape (m,), or None
        Times of the loading [s]; None for a static path.
    loads : dict of ndarray, shape (m,)
        The loads by name. A static path has one of them, "force" or "displacement".
    initial : mapping or None
        State at the start, as for `time_history`.
    collapse_drift : float or None
        As for `time_history`.
    """

    column: Column
    time: Array | None
    loads: dict[str, Array]
    initial: Mapping[str, ArrayLike] | None = None
    collapse_drift: float | None = None

    @property
    def static(self) -> bool:
        """Whether the path is static."""
        return self.time is None

    @property
    def response_name(self) -> str:
        """What the response is: "displacement", or "force" where the displacement is driven."""
        return "force" if "displacement" in self.loads else "displacement"

    def solve(self, setting: Setting, column: Column | None = None) -> Answer:
        """Return the answer of a setting, for another column if one is given."""
        column = self.column if column is None else column
        if column.kinematics != setting.kinematics:
            with without_notes():
                column = dataclasses.replace(column, kinematics=setting.kinematics)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", AccuracyWarning)
            warnings.simplefilter("ignore", LongRunWarning)
            if self.static:
                return self._solve_static(setting, column)
            result = time_history(no_watch, column, self.time, **self.keywords(setting, column))
        return self._answer(result)

    def keywords(self, setting: Setting, column: Column) -> dict[str, Any]:
        """Return the arguments of `time_history` for a setting."""
        loads: dict[str, Any] = dict(self.loads)
        if column.kinematics == "small" and column.axial_spring is None:
            # These loads would have nothing to act on and would be refused.
            loads = {name: load for name, load in loads.items() if name not in VERTICAL}
        return {
            **loads,
            **setting.solver,
            "initial": self._initial(column.n),
            "collapse_drift": self.collapse_drift,
        }

    def _initial(self, n: int) -> Mapping[str, ArrayLike] | None:
        """Return the state at the start; where bodies are cut in two, the halves share it."""
        if self.initial is None or n == self.column.n:
            return self.initial
        parts = n // self.column.n
        return {
            name: np.repeat(np.atleast_1d(values), parts) / parts
            for name, values in self.initial.items()
        }

    def _answer(self, result: Response) -> Answer:
        """Return the answer at the times of the loading."""
        taken = result.energy["spring"] + result.energy["damping"]
        moment = result.moment[:, 0]
        response = result.displacement
        time = np.array(result.time)
        summary = result.summary
        status = summary.get("status", "completed")
        chosen = f"{summary['method']}: {summary['reason']}" if summary.get("reason") else ""
        histories = [np.array(values) for values in (response, moment, taken)]
        wanted = self.time[self.time <= time[-1]]
        if time.size != wanted.size or time[-1] != wanted[-1]:
            # Rows were kept after each step because the step divides no interval, or the last row
            # is that of a collapse between two times.
            histories = [at_times(wanted, time, values) for values in histories]
        return Answer(wanted, *histories, status, chosen)

    def _solve_static(self, setting: Setting, column: Column) -> Answer:
        """Return the answer at the points of the path, however it is divided."""
        (name, path), parts = next(iter(self.loads.items())), setting.parts
        place = np.arange(path.size, dtype=np.float64)
        if parts == 0:
            kept = reversals(path)
            result = cyclic(column, **{name: path[kept]}, collapse_drift=self.collapse_drift)
            # A point in between lies on the straight line of its leg, at its driven value.
            place = along(path, kept)
        elif parts and parts > 1:
            fine = np.interp(np.arange(parts * (path.size - 1) + 1) / parts, place, path)
            # The points that were given, to the last digit.
            fine[::parts] = path
            result = cyclic(column, **{name: fine}, every=parts, collapse_drift=self.collapse_drift)
        else:
            result = cyclic(column, **{name: path}, collapse_drift=self.collapse_drift)
        response = result.force if name == "displacement" else result.displacement
        histories = [response, result.moment[:, 0], result.energy["spring"]]
        if parts == 0:
            kept_at = np.arange(response.size)
            histories = [np.interp(place, kept_at, values) for values in histories]
        points = np.arange(histories[0].size, dtype=np.float64)
        status = result.summary.get("status", "completed")
        return Answer(points, *map(np.array, histories), status)

    def run(
        self, setting: Setting, repeats: int = 1, column: Column | None = None, seconds: float = 1e9
    ) -> Run:
        """Return the answer of a setting and the median of its wall times, or why it has no answer.

        Parameters
        ----------
        setting : Setting
            What to try.
        repeats : int
            Number of runs; more where they are very short.
        column : Column, optional
            Another column in place of the scene's.
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
            return Run(setting, None, status="refused", reason=str(error))
        except SolveError as error:
            return Run(setting, None, times_or(times, begin), 1, "failed", str(error))
        seconds = float(np.median(times))
        return Run(setting, answer, seconds, len(times), answer.status, answer.reason)


def times_or(times: list[float], start: float) -> float:
    """Return the median of the times; without any, the time since the start."""
    return float(np.median(times)) if times else clock.perf_counter() - start


def make_scene(
    column: Column,
    time: ArrayLike | None,
    loads: Mapping[str, ArrayLike],
    initial: Mapping[str, ArrayLike] | None,
    collapse_drift: float | None,
) -> Scene:
    """Check a loading and return the scene.

    Raises
    ------
    InputError
        If the loads do not go together.
    """
    checked_column(column, "compare_methods: ")
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
        if next(iter(given.values())).size < 2:
            raise InputError("compare_methods: the path has fewer than 2 points")
        return Scene(column, None, given, None, collapse_drift)
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
    return Scene(column, times, given, initial, collapse_drift)


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
