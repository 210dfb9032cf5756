"""Shear and moment at the base, held against the equilibrium of the bodies with their inertia.

The base forces are sums over the lowest joint and the damping. Here they are what the ground must
hold: lateral force and axial load less the inertia of all bodies. Accelerations and positions of
the bodies with exact rotations come from `reference_chain`; for small rotations see
`test_invariants.py`.
"""

from __future__ import annotations

import numpy as np
import pytest
from reference_chain import STEP, Chain, as_initial, chain

import rbsdem
from rbsdem.springs import Elastic, Takeda

N = 3
LENGTHS, MASSES = np.array([0.9, 0.6, 0.7]), np.array([50.0, 20.0, 30.0])
HEIGHT = LENGTHS.sum()
K_V, K_M = np.array([4e4, 3e4, 2e4]), np.array([9e3, 7e3, 5e3])
#: Lateral force [N] and acceleration of the ground [m/s2] at the start.
FORCE, GROUND = 700.0, -4.0
RNG = np.random.default_rng(7)

DAMPINGS = {
    "none": None,
    "mass": rbsdem.Damping(mass=0.7),
    "stiffness": rbsdem.Damping(stiffness=2e-3),
}


def column_of(kinematics: str, damping: rbsdem.Damping | None, **more) -> rbsdem.Column:
    return chain(LENGTHS, MASSES, K_V, K_M, kinematics=kinematics, damping=damping, **more)


def start(column: rbsdem.Column, q, v) -> rbsdem.Result:
    """The first row of a run that begins at a state."""
    return rbsdem.time_history(
        column, [0.0, 1e-4], force=[FORCE, FORCE], ground_acceleration=[GROUND, GROUND],
        initial=as_initial(q, v, N), method="rk4",
    )  # fmt: skip


@pytest.mark.parametrize("damping", ["none", "mass", "stiffness"])
def test_base_forces_hold_the_bodies_with_exact_rotations(damping):
    column = column_of(
        "finite", DAMPINGS[damping], axial_load=1500.0, self_weight=True, top_mass=12.0
    )
    reference = Chain(column, lambda _: (FORCE, GROUND, 0.0, 0.0))
    for _ in range(3):
        q, v = RNG.normal(0, 0.3, 2 * N), RNG.normal(0, 2.0, 2 * N)
        q[:N] *= 0.1
        rates = reference.rates(0.0, np.concatenate([q, reference.mass(q) @ v]))[2 * N :]
        # p' = M a + M' v
        turning = (reference.mass(q + 1j * STEP * v) @ v).imag / STEP
        a = np.linalg.solve(reference.mass(q), rates - turning)
        rows, last = reference.bodies(q + 1j * STEP * v, v + 1j * STEP * a)
        foot = np.array([q[0], 0.0])
        along, about, scale = FORCE, 0.0, abs(FORCE) + np.abs(reference.k * q).sum()
        top = last[0].real - foot
        about += FORCE * top[1] + 1500.0 * top[0]
        bodies = [*zip(rows, reference.own, reference.inertia, strict=True), (last, 12.0, 0.0)]
        for (place, rate, _, spin), m, inertia in bodies:
            lever, felt = place.real - foot, m * (rate.imag / STEP + [GROUND, 0.0])
            weight = m * column.gravity if m != 12.0 else 0.0  # that of the top mass is in the load
            along -= felt[0]
            about -= felt[0] * lever[1] - felt[1] * lever[0] + inertia * spin.imag / STEP
            about += weight * lever[0]
            scale += np.abs(felt).sum()
        run = start(column, q, v)
        assert run.base_shear[0] == pytest.approx(along, abs=1e-12 * scale)
        assert run.base_moment[0] == pytest.approx(about, abs=1e-11 * scale * HEIGHT)


def test_base_shear_of_a_yielding_column_is_that_of_its_bodies_all_the_way():
    """Accelerations of the bodies are second differences of their recorded positions."""
    flexure = Takeda(k_c=2.5e8, d_c=3e-4, k_y=6.3e7, d_y=2.7e-3, k_u=7.6e6, b1=0.22)
    column = rbsdem.Column(
        1.6, 614.4, Elastic(7e8), [flexure, flexure.split(2)], n=2, axial_load=744e3,
        kinematics="pdelta", top_mass=75e3, damping=rbsdem.Damping(mass=0.5, stiffness=1e-4),
    )  # fmt: skip
    time = np.arange(0.0, 2.0, 0.01)
    motion = 6.0 * np.sin(2 * np.pi * 2.0 * time)
    dt = 5e-5
    run = rbsdem.time_history(
        column, time, ground_acceleration=motion, method="rk4", dt=dt, every=1
    )
    assert np.abs(run.rotation).max() > 2 * flexure.d_y
    turn = np.cumsum(run.rotation, axis=1)
    top = np.cumsum(run.slip + 0.8 * turn, axis=1)
    centre = top - 0.4 * turn
    # The top mass is one more body.
    momentum = centre @ [307.2, 307.2] + 75e3 * top[:, 1]
    ground = np.interp(run.time, time, motion) * (614.4 + 75e3)
    felt = (momentum[2:] - 2 * momentum[1:-1] + momentum[:-2]) / dt**2 + ground[1:-1]
    peak = np.abs(run.base_shear).max()
    np.testing.assert_allclose(run.base_shear[1:-1], -felt, atol=2e-4 * peak)
    assert run.summary["peak_base_shear"] == run.base_shear[np.argmax(np.abs(run.base_shear))]
    # Damping of the bodies against the ground is part of it, so it is not that of the joint.
    assert np.abs(run.base_shear - run.shear[:, 0]).max() > 1e-3 * peak


def test_undamped_rows_carry_nothing_more():
    column = column_of("small", None)
    run = start(column, np.full(2 * N, 0.01), np.zeros(2 * N))
    assert np.shares_memory(run.base_shear, run.shear)
    assert np.shares_memory(run.base_moment, run.moment)


def test_loop_of_a_response_in_time_is_that_of_the_base_shear():
    pytest.importorskip("matplotlib")
    run = start(column_of("small", DAMPINGS["mass"]), np.full(2 * N, 0.01), np.zeros(2 * N))
    ax = rbsdem.plot.loop(run)
    x, y = ax.get_lines()[0].get_data()
    np.testing.assert_array_equal(x, 1e3 * run.displacement)
    np.testing.assert_array_equal(y, 1e-3 * run.base_shear)
    assert ax.get_ylabel() == "Base shear (kN)"
