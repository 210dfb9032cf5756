"""The table of the tests: `specimens.csv` of a folder of histories."""

from __future__ import annotations

import csv
import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass
from difflib import get_close_matches
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.measured.specimen import Observed, Specimen

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["TABLE", "Specimens", "read_specimens"]

TABLE = "specimens.csv"
"""Name of the table in its folder."""

# Texts that mean "not reported". So does a zero where zero has no meaning.
_NOT_REPORTED = ("", "-", "--", "n/a", "na", "nan", "none", "not reported")


@dataclass(frozen=True, slots=True)
class _Column:
    """Where an attribute comes from: its column, the factor to SI, whether zero is a value."""

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


def _text(column: str, **more: Any) -> _Column:
    return _Column(column, kind=str, **more)


def _count(column: str, **more: Any) -> _Column:
    return _Column(column, kind=int, **more)


def _mm(column: str, **more: Any) -> _Column:
    return _Column(column, factor=1000, divide=True, **more)


def _kilo(column: str, **more: Any) -> _Column:
    return _Column(column, factor=1000, **more)


def _mega(column: str, **more: Any) -> _Column:
    return _Column(column, factor=1000**2, **more)


_COLUMNS = {
    "name": _text("name", needed=True),
    "section": _text("section", needed=True),
    "length": _mm("L_mm", needed=True),
    "width": _mm("b_mm", needed=True),
    "depth": _mm("h_mm", needed=True),
    "concrete_strength": _mega("fc_MPa", needed=True),
    "axial_load": _kilo("axial_kN", zero=True, needed=True),
    "longitudinal_number": _count("n_long", needed=True),
    "peer_id": _count("peer_id"),
    "file": _text("file"),
    "author": _text("author"),
    "year": _text("year"),
    "config": _text("config"),
    "measured_length": _mm("Lmeas_mm"),
    "cover": _mm("cover_mm"),
    "cover_perpendicular": _mm("cover_perp_mm"),
    "cover_definition": _text("cover_definition"),
    "corner_diameter": _mm("db_corner_mm"),
    "intermediate_diameter": _mm("db_interm_mm"),
    "intermediate_perpendicular": _count("n_interm_perp", zero=True),
    "intermediate_parallel": _count("n_interm_par", zero=True),
    "corner_yield_stress": _mega("fy_long_MPa"),
    "intermediate_yield_stress": _mega("fy_interm_MPa"),
    "longitudinal_ultimate_stress": _mega("fu_long_MPa"),
    "transverse_yield_stress": _mega("fy_trans_MPa"),
    "transverse_ultimate_stress": _mega("fu_trans_MPa"),
    "transverse_diameter": _mm("db_trans_mm"),
    "transverse_spacing": _mm("s_trans_mm"),
    "shear_legs": _Column("legs_Nv"),
    "confinement": _text("confinement"),
    "failure_mode": _text("failure_mode"),
    "pdelta_code": _count("pdelta_code"),
    "top_length": _mm("Ltop_mm", zero=True),
    "bottom_length": _mm("Lbottom_mm", zero=True),
    "beam_length": _mm("Lbeam_mm"),
    "splice_length": _mm("Lsplice_mm"),
    "notes": _text("notes"),
}

_OBSERVED = {
    "points": _count("n_points"),
    "largest_force": _kilo("F_max_kN", zero=True),
    "smallest_force": _kilo("F_min_kN", zero=True),
    "largest_displacement": _mm("d_max_mm", zero=True),
    "smallest_displacement": _mm("d_min_mm", zero=True),
    "reversals": _count("reversals", zero=True),
    "cycles": _count("cycles", zero=True),
    "stiffness_25": _mega("K_sec25_kN_mm"),
    "stiffness_50": _mega("K_sec50_kN_mm"),
    "stiffness_75": _mega("K_sec75_kN_mm"),
    "published_shear": _kilo("manual_Vmax_kN"),
    "published_moment": _kilo("manual_Mmax_kNm"),
    "published_yield_displacement": _mm("manual_dy_mm"),
    "published_label": _text("manual_label"),
}


class Specimens(Sequence[Specimen]):
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

    def to_frame(self) -> pd.DataFrame:
        """Return a row for each test."""
        import pandas as pd  # noqa: PLC0415

        rows = [asdict(row) for row in self._rows]
        return pd.DataFrame([{**row, **row.pop("observed")} for row in rows])

    def _named(self, key: str) -> Specimen:
        for row in self._rows:
            if row.is_called(key):
                return row
        names = [row.name for row in self._rows] + [row.file for row in self._rows if row.file]
        raise InputError(f"no specimen {key!r} in the table; {_nearest(key, names)}")


def read_specimens(path: str | os.PathLike[str]) -> Specimens:
    """Read the table of the tests.

    Parameters
    ----------
    path : path
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
            missing = [c.column for c in _COLUMNS.values() if c.needed and c.column not in names]
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
    values = _values(row, _COLUMNS, where)
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
        observed=Observed(**_values(row, _OBSERVED, where)),
    )


def _values(row: dict[str, str | None], columns: dict[str, _Column], where: str) -> dict[str, Any]:
    """Return the attributes that the row has columns for."""
    found = {}
    for name, column in columns.items():
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
    if callable(wanted):
        return wanted
    if isinstance(wanted, Collection) and not isinstance(wanted, str):
        return lambda value: value in wanted
    return lambda value: value == wanted


def _nearest(name: str, known: Sequence[str]) -> str:
    close = get_close_matches(name, known, n=3, cutoff=0.4)
    return f"did you mean {', '.join(close)}?" if close else "see the table for the names"
