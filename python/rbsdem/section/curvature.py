"""Moment against curvature of a section under a constant axial load, and its events.

Ranges of loads and lengths that a user plausibly gives beside a section are checked here.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, ArrayLike, DataFrame
from rbsdem.errors import InputError, warn
from rbsdem.model.materials import Tension
from rbsdem.model.shape import Section, checked_section

#: Least and largest length of a column [m]: a number in millimetres is outside.
_SHORTEST, _LONGEST = 0.05, 100.0

#: Share of f'c A below which an axial load is hardly meant: the same number in kN is a usual load.
_HARDLY_ANY = 4e-4

RANGE: dict[str, tuple[float, float, float, str]] = {
    "axial load ratio": (0.0, 0.75, 1.0, ""),
    "concrete strength": (16e6, 110e6, 1e6, " MPa"),
    "yield stress of the bars": (240e6, 590e6, 1e6, " MPa"),
    "reinforcement ratio": (0.0045, 0.0605, 1.0, ""),
    "depth": (0.20, 0.65, 1.0, " m"),
    "shear span over depth": (1.5, 8.0, 1.0, ""),
    "yield stress of the ties times their ratio": (0.3e6, 16e6, 1e6, " MPa"),
    "tie spacing over bar diameter": (1.2, 18.0, 1.0, ""),
}
"""Range of the tests that the layered model was fitted to, in SI; a unit to print them in.

Of nearly all of them: 8 of 285 have a shorter shear span, 3 a smaller, 3 a larger depth, 11 fewer
ties.
"""

RANGE_OF_WALLS: dict[str, tuple[float, float, float, str]] = {
    "axial load ratio": (0.0, 0.35, 1.0, ""),
    "concrete strength": (15e6, 100e6, 1e6, " MPa"),
    "length over thickness": (4.0, 25.0, 1.0, ""),
    "shear span over length": (0.33, 3.05, 1.0, ""),
}
"""Range of the walls that the shear relation of walls and their bands stand on, likewise."""

#: A value on an end of a range may be off it by this share.
_SLACK = 1e-9


def column_length(value: Any, name: str) -> float:
    """Return a length from the base of a column to its lateral load [m].

    Parameters
    ----------
    value : float
        The length.
    name : str
        Its name in messages.

    Raises
    ------
    InputError
        If it is not a number, or no length of a column in metres.
    """
    length = value if type(value) is float else _arguments.number(value, name)
    if _SHORTEST <= length <= _LONGEST:
        return length
    hint = "1600 mm is 1.6"
    if length > 1e4:
        hint += "; the length comes before the axial load"
    raise InputError(
        f"{name} = {length:g} m must be between {_SHORTEST:g} and {_LONGEST:g}; {hint}"
    )


def axial_load_note(axial_load: float, section: Section) -> str:
    """Return a remark on an axial load that is hardly meant; empty if there is none.

    Tension is one, as the sign may be that of another convention, and a load as small as one in kN.

    Parameters
    ----------
    axial_load : float
        Compression positive [N].
    section : Section
        The section that carries it.
    """
    ratio = abs(axial_load) / (section.concrete.fc * section.gross_area)
    if not 0.0 < ratio < math.inf:
        return ""
    if ratio >= _HARDLY_ANY:
        if axial_load > 0.0:
            return ""
        least, most = section.axial_capacity
        if axial_load < least:
            # It will be refused.
            return ""
        return (
            f"axial_load = {axial_load:g} N is tension; compression is positive, and without "
            f"bending the section carries {least:g} to {most:g} N"
        )
    return (
        f"axial_load = {axial_load:g} N is only {ratio:.1e} of f'c A; loads are in N: 744 kN is "
        "744e3"
    )


def checked_load(section: Section, axial_load: Any) -> float:
    """Return an axial load as a number [N]; warn the caller's caller if it is hardly meant."""
    checked_section(section)
    value = _arguments.number(axial_load, "axial_load", unit="N")
    note = axial_load_note(value, section)
    if note:
        warn(note)
    return value


