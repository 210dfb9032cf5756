"""Extremes of rotation and contact: full turns, bodies that fly off and land.

Motions are held against `reference_chain`, which knows nothing but the energies. The elastica to
a right angle and beyond: `rbsdem verify`.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from reference_chain import Chain, chain, deformations

import rbsdem
from rbsdem.errors import AccuracyWarning
from rbsdem.springs import Compression, Elastic


@pytest.mark.parametrize("n", [1, 3])
def test_top_that_is_driven_farther_than_the_column_is_long_slides_at_the_foot(n):
    """All bodies lie; the slip of the lowest joint, along the ground, is what is left."""
    k_v, height = 1e9, 2.0
    column = rbsdem.Column(height, 100.0, Elastic(k_v), Elastic(1e5), n=n, kinematics="finite")
    run = rbsdem.cyclic(column, displacement=height * np.linspace(0.0, 1.2, 61)[1:])
    assert run.force[-1] == pytest.approx(k_v * 0.2 * height, rel=1e-3)
    assert np.sum(run.rotation[-1]) == pytest.approx(np.pi / 2, abs=0.01)
    assert np.max(np.abs(run.energy["residual"])) < 1e-5 * run.energy["spring"][-1]
    np.testing.assert_allclose(run.top[:, 0], run.displacement, atol=1e-9)


@pytest.mark.parametrize(("n", "opens"), [(1, False), (2, False), (2, True)])
def test_full_turns_against_hamiltons_equations(n, opens):
    """Weak joints, a fast spin: a full turn and more, where sine and cosine see all signs.

    Later on the motion is chaotic: what is 1e-10 apart is 1e-2 apart after half a second.
    """
    column = chain(
        [1.0] * n, [10.0] * n, [3e4] * n, [20.0] * n, kinematics="finite",
        axial_spring=Elastic(4e4) if opens else None, axial_load=-400.0, self_weight=True,
    )  # fmt: skip
    size = (3 if opens else 2) * n
    v = np.zeros(size)
    v[n] = 60.0
    times = np.linspace(0.0, 0.5 if n == 1 else 0.28, 6)
    initial = {"rotation_velocity": v[n : 2 * n]}
    if opens:  # else they begin in equilibrium
        initial["opening"] = np.zeros(n)
    expected = Chain(column).solve(times, np.zeros(size), v, 1e-10)
    for method, options in (("rk45", {"tolerance": 1e-10}), ("rk4", {"dt": 5e-5})):
        run = rbsdem.time_history(column, times, method=method, initial=initial, **options)
        assert np.max(np.abs(np.cumsum(run.rotation, axis=1))) > 2 * np.pi
        np.testing.assert_allclose(deformations(run), expected, atol=2e-5)


@pytest.mark.parametrize("level", ["small", "pdelta"])
@pytest.mark.parametrize("turn", [0.0999, 0.1001, 0.5, np.pi / 2, 2 * np.pi])
def test_small_rotations_warn_above_a_tenth(level, turn):
    """Of the path and of the run in time; by the rotation of a body, not of a joint."""
    column = rbsdem.Column(2.0, 100.0, Elastic(1e12), Elastic(1e6), n=2, kinematics=level)
    # Two equal joints under a force at the top turn by 2 : 1.
    analyses = [
        lambda: rbsdem.cyclic(column, force=[turn / (2.0 / 1e6 + 1.0 / 1e6)]),
        lambda: rbsdem.time_history(
            column, [0.0, 1e-6], initial={"rotation": [turn / 2] * 2}, method="rk4"
        ),
    ]
    for number, analysis in enumerate(analyses):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            run = analysis()
        assert run.summary["peak_rotation"] == pytest.approx(turn, rel=1e-5)
        assert [one.category for one in caught] == ([AccuracyWarning] if turn > 0.1 else [])
        if turn > 1 and number == 0:
            # A path whose top goes so far is asked for its units.
            assert "beyond half of the height" in str(caught[0].message)
        elif turn > 0.1:
            assert f"kinematics = '{level}'" in str(caught[0].message)
            told = "has no meaning" if turn > 1 else "err by about 2 th^2/3"
            assert told in str(caught[0].message)


@pytest.mark.parametrize("turn", [0.11, 0.2, 0.3])
@pytest.mark.parametrize("axial_load", [0.0, 1e5])
def test_note_of_large_rotations_is_right_about_the_error(turn, axial_load):
    """F = k th/(l cos th) - P tan th under x = l sin th; small rotations have (k/l - P) x/l."""

    def force(level):
        column = rbsdem.Column(
            2.0, 100.0, Elastic(1e12), Elastic(1e6), kinematics=level, axial_load=axial_load
        )
        return rbsdem.cyclic(column, displacement=[2.0 * np.sin(turn)]).force[0]

    with pytest.warns(AccuracyWarning, match=r"about 2 th\^2/3 of them") as caught:
        error = 1 - force("pdelta") / force("finite")
    assert error == pytest.approx(2 / 3 * turn**2, rel=0.2)
    # The warning stands at the caller's line, for filters by module.
    assert caught[0].filename == __file__


@pytest.mark.parametrize("stiffness", [1e6, 1e9])
@pytest.mark.parametrize(
    ("method", "close"), [("located", 1e-6), ("rk45", 1e-6), ("newmark", 0.05)]
)
def test_body_that_bounces_comes_back_to_its_height(method, close, stiffness):
    """A body falls on its joint and flies off again, twenty times.

    Flight of 2 sqrt(2 h/g), then half a swing and a bit about the place of rest: the times of its
    highest and lowest places are in closed form, and so are the places.
    """
    mass, g, height = 50.0, 9.80665, 0.01
    column = rbsdem.Column(
        1.0, mass, Elastic(1e6), Elastic(1e6), axial_spring=Compression(stiffness),
        self_weight=True, gravity=g,
    )  # fmt: skip
    omega = np.sqrt(stiffness / mass)
    speed = np.sqrt(2 * g * height)
    period = 2 * speed / g + 2 * (np.pi - np.arctan2(speed * omega, g)) / omega
    half = period / 2
    options = {
        "rk45": {"method": "rk45", "tolerance": 1e-10},
        "located": {
            "method": "rk4", "events": "located", "dt": half / np.ceil(period * omega / 0.04)
        },
        "newmark": {"method": "newmark", "dt": half / np.ceil(period * omega / 0.02)},
    }[method]  # fmt: skip
    times = np.linspace(0.0, 20 * period, 41)
    run = rbsdem.time_history(column, times, initial={"opening": [height]}, **options)
    tops, bottoms = run.opening[::2, 0], run.opening[1::2, 0]
    deepest = -g / omega**2 - np.sqrt((g / omega**2) ** 2 + (speed / omega) ** 2)
    assert np.max(np.abs(tops / height - 1)) < close
    assert np.max(np.abs(bottoms / deepest - 1)) < close * (1 if stiffness < 1e8 else 1e3)


@pytest.mark.parametrize("method", ["rk4", "rk45", "newmark", "hht", "generalised_alpha"])
@pytest.mark.parametrize("push", [0.999, 1.001])
def test_body_lifts_off_where_the_ground_falls_faster_than_it(method, push):
    """The ground falls with `push` times gravity: closed below 1, open above."""
    stiffness, mass, g = 1e8, 50.0, 9.80665
    column = rbsdem.Column(
        1.0, mass, Elastic(1e6), Elastic(1e6),
        axial_spring=Compression(stiffness),
        self_weight=True, gravity=g, damping=rbsdem.Damping(stiffness=1e-4, tangent=True),
    )  # fmt: skip
    times = np.linspace(0.0, 0.5, 51)
    fall = -push * g * np.minimum(times / 0.1, 1.0)
    options = {} if method == "rk4" else {"dt": 1e-4} if method != "rk45" else {}
    run = rbsdem.time_history(column, times, vertical_acceleration=fall, method=method, **options)
    if push < 1:
        assert np.all(run.opening[times > 0.3] < 0)
        at_rest = -(1 - push) * mass * g / stiffness
        assert run.opening[-1, 0] == pytest.approx(at_rest, rel=1e-3)
    else:
        # From the moment at which the ground outruns it, half a cube of the time, then a square.
        ramp, late = 0.1 - 0.1 / push, times[times > 0.2] - 0.1
        slope = push * g / 0.1
        expected = slope * (ramp**3 / 6 + ramp**2 / 2 * late) + 0.5 * (push - 1) * g * late**2
        np.testing.assert_allclose(run.opening[times > 0.2, 0], expected, atol=3e-5)
