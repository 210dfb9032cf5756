"""Prediction of tests from their properties: loop, scores, band, and the tests most like each."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import astuple, dataclass, field, replace
from functools import lru_cache
from typing import Any, TypeAlias, overload

import numpy as np

from rbsdem import _arguments
from rbsdem._files import data_frame
from rbsdem._package import recorded, unwarned
from rbsdem._types import Array, ArrayLike, DataFrame
from rbsdem.curves.scores import SCORES, Comparison, compare
from rbsdem.errors import InputError, RbsdemError, SolveError, warn
from rbsdem.measured.specimens import (
    Specimen,
    check_options,
    checked_specimen,
    draw,
    read_specimens,
)
from rbsdem.measured.specimens import column as column_of
from rbsdem.model.column import Column
from rbsdem.model.shape import CircularSection, Section
from rbsdem.run.bands import (
    Band,
    Learned,
    distance,
    features_of,
    has_bands,
    numbers,
)
from rbsdem.run.bands import band as band_of
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.response import cyclic
from rbsdem.run.rig import rig_force
from rbsdem.run.sisters import Loop, Told, learn, told
from rbsdem.section.columns import DEFAULT, model_name
from rbsdem.section.criteria import WATCHED
from rbsdem.section.parameters import parameters

Model: TypeAlias = str | Callable[[Specimen], Column]
Tests: TypeAlias = "str | os.PathLike[str] | Iterable[Specimen | Prediction]"

#: Scores of which groups have quartiles.
_SUMMARY = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio", "end_ratio", "rms_best")
_LOSSES = ("test_drift_at_loss", "model_drift_at_loss")
_OF_SPECIMEN = (
    "peer_id", "series", "section", "failure_mode", "axial_load_ratio", "span_depth_ratio"
)  # fmt: skip
#: Quantities of a band that have an interval, and their names in `numbers`.
_INTERVALS = {"peak_force": "peak", "energy": "energy", "drift_at_loss": "drift"}
#: Limit states that have a column.
_STATES = (*WATCHED, "strength_loss", "axial_failure")


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
        Name of the model with the version of its parameters, as "layered 2026.8".
    status : str
        "completed", "stopped" (the analysis ended before the test did), "failed" (there is no
        analysis), or "no history" (there is nothing to compare with; not counted).
    displacement, force : ndarray, shape (m,)
        The path [m] and the lateral forces along it [N], NaN behind an early end.
    error : str
        Text of the exception.
    run_warnings : str
        Warnings of the analysis.
    seconds : float
        Wall time for the column and its analysis [s].
    comparison : rbsdem.curves.scores.Comparison or None
        Scores; None without a history, and along another path than that of the test. A test that
        failed has an nrmse of 1.
    band : Band or None
        The prediction with its 80 % band and intervals; None unless bands were asked for.
    nearest : tuple of Neighbour
        The tests that are most like it among those of `near`, with the errors of their predictions.
    warnings : tuple of str
        Where the column is outside the range of the tests that the model was fitted to.
    limit_states : dict of str to float, or None
        Drifts at which limit states are reached, in the order in which they are, by the names of
        `rbsdem.run.limit_states.LimitState`; None unless they were asked for.
    """

    specimen: Specimen
    model: str
    status: str
    displacement: Array = field(default_factory=lambda: np.empty(0), compare=False)
    force: Array = field(default_factory=lambda: np.empty(0), compare=False)
    error: str = ""
    run_warnings: str = ""
    seconds: float = 0.0
    comparison: Comparison | None = None
    band: Band | None = None
    nearest: tuple[Neighbour, ...] = ()
    warnings: tuple[str, ...] = ()
    limit_states: dict[str, float] | None = None

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
        """Share of the test that lies within the band; NaN without a band or a test."""
        if self.band is None or self.comparison is None:
            return math.nan
        return self.band.holds(self.comparison.test_force)

    def intervals(self) -> DataFrame:
        """Return largest force, work and drift at loss: predicted, 80 % interval, and measured.

        Raises
        ------
        InputError
            If there is no band.
        """
        if self.band is None:
            raise InputError(f"{self.specimen.name} has no band; predict it with bands=True")
        test, measured = self.comparison, {}
        if test is not None:
            measured = numbers(test.displacement, test.test_force, test.height)
        found = [
            (name, *astuple(getattr(self.band, name)), measured.get(key, math.nan))
            for name, key in _INTERVALS.items()
        ]
        columns = ("quantity", "lower", "predicted", "upper", "test")
        return data_frame(found, columns).set_index("quantity")


