"""Files of ground motions: records with a head of statements, and columns.

A record of a database has lines above its values that state the quantity, its unit, the step and
the number of values: AT2 of PEER, the ASCII files of ESM, of AFAD, of K-NET and KiK-net. A table
has a column of times and one of accelerations, or one with a step. Files have gone through many
hands, so what is found in them is read where its meaning is clear, and told where it is mended; a
statement that is not understood is named.
"""

from __future__ import annotations

import itertools
import math
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rbsdem import _arguments
from rbsdem._tables import STANDARD_GRAVITY, NumberTable, read_lines, read_table
from rbsdem._types import Array
from rbsdem.errors import InputError, RepairWarning, warn
from rbsdem.motions.motion import GroundMotion

#: Value of each unit in m/s2.
UNITS = {
    "g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "in/s2": 0.0254,
    "ft/s2": 0.3048,
}  # fmt: skip

_SPELLINGS = {"gal": "cm/s2", "gals": "cm/s2", "g's": "g", "gs": "g"}


def unit_named(word: str) -> str:
    """Return the name of a unit by one of its spellings, or an empty text.

    Parameters
    ----------
    word : str
        As in a file: "G", "cm/s/s", "cm/sec**2", "gal", "m/s^2".
    """
    plain = word.strip().strip("()[].,:;").lower().replace(" ", "").replace("sec", "s")
    for power in ("/s/s", "/s^2", "/s**2", "/s²", "s^-2", "s-2", "/s2"):
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
        Beginning of a message.

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
#: Removes what a row may be made of.
_MARKS = str.maketrans("", "", "0123456789+-.eE \t")


_VALUE = r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?)"
_COUNT = re.compile(
    r"(?:\bNPTS|\bNDATA|\b(?:NUMBER|NO\.?|NUM)[ _]*OF[ _]*(?:DATA|POINTS|SAMPLES|VALUES)\w*)"
    r"\s*[=:]?\s*(\d+)",
    re.IGNORECASE,
)
_STEP = re.compile(
    r"(?:\bDT\b|\bDELTA[ _]*T\b|\bTIME[ _]*(?:STEP|INTERVAL|INCREMENT)"
    rf"|\bSAMPL\w*?[ _]*(?:INTERVAL|PERIOD|STEP))([^\d.+-]*?){_VALUE}\s*(ms)?",
    re.IGNORECASE,
)
_RATE = re.compile(
    r"(?:\bSAMPL\w*?[ _]*(?:RATE|FREQ\w*)|\bSAMPLES\s*(?:/|PER)\s*S\w*)[^\d.+-]*?" + _VALUE,
    re.IGNORECASE,
)
#: Numbers before their names, or alone below the unit: 4000 0.0050 NPTS, DT.
_BEFORE = re.compile(
    rf"^\s*{_VALUE}\s+{_VALUE}\s*(?:(NPTS|DT)\s*,?\s*(?:NPTS|DT)\W*(?:SEC\W*)?)?$", re.IGNORECASE
)
_UNIT_KEY = re.compile(
    r"(?:\b|_)UNITS?(?:\b|_)\s*(?:OF\b|IS\b|ARE\b)?[\s:=(\[]*(.*)", re.IGNORECASE
)
_UNIT_TEXT = re.compile(
    r"(?<![\w/])(?:(?:mm|cm|m|in|ft)\s*[/.*·]?\s*s(?:ec)?\s*(?:/\s*s(?:ec)?|(?:\^|\*\*)?-?2|²)|gals?)"
    r"(?![\w/])|(?<=[(\[])\s*g\s*(?=[)\]])|(?<=,)\s*g\s*$",
    re.IGNORECASE,
)
#: A unit of something else, as that of the times.
_OTHER_UNIT = re.compile(r"(s|sec|seconds?|hz|deg\w*|°)\W*$", re.IGNORECASE)
_QUANTITY = re.compile(r"ACC|PGA", re.IGNORECASE)
_ABOUT = re.compile(
    r"^\W*((?:STATION|COMP|DIR|STREAM|EVENT)\w*?(?:[ _](?:CODE|NAME))?)\.?\s*[:=]\s*(\S.*)$",
    re.IGNORECASE,
)
_KEY_AND_VALUE = re.compile(r"\s*[A-Za-z][^:=]*[:=]")
_MOST_HEAD = 100


