"""What a study of methods found: its rows, reference, choice and effects of parts of the model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from rbsdem.methods.physics import Physics
from rbsdem.methods.reference import Reference
from rbsdem.methods.rows import Choice, Row, cheapest

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class MethodStudy:
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

    def to_frame(self) -> pd.DataFrame:
        """Return a DataFrame with a row for each setting: its cost, its errors, the front."""
        import pandas  # noqa: PLC0415

        rows = [
            {
                "method": row.setting.method,
                "events": row.setting.events or "",
                "kinematics": row.setting.kinematics,
                "dt_s": row.setting.dt,
                "tolerance": row.setting.tolerance,
                "parts": row.setting.parts,
                "wall_time_s": row.seconds,
                "repeats": row.repeats,
                "response_rms": row.response_rms,
                "response_max": row.response_max,
                "base_moment_rms": row.moment,
                "energy": row.energy,
                "peak": row.peak,
                "error": row.error,
                "move_to_finer": row.move,
                "pareto": int(row.pareto),
                "status": row.status,
                "reason": row.reason,
            }
            for row in self.rows
        ]
        return pandas.DataFrame(rows).astype({"parts": "Int64"})
