"""The work of an ensemble in pieces: what a piece needs, how it is done, what comes of it.

Its store is a table with a row for each run, known by what the run follows from: a second start
computes what is missing, and so does one with more columns, motions or scales.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias

import numpy as np

from rbsdem import _core
from rbsdem._types import Array, NDArray
from rbsdem.errors import RbsdemError
from rbsdem.many import inputs
from rbsdem.model.column import Column, notes_off
from rbsdem.model.springs import Layered
from rbsdem.run.response import time_history
from rbsdem.section.criteria import criteria, thresholds
from rbsdem.section.frame import Structure

Integers = NDArray[np.int32]

#: First run of a task, and the one after its last.
Piece: TypeAlias = tuple[int, int]

#: Watches for a rotation that no joint reaches.
_NEVER = np.finfo(np.float64).max
_NO_WATCH: Array = np.array([(1, 1, 0.0, side, 0.0, _NEVER) for side in (1.0, -1.0)])

#: Runs of a task at the most: each takes about 1 kB while the task lasts.
_MOST_RUNS = 16384

_FAILED = inputs.STATUSES.index("failed")

#: How the error of a run begins whose measure raised one.
FAULT_OF_MEASURE = "measure "


class Share(tuple[int, int]):
    """Part i of n of a work whose runs the caller has chosen: it only names the part of a store."""


@dataclass(frozen=True, eq=False)
class Plan:
    """Runs with all that they need: some can be taken out of it and sent to another process.

    `column` and `motion` are places in `columns` and `motions`. `initial` are the states that the
    runs of each column begin in; an empty state is rest, and so is an empty list. The drifts of so
    many `storeys` are kept one by one.
    """

    columns: list[Structure]
    motions: list[inputs.Motion]
    settings: dict[str, Any]
    column: Integers
    motion: Integers
    scale: Array
    functions: dict[str, inputs.Measure] = field(default_factory=dict)
    states: tuple[str, ...] = ()
    storeys: int = 0
    initial: list[Array] = field(default_factory=list)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the measures, those of functions left out."""
        return _core.measures() + self.states + inputs.storey_measures(self.storeys)

    def __len__(self) -> int:
        """Return the number of runs."""
        return self.scale.size

    @property
    def before(self) -> list[Array]:
        """States that the runs of each column begin in."""
        return self.initial or [inputs.AT_REST] * len(self.columns)

    def only(self, runs: NDArray[np.int_]) -> Plan:
        """Return the plan of some of the runs."""
        return replace(
            self, column=self.column[runs], motion=self.motion[runs], scale=self.scale[runs]
        )

    def task(self, first: int, last: int) -> Plan:
        """Return the runs from first to before last, with their columns and motions alone."""
        columns, column = np.unique(self.column[first:last], return_inverse=True)
        motions, motion = np.unique(self.motion[first:last], return_inverse=True)
        return replace(
            self,
            columns=[self.columns[i] for i in columns],
            motions=[self.motions[j] for j in motions],
            column=column.astype(np.int32),
            motion=motion.astype(np.int32),
            scale=self.scale[first:last],
            initial=[self.initial[i] for i in columns] if self.initial else [],
        )


@dataclass(frozen=True, eq=False)
class Outcome:
    """Fates (runs,), measures (measures, runs), those of functions by name, errors by run.

    `seconds` is the time that the runs took.
    """

    fates: NDArray[np.int8]
    values: Array
    extra: dict[str, Array]
    errors: dict[int, str]
    seconds: float = 0.0

    @classmethod
    def none(cls, plan: Plan, status: str = "", error: str = "") -> Outcome:
        """Return the outcome of runs that gave nothing back."""
        runs = len(plan)
        return cls(
            np.full(runs, inputs.STATUSES.index(status), dtype=np.int8),
            np.full((len(plan.names), runs), np.nan),
            {name: np.full(runs, np.nan) for name in plan.functions},
            dict.fromkeys(range(runs), error) if error else {},
        )

    def put(self, runs: NDArray[np.int_], other: Outcome) -> None:
        """Take the outcome of some runs."""
        self.fates[runs] = other.fates
        self.values[:, runs] = np.where(other.fates != 0, other.values, np.nan)
        for name, values in other.extra.items():
            self.extra[name][runs] = values
        self.errors.update({int(runs[run]): text for run, text in other.errors.items()})


def chunks(seconds: Array, longest: Callable[[], float]) -> Iterator[Piece]:
    """Yield the tasks of runs that are expected to take some seconds each (runs,).

    `longest` is asked before each task for its expected seconds; one run is the least.
    """
    # By their middles, so that a last run does not stand alone for the round-off of a sum.
    middle = np.cumsum(seconds) - 0.5 * seconds
    first = 0
    while first < seconds.size:
        end = middle[first] - 0.5 * seconds[first] + longest()
        last = min(int(np.searchsorted(middle, end)), first + _MOST_RUNS)
        piece = first, max(first + 1, last)
        yield piece
        first = piece[1]


