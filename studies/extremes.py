"""Print what was observed at the extremes: the long versions of tests/python/test_extremes_*.py.

    python studies/extremes.py

Uses the installed package alone; takes some 15 s.
"""

from __future__ import annotations

import itertools
import resource
import time
import warnings
from concurrent.futures import ThreadPoolExecutor

import numpy as np

import rbsdem
from rbsdem.springs import Elastic, Takeda

Row = tuple[str, str, str]


def main() -> None:
    """Print one Markdown table."""
    # Some rows are about large rotations and loads close to the critical one.
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    print("| extreme | how | observed |")
    print("| --- | --- | --- |")
    for row in (
        below_the_limit,
        above_the_limit,
        stiffness_ratios,
        many_bodies,
        full_turns,
        long_path,
        axial_loads,
        huge_damping,
        long_record,
        threads,
    ):
        print("| " + " | ".join(row()) + " |")


def chain(n: int, **more: object) -> rbsdem.Column:
    """Return an elastic cantilever as n bodies."""
    return rbsdem.Column(4.0, 2000.0, Elastic(4e8 * n), Elastic(1e8 * n), n=n, **more)


def below_the_limit() -> Row:
    """Take a million steps below the limit of RK4."""
    found = []
    for n, share in itertools.product((1, 10, 100), (0.5, 0.99)):
        column = chain(n)
        modes = rbsdem.modes(column)
        dt = share * modes.stable_step
        steps = 1_000_000
        start = 1e-3 * modes.shapes[:, 0] / np.abs(modes.shapes[:, 0]).max()
        run = rbsdem.time_history(
            column,
            [0.0, steps * dt],
            dt=dt,
            every=steps // 4,
            initial={"slip": start[:n], "rotation": start[n:]},
            method="rk4",
        )
        total = run.energy["kinetic"] + run.energy["spring"]
        found.append(f"{share} n={n}: {total[-1] / total[0] - 1:+.0e}")
    return (
        "step of 0.5 and 0.99 of the RK4 limit",
        "first mode of an elastic chain, 1e6 steps; change of the energy",
        ", ".join(found),
    )


def above_the_limit() -> Row:
    """Take steps beyond the limit."""
    found = []
    for n, share in itertools.product((1, 10, 100), (1.01, 2.0)):
        column = chain(n)
        dt = share * rbsdem.modes(column).stable_step
        start = {"rotation": [1e-3] * n}
        try:
            rbsdem.time_history(column, [0, 1e4 * dt], dt=dt, initial=start, method="rk4")
            raise AssertionError("not refused")
        except rbsdem.InputError:
            pass
        try:
            rbsdem.time_history(
                column, [0, 1e6 * dt], dt=dt, initial=start, allow_unstable=True, method="rk4"
            )
            raise AssertionError("not stopped")
        except rbsdem.SolveError as error:
            steps = error.result.summary["steps"]
            found.append(f"{share} n={n}: after {steps} steps")
    return (
        "step of 1.01 and 2 times the limit",
        "refused with the limit; with `allow_unstable` it stops with the time",
        ", ".join(found),
    )


def stiffness_ratios() -> Row:
    """Load columns whose springs differ by many orders of magnitude."""
    worst = 0.0
    for power in range(-9, 10, 3):
        column = rbsdem.Column(1.6, 600.0, Elastic(1e8 * 10.0**power / 1.6**2), Elastic(1e8), n=5)
        run = rbsdem.cyclic(column, force=[1e3, -1e3, 500.0])
        arms = 1.6 * (1 - np.arange(5) / 5)
        exact = 1e3 * (5 / column.shear.k + np.sum(arms**2) / 1e8)
        worst = max(worst, abs(run.displacement[0] / exact - 1))
    return (
        "k_V l^2/k_M from 1e-9 to 1e9",
        "deflection of five bodies against the closed form (frequencies: `test_modes.py`)",
        f"largest relative error {worst:.0e}",
    )


def many_bodies() -> Row:
    """Solve one to 5000 bodies: static and implicit."""
    found = []
    for n in (1, 10, 100, 1000, 5000):
        column = chain(
            n,
            axial_load=1e5,
            kinematics="pdelta",
            top_mass=1e4,
            damping=rbsdem.Damping(stiffness=2e-3),
        )
        begin = time.perf_counter()
        rbsdem.cyclic(column, force=[1e4])
        middle = time.perf_counter()
        run = rbsdem.time_history(
            column,
            np.linspace(0, 2, 101),
            ground_acceleration=np.sin(np.linspace(0, 20, 101)),
            method="newmark",
            every=1000,
            dt=0.02,
        )
        spent = time.perf_counter() - middle
        found.append(
            f"n={n}: {1e3 * (middle - begin):.2g} ms, {1e3 * spent:.2g} ms, "
            f"residual {run.summary['relative_energy_residual']:.0e}"
        )
    return (
        "1 to 5000 bodies",
        "pdelta: one static point; 100 steps of Newmark; energy residual",
        "; ".join(found),
    )


