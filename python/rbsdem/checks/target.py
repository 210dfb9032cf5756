"""Capacity curves and their target displacements by three codes.

ASCE 41-17, 7.4.3.3.2, with the coefficients of FEMA 440; EN 1998-1:2004, annex B (N2); the capacity
spectrum of FEMA 440, chapter 6. Each is a function of a `Capacity` and a spectrum.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, ArrayLike, DataFrame
from rbsdem.checks import asce_41 as codes
from rbsdem.checks.acceptance import between, pushed_over, rows_at
from rbsdem.checks.en_1998 import target_of_one_mass
from rbsdem.curves.envelope import SOURCES, Envelope, Idealisation, envelope
from rbsdem.errors import InputError, warn
from rbsdem.motions.design import DesignSpectrum, damping_factor
from rbsdem.run.analysis import BuildingModes, matrices, modes
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.frame_result import FrameResult
from rbsdem.section.frame import Frame
from rbsdem.section.plan import Building, cosine_sine

TargetMethod = Literal["asce_41", "en_1998", "capacity_spectrum"]

#: Damping by which modes are combined; share of a push below which a frame lies across it.
_DAMPING, _ACROSS = 0.05, 0.5

#: Units of factors.
_UNITS = {"m*": "kg", "d_et*": "m", "d_t*": "m"}
_UNITS |= dict.fromkeys(("T*", "T_C", "T_0", "T_eff", "T_sec"), "s")


@dataclass(frozen=True, repr=False, eq=False)
class Target(Tabular):
    """A target displacement with its curve, its spectrum and the state of the frame there.

    Attributes
    ----------
    method, source : str
        "asce_41", "en_1998" or "capacity_spectrum", and its clause.
    curve : Capacity
        The curve.
    spectrum : DesignSpectrum
        The demand.
    displacement : float
        Of the control node [m], unsigned.
    lines : Idealisation
        The two straight lines of the curve.
    period : float
        Effective period of the method [s]: T_e, T* or T_eff.
    ductility : float
        mu_strength of ASCE 41, else displacement over that at yield of the lines; below the first
        yield of a member displacement over that there, below 1.
    factors : dict of str to float
        The coefficients of the method by name.
    warnings : tuple of str
        What a reader has to know.
    push : FrameResult, BuildingResult or None
        The push-over; None where a `Capacity` was given.
    """

    method: str
    source: str
    curve: Capacity
    spectrum: DesignSpectrum
    displacement: float
    lines: Idealisation
    period: float
    ductility: float
    factors: dict[str, float]
    warnings: tuple[str, ...] = ()
    push: Any = None

    @property
    def reached(self) -> bool:
        """Whether the curve goes as far as the target displacement."""
        return self.displacement <= self.curve.largest * (1.0 + 1e-9)

    @property
    def acceleration(self) -> float:
        """Spectral acceleration at the effective period, with the spectrum's damping [m/s2]."""
        return self.spectrum.sa(self.period)

    @property
    def base_shear(self) -> float:
        """Base shear at the target displacement [N]; NaN beyond the end of the curve."""
        return self.curve.force_at(self.displacement)

    @property
    def drift(self) -> float:
        """Target displacement over the height of the frame."""
        return self.displacement / float(self.pushed.column.height)

    @property
    def signed(self) -> float:
        """Displacement of the control node in the rows of the push-over [m]."""
        x = self.pushed.displacement
        return float(x[0] + math.copysign(self.displacement, x[-1] - x[0]))

    @cached_property
    def storey_drift(self) -> Array:
        """Storey drifts at the target displacement, beyond those of the dead load.

        Of a building the largest of its corners.
        """
        push = self.pushed
        drift = push.corner_drift if isinstance(push, BuildingResult) else push.storey_drift
        there: Array = between(rows_at(self.pushed, self)[1], np.abs(drift - drift[0]))[0]
        return there

    @cached_property
    def torsion(self) -> dict[str, float]:
        """Factors of the displacements of the frames of a building for torsion, by their names.

        Roof displacement of a frame over that of the centre of mass by elastic modal analysis along
        the push (complete quadratic combination, 5 %), at least 1, over the same ratio of the
        push-over at the target, and at least 1: the extended N2 method (Kreslin and Fajfar 2012)
        for EN 1998-1, 4.3.3.4.2.7. Frames across the push, and planar frames, have none.
        """
        push = self.pushed
        if not isinstance(push, BuildingResult):
            return {}
        building = push.building
        modal, along, share = _moved_along(building)
        size = share * np.array([self.spectrum.sa(period) for period in modal.period])
        size = size / modal.omega**2
        roof = np.stack(
            [motion[-1] for motion in (modal.floor_x, modal.floor_y, modal.floor_rotation)]
        )
        rows = rows_at(push, self)[1]
        moved = [push.floor_x[:, -1], push.floor_y[:, -1], push.floor_rotation[:, -1]]
        pushed = np.array([between(rows, motion - motion[0])[0, 0] for motion in moved])
        ratio = np.divide.outer(modal.omega, modal.omega)
        close = 8.0 * _DAMPING**2 * (1.0 + ratio) * ratio**1.5
        close /= (1.0 - ratio**2) ** 2 + 4.0 * _DAMPING**2 * ratio * (1.0 + ratio) ** 2

        def combined(each: Array) -> float:
            return float(np.sqrt((size * each) @ close @ (size * each)))

        c, s = cosine_sine(building.direction)
        x, y = building.centres[-1]
        factors = {}
        for plane in building.planes:
            cosine, sine = plane.direction
            toward = cosine * c + sine * s
            if abs(toward) < _ACROSS:
                continue
            of_frame = np.array([cosine, sine, plane.arm - (x * sine - y * cosine)]) / toward
            elastic = combined(of_frame @ roof) / combined(along[-1])
            by_push = float(of_frame @ pushed / (pushed @ [c, s, 0.0]))
            factors[plane.name] = max(max(elastic, 1.0) / by_push, 1.0) if by_push > 0 else math.inf
        return factors

    @property
    def pushed(self) -> Any:
        """The push-over; `InputError` where a `Capacity` was given."""
        if self.push is None:
            raise InputError("target: it was made of a Capacity; give the push-over of a frame")
        return self.push

    def to_pandas(self) -> DataFrame:
        """Return a row for each figure, with its unit."""
        lines = self.lines
        rows: list[tuple[str, float, str]] = [
            ("target displacement", self.displacement, "m"),
            ("base shear there", self.base_shear, "N"),
            ("yield displacement", lines.yield_displacement, "m"),
            ("yield force", lines.yield_force, "N"),
            ("effective stiffness", lines.stiffness, "N/m"),
            ("elastic period", self.curve.period, "s"),
            ("effective period", self.period, "s"),
            ("spectral acceleration there", self.acceleration, "m/s2"),
            ("effective mass", self.curve.gamma * self.curve.modal_mass, "kg"),
            ("ductility", self.ductility, ""),
        ]
        if self.push is not None:
            rows.insert(1, ("roof drift", self.drift, "drift"))
        rows += [(name, value, _UNITS.get(name, "")) for name, value in self.factors.items()]
        return data_frame(rows, ["figure", "value", "unit"])

    def __repr__(self) -> str:
        end, force = "", f"base shear {self.base_shear:.4g} N, "
        if not self.reached:
            end, force = f", not reached: the curve ends at {self.curve.largest:.4g} m", ""
        return (
            f"Target({self.method}, {self.displacement:.4g} m, {force}"
            f"period {self.curve.period:.3g} s elastic, {self.period:.3g} s effective, "
            f"ductility {self.ductility:.3g}{end})"
        )


