"""The column: mass matrix, modes, stable step, axial load, and what it refuses.

References are built here from positions of centroids and the exact geometry of the chain (theory,
section 2), or are closed forms of beam theory.
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.optimize import brentq

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

ELASTIC = Elastic(1.0e6)
BILINEAR = Bilinear(7.0387e8, 1.2960e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)

# The warning that frequencies hang on the last digits of the load is right, and not the matter.
NEAR_CRITICAL = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")


def elastic(values) -> list[Elastic]:
    return [Elastic(k) for k in values]


def random_column(rng: np.random.Generator, n: int, **options) -> rbsdem.Column:
    """Bodies and joints that differ by factors of up to 30."""

    def spread(middle):
        return middle * 10 ** rng.uniform(-0.75, 0.75, n)

    lengths = spread(0.5)
    return rbsdem.Column(
        lengths.sum(),
        None,
        elastic(spread(5e8)),
        elastic(spread(2e8)),
        n=n,
        lengths=lengths,
        masses=spread(300.0),
        **options,
    )


def stiffness(column: rbsdem.Column) -> np.ndarray:
    return np.diag([spring.k for spring in (*column.joints("shear"), *column.joints("flexure"))])


def kinematic_mass(lengths, masses) -> np.ndarray:
    """Sum of m J'J + I G'G; the rows of J and G are centroids and rotations in (u, phi)."""
    lengths, masses = np.asarray(lengths), np.asarray(masses)
    n = len(lengths)
    joint = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    centroid = joint + lengths / 2
    below = np.tril(np.ones((n, n)))  # joint j is below centroid k
    centroids = np.hstack([below, below * (centroid[:, None] - joint[None, :])])
    rotations = np.hstack([np.zeros((n, n)), below])
    inertia = masses * lengths**2 / 12
    return centroids.T * masses @ centroids + rotations.T * inertia @ rotations


def paper_transform(n: int) -> np.ndarray:
    """T with (u, theta) = T (u, phi): theta is the cumulative sum of phi."""
    transform = np.eye(2 * n)
    transform[n:, n:] = np.tril(np.ones((n, n)))
    return transform


def axial_stiffness(lengths, load, weights) -> np.ndarray:
    """Second derivatives of the potential of load and weights, by hand from section 2.

    Height of a point: sum of l_k (1 - th_k^2/2) over the lengths below it, less the sum of
    u_k th_{k-1}.
    """
    n = len(lengths)
    theta = np.tril(np.ones((n, n)))  # th_k in phi
    total = np.zeros((2 * n, 2 * n))

    def add(force, arms, slips):
        for k in range(n):
            total[n:, n:] -= force * arms[k] * np.outer(theta[k], theta[k])
            if k > 0 and slips[k]:
                total[k, n:] -= force * theta[k - 1]
                total[n:, k] -= force * theta[k - 1]

    add(load, lengths, np.ones(n, dtype=bool))
    for body, weight in enumerate(weights):
        arms = [
            lengths[k] if k < body else (0.5 * lengths[k] if k == body else 0.0) for k in range(n)
        ]
        add(weight, arms, np.arange(n) <= body)
    return total


# ---- mass matrix ---------------------------------------------------------------------------------


@pytest.mark.parametrize("n", range(1, 21))
def test_mass_matrix_in_both_views_is_that_of_the_kinematics(n):
    rng = np.random.default_rng(100 + n)
    for _ in range(5):
        column = random_column(rng, n)
        symmetric = rbsdem.matrices(column).mass
        paper = rbsdem.matrices(column, form="paper").mass
        reference = kinematic_mass(column.lengths, column.masses)
        assert symmetric.shape == paper.shape == (2 * n, 2 * n)
        # All entries are sums of positive terms: entry by entry to round-off.
        np.testing.assert_allclose(symmetric, reference, rtol=1e-13)
        np.testing.assert_allclose(paper @ paper_transform(n), reference, rtol=1e-13)
        assert np.array_equal(symmetric, symmetric.T)
        assert np.all(np.linalg.eigvalsh(symmetric / np.max(symmetric)) > 0)


def test_mass_matrix_of_one_body_is_that_of_eq_5():
    column = rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC)
    m, l = 614.4, 1.6  # noqa: E741
    expected = [[m, m * l / 2], [m * l / 2, m * l**2 / 12 + m * l**2 / 4]]
    for form in ("symmetric", "paper"):
        np.testing.assert_allclose(rbsdem.matrices(column, form).mass, expected, rtol=1e-15)


def test_mass_spread_over_equal_bodies_keeps_mass_and_moments():
    """A cut rigid column is the same rod: M of joint 1 does not depend on n."""
    whole = rbsdem.matrices(rbsdem.Column(3.0, 900.0, ELASTIC, ELASTIC)).mass
    for n in (2, 5, 16):
        mass = rbsdem.matrices(rbsdem.Column(3.0, 900.0, ELASTIC, ELASTIC, n=n)).mass
        np.testing.assert_allclose(mass[np.ix_([0, n], [0, n])], whole, rtol=1e-14)


def test_mass_is_spread_in_proportion_to_the_lengths():
    lengths = [0.5, 1.5, 1.0]
    spread = rbsdem.Column(3.0, 900.0, ELASTIC, ELASTIC, n=3, lengths=lengths)
    given = rbsdem.Column(
        3.0, None, ELASTIC, ELASTIC, n=3, lengths=lengths, masses=[150.0, 450.0, 300.0]
    )
    np.testing.assert_allclose(
        rbsdem.matrices(spread).mass, rbsdem.matrices(given).mass, rtol=1e-15
    )


def test_mass_matrix_form_unknown():
    column = rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC)
    with pytest.raises(rbsdem.InputError, match="form = 'papers'"):
        rbsdem.matrices(column, form="papers")


# ---- modes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 2, 3, 7, 20])
def test_modes_are_orthonormal_and_satisfy_the_eigenproblem(n):
    rng = np.random.default_rng(20 + n)
    column = random_column(rng, n)
    modes = rbsdem.modes(column)
    mass, k = kinematic_mass(column.lengths, column.masses), stiffness(column)
    assert modes.omega.shape == modes.frequency.shape == (2 * n,)
    assert np.all(np.diff(modes.omega) > 0)
    np.testing.assert_allclose(modes.frequency, modes.omega / (2 * np.pi), rtol=1e-15)
    # Bound of the method (Cholesky factor of M): round-off times the condition of M.
    bound = 10 * np.finfo(float).eps * np.linalg.cond(mass)
    identity = modes.shapes.T @ mass @ modes.shapes
    assert np.max(np.abs(identity - np.eye(2 * n))) < bound
    squares = modes.shapes.T @ k @ modes.shapes
    assert np.max(np.abs(squares - np.diag(modes.omega**2))) < 1e-13 * modes.omega[-1] ** 2


def test_modes_of_a_bilinear_and_takeda_column_are_those_of_the_initial_stiffness():
    nonlinear = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=3)
    linear = rbsdem.Column(1.6, 614.4, Elastic(7.0387e8), Elastic(2.5428e8), n=3)
    assert np.array_equal(rbsdem.modes(nonlinear).omega, rbsdem.modes(linear).omega)


# ---- many bodies: the beam -----------------------------------------------------------------------

EI, GA, MU, L = 2.0e7, 3.0e7, 400.0, 3.0


def beam(n: int) -> rbsdem.Column:
    """Uniform cantilever of n bodies of length h = L/n.

    Each joint has the flexibility of its tributary length, h/2 on both sides of it; the joint at
    the ground has only one side. A rotation over a length a at curvature M/EI is M a/EI, a slip at
    strain V/GA is V a/GA: k_M = EI/a, k_V = GA/a.
    """
    h = L / n
    tributary = np.full(n, h)
    tributary[0] = h / 2
    return rbsdem.Column(L, MU * L, elastic(GA / tributary), elastic(EI / tributary), n=n)


def test_beam_static_deflection_converges_with_order_2_in_bending():
    """F L^3/(3 EI) (1 + 1/(2 n^2)) is the trapezoidal rule of x^2, and F (L - h/2)/GA in shear."""
    force = 1.0e3
    for n in (1, 2, 4, 8, 32, 128):
        run = rbsdem.cyclic(beam(n), force=[force])
        bending = force * L**3 / (3 * EI) * (1 + 0.5 / n**2)
        shear = force * (L - L / n / 2) / GA
        assert run.displacement[0] == pytest.approx(bending + shear, rel=1e-12)


def continuous_beam_omega(shear_stiffness: float) -> float:
    """First frequency of a cantilever with bending and shear, without rotary inertia.

    GA (w'' - psi') + mu omega^2 w = 0 and EI psi'' + GA (w' - psi) = 0; w = psi = 0 at the ground,
    psi' = w' - psi = 0 at the top.
    """

    def determinant(omega):
        a, b = MU * omega**2 / shear_stiffness, MU * omega**2 / EI
        squares = (-a + np.array([1, -1]) * np.sqrt(a**2 + 4 * b)) / 2
        roots = np.sqrt(squares.astype(complex))
        roots = np.concatenate([roots, -roots])
        psi = roots + a / roots
        top = np.exp(roots * L)
        rows = [np.ones(4), psi, psi * roots * top, (roots - psi) * top * L]
        # Real up to a constant phase: columns come in pairs.
        return (np.linalg.det(np.array(rows)) * 1j).real

    bending = 1.8751040687119611**2 * np.sqrt(EI / (MU * L**4))
    return brentq(determinant, 0.2 * bending, 1.02 * bending, xtol=1e-12 * bending)


def test_continuous_beam_has_the_textbook_limits():
    """Reference of the next test: slender 1.8751^2 sqrt(EI/mu L^4), and Dunkerley's bound."""
    bending = 1.8751040687119611**2 * np.sqrt(EI / (MU * L**4))
    assert continuous_beam_omega(1e12) == pytest.approx(bending, rel=1e-4)
    shear = np.pi / (2 * L) * np.sqrt(GA / MU)
    both = continuous_beam_omega(GA)
    assert (bending**-2 + shear**-2) ** -0.5 < both < min(bending, shear)


