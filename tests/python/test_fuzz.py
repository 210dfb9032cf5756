"""Fuzzing: 400 mutated namelists and 400 mutated history files.

No crash, no hang, no traceback: exit code 0, 1 or 2, a message that begins with `rbsdem: ` where
it is not 0, finite numbers where it is. The seed is fixed; what fails is kept in the folder of the
test and named in the report. With RBSDEM_EXECUTABLE the same cases go through another executable,
such as the one built with bounds checks and floating-point traps.
"""

from __future__ import annotations

import os
import pty
import random
import re
import select
import subprocess
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest
from conftest import REPOSITORY

import rbsdem

COUNT = 400
SEED = 19_860_704

#: A process that takes longer [s] must at least tell on a terminal how far it is, or write rows.
PATIENCE = 20.0

BAD_WORDS = re.compile(
    r"At line \d|Fortran runtime|Backtrace|SIG[A-Z]{3}|Error termination|free\(\)|malloc|"
    r"corrupt|Traceback|terminate called"
)

SPRINGS = """&shear rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6 /
&flexure rule = 'takeda', k_c = 2.5428e8, d_c = 3.1891e-4, k_y = 6.2937e7, d_y = 2.7183e-3,
         k_u = 7.5772e6, b0 = 0.4, b1 = 0.22, inner = 'kc' /
"""

#: The cases of tests/regression but the long one, and forms that they do not have.
NAMELISTS = {
    path.stem: path.read_text("utf-8")
    for path in sorted((REPOSITORY / "tests" / "regression").glob("*.nml"))
    if "slow" not in path.stem
} | {
    "joints": """&case title = "three joints, don't mind" /
&column n = 3, height = 1.6, lengths = 0.4, 0.5, 0.7, masses = 3*200., kinematics = 'pdelta',
         axial_load = 744e3, self_weight = .true., gravity = 9.81 /
&shear rule = 'elastic', k = 7e8 /
&shear joint = 2, rule = 'bilinear', k = 7e8, d_y = 1e-4, k_post = 8e6 /
&flexure joint = 1, rule = 'takeda', k_c = 2.5d8, d_c = 3e-4, k_y = 6e7, d_y = 2.7e-3, k_u = 7e6,
         inner = 'kr', b1 = 0.9 /
&flexure joint = 2, rule = 'takeda', k_c = 2.5d8, d_c = 3e-4, k_y = 6e7, d_y = 2.7e-3, k_u = 7e6,
         inner = 'one' /
&flexure joint = 3, rule = 'bilinear', k = 2.5d8, d_y = 1e-3, k_post = 1e7 /
&loading drive = 'displacement', amplitudes(1) = 10, amplitudes(2) = 20, unit = 'mm', points = 2 /
""",
    "both": """&column height = 1.6 mass = 614.4, kinematics = 'finite', axial_load = 1.0e5,
         self_weight = T /
"""
    + SPRINGS
    + """&loading drive = 'force', amplitudes = 20., unit = 'kN', period = 0.004, points = 3 /
&loading drive = 'ground_acceleration', file = 'still.csv', interval = 0.001, unit = 'g' /
&analysis method = 'rk4', dt = 1.0e-4 /
""",
}

PAIRS = [(0, 0), (1.5, 40.25), (3.125, 75), (-2.5, -60.5), (-6.75, -99.125), (0.25, 3), (9.5, 110)]

HISTORIES = {
    "test.txt": '"Soesianawati, No 1"\t\t\n7\t0\n' + "".join(f"{d}\t{f}\t\n" for d, f in PAIRS),
    "axial.txt": "Third column\r\n7\r\n" + "".join(f"{d:.3f}\t{f:.2f}\t744\r\n" for d, f in PAIRS),
    "test.csv": "# a comment\ndisplacement_mm,force_kN\n" + "".join(f"{d},{f}\n" for d, f in PAIRS),
    "semi.csv": '"displacement_m";"force_N";x\n'
    + "".join(f"{d / 1e3:e};{f * 1e3:E};1d0\n" for d, f in PAIRS),
    "plain.csv": "".join(f"  {d}   {f}\n" for d, f in PAIRS),
}

GROUND = "time_s,acceleration_g\n" + "".join(f"{k / 500},{(k % 3) / 10}\n" for k in range(6))

JUNK = [
    b"\0", b"\x01", b"\x1a", b"\x7f", b"\xff", b"\xc3", "½".encode(), "\u202e".encode(),
    "\ufeff".encode(), b"'", b'"', b"''", b'"\'"', b"'\"'\"", b"&", b"/", b"!", b"=", b",", b",,",
    b";", b"*", b"(", b")", b"(2)", b"(1:2)", b"(0)", b"(99999999)", b"%", b"$", b"\\", b"\t",
    b"\r", b"\n", b"\n\n", b"\r\n", b" ", b"#", b"&end", b"&shear", b"&column /", b"/ &loading",
    b"joint = 1", b"n = 3", b"every = 3", b"NaN", b"-inf", b"Infinity", b".true.", b"3*", b"3*4",
    b"1,5", b"1/2", b"0x10", b"1e", b"e5", b"--1", b"+", b"-", b".", b"..", b"mm", b"kN", b"drift",
    b"finite", b"pdelta", b"rk4", b"static", b"x" * 70, b"9" * 70, b"k" * 600,
    b"'" + b"z" * 520 + b"'",
]  # fmt: skip