@overload
def predict(specimens: Specimen, model: Model = DEFAULT, **options: Any) -> Prediction: ...
@overload
def predict(
    specimens: Iterable[Specimen] | str | os.PathLike[str], model: Model = DEFAULT, **options: Any
) -> list[Prediction]: ...
def predict(
    specimens: Specimen | Iterable[Specimen] | str | os.PathLike[str],
    model: Model = DEFAULT,
    *,
    bands: bool = False,
    samples: int = 16,
    displacement: ArrayLike | None = None,
    near: Tests = (),
    given: Iterable[Specimen] = (),
    limit_states: bool = False,
    rig: bool = True,
    **options: Any,
) -> Prediction | list[Prediction]:
    """Predict tests from their properties, and compare with what was measured.

    Each column is driven through the measured displacements; its lateral force, with the friction
    of the rig, is compared with the net horizontal force of the test.

    Parameters
    ----------
    specimens : Specimen, iterable of Specimen, or path-like
        One test or column; several, as from `rbsdem.peer.read_specimens`; or a folder, of which all
        tests with a history are predicted.
    model : str or callable, optional
        A model of `rbsdem.peer.column`, or a function that makes a `Column` from a `Specimen`.
    bands : bool, optional
        With the 80 % band of each prediction and the intervals of its numbers; for the layered
        model. A band takes the time of nine predictions more.
    samples : int, optional
        Samples of a band, as for `rbsdem.peer.band`.
    displacement : array_like, shape (m,), optional
        Path of the top [m], for columns that nobody tested. Without it, that of each test.
    near : path-like, or iterable of Specimen or Prediction, optional
        Tests, or their folder; the five that are most like each column stand beside it.
        Those that are not predicted yet are predicted by the same model.
    given : iterable of Specimen, optional
        Tests of the same laboratory and series with their histories. What they say of its strength,
        stiffness and degradation moves the prediction (a Bayes step with the scatter of the bands,
        `rbsdem.run.sisters`) and makes a band narrower; a test that is predicted itself is left out
        of what is given for it. For the layered model.
    limit_states : bool, optional
        With the drifts at which limit states are reached, see `rbsdem.Result.limit_states`; not
        with `given`.
    rig : bool, optional
        With the friction of the rig of a test (`rbsdem.run.rig.rig_force`); False gives the force
        of the column alone, and not with `given`.
    **options
        Passed to `rbsdem.peer.column`, such as ``n=4``.

    Returns
    -------
    Prediction, or list of Prediction
        A row for each test, in their order; the row itself for one specimen. Of several tests one
        that goes wrong has a row with the text of the error. `rbsdem.peer.scores` makes a DataFrame
        of the list.

    Raises
    ------
    InputError
        If the model or its version is not known or has no bands. A single specimen that cannot be
        predicted raises the error itself.
    """
    if callable(model):
        name = str(getattr(model, "__name__", repr(model)))
    else:
        check_options(options)
        name = model_name(model, options.get("model_parameters"))
    version = (options.get("model_parameters") or parameters()).version
    if bands and (model != "layered" or not has_bands(version)):
        raise InputError(f"bands = True: there are bands of 'layered' alone, and none of {name!r}")
    sisters = [checked_specimen(sister) for sister in given]
    if sisters and (model != "layered" or not has_bands(version)):
        raise InputError(f"given: tests move predictions of 'layered' alone, not of {name!r}")
    if sisters and limit_states:
        raise InputError("limit_states = True: they are those of the drawing; leave out given")
    if not _arguments.boolean(rig, "rig") and sisters:
        raise InputError("rig = False: tests tell of column and rig together; leave out given")
    says = {sister: _told(sister, options) for sister in sisters}
    path = None if displacement is None else _path(displacement)
    others: Sequence[Specimen | Prediction]
    others = read_specimens(near).with_history() if isinstance(near, _PATH) else list(near)
    known: dict[Specimen, Prediction] = {}

    def one(specimen: Specimen) -> Prediction:
        """Return the prediction of one test, moved by given tests, with band and neighbours."""
        row = _row(checked_specimen(specimen), model, name, path, limit_states, rig, options)
        column = row[1]
        if column is None or row[0].status == "failed":
            return row[0]
        changes: dict[str, Any] = {}
        others_say = [what for sister, what in says.items() if sister != specimen]
        learned = learn(column, row[0].displacement, others_say) if others_say else None
        if learned is not None:
            changes = _moved(row[0], learned)
        if bands:
            is_known = learned is None and row[0].status == "completed"
            with unwarned():
                changes["band"] = band_of(
                    column,
                    row[0].displacement,
                    samples=samples,
                    learned=learned,
                    rig=rig,
                    force=np.nan_to_num(row[0].force) if is_known else None,
                )
        if others:
            changes["nearest"] = _neighbours(specimen, others, known, model, options | {"rig": rig})
        return replace(row[0], **changes)

    if isinstance(specimens, Specimen):
        row = one(specimens)
        if row.status == "no history":
            raise InputError(f"{row.error}; or give its path as displacement=")
        if row.status == "failed":
            raise InputError(f"{specimens.name}: {row.error}")
        if row.warnings:
            warn(f"{specimens.name}: {'; '.join(row.warnings)}")
        return row
    if isinstance(specimens, _PATH):
        specimens = read_specimens(specimens).with_history()
    return [one(specimen) for specimen in specimens]


