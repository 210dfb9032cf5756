"""Predicted tests on one page of html, made of the parts of `rbsdem explore`."""

from __future__ import annotations

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._arguments import Array
from rbsdem._files import whole_file
from rbsdem.measured.predictions import Picture, Prediction, Predictions
from rbsdem.web.parts import GALLERY, one_file

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
        Its lines, as of `rbsdem.measured.predictions.picture`.
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


def gallery(predictions: Predictions, path: str | os.PathLike[str]) -> Path:
    """Write one page of html with all loops, to sort and to filter.

    Parameters
    ----------
    predictions : Predictions
        The tests.
    path : path
        File to write.

    Returns
    -------
    Path
        The file. It stands alone: styles, script and figures are in it.
    """
    path = Path(path)
    title = f"Loops of {len(predictions)} tests, model {predictions.model}"
    data = {
        "title": title,
        "digits": SCORES,
        "groups": _groups(predictions),
        "tests": [
            card(row, drawn) for row, drawn in zip(predictions, predictions.pictures, strict=True)
        ],
    }
    page = one_file(title, data, GALLERY)
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as file:
        file.write(page.encode("utf-8"))
    return path


def _groups(predictions: Predictions) -> list[dict[str, object]]:
    summary = predictions.summary()
    return [
        {
            "name": name,
            **{count: int(row[count]) for count in ("tests", "stopped", "failed")},
            "scores": {
                score: [
                    finite(float(row[f"{score}_{end}"]), digits)
                    for end in ("median", "lower", "upper")
                ]
                for score, digits in SCORES.items()
            },
        }
        for name, row in summary.iterrows()
    ]
