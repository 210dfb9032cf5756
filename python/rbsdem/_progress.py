"""Progress on stderr: of many runs, and of a single one that takes long."""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from rbsdem._types import NDArray

#: A single run is shown after that [s], and renewed so often.
_PATIENCE, _BEAT = 2.0, 0.2
#: Bars that are on the screen, which has room for one.
_SHOWN: list[Any] = []


@dataclass(frozen=True)
class Bar:
    """A bar that is shown: its call takes the number that is done, and a text."""

    show: Callable[[int, str], None]

    def __call__(self, done: int, text: str) -> None:
        """Show how much is done."""
        self.show(done, text)


@contextmanager
def progress_bar(
    wanted: bool | Bar, total: int, unit: str = "runs", between: bool = False
) -> Iterator[Bar]:
    """Show on stderr how much is done, how much a second, the time left, and a text.

    Where stderr is a pipe or a file (and no notebook), nothing is shown. With `between` no thread
    draws between two calls; seconds and per cent have no rate. A bar in place of `wanted` is that
    of a longer work. More than the total that is done becomes the total.

    Yields
    ------
    Bar
    """
    if isinstance(wanted, Bar):
        yield wanted
        return
    console = None
    if wanted:
        from rich.console import Console  # noqa: PLC0415

        console = Console(stderr=True)
    if console is None or not (console.is_terminal or console.is_jupyter):
        yield Bar(lambda done, text: None)
        return
    from rich import progress  # noqa: PLC0415

    text = progress.TextColumn("{task.description}", markup=False)
    columns = progress.BarColumn(bar_width=24), progress.MofNCompleteColumn(), text
    how: Any = {"console": console, "auto_refresh": not between, "transient": True}
    bar = progress.Progress(*columns, progress.TimeRemainingColumn(), **how)
    _SHOWN.append(bar)
    try:
        with bar:
            task = bar.add_task(unit, total=total)

            def show(done: int, text: str) -> None:
                speed = bar.tasks[task].speed
                rate = "" if speed is None or unit in ("s", "%") else f"{speed:.3g} {unit}/s"
                parts = [part for part in (rate, text) if part]
                most = max(done, total)
                bar.update(
                    task, completed=done, total=most, description=", ".join(parts), refresh=between
                )

            yield Bar(show)
    finally:
        _SHOWN.remove(bar)


@contextmanager
def bar_of_run(control: NDArray[np.int32]) -> Iterator[None]:
    """Show how far a run is, and the time left, from two seconds on; nothing where a bar is shown.

    The run writes its share in parts of a thousand into the second number of `control`.
    """
    # A notebook has no terminal, but shows bars.
    is_shown = "ipykernel" in sys.modules or (sys.stderr is not None and sys.stderr.isatty())
    if _SHOWN or not is_shown:
        yield
        return
    ended = threading.Event()

    def show() -> None:
        if ended.wait(_PATIENCE):
            return
        with progress_bar(True, 100, "%") as bar:
            while not ended.wait(_BEAT):
                bar(int(control[1]) // 10, "per cent of the run")

    thread = threading.Thread(target=show, name="rbsdem progress", daemon=True)
    thread.start()
    try:
        yield
    finally:
        ended.set()
        thread.join()
