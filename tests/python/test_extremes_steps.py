"""Extremes of the time step: the limit of RK4, huge damping, bodies without mass.

RK4 multiplies the amplitude of an undamped mode by |R(i omega h)|, R(z) = 1 + z + z^2/2 + z^3/6 +
z^4/24, so the energy after any number of steps is known in closed form, below the limit and above.
"""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest
from reference_chain import as_initial, chain, deformations
from scipy.linalg import eig

import rbsdem
from rbsdem.springs import Bilinear, Elastic

# Chains of many bodies are as high as they come, and planned for long runs that end early.
pytestmark = pytest.mark.filterwarnings("ignore:(column. height|analysis. about) ")

IMPLICIT = ("newmark", "hht", "generalised_alpha")


def uneven(n: int, **options) -> rbsdem.Column:
    """Elastic bodies, none like another."""
    rng = np.random.default_rng(n)
    springs = rng.uniform(2e7, 5e7, (2, n))
    return chain(rng.uniform(0.5, 1.5, n), rng.uniform(50, 100, n), *springs, **options)


def growth(z):
    """Return |R(i z)|^2 without cancellation."""
    return 1.0 - z**6 / 72 * (1 - z**2 / 8)


def all_modes(n: int, share: float):
    """Return a column, a state at rest with the energy 1/2 in every mode, frequencies, a step."""
    column = uneven(n)
    modes = rbsdem.modes(column)
    start = as_initial(modes.shapes @ (1.0 / modes.omega), n=n)
    return column, start, modes.omega, share * 2 * np.sqrt(2) / modes.omega[-1]


def total_energy(run: rbsdem.Result) -> np.ndarray:
    column = run.column
    k = np.array([spring.k for spring in (*column.joints("shear"), *column.joints("flexure"))])
    return run.energy["kinetic"] + 0.5 * deformations(run) ** 2 @ k


@pytest.mark.parametrize("share", [0.5, 0.99])
@pytest.mark.parametrize(("n", "steps"), [(1, 100_000), (10, 20_000), (100, 2_000)])
def test_below_the_limit_the_energy_falls_as_it_must(n, steps, share):
    column, initial, omega, dt = all_modes(n, share)
    run = rbsdem.time_history(
        column, [0.0, steps * dt], dt=dt, every=steps // 10, initial=initial, method="rk4"
    )
    energy = total_energy(run)
    assert np.all(np.diff(energy) < 0)
    left = np.mean(np.exp(run.summary["steps"] * np.log(growth(omega * dt))))
    assert energy[-1] / energy[0] == pytest.approx(left, rel=1e-9)


@pytest.mark.parametrize("share", [1.01, 2.0])
@pytest.mark.parametrize("n", [1, 10, 100])
def test_above_the_limit_is_refused_with_the_limit_or_stops_with_the_time(n, share):
    column, initial, omega, dt = all_modes(n, share)
    limit = dt / share
    with pytest.raises(rbsdem.InputError, match="beyond the stability limit of rk4") as caught:
        rbsdem.time_history(column, [0.0, 1.0], force=[0.0, 0.0], dt=dt, method="rk4")
    told = float(re.search(r"of rk4, ([-+.e\d]+) s", str(caught.value)).group(1))
    assert told == pytest.approx(limit, rel=1e-5)
    with pytest.raises(rbsdem.SolveError, match="grows without bounds") as caught:
        rbsdem.time_history(
            column, [0.0, 1e6 * dt], dt=dt, every=10, initial=initial, allow_unstable=True,
            method="rk4",
        )  # fmt: skip
    # It stops where the deformations pass 1e100. The highest mode passes through zero now and
    # then, and other modes take part.
    told = float(re.search(r"at time ([-+.e\d]+) s", str(caught.value)).group(1))
    shape = np.max(np.abs(rbsdem.modes(column).shapes[:, -1])) / omega[-1]
    needed = (100 * np.log(10) - np.log(shape)) / (0.5 * np.log(growth(omega[-1] * dt)))
    assert told / dt == pytest.approx(needed, rel=0.01, abs=3)
    result = caught.value.result
    assert result.summary["status"] == "failed"
    assert result.time.size > 1
    for part in (result.slip, result.rotation, result.shear, result.moment):
        assert np.all(np.isfinite(part))
        assert np.max(np.abs(part)) < 1e109


