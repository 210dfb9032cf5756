"""The command `rbsdem ida`."""

from __future__ import annotations

import argparse
import csv
import math
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._files import write_csv, write_figure
from rbsdem._optional import console, need_pyarrow, need_rich, need_scipy, plain
from rbsdem.batch.intensity import NAMES
from rbsdem.cli.parser import CommandParser, run_command
from rbsdem.errors import InputError, RepairWarning
from rbsdem.many.fragility import Fragility
from rbsdem.many.hazard import Hazard
from rbsdem.many.ida import IDA, ida
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.read import read_motion, read_motions
from rbsdem.motions.synthetic import synthetic
from rbsdem.output.ensemble_figure import draw_fragilities
from rbsdem.results.case import Case, read_case

DESCRIPTION = """\
Incremental dynamic analysis: every record at growing intensity until the column of the case
collapses; fragility curves of its limit states. The loading of the case is not used.
"""

EPILOG = """\
RECORDS is a folder of records (AT2, csv), files of records, or synthetic[:N].
Files (--out): ida.csv (a row for each run), fractiles.csv, fragility.csv, ida.png and fragility.png
(need matplotlib), with --parquet ida.parquet.
Exit codes: 0 all went well, 1 the analysis failed, 2 the input is wrong, 130 interrupted.
"""

_DRIFT = 0.1
_WORD = "synthetic"
#: Settings of a case that go with its method.
_OF_METHOD = ("dt", "events", "tolerance", "rho_infinity", "allow_unstable", "max_seconds")


def parser() -> CommandParser:
    """Return the parser of the arguments."""
    parser = CommandParser("ida", DESCRIPTION, EPILOG)
    parser.add_argument("case", type=Path, metavar="CASE.nml", help="case with the column")
    parser.add_argument("records", nargs="+", metavar="RECORDS", help="folder, files, synthetic")
    parser.add_argument("--units", help="unit of records that name none: g, m/s2, cm/s2")
    parser.add_argument(
        "--intensity", default="sa_t1", help=f"{', '.join(NAMES)}; default %(default)s"
    )
    parser.add_argument(
        "--levels", default="hunt", metavar="A,B", help="intensities in m/s2; default a hunt"
    )
    parser.add_argument(
        "--limit",
        action="append",
        default=[],
        metavar="NAME=DRIFT",
        help="a limit state by its peak drift, as repair=0.01; may be repeated",
    )
    parser.add_argument(
        "--beta",
        action="append",
        default=[],
        metavar="NAME=BETA",
        help="a spread that the runs do not determine, as yield=0.4; may be repeated",
    )
    parser.add_argument(
        "--collapse-drift",
        type=float,
        metavar="X",
        help=f"drift that is a collapse; default that of the case, else {_DRIFT:g}",
    )
    parser.add_argument("--method", help="method in time; default that of the case")
    parser.add_argument("--dt", type=float, metavar="S", help="step; default that of the case")
    parser.add_argument(
        "--hazard", type=Path, metavar="FILE", help="csv of intensity, annual frequency"
    )
    parser.add_argument("--jobs", type=int, metavar="N", help="threads; default all processors")
    parser.add_argument("--out", type=Path, metavar="DIR", help="folder of the files")
    parser.add_argument("--parquet", action="store_true", help="write the runs as Parquet too")
    parser.add_argument("--quiet", action="store_true", help="print nothing but errors")
    return parser


def main(arguments: Sequence[str]) -> int:
    """Run the command; return its exit code."""
    given = parser().parse_args(arguments)
    return run_command("rbsdem: ida", lambda: _run(given))


