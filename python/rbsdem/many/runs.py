"""Intensity measures, each in proportion to the scale of a motion, and runs at known ones."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._progress import Bar
from rbsdem._types import Array, DataFrame, NDArray, Unpack
from rbsdem.errors import InputError, Interrupted, warn
from rbsdem.many import inputs
from rbsdem.many.ensemble import checked_part, ensemble
from rbsdem.many.plan import FAULT_OF_MEASURE, Share
from rbsdem.model.column import Column
from rbsdem.motions.motion import GroundMotion, Record, checked_motion, components, is_pair
from rbsdem.run.analysis import modes
from rbsdem.run.solver import COLLAPSE_DRIFT, Solver, checked_solver
from rbsdem.section.criteria import WATCHED
from rbsdem.section.frame import Frame, Structure

Name = Literal["sa_t1", "pga", "sa_avg"]
NAMES: tuple[Name, ...] = ("sa_t1", "pga", "sa_avg")
#: Spectral acceleration of pairs of motions, by how the two make one.
OfPairs = Literal["geometric_mean", "larger"]
OF_PAIRS: tuple[OfPairs, ...] = ("geometric_mean", "larger")

#: Periods of the mean spectral acceleration as parts of the first one (Eads et al. 2015), and how
#: many there are, evenly spaced.
_AVERAGE = (0.2, 3.0, 10)


@dataclass(frozen=True)
class Intensity:
    """An intensity measure.

    Attributes
    ----------
    name : {"sa_t1", "pga", "sa_avg"}
        Pseudo-spectral acceleration at a period, peak ground acceleration, or geometric mean of
        the spectral accelerations at ten periods from 0.2 to 3 times that period [m/s2].
    period : float
        The period [s]; 0 for "pga".
    damping : float
        Damping ratio of the spectrum.
    pairs : {"", "geometric_mean", "larger"}
        Which of the intensities of both components is that of a pair; "" without pairs.
    """

    name: Name
    period: float
    damping: float
    pairs: Literal["", OfPairs] = ""

    def of(self, record: Record) -> float:
        """Return the intensity of a record at scale 1 [m/s2]."""
        each = [self._of_motion(motion) for motion in components(record)]
        if self.pairs == "larger" or len(each) == 1:
            return max(each)
        return math.sqrt(math.prod(each))

    def _of_motion(self, motion: GroundMotion) -> float:
        """Return the intensity of one motion [m/s2]."""
        if self.name == "pga":
            return motion.pga
        if self.name == "sa_t1":
            return motion.sa(self.period, self.damping)
        return motion.sa_avg(self.period * np.linspace(*_AVERAGE), self.damping)

    @property
    def label(self) -> str:
        """Name with unit, for figures and tables."""
        of_pairs = {"": "", "geometric_mean": ", geometric mean", "larger": ", larger component"}
        unit = f"{of_pairs[self.pairs]} (m/s²)"
        if self.name == "pga":
            return f"PGA{unit}"
        mean = "Sa,avg" if self.name == "sa_avg" else "Sa"
        return f"{mean}({self.period:.3g} s, {100 * self.damping:g} %){unit}"


def make_intensity(
    name: str, column: Structure, period: float | None, damping: float, records: Iterable[Record]
) -> Intensity:
    """Return an intensity measure; its period is that of the column unless one is given."""
    several = any(map(is_pair, records))
    name = _arguments.choice(name, "intensity", (*NAMES, *OF_PAIRS))
    if name in OF_PAIRS and not several:
        raise InputError(
            f"intensity: {name!r} is of pairs of motions; give [(east_west, north_south), ...], or "
            "take 'sa_t1'"
        )
    pairs: Literal["", OfPairs] = "geometric_mean" if several else ""
    if name in OF_PAIRS:
        pairs, name = "larger" if name == "larger" else pairs, "sa_t1"
    if name == "pga":
        if period is not None:
            raise InputError("intensity: 'pga' has no period; leave period out, or take 'sa_t1'")
        return Intensity("pga", 0.0, 0.0, pairs)
    at = 1 / float(modes(column).frequency[0]) if period is None else period
    at = _arguments.number(at, "period", above=0, below=100, unit="s")
    hint = "; it is a ratio, 5 % is 0.05"
    ratio = _arguments.number(damping, "damping", least=0.0, most=1.0, hint=hint)
    return Intensity("sa_t1" if name == "sa_t1" else "sa_avg", at, ratio, pairs)


def motions_by_name(motions: Any, columns: Any) -> dict[str, Record]:
    """Return motions of columns by name, or raise `InputError` with all that is wrong."""
    inputs.check_not_one_pair(motions, columns_by_name(columns).values())
    faults: list[str] = []
    several = [motions] if isinstance(motions, GroundMotion) else motions
    names, items = inputs.named(several, "motions", "GroundMotion", faults)
    by_name: dict[str, Record] = {}
    for name, item in zip(names, items, strict=True):
        with _arguments.collected(faults):
            by_name[str(name)] = item if is_pair(item) else checked_motion(item, f"motion {name}: ")
            if all(motion.pga == 0 for motion in components(by_name[str(name)])):
                raise InputError(f"motion {name}: has no acceleration")
    inputs.check_names(names, "motions", "motion", faults)
    _arguments.raise_faults(faults)
    return by_name


def checked_levels(levels: Any) -> Array:
    """Return levels of intensity, ascending."""
    ascending = np.unique(_arguments.finite_vector(levels, "levels", shape="1 or m"))
    if ascending.size == 0 or ascending[0] <= 0:
        raise InputError("levels must be intensities above 0, in m/s2; give at least one")
    return ascending


#: Measures of a run that are kept unless others are asked for.
MEASURES = ("peak_drift", "residual_drift", "peak_base_shear", "peak_rotation", "first_yield")
#: Fates that are a collapse.
COLLAPSES = ("collapsed", "axial_failure")
#: Fates that count as one.
LOST = (*COLLAPSES, "failed")
#: Method by which a run that failed is tried again.
_AGAIN = "rk45"
#: Least intensity [m/s2] from which a motion is scaled.
_LEAST_UNIT = 1e-20


class RunOptions(Solver, total=False):
    """Keywords of `ida` and `stripes`, with the settings of `rbsdem.Solver`.

    A run that fails is tried again with "rk45"; one that fails twice counts as a collapse, with a
    warning.

    Attributes
    ----------
    intensity : {"sa_t1", "pga", "sa_avg", "geometric_mean", "larger"}
        Intensity measure [m/s2]: pseudo-spectral acceleration at the first period (the default),
        peak acceleration, or geometric mean of spectral accelerations from 0.2 to 3 first periods.
        Of a pair of motions each is the geometric mean of both components; "geometric_mean" is
        "sa_t1" by its full name, "larger" that of the component where it is larger.
    period : float
        Period of the intensity [s], by default the first one of the (first) column, uncracked.
    damping : float
        Damping ratio of the spectrum; the default is 0.05.
    collapse_drift : float
        Drift that counts as a collapse, of a storey of a frame (`Frame.collapse`), or displacement
        of the top over the height; the default is 0.1.
    measures : sequence
        Measures that are kept of each run, as for `rbsdem.ensemble`; the default is `MEASURES`, and
        those of the storeys of frames.
    initial : Result, path-like, or sequence or mapping of them
        The state that all runs of a column begin in, as for `rbsdem.ensemble`: what an aftershock
        finds.
    jobs, progress
        As for `rbsdem.ensemble`.
    store : path-like
        Folder that keeps the runs, as for `rbsdem.ensemble`; a second start, with more records too,
        computes what is missing.
    shard : (int, int)
        Part i of n, as ``(3, 20)``: the i-th record and every n-th after it. Several processes with
        one store do one part each; a call without `shard` then has all.
    client : dask.distributed.Client
        A cluster, as for `rbsdem.ensemble`.
    """

    intensity: Name | OfPairs
    period: float | None
    damping: float
    collapse_drift: float
    measures: Sequence[str | inputs.Measure]
    initial: Any
    jobs: int | None
    progress: bool
    store: str | os.PathLike[str] | None
    shard: tuple[int, int] | None
    client: Any


@dataclass(frozen=True, repr=False, eq=False)
class Runs(Tabular):
    """Runs with their intensities.

    Attributes
    ----------
    columns : dict
        Columns by name.
    motions : dict
        Motions by name, or pairs of them, at scale 1.
    measure : Intensity
        The intensity measure.
    column, motion : ndarray of int, shape (runs,)
        Places of column and motion of each run.
    intensity, scale : ndarray, shape (runs,)
        Intensity [m/s2] of the scaled motion, and its scale.
    status : ndarray of str, shape (runs,)
        "completed", "collapsed", "axial_failure" or "failed".
    measures : dict of ndarray, shape (runs,)
        Measures of the response by name.
    """

    columns: Mapping[str | int, Structure]
    motions: Mapping[str, Record]
    measure: Intensity
    column: NDArray[np.int_]
    motion: NDArray[np.int_]
    intensity: Array
    scale: Array
    status: NDArray[np.str_]
    measures: dict[str, Array]

    def __len__(self) -> int:
        """Return the number of runs."""
        return self.intensity.size

    @property
    def collapsed(self) -> NDArray[np.bool_]:
        """Whether a run ended in a collapse, or could not be continued, shape (runs,)."""
        return np.isin(self.status, LOST)

    @property
    def drift_measure(self) -> str:
        """Name of the drift that figures and limits mean: of storeys, else of the top."""
        drift = drift_of(self.columns.values())
        return drift if drift in self.measures else "peak_drift"

    def response(self, edp: str) -> Array:
        """Return a measure of the response, infinite where the column collapsed, shape (runs,).

        Parameters
        ----------
        edp : str
            Name of the measure; "collapse" is 0 or infinity, a limit state such as "first_yield" 1
            where it was reached, else 0.
        """
        if edp == "collapse":
            return np.where(self.collapsed, np.inf, 0.0)
        if edp not in self.measures:
            raise InputError(
                f"edp = {edp!r} is not one of collapse, {', '.join(self.measures)}; ask for it "
                "with measures="
            )
        values = self.measures[edp]
        if edp in WATCHED:
            if not np.isfinite(values).any():
                raise InputError(
                    f"edp = {edp!r}: it was reached in no run, or the columns have no such limit "
                    "state; give a drift as the limit state"
                )
            values = np.isfinite(values).astype(float)
        return np.where(self.collapsed, np.inf, np.abs(values))

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each run; the intensity in the unit of its measure."""
        return data_frame(
            {
                "column": np.array(list(map(str, self.columns)), dtype=object)[self.column],
                "motion": np.array(list(self.motions), dtype=object)[self.motion],
                "intensity": self.intensity,
                "scale": self.scale,
                "status": self.status,
                **self.measures,
            }
        )


