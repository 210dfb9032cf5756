"""Incremental dynamic analysis and stripes, on columns whose answers are known."""

from __future__ import annotations

import os
import signal

import numpy as np
import pandas
import pytest

import rbsdem
from rbsdem import InputError, motions
from rbsdem.many import ensemble
from rbsdem.many.ida import CollapseSearch
from rbsdem.springs import Elastic, PeakOriented

HEIGHT = 2.0
SETTINGS = {"method": "newmark", "dt": 0.002}


def oscillator(k: float = 4e5) -> rbsdem.Column:
    """Shear spring under a mass: the drift is the spectral displacement over the height."""
    return rbsdem.Column(HEIGHT, 1000.0, Elastic(k), Elastic(4e9), damping=0.05)


@pytest.fixture(scope="module")
def column() -> rbsdem.Column:
    return oscillator()


@pytest.fixture(scope="module")
def records() -> tuple[rbsdem.GroundMotion, ...]:
    return motions.synthetic(6)


@pytest.fixture(scope="module")
def omega(column) -> float:
    return float(rbsdem.modes(column).omega[0])


@pytest.fixture(scope="module")
def hunted(column, records) -> rbsdem.fragility.IDA:
    return rbsdem.ida(column, records, collapse_drift=0.05, **SETTINGS)


def softening() -> rbsdem.Column:
    """A hinge that loses its strength, under an axial load that pulls it down."""
    hinge = PeakOriented(d_y=0.004, f_y=2e5, d_cap=0.03, f_cap=2.4e5, d_pc=0.06)
    return rbsdem.Column(
        3.0,
        1e3,
        Elastic(5e8),
        hinge,
        top_mass=5e4,
        axial_load=4.9e5,
        kinematics="pdelta",
        damping=0.05,
    )


def test_an_elastic_column_collapses_at_the_same_intensity_under_all_records(hunted, omega):
    """Sa = w^2 Sd: at the limit d of the drift it is w^2 d h, whatever the record.

    The hunt brackets it within 2 %; the method errs by 2e-3. Curves are straight, fractiles one.
    """
    wanted = omega**2 * 0.05 * HEIGHT
    assert (hunted.lower <= 1.003 * wanted).all()
    assert (hunted.upper >= 0.997 * wanted).all()
    assert (hunted.upper <= 1.021 * hunted.lower).all()
    assert hunted.collapse_intensity == pytest.approx(wanted * np.ones((1, 6)), rel=0.02)
    for motion in range(6):
        level, drift = hunted.curve(motion)
        stands = np.isfinite(drift)
        assert stands.sum() >= 11
        assert drift[stands] == pytest.approx(level[stands] / omega**2 / HEIGHT, rel=3e-3)
        assert not stands[-1]
    levels = omega**2 * HEIGHT * np.array([0.01, 0.03, 0.06])
    at, fractiles = hunted.fractiles(levels)
    assert np.array_equal(at, levels)
    assert fractiles[:, :2] == pytest.approx(np.tile([0.01, 0.03], (3, 1)), rel=3e-3)
    assert np.isinf(fractiles[:, 2]).all()


def test_fragility_of_an_elastic_column_is_a_step(hunted, omega):
    found = hunted.fragilities({"light": 0.01, "heavy": 0.03, "collapse": ("collapse", None)})
    limits = {"light": 0.01, "heavy": 0.03, "collapse": 0.05}
    for name, drift in limits.items():
        assert found[name].name == name
        assert found[name].theta == pytest.approx(omega**2 * drift * HEIGHT, rel=0.015)
        assert found[name].beta < 0.01
    assert hunted.fragility("peak_drift", 0.03).theta == found["heavy"].theta


def test_given_levels_bracket_the_same(column, records, omega, hunted):
    wanted = omega**2 * 0.05 * HEIGHT
    levels = wanted * np.array([0.3, 0.9, 1.1])
    found = rbsdem.ida(column, records, levels=levels, collapse_drift=0.05, **SETTINGS)
    assert np.array_equal(found.lower, np.full((1, 6), levels[1]))
    assert np.array_equal(found.upper, np.full((1, 6), levels[2]))
    assert len(found.runs) == 18
    # Linear between the runs, as the column is.
    half = found.fragility("peak_drift", 0.02).theta
    assert half == pytest.approx(hunted.fragility("peak_drift", 0.02).theta, rel=2e-3)


def test_levels_that_end_below_the_collapse_leave_it_open(column, records, omega):
    levels = omega**2 * 0.05 * HEIGHT * np.array([0.3, 0.9])
    found = rbsdem.ida(column, records[:2], levels=levels, collapse_drift=0.05, **SETTINGS)
    assert np.isinf(found.upper).all()
    assert np.isinf(found.collapse_intensity).all()
    with pytest.raises(InputError, match="no record reached the limit state"):
        found.fragility()


