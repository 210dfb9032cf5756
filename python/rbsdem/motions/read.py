"""Files of ground motions."""

from __future__ import annotations

import os
from pathlib import Path

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.motions.at2 import is_at2, read_at2
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.rows import read_table

#: Largest file that is read [bytes].
_MOST_BYTES = 500_000_000
#: Endings of the files that `read_motions` takes from a folder.
ENDINGS = (".at2", ".csv", ".txt")
#: Formats with much in them besides the accelerations, which other programs read well.
_OTHERS = (".smc", ".v1", ".v2", ".v1c", ".v2c", ".v3", ".cosmos", ".evt", ".mseed", ".sac")


def read_motion(
    path: str | os.PathLike[str], units: str | None = None, dt: float | None = None
) -> GroundMotion:
    """Read a record of a ground motion.

    Parameters
    ----------
    path : path
        An AT2 file of the PEER databases, old or new; or a csv with columns of time and
        acceleration, or with one column.
    units : {"g", "m/s2", "cm/s2", "mm/s2"}, optional
        Unit of the accelerations, where the file does not name it: the third line of an AT2 file,
        or the name of the column, ``acceleration_g``. It is never guessed.
    dt : float, optional
        For a csv: the step [s] if there is no column of times, or the step to which values at
        uneven times are interpolated.

    Raises
    ------
    InputError
        If the file cannot be read, with its name, the line and a remedy.

    Warns
    -----
    RepairWarning
        If a few of the last values of an AT2 file are missing.
    """
    name = _arguments.file(path)
    lines = _lines(name)
    # The name of a file may have bytes that are no text.
    stem = Path(name).stem.encode("utf-8", "replace").decode()
    if is_at2(lines) or name.lower().endswith(".at2"):
        if dt is not None:
            raise InputError(f"{name}: dt = {dt} was given, and an AT2 file has its own; remove it")
        return read_at2(lines, name, stem, units)
    if dt is not None:
        dt = _arguments.number(dt, "dt")
    return read_table(lines, name, stem, units, dt)


def read_motions(
    folder: str | os.PathLike[str], units: str | None = None, pattern: str = "*"
) -> tuple[GroundMotion, ...]:
    """Read all records of a folder, in the order of their names.

    Parameters
    ----------
    folder : path
        Folder with files that end with .AT2, .csv or .txt; other files are left out.
    units : str, optional
        As for `read_motion`, for files that do not name their unit.
    pattern : str, optional
        Files to read, as a shell understands it: ``"RSN*_H*.AT2"``.

    Raises
    ------
    InputError
        With a line for every file that cannot be read, or if there is none.

    Warns
    -----
    RepairWarning
        As `read_motion`.
    """
    place = _arguments.path(folder, "folder")
    _arguments.text(pattern, "pattern")
    if not place.is_dir():
        raise InputError(f"{place} is not a folder; for one record call read_motion")
    paths = sorted(
        path
        for path in place.glob(pattern)
        if path.suffix.lower() in ENDINGS and path.is_file() and not path.name.startswith(".")
    )
    if not paths:
        raise InputError(
            f"{place}: no file {pattern!r} with the ending {', '.join(ENDINGS)} is there"
        )
    motions, faults = [], []
    for path in paths:
        try:
            motions.append(read_motion(path, units))
        except InputError as error:
            faults.append(str(error))
    if faults:
        raise InputError("\n".join(faults))
    return tuple(motions)


def _lines(path: str) -> list[str]:
    """Return the lines of a file, whatever system and code they come from."""
    ending = Path(path).suffix.lower()
    if ending in _OTHERS:
        raise InputError(
            f"{path}: the format {ending} is not read here; gmprocess (USGS) or obspy reads it, "
            "and GroundMotion(acceleration, dt) takes the values in m/s2"
        )
    if os.path.isdir(path):
        raise InputError(f"{path} is a folder; read_motions reads all records of one")
    try:
        if os.path.getsize(path) > _MOST_BYTES:
            raise InputError(f"{path}: larger than {_MOST_BYTES // 10**6} MB; this is no record")
        with open(path, "rb") as file:
            raw = file.read()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    if b"\0" in raw[:4096]:
        raise InputError(f"{path}: is not a text file; get the record as AT2 or csv")
    lines = raw.decode("utf-8-sig", "replace").splitlines()
    if not any(line.strip() for line in lines):
        raise InputError(f"{path}: is empty; get the record anew")
    return lines
