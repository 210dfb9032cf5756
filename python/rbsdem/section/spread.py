"""How far a prediction may be off: bands of the force along a path, from tests that were left out.

Three things are not known of a column that nobody tested: how strong it is, how stiff, and how fast
it degrades. Their scatter is that of the tests which the fit did not see, from laboratory to
laboratory and from test to test (`Scatter`). Samples of it (Sobol points) go through the model: the
force times a factor, the displacement over a factor, and the parameters of degradation times one.
The bands of the samples are then widened by one number so that 80 % of the points of left-out tests
lie within (conformal prediction), because a model is wrong in more ways than three. The number is
another for columns that come near their shear strength, which are predicted worse.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass, replace
from statistics import NormalDist
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core, _views
from rbsdem._core import Array
from rbsdem.analysis import cyclic
from rbsdem.column import Column
from rbsdem.comparison import strength_loss
from rbsdem.comparison.metrics import work
from rbsdem.errors import AccuracyWarning, InputError, SolveError
from rbsdem.section.scatter import SCATTER, Scatter

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rbsdem.section.model import LayeredColumn

__all__ = ["Interval", "Spread", "near_shear", "sobol", "spread"]

#: The shares between which a band lies.
_LOW, _HIGH = 0.1, 0.9

#: Largest force over shear strength between which a column comes near failing in shear.
_NEAR = 0.7, 0.95

#: Parameters of degradation, and whether more of them is more of it.
_DEGRADATION = {
    "fatigue": 1,
    "wear": 1,
    "shear_decay": 1,
    "shear_endurance": -1,
    "core_softening": 1,
    "cover_softening": 1,
}


@dataclass(frozen=True, slots=True)
class Interval:
    """A number with the interval that holds it in 80 % of left-out tests.

    Attributes
    ----------
    lower, value, upper : float
        NaN where the model does not say it, as the drift at a loss that does not come.
    """

    lower: float
    value: float
    upper: float

    def __str__(self) -> str:
        return f"{self.value:.4g} ({self.lower:.4g} to {self.upper:.4g})"


@dataclass(frozen=True, eq=False)
class Spread:
    """A prediction along a path with its 80 % band.

    Attributes
    ----------
    displacement : ndarray, shape (m,)
        The path [m].
    force : ndarray, shape (m,)
        The prediction [N]; zero behind its end, where the column has failed.
    lower, upper : ndarray, shape (m,)
        The band [N].
    samples : ndarray, shape (n, m)
        Forces of the samples, before the band was widened [N].
    peak_force, energy, drift_at_loss : Interval
        Largest force [N], work [J], drift ratio at which 20 % of the strength is lost.
    remarks : tuple of str
        Where the column is outside the range of the tests that the parameters were fitted to.
    """

    displacement: Array
    force: Array
    lower: Array
    upper: Array
    samples: Array
    peak_force: Interval
    energy: Interval
    drift_at_loss: Interval
    remarks: tuple[str, ...]

    @property
    def width(self) -> float:
        """Mean width of the band along the path, over the largest predicted force."""
        step = np.abs(np.diff(self.displacement))
        gap = self.upper - self.lower
        mean = float(step @ (gap[1:] + gap[:-1])) / (2 * float(step.sum()))
        return mean / float(np.max(np.abs(self.force)))

    def plot(self, test: Any = None, ax: Axes | None = None, **line: Any) -> Axes:
        """Draw band and prediction along the path, and a test over them.

        Parameters
        ----------
        test : optional
            A measured test with the same rows.
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.
        **line
            Properties of the prediction's line.
        """
        return _views.view(self, "plot", test, ax, **line)


def spread(
    column: LayeredColumn,
    displacement: ArrayLike,
    *,
    samples: int = 16,
    scatter: Scatter | None = None,
) -> Spread:
    """Predict a path with its band; see `rbsdem.section.model.LayeredColumn.spread`."""
    number = _core.whole(samples, "samples")
    if number < 8:
        raise InputError(f"samples = {samples}; a band needs at least 8")
    version = column.recipe.parameters.version if column.recipe else ""
    found = scatter or SCATTER.get(version)
    if found is None:
        raise InputError(
            f"spread: nobody has left tests out of version {version!r}; there are bands for "
            f"{', '.join(SCATTER)}"
        )
    d = _core.finite_vector(displacement, "displacement")
    if d.size < 2 or not np.any(np.diff(d)):
        raise InputError("spread: the displacement does not change; give a path")
    remarks = column.outside
    if remarks:
        warnings.warn(f"spread: {'; '.join(remarks)}", AccuracyWarning, stacklevel=3)
    force = _force(column, d)
    rows = []
    for strength, stiffness, degradation in sobol(number):
        factor = math.exp(found.degradation * degradation)
        other = _degraded(column, factor)
        # A column that is softer by a factor is where the other is at a smaller displacement.
        path = d * math.exp(found.stiffness * stiffness)
        rows.append(math.exp(found.strength * strength) * _force(other, path))
    sampled = np.array(rows)
    peak = float(np.max(np.abs(force)))
    low, high = np.quantile(sampled, (_LOW, _HIGH), axis=0)
    # Nominally equal specimens differ by this much of their peak even so.
    least = found.twins * peak
    sheared = near_shear(column, peak)
    widen = _between(found.force, sheared)
    upper = force + widen * (np.maximum(high - force, 0.0) + least)
    lower = force - widen * (np.maximum(force - low, 0.0) + least)
    return Spread(
        displacement=d,
        force=force,
        lower=lower,
        upper=upper,
        samples=sampled,
        peak_force=_interval(peak, found.peak, sheared),
        energy=_interval(float(work(d, force)[-1]), found.energy, sheared),
        drift_at_loss=_interval(strength_loss(d, force) / column.height, found.drift, sheared),
        remarks=remarks,
    )


def near_shear(column: Column, peak: float) -> float:
    """Return 0 for a column whose largest force is 0.7 of its shear strength or less, 1 at 0.95.

    Parameters
    ----------
    column : Column
        With the shear spring of the layered model at its foot.
    peak : float
        Largest force [N].
    """
    strength = getattr(column.shear[0], "f_y", math.inf)
    low, high = _NEAR
    return min(max((peak / strength - low) / (high - low), 0.0), 1.0)


def _between(ends: tuple[float, float], share: float) -> float:
    return ends[0] + share * (ends[1] - ends[0])


def _interval(
    value: float, factors: tuple[tuple[float, float], tuple[float, float]], share: float
) -> Interval:
    lower, upper = (_between(ends, share) for ends in zip(*factors, strict=True))
    return Interval(lower * value, value, upper * value)


def _degraded(column: LayeredColumn, factor: float) -> Column:
    """Return the column with faster degradation; what a column limits is limited, not refused."""
    recipe = column.recipe
    assert recipe is not None
    now = recipe.parameters.values
    values = {name: now[name] * factor**way for name, way in _DEGRADATION.items()}
    other = replace(recipe, parameters=recipe.parameters.with_values(**values))
    return replace(column, recipe=other, **other.made)


def _force(column: Column, displacement: Array) -> Array:
    """Return the lateral force along a path; zero behind the end of the analysis."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AccuracyWarning)
        try:
            found = cyclic(column, displacement=displacement).force
        except SolveError as stopped:
            found = np.empty(0) if stopped.result is None else stopped.result.force[:-1]
    force = np.zeros(displacement.size)
    found = found[: displacement.size]
    force[: found.size] = np.where(np.isfinite(found), found, 0.0)
    return force


