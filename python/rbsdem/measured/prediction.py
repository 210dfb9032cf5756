"""A predicted test: its scores, its band, and the tests that are most like it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rbsdem.curves.scores import Comparison
from rbsdem.measured.specimen import Specimen

if TYPE_CHECKING:
    from rbsdem.section.spread import Spread

__all__ = ["Neighbour", "Prediction"]


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A test that is like another.

    Attributes
    ----------
    specimen : Specimen
        The test.
    distance : float
        0 for the same column; 1 is a difference of 0.15 in the axial load ratio, or of 40 % in the
        shear span or in the mechanical ratio of the bars.
    prediction : Prediction or None
        Its prediction, with its errors; None if it was not predicted.
    """

    specimen: Specimen
    distance: float
    prediction: Prediction | None = None


@dataclass(frozen=True, slots=True)
class Prediction:
    """One test with the scores of its prediction.

    Attributes
    ----------
    specimen : Specimen
        The test.
    model : str
        Name of the model with the version of its parameters, as "layered 2026.2".
    status : str
        "completed", "stopped" (the analysis ended before the test did), "failed" (there is no
        analysis), or "no history" (there is nothing to compare with; not counted).
    error : str
        Text of the exception.
    note : str
        Warnings.
    seconds_model : float
        Wall time for building the column [s].
    seconds_analysis : float
        Wall time of the analysis [s].
    comparison : Comparison or None
        Scores; None without a history, along another path than that of the test, or where the
        process died. A test that failed has an nrmse of 1.
    band : Spread or None
        The prediction with its 80 % band and intervals; None unless bands were asked for.
    nearest : tuple of Neighbour
        The tests that are most like it, with the errors of their predictions; with bands only.
    remarks : tuple of str
        Where the column is outside the range of the tests that the model was fitted to.
    limit_states : dict of str to float, or None
        Drifts at which limit states are reached, in the order in which they are, by the names of
        `rbsdem.checks.LimitState`; None unless they were asked for and there is an analysis.
    """

    specimen: Specimen
    model: str
    status: str
    error: str = ""
    note: str = ""
    seconds_model: float = 0.0
    seconds_analysis: float = 0.0
    comparison: Comparison | None = None
    band: Spread | None = None
    nearest: tuple[Neighbour, ...] = ()
    remarks: tuple[str, ...] = ()
    limit_states: dict[str, float] | None = None

    @property
    def seconds(self) -> float:
        """Wall time for the column and its analysis [s]."""
        return self.seconds_model + self.seconds_analysis

    @property
    def nrmse(self) -> float:
        """The error, as in `Comparison`; NaN without a history."""
        return self.score("nrmse")

    def score(self, name: str) -> float:
        """Return a score of `Comparison` by name; NaN without a history.

        Parameters
        ----------
        name : str
            One of `rbsdem.curves.SCORES`, "test_drift_at_loss" or "model_drift_at_loss".
        """
        if self.comparison is not None:
            return float(getattr(self.comparison, name))
        return 1.0 if name == "nrmse" and self.status == "failed" else math.nan

    @property
    def points_within(self) -> float:
        """Share of the test that lies within the band; NaN without one of both."""
        if self.band is None or self.comparison is None:
            return math.nan
        return self.band.holds(self.comparison.test_force)
