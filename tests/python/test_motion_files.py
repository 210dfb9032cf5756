"""Files of ground motions: what is read, what is mended and told, and what is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import InputError, motions
from rbsdem.errors import RepairWarning

G = motions.STANDARD_GRAVITY

NEW = """\
PEER NGA STRONG MOTION DATABASE RECORD
Imperial Valley-06, 10/15/1979, El Centro Array #6, 230
ACCELERATION TIME SERIES IN UNITS OF G
NPTS=      7, DT=   .0050 SEC,
"""
OLD = """\
PEER STRONG MOTION DATABASE RECORD. PROCESSING BY PACIFIC ENGINEERING.
 IMPERIAL VALLEY 10/15/79 2316, EL CENTRO ARRAY #6, 230
 ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=40.0 Hz
    7    0.0050    NPTS, DT
"""
VALUES = [0.1e-3, -0.2e-2, 0.3, -0.4, 0.5e-1, -0.6e-1, 0.7e-5]
ROWS = """\
  .1000000E-03  -.2000000E-02   .3000000E+00  -.4000000E+00   .5000000E-01
 -.6000000E-01   .7000000E-05
"""


@pytest.fixture
def file(tmp_path):
    def write(text: str | bytes, name: str = "RSN159_H230.AT2") -> Path:
        path = tmp_path / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.mark.parametrize(
    "text",
    [
        NEW + ROWS,
        OLD + ROWS,
        (NEW + ROWS).replace("\n", "\r\n"),
        NEW.replace("NPTS=      7, DT=   .0050 SEC,", "NPTS= 7\nDT= .0050 SEC") + ROWS,
        NEW.replace("=      7, DT=   .0050 SEC,", "=7,DT=5.0E-3SEC") + ROWS,
        NEW + ROWS.replace("\n", "\n\n"),
        NEW + " ".join(ROWS.split()),
        NEW + "\n".join(ROWS.split()),
        NEW + ROWS.replace("E", "D"),
        NEW + "  .1000000E-03-.2000000E-02 .3000000-.4000000 .5000000E-01-.6000000E-01 7.E-06\n",
        NEW + ROWS.replace("-.2000000E-02", "-.2000000E\n-02"),
        NEW + ROWS.replace("-.2000000E-02", "-\n.2000000E-02"),
    ],
    ids=list("abcdefghijkl"),
)
def test_at2_files_of_all_kinds_hold_the_same(file, text):
    motion = motions.read_motion(file(text))
    assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-15)
    assert motion.dt == 0.005
    assert motion.name == "RSN159_H230"
    assert "10/15" in motion.description


def test_exponents_of_three_digits_have_no_letter(file):
    """Fortran leaves it out: 0.1-101 is 1e-102, and no pair of numbers."""
    text = NEW.replace("     7", "     3") + " .1000000-101 -.2000000E-02-.3000000+000\n"
    motion = motions.read_motion(file(text))
    assert motion.acceleration == pytest.approx(G * np.array([1e-102, -0.002, -0.3]), rel=1e-15)


def test_missing_values_at_the_end_are_told(file):
    path = file(NEW.replace("     7", "    10") + ROWS)
    with pytest.warns(RepairWarning, match=r"the last 3 of NPTS = 10 values are missing; the rec"):
        motion = motions.read_motion(path)
    assert motion.acceleration.size == 7


@pytest.mark.parametrize(("unit", "value"), [("CM/S/S", 0.01), ("CM/SEC**2", 0.01), ("M/S^2", 1.0)])
def test_at2_names_its_unit(file, unit, value):
    motion = motions.read_motion(file(NEW.replace("OF G", f"OF {unit}") + ROWS))
    assert motion.acceleration == pytest.approx(value * np.array(VALUES), rel=1e-15)


@pytest.mark.parametrize(
    "head", [NEW, OLD, NEW.replace("=      7, DT=   .0050 SEC,", "=7,DT=.005 SEC")]
)
def test_both_doors_read_the_same_at2(file, tmp_path, head):
    """A file in order is read by the executable's reader too, to the last bit."""
    path = file(head + ROWS)
    case = tmp_path / "case.nml"
    case.write_text(
        "&column height = 2, mass = 1000 /\n&shear rule = 'elastic', k = 1e7 /\n"
        "&flexure rule = 'elastic', k = 1e7 /\n"
        f"&loading drive = 'ground_acceleration', file = '{path.name}' /\n"
    )
    read = rbsdem.read_case(case)
    motion = motions.read_motion(path)
    assert np.array_equal(read.ground_acceleration, motion.acceleration)
    assert read.time == pytest.approx(motion.time, abs=1e-15)


