"""Rectangular sections."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.derived import Derived, given
from rbsdem.model.materials import Concrete
from rbsdem.model.reinforcement import Bar, Layout, Ties, share_in_tension
from rbsdem.model.section import Section

__all__ = ["RectangularSection"]


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
        Bars one by one: distance from mid-depth, positive to the tension face [m], area [m2],
        `Steel`. A row of bars may be one entry if `bar_diameter` is given.
    layout : Layout, optional
        Bars by number and diameter, in place of `bars`.
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
    >>> round(section.moment_curvature(744e3, 0.01) / 1e3)
    260
    """

    shape: ClassVar[str] = "rectangle"
    hoops: ClassVar[str] = "ties"

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

    def __post_init__(self) -> None:
        if not isinstance(self.ties, Ties | None):
            raise InputError(f"section: ties = {self.ties!r} must be Ties")
        for name in ("width", "depth", "cover"):
            self._put(name, _arguments.number(getattr(self, name), f"section: {name}"))
        side = given(self.side_cover)
        if side is None:
            self._put("side_cover", Derived(self.cover))
        else:
            self._put("side_cover", _arguments.number(side, "section: side_cover"))
        self._finish()

    def _sizes(self) -> dict[str, float]:
        return {"width": self.width, "depth": self.depth}

    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        return layout.rectangular(self.depth, inset)

    @property
    def effective_depth(self) -> float:
        """From the compression face to the centre of the bars in the half in tension [m].

        Bars within a twentieth of the depth from its middle count in part, those at mid-depth or
        beyond not at all. 0.8 of the depth if there is no other bar.
        """
        parts = [
            (y, area, share)
            for y, area, _ in self.bars
            if (share := 2.0 * share_in_tension(y, self.depth) - 1.0) > 0.0
        ]
        if not parts:
            return 0.8 * self.depth
        weight = sum(area * share for _, area, share in parts)
        centre = 0.5 * self.depth + sum(y * area * share for y, area, share in parts) / weight
        known = max(share for *_, share in parts)
        return known * centre + (1.0 - known) * 0.8 * self.depth

    def part(self, depth: float) -> tuple[float, float]:
        """Return area and first moment about mid-depth of the concrete near the compression face.

        Parameters
        ----------
        depth : float
            From that face [m].
        """
        area = self.width * depth
        return area, 0.5 * area * (depth - self.depth)

    # ---- geometry for the figure -----------------------------------------------------------------

    def outline(self) -> Array:
        """Return the corners of the concrete.

        Returns
        -------
        ndarray, shape (4, 2)
            x and y [m].
        """
        return _box(0.5 * self.width, 0.5 * self.depth)

    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the closed line at a distance inside the outer edge of the ties.

        Parameters
        ----------
        inset : float
            The distance [m].
        bend : float
            Radius of the corners [m].

        Returns
        -------
        ndarray, shape (n, 2)
            x and y [m].
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
        """Return the legs of the ties between the outer ones.

        Returns
        -------
        list of ndarray, shape (4, 2)
            Corners of each leg [m].
        """
        if self.ties is None:
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
            Distance from mid-depth and diameter of each bar [m].

        Returns
        -------
        list of (x, y, diameter)
            The same bars [m].
        """
        # Bars of other diameters belong to the same row: they touch the same tie.
        height = max(0.005, 0.6 * (self.bar_diameter or 0.01))
        inner = self.width - 2.0 * float(self.side_cover or 0.0)
        inner -= 2.0 * self.ties.diameter if self.ties is not None else 0.0
        placed = []
        for level in dict.fromkeys(round(y / height) for y, _ in bars):
            row = [(y, d) for y, d in bars if round(y / height) == level]
            # The thickest stand in the corners.
            row.sort(key=lambda bar: bar[1])
            ends = row[-2:] if len(row) > 1 else []
            row = [*ends[:1], *row[: len(row) - len(ends)], *ends[1:]]
            edge = 0.5 * inner - 0.5 * row[0][1]
            places = np.linspace(-edge, edge, len(row)) if len(row) > 1 else [0.0]
            placed += [(float(x), y, d) for x, (y, d) in zip(places, row, strict=True)]
        return placed


def _box(half_width: float, half_depth: float) -> Array:
    """Return the corners of a rectangle about the origin."""
    signs = np.array([(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)])
    return signs * [half_width, half_depth]
