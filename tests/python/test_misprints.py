"""Misprints E1 to E8 of the paper (docs, theory, section 4): printed beside corrected form.

Each test writes the printed formula down, shows that it cannot be (against eqs 1 and 2, against
virtual work, by units, by energy), and shows that the program does the corrected thing. E9 is a
number of table 3 and stands with the paper's tables.
"""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp
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
    return rbsdem.Column(
        LENGTHS.sum(),
        None,
        options.pop("shear", Elastic(3.0e6)),
        options.pop("flexure", Elastic(2.0e6)),
        n=N,
        lengths=LENGTHS,
        masses=MASSES,
        **options,
    )


def close(a, b, rel: float = 1e-13) -> bool:
    """Whether two arrays agree, relative to the largest value."""
    return bool(np.max(np.abs(np.asarray(a) - b)) <= rel * np.max(np.abs(b)))


def mass_of_eqs_1_and_2() -> np.ndarray:
    """Accelerations of one unknown at a time put into eqs 1 and 2 as they stand (E4 corrected).

    Every l~_ji there has j >= i, so the two cases that are printed suffice. That eqs 1 and 2 are
    those of the kinematics is proved with the mass matrix in `test_column.py`.
    """
    inertia = MASSES * LENGTHS**2 / 12
    matrix = np.zeros((2 * N, 2 * N))
    for column in range(2 * N):
        unit = np.eye(2 * N)[column]
        u, theta = unit[:N], unit[N:]

        def force(i, u=u, theta=theta):
            return MASSES[i] * sum(printed_arm(i, j) * theta[j] + u[j] for j in range(i + 1))

        for n in range(N):
            matrix[n, column] = sum(force(i) for i in range(n, N))
            matrix[N + n, column] = sum(
                inertia[i] * theta[i] + sum(printed_arm(j, i) * force(j) for j in range(i, N))
                for i in range(n, N)
            )
    return matrix


def printed_arm(j: int, i: int) -> float:
    """l~_ji as printed after eq 2: two cases."""
    return LENGTHS[i] / 2 if i == j else LENGTHS[i]


def corrected_arm(j: int, i: int) -> float:
    """l~_ji with the missing case: a body i above body j does not turn it."""
    return printed_arm(j, i) if i <= j else 0.0


def mass_of_eq_3(arm, second_sum_from_j: bool, inertia=None) -> np.ndarray:
    """[A B; C D] of eq 3 with the elements printed below it; indices count from 0 here.

    `second_sum_from_j` tells where the second sum of c_ij and d_ij begins for i < j: at h = j
    (corrected) or at h = i (printed).
    """
    if inertia is None:
        inertia = MASSES * LENGTHS**2 / 12
    a, b, c, d = (np.zeros((N, N)) for _ in range(4))
    for i in range(N):
        for j in range(N):
            start = max(i, j)
            a[i, j] = sum(MASSES[k] for k in range(start, N))
            b[i, j] = sum(MASSES[k] * arm(k, j) for k in range(start, N))
            rows = list(range(i, N))
            if i < j:
                rows = list(range(i, j)) + list(range(j if second_sum_from_j else i, N))
            c[i, j] = sum(MASSES[k] * arm(k, h) for h in rows for k in range(j, N))
            d[i, j] = sum(MASSES[k] * arm(k, h) * arm(k, j) for h in rows for k in range(j, N))
            if i <= j:
                d[i, j] += inertia[j]
    return np.block([[a, b], [c, d]])


def to_relative(matrix: np.ndarray) -> np.ndarray:
    """Columns from absolute to relative rotations: theta = cumulative sum of phi."""
    transform = np.eye(2 * N)
    transform[N:, N:] = np.tril(np.ones((N, N)))
    return matrix @ transform


def test_e2_lever_arm_of_a_body_above_the_point_is_zero():
    reference = mass_of_eqs_1_and_2()
    with_e2_only = mass_of_eq_3(printed_arm, second_sum_from_j=True)
    # A and B know no arm of a body above, C and D do: printed, they take whole lengths too many.
    assert close(with_e2_only[:N], reference[:N])
    assert not close(with_e2_only[N:], reference[N:], rel=0.1)
    surplus = with_e2_only[N, 0] - reference[N, 0]
    by_hand = sum(MASSES[k] * LENGTHS[h] for h in range(N) for k in range(h))
    assert surplus == pytest.approx(by_hand, rel=1e-13)

    corrected = mass_of_eq_3(corrected_arm, second_sum_from_j=True)
    assert close(corrected, reference)
    assert close(rbsdem.matrices(chain(), form="paper").mass, corrected)