def _run(given: argparse.Namespace) -> int:
    # What may be missing or wrong is reported before the work.
    need_scipy("special")
    if not given.quiet:
        need_rich()
    if given.parquet:
        need_pyarrow()
        if given.out is None:
            raise InputError("--parquet writes a file; say where with --out DIR")
    case = read_case(given.case)
    limits = _limits(given.limit)
    spreads = _spreads(given.beta, limits)
    hazard = None if given.hazard is None else _read_hazard(given.hazard)
    motions = _records(given.records, given.units)
    if given.out is not None:
        given.out.mkdir(parents=True, exist_ok=True)
    found = ida(
        case.column,
        motions,
        intensity=given.intensity,
        levels=_levels(given.levels),
        jobs=given.jobs,
        progress=not given.quiet and sys.stderr.isatty(),
        **_settings(case, given),
    )
    curves, notes = _curves(found, limits, spreads)
    written = [] if given.out is None else _write(found, curves, given.out, given.parquet)
    if not given.quiet:
        _report(found, curves, notes, hazard)
        for path in written:
            print(f"wrote {path}")
    return 0


def _settings(case: Case, given: argparse.Namespace) -> dict[str, Any]:
    """Return method, step and collapse of the command line, else of the case."""
    own = "auto" if case.method == "static" else case.method
    settings: dict[str, Any] = {"method": given.method or own}
    # What belongs to the method of the case has no meaning for another one.
    if given.method is None:
        settings |= {name: case.settings[name] for name in _OF_METHOD if name in case.settings}
    if given.dt is not None:
        settings["dt"] = given.dt
    if "initial" in case.settings:
        settings["initial"] = case.settings["initial"]
    drift = given.collapse_drift
    settings["collapse_drift"] = (
        case.settings.get("collapse_drift", _DRIFT) if drift is None else drift
    )
    return settings


def _records(words: Sequence[str], units: str | None) -> list[GroundMotion]:
    """Return the records of folders and files, or synthetic ones."""
    found: list[GroundMotion] = []
    faults = []
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RepairWarning)
        for word in words:
            try:
                found += _of_word(word, units)
            except InputError as error:
                faults.append(str(error))
    for warning in caught:
        sys.stderr.write(f"rbsdem: ida: {warning.message}\n")
    if faults:
        raise InputError("\n".join(faults))
    return found


def _of_word(word: str, units: str | None) -> Sequence[GroundMotion]:
    name, _, number = word.partition(":")
    if name == _WORD and not Path(word).exists():
        return synthetic(int(number) if number.isdigit() else 20)
    if Path(word).is_dir():
        return read_motions(word, units)
    return [read_motion(word, units)]


def _levels(text: str) -> Any:
    if text == "hunt":
        return text
    try:
        return [float(word) for word in text.split(",")]
    except ValueError:
        raise InputError(
            f"--levels {text}: give intensities in m/s2 with commas between, or hunt"
        ) from None


def _limits(texts: Sequence[str]) -> dict[str, Any]:
    """Return yield, the limit states of the command line, and collapse."""
    found: dict[str, Any] = {"yield": ("first_yield", None)}
    for text in texts:
        name, drift = _named_number(text)
        if not (name and 0 < drift < 1):
            raise InputError(f"--limit {text}: give a name and a drift, as repair=0.01")
        found[name] = drift
    return found | {"collapse": ("collapse", None)}


def _spreads(texts: Sequence[str], limits: dict[str, Any]) -> dict[str, float]:
    """Return the spreads that the command line states."""
    found = dict(map(_named_number, texts))
    for text, (name, beta) in zip(texts, map(_named_number, texts), strict=True):
        if name not in limits or not 0 < beta < math.inf:
            raise InputError(
                f"--beta {text}: give a limit state ({', '.join(limits)}) and its spread, as "
                "yield=0.4"
            )
    return found


def _named_number(text: str) -> tuple[str, float]:
    """Return the parts of NAME=NUMBER; NaN where there is no number."""
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError:
        return name, math.nan


