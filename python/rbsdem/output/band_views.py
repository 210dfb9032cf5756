"""Predictions with their bands as tables and figures."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rbsdem import plot
from rbsdem._files import write_figure
from rbsdem._optional import need_matplotlib, need_rich, plain
from rbsdem._views import view_of
from rbsdem.measured.nearest import properties
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.predictions import Predictions
from rbsdem.measured.records import band_record
from rbsdem.section.spread import Interval

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from rich.table import Table

__all__ = ["draw_prediction", "prediction_table", "predictions_band_table", "write_band_sheet"]

#: Cells of the sheet: most beside each other, and their size [inches].
_COLUMNS = 8
_CELL = 2.4, 1.0

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


@view_of(Prediction, "plot")
def draw_prediction(row: Prediction) -> Figure:
    """Draw the loop, and the band along the path."""
    need_matplotlib()
    from matplotlib.figure import Figure  # noqa: PLC0415

    with plot.style():
        figure = Figure(figsize=(8.6, 3.4), layout="constrained")
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.7))
        test = row.comparison
        if row.band is not None:
            d, force = row.band.displacement, row.band.force
        elif test is not None:
            d, force = test.displacement, test.model_force
        else:
            raise ValueError(f"{row.specimen.name}: there is nothing to draw")
        left.axhline(0.0, **plot.ZERO_LINE)
        left.axvline(0.0, **plot.ZERO_LINE)
        if test is not None:
            left.plot(1e3 * test.displacement, 1e-3 * test.test_force, **plot.TEST_LINE)
        left.plot(1e3 * d, 1e-3 * force, **plot.MODEL_LINE)
        left.set(xlabel="Displacement (mm)", ylabel="Force (kN)")
        if row.band is not None:
            row.band.plot(None if test is None else test.test_force, ax=right)
        else:
            right.set_axis_off()
        numbers = properties(row.specimen)
        figure.suptitle(
            f"{row.specimen.name}: axial load ratio {numbers['axial_load_ratio']:.2f}, "
            f"span over depth {numbers['span_depth_ratio']:.2f}, "
            f"concrete {1e-6 * numbers['concrete_strength']:.0f} MPa",
            fontsize="medium",
        )
    return figure


@view_of(Predictions, "band_sheet")
def write_band_sheet(predictions: Predictions, path: Path) -> Path:
    """Write one picture with the bands of all tests along their paths, each in its own scale."""
    need_matplotlib()
    from matplotlib.collections import LineCollection, PolyCollection  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    rows = [row for row in predictions if row.band is not None]
    columns = max(1, min(_COLUMNS, math.ceil(math.sqrt(0.5 * len(rows)))))
    lines = max(1, math.ceil(len(rows) / columns))
    with plot.style():
        figure = Figure(figsize=(_CELL[0] * columns, _CELL[1] * lines))
        ax = figure.add_axes((0, 0, 1, 1))
        ax.set(xlim=(0, columns), ylim=(-lines, 0))
        ax.set_axis_off()
        bands, models, tests = [], [], []
        for i, row in enumerate(rows):
            found = row.band
            assert found is not None
            measured = None if row.comparison is None else row.comparison.test_force
            curves = [found.lower, found.upper, found.force]
            curves += [] if measured is None else [measured]
            most = max(float(np.max(np.abs(curve))) for curve in curves) or 1.0
            way = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(found.displacement)))))
            x = i % columns + 0.02 + 0.96 * way / way[-1]
            low, high, model, *test = (
                np.column_stack((x, -(i // columns) - 0.56 + 0.38 * curve / most))
                for curve in curves
            )
            bands.append(np.concatenate((low, high[::-1])))
            models.append(model)
            tests += test
            share = "" if measured is None else f", {row.points_within:.2f} within"
            label = f"{row.specimen.name[:42]}{share}"
            ax.text(x[0], -(i // columns) - 0.15, label, fontsize=5.0, va="bottom")
        ax.add_collection(PolyCollection(bands, facecolors="0.86", edgecolors="none"))
        ax.add_collection(LineCollection(tests, colors="0.45", linewidths=0.4))
        ax.add_collection(LineCollection(models, colors="#c2410c", linewidths=0.4))
        path.parent.mkdir(parents=True, exist_ok=True)
        write_figure(figure.savefig, path, dpi=160)
    return path


def _figure(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.3g}" if math.isfinite(value) else "∞"
