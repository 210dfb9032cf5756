"""The two doors: what the executable computes from a case, Python computes from the same case.

`read_case` brings a case to Python, by the executable's own reader; `to_namelist` writes one. What
is written comes back bit for bit, and the rows of both agree to the last digit. What a run ends
with (collapse, a note) is told through both.
"""

from __future__ import annotations

import re
import warnings
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strategies import Rng, accepted, any_column, may_vary, motion, rules, spring, static_path

import rbsdem
from rbsdem.errors import AccuracyWarning
from rbsdem.run.case import Case
from rbsdem.section.parameters import parameters
from rbsdem.springs import Bilinear, ConcreteSpring, Elastic, Layered, SteelSpring, Takeda

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

BILINEAR = Bilinear(7.0387e8, 1.296e-4, 8.3185e6)
TAKEDA = Takeda(2.5428e8, 3.1891e-4, 6.2937e7, 2.7183e-3, 7.5772e6, b1=0.22)
LOADING = "&loading drive = 'displacement', amplitudes = 0.001 /\n"
METHODS = ("rk4", "rk45", "newmark", "hht", "generalised_alpha", "auto")
# What carries the mass at the top is no part of the column.
HEAVY = "height = 3.0, mass = 9e3, top_mass = 2e4, gravity = 0"
GROUND = "drive = 'ground_acceleration', unit = 'g', amplitudes = 0.3, period = 0.4, points = 4"
VERTICAL = "drive = 'vertical_acceleration', unit = 'g', amplitudes = 0.2, period = 0.4, points = 4"
AXIAL = "drive = 'axial_load', unit = 'kN', amplitudes = 50, period = 0.4, points = 4"
SOFT = {"shear": "rule = 'elastic', k = 7e8", "flexure": "rule = 'elastic', k = 2.5e8"}
FORCE = "drive = 'force', unit = 'kN', amplitudes = 40, period = 0.4, points = 4"


def near(rng: Rng, value: float) -> float:
    """A number with all its digits, of the size of another."""
    return float(value * rng.uniform(0.5, 1.5))


def some(rng: Rng, rule: str) -> rbsdem.springs.Spring:
    return spring(rng, rule, 2e5, 3e-3)


def write(folder: Path, text: str) -> Path:
    path = folder / "case.nml"
    path.write_text(text, "utf-8")
    return path


def read_back(folder: Path, text: str) -> Case:
    return rbsdem.read_case(write(folder, text))


def made(column: rbsdem.Column, method: str, title: str = "", **given: Any) -> Case:
    """A case by hand: histories by their names, and settings."""
    drives = ("displacement", "force", "ground_acceleration", "vertical_acceleration", "axial_load")
    loads = {name: given.pop(name, None) for name in drives}
    points = max(len(values) for values in loads.values() if values is not None)
    time = given.pop("time", np.arange(float(points)))
    return Case(title, column, method, time, **loads, settings=given)


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
        for i, values in zip(result.column.joint_numbers, getattr(result, name).T, strict=True):
            rows[f"{name}_{i}_{unit}"] = values
    if result.column.damped and not static:
        rows |= {"base_shear_N": result.base_shear, "base_moment_Nm": result.base_moment}
    return rows


def run_of(case: Case) -> tuple[rbsdem.Result, str]:
    """Result of a case, up to where it fails, and what is said then."""
    try:
        return case.run(), ""
    except rbsdem.SolveError as error:
        return error.result, str(error)


def both(run_cli, read_csv, folder: Path, case: Case) -> rbsdem.Result:
    """Result of a case; the executable ends as it does, with the same rows, to the last digit."""
    printed = run_cli(["run", "case.nml", "--quiet"], folder)
    result, error = run_of(case)
    assert error in printed.stderr
    status = result.summary["status"]
    assert printed.returncode == ["completed", "failed", "", "collapsed"].index(status)
    rows = read_csv(folder / ("case.csv.partial" if status == "failed" else "case.csv"))
    own = rows_of(result)
    assert list(own) == list(rows)
    for label, values in rows.items():
        np.testing.assert_array_equal(own[label], values, err_msg=label)
    if status == "completed":  # the csv of Python is the same
        result.to_csv(folder / "python.csv")
        heads = [
            (folder / name).read_text("utf-8").splitlines()[:4]
            for name in ("case.csv", "python.csv")
        ]
        assert heads[0] == heads[1]
        np.testing.assert_equal(read_csv(folder / "python.csv"), rows)
    return result


