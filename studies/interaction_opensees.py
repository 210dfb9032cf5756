"""A layered joint under an axial load that varies, against the fibre section of OpenSees.

    pip install openseespy==3.7.1.2
    python studies/interaction_opensees.py

The same eight bilinear layers (Steel01 in OpenSees) are driven through the same rotations and axial
loads, straight from point to point. rbsdem goes from event to event; OpenSees takes increments and
a turn of a layer inside an increment is missed, so its answers are shown for 1, 10, 100 and 1000
increments a point. Printed are the largest differences of opening and moment over the path,
relative to their largest values.

Two more columns tell whether the two tend to the same. "Extrapolated" is Richardson's 2 B - A from
1000 and 2000 increments: what an increment misses depends on where in it the layer turns, so the
error is of order one only in the mean, and extrapolation takes away some of it. "At events" gives
OpenSees those points as ends of increments at which, in rbsdem, a rate changes on a way: then no
layer turns inside an increment, and no error of OpenSees' increments is left.

Nothing else needs OpenSees, and it is not a dependency.
"""

from __future__ import annotations

import math
import sys

import numpy as np

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Layered

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
        (y, Bilinear(k=k, d_y=d_y, k_post=SHARE * k))
        for y, k, d_y in zip(PLACES, STIFFNESS, YIELD, strict=True)
    ]
    # A slip spring so stiff that the displacement of the top is the rotation times the height.
    column = rbsdem.Column(1.0, 1.0, Elastic(1e22), Layered(layers))
    result = rbsdem.cyclic(column, displacement=rotation, axial_load=load, openings=True)
    assert result.rest is not None
    return result.opening[:, 0], result.moment[:, 0], float(result.rest[0, 0])


def events(rotation: np.ndarray, load: np.ndarray, parts: int = 64) -> list[np.ndarray]:
    """Return for the way to each point the shares at which a line of a layer ends or turns.

    On a way the opening is made of straight pieces. Where the slopes of two parts differ, the lines
    of the parts beside them meet in the event; parts with more than one are cut again.
    """
    ways = [np.empty(0)]
    shares = [np.linspace(0, 1, parts + 1)] * (rotation.size - 1)
    for _ in range(4):
        turns, presses = [rotation[:1]], [load[:1]]
        for i, share in enumerate(shares):
            turns.append(rotation[i] + share[1:] * (rotation[i + 1] - rotation[i]))
            presses.append(load[i] + share[1:] * (load[i + 1] - load[i]))
        opening = ours(np.concatenate(turns), np.concatenate(presses))[0]
        at, ways, finer = 0, [np.empty(0)], []
        for share in shares:
            w = opening[at : at + share.size]
            at += share.size - 1
            found, refined = breaks(share, w, np.abs(opening).max())
            ways.append(found)
            finer.append(refined)
        if all(one.size == share.size for one, share in zip(finer, shares, strict=True)):
            break
        shares = finer
    return ways


def breaks(share: np.ndarray, w: np.ndarray, size: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of a line of straight pieces, and points that separate them better."""
    slope = np.diff(w) / np.diff(share)
    found, more = [], [share]
    # The last digits of the opening, as a slope.
    noise = 1e-13 * size / np.diff(share)
    # Part i has a corner inside or at an end if the parts beside it have different slopes.
    differ = np.abs(np.diff(slope)) > 8 * (noise[1:] + noise[:-1])
    i = 0
    while i < differ.size:
        if not differ[i]:
            i += 1
            continue
        last = i
        while last + 1 < differ.size and differ[last + 1]:
            last += 1
        if last - i <= 1 and i > 0 and last + 2 < slope.size:
            # Straight parts before i and behind last + 1: one corner.
            left, right = (i, last + 1)
            corner = (
                w[right] - w[left] - slope[right] * share[right] + slope[left] * share[left]
            ) / (slope[left] - slope[right])
            found.append(corner)
        else:
            inside = np.linspace(share[i], share[min(last + 2, share.size - 1)], 65)
            more.append(inside)
        i = last + 1
    refined = np.unique(np.concatenate(more))
    return np.array(found), refined


def theirs(
    rotation: np.ndarray, load: np.ndarray, rest: float, ends: list[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """Return opening and moment of a zero-length section.

    The increments of the way to each point end at the given shares of it.
    """
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

    def go(turn: tuple[float, float], press: tuple[float, float], shares: np.ndarray) -> None:
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
        for step in np.diff(shares, prepend=0.0):
            ops.integrator("LoadControl", float(step))
            ops.analysis("Static", "-noWarnings")
            if ops.analyze(1) != 0:
                raise SystemExit(f"OpenSees does not converge with {shares.size} increments")
        ops.remove("timeSeries", 10)
        ops.remove("timeSeries", 11)

    opening, moment = [], []
    here, pressed = 0.0, 0.0
    go((0.0, 0.0), (0.0, load[0]), ends[0])
    go((0.0, rest), (load[0], load[0]), ends[0])
    here, pressed = rest, float(load[0])
    for to, press, shares in zip(rotation + rest, load, ends, strict=True):
        go((here, to), (pressed, press), shares)
        here, pressed = to, press
        opening.append(ops.nodeDisp(2, 1))
        ops.reactions()
        moment.append(ops.nodeReaction(2, 3))
    return np.array(opening), np.array(moment)


def main() -> None:
    """Print the table."""
    print("largest difference of opening / moment, relative to the largest of the path")
    counts = (1, 10, 100, 1000)
    heads = [*map(str, counts), "extrapolated", "at events"]
    print(f"{'axial load':24}" + "".join(f"{head:>22}" for head in heads))
    for name, (rotation, load) in paths().items():
        opening, moment, rest = ours(rotation, load)

        answers = []
        for count in (*counts, 2000):
            ends = [np.linspace(0, 1, count + 1)[1:]] * rotation.size
            answers.append(theirs(rotation, load, rest, ends))
        finest = answers.pop()
        answers.append((2 * finest[0] - answers[-1][0], 2 * finest[1] - answers[-1][1]))
        inside = events(rotation, load)
        ends = [np.unique(np.append(shares, 1.0)) for shares in inside]
        answers.append(theirs(rotation, load, rest, ends))
        cells = []
        for w, m in answers:
            wrong = [
                np.abs(one - other).max() / np.abs(other).max()
                for one, other in ((w, opening), (m, moment))
            ]
            cells.append(
                f"{wrong[0]:11.1e} /{wrong[1]:8.1e}" if all(map(math.isfinite, wrong)) else "-"
            )
        print(f"{name:24}" + " ".join(cells), f"({sum(map(len, inside))} events)")


if __name__ == "__main__":
    main()
