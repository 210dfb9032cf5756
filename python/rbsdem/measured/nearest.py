"""The tests that are most like a column, with the errors of their predictions."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache

from rbsdem import _arguments
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.measured.columns import checked_specimen
from rbsdem.measured.drawing import draw
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.specimen import Specimen

__all__ = ["Neighbour", "nearest", "properties"]

#: Differences that count as 1: of the axial load ratio, and of the logarithms of the others.
_SCALES = {
    "axial_load_ratio": 0.15,
    "span_depth_ratio": 0.4,
    "concrete_strength": 0.35,
    "bar_ratio": 0.4,
    "tie_ratio": 0.6,
}

#: Below this a ratio of bars or ties is none.
_NONE = 1e-3


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A test that is like another.

    Attributes
    ----------
    specimen : Specimen
        The test.
    distance : float
        0 for the same column; 1 is a difference of 0.15 in the axial load ratio, or of 40 % in the
        shear span or in the mechanical ratio of the bars.
    prediction : Prediction or None
        Its prediction, with its errors; None if it was not predicted.
    """

    specimen: Specimen
    distance: float
    prediction: Prediction | None = None

    @property
    def properties(self) -> dict[str, float]:
        """What the distance is taken from; see `rbsdem.peer.properties`."""
        return properties(self.specimen)


def properties(specimen: Specimen) -> dict[str, float]:
    """Return the properties by which tests are compared.

    Parameters
    ----------
    specimen : Specimen
        The test, or a column that nobody tested.

    Returns
    -------
    dict of str to float
        ``axial_load_ratio``, ``span_depth_ratio``, ``concrete_strength`` [Pa], and the mechanical
        ratios of the longitudinal bars, ``bar_ratio`` = A_s f_y/(A_g f'c), and of the ties in the
        direction of loading, ``tie_ratio`` = A_v f_yt/(b s f'c).

    Raises
    ------
    InputError
        If its section cannot be drawn.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        drawing = draw(checked_specimen(specimen))
    steel = sum(bar.area * bar.yield_stress for bar in drawing.bars)
    ties = 0.0
    if drawing.tie_spacing > 0:
        area = drawing.legs * math.pi / 4 * drawing.tie_diameter**2
        ties = area * drawing.tie_yield_stress / (drawing.tie_spacing * specimen.width)
    return {
        "axial_load_ratio": specimen.axial_load_ratio,
        "span_depth_ratio": specimen.span_depth_ratio,
        "concrete_strength": specimen.concrete_strength,
        "bar_ratio": steel / (specimen.gross_area * specimen.concrete_strength),
        "tie_ratio": ties / specimen.concrete_strength,
    }


def nearest(
    specimen: Specimen, tests: Iterable[Prediction | Specimen], n: int = 5
) -> tuple[Neighbour, ...]:
    """Return the tests that are most like a column, the nearest first.

    They differ least in axial load ratio, shear span over depth, concrete strength, mechanical
    ratio of the bars and of the ties; rectangular and round sections are not compared.

    Parameters
    ----------
    specimen : Specimen
        The column; a test among those found is not its own neighbour, nor is another row of the
        table with its history.
    tests : iterable of Prediction or Specimen
        Predicted tests of a folder, as from `rbsdem.peer.predict`, or the tests alone. What has no
        history, or a section that cannot be drawn, is passed over.
    n : int, optional
        How many.

    Raises
    ------
    InputError
        If the section of the column cannot be drawn, or `n` is below 1.
    """
    if _arguments.whole(n, "n") < 1:
        raise InputError(f"nearest: n = {n} must be 1 or more")
    place = _place(specimen)
    found = []
    for one in tests:
        row = one if isinstance(one, Prediction) else None
        other = checked_specimen(one.specimen if isinstance(one, Prediction) else one)
        if (row is None and other.path is None) or (row is not None and row.comparison is None):
            continue
        # A row with the history of another one is an error of the database.
        if other.duplicate_of is not None or _same(specimen, other):
            continue
        if _round(specimen) != _round(other):
            continue
        try:
            there = _place(other)
        except InputError:
            continue
        found.append(Neighbour(other, math.dist(place, there), row))
    return tuple(sorted(found, key=lambda one: one.distance)[:n])


def _same(one: Specimen, other: Specimen) -> bool:
    """Whether two rows are the same test."""
    if one is other or one == other:
        return True
    if one.peer_id is not None and one.peer_id in (other.peer_id, other.duplicate_of):
        return True
    return one.duplicate_of is not None and one.duplicate_of == other.peer_id


def _round(specimen: Specimen) -> bool:
    return specimen.section != "rectangular"


@lru_cache(maxsize=4096)
def _place(specimen: Specimen) -> tuple[float, ...]:
    """Return a column as a point: each number over what counts as 1."""
    found = []
    for name, value in properties(specimen).items():
        number = value if name == "axial_load_ratio" else math.log(max(value, _NONE))
        found.append(number / _SCALES[name])
    return tuple(found)
