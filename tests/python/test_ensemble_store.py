"""The store of an ensemble: rows that are whole or not there, nothing twice, nothing lost."""

from __future__ import annotations

import os
import signal
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_ensembles import column, motion

import rbsdem
from rbsdem import InputError, _core
from rbsdem.many import ensemble, store
from rbsdem.many.inputs import MEASURES, STATUSES
from rbsdem.many.plan import Plan
from rbsdem.springs import Elastic

GIVEN = {"scales": np.linspace(0.1, 3.0, 12), "method": "newmark", "jobs": 1}


@pytest.fixture(autouse=True)
def small_tasks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut the work of these tests into tasks of a run or two, and commit after each."""
    monkeypatch.setattr(ensemble, "_LONGEST", 1e-6)
    monkeypatch.setattr(store, "_BEAT", 0.0)


def run(folder: Path, **more: object) -> rbsdem.fragility.Ensemble:
    return rbsdem.ensemble([column(), column(15e3)], motion(1), store=folder, **(GIVEN | more))


def rows(folder: Path, part: str = "1-of-1") -> list[tuple[Any, ...]]:
    """Return column, scale, status and numbers of each run of a part."""
    with closing(sqlite3.connect(folder / f"part-{part}.sqlite")) as file:
        return file.execute("select column_name, scale, status, numbers from runs").fetchall()


def same(one: rbsdem.fragility.Ensemble, other: rbsdem.fragility.Ensemble) -> None:
    assert list(one.status) == list(other.status)
    assert one.errors == other.errors
    for name in one.measures:
        np.testing.assert_array_equal(one.measures[name], other.measures[name])


def test_a_second_start_computes_what_is_missing(tmp_path: Path) -> None:
    """Rows that were taken away, or all of a file that is damaged and removed."""
    first = run(tmp_path)
    kept = {(name, scale): (status, numbers) for name, scale, status, numbers in rows(tmp_path)}
    for number in range(24):
        status, numbers = kept[str(first.column[number]), first.scale[number]]
        assert STATUSES[status] == first.status[number]
        assert np.frombuffer(numbers)[0] == first.measures[_core.measures()[0]][number]
    path = tmp_path / "part-1-of-1.sqlite"
    with closing(sqlite3.connect(path, isolation_level=None)) as file:
        file.execute("delete from runs where scale > 1.0")
    left = len(rows(tmp_path))
    again = run(tmp_path, jobs=2)
    assert 0 < again.resumed == left < 24
    same(first, again)
    assert run(tmp_path).resumed == 24
    path.write_bytes(path.read_bytes()[:5000])
    with pytest.raises(InputError, match=r"1-of-1.sqlite: .*; it is damaged, remove it"):
        run(tmp_path)
    path.unlink()
    same(first, run(tmp_path))


def swing(result: rbsdem.Result) -> float:
    return float(np.ptp(result.displacement))


def test_failed_runs_and_measures_of_functions_come_back(tmp_path: Path) -> None:
    elastic = rbsdem.Column(1.6, 600.0, Elastic(7e7), Elastic(2.5e8))
    given = {"method": "rk4", "dt": 5e-3, "allow_unstable": True, "scales": [0.0, 1.0]}
    given["collapse_drift"] = None
    first, again = (
        rbsdem.ensemble(elastic, motion(1), measures=[swing], store=tmp_path, **given)
        for _ in range(2)
    )
    assert list(again.status) == ["completed", "failed"]
    assert again.resumed == 2
    same(first, again)


def test_parts_come_together(tmp_path: Path) -> None:
    parts = [run(tmp_path, shard=(i, 3)) for i in (1, 2, 3)]
    assert "" in parts[0].status
    assert "" not in parts[2].status
    same(parts[2], rbsdem.ensemble([column(), column(15e3)], motion(1), **GIVEN))


@pytest.mark.parametrize("what", ["column", "motion", "scale"])
def test_what_is_added_is_computed_alone(
    tmp_path: Path, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In any place and under any name: a run is known by what it follows from.

    24 runs of 2 columns, 1 motion and 12 scales are there; one more of each makes 36, 48 and 26.
    """
    columns, motions, scales = [column(), column(15e3)], [motion(1)], GIVEN["scales"]
    run(tmp_path)
    if what == "column":
        columns = {"light": column(8e3), "heavy": columns[0], "middle": columns[1]}
    elif what == "motion":
        motions = [motion(2), *motions]
    else:
        scales = np.array([*scales, 1.4])
    done = []
    real = ensemble.compute

    def count(task: Plan, control: object) -> object:
        done.append(len(task))
        return real(task, control)

    monkeypatch.setattr(ensemble, "compute", count)
    given = GIVEN | {"scales": scales}
    found = rbsdem.ensemble(columns, motions, store=tmp_path, **given)
    assert found.resumed == 24
    assert sum(done) == len(found) - 24 == {"column": 12, "motion": 24, "scale": 2}[what]
    same(found, rbsdem.ensemble(columns, motions, **given))


