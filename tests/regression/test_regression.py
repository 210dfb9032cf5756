"""Whole cases: the executable against Python to the last digit, and against stored rows.

Each `NN-name.nml` is run by the executable. The same case written in Python below must give the
same numbers, bit by bit; the rows stored in `NN-name.csv` must come back to 1e-9. As a stored
result proves nothing by itself, each case also has a reason: what its rows, and above all the last
one, must be by a closed form, a balance or another method.

A row that is meant to change is stored anew by `rbsdem run tests/regression/NN-name.nml`.
"""

from __future__ import annotations

import importlib
import os
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from integrators import Finite, alpha_method, directions, linear_chain, modal_damping, until
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

import rbsdem
from rbsdem import __main__ as command
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    PeakOriented,
    Pinching,
    SteelSpring,
    Takeda,
)

HERE = Path(__file__).parent
G = 9.80665

Rows = dict[str, np.ndarray]

BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b0=0.4, b1=0.22)
LENGTH, MASS = 1.6, 614.4


@dataclass(frozen=True)
class Case:
    """The same case in Python, and why its rows are right."""

    run: Callable[[], rbsdem.Result]
    reason: Callable[[Rows], None]


# ---- 01: bilinear --------------------------------------------------------------------------------


def run_static_bilinear() -> rbsdem.Result:
    column = rbsdem.Column(LENGTH, MASS, BILINEAR, Elastic(2.5428e8))
    drift = np.array([0.0025, 0.005, 0.01]) * LENGTH
    return rbsdem.cyclic(
        column, displacement=rbsdem.protocol(drift, [1, 2, 1], repeats=2, points=5)
    )


def reason_static_bilinear(rows: Rows) -> None:
    """Springs in series make a bilinear system, takeda.md section 2c: loops are parallelograms."""
    base = LENGTH**2 / 2.5428e8
    k, k_post = 1 / (1 / BILINEAR.k + base), 1 / (1 / BILINEAR.k_post + base)
    yield_force = BILINEAR.k * BILINEAR.d_y
    offset = yield_force * (1 - k_post / k)  # of the two bounding lines
    force, expected = 0.0, []
    before = 0.0
    for d in rows["displacement_m"]:
        force = np.clip(force + k * (d - before), k_post * d - offset, k_post * d + offset)
        expected.append(force)
        before = d
    np.testing.assert_allclose(rows["force_N"], expected, rtol=1e-11, atol=1e-6)
    # The last cycle of 0.016 m of both runs: area of a parallelogram.
    work = rows["spring_J"]
    area = 4 * offset * (0.016 - yield_force / k)
    assert work[160] - work[140] == pytest.approx(
        area + (rows["force_N"][160] ** 2 - rows["force_N"][140] ** 2) / (2 * k), rel=1e-9
    )


# ---- 02: three bodies with P-Delta ---------------------------------------------------------------

LENGTHS, MASSES, LOAD = np.array([0.8, 1.0, 1.2]), np.array([4.0e4, 2.5e4, 2.5e4]), 800e3
SHEAR = (Bilinear(7e8, 2e-4, 8e6), Elastic(5e8), Elastic(5e8))
FLEXURE = (
    Takeda(2.5e8, 3e-4, 6.3e7, 2.7e-3, 7.6e6, b0=0.5, b1=0.22),
    Bilinear(1.5e8, 1e-3, 2e7),
    Elastic(1e8),
)


def run_static_pdelta() -> rbsdem.Result:
    column = rbsdem.Column(
        3.0,
        None,
        SHEAR,
        FLEXURE,
        n=3,
        lengths=LENGTHS,
        masses=MASSES,
        kinematics="pdelta",
        axial_load=LOAD,
        self_weight=True,
    )
    path = rbsdem.protocol(np.array([5.0, 15.0, 40.0]) / 1000, points=8)
    return rbsdem.cyclic(column, displacement=path)


def reason_static_pdelta(rows: Rows) -> None:
    """Equilibrium of what is above each joint in the deformed place, theory section 3."""
    slip, rotation, shear, moment = (
        np.array([rows[f"{name}_{i}_{unit}"] for i in (1, 2, 3)])
        for name, unit in (("slip", "m"), ("rotation", "rad"), ("shear", "N"), ("moment", "Nm"))
    )
    theta = np.cumsum(rotation, axis=0)
    top = np.cumsum(slip + theta * LENGTHS[:, None], axis=0)  # x of the top of each body
    foot = top - theta * LENGTHS[:, None]
    centre = foot + theta * LENGTHS[:, None] / 2
    force, weight = rows["force_N"], MASSES * G
    np.testing.assert_allclose(top[2], rows["displacement_m"], rtol=1e-12, atol=1e-16)
    size = np.max(np.abs(force))
    for i in range(3):
        below = theta[i - 1] if i else 0.0
        axial = LOAD + weight[i:].sum()
        np.testing.assert_allclose(shear[i], force + axial * below, atol=1e-10 * size)
        lever = force * LENGTHS[i:].sum() + LOAD * (top[2] - foot[i])
        lever += sum(weight[k] * (centre[k] - foot[i]) for k in range(i, 3))
        np.testing.assert_allclose(moment[i], lever, atol=1e-10 * size)
    # The last row: back at zero displacement, all springs on their rules.
    assert rows["displacement_m"][-1] == 0.0
    elastic = [(shear[1], slip[1], 5e8), (shear[2], slip[2], 5e8), (moment[2], rotation[2], 1e8)]
    for f, d, k in elastic:
        np.testing.assert_allclose(f, k * d, rtol=1e-12, atol=1e-9)
    # A bilinear spring is within its two bounding lines, and on one of them at the peaks.
    for f, d, spring in ((shear[0], slip[0], SHEAR[0]), (moment[1], rotation[1], FLEXURE[1])):
        offset = spring.d_y * (spring.k - spring.k_post)
        assert np.all(np.abs(f - spring.k_post * d) <= offset * (1 + 1e-12))
    peak = np.argmax(np.abs(moment[0]))
    backbone = FLEXURE[0].k_c * FLEXURE[0].d_c + FLEXURE[0].k_y * (FLEXURE[0].d_y - FLEXURE[0].d_c)
    backbone += FLEXURE[0].k_u * (abs(rotation[0, peak]) - FLEXURE[0].d_y)
    assert abs(moment[0, peak]) == pytest.approx(backbone, rel=1e-12)


