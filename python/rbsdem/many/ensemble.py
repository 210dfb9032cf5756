"""Running an ensemble.

Tasks go to an executor of `concurrent.futures` and back, until all are done or the user ends the
work.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    CancelledError,
    Executor,
    Future,
    ThreadPoolExecutor,
    wait,
)
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular, data_frame
from rbsdem._progress import Bar, progress_bar
from rbsdem._types import Array, ArrayLike, DataFrame, NDArray, Unpack
from rbsdem.errors import InputError, Interrupted, SolveError
from rbsdem.many import inputs
from rbsdem.many.plan import (
    Outcome,
    Piece,
    Plan,
    Share,
    chunks,
    compute,
    expected,
    one_run,
)
from rbsdem.many.store import Store
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.rows import bibtex, parts_of
from rbsdem.run.solver import COLLAPSE_DRIFT, Solver, checked_solver
from rbsdem.section.frame import Frame, Structure

#: How often the display is renewed, and a signal seen [s].
BEAT = 0.2

Task = TypeVar("Task")


class EndRequest:
    """Whether the work is to end before it is done, by Ctrl-C or SIGTERM.

    The signals are noted and looked at between two tasks: an exception from anywhere would lose a
    task on its way. A second Ctrl-C is an exception at once.
    """

    def __init__(self) -> None:
        self.signal: int | None = None

    def __bool__(self) -> bool:
        """Return whether a signal has come."""
        return self.signal is not None

    @contextmanager
    def listening(self, also_terminated: bool) -> Iterator[None]:
        """Note signals while the block lasts; pass SIGTERM on to its own handler after it."""
        if threading.current_thread() is not threading.main_thread():
            yield
            return
        before = {}
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            before[signal.SIGINT] = signal.signal(signal.SIGINT, self._note)
        if also_terminated and signal.getsignal(signal.SIGTERM) not in (signal.SIG_IGN, None):
            before[signal.SIGTERM] = signal.signal(signal.SIGTERM, self._note)
        try:
            yield
        finally:
            for number, handler in before.items():
                signal.signal(number, handler)
            if self.signal == signal.SIGTERM:
                os.kill(os.getpid(), signal.SIGTERM)

    def _note(self, number: int, frame: object) -> None:
        """Note a signal; a second Ctrl-C is an exception."""
        del frame
        if self.signal is not None and number == signal.SIGINT:
            raise KeyboardInterrupt
        self.signal = number


def work_through(
    submit: Callable[[Task], Future[Any]],
    tasks: Iterable[Task],
    take: Callable[[Task, Future[Any]], None],
    *,
    ahead: int,
    end: EndRequest,
    beat: Callable[[], None],
    stop: Callable[[], None],
) -> None:
    """Do all tasks.

    Where the end is requested, or `take` raises an error, the tasks under way are finished and the
    others are not started; after the request `take` gets what was finished.

    Parameters
    ----------
    submit : callable
        Gives a task to an executor.
    tasks : iterable
        The next one is asked for when it is submitted.
    take : callable
        Gets each task with its future, which is done, as they come.
    ahead : int
        Tasks that are submitted and not done, at the most.
    end : EndRequest
        Whether the work is to end.
    beat : callable
        Called several times a second.
    stop : callable
        Called where the work ends before it is done: it lets tasks under way end soon.
    """
    waiting: dict[Future[Any], Task] = {}

    def take_ended() -> None:
        """Take the tasks that have ended, after waiting for one for a beat at most."""
        for future in wait(waiting, BEAT, FIRST_COMPLETED).done:
            take(waiting.pop(future), future)
        beat()

    try:
        for task in tasks:
            waiting[submit(task)] = task
            while len(waiting) >= ahead and not end:
                take_ended()
            if end:
                break
        while waiting and not end:
            take_ended()
        if end:
            _cancel(waiting, stop)
        while waiting:
            take_ended()
    except BaseException:
        _cancel(waiting, stop)
        raise


def _cancel(waiting: dict[Future[Any], Task], stop: Callable[[], None]) -> None:
    """End the tasks under way, and forget those that were not yet started."""
    stop()
    for future in [future for future in waiting if future.cancel()]:
        del waiting[future]


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def check_client(client: Any) -> None:
    """Raise `InputError` for what is not a client of a cluster with workers."""
    if not callable(getattr(client, "submit", None)) or not hasattr(client, "ncores"):
        raise InputError(
            f"client = {client!r:.60} must be a dask.distributed.Client (pip install distributed)"
        )
    if not client.ncores():
        raise InputError("client: its cluster has no workers; start some first")


#: Seconds of a task at the most, as far as that is known: what a kill may cost.
_LONGEST = 2.0

#: Runs that advance side by side.
_LANES = 32
#: Golden ratio: places of its multiples lie evenly, wherever they are cut off.
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True, repr=False, eq=False)
class Ensemble(Tabular):
    """The runs of an ensemble, columns x motions x scales, the scales running fastest.

    Attributes
    ----------
    columns : dict
        The columns by their names.
    motions : dict
        The motions by their names, with `time` [s], `acceleration` [m/s2], and `across` [m/s2]
        along y (empty without).
    settings : dict
        The settings of the analysis that were given, as keywords of `time_history`.
    initial : dict of ndarray
        The states that runs of a column began in, by its name; the others began at rest.
    column, motion : ndarray of int, shape (runs,)
        Places of column and motion of each run in `columns` and `motions`.
    scale : ndarray, shape (runs,)
        Factor of the accelerations.
    status : ndarray of str, shape (runs,)
        "completed", "collapsed", "axial_failure" or "failed"; "" for a run that was not started
        because the ensemble was broken off.
    measures : dict of ndarray, shape (runs,)
        The measures (`MEASURES`, and those of functions); NaN for failed runs.
    errors : dict
        Texts of the errors of failed runs, by the number of the run.
    seconds : float
        Wall time.
    interrupted : bool
        Whether Ctrl-C broke the ensemble off.
    resumed : int
        Number of runs that the store had.
    """

    columns: Mapping[str | int, Structure]
    motions: Mapping[str | int, inputs.Motion]
    settings: dict[str, Any]
    initial: dict[str | int, Array]
    column: NDArray[np.int32]
    motion: NDArray[np.int32]
    scale: Array
    status: NDArray[np.str_]
    measures: dict[str, Array]
    errors: dict[int, str]
    seconds: float
    interrupted: bool = False
    resumed: int = 0

    def __len__(self) -> int:
        """Return the number of runs."""
        return self.scale.size

    def __repr__(self) -> str:
        counts = ", ".join(f"{number} {status}" for status, number in self.counts.items())
        noted = int((self.warnings != "").sum())
        more = f", {noted} with warnings" if noted else ""
        return (
            f"Ensemble({len(self.columns)} columns x {len(self.motions)} motions, {len(self)} "
            f"runs: {counts}{more}; {self.seconds:.3g} s)"
        )

    @property
    def counts(self) -> dict[str, int]:
        """Number of runs of each status that occurs."""
        numbers = {status: int((self.status == status).sum()) for status in inputs.STATUSES}
        return {status or "not started": number for status, number in numbers.items() if number}

    def citation(self) -> str:
        """Return the works behind the runs as BibTeX, as those of results.

        With the method "auto" those of the methods that it chose for the first run of each column.
        """
        parts: set[str] = set()
        for i, column in enumerate(self.columns.values()):
            method, runs = self.settings["method"], np.flatnonzero(self.column == i)
            if method == "auto" and runs.size:
                method = self.history(int(runs[0])).summary["method"]
            parts |= parts_of(column, method)
        return bibtex(parts)

    @property
    def warnings(self) -> NDArray[np.str_]:
        """Of each run, what `time_history` would warn of after it; "" where that is nothing.

        Only what its measures show: rotations ("peak_rotation") of columns without kinematics
        "finite" that did not collapse, and the balance of energy ("relative_energy_residual") of
        frames.
        """
        each = list(self.columns.values())
        frames = np.array([isinstance(structure, Frame) for structure in each])[self.column]
        small = np.array([structure.kinematics != "finite" for structure in each])[self.column]
        unknown = np.full(len(self), np.nan)
        rotation, energy, _ = _core.note_limits()
        turned = self.measures.get("peak_rotation", unknown) > rotation
        missed = self.measures.get("relative_energy_residual", unknown) > energy
        texts = np.full(len(self), "", dtype="<U80")
        texts[turned & small & ~frames & (self.status != "collapsed")] = (
            f"rotations go beyond {rotation:g} rad; use kinematics = 'finite'"
        )
        texts[missed & frames] = (
            f"the balance of energy misses more than {energy:.0%}; take a shorter dt"
        )
        return texts

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each run: what it is, its measures, warnings and error."""
        import pandas  # noqa: PLC0415

        values = {
            "column": pandas.Categorical.from_codes(self.column, list(self.columns)),
            "motion": pandas.Categorical.from_codes(self.motion, list(self.motions)),
            "scale": self.scale,
            "status": pandas.Categorical(self.status, inputs.STATUSES),
        }
        for name, numbers in self.measures.items():
            whole = name in inputs.COUNTS and not self.errors and (self.status != "").all()
            values[name] = numbers.astype(int) if whole else numbers
        errors = pandas.Series("", index=range(len(self)), dtype=object)
        for run, text in self.errors.items():
            errors[run] = text
        return data_frame(values | {"warnings": self.warnings.astype(object), "error": errors})

    def history(self, run: int) -> ColumnResult:
        """Solve one run again, with its history; the bits are those of the run.

        Parameters
        ----------
        run : int
            Its number, that of its row in `to_pandas`, from 0.

        Returns
        -------
        Result
            As `time_history` returns it.

        Raises
        ------
        InputError
            If there is no such run.
        SolveError
            If the run failed; its attribute `result` holds the rows up to there.
        """
        _arguments.integer(run, "run", least=0, most=len(self) - 1)
        name, column = list(self.columns.items())[self.column[run]]
        motion = list(self.motions.values())[self.motion[run]]
        state = self.initial.get(name, inputs.AT_REST)
        result: ColumnResult = one_run(column, motion, float(self.scale[run]), self.settings, state)
        return result


