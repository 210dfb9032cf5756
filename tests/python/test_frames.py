"""Planar frames: closed forms, a column as a frame, what holds for any of them, and both doors."""

from __future__ import annotations

import importlib
import itertools
import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import brentq
from strategies import between, spring
from strategies_frames import RULES
from strategies_frames import frame as random_frame

import rbsdem
from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties, plot
from rbsdem.errors import InputError
from rbsdem.frames import Frame, FrameMember, FrameNode, Member
from rbsdem.model.column import bodies
from rbsdem.springs import Bilinear, Elastic, PeakOriented, Pinching, Takeda

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")

E, A, INERTIA = 30e9, 0.16, 2.1e-3
COLUMN = FrameMember(E, A, INERTIA, yield_moment=250e3, hardening=0.01)
BEAM = FrameMember(E, 0.15, 2.0e-3, yield_moment=200e3, hardening=0.01)
ELASTIC = FrameMember(E, A, INERTIA)


def three_storeys(**more) -> Frame:
    given = {"columns": COLUMN, "beams": BEAM, "floor_mass": 80e3, "beam_load": 25e3}
    return Frame.grid([3.2] * 3, [6.0] * 3, **given | {"kinematics": "pdelta"} | more)


def followed(frame, path, **more):
    """Return the path as far as it can be followed."""
    try:
        return rbsdem.cyclic(frame, displacement=path, **more)
    except rbsdem.SolveError as error:
        return error.result


def test_a_portal_yields_where_its_mechanism_does():
    """First by the stiffness method; hinges turn in their order, each at its moment."""
    plastic, h, span = 2e5, 3.0, 6.0
    column = FrameMember(E, 1e3, INERTIA, yield_moment=plastic)
    beam = FrameMember(E, 1e3, INERTIA)
    portal = Frame.grid([h], [span], columns=column, beams=beam)
    push = rbsdem.pushover(portal, drift=0.1)
    first = push.base_shear[1] / push.displacement[1]
    ratio = h / span
    exact = 24 * E * INERTIA / h**3 * (1 + 6 * ratio) / (4 + 6 * ratio)
    assert first == pytest.approx(exact, rel=1e-6)  # columns and beam hardly get longer
    # Feet before heads, each event exactly at its moment.
    assert [event.end for event in push.events] == ["start", "start", "end", "end"]
    rows = [int(np.flatnonzero(push.time == event.time)[0]) for event in push.events]
    for row, event in zip(rows, push.events, strict=True):
        moment = push.member(event.member).moment[row, event.end == "end"]
        assert abs(moment) == pytest.approx(plastic, rel=1e-12)


@pytest.mark.parametrize("v", 0.5 * np.arange(7))
def test_limit_loads_of_a_portal_are_the_least_of_three_mechanisms(v):
    """Pushed at its left corner, and v times as much down in the middle of its beam."""
    plastic, h, span = 2e5, 3.0, 6.0
    kind = FrameMember(E, A, INERTIA, yield_moment=plastic, hardening=0.0)
    nodes = [FrameNode("a", 0, 0, "fixed"), FrameNode("b", span, 0, "fixed")]
    nodes += [FrameNode("c", 0, h, push_x=1.0), FrameNode("d", span / 2, h, push_y=-v)]
    nodes += [FrameNode("e", span, h)]
    ends = ("ac", "be", "cd", "de")
    frame = Frame(nodes=nodes, members=[Member(pair, *pair, kind) for pair in ends],
                  pattern="nodes", control_node="c")  # fmt: skip
    # Some of the paths end where the beam alone gives way, which the top does not see.
    peak = followed(frame, [0.02, 0.05, 0.1, 0.5]).summary["peak_force"]
    mechanisms = [4 * plastic / h, 6 * plastic / (h + v * span / 2)]
    mechanisms += [8 * plastic / (span * v)] if v else []
    assert peak == pytest.approx(min(mechanisms), rel=1e-12)


def test_a_post_between_pins_leans_on_its_support():
    """A cantilever k = 3 E I/h^3 holds a post with the load P: H = (k - P/h) u, all of it below."""
    h, p, u = 3.0, 2e5, 0.01
    nodes = [FrameNode("a", 0.0, 0.0, "fixed"), FrameNode("b", 0.0, h, push_x=1.0)]
    nodes += [FrameNode("c", 4.0, 0.0, "pinned"), FrameNode("d", 4.0, h, load_y=-p)]
    post, tie = (FrameMember(E, area, INERTIA, ends="pinned") for area in (A, 100 * A))
    members = [Member("C", "a", "b", ELASTIC), Member("P", "c", "d", post)]
    members += [Member("B", "b", "d", tie)]
    more = {"pattern": "nodes", "control_node": "b", "kinematics": "pdelta"}
    run = rbsdem.cyclic(Frame(nodes=nodes, members=members, **more), displacement=[u])
    assert run.force[-1] == pytest.approx((3 * E * INERTIA / h**3 - p / h) * u, rel=1e-7)
    assert run.base_shear[-1] == pytest.approx(run.force[-1], rel=1e-12)


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
@pytest.mark.parametrize("seed", range(8))
def test_reactions_are_the_loads(seed, kinematics):
    """Vertical forces and moments about the origin, for any rigid ends and inclined members.

    Moments of the undeformed frame, so that they hold without second-order work.
    """
    rng = np.random.default_rng(seed)

    def kind() -> FrameMember:
        flexure = Bilinear(k=between(rng, 5e6, 5e7), d_y=1.0, k_post=1e5)
        springs = {} if rng.random() < 0.5 else {"flexure": flexure}
        return FrameMember(E, A, INERTIA, rigid_end=float(rng.uniform(0, 0.8)), **springs)

    heights = [between(rng, 2.5, 4.5) for _ in range(rng.integers(1, 4))]
    widths = [between(rng, 3, 8) for _ in range(rng.integers(1, 4))]
    loads = [float(rng.uniform(0, 3e4)) for _ in heights]
    top = heights[0]
    hung = FrameNode(
        "end", x=-2.5, y=top - float(rng.uniform(-1, 1)), load_y=-float(rng.uniform(0, 1e5))
    )
    arm = Member("arm", "N-1-1", "end", kind(), tuple(rng.uniform(0, 1, 2)), load=8e3)
    frame = Frame.grid(
        heights, widths, columns=kind(), beams=kind(), beam_load=loads, kinematics=kinematics,
        nodes=[hung], members=[arm],
    )  # fmt: skip
    lines = np.concatenate([[0.0], np.cumsum(widths)])
    feet = [f"C-{i + 1}-1" for i in range(lines.size)]
    places = [frame.parts.members.index(foot) for foot in feet]
    whole = sum(loads) * sum(widths) + 2.5 * 8e3 - hung.load_y
    assert frame.parts.compression[places].sum() == pytest.approx(whole, rel=1e-12)
    if kinematics == "pdelta":
        return
    push = rbsdem.cyclic(frame, displacement=[0.01])
    upward = push.member_axial[0, places]
    assert upward.sum() == pytest.approx(whole, rel=1e-12)
    overturning = sum(loads) * sum(widths) ** 2 / 2 - 2.5 * (2.5 * 8e3 / 2 - hung.load_y)
    # Without masses all nodes that move are pushed as their heights.
    levels = np.concatenate([np.repeat(np.cumsum(heights), lines.size), [hung.y]])
    overturning += push.force[0] * (levels**2).sum() / levels.sum()
    held = upward @ lines - push.moment_from[0, places].sum()
    assert held == pytest.approx(overturning, abs=1e-12 * whole * lines[-1])


def pressed_column(kind, axial, members=1, length=8.0, top="") -> Frame:
    """Return a cantilever of equal members, pushed at its top."""
    nodes = [FrameNode("n0", x=0, y=0, support="fixed")]
    nodes += [
        FrameNode(f"n{i}", x=0, y=length * i / members, push_x=float(i == members),
                  load_y=-axial if i == members else 0.0, mass=1e3)
        for i in range(1, members + 1)
    ]  # fmt: skip
    rows = [Member(f"m{i}", f"n{i - 1}", f"n{i}", kind) for i in range(1, members + 1)]
    if top == "guided":
        stiff = Elastic(k=1e9 * kind.modulus * kind.inertia)
        nodes[-1] = replace(nodes[-1], flexure=stiff)
    return Frame(nodes=nodes, members=rows, pattern="nodes", kinematics="pdelta")


@pytest.mark.parametrize("yields", [None, 1e12])
@pytest.mark.parametrize("members", [1, 3])
@pytest.mark.parametrize("alpha", [-0.5, 1e-3, 0.3, 0.67, 0.95])
def test_a_column_of_one_member_is_exact_under_axial_load(alpha, members, yields):
    """Design Guide 25 of AISC and its benchmark case 2: tan u/u, for any number of members.

    u^2 = P L^2/E I; in tension tanh.
    """
    kind = FrameMember(E, A, INERTIA, yield_moment=yields)
    length, rigidity, force = 8.0, E * INERTIA, 1e4
    axial = alpha * np.pi**2 * rigidity / (4 * length**2)
    root = np.emath.sqrt(axial / rigidity) * length
    moment = (force * length * np.tan(root) / root).real
    sway = (force * length**3 / rigidity * (np.tan(root) - root) / root**3).real
    push = rbsdem.cyclic(pressed_column(kind, axial, members), force=[force])
    assert push.moment_from[0, 0] == pytest.approx(-moment, rel=1e-9)
    assert push.displacement[0] == pytest.approx(sway, rel=1e-9)
    # A top that does not turn: half the length twice.
    guided = rbsdem.cyclic(pressed_column(kind, axial, members, top="guided"), force=[force])
    half = root / 2
    moment = (force * length / 2 * np.tan(half) / half).real
    sway = (force * length**3 / rigidity / 4 * (np.tan(half) - half) / half**3).real
    assert guided.moment_from[0, 0] == pytest.approx(-moment, rel=1e-7)
    assert guided.displacement[0] == pytest.approx(sway, rel=1e-7)


@pytest.mark.parametrize("yields", [None, 1e12])
@pytest.mark.parametrize("axial", [-4e6, 0.0, 1e6, 3e6])
def test_a_beam_of_two_members_is_exact_under_axial_load(axial, yields):
    """Benchmark case 1 of AISC: simply supported, under w and P: M = w/k^2 (sec(k L/2) - 1)."""
    kind = FrameMember(E, A, INERTIA, yield_moment=yields)
    w, length, rigidity = 3e3, 8.0, E * INERTIA
    nodes = [FrameNode("a", x=0, y=0, support="pinned")]
    nodes += [FrameNode("b", x=length / 2, y=0, push_y=1.0)]
    nodes += [FrameNode("c", x=length, y=0, support="roller", load_x=-axial)]
    rows = [Member("ab", "a", "b", kind, load=w), Member("bc", "b", "c", kind, load=w)]
    beam = Frame(nodes=nodes, members=rows, pattern="nodes", control="y", control_node="b",
                 kinematics="pdelta")  # fmt: skip
    still = rbsdem.cyclic(beam, force=[0.0])
    moment, sag = w * length**2 / 8, 5 * w * length**4 / (384 * rigidity)
    if axial:
        half = np.emath.sqrt(axial / rigidity) * length / 2
        moment *= (2 * (1 / np.cos(half) - 1) / half**2).real
        sag *= (12 * (2 / np.cos(half) - 2 - half**2) / (5 * half**4)).real
    assert abs(still.moment_from[0, 1]) == pytest.approx(moment, rel=1e-9)
    assert still.displacement[0] == pytest.approx(-sag, rel=1e-9)


