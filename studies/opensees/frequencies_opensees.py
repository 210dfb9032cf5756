"""A cantilever with a mass on top: lateral stiffness and first three frequencies, OpenSees."""

import math

import openseespy.opensees as ops

HEIGHT, WIDTH, DEPTH = 3.2, 0.4, 0.4  # m
E, G, DENSITY, TOP_MASS = 30e9, 12.5e9, 2500.0, 20e3  # Pa, kg/m3, kg
ELEMENTS = 40


def solve() -> dict[str, float]:
    """Return stiffness [N/m] and frequencies [Hz]."""
    area, inertia = WIDTH * DEPTH, WIDTH * DEPTH**3 / 12
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    for i in range(ELEMENTS + 1):
        ops.node(i, 0.0, i * HEIGHT / ELEMENTS)
    ops.fix(0, 1, 1, 1)
    ops.geomTransf("Linear", 1)
    for i in range(ELEMENTS):
        beam = (E, G, area, inertia, 5 / 6 * area, 1, "-mass", DENSITY * area, "-cMass")
        ops.element("ElasticTimoshenkoBeam", i, i, i + 1, *beam)
    ops.mass(ELEMENTS, TOP_MASS, TOP_MASS, 0.0)
    # The modes of the axis come between those of bending: hold it.
    for i in range(1, ELEMENTS + 1):
        ops.fix(i, 0, 1, 0)
    f1, f2, f3 = (math.sqrt(value) / (2 * math.pi) for value in ops.eigen(3))
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(ELEMENTS, 1.0, 0.0, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    ops.analyze(1)
    return {"stiffness": 1.0 / ops.nodeDisp(ELEMENTS, 1), "f1": f1, "f2": f2, "f3": f3}


if __name__ == "__main__":
    print(solve())
