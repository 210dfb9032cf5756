"""Static paths and responses in time, and the results that they return."""

from __future__ import annotations

import contextlib
import math
import os
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from functools import partial
from typing import Any, Concatenate, ParamSpec, Protocol, overload

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._package import unwarned
from rbsdem._types import Array, ArrayLike, Unpack
from rbsdem.checks.limit_states import Hinge, all_thresholds
from rbsdem.checks.limit_states import hinge as hinge_of
from rbsdem.checks.limit_states import limit_states as find_limit_states
from rbsdem.errors import AccuracyWarning, InputError, LongRunWarning, SolveError, warn
from rbsdem.model import frame_result
from rbsdem.model.column import NOTES_ON, Column
from rbsdem.model.frame import Frame, Structure, checked_structure
from rbsdem.model.rows import HasEndState, LimitStates, Response, Rows, settings_of, state_of
from rbsdem.motions.motion import GroundMotion, acting
from rbsdem.run.accuracy import Errors, answer_of, common_interval, errors_of
from rbsdem.run.solver import METHODS, Solver, checked_solver

P = ParamSpec("P")

#: By how much a tolerance is sharpened, at least to where it and not the stability limits the
#: steps, and the least one.
_SHARPER, _SHARP, _LEAST = 100.0, 1e-9, 1e-13

#: Tolerance by default.
_USUAL_TOLERANCE = 1e-6
_DEFORMATIONS = ("slip", "rotation", "opening")
_NONE = np.empty(0)
_NONE.flags.writeable = False
#: Most steps times bodies of a run that is short enough to be done once more.
_SHORT = 50_000


@dataclass(frozen=True)
class ErrorEstimate:
    """Known errors of one result.

    Attributes
    ----------
    method : str
        The method that was used.
    measured : float
        The largest of `Result.refined_error`, where that run is short; NaN where it is not, and for
        a static path.
    usual, largest : float
        Error of the method at its own step or tolerance, relative to the peaks: median and largest
        of the responses of ``studies/error_classes.py``, which say little of another one. 0 for a
        static path, which is exact but for round-off.
    responses : int
        How many responses those were.
    own_setting : bool
        Whether the result has this step or tolerance; else a setting of the user.
    energy : float
        Error of the energy balance of this result, over its largest energy. It is no
        measure of the response, which may err by much more.
    """

    method: str
    measured: float
    usual: float
    largest: float
    responses: int
    own_setting: bool
    energy: float

    def __str__(self) -> str:
        if not self.usual > 0:
            return f"{self.method}: exact but for round-off"
        at = "" if self.own_setting else " at its own setting, which this is not"
        tried = (
            f"{self.usual:g} in the median of {self.responses} other responses, "
            f"{self.largest:g} at most{at}"
        )
        if math.isnan(self.measured):
            return f"{self.method}: errors over the peaks: {tried}; refined_error() measures it"
        return (
            f"{self.method}: error about {self.measured:.1g} of the peaks, by a finer run ({tried})"
        )


class Judged(Rows):
    """Rows with the limit states that they reach, and their error."""

    def limit_states(self) -> LimitStates:
        """Return the limit states that the response reaches, with row, drift and source.

        A layered hinge that knows its drawing: cracking, first yield, nominal moment, yield of the
        hoops, spalling, the tensile strain before bars buckle, fracture of hoops and bars, by the
        strains of its layers (in time the analysis needs ``openings=True``); other layered joints:
        where a layer yields in tension. Other springs: their `Spring.landmarks`, cracking, yield
        and cap.
        All: the same of shear springs, loss of 20 % of the strength, collapse, loss of the axial
        load. Of a frame: the first of its `events` of each kind, with the spring as source.
        Nothing of the response is changed.

        Raises
        ------
        InputError
            If the openings of a layered hinge were not kept in time.
        """
        return find_limit_states(self)

    @property
    def error_estimate(self) -> ErrorEstimate:
        """Estimate of the error: measured where that takes about 0.1 s, else by its method."""
        about = self.summary
        method = METHODS[about["method"]]
        short = self.dynamic and about["steps"] * self.structure.n <= _SHORT
        measured = math.nan
        if short and about["status"] == "completed":
            with contextlib.suppress(SolveError):
                measured = self.refined_error().largest
        usual = method.usual_error, method.largest_error, method.responses
        own = not {"dt", "tolerance", "rho_infinity"} & set(self.call)
        energy = about["relative_energy_residual"]
        return ErrorEstimate(method.name, measured, *usual, own, energy)

    def refined_error(self) -> Errors:
        """Solve once more by the next finer setting and return the distance to it.

        That is half the step, or a hundredth of the tolerance, or half of the increments of a
        static path, by the same method. Where the error falls with the setting, as it does unless
        the response is chaotic, it is about as large as this distance. With a tolerance that cannot
        be made much sharper it is the distance to one a hundred times as large, which is more than
        the error. Nothing is below the last digits of the numbers, 2.2e-16 times the root of the
        number of rows.

        Returns
        -------
        rbsdem.run.accuracy.Errors
            Relative differences of the response (rms and largest), of the base moment, the energy
            and the peak; `largest` is the largest of them.

        Raises
        ------
        SolveError
            If the finer setting does not solve the case.
        """
        return _refined_error(self)


