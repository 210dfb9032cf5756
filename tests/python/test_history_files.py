"""History files through both doors: `rbsdem.peer.read_peer`, and a loading of the executable.

Traps of the PEER text format: README of the shared folder peer, "Original file format". Numbers are
compared to the last bit with what Python's own reading makes of the same text. What is refused
stands in `messages.txt`.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem.peer import read_peer

ELASTIC = "rule = 'elastic', k = 1e6"
PAIRS = [(0.0, 0.0), (0.1, 12.5), (-3.25, -40.125), (97.854, 199.59), (97.854, 199.59), (1e-3, 0.7)]
EXPECTED = np.array([d for d, _ in PAIRS]) / 1000, np.array([f for _, f in PAIRS]) * 1000


@pytest.fixture
def through_executable(run_cli, case_text, tmp_path, read_csv):
    """Drive an elastic column with a file: what is driven comes back row by row."""

    def read(file: str, drive: str, keys: str = "") -> np.ndarray:
        loading = f"drive = '{drive}', file = '{file}', {keys}"
        analysis = "method = 'static'"
        text = case_text(shear=ELASTIC, flexure=ELASTIC, loading=loading, analysis=analysis)
        (tmp_path / "driven.nml").write_text(text)
        result = run_cli(["run", "driven.nml", "-q", "-o", "driven.csv"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        column = {"displacement": "displacement_m", "force": "force_N"}[drive]
        return read_csv(tmp_path / "driven.csv")[column]

    return read


def peer_text(name="Test", count="6", between="\t", tail="", end="\n", number="{}") -> str:
    """A file in the database's format; `tail` stands at the end of every line."""
    rows = (number.format(d) + between + number.format(f) for d, f in PAIRS)
    return "".join(f"{line}{tail}{end}" for line in (name, count, *rows))


def csv_text(
    header="displacement_mm,force_kN", row="{},{}", end="\n", between=",", pairs=PAIRS
) -> str:
    lines = ([header] if header else []) + [row.format(d, f) for d, f in pairs]
    return "".join(f"{line}{end}" for line in lines).replace(",", between)


IN_SI = [(float(d), float(f)) for d, f in zip(*EXPECTED, strict=True)]
PEER = {
    "plain": peer_text(),
    "name in quotes": peer_text('"Test"'),
    "a tab behind name and count": peer_text("Test\t", "6\t"),
    "19 tabs on every line": peer_text(tail="\t" * 19),
    "blanks and tabs on every line": peer_text(tail=" \t \t"),
    "blanks before": peer_text("  Test", "  6", number="   {}"),
    "count tab 0": peer_text(count="6\t0"),  # came in as a pair of PEER 198 and 371
    "count tab 0 tabs": peer_text(count="6\t0\t\t"),
    "count blank 0": peer_text(count="6 0"),
    "third column, axial load": peer_text().replace("\n", "\t744.0\n").replace("\t744.0", "", 2),
    "third column and tabs": peer_text().replace("\n", "\t-744\t\t\n").replace("\t-744", "", 2),
    "windows": peer_text(end="\r\n"),
    "old mac": peer_text(end="\r"),
    "no end of line at the end": peer_text().rstrip("\n"),
    "no end of line at the end, mac": peer_text(end="\r").rstrip("\r"),
    "byte order mark": "\ufeff" + peer_text(),
    "byte order mark and quotes": "\ufeff" + peer_text('"Test"'),
    "blank lines": peer_text() + "\n\t\n \n",
    "blanks for tabs": peer_text(between="   "),
    "tabs and blanks": peer_text(between=" \t "),
    "numbers in quotes": peer_text(number='"{}"'),
    "signs": peer_text(number="{:+}"),
    "exponents": peer_text(number="{:.17e}"),
    "fortran exponents": peer_text(number="{:.17E}").replace("E", "D"),
}
CSV = {
    "plain": csv_text(),
    "semicolons": csv_text(between=";"),
    "tabs": csv_text(between="\t"),
    "blanks": csv_text(between="  "),
    "commas and blanks": csv_text(between=" , "),
    "tabs, first row 0 0 as whole numbers": csv_text(between="\t").replace("0.0", "0", 2),
    "blanks, first row 0 0 as whole numbers": csv_text(between=" ").replace("0.0", "0", 2),
    "windows": csv_text(end="\r\n"),
    "old mac": csv_text(end="\r"),
    "no end of line at the end": csv_text().rstrip("\n"),
    "byte order mark": "\ufeff" + csv_text(),
    "comments before": "# a test\n#\n   # with blanks\n" + csv_text(),
    "comments between": csv_text(row="{},{}\n# note, 1"),
    "blank lines": "\n\n" + csv_text(row="{},{}\n \n"),
    "in quotes": csv_text('"displacement_mm","force_kN"', '"{}","{}"'),
    "capitals": csv_text("DISPLACEMENT_MM,FORCE_KN"),
    "turned around": csv_text("force_kN,displacement_mm", "{1},{0}"),
    "columns between": csv_text("t,displacement_mm,x,force_kN", "1,{},2,{}"),
    "longer names": csv_text("displacement_top_mm,force_lateral_kN"),
    "units in parentheses": csv_text("displacement (mm),force (kN)"),
    "units in brackets": csv_text("displacement [mm],force [kN]"),
    "metres and newtons": csv_text("displacement_m,force_N", "{!r},{!r}", pairs=IN_SI),
    "no units: SI": csv_text("displacement,force", "{!r},{!r}", pairs=IN_SI),
    "exponents": csv_text(row="{:.17e},{:.17E}"),
    "fortran exponents": csv_text("", "{:.17e},{:.17e}").replace("e", "d"),
    "short forms": "displacement_mm,force_kN\n0,.0\n+.1,12.5\n-3.25,-40.125\n97.854,199.59\n"
    "97.854,199.59\n1.e-3,7.E-1\n",
    "many digits": "displacement_mm,force_kN\n0.0000000000000000000000000,0\n"
    "0.1000000000000000055511151231257827,12.50000\n-003.25,-40.125\n97.854,199.59\n"
    "97.854,199.59\n0.00100000000000000000000,0.7\n",
}
CSV["fortran exponents"] = "displacement_mm,force_kN\n" + CSV["fortran exponents"]
TEXTS = [("txt", kind) for kind in PEER] + [("csv", kind) for kind in CSV]