# ---- 03: Takeda driven by force ------------------------------------------------------------------

CRACK = TAKEDA.k_c * TAKEDA.d_c
YIELD = CRACK + TAKEDA.k_y * (TAKEDA.d_y - TAKEDA.d_c)


def backbone_rotation(moment: float) -> float:
    if moment <= CRACK:
        return moment / TAKEDA.k_c
    if moment <= YIELD:
        return TAKEDA.d_c + (moment - CRACK) / TAKEDA.k_y
    return TAKEDA.d_y + (moment - YIELD) / TAKEDA.k_u


def unloading_stiffness(peak: float) -> float:
    """Rule 1 of takeda.md for a peak beyond yield."""
    return (CRACK + YIELD) / (TAKEDA.d_c + TAKEDA.d_y) * (TAKEDA.d_y / peak) ** TAKEDA.b0


def run_static_force() -> rbsdem.Result:
    column = rbsdem.Column(LENGTH, MASS, Elastic(7.0387e8), TAKEDA)
    return rbsdem.cyclic(column, force=rbsdem.protocol(180.0 * 1000, points=6))


def reason_static_force(rows: Rows) -> None:
    """Up, back, down and back along the lines of takeda.md, rules 1 and 2."""
    force = 180e3 * np.interp(np.arange(25), [0, 6, 18, 24], [0, 1, -1, 0])
    np.testing.assert_allclose(rows["force_N"], force, rtol=1e-15, atol=1e-10)
    peak = backbone_rotation(180e3 * LENGTH)
    assert peak > 2 * TAKEDA.d_y
    soft = unloading_stiffness(peak)
    np.testing.assert_allclose(
        rows["rotation_1_rad"][:7], [backbone_rotation(f * LENGTH) for f in force[:7]], rtol=1e-13
    )
    np.testing.assert_allclose(
        rows["rotation_1_rad"][6:13], peak - (180e3 - force[6:13]) * LENGTH / soft, rtol=1e-12
    )
    # The other side is not cracked: past zero on the same line to -Fc, then to its yield point.
    crack = peak - (180e3 * LENGTH + CRACK) / soft
    to_yield = (YIELD - CRACK) / (TAKEDA.d_y + crack)
    for row in range(13, 19):
        moment = -force[row] * LENGTH
        if moment <= CRACK:
            expected = peak - (180e3 * LENGTH + moment) / soft
        elif moment <= YIELD:
            expected = crack - (moment - CRACK) / to_yield
        else:
            expected = -backbone_rotation(moment)
        assert rows["rotation_1_rad"][row] == pytest.approx(expected, rel=1e-12)
    last = -peak + 180e3 * LENGTH / soft
    assert rows["rotation_1_rad"][-1] == pytest.approx(last, rel=1e-12)
    assert rows["displacement_m"][-1] == pytest.approx(last * LENGTH, rel=1e-12)


# ---- 04: elastic on moving ground ----------------------------------------------------------------


def run_rk4_ground() -> rbsdem.Result:
    column = rbsdem.Column(
        2.0,
        None,
        Elastic(3e8),
        [Elastic(4e7), Elastic(6e7)],
        n=2,
        lengths=[1.2, 0.8],
        masses=[900.0, 500.0],
        damping=rbsdem.Damping(mass=8.0, stiffness=2e-5),
    )
    time, ground = np.loadtxt(HERE / "04-rk4-ground.txt").T
    return rbsdem.time_history(
        column, time, ground_acceleration=ground * G, dt=1e-5, every=500, method="rk4"
    )


