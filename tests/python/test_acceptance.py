"""Acceptance of members: tables of codes, a beam by hand, and what follows from them."""

import re
from dataclasses import replace
from html import unescape

import numpy as np
import pytest

import rbsdem
from rbsdem.checks import acceptance, asce_41, formulas
from rbsdem.codes import DesignSpectrum, assess, target
from rbsdem.section.quantities import quantities

STEEL = rbsdem.Steel(500e6, 600e6)
#: b 300, h 500, d 450, d' 50; 4 D16 above and 2 D16 below, two legs D8 at 150 mm.
BEAM = rbsdem.RectangularSection(
    0.3, 0.5, rbsdem.Concrete(25e6), bars=[(0.2, 804.248e-6, STEEL), (-0.2, 402.124e-6, STEEL)],
    bar_diameter=0.016, ties=rbsdem.Ties(0.008, 0.15, STEEL), cover=0.030,
)  # fmt: skip
COLUMN = rbsdem.RectangularSection(
    0.4, 0.4, rbsdem.Concrete(25e6), layout=rbsdem.Layout(8, 0.018, STEEL),
    ties=rbsdem.Ties(0.008, 0.10, STEEL, legs=3), cover=0.03,
)  # fmt: skip


def demand(section, **change):
    given = {
        "member": "B-1-1", "end": "start", "face": "top", "kind": "beam", "length": 5.0,
        "section": section, "other": section, "axial": 0.0, "moment": 100e3, "shear": 50e3,
        "rotation": 0.03, "span": 2.5,
    }  # fmt: skip
    return acceptance._Demand(**given | change)


def test_a_beam_by_hand_asce_41():
    # Hogging, 4 D16 in tension; nominal moments in place of yield moments of 164.8 and 84.1 kN m.
    hogging, sagging = BEAM, BEAM.mirrored
    found = acceptance._asce_41(demand(hogging, other=sagging), 1.0)
    moments = [
        rbsdem.section.interaction(one, "aci318").moment_at(0.0) for one in (hogging, sagging)
    ]
    assert moments == pytest.approx([164.8e3, 84.1e3], rel=0.06)
    shear = sum(moments) / 5.0 / (300 * 450 * 5.0)
    assert shear == pytest.approx(0.0737637, rel=0.06)
    # Up to 0.25 sqrt(MPa) only the bars count, 0.1511679 of balance; the moments do not.
    assert found.rotations == pytest.approx((0.0084883, 0.0234883, 0.0439533), abs=5e-7)
    assert found.source == "table 10-7 i C"
    law = BEAM.concrete_law["ec"]
    yielding = moments[0] * 5.0 / (6 * 0.3 * law * 0.3 * 0.5**3 / 12)
    # The moment of the diagram is between two of its points.
    assert found.yielding == pytest.approx(yielding, rel=2e-3)
    assert found.demand == pytest.approx(0.03 - found.yielding, rel=1e-12)
    # Wider hoops do not conform.
    wide = replace(hogging, ties=rbsdem.Ties(0.008, 0.20, STEEL))
    loose = acceptance._asce_41(demand(wide, other=sagging), 1.0)
    assert loose.rotations == pytest.approx((0.005, 0.0169766, 0.0254650), abs=1.1e-4)
    assert loose.source == "table 10-7 i NC"
    # Sagging: less steel in tension than in compression is row 1.
    assert acceptance._asce_41(demand(sagging, other=hogging), 1.0).rotations == (
        0.010,
        0.025,
        0.05,
    )
    assert acceptance._asce_41(demand(sagging), 0.75).rotations == pytest.approx(
        (0.0075, 0.01875, 0.0375)
    )


