"""Columns, cases, results and errors as values: repr, equality, pickle, copy, immutability."""

from __future__ import annotations

import copy
import pickle
from dataclasses import FrozenInstanceError, fields, replace

import numpy as np
import pytest

import rbsdem
from rbsdem.run.case import Case
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    SteelSpring,
    Takeda,
)

SHEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
FLEXURE = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
LAYERS = Layered(
    [
        *((y, ConcreteSpring(4e9, 1.2e6, 6e-4, 8e7)) for y in np.linspace(-0.2, 0.2, 40)),
        (-0.16, SteelSpring(8e8, 7e5, 8e6)),
        (0.16, SteelSpring(8e8, 7e5, 8e6)),
    ]
)
COLUMN = rbsdem.Column(
    3.0, None, [SHEAR, Elastic(1e9), SHEAR], [LAYERS, FLEXURE, FLEXURE], n=3,
    masses=[300.0, 200.0, 100.0], axial_load=7e5, kinematics="pdelta", damping=0.05,
    rotary_inertia=[30.0, 20.0, 10.0], top_mass=1e3, model="layered 2026.2",
)  # fmt: skip
OPEN = rbsdem.Column(
    2.0, 500.0, SHEAR, FLEXURE, n=2, kinematics="finite", axial_load=1e5,
    axial_spring=[Compression(1e9), Elastic(1e9)], damping=rbsdem.Damping(0.1, 1e-5),
)  # fmt: skip
BIG = rbsdem.Column(1e2, 1e6, Elastic(1e9), Elastic(1e9), n=10_000)
PATH = 3.0 * rbsdem.protocol([0.005, 0.01], points=3)
TIME = np.linspace(0.0, 0.05, 11)
MOTION = np.sin(200 * TIME)
CASE = Case(
    "pushed", COLUMN, "static", np.arange(float(PATH.size)), PATH, None, None, None, None,
    {"every": 2},
)  # fmt: skip


def results() -> dict[str, rbsdem.Result]:
    return {
        "cyclic": rbsdem.cyclic(COLUMN, displacement=PATH),
        "time_history": rbsdem.time_history(OPEN, TIME, ground_acceleration=MOTION),
        "case": CASE.run(),
    }


def failed() -> rbsdem.Result:
    plastic = Bilinear(1e6, 1e-3, 0.0)
    with pytest.raises(rbsdem.SolveError) as caught:
        rbsdem.cyclic(rbsdem.Column(1.6, 1.0, plastic, Elastic(1e6)), force=[500.0, 2e3])
    return caught.value.result


RECORDS = {"column": COLUMN, "open": OPEN, "big": BIG, "case": CASE} | results()
RECORDS |= {"failed": failed()}


@pytest.mark.parametrize("name", RECORDS)
def test_repr_is_short(name):
    assert len(repr(RECORDS[name])) < 200
    assert "\n" not in repr(RECORDS[name])


@pytest.mark.parametrize("name", RECORDS)
def test_pickle_and_copy_keep_everything(name):
    one = RECORDS[name]
    for again in (pickle.loads(pickle.dumps(one)), copy.copy(one), copy.deepcopy(one)):
        assert type(again) is type(one)
        assert (again == one) is True
        assert (again != one) is False
        assert repr(again) == repr(one)


@pytest.mark.parametrize("name", RECORDS)
def test_equality_is_true_or_false_for_anything(name):
    one = RECORDS[name]
    for other in (None, 3, "text", np.zeros(3), COLUMN if one is not COLUMN else OPEN):
        assert (one.__eq__(other)) in (False, NotImplemented)
    assert [one] == [one]
    assert one in [one]


@pytest.mark.parametrize("name", ["cyclic", "time_history", "case"])
def test_runs_that_are_repeated_are_equal(name):
    assert results()[name] == RECORDS[name]


def test_every_field_of_a_result_counts_for_equality():
    one = RECORDS["time_history"]
    for field in fields(one):
        value = getattr(one, field.name)
        if isinstance(value, np.ndarray):
            other = value.copy()
            other.flat[-1] = np.nextafter(np.nan_to_num(other.flat[-1]), np.inf)
        elif field.name == "channels":
            other = value | {"input": value["input"] + 1.0}
        elif field.name == "summary":
            other = value | {"steps": value["steps"] + 1}
        elif field.name == "call":
            other = value | {"time": value["time"] + 1.0}
        else:
            other = {"structure": COLUMN, "case": CASE}[field.name]
        assert (replace(one, **{field.name: other}) == one) is False, field.name


def test_every_field_of_a_case_counts_for_equality():
    changes = {
        "title": "pulled", "column": OPEN, "method": "auto", "time": CASE.time + 1.0,
        "displacement": -PATH, "force": PATH, "ground_acceleration": PATH,
        "vertical_acceleration": PATH, "axial_load": PATH, "ground_acceleration_y": PATH,
        "settings": {}, "names_method": not CASE.names_method,
        "target": {"method": "en_1998"}, "records": {"folder": "motions"},
        "assess": [{"code": "asce_41"}],
        "limit": [{"code": "asce_41"}], "files": {"file": "rows.csv"},
    }  # fmt: skip
    assert set(changes) == {field.name for field in fields(CASE)}
    for name, value in changes.items():
        assert (replace(CASE, **{name: value}) == CASE) is False, name


