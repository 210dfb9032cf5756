"""History files through both doors: `rbsdem.peer.read_peer`, and a loading of the executable.

Traps of the PEER text format: README of the shared folder peer, "Original file format". Numbers are
compared to the last bit with what Python's own reading makes of the same text.
"""

from __future__ import annotations

import csv
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import rbsdem

ELASTIC = "rule = 'elastic', k = 1e6"
PRIORITY = {
    "Soesianawati_et_al_1986_No1": "soes86u1",
    "Tanaka_and_Park_1990_No1": "tana90u1",
    "Tanaka_and_Park_1990_No5": "tana90u5",
    "Zahn_et_al_1986_No7": "zahn86u7",
}

PAIRS = [(0.0, 0.0), (0.1, 12.5), (-3.25, -40.125), (97.854, 199.59), (1e-3, 0.7)]
LINES = [f"{d}\t{f}" for d, f in PAIRS]
EXPECTED = (
    np.array([d for d, _ in PAIRS]) / 1000,
    np.array([f for _, f in PAIRS]) * 1000,
)


@pytest.fixture
def through_executable(run_cli, case_text, tmp_path, read_csv):
    """Drive an elastic column with a file: what is driven comes back row by row."""

    def read(file: str, drive: str, keys: str = "") -> np.ndarray:
        case = tmp_path / "driven.nml"
        loading = f"drive = '{drive}', file = '{file}', {keys}"
        static = "method = 'static'"
        text = case_text(shear=ELASTIC, flexure=ELASTIC, loading=loading, analysis=static)
        case.write_text(text)
        result = run_cli(["run", "driven.nml", "-q", "-o", "driven.csv"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        column = {"displacement": "displacement_m", "force": "force_N"}[drive]
        return read_csv(tmp_path / "driven.csv")[column]

    return read


@pytest.fixture
def complaint(run_cli, case_text, tmp_path, monkeypatch):
    """Text of the error that both doors give for a file, the same for both."""

    def text(file: str, drive: str = "displacement") -> str:
        case = tmp_path / "driven.nml"
        loading = f"drive = '{drive}', file = '{file}'"
        case.write_text(case_text(shear=ELASTIC, flexure=ELASTIC, loading=loading))
        for command in ("check", "run"):
            result = run_cli([command, "driven.nml"], tmp_path)
            assert result.returncode == 2, result
            assert result.stdout == ""
        said = result.stderr.splitlines()
        assert len(said) == 1
        monkeypatch.chdir(tmp_path)
        with pytest.raises(rbsdem.InputError) as error:
            rbsdem.peer.read_peer(file)
        assert said[0] == f"rbsdem: {error.value}"
        return str(error.value)

    return text


# ---- the traps of the text format ----------------------------------------------------------------


def peer_text(name="Test", count: object = len(LINES), lines=LINES, tail="", end="\n") -> str:
    """A file in the database's format; `tail` stands at the end of every line."""
    return "".join(f"{line}{tail}{end}" for line in (name, str(count), *lines))


TRAPS = {
    "plain": peer_text(),
    "name in quotes": peer_text(name='"Test"'),
    "a tab behind name and count": peer_text(name="Test\t", count="5\t"),
    "name in quotes and a tab": peer_text(name='"Test"\t', count="5\t"),
    "19 tabs on every line": peer_text(tail="\t" * 19),
    "blanks and tabs on every line": peer_text(tail=" \t \t"),
    "blanks before": peer_text(name="  Test", count="  5", lines=["   " + line for line in LINES]),
    "count tab 0": peer_text(count="5\t0"),
    "count tab 0 tabs": peer_text(count="5\t0\t\t"),
    "count blank 0": peer_text(count="5 0"),
    "third column, axial load": peer_text(lines=[line + "\t744.0" for line in LINES]),
    "third column and tabs": peer_text(lines=[line + "\t-744" for line in LINES], tail="\t\t"),
    "windows": peer_text(end="\r\n"),
    "old mac": peer_text(end="\r"),
    "no end of line at the end": peer_text().rstrip("\n"),
    "no end of line at the end, mac": peer_text(end="\r").rstrip("\r"),
    "byte order mark": "\ufeff" + peer_text(),
    "byte order mark and quotes": "\ufeff" + peer_text(name='"Test"'),
    "blank lines at the end": peer_text() + "\n\t\n \n",
    "blank lines between": peer_text(lines=[line + "\n" for line in LINES]),
    "blanks for tabs": peer_text(lines=[line.replace("\t", "   ") for line in LINES]),
    "tabs and blanks": peer_text(lines=[line.replace("\t", " \t ") for line in LINES]),
    "numbers in quotes": peer_text(lines=[f'"{d}"\t"{f}"' for d, f in PAIRS]),
    "signs": peer_text(lines=[f"{d:+}\t{f:+}" for d, f in PAIRS]),
    "exponents": peer_text(lines=[f"{d:.17e}\t{f:.17E}" for d, f in PAIRS]),
    "fortran exponents": peer_text(
        lines=[f"{d:.17e}\t{f:.17e}".replace("e", "D") for d, f in PAIRS]
    ),
}


@pytest.mark.parametrize("trap", TRAPS)
def test_peer_format_trap(through_executable, tmp_path, trap):
    (tmp_path / "test.txt").write_bytes(TRAPS[trap].encode())
    test = rbsdem.peer.read_peer(tmp_path / "test.txt")
    assert test.name == "Test"
    assert np.array_equal(test.displacement, EXPECTED[0])
    assert np.array_equal(test.force, EXPECTED[1])
    assert test.displacement.dtype == test.force.dtype == np.float64
    for drive, expected in zip(("displacement", "force"), EXPECTED, strict=True):
        assert np.array_equal(through_executable("test.txt", drive), expected)
        assert np.array_equal(through_executable("test.txt", drive, "format = 'peer'"), expected)


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ("Ono et al. 1989, CA025C", "Ono et al. 1989, CA025C"),
        ('"Zhou et al. 1987, No. 806040"\t', "Zhou et al. 1987, No. 806040"),
        ("2D16RS, 0.25, 1:3", "2D16RS, 0.25, 1:3"),
        ("104-08", "104-08"),
        ("No; semicolon", "No; semicolon"),
        ("# 7", "# 7"),
        ("Säule ½", "Säule ½"),
        ("806040, east", "806040, east"),
        ("806040 east", "806040 east"),
        ("1.5", "1.5"),
        ("7", "7"),
        ("nan", "nan"),
        ("x" * 200, "x" * 200),
    ],
)
def test_name_with_digits_commas_and_the_like(through_executable, tmp_path, line, name):
    (tmp_path / "test.txt").write_text(peer_text(name=line), encoding="utf-8")
    test = rbsdem.peer.read_peer(tmp_path / "test.txt")
    assert test.name == name
    for drive, expected in zip(("displacement", "force"), EXPECTED, strict=True):
        assert np.array_equal(through_executable("test.txt", drive), expected)
    assert np.array_equal(test.force, EXPECTED[1])


