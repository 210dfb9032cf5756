"""Analyses of a column."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar, Literal, overload

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular, text_table
from rbsdem._types import Array, ArrayLike, Unpack
from rbsdem.errors import AccuracyWarning, InputError, LongRunWarning, SolveError, warn
from rbsdem.model.column import NOTES_ON, Column
from rbsdem.model.frame import Frame, Structure, checked_structure
from rbsdem.model.frame_result import FrameResult, frame_result_of, span_note
from rbsdem.model.response import Response, response_of
from rbsdem.model.rows import HasEndState, settings_of, state_of
from rbsdem.motions.motion import GroundMotion, acting
from rbsdem.run.solver import Solver, checked_solver

#: What a run in time is watched for: limit states of the column as criteria in numbers, shape
#: (criteria, 6), given whether openings are kept.
Watch = Callable[[Structure, bool], Array]

_DEFORMATIONS = ("slip", "rotation", "opening")
_NONE = np.empty(0)
_NONE.flags.writeable = False
_NO_CRITERIA = np.empty((0, 6))


def no_thresholds(column: Structure, openings: bool) -> Array:
    """Watch for nothing."""
    return _NO_CRITERIA


@dataclass(frozen=True)
class Modes:
    """Natural modes of the uncracked column.

    Attributes
    ----------
    omega, frequency : ndarray, shape (count,)
        Circular frequencies [rad/s] and frequencies [Hz], ascending.
    shapes : ndarray, shape (2n, count), or (3n, count) where the joints open
        Shapes in (slip 1..n, relative rotation 1..n, opening 1..n), one in each column, with
        shape' M shape = 1.
    stable_step : float
        Longest step for which RK4 is stable, damping included [s].
    """

    omega: Array
    frequency: Array
    shapes: Array
    stable_step: float


@dataclass(frozen=True)
class Matrices:
    """Matrices of the uncracked column for small rotations, M q'' + C q' + (K + K_G) q = p.

    Attributes
    ----------
    unknowns : tuple of str
        Order of the unknowns: slip_1, ..., rotation_1, ... (relative to the body below), and
        opening_1, ... where the joints open. In the paper's form theta_1, ... are absolute
        rotations. The last rotation is no unknown where the top is fixed. Of a frame x_, y_ and
        t_ (rotation) with the names of the nodes, b_ for the rotation of beams behind a panel.
    mass, stiffness, geometric, damping : ndarray, shape (unknowns, unknowns)
        In N, m, kg, s and rad. `geometric` holds the second-order work of the axial forces, zero
        with kinematics "small"; of a frame that on chords, what elastic members bend off their
        chords under these forces being part of their `stiffness`.
    """

    unknowns: tuple[str, ...]
    mass: Array
    stiffness: Array
    geometric: Array
    damping: Array


@dataclass(frozen=True, repr=False, eq=False)
class FrameModes(Tabular):
    """Natural modes of a frame before anything yields, under its dead load; `print` makes a table.

    Attributes
    ----------
    omega, frequency, period : ndarray, shape (count,)
        Circular frequencies [rad/s], frequencies [Hz] and periods [s], the lowest first.
    x, y, turn : ndarray, shape (nodes, count)
        Shapes: displacements of the nodes along x and upward, clockwise rotations, with unit modal
        mass.
    mass : ndarray, shape (count,)
        Modal mass that a motion of the ground along x moves [kg].
    participation : ndarray, shape (count,)
        Its share of the mass of the frame.
    frame : Frame
        The frame.
    """

    omega: Array
    frequency: Array
    period: Array
    x: Array
    y: Array
    turn: Array
    mass: Array
    participation: Array
    frame: Frame
    _columns: ClassVar[tuple[str, ...]] = ("frequency Hz", "period s", "mass kg", "participation")

    def __str__(self) -> str:
        return text_table(self.to_pandas())


def _frame_modes(frame: Frame, count: int | None) -> FrameModes:
    answer = _core.evaluate("modes", frame._statement, count=count)
    omega = answer.values[1:]
    x, y, turn, mass = np.split(answer.rows.T, np.arange(1, 4) * frame.n)
    share = mass[0] / (frame.parts.mass or 1.0)  # none moves along x
    return FrameModes(
        omega, omega / (2 * np.pi), 2 * np.pi / omega, x, y, turn, mass[0].copy(), share, frame
    )


@overload
def modes(column: Column, count: int | None = None) -> Modes: ...
@overload
def modes(column: Frame, count: int | None = None) -> FrameModes: ...
def modes(column: Structure, count: int | None = None) -> Modes | FrameModes:
    """Return natural frequencies, mode shapes and the stable step of RK4.

    Parameters
    ----------
    column : Column or Frame
        The axial load takes part with `kinematics` "pdelta" and "finite".
    count : int, optional
        How many modes, the lowest first; each takes a time in proportion to the number of bodies.
        Without it all of them, up to 1506 modes.

    Raises
    ------
    InputError
        If the axial load is above the critical one; the message gives it.

    Warns
    -----
    AccuracyWarning
        If the axial load is so close to the critical one that low frequencies depend on its last
        digits.
    """
    if count is not None:
        count = _arguments.integer(count, "count")
    if isinstance(column, Frame):
        return _frame_modes(column, count)
    answer = _core.evaluate("modes", checked_structure(column)._statement, count=count)
    if answer.text:
        warn(answer.text)
    stable_step, omega = float(answer.values[0]), answer.values[1:]
    return Modes(omega, omega / (2 * np.pi), answer.rows.T, stable_step)


def matrices(column: Structure, form: Literal["symmetric", "paper"] = "symmetric") -> Matrices:
    """Return the matrices of mass, stiffness, geometric stiffness and damping, in full.

    Parameters
    ----------
    column : Column or Frame
        The structure; a frame has the displacements of its nodes as unknowns, x_N-1-1 and so on.
    form : {"symmetric", "paper"}
        In (slip, relative rotation), or in the paper's (slip, absolute rotation) with the rows of
        its eqs 1 and 2 and the mass matrix [A B; C D] of eq 3, its misprints corrected.
        M_symmetric = M_paper T with theta = cumulative sum of phi, and so for the others.
    """
    form = _arguments.choice(form, "form", ("symmetric", "paper"))
    answer = _core.evaluate("matrices", checked_structure(column)._statement, paper=form == "paper")
    unknowns = tuple(answer.text.splitlines())
    return Matrices(unknowns, *(matrix.copy() for matrix in np.split(answer.rows, 4)))


def cyclic(
    column: Structure,
    *,
    displacement: ArrayLike | None = None,
    force: ArrayLike | None = None,
    axial_load: ArrayLike | None = None,
    initial: Response | str | os.PathLike[str] | None = None,
    every: int | None = None,
    collapse_drift: float | None = None,
    openings: bool = False,
    corners: bool = False,
    max_seconds: float | None = None,
) -> Response | FrameResult:
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
    initial : Result or path, optional
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
    run = _core.cyclic(column._statement + settings, name == "force", values, load, state, wanted)
    call = {name: values, "axial_load": load, "initial": _recorded_state(initial)}
    call |= {"every": every, "collapse_drift": collapse_drift, "max_seconds": max_seconds}
    return _return(column, run, {"analysis": "static", "driven": name}, call)


def reached_force(column: Column, displacement: ArrayLike) -> tuple[Array, SolveError | None]:
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


def time_history(
    watch: Watch,
    column: Structure,
    time: ArrayLike | GroundMotion | None = None,
    *,
    force: ArrayLike | None = None,
    ground_acceleration: ArrayLike | GroundMotion | None = None,
    initial: Mapping[str, ArrayLike] | Response | str | os.PathLike[str] | None = None,
    vertical_acceleration: ArrayLike | GroundMotion | None = None,
    axial_load: ArrayLike | None = None,
    collapse_drift: float | None = None,
    every: int | None = None,
    openings: bool = False,
    motion: bool = False,
    **solver: Unpack[Solver],
) -> Response | FrameResult:
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
    initial : mapping, Result or path, optional
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
    statement, thresholds = column._statement + settings, watch(column, kept)
    tell = partial(_tell, kind=LongRunWarning)
    run, reached = _core.time_history(statement, times, loads, *begin, state, thresholds, tell)
    call = {"time": times, **loads, "initial": kept_initial, **chosen, "every": every}
    return _return(column, run, {"analysis": "dynamic"}, call, reached)


def _tell(note: str, kind: type[Warning] = AccuracyWarning) -> None:
    if NOTES_ON.get():
        warn(note, kind)


def _recorded_state(initial: Any) -> Any:
    """Return what a result records of `initial`: a path as text, of a result its state."""
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
) -> Response | FrameResult:
    arrays, state, summary, error, note = run
    summary |= about
    summary["kinematics"] = column.kinematics
    given = {name: value for name, value in call.items() if value is not None}
    result: Response | FrameResult
    if isinstance(column, Frame):
        result = frame_result_of(arrays, column, summary, given, state)
    else:
        if "lost_joint" in summary:
            summary["lost_joint"] = column.joint_numbers[summary["lost_joint"] - 1]
        result = response_of(Response, arrays, column, summary, given, state, reached)
    if error is not None:
        error.result = result
        raise error
    told = span_note(result) if isinstance(result, FrameResult) else ""
    for text in (note, told):
        if text:
            _tell(text)
    return result
