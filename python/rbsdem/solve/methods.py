"""Facts of the methods of analysis, from the table of the Fortran part."""

from __future__ import annotations

from dataclasses import dataclass

from rbsdem import _core


@dataclass(frozen=True)
class Method:
    """The facts of a method.

    Attributes
    ----------
    name : str
        Name in `time_history(method=...)` and in a case file.
    order : int
        Order of accuracy; 0 for "static" and "auto".
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
        the responses of ``studies/error_classes.py``. 0 for "static" (round-off), and for "auto",
        which has those of the method that it chooses.
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


_SETTINGS = ("dt", "events", "tolerance", "rho_infinity", "allow_unstable")

#: All methods by name.
METHODS = {
    row["method"]: Method(
        name=row["method"],
        order=int(row["order"]),
        kind=row["kind"],
        adaptive=row["adaptive"] == "yes",
        settings=frozenset(name for name in _SETTINGS if row[name] == "yes"),
        limit_share=float(row["limit_share"]),
        period_share=float(row["period_share"]),
        usual_error=float(row["usual_error"]),
        largest_error=float(row["largest_error"]),
        responses=int(row["responses"]),
    )
    for row in _core.methods()
}

#: Names of the methods in time, and of those of them that are implicit.
IN_TIME = tuple(name for name, method in METHODS.items() if method.kind != "static")
IMPLICIT = tuple(name for name, method in METHODS.items() if method.kind == "implicit")
