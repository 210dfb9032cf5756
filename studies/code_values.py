"""Who predicts the drift at which a column has lost 20 % of its strength: table of docs/codes.md.

    python studies/code_values.py FOLDER

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

import numpy as np

from rbsdem import peer
from rbsdem.checks.code_values import DRIFTS_AT_LOSS, drift_at_loss, yield_drift
from rbsdem.codes import code_values

CLASSES = ("Flexure", "Flexure-Shear", "Shear")


STIFFNESSES: dict[str, str] = {
    "ASCE 41-17": "asce_41.stiffness",
    "Elwood, Eberhard 2009": "elwood.stiffness",
    "Haselton 2016, to yield": "haselton.stiffness",
}


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
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    found = peer.predict(peer.read_specimens(options.folder))
    tests = []
    for prediction in found:
        if prediction.comparison is None:
            continue
        specimen = prediction.specimen
        section = peer.draw(specimen).section
        values = code_values(section, specimen.length, specimen.axial_load)
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
        for name in DRIFTS_AT_LOSS:
            drifts = [drift_at_loss(values, name) for _, values in lost]
            measured = [prediction.score("test_drift_at_loss") for prediction, _ in lost]
            ratios = list(np.divide(measured, drifts))
            print(row(name, ratios))
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
            ratios.append(secant * yield_drift(values, key) * span * span / values["yield.moment"])
        print(row(name, ratios))


if __name__ == "__main__":
    main()
