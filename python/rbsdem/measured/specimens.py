"""The table of the tests, `specimens.csv` of a folder of histories, and the sections it draws.

What the table does not report is filled in by rules, each named in `DrawnSpecimen.assumed`:

- bars of a face stand at equal distances between the corner bars; if the faces do not add up to the
  number of bars, the areas of the intermediate bars make up for it (bundled bars);
- bars of a round section stand at equal angles, one on the axis of loading; an odd number stands
  half as drawn and half mirrored, so that both directions of loading are equal;
- an octagon is taken as the circle of its depth (5 % less concrete, the same core);
- ultimate stress not reported: 1.5 times the yield stress (the table has none for spirals);
- yield stress not reported: 420 MPa (Grade 60) of longitudinal bars, theirs for transverse bars;
- cover not reported: 0.05 times the depth; across the loading: that along it;
- transverse bars without diameter or spacing: there are none.
"""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields
from difflib import get_close_matches
from functools import cache, partial
from pathlib import Path, PurePath
from typing import Any, Literal, TypeAlias, get_args, overload

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import DataFrame
from rbsdem.errors import InputError, warn
from rbsdem.measured.tests import MeasuredTest, PeerTest, measured_test, read_peer
from rbsdem.model.column import Column
from rbsdem.model.materials import CONCRETE_DENSITY, Concrete, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection, Section
from rbsdem.section.columns import DEFAULT, MODELS, Model
from rbsdem.section.columns import column as column_of
from rbsdem.section.layered import LayeredColumn

# Spellings of one author.
_AUTHORS = {"Petrovsky": "Petrovski"}


# Texts that mean "not reported". So does a zero where zero has no meaning.
_NOT_REPORTED = ("", "-", "--", "n/a", "na", "nan", "none", "not reported")


@dataclass(frozen=True, slots=True)
class _Column:
    """Where an attribute comes from: its column in the table, and how a text becomes a value.

    Numbers are multiplied by the factor to SI, or divided by it; a zero means "not reported" unless
    `zero`; `needed` ones must be reported.
    """

    column: str
    kind: type = float
    factor: float = 1.0
    divide: bool = False
    zero: bool = False
    needed: bool = False

    def value(self, text: str) -> Any:
        """Return the value in SI, or None if it was not reported."""
        text = text.strip()
        if text.lower() in _NOT_REPORTED:
            return None
        if self.kind is str:
            return text
        number = float(text.replace(",", ""))
        if not math.isfinite(number):
            raise ValueError
        if number == 0 and not self.zero:
            return None
        if self.kind is int:
            if number != round(number):
                raise ValueError
            return round(number)
        # Dividing by a whole number keeps 400 mm the same number as 0.4 m.
        return number / self.factor if self.divide else number * self.factor


def _from(column: str, kind: type = float, *, needed: bool = False, **how: Any) -> Any:
    """Return a field that comes from a column of the table; None where it is not needed."""
    source = {"column": _Column(column, kind, needed=needed, **how)}
    return field(metadata=source) if needed else field(default=None, metadata=source)


_mm = partial(_from, factor=1000, divide=True)
_kilo = partial(_from, factor=1000)
_mega = partial(_from, factor=1000**2)
_count = partial(_from, kind=int)
_text = partial(_from, kind=str)


@dataclass(frozen=True, slots=True)
class Observed:
    """Measured values, as far as the table reports them; no prediction may use them.

    Attributes
    ----------
    points : int or None
        Rows of the history.
    largest_force, smallest_force : float or None
        Of the force column [N].
    largest_displacement, smallest_displacement : float or None
        Of the history [m].
    reversals, cycles : int or None
        Turning points by 2 % of the largest displacement; half of them.
    stiffness_25, stiffness_50, stiffness_75 : float or None
        Secant stiffness at 25, 50, 75 % of the largest force [N/m].
    published_shear : float or None
        Largest shear as published [N].
    published_moment : float or None
        Largest base moment as published [N m].
    published_yield_displacement : float or None
        Calculated in the publication, not measured [m].
    published_label : str or None
        Name of the test there.
    """

    points: int | None = _count("n_points")
    largest_force: float | None = _kilo("F_max_kN", zero=True)
    smallest_force: float | None = _kilo("F_min_kN", zero=True)
    largest_displacement: float | None = _mm("d_max_mm", zero=True)
    smallest_displacement: float | None = _mm("d_min_mm", zero=True)
    reversals: int | None = _count("reversals", zero=True)
    cycles: int | None = _count("cycles", zero=True)
    stiffness_25: float | None = _mega("K_sec25_kN_mm")
    stiffness_50: float | None = _mega("K_sec50_kN_mm")
    stiffness_75: float | None = _mega("K_sec75_kN_mm")
    published_shear: float | None = _kilo("manual_Vmax_kN")
    published_moment: float | None = _kilo("manual_Mmax_kNm")
    published_yield_displacement: float | None = _mm("manual_dy_mm")
    published_label: str | None = _text("manual_label")


