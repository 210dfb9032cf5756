"""Layers in a namelist file: the rows are those of Python, and faults are told with their place."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import rbsdem
from rbsdem.springs import ConcreteSpring, Elastic, Layered, SteelSpring

CONCRETE = (
    "rule = 'concrete', k = 2e9, f_peak = 6e5, d_peak = 6e-4, k_soft = 4e7, f_res = 2e5, "
    "plastic = 1.2, contact = 0.35, misfit = 0.4, wear = 0.03"
)
STEEL = (
    "rule = 'steel', k = 6e8, f_y = 5.4e5, k_post = 6e6, r0 = 8, cr1 = 0.83, cr2 = 0.42, "
    "isotropic_hardening = 0.005, endurance = 800"
)
BLOCK = ConcreteSpring(2e9, 6e5, 6e-4, 4e7, 2e5, 1.2, 0.35, 0.4, 0.03)
BAR = SteelSpring(6e8, 5.4e5, 6e6, 8, 0.83, 0.42, 0.005, endurance=800)
LAYERED = "rule = 'layered'"
PLACES = (-0.15, -0.05, 0.05, 0.15)
SPRINGS = ["id = 1, " + CONCRETE, "id = 2, " + STEEL]
LAYERS = "y = -0.15, -0.05, 0.05, 0.15, -0.16, 0.16, spring = 1, 1, 1, 1, 2, 2"
TWO = "n = 2, height = 1.6, mass = 600, kinematics = 'pdelta', axial_load = 7e5"

Groups = dict[str, str | list[str] | None]


def groups(**changes: str | list[str]) -> Groups:
    """Return a case of one layered joint: strips of concrete between two rows of bars."""
    return {
        "column": "height = 1.6, mass = 614.4, kinematics = 'pdelta', axial_load = 7e5",
        "flexure": LAYERED,
        "layer_spring": SPRINGS,
        "layers": LAYERS,
    } | changes


def spring(strips: rbsdem.Spring = BLOCK, bars: rbsdem.Spring = BAR) -> Layered:
    layers = [(y, strips) for y in PLACES] + [(y, bars) for y in (-0.16, 0.16)]
    return Layered(tuple(layers))


def write(folder: Path, text: str) -> Path:
    path = folder / "case.nml"
    path.write_text(text, "utf-8")
    return path


ELASTIC = Elastic(1e8)
DOORS = {
    "one joint": (groups(), (spring(),)),
    "without joint: every joint": (groups(column=TWO), (spring(), spring())),
    "layers of one joint, another rule for the other": (
        groups(
            column=TWO,
            flexure=[LAYERED, "joint = 2, rule = 'elastic', k = 1e8"],
            layers="joint = 1, " + LAYERS,
        ),
        (spring(), ELASTIC),
    ),
    "joints in a list": (
        groups(column=TWO, flexure=LAYERED + ", joint = 2, 1", layers="joint = 1, 2, " + LAYERS),
        (spring(), spring()),
    ),
    "layers of the first joint only": (
        groups(
            column=TWO,
            flexure=[LAYERED + ", joint = 1", "joint = 2, rule = 'elastic', k = 1e8"],
            layers="joint = 1, " + LAYERS,
        ),
        (spring(), ELASTIC),
    ),
    "one rule, layers of their own": (
        groups(
            column=TWO,
            layer_spring=["id = 7, rule = 'elastic', k = 6e8", *SPRINGS],
            layers=[
                "joint = 2, " + LAYERS.replace("2, 2", "7, 7"),
                "joint = 1, " + LAYERS,
            ],
        ),
        (spring(), spring(bars=Elastic(6e8))),
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


THIRD = {
    "unknown rule": ("id = 3, rule = 'concret', k = 1", "did you mean 'concrete'?"),
    "rule of another kind": (
        "id = 3, rule = 'takeda', k_c = 2, d_c = 1, k_y = 1, d_y = 2, k_u = 0",
        "line 8: flexure spring: layer 1 has the rule 'takeda'; it is one of",
    ),
    "no rule": ("id = 3, k = 1e9", "rule is missing; it is one of"),
    "unknown name": (
        "id = 3, " + STEEL.replace("f_y", "fy"),
        "line 8: &layer_spring has no 'fy'; did you mean 'f_y'?",
    ),
    "no id": (STEEL, "line 8: &layer_spring: id is missing"),
    "parameter of another rule": (
        "id = 3, d_y = 1, " + STEEL,
        "line 8: &layer_spring: d_y is not used by the rule steel",
    ),
    "value": (
        "id = 3, " + STEEL.replace("k_post = 6e6", "k_post = 6e9"),
        # The line is that of the group of the spring, not that of the joint.
        "line 8: flexure spring: layer 1: k_post = 6e+09 must be below k = 6e+08",
    ),
    "id in words": ("id = 'three', " + STEEL, "id = 'three' must be a whole number"),
}


def refused(run_cli, path: Path, said: str) -> None:
    """Both doors tell one fault, with the same words."""
    result = run_cli(["check", path])
    assert result.returncode == 2
    assert said in result.stderr
    assert len(result.stderr.splitlines()) == 1
    with pytest.raises(rbsdem.InputError) as caught:
        rbsdem.read_case(path)
    assert result.stderr == f"rbsdem: {caught.value}\n"


@pytest.mark.parametrize("name", THIRD)
def test_fault_of_the_spring_of_a_layer_is_told(run_cli, case_text, tmp_path, name):
    third, said = THIRD[name]
    layers = LAYERS.replace("y = -0.15", "y = 0, -0.15").replace("spring = 1", "spring = 3, 1")
    text = case_text(**groups(layer_spring=[*SPRINGS, third], layers=layers))
    refused(run_cli, write(tmp_path, text), said)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"layer_spring": [*SPRINGS, "id = 2, " + CONCRETE]},
            "line 8: &layer_spring with id = 2 appears twice",
        ),
        ({"layers": None}, "the layers are missing"),
        ({"layers": "y = 0, spring = 2"}, "one layer has no stiffness against rotation"),
        ({"layers": "spring = 1, 2"}, "&layers needs y and spring"),
        ({"layers": "y = 0, 1"}, "&layers needs y and spring"),
        ({"layers": "y = 0, 1, 2, spring = 1, 2"}, "3 values of y and 2 of spring"),
        ({"layers": "y = 0, 1, spring = 1, 3"}, "there is no &layer_spring with id = 3"),
        ({"layers": "y = 'top', spring = 1"}, "y = 'top'"),
        ({"layers": "joint = 2, " + LAYERS}, "joint = 2; joints are 1 to n = 1"),
        ({"layers": [LAYERS, LAYERS]}, "&layers without joint appears twice"),
        ({"flexure": "rule = 'elastic', k = 1e8"}, "flexural spring"),
        ({"column": TWO.replace("7e5", "5e6")}, "cannot carry the axial load of 5e+06 N"),
        ({"column": TWO.replace("7e5", "-2e6")}, "cannot carry the axial load of -2e+06 N"),
    ],
)
def test_fault_of_a_layered_joint_is_told(run_cli, case_text, tmp_path, *, changes, said):
    # Bars that harden carry any load, in the end.
    text = case_text(**groups(**changes)).replace("k_post = 6e6", "k_post = 0")
    refused(run_cli, write(tmp_path, text), said)
