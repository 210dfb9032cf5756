"""The implicit methods: energy, stiff chains, contact, steps of any length, steps that fail.

Single steps are held against the literature in `test_invariants.py`, orders in `test_events.py`.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from reference_chain import chain, deformations

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Takeda

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")

METHODS = [("newmark", 1.0), ("hht", 0.5), ("hht", 0.9)]
METHODS += [("generalised_alpha", radius) for radius in (1.0, 0.8, 0.5, 0.0)]
SHEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
FLEXURE = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22, inner="one")


def run(column: rbsdem.Column, time, method=("newmark", 1.0), **given) -> rbsdem.Result:
    radius = {} if method[0] == "newmark" else {"rho_infinity": method[1]}
    return rbsdem.time_history(column, time, method=method[0], **radius, **given)


def bodies(n: int, **more) -> rbsdem.Column:
    """Return elastic bodies, none like another, 2 m high."""
    i = np.arange(1, n + 1)
    lengths = 1 + 0.3 * np.sin(i)
    shear, flexure = 4e8 + 1e8 * np.sin(3 * i), 2e8 + 5e7 * np.cos(i)
    masses = 80 + 30 * np.cos(2 * i)
    return chain(2 * lengths / lengths.sum(), masses, shear, flexure, **more)


@pytest.mark.parametrize("damped", [False, True])
@pytest.mark.parametrize("opens", [False, True])
@pytest.mark.parametrize("n", [1, 3, 20, 100])
@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
def test_average_acceleration_balances_the_energy(kinematics, n, opens, damped):
    """Work by the trapezoidal rule is exact: of elastic chains, with exact rotations of all."""
    finite = kinematics == "finite"
    column = bodies(
        n, kinematics=kinematics, axial_load=1e5, self_weight=True, top_mass=500.0,
        damping=rbsdem.Damping(mass=3.0, stiffness=1e-4) if damped else None,
        axial_spring=Elastic(2e9) if opens else None,
    )  # fmt: skip
    if finite:
        shear, flexure = (
            [Bilinear(one.k, 2e-3 / n, one.k / 20) for one in column.joints(name)]
            for name in ("shear", "flexure")
        )
        column = replace(column, shear=shear, flexure=flexure)
    time = 0.03 * np.arange(31) / 30
    v = np.random.default_rng(n).uniform(-1, 1, (3, n))
    loads = {"force": 4e5 * np.sin(200 * time), "ground_acceleration": 50 * np.sin(170 * time)}
    if finite:
        loads |= {"vertical_acceleration": 50 * time, "axial_load": 1e5 * np.cos(99 * time)}
        v[1, 0] = 10.0
    start = {"slip_velocity": v[0], "rotation_velocity": v[1]}
    start |= {"opening_velocity": v[2]} if opens else {}
    found = run(column, time, dt=1e-3, initial=start, **loads)
    assert found.summary["relative_energy_residual"] < (1e-10 if finite else 1e-11)
    assert finite or found.summary["cut_steps"] == 0
    assert not finite or found.summary["events"] > 0


@pytest.mark.parametrize("n", [200, 1000])
def test_many_springs_that_change_their_lines_in_one_step(n):
    """The flexibility of one joint over all: hardly a step is cut."""
    column = rbsdem.Column(
        1.6, 614.4, Elastic(SHEAR.k * n), FLEXURE.split(n), n=n, axial_load=5e5, top_mass=2e4,
        kinematics="pdelta", damping=rbsdem.Damping(stiffness=1e-3),
    )  # fmt: skip
    ground = [0.0, 20.0, -25.0, 20.0, -15.0, 10.0]
    found = run(
        column, 0.1 * np.arange(6), ("generalised_alpha", 0.8), ground_acceleration=ground, dt=5e-3
    )
    assert found.summary["events"] > n
    assert found.summary["cut_steps"] <= 2
    assert found.summary["energy_residual"] < 0.05 * found.energy["damping"][-1]


@pytest.mark.parametrize(("method", "near"), [(METHODS[0], 1e-11), (METHODS[4], 0.05)])
def test_stiff_bodies_with_exact_rotations_and_long_steps(method, near):
    """A hundred bodies that yield, steps many times their shortest period: none is cut."""
    n = 100
    column = rbsdem.Column(
        2.0, 8e3, Elastic(1e9 * n), Bilinear(2e7, 0.01, 1e6).split(n), n=n, kinematics="finite",
        axial_load=2e5, top_mass=2e4,
    )  # fmt: skip
    found = run(
        column, [0.0, 0.2, 0.6, 1.0], method, ground_acceleration=[0.0, 8.0, -9.0, 5.0], dt=5e-3
    )
    assert found.summary["cut_steps"] == 0
    assert found.summary["events"] > n
    assert found.summary["energy_residual"] < near * found.energy["spring"][-1]


@pytest.mark.parametrize("method", METHODS)
def test_a_chain_of_contacts_falls_onto_its_base(method):
    """Twenty loose blocks; with damping of high frequencies each comes to rest under its weight."""
    column = bodies(
        20, axial_spring=Compression(1e9), self_weight=True, damping=rbsdem.Damping(stiffness=1e-4)
    )
    found = run(column, [0.0, 1.0, 2.0], method, initial={"opening": [0.01] * 20}, dt=2e-3, every=1)
    assert np.abs(found.opening).max() < 1
    if method[1] in (0.8, 0.5) and method[0] != "hht":
        above = 9.80665 * np.cumsum(column.masses[::-1])[::-1]
        np.testing.assert_allclose(found.opening[-1], -above / 1e9, atol=1e-7)


def test_steps_of_all_lengths_in_any_order():
    """They differ by four orders of magnitude; each spring stays on its rule."""
    column = rbsdem.Column(1.6, 614.4, SHEAR, FLEXURE, n=3, kinematics="pdelta", axial_load=2e6)
    rng = np.random.default_rng(1)
    for trial in range(20):
        time = np.append(0.0, np.cumsum(10 ** rng.uniform(-8, -4, 400)))
        speed = rng.uniform(-5, 5, (2, 3)) * [[0.1], [1.0]]
        start = {"slip_velocity": speed[0], "rotation_velocity": speed[1]}
        found = run(column, time, METHODS[trial % len(METHODS)], initial=start, every=1)
        assert np.abs(deformations(found)).max() < 1
        assert found.summary["cut_steps"] == 0
        for i, spring in enumerate(column.joints("flexure")):
            force = spring.response(found.rotation[:, i])
            np.testing.assert_allclose(found.moment[:, i], force, atol=1e-9 * abs(force).max())


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("n", [1, 3, 20])
def test_very_short_steps_from_a_velocity_alone(n, method):
    """There are no forces at the start: only the velocity shows the size of round-off."""
    for h in (1e-4, 1e-5, 1e-6, 1e-7, 1e-8):
        start = {"rotation_velocity": [-0.5] + [0.0] * (n - 1)}
        found = run(bodies(n), h * np.arange(6), method, initial=start, dt=h)
        assert found.summary["cut_steps"] == 0
        if h < 2e-7:
            assert found.rotation[-1, 0] == pytest.approx(-2.5 * h, rel=1e-2)
            assert found.summary["energy_residual"] < 1e-2 * found.energy["kinetic"][0]