@dataclass(frozen=True, slots=True)
class Specimen:
    """A tested column: its properties before the test, and where its history is.

    Values that were not reported are None. Steel, bars and lengths follow the notation of the
    database.

    Attributes
    ----------
    name : str
        Name of the test.
    section : str
        "rectangular", "circular", "octagonal" or "square(spiral table)" (square, with a spiral).
    length : float
        Of the equivalent cantilever [m].
    width, depth : float
        Of the section, depth in the direction of loading [m]; both the diameter if it is round.
    concrete_strength : float
        Cylinder strength [Pa].
    axial_load : float
        Compression positive, tension negative [N].
    longitudinal_number : int
        Number of longitudinal bars.
    peer_id : int or None
        Number in the database.
    file : str or None
        File of the history; None if the folder has none for this test.
    folder : Path or None
        Folder of the table.
    author, year : str or None
        Of the report; the year is that in the name if there is no other.
    config : str or None
        C cantilever, DC double curvature, DE double ended, CFB flexible base, HH hammer head.
    measured_length : float or None
        Height at which the displacement was measured [m].
    cover : float or None
        Along the direction of loading: clear to the outer edge of the hoops of a rectangular
        section, to the centre of a spiral [m].
    cover_perpendicular : float or None
        The same across the direction of loading [m].
    cover_definition : str or None
        As in the table.
    corner_diameter, intermediate_diameter : float or None
        Of longitudinal bars [m].
    intermediate_perpendicular, intermediate_parallel : int or None
        Bars between the corner bars, per face, of the faces across and along the loading.
    corner_yield_stress, intermediate_yield_stress : float or None
        Of longitudinal bars [Pa].
    longitudinal_ultimate_stress : float or None
        Of longitudinal bars [Pa].
    transverse_yield_stress, transverse_ultimate_stress : float or None
        Of hoops or spiral [Pa].
    transverse_diameter : float or None
        Of a hoop or spiral bar [m].
    transverse_spacing : float or None
        Of hoops, or pitch of the spiral, where they are close [m].
    shear_legs : float or None
        Hoop bars that cross the section in the direction of loading; diagonal ones count in part.
    confinement : str or None
        Type of the hoops, such as "RI: Rectangular and interlocking ties".
    failure_mode : str or None
        "Flexure", "Flexure-Shear" or "Shear".
    pdelta_code : int or None
        1 to 4, what the force column means; None if the report does not give it.
    top_length, bottom_length : float or None
        From the ends of the column to the hinges of the axial ram [m].
    beam_length, splice_length : float or None
        Of the beam of a flexible base, of the lap splice of the bars [m].
    notes : str
        Remarks of the table.
    duplicate_of : int or None
        Number of the test whose history is repeated here, which is an error of the database.
    observed : Observed
        Measured values.
    """

    name: str = _text("name", needed=True)
    section: str = _text("section", needed=True)
    length: float = _mm("L_mm", needed=True)
    width: float = _mm("b_mm", needed=True)
    depth: float = _mm("h_mm", needed=True)
    concrete_strength: float = _mega("fc_MPa", needed=True)
    axial_load: float = _kilo("axial_kN", zero=True, needed=True)
    longitudinal_number: int = _count("n_long", needed=True)
    peer_id: int | None = _count("peer_id")
    file: str | None = _text("file")
    folder: Path | None = None
    author: str | None = _text("author")
    year: str | None = _text("year")
    config: str | None = _text("config")
    measured_length: float | None = _mm("Lmeas_mm")
    cover: float | None = _mm("cover_mm")
    cover_perpendicular: float | None = _mm("cover_perp_mm")
    cover_definition: str | None = _text("cover_definition")
    corner_diameter: float | None = _mm("db_corner_mm")
    intermediate_diameter: float | None = _mm("db_interm_mm")
    intermediate_perpendicular: int | None = _count("n_interm_perp", zero=True)
    intermediate_parallel: int | None = _count("n_interm_par", zero=True)
    corner_yield_stress: float | None = _mega("fy_long_MPa")
    intermediate_yield_stress: float | None = _mega("fy_interm_MPa")
    longitudinal_ultimate_stress: float | None = _mega("fu_long_MPa")
    transverse_yield_stress: float | None = _mega("fy_trans_MPa")
    transverse_ultimate_stress: float | None = _mega("fu_trans_MPa")
    transverse_diameter: float | None = _mm("db_trans_mm")
    transverse_spacing: float | None = _mm("s_trans_mm")
    shear_legs: float | None = _from("legs_Nv")
    confinement: str | None = _text("confinement")
    failure_mode: str | None = _text("failure_mode")
    pdelta_code: int | None = _count("pdelta_code")
    top_length: float | None = _mm("Ltop_mm", zero=True)
    bottom_length: float | None = _mm("Lbottom_mm", zero=True)
    beam_length: float | None = _mm("Lbeam_mm")
    splice_length: float | None = _mm("Lsplice_mm")
    notes: str = field(default="", metadata={"column": _Column("notes", str)})
    duplicate_of: int | None = None
    observed: Observed = Observed()

    @property
    def gross_area(self) -> float:
        """Area of the concrete section [m2]."""
        if self.section == "circular":
            return math.pi / 4 * self.depth**2
        if self.section == "octagonal":
            return 2 * (math.sqrt(2) - 1) * self.depth**2
        return self.width * self.depth

    @property
    def axial_load_ratio(self) -> float:
        """Axial load over gross area times concrete strength."""
        return self.axial_load / (self.gross_area * self.concrete_strength)

    @property
    def axial_height(self) -> float:
        """Height at which the axial load acts [m].

        The length and `top_length`; the length alone with P-Delta code 4, whose net force has the
        horizontal part of the load in it (Berry, Parrish and Eberhard 2004, 3.3).
        """
        return self.length + (0.0 if self.pdelta_code == 4 else self.top_length or 0.0)

    @property
    def second_order_load(self) -> float:
        """Load at the top that has the second-order moment of the axial load at its height [N].

        P (L + L_top)/L. The sections carry P.
        """
        return self.axial_load * (self.axial_height / self.length)

    @property
    def span_depth_ratio(self) -> float:
        """Length over depth."""
        return self.length / self.depth

    @property
    def mass(self) -> float:
        """Mass from the gross volume and `rbsdem.section.columns.CONCRETE_DENSITY` [kg]."""
        return self.gross_area * self.length * CONCRETE_DENSITY

    @property
    def series(self) -> str:
        """First author and year: tests that one laboratory made together.

        Split tests by this key when a relation is fitted to some and tried on others.
        """
        author = self.author or self.name
        first = re.split(r"\s+et\s+al\b|\s+and\s+|,|&", author.strip())[0].strip()
        first = _AUTHORS.get(first, first)
        # A name in place of the author has the year in it.
        return f"{first} {self.year}" if self.year and self.year not in first else first

    @property
    def kind(self) -> str:
        """Form of the section and failure mode, such as "rectangular, Flexure".

        Octagons and spirals in a square count as round.
        """
        form = "rectangular" if self.section == "rectangular" else "round"
        return f"{form}, {self.failure_mode or 'not known'}"

    def is_called(self, key: str) -> bool:
        """Whether a text is its file (with or without ending), name or number in the database.

        Parameters
        ----------
        key : str
            The text.
        """
        files = (self.file, Path(self.file).stem) if self.file else ()
        return key.strip() in {self.name, str(self.peer_id), *files} - {""}

    @property
    def path(self) -> Path | None:
        """File of the history, a csv or the database's own text; None if it is not there.

        It lies in the folder of the table or below.
        """
        if self.file is None or self.folder is None or not _stays_below(self.file):
            return None
        name = self.folder / self.file
        raw = self.folder / "raw" / name.name
        for path in (name, name.with_suffix(".txt"), raw, raw.with_suffix(".txt")):
            try:
                if path.is_file():
                    return path
            except OSError:  # such as a name that is too long
                continue
        return None

    def history(self) -> PeerTest:
        """Read the history as it is in its file.

        Returns
        -------
        PeerTest
            Displacement [m] and force column [N].

        Raises
        ------
        InputError
            If there is no file, or if it cannot be read.
        """
        path = self.path
        if path is None:
            where = self.folder or "a folder"
            named = f"{self.file} is not in {where}" if self.file else "the table names no file"
            if self.file and not _stays_below(self.file):
                named = f"file = {self.file!r} is no file below the folder of the table"
            raise InputError(f"{self.name}: no history, {named}; put its csv or txt there")
        return read_peer(path)

    def test(self) -> MeasuredTest:
        """Read the history and find the net horizontal force.

        Returns
        -------
        MeasuredTest
            Displacement of the top [m], net horizontal force [N], and the columns of the file.

        Raises
        ------
        InputError
            If there is no file, if it cannot be read, or if a length that its P-Delta code needs is
            not known.
        """
        read, levers = self.history(), ("measured_length", "top_length", "bottom_length")
        given = {name: getattr(self, name) for name in ("length", "axial_load", *levers)}
        columns = read.displacement, read.force
        return measured_test(self.name, *columns, self.pdelta_code, self.name, **given)


