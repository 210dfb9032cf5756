"""A laboratory's own file of a test: displacement and force, read, checked and made comparable."""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.measured.measured import MeasuredTest, net_force, top_displacement

__all__ = ["UNITS", "Layout", "find_layout", "read_test"]


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
        quantities = ("displacement", "force", "axial_load")
        return Layout(s, d, at + 1, quantities[:columns], ("mm", "kN", "kN")[:columns])
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


_QUANTITIES = ("displacement", "force")

# What the force column is, by the P-Delta code of the database.
_CODES = {
    1: "the base moment over the length, with P-Delta in it",
    2: "the net horizontal force on the column",
    3: "the actuator's force, of which the leaning axial ram takes a part",
    4: "the actuator's force, to which the leaning axial ram adds a part",
}

# How columns are often called; the first that fits one column only is taken.
_WORDS = {
    "displacement": ("displacement", "disp", "deflection", "drift", "delta", "d", "u", "x"),
    "force": ("force", "load", "shear", "f", "v", "p", "h"),
}

# What the largest values of a test of a column may be, and where the doubt begins.
_PLAUSIBLE = {"displacement": (5e-4, 1.5, "m"), "force": (500.0, 5e7, "N")}
_LENGTHS, _SMALLEST_LOAD = (0.1, 30.0), 3000.0
_LARGEST_DRIFT, _SMALLEST_DRIFT = 0.4, 5e-4

# A first row beyond this part of the largest value is an offset; a smaller area is none.
_OFFSET = 0.05
_AREA = 0.02

# Bytes that are read to find the layout.
_BEGINNING = 1_000_000


def read_test(
    path: str | os.PathLike[str],
    *,
    columns: Sequence[str | int] | Mapping[str, str | int] | None = None,
    units: Sequence[str] | Mapping[str, str] | None = None,
    pdelta_code: Literal[1, 2, 3, 4] | None = None,
    length: float | None = None,
    axial_load: float | None = None,
    measured_length: float | None = None,
    top_length: float | None = None,
    bottom_length: float | None = None,
    separator: str | None = None,
    decimal: str | None = None,
    header: int | None = None,
    zero: bool | None = None,
    force_sign: Literal[1, -1] = 1,
    checks: bool = True,
    name: str | None = None,
) -> MeasuredTest:
    """Read a test from a laboratory's own csv or text file, check it, and find the net force.

    Separator, decimal point, lines above the numbers, names and units are found in the file, or
    stated. What comes back goes where a test of the database goes: `rbsdem.compare`,
    `rbsdem.calibrate`, `rbsdem.plot.loop`, and `cyclic(column, displacement=test.displacement)`.

    Parameters
    ----------
    path : path
        Text with a row of numbers a line. Above them there may be any lines; the last may have the
        names of the columns, or their names and below them their units.
    columns : pair or mapping, optional
        Columns of displacement and force, by name or by number from 1: ``("LVDT 3", 5)`` or
        ``{"displacement": "LVDT 3", "force": 5}``. By default they are found by their names, or are
        the two columns of a file that has no more.
    units : pair or mapping, optional
        Their units: "m", "mm", "cm", "in" and "N", "kN", "MN", "kip". By default those that the
        file gives in the names (``d_mm``, ``Force [kN]``) or below them.
    pdelta_code : {1, 2, 3, 4}
        What the force column is; every test needs it, since P-Delta is in some forces and not in
        others:

        1. the base moment over the length ("effective force", P-Delta is part of it);
        2. the net horizontal force on the column, or P-Delta was already taken out;
        3. the force of the horizontal actuator, where the ram of the axial load leans with the top
           and its horizontal part takes part of it: the shear is smaller;
        4. as 3, where the ram leans the other way: the shear is larger.
    length : float, optional
        From the base to the lateral force, that of the equivalent cantilever [m]. Needed for codes
        1 and 3, and for drifts.
    axial_load : float, optional
        Compression positive [N]. Needed for codes 1, 3 and 4.
    measured_length : float, optional
        Height at which the displacement was measured [m]; by default the length.
    top_length, bottom_length : float, optional
        From the column's ends to the hinges of the axial ram [m]; code 4 needs the first.
    separator, decimal : str, optional
        What stands between two values: ",", ";", a tab or a blank; and before decimals: "." or ",".
    header : int, optional
        Lines above the first row of numbers.
    zero : bool, optional
        True takes the first row off all others; False accepts an offset of the first row.
    force_sign : {1, -1}, optional
        -1 turns the forces round.
    checks : bool, optional
        False leaves out the checks of size, sign, order and offset.
    name : str, optional
        Name of the test; by default that of the file.

    Returns
    -------
    MeasuredTest
        Displacement of the top [m] and net horizontal force F_H [N]; `length` and `axial_load` are
        NaN if they were not given.

    Raises
    ------
    InputError
        If the file cannot be read, if column, unit or code are not known, or if a check fails: the
        largest values are not those of a test of a column, the force acts against the displacement,
        the columns are exchanged (their loop runs backward), or the first row is not near zero.
        The message names the value and the remedy.

    See Also
    --------
    read_peer : the same reader for files in the format of the database.
    rbsdem.peer.net_force : the formulas of the codes.

    Notes
    -----
    The area ½∮(F dd - d dF) of a loop is the energy that the column takes up and is positive. If
    columns are exchanged it is negative; if the sign of one column is wrong, so is that of the
    correlation of the two.
    """
    where = _arguments.file(path)
    code = _code(pdelta_code, length, axial_load)
    if force_sign not in (1, -1):
        raise InputError(f"force_sign = {force_sign!r} must be 1 or -1")
    layout = find_layout(
        _beginning(where), where, separator=separator, decimal=decimal, header=header
    )
    chosen = _columns(columns, layout, where)
    given = _units(units, chosen, layout, where)
    read, d, f = _core.read_history(
        where, *given, (layout.separator, layout.decimal, layout.skip), (chosen[0], chosen[1])
    )
    f = force_sign * f
    if zero:
        d, f = d - d[0], f - f[0]
    if checks:
        _check_units(length, axial_load)
        _check_sizes(d, f, given, length, where)
        _check_offset(d, f, zero, where)
        _check_order(d, f, where)
    span = math.nan if length is None else length
    try:
        load = math.nan if axial_load is None else _arguments.number(axial_load, "axial_load")
        force = net_force(
            d,
            f,
            code=code,
            axial_load=load,
            top_length=top_length,
            bottom_length=bottom_length,
            length=span,
            measured_length=measured_length,
        )
    except InputError as error:
        raise InputError(f"{where}: {error}") from error
    top = 0.0 if code == 4 else top_length or 0.0
    return MeasuredTest(
        name=name or Path(read).stem,
        displacement=d.copy()
        if length is None
        else top_displacement(d, length=length, measured_length=measured_length),
        force=force,
        measured_displacement=d,
        measured_force=f,
        length=span,
        axial_load=load,
        pdelta_code=code,
        axial_height=span + top,
    )


