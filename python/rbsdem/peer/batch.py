"""Prediction of tests from their properties: a loop and scores for each."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
import time
import warnings
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from multiprocessing import connection
from multiprocessing.synchronize import Event
from typing import Any, TypeAlias

import numpy as np

from rbsdem import _core
from rbsdem.analysis import cyclic
from rbsdem.column import Column
from rbsdem.comparison import compare
from rbsdem.errors import InputError, RbsdemError, SolveError
from rbsdem.peer.columns import check_options, checked_specimen
from rbsdem.peer.columns import column as column_of
from rbsdem.peer.journal import Journal
from rbsdem.peer.measured import MeasuredTest
from rbsdem.peer.predictions import Prediction, Predictions
from rbsdem.peer.progress import progress_bar
from rbsdem.peer.specimen import Specimen
from rbsdem.section.model import DEFAULT, model_name

__all__ = ["predict", "predict_one"]

Model: TypeAlias = str | Callable[[Specimen], Column]

# Tests that a process gets at once: few enough to keep all processes busy to the end.
_CHUNK = 6

# What a process of the pool was given when it started.
_shared: dict[str, Event] = {}


def predict(
    specimens: Iterable[Specimen],
    model: Model = DEFAULT,
    *,
    jobs: int = 1,
    progress: bool = False,
    journal: str | os.PathLike[str] | None = None,
    **options: Any,
) -> Predictions:
    """Predict tests from their properties, and compare with what was measured.

    Each column is driven through the measured displacements; its lateral force is compared with the
    net horizontal force of the test.

    Parameters
    ----------
    specimens : iterable of Specimen
        The tests, as from `rbsdem.peer.read_specimens`.
    model : str or callable, optional
        A model of `rbsdem.peer.column`, or a function that makes a `Column` from a `Specimen`; with
        `jobs` above 1 the function must be importable.
    jobs : int, optional
        Processes to use. Above 1 a script needs ``if __name__ == "__main__":``.
    progress : bool, optional
        Show a bar on stderr.
    journal : path, optional
        File to which each prediction is written as it comes. Predictions that are there already,
        of the same tests by the same model, options and version of rbsdem, are not done again, so
        that a batch that was ended in any way goes on from where it stopped. The model must be
        given by name. The file stays; remove it to predict everything anew.
    **options
        Passed to `rbsdem.peer.column`, such as ``n=4``.

    Returns
    -------
    Predictions
        A row for each test, in their order. A test that goes wrong has a row with the text of the
        error. After a keyboard interrupt the rows are those that were finished.

    Raises
    ------
    InputError
        If the model or its version is not known, if `jobs` is below 1, or if there is a journal
        for a model that is a function.
    """
    if _core.whole(jobs, "jobs") < 1:
        raise InputError(f"jobs = {jobs} must be 1 or more")
    name = _name(model, options)
    if jobs > 1:
        _check_sent(model, options)
    tests = [checked_specimen(specimen) for specimen in specimens]
    if not callable(model):
        check_options(options)
    begin = time.perf_counter()
    kept = None
    if journal is not None:
        if callable(model):
            raise InputError(
                f"journal: the model {name} is a function, of which nobody knows whether it has "
                "changed; give a model by name, or no journal"
            )
        kept = Journal(journal, tests, name, options)
    rows = kept.finished() if kept else {}
    resumed = len(rows)
    left = [number for number in range(len(tests)) if number not in rows]
    run = _in_processes if jobs > 1 and len(left) > 1 else _here
    interrupted = False
    others = set(multiprocessing.active_children())
    with ExitStack() as stack:
        told = stack.enter_context(progress_bar(len(tests), resumed)) if progress else None
        try:
            for place, row in run([tests[number] for number in left], model, options, jobs):
                rows[left[place]] = row
                # A process that died may live the next time.
                if kept and not (row.status == "failed" and row.comparison is None):
                    kept.add(left[place], row)
                if told:
                    told(row)
        except KeyboardInterrupt:
            interrupted = True
        except SystemExit:  # told to end: nobody waits for the tests that are under way
            for child in set(multiprocessing.active_children()) - others:
                child.kill()
            raise
    return Predictions(
        (rows[number] for number in sorted(rows)),
        model=name,
        seconds=time.perf_counter() - begin,
        interrupted=interrupted,
        resumed=resumed,
    )


def predict_one(specimen: Specimen, model: Model = DEFAULT, **options: Any) -> Prediction:
    """Predict one test; an error is reported in the row that is returned.

    Parameters
    ----------
    specimen : Specimen
        The test.
    model : str or callable, optional
        As for `predict`.
    **options
        As for `predict`.

    Returns
    -------
    Prediction
        Its status, its scores and its times.
    """
    name = _name(model, options)
    checked_specimen(specimen)
    if not callable(model):
        check_options(options)
    try:
        test = specimen.test()
        # A test without a usable history is found before the work.
        compare((test.displacement, test.force), test)
    except RbsdemError as error:
        return Prediction(specimen, name, "no history", error=str(error))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        status, error, result, seconds = _analyse(specimen, test, model, options)
    comparison = compare(result, test)
    if status == "completed" and comparison.path_fraction < 1:
        status, error = "stopped", f"the forces end at row {comparison.rows}"
    return Prediction(
        specimen,
        name,
        status,
        error=error,
        note="; ".join(dict.fromkeys(str(warning.message) for warning in caught)),
        seconds_model=seconds[0],
        seconds_analysis=seconds[1],
        comparison=comparison,
    )


def _analyse(
    specimen: Specimen, test: MeasuredTest, model: Model, options: dict[str, Any]
) -> tuple[str, str, Any, tuple[float, float]]:
    """Return status, error, result and wall times; without an analysis the result is NaN."""
    nothing = test.displacement, np.full(test.displacement.size, np.nan)
    begin = built = time.perf_counter()
    try:
        if callable(model):
            column = model(specimen, **options)
        else:
            column = column_of(specimen, model, **options)
        built = time.perf_counter()
        result = cyclic(column, displacement=test.displacement)
        status, error = "completed", ""
    except SolveError as stop:
        known = stop.result is not None
        status, error, result = "stopped" if known else "failed", str(stop), stop.result or nothing
    except RbsdemError as fault:
        status, error, result = "failed", str(fault), nothing
    except Exception as fault:
        # A fault in one model is a row of the table and does not end the others.
        status, error, result = "failed", f"{type(fault).__name__}: {fault}", nothing
    end = time.perf_counter()
    built = max(built, begin)
    return status, error, result, (built - begin, end - built)


def _here(
    tests: list[Specimen], model: Model, options: dict[str, Any], jobs: int
) -> Iterator[tuple[int, Prediction]]:
    del jobs
    for number, specimen in enumerate(tests):
        yield number, predict_one(specimen, model, **options)


def _in_processes(
    tests: list[Specimen], model: Model, options: dict[str, Any], jobs: int
) -> Iterator[tuple[int, Prediction]]:
    """Yield the rows as they are finished."""
    chunks = [range(i, min(i + _CHUNK, len(tests))) for i in range(0, len(tests), _CHUNK)]
    lost: list[int] = []
    stop = _context().Event()
    pool = _pool(min(jobs, len(chunks)), stop)
    try:
        futures: dict[Future[list[Prediction]], range] = {
            pool.submit(_chunk, [tests[i] for i in chunk], model, options): chunk
            for chunk in chunks
        }
        for future in as_completed(futures):
            try:
                rows = future.result()
            except BrokenProcessPool:
                lost += futures[future]
            else:
                yield from zip(futures[future], rows, strict=True)
    finally:
        stop.set()
        pool.shutdown(wait=False, cancel_futures=True)
    yield from _one_by_one(sorted(lost), tests, model, options)


def _one_by_one(
    numbers: list[int], tests: list[Specimen], model: Model, options: dict[str, Any]
) -> Iterator[tuple[int, Prediction]]:
    """Yield the rows of tests whose process died, each in a process of its own."""
    pool = None
    try:
        for number in numbers:
            pool = pool or _pool(1, _context().Event())
            try:
                (row,) = pool.submit(_chunk, [tests[number]], model, options).result()
            except BrokenProcessPool:
                pool.shutdown(wait=False)
                pool = None
                error = "the process died; run this test alone (jobs = 1) to see why"
                row = Prediction(tests[number], _name(model, options), "failed", error=error)
            yield number, row
    finally:
        if pool is not None:
            pool.shutdown(wait=False, cancel_futures=True)


def _pool(jobs: int, stop: Event) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(jobs, mp_context=_context(), initializer=_begin, initargs=(stop,))


def _begin(stop: Event) -> None:
    """Prepare a process: a keyboard interrupt reaches all of them, the main one handles it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    _shared["stop"] = stop
    threading.Thread(target=_end_with_main, daemon=True).start()


def _end_with_main() -> None:
    """End this process as soon as the main one is gone, by whatever signal."""
    main = multiprocessing.parent_process()
    if main is not None:
        connection.wait([main.sentinel])
        os._exit(1)


def _chunk(tests: list[Specimen], model: Model, options: dict[str, Any]) -> list[Prediction]:
    rows = []
    for specimen in tests:
        if _shared["stop"].is_set():
            break
        rows.append(predict_one(specimen, model, **options))
    return rows


def _context() -> Any:
    """Return how processes are started: not by fork, since libraries may have started threads."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["rbsdem.peer.batch"])
    return context


def _check_sent(model: Model, options: dict[str, Any]) -> None:
    """Raise `InputError` for what cannot be sent to another process."""
    try:
        pickle.dumps((model, options))
    except Exception as error:
        raise InputError(
            f"model = {model!r} cannot be sent to another process ({error}); take jobs = 1, or "
            "put the function into a module of its own"
        ) from error


def _name(model: Model, options: dict[str, Any]) -> str:
    """Return the name of the model, with the version of its parameters."""
    if callable(model):
        return getattr(model, "__name__", repr(model))
    return model_name(model, options.get("version"), options.get("model_parameters"))
