"""The commands for the column of a case: `trade`, `ensemble`, `ida`, `explore` and `report`."""

from __future__ import annotations

import json
import math
import os
import subprocess
import sys
import threading
import webbrowser
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import click
import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import claim_folder, data_frame, refuse_other_page, save_frame, write_figure
from rbsdem._package import recorded
from rbsdem._tables import read_table
from rbsdem._types import DataFrame
from rbsdem.cli import CASE, FILE, FOLDER, INTERRUPTED, plain_warnings, quiet, tell
from rbsdem.errors import InputError, RbsdemError, RepairWarning
from rbsdem.many.ensemble import ensemble as run_ensemble
from rbsdem.many.fragility import Fragility, Hazard
from rbsdem.many.ida import IDA
from rbsdem.many.ida import ida as run_ida
from rbsdem.many.judgement import Judgement, asked, checked, judge
from rbsdem.many.runs import NAMES, OF_PAIRS
from rbsdem.many.store import store_status
from rbsdem.methods.ladder import OF_SETTING
from rbsdem.methods.study import Physics, compare_methods
from rbsdem.motions.motion import GroundMotion, Record, synthetic
from rbsdem.motions.read import read_motion, read_motions
from rbsdem.output import many as ensemble_figures
from rbsdem.output import methods as methods_output
from rbsdem.output import tables
from rbsdem.run.case import Case, read_case
from rbsdem.run.solver import COLLAPSE_DRIFT, Solver
from rbsdem.section.criteria import WATCHED
from rbsdem.section.frame import Frame
from rbsdem.web.answers import Answers, tests_of
from rbsdem.web.report import write_record, write_report
from rbsdem.web.server import ExploreServer
from rbsdem.web.state import DEFAULT, opened

_units = click.option("--units", help="unit of records that name none: g, m/s2, cm/s2")
_pairs = click.option(
    "--pairs", is_flag=True, help="records two by two, along x and y of a building"
)
_shard = click.option("--shard", metavar="I/N", help="do part I of N, from 1 to N")
_jobs = click.option("--jobs", type=int, metavar="N", help="threads; default one per processor")
_tests = click.option("--tests", type=FOLDER, metavar="DIR", help="show the nearest measured tests")


#: Exit code of a run that ended because the structure collapsed.
_COLLAPSED = 3


# ---- drawn frames -------------------------------------------------------------------------------


@click.command("draw")
@CASE
def draw(case: Path) -> int:
    """Write a case whose frame is drawn by sections with the springs of its members.

    The executable solves springs: rbsdem draw CASE.nml | rbsdem run - --output rows.csv

    Exit codes: 0 done, 2 the input is wrong.
    """
    print(read_case(case).to_namelist(springs=True), end="")
    return 0


@plain_warnings("rbsdem")
def on_springs(program: str, command: str, path: str, *options: str) -> int:
    """Run the executable on a case whose springs, or whose loads, Python makes.

    After `run` what the case asks for is done: target displacement, acceptance, the report.

    Parameters
    ----------
    program : str
        The executable.
    command, path, *options : str
        The command line: `run`, `check` or `modes`, the path of the case, the rest.

    Returns
    -------
    int
        Exit code.
    """
    words, page = _without_report(options, path)
    try:
        case = read_case(path)
        _refuse_history(case, path, words)
        if page:
            refuse_other_page(Path(page))
        if command != "modes":
            checked(case)
    except RbsdemError as error:
        lines = str(error).splitlines()
        if "--json" in words:
            errors = [{"line": None, "message": line} for line in lines]
            print(json.dumps({"case": path, "errors": errors, "notes": []}))
        else:
            sys.stderr.writelines(f"rbsdem: {line}\n" for line in lines)
        return 2 if isinstance(error, InputError) else 1
    if "initial" in case.settings:
        start = os.path.abspath(case.settings["initial"])
        case = replace(case, settings=case.settings | {"initial": start})
    springs = case.to_namelist(springs=True)
    sys.stdout.flush()
    code = subprocess.run(
        [program, command, "-", *words, "--as", path], input=springs, check=False, encoding="utf-8"
    ).returncode
    if command != "run" or code not in (0, _COLLAPSED) or not (page or asked(case)):
        return code
    try:
        judged = judge(case) if asked(case) else None
        if judged is not None and "--quiet" not in words and "-q" not in words:
            print(judged)
        if page:
            _tell_files(_report_of(case, judged, Path(page), {"title": case.title}))
    except RbsdemError as error:
        sys.stderr.writelines(f"rbsdem: {line}\n" for line in str(error).splitlines())
        return 2 if isinstance(error, InputError) else 1
    return code


