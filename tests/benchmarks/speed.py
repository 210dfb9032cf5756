"""Times of columns and frames, beside another build and beside OpenSees. Nothing is asserted.

    python tests/benchmarks/speed.py [--against PYTHON] [--rounds 3] [--only PATTERN]

Least processor times, as a table of `docs/evidence.md` with its date; `--against` takes the Python
interpreter of another version, and both run in turns. Ratios to OpenSees are printed where
openseespy is installed: the models, loads and steps are those of `studies/frames_opensees.py`.
"""

from __future__ import annotations

import argparse
import importlib
import json
import re
import subprocess
import sys
import warnings
from collections.abc import Callable
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
from benchmark import record_20_s
from drawn_building import building, fibre_frame, least, section
from ensembles import predicted

import rbsdem

MASS, LOAD = 20e3, 10e3

#: Ensembles, whose times are those of a run, and their numbers of runs.
RUNS = {
    "a run of 64, paper's column, no settings": 64,
    "a run of 10, layered column": 10,
    "a run of 4, 3 x 3, modal damping": 4,
    "a run of 4, drawn building": 4,
}


def record() -> tuple[np.ndarray, np.ndarray]:
    """Return times [s] and accelerations [m/s2] of 20 s of ground motion."""
    t = np.arange(0, 20.0001, 0.01)
    a = 4 * np.sin(2 * np.pi * t / 0.9) * np.exp(-(((t - 6) / 5) ** 2))
    return t, a + 1.5 * np.sin(2 * np.pi * t / 0.31) * np.exp(-(((t - 8) / 6) ** 2))


def frame(storeys: int, bays: int, **more: Any) -> rbsdem.Frame:
    """Return a frame of point hinges under its dead load."""
    columns, beams = (
        rbsdem.FrameMember(30e9, area=area, inertia=inertia, yield_moment=moment, hardening=0.01)
        for area, inertia, moment in ((0.16, 2.1e-3, 250e3), (0.15, 2.0e-3, 200e3))
    )
    given = {"floor_mass": MASS * bays, "beam_load": LOAD, "kinematics": "pdelta"}
    given["damping"] = rbsdem.Damping(mass=0.3, stiffness=1e-3)
    return rbsdem.Frame.grid(
        [3.2] * storeys, [6.0] * bays, columns=columns, beams=beams, **(given | more)
    )


def shake(structure: Any, **how: Any) -> Callable[[], Any]:
    """Return a run under the record, without more 4000 steps of Newmark's method."""
    t, a = record()
    how = how or {"method": "newmark", "dt": 0.005}
    return lambda: rbsdem.time_history(structure, t, ground_acceleration=a, every=4000, **how)


def together(structure: Any, name: str, motion: Any, **how: Any) -> Callable[[], Any]:
    """Return an ensemble of one thread."""
    scales = np.linspace(0.2, 1.0, RUNS[name])
    return lambda: rbsdem.ensemble(structure, motion, scales=scales, jobs=1, **how)


def wall_frame() -> rbsdem.Frame:
    """Return a house of six storeys and three bays, one line of which is a wall."""
    steel = rbsdem.Steel(450e6, 600e6)
    hoops, curtain = rbsdem.Hoops(0.010, 0.1, steel, 2, 4), rbsdem.Curtain(0.010, 0.2, steel)
    wall = rbsdem.WallSection(
        4.0, 0.25, rbsdem.Concrete(25e6), vertical=curtain, horizontal=curtain,
        boundary=rbsdem.Boundary(0.5, rbsdem.Bars(8, 0.020, steel), hoops),
    )  # fmt: skip
    return rbsdem.examples.house(6, 3, walls={2: wall})


def in_plan() -> rbsdem.Building:
    """Return a building of four storeys of four and three bays of drawn members."""
    column, beam = section(0.4), section(0.5)
    return rbsdem.Building.grid(
        [3.2] * 4, [5.6] * 4, [5.0] * 3, columns=column, beams_x=beam, beams_y=beam,
        floor_load=7e3, mass="from_loads", eccentricity=(0.05, 0.05), kinematics="pdelta",
    )  # fmt: skip


