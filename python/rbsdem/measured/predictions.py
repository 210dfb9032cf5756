"""Predicted tests: a row for each, medians and quartiles of groups, files."""

from __future__ import annotations

import math
import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, overload

import numpy as np

from rbsdem._files import whole_file, write_csv
from rbsdem.errors import InputError
from rbsdem.measured.pictures import Picture, picture
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.records import band_record, loop_names, score_record

if TYPE_CHECKING:
    import pandas as pd

    pass


__all__ = ["SUMMARY_SCORES", "Group", "Predictions", "Quartiles"]

SUMMARY_SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio", "end_ratio", "rms_best")
"""Scores of which groups have quartiles."""

_NOT_RUN = ("failed", "no history")


@dataclass(frozen=True, slots=True)
class Quartiles:
    """Median and quartiles of a score over tests.

    Attributes
    ----------
    lower, median, upper : float
        25, 50 and 75 % of the tests are below; NaN if no test has the score.
    """

    lower: float
    median: float
    upper: float


@dataclass(frozen=True, slots=True)
class Group:
    """Statistics of tests that have something in common.

    Attributes
    ----------
    name : str
        What they have in common; "all" for all.
    tests : int
        Tests with a history.
    stopped, failed : int
        How many of them ended early, and how many could not be analysed.
    quartiles : dict of str to Quartiles
        For each of `SUMMARY_SCORES`.
    seconds : Quartiles
        Wall time for the column and its analysis [s].
    """

    name: str
    tests: int
    stopped: int
    failed: int
    quartiles: dict[str, Quartiles]
    seconds: Quartiles


