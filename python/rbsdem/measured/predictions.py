"""Predicted tests: a row for each, with scores, band and neighbours; their tables, files, store."""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import math
import os
import pickle
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from rbsdem._files import atomic_write, data_frame
from rbsdem._package import code_digest
from rbsdem._types import Array, DataFrame
from rbsdem.batch.store import JSON_LINES, Store, digest
from rbsdem.checks.criteria import WATCHED
from rbsdem.curves.scores import SCORES, Comparison, compare
from rbsdem.errors import InputError, RbsdemError
from rbsdem.measured.specimens import Rows, Specimen
from rbsdem.run.bands import Band, Interval, numbers

#: How far a model is drawn beyond its test: of the largest force that is in the box.
_BEYOND = 1.08
#: Largest force in the box over that of the test: beyond, nothing would be seen of the test.
_LARGEST = 2.0
#: Distance from a line at which a point is left out, in the box.
_TOLERANCE = 0.0018


@dataclass(frozen=True, eq=False)
class Picture:
    """Two lines in a box from -1 to 1 in both directions.

    Attributes
    ----------
    test, model : ndarray, shape (m, 2)
        Displacement and force over their largest; of a model far beyond its test, up to a little
        beyond the box.
    displacement, force : float
        What 1 stands for [m], [N].
    """

    test: Array
    model: Array
    displacement: float
    force: float


def picture(comparison: Comparison) -> Picture:
    """Return the lines of a comparison.

    Parameters
    ----------
    comparison : Comparison
        Displacement and forces.

    Returns
    -------
    Picture
        Without points that nobody would see.
    """
    c = comparison
    model = c.model_force[: c.rows]
    displacement = float(np.max(np.abs(c.displacement))) or 1.0
    test = float(np.max(np.abs(c.test_force))) or 1.0
    force = min(max(test, float(np.max(np.abs(model), initial=0.0))), _LARGEST * test)
    x = c.displacement / displacement
    clipped = np.clip(model / force, -_BEYOND, _BEYOND)
    return Picture(
        test=thinned(np.column_stack((x, c.test_force / force)), _TOLERANCE),
        model=thinned(np.column_stack((x[: c.rows], clipped)), _TOLERANCE),
        displacement=displacement,
        force=force,
    )


def thinned(points: Array, tolerance: float) -> Array:
    """Leave out points that lie on the straight way between their neighbours.

    Every other point at a time, so that no two neighbours go at once.

    Parameters
    ----------
    points : ndarray, shape (m, 2)
        A line.
    tolerance : float
        Distance from the way at which a point may lie; errors do not add up beyond a few of it.

    Returns
    -------
    ndarray, shape (k, 2)
        First, last and all corners are kept.
    """
    for turn in range(12):
        first = 1 + turn % 2
        inner = np.arange(first, len(points) - 1, 2)
        if not inner.size:
            break
        way = points[inner + 1] - points[inner - 1]
        out = points[inner] - points[inner - 1]
        length = np.maximum(np.hypot(*way.T), 1e-9 * tolerance)
        aside = np.abs(way[:, 0] * out[:, 1] - way[:, 1] * out[:, 0]) / length
        along = np.sum(way * out, axis=1) / length
        drop = (aside <= tolerance) & (along >= -tolerance) & (along <= length + tolerance)
        points = np.delete(points, inner[drop], axis=0)
    return points


SUMMARY_SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio", "end_ratio", "rms_best")
"""Scores of which groups have quartiles."""

#: Limit states that have a column.
_STATES = (*WATCHED, "strength_loss", "axial_failure")

#: Bytes of the longest part of a path that is written.
_LONGEST_NAME = 120


@dataclass(frozen=True, slots=True)
class Neighbour:
    """A test that is like another.

    Attributes
    ----------
    specimen : Specimen
        The test.
    distance : float
        0 for the same column; 1 is a difference of 0.15 in the axial load ratio, or of 40 % in the
        shear span or in the mechanical ratio of the bars.
    prediction : Prediction or None
        Its prediction, with its errors; None if it was not predicted.
    """

    specimen: Specimen
    distance: float
    prediction: Prediction | None = None