@dataclass(eq=False)
class Collector:
    """Makes runs, and keeps what comes of them.

    Attributes
    ----------
    columns, motions, measure
        As in `Runs`.
    names : tuple of str
        Measures of the response.
    settings : dict
        Keywords of `rbsdem.ensemble`.
    who : str
        The analysis, for messages.
    """

    columns: Mapping[str | int, Structure]
    motions: Mapping[str, Record]
    measure: Intensity
    names: Sequence[Any]
    settings: dict[str, Any]
    who: str = "ida"
    parts: list[dict[str, Any]] = field(default_factory=list)
    unit: Array = field(init=False)

    def __post_init__(self) -> None:
        self.unit = np.array([self.measure.of(motion) for motion in self.motions.values()])
        units = zip(self.motions, self.unit, strict=True)
        bad = [name for name, value in units if not value > _LEAST_UNIT]
        if bad:
            raise InputError(
                f"motions without intensity {self.measure.label}, above {_LEAST_UNIT:g}: "
                f"{', '.join(bad)}"
            )

    @property
    def shape(self) -> tuple[int, int]:
        """Number of columns, number of motions."""
        return len(self.columns), len(self.motions)

    def run(self, levels: Array) -> NDArray[np.bool_]:
        """Run at levels of intensity, shape (columns, motions, k), NaN for no run.

        Returns
        -------
        ndarray of bool, shape (columns, motions, k)
            Whether the column collapsed; False where there is no run.
        """
        scales = levels / self.unit[:, None]
        first = self._ensemble(scales, self.settings)
        status, values = first.status.copy(), {n: v.copy() for n, v in first.measures.items()}
        failed = np.flatnonzero(status == "failed")
        if failed.size and self.settings.get("method") != _AGAIN:
            # A method that adapts its step may get through where a fixed one does not.
            again = np.full(levels.shape, np.nan)
            places = np.flatnonzero(~np.isnan(scales).ravel())[failed]
            again.ravel()[places] = scales.ravel()[places]
            how = {n: v for n, v in self.settings.items() if n in _KEPT} | {"method": _AGAIN}
            if how.get("store") is not None:
                # A folder of its own within that of the first attempt.
                how["store"] /= _AGAIN
            second = self._ensemble(again, how)
            status[failed] = second.status
            for name, numbers in values.items():
                numbers[failed] = second.measures[name]
        self.parts.append(
            {
                "column": first.column,
                "motion": first.motion,
                "scale": first.scale,
                "intensity": first.scale * self.unit[first.motion],
                "status": status,
                **{f"measure {name}": numbers for name, numbers in values.items()},
            }
        )
        collapsed = np.zeros(levels.shape, dtype=bool)
        collapsed.ravel()[np.flatnonzero(~np.isnan(scales).ravel())] = np.isin(status, LOST)
        return collapsed

    def tried(self, column: int, motion: int, *names: str) -> list[NDArray[Any]]:
        """Return named arrays of the runs so far of a column under a motion."""
        chosen = [(p["column"] == column) & (p["motion"] == motion) for p in self.parts]
        return [
            np.concatenate(
                [part[name][kept] for part, kept in zip(self.parts, chosen, strict=True)]
            )
            for name in names
        ]

    def check_unloaded_state(self, who: str) -> None:
        """Run without motion, where columns begin in states that other analyses ended in.

        These runs are the beginnings of the curves, which else begin in the origin.
        """
        if self.settings.get("initial") is None:
            return
        collapsed = self.run(np.zeros((*self.shape, 1)))
        for column in np.flatnonzero(collapsed.any(axis=(1, 2))):
            raise InputError(
                f"{who}: column {list(self.columns)[column]!r} collapses from its initial state "
                "without any motion; check initial and collapse_drift"
            )

    def _ensemble(self, scales: Array, settings: dict[str, Any]) -> Any:
        """Return more runs; messages count those before them too."""
        keywords = settings | {"scales": scales, "measures": list(self.names)}
        before = sum(part["status"].size for part in self.parts)
        bar = keywords["progress"]
        if isinstance(bar, Bar):
            keywords["progress"] = Bar(lambda done, text: bar(before + done, text))
        try:
            runs = ensemble(dict(self.columns), dict(self.motions), **keywords)
        except Interrupted as error:
            done, store = before + int((error.ensemble.status != "").sum()), keywords["store"]
            kept = (
                "with a store (store=, or --out of the command) they would be kept"
                if store is None
                else f"they are in {store}, and the same call goes on from there"
            )
            text = f"{self.who}: interrupted after {done} runs; {kept}"
            raise Interrupted(text, error.ensemble) from None
        for text in runs.errors.values():
            # Else the runs would count as collapses.
            if text.startswith(FAULT_OF_MEASURE):
                raise InputError(f"{text}; where it has no value it can return nan")
        return runs

    def finish(self) -> Runs:
        """Return all runs, by column, motion and intensity."""
        whole = {name: np.concatenate([p[name] for p in self.parts]) for name in self.parts[0]}
        order = np.lexsort((whole["intensity"], whole["motion"], whole["column"]))
        whole = {name: values[order] for name, values in whole.items()}
        failed = int((whole["status"] == "failed").sum())
        if failed:
            warn(
                f"{failed} of {order.size} runs failed by two methods and count as collapses; "
                "their status in the table is 'failed'",
            )
        start = len("measure ")
        measures = {name[start:]: v for name, v in whole.items() if name.startswith("measure ")}
        column, motion = whole["column"].astype(int), whole["motion"].astype(int)
        runs = column, motion, whole["intensity"], whole["scale"], whole["status"], measures
        return Runs(dict(self.columns), dict(self.motions), self.measure, *runs)


