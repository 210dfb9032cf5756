"""How far a prediction may be off: bands of the force along a path, from tests that were left out.

Three things are not known of a column that nobody tested: how strong it is, how stiff, and how fast
it degrades. Their scatter is that of the tests which the fit did not see, from laboratory to
laboratory and from test to test (`Scatter`). Samples of it (Sobol points) are forces of the model:
the force times a factor, the displacement over a factor, and the parameters of degradation times
one. The model is run for three values each of stiffness and degradation; at each row of the path a
surface through the nine forces, quadratic in the logarithms of both factors, gives those of the
samples. Their bands are then widened by one number so that 80 % of the points of left-out tests lie
within (conformal prediction), because a model is wrong in more ways than three. The number is
another for columns that come near their shear strength, squat or slender; outside the range of the
tests the band is wider by a factor.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from rbsdem import _arguments, _package
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike
from rbsdem.curves.envelope import strength_loss
from rbsdem.curves.metrics import PathPoints, work
from rbsdem.errors import InputError, warn
from rbsdem.model.column import Column
from rbsdem.model.shape import Section
from rbsdem.run.response import reached_force
from rbsdem.run.rig import friction, rig_force
from rbsdem.section.curvature import RANGE
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.parameters import VERSION
from rbsdem.section.strength import shear_sizes

LEAST, MOST = 8, 4096
"""Fewest and most samples of a band."""

#: Stiffnesses and degradations for which the model is run, in standard deviations. Bands of 16
#: samples are then as wide as if all went through the model (`studies/spread_table.py --surface`).
_PLACES = -1.2, 0.0, 1.2

#: The shares between which a band lies.
_LOW, _HIGH = 0.1, 0.9

#: Largest force over shear strength between which a column comes near failing in shear.
_NEAR = 0.7, 0.95

#: Shear span over depth between which a column that fails in shear goes over from squat to slender.
_SLENDER = 2.0, 3.0

#: Least work of a loop, over what its force moves without regard to signs, to which the interval of
#: its work is in proportion: that of the tests is 0.17 and more.
_LEAST_WORK = 0.15

#: Ratios of bars or ties below this count as this one: the logarithm of 0 is none.
_NONE = 1e-3

#: Differences of the values of `features_of` that count as a distance of 1.
_SCALES = (0.15, 0.4, 0.35, 0.4, 0.6)

#: Parameters of degradation with 1 where a larger value degrades faster, -1 where slower.
_FASTER = ("fatigue", "wear", "shear_decay", "core_softening", "cover_softening")
_DEGRADATION = dict.fromkeys(_FASTER, 1) | {"shear_endurance": -1}


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """Scatter of left-out tests about the model.

    Attributes
    ----------
    strength, stiffness, degradation : (float, float)
        Standard deviations of logarithms from laboratory to laboratory, and from test to test
        within one: force, flexibility of the whole column, rate of degradation.
    shape : float
        What the band has above and below the samples before it is widened, over the largest force:
        nominally equal specimens differ, and loops have a shape of their own.
    force : (float, float, float)
        By what the band is widened: far from the shear strength, and at it of squat and of slender
        columns.
    peak, energy, drift : ((float, float), (float, float), (float, float))
        Ends of the 80 % intervals of largest force, work and drift at 20 % loss, over what is
        predicted, likewise.
    outside : (float, float, float, float), optional
        By what the band is wider outside the range of the tests, and the logarithms of the ends of
        the three intervals, in their order.
    small : (float, float, float, float), optional
        The same for columns whose depth is below the range of the tests.
    """

    strength: tuple[float, float]
    stiffness: tuple[float, float]
    degradation: tuple[float, float]
    shape: float
    force: tuple[float, float, float]
    peak: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    energy: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    drift: tuple[tuple[float, float], tuple[float, float], tuple[float, float]]
    outside: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    small: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)


@cache
def scatter_of_tests(*, walls: bool = False) -> Scatter:
    """Return the scatter of tests about the model with the parameters of its version.

    That of walls is found by `studies/walls_measured.py`; degradation and work of walls have that
    of columns, as too few loops of walls are known.

    `studies/spread_table.py` finds the numbers on tests that the fit did not see, and prints how
    many points of such tests lie within the bands.
    """
    fitted = json.loads(_package.text("wall_spread.json" if walls else "layered_spread.json"))
    return Scatter(**{name: _frozen(value) for name, value in fitted.items()})


def _frozen(value: Any) -> Any:
    """Return lists of json as tuples, also those within lists."""
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


@dataclass(frozen=True)
class Learned:
    """A column as the tests of its laboratory make it.

    Attributes
    ----------
    tests : int
        Number of given tests.
    column : LayeredColumn
        The column with the numbers of the laboratory.
    strength : float
        Factor of its force.
    friction : float
        Force against the motion of the top beyond the friction of rigs, over the largest force.
    second_order : float
        Force in proportion to the displacement, over P/L: axial load over height.
    left : float
        What the tests leave of the scatter of the loop.
    """

    tests: int
    column: LayeredColumn
    strength: float
    friction: float
    second_order: float
    left: float

    def force(self, displacement: Array) -> Array:
        """Return the force that the laboratory will measure along a path [N].

        Parameters
        ----------
        displacement : ndarray, shape (m,)
            The path [m].
        """
        force = self.strength * path_force(self.column, displacement, rig=True)
        by_friction, by_load = forces_of_rig(self.column, displacement, force)
        return np.asarray(force + self.friction * by_friction + self.second_order * by_load)


@dataclass(frozen=True, slots=True)
class Interval:
    """A number with the interval that holds it in 80 % of left-out tests.

    Attributes
    ----------
    lower, value, upper : float
        The value is NaN and the upper end infinite where the model does not come to it along the
        path, as the drift at a loss that does not come.
    """

    lower: float
    value: float
    upper: float

    def __str__(self) -> str:
        if math.isnan(self.value):
            return f"above {self.lower:.4g}"
        return f"{self.value:.4g} ({self.lower:.4g} to {self.upper:.4g})"

    def holds(self, value: float) -> bool:
        """Whether a measured value is in the interval.

        Parameters
        ----------
        value : float
            The value; NaN, which is that of a test that did not come to it, is in an interval
            without an upper end alone.
        """
        if math.isnan(value):
            return self.upper == math.inf
        return self.lower <= value <= self.upper


@dataclass(frozen=True, repr=False, eq=False)
class Band(Tabular):
    """A prediction along a path with its 80 % band.

    Attributes
    ----------
    displacement : ndarray, shape (m,)
        The path [m].
    force : ndarray, shape (m,)
        The prediction [N]; zero behind its end, where the column has failed.
    median : ndarray, shape (m,)
        Median of the samples at each row [N].
    lower, upper : ndarray, shape (m,)
        The band [N].
    samples : ndarray, shape (n, m)
        Forces of the samples, before the band was widened [N].
    peak_force, energy, drift_at_loss : Interval
        Largest force [N], work [J], drift ratio at which 20 % of the strength is lost.
    near_shear : float
        How near the column is to its shear strength, 0 to 1, on which the width depends.
    warnings : tuple of str
        Where the column is outside the range of the tests that the parameters were fitted to.
    """

    _columns = ("displacement m", "force N", "median N", "lower N", "upper N")

    displacement: Array
    force: Array
    median: Array
    lower: Array
    upper: Array
    samples: Array
    peak_force: Interval
    energy: Interval
    drift_at_loss: Interval
    near_shear: float
    warnings: tuple[str, ...]

    def __repr__(self) -> str:
        rows, near = self.displacement.size, self.near_shear
        return f"<Band: {rows} rows, width {self.width:.2f}, near_shear {near:.2f}>"

    @property
    def width(self) -> float:
        """Mean width of the band along the path, over the largest predicted force."""
        step = np.abs(np.diff(self.displacement))
        gap = self.upper - self.lower
        mean = float(step @ (gap[1:] + gap[:-1])) / (2 * float(step.sum()))
        peak = float(np.max(np.abs(self.force)))
        return mean / peak if peak > 0 else math.nan

    def holds(self, test: Any) -> float:
        """Return the share of a measured loop that is within the band, along the path.

        Parameters
        ----------
        test : array_like of shape (m,), or a test
            Forces in the same rows [N].

        Raises
        ------
        InputError
            If it has other rows.
        """
        force = self.rows_of(test)
        at = PathPoints(self.displacement, name="displacement")
        inside = (at(self.lower) <= at(force)) & (at(force) <= at(self.upper))
        return float(np.mean(inside))

    def rows_of(self, test: Any) -> Array:
        """Return the forces of a test, or raise `InputError` if it has other rows.

        Parameters
        ----------
        test : array_like of shape (m,), or a test
            Forces in the rows of the path [N].
        """
        force = _arguments.finite_vector(getattr(test, "force", test), "test")
        if force.size != self.force.size:
            raise InputError(
                f"band: the test has {force.size} rows and the prediction {self.force.size}; "
                "predict the displacements of the test"
            )
        return force


def likeness(section: Section, height: float, axial_load: float) -> dict[str, float]:
    """Return the properties by which columns are compared.

    Parameters
    ----------
    section : Section
        Of the column.
    height : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    dict of str to float
        ``axial_load_ratio``, ``span_depth_ratio``, ``concrete_strength`` [Pa], and the mechanical
        ratios of the longitudinal bars, ``bar_ratio`` = A_s f_y/(A_g f'c), and of the ties in the
        direction of loading, ``tie_ratio`` = A_v f_yt/(b s f'c).
    """
    strength, sizes = section.concrete.fc, shear_sizes(section)
    bars = sum(area * steel.fy for _, area, steel in section.bars)
    return {
        "axial_load_ratio": axial_load / (section.gross_area * strength),
        "span_depth_ratio": height / section.depth,
        "concrete_strength": strength,
        "bar_ratio": bars / (section.gross_area * strength),
        "tie_ratio": sizes.tie_ratio * sizes.tie_yield / strength,
    }


def features_of(section: Section, height: float, axial_load: float) -> tuple[float, ...]:
    """Return the properties of `likeness` on the scale on which columns are compared.

    The axial load ratio, and logarithms of the others: of the concrete strength over 30 MPa.
    """
    axial, span, strength, bars, ties = likeness(section, height, axial_load).values()
    return axial, *map(math.log, (span, strength / 30e6, max(bars, _NONE), max(ties, _NONE)))


def distance(features: Sequence[float], others: Sequence[float]) -> float:
    """Return how far two columns are apart in what `features_of` has.

    Parameters
    ----------
    features, others : sequence of float
        Those of both columns. A distance of 1 is a difference of 0.15 in the axial load ratio, or
        a difference of logarithms: 0.4 for the shear span over the depth, 0.35 for the concrete
        strength, 0.4 for the mechanical ratio of the bars and 0.6 for that of the ties.
    """
    return math.dist(
        *(
            [x / scale for x, scale in zip(each, _SCALES, strict=True)]
            for each in (features, others)
        )
    )


def has_bands(version: str) -> bool:
    """Return whether the scatter of tests about a version of the parameters is known."""
    return version == VERSION


def band(
    column: LayeredColumn,
    displacement: ArrayLike,
    *,
    samples: int = 16,
    scatter: Scatter | None = None,
    learned: Learned | None = None,
    rig: bool = False,
    force: Array | None = None,
) -> Band:
    """Predict the force along a path, with the band that holds 80 % of left-out tests.

    Parameters
    ----------
    column : LayeredColumn
        The column.
    displacement : array_like, shape (m,)
        Displacement of the top [m].
    samples : int, optional
        Of how many samples of strength, stiffness and degradation the band is made; 8 or more,
        best a power of 2.
    scatter : Scatter, optional
        Another scatter than that of the version.
    learned : Learned, optional
        What tests of the laboratory say, by which prediction and band move and the band narrows.
    rig : bool, optional
        With the friction of the rig of a test (`rbsdem.run.rig.rig_force`), as in
        `rbsdem.peer.predict`, and whatever is `learned`; by default the force is the column's.
    force : ndarray, shape (m,), optional
        The force along the path as `path_force` finds it, where it is known, and nothing `learned`.

    Returns
    -------
    Band
        Prediction, band, intervals of largest force, work and drift at 20 % loss, warnings;
        `rbsdem.plot.band` draws it.

    Raises
    ------
    InputError
        If the column is not one of the layered model, the path does not change, or the scatter of
        its version is not known.

    Warns
    -----
    AccuracyWarning
        Where the column is outside the range of the tests.
    """
    remedy = "a column of rbsdem.section.column has bands; of other columns no tests are known"
    _arguments.instance(column, "band: column", LayeredColumn, remedy)
    number = _arguments.integer(samples, "samples")
    if not LEAST <= number <= MOST:
        raise InputError(f"samples = {samples} must be {LEAST} to {MOST}; 16 are enough")
    warnings = column.warnings
    if scatter is None:
        walls = column._drawing.section.shape == "wall"
        scatter, made = scatter_of_tests(walls=walls), column._drawing.parameters
        if not has_bands(made.version):
            raise InputError(
                f"band: no tests were left out of the fit of version {made.version!r}; there are "
                f"bands for {VERSION}, or give scatter="
            )
        if made.own:
            warnings = (*warnings, f"the band is that of {VERSION}, whose parameters changed")
    d = _arguments.finite_vector(displacement, "displacement")
    if d.size < 2 or not np.any(np.diff(d)):
        raise InputError("band: the displacement does not change; give a path")
    if warnings:
        warn(f"band: {'; '.join(warnings)}")
    base = column if learned is None else learned.column
    rig = _arguments.boolean(rig, "rig") or learned is not None
    force, left = path_force(base, d, rig=rig) if force is None else force, 1.0
    sampled = sample(base, d, force, scatter, number, rig=rig)
    if learned is not None:
        sampled -= force
        force, left = learned.force(d), learned.left
        sampled += force
    peak = float(np.max(np.abs(force)))
    near = near_shear(column, peak)
    features = Features(near, slender(column._drawing.height, column._drawing.section.depth))
    up, down = half_band(force, sampled, scatter)
    wider, *powers = _beyond(column, scatter)
    # Single numbers are known less well than the loop, the largest force no better than before:
    # judged by `studies/sisters_table.py`.
    powers[1:] = [math.sqrt(left) * by for by in powers[1:]]
    widen = left * wider * between(scatter.force, features)
    values, height = numbers(d, force, column.height), column.height
    moved = float(np.abs(np.diff(d)) @ np.abs(0.5 * (force[1:] + force[:-1])))
    return Band(
        displacement=d,
        force=force,
        median=np.median(sampled, axis=0),
        lower=force - widen * down,
        upper=force + widen * up,
        samples=sampled,
        peak_force=_interval(values["peak"], scatter.peak, features, powers[0]),
        energy=_interval(
            values["energy"], scatter.energy, features, powers[1], scale=_LEAST_WORK * moved
        ),
        drift_at_loss=_interval(
            values["drift"], scatter.drift, features, powers[2], float(np.max(np.abs(d))) / height
        ),
        near_shear=near,
        warnings=warnings,
    )


def _beyond(column: LayeredColumn, scatter: Scatter) -> tuple[float, ...]:
    """Return by what bands and intervals are wider than inside the range of the tests.

    First the factor of the band, then powers of the factors of three intervals: largest force,
    work and drift.
    """
    # A column within the range has no warnings.
    if not column.warnings:
        return (1.0, 1.0, 1.0, 1.0)
    small = column._drawing.section.depth < RANGE["depth"][0] * (1.0 - 1e-9)
    return scatter.small if small else scatter.outside


def sample(
    column: LayeredColumn,
    displacement: Array,
    force: Array,
    scatter: Scatter,
    number: int,
    *,
    rig: bool = False,
) -> Array:
    """Return the forces of samples of strength, stiffness and degradation, shape (number, m) [N].

    Parameters
    ----------
    column : LayeredColumn
        The column.
    displacement : ndarray, shape (m,)
        The path [m].
    force : ndarray, shape (m,)
        Its own force along the path [N].
    scatter : Scatter
        Of a new laboratory: both standard deviations are in it.
    number : int
        How many.
    rig : bool, optional
        With the friction of the rig of a test.
    """
    drawing = column._drawing
    for name, made in drawing.fields_for(column.top).items():
        if getattr(column, name) != made:
            raise InputError(
                f"band: {name} of this column is not that of its model, whose scatter is known; "
                "change parameters by with_parameters"
            )
    # Scatter from laboratory to laboratory and from test to test, taken together.
    strength, stiffness, degradation = (
        math.hypot(*two) for two in (scatter.strength, scatter.stiffness, scatter.degradation)
    )
    forces = []
    for faster in _PLACES:
        changed = _degraded(column, math.exp(degradation * faster)) if faster else column
        for stiffer in _PLACES:
            # A column stiffer by a factor has at d the force of the model at d times the factor.
            path = displacement * math.exp(stiffness * stiffer)
            alone = not (faster or stiffer)
            forces.append(force if alone else path_force(changed, path, rig=rig))
    stronger, *places = _normal_points(number).T
    shares = np.einsum("nj,ni->nji", *(_shares(at) for at in reversed(places)))
    # Small products are done sooner without the threads of BLAS.
    samples = np.einsum("np,pm->nm", shares.reshape(number, -1), np.array(forces))
    return np.asarray(np.exp(strength * stronger)[:, None] * samples)


def _shares(at: Array) -> Array:
    """Return what each of `_PLACES` has in the parabola through all three, shape (m, 3)."""
    low, middle, high = (at - place for place in _PLACES)
    parts = np.column_stack((0.5 * middle * high, -low * high, 0.5 * low * middle))
    return np.asarray(parts / _PLACES[-1] ** 2)


@cache
def _normal_points(number: int) -> Array:
    """Return standard normal numbers from the first Sobol points in three dimensions.

    Each point is in the middle of its cell; powers of two fill the space evenly.
    """
    from scipy.stats import norm, qmc  # noqa: PLC0415

    bits = (number - 1).bit_length()
    points = qmc.Sobol(3, scramble=False).random_base2(bits)[:number]
    return np.asarray(norm.ppf(points + 0.5 / 2**bits))


def half_band(force: Array, samples: Array, scatter: Scatter) -> tuple[Array, Array]:
    """Return the band above and below a prediction before it is widened [N].

    Parameters
    ----------
    force : ndarray, shape (m,)
        The prediction [N].
    samples : ndarray, shape (n, m)
        Its samples [N].
    scatter : Scatter
        What it has for the shape of loops is in the band even without samples.
    """
    low, high = np.quantile(samples, (_LOW, _HIGH), axis=0)
    least = scatter.shape * float(np.max(np.abs(force)))
    return np.maximum(high - force, 0.0) + least, np.maximum(force - low, 0.0) + least


def numbers(displacement: Array, force: Array, height: float) -> dict[str, float]:
    """Return the numbers that have intervals: largest force [N], work [J], drift at 20 % loss.

    Parameters
    ----------
    displacement, force : ndarray, shape (m,)
        A loop [m, N].
    height : float
        Height to which the drift relates [m].
    """
    return {
        "peak": float(np.max(np.abs(force))),
        "energy": float(work(displacement, force)[-1]),
        "drift": strength_loss(displacement, force) / height,
    }


def near_shear(column: Column, peak: float) -> float:
    """Return 0 for a column whose largest force is 0.7 of its shear strength or less, 1 at 0.95.

    Parameters
    ----------
    column : Column
        With the shear spring of the layered model at its foot.
    peak : float
        Largest force [N].
    """
    foot = column.joints("shear")[0]
    strength = getattr(foot, "f_y", math.inf)
    strength = min(strength, getattr(foot, "f_y_neg", None) or strength)
    low, high = _NEAR
    return min(max((peak / strength - low) / (high - low), 0.0), 1.0)


class Features(NamedTuple):
    """How near a column is to its shear strength, and how slender it is, both 0 to 1."""

    near: float
    slender: float


def slender(span: float, depth: float) -> float:
    """Return 0 for a shear span of twice the depth or less, 1 from three times on.

    Parameters
    ----------
    span, depth : float
        [m].
    """
    low, high = _SLENDER
    return min(max((span / depth - low) / (high - low), 0.0), 1.0)


def between(ends: Sequence[Any], features: Features) -> Any:
    """Return the number of features: far from the shear strength; at it, squat; at it, slender."""
    far, squat, tall = ends
    return far + features.near * (squat + features.slender * (tall - squat) - far)


def _interval(
    value: float,
    factors: Sequence[tuple[float, float]],
    features: Features,
    power: float,
    least: float = math.nan,
    scale: float = 0.0,
) -> Interval:
    """Return a value with its interval; `least` is what it exceeds if it is not known (NaN).

    The ends are in proportion to the value, or to `scale` where that is more: a number that can
    come near zero is not known the better for it. Outside the range of the tests the logarithms of
    the factors are larger by `power`.
    """
    lower, upper = (between(ends, features) ** power for ends in zip(*factors, strict=True))
    if math.isnan(value):
        # No more is known than that it lies beyond, as far as the model is right.
        return Interval(min(lower, 1.0) * least, value, math.inf)
    size = max(abs(value), scale)
    return Interval(value + (lower - 1.0) * size, value, value + (upper - 1.0) * size)


def _degraded(column: LayeredColumn, factor: float) -> LayeredColumn:
    """Return the column with degradation that is faster by a factor."""
    now = column._drawing.parameters.values
    return changed_column(column, {name: now[name] * factor**w for name, w in _DEGRADATION.items()})


def changed_column(column: LayeredColumn, values: dict[str, float]) -> LayeredColumn:
    """Return a column with other parameters; values beyond its limits are cut, not refused.

    Parameters
    ----------
    column : LayeredColumn
        The column.
    values : dict of str to float
        Parameters of its model.
    """
    drawing = column._drawing
    other = replace(drawing, parameters=drawing.parameters.with_values(**values))
    return replace(column, drawing=other, **other.fields_for(column.top))


def forces_of_rig(column: LayeredColumn, displacement: Array, force: Array) -> tuple[Array, Array]:
    """Return friction as large as the largest force, and the second-order force, along a path.

    Parameters
    ----------
    column : LayeredColumn
        The column.
    displacement, force : ndarray, shape (m,)
        The path [m], and the force of the column along it [N].
    """
    way = friction(displacement, column.height)
    return way * np.max(np.abs(force)), column.axial_load / column.height * displacement


def path_force(column: Column, displacement: Array, *, rig: bool = False) -> Array:
    """Return the lateral force along a path; zero behind the end of the analysis.

    Parameters
    ----------
    column : Column
        The column.
    displacement : ndarray, shape (m,)
        The path [m].
    rig : bool, optional
        With the friction of the rig of a test.
    """
    force = np.zeros(displacement.size)
    reached, _ = reached_force(column, displacement)
    force[: reached.size] = reached
    if rig:
        force[: reached.size] += rig_force(column, displacement[: reached.size])
    return force
