"""The scatter of left-out tests about the model, what its bands hold: tables of docs/prediction.md.

    python studies/spread_table.py FOLDER [--samples 16] [--jobs 2] [--once] [--write] [--surface]

The numbers of the model without each group of series are those of `studies/fit_model.py`.

**Numbers of the bands.** Every test is predicted with the parameters without its group. The scatter
of strength, stiffness and drift at loss is split into that between series (laboratories) and that
between the tests of a series. Samples of it go through the model; their band is widened until 80 %
of the points of the tests lie within, and the ends of the intervals of single numbers are quantiles
of the tests. A test counts 1/sqrt(tests of its series), half-way between every test alike and every
series alike. There are three sets of numbers: for columns far from their shear strength, and for
squat and for slender ones at it, as far as the model says, whatever the test said.

**Shape.** The part of the band that is there without samples (`SHAPE`) makes the interval score of
left-out tests least (Winkler 1972: the width, and ten times what a point is beyond); the table of
the choice prints it.

**Correction.** Quantiles of a few dozen series are too near for a series that is not among them. So
the share of the tests that they are taken at is found on series left out again: it is such that
quantiles without a group hold 80 % of that group, over all groups (conformal correction).

**Coverage** is judged on series that nothing has seen: for each group, scatter, share and quantiles
are found anew from the other groups alone, which for this are predicted with the parameters without
them and without the judged group. Leaving out is additive to first order, so these parameters are
those of the fit to all, plus the changes by leaving out the one and the other.

This takes nine times the predictions of all tests with their samples. `--once` takes one: samples
of the scatter of all groups, and parameters that the judged group was left out of for its own tests
alone. The numbers that are shipped are the same, and what is judged hardly differs.

`--write` puts scatter and coverage into docs/prediction.md and the numbers into
data/layered_spread.json.

`--surface` compares the samples, which nine runs of the model give, with as many runs as there are
samples, and prints nothing else.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import fit_model
import numpy as np
from spread_quantiles import LEVEL, Numbers, Points, Ratios, between, weights

from rbsdem import peer
from rbsdem.curves.metrics import PathPoints, secant_stiffness
from rbsdem.run.bands import (
    Features,
    Scatter,
    _degraded,
    _normal_points,
    half_band,
    near_shear,
    numbers,
    path_force,
    sample,
    scatter_of_tests,
    slender,
)
from rbsdem.section.parameters import VERSION

#: What the band has without samples, over the largest force; and what else was tried.
SHAPE = 0.15
SHAPES = (0.05, 0.1, 0.15, 0.2, 0.3)
#: Points along the path at which a band is judged.
POINTS = 400
ROOT = Path(__file__).resolve().parents[1]
NUMBERS = ("peak", "energy", "drift")
NAMES = {"peak": "strength", "stiffness": "stiffness", "drift": "degradation"}

_all = np.empty(0)
_without: list[np.ndarray] = []
_group: dict[str, int] = {}


# ---- predictions, in processes -------------------------------------------------------------------


def _begin(folder: str) -> None:
    global _all
    kept = json.loads((ROOT / "studies/results/fit_model.json").read_text("utf-8"))
    _all, _without[:] = np.array(kept["all"]), map(np.array, kept["without"])
    cases = fit_model.load(folder)
    for number, members in enumerate(fit_model.groups_of(cases, len(_without))):
        _group.update(dict.fromkeys((cases[i].specimen.series for i in members), number))


def _column(number: int, judged: int | np.ndarray | None) -> Any:
    """Return the column of a test with the parameters without its group and the judged one.

    Places of parameters may stand for the judged group: then they are those of the column.
    """
    case = fit_model._cases[number]
    if isinstance(judged, np.ndarray):
        return peer.column(case.specimen, model_parameters=fit_model.at(judged))
    out = {_group[case.specimen.series]} | ({judged} if judged is not None else set())
    places = _all + np.sum([_without[one] - _all for one in out], axis=0)
    return peer.column(case.specimen, model_parameters=fit_model.at(places))


def _numbers(task: tuple[int, int | np.ndarray | None]) -> Numbers:
    number, judged = task
    case = fit_model._cases[number]
    d, test, height = case.target.displacement, case.target.force, case.specimen.length
    column = _column(number, judged)
    force = path_force(column, d, rig=True)
    ours, theirs = numbers(d, force, height), numbers(d, test, height)
    ours["stiffness"], theirs["stiffness"] = secant_stiffness(d, force), secant_stiffness(d, test)
    beyond = math.isnan(ours["drift"])
    if beyond:
        ours["drift"] = float(np.max(np.abs(d))) / height
    logs = {}
    for name, value in ours.items():
        known = value > 0 and theirs[name] > 0
        logs[name] = math.log(theirs[name] / value) if known else math.nan
    near = near_shear(column, float(np.max(np.abs(force))))
    return Numbers(Features(near, slender(height, case.specimen.depth)), logs, beyond)


class Band(NamedTuple):
    """What the samples say of a left-out test, along the path and over its predicted peak.

    Attributes
    ----------
    way : ndarray, shape (points,)
        Test less prediction.
    above, below : ndarray, shape (points,)
        The half bands of the samples alone.
    """

    way: np.ndarray
    above: np.ndarray
    below: np.ndarray

    def scores(self, shape: float) -> np.ndarray:
        """Return the distances of the test over the half band, with what it has for the shape."""
        return np.where(
            self.way > 0, self.way / (self.above + shape), -self.way / (self.below + shape)
        )

    def width(self, shape: float) -> float:
        """Return the mean width of the band before it is widened."""
        return float(np.mean(self.above + self.below)) + 2 * shape

    def interval_score(self, shape: float, widen: float) -> float:
        """Return the mean width, and what points are beyond it, which costs 2/(1 - LEVEL)."""
        above, below = widen * (self.above + shape), widen * (self.below + shape)
        beyond = np.maximum(self.way - above, 0) + np.maximum(-self.way - below, 0)
        return float(np.mean(above + below + 2 / (1 - LEVEL) * beyond))


def _band(task: tuple[int, int | np.ndarray | None, int, Scatter]) -> Band:
    number, judged, samples, scatter = task
    case, column = fit_model._cases[number], _column(number, judged)
    d = case.target.displacement
    force = path_force(column, d, rig=True)
    peak = float(np.max(np.abs(force)))
    up, down = half_band(force, sample(column, d, force, scatter, samples, rig=True), scatter)
    at = PathPoints(d, POINTS, "displacement")
    return Band((at(case.target.force) - at(force)) / peak, at(up) / peak, at(down) / peak)


def _surface(task: tuple[int, int]) -> tuple[float, float]:
    """Return width of a band over that of runs of all samples, and how far its ends are off."""
    number, samples = task
    case, scatter = fit_model._cases[number], scatter_of_tests()
    column, d = case.column, case.target.displacement
    strength, *sizes = (math.hypot(*getattr(scatter, name)) for name in NAMES.values())
    runs = []
    for stronger, *point in _normal_points(samples).tolist():
        stiffness, faster = np.exp(np.multiply(sizes, point)).tolist()
        run = path_force(_degraded(column, faster), stiffness * d, rig=True)
        runs.append(math.exp(strength * stronger) * run)
    force = path_force(column, d, rig=True)
    known = np.array(half_band(force, np.array(runs), scatter))
    ends = np.array(half_band(force, sample(column, d, force, scatter, samples, rig=True), scatter))
    width = known.sum(axis=0).mean()
    return ends.sum(axis=0).mean() / width, np.abs(ends - known).mean() / width


# ---- tables --------------------------------------------------------------------------------------


def components(values: np.ndarray, series: np.ndarray) -> tuple[float, float]:
    """Return standard deviations between series and within them (analysis of variance)."""
    known = np.isfinite(values)
    values, series = values[known], series[known]
    # Two per cent at both ends are not believed.
    values = np.clip(values, *np.quantile(values, (0.02, 0.98)))
    parts = [values[series == name] for name in sorted(set(series.tolist()))]
    inside = sum(((part - part.mean()) ** 2).sum() for part in parts)
    inside /= len(values) - len(parts)
    size = (len(values) - sum(len(part) ** 2 for part in parts) / len(values)) / (len(parts) - 1)
    between_ = sum(len(part) * (part.mean() - values.mean()) ** 2 for part in parts)
    between_ = max(0.0, (between_ / (len(parts) - 1) - inside) / size)
    return round(math.sqrt(between_), 3), round(math.sqrt(inside), 3)


def scatter_of(rows: list[Numbers], series: np.ndarray, chosen: np.ndarray) -> Scatter:
    """Return the scatter of chosen tests, its intervals not yet found."""
    parts = {}
    for name, what in NAMES.items():
        # A drift that the model does not come to is no ratio.
        logs = [math.nan if name == "drift" and r.beyond else r.logs[name] for r in rows]
        parts[what] = components(np.array(logs)[chosen], series[chosen])
    one = ((1.0, 1.0), (1.0, 1.0), (1.0, 1.0))
    # What the band has for the shape is added where bands are judged.
    return Scatter(**parts, shape=0.0, force=(1.0, 1.0, 1.0), peak=one, energy=one, drift=one)


class Fold(NamedTuple):
    """What comes out of some groups, and how it does on all tests."""

    scatter: Scatter
    inside: dict[str, np.ndarray]
    width: np.ndarray
    #: Of each shape: interval scores, shares of points, widths.
    choices: dict[float, np.ndarray]


def fold(
    judged: int | None,
    series: np.ndarray,
    group: np.ndarray,
    samples: int,
    run: Callable[[Any, list[Any]], Iterator[Any]],
    once: dict[str, Any] | None,
) -> Fold:
    """Find scatter, correction and ends without a group; None for those that are shipped."""
    every = range(len(series))
    chosen = group != (-1 if judged is None else judged)
    if once:
        rows, scatter, bands = once["rows"], once["scatter"], once["bands"]
    else:
        without = None if once is not None else judged
        rows = list(run(_numbers, [(i, without) for i in every]))
        scatter = scatter_of(rows, series, chosen if without is not None else group >= 0)
        bands = list(run(_band, [(i, without, samples, scatter) for i in every]))
        if once is not None:
            once |= {"rows": rows, "scatter": scatter, "bands": bands}
    about = series, group, np.array([row.near for row in rows])
    choices = {}
    for shape in SHAPES:
        scores = np.array([band.scores(shape) for band in bands])
        points = Points(scores, *about)
        ends = points.ends(chosen, np.full(3, 1 - LEVEL))
        widened = list(zip(bands, between(ends, points.near).tolist(), strict=True))
        choices[shape] = np.array(
            [
                [band.interval_score(shape, by) for band, by in widened],
                points.held(ends),
                [by * band.width(shape) for band, by in widened],
            ]
        )
    scores = np.array([band.scores(SHAPE) for band in bands])
    points = Points(scores, *about)
    ends = points.ends(chosen, points.tail(chosen))
    width = between(ends, points.near) * np.array([band.width(SHAPE) for band in bands])
    inside, found = {"force": points.held(ends)}, {"force": _rounded(ends)}
    for name in NUMBERS:
        ratios = Ratios(rows, name, *about)
        ends = ratios.ends(chosen, ratios.tail(chosen))
        inside[name] = ratios.held(ends)
        found[name] = tuple(_rounded(np.exp(pair)) for pair in ends)
    return Fold(_with(scatter, found), inside, width, choices)


def _rounded(values: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(value), 3) for value in values)


def _with(scatter: Scatter, found: dict[str, Any]) -> Scatter:
    values = {name: getattr(scatter, name) for name in NAMES.values()}
    return Scatter(**values, shape=SHAPE, **found)


def residual_table(rows: list[Numbers], series: np.ndarray) -> list[str]:
    """Return where the scatter comes from."""
    lines = [
        "| ln of test over model | tests | mean | laboratories | tests of a series |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    for name in ("peak", "stiffness", "energy", "drift"):
        logs = [math.nan if name == "drift" and r.beyond else r.logs[name] for r in rows]
        values = np.array(logs)
        known = values[np.isfinite(values)]
        lab, test = components(values, series)
        lines.append(f"| {name} | {known.size} | {known.mean():+.3f} | {lab:.3f} | {test:.3f} |")
    return lines


def coverage_table(
    inside: dict[str, np.ndarray], width: np.ndarray, kinds: np.ndarray, group: np.ndarray,
    series: np.ndarray,
) -> list[str]:  # fmt: skip
    """Return what is within bands and intervals, by class and by group of series."""
    lines = [
        "| tests | number | points within | mean width | peak | energy | drift at loss |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    chosen = {
        f"{form}, {mode}": kinds == f"{form}, {mode}"
        for form in ("rectangular", "round")
        for mode in ("Flexure", "Flexure-Shear", "Shear")
    }
    for number in sorted(set(group.tolist())):
        chosen[f"series group {number + 1}"] = group == number
    chosen["all"] = np.ones(len(group), bool)
    for name, own in chosen.items():
        cells = [f"{np.nanmean(inside[what][own]):.2f}" for what in NUMBERS]
        lines.append(
            f"| {name} | {own.sum()} | {inside['force'][own].mean():.2f} | "
            f"{width[own].mean():.2f} | {' | '.join(cells)} |"
        )
    names = sorted(set(series.tolist()))

    def by_series(values: np.ndarray) -> float:
        return float(np.mean([np.nanmean(values[series == name]) for name in names]))

    cells = [f"{by_series(inside[what]):.2f}" for what in NUMBERS]
    lines.append(
        f"| mean of series means | {len(names)} series | {by_series(inside['force']):.2f} | "
        f"{by_series(width):.2f} | {' | '.join(cells)} |"
    )
    return lines


def choice_table(choices: dict[float, np.ndarray], series: np.ndarray) -> list[str]:
    """Return the interval scores of what was tried, a test weighted as everywhere."""
    lines = [
        "| band without samples | interval score | points | width |",
        "| ---: | ---: | ---: | ---: |",
    ]
    for shape, values in choices.items():
        score, held, width = np.average(values, axis=1, weights=weights(series))
        lines.append(f"| {shape} | {score:.3f} | {held:.2f} | {width:.2f} |")
    return lines


def by_chance(inside: dict[str, np.ndarray], series: np.ndarray) -> list[str]:
    """Return how groups of series come out if the same series are put into eight by chance."""
    rng = np.random.default_rng(1)
    names = np.array(sorted(set(series.tolist())))
    lines = [
        "| of a group by chance | force | peak | energy | drift at loss |",
        "| --- | ---: | ---: | ---: | ---: |",
    ]
    shares: dict[str, list[float]] = {what: [] for what in ("force", *NUMBERS)}
    for _ in range(500):
        rng.shuffle(names)
        for number in range(8):
            own = np.isin(series, names[number::8])
            for what, found in shares.items():
                found.append(float(np.nanmean(inside[what][own])))
    for text, share in (("5 %", 0.05), ("median", 0.5), ("95 %", 0.95)):
        cells = [f"{np.nanquantile(found, share):.2f}" for found in shares.values()]
        lines.append(f"| {text} | {' | '.join(cells)} |")
    return lines


def write(values: dict[str, Any], tables: dict[str, list[str]]) -> None:
    """Put numbers and tables where they belong; what has no new value stays."""
    path = ROOT / "data/layered_spread.json"
    kept = json.loads(path.read_text("utf-8")) | values
    path.write_text(json.dumps(kept, indent=2) + "\n", "utf-8")
    path = ROOT / "docs/prediction.md"
    text = path.read_text("utf-8")
    for name, lines in tables.items():
        first, last = f"<!-- spread: {name} -->\n", "<!-- end of spread -->"
        begin = text.index(first) + len(first)
        body = "\n".join(lines)
        text = f"{text[:begin]}\n{body}\n\n{text[text.index(last, begin) :]}"
    path.write_text(text, "utf-8")


def main() -> None:
    """Predict, widen, judge, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--once", action="store_true", help="samples of each test once")
    parser.add_argument("--write", action="store_true", help="into docs and data")
    parser.add_argument("--surface", action="store_true", help="samples beside runs of all")
    given = parser.parse_args()

    began = time.perf_counter()
    source = (given.folder,)
    _begin(given.folder)
    cases = fit_model._cases
    series = np.array([case.specimen.series for case in cases])
    group = np.array([_group[name] for name in series.tolist()])
    kinds = np.array([case.specimen.kind for case in cases])
    inside = {name: np.full(len(cases), np.nan) for name in ("force", *NUMBERS)}
    width = np.empty(len(cases))
    choices: dict[float, np.ndarray] = {}
    with ProcessPoolExecutor(given.jobs, initializer=_begin, initargs=source) as pool:

        def run(function: Any, tasks: list[Any]) -> Iterator[Any]:
            return pool.map(function, tasks, chunksize=4)

        if given.surface:
            tasks = [(i, given.samples) for i in range(len(cases))]
            ratio, off = np.array(list(run(_surface, tasks))).T
            print(f"width: mean {ratio.mean():.4f}, standard deviation {ratio.std():.4f}")
            print(f"ends off: mean {off.mean():.4f}, nine tenths below {np.quantile(off, 0.9):.4f}")
            return
        rows = list(run(_numbers, [(i, None) for i in range(len(cases))]))
        once: dict[str, Any] | None = {} if given.once else None
        for judged in range(len(_without)):
            own = group == judged
            found = fold(judged, series, group, given.samples, run, once)
            width[own] = found.width[own]
            for key, values in found.choices.items():
                choices.setdefault(key, np.empty_like(values))[:, own] = values[:, own]
            for name, values in inside.items():
                values[own] = found.inside[name][own]
            seconds = time.perf_counter() - began
            held = inside["force"][own].mean()
            print(f"group {judged + 1}: {held:.2f} within, {seconds:.0f} s", flush=True)
        shipped = fold(None, series, group, given.samples, run, once).scatter
    tables = {
        "scatter": residual_table(rows, series),
        "coverage": coverage_table(inside, width, kinds, group, series),
        "chance": by_chance(inside, series),
        "choice": choice_table(choices, series),
    }
    for lines in tables.values():
        print("\n" + "\n".join(lines))
    print(f"\n{VERSION}: {shipped!r}\n{time.perf_counter() - began:.0f} s")
    if given.write:
        names = (*NAMES.values(), "shape", "force", *NUMBERS)
        kept = [line for line in tables["coverage"] if not line.startswith("| series group ")]
        paged = {"scatter": tables["scatter"], "coverage": kept}
        write({name: getattr(shipped, name) for name in names}, paged)


if __name__ == "__main__":
    main()
