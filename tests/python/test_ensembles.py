"""Ensembles: each run is that of `time_history`; no run stops the others; all faults at once."""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import rbsdem
from rbsdem import InputError, SolveError, _core
from rbsdem.many.inputs import LIMIT_STATES, MEASURES, STATUSES, Motion
from rbsdem.many.plan import Plan, compute
from rbsdem.springs import Bilinear, ConcreteSpring, Elastic, Layered, PeakOriented, Takeda


def motion(seed: int, points: int = 400, dt: float = 0.01) -> tuple[np.ndarray, np.ndarray]:
    """Return a motion of some sines [s, m/s2], 3 m/s2 at its largest."""
    rng = np.random.default_rng(seed)
    time = dt * np.arange(points)
    parts = [
        rng.normal() * np.sin(2 * np.pi * rng.uniform(0.5, 6.0) * time + rng.uniform(0.0, 6.0))
        for _ in range(20)
    ]
    values = np.sum(parts, axis=0) * np.minimum(time, 1.0)
    return time, 3.0 * values / np.abs(values).max()


def column(mass: float = 30e3, **more: object) -> rbsdem.Column:
    """Return one body with a bilinear and a Takeda spring that yields under such motions."""
    shear = Bilinear(k=7.0e7, d_y=1.3e-3, k_post=8.0e5)
    flexure = Takeda(k_c=2.5e8, d_c=3.2e-4, k_y=6.3e7, d_y=2.7e-3, k_u=7.6e6, b1=0.22)
    weight = {"axial_load": 9.81 * mass, "kinematics": "pdelta", "top_mass": mass}
    return rbsdem.Column(1.6, 600.0, shear, flexure, **(weight | more))  # type: ignore[arg-type]


def same_as_alone(found: rbsdem.fragility.Ensemble) -> None:
    """Hold every run of an ensemble to `time_history`, to the last bit."""
    for run in range(len(found)):
        values = {name: found.measures[name][run] for name in found.measures}
        if found.status[run] == "failed":
            with pytest.raises(SolveError, match=re.escape(found.errors[run])):
                found.history(run)
            assert all(math.isnan(value) for value in values.values())
            continue
        result = found.history(run)
        about = result.summary
        assert found.status[run] == about["status"]
        alone = {name: about[name] for name in MEASURES if name in about}
        alone["end_time"] = result.time[-1]
        alone["residual_displacement"] = result.displacement[-1]
        alone["peak_drift"] = abs(about["peak_displacement"]) / result.column.height
        known = set(alone) & set(values)
        assert {name: alone[name] for name in known} == {name: values[name] for name in known}
        states = result.limit_states()
        for name in {"first_yield", *LIMIT_STATES} & set(values):
            at = states[name].time if name in states else math.nan
            np.testing.assert_array_equal(values[name], at, name)
            if name in states:
                assert result.time[states[name].row - 1] < at <= result.time[states[name].row]


@pytest.mark.parametrize("settings", [{}, {"method": "newmark"}, {"method": "rk4", "dt": 1e-3}])
def test_runs_are_those_of_time_history(settings: dict) -> None:
    columns = {"light": column(10e3), "heavy": column(40e3, damping=0.02)}
    motions = {"a": motion(1), "b": motion(2, 250, 0.02)}
    found = rbsdem.ensemble(
        columns, motions, scales=[0.1, 1.0, 3.0], collapse_drift=0.03, **settings
    )
    assert len(found) == 12
    assert set(found.status) == {"completed", "collapsed"}
    same_as_alone(found)


def test_the_number_of_threads_changes_no_bit() -> None:
    given = {"scales": np.linspace(0.1, 3.0, 20), "collapse_drift": 0.03, "method": "hht"}
    one, two = (
        rbsdem.ensemble([column(), column(15e3)], [motion(1), motion(2)], jobs=jobs, **given)
        for jobs in (1, 3)
    )
    assert list(one.status) == list(two.status)
    for name in MEASURES:
        np.testing.assert_array_equal(one.measures[name], two.measures[name])


