"""One case file from drawings to acceptance and a report: by the command and in Python."""

import numpy as np
import pytest
from test_building import B, C
from test_grids import CASE

import rbsdem
from rbsdem import plot
from rbsdem.codes import DesignSpectrum, assess, check_target, judge, target
from rbsdem.many.judgement import response

ASKED = """\
&target method = 'en_1998', spectrum = 'en_1998', ag = 0.15, soil = 'C' /
&assess code = 'en_1998_3', level = 'SD' /
&assess code = 'asce_41', knowledge = 0.75 /
"""
LAST = ASKED.splitlines(keepends=True)[-1]
HOUSE = CASE.replace("values = 0.05 /", "values = 0.15 /") + ASKED

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")


@pytest.fixture
def house(tmp_path):
    path = tmp_path / "house.nml"
    path.write_text(HOUSE)
    return path


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


@pytest.mark.parametrize("method", [None, "static", "newton"])
def test_a_method_that_the_file_names_is_that_of_its_push_over(house, monkeypatch, method):
    if method:
        house.write_text(HOUSE + f"&analysis method = '{method}' /\n")
    monkeypatch.setattr("rbsdem.many.judgement.pushover", lambda _, **how: how["method"])
    case = rbsdem.read_case(house)
    assert response(case) == method
    assert case.method == (method or "static")
    house.write_text(case.to_namelist())
    assert response(rbsdem.read_case(house)) == method


@pytest.mark.usefixtures("without_figures")
def test_one_command_makes_rows_target_acceptance_and_report(house, command):
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


def test_records_and_limits_of_a_case_are_those_of_the_functions(house):
    folder = house.parent / "records"
    folder.mkdir()
    time = np.arange(0.0, 1.2, 0.02)
    for name, period in (("one", 0.4), ("two", 0.7)):
        pulse = 0.2 * np.sin(2 * np.pi * time / period)
        np.savetxt(folder / f"{name}.csv", np.column_stack((time, pulse)), delimiter=",")
    asked = "&records path = 'records', units = 'g' /\n"
    asked += "&limit member = 'C-*-1', rotations = 0.01, 0.02, 0.03, code = 'asce_41' /\n"
    asked += "&limit member = 'C-1-1', rotations = 0.001, 0.002, 0.003 /\n"
    house.write_text(HOUSE + asked)
    case = rbsdem.read_case(house)
    found = judge(case)
    push = rbsdem.pushover(case.column, displacement=0.15)
    point = target(push, DesignSpectrum.en_1998(0.15, "C"), "en_1998")
    hand = check_target(point, rbsdem.motions.read_motions(folder, "g"), progress=False)
    assert list(found.check.record) == ["one", "two"]
    np.testing.assert_array_equal(found.check.storey_drift, hand.storey_drift)
    np.testing.assert_array_equal(found.check.factor, hand.factor)
    near, far = (0.001, 0.002, 0.003), (0.01, 0.02, 0.03)
    european, american = found.assessments
    assert {row["limit_DL_rad"] for row in european.rows if row["member"] == "C-1-1"} == {0.001}
    assert {row["source"] for row in european.rows if row["member"] == "C-2-1"} != {
        "limits that were given"
    }
    limits = {"C-*-1": far, "C-1-1": near}
    same = assess(push, "asce_41", at=point, knowledge=0.75, limits=limits)
    np.testing.assert_array_equal(
        american.to_pandas().select_dtypes("number"), same.to_pandas().select_dtypes("number")
    )
    house.write_text(case.to_namelist())
    assert rbsdem.read_case(house) == case
    assert repr(hand) in str(found)


def test_words_of_lines_come_back(house):
    text = rbsdem.read_case(house).to_namelist()
    assert "&node_load lines = 'outer', load = 25000 /" in text
    assert "&column_of lines = 'inner', storey = 3, kind = 'section-1' /" in text


