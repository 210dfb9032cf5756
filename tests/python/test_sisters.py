"""Predictions that know other tests of the laboratory: the Bayes step, and what it leaves."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from samples import SECTION, write_history, write_table

import rbsdem
from rbsdem import peer
from rbsdem.errors import InputError
from rbsdem.run.bands import distance, features_of, path_force, scatter_of_tests
from rbsdem.run.protocol import protocol
from rbsdem.run.rig import friction
from rbsdem.run.sisters import Loop, Told, learn, told

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
PATH = 1.6 * protocol([0.005, 0.015, 0.03], cycles=1)
COLUMN = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)
FORCE = path_force(COLUMN, PATH, rig=True)


def says(force: np.ndarray) -> Told:
    return told(Loop(COLUMN, PATH, force))


def test_a_test_that_the_model_follows_moves_nothing() -> None:
    found = learn(COLUMN, PATH, [says(FORCE)])
    np.testing.assert_allclose(found.force(PATH), FORCE, rtol=1e-9)
    assert found.strength == 1.0
    assert 0.0 < found.left < 1.0


def test_what_the_rig_adds_is_found() -> None:
    """The loop is; of its causes friction, as strength may stand for second-order force."""
    rig = 0.05 * friction(PATH, 1.6) * np.abs(FORCE).max() + 0.3 * 1.2e6 / 1.6 * PATH
    found = learn(COLUMN, PATH, [says(FORCE + rig)] * 3)
    assert found.friction == pytest.approx(0.05, rel=0.2)
    assert found.second_order > 0.1
    error = found.force(PATH) - FORCE - rig
    assert np.sqrt(np.mean(error**2)) < 0.2 * np.sqrt(np.mean(rig**2))


def test_one_number_in_closed_form() -> None:
    """Of a strength alone, known to the error e: s^2 c/(s^2 + e^2) of what a test is off."""
    size, error, x = math.hypot(*scatter_of_tests().strength), 0.05, 0.1
    information, pull = np.zeros((15, 15)), np.zeros(15)
    information[0, 0], pull[0] = error**-2, x * error**-2
    own = features_of(SECTION, 1.6, 1.2e6)
    for apart in (0.0, 1.0, 30.0):
        features = (own[0] + 0.15 * apart, *own[1:])
        assert distance(own, features) == pytest.approx(apart)
        shared = 0.5 + 0.5 * math.exp(-apart)
        found = learn(COLUMN, PATH, [Told(features, information, pull)])
        share = size**2 * shared / (size**2 + error**2)
        assert math.log(found.strength) == pytest.approx(x * share, rel=1e-9)
    # Two tests that are one count once, but for their errors.
    found = learn(COLUMN, PATH, [Told(own, information, pull)] * 2)
    share = size**2 / (size**2 + error**2 / 2)
    assert math.log(found.strength) == pytest.approx(x * share, rel=1e-9)


def test_the_band_moves_and_narrows() -> None:
    learned = learn(COLUMN, PATH, [says(1.1 * FORCE)] * 3)
    before = peer.band(COLUMN, PATH, samples=8, rig=True)
    after = peer.band(COLUMN, PATH, samples=8, learned=learned)
    np.testing.assert_allclose(after.force, learned.force(PATH))
    assert after.width < before.width
    assert after.peak_force.value > before.peak_force.value
    peaks, works = (
        [interval.upper / interval.lower for interval in pair]
        for pair in ((before.peak_force, after.peak_force), (before.energy, after.energy))
    )
    assert peaks[1] == pytest.approx(peaks[0], rel=1e-9)
    assert works[1] < works[0]


def test_predictions_with_given_tests(tmp_path) -> None:
    (known,) = write_table(tmp_path, [{"file": "a.csv"}])
    path = known.length * protocol([0.005, 0.01, 0.02], cycles=1)
    force = 1.15 * peer.predict(known, displacement=path).force
    write_history(tmp_path / "a.csv", path, force)
    new = replace(known, name="a sister", concrete_strength=1.1 * known.concrete_strength)
    alone = peer.predict(new)
    both = peer.predict([new, known], given=[known])
    assert both[0].model == f"{alone.model}, 1 test given"
    assert both[0].comparison != alone.comparison
    # What is predicted is not given for itself.
    assert both[1].model == alone.model
    with pytest.raises(InputError, match="given: tests move predictions of 'layered' alone"):
        peer.predict(new, "paper", given=[known])
    with pytest.raises(InputError, match="leave out given"):
        peer.predict(new, given=[known], limit_states=True)
    with pytest.raises(InputError, match="given: a sister"):
        peer.predict(known, given=[replace(new, file="no.csv")])