def _code(code: int | None, length: float | None, axial_load: float | None) -> int:
    """Return the P-Delta code, if it is one and what it needs is there."""
    if isinstance(code, bool) or not isinstance(code, int) or code not in _CODES:
        missing = "is needed" if code is None else f"= {_arguments.shown(code)} is not known"
        codes = "; ".join(f"{key}: {text}" for key, text in _CODES.items())
        raise InputError(f"pdelta_code {missing}. It says what the force column is: {codes}")
    for value, needed, what in (
        (length, (1, 3), "length (from the base to the lateral force, m)"),
        (axial_load, (1, 3, 4), "axial_load (N)"),
    ):
        if value is None and code in needed:
            raise InputError(f"pdelta_code = {code} ({_CODES[code]}) needs {what}")
    if length is not None and not 0 < _arguments.number(length, "length") < math.inf:
        raise InputError(f"length = {length} m must be positive")
    return code


def _beginning(where: str) -> str:
    if not os.path.isfile(where):
        what = "is no ordinary file" if os.path.exists(where) else "is not there"
        raise InputError(f"{where}: {what}; give the path of a text file")
    try:
        with open(where, "rb") as file:
            raw = file.read(_BEGINNING)
    except OSError as error:
        raise InputError(f"{where}: {error.strerror}; check path and permissions") from error
    if b"\0" in raw:
        raise InputError(f"{where}: is no text file; save it as csv or text in UTF-8")
    # A last line that is cut off says nothing.
    text = raw.decode("utf-8-sig", "replace")
    return text if len(raw) < _BEGINNING else text[: text.rfind("\n") + 1]


def _pair(given: object, what: str, examples: str) -> tuple[object, object]:
    """Return what is given for displacement and force."""
    if isinstance(given, Mapping):
        strange = [key for key in given if key not in _QUANTITIES]
        if strange:
            raise InputError(f"{what}: {strange[0]!r} is neither 'displacement' nor 'force'")
        return given.get("displacement"), given.get("force")
    if isinstance(given, Sequence) and not isinstance(given, str) and len(given) == 2:
        return given[0], given[1]
    raise InputError(f"{what} = {given!r} must be two, for displacement and force: {examples}")


def _columns(given: object, layout: Layout, where: str) -> list[int]:
    """Return the numbers of the columns of displacement and force."""
    pair: tuple[object, object] = (None, None)
    if given is not None:
        pair = _pair(given, "columns", 'columns=("LVDT 3", "load") or columns=(1, 2)')
    found = [_column(value, q, layout, where) for value, q in zip(pair, _QUANTITIES, strict=True)]
    if None in found and layout.columns == 2 and found.count(None) == 1:
        found = [3 - int(found[1 - i] or 0) if n is None else n for i, n in enumerate(found)]
    elif found == [None, None] and layout.columns == 2 and not _has_time(layout):
        found = [1, 2]
    for number, quantity in zip(found, _QUANTITIES, strict=True):
        if number is None:
            raise InputError(
                f"{where}: which column is the {quantity}? There are {layout.describe()}; say "
                "columns=(displacement, force), by name or by number from 1"
            )
    if found[0] == found[1]:
        raise InputError(f"columns: displacement and force are both column {found[0]} of {where}")
    return [int(number) for number in found if number is not None]


