"""Figures of a summary belong to the column and to all steps.

They do not change with springs that cannot matter, nor with the rows that are kept.
"""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Elastic, PeakOriented

#: A shear spring whose softening follows the work of the hinge of its joint.
SHEAR = PeakOriented(d_y=5e-4, f_y=6e4, d_cap=6e-3, f_cap=7.5e4, d_pc=4e-2, lambda_h=2.0, s_min=0.2)
FLEXURE = Bilinear(k=6.3e7, d_y=1.5e-3, k_post=2e6)
PATH = 1.6 * rbsdem.protocol([0.005, 0.01, 0.015, 0.02], cycles=3, points=10)
TIME = np.arange(0.0, 1.0, 0.01)
MOTION = 9.0 * np.sin(2 * np.pi * 3.0 * TIME) * np.sin(np.pi * TIME)

#: Analyses, by what they are called with.
ANALYSES = {
    "static": {},
    "rk4": {"method": "rk4", "dt": 2e-4},
    "located": {"method": "rk4", "dt": 2e-4, "events": "located"},
    "rk45": {"method": "rk45", "tolerance": 1e-8},
    "newmark": {"method": "newmark", "dt": 1e-3},
    "hht": {"method": "hht", "dt": 1e-3},
}


def column(n: int = 2, **more) -> rbsdem.Column:
    return rbsdem.Column(1.6, 2e4, SHEAR, FLEXURE, n=n, **more)


def solve(analysis: str, subject: rbsdem.Column, sign: float = 1.0, **more) -> rbsdem.Result:
    if analysis == "static":
        return rbsdem.cyclic(subject, displacement=sign * PATH, **more)
    return rbsdem.time_history(
        subject, TIME, ground_acceleration=sign * MOTION, **ANALYSES[analysis], **more
    )


@pytest.mark.parametrize("settings", [{"method": "rk45"}, {"method": "rk4", "events": "located"}])
def test_peaks_inside_a_step_are_found(settings):
    """Free vibration with a velocity at the start: the amplitude falls between all rows."""
    column = rbsdem.Column(2.0, 1e3, Elastic(1e9), Elastic(4e7))
    modes = rbsdem.modes(column)
    omega = modes.omega[0]
    shape = modes.shapes[:, 0] / (modes.shapes[0, 0] + 2.0 * modes.shapes[1, 0])
    time = np.arange(0.0, 3.0, 0.77) * np.pi / omega
    start = 0.01 * omega * shape
    result = rbsdem.time_history(
        column,
        time,
        initial={"slip_velocity": start[:1], "rotation_velocity": start[1:]},
        **settings,
    )
    summary = result.summary
    assert np.abs(result.displacement).max() < 0.00995
    assert abs(summary["peak_displacement"]) == pytest.approx(0.01, rel=2e-5)
    assert summary["peak_rotation"] == pytest.approx(0.01 * abs(shape[1]), rel=2e-5)
    shear = 1e9 * 0.01 * abs(shape[0])
    assert abs(summary["peak_base_shear"]) == pytest.approx(shear, rel=2e-5)


