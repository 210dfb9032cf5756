"""Buildings: planar frames and walls on floors that are rigid in plan."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.model.column import Damping
from rbsdem.model.frame import (
    FrameMember,
    FrameNode,
    Member,
    groups_of_kinds,
    index_of,
    names_of,
    stated,
    with_rigid_end,
)
from rbsdem.model.materials import Ties
from rbsdem.model.springs import Group, placed
from rbsdem.section.frame import SCOPE_NOTE, Frame
from rbsdem.section.plan_grid import PlanDrawing, by_floor

#: Places in plan that are nearer than this are one [m].
_ONE_PLACE = 1e-3
#: Frames whose angles differ by less than this are along one line [degrees].
_ONE_LINE = 1e-6
#: Columns of two planes are one if their E A differ by less than this share: where joints of layers
#: close they depend on M/V, which differs from plane to plane.
_SAME = 0.1

#: Local names that are no arguments of a building or of its drawing.
_NO_KEYWORDS = ("cls", "self", "more", "__class__")

#: Scope of the results of a building, printed with them.
PLAN_NOTE = (
    "Floors are rigid in plan, and members do not resist torsion. A column in two planes has one "
    "axial force, and its planar hinges do not know of each other: on a diagonal they carry 1.2 to "
    "1.7 times what the column does. It does not lose its axial load, whatever its drift."
)


def cosine_sine(degrees: float) -> tuple[float, float]:
    """Return cosine and sine of an angle in degrees, exact at quarters of a turn."""
    quarters, rest = divmod(degrees % 360.0, 90.0)
    cosine, sine = float(np.cos(np.radians(rest))), float(np.sin(np.radians(rest)))
    for _ in range(int(quarters)):
        cosine, sine = -sine, cosine
    return cosine, sine


@dataclass(frozen=True)
class Plane:
    """A planar frame in a building.

    Attributes
    ----------
    name : str
        Its name; nodes and members are called name:N-1-1 and so on.
    frame : Frame
        The frame.
    angle : float
        Direction of its x axis in plan, from x towards y [degrees].
    arm : float
        Distance of this axis from the origin in plan, positive where a counterclockwise turn moves
        it forward: -y of a frame along x, x of one along y [m].
    along : float or None
        Where its x axis begins, from the foot of the perpendicular of the origin: x of a frame
        along x, y of one along y [m]. Without it no column of it is one of another frame.
    """

    name: str
    frame: Frame
    angle: float
    arm: float
    along: float | None = None

    @property
    def direction(self) -> tuple[float, float]:
        """Cosine and sine of its angle."""
        return cosine_sine(self.angle)

    def places(self, x: ArrayLike) -> Array:
        """Return the places in plan of points of the frame, shape (points, 2) [m].

        Without `along` those of the axis at the foot of the perpendicular.
        """
        cosine, sine = self.direction
        s = np.asarray(x, float) + self.along if self.along is not None else 0.0 * np.asarray(x)
        return np.column_stack((s * cosine + self.arm * sine, s * sine - self.arm * cosine))


class Building(Frame):
    """Planar frames and walls that stand in plan and share rigid floors.

    Every floor moves along x and y and turns about its centre of mass; each frame follows in its
    plane. Frames are planar as everywhere, with all of their members and springs. A column where
    two of them cross is one column: its nodes rise together, it has one axial force, and springs of
    both planes. Names of nodes and members have that of the frame before them: x-1:C-2-1.

    Parameters
    ----------
    frames : sequence of tuple
        (frame, angle, arm) or (frame, angle, arm, along), see `Plane`. The masses of its nodes and
        floors move in both directions. Dead loads, masses, springs and losses are those of each
        frame; kinematics, base damping and patterns those of the building.
    names : sequence of str, optional
        Names of the frames; by default x-1, x-2, ... for frames along x, y-1, ... for those along
        y, and frame-1, ... for others.
    centres : pair of float, or sequence of pairs, optional
        Centre of mass of all floors, or of each, in plan [m]; the origin by default.
    floor_mass : float or sequence of float, optional
        Masses of the floors at their centres besides those of the frames [kg]; they do not move
        upward.
    inertia : float or sequence of float, optional
        Rotary inertia of all floors, or of each, about its centre [kg m2]. Without it that of the
        masses of the frames where they stand: of frames without `along` on the line of the frame.
    kinematics, pattern, collapse, damping
        As of `rbsdem.Frame`; shares by mass act at the centres of mass, and the largest drift of a
        storey is that of any frame.
    direction : float, optional
        Of the lateral load, from x towards y [degrees].
    control_node : str, optional
        A node whose displacement in its plane is that of the top; by default it is that of the
        centre of the roof along `direction`.
    plan : PlanDrawing, optional
        What it was drawn from; `grid` gives it.

    Raises
    ------
    InputError
        With a line for everything that is wrong: floors that no frame keeps from turning, columns
        of three frames, names.
    """

    #: Frames in their places; centres of mass, masses and rotary inertia of the floors; nodes that
    #: rise with one of another frame, and columns that are one of another, by their names.
    planes: tuple[Plane, ...]
    direction: float
    centres: Array
    plan_mass: Array
    inertia: Array
    rises: dict[str, str]
    axial_of: dict[str, str]
    #: What it was drawn from; `grid` gives it.
    plan: PlanDrawing | None
    _given: dict[str, Any]

    def __init__(
        self,
        frames: Sequence[tuple[Any, ...]],
        *,
        names: Sequence[str] | None = None,
        centres: ArrayLike = (0.0, 0.0),
        floor_mass: ArrayLike = 0.0,
        inertia: ArrayLike | None = None,
        kinematics: Literal["small", "pdelta"] = "small",
        pattern: Literal["triangular", "uniform", "modal", "nodes"] = "triangular",
        direction: float = 0.0,
        collapse: Literal["storey", "roof"] = "storey",
        damping: Damping | float | None = None,
        control_node: str = "",
        plan: PlanDrawing | None = None,
    ) -> None:
        keywords = {name: value for name, value in locals().items() if name not in _NO_KEYWORDS}
        form = "tuples (frame, angle, arm)"
        keywords["frames"] = tuple(_arguments.several(frames, "building: frames", form))
        planes = _planes(keywords["frames"], names)
        floors = max(int(plane.frame.parts.floor.max(initial=0)) for plane in planes)
        if floors == 0:
            raise InputError(
                "building: its frames have no floors; give them grids, or their nodes floors "
                "(FrameNode(floor=...))"
            )
        laid = [_laid(plane) for plane in planes]
        rises, axial = _shared(planes, laid)
        _arguments.put(
            self,
            _given=keywords,
            planes=planes,
            plan=plan,
            direction=_arguments.number(direction, "building: direction"),
            centres=by_floor(centres, floors, "centres", 2),
            plan_mass=by_floor(floor_mass, floors, "floor_mass")[:, 0],
            rises=rises,
            axial_of=axial,
        )
        turning = _inertia_of(planes, self.centres) if inertia is None else inertia
        _arguments.put(self, inertia=by_floor(turning, floors, "inertia")[:, 0])
        shared = {*axial, *axial.values()}
        super().__init__(
            kinematics=kinematics,
            pattern=pattern,
            collapse=collapse,
            control_node=control_node,
            nodes=[node for nodes, _ in laid for node in nodes],
            members=[
                replace(member, kind=_held_up(member.kind)) if member.name in shared else member
                for _, members in laid
                for member in members
            ],
            damping=damping,
            losses={
                f"{plane.name}:{member}": time
                for plane in planes
                for member, time in (plane.frame.losses or {}).items()
            }
            or None,
        )

    def __repr__(self) -> str:
        names = ", ".join(plane.name for plane in self.planes)
        return f"Building({len(self.storey_heights)} storeys, frames {names})"

    def __eq__(self, other: object) -> bool:
        """Return whether another building has the same members, frames in place, and floors."""
        if not isinstance(other, Building) or self._in_plan() != other._in_plan():
            return False
        return super().__eq__(other) is True

    __hash__ = Frame.__hash__

    def __reduce__(self) -> tuple[Any, ...]:
        return partial(type(self), **self._given), ()

    @classmethod
    def grid(  # type: ignore[override]
        cls,
        storeys: ArrayLike,
        bays_x: ArrayLike,
        bays_y: ArrayLike,
        *,
        columns: Any,
        beams_x: Any = None,
        beams_y: Any = None,
        walls: Mapping[tuple[str, int, int], Any] | None = None,
        infills_x: Any = None,
        infills_y: Any = None,
        floor_load: ArrayLike = 0.0,
        live_load: ArrayLike = 0.0,
        live_share: float = 0.3,
        edge_load: ArrayLike = 0.0,
        self_weight: bool = False,
        mass: Literal["from_loads"] | None = None,
        floor_mass: ArrayLike | None = None,
        eccentricity: ArrayLike = (0.0, 0.0),
        ends: float | Literal["asce"] | None = None,
        panel_hoops: Ties | Literal["none"] | None = None,
        base: Literal["fixed", "pinned"] = "fixed",
        **more: Any,
    ) -> Building:
        """Return a building of a grid in plan, with a frame on each line: x-1, ..., y-1, ...

        Lines along x are numbered from y = 0, those along y from x = 0; the places of a line are
        the lines that cross it. Each frame is one of `rbsdem.Frame.grid`; columns of sections stand
        under the axial load that the elastic building gives them.

        Parameters
        ----------
        storeys, bays_x, bays_y : sequence of float
            Heights, and widths between axes along x and y [m].
        columns : Section, pair of Section, FrameMember, or mapping
            One for all, or by (line across x, line across y, storey), with the rules of
            `rbsdem.Frame.grid`; None: there is no column. There is no panel at a corner where
            nothing stands, as in an L or where floors step back. The depth of a section is along x;
            along y it bends as `section.turned`. A `FrameMember` is the same in both planes.
        beams_x, beams_y : Section, pair of Section, FrameMember, or mapping
            Beams along x and along y: one for all, or by (bay, line, storey).
        walls : mapping, optional
            Walls in place of columns by (direction, line, place): ("x", 2, 1) lies along x on the
            second line, at its first place. A section for all storeys, or one for each. Across its
            plane a wall is a post between two pins.
        infills_x, infills_y : Infill or mapping, optional
            Masonry below the beams, by (bay, line, storey).
        floor_load, live_load : float or sequence of float, optional
            On the panels of all floors, or of each [N/m2]. Yield lines that bisect the corners lead
            it to the beams, on which the triangle or trapezoid is the equal uniform load; a side
            without a beam leaves its part to the others.
        live_share : float, optional
            Part of the live load that acts.
        edge_load : float or sequence of float, optional
            Weight of facades on beams with a panel on one side, of all floors or of each [N/m].
        self_weight : bool, optional
            Whether members of sections have their own weight, 25 kN/m3, besides that of the floors.
        mass : "from_loads", optional
            Masses of the floors are those of the loads, with their centres and rotary inertia.
        floor_mass : float or sequence of float, optional
            Masses of the floors in place of these, spread as the loads, or evenly without loads
            [kg].
        eccentricity : pair of float, optional
            How far the centres of mass are moved along x and y, in parts of the lengths of the
            building: 0.05 is the accidental eccentricity of EN 1998-1.
        ends, panel_hoops, base
            As of `rbsdem.Frame.grid`.
        **more
            `kinematics`, `pattern`, `direction`, `collapse`, `damping` and `control_node` of the
            building.

        Raises
        ------
        InputError
            With what is wrong and where.
        """
        drawing = {name: value for name, value in locals().items() if name not in _NO_KEYWORDS}
        building: Building = PlanDrawing.checked(**drawing).building(cls, more)
        return building

    def changed(self, **changes: Any) -> Building:
        """Return the building with other parameters in place of some of its own."""
        # A drawing does not have these: it is dropped.
        drawn = {"frames", "names", "centres", "floor_mass", "inertia"}.isdisjoint(changes)
        return type(self)(**self._given | ({} if drawn else {"plan": None}) | changes)

    @property
    def scope_note(self) -> str:
        """Scope of results of the building, printed with them."""
        return f"{SCOPE_NOTE} {PLAN_NOTE}"

    def plane(self, name: str) -> Plane:
        """Return a frame in its place, by its name."""
        names = tuple(plane.name for plane in self.planes)
        return self.planes[index_of(name, names, "frame")]

    def corners(self, floor: int) -> Array:
        """Return corners of a floor in plan, shape (corners, 2) [m].

        Ends of its frames, or where a frame has no `along` those of the smallest rectangle.
        """
        ends = []
        for plane in self.planes:
            x = plane.frame.parts.x[plane.frame.parts.floor == floor]
            if x.size:
                ends.append(plane.places([x.min(), x.max()]))
        places: Array = np.unique(np.round(np.vstack(ends), 9), axis=0)
        if all(plane.along is not None for plane in self.planes):
            return places
        (west, south), (east, north) = places.min(axis=0), places.max(axis=0)
        return np.array([(west, south), (east, south), (east, north), (west, north)])

    def frame_of(self, name: str) -> Frame:
        """Return a frame as it stands in the building: with the axial forces and kinds there."""
        known: dict[str, Frame] = vars(self).setdefault("_frames", {})
        if name in known:
            return known[name]
        frame, prefix = self.plane(name).frame, f"{name}:"
        of_all = dict(zip(self.parts.members, self.parts.compression.tolist(), strict=True))
        compression = np.array([of_all[prefix + member] for member in frame.parts.members])
        # Cached properties of the copy are set to what they are in the building.
        inside = copy(frame)
        _arguments.put(inside, kinematics=self.kinematics)
        vars(inside)["parts"] = replace(frame.parts, compression=compression, mass=self.parts.mass)
        vars(inside)["geometry"] = frame.geometry
        # A frame may end below the top of the building.
        heights = self.storey_heights[: int(frame.parts.floor.max())]
        vars(inside)["storey_heights"] = heights
        vars(inside)["kinds"] = {
            member: with_rigid_end(self.kinds[prefix + member], kind.rigid_end)
            for member, kind in frame.kinds.items()
        }
        return known.setdefault(name, inside)

    def _state(self, *cells: Any, drawn: Any = None, **more: Any) -> _core.Statement:
        """Return the groups of a case file, with the drawings of kinds if they are given."""
        parts = self._in_plan()
        names = names_of([member.kind for member in self.members])
        parts += groups_of_kinds(names, drawn or {})
        for node in self.nodes:
            at = node.name.split(":")[0]
            parts += placed(node._groups(plane=at, rises_with=self.rises.get(node.name)))
        for member in self.members:
            name = names[stated(member.kind)]
            parts.append(member._group(name, axial_of=self.axial_of.get(member.name)))
        parts += self.loss_groups()
        if isinstance(self.damping, Damping):
            parts.append(self.damping.statement())
        return _core.joined(parts)

    def _in_plan(self) -> list[_core.Statement | Group]:
        """Return the groups of the building, of its frames in place, and of its floors."""
        parts: list[_core.Statement | Group] = [("frame", self._settings())]
        for plane in self.planes:
            values = {"angle": plane.angle or None, "arm": plane.arm or None, "along": plane.along}
            parts.append(("plane", {"name": _core.Text(plane.name)} | values))
        of_floors = np.column_stack((self.plan_mass, self.inertia, self.centres)).tolist()
        keys = "mass", "inertia", "centre_x", "centre_y"
        for i, values in enumerate(of_floors, 1):
            numbers = {k: v or None for k, v in zip(keys, values, strict=True)}
            parts.append(("floor", {"floor": i, **numbers}))
        return parts

    def _settings(self) -> dict[str, Any]:
        """Return the keys of the building in `&frame`."""
        return {
            "kinematics": None if self.kinematics == "small" else self.kinematics,
            "pattern": None if self.pattern == "triangular" else self.pattern,
            "collapse": None if self.collapse == "storey" else self.collapse,
            "control_node": _core.Text(self.control_node) if self.control_node else None,
            "direction": self.direction or None,
        }

    def _groups(self) -> _core.Statement:
        """Return the groups of a case file, with the drawing in place of springs."""
        if self.plan is None:
            return super()._groups()
        statement = self.plan.groups(self._settings())
        if isinstance(self.damping, Damping):
            statement += self.damping.statement()
        return statement

    def with_kinds(self, kinds: Mapping[str, FrameMember]) -> Building:
        """Return the building with other kinds of members in place of some of `named_kinds`."""
        names = {(kind.name, kind): name for name, kind in self.named_kinds.items()}

        def changed(plane: Plane) -> Frame:
            """Return the frame of a plane with its share of the other kinds."""
            of_frame = {
                name: kinds[names[each]]
                for name, kind in plane.frame.named_kinds.items()
                for each in (stated(_held_up(kind)), stated(kind))
                if names.get(each) in kinds
            }
            return plane.frame.with_kinds(of_frame)

        return self._with_frames(changed)

    def without(self, *members: str) -> Building:
        """Return the building after the loss of members, named as "x-1:C-2-1"."""
        lost: dict[str, list[str]] = {}
        for member in members:
            index_of(member, self.parts.members, "member")
            lost.setdefault(member.split(":")[0], []).append(member.split(":")[1])
        return self._with_frames(lambda plane: plane.frame.without(*lost.get(plane.name, ())))

    def _with_frames(self, change: Callable[[Plane], Frame]) -> Building:
        """Return the building with what `change` makes of each frame in the place of the frame."""
        places = [tuple(place)[1:] for place in self._given["frames"]]
        frames = [(change(one), *at) for one, at in zip(self.planes, places, strict=True)]
        return self.changed(frames=frames)


def _planes(frames: Any, names: Sequence[str] | None) -> tuple[Plane, ...]:
    """Return the frames in their places, with names."""
    planes: list[Plane] = []
    if not frames:
        raise InputError("building: it has no frames; give tuples (frame, angle, arm)")
    if names is not None and len(names) != len(frames):
        raise InputError(
            f"building: {len(names)} names for {len(frames)} frames; give one for each"
        )
    counts: dict[str, int] = {}
    for i, place in enumerate(frames):
        is_place = isinstance(place, tuple) and len(place) in (3, 4)
        if not is_place or not isinstance(place[0], Frame) or isinstance(place[0], Building):
            raise InputError(
                f"building: frames[{i}] = {_arguments.shown(place)} must be a tuple "
                "(frame, angle, arm), or (frame, angle, arm, along) with the begin of its axis"
            )
        numbers = _arguments.finite_vector(place[1:], f"building: frames[{i}]").tolist()
        frame: Frame = place[0]
        if frame.damped:
            raise InputError(
                f"building: frames[{i}] has damping of its own; give it to the building"
            )
        letter = {0.0: "x", 90.0: "y"}.get(numbers[0] % 180.0, "frame")
        counts[letter] = counts.get(letter, 0) + 1
        name = str(names[i]) if names is not None else f"{letter}-{counts[letter]}"
        if ":" in name or not name or name in [plane.name for plane in planes]:
            raise InputError(
                f"building: {name!r} is no name of a frame of its own; names differ and have "
                "no colon"
            )
        planes.append(Plane(name, frame, *numbers))
    return tuple(planes)


def _laid(plane: Plane) -> tuple[list[FrameNode], list[Member]]:
    """Return the nodes and members of a frame in a building."""
    frame, parts, prefix = plane.frame, plane.frame.parts, f"{plane.name}:"
    stated_nodes = {node.name: node for node in frame.nodes}
    panels = {spring.member for spring in parts.springs if spring.group == "panel"}
    nodes = []
    for i in np.unique(parts.ends).tolist():
        name, floor = parts.nodes[i], int(parts.floor[i])
        node = stated_nodes.get(name, FrameNode(name))
        support = frame.supports.get(name, "free")
        if node.moves_with and not floor > 0:
            raise InputError(
                f"building: node {prefix}{name}: moves_with is of a planar frame; in a building "
                "nodes of a floor move with it"
            )
        nodes.append(
            replace(
                node,
                name=prefix + name,
                x=float(parts.x[i]),
                y=float(parts.y[i]),
                floor=floor if floor >= 0 else None,
                support="free" if support == "springs" else support,
                mass=float(parts.node_mass[i]),
                panel=(node.panel or frame.panel) if name in panels else None,
                moves_with="",
            )
        )
    members = [
        Member(
            prefix + name,
            prefix + parts.nodes[where.start],
            prefix + parts.nodes[where.end],
            with_rigid_end(frame.kinds[name], 0.0),
            where.rigid,
            where.load,
        )
        for name, where in frame.geometry.items()
    ]
    return nodes, members


def _inertia_of(planes: Sequence[Plane], centres: Array) -> Array:
    """Return the rotary inertia of the masses of frames about the centres of the floors."""
    inertia = np.zeros(len(centres))
    for plane in planes:
        parts, axis = plane.frame.parts, np.array(plane.direction)
        at = parts.floor > 0
        floor = parts.floor[at] - 1
        away = plane.places(parts.x[at]) - centres[floor]
        if plane.along is None:
            # The place on the line is not known: only the distance of the line counts.
            away = away - np.outer(away @ axis, axis)
        np.add.at(inertia, floor, parts.node_mass[at] * (away**2).sum(axis=1))
    return inertia


def _shared(planes: Sequence[Plane], laid: Sequence[Any]) -> tuple[dict[str, str], dict[str, str]]:
    """Return what planes share where they cross, by names of a later plane and of an earlier one.

    Nodes at one place rise together, and members between them are one column with one axial force.
    """
    rises: dict[str, str] = {}
    axial: dict[str, str] = {}
    first: dict[tuple[float, ...], FrameNode] = {}
    columns: dict[tuple[float, ...], list[tuple[float, float, Plane, Member]]] = {}
    supports = ("fixed", "pinned", "roller")
    # Walls and columns come before the posts, which stand for walls across the plane, so that the
    # axial force is that of the wall.
    for across, plane, (nodes, members) in (
        (across, *pair) for across in (False, True) for pair in zip(planes, laid, strict=True)
    ):
        if plane.along is None:
            continue
        place_of = {node.name: round((node.x or 0.0) / _ONE_PLACE) for node in nodes}
        upright = [
            member
            for member in members
            if place_of[member.start] == place_of[member.end] and not member.kind.after_dead_load
        ]
        posts = {place_of[member.start] for member in upright if member.kind.ends == "pinned"}
        at: dict[str, tuple[float, ...]] = {}
        for node, place in zip(nodes, plane.places([node.x for node in nodes]), strict=True):
            if (place_of[node.name] in posts) is not across:
                continue
            at[node.name] = tuple(np.round(np.array([*place, node.y]) / _ONE_PLACE).tolist())
            leader = first.setdefault(at[node.name], node)
            if leader is not node and not (node.support in supports and leader.support in supports):
                rises[node.name] = leader.name
        for member in upright:
            if member.start not in at:
                continue
            low, high = sorted(at[name][2] for name in (member.start, member.end))
            others = columns.setdefault(at[member.start][:2], [])
            for foot, head, other_plane, other in others:
                if other_plane is plane or foot >= high or head <= low:
                    continue
                _check_one_column(
                    (plane, member), (other_plane, other), (low, high) == (foot, head)
                )
                if other.name in axial.values() or member.name in axial:
                    raise InputError(
                        f"building: column {member.name} is one of three planes, with {other.name};"
                        " a column has two"
                    )
                axial[member.name] = other.name
            others.append((low, high, plane, member))
    return rises, axial


def _check_one_column(one: tuple[Plane, Member], two: tuple[Plane, Member], alike: bool) -> None:
    """Refuse members of two planes at one place that are not one column."""
    (plane, member), (other_plane, other) = one, two
    stiff = [column.kind.modulus * column.kind.area for column in (member, other)]
    is_post = (member.kind.ends == "pinned") != (other.kind.ends == "pinned")
    fault = ""
    if not alike:
        fault = "they end at different heights; give both frames the same nodes there"
    elif abs((plane.angle - other_plane.angle + 90.0) % 180.0 - 90.0) < _ONE_LINE:
        fault = "their frames are along one direction, in which a column bends once; leave one out"
    elif abs(stiff[0] - stiff[1]) > _SAME * max(stiff) and not is_post:
        fault = (
            f"their E A are {stiff[1]:.4g} and {stiff[0]:.4g} N; give both the same section, or "
            "move one of the frames"
        )
    if fault:
        raise InputError(
            f"building: columns {other.name} and {member.name} are at one place, and {fault}"
        )


def _held_up(kind: FrameMember) -> FrameMember:
    """Return a kind that, as that of a column of two planes, does not lose its axial load."""
    if kind.failure_drift is None:
        return kind
    return replace(kind, failure_drift=None, failure_load=None, shear_drift=None)
