"""A computed loop against the test that drove it: one set of scores for every comparison.

The definitions are those in which predictions of the tests of the PEER database are reported here:

path
    Both curves are interpolated linearly at `rbsdem.loops.N_POINTS` points spaced evenly along the
    path of displacement.
nrmse
    Root mean square of (model - test) over those points, over the largest absolute force of the
    test, F. What the analysis did not reach counts with an error of F, as much as no prediction at
    a peak: stopping early does not pay.
ratios
    Model over test, over the rows that both have; not given if less than half of the path was
    reached. The stiffness is the secant from the origin to the first crossing of 70 % of the
    curve's own largest force.

A test keeps its own peculiarities (`rbsdem.loops` says which): ratios of single tests scatter.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import _core, plot
from rbsdem._core import Array
from rbsdem.cycles import HalfCycles, half_cycles, strength_loss, tip_rows
from rbsdem.errors import InputError
from rbsdem.loops import energy, resample, secant_stiffness

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from rich.table import Table

    from rbsdem.peer import MeasuredTest, PeerTest
    from rbsdem.results import Result

__all__ = ["SCORES", "Comparison", "compare"]

SCORES = (
    "nrmse",
    "peak_ratio",
    "energy_ratio",
    "stiffness_ratio",
    "end_ratio",
    "rms_best",
    "done",
    "nrmse_done",
)
"""Names of the scores, in the order of tables."""

# The displacement of a row is that of the test; with exact rotations it is solved for.
_SAME = 1e-6


@dataclass(frozen=True, eq=False)
class Comparison:
    """Scores of a model that was driven through the displacements of a test.

    Attributes
    ----------
    name : str
        Name of the test.
    displacement : ndarray, shape (m,)
        Displacement of the top [m].
    test_force, model_force : ndarray, shape (m,)
        Lateral forces [N]; that of the model is NaN from the row on that it did not reach.
    height : float
        Height to which drifts relate [m]; NaN if it is not known.
    rows : int
        Rows that the model reached.
    nrmse : float
        Root mean square error over the largest force of the test; what was not reached counts as 1.
    done : float
        Share of the path that was reached.
    nrmse_done : float
        `nrmse` over that share alone.
    peak_ratio : float
        Largest absolute force.
    energy_ratio : float
        Work around the loops.
    stiffness_ratio : float
        Secant stiffness at 70 % of the curve's own largest force.
    end_ratio : float
        Root mean square force in the last quarter of the path: above 1 degradation was missed. NaN
        unless all was reached.
    rms_best : float
        `nrmse_done` if the model's force were multiplied by the best factor: the error of shape
        that is left without that of strength.
    """

    name: str
    displacement: Array
    test_force: Array
    model_force: Array
    height: float
    rows: int
    nrmse: float
    done: float
    nrmse_done: float
    peak_ratio: float
    energy_ratio: float
    stiffness_ratio: float
    end_ratio: float
    rms_best: float

    @property
    def scores(self) -> dict[str, float]:
        """The scores by name, in the order of `SCORES`."""
        return {name: getattr(self, name) for name in SCORES}

    @cached_property
    def test_drift_at_loss(self) -> float:
        """Drift at which the test has lost 20 % of its strength, by `rbsdem.cycles`; NaN if none.

        On the envelope of the side that loses it first.
        """
        return strength_loss(self.displacement, self.test_force) / self.height

    @cached_property
    def model_drift_at_loss(self) -> float:
        """The same of the model, over the rows that it reached."""
        reached = slice(self.rows)
        return strength_loss(self.displacement[reached], self.model_force[reached]) / self.height

    @cached_property
    def test_cycles(self) -> HalfCycles:
        """Half-cycles of the test."""
        return half_cycles(self.displacement, self.test_force, tips=self._tips)

    @cached_property
    def model_cycles(self) -> HalfCycles:
        """Half-cycles of the model, as many as it reached the tips of."""
        tips = self._tips[self._tips < self.rows]
        reached = slice(self.rows)
        return half_cycles(self.displacement[reached], self.model_force[reached], tips=tips)

    @cached_property
    def _tips(self) -> np.ndarray:
        return tip_rows(self.displacement, self.test_force)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the loop of the model over that of the test.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.

        Returns
        -------
        matplotlib.axes.Axes
            Millimetres and kilonewtons; drift ratios on top if the height is known.
        """
        reached = slice(self.rows)
        return plot.loops_over_test(
            (self.displacement[reached], self.model_force[reached]),
            (self.displacement, self.test_force),
            title=f"{self.name}\nNRMSE {self.nrmse:.3f}",
            height=self.height if self.height > 0 else None,
            ax=ax,
        )

    def table(self) -> Table:
        """Return the half-cycles as a table of rich, test and model side by side: mm, kN, kJ."""
        from rbsdem.accuracy.table import need_rich  # noqa: PLC0415

        rich = need_rich()
        table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
        units = "d\nmm", "Drift\n%", "Peak\nkN", "", "Energy\nkJ", "", "Secant\nkN/mm", ""
        for name in ("Cycle", *units, "Damping\n%", ""):
            table.add_column(name, justify="right", no_wrap=True)
        test, model = self.test_cycles, self.model_cycles
        kinds = (("peak_force", 1e-3), ("energy", 1e-3), ("stiffness", 1e-6), ("damping", 1e2))
        for i in range(len(test)):
            d = test.displacement[i]
            cells = [f"{1 + i // 2}{'ab'[i % 2]}", f"{d * 1e3:.1f}", f"{d / self.height * 1e2:.2f}"]
            for name, unit in kinds:
                cells.append(f"{getattr(test, name)[i] * unit:.3g}")
                cells.append(f"{getattr(model, name)[i] * unit:.3g}" if i < len(model) else "")
            table.add_row(*(cell.replace("nan", "-") for cell in cells))
        return table

    def __str__(self) -> str:
        parts = [f"{name} {value:.3f}" for name, value in self.scores.items()]
        drifts = (self.test_drift_at_loss, self.model_drift_at_loss)
        lost = ", ".join("none" if math.isnan(drift) else f"{drift:.4f}" for drift in drifts)
        return f"{self.name}: {', '.join(parts)}; drift at 20 % loss (test, model): {lost}"


