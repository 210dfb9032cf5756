"""Incremental dynamic analysis, and stripes: the same motions at many intensities.

The intensity at which a column collapses is searched for (Vamvatsikos and Cornell 2002, "hunt and
fill"), for many motions side by side: the intensity grows until the column collapses, the last step
is halved until the collapse is known closely enough, and runs below it fill the largest gaps. A
multiple-stripe analysis has the same intensities for all records, or records for each intensity.
"""

from __future__ import annotations

import math
import time
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._progress import progress_bar
from rbsdem._types import Array, ArrayLike, NDArray, Unpack
from rbsdem.errors import InputError
from rbsdem.many.fragility import Capacities, Counts, WithFragility
from rbsdem.many.inputs import Measure, is_switch, limit_states, measures_in_a_list
from rbsdem.many.runs import (
    LOST,
    Collector,
    RunOptions,
    Runs,
    checked_levels,
    columns_by_name,
    drift_of,
    make_collector,
    motions_by_name,
    own_records,
)
from rbsdem.motions.motion import GroundMotion, Record, is_pair
from rbsdem.section.criteria import WATCHED
from rbsdem.section.frame import Frame, Structure
from rbsdem.section.strength import AXIAL_FAILURE_FACTORS

#: Least intensity that is tried [m/s2]; how often a collapse below others is searched for anew.
_SMALLEST = 1e-4
_MOST_REPAIRS = 5
#: Ratio of the bounds of a limit state; closer, they count as known (`fragility.NARROW`).
_WIDTH = 1.05


@dataclass(frozen=True)
class CollapseSearch:
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

    def __post_init__(self) -> None:
        faults: list[str] = []
        bounds = {"first": (0.0, 1e3), "growth": (1.0, 10.0), "resolution": (1e-6, 1.0)}
        for name, (above, most) in (bounds | {"highest": (0.0, 1e6)}).items():
            with _arguments.collected(faults):
                limit = getattr(self, name)
                value = _arguments.number(limit, f"search: {name}", above=above, most=most)
                _arguments.put(self, **{name: value})
        with _arguments.collected(faults):
            _arguments.integer(self.points, "search: points", least=1, most=1000)
        if not faults and self.first > self.highest:
            faults.append(f"search: first = {self.first:g} is above highest = {self.highest:g}")
        _arguments.raise_faults(faults)


def search_collapse(
    work: Collector, search: CollapseSearch, refine: Sequence[str]
) -> tuple[Array, Array]:
    """Find the collapses and fill the curves.

    Parameters
    ----------
    work : Collector
        Makes the runs and keeps them.
    search : CollapseSearch
        How.
    refine : sequence of str
        Limit states among the measures; the intensity of each is found to within 5 %, too.

    Returns
    -------
    tuple of ndarray, shape (columns, motions)
        The highest intensity without collapse below the lowest one with a collapse, and that one;
        infinity where the column did not collapse.
    """
    low, high = np.zeros(work.shape), np.full(work.shape, np.inf)
    _bracket(work, search, low, high)
    _narrow(work, search, low, high)
    for _ in range(_MOST_REPAIRS):
        if not _fill(work, search, low, high):
            break
        # A gap that was filled held a collapse at a lower intensity.
        _narrow(work, search, low, high)
    # A column may have no such limit state, as without bars that could fracture.
    measured = (f"measure {name}" for name in refine)
    reached = [m for m in measured if any(np.isfinite(part[m]).any() for part in work.parts)]
    _narrow_states(work, low, reached)
    return low, high


def _bracket(work: Collector, search: CollapseSearch, low: Array, high: Array) -> None:
    """Let the intensity grow until there is a collapse, or shrink if the first run collapsed.

    `low` and `high` are filled: the last intensity without a collapse, and the first with one.
    """
    level = np.full(low.shape, search.first)
    while np.isfinite(level).any():
        collapsed = work.run(level[:, :, None])[:, :, 0]
        tried = np.isfinite(level)
        high[tried & collapsed] = level[tried & collapsed]
        low[tried & ~collapsed] = level[tried & ~collapsed]
        level = np.where(tried & ~collapsed & ~np.isfinite(high), low * search.growth, np.nan)
        down = tried & collapsed & (low == 0)
        level = np.where(down, high / search.growth, level)
        level[level > search.highest * (1 + 1e-9)] = np.nan
        if (level[down] < _SMALLEST).any():
            raise InputError(
                f"ida: the column collapses at {_SMALLEST:g} m/s2 already; check collapse_drift "
                "and the axial load"
            )


