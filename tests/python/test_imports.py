"""Imports between the rooms of the package keep the contracts of pyproject.toml."""

from __future__ import annotations

import subprocess
import sys

import pytest
from conftest import REPOSITORY


def test_the_contracts_are_kept():
    pytest.importorskip("importlinter")
    code = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=REPOSITORY,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
