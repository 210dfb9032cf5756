"""The result of a calibration: the fitted column, its parameters and how well they are known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rbsdem import _views
from rbsdem._arguments import Array
from rbsdem.curves.scores import Comparison
from rbsdem.model.column import Column

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table

__all__ = ["Calibration", "Fitted"]


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


@dataclass(frozen=True, eq=False)
class Calibration:
    """A column fitted to a test.

    Attributes
    ----------
    column, start : Column
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

    column: Column
    start: Column
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
        return _views.view(self, "report")

    def table(self) -> Table:
        """Return the parameters as a table of rich."""
        return _views.view(self, "table")

    def plot(self, axes: Sequence[Axes] | None = None, **line: Any) -> Sequence[Axes]:
        """Draw the loops before and after the fit over the test.

        Parameters
        ----------
        axes : sequence of two matplotlib Axes, optional
            Where to draw; by default a new figure is made.
        **line
            Properties of the model's line, as for ``Axes.plot``.

        Returns
        -------
        sequence of two matplotlib Axes
            Before and after.

        Raises
        ------
        ImportError
            If matplotlib is not installed.
        """
        return _views.view(self, "plot", axes, **line)
