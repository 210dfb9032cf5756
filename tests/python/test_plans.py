"""Buildings in plan: planar frames on rigid floors, held against closed forms and planar frames."""

import pickle
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas
import pytest
from test_building import MORE, B, C

import rbsdem
from rbsdem import codes, plot
from rbsdem.__main__ import main
from rbsdem._files import figure_bytes
from rbsdem.errors import AccuracyWarning
from rbsdem.frames import Frame, FrameMember, FrameNode, Member, TeeSection
from rbsdem.methods.verification import eccentric_storey, peterson, sprung_storey
from rbsdem.run.case import case_of_text
from rbsdem.springs import Elastic, Layered
from rbsdem.web.answers import Answers

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")


@pytest.fixture(scope="module")
def grid():
    """Two frames along x and three along y that share their columns, drawn by sections."""
    more = MORE | {"ends": 1.0, "diaphragm": True}
    along_x = rbsdem.Frame.grid([3.2, 3.0], [5.6, 4.0], columns=C, beams=B, **more)
    along_y = rbsdem.Frame.grid([3.2, 3.0], [5.0], columns=C, beams=B, **more)
    along_x = replace(along_x, floor_mass=6e4)
    frames = [(along_x, 0.0, 0.0, 0.0), (along_x, 0.0, -5.0, 0.0)]
    frames += [(along_y, 90.0, x, 0.0) for x in (0.0, 5.6, 9.6)]
    return rbsdem.Building(frames, kinematics="pdelta", centres=(4.9, 2.8))


@pytest.fixture(scope="module")
def pushed(grid):
    return rbsdem.pushover(grid, drift=0.01, points=3, direction=40.0)


def test_an_eccentric_storey_yields_as_by_hand():
    building = eccentric_storey()
    # U and Theta from two equations, until each frame along x yields.
    stiff = np.array([[90e6, 5.0 * 30e6], [5.0 * 30e6, 25.0 * 90e6 + 2 * 64.0 * 40e6]])
    elastic = np.linalg.solve(stiff, [1.0, 0.0])
    first = 300e3 / (30e6 * (elastic @ [1.0, -5.0]))
    push = rbsdem.cyclic(building, displacement=[0.011], corners=True)
    assert push.force[1] == pytest.approx(first, rel=1e-9)
    last = rbsdem.cyclic(building, force=[900e3 * (1.0 - 1e-12)])
    # The softer frame, at y = 5, moves on: clockwise. Numbers are in `verify`.
    assert last.floor_rotation[-1, 0] < 0.0
    assert [event.member for event in push.events] == ["x-2:spring"]
    # Drifts at the centre, and of the corners (+-8, +-5) by hand
    u, turned = last.floor_x[-1, 0], last.floor_rotation[-1, 0]
    assert last.storey_drift_x[-1] == pytest.approx([u / 3.0], rel=1e-12)
    assert last.storey_drift_y[-1] == pytest.approx([0.0], abs=1e-12)
    furthest = np.hypot(u - 5.0 * turned, 8.0 * turned) / 3.0
    assert last.corner_drift[-1] == pytest.approx([furthest], rel=1e-12)
    # Equilibrium with the load at the centre of mass
    assert push.base_shear_x == pytest.approx(push.force, rel=1e-9)
    assert push.base_torque == pytest.approx(0.0 * push.force, abs=1e-6)
    assert push.base_shear_y == pytest.approx(0.0 * push.force, abs=1e-6)


def test_the_masses_of_petersons_building_all_move():
    modes = rbsdem.modes(peterson(), 4)
    assert modes.participation_x.sum() == pytest.approx(1.0, rel=1e-9)
    assert modes.participation_y.sum() == pytest.approx(1.0, rel=1e-9)


def test_a_building_that_is_turned_is_the_same():
    straight, turned = peterson(), peterson(30.0)
    periods = [rbsdem.modes(each, 4).period for each in (straight, turned)]
    np.testing.assert_allclose(periods[1], periods[0], rtol=1e-12)
    one, two = (rbsdem.pushover(each, drift=0.01, points=2) for each in (straight, turned))
    for name in ("force", "displacement", "floor_rotation", "plane_shear"):
        a, b = getattr(one, name), getattr(two, name)
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-12 * np.abs(a).max(), err_msg=name)


def test_one_frame_is_itself_in_every_direction(grid):
    frame = replace(grid.planes[0].frame, kinematics="pdelta")
    alone = rbsdem.pushover(frame, drift=0.015, points=5, method="static")
    building = rbsdem.Building([(frame, 0.0, 0.0)], kinematics="pdelta")
    push = rbsdem.pushover(building, drift=0.015, points=5, method="static")
    inside = push.frame("x-1")
    for name in ("x", "moment_from", "member_axial", "base_shear"):
        a, b = getattr(alone, name)[-1], getattr(inside, name)[-1]
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-12 * np.abs(a).max(), err_msg=name)
    assert push.force[-1] == pytest.approx(alone.force[-1], rel=1e-13)
    assert push.summary["peak_base_shear"] == pytest.approx(np.abs(alone.force).max(), rel=1e-12)
    # The dead load moves the frame by round-off along x before it is pushed.
    assert alone.summary["peak_base_shear"] == pytest.approx(np.abs(alone.force).max(), rel=1e-12)
    assert [event.name for event in inside.events] == [event.name for event in alone.events]
    turned = rbsdem.Building([(frame, 90.0, 0.0)], kinematics="pdelta", direction=90.0)
    other = rbsdem.pushover(turned, drift=0.015, points=5, method="static")
    np.testing.assert_array_equal(other.floor_y, push.floor_x)
    assert not np.any((other.floor_x, other.floor_rotation))
    # Two of it without eccentricity are one of twice everything.
    pair = rbsdem.Building([(frame, 0.0, 5.0), (frame, 0.0, -5.0)], kinematics="pdelta")
    both = rbsdem.pushover(pair, drift=0.015, points=5, method="static")
    assert both.force[-1] == pytest.approx(2.0 * push.force[-1], rel=1e-12)
    assert np.abs(both.floor_rotation).max() < 1e-14
    assert pickle.loads(pickle.dumps(pair)) == pair