def test_a_run_that_fails_is_a_row() -> None:
    """Beyond the stability limit RK4 grows without bounds."""
    elastic = rbsdem.Column(1.6, 600.0, Elastic(7e7), Elastic(2.5e8))
    found = rbsdem.ensemble(
        elastic, motion(1), scales=[0.0, 1.0], method="rk4", dt=5e-3, allow_unstable=True,
        collapse_drift=None,
    )  # fmt: skip
    assert list(found.status) == ["completed", "failed"]
    assert found.counts == {"completed": 1, "failed": 1}
    assert "grows without bounds" in found.errors[1]
    same_as_alone(found)


def test_scales_for_each_column_and_motion() -> None:
    scales = np.array([[[1.0, 2.0], [3.0, np.nan]], [[np.nan, np.nan], [0.5, 4.0]]])
    found = rbsdem.ensemble(
        [column(), column(10e3)], [motion(1), motion(2)], scales=scales, method="newmark"
    )
    assert list(found.column) == [0, 0, 0, 1, 1]
    assert list(found.motion) == [0, 0, 1, 1, 1]
    assert list(found.scale) == [1.0, 2.0, 3.0, 0.5, 4.0]


def test_names_of_motions() -> None:
    time, acceleration = motion(1)
    given = [
        SimpleNamespace(time=time, acceleration=acceleration, name="kobe"),
        (0.01, acceleration),
    ]
    found = rbsdem.ensemble(column(), given, method="newmark")
    assert list(found.motions) == ["kobe", 1]
    assert found.measures["peak_drift"][0] == pytest.approx(found.measures["peak_drift"][1])


def test_limit_states_are_those_of_the_history() -> None:
    """Of a layered hinge, a spring with a cap, and a spring in lanes."""
    section = rbsdem.peer.paper_sections()["zahn_7"].section
    layered = replace(
        rbsdem.section.column(section, 1.6, axial_load=1.01e6), top_mass=1.01e5, damping=0.02
    )
    peaked = PeakOriented(d_y=0.003, f_y=2e5, d_cap=0.01, f_cap=2.2e5, d_pc=0.1)
    columns = [layered, replace(column(), flexure=peaked), column()]
    time, acceleration = motion(1)
    names = ["first_yield", *LIMIT_STATES]
    shaken = (time[:300], acceleration[:300])
    found = rbsdem.ensemble(columns, shaken, scales=4.0, measures=names, method="newmark")
    same_as_alone(found)
    reached = {name for name in names if np.isfinite(found.measures[name]).any()}
    assert {"first_yield", "cracking", "nominal_moment", "cap", "shear_yield"} <= reached


@pytest.mark.parametrize("method", ["newmark", "rk4"])
def test_no_measure_depends_on_what_else_is_asked_for(method: str) -> None:
    """What a column is watched for decides which lanes run it, if any."""
    for columns in (bodies(), damped()[:2]):
        given = {"columns": columns, "motions": motion(1), "scales": [0.5, 3.0], "method": method}
        few = rbsdem.ensemble(**given)
        more = rbsdem.ensemble(**given, measures=[*MEASURES, *LIMIT_STATES])
        for name in MEASURES:
            np.testing.assert_array_equal(few.measures[name], more.measures[name], name)


def test_a_lost_joint_has_the_number_that_results_give_it() -> None:
    """1 at the bottom of a column on a footing, 0 beneath it, NaN where none was lost."""
    crushing = ConcreteSpring(k=1e7, f_peak=4e4, d_peak=6e-3, k_soft=5e6, f_res=1e4)
    layers = Layered([(y, crushing) for y in (-0.15, -0.05, 0.05, 0.15)])
    elastic = Elastic(1e8)
    weight = {"axial_load": 1e5, "top_mass": 1e4, "kinematics": "pdelta"}
    columns = [
        rbsdem.Column(1.0, 1e3, elastic, hinge, footing=footing, **weight)
        for hinge, footing in (
            (layers, rbsdem.Footing(elastic, elastic, mass=1e3, inertia=1e2, height=0.3)),
            (elastic, rbsdem.Footing(elastic, layers, mass=1e3, inertia=1e2, height=0.3)),
        )
    ]
    given = (0.01, 6 * np.sin(0.08 * np.arange(100)))
    found = rbsdem.ensemble(columns, given, scales=[0.01, 2.0], method="newmark")
    assert list(found.status) == ["completed", "axial_failure"] * 2
    np.testing.assert_array_equal(found.measures["lost_joint"], [np.nan, 1, np.nan, 0])
    same_as_alone(found)


