"""The executable: arguments, exit codes, what is printed, output files, progress, limits, signals.

What is written is whole, and nothing else is touched. What is refused stands in `messages.txt`.
"""

from __future__ import annotations

import json
import os
import pty
import re
import resource
import select
import signal
import stat
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import __main__ as python_command
from rbsdem.springs import Bilinear, Takeda

BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
COLUMN = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA)
ELASTIC = "rule = 'elastic', k = 7e8"
WEAK = "rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 0"
CAPACITY = 7.0387e8 * 1.296e-4  # of the weak spring

# Silence of a run before its progress is shown, and from line to line, with some to spare [s].
SHOWN_AFTER, AGAIN_AFTER = 1.2, 0.4

PATIENCE = 60.0  # seconds after which a run hangs

FATAL_WORDS = ("Fortran runtime", "Backtrace", "backtrace", "SIG", "At line", "Traceback")


def write(folder: Path, text: str, name: str = "case.nml") -> Path:
    path = folder / name
    path.write_bytes(text.encode())
    return path


def faults(result: subprocess.CompletedProcess[str], code: int = 2) -> str:
    """Text of a failure: the code, silence on stdout, the program's name before every line."""
    assert result.returncode == code, result
    assert result.stdout == ""
    assert result.stderr.endswith("\n")
    for line in result.stderr.splitlines():
        assert line.startswith("rbsdem: "), result.stderr
    assert not any(word in result.stderr for word in FATAL_WORDS)
    return result.stderr


def quick(run_cli, folder: Path, *arguments: str | Path) -> None:
    """Run without a word."""
    result = run_cli([*arguments, "-q"], folder)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


@pytest.fixture
def folder(case_text, tmp_path) -> Path:
    """A folder with a case."""
    write(tmp_path, case_text())
    return tmp_path


@pytest.fixture
def good(run_cli, folder) -> bytes:
    """The rows of the case."""
    quick(run_cli, folder, "run", "case.nml", "-o", "good.csv")
    rows = (folder / "good.csv").read_bytes()
    (folder / "good.csv").unlink()
    return rows


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("--help", "rbsdem run|rbsdem check|rbsdem modes|--output|--quiet|--version"),
        ("--help", "\n  0  all went|\n  1  the analysis|\n  2  the input|\n  3  the column"),
        ("--help", f"rbsdem {rbsdem.__version__}"),
        ("--version", f"rbsdem {rbsdem.__version__}\n"),
        ("run --help", "usage: rbsdem run |--output"),
        ("check --help", "usage: rbsdem check |--quiet"),
        ("modes --help", "usage: rbsdem modes |rk4"),
        ("keys --help", "usage: rbsdem keys |--json"),
        ("check case.nml", "case.nml: no errors\n"),
        ("modes case.nml", "mode,frequency_Hz,period_s,omega_rad/s\n|# stable step"),
        ("keys &Column", "&column\n|height "),
        ("keys Takeda", "rule = 'takeda'|k_c |inner "),
        ("keys column", "&column\n|height "),
    ],
)
def test_what_a_command_prints(run_cli, folder, arguments, words):
    shown = run_cli(arguments.split(), folder)
    assert (shown.returncode, shown.stderr) == (0, "")
    assert all(word in shown.stdout for word in words.split("|"))
    assert os.listdir(folder) == ["case.nml"]
    if arguments.endswith("--help"):
        assert max(len(line) for line in shown.stdout.splitlines()) <= 84
        turned = [word.replace("--help", "-h") for word in reversed(arguments.split())]
        assert run_cli(turned, folder).stdout == shown.stdout
        command = arguments.split()[0]
        others = {"run", "check", "modes", "keys", "trade", "peer"} - {command}
        assert (command == "--help") == any(f"rbsdem {one}" in shown.stdout for one in others)
    elif arguments == "keys takeda":
        assert shown.stdout in run_cli(["keys"], folder).stdout


@pytest.mark.parametrize("command", ["trade", "peer", "ensemble"])
def test_help_of_a_command_of_the_package(command, monkeypatch, capsys):
    for words in ([command, "--help"], ["--help", command]):
        monkeypatch.setattr(sys, "argv", ["rbsdem", *words])
        assert python_command.main() == 0
        assert capsys.readouterr().out.startswith(f"Usage: rbsdem {command} ")


def test_console_command_hands_over_to_the_executable(folder):
    """`python -m rbsdem` and the script `rbsdem` pass arguments, output and exit code on."""
    for command in ([sys.executable, "-m", "rbsdem"], [Path(sys.executable).with_name("rbsdem")]):
        for word, code in (("check", 0), ("chek", 2)):
            done = subprocess.run(
                [*command, word, "case.nml"], cwd=folder, capture_output=True, text=True,
                timeout=20, check=False,
            )  # fmt: skip
            assert done.returncode == code
            assert ("case.nml: no errors\n" if code == 0 else "") == done.stdout
            assert ("did you mean 'check'" in done.stderr) == (code == 2)


def test_groups_in_comments_and_texts_are_none(tmp_path):
    for text, fits in (
        ("&frame storeys = 3.0 /\n! &target and mass = 'from_loads'\n", True),
        ("&case title = 'with &target' /\n&frame /\n", True),
        ("&frame mass = 'from_loads' /\n", False),
        ("&case title = 'it''s ! a house' /\n&assess code = 'asce_41' /\n", False),
    ):
        path = str(write(tmp_path, text))
        words = [] if fits else ["run", path, "-o", "rows.csv"]
        assert python_command.for_python(["-o", "rows.csv", "run", path]) == words, text


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "case.nml", "--output", "o.csv", "--quiet"],
        ["run", "case.nml", "-o", "o.csv", "-q"],
        ["--quiet", "--output=o.csv", "run", "case.nml"],
        ["-q", "run", "-o=o.csv", "case.nml"],
    ],
)
def test_options_in_any_place_and_spelling(run_cli, folder, arguments):
    quick(run_cli, folder, *arguments)
    assert sorted(os.listdir(folder)) == ["case.nml", "o.csv"]


