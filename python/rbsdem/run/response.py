"""Static paths, push-overs and responses in time."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, Concatenate, ParamSpec, Protocol, overload

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._types import Array, ArrayLike, Unpack
from rbsdem.errors import InputError, SolveError
from rbsdem.model.column import NOTES_ON, Column
from rbsdem.motions.motion import GroundMotion, acting
from rbsdem.run.building_result import BuildingResult, both_planes_note
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.frame_result import FrameResult, shear_span_note
from rbsdem.run.rows import Result
from rbsdem.run.solve import HasEndState, follow, march, tell
from rbsdem.run.solver import STATIC, PathMethod, Solver, checked_solver
from rbsdem.section.frame import Frame, Structure, checked_structure
from rbsdem.section.plan import Building

P = ParamSpec("P")


class Analysis(Protocol[P]):
    """An analysis: what it returns depends on the structure.

    Every analysis takes the structure as its first argument, `column`, also where it is a frame.
    """

    @overload
    def __call__(self, column: Column, *arguments: P.args, **options: P.kwargs) -> ColumnResult: ...
    # A Building is a Frame with another result: it stands first, and type checkers see an overlap.
    @overload
    def __call__(  # type: ignore[overload-overlap]
        self, column: Building, *arguments: P.args, **options: P.kwargs
    ) -> BuildingResult: ...
    @overload
    def __call__(self, column: Frame, *arguments: P.args, **options: P.kwargs) -> FrameResult: ...
    @overload
    def __call__(
        self, column: Structure, *arguments: P.args, **options: P.kwargs
    ) -> ColumnResult | FrameResult | BuildingResult: ...


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
    initial: Result | str | os.PathLike[str] | None = None,
    every: int | None = None,
    collapse_drift: float | None = None,
    openings: bool = False,
    corners: bool = False,
    method: PathMethod | None = None,
    max_seconds: float | None = None,
) -> Any:
    """Follow the static path of a column through displacements of the top, or lateral forces.

    With `kinematics` "small" and "pdelta" the path goes from event to event (a spring reaches the
    end of its line) without increments or tolerance, or by `method="newton"` from point to point.
    With "finite", and where the axial load varies, equilibrium is solved for at each point and at
    each event. The path starts at zero, or in the state that another analysis ended in.

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
        Whether to keep the openings of layered joints, for `ColumnResult.elongation` and
        `ColumnResult.layer_deformation`.
    corners : bool, optional
        Whether to keep rows between the points too: where a spring leaves its line, or a leap ends.
    method : {"static", "newton"}, optional
        "static" goes from event to event (the default), "newton" in leaps from point to point by
        Newton's method, which solves large drawn frames in a small part of the time. In a leap
        every spring follows its rule exactly, in one direction or by one turning point. A leap is
        halved if springs that turn in it may change the force by 1e-4 of the largest force, or if
        the balance of work is not met; where a 64th of the leap still fails, or it has few events,
        that part goes from event to event. `error_estimate` is what the springs that turn may have
        changed in all leaps, mostly more than the error (``studies/random_frames.py --kind
        leaps``); drops of the force below 2 % of it may be passed over. Columns with "finite",
        under axial loads that vary, or with "small" go from event to event all the same.
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
        it would rest [m; NaN: it does not] with its `fall_energy` [J]. Of a frame
        `summary["fallen_member"]` is the number of the member, which a warning and `events` name.

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
    loads = {"displacement": displacement, "force": force}
    driven = [(name, values) for name, values in loads.items() if values is not None]
    if len(driven) != 1:
        raise InputError("cyclic: give exactly one of displacement and force")
    name, values = driven[0][0], _arguments.vector(driven[0][1], driven[0][0])
    if values.size == 0:
        raise InputError(f"{name} is empty; give at least one point")
    load = None if axial_load is None else _arguments.vector(axial_load, "axial_load")
    kept = not checked_structure(column).opens and _arguments.boolean(openings, "openings")
    call: dict[str, Any] = {name: values, "axial_load": load, "initial": initial}
    call |= {"collapse_drift": collapse_drift, "max_seconds": max_seconds}
    call["method"] = None if method is None else _arguments.choice(method, "cyclic: method", STATIC)
    wanted = _arguments.boolean(corners, "corners")
    run = follow(column, call, every=every, openings=kept, corners=wanted)
    call |= {"initial": _recorded_state(initial), "every": every, "corners": wanted or None}
    return _return(column, run, {"analysis": "static", "driven": name}, call)


def reached_force(column: Structure, displacement: ArrayLike) -> tuple[Array, SolveError | None]:
    """Return the lateral forces along a path up to its end or the first that is not finite [N].

    The last row of an analysis that stopped is where it failed, and is left out; the error is
    returned with the forces. No notes are told.
    """
    path = _arguments.vector(displacement, "displacement")
    channels, _, _, error, _ = follow(column, {"displacement": path}, with_end=False)
    force = channels["force"][: path.size if error is None else -1]
    bad = np.flatnonzero(~np.isfinite(force))
    return (force[: bad[0]] if bad.size else force), error


