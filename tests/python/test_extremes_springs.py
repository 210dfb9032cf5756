"""Extremes of springs: from 1e-12 to 1e6 times yield, long histories, steps of one last digit.

The bilinear rule is the play operator, which is exact in fractions. The Takeda rule has a second
implementation elsewhere (test_springs.py); here are its closed forms and what must not change.
`measure_...` take the number of points: few here, 1e7 in studies/extremes.py.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import reference_springs

import rbsdem
from rbsdem.springs import Bilinear, Compression, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

EPS = np.finfo(float).eps
BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
PLASTIC = Bilinear(7.0387e8, 1.296e-4, 0.0)
NUMBERS = {
    "k_c": 2.5428e8, "d_c": 3.1891e-4, "k_y": 6.2937e7, "d_y": 2.7183e-3, "k_u": 7.5772e6,
    "b0": 0.4, "b1": 0.22,
}  # fmt: skip
TAKEDA = {inner: Takeda(**NUMBERS, inner=inner) for inner in ("kc", "kr", "one")}
SPRINGS = {"bilinear": BILINEAR, "plastic": PLASTIC, "compression": Compression(1e9)}
SPRINGS |= {f"takeda {inner}": spring for inner, spring in TAKEDA.items()}


def steepest(spring) -> float:
    return getattr(spring, "k_c", None) or spring.k


def yield_of(spring) -> float:
    return getattr(spring, "d_y", 1e-4)


def wild_path(spring, points: int, seed: int = 0) -> np.ndarray:
    """Random points of either sign, from 1e-12 to 1e6 times yield, all sizes alike often."""
    rng = np.random.default_rng(seed)
    return yield_of(spring) * rng.choice([-1.0, 1.0], points) * 10 ** rng.uniform(-12, 6, points)


# ---- amplitude -----------------------------------------------------------------------------------


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


def measure_bilinear(points: int) -> tuple[float, float]:
    """Largest error in the first and in the last tenth of a wild path, in units of round-off.

    Round-off is that of the force at the largest deformation so far, on the steepest line.
    """
    path = wild_path(BILINEAR, points)
    exact = play(BILINEAR, path)
    seen = BILINEAR.response(path)
    wrong = np.array([float(Fraction(f) - e) for f, e in zip(seen.tolist(), exact, strict=True)])
    wrong = np.abs(wrong) / (EPS * BILINEAR.k * np.maximum.accumulate(np.abs(path)))
    return np.max(wrong[: points // 10]), np.max(wrong[-points // 10 :])


def test_bilinear_spring_in_fractions_from_1e_12_to_1e6_times_yield():
    assert max(measure_bilinear(5000)) < 2.0


@pytest.mark.parametrize("size", [1e-12, 1e-6, 0.999])
@pytest.mark.parametrize("name", [name for name in SPRINGS if name != "compression"])
def test_below_the_first_corner_a_spring_is_linear(name, size):
    spring = SPRINGS[name]
    path = wild_path(spring, 200)
    corner = getattr(spring, "d_c", yield_of(spring))
    path *= size * corner / np.max(np.abs(path))
    np.testing.assert_allclose(spring.response(path), steepest(spring) * path, rtol=4 * EPS)


@pytest.mark.parametrize("inner", TAKEDA)
@pytest.mark.parametrize("size", [1.0, 1.5, 10.0, 1e3, 1e6])
def test_takeda_peak_and_unloading_far_beyond_yield(inner, size):
    """Backbone at the peak; then eq 7 until the force is gone; the mirror after the mirror."""
    spring = TAKEDA[inner]
    f_c = spring.k_c * spring.d_c
    f_y = f_c + spring.k_y * (spring.d_y - spring.d_c)
    peak = size * spring.d_y
    f_m = f_y + spring.k_u * (peak - spring.d_y)
    k_r = max((f_c + f_y) / (spring.d_c + spring.d_y) * size**-spring.b0, f_m / peak)
    zero = peak - f_m / k_r
    path = np.array([peak, 0.5 * (peak + zero), zero, -peak, -0.5 * (peak + zero), -zero, peak])
    expected = np.array([f_m, 0.5 * f_m, 0.0, -f_m, -0.5 * f_m, 0.0, f_m])
    np.testing.assert_allclose(spring.response(path), expected, atol=1e-11 * f_m)


@pytest.mark.parametrize("inner", TAKEDA)
def test_takeda_wild_path_against_the_second_implementation(inner):
    spring = TAKEDA[inner]
    path = wild_path(spring, 2000, seed=7)
    second = reference_springs.Takeda(**NUMBERS, inner=inner)
    expected = np.array([second.move(d) for d in path.tolist()])
    scale = np.maximum.accumulate(np.abs(path)) * spring.k_c
    assert np.max(np.abs(spring.response(path) - expected) / scale) < 1e-11


# ---- long histories ------------------------------------------------------------------------------


def measure_repetition(name: str, cycle: int, cycles: int) -> int:
    """Number of forces of the last cycle that differ in any bit from those of the third."""
    spring = SPRINGS[name]
    rng = np.random.default_rng(1)
    path = 10 * yield_of(spring) * rng.uniform(-1, 1, cycle)
    path[[0, cycle // 2]] = 11 * yield_of(spring) * np.array([1, -1])
    force = spring.response(np.tile(path, cycles)).reshape(cycles, cycle)
    return int(np.sum(force[-1] != force[2]))


@pytest.mark.parametrize("name", SPRINGS)
def test_repeated_cycles_repeat_to_the_last_bit(name):
    """A cycle of 100 reversals between its peaks, with all inner loops."""
    assert measure_repetition(name, 100, 1000) == 0


def measure_decay(name: str, peaks: int) -> tuple[float, int]:
    """Close a nest of inner loops: error at their peaks in round-off, and peaks that were wrong.

    Amplitudes fall from 9 to 1 times yield in `peaks` reversals; then the motion grows again by
    the same peaks, backwards. Closed inner loops leave no trace: every peak is met again.
    """
    spring = SPRINGS[name]
    size = np.linspace(9.0, 1.0, peaks) * yield_of(spring)
    inward = size * (-1.0) ** np.arange(peaks)
    start = 10 * yield_of(spring) * np.array([1.0, -1.0])
    path = np.concatenate([start, inward, inward[::-1], start])
    force = spring.response(path)
    wrong = np.abs(force[2 : 2 + peaks] - force[2 + peaks : 2 + 2 * peaks][::-1])
    wrong = wrong / (EPS * steepest(spring) * np.max(np.abs(path)))
    return float(np.max(wrong)), int(np.sum(wrong > 100))


@pytest.mark.parametrize("name", SPRINGS)
@pytest.mark.parametrize("peaks", [10, 4000])
def test_nest_of_inner_loops_closes_peak_by_peak(name, peaks):
    assert measure_decay(name, peaks)[0] < 100


# ---- steps that are nothing ----------------------------------------------------------------------


@pytest.mark.parametrize("name", SPRINGS)
def test_repeated_points_change_no_bit(name):
    spring = SPRINGS[name]
    path = wild_path(spring, 500, seed=2)
    force = spring.response(path)
    assert np.array_equal(spring.response(np.repeat(path, 3)), np.repeat(force, 3))
    with_zeros = np.concatenate([[0.0, -0.0, 0.0], path])
    assert np.array_equal(spring.response(with_zeros)[3:], force)


@pytest.mark.parametrize("name", SPRINGS)
@pytest.mark.parametrize("digits", [1, 3, 1000])
def test_trembling_in_the_last_digits_leaves_no_trace(name, digits):
    """At every point the motion turns back by some last digits, and comes again, five times.

    Every such turn opens an inner loop; a lost or a shifted one would show at once.
    """
    spring = SPRINGS[name]
    rng = np.random.default_rng(3)
    path = yield_of(spring) * rng.uniform(-10, 10, 300)
    back = path - digits * np.spacing(np.abs(path)) * np.sign(np.diff(path, prepend=0.0))
    trembling = np.column_stack([path] + [back, path] * 5).ravel()
    force = spring.response(trembling).reshape(-1, 11)[:, ::2]
    scale = steepest(spring) * np.max(np.abs(path))
    wrong = np.abs(force - spring.response(path)[:, None]) / scale
    assert np.max(wrong) < 50 * digits * EPS


@pytest.mark.parametrize("name", SPRINGS)
def test_steps_of_the_last_digit_walk_through_a_corner(name):
    """From 1000 steps before the corner to 1000 behind it and back, as far as it is exact."""
    spring = SPRINGS[name]
    corner = 0.0 if name == "compression" else getattr(spring, "d_c", yield_of(spring))
    step = np.spacing(corner) if corner else 1e-20
    path = corner + step * np.concatenate([np.arange(-1000, 1000), np.arange(1000, -1000, -1)])
    force = spring.response(path)
    straight = steepest(spring) * np.minimum(path, corner)
    bound = 8 * EPS * steepest(spring) * corner + 2100 * step * steepest(spring)
    assert np.max(np.abs(force - straight)) < bound


@pytest.mark.parametrize("name", SPRINGS)
@pytest.mark.parametrize("value", [5e-324, -2e-310, 1e-200])
def test_denormal_deformations_are_moves_like_others(name, value):
    spring = SPRINGS[name]
    path = np.array([value, -value, 2 * value, 0.0])
    force = spring.response(path)
    expected = steepest(spring) * path
    if name == "compression":
        expected = np.minimum(expected, 0.0)
    np.testing.assert_allclose(force, expected, rtol=1e-10, atol=steepest(spring) * 1e-323)


# ---- columns -------------------------------------------------------------------------------------


def column(n: int, kinematics: str = "small", load: float = 0.0) -> rbsdem.Column:
    return rbsdem.Column(
        1.6, 614.4, BILINEAR, TAKEDA["kc"], n=n, kinematics=kinematics, axial_load=load
    )


@pytest.mark.filterwarnings("ignore:the (rotation of a body|top) goes beyond")
@pytest.mark.parametrize("n", [1, 3])
def test_column_from_1e_12_to_1e6_times_yield_has_its_springs_on_their_paths(n):
    """Driven by displacement and by force; every spring sees its own force (statics)."""
    rng = np.random.default_rng(4)
    path = 3e-3 * rng.choice([-1.0, 1.0], 300) * 10 ** rng.uniform(-12, 6, 300)
    run = rbsdem.cyclic(column(n), displacement=path)
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
    again = rbsdem.cyclic(column(n), force=run.force)
    np.testing.assert_allclose(again.displacement, path, atol=1e-10 * np.max(np.abs(path)))


def measure_column(n: int, kinematics: str, cycle: int, cycles: int) -> tuple[float, float, float]:
    """Repeat a random cycle, and compare its begin from the third time on.

    Change of the force over the largest force; energy that the balance misses over the largest
    energy; change of the slips over the largest slip.
    """
    rng = np.random.default_rng(6)
    path = 0.03 * rng.uniform(-1, 1, cycle)
    path[[0, cycle // 2]] = 0.033, -0.033
    run = rbsdem.cyclic(column(n, kinematics, 1e5), displacement=np.tile(path, cycles), every=cycle)
    whole = rbsdem.cyclic(column(n, kinematics, 1e5), displacement=np.tile(path, 4))
    peak = np.max(np.abs(whole.force))
    return (
        float(np.max(np.abs(run.force[3:-1] - run.force[3])) / peak),
        run.summary["relative_energy_residual"],
        float(np.max(np.abs(run.slip[3:-1] - run.slip[3])) / np.max(np.abs(whole.slip))),
    )


@pytest.mark.parametrize(
    ("n", "kinematics", "cycles"), [(1, "small", 2000), (3, "pdelta", 300), (2, "finite", 20)]
)
def test_repeated_cycles_of_a_column_do_not_drift(n, kinematics, cycles):
    change, left, slip = measure_column(n, kinematics, 50, cycles)
    close = 1e-9 if kinematics == "finite" else 1e-13
    assert change < close
    assert slip < close
    assert left < (1e-6 if kinematics == "finite" else 1e-11)
