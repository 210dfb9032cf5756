"""Predicting many tests: what goes wrong is a row; summaries, files, the store, the command."""

from __future__ import annotations

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
from samples import printed, read_rows, write_history, write_table

import rbsdem
from rbsdem import peer
from rbsdem._files import save_frame
from rbsdem.cli import main
from rbsdem.errors import InputError
from rbsdem.measured import predict, predictions
from rbsdem.measured.predictions import PredictionStore
from rbsdem.output import measured
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


def deadly(specimen: peer.Specimen) -> rbsdem.Column:
    if specimen.peer_id == 1:
        os._exit(3)
    return good(specimen)


def slow(specimen: peer.Specimen) -> rbsdem.Column:
    if specimen.peer_id == 3:
        raise KeyboardInterrupt
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


def record(row: peer.Prediction) -> str:
    return repr(peer.Predictions([row]).to_pandas().iloc[0].to_dict())


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
    two = peer.predict(table, good, jobs=2)
    keys = [(row.specimen.name, row.status, repr(row.nrmse)) for row in found]
    assert [(row.specimen.name, row.status, repr(row.nrmse)) for row in two] == keys
    with pytest.raises(InputError, match="take jobs = 1"):
        peer.predict(table, lambda specimen: good(specimen[0]), jobs=2)
    assert [row.specimen.peer_id for row in found.worst(2)] == [5, 4]
    assert found["T2"].specimen.peer_id == 2
    with pytest.raises(InputError, match="no prediction of 'T9'"):
        found["T9"]


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
    text = printed(measured.tests_table(found))
    assert "failed: section: no" in text
    assert "Me 1991 No. 1" in text
    assert "Flexure" in printed(measured.summary_table(found, "failure_mode"))
    # A process that dies is one too; its neighbours go on.
    found = peer.predict(table, deadly, jobs=2)
    assert [row.status for row in found] == ["failed", *4 * ["completed"], "no history"]
    assert "process died" in found[0].error
    assert found[0].nrmse == 1.0
    # Broken off by the keyboard, what is done is kept.
    found = peer.predict(table, slow)
    assert [row.specimen.peer_id for row in found] == [1, 2]
    assert found.interrupted
    assert not found.all_completed


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

    assert peer.predict_one(table[0], bold).note == "hm"


def test_the_papers_model_by_name(table):
    found = peer.predict(table[:1], "paper")
    assert found[0].status == "completed", found[0].error
    assert found[0].seconds_model > 0
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
    row = peer.predict_one(strange)
    assert row.status == "no history"
    assert file.startswith("x") == ("is not in" in row.error)
    row = peer.predict_one(replace(first, file=str(tmp_path / "outside.csv")))
    assert "no file below the folder" in row.error


def test_summary_by_groups_and_files(table, tmp_path):
    found = peer.predict(table, good)
    groups = found.summary()
    assert dict(groups["tests"]) == {"Flexure": 3, "Shear": 2, "all": 5}
    flexure = groups.loc["Flexure"]
    assert flexure["peak_ratio_median"] == pytest.approx(1 / 1.2, rel=1e-6)
    assert flexure["peak_ratio_lower"] == pytest.approx((1 / 1.2 + 1 / 1.3) / 2, rel=1e-6)
    assert list(found.summary("series").index) == ["Me 1991", "Me 1990", "all"]
    with pytest.raises(InputError, match="by = 'colour'"):
        found.summary("colour")
    found.to_csv(tmp_path / "results.csv")
    save_frame(groups.reset_index(), tmp_path / "summary.csv")
    found.loops_to_csv(tmp_path / "loops")
    rows = read_rows(tmp_path / "results.csv")
    assert [row["status"] for row in rows] == [row.status for row in found]
    assert float(rows[0]["nrmse"]) == pytest.approx(found[0].nrmse, rel=1e-5)
    assert rows[5]["nrmse"] == ""
    last = read_rows(tmp_path / "summary.csv")[-1]
    assert (last["failure_mode"], last["tests"]) == ("all", "5")
    assert len(list((tmp_path / "loops").iterdir())) == 5
    loop = np.loadtxt(tmp_path / "loops" / "T1.csv", delimiter=",", skiprows=1)
    assert loop[:, 2] == pytest.approx(found[0].comparison.model_force, rel=1e-5, abs=1)