def is_confined(section: Section, confined: Any) -> bool:
    """Return whether the core is taken as confined; refuse it without transverse bars."""
    wanted = _arguments.boolean(confined, "confined")
    if wanted and not section.confines:
        raise InputError(
            f"confined = True needs transverse bars that confine: give the section {section.hoops}"
        )
    return wanted


def carried_load(value: Any, section: Section, *, tension: bool = True) -> float:
    """Return an axial load that a section carries [N].

    Parameters
    ----------
    value : float
        The load, compression positive [N].
    section : Section
        The section.
    tension : bool, optional
        Whether it may be tension.

    Raises
    ------
    InputError
        If it is not a finite number, or beyond the capacity of the section without bending and
        confinement.
    """
    load = _arguments.number(value, "axial_load", unit="N")
    least, most = section.axial_capacity
    if least <= load <= most and (tension or load >= 0.0):
        return load
    ends = f"{least:g} to {most:g} N" if tension else f"0 to {most:g} N"
    if load >= 0.0:
        fault = "is more compression than the section carries"
    elif tension:
        fault = "is more tension than the section carries"
    else:
        fault = "is tension, which the formulas are not for"
    raise InputError(f"axial_load = {load:g} N {fault}; compression is positive: give {ends}")


def range_warnings(section: Section, height: float, axial_load: float) -> tuple[str, ...]:
    """Return where a column is outside the range of the tests that the model was fitted to.

    Parameters
    ----------
    section : Section
        Its section.
    height : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    tuple of str
        A remark for each property that is outside; empty if there is none.
    """
    if section.shape == "wall":
        return _wall_warnings(section, height, axial_load)
    properties = {
        "axial load ratio": axial_load / (section.gross_area * section.concrete.fc),
        "concrete strength": section.concrete.fc,
        "yield stress of the bars": section.yield_stress,
        "reinforcement ratio": section.steel_ratio,
        "depth": section.depth,
        "shear span over depth": height / section.depth,
    }
    remarks = []
    if section.ties is None:
        remarks.append("there are no ties; of the tests that the model was fitted to two had none")
    else:
        ties = section.ties
        ratio = ties.legs * math.pi / 4 * ties.diameter**2 / (section.web_width * ties.spacing)
        properties["yield stress of the ties times their ratio"] = ratio * ties.steel.fy
        if section.bar_diameter:
            properties["tie spacing over bar diameter"] = ties.spacing / section.bar_diameter
    if section.shape == "tee":
        remarks.append("the section has a flange; those of the tests had none")
    if section.hollow:
        remarks.append("the section is hollow; those of the tests were solid")
    return (*remarks, *_outside(properties, RANGE, "the tests that the model was fitted to"))


def _outside(
    values: dict[str, float], ranges: dict[str, tuple[float, float, float, str]], what: str
) -> list[str]:
    """Return a remark for each value outside its range."""
    remarks = []
    for name, value in values.items():
        low, high, unit, label = ranges[name]
        if not low * (1 - _SLACK) <= value <= high * (1 + _SLACK):
            remarks.append(
                f"{name} = {value / unit:.3g}{label} is outside {low / unit:g} to "
                f"{high / unit:g}{label}, the range of {what}"
            )
    return remarks


def _wall_warnings(section: Section, span: float, axial_load: float) -> tuple[str, ...]:
    """Return remarks on a wall that is unlike those that were tested."""
    values = {
        "axial load ratio": axial_load / (section.gross_area * section.concrete.fc),
        "concrete strength": section.concrete.fc,
        "length over thickness": section.depth / section.width,
        "shear span over length": span / section.depth,
    }
    remarks = _outside(values, RANGE_OF_WALLS, "the tests of walls")
    if section.depth > RANGE_OF_WALLS["length over thickness"][1] * section.width:
        remarks.append("the wall may buckle out of its plane, which is not in the model")
    if section.ties is None:
        remarks.append("the wall has no horizontal bars")
    if section.outline().shape[0] > 4:
        remarks.append("the wall has flanges or barbells; those of the tests were rectangular")
    return tuple(remarks)


#: Points of a diagram at the most.
_MOST_POINTS = 100_000


