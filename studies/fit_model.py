"""Fit the free numbers of the layered model to all tests, and judge them on series left out.

    python studies/fit_model.py FOLDER [--near] [--groups 8] [--steps 6] [--jobs 2] [--write]

FOLDER holds the histories and the table of the tests (docs/peer.md). Doubtful labels are mended by
the rules of `studies/doubts.py`, never by the error of the model. The free numbers are the rows of
`data/layered_parameters.csv` that have a prior; all others stand as they are there.

**Prior.** Every free number has a value from the literature or from mechanics and a spread: the fit
pays for leaving it (maximum a posteriori). **Loss.** A test counts n^2/(n^2 + h^2), n its nrmse
with the errors of peak and energy: what no number mends does not pull. Its weight is
1/sqrt(tests of its series), half-way between every test alike and every series alike.

**Search.** Gauss-Newton with damping from the priors, all numbers at once. Groups of series are
left out from the first step on: neither the slopes of their tests nor what decides on a step enter.
Slopes of each test are taken at the priors and, from the third step on, at the places through which
the fit to all tests went: they are nearly the same everywhere, and take most of the time. What has
seen all tests is the form of the model and its fixed values, some of which are rounded results of
earlier fits. `--near` begins each search where that of the last version ended, the
ones without a group where the same group was left out: for a small change of the model, with
`--steps 0` for the scores alone.

`--write` puts the values into the table, and into `studies/results` what `spread_table.py` takes:
the values with and without each group, and the scores of the tests that were left out.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import sys
import time
import warnings
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import doubts
import numpy as np

from rbsdem import peer
from rbsdem.calibration.fit import Target
from rbsdem.errors import AccuracyWarning, RbsdemError
from rbsdem.run.response import reached_force
from rbsdem.run.rig import rig_force
from rbsdem.section.parameters import ModelParameters, parameters, table

ROOT = Path(__file__).resolve().parents[1]
#: nrmse of a test that counts half.
HALF = 0.13
#: What an error of 1 in the ratio of peaks, or of energies, counts as nrmse.
PEAK, ENERGY = 0.3, 0.08
#: Weight of the prior, of one spread, against the mean over the tests.
PRIOR = 5e-4
#: One of this many points along the path is used.
EVERY = 5
#: Dampings that are tried in a step, and how far a number goes in it, in spreads.
DAMPINGS = (3.0, 0.3, 0.03)
FARTHEST = 1.0
#: Farthest from the prior, and the difference for the slopes, in spreads.
BOUND, STEP = 4.0, 0.3

FREE = {row.name: (row.prior, row.spread) for row in table().values() if row.spread > 0}


def at(places: np.ndarray) -> ModelParameters:
    """Return the parameters of places, which count spreads from the priors."""
    values = {}
    for (name, (prior, spread)), place in zip(FREE.items(), places.tolist(), strict=True):
        way = spread * place
        values[name] = prior * math.exp(way) if prior > 0 else way
    # As a version of its own: what a column limits is limited, not refused.
    return replace(parameters().with_values(**values), version="fit")


@dataclass
class Score:
    """A test beside a model: errors for the loss, nrmse, peak and energy over those measured."""

    error: np.ndarray
    nrmse: float
    peak: float
    energy: float

    @property
    def row(self) -> tuple[float, float, float]:
        """The numbers of the tables."""
        return self.nrmse, self.peak, self.energy


class Case:
    """A test, ready to be compared with many columns."""

    def __init__(self, specimen: peer.Specimen) -> None:
        self.specimen, self.target = specimen, Target(specimen.test())
        self.column = peer.column(specimen)

    def score(self, given: ModelParameters) -> Score:
        """Return the errors with some parameters."""
        try:
            # The section is drawn once; the parameters change nothing in it.
            drawing = replace(self.column.drawing, parameters=given)
            column = replace(self.column, drawing=drawing, **drawing.made)
            force, _ = reached_force(column, self.target.displacement)
            force = force + rig_force(column, self.target.displacement[: force.size])
        except RbsdemError:
            force = np.empty(0)
        whole = self.target.error(force)
        peak, energy = self.target.ratios(force)
        ratios = np.clip([PEAK * (peak - 1), ENERGY * (energy - 1)], -HALF, HALF)
        error = np.append(whole[::EVERY] / math.sqrt(len(whole[::EVERY])), ratios)
        nrmse = float(np.sqrt(np.mean(whole**2)))
        return Score(error / math.sqrt(error @ error + HALF**2), nrmse, peak, energy)


_cases: list[Case] = []


def load(folder: str) -> list[Case]:
    """Return the tests with a history of their own, doubtful labels mended."""
    if not _cases:
        warnings.simplefilter("ignore", AccuracyWarning)
        tests = peer.read_specimens(folder).with_history()
        _cases[:] = [Case(specimen) for specimen in doubts.check(tests).corrected()]
    return _cases


def _score(task: tuple[int, np.ndarray]) -> Score:
    number, places = task
    return _cases[number].score(at(places))


def _slopes(task: tuple[int, np.ndarray]) -> np.ndarray:
    """Return the change of the errors of a test by each place."""
    number, places = task
    here = _score(task).error
    moved = places + STEP * np.eye(len(places))
    return np.column_stack([(_score((number, one)).error - here) / STEP for one in moved])


class Search:
    """Gauss-Newton from the priors, or from a start, over some of the tests."""

    def __init__(
        self,
        cases: Sequence[Case],
        pool: ProcessPoolExecutor | None = None,
        start: np.ndarray | None = None,
    ) -> None:
        self.cases = cases
        self.map = map if pool is None else lambda f, tasks: pool.map(f, tasks, chunksize=4)
        series = [case.specimen.series for case in cases]
        self.weight = np.array([1 / math.sqrt(series.count(name)) for name in series])
        self.start = np.zeros(len(FREE)) if start is None else start
        #: Slopes of every test by the step from which on they hold; no test sees another one here.
        self.along: dict[int, list[np.ndarray]] = {}

    def scores(self, members: Iterable[int], places: np.ndarray) -> list[Score]:
        """Return the scores of some tests."""
        return list(self.map(_score, [(i, places) for i in members]))

    def slopes(self, places: np.ndarray) -> list[np.ndarray]:
        """Return the slopes of all tests."""
        return list(self.map(_slopes, [(i, places) for i in range(len(self.cases))]))

    def loss(self, members: list[int], places: np.ndarray, scores: list[Score]) -> float:
        """Return the weighted mean of the losses of tests, and the prior."""
        weight = self.weight[members]
        losses = np.array([score.error @ score.error for score in scores])
        return float(weight @ losses / weight.sum() + PRIOR * (places @ places))

    def normal(
        self, members: list[int], slopes: list[np.ndarray], rest: list[Score], at: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the matrix and the gradient of the quadratic model of the loss."""
        share = self.weight[members] / self.weight[members].sum()
        matrix, gradient = PRIOR * np.eye(len(at)), PRIOR * at
        for w, i, score in zip(share, members, rest, strict=True):
            matrix = matrix + w * slopes[i].T @ slopes[i]
            gradient = gradient + w * slopes[i].T @ score.error
        return matrix, gradient

    def fit(
        self, members: list[int], steps: int, start: np.ndarray | None = None
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return the places that are best for some tests, and the matrix there.

        Slopes are taken anew every second step of the first fit.
        """
        places, matrix = self.start if start is None else start, PRIOR * np.eye(len(FREE))
        slopes: list[np.ndarray] = []
        scores = self.scores(members, places)
        least = self.loss(members, places, scores)
        for number in range(steps):
            if number % 2 == 0:
                if number not in self.along:
                    self.along[number] = self.slopes(places)
                slopes = self.along[number]
            matrix, gradient = self.normal(members, slopes, scores, places)
            best = places, scores
            for damping in DAMPINGS:
                damped = matrix + damping * np.diag(np.diag(matrix))
                move = np.clip(-np.linalg.solve(damped, gradient), -FARTHEST, FARTHEST)
                there = np.clip(places + move, -BOUND, BOUND)
                found = self.scores(members, there)
                loss = self.loss(members, there, found)
                if loss < least:
                    least, best = loss, (there, found)
                elif best[0] is not places:
                    break
            places, scores = best
            print(f"step {number + 1}: loss {least:.5f}", file=sys.stderr, flush=True)
        return places, matrix


def groups_of(cases: Sequence[Case], number: int) -> list[list[int]]:
    """Return the tests of each group of series; the alphabet has nothing to do with the tests."""
    names = sorted({case.specimen.series for case in cases})
    folds = [set(names[i::number]) for i in range(number)]
    return [[i for i, c in enumerate(cases) if c.specimen.series in fold] for fold in folds]


def summary(scores: np.ndarray, cases: Sequence[Case]) -> list[str]:
    """Return lines of a table: medians (and mean) by class, and means over tests and series."""
    lines = ["| tests | number | nrmse: median (mean) | peak | energy |", "| --- " * 5 + "|"]
    kinds = np.array([case.specimen.kind for case in cases])
    squat = np.array([case.specimen.length / case.specimen.depth < 2 for case in cases])
    parts = {kind: kinds == kind for kind in sorted(set(kinds))} | {"L/h < 2": squat}
    for name, chosen in (parts | {"all": np.full(len(cases), True)}).items():
        part = scores[chosen]
        n, p, e = np.median(part, axis=0)
        mean = part[:, 0].mean()
        lines.append(f"| {name} | {len(part)} | {n:.3f} ({mean:.4f}) | {p:.2f} | {e:.2f} |")
    names = np.array([case.specimen.series for case in cases])
    means = [scores[names == name, 0].mean() for name in sorted(set(names))]
    lines.append(f"\nmean of the means of {len(means)} series: {np.mean(means):.4f}")
    return lines


def main() -> None:
    """Fit, leave out, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--near", action="store_true", help="begin at the last version")
    parser.add_argument("--groups", type=int, default=8)
    parser.add_argument("--steps", type=int, default=4)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--write", action="store_true", help="into data and studies/results")
    given = parser.parse_args()

    began = time.perf_counter()
    cases = load(given.folder)
    with ExitStack() as stack:
        pool = None
        if given.jobs > 1:
            pool = stack.enter_context(
                ProcessPoolExecutor(given.jobs, initializer=load, initargs=(given.folder,))
            )
        last: list[np.ndarray | None] = [None] * (given.groups + 1)
        if given.near:
            kept = json.loads((ROOT / "studies/results/fit_model.json").read_text("utf-8"))
            last = [np.array(one) for one in (kept["all"], *kept["without"])]
        search = Search(cases, pool, last[0])
        everyone = list(range(len(cases)))
        places, matrix = search.fit(everyone, given.steps)
        fitted = np.array([score.row for score in search.scores(everyone, places)])
        print("Fit to all tests\n\n" + "\n".join(summary(fitted, cases)), flush=True)
        left, own = np.full_like(fitted, np.nan), []
        for outside, start in zip(groups_of(cases, given.groups), last[1:], strict=True):
            inside = [i for i in everyone if i not in set(outside)]
            own.append(search.fit(inside, given.steps, start)[0])
            left[outside] = [score.row for score in search.scores(outside, own[-1])]
    print("\nEvery series left out once\n\n" + "\n".join(summary(left, cases)))
    gap = left[:, 0].mean() - fitted[:, 0].mean()
    print(f"left out less fit, mean: {gap:.4f}; {time.perf_counter() - began:.0f} s")
    # The spread that a number has after the fit over that of its prior; 1: the tests say nothing.
    after = np.sqrt(PRIOR * np.diag(np.linalg.inv(matrix)))
    print("\n| number | prior | spread | fit | without each group | spread after over before |")
    print("| --- " * 6 + "|")
    values = at(places)
    others = [at(one) for one in own]
    for (name, (prior, spread)), share in zip(FREE.items(), after, strict=True):
        several = [one.values[name] for one in others] or [math.nan]
        print(
            f"| {name} | {prior:g} | {spread:g} | {values.values[name]:.3g} "
            f"| {min(several):.3g} to {max(several):.3g} | {share:.2f} |"
        )
    names = sorted({case.specimen.series for case in cases})
    of = np.array([case.specimen.series for case in cases])
    print("\n| series | tests | fit | left out |\n| --- | --- | --- | --- |")
    for name in names:
        part = of == name
        pair = f"{fitted[part, 0].mean():.3f} | {left[part, 0].mean():.3f}"
        print(f"| {name} | {part.sum()} | {pair} |")
    if given.write:
        write(places, own, left)


def write(places: np.ndarray, own: list[np.ndarray], left: np.ndarray) -> None:
    """Write the values, those without each group, and the scores left out."""
    path = ROOT / "data/layered_parameters.csv"
    lines = path.read_text("utf-8").splitlines()
    for number, line in enumerate(lines):
        name, *rest = line.split(",", 2)
        if name in FREE:
            lines[number] = f"{name},{at(places).values[name]:.3g},{rest[1]}"
    path.write_text("\n".join(lines) + "\n", "utf-8")
    kept = {"all": places.round(4).tolist(), "without": [one.round(4).tolist() for one in own]}
    (ROOT / "studies/results/fit_model.json").write_text(json.dumps(kept) + "\n", "utf-8")
    with (ROOT / "studies/results/fit_model.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["name", "series", "kind", "nrmse", "peak_ratio", "energy_ratio"])
        for case, row in zip(_cases, left, strict=True):
            s = case.specimen
            writer.writerow([s.name, s.series, s.kind, *(f"{value:.4f}" for value in row)])


if __name__ == "__main__":
    main()
