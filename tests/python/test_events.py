"""Steps in time through events: closed forms on one spring, and the observed orders of all methods.

A mass on an axial spring, which is coupled to nothing else, opens and closes as an oscillator.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from reference_chain import deformations

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, Takeda

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")

MASS, K, POST, YIELD = 2.0, 800.0, 80.0, 0.05
FAST, SLOW = np.sqrt(K / MASS), np.sqrt(POST / MASS)
PLASTIC = Bilinear(K, YIELD, POST)
SHEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
TAKEDA = {"k_c": 2.5428e8, "d_c": 3.1891e-4, "k_y": 6.2937e7, "d_y": 2.7183e-3, "k_u": 7.5772e6}
STOPS = ("located", "rk45")


def settings(method: str, finish: float, steps: int, tolerance: float) -> dict[str, Any]:
    """Return a method in equal steps; `rk45` by its tolerance."""
    if method == "rk45":
        return {"method": method, "tolerance": tolerance}
    events = {"method": "rk4", "events": "located"} if method == "located" else {"method": method}
    return events | {"dt": finish / steps}


def moved(
    spring, finish, w, v, method="rk45", *, mass=MASS, push=0.0, steps=400, tolerance=1e-12
) -> rbsdem.Result:
    """Return the motion of a mass from an opening and a velocity, pushed by a constant load."""
    column = rbsdem.Column(
        1.0, mass, Elastic(1.0), Elastic(1.0), axial_spring=spring, axial_load=push
    )
    return rbsdem.time_history(
        column, [0.0, finish], initial={"opening": [w], "opening_velocity": [v]},
        **settings(method, finish, steps, tolerance),
    )  # fmt: skip


def end(*given, **more) -> float:
    """Return the opening at the end of a motion."""
    return moved(*given, **more).opening[-1, 0]


def mean_order(errors: list[float]) -> float:
    return float(np.log2(errors[0] / errors[-1]) / (len(errors) - 1))


def test_a_spring_that_yields_both_ways():
    """It yields, turns, yields the other way, turns, and goes back to zero force.

    On each line the motion is harmonic.
    """
    v, time = 4.0, np.arcsin(YIELD * FAST / 4.0) / FAST
    v = np.sqrt(v**2 - (YIELD * FAST) ** 2)
    f = K * YIELD
    reach = np.hypot(f / POST, v / SLOW)
    time += np.arctan2(v / SLOW, f / POST) / SLOW
    w, f = YIELD - f / POST + reach, POST * reach
    span = f / K - 2 * YIELD  # elastic down by twice the yield deformation
    time += np.arccos(span * K / f) / FAST
    v = FAST * np.sqrt((f / K) ** 2 - span**2)
    w, f = w - 2 * YIELD, K * span
    reach = np.hypot(f / POST, v / SLOW)
    time += np.arctan2(v / SLOW, -f / POST) / SLOW + np.pi / 2 / FAST
    w += -f / POST - reach + POST * reach / K
    errors = [abs(end(PLASTIC, time, 0, 4, "located", steps=80 * 2**i) - w) for i in range(1, 5)]
    assert 3.7 < mean_order(errors) < 4.8
    assert errors[-1] < 1e-5 * YIELD
    for digits in range(6, 13, 2):
        run = moved(PLASTIC, time, 0.0, 4.0, tolerance=10.0**-digits)
        assert run.opening[-1, 0] == pytest.approx(w, abs=10.0 ** (3 - digits))
        speed = np.sqrt(2 * run.energy["kinetic"][-1] / MASS)
        assert speed == pytest.approx(FAST * POST * reach / K, abs=10.0 ** (3 - digits))
    assert run.summary["energy_residual"] < 1e-10 * MASS * 16


def test_located_steps_without_events_are_those_of_rk4():
    """Elastic springs have no ends: bits."""
    for n in (1, 2, 5):
        column = rbsdem.Column(2.0, 300.0, Elastic(4e8), Elastic(2e8), n=n)
        loads = {"time": [0.0, 2.0**-7], "force": [0.0, 1e5], "method": "rk4", "dt": 2.0**-18}
        one, other = (
            rbsdem.time_history(column, **loads, **events) for events in ({}, {"events": "located"})
        )
        assert one.channels.keys() == other.channels.keys()
        assert all(np.array_equal(one.channels[key], other.channels[key]) for key in one.channels)


def test_a_contact_that_closes_at_the_end_of_a_step():
    """Free flight in binary fractions, contact at t = 1, then half a period and off again."""
    contact = Compression(4.0)
    for method in STOPS:
        flight = moved(contact, 1.0, 1.0, -1.0, method, mass=1.0, steps=4, tolerance=1e-10)
        assert flight.opening[-1, 0] == pytest.approx(0.0, abs=1e-15)
        assert flight.energy["kinetic"][-1] == pytest.approx(0.5, rel=1e-15)
        back = moved(contact, 4.0, 1.0, -1.0, method, mass=1.0, steps=1024, tolerance=1e-10)
        assert back.opening[-1, 0] == pytest.approx(3 - np.pi / 2, abs=1e-9)
        assert back.summary["events"] == 3  # open at the start, closed, opened


@pytest.mark.parametrize("method", STOPS)
@pytest.mark.parametrize("touch", [1.0, 1.1, 1.0 + 1e-9])
def test_a_contact_that_is_just_touched(touch, method):
    """w = (t - t0)^2 - depth under a constant lift: beyond the end and back within a step."""
    for depth in (0.0, *(sign * 10.0**-i for i in (16, 12, 8, 4) for sign in (1, -1))):
        run = moved(
            Compression(10.0), 2.0, touch**2 - depth, -2 * touch, method, mass=1.0, push=-2.0,
            steps=8, tolerance=1e-9,
        )  # fmt: skip
        energy = run.energy["kinetic"] - 2 * run.opening[:, 0]
        assert energy[1] == pytest.approx(energy[0], abs=1e-7 + 1e-3 * np.sqrt(abs(depth)))
        near = 1e-6 + 20 * np.sqrt(max(depth, 0.0))
        assert run.opening[-1, 0] == pytest.approx((2 - touch) ** 2 - depth, abs=near)


def blocks(openings, speeds, finish, **given) -> rbsdem.Result:
    """Return the motion of blocks of 1 kg that are thrown at each other."""
    n = len(openings)
    column = rbsdem.Column(
        1.0, float(n), Elastic(1.0), Elastic(1.0), n=n, axial_spring=Compression(100.0)
    )
    return rbsdem.time_history(
        column, np.array([0.0, 0.5, 1.0]) * finish,
        initial={"opening": openings, "opening_velocity": speeds}, **given,
    )  # fmt: skip


def test_contacts_that_close_at_the_same_instant():
    exact = blocks([1.0, 1.0], [-1.0, -1.0], 2.0, method="rk45", tolerance=1e-12)
    runs = [
        blocks([1.0] * 2, [-1.0] * 2, 2.0, **settings("located", 2.0, 40 * 2**i, 0.0))
        for i in range(1, 5)
    ]
    wrong = [np.abs(run.opening[-1] - exact.opening[-1]).max() for run in runs]
    assert 3.7 < mean_order(wrong) < 5
    assert wrong[-1] < 1e-5
    assert runs[-1].energy["kinetic"][-1] == pytest.approx(2.5, rel=1e-6)
    assert (runs[-1].opening[-1] > 0).all()


def test_many_contacts_open_and_close_within_one_step():
    """The first of these events is known only after they are located: energy of order 4."""
    rng = np.random.default_rng(1)
    for _ in range(5):
        start = rng.uniform(0, 0.05, 8), rng.uniform(-1, 0.2, 8)
        runs = [blocks(*start, 3.0, **settings("located", 3.0, 40 * 2**i, 0)) for i in range(1, 5)]
        wrong = [run.summary["energy_residual"] / run.energy["kinetic"][0] for run in runs]
        assert runs[-1].summary["events"] > 20
        assert 3.7 < mean_order(wrong) < 7
        assert wrong[-1] < 1e-5


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("method", STOPS)
def test_a_start_on_the_end_of_a_line(method, side):
    """The yield deformation is on the yielded line; a spring that turns back there is elastic."""
    finish = 0.75 * np.pi / FAST
    still = end(PLASTIC, finish, side * YIELD, 0.0, method)
    assert still == pytest.approx(side * YIELD * np.cos(0.75 * np.pi), rel=1e-9)
    inward = end(PLASTIC, np.pi / 2 / FAST, side * YIELD, -side * 0.1, method)
    assert inward == pytest.approx(-side * 0.1 / FAST, rel=1e-9)
    rest = K * YIELD / POST
    outward = end(PLASTIC, np.arctan2(1 / SLOW, rest) / SLOW, side * YIELD, side * 1.0, method)
    assert outward == pytest.approx(side * (YIELD - rest + np.hypot(rest, 1 / SLOW)), rel=1e-9)


def test_a_start_with_a_velocity_against_a_one_way_line():
    """Yielded by its opening, and moving back: the first step is on the elastic line.

    Without location of events that step is on the wrong line.
    """
    amplitude = (K + POST) * YIELD / K
    expected = 2 * YIELD - amplitude + amplitude * np.cos(0.5) - 0.1 / FAST * np.sin(0.5)
    for method, near in (("rk45", 1e-10), ("located", 1e-10), ("rk4", 1e-3)):
        found = end(PLASTIC, 0.5 / FAST, 2 * YIELD, -0.1, method, steps=100)
        assert found == pytest.approx(expected, rel=near)


@pytest.mark.parametrize("method", STOPS)
def test_a_plateau_at_rest_and_gliding(method):
    """Its load is the force of the plateau to the last bit: no line changes without need."""
    flat, given = Bilinear(1024.0, 0.0625, 0.0), {"push": -64.0, "steps": 10, "tolerance": 1e-8}
    still = moved(flat, 1.0, 0.125, 0.0, method, **given)
    assert (still.opening == 0.125).all()
    assert still.energy["kinetic"].tolist() == [0.0, 0.0]
    glides = moved(flat, 1.0, 0.125, 0.25, method, **given)
    assert glides.opening[-1, 0] == pytest.approx(0.375, rel=1e-14)
    assert glides.summary["events"] == 1


@pytest.mark.parametrize("inner", ["kc", "kr", "one"])
def test_a_damped_column_comes_to_rest_in_ever_smaller_loops(inner):
    """Cracked and yielded on both sides; every swing crosses zero force."""
    spring = Takeda(**TAKEDA, b1=0.22, inner=inner)
    column = rbsdem.Column(1.6, 614.4, SHEAR, spring, damping=rbsdem.Damping(mass=20.0))
    y = 1.6 * 4 * spring.d_y
    pulled = rbsdem.cyclic(column, displacement=[y, -y, -y / 2])

    def swing(finish, method, steps=1):
        given = settings(method, finish, steps, 1e-12)
        return rbsdem.time_history(column, [0.0, finish], initial=pulled, **given)

    exact, found = swing(0.2, "rk45"), swing(0.2, "located", 8000)
    np.testing.assert_allclose(
        deformations(found)[-1], deformations(exact)[-1], atol=1e-7 * np.abs(exact.rotation).max()
    )
    still = swing(2.0, "rk45")  # exp(-20) is left
    assert still.energy["kinetic"][-1] < 1e-10
    assert still.summary["events"] > 100
    assert still.summary["relative_energy_residual"] < 1e-10


@pytest.mark.parametrize("method", ["rk4", *STOPS])
def test_a_yield_and_a_turn_are_two_events(method):
    assert moved(PLASTIC, 0.14, 0.0, 2.0, method, steps=1000).summary["events"] == 2


def test_the_pair_is_of_order_5():
    """Its error goes with the tolerance, and the number of its steps with the fifth root of it."""
    column = rbsdem.Column(2.0, 300.0, Elastic(4e8), Elastic(2e8))
    modes = rbsdem.modes(column)
    shape = 1e-3 * modes.shapes[:, 0]
    time = 40 / modes.omega[0] * np.array([0.0, 0.3, 1.0])
    steps, errors = [], []
    for tolerance in (1e-7, 1e-12):
        run = rbsdem.time_history(
            column, time, method="rk45", tolerance=tolerance,
            initial={"slip": shape[:1], "rotation": shape[1:]},
        )  # fmt: skip
        steps.append(run.summary["steps"])
        errors.append(np.abs(run.rotation[:, 0] / shape[1] - np.cos(modes.omega[0] * time)).max())
    assert steps[1] / steps[0] == pytest.approx(10, rel=0.05)
    assert 0.85 < np.log10(errors[0] / errors[1]) / 5 < 1.2


def scene(number: int) -> tuple[rbsdem.Column, dict[str, Any]]:
    """Return a column that yields and turns many times, and its loads.

    Rows 0 to 5 have a lateral force; 7 to 9 all four loads, with joints that open or not.
    """
    flexure = Takeda(**TAKEDA, b1=0.22) if number in (1, 2, 4, 5) else Bilinear(2.5e8, 3e-4, 2.5e7)
    n = 3 if number in (3, 4) else 1
    kinematics = ["small", "small", "pdelta", "small", "pdelta", "finite"][number % 6]
    more: dict[str, Any] = {"n": n, "kinematics": kinematics}
    if kinematics != "small":
        more |= {"axial_load": 1e6}
    if number == 4:
        more |= {"self_weight": True, "damping": rbsdem.Damping(mass=5.0)}
    time = 0.05 * np.arange(8) / 7
    force = np.random.default_rng(number + 31).uniform(-2e5, 2e5, 8) * (time > 0)
    loads: dict[str, Any] = {"time": time, "force": force}
    if number > 5:
        more |= {"n": 3, "kinematics": "finite" if number < 8 else "pdelta", "self_weight": True}
        more |= {"axial_load": 1e6, "top_mass": 500.0}
        more |= {"damping": rbsdem.Damping(mass=2.0, stiffness=1e-5)} if number % 2 else {}
        more |= {"axial_spring": Elastic(2e9)} if number in (7, 9) else {}
        loads |= {"ground_acceleration": 50 * np.sin(90 * time)}
        loads |= {"vertical_acceleration": 50 * np.sin(70 * time)}
        loads |= {"axial_load": 1e6 + 1e6 * np.sin(60 * time)}
    n = more["n"]
    column = rbsdem.Column(1.6, 614.4, SHEAR, flexure, **more)
    start = {"slip_velocity": [0.3] + [0.0] * (n - 1), "rotation_velocity": [1.0] + [0.0] * (n - 1)}
    return column, loads | {"initial": start}


@pytest.mark.parametrize("number", [0, 1, 2, 3, 4, 5, 7, 8, 9])
def test_orders_through_yielding_and_unloading(number):
    """Steps that end at events are of order 4 in the response and in the energy.

    A change of line at the end of a step takes two orders away, and the error varies at random: the
    mean over halvings is taken. Errors of some hundred steps of the pair add up.
    """
    column, loads = scene(number)

    def run(method, steps=0, tolerance=0.0, **more) -> rbsdem.Result:
        given = settings(method, 0.05, steps, tolerance)
        return rbsdem.time_history(column, **loads, **given, **more)

    exact = run("rk45", tolerance=1e-13)
    assert exact.summary["events"] > 20

    largest = np.abs(exact.rotation).max()

    def off(found) -> float:
        return np.abs(deformations(found) - deformations(exact)).max() / largest

    coarse = 357 if column.n == 1 else 2002
    parts = [coarse * 2**i for i in range(4)]
    located = [run("located", steps) for steps in parts]
    errors = [off(found) for found in located]
    energies = [found.summary["relative_energy_residual"] for found in located]
    assert 3.5 < mean_order(errors) < 4.5, errors
    assert errors[-1] < 2e-7
    assert (4 if number < 6 else 3.4) < mean_order(energies) < 6, energies
    assert energies[-1] < 1e-8
    assert located[-1].summary["events"] == exact.summary["events"]
    # Steps that do not divide the times of the loads end at their corners too.
    ends = [
        np.abs(deformations(run("located", steps + 5 * 2**i))[-1] - deformations(exact)[-1]).max()
        for i, steps in enumerate(parts)
    ]
    assert 3.4 < mean_order(ends) < 4.5, ends
    assert ends[-1] < 2e-7 * largest
    pair = [off(run("rk45", tolerance=10.0**-digits)) for digits in range(4, 13)]
    assert all(error < 10.0 ** (4 - digits) for digits, error in enumerate(pair, 4)), pair
    assert 0.85 < np.log10(pair[3] / pair[8]) / 5 < 1.2, pair
    for method, radius in (
        ("rk4", {}), ("newmark", {}), ("hht", {"rho_infinity": 0.9}),
        ("generalised_alpha", {"rho_infinity": 0.8}), ("generalised_alpha", {"rho_infinity": 0.0}),
    ):  # fmt: skip
        errors = [off(run(method, steps, **radius)) for steps in [*parts, 2 * parts[-1]][1:]]
        assert 1.4 < mean_order(errors) < 2.8, (method, radius, errors)
        assert errors[-1] < 3e-3, (method, radius)
