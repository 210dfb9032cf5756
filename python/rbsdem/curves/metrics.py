"""Curves in numbers: peaks, energy, stiffness, and points along the path of a test.

The definitions are those of `rbsdem.curves`. Every function takes plain arrays in any
consistent units (SI inside rbsdem); row i of each array is the same moment of the test.

A half-cycle belongs to a turning point of the displacement, its tip. It lasts from where the force
changes its sign before the tip to where it does so after it. The work between the two is taken for
the energy dissipated: one elastic spring stores nothing at zero force. Under P-Delta and in layered
joints some stays stored there, in moments without a lateral force. Each curve has its own zeros of
force; the tips are those of the displacement, which a test and a model driven through it share.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol, TypeAlias

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike, NDArray
from rbsdem.errors import InputError


class HasLoop(Protocol):
    """Anything with a loop, such as a `rbsdem.Result` or a test from `rbsdem.peer.read_peer`."""

    @property
    def displacement(self) -> Array:
        """Displacement, row by row [m]."""

    @property
    def force(self) -> Array:
        """Force, row by row [N]."""


Curve: TypeAlias = HasLoop | tuple[ArrayLike, ArrayLike]


def loop_pair(curve: Any, name: str) -> tuple[Any, Any]:
    """Return displacement and force of a loop: of a response in time its base shear; see `pair`."""
    if hasattr(curve, "loop_force"):
        return curve.path.displacement, curve.path.loop_force
    return pair(curve, name)


def pair(curve: Any, name: str) -> tuple[Any, Any]:
    """Return displacement and force of an object that has both, or of a pair.

    Parameters
    ----------
    curve : Curve
        The object or the pair.
    name : str
        Its name in messages.

    Raises
    ------
    InputError
        If it is neither.
    """
    if hasattr(curve, "displacement") and hasattr(curve, "force"):
        return curve.displacement, curve.force
    try:
        displacement, force = curve
    except (TypeError, ValueError):
        raise InputError(
            f"{name} is neither an object with displacement and force nor a pair of the two"
        ) from None
    return displacement, force


def columns(names: tuple[str, ...], *values: ArrayLike, least: int = 2) -> list[Array]:
    """Return arrays of finite numbers, all of the same length.

    Parameters
    ----------
    names : tuple of str
        Names of the arrays in messages.
    *values : array_like, shape (rows,)
        The arrays.
    least : int, default 2
        Smallest number of rows.

    Raises
    ------
    InputError
        If a value is not a finite number, the lengths differ, or there are fewer rows.
    """
    arrays = [
        _arguments.finite_vector(value, name) for name, value in zip(names, values, strict=True)
    ]
    first = arrays[0].size
    for name, array in zip(names, arrays, strict=True):
        if array.size != first:
            raise InputError(
                f"{name} has {array.size} rows, {names[0]} has {first}; they must be equal"
            )
    if first < least:
        raise InputError(f"{names[0]} has {first} rows; a curve needs at least {least}")
    return arrays


N_POINTS = 2000
"""Points along the path at which the error between two curves is taken."""

STIFFNESS_LEVEL = 0.7
"""Share of its peak force at which the secant stiffness of a curve is taken."""


@dataclass(frozen=True, slots=True)
class Loop:
    """One force-displacement curve in numbers; NaN for a curve without rows.

    Attributes
    ----------
    peak_force : float
        Largest absolute force, unsigned [N].
    displacement_at_peak : float
        Displacement at the first row with that force, signed [m].
    peak_displacement : float
        Largest absolute displacement, unsigned [m].
    energy : float
        Work of the force over the path [J].
    stiffness : float
        Secant from the origin to the first crossing of 70 % of the peak force [N/m]; NaN if that
        point is at no displacement, or at a displacement of the other sign.
    """

    peak_force: float
    displacement_at_peak: float
    peak_displacement: float
    energy: float
    stiffness: float


#: Points along a path at the most.
_MOST_POINTS = 10_000_000


class PathPoints:
    """Points spaced evenly along the path of what drives a model.

    The path is the sum of the absolute steps of the driver. Of rows without a step only the first
    counts.

    Parameters
    ----------
    driver : array_like, shape (rows,)
        The driver of the model: the displacement, or the force.
    n : int, default 2000
        How many points.
    name : str
        Name of the driver in messages.

    Attributes
    ----------
    path : ndarray, shape (n,)
        The path at the points.
    row_path : ndarray, shape (rows,)
        The path at the rows.
    before : ndarray of int, shape (n,)
        Row from which each point is interpolated.

    Raises
    ------
    InputError
        If a value is not a finite number, there are fewer than two rows or points, or the driver
        never moves.
    """

    def __init__(self, driver: ArrayLike, n: int = N_POINTS, name: str = "driver") -> None:
        (d,) = columns((name,), driver)
        _arguments.integer(n, "resample: n", least=2, most=_MOST_POINTS)
        self.row_path = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(d)))))
        if not self.row_path[-1] > 0:
            raise InputError(f"{name} is {d[0]:g} in every row; a loop needs a {name} that changes")
        self.path = np.linspace(0.0, self.row_path[-1], n)
        rows = np.flatnonzero(np.concatenate(([True], np.diff(self.row_path) > 0)))
        interval = np.searchsorted(self.row_path[rows], self.path, side="right") - 1
        interval = np.clip(interval, 0, rows.size - 2)
        self.before, self._after = rows[interval], rows[interval + 1]
        start = self.row_path[self.before]
        self._share = (self.path - start) / (self.row_path[self._after] - start)

    def __call__(self, curve: Array) -> Array:
        """Return a curve at the points, interpolated linearly between its rows.

        Parameters
        ----------
        curve : ndarray, shape (rows,)
            A value for each row of the driver.
        """
        before = curve[self.before]
        return np.asarray(before + self._share * (curve[self._after] - before))

    def reached(self, rows: int) -> np.ndarray:
        """Return which points lie within the first `rows` rows, as an array of bool."""
        end = self.row_path[rows - 1] if rows else -1.0
        return self.path <= end * (1 + 1e-12)


def summarise(displacement: ArrayLike, force: ArrayLike) -> Loop:
    """Put one force-displacement curve into numbers.

    Parameters
    ----------
    displacement, force : array_like, shape (rows,)
        The curve, row by row [m, N].

    Returns
    -------
    Loop
        Peaks, energy and stiffness.

    Raises
    ------
    InputError
        If the arrays differ in length or a value is not a finite number.
    """
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    return loop_of(d, f)


def loop_of(d: Array, f: Array) -> Loop:
    """Do the same as `summarise` for arrays that are known to be sound."""
    if not d.size:
        return Loop(math.nan, math.nan, math.nan, math.nan, math.nan)
    at, furthest = int(np.argmax(np.abs(f))), float(np.max(np.abs(d)))
    done, stiffness = float(work(d, f)[-1]), _secant(d, f, STIFFNESS_LEVEL)
    return Loop(float(abs(f[at])), float(d[at]), furthest, done, stiffness)


def energy(displacement: ArrayLike, force: ArrayLike) -> float:
    """Return the work of the force over the path, by the trapezium rule [J].

    Parameters
    ----------
    displacement, force : array_like, shape (rows,)
        The curve, row by row [m, N].

    Returns
    -------
    float
        The work; over a closed loop, the energy dissipated.

    Raises
    ------
    InputError
        If the arrays differ in length, hold fewer than two rows, or a value is not a finite number.
    """
    return float(work(*columns(("displacement", "force"), displacement, force))[-1])


def work(d: Array, f: Array) -> Array:
    """Return the work of the force up to each row, by the trapezium rule, shape (rows,) [J]."""
    return np.concatenate(([0.0], np.cumsum(0.5 * (f[1:] + f[:-1]) * np.diff(d))))


def secant_stiffness(
    displacement: ArrayLike, force: ArrayLike, *, level: float = STIFFNESS_LEVEL
) -> float:
    """Return the slope from the origin to the first point at a share of the peak force [N/m].

    Parameters
    ----------
    displacement, force : array_like, shape (rows,)
        The curve, row by row [m, N].
    level : float, default 0.7
        Share of the largest absolute force of the curve, above 0 and up to 1. Everything that
        rbsdem reports takes 0.7.

    Returns
    -------
    float
        The stiffness; NaN if the point is at no displacement or at one of the other sign, or if
        there is no force at all.

    Raises
    ------
    InputError
        If the arrays differ in length, hold fewer than two rows, a value is not a finite number,
        or `level` is outside its range.
    """
    d, f = columns(("displacement", "force"), displacement, force)
    return _secant(d, f, _arguments.number(level, "level", above=0, most=1))


def resample(
    driver: ArrayLike, *curves: ArrayLike, n: int = N_POINTS, name: str = "driver"
) -> tuple[Array, ...]:
    """Interpolate curves at points spaced evenly along the path of what drives them.

    Parameters
    ----------
    driver : array_like, shape (rows,)
        The driver of the model; its path is the sum of its absolute steps.
    *curves : array_like, shape (rows,)
        Values to interpolate. Of rows without a step of the driver only the first counts.
    n : int, default 2000
        How many points.
    name : str
        Name of the driver in messages.

    Returns
    -------
    tuple of ndarray, shape (n,)
        The path at the points, then each curve there.

    Raises
    ------
    InputError
        If lengths differ, a value is not a finite number, the driver never moves, or n is below 2.
    """
    names = (name, *(f"curve {i + 1}" for i in range(len(curves))))
    d, *ys = columns(names, driver, *curves)
    points = PathPoints(d, n, name)
    return (points.path, *(points(y) for y in ys))


def rms(values: Array) -> float:
    """Return the root mean square of the values."""
    return float(np.sqrt(np.mean(values * values)))


def ratio(model: float, test: float) -> float:
    """Return model over test; NaN if the test has 0."""
    return model / test if test != 0 else math.nan


def _secant(d: Array, f: Array, level: float) -> float:
    """Return the secant to the first point at a share of the peak force [N/m]; NaN without one."""
    size = np.abs(f)
    target = level * float(np.max(size))
    if not target > 0:
        return math.nan
    i = int(np.argmax(size >= target))
    at, force = float(d[i]), float(f[i])
    if i > 0:
        # The row before lies below the target on both sides of zero force.
        force = float(np.sign(f[i])) * target
        at = float(d[i - 1] + (force - f[i - 1]) / (f[i] - f[i - 1]) * (d[i] - d[i - 1]))
    return force / at if at != 0 and force / at > 0 else math.nan


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


def _work_to_zero(d: Array, f: Array, works: Array, first: int, last: int, side: float) -> float:
    """Return the work up to where the force takes the sign `side` in rows `first` to `last`.

    `works` has the work up to each row.
    """
    swing = side * f[first : last + 1]
    if swing.size == 0:
        return float(works[first])
    at = int(np.argmax(swing >= 0))
    if swing[at] < 0:
        # It never does; take the row where it comes nearest.
        return float(works[first + int(np.argmax(swing))])
    row = first + at
    if at == 0:
        return float(works[row])
    share = swing[at - 1] / (swing[at - 1] - swing[at])
    return float(works[row - 1] + 0.5 * f[row - 1] * share * (d[row] - d[row - 1]))


def _columns(displacement: ArrayLike, force: ArrayLike) -> tuple[Array, Array]:
    """Return checked displacements and forces, which may be empty."""
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    return d, f


def _checked_tips(tips: ArrayLike, rows: int) -> NDArray[np.intp]:
    """Return rows of tips as the user gave them."""
    numbers = _arguments.finite_vector(tips, "tips")
    if (numbers != np.round(numbers)).any() or (np.diff(numbers) <= 0).any():
        raise InputError("tips must be numbers of rows that ascend")
    if numbers.size and not (numbers[0] >= 0 and numbers[-1] < rows):
        raise InputError(f"tips must be from 0 to {rows - 1}")
    return numbers.astype(np.intp)
