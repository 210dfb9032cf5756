"""Limit states by name: a measure of the response and the value at which it is reached."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rbsdem import _arguments
from rbsdem.checks.criteria import WATCHED
from rbsdem.errors import InputError

#: Measures that are 0 or 1, and the threshold that tells the two apart.
_SWITCHES = dict.fromkeys(("collapse", *WATCHED), 1.0)


def is_switch(edp: str) -> bool:
    """Return whether a measure says only whether something has happened, not how far it went."""
    return edp in _SWITCHES


def limit_states(edp: str, threshold: Any) -> dict[str, tuple[str, float]]:
    """Return measure and threshold of each limit state.

    Parameters
    ----------
    edp : str
        The measure.
    threshold : float, mapping or None
        One value, or values by the name of the limit state, each a number for this measure or a
        pair of a measure and a number. None for "collapse" and the limit states of
        `rbsdem.Result.limit_states`.
    """
    if isinstance(threshold, Mapping):
        if not threshold:
            raise InputError("threshold is empty; give at least one limit state")
        found = {}
        for name, value in threshold.items():
            pair = value if isinstance(value, tuple) and len(value) == 2 else (edp, value)
            found[str(name)] = _one(str(pair[0]), pair[1])
        return found
    one = _one(edp, threshold)
    return {edp if threshold is None else f"{edp} {one[1]:g}": one}


def _one(edp: str, threshold: Any) -> tuple[str, float]:
    if edp in _SWITCHES:
        if threshold is not None:
            raise InputError(f"threshold: {edp} has none; leave it out")
        return edp, _SWITCHES[edp]
    if threshold is None:
        raise InputError(f"threshold is missing; give the value of {edp} that is the limit state")
    value = _arguments.number(threshold, f"threshold of {edp}")
    if not value > 0:
        raise InputError(f"threshold of {edp} = {value:g} must be above 0")
    return edp, value
