"""The scatter of left-out tests about the model, and what its bands hold: tables of docs/peer.md.

    python studies/spread_table.py FOLDER STATE [--samples 16] [--jobs 2] [--once] [--write]

STATE is the file in which `studies/fit_model.py` keeps the parameters without each group of series.

**Numbers of the bands.** Every test is predicted with the parameters without its group. The scatter
of strength, stiffness and drift at loss is split into that between series (laboratories) and that
between the tests of a series. Samples of it go through the model; their band is widened until 80 %
of the points of the tests lie within, and the ends of the intervals of single numbers are quantiles
of the tests. A test counts 1/sqrt(tests of its series), half-way between every test alike and every
series alike. There are two sets of numbers: for columns far from their shear strength and for those
at it, as far as the model says, whatever the test said.

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

`--write` puts the tables into docs/peer.md and the numbers into python/rbsdem/section/scatter.py.
"""

from __future__ import annotations

import argparse
import json
import math
import re
import time
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import Any, NamedTuple

import fit_model
import numpy as np

import rbsdem
from rbsdem import peer
from rbsdem.comparison import secant_stiffness
from rbsdem.comparison.metrics import PathPoints
from rbsdem.section import Scatter, parameters
from rbsdem.section.spread import half_band, near_shear, numbers, path_force, sample

#: What nominally equal specimens differ by, over their peak force.
TWINS = 0.05
LEVEL = 0.8
#: Points along the path at which a band is judged.
POINTS = 400
ROOT = Path(__file__).resolve().parents[1]
NUMBERS = ("peak", "energy", "drift")
NAMES = {"peak": "strength", "stiffness": "stiffness", "drift": "degradation"}

_state: dict[str, np.ndarray] = {}
_group: dict[str, int] = {}


# ---- predictions, in processes -------------------------------------------------------------------


def _begin(folder: str, state: str, groups: int) -> None:
    warnings.simplefilter("ignore", rbsdem.AccuracyWarning)
    fit_model._begin(folder)
    kept = json.loads(Path(state).read_text("utf-8"))
    _state.update({name: np.array(value) for name, value in kept.items()})
    names = sorted({case.specimen.series for case in fit_model._cases})
    for number in range(groups):
        _group.update(dict.fromkeys(names[number::groups], number))


def _column(number: int, judged: int | None) -> Any:
    """Return the column of a test with the parameters without its group and the judged one."""
    case = fit_model._cases[number]
    out = {_group[case.specimen.series]} | ({judged} if judged is not None else set())
    moves = [_state[f"without {one}"] - _state["all"] for one in out]
    places = np.clip(_state["all"] + np.sum(moves, axis=0), *fit_model.sides())
    return peer.column(case.specimen, model_parameters=fit_model.at(places))


class Numbers(NamedTuple):
    """A left-out test against its prediction.

    Attributes
    ----------
    near : float
        How near the model is to its shear strength.
    logs : dict of str to float
        ln of test over model. Of a drift at loss that the model does not come to along the path,
        the largest drift stands for it; NaN where the test did not come to it.
    beyond : bool
        Whether the model does not lose its strength along the path, so that there is no upper end.
    """

    near: float
    logs: dict[str, float]
    beyond: bool


def _numbers(task: tuple[int, int | None]) -> Numbers:
    number, judged = task
    case = fit_model._cases[number]
    d, test, height = case.target.displacement, case.target.force, case.specimen.length
    column = _column(number, judged)
    force = path_force(column, d)
    ours, theirs = numbers(d, force, height), numbers(d, test, height)
    ours["stiffness"], theirs["stiffness"] = secant_stiffness(d, force), secant_stiffness(d, test)
    beyond = math.isnan(ours["drift"])
    if beyond:
        ours["drift"] = float(np.max(np.abs(d))) / height
    logs = {}
    for name, value in ours.items():
        known = value > 0 and theirs[name] > 0
        logs[name] = math.log(theirs[name] / value) if known else math.nan
    return Numbers(near_shear(column, float(np.max(np.abs(force)))), logs, beyond)


