"""Measured histories: displacement and net horizontal force; reversal points of four tests.

The full histories belong to the PEER Structural Performance Database and are no part of rbsdem; a
user gets them there (https://nisee.berkeley.edu/spd/) and names the folder. Without them, the
reversal points of `data/reversals_<key>.csv` are used.
"""

from __future__ import annotations

import math
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _arguments, _core, _package
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike, NDArray
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


def top_displacement(
    displacement: ArrayLike, *, length: float, measured_length: float | None = None
) -> Array:
    """Return the displacement of the top from the measured one.

    Parameters
    ----------
    displacement : array_like, shape (m,)
        As in the file [m].
    length : float
        Of the equivalent cantilever [m].
    measured_length : float, optional
        Height at which the displacement was measured [m]; by default the length.

    Returns
    -------
    ndarray, shape (m,)
        d L/L_meas [m], as in the manual's rules for P-Delta: the column stays straight above its
        hinge.
    """
    d = _arguments.finite_vector(displacement, "displacement")
    return d * (length / (measured_length or length))


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
    *,
    length: float,
    axial_load: float,
    measured_length: float | None,
    top_length: float | None,
    bottom_length: float | None,
) -> MeasuredTest:
    """Return the test of two columns of a file; `who` stands in front of messages."""
    levers: dict[str, Any] = {"length": length, "measured_length": measured_length}
    ends: dict[str, Any] = {"top_length": top_length, "bottom_length": bottom_length}
    try:
        axial_load = _arguments.number(axial_load, "axial_load")
        net = net_force(displacement, force, code=code, axial_load=axial_load, **levers, **ends)
    except InputError as error:
        raise InputError(f"{who}: {error}") from error
    top = displacement.copy()
    if not math.isnan(length):
        top = top_displacement(displacement, **levers)
    above = 0.0 if code == 4 else top_length or 0.0
    columns = top, net, displacement, force
    return MeasuredTest(name, *columns, length, axial_load, code, length + above)


@dataclass(frozen=True, repr=False)
class PeerTest(Tabular):
    """A measured force-displacement history.

    Attributes
    ----------
    name : str
        Name of the test, from the first line of a PEER file; the file's name for a csv.
    displacement : ndarray, shape (m,)
        Displacement of the top of the equivalent cantilever [m].
    force : ndarray, shape (m,)
        Force column of the file [N]; the P-Delta code of the test says what it means.
    """

    _columns = ("displacement m", "force N")

    name: str
    displacement: Array
    force: Array


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
    name, _, (displacement, force), _ = _core.evaluate(
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


@dataclass(frozen=True, slots=True, eq=False)
class Reversals:
    """Points of a test at which the displacement turns back, with the first and the last one.

    Attributes
    ----------
    key : str
        Key of the column, as in `rbsdem.peer.paper_columns`.
    name : str
        Name of the specimen.
    displacement : ndarray, shape (n,)
        Displacement of the top of the equivalent cantilever [m].
    force : ndarray, shape (n,)
        Net horizontal force at these points [N]; the largest force of a test lies between them.
    source : str
        Note on the source, with the reports to cite.
    """

    key: str
    name: str
    displacement: NDArray[np.float64]
    force: NDArray[np.float64]
    source: str


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


def shipped_reversals(key: str) -> Reversals:
    """Read the reversal points of a test that come with rbsdem.

    Parameters
    ----------
    key : str
        soesianawati_1, tanaka_park_1, tanaka_park_5 or zahn_7.

    Returns
    -------
    Reversals
        About 20 points in the order of the test, SI units.

    Raises
    ------
    InputError
        If there is no such key.
    """
    if key not in HISTORY_FILES:
        raise InputError(f"no reversal points for {key!r}; there are {', '.join(HISTORY_FILES)}")
    name = f"reversals_{key}.csv"
    rows, notes = _package.rows(name), _package.notes(name)
    displacement, force = (
        np.array([float(row[column]) for row in rows]) for column in ("displacement_mm", "force_kN")
    )
    return Reversals(
        key=key,
        name=notes[0].partition(":")[0],
        displacement=displacement / 1000,
        force=force * 1000,
        source="\n".join(notes),
    )


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