def test_a_column_in_two_planes_has_one_axial_force(grid, pushed):
    parts = grid.parts
    axial = dict(zip(parts.members, parts.compression.tolist(), strict=True))
    assert len(grid.axial_of) == 12
    for second, first in grid.axial_of.items():
        assert axial[second] == pytest.approx(axial[first], rel=1e-12)
    # All loads on all beams
    loads = 2 * 2 * 23e3 * 9.6 + 3 * 2 * 23e3 * 5.0
    feet = [axial[name] for name in axial if name.startswith("x") and name.endswith("-1")]
    columns = [one for one in axial if one.startswith("x") and ":C-" in one and one[-2:] == "-1"]
    assert sum(axial[one] for one in columns) == pytest.approx(loads, rel=1e-12)
    assert len(feet) > len(columns)
    for second, first in grid.axial_of.items():
        frames, names = zip(*(one.split(":") for one in (first, second)), strict=True)
        one, two = (
            pushed.frame(frame).member(name).axial
            for frame, name in zip(frames, names, strict=True)
        )
        np.testing.assert_allclose(two, one, rtol=1e-9)


def test_a_wall_along_y_has_the_axial_force_of_its_post():
    """The plane of its post is the first of the two; rows of both planes are of the same time."""
    house = rbsdem.Building.grid(
        [3.2], [5.0], [5.0], columns=C, beams_x=B, beams_y=B, walls={("y", 1, 1): W},
        floor_load=6e3, mass="from_loads",
    )  # fmt: skip
    push = rbsdem.cyclic(house, displacement=[0.01, -0.01])
    post, wall = (push.frame(name).member("C-1-1").axial for name in ("x-1", "y-1"))
    np.testing.assert_array_equal(post, wall)
    assert abs(wall[1] - wall[0]) > 1e3


def test_other_kinds_are_those_of_columns_in_two_planes_too(grid):
    softer = {name: replace(kind, modulus=2e10) for name, kind in grid.named_kinds.items()}
    assert {member.kind.modulus for member in grid.with_kinds(softer).members} == {2e10}


def test_joints_of_layers_of_both_planes_open_in_series():
    ends = [Layered([(-0.2, Elastic(k)), (0.2, Elastic(k))]) for k in (4e8, 7e8)]
    frames = []
    for joint in ends:
        column = FrameMember(3e10, 0.16, 2e-3, flexure={0.0: joint})
        nodes = [
            FrameNode("foot", 0.0, 0.0, support="fixed", floor=0),
            FrameNode("top", 0.0, 3.0, floor=1, load_y=-2e5, mass=1e3),
        ]
        frames.append(Frame(nodes=nodes, members=[Member("column", "foot", "top", column)]))
    arms = [(frames[0], 0.0, 0.0, 0.0), (frames[1], 90.0, 0.0, 0.0)]
    arms.append((sprung_storey(Elastic(1e7)), 0.0, 4.0))
    building = rbsdem.Building(arms)
    rows = rbsdem.cyclic(building, displacement=[1e-9])
    flexible = 3.0 / (3e10 * 0.16) + 1 / 8e8 + 1 / 14e8
    assert rows.frame("x-1").y[-1, 1] == pytest.approx(-4e5 * flexible, rel=1e-9)
    for name, k in (("x-1", 8e8), ("y-1", 14e8)):
        assert rows.frame(name).springs["opening"][-1, 0] == pytest.approx(-4e5 / k, rel=1e-9)


def test_a_drawn_column_in_two_planes_is_as_stiff_along_its_axis_as_in_frames_alone():
    """Of two depths the mean of both; a case file states what the frames have, and is solved so."""
    for section in (C, replace(C, width=0.6)):
        frames = []
        for bent in (section, section.turned):
            column = rbsdem.section.member(bent, 3.0, axial_load=5e5)
            nodes = [
                FrameNode("foot", 0.0, 0.0, support="fixed", floor=0),
                FrameNode("top", 0.0, 3.0, floor=1, load_y=-1e4, mass=1e3),
            ]
            frames.append(Frame(nodes=nodes, members=[Member("column", "foot", "top", column)]))
        # 1e4 N on each frame, on the column of both twice as much
        alone = sum(-rbsdem.cyclic(one, displacement=[1e-9]).y[-1, 1] for one in frames)
        for one, two in (frames, frames[::-1]):
            arms = [(one, 0.0, 0.0, 0.0), (two, 90.0, 0.0, 0.0)]
            building = rbsdem.Building([*arms, (sprung_storey(Elastic(1e7)), 0.0, 4.0)])
            push = "&loading drive = 'displacement', values = 1e-9 /\n"
            case = case_of_text(building.to_namelist() + push)
            assert case.column == building
            again = building.changed(centres=(0.0, 0.0)).with_kinds({})
            rows = [rbsdem.cyclic(each, displacement=[1e-9]) for each in (building, again)]
            for each in (*rows, case.run()):
                assert -each.frame("x-1").y[-1, 1] == pytest.approx(alone, rel=1e-9)


@pytest.mark.parametrize("load", [0.0, 5e6])
def test_second_order_work_of_columns_in_translation_and_torsion(load):
    # k - P/h along x and y, and the sum of r^2 (k - P/h) about the centre
    springs = {0.0: 20e6, 90.0: 30e6}
    frames = [
        (sprung_storey(Elastic(k), mass=1e5, load=load), angle, arm)
        for angle, k in springs.items()
        for arm in (-4.0, 4.0)
    ]
    modes = rbsdem.modes(rbsdem.Building(frames, inertia=3e6, kinematics="pdelta"), 3)
    net = {angle: 2 * (k - load / 3.0) for angle, k in springs.items()}
    squares = sorted([net[0.0] / 4e5, net[90.0] / 4e5, 16.0 * sum(net.values()) / 3e6])
    assert np.sort(modes.omega**2) == pytest.approx(squares, rel=1e-10)