@pytest.mark.parametrize("seed", range(10))
def test_columns_come_back_from_text(tmp_path, seed):
    rng = np.random.default_rng(seed)
    for _ in range(30):
        column = any_column(rng, in_time=True)
        if rng.random() < 0.3:
            column = replace(column, model='it\'s "mine", 2026.1 / & !')
        text = column.to_namelist()
        assert max(map(len, text.splitlines())) <= 132
        case = read_back(tmp_path, text + LOADING)
        assert case.column == column
        assert case.column.to_namelist() == text


@pytest.mark.parametrize("rule", sorted({*rules("flexure"), *rules("axial")}))
def test_springs_of_every_rule_come_back(tmp_path, rule):
    """Also those whose numbers have all their digits, alone and beside others."""
    rng = np.random.default_rng(11)
    place = "flexure" if rule in rules("flexure") else "axial_spring"
    for _ in range(20):
        springs = {"shear": some(rng, "elastic"), "flexure": some(rng, "elastic")}
        springs[place] = [some(rng, name) for name in (rule, "elastic", rule)]
        column = rbsdem.Column(3.0, 600.0, n=3, **springs)
        back = read_back(tmp_path, column.to_namelist() + LOADING).column
        assert back == column
        path = np.cumsum(rng.uniform(-2e-3, 2e-3, 30))
        for one, other in zip(column.joints(place), back.joints(place), strict=True):
            assert np.array_equal(one.response(path), other.response(path), equal_nan=True)


def random_case(rng: Rng) -> Case:
    """A column with a path, or with loads in time by any method."""
    while True:
        column = any_column(rng, in_time=True)
        title = ["", 'it\'s "quoted" / & !', "Säule 1 — Nr. ½"][rng.integers(3)]
        settings = {"every": int(rng.integers(1, 5))} if rng.random() < 0.5 else {}
        settings |= {"collapse_drift": 0.03} if rng.random() < 0.3 else {}
        if rng.random() < 0.4:
            return made(column, "static", title, **static_path(rng, column), **settings)
        if column.top == "fixed" and not column.top_mass:
            continue  # it has no motion
        found = motion(rng, column)
        if found is None:
            continue
        loads, solver = found
        size = np.sin(np.arange(loads["time"].size))
        matters = column.kinematics != "small" or column.axial_spring
        if rng.random() < 0.4 and matters and may_vary(column, solver):
            loads |= {"vertical_acceleration": size, "axial_load": column.axial_load + 10 * size}
        method = solver.pop("method")
        if rng.random() < 0.2 and method == "rk45":
            method = "auto"
        if method in ("rk45", "auto"):
            solver |= {"tolerance": 1e-5}
        if method == "rk4" and rng.random() < 0.3:
            solver |= {"allow_unstable": True}
        return made(column, method, title, **loads, **solver, **settings)


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
@pytest.mark.parametrize("seed", range(12))
def test_cases_come_back_and_run_alike(tmp_path, run_cli, read_csv, seed):
    rng = np.random.default_rng(100 + seed)
    for _ in range(5):
        case = random_case(rng)
        text = case.to_namelist()
        back = read_back(tmp_path, text)
        assert back == case
        assert back.to_namelist() == text
        assert both(run_cli, read_csv, tmp_path, back) == run_of(case)[0]


