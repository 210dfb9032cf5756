"""Ground motions: what is computed of them, against closed forms and other programs."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import rbsdem
from rbsdem import GroundMotion, motions
from rbsdem.springs import Elastic

G = motions.STANDARD_GRAVITY


def harmonic(omega: float, cycles: int, per_cycle: int = 200) -> GroundMotion:
    dt = 2 * np.pi / omega / per_cycle
    return GroundMotion(np.sin(omega * dt * np.arange(cycles * per_cycle + 1)), dt, "sine")


def rectangular(length: float) -> GroundMotion:
    """One of 1 m/s2, that falls to zero at its end: the step of the table is the whole pulse."""
    return GroundMotion([1.0, 1.0], length, "pulse")


def test_intensities_of_a_sine_over_whole_cycles():
    """Velocity (1 - cos wt)/w; integral of sin^2 is half the length; its 5 and 95 % by symmetry."""
    omega = 4.0
    motion = harmonic(omega, 10)
    assert motion.pga == pytest.approx(1.0, rel=1e-3)
    assert motion.pgv == pytest.approx(2 / omega, rel=1e-4)
    assert motion.arias == pytest.approx(np.pi / (2 * G) * motion.length / 2, rel=1e-12)
    # The integral is t/2 - sin(2wt)/(4w); at 0 to 100 % of ten cycles 5 and 95 % are half a cycle
    # from the ends, where the sine is zero.
    assert motion.duration() == pytest.approx(0.9 * motion.length, rel=1e-6)
    assert motion.duration(5, 75) == pytest.approx(0.7 * motion.length, rel=1e-6)


def test_velocity_and_displacement_are_exact_for_straight_lines():
    """a = t: v = t^2/2, d = t^3/6; the rule of trapezoids has no error there for v."""
    motion = GroundMotion(np.linspace(0.0, 2.0, 5), 0.5)
    t = motion.time
    assert motion.velocity == pytest.approx(t**2 / 2, abs=1e-15)
    assert motion.displacement == pytest.approx(t**3 / 6, abs=1e-15)


@pytest.mark.parametrize("damping", [0.02, 0.05, 0.2])
def test_spectrum_of_a_long_sine_at_resonance(damping):
    """At rest first: x = (e^(-z w t) (...) - cos wt)/(2 z w^2), in the end 1/(2 zeta w^2)."""
    omega = 5.0
    cycles = int(np.ceil(2.5 / damping))
    motion = harmonic(omega, cycles, 400)
    spectrum = motion.spectrum([2 * np.pi / omega], damping)
    wanted = 1 / (2 * damping * omega**2)
    # The free decay has died to exp(-2 pi zeta cycles) < 2e-7; the sine's chords are 2e-5 low.
    assert spectrum.displacement[0] == pytest.approx(wanted, rel=5e-5)
    assert spectrum.pseudo_acceleration[0] == pytest.approx(1 / (2 * damping), rel=5e-5)
    # Velocity of the stationary sine, and its total acceleration sqrt(1 + 4 zeta^2)/(2 zeta).
    assert spectrum.velocity[0] == pytest.approx(omega * wanted, rel=5e-5)
    total = np.sqrt(1 + 4 * damping**2) / (2 * damping)
    assert spectrum.acceleration[0] == pytest.approx(total, rel=5e-5)


@pytest.mark.parametrize("ratio", [0.1, 0.3, 0.5, 1.0, 3.0])
def test_spectrum_of_a_rectangular_pulse(ratio):
    """Undamped (Chopra, section 4.7): 2 sin(pi td/T) in the free vibration after it, at most 2."""
    period = 0.8
    spectrum = rectangular(ratio * period).spectrum([period], 0.0)
    factor = 2.0 if ratio >= 0.5 else 2 * np.sin(np.pi * ratio)
    assert spectrum.pseudo_acceleration[0] == pytest.approx(factor, rel=1e-4)
    assert spectrum.acceleration[0] == pytest.approx(factor, rel=1e-4)


@pytest.mark.parametrize("damping", [0.0, 0.05, 1.0])
def test_spectrum_against_an_integration_of_small_tolerance(damping):
    """Periods below, at and far above the step, damping up to that without vibration."""
    motion = motions.synthetic(1)[0]
    motion = GroundMotion(motion.acceleration[300:420], motion.dt)
    for period in (0.03, 0.4, 30.0):
        omega = 2 * np.pi / period
        peaks = np.zeros(3)
        state = np.zeros(2)
        # From point to point, as the slope of the acceleration jumps there; then free.
        ends = [*zip(motion.acceleration[:-1], motion.acceleration[1:], strict=True)]
        steps = [(motion.dt, a, b) for a, b in ends] + [(1.25 * period, 0.0, 0.0)]
        for length, a, b in steps:
            run = solve_ivp(
                lambda t, y, w=omega, a=a, b=b, h=length: [
                    y[1],
                    -(w**2) * y[0] - 2 * damping * w * y[1] - a - (b - a) * t / h,
                ],
                (0, length),
                state,
                method="DOP853",
                rtol=1e-10,
                atol=1e-13,
                dense_output=True,
            )
            x, v = run.sol(np.linspace(0, length, max(40, int(400 * length / period))))
            total = -(omega**2) * x - 2 * damping * omega * v
            peaks = np.maximum(peaks, [np.abs(values).max() for values in (x, v, total)])
            state = run.y[:, -1]
        spectrum = motion.spectrum([period], damping)
        found = [spectrum.displacement[0], spectrum.velocity[0], spectrum.acceleration[0]]
        assert found == pytest.approx(list(peaks), rel=1e-4)


def test_ends_of_a_spectrum():
    """A rigid oscillator has the ground's acceleration, a very soft one its displacement."""
    motion = motions.synthetic(1)[0]
    spectrum = motion.spectrum([0.0, 1e-3, 2000.0])
    assert spectrum.pseudo_acceleration[0] == spectrum.acceleration[0] == motion.pga
    assert spectrum.displacement[0] == spectrum.pseudo_velocity[0] == 0
    # Each bend of the straight lines sets the stiff one swinging, by its slope over the frequency.
    assert spectrum.acceleration[1] == pytest.approx(motion.pga, rel=5e-3)
    assert spectrum.displacement[2] == pytest.approx(abs(motion.displacement).max(), rel=0.02)


