"""Where the results of tasks come together."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from rbsdem._arguments import Array
from rbsdem.batch.tasks import TaskResult

__all__ = ["Collected"]


class Collected:
    """Fates, measures and errors of all runs, in arrays that are made once.

    Parameters
    ----------
    runs : int
        Number of runs.
    functions : iterable of str
        Names of the measures of functions.
    measures : int
        Number of the other measures.
    """

    def __init__(self, runs: int, functions: Iterable[str], measures: int) -> None:
        self.fates: NDArray[np.int8] = np.zeros(runs, dtype=np.int8)
        self.values: Array = np.full((measures, runs), np.nan)
        self.extra: dict[str, Array] = {name: np.full(runs, np.nan) for name in functions}
        self.errors: dict[int, str] = {}

    def put(self, runs: NDArray[np.int_], result: TaskResult) -> None:
        """Take the result of some runs."""
        self.fates[runs] = result.fates
        self.values[:, runs] = np.where(result.fates != 0, result.values, np.nan)
        for name, values in result.extra.items():
            self.extra[name][runs] = values
        self.errors.update({int(runs[run]): text for run, text in result.errors.items()})
