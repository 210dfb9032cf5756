"""Frames from the sections of their members, held against frames that were put together by hand."""

import json
from dataclasses import replace

import numpy as np
import pandas
import pytest
from samples import BEAM as B
from samples import UPRIGHT as C
from test_invariants_frames import free, moment_size, off_balance

import rbsdem
from rbsdem.frames import Frame, FrameNode, Member, TeeSection
from rbsdem.model.frame import with_rigid_end
from rbsdem.run.case import case_of_text

STEEL, TIES = B.steel, B.ties
#: The beam with a slab.
TEE = TeeSection(
    0.3, 0.5, B.concrete, top=B.top, bottom=B.bottom, steel=STEEL, ties=TIES, cover=0.03,
    flange_width=1.0, flange_thickness=0.12,
)  # fmt: skip
LOADING = "&loading drive = 'displacement', values = 0.01 /\n"
MORE = {"dead_load": 20e3, "live_load": 10e3, "kinematics": "pdelta"}


@pytest.fixture(scope="module")
def drawn():
    return rbsdem.Frame.grid([3.2, 3.0], [5.6, 4.0], columns=C, beams=B, ends=1.0, **MORE)


def test_a_drawn_frame_is_one_of_members_by_hand(drawn):
    kinds = {}
    # The axial loads are those of the elastic frame of gross sections.
    columns, beams = (
        rbsdem.FrameMember(one.concrete_law["ec"], one.gross_area, one.inertia) for one in (C, B)
    )
    elastic = rbsdem.Frame.grid(
        [3.2, 3.0], [5.6, 4.0], columns=columns, beams=beams, beam_load=23e3
    ).parts
    for line in (1, 2, 3):
        for storey, clear in ((1, 3.2 - 0.25), (2, 3.0 - 0.5)):
            # 1 % of f'c A_g is the step of the axial loads.
            carried = elastic.compression[elastic.members.index(f"C-{line}-{storey}")]
            load = max(round(carried / 40e3), 1) * 40e3
            rigid = (0.0 if storey == 1 else 0.25), 0.25
            spans = drawn.kinds[f"C-{line}-{storey}"].shear_spans
            kinds[line, storey] = rbsdem.section.member(
                C, clear, axial_load=load, rigid_end=rigid, shear_spans=spans
            )
    beams = {
        (bay, 0): rbsdem.section.member(B, width - 0.4, rigid_end=(0.2, 0.2), load=23e3)
        for bay, width in ((1, 5.6), (2, 4.0))
    }
    hand = rbsdem.Frame.grid(
        [3.2, 3.0], [5.6, 4.0], columns=kinds, beams=beams, beam_load=23e3, kinematics="pdelta"
    )
    one, two = (rbsdem.pushover(each, drift=0.005, points=5) for each in (drawn, hand))
    np.testing.assert_array_equal(one.base_shear, two.base_shear)
    # Beams are stronger where their top is in tension: more bars are drawn there.
    hinge = drawn.kinds["B-1-1"].at("flexure", 0.0)
    above = sum(layer.k for y, layer in hinge.layers if y > 0.15)
    below = sum(layer.k for y, layer in hinge.layers if y < -0.15)
    assert above > below


def test_columns_carry_the_loads_that_were_stated():
    more = {"self_weight": True, "node_load": {(0, 0): 5e3, (2, 1): 12e3}}
    frame = rbsdem.Frame.grid([3.2, 3.0], [5.6, 4.0], columns=C, beams=B, **MORE, **more)
    on_beams = 2 * 9.6 * (20e3 + 0.3 * 10e3 + 25e3 * 0.15)
    walls = 5 * 5e3 + 12e3
    # The lower halves of the columns of the ground storey stand on the base.
    columns = 3 * 25e3 * 0.16 * (3.2 / 2 + 3.0)
    parts = frame.parts
    feet = [parts.compression[parts.members.index(f"C-{line}-1")] for line in (1, 2, 3)]
    assert sum(feet) == pytest.approx(on_beams + walls + columns, rel=1e-9)


