"""The progress of a calibration on the terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager


@contextmanager
def telling(evaluations: int) -> Iterator[Callable[[int, float], None]]:
    """Show on stderr the number of finished analyses and the best error so far."""
    import rich.progress  # noqa: PLC0415
    from rich.console import Console  # noqa: PLC0415

    bar = rich.progress.Progress(
        rich.progress.BarColumn(bar_width=20),
        rich.progress.TextColumn("{task.completed:.0f} of at most {task.total:.0f} analyses"),
        rich.progress.TextColumn("{task.description}"),
        console=Console(stderr=True),
        transient=True,
    )
    with bar:
        task = bar.add_task("", total=evaluations)

        def told(done: int, best: float) -> None:
            bar.update(task, completed=min(done, evaluations), description=f"nrmse {best:.4f}")

        yield told
