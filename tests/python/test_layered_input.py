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
