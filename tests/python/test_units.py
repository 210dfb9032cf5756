"""A case in other units is the case in SI, value by value; the csv speaks the user's units."""

from __future__ import annotations

import re
from dataclasses import asdict, replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from test_doors import random_case

import rbsdem
from rbsdem import InputError, _core, plot
from rbsdem.output.units import paper

KEYS = _core.keys()

#: SI units in one of each.
UNITS = {
    "force": {"N": 1.0, "kN": 1e3, "MN": 1e6, "kip": 4448.2216152605},
    "length": {"m": 1.0, "mm": 1e-3, "cm": 1e-2, "in": 0.0254},
    "mass": {"kg": 1.0, "t": 1e3},
}
SYSTEMS = [
    {"force": "kN", "length": "mm"},
    {"force": "kN", "length": "mm", "mass": "t"},
    {"force": "MN", "length": "cm"},
    {"force": "kip", "length": "in", "mass": "kg"},
    {"mass": "t"},
    {"length": "in"},
]
#: Powers of force, length and mass in what the list of keys says; stiffness is that of a joint.
POWERS = {
    "N": (1, 0, 0), "m": (0, 1, 0), "kg": (0, 0, 1), "kg m2": (0, 2, 1),
    "force": (1, 0, 0), "deformation": (0, 1, 0), "stiffness": (1, -1, 0),
    "moment": (1, 1, 0), "turning stiffness": (1, 1, 0),
    "displacement": (0, 1, 0), "axial_load": (1, 0, 0),
    "m2": (0, 2, 0), "m4": (0, 4, 0), "N/m": (1, -1, 0), "N m": (1, 1, 0), "Pa": (0, 0, 0),
}  # fmt: skip
ENTRY = re.compile(r"(\w+) = ([^=]+?)(?=,\s+\w+ =|\s*$)")
OF_FLEXURE = {"force": "moment", "stiffness": "turning stiffness", "deformation": "rad"}


def converted(text: str, system: dict[str, str]) -> str:
    """The case with its numbers in the units of a system, as the list of keys gives their units."""
    sizes = [
        UNITS[quantity][system.get(quantity, next(iter(UNITS[quantity])))] for quantity in UNITS
    ]

    def group(match: re.Match[str]) -> str:
        name, body = match[1], match[2]
        rule = re.search(r"rule = '(\w+)'", body)
        drive = re.search(r"drive = '(\w+)'", body)
        keys = KEYS["groups"][name] + (KEYS["rules"][rule[1]]["keys"] if rule else [])
        units = {key["name"]: key.get("unit") for key in keys}
        if drive:
            units["values"] = drive[1]

        def entry(match: re.Match[str]) -> str:
            unit = units[match[1]]
            unit = OF_FLEXURE.get(unit, unit) if name == "flexure" else unit
            if unit not in POWERS:
                return match[0]
            size = float(np.prod([one**p for one, p in zip(sizes, POWERS[unit], strict=True)]))
            values = re.split(r",\s*", match[2].strip())
            return f"{match[1]} = {', '.join(repr(float(value) / size) for value in values)}"

        return f"&{name} {ENTRY.sub(entry, body)} /"

    entries = ", ".join(f"{name} = '{unit}'" for name, unit in system.items())
    return f"&units {entries} /\n" + re.sub(r"&(\w+) ([^/]*?)\s*/", group, text)


def close(one: Any, other: Any) -> bool:
    """Equal to round-off, through records and lists."""
    if isinstance(one, dict):
        return one.keys() == other.keys() and all(close(one[key], other[key]) for key in one)
    if isinstance(one, (list, tuple)):
        return len(one) == len(other) and all(map(close, one, other))
    if isinstance(one, (float, np.ndarray)):
        return bool(np.allclose(one, other, rtol=1e-14, atol=0.0, equal_nan=True))
    return bool(one == other)


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: " ".join(system.values()))
@pytest.mark.filterwarnings("ignore:column")
def test_case_in_other_units_is_the_case_in_si(tmp_path, system):
    for seed in range(25):
        case = replace(random_case(np.random.default_rng(seed)), title="")
        (tmp_path / "case.nml").write_text(converted(case.to_namelist(), system))
        other = rbsdem.read_case(tmp_path / "case.nml")
        assert close(asdict(other.column), asdict(case.column))
        for drive in ("displacement", "force", "ground_acceleration", "axial_load", "time"):
            assert close(getattr(other, drive), getattr(case, drive)), drive
        # What Python writes is SI: the units belong to the file.
        assert "&units" not in other.to_namelist()


FRAME = """
&frame storeys = 3.2, 3.0, bays = 6.0, kinematics = 'pdelta' /
&floor mass = 80e3, dead_load = 25e3 /
&member_kind name = 'all', modulus = 30e9, area = 0.16, inertia = 2.1e-3, shear_rigidity = 1e9 /
&flexure kind = 'all', rule = 'bilinear', k = 4e7, d_y = 6e-3, k_post = 4e5 /
&column_of kind = 'all', rigid_end = 0.25 /
&beam_of kind = 'all' /
&node name = 'N-1-2', load_x = 1e3, load_y = -5e4, load_moment = 2e3, mass = 1e3, inertia = 10.0 /
&loading drive = 'displacement', values = 0.1, -0.1 /
"""


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: " ".join(system.values()))
def test_frame_in_other_units_is_the_frame_in_si(tmp_path, system):
    forces = []
    for text in (FRAME, converted(FRAME, system)):
        (tmp_path / "frame.nml").write_text(text)
        case = rbsdem.read_case(tmp_path / "frame.nml")
        forces.append(case.run().force)
    np.testing.assert_allclose(forces[1], forces[0], rtol=1e-9)


