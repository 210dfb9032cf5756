"""Parameters that have a new name: giving an old one raises an error that says the new one."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar, cast

from rbsdem.errors import InputError

Kind = TypeVar("Kind")
Function = TypeVar("Function", bound=Callable[..., Any])


def renamed(**names: str) -> Callable[[type[Kind]], type[Kind]]:
    """Make a class name the new parameter where an old one is given.

    Parameters
    ----------
    **names : str
        What the message says for each old name: the new name, or where it went.
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
