"""The scatter of tests about the layered model, by version of its parameters.

`studies/spread_table.py` finds the numbers on tests that the fit did not see, and prints how many
points of such tests lie within the bands.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

from rbsdem.section.remote import Middle

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
    shape : float
        What the band has above and below the samples before it is widened, over the largest force:
        nominally equal specimens differ, and loops have a shape of their own.
    force : (float, float)
        By what the band is widened: far from the shear strength, and at it.
    peak, energy, drift : ((float, float), (float, float))
        Ends of the 80 % intervals of largest force, work and drift at 20 % loss, over what is
        predicted: far from the shear strength, and at it.
    growth : float, optional
        By what the band grows with the distance from the middle of the tests: a factor exp(growth
        distance), in which `force` is that at the middle.
    middle : Middle, optional
        The middle of the tests; without it nothing grows.
    """

    strength: Ends
    stiffness: Ends
    degradation: Ends
    shape: float
    force: Ends
    peak: tuple[Ends, Ends]
    energy: tuple[Ends, Ends]
    drift: tuple[Ends, Ends]
    growth: float = 0.0
    middle: Middle | None = None


SCATTER: dict[str, Scatter] = {
    "2026.3": Scatter(
        strength=(0.085, 0.089),
        stiffness=(0.261, 0.217),
        degradation=(0.116, 0.306),
        shape=0.05,
        force=(0.945, 1.44),
        peak=((0.884, 1.195), (0.91, 1.303)),
        energy=((0.741, 1.498), (0.539, 1.437)),
        drift=((0.619, 1.404), (0.508, 1.712)),
    ),
    "2026.4": Scatter(
        strength=(0.08, 0.09),
        stiffness=(0.25, 0.214),
        degradation=(0.141, 0.286),
        shape=0.15,
        force=(0.402, 0.514),
        peak=((0.896, 1.213), (0.891, 1.296)),
        energy=((0.762, 1.553), (0.587, 1.539)),
        drift=((0.641, 1.407), (0.508, 1.912)),
        growth=0.191,
        middle=Middle(
            mean=(0.2154, 1.1979, 0.2711, -1.461, -2.9864),
            axes=(
                (5.6377,),
                (-0.5576, 2.2321),
                (-1.337, -0.7477, 2.3845),
                (-0.5578, -0.0929, 1.8958, 2.596),
                (-2.6506, -0.1359, -0.0933, -0.1672, 1.4196),
            ),
        ),
    ),
    "2026.5": Scatter(
        strength=(0.076, 0.087),
        stiffness=(0.233, 0.211),
        degradation=(0.138, 0.282),
        shape=0.15,
        force=(0.46, 0.591),
        peak=((0.907, 1.221), (0.87, 1.136)),
        energy=((0.821, 1.528), (0.607, 1.995)),
        drift=((0.653, 1.415), (0.746, 2.239)),
        growth=0.134,
        middle=Middle(
            mean=(0.2154, 1.1979, 0.2711, -1.461, -2.9864),
            axes=(
                (5.6377,),
                (-0.5576, 2.2321),
                (-1.337, -0.7477, 2.3845),
                (-0.5578, -0.0929, 1.8958, 2.596),
                (-2.6506, -0.1359, -0.0933, -0.1672, 1.4196),
            ),
        ),
    ),
}
"""Scatter by version of the parameters."""