def test_energy_of_a_record_in_two_directions(grid):
    time = np.arange(0.0, 1.0, 0.01)
    swing = 6.0 * np.sin(np.pi * time)
    pair = swing * np.sin(7.0 * time), -swing * np.sin(5.0 * time)
    motions = tuple(rbsdem.GroundMotion(each, 0.01) for each in pair)
    settings = {"method": "newmark", "dt": 0.01, "motion": True}
    with pytest.warns(AccuracyWarning, match="both of its planes are beyond yield"):
        quake = rbsdem.time_history(grid, motions, **settings)
    # Joints of layers and their snaps; of one frame alone it is 8e-3.
    assert quake.summary["relative_energy_residual"] < 1e-3
    assert set(quake.both_planes) <= set(grid.axial_of.values())
    # What a corner does, from the frames that meet there
    at = quake.drift_at((9.6, 5.0))
    of_frames = [quake.frame(name).storey_drift for name in ("x-2", "y-3")]
    np.testing.assert_allclose(np.stack(of_frames, axis=-1), at, atol=1e-12)
    largest = np.abs([quake.frame(one.name).storey_drift for one in grid.planes]).max()
    assert quake.corner_drift.max() >= largest
    # Forces of the ground balance those of the masses.
    mass = 6e4 * 2
    total = quake.plane_shear @ [plane.direction[1] for plane in grid.planes]
    moved = quake.frame("y-1").floor_acceleration
    turned = [quake.frame(f"y-{i}").floor_acceleration for i in (1, 2, 3)]
    centre = turned[0] + (turned[2] - turned[0]) * 4.9 / 9.6
    assert moved.shape == centre.shape
    lost = np.abs(total + mass * centre.sum(axis=1))
    assert lost.max() < 1e-6 * np.abs(total).max()


def test_a_whole_building_comes_back(grid, tmp_path):
    again = pickle.loads(pickle.dumps(grid))
    assert again == grid
    assert rbsdem.Building(**grid._given) == grid
    loading = "&loading drive = 'displacement', values = 0.01 /\n"
    case = case_of_text(grid.to_namelist() + loading)
    assert case.column == grid
    # Its sections come with it: what is judged is what was drawn.
    for name, kind in grid.kinds.items():
        read = case.column.kinds[name]
        assert (read.sections, read.shear_spans) == (kind.sections, kind.shear_spans)
    saved = case.run()
    saved.save(tmp_path / "push.npz")
    opened = rbsdem.read_result(tmp_path / "push.npz")
    assert opened == saved
    judged = [codes.assess(one, "en_1998_3").to_pandas() for one in (saved, opened)]
    pandas.testing.assert_frame_equal(*judged)
    one, two = (rbsdem.pushover(each, drift=0.003, points=2) for each in (grid, again))
    np.testing.assert_array_equal(one.force, two.force)


def test_columns_are_assessed_in_both_planes(grid, pushed):
    of_building = codes.assess(pushed, "en_1998_3").to_pandas().set_index(["member", "end", "face"])
    both = of_building.xs("both planes", level="face")
    assert len(both) == 2 * len(grid.axial_of)
    for name in ("ratio_NC", "ratio_shear"):
        largest = (
            of_building.drop(index="both planes", level="face")[name].groupby(level=[0, 1]).max()
        )
        for second, first in grid.axial_of.items():
            pair = largest[first, "end"], largest[second, "end"]
            assert both.loc[(first, "end"), name] == pytest.approx(np.hypot(*pair), rel=1e-12)
    alone = codes.assess(pushed.frame("y-2"), "en_1998_3").to_pandas()
    inside = of_building.reset_index()
    inside = inside[inside["member"].str.startswith("y-2:")]
    np.testing.assert_array_equal(inside["ratio_NC"], alone["ratio_NC"])


def test_targets_are_amplified_by_torsion_of_the_modes():
    stiff, arms = np.array([60e6, 30e6]), np.array([5.0, -5.0])
    frames = [(sprung_storey(Elastic(k)), 0.0, arm) for k, arm in zip(stiff, arms, strict=True)]
    frames += [(sprung_storey(Elastic(40e6)), 90.0, x) for x in (-8.0, 8.0)]
    building = rbsdem.Building(frames, floor_mass=1e5, inertia=2e6)
    push = rbsdem.pushover(building, displacement=0.01, points=2)
    found = codes.target(push, codes.DesignSpectrum.table([0.01, 5.0], [1.0, 1.0]), "en_1998")
    # Two modes by hand, their complete quadratic combination under 1 m/s2
    turning = arms**2 @ stiff + 2 * 64.0 * 40e6
    k = np.array([[stiff.sum(), arms @ stiff], [arms @ stiff, turning]])
    half = np.diag([1e5, 2e6]) ** 0.5
    squares, shapes = np.linalg.eigh(np.linalg.solve(half, np.linalg.solve(half, k).T))
    omega, shapes = np.sqrt(squares), np.linalg.solve(half, shapes)
    size = 1e5 * shapes[0] / squares
    r = np.divide.outer(omega, omega)
    close = 8 * 0.05**2 * (1 + r) * r**1.5 / ((1 - r**2) ** 2 + 4 * 0.05**2 * r * (1 + r) ** 2)
    at = {0.0: (1.0, 0.0), "x-1": (1.0, 5.0), "x-2": (1.0, -5.0)}
    elastic = {
        name: np.sqrt((size * (f @ shapes)) @ close @ (size * (f @ shapes)))
        for name, f in at.items()
    }
    u = np.linalg.solve(k, [1.0, 0.0])
    by_hand = {
        name: max(max(elastic[name] / elastic[0.0], 1.0) / (at[name] @ u / u[0]), 1.0)
        for name in ("x-1", "x-2")
    }
    assert found.torsion == pytest.approx(by_hand, rel=1e-9)
    assert max(by_hand.values()) > 1.1
    # The elastic period is that of its mode.
    assert found.curve.period == pytest.approx(2 * np.pi / omega[np.abs(1e5 * shapes[0]).argmax()])
    # The mode that moves the most mass, on the line of the push-over
    assert found.curve.gamma * found.curve.modal_mass == pytest.approx(max((1e5 * shapes[0]) ** 2))
    assert found.storey_drift == pytest.approx(
        [found.displacement / 3.0 / u[0] * np.hypot(u[0] - 5 * u[1], 8 * u[1])], rel=1e-9
    )