def target(
    push: FrameResult | BuildingResult | Capacity,
    spectrum: DesignSpectrum,
    method: TargetMethod = "asce_41",
    **settings: Any,
) -> Target:
    """Return the target displacement of a push-over under a spectrum.

    Parameters
    ----------
    push : FrameResult, BuildingResult or Capacity
        What `rbsdem.pushover` returned, or a curve with its masses. That of a building is judged
        along its direction, with the mode that moves most mass there; `torsion` of the target
        amplifies its frames.
    spectrum : DesignSpectrum
        The demand: `DesignSpectrum.asce_41`, `.en_1998`, `.table` or `.mean_of` records.
    method : {"asce_41", "en_1998", "capacity_spectrum"}, optional
        The method: coefficients of ASCE 41-17, N2 of EN 1998-1, or the capacity spectrum of FEMA
        440. They differ by a third on one frame: name it beside every target.
    **settings
        Those of the method, `site_class`, `c0`, `cm`, `near_field` of
        "asce_41", `iterate` of "en_1998".

    Returns
    -------
    Target
        Displacement, lines, periods and coefficients; `check_target` runs records beside it.

    Raises
    ------
    InputError
        If an argument is refused, or the curve has no such lines.
    """
    methods: dict[str, Callable[..., Target]] = {
        "asce_41": asce_41,
        "en_1998": en_1998,
        "capacity_spectrum": capacity_spectrum,
    }
    run = methods[_arguments.choice(method, "target: method", methods)]
    remedy = "as DesignSpectrum.en_1998(0.25, 'C')"
    demand = _arguments.instance(spectrum, "target: spectrum", DesignSpectrum, remedy)
    curve = push if isinstance(push, Capacity) else capacity(push)
    known = run.__kwdefaults__ or {}
    for name in settings:
        if name not in known:
            there = f"it takes {', '.join(known)}" if known else "it takes none"
            raise InputError(f"target: {name} is no setting of {method!r}; {there}")
    pushed = None if isinstance(push, Capacity) else push
    return replace(run(curve, demand, **settings), push=pushed)


