"""Multiple-stripe analysis: the same intensities for all records, or records for each intensity."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.many.fragility import Counts, Fragile, Fragility, fit_fragility
from rbsdem.many.measures import limit_states
from rbsdem.many.runs import RunOptions, Runs, checked_levels, make_collector, motions_by_name
from rbsdem.model.column import Column
from rbsdem.motions.motion import GroundMotion

if TYPE_CHECKING:
    from typing_extensions import Unpack


@dataclass(frozen=True, eq=False, repr=False)
class Stripes(Fragile[Fragility]):
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
        return self._counts(measure, limit)

    def _counts(self, measure: str, limit: float) -> Counts:
        response = self.runs.response(measure)
        level = np.abs(np.subtract.outer(self.levels, self.runs.intensity)).argmin(axis=0)
        records = self.runs.column * len(self.runs.motions) + self.runs.motion
        names, record = np.unique(records, return_inverse=True)
        failed = np.full((self.levels.size, names.size), np.nan)
        failed[level, record] = response >= limit
        return Counts(self.levels, failed, self.paired)

    def fragility(
        self, edp: str = "collapse", threshold: float | None = None, *, beta: float | None = None
    ) -> Fragility:
        """Return the fragility curve of a limit state, of largest likelihood (Baker 2015, eq 11).

        The parameters are those of `IDA.fragility`.

        Raises
        ------
        InputError
            If no run reached it, or all did, or the runs do not determine beta: at most one level
            has both outcomes. The message gives between what the median lies.
        """
        return self._one(edp, threshold, beta)

    def _fit(self, name: str, measure: str, limit: float, beta: float | None) -> Fragility:
        return fit_fragility(name, self._counts(measure, limit), self.runs.measure.label, beta)

    def __repr__(self) -> str:
        return (
            f"Stripes({self.runs.measure.label}: {self.levels.size} levels, {len(self.runs)} runs, "
            f"{int(self.runs.collapsed.sum())} collapses; {self.seconds:.3g} s)"
        )


def stripes(
    column: Column | Sequence[Column] | Mapping[str, Column],
    motions: Any,
    levels: ArrayLike | None = None,
    **options: Unpack[RunOptions],
) -> Stripes:
    """Run records at levels of intensity.

    Parameters
    ----------
    column : Column, or sequence or mapping of Column
        The column, or several, which are all run with every motion.
    motions : sequence or mapping of GroundMotion, or mapping of sequences
        The records; or for each level [m/s2] its own ones, as ``{2.0: [...], 4.0: [...]}``, scaled
        to it.
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
    by_level = _by_level(motions)
    if by_level is None:
        if levels is None:
            raise InputError("stripes: levels are missing; give intensities in m/s2")
        found, wanted = motions_by_name(motions), checked_levels(levels)
        at = wanted
    else:
        if levels is not None:
            raise InputError("stripes: the motions come by level; leave levels out")
        found, wanted = _own_records(by_level)
        at = checked_levels(list(by_level))
    work = make_collector("stripes", column, found, **options)
    work.run(np.broadcast_to(wanted, (*work.shape, wanted.shape[-1])).copy())
    return Stripes(work.finish(), at, by_level is None, time.perf_counter() - begin)


def _by_level(motions: Any) -> dict[float, dict[str, GroundMotion]] | None:
    """Return the motions of each level, or None if they are the same for all."""
    if not isinstance(motions, Mapping) or not motions:
        return None
    if all(isinstance(motion, GroundMotion) for motion in motions.values()):
        return None
    levels = [_arguments.number(level, "stripes: level") for level in motions]
    return dict(zip(levels, map(motions_by_name, motions.values()), strict=True))


def _own_records(
    by_level: dict[float, dict[str, GroundMotion]],
) -> tuple[dict[str, GroundMotion], Array]:
    """Return all motions, named after their levels, and the level of each, shape (motions, 1)."""
    found, levels = {}, []
    for level, own in by_level.items():
        for name, motion in own.items():
            found[f"{level:g} {name}"] = motion
            levels.append(level)
    return found, np.array(levels)[:, None]