def test_the_report_of_a_building_has_its_frames(tmp_path, monkeypatch):
    # Of its figures the plans and the building are painted; all takes longer than the rest.
    painted: list[bytes] = []

    def first_three(drawn, ending):
        painted.append(figure_bytes(drawn, ending) if len(painted) < 3 else b"")
        return painted[-1]

    monkeypatch.setattr("rbsdem.web.sheets.figure_bytes", first_three)
    # Masses of a grid in plan are those of its floors, and its frames have none.
    building = plan(floor_load=6e3, mass="from_loads")
    push = rbsdem.pushover(building, displacement=0.01, points=2)
    text = rbsdem.report(push, tmp_path / "house.html").read_text()
    for heading in ("Inputs", "Building", "x-1 Frame", "x-1 Response", "x-1 Members"):
        assert f"<h2>{heading}</h2>" in text
    assert [b"Floor 2" in figure for figure in painted[:3]] == [True, True, False]
    assert all(b"</svg>" in figure for figure in painted[:3])
    tables = {path.name for path in (tmp_path / "house_files").iterdir()}
    assert {"inputs.csv", "x_1_members.csv", "rows.csv"} <= tables


def test_what_is_of_one_frame_refuses_a_building(pushed):
    found = codes.assess(pushed, "en_1998_3")
    with pytest.raises(rbsdem.InputError, match=r"assessment.frame\('x-1'\)"):
        plot.assessment(found)


@pytest.mark.usefixtures("without_figures")
def test_the_command_line_runs_pairs_and_reports(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["rbsdem", *words])
        return main()

    house = plan(floor_load=6e3, mass="from_loads", damping=0.05)
    solver = "&analysis method = 'newmark', dt = 0.01 /\n"
    Path("house.nml").write_text(house.to_namelist() + solver)
    pair = swings(0), swings(1)
    for name, swing in zip(("quake_x.csv", "quake_y.csv"), pair, strict=True):
        table = np.column_stack((swing.time, swing.acceleration))
        np.savetxt(name, table, delimiter=",", header="time_s,acceleration_m/s2", comments="")
    records = ["house.nml", "quake_x.csv", "quake_y.csv", "--pairs"]
    assert run("ensemble", *records, "--out", "a") == 0
    drift = pandas.read_csv("a/runs.csv").peak_storey_drift
    direct = rbsdem.ensemble(house, [pair], method="newmark", dt=0.01)
    assert drift.to_numpy() == pytest.approx(direct.measures["peak_storey_drift"], rel=1e-5)
    assert run("ida", *records, "--levels", "1,2", "--out", "b") == 0
    assert len(pandas.read_csv("b/ida.csv")) == 2
    assert run("ida", *records[:2], "--pairs", "--levels", "1") == 2
    assert "1 records are no pairs" in capsys.readouterr().err
    loading = "&loading drive = 'displacement', values = 0.01 /\n"
    Path("push.nml").write_text(house.to_namelist() + loading)
    assert run("run", "push.nml", "--report") == 0
    assert "<h2>x-1 Response</h2>" in Path("push.html").read_text()
    # A report of many runs has the plan too, and does not say that torsion is left out.
    text = rbsdem.report(rbsdem.ida(house, [pair], levels=[1.0], **SHAKEN), "ida.html").read_text()
    assert "Building(2 storeys" in text
    assert "Left out: infills" in text


SHAKEN = {"method": "newmark", "dt": 0.01}


def swings(number, size=200):
    """Motions of two frequencies, of unlike lengths, names and peaks."""
    time = 0.01 * np.arange(size)
    values = np.sin((5.0 + number) * time) + 0.5 * np.sin((23.0 - 2.0 * number) * time)
    return rbsdem.GroundMotion((2.0 + number) * values, 0.01, f"swing {number}")


@pytest.fixture(scope="module")
def house():
    """A storey that yields along x and y, in all its frames."""
    return eccentric_storey().changed(floor_mass=2e5, inertia=8e6, damping=0.03)


def test_runs_of_pairs_are_those_of_one_by_one(house, tmp_path):
    x, y, z = swings(0), swings(1, size=150), swings(2)
    pairs = {"first": (x, y), "second": (y, x), "third": (x, z), "alone": x}
    scales = [0.5, 3.0]
    settings = SHAKEN | {"store": tmp_path}
    runs = rbsdem.ensemble(house, pairs, scales=scales, **settings)
    for run, (motion, scale) in enumerate(zip(runs.motion, runs.scale, strict=True)):
        record = list(pairs.values())[motion]
        parts = record if isinstance(record, tuple) else (record,)
        scaled = [replace(part, acceleration=scale * part.acceleration) for part in parts]
        loading = tuple(scaled) if len(scaled) == 2 else scaled[0]
        alone = rbsdem.time_history(house, loading, collapse_drift=0.1, **SHAKEN)
        assert np.array_equal(runs.history(run).displacement, alone.displacement)
        assert np.array_equal(runs.history(run).floor_y, alone.floor_y)
        of_frames = [abs(frame.storey_drift).max() for frame in alone.frames.values()]
        assert runs.measures["peak_storey_drift"][run] == pytest.approx(max(of_frames), rel=1e-12)
        for name in ("peak_displacement", "peak_base_shear"):
            assert runs.measures[name][run] == alone.summary[name]
    # What is kept of one pair is not that of another with the same motion along x.
    again = rbsdem.ensemble(house, [(x, swings(3)), (x, y)], scales=scales, **settings)
    assert again.resumed == 2
    assert list(again.motions) == ["swing 0 and swing 3", "swing 0 and swing 1"]


