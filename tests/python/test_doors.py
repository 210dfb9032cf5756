"""The two doors: what the executable computes from a case, Python computes from the same case.

`read_case` brings a case to Python, by the executable's own reader; the rows must agree to the last
digit. What a run ends with (collapse, a note) is told through both.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import Bilinear, Compression, Elastic, PeakOriented, Pinching, Takeda

BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)

ELASTIC = "rule = 'elastic', k = 2e8"
CAPPED = "rule = 'peak_oriented', d_y = 4e-3, f_y = 2e5, d_cap = 2e-2, f_cap = 2.2e5, d_pc = 0.1"
SOFT = (
    ", f_res = 3e4, d_u = 0.15, d_c = 4e-4, f_c = 6e4, b0 = 0.4, lambda_s = 60, lambda_c = 70, "
    "lambda_k = 80, lambda_a = 90, c = 1.5, d_y_neg = 3e-3, f_y_neg = 1.9e5, d_cap_neg = 1.8e-2, "
    "f_cap_neg = 2e5, d_pc_neg = 0.2, f_res_neg = 2e4, d_u_neg = 0.16, d_c_neg = 3e-4, "
    "f_c_neg = 5e4"
)
# What carries the mass at the top is no part of the column.
HEAVY = "height = 3.0, mass = 9e3, top_mass = 2e4, gravity = 0"
GROUND = "drive = 'ground_acceleration', unit = 'g', amplitudes = 0.3, period = 0.4, points = 4"
VERTICAL = "drive = 'vertical_acceleration', unit = 'g', amplitudes = 0.2, period = 0.4, points = 4"
AXIAL = "drive = 'axial_load', unit = 'kN', amplitudes = 50, period = 0.4, points = 4"
FOLLOWS = ", axial_load = 2e5, axial_follows = T, force_follows = T"
FORCE = "drive = 'force', unit = 'kN', amplitudes = 40, period = 0.4, points = 4"

# Groups put into the minimal case, and what the column and the settings of the case must be.
CASES = {
    "static": ({}, {}, {}),
    "static, collapse not reached": (
        {"analysis": "collapse_drift = 0.05", "output": "every = 3"},
        {},
        {"collapse_drift": 0.05, "every": 3},
    ),
    "lengths and masses": (
        {"column": "n = 3, height = 3, lengths = 1.2, 1.0, 0.8, masses = 30, 20, 10"},
        {"n": 3, "height": 3.0, "mass": None, "lengths": (1.2, 1.0, 0.8), "masses": (30, 20, 10)},
        {},
    ),
    "springs of each joint": (
        {
            "column": "n = 2, height = 2, mass = 100",
            "shear": [ELASTIC + ", joint = 2", "rule = 'elastic', k = 1e8"],
        },
        {"n": 2, "shear": (Elastic(1e8), Elastic(2e8)), "flexure": TAKEDA},
        {},
    ),
    "capped springs": (
        {
            "column": "n = 2, height = 2, mass = 100",
            "shear": CAPPED.replace("peak_oriented", "pinching") + ", kappa_f = 0.4, kappa_d = 0.5",
            "flexure": [CAPPED + SOFT + ", joint = 1", ELASTIC],
        },
        {
            "shear": Pinching(4e-3, 2e5, 2e-2, 2.2e5, 0.1, kappa_f=0.4, kappa_d=0.5),
            "flexure": (
                PeakOriented(
                    4e-3,
                    2e5,
                    2e-2,
                    2.2e5,
                    0.1,
                    3e4,
                    0.15,
                    4e-4,
                    6e4,
                    0.4,
                    60,
                    70,
                    80,
                    90,
                    1.5,
                    3e-3,
                    1.9e5,
                    1.8e-2,
                    2e5,
                    0.2,
                    2e4,
                    0.16,
                    3e-4,
                    5e4,
                ),
                Elastic(2e8),
            ),
        },
        {},
    ),
    "axial load": (
        {
            "column": "height = 1.6, mass = 614.4, kinematics = 'pdelta', axial_load = 744e3, "
            "self_weight = T, gravity = 9.81",
        },
        {"kinematics": "pdelta", "axial_load": 744e3, "self_weight": True, "gravity": 9.81},
        {},
    ),
    "lumped mass and rotary inertia": (
        {
            "column": "n = 2, height = 3, mass = 9e3, top_mass = 2e4, gravity = 0, "
            "rotary_inertia = 5, 7"
        },
        {"top_mass": 2e4, "top_inertia": 0.0, "rotary_inertia": (5.0, 7.0), "depth": 0.0},
        {},
    ),
    "lumped inertia and depth": (
        {"column": HEAVY + ", top_inertia = 300, depth = 0.8"},
        {"top_mass": 2e4, "top_inertia": 300.0, "depth": 0.8, "rotary_inertia": None},
        {},
    ),
    "rk4 with both kinds of damping": (
        {
            "column": HEAVY,
            "damping": "mass = 0.4, stiffness = 2e-5",
            "loading": GROUND,
            "analysis": "method = 'rk4'",
        },
        {"damping": rbsdem.Damping(0.4, 2e-5)},
        {},
    ),
    "located events": (
        {"column": HEAVY, "loading": GROUND, "analysis": "method = 'rk4', events = 'located'"},
        {"damping": None},
        {"events": "located"},
    ),
    "beyond the stability limit": (
        {
            "column": HEAVY,
            "loading": "drive = 'ground_acceleration', amplitudes = 1e-6, period = 0.4, points = 4",
            "analysis": "method = 'rk4', dt = 0.1, duration = 0.2, allow_unstable = T",
        },
        {},
        {"dt": 0.1, "allow_unstable": True},
    ),
    "tangent damping": (
        {
            "column": HEAVY,
            "damping": "stiffness = 2e-5, tangent = T",
            "loading": GROUND,
            "analysis": "method = 'rk45', tolerance = 1e-7",
        },
        {"damping": rbsdem.Damping(stiffness=2e-5, tangent=True)},
        {"tolerance": 1e-7},
    ),
    "modal damping, one ratio": (
        {
            "column": "n = 2, " + HEAVY,
            "damping": "modal = 0.03",
            "loading": GROUND,
            "analysis": "method = 'rk45'",
        },
        {"damping": rbsdem.Damping(modal=0.03)},
        {},
    ),
    "modal damping of the first modes": (
        {
            "column": "n = 2, " + HEAVY,
            "damping": "modal = 0.03, 0.05",
            "loading": GROUND,
            "analysis": "method = 'rk45'",
        },
        {"damping": rbsdem.Damping(modal=(0.03, 0.05))},
        {},
    ),
    "newmark": (
        {"column": HEAVY, "loading": GROUND, "analysis": "method = 'newmark', dt = 0.01"},
        {},
        {"dt": 0.01},
    ),
    "hht": (
        {
            "column": HEAVY,
            "loading": GROUND,
            "analysis": "method = 'hht', rho_infinity = 0.7, dt = 0.01",
            "output": "every = 2",
        },
        {},
        {"dt": 0.01, "rho_infinity": 0.7, "every": 2},
    ),
    "generalised alpha": (
        {"column": HEAVY, "loading": GROUND, "analysis": "method = 'generalised_alpha'"},
        {},
        {},
    ),
    "auto": ({"column": HEAVY, "loading": GROUND, "analysis": "method = 'auto'"}, {}, {}),
    "finite with four loadings that act together": (
        {
            "column": "n = 2, kinematics = 'finite', "
            + HEAVY
            + ", axial_load = 2e5, self_weight = T",
            "axial_spring": "rule = 'compression', k = 1e9",
            "loading": [GROUND, VERTICAL, AXIAL, FORCE],
            "analysis": "method = 'rk45', duration = 0.3",
        },
        {"axial_spring": Compression(1e9)},
        {},
    ),
    "loads that follow": (
        {
            "column": "n = 2, kinematics = 'finite', " + HEAVY + FOLLOWS,
            "loading": FORCE,
            "analysis": "method = 'rk45'",
        },
        {"axial_follows": True, "force_follows": True},
        {},
    ),
    "openings of each joint": (
        {
            "column": "n = 2, kinematics = 'pdelta', " + HEAVY + ", axial_load = 2e5",
            "axial_spring": [
                "joint = 1, rule = 'bilinear', k = 1e9, d_y = 1e-3, k_post = 1e8",
                "joint = 2, rule = 'elastic', k = 2e9",
            ],
            "loading": VERTICAL,
            "analysis": "method = 'rk4'",
        },
        {"axial_spring": (Bilinear(1e9, 1e-3, 1e8), Elastic(2e9))},
        {},
    ),
    "openings and small rotations": (
        {
            "column": HEAVY + ", axial_load = 2e5",
            "axial_spring": "rule = 'elastic', k = 2e9",
            "loading": AXIAL,
            "analysis": "method = 'newmark'",
        },
        {"axial_spring": Elastic(2e9), "kinematics": "small"},
        {},
    ),
}


def rows_of(result: rbsdem.Result) -> dict[str, np.ndarray]:
    """Columns of a result by the names of the csv."""
    static = result.summary["analysis"] == "static"
    rows = {"step" if static else "time_s": result.time, "displacement_m": result.displacement}
    rows["force_N"] = result.force
    rows |= {f"{name}_J": values for name, values in result.energy.items()}
    rows["top_height_m"] = result.top[:, 1]
    joints = {"slip": "m", "rotation": "rad", "opening": "m", "shear": "N", "moment": "Nm"}
    joints["axial_force"] = "N"
    for name, unit in joints.items():
        if result.axial_force is None and name in ("opening", "axial_force"):
            continue
        for i, values in enumerate(getattr(result, name).T):
            rows[f"{name}_{i + 1}_{unit}"] = values
    if result.column.damped and not static:
        rows |= {"base_shear_N": result.base_shear, "base_moment_Nm": result.base_moment}
    return rows


def write(folder: Path, text: str) -> Path:
    path = folder / "case.nml"
    path.write_text(text, "utf-8")
    return path


@pytest.mark.parametrize("name", CASES)
def test_case_through_both_doors(run_cli, case_text, tmp_path, *, read_csv, name):
    groups, about, settings = CASES[name]
    path = write(tmp_path, case_text(**groups))
    result = run_cli(["run", "case.nml", "--quiet"], tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    rows = read_csv(tmp_path / "case.csv")
    case = rbsdem.read_case(path)
    assert case.title == "minimal"
    assert case.settings == settings
    for field, value in about.items():
        assert getattr(case.column, field) == value, field
    run = case.run()
    assert run.summary["status"] == "completed"
    own = rows_of(run)
    assert list(own) == list(rows)
    several = isinstance(groups.get("loading"), list) or "duration" in groups.get("analysis", "")
    for label, values in rows.items():
        if several:
            # Values at common times are interpolated, which rounds.
            scale = np.max(np.abs(values)) + (
                label.endswith("_J") * np.max(np.abs(rows["input_J"]))
            )
            np.testing.assert_allclose(own[label], values, atol=1e-8 * scale, err_msg=label)
        else:
            assert np.array_equal(own[label], values), label


def test_case_is_that_of_its_keywords(case_text, tmp_path):
    """Not only equal rows: the column is the one that is written by hand."""
    case = rbsdem.read_case(write(tmp_path, case_text()))
    assert case.column == rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA)
    assert case.method == "static"
    path = rbsdem.protocol(np.array([0.005, 0.01]) * 1.6, points=4)
    assert np.array_equal(case.displacement, path)
    assert np.array_equal(case.time, np.arange(path.size))
    assert case.force is case.ground_acceleration is None
    assert case.vertical_acceleration is case.axial_load is None


def test_case_runs_with_another_column_and_other_settings(dynamic_text, tmp_path):
    case = rbsdem.read_case(write(tmp_path, dynamic_text(analysis="method = 'rk4', dt = 2e-4")))
    rough = case.run(method="newmark", dt=None)
    assert rough.summary["method"] == "newmark"
    other = case.run(column=replace(case.column, n=2), every=1)
    assert other.slip.shape[1] == 2
    assert other.time.size == other.summary["steps"] + 1


def test_loadings_of_different_times_come_on_common_ones(dynamic_text, tmp_path):
    (tmp_path / "force.csv").write_text("time_s,force_kN\n0,0\n0.01,20\n0.03,-5\n0.04,0\n")
    (tmp_path / "ground.csv").write_text("t,acceleration_g\n0,0\n0.005,0.3\n0.02,-0.2\n0.05,0\n")
    loading = [
        "drive = 'force', file = 'force.csv'",
        "drive = 'ground_acceleration', file = 'ground.csv'",
    ]
    case = rbsdem.read_case(write(tmp_path, dynamic_text(loading=loading)))
    assert np.array_equal(case.time, [0, 0.005, 0.01, 0.02, 0.03, 0.04, 0.05])
    force = np.interp(case.time, [0, 0.01, 0.03, 0.04], [0, 20e3, -5e3, 0])
    np.testing.assert_allclose(case.force, force, rtol=1e-13)
    ground = 9.80665 * np.interp(case.time, [0, 0.005, 0.02, 0.05], [0, 0.3, -0.2, 0])
    np.testing.assert_allclose(case.ground_acceleration, ground, rtol=1e-13)
    # The points of the files themselves are not touched by interpolation.
    assert case.force[2] == 20e3
    assert case.ground_acceleration[1] == 0.3 * 9.80665
    text = dynamic_text(loading=loading, analysis="method = 'rk4', duration = 0.015")
    case = rbsdem.read_case(write(tmp_path, text))
    assert np.array_equal(case.time, [0, 0.005, 0.01, 0.015])
    assert case.force[-1] == pytest.approx(13750.0, rel=1e-13)


def test_columns_of_a_file_are_found_by_their_drives(case_text, tmp_path):
    """The third column of a PEER file is the axial load; a csv names its columns."""
    (tmp_path / "test.txt").write_text("Test\n3\n0 0 500\n1 2 600\n2 3 550\n")
    (tmp_path / "all.csv").write_text(
        "time_s,acceleration_g,vertical_g,axial_kN\n0,0,0,0\n1,0.1,0.2,30\n2,0,0,0\n"
    )
    column = "height = 1.6, mass = 614.4, kinematics = 'pdelta'"
    loading = [
        f"drive = '{d}', file = 'all.csv'"
        for d in ("axial_load", "ground_acceleration", "vertical_acceleration")
    ]
    text = case_text(column=column, loading=loading, analysis="method = 'rk4'")
    case = rbsdem.read_case(write(tmp_path, text))
    assert case.axial_load.tolist() == [0, 30e3, 0]
    assert case.ground_acceleration.tolist() == [0, pytest.approx(0.980665), 0]
    assert case.vertical_acceleration.tolist() == [0, pytest.approx(1.96133), 0]
    loading = "drive = 'axial_load', file = 'test.txt', interval = 0.1"
    text = case_text(column=column, loading=loading, analysis="method = 'rk4'")
    assert rbsdem.read_case(write(tmp_path, text)).axial_load.tolist() == [500e3, 600e3, 550e3]


def test_title_and_paths_with_letters_beyond_ascii(case_text, tmp_path):
    folder = tmp_path / "Säulen"
    folder.mkdir()
    (folder / "weg.csv").write_text("displacement_mm\n0\n8\n")
    loading = "drive = 'displacement', file = 'weg.csv'"
    path = write(folder, case_text(case="title = 'Säule Nr. 1'", loading=loading))
    case = rbsdem.read_case(path)
    assert case.title == "Säule Nr. 1"
    assert case.displacement.tolist() == [0.0, 0.008]


def test_case_of_10000_bodies_is_read(run_cli, case_text, tmp_path):
    n = 10_000
    lengths = ", ".join(["0.0016"] * n)
    text = case_text(
        column=f"n = {n}, height = 16, lengths = {lengths}, mass = 6e3, kinematics = 'pdelta', "
        "axial_load = 1e3",
        shear=[f"joint = {i + 1}, rule = 'elastic', k = {1e12 + i}" for i in range(n)],
        flexure=[f"joint = {i + 1}, rule = 'elastic', k = {1e12 + i}" for i in range(n)],
        axial_spring="rule = 'elastic', k = 1e12",
    )
    path = write(tmp_path, text)
    assert run_cli(["check", path]).stderr == ""
    column = rbsdem.read_case(path).column
    assert column.n == n
    assert column.unknowns == 3 * n
    assert column.flexure[-1].k == 1e12 + n - 1
    assert column.lengths[7] == 0.0016


# ---- openings, positions -------------------------------------------------------------------------


def test_result_without_openings_has_zeros_and_no_axial_forces():
    run = rbsdem.cyclic(
        rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=2), displacement=[0.01, -0.01]
    )
    assert run.opening.shape == (2, 2)
    assert not run.opening.any()
    assert run.axial_force is None
    assert np.array_equal(run.top, [[0.01, 1.6], [-0.01, 1.6]])


def test_top_of_the_column_by_the_level_of_kinematics():
    """Free vibration from a turn of one body: height l, l (1 - th^2/2), l cos(th)."""
    spring = Elastic(1e6), Elastic(1e4)
    initial = {"rotation": [0.09], "slip": [0.02]}
    heights = {"small": 2.0, "pdelta": 2 * (1 - 0.09**2 / 2), "finite": 2 * np.cos(0.09)}
    for kinematics, height in heights.items():
        column = rbsdem.Column(2.0, 100.0, *spring, kinematics=kinematics)
        run = rbsdem.time_history(column, [0.0, 1e-3], initial=initial, method="rk4")
        angle = np.sin(0.09) if kinematics == "finite" else 0.09
        assert run.top[0] == pytest.approx([0.02 + 2 * angle, height], rel=1e-14)
        assert run.top[0, 0] == run.displacement[0]


def test_openings_begin_in_equilibrium_or_where_they_are_put():
    spring = Elastic(1e8)
    column = rbsdem.Column(
        2.0,
        1e3,
        spring,
        spring,
        n=2,
        axial_spring=Elastic(1e8),
        axial_load=3e4,
        self_weight=True,
    )
    still = rbsdem.time_history(column, [0.0, 0.01], force=[0.0, 0.0], method="rk4")
    weight = 9.80665 * np.array([1e3, 500.0])
    np.testing.assert_allclose(still.axial_force, -(3e4 + weight) * np.ones((2, 1)), rtol=1e-12)
    np.testing.assert_allclose(still.opening, still.axial_force / 1e8, rtol=1e-12)
    np.testing.assert_allclose(still.top[:, 1], 2 + still.opening[0].sum(), rtol=1e-15)
    put = rbsdem.time_history(column, [0.0, 0.01], initial={"opening": [1e-3, 0.0]}, method="rk4")
    assert put.opening[0].tolist() == [1e-3, 0.0]
    moved = rbsdem.time_history(
        column, [0.0, 0.01], initial={"opening_velocity": [0.0, 0.5]}, method="rk4"
    )
    assert np.array_equal(moved.opening[0], still.opening[0])
    assert np.max(np.abs(moved.opening[1] - still.opening[1])) > 1e-4


# ---- ends of a run -------------------------------------------------------------------------------


def test_collapse_of_a_run_in_time_is_told_by_exit_code_and_status(
    run_cli, dynamic_text, tmp_path, read_csv
):
    text = dynamic_text(analysis="method = 'rk4', collapse_drift = 5e-6")
    path = write(tmp_path, text)
    for options in ([], ["--quiet"]):
        result = run_cli(["run", "case.nml", *options], tmp_path)
        assert result.returncode == 3
        assert bool(result.stdout) == (not options)
        match = re.fullmatch(
            r"rbsdem: collapsed at time (\S+) s: the top is at (\S+) m, beyond collapse_drift = "
            r"5e-06 of the height; the rows up to there are in case.csv\n",
            result.stderr,
        )
        assert match, result.stderr
        assert not (tmp_path / "case.csv.partial").exists()
        rows = read_csv(tmp_path / "case.csv")
        assert float(match[1]) == pytest.approx(rows["time_s"][-1], rel=1e-5)
        assert float(match[2]) == pytest.approx(rows["displacement_m"][-1], rel=1e-5)
        assert abs(rows["displacement_m"][-1]) >= 8e-6
        assert np.all(np.abs(rows["displacement_m"][:-1]) < 8e-6)
    run = rbsdem.read_case(path).run()
    assert run.summary["status"] == "collapsed"
    assert np.array_equal(run.displacement, rows["displacement_m"])


def test_collapse_of_a_static_path_is_told_by_exit_code_and_status(
    run_cli, case_text, tmp_path, read_csv
):
    path = write(tmp_path, case_text(analysis="collapse_drift = 0.009"))
    result = run_cli(["run", "case.nml", "--quiet"], tmp_path)
    assert result.returncode == 3
    rows = read_csv(tmp_path / "case.csv")
    # Four points on a quarter: 0.0025, 0.005, 0.0075 and 0.01 of the height in the second cycle.
    assert result.stderr.startswith("rbsdem: collapsed at step 20: the top is at 0.016 m, beyond ")
    assert rows["step"][-1] == 20
    run = rbsdem.read_case(path).run()
    assert run.summary["status"] == "collapsed"
    assert np.array_equal(run.force, rows["force_N"])


SOFT = {"shear": "rule = 'elastic', k = 7e8", "flexure": "rule = 'elastic', k = 2.5e8"}


@pytest.mark.parametrize("kinematics", ["small", "pdelta"])
def test_small_rotations_that_grow_large_are_noted(run_cli, case_text, tmp_path, kinematics):
    for drift, noted in ((0.09, False), (0.3, True)):
        loading = f"drive = 'displacement', amplitudes = {drift}, points = 1"
        column = f"height = 1.6, mass = 614.4, kinematics = '{kinematics}'"
        path = write(tmp_path, case_text(column=column, loading=loading, **SOFT))
        result = run_cli(["run", "case.nml"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        case = rbsdem.read_case(path)
        if not noted:
            assert "note" not in result.stdout
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                assert case.run().summary["peak_rotation"] < 0.1
            continue
        with pytest.warns(rbsdem.errors.AccuracyWarning) as caught:
            run = case.run()
        assert len(caught) == 1
        assert result.stdout.splitlines()[-1] == f"note: {caught[0].message}"
        angle = run.summary["peak_rotation"]
        assert angle == pytest.approx(np.max(np.abs(run.rotation)), rel=1e-12)
        for word in (f"'{kinematics}'", "'finite'", "th^2/6"):
            assert word in str(caught[0].message)


def test_note_of_large_rotations_is_right_about_the_error():
    """One body turned by 0.3 rad: the top of the exact one is at l sin(0.3)."""
    spring = Elastic(1e9), Elastic(1e4)
    error = 1 - np.sin(0.3) / 0.3
    column = rbsdem.Column(2.0, 100.0, *spring)
    with pytest.warns(rbsdem.errors.AccuracyWarning, match=r"about th\^2/6 of it") as caught:
        run = rbsdem.time_history(column, [0.0, 1e-4], initial={"rotation": [0.3]}, method="rk4")
    assert run.summary["peak_rotation"] ** 2 / 6 == pytest.approx(error, rel=0.02)
    # The warning stands at the caller's line, for filters by module.
    assert caught[0].filename == __file__


def test_finite_rotations_need_no_note():
    column = rbsdem.Column(2.0, 100.0, Elastic(1e9), Elastic(1e4), kinematics="finite")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = rbsdem.time_history(column, [0.0, 1e-3], initial={"rotation": [0.5]}, method="rk4")
    assert run.summary["peak_rotation"] == pytest.approx(0.5, rel=0.01)


def test_largest_rotation_is_that_of_all_steps():
    """Whichever rows are kept."""
    column = rbsdem.peer.paper_columns()["zahn_7"]
    path = [0.0, 0.01, 0.02, 0.01, 0.0, 0.0]
    runs = [rbsdem.cyclic(column, displacement=path, every=every) for every in (1, 5)]
    assert runs[0].summary["peak_rotation"] == np.abs(runs[0].rotation).max()
    assert runs[1].summary["peak_rotation"] == runs[0].summary["peak_rotation"]
    time = np.linspace(0.0, 0.1, 101)
    shaken = {"ground_acceleration": 30.0 * np.sin(60.0 * time), "method": "rk4"}
    runs = [rbsdem.time_history(column, time, **shaken, every=every) for every in (1, 10000)]
    assert runs[1].time.size == 2
    assert runs[1].summary["peak_rotation"] == np.abs(runs[0].rotation).max()


def test_modes_near_the_critical_load_are_noted(run_cli, case_text, tmp_path):
    """One body: the critical load is k_M/l."""
    load = 2.5e8 / 1.6 * (1 - 1e-6)
    column = "height = 1.6, mass = 614.4, kinematics = 'pdelta'"
    for axial, noted in ((load, True), (0.5 * load, False)):
        text = case_text(column=f"{column}, axial_load = {axial!r}", loading=None, **SOFT)
        write(tmp_path, text)
        printed = run_cli(["modes", "case.nml"], tmp_path).stdout.splitlines()
        notes = [line for line in printed if line.startswith("# note: ")]
        write(tmp_path, text + "&loading drive = 'force', amplitudes = 1 /\n")
        column_read = rbsdem.read_case(tmp_path / "case.nml").column
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            rbsdem.modes(column_read)
        assert [f"# note: {warning.message}" for warning in caught] == notes
        assert bool(notes) == noted
        assert printed[-1].startswith("# stable step")


def test_summary_says_the_method_and_why(run_cli, case_text, tmp_path):
    case = {"column": HEAVY, "loading": GROUND}
    for method in ("rk4", "rk45", "newmark", "hht", "generalised_alpha", "auto"):
        path = write(tmp_path, case_text(**case, analysis=f"method = '{method}'"))
        summary = rbsdem.read_case(path).run().summary
        printed = run_cli(["run", "case.nml"], tmp_path).stdout
        used, reason = summary["method"], summary["reason"]
        if method == "auto":
            assert used in ("rk4", "rk45", "newmark", "hht", "generalised_alpha")
            assert reason
            assert f"  method                        {used} ({reason})\n" in printed
            checked = run_cli(["check", "case.nml"], tmp_path).stdout
            assert checked == f"case.nml: no errors\nmethod: {used} ({reason})\n"
        else:
            assert (used, reason) == (method, "")
            assert f"  method                        {method}\n" in printed
        head = (tmp_path / "case.csv").read_text("utf-8").splitlines()[2]
        assert head.endswith(f"method: {used}, kinematics: small")


def test_failed_run_has_its_status():
    spring = Bilinear(1e6, 1e-3, 0.0)
    with pytest.raises(rbsdem.SolveError) as caught:
        rbsdem.cyclic(rbsdem.Column(1.6, 1.0, spring, Elastic(1e6)), force=[500.0, 2000.0])
    assert caught.value.result.summary["status"] == "failed"
