"""Sections as drawn: shape, concrete, bars and transverse bars, and what follows from them at once.

Diagrams, strengths, springs and columns of sections stand in `rbsdem.section`.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, fields, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Derived, given
from rbsdem._types import Array, Self
from rbsdem.errors import InputError
from rbsdem.model.materials import (
    Bar,
    Bars,
    Concrete,
    Lap,
    Layout,
    Spiral,
    Steel,
    Ties,
    rows_of_bars,
)


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


class _LayoutBars(tuple[Bar, ...]):
    """Bars that follow from a layout or from rows, one by one."""

    __slots__ = ()


class _Fields:
    """Fields and properties that every shape has."""

    if TYPE_CHECKING:
        _statement: ClassVar[_core.Statement]
        _figures: ClassVar[dict[str, float]]
        concrete: Concrete
        bars: Sequence[Bar]
        layout: Layout | None
        inner_layout: Layout | None
        cover: float
        bar_diameter: float | None
        strips: int
        wall: float | None

        @property
        def side_cover(self) -> float | None: ...
        @property
        def ties(self) -> Ties | Spiral | None: ...
        @property
        def width(self) -> float: ...
        @property
        def depth(self) -> float: ...


@dataclass(frozen=True)
class Section(_Fields, ABC):
    """A section of any shape: concrete, bars, cover, transverse bars.

    A new shape is a class with the abstract methods below, beside its type in `src/section`.
    """

    #: The transverse bars that this shape takes, for messages.
    hoops: ClassVar[str]
    #: Whether the width falls towards the extreme fibres.
    narrows: ClassVar[bool] = False

    #: Name of the shape of a solid section.
    solid: ClassVar[str]

    @cached_property
    def shape(self) -> str:
        """Name of the shape."""
        return f"hollow_{self.solid}" if self.hollow else self.solid

    def __str__(self) -> str:
        """One line: shape, sizes in mm, strengths in MPa, bars, transverse bars, cover."""
        size = " x ".join(f"{1e3 * each:g}" for each in dict.fromkeys((self.width, self.depth)))
        if self.solid != "circle" and self.width == self.depth:
            size = f"{size} x {size}"
        steels = sorted({steel.fy / 1e6 for _, _, steel in self.bars})
        single = self.single_bars
        sizes = " and ".join(sorted({f"{1e3 * diameter:.3g}" for _, diameter in single}))
        hoops = "no ties"
        if self.ties is not None:
            hoops = (
                f"{type(self.ties).__name__.lower()} {1e3 * self.ties.diameter:.3g} mm at "
                f"{1e3 * self.ties.spacing:.3g} mm, {self.ties.steel.fy / 1e6:.4g} MPa"
            )
        lap: Lap | None = getattr(self, "lap", None)
        return (
            f"{self.shape.replace('_', ' ')} {size} mm, f'c {self.concrete.fc / 1e6:.4g} MPa, "
            f"{len(single)} bars of {sizes} mm ({100 * self.steel_ratio:.2f} %, "
            f"{' and '.join(f'{fy:.4g}' for fy in steels)} MPa), {hoops}, "
            f"cover {1e3 * self.cover:.3g} mm"
            + (f", lap {1e3 * lap.length:.3g} mm" if lap is not None else "")
        )

    @property
    def rows(self) -> list[tuple[str, Bars]]:
        """Rows of bars by their faces: "top", "bottom", "side"."""
        return []

    def _lay_out(self, inset: float) -> list[Bar]:
        """Return the bars of the layouts; `inset` is from the face to the edge of the bars [m]."""
        layout, inner = self.layout, self.inner_layout
        if layout is None:
            return []
        bars = layout.bars(self.solid, self.depth, inset)
        if inner is None:
            return bars
        # The bars around the void are those along the inside of a larger outline.
        around = self.depth - 2.0 * self._wall + 4.0 * inset + 2.0 * inner.diameter
        return bars + inner.bars(self.solid, around, inset)

    @abstractmethod
    def _sizes(self) -> dict[str, float]:
        """Return the sizes of the shape, by the names of their keys [m]."""

    def _turned(self) -> dict[str, Any]:
        """Return the sizes of the concrete that change when it is upside down."""
        return {}

    @cached_property
    def effective_depth(self) -> float:
        """From the compression face to the centre of the bars in the half in tension [m].

        Bars within a twentieth of the depth from its middle count in part, those at mid-depth or
        beyond not at all. 0.8 of the depth if there is no other bar.
        """
        parts = [
            (y, area, share)
            for y, area, _ in self.bars
            if (share := 2.0 * _share_in_tension(y, self.depth) - 1.0) > 0.0
        ]
        if not parts:
            return 0.8 * self.depth
        weight = sum(area * share for _, area, share in parts)
        centre = 0.5 * self.depth + sum(y * area * share for y, area, share in parts) / weight
        known = max(share for *_, share in parts)
        return known * centre + (1.0 - known) * 0.8 * self.depth

    @property
    @abstractmethod
    def web_width(self) -> float:
        """Width that carries shear: of a hollow section that of both webs [m]."""

    @abstractmethod
    def part(self, depth: Any) -> tuple[Any, Any]:
        """Return area and first moment about mid-depth of the concrete near one face [m2, m3].

        `depth` is measured from the compression face, y = -depth of the section/2 [m]; of an array
        of depths they are arrays.
        """

    @abstractmethod
    def outline(self) -> Array:
        """Return the outline of the concrete, a point a row: x and y [m]."""

    @property
    def side_cover(self) -> float | None:
        """The cover at the sides [m]: the cover, unless the shape has another."""
        return self.cover

    def void(self, distance: float = 0.0) -> Array:
        """Return a line around the void at a distance [m]; without points in a solid section."""
        del distance
        return _NO_LINE

    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the closed line at `inset` inside the outer edge of the transverse bars [m].

        `bend` is the radius of its corners [m]. Without points where hoops are legs alone.
        """
        del inset, bend
        return _NO_LINE

    def inner_legs(self) -> list[Array]:
        """Return the corners of each leg of the ties between the outer ones [m]."""
        return []

    @abstractmethod
    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return x, y and diameter of bars from their y and diameter [m]."""

    def _set_default(self, name: str, otherwise: float | None) -> None:
        """Set a size that follows from another unless it is given."""
        if given(getattr(self, name)) is None:
            _arguments.put(self, **{name: None if otherwise is None else Derived(otherwise)})

    def _check_wall(self, name: str, size: float, what: str, cover: float) -> None:
        """Refuse a wall that leaves no void, or that hoops with their cover fill."""
        wall, hoop = getattr(self, name), self.ties.diameter if self.ties else 0.0
        if not 0.0 < 2.0 * wall < size:
            raise InputError(
                f"section: {name} = {wall:g} m must be above 0 and below half of the {what}, "
                f"{0.5 * size:g} m; a section without a void is solid"
            )
        if not 2.0 * (cover + hoop) < wall:
            raise InputError(
                f"section: cover = {cover:g} m on both sides and hoops of {hoop:g} m leave nothing "
                f"of a wall of {wall:g} m"
            )

    def _finish(self) -> None:
        """Set bars and bar diameter; state the section to the Fortran part, which checks it."""
        if self.inner_layout is not None and self.layout is None:
            raise InputError("section: inner_layout goes with layout; give the bars outside, too")
        if self.inner_layout is not None and self.wall is None:
            raise InputError("section: inner_layout is around a void; give wall, or remove it")
        self._take_bars(self.cover, self.ties)
        sizes = {"cover": self.cover, "side_cover": self.side_cover, "strips": self.strips}
        sizes["bar_diameter"] = self.bar_diameter if self.bars else None
        _arguments.put(self, _statement=self._stated(self._sizes() | sizes, self.bars, {}))
        answer = _core.evaluate("check_section", self._statement)
        _arguments.put(self, _figures=_core.named("section", answer.values))

    def _take_bars(self, cover: float, transverse: Ties | Spiral | None) -> None:
        """Set the bars, from list or layout, and their diameter."""
        if not isinstance(self.bars, Sequence):
            raise InputError(f"section: bars = {self.bars!r} must be a list of (y, area, Steel)")
        laid = {"layout": self.layout is not None, "rows (top, bottom, side)": bool(self.rows)}
        # Those of a section that this one was made from by `dataclasses.replace` are laid anew.
        laid["bars"] = len(self.bars) > 0 and not self.laid_out
        ways = [name for name, there in laid.items() if there]
        if len(ways) > 1:
            raise InputError(f"section: give {' or '.join(reversed(ways))}, not both")
        if self.layout is not None or self.rows:
            inset = cover + (transverse.diameter if transverse else 0.0)
            _arguments.put(self, bars=_LayoutBars(self._lay_out(inset)))
        else:
            _arguments.put(self, bars=tuple(_bar(bar, i) for i, bar in enumerate(self.bars, 1)))
        if self.layout is not None:
            self._set_default("bar_diameter", self.layout.diameter)
            return
        areas = [area for _, area, _ in self.bars if area > 0.0]
        diameters = [math.sqrt(4.0 * area / math.pi) for area in areas]
        mean = np.average(diameters, weights=areas) if areas else None
        self._set_default("bar_diameter", mean)

    @property
    def laid_out(self) -> bool:
        """Whether `bars` follow from a layout or from rows, so that each entry is one bar."""
        return isinstance(self.bars, _LayoutBars)

    def drawing(self) -> _core.Statement:
        """Return the keys of the section as it was given, as groups of a case file."""
        layouts = {"layout": self.layout, "inner_layout": self.inner_layout}
        laid_out = {name: layout for name, layout in layouts.items() if layout is not None}
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        sizes = {name: given(value) for name, value in values if isinstance(value, int | float)}
        bars = () if self.laid_out else self.bars
        made = self._stated(sizes | self._sizes(), bars, laid_out)
        lap: Lap | None = getattr(self, "lap", None)
        return made if lap is None else made + lap.statement()

    def _stated(
        self, sizes: Mapping[str, Any], bars: Sequence[Bar], layouts: Mapping[str, Layout]
    ) -> _core.Statement:
        """Return the groups of sizes, concrete, steels, bars or layouts, and transverse bars."""
        rows = [] if bars else self.rows
        # Rows without a steel of their own are of the first.
        first: Steel | None = getattr(self, "steel", None)
        steels = [first] if rows and first is not None else []
        steels += [row.steel for _, row in rows if row.steel is not None]
        steels += [steel for layout in layouts.values() for steel in layout.steels]
        steels += [steel for _, _, steel in bars]
        steels += [] if self.ties is None else [self.ties.steel]
        numbers = {steel: i for i, steel in enumerate(dict.fromkeys(steels), 1)}
        parts = [_core.group("section", {"shape": self.shape, **sizes}), self.concrete.statement()]
        parts += [steel.statement(number) for steel, number in numbers.items()]
        if bars:
            y, area, each = zip(*bars, strict=True)
            places = {"y": y, "area": area, "steel": [numbers[steel] for steel in each]}
            parts.append(_core.group("bars", places))
        parts += [row.statement(face, numbers) for face, row in rows]
        parts += [layout.statement(name, numbers) for name, layout in layouts.items()]
        if self.ties is not None:
            parts.append(self.ties.statement(numbers[self.ties.steel]))
        return _core.joined(parts)

    @cached_property
    def hooped(self) -> tuple[float, float]:
        """Depths from the faces y < 0 and y > 0 within which hoops hold the bars [m]."""
        return 0.5 * self.depth, 0.5 * self.depth

    def lapped(self, steel: Steel) -> float:
        """Return the share of the yield stress of a steel that a lap of its bars develops."""
        del steel
        return 1.0

    @property
    def confines(self) -> bool:
        """Whether hoops confine a core."""
        return self.ties is not None

    @cached_property
    def hollow(self) -> bool:
        """Whether there is a void in the middle."""
        return self.wall is not None

    @cached_property
    def _wall(self) -> float:
        """Thickness of the walls at the faces y < 0 and y > 0 [m]; 0 of a solid section."""
        return float(self.wall or 0.0)

    @cached_property
    def mirrored(self) -> Self:
        """The section upside down: y > 0 is what was y < 0. Itself where that is the same."""
        mirrored = sorted(((-y, area, steel) for y, area, steel in self.bars), key=_by_height)
        pairs = zip(mirrored, sorted(self.bars, key=_by_height), strict=True)
        slack, turned = 1e-9 * self.depth, self._turned()
        if all(abs(a[0] - b[0]) <= slack and a[1:] == b[1:] for a, b in pairs):
            return replace(self, **turned) if turned else self
        diameter = float(self.bar_diameter or 0.0)
        if self.rows:
            return replace(self, **turned, **self._rows_turned())
        changes = turned | {"bars": mirrored, "bar_diameter": diameter}
        return replace(self, **changes | {"layout": None, "inner_layout": None})

    def _rows_turned(self) -> dict[str, Any]:
        """Return the rows of bars upside down."""
        return {}

    @property
    def turned(self) -> Section:
        """The section as it is loaded along its width. Itself where that is the same."""
        raise InputError(
            f"section: a {self.shape} has no other side to be loaded along; give a rectangle or a "
            "circle, or the frames of the two planes one by one"
        )

    @cached_property
    def symmetric(self) -> bool:
        """Whether the section is the same upside down."""
        return self.mirrored is self

    @cached_property
    def gross_area(self) -> float:
        """Area of the concrete outline [m2]."""
        return self._figures["area"]

    @cached_property
    def inertia(self) -> float:
        """Second moment of area of the concrete about its centroid [m4]."""
        return self._figures["inertia"]

    @cached_property
    def centroid(self) -> float:
        """Distance of the centroid of the concrete from mid-depth, along y [m]."""
        return self._figures["centroid"]

    @cached_property
    def shear_area(self) -> float:
        """Area that carries elastic shear [m2]."""
        return self._figures["shear_area"]

    @cached_property
    def tension_steel(self) -> float:
        """Bars in the half in tension, those at mid-depth with half of their area [m2].

        Bars within a twentieth of the depth from there count in proportion.
        """
        return sum(area * _share_in_tension(y, self.depth) for y, area, _ in self.bars)

    @cached_property
    def steel_area(self) -> float:
        """Area of all longitudinal bars [m2]."""
        return sum(area for _, area, _ in self.bars)

    @cached_property
    def yield_stress(self) -> float:
        """Largest yield stress of the longitudinal bars [Pa]."""
        return max(steel.fy for _, _, steel in self.bars)

    @property
    def single_bars(self) -> list[tuple[float, float]]:
        """The y and the diameter of every bar [m]; an entry of `bars` may be a row of several."""
        if self.laid_out:
            return [(y, 2.0 * math.sqrt(area / math.pi)) for y, area, _ in self.bars]
        bars = []
        for y, area, _ in self.bars:
            single = 0.25 * math.pi * (self.bar_diameter or 0.0) ** 2
            count = max(1, round(area / single)) if single > 0.0 else 1
            bars += [(y, 2.0 * math.sqrt(area / count / math.pi))] * count
        return bars

    @cached_property
    def steel_ratio(self) -> float:
        """Area of the longitudinal bars over the gross area."""
        return self.steel_area / self.gross_area

    @cached_property
    def axial_capacity(self) -> tuple[float, float]:
        """Least (tension, negative) and largest axial load without bending or confinement [N]."""
        return _core.axial_capacity(self._statement, tension="bare", confined=False)[0]

    @cached_property
    def concrete_law(self) -> dict[str, float]:
        """Parameters of the law of the unconfined concrete: fc, ft, ec [Pa], eps0, n, decay."""
        return {name: self._figures[name] for name in ("fc", "ft", "ec", "eps0", "n", "decay")}

    @property
    def confinement(self) -> Confinement | None:
        """The confined core (Mander, Priestley, Park 1988); None without hoops around it.

        Of a wall it is that of the boundary element at y < 0.
        """
        if not self._figures["ratio"] > 0.0:
            return None
        return Confinement(**{f.name: self._figures[f.name] for f in fields(Confinement)})


@dataclass(frozen=True)
class RectangularSection(Section):
    """A rectangular section.

    Parameters
    ----------
    width, depth : float
        Width and depth; the depth is in the direction of loading [m].
    concrete : Concrete
        The concrete.
    bars : sequence of (y, area, steel), optional
        Bars one by one: distance from mid-depth, upward positive [m], area [m2], `Steel`. A row
        of bars may be one entry if `bar_diameter` is given. y > 0 is up in a beam and on the left
        in a column of a frame; a positive curvature pulls it.
    layout : Layout, optional
        Bars by number and diameter along the four faces, in place of `bars`.
    ties : Ties, optional
        Transverse bars; they carry shear, and confine the core in analyses with `confined=True`.
    cover : float, optional
        Clear cover to the outer edge of the ties [m].
    side_cover : float, optional
        Clear cover at the faces along the depth, if it differs [m].
    bar_diameter : float, optional
        Diameter of the main bars [m], for the length of the hinge and the confinement. By default
        that of the layout, or the mean of round bars with the areas of `bars`, weighted by them.
    strips : int, optional
        Number of strips over the depth.
    wall : float, optional
        Thickness of the walls at the faces in tension and compression of a hollow section [m].
        Hoops run around the outside and around the void, with the same cover at both; the walls
        count as core, but not as confined: the inner hoops bow into the void.
    side_wall : float, optional
        Thickness of the two webs, by default that of the walls [m].
    inner_layout : Layout, optional
        Bars around the void; they go with `layout`.
    top, bottom : Bars or sequence of Bars, optional
        Rows of bars at the faces y > 0 and y < 0, the outer row first, in place of `bars`.
    side : Bars, optional
        Bars of each side, at equal distances between the outer rows above and below.
    steel : Steel, optional
        Steel of the rows.
    lap : Lap, optional
        Lap of the bars at the foot of a column; not in a column in double curvature.

    Raises
    ------
    InputError
        With a line for every error.

    Examples
    --------
    >>> steel = Steel(446e6, 702e6)
    >>> section = RectangularSection(
    ...     0.4,
    ...     0.4,
    ...     Concrete(46.5e6),
    ...     layout=Layout(12, 0.016, steel),
    ...     ties=Ties(0.007, 0.085, Steel(364e6, 521e6), legs=4),
    ...     cover=0.013,
    ... )
    >>> round(rbsdem.section.moment_curvature(section, 744e3, 0.01) / 1e3)
    260
    """

    hoops: ClassVar[str] = "ties"
    solid: ClassVar[str] = "rectangle"

    width: float
    depth: float
    concrete: Concrete
    bars: Sequence[Bar] = ()
    layout: Layout | None = None
    ties: Ties | None = None
    cover: float = 0.0
    side_cover: float | None = None
    bar_diameter: float | None = None
    strips: int = 400
    _: KW_ONLY
    wall: float | None = None
    side_wall: float | None = None
    inner_layout: Layout | None = None
    top: Bars | Sequence[Bars] = ()
    bottom: Bars | Sequence[Bars] = ()
    side: Bars | None = None
    steel: Steel | None = None
    lap: Lap | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "section")
        for face in ("top", "bottom"):
            _arguments.put(self, **{face: _rows(getattr(self, face), face)})
        self._set_default("side_cover", self.cover)
        self._check_rows()
        if self.wall is not None:
            self._set_default("side_wall", self.wall)
            self._check_wall("wall", self.depth, "depth", self.cover)
            self._check_wall("side_wall", self.width, "width", float(self.side_cover or 0.0))
        elif self.side_wall is not None:
            raise InputError("section: side_wall goes with wall; give the walls at the faces, too")
        self._finish()

    def _sizes(self) -> dict[str, float]:
        sizes = {"width": self.width, "depth": self.depth}
        return sizes | {"wall": self._wall, "side_wall": self._web} if self.hollow else sizes

    @property
    def _web(self) -> float:
        """Thickness of the walls at the sides [m]; 0 of a solid section."""
        return float(self.side_wall or 0.0)

    def lapped(self, steel: Steel) -> float:
        """Return the share of the yield stress of a steel that its lap develops."""
        if self.lap is None:
            return 1.0
        diameter = float(self.bar_diameter or 0.0)
        tie = self.ties.diameter if self.ties else 0.0
        axis = min(self.cover, float(self.side_cover or 0.0)) + tie + 0.5 * diameter
        developed = self.lap.developed(steel.fy, self.concrete.fc, diameter, axis)
        return float(min(1.25 * developed ** (2.0 / 3.0), 1.0))

    @property
    def rows(self) -> list[tuple[str, Bars]]:
        """Rows of bars by their faces: "top", "bottom", "side"."""
        several = [(face, row) for face in ("top", "bottom") for row in getattr(self, face)]
        return several if self.side is None else [*several, ("side", self.side)]

    def _rows_turned(self) -> dict[str, Any]:
        return {"top": self.bottom, "bottom": self.top}

    @cached_property
    def turned(self) -> Section:
        """The section as it is loaded along its width. Itself where that is the same."""
        if not self.shape.endswith("rectangle"):
            return super().turned
        other: dict[str, Any] = {
            "width": self.depth, "depth": self.width, "cover": self.side_cover,
            "side_cover": self.cover, "wall": self.side_wall, "side_wall": self.wall,
        }  # fmt: skip
        if self.ties is not None:
            across: Any = self.ties.legs_across
            other["ties"] = replace(self.ties, legs=across, legs_across=self.ties.legs)
        layouts = {"layout": self.layout, "inner_layout": self.inner_layout}
        for name, own in layouts.items():
            if own is not None and own.face is not None:
                # 2 face + 2 (bars of the other faces - 2) are all bars.
                other[name] = replace(own, face=own.number // 2 + 2 - own.face)
        if self.layout is None and self.bars:
            single = 0.25 * math.pi * float(self.bar_diameter or 0.0) ** 2
            steels = [
                steel
                for _, area, steel in self.bars
                for _ in range(1 if self.laid_out else max(1, round(area / single)))
            ]
            # Loaded along the width, what was x is y.
            other["bars"] = [
                (x, 0.25 * math.pi * d**2, steel)
                for (x, _, d), steel in zip(self.place_bars(self.single_bars), steels, strict=True)
            ]
            other |= {"top": (), "bottom": (), "side": None, "steel": None}
            other["bar_diameter"] = float(self.bar_diameter or 0.0)
        made = replace(self, **other)
        return self if made == self else made

    def _check_rows(self) -> None:
        """Refuse rows without a steel, a steel without rows, and rows wider than the section."""
        sizes = [row.steel is None for _, row in self.rows]
        if any(sizes) and self.steel is None:
            raise InputError("section: steel is missing; give that of the rows of bars")
        if self.steel is not None and not any(sizes):
            raise InputError(
                "section: steel is that of rows of bars (top, bottom, side), and none needs it; "
                "remove it"
            )
        tie = self.ties.diameter if self.ties else 0.0
        for face, row in self.rows:
            inside = self._width_at(face) - 2.0 * (float(self.side_cover or 0.0) + tie)
            if face != "side" and not row.number * row.diameter <= inside + 1e-9:
                raise InputError(
                    f"section: {face}: {row.number} bars of {row.diameter:g} m do not fit into a "
                    f"row of {inside:.4g} m; give several rows as a list"
                )

    def _width_at(self, face: str) -> float:
        """Return the width in which the bars of a face lie [m]."""
        del face
        return self.width

    def _lay_out(self, inset: float) -> list[Bar]:
        """Return the bars of the rows, or of the layouts if there are no rows.

        Those of "side" stand in pairs at equal distances between the innermost rows.
        """
        if not self.rows:
            return super()._lay_out(inset)
        half, side = 0.5 * self.depth, self.side
        top: Any = self.top
        bottom: Any = self.bottom
        above, high = rows_of_bars(top, half, inset, self.steel)
        below, low = rows_of_bars(bottom, -half, inset, self.steel)
        inner = high[-1] - 0.5 * top[-1].diameter if top else half
        other = low[-1] + 0.5 * bottom[-1].diameter if bottom else -half
        if inner < other:
            raise InputError(
                f"section: the rows of bars from the top reach down to y = {inner:.4g} m, and "
                f"those from the bottom up to {other:.4g} m; they must not meet",
                "section.top",
            )
        if side is None:
            return above + below
        edge = half - inset - 0.5 * side.diameter
        ends = max(high, default=edge), min(low, default=-edge)
        heights = np.linspace(*ends, side.number + 2)[1:-1].tolist()
        bars = replace(side, number=2 * side.number).at(0.0, self.steel)
        return above + [(heights[i // 2], *bar[1:]) for i, bar in enumerate(bars)] + below

    @property
    def web_width(self) -> float:
        """Width that carries shear: of a hollow section that of both webs [m]."""
        return 2.0 * self._web if self.hollow else self.width

    def part(self, depth: Any) -> tuple[Any, Any]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        `depth` is measured from that face [m].
        """
        area = self.width * depth
        first = 0.5 * area * (depth - self.depth)
        if not self.hollow:
            return area, first
        high = self.depth - 2.0 * self._wall
        reached = np.clip(depth - self._wall, 0.0, high)
        void = reached * (self.width - self.web_width)
        return area - void, first - 0.5 * void * (reached - high)

    def outline(self) -> Array:
        """Return the corners of the concrete, x and y [m]."""
        return _box(0.5 * self.width, 0.5 * self.depth)

    def void(self, distance: float = 0.0) -> Array:
        """Return the corners of the void, or of the line at a distance around it [m]."""
        if not self.hollow:
            return _NO_LINE
        half_width = 0.5 * self.width - self._web + distance
        return _box(half_width, 0.5 * self.depth - self._wall + distance)

    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the closed line at a distance inside the outer edge of the ties [m].

        `bend` is the radius of its corners [m].
        """
        half = np.array(
            [
                0.5 * self.width - float(self.side_cover or 0.0) - inset - bend,
                0.5 * self.depth - self.cover - inset - bend,
            ]
        )
        angle = np.linspace(0.0, 0.5 * np.pi, 16)
        corner = bend * np.column_stack([np.cos(angle), np.sin(angle)])
        turned = [corner, corner[:, ::-1] * [-1, 1], -corner, corner[:, ::-1] * [1, -1]]
        signs = [(1, 1), (-1, 1), (-1, -1), (1, -1)]
        return np.vstack([half * sign + arc for sign, arc in zip(signs, turned, strict=True)])

    def inner_legs(self) -> list[Array]:
        """Return the corners of each leg of the ties between the outer ones [m].

        A hollow section has none: the hoop around its void is drawn with it.
        """
        if self.ties is None or self.hollow:
            return []
        half_tie = 0.5 * self.ties.diameter
        b = 0.5 * self.width - float(self.side_cover or 0.0) - half_tie
        d = 0.5 * self.depth - self.cover - half_tie
        inset = half_tie + 0.5 * float(self.bar_diameter or 0.0)
        along = np.linspace(inset - b, b - inset, round(self.ties.legs))[1:-1]
        across = np.linspace(inset - d, d - inset, round(self.ties.legs_across or 0))[1:-1]
        legs = [_box(half_tie, d) + np.array([x, 0.0]) for x in along]
        return legs + [_box(b, half_tie) + np.array([0.0, y]) for y in across]

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return where bars stand across the width: in rows, equal distances apart.

        Parameters
        ----------
        bars : sequence of (y, diameter)
            Distance from mid-depth and diameter of each bar [m]: those of the layout outside first,
            then those around the void.

        Returns
        -------
        list of (x, y, diameter)
            The same bars [m].
        """
        inset = float(self.side_cover or 0.0) + (self.ties.diameter if self.ties else 0.0)
        outer = len(bars) - (self.inner_layout.number if self.inner_layout else 0)
        placed = _in_rows(bars[:outer], self.width - 2.0 * inset, self.bar_diameter)
        if outer < len(bars):
            around = self.width - self.web_width + 2.0 * (inset + bars[-1][1])
            placed += _in_rows(bars[outer:], around, None)
        return placed


