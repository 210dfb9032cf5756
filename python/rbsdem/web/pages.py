"""The files of the pages, all of them as one file, and predicted tests on such a page."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import os
import re
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._files import atomic_write
from rbsdem._types import Array
from rbsdem.measured.predictions import Picture, Prediction, Predictions

#: Modules of the page, each after those that it imports.
_DRAWN = ("units.js", "chart.js", "fields.js", "drawing.js", "panels.js", "history.js")
MODULES = (*_DRAWN, "answers.js", "main.js")

#: Modules of the page of frames.
FRAMES = ("units.js", "chart.js", "fields.js", "panels.js", "history.js", "answers.js", "frame.js")

#: Modules of the page of all tests.
GALLERY = ("units.js", "chart.js", "fields.js", "panels.js", "gallery.js")

_KINDS = {"html": "html", "css": "css", "js": "javascript"}
TYPES = {ending: f"text/{kind}; charset=utf-8" for ending, kind in _KINDS.items()}

_IMPORT = re.compile(r"^import \{[^}]*\} from \"\./[a-z]+\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export ", re.MULTILINE)


def parts(page: str = "index.html", modules: Sequence[str] = MODULES) -> dict[str, bytes]:
    """Return the files of a page by their names."""
    folder = resources.files("rbsdem.web").joinpath("page")
    return {name: folder.joinpath(name).read_bytes() for name in (page, "page.css", *modules)}


def one_file(
    title: str,
    data: Mapping[str, Any] | None,
    modules: Sequence[str] = MODULES,
    sheets: tuple[str, str] = ("", ""),
) -> str:
    """Return a page with its style, its modules and its results inside.

    It uses no network: its policy allows only the script and the style that are in it.

    Parameters
    ----------
    title : str
        Title of the document.
    data : mapping or None
        What the page would have got from the server.
    modules : sequence of str, optional
        `MODULES`, `GALLERY`, or none for a page of sheets.
    sheets : tuple of str, optional
        Html that stands before and behind what the modules draw.
    """
    name = {MODULES: "index.html", GALLERY: "gallery.html"}.get(tuple(modules), "report.html")
    files = {key: raw.decode("utf-8") for key, raw in parts(name, modules).items()}
    script = "\n".join(_EXPORT.sub("", _IMPORT.sub("", files[module])) for module in modules)
    style = files["page.css"]
    policy = (
        f"default-src 'none'; script-src '{_digest(script)}'; style-src '{_digest(style)}'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    # In JSON "<" stands only in texts, where it can be written so that no tag ends.
    packed = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    page = files[name]
    before, behind = (f'<div class="sheets">{html}</div>\n' if html else "" for html in sheets)
    for old, new in (
        ("<main", f"{before}<main"),
        ("</main>\n", f"</main>\n{behind}"),
        ("<title>rbsdem</title>", f"<title>{plain(title)}</title>"),
        (
            '<link rel="stylesheet" href="page.css">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
            f"<style>{style}</style>",
        ),
        (
            '<script type="module" src="main.js"></script>',
            f'<script type="application/json" id="report">{packed}</script>\n'
            f'<script type="module">{script}</script>',
        ),
    ):
        if page.count(old) != 1:
            raise AssertionError(old)
        page = page.replace(old, new)
    return page


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def plain(text: str) -> str:
    """Return a text for html."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


#: Scores of a card, with their digits.
SCORES = {"nrmse": 3, "peak_ratio": 2, "energy_ratio": 2, "stiffness_ratio": 2, "end_ratio": 2}


_ENDS = ("median", "lower", "upper")


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
        "tests": list(map(card, predictions, predictions.pictures)),
    }
    page = one_file(title, data, GALLERY)
    path.parent.mkdir(parents=True, exist_ok=True)
    with atomic_write(path) as file:
        file.write(page.encode("utf-8"))
    return path


def _groups(predictions: Predictions) -> list[dict[str, object]]:
    summary = predictions.summary()
    return [
        {
            "name": name,
            **{count: int(row[count]) for count in ("tests", "stopped", "failed")},
            "scores": {
                score: [finite(float(row[f"{score}_{end}"]), digits) for end in _ENDS]
                for score, digits in SCORES.items()
            },
        }
        for name, row in summary.iterrows()
    ]