def test_beam_first_frequency_converges_with_order_2():
    exact = continuous_beam_omega(GA)
    numbers = np.array([8, 16, 32, 64, 128])
    errors = np.array([abs(rbsdem.modes(beam(n)).omega[0] / exact - 1) for n in numbers])
    orders = np.log2(errors[:-1] / errors[1:])
    assert errors[-1] < 1e-4
    assert abs(orders[-1] - 2) < 0.02
    assert np.all(np.abs(orders - 2) < 0.2)


# ---- stable step ---------------------------------------------------------------------------------


def growth(z):
    """Amplification of one step of RK4."""
    return np.abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24)


def boundary(eigenvalues: np.ndarray) -> float:
    """First step at which a mode grows, by scanning and halving."""

    def grows(h):
        return np.any(growth(eigenvalues * h) > 1 + 1e-11)

    longest = 4 / np.max(np.abs(eigenvalues))
    steps = np.linspace(0, longest, 4001)[1:]
    first = next(i for i, h in enumerate(steps) if grows(h))
    below, above = steps[first] - longest / 4000, steps[first]
    for _ in range(60):
        middle = 0.5 * (below + above)
        below, above = (below, middle) if grows(middle) else (middle, above)
    return below


def first_order(column: rbsdem.Column, geometric=0.0) -> np.ndarray:
    """Eigenvalues of the equation of motion as a system of first order."""
    n2 = 2 * column.n
    mass = kinematic_mass(column.lengths, column.masses)
    k = stiffness(column)
    given = column.damping or rbsdem.Damping()
    damping = given.mass * mass + given.stiffness * k
    solved = np.linalg.solve(mass, np.hstack([-(k + geometric), -damping]))
    return np.linalg.eigvals(np.vstack([np.hstack([np.zeros((n2, n2)), np.eye(n2)]), solved]))


