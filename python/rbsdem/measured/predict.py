"""Prediction of tests from their properties: a loop and scores for each, and the nearest tests."""

from __future__ import annotations

import math
import os
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from typing import Any, TypeAlias, overload

import numpy as np

from rbsdem import _arguments
from rbsdem._package import recorded, unwarned
from rbsdem._types import Array, ArrayLike
from rbsdem.batch.work import (
    EndRequest,
    Processes,
    Serial,
    check_jobs,
    check_sent,
    progress_bar,
    work_through,
)
from rbsdem.curves.scores import compare
from rbsdem.errors import InputError, RbsdemError, SolveError, warn
from rbsdem.measured.drawing import check_options, checked_specimen, draw
from rbsdem.measured.drawing import column as column_of
from rbsdem.measured.predictions import Neighbour, Prediction, Predictions, PredictionStore
from rbsdem.measured.specimens import TABLE, Specimen, read_specimens
from rbsdem.model.column import Column
from rbsdem.model.shape import CircularSection, Section
from rbsdem.run.bands import band as band_of
from rbsdem.run.bands import has_bands, place_of
from rbsdem.run.result import Result, cyclic
from rbsdem.section.columns import DEFAULT, model_name
from rbsdem.section.parameters import parameters

#: Tests most like a column that stand beside its prediction.
_NEIGHBOURS = 5

Model: TypeAlias = str | Callable[[Specimen], Column]
Near: TypeAlias = str | os.PathLike[str] | Iterable[Specimen | Prediction]


@dataclass(frozen=True)
class PredictionOptions:
    """How tests are predicted, beside model and options of the column.

    Attributes
    ----------
    bands : bool
        With bands.
    samples : int
        Samples of a band.
    displacement : tuple of float or None
        Path of the top [m]; None for that of each test.
    limit_states : bool
        With the drifts at which limit states are reached.
    """

    bands: bool = False
    samples: int = 16
    displacement: tuple[float, ...] | None = None
    limit_states: bool = False

    def given(self, options: dict[str, Any]) -> dict[str, Any]:
        """Return the options of a store: those of the model, and what differs from the usual."""
        own = {name: v for name, v in vars(self).items() if v != getattr(type(self), name)}
        return options | ({"how": own} if own else {})


