"""The static path: independent solutions, equilibrium, energy, limits.

Elastic columns below and beyond their critical load, and mechanisms, are proved in the Fortran
suite `static`.

`small`: the column is statically determinate, every force follows from the lateral force by hand.
`pdelta`: equilibrium is checked in the deformed state, joint by joint, to second order.
"""

from __future__ import annotations

import copy
import itertools
import re

import numpy as np
import pytest
import reference_springs
from scipy.optimize import brentq

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Layered, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

# Column 1 of table 3 (Soesianawati No 1).
SHEAR = Bilinear(7.0387e8, 1.2960e-4, 8.3185e6)
FLEXURE = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
HEIGHT, MASS = 1.6, 614.4


def paper_column(**options) -> rbsdem.Column:
    return rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE, **options)


def reference(spring):
    """The same spring by the independent method."""
    if isinstance(spring, Bilinear):
        return reference_springs.Bilinear(spring.k, spring.d_y, spring.k_post)
    return reference_springs.Takeda(
        spring.k_c, spring.d_c, spring.k_y, spring.d_y, spring.k_u, spring.b0, spring.b1,
        spring.inner,
    )  # fmt: skip


def random_springs(rng: np.random.Generator, n: int):
    """n shear and n flexural springs of yield forces near 1e5 N and 2e5 N m, none like another."""
    shear, flexure = [], []
    for i in range(n):
        yield_force = rng.uniform(0.7e5, 1.3e5)
        slip = 10 ** rng.uniform(-3.5, -2.5)
        shear.append(
            Bilinear(yield_force / slip, slip, rng.uniform(0.01, 0.3) * yield_force / slip)
        )
        crack = 10 ** rng.uniform(-4, -3)
        k_c = rng.uniform(0.4e5, 0.8e5) / crack
        flexure.append(
            Takeda(
                k_c,
                crack,
                rng.uniform(0.2, 0.4) * k_c,
                crack * rng.uniform(4, 10),
                rng.uniform(0.02, 0.1) * k_c,
                b0=rng.uniform(0, 0.5),
                b1=rng.uniform(0.1, 1),
                inner=("kc", "kr", "one")[i % 3],
            )
        )
    return shear, flexure


def random_column(seed: int, n: int, **options) -> rbsdem.Column:
    rng = np.random.default_rng(seed)
    shear, flexure = random_springs(rng, n)
    lengths = rng.uniform(0.3, 1.2, n)
    return rbsdem.Column(lengths.sum(), 500.0, shear, flexure, n=n, lengths=lengths, **options)


def random_history(seed: int, points: int, largest: float) -> np.ndarray:
    """Growing and shrinking reversals without exact returns."""
    rng = np.random.default_rng(seed)
    signs = np.where(np.arange(points) % 2 == 0, 1.0, -1.0)
    values = signs * largest * rng.uniform(0.05, 1.0, points) ** 1.5
    keep = rng.uniform(size=points) < 0.8  # some steps go on in the same direction
    return np.where(keep, values, -values)


def lengths_of(column: rbsdem.Column) -> np.ndarray:
    if column.lengths is None:
        return np.full(column.n, column.height / column.n)
    return np.asarray(column.lengths)


def arms(column: rbsdem.Column) -> np.ndarray:
    """Height of the top above each joint."""
    return np.cumsum(lengths_of(column)[::-1])[::-1]


def springs_of(column: rbsdem.Column):
    def several(springs):
        return list(springs) if isinstance(springs, tuple) else [springs] * column.n

    return several(column.shear), several(column.flexure)


def assert_equilibrium(run: rbsdem.Result, column: rbsdem.Column, rel: float = 1e-10) -> None:
    """Every row: shear across and moment about every joint, of everything above, deformed.

    Load P at the top: across the slip of joint i its component is P th_{i-1}; its lever arm about
    joint i is what the top is displaced beyond the joint, slips and rotations. F has the lever arm
    of the straight column (its change is of third order).
    """
    load = column.axial_load if column.kinematics == "pdelta" else 0.0
    theta = np.cumsum(run.rotation, axis=1)
    below = np.hstack([np.zeros((len(theta), 1)), theta[:, :-1]])
    swing = theta * lengths_of(column)
    for i in range(column.n):
        lever = swing[:, i:].sum(axis=1) + run.slip[:, i + 1 :].sum(axis=1)
        shear = run.force + load * below[:, i]
        moment = run.force * arms(column)[i] + load * lever
        assert np.max(np.abs(run.shear[:, i] - shear)) <= rel * np.max(np.abs(shear))
        assert np.max(np.abs(run.moment[:, i] - moment)) <= rel * np.max(np.abs(moment))
    top = run.slip.sum(axis=1) + swing.sum(axis=1)
    assert np.max(np.abs(run.displacement - top)) <= rel * np.max(np.abs(run.displacement))


