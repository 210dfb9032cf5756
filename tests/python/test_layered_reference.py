"""Layers against the same rules written another way (`reference_layered`).

Concrete and steel without wear are straight lines in both and must agree to round-off. Wear of
steel and the opening of the joint are of first order in the steps of the reference.
"""

from __future__ import annotations

import numpy as np
import pytest
import reference_layered as reference
from numpy.typing import NDArray

from rbsdem.springs import ConcreteSpring, Layered, SteelSpring

Array = NDArray[np.float64]

ARM, DEPTH, STRIPS = 0.16, 0.4, 8
# A section 0.4 m by 0.4 m of 30 MPa over 0.3 m, cut in eight, and two rows of bars of 1600 mm2.
CONCRETE = {
    "k": 1.6e10 / STRIPS,
    "f_peak": 4.8e6 / STRIPS,
    "d_peak": 6e-4,
    "k_soft": 3e8 / STRIPS,
    "f_res": 1.5e6 / STRIPS,
    "plastic": 1.2,
    "contact": 0.35,
    "misfit": 0.4,
    "wear": 0.03,
}
STEEL = {"k": 8e8, "f_y": 7.2e5, "k_post": 8e6, "r0": 8.0, "cr1": 0.83, "cr2": 0.42}
D_Y = STEEL["f_y"] / STEEL["k"]
CAPACITY = CONCRETE["f_peak"] * STRIPS


def fine(spring, path: Array, steps: int = 300) -> Array:
    """Return the forces of a spring of the reference at the points of a path."""
    forces, before = [], 0.0
    for to in path:
        for part in range(1, steps + 1):
            force, spring = spring.step(before + (to - before) * part / steps)
        forces.append(force)
        before = to
    return np.array(forces)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("changes", [{}, {"contact": 0.0, "misfit": 0.0}, {"plastic": 3.0}])
def test_concrete_is_the_reference_to_round_off(seed: int, changes: dict[str, float]) -> None:
    rng = np.random.default_rng(seed)
    path = rng.uniform(-1, 0.4, 25) * 10 ** rng.uniform(-0.7, 1, 25) * CONCRETE["d_peak"]
    numbers = CONCRETE | changes
    got = ConcreteSpring(**numbers).response(path)
    expected = fine(reference.Concrete(**numbers), path, 60)
    np.testing.assert_allclose(got, expected, atol=1e-11 * CONCRETE["f_peak"])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(
    "changes",
    [
        {"cr1": 0.0},
        {},
        {"isotropic_hardening": 0.01},
        {"isotropic_hardening": 0.1, "hardening_reach": 3.0, "f_u": 9e5},
        {"f_u": 9e5, "plateau": 3.0},
    ],
)
def test_steel_is_the_reference_to_round_off(seed: int, changes: dict[str, float]) -> None:
    path = np.random.default_rng(seed).uniform(-1, 1, 20) * np.linspace(0.5, 10, 20) * D_Y
    numbers = STEEL | changes
    got = SteelSpring(**numbers).response(path)
    expected = fine(reference.Steel(**numbers), path, 7)
    np.testing.assert_allclose(got, expected, atol=1e-12 * STEEL["f_y"])


def test_wear_of_steel_is_the_reference_to_first_order() -> None:
    path = np.random.default_rng(1).uniform(-1, 1, 20) * np.linspace(0.5, 10, 20) * D_Y
    numbers = STEEL | {"endurance": 100.0}
    got = SteelSpring(**numbers).response(path)
    coarse, finer = (
        np.max(np.abs(got - fine(reference.Steel(**numbers), path, steps))) for steps in (100, 400)
    )
    assert finer < 2e-3 * STEEL["f_y"]
    assert 2.5 < coarse / finer < 6


def random_reversals() -> Array:
    return np.random.default_rng(1).uniform(-1, 1, 12) * np.linspace(0.002, 0.02, 12)


PATHS = {
    "random reversals": random_reversals(),
    "growing amplitudes": np.repeat([0.002, 0.004, 0.008, 0.016], 2) * np.array([1, -1] * 4),
    "asymmetric": np.array([0.012, -0.002, 0.015, 0.003, 0.02, -0.004, 0.01, 0.0]),
}


def layers(concrete, steel) -> list:
    ys = DEPTH * ((np.arange(STRIPS) + 0.5) / STRIPS - 0.5)
    bars = [(-ARM, steel(**STEEL)), (ARM, steel(**STEEL))]
    return [(y, concrete(**CONCRETE)) for y in ys] + bars


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
@pytest.mark.parametrize("ratio", [0.0, 0.15, 0.4])
def test_joint_is_the_reference_to_first_order(path: Array, ratio: float) -> None:
    load = ratio * CAPACITY
    spring = Layered(layers(ConcreteSpring, SteelSpring))
    got = spring.response(path, load)
    expected = reference.response(load, layers(reference.Concrete, reference.Steel), path, 20)
    assert np.max(np.abs(got - expected)) < 1e-3 * np.max(np.abs(expected))