def test_what_is_too_large_is_refused(run_cli, tmp_path):
    assert "is not known" in faults(run_cli(["x" * 100_000]))
    write(tmp_path, "&column /\n" * 50_000)
    text = faults(run_cli(["check", "case.nml"], tmp_path))
    assert "line 2: &column appears twice" in text
    assert len(text.splitlines()) <= 25
    with (tmp_path / "case.nml").open("wb") as file:
        file.truncate(120_000_000)
    text = faults(run_cli(["check", "case.nml"], tmp_path))
    assert re.search(r"case.nml.* 1.2e\+08 bytes.*100000000", text)


def figures_of(run_cli, folder: Path) -> dict[str, str]:
    result = run_cli(["run", "case.nml"], folder)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.startswith("minimal\n")
    assert re.search(r"rows in .*case.csv", result.stdout)
    return dict(re.findall(r"^  (\w+) +(\S+)$", result.stdout, re.MULTILINE))


def test_summary_of_a_run_has_the_figures_of_its_rows(run_cli, dynamic_text, folder, read_csv):
    figures = figures_of(run_cli, folder)
    rows = read_csv(folder / "case.csv")
    assert int(figures["rows"]) == rows["step"].size == 33
    assert float(figures["peak_displacement_m"]) == pytest.approx(0.016, rel=1e-5)
    peak = rows["force_N"][np.argmax(np.abs(rows["force_N"]))]
    assert float(figures["peak_force_N"]) == pytest.approx(peak, rel=1e-5)
    assert float(figures["input_energy_J"]) == pytest.approx(rows["input_J"][-1], rel=1e-5)
    assert "stable_step_s" not in figures  # no figure of a static path
    # In time: peaks of all steps, whatever rows are kept; the step chosen is a part of the limit.
    write(folder, dynamic_text(output="every = 1"))
    figures_of(run_cli, folder)
    peak = np.max(np.abs(read_csv(folder / "case.csv")["displacement_m"]))
    write(folder, dynamic_text(output="every = 1000000"))
    figures = figures_of(run_cli, folder)
    assert abs(float(figures["peak_displacement_m"])) == pytest.approx(peak, rel=1e-5)
    limit = rbsdem.modes(COLUMN).stable_step
    assert float(figures["stable_step_s"]) == pytest.approx(limit, rel=1e-5)
    assert 0 < float(figures["time_step_s"]) <= 0.2 * limit * (1 + 1e-5)


def test_ground_that_no_earthquake_moves_is_told(run_cli, tmp_path):
    """As the package tells it (test_measures_of_frames.py); the bound is 49.03 m/s2."""
    case = write(
        tmp_path,
        "&column n = 1, height = 2.0, masses = 900.0 /\n&flexure rule = 'elastic', k = 4e7 /\n"
        "&shear rule = 'elastic', k = 3e8 /\n&loading drive = 'ground_acceleration', "
        "time = 0, 0.01, 0.02, values = 0, 49.1, 0 /\n&analysis method = 'rk4' /\n",
    )
    told = "note: the ground: its peak is 5.00681 g; no ground has moved with more than 5 g"
    assert told in run_cli(["run", case], tmp_path).stdout
    case.write_text(case.read_text().replace("49.1", "49.0"))
    assert "5 g" not in run_cli(["run", case, "-o", "b.csv"], tmp_path).stdout


def test_csv_says_version_case_units_and_is_read_by_numpy(run_cli, case_text, tmp_path):
    write(tmp_path, case_text(case="title = 'Säule, \"Nr 1\"; half'"))
    quick(run_cli, tmp_path, "run", "case.nml")
    path = tmp_path / "case.csv"
    text = path.read_text("utf-8")
    assert text.endswith("\n")
    assert "\r" not in text
    head = text.splitlines()[:4]
    assert head[:2] == [f"# rbsdem {rbsdem.__version__}", '# case: Säule, "Nr 1"; half']
    assert re.search("SI.*static.*small", head[2])
    names = head[3].split(",")
    assert names[:3] == ["step", "displacement_m", "force_N"]
    assert all(re.search(r"_(m|N|J|rad|Nm)$", name) for name in names[1:])
    table = np.loadtxt(path, delimiter=",", skiprows=4)
    named = np.genfromtxt(path, delimiter=",", names=True, skip_header=3)
    assert named.dtype.names == tuple(names)
    assert np.array_equal(named["force_N"], table[:, 2])


def test_modes_and_matrices_equal_those_of_python_to_the_last_digit(run_cli, case_text, tmp_path):
    write(tmp_path, case_text(column="n = 4, height = 1.6, mass = 614.4", loading=None))
    column = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=4)
    for count, options in ((8, []), (3, ["--count", "3", "--matrices"])):
        lines = run_cli(["modes", "case.nml", *options], tmp_path).stdout.splitlines()
        modes = rbsdem.modes(column, count=count)
        table = np.array([[float(word) for word in row.split(",")] for row in lines[1 : 1 + count]])
        assert np.array_equal(table[:, 0], np.arange(1, count + 1))
        assert np.array_equal(table[:, 1], modes.frequency)
        np.testing.assert_allclose(table[:, 2] * table[:, 1], 1.0, rtol=1e-15)
        assert np.array_equal(table[:, 3], modes.omega)
        assert lines[1 + count].startswith("# stable step")
        assert float(lines[1 + count].rpartition(":")[2]) == modes.stable_step
    matrices = rbsdem.matrices(column)
    for k, name in enumerate(("mass", "stiffness", "geometric", "damping")):
        head, *rows = (line.split(",") for line in lines[5 + 9 * k : 14 + 9 * k])
        assert head == [name, *matrices.unknowns]
        assert [row[0] for row in rows] == list(matrices.unknowns)
        np.testing.assert_array_equal(
            np.array([row[1:] for row in rows], float), getattr(matrices, name)
        )


