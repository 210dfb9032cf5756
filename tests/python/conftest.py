"""Shared by the tests: the executable, cases as text, the folder of the measured histories."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from rbsdem import __main__ as program

TIMEOUT = 20.0  # seconds; no test asks for more than a few

REPOSITORY = Path(__file__).resolve().parents[2]

# Column 1 of table 3 of the paper, driven to 0.005 and 0.01 of its height; a group a line.
GROUPS = {
    "case": "title = 'minimal'",
    "column": "height = 1.6, mass = 614.4",
    "shear": "rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6",
    "flexure": "rule = 'takeda', k_c = 2.5428e8, d_c = 3.1891e-4, k_y = 6.2937e7, "
    "d_y = 2.7183e-3, k_u = 7.5772e6, b1 = 0.22",
    "loading": "drive = 'displacement', amplitudes = 0.005, 0.01, points = 4",
}

# The same column at rest, and the ground begins to move.
DYNAMIC = {
    "loading": "drive = 'ground_acceleration', amplitudes = 3.0, period = 0.1, points = 4",
    "analysis": "method = 'rk4'",
}


@pytest.fixture(autouse=True, scope="session")
def _default_signals() -> None:
    """Give tests the signals of a terminal: what runs in the background inherits ignored ones."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    if hasattr(signal, "SIGHUP"):
        signal.signal(signal.SIGHUP, signal.SIG_DFL)


Run = Callable[..., subprocess.CompletedProcess[str]]
Groups = str | Sequence[str] | None


@pytest.fixture(scope="session")
def executable() -> Path:
    """The Fortran executable; RBSDEM_EXECUTABLE names another one (such as the checked build)."""
    path = Path(os.environ.get("RBSDEM_EXECUTABLE") or program.executable()).absolute()
    assert path.is_file(), f"{path} is not there"
    return path


@pytest.fixture(scope="session")
def run_cli(executable: Path) -> Run:
    """Run the executable: run_cli(arguments, cwd) -> CompletedProcess with text."""

    def run(
        arguments: Sequence[str | os.PathLike[str]], cwd: Path | None = None, **options
    ) -> subprocess.CompletedProcess[str]:
        options = {"stdin": subprocess.DEVNULL, "timeout": TIMEOUT} | options
        if not {"stdout", "stderr", "capture_output"} & set(options):
            options["capture_output"] = True
        return subprocess.run(
            [executable, *arguments],
            cwd=cwd,
            encoding="utf-8",
            errors="replace",
            check=False,
            **options,
        )

    return run


@pytest.fixture
def command(monkeypatch, capfd) -> Run:
    """Run a command of the package in this process: command(*words, folder) -> CompletedProcess."""

    def run(*words: str | os.PathLike[str], folder: Path | None = None):
        capfd.readouterr()
        with monkeypatch.context() as patch:
            patch.setattr(sys, "argv", ["rbsdem", *map(os.fspath, words)])
            patch.setattr(os, "execv", None)  # the executable would take the place of the tests
            if folder is not None:
                patch.chdir(folder)
            code = program.main()
        return subprocess.CompletedProcess(words, code, *capfd.readouterr())

    return run


@pytest.fixture
def without_figures(monkeypatch) -> None:
    """Let reports be written without their figures, which take longer than all else."""
    monkeypatch.setattr("rbsdem.web.sheets._image", lambda draw: "")


@pytest.fixture(scope="session")
def case_text() -> Callable[..., str]:
    """Text of the minimal case, its groups replaced, added, doubled (list) or left out (None)."""

    def text(**changes: Groups) -> str:
        groups: dict[str, Groups] = dict(GROUPS) | changes
        lines = []
        for name, entries in groups.items():
            several = [entries] if isinstance(entries, str) else entries or []
            lines += [f"&{name} {entry} /" for entry in several]
        return "\n".join(lines) + "\n"

    return text


@pytest.fixture(scope="session")
def dynamic_text(case_text: Callable[..., str]) -> Callable[..., str]:
    """The same for the minimal case in time."""
    return lambda **changes: case_text(**(DYNAMIC | changes))


@pytest.fixture(scope="session")
def read_csv() -> Callable[[Path], dict[str, np.ndarray]]:
    """Columns of a csv by name, every number as Python reads it."""

    def read(path: Path) -> dict[str, np.ndarray]:
        lines = [line for line in path.read_text("utf-8").splitlines() if not line.startswith("#")]
        rows = np.array([[float(word) for word in line.split(",")] for line in lines[1:]])
        names = lines[0].split(",")
        return dict(zip(names, rows.reshape(-1, len(names)).T, strict=True))

    return read


@pytest.fixture(scope="session")
def peer_folder() -> Path:
    """Folder of the measured histories of the PEER database, which is no part of the project."""
    named = os.environ.get("RBSDEM_PEER_DIR")
    folder = Path(named) if named else REPOSITORY.parent / "shared" / "peer"
    if not folder.is_dir():
        pytest.skip(
            f"the PEER histories are not in {folder}; name their folder with RBSDEM_PEER_DIR"
        )
    return folder
