"""The target displacement of a push-over, and its error under records on the same frame."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame, NDArray, Unpack
from rbsdem.checks.acceptance import between, rows_at
from rbsdem.checks.capacity import Capacity, Estimate, asce_41, capacity_spectrum, en_1998
from rbsdem.errors import InputError
from rbsdem.many.ensemble import ensemble
from rbsdem.model.frame import Frame
from rbsdem.model.frame_result import FrameResult
from rbsdem.motions.design import DesignSpectrum
from rbsdem.motions.motion import GroundMotion, checked_motion
from rbsdem.run.analysis import modes
from rbsdem.run.solver import Solver

TargetMethod = Literal["asce_41", "en_1998", "capacity_spectrum"]

_METHODS: dict[str, Callable[..., Estimate]] = {
    "asce_41": asce_41,
    "en_1998": en_1998,
    "capacity_spectrum": capacity_spectrum,
}
#: Damping of a frame without any, as the spectra have it.
_DAMPING = 0.05


#: Units of factors.
_UNITS = {"m*": "kg", "d_et*": "m", "d_t*": "m"}
_UNITS |= dict.fromkeys(("T*", "T_C", "T_0", "T_eff", "T_sec"), "s")


@dataclass(frozen=True, repr=False, eq=False)
class Target(Estimate):
    """A target displacement with its curve, its spectrum and the state of the frame there.

    Attributes
    ----------
    curve : Capacity
        The curve.
    spectrum : DesignSpectrum
        The demand.
    push : FrameResult or None
        The push-over; None where a `Capacity` was given.
    """

    curve: Capacity = None  # type: ignore[assignment]
    spectrum: DesignSpectrum = None  # type: ignore[assignment]
    push: FrameResult | None = None

    @property
    def base_shear(self) -> float:
        """Base shear at the target displacement [N]; NaN beyond the end of the curve."""
        return self.curve.force_at(self.displacement)

    @property
    def drift(self) -> float:
        """Target displacement over the height of the frame."""
        return self.displacement / self._pushed.frame.height

    @property
    def signed(self) -> float:
        """Displacement of the control node in the rows of the push-over [m]."""
        x = self._pushed.displacement
        return float(x[0] + math.copysign(self.displacement, x[-1] - x[0]))

    @cached_property
    def storey_drift(self) -> Array:
        """Storey drifts at the target displacement, beyond those of the dead load."""
        drift = self._pushed.storey_drift
        there: Array = between(rows_at(self._pushed, self)[1], np.abs(drift - drift[0]))[0]
        return there

    @property
    def _pushed(self) -> FrameResult:
        if self.push is None:
            raise InputError("target: it was made of a Capacity; give the push-over of a frame")
        return self.push

    def to_pandas(self) -> DataFrame:
        """Return a row for each figure, with its unit."""
        lines = self.lines
        rows: list[tuple[str, float, str]] = [
            ("target displacement", self.displacement, "m"),
            ("base shear there", self.base_shear, "N"),
            ("yield displacement", lines.yield_displacement, "m"),
            ("yield force", lines.yield_force, "N"),
            ("effective stiffness", lines.stiffness, "N/m"),
            ("elastic period", self.curve.period, "s"),
            ("effective period", self.period, "s"),
            ("spectral acceleration there", self.acceleration, "m/s2"),
            ("effective mass", self.curve.gamma * self.curve.modal_mass, "kg"),
            ("ductility", self.ductility, ""),
        ]
        if self.push is not None:
            rows.insert(1, ("roof drift", self.drift, "drift"))
        rows += [(name, value, _UNITS.get(name, "")) for name, value in self.factors.items()]
        return data_frame(rows, ["figure", "value", "unit"])

    def __repr__(self) -> str:
        end = "" if self.reached else f", not reached: the curve ends at {self.curve.largest:.4g} m"
        return (
            f"Target({self.method}, {self.displacement:.4g} m, base shear {self.base_shear:.4g} N, "
            f"period {self.curve.period:.3g} s elastic, {self.period:.3g} s effective, "
            f"ductility {self.ductility:.3g}{end})"
        )

    def check(
        self,
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
        records : sequence of GroundMotion
            The records. Each is scaled so that the mean logarithm of its spectrum over that of the
            demand is zero.
        periods : tuple of float, optional
            Range of periods for it, in parts of the elastic one of the first mode.
        jobs, progress
            As for `rbsdem.ensemble`.
        **solver
            Settings of the method; by default "newmark" with a step of 0.01 s.

        Returns
        -------
        TargetCheck
            Drifts under the records over those of the estimate. A frame without damping gets 5 % in
            all modes, as the spectrum has.
        """
        frame = self._pushed.frame
        estimate = self.drift, self.storey_drift
        if not frame.damped:
            frame = replace(frame, damping=_DAMPING)
        low, high = (_arguments.number(value, "check: periods", above=0.0) for value in periods)
        t = np.geomspace(low * self.curve.period, high * self.curve.period, 40)
        wanted = np.array([self.spectrum.sa(one) for one in t])
        given = _arguments.several(records, "check: records", "records")
        motions = [checked_motion(one, "check: ") for one in given]
        factors = [
            math.exp(float(np.log(wanted / one.spectrum(t).pseudo_acceleration).mean()))
            for one in motions
        ]
        storeys = range(1, estimate[1].size + 1)
        names = [f"peak_storey_drift_{i}" for i in storeys]
        settings: Any = {"method": "newmark", "dt": 0.01} | solver
        runs = ensemble(
            frame, motions, scales=np.array(factors)[:, None], measures=["peak_drift", *names],
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
        """Whether each run collapsed; a drift without bound for the medians."""
        return np.asarray(self.status == "collapsed")

    def _ratios(self) -> dict[str, Array]:
        found = {"roof": self.roof_drift / self.estimated_roof_drift}
        for i, estimate in enumerate(self.estimated_storey_drift):
            found[f"storey {i + 1}"] = self.storey_drift[:, i] / estimate
        largest = self.storey_drift.max(axis=1) / self.estimated_storey_drift.max()
        return found | {"largest storey": largest}

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


def target(
    push: FrameResult | Capacity,
    spectrum: DesignSpectrum,
    method: TargetMethod = "asce_41",
    **settings: Any,
) -> Target:
    """Return the target displacement of a push-over under a spectrum.

    Parameters
    ----------
    push : FrameResult or Capacity
        What `rbsdem.pushover` returned, or a curve with its masses.
    spectrum : DesignSpectrum
        The demand: `DesignSpectrum.asce_41`, `.en_1998`, `.table` or `.mean_of` records.
    method : {"asce_41", "en_1998", "capacity_spectrum"}, optional
        The method: coefficients of ASCE 41-17, N2 of EN 1998-1, or the capacity spectrum of FEMA
        440. They differ by a third on one frame: name it beside every target.
    **settings
        Those of the method, see `rbsdem.checks.capacity`: `site_class`, `c0`, `cm`, `near_field` of
        "asce_41", `iterate` of "en_1998".

    Returns
    -------
    Target
        Displacement, lines, periods and coefficients; `check` runs records beside it.

    Raises
    ------
    InputError
        If an argument is refused, or the curve has no such lines.
    """
    run = _METHODS[_arguments.choice(method, "target: method", get_args(TargetMethod))]
    remedy = "as DesignSpectrum.en_1998(0.25, 'C')"
    demand = _arguments.instance(spectrum, "target: spectrum", DesignSpectrum, remedy)
    curve = push if isinstance(push, Capacity) else capacity(push)
    known = run.__kwdefaults__ or {}
    for name in settings:
        if name not in known:
            there = f"it takes {', '.join(known)}" if known else "it takes none"
            raise InputError(f"target: {name} is no setting of {method!r}; {there}")
    found = run(curve, demand, **settings)
    pushed = None if isinstance(push, Capacity) else push
    return Target(**vars(found), curve=curve, spectrum=demand, push=pushed)


def capacity(push: FrameResult) -> Capacity:
    """Return the capacity curve of a push-over with the first mode of its frame.

    Parameters
    ----------
    push : FrameResult
        What `rbsdem.pushover` returned. Displacement and base shear count from its first row, in
        which the frame stands under its dead load.

    Raises
    ------
    InputError
        If it is none, or the frame has no mass.
    """
    push = _arguments.instance(push, "target", FrameResult, "as of rbsdem.pushover")
    if push.dynamic:
        raise InputError("target: the result is a response in time; give a push-over")
    frame: Frame = push.frame
    if frame.control == "y" or not frame.parts.mass > 0:
        raise InputError("target: the frame has no mass along x, or is not pushed along it")
    first = modes(frame, 1)
    phi = _control(frame, first.x[:, 0])
    moved = math.sqrt(float(first.mass[0]))
    gamma, modal_mass = moved * abs(phi), moved / abs(phi)
    side = 1.0 if push.displacement[-1] >= push.displacement[0] else -1.0
    u = side * (push.displacement - push.displacement[0])
    v = side * (push.base_shear - push.base_shear[0])
    storeys = len(frame.storey_heights)
    slope = _pdelta_slope(frame, first.x[:, 0] / phi, gamma)
    made = Capacity(
        u, v, gamma, modal_mass, frame.parts.mass, max(storeys, 1), float(first.period[0]),
        pdelta_slope=slope,
    )  # fmt: skip
    return made


def _control(frame: Frame, x: Array) -> float:
    """Return the shape at the control node."""
    parts = frame.parts
    name = frame.control_node
    at = parts.nodes.index(name) if name else int(parts.y.argmax())
    return float(x[at])


def _pdelta_slope(frame: Frame, shape: Array, gamma: float) -> float:
    """Return the slope that the axial forces of the columns take from the curve [N/m].

    By virtual work on the shape phi of the mode: gamma times the sum of P (change of phi)^2/length.
    """
    if frame.kinematics != "pdelta":
        return 0.0
    parts = frame.parts
    start, end = parts.ends.T
    length = np.hypot(parts.x[end] - parts.x[start], parts.y[end] - parts.y[start])
    return gamma * float(np.sum(parts.compression * (shape[end] - shape[start]) ** 2 / length))
