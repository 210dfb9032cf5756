"""The hazard of a site: how often a year an intensity is exceeded."""

from __future__ import annotations

import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem._optional import need_scipy
from rbsdem.errors import AccuracyWarning, InputError

#: A frequency of which more than this part comes from beyond the given points is warned of.
_BEYOND = 0.1


@dataclass(frozen=True, eq=False, init=False)
class Hazard:
    """A hazard curve, a power law between its points and beyond them.

    Parameters
    ----------
    intensity : array_like, shape (m,)
        Intensities, ascending, in the unit of the fragility: m/s2 for accelerations.
    frequency : array_like, shape (m,)
        Mean annual frequencies of their exceedance, descending.

    Raises
    ------
    InputError
        With a line for everything that is wrong.
    """

    intensity: Array
    frequency: Array

    def __init__(self, intensity: ArrayLike, frequency: ArrayLike) -> None:
        im = np.array(_core.finite_vector(intensity, "hazard: intensity"))
        rate = np.array(_core.finite_vector(frequency, "hazard: frequency"))
        faults = []
        if im.size != rate.size or im.size < 2:
            faults.append(
                f"hazard: {im.size} intensities and {rate.size} frequencies; give two or more, one "
                "frequency for each intensity"
            )
        if not (im > 0).all() or not (np.diff(im) > 0).all():
            faults.append("hazard: intensities must be above 0 and ascend strictly")
        if not (rate > 0).all() or not (np.diff(rate) < 0).all():
            faults.append("hazard: frequencies must be above 0 and descend strictly")
        if faults:
            raise InputError("\n".join(faults))
        for name, values in (("intensity", im), ("frequency", rate)):
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def exceeded(self, intensity: ArrayLike) -> Array:
        """Return the mean annual frequency with which intensities are exceeded."""
        u = np.log(np.asarray(intensity, dtype=float))
        x, y = np.log(self.intensity), np.log(self.frequency)
        place = np.clip(np.searchsorted(x, u) - 1, 0, x.size - 2)
        slope = np.diff(y) / np.diff(x)
        return np.asarray(np.exp(y[place] + slope[place] * (u - x[place])))

    def frequency_of(self, mu: float, beta: float) -> float:
        """Return how often a year a limit state is reached whose fragility is lognormal.

        The integral of the fragility over the hazard, in closed form for each power law.

        Parameters
        ----------
        mu, beta : float
            Mean and standard deviation of the logarithm of the capacity.

        Warns
        -----
        AccuracyWarning
            If more than a tenth comes from intensities beyond the points of the hazard.
        """
        special = need_scipy("special")
        x, y = np.log(self.intensity), np.log(self.frequency)
        k = -np.diff(y) / np.diff(x)
        # lambda = exp(y0 - k (u - x0)); the outer laws go on beyond the points.
        ends = np.concatenate([[-np.inf], x[1:-1], [np.inf]])
        parts = [
            _part(special, k[i], y[i] + k[i] * x[i], ends[i], ends[i + 1], mu, beta)
            for i in range(k.size)
        ]
        beyond = _part(special, k[0], y[0] + k[0] * x[0], -np.inf, x[0], mu, beta)
        beyond += _part(special, k[-1], y[-1] + k[-1] * x[-1], x[-1], np.inf, mu, beta)
        total = float(sum(parts))
        if beyond > _BEYOND * total:
            warnings.warn(
                f"hazard: {100 * beyond / total:.0f} % of the mean annual frequency come from "
                f"intensities beyond its points ({self.intensity[0]:g} to "
                f"{self.intensity[-1]:g}); give it a wider range",
                AccuracyWarning,
                stacklevel=3,
            )
        return total


def _part(
    special: object, k: float, c: float, low: float, high: float, mu: float, beta: float
) -> float:
    """Return the integral of Phi((u - mu)/beta) k exp(c - k u) from low to high."""
    ndtr = special.ndtr  # type: ignore[attr-defined]

    def antiderivative(u: float) -> float:
        # By parts; the rest is a normal density moved by k beta^2.
        moved = np.exp(c - k * mu + 0.5 * (k * beta) ** 2)
        rest = moved * ndtr((u - mu) / beta + k * beta)
        if np.isinf(u):
            return float(rest)
        return float(rest - ndtr((u - mu) / beta) * np.exp(c - k * u))

    return antiderivative(high) - antiderivative(low)
