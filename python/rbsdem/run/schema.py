"""A JSON schema of a case, from the one list of keys."""

from __future__ import annotations

from typing import Any

from rbsdem import _core

#: JSON types of the kinds of keys.
_TYPES = {"real": "number", "integer": "integer", "logical": "boolean"}
#: Groups of springs, which have the parameters of their rule.
_SPRINGS = ("shear", "flexure", "axial_spring", "layer_spring")


def case_schema() -> dict[str, Any]:
    """Return the JSON schema of a case as an object of groups, as f90nml reads a case file.

    A group that may stand several times is an object or a list of them. Relations between
    keys, and which groups go together, are not in it: ``rbsdem check`` tells them.

    Returns
    -------
    dict
        A schema of draft 2020-12, for `json.dumps`.
    """
    keys = _core.keys()
    groups = {name: _group(name, own) for name, own in keys["groups"].items()}
    properties = {}
    for name in groups:
        one = {"$ref": f"#/$defs/{name}"}
        several = {"type": "array", "items": one}
        properties[name] = {"if": {"type": "array"}, "then": several, "else": one}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"https://rbsdem.invalid/case-{_core.version()}.json",
        "title": f"A case of rbsdem {_core.version()}",
        "type": "object",
        "properties": properties,
        "additionalProperties": False,
        "$defs": groups,
    }


def _group(name: str, keys: list[dict[str, Any]]) -> dict[str, Any]:
    """Return the schema of one group."""
    schema: dict[str, Any] = {
        "type": "object",
        "properties": {key["name"]: _key(key) for key in keys},
    }
    if name not in _SPRINGS:
        return schema | {"additionalProperties": False}
    schema["properties"]["rule"]["enum"] = list(_core.keys()["rules"])
    rules = [
        {
            "if": {"properties": {"rule": {"const": rule}}, "required": ["rule"]},
            "then": {"properties": {key["name"]: _key(key) for key in about["keys"]}},
        }
        for rule, about in _core.keys()["rules"].items()
    ]
    return schema | {"required": ["rule"], "allOf": rules, "unevaluatedProperties": False}


def _key(key: dict[str, Any]) -> dict[str, Any]:
    """Return the schema of one key; a list where it takes several values."""
    schema: dict[str, Any] = {"type": _TYPES.get(key["kind"], "string")}
    if key.get("choices"):
        schema["enum"] = key["choices"]
    # "minimum" or "exclusiveMinimum", "maximum" or "exclusiveMaximum".
    for bound, name in (("least", "inimum"), ("most", "aximum")):
        if bound in key:
            first = "m" if not key.get(f"{bound}_open") else "exclusiveM"
            schema[first + name] = key[bound]
    unit = f" [{key['unit']}]" if "unit" in key else ""
    about: dict[str, Any] = {"description": key["meaning"] + unit}
    if "default" in key:
        about["default"] = key["default"]
    if "values" in key:
        many = {"type": "array", "items": schema, "maxItems": key["values"]}
        return {"anyOf": [schema, many]} | about
    return schema | about
