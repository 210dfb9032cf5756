"""Rotation and curvature of a plastic hinge in a result."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.checks.criteria import Criterion, criteria
from rbsdem.errors import InputError
from rbsdem.model.response import Response


@dataclass(frozen=True, eq=False, repr=False)
class Hinge:
    """What a joint turns, and how much of it is plastic.

    The plastic rotation is what lies beyond yield, as design rules limit it (ASCE 41-17, figure
    10-1; EN 1998-3, A.3.2.2): zero up to the yield rotation of that side.

    Attributes
    ----------
    joint : int
        The joint, from 1 at the ground.
    time : ndarray, shape (rows,)
        As in the result.
    rotation, moment : ndarray, shape (rows,)
        Rotation of the joint [rad] and its moment [N m].
    yield_rotation : tuple of float
        Rotation at yield to the positive and to the negative side, both positive [rad]; infinite
        where the joint does not yield. Of a layered joint it is that at which its first bar yields
        in this result.
    length : float or None
        Length of the hinge [m], over which the curvature is a mean; None if it is not known.
    ductility : float
        Largest rotation over that at yield of its side: of rotation and of curvature; on a static
        path between the rows too.
    """

    joint: int
    time: Array
    rotation: Array
    moment: Array
    yield_rotation: tuple[float, float]
    length: float | None
    ductility: float

    @property
    def plastic_rotation(self) -> Array:
        """Rotation beyond that at yield, with the sign of the rotation [rad], shape (rows,)."""
        limit = np.where(self.rotation >= 0, *self.yield_rotation)
        beyond: Array = np.maximum(np.abs(self.rotation) - limit, 0.0)
        return np.sign(self.rotation) * beyond

    @property
    def curvature(self) -> Array:
        """Mean curvature of the hinge, rotation over length [1/m], shape (rows,)."""
        return self.rotation / self._length

    @property
    def plastic_curvature(self) -> Array:
        """Plastic rotation over length [1/m], shape (rows,)."""
        return self.plastic_rotation / self._length

    @property
    def _length(self) -> float:
        if self.length is None:
            raise InputError(
                f"joint {self.joint} was not made from a section, and the length of its hinge is "
                "not known; give result.hinge(length=...)"
            )
        return self.length

    def __repr__(self) -> str:
        plastic = np.abs(self.plastic_rotation).max(initial=0.0)
        return (
            f"Hinge(joint {self.joint}, largest rotation "
            f"{np.abs(self.rotation).max(initial=0.0):.4g} rad, plastic {plastic:.4g} rad)"
        )


def hinge(result: Response, joint: int, length: float | None) -> Hinge:
    """Return the response of a hinge; see `Result.hinge`."""
    joint = _arguments.whole(joint, "joint")
    at = result.column.place_of(joint)
    if length is not None:
        length = _arguments.number(length, "length")
        if not 0 < length < math.inf:
            raise InputError(f"length = {length:g} m of the hinge must be above 0")
    else:
        gauge = result.column.gauge(joint)
        if gauge is not None:
            length = min(
                over for part, over in zip(gauge.part, gauge.length, strict=True) if part != "bar"
            )
    yields = [each for each in criteria(result.column, ["first_yield"]) if each.joint == joint]
    path = result.path
    turned = path.rotation[:, at]
    limits = _yield_rotation(path, turned, yields)
    return Hinge(
        joint,
        result.time,
        result.rotation[:, at],
        result.moment[:, at],
        limits,
        length,
        float((np.abs(turned) / np.where(turned >= 0, *limits)).max(initial=0.0)),
    )


def _yield_rotation(
    result: Response, rotation: Array, yields: list[Criterion]
) -> tuple[float, float]:
    """Return the rotations at yield to both sides."""
    if not any(criterion.opening for criterion in yields):
        positive, negative = (
            min((c.threshold for c in yields if side * c.rotation > 0), default=math.inf)
            for side in (1, -1)
        )
        return positive, negative
    result._check_openings()
    positive, negative = (
        _first(side * rotation, [c for c in yields if side * c.rotation >= 0], result)
        for side in (1, -1)
    )
    # A side that was never pushed to yield is taken to be like the other.
    return (
        positive if math.isfinite(positive) else negative,
        negative if math.isfinite(negative) else positive,
    )


def _first(turned: Array, yields: list[Criterion], result: Response) -> float:
    """Return the rotation at which one of the bars of a side yields first."""
    if not yields:
        return math.inf
    # How far each row is on the way to yield.
    reached = np.max([c.values(result) / c.threshold for c in yields], axis=0)
    rows = np.flatnonzero((reached >= 1.0) & (turned > 0.0))
    if rows.size == 0:
        return math.inf
    row = int(rows[0])
    if row == 0 or reached[row - 1] >= 1.0 or turned[row - 1] >= turned[row]:
        return float(turned[row])
    share = (1.0 - reached[row - 1]) / (reached[row] - reached[row - 1])
    return float((1.0 - share) * turned[row - 1] + share * turned[row])
