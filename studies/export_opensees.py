"""The hinges that `lumped_hinge` writes for OpenSees, run there beside the column.

    pip install openseespy==3.7.1.2
    python studies/export_opensees.py [FILE.png]

Columns of one section under three axial loads follow a path of growing drifts; the text of
`LumpedHinge.opensees` is run as it is written, and pushed through the same path. Printed are root
mean square differences of the base moment over its largest value: of OpenSees and the column, of
what rbsdem says of the material and the column, and of OpenSees and what rbsdem says.

Nothing else needs OpenSees, and it is not a dependency.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np

import rbsdem

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "examples/12-lumped-hinge"))
from lumped import MATERIALS, LumpedHinge, draw, lumped_hinge

try:
    import openseespy.opensees as ops
except ImportError:
    sys.exit("this study needs OpenSees: pip install openseespy==3.7.1.2")

HEIGHT = 2.5
DRIFTS = (0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.06)
#: Largest step of the rotation in OpenSees, over the largest one.
STEP = 1 / 60


def column(axial_load: float) -> rbsdem.Column:
    """Return a column of 500 mm, 12 bars of 20 mm, closely tied."""
    steel = rbsdem.Steel(450e6)
    section = rbsdem.RectangularSection(
        0.5,
        0.5,
        rbsdem.Concrete(35e6),
        layout=rbsdem.Layout(12, 0.02, steel),
        ties=rbsdem.Ties(0.01, 0.1, steel, legs=4),
        cover=0.03,
    )
    return rbsdem.section.column(section, HEIGHT, axial_load=axial_load)


def in_opensees(text: str, path: np.ndarray) -> np.ndarray:
    """Run the text of a cantilever through rotations; return the moments of its spring."""
    exec(compile(text, "cantilever", "exec"), {})
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-10, 200)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    ops.loadConst("-time", 0.0)
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    ops.load(3, 1.0, 0.0, 0.0)
    at, found = 0.0, []
    largest = np.abs(path).max() * STEP
    for target in path:
        count = max(1, int(np.ceil(abs(target - at) / largest)))
        ops.integrator("DisplacementControl", 3, 1, (target - at) * HEIGHT / count)
        for _ in range(count):
            if ops.analyze(1) != 0:
                ops.algorithm("KrylovNewton")
                if ops.analyze(1) != 0:
                    return np.array([*found, *[np.nan] * (path.size - len(found))])
                ops.algorithm("Newton")
        at = target
        found.append(ops.basicForce(1)[0])
    return np.array(found)


def rms(one: np.ndarray, other: np.ndarray) -> float:
    """Return the root mean square difference over the largest value of the second."""
    return float(np.sqrt(np.mean((one - other) ** 2)) / np.abs(other).max())


def hinge_of(axial_load: float) -> LumpedHinge:
    """Return the hinge of a column along the path."""
    path = HEIGHT * rbsdem.protocol(DRIFTS, cycles=2)
    run = rbsdem.cyclic(column(axial_load), displacement=path)
    return lumped_hinge(run)


def main() -> None:
    """Print the table; draw the loops if a file is named."""
    axes = None
    if len(sys.argv) > 1:
        import matplotlib.pyplot as plt  # noqa: PLC0415

        axes = plt.subplots(3, 2, figsize=(9, 10))[1]
    print("axial load  material              OpenSees-column  rbsdem-column  OpenSees-rbsdem")
    for row, load in enumerate((3e5, 1.2e6, 2.5e6)):
        hinge = hinge_of(load)
        for place, material in enumerate(MATERIALS):
            theirs = in_opensees(hinge.opensees(material, "py"), hinge.rotation)
            ours = hinge.response(material)
            print(
                f"{load / 1e3:7.0f} kN  {material:20s}  {rms(theirs, hinge.moment):15.4f}"
                f"  {rms(ours, hinge.moment):13.4f}  {rms(theirs, ours):15.1e}"
            )
            if axes is not None:
                ax = draw(hinge, material, ax=axes[row, place])
                ax.plot(1e3 * hinge.rotation, 1e-3 * theirs, "r:", lw=0.8, label="OpenSees")
                ax.legend(fontsize=7)
    if axes is not None:
        axes[0, 0].figure.savefig(sys.argv[1], dpi=110)


if __name__ == "__main__":
    main()
