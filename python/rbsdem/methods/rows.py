"""The rows of a study of methods: settings with cost and errors, the front, the choice."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rbsdem.methods.answer import Run, Setting
from rbsdem.methods.physics import Physics
from rbsdem.methods.reference import Reference
from rbsdem.results.accuracy import Errors, errors_of
from rbsdem.solve.solver import IMPLICIT

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class Row:
    """A setting with its cost and its errors.

    Attributes
    ----------
    setting : Setting
        Method, kinematics, step or tolerance, events.
    seconds : float
        Median wall time of `repeats` runs [s]; nan if there is no answer.
    repeats : int
        Number of runs.
    response_rms, response_max : float
        Root mean square and largest difference of the top displacement (lateral force, if the
        displacement is driven) from the reference over its peak, at the times of the loading.
    moment : float
        Root mean square difference of the base moment over its peak.
    energy : float
        Difference of the energy that springs and damping have taken by the end, over its largest
        value.
    peak : float
        Relative difference of the peak response.
    error : float
        The largest of response_rms, moment, energy and peak.
    move : float
        `error` of this setting against the next finer one of its family, which a user without a
        reference would see; nan if there is no finer one.
    status : str
        "completed", "collapsed", "failed", "refused" or "skipped".
    reason : str
        Why there is no answer; the choice of method "auto" if there is one.
    pareto : bool
        Whether no other setting is both faster and more accurate.
    """

    setting: Setting
    seconds: float = math.nan
    repeats: int = 0
    response_rms: float = math.nan
    response_max: float = math.nan
    moment: float = math.nan
    energy: float = math.nan
    peak: float = math.nan
    error: float = math.nan
    move: float = math.nan
    status: str = "completed"
    reason: str = ""
    pareto: bool = False


@dataclass(frozen=True)
class Choice:
    """The cheapest setting for a tolerance.

    Attributes
    ----------
    tolerance : float
        The error allowed.
    row : Row or None
        The cheapest setting within it, all finer ones of its family within it too; None if there
        is no such setting.
    finer : Row or None
        The next finer setting of its family.
    move : Errors or None
        The difference of the answers of the two.
    """

    tolerance: float
    row: Row | None
    finer: Row | None = None
    move: Errors | None = None

    def __str__(self) -> str:
        wanted = f"tolerance {self.tolerance:g}"
        if self.row is None:
            return f"{wanted}: no setting meets it"
        text = (
            f"{wanted}: {self.row.setting} costs {seconds_text(self.row.seconds)} and errs by "
            f"{self.row.error:.1e}"
        )
        if self.move is None:
            return f"{text}; no finer one was run"
        return (
            f"{text}; the next finer one ({self.finer.setting.value}, "
            f"{seconds_text(self.finer.seconds)}) moves the answer by {self.move.largest:.1e}"
        )


def seconds_text(seconds: float) -> str:
    """Return a time with its unit, two digits."""
    if not math.isfinite(seconds):
        return "-"
    scale, unit = next(
        ((scale, unit) for scale, unit in ((1.0, "s"), (1e-3, "ms")) if seconds >= scale),
        (1e-6, "us"),
    )
    value = seconds / scale
    return f"{value:.0f} {unit}" if value >= 10 else f"{value:.1f} {unit}"


def make_rows(runs: Sequence[Run], reference: Reference | None) -> tuple[Row, ...]:
    """Return the table, with errors and front."""
    rows = []
    for place, run in enumerate(runs):
        row = Row(run.setting, run.seconds, run.repeats, status=run.status, reason=run.reason)
        if run.answer is not None:
            finer = _finer(runs, place)
            if finer is not None:
                row = replace(row, move=errors_of(run.answer, finer.answer).largest)
            if reference is not None:
                errors = errors_of(run.answer, reference.answer)
                row = replace(
                    row,
                    response_rms=errors.response_rms,
                    response_max=errors.response_max,
                    moment=errors.moment,
                    energy=errors.energy,
                    peak=errors.peak,
                    error=_error(errors, run, reference),
                )
        rows.append(row)
    best = math.inf
    front = set()
    measured = [row for row in rows if math.isfinite(row.error)]
    for row in sorted(measured, key=lambda row: (row.seconds, row.error)):
        # Errors below the agreement of the reference cannot be told apart.
        error = max(row.error, reference.resolution)
        if error < best:
            best = error
            front.add(row.setting)
    return tuple(replace(row, pareto=row.setting in front) for row in rows)


def _error(errors: Errors, run: Run, reference: Reference) -> float:
    """Return the error that counts; it is infinite if the run ends at another time."""
    if abs(run.answer.response.size - reference.answer.response.size) > 1:
        return math.inf
    return errors.largest


def _finer(runs: Sequence[Run], place: int) -> Run | None:
    """Return the next finer run of a family that has an answer."""
    for other in runs[place + 1 :]:
        if other.setting.family != runs[place].setting.family:
            return None
        if other.answer is not None:
            return other
    return None


def cheapest(rows: Sequence[Row], tolerance: float) -> Row | None:
    """Return the cheapest row within a tolerance whose finer rows are within it too, or None."""
    best = None
    for place, row in enumerate(rows):
        if not row.error <= tolerance:
            continue
        finer = [r for r in rows[place + 1 :] if r.setting.family == row.setting.family]
        if any(r.error > tolerance for r in finer):
            continue
        if best is None or row.seconds < best.seconds:
            best = row
    return best


def choose(rows: Sequence[Row], runs: Sequence[Run], tolerance: float) -> Choice:
    """Return the cheapest row within a tolerance, and what the next finer one changes."""
    row = cheapest(rows, tolerance)
    if row is None:
        return Choice(tolerance, None)
    place = rows.index(row)
    finer = _finer(runs, place)
    if finer is None:
        return Choice(tolerance, row)
    other = next(r for r in rows if r.setting == finer.setting)
    return Choice(tolerance, row, other, errors_of(runs[place].answer, finer.answer))


def third_method(rows: Sequence[Row], reference: Reference | None) -> Row | None:
    """Return the most accurate implicit setting if the reference is explicit, and vice versa."""
    if reference is None or reference.explicit is None:
        return None
    others = [
        row
        for row in rows
        if (row.setting.method in IMPLICIT) == reference.explicit
        and row.setting.method != "auto"
        and math.isfinite(row.error)
    ]
    return min(others, key=lambda row: row.error, default=None)


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
