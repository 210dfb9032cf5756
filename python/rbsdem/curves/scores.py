"""The scores of a model against a test; the definitions are those of `rbsdem.curves`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, ArrayLike, DataFrame
from rbsdem.curves.envelope import strength_loss
from rbsdem.curves.metrics import (
    Curve,
    HalfCycles,
    Loop,
    PathPoints,
    columns,
    half_cycles,
    loop_of,
    pair,
    ratio,
    rms,
    tip_rows,
)
from rbsdem.errors import InputError, warn

_RATIOS = ("peak_ratio", "energy_ratio", "stiffness_ratio", "end_ratio")
SCORES = ("nrmse", *_RATIOS, "rms_best", "path_fraction", "nrmse_reached")
"""Names of the scores, in the order of tables."""

#: Columns of half-cycles in the table of a comparison, with the unit in the name.
_CYCLE_COLUMNS = {"peak_force": "_N", "energy": "_J", "stiffness": "_N/m", "damping": ""}

# Displacements of model and test that differ by less than this share of the largest are the same:
# with exact rotations the displacement is solved for.
_SAME = 1e-6

# Forces so many times apart are in two units; a poor model is not.
_UNLIKELY = 100.0

# Ratios of less than this share of the path are not given.
_ENOUGH = 0.5


class _Ratios:
    """The ratios of two curves, model over test."""

    __slots__ = ()

    test: Loop
    model: Loop

    @property
    def _enough(self) -> bool:
        """Whether so much of the path was reached that ratios of the whole have a meaning."""
        return True

    @property
    def peak_ratio(self) -> float:
        """Largest absolute force, model over test.

        NaN, as the next two, if less than half of the path was reached.
        """
        return ratio(self.model.peak_force, self.test.peak_force) if self._enough else math.nan

    @property
    def energy_ratio(self) -> float:
        """Work along the path, model over test; NaN unless the test dissipates."""
        known = self._enough and self.test.energy > 0
        return ratio(self.model.energy, self.test.energy) if known else math.nan

    @property
    def stiffness_ratio(self) -> float:
        """Secant stiffness at 70 % of the curve's own peak force, model over test."""
        return ratio(self.model.stiffness, self.test.stiffness) if self._enough else math.nan

    @property
    def displacement_at_peak_ratio(self) -> float:
        """Absolute displacement at the peak force, model over test."""
        return ratio(abs(self.model.displacement_at_peak), abs(self.test.displacement_at_peak))

    @property
    def peak_displacement_ratio(self) -> float:
        """Largest absolute displacement, model over test."""
        return ratio(self.model.peak_displacement, self.test.peak_displacement)


