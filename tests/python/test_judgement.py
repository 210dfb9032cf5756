"""One case file from drawings to acceptance and a report: by the command and in Python."""

import subprocess
import sys

import numpy as np
import pytest
from test_grids import CASE

import rbsdem
from rbsdem.codes import DesignSpectrum, assess, judge, target

ASKED = """\
&target method = 'en_1998', spectrum = 'en_1998', ag = 0.15, soil = 'C' /
&assess code = 'en_1998_3', level = 'SD' /
&assess code = 'asce_41', knowledge = 0.75 /
"""
HOUSE = CASE.replace("values = 0.05 /", "values = 0.15 /") + ASKED

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")


@pytest.fixture
def house(tmp_path):
    path = tmp_path / "house.nml"
    path.write_text(HOUSE)
    return path


def command(*words, folder=None):
    words = [sys.executable, "-m", "rbsdem", *map(str, words)]
    return subprocess.run(
        words, capture_output=True, text=True, timeout=120, check=False, cwd=folder
    )


def test_a_case_asks_for_what_the_functions_do(house):
    case = rbsdem.read_case(house)
    found = judge(case)
    push = rbsdem.pushover(case.column, displacement=0.15)
    point = target(push, DesignSpectrum.en_1998(0.15, "C"), "en_1998")
    assert found.target.displacement == point.displacement
    assert found.levels == ["SD", "CP"]
    for made, hand in zip(
        found.assessments,
        (assess(push, "en_1998_3", at=point), assess(push, "asce_41", at=point, knowledge=0.75)),
        strict=True,
    ):
        np.testing.assert_array_equal(
            made.to_pandas().select_dtypes("number"), hand.to_pandas().select_dtypes("number")
        )
    # What it asks for is part of the case.
    house.write_text(case.to_namelist())
    assert rbsdem.read_case(house) == case


def test_one_command_makes_rows_target_acceptance_and_report(house):
    assert command("check", house).stdout.startswith(f"{house}: no errors\n")
    done = command("run", "house.nml", "--report", folder=house.parent)
    assert done.returncode == 0, done.stderr
    assert "Target(en_1998" in done.stdout
    assert "accepted at SD" in done.stdout
    assert "rows in" in done.stdout
    assert (house.parent / "house.csv").is_file()
    page = (house.parent / "house.html").read_text()
    assert "Target displacement" in page
    assert (house.parent / "house_files" / "all_members.csv").is_file()


def test_the_executable_alone_says_what_to_type(house, run_cli):
    line = 1 + HOUSE[: HOUSE.index("&drawing")].count("\n")
    done = run_cli(["run", house])
    assert done.returncode == 2
    assert f"line {line}" in done.stderr
    assert "rbsdem draw CASE.nml" in done.stderr


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ag = 0.15, ", "", "target: ag is missing"),
        ("ag = 0.15", "ag = 15", "target: ag = 15"),
        ("soil = 'C'", "soil = 'C', s_xs = 1.0", "target: s_xs is not of spectrum"),
        ("soil = 'C'", "soil = 'Q'", "soil"),
        ("level = 'SD'", "level = 'LS'", "level = 'LS' is none of en_1998_3"),
        ("method = 'en_1998'", "method = 'n2'", "'n2' is not known"),
        ("&assess code = 'asce_41', knowledge = 0.75", "&records units = 'g'", "path is missing"),
    ],
)
def test_what_is_wrong_is_told_by_check_and_by_run(house, old, new, words):
    assert old in HOUSE
    house.write_text(HOUSE.replace(old, new, 1))
    for name in ("check", "run"):
        done = command(name, house)
        assert done.returncode == 2
        assert words in done.stderr
    assert not (house.parent / "house.csv").exists()
