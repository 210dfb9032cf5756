"""Problems whose answers textbooks, standards and other programs print, for `rbsdem.verify`.

An oscillator of mass m, stiffness k and damping c is a column of one body whose flexural spring is
1e9 times as stiff as k h^2: the body does not rotate, and what is left of the rotation changes
displacements by less than 1e-8 of themselves. Inches and kips are converted exactly (25.4 mm; the
pound-force is 0.45359237 kg times 9.80665 m/s2).
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.methods import problems_of_frames as frames
from rbsdem.methods.problems_of_frames import FOOT, INCH, KIP, KSI, MASS
from rbsdem.model.column import Column, Damping
from rbsdem.model.materials import Concrete, Steel, Ties
from rbsdem.model.shape import RectangularSection
from rbsdem.model.springs import Bilinear, Elastic, Spring
from rbsdem.run.analysis import modes
from rbsdem.run.result import cyclic, time_history
from rbsdem.section.strength import axial_failure_drift, interaction

RIGID = 1e9


@dataclass(frozen=True)
class Problem:
    """A problem whose answer is printed elsewhere.

    Attributes
    ----------
    name : str
        Short name, by which it is asked for.
    source : str
        Where the numbers are printed.
    what : str
        The quantity, and its unit.
    printed : str
        The numbers as they are printed, with blanks between them.
    solve : callable
        Returns the same numbers of the program.
    remark : str
        Why numbers may lie beyond the digits that are printed; "" where none does.
    within : float
        Largest difference then, over the printed number.
    """

    name: str
    source: str
    what: str
    printed: str
    solve: Callable[[], ArrayLike]
    remark: str = ""
    within: float = 0.0


# ---- oscillators --------------------------------------------------------------------------------


def oscillator(
    mass: float, stiffness: float, damping: float = 0.0, spring: Spring | None = None
) -> Column:
    """Return one degree of freedom, of units of kips, inches and seconds."""
    k = stiffness * KIP / INCH
    return Column(
        1.0,
        mass * MASS,
        spring or Elastic(k),
        Elastic(RIGID * k),
        damping=Damping(mass=damping / mass),
    )


#: Mass, stiffness and damping (5 %) of Chopra's examples of chapter 5.
PULSE = 0.2533, 10.0, 0.1592


def pulse(step: float, end: float = 1.0, spring: Spring | None = None, **options: Any) -> Array:
    """Return displacements at every 0.1 s under 10 sin(pi t/0.6) kip up to 0.6 s [in]."""
    time = np.linspace(0.0, end, round(end / step) + 1)
    force = np.where(time < 0.6 - 1e-9, 10 * np.sin(np.pi * time / 0.6), 0.0)
    run = time_history(oscillator(*PULSE, spring), time, force=KIP * force, **options)
    at = np.searchsorted(run.time, 0.1 * np.arange(1, round(end / 0.1) + 1) - 1e-9)
    return np.asarray(run.displacement[at] / INCH)


def yielding_pulse() -> Array:
    """Return the same of a spring that yields at 7.5 kip."""
    spring = Bilinear(k=PULSE[1] * KIP / INCH, d_y=0.75 * INCH, k_post=0.0)
    return pulse(0.1, 0.9, spring, method="newmark", dt=0.1)


def released(column: Column, start: float, period: float, cycles: int) -> Array:
    """Return displacements at whole cycles after a release from rest at `start` [in]."""
    time = np.linspace(0.0, cycles * period, cycles * 1000 + 1)
    run = time_history(
        column,
        time,
        method="newmark",
        dt=period / 1000,
        force=np.zeros_like(time),
        initial={"slip": [start * INCH]},
    )
    return np.asarray(run.displacement[::1000] / INCH)


def water_tank() -> list[float]:
    """Return period [s], the pull's displacement, and amplitudes after 4 and 13 cycles [in]."""
    column = oscillator(20.03 / 386, 8.2, 0.0360)
    peaks = released(column, 2.0, 0.5, 13)
    pull = cyclic(column, force=[16.4 * KIP]).displacement[0] / INCH
    return [1 / modes(column).frequency[0], pull, peaks[4], peaks[13]]


