"""Tables 2 and 3 of the paper, the reversal points of the four tests, and figure 3's panels."""

from __future__ import annotations

import csv
import importlib.util
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import curves as comparison
from rbsdem import peer
from rbsdem._package import text as data_text
from rbsdem.errors import InputError
from rbsdem.section.columns import CONCRETE_DENSITY
from rbsdem.section.paper import KEYS, paper_columns, paper_sections

ROOT = Path(__file__).resolve().parents[2]
HISTORIES = ROOT.parent / "shared" / "peer"

# Printed in the paper, column by column: axial load [kN], concrete strength [MPa], side [mm],
# length [mm], cover [mm], bars, bar diameter [mm], their yield and ultimate stress [MPa]; stirrups:
# yield and ultimate stress [MPa], diameter, spacing [mm], legs.
TABLE_2 = {
    "soesianawati_1": (744, 46.5, 400, 1600, 13, 12, 16, 446, 702, 364, 521, 7, 85, 4),
    "tanaka_park_1": (819, 25.6, 400, 1600, 40, 8, 20, 474, 721, 333, 481, 12, 80, 3),
    "tanaka_park_5": (968, 32, 550, 1650, 40, 12, 20, 511, 675, 325, 429, 12, 110, 4),
    "zahn_7": (1010, 28.3, 400, 1600, 13, 12, 16, 440, 674, 466, 688, 10, 117, 4),
}

# Shear K_y, D_y, K_u; flexure K_c, D_c, K_y, D_y, K_u, B_0, B_1.
TABLE_3 = {
    "soesianawati_1": (
        (7.0387e8, 1.2960e-4, 8.3185e6),
        (2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, 0.40, 0.22),
    ),
    "tanaka_park_1": (
        (6.3089e8, 1.3280e-4, 2.5114e7),
        (1.7426e8, 4.5449e-4, 4.7797e7, 3.7852e-3, 4.5919e6, 0.40, 0.42),
    ),
    "tanaka_park_5": (
        (9.6302e8, 1.7325e-4, 4.0628e7),
        (6.2258e8, 2.4423e-4, 1.3001e8, 2.5311e-3, 3.7331e7, 0.40, 0.68),
    ),
    "zahn_7": (
        (6.2110e8, 1.6800e-4, 6.3231e6),
        (2.1371e8, 4.4191e-4, 6.2188e7, 2.6367e-3, 1.4052e7, 0.40, 0.15),
    ),
}

# From the database's summary: rows, largest and least force [kN] and displacement [mm], reversals.
HISTORY = {
    "soesianawati_1": (744, 199.59, -186.22, 97.854, -98.059, 22),
    "tanaka_park_1": (593, 166.83, -167.10, 129.50, -86.073, 19),
    "tanaka_park_5": (589, 385.62, -383.84, 74.305, -76.586, 14),
    "zahn_7": (491, 213.30, -196.47, 97.008, -118.18, 17),
}

# Secant stiffness at half of the peak force, by the same source [kN/mm].
SECANT_50 = {
    "soesianawati_1": 29.06,
    "tanaka_park_1": 23.48,
    "tanaka_park_5": 41.99,
    "zahn_7": 22.83,
}

# Secant stiffness at 70 % of the peak force, by the shared definitions [kN/mm].
SECANT_70 = {
    "soesianawati_1": 21.8715,
    "tanaka_park_1": 15.2939,
    "tanaka_park_5": 30.6123,
    "zahn_7": 17.1702,
}


def history(key: str) -> Path:
    """Return the full history of a test or skip."""
    path = peer.find_history(key, HISTORIES) if HISTORIES.is_dir() else None
    if path is None:
        pytest.skip("no ../shared/peer beside the checkout with the full histories")
    return path


# ---- tables 2 and 3 ------------------------------------------------------------------------------


@pytest.mark.parametrize("key", KEYS)
def test_table_2_is_as_printed(key):
    s = paper_sections()[key]
    assert (
        s.axial_load / 1e3,
        s.concrete_strength / 1e6,
        s.width * 1e3,
        s.length * 1e3,
        s.cover * 1e3,
        s.longitudinal_number,
        s.longitudinal_diameter * 1e3,
        s.longitudinal_yield_stress / 1e6,
        s.longitudinal_ultimate_stress / 1e6,
        s.transverse_yield_stress / 1e6,
        s.transverse_ultimate_stress / 1e6,
        s.transverse_diameter * 1e3,
        s.transverse_spacing * 1e3,
        s.shear_legs,
    ) == pytest.approx(TABLE_2[key], rel=1e-15)
    assert s.depth == s.width