def data_of(page: str) -> list[dict]:
    """Return the tests that a page of all loops has inside."""
    (packed,) = re.findall(r'<script type="application/json" id="report">(.*?)</script>', page)
    return json.loads(packed)["tests"]


def test_gallery_is_one_page_that_needs_nothing_else(table, tmp_path):
    found = peer.predict(table, faulty)
    page = peer.gallery(found, tmp_path / "new" / "page.html").read_text()
    tests = data_of(page)
    assert len(tests) == 6
    assert sum("test" in test for test in tests) == 5
    assert sum(bool(test.get("model")) for test in tests) == 3
    assert any("section: no" in test["error"] for test in tests)
    assert not re.search(r"(?:src|href)=(?!\"data:)|https?://(?!www\.w3)|@import", page)
    # Every point is inside the picture, which is a thousand wide and high on each side.
    assert max(abs(x) for test in tests for x in test.get("test", [])) == 1000
    for row, drawn in zip(found, found.pictures, strict=True):
        assert (drawn is None) == (row.comparison is None)
        if drawn is not None:
            assert np.max(np.abs(drawn.test)) <= 1.0
            assert drawn.displacement == np.max(np.abs(row.comparison.displacement))


def test_thinned_lines_stay_where_they_were():
    t = np.linspace(0.0, 6.0, 3000)
    line = np.column_stack((600 + 500 * np.sin(t), 400 + 300 * np.sin(2.1 * t)))
    thin = predictions.thinned(line, 1.0)
    assert len(thin) < len(line) / 10
    assert thin[[0, -1]].tolist() == line[[0, -1]].tolist()
    start, way = thin[:-1], np.diff(thin, axis=0)
    for point in line[::50]:
        share = np.sum((point - start) * way, axis=1) / np.sum(way * way, axis=1)
        nearest = start + np.clip(share, 0, 1)[:, None] * way
        assert np.min(np.hypot(*(point - nearest).T)) < 4.0
    for m in range(4):
        assert len(predictions.thinned(np.arange(2.0 * m).reshape(m, 2) ** 2, 1.0)) == m


def test_texts_of_a_table_do_no_harm(tmp_path, capsys):
    """Markup of rich, codes of terminals, templates, formulas, html: letters like others."""
    texts = ["[/bold]", "[link=x", "\x1b[31mred", "{cards}", "{{ cards }}", "=1+1", "<b>", "\\"]
    texts.append("</script><i>")
    write_history(tmp_path / "a.csv", PATH, 1e7 * PATH)
    write_table(tmp_path, [{"failure_mode": text, "name": f"{text} 1990"} for text in texts])
    out = tmp_path / "out"
    assert run(tmp_path, "--model", "paper", "--jobs", "1", "--out", out, "--by", "name") == 0
    shown = capsys.readouterr().out
    for text in texts:
        assert text.replace("\x1b", "?") in shown
    assert "\x1b" not in shown
    page = (out / "gallery.html").read_text()
    assert "<b>" not in page
    assert "<i>" not in page
    assert [test["name"] for test in data_of(page)] == [f"{text} 1990" for text in texts]
    modes = [row["failure_mode"] for row in read_rows(out / "results.csv")]
    assert modes == [text.replace("=1+1", "'=1+1") for text in texts]
    assert "'=1+1 1990" in [row["name"] for row in read_rows(out / "summary.csv")]