def test_masses_from_loads():
    whole = rbsdem.Frame.grid(
        [3.2, 3.0], [5.6], columns=C, beams=B, dead_load=[20e3, 10e3], node_load=8e3,
        mass="from_loads",
    )  # fmt: skip
    g = 9.80665
    assert whole.floor_mass == pytest.approx(
        [(5.6 * q + 16e3) / g for q in (20e3, 10e3)], rel=1e-12
    )
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="floor_mass of floor 1"):
        rbsdem.Frame.grid(
            [3.2], [5.6], columns=C, beams=B, dead_load=20e3, floor_mass=9e3, mass="from_loads"
        )


def test_rigid_ends_by_strength():
    # Weak columns between strong beams: the beams are rigid in the nodes, and the other way round.
    strong = replace(C, width=0.6, depth=0.6, layout=rbsdem.Layout(12, 0.025, STEEL))
    weak = rbsdem.Frame.grid([3.2] * 2, [5.6], columns=C, beams=strong, dead_load=20e3)
    assert weak.beams[1, 1].rigid_end == (0.2, 0.2)
    assert weak.columns[1, 2].rigid_end == (0.0, 0.0)
    stiff = rbsdem.Frame.grid([3.2] * 2, [5.6], columns=strong, beams=B, dead_load=20e3)
    assert stiff.beams[1, 1].rigid_end == (0.0, 0.0)
    assert (stiff.columns[1, 1].rigid_end, stiff.columns[1, 2].rigid_end) == (
        (0.0, 0.25),
        (0.25, 0.25),
    )


def test_unlike_halves():
    light = replace(B, top=rbsdem.Bars(3, 0.016))
    pair = rbsdem.Frame.grid([3.2], [5.6], columns=C, beams=(B, light), **MORE)
    mirror = rbsdem.Frame.grid([3.2], [5.6], columns=C, beams=(light, B), **MORE)
    one = rbsdem.pushover(pair, drift=0.01, points=10)
    # Mirrored it is the same frame pushed the other way, at the node of the other line.
    back = rbsdem.pushover(replace(mirror, control_node="N-2-1"), drift=-0.01, points=10)
    assert back.base_shear[-1] == pytest.approx(-one.base_shear[-1], rel=1e-6)
    alike = rbsdem.section.member((B, B), 5.0)
    assert alike == rbsdem.section.member(B, 5.0)
    assert alike.sections == (B, B)


def test_a_drawn_frame_comes_back_from_its_springs(drawn):
    assert case_of_text(drawn.to_namelist(springs=True) + LOADING).column == drawn


def test_equal_members_are_one_kind():
    tall = rbsdem.Frame.grid([3.2] * 6, [5.6] * 4, columns=C, beams=B, **MORE)
    kinds = {id(kind.flexure[0][1]) for kind in tall.kinds.values()}
    assert len(tall.parts.members) == 54
    assert len(kinds) < 20


