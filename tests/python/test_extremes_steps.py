"""Extremes of the time step: the limit of RK4, huge damping, bodies without mass.

RK4 multiplies the amplitude of an undamped mode by |R(i omega h)|, R(z) = 1 + z + z^2/2 + z^3/6 +
z^4/24, so the energy after any number of steps is known in closed form, below the limit and
above. `measure_...` take the number of steps: few here, many in studies/extremes.py.
"""

from __future__ import annotations

import itertools
import re

import numpy as np
import pytest
from scipy.linalg import eig

import rbsdem
from rbsdem.springs import Bilinear, Elastic

# Chains of many bodies are as high as they come, and planned for long runs that end early.
pytestmark = pytest.mark.filterwarnings("ignore:(column. height|analysis. about) ")

BODIES = [1, 10, 100]
IMPLICIT = ("newmark", "hht", "generalised_alpha")


def chain(n: int, **options) -> rbsdem.Column:
    """Elastic bodies, none like another."""
    rng = np.random.default_rng(n)
    lengths = rng.uniform(0.5, 1.5, n)
    return rbsdem.Column(
        lengths.sum(), None, [Elastic(k) for k in rng.uniform(2e7, 5e7, n)],
        [Elastic(k) for k in rng.uniform(2e7, 5e7, n)], n=n, lengths=lengths,
        masses=rng.uniform(50, 100, n), **options,
    )  # fmt: skip


def growth(z):
    """Return |R(i z)|^2 without cancellation."""
    return 1.0 - z**6 / 72 * (1 - z**2 / 8)


