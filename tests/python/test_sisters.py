"""Predictions that know other tests of the laboratory: the Bayes step, and what it leaves."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from samples import SECTION, write_history, write_table

import rbsdem
from rbsdem import peer
from rbsdem.errors import InputError
from rbsdem.run.bands import Scatter, factored_force, scatter_of_tests
from rbsdem.run.protocol import protocol
from rbsdem.run.sisters import Loop, learn

pytestmark = pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
PATH = 1.6 * protocol([0.005, 0.01, 0.02, 0.03], cycles=2)
COLUMN = rbsdem.section.column(SECTION, 1.6, axial_load=1.2e6)


def loop(*logs: float) -> Loop:
    return Loop(COLUMN, PATH, factored_force(COLUMN, PATH, np.array(logs)))


def test_a_test_that_the_model_follows_moves_nothing() -> None:
    found = learn([loop(0.0, 0.0, 0.0)], scatter_of_tests())
    np.testing.assert_allclose(found.logs, 0.0, atol=1e-12)
    between = [scatter_of_tests().strength[0], scatter_of_tests().stiffness[0]]
    assert (found.left[:2] < between).all()


def test_a_laboratory_is_believed_by_the_share_of_its_scatter() -> None:
    """Of k tests that all are stronger by x: x k t^2/(k t^2 + s^2), as loops are all but exact."""
    scatter = replace(scatter_of_tests(), strength=(0.08, 0.06), stiffness=(1e-6,) * 2)
    scatter = replace(scatter, degradation=(1e-6,) * 2)
    for number in (1, 3):
        found = learn([loop(0.1, 0.0, 0.0)] * number, scatter)
        share = number * 0.08**2 / (number * 0.08**2 + 0.06**2 + 0.02**2 / 0.5)
        assert found.logs[0] == pytest.approx(0.1 * share, rel=0.1)
        left = (0.08**-2 + number / (0.06**2 + 0.02**2 / 0.5)) ** -0.5
        assert found.left[0] == pytest.approx(left, rel=0.1)


def test_without_scatter_nothing_is_learned() -> None:
    none = Scatter(
        strength=(0.0, 0.1), stiffness=(0.0, 0.1), degradation=(0.0, 0.1), shape=0.05,
        force=(1.0,) * 3, peak=((0.9, 1.1),) * 3, energy=((0.9, 1.1),) * 3,
        drift=((0.9, 1.1),) * 3,
    )  # fmt: skip
    np.testing.assert_allclose(learn([loop(0.1, 0.2, 0.3)], none).logs, 0.0, atol=1e-9)


def test_the_band_moves_and_narrows() -> None:
    learned = learn([loop(0.1, 0.0, 0.0)] * 3, scatter_of_tests())
    before, after = peer.band(COLUMN, PATH), peer.band(COLUMN, PATH, learned=learned)
    np.testing.assert_allclose(after.force, factored_force(COLUMN, PATH, learned.logs))
    assert after.width < before.width
    assert after.peak_force.value > before.peak_force.value
    ends = [(band.peak_force.upper / band.peak_force.lower) for band in (before, after)]
    assert ends[1] < ends[0]


def test_predictions_with_given_tests(tmp_path) -> None:
    (known,) = write_table(tmp_path, [{"file": "a.csv"}])
    path = known.length * protocol([0.005, 0.01, 0.02], cycles=1)
    force = 1.15 * rbsdem.cyclic(peer.column(known), displacement=path).force
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
