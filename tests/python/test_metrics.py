"""Metrics of curves against closed forms, and against the shared definitions where these are."""

from __future__ import annotations

import math
import types
from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest

from rbsdem import curves as comparison
from rbsdem.errors import InputError, RbsdemError, SolveError

SHARED = Path(__file__).resolve().parents[3] / "shared"


def rectangle(turns: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Rigid-plastic loop of +-2 in displacement and +-5 in force, from the upper left corner."""
    d = [-2.0, 2.0, 2.0, -2.0] * turns + [-2.0]
    f = [5.0, 5.0, -5.0, -5.0] * turns + [5.0]
    return np.array(d), np.array(f)


def ellipse(rows: int = 4001) -> tuple[np.ndarray, np.ndarray]:
    """Viscous loop of semi-axes 0.03 and 200: its area is pi times both."""
    angle = np.linspace(0.0, 2.0 * math.pi, rows)
    return 0.03 * np.sin(angle), 200.0 * np.cos(angle)


def elastoplastic() -> tuple[np.ndarray, np.ndarray]:
    """k = 10, yield at 1, one cycle of +-3 from rest and back to zero displacement."""
    d = np.array([0.0, 1.0, 3.0, 1.0, -3.0, -1.0, 0.0])
    f = np.array([0.0, 10.0, 10.0, -10.0, -10.0, 10.0, 10.0])
    return d, f


# ---- one curve -----------------------------------------------------------------------------------


def test_energy_of_a_rectangle_is_its_area():
    d, f = rectangle(turns=3)
    assert comparison.energy(d, f) == 3 * 4.0 * 10.0
    assert comparison.energy(d[::-1], f[::-1]) == -3 * 4.0 * 10.0


def test_energy_of_an_ellipse_is_pi_times_its_semi_axes():
    d, f = ellipse()
    assert comparison.energy(d, f) == pytest.approx(math.pi * 0.03 * 200.0, rel=1e-6)


def test_summary_of_an_elastoplastic_cycle():
    d, f = elastoplastic()
    loop = comparison.summarise(d, f)
    assert loop.peak_force == 10.0
    assert loop.displacement_at_peak == 1.0  # the first of equals
    assert loop.peak_displacement == 3.0
    assert loop.stiffness == 10.0
    # 5 + 20 to the first turn, 0 down to -10, 40 along the lower line, 0 up to 10, 10 to the end.
    assert loop.energy == 75.0


def test_peak_force_is_unsigned_and_its_displacement_is_signed():
    loop = comparison.summarise([0.0, 1.0, 0.0, -2.0], [0.0, 3.0, 0.0, -4.0])
    assert loop.peak_force == 4.0
    assert loop.displacement_at_peak == -2.0


@pytest.mark.parametrize(
    ("level", "slope"),
    [(0.25, 8.0), (0.5, 8.0), (0.625, 10.0 / 2.0), (0.875, 14.0 / 4.5), (1.0, 16.0 / 6.0)],
)
def test_secant_stiffness_is_taken_at_the_interpolated_first_crossing(level, slope):
    # Through (1, 8), (3, 12), (6, 16) and back.
    d, f = [0.0, 1.0, 3.0, 6.0, 0.0], [0.0, 8.0, 12.0, 16.0, 0.0]
    assert comparison.secant_stiffness(d, f, level=level) == pytest.approx(slope, rel=1e-15)


def test_secant_stiffness_on_a_negative_first_excursion():
    assert comparison.secant_stiffness([0.0, -2.0, 1.0], [0.0, -6.0, 1.0]) == 3.0


def test_secant_stiffness_skips_noise_below_the_level():
    # Force at no displacement, as Tanaka & Park No 5 and Zahn No 7 begin.
    d, f = [0.0, 0.0, 1.0, 4.0], [0.0, 2.0, 7.0, 10.0]
    assert comparison.secant_stiffness(d, f) == 7.0


def test_secant_stiffness_is_taken_at_70_per_cent_of_the_own_peak():
    d, f = [0.0, 1.0, 11.0], [0.0, 20.0, 40.0]
    assert comparison.STIFFNESS_LEVEL == 0.7
    assert comparison.secant_stiffness(d, f) == pytest.approx(28.0 / 5.0)
    assert comparison.summarise(d, f).stiffness == comparison.secant_stiffness(d, f)


@pytest.mark.parametrize(
    ("d", "f"),
    [
        ([0.0, 0.0, 1.0], [0.0, 5.0, 5.0]),  # at no displacement
        ([0.0, -1.0, 1.0], [0.0, 5.0, 5.0]),  # at a displacement of the other sign
        ([0.0, 1.0], [0.0, 0.0]),  # no force
    ],
)
def test_secant_stiffness_that_means_nothing_is_nan(d, f):
    assert math.isnan(comparison.secant_stiffness(d, f))


# ---- resampling ----------------------------------------------------------------------------------


def test_resampling_is_even_along_the_path():
    d = np.array([0.0, 3.0, 3.0, -1.0])
    path, again = comparison.resample(d, d, n=8)
    np.testing.assert_allclose(path, np.arange(8.0), atol=1e-14)
    np.testing.assert_allclose(again, [0, 1, 2, 3, 2, 1, 0, -1], atol=1e-14)


def test_of_rows_without_a_step_only_the_first_counts():
    _, f = comparison.resample([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 9.0, 2.0], n=5)
    np.testing.assert_allclose(f, [0.0, 0.5, 1.0, 1.5, 2.0], atol=1e-14)


# ---- two curves ----------------------------------------------------------------------------------


@pytest.mark.parametrize("make", [rectangle, ellipse, elastoplastic])
def test_identical_loops_have_no_error(make):
    d, f = make()
    metrics = comparison.compare((d, f), (d, f))
    assert metrics.nrmse == 0.0
    assert metrics.rms_best == pytest.approx(0.0, abs=1e-15)
    assert metrics.peak_ratio == metrics.end_ratio == 1.0
    assert astuple(metrics.test) == pytest.approx(astuple(metrics.model), rel=0.0, nan_ok=True)
    other = comparison.displacement_metrics(f, d, d)
    assert other.nrmse == other.rms_error == 0.0


@pytest.mark.parametrize("factor", [0.5, 2.0, -1.0])
def test_scaled_loop(factor):
    d, f = ellipse()
    metrics = comparison.compare((d, factor * f), (d, f))
    assert metrics.peak_ratio == abs(factor)
    assert metrics.energy_ratio == pytest.approx(factor, rel=1e-14)
    assert metrics.end_ratio == pytest.approx(abs(factor), rel=1e-14)
    assert metrics.rms_best == pytest.approx(0.0, abs=1e-15)
    # f/200 is the square root of 1 - s^2, and s goes 0, 1, 0, -1, 0 along the path.
    s = np.interp(np.linspace(0.0, 4.0, 2000), [0, 1, 2, 3, 4], [0, 1, 0, -1, 0])
    mean_square = np.mean(1.0 - s * s)
    assert metrics.nrmse == pytest.approx(abs(factor - 1.0) * math.sqrt(mean_square), rel=1e-5)


def test_error_of_a_constant_offset():
    d, f = elastoplastic()
    metrics = comparison.compare((d, f + 1.0), (d, f))
    assert metrics.nrmse == pytest.approx(0.1, rel=1e-14)


def test_error_counts_by_path_not_by_rows():
    # A hundred rows with an error of 1 in the first tenth of the path, two without in the rest.
    d = np.append(np.linspace(0.0, 1.0, 101), [1.0 + 1e-9, 10.0])
    test = np.ones_like(d)
    model = test + np.append(np.ones(101), [0.0, 0.0])
    metrics = comparison.compare((d, model), (d, test))
    assert metrics.nrmse == pytest.approx(math.sqrt(0.1), rel=2e-3)


def test_displacement_metrics_of_a_softer_model():
    f = np.array([0.0, 4.0, -4.0, 2.0])
    metrics = comparison.displacement_metrics(f, f / 2.0, f / 1.0)
    assert metrics.test.stiffness == 2.0
    assert metrics.model.stiffness == 1.0
    assert metrics.stiffness_ratio == 0.5
    assert metrics.peak_ratio == 1.0
    assert metrics.peak_displacement_ratio == metrics.displacement_at_peak_ratio == 2.0
    # The error is f/2, and f goes 0, 4, -4, 2 along its path of 4 + 8 + 6.
    at = np.interp(np.linspace(0.0, 18.0, 2000), [0, 4, 12, 18], f)
    assert metrics.rms_error == pytest.approx(0.5 * math.sqrt(np.mean(at * at)), rel=1e-12)
    assert metrics.nrmse == pytest.approx(metrics.rms_error / 2.0, rel=1e-15)


def test_energy_ratio_needs_a_test_that_dissipates():
    d, f = rectangle()
    assert comparison.compare((d, 2 * f), (d, f)).energy_ratio == 2.0
    assert math.isnan(comparison.compare((d[::-1], f), (d[::-1], f[::-1])).energy_ratio)


def test_metrics_do_not_depend_on_units():
    d, f = elastoplastic()
    si = comparison.compare((d, 1.3 * f + 2.0), (d, f))
    far = 1024.0 * d
    mm = comparison.compare((far, (1.3 * f + 2.0) / 1024.0), (far, f / 1024.0))
    assert mm.nrmse == si.nrmse
    assert mm.energy_ratio == si.energy_ratio
    assert mm.stiffness_ratio == si.stiffness_ratio


# ---- bad input -----------------------------------------------------------------------------------


def test_errors_are_of_the_usual_kinds():
    assert issubclass(InputError, RbsdemError)
    assert issubclass(InputError, ValueError)
    assert issubclass(SolveError, RbsdemError)
    assert issubclass(SolveError, RuntimeError)
    assert SolveError("stopped").result is None
    assert SolveError("stopped", "so far").result == "so far"
    assert str(SolveError("stopped", "so far")) == "stopped"


# ---- the shared definitions ----------------------------------------------------------------------

FILES = (
    "Soesianawati_et_al_1986_No1.csv",
    "Tanaka_and_Park_1990_No1.csv",
    "Tanaka_and_Park_1990_No5.csv",
    "Zahn_et_al_1986_No7.csv",
    "Gill_et_al_1979_No1.csv",
    "Watson_and_Park_1989_No9.csv",
    "Wehbe_et_al_1998_A1.csv",
    "Saatcioglu_and_Ozcebe_1989_U3.csv",
)


@pytest.mark.parametrize("name", FILES)
def test_agreement_with_the_shared_loop_metrics(name):
    definitions, history = SHARED / "loop_metrics.py", SHARED / "peer" / name
    if not (definitions.is_file() and history.is_file()):
        pytest.skip("no ../shared beside the checkout with loop_metrics.py and this history")
    shared = types.ModuleType("shared_loop_metrics")
    exec(compile(definitions.read_text(encoding="utf-8"), definitions, "exec"), shared.__dict__)
    d, f = np.loadtxt(history, delimiter=",", skiprows=1).T
    model = 1.2 * f + 0.05 * np.max(np.abs(f)) * np.sin(np.arange(len(f)))
    theirs, ours = shared.score(d, f, model), comparison.compare((d, model), (d, f))
    pairs = {
        "nrmse": ours.nrmse,
        "peak_ratio": ours.peak_ratio,
        "energy_ratio": ours.energy_ratio,
        "end_ratio": ours.end_ratio,
        "rms_best": ours.rms_best,
        "f_test_max": ours.test.peak_force,
        "f_model_max": ours.model.peak_force,
        "k70_ratio": ours.stiffness_ratio,
    }
    for metric, value in pairs.items():
        assert value == pytest.approx(theirs[metric], rel=1e-12, nan_ok=True), metric
