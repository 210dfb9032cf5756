"""Extremes of the column: ratios of stiffness and mass, up to 5000 bodies, axial loads about the
critical one.

Static answers are held against exact fractions, motions against the cosine of a single mode, for
which the average acceleration has a phase in closed form. Frequencies themselves: test_modes.py.
"""

from __future__ import annotations

import itertools
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from reference_chain import Linear, chain, deformations
from scipy.integrate import solve_ivp

import rbsdem
from rbsdem.springs import Elastic

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

IMPLICIT = ("newmark", "hht", "generalised_alpha")
METHODS = ("rk4", "rk45", *IMPLICIT)


def exact_static(column: rbsdem.Column, force: float) -> tuple[list[Fraction], Fraction]:
    """Deformations and displacement of the top under a lateral force, without round-off.

    (diag(k) - P G) q = a F with the second derivatives G of sum l_k th_k^2/2 + sum u_k th_{k-1}.
    """
    n, load = column.n, Fraction(column.axial_load)
    if column.kinematics == "small":
        load = Fraction(0)
    length = [Fraction(value) for value in column.lengths]
    size = 2 * n
    matrix = [[Fraction(0)] * (size + 1) for _ in range(size)]
    arm = [Fraction(1)] * n + [sum(length[i:], Fraction(0)) for i in range(n)]
    for i, spring in enumerate((*column.joints("shear"), *column.joints("flexure"))):
        matrix[i][i] += Fraction(spring.k)
        matrix[i][size] = arm[i] * Fraction(force)
    for k in range(n):
        for i in range(k + 1):
            for j in range(k + 1):
                matrix[n + i][n + j] -= load * length[k]
        for j in range(k):
            matrix[k][n + j] -= load
            matrix[n + j][k] -= load
    for j in range(size):
        for row in range(j + 1, size):
            factor = matrix[row][j] / matrix[j][j]
            if factor:
                for place in range(j, size + 1):
                    matrix[row][place] -= factor * matrix[j][place]
    answer = [Fraction(0)] * size
    for j in reversed(range(size)):
        rest = sum((matrix[j][i] * answer[i] for i in range(j + 1, size)), Fraction(0))
        answer[j] = (matrix[j][size] - rest) / matrix[j][j]
    return answer, sum((a * q for a, q in zip(arm, answer, strict=True)), Fraction(0))


def worst(seen, exact) -> float:
    """Largest error of deformations, each relative to itself."""
    return max(
        abs(float((Fraction(float(one)) - other) / other))
        for one, other in zip(seen, exact, strict=True)
    )


def loaded(n: int, ratio: float = 9.0, share: float = 0.0, **options) -> rbsdem.Column:
    """Bodies none like another with k_V l^2/k_M = ratio, under a share of the critical load."""
    rng = np.random.default_rng(n)
    lengths = rng.uniform(0.5, 1.5, n)
    flexure = 1e7 * rng.uniform(1, 2, n)
    springs = ratio * flexure / lengths**2, flexure
    critical = Linear(chain(lengths, lengths, *springs)).critical_load()
    options = {"kinematics": "pdelta", "masses": rng.uniform(50, 100, n)} | options
    masses = options.pop("masses")
    return chain(lengths, masses, *springs, axial_load=share * critical, **options)


def decades(n: int, seed: int) -> rbsdem.Column:
    """Stiffnesses at random over 18 decades."""
    rng = np.random.default_rng(seed)
    return chain(rng.uniform(0.5, 1.5, n), np.ones(n), *10 ** rng.uniform(0, 18, (2, n)))


STATIC = [(loaded(n, ratio), 1e-13) for n in (1, 2, 5, 12) for ratio in (1e-9, 1e-3, 1e3, 1e9)]
STATIC += [(loaded(n, ratio, 0.5), 1e-12) for n in (2, 12) for ratio in (1e-9, 1.0, 1e9)]
STATIC += [(decades(n, seed), 1e-13) for n in (2, 5, 12) for seed in range(5)]


@pytest.mark.filterwarnings("ignore:the (rotation of a body|top) goes beyond")
@pytest.mark.parametrize(("column", "close"), STATIC)
def test_static_path_has_all_digits_of_each_deformation(column, close):
    answer, top = exact_static(column, 1.0)
    run = rbsdem.cyclic(column, force=[1.0])
    assert worst(deformations(run)[0], answer) < close
    back = rbsdem.cyclic(column, displacement=[float(top)])
    assert worst([back.force[0]], [Fraction(1)]) < close


