"""Messages name what was given and what to give instead; warnings come where they help."""

from __future__ import annotations

import pickle
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import Concrete, InputError, Layout, RectangularSection, Steel, Ties, peer
from rbsdem.errors import AccuracyWarning
from rbsdem.springs import Bilinear, Elastic, Takeda

STEEL = Steel(446e6, 702e6)
SECTION = RectangularSection(
    0.4, 0.4, Concrete(46.5e6), layout=Layout(12, 0.016, STEEL),
    ties=Ties(0.007, 0.085, Steel(364e6), legs=4), cover=0.013,
)  # fmt: skip
COLUMN = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
TEST = ([0.0, 0.01, -0.01], [0.0, 1e5, -1e5])


@pytest.mark.parametrize(
    "use",
    [
        lambda thing: rbsdem.cyclic(thing, displacement=[0, 0.01]),
        lambda thing: rbsdem.time_history(thing, [0, 0.1], ground_acceleration=[0, 1]),
        rbsdem.modes,
        rbsdem.matrices,
        lambda thing: rbsdem.compare_methods(thing, displacement=[0, 0.01]),
        lambda thing: rbsdem.calibrate(thing, TEST, free=["flexure.k_u"]),
    ],
)
def test_what_is_no_column_is_named_in_short_with_what_makes_one(use):
    for thing, words in (
        (SECTION, ["a RectangularSection", "section.column(section, height, axial_load=...)"]),
        (rbsdem.section.springs(SECTION, 1.6, axial_load=744e3), ["a SectionSprings", "makes one"]),
        (COLUMN.flexure, ["must be a Column"]),
        (None, ["column = None must be a Column"]),
    ):
        with pytest.raises(InputError) as caught:
            use(thing)
        text = str(caught.value)
        assert len(text) < 200
        for word in ("must be a Column", *words):
            assert word in text


@pytest.mark.parametrize(
    "use", [peer.column, peer.predict_one, lambda thing: peer.predict([thing])]
)
def test_what_is_no_specimen_is_named_with_what_makes_its_column(use):
    with pytest.raises(InputError, match="a RectangularSection must be a Specimen") as caught:
        use(SECTION)
    assert "section.column(section, height, axial_load=...)" in str(caught.value)
    with pytest.raises(InputError, match=r"'zahn' must be a Specimen; .*read_specimens"):
        use("zahn")


def test_unknown_option_ends_a_batch_before_its_work():
    for use in (peer.predict_one, lambda s, **o: peer.predict([s], **o), peer.column):
        specimen = peer.Specimen("x", "rectangular", 1.6, 0.4, 0.4, 46.5e6, 744e3, 12)
        with pytest.raises(InputError, match=r"option restraind is not known.*mean restrained"):
            use(specimen, restraind=4)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"restrained": "x"}, "restrained = 'x'"),
        ({"round_core": "x"}, "round_core = 'x'"),
        ({"model_parameters": 0}, "model_parameters = 0 must be a ModelParameters"),
    ],
)
def test_arguments_of_a_section_column(given, words):
    with pytest.raises(InputError, match=words):
        rbsdem.section.column(SECTION, 1.6, axial_load=744e3, **given)


def test_values_of_no_kind_are_refused_by_name():
    thing = object()
    for use, words in (
        (lambda: rbsdem.section.diagram(SECTION, 744e3, tension=thing), "tension = <object"),
        (lambda: rbsdem.springs.Takeda(2e8, 3e-4, 6e7, 3e-3, 7e6, inner=thing), "inner = <object"),
        (lambda: RectangularSection(0.4, 0.4, Concrete(30e6), bars=0, cover=0.02), "bars = 0"),
        (
            lambda: rbsdem.time_history(COLUMN, [0, 1], ground_acceleration=[0, 1], initial=3),
            "initial = 3 must be a Result of this column, the path of a state or a dict",
        ),
    ):
        with pytest.raises(InputError, match=words):
            use()


def test_step_beyond_the_stability_limit_names_the_way_out():
    with pytest.raises(InputError, match=r"stability limit of rk4.*method = 'auto'"):
        rbsdem.time_history(COLUMN, [0, 1], ground_acceleration=[0, 1], method="rk4", dt=0.5)