@pytest.mark.parametrize("ratio", [1e-4, 0.01, 0.1, 0.3, 0.7, 0.99, 1.01, 3.0])
@pytest.mark.parametrize("kind", ["mass", "stiffness", "both"])
def test_stable_step_with_damping_is_the_numerical_boundary(ratio, kind):
    """`ratio` is the damping ratio of the highest mode."""
    for n in (1, 3):
        omega = rbsdem.modes(random_column(np.random.default_rng(50 + n), n)).omega[-1]
        mass, spring = {"mass": (1, 0), "stiffness": (0, 1), "both": (0.5, 0.5)}[kind]
        damped = random_column(
            np.random.default_rng(50 + n),
            n,
            damping=rbsdem.Damping(2 * ratio * omega * mass, 2 * ratio / omega * spring),
        )
        expected = boundary(first_order(damped))
        assert rbsdem.modes(damped).stable_step == pytest.approx(expected, rel=1e-6)


@pytest.mark.parametrize("ratio", [0.0, 0.02, 0.1, 0.3, 0.7])
@pytest.mark.parametrize("share", [-20.0, -1.0, 0.5, 0.99])
def test_stable_step_is_safe_for_one_body_with_an_axial_load(ratio, share):
    """Never beyond the boundary of the damped column under its load; `share` of the critical one.

    The damping stays that of the springs alone, whatever the load makes of the frequencies.
    """
    length, k_v, k_m = 2.0, 2e6, 2e6
    load = share * k_m / length

    def column(**options):
        springs = elastic([k_v]), elastic([k_m])
        return rbsdem.Column(
            length, None, *springs, lengths=[length], masses=[500.0], kinematics="pdelta", **options
        )

    omega = rbsdem.modes(column()).omega[-1]
    loaded = column(axial_load=load, damping=rbsdem.Damping(mass=0.1, stiffness=2 * ratio / omega))
    limit = boundary(first_order(loaded, axial_stiffness([length], load, [])))
    assert rbsdem.modes(loaded).stable_step <= limit * (1 + 1e-6)


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.75, 1.0, 2.0])
@pytest.mark.parametrize("n", [1, 3])
def test_stable_step_is_safe_for_springs_that_yield(n, ratio):
    """Stiffness damping is that of the initial stiffness and stays when a spring yields.

    Softened to nothing, a mode of damping c = 2 ratio omega has the eigenvalue -c, which is further
    out than any of the virgin column if ratio = 1 (-omega, twice): its boundary is half as long.
    """
    linear = random_column(np.random.default_rng(70 + n), n)
    damping = 2 * ratio / rbsdem.modes(linear).omega[-1]
    linear = random_column(
        np.random.default_rng(70 + n), n, damping=rbsdem.Damping(stiffness=damping)
    )
    yielding = rbsdem.Column(
        linear.height,
        None,
        [Bilinear(spring.k, 1e-3, 1e-3 * spring.k) for spring in linear.joints("shear")],
        [Bilinear(spring.k, 1e-3, 1e-3 * spring.k) for spring in linear.joints("flexure")],
        n=n,
        lengths=linear.lengths,
        masses=linear.masses,
        damping=rbsdem.Damping(stiffness=damping),
    )
    step = rbsdem.modes(yielding).stable_step
    for softening in (0.0, 0.1, 0.5, 0.9, 0.999):
        limit = boundary(first_order(linear, -softening * stiffness(linear)))
        assert step <= limit * (1 + 1e-6)


