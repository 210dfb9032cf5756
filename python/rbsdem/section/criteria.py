"""Limit states as linear criteria on the deformations of joints.

A strain of a layered hinge is linear in the rotation and the opening of its joint, and a spring
leaves its line at a deformation. So one list serves the rows of a result and the runs of an
ensemble, which keep no rows.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.model.frame import FrameMember, FrameSpring
from rbsdem.model.shape import Section
from rbsdem.model.springs import Gauge, Landmark, Layered, Spring
from rbsdem.model.wall import WallSection
from rbsdem.section.frame import Frame, Structure
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.quantities import goodnight_buckling_strain, quantities

#: The limit states that criteria find, and what each is.
WATCHED: dict[str, str] = {
    "cracking": "the section cracks, or a spring leaves its first line",
    "first_yield": "the first bar, of a wall of its boundary elements, or a flexural spring yields",
    "web_yield": "the first bar of the web of a wall yields",
    "nominal_moment": "the extreme fibre is at the strain of the nominal moment",
    "hoop_yield": "the core is at the peak of its confined strength, where its hoops yield",
    "spalling": "the cover spalls",
    "crushing": "the core of a boundary element of a wall, or its end without hoops, is crushed",
    "bar_buckling": "a bar is stretched so far that it buckles on reversal",
    "hoop_fracture": "the core is at the strain at which its hoops fracture",
    "bar_fracture": "a bar in tension breaks",
    "cap": "a flexural spring is at its largest moment, from which on it falls",
    "shear_cracking": "a shear spring leaves its first line",
    "shear_yield": "a shear spring yields",
    "shear_failure": "a shear spring is at its largest force, from which on it falls",
}

#: Strain at which the cover of a wall spalls.
_SPALLS = 0.004

#: Limit states of springs by the landmarks at which they are reached.
_TURNS = {"cracking": "cracking", "yield": "first_yield", "cap": "cap"}
_SLIPS = {"cracking": "shear_cracking", "yield": "shear_yield", "cap": "shear_failure"}

_OF_BARS = {
    "first_yield": "f_y/E_s of a bar in tension",
    "web_yield": "f_y/E_s of a bar of the web in tension",
    "bar_fracture": "eps_u of a bar in tension",
    "bar_buckling": "tensile strain before bars buckle on reversal (Goodnight, Kowalsky, Nau 2016)",
}


@dataclass(frozen=True)
class Criterion:
    """A limit state is reached where a sum of a joint's deformations is at a threshold.

    Attributes
    ----------
    name : str
        The limit state, one of `WATCHED`.
    joint : int
        The joint, from 1 at the ground.
    threshold : float
        A strain, a rotation [rad] or a slip [m].
    source : str
        Where the threshold comes from.
    slip, rotation, opening : float
        Factors of the slip, of the rotation with that at rest, and of the opening; of a joint of
        layers in a frame those of a layer (rotation) and of the next one (slip).
    """

    name: str
    joint: int
    threshold: float
    source: str
    slip: float = 0.0
    rotation: float = 0.0
    opening: float = 0.0

    def values(self, result: Any, at: int) -> Array:
        """Return the values that the threshold bounds, shape (rows,); `at` is the joint index."""
        if self.slip:
            return np.asarray(self.slip * result.slip[:, at])
        turned = result.rotation[:, at]
        if not self.opening:
            return np.asarray(self.rotation * turned)
        if (rest := result.rest) is not None:
            turned = turned + rest[:, at]
        return np.asarray(self.rotation * turned + self.opening * result.opening[:, at])


def criteria(column: Structure, names: Collection[str] = tuple(WATCHED)) -> Sequence[Criterion]:
    """Return the criteria of a column; where a state has several, the first to be reached counts.

    Parameters
    ----------
    column : Column or Frame
        The structure.
    names : collection of str, optional
        The limit states that are wanted.
    """
    if set(WATCHED) <= set(names):
        # Once for all analyses, as a frozen column does not change.
        if "_criteria" not in column.__dict__:
            _arguments.put(column, _criteria=tuple(_criteria(column, names)))
        every: tuple[Criterion, ...] = column.__dict__["_criteria"]
        return every
    return _criteria(column, names)


def _criteria(column: Structure, names: Collection[str]) -> list[Criterion]:
    """Return the criteria of a structure for the limit states in `names`."""
    listed: list[Criterion] = []
    if isinstance(column, Frame):
        for group, states, what in (("flexure", _TURNS, "rotation"), ("shear", _SLIPS, "slip")):
            springs = column.parts.springs_of(group)
            single = [part for part in springs if part.rule != "layered"]
            if group == "flexure":
                listed += _of_joints(column, springs, len(single))
            for number, part in enumerate(single, 1):
                where = f"the {group} spring of {part.member} at {part.position:g} of its length"
                if part.group == "panel":
                    where = f"the panel of node {part.member}"
                marks = column.landmarks[part]
                listed += _of_landmarks(number, marks, where, states, what)
        return [criterion for criterion in listed if criterion.name in names]
    for joint, spring in zip(column.joint_numbers, column.joints("flexure"), strict=True):
        if joint == 0:  # A footing is not the column.
            continue
        if isinstance(spring, Layered):
            listed += _of_layers(column, joint, spring, names)
        else:
            listed += _of_spring(joint, spring, _TURNS, "rotation")
    for joint, spring in zip(column.joint_numbers, column.joints("shear"), strict=True):
        if joint > 0:
            listed += _of_spring(joint, spring, _SLIPS, "slip")
    return [criterion for criterion in listed if criterion.name in names]


def _of_joints(frame: Frame, springs: Sequence[FrameSpring], number: int) -> Iterator[Criterion]:
    """Yield the criteria of joints of layers, whose layers are numbered from `number` + 1 on.

    Sections stay plane: of equal layers the outermost ones are stretched most, and where no layer
    is (the slip is that of the next one) two of them give the strain.
    """
    for part in springs:
        made = frame.joints.get(part)
        if made is None:
            continue
        alike: dict[tuple[str, float, bool], list[Criterion]] = {}
        for each in joint_criteria(frame.kinds[part.member], part.position, made):
            key = each.name, each.threshold / abs(each.opening), each.opening > 0.0
            alike.setdefault(key, []).append(each)
        places = np.array([y for y, _ in made.layers])
        widest = int(np.argmax(np.abs(np.diff(places)))) if places.size > 1 else 0
        for equal in alike.values():
            by_place = sorted(equal, key=lambda each: each.rotation / each.opening)
            for each in dict.fromkeys((by_place[0], by_place[-1])):
                y = each.rotation / each.opening
                at, share = int(np.argmin(np.abs(places - y))), 0.0
                if not math.isclose(places[at], y, rel_tol=1e-9, abs_tol=1e-9):
                    at = widest
                    share = (y - places[at]) / (places[at + 1] - places[at])
                yield replace(
                    each,
                    joint=number + at + 1,
                    source=f"{each.source} of {part.member}",
                    slip=each.opening * share,
                    rotation=each.opening * (1.0 - share),
                    opening=0.0,
                )
        number += places.size


def _drawn_wall(kind: FrameMember, position: float) -> tuple[WallSection, Gauge] | None:
    """Return the section and the gauge of a joint of layers at the foot of a drawn wall."""
    section = kind.sections and kind.sections[0]
    if position == 0.0 and kind.gauge is not None and isinstance(section, WallSection):
        return section, kind.gauge
    return None


def joint_criteria(kind: FrameMember, position: float, made: Layered) -> list[Criterion]:
    """Return criteria on rotation and opening of a joint of layers in a member of a frame.

    Where a layer yields in tension ("first_yield"), and an outer layer of concrete has lost its
    strength ("spalling"); of the foot of a drawn wall the states of one that stands alone that
    concern its bars, its cover and its core.

    Parameters
    ----------
    kind : FrameMember
        What the member is of.
    position : float
        Of the joint, in shares of the clear length.
    made : Layered
        The joint.
    """
    if (drawn := _drawn_wall(kind, position)) is not None:
        section, gauge = drawn
        wanted = {*_OF_BARS, "spalling", "crushing"}
        every = *_of_bars(section, 0, (made, gauge)), *_of_fibres(section, 0, gauge)
        return [criterion for criterion in every if criterion.name in wanted]
    return [
        Criterion(
            "first_yield" if mark.name == "yield" else mark.name,
            0,
            mark.deformation,
            mark.source,
            rotation=mark.side * y,
            opening=mark.side,
        )
        for y, marks in made.points
        for mark in marks
    ]


def all_thresholds(column: Structure, openings: bool) -> Array:
    """Return the criteria of a run in numbers, those of openings only if they are kept.

    Each criterion is a state of its own. In a run without openings those on openings stay in the
    list, with a threshold that cannot be reached.
    """
    listed = criteria(column)
    numbers = thresholds(column, listed, range(1, len(listed) + 1))
    if not openings:
        numbers[[bool(each.opening) for each in listed], 5] = np.finfo(np.float64).max
        numbers[:, 4] = 0.0
    return numbers


def thresholds(column: Structure, found: Sequence[Criterion], states: Iterable[int]) -> Array:
    """Return criteria in numbers, shape (criteria, 6), as the Fortran part takes them.

    Parameters
    ----------
    column : Column
        The column.
    found : sequence of Criterion
        Its criteria, or some of them.
    states : iterable of int
        The number of the limit state of each.
    """
    # The rows of a run count the joints from the ground, a footing's included.
    at = {joint: index for index, joint in enumerate(column.joint_numbers, 1)}
    rows = [
        (state, at[c.joint], c.slip, c.rotation, c.opening, c.threshold)
        for state, c in zip(states, found, strict=True)
    ]
    return np.array(rows, dtype=float).reshape(-1, 6)


def _of_spring(
    joint: int, spring: Spring, names: Mapping[str, str], what: str
) -> Iterator[Criterion]:
    """Yield where a spring leaves its lines, to either side."""
    kind = f"{type(spring).__name__}{' shear' if what == 'slip' else ''}"
    where = f"the {kind} spring of joint {joint}"
    yield from _of_landmarks(joint, spring.landmarks(), where, names, what)


def _of_landmarks(
    joint: int, marks: Sequence[Landmark], where: str, names: Mapping[str, str], what: str
) -> Iterator[Criterion]:
    """Yield a criterion for each landmark: on "rotation" or "slip" (`what`) of a joint."""
    for mark in marks:
        source = f"{mark.source} of {where}"
        side = float(mark.side)
        yield Criterion(names[mark.name], joint, mark.deformation, source, **{what: side})


def _of_layers(
    column: Column, joint: int, spring: Layered, names: Collection[str]
) -> Iterator[Criterion]:
    """Yield the criteria of a joint by the strains of its layers."""
    if column.opens:  # Its openings are those of axial springs.
        return
    gauge = column.gauge(joint)
    if gauge is not None and isinstance(column, LayeredColumn) and column.drawing is not None:
        section, buckles = column.drawing.section, math.inf
        if "bar_buckling" in names and section.shape != "wall":
            buckles = buckling_strain(section, column)
        yield from _of_bars(section, joint, (spring, gauge), buckles)
        if not set(names) <= set(_OF_BARS):
            yield from _of_fibres(section, joint, gauge)
        return
    for y, layer in spring.layers:
        for mark in layer.landmarks():
            if mark.name == "yield" and mark.side > 0:
                source = (
                    f"{mark.source} of a {type(layer).__name__} layer of joint {joint}, in tension"
                )
                at = mark.deformation
                yield Criterion("first_yield", joint, at, source, rotation=y, opening=1.0)


def _of_fibres(section: Section, joint: int, gauge: Gauge) -> Iterator[Criterion]:
    """Yield strains of the concrete of a hinge that knows its drawing."""
    law, half = section.concrete_law, 0.5 * section.depth
    walls = section.shape == "wall"
    length = next(
        length for part, length in zip(gauge.part, gauge.length, strict=True) if part != "bar"
    )

    def strain(name: str, y: float, at: float, source: str, sign: float = 1.0) -> Criterion:
        """Return a criterion on the strain at y; with `sign` = -1 compression is positive."""
        turn, open_ = sign * y / length, sign / length
        return Criterion(name, joint, float(at), source, rotation=turn, opening=open_)

    for y in (half, -half):
        if law["ft"] > 0:  # Without tensile strength there is nothing to crack.
            source = "f_t/E_c at the extreme fibre, over the length of the hinge"
            yield strain("cracking", y, law["ft"] / law["ec"], source)
        source = "0.003 at the extreme fibre (ACI 318-19, 22.2.2.1)"
        yield strain("nominal_moment", y, 0.003, source, -1.0)
        lost = section.concrete.eps_spall
        if walls:
            yield strain("spalling", y, _SPALLS, "0.004 at the end face of a wall", -1.0)
        else:
            yield strain("spalling", y, lost, "eps_spall of the concrete", -1.0)
        # The confinement of a wall is that of its end at y < 0.
        core = section.confinement if y < 0 or not walls else section.mirrored.confinement
        if core is None:
            if walls:
                yield strain("crushing", y, lost, "eps_spall of the end without hoops", -1.0)
            continue
        edge = math.copysign(0.5 * core.depth, y)
        if isinstance(section, WallSection):
            edge = math.copysign(section.core_edges[y > 0], y)
            source = "eps_cc at the edge of the core (Mander, Priestley, Park 1988)"
            yield strain("crushing", edge, core.eps_cc, source, -1.0)
        source = "eps_cc at the edge of the core (Mander, Priestley, Park 1988)"
        yield strain("hoop_yield", edge, core.eps_cc, source, -1.0)
        source = "eps_cu at the edge of the core (Priestley, Seible, Calvi 1996, eq 5.14)"
        yield strain("hoop_fracture", edge, core.eps_cu, source, -1.0)


def _of_bars(
    section: Section, joint: int, layers: tuple[Layered, Gauge], buckles: float = math.inf
) -> Iterator[Criterion]:
    """Yield strains of the bars of a hinge that knows its drawing."""
    spring, gauge = layers
    for y, over, strains in _outer_bars(section, gauge, spring, buckles):
        lever = {"rotation": y / over, "opening": 1.0 / over}
        for name, at in strains.items():
            yield Criterion(name, joint, float(at), _OF_BARS[name], **lever)


def _outer_bars(
    section: Section, gauge: Gauge, spring: Layered, buckles: float = math.inf
) -> Iterator[tuple[float, float, dict[str, float]]]:
    """Yield place, length and strains at the limit states of the outermost of equal bars.

    Bars of columns buckle at the strain that is given, those of walls at that of their layers.
    """
    outer: dict[tuple[float, ...], list[float]] = {}
    rows = zip(spring.layers, gauge.part, gauge.length, strict=True)
    layers_of_bars = [(y, layer, over) for (y, layer), part, over in rows if part == "bar"]
    # Layers of bars are in the order of `section.bars`: one height may have several steels.
    for (y, layer, over), (_, _, steel) in zip(layers_of_bars, section.bars, strict=True):
        in_web, bows = 0.0, buckles
        if isinstance(section, WallSection):
            in_web = float(not section.in_boundary(y))
            bows = (getattr(layer, "d_buckle", None) or math.inf) / over
        key = steel.fy / steel.es, steel.eps_u, bows, in_web, over
        outer.setdefault(key, []).append(y)
    for (yields, breaks, bows, in_web, over), places in outer.items():
        strains = {"bar_fracture": breaks, "bar_buckling": bows}
        strains["web_yield" if in_web else "first_yield"] = yields
        known = {name: strain for name, strain in strains.items() if math.isfinite(strain)}
        # Plane sections: of equal bars the outermost ones are stretched most.
        for y in dict.fromkeys((max(places), min(places))):
            yield y, over, known


def buckling_strain(section: Section, column: Column) -> float:
    """Return the tensile strain beyond which bars buckle on reversal; infinite if not known.

    It is known of solid sections with hoops and bars near both faces, in compression.
    """
    if section.hollow or section.ties is None:
        return math.inf
    span = column.height / (2 if column.top == "fixed" else 1)
    try:
        given = quantities(section, span, column.axial_load)
    except InputError:
        return math.inf
    return max(goodnight_buckling_strain(given), 0.01)
