"""Response in time: exact linear solutions, observed order, energy, nonlinear references, steps.

The linear references are built here: mass from positions of centroids, geometric stiffness by hand
(theory, section 3), time by the matrix exponential, which is exact for loads that are linear
between their points, and by the steady state of a harmonic force.
"""

from __future__ import annotations

import itertools
import re
import sys
import threading
import time as clock
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

import rbsdem
from rbsdem import _core
from rbsdem.springs import Bilinear, Elastic, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

SHEAR = Bilinear(7.0387e8, 1.2960e-4, 8.3185e6)
FLEXURE = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
HEIGHT, MASS = 1.6, 614.4

# Three bodies, nothing equal to anything; their highest frequency is 12 times the lowest.
LENGTHS, MASSES = [0.9, 0.6, 0.7], [500.0, 200.0, 300.0]
K_V, K_M = [4.0e6, 3.0e6, 2.0e6], [9.0e6, 7.0e6, 5.0e6]


def elastic(values) -> list[Elastic]:
    return [Elastic(k) for k in values]


def linear_column(n: int, **options) -> rbsdem.Column:
    return rbsdem.Column(
        float(np.sum(LENGTHS[:n])), None, elastic(K_V[:n]), elastic(K_M[:n]), n=n,
        lengths=LENGTHS[:n], masses=MASSES[:n], **options,
    )  # fmt: skip


class Exact:
    """The linear column as z' = A z + B_F F + B_g a_g with z = (q, q'), built by hand."""

    def __init__(self, column: rbsdem.Column) -> None:
        n, lengths = column.n, np.asarray(column.lengths)
        masses = np.asarray(column.masses)
        joint = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
        below = np.tril(np.ones((n, n)))
        centroids = np.hstack([below, below * (joint[:, None] + lengths[:, None] / 2 - joint)])
        rotations = np.hstack([np.zeros((n, n)), below])
        inertia = masses * lengths**2 / 12
        self.mass = centroids.T * masses @ centroids + rotations.T * inertia @ rotations
        self.springs = np.array([s.k for s in (*column.joints("shear"), *column.joints("flexure"))])
        given = column.damping or rbsdem.Damping()
        self.damping = given.mass * self.mass + given.stiffness * np.diag(self.springs)
        self.stiffness = np.diag(self.springs)
        if column.kinematics != "small":
            slip_below = np.vstack([np.zeros(2 * n), rotations[:-1]])
            for k in range(n):
                coupling = np.outer(np.eye(2 * n)[k], slip_below[k])
                second = lengths[k] * np.outer(rotations[k], rotations[k]) + coupling + coupling.T
                self.stiffness = self.stiffness - column.axial_load * second
        self.arm = np.concatenate([np.ones(n), lengths.sum() - joint])
        self.ground = centroids.T @ masses
        solved = np.linalg.solve(
            self.mass,
            np.column_stack([-self.stiffness, -self.damping, self.arm, -self.ground]),
        )
        size = 2 * n
        self.size = size
        self.matrix = np.block(
            [[np.zeros((size, size)), np.eye(size)], [solved[:, :size], solved[:, size : 2 * size]]]
        )
        self.load = np.vstack([np.zeros((size, 2)), solved[:, 2 * size :]])

    def omega_max(self) -> float:
        return float(np.max(np.abs(np.linalg.eigvals(self.matrix))))

    def free(self, times, start) -> np.ndarray:
        """Rows (q, q') from the state `start` at time 0, by eigenvectors."""
        values, vectors = np.linalg.eig(self.matrix)
        part = np.linalg.solve(vectors, np.asarray(start, dtype=complex))
        return (np.exp(np.outer(times, values)) * part @ vectors.T).real

    def piecewise(self, spacing, loads, start) -> np.ndarray:
        """Rows (q, q') at the points of loads (m, 2), which are linear between them. Exact."""
        whole = self.matrix.shape[0]
        block = np.zeros((whole + 4, whole + 4))
        block[:whole, :whole] = self.matrix
        block[:whole, whole : whole + 2] = self.load
        block[whole : whole + 2, whole + 2 :] = np.eye(2) / spacing
        transition = expm(block * spacing)
        rows = [np.asarray(start, dtype=float)]
        for now, then in itertools.pairwise(loads):
            rows.append(transition[:whole] @ np.concatenate([rows[-1], now, then - now]))
        return np.array(rows)

    def harmonic(self, times, amplitude, frequency) -> np.ndarray:
        """Rows (q, q') from rest under amplitude sin(frequency t): steady state + transient."""
        dynamic = self.stiffness - frequency**2 * self.mass + 1j * frequency * self.damping
        shape = np.linalg.solve(dynamic, self.arm * amplitude)

        def steady(t):
            turn = np.exp(1j * frequency * np.asarray(t))[:, None]
            return np.hstack([(turn * shape).imag, (1j * frequency * turn * shape).imag])

        return steady(times) + self.free(times, -steady([0.0])[0])

    def distance(self, run: rbsdem.Result, rows: np.ndarray) -> float:
        """Largest distance of the deformations, in the measure of their energy, relative."""
        q = np.hstack([run.slip, run.rotation])
        expected = rows[:, : self.size]
        wrong = np.sqrt(np.sum(self.springs * (q - expected) ** 2, axis=1))
        return np.max(wrong) / np.max(np.sqrt(np.sum(self.springs * expected**2, axis=1)))


def orders(errors) -> np.ndarray:
    """Observed orders between runs with halved steps."""
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


