"""Extremes of springs: from 1e-12 to 1e6 times yield, long histories, steps of one last digit.

The bilinear rule is the play operator, which is exact in fractions.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import reference_springs

import rbsdem
from rbsdem.springs import Bilinear, Compression, PeakOriented, Pinching, Takeda

EPS = np.finfo(float).eps
BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
PLASTIC = Bilinear(7.0387e8, 1.296e-4, 0.0)
NUMBERS = {
    "k_c": 2.5428e8, "d_c": 3.1891e-4, "k_y": 6.2937e7, "d_y": 2.7183e-3, "k_u": 7.5772e6,
    "b0": 0.4, "b1": 0.22,
}  # fmt: skip
TAKEDA = {inner: Takeda(**NUMBERS, inner=inner) for inner in ("kc", "kr", "one")}
SPRINGS = {"bilinear": BILINEAR, "plastic": PLASTIC, "compression": Compression(1e9)}
CAPPED = {"d_y": 1e-3, "f_y": 1e5, "d_cap": 0.02, "f_cap": 1.5e5, "d_pc": 0.1}
SPRINGS |= {"peak_oriented": PeakOriented(**CAPPED)}
SPRINGS |= {"pinching": Pinching(**CAPPED, kappa_f=0.4, kappa_d=0.5)}
SPRINGS |= {f"takeda {inner}": spring for inner, spring in TAKEDA.items()}

every_spring = pytest.mark.parametrize("spring", SPRINGS.values(), ids=SPRINGS)


def steepest(spring) -> float:
    return next((getattr(spring, name) for name in ("k_c", "k") if hasattr(spring, name)), 1e8)


def yield_of(spring) -> float:
    return getattr(spring, "d_y", 1e-4)


def wild_path(spring, points: int, seed: int = 0) -> np.ndarray:
    """Random points of either sign, from 1e-12 to 1e6 times yield, all sizes alike often."""
    rng = np.random.default_rng(seed)
    return yield_of(spring) * rng.choice([-1.0, 1.0], points) * 10 ** rng.uniform(-12, 6, points)


def play(spring: Bilinear, path: np.ndarray) -> list[Fraction]:
    """Forces along a path without any round-off: k_post d + (k - k_post) play(d)."""
    k, k_post, d_y = Fraction(spring.k), Fraction(spring.k_post), Fraction(spring.d_y)
    forces, here, inside = [], Fraction(0), Fraction(0)
    for value in path.tolist():
        there = Fraction(value)
        inside = min(max(inside + there - here, -d_y), d_y)
        here = there
        forces.append(k_post * here + (k - k_post) * inside)
    return forces


def test_bilinear_spring_in_fractions_from_1e_12_to_1e6_times_yield():
    """In units of the round-off of the largest deformation so far, on the steepest line."""
    path = wild_path(BILINEAR, 5000)
    seen = BILINEAR.response(path).tolist()
    wrong = [abs(float(Fraction(f) - e)) for f, e in zip(seen, play(BILINEAR, path), strict=True)]
    assert np.max(wrong / (EPS * BILINEAR.k * np.maximum.accumulate(np.abs(path)))) < 2.0


@pytest.mark.parametrize("inner", TAKEDA)
def test_takeda_wild_path_against_the_second_implementation(inner):
    path = wild_path(TAKEDA[inner], 2000, seed=7)
    expected = reference_springs.Takeda(**NUMBERS, inner=inner).response(path)
    scale = np.maximum.accumulate(np.abs(path)) * NUMBERS["k_c"]
    assert np.max(np.abs(TAKEDA[inner].response(path) - expected) / scale) < 1e-11


@every_spring
def test_repeated_cycles_repeat_to_the_last_bit(spring):
    """A thousand cycles of 100 reversals between their peaks, with all inner loops."""
    rng = np.random.default_rng(1)
    path = 10 * yield_of(spring) * rng.uniform(-1, 1, 100)
    path[[0, 50]] = 11 * yield_of(spring) * np.array([1, -1])
    force = spring.response(np.tile(path, 1000)).reshape(1000, 100)
    assert np.array_equal(force[-1], force[2])


@every_spring
@pytest.mark.parametrize("peaks", [10, 4000])
def test_nest_of_inner_loops_closes_peak_by_peak(spring, peaks):
    """Amplitudes fall from 9 to 1 times yield; then they grow again by the same peaks, backwards.

    Closed inner loops leave no trace: every peak is met again.
    """
    size = np.linspace(9.0, 1.0, peaks) * yield_of(spring)
    inward = size * (-1.0) ** np.arange(peaks)
    start = 10 * yield_of(spring) * np.array([1.0, -1.0])
    path = np.concatenate([start, inward, inward[::-1], start])
    force = spring.response(path)
    wrong = np.abs(force[2 : 2 + peaks] - force[2 + peaks : 2 + 2 * peaks][::-1])
    assert np.max(wrong) < 100 * EPS * steepest(spring) * np.max(np.abs(path))


@every_spring
@pytest.mark.parametrize("digits", [1, 3, 1000])
def test_trembling_in_the_last_digits_leaves_no_trace(spring, digits):
    """At every point the motion turns back by some last digits, and comes again, five times.

    Every such turn opens an inner loop; a lost or a shifted one would show at once.
    """
    rng = np.random.default_rng(3)
    path = yield_of(spring) * rng.uniform(-10, 10, 300)
    back = path - digits * np.spacing(np.abs(path)) * np.sign(np.diff(path, prepend=0.0))
    trembling = np.column_stack([path] + [back, path] * 5).ravel()
    force = spring.response(trembling).reshape(-1, 11)[:, ::2]
    scale = steepest(spring) * np.max(np.abs(path))
    wrong = np.abs(force - spring.response(path)[:, None]) / scale
    assert np.max(wrong) < 50 * digits * EPS


@every_spring
@pytest.mark.parametrize("value", [5e-324, -2e-310, 1e-200])
def test_denormal_deformations_are_moves_like_others(spring, value):
    path = np.array([value, -value, 2 * value, 0.0])
    expected = steepest(spring) * path
    if spring.rule == "compression":
        expected = np.minimum(expected, 0.0)
    np.testing.assert_allclose(
        spring.response(path), expected, rtol=1e-10, atol=steepest(spring) * 1e-323
    )


@pytest.mark.filterwarnings("ignore:the (rotation of a body|top) goes beyond")
@pytest.mark.parametrize("n", [1, 3])
def test_column_from_1e_12_to_1e6_times_yield_has_its_springs_on_their_paths(n):
    """Driven by displacement and by force; every spring sees its own force (statics)."""
    rng = np.random.default_rng(4)
    path = 3e-3 * rng.choice([-1.0, 1.0], 300) * 10 ** rng.uniform(-12, 6, 300)
    column = rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA["kc"], n=n)
    run = rbsdem.cyclic(column, displacement=path)
    arms = 1.6 - 1.6 * np.arange(n) / n
    largest = np.max(np.abs(run.force))
    np.testing.assert_allclose(run.shear, run.force[:, None] * np.ones(n), atol=1e-11 * largest)
    np.testing.assert_allclose(run.moment, run.force[:, None] * arms, atol=1e-11 * largest)
    for i in range(n):
        for spring, way, force in (
            (BILINEAR, run.slip[:, i], run.shear[:, i]),
            (TAKEDA["kc"], run.rotation[:, i], run.moment[:, i]),
        ):
            scale = steepest(spring) * np.max(np.abs(way))
            assert np.max(np.abs(spring.response(way) - force)) < 1e-10 * scale
    again = rbsdem.cyclic(column, force=run.force)
    np.testing.assert_allclose(again.displacement, path, atol=1e-10 * np.max(np.abs(path)))
