"""Misprints E1 to E8 of the paper (docs, theory, section 4): the program does the corrected thing.

Beside it stands how far the printed formula is off. That the corrected forms follow from the
kinematics and the energies is proved in `test_column.py` and `test_physics.py`. E9 is a number of
table 3 and stands with the paper's tables.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import eigh

import rbsdem
from rbsdem.springs import Elastic

# Three bodies, nothing equal to anything.
LENGTHS = np.array([0.5, 0.8, 0.3])
MASSES = np.array([200.0, 90.0, 410.0])
N = 3

# Column 1 of table 3 (Soesianawati No 1), mass and length of theory E5.
K_V, K_M, MASS, HEIGHT = 7.0387e8, 2.5428e8, 614.4, 1.6


def chain(**options) -> rbsdem.Column:
    springs = {"shear": Elastic(3.0e6), "flexure": Elastic(2.0e6)} | options
    return rbsdem.Column(LENGTHS.sum(), None, n=N, lengths=LENGTHS, masses=MASSES, **springs)


def mass_of_eq_3(*, body_above: float, second_sum_from_j: bool) -> np.ndarray:
    """[A B; C D] of eq 3 with the elements printed below it; indices count from 0 here.

    `body_above` is the share of its length that l~_ji has for a body i above body j: 1 as printed.
    `second_sum_from_j` tells where the second sum of c_ij and d_ij begins for i < j: at h = j
    (corrected) or at h = i (printed).
    """

    def arm(j: int, i: int) -> float:
        return LENGTHS[i] * (0.5 if i == j else 1.0 if i < j else body_above)

    inertia = MASSES * LENGTHS**2 / 12
    a, b, c, d = (np.zeros((N, N)) for _ in range(4))
    for i, j in np.ndindex(N, N):
        above = range(max(i, j), N)
        a[i, j] = sum(MASSES[k] for k in above)
        b[i, j] = sum(MASSES[k] * arm(k, j) for k in above)
        rows = list(range(i, N))
        if i < j:
            rows = list(range(i, j)) + list(range(j if second_sum_from_j else i, N))
        c[i, j] = sum(MASSES[k] * arm(k, h) for h in rows for k in range(j, N))
        d[i, j] = sum(MASSES[k] * arm(k, h) * arm(k, j) for h in rows for k in range(j, N))
        d[i, j] += inertia[j] * (i <= j)
    return np.block([[a, b], [c, d]])


def test_e2_and_e3_mass_matrix_of_eq_3():
    """A lever arm of a body above the point is zero; the second sum of c and d starts at h = j."""
    found = rbsdem.matrices(chain(), form="paper").mass
    corrected = mass_of_eq_3(body_above=0.0, second_sum_from_j=True)
    np.testing.assert_allclose(found, corrected, rtol=1e-13)
    without_e2 = mass_of_eq_3(body_above=1.0, second_sum_from_j=True)
    without_e3 = mass_of_eq_3(body_above=0.0, second_sum_from_j=False)
    for printed in (without_e2, without_e3):
        assert (printed[:N] == corrected[:N]).all()
        assert np.abs(printed - corrected).max() > 0.1 * np.abs(corrected).max()
    # By E3 bodies count twice, and in relative rotations the matrix is not symmetric.
    surplus = (without_e3 - corrected)[N, 2]
    assert surplus == pytest.approx(MASSES[2] * LENGTHS[:2].sum(), rel=1e-12)
    relative = np.eye(2 * N)
    relative[N:, N:] = np.tril(np.ones((N, N)))
    np.testing.assert_allclose(corrected @ relative, (corrected @ relative).T, rtol=1e-13)
    printed = without_e3 @ relative
    assert np.abs(printed - printed.T).max() > 0.1 * np.abs(printed).max()


def test_e1_e4_and_e5_frequencies_of_one_body():
    """Eq 3 has second derivatives, I is m l^2/12, eq 6 has I below: eigenvalues of eq 5."""
    inertia = MASS * HEIGHT**2 / 12

    def squares(inertia: float) -> np.ndarray:
        off = MASS * HEIGHT / 2
        matrix = [[MASS, off], [off, inertia + MASS * HEIGHT**2 / 4]]
        return eigh(np.diag([K_V, K_M]), matrix, eigvals_only=True)

    def eq_6(factor: float) -> np.ndarray:
        kappa = HEIGHT**2 * K_V / (3 * K_M)
        return factor * (1 + kappa + np.array([-1, 1]) * np.sqrt(1 + kappa + kappa**2))

    column = rbsdem.Column(HEIGHT, MASS, Elastic(K_V), Elastic(K_M))
    found = rbsdem.modes(column).omega ** 2
    for corrected in (squares(inertia), eq_6(K_M / (2 * inertia)), [3.606916e5, 6.161798e6]):
        np.testing.assert_allclose(found, corrected, rtol=2e-7)
    for printed in (squares(inertia * HEIGHT), eq_6(K_M / (2 * HEIGHT))):
        assert (np.abs(printed / found - 1) > 0.05).any()
    # Released in its first mode it swings; by eq 3 as printed it would creep to zero.
    period, shape = 2 * np.pi / np.sqrt(found[0]), rbsdem.modes(column).shapes[:, 0]
    run = rbsdem.time_history(
        column, [0.0, period / 2], initial={"slip": shape[:1], "rotation": shape[1:]},
        dt=period / 1600, method="rk4",
    )  # fmt: skip
    assert run.slip[-1, 0] == pytest.approx(-shape[0], rel=1e-6)


def test_e6_eq_4_has_no_further_term_in_row_2():
    """A free vibration keeps its energy; the work of the printed term is a tenth of it."""
    column = rbsdem.Column(HEIGHT, MASS, Elastic(7e3), Elastic(2.5e3), kinematics="finite")
    times = 1e-3 * np.arange(2001)
    run = rbsdem.time_history(
        column, times, dt=1e-3, initial={"slip": [0.05], "rotation": [0.8]}, method="rk4"
    )
    energy = run.energy["kinetic"] + run.energy["spring"]
    assert np.ptp(energy) < 2e-11 * energy[0]
    theta = run.rotation[:, 0]
    rate = np.gradient(theta, times)
    term = 0.25 * MASS * HEIGHT * rate**2 * np.sin(theta) * np.cos(theta)
    work = np.cumsum(term * rate) * 1e-3
    assert np.ptp(work) > 0.1 * energy[0]


def test_e7_moment_spring_sees_the_relative_rotation():
    """All bodies turned about the ground by 0.01: only joint 1 is deformed."""
    angle, k = 0.01, 2.0e6
    run = rbsdem.time_history(
        chain(), [0.0, 1e-6], initial={"rotation": [angle, 0.0, 0.0]}, method="rk4"
    )
    assert run.moment[0].tolist() == [k * angle, 0.0, 0.0]
    assert run.energy["spring"][0] == pytest.approx(0.5 * k * angle**2, rel=1e-15)
    # Limit N = 3 -> N = 1: top displacement F H^2/k_1, not the printed F H l_1/k_1.
    force, height = 1.0e3, LENGTHS.sum()
    stiff = chain(shear=Elastic(1e18), flexure=[Elastic(k), Elastic(1e12 * k), Elastic(1e12 * k)])
    top = rbsdem.cyclic(stiff, force=[force]).displacement[0]
    assert top == pytest.approx(force * height**2 / k, rel=1e-9)


def test_e8_slips_above_the_joint_belong_to_the_lever_arm():
    """Moments of the joints under an axial load, with the slips above them and without."""
    load, force = 1.0e5, 2.0e3
    column = chain(
        shear=[Elastic(k) for k in (8.0e5, 2.0e6, 4.0e6)],
        flexure=[Elastic(k) for k in (9.0e5, 7.0e5, 2.5e6)], axial_load=load, kinematics="pdelta",
    )  # fmt: skip
    run = rbsdem.cyclic(column, force=[force])
    slip, theta = run.slip[0], np.cumsum(run.rotation[0])
    leaning = [LENGTHS[n:] @ theta[n:] for n in range(N)]
    slips = np.array([slip[n + 1 :].sum() for n in range(N)])
    arms = np.cumsum(LENGTHS[::-1])[::-1]
    printed = force * arms + load * np.array(leaning)
    assert run.moment[0] == pytest.approx(printed + load * slips, rel=1e-12)
    assert (load * slips)[0] > 0.01 * run.moment[0, 0]
    below = np.append(0.0, theta[:-1])
    assert run.shear[0] == pytest.approx(force + load * below, rel=1e-12)
