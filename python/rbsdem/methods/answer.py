"""A setting of a method, and what came of trying it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import cast

from rbsdem.results.accuracy import Answer
from rbsdem.solve.solver import Solver


@dataclass(frozen=True)
class Setting:
    """How a case is solved.

    Attributes
    ----------
    method : str
        A method of `rbsdem.time_history`, or "static".
    kinematics : str
        Level of kinematics.
    dt, tolerance : float or None
        Step [s] or tolerance, whichever the method has.
    events : str or None
        Where "rk4" changes lines: "step" or "located".
    parts : int or None
        Static: equal parts of each increment of the path; 0 where only its reversals are driven.
    rho_infinity : float or None
        Spectral radius of "hht" and "generalised_alpha"; None for the default.
    own : bool
        Whether the user gave this setting.
    """

    method: str
    kinematics: str
    dt: float | None = None
    tolerance: float | None = None
    events: str | None = None
    parts: int | None = None
    rho_infinity: float | None = None
    own: bool = False

    @property
    def solver(self) -> Solver:
        """The settings of the method."""
        names = [name for name in Solver.__annotations__ if getattr(self, name, None) is not None]
        return cast(Solver, {name: getattr(self, name) for name in names})

    @property
    def family(self) -> tuple[str, str | None, str, float | None, bool]:
        """What settings have in common that differ only in step, tolerance or parts."""
        return self.method, self.events, self.kinematics, self.rho_infinity, self.own

    @property
    def name(self) -> str:
        """The method and where it changes lines."""
        return f"{self.method}, located" if self.events == "located" else self.method

    @property
    def value(self) -> str:
        """The step, tolerance or division of the path, in words."""
        if self.dt is not None:
            return f"dt = {self.dt:.4g} s"
        if self.tolerance is not None:
            return f"tolerance = {self.tolerance:.0e}"
        if self.parts is None:
            return "step chosen"
        if self.parts == 0:
            return "reversals only"
        return "points as given" if self.parts == 1 else f"increments in {self.parts}"

    def __str__(self) -> str:
        return ", ".join(filter(None, (self.name, self.value, self.kinematics)))


@dataclass(frozen=True)
class Run:
    """A setting that was tried: its answer, or the reason why there is none.

    Attributes
    ----------
    setting : Setting
        The setting.
    answer : Answer or None
        Its answer, if there is one.
    seconds : float
        Median of the wall times of `repeats` runs [s].
    status : str
        "completed", "collapsed", "failed" (`SolveError`), "refused" (`InputError`) or "skipped".
    reason : str
        Why there is no answer; the choice of method "auto" if there is one.
    """

    setting: Setting
    answer: Answer | None
    seconds: float = float("nan")
    repeats: int = 0
    status: str = "completed"
    reason: str = ""
