"""How far two responses are apart, and a response from that of the next finer setting."""

from __future__ import annotations

import math
import sys
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from rbsdem._package import unwarned
from rbsdem._types import Array
from rbsdem.run.solve import follow, march
from rbsdem.run.solver import METHODS

#: A tolerance is divided by the first number, and then cut to between the third and the second:
#: from the second on the tolerance limits the steps, and not the stability.
_SHARPER, _SHARP, _LEAST = 100.0, 1e-9, 1e-13

#: Tolerance by default.
_USUAL_TOLERANCE = 1e-6


@dataclass(frozen=True)
class Answer:
    """The part of a result that is compared.

    Attributes
    ----------
    time, response, moment : ndarray, shape (m,)
        Times of the loading [s], top displacement [m] there (lateral force [N] if the displacement
        is driven), and moment of the lowest joint [N m], of a frame its base shear [N].
    taken : ndarray, shape (m,)
        Energy that springs and damping have taken by then [J]: the energy dissipated and the energy
        that the springs still store.
    status : str
        "completed" or "collapsed".
    reason : str
        The method that the program chose, and why, if it was "auto".
    """

    time: Array
    response: Array
    moment: Array
    taken: Array
    status: str
    reason: str = ""

    @property
    def energy(self) -> float:
        """Energy that springs and damping have taken by the end [J]."""
        return float(self.taken[-1])

    @property
    def largest_energy(self) -> float:
        """Largest absolute value of that energy on the way [J]."""
        return float(np.abs(self.taken).max())

    @property
    def peak(self) -> float:
        """Largest absolute response over the times of the loading."""
        return float(np.abs(self.response).max())

    @property
    def residual(self) -> float:
        """Response at the end."""
        return float(self.response[-1])

    @property
    def peak_moment(self) -> float:
        """Largest absolute moment of the lowest joint over the times of the loading [N m]."""
        return float(np.abs(self.moment).max())


@dataclass(frozen=True)
class Errors:
    """Differences of an answer from another one, relative to the peaks of the other.

    Attributes
    ----------
    response_rms, response_max : float
        Root mean square and largest difference of the responses over the largest response.
    moment : float
        Root mean square difference of the base moments over the largest, of a frame of the base
        shears.
    energy : float
        Difference of the energies at the end over the largest energy.
    peak : float
        Difference of the peak responses over the peak.
    """

    response_rms: float
    response_max: float
    moment: float
    energy: float
    peak: float

    @property
    def largest(self) -> float:
        """The largest of the rms of response and moment, of energy and of peak."""
        return max(self.response_rms, self.moment, self.energy, self.peak)


def errors_of(answer: Answer, other: Answer) -> Errors:
    """Return the differences of an answer from another, over the rows that both have."""
    rows = min(answer.response.size, other.response.size)
    response = answer.response[:rows] - other.response[:rows]
    moment = answer.moment[:rows] - other.moment[:rows]
    taken = answer.taken[rows - 1] - other.taken[rows - 1]
    peak = _not_zero(other.peak)
    higher = np.abs(answer.response[:rows]).max() - np.abs(other.response[:rows]).max()
    return Errors(
        response_rms=float(np.sqrt(np.mean(response**2))) / peak,
        response_max=float(np.abs(response).max()) / peak,
        moment=float(np.sqrt(np.mean(moment**2))) / _not_zero(other.peak_moment),
        energy=abs(float(taken)) / _not_zero(other.largest_energy),
        peak=abs(float(higher)) / peak,
    )


def _not_zero(value: float) -> float:
    """Return a peak to divide by: 1 where it is zero."""
    return value if value > 0 else 1.0


def common_interval(time: Array) -> tuple[float, bool]:
    """Return an interval that divides all intervals between the times, and whether one exists.

    If none exists, the median interval is returned.
    """
    intervals = np.diff(time)
    for parts in range(1, 21):
        base = float(intervals.min()) / parts
        # Taken from the whole length, which has more correct digits than one interval.
        base = float(time[-1] - time[0]) / max(round(float(time[-1] - time[0]) / base), 1)
        counts = intervals / base
        if np.all(np.abs(counts - np.round(counts)) <= 1e-9 * np.maximum(counts, 1.0)):
            return base, True
    return float(np.median(intervals)), False


def at_times(wanted: Array, time: Array, values: Array) -> Array:
    """Return values between rows, by the cubic through the four nearest rows."""
    if time.size < 4:
        return np.interp(wanted, time, values)
    first = np.clip(np.searchsorted(time, wanted) - 2, 0, time.size - 4)
    at = time[first[:, None] + np.arange(4)]
    result = np.zeros(wanted.size)
    for i in range(4):
        weight = np.ones(wanted.size)
        for j in range(4):
            if i != j:
                weight *= (wanted - at[:, j]) / (at[:, i] - at[:, j])
        result += weight * values[first + i]
    return result


