"""Print the table of observed numbers in docs/validation.md.

    python studies/observed.py

Uses the installed package alone; takes some seconds. Round-off differs from machine to machine in
the last digits, the orders do not.
"""

from __future__ import annotations

import itertools
import warnings
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from observed_solvers import rows as rows_of_solvers

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Takeda

Array = NDArray[np.float64]

KEY = "soesianawati_1"


def main() -> None:
    """Print one Markdown table."""
    # Some rows are about large rotations and loads close to the critical one.
    warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
    print("| what | how | observed | theory |")
    print("| --- | --- | --- | --- |")
    for row in (
        eq_6,
        mass_matrices,
        critical_load,
        cantilever,
        free_vibration,
        free_vibration_finite,
        nonlinear_order,
        rk4_energy_linear,
        rk4_energy_nonlinear,
        highest_mode,
        slow_loading,
        static_energy,
        static_increments,
        inverse_drives,
        spring_increments,
        finite_to_small,
    ):
        print("| " + " | ".join(row()) + " |")
    for more in rows_of_solvers():
        print("| " + " | ".join(more) + " |")


# ---- closed forms --------------------------------------------------------------------------------


def eq_6() -> tuple[str, str, str, str]:
    """Natural frequencies of one body against eq 6."""
    rng = np.random.default_rng(6)
    worst = 0.0
    for _ in range(1000):
        length, mass = rng.uniform(0.5, 10.0), 10 ** rng.uniform(1, 5)
        k_m, kappa = 10 ** rng.uniform(5, 10), 10 ** rng.uniform(-2, 2)
        k_v = 3 * k_m * kappa / length**2
        column = rbsdem.Column(length, mass, Elastic(k_v), Elastic(k_m))
        root = np.sqrt(1 + kappa + kappa**2)
        # The lower root without cancellation.
        factors = np.array([kappa / (1 + kappa + root), 1 + kappa + root])
        exact = 6 * k_m / (mass * length**2) * factors
        worst = max(worst, relative(rbsdem.modes(column).omega ** 2, exact))
    return (
        "eq 6 (corrected), omega squared",
        "1000 random columns, kappa from 0.01 to 100",
        f"largest relative error {worst:.0e}",
        "round-off",
    )


def mass_matrices() -> tuple[str, str, str, str]:
    """Compare the mass matrix of the paper with the symmetric one."""
    rng = np.random.default_rng(3)
    worst = 0.0
    for n in range(1, 51):
        column = chain(n, rng)
        transform = np.eye(2 * n)
        transform[n:, n:] = np.tril(np.ones((n, n)))
        symmetric = rbsdem.matrices(column).mass
        both = rbsdem.matrices(column, form="paper").mass @ transform
        worst = max(worst, float(np.max(np.abs(both - symmetric)) / np.max(symmetric)))
    return (
        "mass matrix in both views, eq 3",
        "random chains, n = 1 to 50",
        f"largest difference {worst:.0e} of the largest element",
        "round-off",
    )


def critical_load() -> tuple[str, str, str, str]:
    """Critical load of one body: with P = (1 - e) k_M/l the lower frequency vanishes."""
    k_m, length = 2.5e8, 1.6
    column = rbsdem.Column(length, 600.0, Elastic(7e8), Elastic(k_m), kinematics="pdelta")
    below, above = 0.5 * k_m / length, 2 * k_m / length
    while above - below > 1e-15 * below * 4:
        middle = 0.5 * (below + above)
        try:
            rbsdem.modes(replace(column, axial_load=middle))
            below = middle
        except rbsdem.InputError:
            above = middle
    error = abs(below * length / k_m - 1)
    return (
        "critical load of one body",
        "bisection on the load that is refused, against k_M/l",
        f"relative error {error:.0e}",
        "round-off",
    )


def cantilever() -> tuple[str, str, str, str]:
    """Deflection of a chain of equal bodies against the beam with bending and shear."""
    height, e_i, g_a, force = 3.0, 4.0e7, 3.0e8, 1.0e3
    exact = force * height**3 / (3 * e_i) + force * height / g_a
    errors = []
    numbers = [4, 8, 16, 32, 64]
    for n in numbers:
        part = np.full(n, height / n)
        tributary = part.copy()
        tributary[0] /= 2  # half a body hangs on the joint at the ground
        column = rbsdem.Column(
            height,
            1000.0,
            Elastic(g_a / part[0]),
            [Elastic(e_i / length) for length in tributary],
            n=n,
        )
        errors.append(abs(rbsdem.cyclic(column, force=[force]).displacement[0] / exact - 1))
    return (
        "chain to beam: deflection of an elastic cantilever",
        "n = 4 to 64 equal bodies",
        f"order {slope(1 / np.array(numbers), errors):.2f}, error {errors[-1]:.0e} at n = 64",
        "2",
    )