NUMBERS = [
    b"0", b"-0.0", b"-1", b"1e308", b"-1e308", b"1.7976931348623157e308", b"1e309", b"1e999",
    b"-1e999", b"4.9e-324", b"1e-400", b"1e-300", b"1e300", b"1e150", b"1e-150", b"1e30", b"1e-30",
    b"NaN", b"2147483647", b"-2147483648", b"2147483648", b"99999999999", b"65536", b"2000",
    b"2001", b"1e5", b"1d-5", b"0.1", b"17", b"5*1.0", b"100000*1.0", b"100001*2", b"999999999",
]  # fmt: skip

#: Parts into which a text is taken apart: some bytes, words, numbers and what is between, lines.
GRAINS = [
    rb"[\s\S]{1,20}", rb"[A-Za-z_]\w*|[\s\S]", rb"[-+]?\d[\d.]*(?:[eEdD][-+]?\d+)?|[^-+\d]+|[-+]",
    rb"[^\n]*\n|[^\n]+",
]  # fmt: skip


def mutated(rng: random.Random, text: bytes) -> bytes:
    """Return a text some of whose parts are gone, repeated, exchanged, replaced or changed."""
    parts = re.findall(rng.choice(GRAINS), text) or [b"x"]
    i, j = rng.randrange(len(parts)), rng.randrange(len(parts))
    kind = rng.randrange(9)
    if kind == 0:
        del parts[i : i + rng.choice([1, 2, 5])]
    elif kind == 1:
        parts[i] *= rng.choice([2, 3, 50, 100])
    elif kind == 2:
        parts[i], parts[j] = parts[j], parts[i]
    elif kind == 3:
        del parts[i:]
    elif kind in (4, 5):
        numbers = [k for k, part in enumerate(parts) if re.search(rb"\d", part)]
        parts[rng.choice(numbers or [i])] = rng.choice(NUMBERS)
    elif kind == 6:
        parts.insert(i, rng.choice([*JUNK, rng.randbytes(rng.choice([1, 4, 40]))]))
    elif kind == 7:
        parts[i] = bytes([parts[i][0] ^ (1 << rng.randrange(8))]) + parts[i][1:]
    else:
        some = parts[min(i, j) : max(i, j)]
        parts[min(i, j) : max(i, j)] = rng.sample(some, len(some))
    return b"".join(parts) or b"\n"


def mutants(bases: dict[str, str], seed: int) -> Iterable[tuple[int, str, bytes]]:
    """Number, name of the base and text of each mutant; one to four mutations on another."""
    names = list(bases)
    for i in range(COUNT):
        rng = random.Random(seed + i)
        name = names[i % len(names)]
        text = bases[name].encode()
        for _ in range(rng.choice([1, 1, 1, 2, 2, 3, 4])):
            text = mutated(rng, text)
        yield i, name, text


def shows_progress(command: list[str | Path], cwd: Path, output: Path | None) -> bool:
    """Whether a long run shows on a terminal how far it is, or writes rows."""
    terminal, inner = pty.openpty()
    process = subprocess.Popen(
        command, cwd=cwd, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=inner
    )
    os.close(inner)
    try:
        end, shown = time.monotonic() + PATIENCE, b""
        while time.monotonic() < end:
            if select.select([terminal], [], [], 0.1)[0]:
                try:
                    shown += os.read(terminal, 4096)
                except OSError:
                    break
            if b" s left" in shown:
                return True
            partial = output and output.with_name(f"{output.name}.{process.pid}-1.partial")
            if partial and partial.exists() and partial.stat().st_size > 1_000_000:
                return True
    finally:
        process.kill()
        process.wait()
        os.close(terminal)
    return False


def not_finite(output: Path) -> bool:
    """Whether rows hold something else than finite numbers."""
    for line in output.read_bytes().splitlines():
        if not line.startswith(b"#") and re.search(rb"nan|inf|\*\*", line, re.IGNORECASE):
            return True
    return False