def test_loops_of_files_with_one_name_are_apart(tmp_path):
    """Their path below the folder is kept; what would still be the same gets a number."""
    files = ["a.csv", "sub/a.csv", "A.csv", "a.txt", "a.csv", "sub/deep/No. 7", "w:x?.csv"]
    for i, file in enumerate(files):
        write_history(tmp_path / file, PATH, (1 + i) * 1e7 * PATH)
    tests = write_table(tmp_path, [{"file": file} for file in files])
    found = peer.predict(tests, "paper")
    assert {row.status for row in found} == {"completed"}
    loops = tmp_path / "loops"
    found.loops_to_csv(loops)
    written = {path.relative_to(loops).as_posix() for path in loops.rglob("*.csv")}
    assert written == {
        "a.csv", "sub/a.csv", "A_2.csv", "a_3.csv", "a_4.csv", "sub/deep/No. 7.csv", "w_x_.csv"
    }  # fmt: skip
    loop = np.loadtxt(loops / "sub" / "a.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(loop[:, 1], found[1].comparison.test_force, rtol=1e-6)


def test_second_start_goes_on(table, tmp_path, monkeypatch):
    """What is in the store comes back bit for bit, limit states too, and only the rest is done."""
    given = {"store": tmp_path / "store", "limit_states": True}
    first = peer.predict(table[3:], **given)
    assert first.resumed == 0
    done = []
    one = predict.predict_one
    monkeypatch.setattr(
        predict, "predict_one", lambda s, *a, **o: done.append(s.peer_id) or one(s, *a, **o)
    )
    whole = peer.predict(table[2:], **given)
    assert (done, whole.resumed) == ([3], 3)
    assert [record(row) for row in whole[1:]] == [record(row) for row in first]
    for row, before in zip(whole[1:3], first, strict=False):
        assert np.array_equal(row.comparison.model_force, before.comparison.model_force)
        assert row.comparison.nrmse == before.comparison.nrmse
        path = row.specimen.test().displacement
        result = rbsdem.cyclic(peer.column(row.specimen), displacement=path, openings=True)
        states = {state.name: abs(state.drift) for state in result.limit_states()}
        assert row.limit_states == states
        assert {"cracking", "first_yield"} <= states.keys()
    cells = whole.to_pandas().iloc[1]
    assert cells["drift_first_yield"] == first[0].limit_states["first_yield"]
    assert math.isnan(cells["drift_axial_failure"])
    assert "drift_first_yield" not in peer.predict(table[:1]).to_pandas()


def test_what_has_changed_is_done_again(table, tmp_path):
    folder = tmp_path / "store"

    def resumed(tests: peer.Specimens, model: str = "paper", **more: object) -> int:
        return peer.predict(tests[:1], model, store=folder, **more).resumed

    assert [resumed(table) for _ in range(2)] == [0, 1]
    assert resumed(table, "layered") == 0
    assert resumed(table, n=2) == 0
    write_history(tmp_path / "T1.csv", PATH, 1e7 * PATH)
    assert [resumed(table) for _ in range(2)] == [0, 1]
    changed = write_table(tmp_path, [{"file": "T1.csv", "fc_MPa": "46.6"}])
    assert resumed(changed) == 0
    with pytest.raises(InputError, match="is a function"):
        peer.predict(table, lambda specimen: None, store=tmp_path / "j")
    # Lines of other batches are kept.
    found = peer.predict(changed[:1], "paper", n=2, store=folder)
    PredictionStore(folder, changed[:1], found.model, {}).forget()
    assert [resumed(changed, n=2), resumed(changed)] == [1, 0]
    peer.predict(changed[:1], "paper", store=tmp_path / "one")
    PredictionStore(tmp_path / "one", changed[:1], found.model, {}).forget()
    assert not (tmp_path / "one").exists()


# The command, whose workers wait in their second test.
WAITING = """
import os, pathlib, sys, time
from rbsdem.cli import main
from rbsdem.measured import predict

one = predict.predict_one

def waiting(specimen, model, **options):
    if specimen.peer_id > 1:
        pathlib.Path(f"worker-{os.getpid()}").touch()
        time.sleep(60)
    return one(specimen, model, **options)

predict.predict_one = waiting
if __name__ == "__main__":
    raise SystemExit(main(["peer", *sys.argv[1:]]))
"""


def is_alive(number: int) -> bool:
    try:
        status = Path(f"/proc/{number}/status").read_text()
    except OSError:
        return False
    return not re.search(r"^State:\s+Z", status, re.M)


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize(
    ("number", "jobs"), [(signal.SIGKILL, 3), (signal.SIGTERM, 3), (signal.SIGINT, 1)]
)
def test_killed_batch_leaves_no_process_and_goes_on(table, tmp_path, number, jobs, capsys):
    """The workers end with the main process; what was finished is taken over by the next start."""
    (tmp_path / "waiting.py").write_text(WAITING)
    arguments = [tmp_path, "--model", "paper", "--quiet", "--out", tmp_path / "out"]
    words = [sys.executable, "waiting.py", *arguments, "--jobs", f"{jobs}"]
    running = subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    shards = tmp_path / "out" / "unfinished" / "shards"
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and running.poll() is None:
        workers = [int(p.name[7:]) for p in tmp_path.glob("worker-*")]
        if len(workers) >= min(jobs, 2) and (jobs == 1 or list(shards.glob("*.jsonl"))):
            break
        time.sleep(0.02)
    running.send_signal(number)
    code = running.wait(PATIENCE)
    assert code == (-number if number == signal.SIGKILL else 128 + number)
    while any(map(is_alive, workers)) and time.monotonic() < deadline:
        time.sleep(0.02)
    assert not any(map(is_alive, workers))
    error = running.stderr.read()
    running.stderr.close()
    assert "Traceback" not in error
    assert number != signal.SIGINT or "interrupted after 1 of" in error
    assert run(*arguments, "--jobs", "1") == 0
    assert "1 of them are from an earlier run" in capsys.readouterr().out
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"results.csv", "summary.csv", "gallery.html", "loops.png"}


