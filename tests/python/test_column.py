"""The column: matrices, modes, stable step, axial load, and what it refuses.

Matrices and critical loads once more: `reference_chain.Linear`.
"""

from __future__ import annotations

import numpy as np
import pytest
from reference_chain import Linear
from scipy.linalg import eigh

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

ELASTIC = Elastic(1.0e6)
BILINEAR = Bilinear(7.0387e8, 1.2960e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)


def random_column(rng: np.random.Generator, n: int, **options) -> rbsdem.Column:
    """Bodies and joints that differ by factors of up to 30."""

    def spread(middle):
        return middle * 10 ** rng.uniform(-0.75, 0.75, n)

    lengths = spread(0.5)
    shear, flexure = ([Elastic(k) for k in spread(middle)] for middle in (5e8, 2e8))
    given = {"masses": spread(300.0)} | options
    return rbsdem.Column(
        lengths.sum(), given.pop("mass", None), shear, flexure, n=n, lengths=lengths, **given
    )


@pytest.mark.parametrize("n", [1, 2, 7, 20])
def test_mass_matrix_in_both_forms_is_that_of_the_kinematics(n):
    """theta of the paper is the cumulative sum of phi."""
    rng = np.random.default_rng(100 + n)
    transform = np.eye(2 * n)
    transform[n:, n:] = np.tril(np.ones((n, n)))
    for options in (
        {},
        {"mass": 900.0, "masses": None},  # spread in proportion to the lengths
        {"top_mass": 2e4},
        {"top_mass": 3e3, "top_inertia": 500.0},
        {"depth": 0.7},
        {"rotary_inertia": 12.0, "top_mass": 1e3},
        {"rotary_inertia": rng.uniform(1.0, 50.0, n)},
    ):
        column = random_column(rng, n, **options)
        symmetric = rbsdem.matrices(column).mass
        paper = rbsdem.matrices(column, form="paper").mass
        # All entries are sums of positive terms: entry by entry to round-off.
        np.testing.assert_allclose(symmetric, Linear(column).mass, rtol=1e-12)
        np.testing.assert_allclose(paper @ transform, symmetric, rtol=1e-12)
        assert np.array_equal(symmetric, symmetric.T)


def test_mass_matrix_of_one_body_is_that_of_eq_5():
    column = rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC)
    m, l = 614.4, 1.6  # noqa: E741
    expected = [[m, m * l / 2], [m * l / 2, m * l**2 / 12 + m * l**2 / 4]]
    for form in ("symmetric", "paper"):
        np.testing.assert_allclose(rbsdem.matrices(column, form).mass, expected, rtol=1e-15)


def test_modes_of_a_bilinear_and_takeda_column_are_those_of_the_initial_stiffness():
    nonlinear = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=3)
    linear = rbsdem.Column(1.6, 614.4, Elastic(7.0387e8), Elastic(2.5428e8), n=3)
    assert np.array_equal(rbsdem.modes(nonlinear).omega, rbsdem.modes(linear).omega)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
@pytest.mark.parametrize("n", [1, 2, 5])
@pytest.mark.parametrize("load", [-2.0e5, 1.0e5])
@pytest.mark.parametrize("weight", [False, True])
def test_modes_under_load_and_weight_are_those_of_the_second_order_potential(
    n, load, kinematics, weight
):
    column = rbsdem.Column(
        np.linspace(0.4, 0.8, n).sum(),
        None,
        [Elastic(k) for k in np.linspace(4e6, 2e6, n)],
        [Elastic(k) for k in np.linspace(3e6, 2e6, n)],
        n=n,
        lengths=np.linspace(0.4, 0.8, n),
        masses=np.linspace(9e3, 2e3, n),
        axial_load=load,
        kinematics=kinematics,
        self_weight=weight,
    )
    linear = Linear(column)
    expected = np.sqrt(eigh(linear.stiffness, linear.mass, eigvals_only=True))
    modes = rbsdem.modes(column)
    np.testing.assert_allclose(modes.omega, expected, rtol=1e-11)
    np.testing.assert_allclose(modes.frequency, modes.omega / (2 * np.pi), rtol=1e-15)


def test_cantilever_with_a_heavy_top_is_the_oscillator_of_one_mass():
    """A bridge pier: omega^2 = k/M with k of shear and bending in series."""
    column = rbsdem.Column(6.0, 1.0, Elastic(4e8), Elastic(3e8), top_mass=5e5)
    stiffness = 1 / (1 / 4e8 + 36.0 / 3e8)
    assert rbsdem.modes(column).omega[0] ** 2 == pytest.approx(stiffness / 5e5, rel=1e-5)


def test_extreme_but_valid_columns():
    """From a needle to a tower: eq 6 holds, nothing overflows."""
    for length, mass, k in [(1e-6, 1e-9, 1e-3), (1e4, 1e12, 1e15), (1.0, 1e-12, 1e12)]:
        column = rbsdem.Column(length, mass, Elastic(k), Elastic(k * length**2))
        root = np.sqrt(1 + 1 / 3 + 1 / 9)
        expected = 6 * k / mass * np.array([(1 / 3) / (4 / 3 + root), 4 / 3 + root])
        np.testing.assert_allclose(rbsdem.modes(column).omega ** 2, expected, rtol=1e-12)


