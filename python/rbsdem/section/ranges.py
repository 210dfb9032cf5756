"""Plausible ranges of what a user gives beside a section, with hints for values in other units."""

from __future__ import annotations

import math
from typing import Any

from rbsdem import _core
from rbsdem.errors import InputError

__all__ = ["axial_load_note", "column_length"]

#: Least and largest length of a column [m]: a number in millimetres is outside.
_SHORTEST, _LONGEST = 0.05, 100.0

#: Share of f'c A below which an axial load is hardly meant: the same number in kN is a usual load.
_HARDLY_ANY = 4e-4


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
    length = _core.number(value, name)
    if _SHORTEST <= length <= _LONGEST:
        return length
    hint = "1600 mm is 1.6"
    if length > 1e4:
        hint += "; the length comes before the axial load"
    raise InputError(
        f"{name} = {length:g} m must be between {_SHORTEST:g} and {_LONGEST:g}; {hint}"
    )


def axial_load_note(axial_load: float, strength: float, area: float) -> str:
    """Return a remark on an axial load that is hardly meant, as one in kN; empty if there is none.

    Parameters
    ----------
    axial_load : float
        Compression positive [N].
    strength, area : float
        Cylinder strength [Pa] and gross area [m2].
    """
    ratio = abs(axial_load) / (strength * area)
    if not 0.0 < ratio < _HARDLY_ANY or not math.isfinite(ratio):
        return ""
    return (
        f"axial_load = {axial_load:g} N is only {ratio:.1e} of f'c A; loads are in N: 744 kN is "
        "744e3"
    )
