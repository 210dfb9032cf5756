"""The progress of a study of methods on the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rbsdem.methods.ladder import Budget


@contextmanager
def telling(clock: Budget) -> Iterator[Callable[[str], None]]:
    """Show on stderr what is being done and how much of the budget is used.

    Drawn between runs only, so that no thread disturbs what is timed.
    """
    import rich.progress  # noqa: PLC0415
    from rich.console import Console  # noqa: PLC0415

    bar = rich.progress.Progress(
        rich.progress.BarColumn(bar_width=20),
        rich.progress.TextColumn("{task.completed:.0f} of {task.total:.0f} s  {task.description}"),
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=clock.seconds)

        def told(text: str) -> None:
            bar.update(task, completed=clock.used(), description=text, refresh=True)

        yield told
