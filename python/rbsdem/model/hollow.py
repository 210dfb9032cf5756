"""Hollow sections: a box and a ring.

Their hoops run around the outside and around the void, with the same cover at both. The walls
between them count as core, but not as confined: the inner hoops bow into the void.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import ClassVar

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.circular import CircularSection, _ring, segment
from rbsdem.model.rectangular import RectangularSection, _box
from rbsdem.model.reinforcement import Bar, Layout

__all__ = ["HollowCircularSection", "HollowRectangularSection"]


@dataclass(frozen=True)
class HollowRectangularSection(RectangularSection):
    """A rectangle with a rectangular void.

    Parameters
    ----------
    width, depth : float
        Width and depth; the depth is in the direction of loading [m].
    concrete : Concrete
        The concrete.
    bars : sequence of (y, area, steel), optional
        As for `RectangularSection`.
    layout : Layout, optional
        Bars along the outside, in place of `bars`.
    ties : Ties, optional
        Hoops and ties of the walls.
    cover, side_cover : float, optional
        Clear cover to the hoops, at the outside and at the void alike [m].
    bar_diameter : float, optional
        As for `RectangularSection`.
    strips : int, optional
        Number of strips over the depth.
    wall : float
        Thickness of the walls at the faces in tension and compression [m].
    side_wall : float, optional
        Thickness of the two webs, by default that of the walls [m].
    inner_layout : Layout, optional
        Bars around the void.

    Raises
    ------
    InputError
        With a line for every error.
    """

    shape: ClassVar[str] = "hollow_rectangle"
    hollow: ClassVar[bool] = True

    wall: float = field(kw_only=True)
    side_wall: float | None = field(default=None, kw_only=True)
    inner_layout: Layout | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        self._put("wall", _arguments.number(self.wall, "section: wall"))
        side = self.wall if self.side_wall is None else self.side_wall
        self._put("side_wall", _arguments.number(side, "section: side_wall"))
        super().__post_init__()

    def _finish(self) -> None:
        hoop = self.ties.diameter if self.ties is not None else 0.0
        _check_wall(self.wall, "wall", self.depth, "depth")
        _check_wall(self._web, "side_wall", self.width, "width")
        _check_cover(self.wall, self.cover, hoop)
        _check_cover(self._web, float(self.side_cover or 0.0), hoop)
        _check_inner(self.layout, self.inner_layout)
        super()._finish()

    @property
    def _web(self) -> float:
        return float(self.side_wall or 0.0)

    @property
    def web_width(self) -> float:
        """Width that carries shear, of both webs [m]."""
        return 2.0 * self._web

    def _sizes(self) -> dict[str, float]:
        return super()._sizes() | {"wall": self.wall, "side_wall": self._web}

    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        bars = super()._lay_out(layout, inset)
        if self.inner_layout is None:
            return bars
        # The bars around the void are those along the inside of a larger outline.
        around = self.depth - 2.0 * self.wall + 4.0 * inset + 2.0 * self.inner_layout.diameter
        return bars + self.inner_layout.rectangular(around, inset)

    def part(self, depth: float) -> tuple[float, float]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        Parameters
        ----------
        depth : float
            From that face [m].
        """
        area, first = super().part(depth)
        high = self.depth - 2.0 * self.wall
        reached = min(max(depth - self.wall, 0.0), high)
        void = reached * (self.width - self.web_width)
        return area - void, first - 0.5 * void * (reached - high)

    # ---- geometry for the figure -----------------------------------------------------------------

    def void(self, distance: float = 0.0) -> Array:
        """Return the corners of the void, or of the line around it.

        Parameters
        ----------
        distance : float, optional
            Of the line from the void [m].

        Returns
        -------
        ndarray, shape (4, 2)
            x and y [m].
        """
        half_width = 0.5 * self.width - self._web + distance
        return _box(half_width, 0.5 * self.depth - self.wall + distance)

    def inner_legs(self) -> list[Array]:
        """Return an empty list: the hoop around the void is drawn with it.

        Returns
        -------
        list of ndarray
            Empty.
        """
        return []

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return where bars stand: those of the layout outside, the others around the void.

        Parameters
        ----------
        bars : sequence of (y, diameter)
            Distance from mid-depth and diameter of each bar [m].

        Returns
        -------
        list of (x, y, diameter)
            The same bars [m].
        """
        outer = len(bars) if self.inner_layout is None else len(bars) - self.inner_layout.number
        placed = super().place_bars(bars[:outer])
        if outer == len(bars):
            return placed
        inset = float(self.side_cover or 0.0) + (self.ties.diameter if self.ties else 0.0)
        inner = RectangularSection(
            self.width - self.web_width + 4.0 * inset + 2.0 * bars[-1][1],
            self.depth,
            self.concrete,
            ties=self.ties,
            cover=self.cover,
            side_cover=self.side_cover,
        )
        return placed + inner.place_bars(bars[outer:])


@dataclass(frozen=True)
class HollowCircularSection(CircularSection):
    """A circle with a circular void.

    Parameters
    ----------
    diameter : float
        Diameter of the concrete [m].
    concrete : Concrete
        The concrete.
    bars : sequence of (y, area, steel), optional
        As for `RectangularSection`.
    layout : Layout, optional
        Bars along the outside, in place of `bars`.
    spiral : Spiral, optional
        Transverse bars.
    cover : float, optional
        Clear cover to the hoops, at the outside and at the void alike [m].
    bar_diameter : float, optional
        As for `RectangularSection`.
    strips : int, optional
        Number of strips over the depth.
    wall : float
        Thickness of the wall [m].
    inner_layout : Layout, optional
        Bars around the void.

    Raises
    ------
    InputError
        With a line for every error.
    """

    shape: ClassVar[str] = "hollow_circle"
    hollow: ClassVar[bool] = True

    wall: float = field(kw_only=True)
    inner_layout: Layout | None = field(default=None, kw_only=True)

    def __post_init__(self) -> None:
        self._put("wall", _arguments.number(self.wall, "section: wall"))
        super().__post_init__()

    def _finish(self) -> None:
        hoop = self.spiral.diameter if self.spiral is not None else 0.0
        _check_wall(self.wall, "wall", self.diameter, "diameter")
        _check_cover(self.wall, self.cover, hoop)
        _check_inner(self.layout, self.inner_layout)
        super()._finish()

    @property
    def web_width(self) -> float:
        """Width that carries shear, of both sides of the wall [m]."""
        return 2.0 * self.wall

    def _sizes(self) -> dict[str, float]:
        return super()._sizes() | {"wall": self.wall}

    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        bars = super()._lay_out(layout, inset)
        if self.inner_layout is None:
            return bars
        around = self.diameter - 2.0 * self.wall + 4.0 * inset + 2.0 * self.inner_layout.diameter
        return bars + self.inner_layout.circular(around, inset)

    def part(self, depth: float) -> tuple[float, float]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        Parameters
        ----------
        depth : float
            From that face [m].
        """
        area, first = super().part(depth)
        void, of_void = segment(0.5 * self.diameter - self.wall, depth - self.wall)
        return area - void, first - of_void

    # ---- geometry for the figure -----------------------------------------------------------------

    def void(self, distance: float = 0.0) -> Array:
        """Return the outline of the void, or the line around it.

        Parameters
        ----------
        distance : float, optional
            Of the line from the void [m].

        Returns
        -------
        ndarray, shape (n, 2)
            x and y [m].
        """
        return _ring(0.5 * self.diameter - self.wall + distance)

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return where bars stand: those of the layout outside, the others around the void.

        Parameters
        ----------
        bars : sequence of (y, diameter)
            Distance from mid-depth and diameter of each bar [m].

        Returns
        -------
        list of (x, y, diameter)
            The same bars [m].
        """
        outer = len(bars) if self.inner_layout is None else len(bars) - self.inner_layout.number
        return super().place_bars(bars[:outer]) + super().place_bars(bars[outer:])


def _check_wall(wall: float, name: str, size: float, what: str) -> None:
    if not 0.0 < 2.0 * wall < size:
        raise InputError(
            f"section: {name} = {wall:g} m must be above 0 and below half of the {what}, "
            f"{0.5 * size:g} m; a section without a void is solid"
        )


def _check_cover(wall: float, cover: float, hoop: float) -> None:
    if not 2.0 * (cover + hoop) < wall:
        raise InputError(
            f"section: cover = {cover:g} m on both sides and hoops of {hoop:g} m leave nothing of "
            f"a wall of {wall:g} m"
        )


def _check_inner(layout: Layout | None, inner: Layout | None) -> None:
    if not isinstance(inner, Layout | None):
        raise InputError(f"section: inner_layout = {inner!r} must be a Layout")
    if inner is not None and layout is None:
        raise InputError("section: inner_layout goes with layout; give the bars outside, too")