@dataclass(frozen=True, repr=False, eq=False)
class Result(Judged, Response):
    """The result of `cyclic` and `time_history`: a response with its limit states and its error."""

    def hinge(self, joint: int = 1, *, length: float | None = None) -> Hinge:
        """Return rotation, plastic rotation and curvature of a hinge.

        Parameters
        ----------
        joint : int, optional
            The joint, from 1 at the ground to n.
        length : float, optional
            Length of the hinge for its curvature [m]. Known of the hinge of a column that was made
            from its drawing by the layered model.

        Raises
        ------
        InputError
            If there is no such joint, or the openings of a layered hinge were not kept in time.
        """
        return hinge_of(self, joint, length)


@dataclass(frozen=True, repr=False, eq=False)
class FrameResult(Judged, frame_result.FrameResult):
    """The result of an analysis of a frame."""


FrameResult.__doc__ = frame_result.FrameResult.__doc__
Result.__doc__ = Response.__doc__


class Analysis(Protocol[P]):
    """An analysis: what it returns depends on the structure."""

    @overload
    def __call__(self, column: Column, *arguments: P.args, **options: P.kwargs) -> Result: ...
    @overload
    def __call__(self, column: Frame, *arguments: P.args, **options: P.kwargs) -> FrameResult: ...
    @overload
    def __call__(
        self, column: Structure, *arguments: P.args, **options: P.kwargs
    ) -> Result | FrameResult: ...


def _typed(run: Callable[Concatenate[Structure, P], Any]) -> Analysis[P]:
    """State to type checkers that an analysis returns the result of its structure."""
    return run  # type: ignore[return-value]


