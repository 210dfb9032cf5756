"""Rows of studies/observed.py on the methods in time: orders, energy, large rotations."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import rbsdem
from rbsdem.springs import Bilinear, Elastic

Row = tuple[str, str, str, str]

KEY = "soesianawati_1"


def rows() -> list[Row]:
    """Return the rows, one after the other."""
    return [
        located_order(),
        pair_tolerance(),
        implicit_orders(),
        finite_chain_energy(),
        one_body_of_many(),
        spread_frequencies(),
    ]


def yielding(n: int) -> tuple[rbsdem.Column, dict[str, np.ndarray]]:
    """Return a column that yields and unloads under a push, with P-Delta and a mass on top."""
    column = rbsdem.Column(
        1.6,
        614.4,
        Bilinear(7e8 * n, 1.3e-4 / n, 8e6 * n),
        Bilinear(6e7 * n, 2.7e-3 / n, 1e7 * n),
        n=n,
        axial_load=2e5,
        top_mass=2e4,
        kinematics="pdelta",
    )
    push = {
        "time": np.linspace(0.0, 0.4, 21),
        "force": 1.5e5 * np.interp(np.linspace(0, 2, 21), [0, 1, 2], [0, 1, -0.7]),
    }
    return column, push


def errors_of(n: int, settings: list[dict]) -> list[float]:
    """Return the largest error of the displacement of runs with some settings."""
    column, push = yielding(n)
    exact = rbsdem.time_history(column, **push, method="rk45", tolerance=1e-13).displacement
    return [
        relative(rbsdem.time_history(column, **push, **setting).displacement, exact)
        for setting in settings
    ]


def located_order() -> Row:
    """RK4 with located events through yielding and unloading."""
    found = []
    for n in (1, 3):
        limit = rbsdem.modes(yielding(n)[0]).stable_step
        steps = [0.02 / np.ceil(0.02 / (0.5 * limit * share)) for share in (1 / 2, 1 / 4, 1 / 8)]
        for events in ("located", "step"):
            errors = errors_of(n, [{"method": "rk4", "dt": dt, "events": events} for dt in steps])
            found.append(f"{events} {slope(steps, errors):.1f} (to {errors[-1]:.0e})")
    return (
        "RK4 through yielding and unloading, events located or at the end of a step",
        "bilinear springs, P-Delta, n = 1 and 3, against rk45 with tolerance 1e-13",
        "order " + ", ".join(found),
        "4; step: 2",
    )


def pair_tolerance() -> Row:
    """Error of rk45 over its tolerance."""
    tolerances = (1e-6, 1e-8, 1e-10)
    errors = errors_of(1, [{"method": "rk45", "tolerance": value} for value in tolerances])
    return (
        "rk45, error of the displacement for tolerances of 1e-6, 1e-8, 1e-10",
        "the same column, n = 1",
        ", ".join(f"{error:.0e}" for error in errors),
        "in proportion",
    )


def implicit_orders() -> Row:
    """Order of the implicit methods, elastic and yielding."""
    found = []
    for method in ("newmark", "hht", "generalised_alpha"):
        steps = [0.02 / parts for parts in (2000, 4000, 8000)]
        errors = errors_of(1, [{"method": method, "dt": dt} for dt in steps])
        found.append(f"{method} {slope(steps, errors):.1f}")
    return (
        "Newmark, HHT, generalised-alpha through yielding",
        "the same column, steps of 1e-5 to 2.5e-6 s",
        "order " + ", ".join(found),
        "2",
    )


def finite_chain_energy() -> Row:
    """Free vibration of three bodies with large rotations."""
    column = rbsdem.Column(
        1.6,
        600.0,
        Elastic(4e5),
        Elastic(3e4),
        n=3,
        kinematics="finite",
        self_weight=True,
        axial_load=100.0,
    )
    start = {"slip": [0.01, 0.02, -0.01], "rotation": [0.5, -0.3, 0.4]}
    steps, residuals, largest = [4e-4, 2e-4, 1e-4], [], 0.0
    for dt in steps:
        run = rbsdem.time_history(
            column, np.linspace(0, 1, 101), initial=start, dt=dt, method="rk4"
        )
        residuals.append(run.summary["relative_energy_residual"])
        largest = run.summary["peak_rotation"]
    return (
        "`finite`, n = 3, energy of undamped free vibration over 1 s",
        f"rotations to {largest:.1f} rad, steps of 4e-4 to 1e-4 s",
        f"residual to {residuals[-1]:.0e}, order {slope(steps, residuals):.1f}",
        "4 or more",
    )


def one_body_of_many() -> Row:
    """Different levels and solvers for the same small motion."""
    column, push = yielding(10)
    explicit = rbsdem.time_history(column, **push, method="rk45", tolerance=1e-10)
    implicit = rbsdem.time_history(column, **push, method="newmark", dt=2e-6)
    finite = rbsdem.time_history(
        replace(column, kinematics="finite"), **push, method="rk45", tolerance=1e-10
    )
    return (
        "n = 10: rk45 against Newmark with a step of 2e-6 s, and against `finite`",
        "bilinear springs, P-Delta",
        f"{relative(implicit.displacement, explicit.displacement):.0e}, "
        f"{relative(finite.displacement, explicit.displacement):.0e} of the peak",
        "step squared; angle squared",
    )


def spread_frequencies() -> Row:
    """Frequencies of one body whose springs differ by orders of magnitude, against eq 6."""
    worst = 0.0
    for power in range(-9, 10, 3):
        kappa, k_m, length, mass = 10.0**power, 2.5e8, 1.6, 614.4
        k_v = kappa * k_m / length**2
        column = rbsdem.Column(length, mass, Elastic(k_v), Elastic(k_m))
        total = 4 * k_v / mass + 12 * k_m / (mass * length**2)
        product = 12 * k_v * k_m / (mass**2 * length**2)
        high = total / 2 + np.sqrt(total**2 / 4 - product)
        exact = np.sqrt([product / high, high])
        worst = max(worst, relative(rbsdem.modes(column).omega, exact))
        worst = max(worst, float(np.max(np.abs(rbsdem.modes(column).omega / exact - 1))))
    return (
        "frequencies of one body, k_V l^2/k_M from 1e-9 to 1e9",
        "against the closed form",
        f"largest relative error of any {worst:.0e}",
        "round-off",
    )


def relative(a: np.ndarray, b: np.ndarray) -> float:
    """Return the largest difference over the largest value of `b`."""
    return float(np.max(np.abs(a - b)) / np.max(np.abs(b)))


def slope(steps: list[float], errors: list[float]) -> float:
    """Return the observed order: slope of the errors over the steps, both logarithmic."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])
