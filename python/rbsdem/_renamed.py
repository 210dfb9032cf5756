"""Parameters with a new name: the old name raises an error that gives the new one."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from rbsdem.errors import InputError

Kind = TypeVar("Kind")
Function = TypeVar("Function", bound=Callable[..., Any])


def renamed(**names: str) -> Callable[[type[Kind]], type[Kind]]:
    """Make a class raise an error with the new name if an old parameter is given.

    Parameters
    ----------
    **names : str
        For each old name what the message gives: the new name, or what takes its place.
    """

    def change(kind: type[Kind]) -> type[Kind]:
        kind.__init__ = _watch(kind.__init__, kind.__name__, names)  # type: ignore[misc]
        return kind

    return change


def renamed_keywords(**names: str) -> Callable[[Function], Function]:
    """Do the same for a function."""

    def change(function: Function) -> Function:
        return cast(Function, _watch(function, function.__name__, names))

    return change


def _watch(function: Callable[..., Any], name: str, names: dict[str, str]) -> Callable[..., Any]:
    @wraps(function)
    def watched(*arguments: Any, **options: Any) -> Any:
        try:
            return function(*arguments, **options)
        except TypeError:
            for old in names.keys() & options.keys():
                raise InputError(f"{name}: {old} is now {names[old]}") from None
            raise

    return watched
