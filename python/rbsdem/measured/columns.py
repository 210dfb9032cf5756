"""Columns from the properties of a specimen alone; nothing that was measured enters."""

from __future__ import annotations

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, Literal, get_args, overload

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.measured.drawing import draw
from rbsdem.measured.specimen import Specimen
from rbsdem.model.column import Column
from rbsdem.model.shape import Section
from rbsdem.section.columns import DEFAULT, MODELS, Model
from rbsdem.section.columns import column as column_of
from rbsdem.section.layered import LayeredColumn

__all__ = ["column"]

_OPTIONS = ("n", "model_parameters", "restrained", "round_core", "ends", "footing")

#: The equivalent cantilever of the table, or the form of the test.
Ends = Literal["equivalent", "tested"]


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
        As for `rbsdem.section.column`.
    **options
        As there: ``n``, ``model_parameters``. ``ends="tested"`` makes a double
        curvature specimen (config DC) what it is, twice as long with a hinge at each end: its top
        moves twice as far as the displacement of the test. The default, ``"equivalent"``, is the
        cantilever that all lengths and displacements of the table belong to and the model was
        fitted to: the same within 1e-5 and half the work, until shear softens. Then all further
        slip of the whole specimen is at one end, which its equal halves cannot tell (docs/peer.md).
        ``footing`` is what the column stands on.

    Returns
    -------
    Column
        With second-order effects of the axial load at the height where it acts.

    Raises
    ------
    InputError
        If the model is not known, if the section cannot be analysed, or if the table does not say
        enough of the ends of the test.
    """
    _arguments.choice(model, "model", MODELS)
    checked_specimen(specimen)
    check_options(options)
    tested = _tested(specimen, options.pop("ends", "equivalent"), options.get("footing"))
    drawn = draw(specimen)
    if model == "layered":
        options = {
            "restrained": drawn.restrained,
            "round_core": drawn.round_core,
            **options,
        }
    halves = 2 if tested and specimen.config == "DC" else 1
    return column_of(
        drawn.section,
        halves * specimen.length,
        axial_load=specimen.axial_load,
        mass=halves * specimen.mass,
        model=model,
        axial_height=None if halves == 2 else specimen.axial_height,
        top="fixed" if halves == 2 else "free",
        **options,
    )


def _tested(specimen: Specimen, ends: str, footing: object) -> bool:
    """Return whether the ends are to be those of the test; refuse what the table does not give."""
    if ends not in get_args(Ends):
        raise InputError(f"ends = {ends!r} is not known; it is one of {', '.join(get_args(Ends))}")
    if ends == "equivalent":
        return False
    if specimen.config == "CFB" and footing is None:
        raise InputError(
            f"{specimen.name}: the stiffness of its flexible base is not in the table; give "
            "footing=, or take ends='equivalent'"
        )
    if specimen.config == "DC" and specimen.axial_height != specimen.length:
        raise InputError(
            f"{specimen.name}: its axial load acts at {specimen.axial_height:g} m, not at the "
            f"length of {specimen.length:g} m; take ends='equivalent', which has that lever"
        )
    return True


def checked_specimen(specimen: object) -> Specimen:
    """Return a specimen, or raise `InputError` for anything else."""
    if isinstance(specimen, Specimen):
        return specimen
    given = repr(specimen)
    if len(given) > 60:
        given = f"a {type(specimen).__name__}"
    remedy = "rbsdem.peer.read_specimens reads them from a table"
    if isinstance(specimen, Section):
        remedy = (
            "of a section, rbsdem.section.column(section, height, axial_load=...) makes a column"
        )
    raise InputError(f"specimen = {given} must be a Specimen; {remedy}")


def check_options(options: Mapping[str, object]) -> None:
    """Raise `InputError` for options that `rbsdem.section.column` does not have."""
    for name in options:
        if name not in _OPTIONS:
            near = get_close_matches(name, _OPTIONS, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InputError(
                f"the option {name} is not known; there are {', '.join(_OPTIONS)}{hint}"
            )
