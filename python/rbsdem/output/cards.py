"""A predicted test as the pages show it: its loop, the prediction over it, its scores."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from rbsdem._arguments import Array
from rbsdem.measured.pictures import Picture
from rbsdem.measured.prediction import Prediction

__all__ = ["SCORES", "card"]

#: Scores of a card, with their digits.
SCORES = {
    "nrmse": 3,
    "peak_ratio": 2,
    "energy_ratio": 2,
    "stiffness_ratio": 2,
    "end_ratio": 2,
}


def card(row: Prediction, drawn: Picture | None) -> dict[str, Any]:
    """Return a test for JSON; without a comparison it has no lines.

    Parameters
    ----------
    row : Prediction
        The test.
    drawn : Picture or None
        Its lines, as of `rbsdem.measured.pictures.picture`.
    """
    specimen = row.specimen
    found = {
        "name": specimen.name,
        "failure": specimen.failure_mode or "not known",
        "section": specimen.section,
        "axial_load_ratio": finite(specimen.axial_load_ratio, 4),
        "span_depth_ratio": finite(specimen.span_depth_ratio, 3),
        "status": row.status,
        "error": row.error,
        "scores": {name: finite(row.score(name), 6) for name in SCORES},
    }
    if drawn is None or row.comparison is None:
        return found
    return found | {
        "test": _thousandths(drawn.test),
        "model": _thousandths(drawn.model) if len(drawn.model) > 1 else [],
        "displacement": drawn.displacement,
        "force": drawn.force,
        "height": row.comparison.height,
    }


def finite(value: float, digits: int) -> float | None:
    """Return a number for JSON, None if it is not finite."""
    return round(value, digits) if math.isfinite(value) else None


def _thousandths(line: Array) -> list[int]:
    """Return x, y, x, y, ... of a line in its box."""
    found: list[int] = np.rint(1e3 * line).astype(np.int64).ravel().tolist()
    return found
