"""One check for both doors: what a file is refused for, Python is refused for with the same words.

The columns, dampings and settings of `test_command_line.py` go through the executable; here the
parameters of every rule, and columns as wholes, go through the reader of files.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import rbsdem
from rbsdem import _core
from rbsdem.springs import (
    SPRINGS,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    SteelSpring,
    Takeda,
)

CAPPED = {"d_y": 1e-3, "f_y": 1e5, "d_cap": 1e-2, "f_cap": 1.2e5, "d_pc": 0.1}
GOOD: dict[str, dict[str, float]] = {
    "elastic": {"k": 1e8},
    "bilinear": {"k": 1e8, "d_y": 1e-3, "k_post": 1e6},
    "takeda": {"k_c": 2e8, "d_c": 1e-3, "k_y": 1e8, "d_y": 2e-3, "k_u": 1e6},
    "compression": {"k": 1e8},
    "peak_oriented": CAPPED,
    "pinching": CAPPED | {"kappa_f": 0.5, "kappa_d": 0.5},
    "concrete": {"k": 1e9, "f_peak": 1e6, "d_peak": 2e-3, "k_soft": 1e8},
    "steel": {"k": 1e9, "f_y": 1e6, "k_post": 1e7},
}
NAN, INF = float("nan"), float("inf")
# Relations between parameters: what the rules check themselves.
RELATIONS: list[tuple[str, dict[str, float]]] = [
    ("bilinear", {"k_post": 1e8}),
    ("takeda", {"k_y": 3e8}),
    ("takeda", {"k_u": 1.1e8}),
    ("takeda", {"d_y": 5e-4}),
    ("takeda", {"k_c": 0.0, "d_y": NAN, "b0": -1.0}),
    ("peak_oriented", {"d_cap": 5e-4}),
    ("peak_oriented", {"f_cap": 1e9}),
    ("peak_oriented", {"f_res": 2e5}),
    ("peak_oriented", {"d_c": 1e-4}),
    ("peak_oriented", {"d_c": 1e-4, "f_c": 1e3}),
    ("peak_oriented", {"d_u": 5e-3}),
    ("peak_oriented", {"d_y_neg": 0.5}),
    ("pinching", {"kappa_f": 1.5, "kappa_d": 0.0, "c": 0.5}),
    ("concrete", {"f_peak": 3e6}),
    ("concrete", {"f_res": 2e6}),
    ("steel", {"k_post": 1e9}),
]


def said(call: Callable[[], object]) -> list[str]:
    with pytest.raises(rbsdem.InputError) as caught:
        call()
    return str(caught.value).splitlines()


def shown(value: Any) -> str:
    """A value as it stands in a file."""
    if isinstance(value, str):
        return f"'{value}'"
    if isinstance(value, bool):
        return f".{str(value).lower()}."
    return ", ".join(repr(one) for one in np.atleast_1d(value).tolist())


def entries(values: dict[str, Any]) -> str:
    return ", ".join(f"{name} = {shown(value)}" for name, value in values.items())


def faulty_values() -> Iterator[tuple[str, dict[str, float]]]:
    """Yield each parameter of each rule: not finite, extreme, on the wrong side of its bounds."""
    for rule, good in GOOD.items():
        for key in _core.keys()["rules"][rule]["keys"]:
            if key["kind"] != "real":
                continue
            values = [NAN, -INF, 1e60]
            if "least" in key:
                values.append(key["least"] if key.get("least_open") else key["least"] - 0.5)
            if "most" in key:
                values.append(key["most"] if key.get("most_open") else key["most"] + 0.5)
            for value in values:
                yield rule, good | {key["name"]: value}


@pytest.mark.parametrize("rule", GOOD)
def test_parameters_of_springs_are_refused_with_the_same_words(tmp_path, case_text, rule):
    path = tmp_path / "case.nml"
    group = "axial_spring" if rule in ("compression", "concrete") else "flexure"
    name = {"axial_spring": "axial spring", "flexure": "flexure spring"}[group]
    faults = [values for one, values in faulty_values() if one == rule]
    faults += [GOOD[rule] | values for one, values in RELATIONS if one == rule]
    faults += [{key: value for key, value in GOOD[rule].items() if key != "k"} | {"k": NAN}] * (
        "k" in GOOD[rule]
    )
    assert len(faults) >= 4
    for values in faults:
        path.write_text(case_text(**{group: f"rule = '{rule}', {entries(values)}"}))
        python = said(lambda values=values: SPRINGS[rule](**values))
        file = said(lambda: rbsdem.read_case(path))
        assert [re.sub(rf"^line \d+: {name}: ", "", line) for line in file] == [
            line.removeprefix(f"{rule} spring: ") for line in python
        ], values


def test_missing_parameters_are_named_in_a_file(tmp_path, case_text):
    """Python asks for them in its own words, as for the arguments of any function."""
    path = tmp_path / "case.nml"
    for rule, good in GOOD.items():
        group = "axial_spring" if rule in ("compression", "concrete") else "flexure"
        path.write_text(case_text(**{group: f"rule = '{rule}'"}))
        required = [
            key["name"]
            for key in _core.keys()["rules"][rule]["keys"]
            if "default" not in key and not key.get("optional")
        ]
        assert set(required) == set(good)
        lines = said(lambda: rbsdem.read_case(path))
        assert [line.split(": ")[2].split()[0] for line in lines] == required


E, SOFT = Elastic(1e8), Compression(1e8)
STEEL, CONCRETE = SteelSpring(8e8, 7e5, 0.0), ConcreteSpring(4e9, 1.2e6, 6e-4, 8e7)
LAYERS = Layered([(-0.1, STEEL), (0.0, CONCRETE), (0.1, STEEL)])
LAYERS_TEXT = (
    "&flexure rule = 'layered' /\n"
    "&layer_spring id = 1, rule = 'steel', k = 8e8, f_y = 7e5, k_post = 0 /\n"
    "&layer_spring id = 2, rule = 'concrete', k = 4e9, f_peak = 1.2e6, d_peak = 6e-4, "
    "k_soft = 8e7 /\n"
    "&layers y = -0.1, 0.0, 0.1, spring = 1, 2, 1 /\n"
)
SIZES = {"height": 2.0, "mass": 500.0}
ELASTIC_TEXT = "rule = 'elastic', k = 1e8"

# Fields of a column and, where they are springs or damping, the groups of the file instead.
COLUMNS: dict[str, tuple[dict[str, Any], dict[str, str]]] = {
    "rule at the wrong joint": ({"shear": SOFT}, {"shear": "rule = 'compression', k = 1e8"}),
    "rules at the wrong joints": (
        {"flexure": CONCRETE, "axial_spring": Takeda(2e8, 1e-3, 1e8, 2e-3, 1e6)},
        {
            "flexure": "rule = 'concrete', k = 4e9, f_peak = 1.2e6, d_peak = 6e-4, k_soft = 8e7",
            "axial_spring": "rule = 'takeda', k_c = 2e8, d_c = 1e-3, k_y = 1e8, d_y = 2e-3, "
            "k_u = 1e6",
        },
    ),
    "load over the capacity of layers": (
        {"flexure": LAYERS, "axial_load": 3e6, "kinematics": "pdelta"},
        {"flexure": LAYERS_TEXT},
    ),
    "tension over the capacity of layers": (
        {"flexure": LAYERS, "axial_load": -2e6},
        {"flexure": LAYERS_TEXT},
    ),
    "word": ({"kinematics": "finit"}, {}),
    "words and numbers": ({"kinematics": "big", "n": 0, "top_mass": -1.0, "gravity": NAN}, {}),
    "lists": ({"n": 2, "lengths": [1.0, -1.0], "rotary_inertia": [1.0, 2.0, 3.0]}, {}),
    "both": ({"depth": 0.4, "rotary_inertia": 3.0}, {}),
    "follows": ({"axial_follows": True, "force_follows": True}, {}),
    "damping": (
        {"damping": rbsdem.Damping(-1.0, INF, modal=[0.1, 2.0])},
        {"damping": "mass = -1.0, stiffness = inf, modal = 0.1, 2.0"},
    ),
    "tangent": ({"damping": rbsdem.Damping(tangent=True)}, {"damping": "tangent = T"}),
    "ratios for too many bodies": ({"damping": 0.05, "n": 501}, {"damping": "modal = 0.05"}),
    "everything": (
        {"height": -1.0, "mass": 0.0, "axial_load": INF, "damping": -0.5, "shear": SOFT},
        {"damping": "modal = -0.5", "shear": "rule = 'compression', k = 1e8"},
    ),
}


def case_of(fields: dict[str, Any], groups: dict[str, str]) -> str:
    """A case with the fields of a column, and groups in place of springs and damping."""
    own = {
        name: value
        for name, value in (SIZES | fields).items()
        if name not in ("shear", "flexure", "axial_spring", "damping")
    }
    lines = [f"&column {entries(own)} /\n"]
    for name in ("shear", "flexure", "axial_spring", "damping"):
        text = groups.get(name, ELASTIC_TEXT if name in ("shear", "flexure") else "")
        if text:
            lines.append(text if text.startswith("&") else f"&{name} {text} /\n")
    drive = "drive = 'displacement', amplitudes = 0.001"
    return "".join(lines) + f"&loading {drive} /\n"


@pytest.mark.parametrize("name", COLUMNS)
def test_columns_are_refused_with_the_same_words(tmp_path: Path, name):
    fields, groups = COLUMNS[name]
    (tmp_path / "case.nml").write_text(case_of(fields, groups))
    python = said(lambda: rbsdem.Column(**({"shear": E, "flexure": E} | SIZES | fields)))
    file = said(lambda: rbsdem.read_case(tmp_path / "case.nml"))
    # Springs of a file have lines.
    assert [re.sub(r"^line \d+: ", "", line) for line in file] == python


# Histories: values in the file itself.
HISTORIES: dict[str, dict[str, Any]] = {
    "times that do not ascend": {"time": [0.0, 0.2, 0.1], "force": [0.0, 1.0, 2.0]},
    "one time": {"time": [0.0], "force": [1.0]},
    "step over the limit": {"time": [0.0, 1.0], "force": [0.0, 1.0], "dt": 0.5},
    "too many steps": {"time": [0.0, 1.0], "force": [0.0, 1.0], "dt": 1e-12},
    "vertical motion without effect": {"time": [0.0, 1.0], "vertical_acceleration": [0.0, 1.0]},
    "axial load without effect": {"time": [0.0, 1.0], "axial_load": [0.0, 1.0]},
}


@pytest.mark.parametrize("name", HISTORIES)
def test_histories_are_refused_with_the_same_words(run_cli, tmp_path: Path, name):
    given = HISTORIES[name]
    drive = next(one for one in given if one not in ("time", "dt"))
    loading = f"drive = '{drive}', time = {shown(given['time'])}, values = {shown(given[drive])}"
    text = case_of({}, {}).rsplit("&loading", 1)[0]
    method = "method = 'rk4'" + (f", dt = {given['dt']!r}" if "dt" in given else "")
    (tmp_path / "case.nml").write_text(f"{text}&loading {loading} /\n&analysis {method} /\n")
    column = rbsdem.Column(**SIZES, shear=E, flexure=E)
    python = said(lambda: rbsdem.time_history(column, method="rk4", **given))
    result = run_cli(["check", "case.nml"], tmp_path)
    assert result.returncode == 2
    file = [line.removeprefix("rbsdem: ") for line in result.stderr.splitlines()]
    assert [line.removeprefix("loading: ") for line in file] == python
