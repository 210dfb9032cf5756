"""rbsdem against other programs in the same run: the yardstick in C, and another build of itself.

The programs take turns, so that what disturbs the machine disturbs both; what counts is the median
of the ratios of neighbours.
"""

from __future__ import annotations

import math
import statistics
import subprocess
import sys
from collections import defaultdict
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rows import Row, newest, number

# Both programs do the same sums in another order.
AGREEMENT = 1e-9

# Bodies and steps of a run, at 0.2 of a bound of the stability limit. The last two lengths are what
# the exponent needs, not what a user would run.
STEPS = {
    "rk4": {1: 400_000, 10: 100_000, 50: 40_000, 200: 10_000, 1000: 4_000, 5000: 800},
}
GOALS = {
    "rk4": {1: 2.0, 10: 2.5, 50: 2.5, 200: 2.5},
}
NAMES = {"rk4": "RK4"}
POINTS = 20_000
TABLE = 20


@dataclass
class Case:
    """What one program ran, some times."""

    arguments: list[str]
    times: dict[str, list[float]] = field(default_factory=lambda: defaultdict(list))
    peaks: dict[str, float] = field(default_factory=dict)
    memory: list[int] = field(default_factory=list)
    fault: str = ""

    def run(self, name: str, program: Path) -> None:
        """Run it once."""
        if self.fault:
            return
        done = subprocess.run(
            [program, *self.arguments], capture_output=True, text=True, check=False
        )
        if done.returncode != 0:
            self.fault = f"{name}: " + (done.stderr.strip().split("\n") or ["failed"])[0]
            return
        time, peak, *rest = done.stdout.split()
        self.times[name].append(float(time))
        self.peaks[name] = float(peak)
        self.memory += [int(value) for value in rest]

    def row(self, what: str, goal: float | None) -> Row:
        """Return the ratio of the times."""
        row = Row(what, "x yardstick", goal)
        if self.fault:
            row.note = self.fault
            return row
        pairs = zip(self.times["rbsdem"], self.times["yardstick"], strict=True)
        row.values = [ours / theirs for ours, theirs in pairs]
        ours, theirs = (statistics.median(self.times[name]) for name in ("rbsdem", "yardstick"))
        row.note = f"{number(ours)} / {number(theirs)} ns"
        gap = abs(self.peaks["rbsdem"] / self.peaks["yardstick"] - 1)
        row.note += f", same to {gap:.0e}" if gap <= AGREEMENT else ", ANSWERS DIFFER"
        return row


def explicit_step(n: int) -> float:
    """Return 0.2 of the stability limit for a bound of the highest frequency [s].

    The column of the yardstick: with (a + b)^2 <= 2 (a^2 + b^2) a joint gives each of its two
    bodies at the most 4 k_V (x^2 + h^2 r^2)/2 + 2 k_M r^2/2, and a body has two joints.
    """
    half, mass, depth, shear, flexure = 0.8 / n, 614.4 / n, 0.4, n * 7.0387e8, n * 6.2937e7
    inertia = mass * ((2 * half) ** 2 + depth**2) / 12
    square = max(8 * shear / mass, (8 * shear * half**2 + 4 * flexure) / inertia)
    return 0.2 * 2 * math.sqrt(2) / math.sqrt(square)