def boundary(eigenvalues: np.ndarray) -> float:
    """First step of RK4 at which a mode grows, by scanning and halving."""

    def grows(h):
        z = eigenvalues * h
        return np.any(np.abs(1 + z + z**2 / 2 + z**3 / 6 + z**4 / 24) > 1 + 1e-11)

    steps = np.linspace(0, 4 / np.max(np.abs(eigenvalues)), 4001)[1:]
    first = next(i for i, h in enumerate(steps) if grows(h))
    below, above = steps[first] - steps[0], steps[first]
    for _ in range(60):
        middle = 0.5 * (below + above)
        below, above = (below, middle) if grows(middle) else (middle, above)
    return below


def boundary_of(column: rbsdem.Column, softening: float = 0.0) -> float:
    """The same of a column, whose springs have lost a share of their stiffness."""
    linear = Linear(column)
    linear.stiffness = linear.stiffness - softening * np.diag(linear.k)
    return boundary(np.linalg.eigvals(linear.matrix))


@pytest.mark.parametrize("ratio", [1e-4, 0.01, 0.1, 0.3, 0.7, 0.99, 1.01, 3.0])
@pytest.mark.parametrize("kind", ["mass", "stiffness", "both"])
def test_stable_step_with_damping_is_the_numerical_boundary(ratio, kind):
    """`ratio` is the damping ratio of the highest mode."""
    for n in (1, 3):
        omega = rbsdem.modes(random_column(np.random.default_rng(50 + n), n)).omega[-1]
        mass, spring = {"mass": (1, 0), "stiffness": (0, 1), "both": (0.5, 0.5)}[kind]
        damping = rbsdem.Damping(2 * ratio * omega * mass, 2 * ratio / omega * spring)
        damped = random_column(np.random.default_rng(50 + n), n, damping=damping)
        assert rbsdem.modes(damped).stable_step == pytest.approx(boundary_of(damped), rel=1e-6)


@pytest.mark.parametrize("ratio", [0.0, 0.02, 0.1, 0.3, 0.7])
@pytest.mark.parametrize("share", [-20.0, -1.0, 0.5, 0.99])
def test_stable_step_is_safe_for_one_body_with_an_axial_load(ratio, share):
    """Never beyond the boundary of the damped column under its load; `share` of the critical one.

    The damping stays that of the springs alone, whatever the load makes of the frequencies.
    """
    springs = Elastic(2e6), Elastic(2e6)
    omega = rbsdem.modes(rbsdem.Column(2.0, 500.0, *springs)).omega[-1]
    loaded = rbsdem.Column(
        2.0, 500.0, *springs, kinematics="pdelta", axial_load=share * 2e6 / 2.0,
        damping=rbsdem.Damping(mass=0.1, stiffness=2 * ratio / omega),
    )  # fmt: skip
    assert rbsdem.modes(loaded).stable_step <= boundary_of(loaded) * (1 + 1e-6)


def edge(omega: float, c: float) -> float:
    """Return the boundary of q'' + c q' + omega^2 q = 0."""
    far = -(c / 2 + np.emath.sqrt(c**2 / 4 - omega**2))
    return boundary(np.array([far, omega**2 / far]))


@pytest.mark.filterwarnings("ignore:column. axial_load")
def test_the_stable_step_with_damping_of_modes():
    """One ratio and elastic springs: one mode of the highest frequency.

    Otherwise the radius 2.615587 of a half disc over the highest frequency, for ratios to one half.
    """
    zeta, n = 0.3, 4

    def step_of(modal, flexure=None, **damping):
        springs = Elastic(4e8), flexure or Elastic(2e8)
        given = {"kinematics": "pdelta", "axial_load": -1e6}
        damping = rbsdem.Damping(modal=modal, **damping)
        return rbsdem.modes(rbsdem.Column(2.0, 300.0, *springs, n=n, damping=damping, **given))

    modes = step_of([zeta])
    highest = modes.omega[-1]
    assert modes.stable_step == pytest.approx(edge(highest, 2 * zeta * highest), rel=1e-10)
    for other in (
        step_of([zeta, 0.1]), step_of([zeta], mass=1.0), step_of([zeta], Bilinear(2e8, 1e-3, 0.0))
    ):  # fmt: skip
        assert other.stable_step * highest == pytest.approx(2.615587, rel=1e-3)


