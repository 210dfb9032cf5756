"""Frames from the sections of their members: lengths, rigid ends, gravity loads found by itself."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from itertools import count
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array
from rbsdem.errors import InputError, warn
from rbsdem.model.column import NOTES_ON, notes_off
from rbsdem.model.frame import (
    FrameMember,
    FrameNode,
    Member,
    Place,
    at_place,
    check_places,
    places_of,
    rules_of,
    with_rigid_end,
)
from rbsdem.model.materials import Ties
from rbsdem.model.shape import RectangularSection, Section
from rbsdem.model.springs import Group
from rbsdem.model.wall import WallSection
from rbsdem.section.columns import member, plastic_moments
from rbsdem.section.infill import Infill, InfilledBay
from rbsdem.section.panel import JointPanel, PanelClass, rigid_ends
from rbsdem.section.spans import Pair, line_spans
from rbsdem.section.walls import wall_members

Halves = tuple[Section, Section]
Drawn = Section | Halves | FrameMember
# Places are pairs of numbers, tuples of them and words; a variable keeps the type of its keys.
Cells = Drawn | Mapping[Any, Drawn | None]

#: Weight of reinforced concrete [N/m3].
CONCRETE_WEIGHT = 25e3
#: Axial loads of columns are rounded to this part of f'c A_g, so that like columns are one kind.
_STEP = 0.01
#: Less than this part of a step is round-off: the column carries nothing.
_NO_LOAD = 1e-6
#: So are M/V of the ends of columns, to this part of their clear length.
_SPAN_STEP = 0.05
#: Masses that differ by more than this from those of the loads are told.
_DIFFER = 0.05
#: Longest storey or bay [m]; smallest load of a beam, and of a node [N/m, N].
_LONGEST, _LEAST_LOAD = 200.0, 100.0
#: Depth over width of a section that is one of a beam.
_SLIM = 1.4
#: Beams under load with more bars below than this times those above are told.
_MORE_BELOW = 1.25


def _in_steps(value: float, step: float) -> float:
    """Return the steps nearest to a value, at least one; half-way, by round-off, the larger."""
    return max(math.floor(value / step + 0.5 + 1e-9), 1) * step


@dataclass(frozen=True)
class FrameDrawing:
    """What a frame was drawn from: sections, loads, and the rules of its nodes.

    Attributes
    ----------
    columns, beams : dict
        Section, or those of the two halves, by (line, storey) and (bay, storey), 0 for all.
    ends : float or "asce"
        Rule of the rigid ends, the `share` of `rbsdem.section.rigid_ends`.
    panel_hoops : Ties, "none" or None
        Hoops in the panels of nodes; None: the nodes are rigid.
    infills : dict
        Infill, or None, by (bay, storey), 0 for all.
    dead_load, live_load : tuple of float
        On the beams of each floor [N/m]; of dead load tuples where bays differ.
    live_share : float
        Part of the live load that acts.
    node_load : dict
        Weights on nodes by (line, floor), 0 for all [N].
    self_weight : bool
        Whether the members have their own weight.
    mass : "from_loads" or None
        Where the masses of the floors come from.
    floor_mass : array_like or None
        Those that were given [kg].
    nodes, members : tuple of FrameNode and of Member
        What was given in addition.
    wall_spans : tuple of float
        M/V at the foot of walls, of all lines or of each [m]; zero or none where it is found.
    made : Statement or None
        The frame that was made of it; one that has been changed since is another.
    """

    columns: dict[tuple[int, int], Any]
    beams: dict[tuple[int, int], Any]
    ends: float | Literal["asce"] = "asce"
    panel_hoops: Ties | Literal["none"] | None = None
    infills: dict[tuple[int, int], Any] = field(default_factory=dict)
    dead_load: tuple[Any, ...] = (0.0,)
    live_load: tuple[float, ...] = (0.0,)
    live_share: float = 0.3
    node_load: dict[tuple[int, int], float] = field(default_factory=dict)
    self_weight: bool = False
    mass: Literal["from_loads"] | None = None
    floor_mass: Any = None
    nodes: tuple[FrameNode, ...] = ()
    members: tuple[Member, ...] = ()
    wall_spans: tuple[float, ...] = ()
    made: _core.Statement | None = field(default=None, repr=False)

    def floors(self, lines: int) -> Iterator[Group]:
        """Yield the groups of floors, and of loads of nodes on a number of lines."""
        masses = () if self.floor_mass is None else np.atleast_1d(self.floor_mass).tolist()
        columns = {"mass": masses, "dead_load": self.dead_load, "live_load": self.live_load}
        # Floors that are alike are stated once.
        columns = {
            name: values[:1] if len(set(values)) == 1 else values
            for name, values in columns.items()
        }
        count = max(len(values) for values in columns.values())
        for i in range(count):
            of_floor = {
                name: values[min(i, len(values) - 1)] or None if values else None
                for name, values in columns.items()
            }
            if any(of_floor.values()):
                yield "floor", {"floor": i + 1 if count > 1 else None, **of_floor}
        for place, load in rules_of(self.node_load, "line", "floor", lines):
            yield "node_load", place | {"load": load}


def infill_groups(places: Sequence[tuple[dict[str, Any], Infill | None]]) -> _core.Statement:
    """Return the groups of infills and of their places; None is a panel without one."""
    infills = list(dict.fromkeys(infill for _, infill in places if infill is not None))
    taken = {infill.name for infill in infills}
    free = (name for name in (f"infill-{i}" for i in count(1)) if name not in taken)
    names: dict[Infill | None, str] = {infill: infill.name or next(free) for infill in infills}
    parts: list[Group] = []
    for infill in infills:
        length, height = infill.opening or (None, None)
        keys: dict[str, Any] = {"name": _core.Text(names[infill])}
        keys |= {key: getattr(infill, key) for key in ("thickness", "fm", "strength", "peak_drift")}
        parts.append(("infill", keys | {"opening_length": length, "opening_height": height}))
    for place, panel in places:
        kind = _core.Text(names.get(panel, "none"))
        parts.append(("infill_of", place | {"kind": kind}))
    return _core.joined(parts)


def _masses(floor_mass: Any, floors: Array, mass: str | None) -> dict[str, Any]:
    """Return floor masses: stated ones, compared with the loads, or those of the loads."""
    if floor_mass is None:
        if mass is None:
            return {}
        return {"floor_mass": floors if len(set(floors.tolist())) > 1 else floors[:1]}
    stated = np.broadcast_to(
        _arguments.vector(floor_mass, "frame: floor_mass", shape="1 or m"), floors.shape
    )
    apart = np.abs(stated - floors) > _DIFFER * floors
    if mass is not None and apart.any():
        at = int(apart.argmax())
        warn(
            f"frame: floor_mass of floor {at + 1} is {stated[at]:.4g} kg, and its loads weigh "
            f"{floors[at]:.4g} kg; leave out floor_mass, or mass"
        )
    return {"floor_mass": floor_mass}


def cells_of_walls(walls: Any, lines: int, storeys: int) -> dict[tuple[int, int], WallSection]:
    """Return the sections of lines that are walls, by line and storey, 0 for all."""
    cells: dict[tuple[int, int], WallSection] = {}
    for line, sections in (walls or {}).items():
        number = _arguments.integer(line, "frame: walls", least=1, most=lines)
        each = sections_of_wall(sections, storeys, f"line {number}")
        places = [0] if len(each) == 1 else range(1, storeys + 1)
        cells |= {(number, k): section for k, section in zip(places, each, strict=True)}
    return cells


def sections_of_wall(sections: Any, storeys: int, where: str) -> tuple[WallSection, ...]:
    """Return the sections of a wall: one for all storeys, or one for each from the ground up."""
    each = (
        [sections]
        if isinstance(sections, WallSection)
        else _arguments.several(sections, f"frame: walls: {where}", "WallSection")
    )
    for section in each:
        _arguments.instance(section, f"frame: walls: {where}", WallSection)
    if len(each) not in (1, storeys):
        raise InputError(
            f"frame: walls: {where} has {len(each)} sections for {storeys} storeys; give one, or "
            "one for each"
        )
    return tuple(each)


def spans_of_walls(stated: Any, lines: int) -> tuple[float, ...]:
    """Return M/V of walls, one for all lines or one for each; 0 where it is not given."""
    if stated is None:
        return ()
    if not isinstance(stated, Mapping):
        each = _arguments.vector(stated, "frame: wall_spans", shape="1 or m").tolist()
        if len(each) not in (1, lines) or min(each) < 0.0:
            raise InputError(
                f"frame: wall_spans = {_arguments.shown(stated)} must be one length above 0, or "
                f"one for each of {lines} lines, 0 where it is to be found"
            )
        return tuple(each)
    spans = [0.0] * lines
    for line, span in stated.items():
        number = _arguments.integer(line, "frame: wall_spans", least=1, most=lines)
        spans[number - 1] = _arguments.number(span, "frame: wall_spans", above=0.0, unit="m")
    return tuple(spans)


def loads_of_nodes(weights: Any, lines: int) -> dict[tuple[int, int], float]:
    """Return weights on the nodes of floors by line and floor, 0 for all."""
    rules = weights if isinstance(weights, Mapping) else {("outer", 0): weights} if weights else {}
    loads = {
        place: _arguments.number(load, "frame: node_load")
        for pair, load in rules.items()
        for place in places_of(pair, "node_load", lines)
    }
    told_of_small("frame: node_load", list(loads.values()), "N", "25 kN is 25e3")
    return loads


def loads_of_beams(loads: Any, name: str, storeys: int, bays: int) -> Array:
    """Return loads of beams: one, one for each floor, or tuples of each bay where these differ.

    Returns
    -------
    ndarray, shape (storeys, bays) or (storeys, 1)
        The loads [N/m].
    """
    rows = loads if isinstance(loads, (list, tuple)) or np.ndim(loads) > 0 else [loads]
    named = f"frame: {name}"
    each = [_arguments.vector(row, named, shape="1 or m") for row in rows]
    if len(each) not in (1, storeys) or any(row.size not in (1, bays) for row in each):
        raise InputError(
            f"frame: {name} has {len(each)} values for {storeys} storeys; give one, or one for each"
            + ("" if all(row.size == 1 for row in each) else f", and in it one for {bays} bays")
        )
    width = max((row.size for row in each), default=1)
    table = np.array([np.broadcast_to(row, width) for row in each])
    return np.array(np.broadcast_to(table, (max(storeys, len(each)), width)))


def loads_by_floor(loads: Array) -> tuple[Any, ...]:
    """Return loads as they are stated: once if floors are alike, once a floor if bays are."""
    rows = [row[0] if len(set(row)) == 1 else tuple(row) for row in loads.tolist()]
    return tuple(rows if len(set(rows)) > 1 else rows[:1])


def told_of_small(name: str, loads: Any, unit: str, meant: str) -> None:
    """Tell of a load that is none of a building, as one in kN is."""
    small = [load for load in np.ravel(loads).tolist() if 0.0 < abs(load) < _LEAST_LOAD]
    if small and NOTES_ON.get():
        warn(f"{name} = {small[0]:g} {unit} is that of no building; {meant}")


class Grid:
    """Places of a grid and what stands in them."""

    def __init__(
        self,
        storeys: tuple[float, ...],
        bays: tuple[float, ...],
        columns: dict[tuple[int, int], Any],
        beams: dict[tuple[int, int], Any],
    ) -> None:
        self.storeys, self.bays, self.given = storeys, bays, (columns, beams)
        self.check_places("columns", columns, len(bays) + 1)
        self.check_places("beams", beams, len(bays))
        lines, levels = range(1, len(bays) + 2), range(1, len(storeys) + 1)
        self.columns = {(i, k): at_place(columns, i, k) for k in levels for i in lines}
        self.beams = {(i, k): at_place(beams, i, k) for k in levels for i in lines[:-1]}
        self.kinds: tuple[dict[Any, FrameMember | None], ...] = ({}, {})
        #: Members of the gross sections, by the identity of what stands in places.
        different = {id(cell): cell for cell in self.all_cells()}
        self.elastic = {key: elastic_kind(cell) for key, cell in different.items()}

    def check_places(self, name: str, cells: Mapping[tuple[int, int], Any], lines: int) -> None:
        """Refuse places that the grid does not have."""
        line = "bay" if name in ("beams", "infills") else "line"
        check_places(cells, name, (line, "storey"), (lines, len(self.storeys)))

    def all_cells(self) -> list[Any]:
        """Return what stands in the places where there is a member."""
        return [cell for cell in (*self.columns.values(), *self.beams.values()) if cell is not None]

    def floors(self, loads: Any, name: str) -> Array:
        """Return a value for each floor and bay, shape (storeys, bays), or (storeys, 1)."""
        return loads_of_beams(loads, name, len(self.storeys), len(self.bays))

    def loads(self, drawing: FrameDrawing) -> dict[str, Any]:
        """Return loads of beams, loads of nodes and masses of floors, as arguments of a frame."""
        loads = self.floors(drawing.dead_load, "dead_load")
        loads = loads + drawing.live_share * np.array(drawing.live_load)[:, None]
        if drawing.self_weight:
            loads = loads + self.weights_of_beams()[:, None]
        nodes = {node.name: node for node in drawing.nodes}
        for name, weight in self.weights(drawing.node_load, drawing.self_weight).items():
            node = nodes.get(name)
            nodes[name] = (
                replace(node, load_y=node.load_y - weight)
                if node is not None
                else FrameNode(name, load_y=-weight)
            )
        floors = loads[:, 0] * sum(self.bays)
        if np.ptp(loads, axis=1).any() or None in self.beams.values():
            floors = (self._lengths() * loads).sum(axis=1)
        floors = floors / STANDARD_GRAVITY
        for i, k in self.columns:
            if (loaded := nodes.get(f"N-{i}-{k}")) is not None:
                floors[k - 1] -= loaded.load_y / STANDARD_GRAVITY
        more: dict[str, Any] = {"beam_load": loads_by_floor(loads)}
        more |= _masses(drawing.floor_mass, floors, drawing.mass)
        return more | {"nodes": tuple(nodes.values())}

    def weights_of_beams(self) -> Array:
        """Return the weight of the beams of each floor, of their mean section [N/m]."""
        areas = np.reshape(
            [self._area(beam) for beam in self.beams.values()], (len(self.storeys), -1)
        )
        lengths = self._lengths()
        weights = CONCRETE_WEIGHT * (areas * lengths).sum(axis=1)
        return np.asarray(weights / np.maximum(lengths.sum(axis=1), 1.0))

    def _lengths(self) -> Array:
        """Return the lengths of bays on each floor, 0 without a beam, (storeys, bays) [m]."""
        shape = len(self.storeys), len(self.bays)
        beams = np.reshape([beam is not None for beam in self.beams.values()], shape)
        return np.asarray(beams * np.array(self.bays))

    def weights(self, walls: dict[tuple[int, int], float], heavy: bool) -> dict[str, float]:
        """Return the weights on the nodes of floors [N]: walls, and halves of heavy columns."""
        weights = {}
        for i, k in self.columns:
            if not any(cell is not None for cells in self.around(i, k) for cell in cells):
                continue
            weight = at_place(walls, i, k) or 0.0
            if heavy:
                above = self.columns.get((i, k + 1))
                for cell, height in (
                    (self.columns[i, k], self.storeys[k - 1]),
                    (above, self.storeys[k] if above is not None else 0.0),
                ):
                    weight += 0.5 * CONCRETE_WEIGHT * self._area(cell) * height
            if weight:
                weights[f"N-{i}-{k}"] = weight
        return weights

    def members(
        self,
        cls: Any,
        drawing: FrameDrawing,
        more: dict[str, Any],
        axial_loads: Mapping[str, float] | None = None,
    ) -> list[Any]:
        """Return the kinds of all columns and beams."""
        for name, lengths in (("storeys", self.storeys), ("bays", self.bays)):
            if max(lengths, default=0.0) > _LONGEST:
                raise InputError(
                    f"frame: {name} has a length of {max(lengths):g} m, as no building; lengths "
                    "are in m, and 3200 mm is 3.2"
                )
        axial = axial_loads
        if axial is None:
            elastic = [
                {at: self.elastic.get(id(cell)) for at, cell in cells.items()}
                for cells in (self.columns, self.beams)
            ]
            # What does not change the axial loads is left out.
            aside = ("losses", "kinematics", "panel", "damping", "pattern")
            arguments = {key: value for key, value in more.items() if key not in aside}
            with notes_off():
                parts = cls(
                    self.storeys, self.bays or None, elastic[0], elastic[1] or None, **arguments
                ).parts
            axial = dict(zip(parts.members, parts.compression.tolist(), strict=True))
        load = {
            at: self._rounded(self.columns[at], axial.get(Place("column", *at).name, 0.0))
            for at in self.columns
        }
        rigid = {
            (i, k): self._ends(drawing, load, i, k)
            for k in range(1, len(self.storeys) + 1)
            for i in range(1, len(self.bays) + 2)
        }
        columns, beams = self.kinds
        loads = self.loads_of_beams(more["beam_load"])
        ends = {
            "columns": {
                (i, k): (rigid.get((i, k - 1), (0.0, 0.0))[0], rigid[i, k][0])
                for i, k in self.columns
            },
            "beams": {(i, k): (rigid[i, k][1], rigid[i + 1, k][1]) for i, k in self.beams},
        }
        spans = self._spans_of_columns(load, ends["columns"], more)
        walls = self._wall_members(load, spans, drawing.wall_spans)
        for (i, k), cell in self.columns.items():
            if (i, k) in walls:
                columns[i, k] = walls[i, k]
                continue
            place = self.storeys[k - 1], ends["columns"][i, k], load[i, k], 0.0
            columns[i, k] = _kind(cell, *place, Place("column", i, k), spans.get((i, k)))
        for (i, k), cell in self.beams.items():
            place = self.bays[i - 1], ends["beams"][i, k], 0.0, loads[i, k]
            beams[i, k] = _kind(cell, *place, Place("beam", i, k))
        return list(self.kinds)

    def loads_of_beams(self, beam_load: Any) -> dict[tuple[int, int], float]:
        """Return the loads of all beams by bay and storey [N/m]."""
        storeys, bays = len(self.storeys), len(self.bays)
        loads = loads_of_beams(beam_load, "beam_load", storeys, bays)
        each = np.broadcast_to(loads, (storeys, bays)).tolist()
        return {(i, k): each[k - 1][i - 1] for i, k in self.beams}

    def _area(self, cell: Any) -> float:
        """Return the area of the mean section of a member; 0 of a FrameMember [m2]."""
        kind = self.elastic.get(id(cell))
        return kind.area if kind is not None and is_drawn(cell) else 0.0

    def _rounded(self, cell: Any, load: float) -> float:
        """Return an axial load rounded to steps of 1 % of f'c A_g; 0 for a column in tension."""
        if not is_drawn(cell):
            return load
        step = _STEP * self._area(cell) * halves_of(cell)[0].concrete.fc
        return _in_steps(load, step) if load > _NO_LOAD * step else 0.0

    def note_on_sections(self) -> None:
        """Tell of sections that seem exchanged: columns like beams, and beams like columns."""
        columns, beams = (
            [part for cell in cells.values() if is_drawn(cell) for part in halves_of(cell)]
            for cells in (self.columns, self.beams)
        )
        columns = [section for section in columns if not isinstance(section, WallSection)]
        if not columns or not beams:
            return
        for like_beam in (_has_sides, _is_slim):
            if all(map(like_beam, columns)) and not any(map(like_beam, beams)):
                warn(
                    "frame: all columns are deeper than wide or have unlike bars on their two "
                    "sides, and no beam; exchange columns and beams if that is not meant"
                )
                return

    def note_on_bars(self, beam_load: Any) -> None:
        """Tell of loaded beams with more bars below than above at their ends, which hog."""
        loads, doubtful = self.loads_of_beams(beam_load), []
        for (i, k), cell in self.beams.items():
            if not (is_drawn(cell) and loads[i, k] > 0.0):
                continue
            for part in halves_of(cell):
                if part.mirrored.tension_steel > _MORE_BELOW * part.tension_steel:
                    doubtful.append(Place("beam", i, k).name)
        if doubtful:
            names = list(dict.fromkeys(doubtful))
            more = f" and {len(names) - 1} more" if len(names) > 1 else ""
            warn(
                f"beam {names[0]}{more}: there are more bars below than above at an end, where "
                "the load of the floor pulls the top; y > 0 is above, and section.mirrored turns "
                "a section over"
            )

    def _spans_of_columns(
        self,
        load: dict[tuple[int, int], float],
        ends: dict[tuple[int, int], tuple[float, float]],
        more: dict[str, Any],
    ) -> dict[tuple[int, int], tuple[Pair, Pair]]:
        """Return M/V of the ends of drawn columns where drawn beams yield, like for both sides."""
        spans = {}
        levels = range(1, len(self.storeys) + 1)
        pattern = np.ones(len(self.storeys))
        if more.get("pattern", "triangular") != "uniform":
            pattern = np.cumsum(self.storeys)
        for i in range(1, len(self.bays) + 2):
            line = [self.columns[i, k] for k in levels]
            beams = [self.around(i, k)[1] for k in levels]
            if not all(map(is_drawn, line)) or not all(
                cell is None or is_drawn(cell) for pair in beams for cell in pair
            ):
                continue
            clear = [self.storeys[k - 1] - sum(ends[i, k]) for k in levels]
            if min(clear) <= 0.0:
                continue
            # The mean plastic moments of the column of each storey at its two ends, and the sum of
            # those of the beams at each floor, at the axis of a wall where the line is one.
            try:
                plastic = [
                    tuple(sum(plastic_moments(half, load[i, k])) / 2 for half in halves_of(cell))
                    for k, cell in zip(levels, line, strict=True)
                ]
                nodes = [
                    sum(
                        sum(plastic_moments(halves_of(cell)[1 - at], 0.0))
                        / 2
                        * self._to_axis(i, k, i - 1 + at)
                        for at, cell in enumerate(pair)
                        if cell is not None
                    )
                    for k, pair in zip(levels, beams, strict=True)
                ]
            except InputError:
                continue
            base = plastic[0][0] if more.get("base", "fixed") == "fixed" else 0.0
            arguments: Any = base, plastic, nodes, self.storeys, clear, pattern.tolist()
            for k, pair in zip(levels, line_spans(*arguments), strict=True):
                step = _SPAN_STEP * clear[k - 1]
                low, high = (_in_steps(each, step) for each in pair)
                spans[i, k] = (low, low), (high, high)
        return spans

    def _to_axis(self, i: int, k: int, bay: int) -> float:
        """Return the moment of a beam at the axis of a wall over that at its face; else 1."""
        arms = [
            0.5 * wall.length if (wall := self.wall_at(line, k)) else 0.0
            for line in (i, bay + 1 if bay == i else bay)
        ]
        return 1.0 + 2.0 * arms[0] / max(self.bays[bay - 1] - sum(arms), 1e-3)

    def _wall_members(
        self,
        load: dict[tuple[int, int], float],
        spans: dict[tuple[int, int], tuple[Pair, Pair]],
        wall_spans: tuple[float, ...],
    ) -> dict[tuple[int, int], FrameMember]:
        """Return the kinds of walls: those of one line that stand on each other are one wall."""
        kinds: dict[tuple[int, int], FrameMember] = {}
        for i in range(1, len(self.bays) + 2):
            stated = wall_spans[min(i, len(wall_spans)) - 1] if wall_spans else 0.0
            for low, high in self._runs(i):
                levels = range(low, high + 1)
                sections: Any = [self.columns[i, k] for k in levels]
                foot = spans.get((i, low), ((0.0, 0.0),))[0][0] if low == 1 else 0.0
                loads = [load[i, k] for k in levels]
                heights = [self.storeys[k - 1] for k in levels]
                try:
                    made = wall_members(
                        sections, heights, axial_loads=loads, shear_span=stated or foot or None
                    )
                except InputError as error:
                    raise InputError(f"frame: the wall of line {i}: {error}") from None
                kinds |= {(i, k): kind for k, kind in zip(levels, made, strict=True)}
        return kinds

    def _runs(self, i: int) -> list[tuple[int, int]]:
        """Return the lowest and highest storey of each wall of a line."""
        runs: list[tuple[int, int]] = []
        for k in range(1, len(self.storeys) + 1):
            if not isinstance(self.columns[i, k], WallSection):
                continue
            if runs and runs[-1][1] == k - 1:
                runs[-1] = runs[-1][0], k
            else:
                runs.append((k, k))
        return runs

    def wall_at(self, i: int, k: int) -> WallSection | None:
        """Return the longer wall that goes through a node."""
        walls = [self.columns.get((i, level)) for level in (k, k + 1)]
        sections = [section for section in walls if isinstance(section, WallSection)]
        return max(sections, key=lambda section: section.length, default=None)

    def infilled(self, cells: Mapping[tuple[int, int], Infill | None]) -> list[InfilledBay]:
        """Return the infills in their places."""
        bays = []
        self.check_places("infills", cells, len(self.bays))
        for (i, k), beam in self.beams.items():
            infill = at_place(cells, i, k)
            if infill is None:
                continue
            where = f"frame: the infill in bay {i}, storey {k}"
            sides = self.columns[i, k], self.columns[i + 1, k]
            if beam is None or None in sides:
                missing = "beam above it" if beam is None else "column beside it"
                raise InputError(f"{where} has no {missing}; give None in its place")
            run, rise = self.bays[i - 1], self.storeys[k - 1]
            length = run - sum(_half_depth(cell, beam, end) for end, cell in enumerate(sides))
            height = rise - _half_depth(beam, sides[0], 1)
            height -= _half_depth(self.beams.get((i, k - 1)), sides[0], 0) if k > 1 else 0.0
            if not (length > 0.0 and height > 0.0):
                raise InputError(f"{where} has no place between columns and beams")
            bay = InfilledBay(infill, i, k, length, height, run, rise)
            try:
                bay.infill.opening_factor(length, height)
            except InputError as error:
                raise InputError(f"{where}: {error}") from None
            bays.append(bay)
        return bays

    def around(self, i: int, k: int) -> tuple[list[Any], list[Any]]:
        """Return the columns below and above a node, and the beams on its left and right."""
        columns = [self.columns.get((i, k)), self.columns.get((i, k + 1))]
        beams = [self.beams.get((i - 1, k)), self.beams.get((i, k))]
        return columns, beams

    def _ends(
        self, drawing: FrameDrawing, load: dict[tuple[int, int], float], i: int, k: int
    ) -> tuple[float, float]:
        """Return the rigid lengths of columns and beams in a node [m]."""
        places = [(i, k), (i, k + 1)]
        columns = [(self.columns[at], load[at]) for at in places if is_drawn(self.columns.get(at))]
        left, right = self.beams.get((i - 1, k)), self.beams.get((i, k))
        beams = [halves_of(left)[1]] if is_drawn(left) else []
        beams += [halves_of(right)[0]] if is_drawn(right) else []
        wall = self.wall_at(i, k)
        if wall is not None:
            # It goes on through the floor, and beams reach its face.
            return 0.0, 0.5 * wall.length
        if not columns or not beams:
            return 0.0, 0.0
        # The half of a column that ends in the node.
        parts = [halves_of(cell)[j == 0] for j, (cell, _) in enumerate(columns)]
        try:
            return rigid_ends(parts, beams, axial_load=[n for _, n in columns], share=drawing.ends)
        except InputError as error:
            raise InputError(f"frame: node N-{i}-{k}: {error}") from None

    def panels(self, drawing: FrameDrawing) -> dict[str, Any]:
        """Return the springs in the panels of the nodes."""
        springs: dict[str, Any] = {}
        hoops = drawing.panel_hoops
        if hoops is None:
            return springs
        if hoops != "none":
            _arguments.instance(hoops, "frame: panel_hoops", Ties, 'or "none"')
        for i, k in self.columns:
            columns, beams = (
                [cell for cell in several if is_drawn(cell)] for several in self.around(i, k)
            )
            if not columns or not beams or self.wall_at(i, k) is not None:
                continue
            column = halves_of(columns[0])[0]
            beam = max((halves_of(cell)[0] for cell in beams), key=lambda cell: cell.depth)
            if not (
                isinstance(column, RectangularSection) and isinstance(beam, RectangularSection)
            ):
                raise InputError(f"frame: panel_hoops: node N-{i}-{k} is not of rectangles")
            going = len(columns) + len(beams)
            kind: PanelClass = "interior" if going == 4 else "knee" if going == 2 else "exterior"
            ties = None if hoops == "none" else hoops
            springs[f"N-{i}-{k}"] = JointPanel(column, beam, kind, hoops=ties).spring()
        return springs


