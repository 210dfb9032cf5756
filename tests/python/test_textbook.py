"""Examples of textbooks with the numbers that are printed there.

An oscillator of mass m, stiffness k and damping c is a column of one body whose flexural spring is
1e9 times as stiff as k h^2: the body does not rotate, and what is left of the rotation changes
displacements by less than 1e-8 of themselves. Inches and kips are converted exactly (25.4 mm; the
pound-force is 0.45359237 kg times 9.80665 m/s2). Tolerances are a unit of the last printed digit,
more where the book goes on with rounded numbers.

References: A. K. Chopra, Dynamics of Structures (4th edition); R. W. Clough and J. Penzien,
Dynamics of Structures (2nd edition); K.-J. Bathe, Finite Element Procedures; S. P. Timoshenko and
J. M. Gere, Theory of Elastic Stability (2nd edition); K. Mattiasson, Int. J. Numer. Methods Eng. 17
(1981).
"""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.optimize import brentq

import rbsdem
from rbsdem.springs import Bilinear, Elastic, Spring

INCH = 0.0254
KIP = 1000 * 0.45359237 * 9.80665
MASS = KIP / INCH  # kip s2/in
RIGID = 1e9


def oscillator(
    mass: float, stiffness: float, damping: float = 0.0, spring: Spring | None = None
) -> rbsdem.Column:
    """One degree of freedom, in units of kips, inches and seconds."""
    k = stiffness * KIP / INCH
    return rbsdem.Column(
        1.0,
        mass * MASS,
        spring or Elastic(k),
        Elastic(RIGID * k),
        damping=rbsdem.Damping(mass=damping / mass),
    )


# m = 0.2533 kip s2/in, k = 10 kip/in, c = 0.1592 kip s/in (5 %);
# p = 10 sin(pi t/0.6) kip up to 0.6 s.
PULSE_MASS, PULSE_STIFFNESS = 0.2533, 10.0
PULSE_DAMPING = 0.1592


def pulse(time: np.ndarray) -> np.ndarray:
    return np.where(time < 0.6 - 1e-9, 10 * np.sin(np.pi * time / 0.6), 0.0)


def respond(column: rbsdem.Column, step: float, end: float = 1.0, **options) -> np.ndarray:
    """Displacements at every 0.1 s [in]."""
    time = np.linspace(0.0, end, round(end / step) + 1)
    run = rbsdem.time_history(column, time, force=KIP * pulse(time), **options)
    at = np.searchsorted(run.time, 0.1 * np.arange(1, round(end / 0.1) + 1) - 1e-9)
    return run.displacement[at] / INCH


def test_chopra_theoretical_response_to_a_half_cycle_sine_pulse():
    """Last column of tables E5.2 to E5.4; the load is given at every millisecond."""
    column = oscillator(PULSE_MASS, PULSE_STIFFNESS, PULSE_DAMPING)
    printed = [0.0328, 0.2332, 0.6487, 1.1605, 1.5241, 1.4814, 0.9245, 0.0593, -0.7751, -1.2718]
    for options in (
        {"method": "rk45", "tolerance": 1e-9}, {"method": "newmark", "dt": 5e-4},
    ):  # fmt: skip
        np.testing.assert_allclose(respond(column, 1e-3, **options), printed, rtol=0, atol=1.1e-4)


def test_chopra_example_5_3_average_acceleration():
    column = oscillator(PULSE_MASS, PULSE_STIFFNESS, PULSE_DAMPING)
    printed = [0.0437, 0.2326, 0.6121, 1.0825, 1.4309, 1.4231, 0.9622, 0.1908, -0.6044, -1.1442]
    got = respond(column, 0.1, method="newmark", dt=0.1)
    np.testing.assert_allclose(got, printed, rtol=0, atol=1.1e-4)


def test_chopra_examples_5_5_and_5_6_elastoplastic():
    """Yield at 7.5 kip, by Newton's method and by the modified one: the same displacements."""
    k = PULSE_STIFFNESS * KIP / INCH
    yields = Bilinear(k=k, d_y=0.75 * INCH, k_post=0.0)
    column = oscillator(PULSE_MASS, PULSE_STIFFNESS, PULSE_DAMPING, yields)
    printed = [0.0437, 0.2326, 0.6121, 1.1143, 1.6214, 1.9891, 2.0951, 1.9240, 1.5602]
    got = respond(column, 0.1, 0.9, method="newmark", dt=0.1)
    np.testing.assert_allclose(got, printed, rtol=0, atol=1.1e-4)


def released(column: rbsdem.Column, start: float, period: float, cycles: int) -> np.ndarray:
    """Displacements at whole cycles after a release from rest at `start` [in]."""
    time = np.linspace(0.0, cycles * period, cycles * 1000 + 1)
    run = rbsdem.time_history(
        column, time, method="newmark", dt=period / 1000, force=np.zeros_like(time),
        initial={"slip": [start * INCH]},
    )  # fmt: skip
    return run.displacement[::1000] / INCH


