"""Problems of others whose answers are printed, beside the answers of the program."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import DataFrame
from rbsdem.errors import InputError
from rbsdem.methods.problems import PROBLEMS, Problem
from rbsdem.model.column import notes_off


@dataclass(frozen=True)
class Comparison:
    """A printed number beside that of the program.

    Attributes
    ----------
    problem : Problem
        What it belongs to.
    printed : str
        As it is printed.
    value : float
        Of the program.
    """

    problem: Problem
    printed: str
    value: float

    @property
    def units(self) -> float:
        """Difference in units of the last printed digit."""
        digits, _, exponent = self.printed.lower().partition("e")
        last = 10.0 ** (int(exponent or 0) - len(digits.partition(".")[2]))
        return (self.value - float(self.printed)) / last

    @property
    def difference(self) -> float:
        """Difference over the printed number, or as it is where that is zero."""
        printed = float(self.printed)
        return (self.value - printed) / (abs(printed) or 1.0)

    @property
    def inside(self) -> bool:
        """Whether they differ by less than a unit of the last digit: a printed one may be cut."""
        return abs(self.units) <= 1.0

    @property
    def holds(self) -> bool:
        """Whether it is inside the printed digits, or as close as its remark says."""
        return self.inside or abs(self.difference) <= self.problem.within


@dataclass(frozen=True, repr=False)
class Verification(Tabular):
    """Printed numbers of problems of others beside those of the program.

    Attributes
    ----------
    comparisons : tuple of rbsdem.methods.verification.Comparison
        In the order of the problems.
    """

    comparisons: tuple[Comparison, ...]

    @property
    def holds(self) -> bool:
        """Whether every number is inside the printed digits, or explained by a remark."""
        return all(one.holds for one in self.comparisons)

    def worst(self) -> Verification:
        """Return the number of each problem that differs most, in units of its last digit."""
        found: dict[Problem, Comparison] = {}
        for one in self.comparisons:
            if one.problem not in found or abs(one.units) > abs(found[one.problem].units):
                found[one.problem] = one
        return Verification(tuple(found.values()))

    def to_pandas(self) -> DataFrame:
        """Return a row for each number: problem, source, quantity, both numbers, verdict."""
        return data_frame(
            {
                "problem": [one.problem.name for one in self.comparisons],
                "source": [one.problem.source for one in self.comparisons],
                "what": [one.problem.what for one in self.comparisons],
                "printed": [one.printed for one in self.comparisons],
                "rbsdem": [_shown(one) for one in self.comparisons],
                "difference": [f"{100 * one.difference:+.2g} %" for one in self.comparisons],
                "verdict": [_verdict(one) for one in self.comparisons],
            }
        )

    def __repr__(self) -> str:
        numbers = len(self.comparisons)
        inside = sum(one.inside for one in self.comparisons)
        failed = numbers - sum(one.holds for one in self.comparisons)
        return (
            f"Verification({len({one.problem for one in self.comparisons})} problems, "
            f"{numbers} numbers: {inside} inside the printed digits, "
            f"{numbers - inside - failed} explained, {failed} wrong)"
        )


def _shown(one: Comparison) -> str:
    """Return the number with one digit more than is printed."""
    digits = one.printed.lower().partition("e")[0].lstrip("-").replace(".", "").lstrip("0")
    return f"{one.value:#.{max(len(digits), 1) + 1}g}".rstrip(".")


def _verdict(one: Comparison) -> str:
    if one.inside:
        return "printed digits"
    return one.problem.remark if one.holds else "wrong"


def verify(problems: Sequence[str] | None = None) -> Verification:
    """Solve problems of textbooks, standards and other programs, and compare with what they print.

    Parameters
    ----------
    problems : sequence of str, optional
        Names of problems, or their beginnings; all without them.

    Returns
    -------
    Verification
        A row for each printed number.

    Raises
    ------
    InputError
        If no problem has such a name.
    """
    wanted = PROBLEMS
    if problems is not None:
        begins = _arguments.several(problems, "verify: problems", "names")
        wanted = [one for one in PROBLEMS if one.name.lower().startswith(_lower(begins))]
        for name in _lower(begins):
            if not any(one.name.lower().startswith(name) for one in wanted):
                names = ", ".join(dict.fromkeys(one.name for one in PROBLEMS))
                raise InputError(f"verify: there is no problem {name!r}; there are {names}")
    found = []
    for problem in wanted:
        printed = problem.printed.split()
        with notes_off():
            values = np.ravel(problem.solve()).astype(float).tolist()
        if len(values) != len(printed) or not all(map(math.isfinite, values)):
            raise AssertionError(f"{problem.name}: {values} for {problem.printed}")
        found += [Comparison(problem, *pair) for pair in zip(printed, values, strict=True)]
    return Verification(tuple(found))


def _lower(names: Sequence[str]) -> tuple[str, ...]:
    return tuple(str(name).lower() for name in names)