@pytest.mark.parametrize("seed", range(6))
def test_a_pressed_frame_is_the_same_however_its_columns_are_divided(seed):
    """Random elastic frames up to near their critical load; modes are those of the matrices."""
    rng = np.random.default_rng(seed)
    heights, widths = rng.uniform(2.5, 6, rng.integers(1, 4)), rng.uniform(3, 8, rng.integers(0, 3))
    columns, beams = (FrameMember(E, 0.1, 10 ** float(rng.uniform(-3.6, -2.6))) for _ in "cb")
    while True:
        loads = [
            FrameNode(f"N-{line + 1}-{floor + 1}", load_y=-float(rng.uniform(-1e5, 6e5)))
            for floor in range(heights.size) for line in range(widths.size + 1)
        ]  # fmt: skip
        grid = {"columns": columns, "beams": beams if widths.size else None, "nodes": loads}
        try:
            frame = Frame.grid(heights, widths if widths.size else None, **grid, floor_mass=3e4,
                               kinematics="pdelta")  # fmt: skip
            periods = rbsdem.modes(frame, 2).period
            break
        except rbsdem.SolveError:
            continue  # it buckles
    parts, nodes, members = frame.parts, list(loads), []
    for name, (start, end) in zip(parts.members, parts.ends, strict=True):
        if name.startswith("C"):
            middle = (parts.y[start] + parts.y[end]) / 2
            nodes.append(FrameNode(f"X{name}", x=float(parts.x[start]), y=float(middle)))
            members.append(Member(f"{name}a", parts.nodes[start], f"X{name}", columns))
            members.append(Member(f"{name}b", f"X{name}", parts.nodes[end], columns))
    divided = replace(frame, columns={(0, 0): None}, nodes=nodes, members=members)
    one, other = (rbsdem.cyclic(each, displacement=[0.01]).force[0] for each in (frame, divided))
    assert other == pytest.approx(one, rel=1e-9)
    matrices = rbsdem.matrices(frame)
    whole, mass = matrices.stiffness + matrices.geometric, np.diag(matrices.mass)
    flexible = np.linalg.inv(whole)[np.ix_(mass > 0, mass > 0)]
    root = np.sqrt(mass[mass > 0])
    squares = np.linalg.eigvalsh(root[:, None] * flexible * root)[::-1]
    assert periods == pytest.approx(2 * np.pi * np.sqrt(squares[:2]), rel=1e-9)


def test_a_mechanism_falls_by_its_chords():
    """Hinges at both ends leave columns straight: the force falls by P/h, not by more."""
    plastic, axial, height = 2e5, 4e5, 4.0
    column = FrameMember(E, A, INERTIA, yield_moment=plastic)
    portal = Frame.grid(
        [height], [6.0], columns=column, beams=FrameMember(E, A, 10 * INERTIA),
        nodes=[FrameNode(f"N-{i}-1", load_y=-axial) for i in (1, 2)], kinematics="pdelta",
    )  # fmt: skip
    push = rbsdem.pushover(portal, drift=0.1)
    for force, top in zip(push.force[-3:], push.displacement[-3:], strict=True):
        # The axial forces of the columns do not change; their sum is the load.
        assert force == pytest.approx((4 * plastic - 2 * axial * top) / height, rel=1e-9)


def test_a_rigid_member_is_a_word(tmp_path):
    """A rigid beam on two columns sways and turns: two unknowns by hand."""
    h, b, sway = 3.0, 5.0, 0.01
    column, beam = FrameMember(E, A, INERTIA), FrameMember.rigid()
    portal = Frame.grid([h], [b], columns=column, beams=beam)
    turns = 8 * E * INERTIA / h + E * A / h * b**2 / 2
    exact = 24 * E * INERTIA / h**3 - (12 * E * INERTIA / h**2) ** 2 / turns
    push = rbsdem.cyclic(portal, displacement=[sway])
    assert push.force[0] == pytest.approx(exact * sway, rel=1e-6)
    # The case file has neither modulus nor area nor inertia of it.
    (tmp_path / "rigid.nml").write_text(
        portal.to_namelist() + "&loading drive = 'displacement', amplitudes = 0.01 /\n"
    )
    read = rbsdem.read_case(tmp_path / "rigid.nml")
    assert "interior = 'rigid' /" in portal.to_namelist()
    assert read.column == portal
    with pytest.raises(rbsdem.InputError, match="all of its members are rigid; give one of them"):
        replace(portal, columns=beam)
    # A rigid body on springs from the ground: it slides and rocks.
    slide, rock = 2e6, 3e7
    nodes = [FrameNode("0", 0, 0, "free", shear=Elastic(slide), flexure=Elastic(rock))]
    nodes += [FrameNode("0.5", 0, h / 2), FrameNode("1", 0, h, mass=1e4, push_x=1.0)]
    nodes[0] = replace(nodes[0], support="free", axial_spring=Elastic(1e9))
    members = [Member("a", "0", "0.5", beam), Member("b", "0.5", "1", beam)]
    body = Frame(nodes=nodes, members=members, pattern="nodes")
    soft = 1 / slide + h**2 / rock
    assert rbsdem.cyclic(body, displacement=[sway]).force[0] * soft == pytest.approx(sway, rel=1e-5)
    period = 2 * np.pi * np.sqrt(1e4 * soft)
    assert rbsdem.modes(body).period[0] == pytest.approx(period, rel=1e-5)


def test_unknowns_of_matrices_have_names_of_their_own():
    """Beams behind a panel turn by themselves; long names and spaces count."""
    panel = Elastic(k=1e8)
    long = "the node on the left of the roof"
    nodes = [FrameNode("foot", 0, 0, "fixed"), FrameNode(long, 0, 3, mass=1e3, panel=panel),
             FrameNode(long[:-1] + "F", 4, 3, "roller")]  # fmt: skip
    rows = [Member("C", "foot", long, ELASTIC), Member("B", long, long[:-1] + "F", ELASTIC)]
    unknowns = rbsdem.matrices(Frame(nodes=nodes, members=rows)).unknowns
    assert sorted(unknowns) == sorted(
        [f"{of}_{long}" for of in "xytb"] + [f"{of}_{long[:-1]}F" for of in "xt"]
    )


@pytest.mark.parametrize("ends", [0.0, 0.3])
def test_a_panel_between_columns_and_beams(ends):
    """A cruciform: the panel carries V H, and adds its rotation times H to the displacement.

    It cracks, reaches its strength and loses it: each is an event of the node.
    """
    half, span, k, strength = 1.5, 3.0, 4e7, 1.2e5
    names = ["foot", "head", "left", "right"]
    places = [(0.0, -half), (0.0, half), (-span, 0.0), (span, 0.0)]
    nodes = [
        FrameNode(name, *place, support, push_x=float(name == "head"))
        for name, place, support in zip(
            names, places, ["pinned", "free", "roller", "roller"], strict=True
        )
    ]
    spring = PeakOriented(
        d_c=1e-3, f_c=k * 1e-3, d_y=6e-3, f_y=strength, d_cap=0.02, f_cap=strength, d_pc=0.2
    )
    members = [
        Member(name, "node", name, FrameMember(E, 1.0, INERTIA), rigid_end=(ends, 0.0))
        for name in names
    ]

    def cruciform(panel):
        middle = FrameNode("node", 0.0, 0.0, panel=panel)
        return Frame(nodes=[*nodes, middle], members=members, pattern="nodes", control_node="head")

    rigid, soft = (rbsdem.pushover(cruciform(one), drift=1e-4) for one in (None, spring))
    flexible, stiff = (one.displacement[-1] / one.force[-1] for one in (soft, rigid))
    assert flexible - stiff == pytest.approx((2 * half) ** 2 / k, rel=1e-9)
    push = rbsdem.pushover(cruciform(spring), drift=0.2)
    turn = push.springs["rotation"][:, 0]
    assert push.displacement == pytest.approx(push.force * stiff + turn * 2 * half, rel=1e-9)
    assert push.force.max() == pytest.approx(strength / (2 * half), rel=1e-12)
    left = strength * (1 - (turn[-1] - 0.02) / 0.2) / (2 * half)
    assert push.force[-1] == pytest.approx(left, rel=1e-9)
    events = push.events
    assert [event.name for event in events] == ["cracking", "yield", "cap"]
    assert {(event.member, event.group, event.end) for event in events} == {("node", "panel", "")}


@pytest.mark.parametrize("rule", RULES)
def test_a_panel_of_one_beam_is_a_spring_at_its_end(rule):
    rng = np.random.default_rng(3)
    knee = spring(rng, rule, 1.5e5, 3e-3, options=0)
    column = FrameMember(E, A, INERTIA, yield_moment=250e3, hardening=0.02)
    beam = {"modulus": E, "area": A, "inertia": INERTIA}
    bays = {"storeys": [3.0, 3.0], "bays": [5.0], "columns": column, "kinematics": "pdelta"}
    bays |= {"floor_mass": 3e4, "beam_load": 1e4}
    panels = Frame.grid(**bays, beams=FrameMember(**beam), panel=knee)
    hinges = Frame.grid(**bays, beams=FrameMember(**beam, flexure=[knee, knee.mirrored()]))
    path = [0.05, -0.08, 0.12, 0.0]
    one, other = followed(panels, path), followed(hinges, path)
    size = np.abs(other.force).max()
    rows = min(len(one.force), len(other.force))
    assert rows == len(path) or rule in ("peak_oriented", "pinching", "compression")
    assert np.abs(one.force[:rows] - other.force[:rows]).max() < 1e-9 * size


def drawn(depth: float) -> RectangularSection:
    """A section with bars in all faces."""
    bars = Layout(8, 0.018, Steel(446e6, 702e6))
    ties = Ties(0.008, 0.1, Steel(364e6, 521e6))
    return RectangularSection(0.4, depth, Concrete(30e6), layout=bars, ties=ties, cover=0.03)


def test_a_column_of_layers_as_a_frame():
    """Layers as springs of a frame under a weight: the forces of the column, which has one spring.

    With their force at first, joints open and rotate as those of the column.
    """
    column = rbsdem.section.column(drawn(0.4), 1.6, axial_load=700e3)
    column = replace(column, kinematics="small", shear=[Elastic(k=1e9), Elastic(k=1e9)])
    hinge, above = column.joints("flexure")
    place = bodies(column)[0][0] / column.height
    kind = FrameMember(
        E, 1e3, INERTIA, flexure={0.0: hinge, place: above}, shear=Elastic(k=5e8), interior="rigid"
    )
    nodes = [FrameNode("foot", 0, 0, "fixed"), FrameNode("top", 0, 1.6, load_y=-700e3)]
    frame = Frame(nodes=nodes, members=[Member("C", "foot", "top", kind)], pattern="uniform")
    path = 1.6 * rbsdem.protocol([0.004, 0.02, 0.03], points=7)
    one, other = followed(column, path, openings=True), followed(frame, path)
    assert np.abs(other.force - one.force).max() < 1e-10 * np.abs(one.force).max()
    turned = other.springs["rotation"][:, 0]
    assert np.abs(turned - one.rotation[:, 0]).max() < 1e-12
    assert np.abs(other.springs["opening"][:, 0] - one.opening[:, 0]).max() < 1e-12
    assert np.abs(other.springs["axial_force"] + 700e3).max() < 1e-12 * 700e3
    (first,) = [event for event in other.events if event.name == "yield" and event.side == 1]
    assert first.end == "start"