def _stays_below(file: str) -> bool:
    """Whether the path of a table leads to a file in its folder or below."""
    path = PurePath(file)
    return bool(path.name) and not path.anchor and ".." not in path.parts and "\0" not in file


TABLE = "specimens.csv"
"""Name of the table in its folder."""


class Specimens(Tabular, Sequence[Specimen]):
    """Tested columns in the order of their table.

    A sequence of `Specimen`: ``table[0]``, ``for specimen in table``, ``table[:5]``. A text finds
    one by its file (with or without ending), its name or its number in the database:
    ``table["Zahn_et_al_1986_No7"]``, ``table["11"]``.

    Parameters
    ----------
    rows : iterable of Specimen
        The tests.
    """

    __slots__ = ("_rows",)

    def __init__(self, rows: Iterable[Specimen]) -> None:
        self._rows = tuple(rows)

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Specimen]:
        return iter(self._rows)

    @overload
    def __getitem__(self, key: int | str) -> Specimen: ...
    @overload
    def __getitem__(self, key: slice) -> Specimens: ...
    def __getitem__(self, key: int | str | slice) -> Specimen | Specimens:
        if isinstance(key, slice):
            return Specimens(self._rows[key])
        if isinstance(key, (str, os.PathLike)):
            return self._named(os.fspath(key))
        return self._rows[key]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Specimens) and self._rows == other._rows

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"<Specimens: {len(self)} tests, {len(self.with_history())} with a history>"

    def where(self, **conditions: Any) -> Specimens:
        """Keep the tests that meet all conditions.

        Parameters
        ----------
        **conditions
            Attributes of `Specimen` with what they must be: a value, a list, tuple or set of
            values, or a function that returns whether a value is wanted.

        Returns
        -------
        Specimens
            In the same order.

        Raises
        ------
        InputError
            If there is no such attribute; the message names the nearest ones.

        Examples
        --------
        >>> table = Specimens([])
        >>> len(table.where(section="rectangular", failure_mode=("Flexure", "Shear")))
        0
        """
        known = [name for name in dir(Specimen) if not name.startswith("_")]
        for name in conditions:
            if name not in known:
                raise InputError(f"specimens have no {name!r}; {_nearest(name, known)}")
        tests = [(name, _condition(wanted)) for name, wanted in conditions.items()]
        return Specimens(
            row for row in self._rows if all(meets(getattr(row, name)) for name, meets in tests)
        )

    def with_history(self) -> Specimens:
        """Keep the tests whose histories are in the folder."""
        return Specimens(row for row in self._rows if row.path is not None)

    def series(self) -> dict[str, Specimens]:
        """Split the tests by `Specimen.series`, in the order of the table."""
        parts: dict[str, list[Specimen]] = {}
        for row in self._rows:
            parts.setdefault(row.series, []).append(row)
        return {key: Specimens(rows) for key, rows in parts.items()}

    def to_pandas(self) -> DataFrame:
        """Return a row for each test."""
        rows = [asdict(row) for row in self._rows]
        return data_frame([{**row, **row.pop("observed")} for row in rows])

    def _named(self, key: str) -> Specimen:
        """Return the first specimen that is called so, or raise `InputError`."""
        for row in self._rows:
            if row.is_called(key):
                return row
        names = [row.name for row in self._rows] + [row.file for row in self._rows if row.file]
        raise InputError(f"no specimen {key!r} in the table; {_nearest(key, names)}")


