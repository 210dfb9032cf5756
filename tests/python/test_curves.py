"""Curves: energies, stiffness, half-cycles, loss of strength, scores, envelopes, in closed form."""

from __future__ import annotations

import math
import pickle
from dataclasses import astuple

import numpy as np
import pytest

import rbsdem
from rbsdem import curves as comparison
from rbsdem.curves import Envelope, metrics, strength_loss
from rbsdem.curves.scores import SCORES
from rbsdem.errors import InputError
from rbsdem.springs import Bilinear, Takeda

SHEAR = Bilinear(7e8, 1.3e-4, 8e6)
FLEXURE = Takeda(2.5e8, 3.2e-4, 6.3e7, 2.7e-3, 7.6e6, b1=0.3)


def rectangle(turns: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Rigid-plastic loop of +-2 in displacement and +-5 in force, from the upper left corner."""
    d = [-2.0, 2.0, 2.0, -2.0] * turns + [-2.0]
    f = [5.0, 5.0, -5.0, -5.0] * turns + [5.0]
    return np.array(d), np.array(f)


def ellipse(rows: int = 4001) -> tuple[np.ndarray, np.ndarray]:
    """Viscous loop of semi-axes 0.03 and 200: its area is pi times both."""
    angle = np.linspace(0.0, 2.0 * math.pi, rows)
    return 0.03 * np.sin(angle), 200.0 * np.cos(angle)


def cycle() -> tuple[np.ndarray, np.ndarray]:
    """k = 10, yield at 1, one cycle of +-3 from rest and back to zero displacement."""
    d = np.array([0.0, 1.0, 3.0, 1.0, -3.0, -1.0, 0.0])
    f = np.array([0.0, 10.0, 10.0, -10.0, -10.0, 10.0, 10.0])
    return d, f


def wave(turns: float, amplitude: float, rows: int = 400) -> np.ndarray:
    t = np.linspace(0.0, turns, rows)
    return amplitude * np.sin(2 * math.pi * t) * (0.5 + t / turns)


def elastoplastic(d: np.ndarray, k: float, f_y: float) -> np.ndarray:
    force, f = np.empty(d.size), 0.0
    for i, step in enumerate(np.diff(d, prepend=0.0)):
        f = min(max(f + k * step, -f_y), f_y)
        force[i] = f
    return force


@pytest.fixture(scope="module")
def curves() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Displacement [m], a test and another model [N]."""
    d = wave(5.0, 0.02)
    noise = np.random.default_rng(7).normal(0.0, 2e3, d.size)
    return d, elastoplastic(d, 3e7, 2e5) + noise, elastoplastic(d, 4e7, 2.4e5)


def test_energy_is_the_area():
    d, f = rectangle(turns=3)
    assert comparison.energy(d, f) == 3 * 4.0 * 10.0
    assert comparison.energy(d[::-1], f[::-1]) == -3 * 4.0 * 10.0
    assert comparison.energy(*ellipse()) == pytest.approx(math.pi * 0.03 * 200.0, rel=1e-6)


def test_summary_of_a_cycle():
    loop = comparison.summarise(*cycle())
    assert (loop.peak_force, loop.peak_displacement, loop.stiffness) == (10.0, 3.0, 10.0)
    assert loop.displacement_at_peak == 1.0  # the first of equals
    # 5 + 20 to the first turn, 0 down to -10, 40 along the lower line, 0 up to 10, 10 to the end.
    assert loop.energy == 75.0
    # The peak is unsigned and its displacement signed.
    loop = comparison.summarise([0.0, 1.0, 0.0, -2.0], [0.0, 3.0, 0.0, -4.0])
    assert (loop.peak_force, loop.displacement_at_peak) == (4.0, -2.0)


@pytest.mark.parametrize(
    ("d", "f", "level", "slope"),
    [
        # Through (1, 8), (3, 12), (6, 16) and back: the first crossing, interpolated.
        ([0, 1, 3, 6, 0], [0, 8, 12, 16, 0], 0.25, 8.0),
        ([0, 1, 3, 6, 0], [0, 8, 12, 16, 0], 0.625, 10.0 / 2.0),
        ([0, 1, 3, 6, 0], [0, 8, 12, 16, 0], 0.875, 14.0 / 4.5),
        ([0, 1, 3, 6, 0], [0, 8, 12, 16, 0], 1.0, 16.0 / 6.0),
        # On a negative first excursion.
        ([0, -2, 1], [0, -6, 1], 0.7, 3.0),
        # Force at no displacement, as Tanaka & Park No 5 and Zahn No 7 begin.
        ([0, 0, 1, 4], [0, 2, 7, 10], 0.7, 7.0),
        # Nothing to tell: at no displacement, at one of the other sign, without force.
        ([0, 0, 1], [0, 5, 5], 0.7, math.nan),
        ([0, -1, 1], [0, 5, 5], 0.7, math.nan),
        ([0, 1], [0, 0], 0.7, math.nan),
    ],
)
def test_secant_stiffness(d, f, level, slope):
    found = comparison.secant_stiffness(d, f, level=level)
    assert found == pytest.approx(slope, rel=1e-15, nan_ok=True)
    if level == metrics.STIFFNESS_LEVEL == 0.7:
        assert comparison.secant_stiffness(d, f) == pytest.approx(slope, nan_ok=True)


def test_resampling_is_even_along_the_path():
    d = np.array([0.0, 3.0, 3.0, -1.0])
    path, again = comparison.resample(d, d, n=8)
    np.testing.assert_allclose(path, np.arange(8.0), atol=1e-14)
    np.testing.assert_allclose(again, [0, 1, 2, 3, 2, 1, 0, -1], atol=1e-14)
    # Of rows without a step only the first counts.
    _, f = comparison.resample([0.0, 1.0, 1.0, 2.0], [0.0, 1.0, 9.0, 2.0], n=5)
    np.testing.assert_allclose(f, [0.0, 0.5, 1.0, 1.5, 2.0], atol=1e-14)


def test_turning_points_of_a_zigzag():
    d = [0.0, 1.0, -1.0, -1.0, 2.0, 1.99, 2.01, -2.0, 0.0]
    assert metrics.turning_points(d).tolist() == [1, 2, 6, 7]
    # Without a threshold every corner counts.
    assert metrics.turning_points(d, share=0.0).tolist() == [1, 2, 4, 5, 6, 7]
    for rows in ([], [1.0], [0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 2.0]):
        assert metrics.turning_points(rows).size == 0


def test_half_cycles_of_an_elastoplastic_spring():
    """Energy 2 F_y (2 a - 2 d_y) of a full cycle, damping 2/pi (1 - d_y/a) (Jacobsen)."""
    k, d_y, a = 10.0, 1.0, 4.0
    corners = np.array([0.0, a, -a, a, -a, 0.0])
    d = np.interp(np.linspace(0, 5, 5001), np.arange(6), corners)
    h = metrics.half_cycles(d, elastoplastic(d, k, k * d_y))
    assert h.displacement.tolist() == pytest.approx([a, -a, a, -a])
    assert h.peak_force.tolist() == pytest.approx([10.0, -10.0, 10.0, -10.0])
    assert h.stiffness.tolist() == pytest.approx(4 * [k * d_y / a])
    # The first half-cycle begins at rest: it has not the plastic way back.
    assert h.energy.tolist() == pytest.approx([30.0, 60.0, 60.0, 60.0], rel=1e-3)
    damping = 2 / math.pi * (1 - d_y / a)
    assert h.damping[1:].tolist() == pytest.approx(3 * [damping], rel=1e-3)
    # An elastic spring dissipates nothing.
    d = wave(4.0, 0.01, 4001)
    h = metrics.half_cycles(d, 5e6 * d)
    assert h.energy == pytest.approx(np.zeros(8), abs=1e-9)
    assert h.stiffness == pytest.approx(np.full(8, 5e6))


def test_the_zero_of_the_force_lies_between_two_rows():
    """Work 1.5 to the tip; the force falls from 1 to -1 on the next unit, and gives 0.25 back."""
    h = metrics.half_cycles([0.0, 1.0, 2.0, 1.0, 0.0], [0.0, 1.0, 1.0, -1.0, -1.0])
    assert h.row.tolist() == [2]
    assert h.energy.tolist() == [1.25]
    # A tip in the second row: its half-cycle begins in the first.
    assert metrics.half_cycles([0.0, 1.0, 0.0], [0.0, 1.0, 0.0]).peak_force.tolist() == [1.0]


def test_energy_of_the_half_cycles_is_that_of_the_path():
    d = wave(5.25, 0.02, 3001)
    f = elastoplastic(d, 3e7, 2e5)
    # It ends at a tip, and what is stored there is in the last one.
    h = metrics.half_cycles(d, f)
    assert h.row[-1] == d.size - 1
    assert h.energy.sum() == pytest.approx(comparison.energy(d, f), rel=1e-12)


def test_test_and_model_share_their_tips(curves):
    d, f, m = curves
    c = rbsdem.compare((d, m), (d, f))
    assert np.array_equal(c.test_cycles.row, c.model_cycles.row)
    assert c.model_cycles.peak_force == pytest.approx(
        np.sign(c.model_cycles.displacement) * 2.4e5, rel=1e-9
    )
    model = m.copy()
    model[200:] = np.nan
    half = rbsdem.compare((d, model), (d, f)).model_cycles
    assert 0 < len(half) < len(c.test_cycles)
    assert half.row.max() < 200


@pytest.mark.parametrize(
    ("d", "f", "lost"),
    [
        # 100 at 1, down to 0 at 5: 80 at 1.8, and so on the other side.
        ([0, 1, 5], [0, 100, 0], 1.8),
        ([0, -1, -5], [0, -100, 0], 1.8),
        # The second cycle to 2 carries 70 of 100: 80 was passed at 2; not if it goes half as far.
        ([0, 2, 0, -2, 0, 2, 0], [0, 100, 0, -100, 0, 70, 0], 2.0),
        ([0, 2, 0, -2, 0, 1, 0], [0, 100, 0, -100, 0, 70, 0], math.nan),
        # Positive side: 80 at 1.5; the negative one loses more, but later.
        ([0, 1, -1, 1, 2, -3], [0, 100, -100, 100, 60, -50], 1.5),
        # A cycle that crosses its former peak with less than 80 and stays below has lost it there,
        # row or no row; one that rises to 90 again has not.
        ([0, 1, -1, 2, -3], [0, 100, -100, 60, -50], 1.0),
        ([0, 1, -1, 2], [0, 100, -100, 90], math.nan),
        # A force between the envelopes is no strength: on the way back from 2 it is 300; pushed on
        # it goes from 100 to 70: 80 at 8/3.
        ([0, 1, 2, 1, 0, 2, 3], [0, 100, 100, 300, 0, 100, 70], 8 / 3),
        ([], [], math.nan),
        ([0], [0], math.nan),
        ([0, 1], [0, 1], math.nan),
    ],
)
def test_strength_loss(d, f, lost):
    d, f = (np.array(values, dtype=float) for values in (d, f))
    assert strength_loss(d, f) == pytest.approx(lost, nan_ok=True)
    if d.size < 3:
        assert len(metrics.half_cycles(d, f)) == (d.size == 2)


def test_drift_at_loss_of_test_and_model():
    d, f = np.array([0.0, 0.01, 0.05]), np.array([0.0, 1e5, 0.0])
    assert strength_loss(d, f, share=0.5) == pytest.approx(0.03)
    c = rbsdem.compare((d, 1e5 * np.array([0.0, 1.0, 1.0])), (d, f), height=2.0)
    assert c.test_drift_at_loss == pytest.approx(0.009)
    assert math.isnan(c.model_drift_at_loss)
    assert "0.0090, none" in str(c)


@pytest.mark.parametrize("factor", [1.0, 0.5, 2.0, -1.0])
def test_a_factor_of_the_force_is_a_factor_of_every_force_ratio(factor):
    d, f = ellipse()
    c = rbsdem.compare((d, factor * f), (d, f))
    assert c.peak_ratio == c.end_ratio == abs(factor)
    assert c.energy_ratio == pytest.approx(factor, rel=1e-14)
    assert c.rms_best == pytest.approx(0.0, abs=1e-15)
    # f/200 is the square root of 1 - s^2, and s goes 0, 1, 0, -1, 0 along the path.
    s = np.interp(np.linspace(0.0, 4.0, 2000), [0, 1, 2, 3, 4], [0, 1, 0, -1, 0])
    mean_square = np.mean(1.0 - s * s)
    assert c.nrmse == pytest.approx(abs(factor - 1.0) * math.sqrt(mean_square), rel=1e-5)
    d, f = cycle()
    assert rbsdem.compare((d, 2 * f), (d, f)).stiffness_ratio == 2.0
    # A ratio of energies needs a test that dissipates.
    d, f = rectangle()
    assert math.isnan(rbsdem.compare((d[::-1], f), (d[::-1], f[::-1])).energy_ratio)


def test_errors_count_by_path_not_by_rows():
    d, f = cycle()
    assert rbsdem.compare((d, f + 1.0), (d, f)).nrmse == pytest.approx(0.1, rel=1e-14)
    # A hundred rows with an error of 1 in the first tenth of the path, two without in the rest.
    d = np.append(np.linspace(0.0, 1.0, 101), [1.0 + 1e-9, 10.0])
    test = np.ones_like(d)
    model = test + np.append(np.ones(101), [0.0, 0.0])
    c = rbsdem.compare((d, model), (d, test))
    assert c.nrmse == pytest.approx(math.sqrt(0.1), rel=2e-3)
    # Units do not matter.
    same = rbsdem.compare((1024 * d, model / 1024), (1024 * d, test / 1024))
    assert same.nrmse == c.nrmse
    # Without any force it is the rms of the test: between +-3 a third, half of the path.
    d = np.array([0.0, 1.0, 0.0, -1.0, 0.0])
    f = np.array([3.0, 3.0, -3.0, -3.0, 3.0])
    c = rbsdem.compare((d, 0 * f), (d, f))
    assert (c.nrmse, c.peak_ratio) == (pytest.approx(math.sqrt(0.5 + 0.5 / 3), rel=1e-3), 0)


@pytest.mark.parametrize("share", [0.0, 0.2, 0.49, 0.51, 0.8, 1.0])
def test_what_was_not_reached_counts_as_the_largest_force(curves, share):
    """nrmse^2 = path_fraction nrmse_reached^2 + (1 - path_fraction)."""
    d, f, m = curves
    force = m.copy()
    force[round(share * d.size) :] = np.nan
    c = rbsdem.compare((d, force), (d, f))
    assert c.rows == round(share * d.size)
    inside = 0.0 if c.path_fraction == 0 else c.path_fraction * c.nrmse_reached**2
    assert c.nrmse == pytest.approx(math.sqrt(inside + 1 - c.path_fraction))
    # Ratios of less than half of the path would say nothing.
    assert math.isnan(c.peak_ratio) == math.isnan(c.energy_ratio) == (c.path_fraction < 0.5)
    assert math.isnan(c.end_ratio) == (c.path_fraction < 1)
    assert c.scores == {name: getattr(c, name) for name in SCORES} | c.scores
    assert repr(pickle.loads(pickle.dumps(c)).scores) == repr(c.scores)
    if share == 0:
        assert (c.nrmse, len(c.model_cycles), math.isnan(c.model_drift_at_loss)) == (1.0, 0, True)
        assert "none" in str(c)


def test_displacement_metrics_of_a_softer_model():
    f = np.array([0.0, 4.0, -4.0, 2.0])
    metrics = comparison.displacement_metrics(f, f / 2.0, f / 1.0)
    assert (metrics.test.stiffness, metrics.model.stiffness) == (2.0, 1.0)
    assert (metrics.stiffness_ratio, metrics.peak_ratio) == (0.5, 1.0)
    assert metrics.peak_displacement_ratio == metrics.displacement_at_peak_ratio == 2.0
    # The error is f/2, and f goes 0, 4, -4, 2 along its path of 4 + 8 + 6.
    at = np.interp(np.linspace(0.0, 18.0, 2000), [0, 4, 12, 18], f)
    assert metrics.rms_error == pytest.approx(0.5 * math.sqrt(np.mean(at * at)), rel=1e-12)
    assert metrics.nrmse == pytest.approx(metrics.rms_error / 2.0, rel=1e-15)
    d, f = cycle()
    same = comparison.displacement_metrics(f, d, d)
    assert same.nrmse == same.rms_error == 0.0
    assert astuple(same.test) == astuple(same.model)


def column(**more) -> rbsdem.Column:
    return rbsdem.Column(1.6, 614.0, SHEAR, FLEXURE, **more)


@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
def test_a_result_is_compared_with_the_test_that_drove_it(curves, kinematics):
    d, f, _ = curves
    result = rbsdem.cyclic(column(axial_load=7e5, kinematics=kinematics), displacement=d)
    c = rbsdem.compare(result, (d, f))
    assert (c.rows, c.path_fraction) == (d.size, 1)
    assert np.array_equal(c.model_force, result.force)
    assert c.height == pytest.approx(1.6, rel=1e-6)
    assert rbsdem.compare(result, (d, f), height=3.2).height == 3.2


def test_an_analysis_that_broke_off(curves):
    d, f, _ = curves
    result = rbsdem.cyclic(column(), displacement=d, collapse_drift=0.012)
    assert result.summary["status"] == "collapsed"
    c = rbsdem.compare(result, (d, f))
    assert 0 < c.rows <= result.displacement.size < d.size
    assert np.isnan(c.model_force[c.rows :]).all()
    assert c.nrmse > 0.5


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        (lambda d: d[::2], "every row kept"),
        (lambda d: d + 1e-3, "first 0 displacements agree"),
        (lambda d: np.concatenate((d, [0.0])), "401 rows, the test 400"),
        (lambda d: d[:100], "first 100 displacements agree"),
    ],
)
def test_rows_that_do_not_belong_together_are_refused(curves, changed, words):
    d, f, _ = curves
    result = rbsdem.cyclic(column(), displacement=changed(d))
    with pytest.raises(InputError, match=words):
        rbsdem.compare(result, (d, f))


