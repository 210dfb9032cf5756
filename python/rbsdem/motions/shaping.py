"""What is done to a record before an analysis, and synthetic records in place of licensed ones.

Of synthetic records, white noise, its strength over time shaped as that of an earthquake, goes
through the ground of Kanai (1957) and Tajimi (1960), with the filter of Clough and Penzien (1975)
that leaves no velocity behind. They are like each other as records of one magnitude and distance
are: peak, frequency and damping of the ground, rise and length of the strong part are drawn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rbsdem import _arguments
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array
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
    most = min(_MOST_DEGREE, motion.acceleration.size - 2)
    wanted = _arguments.integer(degree, "corrected: degree", least=0, most=most)
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
    pause = _arguments.number(rest, "sequence: rest", least=0, most=1e6, unit="s")
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


_MOST = 100_000
#: Medians and spreads (of the logarithm) of what is drawn for a motion.
_PGA = (0.30 * STANDARD_GRAVITY, 0.35)
_GROUND_FREQUENCY = (2.5, 0.35)
_GROUND_DAMPING = (0.6, 0.20)
_STRONG_PART = (8.0, 0.35)
#: The filter of Clough and Penzien: its frequency as a part of the ground's, and its damping.
_LOW_CUT, _LOW_DAMPING = 0.10, 0.6
#: Powers of e by which the slowest part of the motion decays after the noise.
_DECAYS = 8.0
#: Duration of the noise over that of its strong part (5 to 95 %), and where in it the peak is.
_WHOLE, _PEAK_AT = 2.5, 0.25


def synthetic(n: int = 20, seed: int = 1, dt: float = 0.01) -> tuple[GroundMotion, ...]:
    """Return synthetic ground motions, the same for the same arguments.

    Parameters
    ----------
    n : int, optional
        How many. The first ones do not depend on how many follow.
    seed : int, optional
        Another seed gives other motions.
    dt : float, optional
        Step [s], at most 0.05.
    """
    number = _arguments.integer(n, "synthetic: n", least=1, most=_MOST)
    start = _arguments.seed(seed, "synthetic: seed")
    step = _arguments.number(dt, "synthetic: dt", least=1e-4, most=0.05, unit="s")
    return tuple(_one(start, i, step) for i in range(1, number + 1))


def _one(seed: int, number: int, dt: float) -> GroundMotion:
    # The sequence of this generator is fixed for all versions of numpy.
    draw = np.random.RandomState([seed, number])
    pga, ground, damping, strong = (
        median * np.exp(spread * draw.standard_normal())
        for median, spread in (_PGA, _GROUND_FREQUENCY, _GROUND_DAMPING, _STRONG_PART)
    )
    size = int(np.ceil(_WHOLE * strong / dt))
    # The ground comes to rest after the noise has ended.
    rest = int(np.ceil(_DECAYS / (_LOW_DAMPING * _LOW_CUT * 2 * np.pi * ground * dt)))
    noise = np.pad(draw.standard_normal(size) * _envelope(size), (0, rest))
    values = _through_ground(noise, dt, 2 * np.pi * ground, damping)
    motion = GroundMotion(values, dt, f"synthetic_{number:02d}", f"synthetic, seed {seed}")
    return motion.scaled(pga=pga)


def _envelope(size: int) -> Array:
    """Return the shape t^a exp(-b t), its peak 1, near zero at the end."""
    tau = np.arange(size) / size
    return np.asarray((tau / _PEAK_AT * np.exp(1 - tau / _PEAK_AT)) ** 2)


def _through_ground(noise: Array, dt: float, omega: float, damping: float) -> Array:
    """Return the noise after the two filters, by its Fourier transform."""
    size = 2 * noise.size
    w = 2 * np.pi * np.fft.rfftfreq(size, dt)
    low = _LOW_CUT * omega
    soil = (omega**2 + 2j * damping * omega * w) / (omega**2 - w**2 + 2j * damping * omega * w)
    cut = -(w**2) / (low**2 - w**2 + 2j * _LOW_DAMPING * low * w)
    return np.fft.irfft(np.fft.rfft(noise, size) * soil * cut, size)[: noise.size]
