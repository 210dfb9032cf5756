"""Response in time: energy, nonlinear references, steps and rows, the initial state, refusals.

Elastic columns of all kinds are held to their equation of motion in `test_invariants.py`, exact
rotations to Hamilton's equations in `test_physics.py`.
"""

from __future__ import annotations

import sys
import threading
import time as clock

import numpy as np
import pytest
from reference_chain import Linear, as_initial

import rbsdem
from rbsdem import _core
from rbsdem.springs import Bilinear, Compression, Elastic, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

SHEAR = Bilinear(7.0387e8, 1.2960e-4, 8.3185e6)
FLEXURE = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
HEIGHT, MASS = 1.6, 614.4
METHODS = {
    "rk4": {"method": "rk4"},
    "located rk4": {"method": "rk4", "events": "located"},
    "rk45": {"method": "rk45", "tolerance": 1e-6},
    **{name: {"method": name} for name in ("newmark", "hht", "generalised_alpha")},
}

# Three bodies, nothing equal to anything; their highest frequency is 12 times the lowest.
LENGTHS, MASSES = [0.9, 0.6, 0.7], [500.0, 200.0, 300.0]
K_V, K_M = [4.0e6, 3.0e6, 2.0e6], [9.0e6, 7.0e6, 5.0e6]


def elastic(values) -> list[Elastic]:
    return [Elastic(k) for k in values]


def linear_column(n: int, **options) -> rbsdem.Column:
    return rbsdem.Column(
        float(np.sum(LENGTHS[:n])), None, elastic(K_V[:n]), elastic(K_M[:n]), n=n,
        lengths=LENGTHS[:n], masses=MASSES[:n], **options,
    )  # fmt: skip


def orders(errors) -> np.ndarray:
    """Observed orders between runs with halved steps."""
    errors = np.asarray(errors)
    return np.log2(errors[:-1] / errors[1:])


def random_loads(seed: int, points: int) -> np.ndarray:
    """Force [N] and acceleration of the ground [m/s2] at `points` times."""
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (points, 2)) * [5e4, 8.0]


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
@pytest.mark.parametrize(
    ("damping", "order"),
    [(None, 5), (rbsdem.Damping(20.0, 5e-4), 4)],
    ids=["undamped", "damped"],
)
def test_energy_residual_falls_with_its_order(kinematics, damping, order):
    """RK4 loses (omega h)^6/72 of an undamped mode in a step: order 5. Work of damping: order 4."""
    column = linear_column(3, kinematics=kinematics, axial_load=2e5, damping=damping)
    modes = rbsdem.modes(column)
    spacing = 1.6 / modes.omega[-1]
    loads = random_loads(7, 41)
    start = modes.shapes @ (1 / modes.omega)
    residuals = []
    for parts in (16, 32, 64) if order == 5 else (64, 128, 256):
        run = rbsdem.time_history(
            column, spacing * np.arange(41), force=loads[:, 0], ground_acceleration=loads[:, 1],
            dt=spacing / parts, initial=as_initial(start, modes.omega[0] * start, 3), method="rk4",
        )  # fmt: skip
        energy = run.energy
        others = ("kinetic", "spring", "damping", "axial")
        begin = energy["kinetic"][0] + energy["spring"][0] + energy["axial"][0]
        residual = energy["input"] + begin - sum(energy[name] for name in others)
        scale = np.max(energy["kinetic"] + energy["spring"])
        np.testing.assert_allclose(energy["residual"], residual, atol=1e-13 * scale)
        assert run.summary["energy_residual"] == np.max(np.abs(energy["residual"]))
        np.testing.assert_allclose(run.force, loads[:, 0], rtol=1e-12)
        residuals.append(np.max(np.abs(energy["residual"])) / scale)
    assert residuals[0] < 1e-5
    assert np.all(np.abs(orders(residuals) - order) < 0.1), orders(residuals)


@pytest.mark.parametrize("ratio", [0.02, 0.5, 0.75, 1.0, 2.0])
def test_step_just_below_the_limit_stays_bounded_when_springs_yield(ratio):
    """Stiffness damping stays when a spring yields, `ratio` is that of the highest mode."""

    def column(damping):
        return rbsdem.Column(
            HEIGHT, MASS, Bilinear(7e8, 1e-4, 7e5), Bilinear(2.5e8, 1e-4, 2.5e5),
            damping=rbsdem.Damping(stiffness=damping),
        )  # fmt: skip

    damped = column(2 * ratio / rbsdem.modes(column(0.0)).omega[-1])
    limit = rbsdem.modes(damped).stable_step
    run = rbsdem.time_history(
        damped, [0, 5000 * limit], dt=0.99 * limit,
        initial={"slip_velocity": [1.0], "rotation_velocity": [1.0]}, method="rk4",
    )  # fmt: skip
    # All the energy of the begin, spent on the flexural spring alone at its yield moment.
    energy, moment = run.energy["kinetic"][0], 2.5e8 * 1e-4
    assert np.max(np.abs(run.rotation)) < 2 * energy / moment


