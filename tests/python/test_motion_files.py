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
    ("csv, texts first", ".txt", rows([f"12:00:0{i} {a}" for i, a in enumerate(ONE)], "", " "),
     {"dt": 0.02, "units": "g"}, False),
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
        (rows(TWO, "UNITS: cubits\n"), {"units": "g"}, "the unit of 'UNITS: cubits' is not one of"),
        (rows(TWO, "Acc in milli-g\n"), {"units": "g"}, "the unit of 'Acc in milli-g' is not one"),
        (rows(TWO, "PGA = 3.2 cm/s2\n"), {}, "(does 'PGA = 3.2 cm/s2' state it?)"),
        (rows(TWO, "PGA = 3.2 cm/s2\n"), {"units": "g"}, "'PGA = 3.2 cm/s2' states 0.032 m/s2"),
        (rows(ONE, "9\n0.02\n"), {"units": "g"}, "no column with the time"),
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
        (rows([f"{20 * i} {a}" for i, a in enumerate(ONE)], "t,acc_g\n"), {}, "on by 20 s on av"),
        (rows([f"{i} {a}" for i, a in enumerate(ONE)]), {"units": "g", "dt": 0.02}, "by 1 s on av"),
        (rows(TWO, "time,vel\n"), {"units": "g"}, "no column is named after the acceleration"),
        (rows(TWO, "Scale factor 9.81\n", " "), {"units": "g"}, "may state a factor of the values"),
        (rows(TWO, "Uncorrected accelerogram\nGNS\n"), {"units": "g"}, "COSMOS, CSMIP or GeoNet"),
    ],
)  # fmt: skip
def test_what_contradicts_the_file_is_refused(text, options, said):
    with pytest.raises(InputError) as caught:
        motions.read_motion(text, **options)
    assert said in str(caught.value)
    if "no ground" in said:
        assert motions.read_motion(text, checks=False).pga == pytest.approx(300 * G)


#: Lines of other laboratories that state a unit, in no words that a list has.
STATED = {
    "m/s2": ["# Unidad: m/s2", "# Beschleunigung in m/s²", "Accélération (m.s-2)",
             "# amplitude m s-2", "Values in metres per second squared", "# ivme birimi: m/sn2",
             "#ACC_UNIT=m/s**2", "acc_mps2", "acceleration (ms^-2)", "# Ускорение (м/с²)",
             "acc/vel/disp: m/s2 / m/s / m", "acc/vel/disp: m/s2/m/s/m", "UNITS: SEC, M/SEC/SEC",
             "# m\u2044s²", "m/ss", "Ускорение в м/с2 (X)", "acc_ms2"],
    "cm/s2": ["#AmplitudeUnit: gal", "# Gal (cm/s/s)", "acceleration in gals", "Ivme (cm/sn2)",
              "# cm/(s^2)", "unit cm s^-2", "3 channels, in Gal", "units: gal/kine/cm",
              "UNITS=cm/s2/cm/s/cm", "Einheit: Gal", "Unité: cm/s²",
              "cm·s⁻²", "Ускорение (см/с2)", "Ускорение (Гал)", "acc_cmss", "# acc cms2",
             "# Acceleration, cm s$^{-2}$", "UNIDADES DE LOS DATOS : cm/s/s (Gal)",
             "# 加速度 单位：cm/s²", "acceleration in gal, G. Santos"],
    "g": ["# Unidad: g", "# fractions of gravity", "UNITS OF GRAVITY",
          "units: G", "UNITS: (g)", "Acc/Vel/Disp: g / cm/s / cm", "Einheit = g",
          "Acc/Vel/Disp: g/cm/s/cm", "# acc in g's", "in units of g, filtered", "# amplitudes [g]",
          "Aceleración en fracciones de g", "en unidades de 'g'", "Ускорение в долях g",
          "acceleration normalised by gravity", "values in gees", "divided by g", "a/g (-)"],
}  # fmt: skip


@pytest.mark.parametrize(
    "line",
    [
        "% of g",
        "percent g",
        "uGal",
        "Acceleration [10^-2 m/s^2]",
        "10^-3 g",
        "nm/s^2",
        "dm/s/s",
        "micrometers/s^2",
        "km/h/s",
    ],
)
def test_a_part_of_a_unit_is_refused(line):
    with pytest.raises(InputError, match=r"the unit of .* is not one of"):
        motions.read_motion(rows(ONE, f"Title\n{line}\n", " "), "g", dt=0.02)


