"""Reinforced-concrete columns as rigid bodies joined by nonlinear springs (RBS-DEM).

SI units throughout: N, m, kg, s, rad. Axial load is positive in compression.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rbsdem._core import version as _version

if TYPE_CHECKING:
    from rbsdem import codes as codes
    from rbsdem import curves as curves
    from rbsdem import errors as errors
    from rbsdem import fragility as fragility
    from rbsdem import frames as frames
    from rbsdem import motions as motions
    from rbsdem import peer as peer
    from rbsdem import plot as plot
    from rbsdem import section as section
    from rbsdem import springs as springs
    from rbsdem.calibration.fit import calibrate as calibrate
    from rbsdem.curves.scores import compare as compare
    from rbsdem.errors import InputError as InputError
    from rbsdem.errors import Interrupted as Interrupted
    from rbsdem.errors import SolveError as SolveError
    from rbsdem.many.ensemble import ensemble as ensemble
    from rbsdem.many.ida import ida as ida
    from rbsdem.measured.laboratory import read_test as read_test
    from rbsdem.methods.study import compare_methods as compare_methods
    from rbsdem.model.column import Column as Column
    from rbsdem.model.column import Footing as Footing
    from rbsdem.model.damping import Damping as Damping
    from rbsdem.model.frame import Frame as Frame
    from rbsdem.model.frame import FrameMember as FrameMember
    from rbsdem.model.materials import Concrete as Concrete
    from rbsdem.model.materials import Layout as Layout
    from rbsdem.model.materials import Spiral as Spiral
    from rbsdem.model.materials import Steel as Steel
    from rbsdem.model.materials import Ties as Ties
    from rbsdem.model.shape import CircularSection as CircularSection
    from rbsdem.model.shape import RectangularSection as RectangularSection
    from rbsdem.motions.motion import GroundMotion as GroundMotion
    from rbsdem.motions.read import read_motions as read_motions
    from rbsdem.results.case import read_case as read_case
    from rbsdem.results.case import read_result as read_result
    from rbsdem.results.result import Result as Result
    from rbsdem.results.result import cyclic as cyclic
    from rbsdem.results.result import pushover as pushover
    from rbsdem.results.result import time_history as time_history
    from rbsdem.solve.analysis import matrices as matrices
    from rbsdem.solve.analysis import modes as modes
    from rbsdem.solve.protocol import protocol as protocol
    from rbsdem.solve.solver import Solver as Solver

__version__ = _version()

#: Where the public names are; each module is imported when it is first asked for.
_HOMES = {
    "calibration.fit": ("calibrate",),
    "curves.scores": ("compare",),
    "errors": ("InputError", "Interrupted", "SolveError"),
    "many.ensemble": ("ensemble",),
    "many.ida": ("ida",),
    "measured.laboratory": ("read_test",),
    "methods.study": ("compare_methods",),
    "model.column": ("Column", "Footing"),
    "model.damping": ("Damping",),
    "model.frame": ("Frame", "FrameMember"),
    "model.materials": ("Concrete", "Layout", "Spiral", "Steel", "Ties"),
    "model.shape": ("CircularSection", "RectangularSection"),
    "motions.motion": ("GroundMotion",),
    "motions.read": ("read_motions",),
    "results.case": ("read_case", "read_result"),
    "results.result": ("Result", "cyclic", "pushover", "time_history"),
    "solve.analysis": ("matrices", "modes"),
    "solve.protocol": ("protocol",),
    "solve.solver": ("Solver",),
}
_MODULE_OF = {name: home for home, names in _HOMES.items() for name in names}
#: Public modules, and those that hold what the names above return, raise or read.
_MODULES = ("codes", "fragility", "frames", "peer", "plot", "section", "springs")
_RECORDS = ("curves", "errors", "motions")

__all__ = sorted([*_MODULE_OF, *_MODULES])  # noqa: PLE0605


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name in (*_MODULES, *_RECORDS):
        return import_module(f"rbsdem.{name}")
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'rbsdem' has no attribute {name!r}")
    found = getattr(import_module(f"rbsdem.{_MODULE_OF[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "__version__", *_RECORDS]