@pytest.mark.parametrize(("height", "most"), [(1.35, 0.005), (4.0, 0.025)])
def test_second_order_work_of_a_drawn_member_is_that_of_its_column(height, most):
    """In double curvature against bodies that lean by themselves, between joints that crack too."""
    section, axial = drawn(0.4), 1.4e6
    column = rbsdem.section.column(section, height, axial_load=axial).double_curvature()
    kind = rbsdem.section.member(section, 2 * height, axial_load=axial)
    top = FrameNode("b", 0, 2 * height, load_y=-axial, push_x=1.0, flexure=Elastic(k=1e13))
    frame = Frame(
        nodes=[FrameNode("a", 0, 0, "fixed"), top], members=[Member("C", "a", "b", kind)],
        pattern="nodes", kinematics="pdelta",
    )  # fmt: skip
    path = 2 * height * np.array([0.002, 0.005, 0.01, 0.02])
    whole = rbsdem.cyclic(column, displacement=path).force
    force = rbsdem.cyclic(frame, displacement=path).force
    assert force == pytest.approx(whole, rel=most)
    # Uncracked the joints between the ends bend as an elastic member; on chords it is 3 % at 8 m.
    assert force[0] == pytest.approx(whole[0], rel=0.003)
    without = rbsdem.cyclic(replace(frame, kinematics="small"), displacement=path).force
    assert (without / whole - 1 > 3 * most).all()


def fixed_and_propped(divided: float, load: float, kind: FrameMember) -> Frame:
    """Return a beam of 6 m, fixed at its start and on a roller, of one member or of two."""
    nodes = [FrameNode("a", 0, 0, "fixed"), FrameNode("b", 6, 0, "roller")]
    places = ["a", "b"]
    if divided:
        nodes.append(FrameNode("m", 6 * divided, 0))
        places.insert(1, "m")
    members = [
        Member(f"B{i}", *pair, kind, load=load) for i, pair in enumerate(itertools.pairwise(places))
    ]
    return Frame(nodes=nodes, members=members, control_node="b", pattern="uniform")


def test_the_span_of_a_beam_yields_where_its_moment_is_largest():
    """Limit analysis: (6 + 4 sqrt(2)) M_p/L^2 of a propped beam, with its hinge at 0.586 L.

    Members have a point at their middle, which gives 12 M_p/L^2: what is beyond M_p between their
    points is told with its place, and a node there makes the limit load exact.
    """
    plastic, exact, place = 1e5, 6 + 4 * np.sqrt(2), 2 - np.sqrt(2)
    kind = FrameMember(E, A, INERTIA, yield_moment=plastic)

    def still(divided: float, factor: float) -> rbsdem.frames.FrameResult:
        beam = fixed_and_propped(divided, factor * plastic / 36, kind)
        return rbsdem.cyclic(beam, displacement=[0.0])

    for divided, factor in ((0.0, 12.0), (place, exact)):
        stands = still(divided, factor - 1e-6)
        assert stands.moment_from[0, 0] == pytest.approx(-plastic, rel=1e-6)
        with pytest.raises(rbsdem.SolveError, match="dead load"):
            still(divided, factor + 1e-6)
    told = r"member B0: at 0.58 of its clear length the moment in its span reaches 102952 N m"
    with pytest.warns(rbsdem.errors.AccuracyWarning, match=told):
        still(0.0, 11.9)


@pytest.mark.parametrize(("load", "tells"), [(6e3, False), (20 * 6666.7, True)])
def test_a_span_without_a_section_is_told(load, tells):
    """Springs at the ends alone: w L^2/8 in the span of a simple beam, which never yields."""
    ends = Bilinear(k=1e9, d_y=30e3 / 1e9, k_post=0.0)
    kind = FrameMember(E, A, INERTIA, flexure=[ends, ends])
    nodes = [FrameNode("a", 0, 0, "pinned"), FrameNode("b", 6, 0, "roller")]
    beam = Frame(nodes=nodes, members=[Member("B", "a", "b", kind, load=load)], control_node="b",
                 pattern="uniform")  # fmt: skip
    with warnings.catch_warnings(record=True) as notes:
        warnings.simplefilter("always")
        rbsdem.cyclic(beam, displacement=[0.0])
    ours = [str(note.message) for note in notes if "in its span" in str(note.message)]
    assert len(ours) == tells
    if tells:
        assert ours[0].startswith("member B: at 0.5 of its clear length")
        assert "600003 N m, 20 times" in ours[0]


def test_a_drawn_beam_under_load_yields_in_its_span():
    """Moments near w L^2/12 and /24, then those of its cracked sections; 8 times two M over L^2.

    The curvatures of the section along the beam and, from cracking on, the slip of bars at its
    ends add up to nothing. Without a joint in the middle the beam carries more than its section
    does, which is told.
    """
    length, ties = 8.0, Ties(0.01, 0.06, Steel(364e6, 521e6), legs=4)
    bars = Layout(8, 0.018, Steel(446e6, 702e6))
    section = RectangularSection(0.3, 0.5, Concrete(30e6), layout=bars, ties=ties, cover=0.03)
    section_moment = rbsdem.section.diagram(section, 0.0).moment.max()
    nodes = [FrameNode("a", 0, 0, "fixed"), FrameNode("c", 0, 3, push_x=1.0)]
    nodes += [FrameNode("b", length, 0, "roller", flexure=Elastic(k=1e13))]

    def bent(kind, load) -> tuple[float, float, rbsdem.frames.FrameResult]:
        rows = [Member("B", "a", "b", kind, load=load), Member("post", "a", "c", ELASTIC)]
        frame = Frame(nodes=nodes, members=rows, pattern="nodes", control_node="c")
        still = rbsdem.cyclic(frame, displacement=[1e-5])
        start, end = still.member("B").moment[0]
        return -start, load * length**2 / 8 + (start - end) / 2, still

    kind = rbsdem.section.member(section, length, load=20e3)
    plain = rbsdem.section.member(section, length)
    limit = 16 * section_moment / length**2
    curve = rbsdem.section.diagram(section, 0.0)
    rising, slip = slice(int(curve.moment.argmax())), 0.0158 * 446 * 0.018
    x = (np.arange(800) + 0.5) / 1600 * length

    def turned(end: float, load: float) -> float:
        moments = np.append(load * x * (length - x) / 2, 0.0) - end
        bend = np.interp(abs(moments), curve.moment[rising], curve.curvature[rising])
        bend *= np.sign(moments)
        slips = end > curve.events.cracking.moment
        return float(bend[:-1].mean() * length / 2 + slips * slip * bend[-1])

    for share, elastic in ((0.05, True), (0.2, False), (0.35, False), (0.5, False)):
        load = share * limit
        ends, span, _ = bent(kind, load)
        unit = load * length**2
        if elastic:
            assert (ends, span) == pytest.approx((unit / 12, unit / 24), rel=0.05)
        theirs = brentq(turned, 0.01 * unit, 0.124 * unit, args=(load,))
        assert ends == pytest.approx(theirs, rel=0.13)
    ends, span, still = bent(kind, 0.75 * limit)
    assert {("start", "yield"), ("0.5", "yield")} <= {(one.end, one.name) for one in still.events}
    assert max(ends, span) < section_moment
    with pytest.raises(rbsdem.SolveError, match="dead load"):
        bent(kind, limit)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="in its span reaches"):
        _, span, _ = bent(plain, 0.9 * limit)
    assert span > section_moment


def test_a_frame_of_drawings():
    """Cracked beams lengthen and press the columns: paths balance, more points change no bit."""
    column = rbsdem.section.member(drawn(0.4), 2.95, axial_load=400e3, rigid_end=0.25)
    beam = rbsdem.section.member(drawn(0.5), 5.6, rigid_end=0.2)
    frame = Frame.grid(
        [3.2], [6.0], columns=column, beams=beam, beam_load=20e3, floor_mass=40e3,
        kinematics="pdelta",
    )  # fmt: skip
    path = frame.height * np.array([0.005, -0.01, 0.02])
    whole = followed(frame, path)
    assert whole.summary["relative_energy_residual"] < 1e-10
    size = abs(whole.summary["peak_force"])
    assert np.abs(whole.base_shear - whole.force).max() < 1e-9 * size
    # What presses the beam presses the columns apart.
    assert np.abs(whole.member("B-1-1").axial).min() > 1e3
    fine = np.concatenate([[a + (b - a) / 2, b] for a, b in zip([0, *path[:-1]], path)])  # noqa: B905
    parts = followed(frame, fine)
    assert np.abs(parts.force[1::2] - whole.force).max() < 1e-11 * size
    motion = rbsdem.GroundMotion(3 * np.sin(0.08 * np.arange(200)), 0.01)
    shaken = rbsdem.time_history(frame, motion, method="newmark", dt=0.005)
    assert shaken.summary["relative_energy_residual"] < 1e-2
    runs = rbsdem.ensemble([frame], [motion], dt=0.005, method="newmark")
    yields = [event.time for event in shaken.events if event.name == "yield"]
    assert runs.measures["first_yield"][0] == pytest.approx(min(yields), abs=0.02)


def test_a_kind_is_refused_for_another_length():
    """Springs are made for a clear length; 1 % is what rounding of a drawing comes to."""
    kind = rbsdem.section.member(drawn(0.4), 2.7, rigid_end=0.25)
    beam = FrameMember(E, A, INERTIA)
    assert Frame.grid([2.97, 3.19], columns={(0, 1): kind, (0, 2): kind}).parts.members
    told = "member C-1-1: its clear length is 2.95 m, and the springs of member_kind 'kind-1' were "
    with pytest.raises(rbsdem.InputError, match=told + "made for 2.7 m; make a kind") as error:
        Frame.grid([3.2] * 3, [6.0], columns=kind, beams=beam)
    assert str(error.value).count("clear length") == 1


def test_floors_that_are_alike_are_one_statement(tmp_path):
    """Lists of equal values, of zeros too: the same frame, and the same from a file."""
    frame = Frame.grid([3.2, 3.0], [6.0], columns=COLUMN, beams=BEAM, floor_mass=[1e4, 1e4],
                       beam_load=[0.0, 0.0])  # fmt: skip
    assert frame == replace(frame, floor_mass=1e4, beam_load=0.0)
    push = rbsdem.pushover(frame, drift=0.01)
    push.save(tmp_path / "push.npz")
    assert rbsdem.read_result(tmp_path / "push.npz") == push


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_elastic_frames_follow_one_line(seed, kinematics):
    """The line of force and displacement passes through the state under dead load alone.

    That state has one set of axial forces: those that it causes are those whose second-order work
    it has. The round-off of members without springs is that of their own forces.
    """
    rng = np.random.default_rng(seed)
    columns, beams = (
        FrameMember(E, between(rng, 0.05, 0.5), between(rng, 5e-4, 2e-2)) for _ in "cb"
    )
    frame = Frame.grid(
        [between(rng, 2.5, 4.5) for _ in range(rng.integers(1, 7))],
        [between(rng, 3, 8) for _ in range(rng.integers(1, 5))],
        columns=columns,
        beams=beams,
        floor_mass=between(rng, 1e4, 1e5),
        beam_load=between(rng, 1e3, 3e4),
        kinematics=kinematics,
    )
    still = rbsdem.cyclic(frame, force=[0.0])
    far = 0.02 * frame.height
    pushed = rbsdem.cyclic(frame, displacement=[far, -far, still.displacement[0]])
    slope = (pushed.force[0] - pushed.force[1]) / (2 * far)
    line = slope * (pushed.displacement - still.displacement[0])
    assert pushed.force == pytest.approx(line, abs=1e-10 * abs(slope) * far)