def initial_state(exact: Exact, seed: int = 0) -> np.ndarray:
    """Random deformations and velocities in which every mode has energy."""
    rng = np.random.default_rng(seed)
    values, vectors = np.linalg.eig(exact.matrix)
    return (vectors @ (rng.uniform(0.5, 1, len(values)) / np.abs(values))).real * 1e-2


def as_initial(state: np.ndarray) -> dict[str, np.ndarray]:
    names = ("slip", "rotation", "slip_velocity", "rotation_velocity")
    return dict(zip(names, np.split(state, 4), strict=True))


# ---- linear: order 4 -----------------------------------------------------------------------------

DAMPINGS = {
    "none": {},
    "mass": {"damping": rbsdem.Damping(1.5)},
    "stiffness": {"damping": rbsdem.Damping(stiffness=2e-5)},
    "both": {"damping": rbsdem.Damping(0.7, 1e-5)},
}


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize(
    ("kinematics", "load"), [("small", 3e5), ("pdelta", 3e5), ("pdelta", -6e5)]
)
def test_free_vibration_has_order_4(n, damping, kinematics, load):
    column = linear_column(n, kinematics=kinematics, axial_load=load, **DAMPINGS[damping])
    exact = Exact(column)
    start = initial_state(exact)
    omega = exact.omega_max()
    steps = 200 * 2 ** np.arange(4)
    duration = 200 * 0.2 / omega
    errors = []
    for count in steps:
        times = np.linspace(0.0, duration, count + 1)
        run = rbsdem.time_history(
            column, times, dt=duration / count, initial=as_initial(start), method="rk4"
        )
        assert run.summary["steps"] == count
        errors.append(exact.distance(run, exact.free(times, start)))
    assert np.all(np.abs(orders(errors) - 4) < 0.05), orders(errors)


def random_loads(seed: int, points: int) -> np.ndarray:
    """Force [N] and acceleration of the ground [m/s2] at `points` times."""
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (points, 2)) * [5e4, 8.0]


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize("load", ["force", "ground_acceleration", "both"])
def test_piecewise_linear_load_has_order_4(n, damping, load):
    """Steps that divide the intervals meet every corner of the load."""
    column = linear_column(n, **DAMPINGS[damping])
    exact = Exact(column)
    points, spacing = 41, 1.6 / exact.omega_max()
    loads = random_loads(n, points)
    if load == "force":
        loads[:, 1] = 0.0
    elif load == "ground_acceleration":
        loads[:, 0] = 0.0
    times = spacing * np.arange(points)
    expected = exact.piecewise(spacing, loads, np.zeros(2 * exact.size))
    errors = []
    for parts in (32, 64, 128):
        run = rbsdem.time_history(
            column,
            times,
            force=None if load == "ground_acceleration" else loads[:, 0],
            ground_acceleration=None if load == "force" else loads[:, 1],
            dt=spacing / parts,
            method="rk4",
        )
        assert run.summary["steps"] == parts * (points - 1)
        assert np.array_equal(run.time, times)
        errors.append(exact.distance(run, expected))
    assert np.all(np.abs(orders(errors) - 4) < 0.05), orders(errors)


def test_force_and_ground_motion_superpose():
    column = linear_column(3, **DAMPINGS["both"])
    loads = random_loads(4, 60)
    times = 2e-3 * np.arange(60)
    options = {"dt": 1e-4, "method": "rk4"}
    force = rbsdem.time_history(column, times, force=loads[:, 0], **options)
    ground = rbsdem.time_history(column, times, ground_acceleration=loads[:, 1], **options)
    both = rbsdem.time_history(
        column, times, force=loads[:, 0], ground_acceleration=loads[:, 1], **options
    )
    for name in ("displacement", "slip", "rotation", "shear", "moment"):
        total = getattr(force, name) + getattr(ground, name)
        assert np.max(np.abs(getattr(both, name) - total)) < 1e-12 * np.max(np.abs(total))