def test_equal_springs_are_stated_once(tmp_path):
    rng = np.random.default_rng(3)
    one, two = some(rng, "layered"), some(rng, "takeda")
    column = rbsdem.Column(
        5.0, 600.0, some(rng, "elastic"), [one, two, one, two, one], n=5, kinematics="pdelta"
    )
    text = column.to_namelist()
    assert text.count("&flexure") == 2
    assert text.count("&layers") == 1
    assert "joint = 1, 3, 5" in text
    assert "joint = 2, 4" in text
    assert text.count("&layer_spring") == len({spring for _, spring in one.layers})
    assert read_back(tmp_path, text + LOADING).column == column


def test_histories_of_files_and_long_ones_come_back_in_the_text(tmp_path, case_text):
    (tmp_path / "f.csv").write_text("time_s,force_kN\n0,0\n0.1,20\n0.25,-7\n")
    (tmp_path / "g.csv").write_text("time_s,acceleration_g\n0,0.1\n0.2,-0.3\n0.3,0\n")
    loading = ["drive = 'force', file = 'f.csv'", "drive = 'ground_acceleration', file = 'g.csv'"]
    settings = "method = 'newmark', duration = 0.28, dt = 0.01"
    case = read_back(tmp_path, case_text(loading=loading, analysis=settings))
    assert "file" not in case.to_namelist()
    assert read_back(tmp_path, case.to_namelist()) == case
    values = np.random.default_rng(1).normal(size=50_000) * 1e-3
    extremes = np.array([0.0, 5e-324, -2.2e-308, 1 / 3, 0.1 + 0.2, np.nextafter(1, 2), 1e22])
    column = rbsdem.Column(1.0, 1.0, Elastic(1e8), Elastic(1e8))
    for path in (values, extremes):
        back = read_back(tmp_path, made(column, "static", displacement=path).to_namelist())
        assert np.array_equal(back.displacement, path)


def drawn_steel(rng: Rng) -> rbsdem.Steel:
    fy = near(rng, 4e8)
    return (
        rbsdem.Steel(fy, 1.3 * fy, eps_u=near(rng, 0.1)) if rng.random() < 0.5 else rbsdem.Steel(fy)
    )


def drawn_section(rng: Rng) -> rbsdem.Section:
    """Any shape, bars laid out or one by one, of steels alike or not."""
    strength = rng.uniform(2e7, 9e7)
    given: dict[str, Any] = {
        "concrete": rbsdem.Concrete(strength, 3e6 if rng.random() < 0.3 else None),
        "cover": float(rng.uniform(0.01, 0.04)),
    }
    round_, hollow = rng.random() < 0.4, rng.random() < 0.3
    size, bar = float(rng.uniform(0.5, 1.2)), float(rng.uniform(0.012, 0.025))
    hoop = {"diameter": float(rng.uniform(0.006, 0.012)), "spacing": float(rng.uniform(0.05, 0.2))}
    if rng.random() < 0.3:
        given["bar_diameter"] = near(rng, 0.02)
    if hollow:
        given["wall"] = 0.25 * size
    if round_:
        given["layout"] = rbsdem.Layout(int(rng.integers(6, 21)), bar, drawn_steel(rng))
        given["spiral"] = rbsdem.Spiral(
            **hoop, steel=drawn_steel(rng), hoops=bool(rng.random() < 0.5)
        )
        kind = rbsdem.CircularSection
        return kind(size, **given)
    legs = float(rng.uniform(2, 5))
    given["ties"] = rbsdem.Ties(
        **hoop, steel=drawn_steel(rng), legs=legs, legs_across=2.0 if rng.random() < 0.5 else None
    )
    if rng.random() < 0.3 and not hollow:
        given["bars"] = [
            (float(y), near(rng, 4e-4), drawn_steel(rng))
            for y in (-0.17, -0.05, 0.08, 0.17) for _ in range(2)
        ]  # fmt: skip
    else:
        between = {"between_diameter": 0.8 * bar, "between_steel": drawn_steel(rng)}
        given["layout"] = rbsdem.Layout(
            int(rng.choice([8, 12, 16])), bar, drawn_steel(rng), face=int(rng.integers(2, 5)),
            **(between if rng.random() < 0.5 else {}),
        )  # fmt: skip
    if rng.random() < 0.3:
        given["side_cover"] = 0.03
    kind = rbsdem.RectangularSection
    return kind(size, size, **given)


