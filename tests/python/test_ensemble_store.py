"""The store of an ensemble: whole shards or none, nothing twice, nothing of another ensemble."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from test_ensembles import column, motion

import rbsdem
from rbsdem import InputError
from rbsdem.many import ensemble, store
from rbsdem.many.inputs import MEASURES
from rbsdem.many.plan import Plan
from rbsdem.springs import Elastic

parquet = pytest.importorskip("pyarrow.parquet", reason="the extra 'ensembles' brings pyarrow")

GIVEN = {"scales": np.linspace(0.1, 3.0, 12), "method": "newmark", "jobs": 1}


@pytest.fixture(autouse=True)
def small_shards(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut the work of these tests into tasks of a run or two, and write each into a shard."""
    monkeypatch.setattr(ensemble, "_LONGEST", 1e-6)
    monkeypatch.setattr(store, "_BEAT", 0.0)


def run(folder: Path, **more: object) -> rbsdem.fragility.Ensemble:
    return rbsdem.ensemble([column(), column(15e3)], motion(1), store=folder, **(GIVEN | more))


def shards(folder: Path) -> dict[str, int]:
    """Return the names of the shards and when each was written."""
    return {path.name: path.stat().st_mtime_ns for path in (folder / "shards").iterdir()}


def same(one: rbsdem.fragility.Ensemble, other: rbsdem.fragility.Ensemble) -> None:
    assert list(one.status) == list(other.status)
    assert one.errors == other.errors
    for name in one.measures:
        np.testing.assert_array_equal(one.measures[name], other.measures[name])


def test_a_second_start_computes_what_is_missing(tmp_path: Path) -> None:
    """Missing, cut short, changed by a few bits, or whole under the name of another."""
    first = run(tmp_path)
    before = shards(tmp_path)
    assert len(before) > 4
    tables = [parquet.read_table(path) for path in (tmp_path / "shards").iterdir()]
    rows = {(row["column"], row["scale"]): row for table in tables for row in table.to_pylist()}
    for number in range(24):
        row = rows[str(first.column[number]), first.scale[number]]
        assert row["status"] == first.status[number]
        assert row["peak_displacement"] == first.measures["peak_displacement"][number]
    again = run(tmp_path)
    assert again.resumed == len(again) == 24
    assert shards(tmp_path) == before
    same(first, again)
    paths = sorted((tmp_path / "shards").iterdir())
    number = first.measures["residual_displacement"][5].tobytes()
    (hit,) = (path for path in paths if number in path.read_bytes())
    hit.write_bytes(hit.read_bytes().replace(number, np.float64(0.01).tobytes()))
    one, other, third, fourth = [path for path in paths if path != hit][:4]
    one.unlink()
    other.write_bytes(b"PAR1")
    third.write_bytes(fourth.read_bytes())
    leftover = tmp_path / "shards" / f"1-of-1-{'0' * 32}.parquet.1-1.partial"
    leftover.touch()
    again = run(tmp_path, jobs=2)
    assert 0 < again.resumed < 24
    assert not leftover.exists()
    same(first, again)
    after = shards(tmp_path)
    changed = {name for name in before if before[name] != after.get(name)}
    assert changed <= {path.name for path in (one, other, third, hit)}
    (tmp_path / "manifest.json").unlink()
    assert run(tmp_path).resumed == 24
    assert len(json.loads((tmp_path / "manifest.json").read_text())["columns"]) == 2


def test_failed_runs_and_measures_of_functions_come_back(tmp_path: Path) -> None:
    def swing(result: rbsdem.Result) -> float:
        return float(np.ptp(result.displacement))

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
    manifest = json.loads((tmp_path / "manifest.json").read_text())
    assert len(manifest["columns"]) == len(columns)
    assert len(manifest["motions"]) == len(motions)


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