@pytest.mark.parametrize("parts", [2, 3])
def test_parts_of_few_slow_runs(tmp_path: Path, parts: int) -> None:
    """Each part has its share of a few runs that take long, whatever the others have done.

    Five runs: of two parts one has three; of three one has one.
    """
    given = {"scales": np.linspace(1, 2, 5), "method": "rk4", "dt": 1e-4, "store": tmp_path}
    number = []
    for place in range(1, parts + 1):
        found = rbsdem.ensemble(column(), motion(1), shard=(place, parts), **given)
        number.append(int((found.status != "").sum()) - found.resumed)
    assert "" not in found.status
    assert sorted(number) == {2: [2, 3], 3: [1, 2, 2]}[parts]


def test_ctrl_c_is_an_exception_with_what_is_done(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """At the third task; the runs that had ended are in it and in the store."""
    tasks = []
    real = ensemble.compute

    def break_off(task: Plan, control: object) -> object:
        tasks.append(task)
        if len(tasks) == 3:
            os.kill(os.getpid(), signal.SIGINT)
        return real(task, control)

    monkeypatch.setattr(ensemble, "compute", break_off)
    with pytest.raises(KeyboardInterrupt, match=r"interrupted after [0-9]+ of 24 runs") as caught:
        run(tmp_path)
    assert isinstance(caught.value, rbsdem.errors.Interrupted)
    found = caught.value.ensemble
    assert found.interrupted
    done = int((found.status != "").sum())
    assert 0 < done < 24
    tasks.clear()
    again = run(tmp_path, allow_partial=True)
    assert again.resumed == done
    assert again.interrupted
    assert again.counts["not started"] > 0
    monkeypatch.undo()
    same(run(tmp_path), rbsdem.ensemble([column(), column(15e3)], motion(1), **GIVEN))


def test_runs_of_other_settings_and_measures_are_others(tmp_path: Path) -> None:
    """They stand side by side; numbers of numpy are those of Python; all measures are kept."""
    run(tmp_path, dt=np.float32(0.0078125), measures=["peak_drift"])
    again = run(tmp_path, dt=0.0078125)
    assert (again.resumed, list(again.measures)) == (24, list(MEASURES))
    for more in ({"dt": 0.01}, {"measures": ["cracking"]}, {"measures": [swing]}):
        given = {"dt": 0.0078125} | more
        assert [run(tmp_path, **given).resumed for _ in range(2)] == [0, 24]
    assert run(tmp_path, dt=0.0078125).resumed == 24


def test_what_cannot_be_a_store(tmp_path: Path) -> None:
    (tmp_path / "thesis.docx").write_text("")
    for folder, more, words in (
        (tmp_path, {"measures": [lambda result: 1.0]}, "name of its own"),
        (tmp_path, {"shard": (0, 2)}, "shard = "),
        (tmp_path, {"shard": (3, 2)}, "shard = "),
        (tmp_path, {"shard": 2}, "shard = "),
        (tmp_path / "thesis.docx", {}, "File exists; give another path"),
    ):
        with pytest.raises(InputError, match=words):
            run(folder, **more)


def test_two_at_one_part(tmp_path: Path) -> None:
    """The second is refused as long as the first writes; other parts read what it has committed."""
    run(tmp_path, shard=(2, 3))
    path = tmp_path / "part-2-of-3.sqlite"
    with closing(sqlite3.connect(path, isolation_level=None)) as file:
        file.execute("begin immediate")
        file.execute("delete from runs")
        with pytest.raises(InputError, match=r"another process is at work on .*part-2-of-3"):
            run(tmp_path, shard=(2, 3))
        # Another process has made its file, and not yet the table in it.
        (tmp_path / "part-3-of-3.sqlite").touch()
        assert run(tmp_path, shard=(1, 3)).resumed == 8
    assert "" not in run(tmp_path).status


def test_a_full_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was committed before stays, and a new start goes on from there."""
    real = store._connection

    def small(path: Path, patience: float = 60.0) -> sqlite3.Connection:
        file = real(path, patience)
        file.execute("pragma max_page_count = 4")
        return file

    monkeypatch.setattr(store, "_connection", small)
    with pytest.raises(OSError, match=r"disk is full; the runs that were written before are kept"):
        run(tmp_path)
    monkeypatch.undo()
    assert 0 < run(tmp_path).resumed < 24
    assert run(tmp_path).resumed == 24


PROGRAM = """\
import sys
sys.path.insert(0, {tests!r})
from test_ensembles import column, motion
import numpy as np, rbsdem
from contextlib import contextmanager
from rbsdem.many import store
from rbsdem.many import ensemble
ensemble._LONGEST = {longest}
store._BEAT = {beat}
@contextmanager
def said(wanted, total):
    yield lambda done, text: print(done, flush=True)
ensemble.progress_bar = said
rbsdem.ensemble([column(), column(15e3)], motion(1, 4000, 0.005), store={folder!r},
                scales=np.linspace(0.1, 3.0, 80), method="rk4", dt={dt}, jobs=1, shard={part})
"""


def begin(folder: Path, **more: object) -> list[object]:
    """Return the command of a program that runs 160 runs in tasks of a few."""
    given = {"longest": 0.05, "beat": 0.0, "dt": None, "part": (1, 1)} | more
    tests = os.fspath(Path(__file__).parent)
    return [sys.executable, "-c", PROGRAM.format(tests=tests, folder=os.fspath(folder), **given)]


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_every_run_that_has_ended_is_kept(tmp_path: Path, number: signal.Signals) -> None:
    """In tasks of which none has ended, and although nothing was due yet."""
    command = begin(tmp_path, longest=1e3, beat=1e3, dt=2e-5)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, **pipes) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line) > 0:
                break
        assert not rows(tmp_path)
        process.send_signal(number)
        out, err = process.communicate(timeout=60)
    ended = int(out.split()[-1])
    assert 0 < ended < 160
    assert len(rows(tmp_path)) == ended
    if number == signal.SIGTERM:
        assert process.returncode == -number
    else:
        assert process.returncode == 1
        assert f"Interrupted: ensemble: interrupted after {ended} of 160 runs" in err


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_a_process_that_is_killed_leaves_what_it_has_committed(tmp_path: Path) -> None:
    """And a journal, from which the next one that opens the file takes back what was half done."""
    with subprocess.Popen(begin(tmp_path, dt=5e-4), stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line) > 8:
                break
        process.kill()
    kept = len(rows(tmp_path))
    assert 0 < kept < 160
    subprocess.run(begin(tmp_path, dt=5e-4), check=True, capture_output=True)
    assert len(rows(tmp_path)) == 160


def test_several_processes_write_at_once(tmp_path: Path) -> None:
    """Each part has its file, which the others read while it is written."""
    parts = [(number, 3) for number in (1, 2, 3)]
    works = [
        subprocess.Popen(begin(tmp_path, part=part), stdout=subprocess.DEVNULL) for part in parts
    ]
    assert [work.wait(120) for work in works] == [0, 0, 0]
    known = [row[:2] for part in parts for row in rows(tmp_path, "{}-of-{}".format(*part))]
    assert len(set(known)) == len(known) == 160