def test_spectrum_against_eqsig():
    """The same exact solution, whose peaks are taken at the points only, and up to the end."""
    eqsig = pytest.importorskip("eqsig", reason="eqsig is not installed (the extra test has it)")
    periods = np.array([0.3, 0.5, 1.0, 2.0, 4.0])
    for motion in motions.synthetic(4, dt=0.005):
        quiet = np.pad(motion.acceleration, (0, 2000))
        other = eqsig.AccSignal(quiet, motion.dt)
        other.generate_response_spectrum(response_times=periods, xi=0.05)
        spectrum = motion.spectrum(periods)
        # A sine whose points are dt apart is seen too small by up to (pi dt/T)^2/2; the peak of a
        # response that the ground has just bent is a little sharper than that.
        unseen = 1 + (np.pi * motion.dt / periods) ** 2
        for found, seen in (
            (spectrum.pseudo_acceleration, other.s_a),
            (spectrum.displacement, other.s_d),
        ):
            assert (found >= seen * (1 - 1e-6)).all()
            assert (found <= seen * unseen * (1 + 1e-5)).all()


def test_intensities_against_eqsig():
    """Arias there has g = 9.81; the duration is counted in whole steps."""
    eqsig = pytest.importorskip("eqsig", reason="eqsig is not installed (the extra test has it)")
    for motion in motions.synthetic(3):
        other = eqsig.AccSignal(motion.acceleration, motion.dt)
        arias = eqsig.im.calc_arias_intensity(other)[-1]
        assert motion.arias == pytest.approx(arias * 9.81 / G, rel=1e-12)
        assert motion.pga == pytest.approx(other.pga, rel=1e-12)
        assert motion.pgv == pytest.approx(other.pgv, rel=1e-9)
        duration = eqsig.im.calc_sig_dur_vals(motion.acceleration, motion.dt)
        assert motion.duration() == pytest.approx(duration, abs=3 * motion.dt)


