"""Predictions as tables for the terminal."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem.measured.predictions import Prediction, Predictions, band_record
from rbsdem.output.tables import table

if TYPE_CHECKING:
    from rich.table import Table


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
        rows.append(
            {
                "Test": row.specimen.name,
                "Failure": row.specimen.failure_mode or "",
                "NRMSE": row.nrmse,
                **{title: row.score(name) for title, name in _RATIOS.items()},
                "test_drift_at_loss": row.score("test_drift_at_loss"),
                "model_drift_at_loss": row.score("model_drift_at_loss"),
                "Time, ms": 1e3 * row.seconds,
                "": remark,
            }
        )
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
        shown: dict[str, Any] = {
            "Test": row.specimen.name,
            "Within": row.points_within,
            "Width": row.band.width,
        }
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
    rows: list[dict[str, Any]] = []
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


def _table(rows: list[dict[str, Any]], **options: Any) -> Table:
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
