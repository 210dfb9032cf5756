"""How far a column is from the middle of the tests that the model was fitted to.

Left-out tests are predicted the worse the farther they are from the others in five properties. The
distance is that of Mahalanobis: in standard deviations of the tests, correlations allowed for.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rbsdem.section.strength import shear_sizes

if TYPE_CHECKING:
    from rbsdem.model.section import Section

__all__ = ["PROPERTIES", "Middle", "place_of"]

PROPERTIES = (
    "axial load ratio",
    "ln of the shear span over the depth",
    "ln of the concrete strength over 30 MPa",
    "ln of the mechanical ratio of the bars",
    "ln of the mechanical ratio of the ties",
)
"""What the distance is taken in."""

#: Below this a ratio of bars or ties is none.
_NONE = 1e-3


def likeness(section: Section, height: float, axial_load: float) -> dict[str, float]:
    """Return the properties by which columns are compared.

    Parameters
    ----------
    section : Section
        Of the column.
    height : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    dict of str to float
        ``axial_load_ratio``, ``span_depth_ratio``, ``concrete_strength`` [Pa], and the mechanical
        ratios of the longitudinal bars, ``bar_ratio`` = A_s f_y/(A_g f'c), and of the ties in the
        direction of loading, ``tie_ratio`` = A_v f_yt/(b s f'c).
    """
    strength, sizes = section.concrete.fc, shear_sizes(section)
    bars = sum(area * steel.fy for _, area, steel in section.bars)
    return {
        "axial_load_ratio": axial_load / (section.gross_area * strength),
        "span_depth_ratio": height / section.depth,
        "concrete_strength": strength,
        "bar_ratio": bars / (section.gross_area * strength),
        "tie_ratio": sizes.tie_ratio * sizes.tie_yield / strength,
    }


def place_of(section: Section, height: float, axial_load: float) -> tuple[float, ...]:
    """Return the properties of a column, in the order of `PROPERTIES`."""
    axial, span, strength, bars, ties = likeness(section, height, axial_load).values()
    return (
        axial,
        math.log(span),
        math.log(strength / 30e6),
        math.log(max(bars, _NONE)),
        math.log(max(ties, _NONE)),
    )


@dataclass(frozen=True, slots=True)
class Middle:
    """The middle of some tests, and how they are spread around it.

    Attributes
    ----------
    mean : tuple of float
        Their mean properties.
    axes : tuple of tuple of float
        Lower triangle A, a row for each property, of which A' A is the inverse of their covariance.
    """

    mean: tuple[float, ...]
    axes: tuple[tuple[float, ...], ...]

    def distance(self, place: tuple[float, ...]) -> float:
        """Return the distance of a column; it is below 3 for nearly all of the tests.

        Parameters
        ----------
        place : tuple of float
            Its properties, see `place_of`.
        """
        way = [value - mean for value, mean in zip(place, self.mean, strict=True)]
        # The rows of a triangle are shorter than the way.
        sums = [sum(a * x for a, x in zip(row, way, strict=False)) for row in self.axes]
        return math.hypot(*sums)
