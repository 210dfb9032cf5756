"""Running an ensemble."""

from __future__ import annotations

import heapq
import os
import time
from collections.abc import Sequence
from contextlib import ExitStack
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.batch.cluster import Cluster, check_client
from rbsdem.batch.collected import Collected
from rbsdem.batch.inputs import (
    check_jobs,
    named_columns,
    named_motions,
    raise_faults,
    scale_array,
    states_of_columns,
)
from rbsdem.batch.measures import STATUSES, Measure, checked_measures, limit_states_among
from rbsdem.batch.progress import telling
from rbsdem.batch.record import Ensemble
from rbsdem.batch.store import Store
from rbsdem.batch.tasks import Piece, Plan, TaskResult, cut, expected
from rbsdem.batch.threads import Threads
from rbsdem.batch.work import Asked, work_through
from rbsdem.errors import InputError, Interrupted
from rbsdem.solve.analysis import Method

#: Seconds of a task at the most, as far as that is known: what a kill may cost.
_LONGEST = 2.0

#: Runs that advance side by side.
_LANES = 64


def ensemble(
    columns: Any,
    motions: Any,
    *,
    scales: ArrayLike = 1.0,
    measures: Sequence[str | Measure] | None = None,
    method: Method = "auto",
    dt: float | None = None,
    events: Literal["step", "located"] | None = None,
    tolerance: float | None = None,
    rho_infinity: float | None = None,
    collapse_drift: float | None = None,
    initial: Any = None,
    allow_unstable: bool = False,
    max_seconds: float | None = None,
    jobs: int | None = None,
    store: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    seeds: Any = None,
    client: Any = None,
    progress: bool = False,
    allow_partial: bool = False,
) -> Ensemble:
    """Run columns under ground motions at several scales, and measure each run.

    Every column is run with every motion at every scale. A run gives the numbers of
    `time_history`, to the last bit, for any number of threads. No run stops the others: each has a
    status.

    Parameters
    ----------
    columns : Column, sequence or mapping of Column
        The columns; without names they are numbered from 0.
    motions : motion, sequence or mapping of motions
        A motion has `time` [s] and `acceleration` [m/s2], and perhaps a `name`, as `GroundMotion`
        does, or is a pair of times (or one step) and accelerations.
    scales : array_like, optional
        Factors of the accelerations: shape (k,) for all, (motions, k) or (columns, motions, k).
        NaN stands for no run.
    measures : sequence of str and callable, optional
        What is kept of each run: names of `rbsdem.batch.measures.MEASURES` (by default all), limit
        states (`LIMIT_STATES`: the time at which each is first reached, NaN if it
        is not), and functions of a `Result` that return a number. A function makes the run's
        history once more, which takes as long as `time_history`; a limit state does not.
    method : str, optional
        As for `time_history`; "auto" chooses for each column and motion.
    dt, tolerance, rho_infinity, collapse_drift : float, optional
        As for `time_history`.
    events : {"step", "located"}, optional
        As for `time_history`.
    initial : Result, path, or sequence or mapping of them, optional
        The state that the runs begin in, which another analysis has ended in, as for
        `time_history`: one for all columns, or one for each, in their order or by their names
        (None: at rest). A column that begins in several states is given once for each, under names
        of its own.
    allow_unstable : bool, optional
        As for `time_history`.
    max_seconds : float, optional
        As for `time_history`: the longest that one run may be expected to take [s].
    jobs : int, optional
        Threads; by default one for each processor that this process may use.
    store : path, optional
        A folder that keeps the runs, written every few seconds, and the rest at Ctrl-C and SIGTERM.
        A second start computes the runs that are missing there, after whatever end of the first,
        and so does one with more columns, motions or scales. Needs pyarrow
        (``pip install "rbsdem[ensembles]"``).
    shard : tuple of two int, optional
        (i, n): do part i of n, from 1 to n, for jobs that share the work and the store. The parts
        are expected to take as long. Runs of the other parts are in the result if the store has
        them.
    seeds : optional
        What the inputs were drawn from, for the manifest of the store: anything that JSON takes.
    client : dask.distributed.Client, optional
        A cluster that does the work in place of threads.
    progress : bool, optional
        Show runs, rate and time left on stderr, if it is a terminal.
    allow_partial : bool, optional
        Return the runs that were finished if Ctrl-C ends the work, the others with the status "".

    Returns
    -------
    Ensemble
        Its `table` has a row for each run.

    Raises
    ------
    Interrupted
        After Ctrl-C, as soon as the runs under way are finished, unless `allow_partial`; its
        `ensemble` has those that are. A second Ctrl-C does not wait for them.
    InputError
        Before the first run, with a line for everything that is wrong.
    """
    begin = time.perf_counter()
    settings = {
        "method": method,
        "dt": dt,
        "events": events,
        "tolerance": tolerance,
        "rho_infinity": rho_infinity,
        "collapse_drift": collapse_drift,
        "allow_unstable": _arguments.switch(allow_unstable, "allow_unstable") or None,
        "max_seconds": max_seconds,
    }
    settings = {name: _plain(value) for name, value in settings.items() if value is not None}
    faults: list[str] = []
    column_names, column_items = named_columns(columns, faults)
    given, motion_items = named_motions(motions, faults)
    before = states_of_columns(initial, column_names, faults)
    full = scale_array(scales, len(column_names), given, faults)
    check_jobs(jobs, faults)
    names: tuple[str, ...] = ()
    functions: dict[str, Measure] = {}
    try:
        names, functions = checked_measures(measures)
    except InputError as error:
        faults.append(str(error))
    part = _checked_part(shard, store, faults)
    check_client(client, faults)
    for name, value in (("progress", progress), ("allow_partial", allow_partial)):
        try:
            _arguments.switch(value, name)
        except InputError as error:
            faults.append(str(error))
    raise_faults(faults)
    wanted = np.flatnonzero(~np.isnan(full).ravel())
    column, motion, _ = np.unravel_index(wanted, full.shape)
    plan = Plan(
        column_items,
        motion_items,
        settings,
        functions,
        column.astype(np.int32),
        motion.astype(np.int32),
        full.ravel()[wanted],
        limit_states_among(names),
        before,
    )
    seconds, in_lanes, wrong = expected(plan)
    each, lanes = seconds[plan.motion, plan.column], in_lanes[plan.motion, plan.column]
    raise_faults([f"column {column_names[i]!r}: {text}" for i, text in wrong])
    kept = None
    if store is not None:
        own_names = column_names, [item.name for item in motion_items]
        kept = Store(_arguments.path(store), plan, own_names, part, seeds)
    own = _of_part(each, lanes, part)
    workers = jobs or available_processors()
    collected, resumed, asked = _carried_out(
        plan, own, (each, lanes), kept, client or workers, progress
    )
    whole = Ensemble(
        columns=dict(zip(column_names, column_items, strict=True)),
        motions={item.name: item for item in motion_items},
        settings=settings,
        initial={
            name: state for name, state in zip(column_names, before, strict=True) if state.size
        },
        column=plan.column,
        motion=plan.motion,
        scale=plan.scale,
        status=np.array(STATUSES)[collected.fates],
        measures=_named(names, collected, plan) | collected.extra,
        errors=dict(sorted(collected.errors.items())),
        seconds=time.perf_counter() - begin,
        interrupted=bool(asked),
        resumed=resumed,
    )
    if asked and not allow_partial:
        raise Interrupted(_told(whole, store), whole)
    return whole


