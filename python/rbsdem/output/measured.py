"""Predicted tests: bands along the path, sheets of all tests, tables for the terminal."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._files import write_figure
from rbsdem._types import Axes
from rbsdem.measured.predictions import Prediction, Predictions, band_record
from rbsdem.measured.specimens import Specimen
from rbsdem.output.style import (
    MODEL_LINE,
    TEST_LINE,
    ZERO_LINE,
    AxesArray,
    Line,
    axes_or_new,
    line_of,
    new_axes,
    style,
)
from rbsdem.output.tables import table
from rbsdem.run.bands import Band

if TYPE_CHECKING:
    from rich.table import Table


Record = dict[str, Any]
_MEDIAN_LINE: Line = {"color": "0.45", "linestyle": ":", "linewidth": 0.8, "zorder": 2}

#: Sheets of bands: most cells beside each other, and their size [inches].
_BAND_COLUMNS = 8
_BAND_CELL = 2.4, 1.0

#: The same of sheets of loops; reach of a loop in its cell.
_COLUMNS = 14
_CELL = 1.15, 1.05
_REACH = np.array((0.46, 0.38))


def band(found: Band, *, test: Any = None, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw band, prediction and median along the path of displacement, and a test over them.

    Parameters
    ----------
    found : Band
        The prediction with its band.
    test : optional
        A measured test with the same rows.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the prediction's line.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    path = 1e3 * np.concatenate(([0.0], np.cumsum(np.abs(np.diff(found.displacement)))))
    measured = None if test is None else found.rows_of(test)
    with axes_or_new(ax, (6.0, 2.8)) as drawn:
        low, high = found.lower / 1e3, found.upper / 1e3
        drawn.fill_between(path, low, high, color="0.86", lw=0, label="80 % band")
        model = line_of(MODEL_LINE | {"label": "Prediction"}, line)
        drawn.plot(path, found.force / 1e3, **model)
        drawn.plot(path, found.median / 1e3, **_MEDIAN_LINE, label="Median of the samples")
        if measured is not None:
            drawn.plot(path, measured / 1e3, **TEST_LINE, label="Test")
        drawn.set(xlabel="Path of displacement (mm)", ylabel="Force (kN)")
        drawn.margins(x=0.01)
        # Above the axes: the band fills them.
        drawn.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)
        return drawn


def prediction(row: Prediction) -> AxesArray:
    """Draw loop and band of a prediction, and the test if there is one.

    Parameters
    ----------
    row : Prediction
        The prediction.

    Returns
    -------
    ndarray of matplotlib.axes.Axes
        The loop, and the band along the path.
    """
    with style():
        left, right = axes = new_axes(1, 2, (8.6, 3.4), width_ratios=(1.0, 1.7))
        test = row.comparison
        if row.band is not None:
            d, force = row.band.displacement, row.band.force
        elif test is not None:
            d, force = test.displacement, test.model_force
        else:
            raise ValueError(f"{row.specimen.name}: there is nothing to draw")
        left.axhline(0.0, **ZERO_LINE)
        left.axvline(0.0, **ZERO_LINE)
        if test is not None:
            left.plot(1e3 * test.displacement, 1e-3 * test.test_force, **TEST_LINE)
        left.plot(1e3 * d, 1e-3 * force, **MODEL_LINE)
        left.set(xlabel="Displacement (mm)", ylabel="Force (kN)")
        if row.band is not None:
            measured = None if test is None else test.test_force
            band(row.band, test=measured, ax=right)
        else:
            right.set_axis_off()
        s = row.specimen
        left.figure.suptitle(
            f"{s.name}: axial load ratio {s.axial_load_ratio:.2f}, "
            f"span over depth {s.span_depth_ratio:.2f}, "
            f"concrete {1e-6 * s.concrete_strength:.0f} MPa",
            fontsize="medium",
        )
    return axes


def band_sheet(predictions: Predictions, path: str | os.PathLike[str]) -> Path:
    """Write one picture with the bands of all tests along their paths, each in its own scale.

    Parameters
    ----------
    predictions : Predictions
        The tests.
    path : path
        File to write, by its ending as PNG, PDF or SVG.

    Returns
    -------
    Path
        The file.
    """
    from matplotlib.collections import LineCollection, PolyCollection  # noqa: PLC0415

    rows = [(row, row.band) for row in predictions if row.band is not None]
    columns = max(1, min(_BAND_COLUMNS, math.ceil(math.sqrt(0.5 * len(rows)))))
    with _sheet(path, len(rows), columns, _BAND_CELL, dpi=160) as ax:
        bands, models, tests = [], [], []
        for i, (row, found) in enumerate(rows):
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
    return Path(path)


@contextmanager
def _sheet(
    path: str | os.PathLike[str],
    cells: int,
    columns: int,
    cell: tuple[float, float],
    **options: Any,
) -> Iterator[Axes]:
    """Yield axes with a unit square for each cell, row by row downwards; then write the picture."""
    from matplotlib.figure import Figure  # noqa: PLC0415

    lines = max(1, math.ceil(cells / columns))
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with style():
        figure = Figure(figsize=(cell[0] * columns, cell[1] * lines))
        ax = figure.add_axes((0, 0, 1, 1))
        ax.set(xlim=(0, columns), ylim=(-lines, 0))
        ax.set_axis_off()
        yield ax
        write_figure(figure, path, **options)


def contact_sheet(predictions: Predictions, path: str | os.PathLike[str]) -> Path:
    """Write one picture with all loops, each in a cell of its own scale.

    One pair of axes and two collections of lines for all cells: a pair for each would take seconds.

    Parameters
    ----------
    predictions : Predictions
        The tests.
    path : path
        File to write, by its ending as PNG, PDF or SVG.

    Returns
    -------
    Path
        The file.
    """
    from matplotlib.collections import LineCollection  # noqa: PLC0415

    path = Path(path)
    rows = [
        (row, drawn)
        for row, drawn in zip(predictions, predictions.pictures, strict=True)
        if drawn is not None
    ]
    columns = max(1, min(_COLUMNS, math.ceil(math.sqrt(1.5 * len(rows)))))
    # Of many thin lines a png hardly gets smaller by trying hard.
    fast = {"pil_kwargs": {"compress_level": 3}} if path.suffix.lower() == ".png" else {}
    with _sheet(path, len(rows), columns, _CELL, dpi=200, **fast) as ax:
        zeros, tests, models = [], [], []
        for i, (row, drawn) in enumerate(rows):
            x, y = i % columns + 0.5, -(i // columns) - 0.56
            zeros += [[(x - 0.46, y), (x + 0.46, y)], [(x, y - 0.38), (x, y + 0.38)]]
            tests.append(_REACH * drawn.test + (x, y))
            if len(drawn.model) > 1:
                models.append(_REACH * drawn.model + (x, y))
            ax.text(x - 0.47, y + 0.4, _short(row.specimen), fontsize=4.6, va="bottom")
            ax.text(x + 0.47, y - 0.41, f"{row.nrmse:.3f}", fontsize=5.0, ha="right", va="bottom")
        ax.add_collection(LineCollection(zeros, colors="0.8", linewidths=0.3))
        ax.add_collection(LineCollection(tests, colors="0.6", linewidths=0.5))
        ax.add_collection(LineCollection(models, colors="#c2410c", linewidths=0.4))
    return path


def _short(specimen: Specimen) -> str:
    """Return a name that fits into a cell: series and what the test is called in it."""
    label = specimen.name
    if specimen.year and specimen.year in label:
        label = label.split(specimen.year, 1)[1].strip(" ,")
        label = f"{specimen.series}, {label}"
    return label if len(label) <= 27 else f"{label[:26]}…"


_STYLES = {"stopped": "yellow", "failed": "red", "no history": "dim"}
_RATIOS = {
    "Peak": "peak_ratio",
    "Energy": "energy_ratio",
    "K": "stiffness_ratio",
    "End": "end_ratio",
}
#: Numbers of a band: name in its csv, title, factor to the unit on paper.
_NUMBERS = (
    ("peak_force_N", "Largest force, kN", 1e-3),
    ("energy_J", "Work, kJ", 1e-3),
    ("drift_at_loss", "Drift at 20 % loss, %", 1e2),
)


def tests_table(predictions: Predictions) -> Table:
    """Return a row for each test: scores, drifts at 20 % loss of strength, remarks."""
    rows = []
    for row in predictions:
        remark = f"outside the tests: {'; '.join(row.remarks)}" if row.remarks else ""
        if row.status != "completed":
            remark = f"{row.status}: {row.error}"
        ratios = {title: row.score(name) for title, name in _RATIOS.items()}
        lost = {name: row.score(name) for name in ("test_drift_at_loss", "model_drift_at_loss")}
        shown: Record = {"Test": row.specimen.name, "Failure": row.specimen.failure_mode or ""}
        shown |= {"NRMSE": row.nrmse, **ratios, **lost, "Time, ms": 1e3 * row.seconds, "": remark}
        rows.append(shown)
    return _table(rows, styles=[_STYLES.get(row.status) for row in predictions])


def summary_table(predictions: Predictions, by: str) -> Table:
    """Return a row for each group: medians, quartiles in brackets."""
    groups = predictions.summary(by)
    rows = [
        {
            "Median (quartiles)": name,
            "Tests": int(group["tests"]),
            "Early end": int(group["stopped"]),
            "Failed": int(group["failed"]),
            "NRMSE": _three(group, "nrmse", 3),
            **{title: _three(group, score, 2) for title, score in _RATIOS.items()},
            "Time, ms": _three(group, "seconds", 1, 1e3),
        }
        for name, group in groups.iterrows()
    ]
    return _table(rows, styles=["bold" if name == "all" else None for name in groups.index])


def bands_table(predictions: Predictions) -> Table:
    """Return a row for each test with a band; an asterisk where the test is outside of it."""
    rows = []
    for row in predictions:
        if row.band is None:
            continue
        record = band_record(row)
        shown: Record = {"Test": row.specimen.name, "Within": row.points_within}
        shown["Width"] = row.band.width
        for name, title, factor in _NUMBERS:
            low, high, test = (factor * record[f"{name}_{end}"] for end in _ENDS)
            # What a test did not come to is not marked.
            outside = not (math.isnan(test) or low <= test <= high)
            shown[title] = f"{_figure(low)}–{_figure(high)}"
            shown[f"test{' ' * len(shown)}"] = _figure(test) + "*" * outside
        errors = [one.prediction.nrmse for one in row.nearest if one.prediction]
        shown["Nearest NRMSE"] = np.median(errors) if errors else math.nan
        shown[""] = f"outside: {'; '.join(row.remarks)}" if row.remarks else ""
        rows.append(shown)
    return _table(rows)


def numbers_table(row: Prediction) -> Table:
    """Return the numbers of a prediction with their intervals, then the nearest tests."""
    name = row.specimen.name
    rows: list[Record] = []
    if row.band is not None:
        record = band_record(row)
        for number, title, factor in _NUMBERS:
            low, high, test = (factor * record[f"{number}_{end}"] for end in _ENDS)
            value = factor * record[number]
            rows.append(
                {name: title, "Predicted": value, "80 % from": low, "to": high} | {"Test": test}
            )
        rows.append({name: "Width of the band over the peak", "Predicted": row.band.width})
    if row.comparison is not None:
        rows.append({name: "NRMSE", "Predicted": row.nrmse})
        if row.band is not None:
            rows.append({name: "Share of the test in the band", "Predicted": row.points_within})
    if row.nearest:
        rows.append({name: "Nearest tests"})
    for one in row.nearest:
        near = one.prediction
        scores = (near.score("nrmse"), near.score("peak_ratio")) if near else (math.nan, math.nan)
        text = f"{one.specimen.name}, distance {one.distance:.2f}"
        text += f" (NRMSE {_figure(scores[0])}, peak {_figure(scores[1])})"
        rows.append({name: text})
    rows += [{name: f"Outside the tests: {remark}"} for remark in row.remarks]
    return _table(rows)


_ENDS = ("lower", "upper", "test")


def _table(rows: list[Record], **options: Any) -> Table:
    import pandas  # noqa: PLC0415

    return table(pandas.DataFrame(rows), **options)


def _three(group: Any, name: str, digits: int, unit: float = 1.0) -> str:
    values = [unit * group[f"{name}_{end}"] for end in ("median", "lower", "upper")]
    if not math.isfinite(values[0]):
        return "-"
    median, low, high = (f"{value:.{digits}f}" for value in values)
    return f"{median} ({low} {high})"


def _figure(value: float) -> str:
    if math.isnan(value):
        return "-"
    return f"{value:.3g}" if math.isfinite(value) else "∞"
