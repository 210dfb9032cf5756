"""All loops in one picture, each in a cell of its own scale."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rbsdem import plot
from rbsdem._optional import need_matplotlib
from rbsdem._views import view_of
from rbsdem.peer.predictions import Prediction, Predictions

if TYPE_CHECKING:
    from rbsdem._core import Array
    from rbsdem.peer.specimen import Specimen

__all__ = ["write_contact_sheet"]

_COLUMNS = 14
_CELL = 1.15, 1.05  # inches
_REACH = 0.46, 0.38


@view_of(Predictions, "contact_sheet")
def write_contact_sheet(predictions: Predictions, path: Path) -> Path:
    """Write the picture.

    One pair of axes and two collections of lines for all cells: a pair for each would take seconds.
    """
    need_matplotlib()
    from matplotlib.collections import LineCollection  # noqa: PLC0415
    from matplotlib.figure import Figure  # noqa: PLC0415

    rows = [row for row in predictions if row.comparison is not None]
    columns = max(1, min(_COLUMNS, math.ceil(math.sqrt(1.5 * len(rows)))))
    lines = max(1, math.ceil(len(rows) / columns))
    path.parent.mkdir(parents=True, exist_ok=True)
    with plot.style():
        figure = Figure(figsize=(_CELL[0] * columns, _CELL[1] * lines))
        ax = figure.add_axes((0, 0, 1, 1))
        ax.set(xlim=(0, columns), ylim=(-lines, 0))
        ax.set_axis_off()
        zeros, tests, models = [], [], []
        for i, row in enumerate(rows):
            x, y = i % columns + 0.5, -(i // columns) - 0.56
            zeros += [[(x - 0.46, y), (x + 0.46, y)], [(x, y - 0.38), (x, y + 0.38)]]
            test, model = _cell(row)
            tests.append(test + np.array((x, y)))
            if len(model) > 1:
                models.append(model + np.array((x, y)))
            ax.text(x - 0.47, y + 0.4, _short(row.specimen), fontsize=4.6, va="bottom")
            ax.text(x + 0.47, y - 0.41, f"{row.nrmse:.3f}", fontsize=5.0, ha="right", va="bottom")
        ax.add_collection(LineCollection(zeros, colors="0.8", linewidths=0.3))
        ax.add_collection(LineCollection(tests, colors="0.6", linewidths=0.5))
        ax.add_collection(LineCollection(models, colors="black", linewidths=0.4))
        # Of many thin lines a png hardly gets smaller by trying hard.
        fast = {"pil_kwargs": {"compress_level": 3}} if path.suffix.lower() == ".png" else {}
        figure.savefig(path, dpi=200, **fast)
    return path


def _cell(row: Prediction) -> tuple[Array, Array]:
    """Return the loops of test and model in a cell about zero, shape (m, 2) each."""
    c = row.comparison
    assert c is not None
    x = _REACH[0] * c.displacement / (np.max(np.abs(c.displacement)) or 1.0)
    largest = float(np.max(np.abs(c.test_force)))
    model = c.model_force[: c.rows]
    reach = min(max(largest, float(np.max(np.abs(model), initial=0.0))), 1.6 * largest)
    # What a model is beyond that would cover the neighbours.
    clipped = np.clip(model, -1.15 * reach, 1.15 * reach)
    return (
        np.column_stack((x, _REACH[1] * c.test_force / reach)),
        np.column_stack((x[: c.rows], _REACH[1] * clipped / reach)),
    )


def _short(specimen: Specimen) -> str:
    """Return a name that fits into a cell: series and what the test is called in it."""
    label = specimen.name
    if specimen.year and specimen.year in label:
        label = label.split(specimen.year, 1)[1].strip(" ,")
        label = f"{specimen.series}, {label}"
    return label if len(label) <= 27 else f"{label[:26]}…"
