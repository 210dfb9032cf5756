"""Static paths in leaps from point to point, beside those from event to event."""

import re
from pathlib import Path

import numpy as np
import pytest
from strategies_frames import frame, plan
from strategies_frames import house as drawn_house
from test_invariants_frames import in_units, out_of_units
from test_softening import SOFT, column

import rbsdem
from rbsdem.springs import Bilinear, Elastic

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")


@pytest.fixture(scope="module")
def house():
    """A drawn frame of two storeys and a bay."""
    made = rbsdem.examples.house(2, 1, diaphragm=True)
    assert made.joints
    return made


def leap(structure, to, **how):
    return rbsdem.cyclic(structure, displacement=to, method="newton", **how)


def both(structure, to):
    return rbsdem.cyclic(structure, displacement=to), leap(structure, to)


def test_a_mechanism_carries_its_limit_load():
    # Four hinges and a sway: F h = 2 M_c + 2 M_b, and the load of events at each point.
    column = rbsdem.FrameMember(3e10, 0.16, 2e-3, yield_moment=2e5, hardening=0.0)
    beam = rbsdem.FrameMember(3e10, 0.15, 2e-3, yield_moment=1e5, hardening=0.0)
    portal = rbsdem.Frame.grid([3.0], [6.0], columns=column, beams=beam)
    exact, leaps = both(portal, np.linspace(0.0, 0.3, 14)[1:])
    assert leaps.summary["method"] == "newton"
    assert leaps.force[-1] == pytest.approx(2 * (2e5 + 1e5) / 3.0, rel=1e-12)
    np.testing.assert_allclose(leaps.force, exact.force, rtol=1e-9)
    np.testing.assert_allclose(leaps.energy["spring"], exact.energy["spring"], rtol=1e-9)
    by_force = rbsdem.cyclic(portal, force=[1e5, 1.9e5], method="newton")
    elastic = rbsdem.cyclic(portal, force=[1e5, 1.9e5])
    np.testing.assert_allclose(by_force.displacement, elastic.displacement, rtol=1e-9)


def test_drawn_buildings_and_their_cycles_are_those_of_events(house):
    to = np.array([*range(1, 11), *range(9, -11, -1), *range(-9, 1)]) * 1e-3 * house.height
    exact, leaps = both(house, to)
    peak = np.abs(exact.force).max()
    error = np.abs(leaps.force - exact.force).max() / peak
    assert error < 1e-4
    assert np.abs(leaps.storey_drift - exact.storey_drift).max() < 1e-4 * 0.01
    # The sum over the leaps is more than the error, and is told with it.
    assert error < leaps.summary["leap_error"] < 5e-3
    assert leaps.error_estimate.measured == leaps.summary["leap_error"]
    assert "by the springs that turn in leaps" in str(leaps.error_estimate)
    # Works of springs are exact along their ways, that of the load is a sum over the leaps.
    assert 0.0 < abs(leaps.summary["relative_energy_residual"]) < 5e-3


@pytest.mark.filterwarnings("ignore:the path leads over snap-backs")
@pytest.mark.parametrize("seed", range(6))
def test_frames_that_soften_end_with_the_words_of_events(seed):
    made = frame(np.random.default_rng(seed), "capped")
    exact, leaps = (
        rbsdem.pushover(made, drift=0.08, points=20, method=method)
        for method in ("static", "newton")
    )
    assert leaps.summary["status"] == exact.summary["status"]
    words = (re.sub(r"-?\d[\d.e+-]*", "#", run.summary["reason"]) for run in (exact, leaps))
    assert len(set(words)) == 1
    assert leaps.displacement[-1] == pytest.approx(exact.displacement[-1], rel=2e-3)


def test_a_snap_back_is_followed_by_its_events():
    """The softening column of `test_softening`, whose top goes back by itself."""
    made = column(shear=SOFT, kinematics="pdelta", axial_load=1.0)
    exact, leaps = both(made, [0.05, 0.5])
    assert leaps.summary["snap_backs"] == 1
    for name in ("force", "rotation", "slip"):
        np.testing.assert_allclose(getattr(leaps, name), getattr(exact, name), rtol=1e-9)
    released = exact.summary["released_energy"]
    assert leaps.summary["released_energy"] == pytest.approx(released, rel=1e-9)


