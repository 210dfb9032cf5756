"""Measured tests: displacement and net horizontal force, of the database or of one's own file.

The full histories belong to the PEER Structural Performance Database and are no part of rbsdem; a
user gets them there (https://nisee.berkeley.edu/spd/) and names the folder. Without them, the
reversal points of `data/reversals_<key>.csv` are used.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments, _core, _package
from rbsdem._files import Tabular
from rbsdem._tables import FORCES, LENGTHS, NumberTable, read_table, to_si
from rbsdem._types import Array, ArrayLike
from rbsdem.curves.metrics import Loop
from rbsdem.errors import InputError

PDELTA_CODES = {
    1: "the base moment over the length, with P-Delta in it",
    2: "the net horizontal force on the column",
    3: "the actuator's force, of which the leaning axial ram takes a part",
    4: "the actuator's force, to which the leaning axial ram adds a part",
}
"""Meaning of the force column of a test, by the P-Delta code of the database (manual, 3.3)."""


@dataclass(frozen=True, repr=False, slots=True, eq=False)
class MeasuredTest(Tabular):
    """A measured history with its net horizontal force.

    Attributes
    ----------
    name : str
        Name of the test.
    displacement : ndarray, shape (m,)
        Displacement of the top of the equivalent cantilever, where the lateral force acts [m]; it
        drives a column. One that was measured at another height is scaled by the heights.
    force : ndarray, shape (m,)
        Net horizontal force F_H [N], the lateral force of a model with P-Delta.
    measured_displacement, measured_force : ndarray, shape (m,)
        Columns of the file [m, N].
    length : float
        Length of the equivalent cantilever [m].
    axial_load : float
        Axial load, compression positive [N].
    pdelta_code : int or None
        Code by which `force` was found; None, where the report does not give it, is taken as 2.
    axial_height : float
        Height at which the axial load acts, at the hinge of its ram [m].
    """

    _columns = ("displacement m", "force N")

    name: str
    displacement: Array
    force: Array
    measured_displacement: Array
    measured_force: Array
    length: float
    axial_load: float
    pdelta_code: int | None
    axial_height: float

    def __repr__(self) -> str:
        d, f = 1e3 * self.displacement, self.force / 1e3
        return (
            f"MeasuredTest({self.name}: {d.size} rows, {d.min():.4g} to {d.max():.4g} mm, "
            f"{f.min():.4g} to {f.max():.4g} kN; length {self.length:.4g} m, "
            f"N {self.axial_load / 1e3:.4g} kN)"
        )

    @property
    def height(self) -> float:
        """The length, under the name it has in `rbsdem.Column` [m]."""
        return self.length

    @property
    def drift(self) -> Array:
        """Displacement over length, shape (m,)."""
        return self.displacement / self.length

    @property
    def base_moment(self) -> Array:
        """Moment at the base, with that of the axial load in the displaced position [N m].

        F_H L + P d (L + L_top)/L, d at the top: exact where the axial load stays vertical.
        """
        lever = self.axial_height / self.length
        return self.force * self.length + self.axial_load * lever * self.displacement


def net_force(
    displacement: ArrayLike,
    force: ArrayLike,
    *,
    code: int | None,
    axial_load: float,
    length: float,
    measured_length: float | None = None,
    top_length: float | None = None,
    bottom_length: float | None = None,
) -> Array:
    """Return the net horizontal force from the force column of a test.

    Parameters
    ----------
    displacement, force : array_like, shape (m,)
        The history as in its file [m, N], the displacement where it was measured.
    code : {1, 2, 3, 4} or None
        P-Delta code of the test; None, where the report does not give it, is taken as 2.
    axial_load : float
        Compression positive [N].
    length : float
        Of the equivalent cantilever [m].
    measured_length : float, optional
        Height at which `displacement` was measured [m]; by default the length.
    top_length, bottom_length : float, optional
        From the column's ends to the hinges of the axial ram [m]; by default 0.

    Returns
    -------
    ndarray, shape (m,)
        Net horizontal force F_H [N].

    Raises
    ------
    InputError
        If there is no such code, or if code 4 comes without `top_length`.

    Notes
    -----
    Berry, Parrish and Eberhard (2004), PEER Structural Performance Database User's Manual, 3.3.
    With F the force column, d the displacement, P the axial load: F_H = F - P d/L_meas (code 1), F
    (code 2), F - P sin(atan(d (L + L_top)/L_meas/(L + L_top + L_bottom))) (code 3), F + P d/L_top
    (code 4).
    """
    d = _arguments.finite_vector(displacement, "displacement")
    f = _arguments.finite_vector(force, "force")
    if d.shape != f.shape:
        raise InputError(f"displacement has {d.size} rows, force {f.size}; they must be equal")
    if code is not None:
        code = _arguments.integer(code, "code")
    axial_load = _arguments.number(axial_load, "axial_load")
    length = _arguments.number(length, "length")
    measured, top, bottom = (
        default if value is None else _arguments.number(value, name)
        for name, value, default in (
            ("measured_length", measured_length, length),
            ("top_length", top_length, 0.0),
            ("bottom_length", bottom_length, 0.0),
        )
    )
    measured = measured or length
    if code in (None, 2):
        return f.copy()
    if code == 1:
        return f - axial_load * d / measured
    if code == 3:
        whole = length + top + bottom
        return f - axial_load * np.sin(np.arctan(d * (length + top) / measured / whole))
    if code == 4:
        if not top > 0:
            raise InputError(
                f"top_length = {top_length}: P-Delta code 4 needs the length from the top of the "
                "column to the hinge of the axial ram"
            )
        return f + axial_load * d / top
    known = ", ".join(f"{key} ({text})" for key, text in PDELTA_CODES.items())
    raise InputError(f"P-Delta code {code!r} is not known; there are {known}, and None")


def measured_test(
    name: str,
    displacement: Array,
    force: Array,
    code: int | None,
    who: str,
    **levers: Any,
) -> MeasuredTest:
    """Return the test of two columns of a file and `net_force`'s levers; `who` begins messages."""
    try:
        axial_load = _arguments.number(levers["axial_load"], "axial_load")
        net = net_force(displacement, force, code=code, **levers)
    except InputError as error:
        raise InputError(f"{who}: {error}") from error
    top, length = displacement.copy(), levers["length"]
    if not math.isnan(length):
        # As in the manual's rules for P-Delta: the column stays straight above its hinge.
        top = displacement * (length / (levers["measured_length"] or length))
    above = 0.0 if code == 4 else levers["top_length"] or 0.0
    columns = top, net, displacement, force
    return MeasuredTest(name, *columns, length, axial_load, code, length + above)


