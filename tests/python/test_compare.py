"""`rbsdem.compare` against closed forms, and against the shared definitions where they are."""

from __future__ import annotations

import math
import pickle
import runpy

import numpy as np
import pytest
from conftest import REPOSITORY

import rbsdem
from rbsdem.curves import cycles
from rbsdem.curves.scores import SCORES
from rbsdem.curves.strength import strength_loss
from rbsdem.errors import InputError
from rbsdem.springs import Bilinear, Takeda

DEFINITIONS = REPOSITORY.parent / "shared" / "loop_metrics.py"

THEIRS = {"stiffness_ratio": "k70_ratio", "path_fraction": "done", "nrmse_reached": "nrmse_done"}

SHEAR = Bilinear(7e8, 1.3e-4, 8e6)
FLEXURE = Takeda(2.5e8, 3.2e-4, 6.3e7, 2.7e-3, 7.6e6, b1=0.3)


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


# ---- scores --------------------------------------------------------------------------------------


def test_a_copy_of_the_test_has_no_error(curves):
    d, f, _ = curves
    c = rbsdem.compare((d, f), (d, f))
    assert (c.nrmse, c.path_fraction, c.rms_best) == pytest.approx((0.0, 1.0, 0.0), abs=1e-14)
    ratios = c.peak_ratio, c.energy_ratio, c.stiffness_ratio, c.end_ratio
    assert ratios == pytest.approx((1.0, 1.0, 1.0, 1.0))


def test_no_force_at_all_is_the_rms_of_the_test():
    d = np.array([0.0, 1.0, 0.0, -1.0, 0.0])
    f = np.array([3.0, 3.0, -3.0, -3.0, 3.0])
    c = rbsdem.compare((d, 0 * f), (d, f))
    # Both ways between +-3 the force is linear: its mean square is a third, half of the path.
    assert c.nrmse == pytest.approx(math.sqrt(0.5 + 0.5 / 3), rel=1e-3)
    assert c.peak_ratio == 0


@pytest.mark.parametrize("factor", [0.5, 2.0])
def test_a_factor_of_the_force_is_a_factor_of_every_force_ratio(curves, factor):
    d, f, _ = curves
    c = rbsdem.compare((d, factor * f), (d, f))
    assert c.peak_ratio == pytest.approx(factor)
    assert c.energy_ratio == pytest.approx(factor)
    assert c.stiffness_ratio == pytest.approx(factor)
    assert c.end_ratio == pytest.approx(factor)
    assert c.rms_best == pytest.approx(0.0, abs=1e-12)


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


@pytest.mark.skipif(not DEFINITIONS.is_file(), reason="the shared definitions are not at hand")
@pytest.mark.parametrize("stop", [None, 0, 1, 2, 90, 200, 399])
def test_scores_are_those_of_the_shared_definitions(curves, stop):
    reference = runpy.run_path(str(DEFINITIONS))["score"]
    d, f, m = curves
    model = m.copy()
    if stop is not None:
        model[stop:] = np.nan
    c = rbsdem.compare((d, model), (d, f))
    expected = reference(1e3 * d, 1e-3 * f, 1e-3 * model)
    for name in SCORES:
        other = THEIRS.get(name, name)
        assert getattr(c, name) == pytest.approx(expected[other], rel=1e-11, nan_ok=True), name


def test_stiffness_is_the_secant_at_70_per_cent_of_the_own_peak():
    d = np.array([0.0, 1.0, 2.0, 0.0])
    test, model = np.array([0.0, 70.0, 100.0, 0.0]), np.array([0.0, 10.0, 20.0, 0.0])
    # 70 at 1; 14 at 1.4.
    assert rbsdem.compare((d, model), (d, test)).stiffness_ratio == pytest.approx(10.0 / 70.0)


def test_a_comparison_is_pickled_whole(curves):
    d, f, _ = curves
    c = rbsdem.compare((d, f), (d, f))
    assert pickle.loads(pickle.dumps(c)).scores == c.scores


# ---- what belongs together -----------------------------------------------------------------------


def column(**more) -> rbsdem.Column:
    return rbsdem.Column(1.6, 614.0, SHEAR, FLEXURE, **more)


def test_a_result_is_compared_with_the_test_that_drove_it(curves):
    d, f, _ = curves
    result = rbsdem.cyclic(column(axial_load=7e5, kinematics="pdelta"), displacement=d)
    c = rbsdem.compare(result, (d, f))
    assert c.rows == d.size
    assert np.array_equal(c.model_force, result.force)
    assert c.height == pytest.approx(1.6, rel=1e-6)
    assert rbsdem.compare(result, (d, f), height=3.2).height == 3.2


def test_with_exact_rotations_too(curves):
    d, f, _ = curves
    result = rbsdem.cyclic(column(axial_load=7e5, kinematics="finite"), displacement=d)
    assert rbsdem.compare(result, (d, f)).path_fraction == 1


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


# ---- half-cycles ---------------------------------------------------------------------------------


def test_turning_points_of_a_zigzag():
    d = [0.0, 1.0, -1.0, -1.0, 2.0, 1.99, 2.01, -2.0, 0.0]
    assert cycles.turning_points(d).tolist() == [1, 2, 6, 7]
    # Without a threshold every corner counts.
    assert cycles.turning_points(d, share=0.0).tolist() == [1, 2, 4, 5, 6, 7]


@pytest.mark.parametrize("d", [[], [1.0], [0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 2.0]])
def test_a_history_without_turning_points(d):
    assert cycles.turning_points(d).size == 0