@overload
def predict(specimens: Specimen, model: Model = DEFAULT, **options: Any) -> Prediction: ...
@overload
def predict(
    specimens: Iterable[Specimen] | str | os.PathLike[str], model: Model = DEFAULT, **options: Any
) -> Predictions: ...
def predict(
    specimens: Specimen | Iterable[Specimen] | str | os.PathLike[str],
    model: Model = DEFAULT,
    *,
    bands: bool | None = None,
    samples: int = 16,
    displacement: ArrayLike | None = None,
    near: Near | None = None,
    jobs: int = 1,
    progress: bool = False,
    store: str | os.PathLike[str] | None = None,
    limit_states: bool = False,
    **options: Any,
) -> Prediction | Predictions:
    """Predict tests from their properties, and compare with what was measured.

    Each column is driven through the measured displacements; its lateral force is compared with the
    net horizontal force of the test.

    Parameters
    ----------
    specimens : Specimen, iterable of Specimen, or path
        One test or column; several, as from `rbsdem.peer.read_specimens`; or a folder, of which all
        tests with a history are predicted.
    model : str or callable, optional
        A model of `rbsdem.peer.column`, or a function that makes a `Column` from a `Specimen`; with
        `jobs` above 1 the function must be importable.
    bands : bool, optional
        With the 80 % band of each prediction, the intervals of its numbers, and the tests that are
        most like it with their errors. By default for one specimen by the layered model. A band
        takes the time of `samples` predictions more.
    samples : int, optional
        Samples of a band, as for `rbsdem.peer.band`.
    displacement : array_like, shape (m,), optional
        Path of the top [m], for columns that nobody tested; with bands. Without it, that of each
        test.
    near : path, iterable of Specimen or Prediction, optional
        Where the tests that are most like a column are looked for; by default among those that are
        predicted, and for one specimen in the folder of its table. Those that are not predicted yet
        are predicted by the same model.
    jobs : int, optional
        Processes to use. Above 1 a script needs ``if __name__ == "__main__":``.
    progress : bool, optional
        Show a bar on stderr, if it is a terminal.
    store : path, optional
        A folder that keeps the predictions, written every few seconds. Predictions that are there
        already, of the same tests by the same model, options and version of rbsdem, are not done
        again, so that a batch that was ended in any way goes on from where it stopped. The model
        must be given by name. The folder stays; remove it to predict everything anew.
    limit_states : bool, optional
        With the drifts at which limit states are reached, see `rbsdem.Result.limit_states`.
    **options
        Passed to `rbsdem.peer.column`, such as ``n=4``.

    Returns
    -------
    Prediction or Predictions
        A row for each test, in their order; the row itself for one specimen. A test that goes wrong
        has a row with the text of the error. After a keyboard interrupt the rows are those that
        were finished. Bands of several tests are without their samples.

    Raises
    ------
    InputError
        If the model or its version is not known or has no bands, if `jobs` is below 1, or if there
        is a store for a model that is a function. A single specimen that cannot be predicted
        raises the error itself.
    """
    check_jobs(jobs)
    name = name_of(model, options)
    single = isinstance(specimens, Specimen)
    tests = _tests(specimens)
    if not callable(model):
        check_options(options)
    how = PredictionOptions(
        bands=_bands(bands, single or displacement is not None, model, options),
        samples=samples,
        displacement=None if displacement is None else tuple(_path(displacement)),
        limit_states=_arguments.boolean(limit_states, "limit_states"),
    )
    if displacement is not None and not how.bands:
        raise InputError(
            "displacement goes with bands of the layered model; for a loop alone take "
            "rbsdem.cyclic(rbsdem.peer.column(specimen), displacement=...)"
        )
    if jobs > 1:
        check_sent("model", (model, options), repr(model))
    if isinstance(specimens, Specimen):
        row = _alone(specimens, model, how, options)
        return _with_nearest([row], model, options, _near(near, specimens))[0] if how.bands else row
    begin = time.perf_counter()
    kept = None
    if store is not None:
        if callable(model):
            raise InputError(
                f"store: the model {name} is a function, which may have changed; give a model by "
                "name, or no store"
            )
        kept = PredictionStore(_arguments.path(store, "store"), tests, name, how.given(options))
    rows: dict[int, Prediction] = {}
    work = partial(_light, model=model, how=how, options=options)
    with ExitStack() as stack:
        if kept is not None:
            stack.enter_context(kept.open())
            rows = kept.read()
        resumed = len(rows)
        interrupted = _carried_out(tests, work, name_of(model, options), jobs, progress, rows, kept)
    found = [rows[number] for number in sorted(rows)]
    if how.bands:
        found = _with_nearest(found, model, options, found if near is None else _near(near))
    return Predictions(
        found,
        model=name,
        seconds=time.perf_counter() - begin,
        interrupted=interrupted,
        resumed=resumed,
    )


def _carried_out(
    tests: Sequence[Specimen],
    work: Callable[[Specimen], Prediction],
    name: str,
    jobs: int,
    progress: bool,
    rows: dict[int, Prediction],
    kept: PredictionStore | None,
) -> bool:
    """Predict the tests that have no row yet; return whether the user interrupted it."""
    left = [number for number in range(len(tests)) if number not in rows]
    lost: list[int] = []
    last = ""

    def put(number: int, row: Prediction, *, keep: bool = True) -> None:
        nonlocal last
        rows[number], last = row, row.specimen.name
        if kept is not None and keep:
            kept.add(number, row)

    def take(number: int, future: Future[Prediction]) -> None:
        try:
            put(number, future.result())
        except BrokenProcessPool:
            lost.append(number)

    def take_alone(number: int, future: Future[Prediction]) -> None:
        try:
            put(number, future.result())
        except BrokenProcessPool:
            error = "the process died; run this test alone (jobs = 1) to see why"
            # It may live the next time.
            put(number, Prediction(tests[number], name, "failed", error=error), keep=False)

    end = EndRequest()
    with ExitStack() as stack:
        show = stack.enter_context(progress_bar(progress, len(tests), "tests"))

        def beat() -> None:
            show(len(rows), last)
            if kept is not None:
                kept.write_if_due()

        def run(numbers: list[int], jobs: int, ahead: int, take: Callable[..., None]) -> None:
            with Processes(jobs, __name__) if jobs else Serial() as executor:
                how: Any = {"ahead": ahead, "end": end, "beat": beat, "stop": lambda: None}
                work_through(lambda i: executor.submit(work, tests[i]), numbers, take, **how)

        try:
            if jobs == 1 or len(left) <= 1:
                run(left, 0, 1, take)
            else:
                # Where one of them dies, its neighbours are done again, each by a process alone.
                stack.enter_context(end.listening(also_terminated=False))
                run(left, jobs, 2 * jobs, take)
                run(sorted(lost), 1, 1, take_alone)
        except KeyboardInterrupt:
            return True
    return bool(end)


