"""Files, pipes, limits and signals: what is written is whole, and nothing else is touched."""

from __future__ import annotations

import os
import resource
import signal
import subprocess
import threading
import time
from pathlib import Path

import pytest

PATIENCE = 60.0  # seconds after which a run hangs

FATAL_WORDS = ("Fortran runtime", "Backtrace", "backtrace", "SIG", "Traceback")

ELASTIC = "rule = 'elastic', k = 7e8"


def faults(result: subprocess.CompletedProcess[str], code: int) -> str:
    """Text of a failure: the code and the program's name before every line."""
    assert result.returncode == code, result
    assert result.stderr.startswith("rbsdem: ")
    assert not any(word in result.stderr for word in FATAL_WORDS), result.stderr
    return result.stderr


@pytest.fixture
def folder(case_text, tmp_path) -> Path:
    """A folder with a case and its rows, `good.txt`."""
    (tmp_path / "case.nml").write_text(case_text())
    return tmp_path


@pytest.fixture
def good(run_cli, folder) -> bytes:
    """The rows of the case."""
    assert run_cli(["run", "case.nml", "-q", "-o", "good.csv"], folder).returncode == 0
    rows = (folder / "good.csv").read_bytes()
    (folder / "good.csv").unlink()
    return rows


def long_case(dynamic_text, folder: Path, name: str, steps: int = 4_000_000) -> None:
    """An elastic column shaken for so many steps; every thousandth has a row."""
    (folder / "ground.csv").write_text("time_s,acceleration_g\n0,0.1\n0.3,-0.1\n1e5,0.1\n")
    text = dynamic_text(
        case=f"title = '{name}'",
        shear=ELASTIC,
        flexure=ELASTIC,
        loading="drive = 'ground_acceleration', file = 'ground.csv'",
        analysis=f"method = 'rk4', dt = 1e-4, duration = {steps * 1e-4!r}",
        output="every = 1000",
    )
    (folder / f"{name}.nml").write_text(text)


# ---- output: own names ---------------------------------------------------------------------------


@pytest.mark.parametrize("link", [False, True])
def test_file_or_link_with_the_ending_partial_is_left_alone(run_cli, folder, good, link):
    """Neither replaced nor followed, whether the run succeeds or not."""
    there = folder / "out.csv.partial"
    (folder / "precious").write_text("precious")
    if link:
        there.symlink_to("precious")
    else:
        there.write_text("precious")
    assert run_cli(["run", "case.nml", "-q", "-o", "out.csv"], folder).returncode == 0
    assert (folder / "out.csv").read_bytes() == good
    assert there.read_text() == (folder / "precious").read_text() == "precious"
    assert there.is_symlink() == link


@pytest.mark.parametrize("kind", ["file", "link", "folder", "earlier rows"])
def test_failed_run_keeps_its_rows_beside_what_is_there(run_cli, case_text, folder, kind):
    """As OUT.partial if that is free or was left by an earlier run, else under its own name."""
    weak = "rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 0"
    loading = "drive = 'force', amplitudes = 1e5, points = 4"
    (folder / "case.nml").write_text(case_text(shear=weak, loading=loading))
    there = folder / "out.csv.partial"
    if kind == "folder":
        there.mkdir()
    elif kind == "link":
        (folder / "precious").write_text("# rbsdem is mine")
        there.symlink_to("precious")
    else:
        there.write_text("# rbsdem 0\n" if kind == "earlier rows" else "precious")
    text = faults(run_cli(["run", "case.nml", "-o", "out.csv"], folder), 1)
    name = text.rstrip().rsplit(" ", 1)[1]
    assert (name == "out.csv.partial") == (kind == "earlier rows")
    assert (folder / name).read_bytes().count(b"\n") > 4
    if kind == "file":
        assert there.read_text() == "precious"
    elif kind == "link":
        assert there.is_symlink()
        assert there.read_text() == "# rbsdem is mine"
    assert not (folder / "out.csv").exists()


