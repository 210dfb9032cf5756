"""One list of keys: dataclasses, keywords of the analyses, documents and messages agree with it."""

from __future__ import annotations

import dataclasses
import importlib.util
import inspect
import json
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import MISSING, fields
from types import ModuleType, UnionType
from typing import Any, Literal, Union, get_args, get_origin, get_type_hints

import pytest
from conftest import REPOSITORY
from strategies import GOOD

import rbsdem
from rbsdem import _core
from rbsdem.model.column import Damping
from rbsdem.model.springs import SPRINGS
from rbsdem.run.case import Case
from rbsdem.run.groups import SHAPES
from rbsdem.run.solver import IN_TIME, STATIC
from rbsdem.springs import Elastic, Layered

KEYS = _core.keys()
RULES = KEYS["rules"]
NO_VALUE = object()

Key = dict[str, Any]


def group(name: str) -> dict[str, Key]:
    return {key["name"]: key for key in KEYS["groups"][name]}


def words(hint: Any) -> set[str]:
    """Words of a Literal, also where None is allowed too."""
    if get_origin(hint) in (Union, UnionType):
        return set().union(*(words(one) for one in get_args(hint)))
    return set(get_args(hint)) if get_origin(hint) is Literal else set()


def default_of(key: Key) -> Any:
    """The default that Python gives: that of the key, None for what may be missing."""
    if "default" in key:
        return key["default"]
    return None if key.get("optional") else NO_VALUE


def agree(kind: type, keys: dict[str, Key], apart: set[str]) -> None:
    """Fields of a dataclass and keys: the same names, defaults and words."""
    hints = get_type_hints(kind)
    own = {field.name: field for field in fields(kind) if field.init and field.name not in apart}
    assert set(own) == set(keys)
    for name, field in own.items():
        default = NO_VALUE if field.default is MISSING else field.default
        assert default == default_of(keys[name]), name
        assert words(hints[name]) == set(keys[name].get("choices", ())), name


def test_every_rule_has_a_class():
    assert set(SPRINGS) == set(RULES)


@pytest.mark.parametrize("rule", RULES)
def test_parameters_of_a_spring_are_the_keys_of_its_rule(rule):
    keys = {key["name"]: key for key in RULES[rule]["keys"]}
    agree(SPRINGS[rule], keys, {"layers"} if rule == "layered" else set())


@pytest.mark.parametrize("rule", RULES)
def test_places_of_a_rule_are_where_a_column_takes_it(rule):
    """`suits` of the Fortran part, seen through the door of a column."""
    values = GOOD.get(rule)
    if values is None:
        values = {"layers": [(-0.1, Elastic(1e8)), (0.1, Elastic(1e8))]}
    spring, elastic = SPRINGS[rule](**values), Elastic(1e8)
    taken = set()
    column = {"height": 1, "mass": 1, "shear": elastic, "flexure": elastic}
    for place, made in {
        "shear": lambda: {"shear": spring},
        "flexure": lambda: {"flexure": spring},
        "axial": lambda: {"axial_spring": spring},
        "layer": lambda: {"flexure": Layered([(-0.1, spring), (0.1, elastic)])},
    }.items():
        try:
            rbsdem.Column(**(column | made()))
            taken.add(place)
        except rbsdem.InputError:
            pass
    assert taken == set(RULES[rule]["places"].split())


def test_fields_of_a_column_are_the_keys_of_its_group():
    column = group("column")
    column["mass"] = {"name": "mass", "kind": "real"}  # Python asks for it, or for None
    column["model"] = column["model"] | {"default": ""}  # no text is an empty one
    footing = {name: column.pop(f"footing_{name}") for name in ("mass", "inertia", "height")}
    springs = {"shear", "flexure", "axial_spring"}
    agree(rbsdem.Column, column, springs | {"damping", "drawing", "footing"})
    agree(rbsdem.Footing, footing, springs)


def test_fields_of_damping_are_the_keys_of_its_group():
    agree(Damping, group("damping"), set())