def released_in_loops(pushed):
    """Return the energies of the loops of a push-over to the right: of loads of all storeys.

    The work of the loads while their force falls evenly from end to end of a loop, less that of it.
    """
    at = [pushed.frame.parts.nodes.index(own.name) for own in pushed.frame.nodes]
    way = pushed.x[:, at] @ [own.push_x for own in pushed.frame.nodes]
    top, force, found, begin = pushed.displacement, pushed.force, [], 0
    while (back := np.flatnonzero(np.diff(top[begin:]) < 0)).size:
        begin += back[0]
        end = begin + 1 + np.flatnonzero(top[begin + 1 :] > top[begin])[0]
        share = (top[begin] - top[end - 1]) / (top[end] - top[end - 1])
        f, s = (
            np.append(of[begin:end], of[end - 1] + share * (of[end] - of[end - 1]))
            for of in (force, way)
        )
        found.append((f[0] + f[-1]) / 2 * (s[-1] - s[0]) - np.trapezoid(f, s))
        begin = end
    return np.array(found)


@pytest.mark.filterwarnings("ignore:the path leads over snap-backs")
@pytest.mark.parametrize("seed", range(10))
def test_paths_of_capped_frames_go_through_snap_backs(seed):
    """Hinges that lose their strength: equilibrium and energy at every corner of the loops too."""
    frame = random_frame(np.random.default_rng(seed), "capped", diaphragm=False)
    share = 1 / len(frame.storeys)
    nodes = [FrameNode(f"N-1-{i + 1}", push_x=share) for i in range(len(frame.storeys))]
    frame = replace(frame, pattern="nodes", nodes=nodes)
    top = np.linspace(0, 0.05, 101)[1:] * frame.height
    pushed = rbsdem.cyclic(frame, displacement=top, corners=True)
    assert pushed.summary["status"] == "completed"
    assert np.abs(pushed.base_shear - pushed.force).max() < 1e-9 * np.abs(pushed.force).max()
    assert pushed.summary["relative_energy_residual"] < 1e-9
    goes_back = (np.diff(pushed.displacement) < 0).any()
    assert goes_back == (pushed.summary.get("snap_backs", 0) > 0)
    released = released_in_loops(pushed).clip(min=0.0).sum()
    assert pushed.summary.get("released_energy", 0.0) == pytest.approx(released, rel=1e-9)


