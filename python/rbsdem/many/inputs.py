"""Columns, motions and scales as the engine takes them, checked all at once; measures of a run."""

from __future__ import annotations

import os
import re
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias
from unicodedata import category

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.motions.motion import acting, is_pair
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.solve import state_of
from rbsdem.section.criteria import WATCHED
from rbsdem.section.frame import Frame, Structure, checked_structure
from rbsdem.section.plan import Building

#: The state of a column at rest.
AT_REST: Array = np.empty(0)


@dataclass(frozen=True, eq=False)
class Motion:
    """Times [s] and accelerations [m/s2] of a motion of the ground, under a name.

    `across` are accelerations along y, of a pair of motions; empty without.
    """

    name: str | int
    time: Array
    acceleration: Array
    across: Array = field(default_factory=lambda: np.empty(0))


def named_columns(columns: Any, faults: list[str]) -> tuple[list[str | int], list[Structure]]:
    """Return names and columns; without names they are numbered from 0."""
    if isinstance(columns, (Column, Frame)):
        columns = [columns]
    names, items = named(columns, "columns", "Column", faults)
    for name, item in zip(names, items, strict=True):
        with _arguments.collected(faults, f"column {name!r}: "):
            checked_structure(item)
    check_names(names, "columns", "Column", faults)
    return names, items


def named_motions(
    motions: Any, columns: Iterable[Any], faults: list[str]
) -> tuple[int, list[Motion]]:
    """Return how many motions are given, and those without a fault.

    A motion is an object with time and acceleration, a pair of times (or one step) and
    accelerations, or a pair of `GroundMotion` along x and y. Without names of their own they are
    numbered from 0.
    """
    with _arguments.collected(faults):
        check_not_one_pair(motions, columns)
    if hasattr(motions, "acceleration") or _is_pair(motions):
        motions = [motions]
    names, items = named(motions, "motions", "motion", faults)
    right = []
    for name, item in zip(names, items, strict=True):
        with _arguments.collected(faults, f"motion {name!r}: "):
            right.append(_motion(name, item))
    check_names(names, "motions", "motion", faults)
    return len(names), right


def named(
    several: Any, what: str, kind: str, faults: list[str]
) -> tuple[list[str | int], list[Any]]:
    """Return names and items; those of a sequence have their own names, else their numbers."""
    if isinstance(several, Mapping):
        return list(several.keys()), list(several.values())
    try:
        items = list(several)
    except TypeError:
        faults.append(f"{what} = {type(several).__name__} must be a {kind}, or several of them")
        return [], []
    names = (_name_of(item) for item in items)
    return [name if isinstance(name, str) and name else i for i, name in enumerate(names)], items


def _name_of(item: Any) -> Any:
    """Return the name of an item, of a pair that of both; None if it has none."""
    if not is_pair(item):
        return getattr(item, "name", None)
    x, y = item
    return f"{x.name} and {y.name}" if x.name and y.name else None


def check_not_one_pair(motions: Any, columns: Iterable[Any]) -> None:
    """Raise `InputError` for two motions of a building that may be meant as one pair."""
    if is_pair(motions) and any(isinstance(column, Building) for column in columns):
        raise InputError(
            "motions is a tuple of two; give [(east_west, north_south)] for a pair along x and y "
            "at once, or a list of two for two records along x"
        )


def check_collapse(
    names: list[str | int], columns: list[Structure], motions: list[Motion], faults: list[str]
) -> None:
    """Add a fault for a building under pairs of motions whose collapse is judged along one axis."""
    by_roof = [getattr(column, "collapse", "") == "roof" for column in columns]
    if any(by_roof) and any(motion.across.size for motion in motions):
        faults.append(
            f"column {names[by_roof.index(True)]!r}: collapse = 'roof' is a drift along one "
            "direction, and motions come in pairs; take collapse = 'storey', or collapse_drift=None"
        )


