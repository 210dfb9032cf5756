"""Grids by short rules: words for lines, loads of nodes, masses; in Python and in files."""

from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem import Bars, Concrete, InputError, RectangularSection, Steel, Ties

STEEL, TIES = Steel(450e6, 600e6), Ties(0.008, 0.15, Steel(400e6))
OUTER = RectangularSection(
    0.35, 0.35, Concrete(25e6), layout=rbsdem.Layout(8, 0.018, STEEL), ties=TIES, cover=0.03
)
INNER = replace(OUTER, width=0.45, depth=0.45, concrete=Concrete(35e6))
BEAM = RectangularSection(
    0.3, 0.5, Concrete(25e6), top=Bars(4, 0.018), bottom=Bars(3, 0.016), steel=STEEL, ties=TIES,
    cover=0.03,
)  # fmt: skip
CASE = """\
&case title = 'house' /
&frame storeys = 3*3.2, bays = 3*5.0, kinematics = 'pdelta', pattern = 'modal',
  self_weight = .true., mass = 'from_loads' /
&floor dead_load = 18e3, live_load = 8e3 /
&floor floor = 3, dead_load = 12e3, live_load = 4e3 /
&node_load lines = 'outer', load = 25e3 /
&node_load lines = 'outer', floor = 3, load = 0 /
&column_of kind = 'outer' /
&column_of lines = 'inner', kind = 'inner' /
&column_of lines = 'inner', storey = 3, kind = 'outer' /
&beam_of kind = 'beam' /
&beam_of bays = 'inner', storey = 3, kind = 'none' /
&drawing name = 'outer', version = 'VERSION' /
&section shape = 'rectangle', width = 0.35, depth = 0.35, cover = 0.03 /
&concrete fc = 25e6 /
&steel id = 1, fy = 450e6, fu = 600e6 /
&steel id = 2, fy = 400e6 /
&layout number = 8, diameter = 0.018, steel = 1 /
&ties diameter = 0.008, spacing = 0.15, steel = 2 /
&drawing name = 'inner', version = 'VERSION' /
&section shape = 'rectangle', width = 0.45, depth = 0.45, cover = 0.03 /
&concrete fc = 35e6 /
&layout number = 8, diameter = 0.018, steel = 1 /
&ties diameter = 0.008, spacing = 0.15, steel = 2 /
&drawing name = 'beam', version = 'VERSION' /
&section shape = 'rectangle', width = 0.3, depth = 0.5, cover = 0.03 /
&concrete fc = 25e6 /
&row face = 'top', number = 4, diameter = 0.018 /
&row face = 'bottom', number = 3, diameter = 0.016 /
&ties diameter = 0.008, spacing = 0.15, steel = 2 /
&loading drive = 'displacement', values = 0.05 /
""".replace("VERSION", rbsdem.section.parameters().version)


@pytest.fixture(scope="module")
def house():
    return rbsdem.Frame.grid(
        [3.2] * 3, [5.0] * 3,
        columns={(0, 0): OUTER, ("inner", (1, 2)): INNER},
        beams={(0, 0): BEAM, ("inner", 3): None},
        dead_load=[18e3, 18e3, 12e3], live_load=[8e3, 8e3, 4e3],
        node_load={("outer", 0): 25e3, ("outer", 3): 0.0},
        self_weight=True, mass="from_loads", kinematics="pdelta", pattern="modal",
    )  # fmt: skip


def test_words_name_lines_and_bays(house):
    drawn = {name: kind.sections[0] for name, kind in house.kinds.items()}
    assert {name for name, one in drawn.items() if one == INNER} == {
        "C-2-1", "C-3-1", "C-2-2", "C-3-2",
    }  # fmt: skip
    assert "B-2-3" not in drawn
    # 1.5 bays of beams a line, its walls, and half of the columns above and below.
    assert len(house.storey_heights) == 3
    weight = 15.0 * (18e3 + 0.3 * 8e3 + 25e3 * 0.15) + 2 * 25e3
    columns = 3.2 * 25e3 * (2 * OUTER.gross_area + 2 * INNER.gross_area)
    assert house.floor_mass[0] * 9.80665 == pytest.approx(weight + columns, rel=1e-12)


def test_a_case_file_says_the_same(house, tmp_path):
    path = tmp_path / "house.nml"
    path.write_text(CASE)
    read = rbsdem.read_case(path).column
    assert read == house
    # What comes back of its own text is the same, and its loads stand there as they were given.
    text = read.to_namelist()
    assert "live_load = 8000" in text
    assert "&node_load lines = 'outer', load = 25000 /" in text
    path.write_text(text + "&loading drive = 'displacement', values = 0.05 /\n")
    assert rbsdem.read_case(path).column == house


def test_a_frame_of_kinds_has_loads_by_rules_too(tmp_path):
    kind = rbsdem.FrameMember(modulus=30e9, area=0.16, inertia=2e-3, name="kind")
    more = {"node_load": {("outer", 1): 10e3}, "live_load": 10e3, "mass": "from_loads"}
    frame = rbsdem.Frame.grid([3.0, 3.0], [5.0], columns=kind, beams=kind, dead_load=20e3, **more)
    path = tmp_path / "frame.nml"
    path.write_text(
        "&frame storeys = 2*3.0, bays = 5.0, mass = 'from_loads' /\n"
        "&floor dead_load = 20e3, live_load = 10e3 /\n"
        "&node_load lines = 'outer', floor = 1, load = 10e3 /\n"
        "&member_kind name = 'kind', modulus = 30e9, area = 0.16, inertia = 2e-3 /\n"
        "&column_of kind = 'kind' /\n&beam_of bays = 'outer', kind = 'kind' /\n"
        "&loading drive = 'displacement', values = 0.05 /\n"
    )
    read = rbsdem.read_case(path).column
    assert read.floor_mass == frame.floor_mass
    np.testing.assert_array_equal(read.parts.compression, frame.parts.compression)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"columns": {("left", 0): OUTER}}, "'left' is not known; a pair has numbers"),
        ({"columns": {(0, "outer"): OUTER}}, "'outer' is not known"),
        ({"columns": {"outer": OUTER}}, "must be a pair"),
        ({"node_load": {("outer", 0): "heavy"}}, "node_load"),
        ({"columns": {((1, 9), 0): OUTER, (0, 0): OUTER}}, "line = 9, but there are 2"),
    ],
)
def test_refusals(change, words):
    given = {"columns": OUTER, "beams": BEAM, "dead_load": 10e3} | change
    with pytest.raises(InputError, match=words):
        rbsdem.Frame.grid([3.0], [5.0], **given)


def test_refusals_of_a_case_file(tmp_path):
    path = tmp_path / "house.nml"
    for old, new, words in (
        ("lines = 'inner', kind", "lines = 'middle', kind", "'middle' is not known"),
        ("lines = 'inner', kind", "line = 2, lines = 'inner', kind", "remove one"),
        ("mass = 'from_loads'", "mass = 'heavy'", "'heavy' is not known"),
        ("&floor floor = 3", "&floor floor = 4", "floor = 4, but the frame has 3 floors"),
        ("'outer', load = 25e3", "'outer'", "node_load: load is missing"),
    ):
        assert old in CASE
        path.write_text(CASE.replace(old, new, 1))
        with pytest.raises(InputError, match=words):
            rbsdem.read_case(path)