def test_springs_in_nodes():
    frame = rbsdem.Frame.grid([3.2] * 2, [5.6] * 2, columns=C, beams=B, panel_hoops="none", **MORE)
    springs = {node.name: node.panel for node in frame.nodes}
    assert set(springs) == {f"N-{i}-{k}" for i in (1, 2, 3) for k in (1, 2)}
    panel = rbsdem.frames.JointPanel(C, B, "interior")
    assert springs["N-2-1"] == panel.spring()
    assert springs["N-1-2"] == rbsdem.frames.JointPanel(C, B, "knee").spring()
    assert springs["N-1-1"] == rbsdem.frames.JointPanel(C, B, "exterior").spring()
    assert frame.beams[1, 1].rigid_end == (0.2, 0.2)


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    ("storeys", "bays", "load"), [(1, [5.6], 10e3), (1, [4.0] * 2, 5e3), (2, [4.0] * 2, 5e3)]
)
def test_nodes_without_hoops_lose_their_strength_in_cycles(storeys, bays, load):
    """To 5 % and back, over snap-backs: every node is in equilibrium at every row."""
    frame = rbsdem.Frame.grid(
        [3.2] * storeys, bays, columns=C, beams=B, panel_hoops="none", ends=0.0, dead_load=load,
        kinematics="pdelta",
    )  # fmt: skip
    # Panels that wear lose their strength too early to snap back.
    bare = {"lambda_s": 0.0, "b0": 0.0}
    nodes = [
        replace(
            own, push_x=float(own.name == f"N-1-{storeys}"),
            panel=own.panel and replace(own.panel, **bare),
        )
        for own in frame.nodes
    ]  # fmt: skip
    frame = replace(frame, pattern="nodes", nodes=nodes)
    turns = np.outer([0.005, 0.01, 0.02, 0.03, 0.05], [1, -1, 1, -1]).ravel()
    run = rbsdem.cyclic(frame, displacement=turns * frame.height)
    assert {event.name for event in run.events if event.group == "panel"} >= {"yield", "cap"}
    assert run.summary["snap_backs"] > 0
    assert np.abs(off_balance(run)[:, free(frame)]).max() < 1e-9 * moment_size(run)
    assert run.summary["relative_energy_residual"] < 1e-9


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
def test_a_tee_hogs_with_its_slab_in_tension():
    frame = rbsdem.Frame.grid([3.2], [5.6], columns=C, beams=TEE, **MORE)
    assert frame.kinds["B-1-1"].sections == (TEE, TEE)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"columns": 3.0}, "must be a Section"),
        ({"columns": {1: C}}, "pair"),
        ({"dead_load": [1e3, 2e3, 3e3]}, "3 values for 2 storeys"),
        ({"mass": "loads"}, "from_loads"),
        ({"live_share": 3.0}, "live_share"),
        ({"ends": 7.0}, "share"),
        ({"storeys": [3.2, 0.5], "ends": 1.0}, "C-1-2 of 0.5 m has rigid ends of 0.5 m"),
        ({"panel_hoops": 3}, "panel_hoops"),
        ({"dead_load": 2e7}, "node N-1-1: axial_load"),
    ],
)
def test_refusals(change, text):
    given = {"storeys": [3.2, 3.0], "bays": [5.6], "columns": C, "beams": B, **MORE} | change
    with pytest.raises(rbsdem.InputError, match=text):
        rbsdem.Frame.grid(**given)


def sections_of(frame):
    return [kind.sections for kind in frame.kinds.values()]


@pytest.mark.filterwarnings("ignore:the section has a flange")
@pytest.mark.parametrize(
    "more",
    [
        {"ends": 0.5, "node_load": 30e3, "self_weight": True, "mass": "from_loads"},
        {"panel_hoops": TIES},
        {"panel_hoops": replace(TIES, spacing=0.15), "damping": 0.05, "floor_mass": 30e3},
        {"panel_hoops": "none", "base": "pinned", "diaphragm": True},
    ],
    ids=["ends", "hoops of a section", "other hoops", "no hoops"],
)
def test_a_drawn_frame_comes_back_from_a_case_file_with_its_sections(more):
    kind = rbsdem.FrameMember(3e10, 0.2, 4e-3, rigid_end=0.25, name="section-1")
    other = replace(B, bottom=B.top) if "panel_hoops" in more else TEE
    frame = rbsdem.Frame.grid(
        [3.2, 3.0, 3.0], [5.6, 4.0], columns={(0, 0): C, (2, 3): kind},
        beams={(1, 0): (B, other), (2, 0): B, (2, 3): None}, **MORE, **more,
    )  # fmt: skip
    text = frame.to_namelist()
    back = case_of_text(text + LOADING).column
    assert back == frame
    assert back.to_namelist() == text
    assert sections_of(back) == sections_of(frame)
    # 40 lines in place of some 500; a frame that was changed has its springs.
    springs = frame.to_namelist(springs=True)
    assert len(springs.splitlines()) > 5 * len(text.splitlines())
    # Other axial loads would make other columns: it has these springs, and their sections.
    lost = replace(frame, beam_load=1e3)
    assert len(lost.to_namelist().splitlines()) > len(springs.splitlines())
    assert case_of_text(lost.to_namelist() + LOADING).column == lost