def ensemble(
    columns: Any,
    motions: Any,
    *,
    scales: ArrayLike = 1.0,
    measures: Sequence[str | inputs.Measure] | None = None,
    collapse_drift: float | None = COLLAPSE_DRIFT,
    initial: Any = None,
    jobs: int | None = None,
    store: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    client: Any = None,
    progress: bool = False,
    allow_partial: bool = False,
    **solver: Unpack[Solver],
) -> Ensemble:
    """Run columns under ground motions at several scales, and measure each run.

    Every column is run with every motion at every scale. A run gives the numbers of
    `time_history`, to the last bit, for any number of threads. No run stops the others: each has a
    status.

    Parameters
    ----------
    columns : Column or Frame, sequence or mapping of them
        The columns; without names they are numbered from 0.
    motions : motion, sequence or mapping of motions
        A motion has `time` [s] and `acceleration` [m/s2], and perhaps a `name`, as `GroundMotion`
        does, or is a pair of times (or one step) and accelerations. Two `GroundMotion` that shake
        a building at once along x and y are a tuple, ``[(east_west, north_south), ...]``: one
        factor scales both, and the shorter one is followed by rest, as in `time_history`.
    scales : array_like, optional
        Factors of the accelerations: shape (k,) for all, (motions, k) or (columns, motions, k).
        NaN stands for no run.
    measures : sequence of str and callable, optional
        Measures that are kept of each run: names of `rbsdem.many.inputs.MEASURES` and, of frames,
        `STOREY_MEASURES` (by default all), those of a single storey ("peak_storey_drift_2"), limit
        states (`LIMIT_STATES`: the time at which each is first reached, NaN if it is not), and
        functions of a `Result` that return a number. A function makes the run's history once more,
        which takes as long as `time_history`; the others do not.
    collapse_drift : float, optional
        Drift at which a run ends as collapsed, as for `time_history`; by default 0.1. None: no run
        ends before its record.
    initial : Result, path-like, or sequence or mapping of them, optional
        The state that the runs begin in, which another analysis has ended in, as for
        `time_history`: one for all columns, or one for each, in their order or by their names
        (None: at rest). A column that begins in several states is given once for each, under names
        of its own.
    jobs : int, optional
        Threads; by default one for each processor that this process may use.
    store : path-like, optional
        A folder that keeps the runs, written every few seconds, and the rest at Ctrl-C and SIGTERM.
        A second start computes the runs that are missing there, after whatever end of the first,
        and so does one with more columns, motions or scales.
    shard : tuple of two int, optional
        (i, n): do part i of n, from 1 to n, for jobs that share the work and the store. The parts
        are expected to take as long. Runs of the other parts are in the result if the store has
        them.
    client : dask.distributed.Client, optional
        A cluster that does the work in place of threads.
    progress : bool, optional
        Show runs, rate and time left on stderr, if it is a terminal.
    allow_partial : bool, optional
        Return the runs that were finished if Ctrl-C ends the work, the others with the status "".
    **solver
        Settings of the method, see `rbsdem.Solver`. Without any "rk4", if all runs go side by side
        with it, in lanes: its errors are those of "auto" (docs/ensembles.md). Else "auto" chooses
        for each column and motion. A run that takes longer than `max_seconds` has failed.

    Returns
    -------
    Ensemble
        Its `to_pandas` has a row for each run.

    Raises
    ------
    Interrupted
        After Ctrl-C, as soon as the runs under way are finished, unless `allow_partial`; its
        `ensemble` has those that are. A second Ctrl-C does not wait for them.
    InputError
        Before the first run, with a line for everything that is wrong.
    """
    begin = time.perf_counter()
    settings: dict[str, Any] = checked_solver(solver, "ensemble")
    if collapse_drift is not None:
        settings["collapse_drift"] = collapse_drift
    settings = {name: _plain(value) for name, value in settings.items()}
    faults: list[str] = []
    column_names, column_items = inputs.named_columns(columns, faults)
    number, motion_items = inputs.named_motions(motions, column_items, faults)
    if collapse_drift is not None:
        inputs.check_collapse(column_names, column_items, motion_items, faults)
    before = inputs.states_of_columns(initial, column_names, faults)
    full = inputs.scale_array(scales, len(column_names), number, faults)
    names: tuple[str, ...] = ()
    functions: dict[str, inputs.Measure] = {}
    with _arguments.collected(faults):
        names, functions = inputs.checked_measures(measures, column_items)
    part = checked_part(shard, store, faults)
    with _arguments.collected(faults):
        if jobs is not None:
            _arguments.integer(jobs, "jobs", least=1)
    with _arguments.collected(faults):
        if client is not None:
            check_client(client)
    switches = {
        "progress": isinstance(progress, Bar) or progress,
        "allow_partial": allow_partial,
    }
    for name, value in switches.items():
        with _arguments.collected(faults):
            _arguments.boolean(value, name)
    _arguments.raise_faults(faults)
    wanted = np.flatnonzero(~np.isnan(full).ravel())
    column, motion, _ = np.unravel_index(wanted, full.shape)
    runs = column.astype(np.int32), motion.astype(np.int32), full.ravel()[wanted]
    asked = functions, inputs.limit_states_among(names), inputs.storeys_among(names)
    # Without settings: RK4 if all runs go side by side in lanes, else "auto".
    methods = [{}] if "method" in settings else [{"method": "auto"}]
    methods = methods if solver else [{"method": "rk4"}, *methods]
    for method in methods:
        plan = Plan(column_items, motion_items, method | settings, *runs, *asked, before)
        seconds, in_lanes, wrong = expected(plan)
        each, lanes = seconds[plan.motion, plan.column], in_lanes[plan.motion, plan.column]
        if lanes.all() and not wrong:
            break
    _arguments.raise_faults([f"column {column_names[i]!r}: {text}" for i, text in wrong])
    kept = None
    if store is not None:
        own_names = column_names, [item.name for item in motion_items]
        kept = Store(_arguments.path(store), plan, own_names, part)
    runs_of_part = _of_part(each.size, part)
    outcome, resumed, end = _carried_out(
        plan, runs_of_part, (each, lanes), kept, client, jobs, progress
    )
    states = zip(column_names, before, strict=True)
    whole = Ensemble(
        dict(zip(column_names, column_items, strict=True)),
        {item.name: item for item in motion_items},
        plan.settings,
        {name: state for name, state in states if state.size},
        plan.column,
        plan.motion,
        plan.scale,
        status=np.array(inputs.STATUSES)[outcome.fates],
        measures=_named(names, outcome, plan) | outcome.extra,
        errors=dict(sorted(outcome.errors.items())),
        seconds=time.perf_counter() - begin,
        interrupted=bool(end),
        resumed=resumed,
    )
    if end and not allow_partial:
        raise Interrupted(_told(whole, store), whole)
    return whole


