"""The executable: arguments, exit codes, messages, output files, progress, memory.

Every fault is looked at through `check` and `run`: both say the same, and nothing is written.
"""

from __future__ import annotations

import os
import pty
import re
import select
import signal
import stat
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Takeda

BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
COLUMN = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA)

# Silence of a run before its progress is shown, and from line to line, with some to spare [s].
SHOWN_AFTER, AGAIN_AFTER = 1.2, 0.4

PATIENCE = 60.0  # seconds after which a run hangs

FATAL_WORDS = ("Fortran runtime", "Backtrace", "SIG", "At line", "forrtl", "Traceback")


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


# ---- arguments -----------------------------------------------------------------------------------


@pytest.mark.parametrize("command", ["run", "check", "modes", "keys"])
def test_help_of_a_command_is_its_own(run_cli, command):
    shown = run_cli([command, "--help"])
    assert (shown.returncode, shown.stderr) == (0, "")
    assert shown.stdout.startswith(f"usage: rbsdem {command} ")
    others = {"run", "check", "modes", "keys", "trade", "peer", "ensemble"} - {command}
    assert not any(f"rbsdem {other}" in shown.stdout for other in others)
    assert max(len(line) for line in shown.stdout.splitlines()) <= 84
    options = {"run": "--output", "check": "--quiet", "modes": "rk4", "keys": "--json"}
    assert options[command] in shown.stdout
    for again in (["--help", command], [command, "-h"]):
        assert run_cli(again).stdout == shown.stdout


@pytest.mark.parametrize("command", ["trade", "peer", "ensemble"])
def test_help_of_a_command_of_the_package(command):
    shown = [
        subprocess.run(
            [sys.executable, "-m", "rbsdem", *arguments], capture_output=True, text=True, check=True
        ).stdout
        for arguments in ([command, "--help"], ["--help", command])
    ]
    assert shown[0].startswith(f"Usage: rbsdem {command} ")
    assert shown[1] == shown[0]


@pytest.mark.parametrize("arguments", [["--help"], ["-h"]])
def test_help_names_commands_options_and_exit_codes(run_cli, arguments):
    result = run_cli(arguments)
    assert result.returncode == 0
    assert result.stderr == ""
    for word in ("rbsdem run", "rbsdem check", "rbsdem modes", "--output", "--quiet", "--version"):
        assert word in result.stdout
    codes = ("0  all went well", "1  the analysis failed", "2  the input is wrong", "3  the column")
    for line in codes:
        assert f"\n  {line}" in result.stdout
    assert (
        "rbsdem trade CASE.nml needs the command that comes with the Python package"
        in result.stdout
    )
    assert max(len(line) for line in result.stdout.splitlines()) <= 84
    assert rbsdem.__version__ in result.stdout


def test_version_is_that_of_the_package(run_cli):
    result = run_cli(["--version"])
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == f"rbsdem {rbsdem.__version__}\n"


