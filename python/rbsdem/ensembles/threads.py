"""Tasks by threads of this process: the solver releases the interpreter's lock."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait

import numpy as np

from rbsdem.ensembles.tasks import Integers, Plan, TaskResult, compute

__all__ = ["Piece", "in_threads"]

#: First run of a task, and the one after its last.
Piece = tuple[int, int]

#: How often the display is renewed, and Ctrl-C seen [s].
_BEAT = 0.2


def in_threads(
    plan: Plan,
    pieces: list[Piece],
    jobs: int,
    take: Callable[[Piece, TaskResult], None],
    told: Callable[[int], None],
) -> bool:
    """Do all pieces; `take` gets their results as they come. Return whether Ctrl-C broke it off.

    After Ctrl-C, and where `take` raises an error, the runs under way are finished and the others
    are not started.
    """
    controls = {piece: np.zeros(2, dtype=np.int32) for piece in pieces}
    interrupted = False
    waiting: dict[Future[TaskResult], Piece] = {}

    def take_done() -> None:
        done, _ = wait(waiting, timeout=_BEAT, return_when=FIRST_COMPLETED)
        for future in done:
            take(waiting.pop(future), future.result())
        told(sum(int(control[1]) for control in controls.values()))

    with ThreadPoolExecutor(jobs) as pool:
        try:
            for piece in pieces:
                waiting[pool.submit(_do, plan, piece, controls[piece])] = piece
                while len(waiting) >= 2 * jobs:
                    take_done()
            while waiting:
                take_done()
        except KeyboardInterrupt:
            interrupted = True
            _stop(controls)
            while waiting:
                take_done()
        except BaseException:
            _stop(controls)
            raise
    return interrupted


def _do(plan: Plan, piece: Piece, control: Integers) -> TaskResult:
    return compute(plan.task(*piece), control)


def _stop(controls: dict[Piece, Integers]) -> None:
    for control in controls.values():
        control[0] = 1
