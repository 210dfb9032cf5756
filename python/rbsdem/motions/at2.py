"""Ground motions in the AT2 format of the PEER strong-motion databases.

Four lines above the values: the database, the event with station and component, the quantity with
its unit, and the number of values NPTS with the step DT. Files have gone through many hands, so
what is found in them is read where its meaning is clear, and told where it is mended.
"""

from __future__ import annotations

import re
import warnings

import numpy as np

from rbsdem.errors import InputError, RepairWarning
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.units import UNITS, agreed_unit, unit_named

#: As many values may be missing at the end, about a line of a file; more is a broken download.
MOST_MISSING = 8

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?")
#: An exponent of three digits, for which Fortran leaves out the letter: 0.25-101.
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d{3})(?![\d.eEdD])")
#: A line that was broken inside a number: it ends with the letter, the sign or the point.
_BROKEN = re.compile(r"(?:\d[eEdD][+-]?|[+-])$")
_VALUE = r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?)"
_COUNT = re.compile(r"NPTS\s*[=:]?\s*(\d+)", re.IGNORECASE)
_STEP = re.compile(rf"\bDT\s*[=:]?\s*{_VALUE}", re.IGNORECASE)
#: Older files: ``4000  0.0050  NPTS, DT``.
_OLD = re.compile(rf"^\s*(\d+)\s+{_VALUE}\s+NPTS\s*,\s*DT", re.IGNORECASE)
_UNIT = re.compile(r"UNITS?\s+(?:OF|:|=)?\s*([^\s,;]+)", re.IGNORECASE)
_MOST_HEAD = 12
#: Removes what a row may be made of.
_MARKS = str.maketrans("", "", "0123456789+-.eE \t")


def is_at2(lines: list[str]) -> bool:
    """Return whether the first lines of a file are those of an AT2 file."""
    return any(re.search("NPTS", line, re.IGNORECASE) for line in lines[:_MOST_HEAD])


def read_at2(lines: list[str], path: str, name: str, units: str | None) -> GroundMotion:
    """Return the motion of an AT2 file.

    Parameters
    ----------
    lines : list of str
        The file.
    path : str
        Of the file, for messages.
    name : str
        Of the motion.
    units : str or None
        Unit of the accelerations, if the file names none.

    Raises
    ------
    InputError
        If the file is no acceleration, or its values cannot be read.

    Warns
    -----
    RepairWarning
        If up to eight values are missing at the end.
    """
    first = _first_row(lines)
    head = "\n".join(lines[:first])
    count, dt = _count_and_step(head, path)
    quantity = next((line for line in lines[:first] if _UNIT.search(line)), "")
    _refuse_other(lines[:first], path)
    found = _UNIT.search(quantity)
    unit = unit_named(found[1]) if found else ""
    if found and not unit:
        raise InputError(
            f"{path}: the unit {found[1]!r} of {quantity.strip()!r} is not one of "
            f"{', '.join(UNITS)}; convert the file"
        )
    unit = agreed_unit(unit, units, f"{path}: ")
    values = _values(lines, first, path)
    missing = count - len(values)
    if missing > MOST_MISSING:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; the file is not whole, get it anew"
        )
    if missing < 0:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; correct NPTS, or remove what does "
            "not belong to the record"
        )
    if missing:
        warnings.warn(
            f"{path}: the last {missing} of NPTS = {count} values are missing; the record ends at "
            f"{dt * (len(values) - 1):g} s",
            RepairWarning,
            stacklevel=4,
        )
    about = lines[1].strip() if first > 1 and "NPTS" not in lines[1].upper() else ""
    return GroundMotion(np.array(values) * UNITS[unit], dt, name, about)


def _first_row(lines: list[str]) -> int:
    """Return the number of lines above the values: up to the last that names NPTS or DT."""
    last = 0
    for number, line in enumerate(lines[:_MOST_HEAD], 1):
        if _COUNT.search(line) or _STEP.search(line) or _OLD.search(line) or "NPTS" in line.upper():
            last = number
    return last


def _count_and_step(head: str, path: str) -> tuple[int, float]:
    lines = head.splitlines()
    old = next((found for line in lines if (found := _OLD.search(line))), None)
    if old:
        count, step = old[1], old[2]
    else:
        several, one = _COUNT.search(head), _STEP.search(head)
        if not (several and one):
            missing = [key for key, at in (("NPTS", several), ("DT", one)) if not at]
            raise InputError(
                f"{path}: the lines above the values give no {' and no '.join(missing)}; they end "
                "with NPTS= 4000, DT= .0050 SEC"
            )
        count, step = several[1], one[1]
    if not (1 < int(count) < 10**8 and 0 < _float(step) <= 1):
        raise InputError(
            f"{path}: NPTS = {count} must be 2 or more and DT = {step} above 0 and at most 1 s; "
            "correct the line above the values"
        )
    return int(count), _float(step)


def _refuse_other(head: list[str], path: str) -> None:
    """Refuse the velocities and displacements that come with an acceleration (VT2, DT2)."""
    text = " ".join(head).upper()
    if "ACCEL" in text:
        return
    for word in ("VELOCITY", "DISPLACEMENT"):
        if word in text:
            raise InputError(
                f"{path}: it says that it holds a {word.lower()}; read the file of the "
                "acceleration (.AT2)"
            )


def _values(lines: list[str], first: int, path: str) -> list[float]:
    values: list[float] = []
    carried, begun = "", 0
    for number, line in enumerate(lines[first:], first + 1):
        row = carried + (line.strip() if carried else line.rstrip())
        begun = begun if carried else number
        carried = ""
        if _BROKEN.search(row):
            carried = row
            continue
        values += _row(row, begun, path)
    if carried:
        raise InputError(
            f"{path} line {begun}: the file ends inside the number {carried.split()[-1]!r}; "
            "get it anew"
        )
    return values


def _row(row: str, number: int, path: str) -> list[float]:
    """Return the values of a line; numbers may touch where the next one is negative."""
    row = row.replace(",", " ")
    if not row.translate(_MARKS):
        try:
            # Nearly all lines are in order.
            return [float(word) for word in row.split()]
        except ValueError:
            pass
    row = _BARE_EXPONENT.sub(r"E\1", row)
    rest = _NUMBER.sub(" ", row).split()
    if rest:
        raise InputError(
            f"{path} line {number}: {rest[0][:20]!r} in {row.strip()[:60]!r} is not a number; "
            "get the file anew, or correct the line"
        )
    return [_float(word) for word in _NUMBER.findall(row)]


def _float(word: str) -> float:
    return float(word.lower().replace("d", "e"))