def test_a_drawn_case_is_the_same_by_python_and_the_executable(drawn, tmp_path, run_cli, command):
    path = tmp_path / "house.nml"
    loading = "&loading drive = 'displacement', values = 0.03, 0.06, -0.06 /\n"
    path.write_text("&case title = 'house' /\n" + drawn.to_namelist() + loading)
    case = rbsdem.read_case(path)
    result = case.run()
    # The executable says what is to be done.
    refused = run_cli(["run", path])
    assert refused.returncode == 2
    assert "rbsdem draw CASE.nml" in refused.stderr
    # The command of the package checks the springs of its members, and lists faults as for others.
    assert command("check", path).stdout == f"{path}: no errors\n"
    told = json.loads(command("check", path, "--json").stdout)
    assert told == {"case": str(path), "errors": [], "notes": []}
    assert "nothing has mass" in command("modes", path).stderr
    wrong = tmp_path / "wrong.nml"
    for old, new, text in (
        ("kind = 'section-1'", "kind = 'section-9'", "section-9"),
        ("version = '2026.8'", "version = '2020.1'", "'2020.1' is not known"),
    ):
        wrong.write_text(path.read_text().replace(old, new, 1))
        found = command("check", wrong)
        assert (found.returncode, found.stdout) == (2, "")
        assert text in found.stderr
        assert text in json.loads(command("check", wrong, "--json").stdout)["errors"][0]["message"]
    springs = tmp_path / "springs.nml"
    springs.write_text(case.to_namelist(springs=True))
    assert run_cli(["run", springs, "--quiet"]).returncode == 0
    rows = pandas.read_csv(tmp_path / "springs.csv", comment="#")
    for name in ("displacement_m", "force_N", "base_shear_N", "spring_J"):
        np.testing.assert_array_equal(rows[name], result.to_pandas()[name])
    result.save(tmp_path / "house.npz")
    again = rbsdem.read_result(tmp_path / "house.npz")
    assert again == result
    assert sections_of(again.frame) == sections_of(drawn)


def test_a_drawn_run_leaves_what_it_was_read_from(drawn, tmp_path, command):
    path, history, page = (tmp_path / name for name in ("d.nml", "h.csv", "d.html"))
    loading = "&loading drive = 'displacement', file = 'h.csv' /\n"
    path.write_text(drawn.to_namelist() + loading)
    history.write_text("displacement\n0\n0.01\n")
    page.write_text("mine")
    before = {file: file.read_bytes() for file in (path, history, page)}
    for options in (
        ["run", "d.nml", "-o", "d.nml"],
        ["run", "d.nml", "--output=h.csv"],
        ["run", "d.nml", "-o", "rows.csv", "--report"],
        ["run", "d.nml", "-o", "rows.csv", "--report=d.nml"],
        ["report", "d.nml", "-o", "h.csv"],
    ):
        done = command(*options, folder=tmp_path)
        assert done.returncode == 2, options
        assert "written over" in done.stderr or "is no report of rbsdem" in done.stderr
        assert {file: file.read_bytes() for file in tmp_path.iterdir()} == before
    # Options stand anywhere, and rows of an earlier run are no case.
    for _ in range(2):
        words = ["-q", "run", "--output", "rows.csv", "d.nml"]
        assert command(*words, folder=tmp_path).returncode == 0


