"""Runs that are ended while they are under way: by Ctrl-C, or by the time that they may take."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import rbsdem
from rbsdem import _progress
from rbsdem.springs import Elastic

pytestmark = [
    pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning"),
    pytest.mark.filterwarnings("ignore::rbsdem.errors.LongRunWarning"),
    pytest.mark.skipif(os.name == "nt", reason="a process of Windows cannot send itself Ctrl-C"),
]

COLUMN = rbsdem.Column(2.0, 1e4, Elastic(2e7), [Elastic(1e8)] * 50, n=50)
# Hours of work: a test would not end if the run were not ended.
TIME = np.array([0.0, 1e6])


def endless(**more):
    ground = np.array([0.0, 1.0])
    return rbsdem.time_history(
        COLUMN,
        TIME,
        ground_acceleration=ground,
        method="newmark",
        dt=1e-3,
        every=10**6,
        **{"max_seconds": 1e9} | more,
    )


@pytest.fixture
def interrupted():
    """Send the process the signal of Ctrl-C while it runs."""
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    timer.start()
    yield
    timer.join()


def test_ctrl_c_ends_a_run_in_time(interrupted):
    with pytest.raises(KeyboardInterrupt):
        endless()


def test_a_handler_that_goes_on_has_the_rows_so_far(interrupted):
    """The energies balance at the last row, which is that of the moment of the signal."""
    before = signal.signal(signal.SIGINT, lambda *_: None)
    try:
        run = endless()
    finally:
        signal.signal(signal.SIGINT, before)
    assert run.summary["status"] == "stopped"
    assert 0 < run.time[-1] < TIME[-1]
    assert run.summary["steps"] == pytest.approx(run.time[-1] / 1e-3, abs=1)
    assert run.summary["relative_energy_residual"] < 1e-6


SOFTENING = rbsdem.springs.Takeda(k_c=2.5e8, d_c=3e-4, k_y=6e7, d_y=2.7e-3, k_u=7e6, b1=0.3)
STATIC = rbsdem.Column(2.0, 1e4, Elastic(2e7), [SOFTENING] * 50, n=50)
PATH = np.tile([0.01, -0.01], 2 * 10**6)


def test_ctrl_c_ends_a_static_path(interrupted):
    with pytest.raises(KeyboardInterrupt):
        rbsdem.cyclic(STATIC, displacement=PATH, every=10**6)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_max_seconds_end_a_static_path(kinematics):
    """Rows up to there are those of the path that was not stopped, straight or curved."""
    column = replace(STATIC, kinematics=kinematics)
    run = rbsdem.cyclic(column, displacement=PATH, max_seconds=0.2)
    assert run.summary["status"] == "stopped"
    assert 0 < run.time.size < PATH.size
    rows = min(run.time.size, 20)
    whole = rbsdem.cyclic(column, displacement=PATH[:rows])
    assert np.array_equal(run.force[:rows], whole.force)
    assert run.summary["relative_energy_residual"] < 1e-6


def test_max_seconds_end_a_static_path_of_a_case(run_cli, tmp_path):
    """By the executable: the rows are in the file, and a note says where the path was stopped."""
    text = STATIC.to_namelist() + (
        "\n&loading drive = 'displacement', amplitudes = 0.01, cycles = 100000 /"
        "\n&analysis method = 'static', max_seconds = 0.2 /\n"
    )
    (tmp_path / "long.nml").write_text(text)
    run = run_cli(["run", "long.nml"], tmp_path)
    assert run.returncode == 0
    assert "the path was stopped on the way to row" in run.stdout
    assert len((tmp_path / "long.csv").read_text().splitlines()) > 2


def test_max_seconds_end_runs_of_an_ensemble():
    """A run that is stopped has no measures and says why; the others go on."""
    short, long = (0.01, np.ones(3)), (0.01, np.sin(0.1 * np.arange(400_000)))
    found = rbsdem.ensemble(COLUMN, [short, long], method="newmark", max_seconds=0.2)
    assert found.status.ravel().tolist() == ["completed", "failed"]
    assert "max_seconds" in found.errors[1]
    assert np.isnan(found.measures["peak_drift"].ravel()[1])


def test_a_long_run_shows_how_far_it_is(monkeypatch):
    """Parts of a hundred, which grow; beside a bar that is shown there is no other."""
    shown = []

    @contextlib.contextmanager
    def bar(wanted, total, unit):
        yield lambda done, text: shown.append((done, total, unit))

    monkeypatch.setattr(_progress, "progress_bar", bar)
    monkeypatch.setattr(_progress, "_PATIENCE", 0.0)
    monkeypatch.setattr(_progress, "_BEAT", 1e-4)
    monkeypatch.setattr(sys, "stderr", SimpleNamespace(isatty=lambda: True))
    run = {"ground_acceleration": np.array([0.0, 1.0]), "method": "newmark", "every": 10**6}
    rbsdem.time_history(COLUMN, np.array([0.0, 200.0]), dt=1e-3, **run)
    done = [one for one, _, _ in shown]
    assert done == sorted(done)
    assert len(set(done)) > 5
    assert 0 <= done[0] < done[-1] <= 100
    shown.clear()
    monkeypatch.setattr(_progress, "_SHOWN", [object()])
    rbsdem.time_history(COLUMN, np.array([0.0, 200.0]), dt=1e-3, **run)
    assert not shown