def test_a_motion_with_the_sign_turned_has_the_mirrored_answer():
    frame, t = three_storeys(beam_load=0.0, kinematics="small"), np.arange(0, 4, 0.01)
    one, other = (
        rbsdem.time_history(frame, t, ground_acceleration=a, method="newmark").storey_drift
        for a in (5 * np.sin(9 * t), -5 * np.sin(9 * t))
    )
    assert other == pytest.approx(-one, rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_a_frame_at_rest_stays_at_rest(seed):
    """Zeros before a record are steps like all others, whatever carries the dead load.

    By symmetry nothing sways: what moves it is round-off, which is measured by the dead load.
    """
    rng = np.random.default_rng([seed, 77])
    moment = between(rng, 2e5, 5e5)
    yields = {"yield_moment": moment, "hardening": 0.02}
    kind = FrameMember(E, 0.2, 3e-3, **(yields if seed % 2 else {}))
    frame = Frame.grid(
        [3.0] * int(rng.integers(1, 7)),
        [6.0] * int(rng.integers(1, 5)),
        columns=kind,
        beams=kind,
        floor_mass=5e4,
        beam_load=float(rng.choice([0, 1e4])),
        kinematics=str(rng.choice(["small", "pdelta"])),
        damping=[0.0, 0.03, rbsdem.Damping(mass=0.2, stiffness=1e-3)][seed % 3],
    )
    t = np.arange(41) * 0.01
    ground = np.where(t < 0.2, 0.0, 2 * np.sin(30 * (t - 0.2)))
    for method in ("newmark", "hht", "generalised_alpha"):
        run = rbsdem.time_history(frame, t, ground_acceleration=ground, method=method, dt=0.01)
        assert run.summary["cut_steps"] == 0
        assert run.summary["steps"] == 40
        still = np.ptp(run.displacement[t <= 0.2])
        assert still <= 1e-9 * np.abs(run.displacement).max()


@pytest.mark.parametrize("method", ["newmark", "hht", "generalised_alpha"])
def test_steps_in_time_converge_and_balance(method):
    """The differences between steps halved fall."""
    frame = three_storeys(damping=rbsdem.Damping(mass=0.2, stiffness=1e-3))
    t = np.linspace(0, 3, 31)
    ground = 6 * np.sin(8 * t)
    tops = []
    for dt in (0.01, 0.005, 0.0025, 0.00125):
        run = rbsdem.time_history(frame, t, ground_acceleration=ground, method=method, dt=dt)
        tops.append(run.displacement)
    steps = [np.abs(b - a).max() for a, b in itertools.pairwise(tops)]
    assert steps[2] < 0.5 * steps[0] < 0.1 * np.abs(tops[0]).max()
    assert run.summary["events"] > 20
    assert run.summary["relative_energy_residual"] < 1e-2


def test_damping_of_the_present_stiffness():
    """Layers that crack and yield cut no step, and the energies balance."""
    t = np.arange(0, 3, 0.01)
    ground = {"ground_acceleration": 5 * np.sin(12 * t), "method": "newmark", "dt": 0.005}
    present = rbsdem.Damping(stiffness=2e-3, tangent=True)
    kind = rbsdem.section.member(drawn(0.4), 3.0, axial_load=4e5)
    beam = rbsdem.section.member(drawn(0.4), 5.0)
    frame = Frame.grid([3.0, 3.0], [5.0], columns=kind, beams=beam, floor_mass=4e4, damping=present)
    run = rbsdem.time_history(frame, t, **ground)
    assert run.summary["cut_steps"] == 0
    assert run.summary["relative_energy_residual"] < 1e-3
    assert any(event.name == "yield" for event in run.events)
    fine = rbsdem.time_history(frame, t, **ground | {"dt": 0.00125})
    assert run.displacement == pytest.approx(
        fine.displacement, abs=0.02 * np.ptp(fine.displacement)
    )


def test_damping_of_modes_is_that_of_each():
    """C is diagonal in the modes, and steps are those of Newmark's method on full matrices."""
    frame = three_storeys(columns=ELASTIC, beams=ELASTIC, damping=0.05)
    found = rbsdem.matrices(frame)
    mass, damping = found.mass, found.damping
    stiffness = found.stiffness + found.geometric
    heavy = np.diag(mass) > 0
    root = np.sqrt(np.diag(mass)[heavy])
    flexible = np.linalg.inv(stiffness)[:, heavy] * root
    squares, vectors = np.linalg.eigh(flexible[heavy] * root[:, np.newaxis])
    omega = 1 / np.sqrt(squares[::-1])
    shapes = flexible @ vectors[:, ::-1] * omega**2
    damped = shapes.T @ damping @ shapes
    assert damped == pytest.approx(np.diag(2 * 0.05 * omega), abs=1e-9 * omega.max())
    first = three_storeys(columns=ELASTIC, beams=ELASTIC, damping=rbsdem.Damping(modal=[0.02, 0.1]))
    damped = shapes.T @ rbsdem.matrices(first).damping @ shapes
    ratios = np.r_[0.02, 0.1, np.zeros(len(omega) - 2)]
    assert damped == pytest.approx(np.diag(2 * ratios * omega), abs=1e-9 * omega.max())

    h, t = 0.01, np.arange(0, 2.005, 0.01)
    ground = 3 * np.sin(9 * t)
    run = rbsdem.time_history(frame, t, ground_acceleration=ground, method="newmark", dt=h)
    along = np.array([name.startswith("x_") for name in found.unknowns], float)
    u, v = np.zeros((2, len(mass)))
    a = np.zeros(len(mass))
    top = [0.0]
    for now in ground[1:]:
        ahead = u + h * v + h**2 / 4 * a
        faster = v + h / 2 * a
        load = -mass @ along * now - damping @ faster - stiffness @ ahead
        a = np.linalg.solve(mass + h / 2 * damping + h**2 / 4 * stiffness, load)
        u, v = ahead + h**2 / 4 * a, faster + h / 2 * a
        top.append(u[found.unknowns.index("x_N-1-3")])
    moved = run.displacement - run.displacement[0]
    assert moved == pytest.approx(np.array(top), abs=1e-9 * np.abs(top).max())
    assert run.summary["relative_energy_residual"] < 1e-9


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_a_frame_without_springs_goes_on_from_its_state(kinematics):
    """Its position is in the unknowns alone: an elastic push is the same after a shake."""
    frame = Frame.grid(
        [3.0] * 2, [6.0], columns=ELASTIC, beams=ELASTIC, floor_mass=5e4, beam_load=1e4,
        kinematics=kinematics,
    )  # fmt: skip
    first = rbsdem.cyclic(frame, displacement=[0.02, -0.03])
    t = np.arange(51) * 0.01
    shaken = rbsdem.time_history(
        frame, t, ground_acceleration=np.sin(9 * t), method="newmark", initial=first
    )
    again = rbsdem.cyclic(frame, displacement=[0.02], initial=shaken)
    assert again.force[0] == pytest.approx(first.force[0], rel=1e-12)
    assert again.summary["relative_energy_residual"] < 1e-11


def test_tangent_damping_is_the_initial_one_while_springs_are_elastic():
    """What members damp as wholes their springs do not damp once more."""
    t = np.arange(0, 1.005, 0.01)
    runs = [
        rbsdem.time_history(
            three_storeys(damping=rbsdem.Damping(stiffness=2e-3, tangent=tangent)),
            t, ground_acceleration=0.1 * np.sin(9 * t), method="newmark",
        )
        for tangent in (False, True)
    ]  # fmt: skip
    assert runs[1].displacement == pytest.approx(runs[0].displacement, rel=1e-9)
    assert runs[1].summary["damping_energy"] == pytest.approx(runs[0].summary["damping_energy"])
    assert runs[1].summary["relative_energy_residual"] < 1e-9


def test_an_ensemble_takes_frames():
    """Measures are those of one run; a frame stands under its load at the start."""
    frame = three_storeys(damping=rbsdem.Damping(mass=0.1, stiffness=1e-3))
    (motion,) = rbsdem.motions.synthetic(1, seed=3)
    column = rbsdem.Column(3.0, 1e4, Elastic(1e9), Elastic(1e8))
    runs = rbsdem.ensemble(
        {"frame": frame, "column": column}, {"m": motion}, scales=[1.0, 2.0], method="newmark",
        measures=[
            "peak_drift", "residual_drift", "first_yield", "peak_base_shear", "peak_storey_drift",
            "residual_storey_drift", "peak_storey_drift_1", "residual_storey_drift_3",
            "peak_storey_drift_4",
        ],
    )  # fmt: skip
    alone = rbsdem.time_history(frame, motion, method="newmark")
    assert set(runs.status) == {"completed"}
    measured = {name: values[0] for name, values in runs.measures.items()}
    assert measured["peak_base_shear"] == abs(alone.summary["peak_base_shear"])
    assert measured["peak_drift"] == abs(alone.summary["peak_displacement"]) / frame.height
    yields = [event.time for event in alone.events if event.name == "yield"]
    assert measured["first_yield"] == pytest.approx(min(yields), abs=2 * motion.dt)
    drifts = abs(alone.storey_drift)
    for name, value in {
        "residual_drift": abs(alone.drift[-1]),
        "peak_storey_drift": drifts.max(),
        "residual_storey_drift": abs(alone.residual_drift).max(),
        "peak_storey_drift_1": drifts[:, 0].max(),
        "residual_storey_drift_3": abs(alone.residual_drift[2]),
    }.items():
        assert measured[name] == pytest.approx(value, rel=1e-12), name
    assert np.isnan(runs.measures["peak_storey_drift_4"]).all()
    assert np.isnan(runs.measures["peak_storey_drift"][2:]).all()
    assert "peak_storey_drift" not in rbsdem.ensemble(column, motion).measures

    ida = rbsdem.ida(frame, [motion], levels=[1.0, 2.0, 4.0], method="newmark")
    first = rbsdem.time_history(
        frame, motion.scaled(float(ida.runs.scale[0])), method="newmark", collapse_drift=0.1
    )
    assert ida.runs.measures["peak_storey_drift"][0] == pytest.approx(
        abs(first.storey_drift).max(), rel=1e-12
    )


def test_a_store_of_frames(tmp_path):
    """Two parts fill it, a third call finds all there; runs from a state are others."""
    frames = {"one": three_storeys(), "two": three_storeys(kinematics="small")}
    motions = rbsdem.motions.synthetic(2, seed=3)
    given = {
        "scales": [1.0, 2.0], "method": "newmark",
        "measures": ["peak_drift", "peak_storey_drift", "peak_storey_drift_2"],
    }  # fmt: skip
    whole = rbsdem.ensemble(frames, motions, **given)
    store = tmp_path / "store"
    half = rbsdem.ensemble(frames, motions, store=store, shard=(1, 2), **given)
    assert 0 < (half.status == "").sum() < 8
    rbsdem.ensemble(frames, motions, store=store, shard=(2, 2), **given)
    again = rbsdem.ensemble(frames, motions, store=store, **given)
    assert again.resumed == 8
    for name, values in whole.measures.items():
        np.testing.assert_array_equal(again.measures[name], values)
    state = rbsdem.cyclic(frames["one"], displacement=[0.1, 0.0])
    pushed = rbsdem.ensemble(
        frames, motions, store=store, initial={"one": state, "two": None}, **given
    )
    assert pushed.resumed == 4
    assert (pushed.measures["peak_drift"][:4] != whole.measures["peak_drift"][:4]).all()
    more = given | {"measures": [*given["measures"], "peak_storey_drift_3"]}
    assert rbsdem.ensemble(frames, motions, store=store, **more).resumed == 0


@pytest.mark.parametrize("seed", range(6))
def test_both_doors(seed, tmp_path, run_cli):
    """A random frame comes back from its text, and the executable gives the same bits."""
    frame = random_frame(np.random.default_rng(100 + seed))
    path = 0.01 * frame.height * np.array([1.0, -1.0, 0.5])
    text = (
        frame.to_namelist()
        + f"&loading drive = 'displacement', values = {', '.join(map(repr, path.tolist()))} /\n"
    )
    (tmp_path / "case.nml").write_text(text)
    case = rbsdem.read_case(tmp_path / "case.nml")
    assert case.column == frame
    done = run_cli(["run", "case.nml", "--quiet"], tmp_path)
    rows = (tmp_path / "case.csv").read_text().splitlines()[3:]
    names = rows[0].split(",")
    table = np.array([list(map(float, row.split(","))) for row in rows[1:]])
    own = followed(frame, path)
    assert (done.returncode == 0) == (own.summary["status"] == "completed")
    assert (table[:, names.index("force_N")] == own.force).all()
    nodes = len(frame.parts.nodes)
    at = names.index("x_1_m")
    assert (table[:, at : at + nodes] == own.x).all()


def test_a_support_holds_all_nodes_that_move_alike():
    """Whichever of them it is given to, and by way of any number of others."""
    nodes = [FrameNode(name, x=4.0 * i, y=3.0, mass=1e4) for i, name in enumerate("abc")]
    feet = [FrameNode(f"foot {name}", x=4.0 * i, y=0.0, support="fixed")
            for i, name in enumerate("abc")]  # fmt: skip
    rows = [Member(f"C{name}", f"foot {name}", name, ELASTIC) for name in "abc"]
    rows += [Member("ab", "a", "b", ELASTIC), Member("bc", "b", "c", ELASTIC)]

    def periods(*more) -> list[float]:
        given = [replace(node, **dict(change)) for node, change in zip(nodes, more, strict=True)]
        frame = Frame(nodes=feet + given, members=rows, control="y", control_node="a",
                      pattern="nodes")  # fmt: skip
        return rbsdem.modes(frame).period.tolist()

    nodes[0] = replace(nodes[0], push_y=1.0)
    chained = {"moves_with": "b"}, {"moves_with": "c"}, {}
    free = periods(*chained)
    assert free == pytest.approx(periods({"moves_with": "c"}, {"moves_with": "c"}, {}), rel=1e-12)
    assert len(free) == 4
    held = {"moves_with": "b"}, {"moves_with": "c", "support": "pinned"}, {}
    alone = {"support": "pinned"}
    one_by_one = periods({"shear": Elastic(k=1e15)}, alone, {"shear": Elastic(k=1e15)})
    slow = [period for period in one_by_one if period > 1e-3]
    assert periods(*held) == pytest.approx(slow, rel=1e-6)
    with pytest.raises(rbsdem.InputError, match="moves with itself, by way of node 'b'"):
        periods({"moves_with": "b"}, {"moves_with": "a"}, {})


def test_springs_from_the_ground_and_members_by_name():
    """A rocking base and a brace: what they carry is missing from the columns."""
    free = three_storeys(
        base="pinned",
        nodes=[FrameNode(f"N-{i}-0", flexure=Bilinear(4e7, 2e-3, 4e5)) for i in range(1, 5)],
    )
    braced = three_storeys(nodes=[FrameNode("N-1-3", shear=Elastic(5e6))])
    plain = rbsdem.cyclic(three_storeys(), displacement=[0.05])
    soft, stiff = (rbsdem.cyclic(frame, displacement=[0.05]) for frame in (free, braced))
    assert soft.force[0] < plain.force[0] < stiff.force[0]
    assert stiff.force[0] == pytest.approx(stiff.base_shear[0], rel=1e-9)
    member = plain.member("C-2-1")
    assert member.force.shape == member.deformation.shape == (1, 3)
    assert member.ductility.max() > 1
    assert member.axial[0] == pytest.approx(free.parts.compression[1], rel=0.2)
    with pytest.raises(rbsdem.InputError, match=r"member = 'C-9-1' .*did you mean 'C-"):
        plain.member("C-9-1")
    table = plain.to_pandas()
    assert table["moment_from_C-2-1_Nm"][0] == member.moment[0, 0]


def test_nodes_between_plastic_hinges_do_not_turn_away_in_time():
    """Their rotations have neither mass nor stiffness then, and what spins would take up energy."""
    kind = FrameMember(E, A, INERTIA, yield_moment=100e3)
    frame = Frame.grid([3.0] * 3, columns=kind, floor_mass=30e3, kinematics="pdelta")
    t = np.arange(0, 3.001, 0.01)
    run = rbsdem.time_history(frame, t, ground_acceleration=4 * np.sin(8 * t), method="newmark")
    assert np.abs(run.node_rotation).max() < 1
    assert run.summary["relative_energy_residual"] < 0.02


def test_plastic_hinges_below_and_above_a_node_share_its_rotation():
    """As their flexibilities, of which one is twice the other; round-off does not choose."""
    moment, springs = 1e5, ({1.0: 2e7}, {0.0: 4e7})
    kinds = [
        FrameMember(E, A, INERTIA, flexure={at: Bilinear(k, moment / k, 0.0)})
        for own in springs
        for at, k in own.items()
    ]
    nodes = [FrameNode("0", 0, 0, "fixed"), FrameNode("1", 0, 3)]
    nodes += [FrameNode("2", 0, 6, mass=1e4, push_x=1.0)]
    members = [Member(f"{i}", f"{i}", f"{i + 1}", kinds[i]) for i in range(2)]
    frame = Frame(nodes=nodes, members=members, pattern="nodes")
    t = np.arange(0, 8, 0.02)
    ground = 6 * np.sin(2 * np.pi * t / 1.3) * np.minimum(1, t)
    run = rbsdem.time_history(frame, t, ground_acceleration=ground, method="newmark")
    turned = run.springs["rotation"]
    assert np.abs(turned[:, 0]).max() > 0.1
    assert turned[:, 0] == pytest.approx(2 * turned[:, 1], abs=0.005 * np.abs(turned).max())


def test_a_node_between_plastic_hinges_does_not_turn_away():
    """Hinges without hardening on all sides of a node leave its rotation free: it stays."""
    kind = FrameMember(E, A, INERTIA, yield_moment=250e3)
    push = rbsdem.pushover(Frame.grid([3.2, 3.2], [6], columns=kind, beams=kind), drift=0.02)
    assert np.abs(push.node_rotation).max() < 0.1


def test_a_result_in_a_file(tmp_path):
    """It comes back bit for bit and without a warning, and goes on with the bits of one path."""
    frame = three_storeys(beam_load=0.0)
    path = frame.height * np.array([0.01, -0.02, 0.03, 0.0])
    whole = rbsdem.cyclic(frame, displacement=path)
    first = rbsdem.cyclic(frame, displacement=path[:2])
    first.save(tmp_path / "first.npz")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        back = rbsdem.read_result(tmp_path / "first.npz")
    assert back == first
    assert back != whole
    rest = rbsdem.cyclic(frame, displacement=path[2:], initial=back)
    assert (np.append(back.force, rest.force) == whole.force).all()
    first.save_state(tmp_path / "first.state")
    rest = rbsdem.cyclic(frame, displacement=path[2:], initial=tmp_path / "first.state")
    assert (rest.force == whole.force[2:]).all()

    (motion,) = rbsdem.motions.synthetic(1, seed=3)
    quake = rbsdem.time_history(frame, motion, method="newmark", motion=True)
    quake.save(tmp_path / "quake.npz")
    back = rbsdem.read_result(tmp_path / "quake.npz")
    assert back == quake
    assert (back.floor_acceleration == quake.floor_acceleration).all()


#: Three floors on three lines of columns, whose middle one goes; beams yield at their ends.
LOST = {
    "storeys": [3.0] * 3, "bays": [6.0] * 2, "base": "fixed",
    "columns": FrameMember(E, 10.0, 1e-1), "pattern": "nodes", "control": "y",
    "control_node": "N-2-1",
}  # fmt: skip


def test_a_frame_without_a_column(tmp_path):
    """The frame without it, through both doors; what is no member is told."""
    plastic = FrameMember(E, 0.15, 2e-3, yield_moment=200e3)
    frame = Frame.grid(**LOST, beams=plastic, nodes=[FrameNode("N-2-1", push_y=-1.0)])
    rest = frame.without("C-2-1")
    assert set(frame.parts.members) - set(rest.parts.members) == {"C-2-1"}
    case = tmp_path / "case.nml"
    case.write_text(rest.to_namelist() + "&loading drive = 'displacement', values = -0.5 /\n")
    assert rbsdem.read_case(case).column == rest
    with pytest.raises(rbsdem.InputError, match="did you mean 'C-2-1'"):
        frame.without("C-2-11")
    # A node that nothing joins is not there.
    bare = frame.without("C-2-3", "B-1-3", "B-2-3").parts
    assert bare.floor[bare.nodes.index("N-2-3")] == -1


@pytest.mark.parametrize("moment", [1e9, 200e3])
def test_sudden_loss_of_a_column(moment):
    """Its force is let go at once: twice the static displacement, or the energy of the push."""
    beam = FrameMember(E, 0.15, 2e-3, yield_moment=moment, hardening=0.02)
    whole = Frame.grid(**LOST, beams=beam, nodes=[FrameNode("N-2-2", load_y=-300e3, push_y=-1.0)])
    carried = whole.parts.compression[whole.parts.members.index("C-2-1")]
    # The frame without it, held by the force that it carried, in place of the column.
    held = FrameNode("N-2-1", mass=3e4, load_y=carried, push_y=-1.0)
    nodes = [FrameNode("N-2-2", load_y=-300e3), held]
    rest = Frame.grid(**LOST, beams=beam, nodes=nodes).without("C-2-1")
    t = np.arange(0, 1, 2e-4)
    fall = rbsdem.time_history(rest, t, force=np.full(t.size, carried), method="newmark", dt=2e-4)
    start = fall.displacement[0]
    furthest = (start - fall.displacement).max()
    push = rbsdem.cyclic(rest, displacement=np.linspace(start, start - 1.2 * furthest, 4000))
    sunk = start - push.displacement
    work = np.concatenate([[0], np.cumsum(np.diff(sunk) * (push.force[1:] + push.force[:-1]) / 2)])
    energy = np.interp(0.0, work[1:] - carried * sunk[1:], sunk[1:])
    assert furthest == pytest.approx(energy, rel=0.01)
    lost = replace(whole, nodes=[*nodes[:1], replace(held, load_y=0.0)], losses={"C-2-1": 0.1})
    gone = rbsdem.time_history(lost, 0.1 + t, force=0 * t, method="newmark", dt=2e-4)
    assert np.abs(gone.displacement - fall.displacement).max() < 1e-9 * furthest
    assert next(event for event in gone.events if event.name == "lost").time == 0.1
    assert np.abs(gone.member("C-2-1").axial).max() < 1e-12 * carried
    # As large as that of steps over yielding.
    assert gone.summary["relative_energy_residual"] == pytest.approx(
        fall.summary["relative_energy_residual"], rel=1, abs=1e-12
    )
    if moment > 1e6:
        still = rbsdem.cyclic(rest, force=[carried])
        assert furthest / (start - still.displacement[-1]) == pytest.approx(2.0, abs=1e-3)
    else:
        assert furthest > 1.2 * 2 * carried * sunk[1] / push.force[1]


#: A column between two others, that fails in shear.
SHEAR = PeakOriented(d_y=2e-3, f_y=60e3, d_cap=0.01, f_cap=61e3, d_pc=0.1)
BRITTLE = FrameMember(
    E, A, INERTIA, flexure=Bilinear(k=1e8, d_y=2.5e-3, k_post=1e6), shear=SHEAR, interior="rigid",
    failure_drift=0.1, failure_load=200e3,
)  # fmt: skip


def bent(middle: FrameMember = BRITTLE, **more) -> Frame:
    given = {"beams": FrameMember(E, 0.15, 4e-3), "beam_load": 30e3, "floor_mass": 60e3}
    return Frame.grid([3.0], [5.0, 5.0], columns={(0, 1): COLUMN, (2, 1): middle}, **given | more)


def test_a_factor_on_the_drift_of_axial_failure():
    frame = bent()
    kinds = frame.with_axial_failure(2.0).named_kinds
    assert sorted(str(kind.failure_drift) for kind in kinds.values()) == ["0.2", "None", "None"]
    assert frame.with_axial_failure(1.0) == frame
    with pytest.raises(InputError, match="no member has a failure_drift"):
        bent(replace(BRITTLE, failure_drift=None, failure_load=None)).with_axial_failure(2.0)
    with pytest.raises(InputError, match="must be above 0"):
        frame.with_axial_failure(0.0)


def test_a_column_that_failed_in_shear_sheds_its_load():
    """At the drift of its axial load; at rest afterwards the others carry the weight."""
    frame = bent(damping=rbsdem.Damping(mass=20.0))
    t = np.arange(0, 9, 0.005)
    force = np.interp(t, [0, 2, 6, 6.5, 9], [0, 520e3, 520e3, 0, 0])
    load = {"force": force, "method": "newmark", "dt": 0.005}
    run = rbsdem.time_history(frame, t, **load)
    (lost,) = [event for event in run.events if event.name == "lost"]
    row = int(np.flatnonzero(run.time == lost.time)[0])
    at = frame.parts.members.index("C-2-1")
    drift = np.diff(run.x[:, [1, 4]], axis=1)[:, 0] / 3.0
    limit = 0.1 / (1 + run.member_axial[:, at] / 200e3)
    assert drift[row - 1] < limit[row - 1]
    assert drift[row] >= 0.1 / (1 + run.member_axial[row - 1, at] / 200e3) * (1 - 1e-3)
    assert lost.member == "C-2-1"
    # Tests lose their load at half to two and a half times the drift.
    assert (lost.lower, lost.upper) == pytest.approx((0.5 * drift[row], 2.5 * drift[row]))
    # Shortly before it is said that it may have: not after, and not while the drift is small.
    early = int(np.argmax(np.abs(drift) > 0.25 * limit.min()))
    cuts = [rbsdem.time_history(frame, t[:n], **load | {"force": force[:n]}) for n in (early, row)]
    assert [cut.may_have_lost() for cut in (*cuts, run)] == [[], ["C-2-1"], []]
    later = rbsdem.time_history(frame.with_axial_failure(1.2), t, **load)
    assert [event.time for event in later.events if event.name == "lost"] > [lost.time]
    # What has not failed goes the same way to the bit; then it carries nothing.
    whole = rbsdem.time_history(
        bent(replace(BRITTLE, failure_drift=None, failure_load=None), damping=frame.damping),
        t[: row + 1], **load | {"force": force[: row + 1]},
    )  # fmt: skip
    assert (whole.displacement == run.displacement[: row + 1]).all()
    middle = run.member("C-2-1")
    assert np.abs(middle.moment[row:]).max() < 1e-6
    assert np.abs(middle.axial[row:]).max() < 1e-6
    weight = 30e3 * 10.0
    assert run.member_axial[-1, :3].sum() == pytest.approx(weight, rel=1e-9)
    assert whole.member_axial[-1, 1] > 0.5 * weight
    legend = plot.pushover(run).get_legend().get_texts()
    assert [text.get_text() for text in legend][-1] == "C-2-1, is lost"
    assert plot.frame(run).lines[-1].get_label() == "failed in shear"
    # Nothing of a member that is gone yields.
    assert not [e for e in run.events if e.member == "C-2-1" and e.time > lost.time]


def test_collapse_is_that_of_a_storey_unless_the_roof_is_asked_for():
    """A soft storey has nearly all of the displacement of the top."""
    soft = replace(COLUMN, yield_moment=60e3)
    storeys = {"columns": {(0, 0): COLUMN, (0, 1): soft}, "beam_load": 0.0}
    storey = three_storeys(**storeys)
    roof = three_storeys(**storeys, collapse="roof")
    path = storey.height * np.linspace(0.005, 0.1, 20)
    ends = [rbsdem.cyclic(one, displacement=path, collapse_drift=0.05) for one in (storey, roof)]
    assert [end.summary["status"] for end in ends] == ["collapsed"] * 2
    for drifts in (ends[0].storey_drift.max(axis=1), ends[1].drift):
        assert drifts[-2] < 0.05 <= drifts[-1]
    assert ends[0].drift[-1] < 0.5 * ends[1].drift[-1]
    (motion,) = rbsdem.motions.synthetic(1, seed=3)
    for one, measure in ((storey, "peak_storey_drift"), (roof, "peak_drift")):
        # Ten per cent, and a run whose storeys go beyond them ends there.
        (status,) = rbsdem.ensemble(one, motion, scales=[40.0], method="newmark").status
        run = rbsdem.time_history(one, motion.scaled(40.0), method="newmark", collapse_drift=0.1)
        assert status == run.summary["status"] == "collapsed"
        drifts = np.abs(run.drift if one is roof else run.storey_drift)
        assert drifts[:-1].max() < 0.1
        assert (
            rbsdem.ida(one, motion, levels=[1.0, 2.0], method="newmark").runs.drift_measure
            == measure
        )
    back = replace(roof, collapse="storey")
    assert back == storey != roof


@pytest.mark.parametrize("columns", [COLUMN, ELASTIC])
def test_a_loss_that_does_not_come_changes_nothing(columns):
    """The springs that could be let go are as stiff as what they stand for."""
    frame = three_storeys(columns=columns)
    t = np.arange(0, 2, 0.01)
    ground = {"ground_acceleration": 5 * np.sin(7 * t), "method": "newmark", "dt": 0.01}
    one = rbsdem.time_history(frame, t, **ground)
    kept = replace(frame, losses={"C-2-1": 3.0, "B-1-2": 3.0})
    other = rbsdem.time_history(kept, t, **ground)
    assert np.abs(one.x - other.x).max() < 1e-9 * np.abs(one.x).max()
    assert kept.parts.compression == pytest.approx(frame.parts.compression, rel=1e-9)
    assert not other.lost.any()


def test_a_run_goes_on_after_a_loss():
    """In two parts, cut before or behind it; energy is balanced where no rotation lacks inertia."""
    heads = [FrameNode(f"N-{line}-1", inertia=1e3) for line in (1, 2, 3)]
    frame = replace(bent(), losses={"C-2-1": 0.4}, nodes=heads)
    t = np.arange(0, 1.2, 0.005)
    ground = {"ground_acceleration": 4 * np.sin(6 * t), "method": "newmark", "dt": 0.005}
    whole = rbsdem.time_history(frame, t, **ground)
    for cut in (60, 80, 81, 150):
        start = {"ground_acceleration": ground["ground_acceleration"][: cut + 1]}
        first = rbsdem.time_history(frame, t[: cut + 1], **ground | start)
        end = {"ground_acceleration": ground["ground_acceleration"][cut:]}
        second = rbsdem.time_history(frame, t[cut:], **ground | end, initial=first)
        assert np.abs(second.x - whole.x[cut:]).max() < 1e-12 * np.abs(whole.x).max()
        assert (second.lost == whole.lost[cut:]).all()
    elastic = replace(frame, columns=ELASTIC, beams=ELASTIC)
    run = rbsdem.time_history(elastic, t, **ground)
    assert run.lost[-1].sum() == 1
    assert run.summary["relative_energy_residual"] < 1e-11


def test_a_run_ends_where_nothing_carries_the_load():
    """A free fall from the loss on: W t^2/(2 m), to a tenth of the storey."""
    frame = replace(bent(), losses=dict.fromkeys(["C-1-1", "C-2-1", "C-3-1"], 0.1))
    t = np.arange(0, 2, 0.005)
    run = rbsdem.time_history(frame, t, ground_acceleration=0 * t, method="newmark", dt=0.005)
    assert run.summary["status"] == "collapsed"
    fallen = 0.5 * 300e3 / 60e3 * (run.time[-1] - 0.1) ** 2
    assert fallen > 0.3 > 0.5 * 300e3 / 60e3 * (run.time[-2] - 0.1) ** 2 - 1e-3
    assert -run.y[-1, 3:].mean() == pytest.approx(fallen, rel=0.02)


def test_a_beam_that_cannot_carry_its_load_any_more_is_told():
    """Two slips against each other move no node: the nodes alone would not show it."""
    slips = PeakOriented(d_y=1e-3, f_y=65e3, d_cap=5e-3, f_cap=66e3, d_pc=5e-3)
    turns = Bilinear(k=1e8, d_y=1.2e-3, k_post=1e6)
    beam = FrameMember(
        E, A, INERTIA, flexure=turns, shear={0.0: slips, 1.0: slips}, interior="rigid"
    )
    frame = Frame.grid(
        [3.0], [6.0], columns=COLUMN, beams=beam, beam_load=20e3, floor_mass=40e3,
        damping=rbsdem.Damping(stiffness=2e-3),
    )  # fmt: skip
    t = np.arange(0, 6, 0.005)
    ground = 0.8 * t * np.sin(9 * t)
    with pytest.warns(
        rbsdem.errors.AccuracyWarning, match=r"the shear spring .* of member B-1-1 slides"
    ):
        run = rbsdem.time_history(frame, t, ground_acceleration=ground, method="newmark", dt=0.005)
    assert run.summary["status"] == "collapsed"
    assert [event.member for event in run.events if event.name == "fall"] == ["B-1-1"]
    assert 100 < run.time.size < t.size
    assert run.summary["relative_energy_residual"] < 1e-2
    assert np.abs(run.springs["slip"]).max() < 3.0


@pytest.mark.filterwarnings("ignore:frame. it has mass and no dead load")
@pytest.mark.parametrize("method", ["newmark", "hht", "generalised_alpha"])
def test_a_member_that_snaps_goes_to_the_next_equilibrium_of_its_inside(method):
    """A slip that softens faster than its elastic post springs back, with a closed form.

    The top stands still. At the cap, f = 100 kN, the post is 20 mm from its chord, and
    the slip is 2 mm. It jumps to where the post carries the residual strength of 20 kN, 4 mm from
    its chord: the post gives 960 J back, and the slip of 18 mm takes 480 J of them.
    """
    stiffness, h, cap, rest = 5e6, 3.0, 1e5, 2e4
    slips = PeakOriented(d_y=1e-3, f_y=0.99 * cap, d_cap=2e-3, f_cap=cap, d_pc=5e-3, f_res=rest)
    post = FrameMember(E, A, stiffness * h**3 / 3 / E, shear={0.5: slips})
    nodes = [FrameNode("a", 0, 0, "fixed"), FrameNode("b", 0, h, mass=2e4, push_x=1.0)]
    frame = Frame(
        nodes=nodes,
        members=[Member("post", "a", "b", post)],
        pattern="nodes",
        damping=rbsdem.Damping(mass=5.0),
    )
    t = np.arange(0, 3.9, 0.01)
    with pytest.warns(
        rbsdem.errors.AccuracyWarning, match="the shear spring 1 of member post moved"
    ):
        run = rbsdem.time_history(frame, t, force=27e3 * t, method=method, dt=0.0025)
    summary = run.summary
    assert summary["snaps"] == 1
    assert summary["snap_energy"] == pytest.approx(480.0, rel=5e-3)
    assert summary["relative_energy_residual"] < 1e-3
    (event,) = [event for event in run.events if event.name == "snap"]
    assert event.member == "post"
    row = int(np.searchsorted(run.time, event.time * (1 - 1e-12)))
    shear = np.abs(run.springs["shear"][:, 0])
    assert shear[row - 1] == pytest.approx(cap, rel=5e-3)
    assert shear[row:] == pytest.approx(rest, rel=1e-9)
    # Of the top, but for what it moves by in the steps of a row.
    slip = np.abs(run.springs["slip"][:, 0])
    assert slip[row] == pytest.approx(18e-3, abs=1e-3)


def test_a_beam_whose_joints_soften_between_nodes_that_stand_still_falls():
    """Its two ends carry 84.2 kN each at most, and have 160 kN to carry.

    Where one has passed its cap no step leads on, however short. The time of the fall does not
    depend on method and step.
    """
    steel, hoop = Steel(446e6, 702e6), Steel(364e6, 521e6)

    def section(depth: float, bar: float) -> RectangularSection:
        return RectangularSection(
            *(0.3, depth, Concrete(20e6)),
            layout=Layout(8, bar, steel),
            ties=Ties(0.008, 0.15, hoop),
            cover=0.03,
        )

    column = rbsdem.section.member(section(0.3, 0.022), 2.8, axial_load=540e3, rigid_end=0.2)
    # A beam that is weak in shear, and stays at its largest force for a while.
    weak = rbsdem.section.parameters().with_values(
        isotropic_hardening=0.0, fatigue=0.0, shear_strength=0.77, shear_cap=0.023
    )
    beam = rbsdem.section.member(section(0.4, 0.014), 8.0, model_parameters=weak)
    share = [0.5, 1.0, 0.5]
    nodes = [
        FrameNode(f"N-{i + 1}-{j}", load_y=-20e3 * share[i], mass=180e3 / 9.81 * share[i])
        for i, j in itertools.product(range(3), (1, 2, 3))
    ]
    frame = Frame.grid(
        [3.0, 3.2, 3.2],
        [8.0] * 2,
        columns=column,
        beams=beam,
        floor_mass=0.0,
        beam_load=20e3,
        nodes=nodes,
        kinematics="pdelta",
        damping=0.03,
    )
    record = rbsdem.motions.synthetic(6, seed=17)[4].scaled(pga=0.3 * 9.81)
    ends = []
    for method, dt in (("newmark", 0.005), ("newmark", 0.01), ("generalised_alpha", 0.005)):
        with pytest.warns(
            rbsdem.errors.AccuracyWarning, match="member B-[12]-[23] slides or turns away"
        ):
            run = rbsdem.time_history(
                frame,
                record.time[:320],
                ground_acceleration=record.acceleration[:320],
                method=method,
                dt=dt,
            )
        assert run.summary["status"] == "collapsed"
        assert run.summary["cut_steps"] == 0
        assert run.summary["relative_energy_residual"] < 1e-4
        ends.append(run.time[-1])
    assert np.ptp(ends) <= 0.02


def test_a_static_path_ends_where_a_column_loses_its_load():
    path = rbsdem.pushover(bent(), drift=0.08)
    assert path.summary["status"] == "ended"
    assert "C-2-1 has failed in shear and loses" in path.summary["reason"]
    assert "ended" in repr(path)
    with pytest.raises(rbsdem.InputError, match="the push-over ended on its way"):
        rbsdem.cyclic(bent(), displacement=[0.0], initial=path)
    last, before = path.displacement[-1] / 3.0, path.displacement[-2] / 3.0
    limits = 0.1 / (1 + path.member_axial[[-2, -1], 1] / 200e3)
    assert before < limits[0] < 0.08
    assert last >= limits[1]
    failed, lost = (e for e in path.events if e.name in ("shear_failure", "lost"))
    assert (failed.group, lost.group) == ("shear", "member")
    assert (failed.member, failed.name) == (lost.member, "shear_failure") == ("C-2-1", failed.name)
    assert lost.drift == path.drift[-1]
    assert lost.force == path.force[-1]
    # The spring yields at 2 mm, in the first row from there on.
    slip = np.abs(path.springs["slip"][:, 0])
    row = int(np.flatnonzero(path.time == failed.time)[0])
    assert slip[row] >= 2e-3 * (1 - 1e-9) > 0.999 * slip[row - 1]
    # In tension, or without failure in shear, nothing is lost.
    strong = replace(SHEAR, f_y=600e3, f_cap=610e3)
    rbsdem.pushover(bent(replace(BRITTLE, shear=strong)), drift=0.08)


@pytest.mark.parametrize("rule", [PeakOriented, Pinching])
def test_shear_springs_of_members_hear_the_nearest_hinge(rule):
    """Strength that decays with the work of the hinge, as in a `Column`."""
    more = {"kappa_f": 0.3, "kappa_d": 0.6} if rule is Pinching else {}
    slips = rule(
        d_y=1e-3, f_y=9e4, d_cap=2e-2, f_cap=9.2e4, d_pc=0.2, lambda_h=3.0, s_min=0.3, **more
    )
    turns = Takeda(k_c=3e8, d_c=1e-4, k_y=1e8, d_y=1e-3, k_u=4e6)
    column = rbsdem.Column(1.5, 1.0, slips, turns)
    kind = FrameMember(
        E, 1e3, INERTIA, flexure={0.0: turns, 1.0: Elastic(k=1e15)}, shear={0.0: slips},
        interior="rigid",
    )  # fmt: skip
    nodes = [FrameNode("foot", 0, 0, "fixed"), FrameNode("top", 0, 1.5, push_x=1.0)]
    frame = Frame(nodes=nodes, members=[Member("C", "foot", "top", kind)], pattern="nodes")
    path = 1.5 * rbsdem.protocol([0.005, 0.01, 0.02], cycles=2)
    one, other = rbsdem.cyclic(column, displacement=path), rbsdem.cyclic(frame, displacement=path)
    assert np.abs(other.force - one.force).max() < 1e-10 * np.abs(one.force).max()
    deaf = rbsdem.cyclic(replace(column, shear=replace(slips, lambda_h=0.0)), displacement=path)
    assert np.abs(deaf.force - one.force).max() > 0.1 * np.abs(one.force).max()


def unlike(**kind) -> dict[str, object]:
    """Return a grid of one bay whose columns differ from a member that is sound."""
    given = {"modulus": 30e9, "area": 0.15, "inertia": 2e-3}
    grid = {"storeys": [3.0], "bays": [5.0], "floor_mass": 2e4, "beam_load": 1e4}
    return grid | {"columns": FrameMember(**given | kind), "beams": FrameMember(**given)}


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ({"floor_mass": 80.0}, "floor: mass = 80 kg is that of no floor .* 40 t is 40e3"),
        ({"beam_load": 25.0}, "floor: dead_load = 25 N/m is that of no floor .* 10 kN/m is 10e3"),
        ({"storeys": [3200.0] * 3}, "storeys has lengths of 3200 .* 3200 mm is 3.2"),
        (unlike(modulus=30e3), "modulus = 30000 Pa is that of no building material"),
        (unlike(area=1.6e5, inertia=2e9), "radius of gyration of 111.803 m"),
        (unlike(yield_moment=170.0), "yield_moment = 170 N m is a stress of 17000 Pa at its edge"),
        (
            unlike(flexure=Bilinear(k=3e8, d_y=0.3, k_post=1.0)),
            "'kind-1' does not yield before a rotation of 0.2",
        ),
        (
            unlike(flexure=Bilinear(k=3e3, d_y=0.02, k_post=1.0)),
            r"a period of some [\d.]+ s is that of no building 3 m",
        ),
        (unlike(inertia=2e5, area=1e3), r"1e\+08 times as stiff in bending as 'kind-2'"),
        (unlike(yield_moment=170e3), ""),
    ],
)
def test_units_that_are_none_of_a_building_and_members_too_unlike_are_told(more, told):
    """A warning, as any of them may be meant; sound numbers are told nothing."""
    given = {"columns": COLUMN, "beams": BEAM, "floor_mass": 80e3, "beam_load": 25e3}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        Frame.grid(**{"storeys": [3.2] * 3, "bays": [6.0] * 3} | given | more)
    assert bool(caught) == bool(told)
    assert not told or any(re.search(told, str(one.message)) for one in caught)


