"""Struts between pins, springs of one side, and parts that are built after the dead load."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties
from rbsdem.errors import InputError, SolveError
from rbsdem.frames import Frame, FrameMember, FrameNode, Member
from rbsdem.springs import Elastic, PeakOriented, Pinching

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")

E = 30e9
COLUMN, BEAM = FrameMember(E, 0.04, 1.3e-4), FrameMember(E, 0.05, 2.6e-4)
STIFFNESS, STRENGTH = 40e6, 100e3
#: Cracks at 0.8 of the strength and four times the stiffness; only where it closes.
BACKBONE = {
    "d_c": 0.2 * STRENGTH / STIFFNESS, "f_c": 0.8 * STRENGTH, "d_y": STRENGTH / STIFFNESS,
    "f_y": 0.0, "f_y_neg": STRENGTH, "d_cap": STRENGTH / STIFFNESS, "f_cap": STRENGTH,
    "d_pc": 0.02, "f_res": 0.4 * STRENGTH, "b0": 0.3,
}  # fmt: skip
STRUT = PeakOriented(**BACKBONE)


def braced(kind: FrameMember, columns: FrameMember = COLUMN, **more) -> Frame:
    """Return a portal with two members across its bay."""
    nodes = itertools.pairwise(("N-1-0", "N-2-1", "N-1-1", "N-2-0"))
    members = [Member(f"D{i}", *pair, kind) for i, pair in enumerate(nodes) if i != 1]
    given = {"beam_load": 1e5, "floor_mass": 2e4, "kinematics": "pdelta"}
    return Frame.grid([1.5], [2.5], columns=columns, beams=BEAM, members=members, **given | more)


def paths(rng: np.random.Generator) -> np.ndarray:
    return rng.uniform(-8, 8, 30) * BACKBONE["d_y"]


@pytest.mark.parametrize("spring", [STRUT, Pinching(**BACKBONE, kappa_f=0.3, kappa_d=0.5)])
def test_a_side_that_carries_nothing(spring):
    """Closes on the backbone of the spring of two sides, opens at zero, closes where it opened."""
    rng, k = np.random.default_rng(7), 4 * STIFFNESS
    both = replace(spring, f_y=STRENGTH, f_y_neg=None)
    closes = -np.linspace(0, 15, 400) * BACKBONE["d_y"]
    np.testing.assert_array_equal(spring.response(closes), both.response(closes))
    other = replace(spring, f_y=STRENGTH, f_y_neg=0.0)
    for _ in range(50):
        path = paths(rng)
        fine = np.concatenate([np.linspace(a, b, 300) for a, b in itertools.pairwise([0, *path])])
        force = spring.response(fine)
        assert force.max() <= 0.0
        np.testing.assert_array_equal(other.response(-fine), -force)
        # However far it opens, nothing is changed: the way out and back leaves no trace.
        at = int(rng.choice(np.flatnonzero(force[:-1] == 0.0)))
        if fine[at] > 0:
            away = np.insert(fine, at + 1, [fine[at] + 0.3, fine[at]])
            np.testing.assert_array_equal(np.delete(spring.response(away), [at + 1, at + 2]), force)
        # A small detour has a small effect, and no loop gives energy.
        longer = np.insert(path, 11, [path[10] + 1e-6, path[10]])
        change = np.delete(spring.response(longer), [11, 12]) - spring.response(path)
        assert np.abs(change).max() <= 10 * 1e-6 * k
        work = np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(fine))
        assert work.min() >= -1e-9 * STRENGTH


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"f_y_neg": None}, "f_y = 0 and f_y_neg = 0: neither side carries anything"),
        ({"lambda_s": 100.0}, "lambda_s = 100 does nothing in a spring of one side"),
    ],
)
def test_one_side_is_refused_what_it_cannot_have(changes, message):
    with pytest.raises(InputError, match=message):
        PeakOriented(**BACKBONE | changes)


def test_a_truss_is_that_of_statics():
    """Forces by equilibrium, displacement of the load by their work; nodes do not turn."""
    area, load, h, a, b = 2e-3, 5e4, 2.0, 1.5, 2.5
    bar = FrameMember(200e9, area, 1e-6, ends="pinned")
    nodes = [
        FrameNode("a", 0, 0, "pinned"), FrameNode("b", a + b, 0, "roller"),
        FrameNode("c", a, h, push_x=1.0),
    ]  # fmt: skip
    members = [Member(pair, *pair, bar) for pair in ("ac", "bc", "ab")]
    truss = Frame(nodes=nodes, members=members, pattern="nodes", control_node="c")
    run = rbsdem.cyclic(truss, force=[load])
    lengths = np.array([np.hypot(a, h), np.hypot(b, h), a + b])
    # About a, then along x at c and at b.
    up = load * h / (a + b)
    forces = np.array([up / h * lengths[0], -up / h * lengths[1], up / h * b])
    np.testing.assert_allclose(-run.member_axial[0], forces, rtol=1e-12)
    work = float(np.sum(forces**2 * lengths) / (200e9 * area))
    assert load * run.displacement[0] == pytest.approx(work, rel=1e-12)
    assert not run.node_rotation.any()
    assert not run.moment_from.any()


def test_a_bar_between_pins_buckles_at_its_own_load():
    """Euler's load pi^2 E I/l^2, a quarter of that between clamped ends."""
    inertia, length = 1e-6, 2.0
    euler = np.pi**2 * 200e9 * inertia / length**2
    bar = FrameMember(200e9, 2e-3, inertia, ends="pinned")
    stay = FrameMember(200e9, 1e-1, 1e-3)

    def under(load: float) -> Frame:
        nodes = [
            FrameNode("a", 0, 0, "pinned"), FrameNode("b", 0, length, load_y=-load),
            FrameNode("c", 0.1, 0, "fixed"), FrameNode("d", 0.1, length), FrameNode("e", 9, 0),
        ]  # fmt: skip
        members = [Member("bar", "a", "b", bar), Member("stay", "c", "d", stay)]
        tie = FrameMember(200e9, 1e-1, 1e-3, ends="pinned")
        members.append(Member("tie", "b", "d", tie))
        return Frame(nodes=nodes[:4], members=members, kinematics="pdelta", control_node="d")

    assert under(0.99 * euler).parts.compression[0] == pytest.approx(0.99 * euler, rel=1e-3)
    with pytest.raises(SolveError, match="member bar buckles between its ends"):
        under(1.02 * euler)


