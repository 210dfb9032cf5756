"""The table of the tests, their histories, and the net horizontal force by P-Delta code."""

from __future__ import annotations

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from rbsdem import peer
from rbsdem.errors import InputError

ROW = {
    "peer_id": "7", "file": "One.csv", "name": "Somebody et al. 1986, No. 1",
    "author": "Somebody et al.", "year": "1986", "section": "rectangular", "config": "DE",
    "L_mm": "1,600", "Lmeas_mm": "1600", "b_mm": "400", "h_mm": "500", "cover_mm": "13",
    "cover_perp_mm": "0", "fc_MPa": "46.5", "axial_kN": "-744", "n_long": "12",
    "db_corner_mm": "16", "db_interm_mm": "16", "n_interm_perp": "0", "n_interm_par": "2",
    "fy_long_MPa": "446", "fu_long_MPa": "0", "fy_trans_MPa": "-", "db_trans_mm": "7",
    "s_trans_mm": "85", "legs_Nv": "3.4", "failure_mode": "Flexure", "pdelta_code": "1",
    "Ltop_mm": "", "F_max_kN": "199.59", "K_sec50_kN_mm": "29.06", "manual_dy_mm": "0",
    "notes": "force-displacement rows identical to PEER id 48", "more": "unknown column",
}  # fmt: skip


