"""The store of an ensemble: whole shards or none, nothing twice, nothing of another ensemble."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from test_ensembles import column, motion

import rbsdem
from rbsdem import InputError
from rbsdem.ensembles import MEASURES, engine, store

parquet = pytest.importorskip("pyarrow.parquet", reason="the extra 'ensembles' brings pyarrow")

GIVEN = {"scales": np.linspace(0.1, 3.0, 12), "method": "newmark", "jobs": 1}


@pytest.fixture(autouse=True)
def small_shards(monkeypatch: pytest.MonkeyPatch) -> None:
    """Cut the work of these tests into shards of a few runs."""
    monkeypatch.setattr(engine, "_LONGEST", 1e-3)


def run(folder: Path, **more: object) -> rbsdem.Ensemble:
    return rbsdem.ensemble([column(), column(15e3)], motion(1), store=folder, **(GIVEN | more))


def shards(folder: Path) -> dict[str, int]:
    """Return the names of the shards and when each was written."""
    return {path.name: path.stat().st_mtime_ns for path in (folder / "shards").iterdir()}


def same(one: rbsdem.Ensemble, other: rbsdem.Ensemble) -> None:
    assert list(one.status) == list(other.status)
    assert one.errors == other.errors
    for name in one.measures:
        np.testing.assert_array_equal(one.measures[name], other.measures[name])


def test_a_second_start_computes_what_is_missing(tmp_path: Path) -> None:
    first = run(tmp_path)
    before = shards(tmp_path)
    assert len(before) > 4
    again = run(tmp_path)
    assert again.resumed == len(again) == 24
    assert shards(tmp_path) == before
    same(first, again)
    lost = sorted(before)[:2]
    (tmp_path / "shards" / lost[0]).unlink()
    (tmp_path / "shards" / lost[1]).write_bytes(b"PAR1")
    third = run(tmp_path, jobs=2)
    assert 0 < third.resumed < 24
    same(first, third)
    after = shards(tmp_path)
    assert {name for name in before if before[name] != after[name]} == set(lost)


def test_damage_is_noticed(tmp_path: Path) -> None:
    """Of bits that change a number, and of a whole shard under the name of another."""
    first = run(tmp_path)
    one, other = sorted((tmp_path / "shards").iterdir())[:2]
    number = first.measures["residual_displacement"][5].tobytes()
    (hit,) = (path for path in (tmp_path / "shards").iterdir() if number in path.read_bytes())
    hit.write_bytes(hit.read_bytes().replace(number, np.float64(0.01).tobytes()))
    same(first, run(tmp_path))
    one.write_bytes(other.read_bytes())
    again = run(tmp_path)
    assert again.resumed < 24
    same(first, again)


def test_a_lost_manifest_is_written_again(tmp_path: Path) -> None:
    run(tmp_path)
    (tmp_path / "manifest.json").unlink()
    assert run(tmp_path).resumed == 24
    assert json.loads((tmp_path / "manifest.json").read_text())["runs"] == 24


def test_a_shard_is_a_table(tmp_path: Path) -> None:
    found = run(tmp_path)
    tables = [parquet.read_table(path) for path in (tmp_path / "shards").iterdir()]
    rows = {row["run"]: row for table in tables for row in table.to_pylist()}
    assert sorted(rows) == list(range(24))
    for number, row in rows.items():
        assert row["scale"] == found.scale[number]
        assert row["status"] == found.status[number]
        assert row["peak_displacement"] == found.measures["peak_displacement"][number]


def test_failed_runs_and_measures_of_functions_come_back(tmp_path: Path) -> None:
    def swing(result: rbsdem.Result) -> float:
        return float(np.ptp(result.displacement))

    elastic = rbsdem.Column(1.6, 600.0, rbsdem.Elastic(7e7), rbsdem.Elastic(2.5e8))
    given = {"method": "rk4", "dt": 5e-3, "allow_unstable": True, "scales": [0.0, 1.0]}
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


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"scales": [1.0]}, "scales"),
        ({"method": "hht"}, "settings"),
        ({"measures": [lambda result: 1.0]}, "lambda"),
    ],
)
def test_another_ensemble_is_refused(tmp_path: Path, change: dict, what: str) -> None:
    run(tmp_path)
    with pytest.raises(InputError, match=what):
        run(tmp_path, **change)


def test_other_columns_and_motions_are_refused(tmp_path: Path) -> None:
    run(tmp_path)
    with pytest.raises(InputError, match=r"its columns, motions differ"):
        rbsdem.ensemble([column(), column(15.1e3)], motion(2), store=tmp_path, **GIVEN)


def test_another_version_is_refused(tmp_path: Path) -> None:
    run(tmp_path)
    path = tmp_path / "manifest.json"
    manifest = json.loads(path.read_text())
    assert manifest["runs"] == 24
    assert manifest["settings"] == {"method": "newmark"}
    assert "&column" in manifest["columns"]["0"]
    path.write_text(json.dumps(manifest | {"version": "0.0.9"}))
    with pytest.raises(InputError, match=r"rbsdem 0\.0\.9"):
        run(tmp_path)
    path.write_text("{}")
    with pytest.raises(InputError, match="no manifest"):
        run(tmp_path)


def test_a_folder_of_other_files_is_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.docx").write_text("")
    with pytest.raises(InputError, match=r"holds other files \(thesis"):
        run(tmp_path)
    with pytest.raises(InputError, match="no folder"):
        run(tmp_path / "thesis.docx")


def test_what_a_manifest_takes(tmp_path: Path) -> None:
    """Numbers of numpy in settings are those of Python; seeds are what JSON takes."""
    run(tmp_path, dt=np.float32(0.0078125))
    assert run(tmp_path, dt=0.0078125).resumed == 24
    with pytest.raises(InputError, match=r"seeds: the manifest .* takes what JSON takes"):
        run(tmp_path / "other", seeds={1, 2})


@pytest.mark.parametrize("shard", [(0, 2), (3, 2), 2, ("1", "2")])
def test_bad_parts(tmp_path: Path, shard: object) -> None:
    with pytest.raises(InputError, match="shard = "):
        run(tmp_path, shard=shard)
    with pytest.raises(InputError, match="give store="):
        rbsdem.ensemble(column(), motion(1), shard=(1, 2))


def test_two_processes_at_one_part(tmp_path: Path) -> None:
    """The second is refused as long as the first is at work, and no longer."""
    run(tmp_path)
    code = (
        "import fcntl, sys\n"
        "file = open(sys.argv[1], 'ab')\n"
        "fcntl.flock(file, fcntl.LOCK_EX)\n"
        "print('locked', flush=True)\n"
        "sys.stdin.read()\n"
    )
    lock = tmp_path / "part-1-of-1.lock"
    with subprocess.Popen(
        [sys.executable, "-c", code, lock], stdin=subprocess.PIPE, stdout=subprocess.PIPE
    ) as other:
        assert other.stdout is not None
        assert other.stdout.readline() == b"locked\n"
        with pytest.raises(InputError, match="another process is at work on part 1 of 1"):
            run(tmp_path)
        other.kill()
    assert run(tmp_path).resumed == 24


def test_parts_of_two_sizes_do_not_meet(tmp_path: Path) -> None:
    """They would compute the same shards."""
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
    real = store.whole_file

    def full(path: Path) -> object:
        written.append(path)
        if len(written) > 4:
            raise OSError(errno.ENOSPC, "No space left on device")
        return real(path)

    monkeypatch.setattr(store, "whole_file", full)
    with pytest.raises(OSError, match=r"No space left on device; the shards .* are kept"):
        run(tmp_path)
    monkeypatch.undo()
    monkeypatch.setattr(engine, "_LONGEST", 1e-3)
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
from rbsdem.ensembles import engine
engine._LONGEST = 0.02
rbsdem.ensemble([column(), column(15e3)], motion(1, 4000, 0.005), store={folder!r},
                scales=np.linspace(0.1, 3.0, 80), method="rk4", jobs=2)
"""


