"""Records scaled to a spectrum beside a target displacement: how far the estimate is off."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame, NDArray, Unpack
from rbsdem.checks.acceptance import between, rows_at
from rbsdem.checks.target import Target
from rbsdem.many.ensemble import ensemble
from rbsdem.motions.motion import GroundMotion, checked_motion
from rbsdem.run.solver import Solver
from rbsdem.section.plan import Building, cosine_sine

#: Damping of a frame without any, as the spectra have it.
_DAMPING = 0.05


@dataclass(frozen=True, repr=False, eq=False)
class TargetCheck(Tabular):
    """Drifts under records beside those of an estimate.

    Attributes
    ----------
    record : tuple of str
        Names of the records.
    factor : ndarray, shape (records,)
        By which they were scaled.
    status : ndarray of str, shape (records,)
        How each run ended, as those of `rbsdem.ensemble`.
    roof_drift : ndarray, shape (records,)
        Largest drift of the roof.
    storey_drift : ndarray, shape (records, storeys)
        Largest drift of each storey.
    estimated_roof_drift, estimated_storey_drift : float, ndarray of shape (storeys,)
        Those of the estimate.
    """

    record: tuple[str, ...]
    factor: Array
    status: NDArray[np.str_]
    roof_drift: Array
    storey_drift: Array
    estimated_roof_drift: float
    estimated_storey_drift: Array

    @property
    def collapsed(self) -> NDArray[np.bool_]:
        """Whether each run collapsed; medians take its drift as infinite."""
        return np.asarray(self.status == "collapsed")

    def _ratios(self) -> dict[str, Array]:
        """Return the drifts of all runs over the estimate: of the roof, storeys, largest storey."""
        ratios = {"roof": self.roof_drift / self.estimated_roof_drift}
        for i, estimate in enumerate(self.estimated_storey_drift):
            ratios[f"storey {i + 1}"] = self.storey_drift[:, i] / estimate
        largest = self.storey_drift.max(axis=1) / self.estimated_storey_drift.max()
        return ratios | {"largest storey": largest}

    def to_pandas(self) -> DataFrame:
        """Return a row for the roof and each storey.

        The estimated drift, the median under the records, and their ratio with its scatter
        (standard deviation of the logarithm, without collapses) and range.
        """
        done = np.isin(self.status, ("completed", "collapsed"))
        rows = []
        estimates = [self.estimated_roof_drift, *self.estimated_storey_drift.tolist()]
        estimates.append(float(self.estimated_storey_drift.max()))
        for (name, ratio), estimate in zip(self._ratios().items(), estimates, strict=True):
            finite = ratio[done & ~self.collapsed]
            whole = np.where(self.collapsed, np.inf, ratio)[done]
            median = float(np.median(whole)) if whole.size else math.nan
            spread = float(np.log(finite).std(ddof=1)) if finite.size > 1 else math.nan
            ends = (finite.min(), finite.max()) if finite.size else (math.nan, math.nan)
            rows.append((name, estimate, median * estimate, median, spread, *map(float, ends)))
        names = ["where", "estimate_drift", "median_drift", "ratio", "sd_ln", "least", "largest"]
        return data_frame(rows, names)

    def __repr__(self) -> str:
        table = self.to_pandas().set_index("where")
        roof, storey = table.loc["roof"], table.loc["largest storey"]
        failed = int(np.sum(~np.isin(self.status, ("completed", "collapsed"))))
        more = f", {failed} not finished" if failed else ""
        return (
            f"TargetCheck({len(self.record)} records, {int(self.collapsed.sum())} collapsed{more}: "
            f"roof drift over the estimate {roof['ratio']:.2f} (sd of ln {roof['sd_ln']:.2f}), "
            f"largest storey drift {storey['ratio']:.2f} ({storey['sd_ln']:.2f}))"
        )


def check_target(
    target: Target,
    records: Sequence[GroundMotion],
    *,
    periods: tuple[float, float] = (0.2, 2.0),
    jobs: int | None = None,
    progress: bool = True,
    **solver: Unpack[Solver],
) -> TargetCheck:
    """Run the same frame under records scaled to the spectrum: the error of the estimate.

    Parameters
    ----------
    target : Target
        The estimate, of a push-over.
    records : sequence of GroundMotion
        The records; those of a building act along its direction. Each is scaled so that the mean
        logarithm of its spectrum over that of the demand is zero.
    periods : tuple of float, optional
        Range of periods of this mean, over the elastic period of the first mode.
    jobs, progress
        As for `rbsdem.ensemble`.
    **solver
        Settings of the method; by default "newmark" with a step of 0.01 s.

    Returns
    -------
    TargetCheck
        Drifts under the records over those of the estimate. A frame without damping gets 5 % in
        all modes, as the spectrum has. Drifts of storeys of a building are the largest of any
        frame; those of the estimate are multiplied by `Target.torsion`.
    """
    frame = target.pushed.structure
    of_building = isinstance(frame, Building)
    estimate = target.drift, _of_frames(target) if of_building else target.storey_drift
    if not frame.damped:
        frame = (frame.changed if of_building else partial(replace, frame))(damping=_DAMPING)
    low, high = (_arguments.number(value, "check_target: periods", above=0.0) for value in periods)
    t = np.geomspace(low * target.curve.period, high * target.curve.period, 40)
    wanted = np.array([target.spectrum.sa(period) for period in t])
    several = _arguments.several(records, "check_target: records", "records")
    motions = [checked_motion(motion, "check_target: ") for motion in several]
    factors = [
        math.exp(float(np.log(wanted / motion.spectrum(t).pseudo_acceleration).mean()))
        for motion in motions
    ]
    storeys = range(1, estimate[1].size + 1)
    names = [f"peak_storey_drift_{i}" for i in storeys]
    settings: Any = {"method": "newmark", "dt": 0.01} | solver
    shaken: Any = motions
    if of_building and frame.direction % 180.0:
        # A record acts along the direction of the push: its parts along x and y are a pair.
        along = cosine_sine(frame.direction)
        named = [motion.name or str(i) for i, motion in enumerate(motions)]
        pairs = [
            tuple(replace(motion, acceleration=part * motion.acceleration) for part in along)
            for motion in motions
        ]
        shaken = dict(zip(named, pairs, strict=True))
    runs = ensemble(
        frame, shaken, scales=np.array(factors)[:, None], measures=["peak_drift", *names],
        jobs=jobs, progress=progress, **settings,
    )  # fmt: skip
    measured = runs.measures
    return TargetCheck(
        tuple(str(name) for name in runs.motions),
        np.array(factors),
        runs.status,
        measured["peak_drift"],
        np.column_stack([measured[name] for name in names]),
        *estimate,
    )


def _of_frames(target: Target) -> Array:
    """Return the largest drift of each storey in any frame of a building, with its torsion."""
    push = target.pushed
    rows = rows_at(push, target)[1]
    largest = np.zeros(len(push.building.storey_heights))
    for name, frame in push.frames.items():
        drift = between(rows, np.abs(frame.storey_drift - frame.storey_drift[0]))[0]
        storeys = largest[: drift.size]
        np.maximum(storeys, target.torsion.get(name, 1.0) * drift, out=storeys)
    return largest