def _narrow(work: Collector, search: CollapseSearch, low: Array, high: Array) -> None:
    """Halve the intervals of the collapses, in the logarithm, until all are narrow enough.

    The ends of the intervals, `low` and `high`, are moved in place.
    """
    while True:
        wide = np.isfinite(high) & (high - low > search.resolution * high)
        if not wide.any():
            return
        with np.errstate(invalid="ignore"):
            middle = np.where(low > 0, np.sqrt(low * high), 0.5 * high)
        level = np.where(wide, middle, np.nan)
        collapsed = work.run(level[:, :, None])[:, :, 0]
        high[wide & collapsed] = level[wide & collapsed]
        low[wide & ~collapsed] = level[wide & ~collapsed]


def _narrow_states(work: Collector, low: Array, states: Sequence[str]) -> None:
    """Halve the intervals in which limit states are first reached, below the collapses."""
    while states:
        level = np.full((*low.shape, len(states)), np.nan)
        for column, motion in np.ndindex(low.shape):
            tried, status, *at = work.tried(column, motion, "intensity", "status", *states)
            lost = np.isin(status, LOST)
            for i, reached in enumerate(np.isfinite(each) | lost for each in at):
                if not reached.any():
                    continue
                first = tried[reached].min()
                last = max([0.0, *tried[tried < first]])
                if first > _WIDTH * last and first > _SMALLEST:
                    level[column, motion, i] = np.sqrt(last * first) if last > 0 else 0.5 * first
            # States that are first reached in one interval ask for one run.
            _, place = np.unique(level[column, motion], return_index=True)
            level[column, motion, np.setdiff1d(np.arange(len(states)), place)] = np.nan
        if np.isnan(level).all():
            return
        work.run(level)


def _fill(work: Collector, search: CollapseSearch, low: Array, high: Array) -> bool:
    """Add runs in the largest gaps below the collapses; return whether one collapsed.

    Then the interval of that collapse, in `low` and `high`, is moved down to it.
    """
    wanted: dict[tuple[int, int], list[float]] = {}
    for column, motion in np.ndindex(low.shape):
        (tried,) = work.tried(column, motion, "intensity")
        points = sorted({0.0, *tried[tried <= low[column, motion]].tolist()})
        added: list[float] = []
        while len(points) - 1 < search.points and low[column, motion] > 0:
            gap = int(np.argmax(np.diff(points)))
            added.append(0.5 * (points[gap] + points[gap + 1]))
            points.insert(gap + 1, added[-1])
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
        (tried,) = work.tried(column, motion, "intensity")
        high[column, motion] = first
        low[column, motion] = max([0.0, *tried[tried < first]])
    return bool(collapsed.any())


#: Settings that change nothing in the answer.
_OF_THE_RUN = ("initial", "jobs", "progress", "store", "shard", "client")
#: Runs that a search is expected to need for a record, as the searches of the documentation do.
_EXPECTED = 16
#: Percentages of the fractile curves.
FRACTILES = (16.0, 50.0, 84.0)