def test_a_load_on_a_pinned_member_goes_to_its_nodes():
    """A beam on two pins bends the columns by nothing."""
    beam = FrameMember(E, 0.05, 2.6e-4, ends="pinned")
    frame = Frame.grid([3.0], [6.0], columns=COLUMN, beams=beam, beam_load=2e4)
    run = rbsdem.cyclic(frame, force=[0.0])
    np.testing.assert_allclose(run.member_axial[0, :2], 6e4, rtol=1e-12)
    assert np.abs(run.moment_from).max() + np.abs(run.moment_to).max() < 1e-6


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_parts_of_later_carry_no_dead_load(kinematics):
    """Columns carry what they do without them; all is in balance, in the first row too."""
    frame = braced(FrameMember.strut(STRUT, after_dead_load=True), kinematics=kinematics)
    bare = replace(frame, members=())
    compression = dict(zip(frame.parts.members, frame.parts.compression, strict=True))
    assert (compression.pop("D0"), compression.pop("D2")) == (0.0, 0.0)
    np.testing.assert_array_equal([*compression.values()], bare.parts.compression)
    push = rbsdem.pushover(frame, drift=0.02)
    assert (push.force[0], push.displacement[0]) == (
        0.0,
        rbsdem.pushover(bare, drift=0.02).displacement[0],
    )
    assert not push.springs["opening"][0].any()
    assert not push.member_axial[0, -2:].any()
    before = braced(FrameMember.strut(STRUT), kinematics=kinematics)
    assert (before.parts.compression[-2:] > 1e4).all()


