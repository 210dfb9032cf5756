"""The one reader of tables of numbers: measured histories, ground motions, hazard curves.

A table is text with a row of numbers a line. Its separators, its decimal sign, the lines above the
first row, the names of the columns and their units are found, or stated by the caller.
"""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.errors import InputError, RepairWarning, warn

#: Standard acceleration of gravity [m/s2].
STANDARD_GRAVITY = 9.80665

#: Value of each unit in metres and in newtons; capital letters do not matter.
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254, "inch": 0.0254, "inches": 0.0254}
FORCES = {
    "N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605, "kips": 4448.2216152605,
    "klb": 4448.2216152605, "lbf": 4.4482216152605, "kgf": 9.80665,
    "tf": 9806.65, "tonf": 9806.65, "t": 9806.65, "ton": 9806.65,
}  # fmt: skip

#: Parts of the names of a quantity, without accents: English, then German, Spanish, French,
#: Italian, Turkish. A single letter is a name of its own only, and two are a word in a name; the
#: first that fits one column only names it.
WORDS = {
    "time": ("time", "t", "zeit", "tiempo", "temps", "tempo", "zaman", "x_value"),
    "acceleration": (
        "acceleration", "acc", "ag", "a", "beschleunigung", "aceleracion", "accelerazione", "ivme",
    ),
    "displacement": (
        "displacement", "disp", "deflection", "drift", "delta", "verschiebung", "auslenkung", "weg",
        "desplazamiento", "deplacement", "spostamento", "yerdegistirme", "yer degistirme",
        "deplasman", "d", "u", "x",
    ),
    "force": (
        "force", "load", "shear", "kraft", "fuerza", "carga", "effort", "charge", "forza", "carico",
        "kuvvet", "yuk", "f", "v", "p", "h",
    ),
}  # fmt: skip

#: Other words that are units, and not names, at the end of a name or below it.
_OTHERS = (
    " s ms sec second seconds min - % rad mrad deg v mv nm ft lb klbf psi ksi pa mpa gpa bar"
    " με ue um μm microstrain strain g gal gals hz °c kg knm"
)
_UNITS = {*_OTHERS.split(" "), *(unit.lower() for unit in (*LENGTHS, *FORCES))}
#: Units of which others are made: kN m, mm/mm, m/s2.
_PARTS = re.compile(r"[/*·.\s]|-(?=[a-z])|(?<=[a-z])(?:\^|\*\*)?[({]?-?\d[)}]?$")

# In the order in which they are tried; a comma that separates has no comma before the decimals.
_LAYOUTS = ((";", "."), (";", ","), ("\t", "."), ("\t", ","), (",", "."), (" ", "."), (" ", ","))
_SEPARATORS = (",", ";", "\t", " ")

