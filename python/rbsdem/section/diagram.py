"""A moment-curvature diagram, its events, and the confinement of the core."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.materials import Tension

if TYPE_CHECKING:
    from rbsdem.model.section import Section

__all__ = [
    "Confinement",
    "Diagram",
    "Events",
    "Point",
    "largest_moment",
    "make_diagram",
    "make_point",
]


@dataclass(frozen=True, slots=True)
class Confinement:
    """The confined core inside the ties (Mander, Priestley, Park 1988).

    Attributes
    ----------
    fcc : float
        Strength of the confined concrete [Pa].
    eps_cc : float
        Strain at its peak.
    r : float
        Exponent of its curve.
    eps_cu : float
        Strain at hoop fracture.
    effectiveness : float
        Coefficient k_e.
    lateral_stress : float
        Effective lateral stress f_l [Pa].
    ratio : float
        Volume of the transverse bars over that of the core, rho_s.
    width, depth : float
        Sizes of the core between the centre lines of the hoops [m].
    """

    fcc: float
    eps_cc: float
    r: float
    eps_cu: float
    effectiveness: float
    lateral_stress: float
    ratio: float
    width: float
    depth: float


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


@dataclass(frozen=True, eq=False)
class Diagram:
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

    section: Section
    axial_load: float
    tension: str
    confined: bool
    curvature: Array
    moment: Array
    strain: Array
    events: Events
    end: Point
    lost: bool


def make_point(values: dict[str, float]) -> Point | None:
    """Return a point, or None if it was not found."""
    if not values["found"]:
        return None
    return Point(**{field.name: values[field.name] for field in fields(Point)})


#: Points of a diagram at the most.
_MOST_POINTS = 100_000


def make_diagram(
    section: Section,
    axial_load: float,
    tension: Tension,
    confined: bool,
    rules: tuple[str, str],
    strains: tuple[float, float],
    points: int,
    furthest: float | None,
) -> Diagram:
    """Return the diagram; see `Section.diagram`."""
    settings = {
        "axial_load": axial_load,
        "tension": tension,
        "confined": confined,
        "yielding": rules[0],
        "ultimate": rules[1],
        "eps_yield": _arguments.number(strains[0], "diagram: eps_yield"),
        "eps_cover": _arguments.number(strains[1], "diagram: eps_cover"),
    }
    events, end, lost = _find(section, settings)
    if furthest is None:
        furthest = end.curvature
        if events.ultimate:
            furthest = min(furthest, 1.15 * events.ultimate.curvature)
    else:
        furthest = _arguments.number(furthest, "furthest")
        if not 0.0 < furthest * section.depth <= 1.0:
            raise InputError(f"furthest = {furthest} 1/m must be above zero and below 1/depth")
    points = _arguments.whole(points, "points")
    if not 2 <= points <= _MOST_POINTS:
        raise InputError(f"points = {points} must be from 2 to {_MOST_POINTS}")
    named = [point.curvature for point in (*_points(events), end) if point.curvature <= furthest]
    # Closer together where the diagram turns, at small curvatures.
    curvature = np.unique(np.concatenate([furthest * np.linspace(0.0, 1.0, points) ** 2, named]))
    moment, strain = section._strains(axial_load, curvature, tension, confined)
    return Diagram(
        section, axial_load, tension, confined, curvature, moment, strain, events, end, lost
    )


def largest_moment(section: Section, axial_load: float, confined: bool) -> float:
    """Return the largest moment of a diagram [N m], in a confined core until its hoops break."""
    settings = {"axial_load": axial_load, "confined": confined}
    rule = "mander" if confined and section.confinement.eps_cu < 1.0 else "cover"
    events, _, _ = _find(section, settings | {"ultimate": rule})
    broken, peak = events.ultimate, events.peak
    if peak is None:
        raise AssertionError("every diagram has a peak")
    if rule == "cover" or broken is None or peak.curvature <= broken.curvature:
        return peak.moment
    curvature = np.linspace(0.0, broken.curvature, 100)
    return float(section._strains(axial_load, curvature, "ts", confined)[0].max())


def _find(section: Section, settings: dict[str, Any]) -> tuple[Events, Point, bool]:
    """Return the named points, the end, and whether the axial load is lost there."""
    points, lost = _core.section_events(section._statement, settings)
    *named, end = (make_point(point) for point in points)
    if end is None:
        raise AssertionError("every diagram ends")
    return Events(*named), end, lost


def _points(events: Events) -> list[Point]:
    found = (events.cracking, events.yielding, events.peak, events.ultimate)
    return [point for point in found if point is not None]