def is_record(lines: Sequence[str]) -> bool:
    """Whether the first lines of a file state the number of values, as those of an AT2 file."""
    head = lines[:_MOST_HEAD]
    named = any(_COUNT.search(line) or "NPTS" in line.upper() for line in head)
    return named or any(
        _UNIT_KEY.search(line) and (found := _BEFORE.match(below)) and found[1].isdigit()
        for line, below in itertools.pairwise(head)
    )


def stated_unit(head: Sequence[str], path: str) -> str:
    """Return the unit of the accelerations that lines above the values state, or an empty text.

    Parameters
    ----------
    head : sequence of str
        The lines.
    path : str
        Of the file, for messages.

    Raises
    ------
    InputError
        If a line states a unit that is not known, or two lines state two.
    """
    said: dict[str, str] = {}
    for line in head:
        key = _UNIT_KEY.search(line)
        if not key or not key[1].strip(" )]"):
            continue
        rest = re.split(r"[,;]", key[1])[0]
        found = _UNIT_TEXT.search(line)
        unit = unit_named(rest) or unit_named(rest.split()[0] if rest.split() else "")
        unit = unit or (unit_named(found[0]) if found else "")
        if unit:
            said.setdefault(unit, line.strip())
        elif not _OTHER_UNIT.match(rest.strip()):
            raise InputError(
                f"{path}: the unit {rest.split()[0] if rest.split() else key[1]!r} of "
                f"{line.strip()[:80]!r} is not one of {', '.join(UNITS)}; convert the file"
            )
    if not said:
        for line in head:
            if _QUANTITY.search(line):
                said |= {unit_named(text[0]): line.strip() for text in _UNIT_TEXT.finditer(line)}
    if len(said) > 1:
        told = " and ".join(f"{unit} ({line[:60]!r})" for unit, line in said.items())
        raise InputError(f"{path}: states the units {told}; keep the one that is meant")
    return next(iter(said), "")


def stated_step(head: Sequence[str]) -> float | None:
    """Return the step [s] that lines above the values state, as a step or as a rate, or None."""
    for line in head:
        before = _BEFORE.match(line)
        if before and before[3]:
            return _float(before[1 if before[3].upper() == "DT" else 2])
        step, rate = _STEP.search(line), _RATE.search(line)
        if step:
            thousand = step[3] or re.search(r"\bms\b|[_(]ms\b", step[1], re.IGNORECASE)
            return _float(step[2]) / (1000 if thousand else 1)
        if rate and _float(rate[1]) > 0:
            return 1 / _float(rate[1])
    return None


def stated_count(head: Sequence[str]) -> int | None:
    """Return the number of values that lines above them state, or None."""
    for line in head:
        before = _BEFORE.match(line)
        if before and before[3]:
            word = before[2 if before[3].upper() == "DT" else 1]
            return int(word) if word.isdigit() else None
        if found := _COUNT.search(line):
            return int(found[1])
    return None


def agreed_step(found: float | None, given: float | None, path: str) -> float | None:
    """Return the step of a file: the one that it states, or the one that the user gives."""
    if found is None or given is None:
        return found if given is None else given
    if abs(found - given) > 1e-6 * found:
        raise InputError(
            f"{path}: the file says that its step is {found:g} s, and dt = {given:g} s was given; "
            "leave dt out, or correct the file"
        )
    return found


def read_record(
    lines: list[str], path: str, name: str, units: str | None, dt: float | None
) -> GroundMotion:
    """Return the motion of a file that states the number of its values, line by line.

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
    dt : float or None
        Step [s], if the file states none.

    Raises
    ------
    InputError
        If the file is no acceleration, or its values cannot be read.

    Warns
    -----
    RepairWarning
        If up to eight values are missing at the end.
    """
    first = _first_value(lines)
    head = lines[:first]
    bare = _BEFORE.match(head[-1]) if head else None
    count, step = stated_count(head), stated_step(head)
    if bare and not bare[3] and bare[1].isdigit() and count is None:
        count, step = int(bare[1]), _float(bare[2])
    step = agreed_step(step, dt, path)
    if count is None or step is None:
        missing = [key for key, at in (("NPTS", count), ("DT", step)) if at is None]
        raise InputError(
            f"{path}: the lines above the values give no {' and no '.join(missing)}; they end "
            "with NPTS= 4000, DT= .0050 SEC"
        )
    if not (1 < count < 10**8 and 0 < step <= 1):
        raise InputError(
            f"{path}: NPTS = {count} must be 2 or more and DT = {step:g} above 0 and at most 1 s; "
            "correct the line above the values"
        )
    _refuse_other(head, path)
    unit = agreed_unit(stated_unit(head, path), units, f"{path}: ")
    values = _values(lines, first, path)
    missing_values = count - len(values)
    if missing_values > MOST_MISSING:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; the file is truncated, download it "
            "again"
        )
    if missing_values < 0:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; correct NPTS, or remove what does "
            "not belong to the record"
        )
    if missing_values:
        warn(
            f"{path}: the last {missing_values} of NPTS = {count} values are missing; the record "
            f"ends at {step * (len(values) - 1):g} s",
            RepairWarning,
        )
    second = lines[1].strip() if first > 1 and not _COUNT.search(lines[1]) else ""
    return GroundMotion(np.array(values) * UNITS[unit], step, name, _about(head) or second)