@dataclass(frozen=True, slots=True)
class Prediction:
    """One test with the scores of its prediction.

    Attributes
    ----------
    specimen : Specimen
        The test.
    model : str
        Name of the model with the version of its parameters, as "layered 2026.6".
    status : str
        "completed", "stopped" (the analysis ended before the test did), "failed" (there is no
        analysis), or "no history" (there is nothing to compare with; not counted).
    error : str
        Text of the exception.
    note : str
        Warnings.
    seconds_model : float
        Wall time for building the column [s].
    seconds_analysis : float
        Wall time of the analysis [s].
    comparison : Comparison or None
        Scores; None without a history, along another path than that of the test, or where the
        process died. A test that failed has an nrmse of 1.
    band : Band or None
        The prediction with its 80 % band and intervals; None unless bands were asked for.
    nearest : tuple of Neighbour
        The tests that are most like it, with the errors of their predictions; with bands only.
    remarks : tuple of str
        Where the column is outside the range of the tests that the model was fitted to.
    limit_states : dict of str to float, or None
        Drifts at which limit states are reached, in the order in which they are, by the names of
        `rbsdem.checks.limit_states.LimitState`; None unless they were asked for.
    """

    specimen: Specimen
    model: str
    status: str
    error: str = ""
    note: str = ""
    seconds_model: float = 0.0
    seconds_analysis: float = 0.0
    comparison: Comparison | None = None
    band: Band | None = None
    nearest: tuple[Neighbour, ...] = ()
    remarks: tuple[str, ...] = ()
    limit_states: dict[str, float] | None = None

    @property
    def seconds(self) -> float:
        """Wall time for the column and its analysis [s]."""
        return self.seconds_model + self.seconds_analysis

    @property
    def nrmse(self) -> float:
        """The error, as in `Comparison`; NaN without a history."""
        return self.score("nrmse")

    def score(self, name: str) -> float:
        """Return a score of `Comparison` by name; NaN without a history.

        Parameters
        ----------
        name : str
            One of `rbsdem.curves.SCORES`, "test_drift_at_loss" or "model_drift_at_loss".
        """
        if self.comparison is not None:
            return float(getattr(self.comparison, name))
        return 1.0 if name == "nrmse" and self.status == "failed" else math.nan

    @property
    def points_within(self) -> float:
        """Share of the test that lies within the band; NaN without one of both."""
        if self.band is None or self.comparison is None:
            return math.nan
        return self.band.holds(self.comparison.test_force)