@pytest.mark.parametrize("factor", [1e-3, 1.0, 7.3, 1e3])
def test_no_step_given(factor):
    """Every interval is cut into equal steps not longer than a fifth of the limit."""
    column = linear_column(3)
    limit = rbsdem.modes(column).stable_step
    times = limit * factor * np.array([0.0, 1.0, 3.0, 3.5])
    run = rbsdem.time_history(column, times, initial={"slip": [1e-3, 0, 0]}, method="rk4")
    assert np.array_equal(run.time, times)
    parts = np.ceil(np.diff(times) / (limit / 5) * (1 - 1e-6))
    assert run.summary["steps"] == parts.sum()
    assert 0 < run.summary["time_step"] <= limit / 5 * (1 + 1e-9)


def test_a_step_that_divides_the_intervals_within_round_off():
    """Steps of 0.005 s in intervals of 0.02 s, whose ends are not exact; then one step for each."""
    column = rbsdem.Column(2.0, 1e4, Elastic(1e6), Elastic(1e6))
    time = 0.02 * np.arange(1001)
    for dt, steps in ((0.005, 4000), (1.0, 20), (0.02, 1000)):
        run = rbsdem.time_history(column, time, force=0 * time, method="newmark", dt=dt)
        assert run.summary["steps"] == steps


@pytest.mark.parametrize("given", [False, True])
def test_steps_and_rows_of_random_loadings(given):
    """No step exceeds the longest, and none is shorter than need be; the last row is kept."""
    column = rbsdem.Column(2.0, 1e4, Elastic(1e6), Elastic(1e6))
    limit = rbsdem.modes(column).stable_step
    rng = np.random.default_rng(2)
    for _ in range(40):
        time = rng.uniform(-100, 100) + np.append(0.0, np.cumsum(10 ** rng.uniform(-4, 0, 29)))
        dt = {"dt": limit * rng.uniform(0.01, 1)} if given else {}
        run = rbsdem.time_history(column, time, force=0 * time, method="rk4", **dt)
        steps = run.summary["steps"]
        if given:
            assert steps == np.ceil((time[-1] - time[0]) / dt["dt"] * (1 - 1e-9))
            assert run.time.size == steps + 1
        else:
            assert np.array_equal(run.time, time)
            assert steps == np.ceil(np.diff(time) / (limit / 5) * (1 - 1e-6)).sum()
        every = int(rng.integers(1, 40))
        thin = rbsdem.time_history(column, time, force=0 * time, method="rk4", every=every, **dt)
        assert thin.time.size == 1 + np.ceil(steps / every)


def test_initial_state_is_the_first_row():
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE, n=2)
    slip, rotation = [3e-4, -5e-4], [4e-3, -1e-3]
    run = rbsdem.time_history(
        column, [0, 1e-3], initial={"slip": slip, "rotation": rotation}, method="rk4"
    )
    assert run.slip[0].tolist() == slip
    assert run.rotation[0].tolist() == rotation
    for i in range(2):
        # The springs get there from zero, beyond yield too.
        assert run.shear[0, i] == SHEAR.response([slip[i]])[0]
        assert run.moment[0, i] == FLEXURE.response([rotation[i]])[0]
    top = sum(slip) + 0.8 * (rotation[0] + sum(rotation))
    assert run.displacement[0] == pytest.approx(top, rel=1e-14)
    assert run.energy["residual"][0] == 0.0
    assert run.energy["kinetic"][0] == 0.0


def test_initial_velocity_is_kinetic_energy():
    column = linear_column(3)
    velocity = np.array([0.1, -0.2, 0.3, 0.4, -0.5, 0.6])
    run = rbsdem.time_history(
        column,
        [0, 1e-3],
        initial={"slip_velocity": velocity[:3], "rotation_velocity": velocity[3:]},
        method="rk4",
    )
    expected = velocity @ Linear(column).mass @ velocity / 2
    assert run.energy["kinetic"][0] == pytest.approx(expected, rel=1e-13)
    one = rbsdem.time_history(linear_column(1), [0, 1e-3], initial={"rotation": 0.01}, method="rk4")
    assert one.rotation[0, 0] == 0.01


