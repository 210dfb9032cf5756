"""Tasks by threads of this process: the solver releases the interpreter's lock."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

import numpy as np

from rbsdem.batch.tasks import Integers, Piece, Plan, TaskResult, compute
from rbsdem.batch.work import BEAT

__all__ = ["Threads"]


class Threads:
    """Workers that are threads.

    Parameters
    ----------
    plan : Plan
        The runs.
    jobs : int
        Number of threads.
    """

    def __init__(self, plan: Plan, jobs: int) -> None:
        #: Tasks under way or next in line, so that no thread waits for one.
        self.ahead = 2 * jobs
        self._plan = plan
        self._pool = ThreadPoolExecutor(jobs)
        self._controls: list[Integers] = []

    def submit(self, piece: Piece) -> Future[TaskResult]:
        """Give a task to the threads."""
        control = np.zeros(2, dtype=np.int32)
        self._controls.append(control)
        return self._pool.submit(_do, self._plan, piece, control)

    def ended(self, futures: Iterable[Future[TaskResult]]) -> set[Future[TaskResult]]:
        """Return the tasks that have ended, after a moment at the latest."""
        return wait(futures, timeout=BEAT, return_when=FIRST_COMPLETED).done

    def result(self, future: Future[TaskResult], piece: Piece) -> TaskResult:
        """Return what a task has come to."""
        del piece
        return future.result()

    def runs(self) -> int:
        """Return the number of runs that are done."""
        return sum(int(control[1]) for control in self._controls)

    def stop(self) -> None:
        """Finish the runs under way, and start no others: every task ends with what it has."""
        for control in self._controls:
            control[0] = 1

    def close(self) -> None:
        """Let go of the threads."""
        self._pool.shutdown()


def _do(plan: Plan, piece: Piece, control: Integers) -> TaskResult:
    return compute(plan.task(*piece), control)