def test_the_executable_alone_says_what_to_type(house, run_cli):
    line = 1 + HOUSE[: HOUSE.index("&drawing")].count("\n")
    done = run_cli(["run", house])
    assert done.returncode == 2
    assert f"line {line}" in done.stderr
    assert "rbsdem draw CASE.nml" in done.stderr
    # A case of springs is solved, and what is left to do is said.
    springs = house.with_name("springs.nml")
    springs.write_text(rbsdem.read_case(house).to_namelist(springs=True))
    done = run_cli(["run", springs])
    assert done.returncode == 0
    assert f"python -m rbsdem run {springs}" in done.stdout
    assert "--report[=FILE]" in run_cli(["run", "--help"]).stdout


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("ag = 0.15, ", "", "target: ag is missing"),
        ("ag = 0.15", "ag = 15", "target: ag = 15"),
        ("soil = 'C'", "soil = 'C', s_xs = 1.0", "target: s_xs is not of spectrum"),
        ("soil = 'C'", "soil = 'Q'", "soil"),
        ("level = 'SD'", "level = 'LS'", "level = 'LS' is none of en_1998_3"),
        ("method = 'en_1998'", "method = 'n2'", "'n2' is not known"),
        (LAST, "&records path = 'a.csv' /\n", "is not there"),
        (
            LAST,
            "&limit member = 'N-*', rotations = 0.1, 0.2, 0.3 /\n",
            "limits of 'N-*': no member",
        ),
        ("method = 'en_1998', ", "", "target: method is missing; it is one of asce_41, en_1998"),
        ("spectrum = 'en_1998', ", "", "target: spectrum is missing; it is one of en_1998"),
        ("code = 'asce_41', ", "", "assess: code is missing; it is one of asce_41"),
        (LAST, "&limit member = 'C' /\n", "rotations is missing"),
        (LAST, "&records units = 'g' /\n", "path is missing"),
    ],
)
def test_what_is_wrong_is_told_by_check_and_by_run(house, old, new, words, *, command):
    assert old in HOUSE
    house.write_text(HOUSE.replace(old, new, 1))
    for name in ("check", "run"):
        done = command(name, house)
        assert done.returncode == 2
        assert words in done.stderr
    assert not (house.parent / "house.csv").exists()


@pytest.mark.usefixtures("without_figures")
def test_a_building_is_judged_by_its_case(tmp_path, command):
    drawn = rbsdem.Building.grid(
        [3.2], [5.0], [5.0], columns=C, beams_x=B, beams_y=B, floor_load=9e3, mass="from_loads",
        eccentricity=(0.1, 0.1), kinematics="pdelta", direction=30.0, damping=0.05,
    )  # fmt: skip
    time = np.arange(0.0, 1.2, 0.02)
    pulse = 0.2 * np.sin(2 * np.pi * time / 0.4)
    np.savetxt(tmp_path / "pulse.csv", np.column_stack((time, pulse)), delimiter=",")
    asked = "&loading drive = 'displacement', values = 0.08 /\n" + ASKED
    asked += "&records path = 'pulse.csv', units = 'g' /\n"
    asked += "&limit member = 'x-1:C-1-*', rotations = 0.001, 0.002, 0.003 /\n"
    path = tmp_path / "plan.nml"
    path.write_text(drawn.to_namelist() + asked)
    case = rbsdem.read_case(path)
    found = judge(case)
    push = rbsdem.pushover(drawn, displacement=0.08)
    point = target(push, DesignSpectrum.en_1998(0.15, "C"), "en_1998")
    hand = assess(push, "en_1998_3", at=point, limits={"x-1:C-1-*": (0.001, 0.002, 0.003)})
    assert found.target.displacement == point.displacement
    european = found.assessments[0]
    np.testing.assert_array_equal(
        european.to_pandas().select_dtypes("number"), hand.to_pandas().select_dtypes("number")
    )
    # The record acts along the push: its frames drift as under its two parts.
    shaken = rbsdem.time_history(
        drawn, tuple(
            rbsdem.GroundMotion(found.check.factor[0] * part * 9.80665 * pulse, 0.02)
            for part in np.array([3**0.5, 1.0]) / 2.0
        ), method="newmark", dt=0.01,
    )  # fmt: skip
    drifts = [np.abs(frame.storey_drift).max() for frame in shaken.frames.values()]
    assert found.check.storey_drift[0, 0] == pytest.approx(max(drifts), rel=1e-9)
    there = np.interp(point.signed, push.displacement, np.arange(push.displacement.size))
    amplified = [
        point.torsion.get(name, 1.0) * np.interp(there, np.arange(push.displacement.size), drift)
        for name, frame in push.frames.items()
        for drift in np.abs(frame.storey_drift - frame.storey_drift[0]).T
    ]
    assert found.check.estimated_storey_drift == pytest.approx([max(amplified)], rel=1e-9)
    # One frame of what was found: figures and the report take it.
    part = european.frame("x-2")
    ends = {row["member"] for row in part.rows}
    assert ends >= set(push.frame("x-2").frame.parts.members)
    plot.assessment(part)
    more = {"target": point, "check": found.check}
    text = rbsdem.report(european, tmp_path / "plan.html", **more).read_text()
    for heading in ("Error of the target", "Building", "y-2 Storeys", "y-2 Members"):
        assert f"<h2>{heading}</h2>" in text
    done = command("run", path, "--quiet")
    assert done.returncode == 0, done.stderr
    path.write_text(case.to_namelist())
    assert rbsdem.read_case(path) == case
