"""Masonry infills: their law and places, both doors, the struts in a frame, and what is said."""

from __future__ import annotations

import math

import matplotlib as mpl
import numpy as np
import pytest

import rbsdem
from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties, plot
from rbsdem.errors import InputError
from rbsdem.frames import Frame, FrameMember, Infill, infills

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
mpl.use("Agg")

STEEL = Steel(450e6)
COLUMN = RectangularSection(
    0.3, 0.3, Concrete(20e6), layout=Layout(8, 0.016, STEEL), cover=0.03,
    ties=Ties(0.008, 0.15, STEEL),
)  # fmt: skip
BEAM = RectangularSection(
    0.3, 0.5, Concrete(20e6), bars=[(-0.2, 6e-4, STEEL), (0.2, 6e-4, STEEL)], bar_diameter=0.016,
    cover=0.03, ties=Ties(0.008, 0.15, STEEL),
)  # fmt: skip
BRICK = Infill(0.2, 2e6)
LOADING = "&loading drive = 'displacement', amplitudes = 0.01 /\n"


def drawn(storeys: int = 2, bays: int = 2, **more) -> Frame:
    given = {"columns": COLUMN, "beams": BEAM, "dead_load": 25e3, "kinematics": "pdelta"}
    return Frame.grid([3.0] * storeys, [4.5] * bays, **given | {"mass": "from_loads"} | more)


def test_the_law_by_hand():
    """V = 0.42 (f_m)^0.25 t l in MPa, clear sizes, and along the diagonal between the nodes."""
    (bay,) = drawn(1, 1, infills=BRICK).infilled
    length, height = 4.5 - 0.3, 3.0 - 0.25
    assert (bay.length, bay.height) == pytest.approx((length, height))
    force = 0.42e6 * 2**0.25 * 0.2 * length
    cos, spring = 4.5 / math.hypot(4.5, 3.0), bay.spring()
    at = cos * height * np.array([0.1 * 0.005, 0.005, 0.03, 0.05])
    shares = np.array([0.8, 1.0, 0.3, 0.3])
    np.testing.assert_allclose(-spring.response(-at), force / cos * shares, rtol=1e-12)
    assert not spring.response(at).any()
    # Stated by Decanini, Liberatore, Mollaioli 2014 in % of area and length.
    window = Infill(0.2, 2e6, (1.2, 1.4))
    wide = 100 * 1.2 / length
    share = 0.55 * math.exp(-0.035 * wide * 1.4 / height) + 0.44 * math.exp(-0.025 * wide)
    assert window.force(length, height) == pytest.approx(share * force, rel=1e-12)
    assert Infill(0.2, strength=1e5, opening=(1.2, 1.4)).force(length, height) == 1e5


def test_struts_stand_in_their_places_and_carry_no_dead_load():
    """The last cell that fits counts; the second storey keeps one of its two panels."""
    frame = drawn(infills={(0, 0): BRICK, (1, 2): None})
    bare = drawn()
    assert [one.struts for one in frame.infilled] == [
        (f"I-{bay}-{storey}-1", f"I-{bay}-{storey}-2") for bay, storey in ((1, 1), (2, 1), (2, 2))
    ]
    # A storey above another beam is lower by half of it.
    assert [one.height for one in frame.infilled] == pytest.approx([2.75, 2.75, 2.5])
    parts, members = frame.parts, bare.parts.members
    np.testing.assert_allclose(
        parts.compression[: len(members)], bare.parts.compression, rtol=1e-12
    )
    assert not parts.compression[len(members) :].any()
    ends = [tuple(parts.nodes[i] for i in pair) for pair in parts.ends[len(members) :]]
    assert ends[:2] == [("N-1-0", "N-2-1"), ("N-2-0", "N-1-1")]


def test_kinds_by_hand_take_infills_too():
    """Their rigid ends are half the depths of the others."""
    column, beam = (
        FrameMember(30e9, 0.09, 6.75e-4, rigid_end=0.25),
        FrameMember(30e9, 0.15, 3.1e-3, rigid_end=0.15),
    )
    frame = drawn(columns=column, beams=beam, mass=None, infills=BRICK)
    assert [one.length for one in frame.infilled] == pytest.approx([4.2] * 4)
    assert [one.height for one in frame.infilled] == pytest.approx([2.75] * 2 + [2.5] * 2)


@pytest.mark.parametrize("cells", [BRICK, {(0, 1): BRICK, (1, 0): Infill(0.1, 3e6, (1.0, 2.0))}])
def test_a_case_file_has_the_same_frame(cells, tmp_path):
    frame = drawn(infills=cells)
    file = tmp_path / "infilled.nml"
    file.write_text(frame.to_namelist() + LOADING)
    read = rbsdem.read_case(file).column
    assert (read, read.infilled) == (frame, frame.infilled)
    assert read.to_namelist() == frame.to_namelist()
    # With all springs, as the executable has it.
    file.write_text(frame.to_namelist(springs=True) + LOADING)
    assert rbsdem.read_case(file).column == frame
    # A frame without one of the struts is that of its members.
    assert len(frame.without("I-1-1-1").infilled) == len(frame.infilled) - 1


