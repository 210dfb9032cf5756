"""The one reader of tables of numbers: measured histories, ground motions, hazard curves.

A table is text with a row of numbers a line. What separates the numbers and what stands before
their decimals, the lines above the first row, the names of the columns and their units are found,
or stated by the caller.
"""

from __future__ import annotations

import itertools
import os
import re
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.errors import InputError

#: Standard acceleration of gravity [m/s2].
STANDARD_GRAVITY = 9.80665

#: Value of each unit in metres and in newtons; capital letters do not matter.
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254, "inch": 0.0254, "inches": 0.0254}
FORCES = {
    "N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605, "kips": 4448.2216152605,
    "lbf": 4.4482216152605, "tf": 9806.65, "tonf": 9806.65,
}  # fmt: skip

#: Other words that are units, and not names, at the end of a name or below it.
_OTHERS = (
    " s ms sec second seconds min - % rad mrad deg v mv nm ft lb klbf kgf psi ksi pa mpa gpa bar"
    " με µε ue um µm microstrain strain g gal gals hz °c kg knm"
)
_UNITS = {*_OTHERS.split(" "), *(unit.lower() for unit in (*LENGTHS, *FORCES))}
#: Units of which others are made: kN m, mm/mm, m/s2.
_PARTS = re.compile(r"[/*·.^\s]|-(?=[a-z])|(?<=[a-z])\d$")

# In the order in which they are tried; a comma that separates has no comma before the decimals.
_LAYOUTS = ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (" ", "."), (" ", ","))
_SEPARATORS = (",", ";", "\t", " ")

#: Lines that are looked at, and rows in a line that make the beginning of the numbers.
_SAMPLE = 500
_ROWS = 3
#: Largest file that is read [bytes].
_MOST_BYTES = 500_000_000

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?$")


@dataclass(frozen=True, eq=False)
class NumberTable:
    """A table of numbers as it stands in a file.

    Attributes
    ----------
    source : str
        Path of the file, for messages; "text" where a text was given.
    names, units : tuple of str
        A text for each column; empty where the file gives none.
    values : ndarray, shape (rows, columns)
        The numbers.
    """

    source: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.names)

    def describe(self) -> str:
        """Return the columns in words."""
        if not any(self.names):
            return f"{self.columns} columns without names"
        return "columns " + ", ".join(f"{i} {name!r}" for i, name in enumerate(self.names, 1))

    def find(self, words: Sequence[str], but: Sequence[str] = ()) -> int | None:
        """Return the place of the only column that the first of some words names, or None.

        A word of one letter names a column only if it stands alone or before its unit. `but` are
        words that the name must not have.
        """
        for word in words:
            named = [
                i
                for i, name in enumerate(map(str.lower, self.names))
                if (word in name if len(word) > 1 else bare(name) == word)
                and not any(other in name for other in but)
            ]
            if len(named) == 1:
                return named[0]
        return None


def bare(name: str) -> str:
    """Return a name without the unit at its end."""
    for mark in ("[", "(", "_", " "):
        name = name.split(mark, maxsplit=1)[0] if mark in name[1:] else name
    return name.strip()


def to_si(values: Array, factor: float) -> Array:
    """Return values of a unit in SI; whole parts of a unit, as mm, round only once."""
    parts = round(1 / factor) if factor < 1 else 0
    return values / parts if parts and abs(parts * factor - 1) < 1e-15 else values * factor


def read_lines(source: str | os.PathLike[str]) -> tuple[str, list[str]]:
    """Return the name for messages and the lines of a file, whatever system they come from.

    Parameters
    ----------
    source : path or str
        A file, or a text of two lines or more.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no text.
    """
    if isinstance(source, str) and "\n" in source:
        where, text = "text", source
    else:
        where = _arguments.file(source)
        if os.path.isdir(where):
            raise InputError(f"{where}: is a folder; give the path of a file")
        try:
            if os.path.getsize(where) > _MOST_BYTES:
                size = f"{_MOST_BYTES // 10**6} MB"
                raise InputError(f"{where}: is larger than {size}; give the file of one table")
            with open(where, "rb") as file:
                raw = file.read()
        except OSError as error:
            raise InputError(
                f"{where}: cannot be read ({error.strerror}); check the path"
            ) from None
        if b"\0" in raw[:4096]:
            raise InputError(f"{where}: is not a text file; save it as csv or text in UTF-8")
        text = raw.decode("utf-8-sig", "replace")
    if not text.strip():
        raise InputError(f"{where}: is empty; download or export it again")
    return where, text.replace("\r\n", "\n").replace("\r", "\n").split("\n")


