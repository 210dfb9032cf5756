"""Predicted tests: loops, bands along the path, tables for the terminal."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem._files import data_frame
from rbsdem._types import Axes, DataFrame
from rbsdem.measured.predict import Prediction
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
from rbsdem.output.units import factor, labelled
from rbsdem.run.bands import Band

if TYPE_CHECKING:
    from rich.table import Table


Record = dict[str, Any]
_MEDIAN_LINE: Line = {"color": "0.45", "linestyle": ":", "linewidth": 0.8, "zorder": 2}


def band(interval: Band, *, test: Any = None, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw band, prediction and median along the path of displacement, and a test over them.

    Parameters
    ----------
    interval : Band
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
    path = factor("m") * np.concatenate(([0.0], np.cumsum(np.abs(np.diff(interval.displacement)))))
    measured = None if test is None else interval.rows_of(test)
    with axes_or_new(ax, (6.0, 2.8)) as drawn:
        low, high = factor("N") * interval.lower, factor("N") * interval.upper
        drawn.fill_between(path, low, high, color="0.86", lw=0, label="80 % band")
        model = line_of(MODEL_LINE | {"label": "Prediction"}, line)
        drawn.plot(path, factor("N") * interval.force, **model)
        drawn.plot(
            path, factor("N") * interval.median, **_MEDIAN_LINE, label="Median of the samples"
        )
        if measured is not None:
            drawn.plot(path, factor("N") * measured, **TEST_LINE, label="Test")
        drawn.set(xlabel=labelled("Path of displacement", "m"), ylabel=labelled("Force", "N"))
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
        left.axhline(0.0, **ZERO_LINE)
        left.axvline(0.0, **ZERO_LINE)
        if test is not None:
            left.plot(factor("m") * test.displacement, factor("N") * test.test_force, **TEST_LINE)
        left.plot(factor("m") * row.displacement, factor("N") * row.force, **MODEL_LINE)
        left.set(xlabel=labelled("Displacement", "m"), ylabel=labelled("Force", "N"))
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


_RATIOS = {
    "Peak": "peak_ratio",
    "Energy": "energy_ratio",
    "K": "stiffness_ratio",
    "End": "end_ratio",
}
#: Quantities with an interval: title, factor to the unit on paper.
_QUANTITIES = {
    "peak_force": ("Largest force, kN", 1e-3),
    "energy": ("Work, kJ", 1e-3),
    "drift_at_loss": ("Drift at 20 % loss, %", 1e2),
}


def tests_table(rows: Iterable[Prediction]) -> Table:
    """Return a row for each test: scores, share within the band, remarks."""
    shown: list[Record] = []
    for row in rows:
        remark = f"outside the tests: {'; '.join(row.warnings)}" if row.warnings else ""
        if row.status != "completed":
            remark = f"{row.status}: {row.error}"
        line: Record = {"Test": row.specimen.name, "Failure": row.specimen.failure_mode or ""}
        line |= {"NRMSE": row.score("nrmse")}
        line |= {title: row.score(name) for title, name in _RATIOS.items()}
        if row.band is not None:
            line |= {"Within": row.points_within, "Width": row.band.width}
        shown.append(line | {"": remark})
    return table(data_frame(shown))


def summary_table(groups: DataFrame) -> Table:
    """Return a row for each group of `score_summary`: medians, quartiles in brackets."""
    rows = [
        {
            "Median (quartiles)": name,
            "Tests": int(group["tests"]),
            "Early end": int(group["stopped"]),
            "Failed": int(group["failed"]),
            "NRMSE": _three(group, "nrmse", 3),
            **{title: _three(group, score, 2) for title, score in _RATIOS.items()},
        }
        for name, group in groups.iterrows()
    ]
    return table(data_frame(rows), styles=["bold" if n == "all" else None for n in groups.index])


def numbers_table(row: Prediction) -> Table:
    """Return the numbers of a prediction with their intervals, then the nearest tests."""
    name = row.specimen.name
    rows: list[Record] = []
    if row.band is not None:
        for quantity, interval in row.intervals().iterrows():
            title, factor = _QUANTITIES[str(quantity)]
            low, value, high, test = (factor * number for number in interval)
            ends = {"Predicted": value, "80 % from": low, "to": high, "Test": test}
            rows.append({name: title} | ends)
        rows.append({name: "Width of the band over the peak", "Predicted": row.band.width})
    if row.comparison is not None:
        rows.append({name: "NRMSE", "Predicted": row.score("nrmse")})
        if row.band is not None:
            rows.append({name: "Share of the test in the band", "Predicted": row.points_within})
    if row.nearest:
        rows.append({name: "Nearest tests"})
    for neighbour in row.nearest:
        text = f"{neighbour.specimen.name}, distance {neighbour.distance:.2f}"
        if neighbour.prediction is not None:
            nrmse, peak = (neighbour.prediction.score(score) for score in ("nrmse", "peak_ratio"))
            text += f" (NRMSE {nrmse:.3g}, peak {peak:.3g})"
        rows.append({name: text})
    rows += [{name: f"Outside the tests: {remark}"} for remark in row.warnings]
    return table(data_frame(rows))


def _three(group: Any, name: str, digits: int) -> str:
    """Return the median of a score with its quartiles in brackets."""
    values = [group[f"{name}_{end}"] for end in ("median", "lower", "upper")]
    if not math.isfinite(values[0]):
        return "-"
    median, low, high = (f"{value:.{digits}f}" for value in values)
    return f"{median} ({low} {high})"