def _light(
    specimen: Specimen, model: Model, how: PredictionOptions, options: dict[str, Any]
) -> Prediction:
    """Predict a test without the samples of its band, which are many times all else."""
    row = predict_one(specimen, model, how=how, **options)
    if row.band is None:
        return row
    return replace(row, band=replace(row.band, samples=row.band.samples[:0]))


def _alone(
    specimen: Specimen, model: Model, how: PredictionOptions, options: dict[str, Any]
) -> Prediction:
    """Predict one specimen; what cannot be predicted is an error, not a row."""
    row = predict_one(specimen, model, how=how, **options)
    if row.status == "no history":
        raise InputError(f"{row.error}; or give its path as displacement=")
    if row.status == "failed":
        raise InputError(f"{specimen.name}: {row.error}")
    if row.remarks:
        warn(f"{specimen.name}: {'; '.join(row.remarks)}")
    return row


def _tests(specimens: Specimen | Iterable[Specimen] | str | os.PathLike[str]) -> Sequence[Specimen]:
    """Return the tests that are asked for."""
    if isinstance(specimens, Specimen):
        return [specimens]
    if isinstance(specimens, str | os.PathLike):
        return read_specimens(specimens).with_history()
    return [checked_specimen(specimen) for specimen in specimens]


def _bands(given: bool | None, single: bool, model: Model, options: dict[str, Any]) -> bool:
    """Return whether there are bands; raise `InputError` if they are asked for and not known."""
    if callable(model) or model != "layered":
        if given:
            raise InputError("bands = True: there are bands for model = 'layered' alone")
        return False
    if given is None and not single:
        return False
    version = (options.get("model_parameters") or parameters()).version
    if given and not has_bands(version):
        raise InputError(f"bands = True: there are no bands of version {version!r}")
    return has_bands(version) if given is None else given


def _path(displacement: ArrayLike) -> list[float]:
    path = _arguments.finite_vector(displacement, "displacement")
    if path.size < 2 or not np.any(np.diff(path)):
        raise InputError("displacement: the path does not change; give one that does")
    return [float(value) for value in path]


def _near(near: Near | None, specimen: Specimen | None = None) -> Sequence[Specimen | Prediction]:
    """Return the tests among which neighbours are looked for."""
    if near is None:
        folder = specimen.folder if specimen is not None else None
        if folder is None or not (folder / TABLE).is_file():
            return []
        near = folder
    if isinstance(near, str | os.PathLike):
        return read_specimens(near).with_history()
    return list(near)


def _with_nearest(
    rows: Sequence[Prediction],
    model: Model,
    options: dict[str, Any],
    tests: Sequence[Specimen | Prediction],
) -> list[Prediction]:
    """Return predictions with the tests that are most like them, these predicted too."""
    known: dict[int, Prediction] = {}
    found = []
    for row in rows:
        if row.status in {"failed", "no history"}:
            found.append(row)
            continue
        near: list[Neighbour] = []
        s = row.specimen
        with unwarned():
            section = draw(s).section
        number = max(len(tests), 1)
        for one in nearest(section, s.length, s.axial_load, tests, number, but=s):
            if one.prediction is None and id(one.specimen) not in known:
                known[id(one.specimen)] = predict_one(one.specimen, model, **options)
            own = one.prediction or known[id(one.specimen)]
            if own.comparison is None:  # its history cannot be read
                continue
            near.append(replace(one, prediction=replace(own, band=None, nearest=())))
            if len(near) == _NEIGHBOURS:
                break
        found.append(replace(row, nearest=tuple(near)))
    return found


