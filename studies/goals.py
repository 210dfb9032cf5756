"""What the layered model was to reach, and what it reaches: the table of docs/peer.md.

    python studies/goals.py FOLDER LEFT_OUT [--jobs 2]

FOLDER holds the histories and the table of the tests; LEFT_OUT is the csv of the scores of tests
that were left out (`studies/fit_model.py --out`). Scores are given as labelled and with doubtful
labels mended (`rbsdem.peer.check`).
"""

from __future__ import annotations

import argparse
import csv
import statistics
import warnings
from pathlib import Path

import numpy as np
from blind_table import NOT_FITTED

import rbsdem
from rbsdem import peer

GOALS = {
    "rectangular, Flexure": 0.105,
    "rectangular, Flexure-Shear": 0.13,
    "rectangular, Shear": 0.15,
    "round, Flexure": 0.12,
    "round, Flexure-Shear": 0.12,
    "round, Shear": 0.12,
}
OLD, NEW = "2026.2", "2026.3"


def series_scores(rows: list[tuple[str, float]]) -> tuple[float, float]:
    """Return the mean of series means and the median of series medians."""
    parts: dict[str, list[float]] = {}
    for name, value in rows:
        parts.setdefault(name, []).append(value)
    means = statistics.fmean(statistics.fmean(part) for part in parts.values())
    return means, statistics.median(statistics.median(part) for part in parts.values())


def main() -> None:
    """Predict, read, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("left_out", type=Path)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()

    warnings.simplefilter("ignore", rbsdem.AccuracyWarning)
    with given.left_out.open(encoding="utf-8") as file:
        left_out = {row["name"]: row for row in csv.DictReader(file)}
    tests = peer.read_specimens(given.folder).with_history()
    mended = peer.check(tests).mended()
    found = {
        (version, what): peer.predict(chosen, version=version, jobs=given.jobs)
        for version in (OLD, NEW)
        for what, chosen in (("labelled", tests), ("mended", mended))
    }
    print(
        f"| median nrmse | tests | {OLD}, labelled | {OLD}, mended | {NEW}, labelled | "
        f"{NEW}, mended | {NEW}, left out | goal | peak, energy ratio left out |"
    )
    print("| --- |" + " ---: |" * 8)
    for kind, goal in [*GOALS.items(), ("all", None)]:
        cells = []
        for rows in found.values():
            values = [row.nrmse for row in rows if kind in (row.specimen.kind, "all")]
            cells.append(f"{statistics.median(values):.3f}")
        own = [row for row in left_out.values() if kind in (row["kind"], "all")]
        medians = [
            statistics.median(float(row[name]) for row in own)
            for name in ("nrmse", "peak_ratio", "energy_ratio")
        ]
        print(
            f"| {kind} | {len(own)} | {' | '.join(cells)} | {medians[0]:.3f} | "
            f"{goal or '-'} | {medians[1]:.2f}, {medians[2]:.2f} |"
        )
    cells, others = [], []
    for rows in found.values():
        means, medians_of = series_scores([(row.specimen.series, row.nrmse) for row in rows])
        cells.append(f"{means:.4f}")
        others.append(f"{medians_of:.4f}")
    own = series_scores([(row["series"], float(row["nrmse"])) for row in left_out.values()])
    size = len(left_out)
    print(f"| mean of series means | {size} | {' | '.join(cells)} | {own[0]:.4f} | 0.125 | |")
    print(f"| median of series medians | {size} | {' | '.join(others)} | {own[1]:.4f} | | |")
    print(f"\n| tests that {OLD} was not fitted to | number | {OLD} | {NEW}, left out |")
    print("| --- | ---: | ---: | ---: |")
    older = {row.specimen.name: row for row in found[OLD, "mended"]}
    for known, text in ((False, "not in its fit"), (True, "in its fit")):
        for kind in (*GOALS, "all"):
            rows = [
                (older[name].nrmse, float(row["nrmse"]))
                for name, row in left_out.items()
                if kind in (row["kind"], "all")
                and (older[name].specimen.file or "").startswith(NOT_FITTED) != known
            ]
            if rows:
                a, b = (
                    f"{np.median(side):.3f} ({np.mean(side):.3f})"
                    for side in zip(*rows, strict=True)
                )
                print(f"| {text}: {kind} | {len(rows)} | {a} | {b} |")
    for key, rows in found.items():
        ended = sum(row.status == "completed" for row in rows)
        each = statistics.median(1e3 * row.seconds for row in rows)
        print(f"{' '.join(key)}: {ended} of {len(rows)} to their end, {each:.1f} ms each (median)")
    print("\nThe thirty worst, left out:")
    worst = sorted(left_out.items(), key=lambda item: -float(item[1]["nrmse"]))[:30]
    for name, row in worst:
        print(
            f"{row['nrmse']} {name} ({row['kind']}), peak {row['peak_ratio']}, "
            f"energy {row['energy_ratio']}"
        )


if __name__ == "__main__":
    main()
