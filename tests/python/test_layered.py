"""A joint of layers: symmetry, continuity, the axial load, what is refused.

Closed forms are proved in the Fortran suites `layered`, `steel` and `concrete`, the rules once more
in `test_layered_reference`.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Compression, ConcreteSpring, Elastic, Layered, SteelSpring

ARM = 0.2  # m
K, FY, POST = 4e8, 4e5, 4e6  # N/m, N, N/m


def steel(**changes: float) -> SteelSpring:
    return SteelSpring(k=K, f_y=FY, k_post=POST, **changes)


def concrete(**changes: float) -> ConcreteSpring:
    numbers = {"k": 2e9, "f_peak": 1e6, "d_peak": 8e-4, "k_soft": 1e8, "f_res": 2e5}
    return ConcreteSpring(**numbers | changes)


def joint(**changes: float) -> Layered:
    """A symmetric section: four layers of concrete between two of steel."""
    ys = np.array([-0.15, -0.05, 0.05, 0.15])
    layers = [(y, concrete(**changes)) for y in ys]
    return Layered([(-ARM, steel()), *layers, (ARM, steel())])


def test_contacts_without_an_axial_load_stand_on_a_corner() -> None:
    """All contacts touch and carry nothing: one closes, whichever way the joint turns.

    With bars k_b at +-a and contacts k_c at +-c, of which one is closed, the opening at the middle
    is w = k_c c turn/(2 k_b + k_c), and M = 2 k_b a^2 turn + k_c c (c turn - w).
    """
    k_b, k_c, a, c = 1.3e9, 1.05e9, 0.16, 0.1
    bar, contact = Elastic(k_b), Compression(k_c)
    spring = Layered([(-a, bar), (-c, contact), (c, contact), (a, bar)])
    turn = np.array([0.0, 1e-3, 0.0, -1e-3, 1e-9, 0.0, 0.0, 2e-3])
    stiffness = 2 * k_b * a**2 + k_c * c**2 * (1 - k_c / (2 * k_b + k_c))
    np.testing.assert_allclose(spring.response(turn), stiffness * turn, rtol=1e-12)
    beneath = rbsdem.Column(1.5, 3000.0, Elastic(1e9), spring)
    time = 0.005 * np.arange(100)
    for method in ("rk4", "rk45", "newmark"):
        run = rbsdem.time_history(
            beneath, time, ground_acceleration=np.sin(20 * time), method=method
        )
        size = stiffness * np.abs(run.rotation).max()
        np.testing.assert_allclose(run.moment, stiffness * run.rotation, rtol=0, atol=1e-9 * size)


def test_steel_that_turns_back_at_once_stays_where_it_is() -> None:
    d_y = FY / K
    path = [5 * d_y, -3 * d_y, 2 * d_y]
    there = np.nextafter(path[-1], 0)
    force = steel().response([*path, there, path[-1], there, path[-1], 4 * d_y])
    np.testing.assert_allclose(force[3:7], force[2])
    assert force[7] == pytest.approx(steel().response([*path, 4 * d_y])[-1])


def test_static_path_is_the_response_of_the_joint() -> None:
    spring = joint()
    path = [0.004, -0.004, 0.008]
    rigid = rbsdem.Column(1.0, 600.0, Elastic(1e14), spring)
    result = rbsdem.cyclic(rigid, displacement=path)
    np.testing.assert_allclose(result.force, spring.response(path), rtol=1e-4)