class Predictions(Rows[Prediction]):
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
        super().__init__(rows)
        self.model = model
        self.seconds = seconds
        self.interrupted = interrupted
        self.resumed = resumed

    def _named(self, key: str) -> Prediction:
        for row in self._rows:
            if row.specimen.is_called(key):
                return row
        raise InputError(f"no prediction of {key!r}; it was not among the tests")

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

    def summary(self, by: str = "failure_mode") -> DataFrame:
        """Return medians and quartiles of groups, a row for each, the last one that of all tests.

        Parameters
        ----------
        by : str, optional
            Attribute of `Specimen` whose values make the groups, as "section" or "series".

        Returns
        -------
        DataFrame
            By the name of the group: ``tests`` with a history, of which ``stopped`` ended early and
            ``failed`` could not be analysed; of each of `SUMMARY_SCORES` and of ``seconds`` the
            quartiles, as ``nrmse_lower``, ``nrmse_median``, ``nrmse_upper``, NaN if no test has it.

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
        groups = [{by: name} | _statistics(rows) for name, rows in parts.items()]
        groups.sort(key=lambda group: -group["tests"])
        return data_frame([*groups, {by: "all"} | _statistics(self._rows)]).set_index(by)

    def to_pandas(self) -> DataFrame:
        """Return a row for each test: properties that group tests, scores, times.

        If limit states were asked for, "drift_first_yield", "drift_spalling", ... are the drifts at
        which they are reached; NaN where they are not.
        """
        states = any(row.limit_states is not None for row in self._rows)
        return data_frame([_scores(row, states) for row in self._rows])

    def bands(self) -> DataFrame:
        """Return a row for each test that has a band: intervals, and what its test was."""
        return data_frame([band_record(row) for row in self._rows if row.band is not None])

    def paths_to_csv(self, folder: str | os.PathLike[str]) -> None:
        """Write the bands along the paths, a file for each test that has one.

        Parameters
        ----------
        folder : path
            Folder, which is made; its files are called as those of `loops_to_csv`.
        """
        for row, path in self._files(folder):
            if row.band is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                row.band.to_csv(path)

    def loops_to_csv(self, folder: str | os.PathLike[str]) -> None:
        """Write the loops, a file for each test with displacement and both forces in SI.

        Parameters
        ----------
        folder : path
            Folder, which is made. A file has the path below it that the history has below its own
            folder; two that would be the same get a number. The files hold the measured forces,
            which belong to the database.
        """
        Path(folder).mkdir(parents=True, exist_ok=True)
        header = "displacement_m,test_force_N,model_force_N"
        for row, path in self._files(folder):
            if row.comparison is not None:
                c = row.comparison
                rows = np.column_stack((c.displacement, c.test_force, c.model_force))
                path.parent.mkdir(parents=True, exist_ok=True)
                with atomic_write(path) as file:
                    np.savetxt(file, rows, "%.7g", delimiter=",", header=header, comments="")

    def _files(self, folder: str | os.PathLike[str]) -> Iterator[tuple[Prediction, Path]]:
        """Return each row with the file in a folder that it is written to."""
        files = [row.specimen.file or f"test_{i + 1}" for i, row in enumerate(self._rows)]
        for row, name in zip(self._rows, loop_names(files), strict=True):
            yield row, Path(folder) / name

    def _some(self, rows: Iterable[Prediction]) -> Predictions:
        return Predictions(
            rows, model=self.model, seconds=self.seconds, interrupted=self.interrupted
        )


def _statistics(rows: Iterable[Prediction]) -> dict[str, Any]:
    counted = [row for row in rows if row.status != "no history"]
    found: dict[str, Any] = {
        "tests": len(counted),
        "stopped": sum(row.status == "stopped" for row in counted),
        "failed": sum(row.status == "failed" for row in counted),
    }
    values = {name: [row.score(name) for row in counted] for name in SUMMARY_SCORES}
    values["seconds"] = [row.seconds for row in counted if row.status != "failed"]
    for name, scores in values.items():
        known = [number for number in scores if math.isfinite(number)]
        quartiles = np.percentile(known, (25, 50, 75)).tolist() if known else 3 * [math.nan]
        ends = ("lower", "median", "upper")
        found |= {f"{name}_{end}": q for end, q in zip(ends, quartiles, strict=True)}
    return found


_RATIOS = ("axial_load_ratio", "span_depth_ratio")
_OF_SPECIMEN = ("peer_id", "series", "section", "failure_mode", *_RATIOS)


def _scores(row: Prediction, limit_states: bool) -> dict[str, Any]:
    """Return properties that group tests, scores and times by the names of the columns."""
    s = row.specimen
    drifts = row.limit_states or {}
    reached = {f"drift_{name}": drifts.get(name, math.nan) for name in _STATES}
    return {
        "name": s.name,
        "file": s.file or "",
        **{name: getattr(s, name) for name in _OF_SPECIMEN},
        "model": row.model,
        "status": row.status,
        **{name: row.score(name) for name in SCORES},
        **{name: row.score(name) for name in ("test_drift_at_loss", "model_drift_at_loss")},
        **(reached if limit_states else {}),
        "seconds_model": row.seconds_model,
        "seconds_analysis": row.seconds_analysis,
        "error": row.error,
        "note": row.note,
        "outside": "; ".join(row.remarks),
    }


def band_record(row: Prediction) -> dict[str, Any]:
    """Return band and intervals of a prediction by the names of the columns of their csv."""
    found, test = row.band, row.comparison
    assert found is not None
    known = {
        "peak_force_N": found.peak_force,
        "energy_J": found.energy,
        "drift_at_loss": found.drift_at_loss,
    }
    measured = [math.nan, math.nan, math.nan]
    if test is not None:
        measured = list(numbers(test.displacement, test.test_force, test.height).values())
    record: dict[str, Any] = {"name": row.specimen.name, "model": row.model}
    record |= {"points_within": row.points_within, "width": found.width}
    for (name, number), of_test in zip(known.items(), measured, strict=True):
        record |= {
            f"{name}_lower": number.lower,
            name: number.value,
            f"{name}_upper": number.upper,
            f"{name}_test": of_test,
        }
    for place, one in enumerate(row.nearest, 1):
        record |= {
            f"nearest_{place}": one.specimen.name,
            f"distance_{place}": one.distance,
            f"nrmse_{place}": one.prediction.nrmse if one.prediction else math.nan,
        }
    return record | {"outside": "; ".join(row.remarks)}


def loop_names(files: Sequence[str]) -> list[PurePath]:
    """Return a csv for each history: its path below the folder, in letters that any disk takes."""
    taken: set[str] = set()
    names = []
    for file in files:
        parts = [_safe(part) for part in PurePath(file).parts if part not in ("..", "/", "")]
        stem = re.sub(r"\.(csv|txt)$", "", parts.pop() if parts else "test", flags=re.IGNORECASE)
        number, name = 1, PurePath(*parts, f"{stem}.csv")
        while str(name).casefold() in taken:
            number += 1
            name = PurePath(*parts, f"{stem}_{number}.csv")
        taken.add(str(name).casefold())
        names.append(name)
    return names


def _safe(part: str) -> str:
    """Return a part of a path without letters that a disk may refuse, and not too long."""
    kept = "".join(c if c.isprintable() and c not in '\\:*?"<>|' else "_" for c in part)
    if len(kept.encode()) <= _LONGEST_NAME:
        return kept
    digest = hashlib.sha256(kept.encode()).hexdigest()[:12]
    return f"{kept.encode()[: _LONGEST_NAME - 13].decode(errors='ignore')}_{digest}"


_TEXTS = ("status", "error", "note")
_TIMES = ("seconds_model", "seconds_analysis")
_CURVES = ("displacement", "force", "median", "lower", "upper")
_INTERVALS = ("peak_force", "energy", "drift_at_loss")
_SHARES = ("near_shear", "distance")


class PredictionStore:
    """A folder with a line for each predicted test.

    A line is found again by a digest of the test, its history, the model with its version, the
    options, and the code of the installed package: after a change of any of these the test is
    predicted anew.

    Parameters
    ----------
    folder : path
        It is made if it is not there.
    tests : sequence of Specimen
        The tests of the batch.
    model : str
        Name of the model with the version of its parameters.
    options : mapping
        What else the model was given.

    Raises
    ------
    InputError
        If the folder holds other files, or is none.
    """

    def __init__(
        self, folder: Path, tests: Sequence[Specimen], model: str, options: Mapping[str, Any]
    ) -> None:
        self._tests = tests
        self._model = model
        given = hashlib.sha256(code_digest() + model.encode() + pickle.dumps(dict(options), 5))
        self._keys = [_key(specimen, given.digest()) for specimen in tests]
        self._store = Store(folder, JSON_LINES, {"digests": {"contents": "predictions"}})
        self.write_if_due = self._store.write_if_due

    def open(self) -> AbstractContextManager[None]:
        """Keep other processes from the folder while the block lasts."""
        return self._store.open()

    def read(self) -> dict[int, Prediction]:
        """Return the predictions that are in the store, by the number of the test."""
        known = {line["key"]: line for lines in self._store.read() for line in lines}
        rows = {}
        for number, key in enumerate(self._keys):
            row = self._row(self._tests[number], known[key]) if key in known else None
            if row is not None:
                rows[number] = row
        return rows

    def forget(self) -> None:
        """Remove the predictions of this batch; a folder without others goes too."""
        own = set(self._keys)
        self._store.remove(lambda line: line["key"] in own)

    def add(self, number: int, row: Prediction) -> None:
        """Take the prediction of a test; it is written a few seconds later."""
        line: dict[str, Any] = {"name": row.specimen.name, "key": self._keys[number]}
        line |= {name: getattr(row, name) for name in (*_TEXTS, *_TIMES)}
        line["nrmse"] = row.nrmse
        if row.comparison is not None:
            line["model_force"] = _packed(row.comparison.model_force)
        line["remarks"] = list(row.remarks)
        line["limit_states"] = row.limit_states
        if row.band is not None:
            line["band"] = _band_line(row.band)
        self._store.add(line)

    def _row(self, specimen: Specimen, line: dict[str, Any]) -> Prediction | None:
        """Return the prediction of a line; None if there is something wrong with the line."""
        try:
            comparison = None
            if "model_force" in line:
                test = specimen.test()
                comparison = compare((test.displacement, _unpacked(line["model_force"])), test)
            band = _band_of(line["band"]) if "band" in line else None
            remarks = tuple(str(text) for text in line["remarks"])
            values: dict[str, Any] = {name: str(line[name]) for name in _TEXTS}
            values |= {name: float(line[name]) for name in _TIMES}
            states = line["limit_states"]
            if states is not None:
                states = {str(name): float(drift) for name, drift in states.items()}
        except (ValueError, TypeError, KeyError, AttributeError, RbsdemError):
            return None
        values |= {"comparison": comparison, "band": band}
        return Prediction(specimen, self._model, remarks=remarks, limit_states=states, **values)


def _packed(values: Array) -> str:
    return base64.b64encode(values.astype("<f8").tobytes()).decode("ascii")


def _unpacked(text: str) -> Array:
    return np.frombuffer(base64.b64decode(text), "<f8").astype(np.float64)


def _band_line(band: Band) -> dict[str, Any]:
    """Return a band as values of json; its samples are left out."""
    line: dict[str, Any] = {name: _packed(getattr(band, name)) for name in _CURVES}
    line |= {name: dataclasses.astuple(getattr(band, name)) for name in _INTERVALS}
    line |= {name: getattr(band, name) for name in _SHARES}
    return line | {"remarks": list(band.remarks)}


def _band_of(line: dict[str, Any]) -> Band:
    values: dict[str, Any] = {name: _unpacked(line[name]) for name in _CURVES}
    values |= {name: Interval(*map(float, line[name])) for name in _INTERVALS}
    values |= {name: float(line[name]) for name in _SHARES}
    samples = np.empty((0, values["force"].size))
    return Band(**values, samples=samples, remarks=tuple(map(str, line["remarks"])))


def _key(specimen: Specimen, given: bytes) -> str:
    """Return the digest of a test, its history and what it is predicted with."""
    values = dataclasses.asdict(dataclasses.replace(specimen, folder=None))
    text = repr(values).encode("utf-8", "backslashreplace")
    path = specimen.path
    return digest(given, text, b"" if path is None else path.read_bytes())
