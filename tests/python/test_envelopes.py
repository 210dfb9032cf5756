"""Envelopes and their idealisation, by closed forms and by the worked numbers of the sources."""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem
from rbsdem import InputError
from rbsdem.curves import Envelope

# A worked envelope: (0, 0) (5, 100) (10, 160) (20, 200) (40, 210) (60, 190), mm and kN.
WORKED = Envelope(
    1,
    np.array([0.0, 5.0, 10.0, 20.0, 40.0, 60.0]) * 1e-3,
    np.array([0.0, 100.0, 160.0, 200.0, 210.0, 190.0]) * 1e3,
)
COLUMN = rbsdem.peer.paper_columns()["zahn_7"]


# The numbers are worked by hand from the definitions: areas 6800 and 10800 N m.
@pytest.mark.parametrize(
    ("method", "force", "displacement"),
    [
        ("asce_41", 179.259, 9.3827),
        ("ec_8", 210.0, 15.2381),
        ("park", 210.0, 13.0556),
        ("equal_energy", 196.008, 9.8004),
    ],
)
def test_worked_numbers(method, force, displacement):
    lines = WORKED.idealise(method)
    assert lines.yield_force == pytest.approx(force * 1e3, rel=5e-6)
    assert lines.yield_displacement == pytest.approx(displacement * 1e-3, rel=1e-5)
    assert lines.ductility == pytest.approx(0.06 / lines.yield_displacement)
    assert not lines.lost


@pytest.mark.parametrize("method", ["asce_41", "ec_8", "equal_energy"])
def test_areas_are_equal(method):
    lines = WORKED.idealise(method)
    x = np.linspace(0.0, lines.end_displacement, 200_001)
    one = np.trapezoid(lines.force(x), x)
    other = np.trapezoid(np.interp(x, WORKED.displacement, WORKED.force), x)
    assert one == pytest.approx(other, rel=1e-8)


@pytest.mark.parametrize("method", ["asce_41", "ec_8", "equal_energy"])
def test_two_straight_lines_are_found_again(method):
    """An elastic and perfectly plastic envelope is its own idealisation."""
    own = Envelope(1, np.array([0.0, 0.01, 0.05]), np.array([0.0, 2e5, 2e5]))
    lines = own.idealise(method, **({} if method == "equal_energy" else {"end": 0.05}))
    assert lines.yield_displacement == pytest.approx(0.01, rel=1e-9)
    assert lines.yield_force == pytest.approx(2e5, rel=1e-9)
    assert lines.ductility == pytest.approx(5.0, rel=1e-9)


def test_hardening_lines_are_found_again_by_asce_41():
    own = Envelope(1, np.array([0.0, 0.01, 0.05]), np.array([0.0, 2e5, 3e5]))
    lines = own.idealise("asce_41")
    assert (lines.yield_displacement, lines.yield_force) == pytest.approx((0.01, 2e5), rel=1e-9)
    assert lines.post_yield_ratio == pytest.approx(0.125)


def test_asce_41_finds_the_highest_balanced_lines_or_says_that_there_are_none():
    """300 concave envelopes, against a search over 4000 yield forces."""
    random = np.random.default_rng(1)
    refused = 0
    for _ in range(300):
        n = random.integers(2, 9)
        slope = np.sort(random.exponential(1.0, n))[::-1]
        step = random.exponential(1.0, n)
        x, y = (np.append(0.0, np.cumsum(part)) for part in (step, slope * step))
        top = y[-1] * np.linspace(1.0, 2.5e-4, 4000)
        at = np.interp(0.6 * top, y, x) / 0.6
        # Triangle and trapezium of the lines less the area below the envelope.
        over = 0.5 * (top * at + (top + y[-1]) * (x[-1] - at)) - np.trapezoid(y, x)
        turned = (over[1:] * over[:-1] < 0) & (at[1:] <= x[-1])
        try:
            lines = Envelope(1, x, y).idealise("asce_41")
        except InputError:
            assert not turned.any()
            refused += 1
            continue
        own = 0.5 * (lines.yield_force * x[-1] + y[-1] * (x[-1] - lines.yield_displacement))
        assert own == pytest.approx(np.trapezoid(y, x), rel=1e-9)
        on = np.interp(0.6 * lines.yield_displacement, x, y)
        assert on == pytest.approx(0.6 * lines.yield_force, rel=1e-9)
        assert lines.yield_force <= y[-1] * (1 + 1e-9)
        if turned.any():
            assert lines.yield_force >= top[1:][turned].max()
    assert 0 < refused < 15