def reason_rk4_ground(rows: Rows) -> None:
    """Exact response of the linear equations to straight lines of the ground, by expm."""
    lengths, masses = np.array([1.2, 0.8]), np.array([900.0, 500.0])
    # Centroids and rotations in (u1, u2, phi1, phi2).
    centres = np.array([[1, 0, 0.6, 0], [1, 1, 1.6, 0.4]])
    turns = np.array([[0, 0, 1, 0], [0, 0, 1, 1]])
    mass = centres.T * masses @ centres + turns.T * (masses * lengths**2 / 12) @ turns
    stiffness = np.diag([3e8, 3e8, 4e7, 6e7])
    damping = 8.0 * mass + 2e-5 * stiffness
    system = np.zeros((10, 10))  # q, v, ground acceleration and its slope
    system[:4, 4:8] = np.eye(4)
    system[4:8, :4] = -np.linalg.solve(mass, stiffness)
    system[4:8, 4:8] = -np.linalg.solve(mass, damping)
    system[4:8, 8] = -np.linalg.solve(mass, masses @ centres)
    system[8, 9] = 1.0
    times, ground = np.loadtxt(HERE / "04-rk4-ground.txt").T
    np.testing.assert_allclose(rows["time_s"], np.arange(17) * 0.005, rtol=1e-12)
    state, exact, now = np.zeros(10), [np.zeros(4)], 0.0
    for time in rows["time_s"][1:]:
        # Times of rows hold all corners of the ground motion.
        at = int(np.searchsorted(times, now + 1e-9)) - 1
        slope = (ground[at + 1] - ground[at]) / (times[at + 1] - times[at])
        state[8:] = G * np.array([ground[at] + slope * (now - times[at]), slope])
        state = expm(system * (time - now)) @ state
        exact.append(state[:4].copy())
        now = time
    names = ("slip_1_m", "slip_2_m", "rotation_1_rad", "rotation_2_rad")
    for i, name in enumerate(names):
        reference = np.array(exact)[:, i]
        # RK4: (omega h)^4/120 for each radian, of the highest mode.
        np.testing.assert_allclose(rows[name], reference, atol=1e-7 * np.max(np.abs(reference)))
    assert rows["damping_J"][-1] > 0.2 * rows["input_J"].max()
    assert np.max(np.abs(rows["residual_J"])) < 1e-9 * rows["input_J"].max()


# ---- 05: exact rotations -------------------------------------------------------------------------


def run_rk4_finite() -> rbsdem.Result:
    column = rbsdem.Column(
        LENGTH,
        MASS,
        Elastic(7e4),
        Elastic(2.5e4),
        kinematics="finite",
        axial_load=600.0,
        self_weight=True,
        damping=rbsdem.Damping(mass=0.5),
    )
    time = np.arange(13) * (1.5 / 12)
    force = rbsdem.protocol(4.0 * 1000, points=3)
    # Beyond the end of the loading its last value is held.
    time, force = np.append(time, 2.0), np.append(force, force[-1])
    return rbsdem.time_history(column, time, force=force, dt=1e-3, every=50, method="rk4")


def reason_rk4_finite(rows: Rows) -> None:
    """Equation 4 corrected (theory section 3) by an integrator of order 8 with error control."""
    corners, values = np.arange(13) * 0.125, 4e3 * rbsdem.protocol(1.0, points=3)
    inertia, half = MASS * LENGTH**2 / 12, MASS * LENGTH / 2

    def rate(time: float, state: np.ndarray) -> list[float]:
        slip, angle, velocity, spin = state
        force = np.interp(time, corners, values)
        c, s = np.cos(angle), np.sin(angle)
        mass = np.array([[MASS, half * c], [half * c, inertia + MASS * LENGTH**2 / 4]])
        load = [
            force - 7e4 * slip + half * s * spin**2,
            force * LENGTH * c + (600.0 + MASS * G / 2) * LENGTH * s - 2.5e4 * angle,
        ]
        load -= 0.5 * mass @ [velocity, spin]
        return [velocity, spin, *np.linalg.solve(mass, load)]

    exact = np.zeros((rows["time_s"].size, 4))
    stops = np.unique(np.concatenate([corners, rows["time_s"]]).round(9))
    state = np.zeros(4)
    for begin, end in pairwise(stops):
        solved = solve_ivp(rate, (begin, end), state, "DOP853", rtol=1e-12, atol=1e-13)
        state = solved.y[:, -1]
        exact[np.isclose(rows["time_s"], end, rtol=0, atol=1e-9)] = state
    assert np.max(np.abs(exact[:, 1])) > 0.3  # far from small
    np.testing.assert_allclose(rows["slip_1_m"], exact[:, 0], atol=1e-8)
    np.testing.assert_allclose(rows["rotation_1_rad"], exact[:, 1], atol=1e-8)
    top = exact[:, 0] + LENGTH * np.sin(exact[:, 1])
    np.testing.assert_allclose(rows["displacement_m"], top, atol=3e-8)


# ---- 06: slow force by RK4 -----------------------------------------------------------------------


SMOOTH = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, inner="one")


def run_rk4_slow() -> rbsdem.Result:
    column = rbsdem.Column(LENGTH, MASS, BILINEAR, SMOOTH, damping=rbsdem.Damping(mass=60.0))
    force = rbsdem.protocol(np.array([60.0, 130.0]) * 1000, [1, 2], repeats=2, points=10)
    return rbsdem.time_history(
        column, np.arange(force.size) * (8.0 / 40), force=force, method="rk4"
    )