def assert_energy(run: rbsdem.Result, rel: float = 1e-12) -> None:
    """Work of the force = spring work + potential of the load; work by the trapezoidal rule."""
    scale = max(np.max(np.abs(run.energy["spring"])), np.max(np.abs(run.energy["input"])))
    assert np.max(np.abs(run.energy["residual"])) <= rel * scale
    balance = run.energy["input"] - run.energy["spring"] - run.energy["axial"]
    assert np.max(np.abs(balance)) <= rel * scale
    assert not np.any(run.energy["kinetic"])
    assert not np.any(run.energy["damping"])


#: Linear kinematics are linear at any amplitude; that it is no longer true to life is told.
LARGE_ROTATIONS = pytest.mark.filterwarnings("default::rbsdem.errors.AccuracyWarning")


# ---- linear closed forms -------------------------------------------------------------------------


@pytest.mark.parametrize("n", [2, 5, 20])
def test_linear_column_is_a_sum_of_flexibilities(n):
    rng = np.random.default_rng(n)
    k_v, k_m, lengths = rng.uniform(1e6, 5e6, n), rng.uniform(1e6, 5e6, n), rng.uniform(0.2, 1, n)
    column = rbsdem.Column(
        lengths.sum(), 100.0, [Elastic(k) for k in k_v], [Elastic(k) for k in k_m],
        n=n, lengths=lengths,
    )  # fmt: skip
    arm = arms(column)
    run = rbsdem.cyclic(column, displacement=[0.02])
    force = 0.02 / np.sum(1 / k_v + arm**2 / k_m)
    assert run.force[0] == pytest.approx(force, rel=1e-13)
    np.testing.assert_allclose(run.slip[0], force / k_v, rtol=1e-13)
    np.testing.assert_allclose(run.rotation[0], force * arm / k_m, rtol=1e-13)


def test_axial_load_does_nothing_in_small():
    history = random_history(1, 30, 0.05)
    with pytest.warns(
        rbsdem.errors.AccuracyWarning, match="axial_load = 744000 N does nothing .*'pdelta'"
    ):
        column = paper_column(axial_load=7.44e5)
    loaded = rbsdem.cyclic(column, displacement=history)
    free = rbsdem.cyclic(paper_column(), displacement=history)
    assert np.array_equal(loaded.force, free.force)
    unloaded = rbsdem.cyclic(paper_column(kinematics="pdelta"), displacement=history)
    assert np.array_equal(unloaded.force, free.force)


# ---- one body, two nonlinear springs, against bracketing -----------------------------------------


def bracketed_path(shear, flexure, length, targets, load=0.0):
    """Driven by displacement: the slip at which both springs ask for the same force, by brentq.

    The springs are in series and none softens, so each goes one way from target to target; V(u) l
    + P (x - u) = M(phi) with phi = (x - u)/l. Springs by the independent method.
    """
    first, second = reference(shear), reference(flexure)
    u = x = 0.0
    path = []
    for target in targets:
        before = first, second

        def gap(slip, before=before, target=target):
            turned = (target - slip) / length
            moment = copy.deepcopy(before[1]).move(turned)
            return copy.deepcopy(before[0]).move(slip) * length + load * (target - slip) - moment

        ends = sorted([u, u + (target - x)])
        u = brentq(gap, *ends, xtol=1e-300, rtol=4 * np.finfo(float).eps, maxiter=300)
        x = target
        first, second = copy.deepcopy(first), copy.deepcopy(second)
        path.append((first.move(u), second.move((x - u) / length), u, (x - u) / length))
    return np.array(path).T


@pytest.mark.parametrize("seed", range(6))
def test_one_body_by_displacement_against_bracketing(seed):
    if seed == 0:
        column, largest = paper_column(), 0.06
    else:
        column, largest = random_column(seed, 1), 0.08
    targets = random_history(seed, 60, largest)
    run = rbsdem.cyclic(column, displacement=targets)
    springs = [several[0] for several in springs_of(column)]
    shear, moment, slip, rotation = bracketed_path(*springs, column.height, targets)
    for got, expected in (
        (run.force, shear),
        (run.force, moment / column.height),
        (run.slip[:, 0], slip),
        (run.rotation[:, 0], rotation),
    ):
        assert np.max(np.abs(got - expected)) < 1e-9 * np.max(np.abs(expected))
    assert_energy(run)


