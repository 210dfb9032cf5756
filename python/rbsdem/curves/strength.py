"""The envelope of a cyclic curve, and where it loses its strength."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.curves.curve import columns
from rbsdem.curves.cycles import turning_points
from rbsdem.errors import InputError

_NEARLY = 0.95
"""Share of the largest displacement so far that a repeated cycle has to reach."""


def beyond(displacement: ArrayLike, force: ArrayLike, side: int) -> tuple[Array, Array, Array]:
    """Return the parts of a curve that go beyond its largest displacement so far to one side.

    A part begins on the line that crosses that displacement, whether there is a row or not; there
    the displacement comes twice, with the force of the part before and with that of the new one.

    Parameters
    ----------
    displacement, force : array_like, shape (m,)
        The curve, row by row, straight between two [m, N].
    side : {1, -1}
        Which side.

    Returns
    -------
    place : ndarray, shape (k,)
        Numbers of the rows, between two rows with the share of the way.
    displacement, force : ndarray, shape (k,)
        There, with the sign that they have to that side [m, N].

    Raises
    ------
    InputError
        If the arrays differ in length or a number is not finite, or if `side` is neither.
    """
    return _beyond(*_to_side(displacement, force, side))


def _beyond(x: Array, y: Array) -> tuple[Array, Array, Array]:
    so_far = np.maximum.accumulate(np.concatenate(([0.0], x)))[:-1]
    rows = np.flatnonzero(x > so_far)
    after = rows[rows > 0]
    share = (so_far[after] - x[after - 1]) / (x[after] - x[after - 1])
    force_there = y[after - 1] + share * (y[after] - y[after - 1])
    place = np.concatenate((rows.astype(np.float64), after - 1 + share))
    # Where the row before is one of them, the crossing is that row.
    place, at = np.unique(place, return_index=True)
    return (
        place,
        np.concatenate((x[rows], so_far[after]))[at],
        np.concatenate((y[rows], force_there))[at],
    )


def envelope_points(
    displacement: ArrayLike, force: ArrayLike, side: int
) -> tuple[Array, Array, Array]:
    """Return the envelope of a cyclic curve to one side.

    Parameters
    ----------
    displacement, force, side
        As for `beyond`.

    Returns
    -------
    place, displacement, force : ndarray, shape (k,)
        Those of `beyond`; and of each half-cycle that comes back to the largest displacement so
        far (within 5 %) without going beyond, the point of the largest force there.

    Raises
    ------
    InputError
        As `beyond`.
    """
    return _envelope(*_to_side(displacement, force, side), turning_points(displacement))


def _envelope(x: Array, y: Array, turns: np.ndarray) -> tuple[Array, Array, Array]:
    places, xs, ys = ([part] for part in _beyond(x, y))
    so_far = np.maximum.accumulate(np.concatenate(([0.0], x)))
    if x.size >= 2:
        for first, last in pairwise([0, *turns.tolist(), x.size - 1]):
            reach = so_far[first + 1]
            if x[first] < x[last] <= reach and x[last] >= _NEARLY * reach:
                place, at, most = _largest_beyond(x, y, (first, last), _NEARLY * reach)
                places.append(np.array([place]))
                xs.append(np.array([at]))
                ys.append(np.array([most]))
    if len(places) == 1:
        return places[0], xs[0], ys[0]
    rows, order = np.unique(np.concatenate(places), return_index=True)
    return rows, np.concatenate(xs)[order], np.concatenate(ys)[order]


def _largest_beyond(
    x: Array, y: Array, rows: tuple[int, int], least: float
) -> tuple[float, float, float]:
    """Return the point of the largest force between two rows where x is at least so large."""
    first, last = rows
    x, y = x[first : last + 1], y[first : last + 1]
    inside = x >= least
    near = inside.nonzero()[0]
    row = near[y[near].argmax()]
    found = float(row), float(x[row]), float(y[row])
    # Where the curve comes to that displacement or leaves it, the force may be more than at a row.
    for row in (inside[1:] != inside[:-1]).nonzero()[0].tolist():
        share = float((least - x[row]) / (x[row + 1] - x[row]))
        there = float(y[row] + share * (y[row + 1] - y[row]))
        if there > found[2]:
            found = row + share, least, there
    return first + found[0], found[1], found[2]


def strength_loss(displacement: ArrayLike, force: ArrayLike, *, share: float = 0.2) -> float:
    """Displacement at which a share of the strength is lost.

    Parameters
    ----------
    displacement, force : array_like, shape (m,)
        The curve, row by row [m, N].
    share : float, optional
        Share of the largest force of a side that is lost, above 0 and below 1.

    Returns
    -------
    float
        On the envelope of a side, the first displacement past the largest force at which the force
        is down to (1 - share) of it and does not come back in the same half-cycle, as a pinched
        loop does that crosses its former displacement; interpolated between two points. The side
        at which this happens first is taken; the displacement is unsigned [m]. A side whose largest
        force is less than half of that of the other does not count. NaN if no side loses so much.

    Raises
    ------
    InputError
        If the arrays differ in length or a number is not finite, or if `share` is out of its range.
    """
    return strength_loss_point(displacement, force, share=share)[1]


def strength_loss_point(
    displacement: ArrayLike, force: ArrayLike, *, share: float = 0.2
) -> tuple[float, float]:
    """Find where a share of the strength is lost, and the displacement there.

    Parameters
    ----------
    displacement, force, share
        As for `strength_loss`.

    Returns
    -------
    place : float
        Number of the row there, between two rows with the share of the way; where the envelope is
        not the curve itself, that of the next point of the envelope. NaN if there is none.
    displacement : float
        That of `strength_loss`.

    Raises
    ------
    InputError
        As `strength_loss`.
    """
    if not 0 < _arguments.number(share, "share") < 1:
        raise InputError(f"share = {share} must be above 0 and below 1")
    found = (math.nan, math.nan)
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    turns = turning_points(d)
    sides = [_envelope(side * d, side * f, turns) for side in (1, -1)]
    # A force between the envelopes, as on the way back, is no strength.
    largest = max((np.max(y) for _, _, y in sides if y.size), default=0)
    for place, x, y in sides:
        if not y.size or 2 * np.max(y) < largest or not np.max(y) > 0:
            continue
        peak = int(np.argmax(y))
        left = (1 - share) * y[peak]
        half_cycle = np.searchsorted(turns, place)
        reached = _still_reached(y, half_cycle)
        lost = np.flatnonzero(reached[peak:] <= left)
        if not lost.size:
            continue
        at = peak + int(lost[0])
        # In a half-cycle the force falls on its line; from one to the next, to what that reaches.
        lower = y[at] if half_cycle[at] == half_cycle[at - 1] else reached[at]
        part = (y[at - 1] - left) / (y[at - 1] - lower)
        way = place[at] - place[at - 1]
        there = place[at - 1] + part * way if way <= 1 else place[at]
        if not found[0] <= there:
            found = float(there), float(x[at - 1] + part * (x[at] - x[at - 1]))
    return found


def _still_reached(force: Array, half_cycle: np.ndarray) -> Array:
    """Return the largest force that the half-cycle of each point has there or later.

    A curve that comes back with pinched loops dips where it crosses its former displacement, and
    rises again: that is no loss of strength.
    """
    largest = force.copy()
    for part in np.split(np.arange(force.size), np.flatnonzero(np.diff(half_cycle)) + 1):
        largest[part] = np.maximum.accumulate(force[part][::-1])[::-1]
    return largest


def _to_side(displacement: ArrayLike, force: ArrayLike, side: int) -> tuple[Array, Array]:
    if _arguments.whole(side, "side") not in (1, -1):
        raise InputError(f"side = {side!r} must be 1 or -1")
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    return side * d, side * f