def test_name_that_is_no_utf_8_does_not_stop_the_reading(through_executable, tmp_path):
    (tmp_path / "test.txt").write_bytes(peer_text(name="Säule").encode("latin-1"))
    test = rbsdem.peer.read_peer(tmp_path / "test.txt")
    assert test.name == "S\N{REPLACEMENT CHARACTER}ule"
    assert np.array_equal(test.force, EXPECTED[1])
    assert np.array_equal(through_executable("test.txt", "force"), EXPECTED[1])


def test_count_is_never_let_in_as_a_pair(tmp_path):
    """8734<TAB>0 in abouorc3.txt came in as a pair of PEER 198 and 371."""
    rng = np.random.default_rng(198)
    pairs = rng.uniform(-100, 100, (8734, 2)).round(4)
    text = peer_text(count="8734\t0", lines=[f"{d}\t{f}" for d, f in pairs])
    (tmp_path / "abouorc3.txt").write_text(text)
    test = rbsdem.peer.read_peer(tmp_path / "abouorc3.txt")
    assert test.displacement.size == 8734
    assert np.array_equal(test.displacement, pairs[:, 0] / 1000)
    assert np.array_equal(test.force, pairs[:, 1] * 1000)


def test_first_pair_is_not_always_zero_and_rows_may_repeat(tmp_path):
    """Takemura 0,-1.31; Mo & Wang 2.56,29.5; Tanaka No 5 and Zahn No 7 repeat rows."""
    for first in ((0.0, -1.31), (2.56, 29.5)):
        pairs = [first, (0.0, 0.0), (0.0, 20.0), (0.0, 20.0), (5.0, 1.0)]
        (tmp_path / "t.txt").write_text(peer_text(lines=[f"{d}\t{f}" for d, f in pairs]))
        test = rbsdem.peer.read_peer(tmp_path / "t.txt")
        assert np.array_equal(test.displacement, np.array([d for d, _ in pairs]) / 1000)
        assert np.array_equal(test.force, np.array([f for _, f in pairs]) * 1000)