@dataclass(frozen=True)
class TeeSection(RectangularSection):
    """A beam with a slab: a rectangular web with a flange at one face, by default above.

    Hoops, cover and `width` are those of the web; the flange is concrete outside the hoops. Bars of
    the slab are bars at their depth, as far as the flange is effective. An L-section, held upright
    by its slab, bends as a tee with the same flange.

    Parameters
    ----------
    width, depth, concrete, bars, layout, ties, cover, side_cover, bar_diameter, strips, top, \
    bottom, side, steel
        As for `RectangularSection`; the depth includes the flange.
    wall, side_wall, inner_layout
        Not for a tee.
    flange_width : float
        Effective width of the flange with that of the web [m]: `rbsdem.section.flange_width`.
    flange_thickness : float
        Thickness of the flange [m].
    flange_below : bool, optional
        Whether the flange is at the face y < 0. By default it is above, at y > 0, which a positive
        curvature pulls: a beam with its slab then hogs. `mirrored` is the beam upside down.

    Raises
    ------
    InputError
        With a line for every error.

    Examples
    --------
    >>> steel = Steel(420e6, 620e6)
    >>> beam = rbsdem.frames.TeeSection(
    ...     0.3,
    ...     0.5,
    ...     Concrete(30e6),
    ...     bars=[(-0.2, 1e-3, steel), (0.2, 1e-3, steel), (0.19, 0.5e-3, steel)],
    ...     bar_diameter=0.016,
    ...     ties=Ties(0.008, 0.1, steel),
    ...     cover=0.03,
    ...     flange_width=1.2,
    ...     flange_thickness=0.12,
    ... )
    >>> print(f"{beam.gross_area:.3f} m2, centroid at {1e3 * beam.centroid:.1f} mm")
    0.258 m2, centroid at 79.5 mm
    """

    _: KW_ONLY
    flange_width: float
    flange_thickness: float
    flange_below: bool = False

    def __str__(self) -> str:
        """One line, as for other sections."""
        flange = f"{1e3 * self.flange_width:g} x {1e3 * self.flange_thickness:g}"
        return super().__str__().replace(" mm", f" mm with a flange of {flange} mm", 1)

    def _finish(self) -> None:
        """Check the flange, then do as every section."""
        if self.hollow:
            raise InputError("section: wall is not for a tee; remove it")
        if not self.flange_width >= self.width:
            raise InputError(
                f"section: flange_width = {self.flange_width:g} m must be at least the width of "
                f"the web, {self.width:g} m, which is part of it"
            )
        if not 0.0 < self.flange_thickness < self.depth:
            raise InputError(
                f"section: flange_thickness = {self.flange_thickness:g} m must be above 0 and "
                f"below the depth, {self.depth:g} m"
            )
        super()._finish()

    @cached_property
    def shape(self) -> str:
        """Name of the shape."""
        return "tee"

    def _width_at(self, face: str) -> float:
        """Return the width in which the bars of a face lie [m]: of the slab that of the flange."""
        slab = "bottom" if self.flange_below else "top"
        return self.flange_width if face == slab else self.width

    def _sizes(self) -> dict[str, float]:
        names = "flange_width", "flange_thickness", "flange_below"
        return super()._sizes() | {name: getattr(self, name) for name in names}

    def _turned(self) -> dict[str, Any]:
        """Return the flange at the other face, unless it is no wider than the web."""
        wider = self.flange_width > self.width
        return {"flange_below": not self.flange_below} if wider else {}

    def part(self, depth: Any) -> tuple[Any, Any]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        `depth` is measured from that face [m].
        """
        area, first = super().part(depth)
        face = 0.0 if self.flange_below else self.depth - self.flange_thickness
        reached = np.clip(depth - face, 0.0, self.flange_thickness)
        wings = reached * (self.flange_width - self.width)
        return area + wings, first + wings * (face + 0.5 * reached - 0.5 * self.depth)

    def outline(self) -> Array:
        """Return the corners of the concrete, x and y [m]."""
        web, wing, face = 0.5 * self.width, 0.5 * self.flange_width, 0.5 * self.depth
        inner = self.flange_thickness - face
        half = np.array([(web, face), (web, inner), (wing, inner), (wing, -face)])
        whole = np.vstack([half, half[::-1] * [-1, 1]])
        return whole if self.flange_below else whole * [1, -1]

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return where bars stand across the width: those of the slab along the flange.

        They are those at the depth of the flange that would fill more than half of the web.
        """

        def in_slab(bar: tuple[float, float]) -> bool:
            """Return whether a bar is one of a row in the flange that is too wide for the web."""
            y = -bar[0] if self.flange_below else bar[0]
            beside = sum(d for other, d in bars if abs(other - bar[0]) < 1e-6)
            return y > 0.5 * self.depth - self.flange_thickness and beside > 0.5 * self.width

        slab = [bar for bar in bars if in_slab(bar)]
        placed = super().place_bars([bar for bar in bars if bar not in slab])
        across = self.flange_width - 2.0 * float(self.side_cover or 0.0)
        return placed + _in_rows(slab, across, self.bar_diameter)


