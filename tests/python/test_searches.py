"""Short runs of the random searches of studies/, and the cases that they have found.

`static_search`: finite static paths that ended where the column could go on. `dynamic_search`:
motions whose answers by different methods are not one. `interaction_search`: static paths under an
axial load that varies which depend on increments or lose energy. The long runs are those of the
studies.
"""

from __future__ import annotations

import importlib
import sys
from pathlib import Path

import pytest

STUDIES = Path(__file__).resolve().parents[2] / "studies"


NAMES = ("static_search", "dynamic_search", "interaction_search")


@pytest.fixture(scope="module")
def studies():
    """The modules of the searches, which import each other from their own folder."""
    before = sys.path[:]
    sys.path.insert(0, str(STUDIES))
    yield {name: importlib.import_module(name) for name in NAMES}
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


def test_methods_in_time_agree(studies):
    kinds = [studies["dynamic_search"].judge((11, i))[0] for i in range(20)]
    assert {"one answer", "sensitive", "ends"} >= set(kinds), kinds
    assert kinds.count("one answer") > 15


def test_paths_under_a_varying_axial_load_do_not_depend_on_increments(studies):
    kinds = [studies["interaction_search"].judge((11, i))[0] for i in range(60)]
    assert {"completed", "axial_failure"} >= set(kinds), kinds
    assert kinds.count("completed") > 50
