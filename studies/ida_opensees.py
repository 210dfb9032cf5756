"""Collapse intensities of a softening column against OpenSees on the same records.

    pip install openseespy
    python studies/ida_opensees.py [RECORDS]

The column of example 08: a capped, peak-oriented hinge under a storey whose weight makes it soften
further. In OpenSees it is one degree of freedom with IMKPeakOriented (no deterioration by
energy) and an elastic spring of -N h beside it, average acceleration and Newton's method. Both are
hunted by the same rule, at a step of 0.001 s. Printed are the collapse intensities, in m/s2 of peak
ground acceleration, and their ratio.
"""

from __future__ import annotations

import sys

import numpy as np
import openseespy.opensees as ops

import rbsdem
from rbsdem import fragility, motions
from rbsdem.springs import Elastic, PeakOriented

HEIGHT, MASS, WEIGHT, RATE = 3.0, 5e4, 4.9e5, 0.5
HINGE = {"d_y": 0.004, "f_y": 2e5, "d_cap": 0.03, "f_cap": 2.4e5, "d_pc": 0.06}
DRIFT, STEP, RESOLUTION = 0.1, 0.001, 0.005
#: Energies of deterioration that are never used up.
NEVER = [1e6] * 4


def column() -> rbsdem.Column:
    """Return the column with one degree of freedom: no shear, no mass but the storey."""
    return rbsdem.Column(
        HEIGHT,
        1e-3,
        Elastic(1e12),
        PeakOriented(**HINGE),
        top_mass=MASS,
        axial_load=WEIGHT,
        kinematics="pdelta",
        damping=rbsdem.Damping(mass=RATE),
    )


def opensees_collapses(motion: rbsdem.GroundMotion, scale: float) -> bool:
    """Return whether OpenSees finds the drift of a collapse."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    inertia = MASS * HEIGHT**2
    ops.mass(2, inertia)
    k = HINGE["f_y"] / HINGE["d_y"]
    side = [HINGE["d_cap"] - HINGE["d_y"], HINGE["d_pc"], 10.0]
    side += [HINGE["f_y"], HINGE["f_cap"] / HINGE["f_y"], 0.0]
    ops.uniaxialMaterial("IMKPeakOriented", 1, k, *side, *side, *NEVER, *[1.0] * 6)
    ops.uniaxialMaterial("Elastic", 2, -WEIGHT * HEIGHT)
    ops.uniaxialMaterial("Parallel", 3, 1, 2)
    ops.element("zeroLength", 1, 1, 2, "-mat", 3, "-dir", 1)
    ops.rayleigh(RATE, 0.0, 0.0, 0.0)
    values = (scale * motion.acceleration / HEIGHT).tolist()
    ops.timeSeries("Path", 1, "-dt", motion.dt, "-values", *values)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormUnbalance", 1e-4, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    for _ in range(round(motion.length / STEP)):
        if ops.analyze(1, STEP) != 0:
            raise RuntimeError(f"{motion.name}: a step of OpenSees did not converge")
        if abs(ops.nodeDisp(2, 1)) >= DRIFT:
            return True
    return False


def opensees_hunt(motion: rbsdem.GroundMotion) -> float:
    """Return the collapse intensity of one record, by the rule of `rbsdem.ida`."""
    low, high, level = 0.0, np.inf, 1.0
    while not np.isfinite(high) or low == 0:
        if opensees_collapses(motion, level / motion.pga):
            high, level = level, level / 1.5
        else:
            low, level = level, level * 1.5
        if np.isfinite(high) and low > 0:
            break
    while high - low > RESOLUTION * high:
        middle = np.sqrt(low * high)
        if opensees_collapses(motion, middle / motion.pga):
            high = middle
        else:
            low = middle
    return float(np.sqrt(low * high))


def main(number: int) -> None:
    """Print a line for each record."""
    records = motions.synthetic(number)
    found = rbsdem.ida(
        column(),
        records,
        intensity="pga",
        levels=fragility.CollapseSearch(resolution=RESOLUTION, points=1),
        refine=[],
        method="newmark",
        dt=STEP,
    )
    ours = found.collapse_intensity[0]
    print("record          rbsdem  OpenSees   ratio")
    ratios = []
    for motion, value in zip(records, ours, strict=True):
        other = opensees_hunt(motion)
        ratios.append(value / other)
        print(f"{motion.name:14s} {value:7.3f}  {other:8.3f}  {ratios[-1]:6.3f}", flush=True)
    spread = np.std(np.log(ratios), ddof=1)
    print(f"median ratio {np.median(ratios):.3f}, spread of its logarithm {spread:.3f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 20)