def test_a_beam_by_hand_en_1998_3():
    cases = ((BEAM, 0.0339757, 0.0095760), (BEAM.mirrored, 0.0464122, 0.0088573))
    for section, ultimate, yielding in cases:
        found = acceptance._en_1998_3(demand(section), True)
        # The sheet counts the bars held at the corners, and E_c of 23.5 GPa; the drawing gives d.
        assert found.rotations[2] == pytest.approx(ultimate, rel=0.01)
        assert found.rotations[1] == pytest.approx(0.75 * found.rotations[2], rel=1e-12)
        assert found.rotations[0] == pytest.approx(yielding, rel=0.01)
        secondary = acceptance._en_1998_3(demand(section), False)
        assert secondary.rotations[2] == pytest.approx(1.5 * found.rotations[2], rel=1e-12)
    q = quantities(BEAM, 2.5, 0.0)
    for beyond, strength in ((0, 133.342e3), (2, 120.008e3), (5, 100.006e3)):
        turned = (1 + beyond) * formulas.ec_8_yield_rotation(q, cracked=False)
        found = acceptance._en_1998_3(demand(BEAM, rotation=turned), True)
        # These have all bars over b d; A.12 has their ratio over b h, 1.3 % less strength.
        assert found.shear == pytest.approx(strength, rel=0.02)


def test_a_column_by_hand():
    d = demand(COLUMN, kind="column", length=2.7, span=1.35, axial=600e3)
    found = acceptance._asce_41(d, 1.0)
    q = quantities(COLUMN, 1.35, 600e3)
    moment = rbsdem.section.interaction(COLUMN, "aci318").moment_at(600e3)
    ratio = 2 * moment / 2.7 / formulas.asce_41_shear_strength(q)
    rotations = asce_41.column_rotations(q.axial_load_ratio, q.tie_ratio, ratio, q.fc, q.fyt)
    assert found.rotations == pytest.approx((rotations.io, rotations.ls, rotations.cp), rel=0.02)


def test_a_joint_by_hand_en_1998_1():
    # eta = 0.6 (1 - 25/250) = 0.54; b_j = min(400, 300 + 400/2); h_jc from bar to bar 306 mm;
    # nu_d = 461.273/4000: 0.54 x 25 x 400 x 306 x sqrt(1 - 0.1153183/0.54).
    joint = demand(COLUMN, kind="interior joint", other=BEAM, axial=461273.0)
    assert acceptance._en_1998_3(joint, True).shear == pytest.approx(1465379.4, rel=1e-7)
    above = joint._replace(axial=0.0)
    assert acceptance._en_1998_3(above, True).shear == pytest.approx(1652400.0, rel=1e-12)
    # 0.8 of it where a beam is missing; a strut that the axial load crushes has no strength.
    outer = above._replace(kind="exterior joint")
    assert acceptance._en_1998_3(outer, True).shear == pytest.approx(1321920.0, rel=1e-12)
    assert acceptance._en_1998_3(joint._replace(axial=3e6), True).shear == 0.0
    # (5.34) the other way round: a beam of 600 mm over this column counts with 400 + 400/2.
    wide = replace(BEAM, width=0.6)
    assert acceptance._en_1998_3(above._replace(other=wide), True).shear == pytest.approx(
        1.5 * 1652400.0, rel=1e-12
    )


def test_shear_beyond_its_strength_is_explained_where_no_spring_fails(push):
    found = assess(push, "en_1998_3", at=0.1)
    assert not found.counts()["shear"]
    assert found.warnings == ()
    weak = [row | {"ratio_shear": 1.1} if row["end"] == "start" else row for row in found.rows]
    (note,) = replace(found, rows=weak).warnings
    assert f"at {sum(row['ratio_shear'] == 1.1 for row in weak)} ends" in note
    assert "A.12" in note
    assert str(replace(found, rows=weak)).endswith(note)
    # A joint is no spring, and where a spring fails there is nothing to explain.
    joints = [row | {"ratio_shear": 1.1} if row["end"] == "joint" else row for row in found.rows]
    assert replace(found, rows=joints).warnings == ()