@pytest.mark.parametrize("key", KEYS)
def test_table_2_agrees_with_itself(key):
    s = paper_sections()[key]
    assert s.length / s.depth == pytest.approx(s.span_depth_ratio, rel=1e-15)
    for diameter, area in (
        (s.longitudinal_diameter, s.longitudinal_area),
        (s.transverse_diameter, s.transverse_area),
    ):
        assert np.pi / 4.0 * diameter**2 * 1e6 == pytest.approx(area * 1e6, abs=0.005)


@pytest.mark.parametrize("key", KEYS)
def test_table_3_is_as_printed(key):
    column = paper_columns()[key]
    v, m = column.shear, column.flexure
    assert (v.k, v.d_y, v.k_post) == TABLE_3[key][0]
    assert (m.k_c, m.d_c, m.k_y, m.d_y, m.k_u, m.b0, m.b1) == TABLE_3[key][1]
    assert m.inner == "kc"


def test_digits_of_the_csv_files_are_the_printed_ones():
    for name in ("paper_table_2.csv", "paper_table_3.csv"):
        lines = [line for line in data_text(name).splitlines() if not line.startswith("#")]
        rows = list(csv.reader(lines))
        assert {len(row) for row in rows} == {7}
        assert rows[0][3:] == list(KEYS)
    numbers = [text for row in rows[1:9] for text in row[3:]]
    assert len(numbers) == 32
    assert all(len(text) == len("7.0387E+08") for text in numbers)


def test_yield_forces_of_the_springs():
    """takeda.md section 4 and the bilinear sequence there, both for Soesianawati No 1."""
    column = paper_columns()["soesianawati_1"]
    v, m = column.shear, column.flexure
    assert v.k * v.d_y == pytest.approx(91221.552, rel=1e-12)
    cracking = m.k_c * m.d_c
    assert cracking == pytest.approx(81092.4348, rel=1e-12)
    assert cracking + m.k_y * (m.d_y - m.d_c) == pytest.approx(232102.8432, rel=1e-9)


def test_b1_of_tanaka_park_5_is_above_what_equation_7_gives():
    """E9 of the list of misprints: K_r over K_c is at most its value at D_m = D_y."""
    most = {}
    for key, column in paper_columns().items():
        m = column.flexure
        cracking = m.k_c * m.d_c
        yielding = cracking + m.k_y * (m.d_y - m.d_c)
        most[key] = (cracking + yielding) / (m.d_c + m.d_y) / m.k_c
        assert (m.b1 > most[key]) == (key == "tanaka_park_5")
    assert most["tanaka_park_5"] == pytest.approx(0.348, abs=5e-4)
    assert paper_columns()["tanaka_park_5"].flexure.b1 == 0.68


@pytest.mark.parametrize("key", KEYS)
def test_columns_take_height_load_and_mass_from_table_2(key):
    column, section = paper_columns()[key], paper_sections()[key]
    assert column.n == 1
    assert column.kinematics == "small"
    assert column.height == section.length
    assert column.axial_load == section.axial_load
    assert column.mass == section.mass
    mass = 1197.9 if key == "tanaka_park_5" else 614.4
    assert column.mass == pytest.approx(mass, rel=1e-14)
    assert CONCRETE_DENSITY == 2400.0


def test_columns_with_changes():
    columns = paper_columns("finite", axial_load=0.0)
    assert {column.kinematics for column in columns.values()} == {"finite"}
    assert {column.axial_load for column in columns.values()} == {0.0}
    assert paper_columns("pdelta")["zahn_7"].axial_load == 1.01e6
    with pytest.raises(InputError, match="axial_lode"):
        paper_columns(axial_lode=0.0)


# ---- reversal points -----------------------------------------------------------------------------


@pytest.mark.parametrize("key", KEYS)
def test_reversal_points(key):
    points = peer.shipped_reversals(key)
    _, _, _, d_max, d_min, reversals = HISTORY[key]
    d, f = points.displacement * 1e3, points.force / 1e3
    assert d.shape == f.shape == (reversals + 2,)
    assert (d[0], f[0]) == (0.0, 0.0)
    assert d.max() == pytest.approx(d_max, rel=1e-14)
    assert d.min() == pytest.approx(d_min, rel=1e-14)
    # Every point but the first and the last is a turn of more than 2 % of the largest displacement.
    legs = np.diff(d)
    assert np.all(legs[1:] * legs[:-1] < 0)
    assert np.abs(legs[:-1]).min() > 0.02 * np.abs(d).max()