def compare(
    result: Result | tuple[Any, Any],
    test: MeasuredTest | PeerTest | tuple[Any, Any],
    *,
    height: float | None = None,
) -> Comparison:
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
        Height to which drifts relate [m]; without it that of the test, or of the model's top.

    Returns
    -------
    Comparison
        Scores, drift at 20 % strength loss of both, half-cycles, figure.

    Raises
    ------
    InputError
        If the rows of the two do not belong together, if a number of the test is not finite, or if
        the test does not move or has no force.

    Examples
    --------
    >>> d = [0.0, 1e-3, 0.0, -1e-3, 0.0]
    >>> f = [0.0, 2e3, -1e3, -2e3, 1e3]
    >>> scores = compare((d, [2 * force for force in f]), (d, f))
    >>> scores.peak_ratio, scores.energy_ratio, round(scores.rms_best, 12)
    (2.0, 2.0, 0.0)
    """
    test_d, test_f = _arrays(test, "test")
    d = _core.finite_vector(test_d, "test: displacement")
    f = _core.finite_vector(test_f, "test: force")
    if d.shape != f.shape or d.size < 2:
        raise InputError(
            f"test: {d.size} displacements and {f.size} forces; give as many, at least 2"
        )
    if not np.max(np.abs(f)) > 0:
        raise InputError("test: force is 0 in every row; there is nothing to compare with")
    model, rows = _model_rows(result, d)
    return Comparison(
        name=str(getattr(test, "name", "test")),
        displacement=d,
        test_force=f,
        model_force=model,
        height=_height(height, test, result),
        rows=rows,
        **_scores(d, f, model, rows),
    )


def _scores(d: Array, f: Array, model: Array, rows: int) -> dict[str, float]:
    largest = float(np.max(np.abs(f)))
    nan = math.nan
    path, t, m = resample(d, f, np.where(np.arange(d.size) < rows, model, 0.0), name="displacement")
    # The last row reached, as the points along the path count it.
    end = float(np.sum(np.abs(np.diff(d[:rows])))) if rows else -1.0
    reached = path <= end * (1 + 1e-12)
    error = np.where(reached, (m - t) / largest, 1.0)
    out = {
        "nrmse": _rms(error),
        "done": float(np.mean(reached)),
        "nrmse_done": nan,
        "peak_ratio": nan,
        "energy_ratio": nan,
        "stiffness_ratio": nan,
        "end_ratio": nan,
        "rms_best": nan,
    }
    if np.count_nonzero(reached) > 1:
        square = float(np.sum(m[reached] ** 2))
        best = float(np.sum(m[reached] * t[reached])) / square if square > 0 else 0.0
        out["nrmse_done"] = _rms(error[reached])
        out["rms_best"] = _rms(best * m[reached] - t[reached]) / largest
    if out["done"] >= 0.5:
        both = d[:rows], f[:rows], model[:rows]
        out |= _ratios(*both)
    if out["done"] >= 1:
        last = path >= 0.75 * path[-1]
        out["end_ratio"] = _ratio(_rms(m[last]), _rms(t[last]))
    return out


def _ratios(d: Array, test: Array, model: Array) -> dict[str, float]:
    work = energy(d, test)
    return {
        "peak_ratio": _ratio(float(np.max(np.abs(model))), float(np.max(np.abs(test)))),
        "energy_ratio": energy(d, model) / work if work > 0 else math.nan,
        "stiffness_ratio": _ratio(
            secant_stiffness(d, model, level=0.7), secant_stiffness(d, test, level=0.7)
        ),
    }


def _model_rows(result: Any, d: Array) -> tuple[Array, int]:
    """Return the forces of the model at the rows of the test, NaN behind the last one reached."""
    model_d, model_f = (
        _core.vector(values, f"result: {name}")
        for name, values in zip(("displacement", "force"), _arrays(result, "result"), strict=True)
    )
    if model_d.shape != model_f.shape:
        raise InputError(
            f"result: {model_d.size} displacements and {model_f.size} forces; give as many"
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
            "(rbsdem.loops.displacement_metrics is for columns driven by force)"
        )
    force = np.full(d.size, np.nan)
    force[:rows] = model_f[:rows]
    return force, rows


def _arrays(curve: Any, name: str) -> tuple[Any, Any]:
    if hasattr(curve, "displacement") and hasattr(curve, "force"):
        return curve.displacement, curve.force
    try:
        displacement, force = curve
    except (TypeError, ValueError):
        raise InputError(
            f"{name} is neither an object with displacement and force nor a pair of the two"
        ) from None
    return displacement, force


def _height(height: float | None, test: Any, result: Any) -> float:
    if height is not None:
        value = _core.number(height, "height")
        if not 0 < value < math.inf:
            raise InputError(f"height = {height} m must be positive")
        return value
    if getattr(test, "height", None):
        return float(test.height)
    top = getattr(result, "top", None)
    return float(top[0, 1]) if top is not None and len(top) else math.nan


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values * values)))


def _ratio(model: float, test: float) -> float:
    return model / test if test != 0 else math.nan
