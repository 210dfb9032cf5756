"""Columns from the properties of a specimen alone; nothing that was measured enters."""

from __future__ import annotations

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
    for name, new in _OLD.items():
        if name in options:
            raise InputError(f"{name}= is now {new}")
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
