"""Ranges: of what a user plausibly gives beside a section, and of the tests that models know."""

from __future__ import annotations

import math
from typing import Any

from rbsdem import _arguments
from rbsdem.errors import InputError, warn
from rbsdem.model.shape import Section, checked_section

#: Least and largest length of a column [m]: a number in millimetres is outside.
_SHORTEST, _LONGEST = 0.05, 100.0

#: Share of f'c A below which an axial load is hardly meant: the same number in kN is a usual load.
_HARDLY_ANY = 4e-4

RANGE: dict[str, tuple[float, float, float, str]] = {
    "axial load ratio": (0.0, 0.75, 1.0, ""),
    "concrete strength": (16e6, 110e6, 1e6, " MPa"),
    "yield stress of the bars": (240e6, 590e6, 1e6, " MPa"),
    "reinforcement ratio": (0.0045, 0.0605, 1.0, ""),
    "depth": (0.15, 0.65, 1.0, " m"),
    "shear span over depth": (1.5, 8.0, 1.0, ""),
    "yield stress of the ties times their ratio": (0.3e6, 16e6, 1e6, " MPa"),
    "tie spacing over bar diameter": (1.2, 18.0, 1.0, ""),
}
"""Range of the tests that the layered model was fitted to, in SI; a unit to print them in.

Of nearly all of them: 8 of 285 have a shorter shear span, 3 a larger depth and 11 fewer ties.
"""

#: A value on an end of a range may be off it by this share.
_SLACK = 1e-9


def column_length(value: Any, name: str) -> float:
    """Return a length from the base of a column to its lateral load [m].

    Parameters
    ----------
    value : float
        The length.
    name : str
        Its name in messages.

    Raises
    ------
    InputError
        If it is not a number, or no length of a column in metres.
    """
    length = _arguments.number(value, name)
    if _SHORTEST <= length <= _LONGEST:
        return length
    hint = "1600 mm is 1.6"
    if length > 1e4:
        hint += "; the length comes before the axial load"
    raise InputError(
        f"{name} = {length:g} m must be between {_SHORTEST:g} and {_LONGEST:g}; {hint}"
    )


def axial_load_note(axial_load: float, section: Section) -> str:
    """Return a remark on an axial load that is hardly meant; empty if there is none.

    Tension is one, as the sign may be that of another convention, and a load as small as one in kN.

    Parameters
    ----------
    axial_load : float
        Compression positive [N].
    section : Section
        The section that carries it.
    """
    ratio = abs(axial_load) / (section.concrete.fc * section.gross_area)
    if not 0.0 < ratio < math.inf:
        return ""
    if ratio >= _HARDLY_ANY:
        if axial_load > 0.0:
            return ""
        least, most = section.axial_capacity
        if axial_load < least:
            # It will be refused.
            return ""
        return (
            f"axial_load = {axial_load:g} N is tension; compression is positive, and without "
            f"bending the section carries {least:g} to {most:g} N"
        )
    return (
        f"axial_load = {axial_load:g} N is only {ratio:.1e} of f'c A; loads are in N: 744 kN is "
        "744e3"
    )


def checked_load(section: Section, axial_load: Any) -> float:
    """Return an axial load as a number [N]; warn the caller's caller if it is hardly meant."""
    checked_section(section)
    value = _arguments.number(axial_load, "axial_load")
    if not math.isfinite(value):
        raise InputError(f"axial_load = {value} N must be a finite number")
    note = axial_load_note(value, section)
    if note:
        warn(note)
    return value


def is_confined(section: Section, confined: Any) -> bool:
    """Return whether the core is taken as confined; refuse it without transverse bars."""
    wanted = _arguments.boolean(confined, "confined")
    if wanted and section.ties is None:
        raise InputError(
            f"confined = True needs transverse bars that confine: give the section {section.hoops}"
        )
    return wanted


def carried_load(value: Any, section: Section, *, tension: bool = True) -> float:
    """Return an axial load that a section carries [N].

    Parameters
    ----------
    value : float
        The load, compression positive [N].
    section : Section
        The section.
    tension : bool, optional
        Whether it may be tension.

    Raises
    ------
    InputError
        If it is not a finite number, or beyond the capacity of the section without bending and
        confinement.
    """
    load = _arguments.number(value, "axial_load")
    if not math.isfinite(load):
        raise InputError(f"axial_load = {load} N must be a finite number")
    least, most = section.axial_capacity
    if least <= load <= most and (tension or load >= 0.0):
        return load
    ends = f"{least:g} to {most:g} N" if tension else f"0 to {most:g} N"
    if load >= 0.0:
        fault = "is more compression than the section carries"
    elif tension:
        fault = "is more tension than the section carries"
    else:
        fault = "is tension, which the formulas are not for"
    raise InputError(f"axial_load = {load:g} N {fault}; compression is positive: give {ends}")


def outside(section: Section, height: float, axial_load: float) -> tuple[str, ...]:
    """Return where a column is outside the range of the tests that the model was fitted to.

    Parameters
    ----------
    section : Section
        Its section.
    height : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    tuple of str
        A remark for each property that is outside; empty if there is none.
    """
    found = {
        "axial load ratio": axial_load / (section.gross_area * section.concrete.fc),
        "concrete strength": section.concrete.fc,
        "yield stress of the bars": max(steel.fy for _, _, steel in section.bars),
        "reinforcement ratio": section.steel_ratio,
        "depth": section.depth,
        "shear span over depth": height / section.depth,
    }
    remarks = []
    if section.ties is None:
        remarks.append("there are no ties; of the tests that the model was fitted to two had none")
    else:
        ties = section.ties
        ratio = ties.legs * math.pi / 4 * ties.diameter**2 / (section.web_width * ties.spacing)
        found["yield stress of the ties times their ratio"] = ratio * ties.steel.fy
        if section.bar_diameter:
            found["tie spacing over bar diameter"] = ties.spacing / section.bar_diameter
    if section.shape == "tee":
        remarks.append("the section has a flange; those of the tests had none")
    if section.hollow:
        remarks.append("the section is hollow; those of the tests were solid")
    for name, value in found.items():
        low, high, unit, label = RANGE[name]
        if not low * (1 - _SLACK) <= value <= high * (1 + _SLACK):
            remarks.append(
                f"{name} = {value / unit:.3g}{label} is outside {low / unit:g} to "
                f"{high / unit:g}{label}, the range of the tests that the model was fitted to"
            )
    return tuple(remarks)