def _column(value: object, quantity: str, layout: Layout, where: str) -> int | None:
    names = [name.lower() for name in layout.names]
    if value is None:
        for word in _WORDS[quantity]:
            # One letter is a name only if it stands alone, or before its unit.
            long = len(word) > 1
            fit = [
                i
                for i, name in enumerate(names, 1)
                if (word in name if long else _bare(name) == word)
                and not ("time" in name or ("axial" in name and quantity == "force"))
            ]
            if len(fit) == 1:
                return fit[0]
        return None
    if isinstance(value, str):
        fit = [i for i, name in enumerate(names, 1) if value.strip().lower() in (name, _bare(name))]
        if len(fit) == 1:
            return fit[0]
        several = "is the name of more than one column" if fit else "is not there"
        raise InputError(
            f"{where}: column {value!r} {several}; there are {layout.describe()}; "
            "a number from 1 is taken as well"
        )
    number = _arguments.whole(value, f"columns: {quantity}")
    if not 1 <= number <= layout.columns:
        raise InputError(
            f"columns: {quantity} = {number}, but {where} has {layout.describe()}, counted from 1"
        )
    return number


def _bare(name: str) -> str:
    """Return a name without the unit at its end."""
    for mark in ("[", "(", "_", " "):
        name = name.split(mark, maxsplit=1)[0] if mark in name[1:] else name
    return name.strip()


def _has_time(layout: Layout) -> bool:
    return any(name.lower().startswith("time") or name.lower() == "t" for name in layout.names)


def _units(given: object, chosen: list[int], layout: Layout, where: str) -> tuple[str, str]:
    """Return the units of displacement and force."""
    pair: tuple[object, object] = (None, None)
    if given is not None:
        pair = _pair(given, "units", 'units=("mm", "kN")')
    found = []
    for value, number, quantity in zip(pair, chosen, _QUANTITIES, strict=True):
        unit = layout.units[number - 1] if value is None else str(value)
        known = {name.lower(): name for name in UNITS[quantity]}
        if unit.lower() not in known:
            has = f"has the unit {unit!r}" if unit else "has no unit"
            named = layout.names[number - 1] or str(number)
            raise InputError(
                f"{where}: the {quantity}, column {named!r}, {has}; say "
                f"units=(displacement, force), the {quantity} in {', '.join(known.values())}"
            )
        found.append(known[unit.lower()])
    return found[0], found[1]


def _check_units(length: float | None, axial_load: float | None) -> None:
    if length is not None and not _LENGTHS[0] <= length <= _LENGTHS[1]:
        raise InputError(
            f"length = {length} m; a column has {_LENGTHS[0]} to {_LENGTHS[1]} m. Give metres, or "
            "say checks=False"
        )
    if axial_load is not None and 0 < abs(axial_load) < _SMALLEST_LOAD:
        raise InputError(
            f"axial_load = {axial_load} N is less than {_SMALLEST_LOAD:.0f} N. Give newtons, 0 if "
            "there is none, or say checks=False"
        )


def _check_sizes(
    d: Array, f: Array, units: tuple[str, str], length: float | None, where: str
) -> None:
    for values, unit, quantity in zip((d, f), units, _QUANTITIES, strict=True):
        largest = float(np.max(np.abs(values)))
        low, high, si = _PLAUSIBLE[quantity]
        if length is not None and quantity == "displacement":
            low, high = _SMALLEST_DRIFT * length, _LARGEST_DRIFT * length
        if not low <= largest <= high:
            raise InputError(
                f"{where}: the largest {quantity} is {largest:.4g} {si}, read in {unit}; a test of "
                f"a column has {low:.3g} to {high:.3g} {si}. Check units=({units[0]!r}, "
                f"{units[1]!r}), columns and length, or say checks=False"
            )


def _check_offset(d: Array, f: Array, zero: bool | None, where: str) -> None:
    if zero is not None:
        return
    for values, quantity, si in ((d, "displacement", "m"), (f, "force", "N")):
        share = abs(values[0]) / float(np.max(np.abs(values)))
        if share > _OFFSET:
            raise InputError(
                f"{where}: the first {quantity} is {values[0]:.4g} {si}, {100 * share:.0f} % of "
                "the largest; say zero=True to take the first row off all others, or zero=False if "
                "the test does begin there"
            )


def _check_order(d: Array, f: Array, where: str) -> None:
    together = float(np.dot(d, f))
    area = 0.5 * float(np.sum(f[:-1] * np.diff(d) - d[:-1] * np.diff(f)))
    size = float(np.max(np.abs(d)) * np.max(np.abs(f)))
    if together < 0:
        raise InputError(
            f"{where}: the force acts against the displacement; the sign of one of them is turned "
            "round, say force_sign=-1 (or checks=False if it is meant so)"
        )
    if area < -_AREA * size:
        raise InputError(
            f"{where}: the loop runs backward and gives energy ({area:.4g} J); displacement and "
            "force are exchanged: say columns=(displacement, force) the other way round (or "
            "checks=False if it is meant so)"
        )