@dataclass(frozen=True, slots=True)
class Point:
    """A point of the diagram.

    Attributes
    ----------
    curvature : float
        [1/m].
    moment : float
        About mid-depth [N m].
    strain : float
        At mid-depth, compression positive.
    """

    curvature: float
    moment: float
    strain: float


@dataclass(frozen=True, slots=True)
class Events:
    """Named points; None where the diagram has none.

    Attributes
    ----------
    cracking : Point or None
        The extreme fibre in tension is at f_t/E_c.
    yielding : Point or None
        Yield by the chosen rule.
    peak : Point or None
        The largest moment.
    ultimate : Point or None
        The ultimate point by the chosen rule.
    """

    cracking: Point | None
    yielding: Point | None
    peak: Point | None
    ultimate: Point | None


@dataclass(frozen=True, repr=False, eq=False)
class Diagram(Tabular):
    """Moment against curvature under a constant axial load.

    Attributes
    ----------
    section : Section
        The section.
    axial_load : float
        Compression positive [N].
    tension : str
        Tension law of the concrete.
    confined : bool
        Whether the core is taken as confined.
    curvature, moment, strain : ndarray, shape (n,)
        Increasing curvatures [1/m], moments about mid-depth [N m], strains at mid-depth
        (compression positive). The events are among these points.
    events : Events
        Cracking, yielding, peak, ultimate.
    end : Point
        Where concrete is crushed or a bar has broken and the moment has fallen by 20 per cent of
        its peak, or the axial load is no longer carried.
    lost : bool
        Whether the diagram ends because the axial load is no longer carried.
    """

    _columns = ("curvature 1/m", "moment Nm", "strain")
    section: Section
    axial_load: float
    tension: Tension
    confined: bool
    curvature: Array
    moment: Array
    strain: Array
    events: Events
    end: Point
    lost: bool

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each point; "event" names those that are events."""
        frame = super().to_pandas()
        named = {point.curvature: name for name, point in _named(self.events).items()}
        frame["event"] = [named.get(value, "") for value in self.curvature.tolist()]
        return frame

    def idealise(self, method: Literal["caltrans", "priestley"] = "caltrans") -> BilinearDiagram:
        """Replace the diagram up to its ultimate point by two straight lines.

        Parameters
        ----------
        method : {"caltrans", "priestley"}, optional
            "caltrans": through the first yield of a bar, then a constant moment with equal areas
            between that point and the ultimate one. "priestley": through the first yield (a bar, or
            0.002 in the concrete) to the nominal moment, at 0.004 in the extreme fibre or 0.015 in
            a bar, then to the ultimate point.

        Returns
        -------
        BilinearDiagram
            Yield point, stiffness and ductility; `capacity` of it is that of a column.

        Raises
        ------
        InputError
            If the method is not known, or the diagram has no yield before its ultimate point.

        Notes
        -----
        Caltrans, Seismic Design Criteria 1.7 (2013), 3.3.1. Priestley, Calvi, Kowalsky 2007;
        strains and lines as in CUMBIA (Montejo, Kowalsky 2007).
        """
        if method not in ("caltrans", "priestley"):
            raise InputError(
                f'idealise: method = {_arguments.shown(method)} must be "caltrans" or "priestley"'
            )
        names = ("axial_load", "tension", "confined")
        settings: dict[str, Any] = {name: getattr(self, name) for name in names}
        settings["yielding"] = "first" if method == "priestley" else "tension"
        found = _find(self.section, settings | {"eps_yield": 0.002, "eps_cover": 0.004})[0]
        first, last = found.yielding, self.events.ultimate
        if first is None or last is None or first.curvature >= last.curvature:
            raise InputError(
                "idealise: the diagram has no yield before its ultimate point; "
                "choose another ultimate, or look at a smaller axial load"
            )
        stiffness = first.moment / first.curvature
        if method == "priestley":
            moment = self._nominal(found.ultimate or last, last)
            turn = moment / stiffness
            return BilinearDiagram(self, method, first, last, turn, moment, last.moment)
        between = np.linspace(first.curvature, last.curvature, 1000)
        moments, _ = _moments(self.section, self.axial_load, between, self.tension, self.confined)
        area = float(np.sum(0.5 * (moments[1:] + moments[:-1]) * np.diff(between)))
        moment = area / (last.curvature - first.curvature)
        if moment > first.moment:
            # The first line goes on beyond the first yield.
            rest = last.curvature**2 - first.curvature**2 - 2.0 * area / stiffness
            moment = stiffness * (last.curvature - math.sqrt(max(rest, 0.0)))
        turn = moment / stiffness
        return BilinearDiagram(self, method, first, last, turn, moment, moment)

    def _nominal(self, crushed: Point, last: Point) -> float:
        """Return the moment at 0.004 in the extreme fibre or 0.015 in a bar, which comes first."""
        end = min(crushed.curvature, last.curvature)
        curvature = np.linspace(0.0, end, 400)
        how = self.tension, self.confined
        moment, strain = _moments(self.section, self.axial_load, curvature, *how)
        stretched = curvature * max(y for y, _, _ in self.section.bars) - strain
        return float(np.interp(min(0.015, stretched[-1]), stretched, moment))

    def __repr__(self) -> str:
        points = ", ".join(
            f"{name} {point.moment / 1e3:.4g} kN m at {1e3 * point.curvature:.3g} mrad/m"
            for name, point in _named(self.events).items()
        )
        core = "confined" if self.confined else "not confined"
        return f"Diagram(N {self.axial_load / 1e3:.4g} kN, {core}: {points})"


@dataclass(frozen=True, repr=False, eq=False)
class BilinearDiagram(Tabular):
    """Two straight lines in place of a moment-curvature diagram.

    Attributes
    ----------
    diagram : Diagram
        The diagram.
    method : str
        By which.
    first_yield, ultimate : Point
        Points of the diagram.
    yield_curvature, yield_moment : float
        phi_y [1/m] and its moment [N m], where the lines meet.
    ultimate_moment : float
        Where the second line ends [N m].
    """

    diagram: Diagram
    method: str
    first_yield: Point
    ultimate: Point
    yield_curvature: float
    yield_moment: float
    ultimate_moment: float

    @property
    def stiffness(self) -> float:
        """E I_eff, secant to the first yield [N m2]."""
        return self.first_yield.moment / self.first_yield.curvature

    @property
    def stiffness_ratio(self) -> float:
        """E I_eff over E_c I_g of the gross section."""
        section = self.diagram.section
        return self.stiffness / (section.concrete_law["ec"] * section.inertia)

    @property
    def ductility(self) -> float:
        """Ductility of curvature, mu_phi = phi_u/phi_y."""
        return self.ultimate.curvature / self.yield_curvature

    def capacity(self, length: float) -> DisplacementCapacity:
        """Return the displacement capacity of a cantilever by its plastic hinge.

        Parameters
        ----------
        length : float
            Shear span L, from the hinge to the point without moment [m].

        Returns
        -------
        DisplacementCapacity
            Hinge length, yield and ultimate displacement, without those of shear and P-Delta.

        Notes
        -----
        With L_sp = 0.022 f_y d_b (MPa) and phi_p = phi_u - phi_y.
        "caltrans" (SDC 1.7, 3.1.3 and 7.6.2): L_p = 0.08 L + L_sp >= 2 L_sp, Delta_y = phi_y L^2/3,
        Delta_p = L_p phi_p (L - L_p/2). "priestley": L_p = k L + L_sp >= 2 L_sp with
        k = 0.2 (f_u/f_y - 1) <= 0.08, Delta_y = phi_y (L + L_sp)^2/3 and, with phi'_y and M'_y of
        the first yield, Delta_u = phi_e (L + L_sp)^2/3 + (phi_u - phi_e) L_p (L + L_sp - L_p/2),
        phi_e = phi'_y M_u/M'_y.
        """
        span = column_length(length, "length")
        section = self.diagram.section
        _, _, steel = max(section.bars, key=lambda bar: bar[0])
        bar, ultimate = section.bar_diameter or 0.0, self.ultimate.curvature
        if self.method == "caltrans":
            share, lever, elastic = 0.08, span, self.yield_curvature
        else:
            if steel.fu is None:
                raise InputError("capacity: k needs the fu of the bars; give their Steel an fu")
            share = hardening_share(steel.fy, steel.fu)
            lever = span + strain_penetration(steel.fy, bar)
            elastic = self.ultimate_moment / self.stiffness
        hinge = hinge_length(share, span, strain_penetration(steel.fy, bar))
        at_yield = self.yield_curvature * lever**2 / 3.0
        turned = (ultimate - elastic) * hinge
        most = elastic * lever**2 / 3.0 + turned * (lever - 0.5 * hinge)
        return DisplacementCapacity(self.method, span, hinge, at_yield, most, turned)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame with the three corners of the lines."""
        curvature = [0.0, self.yield_curvature, self.ultimate.curvature]
        moment = [0.0, self.yield_moment, self.ultimate_moment]
        return data_frame({"curvature_1/m": curvature, "moment_Nm": moment})

    def __repr__(self) -> str:
        return (
            f"BilinearDiagram({self.method}: M {self.yield_moment / 1e3:.4g} kN m, "
            f"E I_eff {self.stiffness / 1e6:.4g} MN m2 ({self.stiffness_ratio:.3f} of gross), "
            f"phi_y {1e3 * self.yield_curvature:.3g} mrad/m, "
            f"phi_u {1e3 * self.ultimate.curvature:.4g} mrad/m, mu_phi {self.ductility:.3g})"
        )


