"""The limit states that a response has reached, and the rotation of its hinges.

They are read from it and change nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame
from rbsdem.checks.criteria import Criterion, criteria
from rbsdem.curves.envelope import strength_loss_point
from rbsdem.errors import InputError
from rbsdem.model.response import Response
from rbsdem.model.rows import Rows
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.strength import axial_failure_drift


@dataclass(frozen=True)
class LimitState:
    """One limit state, where it is reached first.

    Attributes
    ----------
    name : str
        "cracking", "first_yield", "nominal_moment", "hoop_yield", "spalling", "bar_buckling",
        "hoop_fracture", "bar_fracture", "cap", "shear_cracking", "shear_yield", "shear_failure",
        "strength_loss", "collapse" or "axial_failure".
    row : int
        First row of the result at or behind it.
    time : float
        Time [s], linear between two rows; or point of a static path, between two with the share of
        the way (`Result.path`).
    displacement, drift : float
        Of the top there [m], and over the height.
    force : float
        Of the loop there [N], see `Result.loop_force`.
    threshold : float
        The value reached: a strain, a rotation [rad], a slip [m] or a share; NaN of a frame.
    source : str
        Where the threshold comes from.
    """

    name: str
    row: int
    time: float
    displacement: float
    drift: float
    force: float
    threshold: float
    source: str


class LimitStates(Tabular):
    """The limit states of a result in the order in which they are reached.

    Parameters
    ----------
    result : Result
        The response.
    states : list of LimitState
        Those that are reached.
    """

    def __init__(self, result: Rows, states: list[LimitState]) -> None:
        self.result = result
        self._states = sorted(states, key=lambda state: (state.time, state.row))

    def __iter__(self) -> Iterator[LimitState]:
        return iter(self._states)

    def __len__(self) -> int:
        return len(self._states)

    def __contains__(self, name: object) -> bool:
        """Return whether a limit state is reached."""
        return any(state.name == name for state in self._states)

    def __getitem__(self, name: str) -> LimitState:
        """Return a limit state by its name; `KeyError` if it is not reached."""
        for state in self._states:
            if state.name == name:
                return state
        raise KeyError(f"{name!r} is not reached; reached are {', '.join(self.names()) or 'none'}")

    def names(self) -> list[str]:
        """Return the names in the order in which they are reached."""
        return [state.name for state in self._states]

    def drift(self, name: str) -> float:
        """Return the drift, in size, at which a state is reached; NaN if it is not."""
        return abs(self[name].drift) if name in self else float("nan")

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each state: the attributes of `LimitState`."""
        names = list(LimitState.__dataclass_fields__)
        frame = data_frame([asdict(state) for state in self], columns=names)
        units = {"time": "time_s", "displacement": "displacement_m", "force": "force_N"}
        return frame.rename(columns=units)

    def __repr__(self) -> str:
        states = ", ".join(f"{state.name} {100 * state.drift:.2f} %" for state in self)
        return f"LimitStates({states})"


_LOSS = 0.2


#: Limit states by the group of springs of an event, and by what happens.
_EVENTS = {
    ("flexure", "cracking"): "cracking",
    ("flexure", "yield"): "first_yield",
    ("flexure", "cap"): "cap",
    ("flexure", "spalling"): "spalling",
    ("shear", "cracking"): "shear_cracking",
    ("shear", "yield"): "shear_yield",
    ("shear", "cap"): "shear_failure",
    ("member", "shear failure"): "shear_failure",
    ("member", "lost"): "axial_failure",
}


def limit_states(result: Rows) -> LimitStates:
    """Return the limit states that a result reaches; see `Result.limit_states`."""
    first = _of_column(result) if isinstance(result, Response) else _of_frame(result)
    states = [*first.values(), *_losses(result), *_axial_failure(result, first)]
    ends = {
        "axial_failure": ("axial_failure", "the layers lose the axial load"),
        "collapsed": ("collapse", "collapse_drift"),
    }
    name, source = ends.get(result.summary["status"], ("", ""))
    if name and name not in {state.name for state in states}:
        states.append(_state(result, name, result.path.time.size - 1, math.nan, source))
    return LimitStates(result, states)


