"""Frames against OpenSees: the same sections, loads and records, and the times side by side.

    python studies/frames_opensees.py            needs openseespy (pip install openseespy)

Members are OpenSees' `forceBeamColumn` with three Gauss-Lobatto points and bilinear sections. It
prints the differences on a static cyclic path without dead load, which are those of the increments;
on a record of 20 s with steps halved, and with the second-order work of the dead load against
`PDelta`; and the times of both in one process.
"""

from __future__ import annotations

import sys
import time
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import openseespy.opensees as ops

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "benchmarks"))
from drawn_building import building, fibre_frame, fibres, least

import rbsdem

E, MASS, LOAD = 30e9, 20e3, 10e3
COLUMN = {"area": 0.16, "inertia": 2.1e-3, "yield_moment": 250e3}
BEAM = {"area": 0.15, "inertia": 2.0e-3, "yield_moment": 200e3}
HARDENING, HEIGHT, BAY = 0.01, 3.2, 6.0
DAMPING = rbsdem.Damping(mass=0.3, stiffness=1e-3)


def frame(storeys: int, bays: int, **more: Any) -> rbsdem.Frame:
    """Return the frame."""
    kinds = [rbsdem.FrameMember(E, **kind, hardening=HARDENING) for kind in (COLUMN, BEAM)]
    return rbsdem.Frame.grid(
        [HEIGHT] * storeys, [BAY] * bays, columns=kinds[0], beams=kinds[1],
        floor_mass=MASS * bays, damping=DAMPING, **more,
    )  # fmt: skip


def settle(unbalance: float = 1e-6) -> None:
    """Choose how OpenSees solves, to an unbalanced force [N]."""
    ops.system("BandGeneral")
    ops.numberer("RCM")
    ops.constraints("Plain")
    ops.test("NormUnbalance", unbalance, 30)
    ops.algorithm("Newton")


def put_on(unbalance: float = 1e-6) -> None:
    """Put the load of the pattern on the model, where it stays."""
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    ops.analyze(10)
    ops.loadConst("-time", 0.0)
    ops.wipeAnalysis()
    settle(unbalance)


