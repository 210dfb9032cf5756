"""Many tests, here or in other processes."""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import connection
from multiprocessing.synchronize import Event
from typing import Any

from rbsdem.errors import InputError
from rbsdem.measured.one import How, Model, light, name_of, predict_one
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.specimen import Specimen

__all__ = ["check_sent", "here", "in_processes"]

# Tests that a process gets at once: few enough to keep all processes busy to the end.
_CHUNK = 6

# What a process of the pool was given when it started.
_shared: dict[str, Event] = {}


def here(
    tests: list[Specimen], model: Model, how: How, options: dict[str, Any], jobs: int
) -> Iterator[tuple[int, Prediction]]:
    """Yield the rows, one after the other."""
    del jobs
    for number, specimen in enumerate(tests):
        yield number, light(predict_one(specimen, model, how=how, **options))


def in_processes(
    tests: list[Specimen], model: Model, how: How, options: dict[str, Any], jobs: int
) -> Iterator[tuple[int, Prediction]]:
    """Yield the rows as they are finished."""
    chunks = [range(i, min(i + _CHUNK, len(tests))) for i in range(0, len(tests), _CHUNK)]
    lost: list[int] = []
    stop = _context().Event()
    pool = _pool(min(jobs, len(chunks)), stop)
    try:
        futures: dict[Future[list[Prediction]], range] = {
            pool.submit(_chunk, [tests[i] for i in chunk], model, how, options): chunk
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
    yield from _one_by_one(sorted(lost), tests, model, how, options)


def _one_by_one(
    numbers: list[int], tests: list[Specimen], model: Model, how: How, options: dict[str, Any]
) -> Iterator[tuple[int, Prediction]]:
    """Yield the rows of tests whose process died, each in a process of its own."""
    pool = None
    try:
        for number in numbers:
            pool = pool or _pool(1, _context().Event())
            try:
                (row,) = pool.submit(_chunk, [tests[number]], model, how, options).result()
            except BrokenProcessPool:
                pool.shutdown(wait=False)
                pool = None
                error = "the process died; run this test alone (jobs = 1) to see why"
                row = Prediction(tests[number], name_of(model, options), "failed", error=error)
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


def _chunk(
    tests: list[Specimen], model: Model, how: How, options: dict[str, Any]
) -> list[Prediction]:
    rows = []
    for specimen in tests:
        if _shared["stop"].is_set():
            break
        rows.append(light(predict_one(specimen, model, how=how, **options)))
    return rows


def _context() -> Any:
    """Return how processes are started: not by fork, since libraries may have started threads."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["rbsdem.measured.processes"])
    return context


def check_sent(model: Model, options: dict[str, Any]) -> None:
    """Raise `InputError` for what cannot be sent to another process."""
    try:
        pickle.dumps((model, options))
    except Exception as error:
        raise InputError(
            f"model = {model!r} cannot be sent to another process ({error}); take jobs = 1, or "
            "put the function into a module of its own"
        ) from error