@pytest.mark.parametrize("n", [1, 3])
@pytest.mark.parametrize("method", METHODS)
def test_a_fall_without_a_criterion_of_collapse_is_an_error_that_keeps_its_rows(method, n):
    """P l above the yielded stiffness; the springs are on their rules up to there."""
    column = rbsdem.Column(
        HEIGHT, MASS, SHEAR, FLEXURE, n=n, kinematics="pdelta", axial_load=10 * FLEXURE.k_u / HEIGHT
    )
    told = "grows without bounds at" if "rk4" in method else "does not converge although it was cut"
    with pytest.raises(rbsdem.SolveError, match=told) as caught:
        rbsdem.time_history(column, 0.01 * np.arange(1001), force=np.full(1001, 2e5),
                            **METHODS[method])  # fmt: skip
    assert "rk4" in method or "spring of joint" in str(caught.value)
    kept = caught.value.result
    assert 1 < kept.time.size < 1000
    assert (np.diff(kept.time) > 0).all()
    assert all(np.isfinite(values).all() for values in kept.channels.values())


@pytest.mark.parametrize("n", [1, 4])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("spring", [Elastic(2e9), Compression(2e9), Bilinear(2e9, 1e-4, 1e8)])
def test_joints_closed_by_load_and_weight_stay_at_rest(spring, method, n):
    column = rbsdem.Column(
        2.0, 300.0, Elastic(4e8), Elastic(2e8), n=n, axial_spring=spring, axial_load=1e6,
        kinematics="pdelta", self_weight=True,
    )  # fmt: skip
    run = rbsdem.time_history(column, 1e-3 * np.arange(11), force=np.zeros(11), **METHODS[method])
    assert run.energy["kinetic"].max() < 1e-15
    assert run.axial_force[-1, 0] == pytest.approx(-1e6 - 300 * 9.80665, rel=1e-9)
    assert run.summary["energy_residual"] < 1e-9


def test_joints_that_cannot_carry_their_load_at_the_start():
    """A pull on contacts, also as the first value of a history; openings that are given may be."""
    told = r"axial spring of joint 1 cannot carry the axial force of -100000 N"
    for load, given in ((-1e5, {}), (1e5, {"axial_load": [-1e5, 1e5]})):
        column = rbsdem.Column(
            2.0, 300.0, Elastic(4e8), Elastic(2e8), n=3, axial_spring=Compression(1e9),
            axial_load=load,
        )  # fmt: skip
        loads = {"time": [0.0, 0.01], "method": "rk4", "force": [0.0, 0.0]} | given
        with pytest.raises(rbsdem.SolveError, match=told):
            rbsdem.time_history(column, **loads)
    rbsdem.time_history(column, **loads, initial={"opening": np.zeros(3)})


def has_a_turn_meanwhile(run) -> bool:
    """Whether Python gets a turn while a call of Fortran lasts.

    A thread keeps the interpreter for as long as it wants here, so that the turn can only come if
    Fortran gives it away.
    """
    state = []

    def work():
        run(lambda: state.append("in"), lambda: state.append("out"))

    worker = threading.Thread(target=work)
    interval = sys.getswitchinterval()
    sys.setswitchinterval(1000.0)
    try:
        worker.start()
        while not state:
            clock.sleep(0.0)
        seen = list(state)
    finally:
        sys.setswitchinterval(interval)
        worker.join()
    assert state[-1] == "out"
    return seen[-1] == "in"


@pytest.mark.parametrize("analysis", ["time_history", "cyclic", "response"])
def test_gil_is_released(analysis, monkeypatch):
    column = rbsdem.Column(HEIGHT, MASS, SHEAR, FLEXURE)
    path = np.tile(np.linspace(-0.05, 0.05, 1000), 2000)
    analyse = {
        "time_history": lambda: rbsdem.time_history(
            column, [0.0, 1.5e6 * 1e-4], force=[0.0, 0.0], dt=1e-4, every=1000, method="rk4"
        ),
        "cyclic": lambda: rbsdem.cyclic(column, displacement=path, every=1000),
        "response": lambda: FLEXURE.response(path),
    }[analysis]
    fortran = _core._rbsdem.rbs_evaluate

    def run(enter, leave):
        def watched(*arguments):
            enter()
            answer = fortran(*arguments)
            leave()
            return answer

        monkeypatch.setattr(_core._rbsdem, "rbs_evaluate", watched)
        analyse()

    # On a loaded machine the waiting thread may wake too late; it will not do so every time.
    assert any(has_a_turn_meanwhile(run) for _ in range(10))