def read_specimens(path: str | os.PathLike[str]) -> Specimens:
    """Read the table of the tests.

    Parameters
    ----------
    path : path-like
        The folder with `specimens.csv` and the histories, or the table itself. Columns may be
        fewer or more, and in any order.

    Returns
    -------
    Specimens
        Every row of the table, SI units. Blank, "-" and, where it has no meaning, 0 stand for "not
        reported" and become None; "1,600" is a number.

    Raises
    ------
    InputError
        If the table cannot be read: the message names line, column and remedy.

    Notes
    -----
    Columns and units: `docs/peer.md`. The properties come from the PEER Structural Performance
    Database (Berry, Parrish and Eberhard 2004), which does not come with rbsdem.
    """
    given = _arguments.path(path)
    table = Path(_arguments.file(given / TABLE if given.is_dir() else given))
    try:
        with table.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.DictReader(file, skipinitialspace=True)
            names = [name.strip() for name in reader.fieldnames or ()]
            reader.fieldnames = names
            needed = [column.column for _, column in _columns(Specimen) if column.needed]
            missing = [name for name in needed if name not in names]
            if missing:
                raise InputError(f"{table}: no column {', '.join(missing)}; add it to the header")
            rows = [_specimen(row, f"{table}: line {reader.line_num}", table) for row in reader]
    except OSError as error:
        raise InputError(
            f"{table}: {error.strerror or error}; name the folder with {TABLE}, or the table"
        ) from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise InputError(f"{table}: {error}; save it as csv in UTF-8") from error
    return Specimens(rows)


