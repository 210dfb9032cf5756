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
from pathlib import Path

import numpy as np

from rbsdem import _arguments
from rbsdem._tables import STANDARD_GRAVITY, NumberTable, read_lines, read_table
from rbsdem._types import Array
from rbsdem.errors import InputError, RepairWarning, warn
from rbsdem.motions.motion import GroundMotion

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
            f"{path}: {len(values)} values, but NPTS = {count}; the file is truncated, download it "
            "again"
        )
    if missing < 0:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; correct NPTS, or remove what does "
            "not belong to the record"
        )
    if missing:
        warn(
            f"{path}: the last {missing} of NPTS = {count} values are missing; the record ends at "
            f"{dt * (len(values) - 1):g} s",
            RepairWarning,
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
            "download it again"
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
            "download the file again, or correct the line"
        )
    return [_float(word) for word in _NUMBER.findall(row)]


def _float(word: str) -> float:
    return float(word.lower().replace("d", "e"))


#: Times that are this part of a step away from even steps are round-off of their printing.
_UNEVEN = 0.02
_SECONDS = ("", "s", "sec", "second", "seconds")


def read_csv(
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
    # What a comment says is no name of a column.
    rows = ["" if line.startswith("#") else line for line in lines]
    table = read_table((path, rows), least=1)
    time_at, value_at = _columns(table)
    unit = unit_named(table.units[value_at])
    if table.units[value_at] and not unit:
        raise InputError(
            f"{path}: the unit {table.units[value_at]!r} of column {table.names[value_at]} is not "
            f"one of {', '.join(UNITS)}"
        )
    values = table.values[:, value_at] * UNITS[agreed_unit(unit, units, f"{path}: ")]
    about = next((line.lstrip("# ").strip() for line in lines if line.startswith("#")), "")
    if time_at is None:
        if dt is None:
            raise InputError(f"{path}: has no column with the time; give the step in s, dt=")
        return GroundMotion(values, dt, name, about)
    if len(values) < 2:
        raise InputError(f"{path}: has {len(values)} rows; a motion has two or more")
    values, step = _even(table.values[:, time_at], values, dt, path)
    return GroundMotion(values, step, name, about)


def _columns(table: NumberTable) -> tuple[int | None, int]:
    """Return the column of the times, None if there is none, and that of the accelerations."""
    path = table.source
    if not any(table.names):
        if table.columns > 2:
            raise InputError(
                f"{path}: has {table.columns} columns without names; name them in a first line, as "
                "time_s,acceleration_g"
            )
        return (None, 0) if table.columns == 1 else (0, 1)
    time = table.find(("time", "t"))
    value = table.find(("acceleration", "acc", "ag", "a"))
    if value is None and table.columns == (1 if time is None else 2):
        value = 0 if time is None else 1 - time
    if value is None:
        raise InputError(
            f"{path}: no column is named after the acceleration, or more than one ("
            f"{table.describe()}); name them time_s and acceleration_g, or acceleration_m/s2"
        )
    if time is not None and table.units[time].lower() not in _SECONDS:
        raise InputError(
            f"{path}: the times of column {table.names[time]} are not in seconds; convert them "
            "and name the column time_s"
        )
    return time, value


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
    _arguments.number(dt, f"{path}: dt", above=0, unit="s")
    count = math.floor((time[-1] - time[0]) / dt * (1 + 1e-9)) + 1
    return np.interp(time[0] + dt * np.arange(count), time, values), dt


def _rounded(step: float) -> float:
    """Return the step without the round-off of printed times: 0.02 for 0.020000000000000004."""
    short = float(f"{step:.10g}")
    return short if abs(short - step) <= 1e-9 * step else step


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
        acceleration, or with one column. A text of more than one line is taken as such a file.
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
    ending = "" if "\n" in str(path) else _arguments.path(path).suffix.lower()
    if ending in _OTHERS:
        raise InputError(
            f"{path}: the format {ending} is not read here; gmprocess (USGS) or obspy reads it, "
            "and GroundMotion(acceleration, dt) takes the values in m/s2"
        )
    name, lines = read_lines(path)
    # The name of a file may have bytes that are no text.
    stem = Path(name).stem.encode("utf-8", "replace").decode()
    if is_at2(lines) or ending == ".at2":
        if dt is not None:
            raise InputError(f"{name}: dt = {dt} was given, and an AT2 file has its own; remove it")
        return read_at2(lines, name, stem, units)
    if dt is not None:
        dt = _arguments.number(dt, "dt")
    return read_csv(lines, name, stem, units, dt)


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
    motions: list[GroundMotion] = []
    faults: list[str] = []
    for path in paths:
        with _arguments.collected(faults):
            motions.append(read_motion(path, units))
    if faults:
        raise InputError("\n".join(faults))
    return tuple(motions)