@_typed
def time_history(
    column: Structure,
    time: ArrayLike | GroundMotion | tuple[GroundMotion, GroundMotion] | None = None,
    *,
    force: ArrayLike | None = None,
    ground_acceleration: ArrayLike | GroundMotion | None = None,
    initial: Mapping[str, ArrayLike] | Result | str | os.PathLike[str] | None = None,
    vertical_acceleration: ArrayLike | GroundMotion | None = None,
    axial_load: ArrayLike | None = None,
    ground_acceleration_y: ArrayLike | GroundMotion | None = None,
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
        brings its own, and may stand here: ``time_history(column, motion)``; two of a building
        are along x and y: ``time_history(building, (east_west, north_south))``.
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
    ground_acceleration_y : array_like of shape (m,), or GroundMotion, optional
        Of a building acceleration of the ground along y [m/s2]; `ground_acceleration` is along x.
    collapse_drift : float, optional
        Drift at which the structure counts as collapsed, of a storey of a frame
        (`Frame.collapse`), of a column displacement of the top over the height: the analysis ends
        there, and `summary["status"]` is "collapsed".
    every : int, optional
        Keep every n-th step and the last one. By default rows are kept as described for `dt` of
        `Solver`.
    openings : bool, optional
        Whether to keep the openings of layered joints, for `ColumnResult.elongation` and
        `ColumnResult.layer_deformation`.
    motion : bool, optional
        Whether to keep how the top moves, for `ColumnResult.velocity`,
        `ColumnResult.acceleration` and `ColumnResult.absolute_acceleration`; `summary` then has
        "peak_floor_acceleration" [m/s2], the largest absolute acceleration of the top at the ends
        of all steps, in size.
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
    drives = {
        "force": force,
        "ground_acceleration": ground_acceleration,
        "vertical_acceleration": vertical_acceleration,
        "axial_load": axial_load,
        "ground_acceleration_y": ground_acceleration_y,
    }
    if isinstance(time, tuple) and len(time) == 2 and isinstance(time[0], GroundMotion):
        if ground_acceleration is not None or ground_acceleration_y is not None:
            raise InputError(
                "time_history: a pair of GroundMotion stands in the place of time, and "
                "ground_acceleration is given too; give one of them"
            )
        drives |= {"ground_acceleration": time[0], "ground_acceleration_y": time[1]}
        time = None
    if isinstance(time, (list, tuple)) and any(isinstance(motion, GroundMotion) for motion in time):
        raise InputError(
            f"time_history: {len(time)} motions at once; give one, or a tuple of two along x and y"
        )
    time, arrays = acting(time, drives, "time_history")
    loads = {name: _arguments.vector(values, name) for name, values in arrays.items()}
    for name, values in loads.items():
        if values.size == 0:
            raise InputError(f"{name} is empty; give one value for each time")
    if not loads and not initial:
        raise InputError(
            f"time_history: nothing acts; give a load ({', '.join(drives)}) or an initial state"
        )
    if time is None:
        raise InputError("time_history: time is missing; give the times of the loading")
    chosen = checked_solver(solver, "time_history") | {"collapse_drift": collapse_drift}
    kept = not checked_structure(column).opens and _arguments.boolean(openings, "openings")
    moves = _arguments.boolean(motion, "motion")
    call = {"time": _arguments.vector(time, "time"), **loads, **chosen, "every": every}
    run, reached = march(column, call | {"initial": initial}, kept, moves)
    call["initial"] = _recorded_state(initial)
    return _return(column, run, {"analysis": "dynamic"}, call, reached)


def _recorded_state(initial: Any) -> Any:
    """Return the record of `initial`: a path as text, of a result its state."""
    if initial is not None and isinstance(initial, HasEndState):
        return initial.state
    return os.fspath(initial) if isinstance(initial, (str, os.PathLike)) else initial


def _return(
    column: Structure,
    run: _core.Run,
    about: dict[str, str],
    call: dict[str, Any],
    reached: Array | None = None,
) -> ColumnResult | FrameResult | BuildingResult:
    """Return the result of a run and tell its notes; raise the error that ended it, if any.

    `about` goes into the summary, `call` holds the keywords of the analysis, `reached` where
    thresholds of limit states were met in time.
    """
    arrays, state, summary, error, note = run
    summary |= about
    summary["kinematics"] = column.kinematics
    if "lost_joint" in summary and isinstance(column, Column):
        summary["lost_joint"] = column.joint_numbers[summary["lost_joint"] - 1]
    settings = {name: value for name, value in call.items() if value is not None}
    kind: Any = FrameResult if isinstance(column, Frame) else ColumnResult
    kind = BuildingResult if isinstance(column, Building) else kind
    result: ColumnResult | FrameResult | BuildingResult = kind(
        arrays, summary, column, settings, state, reached
    )
    if error is not None:
        error.result = result
        raise error
    told = [note]
    if isinstance(result, BuildingResult):
        told.append(both_planes_note(result) if NOTES_ON.get() else "")
    elif isinstance(result, FrameResult):
        told.append(shear_span_note(result))
    for text in told:
        if text:
            tell(text)
    return result


#: Forces below this share of the strength count as zero: they are round-off.
_ROUND_OFF = 1e-9

#: Larger drifts of a push-over are refused: most are percentages.
_MOST_DRIFT = 1.0


def pushover(
    structure: Structure,
    *,
    drift: float | None = None,
    displacement: float | None = None,
    force: float | None = None,
    pattern: str | None = None,
    direction: float | None = None,
    points: int = 100,
    initial: Any = None,
    method: PathMethod | None = None,
) -> Any:
    """Push a frame or a column to one side.

    Parameters
    ----------
    structure : Frame or Column
        The structure; a frame stands under its dead load already.
    drift, displacement, force : float, optional
        How far: displacement of the top over the height, displacement [m], or lateral force [N];
        exactly one of them. Under a force a path ends where the structure can carry no more.
    pattern : str, optional
        Shares of the lateral load of a frame in place of its own, see `Frame`.
    direction : float, optional
        Direction of the lateral load on a building, from x towards y, in place of its own
        [degrees].
    points : int, optional
        Rows at equal steps; there is one at each event in addition.
    initial : FrameResult, Result or path-like, optional
        The state that the path begins in.
    method : {"static", "newton"}, optional
        "static" goes from event to event, "newton" in leaps from point to point, see `cyclic`. The
        default is "newton" for a building in plan whose joints are drawn in layers, and "static"
        for all other structures.

    Returns
    -------
    FrameResult or Result
        A row for each point and each event, or with "newton" each leap; `events` are the limit
        states in their order, those between two rows by interpolation. A path that ends early is a
        result too: its `summary` has "ended" as status, and the cause as reason (`cyclic`, whose
        path is prescribed, raises `SolveError` there). The path ends where second-order moments
        have used up the strength: beyond, the structure falls under its own weight.
    """
    ends = {"drift": drift, "displacement": displacement, "force": force}
    said = [name for name, value in ends.items() if value is not None]
    if len(said) != 1:
        raise InputError("pushover: give exactly one of drift, displacement and force")
    structure = _pushed(structure, pattern, direction)
    far = _arguments.number(ends[said[0]], f"pushover: {said[0]}", hint=" that is not 0")
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
    chosen = method is None and isinstance(structure, Building) and bool(structure.joints)
    method = "newton" if chosen else method
    how: dict[str, Any] = {"initial": initial, "corners": True, "method": method}
    try:
        result, reason = cyclic(structure, **way, **how), ""
    except SolveError as error:
        if error.result is None or len(error.result.displacement) == 0:
            raise
        result, reason = error.result, str(error)
    if name == "displacement":
        end = _strength_ends(result.displacement, result.force, math.copysign(1.0, far))
        if end is not None:
            # Never on to the other side, where the lateral load would hold the structure back.
            way = {name: np.append(way[name][np.abs(way[name]) < abs(end)], end)}
            result = cyclic(structure, **way, **how)
            reason = (
                f"the strength is used up at a displacement of {end:.6g} m, a drift of "
                f"{100 * end / structure.height:.3g} %: beyond, the structure falls under its own "
                "weight"
            )
    if reason:
        result.summary.update(status="ended", reason=reason)
    elif chosen:
        result.summary["reason"] = "a building in plan of layers; 'static' goes by its events"
    return result


def _pushed(structure: Structure, pattern: str | None, direction: float | None) -> Structure:
    """Return a structure with another pattern, or direction, of its lateral load."""
    changes = {"pattern": pattern, "direction": direction}
    changes = {name: value for name, value in changes.items() if value is not None}
    if "direction" in changes and not isinstance(structure, Building):
        raise InputError("pushover: direction is for buildings; a planar frame has one plane")
    if not changes:
        return structure
    if not isinstance(structure, Frame):
        raise InputError("pushover: pattern is for frames; a column is pushed at its top")
    if isinstance(structure, Building):
        return structure.changed(**changes)
    return replace(structure, **changes)  # type: ignore[arg-type]


def _strength_ends(displacement: Array, force: Array, side: float) -> float | None:
    """Return where the force of a path to one side has fallen to zero, if it does so.

    The path is straight from row to row. If it snaps back to the other side, the displacement from
    which it snaps back is returned.
    """
    u, f = side * displacement, side * force
    onward = (u[1:] > u[:-1]) & (u[1:] > 0)
    none = -_ROUND_OFF * f.max()
    falls = np.flatnonzero(onward & (f[1:] < none) & (np.maximum.accumulate(f)[:-1] > 0))
    falls = falls[f[falls + 1] < f[falls]]
    if falls.size == 0:
        # The path may have ended on its way back, with a force to the other side.
        return float(side * u.max()) if f[-1] < 0 < f.max() and u[-1] < u.max() else None
    i = falls[0]
    if f[i] <= 0:
        return float(side * u[: i + 1].max())
    return float(side * (u[i] + (u[i + 1] - u[i]) * f[i] / (f[i] - f[i + 1])))
