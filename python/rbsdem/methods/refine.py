"""The distance of a result to that of the next finer setting."""

from __future__ import annotations

import math
import sys
import warnings
from dataclasses import asdict
from typing import Any

import numpy as np

from rbsdem._views import view_of
from rbsdem.errors import AccuracyWarning
from rbsdem.methods.answer import Answer, Errors, errors_of
from rbsdem.methods.path import at_times, common_interval
from rbsdem.result import Result
from rbsdem.solve.analysis import cyclic, time_history
from rbsdem.solve.methods import METHODS

#: By how much a tolerance is sharpened, at least to where it and not the stability limits the
#: steps, and the least one.
_SHARPER, _SHARP, _LEAST = 100.0, 1e-9, 1e-13

#: Tolerance by default.
_USUAL_TOLERANCE = 1e-6


@view_of(Result, "refined_error")
def refined_error(result: Result) -> Errors:
    """Return the differences of a result from that of the next finer setting."""
    with warnings.catch_warnings():
        # They were told with the result itself.
        warnings.simplefilter("ignore", AccuracyWarning)
        if result.dynamic:
            finer = time_history(result.column, **_finer(result))
        else:
            finer = cyclic(result.column, **_divided(result))
    driven = "displacement" in result.call
    one, other = (_answer(run, result.time, driven) for run in (result, finer))
    found = asdict(errors_of(one, other))
    # Two runs with the same digits say no more than that the error is within their last ones.
    least = math.sqrt(one.time.size) * sys.float_info.epsilon
    return Errors(**{name: max(error, least) for name, error in found.items()})


def _finer(result: Result) -> dict[str, Any]:
    """Return the keywords of `time_history` for the next finer setting."""
    call, about = dict(result.call), result.summary
    method = METHODS[about["method"]]
    if call.get("method", "auto") == "auto":
        call.pop("tolerance", None)
        if method.name == "rk4" and "events located" in about["reason"]:
            call["events"] = "located"
        if method.adaptive and "tolerance" in result.call:
            call["tolerance"] = result.call["tolerance"]
    call["method"] = method.name
    if method.adaptive:
        tolerance = call.get("tolerance", _USUAL_TOLERANCE)
        sharper = max(min(tolerance / _SHARPER, _SHARP), _LEAST)
        # Where there is none that is much sharper, the distance to one that is not bounds it.
        return call | {"tolerance": sharper if 10 * sharper <= tolerance else _SHARPER * tolerance}
    if "every" in call:
        call["every"] *= 2
    if "dt" in call:
        return call | {"dt": call["dt"] / 2}
    # Rows stay at the times of the loading if the step divides all intervals.
    interval, regular = common_interval(call["time"])
    step = about["time_step"]
    parts = 2 * max(math.ceil(interval / step * (1 - 1e-9)), 1)
    return call | {"dt": interval / parts if regular else step / 2}


def _divided(result: Result) -> dict[str, Any]:
    """Return the keywords of `cyclic` with each increment cut in two."""
    call = dict(result.call)
    name = "displacement" if "displacement" in call else "force"
    path = np.concatenate([[0.0], call[name]])
    fine = np.repeat(call[name], 2)
    fine[::2] = 0.5 * (path[:-1] + path[1:])
    # From the middle of the first increment, every second point is one of the path.
    return call | {name: fine, "every": None}


def _answer(run: Result, times: np.ndarray, driven: bool) -> Answer:
    """Return what is compared, at the rows of the first result."""
    time = run.time
    response = run.force if driven else run.displacement
    taken = run.energy["spring"] + run.energy["damping"]
    histories = [np.array(values) for values in (response, run.moment[:, 0], taken)]
    if not run.dynamic and time.size != times.size:
        places = (2 * times + 1).astype(int)
        places = places[places < time.size]
        histories = [values[places] for values in histories]
        time = times[: places.size]
    elif run.dynamic and not np.array_equal(time, times):
        wanted = times[times <= time[-1]]
        histories = [at_times(wanted, time, values) for values in histories]
        time = wanted
    return Answer(time, *histories, run.summary["status"])
