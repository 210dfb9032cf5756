"""Natural frequencies to all digits at the extremes, and the beam that the chain tends to.

Every frequency is certified: by Sylvester's law of inertia the number of frequencies below s is
the number of negative pivots of K - s^2 M, and with 120 digits these pivots leave no doubt. The
matrices are set up from the springs, apart from anything the program does.
"""

from __future__ import annotations

import re
from decimal import Decimal, localcontext

import numpy as np
import pytest
from reference_chain import chain
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import roots_jacobi

import rbsdem
from rbsdem.springs import Elastic

DIGITS = 120


def exact_count(column: rbsdem.Column, omega: Decimal) -> int:
    """Number of circular frequencies of slips and rotations below omega, in Decimals.

    Unknowns (x_1, th_1, x_2, th_2, ...): displacement of the centroid and rotation of every body.
    """
    n = column.n
    length = [Decimal(value) for value in column.lengths]
    mass = [Decimal(value) for value in column.masses]
    load = Decimal(column.axial_load) if column.kinematics != "small" else Decimal(0)
    matrix = [[Decimal(0)] * (2 * n) for _ in range(2 * n)]
    for i in range(n):
        slip = [(2 * i, Decimal(1)), (2 * i + 1, -length[i] / 2)]
        turn = [(2 * i + 1, Decimal(1))]
        if i > 0:
            slip += [(2 * i - 2, Decimal(-1)), (2 * i - 1, -length[i - 1] / 2)]
            turn += [(2 * i - 1, Decimal(-1))]
        for part, spring in (
            (slip, column.joints("shear")[i]),
            (turn, column.joints("flexure")[i]),
        ):
            for row, a in part:
                for place, b in part:
                    matrix[row][place] += Decimal(spring.k) * a * b
        # Potential of the load: -P (l th^2/2 + u th of the body below)
        matrix[2 * i + 1][2 * i + 1] -= load * length[i]
        if i > 0:
            for row, a in slip:
                matrix[row][2 * i - 1] -= load * a
                matrix[2 * i - 1][row] -= load * a
        matrix[2 * i][2 * i] -= omega**2 * mass[i]
        matrix[2 * i + 1][2 * i + 1] -= omega**2 * mass[i] * length[i] ** 2 / 12

    negative = 0
    for j in range(2 * n):
        pivot = matrix[j][j]
        negative += pivot < 0
        beside = range(j + 1, min(2 * n, j + 4))
        for row in beside:
            factor = matrix[row][j] / pivot
            for place in beside:
                matrix[row][place] -= factor * matrix[j][place]
    return negative


def certify(column: rbsdem.Column, tolerance: float) -> None:
    """Every frequency is within the relative tolerance of the exact one."""
    modes = rbsdem.modes(column)
    omega = modes.omega
    assert omega.shape == (2 * column.n,)
    share = modes.stable_step * omega[-1] / (2 * np.sqrt(2))
    assert share <= 1 + 1e-10
    assert share >= 1 - 1e-10 or column.kinematics != "small"
    with localcontext() as context:
        context.prec = DIGITS
        span = Decimal(tolerance)
        for i, value in enumerate(omega):
            exact = Decimal(float(value))
            assert exact_count(column, exact * (1 - span)) <= i, f"mode {i + 1} is too high"
            assert exact_count(column, exact * (1 + span)) >= i + 1, f"mode {i + 1} is too low"


def critical_load(build, sign=1.0) -> float:
    """Return the critical load that a column under far too much of it names; six digits."""
    with pytest.raises(rbsdem.InputError) as caught:
        rbsdem.modes(build(sign * 1e40))
    found = re.search(r"critical load of ([-+.e\d]+) N", str(caught.value))
    assert found, str(caught.value)
    return float(found.group(1))


@pytest.mark.parametrize("ratio", [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9])
@pytest.mark.parametrize("n", [1, 2, 3, 5, 10])
def test_frequencies_for_stiffness_ratios(n, ratio):
    """k_V l^2/k_M from 1e-9 to 1e9."""
    flexure = 2e7 * n
    shear = ratio * flexure / (2.0 / n) ** 2
    certify(chain([2.0 / n] * n, [100.0 / n] * n, [shear] * n, [flexure] * n), 1e-12)