def capacity(push: FrameResult | BuildingResult) -> Capacity:
    """Return the capacity curve of a push-over with the first mode of its frame.

    Parameters
    ----------
    push : FrameResult or BuildingResult
        What `rbsdem.pushover` returned. Displacement and base shear count from its first row, in
        which the frame stands under its dead load.

    Raises
    ------
    InputError
        If it is none, or the frame has no mass.
    """
    if not isinstance(push, BuildingResult):
        push = _arguments.instance(push, "target", FrameResult, "as of rbsdem.pushover")
    if push.dynamic:
        raise InputError("target: the result is a response in time; give a push-over")
    pushed_over(push, "target")
    if isinstance(push, BuildingResult):
        return _capacity_of_building(push)
    frame: Frame = push.frame
    if frame.control == "y" or not frame.parts.mass > 0:
        raise InputError("target: the frame has no mass along x, or is not pushed along it")
    first = modes(frame, 1)
    parts, name = frame.parts, frame.control_node
    phi = float(first.x[parts.nodes.index(name) if name else int(parts.y.argmax()), 0])
    # Modes have a modal mass of 1, so that this participation squared is the effective mass.
    moved = math.sqrt(float(first.mass[0]))
    gamma, modal_mass = moved * abs(phi), moved / abs(phi)
    side = 1.0 if push.displacement[-1] >= push.displacement[0] else -1.0
    u = side * (push.displacement - push.displacement[0])
    v = side * (push.base_shear - push.base_shear[0])
    storeys = len(frame.storey_heights)
    slope = _pdelta_slope(frame, first.x[:, 0] / phi, gamma)
    masses, period = (gamma, modal_mass, frame.parts.mass), float(first.period[0])
    stiffness = _elastic_slope(frame, first.x[:, 0])
    curve = *masses, max(storeys, 1), period, stiffness, slope
    return Capacity(u, v, *curve, _first_yield(push, side))


def _first_yield(push: FrameResult | BuildingResult, side: float) -> float:
    """Return the displacement of the first event but cracks [m].

    If there are cracks alone it is that of the end; NaN where nothing is watched.
    """
    events = push.events
    beyond = [event.displacement for event in events if event.name != "cracking"]
    last = push.displacement[-1]
    at = beyond[0] if beyond else last if len(events) else math.nan
    return side * float(at - push.displacement[0])


def _moved_along(building: Building) -> tuple[BuildingModes, Array, Array]:
    """Return the modes of a building, the motion of its floors along its direction, and shares.

    The shares are those of the modes in a motion of the ground along this direction.
    """
    modal = modes(building, 3 * len(building.storey_heights))
    masses = building.plan_mass.copy()
    for node in building.nodes:
        if node.floor:
            masses[node.floor - 1] += node.mass
    c, s = cosine_sine(building.direction)
    along = c * modal.floor_x + s * modal.floor_y
    return modal, along, masses @ along