def test_two_processes_with_one_output_leave_whole_rows_of_one(executable, dynamic_text, tmp_path):
    """Each exits 0 since each has written its own rows whole; the last has the name."""
    rows = {}
    for name in ("one", "two"):
        long_case(dynamic_text, tmp_path, name, 200_000)
        subprocess.run([executable, "run", f"{name}.nml", "-q"], cwd=tmp_path, check=True)
        rows[name] = (tmp_path / f"{name}.csv").read_bytes()
    for _ in range(3):
        both = [
            subprocess.Popen([executable, "run", f"{n}.nml", "-q", "-o", "out.csv"], cwd=tmp_path)
            for n in rows
        ]
        assert [process.wait(PATIENCE) for process in both] == [0, 0]
        assert (tmp_path / "out.csv").read_bytes() in rows.values()
        assert not list(tmp_path.glob("*.partial"))


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT, signal.SIGHUP])
def test_stopped_run_leaves_nothing_and_the_old_output(executable, dynamic_text, tmp_path, number):
    long_case(dynamic_text, tmp_path, "case")
    (tmp_path / "case.csv").write_text("old")
    before = sorted(os.listdir(tmp_path))
    process = subprocess.Popen([executable, "run", "case.nml", "-q"], cwd=tmp_path)
    own = tmp_path / f"case.csv.{process.pid}-1.partial"
    for _ in range(60_000):
        if own.exists() and own.stat().st_size > 5000:
            break
        time.sleep(0.001)
    process.send_signal(number)
    assert process.wait(PATIENCE) == -number
    assert sorted(os.listdir(tmp_path)) == before
    assert (tmp_path / "case.csv").read_text() == "old"


def test_ignored_signals_stay_ignored(executable, dynamic_text, tmp_path):
    """As by `nohup`."""
    long_case(dynamic_text, tmp_path, "case", 400_000)
    command = ["sh", "-c", 'trap "" HUP; exec "$0" run case.nml -q', executable]
    process = subprocess.Popen(command, cwd=tmp_path)
    while not list(tmp_path.glob("*.partial")):
        assert process.poll() is None
    process.send_signal(signal.SIGHUP)
    assert process.wait(PATIENCE) == 0


def test_long_name_is_no_obstacle(run_cli, folder, good):
    """The temporary name is not longer than a disk takes."""
    name = "x" * 251 + ".csv"
    assert run_cli(["run", "case.nml", "-q", "-o", name], folder).returncode == 0
    assert (folder / name).read_bytes() == good


# ---- limits --------------------------------------------------------------------------------------


@pytest.mark.parametrize("points", [20, 20_000])
def test_limit_of_file_sizes_is_told_and_the_old_output_stays(run_cli, case_text, folder, points):
    """Few rows fail when the file is closed, many on the way; as on a full disk."""
    loading = f"drive = 'displacement', amplitudes = 0.01, points = {points}"
    (folder / "case.nml").write_text(case_text(loading=loading))
    (folder / "out.csv").write_text("old")
    result = run_cli(
        ["run", "case.nml", "--output", "out.csv"],
        folder,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (4096, 4096)),
    )
    text = faults(result, 1)
    assert "cannot write all of out.csv" in text
    assert "limit" in text
    assert sorted(os.listdir(folder)) == ["case.nml", "out.csv"]
    assert (folder / "out.csv").read_text() == "old"


@pytest.mark.parametrize("points", [1, 20_000])
@pytest.mark.parametrize("kind", ["static", "dynamic"])
def test_full_disk_is_told(run_cli, case_text, dynamic_text, folder, points, kind):
    loading = f"drive = 'displacement', amplitudes = 0.01, points = {points}"
    text = case_text(loading=loading)
    if kind == "dynamic":
        text = dynamic_text(loading=loading.replace("displacement", "force") + ", period = 1.0")
    (folder / "case.nml").write_text(text)
    text = faults(run_cli(["run", "case.nml", "--output", "/dev/full"], folder), 1)
    assert "cannot write all of /dev/full" in text
    assert "free some space" in text


def test_lack_of_memory_is_told(run_cli, case_text, folder):
    """The limits lie between what the program needs for a small case and what the large one needs.

    The first depends on the libraries. OpenBLAS takes a buffer for each thread when it is loaded,
    and waits for ever where there is no room for them.
    """

    def within(megabytes, *words):
        limit = megabytes << 20
        return run_cli(
            words,
            folder,
            env=os.environ | {"OPENBLAS_NUM_THREADS": "1"},
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)),
        )

    (folder / "small.nml").write_text(case_text())
    too_little, enough = 4, 4096
    assert within(enough, "check", "small.nml").returncode == 0
    while enough - too_little > 1:
        middle = (too_little + enough) // 2
        if within(middle, "check", "small.nml").returncode == 0:
            enough = middle
        else:
            too_little = middle
    (folder / "small.nml").unlink()
    (folder / "case.nml").write_text(case_text(column="n = 10000, height = 1.6, mass = 614.4"))
    assert run_cli(["check", "case.nml"], folder).returncode == 0
    for more in (1, 4, 8):
        result = within(enough + more, "run", "case.nml", "-o", "out.csv")
        assert "not enough memory" in faults(result, 1)
        assert os.listdir(folder) == ["case.nml"]