def _carried_out(
    plan: Plan,
    runs_of_part: NDArray[np.int_],
    cost: tuple[Array, NDArray[np.int32]],
    kept: Store | None,
    client: Any,
    jobs: int | None,
    progress: bool,
) -> tuple[Outcome, int, EndRequest]:
    """Do the runs of this process that no store has.

    Return the outcome, how many runs a store had, and whether the work was asked to end.
    """
    outcome, resumed, end = Outcome.none(plan), 0, EndRequest()
    threads = jobs or available_processors()
    with ExitStack() as stack:
        stack.enter_context(end.listening(also_terminated=kept is not None))
        if kept is not None:
            stack.enter_context(kept.open())
            resumed = kept.read(outcome)
        missing = runs_of_part[outcome.fates[runs_of_part] == 0]
        if not cost[1][missing].any():
            # Runs of large scales take longer: in every part of the work there are runs of all.
            missing = missing[np.argsort(_GOLDEN * np.arange(missing.size) % 1.0)]
        each, lanes = (values[missing] for values in cost)
        pace = _TaskSizer(each, lanes, threads)
        show = stack.enter_context(progress_bar(progress, missing.size))
        workers = _Workers(plan.only(missing), client, threads)
        stack.enter_context(workers.executor)

        def take(piece: Piece, future: Future[Outcome]) -> None:
            """Put the outcome of a task in its place, and into the store."""
            result = workers.result(piece, future)
            pace.learn(float(each[slice(*piece)].sum()), result)
            runs = missing[slice(*piece)]
            outcome.put(runs, result)
            if kept is not None:
                kept.add(runs, result)

        def beat() -> None:
            """Renew the display, and write what is due to the store."""
            show(workers.done(), "")
            if kept is not None:
                kept.write_if_due()

        pieces, how = chunks(each, pace.longest), {"beat": beat, "stop": workers.stop}
        work_through(workers.submit, pieces, take, ahead=workers.ahead, end=end, **how)
    return outcome, resumed, end


