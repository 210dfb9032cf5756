"""The result of a calibration: the fitted column, its parameters and how well they are known."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass
from typing import Generic, TypeVar

import numpy as np

from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame
from rbsdem.curves.scores import Comparison
from rbsdem.model.frame import Structure

_HEAD = ("", "Unit", "Start", "Low", "High", "Fitted", "Std. error", "Effect", "Rise", "At")


_LEGEND = (
    "Effect: rms change of the force over the peak, if the parameter changes by 10 % (of",
    "the distance between its bounds, if it may be 0). Rise: growth of the loss by that.",
)


@dataclass(frozen=True, slots=True)
class Fitted:
    """One parameter after a calibration.

    Attributes
    ----------
    name, unit, what : str
        Name, unit and meaning.
    start, low, high, value : float
        Initial value, bounds, and fitted value [unit].
    standard_error : float
        Standard error of the value [unit], from the scatter between half cycles; infinite if no
        force of the test changes with the parameter, NaN if there are too few half cycles.
    effect : float
        Root mean square change of the force over the measured peak, if the parameter alone changes
        by 10 % (of the distance between its bounds, if it may be 0 or negative).
    rise : float
        Increase of the loss by that change; NaN if such a column is refused.
    at_bound : str
        "low" or "high" if the fit ended at that bound, otherwise "".
    """

    name: str
    unit: str
    what: str
    start: float
    low: float
    high: float
    value: float
    standard_error: float
    effect: float
    rise: float
    at_bound: str


#: A fit has the type of the structure that it was made for.
AnyStructure = TypeVar("AnyStructure", bound=Structure)


@dataclass(frozen=True, repr=False, eq=False)
class Calibration(Tabular, Generic[AnyStructure]):
    """A column fitted to a test.

    Attributes
    ----------
    column, start : Column or Frame
        The fitted column and the initial one.
    parameters : tuple of Fitted
        The parameters that were free.
    before, after : Comparison
        Scores of the two columns against the test.
    correlation : ndarray, shape (p, p)
        Correlation of the estimates.
    status : str
        "converged", "evaluations used up", "time used up" or "interrupted".
    warnings : tuple of str
        What the test does not determine.
    loss, seed : str, int
        The loss that was minimised, and the seed of the search.
    evaluations, failed, refused : int
        Number of analyses, of those that did not reach the end of the test, and of columns that
        were refused (K_y above K_c) and cost no analysis.
    seconds : float
        Wall time [s].
    """

    column: AnyStructure
    start: AnyStructure
    parameters: tuple[Fitted, ...]
    before: Comparison
    after: Comparison
    correlation: Array
    status: str
    warnings: tuple[str, ...]
    loss: str
    seed: int
    evaluations: int
    failed: int
    refused: int
    seconds: float

    @property
    def nrmse(self) -> float:
        """Root mean square error of the force over the measured peak, after the fit."""
        return self.after.nrmse

    @property
    def values(self) -> dict[str, float]:
        """The fitted values by name."""
        return {fitted.name: fitted.value for fitted in self.parameters}

    @property
    def report(self) -> str:
        """The fit as plain text."""
        rows = [_HEAD, *(_cells(fitted) for fitted in self.parameters)]
        widths = [max(len(row[i]) for row in rows) for i in range(len(_HEAD))]
        lines = [
            f"Fit to {self.after.name}",
            *(
                f"{name.replace('_', ' '):16s}{_score(self.before, name)} before"
                f"{_score(self.after, name)} after"
                for name in ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio")
            ),
            f"{self.status}: {self.evaluations} analyses in {self.seconds:.2f} s"
            + (f", {self.failed} of them not to the end" if self.failed else ""),
            "",
        ]
        for row in rows:
            first = row[0].ljust(widths[0]) + "  " + row[1].ljust(widths[1])
            rest = (cell.rjust(width) for cell, width in zip(row[2:], widths[2:], strict=True))
            lines.append(f"{first}  {'  '.join(rest)}".rstrip())
        lines += ["", *_LEGEND]
        if len(self.parameters) > 1:
            lines += ["", "Correlation", *self._correlations()]
        if self.warnings:
            lines += ["", *(f"Warning: {line}" for line in self.warnings)]
        return "\n".join(lines)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame with a row for each parameter: the attributes of `Fitted`."""
        frame = data_frame([asdict(fitted) for fitted in self.parameters])
        return frame.rename(columns={"unit": "unit_of_values"})

    def _correlations(self) -> list[str]:
        names = [fitted.name for fitted in self.parameters]
        width = max(len(name) for name in names)
        lines = []
        for i, name in enumerate(names):
            row = (f"{r:+.2f}" if np.isfinite(r) else "  -  " for r in self.correlation[i, : i + 1])
            lines.append(f"{name.ljust(width)}  {'  '.join(row)}")
        return lines


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