BAD_PEER = [
    (peer_text(count=4), ["line 2 declares 4", "there are 5"]),
    (peer_text(count=6), ["line 2 declares 6", "there are 5"]),
    (peer_text(count=0), ["test.txt"]),
    (peer_text(lines=LINES[:-1]), ["line 2 declares 5", "there are 4"]),
    (peer_text(lines=[*LINES[:2], "1,600\t3", *LINES[3:]]), ["line 5, value 1", "1,600"]),
    (peer_text(lines=[*LINES[:2], "1\t1,600.5", *LINES[3:]]), ["line 5, value 2", "1,600.5"]),
    (peer_text(lines=[*LINES[:2], "1.25-3.5\t2", *LINES[3:]]), ["line 5, value 1", "1.25-3.5"]),
    (peer_text(lines=[*LINES[:2], "1.25.3\t2", *LINES[3:]]), ["line 5, value 1", "1.25.3"]),
    (peer_text(lines=[*LINES[:2], "1.25-3.5", *LINES[3:]]), ["line 5", "1 value", "have 2"]),
    (peer_text(lines=[*LINES[:2], "1\t2\t3", *LINES[3:]]), ["line 5", "3 values", "have 2"]),
    (peer_text(lines=[*LINES[:2], "x\ty", *LINES[3:]]), ["line 5, value 1", "'x'", "not a number"]),
    (peer_text(lines=[*LINES[:4], "NaN\t2"]), ["line 7, value 1", "'NaN'", "finite"]),
    (peer_text(lines=[*LINES[:4], "2\t-inf"]), ["line 7, value 2", "'-inf'", "finite"]),
    (peer_text(lines=[line + "\t1\t1" for line in LINES]), ["4 columns"]),
    ("Test\n", ["test.txt"]),
]


@pytest.mark.parametrize(("text", "words"), BAD_PEER)
def test_bad_peer_file_is_named_with_its_line(complaint, tmp_path, text, words):
    (tmp_path / "test.txt").write_text(text)
    said = complaint("test.txt")
    assert said.startswith("test.txt")
    for word in words:
        assert word in said


@pytest.mark.parametrize(
    ("second", "words"),
    [("5.0", ["line 2", "'5.0'"]), ("five", ["'five'"]), ("5\t1", ["line 2"]), ("", ["line 2"]),
     ("-5", ["'-5'"]), ("99999999999999", ["'99999999999999'"]), ("5 0 0", ["line 2"])],
)  # fmt: skip
def test_second_line_that_is_no_count(run_cli, case_text, tmp_path, second, words):
    (tmp_path / "test.txt").write_text(peer_text(count=second))
    loading = "drive = 'force', file = 'test.txt', format = 'peer'"
    (tmp_path / "case.nml").write_text(case_text(loading=loading))
    result = run_cli(["check", "case.nml"], tmp_path)
    assert result.returncode == 2
    for word in ("test.txt", "number of pairs", "format = 'csv'", *words):
        assert word in result.stderr


# ---- csv -----------------------------------------------------------------------------------------

ROWS = [f"{d},{f}" for d, f in PAIRS]


def csv_text(header="displacement_mm,force_kN", rows=ROWS, end="\n") -> str:
    return "".join(f"{line}{end}" for line in (*([header] if header else []), *rows))