class _Workers:
    """Threads, whose solver releases the interpreter's lock, or the workers of a Dask cluster."""

    executor: Executor

    def __init__(self, plan: Plan, client: Any, threads: int) -> None:
        self._plan = plan
        self._done = 0
        # Shared with the threads: the first number ends a task, the second counts its runs.
        self._controls: list[NDArray[np.int32]] = []
        self._remote = client is not None
        if client is None:
            self.executor = ThreadPoolExecutor(threads)
            #: Tasks under way or next in line, so that no thread waits for one.
            self.ahead = 2 * threads
        else:
            self.executor = client.get_executor(pure=False)
            self.ahead = 3 * int(sum(client.ncores().values()))

    def submit(self, piece: Piece) -> Future[Outcome]:
        """Give a task to them."""
        if self._remote:
            return self.executor.submit(compute, self._plan.task(*piece))
        control = np.zeros(2, dtype=np.int32)
        self._controls.append(control)
        return self.executor.submit(lambda: compute(self._plan.task(*piece), control))

    def result(self, piece: Piece, future: Future[Outcome]) -> Outcome:
        """Return the outcome of a task."""
        self._done += piece[1] - piece[0]
        try:
            return future.result()
        except CancelledError:
            raise SolveError("client: the cluster has lost its tasks; start it again") from None
        except Exception as error:
            if type(error).__name__ != "KilledWorker":
                raise
            text = "several worker processes died at the task of this run; run it alone to see why"
            return Outcome.none(self._plan.task(*piece), "failed", text)

    def done(self) -> int:
        """Return the number of runs that are done."""
        return self._done if self._remote else sum(int(control[1]) for control in self._controls)

    def stop(self) -> None:
        """Finish the runs under way, and start no others: every task ends with what it has."""
        for control in self._controls:
            control[0] = 1


