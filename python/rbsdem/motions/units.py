"""Units of recorded accelerations."""

from __future__ import annotations

from rbsdem.errors import InputError
from rbsdem.motions.motion import STANDARD_GRAVITY

#: Value of each unit in m/s2.
UNITS = {"g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001}

_SPELLINGS = {"gal": "cm/s2", "gals": "cm/s2", "g's": "g", "gs": "g"}


def unit_named(word: str) -> str:
    """Return the name of a unit by one of its spellings, or an empty text.

    Parameters
    ----------
    word : str
        As in a file: "G", "cm/s/s", "cm/sec**2", "gal", "m/s^2".
    """
    plain = word.strip().strip("()[].,").lower().replace(" ", "").replace("sec", "s")
    for power in ("/s/s", "/s^2", "/s**2", "/s²", "s-2", "/s2"):
        if plain.endswith(power):
            plain = plain.removesuffix(power).rstrip(".*·") + "/s2"
            break
    plain = _SPELLINGS.get(plain, plain)
    return plain if plain in UNITS else ""


def checked_unit(units: str, who: str) -> str:
    """Return the name of a unit that a user gives, or raise `InputError` naming all."""
    name = unit_named(str(units))
    if not name:
        raise InputError(f"{who}units = {units!r} is not one of {', '.join(UNITS)}")
    return name


def agreed_unit(found: str, given: str | None, who: str) -> str:
    """Return the unit of a file: the one that it names, or the one that the user gives.

    Parameters
    ----------
    found : str
        The unit that the file names; empty if it names none.
    given : str or None
        The unit that the user gives.
    who : str
        What a message starts with.

    Raises
    ------
    InputError
        If the two differ, or if there is none: a unit is never guessed.
    """
    wanted = "" if given is None else checked_unit(given, who)
    if found and wanted and found != wanted:
        raise InputError(
            f"{who}the file says that its accelerations are in {found}, and units = {given!r} was "
            "given; leave units out, or correct the file"
        )
    if not (found or wanted):
        raise InputError(
            f"{who}the file does not name the unit of its accelerations; give units='g', 'm/s2' "
            "or 'cm/s2'"
        )
    return found or wanted
