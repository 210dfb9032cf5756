"""The state that an analysis ended in, from a result or a file of numbers."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem._files import whole_file
from rbsdem._views import view_of
from rbsdem.errors import InputError
from rbsdem.result import Result

__all__ = ["named_state", "state_of"]

_FIRST = "# rbsdem state"


def state_of(initial: Any, call: str) -> Array:
    """Return the state that an analysis begins in, from a result or a path.

    Parameters
    ----------
    initial : Result or path
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
    if isinstance(initial, Result):
        return _of_result(initial)
    if isinstance(initial, np.ndarray):
        # The state of a result, as `Result.call` keeps it.
        return _arguments.vector(initial, "initial")
    a_dict = " or a dict, as {'slip': [0.001]}" if call == "time_history" else ""
    raise InputError(
        f"{call}: initial = {_arguments.shown(initial)} must be a Result of this column, the path "
        f"of a state{a_dict}"
    )


def named_state(initial: Any) -> Any:
    """Return what a result keeps of `initial`: a path as text, of a result its state."""
    if isinstance(initial, Result):
        return initial.state
    return os.fspath(initial) if isinstance(initial, (str, os.PathLike)) else initial


@view_of(Result, "save_state")
def save_state(result: Result, path: str | os.PathLike[str]) -> None:
    """Write a state as text: a head, then one number a line, whole or not at all."""
    state = _of_result(result)
    head = f"{_FIRST}\n# version: {_core.version()}\n{state.size}\n"
    with whole_file(path) as file:
        file.write((head + "\n".join(map(_text, state)) + "\n").encode())


def _text(number: float) -> str:
    """Return a number as the executable writes it: all digits, three for the exponent."""
    digits, _, exponent = f"{number:.16E}".partition("E")
    return f"{digits}E{int(exponent):+04d}"


def _of_result(result: Result) -> Array:
    if result.state is None:
        ended = result.summary["status"]
        why = {
            "failed": "the analysis failed on its way; end it before the failure",
            "axial_failure": "the column has lost its axial load, and nothing can follow",
        }.get(ended, "it was written by an earlier version; run the analysis again")
        raise InputError(f"initial: the result has no state at its end: {why}")
    return result.state


def _read_state(path: str | os.PathLike[str]) -> Array:
    name = os.fspath(path)
    if not Path(path).is_file():
        raise InputError(f"initial: {name}: there is no such file; check the path")
    try:
        lines = Path(path).read_text(encoding="ascii").splitlines()
        if lines[0] != _FIRST:
            raise ValueError("another kind of file")
        numbers = [line for line in lines if not line.startswith("#")]
        state = np.array(numbers[1:], dtype=np.float64)
        if state.size != int(numbers[0]):
            raise ValueError(f"{state.size} numbers of {numbers[0]}")
    except (OSError, ValueError, IndexError) as error:
        raise InputError(
            f"initial: {name} is no state of rbsdem, or it is damaged ({error}); "
            "Result.save_state and the key state of the group output write one"
        ) from error
    return state
