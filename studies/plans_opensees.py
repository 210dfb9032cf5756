"""A building in plan against OpenSees' rigidDiaphragm: the same planar springs, and both times.

    python studies/plans_opensees.py             needs openseespy (pip install openseespy)

Members are OpenSees' `forceBeamColumn` with three Gauss-Lobatto points, and bilinear sections whose
two planes do not know of each other. The floors are eccentric: they turn. The cycle of 4 storeys is
done with finer steps, too, where OpenSees leaves its way: its answer follows its steps.
"""

import time
from dataclasses import replace
from itertools import pairwise, product
from typing import Any

import numpy as np
import openseespy.opensees as ops

import rbsdem

E, HEIGHT, BAYS_X, BAYS_Y = 30e9, 3.2, [5.6, 5.6], [5.0]
COLUMN = {"area": 0.16, "inertia": 2.1e-3, "yield_moment": 250e3}
BEAM = {"area": 0.15, "inertia": 2.0e-3, "yield_moment": 200e3}
HARDENING, OFF = 0.01, 0.1


def building(storeys: int) -> Any:
    """Return the building."""
    column, beam = (rbsdem.FrameMember(E, **kind, hardening=HARDENING) for kind in (COLUMN, BEAM))
    return rbsdem.Building.grid(
        [HEIGHT] * storeys, BAYS_X, BAYS_Y, columns=column, beams_x=beam, beams_y=beam,
        floor_mass=80e3, eccentricity=(OFF, OFF),
    )  # fmt: skip


def model(storeys: int) -> int:
    """Make the same building in OpenSees; return the node at the centre of the roof."""
    ops.wipe()
    ops.model("basic", "-ndm", 3, "-ndf", 6)
    places = [np.concatenate(([0.0], np.cumsum(bays))).tolist() for bays in (BAYS_X, BAYS_Y)]
    tags = {}
    for number, (k, i, j) in enumerate(
        product(range(storeys + 1), range(len(places[0])), range(len(places[1]))), 1
    ):
        tags[i, j, k] = number
        ops.node(number, places[0][i], places[1][j], k * HEIGHT)
        if k == 0:
            ops.fix(number, *[1] * 6)
    for at, kind in enumerate((COLUMN, BEAM)):
        # Members need some stiffness in torsion and across their plane; 1e-9 is seen in records.
        weak = 1e-11 * E * kind["inertia"]
        ops.uniaxialMaterial("Elastic", 10 * at + 1, E * kind["area"])
        ops.uniaxialMaterial(
            "Steel01", 10 * at + 2, kind["yield_moment"], E * kind["inertia"], HARDENING
        )
        ops.uniaxialMaterial("Elastic", 10 * at + 3, weak)
        across = 10 * at + (2 if at == 0 else 3)
        pairs = (10 * at + 1, "P", 10 * at + 2, "My", across, "Mz", 10 * at + 3, "T")
        ops.section("Aggregator", at + 1, *pairs)
        ops.beamIntegration("Lobatto", at + 1, at + 1, 3)
    ops.geomTransf("Linear", 1, 1.0, 0.0, 0.0)
    ops.geomTransf("Linear", 2, 0.0, 0.0, 1.0)
    number = 0
    for k in range(storeys):
        columns = [(tags[i, j, k], tags[i, j, k + 1]) for (i, j, at) in tags if at == k]
        beams = [
            (tags[a, j, k + 1], tags[b, j, k + 1])
            for a, b in pairwise(range(len(places[0])))
            for j in range(len(places[1]))
        ]
        beams += [
            (tags[i, a, k + 1], tags[i, b, k + 1])
            for a, b in pairwise(range(len(places[1])))
            for i in range(len(places[0]))
        ]
        for kind, ends in ((1, columns), (2, beams)):
            for start, end in ends:
                number += 1
                ops.element("forceBeamColumn", number, start, end, kind, kind, "-iter", 50, 1e-14)
    centre = [(0.5 + OFF) * place[-1] for place in places]
    for k in range(1, storeys + 1):
        ops.node(1000 + k, *centre, k * HEIGHT)
        ops.fix(1000 + k, 0, 0, 1, 1, 1, 0)
        ops.rigidDiaphragm(3, 1000 + k, *[tag for at, tag in tags.items() if at[2] == k])
    return 1000 + storeys