def reason_rk4_slow(rows: Rows) -> None:
    """Slow and damped, the response follows the static path; the balance closes."""
    column = rbsdem.Column(LENGTH, MASS, BILINEAR, SMOOTH)
    static = rbsdem.cyclic(column, force=rows["force_N"])
    size = np.max(np.abs(static.displacement))
    np.testing.assert_allclose(rows["displacement_m"], static.displacement, atol=0.01 * size)
    assert rows["displacement_m"][-1] == pytest.approx(static.displacement[-1], abs=0.01 * size)
    # Not a test of elastic lines.
    assert np.max(np.abs(rows["slip_1_m"])) > 2 * BILINEAR.d_y
    assert np.max(np.abs(rows["rotation_1_rad"])) > 5 * TAKEDA.d_c
    balance = rows["input_J"] - sum(
        rows[f"{name}_J"] for name in ("kinetic", "spring", "damping", "axial", "residual")
    )
    assert np.max(np.abs(balance)) < 1e-12 * rows["input_J"].max()
    assert np.max(np.abs(rows["residual_J"])) < 1e-6 * rows["input_J"].max()


# ---- 07: a file ----------------------------------------------------------------------------------

FILE_MM = np.array([0.0, 0.4, 2.5, 7.0, 12.0, 11.5])


def run_history_file() -> rbsdem.Result:
    test = rbsdem.peer.read_peer(HERE / "07-history-file.txt")
    return rbsdem.cyclic(
        rbsdem.Column(LENGTH, MASS, BILINEAR, TAKEDA), displacement=test.displacement * 1.5
    )


def reason_history_file(rows: Rows) -> None:
    """Backbones in series on the way up, unloading stiffnesses in series on the way back."""
    np.testing.assert_allclose(rows["displacement_m"], FILE_MM * 1.5e-3, rtol=1e-15)

    def displacement(force: float) -> float:
        slip = force / BILINEAR.k
        if slip > BILINEAR.d_y:
            slip = BILINEAR.d_y + (force - BILINEAR.k * BILINEAR.d_y) / BILINEAR.k_post
        return slip + LENGTH * backbone_rotation(force * LENGTH)

    for row in range(1, 5):
        reached = displacement(rows["force_N"][row])
        assert reached == pytest.approx(rows["displacement_m"][row], rel=1e-12)
    peak = backbone_rotation(rows["force_N"][4] * LENGTH)
    back = 1 / (1 / BILINEAR.k + LENGTH**2 / unloading_stiffness(peak))
    last = rows["force_N"][4] - back * 0.75e-3
    assert rows["force_N"][-1] == pytest.approx(last, rel=1e-12)
    assert 0 < last < rows["force_N"][4]


# ---- 08: average acceleration, modal damping -----------------------------------------------------


def run_newmark_modal() -> rbsdem.Result:
    column = rbsdem.Column(
        6.0,
        12e3,
        Elastic(6e8),
        [Elastic(2e8), Elastic(4e8), Elastic(4e8)],
        n=3,
        lengths=[2.5, 2.0, 1.5],
        top_mass=80e3,
        top_inertia=9e4,
        depth=0.9,
        damping=rbsdem.Damping(modal=[0.05, 0.03]),
        kinematics="pdelta",
        axial_load=785e3,
        self_weight=True,
    )
    ground = rbsdem.protocol(np.array([0.2, 0.4]) * G, points=4)
    time = np.arange(33) * (0.8 / 16)
    return rbsdem.time_history(column, time, ground_acceleration=ground, method="newmark", dt=0.01)


def reason_newmark_modal(rows: Rows) -> None:
    """The recursion of Newmark 1959 with matrices of another make."""
    lengths = np.array([2.5, 2.0, 1.5])
    masses = 12e3 * lengths / 6
    inertias = masses * (lengths**2 + 0.9**2) / 12
    springs = np.full(3, 6e8), np.array([2e8, 4e8, 4e8])
    chain = linear_chain(lengths, masses, inertias, springs, lumped=(80e3, 9e4), load=785e3)
    motion = G * rbsdem.protocol([0.2, 0.4], points=4)
    ground = np.interp(np.arange(161) / 5, np.arange(33), motion)
    damping = modal_damping(chain, [0.05, 0.03])
    q = alpha_method(chain, damping, -np.outer(ground, chain.ground), 0.01)[::5]
    size = np.max(np.abs(q @ chain.top))
    np.testing.assert_allclose(rows["displacement_m"], q @ chain.top, atol=1e-10 * size)
    for i in range(3):
        size = np.max(np.abs(q[:, i]))
        np.testing.assert_allclose(rows[f"slip_{i + 1}_m"], q[:, i], atol=1e-9 * size)
    # Average acceleration keeps the energy of a linear system to round-off.
    assert np.max(np.abs(rows["residual_J"])) < 1e-11 * rows["input_J"].max()
    assert rows["damping_J"][-1] > 0.2 * rows["input_J"].max()


# ---- 09: generalised-alpha -----------------------------------------------------------------------


