"""A column with a bilinear hinge under a ground motion, rbsdem."""

import numpy as np

import rbsdem
from rbsdem.springs import Bilinear, Elastic

HEIGHT, TOP_MASS = 3.0, 5e4  # m, kg
STIFFNESS, YIELD_MOMENT, HARDENING = 5e7, 2e5, 0.02  # N m/rad, N m
DAMPING = 0.5  # 1/s, in proportion to the mass
STEP = 0.005  # s


def solve(motion: rbsdem.GroundMotion) -> dict[str, float | np.ndarray]:
    """Return drifts of the top; the history at the points of the record."""
    column = rbsdem.Column(
        HEIGHT,
        1e-3,
        Elastic(1e12),
        Bilinear(STIFFNESS, YIELD_MOMENT / STIFFNESS, HARDENING * STIFFNESS),
        top_mass=TOP_MASS,
        axial_load=TOP_MASS * 9.81,
        kinematics="pdelta",
        damping=rbsdem.Damping(mass=DAMPING),
    )
    result = rbsdem.time_history(column, ground_acceleration=motion, method="newmark", dt=STEP)
    return {
        "largest drift": abs(result.summary["peak_displacement"]) / HEIGHT,
        "drift at the end": result.displacement[-1] / HEIGHT,
        "history of the drift": result.displacement[1:] / HEIGHT,
    }


if __name__ == "__main__":
    from given import motion

    print(solve(motion()))