@pytest.mark.parametrize("intensity", ["pga", "sa_avg"])
def test_other_intensities_scatter(column, records, omega, intensity):
    """Each record reaches Sa = w^2 d h at its own PGA, or at its own mean of Sa."""
    found = rbsdem.ida(
        column,
        records,
        intensity=intensity,
        collapse_drift=0.05,
        levels=CollapseSearch(points=1),
        **SETTINGS,
    )
    period = 2 * np.pi / omega
    own = [
        record.pga if intensity == "pga" else record.sa_avg(np.linspace(0.2, 3, 10) * period)
        for record in records
    ]
    wanted = omega**2 * 0.05 * HEIGHT * np.array(own) / [record.sa(period) for record in records]
    assert found.collapse_intensity[0] == pytest.approx(wanted, rel=0.02)
    assert found.fragility().beta == pytest.approx(np.log(wanted).std(ddof=1), abs=0.02)


def test_a_softening_column_is_hunted_down(records):
    """Every bracket holds: a run without collapse below, one with a collapse above."""
    found = rbsdem.ida(
        softening(), records, method="newmark", levels=CollapseSearch(resolution=0.05)
    )
    assert (found.upper <= found.lower / 0.95 * (1 + 1e-12)).all()
    for motion in range(6):
        own = found.runs.motion == motion
        at, lost = found.runs.intensity[own], found.runs.collapsed[own]
        assert at[lost].min() == pytest.approx(found.upper[0, motion])
        assert at[~lost & (at < found.upper[0, motion])].max() == pytest.approx(
            found.lower[0, motion]
        )
    assert set(found.runs.status) == {"completed", "collapsed"}


def test_several_columns_split_the_variance(records):
    """Elastic columns: the record has no part in Sa at the own period, stiffness has all of it."""
    columns = {f"{k:g}": oscillator(k) for k in (4e5, 5e5)}
    period = 1 / float(rbsdem.modes(columns["400000"]).frequency[0])
    found = rbsdem.ida(
        columns,
        records,
        period=period,
        collapse_drift=0.05,
        levels=CollapseSearch(points=1),
        **SETTINGS,
    )
    for i, column in enumerate(columns.values()):
        own = rbsdem.modes(column).omega[0]
        ratio = [record.sa(period) / record.sa(2 * np.pi / own) for record in records]
        wanted = own**2 * 0.05 * HEIGHT * np.array(ratio)
        assert found.collapse_intensity[i] == pytest.approx(wanted, rel=0.02)


def test_limit_states_are_bracketed(records):
    """The base is at its yield and at its cap where its rotation is that, within 5 %."""
    rotations = {"first_yield": 0.004, "cap": 0.03}
    few, names = CollapseSearch(points=3), list(rotations)
    found = rbsdem.ida(softening(), records, method="newmark", levels=few, refine=names)
    for name, rotation in rotations.items():
        data = found.capacities(name)
        assert data.known
        assert (data.upper < found.upper[0]).all()
        assert found.fragility(name).theta == pytest.approx(np.exp(np.log(data.values).mean()))
        for place, record in enumerate(records):
            unit = record.sa(found.runs.measure.period)
            low, high = (
                rbsdem.time_history(
                    softening(), ground_acceleration=record.scaled(at / unit), method="newmark"
                )
                for at in (data.lower[place], data.upper[place])
            )
            assert np.abs(low.rotation).max() < rotation <= np.abs(high.rotation).max() * (1 + 1e-9)
    plain = rbsdem.ida(softening(), records, method="newmark", levels=few, refine=[])
    assert not plain.capacities("first_yield").known
    assert len(plain.runs) < len(found.runs)


def test_the_scale_of_the_records_does_not_matter(column, records, hunted):
    """Nor does it whether the progress is to be shown."""
    strong = [record.scaled(7.0) for record in records[:2]]
    found = rbsdem.ida(column, strong, collapse_drift=0.05, progress=True, **SETTINGS)
    assert found.upper == pytest.approx(hunted.upper[:, :2], rel=1e-12)


def test_a_hunt_goes_on_from_its_store(column, records, tmp_path, monkeypatch):
    """The second start asks for the same runs, and the store has them all."""
    options = {
        "levels": CollapseSearch(points=2),
        "collapse_drift": 0.05,
        "store": tmp_path / "store",
    }
    first = rbsdem.ida(column, records[:2], **options, **SETTINGS)
    more = rbsdem.ida(column, records[:3], **options, **SETTINGS)
    assert np.array_equal(more.upper[:, :2], first.upper)
    monkeypatch.setattr("rbsdem.many.ensemble.compute", None)
    again = rbsdem.ida(column, records[:2], **options, **SETTINGS)
    assert np.array_equal(again.upper, first.upper)
    assert np.array_equal(again.runs.measures["peak_drift"], first.runs.measures["peak_drift"])


