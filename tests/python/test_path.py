"""What is measured on a static path and on curves, which are straight between their points.

That figures do not depend on the rows of a path: `test_invariants.py`.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem import curves as comparison
from rbsdem.springs import Bilinear, Elastic


def test_a_plastic_hinge_by_hand():
    """A rigid column of 2 m on an elastoplastic hinge: the residual drift is what did not spring
    back, and the half-cycles hold the work from zero force to zero force."""
    k, d_y, top = 1e8, 4e-3, 0.05
    flexure = Bilinear(k=k, d_y=d_y, k_post=0.0)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e14), flexure)
    result = rbsdem.cyclic(column, displacement=[top, -top])
    # The force that yields, k d_y/2, springs back by 2 d_y; seen from the last zero.
    assert result.residual_drift == pytest.approx(top / 2.0 - d_y, rel=1e-6)
    plastic = top - 2.0 * d_y
    # The second one ends loaded, with what is stored.
    energy = k * d_y / 2.0 * np.array([plastic, 2.0 * plastic + 0.5 * 2.0 * d_y])
    assert result.half_cycles().energy == pytest.approx(energy, rel=1e-6)
    assert result.path.time == pytest.approx([-1.0, 0.16 - 1.0, 0.0, 0.16, 1.0], rel=1e-6)
    assert result.path.path is result.path


def test_a_path_that_goes_on_begins_where_the_other_one_ended(tmp_path):
    column = rbsdem.Column(1.6, 1e3, Elastic(1e9), Bilinear(5e8, 4e-3, 2e7), n=2)
    path = 0.02 * np.array([1.0, -0.8, 1.5, -1.2, 2.0, -2.2, 2.5, -1.0])
    first = rbsdem.cyclic(column, displacement=path[:5])
    second = rbsdem.cyclic(column, displacement=path[5:], initial=first)
    whole = rbsdem.cyclic(column, displacement=path)
    assert second.residual_drift == whole.residual_drift
    assert np.array_equal(second.path.force[1:], whole.path.force[-second.path.time.size + 1 :])
    # A saved result finds its path again.
    second.save(tmp_path / "second.npz")
    assert rbsdem.read_result(tmp_path / "second.npz").path == second.path


def test_a_path_that_breaks_off_has_corners_up_to_there():
    flexure = Bilinear(k=1e8, d_y=4e-3, k_post=0.0)
    column = rbsdem.Column(2.0, 100.0, Elastic(1e9), flexure)
    with pytest.raises(rbsdem.SolveError) as raised:
        rbsdem.cyclic(column, force=[1e5, 3e5])
    result = raised.value.result
    assert result.path.force[-1] == result.force[-1] == pytest.approx(2e5)
    assert result.limit_states()["first_yield"].drift == pytest.approx(result.drift[-1])


@pytest.mark.parametrize("seed", range(12))
def test_figures_of_a_curve_do_not_depend_on_points_on_its_lines(seed: int) -> None:
    """Of a measured curve too: the same straight lines, with more points."""
    rng = np.random.default_rng(seed)
    amplitude = np.repeat(np.linspace(1.0, 6.0, 8), 2) * np.tile([1.0, -1.0], 8)
    d = np.ravel(np.column_stack((0.6 * amplitude, amplitude, 0.3 * amplitude)))
    f = (
        np.sign(d)
        * np.abs(d) ** 0.3
        * np.linspace(1.0, 0.4, d.size)
        * rng.uniform(0.8, 1.2, d.size)
    )
    rows = np.sort(np.concatenate((np.arange(d.size), rng.uniform(0, d.size - 1, 60))))
    more = tuple(np.interp(rows, np.arange(d.size), values) for values in (d, f))
    loop, again = (comparison.summarise(*curve) for curve in ((d, f), more))
    for name in loop.__slots__:
        assert getattr(again, name) == pytest.approx(getattr(loop, name), nan_ok=True)
    assert comparison.strength_loss(*more) == pytest.approx(
        comparison.strength_loss(d, f), nan_ok=True
    )
    for name in ("displacement", "force", "peak_force", "energy", "stiffness", "damping"):
        of = [getattr(comparison.half_cycles(*curve), name) for curve in ((d, f), more)]
        assert of[1] == pytest.approx(of[0], nan_ok=True)
    for side in (1, -1):
        one, other = (rbsdem.curves.envelope(curve, side) for curve in ((d, f), more))
        for share in (0.3, 0.7, 0.9, 1.0):
            assert other.displacement_at(share) == pytest.approx(one.displacement_at(share))
        lost = [curve.displacement_at(0.8, falling=True) for curve in (one, other)]
        assert lost[1] == pytest.approx(lost[0], nan_ok=True)
