"""Measures of frames depend on the path alone; failures in shear have one name."""

import warnings
from dataclasses import replace
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np
import pytest
from test_acceptance import BEAM, COLUMN

import rbsdem
from rbsdem import plot
from rbsdem.codes import assess
from rbsdem.errors import AccuracyWarning
from rbsdem.frames import FrameNode, Member

MORE = {"floor_mass": 40e3, "beam_load": 15e3, "kinematics": "pdelta"}


@pytest.fixture(scope="module")
def frame():
    return rbsdem.Frame.grid([3.2, 3.0], [5.0], columns=COLUMN, beams=BEAM, **MORE)


@pytest.mark.parametrize("points", [1, 8, 60])
def test_measures_depend_neither_on_points_nor_on_rows(frame, points):
    far = 0.02 * frame.height
    push = rbsdem.pushover(frame, drift=0.02, points=7)
    path = rbsdem.cyclic(frame, displacement=far * np.arange(1, points + 1) / points)
    sparse = rbsdem.cyclic(frame, displacement=far * np.arange(1, 61) / 60, every=30)
    if points == 1:
        # Rows of corners between few points are no path of all points.
        given = {"displacement": sparse.call["displacement"], "every": 30, "corners": True}
        corners = rbsdem.cyclic(frame, **given).path
        np.testing.assert_array_equal(corners.time, sparse.path.time)
    for other in (path, sparse):
        assert len(other.events) == len(push.events)
        for one, two in zip(push.events, other.events, strict=True):
            assert (one.name, one.member, one.end, one.side) == (
                two.name, two.member, two.end, two.side,
            )  # fmt: skip
            assert two.displacement == pytest.approx(one.displacement, rel=1e-6, abs=1e-9)
            assert two.force == pytest.approx(one.force, rel=1e-6)
        for name in ("C-1-1", "B-1-1"):
            one, two = push.member(name), other.member(name)
            np.testing.assert_allclose(two.ductility, one.ductility, rtol=1e-6)
            end = two.plastic_rotation[-1], one.plastic_rotation[-1]
            np.testing.assert_allclose(*end, rtol=1e-6, atol=1e-12)
        assert np.nanmax(other.member("C-1-1").ductility) > 1.3


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_failures_in_shear_of_beams_have_their_name():
    # Hardly any hoops: the beam fails in shear before its ends yield.
    steel = BEAM.bars[0][2]
    many = [(0.2, 24e-4, steel), (-0.2, 24e-4, steel)]
    weak = replace(BEAM, bars=many, ties=rbsdem.Ties(0.006, 0.25, steel))
    strong = rbsdem.RectangularSection(
        0.6, 0.6, BEAM.concrete, layout=rbsdem.Layout(16, 0.028, steel), cover=0.03,
        ties=rbsdem.Ties(0.01, 0.1, steel, legs=4),
    )  # fmt: skip
    frame = rbsdem.Frame.grid(
        [3.2], [3.0], columns=strong, beams=weak, **MORE | {"beam_load": 60e3}
    )
    push = rbsdem.pushover(frame, drift=0.03, points=20)
    failed = [event for event in push.events if event.name == "shear_failure"]
    assert "B-1-1" in {event.member for event in failed}
    assert not [e for e in push.events if e.group == "shear" and e.name == "yield"]
    assert push.limit_states()["shear_failure"].member == failed[0].member
    assert not assess(push, "asce_41").warnings  # which says that no spring fails in shear
    for ax, label in (
        (plot.frame(push), "member failed in shear"),
        (plot.pushover(push), "fails in shear"),
    ):
        assert any(label in text for text in ax.get_legend_handles_labels()[1])
        plt.close(ax.figure)


def test_ends_are_counted_once(frame):
    quake = rbsdem.time_history(
        frame, rbsdem.motions.synthetic(1)[0].scaled(2.0), method="newmark", dt=0.01
    )
    found = assess(quake, "en_1998_3")
    # Two columns and a beam in each of two storeys; rows are of both sides of an end.
    assert "12 ends and 4 joints" in repr(found)
    table = found.to_pandas()
    beyond = table[table["ratio_DL"] > 1]
    assert found.counts()["DL"] == len(set(zip(beyond["member"], beyond["end"], strict=True)))
    assert len(beyond) > found.counts()["DL"]


