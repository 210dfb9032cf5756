"""A laboratory's own file: its layout is found, its mistakes are noticed, its force is made net."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem import InputError, peer, read_test

LENGTH, LOAD = 1.6, 744e3
TIME = np.linspace(0.0, 3.0, 90)
D = np.round(0.012 * TIME * np.sin(2 * np.pi * TIME), 6)
# A loop that takes up energy: the force is ahead of the displacement.
F = np.round(180e3 * np.tanh((D + 0.004 * np.cos(2 * np.pi * TIME) * (TIME > 0)) / 0.01), 1)


def comma(value: float) -> str:
    return f"{value:.6g}".replace(".", ",")


def point(value: float) -> str:
    return f"{value:.6g}"


def write(
    path: Path, head: str, separator: str, number=point, scale=(1e3, 1e-3), more=(), end=""
) -> Path:
    """Rows with the time, displacement, force, and what else there is."""
    rows = [
        separator.join([number(t), number(scale[0] * d), number(scale[1] * f), *more]) + end
        for t, d, f in zip(TIME, D, F, strict=True)
    ]
    text = head + "\n".join(rows) + "\n"
    path.write_bytes(text.encode("latin-1", "ignore") if "ğ" not in text else text.encode())
    return path


NAMED = {"pdelta_code": 2, "length": LENGTH}


@pytest.mark.parametrize(
    ("head", "separator", "number", "end", "given"),
    [
        ("time_s,displacement_mm,force_kN\n", ",", point, "", {}),
        ("# of a pump\n# t,disp [mm],load [kN]\n", ",", point, "", {}),
        ("Prüfung 7\nam 1.2.2020; 9:30\n\nZeit;Weg;Kraft\ns;mm;kN\n", ";", comma, "",
         {"columns": ("weg", "Kraft")}),
        ("t\tTop displacement (mm)\tLateral force (kN)\n", "\t", point, "\t", {}),
        ("t\td\tf\n", "\t", comma, "", {"units": ("mm", "kN")}),
        ("Test of a column\nthree columns, no names\n", " ", point, "",
         {"columns": (2, 3), "units": ("mm", "kN")}),
        ("", "   ", comma, "",
         {"columns": {"displacement": 2, "force": 3},
          "units": {"displacement": "mm", "force": "KN"}}),
        ("1;2;3\n4;5;6\n7;8;9\nt;d;f\n", ";", comma, ";",
         {"header": 4, "columns": ("d", "f"), "units": ("mm", "kN")}),
        ("t,d,F,M,strain\n(s),(mm),(kN),(kN-m),(mm/mm)\n", ",", point, ",1,2", {}),
        ("Time Disp Force\nsec mm kN\n", " ", point, "", {}),
        ("time,disp_mm,axial load_kN\n", ",", point, "", {"columns": (2, 3)}),
        ("Zeit;Weg [mm];Kraft [kN];Normalkraft [kN]\n", ";", comma, ";800", {}),
        ("tiempo,desplazamiento_mm,fuerza_kN\n", ",", point, "", {}),
        ("temps;déplacement (mm);effort (kN)\n", ";", point, "", {}),
        ("tempo;spostamento (mm);forza (kN)\n", ";", point, "", {}),
        ("zaman;yer değiştirme (mm);kuvvet (kN)\n".encode().decode(), ";", point, "", {}),
    ],
)  # fmt: skip
def test_layouts(tmp_path, head, separator, number, end, given):
    """Comments, titles, names, units below them; any separator; commas before decimals."""
    path = write(tmp_path / "test 7.txt", head, separator, number, end=end)
    test = read_test(path, **NAMED, **given)
    np.testing.assert_allclose(test.displacement, D, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(test.force, F, rtol=1e-5, atol=1e-3)
    assert test.name == "test 7"
    as_text = read_test(path.read_text("utf-8" if "ğ" in head else "latin-1"), **NAMED, **given)
    assert np.array_equal(as_text.force, test.force)
    assert (test.height, test.pdelta_code) == (LENGTH, 2)


@pytest.mark.parametrize(
    ("units", "scale"),
    [
        (("m", "N"), (1, 1)),
        (("cm", "MN"), (1e2, 1e-6)),
        (("inches", "kips"), (1 / 0.0254, 1 / 4448.2216)),
        (("in", "lbf"), (1 / 0.0254, 1 / 4.4482216)),
        (("mm", "tonf"), (1e3, 1 / 9806.65)),
        (("mm", "ton"), (1e3, 1 / 9806.65)),
        (("mm", "T"), (1e3, 1 / 9806.65)),
        (("mm", "kgf"), (1e3, 1 / 9.80665)),
        (("in", "klb"), (1 / 0.0254, 1 / 4448.2216)),
        (("%", "kN"), (100 / LENGTH, 1e-3)),
    ],
)
def test_units(tmp_path, units, scale):
    path = write(tmp_path / "t.csv", "t,d,f\n", ",", lambda value: repr(float(value)), scale)
    test = read_test(path, units=units, **NAMED)
    np.testing.assert_allclose(test.displacement, D, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(test.force, F, rtol=1e-7)


@pytest.mark.parametrize("separator", ["\t", " "])
def test_the_number_of_rows_of_a_peer_file_must_be_right(separator):
    """Title, number, rows in mm and kN; a row that is missing is no other kind of file."""
    rows = [f"{1e3 * d:.6g}{separator}{1e-3 * f:.6g}" for d, f in zip(D, F, strict=True)]
    for tail in ("", "\t"):
        text = "\n".join(["Test 7" + tail, f"{len(rows)}{tail}", *rows]) + "\n"
        test = read_test(text, **NAMED)
        np.testing.assert_allclose(test.force, F, rtol=1e-5, atol=1e-3)
        cut = text.replace(rows[40] + "\n", "", 1)
        with pytest.raises(
            InputError, match="line 2: declares 90 rows, but there are 89; the file"
        ):
            read_test(cut, units=("mm", "kN"), **NAMED)


def test_columns_of_texts_and_clocks_are_left_out_and_said(tmp_path):
    rows = "".join(f"2020-01-02 12:00:{i % 60:02d};{1e3 * d:.6g};ok;{1e-3 * f:.6g}\n"
                   for i, (d, f) in enumerate(zip(D, F, strict=True)))  # fmt: skip
    (tmp_path / "t.txt").write_text("clock;top_mm;remark;ram_kN\n" + rows)
    said = r"texts are left out: 'clock' has '2020-01-02 12:00:00'; 'remark' has 'ok'"
    for columns in (("top", "ram"), (2, 4), None):
        with pytest.warns(rbsdem.errors.RepairWarning, match=said) as caught:
            test = read_test(tmp_path / "t.txt", columns=columns, **NAMED)
        assert caught[0].filename == __file__
        np.testing.assert_allclose(test.displacement, D, rtol=1e-5)
        np.testing.assert_allclose(test.force, F, rtol=1e-5)
    with (
        pytest.raises(InputError, match="column 'remark' has texts, as 'ok', and no numbers"),
        pytest.warns(rbsdem.errors.RepairWarning),
    ):
        read_test(tmp_path / "t.txt", columns=("top", "remark"), **NAMED)


LVM = """\
LabVIEW Measurement\t
Separator\tTab
Multi_Headings\tNo
Date\t2020/01/02
***End_of_Header***\t
\t
Channels\t2\t\t
Samples\t90\t90\t
Date\t2020/01/02\t2020/01/02\t
Y_Unit_Label\tmm\tkN\t
X_Dimension\tTime\tTime\t
X0\t0.0000000000000000E+0\t0.0000000000000000E+0\t
Delta_X\t0.033708\t0.033708\t
***End_of_Header***\t\t\t
X_Value\tTop\tRam\tComment
"""
MTS = """\
MTS793|MPT|ENU|1|2|.|/|:|1|0|0|A
Data Acquisition: cyclic
Station Name:\tframe.cfg

