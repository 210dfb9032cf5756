"""Planar frames: columns and beams as one assembly of bodies and springs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import count, product
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from rbsdem import _arguments, _core
from rbsdem._types import Array
from rbsdem.errors import InputError
from rbsdem.model.shape import Section
from rbsdem.model.springs import Gauge, Group, Spring, placed

_PLACES = ("shear", "flexure", "axial_spring")
#: Words for lines and bays.
_SIDES = ("outer", "inner")
_SUPPORTS = ("free", "roller", "pinned", "fixed")


@dataclass(frozen=True)
class FrameMember:
    """A kind of column or beam: elastic, with sections that yield, or with springs of its own.

    Parameters
    ----------
    modulus, area, inertia : float
        Young's modulus [Pa], area [m2] and second moment of area [m4] of the section; of the
        cracked section, if that is meant.
    yield_moment : float, optional
        Moment at which sections yield [N m]. The member is then the force-based beam-column element
        with three points (Gauss and Lobatto), bilinear each.
    hardening : float, optional
        Stiffness of a section after yielding over the one before.
    shear_rigidity : float, optional
        Shear modulus times shear area [N]; 0: no deformation by shear.
    flexure : Spring, sequence of two, or mapping, optional
        Rotational springs in place of `yield_moment`: one for both ends, one for each end, or a
        mapping from positions in shares of the clear length to springs. Joints of layers
        (`Layered`) take part in the axial force of the member; y is positive on the left of the
        way from its start to its end, above in a beam of a grid.
    shear : Spring or mapping, optional
        Springs that slip, one or by their positions.
    axial_spring : Spring, optional
        A spring that opens.
    interior : {"elastic", "rigid"}, optional
        Part between the springs: the elastic beam, or nothing that bends, where the springs
        hold all of the flexibility. Without springs a "rigid" member does not deform (`rigid`).
    ends : {"continuous", "pinned"}, optional
        How it joins its nodes. A member with pinned ends carries axial force alone, and may have an
        axial spring alone; a load on it goes to its nodes.
    after_dead_load : bool, optional
        Whether it is built when the dead load acts already, as infills, jackets and braces are: it
        carries none of it, and its springs count from the frame as it stands then.
    rigid_end : float or pair of float, optional
        Rigid length in each node of a grid that the member ends in, half the depth of the other
        member [m]; not at the base. Two of them are those at its start and at its end.
    failure_drift, failure_load, shear_drift : float, optional
        Once a shear spring of it has yielded (`PeakOriented` or `Pinching`), or its drift is
        `shear_drift`, the member loses its axial load P at the drift failure_drift/(1 +
        P/failure_load) of its clear length, with P [N] of that moment. In time it carries nothing
        from the next step on; a static path ends there with a message.
    length : float, optional
        Clear length that the springs were made for [m], as by `rbsdem.section.member`; members
        whose own differs by more than 1 % are refused. A column in two planes of a building has the
        axial stiffness of such a member, though joints of both planes open.
    name : str, optional
        Name in case files; made up if it is not given.
    sections : pair of Section, optional
        Sections of its two halves, y > 0 on the left of the way from start to end.
    shear_spans : pair of pairs of float, optional
        M/V that its strength in shear is of [m], at start and end, with y > 0 in tension and in
        compression; a run tells where its forces have others.
    gauge : Gauge, optional
        What the layers of the joint at its start stand for, of a drawn wall.
    """

    modulus: float
    area: float
    inertia: float
    yield_moment: float | None = None
    hardening: float = 0.0
    shear_rigidity: float = 0.0
    flexure: Spring | Sequence[Spring] | Mapping[float, Spring] | None = None
    shear: Spring | Mapping[float, Spring] | None = None
    axial_spring: Spring | None = None
    interior: Literal["elastic", "rigid"] = "elastic"
    ends: Literal["continuous", "pinned"] = "continuous"
    after_dead_load: bool = False
    rigid_end: float | tuple[float, float] = 0.0
    failure_drift: float | None = None
    failure_load: float | None = None
    shear_drift: float | None = None
    length: float | None = None
    name: str = field(default="", compare=False)
    sections: tuple[Section, Section] | None = field(default=None, compare=False, repr=False)
    shear_spans: tuple[tuple[float, float], tuple[float, float]] | None = field(
        default=None, compare=False, repr=False
    )
    gauge: Gauge | None = field(default=None, compare=False, repr=False)

    def __post_init__(self) -> None:
        _arguments.convert(self, "FrameMember")
        rigid: Any = self.rigid_end
        if isinstance(rigid, (tuple, list)):
            rigid = tuple(_arguments.number(length, "FrameMember: rigid_end") for length in rigid)
            if len(rigid) != 2:
                raise InputError(
                    f"FrameMember: rigid_end has {len(rigid)} values; give one, or two"
                )
        else:
            rigid = _arguments.number(rigid, "FrameMember: rigid_end")
        springs = _by_position(self.flexure, "flexure", (0.0, 1.0))
        slips = _by_position(self.shear, "shear", (0.5,))
        _arguments.put(self, rigid_end=rigid, flexure=springs, shear=slips)

    @classmethod
    def rigid(cls, **more: Any) -> FrameMember:
        """Return a kind that does not deform, with `rigid_end` and `name` as for any.

        It is 1e5 times as stiff along it and 1e7 times in bending as the stiffest member of the
        frame, which changes forces and periods by less than 1e-6 of them.
        """
        return cls(1.0, 1.0, 1.0, interior="rigid", **more)

    @classmethod
    def strut(cls, spring: Spring, **more: Any) -> FrameMember:
        """Return a kind of one axial spring between two pins, with `after_dead_load` and `name`.

        A spring that carries compression alone is `Compression`, or `PeakOriented` and `Pinching`
        with ``f_y=0`` and the strength ``f_y_neg`` on the other side.
        """
        return cls(1.0, 1.0, 1.0, axial_spring=spring, interior="rigid", ends="pinned", **more)

    def _elastic(self) -> dict[str, float]:
        """Return modulus, area and inertia, which a rigid kind and a strut have none of."""
        springs = self.flexure, self.shear, self.axial_spring, self.yield_moment
        if self.interior == "rigid" and (self.ends == "pinned" or not any(springs)):
            return {}
        return {"modulus": self.modulus, "area": self.area, "inertia": self.inertia}

    def at(self, group: str, position: float) -> Spring | None:
        """Return the spring of a group that was given at a position, None without one."""
        if group == "axial_spring":
            return self.axial_spring
        return dict(self._springs(group)).get(position)

    def _springs(self, group: str) -> tuple[tuple[float, Spring], ...]:
        """Return the springs of "flexure" or "shear" with their positions from 0 to 1."""
        return getattr(self, group) or ()

    def _groups(self, name: str, drawn: Mapping[Any, dict[str, Any]]) -> list[Any]:
        """Return the groups of a case file under a name, and the springs that stand in some.

        `drawn` has the names of drawings by sections; without its own they are left out.
        """
        groups: list[Any] = [
            ("member_kind", {
                "name": _core.Text(name),
                **self._elastic(),
                "shear_rigidity": self.shear_rigidity or None,
                "yield_moment": self.yield_moment,
                "hardening": self.hardening or None,
                "length": self.length,
                "failure_drift": self.failure_drift,
                "failure_load": self.failure_load,
                "shear_drift": self.shear_drift,
                "interior": None if self.interior == "elastic" else self.interior,
                "ends": None if self.ends == "continuous" else self.ends,
                "after_dead_load": self.after_dead_load or None,
                **self._drawing(drawn),
            })
        ]  # fmt: skip
        for group in ("flexure", "shear"):
            positions: dict[Spring, list[float]] = {}
            for position, spring in self._springs(group):
                positions.setdefault(spring, []).append(position)
            for spring, where in positions.items():
                groups.append((group, {"kind": _core.Text(name), "position": where}, spring))
        if self.axial_spring is not None:
            groups.append(("axial_spring", {"kind": _core.Text(name)}, self.axial_spring))
        return groups

    def _drawing(self, drawn: Mapping[Any, dict[str, Any]]) -> dict[str, Any]:
        """Return the keys of its sections, and of what is known of its springs by them."""
        if self.sections not in drawn:
            return {}
        halves = drawn[self.sections]
        keys = {"section": halves["kind"], "section_to": halves["kind_to"]}
        if self.shear_spans is not None:
            keys["shear_spans"] = [span for pair in self.shear_spans for span in pair]
        if self.gauge is not None:
            lengths = dict(zip(self.gauge.part, self.gauge.length, strict=True))
            keys["core_layers"] = self.gauge.part.count("core") or None
            keys["concrete_length"] = lengths.get("core", lengths.get("cover"))
            keys["bar_length"] = lengths["bar"]
        return keys


def _by_position(
    stated: Any, name: str, usual: tuple[float, ...]
) -> tuple[tuple[float, Spring], ...] | None:
    """Return springs by their positions, from one, one for each usual position, or a mapping."""
    springs: Any = stated
    if stated is None:
        return None
    if isinstance(stated, Mapping):
        springs = [
            (at if type(at) is float else _arguments.number(at, f"FrameMember: {name}"), spring)
            for at, spring in stated.items()
        ]
    elif isinstance(stated, Spring):
        springs = [(position, stated) for position in usual]
    else:
        springs = _arguments.several(stated, f"FrameMember: {name}", "springs")
        if len(springs) == len(usual) and all(isinstance(spring, Spring) for spring in springs):
            springs = list(zip(usual, springs, strict=True))
    for item in springs:
        if not (isinstance(item, tuple) and len(item) == 2 and isinstance(item[1], Spring)):
            raise InputError(
                f"FrameMember: {name} = {_arguments.shown(stated)} must be a spring, "
                "one for each end, or a mapping from positions (0 to 1) to springs"
            )
    return tuple(sorted(springs, key=lambda item: item[0]))


@dataclass(frozen=True)
class FrameNode:
    """A node of a frame, or what a node of the grid has in addition.

    Parameters
    ----------
    name : str
        Its name; nodes of a grid are called N-line-floor, with floor 0 at the base.
    x, y : float, optional
        Place [m]; not for a node of the grid.
    floor : int, optional
        Floor that a node outside of the grid is of, from 0 at the base: the frame then has storeys.
    support : {"free", "roller", "pinned", "fixed"}, optional
        Its support: a roller along y alone, a pin along x and y.
    mass, inertia : float, optional
        Mass [kg] and rotary inertia [kg m2].
    load_x, load_y, load_moment : float, optional
        Dead load to the right and upward [N], and clockwise [N m]; a weight is a negative load_y.
    push_x, push_y : float, optional
        Shares of the lateral load with ``pattern="nodes"``.
    moves_with : str, optional
        A node whose displacement along x it shares.
    shear, axial_spring, flexure : Spring, optional
        Springs from the ground: along x, upward, and against rotation (soil, braces, bearings).
    panel : Spring, optional
        Rotational spring between the columns and the beams that meet in the node, as
        `rbsdem.frames.JointPanel.spring` has it; without it they turn as one. It is positive where
        the columns turn clockwise against the beams. Rotations of the node are those of its
        columns.
    """

    name: str
    x: float | None = None
    y: float | None = None
    support: str = ""
    mass: float = 0.0
    inertia: float = 0.0
    load_x: float = 0.0
    load_y: float = 0.0
    load_moment: float = 0.0
    push_x: float = 0.0
    push_y: float = 0.0
    moves_with: str = ""
    shear: Spring | None = None
    axial_spring: Spring | None = None
    flexure: Spring | None = None
    panel: Spring | None = None
    floor: int | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "FrameNode")
        if self.support:
            support = _arguments.choice(self.support, "FrameNode: support", _SUPPORTS)
            _arguments.put(self, support=support)

    def _groups(self, **more: str | None) -> list[Any]:
        """Return the groups of a case file; `more` are names that a building gives it."""
        values = {
            key.name: getattr(self, key.name) or None
            for key in fields(self)
            if key.name not in (*_PLACES, "panel", "x", "y", "floor")
        }
        for name in ("name", "moves_with"):
            if values[name]:
                values[name] = _core.Text(values[name])
        names = {name: _core.Text(value) if value else None for name, value in more.items()}
        node = values | {"x": self.x, "y": self.y, "floor": self.floor} | names
        place = {"node": _core.Text(self.name)}
        springs = [(group, place, getattr(self, group)) for group in _PLACES]
        springs.append(("flexure", {"panel": place["node"]}, self.panel))
        return [("node", node), *(entry for entry in springs if entry[2] is not None)]


@dataclass(frozen=True)
class Member:
    """A member between two nodes of a frame.

    Parameters
    ----------
    name, start, end : str
        Its name, and those of the nodes that it begins and ends at.
    kind : FrameMember
        What it is of.
    rigid_end : tuple of float, optional
        Rigid lengths at its beginning and at its end [m].
    load : float, optional
        Dead load downward, per length along x [N/m].
    """

    name: str
    start: str
    end: str
    kind: FrameMember
    rigid_end: tuple[float, float] = (0.0, 0.0)
    load: float = 0.0

    def __post_init__(self) -> None:
        _arguments.convert(self, "Member")

    def _group(self, kind: str, axial_of: str | None = None) -> Group:
        """Return the member as a group of a case file, with the names of its kind and of a column.

        `axial_of` is the column of another plane that has the same axial force.
        """
        values = {
            "name": _core.Text(self.name),
            "from": _core.Text(self.start),
            "to": _core.Text(self.end),
            "kind": _core.Text(kind),
            "rigid_from": float(self.rigid_end[0]) or None,
            "rigid_to": float(self.rigid_end[1]) or None,
            "load": self.load or None,
            "axial_of": _core.Text(axial_of) if axial_of else None,
        }
        return "member", values


class FrameSpring(NamedTuple):
    """A spring in a member or in the panel of a node.

    Attributes
    ----------
    member, group, rule : str
        Name of the member, or of the node; "flexure", "shear" or "axial_spring", or "panel"; name
        of its rule.
    position : float
        In shares of the clear length of the member; 0 in a panel.
    stiffness : float
        The initial one [N m/rad or N/m].
    end : str
        "start", "end", or the place between them; "" in a panel.
    """

    member: str
    group: str
    rule: str
    position: float
    stiffness: float
    end: str


class Place(NamedTuple):
    """Where a member of the grid stands.

    Attributes
    ----------
    kind : str
        "column" or "beam".
    line, storey : int
        Its line, of a beam its bay, and its storey, from 1.
    """

    kind: Literal["column", "beam"]
    line: int
    storey: int

    @property
    def name(self) -> str:
        """Name of the member."""
        return f"{'C' if self.kind == 'column' else 'B'}-{self.line}-{self.storey}"


@dataclass(frozen=True)
class FrameParts:
    """Nodes, members and springs of a frame, as it was laid out.

    Attributes
    ----------
    nodes, members : tuple of str
        Names, in the order of the columns of a result.
    x, y : ndarray, shape (nodes,)
        Places [m].
    floor : ndarray of int, shape (nodes,)
        Floor of the grid, 0 at the base; -1 for nodes that are none of it.
    ends : ndarray of int, shape (members, 2)
        Numbers of the nodes that members begin and end at, from 0.
    compression : ndarray, shape (members,)
        Axial force under the dead load, compression positive [N].
    springs : tuple of FrameSpring
        Springs of the members, in their order, then those of panels.
    mass : float
        Mass that moves along x [kg].
    node_mass : ndarray, shape (nodes,)
        Masses of the nodes, with their parts of those of the floors [kg].
    """

    nodes: tuple[str, ...]
    members: tuple[str, ...]
    x: Array
    y: Array
    floor: NDArray[np.int64]
    ends: NDArray[np.int64]
    compression: Array
    springs: tuple[FrameSpring, ...]
    mass: float
    node_mass: Array

    def springs_of(self, group: str) -> list[FrameSpring]:
        """Return the springs of a group, as the columns of a result hold them.

        Panels rotate: they follow those of "flexure".
        """
        groups = (group, "panel") if group == "flexure" else (group,)
        return [spring for spring in self.springs if spring.group in groups]


@dataclass(frozen=True)
class MemberGeometry:
    """Where a member is, between the rigid lengths at its nodes.

    Attributes
    ----------
    name : str
        Its name.
    start, end : int
        Numbers of its nodes, from 0.
    axis : ndarray, shape (2,)
        Direction from its start to its end.
    rigid : tuple of float
        Rigid lengths at its start and at its end [m].
    clear : float
        Clear length between them [m].
    foot : ndarray, shape (2,)
        Where the clear length begins [m].
    load : float
        Dead load on it, downward, per length along x [N/m].
    """

    name: str
    start: int
    end: int
    axis: Array
    rigid: tuple[float, float]
    clear: float
    foot: Array
    load: float

    @cached_property
    def normal(self) -> Array:
        """To the right of one who goes from its start to its end: a clockwise turn from `axis`."""
        return np.array([self.axis[1], -self.axis[0]])

    @property
    def upright(self) -> bool:
        """Whether it is rather a column than a beam."""
        return bool(abs(self.axis[1]) > abs(self.axis[0]))

    @property
    def across_load(self) -> float:
        """Its load along `normal`, per clear length [N/m]."""
        return self.load * float(abs(self.axis[0]) * self.axis[0])

    @property
    def hung(self) -> float:
        """Four times the moment of its load in the middle, as between hinges at the ends [N m]."""
        return 0.5 * self.across_load * self.clear**2

    def moment(self, first: ArrayLike, last: ArrayLike, shares: ArrayLike) -> Array:
        """Return moments along the clear length, positive with tension on the side of `normal`.

        `first` and `last` are the moments of its ends, clockwise on the member [N m]; `shares` are
        positions from 0 to 1.
        """
        start, end = np.asarray(first, float), np.asarray(last, float)
        at = np.asarray(shares, float)
        return np.asarray(start * (1 - at) - end * at + self.hung * at * (1 - at))

    def shear(self, first: ArrayLike, last: ArrayLike, shares: ArrayLike) -> Array:
        """Return shear forces along the clear length: the loss of moment per length [N]."""
        s, sway = np.asarray(shares, float), (np.asarray(first) + np.asarray(last)) / self.clear
        return np.asarray(sway + self.across_load * self.clear * (s - 0.5))


def places_of(pair: Any, name: str, *lines: int) -> list[Any]:
    """Return the places of a grid that a key names: line or bay, and storey or floor, 0 for all.

    Parameters
    ----------
    pair : tuple
        Numbers or tuples of numbers; all but the last may be "outer" or "inner".
    name : str
        Of the argument, for messages.
    lines : int
        Number of lines or bays; of a grid in plan there are two.
    """
    if not (isinstance(pair, tuple) and len(pair) == len(lines) + 1):
        what = "a pair (line or bay, storey)" if len(lines) == 1 else "three numbers"
        raise InputError(f"frame: {name}: {_arguments.shown(pair)} must be {what}")
    numbers = []
    for word, most in zip(pair, (*lines, 0), strict=True):
        if isinstance(word, str):
            if word not in (_SIDES if most else ()):
                raise InputError(
                    f"frame: {name}: {word!r} is not known; a pair has numbers, 0 for all, tuples "
                    'of numbers, and for lines and bays "outer" or "inner"'
                )
            outer = list(dict.fromkeys((1, most)))
            numbers.append(outer if word == "outer" else list(range(2, most)))
        else:
            several = word if isinstance(word, (tuple, range)) else (word,)
            numbers.append(
                [
                    number if type(number) is int else _arguments.integer(number, f"frame: {name}")
                    for number in several
                ]
            )
    return [place[::-1] for place in product(*numbers[::-1])]


def rules_of(
    cells: Mapping[tuple[int, int], Any], at: str, level: str, lines: int
) -> list[tuple[dict[str, Any], Any]]:
    """Return the keys of places and what stands there, in the words of `places_of` where they fit.

    Parameters
    ----------
    cells : mapping
        By line or bay and storey or floor, 0 for all.
    at, level : str
        Names of the keys: "line" or "bay", "storey" or "floor".
    lines : int
        Number of lines or bays.
    """
    sides = {"outer": [1, lines], "inner": list(range(2, lines))}
    sides = {word: numbers for word, numbers in sides.items() if len(set(numbers)) > 1}
    items, rules = list(cells.items()), []
    while items:
        (line, storey), cell = items[0]
        place: dict[str, Any] = {at: line or None, level: storey or None}
        count = 1
        for word, numbers in sides.items():
            following = items[: len(numbers)]
            places = [(number, storey) for number in numbers]
            if [pair for pair, _ in following] == places and all(
                other is cell or (isinstance(cell, float) and other == cell)
                for _, other in following
            ):
                place, count = {f"{at}s": word, level: storey or None}, len(numbers)
        rules.append((place, cell))
        del items[:count]
    return rules


def at_place(cells: Mapping[Any, Any], *place: int) -> Any:
    """Return what stands in a place of a grid: the last cell that fits, None without one."""
    kinds = [
        kind
        for key, kind in cells.items()
        if all(at in (0, i) for at, i in zip(key, place, strict=True))
    ]
    return kinds[-1] if kinds else None


def cells_of(
    drawn: Any, name: str, kind: type, *lines: int, halves: type | None = None
) -> dict[Any, Any]:
    """Return the cells of a grid by line or bay and storey, 0 for all, in their order.

    A cell is an instance of `kind` or of `halves`, or a tuple of two instances of `halves`.
    """
    article = "an" if kind.__name__ == "Infill" else "a"
    kinds = f"{article} {kind.__name__}"
    if halves is not None:
        kinds = f"a {halves.__name__}, a pair of them, {kinds}"
    items = drawn.items() if isinstance(drawn, Mapping) else [((0,) * (len(lines) + 1), drawn)]
    by_place: dict[Any, Any] = {}
    for pair, cell in () if drawn is None else items:
        places = places_of(pair, name, *lines)
        paired = halves is not None and isinstance(cell, (tuple, list)) and len(cell) == 2
        parts = tuple(cell) if paired else (cell,)
        if cell is not None and not (
            isinstance(cell, kind) or (halves and all(isinstance(part, halves) for part in parts))
        ):
            pairs = "pairs (line or bay, storey)" if len(lines) == 1 else "three numbers"
            raise InputError(
                f"frame: {name} = {_arguments.shown(cell)} must be {kinds}, or a mapping from "
                f"{pairs}, 0 for all, to these"
            )
        for place in places:
            by_place.pop(place, None)
            by_place[place] = parts if paired else cell
    return by_place


def check_places(
    cells: Iterable[tuple[int, ...]], name: str, words: Sequence[str], most: Sequence[int]
) -> None:
    """Refuse places that a grid does not have.

    `words` name the numbers of a place, `most` are the largest ones; 0 stands for all.
    """
    for place in cells:
        for word, at, last in zip(words, place, most, strict=True):
            if not 0 <= at <= last:
                raise InputError(
                    f"frame: {name}: {word} = {at}, but there are {last}; correct it, or give 0 "
                    "for all"
                )


def index_of(name: str, names: tuple[str, ...], what: str) -> int:
    """Return the number of a node or member, from 0."""
    if name not in names:
        import difflib  # noqa: PLC0415

        near = difflib.get_close_matches(str(name), names, 1, 0.0)
        raise InputError(
            f"{what} = {_arguments.shown(name)} is not of this frame; did you mean {near[0]!r}?"
        )
    return names.index(name)


#: A kind of members as a case file has it: its name, and itself without its rigid lengths, as like
#: members may end in nodes of different sizes.
NamedKind = tuple[str, FrameMember]


def stated(kind: FrameMember) -> NamedKind:
    """Return a kind of members as a case file has it."""
    return kind.name, with_rigid_end(kind, 0.0)


def names_of(kinds: Iterable[FrameMember]) -> dict[NamedKind, str]:
    """Return the names of kinds of members, made up where there is none."""
    # Most members of a grid are of one and the same object, and to hash a kind takes long.
    different = {id(kind): kind for kind in kinds}.values()
    names = dict.fromkeys(map(stated, different), "")
    taken = {name for name, _ in names}
    for number, statement in enumerate(names, 1):
        numbers = (f"kind-{i}" for i in count(number))
        names[statement] = statement[0] or next(one for one in numbers if one not in taken)
        taken.add(names[statement])
    return names


def groups_of_kinds(
    names: Mapping[NamedKind, str], drawn: Mapping[Any, dict[str, Any]]
) -> list[Group | _core.Statement]:
    """Return the groups of kinds of members, under their names, with those of `drawn` sections."""
    kinds = [(kind, name) for (_, kind), name in names.items()]
    return placed([entry for kind, name in kinds for entry in kind._groups(name, drawn)])


def groups_of_cells(
    group: str,
    places: Iterable[tuple[dict[str, Any], Any]],
    names: Mapping[NamedKind, str],
    drawn: Mapping[Any, dict[str, Any]],
) -> list[Group]:
    """Return the groups of what stands in the places of a grid.

    Parameters
    ----------
    group : {"column_of", "beam_of"}
        Its name.
    places : iterable
        Keys of each place, and the kind of members or drawing there.
    names : mapping
        Names of the kinds.
    drawn : mapping
        Keys that name the drawings of the other cells.
    """
    groups: list[Group] = []
    kinds: dict[int, str] = {}
    for place, cell in places:
        if isinstance(cell, FrameMember):
            if id(cell) not in kinds:
                kinds[id(cell)] = names[stated(cell)]
            kind = {"kind": _core.Text(kinds[id(cell)])} | rigid_lengths(cell.rigid_end)
        else:
            kind = drawn[cell] if cell is not None else {"kind": _core.Text("none")}
        groups.append((group, place | kind))
    return groups


def rigid_lengths(rigid_end: float | tuple[float, float]) -> dict[str, float | None]:
    """Return the keys of rigid lengths in nodes."""
    if isinstance(rigid_end, tuple):
        return {"rigid_from": rigid_end[0], "rigid_to": rigid_end[1]}
    return {"rigid_end": rigid_end or None}


def with_rigid_end(kind: FrameMember, rigid_end: float | tuple[float, float]) -> FrameMember:
    """Return a kind of members with other rigid lengths in its nodes."""
    if kind.rigid_end == rigid_end:
        return kind
    # Its other fields are checked already.
    other = copy(kind)
    _arguments.put(other, rigid_end=rigid_end)
    return other