def runs() -> dict[str, Callable[[], Any]]:
    """Return what is timed, by name."""
    small, large = frame(3, 3), frame(8, 8)
    modal = frame(3, 3, damping=rbsdem.Damping(modal=0.03))
    tall = frame(24, 12, floor_mass=12 * 40e3, beam_load=20e3)
    drawn = building()
    one = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
    way = one.height * np.concatenate([np.linspace(0, s * 0.03, 2000) for s in (1, -1, 1)])
    paper = rbsdem.peer.paper_sections()["zahn_7"]

    def make() -> rbsdem.Column:
        return rbsdem.section.column(paper.section, paper.length, axial_load=paper.axial_load)

    layered = make()
    drifts = paper.length * np.concatenate([np.linspace(0, s * 0.02, 1300) for s in (1, -1, 1)])
    loaded = rbsdem.peer.paper_columns()["soesianawati_1"]
    single, some, frames, houses = RUNS
    walls, tower, plan = wall_frame(), rbsdem.examples.house(16, 4), in_plan()
    chain = rbsdem.Column(
        100.0, 614.4, rbsdem.springs.Elastic(7e9), rbsdem.springs.Elastic(2.5e10), n=5000
    )
    return {
        "push-over, 3 x 3": lambda: rbsdem.pushover(small, drift=0.03, points=1),
        "push-over, 8 x 8": lambda: rbsdem.pushover(large, drift=0.03, points=1),
        "push-over, 24 x 12, to its fall": lambda: rbsdem.pushover(tall, drift=0.01),
        "record, 3 x 3": shake(small),
        "record, 8 x 8": shake(large),
        "record, 3 x 3, modal damping": shake(modal),
        "record, 3 x 3, fibres": shake(fibre_frame(3, 3, 400e3)),
        "push-over, drawn building": lambda: rbsdem.pushover(drawn, drift=0.015),
        "push-over, wall-frame": lambda: rbsdem.pushover(walls, drift=0.02),
        "record, wall-frame, default": shake(walls, dt=0.01),
        "drawn 16 x 4, made": lambda: rbsdem.examples.house(16, 4).parts,
        "drawn 16 x 4, push-over to 1.5 %": lambda: rbsdem.pushover(tower, drift=0.015),
        "drawn 16 x 4, push-over to 1.5 %, in leaps": lambda: rbsdem.pushover(
            tower, drift=0.015, method="newton"
        ),
        "building in plan, push-over to 0.03 %": lambda: rbsdem.pushover(
            plan, drift=3e-4, method="static"
        ),
        "building in plan, push-over to 3 %, in leaps": lambda: rbsdem.pushover(plan, drift=0.03),
        "building in plan, record, default": shake(plan, dt=0.01),
        "static, one body, 6000 points": lambda: rbsdem.cyclic(one, displacement=way),
        "static, layered column, 3900 points": lambda: rbsdem.cyclic(layered, displacement=drifts),
        "record, one body": shake(loaded),
        "layered column, made from its drawing": make,
        "layered column, band of 16 samples": lambda: rbsdem.peer.band(layered, drifts[::10]),
        "first frequencies, 5000 bodies": lambda: rbsdem.modes(chain, 3),
        single: together(
            rbsdem.peer.paper_columns("pdelta")["soesianawati_1"], single, record_20_s()
        ),
        some: together(predicted(), some, record_20_s(), method="newmark"),
        frames: together(modal, frames, record(), method="newmark", dt=0.005),
        houses: together(drawn, houses, record(), dt=0.01),
    }


def opensees() -> dict[str, Callable[[], Any]]:
    """Return the same work by OpenSees, or nothing where it is not installed."""
    sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))
    try:
        study = importlib.import_module("frames_opensees")
    except ImportError:
        return {}
    t, a = record()
    work: dict[str, Callable[[], Any]] = {}
    for n in (3, 8):
        work[f"push-over, {n} x {n}"] = lambda n=n: study.pushed(n, n, [0.03 * n * 3.2], 300)
        work[f"record, {n} x {n}"] = lambda n=n: study.shaken(n, n, "pdelta", LOAD, t, a, 0.005)
    damping = rbsdem.Damping(mass=0.3)
    work["record, 3 x 3, fibres"] = lambda: study.recorded(
        study.model_of_fibres(3, 3, 400e3), t, a, 0.005, damping
    )
    return work


def times(pattern: str) -> dict[str, float]:
    """Return the least processor times of this package [s]."""
    warnings.simplefilter("ignore")
    found = {}
    for name, run in runs().items():
        if not re.search(pattern, name):
            continue
        found[name], _ = least(run, 1)
        for _ in range(min(20, int(2.0 / found[name]))):
            found[name] = min(found[name], least(run, 1)[0])
        found[name] /= RUNS.get(name, 1)
    return found


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--against", type=Path, metavar="PYTHON", help="Python of another version")
    parser.add_argument("--rounds", type=int, default=3, help="turns of both versions")
    parser.add_argument("--only", default="", metavar="PATTERN", help="rows whose names have it")
    parser.add_argument("--plain", action="store_true", help="times of this version alone, as json")
    given = parser.parse_args()
    if given.plain:
        print(json.dumps(times(given.only)))
        return
    versions = [Path(sys.executable), *([given.against] if given.against else [])]
    best: list[dict[str, float]] = [{} for _ in versions]
    for _ in range(given.rounds):
        for python, found in zip(versions, best, strict=True):
            command = [str(python), __file__, "--plain", "--only", given.only]
            text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
            for name, seconds in json.loads(text).items():
                found[name] = min(seconds, found.get(name, seconds))
    others = {n: least(run, 1)[0] for n, run in opensees().items() if re.search(given.only, n)}
    against = ["of the other version"] if given.against else []
    print(f"{date.today():%d %B %Y}, least of {given.rounds} rounds:\n")
    print("|", " | ".join(["work", "ms", *against, "OpenSees over rbsdem"]), "|")
    print("| ---", *["| --:"] * (2 + len(against)), "|")
    for name, seconds in best[0].items():
        before = [f"{seconds / best[1][name]:.2f}"] if given.against else []
        ratio = f"{others[name] / seconds:.1f}" if name in others else ""
        time = f"{float(f'{1e3 * seconds:.3g}'):,.10g}".replace(",", " ")
        print("|", " | ".join([name, time, *before, ratio]), "|")


if __name__ == "__main__":
    main()
