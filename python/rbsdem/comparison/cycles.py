"""Cycle by cycle: turning points, energy, stiffness, damping; and where strength is lost.

A half-cycle belongs to a turning point of the displacement, its tip. It lasts from where the force
changes its sign before the tip to where it does so after it. Nothing is stored at zero force, so
the work between the two is the energy dissipated. Each curve has its own zeros of force; the tips
are those of the displacement, which a test and a model driven through it share.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _core
from rbsdem._core import Array
from rbsdem._curve import columns
from rbsdem.comparison.metrics import work
from rbsdem.errors import InputError

__all__ = [
    "TURN",
    "HalfCycles",
    "beyond",
    "envelope",
    "half_cycle_numbers",
    "half_cycles",
    "strength_loss",
    "strength_loss_point",
    "tip_rows",
    "turning_points",
]

TURN = 0.02
"""Share of its largest absolute value by which a displacement turns back at a turning point."""

_NEARLY = 0.95
"""Share of the largest displacement so far that a repeated cycle has to reach."""


@dataclass(frozen=True, slots=True, eq=False)
class HalfCycles:
    """The half-cycles of one curve, in their order.

    Attributes
    ----------
    row : ndarray of int, shape (c,)
        Row of the tip; of a static result, that of its `path`.
    displacement : ndarray, shape (c,)
        At the tip [m].
    force : ndarray, shape (c,)
        At the tip [N].
    peak_force : ndarray, shape (c,)
        The largest on the way to the tip, in its direction [N].
    energy : ndarray, shape (c,)
        Dissipated from zero force to zero force [J]. If a history ends under load, the last value
        includes what is stored there.
    stiffness : ndarray, shape (c,)
        Secant from the origin to the tip [N/m]; NaN where force and displacement of the tip differ
        in sign.
    damping : ndarray, shape (c,)
        Equivalent viscous damping ratio E/(pi F d), with the energy E of the half-cycle and the
        force and displacement of its tip; NaN as for the stiffness.
    """

    row: np.ndarray
    displacement: Array
    force: Array
    peak_force: Array
    energy: Array
    stiffness: Array
    damping: Array

    def __len__(self) -> int:
        return self.row.size


def turning_points(displacement: ArrayLike, *, share: float = TURN) -> np.ndarray:
    """Find the rows at which a displacement turns back.

    Parameters
    ----------
    displacement : array_like, shape (m,)
        The displacement, in the order of the test [m].
    share : float, optional
        Share of its largest absolute value by which it has to turn back, from 0 to 1.

    Returns
    -------
    ndarray of int, shape (k,)
        Rows of the extremes; the first and the last row of the history are not among them.

    Raises
    ------
    InputError
        If a number is not finite, or if `share` is out of its range.
    """
    d = _core.finite_vector(displacement, "displacement")
    if not 0 <= _core.number(share, "share") <= 1:
        raise InputError(f"share = {share} must be from 0 to 1")
    if d.size < 3:
        return np.empty(0, dtype=np.intp)
    # Only local extremes can be turning points; of a plateau, its first row.
    step = np.diff(d)
    moves = np.flatnonzero(step)
    rows = [*(moves[np.flatnonzero(np.diff(np.sign(step[moves])))] + 1).tolist(), d.size - 1]
    threshold = share * float(np.max(np.abs(d)))
    turns: list[int] = []
    direction, extreme = 0.0, 0
    for row in rows:
        away = d[row] - d[extreme]
        if direction == 0:
            # The first move; a small one sets no direction.
            if abs(away) > threshold:
                direction, extreme = math.copysign(1.0, away), row
        elif away * direction > 0:
            extreme = row
        elif -away * direction > threshold:
            turns.append(extreme)
            direction, extreme = -direction, row
    return np.array(turns, dtype=np.intp)


def half_cycle_numbers(displacement: ArrayLike) -> np.ndarray:
    """Return the number of the half-cycle of each row, from 0; a tip begins the next one.

    Parameters
    ----------
    displacement : array_like, shape (m,)
        The displacement, in the order of the test [m].

    Returns
    -------
    ndarray of int, shape (m,)
        How many turning points were reached up to each row.

    Raises
    ------
    InputError
        If a number is not finite.
    """
    turns = turning_points(displacement)
    return np.searchsorted(turns, np.arange(np.size(displacement)), side="right")


def half_cycles(
    displacement: ArrayLike,
    force: ArrayLike,
    *,
    tips: ArrayLike | None = None,
    done: ArrayLike | None = None,
) -> HalfCycles:
    """Cut a curve into half-cycles.

    Parameters
    ----------
    displacement, force : array_like, shape (m,)
        The curve, row by row [m, N].
    tips : array_like of int, shape (c,), optional
        Rows of the tips, ascending. By default the turning points, and the last row if the curve
        is still loaded outwards there.
    done : array_like, shape (m,), optional
        Work of the force up to each row [J], if it is known better than by the trapezium rule.

    Returns
    -------
    HalfCycles
        A value for each tip.

    Raises
    ------
    InputError
        If the arrays differ in length or a number is not finite.
    """
    d, f = _columns(displacement, force)
    rows = tip_rows(d, f) if tips is None else _checked_tips(tips, d.size)
    works = work(d, f) if done is None else columns(("displacement", "work"), d, done, least=0)[1]
    before = np.concatenate(([0], rows[:-1])) if rows.size else rows
    sides = np.sign(d[rows] - d[before])
    # Work up to the zeros of force: before the first tip, between two tips, after the last.
    zeros = np.empty(rows.size + 1)
    peaks = np.empty(rows.size)
    zeros[0] = 0.0
    for i, (first, last, side) in enumerate(zip(before, rows, sides, strict=True)):
        peaks[i] = side * np.max(side * f[first : last + 1])
        if i > 0:
            zeros[i] = _work_to_zero(d, f, works, first, last, side)
    if rows.size:
        zeros[-1] = _work_to_zero(d, f, works, rows[-1], d.size - 1, -sides[-1])
    product = f[rows] * d[rows]
    carries = product > 0
    safe = np.where(carries, product, 1.0)
    energy = np.diff(zeros)
    return HalfCycles(
        row=rows,
        displacement=d[rows],
        force=f[rows],
        peak_force=peaks,
        energy=energy,
        stiffness=np.where(carries, safe / np.where(carries, d[rows], 1.0) ** 2, np.nan),
        damping=np.where(carries, energy / (np.pi * safe), np.nan),
    )


def tip_rows(d: Array, f: Array) -> np.ndarray:
    """Return the turning points, and the last row if the curve is still loaded outwards there."""
    turns = turning_points(d)
    last = d.size - 1
    if last < 1:
        return turns
    side = d[last] - d[turns[-1] if turns.size else 0]
    if side * f[last] > 0 and side * d[last] > 0:
        return np.append(turns, last)
    return turns


def _work_to_zero(d: Array, f: Array, done: Array, first: int, last: int, side: float) -> float:
    """Return the work up to where the force takes the sign `side` between two rows."""
    swing = side * f[first : last + 1]
    if swing.size == 0:
        return float(done[first])
    at = int(np.argmax(swing >= 0))
    if swing[at] < 0:
        # It never does; take the row where it comes nearest.
        return float(done[first + int(np.argmax(swing))])
    row = first + at
    if at == 0:
        return float(done[row])
    share = swing[at - 1] / (swing[at - 1] - swing[at])
    return float(done[row - 1] + 0.5 * f[row - 1] * share * (d[row] - d[row - 1]))


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
    x, y = _to_side(displacement, force, side)
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


def envelope(displacement: ArrayLike, force: ArrayLike, side: int) -> tuple[Array, Array, Array]:
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
    x, y = _to_side(displacement, force, side)
    places, xs, ys = ([part] for part in beyond(displacement, force, side))
    so_far = np.maximum.accumulate(np.concatenate(([0.0], x)))
    if x.size >= 2:
        turns = [0, *turning_points(displacement).tolist(), x.size - 1]
        for first, last in pairwise(turns):
            reach = so_far[first + 1]
            if x[first] < x[last] <= reach and x[last] >= _NEARLY * reach:
                place, at, most = _largest_beyond(x, y, (first, last), _NEARLY * reach)
                places.append(np.array([place]))
                xs.append(np.array([at]))
                ys.append(np.array([most]))
    place, order = np.unique(np.concatenate(places), return_index=True)
    return place, np.concatenate(xs)[order], np.concatenate(ys)[order]


def _largest_beyond(
    x: Array, y: Array, rows: tuple[int, int], least: float
) -> tuple[float, float, float]:
    """Return the point of the largest force between two rows where x is at least so large."""
    first, last = rows
    x, y = x[first : last + 1], y[first : last + 1]
    place, force = np.flatnonzero(x >= least).astype(np.float64), y[x >= least]
    # Where the curve crosses that displacement.
    row = np.flatnonzero((x[1:] >= least) != (x[:-1] >= least))
    share = (least - x[row]) / (x[row + 1] - x[row])
    place = np.concatenate((place, row + share))
    force = np.concatenate((force, y[row] + share * (y[row + 1] - y[row])))
    at = int(np.argmax(force))
    return first + place[at], float(np.interp(place[at], np.arange(x.size), x)), float(force[at])


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
    if not 0 < _core.number(share, "share") < 1:
        raise InputError(f"share = {share} must be above 0 and below 1")
    found = (math.nan, math.nan)
    turns = turning_points(displacement)
    sides = [envelope(displacement, force, side) for side in (1, -1)]
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
    if _core.whole(side, "side") not in (1, -1):
        raise InputError(f"side = {side!r} must be 1 or -1")
    d, f = _columns(displacement, force)
    return side * d, side * f


def _columns(displacement: ArrayLike, force: ArrayLike) -> tuple[Array, Array]:
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    return d, f


def _checked_tips(tips: ArrayLike, rows: int) -> NDArray[np.intp]:
    """Return rows of tips as the user gave them."""
    given = _core.finite_vector(tips, "tips")
    if (given != np.round(given)).any() or (np.diff(given) <= 0).any():
        raise InputError("tips must be numbers of rows that ascend")
    if given.size and not (given[0] >= 0 and given[-1] < rows):
        raise InputError(f"tips must be from 0 to {rows - 1}")
    return given.astype(np.intp)