CSV = {
    "plain": csv_text(),
    "semicolons": csv_text().replace(",", ";"),
    "tabs": csv_text().replace(",", "\t"),
    "blanks": csv_text().replace(",", "  "),
    "commas and blanks": csv_text().replace(",", " , "),
    "tabs, first row 0 0 as whole numbers": csv_text().replace(",", "\t").replace("0.0", "0", 2),
    "blanks, first row 0 0 as whole numbers": csv_text().replace(",", " ").replace("0.0", "0", 2),
    "windows": csv_text(end="\r\n"),
    "old mac": csv_text(end="\r"),
    "no end of line at the end": csv_text().rstrip("\n"),
    "byte order mark": "\ufeff" + csv_text(),
    "comments before": "# a test\n#\n" + csv_text(),
    "comments between": csv_text(rows=[row + "\n# note, 1" for row in ROWS]),
    "comment with blanks before": "   # a test\n" + csv_text(),
    "blank lines": "\n\n" + csv_text(rows=[row + "\n \n" for row in ROWS]),
    "header in quotes": csv_text('"displacement_mm","force_kN"'),
    "numbers in quotes": csv_text(rows=[f'"{d}","{f}"' for d, f in PAIRS]),
    "capitals": csv_text("DISPLACEMENT_MM,FORCE_KN"),
    "turned around": csv_text("force_kN,displacement_mm", [f"{f},{d}" for d, f in PAIRS]),
    "columns between": csv_text("t,displacement_mm,x,force_kN", [f"1,{d},2,{f}" for d, f in PAIRS]),
    "longer names": csv_text("displacement_top_mm,force_lateral_kN"),
    "metres and newtons": csv_text(
        "displacement_m,force_N",
        [f"{float(d)!r},{float(f)!r}" for d, f in zip(*EXPECTED, strict=True)],
    ),
    "no units: SI": csv_text(
        "displacement,force", [f"{float(d)!r},{float(f)!r}" for d, f in zip(*EXPECTED, strict=True)]
    ),
    "exponents": csv_text(rows=[f"{d:.17e},{f:.17E}" for d, f in PAIRS]),
    "fortran exponents": csv_text(
        rows=[f"{d:.17e},{f:.17e}".replace("e", letter) for (d, f), letter in zip(
            PAIRS, "dDdDd", strict=True)]
    ),
    "short forms": csv_text(
        rows=["0,.0", "+.1,12.5", "-3.25,-40.125", "97.854,199.59", "1.e-3,7.E-1"]
    ),
    "many digits": csv_text(
        rows=["0.0000000000000000000000000,0", "0.1000000000000000055511151231257827,12.50000",
              "-003.25,-40.125", "97.854,199.59", "0.00100000000000000000000,0.7"]
    ),
}  # fmt: skip


@pytest.mark.parametrize("kind", CSV)
def test_csv_variant(through_executable, tmp_path, kind):
    (tmp_path / "test.csv").write_bytes(CSV[kind].encode())
    test = rbsdem.peer.read_peer(tmp_path / "test.csv")
    assert test.name == "test.csv"
    assert np.array_equal(test.displacement, EXPECTED[0])
    assert np.array_equal(test.force, EXPECTED[1])
    for drive, expected in zip(("displacement", "force"), EXPECTED, strict=True):
        assert np.array_equal(through_executable("test.csv", drive), expected)
        assert np.array_equal(through_executable("test.csv", drive, "format = 'csv'"), expected)


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
def test_csv_without_header_by_number_of_column_and_unit(through_executable, tmp_path, separator):
    (tmp_path / "test.csv").write_text(csv_text("").replace(",", separator))
    d = through_executable("test.csv", "displacement", "column = '1', unit = 'mm'")
    f = through_executable("test.csv", "force", "column = '2', unit = 'kN'")
    assert np.array_equal(d, EXPECTED[0])
    assert np.array_equal(f, EXPECTED[1])


@pytest.mark.parametrize(
    ("drive", "label", "keys", "numerator", "denominator"),
    [
        ("displacement", "displacement_m", "", 1, 1),
        ("displacement", "displacement_cm", "", 1, 100),
        ("displacement", "displacement_mm", "", 1, 1000),
        ("displacement", "displacement_in", "", 0.0254, 1),
        ("displacement", "displacement_mm", "unit = 'm'", 1, 1),
        ("displacement", "displacement_mm", "scale = -2.0", -2, 1000),
        ("force", "force_N", "", 1, 1),
        ("force", "force_kN", "", 1000, 1),
        ("force", "force_MN", "", 1e6, 1),
        ("force", "force_kip", "", 4448.2216152605, 1),
        ("force", "force_lb", "unit = 'kip', scale = 1e-3", 4.4482216152605, 1),
        ("force", "load", "column = 'load', unit = 'kN'", 1000, 1),
        ("force", "load_kN", "column = 'LOAD_KN'", 1000, 1),
    ],
)
def test_units_of_labels_and_keys(through_executable, tmp_path, *, drive, label, keys,
                                  numerator, denominator):  # fmt: skip
    values = np.array([0.0, 1.5, -97.854, 0.1])
    lines = "".join(f"7,{float(v)!r}\n" for v in values)
    (tmp_path / "test.csv").write_text(f"other,{label}\n{lines}")
    read = through_executable("test.csv", drive, keys)
    np.testing.assert_allclose(read, values * numerator / denominator, rtol=4e-16)


