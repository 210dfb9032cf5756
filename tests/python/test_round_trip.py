"""Columns and cases as text: what is written comes back bit for bit, and the executable agrees."""

from __future__ import annotations

import re
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from strategies import Rng, accepted, any_column, rules, spring

import rbsdem
from rbsdem.errors import AccuracyWarning
from rbsdem.results.case import Case
from rbsdem.section.parameters import parameters
from rbsdem.springs import Compression, Elastic

# The same column is made at every level of kinematics, and masses without weight are tried.
pytestmark = pytest.mark.filterwarnings(
    "ignore:column. (axial_load|self_weight|top_mass|height|shear has) "
)

LOADING = "&loading drive = 'displacement', amplitudes = 0.001 /\n"


def near(rng: Rng, value: float) -> float:
    """A number with all its digits, of the size of another."""
    return float(value * rng.uniform(0.5, 1.5))


def some(rng: Rng, rule: str) -> rbsdem.springs.Spring:
    return spring(rng, rule, 2e5, 3e-3)


# ---- columns -------------------------------------------------------------------------------------


def read_back(folder: Path, text: str) -> Case:
    path = folder / "case.nml"
    path.write_text(text, "utf-8")
    return rbsdem.read_case(path)


@pytest.mark.parametrize("seed", range(10))
def test_columns_come_back_from_text(tmp_path, seed):
    rng = np.random.default_rng(seed)
    for _ in range(30):
        column = any_column(rng, in_time=True)
        if rng.random() < 0.3:
            column = replace(column, model='it\'s "mine", 2026.1 / & !')
        text = column.to_namelist()
        assert max(map(len, text.splitlines())) <= 132
        follows = column.axial_follows or column.force_follows
        motion = "&loading drive = 'ground_acceleration', amplitudes = 1, period = 1 /\n"
        case = read_back(tmp_path, text + (motion if follows else LOADING))
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


def test_column_of_a_section_comes_back_and_its_loop_too(tmp_path, run_cli, read_csv):
    section = rbsdem.peer.paper_sections()["zahn_7"].section
    for model in ("layered", "paper"):
        column = rbsdem.section.column(section, 1.6, axial_load=7e5, model=model)
        path = rbsdem.protocol([0.005, 0.01, 0.02], points=3) * 1.6
        case = made(column, "static", displacement=path)
        back = read_back(tmp_path, case.to_namelist())
        for field in fields(rbsdem.Column):
            assert getattr(back.column, field.name) == getattr(column, field.name), field.name
        same_rows(back.run(), rows(run_cli, read_csv, tmp_path), case.run())


# ---- drawings ------------------------------------------------------------------------------------


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
        section = column.recipe.section
        thicker = {"cover": 1.05 * section.cover}
        assert replace(back.column.recipe.section, **thicker) == replace(section, **thicker)
        one, other = back.run(openings=True), case.run(openings=True)
        assert list(one.limit_states()) == list(other.limit_states())
        reached |= set(one.limit_states().names())
        if number == 0:
            same_rows(one, rows(run_cli, read_csv, tmp_path), other)
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
    ("old", "new"), [("lambda_s = 46.9", "lambda_s = 40"), ("width = 0.4", "width = 0.41")]
)
def test_springs_that_are_not_as_drawn_are_told(tmp_path, old, new):
    with pytest.warns(AccuracyWarning, match="shear.* other than layered 2026.5 draws"):
        case = read_back(tmp_path, drawn_text(**{old: new}))
    assert ("flexure" in case.column.replaced) == (old == "width = 0.4")


def test_a_case_under_another_load_keeps_its_springs(tmp_path):
    """As the executable does, which cannot draw: its answer would be another one."""
    text = drawn_text()
    with pytest.warns(AccuracyWarning, match="drawn for axial_load = 744000 N, and its col"):
        case = read_back(tmp_path, text.replace("axial_load = 744000", "axial_load = 700000", 1))
    assert type(case.column) is rbsdem.Column
    assert case.column.joints("shear") == read_back(tmp_path, text).column.joints("shear")


# ---- cases ---------------------------------------------------------------------------------------


def made(column: rbsdem.Column, method: str, title: str = "", **given: Any) -> Case:
    """A case by hand: histories by their names, and settings."""
    drives = ("displacement", "force", "ground_acceleration", "vertical_acceleration", "axial_load")
    loads = {name: given.pop(name, None) for name in drives}
    points = max(len(values) for values in loads.values() if values is not None)
    time = given.pop("time", np.arange(float(points)))
    return Case(title, column, method, time, **loads, settings=given)


def rows(run_cli, read_csv, folder: Path) -> dict[str, np.ndarray]:
    result = run_cli(["run", "case.nml", "--quiet"], folder)
    assert (result.returncode, result.stderr) == (0, "")
    return read_csv(folder / "case.csv")


