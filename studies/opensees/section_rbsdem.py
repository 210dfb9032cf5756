"""Moment-curvature of a layered section under axial load, rbsdem."""

import numpy as np

import rbsdem
from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties

CURVATURE = np.linspace(0.0, 0.06, 121)  # 1/m
AXIAL_LOAD = 600e3  # N


def solve() -> dict[str, float | np.ndarray]:
    """Return initial stiffness [N m2], moments [N m] and the curve."""
    section = RectangularSection(
        0.4,
        0.4,
        Concrete(20e6),
        layout=Layout(8, 0.020, Steel(420e6, 420e6)),
        ties=Ties(0.010, 0.15, Steel(420e6)),
        cover=0.03,
    )
    moment = rbsdem.section.moment_curvature(section, AXIAL_LOAD, CURVATURE, tension="zero")
    return {
        "initial stiffness": moment[1] / CURVATURE[1],
        "moment at 0.01/m": moment[20],
        "largest moment": moment.max(),
        "moment at 0.06/m": moment[-1],
        "curve": moment,
    }


if __name__ == "__main__":
    print(solve())