def _capacity_of_building(push: BuildingResult) -> Capacity:
    """Return the capacity of a building with the mode that moves most along the push."""
    building = push.building
    modal, along, shares = _moved_along(building)
    if not shares.any():
        raise InputError("target: the building has no mass along the push; give its floors some")
    first = int(np.abs(shares).argmax())
    phi, moved = float(along[-1, first]), float(abs(shares[first]))
    gamma, modal_mass = moved * abs(phi), moved / abs(phi)
    side = math.copysign(1.0, push.displacement[-1] - push.displacement[0])
    u = side * (push.displacement - push.displacement[0])
    v = side * (push.base_shear - push.base_shear[0])
    slope = _pdelta_slope(building, modal.x[:, first] / phi, gamma)
    total = float(np.sum(building.plan_mass) + sum(one.mass for one in building.nodes if one.floor))
    storeys = len(building.storey_heights)
    # The period is that of the mode, with its slope: under dead load members may have cracked.
    stiffness = modal_mass * float(modal.omega[first]) ** 2
    curve = gamma, modal_mass, total, storeys, float(modal.period[first]), stiffness, slope
    return Capacity(u, v, *curve, _first_yield(push, side))


def _elastic_slope(frame: Frame, shape: Array) -> float:
    """Return the slope of a push-over of the frame before anything yields or cracks [N/m].

    The period of the modes belongs to it. The slope of the curve may be less: its members may have
    cracked under the dead load.
    """
    made, parts = matrices(frame), frame.parts
    along = [i for i, name in enumerate(made.unknowns) if name.startswith("x_")]
    node = [parts.nodes.index(made.unknowns[i][2:]) for i in along]

    def moved_by(name: str) -> int:
        """Return the unknown of a node along x; those that are tied share one."""
        if f"x_{name}" in made.unknowns:
            return made.unknowns.index(f"x_{name}")
        return along[int(np.abs(shape[node] - shape[parts.nodes.index(name)]).argmin())]

    load = np.zeros(len(made.unknowns))
    if frame.pattern == "nodes":
        for each in frame.nodes:
            load[moved_by(each.name)] += each.push_x
            if each.push_y:
                load[made.unknowns.index(f"y_{each.name}")] += each.push_y
    else:
        shares = {"triangular": parts.y - parts.y.min(), "modal": shape}
        load[along] = made.mass[along, along] * shares.get(frame.pattern, np.ones(len(shape)))[node]
    moved = np.linalg.solve(made.stiffness + made.geometric, load)
    control = frame.control_node or parts.nodes[int(parts.y.argmax())]
    return float(load[along].sum() / moved[moved_by(control)])


def _pdelta_slope(frame: Frame, shape: Array, gamma: float) -> float:
    """Return the slope that the axial forces of the columns take from the curve [N/m].

    By virtual work on the shape phi of the mode: gamma times the sum of P (change of phi)^2/length.
    """
    if frame.kinematics != "pdelta":
        return 0.0
    parts = frame.parts
    start, end = parts.ends.T
    length = np.hypot(parts.x[end] - parts.x[start], parts.y[end] - parts.y[start])
    return gamma * float(np.sum(parts.compression * (shape[end] - shape[start]) ** 2 / length))