def test_e3_second_sum_of_c_and_d_starts_at_h_equal_j():
    reference = mass_of_eqs_1_and_2()
    with_e3_only = mass_of_eq_3(corrected_arm, second_sum_from_j=False)
    below = np.tril(np.ones((N, N), dtype=bool))
    lower = np.block([[below, below], [below, below]])
    # Only rows i < j of C and D count bodies twice.
    assert close(with_e3_only[lower], reference[lower])
    assert close(with_e3_only[:N], reference[:N])
    for i in range(N):
        for j in range(i + 1, N):
            twice = sum(MASSES[k] * LENGTHS[h] for h in range(i, j) for k in range(j, N))
            surplus = with_e3_only[N + i, j] - reference[N + i, j]
            assert surplus == pytest.approx(twice, rel=1e-12)

    # "Not symmetric in (u, phi)": kinetic energy needs a symmetric matrix.
    printed = to_relative(with_e3_only)
    assert np.max(np.abs(printed - printed.T)) > 0.1 * np.max(np.abs(printed))
    corrected = to_relative(mass_of_eq_3(corrected_arm, second_sum_from_j=True))
    assert close(corrected, corrected.T)
    assert close(rbsdem.matrices(chain()).mass, corrected)


def test_e1_eq_3_has_second_derivatives():
    """A released column swings: it passes zero and comes back. Eq 3 as printed only creeps to zero.

    Printed, M q' + K q = 0 has the solutions q = exp(-lambda t) x with real lambda = omega^2 > 0;
    no component in a mode ever changes its sign. Corrected, mode 1 released from rest is
    cos(omega t): -1 at half a period, +1 after a whole one.
    """
    column = chain()
    mass = rbsdem.matrices(column).mass
    stiffness = np.diag([3.0e6] * N + [2.0e6] * N)
    squares, shapes = eigh(stiffness, mass)
    assert np.all(squares > 0)
    period = 2 * np.pi / np.sqrt(squares[0])
    shape = shapes[:, 0]
    times = np.linspace(0.0, 1.0, 9) * period

    printed = np.exp(-squares[0] * times)
    assert np.all(printed > 0)
    assert np.all(np.diff(printed) < 0)

    run = rbsdem.time_history(
        column,
        times,
        initial={"slip": shape[:N], "rotation": shape[N:]},
        dt=period / 8 / 200,
        method="rk4",
    )
    mode = np.hstack([run.slip, run.rotation]) @ mass @ shape
    assert np.max(np.abs(mode - np.cos(2 * np.pi * times / period))) < 1e-6


def square_frequencies(mass, length, k_v, k_m, power) -> np.ndarray:
    """Eigenvalues of eq 5 with I = m l^power / 12."""
    inertia = mass * length**power / 12
    matrix = np.array(
        [[mass, mass * length / 2], [mass * length / 2, inertia + mass * length**2 / 4]]
    )
    return eigh(np.diag([k_v, k_m]), matrix, eigvals_only=True)


@pytest.mark.filterwarnings("ignore:column. height ")
def test_e4_rotary_inertia_has_length_squared():
    """A frequency does not depend on the units: kg, m, N against t, mm, N."""
    si = (MASS, HEIGHT, K_V, K_M)
    mm = (MASS * 1e-3, HEIGHT * 1e3, K_V * 1e-3, K_M * 1e3)

    printed = square_frequencies(*si, power=3), square_frequencies(*mm, power=3)
    assert not np.allclose(*printed, rtol=0.1)

    corrected = square_frequencies(*si, power=2), square_frequencies(*mm, power=2)
    np.testing.assert_allclose(*corrected, rtol=1e-12)
    for (mass, length, k_v, k_m), expected in zip((si, mm), corrected, strict=True):
        column = rbsdem.Column(length, mass, Elastic(k_v), Elastic(k_m))
        np.testing.assert_allclose(rbsdem.modes(column).omega ** 2, expected, rtol=1e-12)


def test_e4_rotary_inertia_is_that_of_a_slender_rod():
    """Integral of rho x^2 over the rod about its end: m l^2/3, the program's M_22 for N = 1."""
    points, weights = np.polynomial.legendre.leggauss(3)
    x = HEIGHT / 2 * (points + 1)
    about_the_joint = np.sum(weights * HEIGHT / 2 * (MASS / HEIGHT) * x**2)
    column = rbsdem.Column(HEIGHT, MASS, Elastic(K_V), Elastic(K_M))
    for form in ("symmetric", "paper"):
        assert rbsdem.matrices(column, form).mass[1, 1] == pytest.approx(about_the_joint, rel=1e-14)
    printed = MASS * HEIGHT**3 / 12 + MASS * HEIGHT**2 / 4
    assert abs(printed / about_the_joint - 1) > 0.1


