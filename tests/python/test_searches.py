"""Short runs of the random searches of studies/, and the cases that they have found.

`static_search` looks for static paths with exact rotations that end where the column could go on:
neighbours of a path come farther. `balance_search` looks for rows of static paths that are no state
of the column. What must not change an answer otherwise is in `test_invariants.py`.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

STUDIES = Path(__file__).resolve().parents[2] / "studies"


@pytest.fixture(scope="module")
def studies():
    """The modules of the searches, which import each other from their own folder."""
    before = sys.path[:]
    sys.path.insert(0, str(STUDIES))
    yield {name: importlib.import_module(name) for name in ("static_search", "balance_search")}
    sys.path[:] = before


#: Paths at which the search for a finite path once failed: ends of lines met within the last digits
#: of a target, reversals of 1e-11 of the way, springs put on an end out of equilibrium.
FOUND = [(1, 684), (1, 1265), (1, 2234), (1, 4786), (1, 5950), (1, 14634), (2, 236), (2, 31627)]


@pytest.mark.parametrize("seed", FOUND)
def test_paths_that_once_ended(studies, seed):
    assert studies["static_search"].judge(seed)[0] == "complete"


def test_no_static_path_ends_wrongly(studies):
    kinds = [studies["static_search"].judge((11, i))[0] for i in range(300)]
    assert {"complete", "end"} >= set(kinds), kinds
    assert kinds.count("complete") > 280


def test_every_row_of_a_static_path_is_a_state_of_the_column(studies):
    kinds = [studies["balance_search"].judge((11, i))[0] for i in range(850)]
    assert {"completed", "error", "axial_failure", "no column"} >= set(kinds)
    assert kinds.count("completed") > 700