_PATH = (str, os.PathLike)


def _told(sister: Specimen, options: dict[str, Any]) -> Told:
    """Return what a given test says."""
    try:
        test = sister.test()
        with unwarned():
            column = column_of(sister, "layered", **options)
    except RbsdemError as error:
        raise InputError(f"given: {sister.name}: {error}") from error
    return told(Loop(column, test.displacement, test.force))


def _moved(row: Prediction, learned: Learned) -> dict[str, Any]:
    """Return what changes in a row by what tests of the laboratory say."""
    force = learned.force(row.displacement)
    tests = "1 test" if learned.tests == 1 else f"{learned.tests} tests"
    changes: dict[str, Any] = {"force": force, "model": f"{row.model}, {tests} given"}
    if row.comparison is not None:
        changes["comparison"] = compare((row.displacement, force), row.specimen.test())
    return changes


def _path(displacement: ArrayLike) -> Array:
    """Return a path of displacements [m] that changes, or raise `InputError`."""
    path = _arguments.finite_vector(displacement, "displacement")
    if path.size < 2 or not np.any(np.diff(path)):
        raise InputError("displacement: the path does not change; give one that does")
    return path


def _row(
    specimen: Specimen,
    model: Model,
    name: str,
    path: Array | None,
    limit_states: bool,
    rig: bool,
    options: dict[str, Any],
) -> tuple[Prediction, Any]:
    """Return the prediction of a test, and its column; an error becomes a status of the row.

    `name` is that of the model, `path` the displacements [m] in place of the measured ones, `rig`
    whether the friction of the rig is added.
    """
    row, column, test = Prediction(specimen, name, "completed"), None, None
    try:
        if path is None:
            test = specimen.test()
            # A test without a usable history is found before the work.
            compare((test.displacement, test.force), test)
            path = test.displacement
    except RbsdemError as error:
        return replace(row, status="no history", error=str(error)), None
    assert path is not None
    force, moved = np.full(path.size, np.nan), path
    outcome: dict[str, Any] = {}
    begin = time.perf_counter()
    with recorded() as caught:
        try:
            column = model(specimen, **options) if callable(model) else None
            if column is None:
                column = column_of(specimen, model, **options)  # type: ignore[call-overload]
            result = cyclic(column, displacement=path)
        except SolveError as stop:
            outcome = {"status": "failed" if stop.result is None else "stopped", "error": str(stop)}
            result = stop.result
        except Exception as fault:
            # A fault in one model is a row of the table and does not end the others.
            kind = "" if isinstance(fault, RbsdemError) else f"{type(fault).__name__}: "
            outcome, result = {"status": "failed", "error": f"{kind}{fault}"}, None
        if isinstance(result, ColumnResult):
            moved, rows = result.displacement, result.displacement.size
            force[:rows] = result.force
            if rig:
                force[:rows] += rig_force(result.column, moved)
            if limit_states:
                outcome["limit_states"] = {s.name: abs(s.drift) for s in result.limit_states()}
    row = replace(
        row, displacement=path, force=force, seconds=time.perf_counter() - begin, **outcome
    )
    if test is not None:
        comparison = compare((moved, force[: moved.size]), test)
        row = replace(row, comparison=comparison)
        if row.status == "completed" and comparison.path_fraction < 1:
            row = replace(row, status="stopped", error=f"the forces end at row {comparison.rows}")
    note = "; ".join(dict.fromkeys(str(warning.message) for warning in caught))
    return replace(row, run_warnings=note, warnings=getattr(column, "warnings", ())), column


