"""Arguments and exit codes of the commands that are written in Python."""

from __future__ import annotations

import argparse
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn

from rbsdem.errors import InputError, RbsdemError

__all__ = ["INTERRUPTED", "CommandParser", "run_command"]

#: Exit code after a keyboard interrupt.
INTERRUPTED = 130
# As a shell reports a process that was ended by a signal.
_TERMINATED = 128 + 15
_NOBODY_READS = 128 + 13


class CommandParser(argparse.ArgumentParser):
    """A parser whose errors start with the name of the program, as all errors do.

    Parameters
    ----------
    command : str
        Name of the command, the word after `rbsdem`.
    description, epilog : str
        Texts of the help, printed unchanged.
    """

    def __init__(self, command: str, description: str, epilog: str) -> None:
        super().__init__(
            prog=f"rbsdem {command}",
            description=description,
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
        )
        self._command = command

    def error(self, message: str) -> None:
        """Print the message and exit with the code for wrong input."""
        sys.stderr.write(f"rbsdem: {self._command}: {message}\n")
        sys.exit(2)


def run_command(name: str, work: Callable[[], int]) -> int:
    """Do the work of a command, with a message for what goes wrong.

    Parameters
    ----------
    name : str
        What each line of a message starts with.
    work : callable
        Returns the exit code.

    Returns
    -------
    int
        The exit code: that of the work, 2 if the input is wrong, 1 if something else is, 130 after
        a keyboard interrupt, 141 if nobody reads the output any more.
    """
    try:
        with _end_as_exception():
            code, text = work(), ""
        _flush()
    except BrokenPipeError:
        # As with `| head`: an end, and no error.
        code, text = _NOBODY_READS, ""
    except InputError as error:
        code, text = 2, str(error)
    except MemoryError:
        code, text = 1, "not enough memory; raise the limit of the process, or ask for less"
    except (RbsdemError, ImportError, OSError) as error:
        code, text = 1, str(error)
    except KeyboardInterrupt as error:
        code, text = INTERRUPTED, str(error) or "broken off"
    for line in text.splitlines():
        sys.stderr.write(f"{name}: {line}\n")
    _let_go_of_stdout()
    return code


@contextmanager
def _end_as_exception() -> Iterator[None]:
    """Turn SIGTERM into an exception: no unfinished file and no other process stays behind."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, _terminated)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _terminated(number: int, frame: object) -> NoReturn:
    del number, frame
    sys.exit(_TERMINATED)


def _flush() -> None:
    if sys.stdout is not None:  # as it is if it was closed
        sys.stdout.flush()


def _let_go_of_stdout() -> None:
    """Write what is left, or drop it: Python would report at its end that it cannot be written."""
    try:
        _flush()
    except OSError:
        with suppress(OSError, ValueError):
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
