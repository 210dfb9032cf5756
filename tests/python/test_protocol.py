"""Protocols: cycles 0, +a, 0, -a, 0 in equal parts, and those of the literature."""

from __future__ import annotations

import numpy as np
import pytest

import rbsdem


@pytest.mark.parametrize(
    ("given", "path"),
    [
        ({"amplitudes": [4.0], "points": 2}, [0, 2, 4, 2, 0, -2, -4, -2, 0]),
        (
            {"amplitudes": [1.0, 2.0], "cycles": 2},
            [0, 1, 0, -1, 0, 1, 0, -1, 0, 2, 0, -2, 0, 2, 0, -2, 0],
        ),
        ({"amplitudes": [1.0, 2.0], "cycles": [1, 2]}, [0, 1, 0, -1, 0, 2, 0, -2, 0, 2, 0, -2, 0]),
        (
            {"amplitudes": [1.0, 2.0], "repeats": 2},
            [0, 1, 0, -1, 0, 2, 0, -2, 0, 1, 0, -1, 0, 2, 0, -2, 0],
        ),
        (
            {"amplitudes": [1.0, 2.0], "negative_amplitudes": [0.5, 0.0]},
            [0, 1, 0, -0.5, 0, 2, 0, 0, 0],
        ),
    ],
)
def test_cycles(given, path):
    assert rbsdem.protocol(**{"points": 1} | given).tolist() == path


def test_corners_are_exact_for_any_number_of_points():
    a = 0.0123
    for points in range(1, 61):
        path = rbsdem.protocol([a], points=points)
        assert path.size == 4 * points + 1
        assert path[::points].tolist() == [0, a, 0, -a, 0]


def peaks(name: str, **given: float) -> np.ndarray:
    """Return the amplitudes of a protocol, cycle by cycle."""
    return rbsdem.protocol(name, points=1, **given)[1::4]


def test_protocols_of_the_literature_have_their_steps_and_cycles():
    """The numbers are those of docs/input.md, "Named protocols"."""
    drifts = [0.00375, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04]
    assert peaks("sac") == pytest.approx(np.repeat(drifts, [6, 6, 6, 4, 2, 2, 2, 2]), rel=1e-15)
    # Each step 1.4 times the last, ten of them up to the reference.
    steps = peaks("fema_461", reference=0.05, largest=0.07)[::2]
    assert steps[1:10] / steps[:9] == pytest.approx(np.full(9, 1.4), rel=1e-14)
    assert steps[9:] == pytest.approx([0.05, 0.065], rel=1e-14)
    # A step of one cycle is followed by trailing ones at three quarters.
    cycles = np.repeat([0.1, 0.15, 0.1125, 0.2, 0.15], [6, 1, 6, 1, 6])
    assert peaks("curee", reference=2.0, largest=0.2) == pytest.approx(cycles, rel=1e-15)
    assert np.unique(peaks("aci_374_1", largest=0.035)).size == 10
    for name, given, told in (
        ("atc_24", {"reference": 0.01}, "largest"),
        ("fema_461", {}, "reference"),
        ("aci_374_1", {"largest": 0.05}, "ends at"),
    ):
        with pytest.raises(rbsdem.InputError, match=told):
            rbsdem.protocol(name, **given)
