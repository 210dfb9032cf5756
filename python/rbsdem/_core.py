"""The only importer of the compiled extension.

Numbers go in as plain arrays, a status and a message come back; here they become exceptions.
"""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _rbsdem
from rbsdem.errors import InputError, SolveError

Array = NDArray[np.float64]

#: Marks a number that is not given (the constant `unset` of the Fortran part).
UNSET = -float(np.finfo(np.float64).max)

#: The same for a whole number.
UNSET_INTEGER = -int(np.iinfo(np.int32).max)

#: Order of the numbers of a spring, and of the names of rules (`rule_names`, `inner_names`).
SPRING_NUMBERS = ("k", "d_y", "k_post", "k_c", "d_c", "k_y", "k_u", "b0", "b1")
RULES = ("elastic", "bilinear", "takeda")
INNER = ("kc", "kr", "one")

_ANALYSIS_FAILED = 1

#: Names of the figures of a run, in the order of the Fortran summary.
FIGURES = (
    "steps",
    "rows",
    "events",
    "time_step",
    "stable_step",
    "peak_displacement",
    "peak_force",
    "displacement_at_peak_force",
    "input_energy",
    "spring_energy",
    "damping_energy",
    "energy_residual",
    "relative_energy_residual",
)


def version() -> str:
    """Return the version of the compiled part."""
    return _text(_rbsdem.rbs_version_text())


def number(value: Any, name: str) -> float:
    """Return `value` as a float, or raise `InputError` naming it."""
    try:
        if isinstance(value, (bool, np.bool_, str, bytes)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError):
        raise InputError(f"{name} = {value!r} must be a number") from None


def whole(value: Any, name: str) -> int:
    """Return `value` as an int, or raise `InputError` naming it."""
    if isinstance(value, (bool, np.bool_)) or not isinstance(value, (int, np.integer)):
        raise InputError(f"{name} = {value!r} must be a whole number")
    if abs(value) > np.iinfo(np.int32).max:
        raise InputError(f"{name} = {value} is too large")
    return int(value)


def vector(values: ArrayLike, name: str) -> Array:
    """Return `values` as a one-dimensional array of floats, or raise `InputError` naming it."""
    try:
        array = np.asarray(values)
        if array.dtype.kind in "cSUbO" and array.size:
            raise TypeError
        array = array.astype(np.float64)
    except (TypeError, ValueError):
        raise InputError(f"{name} must be an array of numbers") from None
    if array.ndim != 1:
        raise InputError(f"{name} has shape {array.shape}; it must have one dimension")
    return np.ascontiguousarray(array)


def finite_vector(values: ArrayLike, name: str) -> Array:
    """Return `vector(values, name)`, or raise `InputError` naming the first value not finite."""
    array = vector(values, name)
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InputError(
            f"{name}: value {bad[0] + 1} of {array.size} is {array[bad[0]]}; "
            "it must be a finite number"
        )
    return array


def check_spring(rule: str, numbers: Array, inner: str) -> None:
    """Raise `InputError` for numbers that the rule does not allow."""
    _raise(*_rbsdem.rbs_check_spring(rule, numbers, inner))


def spring_response(rule: str, numbers: Array, inner: str, deformation: Array) -> Array:
    """Return the forces of a virgin spring along a path."""
    return _rbsdem.rbs_spring_response(rule, numbers, inner, deformation)


def check_column(column: Mapping[str, Any]) -> None:
    """Raise `InputError` for everything that is wrong with a column."""
    _raise(*_rbsdem.rbs_check_column(**column))


def modes(column: Mapping[str, Any]) -> tuple[Array, Array, float]:
    """Return circular frequencies, shapes (one a column) and the stable step of RK4."""
    omega, shapes, stable_step, status, message = _rbsdem.rbs_modes(**column)
    _raise(status, message)
    return omega, shapes, stable_step


