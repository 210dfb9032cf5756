"""Tell whether more components, vertical displacement and interaction cure one component.

    python studies/components.py FOLDER [--figure]

The paper finds that its one-component models underestimate the displacement capacity of columns,
and leaves open whether more components, vertical displacement and better springs cure that. Its
four columns answer: the springs of its table 3 on one component; springs by its procedure, shared
by 1 to 8 components; layered hinges, in which moment and axial force interact and the column
lengthens and shortens. Driven by the measured displacement (forces, loss of strength) and by the
measured force (displacements).

Printed are, as the mean over the four columns: the ratio of secant stiffness (at 70 % of its own
peak), peak force and drift at 20 % loss of strength to those of the test, the error of the force
(nrmse), and under the measured force the ratio of the peak displacement; in how many of the four
that force is beyond the strength. "--figure" draws docs/components.png. FOLDER holds the measured
tests (docs/peer.md).
"""

from __future__ import annotations

import argparse
import math
import statistics
import warnings
from collections.abc import Callable
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")
from matplotlib import pyplot as plt

import rbsdem
from rbsdem import peer
from rbsdem.measured.tests import HISTORY_FILES

DOCS = Path(__file__).resolve().parents[1] / "docs"

Model = Callable[[str, peer.Specimen], rbsdem.Column]


def shared(n: int) -> Model:
    """Return the maker of n components whose springs follow from the drawing."""
    return lambda key, specimen: peer.column(specimen, "paper", n=n)


def layered(n: int) -> Model:
    """Return the maker of a layered hinge with n - 1 joints above it."""
    return lambda key, specimen: peer.column(specimen, n=n)


MODELS: dict[str, Model] = {
    "table 3, one component": lambda key, specimen: rbsdem.peer.paper_columns("pdelta")[key],
    **{f"paper's springs, N = {n}": shared(n) for n in (1, 2, 4, 8)},
    **{f"layered, N = {n}": layered(n) for n in (2, 4, 8)},
}


def tests(folder: str) -> dict[str, peer.Specimen]:
    """Return the four columns of the paper."""
    table = peer.read_specimens(folder).with_history()
    return {
        key: next(row for row in table if row.path and row.path.name in names)
        for key, names in HISTORY_FILES.items()
    }


def by_force(column: rbsdem.Column, test: peer.MeasuredTest) -> float:
    """Return peak displacement over measured, driven by the measured force; infinite beyond it."""
    try:
        result = rbsdem.cyclic(column, force=test.force)
    except rbsdem.SolveError:
        return math.inf
    if result.summary["status"] != "completed":
        return math.inf
    return abs(result.summary["peak_displacement"]) / float(abs(test.displacement).max())


def measure(model: Model, specimens: dict[str, peer.Specimen]) -> tuple[float, ...]:
    """Return the columns of the table for one model."""
    stiffness, peak, loss, wrong, reach = [], [], [], [], []
    for key, specimen in specimens.items():
        test = specimen.test()
        column = model(key, specimen)
        found = rbsdem.compare(rbsdem.cyclic(column, displacement=test.displacement), test)
        stiffness.append(found.stiffness_ratio)
        peak.append(found.peak_ratio)
        wrong.append(found.nrmse)
        if found.test_drift_at_loss is not None and math.isfinite(found.test_drift_at_loss):
            lost = found.model_drift_at_loss
            kept = lost is None or not math.isfinite(lost)
            loss.append(math.inf if kept else lost / found.test_drift_at_loss)
        reach.append(by_force(column, test))
    beyond = sum(math.isinf(value) for value in reach)
    within = [value for value in reach if math.isfinite(value)]
    never = sum(math.isinf(value) for value in loss)
    reached = [value for value in loss if math.isfinite(value)]
    return (
        statistics.mean(stiffness),
        statistics.mean(peak),
        statistics.mean(wrong),
        statistics.mean(reached) if reached else math.nan,
        never,
        statistics.mean(within) if within else math.nan,
        beyond,
    )


def draw(specimens: dict[str, peer.Specimen]) -> None:
    """Draw one and eight components, and the layered hinge, over the tests."""
    shown = {
        "table 3, one component": "#9a6a1f",
        "paper's springs, N = 8": "#3b8a4b",
        "layered, N = 2": "#1d6fb8",
    }
    figure, axes = plt.subplots(2, 2, figsize=(9, 7), layout="constrained")
    for ax, (key, specimen) in zip(axes.flat, specimens.items(), strict=True):
        test = specimen.test()
        ax.plot(1e3 * test.displacement, test.force / 1e3, color="#9aa3af", lw=1.0, label="test")
        for name, color in shown.items():
            result = rbsdem.cyclic(MODELS[name](key, specimen), displacement=test.displacement)
            ax.plot(1e3 * result.displacement, result.force / 1e3, color=color, lw=0.8, label=name)
        ax.set_title(specimen.name, fontsize=9)
        ax.set_xlabel("displacement [mm]")
        ax.set_ylabel("force [kN]")
    axes[0, 0].legend(fontsize=7, frameon=False)
    figure.savefig(DOCS / "components.png", dpi=110)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--figure", action="store_true")
    given = parser.parse_args()
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    specimens = tests(given.folder)
    print("| model | secant stiffness | peak force | nrmse | ", end="")
    print("drift at loss | never lost | reach | beyond |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for name, model in MODELS.items():
        row = measure(model, specimens)
        cells = [f"{value:.2f}" for value in row[:2]] + [f"{row[2]:.3f}"]
        cells += [f"{row[3]:.2f}", f"{row[4]:.0f}", f"{row[5]:.2f}", f"{row[6]:.0f}"]
        print(f"| {name} | " + " | ".join(cells) + " |")
    if given.figure:
        draw(specimens)


if __name__ == "__main__":
    main()