def _longest(each: Array, lanes: NDArray[np.int32], workers: int) -> float:
    """Return the expected seconds of a task, so that workers end together and lanes are full.

    `each` are expected seconds of the runs, `lanes` 1 for those that advance side by side.
    """
    together = int(lanes.sum())
    most = 8 * workers
    if 2 * together > each.size:
        most = min(most, max(workers, together // _LANES))
    return float(each.sum()) / most


class _TaskSizer:
    """The expected seconds of the next task, found from the seconds of those done."""

    def __init__(self, each: Array, lanes: NDArray[np.int32], workers: int) -> None:
        self._most = _longest(each, lanes, workers)
        # Until the first task is back nobody knows how busy the machine is; lanes take less.
        self._slower = 0.5 if 2 * lanes.sum() > lanes.size else 4.0

    def learn(self, expected: float, result: Outcome) -> None:
        """Take the time of a task in place of the expected one."""
        if result.fates.all() and expected > 0:
            self._slower = result.seconds / expected

    def longest(self) -> float:
        """Return the expected seconds of the next task."""
        return min(self._most, _LONGEST / max(self._slower, 1e-3))


def _of_part(runs: int, part: tuple[int, int]) -> NDArray[np.int_]:
    """Return the runs of part i of n, drawn so that each has long and short ones."""
    number, parts = (1, 1) if isinstance(part, Share) else part
    drawn = np.random.default_rng(1).permutation(runs)
    return np.sort(drawn[number - 1 :: parts])


def _told(partial: Ensemble, store: Any) -> str:
    """Return the text of an interruption."""
    done = int((partial.status != "").sum())
    kept = (
        "this error has them as `ensemble`; with store= the next call computes the rest"
        if store is None
        else f"they are in {store}, and the same call computes the rest"
    )
    return (
        f"ensemble: interrupted after {done} of {len(partial)} runs; {kept} (allow_partial=True "
        "returns what is done)"
    )


def _plain(value: Any) -> Any:
    """Return a value of Python in place of one of numpy, which has another text."""
    return value.item() if isinstance(value, np.generic) else value


def checked_part(shard: Any, store: Any, faults: list[str]) -> tuple[int, int]:
    """Return which part of how many this process does; without parts the first of one."""
    with _arguments.collected(faults):
        if store is not None:
            _arguments.path(store, "store")
    if isinstance(shard, Share):
        return shard
    if shard is None:
        return 1, 1
    try:
        number, parts = (_arguments.integer(part, "shard") for part in shard)
        if not 1 <= number <= parts:
            raise ValueError
    except (InputError, TypeError, ValueError):
        faults.append(
            f"shard = {_arguments.shown(shard)} must be two whole numbers (i, n) with 1 <= i <= n"
        )
        return 1, 1
    if store is None:
        faults.append("shard: parts come together in a store; give store=")
    return number, parts


def _named(names: tuple[str, ...], result: Outcome, plan: Plan) -> dict[str, Array]:
    """Return the measures of all runs by name, with drifts: displacements over heights."""
    values = dict(zip(plan.names, result.values, strict=True))
    heights = np.array([column.height for column in plan.columns])[plan.column]
    values["peak_drift"] = np.abs(values["peak_displacement"]) / heights
    values["residual_drift"] = np.abs(values["residual_displacement"]) / heights
    return {name: values[name] for name in names}