# ---- axial load ----------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("load", [-2.0e5, 1.0e5])
def test_modes_under_an_axial_load_are_those_of_the_second_order_potential(n, load):
    lengths, masses = np.linspace(0.4, 0.8, n), np.linspace(300.0, 100.0, n)
    shear, flexure = np.linspace(4e6, 2e6, n), np.linspace(3e6, 2e6, n)
    column = rbsdem.Column(
        lengths.sum(), None, elastic(shear), elastic(flexure), n=n, lengths=lengths, masses=masses,
        axial_load=load, kinematics="pdelta",
    )  # fmt: skip
    k = stiffness(column) + axial_stiffness(lengths, load, [])
    expected = np.sqrt(eigh(k, kinematic_mass(lengths, masses), eigvals_only=True))
    modes = rbsdem.modes(column)
    np.testing.assert_allclose(modes.omega, expected, rtol=1e-11)
    if n == 1:
        finite = rbsdem.Column(
            lengths[0], masses[0], *elastic([shear[0], flexure[0]]), axial_load=load,
            kinematics="finite",
        )  # fmt: skip
        assert np.array_equal(rbsdem.modes(finite).omega, modes.omega)


def test_tension_raises_and_compression_lowers_the_frequencies():
    """All of them for one body, and for several that cannot slip; the first one in general.

    (With slip the second-order work of the load, -P u_k theta_{k-1}, has no sign.)
    """

    def omega(n, k_v, load, kinematics="pdelta"):
        column = rbsdem.Column(
            2.0, 800.0, Elastic(k_v), Elastic(3e6), n=n, axial_load=load,
            kinematics=kinematics,
        )  # fmt: skip
        return rbsdem.modes(column).omega

    loads = [-4e5, -2e5, 0.0, 1e5, 2e5]
    assert np.all(np.diff([omega(1, 4e6, load) for load in loads], axis=0) < 0)
    bending = np.array([omega(4, 1e13, load)[:4] for load in loads])
    assert np.all(np.diff(bending, axis=0) < 0)
    assert np.all(np.diff([omega(4, 4e6, load)[0] for load in loads]) < 0)
    for n in (1, 4):
        assert np.array_equal(omega(n, 4e6, 0.0), omega(n, 4e6, 0.0, "small"))
        assert np.array_equal(omega(n, 4e6, 2e5, "small"), omega(n, 4e6, 0.0, "small"))


def number_before(text: str, unit: str, after: str) -> float:
    """The number in a message that stands after some words and before its unit."""
    found = re.search(after + r" ([-+.e\d]+) " + unit, text)
    assert found, text
    return float(found.group(1))


@NEAR_CRITICAL
@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
def test_critical_load_of_one_body_is_k_m_over_l(kinematics):
    length, k_m = 1.6, 2.5428e8
    critical = k_m / length

    def column(load):
        return rbsdem.Column(
            length, 614.4, Elastic(7.0387e8), Elastic(k_m), axial_load=load,
            kinematics=kinematics,
        )  # fmt: skip

    # The square of the first frequency falls to zero in proportion to what is left.
    squares = [rbsdem.modes(column(s * critical)).omega[0] ** 2 for s in (1 - 1e-4, 1 - 1e-6)]
    assert squares[0] / squares[1] == pytest.approx(100, rel=1e-3)
    for share in (1 + 1e-9, 1.5, 100.0):
        with pytest.raises(rbsdem.InputError, match="critical load") as caught:
            rbsdem.modes(column(share * critical))
        told = number_before(str(caught.value), "N;", "critical load of")
        assert told == pytest.approx(critical, rel=1e-5)
    rbsdem.modes(column((1 - 1e-9) * critical))


