"""Tables of the keys of a case, for docs/input.md as it is built.

A table stands at ``<!-- keys: NAME -->``. NAME is a group of a case file, ``rule`` and the name
of a rule, ``shape`` and that of a section's, or ``places``: the groups where each rule may stand.
The list is that of ``rbsdem keys --json``.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Iterator
from typing import Any

BLOCK = re.compile(r"<!-- keys: (?P<name>[\w ]+) -->\n")

HEAD = "| key | value | unit | allowed | default | meaning |\n" + "| --- " * 6 + "|\n"

#: Units of the parameters of a spring: for slip and opening, and for rotation.
DIMENSIONS = {"force": "N; N m", "deformation": "m; rad", "stiffness": "N/m; N m/rad"}


def shown(value: float) -> str:
    """Return a number as short as it can be."""
    return f"{value:.12g}"


def allowed(key: dict[str, Any]) -> str:
    """Return the range of a number, or the words that a key takes."""
    if "choices" in key:
        return ", ".join(f"`'{word}'`" for word in key["choices"])
    least, most = key.get("least"), key.get("most")
    above = ">" if key.get("least_open") else "≥"
    if most is None:
        return "" if least is None else f"{above} {shown(least)}"
    below = "<" if key.get("most_open") else "≤"
    return f"{above} {shown(least)}, {below} {shown(most)}"


def default(key: dict[str, Any]) -> str:
    """Return what holds where the key is not given."""
    if "default" not in key:
        return "none" if key.get("optional") or key["kind"] == "text" else "required"
    value = key["default"]
    if isinstance(value, bool):
        return f"`.{str(value).lower()}.`"
    return f"`'{value}'`" if isinstance(value, str) else shown(value)


def kind(key: dict[str, Any]) -> str:
    """Return what a key takes: one value of a kind, or several."""
    word = {"real": "number", "integer": "whole number", "logical": "switch"}.get(
        key["kind"], key["kind"]
    )
    return f"{word}s" if key.get("values", 1) > 1 else word


def rows(keys: list[dict[str, Any]]) -> Iterator[str]:
    """Yield the rows; keys one after the other that differ in their names only share one."""
    last: tuple[str, ...] = ()
    names: list[str] = []
    for key in [*keys, {}]:
        cells = ()
        if key:
            unit = key.get("unit", "")
            cells = (
                kind(key), DIMENSIONS.get(unit, unit) or "–", allowed(key), default(key),
                key["meaning"],
            )  # fmt: skip
        if cells != last and names:
            yield f"| {', '.join(names)} | {' | '.join(last)} |\n"
            names = []
        if key:
            names.append(f"`{key['name']}`")
        last = cells


#: Groups by the places of a rule.
PLACES = {"shear": "shear", "flexure": "flexure", "axial": "axial_spring", "layer": "layer_spring"}


def places(rules: dict[str, Any]) -> str:
    """Return the table of the groups where each rule may stand."""
    text = f"| rule | {' | '.join(f'`&{group}`' for group in PLACES.values())} |\n"
    text += "| --- " * (len(PLACES) + 1) + "|\n"
    for name, rule in rules.items():
        cells = ["yes" if place in rule["places"].split() else "" for place in PLACES]
        text += f"| `'{name}'` | {' | '.join(cells)} |\n"
    return text


def table(known: dict[str, Any], name: str) -> str:
    """Return the table of a group, of a rule, or of the places of all rules."""
    if name == "places":
        return places(known["rules"])
    kind, _, which = name.partition(" ")
    if kind == "rule":
        keys = known["rules"][which]["keys"]
    elif kind == "shape":
        keys = known["section"][which]
    else:
        keys = known["groups"][name]
    return HEAD + "".join(rows(keys))


def filled(text: str) -> str:
    """Return a page with its tables."""
    command = [sys.executable, "-m", "rbsdem", "keys", "--json"]
    known = json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)
    return BLOCK.sub(lambda block: f"\n{table(known, block['name'])}\n", text)
