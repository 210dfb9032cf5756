"""Capacity curves and their target displacements by three methods of codes.

ASCE 41-17, 7.4.3.3.2, with the coefficients of FEMA 440; EN 1998-1:2004, annex B (N2); the capacity
spectrum of FEMA 440, chapter 6. Each is a function of a `Capacity` and a spectrum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, ArrayLike
from rbsdem.curves.envelope import Envelope, Idealisation, envelope
from rbsdem.errors import InputError
from rbsdem.motions.design import DesignSpectrum, damping_factor

#: Coefficient a of C_1 by the class of the site (ASCE 41-17, 7.4.1.3.1).
SITES = {"A": 130.0, "B": 130.0, "C": 90.0, "D": 60.0, "E": 60.0, "F": 60.0}

#: Share of the tolerance of displacements to which methods iterate, and their most passes.
_CLOSE, _PASSES = 1e-10, 400
#: Steps over a curve among which the last point of performance is looked for.
_STEPS = 150


@dataclass(frozen=True, repr=False, eq=False)
class Capacity(Tabular):
    """A push-over curve with the masses that move.

    Attributes
    ----------
    displacement, force : ndarray, shape (n,)
        Displacement of the control node and base shear, from zero to one side [m, N].
    gamma : float
        Participation of the first mode at the control node, with a shape that is 1 there.
    modal_mass : float
        m*, sum of the masses times that shape [kg].
    total_mass : float
        Mass of the building [kg].
    storeys : int
        Number of storeys.
    period, stiffness : float
        Elastic period of the first mode [s], and the slope of the curve that belongs to it [N/m].
        Either follows from the other and m*; without both the slope is that of the first line.
    pdelta_slope : float
        Slope that P-Delta alone takes from the curve [N/m].
    """

    _columns = ("displacement m", "force N")

    displacement: Array
    force: Array
    gamma: float
    modal_mass: float
    total_mass: float
    storeys: int = 1
    period: float = math.nan
    stiffness: float = math.nan
    pdelta_slope: float = 0.0

    def __post_init__(self) -> None:
        curve = envelope((self.displacement, self.force))
        object.__setattr__(self, "displacement", curve.displacement)
        object.__setattr__(self, "force", curve.force)
        for name in ("gamma", "modal_mass", "total_mass"):
            value = _arguments.number(getattr(self, name), f"Capacity: {name}", above=0.0)
            object.__setattr__(self, name, value)
        if math.isnan(self.stiffness):
            # Rows at the start of a path may differ by round-off alone.
            first = int(np.flatnonzero(curve.displacement > 1e-6 * curve.largest_displacement)[0])
            slope = float(curve.force[first] / curve.displacement[first])
            if not math.isnan(self.period):
                slope = self.modal_mass * (2.0 * math.pi / self.period) ** 2
            object.__setattr__(self, "stiffness", slope)
        if math.isnan(self.period):
            slow = 2.0 * math.pi * math.sqrt(self.modal_mass / self.stiffness)
            object.__setattr__(self, "period", slow)

    @classmethod
    def of_masses(
        cls, displacement: ArrayLike, force: ArrayLike, masses: ArrayLike, shape: ArrayLike,
        **more: Any,
    ) -> Capacity:  # fmt: skip
        """Return the curve of any program, with floor masses and the shape of the first mode.

        Parameters
        ----------
        displacement, force : array_like, shape (n,)
            Of the control node, the last floor, and base shear [m, N].
        masses, shape : array_like, shape (storeys,)
            Masses of the floors [kg] and their shares of the shape in any scale, from below.
        **more
            `period`, `stiffness`, `pdelta_slope`.
        """
        m = _arguments.finite_vector(masses, "masses")
        phi = _arguments.finite_vector(shape, "shape")
        if m.size != phi.size or not m.size or phi[-1] == 0:
            raise InputError(
                f"Capacity: {m.size} masses for a shape of {phi.size} floors; give one of each for "
                "every floor, the last one being that of the control node"
            )
        phi = phi / phi[-1]
        modal = float(m @ phi)
        gamma = modal / float(m @ phi**2)
        curve = np.asarray(displacement, float), np.asarray(force, float)
        return cls(*curve, gamma, modal, float(m.sum()), m.size, **more)

    def idealise(self, method: str, end: float) -> Idealisation:
        """Return the two straight lines of the curve up to an end [m]."""
        curve = Envelope(1, self.displacement, self.force)
        return curve.idealise(method, end=min(end, self.largest))  # type: ignore[arg-type]

    @property
    def largest(self) -> float:
        """Displacement of the last point [m]."""
        return float(self.displacement[-1])

    @property
    def peak(self) -> float:
        """Displacement at the largest force, of a plateau its end [m]."""
        return float(self.displacement[self._top])

    @property
    def _top(self) -> int:
        return int(np.flatnonzero(self.force >= (1.0 - 1e-9) * self.force.max())[-1])

    def force_at(self, displacement: float) -> float:
        """Return the base shear at a displacement [N], NaN beyond the end."""
        beyond = displacement > self.largest * (1.0 + 1e-12)
        return math.nan if beyond else float(np.interp(displacement, self.displacement, self.force))


@dataclass(frozen=True, repr=False, eq=False)
class Estimate(Tabular):
    """A target displacement by a method.

    Attributes
    ----------
    method, source : str
        "asce_41", "en_1998" or "capacity_spectrum", and its clause.
    displacement : float
        Of the control node [m], unsigned.
    lines : Idealisation
        The two straight lines of the curve.
    period : float
        Effective period of the method [s]: T_e, T* or T_eff.
    acceleration : float
        Spectral acceleration at that period and the damping of the spectrum [m/s2].
    ductility : float
        mu_strength of ASCE 41, else displacement over that at yield.
    factors : dict of str to float
        The coefficients of the method by name.
    reached : bool
        Whether the curve goes as far.
    notes : tuple of str
        What a reader has to know.
    """

    method: str
    source: str
    displacement: float
    lines: Idealisation
    period: float
    acceleration: float
    ductility: float
    factors: dict[str, float] = field(default_factory=dict)
    reached: bool = True
    notes: tuple[str, ...] = ()


def asce_41(
    curve: Capacity,
    spectrum: DesignSpectrum,
    *,
    site_class: str = "D",
    c0: float | None = None,
    cm: float | None = None,
    near_field: bool | None = None,
) -> Estimate:
    """Return the target displacement of ASCE 41-17, 7.4.3.3.2.

    delta_t = C_0 C_1 C_2 S_a (T_e/2 pi)^2 with T_e = T_i sqrt(K_i/K_e) and the lines of 7.4.3.2.4
    up to delta_t or the largest base shear, whichever comes first.

    Parameters
    ----------
    curve : Capacity
        The curve.
    spectrum : DesignSpectrum
        The demand.
    site_class : {"A", "B", "C", "D", "E", "F"}, optional
        a = 130, 130, 90, 60, 60, 60 in C_1.
    c0 : float, optional
        C_0; by default the participation of the first mode.
    cm : float, optional
        C_m; by default that of concrete moment frames in table 7-4: 1 up to two storeys and for T_e
        above 1 s, else 0.9.
    near_field : bool, optional
        Whether lambda is 0.8 in the limit mu_max, else 0.2; by default where S_a(1 s) is 0.6 g or
        more.
    """
    a = SITES[_arguments.choice(site_class, "target: site_class", SITES)]
    first = curve.gamma if c0 is None else _arguments.number(c0, "target: c0", above=0.0)
    found: dict[str, float] = {}

    def demand(end: float) -> tuple[float, Idealisation, float, float]:
        lines = curve.idealise("asce_41", end)
        period = curve.period * math.sqrt(curve.stiffness / lines.stiffness)
        sa = spectrum.sa(period)
        usual = 1.0 if curve.storeys <= 2 or period > 1.0 else 0.9
        found["C_m"] = usual if cm is None else _arguments.number(cm, "target: cm", above=0.0)
        strength = sa * found["C_m"] * curve.total_mass / lines.yield_force
        more = max(strength - 1.0, 0.0)
        found["C_1"] = 1.0 if period > 1.0 else 1.0 + more / (a * max(period, 0.2) ** 2)
        found["C_2"] = 1.0 if period > 0.7 else 1.0 + (more / period) ** 2 / 800.0
        sd = sa * (period / (2.0 * math.pi)) ** 2
        return first * found["C_1"] * found["C_2"] * sd, lines, period, strength

    end = _settled(lambda u: demand(u)[0], curve.peak)
    target, lines, period, strength = demand(end)
    limit, softening = _most_strength(curve, lines, spectrum, near_field, period)
    notes = []
    if strength > limit:
        notes.append(
            f"mu_strength = {strength:.3g} is above mu_max = {limit:.3g}: a nonlinear static "
            "procedure is not allowed (ASCE 41-17, 7.3.2.1); look at records."
        )
    factors = {"C_0": first, **found, "mu_max": limit, "alpha_1": lines.post_yield_ratio}
    return Estimate(
        "asce_41", "ASCE 41-17, 7.4.3.3.2", target, lines, period, spectrum.sa(period), strength,
        factors | softening, target <= curve.largest * (1 + 1e-9), tuple(notes),
    )  # fmt: skip


def _settled(demand: Callable[[float], float], most: float) -> float:
    """Return the end at which a demand meets itself, or the most; by bisection."""
    if demand(most) >= most:
        return most
    low, high = 0.0, most
    for _ in range(_PASSES):
        middle = 0.5 * (low + high)
        if high - low <= _CLOSE * high:
            break
        low, high = (middle, high) if demand(middle) > middle else (low, middle)
    return high


def _most_strength(
    curve: Capacity,
    lines: Idealisation,
    spectrum: DesignSpectrum,
    near_field: bool | None,
    period: float,
) -> tuple[float, dict[str, float]]:
    """Return mu_max of 7.4.3.3.2 and the slopes of the falling branch over K_e."""
    u, v = curve.displacement[curve._top :], curve.force[curve._top :]
    below = np.flatnonzero(v <= 0.6 * lines.yield_force)
    last = float(u[-1]), float(v[-1])
    if below.size:
        i = int(below[0])
        share = (0.6 * lines.yield_force - v[i - 1]) / (v[i] - v[i - 1])
        last = float(u[i - 1] + share * (u[i] - u[i - 1])), 0.6 * lines.yield_force
    if not last[1] < v[0] * (1.0 - 1e-9):
        return math.inf, {}
    falling = (last[1] - float(v[0])) / (last[0] - float(u[0])) / lines.stiffness
    leaning = -curve.pdelta_slope / lines.stiffness
    near = spectrum.sa(1.0) >= 0.6 * STANDARD_GRAVITY * (1 - 1e-9)
    near = near if near_field is None else _arguments.boolean(near_field, "target: near_field")
    slope = leaning + (0.8 if near else 0.2) * (falling - leaning)
    power = 1.0 + 0.15 * math.log(period)
    limit = lines.end_displacement / lines.yield_displacement + abs(slope) ** -power / 4.0
    return limit, {"alpha_2": falling, "alpha_PDelta": leaning, "alpha_e": slope}


def en_1998(curve: Capacity, spectrum: DesignSpectrum, *, iterate: bool = True) -> Estimate:
    """Return the target displacement of EN 1998-1:2004, annex B (N2).

    Parameters
    ----------
    curve : Capacity
        The curve.
    spectrum : DesignSpectrum
        The demand.
    iterate : bool, optional
        Whether the lines are drawn anew up to the target displacement (B.3) until it stays; else
        once, up to the largest base shear.
    """
    most = curve.peak
    found: dict[str, float] = {}

    def demand(end: float) -> float:
        lines = curve.idealise("ec_8", end)
        force, at = lines.yield_force / curve.gamma, lines.yield_displacement / curve.gamma
        period = 2.0 * math.pi * math.sqrt(curve.modal_mass * at / force)
        sa, elastic = spectrum.sa(period), spectrum.sd(period)
        strength = sa * curve.modal_mass / force
        reached = elastic
        if period < spectrum.corner and strength > 1.0:
            reached = elastic / strength * (1.0 + (strength - 1.0) * spectrum.corner / period)
            reached = min(max(reached, elastic), 3.0 * elastic)
        found.update({"T*": period, "q_u": strength, "d_et*": elastic, "d_t*": reached})
        return curve.gamma * reached

    target = demand(most)
    # The lines need a part that has yielded: from the first line on they are those of the curve.
    end = _settled(demand, most) if _arguments.boolean(iterate, "target: iterate") else most
    target = demand(end)
    lines = curve.idealise("ec_8", end)
    factors = {"Gamma": curve.gamma, "m*": curve.modal_mass, **found, "T_C": spectrum.corner}
    return Estimate(
        "en_1998", "EN 1998-1:2004, annex B", target, lines, found["T*"], spectrum.sa(found["T*"]),
        target / lines.yield_displacement, factors, target <= curve.largest * (1 + 1e-9),
        ("The lines are drawn up to the target displacement.",) if iterate else (),
    )  # fmt: skip


def equivalent(ductility: float) -> tuple[float, float]:
    """Return T_eff/T_0 and the damping beyond the elastic one [%] of FEMA 440, 6.2.

    Parameters
    ----------
    ductility : float
        Displacement over that at yield; up to 1 the system is elastic.
    """
    m = max(ductility - 1.0, 0.0)
    if m < 3.0:
        return 1.0 + 0.20 * m**2 - 0.038 * m**3, 4.9 * m**2 - 1.1 * m**3
    if m <= 5.5:
        return 1.28 + 0.13 * m, 14.0 + 0.32 * m
    longer = 1.0 + 0.89 * (math.sqrt(m / (1.0 + 0.05 * (m - 1.0))) - 1.0)
    return longer, 19.0 * (0.64 * m - 1.0) / (0.64 * m) ** 2 * longer**2


def capacity_spectrum(curve: Capacity, spectrum: DesignSpectrum) -> Estimate:
    """Return the performance point of FEMA 440, chapter 6.

    The displacement of an equivalent oscillator with the period and the damping of the ductility at
    the point itself; of several such points the furthest.

    Parameters
    ----------
    curve : Capacity
        The curve.
    spectrum : DesignSpectrum
        The demand, of 5 %.
    """
    found: dict[str, float] = {}

    def demand(end: float) -> float:
        lines = curve.idealise("asce_41", end)
        slow = 2.0 * math.pi * math.sqrt(curve.modal_mass / lines.stiffness)
        longer, more = equivalent(end / lines.yield_displacement)
        period, damping = slow * longer, 0.05 + 0.01 * more
        factor = damping_factor(damping)
        found.update({"T_0": slow, "T_eff": period, "beta_eff": damping, "B": factor})
        return curve.gamma * spectrum.sd(period) / factor

    trials = np.linspace(0.0, curve.largest, _STEPS + 1).tolist()

    def tried(end: float) -> float:
        # Behind its peak a curve may have no such lines.
        try:
            return demand(end)
        except InputError:
            return math.nan

    above = [i for i, u in enumerate(trials) if not i or tried(u) > u]
    low, missing = trials[above[-1]], above[-1] == _STEPS
    end = curve.largest
    if not missing:
        step = trials[above[-1] + 1] - low
        end = low + _settled(lambda u: tried(low + u) - low, step)
    target = demand(end)
    lines = curve.idealise("asce_41", end)
    secant = curve.force_at(end) / end
    found["T_sec"] = 2.0 * math.pi * math.sqrt(curve.modal_mass / secant)
    notes = []
    if not 0.2 < found["T_0"] < 2.0:
        notes.append(f"T_0 = {found['T_0']:.3g} s is outside of the fit of FEMA 440, 0.2 to 2 s.")
    return Estimate(
        "capacity_spectrum", "FEMA 440, chapter 6", target, lines, found["T_eff"],
        spectrum.sa(found["T_eff"]), end / lines.yield_displacement,
        {"Gamma": curve.gamma, **found, "alpha": lines.post_yield_ratio}, not missing, tuple(notes),
    )  # fmt: skip
