"""Ground motions in csv files: a column of times and one of accelerations, or one with a step."""

from __future__ import annotations

import math
import re

import numpy as np

from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.units import UNITS, agreed_unit, unit_named

#: Times that are this part of a step away from even steps are round-off of their printing.
_UNEVEN = 0.02
_SECONDS = ("", "s", "sec", "second", "seconds")
#: The unit at the end of a column's name: ``_g``, `` (g)``, ``[g]``, ``/g``.
_UNIT = re.compile(r"[_(\[ ]+([^_(\[\])]+)[)\]]?$")
_NAMES = ("acceleration", "ground_acceleration", "ground acceleration", "acc", "a_", "ag")


def read_table(
    lines: list[str], path: str, name: str, units: str | None, dt: float | None
) -> GroundMotion:
    """Return the motion of a csv file.

    Parameters
    ----------
    lines : list of str
        The file: lines that start with # are comments, a first line without numbers names the
        columns, which are separated by semicolons, commas, tabs or blanks.
    path : str
        Of the file, for messages.
    name : str
        Of the motion.
    units : str or None
        Unit of the accelerations, if the name of their column ends with none.
    dt : float or None
        Step [s], where there is no column of times; where there is one, the step to which values
        at uneven times are interpolated.

    Raises
    ------
    InputError
        If the rows are not numbers, times do not ascend or are uneven, or the unit is not known.
    """
    labels, rows, numbers = _rows(lines, path)
    time_at, value_at = _columns(labels, rows.shape[1], path)
    unit = agreed_unit(_unit_of(labels[value_at], path) if labels else "", units, f"{path}: ")
    _check_finite(rows, numbers, path)
    values = rows[:, value_at] * UNITS[unit]
    about = next((line.lstrip("# ").strip() for line in lines if line.startswith("#")), "")
    if time_at is None:
        if dt is None:
            raise InputError(f"{path}: has no column with the time; give the step in s, dt=")
        return GroundMotion(values, dt, name, about)
    if len(values) < 2:
        raise InputError(f"{path}: has {len(values)} rows; a motion has two or more")
    values, step = _even(rows[:, time_at], values, dt, path)
    return GroundMotion(values, step, name, about)


def _rows(lines: list[str], path: str) -> tuple[list[str], Array, list[int]]:
    """Return the names of the columns, the values, and the number of the line of each row."""
    labels: list[str] = []
    rows: list[list[float]] = []
    numbers: list[int] = []
    separator: str | None = None
    for number, line in enumerate(lines, 1):
        text = line.strip()
        if not text or text.startswith("#"):
            continue
        if not rows and not labels:
            separator = next((mark for mark in (";", ",", "\t") if mark in text), None)
        cells = [cell.strip() for cell in text.split(separator)]
        while len(cells) > 1 and not cells[-1]:
            cells.pop()
        values = [_number(cell) for cell in cells]
        if not rows and not labels and all(value is None for value in values):
            labels = cells
            continue
        for cell, value in zip(cells, values, strict=True):
            if value is None:
                raise InputError(
                    f"{path} line {number}: {cell[:20]!r} is not a number; correct the file"
                )
        width = len(labels or (rows[0] if rows else values))
        if len(values) != width:
            raise InputError(
                f"{path} line {number}: {len(values)} values for {width} columns; every row has "
                "one for each"
            )
        rows.append([value for value in values if value is not None])
        numbers.append(number)
    if not rows:
        raise InputError(f"{path}: has no rows of numbers")
    return labels, np.array(rows), numbers


def _number(cell: str) -> float | None:
    if "_" in cell:
        return None
    try:
        return float(cell)
    except ValueError:
        return None


def _columns(labels: list[str], width: int, path: str) -> tuple[int | None, int]:
    """Return the column of the times, None if there is none, and that of the accelerations."""
    if not labels:
        if width > 2:
            raise InputError(
                f"{path}: has {width} columns without names; name them in a first line, as "
                "time_s,acceleration_g"
            )
        return (None, 0) if width == 1 else (0, 1)
    plain = [label.lower() for label in labels]
    times = [i for i, label in enumerate(plain) if label in ("t", "t_s") or label[:4] == "time"]
    values = [i for i, label in enumerate(plain) if i not in times and label.startswith(_NAMES)]
    if not values:
        values = [i for i in range(width) if i not in times] if width <= 2 else []
    if len(values) != 1 or len(times) > 1:
        what = "no column" if not values else "more than one column"
        raise InputError(
            f"{path}: {what} is named after the acceleration, or the time is not clear (columns: "
            f"{', '.join(labels)}); name them time_s and acceleration_g, or acceleration_m/s2"
        )
    if times:
        unit = _UNIT.search(plain[times[0]])
        if unit and unit[1].strip() not in _SECONDS:
            raise InputError(
                f"{path}: the times of column {labels[times[0]]} are not in seconds; convert them "
                "and name the column time_s"
            )
    return (times[0] if times else None), values[0]


def _unit_of(label: str, path: str) -> str:
    found = _UNIT.search(label)
    if not found:
        return ""
    unit = unit_named(found[1])
    if not unit and not label.lower().endswith(("acceleration", "acc")):
        raise InputError(
            f"{path}: the unit {found[1]!r} of column {label} is not one of {', '.join(UNITS)}"
        )
    return unit


def _check_finite(rows: Array, numbers: list[int], path: str) -> None:
    bad = np.flatnonzero(~np.isfinite(rows).all(axis=1))
    if bad.size:
        value = rows[bad[0]][~np.isfinite(rows[bad[0]])][0]
        more = f", and {bad.size - 1} more rows" if bad.size > 1 else ""
        raise InputError(
            f"{path} line {numbers[bad[0]]}: a value is {value}{more}; it must be a finite number"
        )


def _even(time: Array, values: Array, dt: float | None, path: str) -> tuple[Array, float]:
    """Return values at even steps, and the step."""
    steps = np.diff(time)
    back = np.flatnonzero(steps <= 0)
    if back.size:
        i = int(back[0])
        raise InputError(
            f"{path}: row {i + 2} of the times, {time[i + 1]:g} s, does not come after the row "
            f"before, {time[i]:g} s; times must ascend strictly"
        )
    step = float((time[-1] - time[0]) / (time.size - 1))
    off = np.abs(time - time[0] - step * np.arange(time.size))
    even = off.max() <= _UNEVEN * step
    if even and dt is None:
        return values, _rounded(step)
    if dt is None:
        i = int(np.argmax(np.abs(steps - step)))
        raise InputError(
            f"{path}: the times are uneven: {steps[i]:g} s from row {i + 1} to row {i + 2}, but "
            f"{step:g} s on average; give dt= to interpolate the values to even steps"
        )
    if not (math.isfinite(dt) and dt > 0):
        raise InputError(f"{path}: dt = {dt:g} s must be above 0")
    count = math.floor((time[-1] - time[0]) / dt * (1 + 1e-9)) + 1
    return np.interp(time[0] + dt * np.arange(count), time, values), dt


def _rounded(step: float) -> float:
    """Return the step without the round-off of printed times: 0.02 for 0.020000000000000004."""
    short = float(f"{step:.10g}")
    return short if abs(short - step) <= 1e-9 * step else step