@pytest.mark.parametrize("seed", range(1, 4))
def test_one_body_pdelta_by_displacement_against_bracketing(seed):
    """A load below what the joint keeps after yield, so that nothing softens."""
    column = random_column(seed, 1)
    shear, flexure = (several[0] for several in springs_of(column))
    load = 0.2 * flexure.k_u / column.height
    loaded = random_column(seed, 1, axial_load=load, kinematics="pdelta")
    targets = random_history(seed, 60, 0.08)
    run = rbsdem.cyclic(loaded, displacement=targets)
    # P does no work on the slip of joint 1: V = F, M = F l + P l phi.
    force, moment, slip, rotation = bracketed_path(shear, flexure, column.height, targets, load)
    for got, expected in (
        (run.force, force),
        (run.moment[:, 0], moment),
        (run.slip[:, 0], slip),
        (run.rotation[:, 0], rotation),
    ):
        assert np.max(np.abs(got - expected)) < 1e-9 * np.max(np.abs(expected))
    assert_equilibrium(run, loaded)
    assert_energy(run)


def deformation_at(spring, forces):
    """Inverse of a spring along a history of forces, by brentq on the independent spring."""
    state, d = reference(spring), 0.0
    path = []
    for force in forces:
        way = 1.0 if force > state.f else -1.0
        reach = 1e-6
        while way * (copy.deepcopy(state).move(d + way * reach) - force) < 0:
            reach *= 2

        def gap(x, state=state, force=force):
            return copy.deepcopy(state).move(x) - force

        ends = sorted([d, d + way * reach])
        d = brentq(gap, *ends, xtol=1e-300, rtol=4 * np.finfo(float).eps, maxiter=300)
        state.move(d)
        path.append(d)
    return np.array(path)


@pytest.mark.parametrize("seed", range(4))
def test_one_body_by_force_each_spring_sees_its_force(seed):
    column = paper_column() if seed == 0 else random_column(seed, 1)
    shear, flexure = (several[0] for several in springs_of(column))
    largest = 1.15 * min(
        shear.k * shear.d_y,
        (flexure.k_c * flexure.d_c + flexure.k_y * (flexure.d_y - flexure.d_c)) / column.height,
    )
    forces = random_history(seed + 50, 50, largest)
    run = rbsdem.cyclic(column, force=forces)
    assert np.array_equal(run.force, forces)
    scale = np.max(np.abs(forces))
    assert np.max(np.abs(run.shear[:, 0] - forces)) < 1e-14 * scale
    assert np.max(np.abs(run.moment[:, 0] - forces * column.height)) < 1e-13 * scale * column.height
    slip, rotation = deformation_at(shear, forces), deformation_at(flexure, forces * column.height)
    assert np.max(np.abs(run.slip[:, 0] - slip)) < 1e-9 * np.max(np.abs(slip))
    assert np.max(np.abs(run.rotation[:, 0] - rotation)) < 1e-9 * np.max(np.abs(rotation))


# ---- any number of bodies ------------------------------------------------------------------------


@LARGE_ROTATIONS
@pytest.mark.parametrize("n", [1, 2, 5, 12])
@pytest.mark.parametrize("drive", ["displacement", "force"])
def test_small_column_is_statically_determinate(n, drive):
    """Shear F and moment F times the height above the joint; each spring on its own path."""
    column = random_column(10 + n, n)
    targets = random_history(n, 80, 0.1 * np.sqrt(n) if drive == "displacement" else 1.25e5)
    run = rbsdem.cyclic(column, **{drive: targets})
    assert np.array_equal(getattr(run, drive), targets)
    assert_equilibrium(run, column, rel=1e-12)
    assert_energy(run)
    # All joints go the way of the force: their springs see the rows as turning points.
    for i, (shear, flexure) in enumerate(zip(*springs_of(column), strict=True)):
        for spring, d, f in (
            (shear, run.slip[:, i], run.shear[:, i]),
            (flexure, run.rotation[:, i], run.moment[:, i]),
        ):
            again = np.array(reference(spring).response(d))
            assert np.max(np.abs(again - f)) < 1e-11 * np.max(np.abs(f))
    assert run.summary["events"] > 5 * n


