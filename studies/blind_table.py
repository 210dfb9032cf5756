"""How good blind prediction is: the tables of docs/evidence.md.

    python studies/blind_table.py FOLDER

FOLDER holds the histories and the table of the tests. Scores are those of `rbsdem.compare`. The
parameters of the model were fitted to the same tests (studies/fit_model.py): that script prints the
scores on the series that were left out.
"""

from __future__ import annotations

import argparse
import statistics
import warnings
from collections.abc import Callable
from itertools import pairwise

import numpy as np

import rbsdem
from rbsdem import peer
from rbsdem.measured.tests import HISTORY_FILES
from rbsdem.section.columns import MODELS

SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio")
CLASSES = (-1.0, 0.05, 0.15, 0.3, 0.45, 1.0)
SIZES = (2, 3, 5, 9, 17)


def line(name: str, rows: list[peer.Prediction]) -> str:
    """Return a row of a table: medians, and the quartiles of the nrmse."""
    if not rows:
        return f"| {name} | 0 | | | | |"
    first, _, third = np.percentile([row.score("nrmse") for row in rows], [25, 50, 75])
    medians = []
    for score in SCORES:
        values = [value for row in rows if np.isfinite(value := row.score(score))]
        medians.append(statistics.median(values) if values else float("nan"))
    nrmse, *ratios = medians
    text = " | ".join(f"{ratio:.2f}" for ratio in ratios)
    return f"| {name} | {len(rows)} | {nrmse:.3f} ({first:.3f} to {third:.3f}) | {text} |"


def table(
    title: str, found: list[peer.Prediction], groups: dict[str, Callable[[peer.Specimen], bool]]
) -> None:
    """Print a table of groups of tests."""
    print(f"\n| {title} | tests | nrmse (quartiles) | peak | energy | stiffness |")
    print("| --- | ---: | ---: | ---: | ---: | ---: |")
    for name, belongs in groups.items():
        print(line(name, [row for row in found if belongs(row.specimen)]))


def by_axial_load(found: list[peer.Prediction]) -> None:
    """Print the flexural tests by their axial load ratio."""
    groups = {}
    for low, high in pairwise(CLASSES):
        name = f"n < {high:g}" if low < 0 else f"{low:g} to {high:g}"
        groups[name] = lambda s, low=low, high=high: (
            s.failure_mode == "Flexure" and low <= s.axial_load_ratio < high
        )
    table("flexure, axial load ratio", found, groups)


def the_papers_four(tests: peer.Specimens, found: dict[str, list[peer.Prediction]]) -> None:
    """Print the four columns of the paper."""
    print("\n| column of the paper | " + " | ".join(f"nrmse, {name}" for name in found) + " |")
    print("| --- |" + " ---: |" * len(found))
    files = {name for names in HISTORY_FILES.values() for name in names}
    for test in tests:
        if test.path is not None and test.path.name in files:
            scores = [
                next(row.score("nrmse") for row in rows if row.specimen == test)
                for rows in found.values()
            ]
            print(f"| {test.name} | " + " | ".join(f"{score:.3f}" for score in scores) + " |")


def bodies(tests: peer.Specimens) -> None:
    """Print how much the number of bodies changes the force."""
    change: dict[int, list[float]] = {n: [] for n in SIZES}
    for specimen in tests:
        d = specimen.test().displacement
        forces = {n: rbsdem.cyclic(peer.column(specimen, n=n), displacement=d).force for n in SIZES}
        finest = forces[SIZES[-1]]
        for n, force in forces.items():
            rows = min(len(force), len(finest))
            gap = force[:rows] - finest[:rows]
            change[n].append(float(np.sqrt(np.mean(gap**2)) / np.max(np.abs(finest))))
    print(f"\n| bodies | rms change of the force to {SIZES[-1]}: median | largest |")
    print("| ---: | ---: | ---: |")
    for n in SIZES[:-1]:
        print(f"| {n} | {statistics.median(change[n]):.1e} | {max(change[n]):.1e} |")


def main() -> None:
    """Predict, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    given = parser.parse_args()

    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    tests = peer.read_specimens(given.folder).with_history()
    found = {}
    for model in MODELS:
        found[model] = peer.predict(tests, model)
        ended = sum(row.status == "completed" for row in found[model])
        each = [1e3 * row.seconds for row in found[model]]
        print(
            f"\n{model}: {ended} of {len(tests)} tests to their end; a test takes "
            f"{statistics.median(each):.1f} ms (median)"
        )
        groups = {"rectangular, all": lambda s: s.section == "rectangular"}
        for section, members in (("rectangular", ("rectangular",)), ("round", None)):
            for mode in ("Flexure", "Flexure-Shear", "Shear"):
                groups[f"{section}, {mode}"] = lambda s, members=members, mode=mode: (
                    s.failure_mode == mode
                    and (s.section in members if members else s.section != "rectangular")
                )
        table(f"model {model}", found[model], groups)
    rectangular = tests.where(section="rectangular")
    names = {row.name for row in rectangular}
    layered = [row for row in found["layered"] if row.specimen.name in names]
    by_axial_load(layered)
    series = sorted({row.specimen.series for row in layered})
    table("series", layered, {name: lambda s, name=name: s.series == name for name in series})
    the_papers_four(rectangular, found)
    bodies(rectangular.where(failure_mode="Flexure"))


if __name__ == "__main__":
    main()
