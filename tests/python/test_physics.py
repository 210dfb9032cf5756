"""Proofs that belong to the physics: energy, momentum, small against exact rotations, buckling.

Exact rotations are held against `reference_chain`, which knows nothing but the energies.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from reference_chain import Chain, Linear, as_initial, deformations
from scipy.optimize import brentq

import rbsdem
from rbsdem.springs import Elastic

pytestmark = pytest.mark.filterwarnings("ignore:the rotation of a body")

# Three bodies, nothing equal to anything, soft enough to swing far.
LENGTHS, MASSES = [0.9, 0.6, 0.7], [50.0, 20.0, 30.0]
K_V, K_M, K_N = [4e4, 3e4, 2e4], [9e3, 7e3, 5e3], [3e5, 2e5, 4e5]


def elastic(values) -> list[Elastic]:
    return [Elastic(float(k)) for k in values]


def soft(*, opens: bool = False, **options) -> rbsdem.Column:
    return rbsdem.Column(
        sum(LENGTHS), None, elastic(K_V), elastic(K_M), n=3, lengths=LENGTHS, masses=MASSES,
        axial_spring=elastic(K_N) if opens else None, **options,
    )  # fmt: skip


def start(*, opens: bool, size: float = 0.4) -> tuple[np.ndarray, np.ndarray]:
    """Deformations and velocities; the middle body leans by more than `size` [rad]."""
    q = size * np.array([0.05, -0.03, 0.04, 0.9, 0.4, -0.7, 0.01, -0.02, 0.01])
    v = size * np.array([0.3, -0.2, 0.1, 2.0, -1.0, 3.0, 0.1, 0.0, -0.2])
    return q[: 9 if opens else 6], v[: 9 if opens else 6]


@pytest.mark.parametrize("opens", [False, True], ids=["closed", "opening"])
def test_finite_chain_against_hamiltons_equations(opens):
    """Weight, top mass, damping, and all four loads at once."""
    column = soft(
        opens=opens, kinematics="finite", axial_load=1e3, self_weight=True, top_mass=40.0,
        top_inertia=2.0, depth=0.3, damping=rbsdem.Damping(0.1, 1e-4),
    )  # fmt: skip
    times = np.linspace(0.0, 0.15, 4)
    loads = [1e4 * times, 30.0 * times - 3.0, 50.0 * times, 500.0 - 5e3 * times]
    q, v = start(opens=opens)
    reference = Chain(column, lambda t: (1e4 * t, 30.0 * t - 3.0, 50.0 * t, 500.0 - 5e3 * t))
    expected = reference.solve(times, q, v)
    for method, tolerance in (("rk45", 1e-8), ("rk4", 1e-7)):
        run = rbsdem.time_history(
            column, times, force=loads[0], ground_acceleration=loads[1], method=method,
            initial=as_initial(q, v, n=3),
            vertical_acceleration=loads[2], axial_load=1e3 + loads[3],
            **({"tolerance": 1e-10} if method == "rk45" else {"dt": 1e-4}),
        )  # fmt: skip
        assert run.summary["peak_rotation"] > 0.4
        np.testing.assert_allclose(deformations(run), expected, atol=tolerance)


@pytest.mark.parametrize(("opens", "load"), [(False, 0.0), (False, 1.5e3), (True, 0.0)])
def test_finite_tends_to_small_rotations_quadratically_for_three_bodies(opens, load):
    """With an axial load the level is pdelta. Openings, which small rotations do not excite, come
    with the square of the amplitude too."""
    times = np.linspace(0.0, 0.5, 51)
    sizes = 0.05 / 2.0 ** np.arange(4)
    apart, opened = [], []
    for size in sizes:
        q, v = start(opens=False, size=size)
        runs = [
            rbsdem.time_history(
                soft(opens=opens, kinematics=level, axial_load=load), times, method="rk45",
                tolerance=1e-11, initial=as_initial(q, v, n=3),
            )
            for level in ("finite", "pdelta" if load else "small")
        ]  # fmt: skip
        far = [np.hstack([run.slip, run.rotation]) for run in runs]
        apart.append(np.max(np.abs(far[0] - far[1])) / np.max(np.abs(far[1])))
        opened.append(np.max(np.abs(runs[0].opening)))
        assert np.all(runs[1].opening == 0.0)
    np.testing.assert_allclose(np.log2(np.divide(apart[:-1], apart[1:])), 2.0, atol=0.1)
    if opens:
        np.testing.assert_allclose(np.log2(np.divide(opened[:-1], opened[1:])), 2.0, atol=0.1)


def floating(**options) -> rbsdem.Column:
    """Three bodies whose joint at the ground is nothing."""
    nothing = Elastic(1e-30)
    return rbsdem.Column(
        sum(LENGTHS), None, [nothing, *elastic(K_V[1:])], [nothing, *elastic(K_M[1:])], n=3,
        lengths=LENGTHS, masses=MASSES, axial_spring=[nothing, *elastic(K_N[1:])], **options,
    )  # fmt: skip


def test_free_flight_of_a_tumbling_chain_keeps_momentum_spin_and_energy():
    """Nothing pushes from outside: the centre of mass goes straight, the spin about it stays."""
    column = floating(kinematics="finite")
    chain = Chain(column)
    q = np.array([0.1, 0.05, -0.03, 0.3, 0.4, -0.5, 0.2, 0.02, -0.01])
    v = np.array([1.0, 0.2, -0.3, 9.0, 4.0, -2.0, 2.0, 0.1, 0.3])
    times = np.arange(0, 6001) * 5e-4
    run = rbsdem.time_history(
        column, times, method="rk45", tolerance=1e-12, initial=as_initial(q, v, n=3)
    )
    assert abs(run.rotation[-1, 0]) > 3 * 2 * np.pi
    rows, _ = chain.bodies(deformations(run), np.zeros(9))
    places = np.array([row[0] for row in rows])  # body, direction, time
    turns = np.array([row[2] for row in rows])
    share = np.array(MASSES) / sum(MASSES)
    centre = np.einsum("b,bdt->dt", share, places)
    straight = np.polynomial.polynomial.polyfit(times, centre.T, 1)
    off = centre - np.polynomial.polynomial.polyval(times, straight)
    assert np.max(np.abs(off)) < 1e-10 * np.max(np.abs(centre))
    # Velocities by central differences of order 8.
    weights = (
        np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280]) / 5e-4
    )

    def rate(values):
        return np.apply_along_axis(lambda row: np.correlate(row, weights, "valid"), -1, values)

    arms = (places - centre)[..., 4:-4]
    speeds = rate(places - centre)
    spin = np.einsum("b,bt->t", MASSES, arms[:, 1] * speeds[:, 0] - arms[:, 0] * speeds[:, 1])
    spin = spin + chain.inertia @ rate(turns)
    assert np.ptp(spin) < 1e-8 * np.max(np.abs(spin))
    whole = run.energy["kinetic"] + run.energy["spring"]
    assert np.ptp(whole) < 1e-9 * whole[0]


def random_chain(n: int, **options) -> rbsdem.Column:
    rng = np.random.default_rng(n)
    lengths = rng.uniform(0.5, 1.5, n)
    return rbsdem.Column(
        lengths.sum(), None, elastic(rng.uniform(1e7, 3e7, n)), elastic(rng.uniform(1e6, 3e6, n)),
        n=n, lengths=lengths, masses=rng.uniform(50, 100, n), **options,
    )  # fmt: skip


def stiffness_left(column: rbsdem.Column, height: float) -> float:
    """Lateral force per displacement of the top, for a displacement that is next to nothing."""
    step = 1e-7 * height
    return float(rbsdem.cyclic(column, displacement=[step]).force[0] / step)


@pytest.mark.parametrize("level", ["pdelta", "finite"])
@pytest.mark.parametrize("n", [1, 2, 3, 10])
def test_critical_load_is_where_the_static_path_loses_its_stiffness(n, level):
    critical = Linear(random_chain(n)).critical_load()

    def left(load):
        return stiffness_left(random_chain(n, kinematics=level, axial_load=load), n)

    tolerance = 1e-11 if level == "pdelta" else 1e-9
    root = brentq(left, 0.9 * critical, 1.1 * critical, xtol=1e-14 * critical, rtol=1e-14)
    assert root == pytest.approx(critical, rel=tolerance)
    # Both analyses name it in their errors, with six digits.
    above = random_chain(n, kinematics=level, axial_load=1.001 * critical)
    with pytest.raises(rbsdem.InputError, match="buckles by itself") as caught:
        rbsdem.time_history(above, [0.0, 1.0], force=[0.0, 0.0], method="rk4")
    told = float(re.search(r"critical load of ([-+.e\d]+) N", str(caught.value)).group(1))
    assert told == pytest.approx(critical, rel=1e-5)
    with pytest.raises(rbsdem.SolveError, match="buckles by itself") as caught:
        rbsdem.cyclic(above, force=[1.0])
    told = float(re.search(r"is ([.e\d]+) times the critical", str(caught.value)).group(1))
    assert told == pytest.approx(1.001, rel=1e-5)
    below = random_chain(n, kinematics=level, axial_load=0.999 * critical)
    assert rbsdem.cyclic(below, force=[1e-6]).displacement[0] > 0.0
    assert rbsdem.modes(below).omega[0] > 0.0
