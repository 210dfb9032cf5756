"""Columns whose springs lose strength: static path past the cap, snap-back, response in time.

Closed forms: springs in series under one force. Past the cap of one spring the others unload.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Elastic, PeakOriented, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

LENGTH, MASS, K_SHEAR = 2.0, 1e3, 5e7
# In moments and rotations: stiffness 1e8, cap at (0.01, 240e3), softening -4e6 to 40e3 at 0.06.
FLEXURE = PeakOriented(2e-3, 200e3, 0.01, 240e3, 0.06, 40e3)
SOFTENING = -240e3 / 0.06


def column(flexure=FLEXURE, shear=None, **keywords) -> rbsdem.Column:
    return rbsdem.Column(LENGTH, MASS, shear or Elastic(K_SHEAR), flexure, **keywords)


def backbone(turn):
    return np.interp(turn, [0, 2e-3, 0.01, 0.06], [0, 200e3, 240e3, 40e3])


@pytest.mark.parametrize("load", [0.0, 500e3])
@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_path_past_the_cap(kinematics, load):
    """One body: moment of force and load about the joint, on the backbone; the slip is elastic."""
    turns = np.array([1e-3, 2e-3, 6e-3, 0.01, 0.02, 0.04, 0.055, 0.08])
    if kinematics == "finite":
        lever, height = LENGTH * np.cos(turns), LENGTH * np.sin(turns)
        force = (backbone(turns) - load * height) / lever
        top = height + force / K_SHEAR
    else:
        load = 0.0 if kinematics == "small" else load
        force = backbone(turns) / LENGTH - load * turns
        top = force / K_SHEAR + LENGTH * turns
    result = rbsdem.cyclic(column(kinematics=kinematics, axial_load=load), displacement=top)
    np.testing.assert_allclose(result.force, force, rtol=1e-8)
    np.testing.assert_allclose(result.rotation[:, 0], turns, rtol=1e-8)
    assert abs(result.summary["relative_energy_residual"]) < 1e-6


@pytest.mark.parametrize("n", [1, 2, 3, 6])
@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_weakest_joint_softens_alone(kinematics, n):
    """Shear springs in series, one a little weaker: past its cap the others unload."""
    strong = PeakOriented(2e-3, 100e3, 4e-3, 110e3, 0.11)
    weak = PeakOriented(2e-3, 99e3, 4e-3, 109e3, 0.109)
    shear = [weak, *[strong] * (n - 1)]
    stiff = Elastic(1e12)
    chain = rbsdem.Column(
        LENGTH, MASS, shear, [stiff] * n, n=n, kinematics=kinematics, axial_load=1.0
    )
    # Softening -1e6: the weak spring alone goes from (4e-3, 109e3) to (0.044, 69e3).
    force, slip = 69e3, 0.044
    at_cap = 2e-3 + (109e3 - 100e3) / 5e6  # of the strong ones, when the weak one caps
    others = at_cap - (109e3 - force) / 5e7  # they unload with their virgin stiffness
    rotations = force * LENGTH**2 / 1e12 * sum(((n - i) / n) ** 2 for i in range(n))
    top = slip + (n - 1) * others + rotations
    result = rbsdem.cyclic(chain, displacement=[0.25 * top, 0.5 * top, top])
    np.testing.assert_allclose(result.force[-1], force, rtol=1e-6)
    np.testing.assert_allclose(result.slip[-1], [slip, *[others] * (n - 1)], rtol=1e-6)


@pytest.mark.parametrize("kinematics", ["small", "pdelta", "finite"])
def test_capacity_under_a_driven_force(kinematics):
    with pytest.raises(rbsdem.SolveError, match="capacity") as caught:
        rbsdem.cyclic(column(kinematics=kinematics, axial_load=1e3), force=[60e3, 119e3, 125e3])
    assert caught.value.result.force[-1] == pytest.approx(240e3 / LENGTH, rel=1e-3)


@pytest.mark.parametrize("side", [1, -1])
def test_a_push_over_ends_where_its_strength_is_used_up(side):
    """A plastic hinge under an axial load: F L = M_y - P u, which is nothing at u = M_y/P."""
    load = 2e6
    hinge = Bilinear(k=40e6, d_y=0.003, k_post=0.0)
    chain = rbsdem.Column(
        LENGTH, 600.0, Elastic(1e8), hinge, n=1, axial_load=load, kinematics="pdelta"
    )
    push = rbsdem.pushover(chain, displacement=2 * side * 120e3 / load, points=7)
    assert push.summary["status"] == "ended"
    assert "falls under its own weight" in push.summary["reason"]
    assert push.displacement[-1] == pytest.approx(side * 120e3 / load, rel=1e-9)
    assert (side * push.force).min() > -1e-9 * np.abs(push.force).max()
    assert push.path.displacement[-1] == push.displacement[-1]
    # A test can be held on the other side: a prescribed path goes there.
    held = rbsdem.cyclic(chain, displacement=[2 * side * 120e3 / load])
    assert side * held.force[-1] == pytest.approx(-120e3 / LENGTH, rel=0.02)  # with the slip


def test_equal_springs_that_soften_go_on_together():
    """Of two equal storeys both soften, the way of greatest force; a weaker one softens alone."""
    capped = PeakOriented(0.005, 100e3, 0.02, 110e3, 0.05, 10e3)
    weaker = PeakOriented(0.005, 99e3, 0.02, 109e3, 0.05, 10e3)
    for springs, shares in (([capped, capped], 0.5), ([capped, weaker], 1.0)):
        chain = rbsdem.Column(LENGTH, 600.0, springs, Elastic(1e12), n=2, kinematics="small")
        run = rbsdem.cyclic(chain, displacement=[0.039, 0.06])
        slip = np.diff(run.slip, axis=0)[0]
        assert run.force[1] < run.force[0] * 1.1
        assert slip.max() >= shares * slip.sum() * (1 - 1e-6)
        if shares == 0.5:
            np.testing.assert_allclose(slip[0], slip[1], rtol=1e-9)


#: Shear spring that gives back more than the hinge loses: u = V/k + L turn goes back while V falls.
SOFT = Elastic(0.9 * -SOFTENING / LENGTH**2)


@pytest.mark.filterwarnings("ignore:the rotation of a body goes beyond")
@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_path_goes_through_a_snap_back(kinematics):
    """From the cap to the residual moment the top goes back along a straight line.

    A test holds the top and releases the triangle between that line and the vertical, less the work
    that the path does with the residual moment until the top is where it was.
    """
    result = rbsdem.cyclic(
        column(shear=SOFT, kinematics=kinematics, axial_load=1.0),
        displacement=[0.05, 0.5],
        corners=True,
    )
    force, low = 240e3 / LENGTH, 40e3 / LENGTH
    begin, back = (f / SOFT.k + LENGTH * turn for f, turn in ((force, 0.01), (low, 0.06)))
    assert result.displacement[3:] == pytest.approx([begin, back, 0.5], rel=1e-5)
    assert result.force[3:] == pytest.approx([force, low, low], rel=1e-4)
    assert result.summary["snap_backs"] == 1
    triangle = 0.5 * (force - low) * (begin - back)
    assert result.summary["released_energy"] == pytest.approx(triangle, rel=1e-4)
    assert result.summary["relative_energy_residual"] < 1e-12


def test_snap_back_of_exact_rotations_is_reported():
    """Softening steeper than the rest unloads: the top would have to go back."""
    with pytest.raises(rbsdem.SolveError, match="snaps back") as caught:
        rbsdem.cyclic(
            column(shear=SOFT, kinematics="finite", axial_load=1.0), displacement=[0.05, 0.5]
        )
    assert caught.value.result.moment[-1, 0] == pytest.approx(240e3, rel=1e-4)


@pytest.mark.parametrize(
    ("n", "height", "load", "hinge", "shear"),
    [
        (3, 3.41, 16600.0, (4.29e-3, 188e3, 0.0133, 203e3, 0.0171), (1.72e-3, 54200.0, 8.56e-3)),
        (4, 2.03, 50100.0, (1.66e-3, 339e3, 7.5e-3, 379e3, 2.29e-3), (2.79e-3, 174e3, 0.0119)),
        (5, 3.54, 17200.0, (1.22e-3, 203e3, 5.25e-3, 213e3, 3.69e-3), (1.64e-3, 59600.0, 9.7e-3)),
    ],
)
def test_a_joint_that_slips_at_its_residual_force_leaves_the_others_at_rest(
    n, height, load, hinge, shear
):
    """Rates of round-off must not send them along their lines; rows between change nothing."""
    shear = PeakOriented(
        *shear, 1.1 * shear[1], 0.9 * shear[2], f_res=0.1 * shear[1], lambda_h=20.0, s_min=0.3
    )
    chain = rbsdem.Column(
        height, MASS, shear, PeakOriented(*hinge, f_res=0.1 * hinge[1]), n=n, axial_load=load,
        kinematics="pdelta",
    )  # fmt: skip
    turns = height * np.array([0, 0.01, -0.01, 0.02, -0.02, 0.03, -0.03, 0.04])
    steps = [np.linspace(*pair, 9)[1:] for pair in pairwise(turns)]
    whole = rbsdem.cyclic(chain, displacement=turns[1:])
    assert abs(whole.force[-1]) == pytest.approx(shear.f_res, rel=1e-12)
    parts = rbsdem.cyclic(chain, displacement=np.concatenate(steps))
    np.testing.assert_allclose(whole.force, parts.force[7::8], rtol=1e-9)


def test_a_plastic_joint_turns_alone():
    """Two bodies: the base has its plastic moment, the joint above stays elastic and at rest."""
    height, load, k, d_y = 2.56, 3500.0, 9.19e7, 1.992e-3
    shear = Takeda(9.18e7, 5.357e-4, 2.2955e7, 1.7855e-3, 4.59e5, b1=0.3)
    chain = rbsdem.Column(
        height, MASS, shear, Bilinear(k, d_y, 0.0), n=2, axial_load=load, kinematics="pdelta"
    )
    turns = height * np.array([0.01, -0.01, 0.02, -0.02, 0.03, -0.03, 0.04])
    moment = rbsdem.cyclic(chain, displacement=turns).moment[1:]
    np.testing.assert_allclose(abs(moment[:, 0]), k * d_y, rtol=1e-12)
    assert (abs(moment[:, 1]) < 0.51 * k * d_y).all()
