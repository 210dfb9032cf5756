"""Synthetic ground motions, so that everything runs without records that have a licence.

White noise, its strength over time shaped as that of an earthquake, goes through the ground of
Kanai (1957) and Tajimi (1960), with the filter of Clough and Penzien (1975) that leaves no velocity
behind. They are like each other as records of one magnitude and distance are: peak, frequency and
damping of the ground, rise and length of the strong part are drawn for each.
"""

from __future__ import annotations

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.motions.motion import STANDARD_GRAVITY, GroundMotion

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
    number, start = _arguments.whole(n, "n"), _arguments.whole(seed, "seed")
    step = _arguments.number(dt, "dt")
    if not 1 <= number <= _MOST:
        raise InputError(f"synthetic: n = {n} must be from 1 to {_MOST}")
    if start < 0:
        raise InputError(f"synthetic: seed = {seed} must be 0 or more")
    if not 1e-4 <= step <= 0.05:
        raise InputError(f"synthetic: dt = {step:g} s must be from 0.0001 to 0.05 s")
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