def keywords(function: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    return dict(inspect.signature(function, eval_str=False).parameters)


@pytest.mark.parametrize("rule", sorted(set(RULES) - {"layered", "compression", "concrete"}))
def test_words_are_known_in_any_case(tmp_path, rule):
    """Names of rules and other words of a case file and of Python, in capitals."""
    spring = SPRINGS[rule](**GOOD[rule])
    own = rbsdem.Column(2.0, 1e3, spring, spring, kinematics="pdelta", top="fixed")
    assert own == dataclasses.replace(own, kinematics="PDelta", top="FIXED")
    text = "&units force = 'N', length = 'm' /\n" + own.to_namelist()
    text += "&loading drive = 'displacement', amplitudes = 0.01, 0.02 /\n"
    for name, given in (("a", text), ("b", re.sub(r"'\w+'", lambda word: word[0].upper(), text))):
        (tmp_path / f"{name}.nml").write_text(given)
    assert rbsdem.read_case(tmp_path / "a.nml") == rbsdem.read_case(tmp_path / "b.nml")


def test_keywords_of_the_analyses_are_the_keys_of_their_groups():
    settings = group("analysis") | {
        name: group("output")[name] for name in ("every", "openings", "motion")
    }
    loads = set(group("loading")["drive"]["choices"])
    known = keywords(rbsdem.cyclic) | keywords(rbsdem.time_history)
    # The end of the times is the duration; the rest has no key.
    hints = get_type_hints(rbsdem.Solver)
    own = {"column", "time", "initial", "solver", "corners"}
    assert set(known) | set(hints) == (set(settings) | loads | own) - {"duration"}
    for name in set(settings) & set(known):
        default = known[name].default
        assert default == (False if settings[name]["kind"] == "logical" else None), name
    assert words(hints["events"]) == set(settings["events"]["choices"])
    assert words(hints["method"]) == set(settings["method"]["choices"]) - set(STATIC)
    assert words(get_type_hints(rbsdem.cyclic)["method"]) == set(STATIC)
    assert set(IN_TIME) == words(hints["method"])


def test_drives_of_a_case_are_the_loads_of_python():
    drives = group("loading")["drive"]["choices"]
    assert set(drives) <= {field.name for field in fields(Case)}


def test_executable_prints_the_same_list(run_cli):
    printed = run_cli(["keys", "--json"])
    assert (printed.returncode, printed.stderr) == (0, "")
    assert json.loads(printed.stdout) == KEYS
    table = run_cli(["keys"]).stdout.splitlines()
    names = [line.split()[0] for line in table if line.startswith("  ")]
    lists = [*KEYS["groups"].values(), *(rule["keys"] for rule in RULES.values())]
    assert names == [key["name"] for keys in lists for key in keys]


def tables() -> ModuleType:
    """The script that writes the tables of the documents."""
    path = REPOSITORY / "scripts" / "key_tables.py"
    spec = importlib.util.spec_from_file_location("key_tables", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_input_reference_has_a_table_for_each_list_of_keys():
    text = (REPOSITORY / "docs" / "input.md").read_text("utf-8")
    script = tables()
    shown = {found["name"] for found in script.BLOCK.finditer(text)}
    filled = script.filled(text)
    assert "| `height` | number | m | > 0 | required |" in filled
    assert filled.count(script.HEAD) == len(shown) - 1
    # &flexure and &axial_spring have the keys of &shear, and layered joints have no parameters.
    assert KEYS["groups"]["shear"] == KEYS["groups"]["flexure"] == KEYS["groups"]["axial_spring"]
    assert KEYS["groups"]["layout"] == KEYS["groups"]["inner_layout"]
    assert shown == (
        set(KEYS["groups"]) - {"flexure", "axial_spring", "inner_layout"}
        | {f"shape {name}" for name in SHAPES}
        | {f"rule {name}" for name in RULES if name != "layered"}
        | {"places"}
    )


def test_tables_of_the_rules_name_every_key_and_default():
    """docs/rules.md says more of each parameter; names and defaults are those of the program."""
    text = (REPOSITORY / "docs" / "rules.md").read_text("utf-8")
    sections = re.split(r"^## \d+\. ", text, flags=re.MULTILINE)
    found = {section.split("\n", 1)[0]: section for section in sections}
    for title, rules in {
        "Parameters": ("peak_oriented", "pinching"),
        "Concrete": ("concrete",),
        "Steel": ("steel",),
    }.items():
        keys = {key["name"]: key for rule in rules for key in RULES[rule]["keys"]}
        named = set()
        table = re.search(r"^\| name \|.*?(?=\n\n)", found[title], re.MULTILINE | re.DOTALL)
        assert table, title
        for row in table[0].splitlines()[2:]:
            first, meaning = row.strip("| ").split(" | ")[:2]
            names = re.findall(r"`([\w…]+)`", first)
            if names == ["…_neg"]:
                names = [name for name in keys if name.endswith("_neg")]
            named |= set(names)
            said = re.search(r"defaults? ([\d., ]+\d|\d)", meaning)
            numbers = re.findall(r"\d[\d.]*", said[1]) if said else []
            known = [keys[name]["default"] for name in names if "default" in keys[name]]
            if len(numbers) == 1:
                assert {float(numbers[0])} == set(known), row
            elif numbers:
                assert [float(number) for number in numbers] == known, row
            else:
                assert not any(known), row
        assert named == set(keys), title


def test_schema_of_a_case():
    """It is a schema, takes a case and refuses slips; it follows from the list of keys."""
    jsonschema = pytest.importorskip("jsonschema")
    schema = json.loads(
        subprocess.run(
            [sys.executable, "-m", "rbsdem", "keys", "--schema"],
            capture_output=True, check=True, text=True,
        ).stdout
    )  # fmt: skip
    check = jsonschema.Draft202012Validator(schema)
    check.check_schema(schema)
    case = {
        "column": {"height": 1.6, "mass": 600.0, "kinematics": "pdelta"},
        "shear": {"rule": "elastic", "k": 1e8},
        "flexure": [{"rule": "bilinear", "k": 1e8, "d_y": 1e-3, "k_post": 1e5, "joint": 1}],
        "loading": {"drive": "displacement", "amplitudes": [0.01, 0.02], "cycles": 2},
    }
    assert list(check.iter_errors(case)) == []
    for group, slip, said in (
        ("column", {"hieght": 1.0}, "'hieght' was unexpected"),
        ("column", {"height": -1.0}, "-1.0 is less than or equal to the minimum of 0"),
        ("column", {"kinematics": "pdleta"}, "'pdleta' is not one of"),
        ("shear", {"rule": "elastic", "k": 1.0, "d_y": 1.0}, "'d_y' was unexpected"),
        ("shear", {"rule": "elastik"}, "'elastik' is not one of"),
        ("loading", {"cycles": 1.5}, "1.5 is not of type 'integer'"),
    ):
        errors = list(check.iter_errors(case | {group: slip}))
        context = [e.message for error in errors for e in (error, *error.context)]
        assert any(said in message for message in context), (slip, context)