def test_rows_of_a_linear_run_agree_with_each_other():
    column = linear_column(3)
    loads = random_loads(5, 60)
    times = 2e-3 * np.arange(60)
    run = rbsdem.time_history(column, times, force=loads[:, 0], dt=1e-4, method="rk4")
    np.testing.assert_allclose(run.force, loads[:, 0], rtol=1e-12)
    theta = np.cumsum(run.rotation, axis=1)
    top = run.slip.sum(axis=1) + theta @ np.array(LENGTHS)
    np.testing.assert_allclose(run.displacement, top, rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(run.shear, run.slip * K_V, rtol=1e-13, atol=1e-9)
    np.testing.assert_allclose(run.moment, run.rotation * K_M, rtol=1e-13, atol=1e-9)
    energy = 0.5 * (run.slip**2 @ K_V + run.rotation**2 @ K_M)
    np.testing.assert_allclose(run.energy["spring"], energy, rtol=1e-10, atol=1e-9)


# ---- balance laws --------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
@pytest.mark.parametrize(
    ("damping", "order"),
    [({}, 5), ({"damping": rbsdem.Damping(20.0, 5e-4)}, 4)],
    ids=["undamped", "damped"],
)
def test_energy_residual_falls_with_its_order(n, kinematics, damping, order):
    """RK4 loses (omega h)^6/72 of an undamped mode in a step: order 5. Work of damping: order 4."""
    column = linear_column(n, kinematics=kinematics, axial_load=2e5, **damping)
    exact = Exact(column)
    spacing = 1.6 / exact.omega_max()
    loads = random_loads(7, 41)
    residuals = []
    for parts in (16, 32, 64) if order == 5 else (64, 128, 256):
        run = rbsdem.time_history(
            column, spacing * np.arange(41), force=loads[:, 0], ground_acceleration=loads[:, 1],
            dt=spacing / parts, initial=as_initial(initial_state(exact)), method="rk4",
        )  # fmt: skip
        energy = run.energy
        others = ("kinetic", "spring", "damping", "axial")
        begin = energy["kinetic"][0] + energy["spring"][0] + energy["axial"][0]
        residual = energy["input"] + begin - sum(energy[name] for name in others)
        scale = np.max(energy["kinetic"] + energy["spring"])
        np.testing.assert_allclose(energy["residual"], residual, atol=1e-13 * scale)
        assert run.summary["energy_residual"] == np.max(np.abs(energy["residual"]))
        residuals.append(np.max(np.abs(energy["residual"])) / scale)
    assert residuals[0] < 1e-5
    assert np.all(np.abs(orders(residuals) - order) < 0.05), orders(residuals)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_momentum_above_the_ground_joint(kinematics):
    """d2/dt2 of sum m x = F - V_1 - sum m a_g, by differences of order 4 over the rows."""
    n = 1 if kinematics == "finite" else 3
    column = linear_column(n, kinematics=kinematics, axial_load=1e5)
    omega = rbsdem.modes(column).omega[-1]
    h = 0.02 / omega
    times = h * np.arange(1001)
    force = 2e4 + 1e6 * times  # no corner inside
    ground = 3.0 - 50.0 * times
    run = rbsdem.time_history(
        column, times, force=force, ground_acceleration=ground, dt=h,
        initial=as_initial(initial_state(Exact(linear_column(n))) * 10), method="rk4",
    )  # fmt: skip
    lengths, masses = np.array(LENGTHS[:n]), np.array(MASSES[:n])
    theta = np.cumsum(run.rotation, axis=1)
    swing = lengths * (np.sin(theta) if kinematics == "finite" else theta)
    centroid = np.cumsum(run.slip, axis=1) + np.cumsum(swing, axis=1) - swing / 2
    moment = centroid @ masses
    second = -moment[:-4] + 16 * moment[1:-3] - 30 * moment[2:-2] + 16 * moment[3:-1] - moment[4:]
    second /= 12 * h**2
    expected = (force - run.shear[:, 0] - masses.sum() * ground)[2:-2]
    assert np.max(np.abs(second - expected)) < (omega * h) ** 4 * np.max(np.abs(expected))


# ---- finite rotation -----------------------------------------------------------------------------


def finite_column(k_v=7e3, k_m=2.5e3, **options) -> rbsdem.Column:
    return rbsdem.Column(HEIGHT, MASS, Elastic(k_v), Elastic(k_m), kinematics="finite", **options)


def test_e6_finite_free_vibration_conserves_energy_with_order_4_or_more():
    drift = []
    for steps in (100, 200, 400, 800):
        times = np.linspace(0, 6.0, steps + 1)
        run = rbsdem.time_history(
            finite_column(),
            times,
            dt=6.0 / steps,
            initial={"slip": [0.05], "rotation": [0.8]},
            method="rk4",
        )
        total = run.energy["kinetic"] + run.energy["spring"]
        drift.append(np.max(np.abs(total - total[0])) / total[0])
    assert np.all(orders(drift) > 3.95), orders(drift)
    assert drift[-1] < 1e-6


def test_finite_tends_to_small_quadratically():
    def normalised(kinematics, amplitude):
        column = rbsdem.Column(HEIGHT, MASS, Elastic(7e3), Elastic(2.5e3), kinematics=kinematics)
        start = {"slip": [0.06 * amplitude], "rotation": [amplitude]}
        run = rbsdem.time_history(
            column, np.linspace(0, 3, 301), dt=0.002, initial=start, method="rk4"
        )
        return np.hstack([run.slip, run.rotation]) / amplitude

    amplitudes = 0.1 / 2 ** np.arange(4)
    gaps = [np.max(np.abs(normalised("finite", a) - normalised("small", a))) for a in amplitudes]
    assert np.all(np.abs(orders(gaps) - 2) < 0.05), orders(gaps)


def newton_euler(t, y, column, force, ground):
    """One body by Newton and Euler about its centroid, with the vertical force of the ground.

    Independent of the program's Lagrangian form (eq 4): unknowns x_c'', theta'' and that force.
    """
    u, theta, du, dtheta = y
    mass, half, load = column.mass, column.height / 2, column.axial_load
    weight = mass * column.gravity if column.self_weight else 0.0
    inertia = mass * column.height**2 / 12
    sine, cosine = np.sin(theta), np.cos(theta)
    f, acceleration = np.interp(t, [0, 1], force), np.interp(t, [0, 1], ground)
    # Generalised damping forces, alpha M(q) q' + beta k0 q'.
    coupling = mass * half * cosine
    given = column.damping or rbsdem.Damping()
    alpha, beta = given.mass, given.stiffness
    about = inertia + mass * half**2
    shear = column.shear.k * (u + beta * du) + alpha * (mass * du + coupling * dtheta)
    moment = column.flexure.k * (theta + beta * dtheta) + alpha * (coupling * du + about * dtheta)
    x2 = (f - shear) / mass - acceleration
    # y_c'' = -half (sin th'' + cos th'^2), support = load + weight + m y_c''
    drop = load + weight - mass * half * cosine * dtheta**2
    turning = half * cosine * (f + shear) + half * sine * (load + drop) - moment
    dtheta2 = turning / (inertia + mass * half**2 * sine**2)
    du2 = x2 - half * (cosine * dtheta2 - sine * dtheta**2)
    return [du, dtheta, du2, dtheta2]


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"axial_load": 600.0},
        {"axial_load": -3000.0},
        {"self_weight": True, "gravity": 2.0},
        {"damping": rbsdem.Damping(0.5)},
        {"damping": rbsdem.Damping(stiffness=0.05)},
        {"axial_load": 300.0, "self_weight": True, "gravity": 1.0, "damping": rbsdem.Damping(0.2)},
    ],
)
def test_finite_against_newton_and_euler(options):
    """All loads at once, rotations near 1: order 4 against an accurate independent solution."""
    column = finite_column(**options)
    force, ground = [300.0, -200.0], [-0.4, 0.7]
    start = [0.05, 0.8, -0.2, 0.3]
    times = np.linspace(0, 1, 11)
    expected = solve_ivp(
        newton_euler, (0, 1), start, "DOP853", times, rtol=1e-13, atol=1e-14,
        args=(column, force, ground),
    ).y  # fmt: skip
    errors = []
    for steps in (50, 100, 200):
        grid = np.linspace(0, 1, steps + 1)
        run = rbsdem.time_history(
            column,
            grid,
            force=np.interp(grid, [0, 1], force),
            ground_acceleration=np.interp(grid, [0, 1], ground),
            dt=1 / steps,
            initial=as_initial(np.array(start)),
            method="rk4",
        )
        got = np.hstack([run.slip, run.rotation])[:: steps // 10]
        errors.append(np.max(np.abs(got - expected[:2].T)))
    assert np.max(np.abs(expected[1])) > 0.5
    assert errors[-1] < 1e-7
    assert np.all(np.abs(orders(errors) - 4) < 0.3), orders(errors)
    top = run.slip[:, 0] + HEIGHT * np.sin(run.rotation[:, 0])
    np.testing.assert_allclose(run.displacement, top, rtol=1e-13, atol=1e-14)
    balance = run.energy["residual"] / np.max(run.energy["kinetic"])
    assert np.max(np.abs(balance)) < 1e-7


# ---- nonlinear -----------------------------------------------------------------------------------


def bilinear_reference(column, velocity, times):
    """One body, two bilinear springs: solved from event to event with located events.

    Spring force k_post d + (k - k_post)(d - s), |d - s| <= d_y; s stays (elastic) or comes along
    (yielding) until the velocity turns.
    """
    springs = (column.shear, column.flexure)
    mass, length = column.mass, column.height
    matrix = np.array([[mass, mass * length / 2], [mass * length / 2, mass * length**2 / 3]])
    inverse = np.linalg.inv(matrix)
    plastic, way = np.zeros(2), np.zeros(2)

    def rates(t, y):
        force = np.empty(2)
        for i, s in enumerate(springs):
            stretch = way[i] * s.d_y if way[i] else y[i] - plastic[i]
            force[i] = s.k_post * y[i] + (s.k - s.k_post) * stretch
        return np.concatenate([y[2:], -inverse @ force])

    def event(i):
        def reached(t, y):
            if way[i]:
                return way[i] * y[2 + i]
            return springs[i].d_y - abs(y[i] - plastic[i])

        reached.terminal, reached.direction = True, -1
        return reached

    events = [event(0), event(1)]
    now, state = 0.0, np.concatenate([np.zeros(2), velocity])
    rows, count = [], 0
    while now < times[-1]:
        part = solve_ivp(
            rates, (now, times[-1]), state, "DOP853", dense_output=True, events=events,
            rtol=1e-12, atol=1e-15,
        )  # fmt: skip
        inside = times[(times >= now) & (times < part.t[-1])]
        rows.extend(part.sol(t)[:2] for t in inside)
        now, state = part.t[-1], part.y[:, -1]
        for i, found in enumerate(part.t_events):
            if len(found) == 0:
                continue
            count += 1
            if way[i]:
                plastic[i] = state[i] - way[i] * springs[i].d_y
                way[i] = 0.0
            else:
                way[i] = np.sign(state[i] - plastic[i])
    rows.append(state[:2])
    return np.array(rows), count


def test_bilinear_column_converges_to_the_solution_with_located_events():
    """Springs change their line at the end of a step: order 2, not 4; no two steps are alike."""
    column = rbsdem.Column(2.0, 500.0, Bilinear(4e6, 2e-3, 4e5), Bilinear(9e6, 3e-3, 1e6))
    times = np.linspace(0, 0.4, 21)
    velocity = [0.3, 0.4]
    expected, events = bilinear_reference(column, velocity, times)
    assert len(expected) == len(times)
    assert events > 10
    start = {"slip_velocity": velocity[:1], "rotation_velocity": velocity[1:]}
    steps = 0.02 / 2 ** np.arange(5, 13)
    errors, residuals = [], []
    for dt in steps:
        run = rbsdem.time_history(column, times, dt=dt, initial=start, method="rk4")
        got = np.hstack([run.slip, run.rotation])
        errors.append(np.max(np.abs(got - expected)) / np.max(np.abs(expected)))
        residuals.append(run.summary["relative_energy_residual"])
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope > 1.8, (slope, errors)
    assert errors[-1] < 1e-7
    slope = np.polyfit(np.log(steps), np.log(residuals), 1)[0]
    assert slope > 1.8, (slope, residuals)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_springs_are_on_their_paths(kinematics):
    """The rows of every step fed to the springs alone give the forces of the rows."""
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE, kinematics=kinematics)
    loads = random_loads(9, 300) * [5, 30]
    times = 4e-3 * np.arange(300)
    run = rbsdem.time_history(
        column,
        times,
        force=loads[:, 0],
        ground_acceleration=loads[:, 1],
        dt=1e-4,
        every=1,
        method="rk4",
    )
    assert len(run.time) == run.summary["steps"] + 1
    assert np.max(np.abs(run.rotation)) > 2 * FLEXURE.d_y
    for spring, d, f in ((SHEAR, run.slip, run.shear), (FLEXURE, run.rotation, run.moment)):
        again = spring.response(d[:, 0])
        assert np.max(np.abs(again - f[:, 0])) < 1e-12 * np.max(np.abs(f))


