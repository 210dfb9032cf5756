"""A parameter that a calibration may change: its value, its bounds and its meaning."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

from rbsdem import _arguments
from rbsdem.errors import InputError

if TYPE_CHECKING:
    from rbsdem.model.column import Column


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter with the range in which it has a meaning.

    If both bounds are positive, the parameter is searched on a logarithmic scale, on which half and
    twice the value are equally far away. This suits stiffnesses, strengths and lengths.

    Parameters
    ----------
    value : float
        Value to start from, within the bounds [unit].
    low, high : float
        Bounds [unit].
    unit : str, optional
        Unit, as in "N/m"; empty for a bare number.
    what : str, optional
        Its meaning, for reports.

    Raises
    ------
    InputError
        If a value or bound is not finite, the bounds are reversed, or the value is outside them.
    """

    value: float
    low: float
    high: float
    unit: str = ""
    what: str = ""

    def __post_init__(self) -> None:
        about = f"parameter{f' {self.what}' if self.what else ''}"
        _arguments.convert(self, about)
        for name in ("value", "low", "high"):
            if not math.isfinite(getattr(self, name)):
                raise InputError(f"{about}: {name} = {getattr(self, name)} must be a finite number")
        if not self.low < self.high:
            raise InputError(
                f"{about}: bounds {self.low:g} and {self.high:g} must be a lower and a higher one"
            )
        if not self.low <= self.value <= self.high:
            raise InputError(
                f"{about}: value = {self.value:g} is outside its bounds {self.low:g} to "
                f"{self.high:g}; move the bounds or the value"
            )

    @property
    def logarithmic(self) -> bool:
        """Whether the parameter is searched on a logarithmic scale."""
        return self.low > 0

    def place(self, value: float) -> float:
        """Return the place of a value between the bounds, from 0 to 1."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def at(self, place: float) -> float:
        """Return the value at a place from 0 to 1 between the bounds."""
        if place <= 0 or place >= 1:
            return self.low if place <= 0 else self.high
        if self.logarithmic:
            value = self.low * math.pow(self.high / self.low, place)
        else:
            value = self.low + place * (self.high - self.low)
        return min(max(value, self.low), self.high)

    def per_place(self, value: float) -> float:
        """Return the derivative of the value with respect to its place [unit]."""
        if self.logarithmic:
            return value * math.log(self.high / self.low)
        return self.high - self.low


@runtime_checkable
class Recipe(Protocol):
    """A column made from few parameters, such as strengths, that a calibration may change."""

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """The parameters, by name."""

    def with_parameters(self, **values: float) -> Column:
        """Return the column with other values; values that are not named are kept."""


def is_recipe(column: Any) -> bool:
    """Return whether a column offers its own parameters for a calibration."""
    return isinstance(column, Recipe) and isinstance(column.parameters, Mapping)