@dataclass(frozen=True, eq=False, repr=False)
class IDA(WithFragility):
    """Curves of response over intensity, one for each column and motion.

    Attributes
    ----------
    runs : Runs
        All runs with their intensity, fate and measures.
    lower, upper : ndarray, shape (columns, motions)
        Bounds of the collapse intensity [m/s2]: the highest run below it without, and the lowest
        with a collapse (infinite if there was none).
    settings : dict
        How it was run.
    seconds : float
        Wall time.
    early, late : IDA or None
        The same at both ends of the interval of the drift at axial failure, if that was asked for.
    """

    runs: Runs
    lower: Array
    upper: Array
    settings: dict[str, Any]
    seconds: float
    early: IDA | None = None
    late: IDA | None = None

    @property
    def at_ends(self) -> tuple[IDA, IDA] | None:
        """The IDA of early and of late axial failure."""
        return None if self.early is None or self.late is None else (self.early, self.late)

    @property
    def collapse_intensity(self) -> Array:
        """Geometric means of the bounds [m/s2], shape (columns, motions); infinite if none."""
        return np.where(self.lower > 0, np.sqrt(self.lower * self.upper), self.upper)

    def curve(
        self, motion: str | int, column: str | int = 0, edp: str | None = None
    ) -> tuple[Array, Array]:
        """Return intensities and responses under one motion, from the origin upwards.

        Parameters
        ----------
        motion, column : str or int
            Name, or number from 0.
        edp : str, optional
            Measure of the response, by default `Runs.drift_measure`; it is infinite where the
            column collapsed.
        """
        c = _index(column, list(self.runs.columns), "column")
        m = _index(motion, list(self.runs.motions), "motion")
        return self._curve(c, m, self.runs.response(edp or self.runs.drift_measure))

    def fractiles(
        self, levels: ArrayLike | None = None, edp: str | None = None
    ) -> tuple[Array, Array]:
        """Return the 16, 50 and 84 % fractiles of the response at intensities.

        Parameters
        ----------
        levels : array_like, shape (k,), optional
            Intensities [m/s2]; by default 50 up to the highest of the runs.
        edp : str, optional
            Measure of the response, by default `Runs.drift_measure`.

        Returns
        -------
        tuple of ndarray
            The levels (k,), and the fractiles (3, k), infinite where that part has collapsed.
        """
        usual = np.linspace(0, self.runs.intensity.max(), 51)[1:]
        at = usual if levels is None else checked_levels(levels)
        response = self.runs.response(edp or self.runs.drift_measure)
        values = np.array([_at(at, *self._curve(c, m, response)) for c, m in self._pairs()])
        return at, np.percentile(values, FRACTILES, axis=0, method="inverted_cdf")

    def capacities(self, edp: str = "collapse", threshold: float | None = None) -> Capacities:
        """Return the intensities at which the curves reach a limit state.

        Parameters
        ----------
        edp : str, optional
            As for `fragility`.
        threshold : float, optional
            Value of the measure at the limit state.
        """
        ((measure, limit),) = limit_states(edp, threshold).values()
        return self._data(measure, limit)

    def _data(self, measure: str, limit: float) -> Capacities:
        """Return the bounds of the intensity at which each curve reaches a limit."""
        if measure == "collapse":
            return Capacities(self.lower.ravel(), self.upper.ravel())
        response = self.runs.response(measure)
        smooth = not is_switch(measure)
        ends = [_crossing(*self._curve(c, m, response), limit, smooth) for c, m in self._pairs()]
        lower, upper = np.array(ends).T
        if (upper == 0).any():
            at = float(response[self.runs.intensity == 0].max())
            raise InputError(
                f"{measure}: {limit:g} is reached in the initial state already, without any motion "
                f"({at:.3g}); give a limit beyond it"
            )
        return Capacities(lower, upper)

    def _pairs(self) -> list[tuple[int, int]]:
        """Return column and motion of each curve, from 0."""
        return list(np.ndindex(self.lower.shape))

    def _curve(self, column: int, motion: int, response: Array) -> tuple[Array, Array]:
        """Return the curve from the origin to the first collapse."""
        runs_of_curve = (self.runs.column == column) & (self.runs.motion == motion)
        level, values = self.runs.intensity[runs_of_curve], response[runs_of_curve]
        kept = level <= self.upper[column, motion] * (1 + 1e-12)
        level, values = level[kept], values[kept]
        if level.size and level[0] == 0:
            return level, values
        return np.concatenate([[0.0], level]), np.concatenate([[0.0], values])

    def __repr__(self) -> str:
        collapses = self.collapse_intensity[np.isfinite(self.upper)]
        middle = (
            f", their sample median at {np.median(collapses):.4g} m/s2" if collapses.size else ""
        )
        if self.at_ends and collapses.size:
            ends = (np.median(end.collapse_intensity) for end in self.at_ends)
            middle += " ({:.4g} to {:.4g} with early and late axial failure)".format(*ends)
        return (
            f"IDA({self.runs.measure.label}: {self.lower.size} curves, {len(self.runs)} runs, "
            f"{collapses.size} collapses{middle}; {self.seconds:.3g} s)"
        )