def test_scaled_has_what_was_asked_for():
    motion = motions.synthetic(1)[0]
    assert motion.scaled(2.0).acceleration == pytest.approx(2 * motion.acceleration)
    assert motion.scaled(pga=3.0).pga == pytest.approx(3.0, rel=1e-14)
    assert motion.scaled(sa=(0.7, 4.0)).sa(0.7) == pytest.approx(4.0, rel=1e-12)
    assert motion.scaled(sa=(0.7, 4.0), damping=0.1).sa(0.7, 0.1) == pytest.approx(4.0, rel=1e-12)
    assert motion.scaled(-1.0).name == motion.name


def test_mean_spectral_acceleration_is_geometric():
    motion = motions.synthetic(1)[0]
    periods = [0.2, 0.4, 0.8]
    product = np.prod([motion.sa(period) for period in periods])
    assert motion.sa_avg(periods) == pytest.approx(product ** (1 / 3), rel=1e-12)


@pytest.mark.parametrize("degree", [0, 1, 3])
def test_baseline_of_a_polynomial_is_taken_off(degree):
    """A drift of the acceleration that the degree can show leaves nothing behind."""
    time = 0.01 * np.arange(2001)
    quake = np.sin(2 * np.pi * time) * np.sin(np.pi * time / 20) ** 2
    clean = motions.corrected(GroundMotion(quake, 0.01), degree)
    drift = sum(0.03 * (k + 1) * (time / 20) ** k for k in range(degree + 1))
    mended = motions.corrected(GroundMotion(quake + drift, 0.01), degree)
    # The velocity is found by trapezoids, whose error for the polynomial is 1e-6 of it.
    assert mended.acceleration == pytest.approx(clean.acceleration, abs=1e-5)


def test_finer_steps_are_the_same_motion():
    """Between the points it is linear anyway: equal response of an oscillator, bit for bit near."""
    motion = motions.synthetic(1)[0]
    finer = motions.resampled(motion, motion.dt / 4)
    assert finer.acceleration[::4] == pytest.approx(motion.acceleration, abs=1e-14)
    assert finer.sa(0.5) == pytest.approx(motion.sa(0.5), rel=1e-5)
    assert finer.length == pytest.approx(motion.length)


def test_longer_steps_keep_what_they_can_show():
    """A slow sine stays, a fast one that would turn up as a slow one is removed."""
    time = 0.005 * np.arange(8001)
    taper = np.sin(np.pi * time / time[-1]) ** 2
    slow, fast = taper * np.sin(2 * np.pi * time), taper * np.sin(2 * np.pi * 41 * time)
    coarse = motions.resampled(GroundMotion(slow + fast, 0.005), 0.025)
    assert coarse.acceleration == pytest.approx(slow[::5], abs=2e-3)


def test_sequence_joins_with_rest():
    one, two = motions.synthetic(2)
    both = motions.sequence([one, two], rest=3.0)
    assert both.name == "synthetic_01 + synthetic_02"
    m = one.acceleration.size
    assert np.array_equal(both.acceleration[:m], one.acceleration)
    assert not both.acceleration[m : m + 300].any()
    assert np.array_equal(both.acceleration[m + 300 :], two.acceleration)


def test_synthetic_motions_are_fixed_by_their_seed():
    many, few = motions.synthetic(5, seed=3), motions.synthetic(2, seed=3)
    assert many[:2] == few
    assert len({motion.pga for motion in many}) == 5
    assert motions.synthetic(1, seed=4)[0] != many[0]
    # The first draw of the legacy generator of numpy, which is fixed for good.
    draw = np.random.RandomState([3, 1]).standard_normal()
    assert many[0].pga == pytest.approx(0.3 * G * np.exp(0.35 * draw), rel=1e-12)