def run_alpha_force() -> rbsdem.Result:
    column = rbsdem.Column(
        3.0,
        3e3,
        Elastic(5e8),
        Elastic(5e7),
        n=2,
        rotary_inertia=[400.0, 300.0],
        damping=rbsdem.Damping(mass=1.0, stiffness=1e-4),
    )
    wave = rbsdem.protocol(1.0, points=5)
    return rbsdem.time_history(
        column,
        np.arange(21) * (0.5 / 20),
        force=40.0 * wave * 1000,
        ground_acceleration=2.0 * wave,
        method="generalised_alpha",
        rho_infinity=0.6,
        dt=0.005,
        every=5,
    )


def reason_alpha_force(rows: Rows) -> None:
    """The recursion of Chung and Hulbert 1993 with matrices of another make."""
    lengths, masses, inertias = np.full(2, 1.5), np.full(2, 1.5e3), np.array([400.0, 300.0])
    springs = np.full(2, 5e8), np.full(2, 5e7)
    chain = linear_chain(lengths, masses, inertias, springs)
    wave = np.interp(np.arange(101), np.arange(21) * 5, rbsdem.protocol(1.0, points=5))
    loads = np.outer(wave, 40e3 * chain.top - 2.0 * chain.ground)
    damping = 1.0 * chain.mass + 1e-4 * chain.stiffness
    q = alpha_method(chain, damping, loads, 0.005, rho=0.6)[::5]
    for name, values in (("displacement_m", q @ chain.top), ("rotation_2_rad", q[:, 3])):
        size = np.max(np.abs(values))
        np.testing.assert_allclose(rows[name], values, atol=1e-10 * size)
    # The highest mode is far beyond the step: explicit methods could not take it.
    highest = np.sqrt(np.linalg.eigvals(np.linalg.solve(chain.mass, chain.stiffness)).max())
    assert highest.real * 0.005 > 2 * np.sqrt(2)


# ---- 10: two bodies that turn far ----------------------------------------------------------------


def run_rk45_finite() -> rbsdem.Result:
    column = rbsdem.Column(
        2.0,
        1e3,
        Elastic(4e5),
        Elastic(4e4),
        n=2,
        lengths=[1.2, 0.8],
        top_mass=300.0,
        kinematics="finite",
        damping=rbsdem.Damping(mass=0.3),
        axial_load=4e3,
        self_weight=True,
        axial_follows=True,
        force_follows=True,
    )
    wave = rbsdem.protocol(1.0, points=3)
    return rbsdem.time_history(
        column,
        np.arange(13) * (1.2 / 12),
        force=9e3 * wave,
        vertical_acceleration=4.0 * wave,
        axial_load=4e3 + 2e3 * wave,
        method="rk45",
        tolerance=1e-11,
    )


def reason_rk45_finite(rows: Rows) -> None:
    """M(q) and the inertia forces of another make, by an integrator of order 8."""
    chain = Finite(np.array([1.2, 0.8]), np.array([600.0, 400.0]), 300.0)
    springs = np.array([4e5, 4e5, 4e4, 4e4])
    times, wave = rows["time_s"], rbsdem.protocol(1.0, points=3)
    masses = np.append(chain.masses, chain.lumped)

    def rate(time: float, state: np.ndarray) -> np.ndarray:
        q, v = np.split(state, 2)
        part = np.interp(time, times, wave)
        axis, normal = directions(q[2] + q[3])
        forces = np.zeros((3, 2))
        forces[:, 1] -= masses * 4.0 * part
        forces[:2, 1] -= chain.masses * G  # the weight of the lumped mass belongs to the load
        forces[2] += 9e3 * part * normal - (4e3 + 2e3 * part) * axis
        return np.concatenate([v, chain.acceleration(q, v, forces, springs, 0.3)])

    def solve(begin: float, end: float, state: np.ndarray) -> np.ndarray:
        solved = solve_ivp(rate, (begin, end), state, "DOP853", rtol=1e-12, atol=1e-13)
        return solved.y[:, -1]

    states = np.array([*until(solve, times, np.zeros(8)).values()])
    names = ("slip_1_m", "slip_2_m", "rotation_1_rad", "rotation_2_rad")
    for i, name in enumerate(names):
        size = np.max(np.abs(states[:, i]))
        np.testing.assert_allclose(rows[name], states[:, i], atol=1e-7 * size, err_msg=name)
    turn = states[:, 2] + states[:, 3]
    assert np.max(np.abs(turn)) > 0.5  # far from small
    (_, along), (axis_1, axis_2) = directions(0.0), (directions(states[:, 2]), directions(turn))
    first = states[:, :1] * along + 1.2 * axis_1[0].T
    top = first + states[:, 1:2] * axis_1[1].T + 0.8 * axis_2[0].T
    np.testing.assert_allclose(rows["displacement_m"], top[:, 0], atol=1e-7)
    np.testing.assert_allclose(rows["top_height_m"], top[:, 1], atol=1e-7)
    assert np.max(np.abs(rows["residual_J"])) < 1e-9 * rows["input_J"].max()


# ---- 11: contact ---------------------------------------------------------------------------------