def drawn_column(rng: Rng) -> rbsdem.Column:
    section = drawn_section(rng)
    given: dict[str, Any] = {"top": "fixed" if rng.random() < 0.3 else "free"}
    if rng.random() < 0.3:
        given["restrained"] = 6
    if rng.random() < 0.5:
        values = {"wear": near(rng, 0.08), "shear_strength": near(rng, 1.0)}
        given["model_parameters"] = parameters().with_values(**values)
    if rng.random() < 0.3:
        given["footing"] = rbsdem.Footing(some(rng, "elastic"), some(rng, "elastic"))
    load = rng.uniform(0.02, 0.3) * section.gross_area * section.concrete.fc
    height = section.depth * rng.uniform(3, 6)
    return rbsdem.section.column(
        section, height, axial_load=load, n=int(rng.integers(2, 4)), **given
    )


@pytest.mark.filterwarnings("ignore::rbsdem.errors.AccuracyWarning")
@pytest.mark.parametrize("seed", range(4))
def test_a_drawing_comes_back(tmp_path, run_cli, read_csv, seed):
    """The column, what its layers stand for, and what follows when the drawing is changed."""
    rng, reached = np.random.default_rng(seed), set()
    for number in range(12):
        column = accepted(lambda: drawn_column(rng))
        path = column.height * rbsdem.protocol([0.004, 0.012], points=3)
        case = made(column, "static", displacement=path)
        back = read_back(tmp_path, case.to_namelist())
        assert back == case
        assert back.to_namelist() == case.to_namelist()
        section = column.drawing.section
        thicker = {"cover": 1.05 * section.cover}
        assert replace(back.column.drawing.section, **thicker) == replace(section, **thicker)
        one, other = back.run(openings=True), case.run(openings=True)
        assert list(one.limit_states()) == list(other.limit_states())
        reached |= set(one.limit_states().names())
        if number == 0:
            both(run_cli, read_csv, tmp_path, back)
    assert {"cracking", "first_yield"} <= reached


def drawn_text(**changes: str) -> str:
    bars = rbsdem.Layout(12, 0.016, rbsdem.Steel(446e6))
    ties = rbsdem.Ties(0.007, 0.085, rbsdem.Steel(364e6), legs=4)
    section = rbsdem.RectangularSection(
        0.4, 0.4, rbsdem.Concrete(46.5e6), layout=bars, ties=ties, cover=0.013
    )
    text = rbsdem.section.column(section, 1.6, axial_load=744e3).to_namelist() + LOADING
    for old, new in changes.items():
        found = {"drawing": r"&drawing[^/]*/\n", "layout": r"&layout[^/]*/\n"}.get(old, old)
        assert re.search(found, text)
        text = re.sub(found, new, text)
    return text


@pytest.mark.parametrize(
    ("old", "new"), [("b0 = 0.5", "b0 = 0.4"), ("width = 0.4", "width = 0.41")]
)
def test_springs_that_are_not_as_drawn_are_told(tmp_path, old, new):
    with pytest.warns(AccuracyWarning, match="shear.* other than layered 2026.8 draws"):
        case = read_back(tmp_path, drawn_text(**{old: new}))
    assert ("flexure" in case.column.replaced) == (old == "width = 0.4")


def test_a_case_under_another_load_keeps_its_springs(tmp_path):
    """As the executable does, which cannot draw: its answer would be another one."""
    text = drawn_text()
    with pytest.warns(AccuracyWarning, match="drawn for axial_load = 744000 N, and its col"):
        case = read_back(tmp_path, text.replace("axial_load = 744000", "axial_load = 700000", 1))
    assert type(case.column) is rbsdem.Column
    assert case.column.joints("shear") == read_back(tmp_path, text).column.joints("shear")


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