def _specimen(row: dict[str, str | None], where: str, table: Path) -> Specimen:
    """Return the specimen of a row of the table."""
    values = _values(row, Specimen, where)
    notes = values.pop("notes", None) or ""
    again = re.search(r"identical to PEER id (\d+)", notes)
    year = values.pop("year", None)
    if year is None:
        told = re.search(r"\b(?:19|20)\d\d\b", values["name"])
        year = told[0] if told else None
    return Specimen(
        **values,
        year=year,
        notes=notes,
        duplicate_of=int(again[1]) if again else None,
        folder=table.parent,
        observed=Observed(**_values(row, Observed, where)),
    )


@cache
def _columns(record: type) -> list[tuple[str, _Column]]:
    """Return the attributes of a record that come from the table, with their columns."""
    return [(f.name, f.metadata["column"]) for f in fields(record) if "column" in f.metadata]


def _values(row: dict[str, str | None], record: type, where: str) -> dict[str, Any]:
    """Return the attributes that the row has columns for."""
    found = {}
    for name, column in _columns(record):
        text = row.get(column.column)
        try:
            value = column.value(text or "")
        except ValueError:
            kind = "a whole number" if column.kind is int else "a number"
            raise InputError(
                f"{where}: {column.column} = {text!r} must be {kind}, or blank"
            ) from None
        if value is None and column.needed:
            raise InputError(f"{where}: {column.column} = {text!r} is not reported; it is needed")
        found[name] = value
    return found


def _condition(wanted: Any) -> Callable[[Any], bool]:
    """Return the test of a value: a function, one of several values, or a value to be equal to."""
    if callable(wanted):
        return lambda value: bool(wanted(value))
    if isinstance(wanted, Collection) and not isinstance(wanted, str):
        return lambda value: value in wanted
    return lambda value: value == wanted


def _nearest(name: str, known: Sequence[str]) -> str:
    """Return the end of a message about an unknown name: names that are like it."""
    close = get_close_matches(name, known, n=3, cutoff=0.4)
    return f"did you mean {', '.join(close)}?" if close else "see the table for the names"


ULTIMATE_OVER_YIELD = 1.5
"""Ultimate over yield stress where it is not reported."""

DEFAULT_YIELD_STRESS = 420e6
"""Yield stress of longitudinal bars where it is not reported [Pa]."""

_COVER_SHARE = 0.05


#: A longitudinal bar, or several at the same depth: depth from the middle in the direction of
#: loading [m], area [m2], and yield and ultimate stress [Pa].
_Bar: TypeAlias = tuple[float, float, tuple[float, float]]


@dataclass(frozen=True)
class DrawnSpecimen:
    """The section of a specimen, and what the table says of its bars besides.

    Attributes
    ----------
    section : rbsdem.model.shape.Section
        Laws by the strengths. The table has the legs of hoops in the direction of loading only;
        those across are taken as the same. A square section with a spiral has it as hoops.
    restrained : int
        Longitudinal bars that are held in a corner or by a tie, of those around the perimeter.
    round_core : bool
        Whether a rectangular section has a spiral.
    assumed : tuple of str
        Properties that the table did not report, and the values assumed.
    """

    section: Section
    restrained: int
    round_core: bool
    assumed: tuple[str, ...] = ()


@dataclass
class _Sheet:
    """A specimen and the assumptions made while its section is drawn."""

    specimen: Specimen
    assumed: list[str] = field(default_factory=list)

    def known(self, name: str, otherwise: float, said: str) -> float:
        """Return a property, or what is assumed for it."""
        value = getattr(self.specimen, name)
        if value is not None:
            return float(value)
        self.assumed.append(f"{name}: {said}")
        return otherwise

    def guessed(self, name: str, otherwise: float, said: str) -> float:
        """Return a property that a prediction depends on much, or what is assumed, with a warning.

        Parameters
        ----------
        name, otherwise, said
            As for `known`.
        """
        if getattr(self.specimen, name) is None:
            self.warn(f"{name} is not given; taken as {said}")
        return self.known(name, otherwise, said)

    def warn(self, what: str) -> None:
        """Warn of an assumption."""
        warn(f"{self.specimen.name}: {what}")