def test_shear_of_joints_by_statics(frame, push):
    found = assess(push, "en_1998_3", at=0.1).to_pandas().set_index("member")
    state = push.at(drift=0.1 / frame.height)
    first, last = (
        dict(zip(frame.parts.members, state[name], strict=True))
        for name in ("moment_from", "moment_to")
    )
    # At the roof nothing stands above: the moment of the beam at the face over 0.9 d.
    beam = frame.geometry["B-1-2"]
    inside = max(0.2 - beam.rigid[0], 0.0) / beam.clear
    moment = abs(float(beam.moment(first["B-1-2"], last["B-1-2"], inside)))
    assert found.loc["N-1-2", "shear_N"] == pytest.approx(moment / (0.9 * 0.45), rel=0.01)
    # Below, the shear of the column above is taken off.
    lower, column = frame.geometry["B-1-1"], frame.geometry["C-1-2"]
    inside = max(0.2 - lower.rigid[0], 0.0) / lower.clear
    moment = abs(float(lower.moment(first["B-1-1"], last["B-1-1"], inside)))
    taken = abs(first["C-1-2"] + last["C-1-2"]) / column.clear
    assert found.loc["N-1-1", "shear_N"] == pytest.approx(moment / (0.9 * 0.45) - taken, rel=0.02)
    assert "N-1-1" not in set(assess(push, "asce_41", at=0.1).to_pandas()["member"])


@pytest.mark.filterwarnings("ignore:member .* its clear length")
def test_panels_are_judged_by_limits_that_are_given(push):
    house = replace(push.frame, panel=rbsdem.frames.JointPanel(COLUMN, BEAM, "exterior").spring())
    pushed = rbsdem.pushover(house, drift=0.02, points=30)
    open_ = assess(pushed, "asce_41", at=0.1)
    rows = open_.to_pandas().set_index("member")
    assert rows.loc["N-2-1", "status"].startswith("table 10-11 is not built in")
    assert open_.counts()["not evaluated"] == 6
    at = [one.member for one in house.parts.springs_of("flexure") if one.group == "panel"]
    turned = pushed.at(drift=0.1 / house.height)["springs"]["rotation"][-len(at) :]
    limits = {"N-*": (0.001, 0.002, 0.003), "N-2-1": (0.002, 0.004, 0.008)}
    given = assess(pushed, "asce_41", at=0.1, limits=limits)
    assert given.counts()["not evaluated"] == 0
    rows = given.to_pandas().set_index("member")
    for name, rotation in zip(at, turned, strict=True):
        # The panel without hoops yields at a shear strain of 0.0002.
        plastic = max(abs(rotation) - 0.0002, 0.0)
        limit = 0.008 if name == "N-2-1" else 0.003
        assert rows.loc[name, "ratio_CP"] == pytest.approx(plastic / limit, rel=1e-6), name
    assert rows.loc["N-2-1", "ratio_CP"] > 0


@pytest.fixture(scope="module")
def frame():
    return rbsdem.Frame.grid(
        [3.2, 3.2], [5.0, 4.0], columns=COLUMN, beams=BEAM, dead_load=20e3, mass="from_loads",
        kinematics="pdelta", pattern="modal", damping=0.05,
    )  # fmt: skip


@pytest.fixture(scope="module")
def push(frame):
    return rbsdem.pushover(frame, drift=0.03, points=60)


def test_rotations_are_those_of_faces_against_chords(frame, push):
    # A column on a fixed base: no rotation at its foot, so that its chord is all of it.
    rows = np.array([float(push.time.size - 1)])
    found = {(d.member, d.end): d for d in acceptance.demands(push, rows)}
    at = frame.parts.nodes.index("N-1-1")
    rigid = frame.columns[1, 1].rigid_end[1]
    moved = push.x[-1, at] - push.node_rotation[-1, at] * rigid
    assert found["C-1-1", "start"].rotation == pytest.approx(moved / (3.2 - rigid), rel=1e-9)
    moment = push.moment_from[-1, frame.parts.members.index("C-1-1")]
    assert found["C-1-1", "start"].moment == pytest.approx(abs(moment), rel=1e-9)