@_typed
def cyclic(
    column: Structure,
    *,
    displacement: ArrayLike | None = None,
    force: ArrayLike | None = None,
    axial_load: ArrayLike | None = None,
    initial: Rows | str | os.PathLike[str] | None = None,
    every: int | None = None,
    collapse_drift: float | None = None,
    openings: bool = False,
    corners: bool = False,
    max_seconds: float | None = None,
) -> Any:
    """Follow the static path of a column through displacements of the top, or lateral forces.

    With `kinematics` "small" and "pdelta" the path goes from event to event (a spring reaches the
    end of its line) without increments or tolerance. With "finite", and where the axial load
    varies, equilibrium is solved for at each point and at each event. The path starts at zero, or
    in the state that another analysis ended in.

    Parameters
    ----------
    column : Column or Frame
        The structure.
    displacement, force : array_like, shape (m,)
        The loading, exactly one of the two: displacement of the top [m] or lateral force [N].
    axial_load : array_like, shape (m,), optional
        Axial load at the top at each point [N], compression positive, in place of the constant one
        of the column; it changes in proportion on the way from point to point, and the path starts
        under its first value. With `Column(axial_force_ratio=r)` the load is this one plus r F.
        With `kinematics` "small" it acts on axial springs and layered joints alone.
    initial : Result or path-like, optional
        The result of this column in whose end the path begins, or a file that
        `Result.save_state` or the executable wrote. A static result that was driven by the same
        quantity gives the same numbers as one path, to the last bit. After a response in time the
        top is held where the motion has brought it, the velocities vanish, and the joints come to
        equilibrium; so do they where the axial load is another. Axial load, loading, method, masses
        and damping may differ, springs, lengths, number of bodies and kinematics not. Energies are
        counted from the virgin column; rows and peaks are those of this path.
    every : int, optional
        Keep every n-th point and the last one. By default all points are kept.
    collapse_drift : float, optional
        Drift at which the structure counts as collapsed, of a storey of a frame
        (`Frame.collapse`), of a column displacement of the top over the height: the path ends
        there, and `summary["status"]` is "collapsed".
    openings : bool, optional
        Whether to keep the openings of layered joints, for `Result.elongation` and
        `Result.layer_deformation`.
    corners : bool, optional
        Whether to keep rows between the points too, where a spring leaves its line.
    max_seconds : float, optional
        A path that takes longer [s] ends there: `summary["status"]` is "stopped", and its rows are
        those up to there.

    Returns
    -------
    Result or FrameResult
        A row for each point kept. Where the layers of a joint can no longer carry the axial load,
        the path ends with the state there as its last row; `summary["status"]` is "axial_failure"
        and `summary["lost_joint"]` is the number of the joint. `summary` has then also the
        load that was lost, `axial_capacity` at that rotation [N], and the `fall` of the joint until
        it would rest [m; NaN: it does not] with its `fall_energy` [J].

    Raises
    ------
    InputError
        For bad input.
    SolveError
        If the path cannot be continued (a force beyond the capacity); its attribute `result` holds
        the path up to that point, with the last good state as its last row.

    Warns
    -----
    AccuracyWarning
        If a body turns by more than 0.1 rad with `kinematics` "small" or "pdelta", or the top goes
        beyond half of the height.
    """
    given = {"displacement": displacement, "force": force}
    driven = [(name, values) for name, values in given.items() if values is not None]
    if len(driven) != 1:
        raise InputError("cyclic: give exactly one of displacement and force")
    name, values = driven[0][0], _arguments.vector(driven[0][1], driven[0][0])
    if values.size == 0:
        raise InputError(f"{name} is empty; give at least one point")
    load = None if axial_load is None else _arguments.vector(axial_load, "axial_load")
    kept = not checked_structure(column).opens and _arguments.boolean(openings, "openings")
    settings = settings_of(every, kept, collapse_drift=collapse_drift, max_seconds=max_seconds)
    state = None if initial is None else state_of(initial, "cyclic")
    wanted = _arguments.boolean(corners, "corners")
    if isinstance(column, Frame):
        settings = _core.joined([settings, *column._lost()])
    run = _core.cyclic(column._made, settings, name == "force", values, load, state, wanted)
    call = {name: values, "axial_load": load, "initial": _recorded_state(initial)}
    call |= {"every": every, "collapse_drift": collapse_drift, "max_seconds": max_seconds}
    return _return(column, run, {"analysis": "static", "driven": name}, call)


def reached_force(column: Structure, displacement: ArrayLike) -> tuple[Array, SolveError | None]:
    """Return the lateral forces along a path up to its end or the first that is not finite [N].

    The last row of an analysis that stopped is where it failed, and left out; the error is returned
    with the forces.
    """
    error = None
    try:
        force = cyclic(column, displacement=displacement).force
    except SolveError as stopped:
        error = stopped
        force = np.empty(0) if stopped.result is None else stopped.result.force[:-1]
    force = force[: np.size(displacement)]
    bad = np.flatnonzero(~np.isfinite(force))
    return (force[: bad[0]] if bad.size else force), error


