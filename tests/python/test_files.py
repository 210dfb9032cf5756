"""The one way in which the Python package writes files."""

from __future__ import annotations

import csv
import errno
import math
import os
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem._files import atomic_write, escape_formula, write_csv
from rbsdem.errors import InputError

SOURCES = Path(__file__).resolve().parents[2] / "python" / "rbsdem"


def names(folder: Path) -> list[str]:
    return sorted(os.listdir(folder))


def test_no_module_opens_a_file_for_writing_but_this_one():
    """A table or a figure that is written in another way would follow links and be half of one.

    A case in a scratch folder of its own is no such file.
    """
    ways = (
        'open("w',
        ".write_text(",
        ".write_bytes(",
        "savefig(",
        "savetxt(where",
        "frame.to_csv(",
    )
    for path in SOURCES.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        found = [way for way in ways if way in text]
        assert not found or path.name in ("_files.py", "case.py"), (path, found)


def test_name_comes_when_the_file_is_whole(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")
    with atomic_write(target) as file:
        file.write(b"ne")
        assert target.read_text() == "old"
        assert len(names(tmp_path)) == 2
        file.write(b"w")
    assert target.read_text() == "new"
    assert names(tmp_path) == ["table.csv"]


def test_error_leaves_the_old_file(tmp_path):
    target = tmp_path / "table.csv"
    target.write_text("old")

    def broken_off() -> None:
        with atomic_write(target) as file:
            file.write(b"half")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        broken_off()
    assert target.read_text() == "old"
    assert names(tmp_path) == ["table.csv"]


def test_a_full_disk_is_told_with_the_name_of_the_file(tmp_path):
    target = tmp_path / "table.csv"
    with pytest.raises(OSError, match=r"table\.csv'$") as caught, atomic_write(target):
        raise OSError(errno.ENOSPC, "No space left on device")
    assert caught.value.filename == str(target)
    assert names(tmp_path) == []


def test_damaged_results_are_told(tmp_path):
    """Whatever byte of the archive is wrong: a result, or InputError."""
    elastic = rbsdem.springs.Elastic(1e8)
    column = rbsdem.Column(2.0, 9.0, elastic, elastic)
    path = tmp_path / "r.npz"
    rbsdem.cyclic(column, displacement=[0.0, 0.01, 0.0]).save(path)
    data, random = path.read_bytes(), np.random.default_rng(3)
    refused = 0
    for cut in range(200):
        changed = bytearray(data[: random.integers(1, len(data))] if cut % 4 == 0 else data)
        changed[random.integers(len(changed))] ^= 1 << random.integers(8)
        path.write_bytes(changed)
        try:
            rbsdem.read_result(path)
        except InputError:
            refused += 1
    assert refused > 100


def test_temporary_name_follows_no_link_and_replaces_nothing(tmp_path):
    """Whatever has the first name that would be tried, the next is taken."""
    (tmp_path / "precious").write_text("precious")
    for number in (1, 2):
        (tmp_path / f"t.csv.{os.getpid()}-{number}.partial").symlink_to("precious")
    (tmp_path / "t.csv.partial").symlink_to("precious")
    with atomic_write(tmp_path / "t.csv") as file:
        file.write(b"new")
    assert (tmp_path / "t.csv").read_text() == "new"
    assert (tmp_path / "precious").read_text() == "precious"
    assert len(names(tmp_path)) == 5


def test_long_names(tmp_path):
    name = "ä" * 125 + ".csv"  # 254 bytes
    with atomic_write(tmp_path / name) as file:
        file.write(b"new")
    assert names(tmp_path) == [name]


def test_folder_and_pipe_without_a_reader_are_refused(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for name, words in (("", "is a folder"), ("pipe", "pipe that nobody reads")):
        with pytest.raises(InputError, match=words), atomic_write(tmp_path / name) as file:
            file.write(b"x")
    assert names(tmp_path) == ["pipe"]


def test_pipe_and_device_are_written_directly(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    got: list[bytes] = []
    reader = os.open(tmp_path / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    os.set_blocking(reader, True)

    def read() -> None:
        with os.fdopen(reader, "rb") as file:
            got.append(file.read())

    thread = threading.Thread(target=read)
    with atomic_write(tmp_path / "pipe") as file:
        thread.start()
        file.write(b"x" * 200_000)
    thread.join()
    assert got == [b"x" * 200_000]
    with pytest.raises(OSError, match="No space"), atomic_write("/dev/full") as file:
        file.write(b"x")
    assert not Path("/dev/full").is_file()


def test_standard_output_is_not_replaced(tmp_path):
    program = "from rbsdem._files import write_csv; write_csv('/dev/stdout', [('name',), (1.5,)])"
    with open(tmp_path / "out.txt", "wb") as file:
        subprocess.run([sys.executable, "-c", program], stdout=file, check=True)
    assert (tmp_path / "out.txt").read_text() == "name\n1.5\n"


def test_cells_of_a_table(tmp_path):
    """Numbers keep their sign; a text that a spreadsheet would calculate gets an apostrophe."""
    texts = ["=1+1", "+1", "-1", "@SUM(A1)", "\t=1", "\r=1", "a=b", "5", ""]
    write_csv(tmp_path / "t.csv", [texts, [-1.5, 2, None, math.nan, math.inf, True, 1 / 3]])
    with (tmp_path / "t.csv").open(newline="") as file:
        first, second = csv.reader(file)
    assert first == ["'=1+1", "'+1", "'-1", "'@SUM(A1)", "'\t=1", "'\n=1", "a=b", "5", ""]
    assert second == ["-1.5", "2", "", "", "", "True", "0.333333"]
    assert [escape_formula(text) for text in texts] == first
