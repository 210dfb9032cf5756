"""The progress of an ensemble on the terminal."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rbsdem._optional import need_rich


@contextmanager
def telling(wanted: bool, total: int) -> Iterator[Callable[[int], None]]:
    """Show on stderr how many runs are done, how many a second, and the time left.

    Where stderr is a pipe or a file, nothing is shown.
    """
    if not wanted or not sys.stderr.isatty():
        yield lambda done: None
        return
    rich = need_rich()
    from rich.console import Console  # noqa: PLC0415

    bar = rich.progress.Progress(
        rich.progress.BarColumn(bar_width=24),
        rich.progress.MofNCompleteColumn(),
        rich.progress.TextColumn("{task.description}"),
        rich.progress.TimeRemainingColumn(),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=total)

        def told(done: int) -> None:
            speed = bar.tasks[task].speed
            rate = "" if speed is None else f"{speed:.3g} runs/s,"
            bar.update(task, completed=done, description=rate)

        yield told
