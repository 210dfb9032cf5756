"""The jobs of docs/opensees.md: the answers of rbsdem against those of OpenSees, which are stored.

``python studies/opensees_jobs.py --write`` stores them.
"""

import importlib
import json
import sys
from pathlib import Path

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parents[2] / "studies" / "opensees"


@pytest.fixture(scope="module")
def theirs():
    stored = json.loads((FOLDER / "answers.json").read_text(encoding="utf-8"))
    return {
        job: {name: np.array(value, dtype=float) for name, value in answers.items()}
        for job, answers in stored.items()
    }


@pytest.fixture
def job(monkeypatch):
    monkeypatch.syspath_prepend(str(FOLDER))
    yield importlib.import_module
    for name in list(sys.modules):
        if name == "given" or name.endswith("_rbsdem"):
            del sys.modules[name]


def gap(ours, other):
    """Largest difference over the largest value."""
    return np.max(np.abs(ours - other)) / np.max(np.abs(other))


@pytest.mark.parametrize(
    ("name", "within"),
    [
        # 40 bodies against 40 beams.
        ("frequencies", 1.5e-3),
        # Concrete that bending relieves unloads in OpenSees.
        ("section", 6e-3),
    ],
)
def test_single_answers(job, theirs, name, within):
    for answer, ours in job(f"{name}_rbsdem").solve().items():
        assert gap(ours, theirs[name][answer]) < within, answer


def test_earthquake(job, theirs):
    """The same equations, the same step."""
    ours = job("earthquake_rbsdem").solve(job("given").motion())
    for answer, value in ours.items():
        assert gap(value, theirs["earthquake"][answer]) < 1e-5, answer


def test_incremental_dynamic_analysis(job, theirs):
    """All fates are equal; the two rules close inner loops in other ways, which few drifts show."""
    given = job("given")
    ours = job("ida_rbsdem").solve(given.records(), given.LEVELS)["drift"]
    other = theirs["ida"]["drift"]
    fallen = np.isnan(other)
    assert np.array_equal(np.isinf(ours), fallen)
    assert np.median(np.abs(ours[~fallen] / other[~fallen] - 1)) < 1e-4
