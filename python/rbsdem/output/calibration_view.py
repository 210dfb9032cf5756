"""A calibration as report, table and figure."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import plot
from rbsdem._optional import need_rich
from rbsdem._views import view_of
from rbsdem.calibration.outcome import Calibration, Fitted
from rbsdem.errors import InputError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table

    from rbsdem.curves.scores import Comparison

_HEAD = ("", "Unit", "Start", "Low", "High", "Fitted", "Std. error", "Effect", "Rise", "At")

#: Columns of the table for the terminal: all but the bounds.
_NARROW = (0, 1, 2, 5, 6, 7, 8, 9)


@view_of(Calibration, "report")
def report(fit: Calibration) -> str:
    """Return the fit as plain text."""
    rows = [_HEAD, *(_cells(fitted) for fitted in fit.parameters)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_HEAD))]
    lines = [
        f"Fit to {fit.after.name}",
        *(
            f"{name.replace('_', ' '):16s}{_score(fit.before, name)} before"
            f"{_score(fit.after, name)} after"
            for name in ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio")
        ),
        f"{fit.status}: {fit.evaluations} analyses in {fit.seconds:.2f} s"
        + (f", {fit.failed} of them not to the end" if fit.failed else ""),
        "",
    ]
    for row in rows:
        first = row[0].ljust(widths[0]) + "  " + row[1].ljust(widths[1])
        rest = (cell.rjust(width) for cell, width in zip(row[2:], widths[2:], strict=True))
        lines.append(f"{first}  {'  '.join(rest)}".rstrip())
    lines += [
        "",
        "Effect: rms change of the force over the peak, if the parameter changes by 10 % (of",
    ]
    lines += ["the distance between its bounds, if it may be 0). Rise: growth of the loss by that."]
    if len(fit.parameters) > 1:
        lines += ["", "Correlation", *_correlation(fit)]
    if fit.warnings:
        lines += ["", *(f"Warning: {line}" for line in fit.warnings)]
    return "\n".join(lines)


@view_of(Calibration, "table")
def table(fit: Calibration) -> Table:
    """Return the parameters as a table of rich."""
    rich = need_rich()
    found = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False)
    for i in _NARROW:
        found.add_column(_HEAD[i], justify="left" if i < 2 else "right", no_wrap=True)
    for fitted in fit.parameters:
        cells = _cells(fitted, 3)
        found.add_row(*(cells[i] for i in _NARROW), style="bold" if fitted.at_bound else None)
    return found


@view_of(Calibration, "plot")
def draw(fit: Calibration, axes: Sequence[Axes] | None = None, **line: Any) -> Sequence[Axes]:
    """Draw the loops before and after over the test, to the same scale."""
    if axes is None:
        axes = plot.new_axes(1, 2, (6.9, 3.2))
    if len(axes) != 2:
        raise InputError(f"calibration: plot: {len(axes)} axes; give two, for before and after")
    for ax, name, scores in zip(axes, "ab", (fit.before, fit.after), strict=True):
        when = "before" if name == "a" else "after"
        plot.loops_over_test(
            (scores.displacement, scores.model_force),
            (scores.displacement, scores.test_force),
            title=f"({name}) {when}: NRMSE {scores.nrmse:.3f}",
            height=scores.height if scores.height > 0 else None,
            ax=ax,
            **line,
        )
    highest = max(ax.get_ylim()[1] for ax in axes)
    for ax in axes:
        ax.set_ylim(-highest, highest)
    return axes


def _score(scores: Comparison, name: str) -> str:
    value = getattr(scores, name)
    return f"{'-' if math.isnan(value) else f'{value:.4f}':>8}"


def _cells(fitted: Fitted, digits: int = 4) -> tuple[str, ...]:
    numbers = (fitted.start, fitted.low, fitted.high, fitted.value, fitted.standard_error)
    return (
        fitted.name,
        fitted.unit or "-",
        *(f"{number:.{digits}g}" for number in numbers[:4]),
        "-" if math.isnan(numbers[4]) else f"{numbers[4]:.2g}",
        f"{fitted.effect:.4f}",
        "-" if math.isnan(fitted.rise) else f"{fitted.rise:+.4f}",
        fitted.at_bound,
    )


def _correlation(fit: Calibration) -> list[str]:
    names = [fitted.name for fitted in fit.parameters]
    width = max(len(name) for name in names)
    lines = []
    for i, name in enumerate(names):
        row = (f"{r:+.2f}" if np.isfinite(r) else "  -  " for r in fit.correlation[i, : i + 1])
        lines.append(f"{name.ljust(width)}  {'  '.join(row)}")
    return lines