@pytest.mark.parametrize("share", [-1.0, 0.5, 0.999, 1.001, 2.0])
@pytest.mark.parametrize("n", [1, 2, 10])
def test_static_path_under_axial_load(n, share):
    """Near the critical load an error of a stiffness grows by 1/|1 - share|."""
    column = loaded(n, share=share)
    answer, top = exact_static(column, 1.0)
    way = 1e-4 if top > 0 else -1e-4
    close = 1e-13 / abs(1 - share) * n
    run = rbsdem.cyclic(column, displacement=[way])
    scale = Fraction(way) / top
    assert worst([run.force[0]], [scale]) < close
    largest = max(abs(q) for q in answer)
    wrong = [
        abs(Fraction(float(q)) - e * scale)
        for q, e in zip(deformations(run)[0], answer, strict=True)
    ]
    assert float(max(wrong) / abs(largest * scale)) < close
    if share > 1:
        # A dropping path: the column must be held back.
        assert top < 0 and run.force[0] * way < 0  # noqa: PT018
        with pytest.raises(rbsdem.SolveError, match=r"is [.\d]+ times the critical load"):
            rbsdem.cyclic(column, force=[1.0])
    bent = loaded(n, share=share, kinematics="finite")
    small = rbsdem.cyclic(bent, displacement=[way * 1e-2])
    assert small.force[0] == pytest.approx(float(scale) * 1e-2, rel=1e-6 / abs(1 - share))


def measure_single_mode(column: rbsdem.Column, method: str, periods: float, steps: int = 0):
    """Let a column go in its lowest mode: error of the deformations, relative, and of the energy.

    `newmark` with a number of steps per period: against its own phase 2 atan(omega h/2) a step.
    """
    modes = rbsdem.modes(column)
    n, omega = column.n, modes.omega[0]
    shape = 1e-3 * modes.shapes[:, 0] / np.max(np.abs(modes.shapes[n:, 0]))
    times = np.linspace(0.0, periods * 2 * np.pi / omega, 9)
    h = times[1] / max(round(steps * periods / 8), 1)
    options = {"dt": h} if method == "newmark" else {"tolerance": 1e-9}
    run = rbsdem.time_history(
        column, times, method=method, initial={"slip": shape[:n], "rotation": shape[n:]}, **options
    )
    phase = omega * times if method == "rk45" else 2 * np.arctan(omega * h / 2) / h * times
    k = np.array([s.k for s in (*column.joints("shear"), *column.joints("flexure"))])
    measure = np.sqrt(k) * np.abs(deformations(run) - np.cos(phase)[:, None] * shape)
    whole = run.energy["kinetic"] + 0.5 * deformations(run) ** 2 @ k
    return (
        float(np.max(measure) / np.max(np.sqrt(k) * np.abs(shape))),
        float(np.max(np.abs(whole / whole[0] - 1))),
    )


def uneven(n: int, ratio: float) -> rbsdem.Column:
    """Masses of neighbours differ by a ratio."""
    masses = 100.0 * np.where(np.arange(n) % 2 == 0, 1.0, ratio)
    return chain([0.5] * n, masses, [3e7] * n, [2e7] * n)


MOTIONS = [(loaded(n, ratio), 0.25) for n in (1, 3) for ratio in (1e-9, 1e-3, 1e3, 1e9)]
MOTIONS += [(uneven(n, ratio), 0.5) for n in (2, 4) for ratio in (1e-6, 1e-3, 1e3, 1e6)]
MOTIONS += [(loaded(n, share=share), 2.0) for n in (1, 3, 10) for share in (-1.0, 0.5, 0.999)]


@pytest.mark.parametrize(("column", "periods"), MOTIONS)
def test_motion_in_the_lowest_mode(column, periods):
    """`rk45` follows the slow mode over the fast ones, and `newmark` need not see them."""
    near = 1.0
    if column.axial_load:
        near = 1 - column.axial_load / Linear(column).critical_load()
    error, energy = measure_single_mode(column, "newmark", 5.0, 200)
    assert error < 1e-8 / abs(near)
    assert energy < 1e-8 or column.axial_load
    error, energy = measure_single_mode(column, "rk45", periods)
    assert error < 1e-6 / abs(near)
    assert energy < 1e-6 or column.axial_load