def test_rest_follows_the_shorter_record_of_a_case():
    house = plan(floor_load=6e3, mass="from_loads", damping=0.05)
    pair = swings(0), swings(1, size=150)
    text = house.to_namelist() + "&analysis method = 'newmark', dt = 0.01 /\n"
    for drive, swing in zip(("ground_acceleration", "ground_acceleration_y"), pair, strict=True):
        values = ", ".join(map(repr, swing.acceleration.tolist()))
        text += f"&loading drive = '{drive}', interval = 0.01, values = {values} /\n"
    of_case, alone = case_of_text(text).run(), rbsdem.time_history(house, pair, **SHAKEN)
    np.testing.assert_array_equal(of_case.floor_y, alone.floor_y)
    # On the page it is drawn, and saved as the same case.
    page = Answers()
    state = page.open({"text": text}, None)["state"]
    saved = page.export({"state": state, "form": "namelist"}, None)["text"]
    assert case_of_text(saved) == case_of_text(text)


def test_a_record_along_y_in_another_unit_is_told(house):
    record = 981.0 * np.sin(np.arange(20))
    with pytest.warns(AccuracyWarning, match="no ground has moved with more than 5 g"):
        rbsdem.time_history(
            house, 0.01 * np.arange(20), ground_acceleration_y=record, method="newmark", dt=0.01
        )


@pytest.mark.usefixtures("without_figures")
def test_the_intensity_of_a_pair_is_of_both_components(house, tmp_path):
    pairs = {"a": (swings(0), swings(1)), "b": (swings(2), swings(0))}
    period = 1.0 / rbsdem.modes(house).frequency[0]
    each = np.array([[part.sa(period) for part in pair] for pair in pairs.values()])
    wanted = {"larger": each.max(axis=1), "geometric_mean": np.sqrt(each.prod(axis=1))}
    for name, unit in wanted.items():
        found = rbsdem.ida(house, pairs, levels=[2.0, 30.0], intensity=name, **SHAKEN)
        runs = found.runs
        np.testing.assert_allclose(runs.scale, runs.intensity / unit[runs.motion], rtol=1e-12)
        usual = name.replace("_", " ") if name == "geometric_mean" else "larger component"
        assert usual in runs.measure.label
    default = rbsdem.ida(house, pairs, levels=[2.0, 30.0], **SHAKEN).runs
    assert np.array_equal(default.scale, runs.scale)
    peaks = rbsdem.ida(house, pairs, levels=[2.0], intensity="pga", **SHAKEN).runs.scale
    both = [np.sqrt(x.pga * y.pga) for x, y in pairs.values()]
    np.testing.assert_allclose(peaks, 2.0 / np.array(both), rtol=1e-12)
    drift = found.runs.measures["peak_storey_drift"]
    limit = np.sqrt(drift.min() * drift.max())
    assert 2.0 < found.fragility("peak_storey_drift", limit, beta=0.4).theta < 30.0
    text = rbsdem.report(found, tmp_path / "ida.html").read_text()
    assert "geometric mean" in text
    # A factor of both: a pair of twice the size is the same record.
    twice = {
        name: tuple(replace(part, acceleration=2.0 * part.acceleration) for part in pair)
        for name, pair in pairs.items()
    }
    same = rbsdem.ida(house, twice, levels=[2.0, 30.0], **SHAKEN).runs
    assert np.array_equal(same.measures["peak_storey_drift"], drift)


def coarse(motion):
    return rbsdem.motions.resampled(motion, 0.02)


def planar():
    return sprung_storey(Elastic(1e7), mass=1e3, load=1e4)


@pytest.mark.parametrize(
    ("call", "told"),
    [
        (lambda h: rbsdem.ensemble(h, (swings(0), swings(1))), "motions is a tuple of two"),
        (lambda h: rbsdem.ida(h, (swings(0), swings(1))), "motions is a tuple of two"),
        (
            lambda h: rbsdem.fragility.stripes(h, {2.0: (swings(0), swings(1))}),
            "motions is a tuple of two",
        ),
        (
            lambda h: rbsdem.ensemble(planar(), [(swings(0), swings(1))], **SHAKEN),
            "nothing of it moves along y",
        ),
        (
            lambda h: rbsdem.ida(planar(), [(swings(0), swings(1))], **SHAKEN),
            "nothing of it moves along y",
        ),
        (
            lambda h: rbsdem.ensemble(h, [(swings(0), coarse(swings(1)))]),
            "motion 'swing 0 and swing 1': .*steps differ",
        ),
        (lambda h: rbsdem.ensemble(h, [[swings(0), swings(1)]]), "a list is not a motion"),
        (lambda h: rbsdem.time_history(h, [swings(0)] * 3), "3 motions at once"),
        (lambda h: rbsdem.ida(h, [swings(0)], intensity="larger"), "'larger' is of pairs"),
        (
            lambda h: rbsdem.ensemble(h.changed(collapse="roof"), [(swings(0), swings(1))]),
            "column 0: collapse = 'roof' is a drift along one direction",
        ),
    ],
)
def test_pairs_that_cannot_be_run_are_refused(house, call, told):
    with pytest.raises(rbsdem.InputError, match=told):
        call(house)


def halved(frame):
    """Return a frame with a node in the middle of its column."""
    post, spring = frame.members
    foot, top = (node for node in frame.nodes if node.name in (post.start, post.end))
    middle = FrameNode("middle", foot.x, 0.5 * (foot.y + top.y))
    kind = replace(post.kind, ends="continuous")
    halves = [Member("low", foot.name, "middle", kind), Member("high", "middle", top.name, kind)]
    return replace(frame, nodes=[*frame.nodes, middle], members=[*halves, spring])