def mass_matrix(column: Mapping[str, Any], paper: bool) -> Array:
    """Return the mass matrix in the paper's or in the symmetric form."""
    mass, status, message = _rbsdem.rbs_mass_matrix(**column, paper=int(paper))
    _raise(status, message)
    return mass


def cyclic(
    column: Mapping[str, Any], by_force: bool, values: Array, every: int, n: int
) -> tuple[Array, dict[str, float], SolveError | None]:
    """Return rows, figures, and the error that ended the static path early."""
    rows = _empty_rows(n, _rbsdem.rbs_kept_rows(values.size, every))
    kept, figures, status, message = _rbsdem.rbs_cyclic(
        **column, by_force=int(by_force), values=values, every=every, rows=rows
    )
    return _finish(rows, kept, figures, status, message)


def time_history(
    column: Mapping[str, Any],
    time: Array,
    force: Array,
    ground: Array,
    dt: float,
    deformation: Array,
    velocity: Array,
    every: int,
    n: int,
) -> tuple[Array, dict[str, float], SolveError | None]:
    """Return rows, figures, and the error that ended the response early."""
    kept, status, message = _rbsdem.rbs_plan(**column, time=time, dt=dt, every=every)
    _raise(status, message)
    rows = _empty_rows(n, kept)
    kept, figures, status, message = _rbsdem.rbs_time_history(
        **column,
        time=time,
        force=force,
        ground=ground,
        dt=dt,
        initial_deformation=deformation,
        initial_velocity=velocity,
        every=every,
        rows=rows,
    )
    return _finish(rows, kept, figures, status, message)


def protocol(amplitudes: Array, cycles: NDArray[np.int32], repeats: int, points: int) -> Array:
    """Return the points of a cyclic protocol."""
    steps = int(cycles.sum()) if cycles.size > 1 else int(cycles[0]) * amplitudes.size
    size = max(4 * points * steps * repeats + 1, 1)
    if size > np.iinfo(np.int32).max:
        raise InputError(f"protocol: {size} points are too many; reduce cycles, repeats or points")
    values, status, message = _rbsdem.rbs_protocol(amplitudes, cycles, repeats, points, size)
    _raise(status, message)
    return values


def read_history(path: str) -> tuple[str, Array, Array]:
    """Return name, displacements [m] and forces [N] of a history file."""
    if not path or "\0" in path:
        raise InputError(f"{path!r} is no path of a file")
    # No row is shorter than two digits, a separator and an end of line.
    most = os.path.getsize(path) // 4 + 1 if os.path.isfile(path) else 1
    if most > np.iinfo(np.int32).max:
        raise InputError(f"{path}: the file is too large")
    # As bytes: f2py takes no letters beyond ASCII.
    answer = _rbsdem.rbs_read_history(os.fsencode(path), most)
    rows, name, displacement, force, status, message = answer
    _raise(status, message)
    return _text(name), displacement[:rows].copy(), force[:rows].copy()


def _empty_rows(n: int, rows: int) -> Array:
    """Return the array that Fortran fills, one row of the result a column."""
    return np.empty((9 + 4 * n, rows), order="F")


def _finish(
    rows: Array, kept: int, figures: Array, status: int, message: bytes
) -> tuple[Array, dict[str, float], SolveError | None]:
    """Cut the rows to those kept; turn bad input into an exception, a failure into an error."""
    error = None
    if status == _ANALYSIS_FAILED:
        error = SolveError(_text(message))
    else:
        _raise(status, message)
    named = {name: float(value) for name, value in zip(FIGURES, figures, strict=True)}
    for name in ("steps", "rows", "events"):
        named[name] = int(named[name])
    return rows[:, :kept].T, named, error


def _raise(status: int, message: bytes) -> None:
    """Raise the exception that a status stands for."""
    if status == 0:
        return
    raise (SolveError if status == _ANALYSIS_FAILED else InputError)(_text(message))


def _text(message: bytes) -> str:
    """Return a message of Fortran without its padding."""
    return message.decode("utf-8", errors="replace").rstrip()
