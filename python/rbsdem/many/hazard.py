"""The hazard of a site: how often a year an intensity is exceeded."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments
from rbsdem._arguments import Array
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
        im = np.array(_arguments.finite_vector(intensity, "hazard: intensity"))
        rate = np.array(_arguments.finite_vector(frequency, "hazard: frequency"))
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
        u = np.log(_arguments.vector(intensity, "intensity", shape="any"))
        x, y = np.log(self.intensity), np.log(self.frequency)
        place = np.clip(np.searchsorted(x, u) - 1, 0, x.size - 2)
        slope = np.diff(y) / np.diff(x)
        return np.asarray(np.exp(y[place] + slope[place] * (u - x[place])))

    def frequency_of(self, mu: float, beta: float) -> float:
        """Return how often a year a limit state is reached whose fragility is lognormal.

        The integral of the hazard over the density of the capacity, in closed form for each power
        law: a sum of positive terms, each taken where its digits are.

        Parameters
        ----------
        mu, beta : float
            Mean and standard deviation of the logarithm of the capacity; beta above 0.

        Warns
        -----
        AccuracyWarning
            If more than a tenth comes from intensities beyond the points of the hazard.

        Raises
        ------
        InputError
            If mu is not finite, or beta not above 0.
        """
        mu, beta = _arguments.number(mu, "hazard: mu"), _arguments.number(beta, "hazard: beta")
        if not (np.isfinite(mu) and np.isfinite(beta) and beta > 0):
            raise InputError(
                f"hazard: mu = {mu:g}, beta = {beta:g}: the capacity needs a finite mu, and a beta "
                "above 0"
            )
        from scipy import special  # noqa: PLC0415

        x, y = np.log(self.intensity), np.log(self.frequency)
        slope = np.diff(y) / np.diff(x)

        def part(low: float, high: float, segment: int) -> float:
            start = x[segment], y[segment]
            return _part(special, low, high, (*start, slope[segment]), mu, beta)

        # The outer laws go on beyond the points.
        with np.errstate(over="ignore"):
            inside = [part(x[i], x[i + 1], i) for i in range(slope.size)]
            before, behind = part(-np.inf, x[0], 0), part(x[-1], np.inf, -1)
        total = before + sum(inside) + behind
        # Of intensities, not of capacities: those beyond a point fail with all capacities below it.
        failed = special.ndtr((x[[0, -1]] - mu) / beta) * self.frequency[[0, -1]]
        beyond = before - failed[0] + behind + failed[1]
        share = beyond / total if 0.0 < total < np.inf else float(total > 0.0)
        if share > _BEYOND:
            warnings.warn(
                f"hazard: {100 * share:.0f} % of the mean annual frequency come from "
                f"intensities beyond its points ({self.intensity[0]:g} to "
                f"{self.intensity[-1]:g}); give it a wider range",
                AccuracyWarning,
                stacklevel=3,
            )
        return float(total)


def _part(
    special: Any, low: float, high: float, law: tuple[float, float, float], mu: float, beta: float
) -> float:
    """Return the integral of exp(y + s (u - x)) over the density of ln capacity, low to high.

    The product is a normal density about mu + s beta^2. Where both ends lie on one side of it, each
    end is the product there times Mills' ratio, and no large exponents cancel.
    """
    x, y, s = law
    ends = [(end - mu) / beta - s * beta for end in (low, high)]
    if ends[0] < 0 < ends[1]:
        peak = y + s * (mu + 0.5 * s * beta**2 - x)
        # The peak lies between: of two tails that are missing none is the larger part.
        return float(np.exp(peak) * (special.ndtr(ends[1]) - special.ndtr(ends[0])))
    sign = 1.0 if ends[0] >= 0 else -1.0

    def tail(end: float, place: float) -> float:
        if np.isinf(end):
            return 0.0
        product = np.exp(y + s * (end - x) - 0.5 * ((end - mu) / beta) ** 2)
        return float(0.5 * product * special.erfcx(sign * place / np.sqrt(2.0)))

    return sign * (tail(low, ends[0]) - tail(high, ends[1]))
