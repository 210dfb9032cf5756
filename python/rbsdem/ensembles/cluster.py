"""Tasks by the workers of a Dask cluster, on this machine or on many."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from rbsdem.ensembles.measures import STATUSES
from rbsdem.ensembles.tasks import Plan, Task, TaskResult, compute
from rbsdem.ensembles.threads import Piece

__all__ = ["check_client", "in_cluster"]

#: Tasks that a thread of the cluster has before it, so that none waits for the next.
_AHEAD = 3


def check_client(client: Any, faults: list[str]) -> None:
    """Add a fault for what is not a client of a cluster with workers; None is no client."""
    if client is None:
        return
    if not callable(getattr(client, "submit", None)) or not hasattr(client, "ncores"):
        faults.append(
            f"client = {client!r} must be a dask.distributed.Client (pip install distributed)"
        )
    elif not client.ncores():
        faults.append("client: its cluster has no workers; start some first")


def in_cluster(
    plan: Plan,
    pieces: list[Piece],
    client: Any,
    take: Callable[[Piece, TaskResult], None],
    told: Callable[[int], None],
) -> bool:
    """Do all pieces; `take` gets their results as they come. Return whether Ctrl-C broke it off.

    The cluster gives the task of a worker that dies to another one. Runs of a task at which several
    workers have died are failed.
    """
    from distributed import KilledWorker, as_completed  # noqa: PLC0415

    left = iter(pieces)
    of: dict[Any, Piece] = {}
    done = 0

    def submit(piece: Piece) -> Any:
        future = client.submit(compute, plan.task(*piece), pure=False)
        of[future] = piece
        return future

    ahead = _AHEAD * max(1, sum(client.ncores().values()))
    waiting = as_completed([submit(piece) for _, piece in zip(range(ahead), left, strict=False)])
    try:
        for future in waiting:
            piece = of.pop(future)
            try:
                result = future.result()
            except KilledWorker:
                result = _died(plan.task(*piece))
            take(piece, result)
            done += piece[1] - piece[0]
            told(done)
            following = next(left, None)
            if following is not None:
                waiting.add(submit(following))
    except KeyboardInterrupt:
        client.cancel(list(of))
        return True
    except BaseException:
        client.cancel(list(of))
        raise
    return False


def _died(task: Task) -> TaskResult:
    """Return the result of a task at which workers have died."""
    runs = len(task)
    text = "several worker processes died at the task of this run; run it alone to see why"
    return TaskResult(
        np.full(runs, STATUSES.index("failed"), dtype=np.int8),
        np.full((len(task.names), runs), np.nan),
        {name: np.full(runs, np.nan) for name in task.functions},
        dict.fromkeys(range(runs), text),
    )