#: Settings that a second attempt by another method keeps.
_KEPT = ("collapse_drift", "initial", "jobs", "progress", "store", "shard", "client")


def make_collector(
    who: str,
    columns: Structure | Sequence[Structure] | Mapping[str, Structure],
    motions: Mapping[str, Record],
    *,
    intensity: Name | OfPairs = "sa_t1",
    period: float | None = None,
    damping: float = 0.05,
    collapse_drift: float = COLLAPSE_DRIFT,
    measures: Sequence[str | inputs.Measure] | None = None,
    initial: Any = None,
    jobs: int | None = None,
    progress: bool = False,
    store: str | os.PathLike[str] | None = None,
    shard: tuple[int, int] | None = None,
    client: Any = None,
    **solver: Unpack[Solver],
) -> Collector:
    """Return the collector of an analysis; the keywords are those of `RunOptions`."""
    named = columns_by_name(columns)
    first = next(iter(named.values()))
    measure = make_intensity(intensity, first, period, damping, motions.values())
    settings = {"method": "auto"} | checked_solver(solver, who)
    settings |= {
        "collapse_drift": _arguments.number(
            collapse_drift,
            "collapse_drift",
            above=0,
            below=1,
            hint="; it is a displacement over the height",
        ),
        "initial": initial,
        "jobs": jobs,
        "progress": progress,
        "store": None if store is None else _arguments.path(store, "store"),
        "shard": None if shard is None else Share(shard),
        "client": client,
    }
    if measures is None:
        frames = any(isinstance(structure, Frame) for structure in named.values())
        measures = (*MEASURES, *(inputs.STOREY_MEASURES if frames else ()))
    return Collector(named, motions, measure, inputs.measures_in_a_list(measures), settings, who)


