"""The commands for measured tests: `peer` and `predict`."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from fnmatch import fnmatch
from pathlib import Path

import click
import numpy as np

from rbsdem._files import claim_folder, save_frame, write_figure
from rbsdem._package import unwarned
from rbsdem._types import Array
from rbsdem.cli import FILE, FOLDER, Command, Values, quiet, tell
from rbsdem.errors import InputError
from rbsdem.measured.predict import Prediction, score_summary, scores
from rbsdem.measured.predict import predict as run_predictions
from rbsdem.measured.specimens import Specimen, Specimens, read_specimens
from rbsdem.methods.verification import verify as solve
from rbsdem.output import measured
from rbsdem.output.measured import prediction as draw_prediction
from rbsdem.output.tables import console, table
from rbsdem.run.protocol import protocol
from rbsdem.section.columns import DEFAULT, MODELS

_SECTIONS = click.Choice(["rectangular", "circular", "all"])


# ---- measured tests -----------------------------------------------------------------------------


@click.command("peer", cls=Command)
@click.argument("folder", type=FILE, metavar="DIR")
@click.option("--model", default=DEFAULT, help=f"{', '.join(MODELS)}; default {DEFAULT}")
@click.option("--section", type=_SECTIONS, default="all", help="circular: octagons and spirals too")
@click.option("--failure", cls=Values, metavar="MODE ...", help="Flexure, Flexure-Shear, Shear")
@click.option("--only", cls=Values, metavar="NAME ...", help="names, files, numbers; * is any text")
@click.option("--by", default="kind", help="groups: kind, failure_mode, section, series")
@click.option("--out", type=FILE, metavar="FILE.csv", help="write a row for each test")
@click.option("--bands", is_flag=True, help="80 % bands; 17 times the work")
@click.option("--limit-states", is_flag=True, help="drifts of limit states, in the csv")
@quiet
def peer(
    folder: Path,
    model: str,
    section: str,
    failure: tuple[str, ...],
    only: tuple[str, ...],
    by: str,
    out: Path | None,
    bands: bool,
    limit_states: bool,
    quiet: bool,
) -> int:
    r"""Predict every test of a folder from its properties and compare with the measurement.

    DIR holds specimens.csv and the histories of the PEER Structural Performance Database. Prints
    medians and quartiles of groups; tests that are named by --only are printed one by one.

    \b
    Exit codes: 0 every test was analysed to its end, 1 some were not or have no history, 2 the
    input is wrong, 130 interrupted by the keyboard.
    """
    table = read_specimens(folder)
    tests = chosen(table, section, failure, only)
    if not hasattr(tests[0], by):
        raise InputError(f"--by {by} is no property, as failure_mode, section, series")
    predictions = run_predictions(tests, model, bands=bands, limit_states=limit_states)
    if out is not None:
        save_frame(scores(predictions), out)
    terminal = console(168)
    if only and not quiet:
        terminal.print(measured.tests_table(predictions))
        terminal.print()
    terminal.print(measured.summary_table(score_summary(predictions, by)))
    print(f"\nModel {predictions[0].model}: {len(predictions)} tests")
    left = [] if only else [row.name for row in table if row.path is None]
    left += [row.specimen.name for row in predictions if row.status == "no history"]
    if left:
        names = ", ".join([*left[:3], *(["..."] if left[3:] else [])])
        print(f"{len(left)} of the table have no history in the folder, so no score: {names}")
    return 0 if all(row.status == "completed" for row in predictions) else 1


def chosen(
    table: Specimens, section: str, failure: Sequence[str], only: Sequence[str]
) -> Specimens:
    """Return the tests that are asked for.

    Tests asked for by name need not have a history.
    """
    if only:
        meant: dict[str, Specimen] = {}
        for name in only:
            several = [row for row in table if _is_meant(row, name)]
            # If there is none, this raises an error that names the nearest.
            meant |= {row.name: row for row in several or [table[name]]}
        return Specimens(row for row in table if row.name in meant)
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
    """Whether a word of --only is the name, file or number of a test, or a pattern of them."""
    return row.is_called(name) or fnmatch(row.name, name) or fnmatch(row.file or "", name)


# ---- columns of a table -------------------------------------------------------------------------


@click.command("predict", cls=Command)
@click.argument("table", type=FILE, metavar="DIR")
@click.argument("only", nargs=-1, metavar="[NAME]...")
@click.option("--drifts", cls=Values, type=float, metavar="X ...", help="drift ratios of cycles")
@click.option("--cycles", type=int, default=2, metavar="N", help="at each drift; 2")
@click.option("--samples", type=int, default=16, metavar="N", help="of a band; 16")
@click.option("--near", type=FILE, metavar="DIR", help="folder of tests, for the nearest ones")
@click.option("--no-rig", is_flag=True, help="the column alone, without the friction of a rig")
@click.option("--out", type=FOLDER, metavar="DIR", help="write files into this folder")
def predict(
    table: Path,
    only: tuple[str, ...],
    drifts: tuple[float, ...],
    cycles: int,
    samples: int,
    near: Path | None,
    no_rig: bool,
    out: Path | None,
) -> int:
    r"""Predict columns of a table from their properties, with 80 % bands.

    DIR is a specimens.csv as docs/peer.md describes it, or its folder; NAME a name, file or number,
    by default all. A column with a history is driven through it and compared with it; one without
    needs the drift ratios of its cycles, as --drifts 0.01 0.02.

    \b
    Files (--out): numbers.csv (scores, intervals), and for each column the band along its
    path as csv and a figure.
    Exit codes: 0 all were predicted, 1 some were not, 2 the input is wrong, 130 interrupted.
    """
    specimens = read_specimens(table)
    tests = list(chosen(specimens, "all", (), only) if only else specimens)
    if not tests:
        raise InputError(f"{table} has no rows; write one for each column")
    path = protocol(drifts, cycles=cycles) if drifts else None
    others = () if near is None else read_specimens(near).with_history()
    files = {} if out is None else _claimed(tests, out)
    rows, errors = [], []
    for specimen in tests:
        try:
            with unwarned():
                # The table says it.
                row = run_predictions(
                    specimen,
                    bands=True,
                    samples=samples,
                    displacement=_path(specimen, path),
                    near=others,
                    rig=not no_rig,
                )
        except InputError as error:
            if len(tests) == 1:
                raise
            errors.append(str(error))
            continue
        rows.append(row)
    lines = _write_columns(rows, files) if files else []
    terminal = console(120)
    for row in rows:
        terminal.print(measured.numbers_table(row))
        terminal.print()
    for line in lines:
        print(line)
    for text in errors:
        tell(text)
    return 1 if errors or any(row.status != "completed" for row in rows) else 0


def _path(specimen: Specimen, drifts: Array | None) -> Array | None:
    """Return the displacements of a column; None for those of its test."""
    if drifts is not None:
        return specimen.length * np.asarray(drifts)
    if specimen.path is None:
        raise InputError(
            f"{specimen.name} has no history; give the drifts of its cycles: --drifts 0.005 0.01 "
            "0.02 0.03"
        )
    return None


def _claimed(tests: Sequence[Specimen], folder: Path) -> dict[str, list[Path]]:
    """Return the files of the tests, csv and figure, by name; "" has that of the numbers."""
    short = [re.sub(r"[^\w.-]+", "_", test.name)[:80] for test in tests]
    names = [f"{number}_{name}" for number, name in enumerate(short, 1)]
    endings = [f"{name}{ending}" for name in names for ending in (".csv", ".png")]
    numbers, *files = claim_folder(folder, ["numbers.csv", *endings])
    pairs = zip(files[::2], files[1::2], strict=True)
    return {"": [numbers]} | {t.name: list(p) for t, p in zip(tests, pairs, strict=True)}


def _write_columns(rows: Sequence[Prediction], files: Mapping[str, Sequence[Path]]) -> list[str]:
    """Write the files; return lines that say which."""
    written = [*files[""]]
    save_frame(scores(rows), written[0])
    for row in rows:
        table, figure = files[row.specimen.name]
        if row.band is not None:
            row.band.to_csv(table)
            written.append(table)
        written.append(figure)
        write_figure(draw_prediction(row), figure, dpi=160)
    return [f"wrote {file}" for file in written]


@click.command("verify")
@click.argument("names", nargs=-1, metavar="[NAME]...")
@click.option("--all", "every", is_flag=True, help="each number, not the worst of each problem")
@click.option("--output", type=click.Path(dir_okay=False), metavar="FILE", help="all as csv")
def verify(names: tuple[str, ...], every: bool, output: str | None) -> int:
    """Solve problems of textbooks, standards and other programs, and compare with their numbers.

    NAME is the beginning of the name of a problem; without names all are solved. Of each problem
    the table has the number that differs most, in units of the last printed digit.

    Exit codes: 0 all are inside the printed digits or explained, 1 some are not, 2 no such problem.
    """
    verification = solve(list(names) or None)
    shown = verification if every else verification.worst()
    styles = [None if one.holds else "red" for one in shown.comparisons]
    console(160).print(table(shown, styles=styles))
    print(verification)
    if output is not None:
        verification.to_csv(output)
        print(f"wrote {output}")
    return 0 if verification.holds else 1