#: Share of displacements to which methods iterate, and their most passes.
_CLOSE, _PASSES = 1e-10, 400
#: Steps over a curve among which the last point of performance is looked for.
_STEPS = 150
#: Periods of buildings [s].
_SHORTEST, _LONGEST = 0.01, 15.0
#: Their strengths over their weights.
_WEAKEST, _STRONGEST = 0.002, 50.0
#: Share of its force by which a curve is off its first line where that ends.
_STRAIGHT = 1e-3


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
        Elastic period of the first mode [s], and the elastic slope of the curve [N/m]. Without them
        the slope is that of the first line of the curve, the period that of m* on it.
    pdelta_slope : float
        Slope that P-Delta alone takes from the curve [N/m].
    first_yield : float
        Displacement at which a member yields or fails first, not before the end of the first line
        of the curve, which it is by default [m]. Cracks bend a curve before it.
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
    first_yield: float = math.nan

    def __post_init__(self) -> None:
        curve = envelope((self.displacement, self.force))
        # Where nothing is left of the strength the curve has ended.
        top = int(curve.force.argmax())
        gone = np.flatnonzero(curve.force[top:] <= 0)
        last = top + int(gone[0]) if gone.size else curve.force.size
        _arguments.put(self, displacement=curve.displacement[:last], force=curve.force[:last])
        for name in ("gamma", "modal_mass", "total_mass"):
            value = _arguments.number(getattr(self, name), f"Capacity: {name}", above=0.0)
            _arguments.put(self, **{name: value})
        if math.isnan(self.stiffness):
            _arguments.put(self, stiffness=self.slope)
        at = _arguments.number(np.nan_to_num(self.first_yield), "Capacity: first_yield")
        _arguments.put(self, first_yield=min(max(at, self.elastic), self.largest))
        if math.isnan(self.period):
            slow = 2.0 * math.pi * math.sqrt(self.modal_mass / self.stiffness)
            _arguments.put(self, period=slow)
        share = self.force.max() / (STANDARD_GRAVITY * self.total_mass)
        for what, value, least, most in (
            (f"a period of {self.period:.3g} s", self.period, _SHORTEST, _LONGEST),
            (f"a strength of {share:.3g} times the weight", share, _WEAKEST, _STRONGEST),
        ):
            if not least <= value <= most:
                warn(
                    f"Capacity: {what} is that of no building; displacements are in m, forces in "
                    "N and masses in kg (1 kN is 1e3, 1 t is 1e3)"
                )
                break

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
            `period`, `stiffness`, `pdelta_slope`, `first_yield`.
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
        """Return the two straight lines of the curve up to an end [m].

        If the end comes before the first yield of a member, there is one line up to the force at
        that yield. Its slope is that of the curve as long as the curve is straight, where any yield
        point would have equal areas. Further on, where members have cracked, the slope is the
        stiffness that the method finds up to the end.
        """
        curve = Envelope(1, self.displacement, self.force)
        if self.yields(end):
            return curve.idealise(method, end=min(end, self.largest))  # type: ignore[arg-type]
        stiffness = self.slope
        if end > self.elastic * (1.0 + 1e-12):
            if method == "asce_41":
                force = 0.6 * self.force_at(end)
                stiffness = force / curve.displacement_at(force / curve.peak_force)
            else:
                stiffness = curve.idealise(method, end=end).stiffness  # type: ignore[arg-type]
        upto = slice(int(np.searchsorted(self.displacement, self.first_yield)) + 1)  # before a fall
        at = np.interp(self.first_yield, self.displacement[upto], self.force[upto])
        strength, whole = float(at), curve.idealise("park")
        first, left = (strength / stiffness, strength), (whole.ultimate_displacement, whole.lost)
        return Idealisation(method, SOURCES[method], *first, *first, *left)

    def ductility(self, displacement: float, lines: Idealisation, end: float) -> float:
        """Return a displacement over that at yield, with lines up to an end [m].

        If no member yields before the end, that at the first yield of a member is taken.
        """
        return displacement / (lines.yield_displacement if self.yields(end) else self.first_yield)

    def yields(self, end: float) -> bool:
        """Return whether a member yields before an end of the lines [m], beyond round-off."""
        return end > self.first_yield * (1.0 + 1e-12)

    @cached_property
    def slope(self) -> float:
        """Slope of the first line of the curve, its largest secant [N/m]."""
        # Rows at the start of a path may differ by round-off alone.
        there = self.displacement > 1e-6 * self.largest
        return float((self.force[there] / self.displacement[there]).max())

    @cached_property
    def elastic(self) -> float:
        """Displacement of the last point on the first line of the curve [m]."""
        near = self.force >= (1.0 - _STRAIGHT) * self.slope * self.displacement
        return float(self.displacement[np.flatnonzero(near)[-1]])

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
        """Row of the largest force, of a plateau its last row."""
        return int(np.flatnonzero(self.force >= (1.0 - 1e-9) * self.force.max())[-1])

    def force_at(self, displacement: float) -> float:
        """Return the base shear at a displacement [N], NaN beyond the end."""
        beyond = displacement > self.largest * (1.0 + 1e-12)
        return math.nan if beyond else float(np.interp(displacement, self.displacement, self.force))


