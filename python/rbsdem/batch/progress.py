"""The progress of work on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def progress_bar(
    wanted: bool, total: int, unit: str = "runs", between: bool = False
) -> Iterator[Callable[[int, str], None]]:
    """Show on stderr how much is done, how much a second, the time left, and a text.

    Where stderr is a pipe or a file, nothing is shown. With `between` no thread draws between two
    calls; seconds have no rate.

    Yields
    ------
    callable
        Takes the number that is done and the text.
    """
    if not wanted or not sys.stderr.isatty():
        yield lambda done, text: None
        return
    from rich import progress  # noqa: PLC0415
    from rich.console import Console  # noqa: PLC0415

    bar = progress.Progress(
        progress.BarColumn(bar_width=24),
        progress.MofNCompleteColumn(),
        progress.TextColumn("{task.description}", markup=False),
        progress.TimeRemainingColumn(),
        console=Console(stderr=True),
        auto_refresh=not between,
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=total)

        def show(done: int, text: str) -> None:
            speed = bar.tasks[task].speed
            rate = "" if speed is None or unit == "s" else f"{speed:.3g} {unit}/s"
            parts = [part for part in (rate, text) if part]
            bar.update(task, completed=done, description=", ".join(parts), refresh=between)

        yield show