def halves_of(cell: Any) -> Halves:
    """Return the sections of the two halves of a member."""
    return cell if isinstance(cell, tuple) else (cell, cell)


def is_drawn(cell: Any) -> bool:
    """Return whether a cell has sections."""
    return cell is not None and not isinstance(cell, FrameMember)


def _has_sides(section: Section) -> bool:
    """Return whether the bars on the two sides are unlike, as those of a beam."""
    sides = section.tension_steel, section.mirrored.tension_steel
    return max(sides) > _MORE_BELOW * min(sides)


def _is_slim(section: Section) -> bool:
    """Return whether a section is as slim as those of beams."""
    return section.depth > _SLIM * section.width


def _half_depth(cell: Any, other: Any, end: int) -> float:
    """Return half the depth of a member [m]; of a FrameMember, the rigid end of the other."""
    if is_drawn(cell):
        return 0.25 * sum(part.depth for part in halves_of(cell))
    rigid = other.rigid_end if cell is not None and isinstance(other, FrameMember) else 0.0
    return float(rigid[end] if isinstance(rigid, tuple) else rigid)


def elastic_kind(cell: Any) -> FrameMember | None:
    """Return a member of the gross section, for the axial loads."""
    if not is_drawn(cell):
        return cell  # type: ignore[no-any-return]
    parts = halves_of(cell)
    modulus, inertia = parts[0].concrete_law["ec"], 0.5 * sum(part.inertia for part in parts)
    return FrameMember(modulus, 0.5 * sum(part.gross_area for part in parts), inertia)


def _kind(
    cell: Any,
    length: float,
    ends: tuple[float, float],
    load: float,
    span_load: float,
    where: Place,
    spans: tuple[Pair, Pair] | None = None,
) -> FrameMember | None:
    """Return the kind of a member: as it is given, or made of its section."""
    if not is_drawn(cell):
        return cell  # type: ignore[no-any-return]
    clear = length - sum(ends)
    if not clear > 0:
        raise InputError(
            f"frame: member {where.name} of {length:g} m has rigid ends of {sum(ends):g} m, and no "
            "length"
        )
    try:
        return _made(halves_of(cell), clear, load, span_load, spans, ends)
    except InputError as error:
        raise InputError(f"frame: member {where.name}: {error}") from None


@lru_cache(maxsize=1024)
def _made(
    sections: Halves,
    length: float,
    axial_load: float,
    load: float,
    spans: tuple[Pair, Pair] | None,
    ends: tuple[float, float],
) -> FrameMember:
    """Return the kind of a member; equal members are made once, but for their rigid ends."""
    made = member(sections, length, axial_load=axial_load, load=load, shear_spans=spans)
    return with_rigid_end(made, ends)