def run_contact() -> rbsdem.Result:
    column = rbsdem.Column(
        1.0,
        1e3,
        Elastic(1e7),
        Elastic(1e7),
        axial_spring=Compression(4e6),
        self_weight=True,
    )
    ground = np.append(2.5 * G * rbsdem.protocol(1.0, points=2), 0.0)
    time = np.append(np.arange(9) * 0.02, 0.4)
    return rbsdem.time_history(
        column,
        time,
        vertical_acceleration=ground,
        method="rk4",
        events="located",
        dt=2e-4,
        every=100,
    )


def reason_contact(rows: Rows) -> None:
    """m w'' = -N - m (g + a), N = k w for w < 0: a spring in contact, a parabola in flight."""
    wave = np.append(rbsdem.protocol(1.0, points=2), 0.0)
    corners = np.append(np.arange(9) * 0.02, 0.4)

    def solve(begin: float, end: float, state: np.ndarray) -> np.ndarray:
        while begin < end:
            # In contact or on the way into it.
            touching = state[0] < 0 or (abs(state[0]) < 1e-14 and state[1] < 0)

            def rate(time: float, state: np.ndarray, touching=touching) -> list[float]:
                ground = 2.5 * G * np.interp(time, corners, wave)
                spring = 4e6 / 1e3 * state[0] if touching else 0.0
                return [state[1], -spring - G - ground]

            def leaves(_: float, state: np.ndarray) -> float:
                return state[0]

            leaves.terminal = True
            leaves.direction = 1 if touching else -1
            solved = solve_ivp(
                rate, (begin, end), state, "DOP853", rtol=1e-13, atol=1e-15, events=leaves
            )
            begin, state = solved.t[-1], solved.y[:, -1]
            if solved.t_events[0].size:
                state[0] = 0.0
                # On the other side, so that the next piece does not end where it begins.
                begin, state = begin + 1e-13, state + 1e-13 * np.array(rate(begin, state))
        return state

    stops = np.unique(np.concatenate([corners, rows["time_s"]]).round(9))
    states = until(solve, stops, np.array([-G * 1e3 / 4e6, 0.0]))
    opening = np.array([states[float(t.round(9))][0] for t in rows["time_s"]])
    size = np.max(np.abs(opening))
    assert size > 0.05  # it flies
    np.testing.assert_allclose(rows["opening_1_m"], opening, atol=1e-7 * size)
    force = np.minimum(4e6 * opening, 0.0)
    np.testing.assert_allclose(rows["axial_force_1_N"], force, atol=4e6 * 1e-7 * size)
    np.testing.assert_allclose(rows["top_height_m"], 1 + rows["opening_1_m"], rtol=1e-15)
    assert not rows["displacement_m"].any()


# ---- 12: static path with exact rotations --------------------------------------------------------


def run_static_finite() -> rbsdem.Result:
    column = rbsdem.Column(
        LENGTH,
        MASS,
        Elastic(2e5),
        Elastic(4e4),
        kinematics="finite",
        axial_load=5e3,
        self_weight=True,
    )
    return rbsdem.cyclic(
        column, displacement=rbsdem.protocol(np.array([0.3, 0.8]) * LENGTH, points=4)
    )


def reason_static_finite(rows: Rows) -> None:
    """Equilibrium of one body: slip F/k_V, moment of force, load and weight about the joint."""
    load = 5e3 + MASS * G / 2

    def force(turn: float) -> float:
        return (4e4 * turn - load * LENGTH * np.sin(turn)) / (LENGTH * np.cos(turn))

    for row, displacement in enumerate(rows["displacement_m"]):
        turn = brentq(
            lambda th, d=displacement: force(th) / 2e5 + LENGTH * np.sin(th) - d,
            -1.5,
            1.5,
            xtol=1e-14,
        )
        assert rows["rotation_1_rad"][row] == pytest.approx(turn, rel=1e-9, abs=1e-12)
        assert rows["force_N"][row] == pytest.approx(force(turn), rel=1e-9, abs=1e-6)
        assert rows["top_height_m"][row] == pytest.approx(LENGTH * np.cos(turn), rel=1e-12)
    assert np.max(np.abs(rows["rotation_1_rad"])) > 0.7
    np.testing.assert_allclose(rows["slip_1_m"], rows["force_N"] / 2e5, rtol=1e-12, atol=1e-14)


# ---- 13: capped backbone with deterioration ------------------------------------------------------

CAPPED = PeakOriented(
    d_c=5e-4,
    f_c=80e3,
    d_y=4e-3,
    f_y=230e3,
    d_cap=15e-3,
    f_cap=250e3,
    d_pc=60e-3,
    f_res=40e3,
    d_y_neg=3e-3,
    f_y_neg=180e3,
    f_cap_neg=190e3,
    b0=0.4,
    lambda_s=60,
    lambda_c=60,
    lambda_k=120,
    lambda_a=120,
    c=1.2,
)


def other_make(name: str) -> Any:
    """Return a module of `tests/python` with springs of another make."""
    place = str(HERE.parent / "python")
    if place not in sys.path:
        sys.path.append(place)
    return importlib.import_module(name)


