"""Prediction of tests from their properties: a loop and scores for each."""

from __future__ import annotations

import multiprocessing
import os
import time
import warnings
from collections.abc import Callable, Iterable, Sequence
from contextlib import ExitStack
from dataclasses import replace
from typing import Any, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.measured.columns import check_options, checked_specimen
from rbsdem.measured.journal import Journal
from rbsdem.measured.nearest import Neighbour, nearest
from rbsdem.measured.one import How, Model, name_of, predict_one
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.predictions import Predictions
from rbsdem.measured.processes import check_sent, here, in_processes
from rbsdem.measured.progress import progress_bar
from rbsdem.measured.specimen import Specimen
from rbsdem.measured.specimens import TABLE, read_specimens
from rbsdem.section.model import DEFAULT
from rbsdem.section.parameters import parameters
from rbsdem.section.scatter import SCATTER
from rbsdem.section.spread import has_bands

__all__ = ["predict", "predict_one"]

#: Tests most like a column that stand beside its prediction.
_NEIGHBOURS = 5

Near: TypeAlias = str | os.PathLike[str] | Iterable[Specimen | Prediction]


@overload
def predict(
    specimens: Specimen,
    model: Model = DEFAULT,
    *,
    bands: bool | None = None,
    samples: int = 16,
    displacement: ArrayLike | None = None,
    near: Near | None = None,
    jobs: int = 1,
    progress: bool = False,
    journal: str | os.PathLike[str] | None = None,
    limit_states: bool = False,
    **options: Any,
) -> Prediction: ...
@overload
def predict(
    specimens: Iterable[Specimen] | str | os.PathLike[str],
    model: Model = DEFAULT,
    *,
    bands: bool | None = None,
    samples: int = 16,
    displacement: ArrayLike | None = None,
    near: Near | None = None,
    jobs: int = 1,
    progress: bool = False,
    journal: str | os.PathLike[str] | None = None,
    limit_states: bool = False,
    **options: Any,
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
    journal: str | os.PathLike[str] | None = None,
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
        Samples of a band, as for `rbsdem.section.model.LayeredColumn.spread`.
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
        Show a bar on stderr.
    journal : path, optional
        File to which each prediction is written as it comes. Predictions that are there already,
        of the same tests by the same model, options and version of rbsdem, are not done again, so
        that a batch that was ended in any way goes on from where it stopped. The model must be
        given by name. The file stays; remove it to predict everything anew.
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
        is a journal for a model that is a function. A single specimen that cannot be predicted
        raises the error itself.
    """
    if _arguments.whole(jobs, "jobs") < 1:
        raise InputError(f"jobs = {jobs} must be 1 or more")
    name = name_of(model, options)
    single = isinstance(specimens, Specimen)
    tests = _tests(specimens)
    if not callable(model):
        check_options(options)
    how = How(
        bands=_bands(bands, single or displacement is not None, model, options),
        samples=samples,
        displacement=None if displacement is None else tuple(_path(displacement)),
        limit_states=_arguments.switch(limit_states, "limit_states"),
    )
    if displacement is not None and not how.bands:
        raise InputError(
            "displacement goes with bands of the layered model; for a loop alone take "
            "rbsdem.cyclic(rbsdem.peer.column(specimen), displacement=...)"
        )
    if jobs > 1:
        check_sent(model, options)
    if isinstance(specimens, Specimen):
        row = _alone(specimens, model, how, options)
        return _with_nearest([row], model, options, _near(near, specimens))[0] if how.bands else row
    begin = time.perf_counter()
    kept = None
    if journal is not None:
        if callable(model):
            raise InputError(
                f"journal: the model {name} is a function, of which nobody knows whether it has "
                "changed; give a model by name, or no journal"
            )
        kept = Journal(journal, tests, name, how.given(options))
    rows = kept.finished() if kept else {}
    resumed = len(rows)
    with ExitStack() as stack:
        told = stack.enter_context(progress_bar(len(tests), resumed)) if progress else None
        interrupted = _run(tests, model, how, options, jobs, rows, kept, told)
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


def _run(
    tests: Sequence[Specimen],
    model: Model,
    how: How,
    options: dict[str, Any],
    jobs: int,
    rows: dict[int, Prediction],
    kept: Journal | None,
    told: Callable[[Prediction], None] | None,
) -> bool:
    """Predict the tests that have no row yet; return whether the user interrupted it."""
    left = [number for number in range(len(tests)) if number not in rows]
    run = in_processes if jobs > 1 and len(left) > 1 else here
    others = set(multiprocessing.active_children())
    try:
        for place, row in run([tests[number] for number in left], model, how, options, jobs):
            rows[left[place]] = row
            # A process that died may live the next time.
            if kept and not (row.status == "failed" and row.comparison is None):
                kept.add(left[place], row)
            if told:
                told(row)
    except KeyboardInterrupt:
        return True
    except SystemExit:  # told to end: nobody waits for the tests that are under way
        for child in set(multiprocessing.active_children()) - others:
            child.kill()
        raise
    return False


def _alone(specimen: Specimen, model: Model, how: How, options: dict[str, Any]) -> Prediction:
    """Predict one specimen; what cannot be predicted is an error, not a row."""
    row = predict_one(specimen, model, how=how, **options)
    if row.status == "no history":
        raise InputError(f"{row.error}; or give its path as displacement=")
    if row.status == "failed":
        raise InputError(f"{specimen.name}: {row.error}")
    if row.remarks:
        warnings.warn(f"{specimen.name}: {'; '.join(row.remarks)}", AccuracyWarning, stacklevel=3)
    return row


def _tests(
    specimens: Specimen | Iterable[Specimen] | str | os.PathLike[str],
) -> Sequence[Specimen]:
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
    own = options.get("model_parameters")
    version = (own or parameters(options.get("version"))).version
    if given is None:
        return version in SCATTER
    if given:
        has_bands(version)
    return given


def _path(displacement: ArrayLike) -> list[float]:
    path = _arguments.finite_vector(displacement, "displacement")
    if path.size < 2 or not np.any(np.diff(path)):
        raise InputError("displacement: the path does not change; give one that does")
    return path.tolist()


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
        for one in nearest(row.specimen, tests, max(len(tests), 1)):
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
