"""A section as drawn: its shape, concrete, bars and hoops, and what follows from them at once."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, ClassVar, Self

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.derived import Derived, given
from rbsdem.model.materials import Concrete, Steel
from rbsdem.model.reinforcement import Bar, Layout, Spiral, Ties
from rbsdem.section.diagram import Confinement
from rbsdem.section.strips import Strips, cut

__all__ = ["DrawnSection"]


class _LaidOut(tuple[Bar, ...]):
    """Bars that follow from a layout."""

    __slots__ = ()


@dataclass(frozen=True)
class DrawnSection(ABC):
    """What a section of any shape is made of; `Section` adds what it can be asked.

    A new shape is a class with the abstract methods below, beside its type in `src/section`.
    """

    #: Name of the shape.
    shape: ClassVar[str]
    #: The transverse bars that this shape takes, for messages.
    hoops: ClassVar[str]

    @abstractmethod
    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        """Return the bars of a layout; `inset` is from the face to the edge of the bars [m]."""

    @abstractmethod
    def _sizes(self) -> dict[str, float]:
        """Return the sizes of the shape, by the names of their keys [m]."""

    @property
    @abstractmethod
    def effective_depth(self) -> float:
        """From the compression face to the centre of the bars in the half in tension [m]."""

    #: Whether the width falls towards the extreme fibres.
    narrows: ClassVar[bool] = False
    #: Whether there is a void in the middle.
    hollow: ClassVar[bool] = False

    @abstractmethod
    def part(self, depth: float) -> tuple[float, float]:
        """Return area and first moment about mid-depth of the concrete near one face [m2, m3].

        `depth` is measured from the compression face, y = -depth of the section/2 [m].
        """

    @abstractmethod
    def outline(self) -> Array:
        """Return the outline of the concrete, a point a row: x and y [m]."""

    @abstractmethod
    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the closed line at `inset` inside the outer edge of the transverse bars [m]."""

    @abstractmethod
    def inner_legs(self) -> list[Array]:
        """Return the corners of each leg of the ties between the outer ones [m]."""

    @abstractmethod
    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return x, y and diameter of bars of which y and diameter are given [m]."""

    def _put(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _finish(self) -> None:
        """Set bars and bar diameter; state the section to the Fortran part, which checks it."""
        if not isinstance(self.concrete, Concrete):
            raise InputError(f"section: concrete = {self.concrete!r} must be a Concrete")
        self._put("strips", _arguments.whole(self.strips, "section: strips"))
        ties = self.ties
        self._take_bars(self.cover, ties)
        numbers = {
            steel: i for i, steel in enumerate(dict.fromkeys(bar[2] for bar in self.bars), 1)
        }
        if ties is not None:
            numbers.setdefault(ties.steel, len(numbers) + 1)
        given = {"cover": self.cover, "side_cover": self.side_cover, "strips": self.strips}
        diameter = self.bar_diameter if self.bars else None
        statement = _core.group(
            "section", {"shape": self.shape} | self._sizes() | given | {"bar_diameter": diameter}
        )
        statement += self.concrete.statement()
        for steel, number in numbers.items():
            statement += steel.statement(number)
        if self.bars:
            y, area, steels = zip(*self.bars, strict=True)
            bars = {"y": y, "area": area, "steel": [numbers[steel] for steel in steels]}
            statement += _core.group("bars", bars)
        if ties is not None:
            statement += ties.statement(numbers[ties.steel])
        self._put("_statement", statement)
        self._put("_figures", _core.check_section(statement))

    def _take_bars(self, cover: float, transverse: Ties | Spiral | None) -> None:
        """Set the bars, from list or layout, and their diameter."""
        if not isinstance(self.bars, Sequence):
            raise InputError(f"section: bars = {self.bars!r} must be a list of (y, area, Steel)")
        if self.layout is not None:
            # Those of a section that this one was made from by `dataclasses.replace` are laid anew.
            if len(self.bars) > 0 and not isinstance(self.bars, _LaidOut):
                raise InputError("section: give bars or layout, not both")
            if not isinstance(self.layout, Layout):
                raise InputError(f"section: layout = {self.layout!r} must be a Layout")
            inset = cover + (transverse.diameter if transverse else 0.0)
            self._put("bars", _LaidOut(self._lay_out(self.layout, inset)))
            follows: float | None = self.layout.diameter
        else:
            self._put("bars", tuple(_bar(bar, i) for i, bar in enumerate(self.bars, 1)))
            areas = [area for _, area, _ in self.bars if area > 0.0]
            diameters = [math.sqrt(4.0 * area / math.pi) for area in areas]
            follows = np.average(diameters, weights=areas) if areas else None
        diameter = given(self.bar_diameter)
        if diameter is not None:
            self._put("bar_diameter", _arguments.number(diameter, "section: bar_diameter"))
        else:
            self._put("bar_diameter", None if follows is None else Derived(follows))

    def drawing(self) -> _core.Statement:
        """Return the keys of the section as it was given, as groups of a case file."""
        layouts = {name: getattr(self, name, None) for name in ("layout", "inner_layout")}
        laid_out = [layout for layout in layouts.values() if layout is not None]
        steels = [steel for layout in laid_out for steel in layout.steels]
        bars = self.bars if self.layout is None else ()
        steels += [steel for _, _, steel in bars]
        if self.ties is not None:
            steels.append(self.ties.steel)
        numbers = {steel: i for i, steel in enumerate(dict.fromkeys(steels), 1)}
        values = ((field.name, getattr(self, field.name)) for field in fields(self))
        sizes = {name: given(value) for name, value in values if isinstance(value, int | float)}
        statement = _core.group("section", {"shape": self.shape} | sizes)
        statement += self.concrete.statement()
        for steel, number in numbers.items():
            statement += steel.statement(number)
        if bars:
            y, area, each = zip(*bars, strict=True)
            rows = {"y": y, "area": area, "steel": [numbers[steel] for steel in each]}
            statement += _core.group("bars", rows)
        for name, layout in layouts.items():
            if layout is not None:
                statement += layout.statement(name, numbers)
        if self.ties is not None:
            statement += self.ties.statement(numbers[self.ties.steel])
        return statement

    @property
    def turned(self) -> Self:
        """The section upside down: y > 0 is what was y < 0. Itself where that is the same."""
        turned = sorted(((-y, area, steel) for y, area, steel in self.bars), key=_place)
        pairs = zip(turned, sorted(self.bars, key=_place), strict=True)
        slack = 1e-9 * self.depth
        if all(abs(a[0] - b[0]) <= slack and a[1:] == b[1:] for a, b in pairs):
            return self
        layouts = {f.name: None for f in fields(self) if f.name.endswith("layout")}
        diameter = float(self.bar_diameter or 0.0)
        return replace(self, bars=turned, bar_diameter=diameter, **layouts)

    @property
    def symmetric(self) -> bool:
        """Whether the section is the same upside down."""
        return self.turned is self

    @property
    def web_width(self) -> float:
        """Width that carries shear [m]."""
        return self.width

    def void(self, distance: float = 0.0) -> Array:
        """Return a line around the void at a distance [m]; without points in a solid section."""
        del distance
        return np.empty((0, 2))

    @property
    def gross_area(self) -> float:
        """Area of the concrete outline [m2]."""
        return self._figures["area"]

    @property
    def steel_area(self) -> float:
        """Area of all longitudinal bars [m2]."""
        return sum(area for _, area, _ in self.bars)

    @property
    def steel_ratio(self) -> float:
        """Area of the longitudinal bars over the gross area."""
        return self.steel_area / self.gross_area

    @property
    def axial_capacity(self) -> tuple[float, float]:
        """Least (tension, negative) and largest axial load without bending or confinement [N]."""
        return _core.axial_capacity(self._statement, tension="bare", confined=False)[0]

    @property
    def concrete_law(self) -> dict[str, float]:
        """Parameters of the law of the unconfined concrete: fc, ft, ec [Pa], eps0, n, decay."""
        return {name: self._figures[name] for name in ("fc", "ft", "ec", "eps0", "n", "decay")}

    @property
    def confinement(self) -> Confinement | None:
        """The confined core (Mander, Priestley, Park 1988); None without ties."""
        if self.ties is None:
            return None
        return Confinement(**{f.name: self._figures[f.name] for f in fields(Confinement)})

    def cut(
        self, number: int, *, restrained: int | None = None, round_core: bool = False
    ) -> Strips:
        """Cut the section into strips of equal thickness across the direction of loading.

        Parameters
        ----------
        number : int
            Number of strips.
        restrained : int, optional
            Longitudinal bars that are held in a corner of a hoop or by a tie. By default the four
            corners, and four more for each leg beyond two (in proportion for a part of one), up to
            the number of bars.
        round_core : bool, optional
            Whether the ties stand for a spiral around a round core.

        Returns
        -------
        Strips
            In order of y; in each strip core and cover have centroids of their own.
        """
        return cut(self, number, restrained, round_core)


def _place(bar: Bar) -> tuple[float, float, float]:
    """Return by what bars are ordered; heights that differ by round-off are one."""
    y, area, steel = bar
    return round(y, 9), area, steel.fy


def _bar(bar: Any, number: int) -> Bar:
    """Return an entry of `bars`, whose values must be numbers and a steel."""
    try:
        y, area, steel = bar
    except (TypeError, ValueError):
        raise InputError(f"section: bar {number} = {bar!r} must be (y, area, steel)") from None
    if not isinstance(steel, Steel):
        raise InputError(f"section: steel of bar {number} = {steel!r} must be a Steel")
    return (
        _arguments.number(y, f"section: y of bar {number}"),
        _arguments.number(area, f"section: area of bar {number}"),
        steel,
    )
