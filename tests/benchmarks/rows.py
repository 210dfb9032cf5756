"""Rows of the table that `benchmark.py` prints, and where the programs are that it runs."""

from __future__ import annotations

import statistics
import sys
from dataclasses import dataclass, field
from pathlib import Path

from rich import box
from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).resolve().parents[2]


@dataclass
class Row:
    """One line of the table; `values` in its unit, empty if it could not be measured.

    The goal is an upper bound, or the lower and the upper one.
    """

    what: str
    unit: str
    goal: float | tuple[float, float] | None = None
    values: list[float] = field(default_factory=list)
    note: str = ""

    def texts(self) -> list[str]:
        """Return the cells of the row."""
        goal = ""
        if isinstance(self.goal, tuple):
            goal = f"{self.goal[0]:g} - {self.goal[1]:g}"
        elif self.goal is not None:
            goal = f"< {self.goal:g}"
        if not self.values:
            return [self.what, self.unit, goal, "-", "", self.note]
        spread = f"{number(min(self.values))} - {number(max(self.values))}"
        note = ", ".join(part for part in (self.verdict(), self.note) if part)
        return [self.what, self.unit, goal, number(statistics.median(self.values)), spread, note]

    def verdict(self) -> str:
        """Return whether the median meets the goal."""
        if self.goal is None:
            return ""
        least, most = self.goal if isinstance(self.goal, tuple) else (-float("inf"), self.goal)
        return "met" if least <= statistics.median(self.values) <= most else "MISSED"


def number(value: float) -> str:
    """Return three digits, and all those before the point."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def newest(name: str, build: Path | None) -> Path | None:
    """Return the newest program of a name in a build folder, or in all of them."""
    folders = [build] if build else [ROOT / "build", *ROOT.glob("build-*")]
    found = [path for folder in folders for path in folder.rglob(name) if path.is_file()]
    found = [path for path in found if not {"checked", "memory"} & set(path.parts)]
    return max(found, key=lambda path: path.stat().st_mtime, default=None)


HEADINGS = ("What", "Unit", "Goal", "Median", "Fastest - slowest", "")


def show(rows: dict[str, list[Row]]) -> None:
    """Print the table."""
    table = Table(box=box.SIMPLE_HEAD)
    for place, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if place in (2, 3) else "left", no_wrap=place < 5)
    for title, part in rows.items():
        table.add_row(f"[bold]{title}")
        for row in part:
            what, *rest = row.texts()
            table.add_row(f"  {what}", *rest, end_section=row is part[-1])
    Console(width=None if sys.stdout.isatty() else 132).print(table)
