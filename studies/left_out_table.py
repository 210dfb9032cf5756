"""Stiffness, small cycles and largest forces of left-out tests: tables of docs/evidence.md.

    python studies/left_out_table.py FOLDER

Each test is predicted with the parameters that were fitted without its group of series
(`studies/fit_model.py`). Model over test: secants at shares of the peak, each curve of its own;
work up to the last zero of the displacement before 0.5 % drift, where there is a cycle of 0.1 % or
more before it. Test over model: the largest force, and the largest moment at the foot, whose
section theory is the peak of the moment-curvature diagram with the confined core (Mander) at the
strengths of the table.
"""

from __future__ import annotations

import argparse

import fit_model
import numpy as np
import spread_table

from rbsdem.curves.metrics import secant_stiffness, work
from rbsdem.errors import RbsdemError
from rbsdem.run.bands import path_force
from rbsdem.section import diagram
from rbsdem.section.strength import shear_sizes

LEVELS = (0.2, 0.3, 0.5)
#: Drift of small cycles, and the least amplitude of one.
SMALL, LEAST = 0.005, 0.001


def small_work(d: np.ndarray, force: np.ndarray, height: float) -> float:
    """Return the work of the cycles below 0.5 % drift [J]; NaN if there is none."""
    inside = np.abs(d) <= SMALL * height
    d = d if np.all(inside) else d[: np.argmin(inside)]
    zeros = np.flatnonzero(d[1:] * d[:-1] <= 0)
    if not zeros.size or min(d[: zeros[-1] + 1].max(), -d.min()) < LEAST * height:
        return np.nan
    return float(work(d, force[: d.size])[zeros[-1]])


def numbers(i: int) -> list[float]:
    """Return ratios of a test, model over test, then test over model, and over section theory."""
    case = fit_model._cases[i]
    d, test, column = case.target.displacement, case.target.force, spread_table._column(i, None)
    height, load = case.specimen.length, case.specimen.axial_load
    force = path_force(column, d, rig=True)
    found = [
        secant_stiffness(d, force, level=x) / secant_stiffness(d, test, level=x) for x in LEVELS
    ]
    found.append(small_work(d, force, height) / small_work(d, test, height))
    ours, theirs = (float(np.max(np.abs(f * height + load * d))) for f in (force, test))
    try:
        theory = diagram(column.drawing.section, load, confined=True).events.peak.moment
    except (RbsdemError, AttributeError):
        theory = np.nan
    peak = float(np.max(np.abs(test)) / np.max(np.abs(force)))
    return [*found, peak, theirs / ours, theirs / theory, ours / theory]


def parts() -> dict[str, np.ndarray]:
    """Return the tests of each row: classes, then flexural tests by what may explain a peak."""
    tests = [case.specimen for case in fit_model._cases]
    kinds = np.array([one.kind for one in tests])
    found = {kind: kinds == kind for kind in sorted(set(kinds.tolist()))}
    bends = np.array([one.failure_mode == "Flexure" for one in tests])
    sections = [case.column.drawing.section for case in fit_model._cases]
    by = {
        "n": ([one.axial_load_ratio for one in tests], (0.05, 0.15, 0.3, 0.45)),
        "f'c, MPa": ([one.concrete.fc / 1e6 for one in sections], (40, 60, 90)),
        "tie ratio times f_yt/f'c": (
            [like.tie_ratio * like.tie_yield / like.fc for like in map(shear_sizes, sections)],
            (0.03, 0.06, 0.12),
        ),
        "f_u/f_y": ([max(s.fu / s.fy for _, _, s in one.bars) for one in sections], (1.3, 1.5)),
        "depth, m": ([one.depth for one in sections], (0.21, 0.31, 0.41)),
    }
    for name, (values, ends) in by.items():
        value = np.array(values, dtype=float)
        for low, high in zip((-np.inf, *ends), (*ends, np.inf), strict=True):
            text = f"from {low:g}" if high == np.inf else f"below {high:g}"
            if np.isfinite(low + high):
                text = f"{low:g} to {high:g}"
            found[f"flexure, {name} {text}"] = bends & (value >= low) & (value < high)
    return found | {"flexure": bends, "all": np.ones(len(tests), bool)}


def main() -> None:
    """Predict, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    spread_table._begin(parser.parse_args().folder)
    rows = np.array([numbers(i) for i in range(len(fit_model._cases))])
    with np.errstate(invalid="ignore"):
        logs = np.log(rows)
    groups = parts()
    print("| model over test: median, sd of ln | tests | " + " | ".join(
        f"secant at {level:.0%}" for level in LEVELS
    ) + " | small cycles: work, tests |")  # fmt: skip
    print("| --- |" + " ---: |" * 5)
    for name, own in groups.items():
        if "flexure, " in name:
            continue
        cells = [
            f"{np.nanmedian(rows[own, j]):.2f}, {np.nanstd(logs[own, j]):.2f}" for j in range(3)
        ]
        known = int(np.isfinite(rows[own, 3]).sum())
        cells.append(f"{np.nanmedian(rows[own, 3]):.2f}, {known}")
        print(f"| {name} | {own.sum()} | {' | '.join(cells)} |")
    print("\n| geometric mean | tests | force: test/model | moment: test/model | test/theory "
          "| model/theory |")  # fmt: skip
    print("| --- |" + " ---: |" * 5)
    for name, own in groups.items():
        cells = " | ".join(f"{np.exp(np.nanmean(logs[own, j])):.3f}" for j in range(4, 8))
        print(f"| {name} | {own.sum()} | {cells} |")


if __name__ == "__main__":
    main()
