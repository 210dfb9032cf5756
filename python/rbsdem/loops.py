"""Measured loops against computed ones: peaks, energy, stiffness and the error left between them.

Every function takes plain arrays in any consistent units (SI inside rbsdem); row i of each array is
the same moment of the test. The definitions, used for every comparison that rbsdem reports:

path
    The two curves are interpolated linearly at `N_POINTS` points spaced evenly along the path of
    what drives the model: the sum of the absolute displacement steps when displacement drives, of
    the force steps when force drives. So an error counts by how far the test went, not by how many
    points somebody digitised there.
nrmse
    Root mean square of (model - test) over those points, over the largest absolute measured value
    of all rows. 0 is a copy of the test; predicting nothing at all gives less than 1.
peak
    The row of the largest absolute force, the first of equals.
energy
    Work of the force over the whole path, by the trapezium rule over the rows. A path that does not
    end at zero force also holds a little energy that the column would give back.
stiffness
    Initial stiffness: secant from the origin to the first point at half of the peak force, that
    point interpolated between two rows. A comparison takes half of the test's peak for both curves:
    at half of its own, a model that overshoots would be asked after yield. The first rows of a
    digitised test are too noisy for a tangent: one specimen of the paper shows 1.8 times its gross
    elastic stiffness there, two show force at no displacement.

Driven by force, a model cannot miss the force: it misses the displacement. `loop_metrics` compares
forces at equal displacements, `displacement_metrics` displacements at equal forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem.errors import InputError

__all__ = [
    "N_POINTS",
    "DisplacementMetrics",
    "Loop",
    "LoopMetrics",
    "displacement_metrics",
    "energy",
    "loop_metrics",
    "resample",
    "secant_stiffness",
    "summarise",
]

N_POINTS = 2000
"""Points along the path at which the error between two curves is taken."""

Vector = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Loop:
    """One force-displacement curve in numbers.

    Attributes
    ----------
    peak_force : float
        Largest absolute force, unsigned [N].
    displacement_at_peak : float
        Displacement at that row, signed [m].
    peak_displacement : float
        Largest absolute displacement, unsigned [m].
    energy : float
        Work of the force over the path [J].
    stiffness : float
        Secant stiffness on the first crossing of half of the peak force (of the test's peak force
        in a comparison) [N/m]; NaN if the curve never carries that force, or if that point is at no
        displacement or at one of the other sign.
    """

    peak_force: float
    displacement_at_peak: float
    peak_displacement: float
    energy: float
    stiffness: float


@dataclass(frozen=True, slots=True)
class _Ratios:
    """What both comparisons share: the two curves in numbers and their ratios, model over test."""

    test: Loop
    model: Loop

    @property
    def peak_ratio(self) -> float:
        """Peak force, model over test."""
        return _ratio(self.model.peak_force, self.test.peak_force)

    @property
    def displacement_at_peak_ratio(self) -> float:
        """Displacement at the peak force, model over test, without their signs."""
        return _ratio(abs(self.model.displacement_at_peak), abs(self.test.displacement_at_peak))

    @property
    def peak_displacement_ratio(self) -> float:
        """Largest absolute displacement, model over test."""
        return _ratio(self.model.peak_displacement, self.test.peak_displacement)

    @property
    def energy_ratio(self) -> float:
        """Energy, model over test; NaN unless the test dissipates."""
        return _ratio(self.model.energy, self.test.energy) if self.test.energy > 0 else float("nan")

    @property
    def stiffness_ratio(self) -> float:
        """Initial stiffness, model over test."""
        return _ratio(self.model.stiffness, self.test.stiffness)


@dataclass(frozen=True, slots=True)
class LoopMetrics(_Ratios):
    """A model driven through the measured displacements, against the measured force.

    Attributes
    ----------
    test, model : Loop
        The two curves in numbers.
    nrmse : float
        Root mean square force error along the displacement path, over the measured peak force.
    rms_error : float
        The same as a force [N].
    rms_best : float
        What `nrmse` would be after the model's force is multiplied by the one factor that makes it
        least: the error of shape, without that of strength.
    end_ratio : float
        Root mean square force of the model over that of the test in the last quarter of the path.
        Above 1 the model misses degradation. NaN if the test carries no force there.
    """

    nrmse: float
    rms_error: float
    rms_best: float
    end_ratio: float


@dataclass(frozen=True, slots=True)
class DisplacementMetrics(_Ratios):
    """A model driven by the measured force, against the measured displacement.

    Attributes
    ----------
    test, model : Loop
        The two curves in numbers.
    nrmse : float
        Root mean square displacement error along the force path, over the measured peak
        displacement.
    rms_error : float
        The same as a length [m].
    """

    nrmse: float
    rms_error: float


def loop_metrics(
    displacement: ArrayLike, test_force: ArrayLike, model_force: ArrayLike
) -> LoopMetrics:
    """Compare the forces of a test and of a model that went through the same displacements.

    Parameters
    ----------
    displacement : array_like, shape (n,)
        Displacement of the top in the order of the test [m]; drives the model.
    test_force : array_like, shape (n,)
        Measured net horizontal force [N].
    model_force : array_like, shape (n,)
        Horizontal force of the model [N].

    Returns
    -------
    LoopMetrics
        Both curves in numbers, their ratios and the error between them.

    Raises
    ------
    InputError
        If the arrays differ in length, hold less than two rows or a number that is not finite, or
        if the test does not move or has no force.

    Examples
    --------
    >>> d = [0.0, 1.0, 0.0, -1.0, 0.0]
    >>> m = loop_metrics(d, [0.0, 2.0, -1.0, -2.0, 1.0], [0.0, 4.0, -2.0, -4.0, 2.0])
    >>> m.peak_ratio, m.energy_ratio, round(m.rms_best, 12)
    (2.0, 2.0, 0.0)
    """
    names = "displacement", "test_force", "model_force"
    d, test, model = _rows(names, displacement, test_force, model_force)
    peak = _peak(test, "test_force")
    path, _, t, m = resample(d, d, test, model, name="displacement")
    error = m - t
    rms = _rms(error)
    model_square = float(np.sum(m * m))
    factor = float(np.sum(m * t)) / model_square if model_square > 0 else 0.0
    last = path >= 0.75 * path[-1]
    return LoopMetrics(
        test=_summary(d, test),
        model=_summary(d, model, float(np.max(np.abs(test)))),
        nrmse=rms / peak,
        rms_error=rms,
        rms_best=_rms(factor * m - t) / peak,
        end_ratio=_ratio(_rms(m[last]), _rms(t[last])),
    )


def displacement_metrics(
    force: ArrayLike, test_displacement: ArrayLike, model_displacement: ArrayLike
) -> DisplacementMetrics:
    """Compare the displacements of a test and of a model that carried the same forces.

    Parameters
    ----------
    force : array_like, shape (n,)
        Lateral force in the order of the test [N]; drives the model.
    test_displacement : array_like, shape (n,)
        Measured displacement of the top [m].
    model_displacement : array_like, shape (n,)
        Displacement of the model's top [m].

    Returns
    -------
    DisplacementMetrics
        Both curves in numbers, their ratios and the error between them.

    Raises
    ------
    InputError
        If the arrays differ in length, hold less than two rows or a number that is not finite, or
        if the force does not change or the test has no displacement.
    """
    names = "force", "test_displacement", "model_displacement"
    f, test, model = _rows(names, force, test_displacement, model_displacement)
    peak = _peak(test, "test_displacement")
    _, t, m = resample(f, test, model, name="force")
    rms = _rms(m - t)
    return DisplacementMetrics(
        test=_summary(test, f),
        model=_summary(model, f),
        nrmse=rms / peak,
        rms_error=rms,
    )


def summarise(
    displacement: ArrayLike, force: ArrayLike, *, reference_force: float | None = None
) -> Loop:
    """Put one force-displacement curve into numbers.

    Parameters
    ----------
    displacement, force : array_like, shape (n,)
        The curve, row by row [m, N].
    reference_force : float, optional
        Peak force at half of which the secant stiffness is taken, above 0 [N]; the curve's own
        without it.

    Returns
    -------
    Loop
        Peaks, energy and stiffness.

    Raises
    ------
    InputError
        If the arrays differ in length, hold less than two rows or a number that is not finite, or
        if `reference_force` is not a positive number.
    """
    d, f = _rows(("displacement", "force"), displacement, force)
    return _summary(d, f, reference_force)


def energy(displacement: ArrayLike, force: ArrayLike) -> float:
    """Work of the force over the path by the trapezium rule [J].

    Parameters
    ----------
    displacement, force : array_like, shape (n,)
        The curve, row by row [m, N].

    Returns
    -------
    float
        The work; over a closed loop, the energy dissipated.

    Raises
    ------
    InputError
        If the arrays differ in length, hold less than two rows or a number that is not finite.
    """
    d, f = _rows(("displacement", "force"), displacement, force)
    return _energy(d, f)


def secant_stiffness(
    displacement: ArrayLike,
    force: ArrayLike,
    *,
    level: float = 0.5,
    reference_force: float | None = None,
) -> float:
    """Slope from the origin to the first point at a share of the peak force [N/m].

    Parameters
    ----------
    displacement, force : array_like, shape (n,)
        The curve, row by row [m, N].
    level : float, default 0.5
        Share of the reference force, above 0 and up to 1.
    reference_force : float, optional
        What `level` is a share of, above 0 [N]; the curve's own largest absolute force without it.

    Returns
    -------
    float
        The stiffness; NaN if the curve never carries that force, if the point is at no
        displacement or at one of the other sign, or if there is no force at all.

    Raises
    ------
    InputError
        If the arrays differ in length, hold less than two rows or a number that is not finite, or
        if `level` or `reference_force` is outside its range.
    """
    d, f = _rows(("displacement", "force"), displacement, force)
    return _secant(d, f, level, reference_force)


def resample(
    driver: ArrayLike, *curves: ArrayLike, n: int = N_POINTS, name: str = "driver"
) -> tuple[Vector, ...]:
    """Interpolate curves at points spaced evenly along the path of what drives them.

    Parameters
    ----------
    driver : array_like, shape (rows,)
        What drives the model; its path is the sum of its absolute steps.
    *curves : array_like, shape (rows,)
        What to interpolate. Of rows without a step of the driver only the first counts.
    n : int, default 2000
        How many points.
    name : str
        What messages call the driver.

    Returns
    -------
    tuple of ndarray, shape (n,)
        The path at the points, then each curve there.

    Raises
    ------
    InputError
        If lengths differ, a number is not finite, the driver never moves, or n is below 2.
    """
    names = (name, *(f"curve {i + 1}" for i in range(len(curves))))
    d, *ys = _rows(names, driver, *curves)
    if n < 2:
        raise InputError(f"resample: n = {n} points; give at least 2")
    path = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(d)))))
    if not path[-1] > 0:
        raise InputError(f"{name} is {d[0]:g} in every row; a loop needs a {name} that changes")
    at = np.linspace(0.0, path[-1], n)
    moved = np.concatenate(([True], np.diff(path) > 0))
    return (at, *(np.interp(at, path[moved], y[moved]) for y in ys))


def _rows(names: tuple[str, ...], *values: ArrayLike) -> list[Vector]:
    """Return the arrays as vectors of one length, or say which one is wrong and how."""
    out: list[Vector] = []
    for name, value in zip(names, values, strict=True):
        try:
            array = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"{name} is not an array of numbers: {error}") from error
        if array.ndim != 1:
            raise InputError(
                f"{name} has shape {array.shape}; give one number for each row, shape (n,)"
            )
        if array.size < 2:
            raise InputError(f"{name} has {array.size} rows; a loop needs at least 2")
        if out and array.size != out[0].size:
            raise InputError(
                f"{name} has {array.size} rows, {names[0]} has {out[0].size}; they must be equal"
            )
        bad = np.flatnonzero(~np.isfinite(array))
        if bad.size:
            raise InputError(
                f"{name} is {array[bad[0]]} in row {bad[0]} (counted from 0); "
                f"remove the rows that are not finite"
            )
        out.append(array)
    return out


def _peak(values: Vector, name: str) -> float:
    peak = float(np.max(np.abs(values)))
    if not peak > 0:
        raise InputError(f"{name} is 0 in every row; there is nothing to compare with")
    return peak


def _summary(d: Vector, f: Vector, reference_force: float | None = None) -> Loop:
    at = int(np.argmax(np.abs(f)))
    return Loop(
        peak_force=float(abs(f[at])),
        displacement_at_peak=float(d[at]),
        peak_displacement=float(np.max(np.abs(d))),
        energy=_energy(d, f),
        stiffness=_secant(d, f, 0.5, reference_force),
    )


def _energy(d: Vector, f: Vector) -> float:
    return float(np.sum(0.5 * (f[1:] + f[:-1]) * np.diff(d)))


def _secant(d: Vector, f: Vector, level: float, reference_force: float | None) -> float:
    if not 0 < level <= 1:
        raise InputError(f"level = {level}; give a share of the peak force above 0 and up to 1")
    size = np.abs(f)
    largest = float(np.max(size))
    reference = largest if reference_force is None else float(reference_force)
    if reference_force is not None and not 0 < reference < float("inf"):
        raise InputError(f"reference_force = {reference_force}; give a positive force")
    target = level * reference
    if not 0 < target <= largest:
        return float("nan")
    i = int(np.argmax(size >= target))
    at, force = float(d[i]), float(f[i])
    # A row before on the other side of zero force is no end to interpolate from.
    if i > 0 and f[i] * f[i - 1] >= 0 and size[i] != size[i - 1]:
        share = (target - size[i - 1]) / (size[i] - size[i - 1])
        at = float(d[i - 1] + share * (d[i] - d[i - 1]))
        force = float(np.sign(f[i])) * target
    if at == 0 or force / at <= 0:
        return float("nan")
    return float(force / at)


def _rms(values: Vector) -> float:
    return float(np.sqrt(np.mean(values * values)))


def _ratio(model: float, test: float) -> float:
    return model / test if test != 0 else float("nan")