def test_an_elastic_frame_is_drawn_and_reported(tmp_path):
    member = rbsdem.FrameMember(30e9, 0.16, 2.1e-3)
    frame = rbsdem.Frame.grid([3.2], [6.0], columns=member, beams=member, beam_load=2e4)
    push = rbsdem.pushover(frame, drift=0.01, points=4)
    plt.close(plot.frame(push).figure)
    assert "Members" in rbsdem.report(push, tmp_path / "elastic.html").read_text("utf-8")


def test_rotations_of_tables_are_in_rad(frame):
    push = rbsdem.pushover(frame, drift=0.02, points=10)
    worst = assess(push, "asce_41").worst(3)
    text = str(plot.table(worst))
    assert "rad" in text
    assert f"{worst['demand_rad'][0]:.3g}" in text


def test_factors_of_members_without_detailing(frame):
    push = rbsdem.pushover(frame, drift=0.02, points=10)
    detailed, other = (assess(push, "en_1998_3", detailing=f) for f in (1.0, 0.8))
    one, two = detailed.to_pandas(), other.to_pandas()
    np.testing.assert_allclose(two["limit_NC_rad"], 0.8 * one["limit_NC_rad"])
    np.testing.assert_allclose(two["limit_DL_rad"], one["limit_DL_rad"])
    assert "A.1 x 0.8" in set(two["source"].str.split(",").str[0])
    assert "ribbed" in detailed.assumed
    with pytest.raises(rbsdem.InputError, match="detailing is for 'en_1998_3'"):
        assess(push, detailing=0.8)


def test_units_that_slip():
    record = rbsdem.motions.synthetic(1)[0]
    member = rbsdem.FrameMember(30e9, 0.16, 2.1e-3)
    frame = rbsdem.Frame.grid([3.2], [6.0], columns=member, beams=member, **MORE)
    for call, text in [
        (lambda: record.sa(1.0, damping=5), "damping = 5"),
        (lambda: rbsdem.ida(frame, [record], damping=5), "5 % is 0.05"),
        (lambda: rbsdem.pushover(frame, drift=2), "2 per cent is 0.02"),
    ]:
        with pytest.raises(rbsdem.InputError, match=text):
            call()
    with pytest.warns(AccuracyWarning, match="5 g"):
        large = record.scaled(60.0)
    with pytest.warns(AccuracyWarning) as told:
        rbsdem.time_history(frame, large, method="newmark", dt=0.01)
    assert any("5 g" in str(each.message) for each in told)
    # Beyond half of the height both notes are told: the unit, and what rotations err by.
    with pytest.warns(AccuracyWarning, match=r"half of the height(.|\n)*2 th\^2/3"):
        rbsdem.cyclic(frame, displacement=[2.0])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"columns": BEAM, "beams": COLUMN}, "exchange columns and beams"),
        ({"dead_load": 20}, "dead_load = 20 N/m is that of no building; 10 kN/m is 10e3"),
        ({"live_load": [3e3, 8.0]}, "live_load = 8 N/m"),
        ({"node_load": {("outer", 2): 25}}, "node_load = 25 N is that of no building"),
        ({"floor_mass": 150.0}, "of the weight of the masses"),
        ({"columns": replace(COLUMN, ties=None)}, "there are no ties"),
        ({}, ""),
    ],
)
def test_drawings_that_slip_are_told_once(change, told):
    given = {"columns": COLUMN, "beams": BEAM} | MORE | change
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert rbsdem.Frame.grid([3.2, 3.0], [5.0], **given).parts.mass > 0
    assert sum(told in str(warning.message) for warning in caught) == bool(told)
    assert told or not caught


def test_strength_over_weight():
    """Two columns with M_p = 200 at both ends, in kN m: 4 M_p/h over m g."""
    kind = rbsdem.FrameMember(30e6, 0.16, 2.1e-3, yield_moment=200.0, hardening=0.0)
    share = 4 * 200.0 / 3.0 / (40e3 * 9.80665)
    with pytest.warns(AccuracyWarning) as caught:
        assert rbsdem.Frame.grid([3.0], [5.0], columns=kind, beams=kind, floor_mass=40e3).parts
    text = [str(w.message) for w in caught if "of the weight of the masses" in str(w.message)]
    assert float(text[0].split(" N, ")[1].split()[0]) == pytest.approx(share, rel=1e-4)


def test_drawn_storeys_in_mm():
    for storeys, bays, name in (([3200], [5.0], "storeys"), ([3.2], [5000], "bays")):
        with pytest.raises(rbsdem.InputError, match=f"{name} has a length .*3200 mm is 3.2"):
            rbsdem.Frame.grid(storeys, bays, columns=COLUMN, beams=BEAM, **MORE)