@pytest.mark.filterwarnings("ignore:the ground. its peak is")
def test_a_collapse_between_two_rows_is_seen_by_every_method():
    """Rows 10 ms apart of a motion of 30 Hz: the largest of them is 8.40 mm, the peak 8.93 mm."""
    subject = rbsdem.peer.paper_columns("pdelta")["soesianawati_1"]
    time = np.arange(0.0, 2.0, 0.01)
    motion = 300 * np.sin(2 * np.pi * 30 * time) * np.exp(-(((time - 0.6) / 0.3) ** 2))
    dense = np.linspace(0.0, time[-1], 20 * (time.size - 1) + 1)

    def run(time, motion, **more) -> rbsdem.Result:
        return rbsdem.time_history(subject, time, ground_acceleration=motion, **more)

    reference = run(dense, np.interp(dense, time, motion), method="rk45")
    peak = reference.summary["peak_displacement"]
    assert peak == pytest.approx(np.abs(reference.displacement).max(), rel=1e-6)
    for settings in ({"method": "rk45"}, {"method": "rk4", "events": "located"}):
        assert run(time, motion, **settings).summary["peak_displacement"] == pytest.approx(
            peak, rel=1e-4
        )
    for method in ("rk4", "rk45", "newmark"):
        for every in (None, 1000):
            result = run(
                time, motion, method=method, collapse_drift=0.0054, every=every,
                dt=1e-3 if method == "newmark" else None,
            )  # fmt: skip
            assert result.summary["status"] == "collapsed", method
            assert method == "newmark" or 0.53 < result.time[-1] < 0.54
        found = rbsdem.ensemble(
            subject, (time, motion), method=method, collapse_drift=0.0054,
            **({"dt": 1e-3} if method == "newmark" else {}),
        )  # fmt: skip
        assert list(found.status) == ["collapsed"], method


def test_limit_states_are_where_the_motion_crosses_them():
    """A free vibration u = a sin(w t) in a spring that would yield at half of its amplitude."""
    hinge = Bilinear(k=4e7, d_y=2.5e-3, k_post=1e6)
    subject = rbsdem.Column(2.0, 1e3, Elastic(1e9), hinge)
    modes = rbsdem.modes(subject)
    omega = modes.omega[0]
    shape = modes.shapes[:, 0] / modes.shapes[1, 0]
    time = np.array([0.0, 1.4, 2.0]) / omega
    start = 5e-3 * omega * shape
    initial = {"slip_velocity": start[:1], "rotation_velocity": start[1:]}
    for settings in ({"method": "rk45"}, {"method": "rk4", "events": "located"}):
        result = rbsdem.time_history(subject, time, initial=initial, **settings)
        state = result.limit_states()["first_yield"]
        assert state.time == pytest.approx(np.pi / 6 / omega, rel=1e-5)
        assert state.displacement == pytest.approx(2.5e-3 * (shape[0] + 2.0), rel=1e-5)
        assert state.row == 1


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("analysis", ["static", "rk4", "rk45", "newmark"])
def test_the_drift_of_collapse_counts_the_height_of_the_column(analysis, sign):
    """To either side; on a footing of half the height, that does not move, as without one."""
    rigid = Elastic(1e13 if analysis == "static" else 1e11)
    beneath = rbsdem.Footing(rigid, rigid, mass=1e6, inertia=1e6, height=0.8)
    subject = column(1, footing=beneath)
    result = solve(analysis, subject, sign, collapse_drift=0.01)
    assert result.summary["status"] == "collapsed"
    drift = np.abs(result.displacement) / 1.6
    assert drift[:-1].max() < 0.01 <= drift[-1]


def test_a_response_in_time_tells_its_base_shear():
    """Without a lateral force at the top there is none to tell."""
    shaken = solve("newmark", column())
    assert f"peak base shear {shaken.summary['peak_base_shear']:.4g} N" in repr(shaken)
    assert not {"peak_force", "displacement_at_peak_force"} & set(shaken.summary)
    pushed = rbsdem.time_history(column(), TIME, force=1e4 * TIME, method="newmark")
    assert pushed.summary["peak_force"] == pytest.approx(1e4 * TIME[-1])
    assert "peak force" in repr(solve("static", column()))


@pytest.mark.parametrize("sign", [1, -1])
def test_peaks_are_the_largest_to_either_side(sign):
    path = sign * np.array([0.0, 0.01, 0.0, -0.03, 0.0])
    result = rbsdem.cyclic(column(), displacement=path)
    largest = np.abs(result.force).argmax()
    assert result.summary["peak_force"] == result.force[largest]
    assert result.summary["displacement_at_peak_force"] == result.displacement[largest]
    assert result.summary["peak_displacement"] == sign * -0.03