@pytest.mark.parametrize(
    "header",
    [
        "displacement (mm),force (kN)",
        "displacement [mm],force [kN]",
        "displacement mm,force kN",
        "displacement/mm,force/kN",
        "displacement-mm,force-kN",
    ],
)
def test_units_in_another_notation_are_not_taken_for_si_in_silence(complaint, tmp_path, header):
    """A displacement in mm read as metres is wrong by 1000 and nobody is told."""
    (tmp_path / "test.csv").write_text(csv_text(header))
    try:
        test = rbsdem.peer.read_peer(tmp_path / "test.csv")
    except rbsdem.InputError:
        assert "mm" in complaint("test.csv")
    else:
        assert np.array_equal(test.displacement, EXPECTED[0])
        assert np.array_equal(test.force, EXPECTED[1])


@pytest.mark.parametrize("label", ["time_ms", "time (ms)", "time_min", "t_ms"])
def test_unit_of_the_time_is_not_taken_for_seconds_in_silence(
    run_cli, dynamic_text, tmp_path, read_csv, label
):
    (tmp_path / "g.csv").write_text(f"{label},acceleration_g\n0,0.1\n20,0.2\n40,0.1\n")
    text = dynamic_text(
        loading="drive = 'ground_acceleration', file = 'g.csv'", output="every = 1000000"
    )
    (tmp_path / "case.nml").write_text(text)
    result = run_cli(["run", "case.nml", "-q"], tmp_path)
    if result.returncode == 2:
        assert "time" in result.stderr or "interval" in result.stderr
    else:
        last = read_csv(tmp_path / "case.csv")["time_s"][-1]
        assert last == pytest.approx(40 * (60.0 if "min" in label else 1e-3))


def test_ground_motion_with_time_and_with_interval(run_cli, dynamic_text, tmp_path, read_csv):
    """Labels t, time, time_s; or one column and the time from row to row."""
    values = [0.0, 0.25, -0.5, 0.125, 0.0]
    times = [k / 64 for k in range(5)]
    files = {
        "t,acceleration_g": "",
        "time,acceleration_g": "",
        "time_s,ground_g": "",
        "acceleration_g,time_s": "",
        "clock,acceleration_g": "time_column = 'clock'",
        "acceleration_g,clock": "time_column = '2'",
        "acceleration_g": "interval = 0.015625",
        "": "column = '1', interval = 0.015625, unit = 'g'",
        "t,other,ground": "column = 'ground', unit = 'g'",
    }
    results = []
    for header, keys in files.items():
        names = header.split(",")
        lines = [header] if header else []
        for t, v in zip(times, values, strict=True):
            cells = {"t": t, "time": t, "time_s": t, "clock": t, "other": 99}
            lines.append(",".join(repr(cells.get(name, v)) for name in names))
        (tmp_path / "g.csv").write_text("\n".join(lines))
        loading = f"drive = 'ground_acceleration', file = 'g.csv', {keys}"
        (tmp_path / "case.nml").write_text(dynamic_text(loading=loading))
        result = run_cli(["run", "case.nml", "-q"], tmp_path)
        assert (result.returncode, result.stderr) == (0, ""), header
        results.append((tmp_path / "case.csv").read_text())
    assert len(set(results)) == 1
    rows = read_csv(tmp_path / "case.csv")
    assert np.array_equal(rows["time_s"], times)
    assert np.max(np.abs(rows["displacement_m"])) > 1e-6


