"""The installation: files of the package, its code, its commands."""

from __future__ import annotations

import csv
import hashlib
import importlib.util
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from importlib import resources
from pathlib import Path

from rbsdem.errors import AccuracyWarning, InputError


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


#: Commands that are run by Python, and their modules.
COMMANDS = dict.fromkeys(
    ("trade", "ensemble", "ida", "explore", "report", "draw"), "rbsdem.cli.columns"
) | {
    "peer": "rbsdem.cli.measured",
    "predict": "rbsdem.cli.measured",
    "verify": "rbsdem.cli.measured",
    "completion": "rbsdem.cli",
}


@contextmanager
def unwarned(*kinds: type[Warning]) -> Iterator[None]:
    """Ignore warnings of some kinds; without any named, those of accuracy."""
    with warnings.catch_warnings():
        for kind in kinds or (AccuracyWarning,):
            warnings.simplefilter("ignore", kind)
        yield


@contextmanager
def recorded(kind: type[Warning] = Warning) -> Iterator[list[warnings.WarningMessage]]:
    """Put warnings of a kind into a list instead of telling them."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", kind)
        yield caught
