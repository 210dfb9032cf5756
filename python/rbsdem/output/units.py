"""Units of figures, tables and reports: mm and kN, or those of a block of `units`."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache

from rbsdem import _arguments
from rbsdem._tables import FORCES, LENGTHS

_LENGTHS, _FORCES = ("mm", "cm", "m", "in"), ("kN", "N", "MN", "kip", "lbf", "tf")
_CHOSEN: ContextVar[tuple[str, str]] = ContextVar("units", default=("mm", "kN"))


@contextmanager
def units(length: str = "mm", force: str = "kN") -> Iterator[None]:
    """Draw figures and print tables in other units inside a ``with`` block.

    Parameters
    ----------
    length : {"mm", "cm", "m", "in"}
        Of displacements and of sections; with "in" moments are in force times inch and stresses in
        ksi or psi, else in force times metre and MPa. Heights of frames stay in m.
    force : {"kN", "N", "MN", "kip", "lbf", "tf"}
        Of forces.

    Examples
    --------
    >>> with units("in", "kip"):
    ...     labelled("Base shear", "N")
    'Base shear (kip)'
    """
    chosen = (
        _arguments.choice(length, "units: length", _LENGTHS),
        _arguments.choice(force, "units: force", _FORCES),
    )
    token = _CHOSEN.set(chosen)
    try:
        yield
    finally:
        _CHOSEN.reset(token)


@cache
def _scales(length: str, force: str) -> dict[str, tuple[float, str]]:
    """Return factor and unit on paper of units of SI, for units of length and force."""
    size, weight = LENGTHS[length], FORCES[force]
    inches = length == "in"
    arm, of_arm = (size, length) if inches else (1.0, "m")
    moment = 1.0 / (weight * arm), f"{force} {of_arm}"
    joules = {"N": "J", "kN": "kJ", "MN": "MJ"}
    stress, stiffness = (1e-6, "MPa"), (1e-6, "MN m2")
    if inches:
        stress = size**2 / weight, {"kip": "ksi", "lbf": "psi"}.get(force, f"{force}/in2")
        stiffness = 1.0 / (weight * size**2), f"{force} in2"
    return {
        "N": (1.0 / weight, force),
        "m": (1.0 / size, length),
        "N m": moment,
        "Nm": moment,
        "J": (moment[0], moment[1] if inches else joules.get(force, moment[1])),
        "1/m": (1e3 * arm, f"mrad/{of_arm}"),
        "drift": (1e2, "%"),
        "N/m": (size / weight, f"{force}/{length}"),
        "Pa": stress,
        "Nm2": stiffness,
    }


def scales() -> dict[str, tuple[float, str]]:
    """Return, of each unit of SI that has another one on paper, the factor and that unit."""
    return _scales(*_CHOSEN.get())


def paper(unit: str) -> tuple[float, str]:
    """Return the factor from a unit of SI to that on paper, and this one.

    Other units stay as they are.
    """
    return scales().get(unit, (1.0, unit))


def known(unit: str) -> bool:
    """Return whether a unit has another one on paper."""
    return unit in scales()


def factor(unit: str) -> float:
    """Return the factor from a unit of SI to that on paper."""
    return paper(unit)[0]


def labelled(words: str, unit: str) -> str:
    """Return the label of an axis with its unit."""
    return f"{words} ({paper(unit)[1]})"
