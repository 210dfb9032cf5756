"""All loops in one picture, each in a cell of its own scale."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rbsdem import plot
from rbsdem._files import write_figure
from rbsdem._optional import need_matplotlib
from rbsdem._views import view_of
from rbsdem.measured.predictions import Predictions

if TYPE_CHECKING:
    from rbsdem.measured.specimen import Specimen

__all__ = ["write_contact_sheet"]

_COLUMNS = 14
_CELL = 1.15, 1.05  # inches
_REACH = np.array((0.46, 0.38))


@view_of(Predictions, "contact_sheet")
def write_contact_sheet(predictions: Predictions, path: Path) -> Path:
    """Write the picture.

    One pair of axes and two collections of lines for all cells: a pair for each would take seconds.
    """
    need_matplotlib()
    from matplotlib.collections import LineCollection  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    rows = [
        (row, drawn)
        for row, drawn in zip(predictions, predictions.pictures, strict=True)
        if drawn is not None
    ]
    columns = max(1, min(_COLUMNS, math.ceil(math.sqrt(1.5 * len(rows)))))
    lines = max(1, math.ceil(len(rows) / columns))
    path.parent.mkdir(parents=True, exist_ok=True)
    with plot.style():
        figure = Figure(figsize=(_CELL[0] * columns, _CELL[1] * lines))
        ax = figure.add_axes((0, 0, 1, 1))
        ax.set(xlim=(0, columns), ylim=(-lines, 0))
        ax.set_axis_off()
        zeros, tests, models = [], [], []
        for i, (row, drawn) in enumerate(rows):
            x, y = i % columns + 0.5, -(i // columns) - 0.56
            zeros += [[(x - 0.46, y), (x + 0.46, y)], [(x, y - 0.38), (x, y + 0.38)]]
            tests.append(_REACH * drawn.test + (x, y))
            if len(drawn.model) > 1:
                models.append(_REACH * drawn.model + (x, y))
            ax.text(x - 0.47, y + 0.4, _short(row.specimen), fontsize=4.6, va="bottom")
            ax.text(x + 0.47, y - 0.41, f"{row.nrmse:.3f}", fontsize=5.0, ha="right", va="bottom")
        ax.add_collection(LineCollection(zeros, colors="0.8", linewidths=0.3))
        ax.add_collection(LineCollection(tests, colors="0.6", linewidths=0.5))
        ax.add_collection(LineCollection(models, colors="#c2410c", linewidths=0.4))
        # Of many thin lines a png hardly gets smaller by trying hard.
        fast = {"pil_kwargs": {"compress_level": 3}} if path.suffix.lower() == ".png" else {}
        write_figure(figure.savefig, path, dpi=200, **fast)
    return path


def _short(specimen: Specimen) -> str:
    """Return a name that fits into a cell: series and what the test is called in it."""
    label = specimen.name
    if specimen.year and specimen.year in label:
        label = label.split(specimen.year, 1)[1].strip(" ,")
        label = f"{specimen.series}, {label}"
    return label if len(label) <= 27 else f"{label[:26]}…"