@dataclass(frozen=True)
class DisplacementCapacity:
    """Displacements of a cantilever with a plastic hinge at its foot.

    Attributes
    ----------
    method : str
        By which.
    length, hinge_length : float
        L and l_p [m].
    yield_displacement, displacement : float
        Of the point without moment, at yield and at the ultimate curvature [m].
    plastic_rotation : float
        Of the hinge [rad].
    """

    method: str
    length: float
    hinge_length: float
    yield_displacement: float
    displacement: float
    plastic_rotation: float

    @property
    def ductility(self) -> float:
        """Ductility of displacement, mu_Delta."""
        return self.displacement / self.yield_displacement

    def __str__(self) -> str:
        return (
            f"{self.method}: l_p {1e3 * self.hinge_length:.4g} mm, displacement at yield "
            f"{1e3 * self.yield_displacement:.4g} mm, capacity {1e3 * self.displacement:.4g} mm "
            f"(drift {100 * self.displacement / self.length:.3g} %, ductility {self.ductility:.3g})"
        )


def strain_penetration(fy: float, bar: float) -> float:
    """Return L_sp = 0.022 f_y d_b (MPa), for f_y [Pa] and d_b [m]; in m."""
    return 0.022e-6 * fy * bar


def hardening_share(fy: float, fu: float) -> float:
    """Return k = 0.2 (f_u/f_y - 1) <= 0.08 (Priestley, Calvi, Kowalsky 2007)."""
    return min(0.2 * (fu / fy - 1.0), 0.08)


