"""A tested column with a fibre hinge under the displacements of the test, OpenSees."""

import math

import numpy as np
import openseespy.opensees as ops
from given import DRAWINGS, Drawing

STEP = 2e-4  # m


def confined(of: Drawing) -> tuple[float, float, float]:
    """Return strength [Pa], its strain and the ultimate strain of the core (Mander et al. 1988)."""
    core, gap = of.side - 2 * of.cover - of.tie, of.spacing - of.tie
    between = (core - of.tie - of.bar) / (of.bars / 4) - of.bar
    ratio = 2 * of.legs * math.pi * of.tie**2 / 4 / (of.spacing * core)
    bars = of.bars * math.pi * of.bar**2 / 4 / core**2
    held = (1 - of.bars * between**2 / (6 * core**2)) * (1 - gap / (2 * core)) ** 2 / (1 - bars)
    pressure = held * ratio * of.tie_yield / 2 / of.concrete
    gain = 2.254 * math.sqrt(1 + 7.94 * pressure) - 2 * pressure - 1.254
    ultimate = 0.004 + 1.4 * ratio * of.tie_yield * 0.1 / (gain * of.concrete)
    return gain * of.concrete, 0.002 * (5 * gain - 4), ultimate


def model(of: Drawing) -> None:
    """Make the column: a fibre hinge at the foot of an elastic part."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    hinge = 0.08 * of.height + 0.022e-6 * of.bar_yield * of.bar  # Paulay and Priestley (1992)
    ops.node(2, 0.0, 0.0)
    ops.node(3, 0.0, of.height)
    ops.fix(1, 1, 1, 1)
    ops.equalDOF(1, 2, 1)
    strength, eps_0, eps_u = confined(of)
    root = math.sqrt(of.concrete / 1e6)
    tension = (0.1, 0.33e6 * root, 470e6 * root / hinge)
    # The hinge is a section without length: strains times the length of the hinge.
    cover = (-of.concrete, -0.002 * hinge, 0.0, -0.006 * hinge)
    ops.uniaxialMaterial("Concrete02", 1, *cover, *tension)
    core = (-strength, -eps_0 * hinge, -0.2 * strength, -eps_u * hinge)
    ops.uniaxialMaterial("Concrete02", 2, *core, *tension)
    ops.uniaxialMaterial("Steel02", 3, of.bar_yield, 200e9 / hinge, 0.01, 20.0, 0.925, 0.15)
    ops.section("Fiber", 1)
    out, inner = of.side / 2, of.side / 2 - of.cover - of.tie / 2
    ops.patch("rect", 2, 20, 1, -inner, -inner, inner, inner)
    ops.patch("rect", 1, 4, 1, -out, -out, -inner, out)
    ops.patch("rect", 1, 4, 1, inner, -out, out, out)
    ops.patch("rect", 1, 20, 1, -inner, -out, inner, -inner)
    ops.patch("rect", 1, 20, 1, -inner, inner, inner, out)
    face, at = of.bars // 4 + 1, inner - of.tie / 2 - of.bar / 2
    for row, y in enumerate(np.linspace(-at, at, face)):
        number = face if row in (0, face - 1) else 2
        ops.layer("straight", 3, number, math.pi * of.bar**2 / 4, y, -at, y, at)
    ops.geomTransf("PDelta", 1)
    ops.element("zeroLengthSection", 1, 1, 2, 1, "-orient", 0, 1, 0, -1, 0, 0)
    cracked = 0.5 * of.side**4 / 12
    ops.element("elasticBeamColumn", 2, 2, 3, of.side**2, 4.7e9 * root, cracked, 1)


def solve(of: Drawing, displacement: np.ndarray) -> np.ndarray:
    """Return the lateral forces [N] at the displacements [m]."""
    model(of)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(3, 0.0, -of.axial_load, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-8, 30)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    ops.analyze(10)
    ops.loadConst("-time", 0.0)
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    ops.load(3, 1.0, 0.0, 0.0)
    force = []
    for target in displacement:
        way = target - ops.nodeDisp(3, 1)
        steps = max(1, math.ceil(abs(way) / STEP))
        ops.integrator("DisplacementControl", 3, 1, way / steps)
        if ops.analyze(steps) != 0:
            raise RuntimeError(f"no equilibrium on the way to {1e3 * target:.1f} mm")
        force.append(ops.getTime())
    return np.array(force)


if __name__ == "__main__":
    from rbsdem import peer

    test = peer.shipped_reversals("soesianawati_1")
    print(np.c_[test.force, solve(DRAWINGS["soesianawati_1"], test.displacement)])