def test_result_knows_its_column_and_its_case():
    assert RECORDS["cyclic"].column is COLUMN
    assert RECORDS["cyclic"].case is None
    assert RECORDS["case"].column == COLUMN
    assert RECORDS["case"].case is CASE
    other = CASE.run(replace(COLUMN, top_mass=2e3))
    assert other.column.top_mass == 2e3
    assert other.case is CASE


def test_equal_records_have_one_hash():
    assert hash(Elastic(1000000)) == hash(Elastic(1e6))
    assert Elastic(2e6) != Elastic(1e6)
    assert replace(COLUMN) == COLUMN
    assert len({COLUMN: 1, replace(COLUMN): 2, OPEN: 3}) == 2


def test_equal_springs_of_all_joints_are_one():
    column = rbsdem.Column(1.0, 1.0, [SHEAR] * 3, (FLEXURE, replace(FLEXURE), FLEXURE), n=3)
    assert column.shear is SHEAR
    assert column.flexure == FLEXURE
    assert column == rbsdem.Column(1.0, 1.0, SHEAR, FLEXURE, n=3)
    assert column.joints("shear") == (SHEAR,) * 3
    assert column.joints("axial_spring") == ()
    assert COLUMN.joints("flexure") == (LAYERS, FLEXURE, FLEXURE)


def test_a_changed_copy_is_checked_anew():
    with pytest.raises(rbsdem.InputError, match="height = -1 m must be above zero"):
        replace(COLUMN, height=-1.0)
    with pytest.raises(rbsdem.InputError, match="cannot carry the axial load"):
        replace(
            COLUMN,
            flexure=Layered([(y, Compression(1e8)) for y in (-0.1, 0.1)]),
            axial_load=-1e3,
        )


def test_records_cannot_be_changed():
    records = [SHEAR, FLEXURE, *RECORDS.values(), rbsdem.modes(OPEN), rbsdem.Damping()]
    for record in records:
        for field in fields(record):
            with pytest.raises(FrozenInstanceError):
                setattr(record, field.name, 1.0)
        with pytest.raises((FrozenInstanceError, AttributeError, TypeError)):
            record.another = 1.0


def test_column_does_not_change_with_the_lists_it_was_made_of():
    lengths, masses = np.array([0.5, 0.5]), [100.0, 200.0]
    springs = [SHEAR, Elastic(2e6)]
    column = rbsdem.Column(1.0, None, springs, springs, n=2, lengths=lengths, masses=masses)
    before = rbsdem.modes(column).omega.copy()
    lengths[:] = [0.1, 0.9]
    masses[0] = 1.0
    springs[0] = Elastic(1.0)
    assert column.lengths == (0.5, 0.5)
    assert column.masses == (100.0, 200.0)
    assert column.shear == (SHEAR, Elastic(2e6))
    assert np.array_equal(rbsdem.modes(column).omega, before)


def test_analyses_leave_their_arrays_alone():
    time, force = TIME.copy(), 500 * MOTION
    rbsdem.time_history(OPEN, time, force=force, ground_acceleration=force / 50, method="newmark")
    rbsdem.cyclic(COLUMN, displacement=force * 1e-6)
    rbsdem.cyclic(COLUMN, force=force)
    FLEXURE.response(force)
    assert np.array_equal(time, TIME)
    assert np.array_equal(force, 500 * MOTION)


def test_arrays_of_any_layout_and_kind_are_taken():
    path = np.array([0.0, 0.004, -0.004, 0.002])
    expected = rbsdem.cyclic(COLUMN, displacement=path).force
    spread = np.zeros((4, 3))
    spread[:, 1] = path
    kinds = [
        path.tolist(),
        tuple(path),
        spread[:, 1],
        path[::-1].copy()[::-1],
        path.astype(">f8"),
        path.astype(object).astype(float),
    ]
    path.flags.writeable = False
    for kind in [*kinds, path]:
        assert np.array_equal(rbsdem.cyclic(COLUMN, displacement=kind).force, expected)
    whole = Elastic(2).response(np.array([1, -2, 3], dtype=np.int16))
    assert np.array_equal(whole, [2.0, -4.0, 6.0])
    assert FLEXURE.response([]).shape == (0,)


@pytest.mark.parametrize("protocol", range(pickle.HIGHEST_PROTOCOL + 1))
def test_errors_are_of_builtin_kinds_and_survive_pickling(protocol):
    plastic = Bilinear(1e6, 1e-3, 0.0)
    with pytest.raises(rbsdem.SolveError, match="beyond the capacity") as caught:
        rbsdem.cyclic(rbsdem.Column(1.6, 1.0, plastic, Elastic(1e6)), force=[0.0, 500.0, 2000.0])
    error = caught.value
    assert error.result.summary["status"] == "failed"
    np.testing.assert_allclose(error.result.force, [0.0, 500.0, 1000.0], rtol=1e-12)
    bare, wrong = rbsdem.SolveError("text"), rbsdem.InputError("text")
    for one, kind in ((error, RuntimeError), (bare, RuntimeError), (wrong, ValueError)):
        back = pickle.loads(pickle.dumps(one, protocol))
        assert (type(back), str(back)) == (type(one), str(one))
        assert isinstance(back, rbsdem.errors.RbsdemError)
        assert isinstance(back, kind)
        assert getattr(back, "result", None) == getattr(one, "result", None)
