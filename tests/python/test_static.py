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