@dataclass(frozen=True, repr=False)
class PeerTest(Tabular):
    """A measured force-displacement history, or the points at which its displacement turns back.

    Attributes
    ----------
    name : str
        Name of the test, from the first line of a PEER file; the file's name for a csv.
    displacement : ndarray, shape (m,)
        Displacement of the top of the equivalent cantilever [m].
    force : ndarray, shape (m,)
        Force column of the file [N]; the P-Delta code of the test says what it means.
    source : str
        Note on the source with the reports to cite, of reversal points that come with rbsdem.
    """

    _columns = ("displacement m", "force N")

    name: str
    displacement: Array
    force: Array
    source: str = ""


def read_peer(path: str | os.PathLike[str], *, units: tuple[str, str] | None = None) -> PeerTest:
    """Read a history: the PEER text format (millimetres, kilonewtons), or a csv with a header.

    Parameters
    ----------
    path : path-like
        File with columns displacement [mm] and force [kN]; a csv may name other units, such as
        `displacement_m,force_N`.
    units : pair of str, optional
        Units of displacement and force in the file, as ``("mm", "kN")``: "m", "mm", "cm", "in" and
        "N", "kN", "MN", "kip". The default is what the file says, else millimetres and kilonewtons
        for the PEER format and SI for a csv.

    Returns
    -------
    PeerTest
        In SI units, every row of the file in its order.

    Raises
    ------
    InputError
        If the file cannot be read; the message names file, line and remedy.
    """
    pair = ["", ""] if units is None else _arguments.several(units, "units", "two units")
    if len(pair) != 2:
        raise InputError(
            f'units = {_arguments.shown(units)} must be those of displacement and force, as ("mm", '
            '"kN")'
        )
    words = [_core.word(_arguments.text(unit, "units")) for unit in pair]
    name, _, (displacement, force), *_ = _core.evaluate(
        "read_history", "\n".join([*words, _arguments.file(path)])
    )
    return PeerTest(name, displacement.copy(), force.copy())


