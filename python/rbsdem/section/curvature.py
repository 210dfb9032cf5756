"""Moment against curvature of a section under a constant axial load, and its events."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem._files import Tabular, data_frame
from rbsdem.errors import InputError
from rbsdem.model.materials import Tension
from rbsdem.model.shape import Section
from rbsdem.section.ranges import checked_load, is_confined

if TYPE_CHECKING:
    import pandas as pd

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

    def to_pandas(self) -> pd.DataFrame:
        """Return a DataFrame, a row for each point; "event" names those that are events."""
        frame = data_frame(
            {"curvature_1/m": self.curvature, "moment_Nm": self.moment, "strain": self.strain}
        )
        named = {point.curvature: name for name, point in _named(self.events).items()}
        frame["event"] = [named.get(value, "") for value in self.curvature.tolist()]
        return frame

    def __repr__(self) -> str:
        points = ", ".join(
            f"{name} {point.moment / 1e3:.4g} kN m at {1e3 * point.curvature:.3g} mrad/m"
            for name, point in _named(self.events).items()
        )
        core = "confined" if self.confined else "not confined"
        return f"Diagram(N {self.axial_load / 1e3:.4g} kN, {core}: {points})"


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
    given = _arguments.finite_vector(curvature, "curvature", shape="any")
    shape, flat = given.shape, given.ravel()
    over = np.flatnonzero(np.abs(flat) * section.depth > 1.0)
    if over.size:
        raise InputError(
            f"curvature: {flat[over[0]]} 1/m makes strains of {flat[over[0]] * section.depth:.3g} "
            f"over the depth; curvatures are in 1/m: 10 mrad/m is 0.01"
        )
    settings = {"axial_load": axial_load, "tension": tension, "confined": confined}
    asked = section._statement + _core.group("diagram", settings)
    moment = np.empty_like(flat)
    strain = np.empty_like(flat)
    for side in (flat >= 0.0, flat < 0.0):
        places = np.flatnonzero(side)
        if places.size:
            places = places[np.argsort(np.abs(flat[places]), kind="stable")]
            rows = _core.evaluate("moment_curvature", asked, curvature=flat[places]).rows
            moment[places], strain[places] = rows
    return moment.reshape(shape)[()], strain.reshape(shape)[()]


def diagram(
    section: Section,
    axial_load: float,
    *,
    tension: Tension = "ts",
    confined: bool = False,
    yielding: str = "tension",
    ultimate: str = "cover",
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
    tension, confined
        As for `moment_curvature`.
    yielding : {"tension", "first"}, optional
        Yield is where the first bar in tension yields; or that or the strain `eps_yield` of
        the extreme fibre in compression, whichever comes first (Priestley, Calvi, Kowalsky
        2007).
    ultimate : {"cover", "mander", "steel", "drop"}, optional
        Ultimate is where the extreme fibre is at `eps_cover`; the edge of the core is at the
        strain of hoop fracture (needs `confined`); the first bar breaks; the moment has fallen
        by 20 per cent of its peak, once concrete is crushed or a bar has broken.
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
    load, confined = checked_load(section, axial_load), is_confined(section, confined)
    settings = {
        "axial_load": load,
        "tension": tension,
        "confined": confined,
        "yielding": yielding,
        "ultimate": ultimate,
        "eps_yield": _arguments.number(eps_yield, "diagram: eps_yield"),
        "eps_cover": _arguments.number(eps_cover, "diagram: eps_cover"),
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
    points = _arguments.integer(points, "points", least=2, most=_MOST_POINTS)
    named = [
        point.curvature for point in (*_named(events).values(), end) if point.curvature <= furthest
    ]
    # Closer together where the diagram turns, at small curvatures.
    curvature = np.unique(np.concatenate([furthest * np.linspace(0.0, 1.0, points) ** 2, named]))
    moment, strain = _moments(section, load, curvature, tension, confined)
    return Diagram(section, load, tension, confined, curvature, moment, strain, events, end, lost)


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


def _find(section: Section, settings: dict[str, Any]) -> tuple[Events, Point, bool]:
    """Return the named points, the end, and whether the axial load is lost there."""
    answer = _core.evaluate("section_events", section._statement + _core.group("diagram", settings))
    *named, end = map(make_point, answer.rows)
    if end is None:
        raise AssertionError("every diagram ends")
    return Events(*named), end, bool(answer.values[0])


def _named(events: Events) -> dict[str, Point]:
    """Return the points that were found by their names."""
    found = {field.name: getattr(events, field.name) for field in fields(Events)}
    return {name: point for name, point in found.items() if point is not None}