BAD_CSV = [
    ("displacement,force\nNaN,1\n", ["line 2, value 1", "'NaN'", "finite"]),
    ("displacement,force\n1,nan\n", ["line 2, value 2", "'nan'", "finite"]),
    ("displacement,force\n1,2\n3,inf\n", ["line 3, value 2", "'inf'", "finite"]),
    ("displacement,force\n-Infinity,2\n", ["line 2, value 1", "'-Infinity'", "finite"]),
    ("displacement,force\n1e999,2\n", ["line 2, value 1", "'1e999'", "finite"]),
    ("displacement,force\n1,-1d400\n", ["line 2, value 2", "'-1d400'", "finite"]),
    ("displacement,force\n1e99999999999,2\n", ["line 2, value 1", "finite"]),
    ("displacement,force\n1,2\n3\n", ["line 3", "1 value", "have 2"]),
    ("displacement,force\n1,2\n3,4,5\n", ["line 3", "3 values", "have 2"]),
    ("displacement,force\n1,2\n3,\n", ["line 3, value 2", "is empty"]),
    ("displacement,force\n1,2\n,4\n", ["line 3, value 1", "is empty"]),
    ("displacement,force\n1,2,\n", ["line 2, value 3", "is empty"]),
    ("displacement,force\n1,2,3\n", ["2 names of columns for 3"]),
    ("displacement,force\n1\n", ["2 names of columns for 1"]),
    ("displacement;force\n1,5;2,5\n", ["line 2, value 1", "'1,5'", "not a number"]),
    ("displacement,force\n1/2,2\n", ["line 2, value 1", "'1/2'"]),
    ("displacement,force\n3*4,2\n", ["line 2, value 1", "'3*4'"]),
    ("displacement,force\n1,2/\n", ["line 2, value 2", "'2/'"]),
    ("displacement,force\n1 2,3\n", ["line 2, value 1", "'1 2'"]),
    ("displacement,force\n1+2,3\n", ["line 2, value 1", "'1+2'"]),
    ("displacement,force\n1e,3\n", ["line 2, value 1", "'1e'"]),
    ("displacement,force\n.,3\n", ["line 2, value 1", "'.'"]),
    ("displacement,force\n-,3\n", ["line 2, value 1", "'-'"]),
    ("displacement,force\n0x1F,3\n", ["line 2, value 1", "'0x1F'"]),
    ("displacement,force\nT,3\n", ["line 2, value 1", "'T'"]),
    ("displacement,force\nabc,3\n", ["line 2, value 1", "'abc'"]),
    ("displacement,force\n1,2\nthe end,\n", ["line 3, value 1", "'the end'"]),
    ("displacement,force\n1,\x01\x02\n", ["line 2, value 2", "'??'"]),
    ("displacement,force\n1," + "9" * 5000 + "\n", ["line 2, value 2"]),
    ("displacement,force\n", ["no rows of numbers"]),
    ("displacement,force", ["no rows of numbers"]),
    ("# only a comment\n", ["no rows of numbers"]),
    ("\n \n\t\n", ["no rows of numbers"]),
    ("a,b\n1,2\n", ["no column is named after 'displacement'", "a, b"]),
    ("1,2\n3,4\n", ["no column is named after 'displacement'", "2 columns without names"]),
    ("displacement_kN,force_kN\n1,2\n", ["unit 'kN'", "displacement_kN", "m, mm, cm, in"]),
    ("displacement_furlong,force\n1,2\n", ["unit 'furlong'", "m, mm, cm, in"]),
]


@pytest.mark.parametrize(("text", "words"), BAD_CSV)
def test_bad_csv_is_named_with_line_and_value(complaint, tmp_path, text, words):
    (tmp_path / "bad.csv").write_text(text)
    said = complaint("bad.csv")
    assert said.startswith("bad.csv")
    for word in words:
        assert word in said
    assert len(said) < 300
    assert said.isprintable()


def test_file_that_is_none(complaint, tmp_path):
    assert "none.csv: cannot be opened" in complaint("none.csv")
    (tmp_path / "folder").mkdir()
    assert "folder: is a folder" in complaint("folder")
    (tmp_path / "empty.csv").write_bytes(b"")
    assert "empty.csv: is empty" in complaint("empty.csv")
    (tmp_path / "binary.csv").write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR")
    assert "binary.csv: is not a text file (it has a zero byte)" in complaint("binary.csv")
    (tmp_path / "loop.csv").symlink_to("loop.csv")
    assert "loop.csv: cannot be opened" in complaint("loop.csv")
    (tmp_path / "plain").write_text("1")
    assert "plain/x.csv: cannot be opened" in complaint("plain/x.csv")
    assert "cannot be opened" in complaint("x" * 300)


def apart(code: str, folder: Path) -> str:
    """What a line of Python prints in a process of its own, where it may crash."""
    script = (
        "import rbsdem\n"
        f"try:\n    {code}\n"
        "except rbsdem.InputError as error:\n    print('refused:', error)\n"
        "print('no crash')\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", script],
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=20,
        check=False,
    )
    assert result.returncode == 0, (result.returncode, result.stderr[-300:])
    assert result.stdout.endswith("no crash\n")
    return result.stdout


