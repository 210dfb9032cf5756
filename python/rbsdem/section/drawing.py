"""A layered column from the groups of a case file that has its drawing."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import fields, replace
from typing import Any

from rbsdem import _core
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.model.column import Column
from rbsdem.model.materials import Concrete, Layout, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection, Section
from rbsdem.section.layered import LayeredColumn, LayeredModel
from rbsdem.section.parameters import VERSION, ModelParameters, parameters

Groups = Mapping[str, list[dict[str, Any]]]
"""The groups of a case file with their values by name; those of one name in their order."""

#: The classes of the shapes.
SHAPES: dict[str, type[Section]] = {
    "rectangle": RectangularSection,
    "circle": CircularSection,
    "hollow_rectangle": RectangularSection,
    "hollow_circle": CircularSection,
}

#: What groups with steels stand for.
_PARTS: dict[str, type] = {"layout": Layout, "inner_layout": Layout, "ties": Ties, "spiral": Spiral}


def layered_column(recipe: LayeredModel, given: Mapping[str, Any]) -> Column:
    """Return the column of a case that has its drawing.

    Parameters
    ----------
    recipe : LayeredModel
        The drawing.
    given : mapping
        The arguments of `rbsdem.Column` that the case gives, with its springs.

    Returns
    -------
    Column
        A `LayeredColumn` with the springs of the case; a plain column where these were drawn for
        another axial load than that of the case.

    Warns
    -----
    AccuracyWarning
        Where they are not those that the model draws.
    """
    column = LayeredColumn(**given, recipe=recipe)
    if column.recipe != recipe:
        warnings.warn(
            f"the springs of the case were drawn for axial_load = {recipe.axial_load:g} N, and its "
            f"column has {column.axial_load:g} N; it is solved with its own springs, and nothing "
            "is known of bars and concrete. To draw it again, make the column of its section",
            AccuracyWarning,
            stacklevel=3,
        )
        return Column(**given)
    other = column.replaced
    if other:
        warnings.warn(
            f"the case has {' and '.join(other)} other than layered {recipe.parameters.label} "
            "draws from its section; it is solved with its own springs, and what bars and concrete "
            "undergo is known only for a hinge that is as drawn. To draw the springs anew, make "
            "the column of case.column.recipe.section",
            AccuracyWarning,
            stacklevel=3,
        )
    return column


def recipe_of(groups: Groups) -> LayeredModel:
    """Return the drawing of a case.

    Parameters
    ----------
    groups : mapping
        The groups of the case, which are those of a drawing or others.

    Raises
    ------
    InputError
        If a value is refused, or the program does not know the version.
    """
    drawing = _one(groups, "drawing")
    changes = {one["name"]: one["value"] for one in groups.get("parameter", [])}
    made = _parameters(drawing.pop("version"), changes)
    return LayeredModel(section=_section(groups), parameters=made, **drawing)


def _parameters(version: str, changes: dict[str, float]) -> ModelParameters:
    made = parameters().with_values(**changes)
    if version != VERSION and set(made.values) - set(changes):
        raise InputError(
            f"drawing: version = {version!r} is not known; this program has {VERSION}, and takes "
            "another one with all of its parameters"
        )
    return replace(made, version=version)


def _section(groups: Groups) -> Section:
    steels: dict[int | None, Steel] = {}
    for one in groups.get("steel", []):
        values = _core.typed("steel", one)
        number = values.pop("id", None)
        steels.setdefault(number, Steel(**values))
    sizes = _one(groups, "section")
    shape = sizes.pop("shape")
    kind = SHAPES[shape]
    parts: dict[str, Any] = {"concrete": Concrete(**_one(groups, "concrete"))}
    if "bars" in groups:
        bars = _one(groups, "bars")
        rows = zip(bars["y"], bars["area"], bars["steel"], strict=True)
        parts["bars"] = [(y, area, steels[int(number)]) for y, area, number in rows]
    for name, part in _PARTS.items():
        if name in groups:
            values = _one(groups, name)
            used = {key: steels[values[key]] for key in values if key.endswith("steel")}
            parts[name] = part(**values | used)
    known = {field.name for field in fields(kind)}
    for name in (*sizes, *parts):
        solid = not shape.startswith("hollow")
        if name not in known or (solid and name in ("wall", "side_wall", "inner_layout")):
            raise InputError(f"section: {name} is not for shape = {shape!r}; remove it")
    return kind(**sizes, **parts)


def _one(groups: Groups, name: str) -> dict[str, Any]:
    """Return the values of a group that is there once."""
    if name not in groups:
        raise InputError(f"section: the group &{name} is missing; give it")
    return _core.typed(name, groups[name][0])
