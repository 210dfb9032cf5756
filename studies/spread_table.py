"""The scatter of left-out tests about the model, and what its bands hold: tables of docs/peer.md.

    python studies/spread_table.py FOLDER STATE [--samples 16] [--jobs 2]

STATE is the file in which `studies/fit_model.py` keeps the parameters without each group of series.
Every test is predicted with the parameters without its group. The scatter of strength, stiffness
and drift at loss is split into that between series (laboratories) and that between the tests of a
series. The bands of samples of it are widened until 80 % of the points lie within, every test
alike: by one number for columns far from their shear strength, by another for those at it, as far
as the model says, whatever the test said. The coverage that is printed for a group is that with the
numbers from the other groups.
"""

from __future__ import annotations

import argparse
import json
import math
import warnings
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any

import fit_model
import numpy as np

import rbsdem
from rbsdem import peer
from rbsdem.comparison import strength_loss
from rbsdem.comparison.metrics import secant_stiffness, work
from rbsdem.section import Scatter
from rbsdem.section.spread import near_shear, spread

TWINS = 0.05
LEVEL = 0.8
POINTS = 5

_state: dict[str, list[float]] = {}
_group: dict[str, int] = {}


def _begin(folder: str, state: str, groups: int) -> None:
    warnings.simplefilter("ignore", rbsdem.AccuracyWarning)
    fit_model._begin(folder)
    _state.update(json.loads(Path(state).read_text("utf-8")))
    names = sorted({case.specimen.series for case in fit_model._cases})
    for number in range(groups):
        _group.update(dict.fromkeys(names[number::groups], number))


def _column(number: int) -> Any:
    case = fit_model._cases[number]
    places = np.array(_state[f"without {_group[case.specimen.series]}"])
    return peer.column(case.specimen, model_parameters=fit_model.at(places))


def _numbers(number: int) -> dict[str, float]:
    """Return logarithms of ratios of a left-out test, test over model, and how near shear it is."""
    case = fit_model._cases[number]
    target, height, column = case.target, case.specimen.length, _column(number)
    force, _ = fit_model.forces(column, target.displacement)
    model = np.concatenate((force, np.zeros(target.force.size - force.size)))
    d, test = target.displacement, target.force
    rows = {
        "peak": (np.max(np.abs(test)), np.max(np.abs(model))),
        "stiffness": (secant_stiffness(d, test), secant_stiffness(d, model)),
        "energy": (work(d, test)[-1], work(d, model)[-1]),
        "drift": (strength_loss(d, test) / height, strength_loss(d, model) / height),
    }
    found = {"near": near_shear(column, float(np.max(np.abs(model))))}
    for name, (a, b) in rows.items():
        known = math.isfinite(a) and math.isfinite(b) and a > 0 and b > 0
        found[name] = math.log(a / b) if known else math.nan
    return found


def _band(task: tuple[int, int, Scatter]) -> tuple[np.ndarray, float]:
    """Return distances from the prediction over the half band, and the mean width of the band."""
    number, samples, scatter = task
    case = fit_model._cases[number]
    found = spread(_column(number), case.target.displacement, samples=samples, scatter=scatter)
    at = case.target._points
    test, force = at(case.target.force)[::POINTS], at(found.force)[::POINTS]
    up, down = at(found.upper - found.force)[::POINTS], at(found.force - found.lower)[::POINTS]
    way = test - force
    score = np.where(way > 0, way / up, -way / down)
    return score, float(np.mean(up + down)) / float(np.max(np.abs(found.force)))


def components(values: np.ndarray, series: np.ndarray) -> tuple[float, float]:
    """Return standard deviations between series and within them (analysis of variance)."""
    known = np.isfinite(values)
    values, series = values[known], series[known]
    # Half of a per cent at both ends is not believed.
    values = np.clip(values, *np.quantile(values, (0.02, 0.98)))
    parts = [values[series == name] for name in sorted(set(series))]
    inside = sum(((part - part.mean()) ** 2).sum() for part in parts)
    inside /= len(values) - len(parts)
    size = (len(values) - sum(len(part) ** 2 for part in parts) / len(values)) / (len(parts) - 1)
    between = sum(len(part) * (part.mean() - values.mean()) ** 2 for part in parts)
    between = max(0.0, (between / (len(parts) - 1) - inside) / size)
    return math.sqrt(between), math.sqrt(inside)


def widths(scores: list[np.ndarray], near: np.ndarray) -> tuple[float, float]:
    """Return the numbers below which the given share of points lies, far from shear and at it."""
    ends = []
    for chosen in (near < 0.5, near >= 0.5):
        part = [score for score, one in zip(scores, chosen, strict=True) if one]
        ends.append(float(np.quantile(np.concatenate(part), LEVEL)))
    return ends[0], ends[1]