def jacked_building() -> list[float]:
    """Return period [s], and amplitudes after one and six cycles [in]."""
    column = oscillator(1920 / 386, 100.0, 1.584)
    peaks = released(column, 0.20, 1.40, 6)
    return [1 / modes(column).frequency[0], peaks[1], peaks[6]]


def rectangular_pulse() -> list[float]:
    """Return the peak over the static displacement, and the peak [in]."""
    column = oscillator(3.73 * (0.5 / (2 * np.pi)) ** 2, 3.73)
    time = np.linspace(0.0, 1.0, 10001)
    force = KIP * np.select([time < 0.2 - 1e-9, time < 0.2 + 1e-9], [4.0, 2.0], 0.0)
    run = time_history(column, time, force=force, method="newmark", dt=1e-4)
    peak = float(np.abs(run.displacement).max()) / INCH
    return [peak / (4 / 3.73), peak]


def two_degrees(**options: Any) -> Array:
    """Return the first of Bathe's two degrees of freedom at steps of 0.28.

    M = diag(2, 1), K = [6 -2; -2 4], a force of 10 on the second from rest. Seen from that force,
    the system is given by its eigenvalues 2 and 5 and by its static and initial flexibility. One
    body that slips and rotates has four values to choose, so it can have the same four; the
    trapezoidal rule does not mind which coordinates it is applied to. The force is 0.01, so that
    rotations are small, and the displacements are 1000 times those here.
    """
    from scipy.optimize import brentq  # noqa: PLC0415

    def body(inertia: float) -> tuple[float, float, float]:
        # A unit force at the top accelerates it by 1 (1/m + 1/(4 J)), moves it by 0.3 in the end
        # (1/k_V + 1/k_M), and the sum of the eigenvalues is 7 (k_V + k_M/J).
        mass = 4 * inertia / (4 * inertia - 1)
        both = 12 * inertia**2 / (4 * inertia - 1)
        flexure = (both - 7) / (1 - 1 / inertia)
        return mass, 7 - flexure / inertia, flexure

    inertia = brentq(lambda j: np.prod(body(j)[1:]) - 10 * body(j)[0] * j, 4.0, 6.0, xtol=1e-14)
    mass, shear, flexure = body(inertia)
    column = Column(1.0, mass, Elastic(shear), Elastic(flexure), rotary_inertia=[inertia])
    time = 0.28 * np.arange(13)
    run = time_history(column, time, force=np.full(13, 0.01), **options)
    return np.asarray(1000 * run.displacement[np.isin(run.time, time)][1:])


# ---- columns ------------------------------------------------------------------------------------


def cantilever(n: int, **options: Any) -> Column:
    """Return a chain of EI = m = L = 1 that only bends; the joint at the foot is half a body."""
    return Column(1.0, 1.0, Elastic(1e9 * n), [Elastic(2.0 * n)] + [Elastic(n)] * (n - 1), n=n,
                  **options)  # fmt: skip


def limit(of: Callable[[int], Any], n: int) -> Array:
    """Return the limit of chains of n and 2 n bodies, whose errors have order 2."""
    return np.asarray((4 * np.asarray(of(2 * n)) - np.asarray(of(n))) / 3)


def pipe_column() -> list[float]:
    """Return stiffness [kip/in], frequency [rad/s] and period [s] of a pipe with a weight."""
    stiffness, length, n = 29e3 * KIP * 7.23 * INCH**2, 144 * INCH, 60
    k = stiffness * n / length
    flexure = [Elastic(2 * k)] + [Elastic(k)] * (n - 1)
    column = Column(length, 1e-3, Elastic(1e9 * k), flexure, n=n, top_mass=5.20 / 386 * MASS,
                    gravity=0.0)  # fmt: skip
    found = modes(column)
    pushed = cyclic(column, displacement=[INCH]).force[0] / KIP
    return [pushed, found.omega[0], 1 / found.frequency[0]]


def euler_load() -> list[float]:
    """Return the critical load that the refusal of a load beyond it tells, over EI/L^2."""
    try:
        modes(cantilever(100, axial_load=3.0, kinematics="pdelta"))
    except InputError as error:
        said = re.search(r"critical load of ([-+.e\d]+) N", str(error))
        return [float(said[1])] if said else []
    return []


