"""The files of the folder `data`, which are installed with the package."""

from __future__ import annotations

import csv
from importlib import resources

from rbsdem.errors import InputError


def text(name: str) -> str:
    """Return the text of a file.

    Parameters
    ----------
    name : str
        File name inside the folder.

    Raises
    ------
    InputError
        If the file is not there.
    """
    try:
        return resources.files("rbsdem").joinpath("data", name).read_text(encoding="utf-8")
    except OSError as error:
        raise InputError(
            f"data file {name} is not in the installed package; install rbsdem again"
        ) from error


def notes(name: str) -> list[str]:
    """Return the comment lines of a file without #: what the file is, and its source."""
    return [line.lstrip("# ") for line in text(name).splitlines() if line.startswith("#")]


def rows(name: str) -> list[dict[str, str]]:
    """Return the rows of a csv file as mappings from the names in its header."""
    lines = [line for line in text(name).splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))