def ends_of(values: np.ndarray, near: np.ndarray) -> tuple[tuple[float, float], ...]:
    """Return the factors between which the given share of tests lies, far from shear and at it."""
    found = []
    for chosen in (near < 0.5, near >= 0.5):
        part = values[chosen & np.isfinite(values)]
        sides = np.quantile(part, (0.5 - LEVEL / 2, 0.5 + LEVEL / 2))
        found.append(tuple(round(math.exp(side), 3) for side in sides))
    return tuple(found)


def held(
    values: np.ndarray, factors: tuple[tuple[float, float], ...], near: np.ndarray
) -> np.ndarray:
    """Return which values are between the factors."""
    low, high = ((1 - near) * far + near * at for far, at in zip(*factors, strict=True))
    ratio = np.exp(values)
    return (low <= ratio) & (ratio <= high)


def main() -> None:
    """Predict, widen, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("state")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--groups", type=int, default=8)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()

    source = given.folder, given.state, given.groups
    _begin(*source)
    cases = fit_model._cases
    series = np.array([case.specimen.series for case in cases])
    group = np.array([_group[name] for name in series])
    with ProcessPoolExecutor(given.jobs, initializer=_begin, initargs=source) as pool:
        rows = list(pool.map(_numbers, range(len(cases)), chunksize=8))
        near = np.array([row.pop("near") for row in rows])
        logs = {name: np.array([row[name] for row in rows]) for name in rows[0]}
        total = residuals(logs, series)
        factors = {name: ends_of(logs[name], near) for name in ("peak", "energy", "drift")}
        scatter = Scatter(
            strength=round(total["peak"], 3),
            stiffness=round(total["stiffness"], 3),
            degradation=round(total["drift"], 3),
            twins=TWINS,
            force=(1.0, 1.0),
            **factors,
        )
        tasks = [(number, given.samples, scatter) for number in range(len(cases))]
        found = list(pool.map(_band, tasks, chunksize=4))
    scores = [row[0] for row in found]
    numbers = sorted(set(group.tolist()))
    inside, width = np.empty(len(cases)), np.empty(len(cases))
    kept = {name: np.zeros(len(cases), bool) for name in factors}
    for number in numbers:
        others, own = group != number, group == number
        ends = widths([s for s, one in zip(scores, others, strict=True) if one], near[others])
        widen = ends[0] + near * (ends[1] - ends[0])
        for i in np.flatnonzero(own):
            inside[i], width[i] = np.mean(scores[i] <= widen[i]), widen[i] * found[i][1]
        for name in factors:
            without = ends_of(logs[name][others], near[others])
            kept[name][own] = held(logs[name], without, near)[own]
    print("\n| tests | number | points within | mean width | peak | energy | drift at loss |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, chosen in classes_of(cases, group).items():
        cells = []
        for what in factors:
            known = chosen & np.isfinite(logs[what])
            cells.append(f"{np.mean(kept[what][known]):.2f}" if known.sum() else "-")
        print(
            f"| {name} | {chosen.sum()} | {inside[chosen].mean():.2f} | "
            f"{width[chosen].mean():.2f} | {' | '.join(cells)} |"
        )
    force = tuple(round(end, 3) for end in widths(scores, near))
    print(f"\n{replace(scatter, force=force)!r}")


def residuals(logs: dict[str, np.ndarray], series: np.ndarray) -> dict[str, float]:
    """Print where the scatter comes from; return all of it."""
    print("| ln of test over model | tests | mean | laboratories | tests of a series |")
    print("| --- | ---: | ---: | ---: | ---: |")
    total = {}
    for name, values in logs.items():
        known = values[np.isfinite(values)]
        between, inside = components(values, series)
        total[name] = math.hypot(between, inside)
        print(f"| {name} | {known.size} | {known.mean():+.3f} | {between:.3f} | {inside:.3f} |")
    return total


def classes_of(cases: list[fit_model.Case], group: np.ndarray) -> dict[str, np.ndarray]:
    """Return which tests belong to each line of the table."""
    kinds = np.array([case.specimen.kind for case in cases])
    found = {
        kind: kinds == kind
        for kind in (
            f"{form}, {mode}"
            for form in ("rectangular", "round")
            for mode in ("Flexure", "Flexure-Shear", "Shear")
        )
    }
    for number in sorted(set(group.tolist())):
        found[f"series group {number + 1}"] = group == number
    return found | {"all": np.ones(len(cases), bool)}


if __name__ == "__main__":
    main()
