"""Tasks by the workers of a Dask cluster, on this machine or on many."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import suppress
from typing import Any

import numpy as np

from rbsdem.batch.measures import STATUSES
from rbsdem.batch.tasks import Piece, Plan, Task, TaskResult, compute
from rbsdem.batch.work import BEAT

__all__ = ["Cluster", "check_client"]

#: Tasks that a thread of the cluster has before it, so that none waits for the next.
_AHEAD = 3


def check_client(client: Any, faults: list[str]) -> None:
    """Add a fault for what is not a client of a cluster with workers; None is no client."""
    if client is None:
        return
    if not callable(getattr(client, "submit", None)) or not hasattr(client, "ncores"):
        faults.append(
            f"client = {client!r:.60} must be a dask.distributed.Client (pip install distributed)"
        )
    elif not client.ncores():
        faults.append("client: its cluster has no workers; start some first")


class Cluster:
    """Workers that are those of a cluster.

    It gives the task of a worker that dies to another one. Runs of a task at which several workers
    have died are failed.

    Parameters
    ----------
    plan : Plan
        The runs.
    client : dask.distributed.Client
        The way to the cluster.
    """

    def __init__(self, plan: Plan, client: Any) -> None:
        self.ahead = _AHEAD * max(1, sum(client.ncores().values()))
        self._plan = plan
        self._client = client
        self._waiting: set[Any] = set()
        self._stopped = False
        self._done = 0

    def submit(self, piece: Piece) -> Any:
        """Give a task to the cluster."""
        future = self._client.submit(compute, self._plan.task(*piece), pure=False)
        self._waiting.add(future)
        return future

    def ended(self, futures: Iterable[Any]) -> Iterable[Any]:
        """Return the tasks that have ended, after a moment at the latest."""
        from distributed import wait  # noqa: PLC0415

        if not self._stopped:
            with suppress(TimeoutError):
                wait(list(futures), BEAT, "FIRST_COMPLETED")
        return [future for future in futures if future.done()]

    def result(self, future: Any, piece: Piece) -> TaskResult:
        """Return what a task has come to."""
        from distributed import KilledWorker  # noqa: PLC0415

        self._waiting.discard(future)
        task = self._plan.task(*piece)
        if future.cancelled():
            return _without_values(task, "")
        try:
            result: TaskResult = future.result()
        except KilledWorker:
            result = _without_values(task, "failed")
            text = "several worker processes died at the task of this run; run it alone to see why"
            result.errors.update(dict.fromkeys(range(len(task)), text))
        self._done += len(task)
        return result

    def runs(self) -> int:
        """Return the number of runs that are done."""
        return self._done

    def stop(self) -> None:
        """Take back the tasks that have not ended."""
        self._stopped = True
        self._client.cancel([future for future in self._waiting if not future.done()])

    def close(self) -> None:
        """Let the cluster be: it belongs to its client."""


def _without_values(task: Task, status: str) -> TaskResult:
    """Return the result of a task of which nothing came back."""
    runs = len(task)
    return TaskResult(
        np.full(runs, STATUSES.index(status), dtype=np.int8),
        np.full((len(task.names), runs), np.nan),
        {name: np.full(runs, np.nan) for name in task.functions},
        {},
    )