def solved(storeys: int, path: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return forces and rotations of the roof on a path of displacements of its centre."""
    roof = model(storeys)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    shares = np.arange(1, storeys + 1) / sum(range(1, storeys + 1))
    for k, share in enumerate(shares.tolist(), 1):
        ops.load(1000 + k, share, 0.0, 0.0, 0.0, 0.0, 0.0)
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 100)
    ops.algorithm("Newton")
    found = []
    for step in np.diff(path, prepend=0.0).tolist():
        ops.integrator("DisplacementControl", roof, 1, step)
        ops.analysis("Static", "-noWarnings")
        if ops.analyze(1):
            raise RuntimeError(f"OpenSees stops at step {len(found) + 1}")
        found.append((ops.getTime(), ops.nodeDisp(roof, 6)))
    force, turned = np.array(found).T
    return force, turned


def shaken(storeys: int, scale: float, parts: int) -> None:
    """Print the difference of a record in two directions, with parts of its steps, and times."""
    house = building(storeys)
    # OpenSees begins without acceleration, and may miss the last one of a path for round-off.
    pair = tuple(
        replace(one, acceleration=np.concatenate(([0.0], scale * one.acceleration[1:2000], [0.0])))
        for one in rbsdem.motions.synthetic(2)
    )
    dt = pair[0].dt / parts
    begin = time.perf_counter()
    rows = rbsdem.time_history(house, pair, method="newmark", dt=dt)
    middle = time.perf_counter()
    roof = model(storeys)
    for k, (mass, inertia) in enumerate(
        zip(house.plan_mass.tolist(), house.inertia.tolist(), strict=True), 1
    ):
        ops.mass(1000 + k, mass, mass, 0.0, 0.0, 0.0, inertia)
    for axis, motion in enumerate(pair, 1):
        ops.timeSeries("Path", axis, "-dt", parts * dt, "-values", *motion.acceleration.tolist())
        ops.pattern("UniformExcitation", axis, axis, "-accel", axis)
    ops.constraints("Transformation")
    ops.numberer("RCM")
    ops.system("BandGeneral")
    ops.test("NormDispIncr", 1e-12, 100)
    ops.algorithm("Newton")
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient", "-noWarnings")
    found = [[0.0] * 3]
    for step in range(round(rows.time[-1] / dt)):
        if ops.analyze(1, dt):
            raise RuntimeError(f"OpenSees stops at step {step + 1}")
        found.append([ops.nodeDisp(roof, axis) for axis in (1, 2, 6)])
    end = time.perf_counter()
    found = found[:: (len(found) - 1) // (rows.time.size - 1)]
    moved = np.column_stack([rows.floor_x[:, -1], rows.floor_y[:, -1], rows.floor_rotation[:, -1]])
    off = np.abs(moved - found).max(axis=0) / np.abs(moved).max(axis=0)
    print(
        f"{storeys} storeys, record of {rows.time[-1]:.0f} s times {scale:g}, "
        f"{(len(found) - 1) * parts} steps, {rows.summary['events']} events: {off[0]:.1e} along x, "
        f"{off[1]:.1e} along y, {off[2]:.1e} in rotation; rbsdem {1e3 * (middle - begin):5.0f} ms, "
        f"OpenSees {1e3 * (end - middle):5.0f} ms, ratio {(end - middle) / (middle - begin):.0f}"
    )


def refined(times: int) -> None:
    """Print the difference on a cycle of 4 storeys with finer steps from -40 to -43 mm."""
    path = np.concatenate([np.linspace(a, b, 401)[1:] for a, b in ((0.0, 0.06), (0.06, 0.0))])
    back = np.linspace(0.0, -0.06, 401)
    near = (back[1:] < -0.04) & (back[1:] > -0.043)
    fine = [
        np.linspace(a, b, (times if inside else 1) + 1)[1:]
        for (a, b), inside in zip(pairwise(back), near, strict=True)
    ]
    path = np.concatenate((path, *fine, np.linspace(-0.06, 0.0, 401)[1:]))
    rows = rbsdem.cyclic(building(4), displacement=path)
    force, turned = solved(4, path)
    twist = rows.floor_rotation[:, -1]
    print(
        f"4 storeys, steps / {times:2d} near -41 mm: "
        f"{np.abs(rows.force - force).max() / np.abs(force).max():.1e} in force, "
        f"{np.abs(twist - turned).max() / np.abs(twist).max():.1e} in rotation; "
        f"last force of rbsdem {rows.force[-1]!r} N"
    )


def main() -> None:
    """Print the differences and the times of a push and of a cyclic path."""
    for storeys, scale, parts in ((2, 0.1, 1), (2, 2.0, 1), (2, 2.0, 4), (4, 2.0, 1)):
        shaken(storeys, scale, parts)
    for times in (1, 16, 64):
        refined(times)
    for storeys, steps, ends in product((2, 4, 8), (100, 400), ((0.06,), (0.06, -0.06, 0.0))):
        legs = pairwise((0.0, *ends))
        path = np.concatenate([np.linspace(a, b, steps + 1)[1:] for a, b in legs])
        house, times = building(storeys), ([], [])
        for _ in range(3):
            begin = time.perf_counter()
            rows = rbsdem.cyclic(house, displacement=path)
            middle = time.perf_counter()
            force, turned = solved(storeys, path)
            times[0].append(middle - begin)
            times[1].append(time.perf_counter() - middle)
        off = np.abs(rows.force - force).max() / np.abs(rows.force).max()
        twist = rows.floor_rotation[:, -1]
        off_turn = np.abs(twist - turned).max() / np.abs(twist).max()
        ours, theirs = map(min, times)
        kind = "push" if len(ends) == 1 else "cycle"
        print(
            f"{storeys} storeys, {kind:5s} of {path.size:4d} steps: {off:.1e} in force, "
            f"{off_turn:.1e} in rotation; rbsdem {1e3 * ours:5.0f} ms, OpenSees "
            f"{1e3 * theirs:5.0f} ms, ratio {theirs / ours:.0f}"
        )


if __name__ == "__main__":
    main()
