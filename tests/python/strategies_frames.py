"""Random frames of all rules, for tests and studies: families of springs, and paths."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import Any

import numpy as np
from strategies import Rng, between, hardening, layered, rules, spring

import rbsdem
from rbsdem.frames import Frame, FrameMember, Infill
from rbsdem.springs import Spring

RULES = [rule for rule in rules("flexure") if rule not in ("layered", "compression")]
#: Rules of the springs of a family; None: springs that harden all the way.
FAMILIES: dict[str, list[str] | None] = {
    "hardening": None,
    "capped": ["peak_oriented", "pinching"],
    "mixed": RULES,
    "layered": ["layered"],
    "all": [*RULES, "layered"],
}
MODULUS = 3e10
#: Storeys of drawn buildings at the most; searches take taller ones.
TALLEST = int(os.environ.get("RBSDEM_STOREYS", "2"))


def end(rng: Rng, family: str, moment: float) -> Spring:
    """Return a spring of a family that yields near a moment."""
    names = FAMILIES[family]
    way = between(rng, 1e-3, 8e-3)
    if names is None:
        return hardening(rng, str(rng.choice(["bilinear", "takeda"])), moment, way)
    rule = str(rng.choice(names))
    if rule == "layered":
        # Contacts that rock carry nothing without an axial load.
        return layered(rng, moment, way, rocks=0.0)
    return spring(rng, rule, moment, way)


def kind(rng: Rng, family: str, moment: float, *, panels: bool = True) -> FrameMember:
    """Return a kind of members: elastic, sections that yield, or springs at ends or along it."""
    stiffness = moment * between(rng, 60, 400)
    area = stiffness / MODULUS * between(rng, 30, 200)
    given: dict[str, Any] = {"modulus": MODULUS, "area": area, "inertia": stiffness / MODULUS}
    given["rigid_end"] = float(rng.choice([0.0, 0.2])) if panels else 0.0
    drawn = rng.random()
    if drawn < 0.15:
        return FrameMember(**given, shear_rigidity=float(rng.choice([0.0, 0.3 * MODULUS * area])))
    if family != "capped" and drawn < 0.45:
        least = 0.01 if family == "hardening" else 0.0
        share = float(rng.choice([least, 0.01, 0.05]))
        return FrameMember(**given, yield_moment=moment, hardening=share)
    ends = [end(rng, family, moment) for _ in "ab"]
    if drawn > 0.7:
        inner = {0.0: ends[0], 0.5: ends[1], 1.0: ends[0]}
        return FrameMember(**given, flexure=inner, interior="rigid")
    return FrameMember(**given, flexure=ends)


def frame(rng: Rng, family: str = "mixed", **fixed: Any) -> Frame:
    """Return a frame of 1 to 6 storeys and 1 to 4 bays that stands under its load."""
    panels = fixed.pop("panels", rng.random() < 0.3)
    of_panels = "mixed" if family in ("layered", "all") else family  # layers stand in members
    for _ in range(200):
        tied = bool(rng.random() < 0.3)
        given: dict[str, Any] = {
            "columns": kind(rng, family, between(rng, 1e5, 6e5), panels=panels),
            "beams": kind(rng, family, between(rng, 1e5, 5e5), panels=panels),
            "floor_mass": between(rng, 1e4, 1e5),
            "beam_load": float(rng.choice([0.0, between(rng, 1e3, 2e4)])),
            "kinematics": str(rng.choice(["small", "pdelta"])),
            "base": str(rng.choice(["fixed", "pinned"])),
            "diaphragm": tied,
            "pattern": str(rng.choice(["triangular", "uniform", "modal"])),
            "panel": end(rng, of_panels, between(rng, 1e5, 5e5)) if panels else None,
        }
        storeys = [between(rng, 2.5, 4.5) for _ in range(rng.integers(1, 7))]
        bays = [between(rng, 3, 8) for _ in range(rng.integers(1, 5))]
        try:
            made = Frame.grid(storeys, bays, **given | fixed)
            assert made.parts.mass > 0  # lays it out, under its load
        except (rbsdem.InputError, rbsdem.SolveError):
            continue  # too weak for its load, or its modes buckle
        return made
    raise AssertionError(f"no frame of 200 was accepted: {family}, {fixed}")


def _drawn(rng: Rng) -> tuple[rbsdem.RectangularSection, rbsdem.RectangularSection]:
    """Return the drawings of columns and beams."""
    bars, hoops = rbsdem.Steel(between(rng, 350e6, 550e6), 600e6), rbsdem.Steel(400e6)
    more: dict[str, Any] = {"ties": rbsdem.Ties(0.008, float(rng.choice([0.1, 0.15, 0.2])), hoops)}
    more["cover"] = 0.03
    concrete = rbsdem.Concrete(between(rng, 18e6, 35e6))
    side, depth = float(rng.choice([0.3, 0.35, 0.4, 0.5])), float(rng.choice([0.4, 0.5, 0.6]))
    layout = rbsdem.Layout(int(rng.choice([4, 8])), 0.018, bars)
    column = rbsdem.RectangularSection(side, side, concrete, layout=layout, **more)
    below, above = (float(rng.choice([5e-4, 6e-4, 10e-4])), bars), (10e-4, bars)
    rows = [(0.05 - depth / 2, *below), (depth / 2 - 0.05, *above)]
    beam = rbsdem.RectangularSection(0.3, depth, concrete, bars=rows, bar_diameter=0.018, **more)
    return column, beam


def building(rng: Rng) -> Frame:
    """Return a frame of storeys up to the tallest and 1 to 3 bays from the drawings of members."""
    column, beam = _drawn(rng)
    storeys, bays = int(rng.integers(1, TALLEST + 1)), int(rng.integers(1, 4))
    return Frame.grid(
        [float(rng.choice([3.0, 3.2, 3.5]))] * storeys, [float(rng.choice([4.0, 5.0, 6.0]))] * bays,
        columns=column, beams=beam, beam_load=float(rng.choice([8e3, 12e3, 18e3])),
        kinematics=str(rng.choice(["small", "pdelta"])), base=str(rng.choice(["fixed", "pinned"])),
        floor_mass=3e4,
    )  # fmt: skip


def plan(rng: Rng) -> rbsdem.Building:
    """Return a drawn building in plan of 1 or 2 storeys, eccentric and pushed in any direction."""
    column, beam = _drawn(rng)
    bays = [[float(rng.choice([4.0, 5.0, 6.0]))] * int(rng.integers(1, 3)) for _ in "xy"]
    return rbsdem.Building.grid(
        [3.2] * int(rng.integers(1, 3)), *bays, columns=column, beams_x=beam, beams_y=beam,
        floor_load=float(rng.choice([4e3, 6e3])), mass="from_loads",
        eccentricity=(rng.uniform(-0.1, 0.1), rng.uniform(-0.1, 0.1)),
        direction=float(rng.choice([0.0, 30.0, 90.0, 200.0])),
        kinematics=str(rng.choice(["small", "pdelta"])),
    )  # fmt: skip


def house(rng: Rng) -> Frame:
    """Return a drawn frame, or a building in plan, with a wall, infills and laps in some."""
    column, beam = _drawn(rng)
    bars = column.bars[0][2]
    mesh = rbsdem.Curtain(0.01, 0.2, bars)
    wall = rbsdem.WallSection(
        float(rng.choice([1.2, 2.0])), 0.2, column.concrete, vertical=mesh, horizontal=mesh
    )
    storeys, bays = [3.2] * int(rng.integers(1, 3)), [5.0] * int(rng.integers(1, 3))
    brick = Infill(0.2, fm=between(rng, 1e6, 4e6)) if rng.random() < 0.5 else None
    more: dict[str, Any] = {"kinematics": str(rng.choice(["small", "pdelta"]))}
    more |= {"mass": "from_loads", "beams_x" if (in_plan := rng.random() < 0.5) else "beams": beam}
    if not in_plan:
        column = replace(column, lap=rbsdem.Lap(0.4)) if rng.random() < 0.5 else column
        walls = {int(rng.integers(1, len(bays) + 2)): wall} if rng.random() < 0.5 else None
        return Frame.grid(
            storeys, bays, columns=column, dead_load=15e3, walls=walls, infills=brick, **more
        )
    at = str(rng.choice(["x", "y"])), 1, 1
    return rbsdem.Building.grid(
        storeys, bays, [5.0], columns=column, beams_y=beam, floor_load=5e3, infills_x=brick,
        walls={at: wall} if rng.random() < 0.5 else None, eccentricity=(0.05, 0.0),
        direction=float(rng.choice([0.0, 30.0, 200.0])), **more,
    )  # fmt: skip


def drifts(rng: Rng, made: Frame, largest: float = 0.04) -> np.ndarray:
    """Return displacements of the top that grow from turn to turn [m].

    No part of a way ends where an earlier turning point is passed: there springs stand on the ends
    of their lines but for the round-off of the point that is given.
    """
    far = between(rng, 0.005, largest) * made.height
    return far * np.array([1.0, -1.0, 1.53, -0.7, 2.0, 0.0])