STRIP = "rule = 'concrete', k = 2e9, f_peak = 6e5, d_peak = 6e-4, k_soft = 4e7, f_res = 2e5"
LAYER_SPRINGS = [f"id = 1, {STRIP}", "id = 2, rule = 'steel', k = 6e8, f_y = 5.4e5, k_post = 6e6"]
LAYERS = "y = -0.05, 0.05, -0.16, 0.16, spring = 1, 1, 2, 2"
PLACES = (-0.05, 0.05, -0.16, 0.16)
BLOCK, BAR = ConcreteSpring(2e9, 6e5, 6e-4, 4e7, 2e5), SteelSpring(6e8, 5.4e5, 6e6)
JOINT = Layered(list(zip(PLACES, (BLOCK, BLOCK, BAR, BAR), strict=True)))
RIGID = Layered(list(zip(PLACES, (BLOCK, BLOCK, Elastic(6e8), Elastic(6e8)), strict=True)))
TWO = "n = 2, height = 2, mass = 100"
ELASTIC = "rule = 'elastic', k = 1e8"
#: Groups of a case, and the springs of its joints.
FORMS = {
    "shear of one joint and of the others": (
        {"column": TWO, "shear": ["rule = 'elastic', k = 2e8, joint = 2", ELASTIC]},
        {"shear": (Elastic(1e8), Elastic(2e8)), "flexure": TAKEDA},
    ),
    "layers of all joints": (
        {"column": TWO, "flexure": "rule = 'layered'", "layers": LAYERS},
        {"flexure": JOINT},
    ),
    "joints in lists": (
        {
            "column": TWO,
            "flexure": "rule = 'layered', joint = 2, 1",
            "layers": f"joint = 1, 2, {LAYERS}",
        },
        {"flexure": JOINT},
    ),
    "layers of one joint": (
        {
            "column": TWO,
            "flexure": ["rule = 'layered'", f"joint = 2, {ELASTIC}"],
            "layers": f"joint = 1, {LAYERS}",
        },
        {"flexure": (JOINT, Elastic(1e8))},
    ),
    "one rule, layers of their own": (
        {
            "column": TWO,
            "flexure": "rule = 'layered'",
            "layer_spring": ["id = 7, rule = 'elastic', k = 6e8", *LAYER_SPRINGS],
            "layers": [
                "joint = 2, " + LAYERS.replace("2, 2", "7, 7"),
                f"joint = 1, {LAYERS}",
            ],
        },
        {"flexure": (JOINT, RIGID)},
    ),
}


@pytest.mark.parametrize("name", FORMS)
def test_forms_in_which_springs_are_given(run_cli, case_text, tmp_path, *, read_csv, name):
    groups, springs = FORMS[name]
    if "layers" in groups:
        groups = {"layer_spring": LAYER_SPRINGS} | groups
    case = read_back(tmp_path, case_text(**groups))
    for place, expected in springs.items():
        several = expected if isinstance(expected, tuple) else (expected,) * 2
        assert case.column.joints(place) == several
    both(run_cli, read_csv, tmp_path, case)


def test_forms_of_true_and_false(case_text, tmp_path):
    for word, value in {".true.": True, "T": True, "t": True, ".FALSE.": False, "F": False}.items():
        column = f"height = 2, mass = 100, kinematics = 'pdelta', self_weight = {word}"
        assert read_back(tmp_path, case_text(column=column)).column.self_weight is value


STEPS = "amplitudes = 0.005, 0.02, 0.01, cycles = 1, 3, 2, repeats = 2, points = 5"


def triangles(amplitudes, cycles, repeats, points) -> np.ndarray:
    """Cycles 0, +a, 0, -a, 0 in equal parts, beginning at zero."""
    wave = np.interp(np.arange(1, 4 * points + 1), np.arange(5) * points, [0, 1, 0, -1, 0])
    once = [a * wave for a, count in zip(amplitudes, cycles, strict=True) for _ in range(count)]
    return np.concatenate([[0.0], *once * repeats])