def eq_6(factor: float) -> np.ndarray:
    """Both roots of eq 6 with the factor in front."""
    kappa = HEIGHT**2 * K_V / (3 * K_M)
    root = np.sqrt(1 + kappa + kappa**2)
    return factor * np.array([1 + kappa - root, 1 + kappa + root])


def test_e5_eq_6_has_the_rotary_inertia_below():
    inertia = MASS * HEIGHT**2 / 12
    expected = square_frequencies(MASS, HEIGHT, K_V, K_M, power=2)
    np.testing.assert_allclose(expected, [3.606916e5, 6.161798e6], rtol=2e-7)

    printed = eq_6(K_M / (2 * HEIGHT))
    assert np.all(printed > 10 * expected)
    corrected = eq_6(K_M / (2 * inertia))
    np.testing.assert_allclose(corrected, expected, rtol=1e-12)
    np.testing.assert_allclose(corrected, eq_6(6 * K_M / (MASS * HEIGHT**2)), rtol=1e-15)

    column = rbsdem.Column(HEIGHT, MASS, Elastic(K_V), Elastic(K_M))
    modes = rbsdem.modes(column)
    np.testing.assert_allclose(modes.omega**2, corrected, rtol=1e-12)
    np.testing.assert_allclose(modes.frequency, [95.585, 395.070], atol=5e-4)


E6_K_V, E6_K_M = 7e3, 2.5e3


def e6_energy(u, theta, du, dtheta):
    about_joint = MASS * HEIGHT**2 / 3
    return (
        0.5 * MASS * du**2
        + 0.5 * about_joint * dtheta**2
        + 0.5 * MASS * HEIGHT * np.cos(theta) * du * dtheta
        + 0.5 * E6_K_V * u**2
        + 0.5 * E6_K_M * theta**2
    )


def e6_motion(printed: bool, duration: float, dt: float) -> np.ndarray:
    """Free vibration by eq 4 from u = 0.05, theta = 0.8.

    Rows (u, theta, u', theta', work of the printed term).
    """
    about_joint = MASS * HEIGHT**2 / 3

    def rates(t, y):
        u, theta, du, dtheta, _ = y
        sine, cosine = np.sin(theta), np.cos(theta)
        coupling = 0.5 * MASS * HEIGHT * cosine
        term = 0.25 * MASS * HEIGHT * dtheta**2 * sine * cosine if printed else 0.0
        force = -E6_K_V * u + 0.5 * MASS * HEIGHT * dtheta**2 * sine
        moment = -E6_K_M * theta + term
        determinant = MASS * about_joint - coupling**2
        slip = (about_joint * force - coupling * moment) / determinant
        turn = (MASS * moment - coupling * force) / determinant
        return [du, dtheta, slip, turn, term * dtheta]

    times = np.linspace(0.0, duration, round(duration / dt) + 1)
    start = [0.05, 0.8, 0.0, 0.0, 0.0]
    return solve_ivp(rates, (0.0, duration), start, "DOP853", times, rtol=1e-13, atol=1e-14).y.T


def test_e6_eq_4_has_no_further_term_in_row_2():
    duration, dt = 2.0, 1e-3
    printed = e6_motion(True, duration, dt)
    energy = e6_energy(*printed[:, :4].T)
    # 18 % between the highest and the lowest value, all of it the work of the term.
    assert round(np.ptp(energy) / energy[0], 2) == 0.18
    np.testing.assert_allclose(energy - energy[0], printed[:, 4], atol=1e-9 * energy[0])

    corrected = e6_motion(False, duration, dt)
    energy = e6_energy(*corrected[:, :4].T)
    assert np.ptp(energy) < 2e-11 * energy[0]

    column = rbsdem.Column(HEIGHT, MASS, Elastic(E6_K_V), Elastic(E6_K_M), kinematics="finite")
    times = dt * np.arange(round(duration / dt) + 1)
    run = rbsdem.time_history(
        column, times, dt=dt, initial={"slip": [0.05], "rotation": [0.8]}, method="rk4"
    )
    total = run.energy["kinetic"] + run.energy["spring"]
    assert np.ptp(total) < 2e-11 * total[0]
    np.testing.assert_allclose(np.ravel(run.slip), corrected[:, 0], atol=1e-11)
    np.testing.assert_allclose(np.ravel(run.rotation), corrected[:, 1], atol=1e-11)
    assert np.max(np.abs(np.ravel(run.rotation) - printed[:, 1])) > 0.05