def _report_of(
    case: Case, judged: Judgement | None, page: Path, head: Mapping[str, str | None], *units: Any
) -> list[Path]:
    """Write the reports of a case of a frame, of each acceptance or of its response."""
    if judged is None or not judged.assessments:
        record = case.run() if judged is None else judged.result
        return write_record(record, page, head, *units)
    files: list[Path] = []
    more: dict[str, Any] = {"target": judged.target, "check": judged.check}
    for number, assessment in enumerate(judged.assessments, 1):
        # By the name of the case, NAME.html, NAME_2.html
        file = page.with_stem(f"{page.stem}_{number}") if files else page
        files += write_record(assessment, file, head, *units, **more)
    return files


def _refuse_history(case: Case, path: str, words: Sequence[str]) -> None:
    """Refuse to write over a history: the executable gets its values, and not its file's name."""
    folder = Path(path).parent
    written = [folder / name for name in case.files.values()]
    for word, following in pairwise([*words, ""]):
        option, equal, value = word.partition("=")
        if option in ("-o", "--output"):
            written.append(Path(value if equal else following))
    for name, given in _core.groups(_core.read_groups(path)):
        for file in written if name == "loading" and "file" in given else ():
            if file.is_file() and file.samefile(folder / given["file"]):
                raise InputError(
                    f"output: {file} is an input of the case and would be written over; choose "
                    "another file with --output"
                )


def _without_report(words: Sequence[str], path: str) -> tuple[list[str], str]:
    """Return the arguments without --report, and its file: by default that of the case."""
    kept, page = [], ""
    for word in words:
        option, _, file = word.partition("=")
        if option == "--report":
            page = file or str(Path(path).with_suffix(".html"))
        else:
            kept.append(word)
    return kept, page


# ---- methods ------------------------------------------------------------------------------------


@click.command("trade")
@CASE
@click.option("--tolerance", type=float, metavar="X", help="name the cheapest setting within it")
@click.option("--budget", type=float, default=60.0, metavar="S", help="wall time; default 60 s")
@click.option("--methods", metavar="A,B", help="methods in time to try; default all of them")
@click.option("--output", type=FOLDER, metavar="DIR", help="folder of files; default CASE-trade")
@quiet
def trade(
    case: Path,
    tolerance: float | None,
    budget: float,
    methods: str | None,
    output: Path | None,
    quiet: bool,
) -> int:
    r"""Measure what accuracy costs in a case, and which parts of the model it needs.

    The case is run with different methods, steps and tolerances and compared with a reference on
    which two methods agree.

    \b
    Files: trade.csv (settings), physics.csv (parts of the model), trade.png (error, wall time).
    Exit codes: 0 success, 1 the analysis failed, 2 the input is wrong.
    """
    model = read_case(case)
    folder = output or case.with_name(f"{case.stem}-trade")
    names = ["trade.csv", "physics.csv", "trade.png"]
    claim_folder(folder, names, look=True)
    loads: dict[str, Any] = dict(model.loads)
    study = compare_methods(
        model.column,
        time=model.time if model.dynamic else None,
        **loads,
        collapse_drift=model.settings.get("collapse_drift"),
        methods=methods.split(",") if methods else None,
        setting=cast(Solver, {n: v for n, v in model.solver.items() if n in OF_SETTING}),
        tolerance=tolerance,
        budget=budget,
        progress=not quiet and sys.stderr.isatty(),
    )
    *written, picture = claim_folder(folder, names)
    study.to_csv(written[0])
    physics = study.physics or Physics((), "", math.nan, math.nan)
    physics.to_csv(written[1])
    figure = methods_output.save(study, picture, model.title)
    if figure is not None:
        written.append(figure)
    if not quiet:
        methods_output.report(study, model.title or case.stem)
        if figure is None:
            print("no figure: there is no reference")
        _tell_files(written)
    return 0


def _tell_files(paths: Sequence[Path]) -> None:
    """Print which files were written."""
    for path in paths:
        print(f"wrote {path}")


# ---- records ------------------------------------------------------------------------------------