def test_collapse_that_was_asked_for_is_no_warning():
    """Large rotations belong to a run that ends at `collapse_drift`; without it they are noted."""
    elastic = Elastic(1e6)
    column = rbsdem.Column(1.0, 100.0, elastic, elastic, axial_load=2e3, kinematics="pdelta")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = rbsdem.cyclic(column, displacement=[0.0, 0.6], collapse_drift=0.5)
    assert run.summary["status"] == "collapsed"
    assert run.summary["peak_rotation"] > 0.1
    with pytest.warns(AccuracyWarning, match="the rotation of a body goes beyond 0.1 rad"):
        rbsdem.cyclic(column, displacement=[0.0, 0.4])


def test_many_runs_are_warned_of_once():
    """Python shows a warning once for a line of code, if the text is the same."""
    code = """
import rbsdem
elastic = rbsdem.springs.Elastic(1e6)
column = rbsdem.Column(1.0, 100.0, elastic, elastic, axial_load=2e3, kinematics="pdelta")
for i in range(20):
    rbsdem.cyclic(column, displacement=[0.0, 0.3 + 0.01 * i])
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, timeout=60
    )
    assert done.stderr.count("AccuracyWarning") == 1


# ---- ground motions ------------------------------------------------------------------------------

ACCELERATION = np.round(0.1 * np.sin(np.arange(23) / 3.0), 5)
CASE = """&column height = 1.6, mass = 614.4 /
&shear rule = 'elastic', k = 7e8 /
&flexure rule = 'elastic', k = 2.5e8 /
&loading drive = 'ground_acceleration', file = 'motion.{ending}' /
&analysis method = 'newmark', dt = 0.01 /
"""


def at2(folder: Path, fourth: str, third: str = "ACCELERATION TIME SERIES IN UNITS OF G", cut=None):
    lines = ["PEER NGA STRONG MOTION DATABASE RECORD", "Somewhere, 1/1/1990, Station, 090"]
    numbers = [f"{value:15.7E}" for value in ACCELERATION[:cut]]
    rows = ["".join(numbers[i : i + 5]) for i in range(0, len(numbers), 5)]
    (folder / "motion.AT2").write_text("\r\n".join([*lines, third, fourth, *rows]) + "\r\n")
    (folder / "AT2.nml").write_text(CASE.format(ending="AT2"))


@pytest.mark.parametrize(
    "fourth", ["NPTS=     23, DT=   .0200 SEC", "   23   0.0200    NPTS, DT", "NPTS=23,DT=.02 SEC"]
)
def test_at2_file_drives_a_case_as_its_csv_does(tmp_path, fourth):
    at2(tmp_path, fourth)
    rows = "".join(f"{0.02 * i!r},{a!r}\n" for i, a in enumerate(ACCELERATION.tolist()))
    (tmp_path / "motion.csv").write_text("time_s,acceleration_g\n" + rows)
    (tmp_path / "csv.nml").write_text(CASE.format(ending="csv"))
    one, two = (rbsdem.read_case(tmp_path / f"{name}.nml") for name in ("AT2", "csv"))
    np.testing.assert_allclose(one.time, two.time, rtol=1e-14)
    np.testing.assert_array_equal(one.ground_acceleration, two.ground_acceleration)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"fourth": "NPTS= 24, DT= .02"}, "line 4 declares 24 values, but there are only"),
        ({"fourth": "NPTS= 22, DT= .02"}, "line 4 declares 22 values, but there are more"),
        ({"fourth": "NPTS= x, DT= .02"}, "line 4: .* must give the number of values, NPTS"),
        ({"fourth": "NPTS= 23, DT= 0"}, "line 4: .* the time step in s, DT"),
        ({"fourth": "NPTS= 23, DT= .02", "third": "VELOCITY TIME SERIES IN UNITS OF CM/S"},
         "must say ACCELERATION ... IN UNITS OF G"),
    ],
)  # fmt: skip
def test_at2_file_that_is_not_right(tmp_path, given, words):
    at2(tmp_path, **given)
    with pytest.raises(InputError, match=words):
        rbsdem.read_case(tmp_path / "AT2.nml")


FLEXURE = Takeda(k_c=2e9, d_c=4e-5, k_y=5e8, d_y=3.4e-4, k_u=6e7)
IN_KN = Takeda(k_c=2e6, d_c=4e-5, k_y=5e5, d_y=3.4e-4, k_u=6e4)
IN_MRAD = Bilinear(k=5e7, d_y=2.7, k_post=1e6)
SMALL_CYCLES = [0.004, 0.016, 0.04]


@pytest.mark.parametrize(
    ("flexure", "load", "amplitudes", "words"),
    [
        (FLEXURE, 744e3, SMALL_CYCLES, ""),
        (FLEXURE, 0.0, SMALL_CYCLES, ""),
        (Elastic(k=2e9), 744.0, SMALL_CYCLES, ""),
        (FLEXURE, 744.0, SMALL_CYCLES, "is hardly any beside the lateral strength"),
        (FLEXURE, -744e3, SMALL_CYCLES, "N is tension; compression is positive"),
        (IN_KN, 744e3, [4e-5], "the lateral strength of flexure, "),
        (IN_MRAD, 0.0, SMALL_CYCLES, "flexure does not yield before a rotation of 0.2 rad"),
        (FLEXURE, 744e3, [0.25, 0.5, 1, 2], "the top goes beyond half of the height"),
        (FLEXURE, 744e3, [4, 8, 16], "the top goes beyond half of the height"),
    ],
)
def test_numbers_in_other_units_are_told_once(tmp_path, run_cli, flexure, load, amplitudes, words):
    # Nothing here is an error: a case is judged by its own strength, stiffness and height.
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        column = rbsdem.Column(
            1.6, 614.4, Elastic(k=1e9), flexure, axial_load=load, kinematics="pdelta"
        )
        path = rbsdem.protocol(amplitudes, points=3)
        try:
            rbsdem.cyclic(column, displacement=path)
        except rbsdem.SolveError:
            assert flexure is IN_KN  # it falls under its load
        case = column.to_namelist()
    notes = [str(one.message) for one in told]
    assert len(notes) == (1 if words else 0)
    assert words in "".join(notes)
    values = ", ".join(map(str, amplitudes))
    (tmp_path / "a.nml").write_text(
        f"{case}\n&loading drive = 'displacement', amplitudes = {values}, points = 3 /\n"
    )
    for command in ("check", "run"):
        output = run_cli([command, "a.nml"], cwd=tmp_path)
        lines = (output.stdout + output.stderr).splitlines()
        found = [line.removeprefix("note: ") for line in lines if line.startswith("note: ")]
        if command == "check" or flexure is not IN_KN:
            assert found == notes


def test_an_area_is_no_diameter():
    bars = Layout(12, 314e-6, STEEL)
    with pytest.raises(InputError, match=r"bar_diameter = 0.000314 m is thinner .* 20 mm is 0.02"):
        RectangularSection(0.4, 0.4, Concrete(46.5e6), layout=bars, cover=0.013)


@pytest.mark.parametrize(
    ("call", "field"),
    [
        (lambda: rbsdem.Concrete(46.5), "concrete.fc"),
        (lambda: Elastic(-1.0), "elastic spring.k"),
        (lambda: rbsdem.Layout("many", 0.016, rbsdem.Steel(446e6)), "layout.number"),
        (lambda: rbsdem.protocol([]), "protocol.amplitudes"),
        (lambda: rbsdem.protocol([0.01, "x"]), "amplitudes"),
        (lambda: rbsdem.protocol([0.01, -0.02]), "loading.amplitudes"),
    ],
)
def test_an_input_error_knows_its_field(call, field):
    with pytest.raises(rbsdem.InputError) as caught:
        call()
    assert caught.value.field == field
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.faults, str(again)) == (caught.value.faults, str(caught.value))


def test_each_line_of_an_input_error_has_its_field():
    lines = "a b.nml line 4: k = 1 must be 2\nties: legs_across = 9 do not fit\nthere is no column"
    error = rbsdem.InputError(lines)
    assert [field for field, _ in error.faults] == ["k", "ties.legs_across", ""]
    assert rbsdem.InputError("no core is left", "section: cover").field == "section.cover"
