"""All loops on one page of html, drawn as svg, to sort and to filter."""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

from rbsdem._core import Array
from rbsdem._files import whole_file
from rbsdem._optional import need_jinja2
from rbsdem._views import view_of
from rbsdem.peer.pictures import Picture
from rbsdem.peer.prediction import Prediction
from rbsdem.peer.predictions import Predictions

__all__ = ["write_gallery"]

# Size of a picture in its own units, a quarter of a pixel, and the room its axes leave.
_WIDTH, _HEIGHT = 1200, 880
_REACH = 0.92

#: Scores of the table at the top, with their digits.
_SCORES = (
    ("nrmse", 3),
    ("peak_ratio", 2),
    ("energy_ratio", 2),
    ("stiffness_ratio", 2),
    ("end_ratio", 2),
)


@dataclass(frozen=True, slots=True)
class _Card:
    """A test as the template shows it; without a comparison there are no lines."""

    row: Prediction
    mode: str
    test: str = ""
    model: str = ""
    displacement: str = ""
    force: str = ""


@view_of(Predictions, "gallery")
def write_gallery(predictions: Predictions, path: Path) -> Path:
    """Write the page; `rbsdem.peer.Predictions.gallery` says more."""
    jinja2 = need_jinja2()
    environment = jinja2.Environment(autoescape=True, undefined=jinja2.StrictUndefined)
    # The loader of packages in jinja2 does not find files of an editable install.
    template = resources.files("rbsdem.peer").joinpath("gallery.html.jinja")
    cards = [
        _card(row, drawn) for row, drawn in zip(predictions, predictions.pictures, strict=True)
    ]
    page = environment.from_string(template.read_text(encoding="utf-8")).render(
        title=f"Loops of {len(predictions)} tests, model {predictions.model}",
        groups=predictions.summary(),
        scores=_SCORES,
        modes=list(dict.fromkeys(card.mode for card in cards)),
        cards=cards,
        width=_WIDTH,
        height=_HEIGHT,
        inf=math.inf,
    )
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as file:
        file.write(page.encode())
    return path


def _card(row: Prediction, drawn: Picture | None) -> _Card:
    mode = row.specimen.failure_mode or "not known"
    if drawn is None or row.comparison is None:
        return _Card(row, mode)
    height = row.comparison.height
    drift = f" = {100 * drawn.displacement / height:.1f} %" if height > 0 else ""
    return _Card(
        row,
        mode,
        test=_path(drawn.test),
        model=_path(drawn.model) if len(drawn.model) > 1 else "",
        displacement=f"{1e3 * drawn.displacement:.0f} mm{drift}",
        force=f"{1e-3 * drawn.force:.0f} kN",
    )


def _path(line: Array) -> str:
    """Return a line in the box as the data of an svg path, in whole numbers."""
    x = _WIDTH / 2 * (1 + _REACH * line[:, 0])
    y = _HEIGHT / 2 * (1 - _REACH * line[:, 1])
    points = np.rint(np.column_stack((x, y))).astype(np.int64)
    return "M" + " ".join(f"{a},{b}" for a, b in points.tolist())