@pytest.mark.parametrize("key", KEYS)
def test_forces_of_reversal_points_stay_inside_those_of_the_history(key):
    _, f_max, f_min, *_ = HISTORY[key]
    f = peer.shipped_reversals(key).force / 1e3
    assert 0.9 * f_max < f.max() <= f_max
    assert f_min <= f.min() < 0.9 * f_min


@pytest.mark.parametrize("key", KEYS)
def test_reversal_files_name_what_to_cite(key):
    points = peer.shipped_reversals(key)
    assert points.name == paper_sections()[key].specimen
    assert "University of Canterbury" in points.source
    assert "Berry, M., Parrish, M., Eberhard, M. (2004)" in points.source
    assert "mm" in points.source
    assert "kN" in points.source


@pytest.mark.parametrize("key", KEYS)
def test_measured_loops_state_the_peaks_of_the_histories(key):
    loop = peer.measured_loops()[key]
    _, f_max, f_min, d_max, d_min, _ = HISTORY[key]
    assert loop.peak_force == pytest.approx(1e3 * max(f_max, -f_min), rel=1e-14)
    assert loop.peak_displacement == pytest.approx(1e-3 * max(d_max, -d_min), rel=1e-14)
    assert loop.stiffness == pytest.approx(1e6 * SECANT_70[key], rel=5e-6)


@pytest.mark.parametrize("key", KEYS)
def test_reversal_points_are_rows_of_the_full_history(key):
    test, points = rbsdem.peer.read_peer(history(key)), peer.shipped_reversals(key)
    assert len(test.force) == HISTORY[key][0]
    rows = set(zip(test.displacement.tolist(), test.force.tolist(), strict=True))
    assert set(zip(points.displacement.tolist(), points.force.tolist(), strict=True)) <= rows


@pytest.mark.parametrize("key", KEYS)
def test_measured_loops_are_those_of_the_full_histories(key):
    test = rbsdem.peer.read_peer(history(key))
    loop, shipped = comparison.summarise(test.displacement, test.force), peer.measured_loops()[key]
    assert loop.peak_force == pytest.approx(shipped.peak_force, rel=5e-6)
    assert loop.displacement_at_peak == pytest.approx(shipped.displacement_at_peak, rel=5e-6)
    assert loop.energy == pytest.approx(shipped.energy, rel=5e-6)
    assert loop.stiffness == pytest.approx(shipped.stiffness, rel=5e-6)
    half = comparison.secant_stiffness(test.displacement, test.force, level=0.5)
    assert half == pytest.approx(1e6 * SECANT_50[key], rel=2e-4)


def test_extraction_writes_the_shipped_files(tmp_path, monkeypatch):
    for key in KEYS:
        history(key)
    spec = importlib.util.spec_from_file_location(
        "extract_reversals", ROOT / "scripts" / "extract_reversals.py"
    )
    script = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(script)
    monkeypatch.setattr("sys.argv", ["extract", str(HISTORIES), "--out", str(tmp_path)])
    assert script.main() == 0
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == sorted(["measured_loops.csv", *(f"reversals_{key}.csv" for key in KEYS)])
    for name in written:
        assert (tmp_path / name).read_text(encoding="utf-8") == data_text(name)


def test_unknown_keys_and_files_are_refused():
    with pytest.raises(InputError, match="soesianawati_1"):
        peer.shipped_reversals("soesianawati_2")
    with pytest.raises(InputError, match=r"none\.csv"):
        data_text("none.csv")


# ---- where the histories are ---------------------------------------------------------------------


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


def test_a_folder_that_is_not_there_is_an_error(tmp_path, monkeypatch):
    missing = tmp_path / "missing"
    with pytest.raises(InputError, match="missing is not a folder"):
        peer.find_history("zahn_7", missing)
    monkeypatch.setenv("RBSDEM_PEER_DIR", str(missing))
    with pytest.raises(InputError, match="RBSDEM_PEER_DIR"):
        peer.find_history("zahn_7")


# ---- figures -------------------------------------------------------------------------------------


