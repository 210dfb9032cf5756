"""The command `rbsdem ensemble`: records in, one row a run out, parts that come together."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import numpy as np
import pandas
import pytest
from samples import read_rows
from test_ensembles import column, motion

import rbsdem
from rbsdem.__main__ import main
from rbsdem.many import ensemble

ANALYSIS = "&analysis method = 'newmark', collapse_drift = 0.05 /\n"


def command(monkeypatch: pytest.MonkeyPatch, *words: object) -> int:
    monkeypatch.setattr(sys, "argv", ["rbsdem", "ensemble", *map(str, words)])
    return main()


@pytest.fixture
def case(tmp_path: Path) -> Path:
    """Write a case with a motion of its own, and two records."""
    time_, acceleration = motion(1)
    for name, factor in (("one", 1.0), ("two", -0.5)):
        rows = np.column_stack((time_, factor * acceleration))
        header = "time_s,acceleration_m/s2"
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header=header, comments="")
    values = ", ".join(map(str, acceleration[:50]))
    times = ", ".join(map(str, time_[:50]))
    loading = f"&loading drive = 'ground_acceleration', values = {values}, time = {times} /\n"
    path = tmp_path / "pier.nml"
    path.write_text(column().to_namelist() + loading + ANALYSIS)
    return path


def test_records_and_scales(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    records = [case.with_name(f"{name}.csv") for name in ("one", "two")]
    out = case.parent / "out"
    given = (case, *records, "--scales", "0.5,1,8", "--out", out)
    assert command(monkeypatch, *given) == 0
    told = capsys.readouterr()
    assert told.out.startswith("6 runs: ")
    assert told.err == ""
    rows = read_rows(out / "runs.csv")
    assert [row["motion"] for row in rows] == ["one"] * 3 + ["two"] * 3
    assert [row["scale"] for row in rows] == ["0.5", "1", "8"] * 2
    expected = rbsdem.ensemble(
        column(),
        rbsdem.motions.read_motion(records[1]),
        method="newmark",
        collapse_drift=0.05,
    )
    assert float(rows[4]["peak_drift"]) == pytest.approx(expected.measures["peak_drift"][0], 1e-5)
    assert command(monkeypatch, *given) == 0
    assert "6 runs, 6 of them from the store" in capsys.readouterr().out
    assert command(monkeypatch, "--status", out / "store") == 0
    alone = capsys.readouterr().out
    assert command(monkeypatch, "--status", out) == 0
    lines = capsys.readouterr().out.splitlines()
    assert alone.splitlines() == lines
    counts = pandas.read_csv(out / "runs.csv").status.value_counts()
    assert lines[0] == "6 runs: " + ", ".join(f"{n} {status}" for status, n in counts.items())
    assert lines[1].startswith("part 1 of 1: 6 runs, the last written ")
    assert command(monkeypatch, "--status", case.parent) == 2
    assert "is no store of runs" in capsys.readouterr().err


def test_the_state_of_the_case(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`&analysis initial` is where all runs begin; loads beside the motion are refused."""
    state = rbsdem.cyclic(column(), displacement=[0.03, 0.01])
    state.save_state(case.with_name("end.state"))
    text = case.read_text()
    case.write_text(text.replace("&analysis", "&analysis initial = 'end.state',"))
    out = case.parent / "out"
    assert command(monkeypatch, case, case.with_name("one.csv"), "--out", out, "--quiet") == 0
    record = rbsdem.motions.read_motion(case.with_name("one.csv"))
    given = {"method": "newmark", "collapse_drift": 0.05, "initial": state}
    expected = rbsdem.time_history(column(), ground_acceleration=record, **given)
    row = read_rows(out / "runs.csv")[0]
    assert float(row["residual_displacement"]) == pytest.approx(expected.displacement[-1], 1e-5)
    case.write_text(text + "&loading drive = 'force', values = 0, 1e3, time = 0, 1 /\n")
    assert command(monkeypatch, case, "--out", out) == 2
    assert "takes the ground motion along x of a case, no force" in capsys.readouterr().err


def test_parts(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(ensemble, "_LONGEST", 1e-4)
    out = case.parent / "out"
    scales = ",".join(map(str, range(1, 30)))
    for part in ("2/2", "1/2"):
        assert not (out / "runs.csv").exists()
        assert command(monkeypatch, case, "--scales", scales, "--out", out, "--shard", part) == 0
    assert "runs.csv is written when all parts are in" in capsys.readouterr().out
    assert len((out / "runs.csv").read_text().splitlines()) == 30


def test_cases_without_motion(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The motion is that of the case, unless it has none."""
    out = case.parent / "out"
    assert command(monkeypatch, case, "--out", out, "--quiet") == 0
    assert len(read_rows(out / "runs.csv")) == 1
    loading = "&loading drive = 'displacement', values = 0.001 /\n&analysis method = 'static' /\n"
    case.write_text(column().to_namelist() + loading)
    assert command(monkeypatch, case, "--out", out) == 2
    assert "takes no records" in capsys.readouterr().err


def test_a_case_without_loading(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its column is shaken by records; by itself it has nothing to run."""
    case.write_text(column().to_namelist() + ANALYSIS)
    record = case.with_name("one.csv")
    assert command(monkeypatch, case, record, "--out", case.parent / "out") == 0
    assert "1 runs: 1 completed" in capsys.readouterr().out
    assert command(monkeypatch, case, "--out", case.parent / "out") == 2
    assert "no ground acceleration; give records" in capsys.readouterr().err
    bare = rbsdem.read_case(case)
    assert bare.method == "newmark"
    with pytest.raises(rbsdem.InputError, match="the case has no loading"):
        bare.run()
    case.write_text(column().to_namelist())
    assert rbsdem.read_case(case).method == "auto"


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_keeps_what_is_done(
    case: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """At the second task: the exit code tells, and a second start goes on."""
    tasks, real = [], ensemble.compute

    def break_off(task: object, control: object) -> object:
        tasks.append(task)
        if len(tasks) == 2:
            os.kill(os.getpid(), signal.SIGINT)
        return real(task, control)

    monkeypatch.setattr(ensemble, "_LONGEST", 1e-6)
    monkeypatch.setattr(ensemble, "compute", break_off)
    out = case.parent / "out"
    words = (case, "--scales", ",".join(map(str, range(1, 40))), "--out", out, "--jobs", "1")
    assert command(monkeypatch, *words) == 130
    assert "not started" in capsys.readouterr().out
    assert not (out / "runs.csv").exists()
    assert command(monkeypatch, *words) == 0
    assert "of them from the store" in capsys.readouterr().out
