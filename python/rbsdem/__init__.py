"""Reinforced-concrete columns as rigid bodies joined by nonlinear springs (RBS-DEM).

SI units throughout: N, m, kg, s, rad. Axial load is positive in compression.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from rbsdem._core import version as _version

if TYPE_CHECKING:
    from rbsdem import codes, fragility, peer, plot, section, springs
    from rbsdem import curves as curves
    from rbsdem import errors as errors
    from rbsdem import motions as motions
    from rbsdem.calibration.fit import calibrate
    from rbsdem.curves.scores import compare
    from rbsdem.errors import InputError, Interrupted, SolveError
    from rbsdem.many.ensemble import ensemble
    from rbsdem.many.ida import ida
    from rbsdem.measured.laboratory import read_test
    from rbsdem.methods.measure import compare_methods
    from rbsdem.model.column import Column
    from rbsdem.model.damping import Damping
    from rbsdem.model.footing import Footing
    from rbsdem.model.materials import Concrete, Steel
    from rbsdem.model.reinforcement import Layout, Spiral, Ties
    from rbsdem.model.shape import CircularSection, RectangularSection
    from rbsdem.motions.motion import GroundMotion
    from rbsdem.motions.read import read_motions
    from rbsdem.results.case import read_case
    from rbsdem.results.result import Result, cyclic, time_history
    from rbsdem.results.saved import read_result
    from rbsdem.solve.analysis import matrices, modes
    from rbsdem.solve.protocol import protocol
    from rbsdem.solve.solver import Solver

__version__ = _version()

#: Where the public names are; each module is imported when it is first asked for.
_HOMES = {
    "calibration.fit": ("calibrate",),
    "curves.scores": ("compare",),
    "errors": ("InputError", "Interrupted", "SolveError"),
    "many.ensemble": ("ensemble",),
    "many.ida": ("ida",),
    "measured.laboratory": ("read_test",),
    "methods.measure": ("compare_methods",),
    "model.column": ("Column",),
    "model.damping": ("Damping",),
    "model.footing": ("Footing",),
    "model.materials": ("Concrete", "Steel"),
    "model.reinforcement": ("Layout", "Spiral", "Ties"),
    "model.shape": ("CircularSection", "RectangularSection"),
    "motions.motion": ("GroundMotion",),
    "motions.read": ("read_motions",),
    "results.case": ("read_case",),
    "results.result": ("Result", "cyclic", "time_history"),
    "results.saved": ("read_result",),
    "solve.analysis": ("matrices", "modes"),
    "solve.protocol": ("protocol",),
    "solve.solver": ("Solver",),
}
_MODULE_OF = {name: home for home, names in _HOMES.items() for name in names}
#: Public modules; curves, errors and motions hold what the names above return, raise or read.
_MODULES = (
    "codes",
    "curves",
    "errors",
    "fragility",
    "motions",
    "peer",
    "plot",
    "section",
    "springs",
)

__all__ = [
    "CircularSection",
    "Column",
    "Concrete",
    "Damping",
    "Footing",
    "GroundMotion",
    "InputError",
    "Interrupted",
    "Layout",
    "RectangularSection",
    "Result",
    "SolveError",
    "Solver",
    "Spiral",
    "Steel",
    "Ties",
    "calibrate",
    "codes",
    "compare",
    "compare_methods",
    "cyclic",
    "ensemble",
    "fragility",
    "ida",
    "matrices",
    "modes",
    "peer",
    "plot",
    "protocol",
    "read_case",
    "read_motions",
    "read_result",
    "read_test",
    "section",
    "springs",
    "time_history",
]


def __getattr__(name: str) -> Any:
    """Import a public name when it is first asked for."""
    if name in _MODULES:
        return import_module(f"rbsdem.{name}")
    if name not in _MODULE_OF:
        raise AttributeError(f"module 'rbsdem' has no attribute {name!r}")
    found = getattr(import_module(f"rbsdem.{_MODULE_OF[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return [*__all__, "__version__", "curves", "errors", "motions"]