@pytest.mark.parametrize(("ending", "kind"), TEXTS)
def test_texts_of_all_kinds_hold_the_same(through_executable, tmp_path, ending, kind):
    path = tmp_path / f"test.{ending}"
    path.write_bytes((PEER if ending == "txt" else CSV)[kind].encode())
    test = read_peer(path)
    assert test.name == {"txt": "Test", "csv": "test.csv"}[ending]
    assert np.array_equal(test.displacement, EXPECTED[0])
    assert np.array_equal(test.force, EXPECTED[1])
    assert test.displacement.dtype == test.force.dtype == np.float64
    assert np.array_equal(through_executable(path.name, "displacement"), EXPECTED[0])
    named = f"format = '{ending.replace('txt', 'peer')}'"
    assert np.array_equal(through_executable(path.name, "force", named), EXPECTED[1])


@pytest.mark.parametrize(
    ("line", "name"),
    [
        ('"Zhou et al. 1987, No. 806040"\t', "Zhou et al. 1987, No. 806040"),
        ("2D16RS, 0.25, 1:3", "2D16RS, 0.25, 1:3"),
        ("104-08", "104-08"),
        ("No; semicolon", "No; semicolon"),
        ("# 7", "# 7"),
        ("Säule ½", "Säule ½"),
        ("S\udce4ule", "S\N{REPLACEMENT CHARACTER}ule"),  # no UTF-8
        ("806040 east", "806040 east"),
        ("7", "7"),
        ("nan", "nan"),
        ("x" * 200, "x" * 200),
    ],
)
def test_name_with_digits_commas_and_the_like(through_executable, tmp_path, line, name):
    (tmp_path / "test.txt").write_bytes(peer_text(line).encode("utf-8", "surrogateescape"))
    test = read_peer(tmp_path / "test.txt")
    assert test.name == name
    assert np.array_equal(test.force, EXPECTED[1])
    assert np.array_equal(through_executable("test.txt", "force"), EXPECTED[1])


@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
def test_csv_without_header_by_number_of_column_and_unit(through_executable, tmp_path, separator):
    (tmp_path / "test.csv").write_text(csv_text("", between=separator))
    d = through_executable("test.csv", "displacement", "column = '1', unit = 'mm'")
    f = through_executable("test.csv", "force", "column = '2', unit = 'kN'")
    assert np.array_equal(d, EXPECTED[0])
    assert np.array_equal(f, EXPECTED[1])


@pytest.mark.parametrize(
    ("drive", "label", "keys", "factor"),
    [
        ("displacement", "displacement_cm", "", 1 / 100),
        ("displacement", "displacement_in", "", 0.0254),
        ("displacement", "displacement_mm", "unit = 'm'", 1),
        ("displacement", "displacement_mm", "scale = -2.0", -2 / 1000),
        ("force", "force_MN", "", 1e6),
        ("force", "force_kip", "", 4448.2216152605),
        ("force", "force_lb", "unit = 'kip', scale = 1e-3", 4.4482216152605),
        ("force", "load", "column = 'load', unit = 'kN'", 1000),
        ("force", "load_kN", "column = 'LOAD_KN'", 1000),
    ],
)
def test_units_of_labels_and_keys(through_executable, tmp_path, *, drive, label, keys, factor):
    values = np.array([0.0, 1.5, -97.854, 0.1])
    lines = "".join(f"7,{float(v)!r}\n" for v in values)
    (tmp_path / "test.csv").write_text(f"other,{label}\n{lines}")
    read = through_executable("test.csv", drive, keys)
    np.testing.assert_allclose(read, values * factor, rtol=4e-16)


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


