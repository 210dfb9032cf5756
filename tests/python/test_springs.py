"""The Takeda rule by hand and against an independent method; input of all springs.

Further sequences by hand are in the Fortran suite `takeda`. What holds for every
rule to the last bit is in `test_invariants.py`. ``reference_springs`` is a second implementation
written from the same rules.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import reference_springs
from numpy.typing import ArrayLike, NDArray

import rbsdem
from rbsdem.model.springs import SPRINGS
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    PeakOriented,
    Pinching,
    SteelSpring,
    Takeda,
)

Array = NDArray[np.float64]

INNER = ("kc", "kr", "one")


EPSILON = float(np.finfo(float).eps)

# Table 3, Soesianawati No 1 (kN m and rad as printed there; here numbers only)
KC, DC, KY, DY, KU = 2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6
B0, B1 = 0.4, 0.22
COLUMN_1: dict[str, Any] = {
    "k_c": KC, "d_c": DC, "k_y": KY, "d_y": DY, "k_u": KU, "b0": B0, "b1": B1,
}  # fmt: skip
FC = KC * DC
FY = FC + KY * (DY - DC)
K0 = (FC + FY) / (DC + DY)


def response(spring: Any, path: ArrayLike) -> Array:
    return spring.response(np.asarray(path, dtype=float))


# F_c = 1, F_y = 2.5, K_0 = 0.5
ROUND = {"k_c": 1.0, "d_c": 1.0, "k_y": 0.3, "d_y": 6.0, "k_u": 0.01}


def test_takeda_zero_force_is_passed_only_beyond() -> None:
    """At exactly the zero crossing O(+) still leads back to its peak, and so does an ulp beyond."""
    spring = Takeda(**COLUMN_1)
    peak = 4 * DY
    zero = peak - (FY + 3 * KU * DY) / (K0 * (1 / 4) ** B0)
    for turn in (zero, math.nextafter(zero, -1), math.nextafter(zero, 1), zero - 1e-13 * DY):
        path = [peak, -peak, peak, turn, 2.5 * DY, 2.4 * DY, peak, 5 * DY]
        force = response(spring, path)
        line = K0 * (1 / 4) ** B0 * (np.array([2.5, 2.4]) * DY - zero)
        np.testing.assert_allclose(force[4:6], line, rtol=1e-9)
        np.testing.assert_allclose(force[6:], [FY + 3 * KU * DY, FY + 4 * KU * DY], rtol=1e-12)


def test_takeda_zero_force_reached_exactly_is_not_passed() -> None:
    """Numbers without round-off: F_y = 2, K_0 = 1/2, peak (8, 2), zero force at 4.

    Short of the crossing and at it O(+) runs both ways, so that 6 is no inner peak. Any distance
    beyond it is, and then the last loading aims at (6, 1) first.
    """
    spring = Takeda(k_c=1.0, d_c=1.0, k_y=0.25, d_y=5.0, k_u=0.0, b0=0.0, inner="one")
    zero = 3 - (1 / 6) / -0.5  # of I(-) from (3, -1/6)
    to_the_peak = 2 / (8 - zero) * (7 - zero)
    for turn in (4.0, math.nextafter(4.0, 5.0)):
        force = response(spring, [8, -8, 8, turn, 6, 3, 7])
        np.testing.assert_allclose(force[4:], [1, -1 / 6, to_the_peak], rtol=1e-12)
    for turn in (math.nextafter(4.0, 3.0), 4.0 - 1e-13, 4.0 - 1e-11):
        force = response(spring, [8, -8, 8, turn, 6, 3, 5, 7])
        to_6 = 1 / (6 - zero) * (5 - zero)
        np.testing.assert_allclose(force[4:], [1, -1 / 6, to_6, 1.5], rtol=1e-9)


@pytest.mark.parametrize("inner", ["kc", "kr", "one"])
def test_takeda_back_at_its_peak_but_for_round_off_unloads_from_it(inner: Any) -> None:
    """Not by the inner unloading, which has the slope of reloading with b1 = 0.01."""
    spring = Takeda(**ROUND, b1=0.01, inner=inner)
    outer = (1.6 + 1) / (3 + 1)
    for turn in (3.0 - 1e-14, 3.0, 3.0 + 1e-14):
        force = spring.response([3.0, -3.0, turn, 2.0])
        assert force[-2:] == pytest.approx([1.6, 1.6 - outer], rel=1e-12)


def random_parameters(rng: np.random.Generator, kind: str, extreme: bool) -> dict[str, Any]:
    """Valid parameters over the ranges of section 3 and their ends, or beyond them."""
    k, d = 10 ** rng.uniform(0, 10), 10 ** rng.uniform(-5, 0)
    post = rng.choice([0.0, 0.9, rng.uniform(0.01, 0.9)], p=[0.15, 0.05, 0.8])
    share, beyond = rng.uniform(0.05, 0.9), rng.choice([1.05, rng.uniform(1.05, 15)], p=[0.1, 0.9])
    b0 = rng.choice([0.0, 0.4, 1.0, rng.uniform(0, 1)], p=[0.1, 0.3, 0.1, 0.5])
    b1 = rng.uniform(0.05, 1.5)
    if extreme:
        share = rng.choice([1e-6, 1e-3, 0.05, 0.5, 0.999])
        beyond, post = rng.choice([1.0001, 1.05, 5, 100]), rng.choice([0.0, 1e-3, 0.5, 1.0])
        b0, b1 = rng.choice([0.0, 0.5, 1.0, 1.5]), rng.choice([1e-3, 0.2, 1.0, 5.0])
    given = {"k_c": k, "d_c": d, "k_y": k * share, "d_y": d * beyond, "k_u": k * share * post}
    return given | {"b0": b0, "b1": b1, "inner": kind}


def random_path(rng: np.random.Generator, spring: Any, points: int, exact: bool) -> Array:
    """A growing, decaying or irregular history with exact returns.

    It goes back to earlier points, to cracking and yield points, to zero deformation, and to
    zero crossings of unloading lines. The reference ``spring`` walks along to know where these are.

    A turn at a zero crossing comes in two sorts. ``exact``: there or one floating-point number
    beside it. Round-off decides whether that is short of the crossing or beyond, and with it
    whether the next reversal is an inner peak, so that two computations may rightly differ from
    there on. Otherwise: clearly short of it or beyond, by 1e-13 or 1e-9 of the deformation.
    """
    special = [s * x for x in (spring.d_c, spring.d_y) for s in (1, -1)]
    size = spring.d_y * rng.choice([0.4, 1.2, 3.0, 8.0])
    along = np.linspace(0, 1, points)
    sizes = size * [0.2 + along, 1.02 - along, rng.exponential(1, points)][rng.integers(3)]
    path: list[float] = []
    way = rng.choice([-1, 1])
    while len(path) < points:
        way = -way
        choice = rng.random()
        a = sizes[len(path)]
        if choice < 0.35:
            d = way * a * rng.uniform(0.7, 1)
        elif choice < 0.65 or not path:
            d = a * rng.uniform(-1, 1)
        elif choice < 0.85:
            d = path[rng.integers(len(path))]
        elif choice < 0.9:
            d = rng.choice([*special, 0.0])
        else:
            path.append(float(spring.d - 0.1 * spring.f / spring.k_c))
            spring.move(path[-1])
            d = spring.zero if abs(spring.zero) <= 10 * size else 0.0
            if exact:
                d = rng.choice([d, d * (1 - EPSILON), d * (1 + EPSILON)])
            else:
                d += rng.choice([-1, 1]) * rng.choice([1e-13, 1e-9]) * (abs(d) + spring.d_y)
        path.append(float(d))
        spring.move(path[-1])
    return np.array(path[:points])


def random_cases(seed: int, kind: str, count: int, points: int, **how: bool) -> Iterator[tuple]:
    """Yield a spring, its second implementation and a path."""
    rng = np.random.default_rng([seed, INNER.index(kind)])
    for _ in range(count):
        numbers = random_parameters(rng, kind, how.get("extreme", False))
        second = reference_springs.Takeda(**numbers)
        path = random_path(rng, second, points, how.get("exact", False))
        yield Takeda(**numbers), second, path


@pytest.mark.parametrize("kind", INNER)
@pytest.mark.parametrize(
    ("seed", "count", "points", "extreme"),
    [(101, 300, 40, False), (102, 150, 60, True), (103, 10, 600, False)],
    ids=["ordinary", "extreme", "long"],
)
def test_reference_agrees(kind: str, seed: int, count: int, points: int, extreme: bool) -> None:
    for spring, second, path in random_cases(seed, kind, count, points, extreme=extreme):
        expected = second.response(path)
        near = 1e-9 * max(np.abs(expected).max(), spring.response([spring.d_y])[0])
        np.testing.assert_allclose(spring.response(path), expected, rtol=0, atol=near)


@pytest.mark.parametrize("kind", INNER)
def test_waiting_and_cutting_short_at_exact_crossings(kind: str) -> None:
    """Time does not enter, and a spring keeps nothing of a call: not a bit changes."""
    for spring, _, path in random_cases(20, kind, 300, 40, exact=True):
        force = spring.response(path)
        assert np.array_equal(spring.response(np.repeat(path, 3)), np.repeat(force, 3))
        for cut in (5, 17, 32):
            assert np.array_equal(spring.response(path[:cut]), force[:cut])


def test_shapes_of_the_deformation() -> None:
    spring = Takeda(k_c=4.0, d_c=1.0, k_y=2.0, d_y=3.0, k_u=0.5)
    path = np.array([0.1, 2.0, -1.0, 5.0, 0.0])
    force = spring.response(path)
    assert isinstance(force, np.ndarray)
    assert force.shape == path.shape
    assert force.dtype == np.float64
    assert np.array_equal(spring.response(path.tolist()), force)
    assert np.array_equal(spring.response(tuple(path)), force)
    assert np.array_equal(spring.response(np.repeat(path, 2)[::2]), force)
    assert np.array_equal(spring.response([1, 2, -3]), spring.response([1.0, 2.0, -3.0]))
    empty = spring.response([])
    assert (empty.shape, empty.dtype) == ((0,), np.float64)
    for shape in ((2, 3), (1, 1), (0, 2)):
        with pytest.raises(rbsdem.InputError):
            spring.response(np.zeros(shape))
    path.flags.writeable = False
    assert np.array_equal(spring.response(path), force)


def test_concrete_is_straight_to_a_peak_that_is_all_but_elastic() -> None:
    """Popovics' curve has no bend where f_peak is k d_peak but for round-off: its limit."""
    k, d_peak, k_soft = 76608443.77002211, 0.0013053391385967734, 14043017.5
    spring = ConcreteSpring(k=k, f_peak=1e5, d_peak=d_peak, k_soft=k_soft)
    d = -d_peak * np.array([0.1, 0.6, 0.3, 0.9, 1.0])
    assert response(spring, d) == pytest.approx(k * d, rel=1e-12)
    assert response(spring, np.array([-2 * d_peak]))[0] == pytest.approx(k_soft * d_peak - 1e5)