HEIGHT, BENDING, SHEAR = 2.0, 1.2e7, 2.5e8


def cantilever(n: int, **options) -> rbsdem.Column:
    """A uniform cantilever; in bending the joint at the foot stands for half a body only."""
    length = HEIGHT / n
    bending = BENDING * np.concatenate([[2.0], np.ones(n - 1)]) / length
    return chain([length] * n, [800.0 / n] * n, [SHEAR / length] * n, bending, **options)


def measure_deflection(n: int, kinematics: str, load: float) -> float:
    """Relative error of the deflection by a force at the top, under an axial load.

    The beam of Euler and Bernoulli: tan(c L)/(c^3 EI) - L/(c^2 EI), c^2 = P/EI. The share of the
    shear springs, which is in proportion to their flexibility, is taken off.
    """
    column = cantilever(n, kinematics=kinematics, axial_load=load)
    c = np.sqrt(load / BENDING)
    exact = (np.tan(c * HEIGHT) / c - HEIGHT) / load
    one, half = (
        rbsdem.cyclic(replace(column, shear=Elastic(k * n)), force=[1.0]).displacement[0]
        for k in (1e12, 2e12)
    )
    return float((2 * half - one) / exact - 1)


@pytest.mark.parametrize("kinematics", ["pdelta", "finite"])
def test_deflection_tends_to_the_beam_with_order_2_up_to_5000_bodies(kinematics):
    bodies = np.array([1, 5, 50, 500, 5000])
    wrong = np.array([measure_deflection(n, kinematics, 3e6) for n in bodies])
    orders = -np.diff(np.log10(np.abs(wrong))) / np.diff(np.log10(bodies))
    np.testing.assert_allclose(orders[1:], 2.0, atol=0.06)
    assert abs(wrong[-1]) < 0.65 * float(bodies[-1]) ** -2


@pytest.mark.parametrize("n", [2, 100, 5000])
def test_implicit_run_stays_in_equilibrium(n):
    """From the static answer under force and axial load nothing may move."""
    column = cantilever(n, kinematics="pdelta", axial_load=2e6)
    static = rbsdem.cyclic(column, force=[1e4])
    for method in IMPLICIT:
        run = rbsdem.time_history(
            column, [0.0, 1.0], force=[1e4, 1e4], method=method, dt=0.05,
            initial={"slip": static.slip[0], "rotation": static.rotation[0]},
        )  # fmt: skip
        moved = np.max(np.abs(run.displacement - static.displacement[0]))
        assert moved < 1e-9 * abs(static.displacement[0]), method


@pytest.mark.filterwarnings("ignore:the ground. its peak is")
@pytest.mark.parametrize("method", [*METHODS, "located"])
@pytest.mark.parametrize("kind", ["axial_load", "vertical_acceleration"])
def test_load_that_goes_beyond_the_critical_one_for_a_while(method, kind):
    """One body: (I + m l^2/3) th'' + (k_M - P(t) l) th = 0 with P up to twice critical and back.

    By vertical motion P = m_above (g + a); the slip follows from the shear spring, stiff here.
    """
    length, mass, k_m, k_v = 1.5, 200.0, 3e5, 1e11
    column = chain([length], [mass], [k_v], [k_m], kinematics="pdelta")
    inertia = mass * length**2 / 3
    times = np.linspace(0.0, 0.4, 41)
    load = 2 * k_m / length * np.sin(np.pi * times / 0.4) ** 2
    given = load if kind == "axial_load" else load / (mass / 2)

    def rates(time, state):
        p = np.interp(time, times, load)
        return [state[1], -(k_m - p * length) / inertia * state[0]]

    start = 2e-5
    states = [np.array([start, 0.0])]
    for span in itertools.pairwise(times):
        part = solve_ivp(rates, span, states[-1], method="DOP853", rtol=1e-11, atol=1e-17)
        states.append(part.y[:, -1])
    expected = np.array(states)[:, 0]
    assert np.max(np.abs(expected)) > 500 * start
    options = {"method": "rk4", "events": "located"} if method == "located" else {"method": method}
    if method in IMPLICIT:
        options["dt"] = 2e-5
    run = rbsdem.time_history(
        column, times, **{kind: given}, **options, initial={"rotation": [start]}
    )
    np.testing.assert_allclose(run.rotation[:, 0], expected, atol=2e-5 * np.max(expected))
    assert run.summary["relative_energy_residual"] < 1e-3