def own_records(motions: dict[str, Record], options: RunOptions) -> dict[str, Record]:
    """Return the records of the part that `shard` names: the i-th and every n-th after it."""
    shard = options.get("shard")
    if shard is None:
        return motions
    faults: list[str] = []
    number, parts = checked_part(shard, options.get("store"), faults)
    if not faults and parts > len(motions):
        faults.append(f"shard: {parts} parts of {len(motions)} motions; a part has one or more")
    _arguments.raise_faults(faults)
    return dict(list(motions.items())[number - 1 :: parts])


def drift_of(structures: Iterable[Structure]) -> str:
    """Return the measure of drift that collapse is judged by: of storeys, or of the top."""
    by_storeys = [
        isinstance(structure, Frame)
        and bool(structure.storey_heights)
        and structure.collapse == "storey"
        for structure in structures
    ]
    return "peak_storey_drift" if by_storeys and all(by_storeys) else "peak_drift"


def columns_by_name(columns: Any) -> dict[str | int, Structure]:
    """Return columns under their names; one column, a sequence, or a mapping."""
    if isinstance(columns, (Column, Frame)):
        return {"column": columns}
    faults: list[str] = []
    names, items = inputs.named_columns(columns, faults)
    _arguments.raise_faults(faults)
    return dict(zip(names, items, strict=True))