@pytest.mark.parametrize("share", [0.5, 2.0, 1e3, 1e6])
@pytest.mark.parametrize(("n", "steps"), [(1, 10_000), (10, 5_000), (100, 500)])
def test_average_acceleration_keeps_the_energy_at_any_step(n, steps, share):
    column, initial, _, dt = all_modes(n, share)
    run = rbsdem.time_history(
        column, [0.0, steps * dt], dt=dt, method="newmark", every=steps // 20, initial=initial
    )
    energy = total_energy(run)
    # Beyond 1e3 times the limit round-off shows: inertia is 1e-12 of the forces and less.
    assert np.max(np.abs(energy / energy[0] - 1)) < (1e-9 if share <= 1e3 else 1e-7)


DAMPING_LIMIT = 2.785293563405282  # real root of R(-x) = 1


def roots(omega: float, damping: float) -> tuple[float, float]:
    """Return the rates of x'' + damping x' + omega^2 x = 0, the slow one without cancellation."""
    fast = -0.5 * damping - np.sqrt(0.25 * damping**2 - omega**2)
    return fast, omega**2 / fast


@pytest.mark.parametrize("kind", ["mass", "stiffness"])
@pytest.mark.parametrize("ratio", [10.0, 1e3, 1e6])
def test_huge_damping_moves_the_limit_and_creeps_exactly(kind, ratio):
    """One mode, `ratio` times critical; the stable step is that of the real root."""
    plain = rbsdem.modes(uneven(2))
    omega = plain.omega[0]
    damping = 2 * ratio * omega
    given = {kind: damping if kind == "mass" else damping / omega**2}
    column = uneven(2, damping=rbsdem.Damping(**given))
    limit = rbsdem.modes(column).stable_step
    largest = damping if kind == "mass" else damping * (plain.omega[-1] / omega) ** 2
    assert limit == pytest.approx(DAMPING_LIMIT / largest, rel=0.01)
    with pytest.raises(rbsdem.InputError, match="beyond the stability limit"):
        rbsdem.time_history(column, [0.0, 1.0], force=[0.0, 0.0], dt=1.01 * limit, method="rk4")

    shape = 1e-3 * plain.shapes[:, 0]
    at_rest = {"slip": shape[:2], "rotation": shape[2:]}
    fast, slow = roots(omega, damping)
    creeping = at_rest | {"slip_velocity": slow * shape[:2], "rotation_velocity": slow * shape[2:]}
    explicit, implicit = np.linspace(0.0, 2000 * limit, 11), np.linspace(0.0, -3 / slow, 7)
    for method, times, options in (
        ("rk4", explicit, {"dt": 0.99 * limit, "every": 200}),
        ("rk45", explicit, {"tolerance": 1e-10}),
        *((method, implicit, {"dt": -1 / slow / 500}) for method in IMPLICIT),
    ):
        begin = creeping if method in IMPLICIT else at_rest
        run = rbsdem.time_history(column, times, method=method, initial=begin, **options)
        expected = np.exp(slow * run.time)
        if begin is at_rest:
            expected = (fast * expected - slow * np.exp(fast * run.time)) / (fast - slow)
        wrong = np.max(np.abs(run.slip / shape[:2] - expected[:, None]))
        assert wrong < 2e-6, method