# ---- tables -------------------------------------------------------------------------------------


def scores(rows: Iterable[Prediction]) -> DataFrame:
    """Return a row for each prediction: properties that group tests, scores, times.

    Parameters
    ----------
    rows : iterable of Prediction
        As `predict` returns them.

    Returns
    -------
    DataFrame
        If limit states were asked for, "drift_first_yield", "drift_spalling", ... are the drifts at
        which they are reached, NaN where they are not. Bands have "points_within", "band_width" and
        the ends of the intervals of `Prediction.intervals`.
    """
    return data_frame([_scores(row) for row in rows])


def _scores(row: Prediction) -> dict[str, Any]:
    """Return the row of a prediction in the table of scores."""
    s = row.specimen
    record = {
        "name": s.name,
        "file": s.file or "",
        **{name: getattr(s, name) for name in (*_OF_SPECIMEN, "kind")},
        "model": row.model,
        "status": row.status,
        **{name: row.score(name) for name in (*SCORES, *_LOSSES)},
        "seconds": row.seconds,
        "error": row.error,
        "run_warnings": row.run_warnings,
        "warnings": "; ".join(row.warnings),
    }
    if row.limit_states is not None:
        record |= {f"drift_{name}": row.limit_states.get(name, math.nan) for name in _STATES}
    if row.band is not None:
        record |= {"points_within": row.points_within, "band_width": row.band.width}
        for name, interval in row.intervals().iterrows():
            record |= {f"{name}_{end}": interval[end] for end in ("lower", "upper")}
    return record


def score_summary(rows: Iterable[Prediction], by: str = "failure_mode") -> DataFrame:
    """Return medians and quartiles of groups, a row for each, the last one that of all tests.

    Parameters
    ----------
    rows : iterable of Prediction
        As `predict` returns them.
    by : str, optional
        A column of `scores` whose values make the groups, as "section" or "series".

    Returns
    -------
    DataFrame
        By the name of the group: ``tests`` with a history, of which ``stopped`` ended early and
        ``failed`` could not be analysed; the quartiles of the scores, as ``nrmse_lower``,
        ``nrmse_median``, ``nrmse_upper``, NaN if no test has it.

    Raises
    ------
    InputError
        If there is no such column.
    """
    table = scores(rows)
    if by not in table:
        raise InputError(
            f"by = {by!r} is no property of the tests; it is one of {', '.join(table)}"
        )
    table = table[table["status"] != "no history"]
    names = table[by].map(lambda value: "not known" if value is None else str(value))
    groups = [(name, table[names == name]) for name in dict.fromkeys(names)]
    groups.sort(key=lambda group: -len(group[1]))
    lines = []
    for name, group in [*groups, ("all", table)]:
        line: dict[str, Any] = {by: name, "tests": len(group)}
        line |= {status: int((group["status"] == status).sum()) for status in ("stopped", "failed")}
        for score in _SUMMARY:
            quartiles = group[score].quantile([0.25, 0.5, 0.75])
            ends = ("lower", "median", "upper")
            line |= {f"{score}_{end}": q for end, q in zip(ends, quartiles, strict=True)}
        lines.append(line)
    return data_frame(lines).set_index(by)


