"""Parameters of the layered model, the same for all columns: a table with values, bounds, meaning.

They are in `data/layered_parameters.csv`. A refit of the parameters is a new `VERSION`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from functools import cache, cached_property
from types import MappingProxyType

from rbsdem import _arguments, _package
from rbsdem.errors import InputError

VERSION = "2026.8"
"""Version of the parameters."""

#: Names that stand for a factor on several parameters: which, and what they are.
FACTORS: dict[str, tuple[tuple[str, ...], str]] = {
    "strength": (("steel_strength", "concrete_strength"), "strengths of steel and concrete"),
    "lengths": (
        ("hinge_length", "slip_length"),
        "lengths of hinge and slip: rotations of all bars",
    ),
    "softening": (
        ("core_softening", "cover_softening", "fatigue"),
        "slopes of core and cover behind the peak, fatigue of the bars",
    ),
}


@dataclass(frozen=True, slots=True)
class Row:
    """A parameter of the model.

    Attributes
    ----------
    name, meaning, unit, source : str
        Its name, what it is, its unit, and where its form or value comes from.
    value : float
        Its value.
    low, high : float
        Factors between which a calibration may change it; NaN if it may not.
    rank : int
        Its place among the parameters that a column offers one by one; 0: it is not offered.
    prior, spread : float
        What it was expected to be before the tests were looked at, and how far off it may be: the
        standard deviation of its logarithm, or of itself where the prior is 0. NaN and 0 for those
        that are not fitted.
    """

    name: str
    value: float
    low: float
    high: float
    rank: int
    prior: float
    spread: float
    unit: str
    meaning: str
    source: str


@cache
def table() -> Mapping[str, Row]:
    """Return the parameters of the model by name, those of the hinge first."""
    rows = {}
    for row in _package.rows("layered_parameters.csv"):
        numbers = {name: float(row[name] or "nan") for name in ("value", "low", "high", "prior")}
        numbers |= {"rank": int(row["rank"] or 0), "spread": float(row["spread"] or 0)}
        rows[row["name"]] = Row(**row | numbers)  # type: ignore[arg-type]
    return MappingProxyType(rows)


@dataclass(frozen=True)
class ModelParameters:
    """All parameters of the layered model.

    Attributes
    ----------
    version : str
        Version that they are, or that they were changed from.
    values : mapping of str to float
        All values by name; the names of the shear spring begin with ``shear_``.
    """

    version: str
    values: Mapping[str, float]

    def __post_init__(self) -> None:
        values = dict(self.values)
        for name, value in values.items():
            if type(value) is not float or not math.isfinite(value):
                known = f"parameters: {name}"
                values[name] = _arguments.within(_arguments.number(value, known), known)
        # Each value is an attribute too.
        self.__dict__.update(values, values=values)

    def __hash__(self) -> int:
        return hash((self.version, tuple(self.values.values())))

    def __getattr__(self, name: str) -> float:
        raise AttributeError(f"there is no parameter {name!r}")

    @cached_property
    def own(self) -> tuple[str, ...]:
        """Names of the parameters that differ from those of the version; all of another version."""
        if self.version != VERSION:
            return tuple(self.values)
        return tuple(name for name, row in table().items() if self.values[name] != row.value)

    @property
    def label(self) -> str:
        """The version, as "2026.8", or "2026.8 changed" where parameters differ from it."""
        changed = self.version == VERSION and self.own
        return f"{self.version} changed" if changed else self.version

    def with_values(self, **values: float) -> ModelParameters:
        """Return the parameters with other values of some.

        Parameters
        ----------
        **values
            Names as in `values`, such as ``steel_strength=1.0`` or ``shear_strength=1.1``; or one
            of `FACTORS`, by which several are multiplied.

        Raises
        ------
        InputError
            If a name is not known, or a value is not a finite number.
        """
        for name in [name for name in FACTORS if name in values]:
            factor = _arguments.number(values.pop(name), f"parameters: {name}")
            for one in FACTORS[name][0]:
                values[one] = factor * values.get(one, self.values[one])
        for name in values:
            if name not in self.values:
                known = [*self.values, *FACTORS]
                (near,) = get_close_matches(name, known, n=1, cutoff=0.0)
                raise InputError(f"parameters: {name!r} is not known; did you mean {near!r}?")
        return replace(self, values={**self.values, **values})


@cache
def parameters() -> ModelParameters:
    """Return the parameters of the layered model."""
    return ModelParameters(VERSION, {name: row.value for name, row in table().items()})