@pytest.mark.parametrize("method", ["rk4", "rk45", *IMPLICIT])
def test_tangent_damping_of_a_perfectly_plastic_spring_vanishes(method):
    """The slip yields with a constant force: x'' = -F_y/m once the rotation is stiff as a rock.

    With the initial stiffness in its place the damping force would be some 60 times F_y.
    """
    spring = Bilinear(1e6, 1e-6, 0.0)
    column = rbsdem.Column(
        1.0, 100.0, spring, Elastic(1e12), rotary_inertia=1e6,
        damping=rbsdem.Damping(stiffness=1e-4, tangent=True),
    )  # fmt: skip
    options = {"rk45": {"tolerance": 1e-9}, "rk4": {"events": "located"}}.get(method, {"dt": 1e-5})
    times = np.linspace(0.0, 0.5, 6)
    run = rbsdem.time_history(
        column, times, method=method, initial={"slip_velocity": [0.6]}, **options
    )
    expected = 0.6 * times - 0.5 * (1e6 * 1e-6 / 100.0) * times**2
    np.testing.assert_allclose(run.slip[:, 0], expected, atol=1e-4)


@pytest.mark.parametrize("lightness", [1e-6, 1e-12, 1e-30])
@pytest.mark.parametrize("method", IMPLICIT)
def test_nearly_massless_body_moves_as_if_it_had_none(method, lightness):
    """The limit without mass has half the modes, from K^-1 M with a singular M.

    Steps are 1/100 of the lowest period; the modes of the light body, up to 1e15 times as fast,
    must not wake up. Newmark's average acceleration turns by 2 atan(omega h/2) in a step.
    """
    k_v, k_m, heavy, length = [3e6, 2e6], [4e6, 5e6], 80.0, 0.7
    column = rbsdem.Column(
        2 * length, None, [Elastic(k) for k in k_v], [Elastic(k) for k in k_m], n=2,
        lengths=[length] * 2, masses=[heavy * lightness, heavy],
    )  # fmt: skip
    centre = np.array([1.0, 1.0, 1.5 * length, 0.5 * length])
    turn = np.array([0.0, 0.0, 1.0, 1.0])
    mass = heavy * (np.outer(centre, centre) + length**2 / 12 * np.outer(turn, turn))
    values, vectors = eig(mass / np.array([*k_v, *k_m])[:, None])
    lowest = np.argmax(values.real)
    omega, shape = values.real[lowest] ** -0.5, 1e-3 * vectors[:, lowest].real
    dt = 2 * np.pi / omega / 100
    run = rbsdem.time_history(
        column, [0.0, 300 * dt], dt=dt, method=method, every=10,
        initial={"slip": shape[:2], "rotation": shape[2:]},
    )  # fmt: skip
    phase = 2 * np.arctan(omega * dt / 2) / dt * run.time
    close = 1e-6 + 4 * lightness if method == "newmark" else 5e-3
    np.testing.assert_allclose(
        np.hstack([run.slip, run.rotation]), np.cos(phase)[:, None] * shape,
        atol=close * np.max(np.abs(shape)),
    )  # fmt: skip


@pytest.mark.parametrize("method", IMPLICIT)
def test_zeros_of_a_vibration_may_fall_on_the_steps(method):
    """All forces vanish together there, and nothing but round-off is left to converge to.

    Average acceleration turns by 2 atan(omega h/2) in a step: pi/2 after `steps` of these.
    """
    column = uneven(1)
    modes = rbsdem.modes(column)
    for j, steps in itertools.product((0, 1), (3, 7, 50, 105, 108, 201)):
        h = 2 * np.tan(np.pi / (4 * steps)) / modes.omega[j]
        shape = 1e-3 * modes.shapes[:, j]
        run = rbsdem.time_history(
            column, [0.0, 3 * steps * h], dt=h, method=method, every=steps,
            initial={"slip": shape[:1], "rotation": shape[1:]},
        )  # fmt: skip
        assert run.summary["cut_steps"] == 0
        if method == "newmark":
            np.testing.assert_allclose(
                run.rotation[:, 0] / shape[1], [1.0, 0.0, -1.0, 0.0], atol=1e-9
            )