def read_table(
    source: str | os.PathLike[str] | tuple[str, list[str]],
    *,
    separator: str | None = None,
    decimal: str | None = None,
    header: int | None = None,
    least: int = 2,
) -> NumberTable:
    """Read a table of numbers.

    Parameters
    ----------
    source : path, str or (str, list of str)
        A file, a text, or what `read_lines` returned.
    separator, decimal : str, optional
        What stands between two values: ",", ";", a tab or a blank; and before decimals: "." or ",".
    header : int, optional
        Lines above the first row.
    least : int, optional
        Fewest columns.

    Raises
    ------
    InputError
        If there are no rows, what is stated cannot be, or a value is no finite number; with the
        line.
    """
    if separator is not None and separator not in _SEPARATORS:
        raise InputError(f'separator = {separator!r} must be ",", ";", "\\t" or " "')
    if decimal not in (None, ".", ","):
        raise InputError(f'decimal = {decimal!r} must be "." or ","')
    if separator == decimal == ",":
        raise InputError("separator and decimal are both a comma; one of them must be another")
    where, lines = source if isinstance(source, tuple) else read_lines(source)
    if header is not None and not 0 <= header < len(lines):
        raise InputError(f"header = {header}: {where} has {len(lines)} lines")
    stated: dict[str, Any] = {"separator": separator, "decimal": decimal, "header": header}
    first, mark, point = _layout(lines, where, stated, least)
    values = _values(lines, first, mark, point, where)
    at = first if _is_count(lines, first, mark) else first - 1
    names: tuple[str, ...]
    units: tuple[str, ...]
    if header is None and values.shape[1] in (2, 3) and _is_count(lines, at, mark):
        # The format of the PEER database: a title, the number of rows, the rows.
        values = values[at + 1 - first :]
        count = values.shape[1]
        names, units = ("displacement", "force", "axial_load")[:count], ("mm", "kN", "kN")[:count]
    else:
        above = [line for line in lines[:first] if line.strip()]
        names, units = _head(above, mark, values.shape[1])
    return NumberTable(where, names, units, values)


def _layout(
    lines: list[str], where: str, stated: dict[str, Any], least: int
) -> tuple[int, str, str]:
    """Return the lines above the first row, the separator and the decimal point."""
    sample, header = lines[:_SAMPLE], stated["header"]
    filled = [i for i, line in enumerate(sample) if line.strip() and line.lstrip()[0] != "#"]
    # Several columns before one; a few rows in a line are the beginning, and in a file with a
    # mistake there may be only one.
    for columns, rows in itertools.product((2, 1) if least == 1 else (2,), (_ROWS, 1)):
        best: tuple[int, int, str, str] | None = None
        for mark, point in _LAYOUTS:
            if stated["separator"] not in (None, mark) or stated["decimal"] not in (None, point):
                continue
            width = {i: _width(_split(sample[i], mark), point) for i in filled}
            begin = _begin(width, filled, rows, columns) if header is None else header
            count = sum(width[i] >= columns for i in filled if i >= (begin or 0))
            if begin is not None and count and (best is None or count > best[0]):
                best = count, begin, mark, point
        if best is not None:
            return best[1:]
    known = ", ".join(f"{name} = {value!r}" for name, value in stated.items() if value is not None)
    raise InputError(
        f"{where}: has no rows of {'two or more ' if least > 1 else ''}numbers"
        f"{known and ' with '}{known}; check what separates the values, and the decimal point"
    )