@pytest.mark.parametrize(
    "line",
    ["fs=200", "SR=200", "Abtastrate 200", "Pas de temps 0.005", "sampling: 200", "1/200 s",
     "DELTA 0.005",
     "Tasa de muestreo 200", "Zeitschritt 0.005", "passo 0.005", "Interval: 0.005", "Δt = 0.005",
     "Fs:200Hz", "Passo 0,005 s", "MUESTRAS POR SEGUNDO: 200", "TASA DE MUESTREO : 200 m/s",
     "INTERVALO DE MUESTREO, C1-C6 (s) : /.005/.005/.005", "时间间隔：0.005s", "采样率200",
     "h = 0.005", "Частота 200 Гц", "interval waktu 0.005 detik",
     "bemonsteringsfrequentie 200", "時間間隔 0.005 秒", "every 5000 microseconds", "200 S/s",
     "tstep 0.005", "digitized at 200", "bandpass 0.1-25 Hz, 200 sps"],
)  # fmt: skip
def test_a_number_that_may_be_another_step_is_asked_for(line):
    text = rows(ONE, f"Title\n{line}\n", " ")
    with pytest.raises(InputError, match=r"step is 0.02 s, but .* may state 0.005 s"):
        motions.read_motion(text, "g", dt=0.02)
    assert motions.read_motion(text, "g", dt=0.005).dt == 0.005
    assert motions.read_motion(text, "g", dt=0.02, checks=False).dt == 0.02


@pytest.mark.parametrize(
    "line",
    ["NPTS 7", "Latitude 38.1", "Depth 12 km", "Vs30 = 250 m/s", "Filter: 0.05 Hz; 25 Hz",
     "Instrument freq 25 Hz", "Step 3 of 7", "Number of samples 7", "damping 0.05"],
)  # fmt: skip
def test_other_numbers_are_no_steps(line):
    assert motions.read_motion(rows(ONE, f"Title\n{line}\n", " "), "g", dt=0.02).dt == 0.02


@pytest.mark.parametrize("unit", STATED)
def test_a_unit_is_a_statement_in_any_words(unit):
    """It is taken, and another one that the caller gives is refused."""
    factor = motions.read.UNITS[unit] / G
    for line in STATED[unit]:
        for lines, options in ((in_unit(factor), {}), (ONE, {"dt": 0.02})):
            values = [row.split()[-1] for row in in_unit(factor)] if lines is ONE else lines
            text = rows(values, f"Title\n{line}\n", " ")
            for units in (None, unit):
                motion = motions.read_motion(text, units, **options)
                assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-14), line
            for other in set(STATED) - {unit}:
                with pytest.raises(InputError, match=f"are in {unit}, and units = '{other}'"):
                    motions.read_motion(text, other, **options)


@pytest.mark.parametrize(
    "line",
    ["# Muestreo: 50 Hz", "Paso: 0.02 s", "# Intervalo (s): 0.02", "50 muestras por segundo",
     "Abtastrate 50 Hz", "at 50 samples/s", "Fs = 50Hz", "# rate: 50 1/s",
     "Sampling rate: 0.05 kHz", "dt 20 ms", "sampling rate (samples/sec): 50",
     "Pas de temps : 20 ms", "DT: 2.0E-02", "spaced at 0.02 sec. intervals", "# 7 pts at 0.02 s"],
)  # fmt: skip
def test_a_rate_or_a_time_that_may_be_the_step_is_asked_for(line):
    for lines, options in ((ONE, {"dt": 0.02}), (TWO, {})):
        text = rows(lines, f"{line}\n", " ")
        assert motions.read_motion(text, "g", **options).dt == 0.02
    for dt in (0.01, 0.04):
        with pytest.raises(InputError, match=r"may state 0\.02 s|its step is 0\.02 s"):
            motions.read_motion(rows(ONE, f"{line}\n"), "g", dt)
    motion = motions.read_motion(rows(ONE, "# Muestreo: 50 Hz\n"), "g", 0.01, checks=False)
    assert motion.dt == 0.01


def test_the_executable_leaves_comments_with_units_to_python(file, tmp_path):
    case = tmp_path / "case.nml"
    case.write_text(
        "&column height = 2, mass = 1000 /\n&shear rule = 'elastic', k = 1e7 /\n"
        "&flexure rule = 'elastic', k = 1e7 /\n"
        "&loading drive = 'ground_acceleration', file = 'a.txt', unit = 'g', interval = 0.01 /\n"
    )
    # It knows a unit of one letter in brackets, if it is the one that is given.
    comments = [line for lines in STATED.values() for line in lines if line[0] == "#"]
    comments.remove("# amplitudes [g]")
    for line in [*comments, "# Muestreo: 50 Hz"]:
        file(rows(ONE, f"{line}\n"), "a.txt")
        with pytest.raises(InputError, match=r"that a comment states .* is not read"):
            rbsdem.read_case(case)
    file(rows(ONE, "# Station A, event 3\n"), "a.txt")
    assert rbsdem.read_case(case).ground_acceleration.max() == pytest.approx(0.3 * G)


@pytest.mark.parametrize(
    "line",
    ["# Filter: 0.1 - 40 Hz", "Duration 40 s", "Filtered HP=0.1 Hz LP=40.0 Hz", "Peak at 3.2 s",
     "Recorded 1994-01-17 12:30:55 at 34.21 N", "Vs30 760 m/s", "PGA = 0.3 g", "PGV 23 cm/s",
     "UNITED STATES GEOLOGICAL SURVEY", "University community station", "10/15/1979, 23:16:54 UTC"],
)  # fmt: skip
def test_other_numbers_of_a_head_state_nothing(line):
    for lines, options in ((ONE, {"dt": 0.02}), (TWO, {})):
        motion = motions.read_motion(rows(lines, f"{line}\n", " "), "g", **options)
        assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-14)


