"""The static path: limits, plateaus and contacts in closed form, refusals.

Equilibrium, energy and springs on their rules over random columns: `test_invariants.py`. Softening
springs: `test_softening.py`.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Layered

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)


def assert_energy(run: rbsdem.Result, rel: float = 1e-12) -> None:
    """Work of the force = spring work + potential of the load; work by the trapezoidal rule."""
    scale = max(np.max(np.abs(run.energy["spring"])), np.max(np.abs(run.energy["input"])))
    assert np.max(np.abs(run.energy["residual"])) <= rel * scale
    balance = run.energy["input"] - run.energy["spring"] - run.energy["axial"]
    assert np.max(np.abs(balance)) <= rel * scale
    assert not np.any(run.energy["kinetic"])
    assert not np.any(run.energy["damping"])


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


def test_capacity_of_the_joint_that_is_named():
    """Plastic flexure of joint 2 of 3, weakest: F = k d_y / (height above it)."""
    weak, strong = Bilinear(1e8, 1e-3, 0.0), Elastic(1e9)
    column = rbsdem.Column(3.0, 100.0, strong, [strong, weak, strong], n=3)
    with pytest.raises(rbsdem.SolveError, match="flexural spring of joint 2") as caught:
        rbsdem.cyclic(column, force=[-1e6])
    assert reached(str(caught.value)) == pytest.approx(-1e5 / 2.0, rel=1e-5)
    assert caught.value.result.force.tolist() == pytest.approx([-1e5 / 2.0])


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
    assert_energy(run)


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


@pytest.mark.parametrize("ratio", [1.0, 3.0])
def test_a_mechanism_of_joints_shares_the_motion_by_their_stiffness(ratio):
    """Joints of equal strength go on as if they hardened in proportion to their stiffness."""
    k, d = 7.0387e8, 1.296e-4
    shear = [Bilinear(k, d, 0.0), Bilinear(ratio * k, d / ratio, 0.0)]
    column = rbsdem.Column(1.6, 614.4, shear, Elastic(2.5428e8), n=2)
    run = rbsdem.cyclic(column, displacement=[0.01, 0.02])
    np.testing.assert_allclose(run.force, k * d, rtol=1e-12)
    share = np.array([ratio, 1.0]) / (1 + ratio)
    np.testing.assert_allclose(np.diff(run.slip, axis=0)[0], 0.01 * share, rtol=1e-10)


@pytest.mark.parametrize("n", range(1, 6))
def test_the_base_slips_on_a_plateau_under_an_axial_load(n):
    """Its row of K is zero, and K has no inverse; no other spring moves."""
    shear = [Bilinear(1e8, 1e-3, 0.0), *[Elastic(4e8)] * (n - 1)]
    column = rbsdem.Column(
        2.0, 300.0, shear, Elastic(2e8), n=n, axial_load=1e5, kinematics="pdelta"
    )
    run = rbsdem.cyclic(column, displacement=[0.01, 0.05])
    np.testing.assert_allclose(run.force, 1e5, rtol=1e-12)
    moved = np.hstack([run.slip, run.rotation])
    assert np.diff(moved[:, 0]) == pytest.approx(0.04, rel=1e-11)
    np.testing.assert_allclose(moved[1, 1:], moved[0, 1:], rtol=1e-9)


def test_a_force_that_is_that_of_yield_but_for_its_last_digits():
    """The spring stands on the end of its line, so the joints move the top a little farther."""
    k, d_y, nearly = 2.5428e8, 2.7183e-3, 1 - 5e-12
    column = rbsdem.Column(1.6, 614.4, Elastic(7e8), Bilinear(k, d_y, 7.5772e6))
    run = rbsdem.cyclic(column, force=np.array([0.5, nearly]) * k * d_y / 1.6)
    expected = nearly * k * d_y * (1.6 / k + 1 / (7e8 * 1.6))
    assert run.displacement[1] == pytest.approx(expected, rel=1e-12)


def leaning(k=1.0, k_v=1e13, **more) -> rbsdem.Column:
    """Return a column of height 1 with exact rotations."""
    return rbsdem.Column(
        1.0, 1.0, Elastic(k_v), **{"kinematics": "finite", "flexure": Elastic(k)} | more
    )


def driven_beyond(column: rbsdem.Column, match: str, **loads) -> rbsdem.Result:
    """Return the rows of a path that cannot be followed to its end."""
    with pytest.raises(rbsdem.SolveError, match=match) as caught:
        rbsdem.cyclic(column, **loads)
    return caught.value.result


@pytest.mark.parametrize(("name", "far"), [("force", 8.0), ("displacement", 0.8)])
def test_the_residual_of_the_energy_falls_with_the_fourth_power_of_the_rows(name, far):
    """An elastic beam of EI = 1 in three parts, bent far."""
    column = leaning(n=3, flexure=[Elastic(6.0), Elastic(3.0), Elastic(3.0)])
    residuals = []
    for rows in (320, 640, 1280):
        run = rbsdem.cyclic(column, **{name: far * np.arange(1, rows + 1) / rows})
        residuals.append(abs(run.energy["residual"][-1] / run.energy["input"][-1]))
    assert 1e-12 < residuals[0] < 1e-4
    assert residuals[0] / residuals[1] > 14
    assert residuals[1] / residuals[2] > 14


def test_a_smooth_peak_of_the_force():
    """Soft axial springs: the column gets longer as it leans."""
    column = leaning(
        n=2, flexure=[Elastic(0.66), Elastic(10.0)], lengths=[0.95, 0.05], axial_load=1.0,
        axial_spring=Elastic(2.5),
    )  # fmt: skip
    force = rbsdem.cyclic(column, displacement=0.002 * np.arange(1, 301)).force
    assert 10 < force.argmax() < 290
    kept = driven_beyond(column, "beyond the capacity of the column",
                         force=np.array([0.5, 1.1]) * force.max())  # fmt: skip
    assert kept.force[-1] == pytest.approx(force.max(), rel=1e-5)


def test_a_driven_top_moves_as_far_as_the_column_can_follow():
    """P l above k_M: x = l sin(th) + F/k_V has a maximum."""
    column = leaning(k_v=10.0, axial_load=3.0)
    th = np.linspace(0, np.pi / 2, 100002)[1:-1]
    farthest = (np.sin(th) + (th - 3 * np.sin(th)) / np.cos(th) / 10).max()
    kept = driven_beyond(column, "row 3: no equilibrium was found beyond force",
                         displacement=[0.3, 0.99 * farthest, 1.01 * farthest])  # fmt: skip
    assert kept.time.size == 3
    assert kept.displacement[-1] == pytest.approx(farthest, rel=1e-8)
    both = rbsdem.cyclic(column, displacement=[0.99 * farthest, -0.99 * farthest]).force
    assert both[1] == pytest.approx(-both[0], rel=1e-10)


def test_the_force_at_the_critical_load_begins_with_the_third_power():
    column = leaning(k_v=100.0, axial_load=1.0)
    driven_beyond(column, "critical load", force=[0.1])
    force = rbsdem.cyclic(column, displacement=[0.01]).force[0]
    assert force == pytest.approx(0.01**3 / 6, rel=1e-3)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_an_axial_spring_yields_before_the_path_starts(kinematics):
    """The energy balance begins with springs in equilibrium beyond yield."""
    springs = [Bilinear(1e8, 1.1e-3, 1e7), Bilinear(1e8, 1.5e-3, 1e7)]
    column = rbsdem.Column(
        2.0, None, Elastic(4e8), Elastic(2e8), n=2, masses=[1e3, 2e3], axial_spring=springs,
        axial_load=1e5, self_weight=True, kinematics=kinematics,
    )  # fmt: skip
    g = 9.80665
    opening = np.array([-1.1e-3 - (3e3 * g - 1e4) / 1e7, -(1e5 + 2e3 * g) / 1e8])
    run = rbsdem.cyclic(column, displacement=[0.0, 1e-4])
    np.testing.assert_allclose(run.opening[0], opening, rtol=1e-12)
    np.testing.assert_allclose(run.opening[1], opening, rtol=1e-6)
    assert run.top[0, 1] == pytest.approx(2 + opening.sum(), rel=1e-14)
    assert run.summary["energy_residual"] < 1e-9 * run.energy["input"][1]
    fallen = 1e5 * opening.sum() + g * (1e3 * opening[0] + 2e3 * opening.sum())
    assert run.energy["axial"][0] == pytest.approx(fallen, rel=1e-12)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_a_joint_that_cannot_carry_tension_is_named(kinematics):
    for springs, told in (
        (Compression(1e8), r"joint 1 \(rule 'compression'\) cannot carry the tension of 500 N"),
        ([Elastic(1e8), Bilinear(1e8, 4e-6, 0.0)], r"joint 2 \(rule 'bilinear'\)"),
    ):
        column = leaning(n=2, axial_load=-500.0, axial_spring=springs, kinematics=kinematics)
        driven_beyond(column, "the axial spring of " + told, displacement=[1e-4])


def test_the_work_of_a_load_on_tiny_rotations_has_no_cancellation():
    """1 - cos(1e-9) is lost beside 1; to second order both levels are the same."""
    works = [
        rbsdem.cyclic(
            rbsdem.Column(2.0, 400.0, Elastic(4e8), Elastic(2e8), n=5, kinematics=level,
                          axial_load=1e5, self_weight=True),
            displacement=[1e-9],
        ).energy["axial"][0]
        for level in ("pdelta", "finite")
    ]  # fmt: skip
    assert works[1] == pytest.approx(works[0], rel=1e-12)