@NEAR_CRITICAL
def test_critical_load_of_two_bodies():
    """Equal lengths and joints, rigid in slip: K - P l [[2, 1], [1, 1]] is singular at P l = c k.

    c is the smaller root of 1/c = eigenvalue of [[2, 1], [1, 1]]: (3 - sqrt 5)/2.
    """
    length, k = 0.8, 3.0e6
    critical = (3 - np.sqrt(5)) / 2 * k / length

    def column(load):
        return rbsdem.Column(
            2 * length, 500.0, Elastic(1e16), Elastic(k), n=2, axial_load=load,
            kinematics="pdelta",
        )  # fmt: skip

    rbsdem.modes(column((1 - 1e-6) * critical))
    with pytest.raises(rbsdem.InputError, match="critical load"):
        rbsdem.modes(column((1 + 1e-6) * critical))


@NEAR_CRITICAL
def test_shear_flexibility_lowers_the_critical_load_of_two_bodies():
    """Slip of joint 2 belongs to the lever arm (E8): the critical load by the determinant."""
    length, k_m, k_v = 0.8, 3.0e6, 5.0e6
    lengths = [length, length]

    def smallest(load):
        k = np.diag([k_v, k_v, k_m, k_m]) + axial_stiffness(lengths, load, [])
        return np.linalg.eigvalsh(k)[0] / k_m

    stiff_in_shear = (3 - np.sqrt(5)) / 2 * k_m / length
    critical = brentq(smallest, 0.0, stiff_in_shear, xtol=1e-6)
    assert critical < 0.95 * stiff_in_shear

    def column(load):
        return rbsdem.Column(
            2 * length, 500.0, Elastic(k_v), Elastic(k_m), n=2, axial_load=load,
            kinematics="pdelta",
        )  # fmt: skip

    rbsdem.modes(column((1 - 1e-6) * critical))
    with pytest.raises(rbsdem.InputError, match="critical load"):
        rbsdem.modes(column((1 + 1e-6) * critical))


def test_no_tension_is_critical_for_one_body():
    column = rbsdem.Column(2.0, 800.0, ELASTIC, ELASTIC, axial_load=-1e12, kinematics="pdelta")
    assert np.all(np.isfinite(rbsdem.modes(column).omega))


@NEAR_CRITICAL
def test_two_bodies_buckle_in_tension_at_a_slider():
    """A dead load that pulls on two rods joined by a slider buckles them (E8: -P u_2 theta_1).

    The critical tension is where the determinant of K + K_G vanishes.
    """
    length, k_v, k_m = 0.8, 1.0e6, 3.0e6

    def smallest(load):
        k = np.diag([k_v, k_v, k_m, k_m]) + axial_stiffness([length, length], load, [])
        return np.linalg.eigvalsh(k)[0] / k_m

    critical = brentq(smallest, -1e8, 0.0, xtol=1e-6)

    def column(load):
        return rbsdem.Column(
            2 * length, 500.0, Elastic(k_v), Elastic(k_m), n=2, axial_load=load,
            kinematics="pdelta",
        )  # fmt: skip

    rbsdem.modes(column((1 - 1e-6) * critical))
    with pytest.raises(rbsdem.InputError, match="critical load"):
        rbsdem.modes(column((1 + 1e-6) * critical))


# ---- weight --------------------------------------------------------------------------------------


@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
def test_weight_of_one_body_is_half_of_it_at_the_top(kinematics):
    mass, gravity, load = 5.0e4, 9.81, 1.0e5
    springs = Elastic(4e6), Elastic(3e6)
    heavy = rbsdem.Column(
        2.0, mass, *springs, axial_load=load, kinematics=kinematics, self_weight=True,
        gravity=gravity,
    )  # fmt: skip
    loaded = rbsdem.Column(
        2.0, mass, *springs, axial_load=load + mass * gravity / 2, kinematics=kinematics
    )
    np.testing.assert_allclose(rbsdem.modes(heavy).omega, rbsdem.modes(loaded).omega, rtol=1e-13)


def test_weight_of_one_body_in_the_static_path():
    """k_M phi = F l + m g (l/2) phi."""
    mass, gravity, length, k_v, k_m = 5.0e4, 9.81, 2.0, 4e6, 3e6
    column = rbsdem.Column(
        length, mass, Elastic(k_v), Elastic(k_m), kinematics="pdelta",
        self_weight=True, gravity=gravity,
    )  # fmt: skip
    force = 1.0e4
    run = rbsdem.cyclic(column, force=[force])
    rotation = force * length / (k_m - mass * gravity * length / 2)
    assert run.rotation[0, 0] == pytest.approx(rotation, rel=1e-13)
    assert run.displacement[0] == pytest.approx(force / k_v + length * rotation, rel=1e-13)


