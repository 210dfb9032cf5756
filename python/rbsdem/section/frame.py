"""Planar frames: columns and beams as one assembly of bodies and springs."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import count
from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._types import Array, ArrayLike, Self
from rbsdem.errors import InputError, each_told_once, warn
from rbsdem.model.column import NOTES_ON, Column, Damping, checked_column
from rbsdem.model.frame import (
    FrameMember,
    FrameNode,
    FrameParts,
    FrameSpring,
    Member,
    MemberGeometry,
    Place,
    at_place,
    cells_of,
    groups_of_cells,
    groups_of_kinds,
    index_of,
    names_of,
    rules_of,
    stated,
    with_rigid_end,
)
from rbsdem.model.materials import Ties
from rbsdem.model.shape import Section
from rbsdem.model.springs import Group, Landmark, Layered, Spring, placed
from rbsdem.model.wall import WallSection
from rbsdem.section.grid import (
    Cells,
    FrameDrawing,
    Grid,
    cells_of_walls,
    halves_of,
    infill_groups,
    is_drawn,
    loads_by_floor,
    loads_of_beams,
    loads_of_nodes,
    spans_of_walls,
    told_of_small,
)
from rbsdem.section.infill import INFILL_NOTE, Infill, InfilledBay
from rbsdem.section.parameters import VERSION

_ENDS = {0.0: "start", 1.0: "end"}

#: Scope of the results of a frame, printed with them.
SCOPE_NOTE = (
    "The frame is computed from the properties of its members. Predicted columns carry the error "
    "that tests gave; beams, nodes and slabs are computed, and no frame was fitted."
)


@dataclass(frozen=True, repr=False)
class Frame:
    """A planar frame: a grid of storeys and bays, single nodes and members, or both.

    Nodes of the grid are called N-line-floor (N-2-1: second line of columns, first floor; floor 0
    is the base), columns C-line-storey, beams B-bay-storey.

    Parameters
    ----------
    storeys, bays : sequence of float, optional
        Heights of the storeys from the ground up and widths of the bays from the left [m]. Without
        bays there is one line of columns.
    columns, beams : FrameMember or mapping, optional
        Kinds of the columns and beams of the grid: one for all, or a mapping from (line, storey) or
        (bay, storey) to a kind, where the last pair that fits counts: numbers, tuples of them, 0
        for all, and for lines and bays "outer" or "inner". None: there is no member.
    floor_mass : float or sequence of float, optional
        Mass of each floor, shared by its nodes as the widths beside them [kg]. Its weight acts as
        far as it is given as a load.
    beam_load : float or sequence, optional
        Dead load on the beams of each floor, or in it of each bay, downward [N/m].
    kinematics : {"small", "pdelta"}, optional
        Small rotations, or the same with the second-order work of the axial forces under the dead
        load, which do not change along a path.
    base : {"fixed", "pinned", "free"}, optional
        How the columns of the grid stand; "free" with springs from the ground.
    diaphragm : bool, optional
        Whether all nodes of a floor of the grid move alike along x.
    pattern : {"triangular", "uniform", "modal", "nodes"}, optional
        Shares of the lateral load: as mass times height, as mass, as the first mode, adding up to
        1; or `push_x` and `push_y` of the nodes. Where no mass is given all nodes count alike.
    control_node, control : str, optional
        Node and direction ("x" or "y") whose displacement is that of the top; without it the first
        node of the highest. Pushes to both sides are mirrored with it at the middle of the roof, or
        with a diaphragm.
    collapse : {"storey", "roof"}, optional
        Whose drift `collapse_drift` of an analysis is: the largest of the storeys of the grid, or
        that of the top over the height.
    nodes : sequence of FrameNode, optional
        Nodes, or what nodes of the grid have in addition.
    members : sequence of Member, optional
        Members between nodes.
    damping : Damping or float, optional
        In proportion to mass and to the stiffness of the members, or ratios of the modes under the
        dead load; a number is the ratio of all.
    panel : Spring, optional
        Rotational spring in every node where columns and beams meet, between them; nodes may have
        one of their own.
    losses : mapping of str to float, optional
        Members that are lost during a response in time, and when [s]: from the next step on they
        carry nothing. Their dead load stays on their nodes. For a frame that begins without a
        member see `without`.
    drawing : FrameDrawing, optional
        What it was drawn from; `grid` gives it.

    Raises
    ------
    InputError
        With a line for everything that is wrong: the member or node, and the remedy.

    Warns
    -----
    AccuracyWarning
        For lengths that are those of no building, and masses without weight.
    """

    storeys: ArrayLike | None = None
    bays: ArrayLike | None = None
    columns: FrameMember | Mapping[Any, FrameMember | None] | None = None
    beams: FrameMember | Mapping[Any, FrameMember | None] | None = None
    floor_mass: ArrayLike = 0.0
    beam_load: ArrayLike = 0.0
    kinematics: Literal["small", "pdelta"] = "small"
    base: Literal["fixed", "pinned", "free"] = "fixed"
    diaphragm: bool = False
    pattern: Literal["triangular", "uniform", "modal", "nodes"] = "triangular"
    control_node: str = ""
    control: Literal["x", "y"] = "x"
    collapse: Literal["storey", "roof"] = "storey"
    nodes: Sequence[FrameNode] = ()
    members: Sequence[Member] = ()
    damping: Damping | float | None = None
    panel: Spring | None = None
    losses: Mapping[str, float] | None = None
    drawing: FrameDrawing | None = field(default=None, compare=False)

    if TYPE_CHECKING:
        #: What Fortran has made of it.
        _made: ClassVar[_core.Made]

    #: Whether other frames of its building may hold it.
    _is_part: ClassVar[bool] = False
    #: Openings are those of axial springs, as in a column that has these.
    opens: ClassVar[bool] = True

    def __post_init__(self) -> None:
        _arguments.convert(self, "frame")
        for name in ("storeys", "bays"):
            if getattr(self, name) is not None:
                lengths = _arguments.vector(getattr(self, name), f"frame: {name}", shape="1 or m")
                _arguments.put(self, **{name: tuple(lengths.tolist())})
        storeys, bays = len(self.storeys or ()), len(self.bays or ())  # type: ignore[arg-type]
        for name in ("floor_mass", "beam_load"):
            of_beams = loads_of_beams(
                getattr(self, name), name, storeys, bays if name == "beam_load" else 1
            )
            # Floors that are alike are stated once, as a case file has them.
            _arguments.put(self, **{name: loads_by_floor(of_beams)})
        for name in ("columns", "beams"):
            lines = len(self.bays or ()) + (name == "columns")  # type: ignore[arg-type]
            cells = cells_of(getattr(self, name), name, FrameMember, lines)
            _arguments.put(self, **{name: cells or None})
        for name, kind in (("nodes", FrameNode), ("members", Member)):
            items = tuple(_arguments.several(getattr(self, name), f"frame: {name}", name))
            for item in items:
                _arguments.instance(item, f"frame: {name}", kind)
            _arguments.put(self, **{name: items})
        if self.losses is not None:
            if not isinstance(self.losses, Mapping):
                raise InputError(
                    f"frame: losses = {_arguments.shown(self.losses)} must be a mapping from names "
                    "of members to times"
                )
            losses = self.losses.items()
            _arguments.put(
                self, losses={k: _arguments.number(v, "frame: losses") for k, v in losses}
            )
        if self.damping is not None and not isinstance(self.damping, Damping):
            _arguments.put(
                self, damping=Damping(modal=_arguments.number(self.damping, "frame: damping"))
            )
        _arguments.put(self, _made=_core.Made(self._state(), self._is_part))
        # Nodes, members and springs are in the first three lines.
        for note in self._made.text.splitlines()[3:] if NOTES_ON.get() else ():
            warn(note)

    def __repr__(self) -> str:
        grid = f"{len(self.storeys or ())} storeys, {len(self.bays or ())} bays"  # type: ignore[arg-type]
        parts = self.parts
        return (
            f"Frame({grid}, {len(parts.nodes)} nodes, {len(parts.members)} members, "
            f"kinematics={self.kinematics!r})"
        )

    @property
    def _statement(self) -> _core.Statement:
        """Its keys, as the groups of a case file."""
        return self._made.statement

    def __hash__(self) -> int:
        return hash((self._statement.text, *self._statement.numbers))

    @cached_property
    def parts(self) -> FrameParts:
        """Nodes, members and springs as they were laid out, with the forces of the dead load."""
        answer = self._made
        lines = answer.text.split("\n")[:3]
        nodes, members, springs = (tuple(line.split("\t")[:-1]) for line in lines)
        n, m, s = len(nodes), len(members), len(springs)
        x, y, floor, node_mass, ends, compression, position, stiffness, mass = np.split(
            answer.values, np.cumsum([n, n, n, n, 2 * m, m, s, s])
        )
        return FrameParts(
            nodes,
            members,
            x,
            y,
            floor.astype(np.int64),
            ends.reshape(m, 2).astype(np.int64) - 1,
            np.full(m, np.nan) if answer.is_part else compression,
            tuple(
                _spring_of(text, float(where), float(k))
                for text, where, k in zip(springs, position, stiffness, strict=True)
            ),
            float(mass[0]),
            node_mass,
        )

    @cached_property
    def geometry(self) -> dict[str, MemberGeometry]:
        """Where each member is, by its name, in the order of the columns of a result."""
        parts, free = self.parts, {member.name: member for member in self.members}
        nodes, geometry, places = np.column_stack((parts.x, parts.y)), {}, self.places
        for name, (start, end) in zip(parts.members, parts.ends.tolist(), strict=True):
            rigid: Any = (free.get(name) or self.kinds[name]).rigid_end
            if not isinstance(rigid, tuple):
                # A column of the first storey has no rigid length at its foot.
                foot = places[name].kind == "column" and places[name].storey == 1
                rigid = (0.0 if foot else rigid, rigid)
            length = float(np.hypot(*(nodes[end] - nodes[start])))
            axis = (nodes[end] - nodes[start]) / length
            begin = nodes[start] + rigid[0] * axis
            geometry[name] = MemberGeometry(
                name, start, end, axis, rigid, length - sum(rigid), begin, self.load_of(name)
            )
        return geometry

    @cached_property
    def supports(self) -> dict[str, str]:
        """Nodes that are held: "roller", "pinned", "fixed", or "springs" from the ground."""
        parts = self.parts
        held: dict[str, str] = {
            name: self.base for name, i in zip(parts.nodes, parts.floor, strict=True) if i == 0
        }
        # Nodes outside of the grid are held by their own supports alone.
        held |= {node.name: "free" for node in self.nodes if node.floor is not None}
        for node in self.nodes:
            how = node.support or held.get(node.name, "free")
            sprung = any((node.shear, node.axial_spring, node.flexure))
            held[node.name] = "springs" if how == "free" and sprung else how
        joined = {parts.nodes[i] for i in parts.ends.ravel()}
        return {name: how for name, how in held.items() if how != "free" and name in joined}

    @property
    def height(self) -> float:
        """Height from the lowest to the highest node, of a beam alone its length [m]."""
        return float(np.ptp(self.parts.y) or np.ptp(self.parts.x))

    @cached_property
    def storey_heights(self) -> tuple[float, ...]:
        """Heights of the storeys of the grid, or between the floors of nodes [m]; empty without."""
        parts, grid = self.parts, cast("Sequence[float]", self.storeys or ())
        floors = range(parts.floor.max(initial=0) + 1)
        if grid and len(grid) == len(floors) - 1:
            return tuple(grid)
        # Nodes of one's own make the floors, or more floors than the grid has.
        level = [parts.y[parts.floor == i].max() for i in floors] if len(floors) > 1 else [0.0]
        return tuple(np.diff(level).tolist())

    @property
    def floor_levels(self) -> Array:
        """Heights of the floors from the base up, shape (storeys + 1,) [m]."""
        top = self.parts.y[self.parts.floor == len(self.storey_heights)].max()
        return np.asarray(top - np.cumsum((0.0, *self.storey_heights[::-1]))[::-1])

    @property
    def n(self) -> int:
        """Number of nodes."""
        return len(self.parts.nodes)

    @property
    def joint_numbers(self) -> range:
        """Numbers of the springs in members, from 1, as limit states know them, layers last."""
        layers = sum(len(joint.layers) for joint in self.joints.values())
        return range(1, len(self.parts.springs) + layers + 1)

    @property
    def damped(self) -> bool:
        """Whether the frame has viscous damping."""
        return isinstance(self.damping, Damping) and self.damping.acts

    @cached_property
    def places(self) -> dict[str, Place]:
        """Where the members of the grid stand, by their names."""
        free = {member.name for member in self.members}
        lines = range(1, len(self.bays or ()) + 2)  # type: ignore[arg-type]
        levels = range(1, len(self.storeys or ()) + 1)  # type: ignore[arg-type]
        grid = [Place("column", i, k) for k in levels for i in lines]
        grid += [Place("beam", i, k) for k in levels for i in lines[:-1]]
        there = set(self.parts.members) - free
        return {place.name: place for place in grid if place.name in there}

    @cached_property
    def kinds(self) -> dict[str, FrameMember]:
        """Kinds of the members by their names, in the order of the columns of a result."""
        kinds = {member.name: member.kind for member in self.members}
        cells: Any = {"column": self.columns or {}, "beam": self.beams or {}}
        kinds |= {
            name: at_place(cells[place.kind], place.line, place.storey)
            for name, place in self.places.items()
        }
        return {name: kinds[name] for name in self.parts.members}

    @cached_property
    def struts(self) -> dict[str, InfilledBay]:
        """Infilled bays, by the names of their struts."""
        return {name: bay for bay in self.infilled for name in bay.struts}

    @cached_property
    def given_springs(self) -> dict[FrameSpring, Spring | None]:
        """The spring that was given at each place; for the layers of a joint it is the joint."""
        panels = {node.name: node.panel for node in self.nodes}
        # Equal members are of one kind.
        known: dict[int, dict[tuple[str, float], Spring]] = {}
        springs: dict[FrameSpring, Spring | None] = {}
        for spring in self.parts.springs:
            if spring.group == "panel":
                springs[spring] = panels.get(spring.member) or self.panel
                continue
            kind: Any = self.kinds[spring.member]
            if id(kind) not in known:
                known[id(kind)] = {
                    (group, position): of_place
                    for group in ("flexure", "shear")
                    for position, of_place in getattr(kind, group) or ()
                }
            group = "flexure" if spring.rule == "layered" else spring.group
            otherwise = kind.axial_spring if group == "axial_spring" else None
            springs[spring] = known[id(kind)].get((group, spring.position), otherwise)
        return springs

    @cached_property
    def joints(self) -> dict[FrameSpring, Layered]:
        """Flexural springs that are joints of layers, with these."""
        return {
            spring: made
            for spring, made in self.given_springs.items()
            if isinstance(made, Layered) and spring.group == "flexure"
        }

    @cached_property
    def landmarks(self) -> dict[FrameSpring, list[Landmark]]:
        """Cracking, yield and cap of each spring, first time on the virgin curve."""
        known: dict[int, list[Landmark]] = {}
        landmarks: dict[FrameSpring, list[Landmark]] = {}
        sides: tuple[Literal[1, -1], ...] = (1, -1)
        for spring, made in self.given_springs.items():
            if spring.member in self.struts:
                landmarks[spring] = self.struts[spring.member].landmarks()
                continue
            kind = None if spring.group == "panel" else self.kinds[spring.member]
            if kind is not None and kind.yield_moment is not None:
                turned = kind.yield_moment / spring.stiffness
                yields = [Landmark("yield", side, turned, "yield_moment") for side in sides]
                landmarks[spring] = yields if spring.group == "flexure" else []
                continue
            if made is not None and spring.rule != "layered" and id(made) not in known:
                known[id(made)] = made.landmarks()
            landmarks[spring] = known.get(id(made), [])
        return landmarks

    def without(self, *members: str) -> Self:
        """Return the frame after the loss of members.

        Parameters
        ----------
        *members : str
            Names: C-line-storey, B-bay-storey, or those of `members`.

        Raises
        ------
        InputError
            If there is no such member, or a node outside of the grid is left without one.
        """
        cells: Any = {"column": dict(self.columns or {}), "beam": dict(self.beams or {})}  # type: ignore[arg-type]
        free = {member.name: member for member in self.members}
        for name in members:
            index_of(name, self.parts.members, "member")
            if free.pop(name, None) is None:
                kind, *at = self.places[name]
                cells[kind].pop(tuple(at), None)
                cells[kind][tuple(at)] = None
        columns, beams = (own_cells or None for own_cells in cells.values())
        return replace(self, columns=columns, beams=beams, members=tuple(free.values()))

    @cached_property
    def named_kinds(self) -> dict[str, FrameMember]:
        """Kinds of its members by their names in a case file, without their rigid lengths."""
        cells: Any = self.columns, self.beams
        kinds = [kind for of_grid in cells for kind in (of_grid or {}).values() if kind]
        named = names_of([*kinds, *(member.kind for member in self.members)])
        return {name: kind for (_, kind), name in named.items()}

    def with_kinds(self, kinds: Mapping[str, FrameMember]) -> Self:
        """Return the frame with other kinds of members in place of some of `named_kinds`."""
        names = {(kind.name, kind): name for name, kind in self.named_kinds.items()}

        def changed(kind: FrameMember | None) -> FrameMember | None:
            other = kind and kinds.get(names[stated(kind)])
            return with_rigid_end(other, kind.rigid_end) if other and kind else kind

        columns, beams = (
            {at: changed(kind) for at, kind in of_grid.items()} if of_grid else of_grid  # type: ignore[union-attr]
            for of_grid in (self.columns, self.beams)
        )
        members = tuple(
            replace(member, kind=changed(member.kind) or member.kind) for member in self.members
        )
        return replace(self, columns=columns, beams=beams, members=members)

    def with_axial_failure(self, factor: float) -> Self:
        """Return the frame whose members lose their axial load at `factor` times the drift.

        A collapse that stands on this drift is told at both ends of its interval,
        `rbsdem.section.strength.AXIAL_FAILURE_FACTORS`.

        Parameters
        ----------
        factor : float
            Above 0.

        Raises
        ------
        InputError
            If the factor is not above 0, or no member can lose its axial load.
        """
        factor = _arguments.number(factor, "with_axial_failure: factor", above=0)
        kinds = {
            name: replace(kind, failure_drift=factor * kind.failure_drift)
            for name, kind in self.named_kinds.items()
            if kind.failure_drift is not None
        }
        if not kinds:
            raise InputError(
                "with_axial_failure: no member has a failure_drift; members with axial_load of "
                "rbsdem.section.member have one"
            )
        return self.with_kinds(kinds)

    def load_of(self, member: str) -> float:
        """Return the dead load on a member, downward, per length along x [N/m]."""
        for free in self.members:
            if free.name == member:
                return free.load
        place, loads = self.places[member], self.beam_load
        if place.kind == "column":
            return 0.0
        of_floor = np.atleast_1d(loads[min(place.storey, len(loads)) - 1])  # type: ignore[arg-type, index]
        return float(of_floor[min(place.line, of_floor.size) - 1])

    def _state(
        self,
        cells: Sequence[Mapping[tuple[int, int], Any]] = (),
        drawn: Mapping[Any, dict[str, Any]] | None = None,
        drawing: FrameDrawing | None = None,
        **more: Any,
    ) -> _core.Statement:
        """Return the groups of a case file; some cells may be drawn, with `more` keys of the grid.

        `drawn` has, for each drawn cell and for the sections of each kind, the keys that name the
        drawings. With a `drawing`, its floors, nodes and members stand in the place of those that
        were made from them.
        """
        grids: Any = cells or (self.columns or {}, self.beams or {})
        drawn = drawn or {}
        kinds = [
            kind for of_grid in grids for kind in of_grid.values() if kind and kind not in drawn
        ]
        members = self.members if drawing is None else drawing.members
        kinds += [member.kind for member in members]
        names = names_of(kinds)
        usual = {"kinematics": "small", "base": "fixed", "pattern": "triangular", "control": "x"}
        usual["collapse"] = "storey"
        grid = {
            name: getattr(self, name)
            for name in ("storeys", "bays", "diaphragm", "control_node", *usual)
        }
        own_values = {k: v for k, v in grid.items() if v not in (None, False, "", usual.get(k))}
        parts: list[_core.Statement | Group] = [("frame", own_values | more)]
        lines = len(self.bays or ()) + 1  # type: ignore[arg-type]
        parts += self._floors() if drawing is None else drawing.floors(lines)
        parts += groups_of_kinds(names, drawn)
        columns = rules_of(grids[0], "line", "storey", lines)
        beams = rules_of(grids[1], "bay", "storey", lines - 1)
        parts += groups_of_cells("column_of", columns, names, drawn)
        parts += groups_of_cells("beam_of", beams, names, drawn)
        nodes = self.nodes if drawing is None else drawing.nodes
        parts += placed([entry for node in nodes for entry in node._groups()])
        parts += [member._group(names[stated(member.kind)]) for member in members]
        parts += self.loss_groups()
        if self.panel is not None:
            parts += placed([("flexure", {"panel": _core.Text("all")}, self.panel)])
        if isinstance(self.damping, Damping):
            parts.append(self.damping.statement())
        return _core.joined(parts)

    def loss_groups(self) -> list[Group]:
        """Return the groups of members that are lost."""
        return [
            ("loss", {"member": _core.Text(member), "time": time})
            for member, time in (self.losses or {}).items()
        ]

    def _floors(self) -> Iterator[Group]:
        """Yield a group for each floor with a mass or a load, one for all if they are alike."""
        masses, loads = self.floor_mass, self.beam_load
        count = max(len(masses), len(loads))  # type: ignore[arg-type]
        for i in range(count):
            mass = masses[min(i, len(masses) - 1)]  # type: ignore[arg-type, index]
            load = loads[min(i, len(loads) - 1)]  # type: ignore[arg-type, index]
            if mass or load:
                floor = None if count == 1 else i + 1
                values = {"floor": floor, "mass": mass or None, "dead_load": load or None}
                yield "floor", values

    @classmethod
    def grid(
        cls,
        storeys: ArrayLike,
        bays: ArrayLike | None = None,
        *,
        columns: Cells,
        beams: Cells | None = None,
        ends: float | Literal["asce"] | None = None,
        panel_hoops: Ties | Literal["none"] | None = None,
        dead_load: ArrayLike = 0.0,
        live_load: ArrayLike = 0.0,
        live_share: float = 0.3,
        node_load: float | Mapping[Any, float] = 0.0,
        self_weight: bool = False,
        mass: Literal["from_loads"] | None = None,
        infills: Infill | Mapping[Any, Infill | None] | None = None,
        walls: Mapping[int, WallSection | Sequence[WallSection]] | None = None,
        wall_spans: ArrayLike | Mapping[int, float] | None = None,
        axial_loads: Mapping[str, float] | None = None,
        **more: Any,
    ) -> Self:
        """Return a frame of storeys and bays, from kinds of members or from their sections.

        Members of sections are layered ones (`rbsdem.section.member`) between the faces of the
        rigid ends; columns stand under the axial load of the elastic frame, rounded to 1 % of f'c
        A_g. Equal members are made once.

        Parameters
        ----------
        storeys, bays : sequence of float
            Heights and widths between axes [m].
        columns, beams : Section, pair of Section, FrameMember, or mapping
            One for all, or by (line, storey) or (bay, storey), where the last that fits counts:
            numbers, tuples of them, 0 for all, "outer" or "inner": ``{("outer", 1): c1, ("inner",
            (1, 2)): c2}``. None: there is no member; a node without any is not there, as where
            upper storeys step back. A pair are the sections of the two halves. y > 0 of a
            section is up in a beam, on the left in a column.
        ends : float or "asce", optional
            Part of a node that is rigid in columns and beams, or the rule of ASCE 41-17, 10.4.2.2.1
            (`rbsdem.section.rigid_ends`); by default that rule, and 1 with springs in the nodes.
        panel_hoops : Ties or "none", optional
            Springs in the panels of the nodes (`rbsdem.frames.JointPanel`) with these hoops, or
            without hoops; None: the nodes are rigid.
        dead_load, live_load : float or sequence of float, optional
            On the beams of all floors, or of each [N/m]; of dead load a floor may have one for each
            bay.
        live_share : float, optional
            Part of the live load that acts.
        node_load : float or mapping, optional
            Weights of walls and facades on the nodes of floors: of the outer lines, or by (line,
            floor) as the columns; the last that fits counts [N].
        self_weight : bool, optional
            Whether members of sections have their own weight, 25 kN/m3.
        mass : "from_loads", optional
            Floor masses are those of the loads; given `floor_mass` that differ from them by more
            than 5 % are told.
        walls : mapping, optional
            Lines that are walls, with a section for all storeys or one for each, from the ground
            up. Their members have the springs of the whole wall (`rbsdem.section.wall_members`),
            and beams reach their faces by rigid arms.
        wall_spans : float, sequence or mapping, optional
            M/V at the foot of walls, for which their springs are made, of all or by line [m]; by
            default where the beams yield and the wall at its foot under the lateral load of the
            pattern. A run tells where it is another.
        infills : Infill or mapping, optional
            Masonry between columns and beams: one for all bays and storeys, or by (bay, storey), 0
            for all, where the last that fits counts; None: there is none.
        axial_loads : mapping, optional
            Axial loads under which columns stand, by name, in place of those of the frame alone, as
            of columns that carry beams of another frame [N].
        **more
            Other parameters of `Frame`; `beam_load` adds to the loads above.

        Raises
        ------
        InputError
            With what is wrong and where.
        """
        heights = tuple(_arguments.vector(storeys, "frame: storeys", shape="1 or m").tolist())
        widths: tuple[float, ...] = ()
        if bays is not None:
            widths = tuple(_arguments.vector(bays, "frame: bays", shape="1 or m").tolist())
        if mass is not None:
            _arguments.choice(mass, "frame: mass", ("from_loads",))
        lines = len(widths) + 1
        upright = cells_of(columns, "columns", FrameMember, lines, halves=Section)
        upright |= cells_of_walls(walls, lines, len(heights))
        level = cells_of(beams, "beams", FrameMember, lines - 1, halves=Section)
        grid = Grid(heights, widths, upright, level)
        nodes_given = tuple(_arguments.several(more.pop("nodes", ()), "frame: nodes", "nodes"))
        for node in nodes_given:
            _arguments.instance(node, "frame: nodes", FrameNode)
        stated = {
            "beam_load": more.pop("beam_load", 0.0), "dead_load": dead_load, "live_load": live_load
        }  # fmt: skip
        loads = {name: grid.floors(load, name) for name, load in stated.items()}
        if self_weight is True or sum(map(np.any, loads.values())) > 1:
            # The solver sees the sum: of a single load it tells by itself.
            for name, load in loads.items():
                told_of_small(f"frame: {name}", load, "N/m", "10 kN/m is 10e3")
        dead, live = loads["beam_load"] + loads["dead_load"], loads["live_load"]
        if live.shape[1] > 1:
            raise InputError("frame: live_load is one for each floor; give bays to dead_load")
        drawing = FrameDrawing(
            grid.given[0],
            grid.given[1],
            ends if ends is not None else "asce" if panel_hoops is None else 1.0,
            panel_hoops,
            cells_of(infills, "infills", Infill, lines - 1),
            tuple(row[0] if len(set(row)) == 1 else tuple(row) for row in dead.tolist()),
            tuple(live[:, 0].tolist()),
            _arguments.number(live_share, "frame: live_share", least=0.0, most=1.0),
            loads_of_nodes(node_load, lines),
            _arguments.boolean(self_weight, "frame: self_weight"),
            mass,
            more.pop("floor_mass", None),
            nodes_given,
            tuple(more.get("members", ())),
            spans_of_walls(wall_spans, lines),
        )
        grid.check_places("node_load", drawing.node_load, lines)
        more |= grid.loads(drawing)
        drawn = any(drawing.infills.values()) or any(map(is_drawn, grid.all_cells()))
        if not drawn:
            cells = drawing.columns, drawing.beams or None
            return cls(heights, widths or None, *cells, **more)
        with each_told_once():
            members = grid.members(cls, drawing, more, axial_loads)
        if NOTES_ON.get():
            grid.note_on_sections()
            grid.note_on_bars(more["beam_load"])
        nodes = {node.name: node for node in more["nodes"]}
        for name, panel in grid.panels(drawing).items():
            node = nodes.get(name, FrameNode(name))
            nodes[name] = node if node.panel is not None else replace(node, panel=panel)
        more["nodes"] = tuple(nodes.values())
        struts = [strut for bay in grid.infilled(drawing.infills) for strut in bay.members()]
        more["members"] = (*drawing.members, *struts)
        frame = cls(heights, widths or None, members[0], members[1] or None, **more)
        # Under axial loads of another frame its sections alone do not say what it is.
        made = frame._statement if axial_loads is None else None
        _arguments.put(frame, drawing=replace(drawing, made=made))
        return frame

    @cached_property
    def infilled(self) -> tuple[InfilledBay, ...]:
        """Infills in their places, whose struts are members."""
        if self.drawing is None or not self.drawing.infills:
            return ()
        storeys: Any = self.storeys
        bays: Any = self.bays
        grid = Grid(storeys, bays, self.drawing.columns, self.drawing.beams)
        free = {member.name for member in self.members}
        return tuple(
            bay for bay in grid.infilled(self.drawing.infills) if free.issuperset(bay.struts)
        )

    @property
    def scope_note(self) -> str:
        """Scope of results of the frame, printed with them."""
        return f"{SCOPE_NOTE} {INFILL_NOTE}" if self.infilled else SCOPE_NOTE

    def to_namelist(self, *, springs: bool = False) -> str:
        """Return the frame as groups of a case file, from which the same frame comes back.

        Parameters
        ----------
        springs : bool, optional
            Whether members that were drawn are written with all their springs, as the executable
            takes them; else by their sections, from which `rbsdem.read_case` makes them again.
        """
        statement = self._statement if springs else self._groups()
        return _core.evaluate("to_namelist", statement).text

    def _groups(self) -> _core.Statement:
        """Return the groups of a case file, with drawings in place of springs where that is all."""
        drawing = self.drawing
        if drawing is None or drawing.made != self._statement:
            # Not drawn, or changed since, as by `without`: springs, with what they were made of.
            drawn, sections, _ = drawings_of(self.named_kinds.values())
            return self._state(drawn=drawn) + sections if drawn else self._statement
        cells = drawing.columns, drawing.beams
        different = [cell for of_grid in cells for cell in of_grid.values()]
        drawn, sections, hoops = drawings_of(
            [*different, *(member.kind for member in drawing.members)], drawing.panel_hoops
        )
        more = {
            "panel_hoops": hoops,
            "ends": drawing.ends if drawing.ends != "asce" else None,
            "live_share": drawing.live_share if any(drawing.live_load) else None,
            "self_weight": drawing.self_weight or None,
            "mass": drawing.mass,
            "wall_spans": drawing.wall_spans or None,
        }
        statement = self._state(cells, drawn, drawing, **more)
        bays = len(self.bays or ())  # type: ignore[arg-type]
        infills = rules_of(drawing.infills, "bay", "storey", bays)
        return statement + infill_groups(infills) + sections


class FrameInPlan(Frame):
    """A frame of a building, which others may hold: alone its dead load gives no forces yet."""

    _is_part = True


def drawings_of(
    cells: Iterable[Any], hoops: Ties | Literal["none"] | None = None
) -> tuple[dict[Any, dict[str, Any]], _core.Statement, Any]:
    """Return the keys of drawn cells, the groups of their sections, and what names the hoops.

    Hoops are named by a drawing that has them; "none" and None stay as they are.

    Parameters
    ----------
    cells : iterable
        What stands in the places of a grid; kinds of members are drawn by the sections that they
        know.
    hoops : Ties, "none" or None
        Those in the panels of nodes.
    """
    drawings: dict[Section, str] = {}
    cells = list(cells)
    kinds = [cell for cell in cells if isinstance(cell, FrameMember)]
    taken = {cell.name for cell in kinds}

    def name_of(section: Section) -> _core.Text:
        """Return the name of the drawing of a section; a new one is entered in `drawings`."""
        names = (f"section-{i}" for i in count(1))
        free = (name for name in names if name not in {*taken, *drawings.values()})
        return _core.Text(drawings.get(section) or drawings.setdefault(section, next(free)))

    drawn: dict[Any, dict[str, Any]] = {}
    for cell in filter(is_drawn, [*cells, *(kind.sections for kind in kinds)]):
        start, end = halves_of(cell)
        drawn[cell] = {"kind": name_of(start), "kind_to": name_of(end) if start != end else None}
    named: Any = hoops
    if isinstance(hoops, Ties):
        # A drawing with these hoops; no member may be of it.
        like: Section = replace(next(iter(drawings)), ties=hoops)  # type: ignore[call-arg]
        named = name_of(next((section for section in drawings if section.ties == hoops), like))
    groups = [
        _core.group("drawing", {"name": _core.Text(name), "version": _core.Text(VERSION)})
        + section.drawing()
        for section, name in drawings.items()
    ]
    return drawn, _core.joined(groups), named


def _spring_of(text: str, position: float, stiffness: float) -> FrameSpring:
    """Return a spring of a frame from "member group rule", its place (0 to 1) and stiffness."""
    member, group, rule = text.rsplit(" ", 2)
    end = "" if group == "panel" else _ENDS.get(position, f"{position:g}")
    return FrameSpring(member, group, rule, position, stiffness, end)


#: Structures that analyses take.
Structure = Column | Frame


def checked_structure(structure: object, who: str = "") -> Structure:
    """Return a column or a frame, or raise `InputError` with what makes one."""
    return structure if isinstance(structure, Frame) else checked_column(structure, who)
