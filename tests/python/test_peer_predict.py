"""Predicting many tests: rows for what goes wrong, summaries, files, and the command."""

from __future__ import annotations

import csv
import io
import json
import math
import os
import re
import signal
import subprocess
import sys
import time
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import peer, plot
from rbsdem.cli import main
from rbsdem.errors import InputError
from rbsdem.measured import predictions
from rbsdem.output import reports
from rbsdem.output.tables import write_csv
from rbsdem.springs import Bilinear, Takeda

HEADER = (
    "peer_id,file,name,author,year,section,L_mm,b_mm,h_mm,cover_mm,fc_MPa,axial_kN,n_long,"
    "db_corner_mm,n_interm_perp,n_interm_par,fy_long_MPa,db_trans_mm,s_trans_mm,fy_trans_MPa,"
    "legs_Nv,failure_mode,pdelta_code"
)
SPRINGS = {
    "shear": Bilinear(7e8, 1.3e-4, 8e6),
    "flexure": Takeda(2.5e8, 3.2e-4, 6.3e7, 2.7e-3, 7.6e6, b1=0.3),
}


def good(specimen: peer.Specimen) -> rbsdem.Column:
    return rbsdem.Column(
        specimen.length, 600.0, **SPRINGS, axial_load=specimen.axial_load, kinematics="pdelta"
    )


def faulty(specimen: peer.Specimen) -> rbsdem.Column:
    """Go wrong in the ways in which models do."""
    if specimen.peer_id == 1:
        raise InputError("section: no")
    if specimen.peer_id == 2:
        return specimen.nothing
    return good(specimen)


def deadly(specimen: peer.Specimen) -> rbsdem.Column:
    if specimen.peer_id == 1:
        os._exit(3)
    return good(specimen)


# The command with a model that does not come to an end on its third test.
ENDLESS = """
import itertools, pathlib, sys, time
from rbsdem.cli import main
from rbsdem.measured import predict

make = predict.column_of
count = itertools.count()

def endless(specimen, model):
    if next(count) == 2:
        pathlib.Path("begun").touch()
        time.sleep(60)
    return make(specimen, model)

predict.column_of = endless
raise SystemExit(main(["peer", *sys.argv[1:], "--model", "paper"]))
"""


