"""The command `rbsdem trade`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rbsdem._optional import need_rich
from rbsdem.cli.parser import CommandParser, run_command
from rbsdem.methods.measure import trade
from rbsdem.output import methods_figure as figure
from rbsdem.output import methods_table as table
from rbsdem.results.case import Case, read_case

DESCRIPTION = """\
What accuracy costs in a case, and which parts of the model it needs: the case is run over methods,
steps and tolerances, against a reference on which two methods agree.
"""

EPILOG = """\
Files: trade.csv (settings), physics.csv (parts of the model), trade.png (error against wall time;
needs matplotlib). Exit codes: 0 all went well, 1 the analysis failed, 2 the input is wrong.
"""


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("trade", DESCRIPTION, EPILOG)
    parser.add_argument("case", type=Path, metavar="CASE.nml", help="case of the executable")
    parser.add_argument(
        "--tolerance",
        type=float,
        metavar="X",
        help="relative error allowed: names the cheapest setting within it",
    )
    parser.add_argument(
        "--budget", type=float, default=60.0, metavar="S", help="wall time, default 60 s"
    )
    parser.add_argument(
        "--methods", metavar="A,B", help="methods in time to try, default all of them"
    )
    parser.add_argument(
        "--output", type=Path, metavar="DIR", help="folder of the files, default CASE-trade"
    )
    parser.add_argument(
        "--quiet", action="store_true", help="write the files, print nothing but errors"
    )
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem", lambda: _run(given))


def _run(given: argparse.Namespace) -> int:
    case = read_case(given.case)
    if not given.quiet:
        # Before the work, not after it.
        need_rich()
    methods = given.methods.split(",") if given.methods else None
    found = trade(
        case.column,
        **loading(case),
        methods=methods,
        setting=own(case),
        tolerance=given.tolerance,
        budget=given.budget,
        progress=not given.quiet and sys.stderr.isatty(),
    )
    folder = given.output or given.case.with_name(f"{given.case.stem}-trade")
    folder.mkdir(parents=True, exist_ok=True)
    written = [folder / "trade.csv", folder / "physics.csv"]
    found.to_csv(written[0])
    found.physics_to_csv(written[1])
    picture = figure.save(found, folder / "trade.png", case.title)
    if picture is not None:
        written.append(picture)
    if not given.quiet:
        table.report(found, case.title or given.case.stem)
        if picture is None:
            print('no figure: it needs matplotlib (pip install "rbsdem[plot]") and a reference')
        for path in written:
            print(f"wrote {path}")
    return 0


def own(case: Case) -> dict[str, Any] | None:
    """Return the setting of a case, as `trade` takes it."""
    if case.method == "static":
        return None
    names = ("dt", "tolerance", "events", "rho_infinity")
    return {"method": case.method, **{n: case.settings[n] for n in names if n in case.settings}}


def loading(case: Case) -> dict[str, Any]:
    """Return the arguments of `trade` for a case."""
    names = ("displacement", "force", "ground_acceleration", "vertical_acceleration", "axial_load")
    found = {name: getattr(case, name) for name in names if getattr(case, name) is not None}
    if case.method != "static":
        found["time"] = case.time
    if "collapse_drift" in case.settings:
        found["collapse_drift"] = case.settings["collapse_drift"]
    return found
