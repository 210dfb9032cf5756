"""Exceptions of rbsdem; the text of an error is the same in Python and in the executable."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rbsdem.batch.record import Ensemble
    from rbsdem.model.response import Response

__all__ = [
    "AccuracyWarning",
    "InputError",
    "Interrupted",
    "LongRunWarning",
    "RbsdemError",
    "RepairWarning",
    "SolveError",
]


class RbsdemError(Exception):
    """Base of every error that rbsdem raises on purpose."""


class InputError(RbsdemError, ValueError):
    """The input is wrong: the message names the object, its value and a remedy."""


class SolveError(RbsdemError, RuntimeError):
    """An analysis of valid input could not be completed.

    Parameters
    ----------
    message : str
        What stopped the analysis and where.
    result : rbsdem.Result, optional
        The path up to that point.

    Attributes
    ----------
    result : rbsdem.Result or None
        The path up to that point; None if no path was computed.
    """

    def __init__(self, message: str = "", result: Response | None = None) -> None:
        super().__init__(message)
        self.result = result

    def __reduce__(self) -> tuple[type[SolveError], tuple[str, Response | None]]:
        """Keep `result` when the error is sent to another process (pickle)."""
        return type(self), (str(self), self.result)


class Interrupted(KeyboardInterrupt):
    """Ctrl-C ended work of many runs before all of them were done.

    It is a `KeyboardInterrupt`: a program that does not ask for it ends.

    Parameters
    ----------
    message : str
        What was done, and how to go on.
    ensemble : rbsdem.batch.record.Ensemble, optional
        The runs that were done.

    Attributes
    ----------
    ensemble : rbsdem.batch.record.Ensemble or None
        The runs that were done; the status of the others is "".
    """

    def __init__(self, message: str = "", ensemble: Ensemble | None = None) -> None:
        super().__init__(message)
        self.ensemble = ensemble

    def __reduce__(self) -> tuple[type[Interrupted], tuple[str, Ensemble | None]]:
        """Keep `ensemble` when the exception is sent to another process (pickle)."""
        return type(self), (str(self), self.ensemble)


class LongRunWarning(UserWarning):
    """An analysis that starts now will take long: the message says how long, and what is faster."""


class AccuracyWarning(UserWarning):
    """A result of valid input may mislead: the message says why, and what to use instead."""


class RepairWarning(UserWarning):
    """A file was not in order and has been mended: the message says what is missing, and where."""
