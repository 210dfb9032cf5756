"""The progress of predictions on the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rbsdem._optional import need_rich
from rbsdem.measured.prediction import Prediction


@contextmanager
def progress_bar(total: int, done: int = 0) -> Iterator[Callable[[Prediction], None]]:
    """Show on stderr how many tests are done, and the last one."""
    rich = need_rich()
    from rich.console import Console  # noqa: PLC0415

    bar = rich.progress.Progress(
        rich.progress.BarColumn(bar_width=24),
        rich.progress.MofNCompleteColumn(),
        rich.progress.TimeElapsedColumn(),
        rich.progress.TextColumn("{task.description}", markup=False),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=total, completed=done)

        def told(row: Prediction) -> None:
            bar.update(task, advance=1, description=row.specimen.name)

        yield told
