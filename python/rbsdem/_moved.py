"""Modules with a new name: importing the old one raises an error that gives the new one."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType

# From old to new names.
MOVED = {
    "rbsdem.trade": "rbsdem.accuracy",
    "rbsdem.results": "rbsdem.result",
    "rbsdem.loops": "rbsdem.comparison (loop_metrics is rbsdem.compare)",
    "rbsdem.cycles": "rbsdem.comparison",
    "rbsdem.calibration.parameter": "rbsdem.parameter",
    "rbsdem.peer.blind": "rbsdem.section.model",
    "rbsdem.peer.layers": "rbsdem.section.hinge",
    "rbsdem.peer.shear": "rbsdem.section.shear_model",
    "rbsdem.peer.strips": "rbsdem.section.strips",
    "rbsdem.section.shapes": "rbsdem.section",
    "rbsdem.section.shear": "rbsdem.section.shear_diagram and rbsdem.section.shear_spring",
    "rbsdem.peer.Hinge": "rbsdem.section.HingeParameters",
    "rbsdem.peer.LayeredColumn": "rbsdem.section.LayeredColumn",
    "rbsdem.peer.MODELS": "rbsdem.section.MODELS",
    "rbsdem.peer.ShearNumbers": "rbsdem.section.ShearParameters",
}


class MovedFinder(MetaPathFinder):
    """Finder that Python asks for a module if no other finder has found it."""

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None = None,
        target: ModuleType | None = None,
    ) -> ModuleSpec | None:
        """Raise `ImportError` for a module that has moved; return None for all others."""
        if fullname in MOVED:
            raise ImportError(f"the module {fullname} is now {MOVED[fullname]}", name=fullname)
        return None


def install() -> None:
    """Append the finder to `sys.meta_path`, once."""
    if not any(isinstance(finder, MovedFinder) for finder in sys.meta_path):
        sys.meta_path.append(MovedFinder())


def moved_attribute(module: str, name: str) -> AttributeError:
    """Return the error for an attribute that a package does not have."""
    full = f"{module}.{name}"
    if full in MOVED:
        return AttributeError(f"{full} is now {MOVED[full]}", name=name)
    return AttributeError(f"module {module!r} has no attribute {name!r}", name=name)