def test_damping_of_the_present_stiffness_ends_with_that_stiffness():
    """When springs yield, their initial damping -c remains, that of the present one does not."""
    yields = Bilinear(7.0387e8, 1.296e-4, 8.3185e6), Bilinear(2.5428e8, 3.2e-4, 7.6e6)
    for tangent in (False, True):
        damping = rbsdem.Damping(stiffness=7e-4, tangent=tangent)
        modes = rbsdem.modes(rbsdem.Column(1.6, 614.4, *yields, damping=damping))
        c = 7e-4 * modes.omega[1] ** 2
        expected = edge(modes.omega[1], c) if tangent else 2.785293563405282 / c
        assert modes.stable_step == pytest.approx(expected, rel=1e-6 if tangent else 1e-12)
    assert modes.stable_step * c > 2.79


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.75, 1.0, 2.0])
@pytest.mark.parametrize("n", [1, 3])
def test_stable_step_is_safe_for_springs_that_yield(n, ratio):
    """Stiffness damping is that of the initial stiffness and stays when a spring yields.

    Softened to nothing, a mode of damping c = 2 ratio omega has the eigenvalue -c, which is further
    out than any of the virgin column if ratio = 1 (-omega, twice): its boundary is half as long.
    """
    linear = random_column(np.random.default_rng(70 + n), n)
    damping = rbsdem.Damping(stiffness=2 * ratio / rbsdem.modes(linear).omega[-1])
    linear = random_column(np.random.default_rng(70 + n), n, damping=damping)
    shear, flexure = (
        [Bilinear(spring.k, 1e-3, 1e-3 * spring.k) for spring in linear.joints(name)]
        for name in ("shear", "flexure")
    )
    yielding = rbsdem.Column(
        linear.height, None, shear, flexure, n=n, lengths=linear.lengths, masses=linear.masses,
        damping=damping,
    )  # fmt: skip
    step = rbsdem.modes(yielding).stable_step
    for softening in (0.0, 0.1, 0.5, 0.9, 0.999):
        assert step <= boundary_of(linear, softening) * (1 + 1e-6)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
@pytest.mark.parametrize(
    ("n", "k_v", "share"),
    [
        (1, 7e8, 1.0),  # k_M/l
        (2, 1e16, (3 - np.sqrt(5)) / 2),  # the smaller root of 1/c = eigenvalue of [[2, 1], [1, 1]]
        (2, 5e6, None),  # slip of joint 2 belongs to the lever arm (E8)
        (2, -1e6, None),  # a dead load that pulls on two rods joined by a slider buckles them
    ],
)
def test_critical_load(n, k_v, share):
    length, k_m = 0.8, 3e6

    def column(load):
        return rbsdem.Column(
            n * length, 500.0, Elastic(abs(k_v)), Elastic(k_m), n=n, axial_load=load,
            kinematics="pdelta",
        )  # fmt: skip

    linear = Linear(column(0.0))
    critical = linear.critical_load()
    if k_v < 0:
        second = linear.leaning(1.0, np.zeros(n))
        critical = 1 / eigh(second, linear.stiffness, eigvals_only=True)[0]
        assert critical < 0
    if share is not None:
        assert critical == pytest.approx(share * k_m / length, rel=1e-9)
    # The square of the first frequency falls to zero in proportion to what is left.
    squares = [rbsdem.modes(column(s * critical)).omega[0] ** 2 for s in (1 - 1e-4, 1 - 1e-6)]
    assert squares[0] / squares[1] == pytest.approx(100, rel=1e-3)
    rbsdem.modes(column((1 - 1e-9) * critical))
    with pytest.raises(rbsdem.InputError, match="critical load"):
        rbsdem.modes(column((1 + 1e-9) * critical))


def test_no_tension_is_critical_for_one_body():
    column = rbsdem.Column(2.0, 800.0, ELASTIC, ELASTIC, axial_load=-1e12, kinematics="pdelta")
    assert np.all(np.isfinite(rbsdem.modes(column).omega))


def test_weight_does_nothing_without_second_order_work():
    springs = Elastic(4e6), Elastic(3e6)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="self_weight does nothing .*'pdelta'"):
        rbsdem.Column(2.0, 5e4, *springs, self_weight=True)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="axial_load = 7.* does nothing"):
        rbsdem.Column(2.0, 5e4, *springs, axial_load=7.44e5)
    massless = rbsdem.Column(2.0, 5e4, *springs, self_weight=True, gravity=0.0, kinematics="pdelta")
    light = rbsdem.Column(2.0, 5e4, *springs)
    assert np.array_equal(rbsdem.modes(massless).omega, rbsdem.modes(light).omega)


def test_rayleigh_damping_has_its_ratio_at_both_frequencies():
    damping = rbsdem.Damping.rayleigh(0.05, 2.0, 11.0, tangent=True)
    for frequency in (2.0, 11.0):
        omega = 2 * np.pi * frequency
        ratio = damping.mass / (2 * omega) + damping.stiffness * omega / 2
        assert ratio == pytest.approx(0.05, rel=1e-14)
    assert damping.tangent
    assert damping.modal is None
    assert rbsdem.Damping.rayleigh(0.05, 11.0, 2.0, tangent=True) == damping


def test_damping_of_a_column_as_a_ratio_or_in_parts():
    ratio = rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC, damping=0.05)
    assert ratio.damping == rbsdem.Damping(modal=0.05)
    assert rbsdem.Damping(modal=np.array([0.1, 0.2])).modal == (0.1, 0.2)
    assert len({ratio, rbsdem.Column(1.6, 614.4, ELASTIC, ELASTIC, damping=0.05)}) == 1
