"""The search of a calibration against other searches with about as many analyses.

    python studies/calibration_search.py [DIR]

Six parameters of the Takeda spring of the paper's columns, fitted to the loops of columns whose
parameters were drawn at random, and to the measured loops if DIR has them; three seeds each. It
prints the number of analyses, and the nrmse above the best that any search found.
"""

from __future__ import annotations

import sys
import warnings
from collections.abc import Callable
from contextlib import suppress

import numpy as np
from scipy.optimize import differential_evolution, dual_annealing, minimize

import rbsdem
from rbsdem.calibration.misfit import Misfit, Target, rms
from rbsdem.calibration.paths import Parameters, free_parameters
from rbsdem.calibration.search import Search, SearchStopped
from rbsdem.peer import find_history, read_peer
from rbsdem.run.result import reached_force

FREE = [f"flexure.{name}" for name in ("k_c", "k_y", "d_y", "k_u", "b0", "b1")]
MOST, SEEDS, DRAWN = 800, 3, 2


class Limited(Misfit):
    """A misfit that ends any search after `MOST` analyses."""

    def loss_at(self, places: np.ndarray) -> float:
        """Return the loss; a place that is refused has a large one."""
        if self.evaluations >= MOST:
            raise SearchStopped
        return rms(self.vector(np.asarray(places)))


def used(misfit: Limited, seed: int) -> None:
    """Run the search of the package."""
    Search(misfit, seed, MOST, None).run()


def by_scipy(run: Callable[..., object]) -> Callable[[Limited, int], None]:
    """Return a search of scipy, ended by the number of analyses."""

    def searched(misfit: Limited, seed: int) -> None:
        with suppress(SearchStopped):
            run(misfit, [(0.0, 1.0)] * len(misfit.free), seed)

    return searched


def after_hypercube(method: str) -> Callable[[Limited, int], None]:
    """Return a search from the best point of a Latin hypercube."""

    def run(misfit: Limited, bounds: list[tuple[float, float]], seed: int) -> None:
        Search(misfit, seed, MOST, None)._sample()
        minimize(misfit.loss_at, misfit.best_places, method=method, bounds=bounds)

    return by_scipy(run)


SEARCHES = {
    "hypercube, least squares (used)": used,
    "hypercube, Nelder-Mead": after_hypercube("Nelder-Mead"),
    "hypercube, Powell": after_hypercube("Powell"),
    "differential evolution": by_scipy(
        lambda misfit, bounds, seed: differential_evolution(
            misfit.loss_at, bounds, rng=seed, popsize=6, polish=False
        )
    ),
    "dual annealing": by_scipy(
        lambda misfit, bounds, seed: dual_annealing(misfit.loss_at, bounds, rng=seed)
    ),
}


def main() -> None:
    """Run all searches and print what they found."""
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    columns = rbsdem.peer.paper_columns("pdelta")
    measured, drawn = {}, {}
    random = np.random.default_rng(0)
    for key, column in columns.items():
        history = find_history(key, sys.argv[1]) if sys.argv[1:] else None
        test = read_peer(history) if history else rbsdem.peer.shipped_reversals(key)
        if history:
            measured[key] = column, test
        d = test.displacement
        d = d if history else np.interp(np.arange(0, d.size - 1, 0.05), np.arange(d.size), d)
        for number in range(DRAWN):
            drawn[f"{key} {number}"] = column, (d, _drawn(column, d, random))
    for title, tests in (("measured", measured), ("drawn", drawn)):
        if tests:
            _table(title, tests)


def _drawn(column: rbsdem.Column, d: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Return the force of a column with parameters from the inner half of their bounds."""
    parameters = Parameters(column)
    free = free_parameters(parameters, FREE, None)
    while True:
        places = random.uniform(0.25, 0.75, len(FREE))
        values = {n: p.at(at) for (n, p), at in zip(free.items(), places, strict=True)}
        with suppress(rbsdem.InputError):
            return reached_force(parameters.build(values), d)[0]


def _table(title: str, tests: dict[str, tuple[rbsdem.Column, object]]) -> None:
    found = np.empty((len(SEARCHES), len(tests), SEEDS))
    analyses = np.empty_like(found)
    for i, run in enumerate(SEARCHES.values()):
        for j, (column, test) in enumerate(tests.values()):
            parameters, target = Parameters(column), Target(test)
            free = free_parameters(parameters, FREE, None)
            for seed in range(SEEDS):
                misfit = Limited(
                    parameters.build, free, target, "nrmse", 1, lambda done, best: None
                )
                run(misfit, seed)
                found[i, j, seed], analyses[i, j, seed] = misfit.best, misfit.evaluations
    above = found - found.min(axis=(0, 2))[None, :, None]
    print(f"\n{title:32s}  analyses   median     mean  largest")
    for name, row, count in zip(SEARCHES, above, analyses, strict=True):
        print(
            f"{name:32s}  {count.mean():8.0f}  {np.median(row):.5f}  {row.mean():.5f}  "
            f"{row.max():.5f}"
        )


if __name__ == "__main__":
    main()
