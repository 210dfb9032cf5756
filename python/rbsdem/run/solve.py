"""Analyses of a structure by the keywords of a call, and the states in which they begin and end."""

from __future__ import annotations

import os
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import AccuracyWarning, InputError, LongRunWarning, warn
from rbsdem.model.column import NOTES_ON
from rbsdem.section.criteria import all_thresholds
from rbsdem.section.frame import Frame, Structure

#: First line of a file with a state.
STATE_HEAD = "# rbsdem state"

_DEFORMATIONS = ("slip", "rotation", "opening")
_NONE = np.empty(0)
_NONE.flags.writeable = False
#: Histories of an analysis in time, by name.
HISTORIES = (
    *("force", "ground_acceleration", "vertical_acceleration", "axial_load"),
    "ground_acceleration_y",
)


@runtime_checkable
class HasEndState(Protocol):
    """A result in whose end another analysis can begin."""

    @property
    def state(self) -> Array | None:
        """State at the end."""

    @property
    def summary(self) -> dict[str, Any]:
        """Figures of the analysis."""


def follow(
    structure: Structure,
    call: Mapping[str, Any],
    *,
    every: int | None = None,
    openings: bool = False,
    corners: bool = False,
    with_end: bool = True,
) -> _core.Run:
    """Follow a static path, by the keywords of `rbsdem.cyclic` with checked arrays."""
    settings = settings_of(
        every,
        openings,
        collapse_drift=call.get("collapse_drift"),
        max_seconds=call.get("max_seconds"),
        method=call.get("method"),
    )
    initial = call.get("initial")
    state = None if initial is None else state_of(initial, "cyclic")
    if isinstance(structure, Frame):
        settings = _core.joined([settings, *structure.loss_groups()])
    by_force = call.get("force") is not None
    values = call["force" if by_force else "displacement"]
    load = call.get("axial_load")
    how = load, state, corners, with_end
    return _core.cyclic(structure._made, settings, by_force, values, *how)


def march(
    structure: Structure, call: Mapping[str, Any], openings: bool = False, motion: bool = False
) -> tuple[_core.Run, Array]:
    """March through time, by the keywords of `rbsdem.time_history` with checked arrays."""
    keywords = {name: value for name, value in call.items() if value is not None}
    loads = {name: keywords.pop(name) for name in HISTORIES if name in keywords}
    times, initial, every = (keywords.pop(name, None) for name in ("time", "initial", "every"))
    settings = settings_of(every, openings, motion, **keywords)
    if initial is None or isinstance(initial, Mapping):
        begin, state = _initial_state(initial, structure), None
    else:
        begin, state = (_NONE, False), state_of(initial, "time_history")
    # A frame finds its limit states in its rows.
    frames = isinstance(structure, Frame)
    thresholds = np.empty((0, 6)) if frames else all_thresholds(structure, openings)
    return _core.time_history(
        structure._made, settings, times, loads, *begin, state, thresholds, tell_long
    )


def tell(note: str, kind: type[Warning] = AccuracyWarning) -> None:
    """Warn, unless notes are off."""
    if NOTES_ON.get():
        warn(note, kind)


def tell_long(note: str) -> None:
    """Warn of a run that will take long."""
    tell(note, LongRunWarning)


def settings_of(
    every: int | None, openings: bool, motion: bool = False, **options: Any
) -> _core.Statement:
    """Return the groups analysis and output with the settings that are given."""
    statement = _core.settings({name: v for name, v in options.items() if v is not None})
    if every is None and not openings and not motion:
        return statement
    if every is not None:
        _arguments.integer(every, "every", least=1)
    return statement + _core.group(
        "output", {"every": every, "openings": int(openings) or None, "motion": int(motion) or None}
    )


def state_of(initial: Any, call: str) -> Array:
    """Return the state that an analysis begins in, from a response or a path.

    Parameters
    ----------
    initial : Response or path-like
        As the user gave it.
    call : str
        Name of the analysis, for messages.

    Raises
    ------
    InputError
        If it is neither, has no state, or the file is damaged.
    """
    if isinstance(initial, (str, os.PathLike)):
        return _read_state(_arguments.file(initial, f"{call}: initial"))
    if isinstance(initial, HasEndState):
        return last_state(initial)
    if isinstance(initial, np.ndarray):
        # The state of a result, as `Result.call` keeps it.
        return _arguments.vector(initial, "initial")
    a_dict = " or a dict, as {'slip': [0.001]}" if call == "time_history" else ""
    raise InputError(
        f"{call}: initial = {_arguments.shown(initial)} must be a Result of this column, the path "
        f"of a state{a_dict}"
    )


def last_state(response: HasEndState) -> Array:
    """Return the state that an analysis ended in; `InputError` if it has none."""
    if response.state is None:
        why = {
            "failed": "the analysis failed on its way; end it before the failure",
            "ended": "the push-over ended on its way; end it before that",
            "axial_failure": "a joint has lost its axial load, and nothing can follow",
        }.get(response.summary["status"], "run the analysis again")
        raise InputError(f"initial: the result has no state at its end: {why}")
    return response.state


def _read_state(path: str) -> Array:
    """Return the state of a file: a head, lines with #, the count of numbers, the numbers."""
    if not Path(path).is_file():
        raise InputError(f"initial: {path}: there is no such file; check the path")
    if zipfile.is_zipfile(path):
        raise InputError(
            f"initial: {path} is a saved result and no state; give "
            f"initial=rbsdem.read_result({path!r})"
        )
    try:
        lines = Path(path).read_text(encoding="ascii").splitlines()
        if lines[0] != STATE_HEAD:
            raise ValueError("another kind of file")
        numbers = [line for line in lines if not line.startswith("#")]
        state = np.array(numbers[1:], dtype=np.float64)
        if state.size != int(numbers[0]):
            raise ValueError(f"{state.size} numbers of {numbers[0]}")
    except (OSError, ValueError, IndexError) as error:
        raise InputError(
            f"initial: {path} is no state of rbsdem, or it is damaged ({error}); "
            "Result.save_state and the key state of the group output write one"
        ) from error
    return state


def _initial_state(
    initial: Mapping[str, ArrayLike] | None, column: Structure
) -> tuple[Array, bool]:
    """Return deformations and velocities at the start, and whether openings are given.

    An empty array means a column at rest.
    """
    if not initial:
        return _NONE, False
    if isinstance(column, Frame):
        raise InputError(
            "time_history: a frame begins under its dead load, or with initial= in the state that "
            "another analysis ended in; it takes no deformations of joints"
        )
    n = len(column.joint_numbers)
    known = _DEFORMATIONS if column.opens else _DEFORMATIONS[:2]
    parts = {name: np.zeros(n) for name in (*known, *(f"{name}_velocity" for name in known))}
    for name, values in initial.items():
        if name not in parts:
            if name in ("opening", "opening_velocity"):
                raise InputError(
                    f"initial: {name!r} needs joints that open; give the column axial_spring"
                )
            raise InputError(f"initial: {name!r} is not known; it is one of {', '.join(parts)}")
        array = _arguments.finite_vector(values, f"initial: {name}", shape="1 or m")
        if array.shape != (n,):
            raise InputError(f"initial: {name} has {array.size} values for n = {n} joints")
        parts[name] = array
    return np.concatenate([*parts.values()]), "opening" in initial