def test_what_is_no_file_is_told_by_both_doors(run_cli, case_text, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("folder").mkdir()
    Path("binary.csv").write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR")
    Path("loop.csv").symlink_to("loop.csv")
    Path("plain").write_text("1")
    wide = [",".join(["displacement", "force", *(f"c{i}" for i in range(63))]), ",".join("1" * 65)]
    Path("wide.csv").write_text("\n".join(wide))
    for path, words in {
        "folder": "is a folder",
        "binary.csv": "is not a text file (it has a zero byte)",
        "loop.csv": "cannot be opened",
        "plain/x.csv": "cannot be opened",
        "x" * 300: "cannot be opened",
        "wide.csv": "64",  # columns at the most; more are not cut
    }.items():
        Path("case.nml").write_text(case_text(loading=f"drive = 'displacement', file = '{path}'"))
        said = run_cli(["check", "case.nml"], tmp_path).stderr
        with pytest.raises(rbsdem.InputError) as error:
            read_peer(path)
        assert said == f"rbsdem: {error.value}\n"
        assert words in said
    Path("wide.csv").write_text("\n".join(line.rpartition(",")[0] for line in wide))
    assert read_peer("wide.csv").force[0] == 1


def test_paths_of_any_kind(through_executable, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "Säulen ½"
    folder.mkdir()
    (folder / "eine prüfung.txt").write_text(peer_text())
    relative = "Säulen ½/eine prüfung.txt"
    for path in (folder / "eine prüfung.txt", str(folder / "eine prüfung.txt"), relative):
        assert np.array_equal(read_peer(path).force, EXPECTED[1])
    assert np.array_equal(through_executable(relative, "force"), EXPECTED[1])
    with pytest.raises(rbsdem.InputError, match="fehlt-ü"):
        read_peer(folder / "fehlt-ü.txt")


def test_long_file_with_a_single_column_is_no_test(tmp_path):
    """Rows of two bytes were more than the arrays of read_peer had been made for."""
    (tmp_path / "one.csv").write_text("1\n" * 200_000)
    with pytest.raises(rbsdem.InputError, match=r"one\.csv"):
        read_peer(tmp_path / "one.csv")


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
    text = csv_text("displacement,force", pairs=[(word, word) for word in words])
    (tmp_path / "test.csv").write_text(text)
    test = read_peer(tmp_path / "test.csv")
    assert np.array_equal(test.displacement, values)
    assert np.array_equal(test.force, values)
    # Through the executable only what a column can stand.
    kept = np.abs(values) < 1e50
    chosen = [(word, word) for word, keep in zip(words, kept, strict=True) if keep]
    (tmp_path / "test.csv").write_text(csv_text("displacement,force", pairs=chosen))
    assert np.array_equal(through_executable("test.csv", "force"), values[kept])


def numpy_reading(path: Path) -> tuple[np.ndarray, np.ndarray]:
    table = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    return table[:, 0] / 1000, table[:, 1] * 1000


def test_histories_of_the_database(peer_folder, through_executable):
    """Every third is read as numpy reads it, and has the rows and extremes of `specimens.csv`.

    A few drive the executable: it is the same reader.
    """
    with open(peer_folder / "specimens.csv", newline="", encoding="utf-8") as file:
        table = {row["file"]: row for row in csv.DictReader(file) if row["file"]}
    found = {path.name for path in peer_folder.glob("*.csv")} - {"specimens.csv"}
    assert found == set(table)
    for number, (name, row) in list(enumerate(table.items()))[::3]:
        path = peer_folder / name
        test = read_peer(path)
        d, f = numpy_reading(path)
        assert test.name == name
        assert np.array_equal(test.displacement, d), name
        assert np.array_equal(test.force, f), name
        assert f.size == int(row["n_points"])
        said = [float(row[key]) / 1e3 for key in ("d_max_mm", "d_min_mm")]
        said += [float(row[key]) * 1e3 for key in ("F_max_kN", "F_min_kN")]
        np.testing.assert_allclose([d.max(), d.min()], said[:2], rtol=1e-4, atol=5e-7)
        np.testing.assert_allclose([f.max(), f.min()], said[2:], rtol=1e-4, atol=0.5)
        if number % 27 == 0:
            assert np.array_equal(through_executable(str(path), "displacement"), d), name
            assert np.array_equal(through_executable(str(path), "force"), f), name
