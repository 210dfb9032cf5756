"""Files of ground motions: records with a head of statements, and columns.

A record of a database has lines above its values that state the quantity, its unit, the step and
the number of values: AT2 of PEER, the ASCII files of ESM, of AFAD, of K-NET and KiK-net. A table
has a column of times and one of accelerations, or one with a step. Files have gone through many
hands, so what is found in them is read where its meaning is clear, and told where it is mended; a
statement that is not understood is named.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._package import unwarned
from rbsdem._tables import STANDARD_GRAVITY, NumberTable, plain, read_lines, read_table
from rbsdem._types import Array
from rbsdem.errors import InputError, RepairWarning, warn
from rbsdem.motions.motion import GroundMotion

#: Value of each unit in m/s2.
UNITS = {
    "g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "in/s2": 0.0254,
    "ft/s2": 0.3048,
}  # fmt: skip

_NUM = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d+)?"
_SECOND = r"(?:s(?:ec(?:onds?)?|eg(?:undos?)?|ek(?:unden?)?|n)?|с(?:ек)?|秒)"
#: A length over the square of a time, in small letters, as "cm/s/s", "cm/sec**2", "m s-2".
_PER_SECOND_SQUARED = (
    r"((?:milli|centi)?met(?:er|re)s?|[mc]?m|[мс]?м|in(?:ch(?:es)?)?|f(?:oo|ee)?t)"
    rf"\s*(?:[/.*·_]|per\b|p(?=s2)|(?<=m)(?=\s|s(?:\s?\^?-2|\^?2|s)(?![a-z\d])))"
    rf"\s*\(?{_SECOND}\)?\s*"
    rf"(?:(?:/|per\b)\s*{_SECOND}|(?:\^|\*\*)?[({{]?\s*-?2|squared|(?<=s)s)[)}}]?(?![a-z0-9])"
)
_DECIMAL_COMMA = re.compile(r"(?<![\w.,])(\d+),(\d+)(?![\d.,])")
_LENGTHS = {
    "mi": "mm",
    "ce": "cm",
    "me": "m",
    "fo": "ft",
    "fe": "ft",
    "мм": "mm",
    "см": "cm",
    "м": "m",
}


def _statement(line: str) -> str:
    """Return a line in small letters, its decimal commas as points, without marks of LaTeX."""
    return _DECIMAL_COMMA.sub(r"\1.\2", plain(line).replace("$", ""))


def unit_named(word: str) -> str:
    """Return the name of a unit by one of its spellings, or an empty text.

    Parameters
    ----------
    word : str
        As in a file: "G", "cm/s/s", "cm/sec**2", "gal", "m/s^2".
    """
    text = _statement(word).strip().strip("()[].,:;'\"").strip()
    if text in ("g", "gs", "g's", "gees"):
        return "g"
    if text in ("gal", "gals", "гал"):
        return "cm/s2"
    match = re.fullmatch(_PER_SECOND_SQUARED, text)
    return f"{_LENGTHS.get(match[1][:2], match[1][:2])}/s2" if match else ""


def checked_unit(units: str, who: str) -> str:
    """Return the name of a unit that a user gives, or raise `InputError` naming all."""
    name = unit_named(str(units))
    if not name:
        raise InputError(f"{who}units = {units!r} is not one of {', '.join(UNITS)}")
    return name


def agreed_unit(stated: str, wanted: str | None, who: str, line: str = "") -> str:
    """Return the unit of a file: the one that it names, or the one that the user gives.

    Parameters
    ----------
    stated : str
        The unit that the file names; empty if it names none.
    wanted : str or None
        The unit that the user gives.
    who : str
        Beginning of a message.
    line : str, optional
        The line that states the unit, or has one that is not clearly that of the values.

    Raises
    ------
    InputError
        If the two differ, or if there is none: a unit is never guessed.
    """
    unit = "" if wanted is None else checked_unit(wanted, who)
    if stated and unit and stated != unit:
        raise InputError(
            f"{who}the file says that its accelerations are in {stated}, and units = {wanted!r} "
            f"was given; leave units out, or correct {repr(line) if line else 'the file'}"
        )
    if not (stated or unit):
        asked = f" (does {line!r} state it?)" if line else ""
        raise InputError(
            f"{who}the file does not name the unit of its accelerations{asked}; give units='g', "
            "'m/s2' or 'cm/s2'"
        )
    return stated or unit


#: As many values may be missing at the end, about a line of a file; more is a broken download.
MOST_MISSING = 8

_NUMBER = re.compile(_NUM)
#: An exponent of three digits, for which Fortran leaves out the letter: 0.25-101.
_BARE_EXPONENT = re.compile(r"(?<=[\d.])([+-]\d{3})(?![\d.eEdD])")
#: A line that was broken inside a number: it ends with the letter, the sign or the point.
_BROKEN = re.compile(r"(?:\d[eEdD][+-]?|[+-])$")
#: Removes what a row may be made of.
_MARKS = str.maketrans("", "", "0123456789+-.eE \t")

# What lines above the values state. A unit of acceleration is a statement whatever the words; one
# beside a number is a value, as that of the peak. Steps and rates are known by their words; any
# other number of seconds or Hz that may be one is asked for, where it is not what is used.
_UNIT = re.compile(
    rf"(?<![a-z]){_PER_SECOND_SQUARED}|(?<![a-z])(?:gals?(?![a-z])|гал\b)"
    r"|(?:(?<=[(\[,:=/])\s*(?!g\.\s*[a-z])|\b(?:in|of|by|to|en|units?|(?:frac|frak|mult|unid|unit|дол)\w*"
    r"(?:\s+d\w)?)\s+|_|(?<=\d)\s*)(?:g(?:'?s|ees|ravity)?|['\"]g['\"])(?=\s*(?:[)\],;.:=/*x]|$|\s\())"
)
_NUMBER_BEFORE = re.compile(rf"(?<![\w.])({_NUM})\s*[x*×]?\s*$")
_NUMBER_BEHIND = re.compile(rf"\s*[)\]:=x*×/]+[\s:=]*({_NUM})(?![\d.]*\s*[a-z])")
#: A part of g that no record has, or a factor before a unit: it is a misprint, or another unit.
_PART_OF_G = re.compile(
    r"(?<![\w])(?:(?:%|per\s?cent|percentage|porcentaje|prozent)\s*(?:(?:of|de|von)\s+)?|milli[ -]?"
    r"|micro[ -]?|[mnuµμ])g(?:als?)?(?![\w])|\b10\s*(?:\^|\*\*)\s*[({]?[-+]?\d+[)}]?\W{0,3}"
    rf"(?:g|gals?|{_PER_SECOND_SQUARED})(?![\w])|(?<![a-z])(?:[dhknuµμ]|da|deci|kilo|micro|nano)m(?:et(?:er|re)s?)?\s*[/.]?\s*{_SECOND}\s*"
    rf"(?:/\s*{_SECOND}|(?:\^|\*\*)?[({{]?-?2)|\bkm\s*/\s*h\s*/"
)
_FACTOR = re.compile(rf"(?:\bscale|\bscaling|factor|multipl\w* by)\b[^\d.+-]*({_NUM})(?![\d:/])")
_UNIT_KEY = re.compile(
    r"(?:unit(?:s|e|es|a)?|unidad(?:es)?|einheit(?:en)?|birimi?)(?![a-z])"
    r"\s*(?:[:=(\[]|(?:of|is|are|in)\b)[\s:=(\[]*(.*)"
)
#: A unit of something else, as that of the times.
_OTHER_UNIT = re.compile(rf"({_SECOND}|hz|deg\w*|°)\W*$")
_RATES = {"hz": 1.0, "khz": 1e3, "sps": 1.0, "s/s": 1.0, "гц": 1.0}
_TIME_UNIT = (
    r"(?<![a-z])(k?hz|гц|sps|(?<!/)s/s|ms(?:ec)?|us"
    rf"|(?:milli|micro)?{_SECOND})(?![a-z0-9^'])"
)
_STEP = re.compile(
    r"(?:\b(?:dt|delta[ _]*[tx])\b|\btime[ _]*(?:step|interval|increment)"
    r"|\bsampl\w*?[ _]*(?:interval|period|step)"
    r"|(?P<rate>\bsampl\w*?[ _]*(?:rate|freq\w*)|\bsamples\s*(?:/|per)\s*s\w*))"
    rf"(?P<between>[^\d.+-]*?)(?P<number>{_NUM})\s*(?P<behind>[a-z]*)"
)
#: Before a number: no part of a word, a date or a clock.
_ALONE = r"(?<![a-z_\d.-])(?<!\d[:/])"
_TIMED = re.compile(
    rf"{_ALONE}({_NUM})\s*{_TIME_UNIT}|{_TIME_UNIT}\W{{0,3}}?[:=][\s/]*({_NUM})"
    rf"|{_ALONE}({_NUM})\s*(?![ckm]?m/|in/|ft/)(?:[a-z]+|1)\s*(?:/|p(?:er|or)\s)\s*{_SECOND}(?![a-z/])"
)
#: A number without a unit behind what may be a word for a step or a rate.
_HINTED = re.compile(
    r"(?:(?:sampl|muestr|abtast|chantill|campion|amostr|orne|step|schritt|interv|aralig|passo?\b|paso"
    r"|采样|周波数|间隔|間隔|步长|шаг|частот|pas de temps|delta\b|δt|\bfs\b|\b[ht]\b(?=\s*=)"
    r"|\bsr\b|fre[qck]|rate\b|digiti[sz])[^\d.+-]{0,24}?"
    rf"|(?<![\w.])1\s*/)\s*({_NUM})(?![\d.]|\s*(?:[-%]|/(?!s)"
    r"|(?:[kcm]?m|gals?|g|deg\w*|v|khz|ms\w*|us|milli\w*|micro\w*|of)\b(?!/s)))"
)
#: Numbers of other things: how many values there are.
_NUMBER_OF = re.compile(
    r"\bn(?:o|um|b|r)?\w*\.?[\s_]*(?:of|de|di|der)\b|points|puntos|npts|count|anzahl"
)
_FILTER = re.compile(r"filt|pass(?!o)|cut|corner|corte|pasa|\b[hl]p\b|natural|instrument|nyquist")
#: A step is at most this long, a rate at least its inverse [s].
_LONGEST_STEP, _LEAST_RATE = 0.1, 10.0
#: Times that go on by more are no seconds of a record [s].
_LONGEST_TIMES = 0.5
#: Steps that differ by this part are two; times this part of a step off are round-off of printing.
_UNEVEN = 0.02

_COUNT = re.compile(
    r"(?:\bNPTS|\bNDATA|\b(?:NUMBER|NO\.?|NUM)[ _]*OF[ _]*(?:DATA|POINTS|SAMPLES|VALUES)\w*)"
    r"\s*[=:]?\s*(\d+)",
    re.IGNORECASE,
)
#: Numbers before their names: 4000 0.0050 NPTS, DT.
_BEFORE = re.compile(
    rf"^\s*({_NUM})\s+({_NUM})\s*(NPTS|DT)\s*,?\s*(?:NPTS|DT)\W*(?:SEC\W*)?$", re.IGNORECASE
)
_ABOUT = re.compile(
    r"^\W*((?:STATION|COMP|DIR|STREAM|EVENT)\w*?(?:[ _](?:CODE|NAME))?)\.?\s*[:=]\s*(\S.*)$",
    re.IGNORECASE,
)
_KEY_AND_VALUE = re.compile(r"\s*[A-Za-z][^:=]*[:=]")
_MOST_HEAD = 100


def stated_unit(head: Sequence[str], path: str) -> tuple[str, str, list[tuple[float, str]]]:
    """Return the unit of the accelerations that lines above them state, and values with a unit.

    Parameters
    ----------
    head : sequence of str
        The lines.
    path : str
        Of the file, for messages.

    Returns
    -------
    unit, line : str
        The unit, and the line that states it, or has a value with one; empty if there is none.
    values : list of (float, str)
        Values with a unit, as that of the peak [m/s2], and their lines.

    Raises
    ------
    InputError
        If a line states a unit that is not known, or two lines state two.
    """
    said: dict[str, str] = {}
    values: list[tuple[float, str]] = []
    for line in head:
        text, short = _statement(line).strip(), line.strip()[:80]
        known = False
        for match in _UNIT.finditer(text):
            word = match[0] if match[1] else re.sub(r"^.*[\s_]", "", match[0])
            unit, known = unit_named(word.replace("gravity", "g")), True
            beside = _NUMBER_BEFORE.search(text[: match.end() - len(word)])
            beside = beside or _NUMBER_BEHIND.match(text[match.end() :])
            if beside:
                values.append((abs(_float(beside[1])) * UNITS[unit], short))
            else:
                said.setdefault(unit, short)
        key = _UNIT_KEY.search(text)
        strange = key and re.search("[a-z]", key[1]) and not _OTHER_UNIT.match(key[1])
        if _PART_OF_G.search(text) or (strange and not known):
            raise InputError(
                f"{path}: the unit of {short!r} is not one of {', '.join(UNITS)}; convert the file"
            )
    if len(said) > 1:
        told = " and ".join(f"{unit} ({line[:60]!r})" for unit, line in said.items())
        raise InputError(f"{path}: states the units {told}; keep the one that is meant")
    unit, line = next(iter(said.items()), ("", values[0][1] if values else ""))
    return unit, line, values


def _check_peak(
    values: Sequence[tuple[float, str]], motion: GroundMotion, head: Sequence[str], path: str
) -> None:
    """Refuse the unit of the user where the file states a factor, or a peak that is far off.

    `values` are the accelerations [m/s2] that lines of the head state, each with its line. Peaks of
    other components and of the uncorrected record are within a factor of five.
    """
    for line in head:
        factor = _FACTOR.search(_statement(line))
        if factor and _float(factor[1]) not in (0, 1):
            raise InputError(
                f"{path}: {line.strip()[:80]!r} may state a factor of the values; apply it, and "
                "say checks=False"
            )
    if values and not any(0.2 * motion.pga <= value <= 5 * motion.pga for value, _ in values):
        value, line = values[0]
        raise InputError(
            f"{path}: the largest acceleration is {motion.pga:.4g} m/s2, and {line!r} states "
            f"{value:.4g} m/s2; check units, or say checks=False if that is no peak"
        )


def stated_step(head: Sequence[str]) -> float | None:
    """Return the step [s] that lines above the values state, as a step or as a rate, or None."""
    for line in head:
        before, match = _BEFORE.match(line), _STEP.search(_statement(line))
        if before:
            return _float(before[1 if before[3].upper() == "DT" else 2])
        if match and ((number := _float(match["number"])) > 0 or not match["rate"]):
            unit = re.search(_TIME_UNIT, match["behind"]) or re.search(
                _TIME_UNIT, match["between"].replace("_", " ")
            )
            many = re.search(rf"(?:/|\bper)\s*{_SECOND}(?![a-z])", match["between"])
            word = unit[1] if unit and not many else "hz" if match["rate"] else "s"
            return _seconds(number, word) if number else 0.0
    return None


def _seconds(number: float, unit: str) -> float:
    """Return a time in seconds, or the time between two values of a rate as 100 Hz."""
    if unit in _RATES:
        return 1 / (_RATES[unit] * number)
    micro = unit.startswith(("us", "micro"))
    return number * (1e-6 if micro else 1e-3 if unit[0] == "m" else 1.0)


def _check_step(head: Sequence[str], step: float, path: str) -> None:
    """Refuse a step if a line has a time or a rate that may be the step, and none has this one."""
    asked: dict[str, float] = {}
    for line in head:
        for text in _statement(line).split(";"):
            if _FILTER.search(text) and "sps" not in text:
                break
            found = [
                time
                for match in _TIMED.finditer(text)
                if (number := _float(match[1] or match[4] or match[5])) > 0
                and (time := _seconds(number, match[2] or match[3] or "hz")) <= _LONGEST_STEP
            ]
            for match in () if found or _NUMBER_OF.search(text) else _HINTED.finditer(text):
                number = _float(match[1])
                found += (
                    [number] if 0 < number < 1 else [1 / number] if number > _LEAST_RATE else []
                )
            for other in found:
                if abs(other - step) <= _UNEVEN * step:
                    return
                if other <= _LONGEST_STEP:
                    asked.setdefault(line.strip()[:80], other)
    for line, other in asked.items():
        raise InputError(
            f"{path}: the step is {step:g} s, but {line!r} may state {other:g} s; correct dt or "
            "the file, or say checks=False if it is no step"
        )


def stated_count(head: Sequence[str]) -> int | None:
    """Return the number of values that lines above them state, or None."""
    for line in head:
        if before := _BEFORE.match(line):
            word = before[2 if before[3].upper() == "DT" else 1]
            return int(word) if word.isdigit() else None
        if match := _COUNT.search(line):
            return int(match[1])
    return None


def agreed_step(stated: float | None, wanted: float | None, path: str) -> float | None:
    """Return the step of a file: the one that it states, or the one that the user gives."""
    if stated is None or wanted is None:
        return stated if wanted is None else wanted
    if abs(stated - wanted) > 1e-6 * stated:
        raise InputError(
            f"{path}: the file says that its step is {stated:g} s, and dt = {wanted:g} s was "
            "given; leave dt out, or correct the file"
        )
    return stated


def read_record(
    lines: list[str],
    path: str,
    name: str,
    units: str | None,
    dt: float | None,
    *,
    first: int,
    count: int | None,
    step: float | None,
    checks: bool,
) -> GroundMotion:
    """Return the motion of a file with the values of one record, line by line.

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
    first : int
        Lines above the values.
    count : int or None
        Number of the values, if the file states it.
    step : float or None
        The step that the file states [s].
    checks : bool
        False accepts what may contradict a line above the values.

    Raises
    ------
    InputError
        If the file is no acceleration, or its values cannot be read.

    Warns
    -----
    RepairWarning
        If up to eight values are missing at the end.
    """
    head = lines[:first]
    stated, step = step, agreed_step(step, dt, path)
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
    if checks and stated is None:
        _check_step(head, step, path)
    _refuse_other(head, path)
    stated_in, line, peaks = stated_unit(head, path)
    unit = agreed_unit(stated_in, units, f"{path}: ", line)
    values = _values(lines, first, path)
    lacking = count - len(values)
    if lacking > MOST_MISSING:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; the file is truncated, download it "
            "again"
        )
    if lacking < 0:
        raise InputError(
            f"{path}: {len(values)} values, but NPTS = {count}; correct NPTS, or remove what does "
            "not belong to the record"
        )
    if lacking:
        warn(
            f"{path}: the last {lacking} of NPTS = {count} values are missing; the record "
            f"ends at {step * (len(values) - 1):g} s",
            RepairWarning,
        )
    second = lines[1].strip() if first > 1 and not _COUNT.search(lines[1]) else ""
    motion = GroundMotion(np.array(values) * UNITS[unit], step, name, _about(head) or second)
    if checks:
        _check_peak([] if stated_in else peaks, motion, head, path)
    return motion


def _first_value(lines: list[str]) -> int:
    """Return the number of lines above the values: up to the last that states something."""
    last = 0
    for number, line in enumerate(lines[:_MOST_HEAD], 1):
        text = plain(line)
        behind = last == number - 1 and _KEY_AND_VALUE.match(line)
        if _STEP.search(text) or _UNIT_KEY.search(text) or behind or _states_count(line):
            last = number
    return last


def _states_count(line: str) -> bool:
    """Whether a line states the number of values."""
    return bool(_COUNT.search(line)) or "NPTS" in line.upper()


def _record(lines: list[str]) -> tuple[int, int | None, float | None] | None:
    """Return the lines above the values of one record, their number and step, or None for columns.

    The number may be stated in words, or stand above the values, alone or with the step.
    """
    if any(map(_states_count, lines[:_MOST_HEAD])):
        first, count, step = _stated(lines)
        rows = [line for line in lines[first:] if re.match(r"\s*[-+.\d]", line)]
        # As many lines as values are rows of columns, and so are pairs that begin with times.
        if count is not None and (len(rows) == count or _begin_with_times(rows[:_MOST_HEAD])):
            return None
        return first, count, step
    filled = [i for i, line in enumerate(lines) if line.strip() and line.lstrip()[0] != "#"]
    begin = next((i for i in filled if _words(lines[i])), len(lines))
    filled = [i for i in filled if i >= begin]
    return _counted(lines, filled) if len(filled) > 2 else None


def _counted(
    lines: list[str], filled: Sequence[int]
) -> tuple[int, int | None, float | None] | None:
    """Return what `_record` returns, for lines that do not name the number of the values.

    `filled` are the places of the lines that are neither empty nor above the values.
    """
    begin = filled[0]
    words, below = _words(lines[begin]), _words(lines[filled[1]])
    numbers = [len(_NUMBER.findall(lines[i])) for i in filled]
    if len(words) <= 2 and words[0].isdigit() and below:
        count, rest = int(words[0]), sum(numbers[1:])
        step = _float((words + below)[1])
        if len(words) == 1 and count == rest:
            return begin + 1, count, stated_step(lines[:begin])
        if len(words) == len(below) == 1 and count == rest - 1 and 0 < step <= 1:
            return filled[1] + 1, count, step
        if len(words) == 2 != len(below) and 0 <= count - rest <= MOST_MISSING and 0 < step <= 1:
            return begin + 1, count, step
    if not _goes_on(lines, filled):
        return None
    return begin, sum(numbers), stated_step(lines[:begin])


def _stated(lines: list[str]) -> tuple[int, int | None, float | None]:
    """Return the lines above the values, and the number and the step that they state."""
    first = _first_value(lines)
    return first, stated_count(lines[:first]), stated_step(lines[:first])


def _words(line: str) -> list[str]:
    """Return the numbers of a line as they stand there; none if it has anything else."""
    words = (line.replace(",", " ") if "." in line else line).split()
    return words if all(map(_NUMBER.fullmatch, words)) else []


def _begin_with_times(rows: Sequence[str]) -> bool:
    """Whether rows are pairs, and nearly all of their first numbers ascend."""
    pairs = [_NUMBER.findall(row) for row in rows]
    times = np.array([_float(pair[0]) for pair in pairs if len(pair) == 2])
    return len(times) >= 0.8 * len(pairs) and float(np.mean(np.diff(times) > 0)) >= 0.8


def _goes_on(lines: Sequence[str], filled: Sequence[int]) -> bool:
    """Whether three or more values a line without names are one record.

    Values that follow each other in a line then differ less than those below each other.
    """
    rows = [_words(lines[i]) for i in filled]
    width = len(rows[0])
    named = filled[0] > 0 and len(lines[filled[0] - 1].lstrip("#").split()) == width
    if width < 3 or named or any(len(row) != width for row in rows[:-1]):
        return False
    last = len(rows[-1])
    values = np.array([[_float(word) for word in row] for row in rows[:-1]])
    along = np.abs(np.diff(values.ravel())).mean()
    return 0 < last <= width and bool(
        along < (0.7 if last == width else 1.0) * np.abs(np.diff(values, axis=0)).mean()
    )


def _about(head: Sequence[str]) -> str:
    """Return station, component and event from lines of key and value."""
    matches = [match for line in head if (match := _ABOUT.match(line))]
    return ", ".join(dict.fromkeys(match[2].strip() for match in matches))


class _OtherQuantityError(InputError):
    """A file holds a velocity or a displacement."""


def _refuse_other(head: Sequence[str], path: str) -> None:
    """Refuse the velocities and displacements that come with an acceleration (VT2, DT2)."""
    text = " ".join(head).upper()
    if "ACC" in text or "PGA" in text:
        return
    for word in ("VELOCITY", "DISPLACEMENT"):
        if word in text:
            raise _OtherQuantityError(
                f"{path}: it says that it holds a {word.lower()}; read the file of the "
                "acceleration (.AT2)"
            )


#: K-NET and KiK-net: lines of 18 letters for the key and a value, then integers.
_KNET_HEAD = 17
_SCALE = re.compile(rf"({_NUM})\s*\(gal\)\s*/\s*({_NUM})", re.IGNORECASE)


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
    """Return the values below the first lines; a number may be broken at the end of a line."""
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
    """Return a number whose exponent may have the letter d of Fortran."""
    return float(word.lower().replace("d", "e"))


_SECONDS = ("", "s", "sec", "second", "seconds")


def read_columns(
    lines: list[str],
    path: str,
    name: str,
    units: str | None,
    dt: float | None,
    column: str | int | None,
    *,
    checks: bool,
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
    checks : bool
        False accepts what may contradict a line above the values.

    Raises
    ------
    InputError
        If the rows are not numbers, times do not ascend or are uneven, or the unit is not known.
    """
    # The words of a comment are no names of columns.
    table = read_table((path, ["" if line.startswith("#") else line for line in lines]), least=1)
    # A line of names belongs to its columns; above a single one it states what any line may.
    head = lines[: len(table.head) if table.columns > 1 else table.first]
    _refuse_other(lines[: table.first], path)
    time_at, value_at = _columns(table, column)
    if checks and table.columns == 1:
        _check_count(lines[table.first :], table.values.size - 1, path)
    named = table.units[value_at] if table.columns > 1 else ""
    unit = unit_named(named)
    if named and not unit:
        raise InputError(
            f"{path}: the unit {named!r} of column {table.names[value_at]} is not one of "
            f"{', '.join(UNITS)}"
        )
    above, line, peaks = ("cm/s2", "", []) if _AFAD in lines[0] else stated_unit(head, path)
    if unit and above and unit != above:
        raise InputError(
            f"{path}: column {table.names[value_at]} is in {unit}, and a line above says {above}; "
            "correct the file"
        )
    stated_in = unit or above
    unit = agreed_unit(stated_in, units, f"{path}: ", "" if unit else line)
    values = table.values[:, value_at] * UNITS[unit]
    comment = next((line.lstrip("# ").strip() for line in lines if line.startswith("#")), "")
    about = _about(head) or comment
    stated, count = stated_step(head), stated_count(head)
    if count is not None and count != len(values):
        raise InputError(
            f"{path}: {len(values)} rows, but {count} are stated; the file is truncated or mixed up"
        )
    if time_at is None:
        step = agreed_step(stated, dt, path)
        if step is None:
            raise InputError(f"{path}: has no column with the time; give the step in s, dt=")
    else:
        if len(values) < 2:
            raise InputError(f"{path}: has {len(values)} rows; a motion has two or more")
        times = table.values[:, time_at]
        if (
            checks
            and not table.units[time_at]
            and np.ptp(times) > _LONGEST_TIMES * (len(times) - 1)
        ):
            raise InputError(
                f"{path}: the times of column {table.names[time_at] or time_at + 1} go on by "
                f"{np.ptp(times) / (len(times) - 1):.4g} s on average; if they are milliseconds or "
                "numbers of rows, convert them, or give column= and dt=; else say checks=False"
            )
        values, step = _even(times, values, dt, path)
        if stated is not None and dt is None and abs(stated - step) > _UNEVEN * stated:
            raise InputError(
                f"{path}: the times have a step of {step:g} s, and a line above says {stated:g} s; "
                "correct the file"
            )
    motion = GroundMotion(values, step, name, about)
    if checks and stated is None and (time_at is None or dt is None):
        _check_step(head, step, path)
    if checks:
        _check_peak([] if stated_in else peaks, motion, head, path)
    return motion