def test_energy_of_a_nonlinear_run_is_reported_and_balances():
    column = rbsdem.Column(
        HEIGHT, MASS, SHEAR, FLEXURE, damping=rbsdem.Damping(mass=5.0, stiffness=1e-6)
    )
    loads = random_loads(10, 100) * [5, 30]
    times = 4e-3 * np.arange(100)
    residuals = []
    for parts in (20, 80, 320):
        run = rbsdem.time_history(
            column,
            times,
            force=loads.T[0],
            ground_acceleration=loads.T[1],
            dt=4e-3 / parts,
            method="rk4",
        )
        residuals.append(run.summary["relative_energy_residual"])
    assert run.energy["spring"][-1] > 100
    assert np.all(np.diff(run.energy["damping"]) >= 0)
    assert residuals[-1] < 1e-4
    assert residuals[2] < 0.3 * residuals[1] < 0.09 * residuals[0]


def ramps(targets, duration: float, points: int):
    """Times and forces from target to target along half cosines, at rest at each target."""
    corners = np.concatenate([[0.0], targets])
    phase = np.linspace(0, 1, points + 1)[1:]
    blend = (1 - np.cos(np.pi * phase)) / 2
    force = np.concatenate([a + (b - a) * blend for a, b in itertools.pairwise(corners)])
    return duration / points * np.arange(len(force) + 1), np.concatenate([[0.0], force])


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_slow_force_follows_the_static_path(kinematics):
    """Column 1 of the paper: inertia and damping at the turning points fall with duration^-2."""
    column = rbsdem.Column(
        HEIGHT,
        MASS,
        SHEAR,
        FLEXURE,
        axial_load=7.44e5,
        kinematics=kinematics,
        damping=rbsdem.Damping(mass=50.0),
    )
    targets = np.array([0.8e5, -1.0e5, 1.3e5, -1.5e5, 0.5e5, -0.2e5, 1.6e5, 0.0])
    static = rbsdem.cyclic(column, force=targets).displacement
    gaps = []
    for duration in (0.4, 1.6, 6.4):
        times, force = ramps(targets, duration, 400)
        run = rbsdem.time_history(column, times, force=force, method="rk4")
        gaps.append(np.max(np.abs(run.displacement[400::400] - static)) / np.max(np.abs(static)))
    assert gaps[2] < 2e-4, gaps
    assert gaps[2] < 0.2 * gaps[1] < 0.04 * gaps[0], gaps


