"""Times of rbsdem on this machine, goal and measured side by side. Nothing is asserted.

    python tests/benchmarks/benchmark.py [--quick] [--build DIR]

Medians over repeats, with the fastest and the slowest: wall time through Python, processor time
elsewhere, which another load of the machine disturbs less. What runs inside Fortran is timed by
`time_solver`, built like the unit tests: meson setup build/fortran, then meson compile -C
build/fortran. Rows that need a program that is not there say so.
"""

from __future__ import annotations

import argparse
import importlib.util
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

import rbsdem
from rbsdem.__main__ import executable as installed_executable

try:
    import resource
except ImportError:  # Windows
    resource = None  # type: ignore[assignment]
try:
    from rich import box
    from rich.console import Console
    from rich.table import Table
except ImportError:
    Console = None  # type: ignore[assignment,misc]

ROOT = Path(__file__).resolve().parents[2]

CASE = """\
&column height = 1.6, mass = 614.4, kinematics = '{kinematics}' /
&shear rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6 /
&flexure rule = 'takeda', k_c = 2.5428e8, d_c = 3.1891e-4, k_y = 6.2937e7,
         d_y = 2.7183e-3, k_u = 7.5772e6, b0 = 0.4, b1 = 0.22 /
&loading drive = 'force', unit = 'kN', amplitudes = 150, cycles = {cycles}, period = 1.0 /
&analysis method = 'rk4', dt = 2e-4 /
&output every = 1000 /
"""
STEPS_PER_CYCLE = 5000


@dataclass
class Row:
    """One line of the table; `values` in its unit, empty if it could not be measured."""

    what: str
    unit: str
    goal: float | None = None
    values: list[float] = field(default_factory=list)
    note: str = ""

    def texts(self) -> list[str]:
        """Return the cells of the row."""
        goal = "" if self.goal is None else f"< {self.goal:g}"
        if not self.values:
            return [self.what, self.unit, goal, "-", "", self.note]
        median = statistics.median(self.values)
        spread = f"{number(min(self.values))} - {number(max(self.values))}"
        verdict = "" if self.goal is None else "met" if median < self.goal else "MISSED"
        note = ", ".join(part for part in (verdict, self.note) if part)
        return [self.what, self.unit, goal, number(median), spread, note]


def number(value: float) -> str:
    """Return three digits, and all those before the point."""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def seconds(action: Callable[[], Any], repeats: int) -> list[float]:
    """Return the times of some calls, after one that does not count."""
    action()
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        action()
        times.append(time.perf_counter() - begin)
    return times


def processor_time(command: list[Any]) -> float:
    """Return the processor time of a process; its wall time where that is not known (Windows)."""
    begin = time.perf_counter()
    used = children()
    subprocess.run(command, check=True)
    return children() - used or time.perf_counter() - begin


def children() -> float:
    """Return the processor time of all ended child processes; 0 where it is not known."""
    if resource is None:
        return 0.0
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def newest(name: str, build: Path | None) -> Path | None:
    """Return the newest program of a name in a build folder, or in all of them."""
    folders = [build] if build else [ROOT / "build", *ROOT.glob("build-*")]
    found = [path for folder in folders for path in folder.rglob(name) if path.is_file()]
    found = [path for path in found if not {"checked", "memory"} & set(path.parts)]
    return max(found, key=lambda path: path.stat().st_mtime, default=None)


def find_executable(build: Path | None) -> Path | None:
    """Return the executable of a build folder, or the installed one."""
    if build:
        return newest("rbsdem", build)
    try:
        return Path(installed_executable())
    except FileNotFoundError:
        return newest("rbsdem", None)


def growing_cycles(points: int) -> np.ndarray:
    """Return a cyclic path of the top [m], growing to 3 % drift and back, with inner loops."""
    share = np.arange(1, points + 1) / points
    angle = 2 * np.pi * 20 * share
    return 0.05 * np.sin(np.pi * share) * (np.sin(angle) + 0.2 * np.sin(7 * angle))


def through_python(repeats: int) -> list[Row]:
    """Time analyses through the Python package."""
    column = rbsdem.paper_columns()["soesianawati_1"]
    path = growing_cycles(20_000)
    static = seconds(lambda: rbsdem.cyclic(column, displacement=path), 3 * repeats)
    rotation = path / column.height
    spring = rbsdem.Takeda(
        k_c=2.5428e8, d_c=3.1891e-4, k_y=6.2937e7, d_y=2.7183e-3, k_u=7.5772e6, b1=0.22
    )
    response = seconds(lambda: spring.response(rotation), 3 * repeats)
    return [
        Row("static, N = 1, 20 000 points", "ms", 10, [1e3 * t for t in static]),
        Row("Takeda spring, 20 000 points", "ms", None, [1e3 * t for t in response]),
    ]


INSIDE = (
    ("static", "static, N = 1", "ns/increment", None),
    ("rk4_small", "RK4, N = 1, small", "ns/step", 250),
    ("rk4_pdelta", "RK4, N = 1, pdelta", "ns/step", 250),
    ("rk4_finite", "RK4, N = 1, finite (eq 4)", "ns/step", 250),
    ("rk4_n10", "RK4, N = 10", "ns/body-step", None),
    ("rk4_n50", "RK4, N = 50", "ns/body-step", None),
    ("rk4_n200", "RK4, N = 200", "ns/body-step", None),
    ("spring_smooth", "Takeda spring, smooth path", "ns/point", None),
    ("spring_random", "Takeda spring, a turn at each point", "ns/point", None),
)


