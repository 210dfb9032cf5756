"""Walls: one that stands alone, and the members of one that goes through the storeys of a frame."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem.errors import InputError, warn
from rbsdem.model.column import Footing, Top
from rbsdem.model.frame import FrameMember
from rbsdem.model.springs import Elastic, Gauge, Layered, Spring, unchecked
from rbsdem.model.wall import WallSection
from rbsdem.section.columns import column
from rbsdem.section.curvature import column_length
from rbsdem.section.layered import LayeredColumn, LayeredModel, area_of_rest, part_of_height
from rbsdem.section.parameters import ModelParameters, parameters

#: Moment over shear at the foot over the height of a wall in a building: that of a triangular load
#: on many storeys is 2/3, and fewer have more.
SHARE_OF_HEIGHT = 0.7

#: Height of a storey over the thickness of a wall, from which on it may buckle out of its plane.
_SLENDER = 20.0

#: Parts of a storey that are shorter than this share of it do not bend; how much stiffer than the
#: wall a joint is that does not.
_SHORTEST, _STIFF = 1e-3, 1e3

Hinges = Literal["base", "all"]


def wall(
    section: WallSection,
    height: float,
    *,
    axial_load: float,
    shear_span: float | None = None,
    mass: float | None = None,
    n: int | None = None,
    model_parameters: ModelParameters | None = None,
    top: Top = "free",
    footing: Footing | None = None,
) -> LayeredColumn:
    """Return a wall that stands alone, with second-order effects of the axial load.

    It is a column of the layered model: a joint at the foot whose layers are strips of boundary
    core, confined by its own hoops, of cover and of web, and bars; an elastic wall above it that
    cracks; a shear spring in series. Its parameters are those fitted to columns; the shear spring
    has a relation of its own for walls (`rbsdem.section.strength.wall_shear_strength`).

    Parameters
    ----------
    section : WallSection
        The section.
    height : float
        From the foot to the lateral load [m]; with a fixed top the clear height.
    axial_load : float
        Compression positive [N].
    shear_span : float, optional
        Moment over shear at the foot, for which the springs are made [m]; by default the height,
        or half of it under a fixed top.
    mass, n, model_parameters, top, footing
        As for `rbsdem.section.column`.

    Returns
    -------
    LayeredColumn
        With the wall as its drawing.

    Raises
    ------
    InputError
        If a value is refused, or the section cannot carry the axial load.
    """
    _checked_wall(section)
    if shear_span is not None:
        shear_span = column_length(shear_span, "shear_span")
    given: Any = {"mass": mass, "n": n, "model_parameters": model_parameters}
    ends: Any = {"top": top, "footing": footing, "shear_span": shear_span}
    made: LayeredColumn = column(section, height, axial_load=axial_load, **given, **ends)
    return made


def _checked_wall(section: object) -> WallSection:
    return _arguments.instance(section, "wall: section", WallSection, "rbsdem.WallSection")


def wall_members(
    section: WallSection | Sequence[WallSection],
    storeys: Sequence[float],
    *,
    axial_loads: float | Sequence[float] = 0.0,
    shear_span: float | None = None,
    hinges: Hinges = "base",
    model_parameters: ModelParameters | None = None,
) -> tuple[FrameMember, ...]:
    """Return the kinds of members of a wall that goes through the storeys of a frame.

    Their springs are those of the whole wall: of moment over shear at its foot, not of half of a
    storey. The foot has a joint of layers, and so has the base of every storey in which the section
    changes. Each storey has a joint in its middle that cracks, and its part of the wall's shear
    spring.

    Parameters
    ----------
    section : WallSection or sequence of WallSection
        The section of all storeys, or that of each, from the ground up.
    storeys : sequence of float
        Heights of the storeys [m].
    axial_loads : float or sequence of float, optional
        Compression under the dead load, of all storeys or of each [N].
    shear_span : float, optional
        Moment over shear at the foot [m]; by default 0.7 of the height of all storeys.
    hinges : {"base", "all"}, optional
        "all": a joint of layers at the base of every storey.
    model_parameters : ModelParameters, optional
        As for `rbsdem.section.column`.

    Returns
    -------
    tuple of FrameMember
        One for each storey, from the ground up.

    Raises
    ------
    InputError
        If a value is refused, or a section cannot carry its axial load.

    Warns
    -----
    AccuracyWarning
        Where a storey is more than 20 times as high as the wall is thick.
    """
    heights = _arguments.vector(storeys, "wall_members: storeys", shape="1 or m").tolist()
    number = len(heights)
    each = [section] * number if isinstance(section, WallSection) else list(section)
    loads = np.atleast_1d(np.asarray(axial_loads, dtype=float))
    for name, size in (("sections", len(each)), ("axial_loads", loads.size)):
        if size not in ({1, number} if name == "axial_loads" else {number}):
            raise InputError(f"wall_members: {size} {name} for {number} storeys; give one for each")
    loads = np.broadcast_to(loads, number)
    hinges = _arguments.choice(hinges, "wall_members: hinges", ("base", "all"))
    span = SHARE_OF_HEIGHT * sum(heights) if shear_span is None else shear_span
    span = column_length(span, "wall_members: shear_span")
    levels = np.concatenate(([0.0], np.cumsum(heights)))
    ratio, storey = max(
        (height / _checked_wall(one).thickness, i)
        for i, (height, one) in enumerate(zip(heights, each, strict=True), 1)
    )
    if ratio > _SLENDER:
        warn(
            f"wall_members: storey {storey} of {heights[storey - 1]:g} m is {ratio:.3g} times as "
            "high as the wall is thick; beyond 20 it may buckle out of its plane, which is not in "
            "the model"
        )
    # Up to the level `elastic` the joint of layers below stands for the wall.
    made, elastic = [], 0.0
    for i, (low, high) in enumerate(pairwise(levels.tolist())):
        own = _checked_wall(each[i])
        foot = None
        if i == 0 or hinges == "all" or each[i] != each[i - 1]:
            foot = _foot(
                own, float(loads[i]), float(span) - low, high - low, i > 0, model_parameters
            )
            elastic = low + foot.joint.length
        place = float(span), low, high, max(low, elastic)
        of_foot = foot and (foot.joint.spring, foot.joint.gauge)
        made.append(_storey(own, float(loads[i]), place, of_foot, model_parameters))
    return tuple(made)


@lru_cache(maxsize=1024)
def _foot(
    section: WallSection,
    axial_load: float,
    span: float,
    height: float,
    above: bool,
    model: ModelParameters | None,
) -> LayeredModel:
    """Return what the joint of layers at the base of a storey is made from."""
    values = model or parameters()
    if above:
        # Bars go on below: nothing slips.
        values = values.with_values(slip_length=0.0)
    return LayeredModel(section, max(span, 0.5 * height), axial_load, 2, values)


@lru_cache(maxsize=1024)
def _storey(
    section: WallSection,
    axial_load: float,
    place: tuple[float, float, float, float],
    foot: tuple[Layered, Gauge] | None,
    model: ModelParameters | None,
) -> FrameMember:
    """Return the kind of one storey.

    `place` has M/V at the foot of the wall, the lower and the upper level of the storey, and the
    level above which the storey bends [m]; `foot` is the joint of layers at its base, if any.
    """
    span, low, high, begins = place
    height, part = high - low, high - begins
    whole = LayeredModel(section, span, axial_load, 2, model or parameters())
    flexure: dict[float, Spring] = {} if foot is None else {0.0: foot[0]}
    if part < _SHORTEST * height:
        # All of the storey is part of the joint below.
        flexure[0.5] = unchecked(Elastic, k=_STIFF * whole.joint.flexural_stiffness / height)
    else:
        # From the middle of the part to where the moment is zero: at its end at the least.
        arm = max(span - 0.5 * (begins + high), 0.5 * part)
        # The joint in the middle bends the storey as much as all of its part does.
        stiffness = whole.joint.flexural_stiffness / part / (1.0 + part / (6.0 * arm))
        middle = (0.5 * (begins + high) - low) / height
        flexure[middle] = whole.above(stiffness, arm + 0.5 * part, arm - 0.5 * part)
    area, modulus = section.gross_area, section.concrete_law["ec"]
    return FrameMember(
        modulus=modulus,
        area=area_of_rest(area, modulus, height, foot[:1] if foot else ()),
        inertia=section.inertia,
        flexure=flexure,
        shear={0.0: part_of_height(whole.shear[0], height / span)},
        interior="rigid",
        length=height,
        sections=(section, section),
        shear_spans=((span, span), (span, span)) if low == 0.0 else None,
        gauge=foot and foot[1],
    )