def hinge_length(share: float, span: float, penetration: float) -> float:
    """Return the length of a plastic hinge, k L + L_sp >= 2 L_sp, in the unit of L and L_sp."""
    return max(share * span + penetration, 2.0 * penetration)


def make_point(row: Array) -> Point | None:
    """Return the point of a row of the Fortran part, or None if it was not found."""
    values = _core.named("point", row)
    if not values["found"]:
        return None
    return Point(**{field.name: values[field.name] for field in fields(Point)})


def moment_curvature(
    section: Section,
    axial_load: float,
    curvature: ArrayLike,
    tension: Tension = "ts",
    confined: bool = False,
) -> Array:
    """Return the moment of each curvature under a constant axial load.

    Parameters
    ----------
    section : Section
        The section.
    axial_load : float
        Compression positive [N].
    curvature : array_like
        Curvatures, in any order [1/m]; a positive one puts y > 0 in tension. Each is reached
        from zero, so its moment does not depend on the others.
    tension : {"ts", "bare", "zero"}, optional
        Tension law of the concrete: with tension stiffening, up to f_t only, no tension.
    confined : bool, optional
        Whether the core inside the ties is confined and the cover spalls.

    Returns
    -------
    ndarray, shape of `curvature`
        Moments about mid-depth [N m].

    Raises
    ------
    InputError
        If the section cannot carry the axial load, or a value is refused.
    SolveError
        If the section no longer carries the axial load at one of the curvatures.
    """
    load = checked_load(section, axial_load)
    return _moments(section, load, curvature, tension, is_confined(section, confined))[0]


