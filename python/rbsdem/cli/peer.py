"""The command `rbsdem peer`."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path

from rbsdem._optional import console, need_rich
from rbsdem.cli.parser import INTERRUPTED, CommandParser, run_command
from rbsdem.errors import InputError
from rbsdem.measured.batch import predict
from rbsdem.measured.doubts import Checked, check
from rbsdem.measured.journal import Journal
from rbsdem.measured.one import How
from rbsdem.measured.predictions import Predictions
from rbsdem.measured.specimen import Specimen
from rbsdem.measured.specimens import Specimens, read_specimens
from rbsdem.section.model import DEFAULT, MODELS, model_name

DESCRIPTION = """\
Predict every test of a folder from its properties and compare with what was measured. The folder
holds specimens.csv and the histories of the PEER Structural Performance Database.
"""

EPILOG = """\
Files (--out): results.csv (a row for each test), summary.csv (medians and quartiles of
groups), gallery.html (all loops, to sort and filter), loops.png (all loops; needs matplotlib);
with --bands also bands.csv (intervals, nearest tests) and bands.png, with --loops bands/ (the band
along the path of each test); with --check only check.csv (indicators and doubts).
A batch that did not come to its end leaves what was finished in unfinished.jsonl; a second start
with the same --out goes on from there.
Exit codes: 0 every test was analysed to its end, 1 some were not, 2 the input is wrong,
130 interrupted by the keyboard (what was finished is reported).
"""

#: Name of the journal in the folder of `--out`, as long as the batch is not finished.
UNFINISHED = "unfinished.jsonl"


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("peer", DESCRIPTION, EPILOG)
    parser.add_argument("folder", type=Path, metavar="DIR", help="folder of the tests")
    parser.add_argument("--model", default=DEFAULT, help=f"{', '.join(MODELS)}; default {DEFAULT}")
    parser.add_argument(
        "--model-version",
        metavar="VERSION",
        help="version of the parameters of the layered model; the newest by default",
    )
    parser.add_argument(
        "--section",
        default="all",
        choices=["rectangular", "circular", "all"],
        help="sections; circular with octagonal ones and spirals; default %(default)s",
    )
    parser.add_argument(
        "--failure", nargs="+", metavar="MODE", help="failure modes: Flexure, Flexure-Shear, Shear"
    )
    parser.add_argument(
        "--only", nargs="+", metavar="NAME", help="files, names or numbers of tests; * is any text"
    )
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="processes"
    )
    parser.add_argument(
        "--by",
        default="kind",
        metavar="WHAT",
        help="groups: kind (form and failure mode), failure_mode, section, series",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="say which tests are doubtful, and why; no column is predicted",
    )
    parser.add_argument(
        "--mended",
        action="store_true",
        help="predict with sure doubts mended, or the tests set aside (see --check)",
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="write files into this folder")
    parser.add_argument(
        "--loops", action="store_true", help="with --out, write the loops of every test as csv"
    )
    parser.add_argument(
        "--bands",
        action="store_true",
        help="with 80 %% bands, intervals of numbers, and the nearest tests (17 times the work)",
    )
    parser.add_argument(
        "--limit-states",
        action="store_true",
        help="with the drifts at which limit states are reached, as columns of results.csv",
    )
    parser.add_argument("--quiet", action="store_true", help="print the summary only")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem: peer", lambda: _run(given))


def _run(given: argparse.Namespace) -> int:
    # What may be missing or wrong is reported before the work.
    need_rich()
    tests = chosen(read_specimens(given.folder), given.section, given.failure, given.only)
    if given.check:
        return _check(tests, given.out)
    if given.mended:
        # Rules by series and twins look at all tests, not at the chosen ones alone.
        tests = _mended(tests, check(read_specimens(given.folder).with_history()))
    if not hasattr(tests[0], given.by):
        raise InputError(f"--by {given.by} is no property, as failure_mode, section, series")
    options = {} if given.model_version is None else {"version": given.model_version}
    model_name(given.model, **options)
    if given.loops and given.out is None:
        raise InputError("--loops writes files; say where with --out DIR")
    if given.out is not None:
        given.out.mkdir(parents=True, exist_ok=True)
    journal = None if given.out is None else given.out / UNFINISHED
    found = predict(
        tests,
        given.model,
        jobs=given.jobs,
        bands=given.bands,
        progress=not given.quiet and sys.stderr.isatty(),
        journal=journal,
        limit_states=given.limit_states,
        **options,
    )
    # The files come first: whoever reads the report may stop reading.
    lines = []
    if given.out is not None:
        lines = written(found, given.out, given.by, given.loops)
    if journal is not None and not found.interrupted:
        how = How(bands=given.bands, limit_states=given.limit_states)
        Journal(journal, tests, found.model, how.given(options)).forget()
    _report(found, given.by, given.quiet)
    for line in lines:
        print(line)
    if found.interrupted:
        sys.stderr.write(f"rbsdem: peer: broken off after {len(found)} of {len(tests)} tests\n")
        return INTERRUPTED
    return 0 if found.all_completed else 1


def _check(tests: Specimens, folder: Path | None) -> int:
    """Print which tests are doubtful."""
    checked = check(tests)
    console(168).print(checked.table())
    sure = {doubt.specimen.name for doubt in checked.doubts if doubt.sure}
    hints = {doubt.specimen.name for doubt in checked.doubts} - sure
    print(
        f"\n{len(checked.indicators)} tests with a history: {len(sure)} surely doubtful, hints "
        f"for {len(hints)} more"
    )
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        checked.to_csv(folder / "check.csv")
        print(f"wrote {folder / 'check.csv'}")
    return 0


def _mended(tests: Specimens, checked: Checked) -> Specimens:
    """Return the chosen tests as they are after mending."""
    mended = {row.name: row for row in checked.mended()}
    kept = Specimens(mended[row.name] for row in tests if row.name in mended)
    if not kept:
        raise InputError("--mended sets all of these tests aside; --check says why")
    return kept


def chosen(
    table: Specimens, section: str, failure: Sequence[str] | None, only: Sequence[str] | None
) -> Specimens:
    """Return the tests that are asked for.

    Tests asked for by name need not have a history.
    """
    if only:
        found: dict[str, Specimen] = {}
        for name in only:
            several = [row for row in table if _is_meant(row, name)]
            # If there is none, this raises an error that names the nearest.
            found |= {row.name: row for row in several or [table[name]]}
        return Specimens(row for row in table if row.name in found)
    tests = table.with_history()
    if not tests:
        raise InputError("the folder has no history of any test of its table; put csv or txt there")
    if section == "rectangular":
        tests = tests.where(section="rectangular")
    elif section == "circular":
        tests = tests.where(section=lambda shape: shape != "rectangular")
    if failure:
        known = {(row.failure_mode or "").lower() for row in table}
        wrong = [mode for mode in failure if mode.lower() not in known]
        if wrong:
            modes = ", ".join(sorted({row.failure_mode or "" for row in table} - {""}))
            raise InputError(f"--failure {wrong[0]} is not in the table; there are {modes}")
        wanted = [mode.lower() for mode in failure]
        tests = tests.where(failure_mode=lambda mode: (mode or "").lower() in wanted)
    if not tests:
        raise InputError("no test is left of those with a history; choose other sections or modes")
    return tests


def _is_meant(row: Specimen, name: str) -> bool:
    return row.is_called(name) or fnmatch(row.name, name) or fnmatch(row.file or "", name)


def _report(found: Predictions, by: str, quiet: bool) -> None:
    out = console(168)
    if not quiet:
        out.print(found.table())
        out.print()
        if any(row.band is not None for row in found):
            out.print(found.band_table())
            out.print("* outside its interval", style="dim")
            out.print()
    out.print(found.summary_table(by))
    print(f"\nModel {found.model}: {len(found)} tests in {found.seconds:.1f} s")
    if found.resumed:
        print(f"{found.resumed} of them are from an earlier start that was broken off")


def written(found: Predictions, folder: Path, by: str, loops: bool) -> list[str]:
    """Write the files; return lines that say which."""
    files = [folder / "results.csv", folder / "summary.csv", folder / "gallery.html"]
    found.to_csv(files[0])
    found.summary_to_csv(files[1], by)
    found.gallery(files[2])
    banded = any(row.band is not None for row in found)
    if banded:
        files.append(folder / "bands.csv")
        found.bands_to_csv(files[-1])
    missing = []
    pictures = {"loops.png": found.contact_sheet}
    if banded:
        pictures["bands.png"] = found.band_sheet
    for name, write in pictures.items():
        try:
            files.append(write(folder / name))
        except ImportError as error:
            missing.append(f"no {name}: {error}")
    if loops:
        found.loops_to_csv(folder / "loops")
        files.append(folder / "loops")
    if loops and banded:
        found.paths_to_csv(folder / "bands")
        files.append(folder / "bands")
    return [*missing, *(f"wrote {file}" for file in files)]