def test_members_too_stiff_for_the_digits_are_refused():
    """Beams 1e5 times as stiff are rigid to 1e-5; 1e9 times leave too few digits, and say so."""
    columns = FrameMember(E, A, INERTIA)

    def period(ratio: float) -> float:
        beams = FrameMember(ratio * E, A, INERTIA)
        frame = Frame.grid([3.2] * 3, [6.0] * 2, columns=columns, beams=beams, floor_mass=8e4)
        return rbsdem.modes(frame, 1).period[0]

    assert period(1e5) == pytest.approx(period(1e7), rel=2e-5)
    for ratio in (1e9, 1e12, 1e15):
        with pytest.raises(rbsdem.InputError, match=r"member B-1-1: .* is so much stiffer"):
            period(ratio)


@pytest.mark.parametrize(
    ("more", "part"),
    [
        ({"beams": FrameMember(E, 1e10, INERTIA)}, "member B-1-1: along its axis it"),
        ({"panel": Elastic(1e19)}, r"node N-1-1: its panel of 1e\+19 N m/rad"),
    ],
)  # fmt: skip
def test_what_is_too_stiff_is_no_mechanism(more, part):
    """The part is named with what is rigid in its place."""
    given = {"columns": FrameMember(E, A, INERTIA), "beams": FrameMember(E, A, INERTIA)}
    with pytest.raises(rbsdem.InputError, match=f"{part} is so much stiffer.* is rigid;"):
        rbsdem.modes(Frame.grid([3.2] * 3, [5.0], floor_mass=4e4, **given | more), 1)