def expected(plan: Plan) -> tuple[Array, Integers, list[tuple[int, str]]]:
    """Return the seconds expected of a run, whether lanes take it, what is wrong with columns.

    The first two have shape (motions, columns).
    """
    return _core.plan_ensemble(_batch(plan, [_NO_WATCH] * len(plan.columns)))


def _batch(plan: Plan, thresholds: list[Array]) -> dict[str, Any]:
    """Return columns and motions as `_core.batch` joins them; `thresholds` are by column."""
    columns = [column._statement for column in plan.columns]
    motions = [(motion.time, motion.acceleration, motion.across) for motion in plan.motions]
    return _core.batch(columns, _core.settings(plan.settings), thresholds, plan.before, motions)


def compute(task: Plan, control: Integers | None = None, kernel: int = 0) -> Outcome:
    """Do the runs of a plan.

    `control` is shared with the thread that waits: it sets the first number to end the task before
    its next run, and reads in the second how many runs are done. `kernel` is the `level` of
    `_core.run_ensemble`.
    """
    begin = time.monotonic()
    control = np.zeros(2, dtype=np.int32) if control is None else control
    batch = _batch(task, [watched(column, task.states) for column in task.columns])
    runs = {"columns": task.column + 1, "motions": task.motion + 1, "scales": task.scale}
    number = len(_core.measures()) + len(task.states)
    asked = {"measures": number, "storeys": task.storeys, "level": kernel}
    fates, values, errors = _core.run_ensemble(batch, control, **runs, **asked)
    _name_joints(task, values)
    extra = {name: np.full(len(task), np.nan) for name in task.functions}
    if extra:
        _call_functions(task, control, fates, errors, extra)
    seconds = time.monotonic() - begin
    return Outcome(fates.astype(np.int8), values, extra, errors, seconds)


def _name_joints(task: Plan, values: Array) -> None:
    """Give the joints that were lost the numbers by which columns know them; NaN: none was.

    The solver counts them from the ground, from 1, a footing's included.
    """
    lost = values[_core.measures().index("lost_joint")]
    lost[lost == 0] = np.nan
    for run in np.flatnonzero(lost > 0):
        lost[run] = task.columns[task.column[run]].joint_numbers[int(lost[run]) - 1]


def _call_functions(
    task: Plan, control: Integers, fates: Integers, errors: dict[int, str], extra: dict[str, Array]
) -> None:
    """Fill the measures of functions, each run with its history, which is then dropped."""
    for run in np.flatnonzero(fates):
        if control[0]:
            fates[run:] = 0
            return
        if fates[run] == _FAILED:
            continue
        try:
            with notes_off():
                at, scale = task.column[run], float(task.scale[run])
                run_of = task.columns[at], task.motions[task.motion[run]], scale
                result = one_run(*run_of, task.settings, task.before[at])
        except RbsdemError as error:
            fates[run], errors[int(run)] = _FAILED, str(error)
            continue
        for name, function in task.functions.items():
            try:
                extra[name][run] = _number(function(result))
            except Exception as error:  # A fault in a measure is that of a run and ends no batch.
                fates[run] = _FAILED
                errors[int(run)] = f"{FAULT_OF_MEASURE}{name}: {type(error).__name__}: {error}"


def _number(value: Any) -> float:
    """Return what a function of the user returned as a float; a text is refused."""
    if isinstance(value, (str, bytes)):
        raise TypeError(f"{value!r:.40} is a text; return a number")
    return float(value)


def one_run(
    column: Any, motion: inputs.Motion, scale: float, settings: dict[str, Any], initial: Array
) -> Any:
    """Return the `Result` of one run, with its history; an empty state is at rest."""
    springs = column.joints("flexure") if isinstance(column, Column) else ()
    settings = settings | {"openings": any(isinstance(each, Layered) for each in springs)}
    settings["initial"] = initial if initial.size else None
    ground: dict[str, Any] = {"ground_acceleration": scale * motion.acceleration}
    if motion.across.size:
        ground["ground_acceleration_y"] = scale * motion.across
    return time_history(column, motion.time, **ground, **settings)


def watched(column: Structure, states: tuple[str, ...]) -> Array:
    """Return the criteria of runs of a column, as `_core.batch` takes them."""
    numbers = {name: number for number, name in enumerate(("first_yield", *states), 1)}
    limits = criteria(column, numbers)
    if not limits:
        return _NO_WATCH
    return thresholds(column, limits, [numbers[each.name] for each in limits])
