"""The parser of arguments for the commands that are written in Python."""

from __future__ import annotations

import argparse
import sys

__all__ = ["CommandParser"]


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