def ida(
    column: Structure | Sequence[Structure] | Mapping[str, Structure],
    motions: GroundMotion | Sequence[Record] | Mapping[str, Record],
    *,
    levels: ArrayLike | Literal["search"] | CollapseSearch = "search",
    refine: Sequence[str] | None = None,
    axial_failure: bool | None = None,
    **options: Unpack[RunOptions],
) -> IDA:
    """Run an incremental dynamic analysis: every motion at growing intensity.

    Parameters
    ----------
    column : Column or Frame, or sequence or mapping of them
        The column; several are all run with every motion.
    motions : GroundMotion, or sequence or mapping of GroundMotion
        The records, whose own scale does not matter; of a building also pairs of motions along x
        and y, ``[(east_west, north_south), ...]``, each of which one factor scales.
    levels : array_like, "search" or CollapseSearch, optional
        Intensities of the runs [m/s2], or a search for the collapse of each record, whose
        settings are those of `CollapseSearch`.
    refine : sequence of str, optional
        Limit states that the search finds to within 5 % too, as ``["first_yield", "spalling"]``;
        they are then among the measures, with given levels too. The default is "first_yield"
        if that is a measure; ``[]`` leaves all to the runs made for the collapse.
    axial_failure : bool, optional
        Whether frames, whose members lose their axial load at a drift that is known to a factor,
        are run at both ends of its interval too (`rbsdem.Frame.with_axial_failure`); by default
        where a member that can lose it may have failed in shear in some run. This takes three
        times the time; fragilities then have the dispersion that it makes.
    **options
        See `rbsdem.many.runs.RunOptions`: intensity, period, damping, collapse_drift, measures,
        initial, jobs, progress, store, shard, client; and the settings of the method, see
        `rbsdem.Solver`. With an initial state the curves begin at what the column does in it
        without motion.

    Returns
    -------
    IDA
        Curves, collapse intensities, fractiles, fragilities, figure.

    Raises
    ------
    InputError
        Before the first run, with all that is wrong.
    """
    begin = time.perf_counter()
    asked = axial_failure
    if asked is not None:
        asked = _arguments.boolean(asked, "ida: axial_failure")
    failing = {} if asked is False else _that_lose_their_load(columns_by_name(column))
    if asked and not failing:
        raise InputError(
            "ida: axial_failure = True: no member of a frame has a failure_drift; leave "
            "axial_failure out"
        )
    again: dict[str, Any] = {"levels": levels, "refine": refine, "axial_failure": False} | options
    if "measures" in options:
        options["measures"] = _with_drift(options["measures"], column)
    search = _search_of(levels)
    records = own_records(motions_by_name(motions, column), options)
    work = make_collector("ida", column, records, **options)
    named = {name for name in work.names if isinstance(name, str)}
    refined = _refined(refine, named)
    work.names = [*work.names, *(name for name in refined if name not in named)]
    watched = bool(failing) and asked is None and _SHEARED not in work.names
    work.names += [_SHEARED] * watched
    work.check_unloaded_state("ida")
    at = np.empty(_EXPECTED) if search is not None else checked_levels(levels)
    wanted = _arguments.boolean(work.settings["progress"], "progress")
    with progress_bar(wanted, at.size * math.prod(work.shape)) as show:
        if wanted:
            work.settings["progress"] = show
        if search is not None:
            lower, upper = search_collapse(work, search, refined)
        else:
            collapsed = work.run(np.broadcast_to(at, (*work.shape, at.size)).copy())
            lower, upper = _first(at, collapsed)
    kept = {n: v for n, v in work.settings.items() if n not in _OF_THE_RUN}
    about = {n: v for n, v in kept.items() if v is not None and v is not False}
    about["levels"] = "search" if search is not None else "given"
    runs = work.finish()
    needed = bool(failing) and (asked or _may_fail(runs, failing))
    if watched:
        del runs.measures[_SHEARED]
    ends: list[Any] = [
        {name: failing[name].with_axial_failure(factor) if name in failing else one
         for name, one in runs.columns.items()}
        for factor in (AXIAL_FAILURE_FACTORS if needed else ())
    ]  # fmt: skip
    told = [ida(end, motions, **again) for end in ends]
    return IDA(runs, lower, upper, about, time.perf_counter() - begin, *told)