def buckled(load: float, way: float) -> list[float]:
    """Return height, way across and rotation [degrees] of the end of a buckled cantilever.

    The chain is driven across to where it needs no force: the printed load has four digits, which
    at 20 degrees are 2 % of the distance from the critical one.
    """
    from scipy.optimize import brentq  # noqa: PLC0415

    column = cantilever(80, axial_load=load * np.pi**2 / 4, kinematics="finite")

    def push(across: float) -> Any:
        return cyclic(column, displacement=np.linspace(0.0, across, 30)[1:])

    ends = 0.9 * way, min(1.1 * way, 0.95)
    end = push(brentq(lambda across: push(across).force[-1], *ends, xtol=1e-9))
    return [end.top[-1, 1], end.top[-1, 0], float(np.degrees(np.sum(end.rotation[-1])))]


def bent(n: int, force: float) -> list[float]:
    """Return way across, way down and rotation of the end of a cantilever under a force across."""
    column = cantilever(n, kinematics="finite")
    run = cyclic(column, force=np.linspace(0, force, 11)[1:])
    return [run.top[-1, 0], 1 - run.top[-1, 1], float(np.sum(run.rotation[-1]))]


# ---- sections -----------------------------------------------------------------------------------


def _at(diagram: Any, values: Array, wanted: list[float], units: tuple[float, float]) -> Array:
    """Return axial load and moment between points of a diagram, at each of some other values."""
    order = np.argsort(values)
    pairs = zip((diagram.axial_load, diagram.moment), units, strict=True)
    found = [np.interp(wanted, values[order], one[order]) / unit for one, unit in pairs]
    return np.ravel(np.column_stack(found))


def eight_bars() -> Array:
    """Return axial load [kN] and moment [kN m] at depths of the neutral axis of 500 mm and less."""
    steel, bar = Steel(460e6, 575e6, es=200e9), np.pi / 4 * 0.025**2
    bars = [(0.1875, 3 * bar, steel), (0.0, 2 * bar, steel), (-0.1875, 3 * bar, steel)]
    section = RectangularSection(
        0.5, 0.5, Concrete(35e6), bars=bars, bar_diameter=0.025, cover=0.04,
        ties=Ties(0.01, 0.1, steel, legs=3),
    )  # fmt: skip
    found = interaction(section, "aci318")
    axes = [0.5, 0.4375, 0.247642, 0.164062, 0.158133]
    return _at(found, found.neutral_axis, axes, (1e3, 1e3))


def spcolumn() -> list[float]:
    """Return axial load [kip] and moment [kip ft] at strains of the far bars of 0, yield, 0.005.

    Then the moment without axial load, and the largest and least axial load.
    """
    psi, units = KSI / 1000, (KIP, KIP * FOOT)
    steel = Steel(60e3 * psi, es=29e6 * psi)
    bars = [(side * 5.5 * INCH, 4.0 * INCH**2, steel) for side in (1, -1)]
    side = 16 * INCH
    section = RectangularSection(
        side, side, Concrete(5e3 * psi), bars=bars, bar_diameter=1.128 * INCH
    )
    found = interaction(section, "aci318", points=200)
    numbers = _at(found, found.tension_strain, [0.0, 60 / 29000, 0.005], units)
    ends = found.axial_load[[-1, 0]] / KIP
    return [*numbers, found.moment_at(0.0) / units[1], *ends]


def shed() -> list[float]:
    """Return the drift at axial failure of 300 x 500 mm, two ties of 10 mm at 100 mm, 375 kN."""
    bars = [(0.2, 1e-3, Steel(400e6)), (-0.2, 1e-3, Steel(400e6))]
    section = RectangularSection(
        0.3, 0.5, Concrete(25e6), bars=bars, bar_diameter=0.02, cover=0.03,
        ties=Ties(0.01, 0.1, Steel(300e6), legs=2),
    )  # fmt: skip
    return [axial_failure_drift(section, 375e3)]


def elwood() -> str:
    """Return their formula with a core of 430 mm and an area of ties of 2 x 78.54 mm2."""
    tangent = np.tan(np.radians(65.0))
    ties = 2 * np.pi / 4 * 0.01**2 * 300e6 * 0.43 / 0.1
    return f"{0.04 * (1 + tangent**2) / (tangent + 375e3 / (ties * tangent)):.6f}"