def test_argument_of_100_000_letters_is_refused(run_cli):
    text = faults(run_cli(["x" * 100_000]))
    assert "is not known" in text


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", "case.nml", "--output", "o.csv", "--quiet"],
        ["run", "case.nml", "-o", "o.csv", "-q"],
        ["--quiet", "--output=o.csv", "run", "case.nml"],
        ["-q", "run", "-o=o.csv", "case.nml"],
    ],
)
def test_options_in_any_place_and_spelling(run_cli, case_text, tmp_path, arguments):
    write(tmp_path, case_text())
    result = run_cli(arguments, tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    assert sorted(os.listdir(tmp_path)) == ["case.nml", "o.csv"]


# ---- good cases ----------------------------------------------------------------------------------


def test_run_writes_rows_and_prints_a_summary(run_cli, case_text, tmp_path, read_csv):
    write(tmp_path, case_text())
    result = run_cli(["run", "case.nml"], tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    rows = read_csv(tmp_path / "case.csv")
    figures = dict(re.findall(r"^  (\w+) +(\S+)$", result.stdout, re.MULTILINE))
    assert result.stdout.startswith("minimal\n")
    assert int(figures["rows"]) == rows["step"].size == 33
    assert float(figures["peak_displacement_m"]) == pytest.approx(0.016, rel=1e-5)
    peak = rows["force_N"][np.argmax(np.abs(rows["force_N"]))]
    assert float(figures["peak_force_N"]) == pytest.approx(peak, rel=1e-5)
    assert float(figures["input_energy_J"]) == pytest.approx(rows["input_J"][-1], rel=1e-5)
    assert "rows in" in result.stdout
    assert "case.csv" in result.stdout
    assert "stable_step" not in result.stdout  # no figure of a static path


def test_run_in_time_prints_step_and_limit(run_cli, dynamic_text, tmp_path):
    write(tmp_path, dynamic_text())
    result = run_cli(["run", "case.nml"], tmp_path)
    assert result.returncode == 0
    figures = dict(re.findall(r"^  (\w+) +(\S+)$", result.stdout, re.MULTILINE))
    limit = rbsdem.modes(COLUMN).stable_step
    assert float(figures["stable_step_s"]) == pytest.approx(limit, rel=1e-5)
    assert 0 < float(figures["time_step_s"]) <= 0.2 * limit * (1 + 1e-5)


def test_csv_says_version_case_units_and_is_read_by_numpy(run_cli, case_text, tmp_path):
    write(tmp_path, case_text(case="title = 'Säule, \"Nr 1\"; half'"))
    assert run_cli(["run", "case.nml", "--quiet"], tmp_path).returncode == 0
    path = tmp_path / "case.csv"
    text = path.read_text("utf-8")
    assert text.endswith("\n")
    assert "\r" not in text
    head = text.splitlines()[:4]
    assert head[0] == f"# rbsdem {rbsdem.__version__}"
    assert head[1] == '# case: Säule, "Nr 1"; half'
    assert "SI" in head[2]
    assert "static" in head[2]
    assert "small" in head[2]
    names = head[3].split(",")
    assert names[:3] == ["step", "displacement_m", "force_N"]
    joints = ["slip_1_m", "rotation_1_rad", "shear_1_N", "moment_1_Nm"]
    assert names[9:] == ["top_height_m", *joints]
    assert len(set(names)) == len(names)
    for name in names[1:]:
        assert re.search(r"_(m|N|J|rad|Nm)$", name), name
    table = np.loadtxt(path, delimiter=",", skiprows=4)
    assert table.shape == (33, len(names))
    named = np.genfromtxt(path, delimiter=",", names=True, skip_header=3)
    assert named.dtype.names == tuple(names)
    assert np.all(np.isfinite(table))
    run = rbsdem.cyclic(
        COLUMN, displacement=rbsdem.protocol(np.array([0.005, 0.01]) * 1.6, points=4)
    )
    assert np.array_equal(table[:, 1], run.displacement)
    assert np.array_equal(table[:, 2], run.force)
    assert np.array_equal(named["moment_1_Nm"], run.moment[:, 0])


def test_csv_of_a_run_in_time_has_time_and_columns_for_each_joint(
    run_cli, dynamic_text, tmp_path, read_csv
):
    write(tmp_path, dynamic_text(column="n = 3, height = 1.6, mass = 614.4"))
    assert run_cli(["run", "case.nml", "--quiet"], tmp_path).returncode == 0
    rows = read_csv(tmp_path / "case.csv")
    joints = [
        f"{name}_{i}_{unit}"
        for name, unit in (("slip", "m"), ("rotation", "rad"), ("shear", "N"), ("moment", "Nm"))
        for i in (1, 2, 3)
    ]
    assert list(rows)[10:] == joints
    assert next(iter(rows)) == "time_s"
    assert np.all(np.diff(rows["time_s"]) > 0)
    assert rows["time_s"][-1] == pytest.approx(0.1, rel=1e-12)


def test_quiet_prints_nothing(run_cli, case_text, dynamic_text, tmp_path):
    write(tmp_path, case_text(), "a.nml")
    write(tmp_path, dynamic_text(), "b.nml")
    for arguments in (["run", "a.nml"], ["run", "b.nml"], ["check", "a.nml"], ["check", "b.nml"]):
        result = run_cli([*arguments, "--quiet"], tmp_path)
        assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_check_writes_nothing(run_cli, case_text, dynamic_text, tmp_path):
    for text in (case_text(), dynamic_text()):
        write(tmp_path, text)
        result = run_cli(["check", "case.nml"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        assert result.stdout == "case.nml: no errors\n"
        assert os.listdir(tmp_path) == ["case.nml"]


def test_modes_equal_those_of_python_to_the_last_digit(run_cli, case_text, tmp_path):
    write(tmp_path, case_text(column="n = 4, height = 1.6, mass = 614.4"))
    result = run_cli(["modes", "case.nml"], tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert os.listdir(tmp_path) == ["case.nml"]
    lines = result.stdout.splitlines()
    assert lines[0] == "mode,frequency_Hz,period_s,omega_rad/s"
    table = np.array([[float(word) for word in line.split(",")] for line in lines[1:-1]])
    modes = rbsdem.modes(rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=4))
    assert np.array_equal(table[:, 0], np.arange(1, 9))
    assert np.array_equal(table[:, 1], modes.frequency)
    np.testing.assert_allclose(table[:, 2] * table[:, 1], 1.0, rtol=1e-15)
    assert np.array_equal(table[:, 3], modes.omega)
    assert lines[-1].startswith("# stable step")
    assert float(lines[-1].rpartition(":")[2]) == modes.stable_step


def test_first_modes_and_matrices_equal_those_of_python_to_the_last_digit(
    run_cli, case_text, tmp_path
):
    write(tmp_path, case_text(column="n = 4, height = 1.6, mass = 614.4"))
    result = run_cli(["modes", "case.nml", "--count", "3", "--matrices"], tmp_path)
    lines = result.stdout.splitlines()
    assert lines[4].startswith("# stable step")
    column = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=4)
    np.testing.assert_array_equal(
        [float(line.split(",")[3]) for line in lines[1:4]], rbsdem.modes(column, count=3).omega
    )
    matrices = rbsdem.matrices(column)
    for k, name in enumerate(("mass", "stiffness", "geometric", "damping")):
        head, *rows = (line.split(",") for line in lines[5 + 9 * k : 14 + 9 * k])
        assert head == [name, *matrices.unknowns]
        assert [row[0] for row in rows] == list(matrices.unknowns)
        np.testing.assert_array_equal(
            np.array([row[1:] for row in rows], float), getattr(matrices, name)
        )


def test_modes_of_table_3_column_1_are_those_of_eq_6_corrected(run_cli, case_text, tmp_path):
    """theory.md E5: 95.585 and 395.070 Hz."""
    write(tmp_path, case_text(loading=None))  # modes need no loading
    lines = run_cli(["modes", "case.nml"], tmp_path).stdout.splitlines()
    frequencies = [float(line.split(",")[1]) for line in lines[1:3]]
    np.testing.assert_allclose(frequencies, [95.585, 395.070], rtol=1e-5)


# ---- the case file as text -----------------------------------------------------------------------

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
    "defaults said": lambda t: (
        t.replace("height", "n = 1, kinematics = 'small', axial_load = 0, height")
        + "&damping mass = 0, tangent = F / &analysis method = 'static' /\n"
        + "&output every = +1 /"
    ),
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_layout_of_the_case_file_does_not_matter(run_cli, case_text, tmp_path, layout):
    write(tmp_path, case_text(), "plain.nml")
    write(tmp_path, LAYOUTS[layout](case_text()), "layout.nml")
    for name in ("plain.nml", "layout.nml"):
        result = run_cli(["run", name, "--quiet"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
    assert (tmp_path / "layout.csv").read_bytes() == (tmp_path / "plain.csv").read_bytes()


def test_values_from_a_subscript_on_are_taken_or_refused_in_plain_words(
    run_cli, case_text, tmp_path
):
    """Fortran gives an element one value; more of them must not end in words of its runtime."""
    write(tmp_path, case_text(), "plain.nml")
    write(tmp_path, case_text().replace("amplitudes =", "amplitudes(1) ="))
    assert run_cli(["run", "plain.nml", "--quiet"], tmp_path).returncode == 0
    result = run_cli(["run", "case.nml", "--quiet"], tmp_path)
    if result.returncode == 0:
        assert (tmp_path / "case.csv").read_bytes() == (tmp_path / "plain.csv").read_bytes()
    else:
        text = faults(result)
        assert "case.nml line 5" in text
        assert "amplitudes" in text
        assert "namelist object" not in text


def test_repeat_counts_stand_for_values(run_cli, case_text, tmp_path):
    loading = "drive = 'displacement', points = 3, amplitudes = "
    write(tmp_path, case_text(loading=loading + "2*0.01, 0.02, cycles = 3*2"), "a.nml")
    write(tmp_path, case_text(loading=loading + "0.01, 0.01, 0.02, cycles = 2, 2, 2"), "b.nml")
    for name in ("a.nml", "b.nml"):
        assert run_cli(["run", name, "--quiet"], tmp_path).returncode == 0
    assert (tmp_path / "a.csv").read_bytes() == (tmp_path / "b.csv").read_bytes()


def test_quote_within_a_text_is_doubled_or_of_the_other_kind(run_cli, case_text, tmp_path):
    """Fortran 2008, 4.4.3: a doubled delimiter within a text stands for one."""
    for title in ("'it''s /&= 1'", '"it\'s /&= 1"'):
        write(tmp_path, case_text(case=f"title = {title}"))
        result = run_cli(["run", "case.nml", "--quiet"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        assert (tmp_path / "case.csv").read_text("utf-8").splitlines()[1] == "# case: it's /&= 1"


# ---- faults of the case --------------------------------------------------------------------------

K = "rule = 'bilinear', k = 7e8, d_y = 1e-4, k_post = 8e6"
E = "rule = 'elastic', k = 1e8"
H = "height = 1, mass = 1, "
STATIC = "method = 'static'"
PROTOCOL = "drive = 'displacement', amplitudes = "


def check_and_run(run_cli, folder: Path, words: list[str]) -> str:
    """The message of a faulty case, the same from `check` and `run`; nothing is written."""
    before = sorted(os.listdir(folder))
    results = [run_cli([command, "case.nml"], folder) for command in ("check", "run")]
    texts = [faults(result) for result in results]
    for word in words:
        assert word in texts[0]
    assert texts[0] == texts[1]
    assert sorted(os.listdir(folder)) == before
    return texts[0]


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (b"", ["case.nml", "is empty"]),
        (b"\n \n! nothing\n", ["case.nml", "no groups", "&column"]),
        (b"height = 1.6\n", ["line 1", "'height' stands outside a group", "&name"]),
        (b"&column height = 1.6\n", ["line 1", "&column is not closed", "/"]),
        (b"&\n/\n", ["line 1", "no name after &"]),
        (b"\n&column height\n/", ["line 3", "'height' in &column has no ="]),
        (b"&case title = 'a\0b' /", ["case.nml", "not a text file", "zero byte"]),
        (b"\x7fELF\x01\x02\x03", ["line 1", "control character"]),
        (b"&column /\n" * 50000, ["line 2: &column appears twice"]),
    ],
)
def test_file_that_is_no_case(run_cli, tmp_path, content, words):
    (tmp_path / "case.nml").write_bytes(content)
    text = check_and_run(run_cli, tmp_path, words)
    assert len(text.splitlines()) <= 25


def test_case_of_more_than_100_mb_is_refused(run_cli, tmp_path):
    with (tmp_path / "case.nml").open("wb") as file:
        file.truncate(120_000_000)
    check_and_run(run_cli, tmp_path, ["case.nml", "1.2e+08 bytes", "100000000"])


def test_step_beyond_the_stability_limit_is_refused_with_the_limit(run_cli, dynamic_text, tmp_path):
    """Dynamics; theory section 6: 2 sqrt(2) / omega_max."""
    limit = float(2 * np.sqrt(2) / rbsdem.modes(COLUMN).omega[-1])
    write(tmp_path, dynamic_text(analysis=f"method = 'rk4', dt = {limit * 1.001!r}"))
    text = check_and_run(run_cli, tmp_path, ["beyond the stability limit"])
    said = float(re.search(r"limit of rk4, (\S+) s", text).group(1))
    assert said == pytest.approx(limit, rel=1e-5)
    write(tmp_path, dynamic_text(analysis=f"method = 'rk4', dt = {limit * 0.999!r}"))
    assert run_cli(["run", "case.nml"], tmp_path).returncode == 0


# ---- where the output goes -----------------------------------------------------------------------

CAPACITY = 7.0387e8 * 1.296e-4  # of a shear spring without stiffness after yield


@pytest.fixture
def overloaded(case_text):
    """A case that fails half way: a force of twice the capacity of the shear spring."""
    return case_text(
        shear="rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 0",
        loading=f"drive = 'force', amplitudes = {CAPACITY / 2!r}, {2 * CAPACITY!r}, points = 4",
    )


def test_output_is_named_after_the_case_beside_it(run_cli, case_text, tmp_path):
    folder = tmp_path / "sub.d"
    folder.mkdir()
    for name, output in (("a.b.nml", "a.b.csv"), ("plain", "plain.csv"), (".x", ".x.csv")):
        write(folder, case_text(), name)
        assert run_cli(["run", f"sub.d/{name}", "-q"], tmp_path).returncode == 0
        assert (folder / output).is_file()
    assert os.listdir(tmp_path) == ["sub.d"]


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


def test_output_with_blanks_and_letters_beyond_ascii_in_its_path(run_cli, case_text, tmp_path):
    folder = tmp_path / "Säule 1 ü"
    folder.mkdir()
    write(folder, case_text(), "ein Fall.nml")
    result = run_cli(["run", folder / "ein Fall.nml"], tmp_path)
    assert result.returncode == 0
    assert "Säule 1 ü/ein Fall.csv" in result.stdout
    assert (folder / "ein Fall.csv").is_file()


@pytest.mark.parametrize(
    ("output", "words"),
    [
        ("folder", ["folder is a folder", "path of a file"]),
        ("folder/", ["is a folder"]),
        (".", ["is a folder"]),
        ("none/out.csv", ["cannot write none/out.csv", "--output"]),
        ("plain/out.csv", ["cannot write plain/out.csv", "--output"]),  # below a regular file
        ("x" * 300, ["cannot write", "--output"]),
    ],
)
def test_output_that_cannot_be_written_is_refused(run_cli, case_text, tmp_path, output, words):
    (tmp_path / "folder").mkdir()
    (tmp_path / "plain").write_text("untouched")
    write(tmp_path, case_text())
    text = faults(run_cli(["run", "case.nml", "--output", output], tmp_path))
    for word in words:
        assert word in text
    assert sorted(os.listdir(tmp_path)) == ["case.nml", "folder", "plain"]
    assert os.listdir(tmp_path / "folder") == []
    assert (tmp_path / "plain").read_text() == "untouched"


def test_force_beyond_the_capacity_keeps_the_path_and_the_old_output(
    run_cli, overloaded, tmp_path, read_csv
):
    """Static path: the force reached is said, the path up to there is kept."""
    write(tmp_path, overloaded)
    (tmp_path / "out.csv").write_text("old")
    assert run_cli(["check", "case.nml"], tmp_path).returncode == 0
    text = faults(run_cli(["run", "case.nml", "-o", "out.csv"], tmp_path), code=1)
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
    right = overloaded.replace("k_post = 0", "k_post = 1e6")
    write(tmp_path, right)
    assert run_cli(["run", "case.nml", "-q", "-o", "out.csv"], tmp_path).returncode == 0
    assert read_csv(tmp_path / "out.csv")["step"].size == 33
    assert sorted(os.listdir(tmp_path)) == ["case.nml", "out.csv"]


def test_failure_with_quiet_still_tells(run_cli, overloaded, tmp_path):
    write(tmp_path, overloaded)
    text = faults(run_cli(["run", "case.nml", "--quiet"], tmp_path), code=1)
    assert "beyond the capacity" in text


def test_bad_input_leaves_old_output_and_no_partial(run_cli, case_text, tmp_path):
    for groups in ({"column": "height = -1, mass = 1"}, {"loading": PROTOCOL + "1e308, scale = 9"}):
        write(tmp_path, case_text(**groups))
        (tmp_path / "case.csv").write_text("old")
        faults(run_cli(["run", "case.nml"], tmp_path))
        assert sorted(os.listdir(tmp_path)) == ["case.csv", "case.nml"]
        assert (tmp_path / "case.csv").read_text() == "old"


@pytest.mark.parametrize("output", [None, "history.csv", "./history.csv", "HERE/history.csv"])
def test_output_never_replaces_the_history_that_it_is_read_from(
    run_cli, case_text, tmp_path, output
):
    """history.nml on history.csv: its default output would be the file that drives it."""
    (tmp_path / "history.csv").write_text("displacement_mm,force_kN\n0,0\n10,1\n")
    before = (tmp_path / "history.csv").read_text()
    text = case_text(loading="drive = 'displacement', file = 'history.csv'")
    write(tmp_path, text, "history.nml")
    option = ["--output", output.replace("HERE", str(tmp_path))] if output else []
    text = faults(run_cli(["run", "history.nml", *option], tmp_path))
    assert "history.csv" in text
    assert "--output" in text
    assert (tmp_path / "history.csv").read_text() == before
    assert sorted(os.listdir(tmp_path)) == ["history.csv", "history.nml"]


def test_output_never_replaces_the_case(run_cli, case_text, tmp_path):
    write(tmp_path, case_text(), "case.csv")
    for arguments in (["case.csv"], ["case.csv", "-o", "case.csv"]):
        text = faults(run_cli(["run", *arguments], tmp_path))
        assert "case.csv" in text
        assert (tmp_path / "case.csv").read_text() == case_text()
        assert os.listdir(tmp_path) == ["case.csv"]


@pytest.mark.parametrize("target", ["/dev/full", "/dev/null", "fifo"])
def test_output_that_is_no_regular_file_is_not_replaced_by_one(
    run_cli, case_text, tmp_path, target
):
    """A rename onto /dev/null or a pipe would take it away from everyone."""
    write(tmp_path, case_text())
    assert run_cli(["run", "case.nml", "-q", "-o", "good.csv"], tmp_path).returncode == 0
    path = tmp_path / "special"
    if target == "fifo":
        os.mkfifo(path)
    else:
        path.symlink_to(target)  # not the device itself: the root user could lose it
    reader = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    try:
        result = run_cli(["run", "case.nml", "--output", "special"], tmp_path)
        assert not stat.S_ISREG(path.stat().st_mode)
        assert path.is_symlink() == (target != "fifo")
        assert sorted(os.listdir(tmp_path)) == ["case.nml", "good.csv", "special"]
        if result.returncode == 0:
            assert target != "/dev/full"
            if target == "fifo":
                assert os.read(reader, 1_000_000) == (tmp_path / "good.csv").read_bytes()
        else:
            assert "special" in faults(result, code=result.returncode)
    finally:
        os.close(reader)


def test_modes_that_cannot_be_printed_are_no_success(run_cli, case_text, tmp_path):
    """`rbsdem modes case.nml >file` on a full disk must not exit 0."""
    write(tmp_path, case_text())
    with open("/dev/full", "w") as full:
        result = run_cli(["modes", "case.nml"], tmp_path, stdout=full, stderr=subprocess.PIPE)
    assert result.returncode == 1
    assert result.stderr.startswith("rbsdem: ")
    assert not any(word in result.stderr for word in FATAL_WORDS)


@pytest.mark.parametrize("closed", [0, 1, 2])
def test_closed_standard_streams_do_no_harm_to_the_csv(run_cli, case_text, tmp_path, closed):
    write(tmp_path, case_text())
    assert run_cli(["run", "case.nml", "-q", "-o", "good.csv"], tmp_path).returncode == 0
    process = run_cli(["run", "case.nml"], tmp_path, preexec_fn=lambda: os.close(closed))
    assert process.returncode in (0, 1)
    if process.returncode == 0:
        assert (tmp_path / "case.csv").read_bytes() == (tmp_path / "good.csv").read_bytes()


# ---- long runs -----------------------------------------------------------------------------------


def long_text(dynamic_text, steps: int, every: int) -> str:
    """Elastic column shaken for a number of steps that do not divide the loading's times."""
    elastic = "rule = 'elastic', k = 7e8"
    dt = 1.0e-4
    return dynamic_text(
        shear=elastic,
        flexure=elastic,
        loading="drive = 'ground_acceleration', file = 'ground.csv'",
        analysis=f"method = 'rk4', dt = {dt}, duration = {(steps - 0.5) * dt!r}",
        output=f"every = {every}",
    )


ROWS = 4000


@pytest.fixture
def long_run(dynamic_text, tmp_path):
    """A case of many steps. The tests stop it on its way, which makes it long by the clock."""
    (tmp_path / "ground.csv").write_text("time_s,acceleration_g\n0,0.1\n0.3,-0.1\n1e5,0.1\n")
    return write(tmp_path, long_text(dynamic_text, ROWS * 1000, 1000))


def unfinished(process: subprocess.Popen, folder: Path, name: str = "case.csv") -> Path:
    """The name of the rows of a process until they are whole."""
    return folder / f"{name}.{process.pid}-1.partial"


def stopped(process: subprocess.Popen, partial: Path, size: int, pause: float) -> None:
    """Stop a run for a while once it has written so much."""
    wait_for(partial, size)
    process.send_signal(signal.SIGSTOP)
    assert process.poll() is None, "the run was over before it could be stopped"
    time.sleep(pause)
    process.send_signal(signal.SIGCONT)


def test_no_progress_in_a_pipe(executable, long_run, tmp_path, read_csv):
    process = subprocess.Popen(
        [executable, "run", long_run], cwd=tmp_path, stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    stopped(process, unfinished(process, tmp_path), 50_000, SHOWN_AFTER)
    out, error = process.communicate(timeout=PATIENCE)
    assert (process.returncode, error) == (0, "")
    assert "\r" not in out
    assert read_csv(tmp_path / "case.csv")["time_s"].size == ROWS + 1


@dataclass(frozen=True)
class Shown:
    """What a run leaves: exit code, text on the terminal (stderr), stdout (a pipe)."""

    code: int
    text: str
    out: str


def on_terminal(
    executable: Path, arguments: list[str], cwd: Path, stops: Sequence[tuple[int, float]] = ()
) -> Shown:
    """Run on a terminal, stopped each time that the csv has a size, for a while [bytes, s]."""
    terminal, inner = pty.openpty()
    with open(cwd / "stdout.txt", "w+") as out:
        process = subprocess.Popen(
            [executable, *arguments], cwd=cwd, stdin=subprocess.DEVNULL, stdout=out, stderr=inner
        )
        os.close(inner)
        for size, pause in stops:
            stopped(process, unfinished(process, cwd), size, pause)
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
        return Shown(code, text.decode(), out.read())


def test_progress_on_a_terminal_grows_and_is_taken_away(executable, long_run, tmp_path):
    stops = [(50_000, SHOWN_AFTER), (400_000, AGAIN_AFTER)]
    shown = on_terminal(executable, ["run", "case.nml"], tmp_path, stops)
    assert shown.code == 0
    assert "rows in" in shown.out
    assert "\r" not in shown.out
    shares = [int(share) for share in re.findall(r"\] +(\d+) % +\d+ s left", shown.text)]
    assert len(shares) >= 2
    assert shares == sorted(shares)
    assert 0 < shares[0] < shares[-1] <= 100
    # Never a line of its own, and blank at the end.
    assert "\n" not in shown.text
    assert re.search(r"\r +\r$", shown.text)
    assert max(len(line) for line in shown.text.split("\r")) < 80


def test_progress_on_a_terminal_stays_away_with_quiet_and_in_short_runs(
    executable, case_text, long_run, tmp_path
):
    stops = [(50_000, SHOWN_AFTER)]
    shown = on_terminal(executable, ["run", "case.nml", "-q"], tmp_path, stops)
    assert (shown.code, shown.text, shown.out) == (0, "", "")
    write(tmp_path, case_text(), "short.nml")
    shown = on_terminal(executable, ["run", "short.nml"], tmp_path)
    assert (shown.code, shown.text) == (0, "")
    assert "rows in" in shown.out


def wait_for(path: Path, least: int) -> None:
    for _ in range(round(PATIENCE / 0.001)):
        if path.is_file() and path.stat().st_size > least:
            return
        time.sleep(0.001)
    raise AssertionError(f"{path} does not grow")


def test_output_is_whole_or_the_old_one_at_any_time(executable, long_run, tmp_path, read_csv):
    (tmp_path / "case.csv").write_text("old")
    process = subprocess.Popen([executable, "run", "case.nml", "-q"], cwd=tmp_path)
    wait_for(unfinished(process, tmp_path), 5000)
    process.send_signal(signal.SIGSTOP)
    assert process.poll() is None, "the run was over before it could be watched"
    assert (tmp_path / "case.csv").read_text() == "old"
    process.send_signal(signal.SIGCONT)
    assert process.wait(timeout=PATIENCE) == 0
    assert read_csv(tmp_path / "case.csv")["time_s"].size == ROWS + 1
    assert not list(tmp_path.glob("*.partial"))


def test_killed_run_leaves_the_old_output(executable, long_run, tmp_path):
    (tmp_path / "case.csv").write_text("old")
    process = subprocess.Popen([executable, "run", "case.nml", "-q"], cwd=tmp_path)
    wait_for(unfinished(process, tmp_path), 5000)
    process.kill()
    assert process.wait(timeout=20) == -signal.SIGKILL
    assert (tmp_path / "case.csv").read_text() == "old"


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
    (tmp_path / "ground.csv").write_text("time_s,acceleration_g\n0,0.1\n0.3,-0.1\n1e5,0.1\n")
    peaks = {}
    for steps in (100_000, 1_000_000):
        write(tmp_path, long_text(dynamic_text, steps, 10_000))
        peaks[steps] = peak_memory(executable, tmp_path)
        rows = read_csv(tmp_path / "case.csv")
        assert rows["time_s"].size == steps // 10_000 + 1
        np.testing.assert_allclose(np.diff(rows["time_s"])[:-1], 1.0, rtol=1e-9)
    # One double a step would be 7 MB more.
    assert peaks[1_000_000] < peaks[100_000] + 1000


# ---- loadings ------------------------------------------------------------------------------------

ELASTIC = "rule = 'elastic', k = 7e8"


def run_rows(run_cli, read_csv, folder: Path, text: str, name: str = "case.nml"):
    write(folder, text, name)
    result = run_cli(["run", name, "-q"], folder)
    assert (result.returncode, result.stderr) == (0, "")
    return read_csv((folder / name).with_suffix(".csv"))


def test_force_and_ground_motion_together_are_their_sum_on_a_linear_column(
    run_cli, dynamic_text, tmp_path, read_csv
):
    """Theory section 3: both act on the same linear equations. Times of the two files differ."""
    (tmp_path / "force.csv").write_text("time_s,force_kN\n0,0\n0.01,20\n0.03,-5\n0.04,0\n")
    (tmp_path / "ground.csv").write_text("t,acceleration_g\n0,0\n0.005,0.3\n0.02,-0.2\n0.04,0\n")
    force, ground = (
        "drive = 'force', file = 'force.csv'",
        "drive = 'ground_acceleration', file = 'ground.csv'",
    )
    none = "drive = 'force', scale = 0, file = 'force.csv'"
    still = "drive = 'ground_acceleration', scale = 0, file = 'ground.csv'"
    parts = {}
    for name, loading in {
        "both": [force, ground], "turned": [ground, force], "a": [force, still], "b": [none, ground]
    }.items():  # fmt: skip
        text = dynamic_text(shear=ELASTIC, flexure=ELASTIC, loading=loading)
        parts[name] = run_rows(run_cli, read_csv, tmp_path, text, f"{name}.nml")
    times = [0, 0.005, 0.01, 0.02, 0.03, 0.04]
    assert np.array_equal(parts["both"]["time_s"], times)
    for column in ("displacement_m", "slip_1_m", "rotation_1_rad", "force_N"):
        total = parts["a"][column] + parts["b"][column]
        scale = np.max(np.abs(total))
        np.testing.assert_allclose(parts["both"][column], total, atol=1e-12 * scale)
        assert np.array_equal(parts["both"][column], parts["turned"][column])
        if column != "force_N":
            assert np.max(np.abs(parts["b"][column])) > 0.01 * scale
    column = rbsdem.Column(1.6, 614.4, Elastic(7e8), Elastic(7e8))
    run = rbsdem.time_history(
        column,
        times,
        force=np.interp(times, [0, 0.01, 0.03, 0.04], [0, 20e3, -5e3, 0]),
        ground_acceleration=9.80665 * np.interp(times, [0, 0.005, 0.02, 0.04], [0, 0.3, -0.2, 0]),
        method="rk4",
    )
    np.testing.assert_allclose(parts["both"]["displacement_m"], run.displacement, rtol=1e-9)


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
    rows = run_rows(run_cli, read_csv, tmp_path, dynamic_text(loading=loading))
    np.testing.assert_allclose(rows["time_s"], [float(t) for t in times], rtol=1e-12)


def test_duration_cuts_and_prolongs_the_loading(run_cli, dynamic_text, tmp_path, read_csv):
    (tmp_path / "f.csv").write_text("time_s,force_kN\n1,0\n1.01,20\n1.03,-5\n")
    ends = {}
    for duration in (0.005, 0.03, 0.05):
        rows = run_rows(run_cli, read_csv, tmp_path, dynamic_text(
            loading="drive = 'force', file = 'f.csv'",
            analysis=f"method = 'rk4', duration = {duration}"))  # fmt: skip
        assert rows["time_s"][0] == 1.0
        assert rows["time_s"][-1] == 1.0 + duration
        ends[duration] = rows["force_N"][-1]
    assert ends[0.005] == pytest.approx(10e3, rel=1e-12)
    assert ends[0.03] == pytest.approx(-5e3, rel=1e-12)
    assert ends[0.05] == pytest.approx(-5e3, rel=1e-12)


def triangles(amplitudes, cycles, repeats, points) -> np.ndarray:
    """Cycles 0, +a, 0, -a, 0 in equal parts, beginning at zero."""
    wave = np.interp(np.arange(1, 4 * points + 1), np.arange(5) * points, [0, 1, 0, -1, 0])
    once = [a * wave for a, count in zip(amplitudes, cycles, strict=True) for _ in range(count)]
    return np.concatenate([[0.0], *once * repeats])


@pytest.mark.parametrize(
    ("keys", "factor"),
    [
        ("", 1.6),  # drift is displacement over height
        ("unit = 'drift'", 1.6),
        ("unit = 'm', scale = 0.5", 0.5),
        ("unit = 'mm', scale = 100", 0.1),
        ("unit = 'cm', scale = -2", -0.02),
        ("unit = 'in'", 0.0254),
    ],
)
def test_protocol_of_displacements_in_its_units(
    run_cli, case_text, tmp_path, *, read_csv, keys, factor
):
    loading = f"{PROTOCOL} 0.005, 0.02, 0.01, cycles = 1, 3, 2, repeats = 2, points = 5, {keys}"
    rows = run_rows(run_cli, read_csv, tmp_path, case_text(loading=loading))
    expected = factor * triangles([0.005, 0.02, 0.01], [1, 3, 2], 2, 5)
    np.testing.assert_allclose(rows["displacement_m"], expected, rtol=1e-14)
    assert np.array_equal(rows["step"], np.arange(expected.size))


def test_named_protocol_is_that_of_python(run_cli, case_text, tmp_path, read_csv):
    loading = (
        "drive = 'displacement', protocol = 'fema_461', reference = 30, unit = 'mm', points = 3"
    )
    rows = run_rows(run_cli, read_csv, tmp_path, case_text(loading=loading))
    expected = 1e-3 * rbsdem.protocol("fema_461", reference=30.0, points=3)
    np.testing.assert_allclose(rows["displacement_m"], expected, rtol=1e-14, atol=1e-18)


def test_protocol_with_another_amplitude_to_the_other_side(run_cli, case_text, tmp_path, read_csv):
    keys = "0.01, 0.02, negative_amplitudes = 0.005, 0, points = 2"
    rows = run_rows(run_cli, read_csv, tmp_path, case_text(loading=f"{PROTOCOL} {keys}"))
    sides = {"negative_amplitudes": [0.008, 0.0], "points": 2}
    expected = rbsdem.protocol([0.016, 0.032], **sides)
    np.testing.assert_allclose(rows["displacement_m"], expected, rtol=1e-14, atol=1e-18)


@pytest.mark.parametrize(
    ("drive", "unit", "factor"),
    [
        ("force", "", 1.0),
        ("force", "kN", 1e3),
        ("force", "MN", 1e6),
        ("force", "kip", 4448.2216152605),
    ],
)
def test_protocol_of_forces_in_its_units(
    run_cli, case_text, tmp_path, *, read_csv, drive, unit, factor
):
    loading = f"drive = '{drive}', amplitudes = 1, 2, cycles = 2, points = 3, unit = '{unit}'"
    text = case_text(shear=ELASTIC, flexure=ELASTIC, loading=loading)
    rows = run_rows(run_cli, read_csv, tmp_path, text)
    expected = factor * triangles([1.0, 2.0], [2, 2], 1, 3)
    np.testing.assert_allclose(rows["force_N"], expected, rtol=1e-14)


@pytest.mark.parametrize(
    ("unit", "factor"), [("", 1.0), ("g", 9.80665), ("cm/s2", 0.01), ("mm/s2", 1e-3)]
)
def test_protocol_of_ground_motion_in_its_units_and_period(
    run_cli, dynamic_text, tmp_path, *, read_csv, unit, factor
):
    """A rigid column on an elastic base follows its ground: the base shear is m a_g."""
    loading = (
        f"drive = 'ground_acceleration', amplitudes = 2, period = 8, points = 4, unit = '{unit}'"
    )
    damped = "mass = 700"
    text = dynamic_text(damping=damped, shear=ELASTIC, flexure=ELASTIC, loading=loading)
    rows = run_rows(run_cli, read_csv, tmp_path, text)
    assert np.array_equal(rows["time_s"], np.arange(17) / 2)
    expected = -614.4 * factor * triangles([2.0], [1], 1, 4)
    # Slow against a period of 0.006 s, damped: what is left is the turn of the triangle.
    np.testing.assert_allclose(rows["shear_1_N"], expected, atol=2e-3 * 614.4 * factor)


def test_every_keeps_each_nth_point_of_a_static_path_and_the_last(
    run_cli, case_text, tmp_path, read_csv
):
    whole = run_rows(run_cli, read_csv, tmp_path, case_text())
    size = whole["step"].size
    for every in (1, 2, 3, size - 1, size, 1000, 999_999_999):
        rows = run_rows(run_cli, read_csv, tmp_path, case_text(output=f"every = {every}"))
        kept = sorted({*range(0, size, every), size - 1})
        for name, values in whole.items():
            assert np.array_equal(rows[name], values[kept]), (every, name)


def test_every_counts_steps_of_a_run_in_time(run_cli, dynamic_text, tmp_path, read_csv):
    """Without it the rows are those of the loading; with it each n-th step and the last."""
    loading = run_rows(run_cli, read_csv, tmp_path, dynamic_text())
    assert np.array_equal(loading["time_s"], np.arange(17) * 0.00625)
    whole = run_rows(run_cli, read_csv, tmp_path, dynamic_text(output="every = 1"))
    size = whole["time_s"].size
    limit = rbsdem.modes(COLUMN).stable_step
    assert size >= 0.1 / (0.2 * limit)
    assert np.max(np.diff(whole["time_s"])) <= 0.2 * limit * (1 + 1e-12)
    assert set(loading["time_s"]) <= set(whole["time_s"])
    for every in (2, 7, size - 1, size, 999_999_999):
        rows = run_rows(run_cli, read_csv, tmp_path, dynamic_text(output=f"every = {every}"))
        kept = sorted({*range(0, size, every), size - 1})
        for name, values in whole.items():
            assert np.array_equal(rows[name], values[kept]), (every, name)


def test_peaks_of_the_summary_are_over_all_steps(run_cli, dynamic_text, tmp_path, read_csv):
    whole = run_rows(run_cli, read_csv, tmp_path, dynamic_text(output="every = 1"))
    peak = np.max(np.abs(whole["displacement_m"]))
    for output in ("every = 1000000", None):
        write(tmp_path, dynamic_text(output=output))
        text = run_cli(["run", "case.nml"], tmp_path).stdout
        said = float(re.search(r"peak_displacement_m +(\S+)", text).group(1))
        assert abs(said) == pytest.approx(peak, rel=1e-5)


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


# ---- column --------------------------------------------------------------------------------------


def test_axial_load_and_self_weight_soften_an_elastic_column(
    run_cli, case_text, tmp_path, read_csv
):
    """Theory section 3: (k_M - P L - m g L/2) theta = F L for one body."""
    force, load, length, mass = 1.0e4, 5.0e6, 1.6, 614.4e3
    loading = f"drive = 'force', amplitudes = {force}, points = 1"
    column = f"height = {length}, mass = {mass}, kinematics = "
    weight = 9.80665
    for kinematics, axial, lost in (
        ("small", f"axial_load = {load}, self_weight = T", 0.0),
        ("pdelta", "", 0.0),
        ("pdelta", f"axial_load = {load}", load * length),
        ("pdelta", f"axial_load = {-load}", -load * length),
        ("pdelta", f"axial_load = {load}, self_weight = .true.",
         load * length + mass * weight * length / 2),
        ("pdelta", "self_weight = t, gravity = 3.7", mass * 3.7 * length / 2),
        ("pdelta", f"axial_load = {load}, self_weight = .FALSE.", load * length),
    ):  # fmt: skip
        text = case_text(
            column=f"{column}'{kinematics}', {axial}",
            shear="rule = 'elastic', k = 7e8",
            flexure="rule = 'elastic', k = 2.5e8",
            loading=loading,
        )
        rows = run_rows(run_cli, read_csv, tmp_path, text)
        expected = force / 7e8 + force * length**2 / (2.5e8 - lost)
        assert rows["displacement_m"][1] == pytest.approx(expected, rel=1e-12)


def test_springs_of_each_joint_with_joint(run_cli, case_text, tmp_path, read_csv):
    """Flexibilities add up: F/k_V of each joint and F h^2/k_M, h the height of the top above it."""
    force = 1.0e4
    lengths = [0.4, 0.7, 0.5]
    shear, flexure = [7e8, 5e8, 6e8], [2e8, 3e8, 1e8]
    text = case_text(
        column="n = 3, height = 1.6, mass = 614.4, lengths = 0.4, 0.7, 0.5",
        shear=[
            "rule = 'elastic', joint = 3, k = 6e8",
            "rule = 'elastic', k = 5e8",  # every other joint: the second
            "rule = 'elastic', k = 7e8, joint = 1",
        ],
        flexure=[f"joint = {i + 1}, rule = 'elastic', k = {k}" for i, k in enumerate(flexure)],
        loading=f"drive = 'force', amplitudes = {force}, points = 1",
    )
    rows = run_rows(run_cli, read_csv, tmp_path, text)
    arms = np.cumsum(lengths[::-1])[::-1]
    expected = np.sum(force / np.array(shear)) + np.sum(force * arms**2 / np.array(flexure))
    assert rows["displacement_m"][1] == pytest.approx(expected, rel=1e-12)
    for i in range(3):
        assert rows[f"slip_{i + 1}_m"][1] == pytest.approx(force / shear[i], rel=1e-12)
        angle = force * arms[i] / flexure[i]
        assert rows[f"rotation_{i + 1}_rad"][1] == pytest.approx(angle, rel=1e-12)


def test_masses_and_lengths_of_each_body(run_cli, case_text, tmp_path):
    text = case_text(
        column="n = 2, height = 2, lengths = 0.5, 1.5, masses = 100, 30",
        shear=ELASTIC, flexure=ELASTIC, loading=None,
    )  # fmt: skip
    write(tmp_path, text)
    lines = run_cli(["modes", "case.nml"], tmp_path).stdout.splitlines()[1:-1]
    spring = Elastic(7e8)
    column = rbsdem.Column(2, None, spring, spring, n=2, lengths=[0.5, 1.5], masses=[100, 30])
    assert [float(line.split(",")[1]) for line in lines] == rbsdem.modes(column).frequency.tolist()


def test_damping_of_the_case_is_that_of_python(run_cli, dynamic_text, tmp_path, read_csv):
    text = dynamic_text(damping="mass = 30, stiffness = 1e-5")
    rows = run_rows(run_cli, read_csv, tmp_path, text)
    damped = rbsdem.Column(
        1.6, 614.4, BILINEAR, TAKEDA, damping=rbsdem.Damping(mass=30.0, stiffness=1e-5)
    )
    time_, ground = np.arange(17) * 0.00625, triangles([3.0], [1], 1, 4)
    run = rbsdem.time_history(damped, time_, ground_acceleration=ground, method="rk4")
    assert np.array_equal(rows["displacement_m"], run.displacement)
    assert np.array_equal(rows["damping_J"], run.energy["damping"])
    assert run.energy["damping"][-1] > 0.05 * run.energy["input"].max()


def test_console_command_hands_over_to_the_executable(case_text, tmp_path):
    """`python -m rbsdem` and the script `rbsdem` pass arguments, output and exit code on."""
    import sys  # noqa: PLC0415

    script = Path(sys.executable).with_name("rbsdem")
    write(tmp_path, case_text())
    for command in ([sys.executable, "-m", "rbsdem"], [script]):
        good = subprocess.run(
            [*command, "check", "case.nml"], cwd=tmp_path, capture_output=True, text=True,
            timeout=20, check=False,
        )  # fmt: skip
        assert (good.returncode, good.stdout, good.stderr) == (0, "case.nml: no errors\n", "")
        bad = subprocess.run(
            [*command, "chek", "case.nml"], cwd=tmp_path, capture_output=True, text=True,
            timeout=20, check=False,
        )  # fmt: skip
        assert "did you mean 'check'" in faults(bad)