def _of_frame(result: Any) -> dict[str, LimitState]:
    """Return the first event of each kind."""
    first: dict[str, LimitState] = {}
    path = result.path
    for event in path.events:
        name = _EVENTS.get((event.group.replace("panel", "flexure"), event.what), "")
        if name and name not in first:
            place = float(np.interp(event.step, path.time, np.arange(path.time.size)))
            source = f"{event.group} of {event.member} {event.end}".rstrip()
            first[name] = _state(result, name, place, math.nan, source)
    return first


def _of_column(result: Response) -> dict[str, LimitState]:
    """Return the first criterion of each state that is met."""
    watched, joints = criteria(result.column), result.column.joint_numbers
    path = result.path
    if any(criterion.opening for criterion in watched):
        path._check_openings()
    first: dict[str, LimitState] = {}
    for place, criterion in enumerate(watched):
        if result.reached is None:
            found = _in_rows(result, path, criterion, joints.index(criterion.joint))
        else:
            found = _in_time(result, criterion, *result.reached[place])
        if found is not None and (found.name not in first or found.time < first[found.name].time):
            first[found.name] = found
    return first


def _in_time(
    result: Response, criterion: Criterion, time: float, displacement: float
) -> LimitState | None:
    """Return the limit state that the steps of an analysis in time have reached."""
    if math.isnan(time):
        return None
    place = float(np.interp(time, result.time, np.arange(result.time.size)))
    state = _state(result, criterion.name, place, criterion.threshold, criterion.source)
    at = float(displacement)
    return replace(state, time=float(time), displacement=at, drift=at / result.structure.height)


def _in_rows(result: Response, path: Response, criterion: Criterion, at: int) -> LimitState | None:
    values, threshold = criterion.values(path, at), criterion.threshold
    rows = np.flatnonzero(values >= threshold)
    if rows.size == 0:
        return None
    place = float(rows[0])
    if rows[0] > 0:
        before, there = values[rows[0] - 1 : rows[0] + 1]
        place += (threshold - there) / (there - before)
    return _state(result, criterion.name, place, threshold, criterion.source)


def _losses(result: Rows) -> list[LimitState]:
    """Return where a fifth of the strength of a side is lost first, as the comparison has it."""
    path = result.path
    place, loss = strength_loss_point(path.displacement, path.loop_force, share=_LOSS)
    if math.isnan(place):
        return []
    source = "20 % of the largest force of a side, on its envelope"
    state = _state(result, "strength_loss", place, _LOSS, source)
    at = math.copysign(loss, state.displacement)
    return [replace(state, displacement=at, drift=at / result.structure.height)]


def _axial_failure(result: Rows, first: dict[str, LimitState]) -> list[LimitState]:
    """Return where a column that has failed in shear loses its axial load.

    Its shear spring has yielded, and its drift is that at which the friction along the shear crack
    carries the axial load no more (`rbsdem.section.strength.axial_failure_drift`).
    """
    column = result.structure
    if "shear_yield" not in first or not isinstance(column, LayeredColumn):
        return []
    assert column.drawing is not None
    limit = axial_failure_drift(column.drawing.section, column.axial_load)
    path = result.path
    drift = np.abs(path.displacement) / column.height
    rows = np.flatnonzero((drift >= limit) & (path.time >= first["shear_yield"].time))
    if rows.size == 0:
        return []
    source = "friction along the shear crack, Elwood and Moehle 2005"
    return [_state(result, "axial_failure", float(rows[0]), limit, source)]


def _state(result: Rows, name: str, place: float, threshold: float, source: str) -> LimitState:
    """Return the state at a row of the path, or between two with the share of the way."""
    path = result.path
    rows = np.arange(path.time.size)
    time, displacement, force = (
        float(np.interp(place, rows, values))
        for values in (path.time, path.displacement, path.loop_force)
    )
    # Round-off of a time that is one of the rows does not take the next one.
    row = np.searchsorted(result.time, time - 1e-12 * abs(time))
    at, drift = min(int(row), result.time.size - 1), displacement / result.structure.height
    return LimitState(name, at, time, displacement, drift, force, threshold, source)


