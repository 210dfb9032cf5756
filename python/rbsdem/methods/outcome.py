"""What a trade found: the rows, the reference, the choice and the effects of parts of the model."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from rbsdem import _views
from rbsdem.methods.physics import Physics
from rbsdem.methods.reference import Reference
from rbsdem.methods.rows import Choice, Row, cheapest

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table


@dataclass(frozen=True)
class Trade:
    """Wall time against accuracy in one case.

    Attributes
    ----------
    rows : tuple of Row
        All settings, families together, coarse ones first.
    reference : Reference or None
        The solution that errors are measured against; None if there is none, as `notes` says.
    choice : Choice or None
        The cheapest setting that meets the user's tolerance, if one was given.
    physics : Physics or None
        The change of the answer by each part of the model.
    response : str
        Kind of response: "displacement" or "force".
    seconds, budget : float
        Wall time used and wall time allowed [s].
    notes : tuple of str
        Further remarks.
    """

    rows: tuple[Row, ...]
    reference: Reference | None
    choice: Choice | None
    physics: Physics | None
    response: str
    seconds: float
    budget: float
    notes: tuple[str, ...] = ()

    def cheapest(self, tolerance: float) -> Row | None:
        """Return the cheapest setting whose error is within a tolerance, or None.

        All finer settings of its family must be within it too, so that a setting which is accurate
        by chance is not taken.
        """
        return cheapest(self.rows, tolerance)

    def table(self) -> Table:
        """Return the settings as a table of rich, with the Pareto front marked."""
        return _views.view(self, "table")

    def physics_table(self) -> Table:
        """Return the effects of the parts of the model as a table of rich."""
        return _views.view(self, "physics_table")

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the settings as csv."""
        _views.view(self, "to_csv", path)

    def physics_to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the effects of the parts of the model as csv."""
        _views.view(self, "physics_to_csv", path)

    def plot(self, ax: Axes | None = None, **line: Any) -> Axes:
        """Draw error against wall time, both logarithmic, the Pareto front marked.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.
        **line
            Properties of the lines, as for ``Axes.plot``.

        Raises
        ------
        InputError
            If there is nothing to draw.
        ImportError
            If matplotlib is not installed.
        """
        return _views.view(self, "plot", ax, **line)