@pytest.mark.parametrize("system", SYSTEMS, ids=lambda system: " ".join(system.values()))
@pytest.mark.parametrize("kind", ["static", "in time"])
def test_csv_is_in_the_units_of_the_case(
    tmp_path, run_cli, read_csv, case_text, dynamic_text, *, system, kind
):
    column = "n = 2, height = 1.6, mass = 614.4, kinematics = 'pdelta', axial_load = 4e5"
    given = {"column": column, "axial_spring": "rule = 'compression', k = 1e9"}
    text = case_text(**given)
    if kind == "in time":
        text = dynamic_text(**given, output="motion = .true.")
    tables = []
    for name, content in (("si", text), ("other", converted(text, system))):
        (tmp_path / f"{name}.nml").write_text(content)
        result = run_cli(["run", f"{name}.nml", "--quiet"], tmp_path)
        assert (result.returncode, result.stderr) == (0, "")
        tables.append(read_csv(tmp_path / f"{name}.csv"))
    force, length = system.get("force", "N"), system.get("length", "m")
    size = {"m": UNITS["length"][length], "N": UNITS["force"][force]}
    size["Nm"] = size["N"] * size["m"]
    label = {"m": length, "N": force, "Nm": force + length}
    size["m/s"], label["m/s"] = size["m"], f"{length}/s"
    before, after = tables
    assert len(before) == len(after)
    for name, values in before.items():
        quantity, _, unit = name.rpartition("_")
        renamed = f"{quantity}_{label[unit]}" if unit in size and quantity else name
        # What is left of the energies is round-off.
        scale = max(np.max(np.abs(before["input_J"] if unit == "J" else values)), 1e-30)
        np.testing.assert_allclose(
            after[renamed] * size.get(unit, 1.0) / scale, values / scale, atol=2e-7, err_msg=name
        )
    head = (tmp_path / "other.csv").read_text("utf-8").splitlines()[2]
    plain = force == "N" and length == "m"
    assert head.startswith("# units: SI," if plain else f"# units: {force}, {length}, else SI,")
    # Results of Python are in SI.
    run = rbsdem.read_case(tmp_path / "other.nml").run()
    np.testing.assert_allclose(after[f"force_{force}"] * size["N"], run.force, rtol=1e-14)


def test_place_of_the_units_in_the_file_does_not_matter(tmp_path, case_text):
    groups = converted(case_text(), SYSTEMS[0]).splitlines()
    cases = []
    for lines in (groups, [*groups[1:], groups[0]]):
        (tmp_path / "case.nml").write_text("\n".join(lines))
        cases.append(rbsdem.read_case(tmp_path / "case.nml"))
    assert cases[0] == cases[1]


@pytest.mark.parametrize("unit", [None, "m", "mm"])
def test_unit_of_a_loading_comes_before_those_of_the_case(tmp_path, case_text, unit):
    (tmp_path / "path.csv").write_text("displacement\n0\n8\n")
    given = f", unit = '{unit}'" if unit else ""
    text = case_text(loading=f"drive = 'displacement', file = 'path.csv'{given}")
    (tmp_path / "case.nml").write_text(converted(text, {"length": "cm"}))
    displacement = rbsdem.read_case(tmp_path / "case.nml").displacement
    assert displacement[1] == 8 * UNITS["length"][unit or "cm"]


@pytest.mark.usefixtures("without_figures")
def test_figures_tables_and_reports_speak_other_units_in_a_block(tmp_path):
    push = rbsdem.pushover(rbsdem.examples.portal(), drift=0.02)
    kip, inch = UNITS["force"]["kip"], UNITS["length"]["in"]
    states = plot.table(push.limit_states())
    with plot.units("in", "kip"):
        drawn = plot.pushover(push)
        heading = str(plot.table(push.limit_states())).splitlines()
    line = drawn.get_lines()[0]
    np.testing.assert_allclose(line.get_xdata(), push.displacement / inch, rtol=1e-15)
    np.testing.assert_allclose(line.get_ydata(), push.base_shear / kip, rtol=1e-15)
    assert (drawn.get_xlabel(), drawn.get_ylabel()) == (
        "Roof displacement (in)", "Base shear (kip)"
    )  # fmt: skip
    # The drift above the axis is that of the height, whatever the unit below.
    (top,) = drawn.child_axes
    drawn.figure.draw_without_rendering()
    ratio = np.ptp(top.get_xlim()) / np.ptp(drawn.get_xlim())
    assert ratio == pytest.approx(100 * inch / push.frame.height, rel=1e-12)
    assert "kip" in heading[1] or "kip" in heading[0]
    # Outside of the block all is as before.
    assert str(plot.table(push.limit_states())) == str(states)
    assert "kN" in str(states)
    for length, force in product(("mm", "cm", "m", "in"), ("kN", "N", "MN", "kip", "lbf", "tf")):
        with plot.units(length, force):
            size, weight = paper("m")[0], paper("N")[0]
            arm = size if length == "in" else 1.0
            assert paper("N m")[0] == pytest.approx(weight * arm, rel=1e-14)
            assert paper("N/m")[0] == pytest.approx(weight / size, rel=1e-14)
    with plot.units("in", "kip"):
        assert paper("Pa")[0] * 1e6 == pytest.approx(0.1450377377, rel=1e-9)
    checked = rbsdem.codes.assess(push, "en_1998_3")
    page = rbsdem.report(checked, tmp_path / "a.html", units=("in", "kip")).read_text()
    assert "Shear strength kip" in page.replace("<br>", " ").replace("\n", " ")
    for units in ("in", ("ft", "kip"), ("in",)):
        with pytest.raises(InputError, match="units"):
            rbsdem.report(checked, tmp_path / "b.html", units=units)
    assert not (tmp_path / "b.html").exists()
