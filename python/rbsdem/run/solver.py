"""The settings of a method, and the facts of all methods from the table of the Fortran part."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal, TypedDict

from rbsdem import _arguments, _core

#: Names of the methods of static paths, and of those in time.
PathMethod = Literal["static", "newton"]
MethodName = Literal["auto", "rk4", "rk45", "newmark", "hht", "generalised_alpha"]


class Solver(TypedDict, total=False):
    """The settings of a method in time, as keywords of the analyses in time.

    ``time_history(column, motion, method="newmark", dt=0.01)``; settings that several analyses
    share: ``settings = Solver(method="newmark", dt=0.01)``, ``ensemble(columns, motions,
    **settings)``.

    Attributes
    ----------
    method : {"auto", "rk4", "rk45", "newmark", "hht", "generalised_alpha"}
        "auto" lets the program choose; `summary["method"]` and `summary["reason"]` report its
        choice. "rk4" is classical Runge-Kutta with a fixed step (the paper's scheme), "rk45"
        Runge-Kutta 5(4) with error control. The others are implicit: average acceleration,
        Hilber-Hughes-Taylor, generalised-alpha. The default is "auto" with ground motion; with a
        lateral force alone the method must be named.
    dt : float
        Step [s]. If it divides every interval of `time`, rows are kept at `time`; otherwise the
        steps run from the first to the last time and a row is kept after each. Without `dt` the
        method chooses the step; "rk4" divides every interval into equal steps not longer than a
        fifth of the stability limit.
    events : {"step", "located"}
        For "rk4": a spring changes its line at the end of a step ("step", the default), or the step
        is cut where the line ends ("located").
    tolerance : float
        For "rk45" and "auto": allowed relative error of a step in the energy norm. The default is
        1e-6.
    rho_infinity : float
        For "hht" and "generalised_alpha": spectral radius at infinite frequency; 1 means no
        numerical damping. The default is 0.8.
    allow_unstable : bool
        For "rk4": accept a `dt` beyond the stability limit.
    max_seconds : float
        A run that takes longer [s] is "stopped", with the rows up to there.
    """

    method: MethodName | None
    dt: float | None
    events: Literal["step", "located"] | None
    tolerance: float | None
    rho_infinity: float | None
    allow_unstable: bool
    max_seconds: float | None


def checked_solver(given: Mapping[str, Any], who: str) -> dict[str, Any]:
    """Return the settings of a method that are given.

    Raises
    ------
    TypeError
        For a name that is no setting, as for any keyword that a function does not have.
    """
    names = Solver.__annotations__
    for name in given:
        if name not in names:
            raise TypeError(f"{who}() got an unexpected keyword argument {name!r}")
    unstable = _arguments.boolean(given.get("allow_unstable", False), "allow_unstable")
    chosen = {**given, "allow_unstable": unstable or None}
    return {name: chosen[name] for name in names if chosen.get(name) is not None}


@dataclass(frozen=True)
class Method:
    """The facts of a method.

    Attributes
    ----------
    name : str
        Name in `time_history(method=...)` and in a case file.
    order : int
        Order of accuracy; 0 for static paths and "auto".
    kind : {"static", "choice", "explicit", "implicit"}
        "choice" is "auto", which stands for one of the others.
    adaptive : bool
        Whether the length of its steps follows from a tolerance.
    settings : frozenset of str
        Which of dt, events, tolerance, rho_infinity and allow_unstable it takes.
    limit_share, period_share : float
        The step that the method chooses, as a share of the stability limit of "rk4" and of the
        longest natural period; 0 if it does not depend on that. For "rk45" it is the longest step.
    usual_error, largest_error : float
        Errors at this step, or at the tolerance by default, over the peaks: median and largest of
        the responses of ``studies/error_classes.py``, of "newton" of the frames in
        ``docs/plans.md``. 0 for "static" (round-off), and for "auto", which has those of the method
        that it chooses.
    responses : int
        How many responses these are.
    """

    name: str
    order: int
    kind: str
    adaptive: bool
    settings: frozenset[str]
    limit_share: float
    period_share: float
    usual_error: float
    largest_error: float
    responses: int


#: Columns of the table of methods: which settings a method takes, and its numbers.
_SETTINGS = ("dt", "events", "tolerance", "rho_infinity", "allow_unstable")
_NUMBERS = ("limit_share", "period_share", "usual_error", "largest_error")

#: All methods by name.
METHODS = {
    row["method"]: Method(
        name=row["method"],
        order=int(row["order"]),
        kind=row["kind"],
        adaptive=row["adaptive"] == "yes",
        settings=frozenset(name for name in _SETTINGS if row[name] == "yes"),
        **{name: float(row[name]) for name in _NUMBERS},
        responses=int(row["responses"]),
    )
    for row in _core.methods()
}

#: Drift that counts as a collapse, where runs need one and none is given: of a storey of a frame,
#: of a column the displacement of the top over the height.
COLLAPSE_DRIFT = 0.1

#: Names of the methods of static paths, of those in time, and of those of them that are implicit.
STATIC = tuple(name for name, method in METHODS.items() if method.kind == "static")
IN_TIME = tuple(name for name, method in METHODS.items() if method.kind != "static")
IMPLICIT = tuple(name for name, method in METHODS.items() if method.kind == "implicit")
