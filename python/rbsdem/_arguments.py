"""Checks of arguments: one function for each kind.

Each returns the value in its own type, or raises `InputError` with the name, the value and what it
must be.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import fields
from functools import cache, partial
from pathlib import Path
from types import NoneType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError

T = TypeVar("T")
Number = TypeVar("Number", int, float)

#: Larger numbers have no meaning in any unit (the constant `beyond_meaning`).
BEYOND_MEANING = 1e50

#: Letters of a value in a message.
_MOST = 60
#: Types that `float` takes, but are no numbers.
_NO_NUMBERS = (bool, np.bool_, str, bytes, bytearray, np.datetime64, np.timedelta64)


#: The largest whole number of Fortran.
_LARGEST_INTEGER = 2**31 - 1


def shown(value: object) -> str:
    """Return a value for a message; of a record, or where it is long, only its kind."""
    try:
        told = repr(value)
    except Exception:  # Classes of the caller raise anything, and ints of many digits too.
        told = ""
    if 0 < len(told) <= _MOST and "\n" not in told:
        return told
    kind = type(value).__name__
    return f"{'an' if kind[0] in 'aeiou' else 'a'} {kind}"


def one_line(text: str) -> str:
    """Return a text without the characters that separate keys and groups of a statement."""
    return "".join(character if character.isprintable() else " " for character in text)


def number(value: Any, name: str, **bounds: Any) -> float:
    """Return `value` as a float; with bounds see `within`."""
    if bounds:
        return within(number(value, name), name, **bounds)
    if type(value) is float:
        return value
    try:
        if isinstance(value, _NO_NUMBERS):
            raise TypeError
        if isinstance(value, np.ndarray) and (value.ndim or value.dtype.kind not in "iuf"):
            raise TypeError
        return float(value)
    except OverflowError:
        raise InputError(f"{name} = {shown(value)} is too large") from None
    except Exception:  # Classes of the caller raise anything.
        raise InputError(f"{name} = {shown(value)} must be a number") from None


def within(
    value: Number,
    name: str,
    *,
    above: float | None = None,
    least: float | None = None,
    below: float | None = None,
    most: float | None = None,
    unit: str = "",
    hint: str = "",
) -> Number:
    """Return a number if it is finite and within its bounds; `hint` ends the message.

    `above` and `below` are excluded, `least` and `most` are not.
    """
    low = -np.inf if least is None else least
    high = np.inf if most is None else most
    inside = low <= value <= high and abs(value) < np.inf
    if inside and (above is None or value > above) and (below is None or value < below):
        return value
    ends = {"above": above, "from": least, "below": below, "at most": most}
    said = [f"{word} {bound:.15g}" for word, bound in ends.items() if bound is not None]
    text = " and ".join(said) or "a finite number"
    if least is not None:
        text = f"{least:.15g} or more" if len(said) == 1 else text.replace(" and ", " to ", 1)
        text = text.replace(" to at most ", " to ")
    text += " and finite" if said and not abs(value) < np.inf else ""
    raise InputError(f"{name} = {value:.6g}{unit and ' '}{unit} must be {text}{hint}")


def integer(value: Any, name: str, **bounds: Any) -> int:
    """Return `value` as an int; with bounds see `within`."""
    if bounds:
        return within(integer(value, name), name, **bounds)
    # In numpy a span of time, timedelta64, is a whole number: `_NO_NUMBERS` keeps it out.
    if isinstance(value, _NO_NUMBERS) or not isinstance(value, (int, np.integer)):
        raise InputError(f"{name} = {shown(value)} must be a whole number")
    if abs(int(value)) > _LARGEST_INTEGER:
        raise InputError(f"{name} = {shown(value)} is too large")
    return int(value)


def boolean(value: Any, name: str) -> bool:
    """Return `value` as a bool."""
    if isinstance(value, (bool, np.bool_, int, np.integer)) and value in (0, 1):
        return bool(value)
    raise InputError(f"{name} = {shown(value)} must be True or False")


def text(value: Any, name: str) -> str:
    """Return `value` if it is a text."""
    if isinstance(value, str):
        return value
    raise InputError(f"{name} = {shown(value)} must be a text")


def is_one_of(value: Any, words: Iterable[str]) -> bool:
    """Return whether `value` is one of some words; an array, for one, is none."""
    return isinstance(value, str) and value in words


def seed(value: Any, name: str = "seed") -> int:
    """Return `value` as the seed of random numbers."""
    return integer(value, name, least=0)


def choice(value: Any, name: str, words: Iterable[str]) -> Any:
    """Return the one of some words that `value` is, whose case does not matter."""
    words = tuple(words)
    for word in words:
        if isinstance(value, str) and value.lower() == word.lower():
            return word
    raise InputError(f"{name} = {shown(value)} is not known; it is one of {', '.join(words)}")


def vector(values: ArrayLike, name: str, *, shape: str = "m") -> Array:
    """Return `values` as an array of floats.

    `shape` is "m" for one dimension, "1 or m" where one number stands for an array of one, "any".
    """
    try:
        array = np.asarray(values)
        # numpy would use the value below a mask.
        if np.ma.is_masked(values) or (array.dtype.kind not in "iuf" and array.size):
            raise TypeError
        array = array.astype(np.float64)
    except Exception:  # Classes of the caller raise anything.
        raise InputError(f"{name} = {shown(values)} must be an array of numbers", name) from None
    if shape == "any":
        return array
    if shape == "1 or m" and array.ndim == 0:
        array = array[None]
    if array.ndim != 1:
        raise InputError(f"{name} has shape {array.shape}; it must have one dimension", name)
    return np.ascontiguousarray(array)


def finite_vector(values: ArrayLike, name: str, *, shape: str = "m") -> Array:
    """Return what `vector` returns for `values`, each finite and at most `BEYOND_MEANING`."""
    array = vector(values, name, shape=shape)
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InputError(
            f"{name}: value {bad[0] + 1} of {array.size} is {array.flat[bad[0]]}; "
            "it must be a finite number"
        )
    beyond = np.flatnonzero(np.abs(array) > BEYOND_MEANING)
    if beyond.size:
        raise InputError(
            f"{name}: value {beyond[0] + 1} of {array.size} is {array.flat[beyond[0]]}; "
            "products of it would not be finite: check its exponent and unit"
        )
    return array


def path(value: Any, name: str = "path") -> Path:
    """Return `value` as a path, with the home folder in place of a tilde."""
    if isinstance(value, (str, os.PathLike)):
        try:
            plain = os.fspath(value)
            if isinstance(plain, str) and plain and "\0" not in plain:
                os.fsencode(plain)
                return Path(plain).expanduser()
        except Exception:  # Classes of the caller raise anything; no file has such a name.
            pass
    raise InputError(f"{name} = {shown(value)} is not the path of a file or folder")


def file(value: Any, name: str = "path") -> str:
    """Return the path of a file that can be read to its end: a device has none."""
    plain = os.fspath(path(value, name))
    try:
        mode = os.stat(plain).st_mode
    except OSError:
        # Its reader says what is wrong.
        return plain
    if stat.S_ISCHR(mode) or stat.S_ISBLK(mode):
        raise InputError(f"{plain} is a device; give the path of a file")
    return plain


def instance(value: Any, name: str, kind: type[T], remedy: str = "") -> T:
    """Return `value` if it is of a class."""
    if isinstance(value, kind):
        return value
    remedy = f"; {remedy}" if remedy else ""
    article = "" if kind.__name__.endswith("s") else "a "
    raise InputError(f"{name} = {shown(value)} must be {article}{kind.__name__}{remedy}")


# `dataclasses.replace` hands on what an object holds, whether it was given or not: a number that
# followed from another must be known as such, or it would stay behind when the other changes.
class Derived(float):
    """A number that was not given."""

    __slots__ = ()


def given(value: float | None) -> float | None:
    """Return a value if somebody gave it, else None."""
    return None if isinstance(value, Derived) else value


def convert(record: object, who: str) -> None:
    """Make the fields of a new frozen record what their annotations say, or raise `InputError`.

    Fields are numbers, whole numbers, switches, words or records; None and what followed from
    another number stay where they may be. Fields of other types are left to the record.
    """
    kind: type = type(record)
    for name, make, optional, plain in _conversions(kind):
        value = getattr(record, name)
        # Most values are what they have to be.
        if type(value) is not plain and not (optional and given(value) is None):
            put(record, **{name: make(value, f"{who}: {name}")})


def put(record: object, **values: Any) -> None:
    """Set fields of a frozen record, as only its own making may."""
    for name, value in values.items():
        object.__setattr__(record, name, value)


_PLAIN: dict[Any, Callable[[Any, str], Any]] = {
    float: number, int: integer, bool: boolean, str: text,
}  # fmt: skip


@cache
def _conversions(record: type) -> list[tuple[str, Callable[[Any, str], Any], bool, Any]]:
    """Return name and conversion of the fields that have one, and whether they may be None.

    Last is the type whose values the conversion leaves as they are; None where it looks further.
    """
    hints = get_type_hints(record)
    conversions = []
    for name in [field.name for field in fields(record)]:
        kinds = [kind for kind in get_args(hints[name]) if kind is not NoneType]
        optional = len(kinds) < len(get_args(hints[name]))
        kind = kinds[0] if optional and len(kinds) == 1 else hints[name]
        make = _PLAIN.get(get_origin(kind) or kind)
        if get_origin(kind) is Literal:
            make = partial(_word, get_args(kind))
        if make is None and isinstance(kind, type):
            make = partial(_instance_of, kind)
        if make is not None:
            conversions.append((name, make, optional, None if kind is int else kind))
    return conversions


def _word(words: tuple[str, ...], value: object, name: str) -> str:
    """Return the word that a text is, whose case does not matter; another text is left as it is."""
    given = text(value, name)
    return next((word for word in words if word.lower() == given.lower()), given)


def _instance_of(kind: type[T], value: object, name: str) -> T:
    return instance(value, name, kind)


def several(values: Any, name: str, of: str = "whole numbers") -> list[Any]:
    """Return the items of a sequence; a text and a mapping are none."""
    if not isinstance(values, (str, bytes, dict)):
        try:
            return list(values)
        except Exception:  # Classes of the caller raise anything.
            pass
    raise InputError(f"{name} = {shown(values)} must be a sequence of {of}")


#: More faults than this are only counted.
MOST_FAULTS = 25


@contextmanager
def collected(faults: list[str], who: str = "") -> Iterator[None]:
    """Add the error of an input to the faults, which are raised together."""
    try:
        yield
    except InputError as error:
        faults.append(f"{who}{error}")


def raise_faults(faults: list[str]) -> None:
    """Raise `InputError` with a line for each fault, if there is any."""
    if not faults:
        return
    more = len(faults) - MOST_FAULTS
    text = "\n".join(faults[:MOST_FAULTS])
    raise InputError(text + (f"\nand {more} more" if more > 0 else ""))
