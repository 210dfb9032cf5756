"""What is done to a record before an analysis: baseline, step, several in a row."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.motions.motion import GroundMotion, checked_motion

_MOST_DEGREE = 8
_MOST_VALUES = 20_000_000


def corrected(motion: GroundMotion, degree: int = 1) -> GroundMotion:
    """Return a motion with its baseline corrected.

    A polynomial is taken off the acceleration such that what is left of the velocity is smallest in
    the sense of least squares; the velocity starts from zero before and after.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    degree : int, optional
        Degree of the polynomial in the acceleration: 0 takes off a constant, 1 a straight line.
    """
    checked_motion(motion)
    wanted = _arguments.whole(degree, "degree")
    if not 0 <= wanted <= min(_MOST_DEGREE, motion.acceleration.size - 2):
        raise InputError(f"corrected: degree = {degree} must be from 0 to {_MOST_DEGREE}")
    tau = np.linspace(0.0, 1.0, motion.acceleration.size)
    powers = np.arange(1, wanted + 2)
    # Velocities over the length of the record: their slope is what comes off the acceleration.
    drift = tau[:, None] ** powers
    parts = np.linalg.lstsq(drift, motion.velocity, rcond=None)[0]
    slope: Array = (powers * tau[:, None] ** (powers - 1)) @ parts / motion.length
    return replace(motion, acceleration=motion.acceleration - slope)


def resampled(motion: GroundMotion, dt: float) -> GroundMotion:
    """Return a motion at other steps.

    Shorter steps lie on the straight lines between the values; where they divide the old step, the
    motion is the same. Before longer steps are taken, frequencies that they cannot show are
    removed.

    Parameters
    ----------
    motion : GroundMotion
        The motion.
    dt : float
        New step [s].
    """
    checked_motion(motion)
    step = _arguments.number(dt, "dt")
    if not 0 < step <= motion.length:
        raise InputError(
            f"resampled: dt = {step:g} s must be above 0 and at most the length of the motion, "
            f"{motion.length:g} s"
        )
    if motion.length / step > _MOST_VALUES:
        raise InputError(f"resampled: dt = {step:g} s makes more than {_MOST_VALUES} values")
    values = motion.acceleration
    if step > motion.dt * (1 + 1e-9):
        values = _without_high(values, motion.dt, 0.5 / step)
    count = int(np.ceil(motion.length / step * (1 - 1e-12))) + 1
    time = step * np.arange(count)
    # The last step may end after the record, where the ground is at rest.
    return replace(motion, acceleration=np.interp(time, motion.time, values, right=0.0), dt=step)


def sequence(
    motions: Sequence[GroundMotion], rest: float = 10.0, name: str | None = None
) -> GroundMotion:
    """Return records one after another, as a main shock and its aftershocks.

    Parameters
    ----------
    motions : sequence of GroundMotion
        The records in their order, all with the same step.
    rest : float, optional
        Time without motion between two records [s].
    name : str, optional
        Name of the whole, by default those of the parts, joined.
    """
    given = _arguments.several(motions, "sequence: motions", "GroundMotion")
    parts = [checked_motion(motion) for motion in given]
    if not parts:
        raise InputError("sequence: there are no motions; give at least one")
    pause = _arguments.number(rest, "rest")
    if not 0 <= pause <= 1e6:
        raise InputError(f"sequence: rest = {pause:g} s must be 0 or more")
    dt = parts[0].dt
    other = next((motion for motion in parts if motion.dt != dt), None)
    if other is not None:
        raise InputError(
            f"sequence: {parts[0].name or 'the first motion'} has dt = {dt:g} s and "
            f"{other.name or 'another one'} {other.dt:g} s; bring them to one step with "
            f"resampled(motion, {min(dt, other.dt):g})"
        )
    quiet = np.zeros(round(pause / dt))
    values = [parts[0].acceleration]
    for motion in parts[1:]:
        values += [quiet, motion.acceleration]
    joined = " + ".join(motion.name for motion in parts) if name is None else name
    return GroundMotion(np.concatenate(values), dt, joined)


def _without_high(values: Array, dt: float, highest: float) -> Array:
    """Return values without the frequencies above one [Hz]; zeros around keep the ends apart."""
    size = 2 * values.size
    parts = np.fft.rfft(values, size)
    parts[np.fft.rfftfreq(size, dt) > highest] = 0
    return np.fft.irfft(parts, size)[: values.size]