def test_half_cycles_of_an_elastoplastic_spring():
    """Energy 2 F_y (2 a - 2 d_y) of a full cycle, damping 2/pi (1 - d_y/a) (Jacobsen)."""
    k, d_y, a = 10.0, 1.0, 4.0
    corners = np.array([0.0, a, -a, a, -a, 0.0])
    d = np.interp(np.linspace(0, 5, 5001), np.arange(6), corners)
    h = cycles.half_cycles(d, elastoplastic(d, k, k * d_y))
    assert h.displacement.tolist() == pytest.approx([a, -a, a, -a])
    assert h.peak_force.tolist() == pytest.approx([10.0, -10.0, 10.0, -10.0])
    assert h.stiffness.tolist() == pytest.approx(4 * [k * d_y / a])
    # The first half-cycle begins at rest: it has not the plastic way back.
    assert h.energy.tolist() == pytest.approx([30.0, 60.0, 60.0, 60.0], rel=1e-3)
    damping = 2 / math.pi * (1 - d_y / a)
    assert h.damping[1:].tolist() == pytest.approx(3 * [damping], rel=1e-3)


def test_the_zero_of_the_force_lies_between_two_rows():
    """Work 1.5 to the tip; the force falls from 1 to -1 on the next unit, and gives 0.25 back."""
    h = cycles.half_cycles([0.0, 1.0, 2.0, 1.0, 0.0], [0.0, 1.0, 1.0, -1.0, -1.0])
    assert h.row.tolist() == [2]
    assert h.energy.tolist() == [1.25]


def test_an_elastic_spring_dissipates_nothing():
    d = wave(4.0, 0.01, 4001)
    h = cycles.half_cycles(d, 5e6 * d)
    assert len(h) == 8
    assert h.energy == pytest.approx(np.zeros(8), abs=1e-9)
    assert h.stiffness == pytest.approx(np.full(8, 5e6))


def test_energy_of_the_half_cycles_is_that_of_the_path():
    d = wave(5.25, 0.02, 3001)
    f = elastoplastic(d, 3e7, 2e5)
    # It ends at a tip, and what is stored there is in the last one.
    h = cycles.half_cycles(d, f)
    assert h.row[-1] == d.size - 1
    assert h.energy.sum() == pytest.approx(rbsdem.curves.energy(d, f), rel=1e-12)


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


# ---- strength loss -------------------------------------------------------------------------------


def test_strength_loss_of_a_softening_push():
    # 100 at 1, down to 0 at 5: 80 at 1.8.
    d, f = [0.0, 1.0, 5.0], [0.0, 100.0, 0.0]
    assert strength_loss(d, f) == pytest.approx(1.8)
    assert strength_loss([-x for x in d], [-x for x in f]) == pytest.approx(1.8)
    assert strength_loss(d, f, share=0.5) == pytest.approx(3.0)


def test_strength_loss_at_a_repeated_cycle():
    """The second cycle to 2 carries 70 of 100: 80 was passed at 2."""
    d = [0.0, 2.0, 0.0, -2.0, 0.0, 2.0, 0.0]
    f = [0.0, 100.0, 0.0, -100.0, 0.0, 70.0, 0.0]
    assert strength_loss(d, f) == pytest.approx(2.0)
    # Not if it only goes half as far.
    d[5] = 1.0
    assert math.isnan(strength_loss(d, f))


def test_strength_loss_of_the_side_that_comes_first():
    d = [0.0, 1.0, -1.0, 1.0, 2.0, -3.0]
    f = [0.0, 100.0, -100.0, 100.0, 60.0, -50.0]
    # Positive side: 80 at 1.5; the negative one loses more, but later.
    assert strength_loss(d, f) == pytest.approx(1.5)
    # A cycle that crosses its former peak with less than 80 and stays below has lost it there, row
    # or no row; one that rises to 90 again has not.
    del d[3], f[3]
    assert strength_loss(d, f) == pytest.approx(1.0)
    assert math.isnan(strength_loss(d[:4], [0.0, 100.0, -100.0, 90.0]))


def test_a_force_between_the_envelopes_is_no_strength():
    """On the way back from 2 the force is 300; pushed on it goes from 100 to 70: 80 at 8/3."""
    d = [0.0, 1.0, 2.0, 1.0, 0.0, 2.0, 3.0]
    f = [0.0, 100.0, 100.0, 300.0, 0.0, 100.0, 70.0]
    assert strength_loss(d, f) == pytest.approx(8 / 3)


@pytest.mark.parametrize("rows", [0, 1, 2])
def test_few_rows_lose_nothing(rows):
    d, f = np.arange(rows) * 1.0, np.arange(rows) * 1.0
    assert math.isnan(strength_loss(d, f))
    assert len(cycles.half_cycles(d, f)) == (1 if rows == 2 else 0)


def test_drift_at_loss_of_test_and_model():
    d, f = np.array([0.0, 0.01, 0.05]), np.array([0.0, 1e5, 0.0])
    c = rbsdem.compare((d, 1e5 * np.array([0.0, 1.0, 1.0])), (d, f), height=2.0)
    assert c.test_drift_at_loss == pytest.approx(0.009)
    assert math.isnan(c.model_drift_at_loss)
    assert "0.0090, none" in str(c)


def test_nothing_reached_is_no_fault(curves):
    d, f, _ = curves
    c = rbsdem.compare((d, np.full(d.size, np.nan)), (d, f))
    assert (c.nrmse, c.path_fraction, c.rows) == (1.0, 0.0, 0)
    assert math.isnan(c.model_drift_at_loss)
    assert len(c.model_cycles) == 0
    assert "none" in str(c)


# ---- figure and table ----------------------------------------------------------------------------