def fault_of(command: list[str | Path], cwd: Path, output: Path | None = None) -> str | None:
    """What is wrong with the way a process ends; None if nothing is."""
    try:
        result = subprocess.run(
            command,
            cwd=cwd,
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None if shows_progress(command, cwd, output) else "hangs"
    out = result.stdout.decode("utf-8", "replace")
    err = result.stderr.decode("utf-8", "replace")
    where = re.search(r"/(src/\S+f90:\d+)", err)
    strange = BAD_WORDS.search(err)
    silent = not err or any(not line.startswith("rbsdem: ") for line in err.split("\n")[:-1])
    code = result.returncode
    fault = None
    if code not in (0, 1, 2):
        fault = f"exit code {code} {where.group(1) if where else err[:80]!r}"
    elif strange:
        fault = f"words of the runtime: {err[strange.start() : strange.start() + 80]!r}"
    elif code and silent:
        fault = f"exit code {code} without a message of ours: {err[:80]!r}"
    elif code and out:
        fault = f"exit code {code} and a result"
    elif code == 0 and err:
        fault = f"exit code 0 with a message: {err[:80]!r}"
    elif code == 0 and re.search(r"\bnan\b|\binf(inity)?\b", out, re.IGNORECASE):
        fault = "exit code 0 with a number that is not finite"
    elif code == 0 and output and not_finite(output):
        fault = "exit code 0 with a row that is not finite"
    return fault


def report(faults: list[tuple[str, str]]) -> str:
    """One line for each kind of fault, with a file that shows it."""
    kinds: dict[str, list[str]] = {}
    for what, where in faults:
        kinds.setdefault(what, []).append(where)
    lines = [f"{len(where)} x {what}, such as {where[0]}" for what, where in kinds.items()]
    return "\n".join([f"{len(faults)} faults:", *sorted(lines)[:60]])


def judge(jobs: Iterable, check: Callable[..., list[tuple[str, str]]]) -> None:
    """Check all jobs on two threads; fail with a report."""
    with ThreadPoolExecutor(2) as pool:
        faults = [fault for found in pool.map(lambda job: check(*job), jobs) for fault in found]
    assert not faults, report(faults)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name, text in HISTORIES.items():
        (tmp_path / name).write_bytes(text.encode())
    for path in (REPOSITORY / "tests" / "regression").glob("*.txt"):
        (tmp_path / path.name).write_bytes(path.read_bytes())
    (tmp_path / "motion.csv").write_text(GROUND)
    (tmp_path / "still.csv").write_text("acceleration\n0\n0.1\n0\n")
    return tmp_path


def driven(name: str) -> str:
    """A case that a history of any kind drives; one without names gives its column."""
    keys = ", column = '2'" if name.endswith("plain.csv") else ""
    return f"""&column height = 1.6, mass = 614.4 /
{SPRINGS}&loading drive = 'force', file = '{name}', scale = 0.1{keys} /
"""


def shaken(name: str) -> str:
    """A slow column under a ground motion: times that are far apart are not long for it."""
    return f"""&column height = 10.0, mass = 1.0e9 /
{SPRINGS}&loading drive = 'ground_acceleration', file = '{name}', scale = 1.0e-3 /
&analysis method = 'rk4' /
"""


@pytest.mark.parametrize(
    ("bases", "case_of", "share"),
    [(NAMELISTS, None, 1), (HISTORIES, driven, 1), ({"motion.csv": GROUND}, shaken, 4)],
    ids=["namelists", "histories", "ground motions"],
)
def test_mutants_end_with_rows_or_a_message(executable, folder, bases, case_of, share):
    """Times of motions, too: reversed, far apart, without a header."""

    def check(i: int, base: str, text: bytes) -> list[tuple[str, str]]:
        mutant = folder / (f"{i:04d}-{base}" if case_of else f"{i:04d}-{base}.nml")
        mutant.write_bytes(text)
        case = mutant
        if case_of:
            case = folder / f"{i:04d}.nml"
            case.write_text(case_of(mutant.name))
        output = case.with_suffix(".csv")
        commands = [["run", case.name, "--output", output.name]]
        if not case_of:
            commands += [["check", case.name], ["modes", case.name]]
        found = []
        for command in commands:
            rows = output if command[0] == "run" else None
            if fault := fault_of([executable, *command], folder, rows):
                found.append((f"{base}, {command[0]}: {fault}", case.as_posix()))
        for path in folder.glob(f"{output.name}*"):
            path.unlink()
        if not found:
            mutant.unlink()
            case.unlink(missing_ok=True)
        return found

    judge((job for job in mutants(bases, SEED) if job[0] % share == 0), check)


@pytest.mark.filterwarnings("ignore")
def test_mutated_histories_in_python(folder):
    """`read_peer` raises InputError and nothing else, or reads finite numbers."""
    read = 0
    for i, base, text in mutants(HISTORIES, SEED):
        path = folder / f"{i:04d}-{base}"
        path.write_bytes(text)
        try:
            test = rbsdem.peer.read_peer(path)
        except rbsdem.InputError:
            continue
        read += 1
        assert test.force.shape == test.displacement.shape, path
        assert test.force.size > 0, path
        assert np.isfinite([test.force, test.displacement]).all(), path
    # Neither door is shut: both happen often.
    assert 0.1 * COUNT < read < 0.9 * COUNT
