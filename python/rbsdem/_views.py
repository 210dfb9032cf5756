"""The functions that draw a record or make a table of it.

A record (a comparison, a diagram, the rows of a trade) does not import its views. The module that
draws a record registers its functions here, and the methods `plot`, `table` and others of the
record look them up here. So imports go one way: this module <- records <- views. The package of a
record imports its views, which registers them.
"""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeVar

Function = TypeVar("Function", bound=Callable[..., Any])

_FUNCTIONS: dict[tuple[type, str], Callable[..., Any]] = {}


def view_of(kind: type, name: str) -> Callable[[Function], Function]:
    """Register the decorated function as a view of a record.

    Parameters
    ----------
    kind : type
        Class of the record.
    name : str
        Name of the view, usually that of the method: "plot", "table".
    """

    def register(function: Function) -> Function:
        _FUNCTIONS[kind, name] = function
        return function

    return register


def view(record: object, name: str, *arguments: Any, **options: Any) -> Any:
    """Call the view of a record with the record and the arguments, and return its result."""
    import_module("rbsdem._registered")
    for kind in type(record).__mro__:
        if (kind, name) in _FUNCTIONS:
            return _FUNCTIONS[kind, name](record, *arguments, **options)
    raise NotImplementedError(f"there is no {name} of a {type(record).__name__}")