#: Lines that are looked at, and rows in a line that make the beginning of the numbers.
_SAMPLE = 500
_ROWS = 3
#: Largest file that is read [bytes].
_MOST_BYTES = 500_000_000

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+)?$")
#: How programs write a value that is no number: NaN, -Inf, 1.#IND, -1.#QNAN, -nan(ind).
_NOT_FINITE = re.compile(r"[+-]?(nan(\(\w*\))?|inf(inity)?|1[.,]#\w+)$", re.IGNORECASE)
#: A line of key and value, as UNITS: cm/s2 or DT=0.01.
_STATEMENT = re.compile(r"\W*[A-Za-z][^:=]*[:=]\s*\S")
#: A comment begins at the start of a line, or after a blank behind something else.
_COMMENT = re.compile(r"(?<=\S)\s+#.*")


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
        The numbers; NaN in a column of texts.
    head : tuple of str
        The lines above the first row and the names.
    first : int
        Number of the lines above the first row.
    texts : dict of int to str
        Columns of texts, dates or clocks, with the first entry of each.
    """

    source: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    values: Array
    head: tuple[str, ...] = ()
    first: int = 0
    texts: Mapping[int, str] = field(default_factory=dict)

    @property
    def columns(self) -> int:
        """Number of columns."""
        return len(self.names)

    def describe(self) -> str:
        """Return the columns in words."""
        if not any(self.names):
            return f"{self.columns} columns without names"
        return "columns " + ", ".join(f"{i} {name!r}" for i, name in enumerate(self.names, 1))

    def find(self, quantity: str, but: Sequence[str] = ()) -> int | None:
        """Return the index of the only column of numbers that has the name of a quantity, or None.

        A word of one letter names a column only if it stands alone or before its unit. `but` are
        words that the name must not have.
        """
        names = [plain(name) for name in self.names]
        for word in WORDS[quantity]:
            named = [
                i
                for i, name in enumerate(names)
                if i not in self.texts
                and (_is_in(word, name) if len(word) > 1 else bare(name) == word)
                and not any(other in name for other in but)
            ]
            if len(named) == 1:
                return named[0]
        return None

    def index_of(self, value: object, what: str) -> int:
        """Return the index of a column that a user names, or counts from 1; `what` it is for."""
        if isinstance(value, str):
            word = value.strip().lower()
            names = [name.lower() for name in self.names]
            named = [i for i, name in enumerate(names) if word in (name, bare(name))]
            if len(named) != 1:
                fault = "is the name of more than one column" if named else "is not there"
                raise InputError(
                    f"{self.source}: column {value!r} {fault}; there are {self.describe()}; "
                    "a number from 1 is taken as well"
                )
            at = named[0]
        else:
            number = _arguments.integer(value, what)
            if not 1 <= number <= self.columns:
                raise InputError(
                    f"{what} = {number}, but {self.source} has {self.describe()}, counted from 1"
                )
            at = number - 1
        if at in self.texts:
            raise InputError(
                f"{self.source}: column {value!r} has texts, as {self.texts[at]!r}, and no numbers"
            )
        return at


def plain(text: str) -> str:
    """Return a text in small letters without accents."""
    parts = unicodedata.normalize("NFKD", text.lower().replace("ı", "i"))
    text = "".join(letter for letter in parts if not unicodedata.combining(letter))
    return text.replace("\u2212", "-").replace("\u2044", "/")


def _is_in(word: str, name: str) -> bool:
    """Return whether a word is a part of a name: "ag" is none of "flag"."""
    return word in name if len(word) > 2 else word in re.split("[^a-z]+", name)


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
    source : path-like or str
        A file, or a text of two lines or more.

    Raises
    ------
    InputError
        If the file cannot be read, or holds no text.
    """
    if isinstance(source, str) and "\n" in source:
        where, text = "text", source.lstrip("\ufeff")
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
        try:
            text = raw.decode("utf-8-sig")
        except UnicodeDecodeError:
            text = raw.decode("latin-1")
    if not text.strip():
        raise InputError(f"{where}: is empty; download or export it again")
    text = text.replace("\u2212", "-").replace("\r\n", "\n").replace("\r", "\n")
    return where, text.split("\n")


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
    source : path-like, str or (str, list of str)
        A file, a text, or what `read_lines` returned.
    separator, decimal : str, optional
        Separator of two values: ",", ";", a tab or a blank; and before decimals: "." or ",".
    header : int, optional
        Lines above the first row.
    least : int, optional
        Fewest columns.

    Raises
    ------
    InputError
        If there are no rows, what is stated cannot be, or a value is no finite number; with the
        line.

    Warns
    -----
    RepairWarning
        If columns of texts, dates or clocks are left out.
    """
    if separator is not None and not _arguments.is_one_of(separator, _SEPARATORS):
        raise InputError(f'separator = {separator!r} must be ",", ";", "\\t" or " "')
    if decimal is not None and not _arguments.is_one_of(decimal, (".", ",")):
        raise InputError(f'decimal = {decimal!r} must be "." or ","')
    if separator == decimal == ",":
        raise InputError("separator and decimal are both a comma; one of them must be another")
    where, lines = source if isinstance(source, tuple) else read_lines(source)
    lines = [_COMMENT.sub("", line) if "#" in line else line for line in lines]
    header = None if header is None else _arguments.integer(header, "header")
    if header is not None and not 0 <= header < len(lines):
        raise InputError(f"header = {header}: {where} has {len(lines)} lines")
    stated: dict[str, Any] = {"separator": separator, "decimal": decimal, "header": header}
    first, mark, point, texts = _layout(lines, where, stated, least)
    columns = len(_split(lines[first], mark))
    if header is None:
        first = _first_row(lines, first, mark, point)
    values = _values(lines, first, columns, mark, point, where, texts)
    at = first if _is_count(lines, first, mark) else first - 1
    above = [i for i in range(first) if lines[i].strip()]
    names_at = first
    if header is None and values.shape[1] in (2, 3) and _is_count(lines, at, mark):
        # The format of the PEER database: a title, the number of rows, the rows.
        values = values[at + 1 - first :]
        count = values.shape[1]
        names, units = ("displacement", "force", "axial_load")[:count], ("mm", "kN", "kN")[:count]
    else:
        remarks = lines[first].rstrip(" ").endswith(mark)
        names, units, rows = _head([lines[i] for i in above], mark, values.shape[1], remarks)
        names_at = above[-rows] if rows else first
        # Two numbers below names alone may be the first row.
        counted = rows == 2 or (rows == 1 and values.shape[1] > 2)
        if header is None and counted and _are_channels(lines[first:], mark):
            warn(f"{where} line {first + 1}: numbers of channels are left out", RepairWarning)
            values = values[1:]
    if texts:
        said = "; ".join(f"{names[i] or i + 1!r} has {text!r}" for i, text in texts.items())
        warn(f"{where}: columns of texts are left out: {said}", RepairWarning)
    return NumberTable(where, names, units, values, tuple(lines[:names_at]), first, texts)


def _layout(
    lines: list[str], where: str, stated: dict[str, Any], least: int
) -> tuple[int, str, str, dict[int, str]]:
    """Return the lines above the first row, separator, decimal point and columns of texts."""
    sample, header = lines[:_SAMPLE], stated["header"]
    filled = [i for i, line in enumerate(sample) if line.strip() and line.lstrip()[0] != "#"]
    # Several columns before one, numbers alone before numbers and texts; a few rows in a line are
    # the beginning, and in a file with a mistake there may be only one.
    wanted = [(2, _ROWS, False), (2, _ROWS, True), (2, 1, False)]
    if least == 1:
        wanted += [(1, _ROWS, False), (1, _ROWS, True), (1, 1, False)]
    for columns, rows, mixed in wanted:
        best: tuple[int, int, str, str, tuple[bool, ...]] | None = None
        for mark, point in _LAYOUTS:
            if stated["separator"] not in (None, mark) or stated["decimal"] not in (None, point):
                continue
            kinds = {i: _kinds(_split(sample[i], mark), point) for i in filled}
            fit = {i for i in filled if sum(kinds[i]) >= columns and all(kinds[i]) is not mixed}
            begin = _begin(kinds, filled, rows, fit) if header is None else header
            count = sum(i >= (begin or 0) for i in fit)
            # A few lines of texts and numbers may stand above the rows of another layout.
            if begin is None or not count or (mixed and 2 * count < len(filled)):
                continue
            if best is None or count > best[0]:
                row = next(kinds[i] for i in filled if i >= begin and i in fit)
                best = count, begin, mark, point, row
        if best is not None:
            _, begin, mark, point, row = best
            words = _split(next(sample[i] for i in filled if i >= begin), mark) if mixed else []
            texts = {i: words[i][:40] for i, number in enumerate(row) if not number}
            return begin, mark, point, texts
    known = ", ".join(f"{name} = {value!r}" for name, value in stated.items() if value is not None)
    raise InputError(
        f"{where}: has no rows of {'two or more ' if least > 1 else ''}numbers"
        f"{known and ' with '}{known}; check what separates the values, and the decimal point"
    )


def _begin(
    kinds: dict[int, tuple[bool, ...]], filled: list[int], rows: int, fit: set[int]
) -> int | None:
    """Return the first of the rows of numbers: alike in a few lines, or to the end."""
    for place, i in enumerate(filled):
        if i in fit and all(kinds[j] == kinds[i] for j in filled[place : place + rows]):
            return i
    return None


def _first_row(lines: list[str], begin: int, mark: str, point: str) -> int:
    """Return the first row, where one among the first may be wrong.

    A line above with as many fields as the rows, one of them a number, is a row, and so is any line
    below the names of the columns, and above a row in a file that begins with one.
    """
    columns, first, named = len(_split(lines[begin], mark)), begin, False
    remarks = lines[begin].rstrip(" ").endswith(mark)
    top, between = (begin, False), begin
    for i in range(begin - 1, -1, -1):
        if lines[i].startswith("***End_of_Header***"):  # of LabVIEW
            break
        words = _split(lines[i], mark)
        if not words or lines[i].lstrip().startswith("#") or _STATEMENT.match(lines[i]):
            continue
        numbers = _kinds(words, point)
        like = any(numbers) or any(map(_NOT_FINITE.match, words))
        fields = len(words) if mark == " " else lines[i].count(mark) + 1
        counts = named and _counts(words, columns)
        if counts or (len(words) < columns and _is_count(lines, i, mark)):
            continue
        if remarks and len(words) == columns + 1:
            words = words[:columns]
        top = i, all(numbers) and (len(words) == columns or mark != " ")
        # Between blanks, a title is words and numbers too.
        title = mark == " " and not (numbers[0] or _NOT_FINITE.match(words[0]))
        short = all(numbers) and len(words) < columns
        if top[1] or short or (like and columns in (len(words), fields) and not title):
            first = first if named else i
        elif len(words) == columns and not like and "" not in words:
            first = first if named or mark == " " else min(first, between)
            # In one column a word among numbers is no name.
            named = columns > 1
        elif any(map(str.isalnum, lines[i])):
            between = i
    return top[0] if top[1] else first


def _values(
    lines: list[str],
    first: int,
    columns: int,
    mark: str,
    point: str,
    where: str,
    texts: Collection[int],
) -> Array:
    """Return the numbers of all rows, and NaN in columns of texts."""
    rows = ["" if line.lstrip()[:1] == "#" else line for line in lines[first:]]
    if point == ",":
        rows = [line.replace(",", ".") for line in rows]
    try:
        # Nearly all files are in order.
        separator = None if mark == " " else mark
        values = np.loadtxt(rows, delimiter=separator, comments=None, quotechar='"', ndmin=2)
        if np.isfinite(values).all():
            return values
    except ValueError:
        pass
    found: list[list[float]] = []
    for number, line in enumerate(rows, first + 1):
        if not line.strip():
            continue
        words = _split(line, mark)
        if len(words) != columns:
            if not found and len(words) == 1 and words[0].isdigit():
                behind = sum(bool(line.strip()) for line in rows[number - first :])
                raise InputError(
                    f"{where} line {number}: declares {words[0]} rows, but there are {behind}; the "
                    "file is cut or mixed up, or the number wants correcting"
                )
            raise InputError(
                f"{where} line {number}: has {len(words)} value{'s' * (len(words) != 1)}, the rows "
                f"{'before' if found else 'behind'} have {columns}; every row has one for each "
                "column"
            )
        at = f"{where} line {number}, value "
        found.append([np.nan if i - 1 in texts else _number(word, f"{at}{i}")
                      for i, word in enumerate(words, 1)])  # fmt: skip
    return np.array(found)


def _number(word: str, where: str) -> float:
    """Return the number of a field, or raise `InputError` with the place of the field."""
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
    """Return the fields of a line; a blank as `mark` stands for any number of blanks."""
    line = line.strip(" \t") if mark == " " else line.strip(" ").rstrip("\t ")
    if not line:
        return []
    words = line.split() if mark == " " else line.split(mark)
    words = [word.strip().strip('"').strip() for word in words]
    # Spreadsheets may end each line with a separator.
    return words[:-1] if len(words) > 1 and not words[-1] else words


def _kinds(words: Sequence[str], point: str) -> tuple[bool, ...]:
    """Return which fields of a line are numbers."""
    if point == ",":
        words = [word.replace(",", ".") if "." not in word else "x" for word in words]
    return tuple(bool(_NUMBER.match(word)) for word in words)


def _is_count(lines: Sequence[str], at: int, mark: str) -> bool:
    """Whether a line has the number of the lines behind it, alone or with a 0."""
    if mark not in (" ", "\t") or at < 0:
        return False
    words = lines[at].split()
    if not words or not words[0].isdigit() or words[1:] not in ([], ["0"]):
        return False
    return int(words[0]) == sum(bool(line.strip()) for line in lines[at + 1 :])


def _head(
    lines: Sequence[str], mark: str, columns: int, remarks: bool
) -> tuple[tuple[str, ...], tuple[str, ...], int]:
    """Return names and units from the lines above the numbers, and how many of these have them.

    A column of remarks without one has a name, and no field that is a number, or none at all.
    """
    empty = ("",) * columns
    statement = lines and _STATEMENT.match(lines[-1]) and len(re.findall("[:=]", lines[-1])) == 1
    rows = [] if statement else [_names(line, mark, columns) for line in lines[-3:]]
    if remarks or any(plain(row[-1]) == "comment" for row in rows[-1:] if row):
        rows = [row[:columns] if len(row) == columns + 1 else row for row in rows]
    last = rows[-1] if rows else ()
    if len(last) != columns:
        return empty, empty, 0
    several = len(rows) == 3 and len(rows[0]) == len(rows[1]) == columns
    if several and _are_units(rows[1], rows[0]) and not any(map(_is_unit, last)):
        # Names of channels below the units
        return rows[0], tuple(word.strip("[]() ") for word in rows[1]), 3
    above = rows[-2] if len(rows) > 1 and len(rows[-2]) == columns else empty
    if all(map(_is_unit, last)) or (above is not empty and _are_units(last, above)):
        units = tuple(word.strip("[]() ") for word in last)
        return above, units, 1 if above is empty else 2
    units = tuple(map(_unit_in, last))
    if not any(units) and mark != " ":
        # In the files of some programs the units stand further up, without that of the times.
        stated = (_names(line, mark, columns) for line in reversed(lines[:-1]))
        row = next((row for row in stated if len(row) == columns and all(map(_is_unit, row[1:]))
                    and not _is_unit(row[0])), ("", *units[1:]))  # fmt: skip
        units = ("", *row[1:])
    return last, units, 1


def _are_units(words: Sequence[str], above: Sequence[str]) -> bool:
    """Whether most words of a line are units, and few of the line above are."""
    known, named = (sum(map(_is_unit, row)) for row in (words, above))
    return 2 * known > len(words) and 2 * named < len(words)


def _are_channels(lines: Sequence[str], mark: str) -> bool:
    """Whether the first line counts the columns, and the next one has decimals."""
    rows = [_split(line, mark) for line in lines[:20] if line.strip()][:2]
    counted = len(rows) == 2 and _counts(rows[0], len(rows[1]))
    return counted and not any(map(str.isdigit, rows[1]))


def _counts(words: Sequence[str], columns: int) -> bool:
    """Whether a line has the numbers of the columns, one after the other."""
    first = words[0] if columns > 1 and words and words[0] in ("0", "1") else "-1"
    return list(words) == [str(int(first) + i) for i in range(columns)]


def _names(line: str, mark: str, columns: int) -> tuple[str, ...]:
    """Return the names in a line; between blanks, one of two words has two blanks behind it."""
    words = _split(line.lstrip("#"), mark)
    if mark == " ":
        # A unit in brackets belongs to the name before it.
        together = re.sub(r"\s+(?=[(\[])", " ", line.strip("# \t"))
        joined = re.findall(r"[^\s(\[]\S*(?: [(\[][^)\]]*[)\]])?|[(\[]\S*", together)
        if len(joined) != len(words) or len(words) != columns:
            apart = re.split(r"\s{2,}|\t", line.strip("# \t"))
            words = joined if len(joined) == columns else apart
    return tuple(words)


def _is_unit(word: str) -> bool:
    """Whether a word is a unit, or is in brackets as a unit is."""
    unit = plain(word.strip("[]() "))
    parts = _PARTS.split(unit)
    return word[:1] in ("[", "(") or (unit != "." and all(part in _UNITS for part in parts))


def _unit_in(name: str) -> str:
    """Return the unit at the end of a name, as in `d_mm`, `d [mm]`, `d (mm)`, or an empty text."""
    found = re.search(r"[(\[]\s*([^()\[\]]+?)\s*[)\]]$", name.strip())
    if found:
        return found[1]
    if re.fullmatch(r"\W*[NSEWUD]-[NSEWUD]\W*", name):
        return ""  # A direction
    name = re.sub(r"\s+in\s+(?=\S+$)", " ", name)
    ends = (name[mark.end() :] for mark in re.finditer(r"[\s_/-]", name))
    return next((end for end in ends if end.strip("- ") and _is_unit(end)), "")
