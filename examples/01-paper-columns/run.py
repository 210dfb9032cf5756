"""The four columns of the paper against their tests: predicted from their drawings, and as there.

    python examples/01-paper-columns/run.py [--peer DIR] [--out DIR] [--pdf] [--no-plot]

(a) Table 2 of the paper, which is what the drawings show, becomes columns of the layered model. The
    measured displacement drives them on the static path. No result of the tests is used.
(b) The measured force drives one-component models with the springs of table 3, as in figure 3 of
    the paper: equation 4 (finite rotations, inertia of the real column, no axial load) by RK4, and
    the static path of the same column; the two are compared.
(c) The measured displacement drives the models of (b) on the static path with P-Delta.

The force of these tests is the net horizontal force, which is the lateral load of the models in (a)
and (c).

The full measured histories are taken from --peer, from the environment variable RBSDEM_PEER_DIR or
from ../shared/peer beside the checkout. Without them, the reversal points that come with rbsdem are
used.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import math
import os
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from rich import box
from rich.console import Console
from rich.table import Table

import rbsdem
from rbsdem import curves as comparison
from rbsdem import plot
from rbsdem.peer import FOLDER_VARIABLE, find_history, measured_loops, shipped_reversals
from rbsdem.section.paper import PaperSection

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BESIDE = Path(__file__).resolve().parents[3] / "shared" / "peer"

# Number of rows between two reversal points, about as many as in the histories. They follow half a
# cosine, because a test also slows down where it turns.
ROWS_PER_LEG = 30

# Seconds for one row of a test in RK4. The first natural period is about 0.01 s elastic and 0.06 s
# after yield. There is no damping in equation 4, so the column overshoots where the force turns, in
# proportion to its speed: 0.05 s leave 2 to 4 % of the peak displacement, 0.1 s 1 to 2 %.
ROW_TIME = 0.1

# RK4 step as a share of the largest stable one; the higher mode only has to stay small.
STEP_SHARE = 0.5

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Drive:
    """Measured rows of a test, and what drives the model through them.

    `displacement` and `force` [m, N] are the path of the model; `rows` picks the measured rows out
    of it (all of them where the full history is there).
    """

    key: str
    displacement: Vector
    force: Vector
    rows: NDArray[np.intp]
    full: bool
    source: str


@dataclass(frozen=True)
class Run:
    """One test and one model: what the table and a panel show."""

    drive: Drive
    test: comparison.Loop
    model: comparison.Loop
    nrmse: float
    curve: tuple[Vector, Vector]
    static_difference: float | None = None


def read(key: str, folder: Path | None) -> Drive:
    """Return the full history of a test if it can be found, else its reversal points."""
    path = find_history(key, folder)
    if path is None and folder is None and not os.environ.get(FOLDER_VARIABLE) and BESIDE.is_dir():
        path = find_history(key, BESIDE)
    if path is not None:
        test = rbsdem.peer.read_peer(path)
        rows = np.arange(len(test.force))
        source = f"full history, {len(rows)} rows ({path.name})"
        return Drive(key, test.displacement, test.force, rows, True, source)
    points = shipped_reversals(key)
    rows = np.arange(len(points.force)) * ROWS_PER_LEG
    leg = 0.5 - 0.5 * np.cos(np.pi * np.arange(ROWS_PER_LEG) / ROWS_PER_LEG)
    at = np.append(np.add.outer(np.arange(len(rows) - 1), leg).ravel(), len(rows) - 1)
    displacement, force = (
        np.interp(at, np.arange(len(rows)), values)
        for values in (points.displacement, points.force)
    )
    source = f"{len(rows)} reversal points"
    named = folder or os.environ.get(FOLDER_VARIABLE)
    if named:
        source += f" (no history of this test in {named})"
    return Drive(key, displacement, force, rows, False, source)


def by_force(drive: Drive, column: rbsdem.Column, row_time: float) -> tuple[Run, float]:
    """Drive a column by the measured force, by RK4 on equation 4 and on the static path.

    Returns the run and the seconds that the two analyses took.
    """
    small = dataclasses.replace(column, axial_load=0.0, kinematics="small")
    finite = dataclasses.replace(column, axial_load=0.0, kinematics="finite")
    at = np.arange(len(drive.force)) * row_time
    start = time.perf_counter()
    static = rbsdem.cyclic(small, force=drive.force)
    # A whole number of steps in a row, so that results come at the rows.
    dt = row_time / math.ceil(row_time / (STEP_SHARE * rbsdem.modes(finite).stable_step))
    dynamic = rbsdem.time_history(finite, at, force=drive.force, dt=dt, method="rk4")
    seconds = time.perf_counter() - start

    model = np.interp(at, dynamic.time, dynamic.displacement)
    difference = np.max(np.abs(model - static.displacement)) / np.max(np.abs(static.displacement))
    if drive.full:
        metrics = comparison.displacement_metrics(drive.force, drive.displacement, model)
        test, loop, nrmse = metrics.test, metrics.model, metrics.nrmse
    else:
        test = measured_loops()[drive.key]
        loop = comparison.summarise(model, drive.force)
        nrmse = rms_over_peak(model, drive.displacement, drive.rows)
    return Run(drive, test, loop, nrmse, (model, drive.force), float(difference)), seconds


def by_displacement(drive: Drive, column: rbsdem.Column) -> tuple[Run, float]:
    """Drive a column by the measured displacement on its static path with P-Delta.

    Returns the run and the seconds that the analysis took.
    """
    pdelta = dataclasses.replace(column, kinematics="pdelta")
    start = time.perf_counter()
    static = rbsdem.cyclic(pdelta, displacement=drive.displacement)
    seconds = time.perf_counter() - start

    if drive.full:
        scores = rbsdem.compare(static, (drive.displacement, drive.force))
        test, loop, nrmse = scores.test, scores.model, scores.nrmse
    else:
        test = measured_loops()[drive.key]
        loop = comparison.summarise(drive.displacement, static.force)
        nrmse = rms_over_peak(static.force, drive.force, drive.rows)
    return Run(drive, test, loop, nrmse, (drive.displacement, static.force)), seconds


def from_drawing(drive: Drive, section: PaperSection) -> tuple[Run, float]:
    """Make the layered column of table 2 and drive it by the measured displacement.

    Returns the run and the seconds that the model and the analysis took.
    """
    start = time.perf_counter()
    column = rbsdem.section.column(section.section, section.length, axial_load=section.axial_load)
    seconds = time.perf_counter() - start
    run, taken = by_displacement(drive, column)
    return run, seconds + taken


def rms_over_peak(model: Vector, test: Vector, rows: NDArray[np.intp]) -> float:
    """Root mean square difference at some rows over the largest absolute test value there."""
    error = model[rows] - test[rows]
    return float(np.sqrt(np.mean(error**2)) / np.max(np.abs(test[rows])))


QUANTITIES = (
    ("Peak\nforce", "kN", "peak_force", 1e-3),
    ("Displ.\nat peak", "mm", "displacement_at_peak", 1e3),
    ("Largest\ndispl.", "mm", "peak_displacement", 1e3),
    ("\nEnergy", "kJ", "energy", 1e-3),
    ("Stiff-\nness", "kN/mm", "stiffness", 1e-6),
)


def print_histories(console: Console, measured: dict[str, Drive]) -> None:
    """Print which measured rows are used."""
    console.print("[bold]Measured histories[/bold]")
    for key, drive in measured.items():
        line = f"  {rbsdem.peer.paper_sections()[key].specimen:<20}{drive.source}"
        console.print(line, markup=False, soft_wrap=True)
    if not all(drive.full for drive in measured.values()):
        console.print(
            "  With reversal points, the rms error below is taken at these points alone. The\n"
            "  other values of the test are those of its history (data/measured_loops.csv).\n"
            f"  To use the full histories: --peer DIR or {FOLDER_VARIABLE}; data/README.md."
        )
    console.print()


def print_table(console: Console, title: str, error: str, notes: str, runs: dict[str, Run]) -> None:
    """Print test, model and ratio for each specimen, and what the columns mean."""
    sections = rbsdem.peer.paper_sections()
    dynamic = any(run.static_difference is not None for run in runs.values())
    out = Table(box=box.SIMPLE_HEAD, padding=0, show_edge=False)
    out.add_column("\n\nSpecimen")
    for name, unit, _, _ in QUANTITIES:
        out.add_column(f"{name}\n{unit}", justify="right")
    out.add_column(f"{error}\n%", justify="right")
    if dynamic:
        out.add_column("RK4 -\nstatic\n%", justify="right")
    for key, run in runs.items():
        test = [getattr(run.test, name) * scale for _, _, name, scale in QUANTITIES]
        model = [getattr(run.model, name) * scale for _, _, name, scale in QUANTITIES]
        last = [f"{100 * run.nrmse:.1f}"]
        if run.static_difference is not None:
            last.append(f"{100 * run.static_difference:.2f}")
        out.add_row(f"[bold]{sections[key].specimen}")
        out.add_row("  test", *(f"{value:.1f}" for value in test))
        out.add_row("  model", *(f"{value:.1f}" for value in model), *last)
        ratios = (f"{abs(m / t):.2f}" for m, t in zip(model, test, strict=True))
        out.add_row("  model / test", *ratios, end_section=True)
    console.print(f"[bold]{title}[/bold]\n")
    console.print(out)
    console.print(f"\n[dim]{notes}[/dim]\n")


def write_csv(path: Path, parts: dict[tuple[str, str], dict[str, Run]]) -> None:
    """Write the tables in long form: one row for each model, drive, specimen and quantity."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_suffix(".partial")
    with partial.open("w", encoding="utf-8", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        head = ["model_of", "driven_by", "specimen", "history"]
        rows.writerow([*head, "quantity", "unit", "test", "model", "ratio"])
        for part, runs in parts.items():
            for key, run in runs.items():
                start = [*part, key, "full" if run.drive.full else "reversals"]
                for _, unit, name, scale in QUANTITIES:
                    test, model = (scale * getattr(x, name) for x in (run.test, run.model))
                    numbers = [f"{x:.6g}" for x in (test, model, abs(model / test))]
                    rows.writerow([*start, name, unit, *numbers])
                rows.writerow([*start, "rms_error_over_peak", "1", "", f"{run.nrmse:.6g}", ""])
                if run.static_difference is not None:
                    value = f"{run.static_difference:.6g}"
                    rows.writerow([*start, "rk4_minus_static_over_peak", "1", "", value, ""])
    partial.replace(path)


def panel(run: Run) -> plot.Subplot:
    """Return the panel of a run: model over test."""
    section, rows = rbsdem.peer.paper_sections()[run.drive.key], run.drive.rows
    return plot.Subplot(
        title=section.specimen,
        model=run.curve,
        test=(run.drive.displacement[rows], run.drive.force[rows]),
        height=section.length,
        test_points=not run.drive.full,
    )


def test_label(runs: dict[str, Run]) -> str:
    """Say in the legend whether the test is whole."""
    full = all(run.drive.full for run in runs.values())
    return "Test" if full else "Test (reversal points)"


def one_part(runs: dict[str, Run]) -> Figure:
    """Draw the four panels of one model and drive."""
    panels = plot.four_panels([panel(run) for run in runs.values()], test_label=test_label(runs))
    figure: Figure = panels[0].figure
    return figure


def both_models(drawn: dict[str, Run], paper: dict[str, Run]) -> Figure:
    """Draw the predictions from the drawings in the upper row, the paper's models in the lower."""
    from matplotlib.figure import Figure  # noqa: PLC0415

    with plot.style():
        figure = Figure(figsize=(11.0, 5.6), layout="constrained")
        upper, lower = figure.subfigures(2, 1, squeeze=False).ravel()
        for row, runs, title in (
            (upper, drawn, "Predicted from the drawings (layered model)"),
            (lower, paper, "Springs of the paper's table 3, driven by the measured force"),
        ):
            row.suptitle(title, fontsize=11)
            for i, (ax, run) in enumerate(zip(row.subplots(1, 4), runs.values(), strict=True)):
                shown = panel(run)
                plot.loops_over_test(
                    shown.model,
                    shown.test,
                    title=shown.title,
                    test_points=shown.test_points,
                    legend=False,
                    ax=ax,
                )
                if i > 0:
                    ax.set_ylabel("")
        handles = row.axes[0].get_lines()[:2]
        labels = [test_label(drawn), "Model"]
        figure.legend(handles, labels, loc="outside lower center", ncols=2, handlelength=3.2)
        figure.draw_without_rendering()
    return figure


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog=f"Without --peer, the environment variable {FOLDER_VARIABLE} names the folder.",
    )
    parser.add_argument("--peer", type=Path, metavar="DIR", help="folder of the full histories")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", default=Path("figures"), help="default: ./figures"
    )
    parser.add_argument("--pdf", action="store_true", help="write the figures as PDF too")
    parser.add_argument("--no-plot", action="store_true", help="print and write the tables only")
    parser.add_argument(
        "--row-time",
        type=float,
        metavar="SECONDS",
        default=ROW_TIME,
        help=f"time in which RK4 loads one row of a test (default {ROW_TIME})",
    )
    given = parser.parse_args()
    if not 0 < given.row_time < float("inf"):
        parser.error(f"--row-time {given.row_time}: give a positive number of seconds")
    return given


