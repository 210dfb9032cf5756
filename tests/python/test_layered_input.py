"""Layers in a namelist file: the rows are those of Python, and faults are told with their place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rbsdem

CONCRETE = (
    "rule = 'concrete', k = 2e9, f_peak = 6e5, d_peak = 6e-4, k_fall = 4e7, f_res = 2e5, "
    "plastic = 1.2, contact = 0.35, misfit = 0.4, wear = 0.03"
)
STEEL = (
    "rule = 'steel', k = 6e8, f_y = 5.4e5, k_post = 6e6, r0 = 8, r1 = 0.83, r2 = 0.42, "
    "growth = 0.005, endurance = 800"
)
BLOCK = rbsdem.ConcreteSpring(2e9, 6e5, 6e-4, 4e7, 2e5, 1.2, 0.35, 0.4, 0.03)
BAR = rbsdem.SteelSpring(6e8, 5.4e5, 6e6, 8, 0.83, 0.42, 0.005, 800)
LAYERED = "rule = 'layered', axial_load = 7e5"
PLACES = (-0.15, -0.05, 0.05, 0.15)

Groups = dict[str, str | list[str] | None]


def groups(**changes: str | list[str]) -> Groups:
    """Return a case of one layered joint: strips of concrete between two rows of bars."""
    layers = [f"y = {y}, {CONCRETE}" for y in PLACES] + [f"y = {y}, {STEEL}" for y in (-0.16, 0.16)]
    return {
        "column": "height = 1.6, mass = 614.4, kinematics = 'pdelta'",
        "axial": "load = 7e5",
        "flexure": LAYERED,
        "layer": layers,
    } | changes


def spring(strips: rbsdem.Spring = BLOCK, bars: rbsdem.Spring = BAR) -> rbsdem.Layered:
    layers = [(y, strips) for y in PLACES] + [(y, bars) for y in (-0.16, 0.16)]
    return rbsdem.Layered(7e5, tuple(layers))


def write(folder: Path, text: str) -> Path:
    path = folder / "case.nml"
    path.write_text(text, "utf-8")
    return path


ELASTIC = rbsdem.Elastic(1e8)
LAYERS = groups()["layer"]
DOORS = {
    "one joint": (groups(), (spring(),)),
    "joint = 0 is every joint": (
        groups(column="n = 2, height = 1.6, mass = 600, kinematics = 'pdelta'"),
        (spring(), spring()),
    ),
    "layers of the first joint only": (
        groups(
            column="n = 2, height = 1.6, mass = 600, kinematics = 'pdelta'",
            flexure=[LAYERED + ", joint = 1", "joint = 2, rule = 'elastic', k = 1e8"],
            layer=[f"joint = 1, {layer}" for layer in LAYERS],
        ),
        (spring(), ELASTIC),
    ),
    "one rule, layers of their own": (
        groups(
            column="n = 2, height = 1.6, mass = 600, kinematics = 'pdelta'",
            layer=[layer for layer in LAYERS if "steel" not in layer]
            + ["joint = 1, y = -0.16, " + STEEL, "joint = 1, y = 0.16, " + STEEL]
            + [f"joint = 2, y = {y}, rule = 'elastic', k = 6e8" for y in (-0.16, 0.16)],
        ),
        (spring(), spring(bars=rbsdem.Elastic(6e8))),
    ),
}


@pytest.mark.parametrize("name", DOORS)
def test_layers_through_both_doors(run_cli, case_text, tmp_path, *, read_csv, name):
    about, springs = DOORS[name]
    path = write(tmp_path, case_text(**about))
    case = rbsdem.read_case(path)
    expected = springs if len(set(springs)) > 1 else springs[0]
    flexure = case.column.flexure
    assert flexure == expected or set(flexure) == {expected}
    result = run_cli(["run", "case.nml", "--quiet"], tmp_path)
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")
    rows = read_csv(tmp_path / "case.csv")
    run = case.run()
    assert np.array_equal(rows["displacement_m"], run.displacement)
    assert np.array_equal(rows["force_N"], run.force)
    for i, moment in enumerate(run.moment.T):
        assert np.array_equal(rows[f"moment_{i + 1}_Nm"], moment)


FAULTS = {
    "unknown rule": ("y = 0, rule = 'concret', k = 1", "did you mean 'concrete'?"),
    "rule of another kind": (
        "y = 0, " + CONCRETE.replace("'concrete'", "'takeda'"),
        "it is one of concrete, steel, elastic, bilinear, compression",
    ),
    "no rule": ("y = 0, k = 1e9", "&layer: rule is missing; it is one of concrete"),
    "unknown name": ("y = 0, " + STEEL.replace("f_y", "fy"), "has no 'fy'; did you mean 'f_y'?"),
    "joint out of range": ("y = 0, joint = 2, " + STEEL, "joint = 2; it is 0 for every joint"),
    "no y": (STEEL, "y of layer 7 is missing; give it a value in m"),
    "number of another rule": ("y = 0, d_y = 1, " + STEEL, "layer 7: d_y is not used by the rule"),
    "value": (
        "y = 0, " + STEEL.replace("k_post = 6e6", "k_post = 6e9"),
        "layer 7: k_post = 6e+09 must be below k = 6e+08",
    ),
    "y in words": ("y = 'top', " + STEEL, "y = 'top'"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault_of_a_layer_is_told(run_cli, case_text, tmp_path, name):
    layer, said = FAULTS[name]
    path = write(tmp_path, case_text(**groups(layer=[*LAYERS, layer])))
    result = run_cli(["check", path])
    assert result.returncode == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    with pytest.raises(rbsdem.InputError) as caught:
        rbsdem.read_case(path)
    assert result.stderr == f"rbsdem: {caught.value}\n"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"layer": []}, "the layers are missing; give at least two"),
        ({"layer": ["y = 0, " + STEEL]}, "one layer has no stiffness against rotation"),
        ({"flexure": "rule = 'elastic', k = 1e8"}, "belongs to no flexural spring"),
        ({"flexure": "rule = 'layered'"}, "axial_load is missing"),
        ({"flexure": "rule = 'layered', axial_load = 5e6"}, "cannot carry axial_load = 5e+06 N"),
        ({"flexure": "rule = 'layered', axial_load = -2e6"}, "cannot carry axial_load = -2e+06 N"),
    ],
)
def test_fault_of_a_layered_joint_is_told(run_cli, case_text, tmp_path, *, changes, said):
    # Bars that harden carry any load, in the end.
    text = case_text(**groups(**changes)).replace("k_post = 6e6", "k_post = 0")
    result = run_cli(["check", write(tmp_path, text)])
    assert result.returncode == 2
    assert said in result.stderr
