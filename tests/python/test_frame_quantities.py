"""Reactions, storey shears and rotations of frames: statics at every row, and closed forms."""

import numpy as np
import pytest

import rbsdem
from rbsdem import frames
from rbsdem.springs import Bilinear

STIFF = frames.FrameMember(30e9, 4.0, 4.0)


def frame(kinematics="pdelta", **more):
    """Return three storeys, two bays, with rigid ends, loads on beams and on nodes."""
    kinds = [
        frames.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=m, hardening=0.02, rigid_end=p)
        for m, p in ((250e3, 0.25), (180e3, 0.2))
    ]
    nodes = [frames.FrameNode(f"N-{i}-{k}", load_y=-40e3) for i in (1, 3) for k in (1, 2, 3)]
    return rbsdem.Frame.grid(
        [4.0, 3.2, 3.0], [6.0, 4.5], columns=kinds[0], beams=kinds[1], beam_load=20e3,
        floor_mass=[60e3, 50e3, 40e3], nodes=nodes, kinematics=kinematics, **more,
    )  # fmt: skip


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
@pytest.mark.parametrize("pattern", ["triangular", "uniform"])
def test_statics_of_a_push_over(kinematics, pattern):
    made = frame(kinematics, pattern=pattern)
    push = rbsdem.pushover(made, drift=0.03, points=20)
    weight, force = 3 * 20e3 * 10.5 + 6 * 40e3, push.force
    levels, mass = np.cumsum([4.0, 3.2, 3.0]), np.array([60e3, 50e3, 40e3])
    shares = mass * levels if pattern == "triangular" else mass
    shares = shares / shares.sum()
    total = sum(push.reactions.values())
    assert list(push.reactions) == ["N-1-0", "N-2-0", "N-3-0"]
    np.testing.assert_allclose(total[:, 0], -force, atol=1e-9 * weight)
    np.testing.assert_allclose(total[:, 1], weight, rtol=1e-9)
    above = np.cumsum(shares[::-1])[::-1]
    np.testing.assert_allclose(push.storey_shear, np.outer(force, above), atol=1e-9 * weight)
    # The loads and, with second-order work, the weights on nodes that have moved.
    moment = force * (shares @ levels)
    if kinematics == "pdelta":
        parts = made.parts
        node = np.zeros(made.n)
        for one in made.geometry.values():
            own = 0.5 * one.load * abs(parts.x[one.end] - parts.x[one.start])
            node[[one.start, one.end]] += own
        for own in made.nodes:
            node[parts.nodes.index(own.name)] -= own.load_y
        moment = moment + push.x @ node
    # Beams that shorten move the weights of their two nodes a little differently.
    np.testing.assert_allclose(push.base_moment, moment, atol=2e-4 * moment.max())


def test_shears_of_the_lowest_storey_are_the_base_shear_in_time():
    record = rbsdem.motions.synthetic(1)[0]
    made = frame("pdelta")
    quake = rbsdem.time_history(made, record, method="newmark", dt=0.01)
    largest = np.abs(quake.base_shear).max()
    np.testing.assert_allclose(quake.storey_shear[:, 0], quake.base_shear, atol=1e-8 * largest)


def test_loads_on_a_clamped_beam_are_held_by_its_ends():
    nodes = [frames.FrameNode(name, x, 0.0, support="fixed") for name, x in (("a", 0), ("b", 6))]
    one = frames.Member("AB", "a", "b", frames.FrameMember(30e9, 0.15, 3e-3), (0.5, 0.25), 12e3)
    free = frames.FrameNode("c", 0.0, 3.0, load_y=-1e3)
    post = frames.Member("AC", "a", "c", frames.FrameMember(30e9, 0.15, 3e-3))
    made = rbsdem.Frame(nodes=[*nodes, free], members=[one, post], control_node="c")
    rest = rbsdem.cyclic(made, force=[0.0])
    beam = rest.member("AB")
    half = 0.5 * 12e3 * 5.25
    np.testing.assert_allclose(beam.shear[0], [-half, half])
    fixed = half * 5.25 / 6
    np.testing.assert_allclose(beam.geometry.moment(*beam.moment[0], [0, 0.5, 1]), [
        -fixed, fixed / 2, -fixed])  # fmt: skip
    np.testing.assert_allclose(rest.reactions["a"][0], [0, half + 12e3 * 0.5 + 1e3, -fixed
        - half * 0.5], atol=1e-6)  # fmt: skip
    np.testing.assert_allclose(
        rest.reactions["b"][0, 1:], [half + 12e3 * 0.25, fixed + half * 0.25]
    )


def test_stability_coefficient_is_what_takes_the_stiffness():
    """theta = P/(K h): with second-order work the force falls by this share."""
    flexible = frames.FrameMember(30e9, 4.0, 1e-4)
    forces = []
    for kinematics in ("small", "pdelta"):
        made = rbsdem.Frame.grid(
            [3.0], [5.0], columns=flexible, beams=STIFF, beam_load=40e3, kinematics=kinematics
        )
        push = rbsdem.pushover(made, drift=0.001, points=4)
        forces.append(push.force[-1])
        theta = push.stability_coefficient[-1, 0]
    first_order, second_order = forces
    # By first-order shears theta is P d/(V h); by those of the displaced frame theta/(1 - theta).
    assert theta == pytest.approx(200e3 * 0.001 / second_order, rel=1e-6)
    assert second_order == pytest.approx(first_order - 200e3 * 0.001, rel=0.01)


def test_rotations_of_a_cantilever_and_of_its_hinge():
    elastic = rbsdem.Frame([3.0], columns=frames.FrameMember(30e9, 0.16, 2.1e-3))
    bent = rbsdem.pushover(elastic, drift=0.01, points=3).member("C-1-1")
    np.testing.assert_allclose(bent.chord_rotation[-1], [-0.01, 0.005], rtol=1e-9)
    assert not bent.plastic_rotation.any()
    hinge = frames.FrameMember(
        30e9, 0.16, 2.1e-3, flexure=Bilinear(1e7, 4e-3, 1e5), interior="rigid"
    )
    made = rbsdem.Frame([3.0], columns=hinge)
    # No moment is at the top, so all of the drift is the rotation of the foot.
    column = rbsdem.cyclic(made, displacement=[0.03, -0.03, 0.0]).member("C-1-1")
    np.testing.assert_allclose(column.chord_rotation[:, 0], [-0.01, 0.01, 0.0], atol=1e-12)
    whole = rbsdem.pushover(made, drift=0.01, points=10).member("C-1-1")
    assert whole.plastic_rotation[-1, 0] == pytest.approx(-0.006, rel=1e-9)
    assert not whole.plastic_rotation[:, 1].any()


def test_state_at_a_drift_and_at_the_largest_force():
    push = rbsdem.pushover(frame(), drift=0.04, points=7)
    at = push.at(drift=0.0123)
    assert at["displacement"] == pytest.approx(0.0123 * push.frame.height, rel=1e-12)
    assert push.at("peak")["force"] == push.path.force.max()
    loop = rbsdem.cyclic(frame(), displacement=[0.1, -0.2, 0.3])
    # From the first point at 0.1 m to the second at -0.2 m.
    assert loop.at(drift=-0.01)["time"] == pytest.approx((0.1 + 0.102) / 0.3)
    with pytest.raises(rbsdem.InputError, match=r"drift = 0\.5 is not reached; the rows go from"):
        push.at(drift=0.5)
    with pytest.raises(rbsdem.InputError, match="exactly one of time"):
        push.at(1.0, drift=0.01)
    with pytest.raises(rbsdem.InputError, match="time = 'top'"):
        push.at("top")
