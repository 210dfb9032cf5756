"""The footing: what a column stands on where the ground gives way."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

from rbsdem import _arguments
from rbsdem.model.springs import Spring, checked_spring


@dataclass(frozen=True)
class Footing:
    """A rigid footing on springs: the joint beneath it is joint 0 of the column.

    Parameters
    ----------
    shear, flexure : Spring
        Springs between the ground and the footing: against sliding, and against turning. A footing
        that rocks has a `Layered` spring of `Compression` layers.
    axial_spring : Spring, optional
        Spring against settling, opening and tension positive; needed where the joints of the column
        have axial springs, and only there.
    mass : float, optional
        Mass of the footing [kg]. A static path does not need it.
    inertia : float, optional
        Its rotary inertia about its centroid, at half its height [kg m2].
    height : float, optional
        Height of the footing [m]. Its springs are at its bottom, the column stands on its top.

    Raises
    ------
    InputError
        If a spring is missing or a number is not one. What depends on the column is checked there.
    """

    shear: Spring
    flexure: Spring
    axial_spring: Spring | None = None
    mass: float = 0.0
    inertia: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        for name in ("shear", "flexure", "axial_spring"):
            spring = getattr(self, name)
            if spring is not None or name != "axial_spring":
                checked_spring(spring, f"footing: {name}", name)
        _arguments.convert(self, "footing")

    def __repr__(self) -> str:
        given = (
            f"{part.name}={getattr(self, part.name)!r}"
            for part in fields(self)
            if getattr(self, part.name) != part.default
        )
        return f"Footing({', '.join(given)})"

    def keys(self) -> dict[str, Any]:
        """Return the keys of the column that state the footing."""
        return {f"footing_{name}": getattr(self, name) for name in ("mass", "inertia", "height")}
