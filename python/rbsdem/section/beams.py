"""Beams with slabs and the nodes that they end in: width of the flange, rigid ends."""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.model.shape import Section, checked_section
from rbsdem.section.axial_moment import nominal_moment
from rbsdem.section.ranges import carried_load


def flange_width(
    web: float, thickness: float, clear_span: float, clear_distance: float, *, sides: int = 2
) -> float:
    """Return the effective width of a slab as the flange of a beam, with its web [m].

    Parameters
    ----------
    web : float
        Width of the web, b_w [m].
    thickness : float
        Thickness of the slab, h [m].
    clear_span : float
        Of the beam, l_n [m].
    clear_distance : float
        From web to web, s_w [m].
    sides : {1, 2}, optional
        Sides of the web with a slab: two of a tee, one of an L-section.

    Returns
    -------
    float
        b_w + 2 min(8 h, s_w/2, l_n/8), or b_w + min(6 h, s_w/2, l_n/12) of an L-section.

    Raises
    ------
    InputError
        If an argument is refused.

    Notes
    -----
    ACI 318-19, table 6.3.2.1. Where the slab is in tension, its bars within the same width count
    (18.7.3.2); tests have that much at 2 % drift (French and Moehle 1991).
    """
    sizes = {
        "web": web, "thickness": thickness, "clear_span": clear_span,
        "clear_distance": clear_distance,
    }  # fmt: skip
    b_w, h, l_n, s_w = (
        _arguments.number(value, f"flange_width: {name}", above=0.0)
        for name, value in sizes.items()
    )
    if _arguments.integer(sides, "flange_width: sides") not in (1, 2):
        raise InputError(f"flange_width: sides = {sides} must be 1 or 2")
    times, part = (8.0, 8.0) if sides == 2 else (6.0, 12.0)
    return b_w + sides * min(times * h, 0.5 * s_w, l_n / part)


def rigid_ends(
    columns: Section | Sequence[Section],
    beams: Section | Sequence[Section],
    *,
    axial_load: float | Sequence[float] = 0.0,
    share: float | Literal["asce"] = "asce",
) -> tuple[float, float]:
    """Return the `rigid_end` of the columns and of the beams in a node [m].

    Parameters
    ----------
    columns, beams : Section or sequence of Section
        All columns that meet in the node, and all beams.
    axial_load : float or sequence of float, optional
        Compression of the columns, of all or of each [N].
    share : float or "asce", optional
        Which part of the node is rigid in both, from 0 (members reach to the axes) to 1 (to the
        faces); by default as strength has it, by the rule of ASCE 41-17, 10.4.2.2.1: where the
        columns are stronger than 1.2 times the beams they are rigid in the node and the beams are
        not, where they are weaker than 0.8 times the beams the other way round, and half of the
        node is between.

    Returns
    -------
    tuple of float
        Of the columns, a part of half of the depth of the deepest beam, and of the beams, the same
        part or another of half of that of the deepest column.

    Raises
    ------
    InputError
        If an argument is refused.

    Notes
    -----
    Strengths are sums of the nominal moments of ACI 318-19; of members with unlike faces the means
    of both, as in a node with a beam on each side, or where the load comes from both sides.
    """
    sections = [
        [checked_section(one) for one in ([given] if isinstance(given, Section) else given)]
        for given in (columns, beams)
    ]
    if not all(sections):
        raise InputError("rigid_ends: a node has one column and one beam at least; give them")
    if share == "asce":
        loads = np.broadcast_to(axial_load, len(sections[0])).tolist()
        column = sum(map(_strength, sections[0], loads))
        beam = sum(_strength(one, 0.0) for one in sections[1])
        parts = (1.0, 0.0) if column > 1.2 * beam else (0.0, 1.0)
        if 0.8 * beam <= column <= 1.2 * beam:
            parts = (0.5, 0.5)
    else:
        part = _arguments.number(share, "rigid_ends: share", least=0.0, most=1.0)
        parts = part, part
    half = [0.5 * max(one.depth for one in several) for several in sections]
    return parts[0] * half[1], parts[1] * half[0]


@lru_cache(maxsize=1024)
def _strength(section: Section, axial_load: float) -> float:
    """Return the mean of the nominal moments to both sides [N m]."""
    moments = [
        nominal_moment(one, carried_load(axial_load, one)) for one in (section, section.mirrored)
    ]
    if not math.isfinite(sum(moments)):
        raise InputError(
            f"rigid_ends: axial_load = {axial_load:g} N is more than ACI 318-19 gives the section"
        )
    return 0.5 * sum(moments)