# ---- tests that are like a column ---------------------------------------------------------------


def _neighbours(
    specimen: Specimen,
    tests: Sequence[Specimen | Prediction],
    known: dict[Specimen, Prediction],
    model: Model,
    options: dict[str, Any],
    number: int = 5,
) -> tuple[Neighbour, ...]:
    """Return the tests that are most like a specimen, predicted; `known` keeps predictions."""
    with unwarned():
        section = draw(specimen).section
    hinge = section, specimen.length, specimen.axial_load
    near: list[Neighbour] = []
    for neighbour in nearest(*hinge, tests, max(len(tests), 1), but=specimen):
        prediction = neighbour.prediction or known.get(neighbour.specimen)
        if prediction is None:
            (prediction,) = predict([neighbour.specimen], model, **options)
            known[neighbour.specimen] = prediction
        # A test whose history cannot be read says nothing.
        if prediction.comparison is not None:
            near.append(replace(neighbour, prediction=replace(prediction, band=None, nearest=())))
        if len(near) == number:
            break
    return tuple(near)


def nearest(
    section: Section,
    height: float,
    axial_load: float,
    tests: Iterable[Prediction | Specimen],
    n: int = 5,
    *,
    but: Specimen | None = None,
) -> tuple[Neighbour, ...]:
    """Return the tests that are most like a column, the nearest first.

    They differ least in the properties of `likeness`; rectangular and round sections, of which
    those with a spiral are, are not compared.

    Parameters
    ----------
    section : Section
        Of the column; that of a test is ``peer.draw(specimen).section``.
    height : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    tests : iterable of Prediction or Specimen
        Predicted tests, as from `rbsdem.peer.predict`, or the tests alone. Those without a history,
        or with a section that cannot be drawn, are passed over.
    n : int, optional
        How many.
    but : Specimen, optional
        The column itself, if it is a test: it is not its own neighbour, nor is another row of the
        table with its history.

    Raises
    ------
    InputError
        If `n` is below 1.
    """
    _arguments.integer(n, "nearest: n", least=1)
    features = features_of(section, height, axial_load)
    is_round = isinstance(section, CircularSection) if but is None else _is_round(but)
    neighbours = []
    for test in tests:
        row = test if isinstance(test, Prediction) else None
        other = checked_specimen(test.specimen if isinstance(test, Prediction) else test)
        if (row is None and other.path is None) or (row is not None and row.comparison is None):
            continue
        # A row with the history of another one is an error of the database.
        if other.duplicate_of is not None or (but is not None and _same(but, other)):
            continue
        if is_round != _is_round(other):
            continue
        try:
            there = _features(other)
        except InputError:
            continue
        neighbours.append(Neighbour(other, distance(features, there), row))
    return tuple(sorted(neighbours, key=lambda neighbour: neighbour.distance)[:n])


def _same(test: Specimen, other: Specimen) -> bool:
    """Whether two rows are the same test."""
    if test is other or test == other:
        return True
    if test.peer_id is not None and test.peer_id in (other.peer_id, other.duplicate_of):
        return True
    return test.duplicate_of is not None and test.duplicate_of == other.peer_id


def _is_round(specimen: Specimen) -> bool:
    """Whether the section is round, an octagon, or a square with a spiral."""
    return specimen.section != "rectangular"


@lru_cache(maxsize=4096)
def _features(specimen: Specimen) -> tuple[float, ...]:
    """Return the properties by which a test is compared, see `features_of`."""
    with unwarned():
        section = draw(specimen).section
    return features_of(section, specimen.length, specimen.axial_load)
