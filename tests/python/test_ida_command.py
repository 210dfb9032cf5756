"""The command `rbsdem ida`: files, report, exit codes, and all that is wrong before the work."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from conftest import REPOSITORY
from samples import read_rows

import rbsdem
from rbsdem import motions
from rbsdem.cli import columns, main

CASE = REPOSITORY / "examples" / "08-ida" / "case.nml"
FEW = ["--method", "newmark", "--levels", "2,6,30"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Four records as csv files."""
    place = tmp_path_factory.mktemp("records")
    for record in motions.synthetic(4):
        record.to_csv(place / f"{record.name}.csv")
    return place


def test_files_and_report(folder, tmp_path, capsys):
    out = tmp_path / "new" / "ida"
    words = [
        str(CASE),
        str(folder),
        *FEW,
        "--limit",
        "repair=0.01",
        "--limit",
        "cap",
        "--beta",
        "cap=0.4",
    ]
    assert main(["ida", *words, "--out", str(out)]) == 0
    names = ["fractiles.csv", "fragility.csv", "fragility.png", "ida.csv", "ida.png"]
    assert sorted(path.name for path in out.iterdir()) == ["contents.txt", *names, "store"]
    runs = read_rows(out / "ida.csv")
    assert len(runs) == 12
    assert {row["motion"] for row in runs} == {f"synthetic_0{i}" for i in range(1, 5)}
    found = rbsdem.ida(
        rbsdem.read_case(CASE).column, motions.synthetic(4), method="newmark", levels=[2, 6, 30]
    )
    kept = [float(row["peak_drift"]) for row in runs]
    assert sorted(kept) == pytest.approx(sorted(found.runs.measures["peak_drift"]), rel=1e-5)
    curves = {row["limit_state"]: row for row in read_rows(out / "fragility.csv")}
    repair = found.fragility("peak_drift", 0.01)
    assert float(curves["repair"]["theta_m/s2"]) == pytest.approx(repair.theta, rel=1e-5)
    assert float(curves["repair"]["beta"]) == pytest.approx(repair.beta, rel=1e-5)
    assert 6 < float(curves["cap"]["theta_m/s2"]) < 30
    assert len(read_rows(out / "fractiles.csv")) == 50
    printed = capsys.readouterr().out
    assert "Sa(0.61 s, 5 %) (m/s²): 4 records, 12 runs" in printed
    assert "repair" in printed
    assert f"wrote {out / 'ida.csv'}" in printed


def test_settings_of_the_case(folder, tmp_path, monkeypatch):
    """All of them reach the analysis, but those of its method where another one is asked for."""
    case = rbsdem.read_case(CASE)
    state = rbsdem.cyclic(case.column, displacement=[0.02, 0.0])
    state.save_state(tmp_path / "end.state")
    text = case.column.to_namelist() + (
        "&analysis method = 'hht', dt = 0.01, rho_infinity = 0.7, collapse_drift = 0.08, "
        "initial = 'end.state' /\n"
    )
    (tmp_path / "pier.nml").write_text(text)
    asked = []

    def ask(*given, **settings):
        asked.append(settings)
        raise rbsdem.InputError("enough")

    monkeypatch.setattr(columns, "run_ida", ask)
    for words in ([], ["--method", "newmark"]):
        assert main(["ida", str(tmp_path / "pier.nml"), str(folder), "--quiet", *words]) == 2
    method = {"method": "hht", "dt": 0.01, "rho_infinity": 0.7}
    common = {"collapse_drift": 0.08, "initial": str(tmp_path / "end.state")}
    assert method | common | asked[0] == asked[0]
    assert {"method": "newmark"} | common | asked[1] == asked[1]
    assert not {"dt", "rho_infinity"} & set(asked[1])


def test_hazard_adds_frequencies(folder, tmp_path, capsys):
    hazard = tmp_path / "hazard.csv"
    hazard.write_text("# a site\nsa,frequency\n0.1,1\n1,0.03\n10,0.0003\n100,1e-7\n")
    words = [str(CASE), str(folder), *FEW, "--limit", "repair=0.01", "--hazard", str(hazard)]
    assert main(["ida", *words, "--beta", "repair=0.35", "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "Per year" in printed
    line = next(line for line in printed.splitlines() if "repair" in line)
    assert (line.split()[2], line.split()[4]) == ("0.35", "-")
    assert 1e-4 < float(line.split()[-1]) < 1e-1
    two = [str(CASE), str(folder / "synthetic_01.csv"), str(folder / "synthetic_02.csv")]
    assert main(["ida", *two, "--method", "newmark", "--levels", "0.5,1,2"]) == 0
    assert "collapse: no record reached the limit state" in capsys.readouterr().out


def test_mended_records_are_told(folder, tmp_path, capsys):
    short = tmp_path / "short.AT2"
    values = "\n".join(f"{value:.5E}" for value in motions.synthetic(1)[0].acceleration)
    count = len(values.splitlines()) + 3
    head = f"PEER\nevent\nACCELERATION IN UNITS OF M/S/S\nNPTS= {count}, DT= .0100 SEC"
    short.write_text(f"{head}\n{values}\n")
    assert main(["ida", str(CASE), str(short), "synthetic:2", *FEW, "--quiet"]) == 0
    assert "rbsdem: ida: " in (told := capsys.readouterr().err)
    assert "the last 3 of NPTS" in told
    # Quiet in a pipe: nothing but what was asked for.
    assert main(["ida", str(CASE), "synthetic:2", *FEW, "--quiet"]) == 0
    assert capsys.readouterr() == ("", "")


def test_warnings_are_notes_and_helps_keep_their_lines(folder, capsys):
    """No line of a program that the user has not written; no mark of the help."""
    told = main(
        ["ida", str(CASE), str(folder), "--method", "newmark", "--levels", "2", "--dt", "2"]
    )
    said = capsys.readouterr().err
    assert told in (0, 1)
    assert all(line.startswith("rbsdem: ida: ") for line in said.splitlines())
    for name in ("trade", "ensemble", "ida", "peer", "predict", "explore", "report"):
        assert main([name, "--help"]) == 0
        text = capsys.readouterr().out
        assert "\\b" not in text
        assert re.search(r"^  (Files|Exit codes)", text, re.MULTILINE)