#: Measure of a run in which a shear spring yielded.
_SHEARED = "shear_yield"


def _that_lose_their_load(structures: Mapping[str | int, Structure]) -> dict[str | int, Frame]:
    """Return the frames with a member that loses its axial load after a failure in shear."""
    return {
        name: structure
        for name, structure in structures.items()
        if isinstance(structure, Frame)
        and any(kind.failure_drift is not None for kind in structure.named_kinds.values())
    }


def _may_fail(runs: Runs, frames: Mapping[str | int, Frame]) -> bool:
    """Return whether members may have failed in shear: by a spring, or at a drift."""
    places = [at for at, name in enumerate(runs.columns) if name in frames]
    sheared = np.isfinite(runs.measures[_SHEARED]) & np.isin(runs.column, places)
    kinds = (kind for frame in frames.values() for kind in frame.named_kinds.values())
    return bool(sheared.any()) or any(kind.shear_drift is not None for kind in kinds)


def _search_of(levels: Any) -> CollapseSearch | None:
    """Return the search that `levels` asks for; None if they are intensities."""
    if isinstance(levels, CollapseSearch):
        return levels
    if isinstance(levels, str):
        if levels != "search":
            raise InputError(f"levels = {levels!r} must be 'search' or intensities in m/s2")
        return CollapseSearch()
    return None


def _refined(refine: Any, measures: Collection[str]) -> list[str]:
    """Return the limit states that a search narrows."""
    if refine is None:
        return ["first_yield"] if "first_yield" in measures else []
    names = [refine] if isinstance(refine, str) else _arguments.several(refine, "refine", "names")
    return list(dict.fromkeys(_arguments.choice(name, "refine", WATCHED) for name in names))


def _with_drift(measures: Sequence[str | Measure], columns: Any) -> list[Any]:
    """Return measures with the drift of `Runs.drift_measure` among them."""
    several = measures_in_a_list(measures)
    named = [measure for measure in several if isinstance(measure, str)]
    drift = drift_of(columns_by_name(columns).values())
    return several if drift in named else [drift, *several]


