"""A section as drawn: its shape, concrete, bars and hoops, and what follows from them at once."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.errors import InputError
from rbsdem.section.diagram import Confinement
from rbsdem.section.materials import Concrete, Steel
from rbsdem.section.reinforcement import Bar, Layout, Spiral, Ties
from rbsdem.section.strips import Strips, cut

__all__ = ["DrawnSection"]

#: Shapes in the Fortran part, from 1.
_SHAPES = ("rectangle", "circle")

#: Kinds of transverse reinforcement in the Fortran part, from 0.
_KINDS = ("none", "ties", "spiral", "hoops")

_NO_STEEL = (1.0, 1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True)
class DrawnSection(ABC):
    """What a section of any shape is made of; `rbsdem.section.Section` adds what it can be asked.

    A new shape is a class with the abstract methods below, beside its type in `src/section`.
    """

    #: Name of the shape.
    shape: ClassVar[str]
    #: The transverse bars that this shape takes, for messages.
    hoops: ClassVar[str]

    @abstractmethod
    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        """Return the bars of a layout; `inset` is from the face to the edge of the bars [m]."""

    @property
    @abstractmethod
    def gross_area(self) -> float:
        """Area of the concrete outline [m2]."""

    @property
    @abstractmethod
    def effective_depth(self) -> float:
        """From the compression face to the centre of the bars in the half in tension [m]."""

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

    def _finish(
        self, width: float, depth: float, side_cover: float, transverse: Ties | Spiral | None
    ) -> None:
        """Set bars and bar diameter, and pack the section for the Fortran part, which checks it."""
        concrete, cover = self.concrete, self.cover
        if not isinstance(concrete, Concrete):
            raise InputError(f"section: concrete = {concrete!r} must be a Concrete")
        if not (isinstance(self.strips, int) and 10 <= self.strips <= 100_000):
            raise InputError(f"section: strips = {self.strips!r} must be from 10 to 100000")
        self._take_bars(cover, transverse)
        bars = self.bars
        steels = list(dict.fromkeys(steel for _, _, steel in bars))
        kind, tie_numbers = _transverse_numbers(transverse)
        places = [steels.index(steel) + 1 for _, _, steel in bars]
        codes = [_SHAPES.index(self.shape) + 1, kind, self.strips, len(steels), len(bars), *places]
        numbers = [width, depth, cover, side_cover, self.bar_diameter or 0.0]
        numbers += concrete.numbers() + tie_numbers
        for steel in steels:
            numbers += steel.numbers()
        numbers += [y for y, _, _ in bars] + [area for _, area, _ in bars]
        self._put("_codes", np.array(codes, dtype=np.int32))
        self._put("_numbers", np.array(numbers, dtype=np.float64))
        self._put("_figures", _core.check_section(self._packed))

    def _take_bars(self, cover: float, transverse: Ties | Spiral | None) -> None:
        """Set the bars, from list or layout, and the diameter of the outermost one in tension."""
        if self.layout is not None:
            if len(self.bars) > 0:
                raise InputError("section: give bars or layout, not both")
            if not isinstance(self.layout, Layout):
                raise InputError(f"section: layout = {self.layout!r} must be a Layout")
            inset = cover + (transverse.diameter if transverse else 0.0)
            self._put("bars", tuple(self._lay_out(self.layout, inset)))
            if self.bar_diameter is None:
                self._put("bar_diameter", self.layout.diameter)
        else:
            self._put("bars", tuple(_bar(bar, i) for i, bar in enumerate(self.bars, 1)))
        if self.bar_diameter is not None:
            value = _core.number(self.bar_diameter, "section: bar_diameter")
            self._put("bar_diameter", value)
        elif self.bars:
            area = max(self.bars, key=lambda bar: bar[0])[1]
            self._put("bar_diameter", math.sqrt(4.0 * max(area, 0.0) / math.pi))

    @property
    def _packed(self) -> tuple[Any, Any]:
        return self._codes, self._numbers

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
        return _core.axial_capacity(self._packed)

    @property
    def concrete_law(self) -> dict[str, float]:
        """Parameters of the law of the unconfined concrete: fc, ft, ec [Pa], eps0, n, decay."""
        names = ("fc", "ft", "ec", "eps0", "n", "decay")
        return dict(zip(names, self._figures[:6].tolist(), strict=True))

    @property
    def confinement(self) -> Confinement | None:
        """The confined core (Mander, Priestley, Park 1988); None without ties."""
        if self.ties is None:
            return None
        return Confinement(*self._figures[6:15].tolist())

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
            corners, and four more for each leg beyond two, up to the number of bars.
        round_core : bool, optional
            Whether the ties stand for a spiral around a round core.

        Returns
        -------
        Strips
            In order of y; in each strip core and cover have centroids of their own.
        """
        return cut(self, number, restrained, round_core)


def _bar(bar: Any, number: int) -> Bar:
    """Return an entry of `bars`, whose values must be numbers and a steel."""
    try:
        y, area, steel = bar
    except (TypeError, ValueError):
        raise InputError(f"section: bar {number} = {bar!r} must be (y, area, steel)") from None
    if not isinstance(steel, Steel):
        raise InputError(f"section: steel of bar {number} = {steel!r} must be a Steel")
    return (
        _core.number(y, f"section: y of bar {number}"),
        _core.number(area, f"section: area of bar {number}"),
        steel,
    )


def _transverse_numbers(ties: Ties | Spiral | None) -> tuple[int, list[float]]:
    """Return kind and numbers of the transverse bars."""
    if ties is None:
        return _KINDS.index("none"), [0.0, 0.0, 0.0, 0.0, *_NO_STEEL]
    sizes = [ties.diameter, ties.spacing, ties.legs, float(ties.legs_across or 0.0)]
    return _KINDS.index(ties.kind), sizes + ties.steel.numbers()