def all_modes(column: rbsdem.Column) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Return a state at rest with the energy 1/2 in every mode, and the frequencies."""
    modes = rbsdem.modes(column)
    q = modes.shapes @ (1.0 / modes.omega)
    return {"slip": q[: column.n], "rotation": q[column.n :]}, modes.omega


def total_energy(run: rbsdem.Result, column: rbsdem.Column) -> np.ndarray:
    k = np.array([spring.k for spring in (*column.joints("shear"), *column.joints("flexure"))])
    return run.energy["kinetic"] + 0.5 * np.hstack([run.slip, run.rotation]) ** 2 @ k


# ---- the limit of RK4 ----------------------------------------------------------------------------


def measure_below_the_limit(n: int, share: float, steps: int, events: str = "step"):
    """Energy at the end over that at the begin, observed and in closed form."""
    column = chain(n)
    initial, omega = all_modes(column)
    dt = share * 2 * np.sqrt(2) / omega[-1]
    run = rbsdem.time_history(
        column,
        [0.0, steps * dt],
        dt=dt,
        every=max(steps // 10, 1),
        initial=initial,
        events=events,
        method="rk4",
    )
    energy = total_energy(run, column)
    assert np.all(np.diff(energy) < 0)
    left = np.mean(np.exp(run.summary["steps"] * np.log(growth(omega * dt))))
    return energy[-1] / energy[0], left


@pytest.mark.parametrize("share", [0.5, 0.99])
@pytest.mark.parametrize(("n", "steps"), [(1, 100_000), (10, 20_000), (100, 2_000)])
def test_below_the_limit_the_energy_falls_as_it_must(n, steps, share):
    seen, exact = measure_below_the_limit(n, share, steps)
    assert seen == pytest.approx(exact, rel=1e-9)


def test_below_the_limit_with_located_events():
    seen, exact = measure_below_the_limit(2, 0.99, 20_000, events="located")
    assert seen == pytest.approx(exact, rel=1e-9)


def measure_above_the_limit(n: int, share: float, events: str = "step"):
    """Step at which the deformations pass 1e100, observed and in closed form; what is kept."""
    column = chain(n)
    initial, omega = all_modes(column)
    dt = share * 2 * np.sqrt(2) / omega[-1]
    with pytest.raises(rbsdem.SolveError, match="grows without bounds") as caught:
        rbsdem.time_history(
            column, [0.0, 1e6 * dt], dt=dt, every=10, initial=initial, events=events,
            allow_unstable=True, method="rk4",
        )  # fmt: skip
    told = float(re.search(r"at time ([-+.e\d]+) s", str(caught.value)).group(1))
    shape = np.max(np.abs(rbsdem.modes(column).shapes[:, -1])) / omega[-1]
    needed = (100 * np.log(10) - np.log(shape)) / (0.5 * np.log(growth(omega[-1] * dt)))
    return told / dt, needed, caught.value.result


@pytest.mark.parametrize("share", [1.01, 2.0])
@pytest.mark.parametrize("n", BODIES)
def test_above_the_limit_is_refused_with_the_limit_or_stops_with_the_time(n, share):
    column = chain(n)
    limit = 2 * np.sqrt(2) / rbsdem.modes(column).omega[-1]
    with pytest.raises(rbsdem.InputError, match="beyond the stability limit of rk4") as caught:
        rbsdem.time_history(column, [0.0, 1.0], force=[0.0, 0.0], dt=share * limit, method="rk4")
    told = float(re.search(r"of rk4, ([-+.e\d]+) s", str(caught.value)).group(1))
    assert told == pytest.approx(limit, rel=1e-5)
    seen, needed, result = measure_above_the_limit(n, share)
    # The highest mode passes through zero now and then, and other modes take part.
    assert seen == pytest.approx(needed, rel=0.01, abs=3)
    assert result.summary["status"] == "failed"
    assert result.time.size > 1
    for part in (result.slip, result.rotation, result.shear, result.moment):
        assert np.all(np.isfinite(part))
        assert np.max(np.abs(part)) < 1e109


@pytest.mark.parametrize("n", [1, 3])
def test_above_the_limit_springs_that_harden_without_end_let_it_grow_too(n):
    spring = Bilinear(5e8, 1e-3, 4e8)
    column = rbsdem.Column(2.0, 500.0, spring, spring, n=n)
    limit = rbsdem.modes(column).stable_step
    with pytest.raises(rbsdem.SolveError, match="grows without bounds at time"):
        rbsdem.time_history(
            column, [0.0, 1e6 * limit], dt=1.5 * limit, initial={"slip": np.full(n, 2e-3)},
            allow_unstable=True, every=1000, method="rk4",
        )  # fmt: skip


def measure_average_acceleration(n: int, share: float, steps: int) -> float:
    """Largest change of the energy of Newmark's method, relative: in theory none at any step."""
    column = chain(n)
    initial, omega = all_modes(column)
    dt = share * 2 * np.sqrt(2) / omega[-1]
    run = rbsdem.time_history(
        column, [0.0, steps * dt], dt=dt, method="newmark", every=max(steps // 20, 1),
        initial=initial,
    )  # fmt: skip
    energy = total_energy(run, column)
    return np.max(np.abs(energy / energy[0] - 1))


@pytest.mark.parametrize("share", [0.5, 2.0, 1e3, 1e6])
@pytest.mark.parametrize(("n", "steps"), [(1, 10_000), (10, 5_000), (100, 500)])
def test_average_acceleration_keeps_the_energy_at_any_step(n, steps, share):
    # Beyond 1e3 times the limit round-off shows: inertia is 1e-12 of the forces and less.
    assert measure_average_acceleration(n, share, steps) < (1e-9 if share <= 1e3 else 1e-7)


# ---- damping -------------------------------------------------------------------------------------

DAMPING_LIMIT = 2.785293563405282  # real root of R(-x) = 1


def roots(omega: float, damping: float) -> tuple[float, float]:
    """Return the rates of x'' + damping x' + omega^2 x = 0, the slow one without cancellation."""
    fast = -0.5 * damping - np.sqrt(0.25 * damping**2 - omega**2)
    return fast, omega**2 / fast


@pytest.mark.parametrize("kind", ["mass", "stiffness"])
@pytest.mark.parametrize("ratio", [10.0, 1e3, 1e6])
def test_huge_damping_moves_the_limit_and_creeps_exactly(kind, ratio):
    """One mode, `ratio` times critical; the stable step is that of the real root."""
    plain = rbsdem.modes(chain(2))
    omega = plain.omega[0]
    damping = 2 * ratio * omega
    given = {kind: damping if kind == "mass" else damping / omega**2}
    column = chain(2, damping=rbsdem.Damping(**given))
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


def measure_start_off_the_creep(method: str, ratio: float) -> float:
    """Largest displacement, over that at the begin, of an overdamped column let go at rest.

    In theory 1. Its acceleration is that of an undamped column for a time of 1/damping, far less
    than the step; the alpha methods carry it on, average acceleration does not.
    """
    plain = rbsdem.modes(chain(2))
    omega = plain.omega[0]
    column = chain(2, damping=rbsdem.Damping(mass=2 * ratio * omega))
    _, slow = roots(omega, 2 * ratio * omega)
    shape = 1e-6 / ratio**2 * plain.shapes[:, 0]
    run = rbsdem.time_history(
        column, [0.0, -3 / slow], dt=-1 / slow / 500, method=method, every=1,
        initial={"slip": shape[:2], "rotation": shape[2:]},
    )  # fmt: skip
    return np.max(np.abs(run.slip / shape[:2]))


def test_start_off_the_creep_of_huge_damping():
    assert measure_start_off_the_creep("newmark", 1e3) < 1 + 1e-9
    for method in ("hht", "generalised_alpha"):
        beyond = [measure_start_off_the_creep(method, ratio) - 1 for ratio in (1e3, 1e4)]
        assert beyond[0] < 0.08
        assert beyond[1] / beyond[0] == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize("method", ["rk4", "rk45", *IMPLICIT])
@pytest.mark.parametrize("ratio", [1e-9, 0.5, 0.999999])
def test_modal_damping_up_to_the_critical_one(method, ratio):
    column = chain(3, damping=ratio)
    modes = rbsdem.modes(column)
    for j in (0, 5):
        omega, shape = modes.omega[j], 1e-3 * modes.shapes[:, j]
        times = np.linspace(0.0, 4.0 / omega, 9)
        options = {"tolerance": 1e-9} if method == "rk45" else {"dt": times[-1] / 8 / 500}
        run = rbsdem.time_history(
            column, times, method=method, initial={"slip": shape[:3], "rotation": shape[3:]},
            **options,
        )  # fmt: skip
        turn = omega * np.sqrt((1 - ratio) * (1 + ratio))
        envelope = np.exp(-ratio * omega * run.time)
        exact = envelope * (
            np.cos(turn * run.time) + ratio * omega * run.time * np.sinc(turn * run.time / np.pi)
        )
        np.testing.assert_allclose(
            run.rotation, exact[:, None] * shape[3:], atol=3e-5 * np.max(np.abs(shape[3:]))
        )
    with pytest.raises(rbsdem.InputError, match=r"damping: modal = 1 must be below 1"):
        chain(3, damping=1.0)


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


# ---- without mass or inertia ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"mass": 0.0}, "column: mass = 0 kg must be above zero"),
        ({"mass": None, "masses": [5.0, 0.0]}, r"column: masses\(2\) = 0 kg must be above zero"),
        ({"rotary_inertia": 0.0}, "column: rotary_inertia = 0 kg m2 must be above zero"),
        ({"rotary_inertia": [1.0, 0.0]}, r"column: rotary_inertia\(2\) = 0 kg m2 must be above"),
    ],
)
def test_bodies_without_mass_or_inertia_are_refused_by_name(change, named):
    spring = Elastic(1e6)
    with pytest.raises(rbsdem.InputError, match=named):
        rbsdem.Column(
            **{"height": 2.0, "mass": 10.0, "shear": spring, "flexure": spring, "n": 2} | change
        )


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
    column = chain(1)
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
