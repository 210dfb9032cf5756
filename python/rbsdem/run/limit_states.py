"""Limit states that a response reaches, and what hinges undergo."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass, fields, replace
from typing import Any, overload

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame, text_table
from rbsdem._types import Array, DataFrame
from rbsdem.curves.envelope import strength_loss_point
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.section.criteria import Criterion, criteria
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.strength import (
    ROUND_AXIAL_FAILURE_FACTORS,
    axial_failure_drift,
    axial_failure_interval,
    round_axial_failure_drift,
)


@dataclass(frozen=True)
class LimitState:
    """One limit state, where it is reached first.

    Attributes
    ----------
    name : str
        Of `limit_states()`: "cracking", "first_yield", "nominal_moment", "hoop_yield", "spalling",
        "bar_buckling", "hoop_fracture", "bar_fracture", "cap", "shear_cracking", "shear_yield",
        "shear_failure", "strength_loss", "collapse" or "axial_failure"; of a frame
        "infill_cracking", "infill_peak" and "infill_residual" too. Of the `events` of a frame:
        "cracking", "yield", "spalling", "cap" or "shear_failure" of a spring, "residual" of an
        infill. Of a member: "shear_failure" where its drift reaches `shear_drift` before a spring
        fails, "lost" where it no longer carries its axial load, "snap" where its inside jumps to
        another equilibrium (the jump that loses most energy), "fall" where it has none left.
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
    member, group : str
        Of a frame, name of the member, and which of its springs: "flexure", "shear",
        "axial_spring" or "infill", a strut of one; or name of the node, and "panel"; "member" where
        it is lost as a whole.
    end : str
        "start", "end", or the place between them in shares of the clear length; "" in a panel.
    side : int
        1 or -1; 0 of a member as a whole.
    lower, upper : float
        Ends of the 80 % interval of tests about the drift of the structure, or of the member, where
        the state is a loss of the axial load; NaN of others.
    """

    name: str
    row: int
    time: float
    displacement: float
    drift: float
    force: float
    threshold: float = math.nan
    source: str = ""
    member: str = ""
    group: str = ""
    end: str = ""
    side: int = 0
    lower: float = math.nan
    upper: float = math.nan


class LimitStates(Tabular):
    """Limit states in the order in which they are reached; `print` makes a short table.

    Parameters
    ----------
    states : iterable of LimitState
        Those that are reached.
    result : Result or FrameResult
        The response.
    """

    def __init__(self, states: Iterable[LimitState], result: Any) -> None:
        self.result = result
        self._states = sorted(states, key=lambda state: (state.time, state.row))

    def __iter__(self) -> Iterator[LimitState]:
        return iter(self._states)

    def __len__(self) -> int:
        return len(self._states)

    def __contains__(self, name: object) -> bool:
        """Return whether a limit state is reached."""
        return any(state.name == name for state in self)

    @overload
    def __getitem__(self, name: str | int) -> LimitState: ...
    @overload
    def __getitem__(self, name: slice) -> list[LimitState]: ...
    def __getitem__(self, name: str | int | slice) -> LimitState | list[LimitState]:
        """Return the first limit state of a name, `KeyError` if it is not reached; or by place."""
        if not isinstance(name, str):
            return self._states[name]
        for state in self:
            if state.name == name:
                return state
        raise KeyError(f"{name!r} is not reached; reached are {', '.join(self.names()) or 'none'}")

    def names(self) -> list[str]:
        """Return the names in the order in which they are reached."""
        return list(dict.fromkeys(state.name for state in self))

    def drift(self, name: str) -> float:
        """Return the drift, in size, at which a state is reached; NaN if it is not."""
        return abs(self[name].drift) if name in self else math.nan

    def to_pandas(self, *, cracking: bool = True) -> DataFrame:
        """Return a row for each state, those of cracking on request: what `LimitState` has."""
        rows = [asdict(state) for state in self if cracking or state.name != "cracking"]
        units = {"time": "time_s" if self.result.dynamic else "point"}
        units |= {"displacement": "displacement_m", "force": "force_N"}
        frame = data_frame(rows, [field.name for field in fields(LimitState)])
        if not any(math.isfinite(state.upper) for state in self):
            frame = frame.drop(columns=["lower", "upper"])
        if not any(state.member for state in self):
            frame = frame.drop(columns=["member", "group", "end", "side"])
        elif not any(state.source for state in self):
            frame = frame.drop(columns=["threshold", "source"])
        return frame.rename(columns=units)

    def __str__(self) -> str:
        # Of many springs those that crack hide the others.
        cracks = sum(state.name == "cracking" for state in self)
        table = text_table(self.to_pandas(cracking=cracks < 2))
        return table + (f"\nand {cracks} springs crack" if cracks > 1 else "")

    def __repr__(self) -> str:
        names = [state.name for state in self]
        if len(names) == len(set(names)):
            told = [f"{state.name} {100 * state.drift:.2f} %" for state in self]
        else:
            told = [f"{number} {name}" for name, number in Counter(names).items()]
        return f"LimitStates({', '.join(told)})"


_LOSS = 0.2


#: Limit states by the group of springs of an event, and by what happens.
_EVENTS = {
    ("flexure", "cracking"): "cracking",
    ("flexure", "yield"): "first_yield",
    ("flexure", "cap"): "cap",
    **{
        ("flexure", name): name
        for name in ("web_yield", "spalling", "crushing", "bar_buckling", "bar_fracture")
    },
    ("shear", "cracking"): "shear_cracking",
    ("shear", "yield"): "shear_yield",
    ("infill", "cracking"): "infill_cracking",
    ("infill", "cap"): "infill_peak",
    ("infill", "residual"): "infill_residual",
    ("shear", "shear_failure"): "shear_failure",
    ("member", "shear_failure"): "shear_failure",
    ("member", "lost"): "axial_failure",
}


def limit_states(result: Any) -> LimitStates:
    """Return the limit states that a result reaches; see `Result.limit_states`."""
    first = _of_column(result) if isinstance(result.structure, Column) else _of_frame(result)
    states = [*first.values(), *_losses(result), *_axial_failure(result, first)]
    ends = {
        "axial_failure": ("axial_failure", "the layers lose the axial load"),
        "collapsed": ("collapse", "collapse_drift"),
    }
    name, source = ends.get(result.summary["status"], ("", ""))
    if name and name not in {state.name for state in states}:
        states.append(_state(result, name, result.path.time.size - 1, math.nan, source))
    return LimitStates(states, result)


def _of_frame(result: Any) -> dict[str, LimitState]:
    """Return the limit states of the first events of a frame, by name."""
    first: dict[str, LimitState] = {}
    path = result.path
    for event in path.events:
        name = _EVENTS.get((event.group.replace("panel", "flexure"), event.name), "")
        if name and name not in first:
            row = float(np.interp(event.time, path.time, np.arange(path.time.size)))
            source = f"{event.group} of {event.member} {event.end}".rstrip()
            where = {key: getattr(event, key) for key in ("member", "group", "end", "side")}
            first[name] = replace(_state(result, name, row, math.nan, source), **where)
    return first


def _of_column(result: Any) -> dict[str, LimitState]:
    """Return the limit states of a column, by name, each where the first of its criteria is met."""
    watched, joints = criteria(result.column), result.column.joint_numbers
    path = result.path
    if any(criterion.opening for criterion in watched):
        path._check_openings()
    first: dict[str, LimitState] = {}
    for number, criterion in enumerate(watched):
        if result.reached is None:
            state = _in_rows(result, path, criterion, joints.index(criterion.joint))
        else:
            state = _in_time(result, criterion, *result.reached[number])
        if state is not None and (state.name not in first or state.time < first[state.name].time):
            first[state.name] = state
    return first


def _in_time(
    result: Any, criterion: Criterion, time: float, displacement: float
) -> LimitState | None:
    """Return the limit state of a criterion that was met in a step of an analysis in time.

    `time` [s] and `displacement` of the top [m] are where the solver met it; NaN: it did not.
    """
    if math.isnan(time):
        return None
    row = float(np.interp(time, result.time, np.arange(result.time.size)))
    state = _state(result, criterion.name, row, criterion.threshold, criterion.source)
    at = float(displacement)
    return replace(state, time=float(time), displacement=at, drift=at / result.structure.height)


def _in_rows(result: Any, path: Any, criterion: Criterion, at: int) -> LimitState | None:
    """Return the limit state of a criterion of joint `at` (from 0) that rows of the path meet."""
    values, threshold = criterion.values(path, at), criterion.threshold
    rows = np.flatnonzero(values >= threshold)
    if rows.size == 0:
        return None
    row = float(rows[0])
    if rows[0] > 0:
        before, there = values[rows[0] - 1 : rows[0] + 1]
        row += (threshold - there) / (there - before)
    return _state(result, criterion.name, row, threshold, criterion.source)


def _losses(result: Any) -> list[LimitState]:
    """Return where a side first loses a fifth of its strength, as `rbsdem.curves.strength_loss`."""
    path = result.path
    row, loss = strength_loss_point(path.displacement, path.loop_force, share=_LOSS)
    if math.isnan(row):
        return []
    source = "20 % of the largest force of a side, on its envelope"
    state = _state(result, "strength_loss", row, _LOSS, source)
    at = math.copysign(loss, state.displacement)
    return [replace(state, displacement=at, drift=at / result.structure.height)]


def _axial_failure(result: Any, first: dict[str, LimitState]) -> list[LimitState]:
    """Return where a column loses its axial load.

    A column whose shear spring has yielded loses it at the drift at which the friction along the
    shear crack carries the load no more (`rbsdem.section.strength.axial_failure_drift`). A round
    one with hoops, however it fails, loses it at the latest at its `round_axial_failure_drift`.
    """
    column = result.structure
    if not isinstance(column, LayeredColumn):
        return []
    assert column.drawing is not None
    section, load, path = column.drawing.section, column.axial_load, result.path
    drift, candidates = np.abs(path.displacement) / column.height, []
    if "shear_yield" in first:
        limit, ends = axial_failure_drift(section, load), axial_failure_interval(section, load)
        sheared = path.time >= first["shear_yield"].time
        source = "friction along the shear crack, Elwood and Moehle 2005"
        candidates.append((np.flatnonzero((drift >= limit) & sheared), limit, source, ends))
    limit = round_axial_failure_drift(section, load)
    ends = ROUND_AXIAL_FAILURE_FACTORS[0] * limit, ROUND_AXIAL_FAILURE_FACTORS[1] * limit
    source = "yield + b of circles, ASCE 41-17, table 10-9"
    candidates.append((np.flatnonzero(drift >= limit), limit, source, ends))
    reached = [candidate for candidate in candidates if candidate[0].size]
    if not reached:
        return []
    rows, limit, source, (low, high) = min(reached, key=lambda candidate: int(candidate[0][0]))
    state = _state(result, "axial_failure", float(rows[0]), limit, source)
    return [replace(state, lower=low, upper=high)]


def _state(result: Any, name: str, row: float, threshold: float, source: str) -> LimitState:
    """Return the state at a row of the path; row 3.5 is half way between rows 3 and 4."""
    path = result.path
    rows = np.arange(path.time.size)
    time, displacement, force = (
        float(np.interp(row, rows, values))
        for values in (path.time, path.displacement, path.loop_force)
    )
    # Round-off of a time that is one of the rows does not take the next one.
    after = np.searchsorted(result.time, time - 1e-12 * abs(time))
    at, drift = min(int(after), result.time.size - 1), displacement / result.structure.height
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
        """Length of the hinge [m]; `InputError` if it is not known."""
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


def hinge(result: Any, joint: int, length: float | None) -> Hinge:
    """Return the response of a hinge; see `ColumnResult.hinge`."""
    joint = _arguments.integer(joint, "joint")
    at = result.column.index_of(joint)
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


def _yield_rotation(result: Any, at: int, yields: list[Criterion]) -> tuple[float, float]:
    """Return the rotations at yield of joint `at` (from 0) to both sides [rad]; inf if none."""
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


def _first(side: int, yields: list[Criterion], result: Any, at: int) -> float:
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