def _records(words: Sequence[str], units: str | None, pairs: bool) -> list[Record]:
    """Return the records of folders and files, or synthetic ones; report all that is wrong."""
    records: list[GroundMotion] = []
    faults: list[str] = []
    with recorded(RepairWarning) as caught:
        for word in words:
            with _arguments.collected(faults):
                records += _records_of(word, units)
    for warning in caught:
        tell(str(warning.message))
    if faults:
        raise InputError("\n".join(faults))
    if not pairs:
        return list(records)
    if len(records) % 2:
        raise InputError(
            f"--pairs: {len(records)} records are no pairs; give two of each earthquake one after "
            "the other, along x and along y"
        )
    return list(zip(records[::2], records[1::2], strict=True))


def _records_of(word: str, units: str | None) -> Sequence[GroundMotion]:
    """Return the records of a folder, a file, or of synthetic:N."""
    name, _, number = word.partition(":")
    if name == "synthetic" and not Path(word).exists():
        return synthetic(int(number) if number.isdigit() else 20)
    return read_motions(word, units) if Path(word).is_dir() else [read_motion(word, units)]


def _numbers(text: str, option: str, example: str) -> list[float]:
    """Return the numbers of an option, which commas separate; errors give an example."""
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise InputError(f"{option} {text}: give {example}") from None


def _tell_status(context: click.Context, option: click.Parameter, folder: Path | None) -> None:
    """Print what a store has, and end."""
    del option
    if folder is None:
        return
    inner = folder / "store"  # of --out; else the folder is a store itself
    for line in store_status(inner if inner.is_dir() else folder):
        click.echo(line)
    context.exit()


_status = click.option(
    "--status", type=FOLDER, metavar="DIR", is_eager=True, expose_value=False,
    callback=_tell_status, help="tell what is done in a folder of --out or store=, and end",
)  # fmt: skip


# ---- ensembles ----------------------------------------------------------------------------------


@click.command("ensemble")
@CASE
@click.argument("records", nargs=-1, type=FILE, metavar="[RECORD]...")
@click.option("--scales", default="1", metavar="A,B,...", help="factors of the records; default 1")
@_units
@_pairs
@click.option("--out", type=FOLDER, required=True, metavar="DIR", help="folder for the files")
@_jobs
@_shard
@_status
@quiet
def ensemble(
    case: Path,
    records: tuple[Path, ...],
    scales: str,
    units: str | None,
    pairs: bool,
    out: Path,
    jobs: int | None,
    shard: str | None,
    quiet: bool,
) -> int:
    r"""Run the column of a case under ground motions at several scales.

    RECORD is a file or a folder; without records the ground acceleration of the case is used.
    Method, step, collapse drift and initial state are those of the case.

    \b
    Files (--out): store/ (finished runs, a database of SQLite for each part),
    runs.csv (one row per run, written when all parts are finished).
    A second start computes only what the store does not hold: after an interruption, or with more
    records or scales. In a job array, give every job the same command with --shard I/N.
    Exit codes: 0 every run was completed or collapsed, 1 some failed, 2 the input is wrong,
    130 interrupted by the keyboard (finished runs are kept).
    """
    model = read_case(case)
    if not model.dynamic:
        raise InputError(
            f"{case}: method = '{model.method}' takes no records; give a method in time, as 'auto'"
        )
    (rows,) = claim_folder(out, ["runs.csv"])
    runs = run_ensemble(
        {model.title or case.stem: model.column},
        _records(list(map(str, records)), units, pairs) if records else [_own_motion(case, model)],
        scales=_numbers(scales, "--scales", "numbers separated by commas, as 0.5,1,2"),
        collapse_drift=model.settings.get("collapse_drift"),
        initial=model.settings.get("initial"),
        **model.solver,
        jobs=jobs,
        store=out / "store",
        shard=None if shard is None else _part(shard),
        progress=not quiet,
        allow_partial=True,
    )
    if "" not in runs.status:
        runs.to_csv(rows)
    if not quiet:
        counts = ", ".join(f"{number} {status}" for status, number in runs.counts.items())
        resumed = f", {runs.resumed} of them from the store" if runs.resumed else ""
        print(f"{len(runs)} runs{resumed}: {counts}; {runs.seconds:.3g} s")
        if "" in runs.status:
            print(f"runs.csv is written when all parts are in {out / 'store'}")
        else:
            _tell_files([rows])
    if runs.interrupted:
        return INTERRUPTED
    return 1 if runs.errors else 0