def predict_one(
    specimen: Specimen,
    model: Model = DEFAULT,
    *,
    how: PredictionOptions | None = None,
    **options: Any,
) -> Prediction:
    """Predict one test; an error is reported in the row that is returned.

    Parameters
    ----------
    specimen : Specimen
        The test.
    model : str or callable, optional
        As for `predict`.
    how : PredictionOptions, optional
        Band and path.
    **options
        As for `predict`.

    Returns
    -------
    Prediction
        Its status, its scores and its times.
    """
    how = how or PredictionOptions()
    name = name_of(model, options)
    checked_specimen(specimen)
    if not callable(model):
        check_options(options)
    test = None
    try:
        if how.displacement is None:
            test = specimen.test()
            # A test without a usable history is found before the work.
            compare((test.displacement, test.force), test)
    except RbsdemError as error:
        return Prediction(specimen, name, "no history", error=str(error))
    path = np.array(how.displacement) if test is None else test.displacement
    with recorded() as caught:
        row, result = _analyse(Prediction(specimen, name, "completed"), path, model, how, options)
    if test is not None:
        comparison = compare(result, test)
        row = replace(row, comparison=comparison)
        if row.status == "completed" and comparison.path_fraction < 1:
            row = replace(row, status="stopped", error=f"the forces end at row {comparison.rows}")
    return replace(row, note="; ".join(dict.fromkeys(str(warning.message) for warning in caught)))


def _analyse(
    row: Prediction, path: Array, model: Model, how: PredictionOptions, options: dict[str, Any]
) -> tuple[Prediction, Any]:
    """Return the row of a test with what came of its analysis, and the result; NaN without one."""
    result: Any = path, np.full(path.size, np.nan)
    status, error = "failed", ""
    column: Any = None
    begin = built = time.perf_counter()
    try:
        if callable(model):
            column = model(row.specimen, **options)
        else:
            column = column_of(row.specimen, model, **options)  # type: ignore[call-overload]
        built = time.perf_counter()
        result = cyclic(column, displacement=path)
        status = "completed"
    except SolveError as stop:
        error = str(stop)
        if stop.result is not None:
            status, result = "stopped", stop.result
    except RbsdemError as fault:
        error = str(fault)
    except Exception as fault:
        # A fault in one model is a row of the table and does not end the others.
        error = f"{type(fault).__name__}: {fault}"
    states = None
    if how.limit_states and isinstance(result, Result):
        states = {state.name: abs(state.drift) for state in result.limit_states()}
    end = time.perf_counter()
    band = None
    if how.bands and status != "failed":
        band = band_of(column, path, samples=how.samples)
    found: Any = {"status": status, "error": error, "band": band, "limit_states": states}
    times: Any = {"seconds_model": built - begin, "seconds_analysis": end - built}
    return replace(row, remarks=getattr(column, "outside", ()), **found, **times), result


def name_of(model: Model, options: dict[str, Any]) -> str:
    """Return the name of the model, with the version of its parameters."""
    if callable(model):
        return str(getattr(model, "__name__", repr(model)))
    return model_name(model, options.get("model_parameters"))


#: Differences that count as 1: of the axial load ratio, and of the logarithms of the shear span
#: over the depth, the concrete strength, and the mechanical ratios of bars and ties.
_SCALES = (0.15, 0.4, 0.35, 0.4, 0.6)


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
        Predicted tests of a folder, as from `rbsdem.peer.predict`, or the tests alone. What has no
        history, or a section that cannot be drawn, is passed over.
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
    place = place_of(section, height, axial_load)
    is_round = isinstance(section, CircularSection) if but is None else _is_round(but)
    found = []
    for one in tests:
        row = one if isinstance(one, Prediction) else None
        other = checked_specimen(one.specimen if isinstance(one, Prediction) else one)
        if (row is None and other.path is None) or (row is not None and row.comparison is None):
            continue
        # A row with the history of another one is an error of the database.
        if other.duplicate_of is not None or (but is not None and _same(but, other)):
            continue
        if is_round != _is_round(other):
            continue
        try:
            there = _place(other)
        except InputError:
            continue
        ways = [(a - b) / scale for a, b, scale in zip(place, there, _SCALES, strict=True)]
        found.append(Neighbour(other, math.hypot(*ways), row))
    return tuple(sorted(found, key=lambda one: one.distance)[:n])


def _same(one: Specimen, other: Specimen) -> bool:
    """Whether two rows are the same test."""
    if one is other or one == other:
        return True
    if one.peer_id is not None and one.peer_id in (other.peer_id, other.duplicate_of):
        return True
    return one.duplicate_of is not None and one.duplicate_of == other.peer_id


def _is_round(specimen: Specimen) -> bool:
    return specimen.section != "rectangular"


@lru_cache(maxsize=4096)
def _place(specimen: Specimen) -> tuple[float, ...]:
    with unwarned():
        section = draw(specimen).section
    return place_of(section, specimen.length, specimen.axial_load)
