"""The command `rbsdem`: starts the executable that was built with the package.

Some commands are run by Python.
"""

from __future__ import annotations

import os
import re
import sys
from importlib.resources import files

from rbsdem._package import COMMANDS


def executable() -> str:
    """Return the path of the Fortran executable.

    Raises
    ------
    FileNotFoundError
        If the package was built without it.
    """
    program = "rbsdem.exe" if os.name == "nt" else "rbsdem"
    path = str(files("rbsdem").joinpath("bin", program))
    if not os.path.isfile(path):
        raise FileNotFoundError(
            f"rbsdem: the executable {path} is missing; install the package anew"
        )
    return path


#: Groups and keys of a case that Python reads; the executable solves springs.
_OF_PYTHON = ("&drawing", "&infill_of", "&node_load", "&target", "&assess", "&records", "&limit")
_OF_FRAMES = ("live_load", "self_weight", "from_loads")


def _word_of(found: re.Match[str]) -> str:
    """Return a quoted text if it is one word; nothing of a comment, or of more words."""
    return found[0] if found[0][0] != "!" and found[0][1:-1].isidentifier() else ""


#: Options whose value may be the next word.
_WITH_VALUE = ("-o", "--output", "--count")


def for_python(words: list[str]) -> list[str]:
    """Return the words of `run`, `check` or `modes` if Python takes part in the case.

    The command and the path of the case come first.
    """
    places = [
        i
        for i, word in enumerate(words)
        if not word.startswith("-") and not (i and words[i - 1] in _WITH_VALUE)
    ]
    name, path = [*(words[i] for i in places), "", ""][:2]
    if name not in ("run", "check", "modes") or not os.path.isfile(path):
        return []
    ordered = [name, path, *(word for i, word in enumerate(words) if i not in places[:2])]
    if any(word.partition("=")[0] == "--report" for word in words):
        return ordered
    with open(path, encoding="utf-8", errors="replace") as file:
        # Neither comments nor texts are groups.
        text = re.sub(r"""'[^'\n]*'|"[^"\n]*"|!.*""", _word_of, file.read().lower())
    asked = any(name in text for name in _OF_PYTHON[3:])
    drawn = "&frame" in text and any(name in text for name in (*_OF_PYTHON, *_OF_FRAMES))
    # A column of a drawing without the layers of its joints
    drawn |= "&drawing" in text and "&layers" not in text
    return ordered if asked or drawn else []


def main() -> int:
    """Run the executable with the arguments of the command line, or a command of the package."""
    words = sys.argv[1:]
    if words[:1] in (["--help"], ["-h"]) and words[1:2] and words[1] in COMMANDS:
        words = [words[1], "--help"]
    if (words and words[0] in COMMANDS) or "_RBSDEM_COMPLETE" in os.environ:
        # Only now: the executable starts without click.
        from rbsdem.cli import main as run_command  # noqa: PLC0415

        return run_command(words)
    if words == ["keys", "--schema"]:
        import json  # noqa: PLC0415

        from rbsdem.run.schema import case_schema  # noqa: PLC0415

        print(json.dumps(case_schema(), indent=1))
        return 0
    try:
        program = executable()
    except FileNotFoundError as error:
        print(error, file=sys.stderr)
        return 2
    if ordered := for_python(words):
        from rbsdem.cli.columns import on_springs  # noqa: PLC0415

        return on_springs(program, *ordered)
    if sys.stdout is not None:  # as it is if it was closed
        sys.stdout.flush()
    if os.name == "nt":  # where a process that is replaced returns to the shell at once
        from subprocess import run  # noqa: PLC0415

        return run([program, *sys.argv[1:]], check=False).returncode
    os.execv(program, [program, *sys.argv[1:]])
    return 2


if __name__ == "__main__":
    sys.exit(main())