@pytest.mark.parametrize(
    "text",
    ["1\n" * 200_000, "force_N\n" + "1\n" * 200_000, "displacement_m\n1\n2\n", "n\n0\n"],
    ids=["numbers", "forces", "displacements", "an empty test"],
)
def test_file_with_a_single_column_is_no_test(tmp_path, text):
    """Rows of two bytes were more than the arrays of read_peer had been made for."""
    (tmp_path / "one.csv").write_text(text)
    assert apart("rbsdem.peer.read_peer('one.csv')", tmp_path).startswith("refused: one.csv")


def test_time_and_value_are_no_displacement_and_force(tmp_path):
    """The second of two columns must not stand for both."""
    (tmp_path / "two.csv").write_text("time,value\n0,1\n1,2\n")
    with pytest.raises(rbsdem.InputError, match=r"two\.csv"):
        rbsdem.peer.read_peer(tmp_path / "two.csv")


@pytest.mark.parametrize("kind", ["text", "path", "relative"])
def test_path_of_any_kind(tmp_path, monkeypatch, kind):
    monkeypatch.chdir(tmp_path)
    name = "ein Test.txt"
    Path(name).write_text(peer_text())
    path = {"text": str(tmp_path / name), "path": tmp_path / name, "relative": name}[kind]
    assert np.array_equal(rbsdem.peer.read_peer(path).force, EXPECTED[1])


def test_path_with_letters_beyond_ascii(through_executable, tmp_path):
    folder = tmp_path / "Säulen ½"
    folder.mkdir()
    (folder / "prüfung.txt").write_text(peer_text())
    assert np.array_equal(rbsdem.peer.read_peer(folder / "prüfung.txt").force, EXPECTED[1])
    assert np.array_equal(through_executable("Säulen ½/prüfung.txt", "force"), EXPECTED[1])
    with pytest.raises(rbsdem.InputError, match="fehlt-ü"):
        rbsdem.peer.read_peer(folder / "fehlt-ü.txt")


@pytest.mark.parametrize("path", ["''", "'a' + chr(0) + 'b'", "'x' * 5000"])
def test_path_that_can_be_none(tmp_path, path):
    """C takes a zero byte for the end of the path: another file than the one asked for."""
    (tmp_path / "a").write_text(peer_text(lines=["1\t2"] * 5000, count=5000))
    assert apart(f"rbsdem.peer.read_peer({path})", tmp_path).startswith("refused")


def test_ten_thousand_random_numbers_to_the_last_bit(through_executable, tmp_path):
    """Correct rounding of any decimal: 1 to 25 digits, exponents over the whole range."""
    rng = np.random.default_rng(7)
    words = []
    for _ in range(10_000):
        digits = "".join(map(str, rng.integers(0, 10, rng.integers(1, 26))))
        point = rng.integers(0, len(digits) + 1)
        sign = rng.choice(["", "-", "+"])
        exponent = rng.choice(["", f"e{rng.integers(-280, 270)}", f"D{rng.integers(-30, 30):+03d}"])
        words.append(f"{sign}{digits[:point]}.{digits[point:]}{exponent}")
    values = np.array([float(word.replace("D", "e")) for word in words])
    rows = [f"{word},{word}" for word in words]
    (tmp_path / "test.csv").write_text(csv_text("displacement,force", rows))
    test = rbsdem.peer.read_peer(tmp_path / "test.csv")
    assert np.array_equal(test.displacement, values)
    assert np.array_equal(test.force, values)
    # Through the executable only what a column can stand.
    kept = np.abs(values) < 1e50
    chosen = [row for row, keep in zip(rows, kept, strict=True) if keep]
    (tmp_path / "test.csv").write_text(csv_text("displacement,force", chosen))
    assert np.array_equal(through_executable("test.csv", "force"), values[kept])


def test_columns_of_the_fortran_limit(complaint, tmp_path):
    """64 columns are read, more are refused and not cut."""
    names = ["displacement", "force", *[f"c{i}" for i in range(98)]]
    for count in (3, 64, 65, 100):
        text = ",".join(names[:count]) + "\n" + ",".join(["1"] * count) + "\n"
        (tmp_path / "wide.csv").write_text(text)
        if count <= 64:
            assert rbsdem.peer.read_peer(tmp_path / "wide.csv").force[0] == 1
        else:
            assert "wide.csv" in complaint("wide.csv")


