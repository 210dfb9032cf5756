"""Runs that begin in the state that another analysis ended in."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_ensembles import column, motion, same_as_alone

import rbsdem
from rbsdem import InputError, motions
from rbsdem.many.ida import CollapseSearch
from rbsdem.springs import Elastic

NEWMARK = {"method": "newmark"}


def layered() -> rbsdem.Column:
    section = rbsdem.peer.paper_sections()["zahn_7"].section
    return replace(
        rbsdem.section.column(section, 1.6, axial_load=1.01e6), top_mass=1.01e5, damping=0.02
    )


def shaken(of: rbsdem.Column, scale: float = 2.0, seed: int = 1, **more: object) -> rbsdem.Result:
    """Return the response to a motion that leaves damage."""
    time, acceleration = motion(seed, 300)
    given = NEWMARK | more
    return rbsdem.time_history(of, time, ground_acceleration=scale * acceleration, **given)


def test_each_run_is_that_of_time_history() -> None:
    """One state a column, of a motion, of a static path, and none."""
    columns = {"layered": layered(), "pushed": column(20e3, n=2), "virgin": column()}
    initial = {
        "layered": shaken(columns["layered"], 1.0),
        "pushed": rbsdem.cyclic(columns["pushed"], displacement=[0.02, -0.01]),
    }
    time, acceleration = motion(2, 150)
    found = rbsdem.ensemble(
        columns, (time, acceleration), scales=[0.5, 1.0], initial=initial, **NEWMARK
    )
    assert set(found.status) == {"completed"}
    same_as_alone(found)
    for run, name in enumerate(np.repeat(list(columns), 2)):
        alone = rbsdem.time_history(
            columns[name],
            time,
            ground_acceleration=found.scale[run] * acceleration,
            initial=initial.get(name),
            **NEWMARK,
        )
        assert found.measures["residual_displacement"][run] == alone.displacement[-1]
        assert found.measures["peak_base_shear"][run] == alone.summary["peak_base_shear"]


def test_states_are_checked_before_the_start(tmp_path: Path) -> None:
    state = shaken(column())
    broken = state.state.copy()
    broken[-1] += 1.0
    path = tmp_path / "end.state"
    state.save_state(path)
    own = {"a": column(), "b": column(n=2)}
    for initial, message in (
        (state, r"column 'b': initial: the state belongs to a column of n = 1"),
        ([state, broken], r"column 'b': initial: the state is damaged"),
        ([path], r"initial: 1 states for 2 columns"),
        ({"c": path}, r"initial: 'c' is no column; they are 'a', 'b'"),
        ({"a": tmp_path / "no.state"}, r"column 'a': initial: .*no such file"),
        (7, r"ensemble: initial = 7 must be a Result"),
        ({"b": shaken(layered(), 0.5)}, r"column 'b': initial: "),
    ):
        with pytest.raises(InputError, match=message):
            rbsdem.ensemble(own, motion(1), initial=initial, **NEWMARK)
    found = rbsdem.ensemble(own, motion(1), initial={"a": path}, **NEWMARK)
    assert found.measures["residual_drift"][0] != found.measures["residual_drift"][1]


def test_a_store_belongs_to_its_states(tmp_path: Path) -> None:
    state = shaken(column())
    runs = [
        rbsdem.ensemble(column(), motion(2), initial=state, store=tmp_path, **NEWMARK)
        for _ in range(2)
    ]
    assert runs[1].resumed == 1
    assert runs[1].measures["peak_drift"] == runs[0].measures["peak_drift"]
    for other in (None, shaken(column(), 1.9)):
        found = rbsdem.ensemble(column(), motion(2), initial=other, store=tmp_path, **NEWMARK)
        assert found.resumed == 0


def test_ida_of_a_damaged_column() -> None:
    """From rest it is that of the virgin column; from a swing that of both motions together.

    The elastic column adds them: without motion its drift is that of the push that is let go.
    """
    records = motions.synthetic(2)
    given = {"levels": CollapseSearch(points=2, resolution=0.2), "method": "newmark", "dt": 0.01}
    elastic = rbsdem.Column(2.0, 1e3, Elastic(4e5), Elastic(4e9))
    rest = rbsdem.cyclic(elastic, displacement=[0.0])
    virgin, same = (rbsdem.ida(elastic, records, initial=state, **given) for state in (None, rest))
    np.testing.assert_array_equal(virgin.collapse_intensity, same.collapse_intensity)
    pushed = rbsdem.cyclic(elastic, displacement=[0.02])
    found = rbsdem.ida(elastic, records, initial=[pushed], **given)
    level, drift = found.curve(0)
    assert level[0] == 0
    assert drift[0] == pytest.approx(0.01, rel=1e-3)
    for bound, fate in ((found.lower, "completed"), (found.upper, "collapsed")):
        factor = bound[0, 0] / found.runs.measure.of(records[0])
        alone = rbsdem.time_history(
            elastic,
            ground_acceleration=records[0].scaled(factor),
            initial=pushed,
            collapse_drift=0.1,
            method="newmark",
            dt=0.01,
        )
        assert alone.summary["status"] == fate
    with pytest.raises(InputError, match="reached in the initial state already"):
        found.fragility("peak_drift", 0.005)
    with pytest.raises(InputError, match="'column' collapses from its initial state"):
        rbsdem.ida(elastic, records, initial=pushed, collapse_drift=0.005, **given)