def _check_count(lines: Sequence[str], rest: int, path: str) -> None:
    """Refuse a first value that may be the number of the others, if it is not."""
    first, *others = (line.strip() for line in lines[:20] if line.strip())
    if first.isdigit() and not any(map(str.isdigit, others)):
        count = int(first)
        if count >= 10 and abs(count - rest) <= max(MOST_MISSING, 0.05 * rest):
            raise InputError(
                f"{path}: the first line, {first}, may be the number of the values, but {rest} "
                "are below it; the file is cut or mixed up, or say checks=False"
            )


def _columns(table: NumberTable, column: str | int | None) -> tuple[int | None, int]:
    """Return the place of the times, None if there are none, and that of the accelerations."""
    path = table.source
    numbers = [i for i in range(table.columns) if i not in table.texts]
    time, acceleration = table.find("time"), table.find("acceleration")
    if len(numbers) == 1 and column is None and (table.columns == 1 or time is None):
        return None, numbers[0]
    # ACCELERATION TIME SERIES is no time.
    time = None if time == acceleration else time
    if column is not None:
        value = table.index_of(column, "column")
        if time is None and not any(table.names) and value > 0 and _ascends(table.values[:, 0]):
            time = 0
    elif not any(table.names):
        if len(numbers) > 2:
            raise InputError(
                f"{path}: has {len(numbers)} columns without names. If they are columns, say "
                "column=, the number of the accelerations from 1; if they are one record, line by "
                "line, state the number of its values and their step above them, as "
                "NPTS= 4000, DT= .0050 SEC"
            )
        return numbers[0], numbers[1]
    else:
        if acceleration is None and len(numbers) == 2 and time is not None:
            acceleration = numbers[1 - numbers.index(time)]
            if plain(table.names[acceleration]).startswith(("vel", "disp")):
                acceleration = None
        if acceleration is None:
            raise InputError(
                f"{path}: no column is named after the acceleration, or more than one "
                f"({table.describe()}); say column=, its name or its number from 1"
            )
        value = acceleration
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
    ".at2", ".csv", ".txt", ".asc", ".lvm", ".ns", ".ew", ".ud",
    *(f".{direction}{place}" for direction in ("ns", "ew", "ud") for place in (1, 2)),
)  # fmt: skip
#: Of these, files of many kinds.
_TABLES = (".csv", ".txt")
#: Formats with much in them besides the accelerations, which other programs read well.
_OTHERS = (
    ".smc", ".v1", ".v2", ".v1c", ".v2c", ".v3", ".v1a", ".v2a", ".cosmos", ".evt", ".mseed",
    ".sac",
)  # fmt: skip
_VOLUME = re.compile(r"\bCOSMOS\b|\b(un)?corrected accelerogram", re.IGNORECASE)
_AFAD = "STRONG GROUND MOTION RECORDS OF TURKIYE"


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
        False accepts a record of more than 5 g, and what may contradict a line above the values.

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
    with unwarned():  # A peak beyond 5 g is refused below.
        if lines[0].startswith("Origin Time") and any(
            "Scale Factor" in line for line in lines[:20]
        ):
            motion = read_knet(lines, name, stem)
            agreed_unit("cm/s2", units, f"{name}: ")
            agreed_step(motion.dt, dt, name)
        elif (record := None if column is not None else _record(lines)) or ending == ".at2":
            first, count, step = record or _stated(lines)
            motion = read_record(
                lines, name, stem, units, dt, first=first, count=count, step=step, checks=checks
            )
        else:
            motion = read_columns(lines, name, stem, units, dt, column, checks=checks)
    if checks and motion.pga > _core.note_limits()[2]:
        raise InputError(
            f"{name}: the largest acceleration is {motion.pga / STANDARD_GRAVITY:.4g} g; no ground "
            "has moved with more than 5 g. Check the unit, or say checks=False"
        )
    return motion


