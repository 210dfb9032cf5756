"""Prediction of one test: a row for whatever comes of it."""

from __future__ import annotations

import time
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from rbsdem._arguments import Array
from rbsdem.curves.scores import compare
from rbsdem.errors import RbsdemError, SolveError
from rbsdem.measured.columns import check_options, checked_specimen
from rbsdem.measured.columns import column as column_of
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.specimen import Specimen
from rbsdem.model.column import Column
from rbsdem.results.result import Result, cyclic
from rbsdem.section.model import DEFAULT, model_name
from rbsdem.section.spread import Spread

__all__ = ["How", "Model", "light", "name_of", "predict_one"]

Model: TypeAlias = str | Callable[[Specimen], Column]


@dataclass(frozen=True)
class How:
    """How tests are predicted, beside model and options.

    Attributes
    ----------
    bands : bool
        With bands.
    samples : int
        Samples of a band.
    displacement : tuple of float or None
        Path of the top [m]; None for that of each test.
    """

    bands: bool = False
    samples: int = 16
    displacement: tuple[float, ...] | None = None
    limit_states: bool = False

    def given(self, options: dict[str, Any]) -> dict[str, Any]:
        """Return the options of a journal: those of the model, and what differs from the usual."""
        own = {name: value for name, value in vars(self).items() if value != getattr(How, name)}
        return options | ({"how": own} if own else {})


def predict_one(
    specimen: Specimen, model: Model = DEFAULT, *, how: How | None = None, **options: Any
) -> Prediction:
    """Predict one test; an error is reported in the row that is returned.

    Parameters
    ----------
    specimen : Specimen
        The test.
    model : str or callable, optional
        As for `predict`.
    how : How, optional
        Band and path.
    **options
        As for `predict`.

    Returns
    -------
    Prediction
        Its status, its scores and its times.
    """
    how = how or How()
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
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        done = _analyse(specimen, path, model, how, options)
    status, error, comparison = done.status, done.error, None
    if test is not None:
        comparison = compare(done.result, test)
        if status == "completed" and comparison.path_fraction < 1:
            status, error = "stopped", f"the forces end at row {comparison.rows}"
    return Prediction(
        specimen,
        name,
        status,
        error=error,
        note="; ".join(dict.fromkeys(str(warning.message) for warning in caught)),
        seconds_model=done.seconds[0],
        seconds_analysis=done.seconds[1],
        comparison=comparison,
        band=done.band,
        remarks=done.remarks,
        limit_states=done.limit_states,
    )


class _Analysed(NamedTuple):
    """What came of an analysis; without one the result is NaN."""

    status: str
    error: str
    result: Any
    seconds: tuple[float, float]
    band: Spread | None
    remarks: tuple[str, ...]
    limit_states: dict[str, float] | None


def _analyse(
    specimen: Specimen, path: Array, model: Model, how: How, options: dict[str, Any]
) -> _Analysed:
    nothing = path, np.full(path.size, np.nan)
    begin = built = end = time.perf_counter()
    band: Spread | None = None
    remarks: tuple[str, ...] = ()
    try:
        if callable(model):
            column = model(specimen, **options)
        else:
            column = column_of(specimen, model, **options)
        built = end = time.perf_counter()
        remarks = getattr(column, "outside", ())
        result = cyclic(column, displacement=path)
        status, error = "completed", ""
    except SolveError as stop:
        known = stop.result is not None
        status, error, result = "stopped" if known else "failed", str(stop), stop.result or nothing
    except RbsdemError as fault:
        status, error, result = "failed", str(fault), nothing
    except Exception as fault:
        # A fault in one model is a row of the table and does not end the others.
        status, error, result = "failed", f"{type(fault).__name__}: {fault}", nothing
    states = None
    if how.limit_states and isinstance(result, Result):
        states = {state.name: abs(state.drift) for state in result.limit_states()}
    end = time.perf_counter()
    if how.bands and status != "failed":
        band = column.spread(path, samples=how.samples)
    built = max(built, begin)
    return _Analysed(status, error, result, (built - begin, end - built), band, remarks, states)


def light(row: Prediction) -> Prediction:
    """Return a prediction without the samples of its band, which are many times all else."""
    if row.band is None:
        return row
    return replace(row, band=replace(row.band, samples=row.band.samples[:0]))


def name_of(model: Model, options: dict[str, Any]) -> str:
    """Return the name of the model, with the version of its parameters."""
    if callable(model):
        return getattr(model, "__name__", repr(model))
    return model_name(model, options.get("version"), options.get("model_parameters"))
