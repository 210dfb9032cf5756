"""Finding limit states on the path of a result. They read its state and change nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from rbsdem.checks.criteria import Criterion, criteria
from rbsdem.checks.limit_states import LimitState, LimitStates
from rbsdem.curves.strength import strength_loss_point
from rbsdem.model.response import Response

_LOSS = 0.2


def limit_states(result: Response) -> LimitStates:
    """Return the limit states that a result reaches; see `Result.limit_states`."""
    watched = criteria(result.column)
    path = result.path
    if any(criterion.opening for criterion in watched):
        path._check_openings()
    first: dict[str, LimitState] = {}
    for place, criterion in enumerate(watched):
        if result.reached is None:
            found = _in_rows(result, criterion)
        else:
            found = _in_time(result, criterion, *result.reached[place])
        if found is not None and (found.name not in first or found.time < first[found.name].time):
            first[found.name] = found
    states = [*first.values(), *_losses(result)]
    ends = {
        "axial_failure": ("axial_failure", "the layers lose the axial load"),
        "collapsed": ("collapse", "collapse_drift"),
    }
    if result.summary["status"] in ends:
        name, source = ends[result.summary["status"]]
        states.append(_state(result, name, path.time.size - 1, math.nan, source))
    return LimitStates(result, states)


def _in_time(
    result: Response, criterion: Criterion, time: float, displacement: float
) -> LimitState | None:
    """Return what all steps of an analysis in time have seen."""
    if math.isnan(time):
        return None
    place = float(np.interp(time, result.time, np.arange(result.time.size)))
    state = _state(result, criterion.name, place, criterion.threshold, criterion.source)
    at = float(displacement)
    return replace(state, time=float(time), displacement=at, drift=at / result.column.height)


def _in_rows(result: Response, criterion: Criterion) -> LimitState | None:
    values, threshold = criterion.values(result.path), criterion.threshold
    rows = np.flatnonzero(values >= threshold)
    if rows.size == 0:
        return None
    place = float(rows[0])
    if rows[0] > 0:
        before, there = values[rows[0] - 1 : rows[0] + 1]
        place += (threshold - there) / (there - before)
    return _state(result, criterion.name, place, threshold, criterion.source)


def _losses(result: Response) -> list[LimitState]:
    """Return where a fifth of the strength of a side is lost first, as the comparison has it."""
    path = result.path
    place, loss = strength_loss_point(path.displacement, path.loop_force, share=_LOSS)
    if math.isnan(place):
        return []
    source = "20 % of the largest force of a side, on its envelope"
    state = _state(result, "strength_loss", place, _LOSS, source)
    at = math.copysign(loss, state.displacement)
    return [replace(state, displacement=at, drift=at / result.column.height)]


def _state(result: Response, name: str, place: float, threshold: float, source: str) -> LimitState:
    """Return the state at a row of the path, or between two with the share of the way."""
    path = result.path
    rows = np.arange(path.time.size)
    time, displacement, force = (
        float(np.interp(place, rows, values))
        for values in (path.time, path.displacement, path.loop_force)
    )
    # Round-off of a time that is one of the rows does not take the next one.
    row = np.searchsorted(result.time, time - 1e-12 * abs(time))
    return LimitState(
        name,
        min(int(row), result.time.size - 1),
        time,
        displacement,
        displacement / result.column.height,
        force,
        threshold,
        source,
    )
