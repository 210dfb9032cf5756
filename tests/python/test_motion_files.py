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
NPTS=      7, DT=   .0200 SEC,
"""
OLD = """\
PEER STRONG MOTION DATABASE RECORD. PROCESSING BY PACIFIC ENGINEERING.
 IMPERIAL VALLEY 10/15/79 2316, EL CENTRO ARRAY #6, 230
 ACCELERATION TIME HISTORY IN UNITS OF G. FILTER POINTS: HP=0.1 Hz LP=40.0 Hz
    7    0.0200    NPTS, DT
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


TWO = [f"{0.02 * i:.2f} {a}" for i, a in enumerate(VALUES)]
ONE = [str(a) for a in VALUES]
LINES = NEW.splitlines()


def rows(lines: list[str], head: str = "", separator: str = ",") -> str:
    return head + "".join(f"{line.replace(' ', separator)}\n" for line in lines)


def in_unit(factor: float) -> list[str]:
    return [f"{0.02 * i:.2f} {a / factor!r}" for i, a in enumerate(VALUES)]


GAL = in_unit(0.01 / G)
AFAD = """\
STRONG GROUND MOTION RECORDS OF TURKIYE
PLACE                     : A
STATION ID                : 0905
NUMBER OF DATA            : 7
SAMPLING INTERVAL (sec)   : 0.020000
RAW PGA VALUES (gal)      : 392.3 (N-S)  1.0 (E-W)  2.0 (U-D)

 N-S         E-W         U-D
"""
ESM = """\
EVENT_NAME: A
EVENT_ID: 2
STATION_CODE: ACC
SAMPLING_INTERVAL_S: 0.020000
NDATA: 7
STREAM: HNE
UNITS: cm/s^2
PGA_CM/S^2: 392.3
DATA_TYPE: ACCELERATION
USER5:
"""
#: Kind, ending, text, options of `read_motion`, and whether the executable takes the file too.
FILES = [
    ("at2", ".AT2", NEW + ROWS, {}, True),
    ("at2, old", ".AT2", OLD + ROWS, {}, True),
    ("at2, windows", ".AT2", (NEW + ROWS).replace("\n", "\r\n"), {}, True),
    ("at2, tight", ".AT2", NEW.replace("=      7, DT=   .0200", "=7,DT=.02") + ROWS, {}, True),
    ("at2, blank lines", ".AT2", NEW + ROWS.replace("\n", "\n\n"), {}, True),
    ("at2, one line", ".AT2", NEW + " ".join(ROWS.split()), {}, True),
    ("at2, one value a line", ".AT2", NEW + "\n".join(ROWS.split()), {}, True),
    ("at2, exponents with D", ".AT2", NEW + ROWS.replace("E", "D"), {}, True),
    ("at2, as txt", ".txt", NEW + ROWS, {}, True),
    ("at2, step agrees", ".AT2", NEW + ROWS, {"dt": 0.02, "units": "g"}, True),
    *(
        (f"at2, {line}", ".AT2", "\n".join([*LINES[:3], line]) + "\n" + ROWS, {}, both)
        for line, both in {
            "NPTS= 7\nDT= .0200 SEC": False,
            "NPTS=7,DT=2.0E-2SEC": False,
            "0.0200 7 DT, NPTS": False,
            "7 0.0200 NPTS DT": True,
            "7 0.0200": False,
        }.items()
    ),
    ("at2, touching", ".AT2", NEW + ".1E-03-.200E-02 .300-.4 .5E-01-.6E-01 7.E-06\n", {}, False),
    ("at2, broken", ".AT2", NEW + ROWS.replace("-.2000000E-02", "-.2000000E\n-02"), {}, False),
    ("at2, broken sign", ".AT2", NEW + ROWS.replace("-.2000000E-02", "-\n.2000000E-02"), {}, False),
    *(
        (f"at2, {unit}", ".AT2", NEW.replace("OF G", f"OF {unit}")
         + " ".join(repr(a * G / value) for a in VALUES), {}, False)
        for unit, value in
        {"CM/S/S": 0.01, "CM/SEC**2": 0.01, "M/S^2": 1.0, "IN/SEC/SEC": 0.0254}.items()
    ),
    ("csv", ".csv", rows(TWO, "# A\ntime_s,acceleration_g\n"), {}, True),
    ("csv, unit agrees", ".csv", rows(TWO, "time_s,acceleration_g\n"), {"units": "G"}, True),
    ("csv, cm/s2", ".csv", rows(GAL, "time_s,acceleration_cm/s2\n"), {}, True),
    ("csv, mm/s2", ".csv", rows(in_unit(0.001 / G), "time_s,acceleration_mm/s2\n"), {}, True),
    ("csv, m/s2", ".csv", rows(in_unit(1 / G), "time_s,acceleration_m/s2\n"), {"units": "m/s^2"},
     True),
    ("csv, one column", ".csv", rows(ONE, "acceleration_g\n"), {"dt": 0.02}, True),
    ("csv, bare column", ".csv", rows(ONE), {"units": "g", "dt": 0.02}, True),
    ("csv, bare", ".csv", rows(TWO), {"units": "g"}, False),
    ("csv, blanks", ".txt", rows(TWO, "t acceleration_g\n", " "), {}, True),
    ("csv, other columns", ".csv",
     rows([f"{row} 7" for row in GAL], "time_s,acceleration_cm/s2,velocity_cm/s\n"), {}, True),
    ("csv, gal", ".csv", rows(GAL, "time_s,acceleration_gal\n"), {}, False),
    ("csv, commas at the end", ".csv",
     "\ufeff" + rows([f"{row} " for row in GAL], "t_s,acceleration_cm/s2\n"), {}, False),
    ("csv, names with units", ".txt", rows(GAL, "Time (s)  Acceleration (gal)\n", " "), {}, False),
    ("csv, decimal commas", ".csv",
     rows([row.replace(".", ",") for row in in_unit(1 / G)], "t;a\ns;m/s2\n", ";"), {}, False),
    ("csv, German", ".csv",
     rows([row.replace(".", ",") for row in in_unit(1 / G)], "Zeit;Beschleunigung [m/s²]\n", ";"),
     {}, False),
    ("csv, a clock and a word", ".csv",
     rows([f"12:00:0{i} {a} ok" for i, a in enumerate(ONE)], "clock,acceleration_g,note\n"),
     {"dt": 0.02}, False),
    ("csv, columns by name", ".csv", rows([f"{row} 7" for row in TWO], "time_s,ns_g,ew_g\n"),
     {"column": "NS"}, False),
    ("csv, columns by number", ".txt", rows([f"7 {row}" for row in ONE], "", " "),
     {"column": 2, "units": "g", "dt": 0.02}, False),
    *(
        (f"head, {head}", ".txt", rows([row.split()[-1] for row in GAL], f"{head}\n"),
         {"dt": 0.02}, False)
        for head in (
            "ACCELERATION (CM/SEC2)", "ACCELERATION TIME SERIES, CM/S/S", "# Units: cm/s2",
            "UNITS: cm/s^2", "STATION=A\nUNITS=GAL", "Sampling rate: 50 Hz\nAccelerations in gal",
        )
    ),
    ("head, step and rate", ".txt", rows(ONE, "Time step (ms) = 20\nUNITS: g\n"), {}, False),
    ("ESM", ".ASC", rows([row.split()[-1] for row in GAL], ESM), {}, False),
    ("AFAD", ".txt", rows([f"{row.split()[-1]} 7 8" for row in GAL], AFAD, "  "), {"column": "N-S"},
     False),
]  # fmt: skip


