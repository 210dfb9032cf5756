"""Times of rbsdem on this machine, goal and measured side by side. Nothing is asserted.

    python tests/benchmarks/benchmark.py [--quick] [--only PART] [--build DIR] [--against OTHER]

Medians over repeats of the processor time, which another load of the machine disturbs less than the
wall time, with the fastest and the slowest. The yardstick is the same work written by hand in C for
one case, built by meson setup build/fortran, then meson compile -C build/fortran, if there is a C
compiler. --against takes the Python interpreter of another version and runs both in turns.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from rows import ROOT, Row, newest, number, show

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


#: Bodies, steps and goal of a run of the yardstick; 0 bodies: the static path of one.
CHAINS = {
    0: (20_000, None),
    1: (400_000, 2.0),
    10: (100_000, 2.5),
    50: (40_000, 2.5),
    200: (10_000, 2.5),
}
#: Both programs do the same sums in another order.
AGREEMENT = 1e-9


def explicit_step(n: int) -> float:
    """Return 0.2 of the stability limit for a bound of the highest frequency [s].

    With (a + b)^2 <= 2 (a^2 + b^2) a joint gives each of its two bodies at the most
    4 k_V (x^2 + h^2 r^2)/2 + 2 k_M r^2/2, and a body has two joints.
    """
    if n == 1:
        return 2e-4
    half, mass, depth, shear, flexure = 0.8 / n, 614.4 / n, 0.4, n * 7.0387e8, n * 6.2937e7
    inertia = mass * ((2 * half) ** 2 + depth**2) / 12
    square = max(8 * shear / mass, (8 * shear * half**2 + 4 * flexure) / inertia)
    return float(0.2 * 2 * np.sqrt(2 / square))


def work_of_yardstick(n: int, steps: int, dt: float) -> Callable[[], rbsdem.Result]:
    """Return the work of the yardstick: bodies under a sine of 800 steps, or one static path."""
    bodies = max(n, 1)
    shear = Bilinear(7.0387e8, 1.296e-4, 8.3185e6).split(bodies)
    flexure = Bilinear(6.2937e7, 2.7183e-3, 7.5772e6).split(bodies)
    column = rbsdem.Column(1.6, 614.4, shear, flexure, n=bodies, depth=0.4)
    if n == 0:
        path = growing_cycles(steps)
        return lambda: rbsdem.cyclic(column, displacement=path, every=1000)
    at = np.arange(0, steps + 1, 20)
    loads = {"time": dt * at, "force": 1.5e5 * np.sin(2 * np.pi * at / 800)}
    return lambda: rbsdem.time_history(column, **loads, method="rk4", dt=dt, every=1000)


def yardstick_rows(build: Path | None, repeats: int, divisor: int) -> list[Row]:
    """Measure rbsdem by the same work written in C for one case, in turns."""
    program = newest("yardstick", build)
    if program is None:
        return [Row("yardstick", "", note="it is not built, see --help")]
    rows = []
    for n, (count, goal) in CHAINS.items():
        steps, dt = count if n == 0 else count // divisor, explicit_step(max(n, 1))
        work = work_of_yardstick(n, steps, dt)
        own = ["rk4", str(n), repr(dt), str(steps), "800", "1"] if n else ["static", str(steps)]
        row = Row(f"RK4, N = {n}" if n else "static, N = 1", "x yardstick", goal)
        for _ in range(repeats):
            told = subprocess.run([program, *own], check=True, capture_output=True, text=True)
            theirs, peak = map(float, told.stdout.split())
            begin = time.process_time()
            found = work().summary
            ours = 1e9 * (time.process_time() - begin) / steps
            row.values.append(ours / theirs)
            gap = abs(found["peak_displacement" if n else "peak_force"] / peak - 1)
            row.note = f"{number(ours)} / {number(theirs)} ns, "
            row.note += f"same to {gap:.0e}" if gap <= AGREEMENT else "ANSWERS DIFFER"
        rows.append(row)
    return rows


def package_rows(other: Path, repeats: int) -> list[Row]:
    """Measure this package against that of another interpreter, through Python."""
    ratios: dict[str, list[float]] = {}
    for _ in range(repeats):
        tables = []
        for python in (sys.executable, other):
            command = [python, __file__, "--only", "python", "--plain", "--repeats", "2"]
            text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            tables.append(dict(line.split("\t") for line in text.splitlines()))
        now, before = tables
        for name in now:
            ratios.setdefault(name, []).append(float(now[name]) / float(before[name]))
    return [Row(name, "x before", 1.05, values) for name, values in ratios.items()]


PARTS = ("python", "yardstick")


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer repeats, shorter runs")
    parser.add_argument("--only", choices=PARTS, help="one part of the table")
    parser.add_argument("--repeats", type=int, metavar="N", help="default 9, with --quick 3")
    parser.add_argument("--build", type=Path, metavar="DIR", help="build folder of yardstick")
    parser.add_argument("--against", type=Path, metavar="PYTHON", help="Python of another version")
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
    if "yardstick" in parts:
        rows["By the yardstick"] = yardstick_rows(given.build, repeats, divisor)
    if given.against:
        rows["Now against before"] = package_rows(given.against, repeats)
    if given.plain:
        print(*(f"{row.what}\t{min(row.values)}" for row in rows["Through Python"]), sep="\n")
    else:
        show(rows)


if __name__ == "__main__":
    main()
