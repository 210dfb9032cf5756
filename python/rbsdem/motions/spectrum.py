"""Elastic response spectra."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem.errors import InputError

_MOST_DAMPING = 10.0
# An oscillator takes a step of a twentieth of its period: shorter periods only cost time.
_SHORTEST = 1e-4
_LONGEST = 1e4


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Peaks of elastic oscillators under a ground motion.

    Attributes
    ----------
    period : ndarray, shape (n,)
        Natural periods [s].
    damping : float
        Damping ratio.
    displacement, velocity : ndarray, shape (n,)
        Largest displacement [m] and velocity [m/s] relative to the ground.
    acceleration : ndarray, shape (n,)
        Largest absolute acceleration [m/s2].
    """

    period: Array
    damping: float
    displacement: Array
    velocity: Array
    acceleration: Array

    @property
    def pseudo_velocity(self) -> Array:
        """Displacement times the circular frequency [m/s], shape (n,); zero at period 0."""
        return self._times_frequency(1)

    @property
    def pseudo_acceleration(self) -> Array:
        """Displacement times the squared circular frequency [m/s2], shape (n,); PGA at period 0."""
        return np.where(self.period > 0, self._times_frequency(2), self.acceleration)

    def _times_frequency(self, power: int) -> Array:
        moving = self.period > 0
        omega = 2 * np.pi / np.where(moving, self.period, 1.0)
        return np.where(moving, omega**power * self.displacement, 0.0)


def response_spectrum(
    acceleration: Array, dt: float, periods: ArrayLike | None, damping: float
) -> Spectrum:
    """Return the spectrum of accelerations [m/s2] at steps dt [s]; see `GroundMotion.spectrum`."""
    if periods is None:
        periods = np.geomspace(0.02, 10.0, 100)
    period = _arguments.finite_vector(periods, "periods")
    if period.size == 0:
        raise InputError("periods is empty; give at least one natural period in s")
    allowed = (period == 0) | ((period >= _SHORTEST) & (period <= _LONGEST))
    if not allowed.all():
        first = int(np.flatnonzero(~allowed)[0])
        raise InputError(
            f"periods: value {first + 1} of {period.size} is {period[first]:g} s; natural periods "
            f"are 0 or from {_SHORTEST:g} to {_LONGEST:g} s"
        )
    ratio = _arguments.number(damping, "damping")
    if not 0 <= ratio <= _MOST_DAMPING:
        raise InputError(
            f"damping = {ratio:g} must be from 0 to {_MOST_DAMPING:g}; it is a ratio, not a "
            "percentage"
        )
    return Spectrum(period, ratio, *_core.spectrum(acceleration, dt, period, ratio))
