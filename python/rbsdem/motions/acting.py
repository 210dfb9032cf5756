"""Ground motions given to an analysis in place of arrays."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from rbsdem.errors import InputError
from rbsdem.motions.motion import GroundMotion

_OF_THE_GROUND = ("ground_acceleration", "vertical_acceleration")


def acting(
    time: ArrayLike | None, loads: Mapping[str, ArrayLike | GroundMotion | None], who: str
) -> tuple[ArrayLike | None, dict[str, ArrayLike]]:
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
        The times, and the loads that are given. Of two motions the shorter one is followed by rest.

    Raises
    ------
    InputError
        If the times are given twice, or two motions have different steps.
    """
    given: dict[str, ArrayLike] = {}
    motions: dict[str, GroundMotion] = {}
    for name, load in loads.items():
        if isinstance(load, GroundMotion):
            motions[name] = load
        elif load is not None:
            given[name] = load
    if not motions:
        return time, given
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
        told = " and ".join(f"{name} {motion.dt:g} s" for name, motion in motions.items())
        raise InputError(
            f"{who}: steps differ ({told}); motions.resampled brings a motion to another step"
        )
    longest = max(motions.values(), key=lambda motion: motion.acceleration.size)
    size = longest.acceleration.size
    for name, motion in motions.items():
        given[name] = np.pad(motion.acceleration, (0, size - motion.acceleration.size))
    return longest.time, {name: given[name] for name in loads if name in given}