@pytest.mark.parametrize(
    ("change", "text"),
    [
        (("version = '2026.8'", "version = '2020.1'"), "version = '2020.1' is not known"),
        (("name = 'section-1', ", ""), "drawing: name is missing"),
        (("kind = 'section-1'", "kind = 'section-9'"), "section-9"),
        (("name = 'section-2', v", "name = 'section-1', v"), "'section-1': another drawing"),
        (
            ("&drawing name = 'section-2'", "&drawing n = 3, name = 'section-2'"),
            "name and version alone",
        ),
        (("&concrete fc = 25000000 /\n", ""), "concrete: fc is missing"),
    ],
)
def test_faults_of_drawn_cases_are_named(drawn, change, text):
    case = drawn.to_namelist() + LOADING
    assert change[0] in case
    with pytest.raises(rbsdem.InputError, match=text):
        case_of_text(case.replace(*change, 1))


def test_a_column_has_one_drawing():
    column = rbsdem.section.column(C, 1.6, axial_load=400e3)
    case = column.to_namelist() + LOADING
    more = "&drawing name = 'x', version = '2026.8' /\n"
    with pytest.raises(rbsdem.InputError, match="a column has one; remove the others"):
        case_of_text(case + more)


def test_one_beam_is_the_same_beam_by_every_door(tmp_path):
    """Drawn into a grid, made into a member before, and read from a case file: the same bits."""
    more = {"floor_mass": 20e3, "beam_load": 25e3, "kinematics": "pdelta"}
    k = rbsdem.section.member(C, 3.2, axial_load=120e3)
    beam = rbsdem.section.member(B, 5.6, load=25e3)
    by_hand = rbsdem.Frame.grid([3.2], [5.6], columns=k, beams=beam, **more)
    drawn = rbsdem.Frame.grid([3.2], [5.6], columns=k, beams=B, ends=0.0, **more)
    assert drawn.kinds["B-1-1"].flexure == beam.flexure
    path = tmp_path / "house.nml"
    path.write_text(drawn.to_namelist() + LOADING)
    runs = [rbsdem.pushover(frame, drift=0.02) for frame in (by_hand, drawn)]
    runs.append(rbsdem.pushover(rbsdem.read_case(path).column, drift=0.02))
    # More bars are above: the end that hogs is the stronger one.
    start, end = np.abs(runs[0].member("B-1-1").moment).max(axis=0)
    assert end > 1.4 * start
    for run in runs[1:]:
        np.testing.assert_array_equal(run.base_shear, runs[0].base_shear)
        np.testing.assert_array_equal(run.member("B-1-1").moment, runs[0].member("B-1-1").moment)


def test_a_beam_upside_down_is_told():
    with pytest.warns(rbsdem.errors.AccuracyWarning, match="beam B-1-1 and 3 more: .* bars below"):
        rbsdem.Frame.grid([3.2] * 2, [5.6] * 2, columns=C, beams=B.mirrored, **MORE)
    # Without a load there is nothing that it hangs from.
    rbsdem.Frame.grid([3.2], [5.6], columns=C, beams=B.mirrored)


