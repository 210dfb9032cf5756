"""A case in other units is the case in SI, value by value; the csv speaks the user's units."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rbsdem

#: SI units in one of each.
FORCES = {"N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605}
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254}
MASSES = {"kg": 1.0, "t": 1e3}

SYSTEMS = [
    {"force": "kN", "length": "mm"},
    {"force": "kN", "length": "mm", "mass": "t"},
    {"force": "MN", "length": "cm"},
    {"force": "kip", "length": "in", "mass": "kg"},
    {"mass": "t"},
    {"length": "in"},
]

#: Groups of a case: values in SI with the powers of force, length and mass in their units.
Value = tuple[float | list[float], tuple[int, int, int]]
FORCE, LENGTH, MASS, NONE = (1, 0, 0), (0, 1, 0), (0, 0, 1), (0, 0, 0)
STIFFNESS, MOMENT, TURNING = (1, -1, 0), (1, 1, 0), (0, 2, 1)
Groups = list[tuple[str, str, dict[str, Value]]]

COLUMN: Groups = [
    ("column", "n = 2, kinematics = 'pdelta', self_weight = T, gravity = 9.81", {
        "height": (2.25, LENGTH), "lengths": ([1.25, 1.0], LENGTH),
        "masses": ([300.0, 500.0], MASS),
        "axial_load": (4e5, FORCE), "top_mass": (2e4, MASS), "top_inertia": (300.0, TURNING),
        "rotary_inertia": ([40.0, 50.0], TURNING),
    }),
    ("damping", "mass = 0.3, stiffness = 1e-5, tangent = T", {}),
    ("shear", "rule = 'pinching', kappa_f = 0.4, kappa_d = 0.5, lambda_s = 60", {
        "d_y": (2e-3, LENGTH), "f_y": (2e5, FORCE), "d_cap": (0.01, LENGTH),
        "f_cap": (2.2e5, FORCE),
        "d_pc": (0.05, LENGTH), "f_res": (2e4, FORCE), "d_y_neg": (2.1e-3, LENGTH),
    }),
    ("flexure", "joint = 1, rule = 'layered'", {}),
    ("flexure", "joint = 2, rule = 'takeda', d_c = 3e-4, d_y = 3e-3, b1 = 0.3", {
        "k_c": (2.5e8, MOMENT), "k_y": (6e7, MOMENT), "k_u": (7e6, MOMENT),
    }),
    ("layer_spring", "id = 1, rule = 'concrete', contact = 0.35", {
        "k": (4e9, STIFFNESS), "f_peak": (1.2e6, FORCE), "d_peak": (6e-4, LENGTH),
        "k_soft": (8e7, STIFFNESS),
    }),
    ("layer_spring", "id = 2, rule = 'steel', r0 = 8", {
        "k": (8e8, STIFFNESS), "f_y": (7e5, FORCE), "k_post": (8e6, STIFFNESS),
    }),
    ("layers", "joint = 1, spring = 1, 1, 1, 1, 2, 2", {
        "y": ([-0.15, -0.05, 0.05, 0.15, -0.16, 0.16], LENGTH),
    }),
]  # fmt: skip
OPENING: Groups = [
    ("column", "kinematics = 'pdelta'", {
        "height": (2.0, LENGTH), "mass": (900.0, MASS), "axial_load": (4e5, FORCE),
        "depth": (0.5, LENGTH), "top_mass": (1e4, MASS),
    }),
    ("shear", "rule = 'elastic'", {"k": (2e8, STIFFNESS)}),
    ("flexure", "rule = 'bilinear', d_y = 1.5e-3", {"k": (4e7, MOMENT), "k_post": (1e5, MOMENT)}),
    ("axial_spring", "rule = 'compression'", {"k": (1e9, STIFFNESS)}),
]  # fmt: skip
STATIC: Groups = [("loading", "drive = 'displacement', amplitudes = 0.004, 0.01, points = 3", {})]
PATH: Groups = [
    ("loading", "drive = 'displacement'", {"values": ([0.0, 0.01, -0.02, 0.005], LENGTH)})
]
FORCES_IN_TIME: Groups = [
    ("loading", "drive = 'force', period = 0.2, points = 4", {"amplitudes": ([2e4, 5e4], FORCE)}),
    ("loading", "drive = 'ground_acceleration', unit = 'g', amplitudes = 0.1, period = 0.1", {}),
    (
        "loading",
        "drive = 'axial_load', time = 0.0, 0.1, 0.4",
        {"values": ([0.0, 3e4, -2e4], FORCE)},
    ),
    ("analysis", "method = 'newmark', dt = 0.002", {}),
]


def text(groups: Groups, system: dict[str, str]) -> str:
    """The case with its numbers in the units of a system."""
    sizes = [
        FORCES[system.get("force", "N")],
        LENGTHS[system.get("length", "m")],
        MASSES[system.get("mass", "kg")],
    ]
    lines = []
    if system:
        entries = ", ".join(f"{name} = '{unit}'" for name, unit in system.items())
        lines.append(f"&units {entries} /")
    for group, plain, values in groups:
        entries = [plain]
        for name, (value, powers) in values.items():
            size = float(np.prod([one**power for one, power in zip(sizes, powers, strict=True)]))
            numbers = [repr(float(one) / size) for one in np.atleast_1d(value)]
            entries.append(f"{name} = {', '.join(numbers)}")
        lines.append(f"&{group} {', '.join(entry for entry in entries if entry)} /")
    return "\n".join(lines) + "\n"


def read(folder: Path, name: str, content: str) -> rbsdem.results.case.Case:
    (folder / name).write_text(content, "utf-8")
    return rbsdem.read_case(folder / name)


def close(one: Any, other: Any) -> bool:
    """Equal to round-off, through records and lists."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(close(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(close, one, other))
    if isinstance(one, float):
        return bool(np.isclose(one, other, rtol=1e-14, atol=0.0))
    return bool(one == other)