def test_what_is_no_store_of_these_runs(tmp_path: Path) -> None:
    """Numbers of numpy in settings are those of Python; all measures are kept."""
    place = tmp_path / "store"
    run(place, dt=np.float32(0.0078125), measures=["peak_drift"])
    again = run(place, dt=0.0078125)
    assert (again.resumed, list(again.measures)) == (24, list(MEASURES))
    path = place / "manifest.json"
    manifest = json.loads(path.read_text())
    settings = {"method": "newmark", "dt": 0.0078125, "collapse_drift": 0.1}
    assert manifest["settings"] == settings
    entries = list(manifest["columns"].values())
    assert [entry["name"] for entry in entries] == ["0", "1"]
    assert "&column" in entries[0]["case"]
    (tmp_path / "thesis.docx").write_text("")
    for folder, more, words in (
        (place, {"dt": 0.01}, "their settings differ"),
        (place, {"dt": 0.0078125, "measures": [lambda result: 1.0]}, "name of its own"),
        (place, {"dt": 0.0078125, "measures": ["cracking"]}, "their measures differ"),
        (place, {"shard": (0, 2)}, "shard = "),
        (place, {"shard": (3, 2)}, "shard = "),
        (place, {"shard": 2}, "shard = "),
        (tmp_path / "new", {"seeds": {1, 2}}, r"seeds: the manifest .* takes what JSON takes"),
        (tmp_path, {}, r"holds other files \("),
        (tmp_path / "thesis.docx", {}, "no folder"),
    ):
        with pytest.raises(InputError, match=words):
            run(folder, **more)
    for text, words in ((json.dumps(manifest | {"version": "0.0.9"}), "0.0.9"), ("{}", "no manif")):
        path.write_text(text)
        with pytest.raises(InputError, match=words):
            run(place, dt=0.0078125)


def test_two_at_one_part(tmp_path: Path) -> None:
    """The second is refused as long as the first is at work, whatever the number of its parts."""
    fcntl = pytest.importorskip("fcntl")
    run(tmp_path, shard=(2, 3))
    with (tmp_path / "part-2-of-3.lock").open("ab") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        with pytest.raises(InputError, match="another process is at work on part 2 of 3"):
            run(tmp_path)
        run(tmp_path, shard=(1, 3))
    assert "" not in run(tmp_path).status


def test_a_full_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What was written before stays whole, nothing half written is left."""
    written = []
    real = store.atomic_write

    def full(path: Path) -> object:
        written.append(path)
        if len(written) > 4:
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(path)

    monkeypatch.setattr(store, "atomic_write", full)
    with pytest.raises(OSError, match=r"No space left on device; the shards .* are kept"):
        run(tmp_path)
    monkeypatch.undo()
    kept = shards(tmp_path)
    assert len(kept) == 3
    assert all(name.endswith(".parquet") for name in kept)
    again = run(tmp_path)
    assert 0 < again.resumed < 24
    assert kept.items() <= shards(tmp_path).items()


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
                scales=np.linspace(0.1, 3.0, 80), method="rk4", dt={dt}, jobs=1)
"""


def begin(folder: Path, **more: object) -> list[object]:
    """Return the command of a program that runs 160 runs in tasks of a few."""
    given = {"longest": 0.05, "beat": 0.0, "dt": None} | more
    tests = os.fspath(Path(__file__).parent)
    return [sys.executable, "-c", PROGRAM.format(tests=tests, folder=os.fspath(folder), **given)]


def rows(folder: Path) -> list[tuple[str, float]]:
    """Return column and scale of each row of the shards."""
    tables = [parquet.read_table(path) for path in (folder / "shards").glob("*.parquet")]
    return [(row["column"], row["scale"]) for table in tables for row in table.to_pylist()]


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_every_run_that_has_ended_is_kept(tmp_path: Path, number: signal.Signals) -> None:
    """In tasks of which none has ended, and although no shard was due yet."""
    command = begin(tmp_path, longest=1e3, beat=1e3, dt=2e-5)
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(command, **pipes) as process:
        assert process.stdout is not None
        for line in process.stdout:
            if int(line) > 0:
                break
        assert not list((tmp_path / "shards").iterdir())
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