FOLDER_VARIABLE = "RBSDEM_PEER_DIR"
"""Environment variable with the folder of the histories."""

HISTORY_FILES = {
    "soesianawati_1": ("Soesianawati_et_al_1986_No1.csv", "soes86u1.txt"),
    "tanaka_park_1": ("Tanaka_and_Park_1990_No1.csv", "tana90u1.txt"),
    "tanaka_park_5": ("Tanaka_and_Park_1990_No5.csv", "tana90u5.txt"),
    "zahn_7": ("Zahn_et_al_1986_No7.csv", "zahn86u7.txt"),
}
"""File names of the history of each column: a csv, and the database's own text file."""


def find_history(
    key: str | os.PathLike[str], folder: str | os.PathLike[str] | None = None
) -> Path | None:
    """Find the full measured history of a column.

    Parameters
    ----------
    key : str or path-like
        Key of a column (soesianawati_1, tanaka_park_1, tanaka_park_5, zahn_7) or a file name.
    folder : path-like, optional
        Folder to search; by default that of the environment variable RBSDEM_PEER_DIR.

    Returns
    -------
    Path or None
        The file, in the folder or in its subfolder `raw`; None if it is not there or if no folder
        is named.

    Raises
    ------
    InputError
        If the folder that was named does not exist.
    """
    where, said_by = folder, "folder"
    if where is None:
        where, said_by = os.environ.get(FOLDER_VARIABLE) or None, FOLDER_VARIABLE
    if where is None:
        return None
    root = Path(where).expanduser()
    if not root.is_dir():
        raise InputError(
            f"{said_by} = {where} is not a folder; name the folder of the PEER histories"
        )
    for name in HISTORY_FILES.get(str(key), (key,)):
        for path in (root / name, root / "raw" / name):
            if path.is_file():
                return path
    return None


def shipped_reversals(key: str) -> PeerTest:
    """Read the reversal points of a test that come with rbsdem.

    Parameters
    ----------
    key : str
        soesianawati_1, tanaka_park_1, tanaka_park_5 or zahn_7.

    Returns
    -------
    PeerTest
        About 20 points in the order of the test, the first and the last among them: displacement of
        the top of the equivalent cantilever, net horizontal force. The largest force of a test lies
        between them.

    Raises
    ------
    InputError
        If there is no such key.
    """
    if key not in HISTORY_FILES:
        raise InputError(f"no reversal points for {key!r}; there are {', '.join(HISTORY_FILES)}")
    name = f"reversals_{key}.csv"
    rows, notes = _package.rows(name), _package.notes(name)
    displacement = np.array([float(row["displacement_mm"]) for row in rows]) / 1000
    force = np.array([float(row["force_kN"]) for row in rows]) * 1000
    return PeerTest(notes[0].partition(":")[0], displacement, force, "\n".join(notes))


def measured_loops() -> dict[str, Loop]:
    """Read key values of the full histories of the four tests.

    Returns
    -------
    dict of str to rbsdem.curves.Loop
        Peak force, displacement at it, largest displacement, energy and stiffness of each
        test, SI units, in the definitions of `rbsdem.curves`.
    """
    return {
        row["key"]: Loop(
            peak_force=float(row["peak_force_kN"]) * 1000,
            displacement_at_peak=float(row["displacement_at_peak_mm"]) / 1000,
            peak_displacement=float(row["peak_displacement_mm"]) / 1000,
            energy=float(row["energy_kJ"]) * 1000,
            stiffness=float(row["stiffness_kN_per_mm"]) * 1e6,
        )
        for row in _package.rows("measured_loops.csv")
    }


#: Drifts are parts of the length.
_DRIFT = "%"
_UNITS = {"displacement": {**LENGTHS, _DRIFT: 0.01}, "force": FORCES}
_QUANTITIES = ("displacement", "force")

#: No names of what is looked for: the force is that along the displacement.
_NOT = {"displacement": ("time",), "force": ("time", "axial", "normal")}

#: A line above the rows that states units.
_UNIT_LINE = re.compile(r"\W*(?:unit|unidad|einheit|birim)\w*\s*:", re.IGNORECASE)

