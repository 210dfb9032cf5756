"""What a result says of its own error, and what is said before a long run.

An estimate is held against a solution that is finer by many digits. No clock is read: the time of a
run is told from the number of its steps.
"""

from __future__ import annotations

import os
import pickle
import signal
import subprocess
from dataclasses import replace

import numpy as np
import pytest

import rbsdem
from rbsdem import __main__ as command
from rbsdem.run.accuracy import Answer, errors_of
from rbsdem.run.solver import IN_TIME, METHODS
from rbsdem.springs import Bilinear, Elastic

COLUMN = rbsdem.peer.paper_columns("pdelta", top_mass=75.9e3)["soesianawati_1"]
TIME = np.arange(0.0, 3.0, 0.01)
MOTION = 5.0 * np.sin(2 * np.pi * 2.0 * TIME)


def shake(column: rbsdem.Column = COLUMN, **keywords) -> rbsdem.Result:
    return rbsdem.time_history(column, TIME, ground_acceleration=MOTION, **keywords)


def answer(run: rbsdem.Result) -> Answer:
    taken = run.energy["spring"] + run.energy["damping"]
    return Answer(run.time, run.displacement, run.moment[:, 0], taken, "completed")


@pytest.fixture(scope="module")
def exact() -> rbsdem.Result:
    return shake(method="rk45", tolerance=1e-12)


@pytest.mark.parametrize(
    "keywords",
    [
        {},
        {"method": "rk4"},
        {"method": "rk4", "dt": 1e-3},
        {"method": "rk4", "dt": 1e-3, "events": "located"},
        {"method": "rk45"},
        {"method": "rk45", "tolerance": 1e-5},
        {"method": "auto", "tolerance": 1e-5},
        {"method": "newmark"},
        {"method": "hht", "rho_infinity": 0.9},
        {"method": "generalised_alpha", "dt": 0.005},
    ],
    ids=str,
)
def test_distance_to_the_next_finer_setting_is_about_the_error(exact, keywords):
    """Three quarters of it for a method of order 2, more for higher orders."""
    run = shake(**keywords)
    found = run.refined_error().largest
    true = errors_of(answer(run), answer(exact)).largest
    assert 0.6 * true < found < 1.5 * true


def test_no_error_is_zero(exact):
    """The sharpest tolerance has no sharper one, an elastic path no other digits: neither is 0."""
    sharpest = shake(method="rk45", tolerance=1e-13)
    true = errors_of(answer(sharpest), answer(exact)).largest
    assert true < sharpest.refined_error().largest < 1e-8
    elastic = rbsdem.Column(2.0, 500.0, Elastic(1e9), Elastic(1e9))
    found = rbsdem.cyclic(elastic, displacement=[0.0, 0.01, -0.01]).refined_error()
    assert min(found.peak, found.energy, found.largest) >= np.finfo(float).eps


def test_rows_of_corners_are_not_points_of_a_push():
    """Without exact rotations no increment matters: the distance is round-off."""
    column = rbsdem.Column(2.0, 500.0, Bilinear(1e8, 1e-4, 1e6), Bilinear(1e8, 1e-3, 1e6))
    push = rbsdem.pushover(column, drift=0.01, points=7)
    assert push.time.size > 7
    assert push.refined_error().largest < 1e-12


def test_irregular_times_and_thinned_rows_can_be_refined(exact):
    uneven = np.delete(TIME, slice(5, None, 7))
    motion = np.interp(uneven, TIME, MOTION)
    for method in ("rk4", "newmark", "rk45"):
        run = rbsdem.time_history(COLUMN, uneven, ground_acceleration=motion, method=method)
        assert 0 < run.refined_error().largest < METHODS[method].largest_error
    thin, whole = shake(method="rk4", dt=1e-3, every=5), shake(method="rk4", dt=1e-3, every=1)
    assert thin.refined_error().peak == pytest.approx(whole.refined_error().peak, rel=0.2)


@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
@pytest.mark.parametrize("every", [None, 4])
def test_a_static_path_is_exact(kinematics, every):
    column = replace(COLUMN, kinematics=kinematics)
    path = 1.6 * rbsdem.protocol([0.005, 0.02], cycles=1, points=5)
    run = rbsdem.cyclic(column, displacement=path, every=every)
    assert run.refined_error().largest < 1e-9
    estimate = run.error_estimate
    assert (estimate.usual, estimate.largest, estimate.own_setting) == (0.0, 0.0, True)
    assert str(estimate) == "static: exact but for round-off"


