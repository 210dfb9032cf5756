"""Predictions as tables of rich."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from rbsdem._optional import need_rich, plain
from rbsdem._views import view_of
from rbsdem.measured.doubts import Checked
from rbsdem.measured.predictions import Predictions, Quartiles

if TYPE_CHECKING:
    from rich.table import Table

_RATIOS = ("peak_ratio", "energy_ratio", "stiffness_ratio", "end_ratio")
_MARKS = {"stopped": "yellow", "failed": "red", "no history": "dim"}


@view_of(Predictions, "table")
def tests_table(predictions: Predictions) -> Table:
    """Return a row for each test."""
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    table.add_column("Test", no_wrap=True)
    table.add_column("Failure", no_wrap=True)
    names = ("NRMSE", "Peak", "Energy", "K", "End", "Loss %\ntest", "\nmodel", "Time\nms")
    for name in names:
        table.add_column(name, justify="right", no_wrap=True)
    # As wide as the text, it would squeeze all others.
    table.add_column("", no_wrap=True, overflow="ellipsis", max_width=60)
    for row in predictions:
        drifts = (row.score("test_drift_at_loss"), row.score("model_drift_at_loss"))
        cells = [_number(row.nrmse, 3), *(_number(row.score(name), 2) for name in _RATIOS)]
        cells += [_number(100 * drift, 1) for drift in drifts]
        remark = f"outside the tests: {'; '.join(row.remarks)}" if row.remarks else ""
        if row.status != "completed":
            remark = f"{row.status}: {row.error}"
        table.add_row(
            plain(row.specimen.name),
            plain(row.specimen.failure_mode or ""),
            *cells,
            _number(1e3 * row.seconds, 1),
            plain(remark.splitlines()[0] if remark else ""),
            style=_MARKS.get(row.status),
        )
    return table


@view_of(Predictions, "summary_table")
def summary_table(predictions: Predictions, by: str) -> Table:
    """Return a row for each group: median, and in gray the quartiles."""
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    table.add_column("Median and quartiles", no_wrap=True)
    for name in ("Tests", "Early end", "Failed", "NRMSE", "Peak", "Energy", "K", "End", "Time ms"):
        table.add_column(name, justify="right", no_wrap=True)
    for group in predictions.summary(by):
        q = group.quartiles
        cells = [_three(q["nrmse"], 3), *(_three(q[name], 2) for name in _RATIOS)]
        table.add_row(
            plain(group.name),
            *(str(count) if count else "-" for count in (group.tests, group.stopped, group.failed)),
            *cells,
            _three(group.seconds, 1, 1e3),
            style="bold" if group.name == "all" else None,
        )
    return table


@view_of(Checked, "table")
def doubts_table(checked: Checked) -> Table:
    """Return a row for each doubt, the sure ones first."""
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    for name in ("Test", "About", "", "Why", "For the second score"):
        table.add_column(name, no_wrap=name != "Why")
    for doubt in sorted(checked.doubts, key=lambda doubt: not doubt.sure):
        remedy = "set aside" if doubt.code is None else f"code {doubt.code}"
        table.add_row(
            plain(doubt.specimen.name),
            doubt.about,
            "sure" if doubt.sure else "hint",
            plain(doubt.why),
            remedy if doubt.sure else "-",
            style=None if doubt.sure else "dim",
        )
    return table


def _three(q: Quartiles, digits: int, unit: float = 1.0) -> str:
    median, lower, upper = (_number(unit * value, digits) for value in (q.median, q.lower, q.upper))
    return f"{median} [dim]{lower} {upper}[/dim]" if median != "-" else "-"


def _number(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if math.isfinite(value) else "-"