@pytest.mark.skipif(os.name == "nt", reason="no SIGKILL")
def test_kill_9(tmp_path: Path) -> None:
    """A process that is killed leaves whole shards; the next start computes the others only."""
    code = PROGRAM.format(tests=os.fspath(Path(__file__).parent), folder=os.fspath(tmp_path))
    with subprocess.Popen([sys.executable, "-c", code]) as process:
        folder = tmp_path / "shards"
        while process.poll() is None and len(list(folder.glob("*.parquet"))) < 3:
            time.sleep(0.01)
        process.send_signal(signal.SIGKILL)
    before = {name: when for name, when in shards(tmp_path).items() if name.endswith(".parquet")}
    leftover = folder / f"{'0' * 32}.1-1.partial"
    leftover.touch()
    subprocess.run([sys.executable, "-c", code], check=True)
    after = shards(tmp_path)
    assert len(before) >= 3
    assert before.items() <= after.items()
    runs = [
        parquet.read_table(folder / name, columns=["run"])["run"].to_pylist()
        for name in after
        if name.endswith(".parquet")
    ]
    assert sorted(run for part in runs for run in part) == list(range(160))


def test_all_measures_are_kept_whatever_is_asked_for(tmp_path: Path) -> None:
    run(tmp_path, measures=["peak_drift"])
    again = run(tmp_path)
    assert again.resumed == 24
    assert list(again.measures) == list(MEASURES)