def check_names(names: list[str | int], what: str, kind: str, faults: list[str]) -> None:
    """Add a fault for names that a table cannot have, or could not tell apart, and for none."""
    if not names and not faults:
        faults.append(f"{what} is empty; give at least one {kind}")
    for name in names:
        if isinstance(name, bool) or not isinstance(name, (str, int, np.integer)):
            faults.append(f"{what}: the name {name!r} must be a text or a whole number")
        elif any(category(letter) in ("Cc", "Cs") for letter in str(name)):
            faults.append(f"{what}: the name {name!r} has characters that no file takes")
    count = Counter(map(str, names))
    for name in sorted(name for name, number in count.items() if number > 1):
        faults.append(
            f"{what}: two are called {name!r}; give them other names, as {{name: {kind}}}"
        )


def _is_pair(item: Any) -> bool:
    """Return whether an item is a pair of times, or a step, and as many accelerations."""
    if not isinstance(item, tuple) or len(item) != 2:
        return False
    return all(isinstance(part, (float, int, np.ndarray, list)) for part in item)


def _motion(name: str | int, item: Any) -> Motion:
    """Return a motion of any of the forms in which one is given."""
    if is_pair(item):
        pair = dict(zip(("ground_acceleration", "ground_acceleration_y"), item, strict=True))
        times, loads = acting(None, pair, "a pair of motions")
        return Motion(name, *map(np.asarray, (times, *loads.values())))
    if hasattr(item, "time") and hasattr(item, "acceleration"):
        times, values = item.time, item.acceleration
    elif _is_pair(item):
        times, values = item
    else:
        raise InputError(
            f"a {type(item).__name__} is not a motion; give a GroundMotion, a pair of times (or "
            "one step) [s] and accelerations [m/s2], or a tuple of two GroundMotion along x and y"
        )
    acceleration = _arguments.finite_vector(values, "acceleration")
    if isinstance(times, (int, float)):
        step = _arguments.number(times, "step", above=0, unit="s")
        times = step * np.arange(acceleration.size)
    time = _arguments.finite_vector(times, "time")
    if time.size != acceleration.size:
        raise InputError(
            f"{acceleration.size} accelerations for {time.size} times; give one for each"
        )
    if time.size < 2:
        raise InputError(f"{time.size} point(s); give two or more")
    back = np.flatnonzero(~(np.diff(time) > 0))
    if back.size:
        at = int(back[0])
        raise InputError(
            f"time: value {at + 2} of {time.size}, {time[at + 1]} s, does not come after the one "
            f"before, {time[at]} s; times must ascend strictly"
        )
    return Motion(name, time, acceleration)


def states_of_columns(initial: Any, names: list[str | int], faults: list[str]) -> list[Array]:
    """Return the state that the runs of each column begin in; an empty one is at rest.

    `initial` is one state for all columns, a sequence with one for each, or a mapping by their
    names; None among them is at rest.
    """
    if initial is None:
        return [AT_REST] * len(names)
    if isinstance(initial, (str, os.PathLike, ColumnResult, np.ndarray)):
        return [_state(initial, "", faults)] * len(names)
    if isinstance(initial, Mapping):
        unknown = [name for name in initial if name not in names]
        if unknown:
            faults.append(
                f"initial: {unknown[0]!r} is no column; they are {', '.join(map(repr, names[:20]))}"
            )
        states = [initial.get(name) for name in names]
    else:
        try:
            states = list(initial)
        except TypeError:
            return [_state(initial, "", faults)] * len(names)
        if len(states) != len(names):
            faults.append(
                f"initial: {len(states)} states for {len(names)} columns; give one for each, or "
                "one for all"
            )
            return [AT_REST] * len(names)
    return [
        AT_REST if state is None else _state(state, f"column {name!r}: ", faults)
        for name, state in zip(names, states, strict=True)
    ]


def _state(initial: Any, who: str, faults: list[str]) -> Array:
    """Return the state in numbers; rest, and one more fault, if it is none."""
    with _arguments.collected(faults, who):
        return state_of(initial, "ensemble")
    return AT_REST