def _refuse_format(path: object, kind: str) -> None:
    """Raise `InputError` for a format that other programs read."""
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
        Folder with files that end with .AT2, .csv, .txt, .asc, .lvm, or as those of K-NET; other
        files are left out. So are velocities and displacements and, beside the records of a
        database, .csv and .txt that cannot be read, as its list and its readme.
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
        As `read_motion`, and if a file is left out that may be a record.
    """
    place = _arguments.path(folder, "folder")
    _arguments.text(pattern, "pattern")
    if not place.is_dir():
        raise InputError(f"{place} is not a folder; for one record call read_motion")
    files = sorted(
        path for path in place.glob(pattern) if path.is_file() and not path.name.startswith(".")
    )
    paths = [path for path in files if path.suffix.lower() in ENDINGS]
    if not paths:
        raise InputError(
            f"{place}: no file {pattern!r} with the ending {', '.join(ENDINGS)} is there"
        )
    tables = [path for path in paths if path.suffix.lower() in _TABLES]
    motions: list[GroundMotion] = []
    faults: list[str] = []
    others: list[str] = []
    for path in paths:
        # Beside the records of a database there are a list of them and a readme.
        beside = path in tables and len(tables) < len(paths)
        with _arguments.collected(others if beside else faults):
            try:
                motions.append(read_motion(path, units, column=column, checks=checks))
            except _OtherQuantityError as error:
                others.append(str(error))
    for path in files:
        if path.suffix.lower() in _OTHERS:
            others.append(f"{path}: the format {path.suffix} is not read here")
    if faults or not motions:
        raise InputError("\n".join(faults + others))
    if others:
        told = "; ".join(others)
        warn(f"{place}: left out beside the records: {told}", RepairWarning)
    return tuple(motions)