# ---- RK4 -----------------------------------------------------------------------------------------


def free_vibration() -> tuple[str, str, str, str]:
    """Free vibration of linear chains against the modal solution."""
    orders = []
    for n in (1, 3, 6):
        column = chain(n, np.random.default_rng(n))
        modes = rbsdem.modes(column)
        amplitude = np.ones(2 * n) * 1e-3 / modes.omega
        start = modes.shapes @ amplitude
        time = np.linspace(0.0, 6 * np.pi / modes.omega[-1], 41)
        exact = (amplitude * np.cos(np.outer(time, modes.omega))) @ modes.shapes.T
        steps, errors = [], []
        for count in (2, 4, 8, 16):
            run = rbsdem.time_history(
                column,
                time,
                initial={"slip": start[:n], "rotation": start[n:]},
                dt=time[1] / count,
                method="rk4",
            )
            steps.append(run.summary["time_step"])
            errors.append(relative(np.hstack([run.slip, run.rotation]), exact))
        orders.append(slope(steps, errors))
    return (
        "RK4, free vibration, linear springs",
        "n = 1, 3, 6, all modes, against the modal solution",
        "order " + ", ".join(f"{order:.3f}" for order in orders),
        "4",
    )


def free_vibration_finite() -> tuple[str, str, str, str]:
    """Free vibration of one body with finite rotations, against a much finer step."""
    column = swing()
    start = {"slip": [0.05], "rotation": [0.8]}
    steps = [0.02, 0.01, 0.005, 0.0025]

    def end(dt: float) -> Array:
        run = rbsdem.time_history(column, [0.0, 2.0], initial=start, dt=dt, method="rk4")
        return np.array([run.slip[-1, 0], run.rotation[-1, 0]])

    reference = end(steps[-1] / 32)
    errors = [np.max(np.abs(end(dt) - reference)) for dt in steps]
    return (
        "RK4, free vibration, finite rotations",
        "corrected eq 4 from u = 0.05 m, theta = 0.8 rad, against a step 32 times finer",
        f"order {slope(steps, errors):.2f}",
        "4",
    )


def shaken(parts: int) -> rbsdem.Result:
    """Response of column 1 of table 3 to a pulse far into yield; each 0.01 s in `parts` steps."""
    time = np.linspace(0.0, 1.0, 101)
    ground = 392.0 * np.sin(8 * np.pi * time) * np.exp(-2 * time)
    column = rbsdem.peer.paper_columns()[KEY]
    return rbsdem.time_history(
        column, time, ground_acceleration=ground, dt=0.01 / parts, method="rk4"
    )


def nonlinear_order() -> tuple[str, str, str, str]:
    """Order of the displacement where springs change their lines."""
    parts = [20, 40, 80, 160, 320, 640, 1280]
    reference = shaken(16 * parts[-1]).displacement
    errors = [relative(shaken(count).displacement, reference) for count in parts]
    return (
        "RK4, bilinear and Takeda springs",
        f"ground pulse, {shaken(parts[-1]).summary['events']} changes of line in 1 s, "
        f"steps from {0.01 / parts[0]:.0e} to {0.01 / parts[-1]:.0e} s",
        f"order {slope(1 / np.array(parts), errors):.1f} (scatters), "
        f"error of the largest step {errors[0]:.0e}",
        "2: lines change at the end of a step",
    )


def rk4_energy_linear() -> tuple[str, str, str, str]:
    """Residual of the energy balance and its order, without and with damping."""
    plain = chain(3, np.random.default_rng(3))
    modes = rbsdem.modes(plain)
    start = modes.shapes @ (1e-3 / modes.omega)
    time = np.linspace(0.0, 20 / modes.omega[-1], 21)
    force = 1.0e4 * np.sin(0.3 * modes.omega[-1] * time)
    damped = replace(plain, damping=rbsdem.Damping(mass=20.0, stiffness=0.2 / modes.omega[-1]))
    parts = np.array([8, 16, 32, 64])
    found = []
    for column in (plain, damped):
        residuals = []
        for count in parts:
            run = rbsdem.time_history(
                column,
                time,
                force=force,
                initial={"slip": start[:3], "rotation": start[3:]},
                dt=time[1] / count,
                method="rk4",
            )
            residuals.append(run.summary["relative_energy_residual"])
        found.append(f"{residuals[0]:.0e}, order {slope(1 / parts, residuals):.2f}")
    return (
        "RK4, energy residual, linear chain",
        "n = 3, all modes and a force, undamped; damped; steps of 1/8 to 1/64 over omega_max",
        "; ".join(found),
        "5; 4",
    )


