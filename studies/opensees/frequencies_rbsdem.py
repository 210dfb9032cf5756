"""A cantilever with a mass on top: lateral stiffness and first three frequencies, rbsdem."""

import numpy as np
from scipy.special import roots_jacobi

import rbsdem
from rbsdem.springs import Elastic

HEIGHT, WIDTH, DEPTH = 3.2, 0.4, 0.4  # m
E, G, DENSITY, TOP_MASS = 30e9, 12.5e9, 2500.0, 20e3  # Pa, kg/m3, kg
BODIES = 20


def solve() -> dict[str, float]:
    """Return stiffness [N/m] and frequencies [Hz]."""
    area, inertia = WIDTH * DEPTH, WIDTH * DEPTH**3 / 12
    # Joints at the points of the Gauss-Radau rule, each with the flexibility of its share.
    x, w = roots_jacobi(BODIES - 1, 0, 1)
    share = HEIGHT / 2 * np.append(2 / BODIES**2, w / (1 + x))
    lengths = np.diff([0.0, *(HEIGHT / 2 * (1 + x)), HEIGHT])
    shear = [Elastic(k) for k in 5 / 6 * G * area / share]
    flexure = [Elastic(k) for k in E * inertia / share]
    column = rbsdem.Column(
        HEIGHT, DENSITY * area * HEIGHT, shear, flexure, n=BODIES, lengths=lengths,
        depth=DEPTH, top_mass=TOP_MASS, gravity=0.0,
    )  # fmt: skip
    stiffness = 1.0 / rbsdem.cyclic(column, force=[1.0]).displacement[0]
    f = rbsdem.modes(column, count=3).frequency
    return {"stiffness": stiffness, "f1": f[0], "f2": f[1], "f3": f[2]}


if __name__ == "__main__":
    print(solve())
