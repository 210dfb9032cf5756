"""Extremes of rotation and contact: to a right angle, full turns, bodies that fly off and land.

The elastica has closed forms for a force across and a load along the beam; a chain tends to it with
order 2. Motions are held against `reference_chain`, which knows nothing but the energies.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from reference_chain import Chain
from scipy.optimize import brentq
from scipy.special import ellipe, ellipeinc, ellipk, ellipkinc

import rbsdem
from rbsdem.errors import AccuracyWarning
from rbsdem.springs import Compression, Elastic

HEIGHT, BENDING = 2.0, 1e6


def elastic(values) -> list[Elastic]:
    return [Elastic(float(k)) for k in values]


def slender(n: int, load: float = 0.0, kinematics: str = "finite") -> rbsdem.Column:
    """A beam that only bends; its foot, half a body from the ground, is twice as stiff."""
    length = HEIGHT / n
    return rbsdem.Column(
        HEIGHT, 100.0, Elastic(1e12 * n),
        elastic([2 * BENDING / length] + [BENDING / length] * (n - 1)), n=n,
        kinematics=kinematics, axial_load=load,
    )  # fmt: skip


# ---- the elastica --------------------------------------------------------------------------------


def across(turn: float) -> tuple[float, float]:
    """F L^2/EI of a force across a cantilever, and x_T/L, for a rotation of its end.

    K. E. Bisshopp, D. C. Drucker, Q. Appl. Math. 3 (1945): with p^2 = (1 + sin turn)/2 and
    sin a = 1/(p sqrt 2) it is (K(p) - F(p, a))^2.
    """
    m = (1 + np.sin(turn)) / 2
    a = np.arcsin(1 / np.sqrt(2 * m))
    root = ellipk(m) - ellipkinc(a, m)
    # height of the end: L sqrt(2 sin turn)/root; its way across from E(p).
    return root**2, 1 - 2 * (ellipe(m) - ellipeinc(a, m)) / root


def measure_across(n: int, turn: float) -> tuple[float, float]:
    """Errors of the way across, relative to the height, and of the rotation of the end [rad]."""
    force, way = across(turn)
    run = rbsdem.cyclic(slender(n), force=[force * BENDING / HEIGHT**2])
    return (
        float(run.displacement[0] / HEIGHT - way),
        float(np.sum(run.rotation[0]) - turn),
    )


@pytest.mark.parametrize("turn", [0.3, 1.0, 1.4, 1.55])
def test_force_across_bends_a_chain_to_the_elastica_with_order_2(turn):
    """Up to 89 degrees at the end, by 100 times the force of the linear range and more."""
    wrong = np.abs([measure_across(n, turn) for n in (20, 40, 80, 160)])
    orders = np.log2(wrong[:-1] / wrong[1:])
    np.testing.assert_allclose(orders[-1], 2.0, atol=0.1)
    assert np.max(wrong[-1]) < (2e-4 if turn < 1.5 else 3e-3)


def along(turn: float) -> tuple[float, float, float]:
    """Load over the critical one, way across and height over L of a buckled cantilever.

    P/P_cr = (2 K(p)/pi)^2 with p = sin(turn/2); beyond 2.29 rad the end is below the foot.
    """
    m = np.sin(turn / 2) ** 2
    k = ellipk(m)
    return (2 * k / np.pi) ** 2, np.sqrt(m) * 2 / k, 2 * ellipe(m) / k - 1


def measure_along(n: int, turn: float) -> tuple[float, float]:
    """Errors of way across and height of a buckled chain, where it needs no force across."""
    share, way, height = along(turn)
    column = slender(n, share * np.pi**2 * BENDING / (4 * HEIGHT**2))

    def force(displacement):
        path = np.linspace(0.0, displacement, 30)[1:]
        return rbsdem.cyclic(column, displacement=path)

    root = brentq(
        lambda d: force(d).force[-1], 0.9 * way * HEIGHT, min(1.1 * way, 0.99) * HEIGHT, xtol=1e-12
    )
    top = force(root).top[-1]
    return float(top[0] / HEIGHT - way), float(top[1] / HEIGHT - height)


@pytest.mark.parametrize("turn", [0.5, 1.0, np.pi / 2, 1.8])
def test_load_beyond_the_critical_one_bends_a_chain_to_the_elastica_with_order_2(turn):
    """Held back by a driven top, which needs no force where the buckled beam stands alone."""
    wrong = np.abs([measure_along(n, turn) for n in (10, 20, 40)])
    orders = np.log2(wrong[:-1] / wrong[1:])
    np.testing.assert_allclose(orders[-1], 2.0, atol=0.15)
    assert np.max(wrong[-1]) < 3e-3


@pytest.mark.parametrize("n", [1, 3])
def test_top_that_is_driven_farther_than_the_column_is_long_slides_at_the_foot(n):
    """All bodies lie; the slip of the lowest joint, along the ground, is what is left."""
    k_v = 1e9
    column = rbsdem.Column(HEIGHT, 100.0, Elastic(k_v), Elastic(1e5), n=n, kinematics="finite")
    run = rbsdem.cyclic(column, displacement=HEIGHT * np.linspace(0.0, 1.2, 61)[1:])
    assert run.force[-1] == pytest.approx(k_v * 0.2 * HEIGHT, rel=1e-3)
    assert np.sum(run.rotation[-1]) == pytest.approx(np.pi / 2, abs=0.01)
    assert np.max(np.abs(run.energy["residual"])) < 1e-5 * run.energy["spring"][-1]
    np.testing.assert_allclose(run.top[:, 0], run.displacement, atol=1e-9)


# ---- full turns ----------------------------------------------------------------------------------


@pytest.mark.parametrize("opens", [False, True], ids=["closed", "opening"])
@pytest.mark.parametrize("n", [1, 2])
def test_full_turns_against_hamiltons_equations(n, opens):
    """Weak joints, a fast spin: a full turn and more, where sine and cosine see all signs.

    Later on the motion is chaotic: what is 1e-10 apart is 1e-2 apart after half a second.
    """
    column = rbsdem.Column(
        1.0 * n, 10.0 * n, elastic([3e4] * n), elastic([20.0] * n), n=n, kinematics="finite",
        axial_spring=elastic([4e4] * n) if opens else None, axial_load=-400.0, self_weight=True,
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
        seen = np.hstack([run.slip, run.rotation] + ([run.opening] if opens else []))
        np.testing.assert_allclose(seen, expected, atol=2e-5)


def measure_turns(seconds: float) -> tuple[float, float]:
    """Number of full turns of three bodies about each other, and the relative drift of energy."""
    column = rbsdem.Column(
        3.0,
        30.0,
        elastic([3e5] * 3),
        elastic([2.0] * 3),
        n=3,
        kinematics="finite",
        axial_load=-20.0,
    )
    run = rbsdem.time_history(
        column, [0.0, seconds], method="rk45", tolerance=1e-10, every=50,
        initial={"rotation_velocity": [8.0, 5.0, -9.0]},
    )  # fmt: skip
    whole = run.energy["kinetic"] + run.energy["spring"] + run.energy["axial"]
    turned = np.max(np.abs(np.cumsum(run.rotation, axis=1))) / (2 * np.pi)
    return float(turned), float(np.max(np.abs(whole - whole[0])) / np.max(run.energy["kinetic"]))


def test_turning_chain_keeps_its_energy():
    turned, drift = measure_turns(5.0)
    assert turned > 2
    assert drift < 1e-6


# ---- where small rotations end -------------------------------------------------------------------


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
            told = "has no meaning" if turn > 1 else "errs by about"
            assert told in str(caught[0].message)


# ---- contact -------------------------------------------------------------------------------------


def measure_bounces(method: str, bounces: int, stiffness: float) -> tuple[float, float]:
    """A body falls on its joint and flies off again: errors of its highest and lowest places.

    Flight of 2 sqrt(2 h/g), then half a swing and a bit about the place of rest: the times of both
    places are in closed form, and so are the places.
    """
    mass, g, height = 50.0, 9.80665, 0.01
    column = rbsdem.Column(
        1.0, mass, Elastic(1e6), Elastic(1e6),
        axial_spring=Compression(stiffness),
        self_weight=True, gravity=g,
    )  # fmt: skip
    omega = np.sqrt(stiffness / mass)
    speed = np.sqrt(2 * g * height)
    contact = 2 * (np.pi - np.arctan2(speed * omega, g)) / omega
    period = 2 * speed / g + contact
    times = np.linspace(0.0, bounces * period, 2 * bounces + 1)
    options = {"rk45": {"method": "rk45", "tolerance": 1e-10}}.get(
        method,
        {"method": "rk4", "events": "located", "dt": period / 2 / np.ceil(period * omega / 0.04)},
    )
    if method == "newmark":
        options = {"method": "newmark", "dt": period / 2 / np.ceil(period * omega / 0.02)}
    run = rbsdem.time_history(column, times, initial={"opening": [height]}, **options)
    tops, bottoms = run.opening[::2, 0], run.opening[1::2, 0]
    deepest = -g / omega**2 - np.sqrt((g / omega**2) ** 2 + (speed / omega) ** 2)
    assert np.all(bottoms < 0)
    return (
        float(np.max(np.abs(tops / height - 1))),
        float(np.max(np.abs(bottoms / deepest - 1))),
    )


@pytest.mark.parametrize("stiffness", [1e6, 1e9])
@pytest.mark.parametrize(
    ("method", "close"), [("located", 1e-6), ("rk45", 1e-6), ("newmark", 0.05)]
)
def test_body_that_bounces_comes_back_to_its_height(method, close, stiffness):
    high, low = measure_bounces(method, 20, stiffness)
    assert high < close
    assert low < close * (1 if stiffness < 1e8 else 1e3)


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
