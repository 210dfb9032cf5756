"""Exceptions of rbsdem; the text of an error is the same in Python and in the executable."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

#: How a message begins that tells of a value: "cover = ...", "layout: number = ...", after the
#: place of the value in a file and the name of its drawing, if there are any.
_FIELD = re.compile(
    r"(?:(?:.* )?line \d+: )?(?:drawing '[^']*': )?(?:([\w ]+?)(?:\(\d+\))?: )?"
    r"([a-z]\w*)(?:\(\d+\))?(?: = |: value \d| is missing)"
)


class RbsdemError(Exception):
    """Base class of the errors of rbsdem."""


class InputError(RbsdemError, ValueError):
    """The input is wrong: the message names the object, its value and a remedy.

    Parameters
    ----------
    message : str
        One line for each fault, as "layout: number = 11 ...".
    field : str, optional
        The value that is wrong, as "layout.number". By default it is read from the beginning of
        each line, where the messages of rbsdem have it.

    Attributes
    ----------
    faults : tuple of (str, str)
        Field and line of each fault; the field is "" where the line names none.
    """

    def __init__(self, message: str = "", field: str = "") -> None:
        super().__init__(message)
        field = field.replace(": ", ".")
        self.faults = tuple((field or _field(line), line) for line in str(message).splitlines())

    def of(self, part: str) -> InputError:
        """Return the same error with the name of what it is about before each line."""
        made = InputError("\n".join(f"{part}: {line}" for _, line in self.faults))
        made.faults = tuple((field, f"{part}: {line}") for field, line in self.faults)
        return made

    @property
    def field(self) -> str:
        """The value that is wrong, the first if there are several."""
        return self.faults[0][0] if self.faults else ""


def _field(line: str) -> str:
    """Return the value that a message is about, as "layout.number"; "" if it names none."""
    match = _FIELD.match(line)
    return "" if match is None else ".".join(filter(None, match.groups()))


class SolveError(RbsdemError, RuntimeError):
    """An analysis of valid input could not be completed.

    Parameters
    ----------
    message : str
        Cause and place of the stop.
    result : rbsdem.Result, optional
        The path up to that point.

    Attributes
    ----------
    result : rbsdem.Result or None
        The path up to that point; None if no path was computed.
    """

    def __init__(self, message: str = "", result: Any = None) -> None:
        super().__init__(message)
        self.result = result


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended an analysis of many runs before all of them were done.

    It is a `KeyboardInterrupt`: a program that does not catch it ends.

    Parameters
    ----------
    message : str
        Number of runs that were done, and how to go on.
    ensemble : rbsdem.fragility.Ensemble, optional
        The runs that were done.

    Attributes
    ----------
    ensemble : rbsdem.fragility.Ensemble or None
        The runs that were done; the status of the others is "".
    """

    def __init__(self, message: str = "", ensemble: Any = None) -> None:
        super().__init__(message)
        self.ensemble = ensemble


class LongRunWarning(UserWarning):
    """An analysis that starts now will take long: the message says how long, and what is faster."""


class AccuracyWarning(UserWarning):
    """A result of valid input may mislead: the message says why, and what to use instead."""


class RepairWarning(UserWarning):
    """A file was repaired while it was read: the message says what was missing, and where."""


#: Packages whose lines are not those of a user: a warning names the first line of another one.
_BETWEEN = ("rbsdem", "dataclasses", "functools")


#: What has been told in a block in which each text is told once.
_TOLD: ContextVar[set[str] | None] = ContextVar("_TOLD", default=None)


@contextmanager
def each_told_once() -> Iterator[None]:
    """Give each warning once in this block, where many similar objects are made."""
    token = _TOLD.set(set())
    try:
        yield
    finally:
        _TOLD.reset(token)


def warn(text: str, kind: type[Warning] = AccuracyWarning) -> None:
    """Warn, at the line of the user's program that called the package.

    Parameters
    ----------
    text : str
        The danger, and the remedy.
    kind : type, optional
        Class of the warning.
    """
    told = _TOLD.get()
    if told is not None:
        if text in told:
            return
        told.add(text)
    level, frame = 2, sys._getframe(1)
    while frame.f_back and frame.f_globals.get("__name__", "").partition(".")[0] in _BETWEEN:
        level, frame = level + 1, frame.f_back
    warnings.warn(text, kind, stacklevel=level)