def _carried_out(
    plan: Plan,
    own: NDArray[np.int_],
    cost: tuple[Array, NDArray[np.int32]],
    kept: Store | None,
    workers: Any,
    progress: bool,
) -> tuple[Collected, int, Asked]:
    """Do the runs of this process that no store has.

    `workers` is a number of threads or the client of a cluster. Return what was collected, how many
    runs a store had, and whether the work was asked to end.
    """
    collected = Collected(plan.scale.size, plan.functions, len(plan.names))
    asked = Asked()
    resumed = 0
    with ExitStack() as stack:
        stack.enter_context(asked.listening(also_terminated=kept is not None))
        if kept is not None:
            stack.enter_context(kept.open())
            there, found = kept.read()
            if found is not None:
                collected.put(there, found)
            resumed = there.size
        missing = own[collected.fates[own] == 0]
        each, lanes = (values[missing] for values in cost)
        threads = workers if isinstance(workers, int) else available_processors()
        pace = _Pace(each, lanes, threads)

        def take(piece: Piece, result: TaskResult) -> None:
            pace.learn(float(each[slice(*piece)].sum()), result)
            runs = missing[slice(*piece)]
            collected.put(runs, result)
            if kept is not None:
                kept.add(runs, result)

        told = stack.enter_context(telling(progress, missing.size))
        left = plan.only(missing)
        do = Threads(left, workers) if isinstance(workers, int) else Cluster(left, workers)
        work_through(do, cut(each, pace.longest), take, told, asked)
    return collected, resumed, asked


