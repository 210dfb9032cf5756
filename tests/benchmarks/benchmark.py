"""Times of rbsdem on this machine, goal and measured side by side. Nothing is asserted.

    python tests/benchmarks/benchmark.py [--quick] [--only PART] [--build DIR] [--against OTHER]

Medians over repeats of the processor time, which another load of the machine disturbs less than the
wall time, with the fastest and the slowest. What runs inside Fortran is timed by
`time_solver`, built like the unit tests: meson setup build/fortran, then meson compile -C
build/fortran. There `yardstick` is built too, if there is a C compiler: the same work written by
hand for one case, by which the solver is measured. --against takes the build folder of another
version (of an older commit, say) or its Python interpreter, and runs both in
turns. Rows that need a program that is not
there say so.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import subprocess
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from compare import INSIDE, against_rows, package_rows, yardstick_rows
from rows import ROOT, Row, newest, show

import rbsdem
from rbsdem import _core, peer
from rbsdem.springs import Bilinear, Elastic, Takeda

CHAIN = Takeda(k_c=2.5e8, d_c=3e-4, k_y=6e7, d_y=2.7e-3, k_u=7e6, b1=0.3)


def seconds(action: Callable[[], Any], repeats: int) -> list[float]:
    """Return the times of some calls, after one that does not count."""
    action()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        action()
        times.append(time.process_time() - start)
    return times


def growing_cycles(points: int) -> np.ndarray:
    """Return a cyclic path of the top [m], growing to 3 % drift and back, with inner loops."""
    share = np.arange(1, points + 1) / points
    angle = 2 * np.pi * 20 * share
    return 0.05 * np.sin(np.pi * share) * (np.sin(angle) + 0.2 * np.sin(7 * angle))


def through_python(repeats: int) -> list[Row]:
    """Time analyses through the Python package."""
    column = rbsdem.peer.paper_columns()["soesianawati_1"]
    path = growing_cycles(20_000)
    static = seconds(lambda: rbsdem.cyclic(column, displacement=path), 3 * repeats)
    chain = rbsdem.Column(2.0, 1e4, Elastic(2e7), CHAIN, axial_load=3e5, kinematics="pdelta")
    chains = [dataclasses.replace(chain, n=n) for n in (1, 10)]
    one, ten = (
        seconds(lambda chain=chain: rbsdem.cyclic(chain, displacement=path[::5]), 3 * repeats)
        for chain in chains
    )
    loaded = dataclasses.replace(column, top_mass=744e3 / 9.81)
    time_, motion = record_20_s()
    newmark = seconds(
        lambda: rbsdem.time_history(
            loaded, time_, ground_acceleration=motion, method="newmark", dt=0.005
        ),
        3 * repeats,
    )
    hinged = rbsdem.frames.FrameMember(
        modulus=3e10, area=0.16, inertia=2e-3, flexure=[Bilinear(1e8, 2e-3, 2e6)] * 2
    )
    frame = rbsdem.Frame.grid(
        [3.2] * 3, [6.0] * 3, columns=hinged, beams=hinged, beam_load=1.5e4, floor_mass=1.2e5,
        kinematics="pdelta",
    )  # fmt: skip
    pushed = seconds(lambda: rbsdem.pushover(frame, drift=0.02), 3 * repeats)
    rotation = path / column.height
    spring = Takeda(k_c=2.5428e8, d_c=3.1891e-4, k_y=6.2937e7, d_y=2.7183e-3, k_u=7.5772e6, b1=0.22)
    response = seconds(lambda: spring.response(rotation), 3 * repeats)
    paper = rbsdem.peer.paper_sections()["tanaka_park_5"]
    section, load = paper.section, paper.axial_load
    curvature = np.linspace(0.0, 0.1, 100)
    moments = seconds(
        lambda: rbsdem.section.moment_curvature(section, load, curvature), 3 * repeats
    )
    shear = seconds(
        lambda: rbsdem.section.shear_diagram(section, paper.length, load, furthest=0.022),
        3 * repeats,
    )
    return [
        Row("static, N = 1, 20 000 points", "ms", 10, [1e3 * t for t in static]),
        Row("static, P-Delta, one body, 4000 points", "ms", None, [1e3 * t for t in one]),
        Row("static, P-Delta, ten bodies, 4000 points", "ms", None, [1e3 * t for t in ten]),
        Row("Newmark, N = 1, 4000 steps", "ms", None, [1e3 * t for t in newmark]),
        Row("push-over, 3 x 3 of point hinges", "ms", None, [1e3 * t for t in pushed]),
        Row("Takeda spring, 20 000 points", "ms", None, [1e3 * t for t in response]),
        Row("section, 100 moments", "ms", 5, [1e3 * t for t in moments]),
        Row("section, shear diagram", "ms", 20, [1e3 * t for t in shear]),
    ]


def record_20_s() -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and accelerations [m/s2] of a made-up record, 0.4 g, at 0.005 s."""
    time_ = np.arange(4000) * 0.005
    rng = np.random.default_rng(1)
    motion = np.zeros(time_.size)
    for _ in range(40):
        omega = 2 * np.pi * rng.uniform(0.3, 8.0)
        motion += rng.normal() * np.sin(omega * time_ + rng.uniform(0.0, 2 * np.pi))
    motion *= np.minimum(time_ / 3, 1) * np.exp(-np.maximum(time_ - 8, 0) / 6)
    return time_, 0.4 * 9.81 * motion / np.abs(motion).max()