def rk4_energy_nonlinear() -> tuple[str, str, str, str]:
    """Residual of the energy balance where springs change their lines."""
    values = [shaken(count).summary["relative_energy_residual"] for count in (40, 1280)]
    return (
        "RK4, energy residual, bilinear and Takeda springs",
        "the ground pulse, steps of 2.5e-4 s and 7.8e-6 s",
        f"{values[0]:.0e}, {values[1]:.0e}",
        "falls with the step",
    )


def highest_mode() -> tuple[str, str, str, str]:
    """Energy that RK4 loses in the highest mode with the automatic step."""
    column = rbsdem.peer.paper_columns()[KEY]
    modes = rbsdem.modes(column)
    start = 1e-4 * modes.shapes[:, 1] / np.max(np.abs(modes.shapes[:, 1]))
    period = 2 * np.pi / modes.omega[1]
    run = rbsdem.time_history(
        column,
        [0.0, 100 * period],
        initial={"slip": start[:1], "rotation": start[1:]},
        method="rk4",
    )
    total = run.energy["kinetic"] + run.energy["spring"]
    share = run.summary["time_step"] * modes.omega[1]
    theory = 1 - (1 - share**6 / 72 + share**8 / 576) ** run.summary["steps"]
    return (
        "RK4, numerical damping of the highest mode",
        "column 1 of table 3, automatic step, 100 periods of that mode",
        f"{100 * (1 - total[-1] / total[0]):.1f} % of its energy",
        f"{100 * theory:.1f} %",
    )


def slow_loading() -> tuple[str, str, str, str]:
    """Load RK4 by a force, slower and slower, against the static path."""
    column = rbsdem.peer.paper_columns()[KEY]
    points = rbsdem.peer.shipped_reversals(KEY)
    at = np.arange(0.0, points.force.size - 1 + 1e-9, 1 / 30)
    force = np.interp(at, np.arange(points.force.size), points.force)
    static = rbsdem.cyclic(column, force=force)
    limit = rbsdem.modes(column).stable_step
    differences = []
    for row_time in (0.05, 0.1, 0.2, 0.4):
        time = np.arange(force.size) * row_time
        dt = row_time / np.ceil(row_time / (0.5 * limit))
        run = rbsdem.time_history(column, time, force=force, dt=dt, method="rk4")
        differences.append(relative(run.displacement, static.displacement))
    return (
        "RK4 under slow loading against the static path",
        "column 1 of table 3, reversal points of its test, 1.5 s to 12 s from reversal to reversal",
        ", ".join(f"{100 * value:.1f} %" for value in differences) + " of the peak displacement",
        "goes to 0 with the speed",
    )


# ---- static path ---------------------------------------------------------------------------------


def static_cases() -> list[tuple[rbsdem.Column, Array]]:
    """Nonlinear columns with random histories of the top."""
    cases = []
    for n, kinematics in itertools.product((1, 3, 10), ("small", "pdelta")):
        rng = np.random.default_rng(n)
        column = replace(chain(n, rng, nonlinear=True), axial_load=1.0e5, kinematics=kinematics)
        cases.append((column, rng.uniform(-1, 1, 200) * 0.01 * column.height))
    return cases


def static_energy() -> tuple[str, str, str, str]:
    """Residual of the energy balance of the static path."""
    worst = max(
        rbsdem.cyclic(column, displacement=path).summary["relative_energy_residual"]
        for column, path in static_cases()
    )
    return (
        "static path, energy residual",
        "n = 1, 3, 10, small and pdelta, 200 random reversals, P = 100 kN",
        f"largest {worst:.0e} of the largest energy",
        "round-off",
    )


def static_increments() -> tuple[str, str, str, str]:
    """Follow the same path in one and in a hundred increments."""
    worst = 0.0
    for column, path in static_cases():
        one = rbsdem.cyclic(column, displacement=path)
        many = rbsdem.cyclic(column, displacement=subdivided(path, 100))
        worst = max(worst, relative(many.force[99::100], one.force))
    return (
        "static path, increments",
        "the same, 1 and 100 increments from reversal to reversal",
        f"largest difference of force {worst:.0e} of the peak",
        "round-off",
    )