@_typed
def time_history(
    column: Structure,
    time: ArrayLike | GroundMotion | None = None,
    *,
    force: ArrayLike | None = None,
    ground_acceleration: ArrayLike | GroundMotion | None = None,
    initial: Mapping[str, ArrayLike] | Rows | str | os.PathLike[str] | None = None,
    vertical_acceleration: ArrayLike | GroundMotion | None = None,
    axial_load: ArrayLike | None = None,
    collapse_drift: float | None = None,
    every: int | None = None,
    openings: bool = False,
    motion: bool = False,
    **solver: Unpack[Solver],
) -> Any:
    """Compute the response in time to forces at the top and motions of the ground.

    Parameters
    ----------
    column : Column or Frame
        The structure; a frame needs an implicit method ("newmark", "hht", "generalised_alpha").
    time : array_like of shape (m,), or GroundMotion, optional
        Times of the loading, ascending [s]; two are enough for a free vibration. A `GroundMotion`
        brings its own, and may stand here: ``time_history(column, motion)``.
    force : array_like, shape (m,), optional
        Lateral force at the top [N], linear between the times.
    ground_acceleration : array_like of shape (m,), or GroundMotion, optional
        Acceleration of the ground [m/s2], linear between the times.
    initial : mapping, Result or path-like, optional
        State at the start. As a mapping: "slip" [m], "rotation" [rad], "opening" [m], and
        "slip_velocity", "rotation_velocity", "opening_velocity", each of shape (n,). The springs
        are loaded from zero to this state. Without "opening" the joints start in equilibrium under
        axial load and weight. As a `Result` of this column, or a file that `Result.save_state` or
        the executable wrote: the state that it ended in. Times that begin where those of the
        result end give the numbers of one analysis, if the method is the same. After a
        static path the column starts at rest; its lateral force is let go, unless `force` holds
        it. `cyclic` says what may differ.
    vertical_acceleration : array_like of shape (m,), or GroundMotion, optional
        Vertical acceleration of the ground, upward positive [m/s2].
    axial_load : array_like, shape (m,), optional
        Axial load at the top [N], compression positive, in place of the constant one of the column.
    collapse_drift : float, optional
        Drift at which the structure counts as collapsed, of a storey of a frame
        (`Frame.collapse`), of a column displacement of the top over the height: the analysis ends
        there, and `summary["status"]` is "collapsed".
    every : int, optional
        Keep every n-th step and the last one. By default rows are kept as described for `dt` of
        `Solver`.
    openings : bool, optional
        Whether to keep the openings of layered joints, for `Result.elongation` and
        `Result.layer_deformation`.
    motion : bool, optional
        Whether to keep how the top moves, for `Result.velocity`, `Result.acceleration` and
        `Result.absolute_acceleration`; `summary` then has "peak_floor_acceleration" [m/s2], the
        largest absolute acceleration of the top at the ends of all steps, in size.
    **solver
        Settings of the method, see `rbsdem.Solver`: method, dt, events, tolerance, rho_infinity,
        allow_unstable, max_seconds.

    Returns
    -------
    Result
        A row for each time kept; the first row is the start. Where the layers of a joint can no
        longer carry the axial load, the analysis ends; `summary["status"]` is "axial_failure".

    Raises
    ------
    InputError
        For bad input, and for a step beyond the stability limit (the message gives the limit).
    SolveError
        If the motion grows without bounds, or a step does not converge; its attribute `result`
        holds the rows up to that point.

    Warns
    -----
    AccuracyWarning
        If a body turns by more than 0.1 rad with `kinematics` "small" or "pdelta", and if vertical
        loads have no effect on the column.
    LongRunWarning
        Before a run starts that is expected to take more than 5 s; it names the faster method.
    """
    given = {
        "force": force,
        "ground_acceleration": ground_acceleration,
        "vertical_acceleration": vertical_acceleration,
        "axial_load": axial_load,
    }
    time, arrays = acting(time, given, "time_history")
    loads = {name: _arguments.vector(values, name) for name, values in arrays.items()}
    for name, values in loads.items():
        if values.size == 0:
            raise InputError(f"{name} is empty; give one value for each time")
    if not loads and not initial:
        raise InputError(
            "time_history: nothing acts; give a load (" + ", ".join(given) + ") or an initial state"
        )
    if time is None:
        raise InputError("time_history: time is missing; give the times of the loading")
    chosen = checked_solver(solver, "time_history") | {"collapse_drift": collapse_drift}
    kept = not checked_structure(column).opens and _arguments.boolean(openings, "openings")
    moves = _arguments.boolean(motion, "motion")
    settings = settings_of(every, kept, moves, **chosen)
    times = _arguments.vector(time, "time")
    if initial is None or isinstance(initial, Mapping):
        begin, state, kept_initial = _initial_state(initial, column), None, initial
    else:
        begin, state = (_NONE, False), state_of(initial, "time_history")
        kept_initial = _recorded_state(initial)
    thresholds = all_thresholds(column, kept)
    tell = partial(_tell, kind=LongRunWarning)
    run, reached = _core.time_history(
        column._made, settings, times, loads, *begin, state, thresholds, tell
    )
    call = {"time": times, **loads, "initial": kept_initial, **chosen, "every": every}
    return _return(column, run, {"analysis": "dynamic"}, call, reached)


def _tell(note: str, kind: type[Warning] = AccuracyWarning) -> None:
    if NOTES_ON.get():
        warn(note, kind)


def _recorded_state(initial: Any) -> Any:
    """Return the record of `initial`: a path as text, of a result its state."""
    if isinstance(initial, HasEndState):
        return initial.state
    return os.fspath(initial) if isinstance(initial, (str, os.PathLike)) else initial