REFUSED = [
    (lambda f: rbsdem.Building([(f, 0.0, 3.0)]), "floor 1: the planes leave it free to turn"),
    (lambda f: rbsdem.Building([(f, 30.0, 0.0)]), "free to turn, or to move"),
    (lambda f: rbsdem.Building([]), "it has no frames"),
    (lambda f: rbsdem.Building([(f, 0.0)]), "must be a tuple"),
    (
        lambda f: rbsdem.Building([(f, 0.0, 0.0)], centres=(1.0, 2.0, 3.0)),
        "centres = .* must be a pair",
    ),
    (
        lambda f: rbsdem.pushover(rbsdem.Building([(f, 0.0, 0.0)]), drift=1e-4).drift_at((1.0,)),
        "must be x and y",
    ),
    (lambda f: rbsdem.Building([(f, 0.0, 0.0)], names=["a:b"]), "is no name of a frame"),
    (lambda f: rbsdem.Building([(f, 0.0, 0.0)], names=["a", "b"]), "2 names for 1 frames"),
    (lambda f: rbsdem.Building([(f, 0.0, 0.0)], direction=90.0), "has a part along y"),
    (lambda f: rbsdem.Building([(f, 0.0, 0.0)], inertia=[1.0, 2.0]), "one for each of 1 floors"),
    (lambda f: rbsdem.Building([(replace(f, damping=0.05), 0, 0)]), "has damping of its own"),
    (lambda f: rbsdem.pushover(f, drift=0.01, direction=20.0), "direction is for buildings"),
    (
        lambda f: rbsdem.time_history(
            f, [0.0, 1.0], ground_acceleration_y=[0.0, 1.0], method="newmark", dt=0.1
        ),
        "nothing of it moves along y",
    ),
    (
        lambda f: rbsdem.Building([(f, 0.0, 0.0)]).without("x-2:post"),
        "is not of this frame",
    ),
    (lambda f: rbsdem.Building([(f, 0.0, 0.0)]).plane("x-2"), "is not of this frame"),
    (
        lambda f: rbsdem.Building([(f, angle, 0.0, 0.0) for angle in (0.0, 180.0)]),
        "along one direction, in which a column bends once",
    ),
    (lambda f: rbsdem.Building([(f, 0, 0, 0), (halved(f), 90, 0, 0)]), "end at different heights"),
    (lambda f: rbsdem.Building([(rbsdem.Building([(f, 0, 0)]), 0, 0)]), "must be a tuple"),
    (lambda f: rbsdem.Building([(f, np.nan, 0)]), "frames.0.: value 1 of 2 is nan"),
]


@pytest.mark.parametrize(("made", "told"), REFUSED)
def test_refusals_name_the_fault(made, told):
    with pytest.raises(rbsdem.InputError, match=told):
        made(planar())


ELASTIC = FrameMember(3e10, 0.16, 2e-3)
MESH = rbsdem.Curtain(0.01, 0.2, C.bars[0][2])
W = rbsdem.WallSection(1.8, 0.2, concrete=C.concrete, cover=0.02, vertical=MESH, horizontal=MESH)


def plan(bays_x=(6.0, 4.0), bays_y=(4.0, 5.0), **more):
    given = {"columns": ELASTIC, "beams_x": ELASTIC, "beams_y": ELASTIC} | more
    return rbsdem.Building.grid([3.0, 3.0], bays_x, bays_y, **given)


def loads_of(building, line):
    return np.broadcast_to(building.plane(line).frame.beam_load[0], 2)


def test_loads_go_to_the_beams_by_yield_lines():
    building = plan(floor_load=[6e3, 4e3], live_load=[2e3, 0.0], mass="from_loads")
    q = 6e3 + 0.3 * 2e3
    # Panels of 6 x 4 and 6 x 5 m beside the middle line along x: trapezoids of 8 and 8.75 m2;
    # of 4 x 4 and 4 x 5 m beside the last one along y: triangles of 4 m2, then a trapezoid of 6.
    assert loads_of(building, "x-2") * [6.0, 4.0] == pytest.approx([q * 16.75, q * 8.0])
    assert loads_of(building, "y-3") * [4.0, 5.0] == pytest.approx([q * 4.0, q * 6.0])
    # All of it stands on the ground, and the mass is where it is.
    parts = building.parts
    feet = [name in {*building.axial_of.values()} and name.endswith("-1") for name in parts.members]
    assert parts.compression[feet].sum() == pytest.approx(90.0 * (q + 4e3), rel=1e-12)
    assert building.plan_mass == pytest.approx(90.0 * np.array([q, 4e3]) / 9.80665, rel=1e-12)
    assert building.centres == pytest.approx(np.tile([5.0, 4.5], (2, 1)), rel=1e-12)
    assert building.inertia == pytest.approx(building.plan_mass * (100.0 + 81.0) / 12.0, rel=1e-12)
    # Facades are lines, and accidental eccentricity a part of the length.
    facade = plan(edge_load=1e3, mass="from_loads", eccentricity=(0.05, -0.1))
    assert facade.plan_mass == pytest.approx(np.full(2, 38e3 / 9.80665), rel=1e-12)
    assert facade.centres[0] == pytest.approx([5.5, 3.6], rel=1e-12)
    lines = 20.0 * (100.0 / 12.0 + 81.0 / 4.0) + 18.0 * (81.0 / 12.0 + 100.0 / 4.0)
    assert facade.inertia[0] == pytest.approx(1e3 / 9.80665 * lines, rel=1e-12)


def test_a_side_without_a_beam_leaves_its_load_to_the_others():
    without = {"beams_x": {(0, 0, 0): ELASTIC, (1, 1, 0): None}}
    building = plan(floor_load=6e3, mass="from_loads", **without)
    # Of the panel of 6 x 4 m sides of 4, 8 and 4 m2 are left.
    assert loads_of(building, "x-2")[0] * 6.0 == pytest.approx(6e3 * (12.0 + 8.75))
    assert building.plan_mass[0] == pytest.approx(6e3 * 90.0 / 9.80665)


def test_a_grid_is_its_frames_one_by_one():
    column, beam = FrameMember(3.5e5, 4.0, 1.25), FrameMember(5e5, 1.0, 2.61)
    drawn = rbsdem.Building.grid(
        [13.0] * 2, [35.0] * 2, [25.0] * 2, columns=column, beams_x=beam, beams_y=beam,
        floor_mass=6.21118, eccentricity=(3.0 / 70.0, 2.0 / 50.0),
    )  # fmt: skip
    assert drawn.inertia == pytest.approx(np.full(2, 6.21118 * 7400.0 / 12.0))
    one, two = rbsdem.modes(drawn.changed(inertia=0.0), 4), rbsdem.modes(peterson(), 4)
    np.testing.assert_allclose(one.period, two.period, rtol=1e-12)


