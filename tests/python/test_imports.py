"""What the contracts of import-linter in pyproject.toml cannot see."""

from __future__ import annotations

import re

from conftest import REPOSITORY


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