def _longest(each: Array, lanes: NDArray[np.int32], workers: int) -> float:
    """Return the expected seconds of a task, so that workers end together and lanes are full."""
    together = int(lanes.sum())
    most = 8 * workers
    if 2 * together > each.size:
        most = min(most, max(workers, together // _LANES))
    return float(each.sum()) / most


class _Pace:
    """The expected seconds of the next task, of which a few real ones come."""

    def __init__(self, each: Array, lanes: NDArray[np.int32], workers: int) -> None:
        self._most = _longest(each, lanes, workers)
        # Until the first task is back nobody knows how busy the machine is; lanes take less.
        self._slower = 0.5 if 2 * lanes.sum() > lanes.size else 4.0

    def learn(self, expected: float, result: TaskResult) -> None:
        """Take what a task took in place of what was expected."""
        if result.fates.all() and expected > 0:
            self._slower = result.seconds / expected

    def longest(self) -> float:
        """Return the expected seconds of the next task."""
        return min(self._most, _LONGEST / max(self._slower, 1e-3))


def _of_part(each: Array, lanes: NDArray[np.int32], part: tuple[int, int]) -> NDArray[np.int_]:
    """Return the runs of part i of n, which follow from the input, whoever computes them.

    Blocks go in order of their length, each to the part that has least so far.
    """
    place, parts = part
    if parts == 1:
        return np.arange(each.size)
    longest = min(_LONGEST, _longest(each, lanes, parts))
    blocks = list(cut(each, lambda: longest))
    lengths = [float(each[slice(*block)].sum()) for block in blocks]
    total = [(0.0, number) for number in range(parts)]
    own = []
    for number in np.argsort([-length for length in lengths], kind="stable"):
        least, taker = heapq.heappop(total)
        heapq.heappush(total, (least + lengths[number], taker))
        if taker == place - 1:
            own.append(np.arange(*blocks[number]))
    return np.sort(np.concatenate(own)) if own else np.empty(0, dtype=int)


def _told(found: Ensemble, store: Any) -> str:
    """Return what an interruption has left."""
    done = int((found.status != "").sum())
    kept = (
        "the attribute `ensemble` of this error has them; with store= the next call goes on"
        if store is None
        else f"they are in {store}, and the same call goes on from there"
    )
    return (
        f"ensemble: broken off after {done} of {len(found)} runs; {kept} (allow_partial=True "
        "returns what is done)"
    )


def _plain(value: Any) -> Any:
    """Return a value of Python in place of one of numpy, which a manifest does not take."""
    return value.item() if isinstance(value, np.generic) else value


def _checked_part(shard: Any, store: Any, faults: list[str]) -> tuple[int, int]:
    """Return which part of how many this process does; without parts the first of one."""
    try:
        if store is not None:
            _arguments.path(store, "store")
    except InputError as error:
        faults.append(str(error))
    if shard is None:
        return 1, 1
    try:
        place, parts = (_arguments.whole(number, "shard") for number in shard)
        if not 1 <= place <= parts:
            raise ValueError
    except (InputError, TypeError, ValueError):
        faults.append(
            f"shard = {_arguments.shown(shard)} must be two whole numbers (i, n) with 1 <= i <= n"
        )
        return 1, 1
    if store is None:
        faults.append("shard: parts come together in a store; give store=")
    return place, parts


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _named(names: tuple[str, ...], result: Collected, plan: Plan) -> dict[str, Array]:
    values = dict(zip(plan.names, result.values, strict=True))
    heights = np.array([column.height for column in plan.columns])[plan.column]
    values["peak_drift"] = np.abs(values["peak_displacement"]) / heights
    values["residual_drift"] = np.abs(values["residual_displacement"]) / heights
    return {name: values[name] for name in names}
