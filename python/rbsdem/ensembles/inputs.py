"""Columns, motions and scales as the engine takes them, checked all at once."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.column import Column, checked_column
from rbsdem.errors import InputError

__all__ = ["Motion", "named_columns", "named_motions", "scale_array"]

#: More faults than this are only counted.
MOST_FAULTS = 25


@dataclass(frozen=True, eq=False)
class Motion:
    """Times [s] and accelerations [m/s2] of a motion of the ground, under a name."""

    name: str | int
    time: Array
    acceleration: Array


def raise_faults(faults: list[str]) -> None:
    """Raise `InputError` with a line for each fault, if there is any."""
    if not faults:
        return
    more = len(faults) - MOST_FAULTS
    text = "\n".join(faults[:MOST_FAULTS])
    raise InputError(text + (f"\nand {more} more" if more > 0 else ""))


def named_columns(columns: Any, faults: list[str]) -> tuple[list[str | int], list[Column]]:
    """Return names and columns; without names they are numbered from 0."""
    if isinstance(columns, Column):
        columns = [columns]
    names, items = _named(columns, "columns", "Column", faults)
    for name, item in zip(names, items, strict=True):
        try:
            checked_column(item)
        except InputError as error:
            faults.append(f"column {name!r}: {error}")
    if not names and not faults:
        faults.append("columns is empty; give at least one Column")
    return names, items


def named_motions(motions: Any, faults: list[str]) -> tuple[int, list[Motion]]:
    """Return how many motions are given, and those that are right.

    A motion is an object with time and acceleration, or a pair of times (or one step) and
    accelerations. Without names of their own they are numbered from 0.
    """
    if hasattr(motions, "acceleration") or _is_pair(motions):
        motions = [motions]
    own = not isinstance(motions, Mapping)
    names, items = _named(motions, "motions", "motion", faults)
    if own:
        names = [_own_name(item, name) for name, item in zip(names, items, strict=True)]
    found = []
    for name, item in zip(names, items, strict=True):
        try:
            found.append(_motion(name, item))
        except InputError as error:
            faults.append(f"motion {name!r}: {error}")
    for name in sorted({str(name) for name in names if names.count(name) > 1}):
        faults.append(
            f"motions: two are called {name!r}; give them other names, as {{name: motion}}"
        )
    if not names and not faults:
        faults.append("motions is empty; give at least one motion")
    return len(names), found


def _named(given: Any, what: str, one: str, faults: list[str]) -> tuple[list[str | int], list[Any]]:
    if isinstance(given, Mapping):
        return list(given.keys()), list(given.values())
    try:
        items = list(given)
    except TypeError:
        faults.append(f"{what} = {type(given).__name__} must be a {one}, or several of them")
        return [], []
    return list(range(len(items))), items


def _own_name(item: Any, number: str | int) -> str | int:
    name = getattr(item, "name", None)
    return name if isinstance(name, str) and name else number


def _is_pair(item: Any) -> bool:
    """Return whether an item is a pair of times, or a step, and as many accelerations."""
    if not isinstance(item, tuple) or len(item) != 2:
        return False
    return all(isinstance(part, (float, int, np.ndarray, list)) for part in item)


def _motion(name: str | int, item: Any) -> Motion:
    if hasattr(item, "time") and hasattr(item, "acceleration"):
        given_time, given = item.time, item.acceleration
    elif _is_pair(item):
        given_time, given = item
    else:
        raise InputError(
            f"a {type(item).__name__} is not a motion; give a GroundMotion, or a pair of times (or "
            "one step) [s] and accelerations [m/s2]"
        )
    acceleration = _core.finite_vector(given, "acceleration")
    if isinstance(given_time, (int, float)):
        step = _core.number(given_time, "step")
        if not step > 0:
            raise InputError(f"step = {step} s must be above zero")
        given_time = step * np.arange(acceleration.size)
    time = _core.finite_vector(given_time, "time")
    if time.size != acceleration.size:
        raise InputError(
            f"{acceleration.size} accelerations for {time.size} times; give one for each"
        )
    if time.size < 2:
        raise InputError(f"{time.size} point(s); give two or more")
    back = np.flatnonzero(~(np.diff(time) > 0))
    if back.size:
        at = int(back[0])
        raise InputError(
            f"time: value {at + 2} of {time.size}, {time[at + 1]} s, does not come after the one "
            f"before, {time[at]} s; times must ascend strictly"
        )
    return Motion(name, time, acceleration)


def scale_array(scales: ArrayLike, columns: int, motions: int, faults: list[str]) -> Array:
    """Return the scales for each column and motion, shape (columns, motions, k); NaN: no run."""
    try:
        given = np.asarray(scales, dtype=np.float64)
    except (TypeError, ValueError):
        faults.append("scales must be numbers")
        return np.ones((columns, motions, 1))
    if given.ndim == 0:
        given = given[None]
    shape = columns, motions, given.shape[-1]
    try:
        full = np.broadcast_to(given, shape)
    except ValueError:
        faults.append(
            f"scales has shape {given.shape}; it must be (k,), ({motions}, k) with a row for each "
            f"motion, or ({columns}, {motions}, k)"
        )
        return np.ones((columns, motions, 1))
    if given.ndim > 3:
        faults.append(f"scales has {given.ndim} dimensions; it can have three")
    wrong = given[np.isinf(given) | (np.abs(given) > _core.BEYOND_MEANING)]
    if wrong.size:
        faults.append(f"scales: {wrong[0]} must be a finite number, or NaN for no run")
    elif np.isnan(given).all():
        faults.append("scales: no run is asked for; give at least one number")
    return full


def check_jobs(jobs: Any, faults: list[str]) -> None:
    """Add a fault if the number of threads is not one."""
    try:
        if jobs is not None and _core.whole(jobs, "jobs") < 1:
            faults.append(f"jobs = {jobs} must be 1 or more")
    except InputError as error:
        faults.append(str(error))
