"""Ground motions given to an analysis in place of arrays."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from rbsdem.errors import InputError
from rbsdem.motions.motion import GroundMotion

_OF_THE_GROUND = ("ground_acceleration", "vertical_acceleration")


def acting(time: Any, loads: Mapping[str, Any], who: str) -> tuple[Any, dict[str, Any]]:
    """Return times and loads as arrays, where loads may be ground motions.

    Parameters
    ----------
    time : array_like or None
        Times of the loading [s]; None where a motion brings them.
    loads : mapping
        Loads by name: arrays, ground motions, or None.
    who : str
        The function that was called, for messages.

    Returns
    -------
    tuple
        The times, and the loads. Of two motions the shorter one is followed by rest.

    Raises
    ------
    InputError
        If the times are given twice, or two motions have different steps.
    """
    motions = {name: load for name, load in loads.items() if isinstance(load, GroundMotion)}
    if not motions:
        return time, dict(loads)
    for name in motions:
        if name not in _OF_THE_GROUND:
            raise InputError(
                f"{who}: {name} is a GroundMotion; give it as {' or '.join(_OF_THE_GROUND)}"
            )
    if time is not None:
        raise InputError(
            f"{who}: time is given, and {next(iter(motions))} brings its own; leave time out, or "
            "give motion.acceleration"
        )
    steps = {motion.dt for motion in motions.values()}
    if len(steps) > 1:
        given = " and ".join(f"{name} {motion.dt:g} s" for name, motion in motions.items())
        raise InputError(
            f"{who}: steps differ ({given}); motions.resampled brings a motion to another step"
        )
    longest = max(motions.values(), key=lambda motion: motion.acceleration.size)
    size = longest.acceleration.size
    values = {
        name: np.pad(motion.acceleration, (0, size - motion.acceleration.size))
        for name, motion in motions.items()
    }
    return longest.time, {**loads, **values}