@dataclass(frozen=True, repr=False, eq=False)
class Comparison(_Ratios, Tabular):
    """A model that was driven through the displacements of a test, against the force of the test.

    Attributes
    ----------
    name : str
        Name of the test.
    displacement : ndarray, shape (m,)
        Displacement of the top [m].
    test_force, model_force : ndarray, shape (m,)
        Lateral forces [N]; that of the model is NaN from the first row that it did not reach.
    height : float
        Height to which drifts relate [m]; NaN if it is not known.
    rows : int
        Number of rows that the model reached.
    test, model : Loop
        The two curves in numbers, over the rows that the model reached.
    nrmse : float
        Root mean square error over the largest force of the test; what was not reached counts as 1.
    path_fraction : float
        Share of the path that the model reached.
    nrmse_reached : float
        `nrmse` over that share alone.
    end_ratio : float
        Root mean square force in the last quarter of the path, model over test. Above 1 the model
        misses degradation. NaN unless the whole path was reached.
    rms_best : float
        The `nrmse_reached` that would result if the force of the model were multiplied by the
        factor that makes it least: the error of shape, without that of strength.
    """

    name: str
    displacement: Array
    test_force: Array
    model_force: Array
    height: float
    rows: int
    test: Loop
    model: Loop
    nrmse: float
    path_fraction: float
    nrmse_reached: float
    end_ratio: float
    rms_best: float

    @property
    def _enough(self) -> bool:
        return self.path_fraction >= _ENOUGH

    @property
    def scores(self) -> dict[str, float]:
        """The scores by name, in the order of `SCORES`."""
        return {name: getattr(self, name) for name in SCORES}

    @cached_property
    def test_drift_at_loss(self) -> float:
        """Drift at which the test has lost 20 % of its strength; NaN if it does not lose so much.

        On the envelope of the side that loses it first; see `rbsdem.curves.strength_loss`.
        """
        return strength_loss(self.displacement, self.test_force) / self.height

    @cached_property
    def model_drift_at_loss(self) -> float:
        """Drift at which the model has lost 20 % of its strength, over the rows it reached."""
        return strength_loss(*self.model_curve) / self.height

    @property
    def model_curve(self) -> tuple[Array, Array]:
        """Displacement [m] and force [N] of the model, over the rows that it reached."""
        return self.displacement[: self.rows], self.model_force[: self.rows]

    @cached_property
    def test_cycles(self) -> HalfCycles:
        """Half-cycles of the test."""
        return half_cycles(self.displacement, self.test_force, tips=self._tips)

    @cached_property
    def model_cycles(self) -> HalfCycles:
        """Half-cycles of the model, as far as it reached their tips."""
        return half_cycles(*self.model_curve, tips=self._tips[self._tips < self.rows])

    @cached_property
    def _tips(self) -> np.ndarray:
        return tip_rows(self.displacement, self.test_force)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame with a row for each half-cycle, test and model side by side.

        Rows that the model did not reach are NaN.
        """
        test, model = self.test_cycles, self.model_cycles
        columns: dict[str, Any] = {
            "cycle": [f"{1 + i // 2}{'ab'[i % 2]}" for i in range(len(test))],
            "displacement_m": test.displacement,
            "drift": test.displacement / self.height,
        }
        for name, unit in _CYCLE_COLUMNS.items():
            reached = np.full(len(test), np.nan)
            reached[: len(model)] = getattr(model, name)[: len(test)]
            columns[f"test_{name}{unit}"] = getattr(test, name)
            columns[f"model_{name}{unit}"] = reached
        return data_frame(columns)

    def __repr__(self) -> str:
        parts = [f"{name} {value:.3f}" for name, value in self.scores.items()]
        drifts = (self.test_drift_at_loss, self.model_drift_at_loss)
        lost = ", ".join("none" if math.isnan(drift) else f"{drift:.4f}" for drift in drifts)
        return f"{self.name}: {', '.join(parts)}; drift at 20 % loss (test, model): {lost}"


@dataclass(frozen=True, slots=True)
class DisplacementMetrics(_Ratios):
    """A model that carried the measured forces, against the measured displacement.

    Attributes
    ----------
    test, model : Loop
        The two curves in numbers.
    nrmse : float
        Root mean square displacement error along the force path, over the largest displacement of
        the test.
    rms_error : float
        The same as a length [m].
    """

    test: Loop
    model: Loop
    nrmse: float
    rms_error: float


def compare(result: Curve, test: Curve, *, height: float | None = None) -> Comparison:
    """Compare a column that was driven through the displacements of a test with the test.

    Parameters
    ----------
    result : Result or pair of array_like
        What `rbsdem.cyclic(column, displacement=test.displacement)` returns, or the `result` of its
        `SolveError`; or displacement [m] and force [N], the force NaN where the analysis stopped.
    test : MeasuredTest, PeerTest or pair of array_like
        Displacement [m] and net horizontal force [N], row by row. The force of a `PeerTest` is
        taken as it stands; `rbsdem.peer.Specimen.test` turns it into the net force.
    height : float, optional
        Height to which drifts relate [m]; by default that of the test, or of the model's top.

    Returns
    -------
    rbsdem.curves.scores.Comparison
        Scores, drift at 20 % strength loss of both, half-cycles, figure.

    Raises
    ------
    InputError
        If the rows of the two do not belong together, if a value of the test is not a finite
        number, or if the test does not move or has no force.

    Examples
    --------
    >>> d = [0.0, 1e-3, 0.0, -1e-3, 0.0]
    >>> f = [0.0, 2e3, -1e3, -2e3, 1e3]
    >>> scores = compare((d, [2 * force for force in f]), (d, f))
    >>> scores.peak_ratio, scores.energy_ratio, round(scores.rms_best, 12)
    (2.0, 2.0, 0.0)
    """
    d, f = columns(("test: displacement", "test: force"), *pair(test, "test"))
    largest = _largest(f, "test: force")
    force, rows = _model_rows(result, d)
    points = PathPoints(d, name="displacement")
    reached = points.reached(rows)
    t, m = points(f), points(np.where(np.arange(d.size) < rows, force, 0.0))
    error = np.where(reached, (m - t) / largest, 1.0)
    nrmse_reached = best = end = math.nan
    if np.count_nonzero(reached) > 1:
        square = float(np.sum(m[reached] ** 2))
        factor = float(np.sum(m[reached] * t[reached])) / square if square > 0 else 0.0
        nrmse_reached = rms(error[reached])
        best = rms(factor * m[reached] - t[reached]) / largest
    if reached.all():
        last = points.path >= 0.75 * points.path[-1]
        end = ratio(rms(m[last]), rms(t[last]))
    loops = loop_of(d[:rows], f[:rows]), loop_of(d[:rows], force[:rows])
    of_model = float(np.max(np.abs(force[:rows]), initial=0.0))
    if of_model > 0 and not 1 / _UNLIKELY < of_model / largest < _UNLIKELY:
        warn(
            f"compare: the largest force is {of_model:.4g} N in the model and {largest:.4g} N in "
            f"the test, {max(of_model / largest, largest / of_model):.4g} times apart; both are in "
            "N (1 kN is 1000)"
        )
    scores = rms(error), float(np.mean(reached)), nrmse_reached, end, best
    name, height = str(getattr(test, "name", "test")), _height(height, test, result)
    return Comparison(name, d, f, force, height, rows, *loops, *scores)


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
        If the arrays differ in length, hold fewer than two rows, a value is not a finite number,
        or if the force does not change or the test has no displacement.
    """
    names = "force", "test_displacement", "model_displacement"
    f, test, model = columns(names, force, test_displacement, model_displacement)
    largest = _largest(test, "test_displacement")
    points = PathPoints(f, name="force")
    error = rms(points(model - test))
    return DisplacementMetrics(
        test=loop_of(test, f), model=loop_of(model, f), nrmse=error / largest, rms_error=error
    )