# ---- steps and rows ------------------------------------------------------------------------------


def told_limit(message: str) -> float:
    found = re.search(r"stability limit of rk4, ([-+.e\d]+) s", message)
    assert found, message
    return float(found.group(1))


@pytest.mark.parametrize("damping", DAMPINGS)
def test_step_beyond_the_limit_is_refused_with_the_limit(damping):
    column = linear_column(3, **DAMPINGS[damping])
    limit = rbsdem.modes(column).stable_step
    with pytest.raises(rbsdem.InputError, match="beyond") as caught:
        rbsdem.time_history(column, [0, 1], force=[0.0, 0.0], dt=1.01 * limit, method="rk4")
    assert told_limit(str(caught.value)) == pytest.approx(limit, rel=1e-5)
    run = rbsdem.time_history(
        column, [0, 100 * limit], force=[0.0, 0.0], dt=0.99 * limit, method="rk4"
    )
    assert run.summary["stable_step"] == limit
    assert run.summary["time_step"] == 0.99 * limit


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("damping", DAMPINGS)
def test_step_just_below_the_limit_stays_bounded(n, damping):
    """No mode of RK4 grows there, so the energy never rises above that of the begin: 1e5 steps."""
    column = linear_column(n, **DAMPINGS[damping])
    limit = rbsdem.modes(column).stable_step
    exact = Exact(column)
    run = rbsdem.time_history(
        column, [0, 1e5 * 0.99 * limit], dt=0.99 * limit, every=100,
        initial=as_initial(initial_state(exact)), method="rk4",
    )  # fmt: skip
    assert run.summary["steps"] == 100_000
    # With damping eigenvectors are oblique: bounded by their condition, still without growth.
    factor = 1 + 1e-9 if damping == "none" else np.linalg.cond(np.linalg.eig(exact.matrix)[1])
    total = run.energy["kinetic"] + 0.5 * np.hstack([run.slip, run.rotation]) ** 2 @ exact.springs
    assert np.max(total) <= total[0] * factor
    assert total[-1] <= total[0] * (1 + 1e-9)