def sobol(number: int) -> Array:
    """Return standard normal numbers from the first Sobol points in three dimensions.

    Parameters
    ----------
    number : int
        How many points; powers of two fill the space evenly.

    Returns
    -------
    ndarray, shape (number, 3)
        Quantiles of the points (Sobol 1967; direction numbers of Joe and Kuo 2008), each in the
        middle of its cell.
    """
    bits = max(1, (number - 1).bit_length())
    normal = NormalDist()
    points = np.empty((number, 3))
    for place, first in enumerate(((), (1,), (1, 3))):
        directions = _directions(first, bits)
        x = 0
        for i in range(number):
            points[i, place] = normal.inv_cdf((x + 0.5) / 2**bits)
            x ^= directions[((~i) & (i + 1)).bit_length() - 1] if i + 1 < 2**bits else 0
    return points


def _directions(first: Sequence[int], bits: int) -> list[int]:
    """Return direction numbers of the polynomials 1, x + 1 and x^2 + x + 1."""
    numbers = list(first) or [1] * bits
    degree = len(first)
    for k in range(len(numbers), bits):
        new = numbers[k - degree] ^ (numbers[k - degree] << degree)
        if degree == 2:
            new ^= numbers[k - 1] << 1
        numbers.append(new)
    return [m << (bits - 1 - k) for k, m in enumerate(numbers[:bits])]
