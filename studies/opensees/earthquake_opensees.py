"""A column with a bilinear hinge under a ground motion, OpenSees."""

import numpy as np
import openseespy.opensees as ops

import rbsdem

HEIGHT, TOP_MASS = 3.0, 5e4  # m, kg
STIFFNESS, YIELD_MOMENT, HARDENING = 5e7, 2e5, 0.02  # N m/rad, N m
DAMPING = 0.5  # 1/s, in proportion to the mass
STEP = 0.005  # s


def solve(motion: rbsdem.GroundMotion) -> dict[str, float | np.ndarray]:
    """Return drifts of the top; the history at the points of the record."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    ops.node(2, 0.0, 0.0)
    ops.node(3, 0.0, HEIGHT)
    ops.fix(1, 1, 1, 1)
    ops.fix(2, 1, 1, 0)
    ops.mass(3, TOP_MASS, 1e-3, 1e-3)
    ops.uniaxialMaterial("Steel01", 1, YIELD_MOMENT, STIFFNESS, HARDENING)
    ops.element("zeroLength", 1, 1, 2, "-mat", 1, "-dir", 6)
    ops.geomTransf("PDelta", 1)
    ops.element("elasticBeamColumn", 2, 2, 3, 1.0, 1e13, 1.0, 1)
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(3, 0.0, -TOP_MASS * 9.81, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 50)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.0)
    ops.analysis("Static")
    ops.analyze(1)
    ops.wipeAnalysis()
    ops.setTime(0.0)
    ops.rayleigh(DAMPING, 0.0, 0.0, 0.0)
    ops.timeSeries("Path", 2, "-dt", motion.dt, "-values", *motion.acceleration)
    ops.pattern("UniformExcitation", 2, 1, "-accel", 2)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 50)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    drift = []
    for _ in range(round(motion.length / STEP)):
        if ops.analyze(1, STEP) != 0:
            raise RuntimeError("a step did not converge")
        drift.append(ops.nodeDisp(3, 1) / HEIGHT)
    every = round(motion.dt / STEP)
    return {
        "largest drift": max(map(abs, drift)),
        "drift at the end": drift[-1],
        "history of the drift": np.array(drift[every - 1 :: every]),
    }


if __name__ == "__main__":
    from given import motion

    print(solve(motion()))