def test_chopra_free_vibration_of_an_elevated_water_tank():
    """Chapter 2: 16.4 kip pull it by 2 in; after four cycles in 2.0 s the amplitude is 1 in.

    From these Chopra finds k = 8.2 kip/in, m = 20.03 kip/g, a damping of 2.76 %,
    c = 0.0360 kip s/in, and 13 cycles until the amplitude is 0.2 in.
    """
    column = oscillator(20.03 / 386, 8.2, 0.0360)
    assert 1 / rbsdem.modes(column).frequency[0] == pytest.approx(0.5, abs=5e-4)
    pull = rbsdem.cyclic(column, force=[16.4 * KIP])
    assert pull.displacement[0] / INCH == pytest.approx(2.0, rel=1e-8)
    peaks = released(column, 2.0, 0.5, 13)
    assert peaks[4] == pytest.approx(1.0, abs=0.005)
    assert peaks[13] == pytest.approx(0.2, abs=0.02)


def test_clough_and_penzien_example_e2_1():
    """A jack pulls a one-storey building by 0.20 in with 20 kip; 0.16 in come back after 1.40 s.

    From these: weight 1920 kip, damping 3.55 %, c = 1.584 kip s/in, 0.0524 in after six cycles.
    """
    column = oscillator(1920 / 386, 100.0, 1.584)
    peaks = released(column, 0.20, 1.40, 6)
    assert peaks[1] == pytest.approx(0.16, abs=5e-4)
    assert peaks[6] == pytest.approx(0.0524, abs=3e-4)
    assert 1 / rbsdem.modes(column).frequency[0] == pytest.approx(1.40, abs=5e-3)


def test_chopra_example_4_1_rectangular_pulse():
    """4 kip for 0.2 s on a frame of k = 3.73 kip/in, 0.5 s: R_d = 1.902, peak 2.04 in."""
    column = oscillator(3.73 * (0.5 / (2 * np.pi)) ** 2, 3.73)
    time = np.linspace(0.0, 1.0, 10001)
    force = KIP * np.select([time < 0.2 - 1e-9, time < 0.2 + 1e-9], [4.0, 2.0], 0.0)
    run = rbsdem.time_history(column, time, force=force, method="newmark", dt=1e-4)
    peak = np.max(np.abs(run.displacement)) / INCH
    assert peak / (4 / 3.73) == pytest.approx(1.902, abs=5e-4)
    assert peak == pytest.approx(2.04, abs=5e-3)


def bathe(inertia: float) -> tuple[float, float, float]:
    """Mass and stiffnesses of a body of unit height for a rotary inertia about the centroid.

    A unit force at the top accelerates it by 1 (1/m + 1/(4 J)), moves it by 0.3 in the end
    (1/k_V + 1/k_M), and the sum of the eigenvalues is 7 (k_V + k_M/J).
    """
    mass = 4 * inertia / (4 * inertia - 1)
    both = 12 * inertia**2 / (4 * inertia - 1)
    flexure = (both - 7) / (1 - 1 / inertia)
    return mass, 7 - flexure / inertia, flexure


def test_bathe_two_degrees_of_freedom_by_the_trapezoidal_rule():
    """M = diag(2, 1), K = [6 -2; -2 4], a force of 10 on the second from rest, steps of 0.28.

    Seen from that force, the system is given by its eigenvalues 2 and 5 and by its static and
    initial flexibility. One body that slips and rotates has four values to choose, so it can have
    the same four; the trapezoidal rule does not mind which coordinates it is applied to. The force
    is 0.01, so that rotations are small, and the displacements are 1000 times those here.
    """
    inertia = brentq(lambda j: np.prod(bathe(j)[1:]) - 10 * bathe(j)[0] * j, 4.0, 6.0, xtol=1e-14)
    mass, shear, flexure = bathe(inertia)
    column = rbsdem.Column(1.0, mass, Elastic(shear), Elastic(flexure), rotary_inertia=[inertia])
    np.testing.assert_allclose(rbsdem.modes(column).omega ** 2, [2.0, 5.0], rtol=1e-12)

    time = 0.28 * np.arange(13)
    force = np.full(13, 0.01)
    run = rbsdem.time_history(column, time, force=force, method="newmark", dt=0.28)
    printed = [0.364, 1.35, 2.68, 4.00, 4.95, 5.34, 5.13, 4.48, 3.64, 2.90, 2.44, 2.31]
    np.testing.assert_allclose(1000 * run.displacement[1:], printed, rtol=0, atol=5.5e-3)

    # The exact answer, by superposition of modes.
    exact = rbsdem.time_history(column, time, force=force, method="rk45", tolerance=1e-9)
    printed = [0.382, 1.41, 2.78, 4.09, 5.00, 5.29, 4.986, 4.277, 3.457, 2.806, 2.484, 2.489]
    np.testing.assert_allclose(
        1000 * exact.displacement[np.isin(exact.time, time)][1:], printed, rtol=0, atol=5.5e-3
    )


