"""Where work is done: in this thread, in other processes, on a cluster.

All have the interface of `concurrent.futures`, as its threads do.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import suppress
from functools import partial
from multiprocessing import connection
from typing import Any

from rbsdem import _arguments
from rbsdem.errors import InputError


def available_processors() -> int:
    """Return the number of processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def check_jobs(jobs: Any) -> int:
    """Return the number of threads or processes, or raise `InputError` if it is none."""
    if _arguments.whole(jobs, "jobs") < 1:
        raise InputError(f"jobs = {jobs} must be 1 or more")
    return int(jobs)


class Serial(Executor):
    """Do tasks in the calling thread: one is done when it is submitted."""

    def submit(self, function: Callable[..., Any], /, *args: Any, **more: Any) -> Future[Any]:
        """Do a task; a keyboard interrupt is not caught."""
        future: Future[Any] = Future()
        try:
            future.set_result(function(*args, **more))
        except Exception as error:
            future.set_exception(error)
        return future


class Processes(Executor):
    """Processes that end with this one, by whatever signal.

    The tasks of a process that dies, and of its neighbours, raise `BrokenProcessPool`; later ones
    are done by new processes.

    Parameters
    ----------
    jobs : int
        Number of processes.
    preload : str
        Module that each process begins with, so that it is imported once.
    """

    def __init__(self, jobs: int, preload: str) -> None:
        self._jobs = jobs
        self._preload = preload
        self._others = set(multiprocessing.active_children())
        self._pool = self._new_pool()

    def _new_pool(self) -> ProcessPoolExecutor:
        # Not by fork, since libraries may have started threads.
        known = multiprocessing.get_all_start_methods()
        context: Any = multiprocessing.get_context(
            "forkserver" if "forkserver" in known else "spawn"
        )
        if "forkserver" in known:
            context.set_forkserver_preload([self._preload])
        return ProcessPoolExecutor(self._jobs, mp_context=context, initializer=_begin)

    def submit(self, function: Callable[..., Any], /, *args: Any, **more: Any) -> Future[Any]:
        """Give a task to a process."""
        try:
            return self._pool.submit(function, *args, **more)
        except BrokenProcessPool:
            self._pool.shutdown(wait=False)
            self._pool = self._new_pool()
            return self._pool.submit(function, *args, **more)

    def __exit__(self, kind: object, error: object, trace: object) -> None:
        """Let go of the processes, after an error without waiting for them."""
        self.shutdown(wait=kind is None)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Let go of the processes; without `wait` they are killed."""
        if not wait:
            for child in set(multiprocessing.active_children()) - self._others:
                child.kill()
        self._pool.shutdown(wait=wait, cancel_futures=cancel_futures)


def _begin() -> None:
    """Prepare a process: a keyboard interrupt reaches all of them, the main one handles it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_main, daemon=True).start()


def _end_with_main() -> None:
    """End this process as soon as the main one is gone, by whatever signal."""
    main = multiprocessing.parent_process()
    if main is not None:
        connection.wait([main.sentinel])
        os._exit(1)


def check_sent(name: str, value: object, what: str) -> None:
    """Raise `InputError` for what cannot be sent to another process."""
    try:
        pickle.dumps(value)
    except Exception as error:
        raise InputError(
            f"{name} = {what} cannot be sent to another process ({error}); take jobs = 1, or put "
            "the function into a module of its own"
        ) from error


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

    def cancel(self) -> None:
        """Take back the tasks that have not ended."""
        with suppress(RuntimeError):  # The set may change while it is copied.
            self._client.cancel([remote for remote in list(self._remote) if not remote.done()])