# ---- the table ----------------------------------------------------------------------------------

CHOPRA = "Chopra, Dynamics of Structures"
TIMOSHENKO = "Timoshenko and Gere, Theory of Elastic Stability"
HALF_SINE = "displacement every 0.1 s [in]"
EXACT = "0.0328 0.2332 0.6487 1.1605 1.5241 1.4814 0.9245 0.0593 -0.7751 -1.2718"
STEPS = "0.0437 0.2326 0.6121 1.0825 1.4309 1.4231 0.9622 0.1908 -0.6044 -1.1442"
YIELDS = "0.0437 0.2326 0.6121 1.1143 1.6214 1.9891 2.0951 1.9240 1.5602"
TRAPEZOIDS = "0.364 1.35 2.68 4.00 4.95 5.34 5.13 4.48 3.64 2.90 2.44 2.31"
SUPERPOSED = "0.382 1.41 2.78 4.09 5.00 5.29 4.986 4.277 3.457 2.806 2.484 2.489"
ENGESSER = "with shear by the slope of the axis; the source does not tell its own"
ROUNDED = "the book goes on with rounded numbers"

PROBLEMS: list[Problem] = [
    Problem("Half-cycle sine pulse", f"{CHOPRA}, tables E5.2 to E5.4", f"exact {HALF_SINE}", EXACT,
            partial(pulse, 1e-3, method="rk45", tolerance=1e-9)),
    Problem("Half-cycle sine pulse, Newmark", f"{CHOPRA}, example 5.3", HALF_SINE, STEPS,
            partial(pulse, 0.1, method="newmark", dt=0.1)),
    Problem("Half-cycle sine pulse, yielding", f"{CHOPRA}, examples 5.5 and 5.6", HALF_SINE, YIELDS,
            yielding_pulse),
    Problem("Elevated water tank", f"{CHOPRA}, chapter 2",
            "period [s], pull, after 4 and 13 cycles [in]", "0.50 2.0 1.0 0.2", water_tank),
    Problem("Rectangular pulse", f"{CHOPRA}, example 4.1", "R_d, peak [in]", "1.902 2.04",
            rectangular_pulse),
    Problem("Pipe column", f"{CHOPRA}, example 6.2", "k [kip/in], omega [rad/s], T [s]",
            "0.211 3.958 1.59", pipe_column, ROUNDED, 1.5e-3),
    Problem("Jacked building", "Clough and Penzien, Dynamics of Structures, example E2-1",
            "period [s], after 1 and 6 cycles [in]", "1.40 0.16 0.0524", jacked_building, ROUNDED,
            6e-3),
    Problem("Two degrees, trapezoidal rule", "Bathe, Finite Element Procedures, chapter 9",
            "displacement at 12 steps", TRAPEZOIDS,
            partial(two_degrees, method="newmark", dt=0.28)),
    Problem("Two degrees, exact", "Bathe, Finite Element Procedures, chapter 9",
            "displacement at 12 steps", SUPERPOSED,
            partial(two_degrees, method="rk45", tolerance=1e-9)),
    Problem("Uniform cantilever", f"{CHOPRA}, distributed mass", "omega over sqrt(EI/(m L^4))",
            "3.516 22.03 61.70",
            partial(limit, lambda n: modes(cantilever(n)).omega[:3], 50)),
    Problem("Euler's column", f"{TIMOSHENKO}, chapter 2", "critical load over EI/L^2", "2.467",
            euler_load),
    *(
        Problem(f"Elastica, {turn} degrees", f"{TIMOSHENKO}, table of the elastica",
                "height, way across over L, rotation", f"{height} {way} {turn}",
                partial(buckled, load, float(way)), "the load is printed with four digits", 2e-2)
        for turn, load, height, way in (
            ("20", 1.015, "0.970", "0.220"), ("40", 1.063, "0.881", "0.422"),
            ("60", 1.152, "0.741", "0.593"), ("80", 1.293, "0.560", "0.719"),
            ("100", 1.518, "0.349", "0.792"),
        )
    ),
    *(
        Problem(f"Cantilever bent by F = {force} EI/L^2",
                "Mattiasson, Int. J. Numer. Methods Eng. 17 (1981)",
                "way across and down over L, rotation", printed,
                partial(limit, partial(bent, force=float(force)), 40),
                "chains of 40 and 80 bodies extrapolated", 1e-4)
        for force, printed in (
            ("1", "0.30172 0.05643 0.46135"), ("2", "0.49346 0.16064 0.78175"),
            ("10", "0.81061 0.55500 1.43029"),
        )
    ),
    Problem("Two storeys with flexible beams", f"{CHOPRA}, example 10.5",
            "omega over sqrt(EI/(m h^3))", "2.198 5.850", frames.flexible_beams),
    Problem("Seven storeys, periods", "SAP2000 verification manual, example 1-022",
            "periods [s]", "1.2732 0.4313 0.2420 0.1602 0.1190 0.0951 0.0795",
            lambda: modes(frames.seven_storeys(), 7).period),
    Problem("Seven storeys, lateral loads", "SAP2000 verification manual, example 1-022",
            "displacement of the top [in]", "1.45076", frames.pushed_seven_storeys),
    Problem("Nine storeys, ten bays", "Bathe and Wilson; SAP2000 verification manual, 1-021",
            "eigenvalues [1/s2]", "0.589541 5.52695 16.5878", frames.nine_storeys),
    *(
        Problem(f"AISC benchmark case {case}{', with shear' if shear else ''}",
                f"AISC 360-16, figure C-C2.{case + 1}", "moments [kip in], displacements [in]",
                printed, partial(frames.aisc, loads, shear=shear, **more),
                ENGESSER if shear else "", 2e-3 if shear else 0.0)
        for case, shear, loads, more, printed in (
            (1, False, "0 150 300 450", {"across": 0.2 * KIP / FOOT},
             "235 269 313 375 0.197 0.224 0.261 0.311"),
            (1, True, "0 150 300 450", {"across": 0.2 * KIP / FOOT},
             "235 270 316 380 0.202 0.230 0.269 0.322"),
            (2, False, "0 100 150 200", {"tip": KIP}, "336 469 598 848 0.901 1.33 1.75 2.56"),
            (2, True, "0 100 150 200", {"tip": KIP}, "336 470 601 856 0.907 1.34 1.77 2.60"),
        )
    ),
    *(
        Problem(name, "AISC Design Guide 25, closed form",
                "moments [kip in], sways [in] at 1/4, 1/2 and 0.67 of Euler's load",
                *frames.beam_column((0.25, 0.5, 0.67), halves))
        for name, halves in (("Beam-column", 1), ("Beam-column, guided top", 2))
    ),
    Problem("Portals that sway", "phi tan phi = 6 on pins, phi = -6 tan phi on fixed feet",
            "P h^2/E I of each column, phi^2", "1.8213 7.3792", frames.swaying_portals),
    Problem("Slender cantilever", "CSI, test problem 109, closed form",
            "moment [N m], displacement [m]", "1126.5 0.169134", frames.slender),
    Problem("Sway mechanism of a portal", "limit analysis, 4 M_p/h", "load over M_p/h",
            "4.00000000", frames.plastic_sway),
    Problem("Loss of a column, three floors", "limit analysis, 3 x 4 M_p/L", "load over M_p/L",
            "12.0000000", frames.lost_column),
    Problem("Square section, eight bars", "program concreteproperties 0.7.0, ACI 318",
            "N [kN], M [kN m] at five neutral axes",
            "6959.36 395.59 6063.09 509.27 2880.68 687.48 1469.55 581.32 1352.70 570.41",
            eight_bars, "the neutral axes are printed to a micrometre", 1e-5),
    Problem("Column of 16 x 16 in", "published example of spColumn, ACI 318",
            "N [kip], M [kip ft] at three strains; M at N = 0; ends of N",
            "957 261 417 386 195 320 238 1534 -480", spcolumn,
            "beta_1 falls from 4 ksi in the inch-pound edition, from 28 MPa in the metric", 5e-3),
    Problem("Axial load after shear failure", "Elwood and Moehle 2005, formula", "drift", elwood(),
            shed),
]  # fmt: skip
