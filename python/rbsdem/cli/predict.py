"""The command `rbsdem predict`."""

from __future__ import annotations

import argparse
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rbsdem._arguments import Array
from rbsdem._files import write_figure
from rbsdem._optional import console, need_rich
from rbsdem.cli.parser import CommandParser, run_command
from rbsdem.cli.peer import chosen
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.measured.batch import predict
from rbsdem.measured.prediction import Prediction
from rbsdem.measured.predictions import Predictions
from rbsdem.measured.records import loop_names
from rbsdem.measured.specimen import Specimen
from rbsdem.measured.specimens import read_specimens
from rbsdem.solve.protocol import protocol

DESCRIPTION = """\
Predict columns of a table from their properties, with 80 % bands. The table is a specimens.csv as
docs/peer.md describes; a column needs no history if --drifts says what is done to it.
"""

EPILOG = """\
A column with a history is driven through it and compared with it, unless there are --drifts.
Files (--out): numbers.csv (intervals, nearest tests), and for each column the band along its path
as csv and a figure (needs matplotlib).
Exit codes: 0 all were predicted, 1 some were not, 2 the input is wrong, 130 interrupted.
"""


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("predict", DESCRIPTION, EPILOG)
    parser.add_argument("table", type=Path, metavar="DIR", help="specimens.csv or its folder")
    parser.add_argument(
        "only", nargs="*", metavar="NAME", help="names, files, numbers; default all"
    )
    parser.add_argument(
        "--drifts", nargs="+", type=float, metavar="X", help="drift ratios of cycles, as 0.01 0.02"
    )
    parser.add_argument("--cycles", type=int, default=2, metavar="N", help="at each drift; 2")
    parser.add_argument("--model-version", metavar="VERSION", help="of the parameters; the newest")
    parser.add_argument("--samples", type=int, default=16, metavar="N", help="of a band; 16")
    parser.add_argument(
        "--near", type=Path, metavar="DIR", help="folder of tests, for those most like a column"
    )
    parser.add_argument("--out", type=Path, metavar="DIR", help="write files into this folder")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem: predict", lambda: _run(given))


def _run(given: argparse.Namespace) -> int:
    need_rich()
    table = read_specimens(given.table)
    tests = list(chosen(table, "all", None, given.only) if given.only else table)
    if not tests:
        raise InputError(f"{given.table} has no row; write one for each column")
    cycles = None if given.drifts is None else protocol(given.drifts, cycles=given.cycles)
    options = {} if given.model_version is None else {"version": given.model_version}
    near = None if given.near is None else read_specimens(given.near).with_history()
    rows, errors = [], []
    for specimen in tests:
        path = _path(specimen, cycles)
        try:
            with warnings.catch_warnings():
                # The table says it.
                warnings.simplefilter("ignore", AccuracyWarning)
                row = predict(
                    specimen, bands=True, samples=given.samples, displacement=path, near=near,
                    **options,
                )  # fmt: skip
        except InputError as error:
            if len(tests) == 1:
                raise
            errors.append(str(error))
            continue
        rows.append(row)
    lines = []
    if given.out is not None:
        lines = written(Predictions(rows), given.out)
    out = console(120)
    for row in rows:
        out.print(row.table())
        out.print()
    for line in lines:
        print(line)
    for text in errors:
        sys.stderr.write(f"rbsdem: predict: {text}\n")
    return 1 if errors or any(row.status != "completed" for row in rows) else 0


def _path(specimen: Specimen, cycles: Array | None) -> Array | None:
    """Return the displacements of a column; None for those of its test."""
    if cycles is not None:
        return specimen.length * np.asarray(cycles)
    if specimen.path is None:
        raise InputError(
            f"{specimen.name} has no history; say what is done to it: --drifts 0.005 0.01 0.02 0.03"
        )
    return None


def written(rows: Predictions, folder: Path) -> list[str]:
    """Write the files; return lines that say which."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "numbers.csv"]
    rows.bands_to_csv(files[0])
    missing: list[str] = []
    for row, name in zip(rows, loop_names([row.specimen.name for row in rows]), strict=True):
        target = folder / name.name
        if row.band is not None:
            row.band.to_csv(target)
            files.append(target)
        try:
            files.append(_drawn(row, target.with_suffix(".png")))
        except ImportError as error:
            missing = [f"no figures: {error}"]
    return [*missing, *(f"wrote {file}" for file in files)]


def _drawn(row: Prediction, path: Path) -> Path:
    write_figure(row.plot().savefig, path, dpi=160)
    return path