def _initial_state(
    initial: Mapping[str, ArrayLike] | None, column: Structure
) -> tuple[Array, bool]:
    """Return deformations and velocities at the start, and whether openings are given.

    An empty array means a column at rest.
    """
    if not initial:
        return _NONE, False
    if isinstance(column, Frame):
        raise InputError(
            "time_history: a frame begins under its dead load, or with initial= in the state that "
            "another analysis ended in; it takes no deformations of joints"
        )
    n = len(column.joint_numbers)
    known = _DEFORMATIONS if column.opens else _DEFORMATIONS[:2]
    parts = {name: np.zeros(n) for name in (*known, *(f"{name}_velocity" for name in known))}
    for name, values in initial.items():
        if name not in parts:
            if name in ("opening", "opening_velocity"):
                raise InputError(
                    f"initial: {name!r} needs joints that open; give the column axial_spring"
                )
            raise InputError(f"initial: {name!r} is not known; it is one of {', '.join(parts)}")
        array = _arguments.finite_vector(np.atleast_1d(values), f"initial: {name}")
        if array.shape != (n,):
            raise InputError(f"initial: {name} has {array.size} values for n = {n} joints")
        parts[name] = array
    return np.concatenate([*parts.values()]), "opening" in initial


def _return(
    column: Structure,
    run: _core.Run,
    about: dict[str, str],
    call: dict[str, Any],
    reached: Array | None = None,
) -> Result | FrameResult:
    arrays, state, summary, error, note = run
    summary |= about
    summary["kinematics"] = column.kinematics
    if "lost_joint" in summary and isinstance(column, Column):
        summary["lost_joint"] = column.joint_numbers[summary["lost_joint"] - 1]
    given = {name: value for name, value in call.items() if value is not None}
    kind = FrameResult if isinstance(column, Frame) else Result
    result = kind(arrays, summary, column, given, state, reached)
    if error is not None:
        error.result = result
        raise error
    told = [note]
    if isinstance(result, FrameResult):
        told += [frame_result.span_note(result), frame_result.shear_span_note(result)]
    for text in told:
        if text:
            _tell(text)
    return result


#: Drift of a push-over that is more than a structure of small rotations has.
_MOST_DRIFT = 1.0


def pushover(
    structure: Structure,
    *,
    drift: float | None = None,
    displacement: float | None = None,
    force: float | None = None,
    pattern: str | None = None,
    points: int = 100,
    initial: Any = None,
) -> Any:
    """Push a frame or a column to one side, from event to event.

    Parameters
    ----------
    structure : Frame or Column
        The structure; a frame stands under its dead load already.
    drift, displacement, force : float, optional
        How far: displacement of the top over the height, displacement [m], or lateral force [N];
        exactly one of them. Under a force a path ends where the structure can carry no more.
    pattern : str, optional
        Shares of the lateral load of a frame in place of its own, see `Frame`.
    points : int, optional
        Rows at equal steps; there is one at each event in addition.
    initial : FrameResult, Result or path-like, optional
        The state that the path begins in.

    Returns
    -------
    FrameResult or Result
        With a row for each point and each event; `events` are the limit states in their order. A
        path that ends before is a result too: its `summary` has "ended" as status, and why as
        reason. `cyclic`, whose path is prescribed, raises `SolveError` there. Where second-order
        moments have used up the strength, the path has ended: beyond, the structure falls.
    """
    given = {"drift": drift, "displacement": displacement, "force": force}
    said = [name for name, value in given.items() if value is not None]
    if len(said) != 1:
        raise InputError("pushover: give exactly one of drift, displacement and force")
    if pattern is not None:
        if not isinstance(structure, Frame):
            raise InputError("pushover: pattern is for frames; a column is pushed at its top")
        structure = replace(structure, pattern=pattern)  # type: ignore[arg-type]
    far = _arguments.number(given[said[0]], f"pushover: {said[0]}", hint=" that is not 0")
    if far == 0:
        raise InputError(f"pushover: {said[0]} = 0 must be a finite number that is not 0")
    if said[0] == "drift":
        if abs(far) > _MOST_DRIFT:
            raise InputError(
                f"pushover: drift = {far:g} is a displacement of {far:g} times the height; drifts "
                "are parts of it, and 2 per cent is 0.02"
            )
        far *= structure.height
    points = _arguments.integer(points, "pushover: points", least=1)
    name = "force" if said[0] == "force" else "displacement"
    way: dict[str, Any] = {name: far * np.arange(1, points + 1) / points}
    try:
        result, reason = cyclic(structure, **way, initial=initial, corners=True), ""
    except SolveError as error:
        if error.result is None or len(error.result.displacement) == 0:
            raise
        result, reason = error.result, str(error)
    if name == "displacement":
        end = _strength_ends(result.displacement, result.force, math.copysign(1.0, far))
        if end is not None:
            # Never on to the other side, where the lateral load would hold the structure back.
            way = {name: np.append(way[name][np.abs(way[name]) < abs(end)], end)}
            result = cyclic(structure, **way, initial=initial, corners=True)
            reason = (
                f"the strength is used up at a displacement of {end:.6g} m, a drift of "
                f"{100 * end / structure.height:.3g} %: beyond, the structure falls under its own "
                "weight"
            )
    if reason:
        result.summary.update(status="ended", reason=reason)
    return result


