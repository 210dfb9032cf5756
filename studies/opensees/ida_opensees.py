"""Incremental dynamic analysis of a column that softens, OpenSees."""

import numpy as np
import openseespy.opensees as ops

import rbsdem

HEIGHT, TOP_MASS, DAMPING = 3.0, 5e4, 0.5  # m, kg, 1/s
D_Y, F_Y, D_CAP, F_CAP, D_PC = 0.004, 2e5, 0.03, 2.4e5, 0.06
COLLAPSE_DRIFT, STEP = 0.1, 0.01  # s


def largest_drift(motion: rbsdem.GroundMotion, scale: float) -> float:
    """Return the largest drift; infinity for a collapse."""
    ops.wipe()
    ops.model("basic", "-ndm", 1, "-ndf", 1)
    ops.node(1, 0.0)
    ops.node(2, 0.0)
    ops.fix(1, 1)
    ops.mass(2, TOP_MASS * HEIGHT**2)
    side = (D_CAP - D_Y, D_PC, 10.0, F_Y, F_CAP / F_Y, 0.0)
    never, ones = [1e6] * 4, [1.0] * 6
    ops.uniaxialMaterial("IMKPeakOriented", 1, F_Y / D_Y, *side, *side, *never, *ones)
    ops.uniaxialMaterial("Elastic", 2, -TOP_MASS * 9.81 * HEIGHT)
    ops.uniaxialMaterial("Parallel", 3, 1, 2)
    ops.element("zeroLength", 1, 1, 2, "-mat", 3, "-dir", 1)
    ops.rayleigh(DAMPING, 0.0, 0.0, 0.0)
    values = scale * motion.acceleration / HEIGHT
    ops.timeSeries("Path", 1, "-dt", motion.dt, "-values", *values)
    ops.pattern("UniformExcitation", 1, 1, "-accel", 1)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    largest = 0.0
    for _ in range(round(motion.length / STEP)):
        if ops.analyze(1, STEP) != 0:
            raise RuntimeError(f"{motion.name}: a step did not converge")
        largest = max(largest, abs(ops.nodeDisp(2, 1)))
        if largest >= COLLAPSE_DRIFT:
            return np.inf
    return largest


def solve(records: list[rbsdem.GroundMotion], levels: np.ndarray) -> dict[str, np.ndarray]:
    """Return fractiles of the largest drift, and how many collapse, at peak accelerations."""
    drift = np.array([[largest_drift(m, level / m.pga) for level in levels] for m in records])
    # A record that has collapsed counts as collapsed at higher levels too.
    curves = np.where(np.maximum.accumulate(np.isinf(drift), axis=1), np.inf, drift)
    return {
        "fractiles": np.percentile(curves, (16, 50, 84), axis=0, method="inverted_cdf"),
        "collapses": np.isinf(drift).sum(axis=0),
        "drift": drift,
    }


if __name__ == "__main__":
    from given import LEVELS, records

    print(solve(records(), LEVELS))
