"""Tasks on their way to an executor and back, until all are done or somebody ends the work.

A task is whatever its caller takes it for; work is a function and its inputs. Executors have the
interface of `concurrent.futures`, as its threads do.
"""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from typing import Any, TypeVar

from rbsdem.errors import InputError

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