def _first(levels: Array, collapsed: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Return the level below and at the first collapse of each curve."""
    with_end = np.concatenate([collapsed, np.ones((*collapsed.shape[:-1], 1), bool)], axis=-1)
    place = with_end.argmax(axis=-1)
    return np.concatenate([[0.0], levels])[place], np.concatenate([levels, [np.inf]])[place]


def _at(levels: Array, level: Array, response: Array) -> Array:
    """Return the response at levels: linear between runs, infinite from the collapse on."""
    last = int(np.argmax(~np.isfinite(response))) if np.isinf(response).any() else response.size
    interpolated = np.interp(levels, level[:last], response[:last], right=np.nan)
    if last < response.size:
        # Between the last run without and the first with a collapse the response stays.
        interpolated = np.where(levels > level[last - 1], response[last - 1], interpolated)
        return np.where(levels >= level[last], np.inf, interpolated)
    # No collapse: what was not run is not known to be lower than the last run.
    return np.where(np.isnan(interpolated), np.inf, interpolated)


def _crossing(level: Array, response: Array, limit: float, smooth: bool) -> tuple[float, float]:
    """Return bounds of the intensity at which a curve first reaches a value.

    If the measure is `smooth`, both are the intensity by interpolation between two runs.
    """
    reached = np.flatnonzero(response >= limit)
    if not reached.size:
        return float(level[-1]), np.inf
    i = int(reached[0])
    if i == 0:
        return 0.0, 0.0
    low, high = float(level[i - 1]), float(level[i])
    if not (smooth and np.isfinite(response[i])):
        return low, high
    part = (limit - response[i - 1]) / (response[i] - response[i - 1])
    return (low + part * (high - low),) * 2


def _index(key: str | int, names: list[Any], what: str) -> int:
    """Return the place of a name; a number that is no name is the place itself."""
    if key in names:
        return names.index(key)
    if isinstance(key, int) and 0 <= _arguments.integer(key, what) < len(names):
        return key
    raise InputError(f"{what} = {key!r} is not one of {', '.join(map(str, names[:20]))}")


@dataclass(frozen=True, eq=False, repr=False)
class Stripes(WithFragility):
    """Runs at levels of intensity.

    Attributes
    ----------
    runs : Runs
        All runs with their intensity, fate and measures.
    levels : ndarray, shape (k,)
        The intensities [m/s2].
    paired : bool
        Whether the records are the same at all levels.
    seconds : float
        Wall time.
    """

    runs: Runs
    levels: Array
    paired: bool
    seconds: float

    def counts(self, edp: str = "collapse", threshold: float | None = None) -> Counts:
        """Return which runs reached a limit state, by level and record."""
        ((measure, limit),) = limit_states(edp, threshold).values()
        return self._data(measure, limit)

    def _data(self, measure: str, limit: float) -> Counts:
        """Return whether each record reaches a limit at each level; NaN where it was not run."""
        response = self.runs.response(measure)
        level = np.abs(np.subtract.outer(self.levels, self.runs.intensity)).argmin(axis=0)
        records = self.runs.column * len(self.runs.motions) + self.runs.motion
        names, record = np.unique(records, return_inverse=True)
        failed = np.full((self.levels.size, names.size), np.nan)
        failed[level, record] = response >= limit
        return Counts(self.levels, failed, self.paired)

    def __repr__(self) -> str:
        return (
            f"Stripes({self.runs.measure.label}: {self.levels.size} levels, {len(self.runs)} runs, "
            f"{int(self.runs.collapsed.sum())} collapses; {self.seconds:.3g} s)"
        )


def stripes(
    column: Structure | Sequence[Structure] | Mapping[str, Structure],
    motions: Any,
    levels: ArrayLike | None = None,
    **options: Unpack[RunOptions],
) -> Stripes:
    """Run records at levels of intensity.

    Parameters
    ----------
    column : Column or Frame, or sequence or mapping of them
        The column, or several, which are all run with every motion.
    motions : sequence or mapping of GroundMotion, or mapping of sequences
        The records, or pairs of them as for `rbsdem.ida`; or for each level [m/s2] its own ones, as
        ``{2.0: [...], 4.0: [...]}``, scaled to it.
    levels : array_like, shape (k,), optional
        Intensities of the runs [m/s2], unless the motions come by level.
    **options
        As for `rbsdem.ida`, see `rbsdem.many.runs.RunOptions`.

    Returns
    -------
    Stripes
        Counts, fragilities, figure.

    Raises
    ------
    InputError
        Before the first run, with all that is wrong.
    """
    begin = time.perf_counter()
    by_level = _by_level(motions, column)
    if by_level is None:
        if levels is None:
            raise InputError("stripes: levels are missing; give intensities in m/s2")
        records, wanted = motions_by_name(motions, column), checked_levels(levels)
        at = wanted
    else:
        if levels is not None:
            raise InputError("stripes: the motions come by level; leave levels out")
        records, wanted = _records_of_levels(by_level)
        at = checked_levels(list(by_level))
    names, records = list(records), own_records(records, options)
    if by_level is not None:
        wanted = wanted[[name in records for name in names]]
    work = make_collector("stripes", column, records, **options)
    work.run(np.broadcast_to(wanted, (*work.shape, wanted.shape[-1])).copy())
    return Stripes(work.finish(), at, by_level is None, time.perf_counter() - begin)


def _by_level(motions: Any, column: Any) -> dict[float, dict[str, Record]] | None:
    """Return the motions of each level, or None if they are the same for all."""
    if not isinstance(motions, Mapping) or not motions:
        return None
    # A pair has a name; two records of a level have a number.
    if all(
        isinstance(each, GroundMotion) or (is_pair(each) and isinstance(name, str))
        for name, each in motions.items()
    ):
        return None
    levels = [_arguments.number(level, "stripes: level") for level in motions]
    of_levels = (motions_by_name(each, column) for each in motions.values())
    return dict(zip(levels, of_levels, strict=True))


def _records_of_levels(
    by_level: dict[float, dict[str, Record]],
) -> tuple[dict[str, Record], Array]:
    """Return all motions, named after their levels, and the level of each, shape (motions, 1)."""
    records, levels = {}, []
    for level, motions in by_level.items():
        for name, motion in motions.items():
            records[f"{level:g} {name}"] = motion
            levels.append(level)
    return records, np.array(levels)[:, None]
