"""The search for the intensity at which a column collapses, for many motions side by side.

Hunt and fill (Vamvatsikos and Cornell 2002): the intensity grows until the column collapses, the
last step is halved until the collapse is known closely enough, and runs below it fill the largest
gaps of the curve.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.many.runs import LOST, Collector

_SMALLEST = 1e-4
_MOST_REPAIRS = 5
_YIELD = "measure first_yield"
#: Ratio of the bounds of the first yield; closer, they count as known (`fragility.NARROW`).
_YIELD_WIDTH = 1.05


@dataclass(frozen=True)
class Hunt:
    """How collapses are searched for.

    Parameters
    ----------
    first : float, optional
        Intensity of the first run [m/s2].
    growth : float, optional
        Factor from run to run until the column collapses.
    resolution : float, optional
        Width of the interval that a collapse is known to lie in, over its intensity.
    points : int, optional
        Runs without collapse on each curve, at least.
    highest : float, optional
        Intensity at which the search ends without a collapse [m/s2].
    yielding : bool, optional
        Whether to search for the first yield of a spring too, to within 5 %, if the measure
        "first_yield" is kept.

    Raises
    ------
    InputError
        With a line for everything that is wrong.
    """

    first: float = 1.0
    growth: float = 1.5
    resolution: float = 0.02
    points: int = 10
    highest: float = 200.0
    yielding: bool = True

    def __post_init__(self) -> None:
        faults = []
        bounds = {
            "first": (0.0, 1e3),
            "growth": (1.0, 10.0),
            "resolution": (1e-6, 1.0),
            "highest": (0.0, 1e6),
        }
        for name, (least, most) in bounds.items():
            value = _arguments.number(getattr(self, name), f"hunt: {name}")
            object.__setattr__(self, name, value)
            if not least < value <= most:
                faults.append(f"hunt: {name} = {value:g} must be above {least:g}, at most {most:g}")
        _arguments.switch(self.yielding, "hunt: yielding")
        if _arguments.whole(self.points, "hunt: points") < 1 or self.points > 1000:
            faults.append(f"hunt: points = {self.points} must be from 1 to 1000")
        if not faults and self.first > self.highest:
            faults.append(f"hunt: first = {self.first:g} is above highest = {self.highest:g}")
        if faults:
            raise InputError("\n".join(faults))


def hunt_and_fill(work: Collector, hunt: Hunt) -> tuple[Array, Array]:
    """Find the collapses and fill the curves.

    Parameters
    ----------
    work : Collector
        Makes the runs and keeps them.
    hunt : Hunt
        How.

    Returns
    -------
    tuple of ndarray, shape (columns, motions)
        The highest intensity without collapse below the lowest one with a collapse, and that one;
        infinity where the column did not collapse.
    """
    shape = len(work.columns), len(work.motions)
    low, high = np.zeros(shape), np.full(shape, np.inf)
    _bracket(work, hunt, low, high)
    _narrow(work, hunt, low, high)
    for _ in range(_MOST_REPAIRS):
        if not _fill(work, hunt, low, high):
            break
        # A gap that was filled held a collapse at a lower intensity.
        _narrow(work, hunt, low, high)
    # Layered joints have no one yield point.
    known = any(_YIELD in part and np.isfinite(part[_YIELD]).any() for part in work.parts)
    if hunt.yielding and known:
        _narrow_yield(work, low)
    return low, high


def _bracket(work: Collector, hunt: Hunt, low: Array, high: Array) -> None:
    """Let the intensity grow until there is a collapse, or shrink if the first run collapsed."""
    level = np.full(low.shape, hunt.first)
    while np.isfinite(level).any():
        collapsed = work.run(level[:, :, None])[:, :, 0]
        tried = np.isfinite(level)
        high[tried & collapsed] = level[tried & collapsed]
        low[tried & ~collapsed] = level[tried & ~collapsed]
        level = np.where(tried & ~collapsed & ~np.isfinite(high), low * hunt.growth, np.nan)
        down = tried & collapsed & (low == 0)
        level = np.where(down, high / hunt.growth, level)
        level[level > hunt.highest * (1 + 1e-9)] = np.nan
        if (level[down] < _SMALLEST).any():
            raise InputError(
                f"ida: the column collapses at {_SMALLEST:g} m/s2 already; check collapse_drift "
                "and the axial load"
            )


def _narrow(work: Collector, hunt: Hunt, low: Array, high: Array) -> None:
    """Halve the intervals of the collapses, in the logarithm, until all are narrow enough."""
    while True:
        wide = np.isfinite(high) & (high - low > hunt.resolution * high)
        if not wide.any():
            return
        with np.errstate(invalid="ignore"):
            middle = np.where(low > 0, np.sqrt(low * high), 0.5 * high)
        level = np.where(wide, middle, np.nan)
        collapsed = work.run(level[:, :, None])[:, :, 0]
        high[wide & collapsed] = level[wide & collapsed]
        low[wide & ~collapsed] = level[wide & ~collapsed]


def _narrow_yield(work: Collector, low: Array) -> None:
    """Halve the intervals in which a spring yields first, below the collapses."""
    while True:
        level = np.full(low.shape, np.nan)
        for column, motion in np.ndindex(low.shape):
            tried, yielded = _yields(work, column, motion)
            if not yielded.any():
                continue
            first = tried[yielded].min()
            last = max([0.0, *tried[tried < first]])
            if first > _YIELD_WIDTH * last and first > _SMALLEST:
                level[column, motion] = np.sqrt(last * first) if last > 0 else 0.5 * first
        if np.isnan(level).all():
            return
        work.run(level[:, :, None])


def _yields(work: Collector, column: int, motion: int) -> tuple[Array, NDArray[np.bool_]]:
    """Return the intensities of the runs of a column under a motion, and which of them yielded."""
    tried, yielded = [], []
    for part in work.parts:
        own = (part["column"] == column) & (part["motion"] == motion)
        tried.append(part["intensity"][own])
        yielded.append(np.isfinite(part[_YIELD][own]) | np.isin(part["status"][own], LOST))
    return np.concatenate(tried), np.concatenate(yielded)


def _fill(work: Collector, hunt: Hunt, low: Array, high: Array) -> bool:
    """Add runs in the largest gaps below the collapses; return whether one collapsed."""
    wanted: dict[tuple[int, int], list[float]] = {}
    for column, motion in np.ndindex(low.shape):
        tried = _levels(work, column, motion)
        own = sorted({0.0, *tried[tried <= low[column, motion]].tolist()})
        added: list[float] = []
        while len(own) - 1 < hunt.points and low[column, motion] > 0:
            gap = int(np.argmax(np.diff(own)))
            added.append(0.5 * (own[gap] + own[gap + 1]))
            own.insert(gap + 1, added[-1])
        if added:
            wanted[column, motion] = added
    if not wanted:
        return False
    levels = np.full((*low.shape, max(map(len, wanted.values()))), np.nan)
    for place, values in wanted.items():
        levels[place][: len(values)] = values
    collapsed = work.run(levels)
    for column, motion in np.argwhere(collapsed.any(axis=-1)):
        first = levels[column, motion][collapsed[column, motion]].min()
        tried = _levels(work, column, motion)
        high[column, motion] = first
        low[column, motion] = max([0.0, *tried[tried < first]])
    return bool(collapsed.any())


def _levels(work: Collector, column: int, motion: int) -> Array:
    """Return the intensities that a column was run at under a motion."""
    found = [
        part["intensity"][(part["column"] == column) & (part["motion"] == motion)]
        for part in work.parts
    ]
    return np.concatenate(found)
