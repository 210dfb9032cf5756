"""Tested frames by OpenSees, on the drawings of `frames_measured.py` and beside rbsdem.

    python studies/frames_measured_opensees.py [FOLDER] [options of frames_measured.py]

needs openseespy (pip install openseespy). It prints the tables of both and draws both into one
figure for each test.

Members are `forceBeamColumn` with five Gauss-Lobatto points between rigid ends (`-jntOffset`) of
the same lengths. Fibres: `Concrete02`, in the core with the peak of Mander, Priestley and Park 1988
and on to the stress of their curve at the fracture of the hoops, in the cover to 20 % at the strain
of spalling; tension to its strength, and to none at a strain of 0.002; `Steel02` from the yield
stress straight to the largest one at its strain. The panel is a rotational spring `Hysteretic` with
the points of that of rbsdem. Weights act with `PDelta`, tie rods with `Linear`.
"""

from __future__ import annotations

import math
import time
from itertools import count

import numpy as np
import openseespy.opensees as ops
from frames_measured import Curve, Drawing, followed, study

import rbsdem
from rbsdem.springs import Pinching

#: Fibres over the depth, and points of integration.
FIBRES, POINTS = 40, 5
#: Strain at which the tension of cracked concrete has gone.
GONE = 0.002


def concrete_fibres(section: rbsdem.RectangularSection, tags: count) -> None:
    """Add core and cover to the section that is being made."""
    law, core = section.concrete_law, section.confinement
    ft = law["ft"]
    x = core.eps_cu / core.eps_cc
    left = core.fcc * x * core.r / (core.r - 1.0 + x**core.r)
    made = []
    for fc, eps, fu, eps_u in (
        (core.fcc, core.eps_cc, left, core.eps_cu),
        (law["fc"], law["eps0"], 0.2 * law["fc"], section.concrete.eps_spall),
    ):
        made.append(next(tags))
        ops.uniaxialMaterial("Concrete02", made[-1], -fc, -eps, -fu, -eps_u, 0.1, ft, ft / GONE)
    y, z, top, side = 0.5 * core.depth, 0.5 * core.width, 0.5 * section.depth, 0.5 * section.width
    inner, outer = made
    number = math.ceil(FIBRES * core.depth / section.depth)
    ops.patch("rect", inner, number, 1, -y, -z, y, z)
    ops.patch("rect", outer, number, 1, -y, z, y, side)
    ops.patch("rect", outer, number, 1, -y, -side, y, -z)
    for low, high in ((-top, -y), (y, top)):
        ops.patch("rect", outer, math.ceil(0.5 * (FIBRES - number)) + 1, 1, low, -side, high, side)


def fibre_section(section: rbsdem.RectangularSection, tag: int, tags: count) -> dict[int, float]:
    """Make a section; return its tags of steels with their yield strains."""
    steels = {steel: next(tags) for steel in dict.fromkeys(bar[2] for bar in section.bars)}
    for steel, number in steels.items():
        share = (steel.fu - steel.fy) / (steel.eps_u - steel.fy / steel.es) / steel.es
        ops.uniaxialMaterial("Steel02", number, steel.fy, steel.es, share, 18.0, 0.925, 0.15)
    ops.section("Fiber", tag)
    concrete_fibres(section, tags)
    for y, area, steel in section.bars:
        # Those of a drawing are positive below.
        ops.fiber(-y, 0.0, area, steels[steel])
    return {number: steel.fy / steel.es for steel, number in steels.items()}


def panel_spring(spring: Pinching, tag: int) -> None:
    """Make the material of a panel."""
    points = [
        (spring.d_c, spring.f_c), (spring.d_y, spring.f_y), (spring.d_cap, spring.f_cap),
    ]  # fmt: skip
    both = [value for d, f in points for value in (f, d)]
    ops.uniaxialMaterial(
        "Hysteretic", tag, *both, *(-value for value in both), spring.kappa_d, spring.kappa_f,
        0.0, 0.0, 0.0,
    )  # fmt: skip