def portal(left, x, **first):
    """Return nodes and members of a portal with its left column at x."""
    member = rbsdem.FrameMember(30e9, 0.16, 2.1e-3)
    names = [f"{left}{i}" for i in range(4)]
    places = [(x, 0.0), (x, 3.0), (x + 4.0, 3.0), (x + 4.0, 0.0)]
    nodes = [
        FrameNode(name, *at, "fixed" if at[1] == 0 else "free", **more)
        for name, at, more in zip(names, places, ({}, first, {}, {}), strict=True)
    ]
    pairs = pairwise(names)
    return nodes, [Member(f"{left}-{i}", *pair, member) for i, pair in enumerate(pairs)]


def test_parts_that_nothing_ties_are_refused():
    one, two = portal("a", 0.0), portal("b", 10.0)
    with pytest.raises(rbsdem.InputError, match="nodes a0 and b0 are of parts that nothing ties"):
        rbsdem.Frame(nodes=one[0] + two[0], members=one[1] + two[1])
    # A strut without bending stiffness, or a common motion along x, ties them.
    tied = portal("b", 10.0, moves_with="a2")
    frame = rbsdem.Frame(nodes=one[0] + tied[0], members=one[1] + tied[1])
    push = rbsdem.pushover(frame, displacement=0.01, points=2)
    np.testing.assert_allclose(push.node("b1")[:, 0], push.node("a2")[:, 0], rtol=1e-12)
    # Both parts carry half, as they are alike.
    shear = {name: force[-1, 0] for name, force in push.reactions.items()}
    assert shear["a0"] + shear["a3"] == pytest.approx(shear["b0"] + shear["b3"], rel=1e-3)
    # Two nodes at one place may move alike: a hinge between the parts.
    close = portal("b", 4.0, moves_with="a2")
    close[0][0] = replace(close[0][0], x=4.5)
    rbsdem.Frame(nodes=one[0] + close[0], members=one[1] + close[1])
    with pytest.raises(rbsdem.InputError, match="tie them by moves_with"):
        rbsdem.Frame(
            nodes=one[0] + [replace(node, moves_with="") for node in close[0]],
            members=one[1] + close[1],
        )


def test_a_frame_that_turns_far_is_told(frame):
    member = rbsdem.FrameMember(30e9, 0.16, 2.1e-3)
    elastic = rbsdem.Frame.grid([3.2], [6.0], columns=member, beams=member, beam_load=2e4)
    with pytest.warns(AccuracyWarning, match=r"turns by more than 0\.1 rad"):
        rbsdem.pushover(elastic, drift=0.12, points=2)
    rbsdem.pushover(elastic, drift=0.09, points=2)


def test_the_peak_of_a_push_downward():
    member = rbsdem.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=1e5, hardening=0.02)
    nodes = [FrameNode("a", 0, 0, "fixed"), FrameNode("b", 3, 0, push_y=-1.0)]
    nodes.append(FrameNode("c", 6, 0, "fixed"))
    beam = rbsdem.Frame(
        nodes=nodes, members=[Member("ab", "a", "b", member), Member("bc", "b", "c", member)],
        pattern="nodes", control="y", control_node="b",
    )  # fmt: skip
    for side in (-1.0, 1.0):
        push = rbsdem.pushover(beam, displacement=side * 0.02, points=5)
        assert abs(push.force[-1]) > 1e5
        assert push.summary["peak_force"] == pytest.approx(push.force[-1], rel=1e-12)


def test_reactions_after_a_loss_are_the_base_shear():
    column = rbsdem.FrameMember(30e9, 0.16, 2.1e-3, yield_moment=2e5, hardening=0.02)
    frame = rbsdem.Frame.grid(
        [3.2, 3.2], [5.0, 5.0], columns=column, beams=column, floor_mass=40e3, beam_load=20e3,
        kinematics="pdelta", losses={"C-2-1": 1.0},
    )  # fmt: skip
    run = rbsdem.time_history(
        frame, rbsdem.motions.synthetic(1)[0].scaled(0.4), method="newmark", dt=0.01
    )
    after = run.lost[:, run.frame.parts.members.index("C-2-1")] > 0
    assert after.any()
    assert not after.all()
    total = sum(force[:, 0] for force in run.reactions.values())
    np.testing.assert_allclose(total, -run.base_shear, atol=1e-6 * np.abs(run.base_shear).max())
