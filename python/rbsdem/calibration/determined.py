"""How well a test determines the parameters that were fitted to it.

J is the derivative of the error vector with respect to the places of the parameters, at the fit.
Parameters whose columns of J are almost parallel cannot be distinguished: their correlation is that
of (J'J)^-1.

The errors of a model at neighbouring points of a path are not independent, so s^2 (J'J)^-1, which
assumes that they are, would be far too small. The G half cycles of the test are taken as
independent instead: (J'J)^-1 (sum over half cycles of J_g'e_g e_g'J_g) (J'J)^-1 G/(G - 1),
the covariance for clustered errors (Liang & Zeger 1986, Biometrika 73; Cameron & Miller 2015,
Journal of Human Resources 50).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbsdem._types import Array
from rbsdem.calibration.misfit import Misfit, rms
from rbsdem.calibration.search import AT_BOUND, refused
from rbsdem.errors import InputError

#: Change of a parameter for which its sensitivity is reported.
CHANGE = 0.1

#: Share of the peak force by which a parameter must change some force; otherwise it is refused.
NO_EFFECT = 1e-6

#: Root mean square change of the force over the peak, for CHANGE, below which a parameter is
#: hardly determined.
LITTLE_EFFECT = 1e-3

#: Correlation above which two parameters cannot be distinguished.
TOO_ALIKE = 0.95

#: Steps for a derivative, as shares of the distance between the bounds. The second is used if
#: nothing changes with the first.
_STEPS = 0.005, 0.05


@dataclass(frozen=True, slots=True, eq=False)
class Determined:
    """How well the test determines each parameter, in the order of the parameters.

    Attributes
    ----------
    standard_error : ndarray, shape (p,)
        Standard error of the value, in its unit; infinite if no force changes with it, NaN if there
        are no more half cycles than parameters.
    effect : ndarray, shape (p,)
        Root mean square change of the force over the measured peak, if the parameter changes by
        10 %.
    rise : ndarray, shape (p,)
        Increase of the loss if the parameter alone changes by 10 %, in the direction of the larger
        increase.
    correlation : ndarray, shape (p, p)
        Correlation of the estimates; NaN for a parameter with which no force changes.
    at_bound : tuple of str
        "low", "high" or "".
    """

    standard_error: Array
    effect: Array
    rise: Array
    correlation: Array
    at_bound: tuple[str, ...]


def without_effect(misfit: Misfit, places: list[Array]) -> list[str]:
    """Return the names of the parameters that change no force between their bounds.

    Parameters
    ----------
    misfit : Misfit
        The misfit.
    places : list of ndarray, shape (p,)
        Points from which each parameter alone is moved to its bounds.
    """
    idle = list(range(len(misfit.free)))
    for base in places:
        base_vector = misfit.vector(base)
        if refused(base_vector):
            continue
        for i in list(idle):
            ends = [_moved(base, i, place) for place in (0.0, 0.5, 1.0)]
            for vector in misfit.vectors(ends):
                if not refused(vector) and np.max(np.abs(vector - base_vector)) > NO_EFFECT:
                    idle.remove(i)
                    break
        if not idle:
            break
    return [list(misfit.free)[i] for i in idle]


def refuse(misfit: Misfit, names: list[str]) -> None:
    """Raise `InputError` for parameters without effect."""
    if not names:
        return
    ranges = ", ".join(
        f"{name} from {misfit.free[name].low:g} to {misfit.free[name].high:g}" for name in names
    )
    largest = float(np.max(np.abs(misfit.target.displacement)))
    raise InputError(
        f"calibrate: the test cannot determine {ranges}: no force changes over displacements up "
        f"to {largest:g} m. Leave {'it' if len(names) == 1 else 'them'} out of free, or move the "
        "bounds"
    )


def determine(misfit: Misfit, places: Array) -> Determined:
    """Return how well the test determines the parameters at a fit, shape (p,)."""
    free = list(misfit.free.values())
    size = len(free)
    vector = misfit.vector(places)
    jacobian = _derivatives(misfit, places, vector)
    per_place = np.array(
        [one.per_place(one.at(place)) for one, place in zip(free, places, strict=True)]
    )
    values = np.array([one.at(place) for one, place in zip(free, places, strict=True)])
    seen = np.sqrt(np.mean(jacobian**2, axis=0)) > NO_EFFECT
    covariance = np.full((size, size), np.nan)
    correlation = np.full((size, size), np.nan)
    if seen.any():
        part = np.ix_(seen, seen)
        inverse = _inverse(jacobian[:, seen])
        spread = np.sqrt(np.diag(inverse))
        correlation[part] = inverse / np.outer(spread, spread)
        covariance[part] = _clustered(jacobian[:, seen], vector, inverse, _groups(misfit, vector))
    np.fill_diagonal(correlation, 1.0)
    error = np.sqrt(np.diag(covariance)) * np.abs(per_place)
    error[~seen] = np.inf
    effect, rise = _sensitivity(misfit, places, values, vector)
    at_bound = tuple(
        "low" if place < AT_BOUND else "high" if place > 1 - AT_BOUND else "" for place in places
    )
    return Determined(error, effect, rise, correlation, at_bound)


def warnings_of(names: list[str], found: Determined) -> list[str]:
    """Return a line for everything that the test does not determine."""
    lines = []
    for i, name in enumerate(names):
        if np.isinf(found.standard_error[i]):
            lines.append(
                f"{name}: no force of the test changes with it at the fit; other values fit just "
                "as well"
            )
        elif found.effect[i] < LITTLE_EFFECT:
            lines.append(
                f"{name}: hardly determined, {CHANGE:.0%} more or less change the force by "
                f"{found.effect[i]:.1e} of its peak"
            )
        if found.at_bound[i]:
            lines.append(f"{name}: ended at its {found.at_bound[i]} bound")
    for i, name in enumerate(names):
        for j in range(i):
            alike = found.correlation[i, j]
            if abs(alike) > TOO_ALIKE:
                lines.append(
                    f"{names[j]} and {name}: correlation {alike:+.3f}, the test does not "
                    "distinguish them; fix one of them"
                )
    return lines


def _moved(places: Array, i: int, place: float) -> Array:
    moved = places.copy()
    moved[i] = place
    return moved


def _derivatives(misfit: Misfit, places: Array, vector: Array) -> Array:
    """Return the derivative of the vector with respect to each place."""
    jacobian = np.zeros((vector.size, places.size))
    for i in range(places.size):
        for step in _STEPS:
            jacobian[:, i] = _derivative(misfit, places, vector, i, step)
            if rms(jacobian[:, i]) > NO_EFFECT:
                break
    return jacobian


def _derivative(misfit: Misfit, places: Array, vector: Array, i: int, step: float) -> Array:
    """Return central differences; one-sided ones at a bound or next to a refused column."""
    ends = np.clip([places[i] - step, places[i] + step], 0.0, 1.0)
    sides = [(end, misfit.vector(_moved(places, i, end))) for end in ends]
    known = [(end, other) for end, other in sides if not refused(other)]
    if len(known) < 2:
        known.append((places[i], vector))
    if len(known) < 2 or known[0][0] == known[1][0]:
        return np.zeros(vector.size)
    return np.asarray((known[1][1] - known[0][1]) / (known[1][0] - known[0][0]))


def _inverse(jacobian: Array) -> Array:
    """Return (J'J)^-1, which is large but finite for parallel columns."""
    scale = np.sqrt(np.sum(jacobian**2, axis=0))
    scaled = jacobian / scale
    values, vectors = np.linalg.eigh(scaled.T @ scaled)
    inverse = (vectors / np.maximum(values, 1e-12)) @ vectors.T
    return np.asarray(inverse / np.outer(scale, scale))


def _groups(misfit: Misfit, vector: Array) -> Array:
    """Return the half cycle of each element; each ratio of a balanced loss has one of its own."""
    groups = misfit.target.half_cycle
    extra = vector.size - groups.size
    return np.concatenate((groups, groups[-1] + 1 + np.arange(extra))) if extra else groups


def _clustered(jacobian: Array, error: Array, inverse: Array, groups: Array) -> Array:
    several = np.unique(groups)
    if several.size <= jacobian.shape[1]:
        return np.full(inverse.shape, np.nan)
    scores = np.array([error[groups == g] @ jacobian[groups == g] for g in several])
    # As a square, so that round-off leaves no variance below 0.
    root = scores @ inverse
    return root.T @ root * (several.size / (several.size - 1.0))


def _sensitivity(
    misfit: Misfit, places: Array, values: Array, vector: Array
) -> tuple[Array, Array]:
    """Return change of force and growth of the loss for 10 % more or less of each parameter.

    For a parameter that may be zero or negative it is 10 % of the distance between its bounds.
    """
    effect, rise = np.zeros(places.size), np.full(places.size, np.nan)
    base = rms(vector)
    for i, one in enumerate(misfit.free.values()):
        whole = values[i] if one.logarithmic else one.high - one.low
        step = CHANGE * whole
        for value in (values[i] - step, values[i] + step):
            moved = _moved(places, i, one.place(min(max(value, one.low), one.high)))
            if moved[i] == places[i]:
                continue
            other = misfit.vector(moved)
            if refused(other):
                continue
            effect[i] = max(effect[i], rms(other - vector))
            rise[i] = np.fmax(rise[i], rms(other) - base)
    return effect, rise
