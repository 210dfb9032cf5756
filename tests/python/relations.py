"""Relations over random structures: how they are tried, in tests and in studies.

A relation is a function of a random generator; `relation` makes it a test of some hundred cases.
RBSDEM_CASES=50 takes fifty times as many, 0.2 a fifth, RBSDEM_SEED=7 others; a failure names its
case, and `replay("relation", case)` runs it alone.
"""

from __future__ import annotations

import os
import warnings
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

import rbsdem

Rng = np.random.Generator
TIMES = float(os.environ.get("RBSDEM_CASES", "1"))
SEED = int(os.environ.get("RBSDEM_SEED", "0"))


class Discard(Exception):  # noqa: N818
    """The case has nothing to say of the relation."""


@dataclass
class Outcome:
    """What cases of a relation have come to: distances, and what is wrong in which case."""

    judge: Callable[[Rng], float | None]
    bar: float
    cases: int = 0
    distances: list[float] = field(default_factory=list)
    faults: list[str] = field(default_factory=list)

    def take(self, case: int) -> None:
        """Add a case."""
        self.cases += 1
        try:
            distance = replay(self.judge.__name__, case, self.judge) or 0.0
        except Discard:
            return
        except Exception as error:  # all of them, with the numbers of their cases
            self.faults.append(f"case {case}: {type(error).__name__}: {error}")
            return
        self.distances.append(distance)
        if not distance <= self.bar:
            self.faults.append(f"case {case}: {distance:.1e} is above {self.bar:.1e}")


def replay(
    name: str, case: int, judge: Callable[[Rng], float | None] | None = None
) -> float | None:
    """Run one case of a relation."""
    rng = np.random.default_rng((zlib.crc32(name.encode()), SEED, case))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return (judge or RELATIONS[name].judge)(rng)


#: What is made of each relation by its name: the outcome of no case.
RELATIONS: dict[str, Outcome] = {}


def relation(
    cases: int, judged: float = 0.5, bar: float = 0.0
) -> Callable[[Callable[[Rng], float | None]], Any]:
    """Make a relation a test of some cases, of which at least a share is not discarded.

    What it returns is a distance, which is not above the bar.
    """

    def make(judge: Callable[[Rng], float | None]) -> Callable[[], None]:
        RELATIONS[judge.__name__] = Outcome(judge, bar)

        def test() -> None:
            found = Outcome(judge, bar)
            for case in range(int(cases * TIMES)):
                found.take(case)
            shown = "\n".join(line[:600] for line in found.faults[:20])
            tried = len(found.distances) + sum(": " in one for one in found.faults)
            assert not found.faults, f"{len(found.faults)} of {tried}:\n{shown}"
            # Few cases say little of the share.
            enough = TIMES < 1 or tried >= judged * found.cases
            assert enough, f"only {tried} of {found.cases} were judged"

        test.__name__ = judge.__name__
        test.__doc__ = judge.__doc__
        # The one in `RELATIONS` may be of another module, whose relation has this name too.
        test.outcome = RELATIONS[judge.__name__]  # type: ignore[attr-defined]
        return test

    return make


def ended(run: Callable[[], Any]) -> Any:
    """Return the result of a run, or what there is of it."""
    try:
        return run()
    except rbsdem.SolveError as error:
        if error.result is None:
            raise Discard from None
        return error.result