@dataclass(frozen=True, eq=False, repr=False)
class Hinge:
    """Rotation of a joint, and its plastic part.

    The plastic rotation is what lies beyond yield, as design rules limit it (ASCE 41-17, figure
    10-1; EN 1998-3, A.3.2.2): zero up to the yield rotation of that side.

    Attributes
    ----------
    joint : int
        The joint, from 1 at the ground.
    time : ndarray, shape (rows,)
        As in the result.
    rotation, moment : ndarray, shape (rows,)
        Rotation of the joint [rad] and its moment [N m].
    yield_rotation : tuple of float
        Rotation at yield to the positive and to the negative side, both positive [rad]; infinite
        where the joint does not yield. Of a layered joint it is that at which its first bar yields
        in this result.
    length : float or None
        Length of the hinge [m], over which the curvature is a mean; None if it is not known.
    ductility : float
        Largest rotation over that at yield of its side: of rotation and of curvature; on a static
        path between the rows too.
    """

    joint: int
    time: Array
    rotation: Array
    moment: Array
    yield_rotation: tuple[float, float]
    length: float | None
    ductility: float

    @property
    def plastic_rotation(self) -> Array:
        """Rotation beyond that at yield, with the sign of the rotation [rad], shape (rows,)."""
        limit = np.where(self.rotation >= 0, *self.yield_rotation)
        beyond: Array = np.maximum(np.abs(self.rotation) - limit, 0.0)
        return np.sign(self.rotation) * beyond

    @property
    def curvature(self) -> Array:
        """Mean curvature of the hinge, rotation over length [1/m], shape (rows,)."""
        return self.rotation / self._length

    @property
    def plastic_curvature(self) -> Array:
        """Plastic rotation over length [1/m], shape (rows,)."""
        return self.plastic_rotation / self._length

    @property
    def _length(self) -> float:
        if self.length is None:
            raise InputError(
                f"joint {self.joint} was not made from a section, and the length of its hinge is "
                "not known; give result.hinge(length=...)"
            )
        return self.length

    def __repr__(self) -> str:
        plastic = np.abs(self.plastic_rotation).max(initial=0.0)
        return (
            f"Hinge(joint {self.joint}, largest rotation "
            f"{np.abs(self.rotation).max(initial=0.0):.4g} rad, plastic {plastic:.4g} rad)"
        )


def hinge(result: Response, joint: int, length: float | None) -> Hinge:
    """Return the response of a hinge; see `Result.hinge`."""
    joint = _arguments.integer(joint, "joint")
    at = result.column.place_of(joint)
    if length is not None:
        length = _arguments.number(length, "hinge: length", above=0, unit="m")
    else:
        gauge = result.column.gauge(joint)
        if gauge is not None:
            length = min(
                over for part, over in zip(gauge.part, gauge.length, strict=True) if part != "bar"
            )
    yields = [each for each in criteria(result.column, ["first_yield"]) if each.joint == joint]
    path = result.path
    turned = path.rotation[:, at]
    limits = _yield_rotation(path, at, yields)
    ductility = float((np.abs(turned) / np.where(turned >= 0, *limits)).max(initial=0.0))
    rows = result.time, result.rotation[:, at], result.moment[:, at]
    return Hinge(joint, *rows, limits, length, ductility)


def _yield_rotation(result: Response, at: int, yields: list[Criterion]) -> tuple[float, float]:
    """Return the rotations at yield to both sides."""
    if not any(criterion.opening for criterion in yields):
        positive, negative = (
            min((c.threshold for c in yields if side * c.rotation > 0), default=math.inf)
            for side in (1, -1)
        )
        return positive, negative
    result._check_openings()
    positive, negative = (
        _first(side, [c for c in yields if side * c.rotation >= 0], result, at) for side in (1, -1)
    )
    # A side that was never pushed to yield is taken to be like the other.
    return (
        positive if math.isfinite(positive) else negative,
        negative if math.isfinite(negative) else positive,
    )


def _first(side: int, yields: list[Criterion], result: Response, at: int) -> float:
    """Return the rotation at which one of the bars of a side yields first."""
    if not yields:
        return math.inf
    # How far each row is on the way to yield.
    turned = side * result.rotation[:, at]
    reached = np.max([c.values(result, at) / c.threshold for c in yields], axis=0)
    rows = np.flatnonzero((reached >= 1.0) & (turned > 0.0))
    if rows.size == 0:
        return math.inf
    row = int(rows[0])
    if row == 0 or reached[row - 1] >= 1.0 or turned[row - 1] >= turned[row]:
        return float(turned[row])
    share = (1.0 - reached[row - 1]) / (reached[row] - reached[row - 1])
    return float((1.0 - share) * turned[row - 1] + share * turned[row])