@pytest.mark.parametrize("ratio", [0.02, 0.5, 0.75, 1.0, 2.0])
def test_step_just_below_the_limit_stays_bounded_when_springs_yield(ratio):
    """Stiffness damping stays when a spring yields, `ratio` is that of the highest mode."""

    def column(damping):
        return rbsdem.Column(
            HEIGHT, MASS, Bilinear(7e8, 1e-4, 7e5), Bilinear(2.5e8, 1e-4, 2.5e5),
            damping=rbsdem.Damping(stiffness=damping),
        )  # fmt: skip

    damped = column(2 * ratio / rbsdem.modes(column(0.0)).omega[-1])
    limit = rbsdem.modes(damped).stable_step
    run = rbsdem.time_history(
        damped, [0, 5000 * limit], dt=0.99 * limit,
        initial={"slip_velocity": [1.0], "rotation_velocity": [1.0]}, method="rk4",
    )  # fmt: skip
    # All the energy of the begin, spent on the flexural spring alone at its yield moment.
    energy, moment = run.energy["kinetic"][0], 2.5e8 * 1e-4
    assert np.max(np.abs(run.rotation)) < 2 * energy / moment


@pytest.mark.parametrize("factor", [1e-3, 1.0, 7.3, 1e3])
def test_no_step_given(factor):
    """Every interval is cut into equal steps not longer than a fifth of the limit."""
    column = linear_column(3)
    limit = rbsdem.modes(column).stable_step
    times = limit * factor * np.array([0.0, 1.0, 3.0, 3.5])
    run = rbsdem.time_history(column, times, initial={"slip": [1e-3, 0, 0]}, method="rk4")
    assert np.array_equal(run.time, times)
    parts = np.ceil(np.diff(times) / (limit / 5) * (1 - 1e-6))
    assert run.summary["steps"] == parts.sum()
    assert 0 < run.summary["time_step"] <= limit / 5 * (1 + 1e-9)


def test_no_step_given_is_accurate():
    """What a user gets without choosing: within 1 % of the exact solution for a smooth load."""
    column = linear_column(3, **DAMPINGS["both"])
    exact = Exact(column)
    frequency = 0.1 * exact.omega_max()
    times = np.linspace(0, 12 * np.pi / frequency, 12 * 200 + 1)
    run = rbsdem.time_history(column, times, force=1e4 * np.sin(frequency * times), method="rk4")
    assert exact.distance(run, exact.harmonic(times, 1e4, frequency)) < 0.01


def test_step_that_divides_keeps_rows_at_the_times():
    column = linear_column(1)
    times = np.array([1.0, 1.25, 1.5, 2.5]) * 0.01
    run = rbsdem.time_history(column, times, force=[0, 1e3, 0, 0], dt=0.01 / 64, method="rk4")
    assert np.array_equal(run.time, times)
    assert run.summary["steps"] == 96
    again = rbsdem.time_history(
        column, times, force=[0, 1e3, 0, 0], dt=0.01 / 64 * (1 + 1e-12), method="rk4"
    )
    assert np.array_equal(again.time, times)


def test_step_that_does_not_divide_keeps_a_row_after_each():
    column = linear_column(1)
    times = np.array([0.5, 0.6, 0.63])
    dt = 0.0007
    run = rbsdem.time_history(column, times, force=[0, 1e3, 0], dt=dt, method="rk4")
    assert run.summary["steps"] == 186
    np.testing.assert_allclose(run.time[:-1], 0.5 + dt * np.arange(186), rtol=1e-14)
    assert run.time[-1] == 0.63
    np.testing.assert_allclose(run.force, np.interp(run.time, times, [0, 1e3, 0]), atol=1e-9)
    long = rbsdem.time_history(
        column, [0.0, 1e-4, 2e-4, 1e-3], force=[0, 1, 2, 3], dt=4e-4, method="rk4"
    )
    np.testing.assert_allclose(long.time, [0, 4e-4, 8e-4, 1e-3], rtol=1e-14)


def test_rows_do_not_depend_on_the_begin_of_time():
    """The same loading begun at 0 and at 64 s (exact in binary)."""
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE)
    times = np.arange(0, 100) / 1024
    loads = random_loads(12, 100) * [5, 30]
    early = rbsdem.time_history(
        column,
        times,
        force=loads.T[0],
        ground_acceleration=loads.T[1],
        dt=1 / 1024 / 16,
        method="rk4",
    )
    late = rbsdem.time_history(
        column,
        times + 64,
        force=loads.T[0],
        ground_acceleration=loads.T[1],
        dt=1 / 1024 / 16,
        method="rk4",
    )
    assert np.array_equal(late.time, times + 64)
    np.testing.assert_allclose(late.displacement, early.displacement, rtol=1e-9, atol=1e-14)


def test_rows_at_the_times_are_among_those_of_the_steps():
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE, n=2)
    times = np.concatenate([[0.0], np.cumsum(1e-3 * np.array([1, 2, 5, 1, 3] * 20))])
    force = 1e5 * np.sin(60 * times)
    for dt in (None, 1e-4):
        whole = rbsdem.time_history(column, times, force=force, dt=dt, every=1, method="rk4")
        plain = rbsdem.time_history(column, times, force=force, dt=dt, method="rk4")
        assert np.array_equal(plain.time, times)
        places = np.searchsorted(whole.time, times)
        assert np.array_equal(whole.time[places], times)
        assert np.array_equal(whole.moment[places], plain.moment)