def subdivided(targets, parts: int) -> np.ndarray:
    """The same path with `parts` steps to each target."""
    corners = np.concatenate([[0.0], targets])
    legs = [np.linspace(a, b, parts + 1)[1:] for a, b in itertools.pairwise(corners)]
    return np.concatenate(legs)


@pytest.mark.parametrize("n", [1, 3, 6])
def test_pdelta_springs_are_on_their_paths(n):
    """Rows so close that no spring turns unseen between them: each is on its rule's path."""
    column = random_column(40 + n, n, axial_load=2.0e5, kinematics="pdelta")
    targets = subdivided(random_history(n, 25, 0.1), 400)
    run = rbsdem.cyclic(column, displacement=targets)
    for i, (shear, flexure) in enumerate(zip(*springs_of(column), strict=True)):
        for spring, d, f in (
            (shear, run.slip[:, i], run.shear[:, i]),
            (flexure, run.rotation[:, i], run.moment[:, i]),
        ):
            again = np.array(reference(spring).response(d))
            assert np.max(np.abs(again - f)) < 1e-9 * np.max(np.abs(f))


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_weight_and_load_in_equilibrium(kinematics):
    """Self-weight of three heavy bodies: moment about each joint of every centroid, by hand."""
    masses = np.array([2.0e4, 1.0e4, 3.0e4])
    rng = np.random.default_rng(5)
    shear, flexure = random_springs(rng, 3)
    lengths = np.array([0.8, 0.5, 0.9])
    load, gravity = 5.0e4, 9.80665
    column = rbsdem.Column(
        lengths.sum(), None, shear, flexure, n=3, lengths=lengths, masses=masses,
        axial_load=load, self_weight=True, kinematics=kinematics,
    )  # fmt: skip
    run = rbsdem.cyclic(column, displacement=random_history(3, 60, 0.1))
    theta = np.cumsum(run.rotation, axis=1)
    x_top = np.cumsum(run.slip + lengths * theta, axis=1)
    x_bottom = x_top - lengths * theta  # of the body, above the slip of its joint
    x_centre = x_bottom + lengths / 2 * theta
    below = np.hstack([np.zeros((len(theta), 1)), theta[:, :-1]])
    second_order = 1.0 if kinematics == "pdelta" else 0.0
    for i in range(3):
        weight = masses[i:] * gravity
        shear_here = run.force + second_order * (load + weight.sum()) * below[:, i]
        overturning = load * (x_top[:, -1] - x_bottom[:, i])
        overturning += (x_centre[:, i:] - x_bottom[:, [i]]) @ weight
        moment = run.force * lengths[i:].sum() + second_order * overturning
        assert np.max(np.abs(run.shear[:, i] - shear_here)) < 1e-10 * np.max(np.abs(shear_here))
        assert np.max(np.abs(run.moment[:, i] - moment)) < 1e-10 * np.max(np.abs(moment))
    assert_energy(run)


# ---- limits --------------------------------------------------------------------------------------

PLASTIC = Bilinear(1.0e8, 1.0e-3, 0.0)


def reached(message: str) -> float:
    """The force that a message says was reached."""
    found = re.search(r"at force ([-+.e\d]+) N", message)
    assert found, message
    return float(found.group(1))


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_force_beyond_the_capacity_keeps_the_path(sign):
    column = rbsdem.Column(2.0, 100.0, PLASTIC, Elastic(5e8))
    capacity = 1.0e5
    forces = sign * np.array([0.5, -0.8, 0.9, 1.0 - 1e-9, 1.2, 0.3]) * capacity
    with pytest.raises(rbsdem.SolveError, match="shear spring of joint 1") as caught:
        rbsdem.cyclic(column, force=forces)
    assert reached(str(caught.value)) == pytest.approx(sign * capacity, rel=1e-5)
    assert "row 5" in str(caught.value)
    kept = caught.value.result
    np.testing.assert_allclose(kept.force, np.append(forces[:4], sign * capacity), rtol=1e-12)
    np.testing.assert_allclose(kept.displacement, kept.force * (1e-8 + 4 / 5e8), rtol=1e-12)
    np.testing.assert_allclose(kept.slip[-1], sign * 1e-3, rtol=1e-12)
    assert_energy(kept)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_a_joint_that_rocks_on_its_edge(kinematics):
    """Two contacts at b from the middle carry N: M = N b, so F = N (b - l sin(phi))/(l cos(phi)).

    On the edge k_1 (y_1 - s/a)^2 is round-off of zero, and was taken for a slope.
    """
    load, edge, height = 687e3, 0.2, 2.0
    contact = Compression(k=105981656.0)
    rock = Layered([(-edge, contact), (edge, contact)])
    column = rbsdem.Column(
        height, 500.0, Elastic(1e9), rock, axial_load=load, kinematics=kinematics
    )
    peaks = np.array([0.0362, -0.0362, 0.0423, -0.0423, 0.0454, -0.0454, 0.0497, -0.0497])
    run = rbsdem.cyclic(column, displacement=peaks)
    turn = run.rotation[:, 0]
    sine, cosine = {
        "small": (0.0 * turn, 1.0), "pdelta": (turn, 1.0), "finite": (np.sin(turn), np.cos(turn))
    }[kinematics]  # fmt: skip
    across = sine if kinematics == "finite" else turn
    np.testing.assert_allclose(run.slip[:, 0] + height * across, peaks, rtol=1e-10)
    force = load * (np.sign(peaks) * edge - height * sine) / (height * cosine)
    np.testing.assert_allclose(run.force, force, rtol=1e-9)
    if kinematics != "finite":
        assert_energy(run)


