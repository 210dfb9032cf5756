"""The progress of predictions on the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from rbsdem._optional import escaped, need_rich
from rbsdem.peer.predictions import Prediction


@contextmanager
def progress_bar(total: int) -> Iterator[Callable[[Prediction], None]]:
    """Show on stderr how many tests are done, and the last one."""
    rich = need_rich()
    from rich.console import Console  # noqa: PLC0415

    bar = rich.progress.Progress(
        rich.progress.BarColumn(bar_width=24),
        rich.progress.MofNCompleteColumn(),
        rich.progress.TimeElapsedColumn(),
        rich.progress.TextColumn("{task.description}"),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=total)

        def told(row: Prediction) -> None:
            bar.update(task, advance=1, description=escaped(row.specimen.name))

        yield told