def test_no_load_no_motion():
    run = rbsdem.time_history(linear_column(3), [0, 1], force=[0.0, 0.0], method="rk4")
    assert not np.any(run.displacement)
    assert not np.any(run.force)
    assert run.summary["relative_energy_residual"] == 0.0


# ---- initial state -------------------------------------------------------------------------------


def test_initial_state_is_the_first_row():
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE, n=2)
    slip, rotation = [3e-4, -5e-4], [4e-3, -1e-3]
    run = rbsdem.time_history(
        column, [0, 1e-3], initial={"slip": slip, "rotation": rotation}, method="rk4"
    )
    assert run.slip[0].tolist() == slip
    assert run.rotation[0].tolist() == rotation
    for i in range(2):
        # The springs get there from zero, beyond yield too.
        assert run.shear[0, i] == SHEAR.response([slip[i]])[0]
        assert run.moment[0, i] == FLEXURE.response([rotation[i]])[0]
    top = sum(slip) + 0.8 * (rotation[0] + sum(rotation))
    assert run.displacement[0] == pytest.approx(top, rel=1e-14)
    assert run.energy["residual"][0] == 0.0
    assert run.energy["kinetic"][0] == 0.0


def test_initial_velocity_is_kinetic_energy():
    column = linear_column(3)
    velocity = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
    run = rbsdem.time_history(
        column,
        [0, 1e-3],
        initial={"slip_velocity": velocity[:3], "rotation_velocity": velocity[3:]},
        method="rk4",
    )
    expected = velocity @ Exact(column).mass @ velocity / 2
    assert run.energy["kinetic"][0] == pytest.approx(expected, rel=1e-13)
    one = rbsdem.time_history(linear_column(1), [0, 1e-3], initial={"rotation": 0.01}, method="rk4")
    assert one.rotation[0, 0] == 0.01


BAD_INITIAL = [
    ({"slips": [0.1]}, "initial: 'slips'"),
    ({"slip": [0.1, 0.2]}, "initial: slip has 2 values for n = 1"),
    ({"rotation": []}, "initial: rotation has 0 values"),
    ({"rotation_velocity": [float("nan")]}, "initial: rotation_velocity: value 1 of 1 is nan"),
    ({"slip": [float("inf")]}, "initial: slip: value 1 of 1 is inf"),
    ({"slip": "far"}, "initial: slip must be an array of numbers"),
]


@pytest.mark.parametrize(("initial", "text"), BAD_INITIAL, ids=[text for _, text in BAD_INITIAL])
def test_bad_initial_state_is_refused(initial, text):
    with pytest.raises(rbsdem.InputError, match=re.escape(text)):
        rbsdem.time_history(linear_column(1), [0, 1], initial=initial, method="rk4")


# ---- bad input -----------------------------------------------------------------------------------

NAN, INF = float("nan"), float("inf")
BAD = [
    ({"time": [0.0, 1.0, 0.5]}, "time: value 3 of 3, 0.5 s"),
    ({"time": [0.0, 1.0, 1.0]}, "time: value 3 of 3, 1 s"),
    ({"time": [1.0, 0.0]}, "time: value 2 of 2, 0 s"),
    ({"time": [0.0, NAN, 1.0]}, "time: value 2 of 3 is NaN"),
    ({"time": [0.0, INF]}, "time: value 2 of 2 is Infinity"),
    ({"time": [0.0]}, "time: 1 point"),
    ({"time": []}, "time: 0 point"),
    ({"time": [[0.0, 1.0]]}, "time has shape (1, 2)"),
    ({"time": ["a", "b"]}, "time must be an array of numbers"),
    ({"force": [1.0]}, "force: 1 values for 2 times"),
    ({"force": [1.0, 2.0, 3.0]}, "force: 3 values for 2 times"),
    ({"force": []}, "force is empty"),
    ({"force": [0.0, NAN]}, "force: value 2 of 2 is NaN"),
    ({"ground_acceleration": [1.0]}, "ground_acceleration: 1 values for 2 times"),
    ({"ground_acceleration": [-INF, 1.0]}, "ground_acceleration: value 1 of 2 is -Infinity"),
    ({"ground_acceleration": []}, "ground_acceleration is empty"),
    ({"dt": 0.0}, "dt = 0 s must be above zero"),
    ({"dt": -1e-3}, "dt = -0.001 s must be above zero"),
    ({"dt": NAN}, "dt = NaN must be a finite number"),
    ({"dt": INF}, "dt = Infinity"),
    ({"dt": 10.0}, "dt = 10 s is beyond the stability limit"),
    ({"dt": "fast"}, "dt = 'fast' must be a number"),
    ({"dt": 1e-12}, "steps of 1e-12 s"),
    ({"time": [0.0, 1e12]}, "generalised_alpha"),
    ({"method": "rk5"}, "method = 'rk5'"),
    ({"every": 0}, "every = 0"),
    ({"every": 2.5}, "every = 2.5"),
]


@pytest.mark.parametrize(("change", "text"), BAD, ids=[text for _, text in BAD])
def test_bad_history_is_refused(change, text):
    with pytest.raises(rbsdem.InputError, match=re.escape(text)):
        rbsdem.time_history(
            linear_column(1),
            **({"time": [0.0, 1.0], "initial": {"slip": [0.0]}, "method": "rk4"} | change),
        )


