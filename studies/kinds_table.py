"""What bands hold of kinds of tests that were left out whole: a table of docs/prediction.md.

    python studies/kinds_table.py FOLDER [--samples 16] [--jobs 2] [--write]

Each kind is predicted by a model, a scatter and quantiles that have seen none of it: columns at the
ends of a property, a laboratory with more than eight tests, a decade. The parameters without a kind
are a step of Gauss-Newton from those of all tests, less the step of all tests themselves: leaving
out is additive to first order. Everything else is that of `studies/spread_table.py --once`.

**Rule.** A column outside the range of the tests (`column.warnings`) has a wider band and wider
intervals: four numbers, of force, peak, work and drift at loss. With each of them the kinds at the
ends of a property hold 80 % in the mean, every kind alike; a kind is judged with the numbers of the
others. Laboratories and decades are within the range, so nothing widens. The last column is the
width that would hold 80 % of the points of that kind.

`--write` puts the table into docs/prediction.md and the numbers into data/layered_spread.json.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from typing import Any, NamedTuple

import fit_model
import numpy as np
import spread_table
from spread_quantiles import LEVEL, Points, Ratios, between
from spread_table import NUMBERS, SHAPE

from rbsdem.run.bands import likeness

#: What a band or an interval may be multiplied by.
WIDER = np.arange(1.0, 3.001, 0.05).round(2)
#: A laboratory has more tests than this.
FEW = 8


def ends_of_properties(case: fit_model.Case) -> dict[str, bool]:
    """Return which kinds a test belongs to."""
    section, test = case.column.drawing.section, case.specimen
    like, ties = likeness(section, test.length, test.axial_load), section.ties
    axial, span = like["axial_load_ratio"], like["span_depth_ratio"]
    bar = section.bar_diameter or np.nan
    return {
        "n above 0.6": axial > 0.6,
        "L/h up to 1.5": span < 1.501,
        "L/h up to 2 and n above 0.3": span < 2.001 and axial > 0.3,
        "L/h above 6": span > 6.0,
        "depth up to 0.21 m": section.depth < 0.211,
        "depth above 0.5 m": section.depth > 0.501,
        "ties below 0.5 MPa, or none": like["tie_ratio"] * section.concrete.fc < 0.5e6,
        "ties at more than 10 d_b": ties is not None and ties.spacing > 10.001 * bar,
        "concrete above 80 MPa": section.concrete.fc > 80e6,
    }


class Kind(NamedTuple):
    """A kind against the model without it; the first axis is that of force and numbers.

    Attributes
    ----------
    name : str
    outside : bool
        Whether its columns are outside the range of the others.
    number, laboratories : int
    held : ndarray, shape (4, widths)
        Shares within the band and the intervals.
    score : ndarray, shape (4, widths)
        Interval scores: of the force over its peak, of logarithms of the numbers.
    needed : float
        Width that holds 80 % of the points.
    """

    name: str
    outside: bool
    number: int
    laboratories: int
    held: np.ndarray
    score: np.ndarray
    needed: float


def judge(low: np.ndarray, high: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Return shares within and interval scores by width.

    A value that is NaN does not count; one that is infinite is outside, and has no score.
    """
    known = ~np.isnan(value)
    low, high, value = low[known], high[known], value[known]
    found = []
    for wider in WIDER:
        beyond = np.maximum(value - wider * high, 0) + np.maximum(wider * low - value, 0)
        # An interval without an upper end has no width.
        width = np.where(np.isinf(high), 0.0, wider * (high - low))
        scores = width + 2 / (1 - LEVEL) * beyond
        found.append((np.mean(beyond == 0), np.mean(scores[np.isfinite(scores)])))
    return np.array(found).T


def kind_of(
    name: str, outside: bool, own: np.ndarray, about: tuple[np.ndarray, np.ndarray],
    known: tuple[list[Any], list[Any]], rows: list[Any], bands: list[Any],
) -> Kind:  # fmt: skip
    """Judge a kind with quantiles of the others, which are known with their groups left out."""
    near = np.array([row.near for row in known[0]])
    here = np.array([row.near for row in rows])
    points = Points(np.array([band.scores(SHAPE) for band in known[1]]), *about, near)
    wider = between(points.ends(~own, points.tail(~own)), here)[:, None]
    half = [np.array([getattr(b, side) for b in bands]) + SHAPE for side in ("below", "above")]
    way = np.array([band.way for band in bands])
    found = [judge(*(x.ravel() for x in (-wider * half[0], wider * half[1], way)))]
    for what in NUMBERS:
        ratios = Ratios(known[0], what, *about, near)
        low, high = between(ratios.ends(~own, ratios.tail(~own)), here).T
        log = np.array([row.logs[what] for row in rows])
        if what == "drift":
            beyond = np.array([row.beyond for row in rows])
            low = np.where(beyond, np.minimum(low, 0.0), low)
            high = np.where(beyond, np.inf, high)
            # A test without a loss is within an interval without an upper end alone.
            log = np.where(np.isnan(log), np.where(beyond, 0.0, np.inf), log)
        found.append(judge(low, high, log))
    held, score = np.array(found).transpose(1, 0, 2)
    laboratories = len(set(about[0][own].tolist()))
    scores = np.array([band.scores(SHAPE) for band in bands]) / wider
    needed = float(np.quantile(scores, LEVEL))
    return Kind(name, outside, int(own.sum()), laboratories, held, score, needed)