def _own_motion(path: Path, case: Case) -> Any:
    """Return the ground motion of a case."""
    if case.ground_acceleration is None:
        raise InputError(
            f"{path} has no ground acceleration; give records: rbsdem ensemble {path} RECORD ..."
        )
    others = [name for name in case.loads if name != "ground_acceleration"]
    if others:
        raise InputError(
            f"{path}: an ensemble takes the ground motion along x of a case, no {others[0]}; give "
            "records (--pairs: along x and y), or run the case alone: rbsdem run"
        )
    return case.time, case.ground_acceleration


def _part(text: str) -> tuple[int, int]:
    """Return part and number of parts of --shard I/N."""
    part, _, parts = text.partition("/")
    try:
        return int(part), int(parts)
    except ValueError:
        raise InputError(f"--shard {text}: give part and number of parts, as 3/20") from None


# ---- incremental dynamic analysis ---------------------------------------------------------------


@click.command("ida")
@CASE
@click.argument("records", nargs=-1, required=True, type=FILE, metavar="RECORDS...")
@_units
@_pairs
@click.option(
    "--intensity", default="sa_t1", help=f"{', '.join((*NAMES, *OF_PAIRS))}; default sa_t1"
)
@click.option("--levels", default="search", metavar="A,B", help="m/s2; default: found by search")
@click.option(
    "--limit", multiple=True, metavar="NAME[=DRIFT]", help="limit state: repair=0.01, spalling"
)
@click.option("--beta", multiple=True, metavar="NAME=BETA", help="stated dispersion: yield=0.4")
@click.option(
    "--collapse-drift", type=float, metavar="X", help=f"default: the case, else {COLLAPSE_DRIFT}"
)
@click.option("--method", help="method in time; default that of the case")
@click.option("--dt", type=float, metavar="S", help="step; default that of the case")
@click.option("--hazard", type=FILE, metavar="FILE", help="csv of intensity, annual frequency")
@_jobs
@click.option("--out", type=FOLDER, metavar="DIR", help="folder for the files and the runs")
@_shard
@quiet
def ida(
    case: Path,
    records: tuple[Path, ...],
    units: str | None,
    pairs: bool,
    intensity: Any,
    levels: str,
    limit: tuple[str, ...],
    beta: tuple[str, ...],
    hazard: Path | None,
    jobs: int | None,
    out: Path | None,
    shard: str | None,
    quiet: bool,
    **method: Any,
) -> int:
    r"""Run an incremental dynamic analysis: each record at growing intensity until collapse.

    Fragility curves of the limit states are fitted to the runs. RECORDS is a folder of records
    (AT2, csv), files of records, or synthetic[:N]. The loading of the case is not used. With
    --pairs each two of them, a folder's by name, shake a building along x and y at once; their
    intensity is the geometric mean, or --intensity larger. --limit and --beta may be repeated.

    \b
    Files (--out): store/ (finished runs, from which a second start goes on), ida.csv (one row per
    run), fractiles.csv, fragility.csv, ida.png, fragility.png.
    In a job array, give every job the same command with --shard I/N; the command without it joins
    the parts.
    Exit codes: 0 success, 1 the analysis failed, 2 the input is wrong, 130 interrupted (finished
    runs are kept).
    """
    # Missing and wrong arguments are reported before the work.
    model = read_case(case)
    limits = _limits(limit)
    spreads = _spreads(beta, limits)
    site = None if hazard is None else _read_hazard(hazard)
    example = "intensities in m/s2 separated by commas, or search"
    motions = _records(list(map(str, records)), units, pairs)
    part = None if shard is None else _part(shard)
    store, files = None, []
    if out is not None:
        files = claim_folder(out, _OF_IDA)
        store = out / "store"
    watched = [name for name in limits if name in WATCHED]
    analysis = run_ida(
        model.column,
        motions,
        refine=["first_yield", *watched],
        intensity=intensity,
        levels=levels if levels == "search" else _numbers(levels, "--levels", example),
        jobs=jobs,
        store=store,
        shard=part,
        progress=not quiet and sys.stderr.isatty(),
        **_ida_settings(model, **method),
    )
    if part is not None:
        if not quiet:
            print(
                f"part {shard}: {len(analysis.runs)} runs are in {store}; {analysis.seconds:.3g} s"
            )
        return 0
    curves, notes = _curves(analysis, limits, spreads)
    frame, more = _fragilities(curves, site)
    if files:
        _write(analysis, curves, frame, files)
    if not quiet:
        terminal = tables.console(120)
        label, size = analysis.runs.measure.label, analysis.lower.size
        told = f"{label}: {size} records, {len(analysis.runs)} runs, {analysis.seconds:.3g} s"
        terminal.print(tables.plain(told))
        terminal.print(tables.table(frame))
        for note in [*notes, *more]:
            terminal.print(tables.plain(note))
        _tell_files(files)
    return 0


