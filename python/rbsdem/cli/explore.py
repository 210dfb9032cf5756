"""The command `rbsdem explore`."""

from __future__ import annotations

import argparse
import sys
import threading
import webbrowser
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from rbsdem.cli.parser import CommandParser, run_command
from rbsdem.errors import InputError
from rbsdem.results.case import read_case
from rbsdem.web.near import Near
from rbsdem.web.server import ExploreServer, opened
from rbsdem.web.state import DEFAULT
from rbsdem.web.texts import drawing_in

DESCRIPTION = """\
A page in the browser on which one draws a column and sees its loops. Section by dragging and
typing, limit states, bands, moment-curvature, interaction, values of codes, tests that are like it.
"""

EPILOG = """\
The page is on this machine alone; its address has a token, and nothing is asked of a network.
Ctrl-C ends it. Exit codes: 0 ended, 2 the input is wrong.
"""


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("explore", DESCRIPTION, EPILOG)
    parser.add_argument("case", type=Path, nargs="?", metavar="CASE.nml", help="case to begin with")
    parser.add_argument(
        "--no-browser", action="store_true", help="print the address, open no browser"
    )
    parser.add_argument(
        "--port", type=int, default=0, metavar="N", help="port on 127.0.0.1, default a free one"
    )
    parser.add_argument(
        "--tests",
        type=Path,
        metavar="DIR",
        help="folder of measured tests, to show those nearest to the column",
    )
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem: explore", lambda: _run(given))


def start_of(path: Path) -> Mapping[str, Any]:
    """Return the state of a case file; its histories are put into it.

    Raises
    ------
    InputError
        As `rbsdem.read_case`.
    """
    case = read_case(path)
    written = path.read_text(encoding="utf-8", errors="replace")
    found = opened(written) if drawing_in(written) is not None else {"faults": []}
    if "faults" in found:
        found = opened(case.to_namelist())
    if "faults" in found:
        raise InputError("\n".join(fault["text"] for fault in found["faults"]))
    return {**found["state"], "note": found.get("note", ""), "title": case.title}


def _run(given: argparse.Namespace) -> int:
    start = DEFAULT if given.case is None else start_of(given.case)
    near = None if given.tests is None else Near(given.tests)
    server = ExploreServer(given.port, start, near)
    print(server.address, flush=True)
    if not given.no_browser:
        # Some browsers come back only when they are closed.
        threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        sys.stderr.write("rbsdem: explore: Ctrl-C ends it\n")
    try:
        server.serve_forever(poll_interval=0.2)
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
    return 0