@dataclass(frozen=True)
class CircularSection(Section):
    """A circular section.

    Parameters
    ----------
    diameter : float
        Diameter of the concrete [m].
    concrete : Concrete
        The concrete.
    bars : sequence of (y, area, steel), optional
        As for `RectangularSection`.
    layout : Layout, optional
        Bars around the circle, the first at the tension face, in place of `bars`.
    spiral : Spiral, optional
        Transverse bars.
    cover : float, optional
        Clear cover to the outer edge of the spiral [m].
    bar_diameter : float, optional
        As for `RectangularSection`.
    strips : int, optional
        Number of strips over the depth.
    wall : float, optional
        Thickness of the wall of a hollow section [m], as for `RectangularSection`.
    inner_layout : Layout, optional
        Bars around the void; they go with `layout`.

    Raises
    ------
    InputError
        With a line for every error.
    """

    hoops: ClassVar[str] = "a spiral"
    solid: ClassVar[str] = "circle"
    narrows: ClassVar[bool] = True

    diameter: float
    concrete: Concrete
    bars: Sequence[Bar] = ()
    layout: Layout | None = None
    spiral: Spiral | None = None
    cover: float = 0.0
    bar_diameter: float | None = None
    strips: int = 400
    _: KW_ONLY
    wall: float | None = None
    inner_layout: Layout | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "section")
        if self.wall is not None:
            self._check_wall("wall", self.diameter, "diameter", self.cover)
        self._finish()

    def _sizes(self) -> dict[str, float]:
        sizes = {"diameter": self.diameter}
        return sizes | {"wall": self._wall} if self.hollow else sizes

    @property
    def width(self) -> float:
        """The diameter [m]."""
        return self.diameter

    @property
    def depth(self) -> float:
        """The diameter [m]."""
        return self.diameter

    @property
    def turned(self) -> Section:
        """The section as it is loaded along its width, which is the same."""
        return self

    @property
    def ties(self) -> Spiral | None:
        """The spiral."""
        return self.spiral

    @property
    def effective_depth(self) -> float:
        """0.8 of the diameter [m] (ACI 318-19, 22.5.2.2)."""
        return 0.8 * self.diameter

    @property
    def web_width(self) -> float:
        """Width that carries shear: of a hollow section that of both sides of the wall [m]."""
        return 2.0 * self._wall if self.hollow else self.diameter

    def part(self, depth: Any) -> tuple[Any, Any]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        `depth` is measured from that face [m].
        """
        area, first = _segment(0.5 * self.diameter, depth)
        if not self.hollow:
            return area, first
        void, of_void = _segment(0.5 * self.diameter - self._wall, depth - self._wall)
        return area - void, first - of_void

    def outline(self) -> Array:
        """Return the outline of the concrete, x and y [m]."""
        return _ring(0.5 * self.diameter)

    def void(self, distance: float = 0.0) -> Array:
        """Return the outline of the void, or the line at a distance around it [m]."""
        return _ring(0.5 * self.diameter - self._wall + distance) if self.hollow else _NO_LINE

    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the circle at a distance inside the outer edge of the spiral [m]."""
        del bend  # A circle has no corners.
        return _ring(0.5 * self.diameter - self.cover - inset)

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return where bars stand across the width: around the circle, left and right in turn.

        Parameters
        ----------
        bars : sequence of (y, diameter)
            Distance from mid-depth and diameter of each bar [m]: those of the layout outside first,
            then those around the void.

        Returns
        -------
        list of (x, y, diameter)
            The same bars [m].
        """
        outer = len(bars) - (self.inner_layout.number if self.inner_layout else 0)
        return _around(bars[:outer]) + _around(bars[outer:])


def checked_section(section: object) -> Section:
    """Return a section, or raise `InputError` with what makes one."""
    if isinstance(section, Section):
        return section
    raise InputError(
        f"section = {_arguments.shown(section)} must be a RectangularSection, a CircularSection or "
        "a WallSection"
    )


def _by_height(bar: Bar) -> tuple[int, float, float]:
    """Return by what bars are ordered; heights that differ by round-off are one."""
    y, area, steel = bar
    # `round` takes long.
    return math.floor(1e9 * y + 0.5), area, steel.fy


def _rows(bars: Any, face: str) -> tuple[Bars, ...]:
    """Return the rows of a face as a tuple; a single row may be given alone."""
    if bars is None or isinstance(bars, Bars):
        return () if bars is None else (bars,)
    rows = _arguments.several(bars, f"section: {face}", "rows of Bars")
    return tuple(
        _arguments.instance(row, f"section: {face}", Bars, "as Bars(4, 0.016)") for row in rows
    )


def _bar(bar: Any, number: int) -> Bar:
    """Return an entry of `bars`, whose values must be numbers and a steel."""
    try:
        y, area, steel = bar
    except (TypeError, ValueError):
        raise InputError(f"section: bar {number} = {bar!r} must be (y, area, steel)") from None
    return (
        _arguments.number(y, f"section: y of bar {number}"),
        _arguments.number(area, f"section: area of bar {number}"),
        _arguments.instance(steel, f"section: steel of bar {number}", Steel),
    )


#: Bars at mid-depth count half in tension; the others whole from this share of the depth on.
_MIDDLE = 0.05


def _share_in_tension(y: float, depth: float) -> float:
    """Return the share of a bar that counts in the half in tension, y > 0.

    From 0 to 1 in a straight line over a tenth of the depth around mid-depth, so that no strength
    jumps when a bar is moved.
    """
    return min(max(0.5 + 0.5 * y / (_MIDDLE * depth), 0.0), 1.0)


def _box(half_width: float, half_depth: float) -> Array:
    """Return the corners of a rectangle about the origin."""
    signs = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return signs * [half_width, half_depth]


#: The line around the void of a solid section: it has no points.
_NO_LINE: Array = np.empty((0, 2))


def _in_rows(
    bars: Sequence[tuple[float, float]], width: float, diameter: float | None
) -> list[tuple[float, float, float]]:
    """Return where bars stand in rows between ties that are `width` apart."""
    # Bars of other diameters belong to the same row: they touch the same tie.
    height = max(0.005, 0.6 * (diameter or 0.01))
    placed = []
    for level in dict.fromkeys(round(y / height) for y, _ in bars):
        row = [(y, d) for y, d in bars if round(y / height) == level]
        # The thickest stand in the corners.
        row.sort(key=lambda bar: bar[1])
        ends = row[-2:] if len(row) > 1 else []
        row = [*ends[:1], *row[: len(row) - len(ends)], *ends[1:]]
        edge = 0.5 * width - 0.5 * row[0][1]
        places = np.linspace(-edge, edge, len(row)) if len(row) > 1 else [0.0]
        placed += [(float(x), y, d) for x, (y, d) in zip(places, row, strict=True)]
    return placed


def _around(bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
    """Return where bars stand around a circle through the outermost ones."""
    radius = max((abs(y) for y, _ in bars), default=0.0)
    seen: dict[int, int] = {}
    placed = []
    for y, d in bars:
        level = round(1e3 * y)
        side = 1 if seen.setdefault(level, 0) % 2 == 0 else -1
        seen[level] += 1
        placed.append((side * math.sqrt(max(0.0, radius**2 - y**2)), y, d))
    return placed


def _segment(radius: float, depth: Any) -> tuple[Any, Any]:
    """Return area and first moment about the centre of the segment of a circle.

    `depth` [m] is that of the segment, from the circle at y = -radius; none below 0, all beyond the
    diameter.
    """
    angle = np.arccos(np.clip(1.0 - depth / radius, -1.0, 1.0))
    area = radius**2 * (angle - np.sin(angle) * np.cos(angle))
    return area, -2.0 / 3.0 * (radius * np.sin(angle)) ** 3


def _ring(radius: float) -> Array:
    """Return the points of a circle about the origin, x and y [m]."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])