@pytest.mark.parametrize("ratio", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize("n", [2, 3, 5, 10])
def test_frequencies_for_mass_ratios_of_neighbours(n, ratio):
    masses = [100.0 * ratio ** (i % 2) for i in range(n)]
    certify(chain([2.0 / n] * n, masses, [4e8 * n] * n, [2e7 * n] * n), 1e-12)


def random_extremes(random: np.random.Generator, **options) -> rbsdem.Column:
    """Return a chain with joints and bodies at random between the extremes, each on its own."""
    n = int(random.integers(2, 11))
    lengths = 10 ** random.uniform(-0.5, 0.5, n)
    masses = 10 ** random.uniform(-6, 6, n)
    flexure = 10 ** random.uniform(0, 18, n)
    shear = 10 ** random.uniform(0, 18, n) / lengths**2
    return chain(lengths, masses, shear, flexure, **options)


@pytest.mark.parametrize("seed", range(40))
def test_frequencies_with_everything_at_random(seed):
    certify(random_extremes(np.random.default_rng(seed)), 1e-9)


@pytest.mark.parametrize("share", [0.01, 0.5, 0.9, -0.1, -0.5, -0.9])
@pytest.mark.parametrize("seed", range(4))
def test_frequencies_under_axial_load_with_everything_at_random(seed, share):
    """Compression and tension, as a share of the critical load of the one or the other."""

    def build(load):
        random = np.random.default_rng(100 + seed)
        return random_extremes(random, kinematics="pdelta", axial_load=load)

    certify(build(abs(share) * critical_load(build, np.sign(share))), 1e-9)


@pytest.mark.parametrize("n", [1, 4, 30])
def test_shapes_are_orthonormal_and_satisfy_the_eigenproblem(n):
    """Row by row: k_i q_i = omega^2 (M q)_i, for stiffnesses six powers of ten apart."""
    random = np.random.default_rng(n)
    shear, flexure = 10 ** random.uniform(5, 11, (2, n))
    column = chain([2.0 / n] * n, [100.0 / n] * n, shear, flexure)
    modes = rbsdem.modes(column)
    mass = rbsdem.matrices(column).mass
    stiffness = np.concatenate([shear, flexure])
    np.testing.assert_allclose(modes.shapes.T @ mass @ modes.shapes, np.eye(2 * n), atol=1e-9)
    scale = np.sqrt(stiffness)[:, None]
    inner = (scale * modes.shapes) / modes.omega
    np.testing.assert_allclose(inner.T @ inner, np.eye(2 * n), atol=1e-12)


@pytest.mark.parametrize("top", ["free", "fixed"])
def test_the_first_modes_are_those_of_all_modes(top):
    """With openings, whose modes lie between the others."""
    stiff = Elastic(3e8)
    column = rbsdem.Column(
        3.0, 900.0, stiff, stiff, n=12, axial_spring=Elastic(2e9), axial_load=1e6,
        kinematics="pdelta", top=top, top_mass=50.0,
    )  # fmt: skip
    every = rbsdem.modes(column)
    for count in (1, 5, 1000):
        first = rbsdem.modes(column, count=count)
        m = min(count, every.omega.size)
        np.testing.assert_array_equal(first.omega, every.omega[:m])
        np.testing.assert_array_equal(first.shapes, every.shapes[:, :m])
    assert first.stable_step == every.stable_step
    with pytest.raises(rbsdem.InputError, match="count = 0"):
        rbsdem.modes(column, count=0)


@pytest.mark.parametrize("top", ["free", "fixed"])
@pytest.mark.parametrize("form", ["symmetric", "paper"])
def test_matrices_satisfy_the_eigenproblem_of_the_modes(form, top):
    """K + K_G and C = 2 zeta omega M too; the paper's unknowns are sums of the others."""
    stiff, zeta, n = Elastic(3e8), 0.04, 5
    column = rbsdem.Column(
        3.0, 900.0, stiff, stiff, n=n, axial_spring=Elastic(2e9), axial_load=1e6,
        kinematics="pdelta", top=top, top_mass=50.0, damping=zeta,
    )  # fmt: skip
    found = rbsdem.matrices(column, form)
    modes = rbsdem.modes(column)
    bodies = n + (top == "fixed")
    rotations = bodies - (top == "fixed")
    angle = "theta" if form == "paper" else "rotation"
    names = [f"slip_{j + 1}" for j in range(bodies)]
    names += [f"{angle}_{j + 1}" for j in range(rotations)]
    names += [f"opening_{j + 1}" for j in range(bodies)]
    assert found.unknowns == tuple(names)
    shapes = np.delete(modes.shapes, range(bodies + rotations, 2 * bodies), axis=0)
    if form == "paper":
        turned = slice(bodies, bodies + rotations)
        shapes[turned] = np.cumsum(shapes[turned], axis=0)
    inertia = found.mass @ shapes
    size = np.abs(inertia * modes.omega**2).max()
    np.testing.assert_allclose(
        (found.stiffness + found.geometric) @ shapes, inertia * modes.omega**2, atol=1e-12 * size
    )
    size = np.abs(inertia * modes.omega).max()
    np.testing.assert_allclose(
        found.damping @ shapes, 2 * zeta * inertia * modes.omega, atol=1e-12 * size
    )
    assert np.abs(found.geometric).max() > 0


def test_openings_are_modes_of_their_own():
    """A uniform chain in tension, fixed at its foot: 2 sqrt(k/m) sin((2 j - 1) pi/(4 n + 2))."""
    n, k, mass = 5, 3e9, 40.0
    plain, column = (
        rbsdem.Column(2.0, n * mass, Elastic(4e8), Elastic(2e8), n=n, axial_spring=spring)
        for spring in (None, Elastic(k))
    )
    modes = rbsdem.modes(column)
    j = np.arange(1, n + 1)
    own = 2 * np.sqrt(k / mass) * np.sin((2 * j - 1) * np.pi / (4 * n + 2))
    expected = np.sort(np.append(rbsdem.modes(plain).omega, own))
    np.testing.assert_allclose(modes.omega, expected, rtol=1e-13)
    mass_matrix = rbsdem.matrices(column).mass
    product = modes.shapes.T @ mass_matrix @ modes.shapes
    np.testing.assert_allclose(product, np.eye(3 * n), atol=1e-11)
    opens, bends = np.abs(modes.shapes[2 * n :]).max(axis=0), np.abs(modes.shapes[: 2 * n]).max(0)
    assert ((opens == 0) != (bends == 0)).all()


def test_the_stable_step_of_10000_bodies():
    """In the highest mode all bodies far from the ends rotate alike and slip back: k_V l^2/I."""
    n, k_v = 10_000, 1e21
    flexure = np.full(n, 1e6 * n / 2.0)
    flexure[0] *= 2
    column = chain([2.0 / n] * n, [100.0 / n] * n, [k_v] * n, flexure)
    modes = rbsdem.modes(column, count=1)
    lowest = 1.8751040687119611**2 * np.sqrt(1e6 / (100 * 8))
    assert modes.omega[0] == pytest.approx(lowest, rel=1e-8)
    highest = np.sqrt(12 * k_v * n / 100)
    assert modes.stable_step == pytest.approx(2 * np.sqrt(2) / highest, rel=1e-6)


HEIGHT, MASS, BENDING, SHEAR, DEPTH = 2.0, 800.0, 1.2e7, 2.5e8, 0.5


def beam_frequencies(
    number: int, shear: float = SHEAR, depth: float = DEPTH, top_mass: float = 0.0
) -> np.ndarray:
    """Circular frequencies of the Timoshenko cantilever with rotary inertia.

    State (x, th, M, V) along z: x' = th + V/kGA, th' = M/EI, M' = -V - rho I w^2 th,
    V' = -rho A w^2 x. Frequency equation: the motion that leaves foot clamped, and the top free
    or with a mass, V = m w^2 x.
    """
    line = MASS / HEIGHT

    def free_top(omega):
        matrix = np.zeros((4, 4))
        matrix[0, 1], matrix[0, 3] = 1.0, 1.0 / shear
        matrix[1, 2] = 1.0 / BENDING
        matrix[2, 3], matrix[2, 1] = -1.0, -line * depth**2 / 12 * omega**2
        matrix[3, 0] = -line * omega**2
        scale = np.array([1.0, 1.0 / HEIGHT, BENDING / HEIGHT**2, BENDING / HEIGHT**3])
        carried = expm(matrix * scale / scale[:, None] * HEIGHT)
        carried[3] -= top_mass * omega**2 / scale[3] * carried[0]
        return np.linalg.det(carried[2:, 2:])

    step = 0.3 * np.sqrt(BENDING / (line * HEIGHT**4))
    roots = []
    below = free_top(step)
    for i in range(2, 100000):
        above = free_top(i * step)
        if below * above < 0:
            roots.append(brentq(free_top, (i - 1) * step, i * step, xtol=1e-13, rtol=1e-14))
            if len(roots) == number:
                return np.array(roots)
        below = above
    raise AssertionError("too few frequencies")


def beam_chain(n: int, foot: float, shear: float = SHEAR, depth: float = DEPTH) -> rbsdem.Column:
    """Return n equal bodies, springs of a body's length; the foot's are `foot` times as stiff."""
    length = HEIGHT / n
    flexures, shears = np.full(n, BENDING / length), np.full(n, shear / length)
    flexures[0] *= foot
    shears[0] *= foot
    return chain([length] * n, [MASS / n] * n, shears, flexures, depth=depth)


@pytest.mark.parametrize(("foot", "order"), [(2.0, 2), (1.0, 1)])
@pytest.mark.parametrize(
    ("shear", "depth"), [(SHEAR, DEPTH), (1e13, 1e-3)], ids=["Timoshenko", "slender"]
)
def test_frequencies_of_a_chain_tend_to_those_of_the_beam(shear, depth, foot, order):
    """A joint between two bodies stands for half of each; the foot has only one half above it.

    With the foot's springs twice as stiff (half a body's length) the sums over joints are the
    trapezoidal rule for the integrals of M^2/EI and V^2/kGA: order 2; alike, order 1.
    """
    exact = beam_frequencies(3, shear, depth)
    bodies = np.array([25, 50, 100, 200])
    wrong = np.array(
        [rbsdem.modes(beam_chain(n, foot, shear, depth)).omega[:3] / exact - 1 for n in bodies]
    )
    orders = np.log2(np.abs(wrong[:-1] / wrong[1:]))
    np.testing.assert_allclose(orders[-1], order, atol=0.05)
    assert np.all(np.abs(wrong[-1]) < (1e-4 if order == 2 else 1e-2))


def test_chain_with_a_mass_at_the_top_tends_to_the_beam_with_order_2():
    """The half body at the top belongs to no joint: the highest shear spring takes its part."""
    top_mass, bodies = 5 * MASS, (25, 50, 100, 200)
    exact = beam_frequencies(2, top_mass=top_mass)
    soft = HEIGHT**3 / (3 * BENDING) + HEIGHT / SHEAR
    wrong = []
    for n in bodies:
        part = np.full(n, HEIGHT / n)
        part[0] /= 2
        shear_part = part.copy()
        shear_part[-1] *= 1.5
        column = chain(
            [HEIGHT / n] * n, [MASS / n] * n, SHEAR / shear_part, BENDING / part,
            depth=DEPTH, top_mass=top_mass, gravity=0.0,
        )  # fmt: skip
        deflection = rbsdem.cyclic(column, force=[1.0]).displacement[0]
        wrong.append([deflection / soft - 1, *(rbsdem.modes(column).omega[:2] / exact - 1)])
    wrong = np.abs(wrong)
    np.testing.assert_allclose(np.log2(wrong[:-1] / wrong[1:])[-1], 2.0, atol=0.05)
    assert np.all(wrong[-1] < 1e-4)


@pytest.mark.parametrize(("n", "close"), [(2, 1e-3), (3, 1e-4), (5, 5e-6), (20, 5e-7)])
def test_joints_at_gauss_radau_points_are_the_beam(n, close):
    """M^2 is a square along the height, which the rule integrates: stiffness to round-off."""
    x, w = roots_jacobi(n - 1, 0, 1)
    share = HEIGHT / 2 * np.append(2 / n**2, w / (1 + x))
    lengths = np.diff([0.0, *(HEIGHT / 2 * (1 + x)), HEIGHT])
    if n == 2:
        np.testing.assert_allclose(share, [HEIGHT / 4, 3 * HEIGHT / 4], rtol=1e-14)
    column = chain(
        lengths, MASS / HEIGHT * lengths, SHEAR / share, BENDING / share,
        depth=DEPTH, top_mass=15 * MASS, gravity=0.0,
    )  # fmt: skip
    deflection = rbsdem.cyclic(column, force=[1.0]).displacement[0]
    beam = HEIGHT**3 / (3 * BENDING) + HEIGHT / SHEAR
    assert deflection == pytest.approx(beam, rel=1e-13)
    exact = beam_frequencies(1, top_mass=15 * MASS)
    assert rbsdem.modes(column, count=1).omega == pytest.approx(exact, rel=close)


EULER = np.pi**2 * BENDING / (2 * HEIGHT) ** 2


def buckling_chain(n: int, load: float, shear: float, top: float) -> rbsdem.Column:
    """Return a chain like `beam_chain`, but the highest shear spring is `top` times as stiff."""
    length = HEIGHT / n
    flexures, shears = np.full(n, BENDING / length), np.full(n, shear / length)
    flexures[0] *= 2.0
    shears[-1] *= top
    return chain(
        [length] * n, [MASS / n] * n, shears, flexures, kinematics="pdelta", axial_load=load
    )


@pytest.mark.parametrize(("top", "order"), [(0.5, 2), (1.0, 1)])
def test_critical_load_with_shear_tends_to_haringx(top, order):
    """P (1 + P/kGA) = P_E, not Engesser's P (1/P_E + 1/kGA) = 1.

    A slip is across the body below it, so the shear force of the load is P times the rotation of
    the section, not of the axis: Haringx. The load slides joint i by the rotation of body i - 1;
    the lowest joint feels nothing and the highest rotation has no joint: order 1, or 2 if the
    highest joint stands for two bodies.
    """
    shear = 3 * EULER
    haringx = shear * (np.sqrt(1 + 4 * EULER / shear) - 1) / 2
    engesser = EULER / (1 + EULER / shear)
    assert haringx / engesser > 1.04
    wrong = [
        critical_load(lambda load, n=n: buckling_chain(n, load, shear, top)) / haringx - 1
        for n in (80, 160)
    ]
    assert np.log2(abs(wrong[0] / wrong[1])) == pytest.approx(order, abs=0.15)
    assert abs(wrong[-1]) < (1e-5 if order == 2 else 3e-3)