class Built:
    """A drawing in OpenSees, under its dead load."""

    def __init__(self, drawing: Drawing) -> None:
        ops.wipe()
        ops.model("basic", "-ndm", 2, "-ndf", 3)
        tags, self.place, beams = count(1), {}, {}
        self.node, self.panel = {}, None
        for node in drawing.nodes:
            tag = self.node[node.name] = beams[node.name] = next(tags)
            self.place[node.name] = np.array((node.x, node.y))
            ops.node(tag, node.x, node.y)
            held = {"fixed": (1, 1, 1), "pinned": (1, 1, 0), "roller": (0, 1, 0)}
            if node.support in held:
                ops.fix(tag, *held[node.support])
            if node.panel:
                beams[node.name] = other = next(tags)
                ops.node(other, node.x, node.y)
                ops.equalDOF(tag, other, 1, 2)
                material = next(tags)
                panel_spring(node.panel, material)
                ops.element("zeroLength", next(tags), other, tag, "-mat", material, "-dir", 6)
                self.panel = tag, other
        sections: dict[rbsdem.RectangularSection, int] = {}
        self.watched: list[tuple] = []
        for part in drawing.parts:
            line = self.place[part.end] - self.place[part.start]
            upright = abs(line[1]) > abs(line[0])
            if part.section not in sections:
                tag = sections[part.section] = next(tags)
                steels = fibre_section(part.section, tag, tags)
                ops.beamIntegration("Lobatto", tag, tag, POINTS)
            start, end = (rigid * line / np.linalg.norm(line) for rigid in part.rigid)
            shape = "PDelta" if upright and not drawing.tied else "Linear"
            transf = next(tags)
            ops.geomTransf(shape, transf, "-jntOffset", *start.tolist(), *(-end).tolist())
            ends = (
                (self.node if upright else beams)[part.start],
                (self.node if upright else beams)[part.end],
            )
            element = next(tags)
            ops.element(
                "forceBeamColumn", element, *ends, transf, sections[part.section],
                "-iter", 50, 1e-10,
            )  # fmt: skip
            if part.name == drawing.watched:
                (number, self.yields), *_ = steels.items()
                self.watched = [
                    (
                        element,
                        "section",
                        f"{at}",
                        "fiber",
                        f"{-y}",
                        "0",
                        f"{number}",
                        "stressStrain",
                    )
                    for at in (1, POINTS)
                    for y, _, _ in part.section.bars
                ]
        self.control = self.node[drawing.control]
        self._weigh(drawing)

    def _weigh(self, drawing: Drawing) -> None:
        """Put the dead loads on, then the pattern of the push."""
        ops.system("BandGeneral")
        ops.numberer("RCM")
        ops.constraints("Transformation")
        ops.test("NormDispIncr", 1e-9, 50)
        ops.algorithm("Newton")
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        for node in drawing.nodes:
            if node.load_y:
                ops.load(self.node[node.name], 0.0, node.load_y, 0.0)
        ops.integrator("LoadControl", 0.1)
        ops.analysis("Static", "-noWarnings")
        if ops.analyze(10):
            raise RuntimeError("the dead load does not converge")
        ops.loadConst("-time", 0.0)
        ops.timeSeries("Linear", 2)
        ops.pattern("Plain", 2, 2)
        for node in drawing.nodes:
            if node.push_x:
                ops.load(self.node[node.name], node.push_x, 0.0, 0.0)

    @property
    def moved(self) -> float:
        """Displacement of the control node [m]."""
        return float(ops.nodeDisp(self.control, 1))

    def go(self, target: float, halvings: int = 8) -> bool:
        """Go to a displacement, in halves and by other algorithms where Newton fails."""
        for algorithm in (
            ("Newton",),
            ("KrylovNewton",),
            ("NewtonLineSearch",),
            ("Newton", "-initial"),
        ):
            ops.algorithm(*algorithm)
            ops.integrator("DisplacementControl", self.control, 1, target - self.moved)
            if not ops.analyze(1):
                return True
        middle = 0.5 * (self.moved + target)
        return halvings > 0 and all(self.go(to, halvings - 1) for to in (middle, target))

    def reached(self) -> bool:
        """Return whether a bar of the watched member has yielded."""
        strains = (ops.eleResponse(*asked) for asked in self.watched)
        return any(len(pair) > 1 and pair[1] >= self.yields for pair in strains)


def by_opensees(drawing: Drawing, path: np.ndarray, unload: bool) -> Curve:
    """Follow a path with OpenSees."""
    begin = time.process_time()
    built = Built(drawing)
    moved, force, panel, yielded = [], [], [], (math.nan, math.nan)

    def row() -> None:
        nonlocal yielded
        moved.append(built.moved)
        force.append(ops.getLoadFactor(2))
        turns = [ops.nodeDisp(node, 3) for node in built.panel or ()]
        panel.append(turns[1] - turns[0] if turns else 0.0)
        if math.isnan(yielded[0]) and built.reached():
            yielded = moved[-1], force[-1]

    for target in path:
        if not built.go(float(target)):
            break
        row()
    step = path[-1] / path.size
    while unload and force[-1] > 0.0 and built.go(moved[-1] - step):
        row()
    seconds = time.process_time() - begin
    return Curve(np.array(moved), np.array(force), np.array(panel), yielded, seconds)


if __name__ == "__main__":
    study({"rbsdem": followed, "OpenSees": by_opensees})
