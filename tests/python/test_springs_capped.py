"""The rules with a capped backbone: by their properties, against an independent method.

``docs/rules.md`` states the rules. ``reference_capped`` is a second implementation. What holds for
every rule is in `test_invariants.py`.
"""

from __future__ import annotations

import numpy as np
import pytest
import reference_capped
from numpy.typing import ArrayLike, NDArray

from rbsdem.springs import PeakOriented, Pinching

Array = NDArray[np.float64]
Numbers = dict[str, float]

CASES = 1000
POINTS = 40
KINDS = ("peak_oriented", "pinching")

# The spring of the sequences by hand (docs/rules.md): elastic 100 up to (1, 100), cap at (3, 120),
# softening with -10 down to the residual 20 at 13.
HAND: Numbers = {
    "d_y": 1.0,
    "f_y": 100.0,
    "d_cap": 3.0,
    "f_cap": 120.0,
    "d_pc": 12.0,
    "f_res": 20.0,
}


def make(numbers: Numbers) -> PeakOriented:
    return (Pinching if "kappa_f" in numbers else PeakOriented)(**numbers)


def reference(numbers: Numbers) -> reference_capped.Capped:
    return reference_capped.Capped(**numbers)


def random_side(rng: np.random.Generator, cracks: bool, tears: bool) -> Numbers:
    d_y, f_y = 10 ** rng.uniform(-0.3, 0.3, 2)
    side = {"d_y": d_y, "f_y": f_y, "d_cap": d_y, "f_cap": f_y}
    slope = f_y / d_y
    if cracks:
        side["d_c"] = d_y * rng.uniform(0.02, 0.6)
        least = side["d_c"] * slope
        side["f_c"] = least + (f_y - least) * rng.uniform(0.05, 0.9)
        slope = (f_y - side["f_c"]) / (d_y - side["d_c"])
    if rng.random() > 0.15:  # else there is no hardening: the cap is at yield
        side["d_cap"] = d_y * rng.uniform(1.05, 8)
        way = side["d_cap"] - d_y
        side["f_cap"] = f_y + slope * way * rng.choice([0.0, rng.uniform(0, 0.5)])
    side["d_pc"] = d_y * 10 ** rng.uniform(-0.5, 2)
    side["f_res"] = f_y * rng.choice([0.0, rng.uniform(0, 0.9)])
    if tears:
        side["d_u"] = side["d_cap"] + d_y * rng.uniform(0, 10)
    return side


def random_numbers(rng: np.random.Generator, kind: str, deteriorates: bool = True) -> Numbers:
    features = rng.random() < 0.5, rng.random() < 0.3
    numbers = random_side(rng, *features)
    if rng.random() < 0.5:
        other = random_side(rng, *features)
        numbers |= {f"{name}_neg": value for name, value in other.items()}
    numbers["b0"] = rng.choice([0.0, rng.uniform(0, 1)])
    numbers["c"] = rng.choice([1.0, rng.uniform(1, 2)])
    sides = reference(numbers).given.values()
    unit = sum(0.5 * side.f_y * side.d_y for side in sides) * max(side.slope for side in sides)
    least = max(side.f_cap**2 * (1 + side.d_cap / side.d_pc) for side in sides) / unit
    for x in "scka":
        if deteriorates and rng.random() < 0.5:
            numbers[f"lambda_{x}"] = least * 10 ** rng.uniform(0.01, 2)
    if kind == "pinching":
        numbers |= {"kappa_f": rng.uniform(0.05, 1), "kappa_d": rng.uniform(0.01, 1)}
    return {name: float(value) for name, value in numbers.items()}


def random_path(rng: np.random.Generator, d_y: float, points: int = POINTS) -> Array:
    path = d_y * rng.uniform(-1, 1, points) * 10 ** rng.uniform(-0.5, 1.2, points)
    for i in range(3, points):  # exact returns to earlier points
        if rng.random() < 0.15:
            path[i] = path[rng.integers(0, i)]
    return path


def growing_cycles(rng: np.random.Generator, d_y: float) -> Array:
    """Return full cycles, without turns between the peaks."""
    return d_y * np.sort(10 ** rng.uniform(-0.5, 1.2, 8)) * np.array([1, -1] * 4)


def scale(numbers: Numbers) -> float:
    return max(numbers["f_cap"], numbers.get("f_cap_neg", 0.0))


def stiffest(numbers: Numbers) -> float:
    return max(side.slope for side in reference(numbers).given.values())


def refined(path: ArrayLike, n: int) -> Array:
    """Put n - 1 points on the way to each point, which itself stays to the last bit."""
    begin = 0.0
    points = []
    for end in np.asarray(path).tolist():
        points += [begin + (end - begin) * i / n for i in range(1, n)] + [end]
        begin = end
    return np.array(points)


@pytest.mark.parametrize("kind", KINDS)
def test_reference_agrees(kind):
    rng = np.random.default_rng(70 + KINDS.index(kind))
    for _ in range(CASES):
        numbers = random_numbers(rng, kind)
        # At the end of its life a side is told by inner loops, which the reference does not know.
        numbers = {
            name: value * 100 ** name.startswith("lambda") for name, value in numbers.items()
        }
        peaks = growing_cycles(rng, numbers["d_y"])
        path = refined(peaks, 9)
        expected = reference(numbers).response(path)
        found = make(numbers).response(path)
        np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * scale(numbers))


def test_property_11_partial_unloading_leaves_no_trace():
    """Down toward zero force and up again, on one line: nothing deteriorates.

    With pinching one of the two parts may pass zero force before the other.
    """
    rng = np.random.default_rng(11)
    for _ in range(CASES):
        numbers = random_numbers(rng, "peak_oriented")
        path = random_path(rng, numbers["d_y"])
        spring = make(numbers)
        force = spring.response(path)
        way = np.sign(np.diff(np.concatenate(([0.0], path))))
        for i in rng.integers(0, POINTS, 2).tolist():
            if way[i] * force[i] <= 1e-9 * scale(numbers):
                continue
            inside = path[i] - way[i] * 0.9 * abs(force[i]) / stiffest(numbers) * rng.random(5)
            longer = np.concatenate((path[: i + 1], inside, path[i:]))
            found = np.delete(spring.response(longer), slice(i + 1, i + 7))
            np.testing.assert_allclose(found, force, rtol=0, atol=1e-9 * scale(numbers))


def test_limits_of_the_numbers_are_allowed():
    PeakOriented(1.0, 100.0, 1.0, 100.0, 1e-3)  # falls at once
    PeakOriented(1.0, 100.0, 3.0, 300.0, 12.0, d_u=3.0)  # elastic up to rupture
    Pinching(**HAND, kappa_f=1.0, kappa_d=1.0)