def test_measures_of_functions() -> None:
    def mean_force(result: rbsdem.Result) -> float:
        return float(np.abs(result.base_shear).mean())

    def broken(result: rbsdem.Result) -> float:
        return result.time[10**6]

    found = rbsdem.ensemble(
        column(),
        motion(1),
        scales=[1.0, 2.0],
        measures=["peak_drift", mean_force],
        method="newmark",
    )
    assert list(found.measures) == ["peak_drift", "mean_force"]
    assert found.measures["mean_force"][1] == mean_force(found.history(1))
    filters = list(warnings.filters)
    found = rbsdem.ensemble(
        column(), motion(1), scales=np.ones(20), measures=[broken], method="newmark", jobs=4
    )
    assert set(found.status) == {"failed"}
    assert found.errors[0].startswith("measure broken: IndexError")
    assert warnings.filters == filters


def test_runs_are_warned_of_where_single_ones_warn() -> None:
    found = rbsdem.ensemble(
        {"small": column(), "finite": column(kinematics="finite")}, motion(1),
        scales=[1.0, 3.0, 5.0, 10.0, 20.0, 30.0], method="newmark", collapse_drift=None,
    )  # fmt: skip
    warned = list(found.to_pandas()["warnings"] != "")
    for run in range(len(found)):
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            found.history(run)
        assert warned[run] == any("rotation of a body" in str(one.message) for one in told)
    assert 0 < sum(warned) < len(found)
    assert f"{sum(warned)} with warnings" in repr(found)


def test_table() -> None:
    pytest.importorskip("pandas")
    found = rbsdem.ensemble({"a": column()}, motion(1), scales=[1.0, 2.0], method="newmark")
    table = found.to_pandas()
    assert list(table.columns) == [
        "column",
        "motion",
        "scale",
        "status",
        *MEASURES,
        "warnings",
        "error",
    ]
    assert list(table["column"]) == ["a", "a"]
    assert table["steps"].dtype.kind == "i"
    assert list(table["peak_drift"]) == list(found.measures["peak_drift"])


def test_all_faults_at_once() -> None:
    time, acceleration = motion(1)
    back = time.copy()
    back[5] = back[4]
    with pytest.raises(InputError) as caught:
        rbsdem.ensemble(
            [column(), 7],
            {"short": (time, acceleration[1:]), "back": (back, acceleration), "no": "kobe"},
            scales=[[1.0, 2.0]] * 2,
            jobs=0,
            measures=["drift"],
        )
    text = str(caught.value)
    for part in (
        "column 1: column = 7",
        "motion 'short': 399 accelerations for 400 times",
        "motion 'back': time: value 6 of 400",
        "motion 'no': a str",
        "scales has shape (2, 2)",
        "jobs = 0",
        "measures: 'drift' is not known",
    ):
        assert part in text
    assert len(text.splitlines()) == 7


def test_columns_that_cannot_be_run_are_named_before_the_start() -> None:
    with pytest.raises(InputError, match=r"column 'b': .*stability limit") as caught:
        rbsdem.ensemble({"a": column(1e6), "b": column(1e2)}, motion(1), method="rk4", dt=2.5e-3)
    assert "column 'a'" not in str(caught.value)


