"""Finding limit states in the rows of a result. They read its state and change nothing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from rbsdem._core import Array
from rbsdem._views import view_of
from rbsdem.comparison.cycles import strength_loss_point
from rbsdem.limit_states.criteria import Criterion, criteria
from rbsdem.limit_states.record import LimitState, LimitStates
from rbsdem.result import Result

_LOSS = 0.2


@view_of(Result, "limit_states")
def limit_states(result: Result) -> LimitStates:
    """Return the limit states that a result reaches; see `Result.limit_states`."""
    watched = criteria(result.column)
    if any(criterion.opening for criterion in watched):
        result._check_openings()
    first: dict[str, LimitState] = {}
    for criterion in watched:
        found = _reached(result, criterion)
        if found is not None and (found.name not in first or found.time < first[found.name].time):
            first[found.name] = found
    states = [*first.values(), *_losses(result)]
    ends = {
        "axial_failure": ("axial_failure", "the layers lose the axial load"),
        "collapsed": ("collapse", "collapse_drift"),
    }
    if result.summary["status"] in ends:
        name, source = ends[result.summary["status"]]
        states.append(_state(result, name, result.time.size - 1, 1.0, math.nan, source))
    return LimitStates(result, states)


def _reached(result: Result, criterion: Criterion) -> LimitState | None:
    values, threshold = criterion.values(result), criterion.threshold
    rows = np.flatnonzero(values >= threshold)
    if rows.size == 0:
        return None
    row = int(rows[0])
    share = 1.0
    if row > 0 and values[row] > values[row - 1]:
        share = float((threshold - values[row - 1]) / (values[row] - values[row - 1]))
    return _state(result, criterion.name, row, share, threshold, criterion.source)


def _losses(result: Result) -> list[LimitState]:
    """Return where a fifth of the strength of a side is lost first, as the comparison has it."""
    row, loss = strength_loss_point(result.displacement, result.loop_force, share=_LOSS)
    if row is None:
        return []
    source = "20 % of the largest force of a side, on its envelope"
    state = _state(result, "strength_loss", row, 1.0, _LOSS, source)
    # Interpolated on the envelope.
    at = math.copysign(loss, state.displacement)
    return [replace(state, displacement=at, drift=at / result.column.height)]


def _state(
    result: Result, name: str, row: int, share: float, threshold: float, source: str
) -> LimitState:
    before = max(row - 1, 0)

    def at(values: Array) -> float:
        return float((1.0 - share) * values[before] + share * values[row])

    displacement = at(result.displacement)
    return LimitState(
        name,
        row,
        at(result.time),
        displacement,
        displacement / result.column.height,
        threshold,
        source,
    )