def test_stripes_of_an_elastic_column(column, records, omega):
    """All or none at each level: no spread is known, and the step lies between the levels."""
    limit = omega**2 * 0.03 * HEIGHT
    levels = limit * np.array([0.5, 0.9, 1.1, 2.0])
    found = rbsdem.fragility.stripes(column, records, levels, **SETTINGS)
    counts = found.counts("peak_drift", 0.03)
    assert counts.number.tolist() == [6, 6, 6, 6]
    assert counts.failures.tolist() == [0, 0, 6, 6]
    with pytest.raises(InputError, match="do not determine beta"):
        found.fragility("peak_drift", 0.03)
    step = found.fragility("peak_drift", 0.03, beta=0.2)
    assert found.fragilities({"heavy": 0.03}, beta={"heavy": 0.2})["heavy"].theta == step.theta
    assert 0.9 * limit < step.theta < 1.1 * limit
    with pytest.raises(InputError, match="beta of light: no such limit state; there are heavy"):
        found.fragilities({"heavy": 0.03}, beta={"light": 0.2})


def test_stripes_with_records_of_their_own(column, records, omega):
    limit = omega**2 * 0.03 * HEIGHT
    own = {0.9 * limit: records[:3], 1.1 * limit: records[2:]}
    found = rbsdem.fragility.stripes(column, own, **SETTINGS)
    counts = found.counts("peak_drift", 0.03)
    assert not counts.paired
    assert counts.number.tolist() == [3, 4]
    assert counts.failures.tolist() == [0, 4]


def test_stripes_and_ida_tell_the_same_of_a_softening_column(records):
    """The same runs: a stripe counts the records whose collapse lies below its level."""
    settings = {"method": "newmark"}
    hunted = rbsdem.ida(
        softening(), records, levels=CollapseSearch(resolution=0.01, points=1), **settings
    )
    levels = np.quantile(hunted.collapse_intensity, [0.1, 0.5, 0.7, 0.9])
    found = rbsdem.fragility.stripes(softening(), records, levels, **settings)
    below = (hunted.collapse_intensity[0] < levels[:, None]).sum(axis=1)
    assert found.counts().failures.tolist() == below.tolist()


def test_parts_of_a_search_come_together_in_a_store(column, records, hunted, tmp_path, monkeypatch):
    """Each part is the search of its records; without `shard` nothing is left to compute."""
    given = {"collapse_drift": 0.05, "store": tmp_path / "store"} | SETTINGS
    parts = [rbsdem.ida(column, records, shard=(i, 2), **given) for i in (1, 2)]
    assert [len(part.runs.motions) for part in parts] == [3, 3]
    computed = []
    monkeypatch.setattr(ensemble, "compute", lambda task, control: computed.append(task))
    whole = rbsdem.ida(column, records, **given)
    monkeypatch.undo()
    assert not computed
    assert np.array_equal(whole.upper, hunted.upper)
    pandas.testing.assert_frame_equal(whole.to_pandas(), hunted.to_pandas())
    levels = {1.0: list(records[:2]), 2.0: list(records[2:])}
    striped = rbsdem.fragility.stripes(column, levels, shard=(2, 2), **given)
    assert striped.runs.intensity == pytest.approx([1.0, 2.0, 2.0])
    for shard, options, said in (
        ((1, 7), given, "7 parts of 6 motions"),
        ((3, 2), given, "1 <= i <= n"),
        ((1, 2), SETTINGS, "give store="),
    ):
        with pytest.raises(InputError, match=said):
            rbsdem.ida(column, records, shard=shard, **options)


def test_a_search_that_is_interrupted_goes_on(column, records, hunted, tmp_path):
    calls = []

    def interrupting(result):
        calls.append(1)
        if len(calls) == 30:
            os.kill(os.getpid(), signal.SIGINT)
        return 0.0

    given = {"collapse_drift": 0.05, "store": tmp_path / "store", "measures": [interrupting]}
    with pytest.raises(rbsdem.errors.Interrupted, match=r"ida: interrupted after \d+ runs; they"):
        rbsdem.ida(column, records, jobs=1, **given, **SETTINGS)
    done = len(calls)
    again = rbsdem.ida(column, records, jobs=1, **given, **SETTINGS)
    assert 30 <= done < len(again.runs)
    assert len(calls) == len(again.runs)
    assert np.array_equal(again.upper, hunted.upper)
    calls.clear()
    calls.extend([1] * 25)
    with pytest.raises(rbsdem.errors.Interrupted, match=r"with a store .* they would be kept"):
        rbsdem.ida(
            column, records, jobs=1, collapse_drift=0.05, measures=[interrupting], **SETTINGS
        )