def _begin(width: dict[int, int], filled: list[int], rows: int, least: int) -> int | None:
    """Return the first of the rows of numbers: as many in each of a few lines, or to the end."""
    for place, i in enumerate(filled):
        if width[i] >= least and all(width[j] == width[i] for j in filled[place : place + rows]):
            return i
    return None


def _values(lines: list[str], first: int, mark: str, point: str, where: str) -> Array:
    """Return the numbers of all rows."""
    rows = lines[first:]
    if point == ",":
        rows = [line.replace(",", ".") for line in rows]
    try:
        # Nearly all files are in order.
        separator = None if mark == " " else mark
        values = np.loadtxt(rows, delimiter=separator, comments="#", quotechar='"', ndmin=2)
        if np.isfinite(values).all():
            return values
    except ValueError:
        pass
    found: list[list[float]] = []
    for number, line in enumerate(rows, first + 1):
        if not line.strip() or line.lstrip().startswith("#"):
            continue
        words = _split(line, mark)
        if found and len(words) != len(found[0]):
            raise InputError(
                f"{where} line {number}: has {len(words)} value{'s' * (len(words) != 1)}, the rows "
                f"before have {len(found[0])}; every row has one for each column"
            )
        found.append([_number(word, f"{where} line {number}, value {i}")
                      for i, word in enumerate(words, 1)])  # fmt: skip
    return np.array(found)


def _number(word: str, where: str) -> float:
    try:
        value = float("x" if "_" in word else word.lower().replace("d", "e"))
    except ValueError:
        fault = "is not a number" if word else "is empty"
    else:
        if np.isfinite(value):
            return value
        fault = "is not a finite number"
    raise InputError(f"{where}: {word[:40]!r} {fault}; correct the file")


def _split(line: str, mark: str) -> list[str]:
    line = line.strip(" \t") if mark == " " else line.strip(" ").rstrip("\t ")
    if not line:
        return []
    words = line.split() if mark == " " else line.split(mark)
    words = [word.strip().strip('"').strip() for word in words]
    # Spreadsheets may end each line with a separator.
    return words[:-1] if len(words) > 1 and not words[-1] else words


def _width(words: Sequence[str], point: str) -> int:
    """Return how many numbers a line has; 0 if it has something else."""
    if point == ",":
        words = [word.replace(",", ".") if "." not in word else "x" for word in words]
    return len(words) if words and all(map(_NUMBER.match, words)) else 0


def _is_count(lines: Sequence[str], at: int, mark: str) -> bool:
    """Whether a line has the number of the lines behind it, alone or with a 0."""
    if mark != " " or at < 0:
        return False
    words = lines[at].split()
    if not words or not words[0].isdigit() or words[1:] not in ([], ["0"]):
        return False
    return int(words[0]) == sum(bool(line.strip()) for line in lines[at + 1 :])


def _head(lines: Sequence[str], mark: str, columns: int) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units from the lines above the numbers."""
    empty = ("",) * columns
    rows = [_split(line.lstrip("#"), mark) for line in lines]
    if not rows or len(rows[-1]) != columns:
        return empty, empty
    last = tuple(rows[-1])
    if all(map(_is_unit, last)):
        above = tuple(rows[-2]) if len(rows) > 1 and len(rows[-2]) == columns else empty
        return above, tuple(word.strip("[]() ") for word in last)
    return last, tuple(map(_unit_in, last))


def _is_unit(word: str) -> bool:
    """Whether a word is a unit, or is in brackets as a unit is."""
    plain = word.strip("[]() ").lower()
    return word[:1] in ("[", "(") or all(part in _UNITS for part in _PARTS.split(plain))


def _unit_in(name: str) -> str:
    """Return the unit at the end of a name, as in `d_mm`, `d [mm]`, `d (mm)`, or an empty text."""
    found = re.search(r"[(\[]\s*([^()\[\]]+?)\s*[)\]]$", name.strip())
    if found:
        return found[1]
    ends = (name[mark.end() :] for mark in re.finditer(r"[\s_/-]", name))
    return next((end for end in ends if end.strip("- ") and _is_unit(end)), "")