# A worked envelope: (0, 0) (5, 100) (10, 160) (20, 200) (40, 210) (60, 190), mm and kN.
WORKED = Envelope(
    1,
    np.array([0.0, 5.0, 10.0, 20.0, 40.0, 60.0]) * 1e-3,
    np.array([0.0, 100.0, 160.0, 200.0, 210.0, 190.0]) * 1e3,
)
COLUMN = rbsdem.peer.paper_columns()["zahn_7"]


# The numbers are worked by hand from the definitions: areas 6800 and 10800 N m.
@pytest.mark.parametrize(
    ("method", "force", "displacement"),
    [
        ("asce_41", 179.259, 9.3827),
        ("ec_8", 210.0, 15.2381),
        ("park", 210.0, 13.0556),
        ("equal_energy", 196.008, 9.8004),
    ],
)
def test_worked_numbers(method, force, displacement):
    lines = WORKED.idealise(method)
    assert lines.yield_force == pytest.approx(force * 1e3, rel=5e-6)
    assert lines.yield_displacement == pytest.approx(displacement * 1e-3, rel=1e-5)
    assert lines.ductility == pytest.approx(0.06 / lines.yield_displacement)
    assert not lines.lost


@pytest.mark.parametrize("method", ["asce_41", "ec_8", "equal_energy"])
def test_areas_are_equal(method):
    lines = WORKED.idealise(method)
    x = np.linspace(0.0, lines.end_displacement, 200_001)
    one = np.trapezoid(lines.force(x), x)
    other = np.trapezoid(np.interp(x, WORKED.displacement, WORKED.force), x)
    assert one == pytest.approx(other, rel=1e-8)