#: What the executable says of a file that it leaves to Python, or asks the user to state.
SAID = "of Python take more|name one with column|give the unit with|'' is empty"


@pytest.mark.filterwarnings("ignore:.*columns of texts:rbsdem.errors.RepairWarning")
@pytest.mark.parametrize(
    ("kind", "ending", "text", "options", "both"), FILES, ids=[row[0] for row in FILES]
)
def test_files_of_all_kinds_hold_the_same(file, tmp_path, kind, ending, text, options, both):
    """Through both doors: the same bits, or the executable says who reads the file."""
    path = file(text, f"record{ending}")
    motion = motions.read_motion(path, **options)
    assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-14)
    assert (motion.dt, motion.name) == (0.02, "record")
    assert np.array_equal(motions.read_motion(text, **options).acceleration, motion.acceleration)
    keys = f", unit = '{options['units'].lower().replace('^', '')}'" if "units" in options else ""
    if "dt" in options and "at2" not in kind:
        keys += f", interval = {options['dt']}"
    case = tmp_path / "case.nml"
    case.write_text(
        "&column height = 2, mass = 1000 /\n&shear rule = 'elastic', k = 1e7 /\n"
        "&flexure rule = 'elastic', k = 1e7 /\n"
        f"&loading drive = 'ground_acceleration', file = '{path.name}'{keys} /\n"
    )
    if both:
        read = rbsdem.read_case(case)
        assert np.array_equal(read.ground_acceleration, motion.acceleration)
        assert read.time == pytest.approx(motion.time, abs=1e-15)
    else:
        with pytest.raises(InputError, match=SAID):
            rbsdem.read_case(case)