def predicted_column(repeats: int) -> list[Row]:
    """Time what is done with the layered column that is predicted from a drawing.

    Processor time of this process: wall time on a machine that does nothing else.
    """
    paper = rbsdem.peer.paper_sections()["soesianawati_1"]

    def make() -> rbsdem.Column:
        return rbsdem.section.column(paper.section, paper.length, axial_load=paper.axial_load)

    column = make()
    loaded = dataclasses.replace(column, top_mass=paper.axial_load / 9.81)
    time_, motion = record_20_s()
    path = growing_cycles(4000)
    events = (
        rbsdem.time_history(loaded, time_, ground_acceleration=motion).summary["events"],
        rbsdem.cyclic(column, displacement=path).summary["events"],
    )
    layers = len(column.joints("flexure")[0].layers)
    calls: list[tuple[str, float, str, Callable[[], Any]]] = [
        ("predicted column, 20 s record at 0.005 s", 6, f"{events[0]} events",
         lambda: rbsdem.time_history(loaded, time_, ground_acceleration=motion)),
        ("predicted column, 4000 static points", 3, f"{events[1]} events",
         lambda: rbsdem.cyclic(column, displacement=path)),
        ("predicted column, made from its drawing", 1.5, f"{layers} layers", make),
    ]  # fmt: skip
    rows = []
    for name, goal, note, call in calls:
        call()
        times = []
        for _ in range(5 * repeats):
            start = time.process_time()
            call()
            times.append(1e3 * (time.process_time() - start))
        rows.append(Row(name, "ms", goal, times, note))
    return rows


def crossing(repeats: int) -> list[Row]:
    """Time the way of a column, from Python or from its file, to a solver ready to start."""
    one = rbsdem.peer.paper_columns()["soesianawati_1"]
    paper = rbsdem.peer.paper_sections()["tanaka_park_5"]
    predicted = rbsdem.section.column(paper.section, paper.length, axial_load=paper.axial_load)
    text = predicted.to_namelist() + "&loading drive = 'displacement', values = 0.001 /\n"
    calls: list[tuple[str, float, Callable[[], Any]]] = [
        ("one body, crossing", 0.05, lambda: _core.evaluate("check_structure", one._statement)),
        (
            "predicted column, crossing",
            0.3,
            lambda: _core.evaluate("check_structure", predicted._statement),
        ),
        ("static, N = 1, 2 points", 0.11, lambda: rbsdem.cyclic(one, displacement=[0.001, 0.002])),
    ]
    with tempfile.TemporaryDirectory() as folder:
        case = Path(folder) / "predicted.nml"
        case.write_text(text, encoding="utf-8")
        calls.append(("predicted column, file", 1.0, lambda: _core.read_case(str(case))))
        rows = []
        for name, goal, call in calls:
            times = seconds(lambda call=call: [call() for _ in range(100)], 3 * repeats)
            rows.append(Row(name, "ms", goal, [10.0 * t for t in times]))
    rows[1].note = f"{len(predicted._statement.numbers)} numbers"
    return rows