def test_weight_of_three_bodies_is_the_second_order_potential():
    lengths, masses = np.array([0.9, 0.4, 0.7]), np.array([9e3, 2e3, 1.4e4])
    column = rbsdem.Column(
        2.0, None, elastic([2e6, 4e6, 3e6]), elastic([2e6, 1e6, 1.5e6]), n=3, lengths=lengths,
        masses=masses, kinematics="pdelta", self_weight=True, axial_load=5e4,
    )  # fmt: skip
    k = stiffness(column) + axial_stiffness(lengths, 5e4, masses * 9.80665)
    expected = np.sqrt(eigh(k, kinematic_mass(lengths, masses), eigvals_only=True))
    np.testing.assert_allclose(rbsdem.modes(column).omega, expected, rtol=1e-11)


def test_weight_does_nothing_without_second_order_work():
    springs = Elastic(4e6), Elastic(3e6)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="self_weight does nothing .*'pdelta'"):
        heavy = rbsdem.Column(2.0, 5e4, *springs, self_weight=True)
    light = rbsdem.Column(2.0, 5e4, *springs)
    assert np.array_equal(rbsdem.modes(heavy).omega, rbsdem.modes(light).omega)
    massless = rbsdem.Column(2.0, 5e4, *springs, self_weight=True, gravity=0.0, kinematics="pdelta")
    assert np.array_equal(rbsdem.modes(massless).omega, rbsdem.modes(light).omega)


# ---- bad input -----------------------------------------------------------------------------------

NAN, INF = float("nan"), float("inf")
GOOD = {"height": 1.6, "mass": 614.4, "shear": BILINEAR, "flexure": TAKEDA}

BAD = [
    ({"height": 0.0}, ["height", "0"]),
    ({"height": -1.6}, ["height", "-1.6"]),
    ({"height": NAN}, ["height", "NaN"]),
    ({"height": INF}, ["height", "Infinity"]),
    ({"height": "tall"}, ["height", "tall"]),
    ({"height": None}, ["height", "None"]),
    ({"mass": 0.0}, ["mass", "0"]),
    ({"mass": -5.0}, ["mass", "-5"]),
    ({"mass": NAN}, ["mass", "NaN"]),
    ({"mass": None}, ["mass", "missing"]),
    ({"mass": [1.0, 2.0]}, ["mass"]),
    ({"n": 0}, ["n = 0"]),
    ({"n": -3}, ["n = -3"]),
    ({"n": 2.0}, ["n = 2.0"]),
    ({"n": True}, ["n = True"]),
    ({"n": 10**6}, ["n = 1000000"]),
    ({"n": 10**12}, ["n = 1000000000000"]),
    ({"n": 2, "lengths": [1.6]}, ["lengths", "1", "n = 2"]),
    ({"n": 2, "lengths": [0.8, 0.9]}, ["lengths", "1.7", "1.6"]),
    ({"n": 2, "lengths": [1.7, -0.1]}, ["lengths(2)", "-0.1"]),
    ({"n": 2, "lengths": [0.0, 1.6]}, ["lengths(1)", "0"]),
    ({"n": 2, "lengths": [NAN, 1.6]}, ["lengths(1)", "NaN"]),
    ({"n": 2, "lengths": []}, ["lengths", "empty"]),
    ({"n": 2, "lengths": [[0.8, 0.8]]}, ["lengths", "(1, 2)"]),
    ({"n": 2, "lengths": "ab"}, ["lengths"]),
    ({"n": 2, "masses": [1.0, 2.0, 3.0]}, ["masses", "3", "n = 2"]),
    ({"n": 2, "masses": [1.0, 0.0]}, ["masses(2)", "0"]),
    ({"n": 2, "masses": [-1.0, 2.0]}, ["masses(1)", "-1"]),
    ({"n": 2, "masses": [INF, 2.0]}, ["masses(1)", "Infinity"]),
    ({"n": 2, "masses": []}, ["masses", "empty"]),
    ({"axial_load": NAN}, ["axial_load", "NaN"]),
    ({"axial_load": -INF}, ["axial_load", "-Infinity"]),
    ({"kinematics": "large"}, ["kinematics", "large", "small"]),
    ({"kinematics": "Small"}, ["kinematics", "Small"]),
    ({"kinematics": ""}, ["kinematics"]),
    ({"self_weight": 2}, ["self_weight = 2", "True or False"]),
    ({"self_weight": "no"}, ["self_weight = 'no'", "True or False"]),
    ({"axial_follows": True}, ["axial_follows", "finite"]),
    ({"force_follows": True, "kinematics": "pdelta"}, ["force_follows", "finite"]),
    ({"axial_follows": None}, ["axial_follows = None", "True or False"]),
    ({"top_mass": -1.0}, ["top_mass", "-1 kg"]),
    ({"top_mass": NAN}, ["top_mass", "NaN"]),
    ({"top_mass": "heavy"}, ["top_mass", "heavy"]),
    ({"top_inertia": INF}, ["top_inertia", "Infinity"]),
    ({"depth": -0.4}, ["depth", "-0.4 m"]),
    ({"depth": 0.4, "rotary_inertia": 3.0}, ["both depth and rotary_inertia"]),
    ({"rotary_inertia": 0.0}, ["rotary_inertia", "0 kg m2"]),
    ({"rotary_inertia": NAN}, ["rotary_inertia", "NaN"]),
    ({"rotary_inertia": "x"}, ["rotary_inertia"]),
    ({"rotary_inertia": []}, ["rotary_inertia", "empty"]),
    ({"rotary_inertia": [1.0, 2.0], "n": 3}, ["rotary_inertia has 2 values for n = 3"]),
    ({"axial_spring": 1e9}, ["axial_spring", "1000000000.0"]),
    ({"axial_spring": []}, ["axial_spring", "empty"]),
    ({"axial_spring": TAKEDA}, ["axial spring", "'takeda'"]),
    ({"axial_spring": [ELASTIC] * 2, "n": 3}, ["axial_spring has 2 springs for n = 3 joints"]),
    ({"shear": Compression(1e9)}, ["shear spring", "'compression'"]),
    ({"damping": "5 %"}, ["damping", "5 %"]),
    ({"damping": [0.1]}, ["damping", "[0.1]"]),
    ({"damping": 5.0}, ["damping: modal = 5", "below 1"]),
    ({"damping": -0.1}, ["damping: modal = -0.1", "negative"]),
    ({"damping": rbsdem.Damping(tangent=True)}, ["damping: tangent", "without stiffness"]),
    ({"damping": rbsdem.Damping(modal=[0.1] * 3)}, ["damping: modal has 3 values for 2 modes"]),
    ({"damping": 0.05, "n": 501}, ["modal damping", "500 bodies", "n = 501"]),
    ({"gravity": -9.81}, ["gravity", "-9.81"]),
    ({"gravity": NAN}, ["gravity", "NaN"]),
    ({"damping": rbsdem.Damping(-0.1)}, ["damping: mass", "-0.1"]),
    ({"damping": rbsdem.Damping(INF)}, ["damping: mass", "Infinity"]),
    ({"damping": rbsdem.Damping(stiffness=-1e-3)}, ["damping: stiffness", "-0.001"]),
    ({"damping": rbsdem.Damping(stiffness=NAN)}, ["damping: stiffness", "NaN"]),
    ({"shear": 7e8}, ["shear", "700000000.0"]),
    ({"shear": []}, ["shear", "empty"]),
    ({"shear": [BILINEAR, BILINEAR], "n": 3}, ["shear", "2", "3"]),
    ({"shear": [BILINEAR, None], "n": 2}, ["shear", "None"]),
    ({"flexure": None}, ["flexure", "None"]),
    ({"flexure": [TAKEDA, BILINEAR, TAKEDA], "n": 2}, ["flexur", "3", "2"]),
]


