"""Walls as drawn: boundary elements with bars and hoops at the ends, meshes between them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import KW_ONLY, dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Derived, given
from rbsdem._types import Array, Self
from rbsdem.errors import InputError
from rbsdem.model.materials import (
    Bar,
    Bars,
    Concrete,
    Layout,
    Steel,
    Ties,
    _check_sizes,
    rows_of_bars,
)
from rbsdem.model.shape import Section, _bar, _box, _in_rows

#: Hoops farther apart than this many diameters of the bars hold neither bars nor concrete.
_FARTHEST = 16.0


@dataclass(frozen=True)
class Hoops:
    """Hoops around a boundary element.

    Parameters
    ----------
    diameter : float
        Of the bar [m].
    spacing : float
        From hoop to hoop along the height [m].
    steel : Steel
        Its `eps_u` is the strain of hoop fracture.
    legs_along, legs_across : float, optional
        Bars of a hoop, with its cross ties, parallel to the length of the wall and across it.

    Raises
    ------
    InputError
        If a number is refused.
    """

    diameter: float
    spacing: float
    steel: Steel
    legs_along: float = 2.0
    legs_across: float = 2.0

    def __post_init__(self) -> None:
        _arguments.convert(self, "hoops")
        _check_sizes(self, "hoops", diameter="m", spacing="m", legs_along="", legs_across="")


@dataclass(frozen=True)
class Curtain:
    """Bars of the web in one direction: a mesh near each face.

    Parameters
    ----------
    diameter : float
        Of the bars [m].
    spacing : float
        Between them [m]; those along the height share what is between the boundary elements in
        equal parts about as long, each with its bar in the middle.
    steel : Steel
        Their steel.
    faces : int, optional
        Meshes over the thickness, usually one near each face.

    Raises
    ------
    InputError
        If a number is refused.
    """

    diameter: float
    spacing: float
    steel: Steel
    faces: int = 2

    def __post_init__(self) -> None:
        _arguments.convert(self, "curtain")
        _check_sizes(self, "curtain", diameter="m", spacing="m", faces="")

    @property
    def area(self) -> float:
        """Area of the bars of all faces at one place [m2]."""
        return self.faces * 0.25 * math.pi * self.diameter**2

    def _group(self, direction: str, steel: int) -> _core.Statement:
        """Return its keys as a group of a case file; `steel` is the number of its steel."""
        values = {"diameter": self.diameter, "spacing": self.spacing, "faces": self.faces}
        return _core.group("curtain", {"direction": direction, **values, "steel": steel})


@dataclass(frozen=True)
class Boundary:
    """A boundary element at an end of a wall.

    Parameters
    ----------
    length : float
        Along the wall, from its end face [m].
    bars : Bars, sequence of Bars, or sequence of (x, area, steel)
        Rows of bars across the wall with their steel, the outer first: at equal distances from the
        hoop at the end face to that at the web, or at those that the rows state (`clear`); one
        `Bars` of more than two stands in rows of two. Or bars one by one: distance from the end
        face [m], area [m2], `Steel`; a row of bars may be one entry if `bar_diameter` is given.
    hoops : Hoops, optional
        Hoops around these bars; without them, or with hoops more than 16 diameters of the bars
        apart, the concrete is not confined.
    thickness : float, optional
        Across the wall, if it is thicker than the web: a barbell, or a flange of that width [m].
    bar_diameter : float, optional
        Diameter of the bars [m]; by default the mean of round bars with the areas of `bars`,
        weighted by them.

    Raises
    ------
    InputError
        If a value is refused.
    """

    length: float
    bars: Bars | Sequence[Bars] | Sequence[Bar] = ()
    hoops: Hoops | None = None
    thickness: float | None = None
    bar_diameter: float | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "boundary")
        _check_sizes(self, "boundary", length="m", thickness="m", bar_diameter="m")
        if isinstance(self.bars, Bars):
            # Bars given as one row stand in pairs, one bar near each face.
            row, two = self.bars, self.bars.number // 2
            each = [2] * two + [1] * (row.number % 2)
            rows = [replace(row, number=number) for number in each]
            _arguments.put(self, bars=tuple(rows))
        bars: Any = self.bars
        if self._in_rows:
            if any(row.steel is None for row in bars):
                raise InputError("boundary: the steel of its bars is missing; give it with Bars")
            return
        bars = tuple(_bar(bar, number) for number, bar in enumerate(bars, 1))
        beyond = max((x for x, _, _ in bars), default=0.0)
        if beyond > self.length or any(x < 0.0 for x, _, _ in bars):
            raise InputError(
                f"boundary: bars beyond its length: x = {beyond:g} m in {self.length:g} m; x is "
                "measured from the end face of the wall"
            )
        # To the nanometre, so that a case file gives them back to the last bit.
        bars = tuple((round(x, 9), area, steel) for x, area, steel in bars)
        _arguments.put(self, bars=bars)
        if given(self.bar_diameter) is None:
            # The mean diameter, weighted by the areas.
            areas = [area for _, area, _ in bars]
            mean = sum(area**1.5 for area in areas) / max(sum(areas), 1e-12)
            _arguments.put(self, bar_diameter=Derived(math.sqrt(4.0 / math.pi) * mean))

    @property
    def _in_rows(self) -> bool:
        """Whether its bars are rows, which get their places in a wall."""
        rows: Any = self.bars
        return bool(rows) and all(isinstance(row, Bars) for row in rows)

    @property
    def single(self) -> tuple[Bar, ...]:
        """Its bars one by one; none while they are rows, which get their places in a wall."""
        bars: Any = self.bars
        return () if self._in_rows else tuple(bars)

    def _laid(self, cover: float) -> Boundary:
        """Return the boundary element with its rows as bars one by one."""
        if not self._in_rows:
            return self
        rows: Any = self.bars
        tie = self.hoops.diameter if self.hoops else 0.0
        first = cover + tie + 0.5 * rows[0].diameter
        last = max(self.length - tie - 0.5 * rows[-1].diameter, first)
        places = np.linspace(first, last, len(rows)).tolist()
        if len(rows) == 1:
            places = [0.5 * (first + last)]
        if any(row.clear is not None for row in rows):
            # The face is at the end: x is how far it is from there.
            rows_from_end = rows_of_bars(rows, self.length, cover + tie, None)[1]
            places = [self.length - place for place in rows_from_end]
        bars = [
            (x, *bar[1:]) for x, row in zip(places, rows, strict=True) for bar in row.at(x, None)
        ]
        return replace(self, bars=bars)

    @property
    def confines(self) -> bool:
        """Whether its hoops are close enough to hold bars and concrete."""
        return self.hoops is not None and self.hoops.spacing <= _FARTHEST * float(
            self.bar_diameter or 0.0
        )

    def _group(self, side: str, numbers: dict[Steel, int], *, drawn: bool) -> _core.Statement:
        """Return its keys; hoops that do not confine are part of a drawing alone."""
        values = {
            "side": side, "length": self.length, "thickness": self.thickness,
            "bar_diameter": given(self.bar_diameter),
        }  # fmt: skip
        if self.hoops is not None and (drawn or self.confines):
            values |= {
                "hoop_diameter": self.hoops.diameter,
                "hoop_spacing": self.hoops.spacing,
                "legs_along": self.hoops.legs_along,
                "legs_across": self.hoops.legs_across,
                "steel": numbers[self.hoops.steel],
            }
        return _core.group("boundary", values)


@dataclass(frozen=True)
class WallSection(Section):
    """A wall: a web with a mesh of bars, and boundary elements at its ends.

    Parameters
    ----------
    length, thickness : float
        Along the loading, and of the web across it [m].
    concrete : Concrete
        The concrete.
    boundary : Boundary or pair of Boundary, optional
        Boundary elements: the same at both ends, or those at y < 0 and at y > 0.
    vertical : Curtain or None
        Bars along the height between the boundary elements.
    horizontal : Curtain or None
        Bars along the length: they carry shear.
    cover : float, optional
        Clear cover to the outer edge of hoops and horizontal bars [m].

    Raises
    ------
    InputError
        With a line for every error.

    Examples
    --------
    >>> s = Steel(583e6, 747e6)
    >>> mesh = Steel(485e6, 535e6)
    >>> wall = rbsdem.WallSection(
    ...     2.0,
    ...     0.15,
    ...     Concrete(40.5e6),
    ...     boundary=rbsdem.Boundary(0.26, Bars(6, 0.010, s), rbsdem.Hoops(0.006, 0.075, mesh)),
    ...     vertical=rbsdem.Curtain(0.006, 0.126, mesh),
    ...     horizontal=rbsdem.Curtain(0.006, 0.15, mesh),
    ... )
    >>> round(rbsdem.section.moment_curvature(wall, 691e3, 0.01) / 1e3)
    1552
    """

    hoops: ClassVar[str] = "hoops in its boundary elements"
    solid: ClassVar[str] = "wall"
    #: As other sections have them; the bars of a wall are those of boundaries and meshes.
    layout: ClassVar[Layout | None] = None  # type: ignore[misc]
    inner_layout: ClassVar[Layout | None] = None  # type: ignore[misc]
    wall: ClassVar[float | None] = None  # type: ignore[misc]
    strips: ClassVar[int] = 400  # type: ignore[misc]

    length: float
    thickness: float
    concrete: Concrete
    _: KW_ONLY
    boundary: Boundary | tuple[Boundary, Boundary] | None = None
    vertical: Curtain | None
    horizontal: Curtain | None
    cover: float = 0.02

    def __post_init__(self) -> None:
        _arguments.convert(self, "wall")
        if isinstance(self.boundary, list):
            _arguments.put(self, boundary=tuple(self.boundary))
        if isinstance(self.boundary, tuple) and (
            len(self.boundary) != 2 or not all(isinstance(b, Boundary) for b in self.boundary)
        ):
            raise InputError(
                "wall: boundary must be a Boundary, or two of them, at y < 0 and y > 0"
            )
        if self.boundary is not None:
            laid = tuple(end._laid(self.cover) for end in self.ends if end)
            _arguments.put(self, boundary=laid if isinstance(self.boundary, tuple) else laid[0])
        diameters = [float(end.bar_diameter or 0.0) for end in self.ends if end]
        mesh = self.vertical.diameter if self.vertical else None
        _arguments.put(self, bar_diameter=max([*diameters, 0.0]) or mesh)
        placed = self._placed()
        _arguments.put(self, bars=tuple(bar[:3] for bar in placed))
        single = [(y, math.sqrt(4 * a / math.pi / n)) for y, a, _, n in placed for _ in range(n)]
        _arguments.put(self, _single=single)
        _arguments.put(self, _statement=self._groups(drawn=False))
        answer = _core.evaluate("check_section", self._statement)
        _arguments.put(self, _figures=_core.named("section", answer.values))

    def _placed(self) -> list[tuple[float, float, Steel, int]]:
        """Return y, area and steel of bars or rows of the mesh, and how many bars each is."""
        half = 0.5 * self.length
        placed: list[tuple[float, float, Steel, int]] = []
        lengths = [end.length if end else 0.0 for end in self.ends]
        for end, sign in zip(self.ends, (-1.0, 1.0), strict=True):
            if end is None:
                continue
            for x, area, steel in end.single:
                bar = 0.25 * math.pi * float(end.bar_diameter or 0.0) ** 2
                placed.append((sign * (half - x), area, steel, max(1, round(area / bar))))
        if self.vertical is None:
            return placed
        clear, middle = self.length - sum(lengths), 0.5 * (lengths[0] - lengths[1])
        number = round(clear / self.vertical.spacing)
        if number < 1 and clear >= 0.0:
            raise InputError(
                "curtain: no vertical bars between the boundaries; give vertical=None if there are "
                "none"
            )
        row = self.vertical.area, self.vertical.steel, self.vertical.faces
        # From the middle on, so that rows of a symmetric wall are symmetric to the last bit.
        places = (clear / number * 0.5 * (2 * i + 1 - number) for i in range(number))
        return placed + [(middle + y, *row) for y in places]

    def _groups(self, *, drawn: bool) -> _core.Statement:
        """Return the wall as groups: as it was drawn, or with all bars and with ties for shear."""
        ends: list[tuple[str, Boundary | None]] = list(
            zip(("start", "end"), self.ends, strict=True)
        )
        if not isinstance(self.boundary, tuple):
            ends = [("both", self.boundary)]
        meshes = {"vertical": self.vertical, "horizontal": self.horizontal}
        bars = self.bars
        if drawn:
            bars = self.bars[: sum(len(end.single) for end in self.ends if end)]
        steels = [steel for _, _, steel in bars]
        steels += [mesh.steel for mesh in meshes.values() if mesh]
        steels += [end.hoops.steel for _, end in ends if end and end.hoops]
        numbers = {steel: i for i, steel in enumerate(dict.fromkeys(steels), 1)}
        more = {"cover": self.cover, "bar_diameter": None if drawn else self.bar_diameter}
        parts = [_core.group("section", {"shape": "wall", **self._sizes(), **more})]
        parts.append(self.concrete.statement())
        parts += [steel.statement(number) for steel, number in numbers.items()]
        if bars:
            y, area, each = zip(*bars, strict=True)
            rows = {"y": y, "area": area, "steel": [numbers[steel] for steel in each]}
            parts.append(_core.group("bars", rows))
        for side, end in ends:
            if end is not None:
                parts.append(end._group(side, numbers, drawn=drawn))
        for direction, mesh in meshes.items():
            if drawn and mesh is not None:
                parts.append(mesh._group(direction, numbers[mesh.steel]))
        if self.ties is not None and not drawn:
            parts.append(self.ties.statement(numbers[self.ties.steel]))
        return _core.joined(parts)

    def drawing(self) -> _core.Statement:
        """Return the keys of the section as it was given, as groups of a case file."""
        return self._groups(drawn=True)

    def __str__(self) -> str:
        """One line, as for other sections."""
        text = super().__str__()
        for end, where in zip(self.ends, ("y < 0", "y > 0"), strict=True):
            if end is not None:
                hoops = f"hoops {1e3 * end.hoops.spacing:.3g} mm apart" if end.hoops else "no hoops"
                text += f", boundary of {1e3 * end.length:.4g} mm at {where} with {hoops}"
        return text

    def _sizes(self) -> dict[str, float]:
        return {"width": self.thickness, "depth": self.length}

    @property
    def ends(self) -> tuple[Boundary | None, Boundary | None]:
        """The boundary elements at y < 0 and at y > 0."""
        if isinstance(self.boundary, tuple):
            return self.boundary
        return self.boundary, self.boundary

    @cached_property
    def mirrored(self) -> Self:
        """The wall the other way round: y > 0 is what was y < 0. Itself where that is the same."""
        first, last = self.ends
        return self if first == last else replace(self, boundary=(last, first))  # type: ignore[arg-type]

    @property
    def hooped(self) -> tuple[float, float]:
        """Lengths from the end faces y < 0 and y > 0 within which hoops hold the bars [m]."""
        first, last = (end.length if end and end.confines else 0.0 for end in self.ends)
        return first, last

    def in_boundary(self, y: float) -> bool:
        """Return whether a place is in a boundary element; all of a wall without any is."""
        end = self.ends[y > 0]
        return end is None or abs(y) >= 0.5 * self.length - end.length - 1e-9

    @property
    def core_edges(self) -> tuple[float, float]:
        """Distances of the outer hoops from mid-length, at y < 0 and y > 0 [m]."""
        first, last = (
            0.5 * self.length - self.cover - (0.5 * end.hoops.diameter if end and end.hoops else 0)
            for end in self.ends
        )
        return first, last

    @property
    def confines(self) -> bool:
        """Whether hoops confine a core."""
        return any(end.confines for end in self.ends if end)

    @cached_property
    def ties(self) -> Ties | None:
        """The horizontal bars, which carry shear; they confine nothing."""
        mesh = self.horizontal
        if mesh is None:
            return None
        return Ties(mesh.diameter, mesh.spacing, mesh.steel, float(mesh.faces))

    @property
    def width(self) -> float:
        """Thickness of the web [m]."""
        return self.thickness

    @property
    def depth(self) -> float:
        """The length [m]."""
        return self.length

    @property
    def web_width(self) -> float:
        """Thickness of the web, which carries shear [m]."""
        return self.thickness

    @property
    def single_bars(self) -> list[tuple[float, float]]:
        """The y and the diameter of every bar [m]."""
        single: list[tuple[float, float]] = self.__dict__["_single"]
        return list(single)

    def _thicker(self) -> list[tuple[float, float]]:
        """Return length and thickness of what is at the ends y < 0 and y > 0 [m]."""
        return [
            (end.length, end.thickness or self.thickness) if end else (0.0, self.thickness)
            for end in self.ends
        ]

    def part(self, depth: Any) -> tuple[Any, Any]:
        """Return area and first moment about mid-length of the concrete near the end y < 0.

        `depth` is measured from that end [m].
        """
        (near, first), (far, last) = self._thicker()
        area = self.thickness * depth
        moment = 0.5 * area * (depth - self.length)
        for begin, size, thickness in ((0.0, near, first), (self.length - far, far, last)):
            reached = np.clip(depth - begin, 0.0, size)
            wings = reached * (thickness - self.thickness)
            area = area + wings
            moment = moment + wings * (begin + 0.5 * reached - 0.5 * self.length)
        return area, moment

    def outline(self) -> Array:
        """Return the corners of the concrete, x and y [m]."""
        (near, first), (far, last) = self._thicker()
        half, web = 0.5 * self.length, 0.5 * self.thickness
        right = [(0.5 * last, half)]
        if last > self.thickness:
            right += [(0.5 * last, half - far), (web, half - far)]
        if first > self.thickness:
            right += [(web, near - half), (0.5 * first, near - half)]
        side = np.array([*right, (0.5 * first, -half)])
        return np.vstack([side, side[::-1] * [-1, 1]])

    def inner_legs(self) -> list[Array]:
        """Return the corners of each leg of boundary hoops, and of the horizontal bars [m]."""
        legs = []
        for end, sign, (length, thickness) in zip(
            self.ends, (-1.0, 1.0), self._thicker(), strict=True
        ):
            if end is None or end.hoops is None:
                continue
            thick = 0.5 * end.hoops.diameter
            b = 0.5 * thickness - self.cover - thick
            d = 0.5 * (length - self.cover) - thick
            middle = sign * (0.5 * self.length - self.cover - thick - d)
            along = np.linspace(-b, b, max(2, round(end.hoops.legs_along)))
            across = np.linspace(-d, d, max(2, round(end.hoops.legs_across)))
            legs += [_box(thick, d + thick) + np.array([x, middle]) for x in along]
            legs += [_box(b + thick, thick) + np.array([0.0, middle + y]) for y in across]
        if self.horizontal is not None:
            thick, faces = 0.5 * self.horizontal.diameter, self.horizontal.faces
            b = 0.5 * self.thickness - self.cover - thick if faces > 1 else 0.0
            legs += [
                _box(thick, 0.5 * self.length - self.cover) + np.array([x, 0.0])
                for x in np.linspace(-b, b, faces)
            ]
        return legs

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return x, y and diameter of bars from their y and diameter, placed in rows [m]."""
        placed = []
        half, ends = 0.5 * self.length, self._thicker()
        for zone, thickness in ((-1, ends[0][1]), (0, self.thickness), (1, ends[1][1])):
            of_zone = [bar for bar in bars if _zone(bar[0], half, ends) == zone]
            end = self.ends[zone > 0] if zone else None
            tie = end.hoops.diameter if end and end.hoops else 0.0
            if zone == 0 and self.horizontal is not None:
                tie = self.horizontal.diameter
            placed += _in_rows(of_zone, thickness - 2.0 * (self.cover + tie), self.bar_diameter)
        return placed


def _zone(y: float, half: float, ends: Sequence[tuple[float, float]]) -> int:
    """Return -1 or 1 for a bar in a boundary element at y < 0 or y > 0, else 0."""
    if y <= ends[0][0] - half:
        return -1
    return 1 if y >= half - ends[1][0] else 0
