"""What both programs of a job get: drawings and tests, ground motions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import rbsdem
from rbsdem import motions

#: Peak accelerations of the incremental dynamic analysis [m/s2].
LEVELS = np.arange(1.0, 11.0)


@dataclass(frozen=True)
class Drawing:
    """A square column, as its drawing shows it. Units: m, N, Pa."""

    height: float
    axial_load: float
    side: float
    cover: float
    concrete: float
    bars: int
    bar: float
    bar_yield: float
    bar_ultimate: float
    tie: float
    spacing: float
    legs: int
    tie_yield: float


#: Four tests, by their key in `rbsdem.peer.shipped_reversals`; data/paper_table_2.csv.
DRAWINGS = {
    "soesianawati_1": Drawing(
        1.6, 744e3, 0.4, 0.013, 46.5e6, 12, 0.016, 446e6, 702e6, 0.007, 0.085, 4, 364e6
    ),
    "tanaka_park_1": Drawing(
        1.6, 819e3, 0.4, 0.040, 25.6e6, 8, 0.020, 474e6, 721e6, 0.012, 0.080, 3, 333e6
    ),
    "tanaka_park_5": Drawing(
        1.65, 968e3, 0.55, 0.040, 32.0e6, 12, 0.020, 511e6, 675e6, 0.012, 0.110, 4, 325e6
    ),
    "zahn_7": Drawing(
        1.6, 1010e3, 0.4, 0.013, 28.3e6, 12, 0.016, 440e6, 674e6, 0.010, 0.117, 4, 466e6
    ),
}


def records() -> tuple[rbsdem.GroundMotion, ...]:
    """Return 20 synthetic motions, the same on every machine."""
    return motions.synthetic(20)


def motion() -> rbsdem.GroundMotion:
    """Return the first 20 s of one of them, with a peak of 0.4 g."""
    first = records()[0].scaled(pga=0.4 * motions.STANDARD_GRAVITY)
    return rbsdem.GroundMotion(first.acceleration[: round(20 / first.dt) + 1], first.dt)
