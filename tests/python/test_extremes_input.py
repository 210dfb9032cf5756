"""Extremes of the input: what is only just allowed must run; threads.

What is not allowed: `test_messages.py`, `test_hostile.py`.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

IMPLICIT = ("newmark", "hht", "generalised_alpha")
METHODS = ("rk4", "rk45", *IMPLICIT)


def test_numbers_at_the_edge_of_meaning_run():
    """The largest and smallest that are allowed, in the units that go with them."""
    for length, mass in ((1e-24, 1e-49), (1e24, 1e49), (1e-24, 1e49), (1e24, 1e-49)):
        k_v = min(max(mass, 1e-49), 1e49)
        k_m = min(max(k_v * length**2, 1e-49), 1e49)
        k_v = k_m / length**2
        if not 1e-50 < k_v < 1e50:
            continue
        column = rbsdem.Column(length, mass, Elastic(k_v), Elastic(k_m), n=2)
        omega = rbsdem.modes(column).omega
        assert np.all(np.isfinite(omega))
        assert np.all(omega > 0)
        period = 2 * np.pi / omega[0]
        if not 1e-40 < period < 1e40:
            continue
        for method in METHODS:
            run = rbsdem.time_history(
                column, np.linspace(0.0, period, 5), method=method,
                initial={"rotation": [1e-3, 1e-3]},
            )  # fmt: skip
            assert np.all(np.isfinite(run.slip))
            assert np.max(np.abs(run.rotation)) < 0.1


def jobs():
    """Every analysis and method, each with springs that remember."""
    shear = Bilinear(7.0387e8, 1.2960e-4, 8.3185e6)
    flexure = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
    rng = np.random.default_rng(8)
    times, ground = 2e-3 * np.arange(60), rng.uniform(-30, 30, 60)
    path = rng.uniform(-0.04, 0.04, 40)
    for n, level, opens in ((1, "small", False), (3, "pdelta", True), (12, "finite", False)):
        column = rbsdem.Column(
            1.6, 614.4, shear, flexure, n=n, kinematics=level, axial_load=1e5,
            axial_spring=Compression(1e9) if opens else None, top_mass=500.0,
        )  # fmt: skip
        yield lambda c=column: rbsdem.cyclic(c, displacement=path[: 40 // c.n])
        yield lambda c=column: rbsdem.cyclic(c, force=3e5 * path)
        for method in METHODS:
            yield lambda c=column, m=method: rbsdem.time_history(
                c, times, ground_acceleration=ground, method=m
            )
        yield lambda c=column: rbsdem.time_history(
            c, times, ground_acceleration=ground, events="located", method="rk4"
        )
    yield lambda: flexure.response(np.tile(path, 50))
    yield lambda: rbsdem.modes(column)


def same(one, other) -> bool:
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, dict):
        return all(same(one[key], other[key]) for key in one)
    if hasattr(one, "__dataclass_fields__"):
        return all(same(getattr(one, key), getattr(other, key)) for key in one.__dataclass_fields__)
    return one == other


@pytest.mark.filterwarnings("ignore:the rotation of a body")
@pytest.mark.parametrize("threads", [4])
def test_threads_at_once_give_the_bits_of_one_alone(threads):
    alone = [job() for job in jobs()]
    with ThreadPoolExecutor(threads) as pool:
        many = [pool.submit(job) for _ in range(threads) for job in jobs()]
        for i, run in enumerate(many):
            assert same(alone[i % len(alone)], run.result()), i