LAYOUTS = {
    "windows": lambda t: t.replace("\n", "\r\n"),
    "old mac": lambda t: t.replace("\n", "\r"),
    "no newline at the end": lambda t: t.rstrip("\n"),
    "byte order mark": lambda t: "\ufeff" + t,
    "tabs": lambda t: t.replace(" ", "\t"),
    "one line": lambda t: t.replace("\n", " "),
    "a line for each entry": lambda t: re.sub(r", (?=\w+ =)", ",\n   ", t),
    "no commas": lambda t: re.sub(r", (?=\w+ =)", "  ", t),
    "no blanks": lambda t: t.replace(" = ", "="),
    "capitals": lambda t: re.sub(
        r"&\w+ |\w+ =", lambda word: word.group().upper(), t, flags=re.ASCII
    ),
    "double quotes": lambda t: t.replace("'", '"'),
    "exponents with d": lambda t: re.sub(r"(\d)e(-?\d)", r"\1D\2", t),
    "comments": lambda t: "! it's a \"case\n" + t.replace("/\n", "/ ! end & 'so\n! k = 3 /\n"),
    "blank lines": lambda t: "\n \n" + t.replace("\n", "\n\n\t\n"),
    "comma at the end": lambda t: t.replace(" /", ", /"),
    "subscripts": lambda t: t.replace(
        "amplitudes = 0.005, 0.01", "amplitudes(1) = 0.005, amplitudes( 2 ) = 0.01"
    ),
    "repeat counts": lambda t: t.replace("0.005, 0.01", "1*0.005, 0.01, cycles = 2*1"),
    "defaults said": lambda t: (
        t.replace("height", "n = 1, kinematics = 'small', axial_load = 0, height")
        + "&damping mass = 0, tangent = F / &analysis method = 'static' /\n"
        + "&output every = +1 /"
    ),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layout_of_the_case_file_does_not_matter(run_cli, case_text, folder, good, layout):
    write(folder, LAYOUTS[layout](case_text()))
    quick(run_cli, folder, "run", "case.nml")
    assert (folder / "case.csv").read_bytes() == good


def test_quote_within_a_text_is_doubled_or_of_the_other_kind(run_cli, case_text, tmp_path):
    """Fortran 2008, 4.4.3: a doubled delimiter within a text stands for one."""
    for title in ("'it''s /&= 1'", '"it\'s /&= 1"'):
        write(tmp_path, case_text(case=f"title = {title}"))
        quick(run_cli, tmp_path, "run", "case.nml")
        assert (tmp_path / "case.csv").read_text("utf-8").splitlines()[1] == "# case: it's /&= 1"


def rows_of(run_cli, read_csv, folder: Path, text: str) -> dict[str, np.ndarray]:
    write(folder, text)
    quick(run_cli, folder, "run", "case.nml")
    return read_csv(folder / "case.csv")


@pytest.mark.parametrize("kind", ["static", "in time"])
def test_every_keeps_each_nth_row_and_the_last(run_cli, case_text, dynamic_text, tmp_path, *,
                                               read_csv, kind):  # fmt: skip
    """Of a path its points; in time the steps, in place of the times of the loading."""
    text = case_text if kind == "static" else dynamic_text
    whole = rows_of(run_cli, read_csv, tmp_path, text(output="every = 1"))
    size = whole["displacement_m"].size
    usual = rows_of(run_cli, read_csv, tmp_path, text())
    if kind == "static":
        assert usual["step"].size == size
    else:
        assert np.array_equal(usual["time_s"], np.arange(17) * 0.00625)
        assert set(usual["time_s"]) <= set(whole["time_s"])
        limit = rbsdem.modes(COLUMN).stable_step
        assert np.max(np.diff(whole["time_s"])) <= 0.2 * limit * (1 + 1e-12)
    for every in (2, 7, size - 1, size, 999_999_999):
        rows = rows_of(run_cli, read_csv, tmp_path, text(output=f"every = {every}"))
        kept = sorted({*range(0, size, every), size - 1})
        for name, values in whole.items():
            assert np.array_equal(rows[name], values[kept]), (every, name)


def test_times_that_are_equal_but_for_round_off_make_no_extra_rows(
    run_cli, dynamic_text, tmp_path, read_csv
):
    """0.1 * 3 is not 0.3 in binary: one file has a time column, the other an interval."""
    times = [f"{k / 10}" for k in range(11)]
    (tmp_path / "f.csv").write_text("time_s,force_N\n" + "".join(f"{t},1\n" for t in times))
    (tmp_path / "g.csv").write_text("acceleration_g\n" + "0.1\n" * 11)
    loading = [
        "drive = 'force', file = 'f.csv'",
        "drive = 'ground_acceleration', file = 'g.csv', interval = 0.1",
    ]  # fmt: skip
    rows = rows_of(run_cli, read_csv, tmp_path, dynamic_text(loading=loading))
    np.testing.assert_allclose(rows["time_s"], [float(t) for t in times], rtol=1e-12)


def test_relative_history_is_looked_up_beside_the_case(run_cli, case_text, tmp_path, read_csv):
    folder = tmp_path / "cases" / "data"
    folder.mkdir(parents=True)
    (folder / "h.csv").write_text("displacement_mm,force_kN\n0,0\n10,1\n-5,2\n")
    (tmp_path / "h.csv").write_text("displacement_mm,force_kN\n0,0\n99,1\n")
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    for file, cwd in (
        ("data/h.csv", tmp_path),
        ("data/h.csv", elsewhere),
        ("../cases/data/h.csv", elsewhere),
        (str(folder / "h.csv"), elsewhere),
    ):
        write(tmp_path / "cases", case_text(loading=f"drive = 'displacement', file = '{file}'"))
        case = os.path.relpath(tmp_path / "cases" / "case.nml", cwd)
        assert run_cli(["run", case, "-q"], cwd).returncode == 0
        rows = read_csv(tmp_path / "cases" / "case.csv")
        assert np.array_equal(rows["displacement_m"], [0, 0.01, -0.005])
        (tmp_path / "cases" / "case.csv").unlink()


def test_case_behind_a_symbolic_link_finds_its_history(run_cli, case_text, tmp_path, read_csv):
    """Beside the link, as every program of the shell does."""
    (tmp_path / "real").mkdir()
    (tmp_path / "link").mkdir()
    write(tmp_path / "real", case_text(loading="drive = 'displacement', file = 'h.csv'"))
    (tmp_path / "link" / "h.csv").write_text("displacement_mm,force_kN\n0,0\n10,1\n")
    (tmp_path / "link" / "case.nml").symlink_to(tmp_path / "real" / "case.nml")
    assert run_cli(["run", "link/case.nml", "-q"], tmp_path).returncode == 0
    rows = read_csv(tmp_path / "link" / "case.csv")
    assert np.array_equal(rows["displacement_m"], [0, 0.01])
    (tmp_path / "folder").symlink_to(tmp_path / "link")
    assert run_cli(["check", "folder/case.nml"], tmp_path).returncode == 0


def test_output_is_named_after_the_case_beside_it(run_cli, case_text, tmp_path):
    folder = tmp_path / "Säule 1.d"
    folder.mkdir()
    names = (
        ("a.b.nml", "a.b.csv"),
        ("plain", "plain.csv"),
        (".x", ".x.csv"),
        ("ü 1.nml", "ü 1.csv"),
    )
    for name, output in names:
        write(folder, case_text(), name)
        result = run_cli(["run", f"Säule 1.d/{name}"], tmp_path)
        assert f"Säule 1.d/{output}" in result.stdout
        assert (folder / output).is_file()
    assert os.listdir(tmp_path) == ["Säule 1.d"]


def test_output_of_the_case_is_relative_to_the_case_and_the_option_to_the_shell(
    run_cli, case_text, tmp_path
):
    folder = tmp_path / "sub"
    folder.mkdir()
    write(folder, case_text(output="file = 'mine.csv'"))
    assert run_cli(["run", "sub/case.nml", "-q"], tmp_path).returncode == 0
    assert sorted(os.listdir(folder)) == ["case.nml", "mine.csv"]
    assert run_cli(["run", "sub/case.nml", "-q", "-o", "other.csv"], tmp_path).returncode == 0
    assert sorted(os.listdir(tmp_path)) == ["other.csv", "sub"]
    assert sorted(os.listdir(folder)) == ["case.nml", "mine.csv"]
    absolute = tmp_path / "absolute.csv"
    write(folder, case_text(output=f"file = '{absolute}'"))
    assert run_cli(["run", "sub/case.nml", "-q"], tmp_path).returncode == 0
    assert absolute.read_bytes() == (tmp_path / "other.csv").read_bytes()


@pytest.mark.parametrize("output", [None, "history.csv", "./history.csv", "HERE/history.csv"])
def test_output_never_replaces_an_input(run_cli, case_text, tmp_path, output):
    """history.nml on history.csv: its default output would be the file that drives it."""
    (tmp_path / "history.csv").write_text("displacement_mm,force_kN\n0,0\n10,1\n")
    text = case_text(loading="drive = 'displacement', file = 'history.csv'")
    write(tmp_path, text, "history.nml")
    write(tmp_path, text, "case.csv")
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    option = ["--output", output.replace("HERE", str(tmp_path))] if output else []
    own = ["--output", "case.csv"] if output else []
    for arguments in (["history.nml", *option], ["case.csv", *own]):
        text = faults(run_cli(["run", *arguments], tmp_path))
        assert "is an input of the case and would be written over" in text
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_no_file_of_the_user_is_written_over_unasked(run_cli, folder, good):
    """The name that a case gives its rows may be that of a measurement; a state may be the case."""
    rows, case = folder / "case.csv", folder / "case.nml"
    rows.write_text("displacement,force\n1,2\n")
    text = faults(run_cli(["run", "case.nml"], folder))
    assert "case.csv is there and has no rows of rbsdem" in text
    assert rows.read_text() == "displacement,force\n1,2\n"
    # Asked for, it is; and rows of an earlier run are replaced.
    assert run_cli(["run", "case.nml", "--output", "case.csv"], folder).returncode == 0
    assert run_cli(["run", "case.nml"], folder).returncode == 0
    assert rows.read_bytes() == good
    before = case.read_text()
    for state in ("case.nml", "./case.csv"):
        given = before + f"&output state = '{state}' /\n"
        case.write_text(given)
        assert "its file of rows; choose another" in faults(run_cli(["run", "case.nml"], folder))
        assert case.read_text() == given
    assert rows.read_bytes() == good


def test_force_beyond_the_capacity_keeps_the_path_and_the_old_output(
    run_cli, case_text, tmp_path, read_csv
):
    """Static path: the force reached is said, also with --quiet; the path up to there is kept."""
    loading = f"drive = 'force', amplitudes = {CAPACITY / 2!r}, {2 * CAPACITY!r}, points = 4"
    overloaded = case_text(shear=WEAK, loading=loading)
    write(tmp_path, overloaded)
    (tmp_path / "out.csv").write_text("old")
    assert run_cli(["check", "case.nml"], tmp_path).returncode == 0
    text = faults(run_cli(["run", "case.nml", "-q", "-o", "out.csv"], tmp_path), code=1)
    assert (tmp_path / "out.csv").read_text() == "old"
    assert f"the lateral force {1.5 * CAPACITY:.6g} N is beyond the capacity" in text
    assert "shear spring of joint 1" in text
    assert re.search(rf"at force {CAPACITY:.6g} N, displacement \S+ m", text)
    assert "drive the column by displacement" in text
    rows = read_csv(tmp_path / "out.csv.partial")
    assert f"the {rows['step'].size} rows up to there are in out.csv.partial" in text
    # A cycle to half the capacity in 16 parts, then quarters of twice of it: the second is the end.
    expected = np.concatenate(
        [np.interp(np.arange(17), [0, 4, 12, 16], [0, 0.5, -0.5, 0]), [0.5, 1.0, 1.0]]
    )
    np.testing.assert_allclose(rows["force_N"], expected * CAPACITY, rtol=1e-12, atol=1e-6)
    # Done right, the whole is there and no partial is left.
    write(tmp_path, overloaded.replace("k_post = 0", "k_post = 1e6"))
    quick(run_cli, tmp_path, "run", "case.nml", "-o", "out.csv")
    assert read_csv(tmp_path / "out.csv")["step"].size == 33
    assert sorted(os.listdir(tmp_path)) == ["case.nml", "out.csv"]


@pytest.mark.parametrize("link", [False, True])
def test_file_or_link_with_the_ending_partial_is_left_alone(run_cli, folder, good, link):
    """Neither replaced nor followed, whether the run succeeds or not."""
    there = folder / "out.csv.partial"
    (folder / "precious").write_text("precious")
    if link:
        there.symlink_to("precious")
    else:
        there.write_text("precious")
    assert run_cli(["run", "case.nml", "-q", "-o", "out.csv"], folder).returncode == 0
    assert (folder / "out.csv").read_bytes() == good
    assert there.read_text() == (folder / "precious").read_text() == "precious"
    assert there.is_symlink() == link


@pytest.mark.parametrize("kind", ["file", "link", "folder", "earlier rows"])
def test_failed_run_keeps_its_rows_beside_what_is_there(run_cli, case_text, folder, kind):
    """As OUT.partial if that is free or was left by an earlier run, else under its own name."""
    loading = "drive = 'force', amplitudes = 1e5, points = 4"
    (folder / "case.nml").write_text(case_text(shear=WEAK, loading=loading))
    there = folder / "out.csv.partial"
    if kind == "folder":
        there.mkdir()
    elif kind == "link":
        (folder / "precious").write_text("# rbsdem is mine")
        there.symlink_to("precious")
    else:
        there.write_text("# rbsdem 0\n" if kind == "earlier rows" else "precious")
    text = faults(run_cli(["run", "case.nml", "-o", "out.csv"], folder), 1)
    name = text.rstrip().rsplit(" ", 1)[1]
    assert (name == "out.csv.partial") == (kind == "earlier rows")
    assert (folder / name).read_bytes().count(b"\n") > 4
    if kind == "file":
        assert there.read_text() == "precious"
    elif kind == "link":
        assert there.is_symlink()
        assert there.read_text() == "# rbsdem is mine"
    assert not (folder / "out.csv").exists()


def test_long_name_is_no_obstacle(run_cli, folder, good):
    """The temporary name is not longer than a disk takes."""
    name = "x" * 251 + ".csv"
    assert run_cli(["run", "case.nml", "-q", "-o", name], folder).returncode == 0
    assert (folder / name).read_bytes() == good


@pytest.mark.parametrize("target", ["/dev/full", "/dev/null", "fifo"])
def test_output_that_is_no_regular_file_is_not_replaced_by_one(run_cli, folder, good, target):
    """A rename onto /dev/null or a pipe would take it away from everyone."""
    path = folder / "special"
    if target == "fifo":
        os.mkfifo(path)
    else:
        path.symlink_to(target)  # not the device itself: the root user could lose it
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        result = run_cli(["run", "case.nml", "--output", "special"], folder)
        assert not stat.S_ISREG(path.stat().st_mode)
        assert path.is_symlink() == (target != "fifo")
        assert sorted(os.listdir(folder)) == ["case.nml", "special"]
        if result.returncode == 0:
            assert target != "/dev/full"
            if target == "fifo":
                assert os.read(reader, 1_000_000) == good
        else:
            assert "special" in faults(result, code=result.returncode)
    finally:
        os.close(reader)


def test_modes_that_cannot_be_printed_are_no_success(run_cli, folder):
    """`rbsdem modes case.nml >file` on a full disk must not exit 0."""
    with open("/dev/full", "w") as full:
        result = run_cli(["modes", "case.nml"], folder, stdout=full, stderr=subprocess.PIPE)
    assert result.returncode == 1
    assert result.stderr.startswith("rbsdem: ")
    assert not any(word in result.stderr for word in FATAL_WORDS)


@pytest.mark.parametrize("closed", [0, 1, 2])
def test_closed_standard_streams_do_no_harm_to_the_csv(run_cli, folder, good, closed):
    process = run_cli(["run", "case.nml"], folder, preexec_fn=lambda: os.close(closed))
    assert process.returncode in (0, 1)
    if process.returncode == 0:
        assert (folder / "case.csv").read_bytes() == good


@pytest.mark.parametrize("points", [20, 20_000])
def test_limit_of_file_sizes_is_told_and_the_old_output_stays(run_cli, case_text, folder, points):
    """Few rows fail when the file is closed, many on the way; as on a full disk."""
    loading = f"drive = 'displacement', amplitudes = 0.01, points = {points}"
    (folder / "case.nml").write_text(case_text(loading=loading))
    (folder / "out.csv").write_text("old")
    result = run_cli(
        ["run", "case.nml", "--output", "out.csv"],
        folder,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
    )
    text = faults(result, 1)
    assert "cannot write all of out.csv" in text
    assert "limit" in text
    assert sorted(os.listdir(folder)) == ["case.nml", "out.csv"]
    assert (folder / "out.csv").read_text() == "old"


@pytest.mark.parametrize("points", [1, 20_000])
@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_full_disk_is_told(run_cli, case_text, dynamic_text, folder, points, kind):
    loading = f"drive = 'displacement', amplitudes = 0.01, points = {points}"
    text = case_text(loading=loading)
    if kind == "dynamic":
        text = dynamic_text(loading=loading.replace("displacement", "force") + ", period = 1.0")
    (folder / "case.nml").write_text(text)
    text = faults(run_cli(["run", "case.nml", "--output", "/dev/full"], folder), 1)
    assert "cannot write all of /dev/full" in text
    assert "free some space" in text


@pytest.mark.parametrize("case", ["-", "/dev/stdin"])
def test_case_from_a_pipe(executable, folder, good, case):
    text = (folder / "case.nml").read_bytes()
    command = [executable, "run", case, "-q", "-o", "out.csv"]
    subprocess.run(command, cwd=folder, input=text, check=True, timeout=PATIENCE)
    assert (folder / "out.csv").read_bytes() == good
    # Its rows have no name of their own.
    result = subprocess.run(
        [executable, "run", case], cwd=folder, input=text, capture_output=True, check=False
    )
    assert (result.returncode, result.stdout) == (2, b"")
    assert b"/dev/stdin has no name for its rows; give one with --output" in result.stderr
    assert sorted(os.listdir(folder)) == ["case.nml", "out.csv"]


def test_history_through_a_pipe_is_that_of_a_file(executable, case_text, tmp_path):
    """Longer than the buffer of a pipe, written in pieces."""
    rows = "".join(f"{1e-3 * (i % 40)!r}\n" for i in range(20_000)).encode()
    (tmp_path / "history.csv").write_bytes(b"displacement_m\n" + rows)
    os.mkfifo(tmp_path / "pipe")
    for name in ("history.csv", "pipe"):
        loading = f"drive = 'displacement', file = '{name}'"
        (tmp_path / f"{name}.nml").write_text(case_text(loading=loading))

    def feed() -> None:
        with open(tmp_path / "pipe", "wb", buffering=0) as pipe:
            pipe.write(b"displacement_m\n")
            for at in range(0, len(rows), 50_000):
                time.sleep(0.01)
                pipe.write(rows[at : at + 50_000])

    writer = threading.Thread(target=feed)
    writer.start()
    for name in ("pipe", "history.csv"):
        command = [executable, "run", f"{name}.nml", "-q", "-o", f"{name}.out"]
        subprocess.run(command, cwd=tmp_path, check=True, timeout=PATIENCE)
    writer.join()
    head, whole = ((tmp_path / f"{n}.out").read_bytes() for n in ("pipe", "history.csv"))
    assert head == whole


def test_pipe_that_nobody_writes_to_is_told(run_cli, folder):
    os.mkfifo(folder / "pipe")
    text = faults(run_cli(["run", "pipe", "-o", "out.csv"], folder), 2)
    assert "pipe: is a pipe that nobody writes to; start its writer first" in text
    closed = run_cli(["run", "-", "-o", "out.csv"], folder, stdin=subprocess.DEVNULL)
    assert "-: is empty" in faults(closed, 2)


def test_pipe_that_nobody_reads_is_told(run_cli, folder):
    os.mkfifo(folder / "pipe")
    text = faults(run_cli(["run", "case.nml", "-o", "pipe"], folder), 2)
    assert "pipe is a pipe that nobody reads" in text
    assert "--output" in text


@pytest.mark.parametrize("output", ["-", "/dev/stdout"])
@pytest.mark.parametrize("into", ["pipe", "file"])
def test_rows_on_standard_output(executable, folder, good, output, into):
    """The rows and nothing else; a file that takes standard output is not replaced."""
    command = [executable, "run", "case.nml", "-o", output]
    if into == "pipe":
        out = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, check=True).stdout
    else:
        with open(folder / "out.txt", "wb") as file:
            subprocess.run(command, cwd=folder, stdout=file, check=True)
        out = (folder / "out.txt").read_bytes()
    assert out == good


