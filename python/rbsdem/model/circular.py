"""Circular sections."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.materials import Concrete
from rbsdem.model.reinforcement import Bar, Layout, Spiral
from rbsdem.model.section import Section

__all__ = ["CircularSection"]


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

    Raises
    ------
    InputError
        With a line for every error.
    """

    shape: ClassVar[str] = "circle"
    hoops: ClassVar[str] = "a spiral"
    narrows: ClassVar[bool] = True

    diameter: float
    concrete: Concrete
    bars: Sequence[Bar] = ()
    layout: Layout | None = None
    spiral: Spiral | None = None
    cover: float = 0.0
    bar_diameter: float | None = None
    strips: int = 400

    def __post_init__(self) -> None:
        if not isinstance(self.spiral, Spiral | None):
            raise InputError(f"section: spiral = {self.spiral!r} must be a Spiral")
        for name in ("diameter", "cover"):
            self._put(name, _arguments.number(getattr(self, name), f"section: {name}"))
        self._finish()

    def _sizes(self) -> dict[str, float]:
        return {"diameter": self.diameter}

    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        return layout.circular(self.diameter, inset)

    @property
    def width(self) -> float:
        """The diameter [m]."""
        return self.diameter

    @property
    def depth(self) -> float:
        """The diameter [m]."""
        return self.diameter

    @property
    def side_cover(self) -> float:
        """The cover [m]."""
        return self.cover

    @property
    def ties(self) -> Spiral | None:
        """The spiral."""
        return self.spiral

    @property
    def effective_depth(self) -> float:
        """0.8 of the diameter [m] (ACI 318-19, 22.5.2.2)."""
        return 0.8 * self.diameter

    def part(self, depth: float) -> tuple[float, float]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        Parameters
        ----------
        depth : float
            From that face [m].
        """
        return segment(0.5 * self.diameter, depth)

    # ---- geometry for the figure -----------------------------------------------------------------

    def outline(self) -> Array:
        """Return the outline of the concrete.

        Returns
        -------
        ndarray, shape (n, 2)
            x and y [m].
        """
        return _ring(0.5 * self.diameter)

    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the closed line at a distance inside the outer edge of the spiral.

        Parameters
        ----------
        inset : float
            The distance [m].
        bend : float
            Not used: a circle has no corners.

        Returns
        -------
        ndarray, shape (n, 2)
            x and y [m].
        """
        return _ring(0.5 * self.diameter - self.cover - inset)

    def inner_legs(self) -> list[Array]:
        """Return an empty list: a spiral has no legs inside.

        Returns
        -------
        list of ndarray
            Empty.
        """
        return []

    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return where bars stand across the width: around the circle, left and right in turn.

        Parameters
        ----------
        bars : sequence of (y, diameter)
            Distance from mid-depth and diameter of each bar [m].

        Returns
        -------
        list of (x, y, diameter)
            The same bars [m].
        """
        radius = max((abs(y) for y, _ in bars), default=0.0)
        seen: dict[int, int] = {}
        placed = []
        for y, d in bars:
            level = round(1e3 * y)
            side = 1 if seen.setdefault(level, 0) % 2 == 0 else -1
            seen[level] += 1
            placed.append((side * math.sqrt(max(0.0, radius**2 - y**2)), y, d))
        return placed


def segment(radius: float, depth: float) -> tuple[float, float]:
    """Return area and first moment about the centre of the segment of a circle.

    Parameters
    ----------
    radius : float
        Of the circle [m].
    depth : float
        Of the segment, from the circle at y = -radius [m]; none below 0, all beyond the diameter.
    """
    angle = math.acos(min(max(1.0 - depth / radius, -1.0), 1.0))
    area = radius**2 * (angle - math.sin(angle) * math.cos(angle))
    return area, -2.0 / 3.0 * (radius * math.sin(angle)) ** 3


def _ring(radius: float) -> Array:
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])
