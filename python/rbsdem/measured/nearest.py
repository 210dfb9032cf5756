"""The tests that are most like a column, with the errors of their predictions."""

from __future__ import annotations

import math
import warnings
from collections.abc import Iterable
from functools import lru_cache

from rbsdem import _arguments
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.measured.drawing import checked_specimen, draw
from rbsdem.measured.predictions import Neighbour, Prediction
from rbsdem.measured.specimens import Specimen
from rbsdem.model.shape import CircularSection, Section
from rbsdem.section.spread import place_of

#: Differences that count as 1: of the axial load ratio, and of the logarithms of the shear span
#: over the depth, the concrete strength, and the mechanical ratios of bars and ties.
_SCALES = (0.15, 0.4, 0.35, 0.4, 0.6)


def nearest(
    section: Section,
    height: float,
    axial_load: float,
    tests: Iterable[Prediction | Specimen],
    n: int = 5,
    *,
    but: Specimen | None = None,
) -> tuple[Neighbour, ...]:
    """Return the tests that are most like a column, the nearest first.

    They differ least in the properties of `likeness`; rectangular and round sections, of which
    those with a spiral are, are not compared.

    Parameters
    ----------
    section : Section
        Of the column; that of a test is ``peer.draw(specimen).section``.
    height : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    tests : iterable of Prediction or Specimen
        Predicted tests of a folder, as from `rbsdem.peer.predict`, or the tests alone. What has no
        history, or a section that cannot be drawn, is passed over.
    n : int, optional
        How many.
    but : Specimen, optional
        The column itself, if it is a test: it is not its own neighbour, nor is another row of the
        table with its history.

    Raises
    ------
    InputError
        If `n` is below 1.
    """
    if _arguments.whole(n, "n") < 1:
        raise InputError(f"nearest: n = {n} must be 1 or more")
    place = place_of(section, height, axial_load)
    is_round = isinstance(section, CircularSection) if but is None else _is_round(but)
    found = []
    for one in tests:
        row = one if isinstance(one, Prediction) else None
        other = checked_specimen(one.specimen if isinstance(one, Prediction) else one)
        if (row is None and other.path is None) or (row is not None and row.comparison is None):
            continue
        # A row with the history of another one is an error of the database.
        if other.duplicate_of is not None or (but is not None and _same(but, other)):
            continue
        if is_round != _is_round(other):
            continue
        try:
            there = _place(other)
        except InputError:
            continue
        ways = [(a - b) / scale for a, b, scale in zip(place, there, _SCALES, strict=True)]
        found.append(Neighbour(other, math.hypot(*ways), row))
    return tuple(sorted(found, key=lambda one: one.distance)[:n])


def _same(one: Specimen, other: Specimen) -> bool:
    """Whether two rows are the same test."""
    if one is other or one == other:
        return True
    if one.peer_id is not None and one.peer_id in (other.peer_id, other.duplicate_of):
        return True
    return one.duplicate_of is not None and one.duplicate_of == other.peer_id


def _is_round(specimen: Specimen) -> bool:
    return specimen.section != "rectangular"


@lru_cache(maxsize=4096)
def _place(specimen: Specimen) -> tuple[float, ...]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        section = draw(specimen).section
    return place_of(section, specimen.length, specimen.axial_load)
