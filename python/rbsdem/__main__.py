"""The command `rbsdem`: starts the executable that was built with the package.

`rbsdem trade` and `rbsdem peer` are run by Python.
"""

from __future__ import annotations

import os
import sys
from importlib.resources import files


def executable() -> str:
    """Return the path of the Fortran executable.

    Raises
    ------
    FileNotFoundError
        If the package was built without it.
    """
    program = "rbsdem.exe" if os.name == "nt" else "rbsdem"
    path = os.fspath(files("rbsdem").joinpath("bin", program))
    if not os.path.isfile(path):
        raise FileNotFoundError(
            f"rbsdem: the executable {path} is missing; install the package anew"
        )
    return path


def main() -> int:
    """Run the executable with the arguments of the command line, or `trade` or `peer`."""
    words = sys.argv[1:]
    if words[:1] in (["--help"], ["-h"]) and words[1:2] in (["trade"], ["peer"]):
        words = [words[1], "--help"]
    if words[:1] == ["trade"]:
        from rbsdem.accuracy.command import main as trade  # noqa: PLC0415

        return trade(words[1:])
    if words[:1] == ["peer"]:
        from rbsdem.peer.command import main as peer  # noqa: PLC0415

        return peer(words[1:])
    try:
        program = executable()
    except FileNotFoundError as error:
        print(error, file=sys.stderr)
        return 2
    if sys.stdout is not None:  # as it is if it was closed
        sys.stdout.flush()
    os.execv(program, [program, *sys.argv[1:]])
    return 2


if __name__ == "__main__":
    sys.exit(main())