def test_synthetic_motions_are_earthquakes():
    """They come to rest; their spectra have the plateau of 2 to 3 PGA and fall beyond it."""
    found = motions.synthetic(20)
    amplified = []
    for motion in found:
        assert abs(motion.velocity[-1]) < 0.02 * motion.pgv
        assert 4 < motion.duration() < 40
        sa = motion.spectrum([0.1, 0.2, 0.4, 3.0]).pseudo_acceleration / motion.pga
        amplified.append(sa)
    median = np.median(amplified, axis=0)
    assert 1.5 < median[1:3].max() < 3.5
    assert median[3] < 0.4 * median[1:3].max()


@pytest.fixture(scope="module")
def column() -> rbsdem.Column:
    return rbsdem.Column(2.0, 1000.0, Elastic(4e5), Elastic(4e9), damping=0.05)


def test_time_history_takes_a_motion_in_place_of_arrays(column):
    motion = motions.synthetic(1)[0]
    by_motion = rbsdem.time_history(column, ground_acceleration=motion)
    by_arrays = rbsdem.time_history(column, motion.time, ground_acceleration=motion.acceleration)
    assert by_motion == by_arrays == rbsdem.time_history(column, motion)
    with pytest.raises(rbsdem.InputError, match="ground_acceleration is given too; give one"):
        rbsdem.time_history(column, motion, ground_acceleration=motion)


def test_a_column_that_is_an_oscillator_has_the_spectrum(column):
    """Shear spring under mass: the top moves as the oscillator of the spectrum, to its end."""
    motion = motions.synthetic(1)[0]
    moving = GroundMotion(np.pad(motion.acceleration, (0, 300)), motion.dt)
    period = 1 / rbsdem.modes(column).frequency[0]
    result = rbsdem.time_history(column, ground_acceleration=moving, method="rk45", tolerance=1e-9)
    # Rows stand at the points of the motion, so a peak between them is up to 5e-4 higher.
    peak = np.abs(result.displacement).max()
    assert motion.spectrum([period]).displacement[0] == pytest.approx(peak, rel=3e-3)


def test_of_two_motions_the_shorter_rests(column):
    motion = motions.synthetic(1)[0]
    short = GroundMotion(0.5 * motion.acceleration[:400], motion.dt)
    opens = replace(column, axial_spring=Elastic(1e9))
    result = rbsdem.time_history(opens, ground_acceleration=motion, vertical_acceleration=short)
    assert result.call["vertical_acceleration"].size == motion.acceleration.size
    assert not result.call["vertical_acceleration"][400:].any()


def test_trade_takes_a_motion(column):
    motion = motions.synthetic(1)[0]
    short = GroundMotion(motion.acceleration[:200], motion.dt)
    found = rbsdem.compare_methods(
        column, ground_acceleration=short, methods=["newmark"], digits=2, repeats=1
    )
    assert found.rows


def test_a_motion_is_a_record():
    motion = motions.synthetic(1)[0]
    assert pickle.loads(pickle.dumps(motion)) == copy.deepcopy(motion) == motion
    assert hash(copy.deepcopy(motion)) == hash(motion)
    assert motion != motion.scaled(2.0)
    assert repr(motion).startswith("GroundMotion('synthetic_01', ")
    with pytest.raises(ValueError, match="read-only"):
        motion.acceleration[0] = 1.0
    with pytest.raises(AttributeError):
        motion.dt = 1.0  # type: ignore[misc]


def test_figures_of_motion_and_spectrum():
    pytest.importorskip("matplotlib")
    motion = motions.synthetic(1)[0]
    assert rbsdem.plot.motion(motion).get_lines()
    ax = rbsdem.plot.spectrum(motion.spectrum(), label="mine")
    rbsdem.plot.spectrum(motion.scaled(2.0).spectrum(), ax=ax, color="red")
    assert ax.get_lines()[0].get_label() == "mine"
    assert ax.get_lines()[1].get_color() == "red"