def test_mirrored_frames_swap_their_ends(frame, push):
    turned = rbsdem.Frame.grid(
        [3.2, 3.2], [4.0, 5.0], columns=COLUMN, beams=BEAM, dead_load=20e3, mass="from_loads",
        kinematics="pdelta", pattern="modal", control_node="N-3-2",
    )  # fmt: skip
    back = rbsdem.pushover(turned, drift=-0.03, points=60)
    for code in ("asce_41", "en_1998_3"):
        one = assess(push, code, at=0.1).to_pandas().set_index(["member", "end"])
        two = assess(back, code, at=-0.1).to_pandas().set_index(["member", "end"])
        pairs: tuple = (
            (("C-1-1", "start"), ("C-3-1", "start")),
            (("B-1-1", "end"), ("B-2-1", "start")),
        )
        if code == "en_1998_3":
            pairs += ((("N-1-1", "joint"), ("N-3-1", "joint")),)
        for first, second in pairs:
            for name in ("rotation_rad", "ratio_shear", "shear_span_m"):
                expected = pytest.approx(two.loc[second, name], rel=1e-4, nan_ok=True)
                assert one.loc[first, name] == expected, name


def test_a_target_is_assessed(push):
    demand = DesignSpectrum.en_1998(0.25, "C")
    found = target(push, demand, "en_1998")
    whole = assess(push, "en_1998_3", at=found)
    assert whole.displacement == pytest.approx(found.signed, rel=1e-12)
    assert set(whole.counts()) == {"DL", "SD", "NC", "shear", "not evaluated"}
    worst = whole.worst(3)
    assert list(worst["ratio"]) == sorted(worst["ratio"], reverse=True)
    # Both ends of the members, and the joints above the base.
    assert len(whole.states()) == 2 * len(push.frame.parts.members) + 6
    # Below yield the plastic rotation is zero, and evaluated.
    small = assess(push, "asce_41", at=0.005)
    assert small.accepted("IO")
    assert (small.to_pandas()["ratio_CP"] == 0).all()
    further = target(push, DesignSpectrum.en_1998(2.0, "D"), "en_1998")
    with pytest.raises(rbsdem.InputError, match="ends before the target"):
        assess(push, at=further)


def test_a_record_is_judged_by_its_envelope(frame):
    record = rbsdem.motions.synthetic(1)[0]
    quake = rbsdem.time_history(frame, record, method="newmark", dt=0.01)
    found = assess(quake, "en_1998_3").to_pandas()
    found = found[found["end"] != "joint"]
    # Both sides of an end that turns to and fro.
    assert (found.groupby(["member", "end"]).size() == 2).all()
    row = found[(found.member == "C-2-1") & (found.end == "start")]["rotation_rad"].max()
    at = frame.parts.nodes.index("N-2-1")
    rigid = frame.columns[2, 1].rigid_end[1]
    chord = (quake.x[:, at] - quake.node_rotation[:, at] * rigid) / (3.2 - rigid)
    assert row == pytest.approx(np.abs(chord).max(), rel=1e-9)
    with pytest.raises(rbsdem.InputError, match="envelope"):
        assess(quake, at=0.1)