def strains(
    section: Section,
    axial_load: float,
    curvature: ArrayLike,
    tension: Tension = "ts",
    confined: bool = False,
) -> tuple[Array, Array]:
    """Return the moments of `moment_curvature` with the strains at mid-depth.

    Parameters
    ----------
    section : Section
        The section.
    axial_load, curvature, tension, confined
        As for `moment_curvature`.

    Returns
    -------
    moment, strain : ndarray, shape of `curvature`
        Moments about mid-depth [N m]; strains at mid-depth, compression positive. The strain
        at y is strain - curvature y.

    Raises
    ------
    InputError, SolveError
        As for `moment_curvature`.
    """
    load = checked_load(section, axial_load)
    return _moments(section, load, curvature, tension, is_confined(section, confined))


def _moments(
    section: Section, axial_load: float, curvature: ArrayLike, tension: Tension, confined: bool
) -> tuple[Array, Array]:
    """Return moments and strains at mid-depth, each curvature reached from zero."""
    wanted = _arguments.finite_vector(curvature, "curvature", shape="any")
    shape, flat = wanted.shape, wanted.ravel()
    over = np.flatnonzero(np.abs(flat) * section.depth > 1.0)
    if over.size:
        raise InputError(
            f"curvature: {flat[over[0]]} 1/m makes strains of {flat[over[0]] * section.depth:.3g} "
            f"over the depth; curvatures are in 1/m: 10 mrad/m is 0.01"
        )
    settings = {"axial_load": axial_load, "tension": tension, "confined": confined}
    asked = section._statement + _core.group("diagram", settings)
    points = np.empty((2, flat.size))
    for side in (flat >= 0.0, flat < 0.0):
        places = np.flatnonzero(side)
        if places.size:
            places = places[np.argsort(np.abs(flat[places]), kind="stable")]
            answer = _core.evaluate("moment_curvature", asked, curvature=flat[places])
            points[:, places] = answer.rows
    return points[0].reshape(shape)[()], points[1].reshape(shape)[()]