KNET = """\
Origin Time       2011/03/11 14:46:00
Lat.              38.103
Long.             142.860
Depth. (km)       24
Mag.              9.0
Station Code      MYG004
Station Lat.      38.7292
Station Long.     141.0217
Station Height(m) 40
Record Time       2011/03/11 14:46:36
Sampling Freq(Hz) 100Hz
Duration Time(s)  300
Dir.              N-S
Scale Factor      2000(gal)/8388608
Max. Acc. (gal)   2699.890
Last Correction   2011/03/11 14:46:21
Memo.
"""
COUNTS = np.array([10, 20, -60, 40, 15, 5, 0, 2, -8, 6])


@pytest.mark.parametrize("ending", [".NS", ".EW2"])
def test_knet_is_scaled_and_its_mean_taken_off(file, ending):
    """Eight integers a line, times n (gal) / m of the head: the format of NIED."""
    lines = (" ".join(f"{count:8d}" for count in part) for part in (COUNTS[:8], COUNTS[8:]))
    path = file(KNET + "\n".join(lines) + "\n", f"MYG0041103111446{ending}")
    motion = motions.read_motion(path)
    gal = COUNTS * 2000 / 8388608
    assert motion.acceleration == pytest.approx(0.01 * (gal - gal.mean()), rel=1e-12, abs=1e-15)
    assert motion.dt == 0.01
    assert motion.description == ("MYG004 N-S 2011/03/11 14:46:36; mean of 0.0007153 gal taken off")
    for wrong in ({"units": "g"}, {"dt": 0.02}):
        with pytest.raises(InputError, match="the file says that its"):
            motions.read_motion(path, **wrong)
    assert [motion.name for motion in motions.read_motions(path.parent)] == [path.stem]


SPOILT = [f"{i * 0.01:.2f},{0.1 * (-1) ** i:.3f}" for i in range(12)]
WRONG = {
    "0.0,-1.#IND": "'-1.#IND' is not a number",
    "0.0,1.#QNAN": "'1.#QNAN' is not a number",
    "0.0,1.#INF": "'1.#INF' is not a number",
    "0.0,-nan(ind)": "'-nan(ind)' is not a number",
    "0.0,NaN": "'NaN' is not a finite number",
    "0.0,": "has 1 value",
    "0.0": "has 1 value",
    ",0.1": "'' is empty",
    "0.0,abc": "'abc' is not a number",
    "0.0,0.1,0.2": "has 3 values",
}


