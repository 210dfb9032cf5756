"""The envelope of a cyclic curve to one side, two lines in its place, and the loss of strength."""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike
from rbsdem.curves.metrics import Curve, columns, loop_pair, turning_points
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
    row : ndarray, shape (k,)
        Numbers of the rows; 3.5 is half way between rows 3 and 4.
    displacement, force : ndarray, shape (k,)
        Values at these rows, with their sign on that side [m, N].

    Raises
    ------
    InputError
        If the arrays differ in length or a number is not finite, or if `side` is neither.
    """
    return _beyond(*_to_side(displacement, force, side))


def _beyond(x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Return the parts of `beyond` for a path to the positive side: rows, places x, forces y.

    Row 3.5 is half way between rows 3 and 4.
    """
    so_far = np.maximum.accumulate(np.concatenate(([0.0], x)))[:-1]
    rows = np.flatnonzero(x > so_far)
    after = rows[rows > 0]
    share = (so_far[after] - x[after - 1]) / (x[after] - x[after - 1])
    force_there = y[after - 1] + share * (y[after] - y[after - 1])
    number = np.concatenate((rows.astype(np.float64), after - 1 + share))
    # If the row before is itself beyond, the crossing is that row and stands once.
    number, at = np.unique(number, return_index=True)
    return (
        number,
        np.concatenate((x[rows], so_far[after]))[at],
        np.concatenate((y[rows], force_there))[at],
    )


def _envelope(x: Array, y: Array, turns: np.ndarray) -> tuple[Array, Array, Array]:
    """Return what `_beyond` returns, and the largest force of each leg that nearly gets there.

    A leg goes from one turning point to the next (`turns`); it nearly gets there if it reaches 0.95
    of the largest displacement so far.
    """
    numbers, xs, ys = ([part] for part in _beyond(x, y))
    so_far = np.maximum.accumulate(np.concatenate(([0.0], x)))
    if x.size >= 2:
        for first, last in pairwise([0, *turns.tolist(), x.size - 1]):
            reach = so_far[first + 1]
            if x[first] < x[last] <= reach and x[last] >= _NEARLY * reach:
                row, at, most = _largest_beyond(x, y, (first, last), _NEARLY * reach)
                numbers.append(np.array([row]))
                xs.append(np.array([at]))
                ys.append(np.array([most]))
    if len(numbers) == 1:
        return numbers[0], xs[0], ys[0]
    rows, order = np.unique(np.concatenate(numbers), return_index=True)
    return rows, np.concatenate(xs)[order], np.concatenate(ys)[order]


