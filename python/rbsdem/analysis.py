"""Analyses of a column."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.column import Column
from rbsdem.errors import InputError
from rbsdem.results import Result, result_from_rows

_INITIAL = ("slip", "rotation", "slip_velocity", "rotation_velocity")


@dataclass(frozen=True)
class Modes:
    """Natural modes of the uncracked column.

    Attributes
    ----------
    omega, frequency : ndarray, shape (2n,)
        Circular frequencies [rad/s] and frequencies [Hz], ascending.
    shapes : ndarray, shape (2n, 2n)
        Shapes in (slip 1..n, relative rotation 1..n), one a column, with shape' M shape = 1.
    stable_step : float
        Longest step for which RK4 is stable, damping included [s].
    """

    omega: Array
    frequency: Array
    shapes: Array
    stable_step: float


def modes(column: Column) -> Modes:
    """Return natural frequencies, mode shapes and the stable step of RK4.

    Parameters
    ----------
    column : Column
        The axial load counts with `kinematics` "pdelta" and "finite".

    Raises
    ------
    InputError
        If the axial load is above the critical one; the message gives it.
    """
    omega, shapes, stable_step = _core.modes(_checked(column)._flat())
    return Modes(omega, omega / (2 * np.pi), shapes, stable_step)


def mass_matrix(column: Column, form: str = "symmetric") -> Array:
    """Return the mass matrix for small rotations, shape (2n, 2n).

    Parameters
    ----------
    column : Column
        The column.
    form : {"symmetric", "paper"}
        In (slip, relative rotation), or the paper's [A B; C D] of eq 3 in (slip, absolute rotation)
        with its misprints corrected. M_symmetric = M_paper T with theta = cumulative sum of phi.
    """
    if form not in ("symmetric", "paper"):
        raise InputError(f"form = {form!r} is not known; it is 'symmetric' or 'paper'")
    return _core.mass_matrix(_checked(column)._flat(), form == "paper")


def cyclic(
    column: Column,
    displacement: ArrayLike | None = None,
    force: ArrayLike | None = None,
    *,
    every: int | None = None,
) -> Result:
    """Follow the static path of a column through displacements of the top, or lateral forces.

    Exact for `kinematics` "small" and "pdelta": the column goes from event to event (end of a line
    of a spring) without increments or tolerance. The path begins at zero.

    Parameters
    ----------
    column : Column
        The column.
    displacement, force : array_like, shape (m,)
        What is driven, exactly one of the two: displacement of the top [m] or lateral force [N].
    every : int, optional
        Every n-th point is kept, and the last; without it all are.

    Returns
    -------
    Result
        A row for each point kept.

    Raises
    ------
    InputError
        For bad input.
    SolveError
        If the path cannot be carried on (a force beyond the capacity); its attribute `result` holds
        the path up to there, with the last good state as last row.
    """
    if (displacement is None) == (force is None):
        raise InputError("cyclic: give exactly one of displacement and force")
    by_force = displacement is None
    name = "force" if by_force else "displacement"
    values = _core.vector(force if by_force else displacement, name)
    every = _every(every)
    rows, summary, error = _core.cyclic(_checked(column)._flat(), by_force, values, every, column.n)
    summary |= {"analysis": "static", "driven": name, "kinematics": column.kinematics}
    return _return(result_from_rows(rows, summary), error)


def time_history(
    column: Column,
    time: ArrayLike,
    force: ArrayLike | None = None,
    ground_acceleration: ArrayLike | None = None,
    dt: float | None = None,
    method: str = "rk4",
    initial: Mapping[str, ArrayLike] | None = None,
    *,
    every: int | None = None,
) -> Result:
    """Compute the response in time to a lateral force, a ground motion, or both.

    Parameters
    ----------
    column : Column
        The column.
    time : array_like, shape (m,)
        Times of the loading, ascending [s]; two are enough for a free vibration.
    force : array_like, shape (m,), optional
        Lateral force at the top [N], linear between the times.
    ground_acceleration : array_like, shape (m,), optional
        Acceleration of the ground [m/s2], linear between the times.
    dt : float, optional
        Step [s]. If it divides every interval of `time`, rows are kept at `time`; else the steps
        run from the first to the last time and a row is kept after each. Without `dt` every
        interval is cut into equal steps not longer than a fifth of the stability limit.
    method : {"rk4"}, optional
        Classical Runge-Kutta with fixed step (the paper's scheme). A spring changes its line at the
        end of a step.
    initial : mapping, optional
        State at the begin: "slip" [m], "rotation" [rad], "slip_velocity", "rotation_velocity", each
        of shape (n,). The springs get there from zero.
    every : int, optional
        Every n-th step is kept, and the last. Without it rows are kept as said for `dt`.

    Returns
    -------
    Result
        A row for each time kept, the first one at the begin.

    Raises
    ------
    InputError
        For bad input, and for a step beyond the stability limit; the message gives the limit.
    SolveError
        If the motion loses all bounds; its attribute `result` holds the rows up to there.
    """
    if method != "rk4":
        raise InputError(f"method = {method!r} is not known; it is 'rk4'")
    flat = _checked(column)._flat()
    rows, summary, error = _core.time_history(
        flat,
        _core.vector(time, "time"),
        _loading(force, "force"),
        _loading(ground_acceleration, "ground_acceleration"),
        _core.UNSET if dt is None else _core.number(dt, "dt"),
        *_initial_state(initial, column.n),
        _every(every),
        column.n,
    )
    summary |= {"analysis": "dynamic", "method": method, "kinematics": column.kinematics}
    return _return(result_from_rows(rows, summary), error)


def _checked(column: Column) -> Column:
    if not isinstance(column, Column):
        raise InputError(f"column = {column!r} must be a Column")
    return column


def _every(every: int | None) -> int:
    if every is None:
        return _core.UNSET_INTEGER
    if _core.whole(every, "every") < 1:
        raise InputError(f"every = {every} must be 1 or more")
    return every


def _loading(values: ArrayLike | None, name: str) -> Array:
    """Return the values of a loading; an empty array stands for none."""
    if values is None:
        return np.empty(0)
    array = _core.vector(values, name)
    if array.size == 0:
        raise InputError(f"{name} is empty; give one value for each time")
    return array


def _initial_state(initial: Mapping[str, ArrayLike] | None, n: int) -> tuple[Array, Array]:
    """Return deformations and velocities (2n) at the begin."""
    parts = {name: np.zeros(n) for name in _INITIAL}
    for name, values in (initial or {}).items():
        if name not in parts:
            raise InputError(f"initial: {name!r} is not known; it is one of {', '.join(_INITIAL)}")
        array = _core.finite_vector(np.atleast_1d(values), f"initial: {name}")
        if array.shape != (n,):
            raise InputError(f"initial: {name} has {array.size} values for n = {n} joints")
        parts[name] = array
    return (
        np.concatenate([parts["slip"], parts["rotation"]]),
        np.concatenate([parts["slip_velocity"], parts["rotation_velocity"]]),
    )


def _return(result: Result, error: Exception | None) -> Result:
    if error is not None:
        error.result = result
        raise error
    return result