def full_turns() -> Row:
    """Let a chain rotate through many full turns."""
    column = rbsdem.Column(1.0, 100.0, Elastic(1e5), Elastic(50.0), n=3, kinematics="finite")
    start = {"rotation_velocity": [30.0, 0.0, 0.0]}
    run = rbsdem.time_history(column, np.linspace(0, 1, 101), initial=start, dt=2e-5, method="rk4")
    return (
        "full turns, `finite`, n = 3",
        "free spinning against soft springs, 1 s",
        f"rotation to {run.summary['peak_rotation']:.0f} rad, energy residual "
        f"{run.summary['relative_energy_residual']:.0e}",
    )


def long_path() -> Row:
    """Follow a path of ten million points."""
    spring = Takeda(k_c=2.5428e8, d_c=3.1891e-4, k_y=6.2937e7, d_y=2.7183e-3, k_u=7.5772e6, b1=0.22)
    corners = np.random.default_rng(1).uniform(-0.02, 0.02, 1000)
    parts = np.linspace(0, 1, 10_001)[1:]
    path = np.concatenate(
        [a + (b - a) * parts for a, b in itertools.pairwise(np.concatenate([[0.0], corners]))]
    )
    path[9999::10000] = corners
    begin = time.perf_counter()
    many = spring.response(path)[9999::10000]
    spent = time.perf_counter() - begin
    differ = int(np.count_nonzero(many != spring.response(corners)))
    return (
        "path of 1e7 points",
        "Takeda spring, 1000 random reversals with 10 000 points between, against none",
        f"{differ} of 1000 forces differ in any bit; {spent:.2g} s",
    )


def axial_loads() -> Row:
    """Load the axis at and beyond the critical load, and in tension."""
    length, k_m = 1.6, 1e8
    critical = k_m / length
    found = []
    for share in (0.5, 0.999, 1.001, 2.0, -5.0):
        column = rbsdem.Column(
            length,
            600.0,
            Elastic(1e9),
            Elastic(k_m),
            axial_load=share * critical,
            kinematics="pdelta",
        )
        exact = 1 / (1 / 1e9 + length**2 / (k_m - share * critical * length))
        run = rbsdem.cyclic(column, displacement=[1e-3])
        found.append(f"{share}: {run.force[0] / (1e-3 * exact) - 1:+.0e}")
    return (
        "axial load of 0.5 to 2 times the critical one, and tension",
        "stiffness under displacement drive against the closed form",
        ", ".join(found) + "; time histories beyond 1 are refused with the critical load",
    )


def huge_damping() -> Row:
    """Step with damping far beyond critical."""
    found = []
    for beta in (1e-3, 1.0, 1e3):
        column = chain(1, damping=rbsdem.Damping(stiffness=beta))
        dt = 0.99 * rbsdem.modes(column).stable_step
        run = rbsdem.time_history(
            column, [0, 2e4 * dt], dt=dt, every=5000, initial={"rotation": [1e-3]}, method="rk4"
        )
        found.append(f"{beta:g} s: bounded {np.all(np.abs(run.rotation) <= 1.001e-3)}")
    return (
        "huge damping",
        "stiffness damping, 20 000 steps of 0.99 of the limit",
        ", ".join(found),
    )


def long_record() -> Row:
    """Run one hour at 0.005 s."""
    column = chain(
        10, kinematics="pdelta", axial_load=1e5, damping=rbsdem.Damping(mass=0.5), top_mass=1e4
    )
    times = np.arange(0, 3600.001, 0.005)
    motion = np.random.default_rng(2).normal(size=times.size)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    begin = time.perf_counter()
    run = rbsdem.time_history(
        column, times, ground_acceleration=motion, method="generalised_alpha", every=10_000
    )
    spent = time.perf_counter() - begin
    grown = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    return (
        "record of one hour at 0.005 s",
        "n = 10, generalised-alpha, two steps an interval",
        f"{run.summary['steps']} steps in {spent:.2g} s, {grown:.0f} MB more memory",
    )


def threads() -> Row:
    """Run two, four and eight threads at once."""
    column = chain(5, kinematics="finite")
    times = np.linspace(0, 0.2, 21)

    def job(size: float) -> bytes:
        start = {"rotation": [size] * 5}
        return rbsdem.time_history(column, times, method="rk45", initial=start).rotation.tobytes()

    sizes = [0.001 * (i + 1) for i in range(16)]
    alone = [job(size) for size in sizes]
    same = []
    for count in (2, 4, 8):
        with ThreadPoolExecutor(count) as pool:
            same.append(list(pool.map(job, sizes)) == alone)
    return ("2, 4, 8 threads at once", "16 runs", f"same bits as alone: {all(same)}")


if __name__ == "__main__":
    main()