def test_three_lines_more_than_the_bare_frame():
    def groups(frame: Frame) -> set[str]:
        return set(frame.to_namelist().splitlines())

    more = groups(drawn(infills=BRICK)) - groups(drawn())
    assert sorted(line.split()[0] for line in more) == ["&infill", "&infill_of"]


def test_an_infill_takes_its_share_and_is_told():
    """In balance with the columns; each state where its strut is; the page, tables, figures."""
    frame = drawn(1, 1, infills=BRICK)
    push = rbsdem.pushover(frame, drift=0.035)
    (bay,), struts = frame.infilled, (3, 4)
    cos = 4.5 / math.hypot(4.5, 3.0)
    forces = cos * (push.member_axial[:, struts[1]] - push.member_axial[:, struts[0]])
    np.testing.assert_allclose(push.infill_shear[:, 0], forces, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(push.storey_shear[:, 0], push.base_shear, rtol=0, atol=1.0)
    told = [event for event in push.events if event.group == "infill"]
    assert [event.name for event in told] == ["cracking", "cap", "residual"]
    assert {event.member for event in told} == {"I-1-1-2"}
    shares = [forces[event.row] / bay.force for event in told]
    assert shares == pytest.approx([0.8, 1.0, 0.3], rel=1e-9)
    names = push.limit_states().names()
    assert [name for name in names if name.startswith("infill")] == [
        "infill_cracking", "infill_peak", "infill_residual",
    ]  # fmt: skip
    row = infills(push).iloc[0]
    assert (row["largest_force_N"], row["state"]) == (pytest.approx(bay.force), "residual")
    assert row["check_ratio"] == pytest.approx(bay.force / row["check_shear_strength_N"])
    assert "20 of 56 tested frames" in push.scope_note
    assert "nfill" not in rbsdem.pushover(drawn(1, 1), drift=0.01).scope_note
    for shown in (frame, push):
        axes = plot.frame(shown)
        labels = [text.get_text() for text in axes.get_legend().get_texts()]
        assert any(label.startswith("infill") for label in labels)
        assert not any("I-1-1" in text.get_text() for text in axes.texts)


def test_left_is_right():
    """The mirrored push of a symmetric frame: the other strut, the other sign."""
    frame = drawn(1, 1, infills=BRICK, self_weight=False)
    start = rbsdem.cyclic(frame, force=[0.0]).displacement[0]
    path = np.array([0.01, 0.03, -0.02, 0.05])
    right = rbsdem.cyclic(frame, displacement=start + path)
    other = drawn(1, 1, infills=BRICK, self_weight=False, control_node="N-2-1")
    left = rbsdem.cyclic(other, displacement=-start - path)
    np.testing.assert_allclose(left.force, -right.force, rtol=1e-6)


def test_a_storey_without_infills_is_the_soft_one():
    """Shaken, the open ground storey drifts; the energies balance."""
    frame = drawn(3, 2, infills={(0, 0): BRICK, (0, 1): None}, damping=0.03)
    push = rbsdem.pushover(frame, drift=0.02)
    assert push.storey_drift[-1, 0] > 20 * push.storey_drift[-1, 1:].max()
    t = np.arange(0.0, 4.0, 0.01)
    ground = 3.0 * np.sin(9.0 * t) * np.minimum(t, 1.0)
    quake = rbsdem.time_history(frame, t, ground_acceleration=ground, method="newmark", dt=0.0025)
    assert quake.summary["status"] == "completed"
    assert abs(quake.summary["relative_energy_residual"]) < 1e-3
    drift = np.abs(quake.storey_drift).max(axis=0)
    assert drift[0] > 3 * drift[1:].max()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Infill(0.0, 2e6), "thickness = 0 must be above 0"),
        (lambda: Infill(0.2), "fm is not given; give it, or strength"),
        (lambda: Infill(0.2, 2e6, peak_drift=0.05), "peak_drift = 0.05 must be above 0 and below"),
        (lambda: Infill(0.2, 2e6, (1.0, 0.0)), "must be its length and its height"),
        (lambda: drawn(infills=Infill(0.2, 2e6, (4.3, 1.0))),
         r"the infill in bay 1, storey 1: the opening is 4.3 m long, and the panel 4.2 m"),
        (lambda: drawn(beams={(0, 0): BEAM, (1, 2): None}, infills=BRICK),
         "the infill in bay 1, storey 2 has no beam above it"),
        (lambda: drawn(columns={(0, 0): COLUMN, (1, 1): None}, infills={(1, 1): BRICK}),
         "the infill in bay 1, storey 1 has no column beside it"),
        (lambda: drawn(infills={(1, 1): COLUMN}), "must be an Infill"),
        (lambda: drawn(infills={(3, 1): BRICK}), "infills: bay = 3, but there are 2"),
    ],
)  # fmt: skip
def test_what_an_infill_cannot_be(call, message):
    with pytest.raises(InputError, match=message):
        call()