def each_prediction(quick: bool) -> list[Row]:
    """Time the prediction of each test of the folder: its column, then the path of the test.

    The fastest of a few calls for each test, as other work of the machine counts in the others;
    the values are those of the tests, and the goal is for their mean.
    """
    rows = [
        Row("predicted column, made of its test", "ms"),
        Row("its cyclic path, with the loop", "ms"),
        Row("mean of both over the tests", "ms", 5),
    ]
    folder = Path(os.environ.get("RBSDEM_PEER_DIR") or ROOT.parent / "shared" / "peer")
    if not folder.is_dir():
        rows[0].note = "RBSDEM_PEER_DIR is not set"
        return rows
    tests = list(peer.read_specimens(folder).with_history())[:: 10 if quick else 1]
    # What is assumed of a test takes no part here.
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    events = points = 0
    for specimen in tests:
        path = specimen.test().displacement
        times = []
        for _ in range(2 if quick else 4):
            start = time.perf_counter()
            column = peer.column(specimen)
            made = time.perf_counter()
            result = rbsdem.cyclic(column, displacement=path)
            assert len(result.force) == len(result.displacement)
            times.append((made - start, time.perf_counter() - made))
        for row, values in zip(rows, zip(*times, strict=True), strict=False):
            row.values.append(1e3 * min(values))
        events += result.summary["events"]
        points += len(path)
    means = [sum(row.values) / len(tests) for row in rows[:2]]
    rows[0].note = f"mean {means[0]:.2f}, {len(tests)} tests"
    rows[
        1
    ].note = (
        f"mean {means[1]:.2f}, {points / len(tests):.0f} points, {events / len(tests):.0f} events"
    )
    rows[2].values = [sum(means)]
    return rows


def inside_fortran(driver: Path | None, repeats: int, divisor: int) -> list[Row]:
    """Time the solver without Python and without files."""
    if driver is None:
        note = "time_solver is not built, see --help"
        return [Row(what, unit, goal, [], note) for what, unit, goal in INSIDE.values()]
    command = [driver, str(repeats), str(divisor)]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split("\n")
    values: dict[str, list[float]] = {}
    for line in filter(None, lines):
        name, value = line.split()
        values.setdefault(name, []).append(float(value))
    rows = []
    for name, (what, unit, goal) in INSIDE.items():
        note = ""
        if f"{name}_lines" in values:
            note = f"{values[f'{name}_lines'][0]:.0f} line changes in 1000 steps"
        rows.append(Row(what, unit, goal, values[name], note))
    return rows


PARTS = ("python", "fortran", "yardstick")


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer repeats, shorter runs")
    parser.add_argument("--only", choices=PARTS, help="one part of the table")
    parser.add_argument("--repeats", type=int, metavar="N", help="default 9, with --quick 3")
    parser.add_argument("--build", type=Path, metavar="DIR", help="build folder of time_solver")
    parser.add_argument(
        "--against",
        type=Path,
        metavar="OTHER",
        help="build folder or Python of another version",
    )
    parser.add_argument("--plain", action="store_true", help="names and least times alone")
    given = parser.parse_args()
    if given.repeats is None:
        given.repeats = 3 if given.quick else 9
    if given.repeats < 1:
        parser.error(f"--repeats {given.repeats}: give 1 or more")
    return given


def main() -> None:
    """Measure and print."""
    given = arguments()
    repeats, divisor = given.repeats, 10 if given.quick else 1
    parts = [given.only] if given.only else PARTS
    rows = {}
    if "python" in parts:
        rows["Through Python"] = [
            *through_python(repeats),
            *predicted_column(repeats),
            *crossing(repeats),
            *([] if given.plain else each_prediction(given.quick)),
        ]
    if "fortran" in parts:
        driver = newest("time_solver", given.build)
        rows["Inside Fortran"] = inside_fortran(driver, repeats, divisor)
    if "yardstick" in parts:
        rows["By the yardstick"] = yardstick_rows(given.build, repeats, divisor)
    if given.against and given.against.is_dir():
        rows["Now against before"] = against_rows(given.build, given.against, repeats, divisor)
    elif given.against:
        rows["Now against before"] = package_rows(given.against, repeats)
    if given.plain:
        print(*(f"{row.what}\t{min(row.values)}" for row in rows["Through Python"]), sep="\n")
    else:
        show(rows)


if __name__ == "__main__":
    main()
