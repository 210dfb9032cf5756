"""The command `rbsdem report`."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from rbsdem.cli.explore import start_of
from rbsdem.cli.parser import CommandParser, run_command
from rbsdem.web.near import Near
from rbsdem.web.report import write_report

DESCRIPTION = """\
A case as one file of html that opens offline. It has loops and limit states and, for a drawn
column, section, diagrams, band and values of codes, and asks nothing of a network.
"""

EPILOG = """\
Exit codes: 0 written, 1 it cannot be written, 2 the input is wrong.
"""


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("report", DESCRIPTION, EPILOG)
    parser.add_argument("case", type=Path, metavar="CASE.nml", help="case of the executable")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help="file to write, default CASE.html"
    )
    parser.add_argument("--title", help="title, default that of the case")
    parser.add_argument(
        "--tests", type=Path, metavar="DIR", help="folder of measured tests, for the nearest ones"
    )
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem: report", lambda: _run(given))


def _run(given: argparse.Namespace) -> int:
    start = start_of(given.case)
    near = None if given.tests is None else Near(given.tests)
    output = given.output or given.case.with_suffix(".html")
    title = given.title or start["title"] or given.case.stem
    print(f"wrote {write_report(output, start, title, near)}")
    return 0
