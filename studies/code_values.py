"""Who predicts the drift at which a column has lost 20 % of its strength: table of docs/codes.md.

    python studies/code_values.py FOLDER [--jobs 2]

FOLDER holds the histories and the table of the tests. For every test that loses 20 % of its
strength, the measured drift is held against the layered model, codes and regressions, all from the
same drawing. A value that has no such drift for a test (a model that does not lose the strength, a
relation for other shapes) is not counted; the number of tests says so. Stiffness is held against
the secant of the test at 70 % of its peak force.
"""

from __future__ import annotations

import argparse
import math
import warnings
from collections.abc import Callable

import numpy as np

from rbsdem import peer
from rbsdem.codes import CodeValues

CLASSES = ("Flexure", "Flexure-Shear", "Shear")


def yield_drift(values: CodeValues, ratio: float) -> float:
    """Drift at yield of a cantilever with a share of its gross stiffness."""
    q = values.quantities
    inertia = math.pi * q.depth**4 / 64 if q.round else q.width * q.depth**3 / 12
    stiffness = ratio * 4700.0 * math.sqrt(q.fc) * inertia
    return values["yield.moment"] * 1e3 * q.span / (3.0 * stiffness)


def asce_41(values: CodeValues) -> float:
    """Drift at the loss of lateral strength: yield and a."""
    return yield_drift(values, values["asce_41.stiffness"]) + values["asce_41.a"]


def haselton(values: CodeValues) -> float:
    """Drift at which a fifth of the strength is lost behind the cap, under one push."""
    cap = yield_drift(values, values["haselton.stiffness"]) + values["haselton.cap"]
    return cap + 0.2 * values["haselton.post_cap"]


def haselton_cyclic(values: CodeValues) -> float:
    """Drift of a cyclic envelope: 0.7 and 0.5 of the two rotations (2016, eqs 12 and 13)."""
    cap = yield_drift(values, values["haselton.stiffness"]) + 0.7 * values["haselton.cap"]
    return cap + 0.1 * values["haselton.post_cap"]


def berry(values: CodeValues) -> float:
    """Drift at bar buckling: yield and the plastic rotation."""
    return yield_drift(values, values["elwood.stiffness"]) + values["berry.rotation"]


DRIFTS: dict[str, Callable[[CodeValues], float]] = {
    "ASCE 41-17, yield + a": asce_41,
    "EN 1998-3, theta_um (A.1)": lambda values: values["ec_8.ultimate"],
    "EN 1998-3, theta_y + theta_um,pl (A.3)": lambda values: (
        values["ec_8.yield"] + values["ec_8.plastic"]
    ),
    "Haselton, one push: cap + 0.2 post-cap": haselton,
    "Haselton, cyclic envelope": haselton_cyclic,
    "Elwood, Moehle 2005, shear": lambda values: values["elwood.shear_drift"],
    "Berry, Eberhard 2005, yield + buckling": berry,
    "Berry, Eberhard 2003, buckling": lambda values: values["berry.buckling"],
}

STIFFNESSES: dict[str, str] = {
    "ASCE 41-17": "asce_41.stiffness",
    "Elwood, Eberhard 2009": "elwood.stiffness",
    "Haselton 2016, to yield": "haselton.stiffness",
}


def attempt(value: Callable[[CodeValues], float], values: CodeValues) -> float:
    """Return a value, NaN where it is not given for a column."""
    if not all(name in values.names() for name in ("yield.moment", "asce_41.stiffness")):
        return math.nan
    try:
        return value(values)
    except ValueError:
        return math.nan


def row(name: str, ratios: list[float]) -> str:
    """Return a row: tests, median of measured over calculated, scatter, share within 25 %."""
    found = np.array([ratio for ratio in ratios if math.isfinite(ratio) and ratio > 0])
    if found.size < 3:
        return f"| {name} | {found.size} | | | |"
    logs = np.log(found)
    near = np.mean(np.abs(logs - np.median(logs)) < math.log(1.25))
    within = np.mean(np.abs(logs) < math.log(1.25))
    return (
        f"| {name} | {found.size} | {np.median(found):.2f} | {np.std(logs):.2f} | "
        f"{100 * within:.0f} % ({100 * near:.0f} %) |"
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("folder")
    parser.add_argument("--jobs", type=int, default=2)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    found = peer.predict(peer.read_specimens(options.folder), jobs=options.jobs)
    tests = []
    for prediction in found:
        if prediction.comparison is None:
            continue
        drawing = peer.draw(prediction.specimen)
        specimen = prediction.specimen
        values = drawing.section().code_values(specimen.length, specimen.axial_load)
        tests.append((prediction, values))
    head = "tests | measured/calculated | sigma_ln | within 25 % (about the median) |"
    for kind in CLASSES:
        lost = [
            (prediction, values)
            for prediction, values in tests
            if prediction.specimen.failure_mode == kind
            and math.isfinite(prediction.score("test_drift_at_loss"))
        ]
        print(f"\n| drift at a loss of 20 %, {kind.lower()} ({len(lost)} tests) | {head}")
        print("| --- | ---: | ---: | ---: | ---: |")
        ratios = [p.score("test_drift_at_loss") / p.score("model_drift_at_loss") for p, _ in lost]
        print(row("layered model", ratios))
        for name, value in DRIFTS.items():
            print(row(name, [p.score("test_drift_at_loss") / attempt(value, v) for p, v in lost]))
    print(f"\n| secant stiffness at 70 % of the peak | {head}")
    print("| --- | ---: | ---: | ---: | ---: |")
    print(row("layered model", [1 / p.score("stiffness_ratio") for p, _ in tests]))
    for name, key in STIFFNESSES.items():
        ratios = []
        for prediction, values in tests:
            if not {key, "yield.moment"} <= set(values.names()):
                continue
            secant = prediction.comparison.test.stiffness
            span = 1e-3 * values.quantities.span
            ratios.append(
                secant * yield_drift(values, values[key]) * span * span / values["yield.moment"]
            )
        print(row(name, ratios))


if __name__ == "__main__":
    main()
