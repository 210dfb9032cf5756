"""Bands of a prediction: their samples, their width, and what is said of columns far from tests."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import SECTION

import rbsdem
from rbsdem import Concrete, Layout, Steel
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.run.bands import (
    Interval,
    Scatter,
    _degraded,
    _normal_points,
    near_shear,
    path_force,
)
from rbsdem.run.protocol import protocol
from rbsdem.section.parameters import parameters

PATH = 1.6 * protocol([0.005, 0.01, 0.02], cycles=2)
NONE = Scatter(
    strength=(0.0, 0.0),
    stiffness=(0.0, 0.0),
    degradation=(0.0, 0.0),
    shape=0.05,
    force=(2.0, 3.0, 4.0),
    peak=((0.9, 1.2), (0.8, 1.4), (0.8, 1.6)),
    energy=((0.5, 1.5), (0.4, 2.0), (0.4, 3.0)),
    drift=((0.7, 1.4), (0.6, 1.8), (0.6, 2.0)),
)


def column(**changes: float):
    return rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6).with_parameters(**changes)


def test_without_scatter_the_band_is_that_of_the_shape() -> None:
    found = rbsdem.peer.band(column(), PATH, scatter=NONE)
    peak = np.max(np.abs(found.force))
    np.testing.assert_allclose(found.upper - found.force, 2 * 0.05 * peak, rtol=1e-9)
    np.testing.assert_allclose(found.force - found.lower, 2 * 0.05 * peak, rtol=1e-9)
    np.testing.assert_allclose(found.samples, np.tile(found.force, (16, 1)), rtol=1e-12)
    assert found.width == pytest.approx(0.2)


def test_scatter_of_strength_is_a_factor() -> None:
    found = rbsdem.peer.band(column(), PATH, scatter=replace(NONE, strength=(0.06, 0.08)))
    factors = np.exp(0.1 * _normal_points(16)[:, 0])
    np.testing.assert_allclose(found.samples, np.outer(factors, found.force), rtol=1e-12)
    at = int(np.argmax(found.force))
    top, peak = found.force[at], np.max(np.abs(found.force))
    rise = (np.quantile(factors, 0.9) - 1) * top + 0.05 * peak
    assert found.upper[at] - top == pytest.approx(2 * rise)


def test_samples_are_as_if_each_went_through_the_model() -> None:
    """A softer column is where the other is at a smaller displacement; nine paths say it of all."""
    scatter = replace(NONE, stiffness=(0.0, 0.3), degradation=(0.3, 0.0))
    for model in (column(), column(shear_strength=0.6 * parameters().shear_strength)):
        found = rbsdem.peer.band(model, PATH, scatter=scatter)
        paths = [
            path_force(_degraded(model, math.exp(0.3 * worse)), PATH * math.exp(0.3 * stiffer))
            for _, stiffer, worse in _normal_points(16).tolist()
        ]
        ends, known = (np.quantile(rows, (0.1, 0.9), axis=0) for rows in (found.samples, paths))
        width = np.mean(known[1] - known[0])
        assert np.mean(ends[1] - ends[0]) == pytest.approx(width, rel=0.03)
        assert np.mean(np.abs(ends - known)) < 0.04 * width


def test_degradation_changes_late_cycles_only() -> None:
    found = rbsdem.peer.band(column(), PATH, scatter=replace(NONE, degradation=(0.7, 0.0)))
    range_of = np.ptp(found.samples, axis=0) / np.max(np.abs(found.force))
    assert range_of[: PATH.size // 6].max() < 0.02 < range_of[PATH.size // 2 :].max()


def test_an_energy_near_zero_has_a_width() -> None:
    """A loop that gives back nearly all that it took: 0.5 and 1.5 times 0.15 of what F moved."""
    push = np.append(np.linspace(0.0, 0.003, 20), np.linspace(0.003, 0.0, 400))
    found = rbsdem.peer.band(column(), push, scatter=NONE)
    moved = np.abs(np.diff(push)) @ np.abs(0.5 * (found.force[1:] + found.force[:-1]))
    energy = found.energy
    assert abs(energy.value) < 0.15 * moved
    assert energy.value - energy.lower == pytest.approx(0.5 * 0.15 * moved)
    assert energy.upper - energy.value == pytest.approx(0.5 * 0.15 * moved)


def test_double_curvature_has_the_band_of_its_half() -> None:
    """Twice the displacement and the work at the same force; its two hinges are alike."""
    half = rbsdem.section.column(SECTION, 1.5, axial_load=700e3)
    whole = rbsdem.section.column(SECTION, 3.0, axial_load=700e3, top="fixed")
    path = protocol([0.005, 0.02], points=4)
    one = rbsdem.peer.band(half, 1.5 * path, samples=8)
    two = rbsdem.peer.band(whole, 3.0 * path, samples=8)
    for name in ("lower", "force", "upper"):
        np.testing.assert_allclose(getattr(two, name), getattr(one, name), rtol=1e-6, atol=1.0)
    assert two.energy.upper == pytest.approx(2 * one.energy.upper, rel=1e-6)
    assert two.drift_at_loss.lower == pytest.approx(one.drift_at_loss.lower, rel=1e-6)


def test_intervals() -> None:
    found = rbsdem.peer.band(column(), PATH, scatter=NONE)
    assert found.peak_force.value == np.max(np.abs(found.force))
    assert found.peak_force.upper == pytest.approx(1.2 * found.peak_force.value)
    assert found.energy.lower == pytest.approx(0.5 * found.energy.value)
    # No strength is lost at this drift: that it comes later is all that is said.
    assert math.isnan(found.drift_at_loss.value)
    assert found.drift_at_loss.lower == pytest.approx(0.7 * 0.02)
    assert found.drift_at_loss.upper == math.inf
    assert str(found.drift_at_loss) == "above 0.014"
    assert str(found.peak_force).startswith(f"{found.peak_force.value:.4g} (")


def test_outside_the_range_of_the_tests_it_says_so() -> None:
    assert column().warnings == ()
    section = replace(
        SECTION,
        concrete=Concrete(140e6),
        layout=Layout(8, 0.01, Steel(700e6, 900e6)),
        ties=replace(SECTION.ties, spacing=0.3),
    )
    with pytest.warns(AccuracyWarning, match="is outside") as caught:
        far = rbsdem.section.column(section, 4.0, axial_load=-1e5)
    names = [
        "axial load ratio",
        "concrete strength",
        "yield stress of the bars",
        "reinforcement ratio",
        "shear span over depth",
        "tie spacing over bar diameter",
    ]
    assert [text.split(" =")[0] for text in far.warnings] == names
    said = str(caught[0].message)
    assert said.startswith("axial_load = -100000 N is tension; compression is positive")
    assert said.endswith("; ".join(far.warnings))
    with pytest.warns(AccuracyWarning, match="concrete strength = 140 MPa is outside"):
        found = rbsdem.peer.band(far, PATH[:3], scatter=NONE)
    assert found.warnings == far.warnings
    with pytest.warns(AccuracyWarning, match="is outside"):
        wide = rbsdem.peer.band(far, PATH[:3], scatter=replace(NONE, outside=(1.5, 2.0, 3.0, 4.0)))
    np.testing.assert_allclose(wide.upper - wide.force, 1.5 * (found.upper - found.force))
    np.testing.assert_allclose(wide.force - wide.lower, 1.5 * (found.force - found.lower))
    # From 0.9 and 1.2, 0.5 and 1.5, 0.7; this path loses no strength.
    assert wide.peak_force.lower == pytest.approx(0.9**2 * found.peak_force.value)
    assert wide.peak_force.upper == pytest.approx(1.2**2 * found.peak_force.value)
    rise = (wide.energy.upper - wide.energy.value) / (found.energy.upper - found.energy.value)
    assert rise == pytest.approx((1.5**3 - 1) / 0.5)
    assert wide.drift_at_loss.lower == pytest.approx(0.7**3 * found.drift_at_loss.lower)
    both = {"outside": (9.0,) * 4, "small": (1.75,) * 4}
    inside = rbsdem.peer.band(column(), PATH[:3], scatter=replace(NONE, **both))
    assert inside.width == pytest.approx(0.2)
    # A column of a depth below that of the tests has a factor of its own.
    half = replace(SECTION, width=0.19, depth=0.19)
    with pytest.warns(AccuracyWarning, match=r"depth = 0\.19 m is outside"):
        model = rbsdem.section.column(half, 0.8, axial_load=2e5)
    with pytest.warns(AccuracyWarning, match=r"depth = 0\.19 m is outside"):
        small = rbsdem.peer.band(model, PATH[:3], scatter=replace(NONE, **both))
    assert small.width == pytest.approx(1.75 * 0.2)
    with pytest.warns(AccuracyWarning, match="there are no ties"):
        rbsdem.section.column(replace(SECTION, ties=None, layout=None), 1.6, axial_load=1.2e6)


def test_the_parameters_have_bands() -> None:
    found = rbsdem.peer.band(column(), PATH)
    assert np.all(found.lower < found.force)
    assert np.all(found.force < found.upper)
    assert 0.1 < found.width < 0.6


def test_near_the_shear_strength_the_band_is_wider() -> None:
    """Halfway from 0.7 to 0.95 of it the widening is halfway between its two numbers."""
    peak = np.max(np.abs(rbsdem.peer.band(column(), PATH, scatter=NONE).force))
    strength = column().shear[0].f_y
    assert near_shear(column(), 0.7 * strength) == pytest.approx(0.0)
    assert near_shear(column(), 0.825 * strength) == pytest.approx(0.5)
    assert near_shear(column(), 2.0 * strength) == 1.0
    weak = column(shear_strength=parameters().shear_strength * peak / strength / 0.825)
    found = rbsdem.peer.band(weak, PATH, scatter=NONE)
    share = near_shear(weak, np.max(np.abs(found.force)))
    assert 0.3 < share < 0.6
    assert found.width == pytest.approx(2 * 0.05 * (2 + 2 * share))
    assert found.peak_force.upper == pytest.approx((1.2 + 0.4 * share) * found.peak_force.value)


def test_what_a_band_holds() -> None:
    found = rbsdem.peer.band(column(), PATH, scatter=NONE)
    assert found.holds(found.force) == 1.0
    assert found.holds(found.upper + 1.0) == 0.0
    # Far off along the second half of the path.
    path = np.concatenate(([0.0], np.cumsum(np.abs(np.diff(PATH)))))
    force = np.where(path <= 0.5 * path[-1], found.force, 10 * found.upper + 1e6)
    assert found.holds(force) == pytest.approx(0.5, abs=0.05)
    with pytest.raises(InputError, match="the test has 2 rows"):
        found.holds([0.0, 1.0])
    assert Interval(1.0, 2.0, 3.0).holds(3.0)
    assert not Interval(1.0, 2.0, 3.0).holds(math.nan)
    assert Interval(1.0, math.nan, math.inf).holds(math.nan)