#: A spring of each rule with every corner that it has; the sides of the capped ones differ.
_CAPPED: dict[str, Any] = {
    "d_y": 4.0, "f_y": 9.0, "d_cap": 6.0, "f_cap": 10.0, "d_pc": 9.0, "d_c": 1.0, "f_c": 4.0,
    "d_y_neg": 3.0, "f_y_neg": 7.0, "d_cap_neg": 5.0, "f_cap_neg": 8.0,
    "d_c_neg": 0.0, "f_c_neg": 0.0,
}  # fmt: skip
CORNERS: dict[str, Any] = {
    "elastic": Elastic(2.0),
    "bilinear": Bilinear(k=2.0, d_y=3.0, k_post=0.1),
    "takeda": Takeda(k_c=4.0, d_c=1.0, k_y=2.0, d_y=3.0, k_u=0.1),
    "peak_oriented": PeakOriented(**_CAPPED),
    "pinching": Pinching(kappa_f=0.4, kappa_d=0.6, **_CAPPED),
    "compression": Compression(k=2.0),
    "concrete": ConcreteSpring(k=8.0, f_peak=9.0, d_peak=4.0, k_soft=2.0),
    "steel": SteelSpring(k=4.0, f_y=8.0, k_post=0.5, f_u=9.0, plateau=1.0),
    "layered": Layered([(-1.0, Elastic(1.0)), (1.0, Elastic(1.0))]),
}


@pytest.mark.parametrize("rule", sorted(SPRINGS.keys() - {""}))
def test_a_rule_says_where_it_cracks_yields_and_caps(rule: str) -> None:
    """Each landmark is a corner of the virgin curve; behind a cap, and only there, it falls."""
    spring = CORNERS[rule]
    marks = spring.landmarks()
    assert all(mark.deformation > 0 for mark in marks)
    step = 1e-3
    for side in (1, -1):
        d = np.arange(0.0, 8.0 + step / 2, step)
        slopes = np.diff(side * response(spring, side * d)) / step
        bends = d[1:-1][np.abs(np.diff(slopes)) > 1e-6]
        own = {mark.name: mark.deformation for mark in marks if mark.side == side}
        falls = d[:-1][slopes < -1e-6]
        assert falls.min(initial=math.inf) == pytest.approx(own.get("cap", math.inf), abs=2 * step)
        first = min((at for name, at in own.items() if name != "cap"), default=math.inf)
        if rule != "concrete":  # A curve of many short lines from the start.
            assert bends.min(initial=math.inf) == pytest.approx(first, abs=2 * step)
        for at in own.values():
            assert abs(bends - at).min() <= 2 * step
