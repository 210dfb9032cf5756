"""Columns with other ends, from a cantilever."""

from __future__ import annotations

import dataclasses
from typing import Any, TypeVar

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.model.column import Column, checked_column
from rbsdem.model.springs import Layered, Spring, SteelSpring, whole_column

__all__ = ["double_curvature", "turned"]

C = TypeVar("C", bound=Column)

#: A deformation that no spring reaches [m or rad].
_NEVER = 1e30


def double_curvature(column: C, *, top_mass: float = 0.0, prismatic: bool | None = None) -> C:
    """Return the column in double curvature whose lower half is a cantilever.

    The upper half is the lower one turned about the middle, where the moment is zero: 2 n - 1
    bodies of twice the height, on 2 n joints, the last one at a top that is fixed against rotation.
    At equal shear and axial load its top moves twice as far as that of the cantilever, as long as
    both halves do the same.

    Parameters
    ----------
    column : Column
        The lower half, with a free top, without a footing and without a mass at its top.
    top_mass : float, optional
        Mass that moves with the top [kg]; a dynamic analysis needs it.
    prismatic : bool, optional
        Whether the sections of the upper half are not turned: the same face of the column is in
        tension at one end and in compression at the other. It matters for springs whose sides
        differ. The default is what a column knows that was made from a section that is not
        symmetric, else no.

    Returns
    -------
    Column
        Of the same class, with all that is not said above as it was.

    Raises
    ------
    InputError
        If the column is no such cantilever, or a spring cannot be turned.
    """
    checked_column(column, "double_curvature: ")
    if prismatic is None:
        prismatic = column._prismatic
    prismatic = _arguments.switch(prismatic, "double_curvature: prismatic")
    refused = {
        "top": column.top != "free",
        "footing": column.footing is not None,
        "top_mass": bool(column.top_mass or column.top_inertia),
        "axial_height": column.axial_height is not None,
        "axial_follows or force_follows": column.axial_follows or column.force_follows,
    }
    for name, given in refused.items():
        if given:
            raise InputError(
                f"double_curvature: the column must be a plain cantilever, without {name}; "
                "give the ends of the whole column afterwards, with dataclasses.replace"
            )
    n = 2 * column.n - 1
    lengths = list(column.lengths or [column.height / column.n] * column.n)
    changes: dict[str, Any] = {
        "height": 2 * column.height,
        "n": n,
        "lengths": _doubled(lengths),
        "top": "fixed",
        "top_mass": _arguments.number(top_mass, "double_curvature: top_mass"),
    }
    if column.mass is not None:
        changes["mass"] = 2 * column.mass
    if column.masses is not None:
        changes["masses"] = _doubled(list(column.masses))
    inertia = column.rotary_inertia
    if inertia is not None:
        parts = list(inertia) * column.n if len(inertia) == 1 else list(inertia)
        masses = list(column.masses or [column.mass * part / column.height for part in lengths])
        # Two halves side by side, each half its length from the middle of the body that they make.
        middle = 2 * (parts[-1] + masses[-1] * (lengths[-1] / 2) ** 2)
        changes["rotary_inertia"] = [*parts[:-1], middle, *parts[-2::-1]]
    for name in ("shear", "flexure", "axial_spring"):
        # The spring of a whole cantilever is one of each half here.
        springs = [part.split(1) if whole_column(part) else part for part in column.joints(name)]
        if springs:
            # A slip keeps its sign when the half is turned, a rotation does not.
            of_the_half = name == ("shear" if prismatic else "flexure")
            turn = turned if of_the_half else _same_at_the_top
            changes[name] = (*springs, *(turn(spring) for spring in reversed(springs)))
    return dataclasses.replace(column, **changes)


def _doubled(parts: list[float]) -> list[float]:
    """Return the parts of both halves; the two at the middle are one."""
    return [*parts[:-1], 2 * parts[-1], *parts[-2::-1]]


def _same_at_the_top(spring: Spring) -> Spring:
    return spring


def turned(spring: Spring) -> Spring:
    """Return a spring that does for negative deformations what another does for positive.

    Parameters
    ----------
    spring : Spring
        The other.

    Raises
    ------
    InputError
        If its rule has no such spring.
    """
    if isinstance(spring, Layered):
        return Layered(tuple((-y, layer) for y, layer in spring.layers))
    if isinstance(spring, SteelSpring) and spring.d_buckle is not None:
        raise InputError(
            "double_curvature: a flexural SteelSpring with d_buckle buckles on one side only, and "
            "cannot be turned; give it no d_buckle"
        )
    sides = [part.name for part in dataclasses.fields(spring) if part.name.endswith("_neg")]
    given = {name: getattr(spring, name) for name in sides}
    if all(value is None for value in given.values()):
        return spring
    changes = {}
    for name, value in given.items():
        plain = name.removesuffix("_neg")
        changes[name] = getattr(spring, plain)
        if value is not None:
            changes[plain] = value
    if changes["d_u_neg"] is None and "d_u" in changes:
        # What is not given would be that of the positive side, which has an end now.
        changes["d_u_neg"] = _NEVER
    return dataclasses.replace(spring, **changes)