def scale_array(scales: ArrayLike, columns: int, motions: int, faults: list[str]) -> Array:
    """Return the scales for each column and motion, shape (columns, motions, k); NaN: no run."""
    try:
        array = _arguments.vector(scales, "scales", shape="any")
    except InputError as error:
        faults.append(str(error))
        return np.ones((columns, motions, 1))
    if array.ndim == 0:
        array = array[None]
    shape = columns, motions, array.shape[-1]
    try:
        full = np.broadcast_to(array, shape)
    except ValueError:
        faults.append(
            f"scales has shape {array.shape}; it must be (k,), ({motions}, k) with a row for each "
            f"motion, or ({columns}, {motions}, k)"
        )
        return np.ones((columns, motions, 1))
    if array.ndim > 3:
        faults.append(f"scales has {array.ndim} dimensions; it can have three")
    wrong = array[np.isinf(array) | (np.abs(array) > _arguments.BEYOND_MEANING)]
    if wrong.size:
        faults.append(f"scales: {wrong[0]} must be a finite number, or NaN for no run")
    elif np.isnan(array).all():
        faults.append("scales: no run is asked for; give at least one number")
    return full


#: A measure of the user: a function of the `Result` of a run.
Measure: TypeAlias = Callable[[ColumnResult], float]

#: The fates of a run, in the order of their numbers in the Fortran part; "" is a run that was not
#: started because the ensemble was broken off.
STATUSES: tuple[str, ...] = ("", "completed", "collapsed", "axial_failure", "failed")

#: The measures; "drift" is a displacement of the top over the height.
MEASURES = {
    "peak_drift": "largest drift in size",
    "residual_drift": "drift at the end of the record, in size",
    "peak_displacement": "largest displacement of the top, with its sign [m]",
    "residual_displacement": "displacement of the top at the end [m]",
    "peak_base_shear": "largest shear force at the base, with its sign [N]",
    "peak_rotation": "largest absolute rotation of a body, in size [rad]",
    "input_energy": "work of the ground motion [J]",
    "spring_energy": "energy of the springs at the end, stored and dissipated [J]",
    "damping_energy": "energy of the damping [J]",
    "energy_residual": "largest error of the energy balance [J]",
    "relative_energy_residual": "the same over the largest energy",
    "first_yield": "time at which a bar or a flexural spring first yields [s]; NaN: none does",
    "end_time": "time at which the run ended [s]",
    "time_step": "step [s]",
    "steps": "number of steps",
    "events": "how often a spring left its line",
    "cut_steps": "steps cut at an event, for accuracy, or because they did not converge",
    "lost_joint": "number of the joint that lost its axial load, as in a `Result`; NaN: none did",
}

#: Measures of frames: of the storey where they are largest; NaN without storeys.
STOREY_MEASURES = {
    "peak_storey_drift": "largest drift of a storey in size",
    "residual_storey_drift": "largest drift of a storey at the end of the record, in size",
}

#: Measures of a single storey of a frame, from 1, are called by these with its number behind.
_OF_A_STOREY = re.compile(r"(?:peak|residual)_storey_drift_([1-9]\d{0,3})")

#: Limit states that are measures too if they are asked for: the time at which each is first reached
#: [s], NaN if it is not; see `rbsdem.Result.limit_states`.
LIMIT_STATES = {name: what for name, what in WATCHED.items() if name != "first_yield"}

#: Measures that are whole numbers.
COUNTS = ("steps", "events", "cut_steps")


def limit_states_among(names: Sequence[str]) -> tuple[str, ...]:
    """Return the limit states among names, but the first yield, which is kept anyway."""
    return tuple(name for name in LIMIT_STATES if name in names)


def storeys_among(names: Sequence[str]) -> int:
    """Return the number of storeys whose drifts are asked for one by one: up to the highest."""
    matches = [_OF_A_STOREY.fullmatch(name) for name in names]
    return max((int(each[1]) for each in matches if each), default=0)