def _ida_settings(
    case: Case, method: str | None, dt: float | None, collapse_drift: float | None
) -> dict[str, Any]:
    """Return method, step and collapse drift of the command line, else of the case."""
    # Settings of the method of the case have no meaning for another one.
    settings: dict[str, Any] = {"method": method} if method else dict(case.solver)
    if dt is not None:
        settings["dt"] = dt
    if "initial" in case.settings:
        settings["initial"] = case.settings["initial"]
    drift = case.settings.get("collapse_drift", COLLAPSE_DRIFT)
    return settings | {"collapse_drift": drift if collapse_drift is None else collapse_drift}


def _limits(texts: Sequence[str]) -> dict[str, Any]:
    """Return yield, the limit states of the command line, and collapse."""
    limits: dict[str, Any] = {"yield": ("first_yield", None)}
    for text in texts:
        name, drift = _named_number(text)
        if text in WATCHED:
            limits[text] = (text, None)
        elif name and 0 < drift < 1:
            limits[name] = drift
        else:
            raise InputError(
                f"--limit {text}: give a name and a drift, as repair=0.01, or one of "
                f"{', '.join(WATCHED)}"
            )
    return limits | {"collapse": ("collapse", None)}


def _spreads(texts: Sequence[str], limits: Mapping[str, Any]) -> dict[str, float]:
    """Return the dispersions that the command line states."""
    spreads = {}
    for text in texts:
        name, beta = _named_number(text)
        if name not in limits or not 0 < beta < math.inf:
            raise InputError(
                f"--beta {text}: give a limit state ({', '.join(limits)}) and its dispersion, as "
                "yield=0.4"
            )
        spreads[name] = beta
    return spreads


def _named_number(text: str) -> tuple[str, float]:
    """Return the parts of NAME=NUMBER; NaN where there is no number."""
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        return name, math.nan


def _read_hazard(path: Path) -> Hazard:
    """Return the hazard of a csv with two columns, with or without a heading."""
    table = read_table(path)
    if table.columns != 2:
        raise InputError(
            f"{path}: has {table.columns} columns; a hazard has two, the intensity and its annual "
            "frequency"
        )
    return Hazard(*table.values.T)


def _curves(
    analysis: IDA, limits: Mapping[str, Any], spreads: Mapping[str, float]
) -> tuple[dict[str, Fragility], list[str]]:
    """Return the curves, and why some limit states have none."""
    curves: dict[str, Fragility] = {}
    notes: list[str] = []
    for name, limit in limits.items():
        try:
            beta = {name: spreads[name]} if name in spreads else None
            curves |= analysis.fragilities({name: limit}, beta=beta)
        except InputError as error:
            notes.append(str(error))
    return curves, notes


def _fragilities(
    curves: Mapping[str, Fragility], hazard: Hazard | None
) -> tuple[DataFrame, list[str]]:
    """Return the curves as a frame, and why some have no band."""
    rows, notes = [], []
    for name, curve in curves.items():
        errors = np.sqrt(curve.covariance.diagonal())
        row = {"limit_state": name, "theta_m/s2": curve.theta, "beta": curve.beta}
        row |= {"se_theta_m/s2": errors[0], "se_beta": math.nan if curve.stated else errors[1]}
        row["records"] = curve.data.size
        try:
            low, high = curve.band([curve.theta])
            row |= {"band_low": float(low[0]), "band_high": float(high[0])}
        except InputError as error:
            notes.append(str(error))
        if hazard is not None:
            row["per_year"] = curve.mean_annual_frequency(hazard)
        rows.append(row)
    return data_frame(rows), notes


#: Files of the command.
_OF_IDA = ["ida.csv", "fractiles.csv", "fragility.csv", "ida.png", "fragility.png"]