def test_long_labels_are_not_cut_to_their_neighbours(through_executable, complaint, tmp_path):
    """Labels that begin with the same 64 letters are still different ones."""
    stem = "displacement_" + "x" * 60
    (tmp_path / "long.csv").write_text(f"{stem}_a_mm,{stem}_b_mm,force\n1,2,3\n4,5,6\n")
    said = None
    try:
        read = through_executable("long.csv", "displacement", f"column = '{stem}_b_mm'")
    except AssertionError:
        said = complaint("long.csv")
        assert "long.csv" in said
    if said is None:
        assert np.array_equal(read, [0.002, 0.005])


# ---- the database --------------------------------------------------------------------------------


def numpy_reading(path: Path) -> tuple[np.ndarray, np.ndarray]:
    table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    return table[:, 0] / 1000, table[:, 1] * 1000


@pytest.fixture
def histories(peer_folder):
    """The files of the folder: those that its table names."""
    found = sorted(path for path in peer_folder.glob("*.csv") if path.name != "specimens.csv")
    with open(peer_folder / "specimens.csv", newline="", encoding="utf-8") as file:
        named = {row["file"] for row in csv.DictReader(file)} - {""}
    assert {path.name for path in found} == named
    return found


def test_all_histories_are_read_as_numpy_reads_them(histories):
    for path in histories:
        assert path.read_text().startswith("displacement_mm,force_kN\n")
        test = rbsdem.peer.read_peer(path)
        d, f = numpy_reading(path)
        assert test.name == path.name
        assert np.array_equal(test.displacement, d), path.name
        assert np.array_equal(test.force, f), path.name


def test_all_histories_are_as_long_as_their_table_says(histories, peer_folder):
    """specimens.csv gives rows and extremes of each."""
    with open(peer_folder / "specimens.csv", newline="", encoding="utf-8") as file:
        table = {row["file"]: row for row in csv.DictReader(file) if row["file"]}
    for path in histories:
        row = table.pop(path.name)
        test = rbsdem.peer.read_peer(path)
        assert test.force.size == int(row["n_points"])
        said = [float(row[key]) for key in ("d_max_mm", "d_min_mm", "F_max_kN", "F_min_kN")]
        d, f = test.displacement * 1e3, test.force / 1e3
        np.testing.assert_allclose([d.max(), d.min(), f.max(), f.min()], said, rtol=1e-4, atol=5e-4)
    assert not table


def test_histories_drive_the_executable(histories, through_executable):
    """A few: all of them are read above, by the same reader in Fortran."""
    for path in histories[::27]:
        d, f = numpy_reading(path)
        assert np.array_equal(through_executable(str(path), "displacement"), d), path.name
        assert np.array_equal(through_executable(str(path), "force"), f), path.name


@pytest.mark.parametrize("stem", PRIORITY)
def test_original_file_equals_the_csv_to_the_last_bit(through_executable, peer_folder, stem):
    raw = peer_folder / "raw" / f"{PRIORITY[stem]}.txt"
    d, f = numpy_reading(peer_folder / f"{stem}.csv")
    lines = raw.read_text().splitlines()
    test = rbsdem.peer.read_peer(raw)
    assert test.name == lines[0].strip().strip('"').strip()
    assert test.force.size == int(lines[1].split()[0])
    assert np.array_equal(test.displacement, d)
    assert np.array_equal(test.force, f)
    assert np.array_equal(through_executable(os.fspath(raw), "displacement"), d)
    assert np.array_equal(through_executable(os.fspath(raw), "force"), f)


@pytest.mark.parametrize(
    ("stem", "rows", "force", "displacement"),
    [
        ("Soesianawati_et_al_1986_No1", 744, (199.59, -186.22), (97.854, -98.059)),
        ("Tanaka_and_Park_1990_No1", 593, (166.83, -167.10), (129.50, -86.073)),
        ("Tanaka_and_Park_1990_No5", 589, (385.62, -383.84), (74.305, -76.586)),
        ("Zahn_et_al_1986_No7", 491, (213.30, -196.47), (97.008, -118.18)),
    ],
)
def test_priority_test_has_the_extremes_of_its_description(
    peer_folder, stem, rows, force, displacement
):
    test = rbsdem.peer.read_peer(peer_folder / f"{stem}.csv")
    assert test.force.size == rows
    np.testing.assert_allclose(
        (test.force.max(), test.force.min()), np.array(force) * 1e3, rtol=5e-5
    )
    extremes = (test.displacement.max(), test.displacement.min())
    np.testing.assert_allclose(extremes, np.array(displacement) / 1e3, rtol=5e-5)