def test_a_path_that_is_cut_has_the_bits_of_one_that_is_not(house):
    to = np.array([*range(1, 9), *range(7, -5, -1)]) * 1e-3 * house.height
    whole = leap(house, to)
    first = leap(house, to[:6])
    rest = leap(house, to[6:], initial=first)
    assert np.array_equal(np.concatenate((first.force, rest.force)), whole.force)
    fewer = leap(house, to, every=3)
    assert np.array_equal(fewer.force, whole.force[np.r_[0:20:3, 19]])


def test_the_other_side_and_other_units_are_the_same(house):
    to = np.arange(1, 9) * 2e-3 * house.height
    push = leap(house, to)
    np.testing.assert_allclose(leap(house, -to).force, -push.force, rtol=1e-9)
    made = frame(np.random.default_rng(5), "capped")
    units = (4.0, 0.5, 8.0)
    to = np.arange(1, 21) * 2e-3 * made.height
    run = out_of_units(leap(in_units(made, *units), to * units[0]), *units)
    np.testing.assert_allclose(run.force, leap(made, to).force, rtol=1e-9)


def test_corners_are_rows_where_a_leap_ends(house):
    to = np.arange(1, 6) * 4e-3 * house.height
    push, rows = leap(house, to), leap(house, to, corners=True)
    points = np.isin(rows.time, np.arange(5.0))
    assert np.array_equal(rows.force[points], push.force)
    assert (np.diff(rows.time) > 0.0).all()
    assert not points.all()
    assert push.path.events[0].member == rows.events[0].member


def test_a_building_in_plan_of_layers_is_pushed_in_leaps():
    drawn = plan(np.random.default_rng(3))
    push = rbsdem.pushover(drawn, drift=0.004, points=8)
    assert push.summary["method"] == "newton"
    exact = rbsdem.pushover(drawn, drift=0.004, points=8, method="static")
    at_points = [run.force[np.isin(run.time, np.arange(8.0))] for run in (push, exact)]
    np.testing.assert_allclose(*at_points, atol=1e-3 * exact.force.max())


def test_every_door_takes_the_method(tmp_path: Path, house, run_cli):
    text = f"""
&case title = 'leaps' /
{house.to_namelist()}
&loading drive = 'displacement', values = 0.01, 0.02, 0.03 /
&analysis method = 'newton' /
"""
    (tmp_path / "case.nml").write_text(text)
    case = rbsdem.read_case(tmp_path / "case.nml")
    assert case.method == "newton"
    assert "method = 'newton'" in case.to_namelist()
    run, leaps = case.run(), leap(house, [0.01, 0.02, 0.03])
    assert np.array_equal(run.force, leaps.force)
    (tmp_path / "springs.nml").write_text(case.to_namelist(springs=True))
    assert "newton" in run_cli(["run", str(tmp_path / "springs.nml")]).stdout
    rows = np.genfromtxt(tmp_path / "springs.csv", delimiter=",", names=True, skip_header=3)
    assert np.array_equal(rows["force_N"], run.force)
    run.save(tmp_path / "run.npz")
    assert rbsdem.read_result(tmp_path / "run.npz").summary["method"] == "newton"


def test_columns_say_where_they_go_by_events():
    made = rbsdem.Column(0.5, 2e5, Bilinear(1e9, 1e-4, 1e8), Elastic(1e8), kinematics="small")
    run = leap(made, [0.01])
    assert run.summary["method"] == "static"
    assert "newton is for frames" in run.summary["reason"]
    with pytest.raises(rbsdem.InputError, match="cyclic: method = 'rk4' is not known"):
        rbsdem.cyclic(made, displacement=[0.01], method="rk4")
    with pytest.raises(rbsdem.InputError, match="method = 'newton' takes no time; call cyclic"):
        rbsdem.time_history(made, [0.0, 1.0], force=[0.0, 1.0], method="newton")


def test_leaps_know_what_was_before_a_cut_and_no_side(house):
    """The largest force so far decides what a leap may miss: over a cut, and without a sign."""
    to = 0.01 * house.height * np.array([-1.0, 1.0, -1.53, 0.7, -2.0, 0.0])
    whole = leap(house, to)
    np.testing.assert_allclose(leap(house, -to).force, -whole.force, atol=1e-9 * whole.force.max())
    for at in range(1, to.size):
        rest = leap(house, to[at:], initial=leap(house, to[:at]))
        assert rest.force.tolist() == whole.force[at:].tolist()


def test_a_leap_ends_in_the_equilibrium_of_events():
    """A leap had ended 3e-9 of the forces off, and the events behind it refused that."""
    made = drawn_house(np.random.default_rng(133))
    to = 0.03 * made.height * np.arange(1, 101) / 100
    assert leap(made, to).summary["status"] == "completed"
