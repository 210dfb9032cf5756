"""Tasks by threads of this process: the solver releases the interpreter's lock."""

from __future__ import annotations

from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

import numpy as np

from rbsdem.ensembles.progress import telling
from rbsdem.ensembles.tasks import Integers, Plan, TaskResult, compute, nothing

#: How often the display is renewed, and Ctrl-C seen [s].
_BEAT = 0.2


def in_threads(
    plan: Plan, pieces: list[tuple[int, int]], jobs: int, progress: bool
) -> tuple[list[TaskResult], bool]:
    """Return the results of all pieces in their order, and whether Ctrl-C broke it off.

    After Ctrl-C the runs under way are finished, the others are not started.
    """
    found = [nothing(last - first, plan.functions) for first, last in pieces]
    if not pieces:
        return found, False
    controls = [np.zeros(2, dtype=np.int32) for _ in pieces]
    interrupted = False
    with ThreadPoolExecutor(jobs) as pool, telling(progress, plan.scale.size) as told:
        waiting: dict[Future[TaskResult], int] = {}
        left = iter(range(len(pieces)))
        try:
            for place in left:
                waiting[pool.submit(_piece, plan, pieces[place], controls[place])] = place
                if len(waiting) == 2 * jobs:
                    _take(waiting, found, controls, told)
            while waiting:
                _take(waiting, found, controls, told)
        except KeyboardInterrupt:
            interrupted = True
            for control in controls:
                control[0] = 1
            while waiting:
                _take(waiting, found, controls, told)
    return found, interrupted


def _piece(plan: Plan, piece: tuple[int, int], control: Integers) -> TaskResult:
    return compute(plan.task(*piece), control)


def _take(
    waiting: dict[Future[TaskResult], int],
    found: list[TaskResult],
    controls: list[Integers],
    told: object,
) -> None:
    """Take what is done, after waiting for a task or for a beat."""
    done, _ = wait(waiting, timeout=_BEAT, return_when=FIRST_COMPLETED)
    for future in done:
        found[waiting.pop(future)] = future.result()
    if callable(told):
        told(sum(int(control[1]) for control in controls))
