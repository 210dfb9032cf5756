"""Incremental dynamic analysis of a column that softens, rbsdem."""

import numpy as np

import rbsdem
from rbsdem.springs import Elastic, PeakOriented

HEIGHT, TOP_MASS, DAMPING = 3.0, 5e4, 0.5  # m, kg, 1/s
STEP = 0.01  # s


def solve(records: list[rbsdem.GroundMotion], levels: np.ndarray) -> dict[str, np.ndarray]:
    """Return fractiles of the largest drift, and how many collapse, at peak accelerations."""
    hinge = PeakOriented(d_y=0.004, f_y=2e5, d_cap=0.03, f_cap=2.4e5, d_pc=0.06)
    column = rbsdem.Column(
        HEIGHT,
        1e-3,
        Elastic(1e12),
        hinge,
        top_mass=TOP_MASS,
        axial_load=TOP_MASS * 9.81,
        kinematics="pdelta",
        damping=rbsdem.Damping(mass=DAMPING),
    )
    found = rbsdem.ida(column, records, intensity="pga", levels=levels, method="newmark", dt=STEP)
    drift = found.runs.response("peak_drift").reshape(len(records), levels.size)
    return {
        "fractiles": found.fractiles(levels)[1],
        "collapses": np.isinf(drift).sum(axis=0),
        "drift": drift,
    }


if __name__ == "__main__":
    from given import LEVELS, records

    print(solve(records(), LEVELS))