def test_an_inclined_member_under_load_tells_the_error_of_its_load_along_the_axis():
    """A cantilever: EI theta'' + p z theta = -w z, z from its top; the series is Airy's."""
    x, y, load, rigidity = 3.0, 2.0, 1e5, 6.3e6
    length = np.hypot(x, y)
    per_length = load * x / length
    w, p = per_length * x / length, per_length * y / length
    term = np.ones(30)  # of z^(3k) in the even solution, and of its integral
    for k in range(1, 30):
        term[k] = -term[k - 1] * p / rigidity * length**3 / (3 * k * (3 * k - 1))
    mean = np.sum(term / (3 * np.arange(30) + 1)) / np.sum(term)
    exact = w / p * (mean - 1) * y - p * length * x / (2 * rigidity / 1e-4 * 0.1)
    kind = FrameMember(rigidity / 1e-4, 0.1, 1e-4)
    error, told = [], []
    for n in (1, 2, 4):
        at = np.arange(n + 1) / n
        nodes = [
            FrameNode(f"{i}", x * a, y * a, "free" if i else "fixed") for i, a in enumerate(at)
        ]
        members = [Member(f"m{i}", f"{i}", f"{i + 1}", kind, load=load) for i in range(n)]
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            frame = Frame(nodes=nodes, members=members, kinematics="pdelta")
        path = rbsdem.cyclic(frame, force=[0.0])
        error.append(path.displacement[0] / exact - 1)
        text = " ".join(str(warning.message) for warning in caught)
        match = re.search(r"m0: it is inclined.* some ([\d.]+) per cent", text)
        told.append(0.01 * float(match[1]) if match else 0.0)
    assert told[0] == pytest.approx(error[0], rel=0.1)
    assert told[2] < 0.01
    assert 3.5 < error[0] / error[1] < 5
    assert 3.5 < error[1] / error[2] < 5