def test_capacity_itself_can_be_reached():
    column = rbsdem.Column(2.0, 100.0, PLASTIC, Elastic(5e8))
    run = rbsdem.cyclic(column, force=[1.0e5, -1.0e5, 1.0e5])
    np.testing.assert_allclose(run.displacement, run.force * (1e-8 + 4 / 5e8), rtol=1e-12)


def test_capacity_of_the_joint_that_is_named():
    """Plastic flexure of joint 2 of 3, weakest: F = k d_y / (height above it)."""
    weak, strong = Bilinear(1e8, 1e-3, 0.0), Elastic(1e9)
    column = rbsdem.Column(3.0, 100.0, strong, [strong, weak, strong], n=3)
    with pytest.raises(rbsdem.SolveError, match="flexural spring of joint 2") as caught:
        rbsdem.cyclic(column, force=[-1e6])
    assert reached(str(caught.value)) == pytest.approx(-1e5 / 2.0, rel=1e-5)
    assert caught.value.result.force.tolist() == pytest.approx([-1e5 / 2.0])


def test_plastic_column_by_displacement():
    """Force stays, the plastic joint takes all the motion, elastic unloading in between."""
    column = rbsdem.Column(2.0, 100.0, PLASTIC, Elastic(5e8))
    flexibility = 1e-8 + 4 / 5e8
    first = 1e5 * flexibility
    targets = np.array([0.5 * first, first, 0.05, 0.05 - first, 0.05 - 2 * first, -0.02])
    run = rbsdem.cyclic(column, displacement=targets)
    np.testing.assert_allclose(
        run.force, [0.5e5, 1e5, 1e5, 0.0, -1e5, -1e5], rtol=1e-12, atol=1e-12 * 1e5
    )
    np.testing.assert_allclose(run.rotation[:, 0], run.force * 2 / 5e8, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(run.slip[:, 0], targets - 2 * run.rotation[:, 0], rtol=1e-12)
    dissipated = 1e5 * (0.05 - first) + 1e5 * (0.05 - 2 * first + 0.02)
    assert run.energy["input"][-1] == pytest.approx(dissipated + 0.5e5 * first, rel=1e-12)
    assert_energy(run)


def softening_column(share: float, k_post: float = 2.0e6):
    """One body whose load takes `share` of the initial rotational stiffness, more than k_post."""
    length, k_v, k_m, phi_y = 1.6, 5.0e8, 1.0e8, 4.0e-3
    load = share * k_m / length
    column = rbsdem.Column(
        length, 100.0, Elastic(k_v), Bilinear(k_m, phi_y, k_post), axial_load=load,
        kinematics="pdelta",
    )  # fmt: skip
    peak = (k_m - load * length) * phi_y / length
    peak_displacement = peak / k_v + length * phi_y
    after = (k_post - load * length) / length  # dF/dphi
    slope = after / (length + after / k_v)
    return column, peak, peak_displacement, slope


def test_unloading_after_the_peak_is_elastic():
    """Back from beyond the peak along the initial stiffness, through zero force at a rest."""
    column, peak, at_peak, slope = softening_column(0.1)
    initial = peak / at_peak
    turn = 3 * at_peak
    force = peak + slope * (turn - at_peak)
    rest = turn - force / initial
    run = rbsdem.cyclic(column, displacement=[turn, rest, turn, 3.5 * at_peak])
    np.testing.assert_allclose(
        run.force, [force, 0.0, force, peak + slope * 2.5 * at_peak], rtol=1e-11, atol=1e-11 * peak
    )
    assert_energy(run)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_yielded_shear_unloads_where_the_force_begins_to_fall(sign):
    """Shear yields first, then flexure; P l > k_post, so the force falls and V goes back.

    With V on its yielded line the top would have to go back, (P l - k_post) > l^2 k_post_V, but V
    need not stay there: dx/dphi = l + (k_post - P l)/(l k_V) > 0 is the way on.
    """
    length, k_v, u_y, k_v_post = 1.6, 5.0e8, 2.0e-4, 1.0e6
    k_m, phi_y, k_m_post, load = 1.0e8, 4.0e-3, 2.0e6, 6.25e6
    column = rbsdem.Column(
        length, 100.0, Bilinear(k_v, u_y, k_v_post), Bilinear(k_m, phi_y, k_m_post),
        axial_load=load, kinematics="pdelta",
    )  # fmt: skip
    assert load * length - k_m_post > length**2 * k_v_post
    peak = (k_m - load * length) * phi_y / length
    slip = u_y + (peak - k_v * u_y) / k_v_post
    at_peak = slip + length * phi_y
    after = (k_m_post - load * length) / length
    rotation = phi_y + np.array([0.0, 0.001, 0.01])
    force = peak + after * (rotation - phi_y)
    top = slip + (force - peak) / k_v + length * rotation
    assert top[0] == pytest.approx(at_peak)
    run = rbsdem.cyclic(column, displacement=sign * top)
    np.testing.assert_allclose(run.force, sign * force, rtol=1e-11)
    np.testing.assert_allclose(run.rotation[:, 0], sign * rotation, rtol=1e-11)
    assert_equilibrium(run, column)
    assert_energy(run)


def path_by_trying(column: rbsdem.Column, targets):
    """Bilinear joints by displacement, P-Delta: at each corner all ways out are tried.

    Of every choice of elastic or yielded line for the springs at a corner the one is taken whose
    rates agree with it; there must be exactly one. Returns force and deformations at the targets.
    """
    n, length, arm = column.n, lengths_of(column), arms(column)
    springs = [spring for several in springs_of(column) for spring in several]
    elastic, corner, yielded = np.array([(s.k, s.d_y, s.k_post) for s in springs]).T
    geometric = np.zeros((2 * n, 2 * n))
    for k in range(n):
        theta = np.array([0.0] * n + [1.0] * (k + 1) + [0.0] * (n - k - 1))
        geometric -= column.axial_load * length[k] * np.outer(theta, theta)
        if k > 0:
            slip = np.eye(2 * n)[k]
            theta[n + k] = 0.0
            geometric -= column.axial_load * (np.outer(slip, theta) + np.outer(theta, slip))
    lever = np.concatenate([np.ones(n), arm])[:, None]
    q, plastic, x, force, path = np.zeros(2 * n), np.zeros(2 * n), 0.0, 0.0, []
    for target in targets:
        way = np.sign(target - x)
        while way * (target - x) > 1e-15:
            end = np.where(np.abs(q - plastic) >= corner * (1 - 1e-12), np.sign(q - plastic), 0)
            found = []
            for choice in itertools.product(*[(0, 1) if e else (0,) for e in end]):
                on = np.array(choice)
                stiffness = geometric + np.diag(np.where(on, yielded, elastic))
                matrix = np.block([[stiffness, -lever], [lever.T, np.zeros((1, 1))]])
                rate = np.linalg.solve(matrix, np.append(np.zeros(2 * n), way))
                if np.all((end == 0) | (on == (end * rate[:-1] > 0))):
                    found.append((on, rate))
            assert len(found) == 1, f"{len(found)} ways on at x = {x}"
            on, rate = found[0]
            ahead = plastic + np.sign(rate[:-1]) * corner
            room = np.where(on, np.inf, (ahead - q) / rate[:-1])
            step = min(way * (target - x), np.min(room))
            q, force, x = q + step * rate[:-1], force + step * rate[-1], x + way * step
            plastic = np.where(on, q - end * corner, plastic)
        path.append((force, *q))
    return np.array(path)


@pytest.mark.parametrize("n", [1, 2, 4])
@pytest.mark.parametrize("k_post", [1.0e6, 1.0e7])
def test_yielded_joints_beyond_the_peak_against_trying_all_ways(n, k_post):
    """Joints yield in shear, joint 1 yields in flexure, the force falls, shear unloads or not."""
    column = rbsdem.Column(
        1.6, 100.0, Bilinear(5.0e8, 2.0e-4, k_post), Bilinear(1.0e8, 4.0e-3, 2.0e6),
        n=n, axial_load=3.0e6, kinematics="pdelta",
    )  # fmt: skip
    targets = [0.004, -0.006, 0.05, 0.13 if n == 4 else 0.15, 0.12, 0.13]
    expected = path_by_trying(column, targets)
    run = rbsdem.cyclic(column, displacement=targets)
    assert_equilibrium(run, column)
    assert_energy(run)
    assert np.max(np.abs(run.force - expected[:, 0])) < 1e-10 * np.max(np.abs(expected[:, 0]))
    for got, wanted in ((run.slip, expected[:, 1 : n + 1]), (run.rotation, expected[:, n + 1 :])):
        assert np.max(np.abs(got - wanted)) < 1e-10 * np.max(np.abs(wanted))


def test_snap_back_is_told_and_the_path_kept():
    """P l - k_post > l^2 k_V with elastic shear: at the peak every way on moves the top back."""
    length, k_v, k_m, phi_y, k_m_post, load = 1.6, 1.0e6, 1.0e8, 4.0e-3, 2.0e6, 6.25e6
    column = rbsdem.Column(
        length, 100.0, Elastic(k_v), Bilinear(k_m, phi_y, k_m_post),
        axial_load=load, kinematics="pdelta",
    )  # fmt: skip
    peak = (k_m - load * length) * phi_y / length
    at_peak = peak / k_v + length * phi_y
    with pytest.raises(rbsdem.SolveError, match="snaps back") as caught:
        rbsdem.cyclic(column, displacement=[0.5 * at_peak, -0.3 * at_peak, 1.1 * at_peak])
    assert reached(str(caught.value)) == pytest.approx(peak, rel=1e-5)
    kept = caught.value.result
    np.testing.assert_allclose(kept.force, peak * np.array([0.5, -0.3, 1.0]), rtol=1e-11)
    assert kept.displacement[-1] == pytest.approx(at_peak, rel=1e-11)
    assert_energy(kept)


def test_takeda_column_of_the_paper_falls_under_its_load():
    """Column 1 with its axial load (table 2): P l > K_u, so the force falls after yield.

    Slopes by hand: dF/dphi = (K_u - P l)/l with a shear spring that stays elastic.
    """
    load = 744e3 * 10  # tenfold, for P l = 1.19e7 above K_u = 7.58e6
    column = paper_column(axial_load=load, kinematics="pdelta")
    f_y = FLEXURE.k_c * FLEXURE.d_c + FLEXURE.k_y * (FLEXURE.d_y - FLEXURE.d_c)
    peak = (f_y - load * HEIGHT * FLEXURE.d_y) / HEIGHT
    run = rbsdem.cyclic(column, displacement=np.linspace(0, 0.03, 301)[1:])
    yielded = run.rotation[:, 0] > FLEXURE.d_y
    slopes = np.diff(run.force[yielded]) / np.diff(run.rotation[yielded, 0])
    np.testing.assert_allclose(slopes, (FLEXURE.k_u - load * HEIGHT) / HEIGHT, rtol=1e-8)
    with pytest.raises(rbsdem.SolveError) as caught:
        rbsdem.cyclic(column, force=[2 * peak])
    assert caught.value.result.force[-1] == pytest.approx(peak, rel=1e-11)


# ---- degenerate input ----------------------------------------------------------------------------


def test_zero_increments_and_repeated_points():
    column = random_column(7, 3, axial_load=1e5, kinematics="pdelta")
    targets = random_history(7, 30, 0.08)
    plain = rbsdem.cyclic(column, displacement=targets)
    repeated = rbsdem.cyclic(
        column, displacement=np.concatenate([[0.0, 0.0], np.repeat(targets, 3)])
    )
    assert repeated.force[:2].tolist() == [0.0, 0.0]
    for k in range(3):
        assert np.array_equal(repeated.force[2 + k :: 3], plain.force)
        assert np.array_equal(repeated.slip[2 + k :: 3], plain.slip)
    assert rbsdem.cyclic(column, displacement=[0.0]).force.tolist() == [0.0]
    assert rbsdem.cyclic(column, force=[0.0, -0.0]).displacement.tolist() == [0.0, 0.0]


@pytest.mark.parametrize("scale", [1e-300, 1e-30, 1e-12, 1e-9])
def test_tiny_amplitudes_are_linear(scale):
    column = paper_column()
    stiffness = 1 / (1 / SHEAR.k + HEIGHT**2 / FLEXURE.k_c)
    targets = scale * np.array([1.0, -0.5, 0.25, -1.0])
    run = rbsdem.cyclic(column, displacement=targets)
    np.testing.assert_allclose(run.force, stiffness * targets, rtol=1e-12)


@LARGE_ROTATIONS
@pytest.mark.parametrize("scale", [1.0, 1e3, 1e9])
def test_huge_amplitudes_are_on_the_last_branch(scale):
    """Backbones: F = q_V + K_u u and F l = q_M + K_u phi."""
    column = paper_column()
    q_v = (SHEAR.k - SHEAR.k_post) * SHEAR.d_y
    f_y = FLEXURE.k_c * FLEXURE.d_c + FLEXURE.k_y * (FLEXURE.d_y - FLEXURE.d_c)
    q_m = f_y - FLEXURE.k_u * FLEXURE.d_y
    flexibility = 1 / SHEAR.k_post + HEIGHT**2 / FLEXURE.k_u
    start = -q_v / SHEAR.k_post - q_m * HEIGHT / FLEXURE.k_u
    targets = np.array([scale, 2 * scale, 3 * scale])
    run = rbsdem.cyclic(column, displacement=targets)
    np.testing.assert_allclose(run.force, (targets - start) / flexibility, rtol=1e-12)
    mirrored = rbsdem.cyclic(column, displacement=-targets)
    assert np.array_equal(mirrored.force, -run.force)


def test_small_steps_far_out_do_not_stop():
    """Steps of one unit in the last place, across an event."""
    column = rbsdem.Column(2.0, 100.0, Bilinear(1e8, 1e-3, 1e6), Elastic(5e8))
    at = 1e5 * (1e-8 + 4 / 5e8)
    targets = [at]
    for _ in range(20):
        targets.append(np.nextafter(targets[-1], 1.0))
    start = np.nextafter(at, 0.0)
    run = rbsdem.cyclic(column, displacement=[start, *targets, *targets[::-1], start])
    np.testing.assert_allclose(run.force, 1e5, rtol=1e-12)


def test_a_path_without_points_is_refused():
    column = paper_column(n=2)
    for drive in ("displacement", "force"):
        with pytest.raises(rbsdem.InputError, match=f"{drive} is empty; give at least one point"):
            rbsdem.cyclic(column, **{drive: []})


BAD = [
    ({}, "exactly one"),
    ({"displacement": [0.1], "force": [1.0]}, "exactly one"),
    ({"displacement": [0.1, float("nan")]}, "displacement: value 2 of 2 is NaN"),
    ({"force": [1.0, 2.0, float("inf")]}, "force: value 3 of 3 is Infinity"),
    ({"force": [-float("inf")]}, "force: value 1 of 1 is -Infinity"),
    ({"displacement": 0.1}, "displacement has shape ()"),
    ({"displacement": [[0.1, 0.2]]}, "displacement has shape (1, 2)"),
    ({"force": ["a"]}, "force must be an array of numbers"),
    ({"force": [1 + 2j]}, "force must be an array of numbers"),
    ({"force": [1.0, [2.0]]}, "force must be an array of numbers"),
    ({"force": [None]}, "force must be an array of numbers"),
    ({"force": [1.0], "every": 0}, "every = 0"),
    ({"force": [1.0], "every": 1.5}, "every = 1.5"),
    ({"force": [1.0], "every": -2}, "every = -2"),
]


@pytest.mark.parametrize(("arguments", "text"), BAD, ids=[text for _, text in BAD])
def test_bad_loading_is_refused(arguments, text):
    with pytest.raises(rbsdem.InputError, match=re.escape(text)):
        rbsdem.cyclic(paper_column(), **arguments)


def test_integers_and_slices_are_taken_as_they_are():
    column = paper_column()
    values = np.arange(-40000, 40000, 8000)
    expected = rbsdem.cyclic(column, force=values.astype(float)).displacement
    assert np.array_equal(rbsdem.cyclic(column, force=values).displacement, expected)
    strided = np.repeat(values.astype(float), 2)[::2]
    assert np.array_equal(rbsdem.cyclic(column, force=strided).displacement, expected)
    assert np.array_equal(rbsdem.cyclic(column, force=tuple(values)).displacement, expected)
