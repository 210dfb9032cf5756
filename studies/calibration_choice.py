"""Which six parameters of the layered model follow a measured loop best.

    python studies/calibration_choice.py DIR [--size 6] [--every 6] [--jobs 2] [--swaps 1]
        [--start NAME ...] [--among NAME ...] [--floor]

The flexural rectangular tests of DIR are taken in turn for the choice and for the judgement; of
those for the choice, one of `--every`. Parameters are added one at a time: each candidate is fitted
together with those that are there, from the best values so far, by a few steps of least squares,
and the one that leaves the least error stays. Then each is taken out once and the best other one
put in its place. The error of a set is the geometric mean of the nrmse of the tests. The sets that
come out are judged by `studies/calibration_table.py` on the other half, with its own search. Option
`--floor` fits all parameters at once, which is about as close as the model can come.
"""

from __future__ import annotations

import argparse
import math
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.optimize import least_squares

import rbsdem
from rbsdem import peer
from rbsdem.calibration.misfit import Target
from rbsdem.errors import RbsdemError
from rbsdem.run.result import reached_force
from rbsdem.section.parameters import table

# Bounds as factors of the value, or as values where it may be zero.
FACTORS = {
    **{name: (row.low, row.high) for name, row in table().items() if row.low < row.high},
    # Several at once.
    "strength": (0.7, 1.5),
    "flexibility": (0.2, 4.0),
    "lengths": (0.2, 4.0),
    "degradation": (0.05, 20.0),
    "softening": (0.1, 20.0),
}
TOGETHER = {
    "strength": {"steel_strength": 1, "concrete_strength": 1},
    "flexibility": {"slip_length": 1, "stiffness": -1, "shear_stiffness": -1},
    "lengths": {"hinge_length": 1, "slip_length": 1},
    "degradation": {"fatigue": 1, "wear": 1, "shear_decay": 1, "shear_endurance": -1},
    "softening": {"core_softening": 1, "cover_softening": 1, "fatigue": 1},
}
EVERY = 4

_cases: list[tuple[Any, Target]] = []


def begin(folder: str, choice: slice) -> None:
    """Load the tests."""
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    tests = peer.read_specimens(folder).where(section="rectangular", failure_mode="Flexure")
    for specimen in [test for test in tests if test.path][choice]:
        _cases.append((peer.column(specimen), Target(specimen.test())))


def made(column: Any, factors: dict[str, float]) -> Any:
    """Return the column with factors on its parameters; what a column limits is limited."""
    drawing = column.drawing
    values = dict(drawing.parameters.values)
    for name, factor in factors.items():
        for one, way in TOGETHER.get(name, {name: 1}).items():
            values[one] *= factor**way
    other = replace(drawing, parameters=drawing.parameters.with_values(**values))
    return replace(column, drawing=other, **other.made)


def fit(task: tuple[int, dict[str, float], tuple[str, ...], int]) -> tuple[float, dict[str, float]]:
    """Return the least nrmse of a test with some parameters free, and their factors."""
    number, start, names, most = task
    column, target = _cases[number]
    low, high = (np.log([FACTORS[name][i] for name in names]) for i in (0, 1))
    best: list[Any] = [math.inf, dict(start)]

    def error(places: np.ndarray) -> np.ndarray:
        factors = dict(zip(names, np.exp(low + places * (high - low)).tolist(), strict=True))
        try:
            whole = target.error(reached_force(made(column, factors), target.displacement)[0])
        except RbsdemError:
            whole = np.full(2000, 1.0)
        nrmse = float(np.sqrt(np.mean(whole**2)))
        if nrmse < best[0]:
            best[:] = nrmse, factors
        return whole[::EVERY] / math.sqrt(2000 / EVERY)

    at = np.array([math.log(start.get(name, 1.0)) for name in names])
    places = np.clip((at - low) / (high - low), 1e-3, 1 - 1e-3)
    if most == 0 or not names:
        error(places)
    else:
        least_squares(
            error,
            places,
            bounds=(0, 1),
            diff_step=0.03,
            max_nfev=most,
            ftol=1e-4,
            xtol=1e-3,
            x_scale=0.2,
            method="trf",
        )
    return best[0], best[1]


def score(found: list[float]) -> float:
    """Return the geometric mean."""
    return math.exp(float(np.mean(np.log(found))))


def main() -> None:
    """Add parameters one by one, exchange them, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--size", type=int, default=6)
    parser.add_argument("--every", type=int, default=6)
    parser.add_argument("--steps", type=int, default=6)
    parser.add_argument("--swaps", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--start", nargs="*", default=[], metavar="NAME", help="set to begin with")
    parser.add_argument("--among", nargs="*", metavar="NAME", help="candidates; all by default")
    parser.add_argument("--floor", action="store_true", help="all parameters at once")
    given = parser.parse_args()
    source = given.folder, slice(0, None, 2 * given.every)
    begin(*source)
    count = len(_cases)
    with ProcessPoolExecutor(given.jobs, initializer=begin, initargs=source) as pool:

        def tried(sets: list[tuple[str, ...]], starts: list[list[dict[str, float]]], steps: int):
            tasks = [
                (i, start[i], names, steps)
                for names, start in zip(sets, starts, strict=True)
                for i in range(count)
            ]
            rows = list(pool.map(fit, tasks, chunksize=2))
            return [rows[k * count : (k + 1) * count] for k in range(len(sets))]

        chosen: tuple[str, ...] = tuple(given.start)
        (now,) = tried([chosen], [[{}] * count], 0 if not chosen else 12)
        print(f"{count} tests, start {chosen}: {score([r[0] for r in now]):.4f}", flush=True)
        if given.floor:
            names = tuple(n for n in FACTORS if n not in TOGETHER)
            (rows,) = tried([names], [[{}] * count], 12)
            print(
                f"all {len(names)}: {score([r[0] for r in rows]):.4f} median "
                f"{np.median([r[0] for r in rows]):.4f}",
                flush=True,
            )
            return

        def best_added(base: tuple[str, ...], start: list[dict[str, float]]):
            others = [name for name in given.among or FACTORS if name not in base]
            sets = [(*base, name) for name in others]
            rows = tried(sets, [start] * len(sets), given.steps)
            order = sorted(range(len(sets)), key=lambda k: score([r[0] for r in rows[k]]))
            for k in order[:6]:
                print(f"    {others[k]:22s} {score([r[0] for r in rows[k]]):.4f}", flush=True)
            return sets[order[0]], rows[order[0]]

        while len(chosen) < given.size:
            chosen, now = best_added(chosen, [row[1] for row in now])
            print(
                f"{' '.join(chosen)}: {score([r[0] for r in now]):.4f} median "
                f"{np.median([r[0] for r in now]):.4f}",
                flush=True,
            )
        for _ in range(given.swaps):
            for name in chosen:
                base = tuple(one for one in chosen if one != name)
                start = [{k: v for k, v in row[1].items() if k != name} for row in now]
                other, rows = best_added(base, start)
                if score([r[0] for r in rows]) < score([r[0] for r in now]) * 0.998:
                    chosen, now = other, rows
                print(
                    f"without {name}: {' '.join(chosen)}: {score([r[0] for r in now]):.4f}",
                    flush=True,
                )


if __name__ == "__main__":
    sys.exit(main())
