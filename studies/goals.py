"""What the layered model was to reach, and what it reaches: the table of docs/peer.md.

    python studies/goals.py FOLDER LEFT_OUT [LEFT_OUT_BEFORE] [--jobs 2]

FOLDER holds the histories and the table of the tests; LEFT_OUT is the csv of the scores of tests
that were left out (`studies/fit_model.py --out`), LEFT_OUT_BEFORE that of the version before.
Scores are given as labelled and with doubtful labels mended (`rbsdem.peer.check`).
"""

from __future__ import annotations

import argparse
import csv
import statistics
import warnings
from pathlib import Path

import rbsdem
from rbsdem import peer
from rbsdem.section import parameters

GOALS = {
    "rectangular, Flexure": 0.105,
    "rectangular, Flexure-Shear": 0.13,
    "rectangular, Shear": 0.15,
    "round, Flexure": 0.12,
    "round, Flexure-Shear": 0.12,
    "round, Shear": 0.12,
}
NEW = parameters().version


def series_scores(rows: list[tuple[str, float]]) -> tuple[float, float]:
    """Return the mean of series means and the median of series medians."""
    parts: dict[str, list[float]] = {}
    for name, value in rows:
        parts.setdefault(name, []).append(value)
    means = statistics.fmean(statistics.fmean(part) for part in parts.values())
    return means, statistics.median(statistics.median(part) for part in parts.values())


def read(path: Path) -> dict[str, dict[str, str]]:
    """Return the rows of a csv of left-out scores by the names of the tests."""
    with path.open(encoding="utf-8") as file:
        return {row["name"]: row for row in csv.DictReader(file)}


def main() -> None:
    """Predict, read, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("left_out", type=Path)
    parser.add_argument("before", type=Path, nargs="?")
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()

    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    left_out = {NEW: read(given.left_out)}
    if given.before:
        left_out = {"before": read(given.before), **left_out}
    tests = peer.read_specimens(given.folder).with_history()
    mended = peer.check(tests).mended()
    found = {
        f"{NEW}, {what}": peer.predict(chosen, jobs=given.jobs)
        for what, chosen in (("labelled", tests), ("mended", mended))
    }
    # Columns of the table: rows of (kind, series, nrmse).
    columns = {
        key: [(row.specimen.kind, row.specimen.series, row.nrmse) for row in rows]
        for key, rows in found.items()
    }
    for version, rows in left_out.items():
        columns[f"{version}, left out"] = [
            (row["kind"], row["series"], float(row["nrmse"])) for row in rows.values()
        ]
    newest = list(left_out[NEW].values())
    print(f"| median nrmse | tests | {' | '.join(columns)} | goal | peak, energy ratio left out |")
    print("| --- |" + " ---: |" * (len(columns) + 3))
    for kind, goal in [*GOALS.items(), ("all", None)]:
        cells = [
            f"{statistics.median(value for k, _, value in rows if kind in (k, 'all')):.3f}"
            for rows in columns.values()
        ]
        own = [row for row in newest if kind in (row["kind"], "all")]
        peak, energy = (
            statistics.median(float(row[name]) for row in own)
            for name in ("peak_ratio", "energy_ratio")
        )
        print(
            f"| {kind} | {len(own)} | {' | '.join(cells)} | {goal or '-'} | "
            f"{peak:.2f}, {energy:.2f} |"
        )
    pairs = [series_scores([row[1:] for row in rows]) for rows in columns.values()]
    for i, (text, goal) in enumerate(
        (("mean of series means", "0.125"), ("median of series medians", ""))
    ):
        cells = [f"{pair[i]:.4f}" for pair in pairs]
        print(f"| {text} | {len(newest)} | {' | '.join(cells)} | {goal} | |")
    for key, rows in found.items():
        ended = sum(row.status == "completed" for row in rows)
        each = statistics.median(1e3 * row.seconds for row in rows)
        print(f"{key}: {ended} of {len(rows)} to their end, {each:.1f} ms each (median)")
    print("\nThe thirty worst, left out:")
    worst = sorted(left_out[NEW].items(), key=lambda item: -float(item[1]["nrmse"]))[:30]
    for name, row in worst:
        print(
            f"{row['nrmse']} {name} ({row['kind']}), peak {row['peak_ratio']}, "
            f"energy {row['energy_ratio']}"
        )


if __name__ == "__main__":
    main()