def test_a_drawn_building_and_its_case_file_are_one(tmp_path):
    oblong = replace(C, depth=0.5)
    house = rbsdem.Building.grid(
        [3.2], [5.6, 4.0], [5.0], columns={(0, 0, 0): C, (1, 1, 0): oblong}, beams_x=B, beams_y=B,
        walls={("x", 2, 3): W}, floor_load=6e3, edge_load=2e3, self_weight=True,
        mass="from_loads", kinematics="pdelta", direction=20.0, damping=0.05,
    )  # fmt: skip
    # The wall bends along x, and across it is a post; sections turn with their planes.
    assert house.frame_of("x-2").kinds["C-3-1"].sections == (W, W)
    assert house.frame_of("y-3").kinds["C-2-1"].ends == "pinned"
    assert house.frame_of("y-1").kinds["C-1-1"].sections[0] == oblong.turned
    assert oblong.turned.depth == C.width
    assert oblong.turned.turned == oblong
    sizes = 4 * 0.4 * 0.4 + 0.4 * 0.5 + 1.8 * 0.2
    beams = 0.5 * 0.3 * (2 * 9.6 + 3 * 5.0)
    weights = 6e3 * 48.0 + 2e3 * 29.2 + 25e3 * (beams + 0.5 * 3.2 * sizes)
    assert house.plan_mass[0] * 9.80665 == pytest.approx(weights, rel=1e-12)
    case = case_of_text(house.to_namelist() + "&loading drive = 'displacement', values = 0.01 /\n")
    assert case.column == house
    assert case.column.plan == house.plan
    push = case.run()
    again = rbsdem.cyclic(house, displacement=[0.01])
    for name, values in push.channels.items():
        np.testing.assert_array_equal(again.channels[name], values, err_msg=name)
    push.save(tmp_path / "push.npz")
    assert rbsdem.read_result(tmp_path / "push.npz").building.plan == house.plan


def test_the_ground_carries_all_loads_beside_walls_along_x_and_y():
    """A post across a wall leans between its pins, and has the axial force of the wall."""
    house = rbsdem.Building.grid(
        [3.2], [5.6, 4.0], [5.0], columns=C, beams_x=B, beams_y=B,
        walls={("x", 1, 2): W, ("y", 3, 1): W}, floor_load=6e3, mass="from_loads",
        kinematics="pdelta", direction=20.0,
    )  # fmt: skip
    push = rbsdem.cyclic(house, displacement=[0.0, 0.01], method="newton")
    np.testing.assert_allclose(push.base_shear, push.force, rtol=1e-12, atol=1e-6)
    line = plot.history(push, "base_shear").get_lines()[0]
    np.testing.assert_allclose(line.get_ydata(), 1e-3 * push.force, rtol=1e-12, atol=1e-9)
    for names, shear in (
        (["x-1", "x-2"], push.base_shear_x),
        (["y-1", "y-2", "y-3"], push.base_shear_y),
    ):
        feet = sum(sum(push.frame(name).reactions.values()) for name in names)
        np.testing.assert_allclose(feet[:, 0], -shear, rtol=1e-9, atol=1e-3)
        np.testing.assert_allclose(feet[:, 1], 6e3 * 48.0, rtol=1e-9)


def test_a_plan_without_a_corner_is_its_frames_one_by_one():
    def left_out(*places):
        return {(0, 0, 0): ELASTIC} | dict.fromkeys(places)

    building = plan(
        columns=left_out((3, 3, 0), (3, 0, 2)), beams_x=left_out((2, 3, 0), (2, 0, 2)),
        beams_y=left_out((2, 3, 0), (0, 3, 2)), floor_load=6e3, edge_load=1e3, mass="from_loads",
    )  # fmt: skip
    # The ground floor has three of four panels, the roof the two on the left; each has its edge.
    weights = [6e3 * (90.0 - 20.0) + 38e3, 6e3 * 54.0 + 30e3]
    assert building.plan_mass * 9.80665 == pytest.approx(weights, rel=1e-12)
    moments = [6e3 * (54.0 * 3.0 + 16.0 * 8.0), 6e3 * 54.0 * 3.0 + 30e3 * 3.0]
    moments[0] += 1e3 * (10.0 * 5.0 + 6.0 * 3.0 + 4.0 * 8.0 + 4.0 * 10.0 + 5.0 * 6.0)
    assert building.centres[:, 0] == pytest.approx(np.divide(moments, weights), rel=1e-12)
    assert building.corners(2).max(axis=0) == pytest.approx([6.0, 9.0])
    assert [len(building.corners(floor)) for floor in (1, 2)] == [7, 6]
    # Its frames by nodes and members, in which nothing is where the grid steps back.
    frames = []
    for plane in building.planes:
        frame, parts = plane.frame, plane.frame.parts
        loads = {node.name: node.load_y for node in frame.nodes}
        nodes = [
            FrameNode(
                parts.nodes[i], parts.x[i], parts.y[i], floor=int(parts.floor[i]),
                support="fixed" if parts.floor[i] == 0 else "",
                load_y=loads.get(parts.nodes[i], 0.0),
            )
            for i in np.unique(parts.ends)
        ]  # fmt: skip
        tied = {node.floor: node.name for node in nodes[::-1]}
        nodes = [
            replace(node, moves_with=tied[node.floor])
            if node.floor and tied[node.floor] != node.name
            else node
            for node in nodes
        ]
        members = [
            Member(name, parts.nodes[at.start], parts.nodes[at.end], ELASTIC, load=at.load)
            for name, at in frame.geometry.items()
        ]
        frames.append((Frame(nodes=nodes, members=members), plane.angle, plane.arm, 0.0))
    more = {"floor_mass": building.plan_mass, "inertia": building.inertia}
    other = rbsdem.Building(frames, centres=building.centres, **more)
    one, two = (rbsdem.pushover(each, drift=0.01, points=2) for each in (building, other))
    for name in ("force", "floor_rotation", "plane_shear"):
        a, b = getattr(one, name), getattr(two, name)
        np.testing.assert_allclose(b, a, rtol=0, atol=1e-12 * np.abs(a).max(), err_msg=name)
    assert case_of_text(building.to_namelist()).column == building