def draw(specimen: Specimen) -> DrawnSpecimen:
    """Draw the section of a specimen.

    Parameters
    ----------
    specimen : Specimen
        The test.

    Returns
    -------
    DrawnSpecimen
        The section, and what was assumed.

    Raises
    ------
    InputError
        If the shape is not known, a value is not plausible in SI units, the numbers of bars
        contradict each other, the bars have no diameter or do not fit, or the section is refused.

    Warns
    -----
    AccuracyWarning
        If a yield stress is not reported, and where bars beyond those of the faces are taken as
        bundled.
    """
    _check(specimen)
    _check_bars(specimen)
    sheet = _Sheet(specimen)
    round_core = specimen.section == "square(spiral table)"
    circular = specimen.section in ("circular", "octagonal")
    if not (circular or round_core or specimen.section == "rectangular"):
        raise InputError(
            f"{specimen.name}: section = {specimen.section!r} is not known; there are rectangular, "
            "circular, octagonal and square(spiral table)"
        )
    tie = specimen.transverse_diameter if specimen.transverse_spacing else None
    if tie is None:
        sheet.assumed.append("no transverse bars: no diameter or spacing")
    cover = sheet.known("cover", _COVER_SHARE * specimen.depth, "0.05 of the depth")
    side_cover = specimen.cover_perpendicular or cover
    if circular or round_core:
        # For a spiral the table gives the cover to its centre.
        cover = side_cover = max(cover - (tie or 0.0) / 2, 0.0)
    diameter = specimen.corner_diameter or specimen.intermediate_diameter
    if diameter is None:
        raise InputError(f"{specimen.name}: no diameter of the longitudinal bars; it is needed")
    corner, intermediate = _steels(sheet)
    if circular or round_core:
        bars = _round(specimen, cover + (tie or 0.0), diameter, corner)
    else:
        bars = _rectangle(sheet, cover + (tie or 0.0), diameter, corner, intermediate)
    steels = {stresses: Steel(*stresses) for _, _, stresses in bars}
    given: dict[str, Any] = {
        "concrete": Concrete(specimen.concrete_strength),
        "bars": [(y, area, steels[stresses]) for y, area, stresses in bars],
        "cover": cover,
        "bar_diameter": diameter,
    }
    hoops: dict[str, Any] = {}
    if tie:
        said = "that of longitudinal bars"
        hoop_yield = sheet.guessed("transverse_yield_stress", corner[0], said)
        ultimate = specimen.transverse_ultimate_stress or ULTIMATE_OVER_YIELD * hoop_yield
        hoops = {"diameter": tie, "spacing": specimen.transverse_spacing}
        hoops["steel"] = Steel(hoop_yield, ultimate)
    section: Section
    if circular:
        spiral = Spiral(**hoops) if hoops else None
        section = CircularSection(specimen.depth, **given, spiral=spiral)
    else:
        legs = specimen.shear_legs or 2.0
        ties = Ties(**hoops, legs=legs, legs_across=legs) if hoops else None
        size = specimen.width, specimen.depth
        section = RectangularSection(*size, **given, ties=ties, side_cover=side_cover)
    return DrawnSpecimen(section, _restrained(specimen), round_core, tuple(sheet.assumed))


def _check_bars(specimen: Specimen) -> None:
    """Refuse numbers of bars that contradict each other, as fewer in all than on the faces."""
    whole = specimen.longitudinal_number
    counts = {
        "longitudinal_number": whole,
        "intermediate_perpendicular": specimen.intermediate_perpendicular,
        "intermediate_parallel": specimen.intermediate_parallel,
    }
    for name, count in counts.items():
        if count is not None and (count != round(count) or count < 0):
            raise InputError(
                f"{specimen.name}: {name} = {count:g} bars must be a whole number, 0 or more"
            )
    if specimen.section != "rectangular":
        return
    across, along = specimen.intermediate_perpendicular, specimen.intermediate_parallel
    if across is None or along is None:
        if whole < 4:
            raise InputError(
                f"{specimen.name}: longitudinal_number = {whole} bars, but a rectangular section "
                "has one in each of its four corners; count all of them"
            )
        return
    # More bars than there are places stand in bundles.
    drawn = 4 + 2 * (across + along)
    if whole < drawn or (whole > drawn == 4):
        raise InputError(
            f"{specimen.name}: longitudinal_number = {whole} contradicts the bars of the faces: "
            f"4 in the corners, 2 x {across} (intermediate_perpendicular) and 2 x {along} "
            f"(intermediate_parallel) are {drawn}; correct one of them"
        )