# ---- pipes ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("case", ["-", "/dev/stdin"])
def test_case_from_a_pipe(executable, folder, good, case):
    text = (folder / "case.nml").read_bytes()
    command = [executable, "run", case, "-q", "-o", "out.csv"]
    subprocess.run(command, cwd=folder, input=text, check=True, timeout=PATIENCE)
    assert (folder / "out.csv").read_bytes() == good
    # Its rows have no name of their own.
    result = subprocess.run(
        [executable, "run", case], cwd=folder, input=text, capture_output=True, check=False
    )
    assert (result.returncode, result.stdout) == (2, b"")
    assert b"/dev/stdin has no name for its rows; give one with --output" in result.stderr
    assert sorted(os.listdir(folder)) == ["case.nml", "out.csv"]


def test_history_through_a_pipe_is_that_of_a_file(executable, case_text, tmp_path):
    """Longer than the buffer of a pipe, written in pieces."""
    rows = "".join(f"{1e-3 * (i % 40)!r}\n" for i in range(60_000)).encode()
    (tmp_path / "history.csv").write_bytes(b"displacement_m\n" + rows)
    os.mkfifo(tmp_path / "pipe")
    for name in ("history.csv", "pipe"):
        loading = f"drive = 'displacement', file = '{name}'"
        (tmp_path / f"{name}.nml").write_text(case_text(loading=loading))

    def feed() -> None:
        with open(tmp_path / "pipe", "wb", buffering=0) as pipe:
            pipe.write(b"displacement_m\n")
            for at in range(0, len(rows), 50_000):
                time.sleep(0.01)
                pipe.write(rows[at : at + 50_000])

    writer = threading.Thread(target=feed)
    writer.start()
    for name in ("pipe", "history.csv"):
        command = [executable, "run", f"{name}.nml", "-q", "-o", f"{name}.out"]
        subprocess.run(command, cwd=tmp_path, check=True, timeout=PATIENCE)
    writer.join()
    head, whole = ((tmp_path / f"{n}.out").read_bytes() for n in ("pipe", "history.csv"))
    assert head == whole


def test_pipe_that_nobody_writes_to_is_told(run_cli, folder):
    os.mkfifo(folder / "pipe")
    text = faults(run_cli(["run", "pipe", "-o", "out.csv"], folder), 2)
    assert "pipe: is a pipe that nobody writes to; start its writer first" in text
    closed = run_cli(["run", "-", "-o", "out.csv"], folder, stdin=subprocess.DEVNULL)
    assert "-: is empty" in faults(closed, 2)


def test_pipe_that_nobody_reads_is_told(run_cli, folder):
    os.mkfifo(folder / "pipe")
    text = faults(run_cli(["run", "case.nml", "-o", "pipe"], folder), 2)
    assert "pipe is a pipe that nobody reads" in text
    assert "--output" in text


@pytest.mark.parametrize("output", ["-", "/dev/stdout"])
@pytest.mark.parametrize("into", ["pipe", "file"])
def test_rows_on_standard_output(executable, folder, good, output, into):
    """The rows and nothing else; a file that takes standard output is not replaced."""
    command = [executable, "run", "case.nml", "-o", output]
    if into == "pipe":
        out = subprocess.run(command, cwd=folder, stdout=subprocess.PIPE, check=True).stdout
    else:
        with open(folder / "out.txt", "wb") as file:
            subprocess.run(command, cwd=folder, stdout=file, check=True)
        out = (folder / "out.txt").read_bytes()
    assert out == good


def test_rows_through_a_slow_reader_are_whole(executable, case_text, folder):
    """More than the buffer of a pipe: the writer waits and loses nothing."""
    loading = "drive = 'displacement', amplitudes = 0.01, points = 2000"
    (folder / "case.nml").write_text(case_text(loading=loading))
    subprocess.run([executable, "run", "case.nml", "-q", "-o", "f.csv"], cwd=folder, check=True)
    os.mkfifo(folder / "pipe")
    reader = os.open(folder / "pipe", os.O_RDONLY | os.O_NONBLOCK)
    process = subprocess.Popen([executable, "run", "case.nml", "-q", "-o", "pipe"], cwd=folder)
    time.sleep(0.2)
    os.set_blocking(reader, True)
    with os.fdopen(reader, "rb") as file:
        assert file.read() == (folder / "f.csv").read_bytes()
    assert process.wait(PATIENCE) == 0


@pytest.mark.parametrize("restored", [True, False])
def test_reader_that_leaves_ends_the_program_quietly(executable, folder, restored):
    """As `rbsdem keys | head -1`: killed by SIGPIPE, also where Python ignored it before."""
    reader, writer = os.pipe()
    os.close(reader)
    process = subprocess.Popen(
        [executable, "keys"], stdout=writer, stderr=subprocess.PIPE, restore_signals=restored
    )
    os.close(writer)
    assert process.communicate(timeout=PATIENCE)[1] == b""
    assert process.returncode == -signal.SIGPIPE
