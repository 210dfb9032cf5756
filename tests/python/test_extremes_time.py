"""Extremes of the record: far from time zero, long, odd spacing, gaps, jumps, no end.

Linear columns have an exact answer to loads that are linear between their points, whatever the
spacing (`reference_chain.Linear`).
"""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from reference_chain import Linear, deformations

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Takeda

IMPLICIT = ("newmark", "hht", "generalised_alpha")
METHODS = ("rk4", "rk45", *IMPLICIT)

HEIGHT, MASS, K_V, K_M = 3.0, 1000.0, 4e6, 3e6
SOFT = rbsdem.Column(HEIGHT, MASS, Elastic(K_V), Elastic(K_M), damping=rbsdem.Damping(mass=1.0))
YIELDING = rbsdem.Column(
    1.6, 614.4, Bilinear(7e8, 1.3e-4, 8e6),
    Takeda(2.5e8, 3e-4, 6e7, 2.7e-3, 7.5e6, b1=0.22),
)  # fmt: skip


@pytest.mark.parametrize("begin", [2.0**20, 2.0**30, 2.0**40, -(2.0**30)])
@pytest.mark.parametrize("method", METHODS)
def test_clock_far_from_zero_changes_nothing(method, begin):
    """Twelve days, the seconds since 1970 and 35000 years; times with all their digits.

    Where the clock is read only for the loads, and there are none, not a bit changes. With error
    control the steps are others in the last digits.
    """
    times = np.arange(0, 33) / 64
    initial = {"slip_velocity": [1.0], "rotation_velocity": [0.3]}
    options = {"tolerance": 1e-9} if method == "rk45" else {}
    near = rbsdem.time_history(YIELDING, times, method=method, initial=initial, **options)
    far = rbsdem.time_history(YIELDING, begin + times, method=method, initial=initial, **options)
    assert near.summary["events"] > 5
    assert np.array_equal(far.time, begin + times)
    if method == "rk45":
        np.testing.assert_allclose(
            deformations(far), deformations(near), atol=1e-7 * np.max(np.abs(near.rotation))
        )
    else:
        assert np.array_equal(deformations(far), deformations(near))


@pytest.mark.parametrize(
    "options", [{"method": "rk4"}, {"method": "rk4", "events": "located"}, {"method": "rk45"}]
)
def test_clock_far_from_zero_with_loads(options):
    """The load is looked up at a time that is rounded to 2.4e-7 s at 2^30 s."""
    times = np.arange(0, 65) / 64
    force = 5e3 * np.sin(20 * times)
    near = rbsdem.time_history(SOFT, times, force=force, **options)
    far = rbsdem.time_history(SOFT, 2.0**30 + times, force=force, **options)
    close = 20 * 2.4e-7 * np.max(np.abs(near.displacement))
    np.testing.assert_allclose(far.displacement, near.displacement, atol=close)
    assert far.summary["steps"] < 1.5 * near.summary["steps"]


def resident() -> int:
    """Return the memory of this process in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc on this system")
@pytest.mark.parametrize("method", METHODS)
def test_memory_does_not_grow_from_run_to_run(method):
    """Over the second half of a number of runs."""
    begin = 0
    for run in range(40):
        if run == 20:
            begin = resident()
        rbsdem.time_history(
            YIELDING, [0.0, 1.0], force=[0.0, 1e5], method=method, every=1000,
            initial={"slip_velocity": [1.0], "rotation_velocity": [0.3]},
        )  # fmt: skip
    assert resident() - begin < 2e6


@cache
def odd_record() -> tuple[np.ndarray, ...]:
    """Times from 1e-9 s apart to a gap of 2 s, two loads and the exact answer."""
    rng = np.random.default_rng(2)
    spacing = np.concatenate([10 ** rng.uniform(-9, -1, 300), [2.0], np.full(20, 0.01)])
    times = np.round(np.concatenate([[0.0], np.cumsum(spacing)]), 12)
    force, ground = 1e4 * np.sin(9 * times), np.sin(7 * times)
    rows = Linear(SOFT).solve(times, np.column_stack([force, ground]))
    return times, force, ground, rows[:, :2]


@pytest.mark.parametrize(("method", "close"), [
    ("rk4", 3e-3), ("rk45", 3e-4), ("newmark", 5e-2), ("hht", 5e-2), ("generalised_alpha", 5e-2)
])  # fmt: skip
def test_odd_spacing_of_times(method, close):
    """From 1e-9 s to a gap of 2 s; every point is met and every straight line followed."""
    times, force, ground, expected = odd_record()
    run = rbsdem.time_history(SOFT, times, force=force, ground_acceleration=ground, method=method)
    assert np.array_equal(run.time, times)
    np.testing.assert_allclose(
        deformations(run) / np.max(np.abs(expected), axis=0),
        expected / np.max(np.abs(expected), axis=0), atol=close,
    )  # fmt: skip


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("width", [0.0, 1e-14, 1e-9])
def test_jump_of_a_load_within_the_last_digits_of_the_time(method, width):
    """From rest; then the deformations swing about those of equilibrium, mode by mode."""
    jump = 0.125
    times = np.arange(0, 4097) / 8192
    times = np.insert(times, 1025, max(np.nextafter(jump, 1), jump + width))
    force = np.where(times > jump, 1e4, 0.0)
    column = rbsdem.Column(HEIGHT, MASS, Elastic(K_V), Elastic(K_M))
    run = rbsdem.time_history(column, times, force=force, method=method)
    assert np.array_equal(run.time, times)
    modes = rbsdem.modes(column)
    share = modes.shapes.T @ [1e4, 1e4 * HEIGHT] / modes.omega**2
    after = np.maximum(times - jump, 0.0)
    swing = 1 - np.cos(np.outer(after, modes.omega))
    expected = share * swing @ modes.shapes.T
    close = {"rk4": 1e-7, "rk45": 1e-5}.get(method, 1e-3)
    np.testing.assert_allclose(
        deformations(run), expected, atol=close * np.max(np.abs(expected))
    )  # fmt: skip