def asce_41(
    curve: Capacity,
    spectrum: DesignSpectrum,
    *,
    site_class: str = "D",
    c0: float | None = None,
    cm: float | None = None,
    near_field: bool | None = None,
) -> Target:
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
    site = _arguments.choice(site_class, "target: site_class", codes.SITES)
    first = curve.gamma if c0 is None else _arguments.number(c0, "target: c0", above=0.0)
    coefficients: dict[str, float] = {}

    def demand(end: float) -> tuple[float, Idealisation, float, float]:
        """Return delta_t [m], lines up to an end [m], T_e [s] and mu_strength."""
        lines = curve.idealise("asce_41", end)
        elastic = not curve.yields(end)
        period = curve.period * math.sqrt(curve.stiffness / lines.stiffness)
        sa = spectrum.sa(period)
        usual = codes.mass_factor(curve.storeys, period)
        coefficients["C_m"] = (
            usual if cm is None else _arguments.number(cm, "target: cm", above=0.0)
        )
        strength = sa * coefficients["C_m"] * curve.total_mass / lines.yield_force
        yields = 1.0 if elastic else strength
        coefficients["C_1"] = codes.inelastic_factor(yields, period, site)
        coefficients["C_2"] = codes.pinching_factor(yields, period)
        reached = first * coefficients["C_1"] * coefficients["C_2"] * spectrum.sd(period)
        if elastic:
            strength = reached / curve.first_yield
        return reached, lines, period, strength

    target, end = _meeting(curve, lambda u: demand(u)[0], curve.peak)
    _, lines, period, strength = demand(end)
    limit, softening = _most_strength(curve, lines, spectrum, near_field, period)
    warnings = []
    if strength > limit:
        warnings.append(
            f"mu_strength = {strength:.3g} is above mu_max = {limit:.3g}: a nonlinear static "
            "procedure is not allowed (ASCE 41-17, 7.3.2.1); look at records."
        )
    factors = {"C_0": first, **coefficients, "mu_max": limit, "alpha_1": lines.post_yield_ratio}
    named = "asce_41", "ASCE 41-17, 7.4.3.3.2", curve, spectrum
    return Target(*named, target, lines, period, strength, factors | softening, tuple(warnings))


def _meeting(
    curve: Capacity, demand: Callable[[float], float], most: float, *, furthest: bool = False
) -> tuple[float, float]:
    """Return the displacement that equals its demand by lines up to it, and the end of the lines.

    On the first line of the curve it is the elastic demand. Beyond, the demand by lines up to each
    end grows with the spectrum, so that more ends have a demand beyond them: the last such end, in
    a fixed order of trials, never moves back as the spectrum grows. An end up to which the curve
    has no lines of the method has the elastic demand.

    Parameters
    ----------
    demand : callable
        The displacement that lines up to an end ask for [m].
    most : float
        Largest end of lines [m].
    furthest : bool, optional
        Whether the furthest of several meetings is looked for.
    """
    elastic = demand(curve.elastic)
    if elastic <= curve.elastic or most <= curve.elastic:
        return elastic, min(elastic, curve.elastic)

    def asked(end: float) -> tuple[float, float]:
        """Return the demand by lines up to an end, and that end; without such lines elastic."""
        try:
            return demand(end), end
        except InputError:
            return elastic, curve.elastic

    reached, lines_to = asked(most)
    if reached >= most:
        return reached, lines_to
    low, high = curve.elastic, most
    if furthest:
        ends = np.linspace(low, most, _STEPS + 1).tolist()
        last = max(i for i, end in enumerate(ends) if not i or asked(end)[0] > end)
        low, high = ends[last : last + 2]
    for _ in range(_PASSES):
        middle = 0.5 * (low + high)
        if high - low <= _CLOSE * high:
            break
        low, high = (middle, high) if asked(middle)[0] > middle else (low, middle)
    # Where the lines jump, the demand may be beyond the end before the jump and below it behind.
    return high, asked(high)[1]