def _strength_ends(displacement: Array, force: Array, side: float) -> float | None:
    """Return where the force of a path to one side has fallen to zero, if it does so.

    It is straight from row to row. Where it snaps back to the other side, that is where it does.
    """
    u, f = side * displacement, side * force
    onward = (u[1:] > u[:-1]) & (u[1:] > 0)
    falls = np.flatnonzero(onward & (f[1:] < 0) & (np.maximum.accumulate(f)[:-1] > 0))
    falls = falls[f[falls + 1] < f[falls]]
    if falls.size == 0:
        # It may have ended on its way back on the other side.
        return float(side * u.max()) if f[-1] < 0 < f.max() and u[-1] < u.max() else None
    i = falls[0]
    if f[i] <= 0:
        return float(side * u[: i + 1].max())
    return float(side * (u[i] + (u[i + 1] - u[i]) * f[i] / (f[i] - f[i + 1])))


def _refined_error(result: Rows) -> Errors:
    """Return the differences of a result from that of the next finer setting."""
    with unwarned():
        # They were told with the result itself.
        if result.dynamic:
            finer: Any = time_history(result.structure, **_finer(result))
        else:
            finer = cyclic(result.structure, **_divided(result))
    driven = "displacement" in result.call
    points = result.time
    if not result.dynamic:
        points = points[(points >= 0) & (points == np.floor(points))]
    one = answer_of(result, points, driven)
    other = answer_of(finer, points, driven, 1 if result.dynamic else 2)
    found = asdict(errors_of(one, other))
    # Two runs with the same digits say no more than that the error is within their last ones.
    least = math.sqrt(one.time.size) * sys.float_info.epsilon
    return Errors(**{name: max(error, least) for name, error in found.items()})


def _finer(result: Rows) -> dict[str, Any]:
    """Return the keywords of `time_history` for the next finer setting."""
    call, about = dict(result.call), result.summary
    method = METHODS[about["method"]]
    if call.get("method", "auto") == "auto":
        call.pop("tolerance", None)
        if method.name == "rk4" and "events located" in about["reason"]:
            call["events"] = "located"
        if method.adaptive and "tolerance" in result.call:
            call["tolerance"] = result.call["tolerance"]
    call["method"] = method.name
    if method.adaptive:
        tolerance = call.get("tolerance", _USUAL_TOLERANCE)
        sharper = max(min(tolerance / _SHARPER, _SHARP), _LEAST)
        # Where there is none that is much sharper, the distance to one that is not bounds it.
        return call | {"tolerance": sharper if 10 * sharper <= tolerance else _SHARPER * tolerance}
    if "every" in call:
        call["every"] *= 2
    if "dt" in call:
        return call | {"dt": call["dt"] / 2}
    # Rows stay at the times of the loading if the step divides all intervals.
    interval, regular = common_interval(call["time"])
    step = about["time_step"]
    parts = 2 * max(math.ceil(interval / step * (1 - 1e-9)), 1)
    return call | {"dt": interval / parts if regular else step / 2}


def _divided(result: Rows) -> dict[str, Any]:
    """Return the keywords of `cyclic` with each increment cut in two."""
    call = dict(result.call)
    name = "displacement" if "displacement" in call else "force"
    path = np.concatenate([[0.0], call[name]])
    fine = np.repeat(call[name], 2)
    fine[::2] = 0.5 * (path[:-1] + path[1:])
    # From the middle of the first increment, every second point is one of the path.
    return call | {name: fine, "every": None, "corners": False}
