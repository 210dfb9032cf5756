"""Tables 2 and 3 of the paper, the reversal points of its four tests, and its columns."""

from __future__ import annotations

import importlib.util

import numpy as np
import pytest
from conftest import REPOSITORY

from rbsdem import peer
from rbsdem._package import text as data_text
from rbsdem.errors import InputError
from rbsdem.section.paper import KEYS, paper_columns, paper_sections

HISTORIES = REPOSITORY.parent / "shared" / "peer"


def test_tables_are_read_as_printed():
    """Of Zahn No 7: each printed value is in its place, in SI."""
    s, column = paper_sections()["zahn_7"], paper_columns()["zahn_7"]
    assert (s.axial_load, s.concrete_strength, s.mass) == (1010e3, 28.3e6, pytest.approx(614.4))
    assert (s.width, s.depth, s.length, s.cover) == (0.4, 0.4, 1.6, 0.013)
    assert (s.longitudinal_number, s.longitudinal_diameter, s.shear_legs) == (12, 0.016, 4)
    assert (s.longitudinal_yield_stress, s.longitudinal_ultimate_stress) == (440e6, 674e6)
    assert (s.transverse_yield_stress, s.transverse_ultimate_stress) == (466e6, 688e6)
    assert (s.transverse_diameter, s.transverse_spacing) == (0.01, 0.117)
    v, m = column.shear, column.flexure
    assert (v.k, v.d_y, v.k_post) == (6.2110e8, 1.6800e-4, 6.3231e6)
    assert (m.k_c, m.d_c, m.k_y, m.d_y) == (2.1371e8, 4.4191e-4, 6.2188e7, 2.6367e-3)
    assert (m.k_u, m.b0, m.b1, m.inner) == (1.4052e7, 0.40, 0.15, "kc")


@pytest.mark.parametrize("key", KEYS)
def test_tables_agree_with_themselves(key):
    s, column = paper_sections()[key], paper_columns()[key]
    assert s.length / s.depth == pytest.approx(s.span_depth_ratio, rel=1e-15)
    for diameter, area in (
        (s.longitudinal_diameter, s.longitudinal_area),
        (s.transverse_diameter, s.transverse_area),
    ):
        assert np.pi / 4.0 * diameter**2 * 1e6 == pytest.approx(area * 1e6, abs=0.005)
    section = s.section
    assert len(section.bars) == s.longitudinal_number
    bars = s.longitudinal_number * s.longitudinal_area
    assert section.steel_ratio == pytest.approx(bars / s.gross_area, rel=1e-4)
    assert (column.n, column.kinematics) == (1, "small")
    assert (column.height, column.axial_load) == (s.length, s.axial_load)
    assert column.mass == pytest.approx(2400.0 * s.width * s.depth * s.length, rel=1e-14)
    # E9 of the list of misprints: by eq 7 K_r over K_c is at most its value at D_m = D_y.
    m = column.flexure
    cracking = m.k_c * m.d_c
    most = (2 * cracking + m.k_y * (m.d_y - m.d_c)) / (m.d_c + m.d_y) / m.k_c
    assert (m.b1 > most) == (key == "tanaka_park_5")


def test_columns_with_changes():
    columns = paper_columns("finite", axial_load=0.0)
    assert {column.kinematics for column in columns.values()} == {"finite"}
    assert {column.axial_load for column in columns.values()} == {0.0}
    assert paper_columns("pdelta")["zahn_7"].axial_load == 1.01e6


@pytest.mark.parametrize("key", KEYS)
def test_reversal_points(key):
    """All but the first and the last are turns of more than 2 % of the largest displacement."""
    points, loop = peer.shipped_reversals(key), peer.measured_loops()[key]
    d, f = points.displacement, points.force
    assert (d[0], f[0]) == (0.0, 0.0)
    legs = np.diff(d)
    assert np.all(legs[1:] * legs[:-1] < 0)
    assert np.abs(legs[:-1]).min() > 0.02 * np.abs(d).max()
    assert loop.peak_displacement == pytest.approx(np.abs(d).max(), rel=1e-14)
    assert 0.9 * loop.peak_force < np.abs(f).max() <= loop.peak_force
    assert points.name == paper_sections()[key].specimen
    for words in ("University of Canterbury", "Berry, M., Parrish, M., Eberhard, M. (2004)", "kN"):
        assert words in points.source


def test_extraction_writes_the_shipped_files(tmp_path, monkeypatch):
    if not HISTORIES.is_dir():
        pytest.skip("no ../shared/peer beside the checkout with the full histories")
    spec = importlib.util.spec_from_file_location(
        "extract_reversals", REPOSITORY / "scripts" / "extract_reversals.py"
    )
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    monkeypatch.setattr("sys.argv", ["extract", str(HISTORIES), "--out", str(tmp_path)])
    assert script.main() == 0
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == sorted(["measured_loops.csv", *(f"reversals_{key}.csv" for key in KEYS)])
    for name in written:
        assert (tmp_path / name).read_text(encoding="utf-8") == data_text(name)


def test_find_history_in_a_folder_and_by_the_variable(tmp_path, monkeypatch):
    monkeypatch.delenv("RBSDEM_PEER_DIR", raising=False)
    assert peer.find_history("zahn_7") is None
    assert peer.find_history("zahn_7", tmp_path) is None

    raw = tmp_path / "raw"
    raw.mkdir()
    (raw / "zahn86u7.txt").write_text("Zahn\t\n1\t\n0\t0\n")
    assert peer.find_history("zahn_7", tmp_path) == raw / "zahn86u7.txt"
    (tmp_path / "Zahn_et_al_1986_No7.csv").write_text("displacement_mm,force_kN\n0,0\n")
    assert peer.find_history("zahn_7", tmp_path) == tmp_path / "Zahn_et_al_1986_No7.csv"
    assert peer.find_history("zahn86u7.txt", tmp_path) == raw / "zahn86u7.txt"
    assert peer.find_history("tanaka_park_1", tmp_path) is None

    monkeypatch.setenv("RBSDEM_PEER_DIR", str(raw))
    assert peer.find_history("zahn_7") == raw / "zahn86u7.txt"
    assert peer.find_history("zahn_7", tmp_path) == tmp_path / "Zahn_et_al_1986_No7.csv"
    monkeypatch.setenv("RBSDEM_PEER_DIR", "")
    assert peer.find_history("zahn_7") is None
    with pytest.raises(InputError, match="missing is not a folder"):
        peer.find_history("zahn_7", tmp_path / "missing")
    monkeypatch.setenv("RBSDEM_PEER_DIR", str(tmp_path / "missing"))
    with pytest.raises(InputError, match="RBSDEM_PEER_DIR"):
        peer.find_history("zahn_7")