def _first_value(lines: list[str]) -> int:
    """Return the number of lines above the values: up to the last that states something."""
    last = 0
    for number, line in enumerate(lines[:_MOST_HEAD], 1):
        named = _COUNT.search(line) or _STEP.search(line) or _RATE.search(line)
        bare = last == number - 1 and (found := _BEFORE.match(line)) and found[1].isdigit()
        behind = last == number - 1 and _KEY_AND_VALUE.match(line)
        if named or bare or behind or "NPTS" in line.upper() or _UNIT_KEY.search(line):
            last = number
    return last


def _about(head: Sequence[str]) -> str:
    """Return station, component and event from lines of key and value."""
    found = [match for line in head if (match := _ABOUT.match(line))]
    return ", ".join(dict.fromkeys(match[2].strip() for match in found))


def _refuse_other(head: Sequence[str], path: str) -> None:
    """Refuse the velocities and displacements that come with an acceleration (VT2, DT2)."""
    text = " ".join(head).upper()
    if "ACC" in text or "PGA" in text:
        return
    for word in ("VELOCITY", "DISPLACEMENT"):
        if word in text:
            raise InputError(
                f"{path}: it says that it holds a {word.lower()}; read the file of the "
                "acceleration (.AT2)"
            )


#: K-NET and KiK-net: lines of 18 letters for the key and a value, then integers.
_KNET_HEAD = 17
_SCALE = re.compile(rf"{_VALUE}\s*\(gal\)\s*/\s*{_VALUE}", re.IGNORECASE)


def read_knet(lines: list[str], path: str, name: str) -> GroundMotion:
    """Return the motion of a file of K-NET or KiK-net, its mean taken off.

    The files are those of the National Research Institute for Earth Science and Disaster
    Resilience: a scale factor n (gal) / m turns their integers into accelerations. They have an
    offset, and the mean of the record is taken off, as its description says.

    Parameters
    ----------
    lines : list of str
        The file.
    path : str
        Of the file, for messages.
    name : str
        Of the motion.

    Raises
    ------
    InputError
        If the scale factor or the sampling frequency is missing, or the values cannot be read.
    """
    head = {line[:18].strip(): line[18:].strip() for line in lines[:_KNET_HEAD]}
    scale, step = _SCALE.search(head.get("Scale Factor", "")), stated_step(lines[:_KNET_HEAD])
    if scale is None or step is None:
        raise InputError(
            f"{path}: a file of K-NET or KiK-net has the lines Sampling Freq(Hz) and Scale Factor, "
            "as 3920(gal)/6182761, above its values; download it again"
        )
    gal = np.array(_values(lines, _KNET_HEAD, path)) * (_float(scale[1]) / _float(scale[2]))
    values = UNITS["cm/s2"] * (gal - gal.mean())
    said = [head.get(key, "") for key in ("Station Code", "Dir.", "Record Time")]
    about = f"{' '.join(filter(None, said))}; mean of {gal.mean():.4g} gal taken off"
    return GroundMotion(values, step, name, about)


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


