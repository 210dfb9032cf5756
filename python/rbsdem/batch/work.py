"""Tasks on their way to workers and back, until all are done or somebody ends the work."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import Any, Protocol

from rbsdem.batch.tasks import Piece, TaskResult

__all__ = ["BEAT", "Asked", "work_through"]

#: How often the display is renewed, and a signal seen [s].
BEAT = 0.2


class Workers(Protocol):
    """Those that do tasks: threads of this process or a cluster."""

    ahead: int

    def submit(self, piece: Piece) -> Any:
        """Give them a task; return by what it is known."""

    def ended(self, futures: Iterable[Any]) -> Iterable[Any]:
        """Return the tasks that have ended, after a moment at the latest."""

    def result(self, future: Any, piece: Piece) -> TaskResult:
        """Return what a task has come to."""

    def runs(self) -> int:
        """Return the number of runs that are done."""

    def stop(self) -> None:
        """Let every task end soon, with the runs that it has done."""

    def close(self) -> None:
        """Let go of them."""


class Asked:
    """Whether the work is to end before it is done, by Ctrl-C or SIGTERM.

    The signals are noted and looked at between two tasks: an exception from anywhere would lose a
    task on its way. A second Ctrl-C is an exception at once.
    """

    def __init__(self) -> None:
        self.by: int | None = None

    def __bool__(self) -> bool:
        """Return whether a signal has come."""
        return self.by is not None

    @contextmanager
    def listening(self, also_terminated: bool) -> Iterator[None]:
        """Note signals while the block lasts; pass SIGTERM on to whom it belongs to after it."""
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
            if self.by == signal.SIGTERM:
                os.kill(os.getpid(), signal.SIGTERM)

    def _note(self, number: int, frame: object) -> None:
        del frame
        if self.by is not None and number == signal.SIGINT:
            raise KeyboardInterrupt
        self.by = number


def work_through(
    workers: Workers,
    pieces: Iterable[Piece],
    take: Callable[[Piece, TaskResult], None],
    told: Callable[[int], None],
    asked: Asked,
) -> None:
    """Do all pieces; `take` gets their results as they come.

    Where the work is asked to end, or `take` raises an error, the runs under way are finished and
    the others are not started; after the question `take` gets what was finished.
    """
    waiting: dict[Any, Piece] = {}

    def take_ended() -> None:
        for future in workers.ended(waiting):
            piece = waiting.pop(future)
            take(piece, workers.result(future, piece))
        told(workers.runs())

    try:
        for piece in pieces:
            waiting[workers.submit(piece)] = piece
            while len(waiting) >= workers.ahead and not asked:
                take_ended()
            if asked:
                break
        while waiting and not asked:
            take_ended()
        if asked:
            workers.stop()
        while waiting:
            take_ended()
    except BaseException:
        workers.stop()
        raise
    finally:
        workers.close()