def bodies() -> list[rbsdem.Column]:
    """Return columns of one body that differ in mass, springs and damping."""
    columns = [column(mass) for mass in (2e3, 10e3, 30e3, 80e3)]
    stiff = Elastic(7e9)
    columns.append(rbsdem.Column(1.6, 600.0, stiff, columns[0].flexure))
    capped = PeakOriented(
        d_y=1.3e-3, f_y=9.1e4, d_cap=5e-3, f_cap=9.4e4, d_pc=0.05, f_res=2e4, lambda_h=20, s_min=0.3
    )
    columns.append(rbsdem.Column(1.6, 3e3, capped, columns[0].flexure))
    return columns


def damped() -> list[rbsdem.Column]:
    """Return one body with each kind of damping."""
    kinds = [
        0.05,
        rbsdem.Damping(mass=0.4),
        rbsdem.Damping(stiffness=2e-4),
        rbsdem.Damping(mass=0.2, stiffness=2e-4, tangent=True),
        rbsdem.Damping(modal=[0.05, 0.02]),
    ]
    return [column(30e3, damping=kind) for kind in kinds] + [column(30e3)]


@pytest.mark.parametrize(
    ("columns", "settings"),
    [
        (bodies, {"method": "newmark", "dt": 0.02}),
        (bodies, {"method": "hht", "rho_infinity": 0.7, "dt": 5e-3}),
        (bodies, {"method": "generalised_alpha", "collapse_drift": 0.05}),
        (bodies, {"method": "rk4", "collapse_drift": 0.05}),
        (bodies, {"method": "rk4", "dt": 2e-4, "allow_unstable": True}),
        (damped, {"method": "newmark", "collapse_drift": 0.05}),
        (damped, {"method": "generalised_alpha", "dt": 5e-3}),
        (damped, {"method": "rk4", "collapse_drift": 0.05}),
    ],
)
def test_lanes_have_the_bits_of_a_run_alone(columns: Callable, settings: dict) -> None:
    """By each set of instructions, whatever the neighbours do, and where there are few of them."""
    motions = [
        Motion(0, *motion(1)),
        Motion(1, *motion(2, 150, 0.02)),
        Motion(2, np.array([0.0, 1.0]), np.array([0.0, 2.0])),
    ]
    scales = np.array([0.0, 0.1, 0.5, 1.0, 3.0, 10.0, 100.0])
    own = columns()
    grid = np.meshgrid(np.arange(len(own)), np.arange(3), np.arange(7), indexing="ij")
    place = [axis.ravel().astype(np.int32) for axis in grid]
    task = Plan(
        own, motions, settings, place[0], place[1], scales[place[2]], states=tuple(LIMIT_STATES)
    )
    alone = compute(task, kernel=-1)
    for kernel in (1, 2, 3):
        found = compute(task, kernel=kernel)
        np.testing.assert_array_equal(found.fates, alone.fates)
        np.testing.assert_array_equal(found.values, alone.values)
        assert found.errors == alone.errors
    events = alone.values[_core.measures().index("events")]
    assert events[alone.fates != STATUSES.index("failed")].max() > 100


def test_lanes_leave_uneven_steps_to_runs_alone() -> None:
    time, acceleration = motion(1)
    later = (time + 1.0, acceleration)
    uneven = (time + 1e-3 * (np.arange(time.size) % 2), acceleration)
    damped = column(damping=0.05)
    found = rbsdem.ensemble(
        [column(), damped], [later, uneven], scales=[0.5, 2.0], method="newmark"
    )
    assert set(found.status) == {"completed"}
    same_as_alone(found)


def test_each_part_of_the_work_has_runs_of_all_scales() -> None:
    """Else the time left would be that of small scales. Runs of lanes stay in their order."""
    made: list[float] = []

    def at(result: rbsdem.Result) -> float:
        made.append(float(np.abs(result.displacement).max()))
        return made[-1]

    scales = np.linspace(0.01, 0.1, 20)
    shaken = {"measures": [at], "method": "rk45", "jobs": 1, "scales": scales}
    found = rbsdem.ensemble(column(n=2), motion(1), **shaken)
    half = sorted(found.measures["at"].tolist().index(value) for value in made[:10])
    assert max(np.diff([-1, *half, 20])) <= 3
