"""A layered joint under an axial load that varies, against the fibre section of OpenSees.

    pip install openseespy==3.7.1.2
    python studies/interaction_opensees.py

The same eight bilinear layers (Steel01 in OpenSees) are driven through the same rotations and axial
loads, straight from point to point. rbsdem goes from event to event; OpenSees takes increments and
a turn of a layer inside an increment is missed, so its answers are shown for 1, 10, 100 and 1000
increments a point. Printed are the largest differences of opening and moment over the path,
relative to their largest values. Nothing else needs OpenSees, and it is not a dependency.
"""

from __future__ import annotations

import math
import sys

import numpy as np

import rbsdem

try:
    import openseespy.opensees as ops
except ImportError:
    sys.exit("this study needs OpenSees: pip install openseespy==3.7.1.2")

PLACES = np.array([-0.18, -0.11, -0.04, 0.04, 0.11, 0.18, -0.15, 0.15])
STIFFNESS = np.array([2.5e8, 2.5e8, 2.5e8, 2.5e8, 2.5e8, 2.5e8, 6e8, 8e8])
YIELD = np.array([1e-3, 1.3e-3, 0.9e-3, 0.9e-3, 1.3e-3, 1e-3, 2e-3, 1.5e-3])
SHARE = 0.02
POINTS = 320


def paths() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Return rotations [rad] and axial loads [N] at the points of each path."""
    at = np.linspace(0, 1, POINTS + 1)[1:]
    rotation = 0.02 * at * np.sin(16 * np.pi * at)
    return {
        "constant": (rotation, np.full(POINTS, 4e5)),
        "a sine": (rotation, 4e5 + 3e5 * np.sin(6.2 * np.pi * at)),
        "follows the rotation": (rotation, 4e5 + 2e7 * rotation),
        "a ramp": (rotation, 4e5 * (2 * at - 0.5)),
    }


def ours(rotation: np.ndarray, load: np.ndarray) -> tuple[np.ndarray, np.ndarray, float]:
    """Return opening, moment, and the rotation at rest under the first load."""
    layers = [
        (y, rbsdem.Bilinear(k=k, d_y=d_y, k_post=SHARE * k))
        for y, k, d_y in zip(PLACES, STIFFNESS, YIELD, strict=True)
    ]
    # A slip spring so stiff that the displacement of the top is the rotation times the height.
    column = rbsdem.Column(1.0, 1.0, rbsdem.Elastic(1e22), rbsdem.Layered(layers))
    result = rbsdem.cyclic(column, displacement=rotation, axial_load=load, openings=True)
    assert result.rest is not None
    return result.opening[:, 0], result.moment[:, 0], float(result.rest[0, 0])


def theirs(
    rotation: np.ndarray, load: np.ndarray, rest: float, increments: int
) -> tuple[np.ndarray, np.ndarray]:
    """Return opening and moment of a zero-length section."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    ops.node(2, 0.0, 0.0)
    ops.fix(1, 1, 1, 1)
    ops.fix(2, 0, 1, 0)
    ops.section("Fiber", 1)
    for i, (y, k, d_y) in enumerate(zip(PLACES, STIFFNESS, YIELD, strict=True), start=1):
        ops.uniaxialMaterial("Steel01", i, k * d_y, k, SHARE)
        # A positive rotation of OpenSees opens the fibres below the axis.
        ops.fiber(-y, 0.0, 1.0, i)
    ops.element("zeroLengthSection", 1, 1, 2, 1)
    ops.constraints("Transformation")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormUnbalance", 1e-7, 200)
    ops.algorithm("Newton")

    def go(turn: tuple[float, float], press: tuple[float, float], steps: int) -> None:
        """Go straight from one rotation and axial load to others."""
        # Steps add up to a little more than one, where a series without more points is zero.
        times = (0.0, 1.0, 2.0)
        ops.remove("loadPattern", 1)
        ops.remove("loadPattern", 2)
        ops.setTime(0.0)
        ops.timeSeries("Path", 10, "-time", *times, "-values", turn[0], turn[1], turn[1])
        ops.timeSeries("Path", 11, "-time", *times, "-values", -press[0], -press[1], -press[1])
        ops.pattern("Plain", 1, 10)
        ops.sp(2, 3, 1.0)
        ops.pattern("Plain", 2, 11)
        ops.load(2, 1.0, 0.0, 0.0)
        ops.integrator("LoadControl", 1 / steps)
        ops.analysis("Static", "-noWarnings")
        if ops.analyze(steps) != 0:
            raise SystemExit(f"OpenSees does not converge with {steps} increments")
        ops.remove("timeSeries", 10)
        ops.remove("timeSeries", 11)

    opening, moment = [], []
    here, pressed = 0.0, 0.0
    go((0.0, 0.0), (0.0, load[0]), increments)
    go((0.0, rest), (load[0], load[0]), increments)
    here, pressed = rest, float(load[0])
    for to, press in zip(rotation + rest, load, strict=True):
        go((here, to), (pressed, press), increments)
        here, pressed = to, press
        opening.append(ops.nodeDisp(2, 1))
        ops.reactions()
        moment.append(ops.nodeReaction(2, 3))
    return np.array(opening), np.array(moment)


def main() -> None:
    """Print the table."""
    print("largest difference of opening / moment, relative to the largest of the path")
    print(f"{'axial load':24}" + "".join(f"{count:>22d}" for count in (1, 10, 100, 1000)))
    for name, (rotation, load) in paths().items():
        opening, moment, rest = ours(rotation, load)
        cells = []
        for increments in (1, 10, 100, 1000):
            w, m = theirs(rotation, load, rest, increments)
            wrong = [
                np.abs(one - other).max() / np.abs(other).max()
                for one, other in ((w, opening), (m, moment))
            ]
            cells.append(
                f"{wrong[0]:11.1e} /{wrong[1]:8.1e}" if all(map(math.isfinite, wrong)) else "-"
            )
        print(f"{name:24}" + " ".join(cells))


if __name__ == "__main__":
    main()
