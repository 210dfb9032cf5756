"""Moment-curvature of a fibre section under axial load, OpenSees."""

import numpy as np
import openseespy.opensees as ops

CURVATURE = np.linspace(0.0, 0.06, 121)  # 1/m
AXIAL_LOAD = 600e3  # N
SIDE, COVER, TIE, BAR = 0.4, 0.03, 0.010, 0.020  # m
FC, FY, ES = 20e6, 420e6, 200e9  # Pa


def model() -> None:
    """Make the section between two nodes at one place."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    ops.node(2, 0.0, 0.0)
    ops.fix(1, 1, 1, 1)
    ops.fix(2, 0, 1, 0)
    # Popovics' curve as Collins and Mitchell (1991) use it; the decay behind the peak is his own.
    n, ec = 0.8 + FC / 17e6, 1e6 * (3320 * (FC / 1e6) ** 0.5 + 6900)
    ops.uniaxialMaterial("Concrete04", 1, -FC, -FC / ec * n / (n - 1), -0.1, ec)
    ops.uniaxialMaterial("Steel01", 2, FY, ES, 0.0)
    ops.section("Fiber", 1)
    half, bar_at = SIDE / 2, SIDE / 2 - COVER - TIE - BAR / 2
    ops.patch("rect", 1, 400, 1, -half, -half, half, half)
    area = np.pi * BAR**2 / 4
    for y, number in ((-bar_at, 3), (0.0, 2), (bar_at, 3)):
        ops.fiber(y, 0.0, number * area, 2)
        ops.fiber(y, 0.0, -number * area, 1)  # the concrete that the bars displace
    ops.element("zeroLengthSection", 1, 1, 2, 1)


def solve() -> dict[str, float | np.ndarray]:
    """Return initial stiffness [N m2], moments [N m] and the curve."""
    model()
    ops.timeSeries("Constant", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(2, -AXIAL_LOAD, 0.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-9, 50)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.0)
    ops.analysis("Static")
    ops.analyze(1)
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    ops.load(2, 0.0, 0.0, 1.0)
    ops.setTime(0.0)
    ops.integrator("DisplacementControl", 2, 3, CURVATURE[1])
    moment = np.zeros_like(CURVATURE)
    for i in range(1, CURVATURE.size):
        if ops.analyze(1) != 0:
            raise RuntimeError(f"no equilibrium at a curvature of {CURVATURE[i]:g} 1/m")
        moment[i] = ops.getTime()
    return {
        "initial stiffness": moment[1] / CURVATURE[1],
        "moment at 0.01/m": moment[20],
        "largest moment": moment.max(),
        "moment at 0.06/m": moment[-1],
        "curve": moment,
    }


if __name__ == "__main__":
    print(solve())
