"""Extremes of the record: far from time zero, an hour long, odd spacing, gaps, jumps, no end.

Linear columns have an exact answer to loads that are linear between their points, whatever the
spacing: the matrix exponential, point by point. `measure_...` take the length of the record: short
here, an hour in studies/extremes.py.
"""

from __future__ import annotations

import os
import re
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import expm

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


def exact(times: np.ndarray, force: np.ndarray, ground: np.ndarray) -> np.ndarray:
    """Slip and rotation of SOFT from rest, exact for straight lines between the points."""
    half = HEIGHT / 2
    mass = MASS * np.array([[1.0, half], [half, half**2 + HEIGHT**2 / 12]])
    system = np.zeros((8, 8))  # q, q', loads, slopes of the loads
    system[:2, 2:4] = np.eye(2)
    system[2:4, :2] = -np.linalg.solve(mass, np.diag([K_V, K_M]))
    system[2:4, 2:4] = -np.eye(2)
    system[2:4, 4] = np.linalg.solve(mass, [1.0, HEIGHT])
    system[2:4, 5] = -np.linalg.solve(mass, MASS * np.array([1.0, half]))
    system[4:6, 6:] = np.eye(2)
    carried: dict[float, np.ndarray] = {}
    rows, state = [np.zeros(2)], np.zeros(4)
    loads = np.column_stack([force, ground])
    for spacing, now, then in zip(
        np.round(np.diff(times), 15).tolist(), loads[:-1], loads[1:], strict=True
    ):
        if spacing not in carried:
            carried[spacing] = expm(system * spacing)[:4]
        state = carried[spacing] @ np.concatenate([state, now, (then - now) / spacing])
        rows.append(state[:2])
    return np.array(rows)


def deformations(run: rbsdem.Result) -> np.ndarray:
    return np.hstack([run.slip, run.rotation])


# ---- far from time zero --------------------------------------------------------------------------


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


# ---- long records --------------------------------------------------------------------------------

SETTINGS = {
    "rk4": {"dt": 1e-3},
    "rk45": {"tolerance": 1e-8},
    "newmark": {"dt": 1e-4},
    "hht": {"dt": 1e-4, "rho_infinity": 0.9},
    "generalised_alpha": {"dt": 1e-4, "rho_infinity": 0.9},
}


def measure_long_record(method: str, seconds: float) -> tuple[float, float]:
    """Largest error relative to the peak, in the first and in the last tenth of a record.

    Points at 0.005 s, force and ground motion together: noise that is smoothed over 0.05 s.
    """
    points = round(seconds / 0.005) + 1
    rng = np.random.default_rng(1)
    smooth = np.hanning(10) / np.sum(np.hanning(10))
    force, ground = (np.convolve(rng.normal(size=points), smooth, "same") for _ in range(2))
    times = np.arange(points) * 0.005
    run = rbsdem.time_history(
        SOFT,
        times,
        force=1e4 * force,
        ground_acceleration=3 * ground,
        method=method,
        **SETTINGS[method],
    )
    wrong = np.abs(deformations(run) - exact(times, 1e4 * force, 3 * ground))
    wrong = np.max(wrong / np.max(np.abs(deformations(run)), axis=0), axis=1)
    tenth = points // 10
    return np.max(wrong[:tenth]), np.max(wrong[-tenth:])


@pytest.mark.parametrize(("method", "close"), [
    ("rk4", 5e-4), ("rk45", 2e-6), ("newmark", 2e-3), ("hht", 2e-3), ("generalised_alpha", 2e-3)
])  # fmt: skip
def test_long_record_is_as_exact_at_its_end(method, close):
    first, last = measure_long_record(method, 30.0)
    assert first < close
    assert last < close
    assert last < 10 * first


def resident() -> int:
    """Return the memory of this process in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def measure_memory(method: str, runs: int, seconds: float) -> int:
    """Growth of the memory of the process over the second half of a number of runs [bytes]."""
    begin = 0
    for run in range(runs):
        if run == runs // 2:
            begin = resident()
        rbsdem.time_history(
            YIELDING, [0.0, seconds], force=[0.0, 1e5], method=method, every=1000,
            initial={"slip_velocity": [1.0], "rotation_velocity": [0.3]},
        )  # fmt: skip
    return resident() - begin


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="no /proc on this system")
@pytest.mark.parametrize("method", METHODS)
def test_memory_does_not_grow_from_run_to_run(method):
    assert measure_memory(method, 40, 1.0) < 2e6


# ---- odd spacing, gaps, jumps --------------------------------------------------------------------


@cache
def odd_record() -> tuple[np.ndarray, ...]:
    """Times from 1e-9 s apart to a gap of 2 s, two loads and the exact answer."""
    rng = np.random.default_rng(2)
    spacing = np.concatenate([10 ** rng.uniform(-9, -1, 300), [2.0], np.full(20, 0.01)])
    times = np.round(np.concatenate([[0.0], np.cumsum(spacing)]), 12)
    force, ground = 1e4 * np.sin(9 * times), np.sin(7 * times)
    return times, force, ground, exact(times, force, ground)


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


@pytest.mark.parametrize(
    ("times", "text"),
    [
        ([0.0], r"time: 1 point\(s\); give two or more"),
        ([0.0, 1.0, 1.0, 2.0], "time: value 3 of 4, 1 s, does not come after the one before"),
        ([0.0, 2.0, 1.0], "time: value 3 of 3, 1 s, does not come after the one before, 2 s"),
        ([0.0, np.nan, 1.0], "time: value 2 of 3 is NaN"),
        ([0.0, 1.0, np.inf], "time: value 3 of 3 is Inf"),
        ([-np.inf, 1.0], "time: value 1 of 2 is -Inf"),
        ([0.0, 1e60], "time: value 2 of 2 is 1e[+]?60"),
        ([0.0, 5e-324, 1.0], "time: value 2 of 3"),
        ([0.0, 1.0, 1e12], r"analysis: [.e+\d]+ steps of [-.e\d]+ s are more than 2e\+09"),
    ],
)
@pytest.mark.parametrize("method", METHODS)
def test_times_that_cannot_be_are_refused_by_index(times, text, method):
    loads = {"force": np.ones(len(times)), "ground_acceleration": np.ones(len(times))}
    with pytest.raises(rbsdem.InputError, match=text):
        rbsdem.time_history(SOFT, times, method=method, **loads)


@pytest.mark.parametrize(
    ("rows", "text"),
    [
        ("0.0,0.0", "1 "),
        ("0.0,0.0\n0.01,\n0.02,0.1", "line 3"),
        ("0.0,0.0\n0.01,nan\n0.02,0.1", "line 3"),
        ("0.0,0.0\n0.01,1e999\n0.02,0.1", "line 3"),
        ("0.0,0.0\n0.02,0.1\n0.02,0.1", "0.02"),
        ("0.0,0.0\n0.02,0.1\n0.01,0.1", "0.01"),
    ],
)
def test_records_with_gaps_and_repeats_are_refused_by_line(
    run_cli, dynamic_text, tmp_path, rows, text
):
    (tmp_path / "motion.csv").write_text(f"time_s,acceleration_g\n{rows}\n", "utf-8")
    case = dynamic_text(loading="drive = 'ground_acceleration', file = 'motion.csv'")
    (tmp_path / "case.nml").write_text(case, "utf-8")
    run = run_cli(["check", "case.nml"], tmp_path)
    assert run.returncode == 2
    assert "motion.csv" in run.stderr or "time" in run.stderr
    assert re.search(re.escape(text), run.stderr), run.stderr