# Plausible sizes of the largest values of a test of a column.
_PLAUSIBLE = {"displacement": (5e-4, 1.5, "m"), "force": (500.0, 5e7, "N")}
_LENGTHS, _SMALLEST_LOAD = (0.1, 30.0), 3000.0
_LARGEST_DRIFT, _SMALLEST_DRIFT = 0.4, 5e-4

# A first row beyond this part of the largest value is an offset; a smaller area is none.
_OFFSET = 0.05
_AREA = 0.02


def read_test(
    path: str | os.PathLike[str] | None = None,
    *,
    displacement: str | os.PathLike[str] | None = None,
    force: str | os.PathLike[str] | None = None,
    structure: Literal["column", "frame"] = "column",
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
    stated. The result goes where a test of the database goes: `rbsdem.compare`,
    `rbsdem.calibrate`, `rbsdem.plot.loop`, and `cyclic(column, displacement=test.displacement)`.

    Parameters
    ----------
    path : path-like
        File with a row of numbers a line, or its text. Above them there may be any lines; the last
        may have the names of the columns, or their names and below them their units. Columns of
        texts, dates or clocks are left out.
    displacement, force : path-like, optional
        Two files in place of one, each with one value a line or all values in a line.
    structure : {"column", "frame"}, optional
        The structure that was tested. The force of a frame is the sum of its actuators; it has no
        `pdelta_code`, and `length` is the height at which the displacement was measured.
    columns : pair or mapping, optional
        Columns of displacement and force, by name or by number from 1: ``("LVDT 3", 5)`` or
        ``{"displacement": "LVDT 3", "force": 5}``. By default they are found by their names, or are
        the two columns of a file that has no more.
    units : pair or mapping, optional
        Their units: "m", "mm", "cm", "in", or "%" for drifts, which need `length`; and "N", "kN",
        "MN", "kip", "klb", "lbf", "kgf", or the weight of 1000 kg, "tf", "tonf", "t", "ton". By
        default those that the file gives in the names (``d_mm``, ``Force [kN]``)
        or below them.
    pdelta_code : {1, 2, 3, 4}
        Meaning of the force column; every test of a column needs it, since P-Delta is in some
        forces and not in others:

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
        Separator of two values: ",", ";", a tab or a blank; and before decimals: "." or ",".
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

    Warns
    -----
    RepairWarning
        If columns of texts are left out.

    See Also
    --------
    read_peer : for files in the format of the database.
    rbsdem.peer.net_force : the formulas of the codes.

    Notes
    -----
    The area ½∮(F dd - d dF) of a loop is the energy that the column takes up and is positive. If
    columns are exchanged it is negative; if the sign of one column is wrong, so is that of the
    correlation of the two.
    """
    lengths: Any = {
        "axial_load": axial_load,
        "length": length,
        "measured_length": measured_length,
        "top_length": top_length,
        "bottom_length": bottom_length,
    }
    for key, value in lengths.items():
        if value is not None:
            _arguments.number(value, key, **({"above": 0, "unit": "m"} if key == "length" else {}))
    _check_words(structure, force_sign, zero, checks, name)
    if structure == "frame":
        if pdelta_code is not None:
            raise InputError(
                f"pdelta_code = {_arguments.shown(pdelta_code)} is a notion of tests of columns; "
                "the force of a frame is the sum of its actuators, so leave it out"
            )
        code = None
    else:
        code = _code(pdelta_code, length, axial_load)
    layout: dict[str, Any] = {"separator": separator, "decimal": decimal, "header": header}
    if path is None or displacement is not None or force is not None:
        table = _two_files(path, displacement, force, layout)
    else:
        table = read_table(path, **layout)
    where = table.source
    chosen = _columns(columns, table)
    given = _units(units, chosen, table)
    d, f = (
        to_si(table.values[:, i], _UNITS[quantity][unit])
        for i, quantity, unit in zip(chosen, _QUANTITIES, given, strict=True)
    )
    if given[0] == _DRIFT:
        if length is None:
            raise InputError(f"{where}: drifts in per cent need length, the height they relate to")
        d = d * length
    f = force_sign * f
    if zero:
        d, f = d - d[0], f - f[0]
    if checks:
        _check_stated(given, table)
        _check_units(length, axial_load)
        _check_sizes(d, f, given, length, where, structure)
        _check_offset(d, f, zero, where)
        _check_order(d, f, where)
    for key in ("length", "axial_load"):
        lengths[key] = math.nan if lengths[key] is None else lengths[key]
    name = name or Path(table.source.split(" and ")[0]).stem
    return measured_test(name, d, f, code, where, **lengths)


def _check_words(
    structure: object, force_sign: object, zero: object, checks: object, name: object
) -> None:
    """Refuse arguments that are not of the kind that they have to be."""
    _arguments.choice(structure, "structure", ("column", "frame"))
    if _arguments.integer(force_sign, "force_sign") not in (1, -1):
        raise InputError(f"force_sign = {_arguments.shown(force_sign)} must be 1 or -1")
    if zero is not None:
        _arguments.boolean(zero, "zero")
    _arguments.boolean(checks, "checks")
    if name is not None:
        _arguments.text(name, "name")


def _code(code: int | None, length: float | None, axial_load: float | None) -> int:
    """Return the P-Delta code, if it is one and what it needs is there."""
    if isinstance(code, bool) or not isinstance(code, int) or code not in PDELTA_CODES:
        missing = "is needed" if code is None else f"= {_arguments.shown(code)} is not known"
        codes = "; ".join(f"{key}: {text}" for key, text in PDELTA_CODES.items())
        raise InputError(f"pdelta_code {missing}. It says what the force column is: {codes}")
    for value, needed, what in (
        (length, (1, 3), "length (from the base to the lateral force, m)"),
        (axial_load, (1, 3, 4), "axial_load (N)"),
    ):
        if value is None and code in needed:
            raise InputError(f"pdelta_code = {code} ({PDELTA_CODES[code]}) needs {what}")
    return code


def _pair(pair: object, what: str, examples: str) -> tuple[object, object]:
    """Return the two values for displacement and force."""
    if isinstance(pair, Mapping):
        strange = [key for key in pair if key not in _QUANTITIES]
        if strange:
            raise InputError(f"{what}: {strange[0]!r} is neither 'displacement' nor 'force'")
        return pair.get("displacement"), pair.get("force")
    if isinstance(pair, Sequence) and not isinstance(pair, str) and len(pair) == 2:
        return pair[0], pair[1]
    raise InputError(f"{what} = {pair!r} must be two, for displacement and force: {examples}")


def _columns(given: object, table: NumberTable) -> tuple[int, int]:
    """Return the places of the columns of displacement and force."""
    pair: tuple[object, object] = (None, None)
    if given is not None:
        pair = _pair(given, "columns", 'columns=("LVDT 3", "load") or columns=(1, 2)')
    places = [
        table.find(quantity, _NOT[quantity])
        if value is None
        else table.index_of(value, f"columns: {quantity}")
        for value, quantity in zip(pair, _QUANTITIES, strict=True)
    ]
    numbers = [i for i in range(table.columns) if i not in table.texts]
    if len(numbers) == 2 and table.find("time") is None:
        # If one of two columns is known, the other column is the other quantity.
        for i, other in ((0, 1), (1, 0)):
            if places[i] is None:
                rest = [place for place in numbers if place != places[other]]
                places[i] = rest[0] if i == 0 or len(rest) == 1 else rest[1]
    for place, quantity in zip(places, _QUANTITIES, strict=True):
        if place is None:
            raise InputError(
                f"{table.source}: which column is the {quantity}? There are {table.describe()}; "
                "say columns=(displacement, force), by name or by number from 1"
            )
    displacement, force = (place or 0 for place in places)
    if displacement == force:
        raise InputError(
            f"columns: displacement and force are both column {force + 1} of {table.source}"
        )
    return displacement, force


def _two_files(
    path: object, displacement: object, force: object, layout: dict[str, Any]
) -> NumberTable:
    """Return the table of two files with one column, or one row, each."""
    if path is not None or displacement is None or force is None:
        raise InputError("read_test: give path, or both displacement= and force=, each of a file")
    values, names, units, sources = [], [], [], []
    for source, quantity in ((displacement, "displacement"), (force, "force")):
        table = read_table(source, least=1, **layout)  # type: ignore[arg-type]
        numbers = [i for i in range(table.columns) if i not in table.texts]
        if len(numbers) > 1 and len(table.values) > 1:
            raise InputError(
                f"{table.source}: has {table.describe()}; the file of the {quantity} has one value "
                "a line, or all in a line; for a table give path and columns"
            )
        values.append(table.values[:, numbers].ravel())
        names.append(quantity)
        units.append(table.units[numbers[0]])
        sources.append(table.source)
    where = " and ".join(dict.fromkeys(sources))
    if len(values[0]) != len(values[1]):
        raise InputError(
            f"{where}: have {len(values[0])} displacements and {len(values[1])} forces; give as "
            "many of both"
        )
    return NumberTable(where, tuple(names), tuple(units), np.column_stack(values))


def _units(given: object, chosen: tuple[int, int], table: NumberTable) -> tuple[str, str]:
    """Return the units of displacement and force."""
    pair: tuple[object, object] = (None, None)
    if given is not None:
        pair = _pair(given, "units", 'units=("mm", "kN")')
    units = []
    for value, place, quantity in zip(pair, chosen, _QUANTITIES, strict=True):
        unit = table.units[place] if value is None else str(value)
        known = {name.lower(): name for name in _UNITS[quantity]}
        if unit.lower() not in known:
            has = f"has the unit {unit!r}" if unit else "has no unit"
            raise InputError(
                f"{table.source}: the {quantity}, column {table.names[place] or place + 1!r}, "
                f"{has}; say units=(displacement, force), the {quantity} in "
                f"{', '.join(known.values())}"
            )
        units.append(known[unit.lower()])
    return units[0], units[1]


def _check_stated(units: tuple[str, str], table: NumberTable) -> None:
    """Refuse units beside others that a line above states, and tons that may be of two kinds."""
    for line in table.head:
        words = {word.lower() for word in re.findall(r"\w+", line.partition(":")[2])}
        for unit, quantity in zip(units, _QUANTITIES, strict=True):
            known = _UNITS[quantity]
            stated = {known[name] for name in known if name.lower() in words}
            if _UNIT_LINE.match(line) and stated and known[unit] not in stated:
                raise InputError(
                    f"{table.source}: {line.strip()[:60]!r} is above the rows, and the {quantity} "
                    f"is read in {unit}; correct units=, or say checks=False"
                )
    if units[0].startswith("in") and units[1] in ("t", "ton", "tonf"):
        raise InputError(
            f"{table.source}: {units[1]!r} beside inches may be 2000 lbf or the weight of 1000 kg; "
            "say units=('in', 'tf') for the second, or give force in kip, or say checks=False"
        )


def _check_units(length: float | None, axial_load: float | None) -> None:
    """Refuse a length or an axial load that is likely in mm or kN."""
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
    d: Array, f: Array, units: tuple[str, str], length: float | None, where: str, structure: str
) -> None:
    """Refuse displacements [m] and forces [N] whose largest values no test has."""
    for values, unit, quantity in zip((d, f), units, _QUANTITIES, strict=True):
        largest = float(np.max(np.abs(values)))
        low, high, si = _PLAUSIBLE[quantity]
        if length is not None and quantity == "displacement":
            low, high = _SMALLEST_DRIFT * length, _LARGEST_DRIFT * length
        if not low <= largest <= high:
            raise InputError(
                f"{where}: the largest {quantity} is {largest:.4g} {si}, read in {unit}; a test of "
                f"a {structure} has {low:.3g} to {high:.3g} {si}. Check units=({units[0]!r}, "
                f"{units[1]!r}), columns and length, or say checks=False"
            )


def _check_offset(d: Array, f: Array, zero: bool | None, where: str) -> None:
    """Refuse a first row far from zero unless the user has said what it means (`zero`)."""
    if zero is not None:
        return
    for values, quantity, si in ((d, "displacement", "m"), (f, "force", "N")):
        share = abs(values[0]) / float(np.max(np.abs(values)))
        if share > _OFFSET:
            raise InputError(
                f"{where}: the first {quantity} is {values[0]:.4g} {si}, {100 * share:.0f} % of "
                "the largest; say zero=True to take the first row off all others, zero=False if "
                "the test does begin there, or header= if that line is no row of the test"
            )


def _check_order(d: Array, f: Array, where: str) -> None:
    """Refuse a force of the wrong sign, and columns that are exchanged."""
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
