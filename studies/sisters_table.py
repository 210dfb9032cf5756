"""What given tests of a laboratory gain for its others: the table of docs/prediction.md.

    python studies/sisters_table.py FOLDER [--jobs 2]

Each test of a series with more than one is predicted with the parameters that were fitted without
its group of series (`studies/fit_model.py`): alone, with the one test of its series given that is
most like it, with three, and with all others.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor

import fit_model
import numpy as np
import spread_table

from rbsdem import peer
from rbsdem.run.bands import factored_force, scatter_of_tests
from rbsdem.run.sisters import Learned, Loop, learn_from, told

#: How many tests are given, the nearest first.
GIVEN = (0, 1, 3, 99)


def _told(number: int) -> tuple[np.ndarray, np.ndarray]:
    case = fit_model._cases[number]
    column = spread_table._column(number, None)
    loop = Loop(column, case.target.displacement, case.target.force)
    return told(loop, scatter_of_tests())


def _score(task: tuple[int, Learned | None]) -> tuple[float, float, float]:
    """Return nrmse, share of points in the band, its width."""
    number, learned = task
    case, column = fit_model._cases[number], spread_table._column(number, None)
    d = case.target.displacement
    band = peer.band(column, d, samples=8, scatter=scatter_of_tests(), learned=learned)
    logs = np.zeros(3) if learned is None else learned.logs
    error = case.target.error(factored_force(column, d, logs))
    return float(np.sqrt(np.mean(error**2))), band.holds(case.target.force), band.width


def main() -> None:
    """Predict, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    spread_table._begin(given.folder)
    specimens = [case.specimen for case in fit_model._cases]
    series = np.array([specimen.series for specimen in specimens])
    members = [i for i, name in enumerate(series) if np.sum(series == name) > 1]
    near = {}
    for i in members:
        s = specimens[i]
        others = {specimens[j]: j for j in members if j != i and series[j] == series[i]}
        hinge = peer.draw(s).section, s.length, s.axial_load
        found = peer.nearest(*hinge, list(others), n=len(others))
        near[i] = [others[one.specimen] for one in found]
    print("| tests given | nrmse: mean, mean of series means | better | points | width |")
    print("| --- | ---: | ---: | ---: | ---: |")
    source = (given.folder,)
    with ProcessPoolExecutor(given.jobs, initializer=spread_table._begin, initargs=source) as pool:
        says = dict(zip(members, pool.map(_told, members, chunksize=4), strict=True))
        alone = np.empty(0)
        for number in GIVEN:
            learned = [
                learn_from([says[j] for j in near[i][:number]], scatter_of_tests())
                if number
                else None
                for i in members
            ]
            tasks = list(zip(members, learned, strict=True))
            errors, held, width = np.array(list(pool.map(_score, tasks, chunksize=4))).T
            alone = alone if alone.size else errors
            own = series[members]
            means = [errors[own == name].mean() for name in sorted(set(own.tolist()))]
            name = {0: "none", 1: "the nearest", 3: "three", 99: "all others"}[number]
            print(
                f"| {name} | {errors.mean():.4f}, {np.mean(means):.4f} "
                f"| {np.mean(errors < alone):.2f} | {held.mean():.2f} | {width.mean():.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
