"""Layers against the same rules written another way (`reference_layered`).

Concrete is straight lines in both and must agree to round-off. Steel is a curve there and chords
here: what the chords cut off is up to 1 % of the yield force for R = 8, up to 3 % for the low
roundness after large plastic excursions. The joint inherits that and nothing else (its moments are
within 1.4 % of the largest one); with bars of two straight lines it agrees to the steps taken.
"""

from __future__ import annotations

import numpy as np
import pytest
import reference_layered as reference
from numpy.typing import NDArray

import rbsdem

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
    got = rbsdem.ConcreteSpring(**numbers).response(path)
    expected = fine(reference.Concrete(**numbers), path, 60)
    np.testing.assert_allclose(got, expected, atol=1e-11 * CONCRETE["f_peak"])


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize(
    ("changes", "share"),
    [
        ({"cr1": 0.0}, 0.012),
        ({}, 0.03),
        ({"isotropic_hardening": 0.01}, 0.03),
        ({"half_strength_work": 500.0}, 0.03),
    ],
)
def test_steel_is_the_reference_but_for_its_chords(
    seed: int, changes: dict[str, float], share: float
) -> None:
    path = np.random.default_rng(seed).uniform(-1, 1, 20) * np.linspace(0.5, 10, 20) * D_Y
    numbers = STEEL | changes
    got = rbsdem.SteelSpring(**numbers).response(path)
    expected = fine(reference.Steel(**numbers), path)
    assert np.max(np.abs(got - expected)) < share * STEEL["f_y"]


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
def test_joint_is_the_reference_but_for_its_chords(path: Array, ratio: float) -> None:
    load = ratio * CAPACITY
    spring = rbsdem.Layered(layers(rbsdem.ConcreteSpring, rbsdem.SteelSpring))
    got = spring.response(path, load)
    expected = reference.response(load, layers(reference.Concrete, reference.Steel), path, 40)
    largest = np.max(np.abs(expected))
    assert np.max(np.abs(got - expected)) < 0.02 * largest
    assert np.sqrt(np.mean((got - expected) ** 2)) < 0.01 * largest


def elastic_plastic(numbers: dict[str, float]) -> tuple[rbsdem.Layered, list]:
    """Concrete with bars of R = 200: two straight lines, which chords follow."""
    bar = STEEL | {"r0": 200.0, "cr1": 0.0} | numbers
    ys = DEPTH * ((np.arange(STRIPS) + 0.5) / STRIPS - 0.5)
    mine = [(y, rbsdem.ConcreteSpring(**CONCRETE)) for y in ys]
    theirs = [(y, reference.Concrete(**CONCRETE)) for y in ys]
    mine += [(y, rbsdem.SteelSpring(**bar)) for y in (-ARM, ARM)]
    theirs += [(y, reference.Steel(**bar)) for y in (-ARM, ARM)]
    return rbsdem.Layered(mine), theirs


@pytest.mark.parametrize("path", PATHS.values(), ids=PATHS)
def test_without_roundness_the_joint_is_the_reference(path: Array) -> None:
    spring, theirs = elastic_plastic({})
    got = spring.response(path, 0.15 * CAPACITY)
    expected = reference.response(0.15 * CAPACITY, theirs, path, 80)
    assert np.max(np.abs(got - expected)) < 1e-3 * np.max(np.abs(expected))
