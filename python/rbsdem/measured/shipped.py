"""Measured histories of the paper's four columns, and the reversal points that come with rbsdem.

The full histories belong to the PEER Structural Performance Database and are no part of rbsdem; a
user gets them there (https://nisee.berkeley.edu/spd/) and names the folder. Without them, the
reversal points of `data/reversals_<key>.csv` are used.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from rbsdem import _package
from rbsdem.curves.metrics import Loop
from rbsdem.errors import InputError

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
    key : str or path
        Key of a column (soesianawati_1, tanaka_park_1, tanaka_park_5, zahn_7) or a file name.
    folder : path, optional
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
