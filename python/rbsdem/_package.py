"""What is installed: the files of the folder `data`, and a digest of the code."""

from __future__ import annotations

import csv
import hashlib
import importlib.util
from functools import cache
from importlib import resources
from pathlib import Path

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


@cache
def code_digest() -> bytes:
    """Return the digest of Python files and extension, by which kept results know their maker."""
    root = Path(__file__).resolve().parent
    files = sorted(root.rglob("*.py"))
    extension = importlib.util.find_spec("rbsdem._rbsdem")
    if extension is not None and extension.origin is not None:
        files.append(Path(extension.origin))
    digest = hashlib.sha256()
    for file in files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.digest()
