"""The command `rbsdem ensemble`."""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from rbsdem._files import write_csv
from rbsdem._optional import need_parquet
from rbsdem.batch.engine import ensemble
from rbsdem.batch.record import Ensemble
from rbsdem.cli.parser import INTERRUPTED, CommandParser, run_command
from rbsdem.errors import InputError
from rbsdem.motions.read import read_motion, read_motions
from rbsdem.results.case import Case, read_case

DESCRIPTION = """\
Run the column of a case under records of ground motions at several scales. Method, step, collapse
drift and the state to begin in are those of the case. Without records its own ground acceleration
is the motion.
"""

EPILOG = """\
Files (--out): store/ (what is computed, in Parquet files of some seconds of work each), runs.csv (a
row for each run, as soon as all parts are there). A second start computes what the store has not:
after an interruption, or with more records or scales. For a job array give every job the same
command with --shard I/N.
Exit codes: 0 every run came to its end or collapsed, 1 some failed, 2 the input is wrong,
130 interrupted by the keyboard (what was finished is kept).
"""

#: Settings of a case that an ensemble takes.
_SETTINGS = (
    "dt",
    "events",
    "tolerance",
    "rho_infinity",
    "collapse_drift",
    "allow_unstable",
    "max_seconds",
    "initial",
)


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("ensemble", DESCRIPTION, EPILOG)
    parser.add_argument("case", type=Path, metavar="CASE.nml", help="case of the executable")
    parser.add_argument(
        "records", type=Path, nargs="*", metavar="RECORD", help="files of records, or folders"
    )
    parser.add_argument(
        "--scales", default="1", metavar="A,B,...", help="factors of the records, default 1"
    )
    parser.add_argument("--units", help="unit of records whose files name none: g, m/s2, cm/s2")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the files"
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="threads, default one per processor")
    parser.add_argument("--shard", metavar="I/N", help="do part I of N, from 1 to N")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem", lambda: _run(given))


def _run(given: argparse.Namespace) -> int:
    need_parquet()
    case = read_case(given.case)
    if case.method == "static":
        raise InputError(
            f"{given.case}: method = 'static' takes no records; set a method in time, as 'auto'"
        )
    shard = None if given.shard is None else _part(given.shard)
    found = ensemble(
        {case.title or given.case.stem: case.column},
        _motions(given, case),
        scales=_scales(given.scales),
        method=case.method,
        **{name: case.settings[name] for name in _SETTINGS if name in case.settings},
        jobs=given.jobs,
        store=given.out / "store",
        shard=shard,
        progress=not given.quiet,
        allow_partial=True,
    )
    if "" not in found.status:
        write_csv(given.out / "runs.csv", _rows(found))
    if not given.quiet:
        print(_told(found, given))
    if found.interrupted:
        return INTERRUPTED
    return 1 if found.errors else 0


def _motions(given: argparse.Namespace, case: Case) -> list[Any]:
    if not given.records:
        if case.ground_acceleration is None:
            raise InputError(
                f"{given.case} has no ground acceleration; give records: rbsdem ensemble "
                f"{given.case} RECORD ..."
            )
        others = ("force", "vertical_acceleration", "axial_load")
        acting = [name for name in others if getattr(case, name) is not None]
        if acting:
            raise InputError(
                f"{given.case}: {acting[0]} has no place in an ensemble, whose motions are "
                "horizontal; take it out of the case, or run the case by itself: rbsdem run"
            )
        return [(case.time, case.ground_acceleration)]
    motions: list[Any] = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for path in given.records:
            if path.is_dir():
                motions += read_motions(path, given.units)
            else:
                motions.append(read_motion(path, given.units))
    for warning in caught:
        sys.stderr.write(f"rbsdem: {warning.message}\n")
    return motions


def _scales(text: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise InputError(f"--scales {text}: give numbers with commas between, as 0.5,1,2") from None


def _part(text: str) -> tuple[int, int]:
    place, _, parts = text.partition("/")
    try:
        return int(place), int(parts)
    except ValueError:
        raise InputError(f"--shard {text}: give part and number of parts, as 3/20") from None


def _rows(found: Ensemble) -> list[list[object]]:
    columns, motions = list(found.columns), list(found.motions)
    rows: list[list[object]] = [["column", "motion", "scale", "status", *found.measures, "error"]]
    for run in range(len(found)):
        numbers = [float(values[run]) for values in found.measures.values()]
        place = str(columns[found.column[run]]), str(motions[found.motion[run]])
        status = str(found.status[run])
        rows.append([*place, float(found.scale[run]), status, *numbers, found.errors.get(run, "")])
    return rows


def _told(found: Ensemble, given: argparse.Namespace) -> str:
    counts = ", ".join(f"{number} {status}" for status, number in found.counts.items())
    resumed = f", {found.resumed} of them from the store" if found.resumed else ""
    told = f"{len(found)} runs{resumed}: {counts}; {found.seconds:.3g} s"
    if "" in found.status:
        return f"{told}\nruns.csv is written when all parts are in {given.out / 'store'}"
    return f"{told}\nwrote {given.out / 'runs.csv'}"
