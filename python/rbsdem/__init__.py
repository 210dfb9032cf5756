"""Reinforced-concrete columns as rigid bodies joined by nonlinear springs (RBS-DEM).

SI units throughout: N, m, kg, s, rad. Axial load is positive in compression.
"""

import ast
from importlib import import_module
from pathlib import Path
from typing import Any

from rbsdem._core import version as _version

__version__ = _version()

# The stub states each name and its home, and type checkers read it too.
_HOMES = {
    alias.name: str(node.module)
    for node in ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf-8")).body
    if isinstance(node, ast.ImportFrom)
    for alias in node.names
}
#: Modules that hold what the others return, raise or read.
_RECORDS = ("curves", "errors", "motions")
__all__ = sorted(set(_HOMES) - set(_RECORDS))  # noqa: PLE0605


def __getattr__(name: str) -> Any:
    """Import a name when it is first asked for."""
    if name not in _HOMES:
        raise AttributeError(f"module 'rbsdem' has no attribute {name!r}")
    if _HOMES[name] == "rbsdem":
        return import_module(f"rbsdem.{name}")
    found = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "__version__", *_RECORDS]