def test_e7_moment_spring_sees_the_relative_rotation():
    """All bodies turned about the ground by 0.01: only joint 1 is deformed."""
    angle, k = 0.01, 2.0e6
    column = chain(flexure=Elastic(k))
    run = rbsdem.time_history(
        column, [0.0, 1e-6], initial={"rotation": [angle, 0.0, 0.0]}, method="rk4"
    )
    theta = np.cumsum(run.rotation[0])
    np.testing.assert_allclose(theta, angle)

    printed = k * theta  # f_M(theta_i): the upper joints resist a rigid rotation
    assert 0.5 * np.sum(printed * theta) == pytest.approx(3 * 0.5 * k * angle**2)
    assert run.moment[0].tolist() == [k * angle, 0.0, 0.0]
    assert run.energy["spring"][0] == pytest.approx(0.5 * k * angle**2, rel=1e-15)


def test_e7_stiff_upper_joints_make_one_body_of_the_column():
    """Limit N = 3 -> N = 1: top displacement F H^2/k_1, not the printed F H l_1/k_1."""
    k, force, height = 2.0e6, 1.0e3, LENGTHS.sum()
    flexure = [Elastic(k), Elastic(1e12 * k), Elastic(1e12 * k)]
    column = chain(shear=Elastic(1e18), flexure=flexure)
    top = rbsdem.cyclic(column, force=[force]).displacement[0]
    stiffness = np.array([spring.k for spring in flexure])
    above = height - np.concatenate([[0.0], np.cumsum(LENGTHS)[:-1]])
    printed = np.sum(LENGTHS * (force * above / stiffness))
    assert printed == pytest.approx(force * height * LENGTHS[0] / k, rel=1e-9)
    assert top == pytest.approx(force * height**2 / k, rel=1e-9)


def top_height(q: np.ndarray) -> float:
    """Height of the top, exact: slip i along the normal of body i - 1, bodies along their axes."""
    slip, theta = q[:N], np.cumsum(q[N:])
    below = np.concatenate([[0.0], theta[:-1]])
    return float(np.sum(LENGTHS * np.cos(theta)) - np.sum(slip * np.sin(below)))


def hessian(function, size: int, step: float = 0.02) -> np.ndarray:
    """Second derivatives at zero by central differences, extrapolated to order 4."""

    def differences(h):
        unit = h * np.eye(size)
        return np.array(
            [
                [
                    function(a + b) - function(a - b) - function(b - a) + function(-a - b)
                    for b in unit
                ]
                for a in unit
            ]
        ) / (4 * h**2)

    return (4 * differences(step / 2) - differences(step)) / 3


def axial_rows(u: np.ndarray, theta: np.ndarray, load: float, slips_count: bool) -> np.ndarray:
    """Right-hand sides of eqs 1 and 2 of the axial load alone, P_y = -load."""
    shear = load * np.concatenate([[0.0], theta[:-1]])
    moment = [load * np.sum(LENGTHS[n:] * theta[n:]) for n in range(N)]
    if slips_count:
        moment = [moment[n] + load * np.sum(u[n + 1 :]) for n in range(N)]
    return np.concatenate([shear, moment])


def test_e8_slips_above_the_joint_belong_to_the_lever_arm():
    load, force = 1.0e5, 2.0e3
    shear, flexure = np.array([8.0e5, 2.0e6, 4.0e6]), np.array([9.0e5, 7.0e5, 2.5e6])
    column = chain(
        shear=[Elastic(k) for k in shear],
        flexure=[Elastic(k) for k in flexure],
        axial_load=load,
        kinematics="pdelta",
    )
    arm = np.concatenate([np.ones(N), np.cumsum(LENGTHS[::-1])[::-1]])

    # The potential of the load decides: P times the height of the top, to second order.
    geometric = load * hessian(top_height, 2 * N)
    q = np.linalg.solve(np.diag(np.concatenate([shear, flexure])) + geometric, force * arm)
    u, theta = q[:N], np.cumsum(q[N:])
    corrected = axial_rows(u, theta, load, slips_count=True)
    printed = axial_rows(u, theta, load, slips_count=False)
    np.testing.assert_allclose(corrected, -geometric @ q, atol=1e-6 * np.max(corrected))
    assert np.max(np.abs(printed + geometric @ q)) > 0.02 * np.max(corrected)

    run = rbsdem.cyclic(column, force=[force])
    np.testing.assert_allclose(np.concatenate([run.slip[0], run.rotation[0]]), q, rtol=1e-6)
    u, theta = run.slip[0], np.cumsum(run.rotation[0])
    springs = np.concatenate([run.shear[0], run.moment[0]])
    balance = force * arm + axial_rows(u, theta, load, slips_count=True) - springs
    assert np.max(np.abs(balance)) < 1e-12 * np.max(np.abs(springs))
    balance = force * arm + axial_rows(u, theta, load, slips_count=False) - springs
    assert np.max(np.abs(balance)) > 0.02 * np.max(corrected)
