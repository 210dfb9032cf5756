"""Predicting many tests: what goes wrong is a row; summaries, the command."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from samples import printed, read_rows, write_history, write_table

import rbsdem
from rbsdem import peer
from rbsdem.cli import main
from rbsdem.errors import InputError
from rbsdem.output import measured
from rbsdem.run.rig import rig_force
from rbsdem.springs import Bilinear, Takeda

PATIENCE = 60.0
SPRINGS = {
    "shear": Bilinear(7e8, 1.3e-4, 8e6),
    "flexure": Takeda(2.5e8, 3.2e-4, 6.3e7, 2.7e-3, 7.6e6, b1=0.3),
}
TURNS = np.linspace(0.0, 4.0, 200)
PATH = 0.03 * TURNS / 4 * np.sin(2 * np.pi * TURNS)


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


@pytest.fixture
def table(tmp_path: Path) -> peer.Specimens:
    """Five tests that the column `good` gave itself, 1.1 to 1.5 times as strong; one is missing."""
    rows = [
        {
            "file": f"T{i}.csv",
            "name": f"Me {1990 + i % 2} No. {i}",
            "year": f"{1990 + i % 2}",
            "failure_mode": "Flexure" if i < 4 else "Shear",
        }
        for i in range(1, 7)
    ]
    tests = write_table(tmp_path, rows)
    force = rbsdem.cyclic(good(tests[0]), displacement=PATH).force
    for i in range(1, 6):
        write_history(tmp_path / f"T{i}.csv", PATH, (1 + i / 10) * force)
    return tests


def run(*arguments: object) -> int:
    return main(["peer", *map(str, arguments)])


def test_scores_of_a_model_that_is_a_factor_off(table):
    found = peer.predict(table, good, rig=False)
    assert [row.status for row in found] == 5 * ["completed"] + ["no history"]
    for i, row in enumerate(found[:5], 1):
        assert row.score("peak_ratio") == pytest.approx(1 / (1 + i / 10), rel=1e-6)
        assert row.score("rms_best") == pytest.approx(0.0, abs=1e-6)
        assert row.seconds > 0
    assert math.isnan(found[5].score("nrmse"))
    assert "T6.csv is not in" in found[5].error
    assert {row.model for row in found} == {"good"}
    for name in ("force", "displacement"):
        loop = rbsdem.cyclic(good(table[0]), displacement=table[0].test().displacement)
        np.testing.assert_array_equal(getattr(found[0], name), getattr(loop, name))


def test_the_rig_of_a_test_adds_its_friction(table):
    """In closed form; in predictions, and in no column."""
    test = table[0]
    column = peer.column(test)
    turn, most = 0.0005 * test.length, 0.004 * test.axial_load
    path = turn * np.array([0.0, 0.5, 1.0, 8.0, 7.5, 6.0, -3.0, -2.5, 0.0])
    of_rig = most * np.array([0.0, 0.5, 1.0, 1.0, 0.5, -1.0, -1.0, -0.5, 1.0])
    np.testing.assert_allclose(rig_force(column, path), of_rig, rtol=1e-12)
    alone = rbsdem.cyclic(column, displacement=path).force
    found = peer.predict(test, displacement=path, bands=True, samples=8)
    np.testing.assert_array_equal(found.force, alone + rig_force(column, path))
    np.testing.assert_array_equal(found.band.force, found.force)
    np.testing.assert_array_equal(peer.band(column, path, samples=8).force, alone)
    without = peer.predict(test, displacement=path, rig=False, bands=True, samples=8)
    np.testing.assert_array_equal(without.force, alone)
    np.testing.assert_array_equal(without.band.force, alone)
    own = column.drawing.parameters.with_values(rig_friction=0.006)
    made = peer.column(test, model_parameters=own)
    np.testing.assert_allclose(rig_force(made, path), 1.5 * of_rig, rtol=1e-12)
    np.testing.assert_allclose(rig_force(good(test), path), of_rig, rtol=1e-12)
    whole = rbsdem.section.column(
        column.drawing.section, 2 * test.length, axial_load=test.axial_load, top="fixed"
    )
    np.testing.assert_allclose(rig_force(whole, 2 * path), of_rig, rtol=1e-12)
    assert not np.any(rig_force(peer.column(replace(test, axial_load=0.0)), path))
    with pytest.raises(InputError, match="leave out given"):
        peer.predict(test, given=[test], rig=False)


def test_what_goes_wrong_is_a_row(table):
    found = peer.predict(table[:4], faulty)
    assert [row.status for row in found] == ["failed", "failed", "completed", "completed"]
    assert found[0].error == "section: no"
    assert found[1].error.startswith("AttributeError: ")
    # Nothing was reached: as wrong as can be, and counted.
    assert [row.score("nrmse") for row in found[:2]] == [1.0, 1.0]
    both = peer.score_summary(found).loc["all"]
    assert (both["tests"], both["failed"], both["stopped"]) == (4, 2, 0)
    text = printed(measured.tests_table(found))
    assert "failed: section: no" in text
    assert "Me 1991 No. 1" in text
    assert "Flexure" in printed(measured.summary_table(peer.score_summary(found)))
    # Of one specimen it is the error itself.
    with pytest.raises(InputError, match="section: no"):
        peer.predict(table[0], faulty)


def test_an_early_end_keeps_what_was_reached(table, monkeypatch):
    whole = rbsdem.cyclic

    def half(column, displacement, **_):
        result = whole(column, displacement=displacement[:150])
        broken = replace(result, summary={**result.summary, "status": "failed"})
        raise rbsdem.SolveError("step 150: no", broken)

    monkeypatch.setattr("rbsdem.measured.predict.cyclic", half)
    row = peer.predict(table[0], good)
    assert (row.status, row.error) == ("stopped", "step 150: no")
    assert row.comparison.rows == 150
    assert 0.3 < row.comparison.path_fraction < 1
    assert row.score("nrmse") > row.score("nrmse_reached")


def test_a_history_that_says_nothing_is_a_row(table, tmp_path):
    rows = "displacement_mm,force_kN\n0,0\n1,0\n"
    (tmp_path / "T1.csv").write_text(rows)
    (tmp_path / "T2.csv").write_text(rows.replace("1,0", "0,5"))
    (tmp_path / "T3.csv").write_text("nonsense")
    found = peer.predict(table[:4], good)
    assert [row.status for row in found] == [*3 * ["no history"], "completed"]
    for row, words in zip(
        found, ("force is 0", "displacement that changes", "T3.csv"), strict=False
    ):
        assert words in row.error


def test_warnings_are_notes(table):
    def bold(specimen):
        warnings.warn("hm", rbsdem.errors.AccuracyWarning, stacklevel=1)
        return good(specimen)

    assert peer.predict(table[0], bold).run_warnings == "hm"


def test_the_papers_model_by_name(table):
    found = peer.predict(table[:1], "paper")
    assert found[0].status == "completed", found[0].error
    column = peer.column(table[0], "paper")
    assert (column.height, column.axial_load, column.kinematics, column.n) == (
        1.6, 1.2e6, "pdelta", 1,
    )  # fmt: skip


@pytest.mark.parametrize(
    "file",
    [
        "/",
        ".",
        "..",
        "../outside.csv",
        "sub/../../outside.csv",
        "x" * 300,
        "x" * 300 + "/a",
        "a\0b",
    ],
)
def test_file_of_a_table_stays_in_its_folder(tmp_path, file):
    """A name that leads elsewhere, or nowhere, is a row without a history."""
    for path in (tmp_path / "in" / "a.csv", tmp_path / "outside.csv"):
        write_history(path, PATH, 1e7 * PATH)
    (first,) = write_table(tmp_path / "in", [{}])
    strange = replace(first, file=file)
    assert strange.path is None
    (row,) = peer.predict([strange])
    assert row.status == "no history"
    assert file.startswith("x") == ("is not in" in row.error)
    (row,) = peer.predict([replace(first, file=str(tmp_path / "outside.csv"))])
    assert "no file below the folder" in row.error


def test_summary_by_groups(table):
    found = peer.predict(table, good, limit_states=True, rig=False)
    groups = peer.score_summary(found)
    assert dict(groups["tests"]) == {"Flexure": 3, "Shear": 2, "all": 5}
    flexure = groups.loc["Flexure"]
    assert flexure["peak_ratio_median"] == pytest.approx(1 / 1.2, rel=1e-6)
    assert flexure["peak_ratio_lower"] == pytest.approx((1 / 1.2 + 1 / 1.3) / 2, rel=1e-6)
    assert list(peer.score_summary(found, "series").index) == ["Me 1991", "Me 1990", "all"]
    with pytest.raises(InputError, match="by = 'colour'"):
        peer.score_summary(found, "colour")
    rows = peer.scores(found)
    assert list(rows["status"]) == [row.status for row in found]
    assert rows["nrmse"][0] == found[0].score("nrmse")
    assert math.isnan(rows["nrmse"][5])
    states = rbsdem.cyclic(good(table[0]), displacement=PATH).limit_states()
    assert found[0].limit_states == {state.name: abs(state.drift) for state in states}
    assert rows["drift_cracking"][0] == found[0].limit_states["cracking"]
    assert "drift_cracking" not in peer.scores(peer.predict(table[:1], good))


def test_texts_of_a_table_do_no_harm(tmp_path, capsys):
    """Markup of rich, codes of terminals, templates, formulas, html: letters like others."""
    texts = ["[/bold]", "[link=x", "\x1b[31mred", "{cards}", "{{ cards }}", "=1+1", "<b>", "\\"]
    texts.append("</script><i>")
    write_history(tmp_path / "a.csv", PATH, 1e7 * PATH)
    write_table(tmp_path, [{"failure_mode": text, "name": f"{text} 1990"} for text in texts])
    out = tmp_path / "out.csv"
    assert run(tmp_path, "--model", "paper", "--out", out, "--by", "name") == 0
    shown = capsys.readouterr().out
    for text in texts:
        assert text.replace("\x1b", "?") in shown
    assert "\x1b" not in shown
    modes = [row["failure_mode"] for row in read_rows(out)]
    assert modes == [text.replace("=1+1", "'=1+1") for text in texts]


def test_command(table, tmp_path, capsys):
    out = tmp_path / "rows.csv"
    assert run(tmp_path, "--out", out, "--failure", "flexure") == 0
    text = capsys.readouterr().out
    for words in (
        "Model layered 20",
        ": 3 tests",
        "rectangular, Flexure",
        "1 of the table have no",
    ):
        assert words in text
    assert [row["file"] for row in read_rows(out)] == ["T1.csv", "T2.csv", "T3.csv"]
    # T6 is asked for by name and has no history.
    assert run(tmp_path, "--only", "T1", "Me * No. 6") == 1
    text = capsys.readouterr().out
    assert "1 of the table have no history in the folder, so no score: Me 1990 No. 6" in text
    assert "no history: " in text
    for arguments, words in (
        (["--only", "T17"], "no specimen 'T17'"),
        (["--failure", "Torsion"], "there are Flexure, Shear"),
        (["--section", "circular"], "no test is left"),
        (["--by", "colour"], "--by colour"),
    ):
        assert run(tmp_path, *arguments) == 2
        error = capsys.readouterr().err
        assert error.startswith("rbsdem: peer: ")
        assert words in error
    assert run(tmp_path / "nowhere") == 2
    assert "No such file" in capsys.readouterr().err


def test_command_whose_reader_leaves(table, tmp_path):
    """From the shell; the file is written before the report."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "rbsdem", "peer", tmp_path, "--out", tmp_path / "o.csv"],
        stdout=writer, stderr=subprocess.PIPE, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")
    assert (tmp_path / "o.csv").is_file()
