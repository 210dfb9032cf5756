"""The difference between a column and a measured loop, and the search that makes it least.

The force of a chain of straight lines is continuous in its parameters nearly everywhere, with kinks
where a spring takes another line, and the error has several minima. The search therefore consists
of a Latin hypercube over the bounds; least squares (scipy, trust region) from its best points with
coarse finite differences, which smooth the kinks; and finer differences from the best of them, the
last with the dogleg method, which can reach the bounds. docs/calibration.md compares it
with others.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.curves.metrics import N_POINTS, PathPoints, half_cycle_numbers, work
from rbsdem.errors import InputError
from rbsdem.model.column import Parameter
from rbsdem.model.frame import Structure
from rbsdem.run.result import reached_force

#: Points along the path of displacement at which the error is taken, as in a comparison.
POINTS = N_POINTS

#: Error of a refused column as a share of the measured peak: larger than that of any analysis.
REFUSED = 10.0

#: Errors that may be minimised.
LOSSES = ("nrmse", "balanced")

#: In "balanced", an error of 1 in the ratio of peaks, or of energies, counts as this nrmse.
RATIO_WEIGHT = 0.5


class Target:
    """A measured loop, ready to be compared with many computed ones.

    The error is that of `rbsdem.compare`: model minus test at points spaced evenly along the path
    of displacement, over the largest measured force. Its root mean square is the nrmse.

    Attributes
    ----------
    name : str
        Name of the test.
    displacement : ndarray, shape (rows,)
        Displacement of the top, row by row [m].
    force : ndarray, shape (rows,)
        Net horizontal force [N].
    peak : float
        Largest absolute force [N].
    half_cycle : ndarray of int, shape (POINTS,)
        Number of the half cycle to which each point belongs.
    """

    def __init__(self, test: Any) -> None:
        self.name = str(getattr(test, "name", "") or "the test")
        self.displacement, self.force = _loop(test)
        self.peak = float(np.max(np.abs(self.force)))
        if not self.peak > 0:
            raise InputError("calibrate: the force of the test is 0 in every row")
        if not np.any(np.diff(self.displacement)):
            raise InputError(
                f"calibrate: the displacement of the test is {self.displacement[0]:g} m in every "
                "row; a loop needs one that changes"
            )
        self._points = PathPoints(self.displacement, POINTS, "displacement")
        self._test = self._points(self.force)
        self.half_cycle = half_cycle_numbers(self.displacement)[self._points.before]

    def error(self, force: Array) -> Array:
        """Return (model - test)/peak at the points, and 1 beyond the rows that were reached.

        Parameters
        ----------
        force : ndarray, shape (m,)
            Force of the model at the first m rows [N].
        """
        reached = force.size
        if reached < self.force.size:
            force = np.concatenate((force, np.zeros(self.force.size - reached)))
        error = (self._points(force) - self._test) / self.peak
        if reached < self.force.size:
            error[~self._points.reached(reached)] = 1.0
        return error

    def ratios(self, force: Array) -> tuple[float, float]:
        """Return peak and energy of the model over those of the test, for the rows reached."""
        if force.size < 2:
            return 0.0, 0.0
        d, test = self.displacement[: force.size], self.force[: force.size]
        done = work(d, test)[-1]
        energy = float(work(d, force)[-1] / done) if done > 0 else 1.0
        largest = float(np.max(np.abs(test)))
        return (float(np.max(np.abs(force))) / largest if largest > 0 else 1.0), energy


class Misfit:
    """The error of a column as a function of the fractions of its free parameters, from 0 to 1.

    It counts the analyses and keeps the best point.

    Parameters
    ----------
    build : callable
        Makes the column from values by name, or raises `InputError`.
    free : mapping of str to Parameter
        The parameters that are free, in order.
    target : Target
        The test.
    loss : str
        One of `LOSSES`.
    jobs : int
        Number of analyses at the same time, in threads.
    show : callable
        Called with the number of analyses and the best loss so far, in words, after each.
    """

    def __init__(
        self,
        build: Callable[[Mapping[str, float]], Structure],
        free: Mapping[str, Parameter],
        target: Target,
        loss: str,
        jobs: int,
        show: Callable[[int, str], None],
    ) -> None:
        self._build, self.free, self.target, self.loss = build, dict(free), target, loss
        self._jobs, self._show = jobs, show
        self.evaluations = self.refused = self.failed = 0
        self.best, self.best_fractions = np.inf, self.start_fractions()
        self._pool: ThreadPoolExecutor | None = None

    def __enter__(self) -> Misfit:
        if self._jobs > 1:
            self._pool = ThreadPoolExecutor(min(self._jobs, 4 * (os.cpu_count() or 1)))
        return self

    def __exit__(self, *reason: object) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=True, cancel_futures=True)
            self._pool = None

    @property
    def size(self) -> int:
        """Length of the vector."""
        return POINTS + (2 if self.loss == "balanced" else 0)

    def start_fractions(self) -> Array:
        """Return the fractions of the initial values of the column."""
        return np.array([one.fraction(one.value) for one in self.free.values()])

    def values(self, fractions: Array) -> dict[str, float]:
        """Return the values by name."""
        return {
            name: one.at(float(fraction))
            for (name, one), fraction in zip(self.free.items(), fractions, strict=True)
        }

    def column(self, fractions: Array) -> Structure:
        """Return the column, or raise `InputError` if it is refused."""
        return self._build(self.values(fractions))

    def vector(self, fractions: Array) -> Array:
        """Return the error vector, whose mean square is to be minimised."""
        return self.vectors([fractions])[0]

    def vectors(self, several: Sequence[Array]) -> list[Array]:
        """Return the error vectors of several points, in their order."""
        run = self._pool.map if self._pool is not None and len(several) > 1 else map
        found = []
        for fractions, (vector, status) in zip(several, run(self._one, several), strict=True):
            found.append(vector)
            if status == "refused":
                self.refused += 1
                continue
            self.evaluations += 1
            self.failed += status == "failed"
            size = rms(vector)
            if size < self.best:
                self.best, self.best_fractions = size, np.array(fractions, dtype=float)
            self._show(self.evaluations, f"nrmse {self.best:.4f}")
        return found

    def _one(self, fractions: Array) -> tuple[Array, str]:
        try:
            force, failed = reached_force(self.column(fractions), self.target.displacement)
        except InputError:
            return np.full(self.size, REFUSED), "refused"
        return self._vector(force), "failed" if failed else "completed"

    def _vector(self, force: Array) -> Array:
        error = self.target.error(force)
        if self.loss == "nrmse":
            return error
        ratios = np.array(self.target.ratios(force))
        # Scaled so that each ratio has its share in the mean square over the points.
        return np.concatenate((error, RATIO_WEIGHT * np.sqrt(POINTS) * (ratios - 1.0)))


def rms(vector: Array) -> float:
    """Return the loss: the root of the sum of squares over the number of points."""
    return float(np.sqrt(vector @ vector / POINTS))


def _loop(test: Any) -> tuple[Array, Array]:
    """Return displacement and net horizontal force of a test or of a pair of arrays."""
    if hasattr(test, "displacement") and hasattr(test, "force"):
        test = test.displacement, test.force
    try:
        displacement, force = test
    except (TypeError, ValueError):
        raise InputError(
            f"calibrate: test: a {type(test).__name__} has no displacement and force; give a "
            "measured test, or a pair of arrays [m, N]"
        ) from None
    d = _arguments.finite_vector(displacement, "calibrate: displacement of the test")
    f = _arguments.finite_vector(force, "calibrate: force of the test")
    if d.size != f.size:
        raise InputError(
            f"calibrate: the test has {d.size} displacements and {f.size} forces; they must be "
            "equal in number"
        )
    if d.size < 3:
        raise InputError(f"calibrate: the test has {d.size} rows; a loop needs at least 3")
    return d, f


#: Points of the hypercube for each free parameter, and the least number of points.
SAMPLES_EACH, SAMPLES_LEAST = 10, 40

#: Largest number of rounds in which refused points are drawn again.
DRAWS = 20

#: Descents from the best points.
STARTS = 6

#: Steps of finite differences as shares of the distance between the bounds.
COARSE, MIDDLE, FINE = 0.02, 0.005, 0.0005

#: A fraction closer to a bound than this is taken to be on it.
AT_BOUND = 1e-3


class SearchStopped(Exception):  # noqa: N818 - not an error: the search may do no more
    """The search has used up its analyses or its time."""


class Search:
    """One search; the misfit keeps the best point.

    Parameters
    ----------
    misfit : Misfit
        The error to minimise.
    seed : int
        Seed of all random choices.
    evaluations : int
        Largest number of analyses.
    seconds : float or None
        Largest wall time [s].
    """

    def __init__(self, misfit: Misfit, seed: int, evaluations: int, seconds: float | None) -> None:
        self.misfit, self._evaluations = misfit, evaluations
        self._random = np.random.default_rng(seed)
        self._until = np.inf if seconds is None else time.perf_counter() + seconds
        self._memory: dict[bytes, Array] = {}

    def run(self) -> str:
        """Search, and return the reason for the end."""
        status = "converged"
        try:
            for fractions in self._sample():
                self._descend(fractions, COARSE, "trf", 12)
            self._descend(self.misfit.best_fractions, MIDDLE, "trf", 12)
            self._descend(self.misfit.best_fractions, FINE, "dogbox", 20)
        except SearchStopped as stopped:
            status = str(stopped)
        except KeyboardInterrupt:
            status = "interrupted"
        return status

    def _vectors(self, several: list[Array]) -> list[Array]:
        memory = self._memory
        if any(fractions.tobytes() not in memory for fractions in several):
            if self.misfit.evaluations >= self._evaluations:
                raise SearchStopped("evaluations used up")
            if time.perf_counter() > self._until:
                raise SearchStopped("time used up")
            wanted = [fractions for fractions in several if fractions.tobytes() not in memory]
            if len(memory) > 64:
                wanted = several
                memory.clear()
            found = self.misfit.vectors(wanted)
            memory |= {p.tobytes(): v for p, v in zip(wanted, found, strict=True)}
        return [self._memory[fractions.tobytes()] for fractions in several]

    def _sample(self) -> list[Array]:
        """Return the best points of a Latin hypercube, the start among its points."""
        from scipy.stats import qmc  # noqa: PLC0415

        size = len(self.misfit.free)
        wanted = max(SAMPLES_EACH * size, SAMPLES_LEAST)
        wanted = min(wanted, max(self._evaluations // 4, 1))
        hypercube = qmc.LatinHypercube(size, rng=self._random)
        points = [self.misfit.start_fractions(), *hypercube.random(wanted)]
        losses = [rms(vector) for vector in self._batches(points)]
        # Refused points are drawn again, as the allowed region is not a box.
        for _ in range(DRAWS):
            missing = wanted + 1 - sum(loss < REFUSED for loss in losses)
            if missing <= 0:
                break
            more = list(hypercube.random(missing))
            points += more
            losses += [rms(vector) for vector in self._batches(more)]
        order = [i for i in np.argsort(losses, kind="stable") if losses[i] < REFUSED]
        return [points[i] for i in order[:STARTS]]

    def _batches(self, points: list[Array], size: int = 16) -> list[Array]:
        found: list[Array] = []
        for first in range(0, len(points), size):
            found += self._vectors(points[first : first + size])
        return found

    def _descend(self, fractions: Array, step: float, method: str, most: int) -> None:
        """Run least squares from a point; the misfit keeps the best point on the way."""
        from scipy.optimize import least_squares  # noqa: PLC0415

        least_squares(
            lambda at: self._vectors([np.array(at)])[0],
            np.clip(fractions, 1e-6, 1 - 1e-6),
            jac=lambda at: self._jacobian(np.array(at), step),
            bounds=(0.0, 1.0),
            method=method,
            max_nfev=most,
            ftol=1e-6,
            xtol=1e-5,
            # As good as the decomposition of J, which many threads of BLAS slow down. It searches
            # a plane, so it needs two parameters.
            tr_solver="lsmr" if fractions.size > 1 else "exact",
        )

    def _jacobian(self, fractions: Array, step: float) -> Array:
        """Return finite differences in a direction that stays in bounds and is not refused."""
        size = fractions.size
        steps = np.where(fractions + step <= 1.0, step, -step)
        moved = [fractions + steps[i] * np.eye(size)[i] for i in range(size)]
        base, *vectors = self._vectors([fractions, *moved])
        jacobian = np.empty((base.size, size))
        for i in range(size):
            if refused(vectors[i]):
                steps[i] *= -1.0
                other = fractions + steps[i] * np.eye(size)[i]
                vectors[i] = self._vectors([other])[0] if 0 <= other[i] <= 1 else base
            jacobian[:, i] = 0.0 if refused(vectors[i]) else (vectors[i] - base) / steps[i]
        return jacobian


def refused(vector: Array) -> bool:
    """Return whether a vector stands for a column that is refused."""
    return bool(vector[0] == REFUSED and vector[-1] == REFUSED)
