"""The search for the parameters that fit best.

The force of a chain of straight lines is continuous in its parameters nearly everywhere, with kinks
where a spring takes another line, and the error has several minima. The search therefore consists
of a Latin hypercube over the bounds; least squares (scipy, trust region) from its best points with
coarse finite differences, which smooth the kinks; and finer differences from the best of them, the
last with the dogleg method, which can reach the bounds. docs/calibration.md compares it
with others.
"""

from __future__ import annotations

import time

import numpy as np

from rbsdem._types import Array
from rbsdem.calibration.misfit import REFUSED, Misfit, rms

#: Points of the hypercube for each free parameter, and the least number of points.
SAMPLES_EACH, SAMPLES_LEAST = 10, 40

#: Largest number of rounds in which refused points are drawn again.
DRAWS = 20

#: Descents from the best points.
STARTS = 6

#: Steps of finite differences as shares of the distance between the bounds.
COARSE, MIDDLE, FINE = 0.02, 0.005, 0.0005

#: A place closer to a bound than this is taken to be on it.
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
            for places in self._sample():
                self._descend(places, COARSE, "trf", 12)
            self._descend(self.misfit.best_places, MIDDLE, "trf", 12)
            self._descend(self.misfit.best_places, FINE, "dogbox", 20)
        except SearchStopped as stopped:
            status = str(stopped)
        except KeyboardInterrupt:
            status = "interrupted"
        return status

    def _vectors(self, several: list[Array]) -> list[Array]:
        memory = self._memory
        if any(places.tobytes() not in memory for places in several):
            if self.misfit.evaluations >= self._evaluations:
                raise SearchStopped("evaluations used up")
            if time.perf_counter() > self._until:
                raise SearchStopped("time used up")
            wanted = [places for places in several if places.tobytes() not in memory]
            if len(memory) > 64:
                wanted = several
                memory.clear()
            found = self.misfit.vectors(wanted)
            memory |= {p.tobytes(): v for p, v in zip(wanted, found, strict=True)}
        return [self._memory[places.tobytes()] for places in several]

    def _sample(self) -> list[Array]:
        """Return the best points of a Latin hypercube, the start among its points."""
        from scipy.stats import qmc  # noqa: PLC0415

        size = len(self.misfit.free)
        wanted = max(SAMPLES_EACH * size, SAMPLES_LEAST)
        wanted = min(wanted, max(self._evaluations // 4, 1))
        hypercube = qmc.LatinHypercube(size, rng=self._random)
        points = [self.misfit.start_places(), *hypercube.random(wanted)]
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

    def _descend(self, places: Array, step: float, method: str, most: int) -> None:
        """Run least squares from a point; the misfit keeps the best point on the way."""
        from scipy.optimize import least_squares  # noqa: PLC0415

        least_squares(
            lambda at: self._vectors([np.array(at)])[0],
            np.clip(places, 1e-6, 1 - 1e-6),
            jac=lambda at: self._jacobian(np.array(at), step),
            bounds=(0.0, 1.0),
            method=method,
            max_nfev=most,
            ftol=1e-6,
            xtol=1e-5,
            # As good as the decomposition of J, which many threads of BLAS slow down. It searches
            # a plane, so it needs two parameters.
            tr_solver="lsmr" if places.size > 1 else "exact",
        )

    def _jacobian(self, places: Array, step: float) -> Array:
        """Return finite differences in a direction that stays in bounds and is not refused."""
        size = places.size
        steps = np.where(places + step <= 1.0, step, -step)
        moved = [places + steps[i] * np.eye(size)[i] for i in range(size)]
        base, *vectors = self._vectors([places, *moved])
        jacobian = np.empty((base.size, size))
        for i in range(size):
            if refused(vectors[i]):
                steps[i] *= -1.0
                other = places + steps[i] * np.eye(size)[i]
                vectors[i] = self._vectors([other])[0] if 0 <= other[i] <= 1 else base
            jacobian[:, i] = 0.0 if refused(vectors[i]) else (vectors[i] - base) / steps[i]
        return jacobian


def refused(vector: Array) -> bool:
    """Return whether a vector stands for a column that is refused."""
    return bool(vector[0] == REFUSED and vector[-1] == REFUSED)
