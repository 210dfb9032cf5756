"""The layout of a text file with columns of numbers: where they begin, and what they are called."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

from rbsdem.errors import InputError

__all__ = ["UNITS", "Layout", "find_layout"]

UNITS = {"displacement": ("m", "mm", "cm", "in"), "force": ("N", "kN", "MN", "kip")}
"""Units that are known, by quantity; capital letters do not matter."""

_ALL_UNITS = {unit.lower() for units in UNITS.values() for unit in units} | {
    "s", "sec", "min", "-", "%", "rad", "mrad", "deg", "v", "mv", "knm", "nm", "με", "µε", "um/m",
    "µm/m", "g", "m/s2", "hz", "mpa", "bar", "°c", "",
}  # fmt: skip

# In the order in which they are tried; a comma that separates has no comma before the decimals.
_SEPARATORS = ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (" ", "."), (" ", ","))
_NAMES = {";": "semicolon", "\t": "tab", ",": "comma", " ": "blank"}

# Lines that are looked at, and rows in a line that make the beginning of the numbers.
_SAMPLE = 2000
_ROWS = 3

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?$")


@dataclass(frozen=True)
class Layout:
    """What a file says about its columns.

    Attributes
    ----------
    separator, decimal : str
        What stands between two values, and before the decimals.
    skip : int
        Lines before the first row.
    names, units : tuple of str
        A text for each column; empty where the file gives none.
    """

    separator: str
    decimal: str
    skip: int
    names: tuple[str, ...]
    units: tuple[str, ...]

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.names)

    def describe(self) -> str:
        """Return the columns in words."""
        if not any(self.names):
            return f"{self.columns} columns without names"
        return "columns " + ", ".join(f"{i} {name!r}" for i, name in enumerate(self.names, 1))


def find_layout(
    text: str, path: str, *, separator: str | None, decimal: str | None, header: int | None
) -> Layout:
    """Find the layout of a file.

    Parameters
    ----------
    text : str
        Its beginning.
    path : str
        Its name in messages.
    separator, decimal : str or None
        What is known of them.
    header : int or None
        Lines before the first row, if that is known.

    Raises
    ------
    InputError
        If there are no rows of at least two numbers, or if what is known cannot be.
    """
    if separator is not None and separator not in _NAMES:
        raise InputError(f'separator = {separator!r} must be ",", ";", "\\t" or " "')
    if decimal not in (None, ".", ","):
        raise InputError(f'decimal = {decimal!r} must be "." or ","')
    if separator == decimal == ",":
        raise InputError("separator and decimal are both a comma; one of them must be another")
    whole = re.split(r"\r\n|\r|\n", text)
    lines = whole[:_SAMPLE]
    if header is not None and not 0 <= header < len(lines):
        raise InputError(f"header = {header}: {path} has {len(lines)} lines")
    best: tuple[int, int, str, str] | None = None
    for s, d in _SEPARATORS:
        if separator not in (None, s) or decimal not in (None, d):
            continue
        widths = [_width(_split(line, s), d) for line in lines]
        begin = _begin(widths, lines) if header is None else header
        if begin is None or (header is None and widths[begin] < 2):
            continue
        count = sum(width >= 2 for width in widths[begin:])
        if count and (best is None or count > best[0]):
            best = count, begin, s, d
    if best is None:
        known = [f"separator = {separator!r}"] * (separator is not None)
        known += [f"decimal = {decimal!r}"] * (decimal is not None)
        known += [f"header = {header}"] * (header is not None)
        given = f" with {', '.join(known)}" if known else ""
        raise InputError(
            f"{path}: no rows of two or more numbers were found{given}; state separator, decimal "
            "and header, the number of lines before the first row"
        )
    _, begin, s, d = best
    widths = [_width(_split(line, s), d) for line in lines]
    columns = next(width for width in widths[begin:] if width >= 2)
    at = begin if _is_count(whole, begin, s) else begin - 1
    if header is None and columns in (2, 3) and _is_count(whole, at, s):
        # The format of the PEER database: a title, the number of rows, the rows.
        names, units = ("displacement", "force", "axial_load"), ("mm", "kN", "kN")
        return Layout(s, d, at + 1, names[:columns], units[:columns])
    names, units = _head([line for line in lines[:begin] if line.strip()], s, columns)
    return Layout(s, d, begin, names, units)


def unit_in(name: str) -> str:
    """Return the unit at the end of a name, as in `d_mm`, `d [mm]`, `d (mm)`, or an empty text."""
    found = re.search(r"[(\[]\s*([^()\[\]]+?)\s*[)\]]$", name.strip())
    if found:
        return found[1]
    found = re.search(r"[\s_/-]([A-Za-zµ%]+)$", name.strip())
    return found[1] if found and found[1].lower() in _ALL_UNITS else ""


def _is_count(lines: Sequence[str], at: int, separator: str) -> bool:
    """Whether a line has the number of the lines behind it, alone or with a 0."""
    if separator != " " or at < 0:
        return False
    words = lines[at].split()
    if not words or not words[0].isdigit() or words[1:] not in ([], ["0"]):
        return False
    return int(words[0]) == sum(bool(line.strip()) for line in lines[at + 1 :])


def _split(line: str, separator: str) -> list[str]:
    line = line.strip(" \t") if separator == " " else line.strip(" ").rstrip("\t ")
    if not line:
        return []
    words = line.split() if separator == " " else line.split(separator)
    words = [word.strip().strip('"').strip() for word in words]
    # Spreadsheets may end each line with a separator.
    return words[:-1] if len(words) > 1 and not words[-1] else words


def _width(words: Sequence[str], decimal: str) -> int:
    """Return how many numbers a line has; 0 if it has something else."""
    if decimal == ",":
        words = [word.replace(",", ".") if "." not in word else "x" for word in words]
    return len(words) if words and all(map(_NUMBER.match, words)) else 0


def _begin(widths: Sequence[int], lines: Sequence[str]) -> int | None:
    """Return the first of the rows of numbers: as many in each of a few lines, or to the end."""
    filled = [i for i, line in enumerate(lines) if line.strip()]
    for place, i in enumerate(filled):
        following = [widths[j] for j in filled[place : place + _ROWS]]
        if widths[i] >= 2 and all(width == widths[i] for width in following):
            return i
    return None


def _head(
    lines: Sequence[str], separator: str, columns: int
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return names and units from the lines above the numbers."""
    empty = ("",) * columns
    rows = [_split(line.lstrip("#"), separator) for line in lines]
    if not rows or len(rows[-1]) != columns:
        return empty, empty
    last = tuple(rows[-1])
    stripped = tuple(word.strip("[]() ") for word in last)
    if all(word.lower() in _ALL_UNITS for word in stripped):
        above = tuple(rows[-2]) if len(rows) > 1 and len(rows[-2]) == columns else empty
        return above, stripped
    return last, tuple(unit_in(name) for name in last)