def write(folder: Path, *rows: dict[str, str], history: str = "0,0\n10,100\n-10,-100\n") -> Path:
    with (folder / "specimens.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, [*ROW, *(name for name in rows[0] if name not in ROW)])
        writer.writeheader()
        writer.writerows({**ROW, **row} for row in rows)
    (folder / "One.csv").write_text("displacement_mm,force_kN\n" + history, encoding="utf-8")
    return folder


def test_a_row_in_si(tmp_path):
    (s,) = peer.read_specimens(write(tmp_path, {}))
    assert (s.peer_id, s.name, s.author, s.year) == (7, ROW["name"], "Somebody et al.", "1986")
    assert (s.length, s.width, s.depth, s.cover) == (1.6, 0.4, 0.5, 0.013)
    assert (s.concrete_strength, s.axial_load, s.corner_yield_stress) == (46.5e6, -744e3, 446e6)
    assert (s.longitudinal_number, s.corner_diameter, s.shear_legs) == (12, 0.016, 3.4)
    assert (s.intermediate_perpendicular, s.intermediate_parallel) == (0, 2)
    assert (s.pdelta_code, s.duplicate_of) == (1, 48)
    assert s.observed.largest_force == pytest.approx(199590.0)
    assert s.observed.stiffness_50 == pytest.approx(29.06e6)
    # Zero, "-", blank, and a column that is not there are not reported, unless zero has a meaning.
    assert s.cover_perpendicular is s.longitudinal_ultimate_stress is None
    assert s.transverse_yield_stress is s.top_length is s.intermediate_yield_stress is None
    assert s.confinement is None
    (s,) = peer.read_specimens(
        write(tmp_path, {"axial_kN": "0", "Ltop_mm": "0", "pdelta_code": "-"})
    )
    assert (s.axial_load, s.top_length, s.axial_load_ratio, s.pdelta_code) == (0.0, 0.0, 0.0, None)


def test_derived_properties(tmp_path):
    rows = [{}, {"section": "circular", "b_mm": "500"}, {"section": "octagonal", "b_mm": "500"}]
    rectangle, circle, octagon = peer.read_specimens(write(tmp_path, *rows))
    assert rectangle.gross_area == pytest.approx(0.2)
    assert circle.gross_area == pytest.approx(math.pi / 16)
    # Eight triangles of inscribed radius 0.25.
    assert octagon.gross_area == pytest.approx(8 * 0.25**2 * math.tan(math.pi / 8))
    assert rectangle.axial_load_ratio == pytest.approx(-744e3 / (0.2 * 46.5e6))
    assert rectangle.mass == pytest.approx(0.2 * 1.6 * 2400)
    assert rectangle.span_depth_ratio == pytest.approx(3.2)


def test_series_keeps_the_tests_of_a_laboratory_together(tmp_path):
    for author, year, name, series in (
        ("Ang et al.", "1981", "x", "Ang 1981"),
        ("Ang et al", "1981", "x", "Ang 1981"),
        ("Watson and Park", "1989", "x", "Watson 1989"),
        ("Petrovsky and Ristic", "1984", "x", "Petrovski 1984"),
        ("BRI", "", "BRI No. 2 (Japan)", "BRI"),
        ("Galeota et al.", "", "Galeota et al. 1996, AA1", "Galeota 1996"),
        ("", "", "Pujol 2002, No. 10-2-3N", "Pujol 2002"),
    ):
        row = {"author": author, "year": year, "name": name}
        assert peer.read_specimens(write(tmp_path, row))[0].series == series


@pytest.fixture
def table(tmp_path) -> peer.Specimens:
    return peer.read_specimens(
        write(
            tmp_path,
            {},
            {"file": "", "name": "Nobody 1990, A", "peer_id": "8", "failure_mode": "Shear"},
            {"file": "Gone.csv", "name": "Nobody 1990, B", "peer_id": "9", "author": "Nobody"},
        )
    )


def test_table_is_a_sequence_with_names(table):
    assert len(table) == 3
    assert table[0] is table["One.csv"] is table["One"] is table["7"] is table[ROW["name"]]
    assert [s.peer_id for s in table[1:]] == [8, 9]
    assert isinstance(table[1:], peer.Specimens)
    assert table[-1].file == "Gone.csv"
    assert "3 tests, 1 with a history" in repr(table)


def test_where(table):
    for conditions, ids in (
        ({}, [7, 8, 9]),
        ({"failure_mode": "Shear"}, [8]),
        ({"failure_mode": ["Shear", "Flexure"], "peer_id": {8, 9}}, [8, 9]),
        ({"peer_id": lambda number: number > 7}, [8, 9]),
        ({"section": "circular"}, []),
        ({"series": "Nobody 1986"}, [9]),
    ):
        assert [s.peer_id for s in table.where(**conditions)] == ids
    assert [s.peer_id for s in table.with_history()] == [7]
    series = [(key, len(part)) for key, part in table.series().items()]
    assert series == [("Somebody 1986", 2), ("Nobody 1986", 1)]
    with pytest.raises(InputError, match="did you mean failure_mode"):
        table.where(failure="Shear")
    with pytest.raises(InputError, match=r"Nobody 1990, [AB]"):
        table["Nobody 1990, C"]


def test_a_table_elsewhere_by_its_own_name(tmp_path):
    write(tmp_path, {})
    other = tmp_path / "mine.csv"
    # As Excel saves it, with a mark at the begin.
    other.write_text("\ufeff" + (tmp_path / "specimens.csv").read_text("utf-8"), encoding="utf-8")
    assert len(peer.read_specimens(other)) == 1


def test_a_bad_value_is_named_with_its_line(tmp_path):
    for row, words in (
        ({"fc_MPa": "strong"}, "line 2: fc_MPa = 'strong' must be a number"),
        ({"fc_MPa": "0"}, "line 2: fc_MPa = '0' is not reported; it is needed"),
        ({"n_long": "11.5"}, "n_long = '11.5' must be a whole number"),
        ({"h_mm": "inf"}, "h_mm = 'inf' must be a number"),
    ):
        with pytest.raises(InputError, match=words):
            peer.read_specimens(write(tmp_path, row))
    for data, words in (
        (b"name,section\nA,rectangular\n", "no column L_mm, b_mm"),
        (b"name\n\xff\xfe\n", "UTF-8"),
        (b"", "no column name"),
    ):
        (tmp_path / "specimens.csv").write_bytes(data)
        with pytest.raises(InputError, match=words):
            peer.read_specimens(tmp_path)
    (tmp_path / "specimens.csv").unlink()
    for place, words in ((tmp_path, r"specimens\.csv: No"), (tmp_path / "nowhere", "No such file")):
        with pytest.raises(InputError, match=words):
            peer.read_specimens(place)


def test_a_history_is_read_from_csv_or_the_original_text(tmp_path):
    table = peer.read_specimens(write(tmp_path, {}))
    assert table[0].history().force.tolist() == [0.0, 1e5, -1e5]
    (tmp_path / "One.csv").unlink()
    (tmp_path / "raw").mkdir()
    (tmp_path / "raw" / "One.txt").write_text("Somebody\t\n2\t\n0\t0\n5\t50\n")
    assert table[0].path == tmp_path / "raw" / "One.txt"
    assert table[0].history().displacement.tolist() == [0.0, 0.005]
    for file, words in (("Gone.csv", "Gone.csv is not in"), ("", "names no file")):
        (s,) = peer.read_specimens(write(tmp_path, {"file": file}))
        with pytest.raises(InputError, match=words):
            s.test()


CODES = {
    # F -+ what the axial load of 1000 N takes away or adds at d = 0.1, L = 2, L_meas = 1.5.
    "1": -1000 * 0.1 / 1.5,
    "2": 0.0,
    "-": 0.0,
    "3": -1000 * math.sin(math.atan(0.1 * (2 + 0.5) / 1.5 / (2 + 0.5 + 0.25))),
    "4": 1000 * 0.1 / 0.5,
}


@pytest.mark.parametrize("code", CODES)
def test_net_force_by_code(tmp_path, code):
    """Manual of the database, 3.3, by hand."""
    row = {
        "pdelta_code": code, "axial_kN": "1", "L_mm": "2000", "Lmeas_mm": "1500", "Ltop_mm": "500",
        "Lbottom_mm": "250",
    }  # fmt: skip
    write(tmp_path, row, history="0,0\n100,5\n-100,-5\n")
    test = peer.read_specimens(tmp_path)[0].test()
    expected = 5000 + CODES[code]
    assert test.force.tolist() == pytest.approx([0.0, expected, -expected])
    assert test.measured_force.tolist() == pytest.approx([0.0, 5e3, -5e3])
    assert test.height == test.length == 2.0
    # Driven is the top, at 2 m, while 0.1 m was measured at 1.5 m; the axial load is at 2.5 m.
    top = 0.1 * 2 / 1.5
    assert test.measured_displacement.tolist() == pytest.approx([0.0, 0.1, -0.1])
    assert test.displacement.tolist() == pytest.approx([0.0, top, -top])
    assert test.drift[1] == pytest.approx(0.1 / 1.5)
    height = 2.0 if code == "4" else 2.5
    assert test.axial_height == height
    assert test.base_moment[1] == pytest.approx(expected * 2 + 1000 * top * height / 2)


def test_code_2_gives_a_copy():
    force = np.array([0.0, 1.0])
    net = peer.net_force([0.0, 1.0], force, code=2, axial_load=1.0, length=1.0)
    net[0] = 5.0
    assert force[0] == 0.0


@pytest.fixture(scope="module")
def database(peer_folder) -> peer.Specimens:
    return peer.read_specimens(peer_folder)


def test_all_of_the_table_is_read(database):
    assert len(database) >= 400
    assert len(database.where(section="rectangular").with_history()) >= 100
    assert [s.peer_id for s in database if s.duplicate_of] == [50]
    assert min(s.axial_load for s in database) < 0
    assert all(s.year is None or len(s.year) == 4 for s in database)


def test_net_forces_reproduce_what_was_published(database):
    """Largest shear of the manual, table A.1, within 1.5 % in one direction or the other."""
    agree = {code: [] for code in (1, 2, 3, 4)}
    for s in database.with_history():
        if s.observed.published_shear and s.pdelta_code:
            force = s.test().force
            published = s.observed.published_shear
            away = min(abs(abs(peak) / published - 1) for peak in (force.max(), force.min()))
            agree[s.pdelta_code].append(away < 0.015 or away * published < 600)
    for code, found in agree.items():
        if found:
            assert np.mean(found) > 0.8, (code, np.mean(found), len(found))


def test_twin_histories_are_in_one_series(database):
    twins = database.where(duplicate_of=48)
    assert twins[0].series == database["48"].series
