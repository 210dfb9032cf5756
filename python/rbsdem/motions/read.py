"""Files of ground motions: AT2 of the PEER strong-motion databases, and csv.

An AT2 file has four lines above the values: the database, the event with station and component, the
quantity with its unit, and the number of values NPTS with the step DT. Files have gone through many
hands, so what is found in them is read where its meaning is clear, and told where it is mended. A
csv has a column of times and one of accelerations, or one with a step.
"""

from __future__ import annotations

import math
import os
import re
import warnings
from pathlib import Path

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError, RepairWarning
from rbsdem.motions.motion import STANDARD_GRAVITY, GroundMotion

#: Value of each unit in m/s2.
UNITS = {"g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001}

_SPELLINGS = {"gal": "cm/s2", "gals": "cm/s2", "g's": "g", "gs": "g"}


def unit_named(word: str) -> str:
    """Return the name of a unit by one of its spellings, or an empty text.

    Parameters
    ----------
    word : str
        As in a file: "G", "cm/s/s", "cm/sec**2", "gal", "m/s^2".
    """
    plain = word.strip().strip("()[].,").lower().replace(" ", "").replace("sec", "s")
    for power in ("/s/s", "/s^2", "/s**2", "/s²", "s-2", "/s2"):
        if plain.endswith(power):
            plain = plain.removesuffix(power).rstrip(".*·") + "/s2"
            break
    plain = _SPELLINGS.get(plain, plain)
    return plain if plain in UNITS else ""


def checked_unit(units: str, who: str) -> str:
    """Return the name of a unit that a user gives, or raise `InputError` naming all."""
    name = unit_named(str(units))
    if not name:
        raise InputError(f"{who}units = {units!r} is not one of {', '.join(UNITS)}")
    return name


def agreed_unit(found: str, given: str | None, who: str) -> str:
    """Return the unit of a file: the one that it names, or the one that the user gives.

    Parameters
    ----------
    found : str
        The unit that the file names; empty if it names none.
    given : str or None
        The unit that the user gives.
    who : str
        What a message starts with.

    Raises
    ------
    InputError
        If the two differ, or if there is none: a unit is never guessed.
    """
    wanted = "" if given is None else checked_unit(given, who)
    if found and wanted and found != wanted:
        raise InputError(
            f"{who}the file says that its accelerations are in {found}, and units = {given!r} was "
            "given; leave units out, or correct the file"
        )
    if not (found or wanted):
        raise InputError(
            f"{who}the file does not name the unit of its accelerations; give units='g', 'm/s2' "
            "or 'cm/s2'"
        )
    return found or wanted


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


#: Times that are this part of a step away from even steps are round-off of their printing.
_UNEVEN = 0.02
_SECONDS = ("", "s", "sec", "second", "seconds")
#: The unit at the end of a column's name: ``_g``, `` (g)``, ``[g]``, ``/g``.
_UNIT_OF_COLUMN = re.compile(r"[_(\[ ]+([^_(\[\])]+)[)\]]?$")
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
        unit = _UNIT_OF_COLUMN.search(plain[times[0]])
        if unit and unit[1].strip() not in _SECONDS:
            raise InputError(
                f"{path}: the times of column {labels[times[0]]} are not in seconds; convert them "
                "and name the column time_s"
            )
    return (times[0] if times else None), values[0]


def _unit_of(label: str, path: str) -> str:
    found = _UNIT_OF_COLUMN.search(label)
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


#: Largest file that is read [bytes].
_MOST_BYTES = 500_000_000
#: Endings of the files that `read_motions` takes from a folder.
ENDINGS = (".at2", ".csv", ".txt")
#: Formats with much in them besides the accelerations, which other programs read well.
_OTHERS = (".smc", ".v1", ".v2", ".v1c", ".v2c", ".v3", ".cosmos", ".evt", ".mseed", ".sac")


def read_motion(
    path: str | os.PathLike[str], units: str | None = None, dt: float | None = None
) -> GroundMotion:
    """Read a record of a ground motion.

    Parameters
    ----------
    path : path
        An AT2 file of the PEER databases, old or new; or a csv with columns of time and
        acceleration, or with one column.
    units : {"g", "m/s2", "cm/s2", "mm/s2"}, optional
        Unit of the accelerations, where the file does not name it: the third line of an AT2 file,
        or the name of the column, ``acceleration_g``. It is never guessed.
    dt : float, optional
        For a csv: the step [s] if there is no column of times, or the step to which values at
        uneven times are interpolated.

    Raises
    ------
    InputError
        If the file cannot be read, with its name, the line and a remedy.

    Warns
    -----
    RepairWarning
        If a few of the last values of an AT2 file are missing.
    """
    name = _arguments.file(path)
    lines = _lines(name)
    # The name of a file may have bytes that are no text.
    stem = Path(name).stem.encode("utf-8", "replace").decode()
    if is_at2(lines) or name.lower().endswith(".at2"):
        if dt is not None:
            raise InputError(f"{name}: dt = {dt} was given, and an AT2 file has its own; remove it")
        return read_at2(lines, name, stem, units)
    if dt is not None:
        dt = _arguments.number(dt, "dt")
    return read_table(lines, name, stem, units, dt)


def read_motions(
    folder: str | os.PathLike[str], units: str | None = None, pattern: str = "*"
) -> tuple[GroundMotion, ...]:
    """Read all records of a folder, in the order of their names.

    Parameters
    ----------
    folder : path
        Folder with files that end with .AT2, .csv or .txt; other files are left out.
    units : str, optional
        As for `read_motion`, for files that do not name their unit.
    pattern : str, optional
        Files to read, as a shell understands it: ``"RSN*_H*.AT2"``.

    Raises
    ------
    InputError
        With a line for every file that cannot be read, or if there is none.

    Warns
    -----
    RepairWarning
        As `read_motion`.
    """
    place = _arguments.path(folder, "folder")
    _arguments.text(pattern, "pattern")
    if not place.is_dir():
        raise InputError(f"{place} is not a folder; for one record call read_motion")
    paths = sorted(
        path
        for path in place.glob(pattern)
        if path.suffix.lower() in ENDINGS and path.is_file() and not path.name.startswith(".")
    )
    if not paths:
        raise InputError(
            f"{place}: no file {pattern!r} with the ending {', '.join(ENDINGS)} is there"
        )
    motions, faults = [], []
    for path in paths:
        try:
            motions.append(read_motion(path, units))
        except InputError as error:
            faults.append(str(error))
    if faults:
        raise InputError("\n".join(faults))
    return tuple(motions)


def _lines(path: str) -> list[str]:
    """Return the lines of a file, whatever system and code they come from."""
    ending = Path(path).suffix.lower()
    if ending in _OTHERS:
        raise InputError(
            f"{path}: the format {ending} is not read here; gmprocess (USGS) or obspy reads it, "
            "and GroundMotion(acceleration, dt) takes the values in m/s2"
        )
    if os.path.isdir(path):
        raise InputError(f"{path} is a folder; read_motions reads all records of one")
    try:
        if os.path.getsize(path) > _MOST_BYTES:
            raise InputError(f"{path}: larger than {_MOST_BYTES // 10**6} MB; this is no record")
        with open(path, "rb") as file:
            raw = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    if b"\0" in raw[:4096]:
        raise InputError(f"{path}: is not a text file; get the record as AT2 or csv")
    lines = raw.decode("utf-8-sig", "replace").splitlines()
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: is empty; get the record anew")
    return lines