@pytest.mark.parametrize(("change", "words"), BAD, ids=[str(change) for change, _ in BAD])
def test_bad_column_is_refused_by_name(change, words):
    with pytest.raises(rbsdem.InputError) as caught:
        rbsdem.Column(**{**GOOD, **change})
    for word in words:
        assert word in str(caught.value)


def test_everything_wrong_with_a_column_is_told_at_once():
    with pytest.raises(rbsdem.InputError) as caught:
        rbsdem.Column(-1.0, NAN, ELASTIC, ELASTIC, n=0, axial_load=INF, kinematics="tiny")
    for word in ("height", "mass", "n = 0", "axial_load", "tiny"):
        assert word in str(caught.value)


@pytest.mark.parametrize("analysis", [rbsdem.modes, rbsdem.matrices, rbsdem.cyclic])
def test_what_is_no_column_is_refused(analysis):
    arguments = {"force": [1.0]} if analysis is rbsdem.cyclic else {}
    with pytest.raises(rbsdem.InputError, match="must be a Column"):
        analysis("column", **arguments)


def test_extreme_but_valid_columns():
    """From a needle to a tower: eq 6 holds, nothing overflows."""
    for length, mass, k in [(1e-6, 1e-9, 1e-3), (1e4, 1e12, 1e15), (1.0, 1e-12, 1e12)]:
        column = rbsdem.Column(length, mass, Elastic(k), Elastic(k * length**2))
        root = np.sqrt(1 + 1 / 3 + 1 / 9)
        scale = 6 * k / mass
        expected = scale * np.array([(1 / 3) / (4 / 3 + root), 4 / 3 + root])
        np.testing.assert_allclose(rbsdem.modes(column).omega ** 2, expected, rtol=1e-12)


def test_column_of_10000_bodies_is_the_largest():
    column = rbsdem.Column(20.0, 1e5, ELASTIC, ELASTIC, n=10_000)
    assert column.unknowns == 20_000
    with pytest.raises(rbsdem.InputError, match="from 1 to 10000"):
        rbsdem.Column(20.0, 1e5, ELASTIC, ELASTIC, n=10_001)