def inverse_drives() -> tuple[str, str, str, str]:
    """Driven by the forces that a displacement-driven run gave."""
    worst = 0.0
    for column, path in static_cases():
        there = rbsdem.cyclic(column, displacement=path)
        back = rbsdem.cyclic(column, force=there.force)
        worst = max(worst, relative(back.displacement, path))
    return (
        "static path, driven by displacement and back by force",
        "the same columns and paths",
        f"largest difference of displacement {worst:.0e} of the peak",
        "round-off",
    )


# ---- springs and kinematics ----------------------------------------------------------------------


def spring_increments() -> tuple[str, str, str, str]:
    """Spring forces with 1, 7 and 1000 sub-increments."""
    rng = np.random.default_rng(1)
    differ = total = 0
    for column in rbsdem.peer.paper_columns().values():
        for spring in (column.shear, column.flexure):
            path = rng.uniform(-6, 6, 500) * spring.d_y
            one = spring.response(path)
            for parts in (7, 1000):
                many = spring.response(subdivided(path, parts))[parts - 1 :: parts]
                differ += int(np.count_nonzero(many != one))
                total += one.size
    return (
        "springs, increments",
        "springs of table 3, 500 random reversals, 7 and 1000 sub-increments",
        f"{differ} of {total} forces differ in any bit",
        "none",
    )


def finite_to_small() -> tuple[str, str, str, str]:
    """`finite` against `small` and `pdelta` for smaller and smaller motions."""
    orders = []
    for load, level in ((0.0, "small"), (500.0, "pdelta")):
        finite = replace(swing(), axial_load=load)
        other = replace(finite, kinematics=level)
        sizes, differences = np.array([0.2, 0.1, 0.05, 0.025]), []
        for size in sizes:
            start = {"slip": [0.05 * size], "rotation": [size]}
            runs = [
                rbsdem.time_history(
                    column, np.linspace(0, 2, 41), initial=start, dt=1e-3, method="rk4"
                )
                for column in (finite, other)
            ]
            differences.append(relative(runs[0].displacement, runs[1].displacement))
        orders.append(slope(sizes, differences))
    return (
        "`finite` to `small` (no load) and to `pdelta` (with load)",
        "free vibration, theta from 0.2 to 0.025 rad, relative difference",
        "order " + ", ".join(f"{order:.2f}" for order in orders),
        "2",
    )


# ---- helpers -------------------------------------------------------------------------------------


def chain(n: int, rng: np.random.Generator, *, nonlinear: bool = False) -> rbsdem.Column:
    """Return a random chain of n bodies, all different."""
    lengths, masses = rng.uniform(0.3, 1.2, n), rng.uniform(100, 500, n)
    shear: list[Elastic | Bilinear] = []
    flexure: list[Elastic | Takeda] = []
    for _ in range(n):
        k_v, k_m = rng.uniform(5e7, 2e8), rng.uniform(5e7, 2e8)
        if nonlinear:
            d_y, d_c = 1e5 / k_v, 4e4 / k_m
            shear.append(Bilinear(k_v, d_y, 0.05 * k_v))
            flexure.append(Takeda(k_m, d_c, 0.3 * k_m, 8 * d_c, 0.05 * k_m, b1=0.4))
        else:
            shear.append(Elastic(k_v))
            flexure.append(Elastic(k_m))
    return rbsdem.Column(lengths.sum(), None, shear, flexure, n=n, lengths=lengths, masses=masses)


def swing() -> rbsdem.Column:
    """Return the soft column of misprint E6, with finite rotations."""
    return rbsdem.Column(1.6, 614.4, Elastic(7e3), Elastic(2.5e3), kinematics="finite")


def subdivided(path: Array, parts: int) -> Array:
    """Return the path with `parts` steps to each point."""
    corners = np.concatenate([[0.0], path])
    return np.concatenate(
        [np.linspace(a, b, parts + 1)[1:] for a, b in itertools.pairwise(corners)]
    )


def relative(a: Array, b: Array) -> float:
    """Return the largest difference over the largest value of `b`."""
    return float(np.max(np.abs(a - b)) / np.max(np.abs(b)))


def slope(steps: Array | list[float], errors: list[float]) -> float:
    """Return the observed order: slope of the errors over the steps, both logarithmic."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


if __name__ == "__main__":
    main()
