"""What the commands that Python does share: how they read their arguments."""

from __future__ import annotations

import argparse
import sys

__all__ = ["CommandParser"]


class CommandParser(argparse.ArgumentParser):
    """A parser whose errors begin with the program's name, as all others.

    Parameters
    ----------
    command : str
        The word behind `rbsdem`.
    description, epilog : str
        Texts of the help, printed as they stand.
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
        """Print the message and end with the code of wrong input."""
        sys.stderr.write(f"rbsdem: {self._command}: {message}\n")
        sys.exit(2)
