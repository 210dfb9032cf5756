"""Columns from the properties of a specimen alone; nothing that was measured enters."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, Literal, overload

from rbsdem.column import Column
from rbsdem.errors import InputError
from rbsdem.peer.drawing import draw
from rbsdem.peer.specimen import Specimen
from rbsdem.section.model import DEFAULT, LayeredColumn, Model, check_model

__all__ = ["column"]

#: Options by their names before 2026.
_OLD = {
    "hinge": "model_parameters=rbsdem.section.parameters().with_values(...)",
    "shear_numbers": "model_parameters=rbsdem.section.parameters().with_values(shear_...=...)",
}

_OPTIONS = ("n", "version", "model_parameters", "restrained", "round_core")


@overload
def column(
    specimen: Specimen, model: Literal["layered"] = "layered", **options: Any
) -> LayeredColumn: ...
@overload
def column(specimen: Specimen, model: Literal["paper"], **options: Any) -> Column: ...
def column(specimen: Specimen, model: Model = DEFAULT, **options: Any) -> Column:
    """Make the column of a specimen.

    Parameters
    ----------
    specimen : Specimen
        The test; only its properties are looked at.
    model : {"layered", "paper"}, optional
        As for `rbsdem.section.Section.column`.
    **options
        As there: ``n``, ``version``, ``model_parameters``.

    Returns
    -------
    Column
        With second-order effects of the axial load at the height where it acts.

    Raises
    ------
    InputError
        If the model is not known, or if the section cannot be analysed.
    """
    check_model(model)
    checked_specimen(specimen)
    check_options(options)
    drawing = draw(specimen)
    if model == "layered":
        options = {
            "restrained": drawing.restrained,
            "round_core": drawing.shape == "square with spiral",
            **options,
        }
    return drawing.section().column(
        specimen.length,
        axial_load=specimen.axial_load,
        mass=specimen.mass,
        model=model,
        axial_height=specimen.axial_height,
        **options,
    )


def checked_specimen(specimen: object) -> Specimen:
    """Return a specimen, or raise `InputError` for anything else."""
    if isinstance(specimen, Specimen):
        return specimen
    given = repr(specimen)
    if len(given) > 60:
        given = f"a {type(specimen).__name__}"
    remedy = "rbsdem.peer.read_specimens reads them from a table"
    if hasattr(specimen, "column"):
        remedy = "a section makes its column itself: section.column(height, axial_load=...)"
    raise InputError(f"specimen = {given} must be a Specimen; {remedy}")


def check_options(options: Mapping[str, object]) -> None:
    """Raise `InputError` for options that `rbsdem.section.Section.column` does not have."""
    for name in options:
        if name in _OLD:
            raise InputError(f"{name}= is now {_OLD[name]}")
        if name not in _OPTIONS:
            near = get_close_matches(name, _OPTIONS, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InputError(
                f"the option {name} is not known; there are {', '.join(_OPTIONS)}{hint}"
            )