def _read_hazard(path: Path) -> Hazard:
    """Return the hazard of a csv with two columns, perhaps with names."""
    try:
        text = path.read_text("utf-8-sig")
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror}); check the path") from None
    rows: list[tuple[float, float]] = []
    for number, row in enumerate(csv.reader(text.splitlines()), 1):
        if not row or row[0].startswith("#"):
            continue
        try:
            intensity, frequency = map(float, row)
        except ValueError:
            if rows or number > 10:
                raise InputError(
                    f"{path} line {number}: {','.join(row)[:40]!r} is not an intensity and an "
                    "annual frequency"
                ) from None
            continue
        rows.append((intensity, frequency))
    if not rows:
        raise InputError(f"{path}: has no rows of an intensity and an annual frequency")
    return Hazard(*zip(*rows, strict=True))


def _curves(
    found: IDA, limits: dict[str, Any], spreads: dict[str, float]
) -> tuple[dict[str, Fragility], list[str]]:
    """Return the curves, and why some limit states have none."""
    curves: dict[str, Fragility] = {}
    notes: list[str] = []
    for name, limit in limits.items():
        try:
            beta = {name: spreads[name]} if name in spreads else None
            curves |= found.fragilities({name: limit}, beta=beta)
        except InputError as error:
            notes.append(str(error))
    return curves, notes


def _write(found: IDA, curves: dict[str, Fragility], folder: Path, parquet: bool) -> list[Path]:
    written = [folder / "ida.csv", folder / "fractiles.csv", folder / "fragility.csv"]
    found.runs.to_csv(written[0])
    level, fractiles = found.fractiles()
    head = ("intensity_m/s2", "peak_drift_16", "peak_drift_50", "peak_drift_84")
    points = np.vstack([level, fractiles]).T.tolist()
    write_csv(written[1], [head, *points])
    names = ("limit_state", "theta_m/s2", "beta", "se_theta_m/s2", "se_beta", "records")
    rows = [
        (name, one.theta, one.beta, *_errors(one), one.data.size) for name, one in curves.items()
    ]
    write_csv(written[2], [names, *rows])
    if parquet:
        written.append(folder / "ida.parquet")
        found.runs.to_parquet(written[-1])
    try:
        pictures = {"ida.png": found.plot(), "fragility.png": draw_fragilities(curves)}
    except ImportError:
        return written
    for name, ax in pictures.items():
        written.append(folder / name)
        write_figure(ax.figure.savefig, written[-1], dpi=150)
    return written


def _errors(one: Fragility) -> tuple[float, float]:
    variance = one.covariance.diagonal()
    return float(variance[0]) ** 0.5, float(variance[1]) ** 0.5


def _report(
    found: IDA, curves: dict[str, Fragility], notes: list[str], hazard: Hazard | None
) -> None:
    rich = need_rich()
    table = rich.table.Table(box=rich.box.SIMPLE_HEAD, padding=(0, 1), show_edge=False)
    heads = ["Limit state", "θ (m/s²)", "±", "β", "±", "90 % band at θ", "Records"]
    for number, head in enumerate([*heads, "1/a"] if hazard else heads):
        table.add_column(head, justify="right" if number else "left", no_wrap=True)
    for name, one in curves.items():
        errors = _errors(one)
        cells = [f"{one.theta:.3g}", f"{errors[0]:.2g}", f"{one.beta:.2f}"]
        cells += ["stated" if one.stated else f"{errors[1]:.2f}"]
        try:
            low, high = one.band([one.theta])
            cells.append(f"{float(low[0]):.2f} to {float(high[0]):.2f}")
        except InputError as error:
            cells.append("-")
            notes = [*notes, str(error)]
        cells.append(str(one.data.size))
        if hazard:
            cells.append(f"{one.mean_annual_frequency(hazard):.2e}")
        table.add_row(plain(name), *cells)
    out = console(100)
    label, size = found.runs.measure.label, found.lower.size
    text = f"{label}: {size} records, {len(found.runs)} runs, {found.seconds:.3g} s"
    out.print(plain(text))
    out.print(table)
    for note in notes:
        out.print(plain(note))
