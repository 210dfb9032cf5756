"""Batches of tests from a table that means harm, and batches that are killed."""

from __future__ import annotations

import csv
import json
import os
import re
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rbsdem import peer
from rbsdem.cli import main
from rbsdem.errors import InputError
from rbsdem.measured import predict
from rbsdem.measured.prediction_store import PredictionStore

ROW = {
    "peer_id": "1", "file": "a.csv", "name": "Me 1990 No. 1", "author": "Me", "year": "1990",
    "section": "rectangular", "L_mm": "1600", "b_mm": "400", "h_mm": "400", "cover_mm": "13",
    "fc_MPa": "46.5", "axial_kN": "744", "n_long": "12", "db_corner_mm": "16",
    "n_interm_perp": "2", "n_interm_par": "2", "fy_long_MPa": "446", "db_trans_mm": "7",
    "s_trans_mm": "85", "fy_trans_MPa": "364", "legs_Nv": "4", "failure_mode": "Flexure",
    "pdelta_code": "2",
}  # fmt: skip
PATIENCE = 60.0


def history(path: Path, scale: float = 1.0) -> None:
    t = np.linspace(0.0, 2.0, 60)
    d = 0.02 * t * np.sin(2 * np.pi * t)
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = np.column_stack((1e3 * d, scale * 150 * np.tanh(d / 0.004)))
    np.savetxt(path, rows, delimiter=",", header="displacement_mm,force_kN", comments="")