def test_frames_of_a_grid_need_not_stand_by_themselves():
    # Beams of y-2 on girders; on x-2 the columns of the upper storey stand on beams of y-1 and y-3.
    columns = {(0, 0, 0): ELASTIC, (2, 0, 0): None, (1, 2, 1): None, (3, 2, 1): None}
    beams = {(0, 0, 0): ELASTIC, (0, 2, 1): None}
    building = plan(columns=columns, beams_x=beams, floor_load=6e3, mass="from_loads")
    push = rbsdem.pushover(building, drift=0.01, points=2)
    secondary = push.frame("y-2")
    # Members resist no torsion: at its ends a beam on girders has no moment, between them it has.
    beam = secondary.member("B-1-1").moment[-1]
    assert abs(beam[0]) < 1e-12 * abs(beam[1])
    assert secondary.storey_drift[-1] == pytest.approx(push.drift_at((6.0, 0.0))[-1, :, 1])
    axial = dict(zip(building.parts.members, building.parts.compression, strict=True))
    feet = [axial[f"x-{j}:C-{i}-1"] for i in (1, 3) for j in (1, 3)]
    assert sum(feet) == pytest.approx(90.0 * 12e3, rel=1e-12)
    again = case_of_text(building.to_namelist(springs=True)).column
    assert again == building
    low = rbsdem.Building.grid(
        [3.0], [6.0, 4.0], [5.0], columns={(0, 0, 0): ELASTIC, (2, 0, 0): None}, beams_x=ELASTIC,
        beams_y=ELASTIC, floor_mass=1e4,
    )  # fmt: skip
    assert case_of_text(low.to_namelist(springs=True)).column == low
    cut = rbsdem.pushover(again, drift=0.01, points=2).frame("y-2")
    np.testing.assert_array_equal(cut.storey_shear, secondary.storey_shear)
    with pytest.raises(rbsdem.InputError, match="parts that nothing ties"):
        rbsdem.modes(building.plane("y-2").frame)
    walls = {("x", line, place): W for line in (1, 2) for place in (1, 2, 3)}
    with pytest.raises(rbsdem.InputError, match=r"mechanism, floor [12] can move along y"):
        plan(bays_y=(4.0,), walls=walls)


def test_buildings_are_equal_that_are_so_in_plan():
    building = plan(floor_load=6e3, mass="from_loads")
    assert case_of_text(building.to_namelist()).column == building
    for name, value in {
        "inertia": 1e5,
        "centres": (1, 2),
        "floor_mass": 1e4,
        "direction": 9,
    }.items():
        other = building.changed(**{name: value})
        assert other != building
        # A drawing has no such centres, masses or inertia.
        assert case_of_text(other.to_namelist()).column == other


TEE = TeeSection(0.3, 0.5, C.concrete, flange_width=0.9, flange_thickness=0.1)
GRIDS = [
    ({"walls": {("x", 9, 1): None}}, "line"),
    ({"walls": {(1, 1): None}}, "must be .direction, line, place."),
    ({"walls": {("x", 1, 1): None}}, "walls: .*WallSection"),
    ({"eccentricity": (5.0, 5.0)}, "5 per cent is 0.05"),
    ({"columns": {(4, 1, 0): ELASTIC}}, "columns: line_x = 4, but there are 3"),
    ({"beams_x": {(1, 1): ELASTIC}}, "must be three numbers"),
    ({"columns": {(0, 0, 2): ELASTIC}}, "nothing stands on the ground"),
    ({"walls": [W]}, "walls = .* must be a dict"),
    ({"floor_load": [1e3] * 3}, "one for each of 2 floors"),
    ({"bays_x": (-1.0,)}, "must be lengths above 0"),
    ({"beams_x": None, "beams_y": None, "floor_load": 6e3}, "no beam around it"),
    ({"mass": "from_loads", "floor_mass": 1e4}, "give one of them"),
    ({"columns": TEE},
     "frame y-1|has no other side"),
]  # fmt: skip


@pytest.mark.parametrize(("changed", "told"), GRIDS)
def test_a_grid_names_what_is_wrong(changed, told):
    with pytest.raises(rbsdem.InputError, match=told):
        plan(**changed)


def test_a_load_in_kn_is_told():
    with pytest.warns(AccuracyWarning, match="no building; 6 kN/m2 is 6e3"):
        plan(floor_load=6.0)


CASES = [
    ("&beam_of kind = 'a' /", "beam_of: along is missing"),
    ("&column_of line = 1, kind = 'a' /", "line is of a planar frame"),
    ("&column_of kind = 'b' /", "kind = 'b' is not known"),
    ("&column_of line_x = 1 /", "column_of: kind is missing"),
    ("&floor floor = 2, floor_load = 5e3 /", "floor = 2, but there are 1; correct it"),
]


@pytest.mark.parametrize(("groups", "told"), CASES)
def test_a_case_of_a_grid_names_what_is_wrong(groups, told):
    text = "&frame storeys = 3.0, bays_x = 4.0, bays_y = 4.0 /\n"
    text += "&member_kind name = 'a', modulus = 3e10, area = 0.16, inertia = 2e-3 /\n"
    with pytest.raises(rbsdem.InputError, match=told):
        case_of_text(text + groups)
    text = text.replace("bays_x = 4.0, bays_y", "bays")
    with pytest.raises(rbsdem.InputError, match="of a grid in plan"):
        case_of_text(text + "&column_of line_x = 1, kind = 'a' /\n&beam_of kind = 'a' /\n")


def test_columns_at_one_place_are_alike(grid):
    frame = sprung_storey(Elastic(1e7), mass=1e3, load=1e4)
    thin = replace(
        frame,
        members=[
            replace(frame.members[0], kind=replace(frame.members[0].kind, area=0.5)),
            frame.members[1],
        ],
    )
    with pytest.raises(rbsdem.InputError, match="give both the same section"):
        rbsdem.Building([(frame, 0.0, 0.0, 0.0), (thin, 90.0, 0.0, 0.0)])
    with pytest.raises(rbsdem.InputError, match="is one of three planes"):
        rbsdem.Building([(frame, angle, 0.0, 0.0) for angle in (0.0, 90.0, 45.0)])