def test_buckled_column_is_refused():
    with pytest.raises(rbsdem.InputError, match="critical load"):
        rbsdem.time_history(
            linear_column(1, kinematics="pdelta", axial_load=2e7),
            [0, 1],
            force=[0.0, 0.0],
            method="rk4",
        )


def test_motion_that_loses_all_bounds_keeps_its_rows():
    """P-Delta beyond the stiffness after yield: the motion grows without end."""
    column = rbsdem.Column(
        2.0, 500.0, Elastic(4e6), Bilinear(9e6, 3e-3, 1e5), axial_load=1e6,
        kinematics="pdelta",
    )  # fmt: skip
    times = np.linspace(0, 50, 5001)
    with pytest.raises(rbsdem.SolveError, match="bounds") as caught:
        rbsdem.time_history(column, times, initial={"rotation_velocity": [1.0]}, method="rk4")
    kept = caught.value.result
    assert 10 < len(kept.time) < 5001
    assert np.array_equal(kept.time, times[: len(kept.time)])
    assert np.all(np.isfinite(kept.displacement))
    # Exponential growth at the rate of the yielded column.
    mass = Exact(rbsdem.Column(2.0, None, [column.shear], [Elastic(1.0)], lengths=[2.0],
                               masses=[500.0])).mass  # fmt: skip
    squares = np.linalg.eigvals(np.linalg.solve(mass, np.diag([4e6, 1e5 - 2e6])))
    growth = np.sqrt(-np.min(squares))
    rates = np.diff(np.log(np.abs(kept.rotation[-20:, 0]))) / np.diff(kept.time[-20:])
    np.testing.assert_allclose(rates, growth, rtol=1e-4)


# ---- the door to Fortran -------------------------------------------------------------------------


def test_double_precision_survives_the_door():
    value = 1.0 + 1e-12
    assert Elastic(1.0).response([value])[0] == value
    assert Elastic(value).response([1.0])[0] == value
    column = rbsdem.Column(value, value, Elastic(1.0), Elastic(1.0))
    assert rbsdem.matrices(column).mass[0, 0] == value
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="half of the height"):
        assert rbsdem.cyclic(column, force=[value]).shear[0, 0] == value
    run = rbsdem.time_history(column, [0, 1e-3], initial={"slip": [value]}, method="rk4")
    assert run.slip[0, 0] == value
    assert (
        rbsdem.time_history(column, [value, 1.5], force=[0.0, 0.0], method="rk4").time[0] == value
    )


def jobs():
    """Runs of both kinds that differ from each other, each a function."""
    work = []
    for n, seed in itertools.product((1, 3), range(4)):
        rng = np.random.default_rng(seed)
        column = rbsdem.Column(
            HEIGHT, MASS, SHEAR, FLEXURE, n=n, axial_load=2e5, kinematics="pdelta"
        )
        path = rng.uniform(-0.05, 0.05, 2000)
        times = 2e-3 * np.arange(200)
        loads = random_loads(seed, 200) * [5, 30]
        work.append(lambda c=column, p=path: rbsdem.cyclic(c, displacement=p))
        work.append(
            lambda c=column, t=times, p=loads: rbsdem.time_history(
                c, t, force=p.T[0], ground_acceleration=p.T[1], method="rk4"
            )
        )
    return work


def test_threads_give_the_same_bits():
    serial = [job() for job in jobs()]
    with ThreadPoolExecutor(4) as pool:
        for _ in range(3):
            parallel = list(pool.map(lambda job: job(), jobs()))
            for one, other in zip(serial, parallel, strict=True):
                assert np.array_equal(one.slip, other.slip)
                assert np.array_equal(one.rotation, other.rotation)
                assert np.array_equal(one.moment, other.moment)
                assert np.array_equal(one.energy["residual"], other.energy["residual"])
                assert one.summary == other.summary


def has_a_turn_meanwhile(run) -> bool:
    """Whether Python gets a turn while a call of Fortran lasts.

    A thread keeps the interpreter for as long as it wants here, so that the turn can only come if
    Fortran gives it away.
    """
    state = []

    def work():
        run(lambda: state.append("in"), lambda: state.append("out"))

    worker = threading.Thread(target=work)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    try:
        worker.start()
        while not state:
            clock.sleep(0.0)
        seen = list(state)
    finally:
        sys.setswitchinterval(interval)
        worker.join()
    assert state[-1] == "out"
    return seen[-1] == "in"


@pytest.mark.parametrize("analysis", ["time_history", "cyclic", "response"])
def test_gil_is_released(analysis, monkeypatch):
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE)
    path = np.tile(np.linspace(-0.05, 0.05, 1000), 2000)
    analyse = {
        "time_history": lambda: rbsdem.time_history(
            column, [0.0, 1.5e6 * 1e-4], force=[0.0, 0.0], dt=1e-4, every=1000, method="rk4"
        ),
        "cyclic": lambda: rbsdem.cyclic(column, displacement=path, every=1000),
        "response": lambda: FLEXURE.response(path),
    }[analysis]
    fortran = _core._rbsdem.rbs_evaluate

    def run(enter, leave):
        def watched(*arguments):
            enter()
            answer = fortran(*arguments)
            leave()
            return answer

        monkeypatch.setattr(_core._rbsdem, "rbs_evaluate", watched)
        analyse()

    # On a loaded machine the waiting thread may wake too late; it will not do so every time.
    assert any(has_a_turn_meanwhile(run) for _ in range(10))