# ---- mass at the top, rotary inertia -------------------------------------------------------------


def lumped_mass(column: rbsdem.Column) -> np.ndarray:
    """Mass matrix of bodies and of what is lumped at the top, each with its own J and G."""
    lengths, masses = np.asarray(column.lengths), np.asarray(column.masses)
    n = len(lengths)
    total = kinematic_mass(lengths, masses)
    joints = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    top = np.concatenate([np.ones(n), lengths.sum() - joints])
    turn = np.concatenate([np.zeros(n), np.ones(n)])
    total += column.top_mass * np.outer(top, top) + column.top_inertia * np.outer(turn, turn)
    below = np.hstack([np.zeros((n, n)), np.tril(np.ones((n, n)))])
    if column.rotary_inertia is not None:
        own = np.broadcast_to(column.rotary_inertia, n) - masses * lengths**2 / 12
    else:
        own = masses * column.depth**2 / 12
    return total + below.T * own @ below


@pytest.mark.parametrize("n", [1, 2, 7])
def test_mass_matrix_with_lumped_mass_depth_and_rotary_inertia(n):
    rng = np.random.default_rng(30 + n)
    for options in (
        {"top_mass": 2e4},
        {"top_mass": 3e3, "top_inertia": 500.0},
        {"top_inertia": 800.0},
        {"depth": 0.7},
        {"rotary_inertia": 12.0, "top_mass": 1e3},
        {"rotary_inertia": rng.uniform(1.0, 50.0, n)},
    ):
        column = random_column(rng, n, **options)
        mass = rbsdem.matrices(column).mass
        np.testing.assert_allclose(mass, lumped_mass(column), rtol=1e-12)
        paper = rbsdem.matrices(column, form="paper").mass
        np.testing.assert_allclose(paper @ paper_transform(n), mass, rtol=1e-12)


def test_cantilever_with_a_heavy_top_is_the_oscillator_of_one_mass():
    """A bridge pier: omega^2 = k/M with k of shear and bending in series."""
    column = rbsdem.Column(6.0, 1.0, Elastic(4e8), Elastic(3e8), top_mass=5e5)
    stiffness_ = 1 / (1 / 4e8 + 36.0 / 3e8)
    assert rbsdem.modes(column).omega[0] ** 2 == pytest.approx(stiffness_ / 5e5, rel=1e-5)


# ---- damping -------------------------------------------------------------------------------------


def test_rayleigh_damping_has_its_ratio_at_both_frequencies():
    damping = rbsdem.Damping.rayleigh(0.05, 2.0, 11.0, tangent=True)
    for frequency in (2.0, 11.0):
        omega = 2 * np.pi * frequency
        ratio = damping.mass / (2 * omega) + damping.stiffness * omega / 2
        assert ratio == pytest.approx(0.05, rel=1e-14)
    assert damping.tangent
    assert damping.modal is None
    assert rbsdem.Damping.rayleigh(0.05, 11.0, 2.0, tangent=True) == damping


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((1.0, 2.0, 11.0), ["ratio = 1.0", "below 1"]),
        ((-0.1, 2.0, 11.0), ["ratio = -0.1"]),
        ((NAN, 2.0, 11.0), ["ratio = nan"]),
        ((0.05, 0.0, 11.0), ["frequency_1 = 0.0 Hz", "above zero"]),
        ((0.05, 2.0, INF), ["frequency_2 = inf"]),
        ((0.05, 2.0, NAN), ["frequency_2 = nan"]),
        ((0.05, 2.0, 2.0), ["both 2.0 Hz", "different"]),
        ((0.05, "a", 2.0), ["frequency_1 = 'a' must be a number"]),
    ],
)
def test_bad_rayleigh_damping_is_refused(arguments, words):
    with pytest.raises(rbsdem.InputError) as caught:
        rbsdem.Damping.rayleigh(*arguments)
    for word in words:
        assert word in str(caught.value)


@pytest.mark.parametrize(
    "arguments",
    [{"mass": "a"}, {"stiffness": None}, {"tangent": "yes"}, {"modal": "a"}, {"modal": []},
     {"modal": [[0.1]]}],
)  # fmt: skip
def test_bad_damping_is_refused_by_name(arguments):
    with pytest.raises(rbsdem.InputError, match=f"damping: {next(iter(arguments))}"):
        rbsdem.Damping(**arguments)


def test_damping_of_a_column_as_a_ratio_or_in_parts():
    ratio = rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC, damping=0.05)
    assert ratio.damping == rbsdem.Damping(modal=0.05)
    assert rbsdem.Damping(modal=np.array([0.1, 0.2])).modal == (0.1, 0.2)
    assert len({ratio, rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC, damping=0.05)}) == 1