def answer_of(run: Any, times: Array, driven: bool = False, parts: int = 1) -> Answer:
    """Return the compared part of a result at some times.

    `driven`: whether the path was driven by displacement, so that its response is the force.
    `parts`: number of increments into which each increment of a static path was cut.
    """
    time = run.time
    response = run.force if driven else run.displacement
    taken = run.energy["spring"] + run.energy["damping"]
    histories = [np.array(values) for values in (response, run.base_action, taken)]
    if not run.dynamic:
        # Rows of corners and of the start stand between the points of the path. It begins at -1 and
        # has its point i at time i; cut into parts, the same point is at parts (i + 1) - 1.
        wanted = parts * (times + 1) - 1
        places = np.searchsorted(time, wanted[wanted <= time[-1]])
        histories = [values[places] for values in histories]
        time = times[: places.size]
    elif run.dynamic and not np.array_equal(time, times):
        wanted = times[times <= time[-1]]
        histories = [at_times(wanted, time, values) for values in histories]
        time = wanted
    response, moment, taken = histories
    about = run.summary
    reason = f"{about['method']}: {about['reason']}" if about.get("reason") else ""
    return Answer(time, response, moment, taken, about.get("status", "completed"), reason)


@dataclass(frozen=True)
class ErrorEstimate:
    """Known errors of one result.

    Attributes
    ----------
    method : str
        The method that was used.
    measured : float
        The largest of `Result.refined_error`, where that run is short; of leaps the sum of what
        springs that turn in them may change, "leap_error" of the summary. NaN for other runs.
    usual, largest : float
        Error of the method at its own step or tolerance, relative to the peaks: median and largest
        of the responses of ``studies/error_classes.py``, or of the frames in ``docs/plans.md`` for
        leaps, which say little of another one. 0 for "static", which is exact but for round-off.
    responses : int
        How many responses those were.
    own_setting : bool
        Whether the result has this step or tolerance; else a setting of the user.
    energy : float
        Error of the energy balance of this result, over its largest energy. It is no
        measure of the response, which may err by much more.
    """

    method: str
    measured: float
    usual: float
    largest: float
    responses: int
    own_setting: bool
    energy: float

    def __str__(self) -> str:
        if not self.usual > 0:
            return f"{self.method}: exact but for round-off"
        at = "" if self.own_setting else " at its own setting, which this is not"
        tried = (
            f"{self.usual:g} in the median of {self.responses} other responses, "
            f"{self.largest:g} at most{at}"
        )
        if math.isnan(self.measured):
            return f"{self.method}: errors over the peaks: {tried}; refined_error() measures it"
        how = f"at most about {self.measured:.1g} of the peaks, by the springs that turn in leaps"
        if self.method != "newton":
            how = f"about {self.measured:.1g} of the peaks, by a finer run"
        return f"{self.method}: error {how} ({tried})"


def refined_error(result: Any) -> Errors:
    """Return the differences of a result from that of the next finer setting."""
    with unwarned():
        # The warnings were told with the result itself.
        if result.dynamic:
            run, _ = march(result.structure, _finer(result))
        else:
            run = follow(result.structure, _divided(result))
    arrays, _, summary, error, _ = run
    if error is not None:
        raise error
    finer = replace(
        result, channels=arrays, summary=summary | {"analysis": result.summary["analysis"]}
    )
    driven = "displacement" in result.call
    points = result.time
    if not result.dynamic:
        points = points[(points >= 0) & (points == np.floor(points))]
    one = answer_of(result, points, driven)
    other = answer_of(finer, points, driven, 1 if result.dynamic else 2)
    found = asdict(errors_of(one, other))
    # Two runs with the same digits say no more than that the error is within their last ones.
    least = math.sqrt(one.time.size) * sys.float_info.epsilon
    return Errors(**{name: max(error, least) for name, error in found.items()})


def _finer(result: Any) -> dict[str, Any]:
    """Return the keywords of `time_history` for the next finer setting."""
    call, about = dict(result.call), result.summary
    # The method that "auto" chose stays, with its treatment of events.
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
        # If no tolerance is much sharper, the distance to a run with a larger one bounds the error.
        return call | {"tolerance": sharper if 10 * sharper <= tolerance else _SHARPER * tolerance}
    if "every" in call:
        # Steps are half as long, and the rows stay at the same times.
        call["every"] *= 2
    if "dt" in call:
        return call | {"dt": call["dt"] / 2}
    # Rows stay at the times of the loading if the step divides all intervals.
    interval, regular = common_interval(call["time"])
    step = about["time_step"]
    parts = 2 * max(math.ceil(interval / step * (1 - 1e-9)), 1)
    return call | {"dt": interval / parts if regular else step / 2}


def _divided(result: Any) -> dict[str, Any]:
    """Return the keywords of `cyclic` with each increment cut in two."""
    call = dict(result.call)
    name = "displacement" if "displacement" in call else "force"
    path = np.concatenate([[0.0], call[name]])
    fine = np.repeat(call[name], 2)
    fine[::2] = 0.5 * (path[:-1] + path[1:])
    # From the middle of the first increment, every second point is one of the path.
    return call | {name: fine}
