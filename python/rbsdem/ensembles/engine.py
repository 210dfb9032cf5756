"""Running an ensemble."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.analysis import Method
from rbsdem.ensembles.inputs import (
    check_jobs,
    named_columns,
    named_motions,
    raise_faults,
    scale_array,
)
from rbsdem.ensembles.measures import STATUSES, Measure, checked_measures, core_measures
from rbsdem.ensembles.record import Ensemble
from rbsdem.ensembles.tasks import Plan, TaskResult, cut, expected, joined
from rbsdem.ensembles.threads import in_threads
from rbsdem.errors import InputError

#: Expected seconds of a task at the most. The lanes take less.
_LONGEST = 2.0


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
    allow_unstable: bool = False,
    jobs: int | None = None,
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
        What is kept of each run: names of `rbsdem.ensembles.MEASURES` (by default all), and
        functions of a `Result` that return a number. A function makes the run's history once more,
        which takes as long as `time_history`.
    method : str, optional
        As for `time_history`; "auto" chooses for each column and motion.
    dt, tolerance, rho_infinity, collapse_drift : float, optional
        As for `time_history`.
    events : {"step", "located"}, optional
        As for `time_history`.
    allow_unstable : bool, optional
        As for `time_history`.
    jobs : int, optional
        Threads; by default one for each processor that this process may use.
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
    settings = {name: value for name, value in settings.items() if value is not None}
    faults: list[str] = []
    column_names, column_items = named_columns(columns, faults)
    given, motion_items = named_motions(motions, faults)
    full = scale_array(scales, len(column_names), given, faults)
    check_jobs(jobs, faults)
    names: tuple[str, ...] = ()
    functions: dict[str, Measure] = {}
    try:
        names, functions = checked_measures(measures)
    except InputError as error:
        faults.append(str(error))
    raise_faults(faults)
    kept = np.flatnonzero(~np.isnan(full).ravel())
    column, motion, _ = np.unravel_index(kept, full.shape)
    plan = Plan(
        column_items,
        motion_items,
        settings,
        functions,
        column.astype(np.int32),
        motion.astype(np.int32),
        full.ravel()[kept],
    )
    seconds, wrong = expected(plan)
    raise_faults([f"column {column_names[i]!r}: {text}" for i, text in wrong])
    threads = jobs or available_processors()
    total = float(seconds[plan.motion, plan.column].sum())
    pieces = cut(plan, seconds, min(_LONGEST, total / (8 * threads)))
    results, interrupted = in_threads(plan, pieces, threads, progress)
    result = joined(results, functions)
    return Ensemble(
        columns=dict(zip(column_names, column_items, strict=True)),
        motions={item.name: item for item in motion_items},
        settings=settings,
        column=plan.column,
        motion=plan.motion,
        scale=plan.scale,
        status=np.array(STATUSES)[result.fates],
        measures=_named(names, result, plan) | result.extra,
        errors=result.errors,
        seconds=time.perf_counter() - begin,
        interrupted=interrupted,
    )


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _named(names: tuple[str, ...], result: TaskResult, plan: Plan) -> dict[str, Array]:
    values = dict(zip(core_measures(), result.values, strict=True))
    heights = np.array([column.height for column in plan.columns])[plan.column]
    values["peak_drift"] = np.abs(values["peak_displacement"]) / heights
    values["residual_drift"] = np.abs(values["residual_displacement"]) / heights
    return {name: values[name] for name in names}