def _most_strength(
    curve: Capacity,
    lines: Idealisation,
    spectrum: DesignSpectrum,
    near_field: bool | None,
    period: float,
) -> tuple[float, dict[str, float]]:
    """Return mu_max of 7.4.3.3.2 and the slopes of the falling branch over K_e.

    The branch goes from the largest force to 60 % of the yield force, or to the end of the curve.
    """
    u, v = curve.displacement[curve._top :], curve.force[curve._top :]
    below = np.flatnonzero(v <= 0.6 * lines.yield_force)
    last = float(u[-1]), float(v[-1])
    if below.size:
        i = int(below[0])
        share = (0.6 * lines.yield_force - v[i - 1]) / (v[i] - v[i - 1])
        last = float(u[i - 1] + share * (u[i] - u[i - 1])), 0.6 * lines.yield_force
    if not last[1] < v[0] * (1.0 - 1e-9):
        return math.inf, {}
    fall, way = last[1] - float(v[0]), last[0] - float(u[0])
    falling = fall / way / lines.stiffness if way > 0 else -math.inf
    leaning = -curve.pdelta_slope / lines.stiffness
    near = spectrum.sa(1.0) >= 0.6 * STANDARD_GRAVITY * (1 - 1e-9)
    near = near if near_field is None else _arguments.boolean(near_field, "target: near_field")
    slope = codes.negative_slope(falling, leaning, near_field=near)
    ductility = lines.end_displacement / lines.yield_displacement
    limit = codes.largest_strength(ductility, slope, period)
    return limit, {"alpha_2": falling, "alpha_PDelta": leaning, "alpha_e": slope}


def en_1998(curve: Capacity, spectrum: DesignSpectrum, *, iterate: bool = True) -> Target:
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
    values: dict[str, float] = {}

    def demand(end: float) -> float:
        """Return the target displacement by lines up to an end [m]."""
        lines = curve.idealise("ec_8", end)
        force, at = lines.yield_force / curve.gamma, lines.yield_displacement / curve.gamma
        period = 2.0 * math.pi * math.sqrt(curve.modal_mass * at / force)
        sa, elastic = spectrum.sa(period), spectrum.sd(period)
        strength = sa * curve.modal_mass / force
        reduction = strength if curve.yields(end) else 1.0
        reached = target_of_one_mass(elastic, reduction, period, spectrum.corner)
        values.update({"T*": period, "q_u": strength, "d_et*": elastic, "d_t*": reached})
        return curve.gamma * reached

    if _arguments.boolean(iterate, "target: iterate"):
        target, end = _meeting(curve, demand, most)
    else:
        target, end = demand(most), most
    demand(end)
    lines = curve.idealise("ec_8", end)
    factors = {"Gamma": curve.gamma, "m*": curve.modal_mass, **values, "T_C": spectrum.corner}
    named = "en_1998", "EN 1998-1:2004, annex B", curve, spectrum
    warnings = ("The lines are drawn up to the target displacement.",) if iterate else ()
    ductility = curve.ductility(target, lines, end)
    return Target(*named, target, lines, values["T*"], ductility, factors, warnings)


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


def capacity_spectrum(curve: Capacity, spectrum: DesignSpectrum) -> Target:
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
    values: dict[str, float] = {}

    def demand(end: float) -> float:
        """Return the displacement of the equivalent oscillator by lines up to an end [m]."""
        lines = curve.idealise("asce_41", end)
        slow = 2.0 * math.pi * math.sqrt(curve.modal_mass / lines.stiffness)
        longer, more = equivalent(curve.ductility(end, lines, end))
        period, damping = slow * longer, 0.05 + 0.01 * more
        factor = damping_factor(damping)
        values.update({"T_0": slow, "T_eff": period, "beta_eff": damping, "B": factor})
        return curve.gamma * spectrum.sd(period) / factor

    target, end = _meeting(curve, demand, curve.largest, furthest=True)
    demand(end)
    lines = curve.idealise("asce_41", end)
    secant = curve.force_at(end) / end
    values["T_sec"] = 2.0 * math.pi * math.sqrt(curve.modal_mass / secant)
    warnings = []
    if not 0.2 < values["T_0"] < 2.0:
        warnings.append(f"T_0 = {values['T_0']:.3g} s is outside the fit of FEMA 440, 0.2 to 2 s.")
    named = "capacity_spectrum", "FEMA 440, chapter 6", curve, spectrum
    factors = {"Gamma": curve.gamma, **values, "alpha": lines.post_yield_ratio}
    ductility = curve.ductility(target, lines, end)
    return Target(*named, target, lines, values["T_eff"], ductility, factors, tuple(warnings))