def _write(
    analysis: IDA, curves: Mapping[str, Fragility], frame: DataFrame, files: Sequence[Path]
) -> None:
    """Write runs, fractiles and curves as csv, and two figures; `files` are those of `_OF_IDA`."""
    runs, shares, fitted, *figures = files
    analysis.runs.to_csv(runs)
    level, fractiles = analysis.fractiles()
    names = [f"{analysis.runs.drift_measure}_{share}" for share in (16, 50, 84)]
    values = {"intensity_m/s2": level, **dict(zip(names, fractiles, strict=True))}
    save_frame(data_frame(values), shares)
    save_frame(frame, fitted)
    drawn = ensemble_figures.ida(analysis), ensemble_figures.fragilities(dict(curves))
    for file, ax in zip(figures, drawn, strict=True):
        write_figure(ax, file, dpi=150)


# ---- the page -----------------------------------------------------------------------------------


@click.command("explore")
@click.argument("case", required=False, type=FILE, metavar="[CASE.nml]")
@click.option("--no-browser", is_flag=True, help="print the address, open no browser")
@click.option("--port", type=int, default=0, metavar="N", help="on 127.0.0.1; default a free one")
@_tests
def explore(case: Path | None, no_browser: bool, port: int, tests: Path | None) -> int:
    r"""Open a page in the browser on which one draws a column and sees its loops.

    It shows section, limit states, bands, moment-curvature, interaction, code values and similar
    measured tests. The page is served on this machine only, under an address with a token, and
    uses no network. Ctrl-C ends it.

    \b
    Exit codes: 0 ended, 2 the input is wrong.
    """
    server = ExploreServer(port, DEFAULT, None if tests is None else tests_of(tests))
    if case is not None:
        server.start = start_of(case, server.answers)
    print(server.address, flush=True)
    if not no_browser:
        # Some browsers come back only when they are closed.
        threading.Thread(target=webbrowser.open, args=(server.address,), daemon=True).start()
        tell("Ctrl-C ends it")
    try:
        server.serve_forever(poll_interval=0.2)
    except KeyboardInterrupt:
        pass
    finally:
        server.server_close()
    return 0


@click.command("report")
@CASE
@click.option("-o", "--output", type=FILE, metavar="FILE", help="default CASE.html")
@click.option("--title", help="title; default that of the case")
@click.option("--author", default="", help="for the head of the report")
@click.option("--project", default="", help="for the head of the report")
@click.option("--paper", default="mm,kN", metavar="A,B", help="units of a frame's: in,kip")
@_tests
def report(
    case: Path, output: Path | None, title: str | None, paper: str, tests: Path | None, **head: str
) -> int:
    r"""Write a case as one html file that opens offline and prints on A4.

    It holds loops and limit states and, for a drawn column, section, diagrams, band and code
    values; for a frame its drawing with hinges, limit states and forces, or the target and the
    acceptance that the case asks for, with the tables as csv in a folder beside it, CASE_files.

    \b
    Exit codes: 0 written, 1 the file cannot be written, 2 the input is wrong.
    """
    model, file = read_case(case), output or case.with_suffix(".html")
    refuse_other_page(file)
    if isinstance(model.column, Frame):
        units: Any = tuple(paper.split(","))
        head["title"] = title or model.title
        judged = judge(model) if asked(model) else None
        _tell_files(_report_of(model, judged, file, head, units))
        return 0
    answers = Answers(None if tests is None else tests_of(tests))
    start = start_of(case, answers)
    title = title or start["title"] or case.stem
    about: Any = head
    _tell_files([write_report(file, start, title, answers=answers, **about)])
    return 0


def start_of(path: Path, server: Answers) -> Mapping[str, Any]:
    """Return the state of a case file; its histories are put into it.

    Parameters
    ----------
    path : Path
        The file.
    server : Answers
        Keeps the record that it has.

    Raises
    ------
    InputError
        As `rbsdem.read_case`.
    """
    case = read_case(path)
    answer = opened(path.read_text(encoding="utf-8", errors="replace"), server.keep_record)
    if "faults" in answer:  # it names files
        answer = opened(case.to_namelist(), server.keep_record)
    if "faults" in answer:
        raise InputError("\n".join(fault["text"] for fault in answer["faults"]))
    return {**answer["state"], "title": case.title}