LENGTH, BENDING, WEIGHT = 1.0, 1.0, 1.0


def beam(n: int, **options) -> rbsdem.Column:
    """EI = m = L = 1, only bending; the joint at the foot stands for half a body."""
    k = BENDING * n / LENGTH
    return rbsdem.Column(
        LENGTH, WEIGHT, Elastic(1e9 * n),
        [Elastic(2 * k)] + [Elastic(k)] * (n - 1), n=n, **options,
    )  # fmt: skip


def test_frequencies_of_the_uniform_cantilever():
    """3.516, 22.03 and 61.70 times sqrt(EI/(m L^4)), m per length (Chopra, beams)."""
    coarse, fine = (rbsdem.modes(beam(n)).omega[:3] for n in (50, 100))
    omega = (4 * fine - coarse) / 3  # their errors have order 2
    assert omega[0] == pytest.approx(3.516, abs=5e-4)
    np.testing.assert_allclose(omega[1:], [22.03, 61.70], rtol=0, atol=5e-3)


def test_chopra_example_6_2_period_of_a_pipe_column():
    """4-inch pipe, 12 ft, 29 000 ksi, 7.23 in4, 5.20 kip on top: 0.211 kip/in, 3.958 rad/s, 1.59 s.

    Chopra's frequency is that of the rounded stiffness, 0.1 % above the one of 0.2107 kip/in.
    """
    stiffness, length, n = 29e3 * KIP * 7.23 * INCH**2, 144 * INCH, 60
    k = stiffness * n / length
    column = rbsdem.Column(
        length, 1e-3, Elastic(1e9 * k),
        [Elastic(2 * k)] + [Elastic(k)] * (n - 1),
        n=n, top_mass=5.20 / 386 * MASS, gravity=0.0,
    )  # fmt: skip
    pushed = rbsdem.cyclic(column, displacement=[INCH])
    assert pushed.force[0] / KIP == pytest.approx(0.211, abs=5e-4)
    modes = rbsdem.modes(column)
    assert modes.omega[0] == pytest.approx(3.958, abs=0.005)
    assert 1 / modes.frequency[0] == pytest.approx(1.59, abs=5e-3)


def test_euler_load_of_the_cantilever():
    """pi^2 EI/(4 L^2) = 2.467 EI/L^2 (Timoshenko and Gere, chapter 2)."""
    column = beam(100, axial_load=3.0, kinematics="pdelta")
    with pytest.raises(rbsdem.InputError, match="critical load") as caught:
        rbsdem.modes(column)
    said = re.search(r"critical load of ([-+.e\d]+) N", str(caught.value))
    assert said is not None
    assert float(said[1]) == pytest.approx(2.467, abs=5e-4)


@pytest.mark.parametrize(
    ("angle", "load", "height", "way"),
    [
        (20, 1.015, 0.970, 0.220),
        (40, 1.063, 0.881, 0.422),
        (60, 1.152, 0.741, 0.593),
        (80, 1.293, 0.560, 0.719),
        (100, 1.518, 0.349, 0.792),
    ],
)
def test_timoshenko_and_gere_elastica_under_axial_load(angle, load, height, way):
    """Their table: rotation of the end, P/P_cr, and where the end is, of a buckled cantilever.

    The chain is driven across to the printed place and needs no force there; the printed load has
    four digits, which at 20 degrees are 2 % of the distance from the critical one.
    """
    column = beam(80, axial_load=load * np.pi**2 / 4, kinematics="finite")

    def push(displacement):
        return rbsdem.cyclic(column, displacement=np.linspace(0.0, displacement, 30)[1:])

    stands = brentq(lambda d: push(d).force[-1], 0.9 * way, min(1.1 * way, 0.95), xtol=1e-9)
    end = push(stands)
    assert end.top[-1, 0] == pytest.approx(way, abs=0.004)
    assert end.top[-1, 1] == pytest.approx(height, abs=0.003)
    assert np.degrees(np.sum(end.rotation[-1])) == pytest.approx(angle, abs=0.4)


@pytest.mark.parametrize(
    ("force", "across", "down", "turn"),
    [
        (1, 0.30172, 0.05643, 0.46135),
        (2, 0.49346, 0.16064, 0.78175),
        (10, 0.81061, 0.55500, 1.43029),
    ],
)
def test_mattiasson_elastica_under_a_force_across(force, across, down, turn):
    """Table of elliptic integrals to five digits: F L^2/EI, way across and down over L, rotation.

    Chains of 40 and 80 bodies err with order 2; what both say of the limit has the digits.
    """

    def shape(n):
        run = rbsdem.cyclic(beam(n, kinematics="finite"), force=np.linspace(0, force, 11)[1:])
        return np.array([run.top[-1, 0], 1 - run.top[-1, 1], np.sum(run.rotation[-1])])

    limit = (4 * shape(80) - shape(40)) / 3
    np.testing.assert_allclose(limit, [across, down, turn], rtol=0, atol=2e-5)