def _largest_beyond(
    x: Array, y: Array, rows: tuple[int, int], least: float
) -> tuple[float, float, float]:
    """Return row, x and y of the largest force between two rows where x is at least `least`."""
    first, last = rows
    x, y = x[first : last + 1], y[first : last + 1]
    inside = x >= least
    near = inside.nonzero()[0]
    row = near[y[near].argmax()]
    largest = float(row), float(x[row]), float(y[row])
    # Where the curve comes to that displacement or leaves it, the force may be more than at a row.
    for row in (inside[1:] != inside[:-1]).nonzero()[0].tolist():
        share = float((least - x[row]) / (x[row + 1] - x[row]))
        there = float(y[row] + share * (y[row + 1] - y[row]))
        if there > largest[2]:
            largest = row + share, least, there
    return first + largest[0], largest[1], largest[2]


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
    row : float
        Number of the row there; 3.5 is half way between rows 3 and 4. If the loss lies between two
        points of the envelope that are no neighbours on the curve, the row of the later one. NaN
        without a loss.
    displacement : float
        That of `strength_loss`.

    Raises
    ------
    InputError
        As `strength_loss`.
    """
    _arguments.number(share, "share", above=0, below=1)
    point = (math.nan, math.nan)
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    turns = turning_points(d)
    sides = [_envelope(side * d, side * f, turns) for side in (1, -1)]
    # A side whose largest force is less than half of that of the other side is not looked at.
    largest = max((np.max(y) for _, _, y in sides if y.size), default=0)
    for number, x, y in sides:
        if not y.size or 2 * np.max(y) < largest or not np.max(y) > 0:
            continue
        peak = int(np.argmax(y))
        left = (1 - share) * y[peak]
        half_cycle = np.searchsorted(turns, number)
        reached = _still_reached(y, half_cycle)
        lost = np.flatnonzero(reached[peak:] <= left)
        if not lost.size:
            continue
        at = peak + int(lost[0])
        # In a half-cycle the force falls on its line; from one to the next, to what that reaches.
        lower = y[at] if half_cycle[at] == half_cycle[at - 1] else reached[at]
        part = (y[at - 1] - left) / (y[at - 1] - lower)
        apart = number[at] - number[at - 1]
        found_row = number[at - 1] + part * apart if apart <= 1 else number[at]
        if not point[0] <= found_row:
            point = float(found_row), float(x[at - 1] + part * (x[at] - x[at - 1]))
    return point


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
    """Return a curve whose side that is asked for is the positive one."""
    if _arguments.integer(side, "side") not in (1, -1):
        raise InputError(f"side = {side!r} must be 1 or -1")
    d, f = columns(("displacement", "force"), displacement, force, least=0)
    return side * d, side * f


Method = Literal["asce_41", "ec_8", "park", "equal_energy"]

IDEALISATIONS: tuple[Method, ...] = get_args(Method)
"""Names of the definitions."""

#: Where each definition comes from.
SOURCES: dict[str, str] = {
    "asce_41": "ASCE 41-17, 7.4.3.2.4",
    "ec_8": "EN 1998-1:2004, B.3",
    "park": "Park 1988, 0.75 of the peak force",
    "equal_energy": "ASTM E2126, equivalent energy",
}

_LOSS = 0.2
"""Share of the strength whose loss ends an envelope (Park; ASTM E2126)."""


@dataclass(frozen=True)
class Idealisation:
    """An envelope as two straight lines: from zero to the yield point, and on to the end.

    Attributes
    ----------
    method, source : str
        Name of the definition, and where it comes from.
    yield_displacement, yield_force : float
        The yield point [m, N].
    end_displacement, end_force : float
        End of the second line [m, N].
    ultimate_displacement : float
        Where 20 % of the strength is lost, or the last point of the envelope if it does not lose
        so much [m].
    lost : bool
        Whether 20 % of the strength is lost.
    """

    method: str
    source: str
    yield_displacement: float
    yield_force: float
    end_displacement: float
    end_force: float
    ultimate_displacement: float
    lost: bool

    @property
    def stiffness(self) -> float:
        """Slope of the first line [N/m]."""
        return self.yield_force / self.yield_displacement

    @property
    def post_yield_ratio(self) -> float:
        """Slope of the second line over that of the first; 0 where there is no second line."""
        length = self.end_displacement - self.yield_displacement
        if not length > 0:
            return 0.0
        return (self.end_force - self.yield_force) / length / self.stiffness

    @property
    def ductility(self) -> float:
        """Ultimate displacement over that at yield."""
        return self.ultimate_displacement / self.yield_displacement

    def force(self, displacement: Array) -> Array:
        """Return the force of the two lines at displacements up to the end [N]."""
        x = (0.0, self.yield_displacement, self.end_displacement)
        return np.interp(displacement, x, (0.0, self.yield_force, self.end_force))


@dataclass(frozen=True, repr=False, eq=False)
class Envelope(Tabular):
    """The envelope of a curve to one side, from zero; displacements and forces are unsigned.

    Attributes
    ----------
    side : {1, -1}
        The side of the displacement.
    displacement : ndarray, shape (k,)
        Ascending from 0 [m]; twice the same where the force falls from one cycle to the next.
    force : ndarray, shape (k,)
        Forces there [N].
    """

    _columns = ("displacement m", "force N")

    side: int
    displacement: Array
    force: Array

    @property
    def peak_force(self) -> float:
        """Largest force [N]."""
        return float(self.force.max())

    @property
    def displacement_at_peak(self) -> float:
        """Displacement at the largest force [m]."""
        return float(self.displacement[self.force.argmax()])

    @property
    def largest_displacement(self) -> float:
        """Displacement of the last point [m]."""
        return float(self.displacement[-1])

    def force_at(self, displacement: float) -> float:
        """Return the force at a displacement [N], linear between points.

        Parameters
        ----------
        displacement : float
            From 0 to that of the last point [m].

        Raises
        ------
        InputError
            If it is beyond the envelope.
        """
        if not 0 <= displacement <= self.largest_displacement:
            raise InputError(
                f"displacement = {displacement:g} m must be from 0 to the end of the envelope, "
                f"{self.largest_displacement:g} m"
            )
        return float(np.interp(displacement, self.displacement, self.force))

    def displacement_at(self, share: float, *, falling: bool = False) -> float:
        """Return where the force reaches a share of its peak [m].

        Parameters
        ----------
        share : float
            Share of the peak force, above 0 and up to 1.
        falling : bool, optional
            Behind the peak, where the force is down to the share, instead of before it.

        Returns
        -------
        float
            The displacement; NaN if the force does not fall so far.
        """
        _arguments.number(share, "share", above=0, most=1)
        return _crossing(self.displacement, self.force, share * self.peak_force, falling=falling)

    def idealise(self, method: Method = "asce_41", *, end: float | None = None) -> Idealisation:
        """Replace the envelope by two straight lines.

        Parameters
        ----------
        method : {"asce_41", "ec_8", "park", "equal_energy"}, optional
            "asce_41": ASCE 41-17, 7.4.3.2.4: initial line through 0.6 of the yield force, equal
            areas up to `end`; of several such yield forces, none above the largest force, the
            highest. "ec_8": EN 1998-1:2004, B.3: elastic and perfectly plastic, the force
            at `end`, equal areas. "park": Park 1988: secant through 0.75 of the peak force,
            extended to it. "equal_energy": ASTM E2126: secant through 0.4 of the peak force, equal
            areas up to a loss of 20 %.
        end : float, optional
            Displacement up to which areas are equal [m], for "asce_41" and "ec_8"; by default that
            of the peak force.

        Returns
        -------
        Idealisation
            Yield point, stiffness, end and ductility.

        Raises
        ------
        InputError
            If the method is not known, or the envelope has no such lines.
        """
        return _idealise(self.displacement, self.force, method, end)

    def __repr__(self) -> str:
        return (
            f"Envelope({'+' if self.side > 0 else '-'}, peak {self.peak_force:.4g} N at "
            f"{self.displacement_at_peak:.4g} m, up to {self.largest_displacement:.4g} m)"
        )


def envelope(curve: Curve, side: Literal[1, -1] = 1) -> Envelope:
    """Return the envelope of a cyclic curve to one side.

    Of the curve those parts are kept that go beyond the largest displacement so far, from where
    they cross it; of a test with noise these are many points, of a static path its corners.

    Parameters
    ----------
    curve : Result, PeerTest or pair of arrays
        Displacement [m] and force [N]. Of a response in time the base shear is taken.
    side : {1, -1}, optional
        The side of the displacement.

    Raises
    ------
    InputError
        If the curve has no displacement with a force to that side.
    """
    d, f = columns(("displacement", "force"), *loop_pair(curve, "the curve"))
    _, x, y = beyond(d, f, side)
    if x.size == 0 or not y.max() > 0:
        way = "positive" if side > 0 else "negative"
        raise InputError(
            f"the curve has no force against a {way} displacement; an envelope needs one to that "
            f"side, so give side = {-side} or another curve"
        )
    return Envelope(side, np.concatenate(([0.0], x)), np.concatenate(([0.0], y)))


def _idealise(x: Array, y: Array, method: str, end: float | None = None) -> Idealisation:
    """Return the two lines of an envelope that begins at zero; see `Envelope.idealise`."""
    method = _arguments.choice(method, "method", IDEALISATIONS)
    if end is not None and method not in ("asce_41", "ec_8"):
        raise InputError(f"method = {method!r} has an end of its own; leave out end")
    top = int(np.argmax(y))
    if not (y[top] > 0 and x[top] > 0):
        raise InputError("the envelope has no force; it cannot be idealised")
    limit = x[top] if end is None else _arguments.number(end, "end")
    if not 0 < limit <= x[-1]:
        raise InputError(
            f"end = {limit:g} m must be above 0 and up to the end of the envelope, {x[-1]:g} m"
        )
    fall = _crossing(x, y, (1 - _LOSS) * y[top], falling=True)
    lost = not math.isnan(fall)
    ultimate = fall if lost else float(x[-1])
    if method == "asce_41":
        points = _asce_41(*_up_to(x, y, limit))
    elif method == "ec_8":
        points = _ec_8(*_up_to(x, y, limit))
    elif method == "park":
        at = _crossing(x, y, 0.75 * y[top]) / 0.75
        points = (at, y[top], max(at, ultimate), y[top])
    else:
        points = _equal_energy(*_up_to(x, y, ultimate), float(y[top]))
    at, force, end_at, end_force = (float(value) for value in points)
    if not at > 0:
        raise InputError("the envelope has its force at zero displacement; it has no first line")
    source = SOURCES[method]
    return Idealisation(method, source, at, force, end_at, end_force, ultimate, lost)


def _crossing(x: Array, y: Array, level: float, *, falling: bool = False) -> float:
    """Return where a curve first reaches a level, or falls to it behind its peak; else NaN."""
    top = int(np.argmax(y))
    if falling:
        below = np.flatnonzero(y[top:] <= level)
        if below.size == 0:
            return math.nan
        at = top + int(below[0])
    else:
        at = int(np.flatnonzero(y >= level)[0])
    if at == 0 or y[at] == y[at - 1]:
        return float(x[at])
    share = (level - y[at - 1]) / (y[at] - y[at - 1])
    return float(x[at - 1] + share * (x[at] - x[at - 1]))


def _up_to(x: Array, y: Array, end: float) -> tuple[Array, Array]:
    """Return a curve up to a displacement, where it steps there up to the larger force."""
    first, after = np.searchsorted(x, end, side="left"), np.searchsorted(x, end, side="right")
    if first < after:
        last = int(first + np.argmax(y[first:after])) + 1
        return x[:last], y[:last]
    return np.append(x[:first], end), np.append(y[:first], np.interp(end, x, y))


def _area(x: Array, y: Array) -> float:
    """Return the area below a curve."""
    return float(np.sum(0.5 * (y[1:] + y[:-1]) * np.diff(x)))


def _asce_41(x: Array, y: Array) -> tuple[float, float, float, float]:
    """Return the lines with equal areas whose first one goes through 0.6 of the yield force.

    With a point (u, v) of the envelope at 0.6 of the yield force, the area of the lines is
    (v end/0.6 + last end - last u/0.6)/2, with the displacement `end` and the force `last` of the
    last point. The points (u, v) for which this area equals that of the envelope lie on a straight
    line, parallel to the chord; `off` is how far the rows are off it. If the envelope meets it
    several times, the lines with the least area between them and the envelope are taken, as the
    standard balances the areas above and below.
    """
    total, end, last, reach = _area(x, y), float(x[-1]), float(y[-1]), float(y.max())
    off = end * y - last * x - 0.6 * (2.0 * total - last * end)
    off[np.abs(off) <= 1e-12 * end * reach] = 0.0
    low, high = off[:-1], off[1:]
    # On a part of the envelope that lies on that line, the furthest point whose yield point is not
    # beyond the end nor above the largest force.
    along, up = np.diff(x), np.diff(y)
    with np.errstate(divide="ignore", invalid="ignore"):
        room = np.minimum(
            np.where(along > 0, (0.6 * end - x[:-1]) / along, 1.0),
            np.where(up > 0, (0.6 * reach - y[:-1]) / up, 1.0),
        )
        share = np.where(low == high, np.clip(room, 0.0, 1.0), low / (low - high))
    met = np.flatnonzero((low == high) & (low == 0) | (low * high < 0) | (high == 0))
    at = (x[:-1] + share * along)[met] / 0.6
    force = (y[:-1] + share * up)[met] / 0.6
    slack = 1.0 + 1e-9
    good = (at > 0) & (at <= end * slack) & (force > 0) & (force <= reach * slack)
    if not good.any():
        raise InputError(
            "ASCE 41, 7.4.3.2.4: no two lines through the envelope at 0.6 of the yield force have "
            f"its area up to end = {end:g} m; choose another end or another method"
        )
    lines = [
        (min(knee, end), top, end, last)
        for knee, top in zip(at[good].tolist(), force[good].tolist(), strict=True)
    ]
    return min(lines, key=lambda each: (_apart(x, y, *each), -each[1]))


def _apart(x: Array, y: Array, at: float, force: float, end: float, last: float) -> float:
    """Return the area between an envelope and two lines, in size [J]."""
    u = np.union1d(x, at)
    off = np.interp(u, x, y) - np.interp(u, [0.0, at, end], [0.0, force, last])
    before, after = np.abs(off[:-1]), np.abs(off[1:])
    both = np.maximum(before + after, np.finfo(float).tiny)
    # Where the line crosses the envelope there are two triangles.
    heights = np.where(off[:-1] * off[1:] < 0, (before**2 + after**2) / both, both)
    return 0.5 * float(np.diff(u) @ heights)


def _ec_8(x: Array, y: Array) -> tuple[float, float, float, float]:
    """Return an elastic and a level line with the area of the envelope, at its last force."""
    end, force = float(x[-1]), float(y[-1])
    if not force > 0:
        raise InputError(f"the envelope has no force at end = {end:g} m; choose another end")
    at = 2.0 * (end - _area(x, y) / force)
    if not 0 < at <= end * (1 + 1e-12):
        raise InputError(
            "EN 1998-1, B.3, finds no yield point: the envelope lies too far above its force at "
            f"end = {end:g} m; choose an end at or before the peak"
        )
    return min(at, end), force, end, force


def _equal_energy(x: Array, y: Array, top: float) -> tuple[float, float, float, float]:
    """Return an elastic line through 0.4 of the peak force and a level one of the same area."""
    end = float(x[-1])
    first = _crossing(x, y, 0.4 * top)
    if not first > 0:
        return 0.0, top, end, top
    stiffness = 0.4 * top / first
    root = end**2 - 2.0 * _area(x, y) / stiffness
    force = stiffness * (end - math.sqrt(root)) if root >= 0 else 0.85 * top
    at = min(force / stiffness, end)
    return at, force, end, force