def dynamic_case(method: str, n: int, divisor: int, strength: int = 1) -> Case:
    """Return the chain of n bodies under a sine of 800 steps.

    The strength is that of the shear springs, 1 as in the paper.
    """
    steps = max(STEPS[method][n] // divisor // TABLE, 10) * TABLE
    dt = 2e-4 if n == 1 else explicit_step(n)
    return Case([method, str(n), repr(dt), str(steps), "800", str(strength)])


def yardstick_rows(build: Path | None, repeats: int, divisor: int) -> list[Row]:
    """Measure rbsdem by the yardstick, and how cost and memory grow with the number of bodies."""
    found = {"yardstick": newest("yardstick", build), "rbsdem": newest("time_solver", build)}
    programs = {name: path for name, path in found.items() if path}
    if len(programs) < len(found):
        return [Row("yardstick and time_solver", "", note="not both are built, see --help")]
    static = Case(["static", str(POINTS)])
    cases = {
        (method, n): dynamic_case(method, n, divisor) for method in STEPS for n in STEPS[method]
    }
    growing = {n: cases["rk4", n] for n in STEPS["rk4"] if n > 1}
    for _ in range(repeats):
        for case in [static, *cases.values()]:
            for name, program in programs.items():
                case.run(name, program)
    inside = Row("static, N = 1, both springs bilinear", "ns/increment", 150)
    inside.values = static.times["rbsdem"]
    rows = [inside, static.row("static, N = 1", None)]
    for (method, n), case in cases.items():
        rows.append(case.row(f"{NAMES[method]}, N = {n}", GOALS[method].get(n)))
        if n == max(STEPS[method]):
            rows.append(exponent(method, growing))
    rows.append(memory({n: cases["rk4", n] for n in STEPS["rk4"]}))
    return rows


def exponent(method: str, cases: dict[int, Case]) -> Row:
    """Return the power of N that the time of a step follows."""
    row = Row(f"{NAMES[method]}, time of a step as N^p", "p", (0.9, 1.1))
    if any(case.fault for case in cases.values()):
        row.note = next(case.fault for case in cases.values() if case.fault)
        return row

    def fit(name: str) -> list[float]:
        times = np.array([case.times[name] for case in cases.values()])
        return list(np.polyfit(np.log(list(cases)), np.log(times), 1)[0])

    row.values = fit("rbsdem")
    row.note = (
        f"N = {min(cases)} to {max(cases)}; yardstick {statistics.median(fit('yardstick')):.2f}"
    )
    return row


def memory(cases: dict[int, Case]) -> Row:
    """Return the memory of a body, from the most that runs held."""
    row = Row("RK4, memory of a body", "kB", 4)
    held = {n: statistics.median(case.memory) for n, case in cases.items() if case.memory}
    if len(held) < len(cases) or not all(held.values()):
        row.note = "told by Linux only" if held else "not measured"
        return row
    few, some, most = 10, 1000, max(held)
    row.values = [(held[most] - held[some]) / (most - some)]
    early = (held[some] - held[few]) / (some - few)
    row.note = (
        f"N = {some} to {most}; {early:.2g} from {few} to {some}; "
        f"N = {most} holds {held[most] / 1024:.1f} MB in all"
    )
    return row


# What `time_solver` tells, with unit and goal; the goal for the ratio to another build is 1.05.
INSIDE = {
    "joint_event": ("joint of 30 layers, an event", "ns", 300),
    "joint_step": ("joint of 30 layers, a step without event", "ns", 60),
    "static": ("static, N = 1", "ns/increment", None),
    "rk4_small": ("RK4, N = 1, small", "ns/step", 250),
    "rk4_pdelta": ("RK4, N = 1, pdelta", "ns/step", 250),
    "rk4_finite": ("RK4, N = 1, finite (eq 4)", "ns/step", 250),
    "rk4_n10": ("RK4, N = 10", "ns/body-step", None),
    "rk4_n50": ("RK4, N = 50", "ns/body-step", None),
    "rk4_n200": ("RK4, N = 200", "ns/body-step", None),
    "spring_smooth": ("Takeda spring, smooth path", "ns/point", None),
    "spring_random": ("Takeda spring, a turn at each point", "ns/point", None),
}


def all_times(driver: Path, divisor: int) -> dict[str, float]:
    """Return what `time_solver` tells of one repeat."""
    command = [driver, "1", str(divisor)]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return {name: float(value) for name, value in map(str.split, text.splitlines())}


def against_rows(build: Path | None, other: Path, repeats: int, divisor: int) -> list[Row]:
    """Measure the solver now against that of another build, inside Fortran."""
    drivers = {"this build": newest("time_solver", build), other.name: newest("time_solver", other)}
    for place, driver in drivers.items():
        if driver is None:
            return [Row("against another build", "", note=f"no time_solver in {place}")]
    ratios: dict[str, list[float]] = {name: [] for name in INSIDE}
    for _ in range(repeats):
        now, before = (all_times(driver, divisor) for driver in drivers.values() if driver)
        for name in INSIDE:
            if name in now and name in before:
                ratios[name].append(now[name] / before[name])
    return [Row(INSIDE[name][0], "x before", 1.05, values) for name, values in ratios.items()]


def package_rows(other: Path, repeats: int) -> list[Row]:
    """Measure this package against that of another interpreter, through Python."""
    ratios: dict[str, list[float]] = {}
    script = Path(__file__).with_name("benchmark.py")
    for _ in range(repeats):
        tables = []
        for python in (sys.executable, other):
            command = [python, script, "--only", "python", "--plain", "--repeats", "2"]
            text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            tables.append(dict(line.split("\t") for line in text.splitlines()))
        now, before = tables
        for name in now:
            ratios.setdefault(name, []).append(float(now[name]) / float(before[name]))
    return [Row(name, "x before", 1.05, values) for name, values in ratios.items()]
