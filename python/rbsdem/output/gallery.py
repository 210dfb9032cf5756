"""All loops on one page of html, to sort and to filter, made of the parts of `rbsdem explore`."""

from __future__ import annotations

from pathlib import Path

from rbsdem._files import whole_file
from rbsdem._views import view_of
from rbsdem.measured.predictions import Group, Predictions
from rbsdem.output.cards import SCORES, card, finite
from rbsdem.web.parts import GALLERY, one_file

__all__ = ["write_gallery"]


@view_of(Predictions, "gallery")
def write_gallery(predictions: Predictions, path: Path) -> Path:
    """Write the page; `rbsdem.peer.Predictions.gallery` says more."""
    title = f"Loops of {len(predictions)} tests, model {predictions.model}"
    data = {
        "title": title,
        "digits": SCORES,
        "groups": [_group(group) for group in predictions.summary()],
        "tests": [
            card(row, drawn) for row, drawn in zip(predictions, predictions.pictures, strict=True)
        ],
    }
    page = one_file(title, data, GALLERY)
    path.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(path) as file:
        file.write(page.encode("utf-8"))
    return path


def _group(group: Group) -> dict[str, object]:
    quartiles = {name: group.quartiles[name] for name in SCORES}
    return {
        "name": group.name,
        "tests": group.tests,
        "stopped": group.stopped,
        "failed": group.failed,
        "scores": {
            name: [finite(value, digits) for value in (q.median, q.lower, q.upper)]
            for (name, q), digits in zip(quartiles.items(), SCORES.values(), strict=True)
        },
    }
