"""The panel of a node from its drawing: equilibrium, Mohr's circle, classes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem.frames import JointPanel
from rbsdem.section.panel import panel_strength

STEEL = rbsdem.Steel(450e6)
HOOPS = rbsdem.Ties(0.010, 0.10, STEEL, legs=3)
COLUMN = rbsdem.RectangularSection(0.40, 0.45, rbsdem.Concrete(30e6))
BEAM = rbsdem.RectangularSection(0.30, 0.50, rbsdem.Concrete(30e6))
NODE = JointPanel(COLUMN, BEAM, hoops=HOOPS, axial_load=500e3)


def principal_tension(shear, vertical, area) -> float:
    """Return the principal tension of a panel under a shear force and a vertical compression."""
    half = 0.5 * vertical / area
    return math.hypot(half, shear / area) - half


def test_the_classes_of_aci_318_and_asce_41_in_pounds_per_square_inch():
    psi = 6894.757
    table = {
        (at, hoops, both): panel_strength(4000 * psi, at, hoops=hoops, transverse_beams=both)
        / math.sqrt(4000) / psi
        for at in ("interior", "exterior", "knee") for hoops in (True, False) for both in (0, 1)
    }  # fmt: skip
    assert list(table.values()) == pytest.approx(
        [15, 20, 10, 12, 12, 15, 6, 8, 8, 12, 4, 4], rel=1e-3
    )


@pytest.mark.parametrize("at", ["interior", "exterior"])
def test_a_panel_without_hoops_fails_at_its_principal_tension(at):
    """Hooked bars bring the shear of the beam, V h_b/h_c, into the panel from above."""
    panel = replace(NODE, at=at, hoops=None)
    hooked = at == "exterior"
    vertical = 500e3 + hooked * panel.strength * 0.50 / 0.45
    tension = principal_tension(panel.strength, vertical, 0.40 * 0.45)
    assert tension == pytest.approx((0.132 if hooked else 0.42) * math.sqrt(30) * 1e6)
    # Hoops that are too far apart are none.
    assert replace(panel, hoops=replace(HOOPS, spacing=0.23)).strength == panel.strength


def test_the_spring_cracks_and_reaches_the_strength():
    spring = NODE.spring()
    assert NODE.width == 0.30 + 2 * 0.05 == pytest.approx(0.40)
    first = spring.f_c / NODE.lever
    assert principal_tension(first, 500e3, NODE.area) == pytest.approx(0.29 * math.sqrt(30) * 1e6)
    assert spring.f_c / spring.d_c == pytest.approx(NODE.stiffness)
    assert spring.f_y == pytest.approx(1.245 * math.sqrt(30) * 1e6 * 0.40 * 0.45 * 0.50)
    # The truss: V = A_sh f_s d/s across one crack at 45 degrees; the strut shortens by 2 V/(E_c A).
    legs = 3 * math.pi * 0.010**2 / 4
    shear, ec = NODE.strength, COLUMN.concrete_law["ec"]
    hoops = shear / (legs * 200e9 * 0.45 / 0.10)
    assert spring.d_y == pytest.approx(hoops + 4 * shear / (ec * NODE.area))
    assert [mark.name for mark in spring.landmarks()][::2] == ["cracking", "yield", "cap"]
    assert replace(NODE, eccentricity=0.05).width == pytest.approx(0.30)


def test_the_lever_arm_is_that_of_the_free_body():
    """Half of the column above the node, and the beam up to its point without moment."""
    panel = replace(NODE, at="exterior", beam_length=2.5, column_height=3.0)
    moment = 100e3
    beam_shear = moment / 2.5
    tension = (moment - beam_shear * 0.225) / (0.9 * 0.50)
    assert moment / (tension - moment / 3.0) == pytest.approx(panel.lever)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"at": "corner"}, "interior, exterior, knee"),
        ({"hoops": 3}, "must be Ties"),
        ({"eccentricity": 0.3}, "outside of the column"),
        ({"beam_length": 0.1}, "ends inside the panel"),
        ({"axial_load": -1e6}, "pulls the concrete of the panel apart"),
    ],
)
def test_wrong_panels(change, words):
    with pytest.raises(rbsdem.InputError, match=words):
        replace(NODE, **change)


def test_work_wears_panels_down():
    """Cycles at one rotation lose strength, the sooner the fewer hoops there are."""
    few = replace(NODE, hoops=replace(HOOPS, diameter=0.006, legs=2))
    losses = []
    for node in (NODE, few, replace(NODE, hoops=None)):
        spring = node.spring()
        turn = spring.d_y + 0.2 * (spring.d_cap - spring.d_y)
        force = spring.response(turn * np.array([0.0, *[1.0, -1.0] * 3]))[1::2]
        whole = replace(spring, lambda_s=0.0)
        assert whole.response(turn * np.array([0.0, *[1.0, -1.0] * 3]))[5] == pytest.approx(
            force[0]
        )
        losses.append(1 - force[2] / force[0])
    assert 0.0 < losses[0] < losses[1] < losses[2] < 0.5
