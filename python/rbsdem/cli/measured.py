"""The commands for measured tests: `peer` and `predict`."""

from __future__ import annotations

import os
import sys
from collections.abc import Sequence
from fnmatch import fnmatch
from pathlib import Path

import click
import numpy as np

from rbsdem._files import save_frame, write_figure
from rbsdem._package import unwarned
from rbsdem._types import Array
from rbsdem.cli import FILE, FOLDER, INTERRUPTED, Command, Values, quiet, tell
from rbsdem.errors import InputError
from rbsdem.measured.doubts import Checked
from rbsdem.measured.doubts import check as check_tests
from rbsdem.measured.predict import PredictionOptions
from rbsdem.measured.predict import predict as run_predictions
from rbsdem.measured.predictions import Predictions, PredictionStore, loop_names
from rbsdem.measured.specimens import Specimen, Specimens, read_specimens
from rbsdem.output import measured, tables
from rbsdem.output.measured import band_sheet, contact_sheet
from rbsdem.output.measured import prediction as draw_prediction
from rbsdem.output.tables import console
from rbsdem.run.protocol import protocol
from rbsdem.section.columns import DEFAULT, MODELS, model_name
from rbsdem.web.pages import gallery

#: Name of the store in the folder of `--out`, as long as the batch is not finished.
UNFINISHED = "unfinished"

_SECTIONS = click.Choice(["rectangular", "circular", "all"])
_out = click.option("--out", type=FOLDER, metavar="DIR", help="write files into this folder")


# ---- measured tests -----------------------------------------------------------------------------


@click.command("peer", cls=Command)
@click.argument("folder", type=FILE, metavar="DIR")
@click.option("--model", default=DEFAULT, help=f"{', '.join(MODELS)}; default {DEFAULT}")
@click.option("--section", type=_SECTIONS, default="all", help="circular: octagons and spirals too")
@click.option("--failure", cls=Values, metavar="MODE ...", help="Flexure, Flexure-Shear, Shear")
@click.option("--only", cls=Values, metavar="NAME ...", help="names, files, numbers; * is any text")
@click.option("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="processes")
@click.option("--by", default="kind", help="groups: kind, failure_mode, section, series")
@click.option("--check", is_flag=True, help="report doubtful tests; no column is predicted")
@click.option("--mended", is_flag=True, help="correct or omit the tests that are surely doubtful")
@_out
@click.option("--loops", is_flag=True, help="with --out, write the loops of every test as csv")
@click.option("--bands", is_flag=True, help="80 % bands and the nearest tests; 17 times the work")
@click.option("--limit-states", is_flag=True, help="drifts of limit states in results.csv")
@quiet
def peer(
    folder: Path,
    model: str,
    section: str,
    failure: tuple[str, ...],
    only: tuple[str, ...],
    jobs: int,
    by: str,
    check: bool,
    mended: bool,
    out: Path | None,
    loops: bool,
    bands: bool,
    limit_states: bool,
    quiet: bool,
) -> int:
    r"""Predict every test of a folder from its properties and compare with the measurement.

    DIR holds specimens.csv and the histories of the PEER Structural Performance Database.

    \b
    Files (--out): results.csv (one row per test), summary.csv (medians and quartiles of groups),
    gallery.html (all loops, to sort and filter), loops.png; with --bands also bands.csv
    (intervals, nearest tests) and bands.png, with --loops bands/ (the band along the path of each
    test); with --check only check.csv (indicators and doubts).
    An interrupted batch leaves its finished tests in the folder unfinished; the same command with
    the same --out resumes there.
    Exit codes: 0 every test was analysed to its end, 1 some were not or have no history, 2 the
    input is wrong, 130 interrupted by the keyboard (finished tests are reported).
    """
    table = read_specimens(folder)
    tests = chosen(table, section, failure, only)
    if check:
        return _check(tests, out)
    if mended:
        # Rules by series and twins look at all tests, not at the chosen ones alone.
        tests = _mended(tests, check_tests(table.with_history()))
    if not hasattr(tests[0], by):
        raise InputError(f"--by {by} is no property, as failure_mode, section, series")
    model_name(model)
    if loops and out is None:
        raise InputError("--loops writes files; give their folder with --out DIR")
    if out is not None:
        out.mkdir(parents=True, exist_ok=True)
    store = None if out is None else out / UNFINISHED
    predictions = run_predictions(
        tests,
        model,
        jobs=jobs,
        bands=bands,
        progress=not quiet and sys.stderr.isatty(),
        store=store,
        limit_states=limit_states,
    )
    # The files come first: whoever reads the report may stop reading.
    lines = [] if out is None else written(predictions, out, by, loops)
    if store is not None and not predictions.interrupted:
        how = PredictionOptions(bands=bands, limit_states=limit_states)
        PredictionStore(store, tests, predictions.model, how.given({})).forget()
    _report(predictions, by, quiet)
    left = [] if only else [row.name for row in table if row.path is None]
    left += [row.specimen.name for row in predictions if row.status == "no history"]
    if left:
        names = ", ".join([*left[:3], *(["..."] if left[3:] else [])])
        print(f"{len(left)} of the table have no history in the folder, so no score: {names}")
    for line in lines:
        print(line)
    if predictions.interrupted:
        tell(f"interrupted after {len(predictions)} of {len(tests)} tests")
        return INTERRUPTED
    return 0 if predictions.all_completed else 1


def _check(tests: Specimens, folder: Path | None) -> int:
    """Print which tests are doubtful."""
    checked = check_tests(tests)
    console(168).print(tables.table(checked))
    sure = {doubt.specimen.name for doubt in checked.doubts if doubt.sure}
    hints = {doubt.specimen.name for doubt in checked.doubts} - sure
    print(
        f"\n{len(checked.indicators)} tests with a history: {len(sure)} surely doubtful, hints "
        f"for {len(hints)} more"
    )
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)
        save_frame(checked.by_test(), folder / "check.csv")
        print(f"wrote {folder / 'check.csv'}")
    return 0