def enough(kinds: list[Kind]) -> np.ndarray:
    """Return the places of the least widths with which kinds hold 80 % in the mean."""
    return np.argmax(np.mean([kind.held for kind in kinds], axis=0) >= LEVEL, axis=1)


def table(kinds: list[Kind]) -> list[str]:
    """Return cover and interval score of the band, and cover of the intervals: before and after."""
    lines = [
        "| left out whole | tests, series | points within | interval score | peak | energy "
        "| drift at loss | for 0.8 |",
        "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |",
    ]
    for kind in kinds:
        others = [one for one in kinds if one.outside and one.name != kind.name]
        at = enough(others) if kind.outside else np.zeros(4, int)
        before = [f"{held:.2f}" for held in kind.held[:, 0]]
        after = [f"{held:.2f}" for held in kind.held[range(4), at]]
        scores = f"{kind.score[0, 0]:.2f}", f"{kind.score[0, at[0]]:.2f}"
        if kind.outside:
            cells = [f"{one}, {two}" for one, two in zip(before, after, strict=True)]
            score = ", ".join(scores)
        else:
            cells, score = before, scores[0]
        lines.append(
            f"| {kind.name} | {kind.number}, {kind.laboratories} | {cells[0]} | {score} | "
            f"{' | '.join(cells[1:])} | {kind.needed:.2f} |"
        )
    return lines


def chosen(cases: list[fit_model.Case], series: np.ndarray) -> list[tuple[str, bool, np.ndarray]]:
    """Return names of kinds, whether they are at the end of a property, and their tests."""
    ends = [ends_of_properties(case) for case in cases]
    kinds = [(name, True, np.array([one[name] for one in ends])) for name in ends[0]]
    for name in sorted(set(series.tolist())):
        if np.sum(series == name) > FEW:
            kinds.append((name, False, series == name))
    decade = np.array([int(case.specimen.year or 0) // 10 * 10 for case in cases])
    for year in sorted(set(decade.tolist()) - {0}):
        kinds.append((f"{year} to {year + 9}", False, decade == year))
    return kinds


def without(search: fit_model.Search, scores: list[Any], every: list[int]) -> Callable[..., Any]:
    """Return a function that gives the places without some tests."""
    slopes = search.slopes(search.start)

    def step(members: list[int]) -> np.ndarray:
        rest = [scores[i] for i in members]
        matrix, gradient = search.normal(members, slopes, rest, search.start)
        damped = matrix + fit_model.DAMPINGS[-1] * np.diag(np.diag(matrix))
        return -np.linalg.solve(damped, gradient)

    whole = step(every)
    return lambda out: search.start + step([i for i in every if not out[i]]) - whole


def main() -> None:
    """Leave out, judge, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--samples", type=int, default=16)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--write", action="store_true", help="into docs and data")
    given = parser.parse_args()

    spread_table._begin(given.folder)
    cases = fit_model._cases
    series = np.array([case.specimen.series for case in cases])
    group = np.array([spread_table._group[name] for name in series.tolist()])
    every, about = list(range(len(cases))), (series, group)
    with ProcessPoolExecutor(
        given.jobs, initializer=spread_table._begin, initargs=(given.folder,)
    ) as pool:

        def predict(members: Any, place: Any, chosen: np.ndarray) -> tuple[list[Any], list[Any]]:
            scatter = spread_table.scatter_of(rows, series, chosen)
            tasks = [(i, place, given.samples, scatter) for i in members]
            own = pool.map(spread_table._numbers, [task[:2] for task in tasks], chunksize=4)
            return list(own), list(pool.map(spread_table._band, tasks, chunksize=4))

        rows = list(pool.map(spread_table._numbers, [(i, None) for i in every], chunksize=4))
        known = predict(every, None, group >= 0)
        search = fit_model.Search(cases, pool, spread_table._all)
        places = without(search, search.scores(every, search.start), every)
        kinds = []
        for name, outside, own in chosen(cases, series):
            found = predict(np.flatnonzero(own).tolist(), places(own), ~own)
            kinds.append(kind_of(name, outside, own, about, known, *found))
    lines = table(kinds)
    wider = WIDER[enough([kind for kind in kinds if kind.outside])].tolist()
    print("\n".join(lines))
    print("\noutside, force and " + ", ".join(NUMBERS) + f": {wider}")
    if given.write:
        spread_table.write({"outside": wider}, {"kinds": lines})


if __name__ == "__main__":
    main()