@pytest.mark.parametrize("wrong", WRONG)
@pytest.mark.parametrize("place", [0, 1, 2, 3, 5, 11])
@pytest.mark.parametrize("head", [0, 1])
def test_a_wrong_row_is_named_wherever_it_stands(wrong, place, head):
    """None is taken for a comment or a head, and none takes others away."""
    lines = ["time_s,acceleration_g"][:head] + SPOILT
    lines[place + head] = wrong
    with pytest.raises(InputError) as caught:
        motions.read_motion("\n".join(lines) + "\n", units="g")
    assert f"line {place + head + 1}" in str(caught.value)
    assert WRONG[wrong] in str(caught.value)


@pytest.mark.parametrize("wrong", ["NaN", "-1.#IND", "1.#INF", "abc", "# 0.1 0.2"])
def test_a_wrong_value_of_one_column_is_named(wrong):
    for place in (0, 1, 2, 3, 7):
        lines = [row.partition(",")[2] for row in SPOILT]
        if wrong.startswith("#"):
            lines[place] += f" {wrong}"
            motion = motions.read_motion("\n".join(lines), units="g", dt=0.01)
            assert motion.acceleration.size == len(SPOILT)
            continue
        lines[place] = wrong
        if (place, wrong) == (0, "abc"):
            continue  # It may be the name of the column.
        with pytest.raises(InputError, match=rf"line {place + 1}, value 1: '{wrong}' is not a"):
            motions.read_motion("\n".join(lines), units="g", dt=0.01)


@pytest.mark.parametrize(
    ("text", "options", "said"),
    [
        (rows(TWO, "UNITS: IN/SEC/SEC\n"), {"units": "g"}, "accelerations are in in/s2"),
        (rows(TWO, "ACCELERATION (CM/SEC2)\n", " "), {"units": "g"}, "accelerations are in cm/s2"),
        (rows(TWO, "Time (s)  Acc (gal)\n", " "), {"units": "g"}, "accelerations are in cm/s2"),
        (rows(TWO, "UNITS: cubits\n"), {"units": "g"}, "the unit 'cubits' of 'UNITS: cubits' is"),
        (rows(TWO, "UNITS: g\nACC UNIT: gal\n"), {}, "states the units g ('UNITS: g') and cm/s2"),
        (rows(TWO, "UNITS: gal\ntime_s,acceleration_g\n"), {}, "is in g, and a line above says cm"),
        (rows(ONE, "DT=0.01\nUNITS: g\n"), {"dt": 0.02}, "step is 0.01 s, and dt = 0.02 s was"),
        (rows(TWO, "DT=0.01\nUNITS: g\n"), {}, "times have a step of 0.02 s, and a line above"),
        (NEW + ROWS, {"dt": 0.01}, "step is 0.02 s, and dt = 0.01 s was"),
        (rows(TWO, "NPTS=14, DT=0.02\nUNITS: g\n"), {}, "7 rows, but 14 are stated"),
        ("Station: X\nUnits: g\n0.1\ne5\n0.2\n0.3\n0.1\n", {"dt": 0.02}, "'e5' is not a number"),
        (rows(ONE, ESM.replace("NDATA: 7", "NDATA: 70")), {}, "7 values, but NPTS = 70; the"),
        (rows(ONE, ESM.replace("ACCELERATION", "VELOCITY").replace("PGA_CM/S^2", "PGV").replace(
            "ACC", "A")), {}, "it says that it holds a velocity"),
        ("0.1 0.2 0.3 0.4 0.5 0.6 0.7 0.8\n" * 9, {"units": "g", "dt": 0.01}, "are one record"),
        (rows(TWO, "time_s,acceleration_g\n").replace("0.3", "300"), {}, "is 300 g; no ground has"),
        (rows(TWO, "Uncorrected accelerogram\nGNS\n"), {"units": "g"}, "COSMOS, CSMIP or GeoNet"),
    ],
)  # fmt: skip
def test_what_contradicts_the_file_is_refused(text, options, said):
    with pytest.raises(InputError) as caught:
        motions.read_motion(text, **options)
    assert said in str(caught.value)
    if "no ground" in said:
        assert motions.read_motion(text, checks=False).pga == pytest.approx(300 * G)


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
