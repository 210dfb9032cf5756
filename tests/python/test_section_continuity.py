"""A drawing's answer is continuous in every dimension, and the same upside down.

A search that always halves the interval across which a predicted value changes most ends at a jump,
if there is one: that interval becomes short and keeps its change.
"""

from __future__ import annotations

import heapq
import math
from collections.abc import Callable
from dataclasses import fields
from itertools import pairwise

import numpy as np
import pytest

import rbsdem
from rbsdem.section import strength
from rbsdem.springs import ConcreteSpring

#: Least and largest values of each input of a column, and the value while others vary [SI].
INPUTS = {
    "width": (0.25, 0.8, 0.4),
    "depth": (0.3, 0.9, 0.45),
    "cover": (0.005, 0.06, 0.02),
    "side_cover": (0.005, 0.06, 0.02),
    "fc": (12e6, 110e6, 30e6),
    "fy": (250e6, 600e6, 450e6),
    "fu": (450e6, 900e6, 620e6),
    "row": (-0.185, 0.185, 0.0),
    "bar": (0.008, 0.035, 0.02),
    "tie": (0.004, 0.02, 0.008),
    "spacing": (0.03, 0.6, 0.12),
    "tie_fy": (200e6, 1000e6, 400e6),
    "legs": (1.0, 6.5, 2.6),
    "legs_across": (1.0, 6.5, 2.0),
    "height": (0.4, 6.0, 1.1),
    "axial_load": (-4e5, 3.5e6, 7e5),
}
LEAST_JUMP = 0.04


def column(**given: float) -> rbsdem.section.layered.LayeredColumn:
    """Return a column with three rows of bars, the middle one at any height."""
    v = {name: middle for name, (*_, middle) in INPUTS.items()} | given
    steel = rbsdem.Steel(v["fy"], v["fu"])
    area, edge = math.pi / 4 * v["bar"] ** 2, v["depth"] / 2 - 0.04
    section = rbsdem.RectangularSection(
        v["width"],
        v["depth"],
        rbsdem.Concrete(v["fc"]),
        bars=[(edge, 3 * area, steel), (v["row"], 2 * area, steel), (-edge, 3 * area, steel)],
        bar_diameter=v["bar"],
        ties=rbsdem.Ties(
            v["tie"],
            v["spacing"],
            rbsdem.Steel(v["tie_fy"]),
            legs=v["legs"],
            legs_across=v["legs_across"],
        ),
        cover=v["cover"],
        side_cover=v["side_cover"],
    )
    return rbsdem.section.column(section, v["height"], axial_load=v["axial_load"])


def predicted(made: rbsdem.section.layered.LayeredColumn) -> dict[str, float]:
    """Return strengths, stiffnesses and springs of a column."""
    drawing, shear = made.drawing, made.shear[0]
    section, joint, place = drawing.section, drawing.joint, (drawing.height, made.axial_load)
    found = {}
    for field in fields(shear):
        value = getattr(shear, field.name)
        if value is None:
            value = getattr(shear, field.name.removesuffix("_neg"))
        found[f"shear {field.name}"] = value
    for name in ("length", "flexural_stiffness", "shear_stiffness", "yield_work"):
        found[name] = getattr(joint, name)
    layers = joint.spring.layers
    for name in ("k", "f_peak", "k_soft", "f_res", "f_y", "k_post", "r0", "d_buckle"):
        of_layers = [(y, getattr(layer, name, None) or 0.0) for y, layer in layers]
        found[f"layers {name}"] = sum(value for _, value in of_layers)
        found[f"layers {name} y2"] = sum(value * y**2 for y, value in of_layers)
    # Strips of core and cover come and go with the place of the hoops.
    concrete = [layer for _, layer in layers if isinstance(layer, ConcreteSpring)]
    found["layers d_peak"] = sum(layer.f_peak * layer.d_peak for layer in concrete)
    found["mcft"] = strength.shear_strength_mcft(section, *place)
    found["sezen"] = strength.shear_strength_sezen(section, *place)
    found["shear failure"] = strength.shear_failure_drift(section, 3e5, place[1])
    found["axial failure"] = strength.axial_failure_drift(section, place[1])
    for name in ("fcc", "eps_cc", "eps_cu", "effectiveness", "lateral_stress"):
        found[f"core {name}"] = getattr(section.confinement, name)
    return {name: value for name, value in found.items() if value is not None}


