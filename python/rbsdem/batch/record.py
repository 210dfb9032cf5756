"""What an ensemble returns."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from rbsdem import _arguments, _views
from rbsdem._arguments import Array
from rbsdem.batch.inputs import AT_REST, Motion
from rbsdem.batch.measures import STATUSES
from rbsdem.batch.tasks import one_run
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.results.result import Result

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True, repr=False, eq=False)
class Ensemble:
    """The runs of an ensemble, columns x motions x scales, the scales running fastest.

    Attributes
    ----------
    columns : dict
        The columns by their names.
    motions : dict
        The motions by their names, with `time` [s] and `acceleration` [m/s2].
    settings : dict
        The settings of the analysis that were given, as keywords of `time_history`.
    initial : dict of ndarray
        The states that runs of a column began in, by its name; the others began at rest.
    column, motion : ndarray of int, shape (runs,)
        Places of column and motion of each run in `columns` and `motions`.
    scale : ndarray, shape (runs,)
        Factor of the accelerations.
    status : ndarray of str, shape (runs,)
        "completed", "collapsed", "axial_failure" or "failed"; "" for a run that was not started
        because the ensemble was broken off.
    measures : dict of ndarray, shape (runs,)
        The measures (`MEASURES`, and those of functions); NaN for failed runs.
    errors : dict
        Texts of the errors of failed runs, by the number of the run.
    seconds : float
        Wall time.
    interrupted : bool
        Whether Ctrl-C broke the ensemble off.
    resumed : int
        Number of runs that the store had.
    """

    columns: Mapping[str | int, Column]
    motions: Mapping[str | int, Motion]
    settings: dict[str, Any]
    initial: dict[str | int, Array]
    column: NDArray[np.int32]
    motion: NDArray[np.int32]
    scale: Array
    status: NDArray[np.str_]
    measures: dict[str, Array]
    errors: dict[int, str]
    seconds: float
    interrupted: bool = False
    resumed: int = 0

    def __len__(self) -> int:
        """Return the number of runs."""
        return self.scale.size

    def __repr__(self) -> str:
        counts = ", ".join(f"{number} {status}" for status, number in self.counts.items())
        return (
            f"Ensemble({len(self.columns)} columns x {len(self.motions)} motions, {len(self)} "
            f"runs: {counts}; {self.seconds:.3g} s)"
        )

    @property
    def counts(self) -> dict[str, int]:
        """Number of runs of each status that occurs."""
        found = {status: int((self.status == status).sum()) for status in STATUSES}
        return {status or "not started": number for status, number in found.items() if number}

    @property
    def table(self) -> pd.DataFrame:
        """A row for each run: column, motion, scale, status, the measures, error.

        Raises
        ------
        ImportError
            If pandas is not installed.
        """
        return _views.view(self, "table")

    def history(self, run: int) -> Result:
        """Solve one run again, with its history; the bits are those of the run.

        Parameters
        ----------
        run : int
            Its number, that of its row in the table, from 0.

        Returns
        -------
        Result
            As `time_history` returns it.

        Raises
        ------
        InputError
            If there is no such run.
        SolveError
            If the run failed; its attribute `result` holds the rows up to there.
        """
        if not 0 <= _arguments.whole(run, "run") < len(self):
            raise InputError(f"run = {run} must be from 0 to {len(self) - 1}")
        name, column = list(self.columns.items())[self.column[run]]
        motion = list(self.motions.values())[self.motion[run]]
        state = self.initial.get(name, AT_REST)
        result: Result = one_run(column, motion, float(self.scale[run]), self.settings, state)
        return result
