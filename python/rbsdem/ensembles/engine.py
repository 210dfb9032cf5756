"""Running an ensemble."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from contextlib import ExitStack
from types import NoneType
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.analysis import Method
from rbsdem.ensembles.cluster import check_client, in_cluster
from rbsdem.ensembles.collected import Collected
from rbsdem.ensembles.inputs import (
    check_jobs,
    named_columns,
    named_motions,
    raise_faults,
    scale_array,
    states_of_columns,
)
from rbsdem.ensembles.measures import STATUSES, Measure, checked_measures, limit_states_among
from rbsdem.ensembles.progress import telling
from rbsdem.ensembles.record import Ensemble
from rbsdem.ensembles.store import Store
from rbsdem.ensembles.tasks import Plan, TaskResult, cut, expected
from rbsdem.ensembles.threads import Piece, in_threads
from rbsdem.errors import InputError

#: Expected seconds of a task at the most. The lanes take less.
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
    jobs: int | None = None,
    store: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    seeds: Any = None,
    client: Any = None,
    progress: bool = False,
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
        What is kept of each run: names of `rbsdem.ensembles.MEASURES` (by default all), limit
        states (`rbsdem.ensembles.LIMIT_STATES`: the time at which each is first reached, NaN if it
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
    jobs : int, optional
        Threads; by default one for each processor that this process may use.
    store : path, optional
        A folder that keeps what is computed, in files of some seconds of work each. A second start
        with the same inputs computes what is missing there, after whatever end of the first. Needs
        pyarrow (``pip install "rbsdem[ensembles]"``).
    shard : tuple of two int, optional
        (i, n): do part i of n, from 1 to n, for jobs that share the work and the store. Runs of the
        other parts are in the result if the store has them.
    seeds : optional
        What the inputs were drawn from, for the manifest of the store: anything that JSON takes.
    client : dask.distributed.Client, optional
        A cluster that does the work in place of threads.
    progress : bool, optional
        Show runs, rate and time left on stderr, if it is a terminal.

    Returns
    -------
    Ensemble
        Its `table` has a row for each run. After Ctrl-C the runs that were finished are kept.

    Raises
    ------
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
        "allow_unstable": _core.switch(allow_unstable, "allow_unstable") or None,
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
    _core.switch(progress, "progress")
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
    raise_faults([f"column {column_names[i]!r}: {text}" for i, text in wrong])
    threads = jobs or available_processors()
    # The shards of a store do not depend on who computes them.
    longest = _LONGEST if store is not None else _longest(plan, seconds, in_lanes, threads)
    pieces = cut(plan, seconds, longest)
    collected = Collected(plan.scale.size, functions, len(plan.names))
    with ExitStack() as stack:
        kept = None
        resumed = 0
        if store is not None:
            own_names = column_names, [item.name for item in motion_items]
            kept = Store(store, plan, own_names, pieces, seeds)
            stack.enter_context(kept.locked(part))
            pieces, resumed = _missing(kept, part, collected)

        def take(piece: Piece, result: TaskResult) -> None:
            collected.put(piece, result)
            if kept is not None:
                kept.write(piece, result)

        runs = sum(last - first for first, last in pieces)
        told = stack.enter_context(telling(progress, runs))
        if client is None:
            interrupted = in_threads(plan, pieces, threads, take, told)
        else:
            interrupted = in_cluster(plan, pieces, client, take, told)
    return Ensemble(
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
        interrupted=interrupted,
        resumed=resumed,
    )


def _longest(plan: Plan, seconds: Array, in_lanes: NDArray[np.int32], threads: int) -> float:
    """Return the expected seconds of a task, so that threads end together and lanes are full."""
    each = seconds[plan.motion, plan.column]
    together = int(in_lanes[plan.motion, plan.column].sum())
    most = 8 * threads
    if 2 * together > each.size:
        most = min(most, max(threads, together // _LANES))
    return min(_LONGEST, float(each.sum()) / most)


def _plain(value: Any) -> Any:
    """Return a value of Python in place of one of numpy, which a manifest does not take."""
    return value.item() if isinstance(value, np.generic) else value


def _checked_part(shard: Any, store: Any, faults: list[str]) -> tuple[int, int]:
    """Return which part of how many this process does; without parts the first of one."""
    if not isinstance(store, (str, os.PathLike, NoneType)):
        faults.append(f"store = {store!r:.40} must be the path of a folder")
    if shard is None:
        return 1, 1
    try:
        place, parts = (_core.whole(number, "shard") for number in shard)
        if not 1 <= place <= parts:
            raise ValueError
    except (InputError, TypeError, ValueError):
        faults.append(f"shard = {shard!r} must be two whole numbers (i, n) with 1 <= i <= n")
        return 1, 1
    if store is None:
        faults.append("shard: parts come together in a store; give store=")
    return place, parts


def _missing(store: Store, part: tuple[int, int], collected: Collected) -> tuple[list[Piece], int]:
    """Collect what the store has; return the pieces of a part that it has not, and its runs."""
    resumed = 0
    missing = []
    own = set(store.part(part))
    for piece in store.shards:
        result = store.read(piece)
        if result is not None:
            collected.put(piece, result)
            resumed += piece[1] - piece[0]
        elif piece in own:
            missing.append(piece)
    return missing, resumed


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