# Plausible ranges in SI units, with a hint for values in other units.
_YIELDS = [f"{bar}_yield_stress" for bar in ("corner", "intermediate", "transverse")]
_RANGES = {
    "length": (0.05, 100.0, "m", "1600 mm is 1.6"),
    "width": (0.02, 20.0, "m", "400 mm is 0.4"),
    "depth": (0.02, 20.0, "m", "400 mm is 0.4"),
    "concrete_strength": (2e6, 300e6, "Pa", "40 MPa is 40e6"),
    "axial_load": (-1e9, 1e9, "N", "700 kN is 700e3"),
    **dict.fromkeys(_YIELDS, (50e6, 3e9, "Pa", "450 MPa is 450e6")),
    "longitudinal_ultimate_stress": (50e6, 4e9, "Pa", "600 MPa is 600e6"),
    "transverse_diameter": (1e-3, 0.1, "m", "10 mm is 0.010"),
    "transverse_spacing": (2e-3, 10.0, "m", "80 mm is 0.080"),
    "longitudinal_number": (1, 10000, "bars", "count all of them"),
    "corner_diameter": (1e-3, 0.1, "m", "16 mm is 0.016"),
    "intermediate_diameter": (1e-3, 0.1, "m", "16 mm is 0.016"),
    "cover": (0.0, 1.0, "m", "20 mm is 0.020"),
    "cover_perpendicular": (0.0, 1.0, "m", "20 mm is 0.020"),
    "shear_legs": (0.0, 1000.0, "bars", "count those that cross the section along the loading"),
}


def _check(specimen: Specimen) -> None:
    """Refuse values outside their plausible ranges, all of them at once."""
    faults = []
    for name, (low, high, unit, remedy) in _RANGES.items():
        value = getattr(specimen, name)
        if value is not None and not low <= value <= high:
            faults.append(
                f"{specimen.name}: {name} = {value:g} {unit} must be between {low:g} and {high:g}; "
                f"{remedy}"
            )
    _arguments.raise_faults(faults)


