"""How far two responses are apart, and a response from that of the next finer setting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rbsdem._types import Array
from rbsdem.model.rows import Response, Rows


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


def base_action(run: Rows) -> Array:
    """Return the compared action at the base: the moment of a column, the shear of a frame."""
    return run.moment[:, 0] if isinstance(run, Response) else run.base_shear


def answer_of(run: Rows, times: Array, driven: bool = False, parts: int = 1) -> Answer:
    """Return the compared part of a result at some times.

    `driven`: by displacement. `parts`: increments of a static path for each one between the times.
    """
    time = run.time
    response = run.force if driven else run.displacement
    taken = run.energy["spring"] + run.energy["damping"]
    histories = [np.array(values) for values in (response, base_action(run), taken)]
    if not run.dynamic:
        # Rows of corners and of the start stand between the points of the path.
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