@pytest.mark.parametrize("method", [name for name in IN_TIME if name != "auto"])
def test_every_result_has_the_class_of_error_of_its_method(exact, method):
    run = shake(method=method)
    estimate, row = run.error_estimate, METHODS[method]
    assert (estimate.method, estimate.own_setting) == (method, True)
    assert (estimate.usual, estimate.largest) == (row.usual_error, row.largest_error)
    assert estimate.energy == run.summary["relative_energy_residual"]
    assert errors_of(answer(run), answer(exact)).largest < estimate.largest
    assert not shake(method=method, **coarser(method)).error_estimate.own_setting


def coarser(method: str) -> dict[str, float]:
    return {"tolerance": 1e-4} if METHODS[method].adaptive else {"dt": 1e-3}


def test_auto_says_what_error_its_choice_has():
    run = shake()
    chosen = METHODS[run.summary["method"]]
    words = f"errors over the peaks: {chosen.usual_error:g} in the median of {chosen.responses}"
    assert words.replace("e-0", "e-") in run.summary["reason"]
    assert run.summary["reason"].endswith(f"{chosen.largest_error:g} at most".replace("e-0", "e-"))


def test_the_error_of_a_short_run_is_measured(exact):
    """It is that of the finer run; an energy is no part of what is printed."""
    run = shake(method="newmark")
    estimate = run.error_estimate
    assert estimate.measured == run.refined_error().largest
    true = errors_of(answer(run), answer(exact)).largest
    assert 0.6 * true < estimate.measured < 1.5 * true
    assert f"about {estimate.measured:.1g} of the peaks" in str(estimate)
    assert "energy" not in str(estimate)
    # A run that takes longer is not done once more unasked.
    long = shake(method="rk4", dt=2e-6, every=1000).error_estimate
    assert np.isnan(long.measured)
    assert "refined_error() measures it" in str(long)


def test_a_result_knows_how_it_was_called():
    run = shake(method="rk4", dt=1e-3)
    again = rbsdem.time_history(COLUMN, **run.call)
    assert again == run
    assert pickle.loads(pickle.dumps(run)) == run


LONG = """
&column height = 1.6, mass = 1e-6, rotary_inertia = 1e-6, top_mass = 75e3, gravity = 0 /
&shear rule = 'bilinear', k = 7.0387e8, d_y = 1.296e-4, k_post = 8.3185e6 /
&flexure rule = 'elastic', k = 2.5e8 /
&loading drive = 'ground_acceleration', unit = 'g', amplitudes = 0.1, 0.2, period = 0.5 /
&analysis method = 'rk4', duration = 20 /
"""
SAID = "steps with method = 'rk4' will take some .* s; the highest frequency limits the stable step"


def test_a_long_run_says_so_before_it_starts_and_names_the_faster_method(tmp_path):
    (tmp_path / "case.nml").write_text(LONG, "utf-8")
    case = rbsdem.read_case(tmp_path / "case.nml")
    # Warnings are errors here, so nothing is solved.
    with pytest.raises(rbsdem.errors.LongRunWarning, match=SAID) as caught:
        case.run()
    assert "Faster: method = 'generalised_alpha'" in str(caught.value)
    assert f"errors of about {METHODS['generalised_alpha'].usual_error:g}" in str(caught.value)
    # With the faster method there is nothing to say.
    assert case.run(method="generalised_alpha").summary["status"] == "completed"
    with pytest.raises(rbsdem.errors.LongRunWarning, match="Faster: method = 'generalised_alpha'"):
        case.run(replace(case.column, kinematics="finite"))


def test_the_executable_says_so_too(run_cli, tmp_path):
    (tmp_path / "case.nml").write_text(LONG, "utf-8")
    checked = run_cli(["check", "case.nml"], tmp_path).stdout.splitlines()[-1]
    assert checked.startswith("note: analysis: about ")
    assert "Faster: method = 'generalised_alpha'" in checked
    program = os.environ.get("RBSDEM_EXECUTABLE") or command.executable()
    with subprocess.Popen(
        [program, "run", "case.nml"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    ) as run:
        assert run.stderr.readline() == f"rbsdem: {checked}\n"
        run.send_signal(signal.SIGTERM)