CASES = {
    "column, static": COLUMN + STATIC,
    "path in the case": COLUMN + PATH,
    "joints that open, in time": OPENING + FORCES_IN_TIME,
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: " ".join(system.values()))
def test_case_in_other_units_is_the_case_in_si(tmp_path, run_cli, read_csv, name, system):
    si = read(tmp_path, "si.nml", text(CASES[name], {}))
    other = read(tmp_path, "other.nml", text(CASES[name], system))
    assert close(asdict(other.column), asdict(si.column))
    for drive in ("displacement", "force", "ground_acceleration", "axial_load", "time"):
        one, two = getattr(si, drive), getattr(other, drive)
        assert (one is None) == (two is None)
        if one is not None:
            np.testing.assert_allclose(two, one, rtol=1e-13)
    tables = []
    for file in ("si", "other"):
        result = run_cli(["run", f"{file}.nml", "--quiet"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        tables.append(read_csv(tmp_path / f"{file}.csv"))
    force, length = system.get("force", "N"), system.get("length", "m")
    size = {"m": LENGTHS[length], "N": FORCES[force], "Nm": FORCES[force] * LENGTHS[length]}
    label = {"m": length, "N": force, "Nm": force + length}
    before, after = tables
    assert len(before) == len(after)
    for column, values in before.items():
        quantity, _, unit = column.rpartition("_")
        renamed = f"{quantity}_{label[unit]}" if unit in size and quantity else column
        # What is left of the energies is round-off.
        size_of = before["input_J"] if unit == "J" else values
        scale = max(np.max(np.abs(size_of)), 1e-30)
        np.testing.assert_allclose(
            after[renamed] * size.get(unit, 1.0) / scale, values / scale, atol=2e-7, err_msg=column
        )
    head = (tmp_path / "other.csv").read_text("utf-8").splitlines()[2]
    if force == "N" and length == "m":
        assert head.startswith("# units: SI,")
    else:
        assert head.startswith(f"# units: {force}, {length}, else SI,")


def test_python_result_of_a_case_in_other_units_is_in_si(tmp_path, run_cli, read_csv):
    system = {"force": "kN", "length": "mm"}
    case = read(tmp_path, "case.nml", text(COLUMN + STATIC, system))
    run = case.run()
    result = run_cli(["run", "case.nml", "--quiet"], tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    table = read_csv(tmp_path / "case.csv")
    np.testing.assert_allclose(table["force_kN"] * 1e3, run.force, rtol=1e-14)
    np.testing.assert_allclose(table["displacement_mm"] / 1e3, run.displacement, rtol=1e-14)
    np.testing.assert_allclose(table["moment_2_kNmm"], run.moment[:, 1], rtol=1e-14)
    # What Python writes is SI: the units belong to the file.
    assert "units" not in case.to_namelist()


def test_place_of_the_units_in_the_file_does_not_matter(tmp_path):
    groups = text(COLUMN + STATIC, {"force": "kN", "length": "mm"}).splitlines()
    first = read(tmp_path, "first.nml", "\n".join(groups))
    last = read(tmp_path, "last.nml", "\n".join([*groups[1:], groups[0]]))
    assert first == last


@pytest.mark.parametrize("unit", [None, "m", "mm"])
def test_unit_of_a_loading_comes_before_those_of_the_case(tmp_path, unit):
    (tmp_path / "path.csv").write_text("displacement\n0\n8\n")
    given = f", unit = '{unit}'" if unit else ""
    loading: Groups = [("loading", f"drive = 'displacement', file = 'path.csv'{given}", {})]
    case = read(tmp_path, "case.nml", text(OPENING + loading, {"length": "cm"}))
    assert case.displacement is not None
    assert case.displacement[1] == 8 * LENGTHS[unit or "cm"]