def _mended(tests: Specimens, checked: Checked) -> Specimens:
    """Return the chosen tests as they are after mending."""
    mended = {row.name: row for row in checked.mended()}
    kept = Specimens(mended[row.name] for row in tests if row.name in mended)
    if not kept:
        raise InputError("--mended omits all of these tests; --check says why")
    return kept


def chosen(
    table: Specimens, section: str, failure: Sequence[str], only: Sequence[str]
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
        out.print(measured.tests_table(found))
        out.print()
        if any(row.band is not None for row in found):
            out.print(measured.bands_table(found))
            out.print("* outside its interval", style="dim")
            out.print()
    out.print(measured.summary_table(found, by))
    print(f"\nModel {found.model}: {len(found)} tests in {found.seconds:.1f} s")
    if found.resumed:
        print(f"{found.resumed} of them are from an earlier run that was interrupted")


def written(found: Predictions, folder: Path, by: str, loops: bool) -> list[str]:
    """Write the files; return lines that say which."""
    files = [folder / "results.csv", folder / "summary.csv", folder / "gallery.html"]
    found.to_csv(files[0])
    save_frame(found.summary(by).reset_index(), files[1])
    gallery(found, files[2])
    banded = any(row.band is not None for row in found)
    if banded:
        files.append(folder / "bands.csv")
        save_frame(found.bands(), files[-1])
    files.append(contact_sheet(found, folder / "loops.png"))
    if banded:
        files.append(band_sheet(found, folder / "bands.png"))
    if loops:
        found.loops_to_csv(folder / "loops")
        files.append(folder / "loops")
    if loops and banded:
        found.paths_to_csv(folder / "bands")
        files.append(folder / "bands")
    return [f"wrote {file}" for file in files]


# ---- columns of a table -------------------------------------------------------------------------


@click.command("predict", cls=Command)
@click.argument("table", type=FILE, metavar="DIR")
@click.argument("only", nargs=-1, metavar="[NAME]...")
@click.option("--drifts", cls=Values, type=float, metavar="X ...", help="drift ratios of cycles")
@click.option("--cycles", type=int, default=2, metavar="N", help="at each drift; 2")
@click.option("--samples", type=int, default=16, metavar="N", help="of a band; 16")
@click.option("--near", type=FILE, metavar="DIR", help="folder of tests, for the nearest ones")
@_out
def predict(
    table: Path,
    only: tuple[str, ...],
    drifts: tuple[float, ...],
    cycles: int,
    samples: int,
    near: Path | None,
    out: Path | None,
) -> int:
    r"""Predict columns of a table from their properties, with 80 % bands.

    DIR is a specimens.csv as docs/peer.md describes it, or its folder; NAME a name, file or number,
    by default all. A column with a history is driven through it and compared with it; one without
    needs the drift ratios of its cycles, as --drifts 0.01 0.02.

    \b
    Files (--out): numbers.csv (intervals, nearest tests), and for each column the band along its
    path as csv and a figure.
    Exit codes: 0 all were predicted, 1 some were not, 2 the input is wrong, 130 interrupted.
    """
    specimens = read_specimens(table)
    tests = list(chosen(specimens, "all", (), only) if only else specimens)
    if not tests:
        raise InputError(f"{table} has no rows; write one for each column")
    path = protocol(drifts, cycles=cycles) if drifts else None
    others = None if near is None else read_specimens(near).with_history()
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
                )
        except InputError as error:
            if len(tests) == 1:
                raise
            errors.append(str(error))
            continue
        rows.append(row)
    lines = [] if out is None else _write_columns(Predictions(rows), out)
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


def _write_columns(rows: Predictions, folder: Path) -> list[str]:
    """Write the files; return lines that say which."""
    folder.mkdir(parents=True, exist_ok=True)
    files = [folder / "numbers.csv"]
    save_frame(rows.bands(), files[0])
    for row, name in zip(rows, loop_names([row.specimen.name for row in rows]), strict=True):
        target = folder / name.name
        if row.band is not None:
            row.band.to_csv(target)
            files.append(target)
        files.append(target.with_suffix(".png"))
        write_figure(draw_prediction(row), files[-1], dpi=160)
    return [f"wrote {file}" for file in files]