@pytest.mark.parametrize("method", ["asce_41", "ec_8", "equal_energy"])
def test_two_straight_lines_are_found_again(method):
    """An elastic and perfectly plastic envelope is its own idealisation; hardening by ASCE 41."""
    own = Envelope(1, np.array([0.0, 0.01, 0.05]), np.array([0.0, 2e5, 2e5]))
    lines = own.idealise(method, **({} if method == "equal_energy" else {"end": 0.05}))
    found = lines.yield_displacement, lines.yield_force, lines.ductility
    assert found == pytest.approx((0.01, 2e5, 5.0), rel=1e-9)
    if method == "asce_41":
        lines = Envelope(1, own.displacement, np.array([0.0, 2e5, 3e5])).idealise(method)
        found = lines.yield_displacement, lines.yield_force, lines.post_yield_ratio
        assert found == pytest.approx((0.01, 2e5, 0.125), rel=1e-9)


def test_asce_41_finds_the_nearest_balanced_lines_or_says_that_there_are_none():
    """300 concave envelopes, against a search over 4000 yield forces."""

    def apart(at, force):
        """Area between lines and envelope, in size, by 20 000 steps."""
        u = np.linspace(0.0, x[-1], 20001)
        lines = np.interp(u, [0.0, at, x[-1]], [0.0, force, y[-1]])
        return np.trapezoid(np.abs(np.interp(u, x, y) - lines), u)

    random = np.random.default_rng(1)
    refused = 0
    for _ in range(300):
        n = random.integers(2, 9)
        slope = np.sort(random.exponential(1.0, n))[::-1]
        step = random.exponential(1.0, n)
        x, y = (np.append(0.0, np.cumsum(part)) for part in (step, slope * step))
        top = y[-1] * np.linspace(1.0, 2.5e-4, 4000)
        at = np.interp(0.6 * top, y, x) / 0.6
        # Triangle and trapezium of the lines less the area below the envelope.
        over = 0.5 * (top * at + (top + y[-1]) * (x[-1] - at)) - np.trapezoid(y, x)
        turned = (over[1:] * over[:-1] < 0) & (at[1:] <= x[-1])
        try:
            lines = Envelope(1, x, y).idealise("asce_41")
        except InputError:
            assert not turned.any()
            refused += 1
            continue
        own = 0.5 * (lines.yield_force * x[-1] + y[-1] * (x[-1] - lines.yield_displacement))
        assert own == pytest.approx(np.trapezoid(y, x), rel=1e-9)
        on = np.interp(0.6 * lines.yield_displacement, x, y)
        assert on == pytest.approx(0.6 * lines.yield_force, rel=1e-9)
        assert lines.yield_force <= y[-1] * (1 + 1e-9)
        if turned.any():
            others = [apart(at[i + 1], top[i + 1]) for i in np.flatnonzero(turned)]
            near = apart(lines.yield_displacement, lines.yield_force)
            assert near <= min(others) + 1e-3 * x[-1] * y[-1]
    assert 0 < refused < 15