def same_rows(run: rbsdem.Result, csv: dict[str, np.ndarray], before: rbsdem.Result) -> None:
    """Result of the text, csv of the executable, and result of the case that was written."""
    assert np.array_equal(run.displacement, csv["displacement_m"])
    assert np.array_equal(run.force, csv["force_N"])
    assert np.array_equal(run.energy["spring"], csv["spring_J"])
    for i, moment in zip(run.column.joint_numbers, run.moment.T, strict=True):
        assert np.array_equal(moment, csv[f"moment_{i}_Nm"])
    for name in ("time", "displacement", "force", "slip", "rotation", "shear", "moment", "top"):
        assert np.array_equal(getattr(run, name), getattr(before, name)), name


def random_case(rng: Rng) -> Case:
    """A column at rest under small random histories, by each kind of method."""
    column = any_column(
        rng, kinematics=str(rng.choice(["small", "pdelta"])), top="free", axial_load=1e4
    )
    titles = ["", 'it\'s "quoted" / & !', "Säule 1 — Nr. ½"]
    title = titles[rng.integers(3)]
    if rng.random() < 0.4:
        path = np.cumsum(rng.uniform(-1e-4, 1e-4, 12))
        every = {"every": 3} if rng.random() < 0.5 else {}
        return made(column, "static", title, displacement=path, **every)
    time = np.cumsum(rng.uniform(1e-3, 2e-3, 12))
    loads = {"ground_acceleration": rng.uniform(-1, 1, 12)}
    if rng.random() < 0.5:
        loads["force"] = rng.uniform(-100, 100, 12)
    if rng.random() < 0.5 and column.kinematics != "small":
        loads |= {
            "vertical_acceleration": rng.uniform(-1, 1, 12),
            "axial_load": 1e4 * rng.uniform(0.9, 1.1, 12),
        }
    methods: list[tuple[str, dict[str, Any]]] = [
        ("newmark", {"dt": 5e-4}),
        ("hht", {"dt": 5e-4, "rho_infinity": 0.7, "collapse_drift": 0.5}),
        ("generalised_alpha", {"every": 2}),
        ("rk45", {"tolerance": 1e-5}),
        ("auto", {}),
    ]
    method, settings = methods[rng.integers(5)]
    return made(column, method, title, time=time, **loads, **settings)


@pytest.mark.parametrize("seed", range(12))
def test_cases_come_back_and_run_alike(tmp_path, run_cli, read_csv, seed):
    rng = np.random.default_rng(100 + seed)
    for _ in range(4):
        case = random_case(rng)
        text = case.to_namelist()
        back = read_back(tmp_path, text)
        assert back == case
        assert back.to_namelist() == text
        same_rows(back.run(), rows(run_cli, read_csv, tmp_path), case.run())


@pytest.mark.parametrize("method", ["rk4", "rk45"])
def test_finite_case_with_loads_that_follow_comes_back(tmp_path, run_cli, read_csv, method):
    rng = np.random.default_rng(5)
    column = rbsdem.Column(
        2.0, 1e3, Elastic(2e8), Elastic(1e8), n=2, kinematics="finite",
        axial_follows=True, force_follows=True, axial_spring=Compression(1e9), top_mass=1e3,
        axial_load=1e4,
    )  # fmt: skip
    time, force = np.linspace(0, 0.02, 9), rng.uniform(-1e3, 1e3, 9)
    case = made(column, method, time=time, force=force)
    back = read_back(tmp_path, case.to_namelist())
    assert back == case
    same_rows(back.run(), rows(run_cli, read_csv, tmp_path), case.run())


def test_case_of_a_file_comes_back_with_its_histories_in_the_text(tmp_path, case_text):
    (tmp_path / "f.csv").write_text("time_s,force_kN\n0,0\n0.1,20\n0.25,-7\n")
    (tmp_path / "g.csv").write_text("time_s,acceleration_g\n0,0.1\n0.2,-0.3\n0.3,0\n")
    loading = ["drive = 'force', file = 'f.csv'", "drive = 'ground_acceleration', file = 'g.csv'"]
    (tmp_path / "a.nml").write_text(
        case_text(loading=loading, analysis="method = 'newmark', duration = 0.28, dt = 0.01")
    )
    case = rbsdem.read_case(tmp_path / "a.nml")
    text = case.to_namelist()
    assert "file" not in text
    assert read_back(tmp_path, text) == case


# ---- long histories ------------------------------------------------------------------------------


def test_a_long_history_comes_back(tmp_path):
    values = np.random.default_rng(1).normal(size=50_000) * 1e-3
    column = rbsdem.Column(1.0, 1.0, Elastic(1e8), Elastic(1e8))
    case = made(column, "static", displacement=values)
    back = read_back(tmp_path, case.to_namelist())
    assert np.array_equal(back.displacement, values)
    extremes = np.array([0.0, 5e-324, -2.2e-308, 1 / 3, 0.1 + 0.2, np.nextafter(1, 2), 1e22])
    case = made(column, "static", displacement=extremes)
    back = read_back(tmp_path, case.to_namelist())
    assert np.array_equal(back.displacement, extremes)