@pytest.mark.parametrize(
    ("drive", "keys", "factor"),
    [
        ("displacement", "", 1.6),  # drift is displacement over height
        ("displacement", "unit = 'drift'", 1.6),
        ("displacement", "unit = 'm', scale = 0.5", 0.5),
        ("displacement", "unit = 'mm', scale = 100", 0.1),
        ("displacement", "unit = 'cm', scale = -2", -0.02),
        ("displacement", "unit = 'in'", 0.0254),
        ("force", "", 1.0),
        ("force", "unit = 'kN'", 1e3),
        ("force", "unit = 'MN'", 1e6),
        ("force", "unit = 'kip'", 4448.2216152605),
        ("ground_acceleration", "period = 8", 1.0),
        ("ground_acceleration", "period = 8, unit = 'g'", 9.80665),
        ("ground_acceleration", "period = 8, unit = 'cm/s2'", 0.01),
        ("ground_acceleration", "period = 8, unit = 'mm/s2'", 1e-3),
    ],
)
def test_protocol_in_its_units_and_period(case_text, tmp_path, drive, keys, factor):
    case = read_back(tmp_path, case_text(loading=f"drive = '{drive}', {STEPS}, {keys}"))
    expected = factor * triangles([0.005, 0.02, 0.01], [1, 3, 2], 2, 5)
    np.testing.assert_allclose(getattr(case, drive), expected, rtol=1e-14)
    step = 8 / 20 if "period" in keys else 1
    np.testing.assert_allclose(case.time, step * np.arange(expected.size), rtol=1e-14)


def test_protocol_of_the_literature_and_one_with_other_amplitudes_to_one_side(case_text, tmp_path):
    for loading, expected in (
        (
            "protocol = 'fema_461', reference = 30, unit = 'mm', points = 3",
            1e-3 * rbsdem.protocol("fema_461", reference=30.0, points=3),
        ),
        (
            "amplitudes = 0.01, 0.02, negative_amplitudes = 0.005, 0, points = 2",
            rbsdem.protocol([0.016, 0.032], negative_amplitudes=[0.008, 0.0], points=2),
        ),
    ):
        case = read_back(tmp_path, case_text(loading=f"drive = 'displacement', {loading}"))
        np.testing.assert_allclose(case.displacement, expected, rtol=1e-14, atol=1e-18)


def test_duration_cuts_and_prolongs_the_loading(dynamic_text, tmp_path):
    (tmp_path / "f.csv").write_text("time_s,force_kN\n1,0\n1.01,20\n1.03,-5\n")
    for duration, force in {0.005: 10e3, 0.03: -5e3, 0.05: -5e3}.items():
        loading = "drive = 'force', file = 'f.csv'"
        analysis = f"method = 'rk4', duration = {duration}"
        case = read_back(tmp_path, dynamic_text(loading=loading, analysis=analysis))
        assert case.time[0] == 1.0
        assert case.time[-1] == 1.0 + duration
        assert case.force[-1] == pytest.approx(force, rel=1e-12)


def test_loads_that_act_together(run_cli, case_text, tmp_path, read_csv):
    """Values at common times are interpolated, which rounds."""
    column = f"n = 2, kinematics = 'finite', {HEAVY}, axial_load = 2e5, self_weight = T"
    loading = [GROUND, VERTICAL, AXIAL, FORCE]
    text = case_text(
        column=column, axial_spring="rule = 'compression', k = 1e9", loading=loading,
        analysis="method = 'rk45', duration = 0.3",
    )  # fmt: skip
    case = read_back(tmp_path, text)
    assert run_cli(["run", "case.nml", "--quiet"], tmp_path).returncode == 0
    rows, own = read_csv(tmp_path / "case.csv"), rows_of(case.run())
    assert list(own) == list(rows)
    for label, values in rows.items():
        scale = np.max(np.abs(values)) + label.endswith("_J") * np.max(np.abs(rows["input_J"]))
        np.testing.assert_allclose(own[label], values, atol=1e-8 * scale, err_msg=label)


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