def test_command(table, tmp_path, capsys):
    out = tmp_path / "out"
    given = ("--jobs", "1", "--out", out, "--loops", "--failure", "flexure")
    assert run(tmp_path, *given) == 0
    text = capsys.readouterr().out
    named = ("Me 1991 No. 1", "Model layered 20", ": 3 tests in", "rectangular, Flexure")
    for words in (*named, "1 of the table have no history"):
        assert words in text
    names = {path.name for path in out.iterdir()}
    assert names == {"results.csv", "summary.csv", "gallery.html", "loops.png", "loops"}
    assert (out / "loops.png").read_bytes()[:4] == b"\x89PNG"
    # T6 is asked for by name and has no history.
    assert run(tmp_path, "--jobs", "1", "--only", "T1", "Me * No. 6") == 1
    assert "1 of the table have no history in the folder, so no score: Me 1990 No. 6" in (
        capsys.readouterr().out
    )
    for arguments, words in (
        (["--only", "T17"], "no specimen 'T17'"),
        (["--failure", "Torsion"], "there are Flexure, Shear"),
        (["--section", "circular"], "no test is left"),
        (["--by", "colour"], "--by colour"),
        (["--jobs", "0"], "jobs = 0"),
        (["--loops"], "--out"),
    ):
        assert run(tmp_path, *arguments) == 2
        error = capsys.readouterr().err
        assert error.startswith("rbsdem: peer: ")
        assert words in error
    assert run(tmp_path / "nowhere") == 2
    assert "No such file" in capsys.readouterr().err


def test_command_whose_reader_leaves(table, tmp_path):
    """Two processes, from the shell; the files are written before the report."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "rbsdem", "peer", tmp_path, "--jobs", "2", "--out", tmp_path / "o"],
        stdout=writer, stderr=subprocess.PIPE, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")
    assert (tmp_path / "o" / "results.csv").is_file()
