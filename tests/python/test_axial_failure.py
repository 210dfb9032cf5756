"""Loss of the axial load: the row at which a run ends, what the layers carry there, and the fall.

Points by hand for four equal layers: plastic ones, and ones that crush (elastic to -4 N at
-0.04 m, falling to -1 N). A fall is walked at a fixed rotation from end to end of the lines.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, ConcreteSpring, Elastic, Layered, Spring

PLACES = (-3, -1, 1, 3)


def crushing(softening: float) -> ConcreteSpring:
    """Return a layer whose curve to the peak is straight but for the last digits."""
    return ConcreteSpring(
        k=100 * (1 + 1e-9),
        f_peak=4.0,
        d_peak=0.04,
        k_soft=softening,
        f_res=1.0,
        plastic=1.0,
        contact=0.0,
    )


def follow(layer: Spring, points: list[tuple[float, float]]) -> rbsdem.Result:
    """Return the path of a joint of four layers through rotations and axial loads."""
    column = rbsdem.Column(1.0, 1.0, Elastic(1e12), Layered([(y, layer) for y in PLACES]))
    rotation, load = np.array(points).T
    return rbsdem.cyclic(column, displacement=rotation, axial_load=load, openings=True)


PLASTIC = Bilinear(100.0, 0.01, 0.0)
STEEP, SLOW = crushing(50), crushing(20)
#: All that falls is taken over without a loss of energy: the layers are flat together.
FLAT = crushing(50 * (1 + 1e-7))


@pytest.mark.parametrize(
    ("layer", "points", "rotation", "opening", "moment", "load", "capacity", "fall", "energy"),
    [
        (PLASTIC, [(0, 2), (0.01, 2), (0.01, 6)], 0.01, -0.04, 0, 4, 4, None, None),
        (PLASTIC, [(0, 1e-9), (0.02, 8)], 0.01, -0.04, 0, 4, 4, None, None),
        (PLASTIC, [(0, -3), (0.005, -6)], 1 / 600, 0.015, 0, -4, -4, None, None),
        (FLAT, [(0, 6), (0.02, 6), (0.03, 6)], 0.02, -0.02, 10, 6, 8, -0.02, 0),
        (STEEP, [(0, 10), (0.005, 10), (0.005, 20)], 0.005, -0.045, -0.5, 13.5, 13.5, None, None),
        (SLOW, [(0, 6), (0.02, 6), (0.05, 6), (0.06, 6)], 0.05, 0.01, 10, 6, 8, -0.0875, 0.10125),
        (SLOW, [(0, 10), (0.03, 10)], 0.025, -0.115, -10, 10, 10, None, None),
    ],
)
def test_where_the_axial_load_is_lost_and_the_fall(
    layer, points, rotation, opening, moment, load, capacity, fall, energy
) -> None:
    """The path ends there, with the state as its last row."""
    lost = follow(layer, points)
    about = lost.summary
    assert about["status"] == "axial_failure"
    assert about["lost_joint"] == 1
    assert lost.rotation[-1, 0] == pytest.approx(rotation, rel=1e-6)
    assert lost.opening[-1, 0] == pytest.approx(opening, rel=1e-5)
    assert lost.moment[-1, 0] == pytest.approx(moment, rel=1e-6, abs=1e-5)
    assert about["lost_axial_load"] == pytest.approx(load, rel=1e-6)
    assert about["axial_capacity"] == pytest.approx(capacity, rel=1e-6)
    if fall is None:
        assert math.isnan(about["fall"])
        assert math.isnan(about["fall_energy"])
    else:
        assert about["fall"] == pytest.approx(fall, rel=1e-6)
        assert about["fall_energy"] == pytest.approx(energy, rel=1e-6, abs=1e-8)


def test_a_completed_path_says_nothing_of_a_fall() -> None:
    """The figures are there only where an axial load was lost."""
    about = follow(PLASTIC, [(0, 2), (0.01, 2)]).summary
    assert about["status"] == "completed"
    assert not {"lost_joint", "lost_axial_load", "axial_capacity", "fall"} & set(about)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.7])
def test_no_run_is_completed_with_more_than_the_layers_carry(share: float) -> None:
    """Driven to a rotation and pressed beyond the capacity there, statics and dynamics end."""
    rotation = 0.02 * share
    capacity = 4.0
    lost = follow(PLASTIC, [(0, 1), (rotation, 1), (rotation, 1.01 * capacity)])
    assert lost.summary["status"] == "axial_failure"
    column = rbsdem.Column(1.0, 1.0, Elastic(1e3), Layered([(y, PLASTIC) for y in PLACES]))
    time = np.linspace(0, 2, 101)
    load = 1.01 * capacity * time / 2
    for method in ("rk4", "newmark", "generalised_alpha"):
        ended = rbsdem.time_history(
            column, time, axial_load=load, force=0.01 * share * time, method=method
        )
        assert ended.summary["status"] == "axial_failure"
        assert ended.summary["axial_capacity"] == pytest.approx(capacity, rel=1e-6)
        assert ended.time[-1] < 2