class Predictions(Sequence[Prediction]):
    """Predictions in the order of the tests.

    A sequence of `Prediction`: ``predictions[0]``, ``for row in predictions``; a text finds one as
    in `Specimens`.

    Parameters
    ----------
    rows : iterable of Prediction
        One for each test.
    model : str, optional
        Name of the model with the version of its parameters.
    seconds : float, optional
        Wall time of everything [s].
    interrupted : bool, optional
        Whether the user interrupted it: the rows are those that were finished.
    resumed : int, optional
        How many of the rows were taken from the journal of an earlier start.
    """

    def __init__(
        self,
        rows: Iterable[Prediction],
        *,
        model: str = "",
        seconds: float = math.nan,
        interrupted: bool = False,
        resumed: int = 0,
    ) -> None:
        self._rows = tuple(rows)
        self.model = model
        self.seconds = seconds
        self.interrupted = interrupted
        self.resumed = resumed

    def __len__(self) -> int:
        return len(self._rows)

    def __iter__(self) -> Iterator[Prediction]:
        return iter(self._rows)

    @overload
    def __getitem__(self, key: int | str) -> Prediction: ...
    @overload
    def __getitem__(self, key: slice) -> Predictions: ...
    def __getitem__(self, key: int | str | slice) -> Prediction | Predictions:
        if isinstance(key, slice):
            return self._some(self._rows[key])
        if isinstance(key, str):
            for row in self._rows:
                if row.specimen.is_called(key):
                    return row
            raise InputError(f"no prediction of {key!r}; it was not among the tests")
        return self._rows[key]

    def __repr__(self) -> str:
        return f"<Predictions: {len(self)} tests by the model {self.model!r}>"

    @property
    def all_completed(self) -> bool:
        """Whether every test was analysed to its end."""
        return not self.interrupted and all(row.status == "completed" for row in self._rows)

    @cached_property
    def pictures(self) -> tuple[Picture | None, ...]:
        """The loops of each test as gallery and contact sheet draw them; None without a history."""
        return tuple(
            None if row.comparison is None else picture(row.comparison) for row in self._rows
        )

    def worst(self, n: int = 10) -> Predictions:
        """Return the n tests of the largest error, the worst first.

        Parameters
        ----------
        n : int, optional
            How many.
        """
        counted = [row for row in self._rows if row.status != "no history"]
        return self._some(sorted(counted, key=lambda row: -row.nrmse)[:n])

    def summary(self, by: str = "failure_mode") -> list[Group]:
        """Return medians and quartiles of groups, the last one that of all tests.

        Parameters
        ----------
        by : str, optional
            Attribute of `Specimen` whose values make the groups, as "section" or "series".

        Raises
        ------
        InputError
            If specimens have no such attribute.
        """
        parts: dict[str, list[Prediction]] = {}
        for row in self._rows:
            try:
                value = getattr(row.specimen, by)
            except AttributeError:
                raise InputError(
                    f"by = {by!r} is no attribute of a specimen, as failure_mode, section, series"
                ) from None
            parts.setdefault("not known" if value is None else str(value), []).append(row)
        groups = [_group(name, rows) for name, rows in parts.items()]
        return [*sorted(groups, key=lambda group: -group.tests), _group("all", self._rows)]

    def records(self) -> list[dict[str, Any]]:
        """Return a dict for each test: properties that group tests, scores, times.

        If limit states were asked for, "drift_first_yield", "drift_spalling", ... are the drifts at
        which they are reached; NaN where they are not.
        """
        states = any(row.limit_states is not None for row in self._rows)
        return [score_record(row, states) for row in self._rows]

    def to_frame(self) -> pd.DataFrame:
        """Return `records` as a DataFrame."""
        import pandas as pd  # noqa: PLC0415

        return pd.DataFrame(self.records())

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write `records` as csv, whole or not at all.

        Texts that a spreadsheet would take for a formula get an apostrophe in front.

        Parameters
        ----------
        path : path
            File to write.
        """
        _write(path, self.records())

    def bands_to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write bands as csv: a row for each test with its intervals and what its test was.

        Parameters
        ----------
        path : path
            File to write.
        """
        _write(path, [band_record(row) for row in self._rows if row.band is not None])

    def paths_to_csv(self, folder: str | os.PathLike[str]) -> None:
        """Write the bands along the paths, a file for each test that has one.

        Parameters
        ----------
        folder : path
            Folder, which is made; its files are called as those of `loops_to_csv`.
        """
        files = [row.specimen.file or f"test_{i + 1}" for i, row in enumerate(self._rows)]
        for row, name in zip(self._rows, loop_names(files), strict=True):
            if row.band is not None:
                target = Path(folder) / name
                target.parent.mkdir(parents=True, exist_ok=True)
                row.band.to_csv(target)

    def summary_to_csv(self, path: str | os.PathLike[str], by: str = "failure_mode") -> None:
        """Write `summary` as csv.

        Parameters
        ----------
        path : path
            File to write.
        by : str, optional
            As for `summary`.
        """
        rows = []
        for group in self.summary(by):
            row: dict[str, Any] = {
                by: group.name,
                "tests": group.tests,
                "stopped": group.stopped,
                "failed": group.failed,
            }
            for name, q in {**group.quartiles, "seconds": group.seconds}.items():
                row |= {
                    f"{name}_lower": q.lower,
                    f"{name}_median": q.median,
                    f"{name}_upper": q.upper,
                }
            rows.append(row)
        _write(path, rows)

    def loops_to_csv(self, folder: str | os.PathLike[str]) -> None:
        """Write the loops, a file for each test with displacement and both forces in SI.

        Parameters
        ----------
        folder : path
            Folder, which is made. A file has the path below it that the history has below its own
            folder; two that would be the same get a number. The files hold the measured forces,
            which belong to the database.
        """
        where = Path(folder)
        where.mkdir(parents=True, exist_ok=True)
        header = "displacement_m,test_force_N,model_force_N"
        files = [row.specimen.file or f"test_{i + 1}" for i, row in enumerate(self._rows)]
        for row, name in zip(self._rows, loop_names(files), strict=True):
            if row.comparison is not None:
                c = row.comparison
                rows = np.column_stack((c.displacement, c.test_force, c.model_force))
                path = where / name
                path.parent.mkdir(parents=True, exist_ok=True)
                with whole_file(path) as file:
                    np.savetxt(file, rows, "%.7g", delimiter=",", header=header, comments="")

    def _some(self, rows: Iterable[Prediction]) -> Predictions:
        return Predictions(
            rows, model=self.model, seconds=self.seconds, interrupted=self.interrupted
        )


def _group(name: str, rows: Iterable[Prediction]) -> Group:
    counted = [row for row in rows if row.status != "no history"]
    return Group(
        name=name,
        tests=len(counted),
        stopped=sum(row.status == "stopped" for row in counted),
        failed=sum(row.status == "failed" for row in counted),
        quartiles={
            score: _quartiles([row.score(score) for row in counted]) for score in SUMMARY_SCORES
        },
        seconds=_quartiles([row.seconds for row in counted if row.status not in _NOT_RUN]),
    )


def _quartiles(values: Sequence[float]) -> Quartiles:
    known = np.array([value for value in values if math.isfinite(value)])
    if not known.size:
        return Quartiles(math.nan, math.nan, math.nan)
    return Quartiles(*np.percentile(known, (25, 50, 75)).tolist())


def _write(path: str | os.PathLike[str], rows: list[dict[str, Any]]) -> None:
    header = list(dict.fromkeys(name for row in rows for name in row))
    write_csv(path, [header, *([row.get(name) for name in header] for row in rows)])
