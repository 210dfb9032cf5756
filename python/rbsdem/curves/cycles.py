"""Cycle by cycle: turning points, energy, stiffness, damping.

A half-cycle belongs to a turning point of the displacement, its tip. It lasts from where the force
changes its sign before the tip to where it does so after it. The work between the two is taken for
the energy dissipated: one elastic spring stores nothing at zero force. Under P-Delta and in layered
joints some stays stored there, in moments without a lateral force. Each curve has its own zeros of
force; the tips are those of the displacement, which a test and a model driven through it share.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike, NDArray
from rbsdem.curves.metrics import columns, work
from rbsdem.errors import InputError

TURN = 0.02
"""Share of its largest absolute value by which a displacement turns back at a turning point."""


_OF_A_CYCLE = ("displacement m", "force N", "peak_force N", "energy J", "stiffness N/m")


@dataclass(frozen=True, repr=False, slots=True, eq=False)
class HalfCycles(Tabular):
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

    _columns = ("row", *_OF_A_CYCLE, "damping")

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
    d = _arguments.finite_vector(displacement, "displacement")
    _arguments.number(share, "share", least=0, most=1)
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
    stiffness = np.where(carries, safe / np.where(carries, d[rows], 1.0) ** 2, np.nan)
    damping = np.where(carries, energy / (np.pi * safe), np.nan)
    return HalfCycles(rows, d[rows], f[rows], peaks, energy, stiffness, damping)


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


def _columns(displacement: ArrayLike, force: ArrayLike) -> tuple[Array, Array]:
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    return d, f


def _checked_tips(tips: ArrayLike, rows: int) -> NDArray[np.intp]:
    """Return rows of tips as the user gave them."""
    given = _arguments.finite_vector(tips, "tips")
    if (given != np.round(given)).any() or (np.diff(given) <= 0).any():
        raise InputError("tips must be numbers of rows that ascend")
    if given.size and not (given[0] >= 0 and given[-1] < rows):
        raise InputError(f"tips must be from 0 to {rows - 1}")
    return given.astype(np.intp)
