"""A setting, its answer, and the difference between two answers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbsdem._arguments import Array


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
class Answer:
    """The part of a result that is compared.

    Attributes
    ----------
    time, response, moment : ndarray, shape (m,)
        Times of the loading [s], top displacement [m] there (lateral force [N] if the displacement
        is driven), and moment of the lowest joint [N m].
    taken : ndarray, shape (m,)
        Energy that springs and damping have taken by then [J]: the energy dissipated and the energy
        that the springs still store.
    status : str
        "completed" or "collapsed".
    reason : str
        The method that the program chose, and why, if it was "auto".
    """

    time: Array
    response: Array
    moment: Array
    taken: Array
    status: str
    reason: str = ""

    @property
    def energy(self) -> float:
        """Energy that springs and damping have taken by the end [J]."""
        return float(self.taken[-1])

    @property
    def largest_energy(self) -> float:
        """Largest absolute value of that energy on the way [J]."""
        return float(np.abs(self.taken).max())

    @property
    def peak(self) -> float:
        """Largest absolute response over the times of the loading."""
        return float(np.abs(self.response).max())

    @property
    def residual(self) -> float:
        """Response at the end."""
        return float(self.response[-1])

    @property
    def peak_moment(self) -> float:
        """Largest absolute moment of the lowest joint over the times of the loading [N m]."""
        return float(np.abs(self.moment).max())


@dataclass(frozen=True)
class Errors:
    """Differences of an answer from another one, relative to the peaks of the other.

    Attributes
    ----------
    response_rms, response_max : float
        Root mean square and largest difference of the responses over the largest response.
    moment : float
        Root mean square difference of the base moments over the largest base moment.
    energy : float
        Difference of the energies at the end over the largest energy.
    peak : float
        Difference of the peak responses over the peak.
    """

    response_rms: float
    response_max: float
    moment: float
    energy: float
    peak: float

    @property
    def largest(self) -> float:
        """The largest of the rms of response and moment, of energy and of peak."""
        return max(self.response_rms, self.moment, self.energy, self.peak)


def errors_of(answer: Answer, other: Answer) -> Errors:
    """Return the differences of an answer from another, over the rows that both have."""
    rows = min(answer.response.size, other.response.size)
    response = answer.response[:rows] - other.response[:rows]
    moment = answer.moment[:rows] - other.moment[:rows]
    taken = answer.taken[rows - 1] - other.taken[rows - 1]
    peak = _not_zero(other.peak)
    higher = np.abs(answer.response[:rows]).max() - np.abs(other.response[:rows]).max()
    return Errors(
        response_rms=float(np.sqrt(np.mean(response**2))) / peak,
        response_max=float(np.abs(response).max()) / peak,
        moment=float(np.sqrt(np.mean(moment**2))) / _not_zero(other.peak_moment),
        energy=abs(float(taken)) / _not_zero(other.largest_energy),
        peak=abs(float(higher)) / peak,
    )


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


def _not_zero(value: float) -> float:
    return value if value > 0 else 1.0