def jumps(at: Callable[[float], dict[str, float]], low: float, high: float) -> list[str]:
    """Return where the values of a function jump, with what does."""
    places = np.linspace(low, high, 12).tolist()
    known = {place: at(place) for place in places}
    scale = {name: max(abs(v[name]) for v in known.values()) or 1.0 for name in known[low]}

    def interval(a: float, b: float) -> tuple[float, float, float, str]:
        changes = {name: abs(known[a][name] - known[b][name]) / scale[name] for name in scale}
        name = max(changes, key=changes.__getitem__)
        return -changes[name], a, b, name

    waiting = [interval(a, b) for a, b in pairwise(places)]
    heapq.heapify(waiting)
    for _ in range(110):
        change, a, b, _ = waiting[0]
        if b - a < 1e-7 * (high - low) or -change < LEAST_JUMP:
            break
        middle = 0.5 * (a + b)
        known[middle] = at(middle)
        heapq.heapreplace(waiting, interval(a, middle))
        heapq.heappush(waiting, interval(middle, b))
    return [
        f"{name} by {-change:.3g} at {a:.9g}"
        for change, a, b, name in waiting
        if b - a < 1e-5 * (high - low) and -change >= LEAST_JUMP
    ]


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
@pytest.mark.parametrize("name", INPUTS)
def test_nothing_jumps(name):
    low, high, _ = INPUTS[name]
    assert jumps(lambda value: predicted(column(**{name: value})), low, high) == []


@pytest.mark.parametrize("height", [0.8, 1.6])
@pytest.mark.parametrize("top", ["free", "fixed"])
def test_a_column_drawn_upside_down(height, top):
    """Its loops are turned about the origin; each direction has the strength of its own bars."""
    steel = rbsdem.Steel(450e6, 620e6)
    rows = [(0.16, 1.6e-3), (0.05, 4e-4), (-0.15, 6e-4)]
    up, down = (
        rbsdem.RectangularSection(
            0.4,
            0.4,
            rbsdem.Concrete(30e6),
            bars=[(side * y, area, steel) for y, area in rows],
            ties=rbsdem.Ties(0.006, 0.15, rbsdem.Steel(400e6)),
            cover=0.02,
        )
        for side in (1, -1)
    )
    columns = [
        rbsdem.section.column(
            one, 2 * height if top == "fixed" else height, axial_load=8e5, top=top
        )
        for one in (up, down)
    ]
    path = columns[0].height * rbsdem.protocol([0.005, 0.01, 0.02, 0.03])
    loop, turned = (
        rbsdem.cyclic(one, displacement=sign * path).force
        for one, sign in zip(columns, (1, -1), strict=True)
    )
    assert len(loop) == len(turned) == len(path)
    np.testing.assert_allclose(turned, -loop, atol=1e-7 * abs(loop).max())
    if top == "fixed":
        # One end has the bars of either face in tension, whatever the direction.
        back = rbsdem.cyclic(columns[0], displacement=-path).force
        np.testing.assert_allclose(back, -loop, atol=1e-5 * abs(loop).max())
        assert columns[0].gauge(columns[0].n + 1) is not None
        # It is still the column of its drawing, whose parameters can be changed.
        assert columns[0].with_parameters(r0=columns[0].drawing.parameters.r0) == columns[0]
    shear = columns[0].shear[0]
    strengths = [strength.column_shear_strength(one, height, 8e5) for one in (up, down)]
    assert shear.f_y_neg / shear.f_y == pytest.approx(strengths[1] / strengths[0])
    assert strengths[1] < 0.95 * strengths[0]
    assert columns[1].shear[0].f_y == pytest.approx(shear.f_y_neg)