def test_case_of_3000_bodies_is_read(run_cli, case_text, tmp_path):
    n = 3000
    lengths = ", ".join(["0.0016"] * n)
    text = case_text(
        column=f"n = {n}, height = 4.8, lengths = {lengths}, mass = 6e3, kinematics = 'pdelta', "
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


def test_result_without_openings_has_zeros_and_no_axial_forces():
    run = rbsdem.cyclic(
        rbsdem.Column(1.6, 614.4, BILINEAR, TAKEDA, n=2), displacement=[0.01, -0.01]
    )
    assert run.opening.shape == (2, 2)
    assert not run.opening.any()
    assert run.axial_force is None
    assert np.array_equal(run.top, [[0.01, 1.6], [-0.01, 1.6]])


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
    np.testing.assert_allclose(still.opening, -(3e4 + weight) / 1e8 * np.ones((2, 1)), rtol=1e-12)
    put = rbsdem.time_history(column, [0.0, 0.01], initial={"opening": [1e-3, 0.0]}, method="rk4")
    assert put.opening[0].tolist() == [1e-3, 0.0]
    moved = rbsdem.time_history(
        column, [0.0, 0.01], initial={"opening_velocity": [0.0, 0.5]}, method="rk4"
    )
    assert np.array_equal(moved.opening[0], still.opening[0])
    assert np.max(np.abs(moved.opening[1] - still.opening[1])) > 1e-4


@pytest.mark.parametrize(("analysis", "drift"), [("static", 0.009), ("rk4", 5e-6)])
def test_collapse_is_told_with_its_place(
    run_cli, case_text, dynamic_text, tmp_path, *, read_csv, analysis, drift
):
    text = case_text if analysis == "static" else dynamic_text
    write(tmp_path, text(analysis=f"method = '{analysis}', collapse_drift = {drift}"))
    for options in ([], ["--quiet"]):
        result = run_cli(["run", "case.nml", *options], tmp_path)
        assert result.returncode == 3
        assert bool(result.stdout) == (not options)
        match = re.fullmatch(
            r"rbsdem: collapsed at (?:step|time) (\S+)(?: s)?: the top is at (\S+) m, beyond "
            rf"collapse_drift = {drift:.3g} of the height; the rows up to there are in case.csv\n",
            result.stderr,
        )
        assert match, result.stderr
        rows = read_csv(tmp_path / "case.csv")
        assert float(match[1]) == pytest.approx(next(iter(rows.values()))[-1], rel=1e-5)
        assert float(match[2]) == pytest.approx(rows["displacement_m"][-1], rel=1e-5)
        beyond = np.abs(rows["displacement_m"]) >= drift * 1.6
        assert beyond[-1]
        assert not beyond[:-1].any()


@pytest.mark.parametrize("side", [1, -1])
def test_collapse_that_was_asked_for_is_no_warning(side):
    """Large rotations belong to a run that ends at `collapse_drift`; without it they are noted."""
    elastic = Elastic(1e6)
    column = rbsdem.Column(1.0, 100.0, elastic, elastic, axial_load=2e3, kinematics="pdelta")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = rbsdem.cyclic(column, displacement=[0.0, 0.6 * side], collapse_drift=0.5)
    assert run.summary["status"] == "collapsed"
    assert run.summary["peak_rotation"] > 0.1
    with pytest.warns(AccuracyWarning, match="the rotation of a body goes beyond 0.1 rad"):
        rbsdem.cyclic(column, displacement=[0.0, 0.4 * side])


def test_finite_rotations_need_no_note():
    column = rbsdem.Column(2.0, 100.0, Elastic(1e9), Elastic(1e4), kinematics="finite")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        run = rbsdem.time_history(column, [0.0, 1e-3], initial={"rotation": [0.5]}, method="rk4")
    assert run.summary["peak_rotation"] == pytest.approx(0.5, rel=0.01)


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