def test_a_beam_and_a_column_that_yield_at_once():
    """Equal moments of beam and columns: w = 16 M_p/L2 = 25 kN/m, though a knee might turn."""
    kind = FrameMember(E, A, INERTIA, yield_moment=100e3, hardening=0.0)
    nodes = [FrameNode("a", 0, 0, "fixed"), FrameNode("b", 8, 0, "fixed")]
    nodes += [FrameNode("c", 0, 4, push_x=1.0), FrameNode("m", 4, 4), FrameNode("d", 8, 4)]

    def portal(w: float) -> Frame:
        members = [Member("left", "a", "c", kind), Member("right", "b", "d", kind)]
        members += [Member("first", "c", "m", kind, load=w), Member("last", "m", "d", kind, load=w)]
        return Frame(nodes=nodes, members=members, pattern="nodes", control_node="c")

    assert rbsdem.cyclic(portal(24.999e3), displacement=[0.05]).force[0] > 0
    with pytest.raises(
        rbsdem.SolveError, match=r"capacity of the frame: at a share of 0\.99996 of it"
    ):
        rbsdem.cyclic(portal(25.001e3), displacement=[0.05])


@pytest.mark.parametrize("share", [0.9, 1.0, 2.0])
def test_columns_beam_and_panels_that_yield_at_once(share):
    """A portal on pins, hinges at the faces of its knees: V = 2 M_p/(clear height)."""
    kind = FrameMember(E, A, INERTIA, yield_moment=100e3, rigid_end=0.25)
    knee = 100e3 * 4.0 / 3.75
    panel = Bilinear(4e7, share * knee / 4e7, 0.0)
    frame = Frame.grid([4.0], [8.0], columns=kind, beams=kind, panel=panel, base="pinned")
    push = rbsdem.pushover(frame, drift=0.05)
    assert push.summary["status"] == "completed"
    assert push.force[-1] == pytest.approx(min(share, 1.0) * 2 * knee / 4.0, rel=1e-9)


def test_a_frame_that_buckles_under_its_dead_load():
    """A cantilever of one member under 1.1 times its critical load, which it is told."""
    critical = np.pi**2 * E * INERTIA / (4 * 4.0**2)
    nodes = [FrameNode("foot", 0, 0, "fixed")]
    nodes += [
        FrameNode(f"n{i}", 0, i, push_x=float(i == 4), load_y=-1.1 * critical * (i == 4))
        for i in range(1, 5)
    ]
    members = [
        Member(f"m{i}", n.name, o.name, ELASTIC)
        for i, (n, o) in enumerate(itertools.pairwise(nodes))
    ]
    with pytest.raises(
        rbsdem.SolveError, match=r"buckles under it: 0\.909\d* of it is the critical"
    ):
        Frame(nodes=nodes, members=members, pattern="nodes", control_node="n4", kinematics="pdelta")


def test_a_frame_that_cannot_carry_its_load_or_goes_nowhere():
    """The share of the dead load and the spring are told; a push-over needs a way."""
    with pytest.raises(
        rbsdem.SolveError, match=r"share of 0\.\d+ of it the flexural spring .* B-1-1"
    ):
        three_storeys(beam_load=1e6)
    for drift in (0.0, np.nan):
        with pytest.raises(rbsdem.InputError, match=r"drift = .* must be a finite number"):
            rbsdem.pushover(three_storeys(), drift=drift)


def test_the_frame_of_vecchio_and_emara_is_pushed_to_its_end(monkeypatch, capsys):
    """Small shares of layers in a motion are no round-off; docs/evidence.md has the numbers."""
    monkeypatch.syspath_prepend(Path(__file__).parents[2] / "studies")
    importlib.import_module("frames_measured").vecchio_emara("asce")
    assert "the path ends" not in capsys.readouterr().out


def test_a_frame_has_the_loops_of_a_column():
    """Envelope, half-cycles, idealisation and states of one record, from corner to corner."""
    frame = three_storeys(beam_load=0.0)
    path = frame.height * rbsdem.protocol([0.005, 0.02], cycles=1)
    coarse, fine = (
        rbsdem.cyclic(frame, displacement=rows)
        for rows in (path, frame.height * rbsdem.protocol([0.005, 0.02], cycles=1, points=9))
    )
    for side in (1, -1):
        one, other = coarse.envelope(side), fine.envelope(side)
        assert one.force.max() == pytest.approx(other.force.max(), rel=1e-12)
        assert one.idealise("asce_41").yield_force == pytest.approx(
            other.idealise("asce_41").yield_force, rel=1e-6
        )
    work = coarse.half_cycles().energy
    done = coarse.path.energy["input"][-1]
    assert done == pytest.approx(coarse.energy["input"][-1], rel=1e-9)
    assert work == pytest.approx(fine.half_cycles().energy, rel=1e-9)
    assert np.isnan(coarse.strength_loss())
    middle = coarse.at(0.5)
    rows = coarse.path
    assert middle["force"] == pytest.approx(np.interp(0.5, rows.time, rows.force), rel=1e-12)
    assert middle["x"] == pytest.approx(
        [np.interp(0.5, rows.time, column) for column in rows.x.T], rel=1e-9, abs=1e-15
    )
    assert middle["springs"]["moment"].shape == coarse.springs["moment"].shape[1:]


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_a_beam_beyond_its_capacity_is_told_with_the_share_that_it_carries(kinematics):
    """Three hinges between nodes that stand still: w l^2/16 is the yield moment."""
    beam = FrameMember(3e10, 0.1, 1e-3, yield_moment=1e5, hardening=0.0)
    post = FrameMember(3e10, 0.1, 1e-3)
    share = f"{16 * 1e5 / (1e5 * 6**2):.6g}"
    with pytest.raises(
        rbsdem.SolveError, match=f"capacity of the frame: at a share of {share} .*B-1-1"
    ):
        Frame.grid(
            [3.0], [6.0], columns=post, beams=beam, floor_mass=1e3, beam_load=1e5,
            kinematics=kinematics,
        )  # fmt: skip


def test_an_ida_tells_what_is_not_known_of_axial_failure():
    """Medians at both ends of the interval make a dispersion that fragilities have."""
    t = np.arange(0.0, 4.0, 0.01)
    records = [
        rbsdem.GroundMotion(np.sin(w * t) * np.minimum(t / 3.0, 1.0), 0.01, name=f"{w:g}")
        for w in (3.0, 6.0, 12.0)
    ]
    options = {
        "levels": np.geomspace(2.0, 60.0, 14), "method": "newmark", "dt": 0.01,
        "intensity": "pga", "measures": ["peak_storey_drift"],
    }  # fmt: skip
    ida = rbsdem.ida(bent(), records, **options)
    alone = rbsdem.ida(bent(), records, axial_failure=False, **options)
    assert alone.at_ends is None
    assert ida.runs.measures.keys() == alone.runs.measures.keys()
    # Where no shear spring yields nothing can be lost, and nothing is run twice.
    weak = options | {"levels": [0.1, 0.2]}
    assert rbsdem.ida(bent(), records[:1], **weak).at_ends is None
    assert rbsdem.ida(bent(), records[:1], axial_failure=np.True_, **weak).at_ends is not None
    assert rbsdem.ida(bent(), records, axial_failure=0, **options).at_ends is None
    early, late = ida.at_ends
    assert (early.collapse_intensity <= ida.collapse_intensity).all()
    assert (ida.collapse_intensity <= late.collapse_intensity).all()
    ours, theirs = (one.fragility(beta=None) for one in (ida, alone))
    assert ours.theta == theirs.theta
    ends = [end.fragility(beta=theirs.beta).theta for end in (early, late)]
    assert ours.model_beta == pytest.approx(np.log(ends[1] / ends[0]) / 2.5632, rel=1e-9)
    assert ours.beta == pytest.approx(np.hypot(theirs.beta, ours.model_beta))
    assert ida.fragility(beta=0.4).beta == 0.4
    with pytest.raises(InputError, match="leave axial_failure out"):
        rbsdem.ida(rbsdem.Column(1.0, 1e3, Elastic(1e6), Elastic(1e6)), records[0],
                   axial_failure=True)  # fmt: skip