def _largest(values: Array, name: str) -> float:
    """Return the largest absolute value, by which errors are divided; refuse 0."""
    largest = float(np.max(np.abs(values)))
    if not largest > 0:
        raise InputError(f"{name} is 0 in every row; there is nothing to compare with")
    return largest


def _model_rows(result: Any, d: Array) -> tuple[Array, int]:
    """Return the forces of the model at the rows of the test, NaN behind the last one reached."""
    model_d, model_f = (
        _arguments.vector(values, f"result: {name}")
        for name, values in zip(("displacement", "force"), pair(result, "result"), strict=True)
    )
    if model_d.shape != model_f.shape:
        raise InputError(
            f"result: force has {model_f.size} rows, displacement has {model_d.size}; they must be "
            "equal"
        )
    n = min(model_d.size, d.size)
    known = np.isfinite(model_d[:n]) & np.isfinite(model_f[:n])
    reached = n if known.all() else int(np.argmin(known))
    away = np.abs(model_d[:reached] - d[:reached]) > _SAME * np.max(np.abs(d))
    rows = int(np.argmax(away)) if away.any() else reached
    # The last good state of a path that broke off lies between two rows: one row may be off.
    stopped = getattr(result, "summary", {}).get("status", "failed") != "completed"
    if model_d.size > d.size or rows < reached - 1 or (rows < d.size and not stopped):
        raise InputError(
            f"result has {model_d.size} rows, the test {d.size}; the first {rows} displacements "
            "agree: drive the column through test.displacement, every row kept "
            "(rbsdem.curves.displacement_metrics is for columns driven by force)"
        )
    force = np.full(d.size, np.nan)
    force[:rows] = model_f[:rows]
    return force, rows


def _height(height: float | None, test: Any, result: Any) -> float:
    """Return the height given, that of the test, or that of the model; NaN without any [m]."""
    if height is not None:
        return _arguments.number(height, "height", above=0, unit="m")
    if getattr(test, "height", None):
        return float(test.height)
    top = getattr(result, "top", None)
    return float(top[0, 1]) if top is not None and len(top) else math.nan