@pytest.mark.parametrize("width", [1, 3, 5])
@pytest.mark.parametrize("head", ["7\n0.02\n", "7 0.02\n", "Title\n7\n0.02\n", "7\n"])
def test_a_first_number_is_the_count_of_the_others(head, width):
    """Then a step below or beside it; one that is not their count is no acceleration either."""
    lines = (" ".join(ONE[i : i + width]) for i in range(0, len(ONE), width))
    dt = 0.02 if head == "7\n" else None
    motion = motions.read_motion(head + "\n".join(lines) + "\n", "g", dt)
    assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-14)
    assert motion.dt == 0.02
    with pytest.raises(InputError, match="first line, 31, may be the number of the values, but 30"):
        motions.read_motion("31\n" + "\n".join(["0.1", "0.2", "0.3"] * 10), "cm/s2", 0.02)


@pytest.mark.parametrize("width", [3, 5, 8])
def test_lines_of_values_without_a_head_are_one_record(width):
    """A smooth record goes on in the line, components go on below each other."""
    record = np.sin(0.3 * np.arange(100)) * np.exp(-0.01 * np.arange(100))
    lines = (" ".join(map(repr, record[i : i + width].tolist())) for i in range(0, 100, width))
    motion = motions.read_motion("\n".join(lines), "g", 0.01)
    assert motion.acceleration == pytest.approx(G * record, rel=1e-14)
    beside = np.column_stack([record * (i - 2.5) for i in range(width)])
    text = "\n".join(" ".join(map(repr, row)) for row in beside.tolist())
    with pytest.raises(InputError, match=f"has {width} columns without names"):
        motions.read_motion(text, "g", 0.01)


LVM = """\
LabVIEW Measurement\t
Decimal_Separator\t.
***End_of_Header***\t

Channels\t1\t
Samples\t7\t
Y_Unit_Label\tg\t
X_Dimension\tTime\t
X0\t0.0000000000000000E+0\t
Delta_X\t0.02\t
***End_of_Header***\t\t
X_Value\tTable\tComment
"""


def test_programs_of_laboratories_state_unit_and_step(file):
    """One channel, whose statements have as many fields as its rows; rows without a remark."""
    path = file(rows(TWO, LVM, "\t"), "t.lvm")
    motion = motions.read_motion(path)
    assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-14)
    assert motion.dt == 0.02
    with pytest.raises(
        InputError, match=r"times have a step of 0.02 s, and a line above says 0.01"
    ):
        motions.read_motion(rows(TWO, LVM.replace("0.02", "0.01"), "\t"))
    mts = "Running Time\tTable\nSec\tm/sec^2\nCH001\tCH002\n"
    motion = motions.read_motion(rows(in_unit(1 / G), mts, "\t"), column="Table")
    assert motion.acceleration == pytest.approx(G * np.array(VALUES), rel=1e-14)


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


@pytest.mark.parametrize("name", ["flag", "damage", "x"])
def test_ag_is_a_word_of_its_own(file, name):
    """A column beside the accelerations is not taken for them as its name ends like theirs."""
    text = f"time_s,a_m/s2,{name}\n" + "".join(f"{0.02 * i},{i},{-7 * i}\n" for i in range(9))
    motion = rbsdem.motions.read_motion(file(text, "m.csv"))
    assert motion.acceleration.tolist() == list(range(9))


def test_a_folder_is_read_in_the_order_of_names(file, tmp_path):
    file(NEW + ROWS, "b.AT2")
    file("time_s,acceleration_g\n0,1\n1,2\n", "a.csv")
    file("notes", "readme.md")
    assert [motion.name for motion in motions.read_motions(tmp_path)] == ["a", "b"]
    assert [motion.name for motion in motions.read_motions(tmp_path, pattern="b*")] == ["b"]


def test_a_list_and_a_readme_beside_records_are_left_out_and_told(file, tmp_path):
    """As the PEER database packs them."""
    file(NEW + ROWS, "RSN6_H1.AT2")
    file("PEER Ground Motion Database\nPlease cite.\n", "_readME.txt")
    file(
        "-- Summary of Metadata of Selected Records --\nResult ID,Scale Factor,Earthquake Name,"
        'Acc. Filename\n1,-,"Imperial Valley-02",RSN6_H1.AT2\n\n-- Scaled Spectra --\nPeriod (sec),'
        "RSN-6 pSa (g)\n0.01,0.28\n0.02,0.29\n0.03,0.31\n",
        "_SearchResults.csv",
    )
    file(NEW.replace("ACCEL", "VEL").replace("VELERATION", "VELOCITY") + ROWS, "RSN6.VEL.txt")
    file("", "RSN6.V2")
    said = "beside the records: .*holds a velocity.*_SearchResults.csv.*_readME.txt.*format .V2"
    with pytest.warns(RepairWarning, match=said):
        assert [motion.name for motion in motions.read_motions(tmp_path)] == ["RSN6_H1"]


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