def nodes_of_model(storeys: int, bays: int) -> int:
    """Make the nodes in OpenSees, with supports and masses; return how many stand on a floor."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    lines = bays + 1
    for i in range(storeys + 1):
        for j in range(lines):
            share = (0.5 if j in (0, bays) else 1.0) * MASS
            ops.node(i * lines + j + 1, j * BAY, i * HEIGHT)
            if i:
                ops.mass(i * lines + j + 1, share, share, 0.0)
            else:
                ops.fix(j + 1, 1, 1, 1)
    return lines


def model(storeys: int, bays: int, kinematics: str, load: float) -> int:
    """Make the same model in OpenSees, under its dead load; return the node of the roof."""
    lines = nodes_of_model(storeys, bays)
    for tag, kind in ((1, COLUMN), (2, BEAM)):
        ops.uniaxialMaterial("Elastic", 10 * tag, E * kind["area"])
        stiffness = E * kind["inertia"]
        ops.uniaxialMaterial("Steel01", 10 * tag + 1, kind["yield_moment"], stiffness, HARDENING)
        ops.section("Aggregator", tag, 10 * tag, "P", 10 * tag + 1, "Mz")
        ops.beamIntegration("Lobatto", tag, tag, 3)
    ops.geomTransf("PDelta" if kinematics == "pdelta" else "Linear", 1)
    ops.geomTransf("Linear", 2)
    element, beams = 0, []
    for i in range(storeys):
        for j in range(lines):
            element += 1
            ends = i * lines + j + 1, (i + 1) * lines + j + 1
            ops.element("forceBeamColumn", element, *ends, 1, 1)
    for i in range(1, storeys + 1):
        for j in range(bays):
            element += 1
            beams.append(element)
            ends = i * lines + j + 1, i * lines + j + 2
            ops.element("forceBeamColumn", element, *ends, 2, 2)
    settle()
    if load:
        ops.timeSeries("Linear", 1)
        ops.pattern("Plain", 1, 1)
        ops.eleLoad("-ele", *beams, "-type", "-beamUniform", -load)
        put_on()
    return storeys * lines + 1


def pushed(storeys: int, bays: int, path: list[float], parts: int) -> list[float]:
    """Return the forces of OpenSees on a cyclic path, in increments."""
    return driven(model(storeys, bays, "small", 0.0), storeys, bays, path, parts)


def driven(roof: int, storeys: int, bays: int, path: list[float], parts: int) -> list[float]:
    """Drive a model to targets under a triangular load, in increments."""
    lines = bays + 1
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    shares = {i * lines + j + 1: i * (0.5 if j in (0, bays) else 1.0)
              for i in range(1, storeys + 1) for j in range(lines)}  # fmt: skip
    for node, share in shares.items():
        ops.load(node, share / sum(shares.values()), 0.0, 0.0)
    found, at = [], 0.0
    for target in path:
        ops.integrator("DisplacementControl", roof, 1, (target - at) / parts)
        ops.analysis("Static")
        if ops.analyze(parts):
            return found
        found.append(ops.getTime())
        at = target
    return found


def shaken(storeys: int, bays: int, kinematics: str, load: float, t: Any, a: Any, dt: float) -> Any:
    """Return the displacement of the roof in OpenSees under a record."""
    return recorded(model(storeys, bays, kinematics, load), t, a, dt, DAMPING)


def recorded(roof: int, t: Any, a: Any, dt: float, damping: rbsdem.Damping) -> Any:
    """Run a model under a record."""
    ops.timeSeries("Path", 3, "-time", *t.tolist(), "-values", *a.tolist())
    ops.pattern("UniformExcitation", 3, 1, "-accel", 3)
    ops.rayleigh(damping.mass, 0.0, damping.stiffness, 0.0)
    ops.integrator("Newmark", 0.5, 0.25)
    ops.analysis("Transient")
    steps = round(t[-1] / dt)
    found = np.zeros(steps + 1)
    for i in range(steps):
        if ops.analyze(1, dt):
            return found[: i + 1]
        found[i + 1] = ops.nodeDisp(roof, 1)
    return found


def model_of_fibres(storeys: int, bays: int, load: float) -> int:
    """Make the same frame in OpenSees, under its dead load; return the node of the roof."""
    lines = nodes_of_model(storeys, bays)
    ops.uniaxialMaterial("Steel01", 1, 0.0012 * E, E, HARDENING)
    ops.section("Fiber", 1)
    for y, area in fibres():
        ops.fiber(y, 0.0, area, 1)
    ops.beamIntegration("Lobatto", 1, 1, 3)
    ops.geomTransf("Linear", 1)
    pairs = [(i * lines + j + 1, (i + 1) * lines + j + 1)
             for i in range(storeys) for j in range(lines)]  # fmt: skip
    pairs += [(i * lines + j + 1, i * lines + j + 2)
              for i in range(1, storeys + 1) for j in range(bays)]  # fmt: skip
    for number, ends in enumerate(pairs, 1):
        ops.element("forceBeamColumn", number, *ends, 1, 1, "-iter", 20, 1e-14)
    settle()
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for node in range(lines + 1, (storeys + 1) * lines + 1):
        ops.load(node, 0.0, -load, 0.0)
    put_on()
    return storeys * lines + 1


def compare_fibres(t: Any, a: Any) -> None:
    """Print what sections of fibres, whose axial forces vary, differ by and cost."""
    load, path = 400e3, [0.03, -0.04, 0.06, -0.08, 0.0]
    own = rbsdem.cyclic(fibre_frame(2, 1, load), displacement=path).force
    for parts in (100, 1000):
        roof = model_of_fibres(2, 1, load)
        other = np.array(driven(roof, 2, 1, path, parts))
        gap = abs(other - own[: len(other)])[:-1].max() / abs(own).max()
        print(f"fibres, 2 x 1, axial forces vary, {parts} increments a leg: {gap:.1e}")
    built = fibre_frame(3, 3, load)
    begin = time.process_time()
    run = rbsdem.time_history(built, t, ground_acceleration=a, method="newmark", dt=0.005, every=2)
    ours = time.process_time() - begin
    roof = model_of_fibres(3, 3, load)
    begin = time.process_time()
    other = recorded(roof, t, a, 0.005, rbsdem.Damping(mass=DAMPING.mass))[::2]
    theirs = time.process_time() - begin
    gap = abs(other - run.displacement[: len(other)]).max() / abs(run.displacement).max()
    print(f"fibres, record of 20 s, step 0.005: {gap:.1e} of the largest displacement")
    told("fibres, 3 x 3, 4000 steps", ours, "OpenSees", theirs)


def drawn_model() -> int:
    """Make the drawn building of the benchmarks with fibres, under its load; return a roof node.

    Each member is one `forceBeamColumn` with three sections of 24 fibres of concrete and the bars;
    slip of bars and shear have no springs.
    """
    storeys = 4
    lines = nodes_of_model(storeys, 3)
    ops.uniaxialMaterial("Concrete02", 1, -30e6, -0.002, -6e6, -0.006, 0.1, 2e6, 2e9)
    ops.uniaxialMaterial("Steel02", 2, 446e6, 200e9, 0.01, 18.0, 0.925, 0.15)
    for tag, depth in ((1, 0.4), (2, 0.5)):
        ops.section("Fiber", tag)
        ops.patch("rect", 1, 24, 1, -depth / 2, -0.2, depth / 2, 0.2)
        for y, bars in ((1, 3), (0, 2), (-1, 3)):
            ops.fiber(y * (depth / 2 - 0.047), 0.0, bars * 0.25 * np.pi * 0.018**2, 2)
        ops.beamIntegration("Lobatto", tag, tag, 3)
    ops.geomTransf("PDelta", 1, "-jntOffset", 0.0, 0.25, 0.0, -0.25)
    ops.geomTransf("PDelta", 3, "-jntOffset", 0.0, 0.0, 0.0, -0.25)
    ops.geomTransf("Linear", 2, "-jntOffset", 0.2, 0.0, -0.2, 0.0)
    number = 0
    for i, j in product(range(storeys), range(lines)):
        number += 1
        ends = i * lines + j + 1, (i + 1) * lines + j + 1
        ops.element("forceBeamColumn", number, *ends, 1 if i else 3, 1)
    beams = []
    for i, j in product(range(1, storeys + 1), range(lines - 1)):
        number += 1
        beams.append(number)
        ops.element("forceBeamColumn", number, i * lines + j + 1, i * lines + j + 2, 2, 2)
    settle(10.0)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.eleLoad("-ele", *beams, "-type", "-beamUniform", -20e3)
    put_on(10.0)
    return storeys * lines + 1


def compare_drawn() -> None:
    """Print the times of a building of drawn members; the models are not the same."""
    built, largest = building(), 0.015 * 4 * HEIGHT
    record = rbsdem.motions.synthetic(1)[0]
    ours, _ = least(lambda: rbsdem.pushover(built, drift=0.015), 3)
    roof = drawn_model()
    begin = time.process_time()
    done = driven(roof, 4, 3, [largest], 200)
    ended = "" if done else ", which it does not end"
    told("drawn building, push", ours, f"OpenSees{ended}", time.process_time() - begin)
    ours, _ = least(lambda: rbsdem.time_history(built, record, dt=0.01), 3)
    roof = drawn_model()
    begin = time.process_time()
    t = 0.01 * np.arange(round(record.time[-1] / 0.01) + 1)
    a = np.interp(t, record.time, record.acceleration)
    found = recorded(roof, t, a, 0.01, rbsdem.Damping())
    theirs = (time.process_time() - begin) / max(len(found) - 1, 1)
    told(
        "drawn building, a step of 0.01 s of a record", ours / (len(t) - 1),
        f"OpenSees (the first {len(found) - 1} of {len(t) - 1})", theirs,
    )  # fmt: skip


def told(what: str, own: float, who: str, theirs: float) -> None:
    """Print two times and their ratio."""
    print(f"{what}: {1e3 * own:.3g} ms, {who} {1e3 * theirs:.3g} ms: {theirs / own:.1f} times")


def main() -> None:
    """Print the comparisons."""
    path = [0.05, -0.08, 0.12, -0.15, 0.2, 0.0]
    own = rbsdem.cyclic(frame(3, 3), displacement=path).force
    for parts in (100, 1000):
        other = np.array(pushed(3, 3, path, parts))
        print(
            f"static cyclic, 3 x 3, {parts} increments a leg: {abs(other / own - 1)[:-1].max():.1e}"
        )
    t = np.arange(0, 20.0001, 0.01)
    a = 4 * np.sin(2 * np.pi * t / 0.9) * np.exp(-(((t - 6) / 5) ** 2))
    a += 1.5 * np.sin(2 * np.pi * t / 0.31) * np.exp(-(((t - 8) / 6) ** 2))
    for kinematics, load in (("small", 0.0), ("pdelta", LOAD)):
        for dt in (0.01, 0.005, 0.0025):
            built = frame(3, 3, kinematics=kinematics, beam_load=load)
            run = rbsdem.time_history(built, t, ground_acceleration=a, method="newmark", dt=dt)
            other = shaken(3, 3, kinematics, load, t, a, dt)[:: round(0.01 / dt)]
            largest = abs(run.displacement).max()
            gap = abs(other - run.displacement[: len(other)]).max() / largest
            print(f"record, {kinematics}, step {dt}: {gap:.1e} of {1e3 * largest:.0f} mm")
    compare_fibres(t, a)
    compare_drawn()
    for storeys, bays in ((3, 3), (8, 8)):
        built = frame(storeys, bays, kinematics="pdelta", beam_load=LOAD)
        times = []
        for _ in range(3):
            begin = time.process_time()
            rbsdem.time_history(
                built, t, ground_acceleration=a, method="newmark", dt=0.005, every=4000
            )
            times.append(time.process_time() - begin)
        begin = time.process_time()
        shaken(storeys, bays, "pdelta", LOAD, t, a, 0.005)
        theirs = time.process_time() - begin
        told(f"{storeys} x {bays}, 4000 steps", min(times), "OpenSees", theirs)
        times = []
        for _ in range(5):
            begin = time.process_time()
            rbsdem.pushover(built, drift=0.03, points=1)
            times.append(time.process_time() - begin)
        begin = time.process_time()
        pushed(storeys, bays, [0.03 * storeys * HEIGHT], 300)
        theirs = time.process_time() - begin
        told(f"{storeys} x {bays}, push-over", min(times), "OpenSees in 300 increments", theirs)


if __name__ == "__main__":
    main()