def slow(specimen: peer.Specimen) -> rbsdem.Column:
    if specimen.peer_id == 3:
        raise KeyboardInterrupt
    return good(specimen)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Five tests that the column `good` gave itself, 1.1 to 1.5 times as strong; one is missing."""
    t = np.linspace(0.0, 4.0, 200)
    d = 0.03 * t / 4 * np.sin(2 * np.pi * t)
    lines = [HEADER]
    for i in range(1, 7):
        mode = "Flexure" if i < 4 else "Shear"
        lines.append(
            f"{i},T{i}.csv,Me {1990 + i % 2} No. {i},Me,{1990 + i % 2},rectangular,1600,400,400,13,"
            f"46.5,744,12,16,2,2,446,7,85,364,4,{mode},2"
        )
        if i < 6:
            column = rbsdem.Column(1.6, 600.0, **SPRINGS, axial_load=744e3, kinematics="pdelta")
            force = (1 + i / 10) * rbsdem.cyclic(column, displacement=d).force
            rows = np.column_stack((1e3 * d, 1e-3 * force))
            np.savetxt(
                tmp_path / f"T{i}.csv", rows, delimiter=",", header="displacement_mm,force_kN",
                comments="",
            )  # fmt: skip
    (tmp_path / "specimens.csv").write_text("\n".join(lines) + "\n")
    return tmp_path


@pytest.fixture
def table(folder) -> peer.Specimens:
    return peer.read_specimens(folder)


# ---- rows ----------------------------------------------------------------------------------------


def test_limit_states_are_columns(table, tmp_path):
    """If asked for, also of what comes from the store of an earlier start."""
    kept = tmp_path / "store"
    for _ in range(2):
        found = peer.predict(table, limit_states=True, store=kept)
        for row in found[:2]:
            path = row.specimen.test().displacement
            result = rbsdem.cyclic(peer.column(row.specimen), displacement=path, openings=True)
            states = {state.name: abs(state.drift) for state in result.limit_states()}
            assert row.limit_states == states
            assert {"cracking", "first_yield"} <= states.keys()
    assert found.resumed == 6
    record = found.to_frame().iloc[0]
    assert record["drift_first_yield"] == found[0].limit_states["first_yield"]
    assert math.isnan(record["drift_axial_failure"])
    assert "drift_first_yield" not in peer.predict(table[:1]).to_frame()


def test_scores_of_a_model_that_is_a_factor_off(table):
    found = peer.predict(table, good)
    assert [row.status for row in found] == 5 * ["completed"] + ["no history"]
    for i, row in enumerate(found[:5], 1):
        assert row.score("peak_ratio") == pytest.approx(1 / (1 + i / 10), rel=1e-6)
        assert row.score("rms_best") == pytest.approx(0.0, abs=1e-6)
        assert row.seconds >= row.seconds_analysis > 0
    assert math.isnan(found[5].nrmse)
    assert "T6.csv is not in" in found[5].error
    assert found.model == "good"


def test_what_goes_wrong_is_a_row(table):
    found = peer.predict(table[:4], faulty)
    assert [row.status for row in found] == ["failed", "failed", "completed", "completed"]
    assert found[0].error == "section: no"
    assert found[1].error.startswith("AttributeError: ")
    # Nothing was reached: as wrong as can be, and counted.
    assert [row.nrmse for row in found[:2]] == [1.0, 1.0]
    assert not found.all_completed
    both = found.summary().loc["all"]
    assert (both["tests"], both["failed"], both["stopped"]) == (4, 2, 0)


def test_an_early_end_keeps_what_was_reached(table, monkeypatch):
    whole = rbsdem.cyclic

    def half(column, displacement, **_):
        result = whole(column, displacement=displacement[:150])
        broken = replace(result, summary={**result.summary, "status": "failed"})
        raise rbsdem.SolveError("step 150: no", broken)

    monkeypatch.setattr("rbsdem.measured.predict.cyclic", half)
    row = peer.predict_one(table[0], good)
    assert (row.status, row.error) == ("stopped", "step 150: no")
    assert row.comparison.rows == 150
    assert 0.3 < row.comparison.path_fraction < 1
    assert row.nrmse > row.score("nrmse_reached")


def test_a_history_that_says_nothing_is_a_row(folder):
    rows = "displacement_mm,force_kN\n0,0\n1,0\n"
    (folder / "T1.csv").write_text(rows)
    (folder / "T2.csv").write_text(rows.replace("1,0", "0,5"))
    (folder / "T3.csv").write_text("nonsense")
    found = peer.predict(peer.read_specimens(folder)[:4], good)
    assert [row.status for row in found] == [*3 * ["no history"], "completed"]
    assert "force is 0" in found[0].error
    assert "displacement that changes" in found[1].error
    assert "T3.csv" in found[2].error


def test_warnings_are_notes(table):
    def bold(specimen):
        warnings.warn("hm", rbsdem.errors.AccuracyWarning, stacklevel=1)
        return good(specimen)

    assert peer.predict_one(table[0], bold).note == "hm"


def test_processes_give_the_same(table):
    one, two = peer.predict(table, good), peer.predict(table, good, jobs=2)
    assert [row.specimen.name for row in two] == [row.specimen.name for row in one]
    assert [row.status for row in two] == [row.status for row in one]
    assert [row.nrmse for row in two[:5]] == [row.nrmse for row in one[:5]]


def test_a_process_that_dies_is_rows_too(folder):
    table = peer.read_specimens(folder)
    found = peer.predict(table, deadly, jobs=2)
    # Its neighbours go on.
    assert [row.status for row in found] == ["failed", *4 * ["completed"], "no history"]
    assert "process died" in found[0].error
    assert found[0].nrmse == 1.0
    assert found.summary().loc["all", "failed"] == 1


def test_a_model_that_cannot_be_sent_is_refused(table):
    with pytest.raises(InputError, match="take jobs = 1"):
        peer.predict(table, lambda specimen: good(specimen[0]), jobs=2)


def test_broken_off_keeps_what_is_done(table):
    found = peer.predict(table, slow)
    assert found.interrupted
    assert [row.specimen.peer_id for row in found] == [1, 2]
    assert not found.all_completed


def test_the_papers_model_by_name(table):
    found = peer.predict(table[:1], "paper")
    assert found[0].status == "completed", found[0].error
    assert found[0].seconds_model > 0
    with pytest.raises(InputError, match="not known"):
        peer.column(table[0], "nonsense")
    column = peer.column(table[0], "paper")
    assert (column.height, column.axial_load, column.kinematics) == (1.6, 744e3, "pdelta")
    assert column.n == 1


# ---- summaries and files -------------------------------------------------------------------------


def test_summary_by_groups(table):
    found = peer.predict(table, good)
    groups = found.summary()
    assert dict(groups["tests"]) == {"Flexure": 3, "Shear": 2, "all": 5}
    flexure = groups.loc["Flexure"]
    assert flexure["peak_ratio_median"] == pytest.approx(1 / 1.2, rel=1e-6)
    assert flexure["peak_ratio_lower"] == pytest.approx((1 / 1.2 + 1 / 1.3) / 2, rel=1e-6)
    assert list(found.summary("series").index) == ["Me 1991", "Me 1990", "all"]
    with pytest.raises(InputError, match="by = 'colour'"):
        found.summary("colour")


def test_worst_and_names(table):
    found = peer.predict(table, good)
    assert [row.specimen.peer_id for row in found.worst(2)] == [5, 4]
    assert found["T2"].specimen.peer_id == 2
    with pytest.raises(InputError, match="no prediction of 'T9'"):
        found["T9"]


def test_csv_files(table, tmp_path):
    found = peer.predict(table, good)
    write_csv(found.to_frame(), tmp_path / "results.csv")
    write_csv(found.summary().reset_index(), tmp_path / "summary.csv")
    found.loops_to_csv(tmp_path / "loops")
    with (tmp_path / "results.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == [row.status for row in found]
    assert float(rows[0]["nrmse"]) == pytest.approx(found[0].nrmse, rel=1e-5)
    assert rows[5]["nrmse"] == ""
    with (tmp_path / "summary.csv").open() as file:
        last = list(csv.DictReader(file))[-1]
    assert (last["failure_mode"], last["tests"]) == ("all", "5")
    assert len(list((tmp_path / "loops").iterdir())) == 5
    loop = np.loadtxt(tmp_path / "loops" / "T1.csv", delimiter=",", skiprows=1)
    assert loop[:, 2] == pytest.approx(found[0].comparison.model_force, rel=1e-5, abs=1)


def data_of(page: str) -> dict:
    """Return what a page of all loops has inside."""
    (packed,) = re.findall(r'<script type="application/json" id="report">(.*?)</script>', page)
    return json.loads(packed)


def test_gallery_is_one_page_that_needs_nothing_else(table, tmp_path):
    page = peer.gallery(peer.predict(table, faulty), tmp_path / "new" / "page.html").read_text()
    tests = data_of(page)["tests"]
    assert len(tests) == 6
    assert sum("test" in test for test in tests) == 5
    assert sum(bool(test.get("model")) for test in tests) == 3
    assert any("section: no" in test["error"] for test in tests)
    assert not re.search(r"(?:src|href)=(?!\"data:)|https?://(?!www\.w3)|@import", page)
    # Every point is inside the picture, which is a thousand wide and high on each side.
    assert max(abs(x) for test in tests for x in test.get("test", [])) == 1000


def test_texts_in_the_gallery_are_data(tmp_path):
    """Neither html nor the end of a script."""
    specimen = peer.Specimen("<b>&", "rectangular", 1.0, 1.0, 1.0, 3e7, 0.0, 4)
    page = peer.Predictions(
        [peer.Prediction(specimen, "m", "no history", error="</script><i>{{ title }}")]
    )
    text = peer.gallery(page, tmp_path / "page.html").read_text()
    assert "<b>" not in text
    assert "<i>" not in text
    (test,) = data_of(text)["tests"]
    assert (test["name"], test["error"]) == ("<b>&", "</script><i>{{ title }}")


def test_gallery_and_contact_sheet_draw_the_same_lines(table):
    found = peer.predict(table, good)
    assert found.pictures is found.pictures
    for row, drawn in zip(found, found.pictures, strict=True):
        assert (drawn is None) == (row.comparison is None)
        if drawn is not None:
            assert np.max(np.abs(drawn.test)) <= 1.0
            assert np.max(np.abs(drawn.model)) <= 1.08
            assert drawn.displacement == np.max(np.abs(row.comparison.displacement))


def test_thinned_lines_stay_where_they_were():
    t = np.linspace(0.0, 6.0, 3000)
    line = np.column_stack((600 + 500 * np.sin(t), 400 + 300 * np.sin(2.1 * t)))
    thin = predictions.thinned(line, 1.0)
    assert len(thin) < len(line) / 10
    assert thin[0].tolist() == line[0].tolist()
    assert thin[-1].tolist() == line[-1].tolist()
    start, way = thin[:-1], np.diff(thin, axis=0)
    for point in line[::50]:
        share = np.sum((point - start) * way, axis=1) / np.sum(way * way, axis=1)
        nearest = start + np.clip(share, 0, 1)[:, None] * way
        assert np.min(np.hypot(*(point - nearest).T)) < 4.0


@pytest.mark.parametrize("m", [0, 1, 2, 3])
def test_short_lines_are_not_thinned_away(m):
    line = np.arange(2.0 * m).reshape(m, 2) ** 2
    assert len(predictions.thinned(line, 1.0)) == m


def test_contact_sheet(table, tmp_path):
    pytest.importorskip("matplotlib")
    file = plot.contact_sheet(peer.predict(table, faulty), tmp_path / "loops.png")
    assert file.read_bytes()[:4] == b"\x89PNG"


def test_tables(table):
    console = pytest.importorskip("rich.console")
    found = peer.predict(table, faulty)
    out = console.Console(width=200, record=True, file=io.StringIO())
    out.print(reports.tests_table(found))
    out.print(reports.summary_table(found, "failure_mode"))
    text = out.export_text()
    assert "failed: section: no" in text
    assert "Me 1991 No. 1" in text
    assert text.count("Flexure") == 4


# ---- the command ---------------------------------------------------------------------------------


def run(*arguments: str | Path) -> tuple[int, list[str]]:
    """Run the command in this process; return its code."""
    return main(["peer", *map(str, arguments)])


def test_command(folder, tmp_path, capsys):
    pytest.importorskip("matplotlib")
    out = tmp_path / "out"
    assert run(folder, "--jobs", "1", "--out", out, "--loops", "--failure", "flexure") == 0
    text = capsys.readouterr().out
    assert "Me 1991 No. 1" in text
    assert "Model layered 2026.5: 3 tests in" in text
    assert "rectangular, Flexure" in text
    names = {path.name for path in out.iterdir()}
    assert names == {"results.csv", "summary.csv", "gallery.html", "loops.png", "loops"}


def test_command_says_by_its_code_that_a_test_failed(folder, capsys):
    # T6 is asked for by name and has no history.
    assert run(folder, "--jobs", "1", "--only", "T1", "Me * No. 6") == 1
    assert "no history" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--only", "T17"], "no specimen 'T17'"),
        (["--failure", "Torsion"], "there are Flexure, Shear"),
        (["--section", "circular"], "no test is left"),
        (["--by", "colour"], "--by colour"),
        (["--jobs", "0"], "jobs = 0"),
        (["--loops"], "--out"),
    ],
)
def test_bad_requests_of_the_command(folder, capsys, arguments, words):
    assert run(folder, *arguments) == 2
    error = capsys.readouterr().err
    assert error.startswith("rbsdem: peer: ")
    assert words in error


def test_command_without_its_folder(tmp_path, capsys):
    assert run(tmp_path / "nowhere") == 2
    assert "No such file" in capsys.readouterr().err


def test_command_as_a_program(folder, tmp_path):
    """Two processes, from the shell."""
    done = subprocess.run(
        [sys.executable, "-m", "rbsdem", "peer", folder, "--jobs", "2", "--quiet"],
        capture_output=True, text=True, timeout=60, check=False, cwd=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    assert "5 tests in" in done.stdout


@pytest.mark.skipif(os.name == "nt", reason="signals")
def test_command_broken_off(tmp_path, peer_folder):
    """An interrupt of the keyboard ends it soon, with what is done."""
    running = subprocess.Popen(
        [sys.executable, "-c", ENDLESS, "--jobs", "1", "--quiet", peer_folder],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=tmp_path,
    )  # fmt: skip
    begun = tmp_path / "begun"
    deadline = time.monotonic() + 60
    while not begun.exists() and running.poll() is None and time.monotonic() < deadline:
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    out, error = running.communicate(timeout=30)
    assert running.returncode == 130, error
    assert "Traceback" not in error
    assert "interrupted after 2 of" in error
    assert "paper" in out
