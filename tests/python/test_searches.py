"""A short run of the random search of studies/, and the cases that it has found.

`static_search` looks for static paths with exact rotations that end where the column could go on:
neighbours of a path come farther.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

STUDIES = Path(__file__).resolve().parents[2] / "studies"


@pytest.fixture(scope="module")
def judge():
    """The judge of one path."""
    sys.path.insert(0, str(STUDIES))
    yield importlib.import_module("static_search").judge
    sys.path.remove(str(STUDIES))


#: Paths at which the search for a finite path once failed: ends of lines met within the last digits
#: of a target, reversals of 1e-11 of the way, springs put on an end out of equilibrium.
FOUND = [(1, 684), (1, 1265), (1, 2234), (1, 4786), (1, 5950), (1, 14634), (2, 236), (2, 31627)]


@pytest.mark.parametrize("seed", FOUND)
def test_paths_that_once_ended(judge, seed):
    assert judge(seed)[0] == "complete"


def test_no_static_path_ends_wrongly(judge):
    kinds = [judge((11, i))[0] for i in range(300)]
    assert {"complete", "end"} >= set(kinds), kinds
    assert kinds.count("complete") > 280