def test_rows_through_a_slow_reader_are_whole(executable, case_text, folder):
    """More than the buffer of a pipe: the writer waits and loses nothing."""
    loading = "drive = 'displacement', amplitudes = 0.01, points = 2000"
    (folder / "case.nml").write_text(case_text(loading=loading))
    subprocess.run([executable, "run", "case.nml", "-q", "-o", "f.csv"], cwd=folder, check=True)
    os.mkfifo(folder / "pipe")
    reader = os.open(folder / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    process = subprocess.Popen([executable, "run", "case.nml", "-q", "-o", "pipe"], cwd=folder)
    time.sleep(0.2)
    os.set_blocking(reader, True)
    with os.fdopen(reader, "rb") as file:
        assert file.read() == (folder / "f.csv").read_bytes()
    assert process.wait(PATIENCE) == 0


@pytest.mark.parametrize("restored", [True, False])
def test_reader_that_leaves_ends_the_program_quietly(executable, folder, restored):
    """As `rbsdem keys | head -1`: killed by SIGPIPE, also where Python ignored it before."""
    reader, writer = os.pipe()
    os.close(reader)
    process = subprocess.Popen(
        [executable, "keys"], stdout=writer, stderr=subprocess.PIPE, restore_signals=restored
    )
    os.close(writer)
    assert process.communicate(timeout=PATIENCE)[1] == b""
    assert process.returncode == -signal.SIGPIPE


ROWS = 4000


def long_case(
    dynamic_text, folder: Path, steps: int = ROWS * 1000, name="case", every=1000
) -> None:
    """An elastic column shaken for so many steps, which do not divide the loading's times.

    The tests stop it on its way, which makes it long by the clock.
    """
    (folder / "ground.csv").write_text("time_s,acceleration_g\n0,0.1\n0.3,-0.1\n1e5,0.1\n")
    text = dynamic_text(
        case=f"title = '{name}'",
        shear=ELASTIC,
        flexure=ELASTIC,
        loading="drive = 'ground_acceleration', file = 'ground.csv'",
        analysis=f"method = 'rk4', dt = 1e-4, duration = {(steps - 0.5) * 1e-4!r}",
        output=f"every = {every}",
    )
    write(folder, text, f"{name}.nml")


@pytest.fixture
def long_run(dynamic_text, tmp_path):
    long_case(dynamic_text, tmp_path)


def unfinished(folder: Path, name: str = "case.csv") -> Path:
    """The name of the rows of a process until they are whole."""
    return folder / f"{name}.1.partial"


def wait_for(path: Path, least: int) -> None:
    for _ in range(round(PATIENCE / 0.001)):
        if path.is_file() and path.stat().st_size > least:
            return
        time.sleep(0.001)
    raise AssertionError(f"{path} does not grow")


def stopped(process: subprocess.Popen, partial: Path, size: int, pause: float) -> None:
    """Stop a run for a while once it has written so much."""
    wait_for(partial, size)
    process.send_signal(signal.SIGSTOP)
    assert process.poll() is None, "the run was over before it could be stopped"
    time.sleep(pause)
    process.send_signal(signal.SIGCONT)


def on_terminal(
    executable: Path, arguments: list[str], cwd: Path, stops: Sequence[tuple[int, float]] = ()
) -> tuple[int, str, str]:
    """Exit code, text on the terminal (stderr) and stdout (a pipe).

    Run on a terminal, stopped each time that the csv has a size, for a while [bytes, s]."""
    terminal, inner = pty.openpty()
    with open(cwd / "stdout.txt", "w+") as out:
        process = subprocess.Popen(
            [executable, *arguments], cwd=cwd, stdin=subprocess.DEVNULL, stdout=out, stderr=inner
        )
        os.close(inner)
        for size, pause in stops:
            stopped(process, unfinished(cwd), size, pause)
        text = b""
        while select.select([terminal], [], [], PATIENCE)[0]:
            try:
                piece = os.read(terminal, 4096)
            except OSError:  # Linux: the other end is closed
                break
            if not piece:
                break
            text += piece
        os.close(terminal)
        code = process.wait(timeout=PATIENCE)
        out.seek(0)
        return code, text.decode(), out.read()


def test_progress_on_a_terminal_grows_and_is_taken_away(executable, long_run, tmp_path):
    stops = [(50_000, SHOWN_AFTER), (400_000, AGAIN_AFTER)]
    code, text, out = on_terminal(executable, ["run", "case.nml"], tmp_path, stops)
    assert code == 0
    assert "rows in" in out
    assert "\r" not in out
    shares = [int(share) for share in re.findall(r"\] +(\d+) % +\d+ s left", text)]
    assert len(shares) >= 2
    assert shares == sorted(shares)
    assert 0 < shares[0] < shares[-1] <= 100
    # Never a line of its own, and blank at the end.
    assert "\n" not in text
    assert re.search(r"\r +\r$", text)
    assert max(len(line) for line in text.split("\r")) < 80


def test_progress_stays_away_in_a_pipe_with_quiet_and_in_short_runs(
    executable, case_text, long_run, tmp_path
):
    process = subprocess.Popen(
        [executable, "run", "case.nml"], cwd=tmp_path, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    stopped(process, unfinished(tmp_path), 50_000, SHOWN_AFTER)
    out, error = process.communicate(timeout=PATIENCE)
    assert (process.returncode, error) == (0, "")
    assert "\r" not in out
    stops = [(50_000, SHOWN_AFTER)]
    assert on_terminal(executable, ["run", "case.nml", "-q"], tmp_path, stops) == (0, "", "")
    write(tmp_path, case_text())
    code, text, out = on_terminal(executable, ["run", "case.nml"], tmp_path)
    assert (code, text) == (0, "")
    assert "rows in" in out


@pytest.mark.parametrize(
    "number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP, signal.SIGKILL], ids=str
)
def test_stopped_run_keeps_its_rows_and_the_old_output(executable, long_run, tmp_path, number):
    """As a run that fails does; those of a run that is killed are named by the next one."""
    (tmp_path / "case.csv").write_text("# rbsdem old")
    process = subprocess.Popen(
        [executable, "run", "case.nml"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    )
    own = unfinished(tmp_path)
    wait_for(own, 50_000)
    process.send_signal(number)
    _, told = process.communicate(timeout=PATIENCE)
    assert process.returncode == -number
    assert (tmp_path / "case.csv").read_text() == "# rbsdem old"
    kept = own if number == signal.SIGKILL else tmp_path / "case.csv.partial"
    text = kept.read_text()
    if number == signal.SIGKILL:
        text = text[: text.rfind("\n") + 1]  # the system may have been in the midst of a row
    assert text.endswith("\n")
    head, *rows = [line for line in text.splitlines() if not line.startswith("#")]
    assert {row.count(",") for row in rows} == {head.count(",")}
    if number == signal.SIGKILL:
        again = subprocess.Popen(
            [executable, "run", "case.nml"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
        )
        wait_for(tmp_path / "case.csv.2.partial", 50_000)
        again.terminate()
        _, told = again.communicate(timeout=PATIENCE)
        assert "note: case.csv.1.partial has rows of a run that was killed\n" in told
    assert "stopped by a signal; the rows up to there are in case.csv.partial\n" in told
    assert sorted(path.name for path in tmp_path.glob("*.partial")) == (
        ["case.csv.1.partial", "case.csv.partial"]
        if number == signal.SIGKILL
        else ["case.csv.partial"]
    )


def test_two_processes_with_one_output_leave_whole_rows_of_one(executable, dynamic_text, tmp_path):
    """Each exits 0 since each has written its own rows whole; the last has the name."""
    rows = {}
    for name in ("one", "two"):
        long_case(dynamic_text, tmp_path, 200_000, name)
        subprocess.run([executable, "run", f"{name}.nml", "-q"], cwd=tmp_path, check=True)
        rows[name] = (tmp_path / f"{name}.csv").read_bytes()
    for _ in range(3):
        both = [
            subprocess.Popen([executable, "run", f"{n}.nml", "-q", "-o", "out.csv"], cwd=tmp_path)
            for n in rows
        ]
        assert [process.wait(PATIENCE) for process in both] == [0, 0]
        assert (tmp_path / "out.csv").read_bytes() in rows.values()
        assert not list(tmp_path.glob("*.partial"))


def test_ignored_signals_stay_ignored(executable, dynamic_text, tmp_path):
    """As by `nohup`."""
    long_case(dynamic_text, tmp_path, 400_000)
    command = ["sh", "-c", 'trap "" HUP; exec "$0" run case.nml -q', executable]
    process = subprocess.Popen(command, cwd=tmp_path)
    while not list(tmp_path.glob("*.partial")):
        assert process.poll() is None
    process.send_signal(signal.SIGHUP)
    assert process.wait(PATIENCE) == 0


def peak_memory(executable: Path, cwd: Path) -> int:
    """Largest resident memory of a run in kB, as the system counts it for the process alone."""
    process = subprocess.Popen([executable, "run", "case.nml", "-q"], cwd=cwd)
    peak = 0
    while process.poll() is None:
        try:
            status = Path(f"/proc/{process.pid}/status").read_text()
        except OSError:
            break
        # Before exec the memory is still that of Python.
        if found := re.search(r"^Name:\s+rbsdem.*^VmHWM:\s+(\d+) kB", status, re.M | re.S):
            peak = max(peak, int(found.group(1)))
        time.sleep(0.001)
    assert process.wait(timeout=20) == 0
    assert peak > 0, "the run was over before it could be measured"
    return peak


def test_million_steps_in_constant_memory(executable, dynamic_text, tmp_path, read_csv):
    """Constant memory when only every n-th step is kept."""
    peaks = {}
    for steps in (100_000, 1_000_000):
        long_case(dynamic_text, tmp_path, steps, every=10_000)
        peaks[steps] = peak_memory(executable, tmp_path)
        rows = read_csv(tmp_path / "case.csv")
        assert rows["time_s"].size == steps // 10_000 + 1
        np.testing.assert_allclose(np.diff(rows["time_s"])[:-1], 1.0, rtol=1e-9)
    # One double a step would be 7 MB more.
    assert peaks[1_000_000] < peaks[100_000] + 1000


def test_check_as_json(run_cli, case_text, dynamic_text, tmp_path):
    """The same errors, notes and code as in words, for programs that write cases."""
    (tmp_path / "good.nml").write_text(dynamic_text())
    (tmp_path / 'b"ad.nml').write_text(case_text(column='hieght = 1.6, title = "x"', shear="k = 1"))
    for name, code in (("good.nml", 0), ('b"ad.nml', 2), ("none.nml", 2)):
        plain, told = (run_cli(["check", name, *more], tmp_path) for more in ([], ["--json"]))
        assert (plain.returncode, told.returncode, told.stderr) == (code, code, "")
        found = json.loads(told.stdout)
        assert found["case"] == name
        said = [f"rbsdem: {each['message']}" for each in found["errors"]]
        assert said == plain.stderr.splitlines()
        for each in found["errors"]:
            line = re.search(r" line (\d+)", each["message"])
            assert each["line"] == (int(line[1]) if line else None)
        notes = [line[6:] for line in plain.stdout.splitlines() if line.startswith("note: ")]
        assert found["notes"] == notes
        assert ("method: " in plain.stdout) == ("method" in found)
