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
from rbsdem.run.bands import distance, numbers, scatter_of_tests
from rbsdem.run.sisters import Loop, Told, learn, told

#: How many tests are given, the nearest first.
GIVEN = {0: "none", 1: "the nearest", 2: "two", 3: "three", 99: "all others"}


def _told(number: int) -> Told:
    target = fit_model._cases[number].target
    column = spread_table._column(number, None)
    return told(Loop(column, target.displacement, target.force))


def _score(task: tuple[int, list[Told]]) -> tuple[float, ...]:
    """Return nrmse, share of points in the band, its width, and which intervals hold."""
    number, given = task
    case, column = fit_model._cases[number], spread_table._column(number, None)
    d, test = case.target.displacement, case.target.force
    learned = learn(column, d, given) if given else None
    known = scatter_of_tests()
    band = peer.band(column, d, samples=8, scatter=known, learned=learned, rig=True)
    error = case.target.error(band.force)
    measured = numbers(d, test, case.specimen.length)
    held = [
        interval.holds(measured[name])
        for name, interval in (
            ("peak", band.peak_force), ("energy", band.energy), ("drift", band.drift_at_loss)
        )
    ]  # fmt: skip
    return float(np.sqrt(np.mean(error**2))), band.holds(test), band.width, *map(float, held)


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
    print("| tests given | nrmse: mean, of series means | better | points | width "
          "| peak, work, drift held |")  # fmt: skip
    print("| --- " + "| ---: " * 5 + "|")
    source = (given.folder,)
    with ProcessPoolExecutor(given.jobs, initializer=spread_table._begin, initargs=source) as pool:
        says = dict(zip(members, pool.map(_told, members, chunksize=4), strict=True))
        near = {
            i: sorted(
                (j for j in members if j != i and series[j] == series[i]),
                key=lambda j, i=i: distance(says[i].features, says[j].features),
            )
            for i in members
        }
        alone = np.empty(0)
        for number, name in GIVEN.items():
            tasks = [(i, [says[j] for j in near[i][:number]]) for i in members]
            rows = np.array(list(pool.map(_score, tasks, chunksize=4)))
            errors, *rest = rows.T
            alone = alone if alone.size else errors
            own = series[members]
            means = [errors[own == name].mean() for name in sorted(set(own.tolist()))]
            held, width, *intervals = (part.mean() for part in rest)
            print(
                f"| {name} | {errors.mean():.4f}, {np.mean(means):.4f} "
                f"| {np.mean(errors < alone):.2f} | {held:.2f} | {width:.2f} "
                f"| {', '.join(f'{share:.2f}' for share in intervals)} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
