"""Force-displacement curves as arguments: an object with both, or a pair of arrays."""

from __future__ import annotations

from typing import Any, Protocol, TypeAlias

from numpy.typing import ArrayLike

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError


class HasLoop(Protocol):
    """Anything with a loop, such as a `rbsdem.Result` or a test from `rbsdem.peer.read_peer`."""

    @property
    def displacement(self) -> Array:
        """Displacement, row by row [m]."""

    @property
    def force(self) -> Array:
        """Force, row by row [N]."""


Curve: TypeAlias = HasLoop | tuple[ArrayLike, ArrayLike]


def loop_pair(curve: Any, name: str) -> tuple[Any, Any]:
    """Return displacement and force of a loop: of a response in time its base shear; see `pair`."""
    if hasattr(curve, "loop_force"):
        return curve.path.displacement, curve.path.loop_force
    return pair(curve, name)


def pair(curve: Any, name: str) -> tuple[Any, Any]:
    """Return displacement and force of an object that has both, or of a pair.

    Parameters
    ----------
    curve : Curve
        The object or the pair.
    name : str
        Its name in messages.

    Raises
    ------
    InputError
        If it is neither.
    """
    if hasattr(curve, "displacement") and hasattr(curve, "force"):
        return curve.displacement, curve.force
    try:
        displacement, force = curve
    except (TypeError, ValueError):
        raise InputError(
            f"{name} is neither an object with displacement and force nor a pair of the two"
        ) from None
    return displacement, force


def columns(names: tuple[str, ...], *values: ArrayLike, least: int = 2) -> list[Array]:
    """Return arrays of finite numbers, all of the same length.

    Parameters
    ----------
    names : tuple of str
        Names of the arrays in messages.
    *values : array_like, shape (rows,)
        The arrays.
    least : int, default 2
        Smallest number of rows.

    Raises
    ------
    InputError
        If a value is not a finite number, the lengths differ, or there are fewer rows.
    """
    arrays = [
        _arguments.finite_vector(value, name) for name, value in zip(names, values, strict=True)
    ]
    first = arrays[0].size
    for name, array in zip(names, arrays, strict=True):
        if array.size != first:
            raise InputError(
                f"{name} has {array.size} rows, {names[0]} has {first}; they must be equal"
            )
    if first < least:
        raise InputError(f"{names[0]} has {first} rows; a curve needs at least {least}")
    return arrays