def read_columns(
    lines: list[str],
    path: str,
    name: str,
    units: str | None,
    dt: float | None,
    column: str | int | None,
) -> GroundMotion:
    """Return the motion of a file with a row of numbers a line.

    Parameters
    ----------
    lines : list of str
        The file: lines that start with # are comments, lines above the numbers may name the columns
        and state unit and step; columns are separated by semicolons, commas, tabs or blanks.
    path : str
        Of the file, for messages.
    name : str
        Of the motion.
    units : str or None
        Unit of the accelerations, if the file states none.
    dt : float or None
        Step [s], where there is no column of times; where there is one, the step to which values
        at uneven times are interpolated.
    column : str, int or None
        The accelerations, by the name of their column or by its number from 1.

    Raises
    ------
    InputError
        If the rows are not numbers, times do not ascend or are uneven, or the unit is not known.
    """
    # The words of a comment are no names of columns.
    table = read_table((path, ["" if line.startswith("#") else line for line in lines]), least=1)
    head = lines[: len(table.head)]
    _refuse_other(head, path)
    time_at, value_at = _columns(table, column)
    own = table.units[value_at]
    unit = unit_named(own)
    if own and not unit:
        raise InputError(
            f"{path}: the unit {own!r} of column {table.names[value_at]} is not one of "
            f"{', '.join(UNITS)}"
        )
    # The line of names is read; what the others state must not contradict it.
    above = stated_unit(head, path)
    if unit and above and unit != above:
        raise InputError(
            f"{path}: column {table.names[value_at]} is in {unit}, and a line above says {above}; "
            "correct the file"
        )
    unit = agreed_unit(unit or above, units, f"{path}: ")
    values = table.values[:, value_at] * UNITS[unit]
    comment = next((line.lstrip("# ").strip() for line in lines if line.startswith("#")), "")
    about = _about(head) or comment
    step = stated_step(head)
    count = stated_count(head)
    if count is not None and count != len(values):
        raise InputError(
            f"{path}: {len(values)} rows, but {count} are stated; the file is truncated or mixed up"
        )
    if time_at is None:
        step = agreed_step(step, dt, path)
        if step is None:
            raise InputError(f"{path}: has no column with the time; give the step in s, dt=")
        return GroundMotion(values, step, name, about)
    if len(values) < 2:
        raise InputError(f"{path}: has {len(values)} rows; a motion has two or more")
    values, even = _even(table.values[:, time_at], values, dt, path)
    if step is not None and dt is None and abs(step - even) > _UNEVEN * step:
        raise InputError(
            f"{path}: the times have a step of {even:g} s, and a line above says {step:g} s; "
            "correct the file"
        )
    return GroundMotion(values, even, name, about)


def _columns(table: NumberTable, column: str | int | None) -> tuple[int | None, int]:
    """Return the place of the times, None if there are none, and that of the accelerations."""
    path = table.source
    time, found = table.find("time"), table.find("acceleration")
    # ACCELERATION TIME SERIES is no time.
    time = None if time == found else time
    if column is not None:
        value = table.index_of(column, "column")
        if time is None and not any(table.names) and value > 0 and _ascends(table.values[:, 0]):
            time = 0
    elif not any(table.names):
        if table.columns > 2:
            raise InputError(
                f"{path}: has {table.columns} columns without names. If they are columns, say "
                "column=, the number of the accelerations from 1; if they are one record, line by "
                "line, state the number of its values and their step above them, as "
                "NPTS= 4000, DT= .0050 SEC"
            )
        return (None, 0) if table.columns == 1 else (0, 1)
    else:
        if found is None and table.columns == (1 if time is None else 2):
            found = 0 if time is None else 1 - time
        if found is None:
            raise InputError(
                f"{path}: no column is named after the acceleration, or more than one "
                f"({table.describe()}); say column=, its name or its number from 1"
            )
        value = found
    if time is not None and table.units[time].lower() not in _SECONDS:
        raise InputError(
            f"{path}: the times of column {table.names[time]} are not in seconds; convert them "
            "and name the column time_s"
        )
    return (None if time == value else time), value


def _ascends(values: Array) -> bool:
    """Whether values are times: they ascend by even steps."""
    steps = np.diff(values)
    return bool(len(steps) and steps.min() > 0 and np.ptp(steps) <= 2 * _UNEVEN * steps.mean())


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
ENDINGS = (
    ".at2",
    ".csv",
    ".txt",
    ".asc",
    ".ns",
    ".ew",
    ".ud",
    *(f".{direction}{place}" for direction in ("ns", "ew", "ud") for place in (1, 2)),
)
#: Formats with much in them besides the accelerations, which other programs read well.
_OTHERS = (
    ".smc", ".v1", ".v2", ".v1c", ".v2c", ".v3", ".v1a", ".v2a", ".cosmos", ".evt", ".mseed",
    ".sac",
)  # fmt: skip
_VOLUME = re.compile(r"\bCOSMOS\b|\b(un)?corrected accelerogram", re.IGNORECASE)
_AFAD = "STRONG GROUND MOTION RECORDS OF TURKIYE"

#: No ground has moved with more than about 5 g [m/s2].
_LARGEST = 5 * STANDARD_GRAVITY