def panels():
    """Four panels of reversal points against half of them."""
    from rbsdem import plot  # noqa: PLC0415

    made = []
    for key, section in paper_sections().items():
        points = peer.shipped_reversals(key)
        half = (0.5 * points.displacement, points.force)
        made.append(plot.Panel(section.specimen, half, points, section.length, True))
    return made


def test_four_panels_are_lettered_symmetric_and_leave_no_style_behind(tmp_path):
    matplotlib = pytest.importorskip("matplotlib")
    from rbsdem import plot  # noqa: PLC0415

    before = dict(matplotlib.rcParams)
    figure = plot.four_panels(panels())
    axes = figure.axes
    assert len(axes) == 4
    for letter, ax, key in zip("abcd", axes, KEYS, strict=True):
        assert ax.texts[0].get_text() == f"({letter}) {paper_sections()[key].specimen}"
        assert ax.get_xlim()[0] == -ax.get_xlim()[1]
        assert ax.get_ylim()[0] == -ax.get_ylim()[1]
        d = peer.shipped_reversals(key).displacement * 1e3
        assert np.abs(d).max() < ax.get_xlim()[1] < 1.2 * np.abs(d).max()
        drift = ax.child_axes[0]
        assert drift.get_xlim()[1] == pytest.approx(
            0.1 * ax.get_xlim()[1] / paper_sections()[key].length
        )
    assert len(figure.legends) == 1
    files = plot.save(figure, tmp_path / "new" / "figure", pdf=True)
    assert [file.name for file in files] == ["figure.png", "figure.pdf"]
    assert files[0].read_bytes().startswith(b"\x89PNG")
    assert files[1].read_bytes().startswith(b"%PDF")
    assert dict(matplotlib.rcParams) == before


def test_loops_are_drawn_in_mm_and_kn_on_given_axes():
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure  # noqa: PLC0415

    from rbsdem import plot  # noqa: PLC0415

    ax = Figure().subplots()
    assert plot.loop([0.0, 0.01, -0.02], [0.0, 1e5, -2e5], ax=ax, color="red") is ax
    np.testing.assert_allclose(ax.get_lines()[0].get_xydata(), [[0, 0], [10, 100], [-20, -200]])
    ax = plot.loops_over_test(([0, 1e-3], [0, 1e3]), ([0, 2e-3], [0, 1e3]), ax=Figure().subplots())
    labels = [text.get_text() for text in ax.get_legend().get_texts()]
    assert labels == ["Test", "Model"]


@pytest.mark.parametrize("draw", ["loop", "loops_over_test"])
def test_keywords_of_lines_go_by_any_of_their_names(draw):
    pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure  # noqa: PLC0415

    from rbsdem import plot  # noqa: PLC0415

    curve = ([0.0, 0.01], [0.0, 1e5])
    ax = Figure().subplots()
    if draw == "loop":
        plot.loop(curve, ax=ax, lw=1.5, c="red", ls="--")
    else:
        plot.loops_over_test(curve, curve, ax=ax, lw=1.5, c="red", ls="--")
    line = ax.get_lines()[0 if draw == "loop" else 1]
    assert (line.get_linewidth(), line.get_color(), line.get_linestyle()) == (1.5, "red", "--")


def test_axes_of_the_caller_keep_the_style_of_the_caller():
    matplotlib = pytest.importorskip("matplotlib")
    from matplotlib.figure import Figure  # noqa: PLC0415

    from rbsdem import plot  # noqa: PLC0415

    with matplotlib.rc_context({"font.family": "monospace", "font.size": 13.0}):
        figure = Figure()
        ax = figure.subplots()
        curve = ([0.0, 0.01, -0.01], [0.0, 1e5, -1e5])
        for _ in range(2):
            plot.loops_over_test(curve, curve, title="Test 1", height=1.6, ax=ax)
        figure.draw_without_rendering()
        (drift,) = ax.child_axes
        texts = [ax.xaxis.label, drift.xaxis.label, ax.texts[0], *ax.get_legend().get_texts()]
        texts += [*ax.get_xticklabels(), *drift.get_xticklabels()]
        assert {text.get_fontfamily()[0] for text in texts} == {"monospace"}
        assert {text.get_fontsize() for text in texts} == {13.0}
    # New axes are in the house style, and only they.
    house = plot.loop(curve)
    try:
        assert house.xaxis.label.get_fontfamily() == [plot.RC["font.family"]]
    finally:
        matplotlib.pyplot.close(house.figure)