def numbers_of(spring: rbsdem.springs.Spring) -> dict[str, Any]:
    """Return the parameters of a spring without those that are off, which another make may lack."""
    off = ("lambda_h", "s_min", "fade", "friction", "seating", "buckling")
    given = {k: v for k, v in asdict(spring).items() if v is not None}
    assert not any(given.get(name) for name in off)
    return {k: v for k, v in given.items() if k not in off}


def second_method(spring: PeakOriented) -> Any:
    """Return the spring once more, of another make (`tests/python/reference_capped`)."""
    return other_make("reference_capped").Capped(**numbers_of(spring))


def run_static_capped() -> rbsdem.Result:
    column = rbsdem.Column(1.6, 614.4, Elastic(4e8), CAPPED, kinematics="pdelta", axial_load=400e3)
    drifts = np.array([0.0025, 0.005, 0.01, 0.02, 0.03, 0.045])
    return rbsdem.cyclic(column, displacement=rbsdem.protocol(drifts * 1.6, cycles=1, points=4))


def reason_static_capped(rows: Rows) -> None:
    """Equilibrium with the load in the deformed place; the spring of another make."""
    turn, slip, moment = rows["rotation_1_rad"], rows["slip_1_m"], rows["moment_1_Nm"]
    size = np.max(np.abs(moment))
    np.testing.assert_allclose(slip, rows["shear_1_N"] / 4e8, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(slip + 1.6 * turn, rows["displacement_m"], rtol=1e-12, atol=1e-15)
    lever = 1.6 * (rows["force_N"] + 400e3 * turn)  # the joint has slipped with the body
    np.testing.assert_allclose(moment, lever, atol=1e-10 * size)
    # One body: it turns back where its top does, and there is a row.
    again = second_method(CAPPED).response(turn[1:])
    np.testing.assert_allclose(moment[1:], again, rtol=0, atol=1e-9 * size)
    peaks = [np.max(np.abs(moment[np.abs(turn) > drift])) for drift in (0.01, 0.028, 0.044)]
    assert peaks[0] > 1.4 * peaks[1] > 1.5 * peaks[2]  # beyond the cap


# ---- 14: pinching and deterioration in time ------------------------------------------------------

PINCHED = Pinching(
    d_c=5e-4,
    f_c=30e3,
    d_y=4e-3,
    f_y=80e3,
    d_cap=10e-3,
    f_cap=85e3,
    d_pc=40e-3,
    f_res=15e3,
    b0=0.3,
    lambda_s=30,
    lambda_c=30,
    lambda_k=60,
    lambda_a=60,
    kappa_f=0.4,
    kappa_d=0.3,
)


def run_pinching(method: str, dt: float, every: int) -> rbsdem.Result:
    column = rbsdem.Column(
        1.0,
        500.0,
        PINCHED,
        Elastic(5e7),
        top_mass=20e3,
        gravity=0.0,
        damping=rbsdem.Damping(mass=0.5),
    )
    ground = rbsdem.protocol(np.array([0.35, 0.6]) * G, points=3)
    time = np.append(np.arange(25) * (0.6 / 24), 1.2)
    return rbsdem.time_history(
        column,
        time,
        ground_acceleration=np.append(ground, 0.0),
        method=method,
        events="located" if method == "rk4" else None,
        dt=dt,
        every=every,
    )


def run_rk4_pinching() -> rbsdem.Result:
    return run_pinching("rk4", 1e-4, 200)


def reason_rk4_pinching(rows: Rows) -> None:
    """Another method in time; the spring along the path that it took, energies in balance."""
    other = run_pinching("newmark", 1e-5, 2000)
    slip = rows["slip_1_m"]
    size = np.max(np.abs(slip))
    assert size > 0.02  # beyond the cap
    np.testing.assert_allclose(slip, other.slip[:, 0], atol=2e-3 * size)
    steps = run_pinching("rk4", 1e-4, 1)
    force = np.array(PINCHED.response(steps.slip[1:, 0]))
    np.testing.assert_allclose(rows["shear_1_N"][1:], force[199::200], atol=1e-3 * 85e3)
    assert np.max(np.abs(rows["residual_J"])) < 1e-4 * rows["input_J"].max()


# ---- 15: layers of concrete and steel ------------------------------------------------------------

STRIP = ConcreteSpring(
    k=2e9,
    f_peak=0.6e6,
    d_peak=6e-4,
    k_soft=4e7,
    f_res=0.2e6,
    plastic=1.2,
    contact=0.35,
    misfit=0.4,
    wear=0.03,
)
SIDE = SteelSpring(
    6e8, 5.4e5, 6e6, r0=8, cr1=0.83, cr2=0.42, isotropic_hardening=0.005, endurance=800
)
MIDDLE = SteelSpring(
    4e8, 3.6e5, 4e6, r0=8, cr1=0.83, cr2=0.42, isotropic_hardening=0.005, endurance=800
)
STRIPS = [(y, STRIP) for y in (-0.175, -0.125, -0.075, -0.025, 0.025, 0.075, 0.125, 0.175)]
LAYERED = Layered((*STRIPS, (-0.16, SIDE), (0.0, MIDDLE), (0.16, SIDE)))


def run_static_layered() -> rbsdem.Result:
    column = rbsdem.Column(1.6, 614.4, Elastic(4e8), LAYERED, kinematics="pdelta", axial_load=700e3)
    drifts = np.array([0.0025, 0.005, 0.01, 0.02, 0.03])
    return rbsdem.cyclic(column, displacement=rbsdem.protocol(drifts * 1.6, cycles=2, points=4))


def reason_static_layered(rows: Rows) -> None:
    """Equilibrium with the load in the deformed place; the joint of another make, in steps."""
    turn, moment = rows["rotation_1_rad"], rows["moment_1_Nm"]
    size = np.max(np.abs(moment))
    lever = 1.6 * (rows["force_N"] + 700e3 * turn)  # the joint has slipped with the body
    np.testing.assert_allclose(moment, lever, atol=1e-10 * size)
    reference = other_make("reference_layered")
    layers = []
    for y, spring in LAYERED.layers:
        kind = reference.Concrete if spring is STRIP else reference.Steel
        layers.append((y, kind(**numbers_of(spring))))
    expected = reference.response(700e3, layers, turn, 10)
    np.testing.assert_allclose(moment, expected, atol=2e-3 * size)  # of first order in the steps


# --------------------------------------------------------------------------------------------------

CASES = {
    "01-static-bilinear": Case(run_static_bilinear, reason_static_bilinear),
    "02-static-pdelta": Case(run_static_pdelta, reason_static_pdelta),
    "03-static-force": Case(run_static_force, reason_static_force),
    "04-rk4-ground": Case(run_rk4_ground, reason_rk4_ground),
    "05-rk4-finite": Case(run_rk4_finite, reason_rk4_finite),
    "06-rk4-slow": Case(run_rk4_slow, reason_rk4_slow),
    "07-history-file": Case(run_history_file, reason_history_file),
    "08-newmark-modal": Case(run_newmark_modal, reason_newmark_modal),
    "09-alpha-force": Case(run_alpha_force, reason_alpha_force),
    "10-rk45-finite": Case(run_rk45_finite, reason_rk45_finite),
    "11-contact": Case(run_contact, reason_contact),
    "12-static-finite": Case(run_static_finite, reason_static_finite),
    "13-static-capped": Case(run_static_capped, reason_static_capped),
    "14-rk4-pinching": Case(run_rk4_pinching, reason_rk4_pinching),
    "15-static-layered": Case(run_static_layered, reason_static_layered),
}


def read_rows(path: Path) -> Rows:
    lines = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
    table = np.array([[float(word) for word in line.split(",")] for line in lines[1:]])
    return dict(zip(lines[0].split(","), table.T, strict=True))


def rows_of(result: rbsdem.Result) -> list[np.ndarray]:
    """Columns of a result in the order of the csv."""
    energies = [result.energy[name] for name in result.energy]
    joints = [result.slip, result.rotation, result.shear, result.moment]
    if result.axial_force is not None:
        joints[2:2] = [result.opening]
        joints += [result.axial_force]
    columns = [result.time, result.displacement, result.force, *energies, result.top[:, 1]]
    columns += [values for joint in joints for values in joint.T]
    if result.dynamic and result.column.damped:
        columns += [result.base_shear, result.base_moment]
    return columns


@pytest.fixture(scope="module")
def rows(tmp_path_factory) -> Callable[[str], Rows]:
    """Rows of a case as the executable gives them."""
    program = Path(os.environ.get("RBSDEM_EXECUTABLE") or command.executable()).absolute()
    folder = tmp_path_factory.mktemp("regression")

    def run(name: str) -> Rows:
        output = folder / f"{name}.csv"
        if not output.is_file():
            result = subprocess.run(
                [program, "run", HERE / f"{name}.nml", "--quiet", "--output", output],
                capture_output=True,
                text=True,
                timeout=20,
                check=False,
            )
            assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
        return read_rows(output)

    return run


def test_every_case_of_the_folder_is_tested():
    assert sorted(path.stem for path in HERE.glob("*.nml")) == sorted(CASES)
    assert sorted(path.stem for path in HERE.glob("*.csv")) == sorted(CASES)


@pytest.mark.parametrize("name", CASES)
def test_executable_equals_python_to_the_last_digit(rows, name):
    """Both doors lead to the same analysis."""
    expected = rows_of(CASES[name].run())
    got = rows(name)
    assert len(expected) == len(got)
    for (label, values), column in zip(got.items(), expected, strict=True):
        assert np.array_equal(values, column), label


@pytest.mark.parametrize("name", CASES)
def test_rows_are_those_stored(rows, name):
    got, stored = rows(name), read_rows(HERE / f"{name}.csv")
    assert list(got) == list(stored)
    energy = max(np.max(np.abs(stored[f"{kind}_J"])) for kind in ("input", "spring"))
    for label, values in stored.items():
        # What round-off leaves where a zero should be is not stored knowledge.
        scale = energy if label.endswith("_J") else np.max(np.abs(values))
        np.testing.assert_allclose(got[label], values, rtol=1e-9, atol=1e-9 * scale, err_msg=label)


@pytest.mark.parametrize("name", CASES)
def test_rows_have_a_reason(rows, name):
    CASES[name].reason(rows(name))