def read_motion(
    path: str | os.PathLike[str],
    units: str | None = None,
    dt: float | None = None,
    *,
    column: str | int | None = None,
    checks: bool = True,
) -> GroundMotion:
    """Read a record of a ground motion.

    Parameters
    ----------
    path : path-like
        An AT2 file of the PEER databases, old or new; an ASCII file of ESM, AFAD, K-NET or KiK-net;
        or a file with columns of time and acceleration, or with one column. A text of more than
        one line is taken as such a file.
    units : {"g", "m/s2", "cm/s2", "mm/s2", "in/s2", "ft/s2"}, optional
        Unit of the accelerations, where the file does not name it in the name of the column,
        ``acceleration_g``, or in a line above the values. It is never guessed, and one that
        contradicts the file is refused.
    dt : float, optional
        The step [s] if there is no column of times and the file states none, or the step to which
        values at uneven times are interpolated.
    column : str or int, optional
        The accelerations in a file with several components, by the name of their column or by its
        number from 1.
    checks : bool, optional
        False accepts a record of more than 5 g.

    Raises
    ------
    InputError
        If the file cannot be read, with its name, the line and a remedy.

    Warns
    -----
    RepairWarning
        If a few of the last values of a record are missing, or columns of texts are left out.
    """
    ending = "" if "\n" in str(path) else _arguments.path(path).suffix.lower()
    if ending in _OTHERS:
        _refuse_format(path, f"the format {ending}")
    name, lines = read_lines(path)
    if any(map(_VOLUME.search, lines[:3])):
        _refuse_format(name, "a volume of COSMOS, CSMIP or GeoNet")
    if dt is not None:
        dt = _arguments.number(dt, "dt")
    # The name of a file may have bytes that are no text.
    stem = Path(name).stem.encode("utf-8", "replace").decode()
    if lines[0].startswith("Origin Time") and any("Scale Factor" in line for line in lines[:20]):
        motion = read_knet(lines, name, stem)
        agreed_unit("cm/s2", units, f"{name}: ")
        agreed_step(motion.dt, dt, name)
    elif ending == ".at2" or _is_one_record(lines, column):
        motion = read_record(lines, name, stem, units, dt)
    else:
        if _AFAD in lines[0]:
            agreed_unit("cm/s2", units, f"{name}: ")
            units = "cm/s2"
        motion = read_columns(lines, name, stem, units, dt, column)
    if checks and motion.pga > _LARGEST:
        raise InputError(
            f"{name}: the largest acceleration is {motion.pga / STANDARD_GRAVITY:.4g} g; no ground "
            "has moved with more than 5 g. Check the unit, or say checks=False"
        )
    return motion


def _is_one_record(lines: list[str], column: str | int | None) -> bool:
    """Whether the values of one record stand in the lines, as many as are stated."""
    if column is not None or not is_record(lines):
        return False
    first = _first_value(lines)
    count = stated_count(lines[:first])
    # As many lines as values are rows of columns.
    rows = [line for line in lines[first:] if re.match(r"\s*[-+.\d]", line)]
    if count is None or len(rows) == count:
        return count is None
    pairs = [_NUMBER.findall(row) for row in rows[:_MOST_HEAD]]
    # Pairs of which nearly all first numbers ascend are times and accelerations.
    times = np.array([_float(pair[0]) for pair in pairs if len(pair) == 2])
    return len(times) < 0.8 * len(pairs) or float(np.mean(np.diff(times) > 0)) < 0.8


def _refuse_format(path: object, kind: str) -> None:
    raise InputError(
        f"{path}: {kind} is not read here; gmprocess (USGS) or obspy reads it, "
        "and GroundMotion(acceleration, dt) takes the values in m/s2"
    )


def read_motions(
    folder: str | os.PathLike[str],
    units: str | None = None,
    pattern: str = "*",
    *,
    column: str | int | None = None,
    checks: bool = True,
) -> tuple[GroundMotion, ...]:
    """Read all records of a folder, in the order of their names.

    Parameters
    ----------
    folder : path-like
        Folder with files that end with .AT2, .csv, .txt, .asc, or as those of K-NET; other files
        are left out.
    units : str, optional
        As for `read_motion`, for files that do not name their unit.
    pattern : str, optional
        Files to read, as a shell understands it: ``"RSN*_H*.AT2"``.

    column, checks : optional
        As for `read_motion`.

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
            motions.append(read_motion(path, units, column=column, checks=checks))
    if faults:
        raise InputError("\n".join(faults))
    return tuple(motions)