def _steels(sheet: _Sheet) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return yield and ultimate stress of corner and intermediate bars."""
    specimen = sheet.specimen
    corner = sheet.guessed("corner_yield_stress", DEFAULT_YIELD_STRESS, "Grade 60, 420 MPa")
    intermediate = specimen.intermediate_yield_stress or corner
    ultimate = specimen.longitudinal_ultimate_stress
    if ultimate is None or ultimate <= corner:
        sheet.assumed.append("longitudinal_ultimate_stress: 1.5 times the yield stress")
        ultimate = ULTIMATE_OVER_YIELD * corner
    # The table has only the ultimate stress of the corner bars.
    return (corner, ultimate), (intermediate, max(ultimate * intermediate / corner, intermediate))


def _rectangle(
    sheet: _Sheet,
    to_bars: float,
    diameter: float,
    corner: tuple[float, float],
    intermediate: tuple[float, float],
) -> list[_Bar]:
    """Return the bars of a rectangle; what the table leaves open is added to the assumptions."""
    specimen = sheet.specimen
    across, along = specimen.intermediate_perpendicular, specimen.intermediate_parallel
    if across is None or along is None:
        sheet.assumed.append("bars of the faces: as equal as possible")
        along = max(specimen.longitudinal_number - 4, 0) // 4
        across = max(specimen.longitudinal_number - 4 - 2 * along, 0) // 2
    inner = specimen.intermediate_diameter or diameter
    between = 2 * (across + along)
    share = (specimen.longitudinal_number - 4) / between if between else 0.0
    if between and specimen.longitudinal_number != 4 + between:
        said = f"areas of the {between} bars between the corners: times {share:.4g}"
        sheet.assumed.append(said)
        sheet.warn(
            f"longitudinal_number = {specimen.longitudinal_number} with bundled bars; {said}"
        )
    area = max(share, 0.0) * math.pi / 4 * inner**2
    edge = specimen.depth / 2 - to_bars
    y_corner, y_inner = edge - diameter / 2, edge - inner / 2
    _check_room(min(y_corner, y_inner), specimen, to_bars, diameter)
    corner_area = math.pi / 4 * diameter**2
    bars = [(y, 2 * corner_area, corner) for y in (-y_corner, y_corner)]
    if across:
        bars += [(y, across * area, intermediate) for y in (-y_inner, y_inner)]
    step = 2 * y_corner / (along + 1)
    bars += [(-y_corner + (i + 1) * step, 2 * area, intermediate) for i in range(along)]
    return sorted(bars, key=lambda bar: bar[0])


def _round(
    specimen: Specimen, to_bars: float, diameter: float, steel: tuple[float, float]
) -> list[_Bar]:
    """Return the bars of a round section; `to_bars` is the concrete outside of them [m]."""
    radius = specimen.depth / 2 - to_bars - diameter / 2
    _check_room(radius, specimen, to_bars, diameter)
    n = specimen.longitudinal_number
    area = math.pi / 4 * diameter**2
    ys = [radius * math.cos(2 * math.pi * i / n) for i in range(n)]
    if n % 2:
        ys, area = [*ys, *(-y for y in ys)], area / 2
    return sorted((y, area, steel) for y in ys)


def _check_room(left: float, specimen: Specimen, to_bars: float, diameter: float) -> None:
    """Refuse bars that are no distance (`left` [m]) away from the middle of the section."""
    if left <= 0:
        raise InputError(
            f"{specimen.name}: bars of {diameter * 1e3:g} mm behind a cover of "
            f"{to_bars * 1e3:g} mm do not fit into a depth of {specimen.depth * 1e3:g} mm"
        )


def _restrained(specimen: Specimen) -> int:
    """Return how many bars are held: all in a spiral; else corners and those at inner legs."""
    n = specimen.longitudinal_number
    if specimen.section != "rectangular" or not specimen.shear_legs:
        return n if specimen.section != "rectangular" else min(4, n)
    # Each leg beyond two holds a bar on both faces, along and across.
    return min(n, 4 + 4 * round(specimen.shear_legs - 2))


_OPTIONS = ("n", "model_parameters", "restrained", "round_core", "ends", "footing")

#: The equivalent cantilever of the table, or the form of the test.
Ends = Literal["equivalent", "tested"]


@overload
def column(
    specimen: Specimen, model: Literal["layered"] = "layered", **options: Any
) -> LayeredColumn: ...
@overload
def column(specimen: Specimen, model: Literal["paper"], **options: Any) -> Column: ...
def column(specimen: Specimen, model: Model = DEFAULT, **options: Any) -> Column:
    """Make the column of a specimen.

    Parameters
    ----------
    specimen : Specimen
        The test; only its properties are looked at.
    model : {"layered", "paper"}, optional
        As for `rbsdem.section.column`.
    **options
        As there: ``n``, ``model_parameters``. ``ends="tested"`` makes a double
        curvature specimen (config DC) what it is, twice as long with a hinge at each end: its top
        moves twice as far as the displacement of the test. The default, ``"equivalent"``, is the
        cantilever that all lengths and displacements of the table belong to and the model was
        fitted to: the same within 1e-5 and half the work, until shear softens. Then all further
        slip of the whole specimen is at one end, which its equal halves cannot tell (docs/peer.md).
        ``footing`` is what the column stands on.

    Returns
    -------
    Column
        With second-order effects of the axial load at the height where it acts.

    Raises
    ------
    InputError
        If the model is not known, if the section cannot be analysed, or if the table does not say
        enough of the ends of the test.
    """
    model = _arguments.choice(model, "model", MODELS)
    checked_specimen(specimen)
    check_options(options)
    tested = _tested(specimen, options.pop("ends", "equivalent"), options.get("footing"))
    drawn = draw(specimen)
    if model == "layered":
        options = {"restrained": drawn.restrained, "round_core": drawn.round_core} | options
    halves = 2 if tested and specimen.config == "DC" else 1
    options |= {"model": model, "axial_load": specimen.axial_load, "mass": halves * specimen.mass}
    options["axial_height"] = None if halves == 2 else specimen.axial_height
    options["top"] = "fixed" if halves == 2 else "free"
    made: Column = column_of(drawn.section, halves * specimen.length, **options)
    return made


def _tested(specimen: Specimen, ends: str, footing: object) -> bool:
    """Return whether the ends are to be those of the test; refuse what the table does not give."""
    if ends not in get_args(Ends):
        raise InputError(f"ends = {ends!r} is not known; it is one of {', '.join(get_args(Ends))}")
    if ends == "equivalent":
        return False
    if specimen.config == "CFB" and footing is None:
        raise InputError(
            f"{specimen.name}: the stiffness of its flexible base is not in the table; give "
            "footing=, or take ends='equivalent'"
        )
    if specimen.config == "DC" and specimen.axial_height != specimen.length:
        raise InputError(
            f"{specimen.name}: its axial load acts at {specimen.axial_height:g} m, not at the "
            f"length of {specimen.length:g} m; take ends='equivalent', which has that lever"
        )
    return True


def checked_specimen(specimen: object) -> Specimen:
    """Return a specimen, or raise `InputError` for anything else."""
    remedy = "rbsdem.peer.read_specimens reads them from a table"
    if isinstance(specimen, Section):
        maker = "rbsdem.section.column(section, height, axial_load=...)"
        remedy = f"of a section, {maker} makes a column"
    return _arguments.instance(specimen, "specimen", Specimen, remedy)


def check_options(options: Mapping[str, object]) -> None:
    """Raise `InputError` for options that `rbsdem.section.column` does not have."""
    for name in options:
        if name not in _OPTIONS:
            near = get_close_matches(name, _OPTIONS, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            known = ", ".join(_OPTIONS)
            raise InputError(f"the option {name} is not known; there are {known}{hint}")