def inside_fortran(driver: Path | None, repeats: int, divisor: int) -> list[Row]:
    """Time the solver without Python and without files."""
    if driver is None:
        note = "time_solver is not built, see --help"
        return [Row(what, unit, goal, [], note) for _, what, unit, goal in INSIDE]
    command = [driver, str(repeats), str(divisor)]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.split("\n")
    values: dict[str, list[float]] = {}
    for line in filter(None, lines):
        name, value = line.split()
        values.setdefault(name, []).append(float(value))
    rows = []
    for name, what, unit, goal in INSIDE:
        note = ""
        if f"{name}_lines" in values:
            note = f"{values[f'{name}_lines'][0]:.0f} line changes in 1000 steps"
        rows.append(Row(what, unit, goal, values[name], note))
    return rows


def through_executable(executable: Path | None, repeats: int, cycles: int) -> list[Row]:
    """Time the whole process on a long case, every 1000th step written."""
    rows = []
    for kinematics in ("small", "finite"):
        row = Row(f"RK4, N = 1, {kinematics}", "ns/step", 250)
        rows.append(row)
        if executable is None:
            row.note = "the executable is not built"
            continue
        steps = cycles * STEPS_PER_CYCLE
        with tempfile.TemporaryDirectory() as folder:
            case = Path(folder) / "case.nml"
            case.write_text(CASE.format(kinematics=kinematics, cycles=cycles), encoding="utf-8")
            command = [executable, "run", case, "--quiet"]
            times = [processor_time(command) for _ in range(repeats + 1)][1:]
        row.values = [1e9 * t / steps for t in times]
        row.note = f"{steps:,} steps".replace(",", " ")
    return rows


def main_job() -> ModuleType:
    """Return the example that runs the four columns, as a module."""
    path = ROOT / "examples" / "01-paper-columns" / "run.py"
    spec = importlib.util.spec_from_file_location("main_job", path)
    if spec is None or spec.loader is None:
        raise ImportError(path)
    module = importlib.util.module_from_spec(spec)
    sys.modules["main_job"] = module  # its dataclasses ask for it
    spec.loader.exec_module(module)
    return module


def four_columns(repeats: int) -> list[Row]:
    """Time what the main job computes: two drives of four columns, without reading and plotting."""
    row = Row("four-column main job, computing", "s", 0.2)
    try:
        job = main_job()
    except (ImportError, SystemExit) as error:
        row.note = str(error)
        return [row]
    columns = rbsdem.paper_columns()
    drives = {key: job.read(key, None) for key in columns}
    for repeat in range(repeats + 1):
        total = 0.0
        for key, column in columns.items():
            total += job.by_force(drives[key], column, job.ROW_TIME)[1]
            total += job.by_displacement(drives[key], column)[1]
        if repeat > 0:
            row.values.append(total)
    points = sum(len(drive.force) for drive in drives.values())
    full = all(drive.full for drive in drives.values())
    row.note = f"{points} rows of {'full histories' if full else 'reversal points'}"
    return [row]


HEADINGS = ("What", "Unit", "Goal", "Median", "Fastest - slowest", "")


def show(rows: dict[str, list[Row]]) -> None:
    """Print the table; with rich if it is there."""
    if Console is None:
        for title, part in rows.items():
            print(f"\n{title}")
            for row in part:
                what, unit, goal, median, spread, note = row.texts()
                print(f"  {what:<38}{goal:>8}{median:>8} {unit:<13}{spread:<18}{note}")
        return
    table = Table(box=box.SIMPLE_HEAD)
    for place, heading in enumerate(HEADINGS):
        table.add_column(heading, justify="right" if place in (2, 3) else "left", no_wrap=place < 5)
    for title, part in rows.items():
        table.add_row(f"[bold]{title}")
        for row in part:
            what, *rest = row.texts()
            table.add_row(f"  {what}", *rest, end_section=row is part[-1])
    Console(width=None if sys.stdout.isatty() else 132).print(table)


def arguments() -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--quick", action="store_true", help="fewer repeats, shorter runs")
    parser.add_argument("--repeats", type=int, metavar="N", help="default 9, with --quick 3")
    parser.add_argument(
        "--build", type=Path, metavar="DIR", help="build folder of time_solver and rbsdem"
    )
    given = parser.parse_args()
    if given.repeats is None:
        given.repeats = 3 if given.quick else 9
    if given.repeats < 1:
        parser.error(f"--repeats {given.repeats}: give 1 or more")
    return given


def main() -> None:
    """Measure and print."""
    given = arguments()
    repeats = given.repeats
    driver = newest("time_solver", given.build)
    rows = {
        "Through Python": through_python(repeats) + four_columns(repeats),
        "Inside Fortran": inside_fortran(driver, repeats, 10 if given.quick else 1),
        "Through the executable": through_executable(
            find_executable(given.build), repeats, 100 if given.quick else 200
        ),
    }
    show(rows)


if __name__ == "__main__":
    main()