Time\tTop\tRam\tAxial Count
Sec\tmm\tkN\tsegments
"""


@pytest.mark.parametrize(
    ("head", "separator", "number", "more", "end"),
    [
        (LVM, "\t", point, (), "\t"),
        (LVM, "\t", comma, (), "\t"),
        (MTS, "\t", point, ("1.5",), ""),
        ('"Time ","Top ","Ram "\n"sec ","mm ","kN "\n', ",", point, (), ""),
        ("Time,Top,Ram,gauge,T\ns,mm,kN,mV/V,degF\n", ",", point, ("0.5", "68.2"), ""),
    ],
    ids=["lvm", "lvm with commas", "mts", "mts in quotes", "unknown units"],
)
def test_exports_of_programs_are_read_by_names(tmp_path, head, separator, number, more, end):
    """A unit that is not known loses no names, and a column of remarks without one none."""
    path = write(tmp_path / "t.lvm", head, separator, number, more=more, end=end)
    test = read_test(path, columns=("Top", "Ram"), **NAMED)
    np.testing.assert_allclose(test.displacement, D, rtol=1e-5, atol=1e-9)
    np.testing.assert_allclose(test.force, F, rtol=1e-5, atol=1e-3)


@pytest.mark.parametrize(
    "head", ["t,d,f\ns,mm,kN\n1,2,3\n", "t,d_mm,f_kN\n0,1,2\n", "1,2,3\nt,d,f\ns,mm,kN\n"]
)
def test_numbers_of_channels_are_no_row(tmp_path, head):
    path = write(tmp_path / "t.csv", head, ",", lambda value: f"{value:.4f}")
    if head[0] == "t":
        with pytest.warns(rbsdem.errors.RepairWarning, match="numbers of channels are left out"):
            test = read_test(path, **NAMED)
    else:
        test = read_test(path, **NAMED)
    np.testing.assert_allclose(test.displacement, D, atol=1e-7)


@pytest.mark.parametrize("separator", ["\n", " ", ","])
def test_displacement_and_force_in_two_files(tmp_path, separator):
    """One value a line, or all in a line."""
    for name, head, values in (("d", "top_mm", 1e3 * D), ("f", "ram_kN", 1e-3 * F)):
        text = separator.join(map(repr, map(float, values)))
        (tmp_path / name).write_text(f"{head}\n{text}\n" if separator == "\n" else text)
    paths = {"displacement": tmp_path / "d", "force": tmp_path / "f"}
    units = {} if separator == "\n" else {"units": ("mm", "kN")}
    test = read_test(**paths, **units, **NAMED)
    np.testing.assert_allclose(test.displacement, D, rtol=1e-14)
    np.testing.assert_allclose(test.force, F, rtol=1e-14)
    (tmp_path / "f").write_text("1\n2\n")
    with pytest.raises(InputError, match="90 displacements and 2 forces"):
        read_test(**paths, units=("mm", "kN"), **NAMED)
    with pytest.raises(InputError, match="both displacement= and force="):
        read_test(displacement=tmp_path / "d", **NAMED)


def test_a_test_of_a_frame_has_no_code(tmp_path):
    path = write(tmp_path / "t.csv", "t,d_mm,f_kN\n", ",", lambda v: repr(float(v)))
    test = read_test(path, structure="frame", length=7.0)
    assert test.pdelta_code is None
    np.testing.assert_allclose(test.force, F, rtol=1e-14)
    assert test.drift.max() == pytest.approx(D.max() / 7.0)
    with pytest.raises(InputError, match="pdelta_code = 2 is a notion of tests of columns"):
        read_test(path, structure="frame", pdelta_code=2)
    with pytest.raises(InputError, match="drifts in per cent need length"):
        read_test(path, structure="frame", units=("%", "kN"))


def test_forces_of_another_unit_are_noticed():
    """kN for N is 1000 times; a model that is twice too strong is no slip."""
    with pytest.warns(rbsdem.errors.AccuracyWarning, match=r"1000 times apart; both are in N"):
        rbsdem.compare((D, F), (D, 1e-3 * F))
    assert rbsdem.compare((D, 2 * F), (D, F)).peak_ratio == pytest.approx(2.0)


def test_offset_of_the_first_row(tmp_path):
    """Refused until the user says what it is."""
    rows = np.column_stack((1e3 * D + 4, 1e-3 * F + 1))
    np.savetxt(tmp_path / "t.csv", rows, delimiter=",", header="d_mm,f_kN", comments="")
    with pytest.raises(
        InputError, match=r"first displacement is 0.004 m, 1. %.*zero=True.*or header= if"
    ):
        read_test(tmp_path / "t.csv", **NAMED)
    zeroed = read_test(tmp_path / "t.csv", zero=True, **NAMED)
    np.testing.assert_allclose(zeroed.displacement, D - D[0], atol=1e-12)
    np.testing.assert_allclose(zeroed.force, F - F[0], atol=1e-6)
    kept = read_test(tmp_path / "t.csv", zero=False, **NAMED)
    assert kept.displacement[0] == pytest.approx(D[0] + 0.004)
    assert read_test(tmp_path / "t.csv", checks=False, **NAMED).force[0] == kept.force[0]


@pytest.mark.parametrize("code", [1, 2, 3, 4])
def test_net_force_is_that_of_the_manual(tmp_path, code):
    path = write(tmp_path / "t.csv", "t,d_m,f_N\n", ",", lambda v: repr(float(v)), (1, 1))
    lengths = {"measured_length": 1.5, "top_length": 0.4, "bottom_length": 0.2, "length": LENGTH}
    test = read_test(path, pdelta_code=code, axial_load=LOAD, **lengths)
    d, lean = D * 2.0 / 1.5, 2.0 + 0.2
    expected = {
        1: F - LOAD * D / 1.5,
        2: F,
        3: F - LOAD * (d / lean) / np.sqrt(1 + (d / lean) ** 2),
        4: F + LOAD * D / 0.4,
    }[code]
    np.testing.assert_allclose(test.force, expected, rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(test.displacement, D * LENGTH / 1.5, rtol=1e-14)
    assert test.axial_height == pytest.approx(LENGTH if code == 4 else LENGTH + 0.4)


def test_it_goes_where_a_test_of_the_database_goes(tmp_path):
    """Compared, calibrated and drawn; without a length there is no drift."""
    column = rbsdem.peer.paper_columns("pdelta")["zahn_7"]
    d = column.height * rbsdem.protocol([0.005, 0.01], cycles=1, points=20)
    model = rbsdem.cyclic(column, displacement=d)
    np.savetxt(tmp_path / "t.txt", np.column_stack((1e3 * d, 1e-3 * model.force)), fmt="%.17g")
    test = read_test(tmp_path / "t.txt", units=("mm", "kN"), pdelta_code=2)
    assert math.isnan(test.length)
    found = rbsdem.compare(rbsdem.cyclic(column, displacement=test.displacement), test)
    assert found.nrmse < 1e-12
    assert found.peak_ratio == pytest.approx(1.0)
    pytest.importorskip("scipy")
    fit = rbsdem.calibrate(column, test, free=["flexure.k_u"])
    assert fit.nrmse < 1e-9
    pytest.importorskip("matplotlib")
    assert len(rbsdem.plot.loops_over_test(model, test).get_lines()) == 4


def test_checks_against_tests_of_the_database(peer_folder):
    """One reader with two doors; no false alarm on size, sign and order, and no miss of a sign.

    Exchanged columns are found by the loop's area or the sizes. Where the loops hardly take up
    energy they cannot be, and nothing else says it: few. Every sixth test stands for its series.
    """
    wrong = {"offset": 0, "other": 0}
    missed = {"sign": 0, "order": 0}
    tests = peer.read_specimens(peer_folder).with_history()[::6]
    for specimen in tests:
        given = {
            "pdelta_code": specimen.pdelta_code or 2,
            "length": specimen.length,
            "axial_load": specimen.axial_load,
            "measured_length": specimen.measured_length,
            "top_length": specimen.top_length,
            "bottom_length": specimen.bottom_length,
        }
        try:
            read_test(specimen.path, **given)
        except InputError as error:
            wrong["offset" if "the first" in str(error) else "other"] += 1
        test = read_test(specimen.path, zero=False, **given)
        same = specimen.test()
        assert np.array_equal(test.force, same.force)
        assert np.array_equal(test.displacement, same.displacement)
        for fault, change in (
            ("sign", {"force_sign": -1}),
            ("order", {"columns": (2, 1), "units": ("mm", "kN")}),
        ):
            try:
                read_test(specimen.path, zero=False, **{**given, **change})
                missed[fault] += 1
            except InputError:
                pass
    assert wrong["other"] == missed["sign"] == 0
    assert wrong["offset"] <= 0.06 * len(tests)
    assert missed["order"] <= 0.05 * len(tests)


def test_units_of_a_history_are_given_as_of_a_test(tmp_path):
    path = tmp_path / "t.csv"
    path.write_text("displacement,force\n0,0\n1,2\n3,4\n")
    for units, factors in {None: (1.0, 1.0), ("mm", "kN"): (1e-3, 1e3)}.items():
        test = rbsdem.peer.read_peer(path, units=units)
        assert test.displacement == pytest.approx([0.0, factors[0], 3 * factors[0]])
        assert test.force == pytest.approx([0.0, 2 * factors[1], 4 * factors[1]])
    for units in (("mm",), "mm", 3, ("mm", 1)):
        with pytest.raises(InputError, match="units"):
            rbsdem.peer.read_peer(path, units=units)
    with pytest.raises(InputError, match="furlong"):
        rbsdem.peer.read_peer(path, units=("furlong", "kN"))


def test_units_that_a_line_states_and_tons_beside_inches(tmp_path):
    """A unit beside another one above the rows is a slip, and tons are of two kinds."""
    path = write(tmp_path / "t.csv", "Units: kip in\nt,d,f\n", ",", point)
    with pytest.raises(InputError, match=r"'Units: kip in' is above .* displacement is read in mm"):
        read_test(path, units=("mm", "kN"), **NAMED)
    path = write(tmp_path / "t.csv", "Units: kN, mm\nt,d,f\n", ",", point)
    read_test(path, units=("mm", "kN"), **NAMED)
    path = write(tmp_path / "t.csv", "t,d (in),f (ton)\n", ",", point)
    with pytest.raises(InputError, match=r"'ton' beside inches may be 2000 lbf or the weight of"):
        read_test(path, **NAMED)


def test_names_of_channels_below_units_are_no_names(tmp_path):
    head = "t,d,f\ns,mm,kN\nCH001,CH002,CH003\n"
    path = write(tmp_path / "t.csv", head, ",", point)
    np.testing.assert_allclose(read_test(path, **NAMED).displacement, D, rtol=1e-5, atol=1e-9)