def storey_measures(storeys: int) -> tuple[str, ...]:
    """Return the names of the measures of single storeys, in the order of the Fortran part."""
    return tuple(f"{name}_{i + 1}" for name in STOREY_MEASURES for i in range(storeys))


def measures_in_a_list(measures: Any) -> list[Any]:
    """Return measures as a list; a single one may be given alone."""
    if isinstance(measures, str) or callable(measures):
        return [measures]
    return _arguments.several(measures, "measures", "names and functions")


def checked_measures(
    measures: Sequence[str | Measure] | None, columns: Sequence[Structure]
) -> tuple[tuple[str, ...], dict[str, Measure]]:
    """Return the names of the measures that are kept, and the functions by their names.

    Raises
    ------
    InputError
        For a name that is not known, and for functions without a name of their own.
    """
    if measures is None:
        frames = any(isinstance(column, Frame) for column in columns)
        return (*MEASURES, *(STOREY_MEASURES if frames else ())), {}
    measures = measures_in_a_list(measures)
    names: list[str] = []
    functions: dict[str, Measure] = {}
    for measure in measures:
        name: Any = measure if isinstance(measure, str) else getattr(measure, "__name__", None)
        if isinstance(measure, str):
            known = measure in MEASURES or measure in LIMIT_STATES or measure in STOREY_MEASURES
            if not known and not _OF_A_STOREY.fullmatch(measure):
                raise InputError(
                    f"measures: {measure!r} is not known; it is one of {', '.join(MEASURES)}, "
                    f"{', '.join(STOREY_MEASURES)} (with _1 behind: of the first storey), a limit "
                    f"state ({', '.join(LIMIT_STATES)}), or a function of a Result"
                )
            names.append(name)
        elif callable(measure) and isinstance(name, str) and name.isidentifier():
            if name in functions or name in MEASURES or name in LIMIT_STATES:
                raise InputError(f"measures: two are called {name!r}; give one another name")
            functions[name] = measure
        else:
            raise InputError(
                f"measures: {_arguments.shown(measure)} is neither the name of a measure nor a "
                "function with a name of its own"
            )
    return tuple(dict.fromkeys(names)), functions


#: Measures that are 0 or 1, and the threshold that tells the two apart.
_SWITCHES = dict.fromkeys(("collapse", *WATCHED), 1.0)


def is_switch(edp: str) -> bool:
    """Return whether a measure says only whether something has happened, not how far it went."""
    return edp in _SWITCHES


def limit_states(edp: str, threshold: Any) -> dict[str, tuple[str, float]]:
    """Return measure and threshold of each limit state.

    Parameters
    ----------
    edp : str
        The measure.
    threshold : float, mapping or None
        One value, or values by the name of the limit state, each a number for this measure or a
        pair of a measure and a number. None if the measure is "collapse" or a limit state of
        `rbsdem.Result.limit_states`, which have no threshold to give.
    """
    if isinstance(threshold, Mapping):
        if not threshold:
            raise InputError("threshold is empty; give at least one limit state")
        states = {}
        for name, value in threshold.items():
            pair = value if isinstance(value, tuple) and len(value) == 2 else (edp, value)
            states[str(name)] = _one(str(pair[0]), pair[1])
        return states
    state = _one(edp, threshold)
    return {edp if threshold is None else f"{edp} {state[1]:g}": state}


def _one(edp: str, threshold: Any) -> tuple[str, float]:
    """Return a measure with its checked threshold; that of a measure of 0 or 1 is not given."""
    if edp in _SWITCHES:
        if threshold is not None:
            raise InputError(f"threshold: {edp} has none; leave it out")
        return edp, _SWITCHES[edp]
    if threshold is None:
        raise InputError(f"threshold is missing; give the value of {edp} that is the limit state")
    return edp, _arguments.number(threshold, f"threshold of {edp}", above=0)