def main() -> None:
    """Do the main job."""
    given = arguments()
    console = Console(highlight=False)
    columns = rbsdem.peer.paper_columns()
    measured = {key: read(key, given.peer) for key in columns}

    seconds = 0.0
    drawn: dict[str, Run] = {}
    by_drive: dict[str, dict[str, Run]] = {"force": {}, "displacement": {}}
    for key, column in columns.items():
        drawn[key], taken = from_drawing(measured[key], rbsdem.peer.paper_sections()[key])
        seconds += taken
        by_drive["force"][key], taken = by_force(measured[key], column, given.row_time)
        seconds += taken
        by_drive["displacement"][key], taken = by_displacement(measured[key], column)
        seconds += taken

    print_histories(console, measured)
    print_table(
        console,
        "(a) Prediction of rbsdem from the drawings, driven by the measured displacement",
        "rms force\nerror",
        "Error over the measured peak. The model knows of a column what table 2 says. Its\n"
        "parameters, the same for all columns, are fitted to many tests, these four among\n"
        "them; errors with their series left out of the fit are in docs/evidence.md.",
        drawn,
    )
    print_table(
        console,
        "(b) No prediction: the paper's springs, driven by the measured force (its figure 3)",
        "rms displ.\nerror",
        "The paper's springs lose no strength, hence their large errors. Error over the\n"
        "measured peak; RK4 on equation 4. RK4 - static: largest difference of\n"
        "displacement from the static path, over its peak. Stiffness:\n"
        "secant at 70 % of the curve's own peak force.",
        by_drive["force"],
    )
    print_table(
        console,
        "(c) No prediction: the paper's springs, driven by the measured displacement",
        "rms force\nerror",
        "Error over the measured peak. Stiffness: secant at 70 % of the curve's own peak\n"
        "force, which lies after yield where a model reaches far more than the test.",
        by_drive["displacement"],
    )
    console.print(f"Computed in {seconds:.3f} s, apart from reading and plotting.")

    written = [given.out / "comparison.csv"]
    parts = {("drawing", "displacement"): drawn}
    parts |= {("table_3", drive): runs for drive, runs in by_drive.items()}
    write_csv(written[0], parts)
    if not given.no_plot:
        for name, figure in (
            ("columns", both_models(drawn, by_drive["force"])),
            ("predicted", one_part(drawn)),
            ("fig3_force_driven", one_part(by_drive["force"])),
            ("displacement_driven", one_part(by_drive["displacement"])),
        ):
            written += plot.save(figure, given.out / f"{name}.png", pdf=given.pdf)
    for path in written:
        console.print(f"wrote {path}", markup=False, soft_wrap=True)


if __name__ == "__main__":
    try:
        main()
    except rbsdem.InputError as error:
        print(f"run.py: {error}", file=sys.stderr)
        sys.exit(2)
    except (rbsdem.errors.RbsdemError, OSError) as error:
        print(f"run.py: {error}", file=sys.stderr)
        sys.exit(1)