def diagram(
    section: Section,
    axial_load: float,
    *,
    tension: Tension = "ts",
    confined: bool | None = None,
    yielding: str = "tension",
    ultimate: str | None = None,
    eps_yield: float = 0.002,
    eps_cover: float = 0.003,
    points: int = 100,
    furthest: float | None = None,
) -> Diagram:
    """Return the moment-curvature diagram with its events.

    Parameters
    ----------
    section : Section
        The section.
    axial_load : float
        Compression positive [N].
    tension : {"ts", "bare", "zero"}, optional
        As for `moment_curvature`.
    confined : bool, optional
        Whether the core inside the ties is confined and the cover spalls; by default it is where
        there are ties.
    yielding : {"tension", "first"}, optional
        Yield is where the first bar in tension yields; or that or the strain `eps_yield` of
        the extreme fibre in compression, whichever comes first (Priestley, Calvi, Kowalsky
        2007).
    ultimate : {"fracture", "cover", "mander", "steel", "drop"}, optional
        Ultimate is where hoops or a bar break first ("fracture", the default with a confined
        core); the extreme fibre is at `eps_cover` ("cover", the default without one); the edge of
        the core is at the strain of hoop fracture (needs `confined`); the first bar breaks; the
        moment has fallen by 20 per cent of its peak, once concrete is crushed or a bar has broken.
    eps_yield, eps_cover : float, optional
        Strains of the extreme fibre, compression positive.
    points : int, optional
        Number of points of the diagram, besides its events.
    furthest : float, optional
        Last curvature of the diagram [1/m]; by default 1.15 times the ultimate one, or the end
        of the diagram if that comes first.

    Returns
    -------
    Diagram
        Curvatures, moments, strains and events; `rbsdem.plot.moment_curvature` draws them.

    Raises
    ------
    InputError, SolveError
        As for `moment_curvature`; `InputError` also if a rule is not known or does not apply.
    """
    load = checked_load(section, axial_load)
    confined = is_confined(section, section.ties is not None if confined is None else confined)
    if ultimate is None:
        ultimate = "fracture" if confined else "cover"
    settings: dict[str, Any] = {
        "axial_load": load,
        "tension": tension,
        "confined": confined,
        "yielding": yielding,
        "ultimate": _arguments.text(ultimate, "diagram: ultimate"),
        "eps_yield": _arguments.number(eps_yield, "diagram: eps_yield"),
        "eps_cover": _arguments.number(eps_cover, "diagram: eps_cover"),
    }
    events, end, lost = _events(section, settings)
    if furthest is None:
        furthest = end.curvature
        if events.ultimate:
            furthest = min(furthest, 1.15 * events.ultimate.curvature)
    else:
        furthest = checked_furthest(furthest, section)
    points = _arguments.integer(points, "points", least=2, most=_MOST_POINTS)
    named = [p.curvature for p in (*_named(events).values(), end) if p.curvature <= furthest]
    # Closer together where the diagram turns, at small curvatures.
    curvature = np.unique(np.concatenate([furthest * np.linspace(0.0, 1.0, points) ** 2, named]))
    moment, strain = _moments(section, load, curvature, tension, confined)
    return Diagram(section, load, tension, confined, curvature, moment, strain, events, end, lost)


def checked_furthest(furthest: float, section: Section) -> float:
    """Return the curvature at which a diagram ends [1/m], or refuse it."""
    furthest = _arguments.number(furthest, "furthest")
    if not 0.0 < furthest * section.depth <= 1.0:
        raise InputError(f"furthest = {furthest} 1/m must be above zero and below 1/depth")
    return furthest


def largest_moment(section: Section, axial_load: float, confined: bool) -> float:
    """Return the largest moment of a diagram [N m], in a confined core until its hoops break."""
    settings = {"axial_load": axial_load, "confined": confined}
    core = section.confinement if confined else None
    rule = "mander" if core is not None and core.eps_cu < 1.0 else "cover"
    events, _, _ = _find(section, settings | {"ultimate": rule})
    broken, peak = events.ultimate, events.peak
    if peak is None:
        raise AssertionError("every diagram has a peak")
    if rule == "cover" or broken is None or peak.curvature <= broken.curvature:
        return peak.moment
    curvature = np.linspace(0.0, broken.curvature, 100)
    return float(_moments(section, axial_load, curvature, "ts", confined)[0].max())


def _events(section: Section, settings: dict[str, Any]) -> tuple[Events, Point, bool]:
    """Return the answer of `_find`; for "fracture" that of the rule whose point comes first."""
    if settings["ultimate"] != "fracture":
        return _find(section, settings)
    core = section.confinement
    hoops = settings["confined"] and core is not None and core.eps_cu < 1.0
    rules = ["steel", "mander"] if hoops else ["steel"]
    answers = [_find(section, settings | {"ultimate": rule}) for rule in rules]

    def place(answer: tuple[Events, Point, bool]) -> float:
        point = answer[0].ultimate
        return math.inf if point is None else point.curvature

    return min(answers, key=place)


def _find(section: Section, settings: dict[str, Any]) -> tuple[Events, Point, bool]:
    """Return the named points, the end, and whether the axial load is lost there."""
    answer = _core.evaluate("section_events", section._statement + _core.group("diagram", settings))
    *named, end = map(make_point, answer.rows)
    if end is None:
        raise AssertionError("every diagram ends")
    return Events(*named), end, bool(answer.values[0])


def _named(events: Events) -> dict[str, Point]:
    """Return the points that were found by their names."""
    points = {field.name: getattr(events, field.name) for field in fields(Events)}
    return {name: point for name, point in points.items() if point is not None}