@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.6, 0.9])
@pytest.mark.parametrize("end", [0.011, 0.02, 0.1])
def test_asce_41_gives_two_lines_back_however_much_they_harden(ratio, end):
    """Lines near each other have several balanced ones; those of the envelope lie on it."""
    force = 2e5 + ratio * 2e7 * (end - 0.01)
    own = Envelope(1, np.array([0.0, 0.01, end]), np.array([0.0, 2e5, force]))
    lines = own.idealise("asce_41")
    assert lines.yield_displacement == pytest.approx(0.01, rel=1e-9)
    assert lines.yield_force == pytest.approx(2e5, rel=1e-9)


def test_steps_of_an_envelope_have_no_width():
    """The force falls by a tenth from one cycle to the next, at 30 mm: area 1 + 4 + 4 kN m.

    On the elastic part (v = 2e7 u): 0.05 v - 2.2e5 u = 0.6 (18000 - 11000) N m. Up to the step the
    force is that before it.
    """
    x, y = np.array([[0, 0], [10, 200], [30, 200], [30, 180], [50, 220]]).T
    own = Envelope(1, 1e-3 * x, 1e3 * y)
    lines = own.idealise("asce_41")
    u = 4200 / (0.05 * 2e7 - 2.2e5)
    assert lines.yield_displacement == pytest.approx(u / 0.6, rel=1e-9)
    assert lines.yield_force == pytest.approx(2e7 * u / 0.6, rel=1e-9)
    step = own.idealise("ec_8", end=0.03)
    assert (step.yield_displacement, step.yield_force) == pytest.approx((0.01, 2e5))


