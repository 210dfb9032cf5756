"""Tasks on their way to an executor and back, until all are done or somebody ends the work.

A task is whatever its caller takes it for; work is a function and its inputs. Executors have the
interface of `concurrent.futures`, as its threads do.
"""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from typing import Any, TypeVar

from rbsdem import _arguments
from rbsdem.errors import InputError, SolveError

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


def check_jobs(jobs: Any) -> int:
    """Return the number of threads or processes, or raise `InputError` if it is none."""
    _arguments.integer(jobs, "jobs", least=1)
    return int(jobs)


def check_client(client: Any) -> None:
    """Raise `InputError` for what is not a client of a cluster with workers."""
    if not callable(getattr(client, "submit", None)) or not hasattr(client, "ncores"):
        raise InputError(
            f"client = {client!r:.60} must be a dask.distributed.Client (pip install distributed)"
        )
    if not client.ncores():
        raise InputError("client: its cluster has no workers; start some first")


class Cluster(Executor):
    """The workers of a Dask cluster.

    It gives the task of a worker that dies to another one. A task at which several workers have
    died raises `BrokenProcessPool`.

    Parameters
    ----------
    client : dask.distributed.Client
        The way to the cluster, which belongs to it.
    """

    def __init__(self, client: Any) -> None:
        self._client = client
        self._remote: set[Any] = set()
        self._question: _Question | None = None
        self._answered = time.monotonic()

    @property
    def workers(self) -> int:
        """Number of threads of the cluster."""
        return max(1, int(sum(self._client.ncores().values())))

    def submit(self, function: Callable[..., Any], /, *args: Any, **more: Any) -> Future[Any]:
        """Give a task to the cluster."""
        future: Future[Any] = Future()
        remote = self._client.submit(function, *args, pure=False, **more)
        self._remote.add(remote)
        remote.add_done_callback(partial(self._hand_over, future))
        return future

    def _hand_over(self, future: Future[Any], remote: Any) -> None:
        """Give the outcome of a task to the future that its caller has."""
        self._remote.discard(remote)
        # The caller may have cancelled it in between.
        if remote.cancelled() or not future.set_running_or_notify_cancel():
            future.cancel()
            return
        error = remote.exception()
        if error is None:
            future.set_result(remote.result())
        elif type(error).__name__ == "KilledWorker":
            future.set_exception(BrokenProcessPool("several worker processes died at the task"))
        else:
            future.set_exception(error)

    def waited_for(self) -> str:
        """Ask the scheduler for its workers; return what is waited for, if they are long in coming.

        Raises
        ------
        SolveError
            If there was no scheduler, or no worker, for a minute.
        """
        question, now = self._question, time.monotonic()
        if question is not None and question.done.is_set():
            if question.answer:
                self._answered = now
            if now - question.asked > _QUESTIONS:
                self._question = None
        if self._question is None:
            self._question = _Question(self._client.ncores)
        silent = now - self._answered
        if silent < _SILENT:
            return ""
        answers = question is not None and question.answer is not None
        what = "workers" if answers and self._client.status == "running" else "scheduler"
        if silent > _PATIENCE:
            raise SolveError(
                f"client: the cluster has had no {what} for {_PATIENCE:.0f} s; start it again. "
                "With store= the next call computes what is missing"
            )
        return f"waiting for a {what.removesuffix('s')} of the cluster"

    def cancel(self) -> None:
        """Take back the tasks that have not ended; a cluster that is silent is not waited for."""
        remotes = [remote for remote in self._remote.copy() if not remote.done()]
        _Question(partial(self._client.cancel, remotes)).done.wait(_SILENT)


#: How often a cluster is asked, when it counts as silent, and how long it may be [s].
_QUESTIONS, _SILENT, _PATIENCE = 1.0, 5.0, 60.0


class _Question:
    """A call to the scheduler in a thread of its own, since it may never come back."""

    def __init__(self, call: Callable[[], Any]) -> None:
        self.asked = time.monotonic()
        self.answer: Any = None
        self.done = threading.Event()
        threading.Thread(target=self._ask, args=(call,), daemon=True).start()

    def _ask(self, call: Callable[[], Any]) -> None:
        with suppress(Exception):  # Of a closed connection, of many kinds.
            self.answer = call()
        self.done.set()
