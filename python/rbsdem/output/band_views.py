"""Predictions with their bands as tables."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from rbsdem._optional import need_rich, plain
from rbsdem._views import view_of
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.predictions import Predictions
from rbsdem.measured.records import band_record
from rbsdem.section.spread import Interval

if TYPE_CHECKING:
    from rich.table import Table

#: Numbers of a band: name of the column of the csv, title, unit, factor.
_NUMBERS = (
    ("peak_force_N", "Largest force", "kN", 1e-3),
    ("energy_J", "Work", "kJ", 1e-3),
    ("drift_at_loss", "Drift at 20 % loss", "%", 1e2),
)


@view_of(Prediction, "table")
def prediction_table(row: Prediction) -> Table:
    """Return numbers with intervals, then the nearest tests with their errors."""
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    table.add_column(plain(row.specimen.name), no_wrap=True)
    for name in ("Predicted", "80 % from", "to", "Test"):
        table.add_column(name, justify="right", no_wrap=True)
    if row.band is not None:
        record = band_record(row)
        for name, title, unit, factor in _NUMBERS:
            values = (record[name], record[f"{name}_lower"], record[f"{name}_upper"])
            cells = [_figure(factor * value) for value in (*values, record[f"{name}_test"])]
            table.add_row(f"{title} ({unit})", *cells)
        table.add_row("Width of the band over the peak", f"{row.band.width:.2f}", "", "", "")
    if row.comparison is not None:
        table.add_row("NRMSE", f"{row.nrmse:.3f}", "", "", "")
        if row.band is not None:
            table.add_row("Share of the test in the band", f"{row.points_within:.2f}", "", "", "")
    if row.nearest:
        table.add_section()
        table.add_row("[bold]Nearest tests[/]", "Distance", "NRMSE", "Peak", "Energy")
        for one in row.nearest:
            near = one.prediction
            scores = ("nrmse", "peak_ratio", "energy_ratio")
            cells = [_figure(near.score(name)) if near else "-" for name in scores]
            table.add_row(plain(one.specimen.name), f"{one.distance:.2f}", *cells)
    for remark in row.remarks:
        table.add_row(plain(f"Outside the tests: {remark}", style="yellow"))
    return table


@view_of(Predictions, "band_table")
def predictions_band_table(predictions: Predictions) -> Table:
    """Return a row for each test with a band."""
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    table.add_column("Test", no_wrap=True)
    titles = ("Within", "Width", "Peak kN\n80 %", "\ntest", "Work kJ\n80 %", "\ntest")
    for title in (*titles, "Loss %\n80 %", "\ntest", "Nearest\nNRMSE"):
        table.add_column(title, justify="right", no_wrap=True)
    table.add_column("", no_wrap=True, overflow="ellipsis", max_width=40)
    for row in predictions:
        if row.band is None:
            continue
        record = band_record(row)
        cells = [_figure(row.points_within), f"{row.band.width:.2f}"]
        for name, _, _, factor in _NUMBERS:
            low, high = (factor * record[f"{name}_{end}"] for end in ("lower", "upper"))
            test = factor * record[f"{name}_test"]
            # What a test did not come to is not marked.
            held = Interval(low, math.nan, high).holds(test) or math.isnan(test)
            cells += [f"{_figure(low)}–{_figure(high)}", _figure(test) + ("" if held else "*")]
        errors = [one.prediction.nrmse for one in row.nearest if one.prediction]
        cells.append(f"{np.median(errors):.3f}" if errors else "-")
        remark = f"outside: {'; '.join(row.remarks)}" if row.remarks else ""
        table.add_row(plain(row.specimen.name), *cells, plain(remark, style="yellow"))
    return table


def _figure(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.3g}" if math.isfinite(value) else "∞"
