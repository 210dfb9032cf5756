"""A grid in plan: the planar frames of its lines, their loads, and the masses of its floors."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array
from rbsdem.errors import InputError, each_told_once
from rbsdem.model.column import notes_off
from rbsdem.model.frame import (
    FrameMember,
    at_place,
    cells_of,
    check_places,
    groups_of_cells,
    groups_of_kinds,
    names_of,
)
from rbsdem.model.materials import Ties
from rbsdem.model.shape import Section
from rbsdem.model.wall import WallSection
from rbsdem.section.frame import FrameInPlan, drawings_of
from rbsdem.section.grid import (
    CONCRETE_WEIGHT,
    elastic_kind,
    halves_of,
    infill_groups,
    is_drawn,
    sections_of_wall,
    told_of_small,
)
from rbsdem.section.infill import Infill

Along = Literal["x", "y"]
Cells = dict[Any, Any]


class Line(NamedTuple):
    """A line of the grid: its direction, and its number from the origin."""

    along: Along
    number: int

    @property
    def name(self) -> str:
        """Name of its frame."""
        return f"{self.along}-{self.number}"


@dataclass(frozen=True)
class PlanDrawing:
    """What a building was drawn from: sections and loads of a grid in plan.

    Attributes
    ----------
    storeys, bays_x, bays_y : tuple of float
        Heights and widths [m].
    columns : dict
        By (line across x, line across y, storey), 0 for all.
    beams_x, beams_y, infills_x, infills_y : dict
        By (bay, line, storey), 0 for all.
    walls : dict
        Sections of all storeys or of each, by (direction, line, place).
    floor_load, live_load, edge_load : tuple of float
        Of each floor: on its panels [N/m2], and on the beams of the outer lines [N/m].
    live_share, self_weight, mass, floor_mass, eccentricity, ends, panel_hoops, base
        As of `rbsdem.Building.grid`.
    """

    storeys: tuple[float, ...]
    bays_x: tuple[float, ...]
    bays_y: tuple[float, ...]
    columns: Cells
    beams_x: Cells
    beams_y: Cells
    walls: dict[tuple[Along, int, int], tuple[WallSection, ...]] = field(default_factory=dict)
    infills_x: Cells = field(default_factory=dict)
    infills_y: Cells = field(default_factory=dict)
    floor_load: tuple[float, ...] = (0.0,)
    live_load: tuple[float, ...] = (0.0,)
    edge_load: tuple[float, ...] = (0.0,)
    live_share: float = 0.3
    self_weight: bool = False
    mass: Literal["from_loads"] | None = None
    floor_mass: tuple[float, ...] | None = None
    eccentricity: tuple[float, float] = (0.0, 0.0)
    ends: float | Literal["asce"] | None = None
    panel_hoops: Ties | Literal["none"] | None = None
    base: Literal["fixed", "pinned"] = "fixed"

    @classmethod
    def checked(cls, **drawn: Any) -> PlanDrawing:
        """Return the drawing of the arguments of `rbsdem.Building.grid`, which are checked."""
        sizes = {}
        for name in ("storeys", "bays_x", "bays_y"):
            values = _arguments.finite_vector(drawn[name], f"building: {name}", shape="1 or m")
            if not values.size or (values <= 0.0).any():
                raise InputError(
                    f"building: {name} = {_arguments.shown(drawn[name])} must be lengths above 0"
                )
            sizes[name] = tuple(values.tolist())
        floors = len(sizes["storeys"])
        lines = len(sizes["bays_x"]) + 1, len(sizes["bays_y"]) + 1
        made = drawn | sizes
        cells: list[tuple[Any, ...]] = [("columns", FrameMember, Section, *lines)]
        for along, bays, across in (("x", lines[0] - 1, lines[1]), ("y", lines[1] - 1, lines[0])):
            cells.append((f"beams_{along}", FrameMember, Section, bays, across))
            cells.append((f"infills_{along}", Infill, None, bays, across))
        for name, kind, halves, *most in cells:
            made[name] = cells_of(drawn[name], name, kind, *most, halves=halves)
            words = ("line_x", "line_y") if name == "columns" else ("bay", "line")
            check_places(made[name], name, (*words, "storey"), (*most, floors))
        made["walls"] = dict(_walls(drawn["walls"], lines, floors))
        for name, unit in (("floor_load", "N/m2"), ("live_load", "N/m2"), ("edge_load", "N/m")):
            made[name] = tuple(by_floor(drawn[name], floors, name, least=0.0)[:, 0].tolist())
            told_of_small(f"building: {name}", made[name], unit, f"6 k{unit} is 6e3")
        mass = drawn["floor_mass"]
        if mass is not None:
            masses = by_floor(mass, floors, "floor_mass", least=0.0)
            made["floor_mass"] = tuple(masses[:, 0].tolist())
        if drawn["mass"] is not None:
            _arguments.choice(drawn["mass"], "building: mass", ("from_loads",))
            if mass is not None:
                raise InputError("building: mass and floor_mass are given; give one of them")
        off = _arguments.finite_vector(drawn["eccentricity"], "building: eccentricity")
        if off.size != 2 or np.abs(off).max() >= 0.5:
            raise InputError(
                f"building: eccentricity = {_arguments.shown(drawn['eccentricity'])} must be two "
                "parts of the lengths along x and y, below a half: 5 per cent is 0.05"
            )
        made["eccentricity"] = tuple(off.tolist())
        made["live_share"] = _arguments.number(
            drawn["live_share"], "building: live_share", least=0.0, most=1.0
        )
        made["self_weight"] = _arguments.boolean(drawn["self_weight"], "building: self_weight")
        _arguments.choice(drawn["base"], "building: base", ("fixed", "pinned"))
        return cls(**made)

    @property
    def lines(self) -> list[Line]:
        """All lines, those along x first."""
        return [
            Line(along, number)
            for along in ("x", "y")
            for number in range(1, len(self.bays("y" if along == "x" else "x")) + 2)
        ]

    def bays(self, along: Along) -> tuple[float, ...]:
        """Return the widths of bays in a direction."""
        return self.bays_x if along == "x" else self.bays_y

    def places(self, along: Along) -> Array:
        """Return the places of the lines across a direction, from the first [m]."""
        return np.concatenate(([0.0], np.cumsum(self.bays(along))))

    def offset(self, line: Line) -> float:
        """Return the place of a line across its direction [m]."""
        return float(self.places("y" if line.along == "x" else "x")[line.number - 1])

    def beam(self, line: Line, bay: int, storey: int) -> Any:
        """Return what stands in a place of beams."""
        return at_place(getattr(self, f"beams_{line.along}"), bay, line.number, storey)

    def panel(self, i: int, j: int, floor: int) -> bool:
        """Return whether a floor has a panel in a bay along x and one along y.

        It has none beside a crossing of lines where nothing stands, as outside of a plan that is no
        rectangle.
        """
        if not (1 <= i <= len(self.bays_x) and 1 <= j <= len(self.bays_y)):
            return False
        return all(self._is_joined(at, to, floor) for at in (i, i + 1) for to in (j, j + 1))

    def _is_joined(self, i: int, j: int, floor: int) -> bool:
        """Return whether a column or a beam ends where two lines cross."""
        # The columns below and above the floor, then the beams on all four sides.
        storeys = range(floor, min(floor + 1, len(self.storeys)) + 1)
        if any(self.column(Line("x", j), i, k) is not None for k in storeys):
            return True
        crossing = ((Line("x", j), i), (Line("y", i), j))
        return any(
            self.beam(line, bay, floor) is not None
            for line, at in crossing
            for bay in (at - 1, at)
            if 1 <= bay <= len(self.bays(line.along))
        )

    def beside(self, line: Line, bay: int, floor: int) -> int:
        """Return how many panels a beam has beside it."""
        places = [(bay, line.number - 1), (bay, line.number)]
        if line.along == "y":
            places = [place[::-1] for place in places]
        return sum(self.panel(*place, floor) for place in places)

    def column(self, line: Line, place: int, storey: int) -> Any:
        """Return what stands in a place of columns, as it bends in the plane of a line.

        A wall bends in its own plane; across it it is a post between two pins.
        """
        across = Line("y" if line.along == "x" else "x", place)
        wall = self.walls.get((*line, place))
        if wall is not None:
            return wall[min(storey, len(wall)) - 1]
        wall = self.walls.get((*across, line.number))
        if wall is not None:
            kind = elastic_kind(wall[min(storey, len(wall)) - 1])
            return replace(kind, ends="pinned")  # type: ignore[type-var]
        at = (place, line.number) if line.along == "x" else (line.number, place)
        cell = at_place(self.columns, *at, storey)
        if not is_drawn(cell) or line.along == "x":
            return cell
        halves = tuple(half.turned for half in halves_of(cell))
        return halves if isinstance(cell, tuple) else halves[0]

    def cells(self, line: Line) -> tuple[Cells, Cells, Cells]:
        """Return columns, beams and infills of a line by place or bay and storey."""
        levels, bays = range(1, len(self.storeys) + 1), len(self.bays(line.along))
        infills = getattr(self, f"infills_{line.along}")
        columns = {(i, k): self.column(line, i, k) for k in levels for i in range(1, bays + 2)}
        beams = {(i, k): self.beam(line, i, k) for k in levels for i in range(1, bays + 1)}
        panels = {(i, k): at_place(infills, i, line.number, k) for i, k in beams if infills}
        return columns, beams, panels

    def weights(self) -> Weights:
        """Return the loads of beams and nodes, and the masses that they are of."""
        weights, heavy = Weights(self), CONCRETE_WEIGHT * self.self_weight
        for k, (dead, live) in enumerate(zip(self.floor_load, self.live_load, strict=True), 1):
            weights.put_panels(k, dead + self.live_share * live)
        for line in self.lines:
            columns, beams, _ = self.cells(line)
            for (i, k), beam in beams.items():
                at_edge = beam is not None and self.beside(line, i, k) == 1
                edge = self.edge_load[k - 1] if at_edge else 0.0
                weights.put_beam(line, i, k, edge + heavy * _area(beam))
            for (i, k), column in columns.items():
                # A column of two lines weighs in that along x.
                if line.along == "x" or isinstance(column, WallSection):
                    half = 0.5 * heavy * _area(column) * self.storeys[k - 1]
                    weights.put_column(line, i, k, half)
        return weights

    def groups(self, of_building: dict[str, Any]) -> _core.Statement:
        """Return the groups of a case file, with the keys of the building in `&frame`."""
        walls = [wall for storeys in self.walls.values() for wall in storeys]
        placed = [*self.columns.values(), *self.beams_x.values(), *self.beams_y.values(), *walls]
        drawn, sections, hoops = drawings_of(placed, self.panel_hoops)
        usual = {"ends": None, "base": "fixed", "mass": None, "self_weight": False}
        grid = {name: getattr(self, name) for name in ("storeys", "bays_x", "bays_y", *usual)}
        grid = {name: value for name, value in grid.items() if value != usual.get(name)}
        grid |= {
            f"eccentricity_{a}": e or None for a, e in zip("xy", self.eccentricity, strict=True)
        }
        grid |= {
            "panel_hoops": hoops,
            "live_share": self.live_share if any(self.live_load) else None,
        }
        parts: list[Any] = [("frame", grid | of_building)]
        keys = "mass", "floor_load", "edge_load", "live_floor_load"
        none = (0.0,) * len(self.storeys)
        loads = self.floor_mass or none, self.floor_load, self.edge_load, self.live_load
        for i, values in enumerate(zip(*loads, strict=True), 1):
            of_floor = {key: value or None for key, value in zip(keys, values, strict=True)}
            parts.append(("floor", {"floor": i} | of_floor))
        names = names_of([kind for kind in placed if isinstance(kind, FrameMember)])
        parts += groups_of_kinds(names, drawn)
        columns: list[tuple[dict[str, Any], Any]] = [
            ({"line_x": i or None, "line_y": j or None, "storey": k or None}, cell)
            for (i, j, k), cell in self.columns.items()
        ]
        for (way, line, place), several in self.walls.items():
            x, y = (place, line) if way == "x" else (line, place)
            for k, wall in enumerate(several, 1):
                storey = k if len(several) > 1 else None
                columns.append(({"along": way, "line_x": x, "line_y": y, "storey": storey}, wall))
        beams, panels = (
            [
                (
                    {"along": along, "bay": i or None, "of_line": j or None, "storey": k or None},
                    cell,
                )
                for along in ("x", "y")
                for (i, j, k), cell in getattr(self, f"{name}_{along}").items()
            ]
            for name in ("beams", "infills")
        )
        parts += groups_of_cells("column_of", columns, names, drawn)
        parts += groups_of_cells("beam_of", beams, names, drawn)
        return _core.joined(parts) + infill_groups(panels) + sections

    def building(self, cls: Any, more: Mapping[str, Any]) -> Any:
        """Return the building: its frames stand under the axial loads of the elastic one.

        Parameters
        ----------
        cls : type
            `rbsdem.Building`.
        more : mapping
            Its other arguments.
        """
        weights = self.weights()
        cells = {line: self.cells(line) for line in self.lines}
        # Posts alone are no frame.
        cells = {
            line: members
            for line, members in cells.items()
            if any(members[1].values())
            or any(kind is not None and not _is_post(kind) for kind in members[0].values())
        }
        at_ground = (
            kind for columns, _, _ in cells.values() for (_, k), kind in columns.items() if k == 1
        )
        if all(kind is None for kind in at_ground):
            raise InputError("building: nothing stands on the ground; give columns of storey 1")
        of_building = weights.masses() | {"names": [line.name for line in cells]}

        def assembled(drawn: bool, **about: Any) -> Any:
            """Return the building: elastic, or drawn under the axial loads of the elastic one."""
            frames = []
            for line, members in cells.items():
                try:
                    frame = self._frame(line, members, weights, axial if drawn else None)
                except InputError as error:
                    raise error.of(f"frame {line.name}") from None
                angle, arm = (
                    (0.0, -self.offset(line)) if line.along == "x" else (90.0, self.offset(line))
                )
                frames.append((frame, angle, arm, 0.0))
            return cls(frames, **of_building | about)

        axial: dict[str, float] = {}
        with notes_off():
            parts = assembled(False).parts
        axial = dict(zip(parts.members, parts.compression.tolist(), strict=True))
        with each_told_once():
            plan = self if of_building.keys().isdisjoint(more) else None
            return assembled(True, **more, plan=plan)

    def _frame(
        self,
        line: Line,
        cells: tuple[Cells, Cells, Cells],
        weights: Weights,
        axial: Mapping[str, float] | None,
    ) -> FrameInPlan:
        """Return the frame of a line: elastic, or of its sections under axial loads."""
        columns, beams, infills = cells
        more: dict[str, Any] = {"ends": self.ends, "panel_hoops": self.panel_hoops}
        if axial is None:
            columns, beams = (
                {at: elastic_kind(kind) for at, kind in placed.items()}
                for placed in (columns, beams)
            )
            more = {}
        else:
            start = f"{line.name}:"
            more["axial_loads"] = {
                name.removeprefix(start): load
                for name, load in axial.items()
                if name.startswith(start)
            }
            more["infills"] = infills or None
        loads = weights.beams[line]
        return FrameInPlan.grid(
            self.storeys, self.bays(line.along), columns=columns, beams=beams, base=self.base,
            dead_load=loads if loads.any() else 0.0, node_load=weights.nodes[line],
            diaphragm=True, **more,
        )  # fmt: skip


class Weights:
    """Loads of a grid in plan.

    Attributes
    ----------
    beams : dict of Line to ndarray, shape (storeys, bays)
        On the beams of each line [N/m].
    nodes : dict of Line to dict
        On the nodes of each line, by place and floor [N].
    """

    def __init__(self, drawing: PlanDrawing) -> None:
        self.drawing = drawing
        storeys = len(drawing.storeys)
        self.beams = {
            line: np.zeros((storeys, len(drawing.bays(line.along)))) for line in drawing.lines
        }
        self.nodes: dict[Line, dict[tuple[int, int], float]] = {one: {} for one in drawing.lines}
        #: Of each floor weights [N], x and y [m], and second moments about their own centres over
        #: the weights [m2].
        self.of_floor: list[list[tuple[float, float, float, float]]] = [[] for _ in range(storeys)]

    def put_panels(self, storey: int, load: float) -> None:
        """Put the load of a floor on its beams, by yield lines that bisect the corners of panels.

        The trapezoid or triangle of a beam becomes a uniform load of equal sum. A side without a
        beam leaves its part to the others.
        """
        d = self.drawing
        for i, j, (area, x, y, second) in self.panels(storey) if load else ():
            a, b = d.bays_x[i - 1], d.bays_y[j - 1]
            sides = [(Line("x", j), i, a), (Line("x", j + 1), i, a)]
            sides += [(Line("y", i), j, b), (Line("y", i + 1), j, b)]
            short, long = sorted((a, b))
            parts = [
                0.25 * short * (short if length <= short else 2.0 * long - short)
                for _, _, length in sides
            ]
            kept = [
                part if d.beam(line, bay, storey) is not None else 0.0
                for part, (line, bay, _) in zip(parts, sides, strict=True)
            ]
            if not any(kept):
                raise InputError(
                    f"building: the panel in bay {i} along x and bay {j} along y of floor "
                    f"{storey} has a load and no beam around it; give one of its beams"
                )
            for part, (line, bay, length) in zip(kept, sides, strict=True):
                share = part / sum(kept) * area
                self.beams[line][storey - 1, bay - 1] += load * share / length
            self.of_floor[storey - 1].append((load * area, x, y, second))

    def panels(self, storey: int) -> Iterator[tuple[int, int, tuple[float, float, float, float]]]:
        """Yield bays along x and y, and area, centre and second moment of the panels of a floor."""
        d = self.drawing
        for i, a in enumerate(d.bays_x, 1):
            for j, b in enumerate(d.bays_y, 1):
                if d.panel(i, j, storey):
                    centre = d.places("x")[i - 1] + 0.5 * a, d.places("y")[j - 1] + 0.5 * b
                    yield i, j, (a * b, *centre, (a**2 + b**2) / 12.0)

    def put_beam(self, line: Line, bay: int, storey: int, load: float) -> None:
        """Put a load on a beam [N/m]."""
        length = self.drawing.bays(line.along)[bay - 1]
        middle = self.drawing.places(line.along)[bay - 1] + 0.5 * length
        self.beams[line][storey - 1, bay - 1] += load
        if load:
            place = self._place(line, middle)
            self.of_floor[storey - 1].append((load * length, *place, length**2 / 12.0))

    def put_column(self, line: Line, place: int, storey: int, half: float) -> None:
        """Put half of the weight of a column on the floor above, and half on that below [N]."""
        at = self._place(line, self.drawing.places(line.along)[place - 1])
        for floor in (storey, storey - 1) if half else ():
            if floor > 0:
                loads = self.nodes[line]
                loads[place, floor] = loads.get((place, floor), 0.0) + half
                self.of_floor[floor - 1].append((half, *at, 0.0))

    def _place(self, line: Line, along: float) -> tuple[float, float]:
        """Return x and y of a place on a line, `along` from its start [m]."""
        place = float(along), self.drawing.offset(line)
        return place if line.along == "x" else place[::-1]

    def masses(self) -> dict[str, Any]:
        """Return masses, centres in plan and rotary inertia of the floors, as a building has them.

        With `mass` = "from_loads" the masses are those of the loads. Masses that are given are
        spread as the loads, or evenly over the panels of a floor without loads.
        """
        d = self.drawing
        lengths = np.array([sum(d.bays_x), sum(d.bays_y)])
        whole = (1.0, *(0.5 * lengths), (lengths**2).sum() / 12.0)
        table = np.empty((len(self.of_floor), 4))
        for i, weights in enumerate(self.of_floor):
            areas = [panel for _, _, panel in self.panels(i + 1)]
            weight, x, y, second = np.array(weights or areas or [whole]).T
            total = float(weight.sum())
            centre = np.array([weight @ x, weight @ y]) / total
            spread = weight @ (second + (x - centre[0]) ** 2 + (y - centre[1]) ** 2) / total
            mass = d.floor_mass[i] if d.floor_mass else 0.0
            if d.mass is not None:
                mass = total / STANDARD_GRAVITY if weights else 0.0
            table[i] = mass, *(centre + d.eccentricity * lengths), mass * spread
        return {"floor_mass": table[:, 0], "centres": table[:, 1:3], "inertia": table[:, 3]}


def _walls(
    walls: Any, lines: tuple[int, int], floors: int
) -> Iterator[tuple[tuple[Along, int, int], tuple[WallSection, ...]]]:
    """Yield the sections of walls by direction, line and place; one wall stands in a place."""
    taken: dict[tuple[int, int], Any] = {}
    for key, sections in _arguments.instance(walls or {}, "building: walls", dict).items():
        if not (isinstance(key, tuple) and len(key) == 3 and key[0] in ("x", "y")):
            raise InputError(
                f"building: walls: {_arguments.shown(key)} must be (direction, line, place), as "
                '("x", 2, 1): along x on the second line, at its first place'
            )
        along, line, place = key
        most = lines[::-1] if along == "x" else lines
        number = _arguments.integer(line, f"building: walls: {key}: line", least=1, most=most[0])
        at = _arguments.integer(place, f"building: walls: {key}: place", least=1, most=most[1])
        each = sections_of_wall(sections, floors, str(key))
        where = (at, number) if along == "x" else (number, at)
        if where in taken:
            raise InputError(
                f"building: walls: {key} and {taken[where]} are at one place; a wall with flanges "
                "is no planar one: move one of them"
            )
        taken[where] = key
        yield (along, number, at), each


def by_floor(numbers: Any, floors: int, name: str, width: int = 1, least: float = -np.inf) -> Array:
    """Return numbers or pairs of each floor, shape (floors, width)."""
    values = _arguments.finite_vector(numbers, f"building: {name}", shape="any")
    if values.size not in (width, width * floors) or (values < least).any():
        each = "a number" if width == 1 else "a pair"
        raise InputError(
            f"building: {name} = {_arguments.shown(numbers)} must be {each}, or one for each of "
            f"{floors} floors" + (", not below 0" if least == 0.0 else "")
        )
    return np.broadcast_to(values.reshape(-1, width), (floors, width))


def _is_post(kind: Any) -> bool:
    """Return whether a member stands for a wall across the plane, as a post between pins."""
    return isinstance(kind, FrameMember) and kind.ends == "pinned"


def _area(member: Any) -> float:
    """Return the area of the mean section of a member that is drawn; 0 of a FrameMember [m2]."""
    kind = elastic_kind(member)
    return float(kind.area) if kind is not None and is_drawn(member) else 0.0