def table(folder: Path, rows: list[dict[str, str]]) -> peer.Specimens:
    with (folder / "specimens.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(ROW))
        writer.writeheader()
        for number, row in enumerate(rows, 1):
            values = {"peer_id": str(number), "name": f"Me 1990 No. {number}"}
            writer.writerow(ROW | values | row)
    return peer.read_specimens(folder)


def run(*arguments: object) -> int:
    return main(["peer", *map(str, arguments)])


# ---- what is in the table ------------------------------------------------------------------------


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
    inside = tmp_path / "in"
    for path in (inside / "a.csv", tmp_path / "outside.csv"):
        history(path)
    first = table(inside, [{}])[0]
    strange = replace(first, file=file)
    assert strange.path is None
    row = peer.predict_one(strange)
    assert row.status == "no history"
    assert file.startswith("x") == ("is not in" in row.error)
    row = peer.predict_one(replace(first, file=str(tmp_path / "outside.csv")))
    assert "no file below the folder" in row.error


def test_texts_of_a_table_do_no_harm(tmp_path, capsys):
    """Markup of rich, codes of terminals, templates, formulas, html: letters like others."""
    texts = ["[/bold]", "[link=x", "\x1b[31mred", "{cards}", "{{ cards }}", "=1+1", "<b>", "\\"]
    history(tmp_path / "a.csv")
    table(tmp_path, [{"failure_mode": text, "name": f"{text} 1990"} for text in texts])
    out = tmp_path / "out"
    assert run(tmp_path, "--model", "paper", "--jobs", "1", "--out", out, "--by", "name") == 0
    shown = capsys.readouterr().out
    for text in texts:
        assert text.replace("\x1b", "?") in shown
    assert "\x1b" not in shown
    page = (out / "gallery.html").read_text()
    assert "<b>" not in page
    (packed,) = re.findall(r'<script type="application/json" id="report">(.*?)</script>', page)
    shown_tests = json.loads(packed)["tests"]
    assert [test["name"] for test in shown_tests] == [f"{text} 1990" for text in texts]
    with (out / "results.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["failure_mode"] for row in rows] == [t.replace("=1+1", "'=1+1") for t in texts]
    with (out / "summary.csv").open(newline="") as file:
        assert "'=1+1 1990" in [row["name"] for row in csv.DictReader(file)]


def test_loops_of_files_with_one_name_are_apart(tmp_path):
    """Their path below the folder is kept; what would still be the same gets a number."""
    files = ["a.csv", "sub/a.csv", "A.csv", "a.txt", "a.csv", "sub/deep/No. 7", "w:x?.csv"]
    for i, file in enumerate(files):
        history(tmp_path / file, 1 + i)
    tests = table(tmp_path, [{"file": file} for file in files])
    found = peer.predict(tests, "paper")
    assert {row.status for row in found} == {"completed"}
    found.loops_to_csv(tmp_path / "loops")
    written = sorted(
        p.relative_to(tmp_path / "loops").as_posix() for p in (tmp_path / "loops").rglob("*.csv")
    )
    assert written == sorted(
        ["a.csv", "sub/a.csv", "A_2.csv", "a_3.csv", "a_4.csv", "sub/deep/No. 7.csv", "w_x_.csv"]
    )
    loop = np.loadtxt(tmp_path / "loops" / "sub" / "a.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(loop[:, 1], found[1].comparison.test_force, rtol=1e-6)


def test_bad_line_of_the_terminal_is_not_the_end_of_the_work(tmp_path):
    """The files are written before the report, whose reader may leave."""
    history(tmp_path / "a.csv")
    table(tmp_path, [{}])
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run(
        [sys.executable, "-m", "rbsdem", "peer", tmp_path, "--jobs", "1", "--out", tmp_path / "o"],
        stdout=writer, stderr=subprocess.PIPE, text=True, timeout=PATIENCE, check=False,
    )  # fmt: skip
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")
    assert (tmp_path / "o" / "results.csv").is_file()


# ---- the store -----------------------------------------------------------------------------------


@pytest.fixture
def tests(tmp_path) -> peer.Specimens:
    """Four tests; the third comes without a history, the forces of the fourth end early."""
    for i in range(1, 5):
        history(tmp_path / f"T{i}.csv", i)
    (tmp_path / "T3.csv").unlink()
    return table(tmp_path, [{"file": f"T{i}.csv"} for i in range(1, 5)])


def same(one: peer.Prediction, other: peer.Prediction) -> bool:
    a, b = (peer.Predictions([row]).to_frame().iloc[0].to_dict() for row in (one, other))
    return repr(a) == repr(b)


def test_second_start_goes_on(tests, tmp_path, monkeypatch):
    """What is in the store comes back bit for bit, and only the rest is done."""
    folder = tmp_path / "store"
    first = peer.predict(tests[:3], "paper", store=folder)
    assert first.resumed == 0
    done = []
    one = predict.predict_one
    monkeypatch.setattr(
        predict, "predict_one", lambda s, *a, **o: done.append(s.peer_id) or one(s, *a, **o)
    )
    whole = peer.predict(tests, "paper", store=folder)
    assert done == [4]
    assert whole.resumed == 3
    assert all(same(row, before) for row, before in zip(whole, first, strict=False))
    for row, before in zip(whole[:2], first, strict=False):
        assert np.array_equal(row.comparison.model_force, before.comparison.model_force)
        assert row.comparison.nrmse == before.comparison.nrmse
    shards = sorted((folder / "shards").iterdir(), key=lambda path: path.stat().st_mtime_ns)
    lines = [json.loads(line) for path in shards for line in path.read_text().splitlines()]
    assert [line["name"] for line in lines] == [s.name for s in tests]


def test_what_has_changed_is_done_again(tests, tmp_path):
    folder = tmp_path / "store"
    peer.predict(tests[:1], "paper", store=folder)
    assert peer.predict(tests[:1], "paper", store=folder).resumed == 1
    assert peer.predict(tests[:1], "layered", store=folder).resumed == 0
    assert peer.predict(tests[:1], "paper", n=2, store=folder).resumed == 0
    history(tmp_path / "T1.csv", 1.01)
    assert peer.predict(tests[:1], "paper", store=folder).resumed == 0
    assert peer.predict(tests[:1], "paper", store=folder).resumed == 1
    changed = table(tmp_path, [{"file": "T1.csv", "fc_MPa": "46.6"}])
    assert peer.predict(changed, "paper", store=folder).resumed == 0


def test_lines_of_other_batches_are_kept(tests, tmp_path):
    folder = tmp_path / "store"
    found = peer.predict(tests[:1], "paper", store=folder)
    peer.predict(tests[:2], "paper", store=folder, n=2)
    PredictionStore(folder, tests[:1], found.model, {}).forget()
    assert peer.predict(tests[:2], "paper", store=folder, n=2).resumed == 2
    PredictionStore(folder, tests[:2], found.model, {"n": 2}).forget()
    assert not folder.exists()


def test_store_is_refused(tests, tmp_path):
    with pytest.raises(InputError, match="is no folder"):
        peer.predict(tests, "paper", store=tmp_path / "T1.csv")
    with pytest.raises(InputError, match=r"holds other files"):
        peer.predict(tests, "paper", store=tmp_path)
    with pytest.raises(InputError, match="is a function"):
        peer.predict(tests, lambda specimen: None, store=tmp_path / "j")


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


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_killed_batch_leaves_no_process_and_goes_on(tmp_path, number):
    """The workers end with the main process; what was finished is taken over by the next start."""
    history(tmp_path / "a.csv")
    table(tmp_path, [{}, {}, {}])
    (tmp_path / "waiting.py").write_text(WAITING)
    arguments = [tmp_path, "--model", "paper", "--jobs", "3", "--quiet", "--out", tmp_path / "out"]
    running = subprocess.Popen(
        [sys.executable, "waiting.py", *arguments], cwd=tmp_path, stderr=subprocess.PIPE
    )
    shards = tmp_path / "out" / "unfinished" / "shards"
    deadline = time.monotonic() + PATIENCE
    while time.monotonic() < deadline and running.poll() is None:
        workers = [int(p.name[7:]) for p in tmp_path.glob("worker-*")]
        if len(workers) == 2 and list(shards.glob("*.jsonl")):
            break
        time.sleep(0.02)
    assert len(workers) == 2
    running.send_signal(number)
    if number == signal.SIGKILL:
        assert running.wait(PATIENCE) == -signal.SIGKILL
        while any(map(is_alive, workers)) and time.monotonic() < deadline:
            time.sleep(0.02)
        assert not any(map(is_alive, workers))
    else:
        assert running.wait(PATIENCE) == 128 + signal.SIGTERM
        assert not any(map(is_alive, workers))
    running.stderr.close()
    assert run(*arguments) == 0
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {"results.csv", "summary.csv", "gallery.html", "loops.png"}


def test_second_start_of_the_command_says_what_it_took_over(tmp_path, capsys):
    history(tmp_path / "a.csv")
    tests = table(tmp_path, [{}, {}])
    (tmp_path / "out").mkdir()
    peer.predict(tests[:1], "paper", store=tmp_path / "out" / "unfinished")
    assert run(tmp_path, "--model", "paper", "--jobs", "1", "--out", tmp_path / "out") == 0
    assert "1 of them are from an earlier run" in capsys.readouterr().out
    assert not (tmp_path / "out" / "unfinished").exists()
