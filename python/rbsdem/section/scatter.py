"""The scatter of tests about the layered model, by version of its parameters.

`studies/spread_table.py` finds the numbers on tests that the fit did not see, and prints how many
points of such tests lie within the bands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

__all__ = ["SCATTER", "Scatter"]


Ends: TypeAlias = tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class Scatter:
    """Scatter of left-out tests about the model.

    Attributes
    ----------
    strength, stiffness, degradation : (float, float)
        Standard deviations of logarithms from laboratory to laboratory, and from test to test
        within one: force, flexibility of the whole column, rate of degradation.
    twins : float
        What nominally equal specimens differ by, over their peak force.
    force : (float, float)
        By what the band of the samples is widened: far from the shear strength, and at it.
    peak, energy, drift : ((float, float), (float, float))
        Ends of the 80 % intervals of largest force, work and drift at 20 % loss, over what is
        predicted: far from the shear strength, and at it.
    """

    strength: Ends
    stiffness: Ends
    degradation: Ends
    twins: float
    force: Ends
    peak: tuple[Ends, Ends]
    energy: tuple[Ends, Ends]
    drift: tuple[Ends, Ends]


SCATTER: dict[str, Scatter] = {
    "2026.3": Scatter(
        strength=(0.085, 0.089),
        stiffness=(0.261, 0.217),
        degradation=(0.087, 0.306),
        twins=0.05,
        force=(0.955, 1.383),
        peak=((0.929, 1.192), (0.951, 1.31)),
        energy=((0.833, 1.544), (0.561, 1.333)),
        drift=((0.664, 1.44), (0.648, 1.585)),
    ),
}
"""Scatter by version of the parameters."""
