"""The parameters of a column that may be free, and the column with other values."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import Any

from rbsdem import _arguments
from rbsdem.calibration import paths
from rbsdem.errors import InputError
from rbsdem.model.column import Column, Parameter, checked_column, is_recipe

#: Largest number of names in a message.
_MANY = 30


class Parameters:
    """The parameters of one column: those of its recipe, or otherwise the paths in it."""

    def __init__(self, column: Column) -> None:
        self.recipe = is_recipe(column)
        if not self.recipe:
            checked_column(column, "calibrate: ")
        self.column: Any = column  # with `parameters`, if it has a recipe
        self.ways = {} if self.recipe else paths.paths(column)

    @property
    def names(self) -> list[str]:
        """Names of all parameters."""
        return list(self.column.parameters) if self.recipe else list(self.ways)

    def known(self) -> dict[str, Parameter | None]:
        """Return all parameters by name; None for those whose bounds must be given."""
        if self.recipe:
            return dict(self.column.parameters)
        return {name: paths.parameter(self.column, name, way) for name, way in self.ways.items()}

    def start(self, name: str) -> float:
        """Return the value of a parameter in the column."""
        if self.recipe:
            return float(self.column.parameters[name].value)
        return paths.value_at(self.column, self.ways[name])

    def build(self, values: Mapping[str, float]) -> Column:
        """Return the column with other values, or raise `InputError` if it is refused."""
        if self.recipe:
            changed: Column = self.column.with_parameters(**values)
            return changed
        return paths.with_values(self.column, self.ways, values)

    def accepts(self, values: Mapping[str, float]) -> bool:
        """Return whether a column with these values is possible."""
        try:
            self.build(values)
        except InputError:
            return False
        return True


def free_parameters(
    parameters: Parameters, free: Sequence[str], bounds: Mapping[str, Sequence[float]] | None
) -> dict[str, Parameter]:
    """Return the parameters to fit, in the order of `free`, with their bounds.

    Raises
    ------
    InputError
        If names are unknown or repeated, or bounds are wrong.
    """
    names = _names(parameters, free)
    given = {name: _pair(name, pair) for name, pair in _mapping(bounds).items()}
    for name in given:
        if name not in names:
            raise InputError(f"calibrate: bounds: {name!r} is not in free ({', '.join(names)})")
    known = parameters.known()
    chosen = {}
    for name in names:
        one = known[name]
        if name in given:
            one = _within(parameters, name, one, given[name])
        if one is None:
            raise InputError(
                f"calibrate: {name} = {parameters.start(name):g} has no default bounds; give "
                f"bounds={{{name!r}: (low, high)}}"
            )
        chosen[name] = one
    return chosen if parameters.recipe else paths.settle(chosen, given, parameters.accepts)


def _names(parameters: Parameters, free: Any) -> list[str]:
    if isinstance(free, str) or not isinstance(free, Sequence | Mapping | set):
        raise InputError(f"calibrate: free = {free!r} must be a list of names")
    names = list(free)
    if not names:
        raise InputError(f"calibrate: free is empty; it names {_list(parameters.names)}")
    for name in names:
        if name not in parameters.names:
            raise _unknown(name, parameters)
        if names.count(name) > 1:
            raise InputError(f"calibrate: free: {name!r} comes twice")
    return names


def _unknown(name: Any, parameters: Parameters) -> InputError:
    near = get_close_matches(str(name), parameters.names, n=1, cutoff=0.0)
    if not near:
        return InputError(f"calibrate: free: {name!r}: this column has no parameters to fit")
    return InputError(
        f"calibrate: free: {name!r} is not a parameter of this column; did you mean {near[0]!r}? "
        f"It has {_list(parameters.names)}"
    )


def _list(names: Sequence[str]) -> str:
    """Return the names as a text; if there are too many, only the first."""
    if len(names) <= _MANY:
        return ", ".join(names)
    first = ", ".join(names[:_MANY])
    return f"{first} and {len(names) - _MANY} more (rbsdem.calibration.free_names lists them)"


def _mapping(bounds: Any) -> Mapping[str, Sequence[float]]:
    if bounds is None:
        return {}
    if not isinstance(bounds, Mapping):
        raise InputError(f"calibrate: bounds = {bounds!r} must be a mapping of name to (low, high)")
    return bounds


def _pair(name: str, pair: Any) -> tuple[float, float]:
    try:
        low, high = pair
    except (TypeError, ValueError):
        raise InputError(f"calibrate: bounds of {name} = {pair!r} must be (low, high)") from None
    about = f"calibrate: bounds of {name}"
    return _arguments.number(low, about), _arguments.number(high, about)


def _within(
    parameters: Parameters, name: str, one: Parameter | None, ends: tuple[float, float]
) -> Parameter:
    start = parameters.start(name)
    if ends[0] < ends[1] and not ends[0] <= start <= ends[1]:
        raise InputError(
            f"calibrate: bounds of {name}: {ends[0]:g} to {ends[1]:g} leave out the start "
            f"{start:g}; move the bounds, or start from another column"
        )
    if not parameters.recipe:
        least, most = paths.ends(parameters.column, parameters.ways[name])
        if ends[0] < least or ends[1] > most:
            side = f"below {least:g}" if ends[0] < least else f"above {most:g}"
            raise InputError(
                f"calibrate: bounds of {name}: {ends[0]:g} to {ends[1]:g} go {side}, which the "
                "column refuses; move the bound"
            )
    try:
        if one is None:
            unit = paths.unit_of(parameters.column, parameters.ways[name])
            return Parameter(start, *ends, unit, name)
        return replace(one, low=ends[0], high=ends[1])
    except InputError as error:
        raise InputError(f"calibrate: bounds of {name}: {error}") from None
