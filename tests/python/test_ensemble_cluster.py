"""Ensembles on a Dask cluster: the bits of threads, and nothing lost with a worker that dies."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from test_ensembles import column, motion

import rbsdem
from rbsdem.many import ensemble

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' brings distributed")

pytestmark = pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::DeprecationWarning")

GIVEN = {"scales": np.linspace(0.1, 3.0, 20), "method": "rk4", "dt": 1e-4}


@pytest.fixture(scope="module")
def cluster() -> Iterator[Any]:
    options = {"n_workers": 2, "threads_per_worker": 1, "dashboard_address": ":0"}
    with distributed.LocalCluster(**options) as cluster, distributed.Client(cluster):
        yield cluster


@pytest.fixture
def client(cluster: Any, monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    monkeypatch.setattr(ensemble, "_LONGEST", 0.2)
    with distributed.Client(cluster) as client:
        yield client


def test_the_bits_are_those_of_threads_although_a_worker_dies(client: Any) -> None:
    elastic = rbsdem.FrameMember(3e10, 0.16, 2e-3)
    frame = rbsdem.Frame.grid(
        [3.0], [6.0], columns=elastic, beams=elastic, beam_load=1e4, floor_mass=1e4
    )
    columns, motions = [column(), column(15e3)], [motion(1, 2000), motion(2, 2000)]
    pids = list(client.run(os.getpid).values())

    def kill() -> None:
        time.sleep(0.3)
        os.kill(pids[0], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    killer.start()
    found = rbsdem.ensemble(columns, motions, client=client, **GIVEN)
    killer.join()
    expected = rbsdem.ensemble(columns, motions, **GIVEN)
    assert list(found.status) == list(expected.status)
    for name in found.measures:
        np.testing.assert_array_equal(found.measures[name], expected.measures[name])
    assert set(client.run(os.getpid).values()) != set(pids)
    found, expected = (
        rbsdem.ensemble(
            frame, motions, client=each, method="newmark", measures=["peak_storey_drift"]
        ).measures["peak_storey_drift"]
        for each in (client, None)
    )
    assert (found == expected).all()


def test_runs_at_which_workers_die_are_failed(cluster: Any, client: Any) -> None:
    """At the first death already, to save time: as a rule the cluster tries again three times."""
    cluster.scheduler.allowed_failures = 0

    def deadly(result: rbsdem.Result) -> float:
        os._exit(1)

    found = rbsdem.ensemble(column(), motion(1), measures=[deadly], method="newmark", client=client)
    assert list(found.status) == ["failed"]
    assert "worker processes died" in found.errors[0]


@pytest.mark.skipif(os.name == "nt", reason="signals of Unix")
def test_ctrl_c_keeps_what_came_back(client: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """At the first result: the tasks that have not ended are taken back."""
    client.wait_for_workers(1, timeout=60)  # one died in a test before
    take = ensemble.Outcome.put

    def put(self: Any, *given: Any) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        monkeypatch.setattr(ensemble.Outcome, "put", take)
        take(self, *given)

    monkeypatch.setattr(ensemble.Outcome, "put", put)
    monkeypatch.setattr(ensemble, "_LONGEST", 1e-3)
    found = rbsdem.ensemble(
        column(), motion(1, 2000), client=client, allow_partial=True, **GIVEN | {"dt": 1e-5}
    )
    assert found.interrupted
    assert 0 < (found.status != "").sum() < len(found)