def test_steps_of_an_envelope_have_no_width():
    """The force falls by a tenth from one cycle to the next, at 30 mm: area 1 + 4 + 4 kN m.

    On the elastic part (v = 2e7 u): 0.05 v - 2.2e5 u = 0.6 (18000 - 11000) N m. Up to the step the
    force is that before it.
    """
    x, y = np.array([[0, 0], [10, 200], [30, 200], [30, 180], [50, 220]]).T
    own = Envelope(1, 1e-3 * x, 1e3 * y)
    lines = own.idealise("asce_41")
    u = 4200 / (0.05 * 2e7 - 2.2e5)
    assert lines.yield_displacement == pytest.approx(u / 0.6, rel=1e-9)
    assert lines.yield_force == pytest.approx(2e7 * u / 0.6, rel=1e-9)
    step = own.idealise("ec_8", end=0.03)
    assert (step.yield_displacement, step.yield_force) == pytest.approx((0.01, 2e5))


def test_elastic_envelope_is_one_line():
    lines = Envelope(1, np.array([0.0, 0.02]), np.array([0.0, 1e5])).idealise()
    assert (lines.yield_displacement, lines.yield_force) == pytest.approx((0.02, 1e5))
    assert (lines.post_yield_ratio, lines.ductility) == (0.0, 1.0)


def test_loss_of_strength_ends_it():
    falling = Envelope(1, np.array([0.0, 0.01, 0.03]), np.array([0.0, 1e5, 5e4]))
    lines = falling.idealise("park")
    assert lines.lost
    # 80 % of the peak lies at 0.4 of the way down.
    assert lines.ultimate_displacement == pytest.approx(0.018)
    assert falling.displacement_at(0.8, falling=True) == pytest.approx(0.018)
    assert falling.displacement_at(0.5) == pytest.approx(0.005)
    assert np.isnan(falling.displacement_at(0.4, falling=True))


def test_envelope_of_a_cyclic_path_lies_on_the_push():
    """A Takeda column without P-Delta comes back to its backbone in every larger cycle."""
    path = COLUMN.height * rbsdem.protocol([0.002, 0.005, 0.01, 0.02], points=20)
    cyclic = rbsdem.cyclic(COLUMN, displacement=path)
    push = rbsdem.cyclic(COLUMN, displacement=[0.02 * COLUMN.height]).path
    for side in (1, -1):
        found = cyclic.envelope(side)
        assert np.all(np.diff(found.displacement) >= 0)
        assert found.largest_displacement == pytest.approx(0.02 * COLUMN.height)
        tips = np.array([0.002, 0.005, 0.01, 0.02]) * COLUMN.height
        for tip in tips:
            on_push = np.interp(tip, push.displacement, push.force)
            # When it is first there; the next cycle comes by with a little more or less.
            first = np.argmax(found.displacement >= tip * (1 - 1e-12))
            assert found.force[first] == pytest.approx(on_push, rel=1e-9)


def test_result_speaks_by_the_definitions_of_the_comparison():
    path = COLUMN.height * rbsdem.protocol([0.01, 0.02], points=10)
    result = rbsdem.cyclic(COLUMN, displacement=path)
    path = result.path
    cycles = rbsdem.curves.half_cycles(path.displacement, path.force)
    assert result.half_cycles().energy == pytest.approx(cycles.energy)
    assert np.isnan(result.strength_loss())
    assert result.idealise("park", -1) == result.envelope(-1).idealise("park")
