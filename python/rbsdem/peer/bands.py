"""How far the prediction of a test may be off: its band, and the tests that are most like it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from rbsdem.peer.columns import column
from rbsdem.peer.drawing import draw
from rbsdem.peer.predictions import Prediction
from rbsdem.peer.specimen import Specimen
from rbsdem.section.spread import Spread

__all__ = ["Neighbour", "band", "nearest"]

#: Differences that count as 1: of the axial load ratio, and of the logarithms of the others.
_SCALES = (0.15, 0.4, 0.35, 0.4, 0.6)


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A predicted test that is like another.

    Attributes
    ----------
    prediction : Prediction
        Its prediction, with its errors.
    distance : float
        0 for the same column; 1 is a difference of 0.15 in the axial load ratio, or of 40 % in the
        shear span or in the mechanical ratio of the bars.
    """

    prediction: Prediction
    distance: float


def band(specimen: Specimen, *, samples: int = 16, **options: Any) -> Spread:
    """Predict a test with the band that holds 80 % of the points of left-out tests.

    Parameters
    ----------
    specimen : Specimen
        The test; of what was measured only the displacement is used.
    samples : int, optional
        As for `rbsdem.section.LayeredColumn.spread`.
    **options
        As for `rbsdem.peer.column`.

    Raises
    ------
    InputError
        If there is no history, the section is refused, or the version has no bands.
    """
    test = specimen.test()
    return column(specimen, **options).spread(test.displacement, samples=samples)


def nearest(specimen: Specimen, found: Iterable[Prediction], n: int = 5) -> tuple[Neighbour, ...]:
    """Return the predicted tests that are most like a column, the nearest first.

    They differ least in axial load ratio, shear span over depth, concrete strength, mechanical
    ratio of the bars and of the ties; rectangular and round sections are not compared.

    Parameters
    ----------
    specimen : Specimen
        The column; a test among those found is not its own neighbour.
    found : iterable of Prediction
        Predicted tests of a folder, as from `rbsdem.peer.predict`.
    n : int, optional
        How many.
    """
    place = _place(specimen)
    near = [
        Neighbour(row, math.dist(place, _place(row.specimen)))
        for row in found
        if row.comparison is not None
        and row.specimen is not specimen
        and (row.specimen.section == "rectangular") == (specimen.section == "rectangular")
    ]
    return tuple(sorted(near, key=lambda one: one.distance)[:n])


def _place(s: Specimen) -> tuple[float, ...]:
    """Return a column as a point: each number over what counts as 1."""
    drawing = draw(s)
    steel = sum(bar.area * bar.yield_stress for bar in drawing.bars)
    steel /= s.gross_area * s.concrete_strength
    ties = 0.0
    if drawing.tie_spacing > 0:
        area = drawing.legs * math.pi / 4 * drawing.tie_diameter**2
        ties = area * drawing.tie_yield_stress / (drawing.tie_spacing * s.width)
        ties /= s.concrete_strength
    logs = (s.span_depth_ratio, s.concrete_strength, steel, max(ties, 1e-3))
    numbers = (s.axial_load_ratio, *(math.log(value) for value in logs))
    return tuple(value / scale for value, scale in zip(numbers, _SCALES, strict=True))