@pytest.mark.usefixtures("without_figures")
def test_the_report_of_an_assessment_is_short(push, tmp_path):
    found = target(push, DesignSpectrum.en_1998(0.25, "C"), "en_1998")
    checked = assess(push, "en_1998_3", at=found)
    path = rbsdem.report(checked, tmp_path / "house.html", title="House", target=found)
    text = path.read_text("utf-8")
    headings = re.findall("<h2>([^<]*)</h2>", text)
    assert headings == ["Inputs", "Target displacement", "Storeys", "Members", "Assumed"]
    # Ten rows of members, one of each storey and figure of the target; layers are beside it.
    assert text.count("<tr>") == 3 + 10 + 2 + len(found.to_pandas())
    storeys = (tmp_path / "house_files/storeys.csv").read_text("utf-8").splitlines()
    assert float(storeys[1].split(",")[2]) == pytest.approx(found.base_shear, rel=1e-3)
    for drawing in (COLUMN, BEAM):
        assert unescape(text).count(str(drawing)) == 1
    rows = (tmp_path / "house_files/all_members.csv").read_text("utf-8").splitlines()
    assert len(rows) == 1 + len(checked.rows)
    assert (tmp_path / "house_files/inputs.csv").is_file()
    whole = rbsdem.report(push, tmp_path / "push.html").read_text("utf-8")
    assert whole.count("<tr>") < 60


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_what_a_code_does_not_cover_is_said():
    circle = rbsdem.CircularSection(
        0.45, rbsdem.Concrete(25e6), layout=rbsdem.Layout(10, 0.02, STEEL),
        spiral=rbsdem.Spiral(0.01, 0.08, STEEL), cover=0.03,
    )  # fmt: skip
    frame = rbsdem.Frame.grid([3.2], [5.0], columns=circle, beams=BEAM, dead_load=20e3)
    push = rbsdem.pushover(frame, drift=0.01, points=10)
    found = assess(push, "en_1998_3", at=0.02)
    columns = found.to_pandas().set_index("member").loc["C-1-1"]
    assert columns["status"].str.contains("circle").all()
    assert columns["ratio_NC"].isna().all()
    assert not found.accepted()
    assert found.states()["C-1-1", "start"] == -1
    # They may be given.
    own = dict.fromkeys(("C-1-1", "C-2-1"), (0.005, 0.02, 0.03))
    given = assess(push, "en_1998_3", at=0.02, limits=own).to_pandas()
    assert set(given[given["status"] != "evaluated"]["member"]) == {"N-1-1", "N-2-1"}
    assert given["status"].iloc[-1] == "5.5.3.3 has no strength for this column (circle)"
    assert assess(push, "asce_41", at=0.02).counts()["not evaluated"] == 0


def test_refusals(push):
    plain = rbsdem.FrameMember(30e9, 0.16, 2e-3, yield_moment=2e5, hardening=0.01)
    bare = rbsdem.pushover(rbsdem.Frame.grid([3.0], [5.0], columns=plain, beams=plain), drift=0.01)
    # In a row beyond, or at the first of several crossings, they were judged in silence.
    one_point = rbsdem.cyclic(push.frame, displacement=[0.03])
    cycle = rbsdem.cyclic(push.frame, displacement=[0.03, -0.01, 0.03], corners=True)
    for call, text in [
        (lambda: assess(bare), "have no sections"),
        (lambda: assess(push, "fema_356"), "asce_41"),
        (lambda: assess(push, at=9.0), "beyond the end"),
        (lambda: assess(one_point, at=0.02), "its given points alone"),
        (lambda: assess(cycle, at=0.02), "turns back"),
        (lambda: target(cycle, DesignSpectrum.en_1998(0.2, "C")), "turns back"),
        (lambda: assess(push, knowledge=2.0), "knowledge"),
        (lambda: assess(push, limits={"C-9-9": (0.1, 0.2, 0.3)}), "C-9-9"),
        (lambda: assess(push, limits={"N-1-1": (0.1, 0.2, 0.3)}), "no node with a panel"),
        (lambda: assess(push, limits={"C-1-1": (0.3, 0.2, 0.1)}), "3 ascending rotations"),
        (lambda: assess(push, limits={"C-1-1": (-0.1, 0.2, 0.3)}), "ascending"),
        (lambda: assess(push, limits={"C-1-1": (0.1, np.nan, 0.3)}), "value 2 of 3 is nan"),
        (lambda: assess(push, limits={"C-1-1": 0.1}), "one dimension"),
        (lambda: assess(push, limits={"C-1-1": ("IO", "LS", "CP")}), "array of numbers"),
        (lambda: assess(push, limits=[0.1, 0.2, 0.3]), "mapping of names"),
        (lambda: assess(push, limits={3: (0.1, 0.2, 0.3)}), "limits of 3"),
        (lambda: assess(push).worst(level="XX"), "CP"),
        (lambda: assess(3), "pushover"),
    ]:
        with pytest.raises(rbsdem.InputError, match=text):
            call()
