"""Imports between the rooms of the package keep the contracts of pyproject.toml."""

from __future__ import annotations

import re
import subprocess
import sys

import pytest
from conftest import REPOSITORY

#: Reads the sources: an editable installation shows the linter an empty folder.
LINT = """
import sys
sys.meta_path[:] = [finder for finder in sys.meta_path if "Mesonpy" not in type(finder).__name__]
sys.path.insert(0, "python")
from importlinter.cli import lint_imports_command
lint_imports_command()
"""


def test_the_contracts_are_kept():
    pytest.importorskip("importlinter")
    done = subprocess.run(
        [sys.executable, "-c", LINT],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout


def test_no_room_asks_another_by_a_text():
    """A text in place of an import hides an arrow from the contracts."""
    allowed = ("__init__.py", "cli/__init__.py")
    package = REPOSITORY / "python" / "rbsdem"
    asks = re.compile(r"(?:import_module|__import__)\(f?[\"']rbsdem")
    found = [
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        if asks.search(path.read_text(encoding="utf-8"))
    ]
    assert set(found) <= set(allowed)
