"""Predictions as rows of tables and files."""

from __future__ import annotations

import hashlib
import math
import re
from collections.abc import Sequence
from pathlib import PurePath
from typing import TYPE_CHECKING, Any

from rbsdem.checks.criteria import WATCHED
from rbsdem.curves.scores import SCORES
from rbsdem.section.spread import numbers

if TYPE_CHECKING:
    from rbsdem.measured.prediction import Prediction

__all__ = ["band_record", "loop_names", "score_record"]

#: Limit states that have a column.
_STATES = (*WATCHED, "strength_loss", "axial_failure")

#: Bytes of the longest part of a path that is written.
_LONGEST_NAME = 120


def score_record(row: Prediction, limit_states: bool = False) -> dict[str, Any]:
    """Return properties that group tests, scores and times by the names of the columns.

    Parameters
    ----------
    row : Prediction
        The test.
    limit_states : bool, optional
        With the drifts of all limit states; NaN for those that are not reached.
    """
    s = row.specimen
    drifts = row.limit_states or {}
    reached = {f"drift_{name}": drifts.get(name, math.nan) for name in _STATES}
    return {
        "name": s.name,
        "file": s.file or "",
        "peer_id": s.peer_id,
        "series": s.series,
        "section": s.section,
        "failure_mode": s.failure_mode,
        "axial_load_ratio": s.axial_load_ratio,
        "span_depth_ratio": s.span_depth_ratio,
        "model": row.model,
        "status": row.status,
        **{name: row.score(name) for name in SCORES},
        "test_drift_at_loss": row.score("test_drift_at_loss"),
        "model_drift_at_loss": row.score("model_drift_at_loss"),
        **(reached if limit_states else {}),
        "seconds_model": row.seconds_model,
        "seconds_analysis": row.seconds_analysis,
        "error": row.error,
        "note": row.note,
        "outside": "; ".join(row.remarks),
    }


def band_record(row: Prediction) -> dict[str, Any]:
    """Return band and intervals of a prediction by the names of the columns of their csv."""
    found, test = row.band, row.comparison
    assert found is not None
    known = {
        "peak_force_N": found.peak_force,
        "energy_J": found.energy,
        "drift_at_loss": found.drift_at_loss,
    }
    measured = [math.nan, math.nan, math.nan]
    if test is not None:
        measured = list(numbers(test.displacement, test.test_force, test.height).values())
    record: dict[str, Any] = {"name": row.specimen.name, "model": row.model}
    record |= {"points_within": row.points_within, "width": found.width}
    for (name, number), of_test in zip(known.items(), measured, strict=True):
        record |= {
            f"{name}_lower": number.lower,
            name: number.value,
            f"{name}_upper": number.upper,
            f"{name}_test": of_test,
        }
    for place, one in enumerate(row.nearest, 1):
        record |= {
            f"nearest_{place}": one.specimen.name,
            f"distance_{place}": one.distance,
            f"nrmse_{place}": one.prediction.nrmse if one.prediction else math.nan,
        }
    return record | {"outside": "; ".join(row.remarks)}


def loop_names(files: Sequence[str]) -> list[PurePath]:
    """Return a csv for each history: its path below the folder, in letters that any disk takes."""
    taken: set[str] = set()
    names = []
    for file in files:
        parts = [_safe(part) for part in PurePath(file).parts if part not in ("..", "/", "")]
        stem = re.sub(r"\.(csv|txt)$", "", parts.pop() if parts else "test", flags=re.IGNORECASE)
        number, name = 1, PurePath(*parts, f"{stem}.csv")
        while str(name).casefold() in taken:
            number += 1
            name = PurePath(*parts, f"{stem}_{number}.csv")
        taken.add(str(name).casefold())
        names.append(name)
    return names


def _safe(part: str) -> str:
    """Return a part of a path without letters that a disk may refuse, and not too long."""
    kept = "".join(c if c.isprintable() and c not in '\\:*?"<>|' else "_" for c in part)
    if len(kept.encode()) <= _LONGEST_NAME:
        return kept
    digest = hashlib.sha256(kept.encode()).hexdigest()[:12]
    return f"{kept.encode()[: _LONGEST_NAME - 13].decode(errors='ignore')}_{digest}"