def test_elastic_parts_of_later_are_those_of_a_frame_without_load():
    """By superposition: what a force adds does not know of the dead load."""
    brace = FrameMember(E, 2e-3, 1e-6, ends="pinned", after_dead_load=True)
    loaded = braced(brace, kinematics="small")
    added = [
        rbsdem.cyclic(frame, force=[0.0, 5e4, -2e4])
        for frame in (loaded, replace(loaded, beam_load=0.0))
    ]
    for name in ("x", "y", "node_rotation", "member_axial", "moment_from"):
        change, alone = (getattr(run, name) - getattr(run, name)[0] for run in added)
        np.testing.assert_allclose(change, alone, rtol=0, atol=1e-9 * np.abs(alone).max())
    np.testing.assert_array_equal(added[0].member_axial[0, -2:], 0.0)


def test_the_mirrored_push_is_the_mirrored_answer():
    frame = braced(FrameMember.strut(STRUT, after_dead_load=True))
    other = replace(frame, control_node="N-2-1")
    path = np.array([0.004, 0.02, -0.01, 0.03])
    start = rbsdem.cyclic(frame, force=[0.0]).displacement[0]
    right = rbsdem.cyclic(frame, displacement=path + start)
    left = rbsdem.cyclic(other, displacement=-path - start)
    np.testing.assert_allclose(left.force, -right.force, rtol=1e-9)


def test_a_jacket_stands_beside_its_column(tmp_path):
    """A drawn column and one of the same nodes that is built later; time and files know both."""
    steel = Steel(400e6)
    section = RectangularSection(
        0.3,
        0.3,
        Concrete(25e6),
        layout=Layout(8, 0.016, steel),
        cover=0.03,
        ties=Ties(0.008, 0.1, steel),
    )
    kind = rbsdem.section.member(section, 1.5, axial_load=1e5)
    jacket = replace(kind, after_dead_load=True, flexure=dict(kind.flexure), shear=None)
    members = [Member(f"J{line}", f"N-{line}-0", f"N-{line}-1", jacket) for line in (1, 2)]
    frame = Frame.grid(
        [1.5], [2.5], columns=kind, beams=BEAM, beam_load=1e5, members=members, floor_mass=2e4
    )
    assert not frame.parts.compression[-2:].any()
    bare = replace(frame, members=())
    path = np.linspace(0, 0.015, 50)
    strong, weak = (rbsdem.cyclic(one, displacement=path).force.max() for one in (frame, bare))
    # Without axial load of its own a jacket is the weaker of the two.
    assert 1.4 < strong / weak < 2.0
    t = np.linspace(0, 1, 101)
    shaken = rbsdem.time_history(
        frame, t, ground_acceleration=3 * np.sin(12 * t), method="newmark", dt=0.00125
    )
    assert shaken.summary["status"] == "completed"
    # As without jackets a method of second order: 0.0172, 0.0052, 0.0013 with half the step.
    assert abs(shaken.summary["energy_residual"]) < 2e-3
    file = tmp_path / "jackets.nml"
    loading = "&loading drive = 'displacement', amplitudes = 0.01 /\n"
    file.write_text(frame.to_namelist() + loading)
    assert rbsdem.read_case(file).column == frame


def test_a_frame_at_rest_with_parts_of_later_stays_at_rest():
    frame = braced(FrameMember.strut(STRUT, after_dead_load=True))
    t = np.linspace(0, 1, 201)
    run = rbsdem.time_history(frame, t, ground_acceleration=0 * t, method="newmark", dt=0.005)
    assert np.ptp(run.displacement) < 1e-12
    # Two struts that cross are as stiff as the one that is pressed.
    elastic = braced(FrameMember.strut(Elastic(0.5 * 4 * STIFFNESS), after_dead_load=True))
    periods = [rbsdem.modes(one).period[0] for one in (frame, elastic)]
    assert periods[0] == pytest.approx(periods[1], rel=1e-9)