def _band(task: tuple[int, int | None, int, Scatter]) -> tuple[np.ndarray, float]:
    """Return distances from the prediction over the half band, and the mean width of the band."""
    number, judged, samples, scatter = task
    case, column = fit_model._cases[number], _column(number, judged)
    d = case.target.displacement
    force = path_force(column, d)
    up, down = half_band(force, sample(column, d, scatter, samples), scatter)
    at = PathPoints(d, POINTS, "displacement")
    way, above, below = at(case.target.force) - at(force), at(up), at(down)
    peak = float(np.max(np.abs(force)))
    return np.where(way > 0, way / above, -way / below), float(np.mean(above + below)) / peak


# ---- quantiles -----------------------------------------------------------------------------------


def quantile(values: np.ndarray, weight: np.ndarray, share: float) -> float:
    """Return the value with a share of the weight below."""
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(below, share * below[-1], side="left")])


def both(near: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return which tests are far from the shear strength, and which at it."""
    return near < 0.5, near >= 0.5


def between(ends: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Return numbers between those far from the shear strength and at it, shape (tests, ...)."""
    return ends[0] + near.reshape(-1, *(1 for _ in ends.shape[1:])) * (ends[1] - ends[0])


class Tests:
    """Left-out tests with what is needed for quantiles: of a number, or of the band."""

    def __init__(self, series: np.ndarray, group: np.ndarray, near: np.ndarray) -> None:
        self.group, self.near = group, near
        self.weight = np.array([1 / math.sqrt(np.sum(series == name)) for name in series])

    def ends(self, chosen: np.ndarray, tail: float) -> np.ndarray:
        """Return the ends far from the shear strength and at it."""
        raise NotImplementedError

    def held(self, ends: np.ndarray) -> np.ndarray:
        """Return the share of each test that is within the ends; NaN if it does not count."""
        raise NotImplementedError

    def tail(self, chosen: np.ndarray) -> float:
        """Return the tail with which chosen groups hold each of them left out to 80 %."""
        groups = sorted(set(self.group[chosen].tolist()))
        share = 1 - LEVEL
        while share > 0.02:
            held = np.full(len(self.near), np.nan)
            for one in groups:
                own = chosen & (self.group == one)
                held[own] = self.held(self.ends(chosen & ~own, share))[own]
            known = np.isfinite(held)
            if np.average(held[known], weights=self.weight[known]) >= LEVEL:
                break
            share -= 0.005
        return share


class Ratios(Tests):
    """A number: ends are those of ln of test over model."""

    def __init__(self, rows: list[Numbers], name: str, *about: np.ndarray) -> None:
        super().__init__(*about)
        self.log = np.array([row.logs[name] for row in rows])
        self.beyond = np.array([row.beyond and name == "drift" for row in rows])
        self.drift = name == "drift"

    def ends(self, chosen: np.ndarray, tail: float) -> np.ndarray:
        """Return the quantiles; a model without a loss tells nothing of the upper one."""
        found = []
        for place in both(self.near):
            low = chosen & place & np.isfinite(self.log)
            high = low & ~self.beyond
            found.append(
                (
                    quantile(self.log[low], self.weight[low], tail / 2),
                    -quantile(-self.log[high], self.weight[high], tail / 2),
                )
            )
        return np.array(found)

    def held(self, ends: np.ndarray) -> np.ndarray:
        """Return which tests are within; one without a loss is, where there is no upper end."""
        low, high = between(ends, self.near).T
        # Beyond the path no more is said than that the loss comes after a part of it.
        low = np.where(self.beyond, np.minimum(low, 0.0), low)
        inside = (low <= self.log) & ((self.log <= high) | self.beyond)
        held = np.where(np.isfinite(self.log), inside, np.nan)
        return np.where(np.isnan(self.log) & self.drift, self.beyond, held)


class Points(Tests):
    """The force along the path: the end is what the band is widened by."""

    def __init__(self, scores: list[np.ndarray], *about: np.ndarray) -> None:
        super().__init__(*about)
        self.scores = np.array(scores)

    def ends(self, chosen: np.ndarray, tail: float) -> np.ndarray:
        """Return the distance over the half band below which the points are."""
        found = []
        for place in both(self.near):
            part = self.scores[chosen & place]
            weight = np.repeat(self.weight[chosen & place], part.shape[1])
            found.append(quantile(part.ravel(), weight, 1 - tail))
        return np.array(found)

    def held(self, ends: np.ndarray) -> np.ndarray:
        """Return the share of the points of each test within the band."""
        return np.mean(self.scores <= between(ends, self.near)[:, None], axis=1)


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
    one = ((1.0, 1.0), (1.0, 1.0))
    return Scatter(**parts, twins=TWINS, force=(1.0, 1.0), peak=one, energy=one, drift=one)


class Fold(NamedTuple):
    """What comes out of some groups, and how it does on all tests."""

    scatter: Scatter
    inside: dict[str, np.ndarray]
    width: np.ndarray


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
    points = Points([row[0] for row in bands], *about)
    ends = points.ends(chosen, points.tail(chosen))
    width = between(ends, points.near) * np.array([row[1] for row in bands])
    inside, found = {"force": points.held(ends)}, {"force": _rounded(ends)}
    for name in NUMBERS:
        ratios = Ratios(rows, name, *about)
        ends = ratios.ends(chosen, ratios.tail(chosen))
        inside[name] = ratios.held(ends)
        found[name] = tuple(_rounded(np.exp(pair)) for pair in ends)
    return Fold(scatter=_with(scatter, found), inside=inside, width=width)


def _rounded(values: np.ndarray) -> tuple[float, ...]:
    return tuple(round(float(value), 3) for value in values)


def _with(scatter: Scatter, found: dict[str, Any]) -> Scatter:
    values = {name: getattr(scatter, name) for name in (*NAMES.values(), "twins")}
    return Scatter(**values, **found)


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


def write(version: str, scatter: Scatter, tables: dict[str, list[str]]) -> None:
    """Put numbers and tables where they belong."""
    path = ROOT / "python/rbsdem/section/scatter.py"
    text = path.read_text("utf-8")
    names = (*NAMES.values(), "twins", "force", *NUMBERS)
    values = "".join(f"        {name}={getattr(scatter, name)!r},\n" for name in names)
    entry = f'    "{version}": Scatter(\n{values}    ),\n'
    text = re.sub(rf'    "{re.escape(version)}": Scatter\(\n.*?\n    \),\n', "", text, flags=re.S)
    start = "SCATTER: dict[str, Scatter] = {\n"
    end = text.index("\n}\n", text.index(start)) + 1
    path.write_text(text[:end] + entry + text[end:], "utf-8")
    path = ROOT / "docs/peer.md"
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
    parser.add_argument("state")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--groups", type=int, default=8)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--version", default=parameters().version, help="of STATE; the newest")
    parser.add_argument("--once", action="store_true", help="samples of each test once")
    parser.add_argument("--write", action="store_true", help="into docs and scatter.py")
    given = parser.parse_args()

    began = time.perf_counter()
    source = given.folder, given.state, given.groups
    _begin(*source)
    cases = fit_model._cases
    series = np.array([case.specimen.series for case in cases])
    group = np.array([_group[name] for name in series.tolist()])
    kinds = np.array([case.specimen.kind for case in cases])
    inside = {name: np.full(len(cases), np.nan) for name in ("force", *NUMBERS)}
    width = np.empty(len(cases))
    with ProcessPoolExecutor(given.jobs, initializer=_begin, initargs=source) as pool:

        def run(function: Any, tasks: list[Any]) -> Iterator[Any]:
            return pool.map(function, tasks, chunksize=4)

        rows = list(run(_numbers, [(i, None) for i in range(len(cases))]))
        once: dict[str, Any] | None = {} if given.once else None
        for judged in range(given.groups):
            own = group == judged
            found = fold(judged, series, group, given.samples, run, once)
            width[own] = found.width[own]
            for name, values in inside.items():
                values[own] = found.inside[name][own]
            seconds = time.perf_counter() - began
            held = inside["force"][own].mean()
            print(f"group {judged + 1}: {held:.2f} within, {seconds:.0f} s", flush=True)
        shipped = fold(None, series, group, given.samples, run, once).scatter
    tables = {
        "scatter": residual_table(rows, series),
        "coverage": coverage_table(inside, width, kinds, group, series),
    }
    for lines in tables.values():
        print("\n" + "\n".join(lines))
    print(f"\n{given.version}: {shipped!r}\n{time.perf_counter() - began:.0f} s")
    if given.write:
        write(given.version, shipped, tables)


if __name__ == "__main__":
    main()
