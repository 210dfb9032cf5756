"""A cantilever with a mass on top: lateral stiffness and first three frequencies, rbsdem."""

import numpy as np

import rbsdem
from rbsdem.springs import Elastic

HEIGHT, WIDTH, DEPTH = 3.2, 0.4, 0.4  # m
E, G, DENSITY, TOP_MASS = 30e9, 12.5e9, 2500.0, 20e3  # Pa, kg/m3, kg
BODIES = 40


def solve() -> dict[str, float]:
    """Return stiffness [N/m] and frequencies [Hz]."""
    area, inertia = WIDTH * DEPTH, WIDTH * DEPTH**3 / 12
    # A joint has the flexibility of half a body on both sides; the one at the ground has one side.
    part = np.full(BODIES, HEIGHT / BODIES)
    part[0] /= 2
    flexure = [Elastic(k) for k in E * inertia / part]
    part[-1] *= 1.5  # the highest joint takes the shear of the half body at the top too
    shear = [Elastic(k) for k in 5 / 6 * G * area / part]
    mass = DENSITY * area * HEIGHT
    column = rbsdem.Column(
        HEIGHT, mass, shear, flexure, n=BODIES, depth=DEPTH, top_mass=TOP_MASS, gravity=0.0
    )
    stiffness = 1.0 / rbsdem.cyclic(column, force=[1.0]).displacement[0]
    f = rbsdem.modes(column).frequency
    return {"stiffness": stiffness, "f1": f[0], "f2": f[1], "f3": f[2]}


if __name__ == "__main__":
    print(solve())