@pytest.mark.parametrize(
    ("text", "options"),
    [
        ("# El Centro\ntime_s,acceleration_g\n0,0.1\n0.02,-0.2\n0.04,0.3\n", {}),
        ("Time (s); Acceleration [g]\n0;0.1\n0.02;-0.2\n0.04;0.3\n", {}),
        ("t\tacc\n5.00\t0.1\n5.02\t-0.2\n5.04\t0.3\n", {"units": "g"}),
        ("0 0.1\n0.02 -0.2\n0.04 0.3\n", {"units": "G"}),
        ("0.1\n-0.2\n0.3\n", {"units": "g", "dt": 0.02}),
        ("acceleration_g\n0.1\n-0.2\n0.3\n", {"dt": 0.02}),
        (
            "time_s,velocity_m/s,acceleration_cm/s2\n0,7,98.0665\n.02,7,-196.133\n.04,7,294.1995\n",
            {},
        ),
        ("t;a\ns;m/s2\n0;0,980665\n0,02;-1,96133\n0,04;2,941995\n", {}),
        ("time_s,acceleration_mm/s2\n0,980.665\n0.02,-1961.33\n0.04,2941.995\n", {}),
        ("time_s,acceleration_m/s2\n0,.980665\n0.02,-1.96133\n0.04,2.941995\n", {"units": "m/s^2"}),
        ("\ufefftime_s,acceleration_gal\n0,98.0665,\n.02,-196.133,\n.04,294.1995,\n", {}),
    ],
)
def test_csv_files_of_all_kinds_hold_the_same(file, text, options):
    motion = motions.read_motion(file(text, "motion.csv"), **options)
    assert np.array_equal(motions.read_motion(text, **options).acceleration, motion.acceleration)
    assert motion.acceleration == pytest.approx(G * np.array([0.1, -0.2, 0.3]), rel=1e-14)
    assert motion.dt == 0.02


def test_csv_with_uneven_times_is_interpolated_where_a_step_is_given(file):
    path = file("time_s,acceleration_g\n0,0\n0.1,1\n0.4,4\n", "uneven.csv")
    with pytest.raises(InputError, match=r"times are uneven: 0\.3 s from row 2 to row 3, but 0\.2"):
        motions.read_motion(path)
    motion = motions.read_motion(path, dt=0.1)
    assert motion.acceleration == pytest.approx(G * np.array([0.0, 1, 2, 3, 4]), rel=1e-12)


def test_a_written_motion_comes_back(tmp_path):
    motion = motions.synthetic(1)[0]
    path = tmp_path / f"{motion.name}.csv"
    motion.to_csv(path)
    assert motions.read_motion(path) == motion


def test_a_folder_is_read_in_the_order_of_names(file, tmp_path):
    file(NEW + ROWS, "b.AT2")
    file("time_s,acceleration_g\n0,1\n1,2\n", "a.csv")
    file("notes", "readme.md")
    assert [motion.name for motion in motions.read_motions(tmp_path)] == ["a", "b"]
    assert [motion.name for motion in motions.read_motions(tmp_path, pattern="b*")] == ["b"]


def test_all_bad_files_of_a_folder_are_told_at_once(file, tmp_path):
    file(NEW + ROWS, "a.AT2")
    file("", "b.AT2")
    file("time_s,acceleration\n0,1\n1,2\n", "c.csv")
    with pytest.raises(InputError) as caught:
        motions.read_motions(tmp_path)
    lines = str(caught.value).splitlines()
    assert len(lines) == 2
    assert "b.AT2: is empty" in lines[0]
    assert "c.csv: the file does not name the unit" in lines[1]
