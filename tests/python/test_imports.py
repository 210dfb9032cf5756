"""Imports between the Python modules go one way: no circles, and no record knows its views."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest
from conftest import REPOSITORY

PACKAGE = REPOSITORY / "python" / "rbsdem"

# Packages that need not be installed: only they are imported inside functions.
OPTIONAL = {"distributed", "matplotlib", "pandas", "pyarrow", "rich", "scipy"}

#: Rooms that stand above the views, which draw, tabulate and write records.
ABOVE = {"output", "cli", "web"}


def modules(package: Path) -> dict[str, Path]:
    """Return the files of a package by the names of their modules."""
    found = {}
    for path in package.rglob("*.py"):
        parts = (package.name, *path.relative_to(package).with_suffix("").parts)
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


def imported(node: ast.AST, known: set[str]) -> Iterator[str]:
    """Yield the modules that code imports, inside functions too, but not for types alone."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.unparse(child.test):
            for part in child.orelse:
                yield from imported(part, known)
        elif isinstance(child, ast.Import):
            yield from (alias.name for alias in child.names)
        elif isinstance(child, ast.ImportFrom):
            for alias in child.names:
                full = f"{child.module}.{alias.name}"
                # The extension is a part of the package and no module of Python.
                yield full if full in known or alias.name == "_rbsdem" else str(child.module)
        else:
            yield from imported(child, known)


def graph(package: Path) -> dict[str, set[str]]:
    """Return for each module the modules of the same package that it imports."""
    files = modules(package)
    known = set(files)
    return {
        name: {
            other
            for other in imported(ast.parse(path.read_text(encoding="utf-8")), known)
            if other in known and other != name
        }
        for name, path in files.items()
    }


def circle(package: Path) -> list[str]:
    """Return the modules of one circle of imports, or nothing."""
    try:
        tuple(TopologicalSorter(graph(package)).static_order())
    except CycleError as error:
        return list(error.args[1])
    return []


def test_no_circles_between_modules():
    assert len(graph(PACKAGE)) > 50
    assert not circle(PACKAGE)


def test_no_record_imports_its_views():
    faults = [
        f"{name} imports {other}"
        for name, others in graph(PACKAGE).items()
        if name.count(".") > 1 and name.split(".")[1] not in ABOVE
        for other in sorted(others)
        if other.startswith("rbsdem.output")
    ]
    assert not faults


def test_functions_import_nothing_but_optional_packages():
    faults = []
    for name, path in modules(PACKAGE).items():
        if path.stem == "__main__":  # Its commands are imported only when they are run.
            continue
        for function in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(function, ast.FunctionDef):
                inside = set(imported(function, set()))
                faults += [
                    f"{name}, {function.name}: {other}"
                    for other in sorted(inside)
                    if other.split(".")[0] not in OPTIONAL
                ]
    assert not faults


@pytest.mark.parametrize(
    ("second", "found"),
    [
        ("from package.one import name\n", True),
        ("def function():\n    from package import one\n", True),
        ("import package.one\n", True),
        ("from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    import package.one\n", False),
        ("import math\n", False),
    ],
)
def test_a_circle_is_found(tmp_path, second, found):
    package = tmp_path / "package"
    package.mkdir()
    (package / "__init__.py").write_text("from package import one, two\n", encoding="utf-8")
    (package / "one.py").write_text("from package import two\n", encoding="utf-8")
    (package / "two.py").write_text(second, encoding="utf-8")
    assert bool(circle(package)) is found
