"""Two straight lines in place of an envelope, by the definitions of codes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._core import Array
from rbsdem.errors import InputError

__all__ = ["IDEALISATIONS", "Idealisation", "Method", "crossing", "idealise"]

Method = Literal["asce_41", "ec_8", "park", "equal_energy"]

IDEALISATIONS: tuple[Method, ...] = get_args(Method)
"""Names of the definitions."""

_SOURCES: dict[str, str] = {
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


def idealise(x: Array, y: Array, method: str, end: float | None = None) -> Idealisation:
    """Return the two lines of an envelope that begins at zero; see `Envelope.idealise`."""
    _arguments.choice(method, "method", IDEALISATIONS)
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
    fall = crossing(x, y, (1 - _LOSS) * y[top], falling=True)
    lost = not math.isnan(fall)
    ultimate = fall if lost else float(x[-1])
    if method == "asce_41":
        points = _asce_41(x, y, limit)
    elif method == "ec_8":
        points = _ec_8(x, y, limit)
    elif method == "park":
        at = crossing(x, y, 0.75 * y[top]) / 0.75
        points = (at, y[top], max(at, ultimate), y[top])
    else:
        points = _equal_energy(x, y, ultimate)
    numbers = tuple(float(value) for value in points)
    return Idealisation(method, _SOURCES[method], *numbers, ultimate, lost)


def crossing(x: Array, y: Array, level: float, *, falling: bool = False) -> float:
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


def area(x: Array, y: Array, end: float) -> float:
    """Return the area below a curve up to a displacement."""
    inside = x < end
    xs = np.append(x[inside], end)
    ys = np.append(y[inside], np.interp(end, x, y))
    return float(np.sum(0.5 * (ys[1:] + ys[:-1]) * np.diff(xs)))


def _asce_41(x: Array, y: Array, end: float) -> tuple[float, float, float, float]:
    """Return the lines with equal areas whose first one goes through 0.6 of the yield force.

    With a point (u, v) of the envelope at 0.6 of the yield force, the area of the lines is
    (v end/0.6 + last end - last u/0.6)/2. Those points where it is that of the envelope lie on a
    straight line, parallel to the chord; of all of them the highest is taken.
    """
    xs = np.append(x[x < end], end)
    ys = np.append(y[x < end], np.interp(end, x, y))
    total, last, reach = area(x, y, end), float(ys[-1]), float(ys.max())
    # Corners where the bounds are: at <= end, and no more force than the envelope has.
    more = np.array([0.6 * end, crossing(xs, ys, 0.6 * reach)])
    corners = np.union1d(xs, more)
    force = np.interp(corners, xs, ys)
    off = end * force - last * corners - 0.6 * (2.0 * total - last * end)
    off[np.abs(off) <= 1e-12 * end * reach] = 0.0
    crossed = np.flatnonzero(off[:-1] * off[1:] < 0)
    share = off[crossed] / (off[crossed] - off[crossed + 1])
    u = np.append(corners[off == 0], corners[crossed] + share * np.diff(corners)[crossed]) / 0.6
    v = np.interp(0.6 * u, xs, ys) / 0.6
    slack = 1.0 + 1e-9
    found = [
        (top, at)
        for at, top in zip(u.tolist(), v.tolist(), strict=True)
        if 0 < at <= end * slack and 0 < top <= reach * slack
    ]
    if not found:
        raise InputError(
            "ASCE 41, 7.4.3.2.4: no two lines through the envelope at 0.6 of the yield force have "
            f"its area up to end = {end:g} m; choose another end or another method"
        )
    top, at = max(found)
    return min(at, end), top, end, last


def _ec_8(x: Array, y: Array, end: float) -> tuple[float, float, float, float]:
    force = float(np.interp(end, x, y))
    if not force > 0:
        raise InputError(f"the envelope has no force at end = {end:g} m; choose another end")
    at = 2.0 * (end - area(x, y, end) / force)
    if not 0 < at <= end * (1 + 1e-12):
        raise InputError(
            "EN 1998-1, B.3, finds no yield point: the envelope lies too far above its force at "
            f"end = {end:g} m; choose an end at or before the peak"
        )
    return min(at, end), force, end, force


def _equal_energy(x: Array, y: Array, end: float) -> tuple[float, float, float, float]:
    top = float(y.max())
    stiffness = 0.4 * top / crossing(x, y, 0.4 * top)
    root = end**2 - 2.0 * area(x, y, end) / stiffness
    force = stiffness * (end - math.sqrt(root)) if root >= 0 else 0.85 * top
    at = min(force / stiffness, end)
    return at, force, end, force