def test_a_frame_that_steps_back_is_one_of_its_nodes_and_members():
    """Where neither a column nor a beam is there is no node, no load and no share of the mass."""
    step = {"columns": {(0, 0): C, (3, 2): None}, "beams": {(0, 0): B, (2, 2): None}}
    frame = rbsdem.Frame.grid(
        [3.2, 3.0], [5.6, 4.0], **step, **MORE, node_load=10e3, self_weight=True,
        mass="from_loads", diaphragm=True,
    )  # fmt: skip
    beams, posts = 25e3 * 0.15 * np.array([9.6, 5.6]), 25e3 * 0.16 * np.array([4.8 + 3.0, 3.0])
    weights = 23e3 * np.array([9.6, 5.6]) + beams + posts + np.array([20e3, 10e3])
    assert np.multiply(frame.floor_mass, 9.80665) == pytest.approx(weights, rel=1e-12)
    low, high = frame.floor_mass
    masses = {"N-1-1": low * 5.6 / 19.2, "N-2-1": low / 2, "N-3-1": low * 4.0 / 19.2}
    masses |= {"N-1-2": high / 2, "N-2-2": high / 2}
    parts, loads = frame.parts, {node.name: node.load_y for node in frame.nodes}
    nodes = [
        FrameNode(
            name, x, y, floor=int(name[-1]), support="" if int(name[-1]) else "fixed",
            mass=masses.get(name, 0.0), load_y=loads.get(name, 0.0),
            moves_with=f"N-1-{name[-1]}" if int(name[-1]) and name[2] > "1" else "",
        )
        for name, x, y in zip(parts.nodes, parts.x, parts.y, strict=True)
        if name != "N-3-2"
    ]  # fmt: skip
    members = [
        Member(
            name, parts.nodes[at.start], parts.nodes[at.end],
            with_rigid_end(frame.kinds[name], 0.0), at.rigid, at.load,
        )
        for name, at in frame.geometry.items()
    ]  # fmt: skip
    hand = Frame(nodes=nodes, members=members, kinematics="pdelta")
    one, two = (rbsdem.pushover(each, drift=0.01, points=2) for each in (frame, hand))
    np.testing.assert_allclose(two.force, one.force, rtol=1e-12)
    np.testing.assert_allclose(two.storey_drift, one.storey_drift, rtol=1e-12)
    np.testing.assert_allclose(*(rbsdem.modes(f, 2).period for f in (frame, hand)), rtol=1e-12)
    # Nothing that is given to a node which is not there is lost without a message.
    with pytest.raises(rbsdem.InputError, match="node 'N-3-2' has no member"):
        replace(frame, nodes=[*frame.nodes, FrameNode("N-3-2", mass=1e3)])


def test_a_frame_that_was_changed_keeps_its_sections(drawn):
    mesh = rbsdem.Curtain(0.01, 0.2, STEEL)
    wall = rbsdem.WallSection(1.8, 0.2, concrete=C.concrete, vertical=mesh, horizontal=mesh)
    walled = rbsdem.Frame.grid([3.2, 3.0], [5.6, 4.0], columns=C, beams=B, walls={3: wall}, **MORE)
    changed = walled.without("B-1-2")
    read = case_of_text(changed.to_namelist()).column
    assert read == changed
    for name, kind in changed.kinds.items():
        found = read.kinds[name]
        known = found.sections, found.shear_spans, found.gauge
        assert known == (kind.sections, kind.shear_spans, kind.gauge)
    assert read.kinds["C-3-1"].gauge is not None
    # The executable solves it by its springs.
    assert case_of_text(changed.to_namelist(springs=True)).column == changed


SECTIONS = [
    ("section = 'a'", "there is no drawing 'a'"),
    ("shear_spans = 1.0, 1.0, 1.0, 1.0", "of a kind with a section"),
    ("section = 'section-1', shear_spans = 1.0, 2.0", "shear_spans has 2 values; give four"),
    ("section = 'section-1', bar_length = 0.3", "give both lengths and that joint"),
]


@pytest.mark.parametrize(("keys", "told"), SECTIONS)
def test_sections_of_kinds_name_what_is_wrong(keys, told):
    kind = rbsdem.FrameMember(3e10, 0.16, 2e-3, sections=(C, C))
    text = rbsdem.Frame([3.0], None, kind).to_namelist()
    assert case_of_text(text).column.kinds["C-1-1"].sections == (C, C)
    with pytest.raises(rbsdem.InputError, match=told):
        case_of_text(text.replace("section = 'section-1'", keys))


def test_a_column_without_load_is_one_whatever_round_off_says():
    kinds = [
        rbsdem.Frame.grid([3.2], columns=C, axial_loads={"C-1-1": load}).kinds["C-1-1"]
        for load in (1e-7, 0.0, -1e-7)
    ]
    assert kinds[0] == kinds[1] == kinds[2]