def test_elastic_envelope_is_one_line():
    lines = Envelope(1, np.array([0.0, 0.02]), np.array([0.0, 1e5])).idealise()
    assert (lines.yield_displacement, lines.yield_force) == pytest.approx((0.02, 1e5))
    assert (lines.post_yield_ratio, lines.ductility) == (0.0, 1.0)


def test_loss_of_strength_ends_it():
    falling = Envelope(1, np.array([0.0, 0.01, 0.03]), np.array([0.0, 1e5, 5e4]))
    lines = falling.idealise("park")
    assert lines.lost
    # 80 % of the peak lies at 0.4 of the way down.
    assert lines.ultimate_displacement == pytest.approx(0.018)
    assert falling.displacement_at(0.8, falling=True) == pytest.approx(0.018)
    assert falling.displacement_at(0.5) == pytest.approx(0.005)
    assert np.isnan(falling.displacement_at(0.4, falling=True))


def test_envelope_of_a_cyclic_path_lies_on_the_push():
    """A Takeda column without P-Delta comes back to its backbone in every larger cycle."""
    path = COLUMN.height * rbsdem.protocol([0.002, 0.005, 0.01, 0.02], points=20)
    cyclic = rbsdem.cyclic(COLUMN, displacement=path)
    push = rbsdem.cyclic(COLUMN, displacement=[0.02 * COLUMN.height]).path
    for side in (1, -1):
        found = cyclic.envelope(side)
        assert np.all(np.diff(found.displacement) >= 0)
        assert found.largest_displacement == pytest.approx(0.02 * COLUMN.height)
        tips = np.array([0.002, 0.005, 0.01, 0.02]) * COLUMN.height
        for tip in tips:
            on_push = np.interp(tip, push.displacement, push.force)
            # When it is first there; the next cycle comes by with a little more or less.
            first = np.argmax(found.displacement >= tip * (1 - 1e-12))
            assert found.force[first] == pytest.approx(on_push, rel=1e-9)


def test_result_speaks_by_the_definitions_of_the_comparison():
    path = COLUMN.height * rbsdem.protocol([0.01, 0.02], points=10)
    result = rbsdem.cyclic(COLUMN, displacement=path)
    path = result.path
    cycles = rbsdem.curves.half_cycles(path.displacement, path.force)
    assert result.half_cycles().energy == pytest.approx(cycles.energy)
    assert np.isnan(result.strength_loss())
    assert result.idealise("park", -1) == result.envelope(-1).idealise("park")
