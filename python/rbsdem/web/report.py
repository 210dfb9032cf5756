"""A report: one html file that needs no network, with a folder of its tables as csv.

Sheets have a heading, a text, figures and a table. A column has besides, between its sheets, the
page with its results inside.
"""

from __future__ import annotations

import base64
import datetime
import os
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import partial, singledispatch
from pathlib import Path
from typing import Any, get_args

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import atomic_write, claim_folder, data_frame, figure_bytes, save_frame
from rbsdem._types import DataFrame
from rbsdem.checks.acceptance import Assessment, between, rows_at
from rbsdem.checks.code_values import code_values
from rbsdem.checks.infills import CHECK_NOTE, infills
from rbsdem.checks.target import Target
from rbsdem.errors import InputError, RbsdemError
from rbsdem.many.ensemble import Ensemble
from rbsdem.many.ida import IDA
from rbsdem.measured.specimens import Specimens
from rbsdem.model.shape import Section
from rbsdem.output import frames, many, section
from rbsdem.output.loops import history
from rbsdem.output.style import style
from rbsdem.output.tables import cells
from rbsdem.output.units import paper, scales
from rbsdem.output.units import units as paper_units
from rbsdem.run.analysis import modes
from rbsdem.run.case import Case, case_of
from rbsdem.run.column_result import Result
from rbsdem.run.frame_result import FrameResult
from rbsdem.section.curvature import diagram
from rbsdem.section.frame import SCOPE_NOTE, Frame, Structure
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.strength import Code, interaction
from rbsdem.web.answers import Answered, Answers
from rbsdem.web.exports import REPORT, one_file, plain
from rbsdem.web.frames import judged
from rbsdem.web.state import Drawn, is_frame, state_of, title_of

#: Keys that only number things, or say how finely the program divides.
_NUMBERS = ("id", "steel", "strips", "spring", "joint")
#: Units of what the keys of a rule are, for springs that turn and for those that do not.
_OF_RULES = {
    True: {"stiffness": "N m/rad", "deformation": "rad", "force": "N m"},
    False: {"stiffness": "N/m", "deformation": "m", "force": "N"},
}
#: Members and sections that a report shows; more are in its tables.
_MOST_MEMBERS, _MOST_SECTIONS = 40, 6
_LEFT_OUT = (
    "Strengths are those of the drawings. Left out: torsion and motion across the frame, infills, "
    "the ground, splices that were not named, factors of force-controlled actions, of joints all "
    "but the strut (EN 1998) or limits that were given (ASCE 41). Tested frames were 10 to 20 % "
    "off in their peaks in the median, and a factor of 1.5 in the drift at the peak."
)
_STOREYS = (
    "Drift, shear, and the part theta = P d/(V h) of it that the dead load P makes (EN 1998-1, "
    "4.4.2.2)."
)
_FITTED = "theta is the median of the fitted curve, beta its dispersion; sample medians differ."
#: Units of the page, by their names there.
_OF_PAGE = {"mm": ("mm", "kN"), "m": ("m", "kN"), "si": ("m", "N"), "in": ("in", "kip")}
#: Letters of a text that a report takes with it.
_MOST_TEXT = 400_000


@dataclass(frozen=True)
class Sheet:
    """A part of a report.

    Attributes
    ----------
    heading, text : str
        Its heading and what stands below it.
    figures : tuple of callables
        Each draws, and returns axes.
    table : DataFrame or None
        Its table, which is written beside the report, too.
    beside : bool
        Whether the table is in the folder of tables only, as long ones are.
    """

    heading: str
    text: str = ""
    figures: tuple[Callable[[], Any], ...] = ()
    table: DataFrame | None = None
    beside: bool = False

    @property
    def name(self) -> str:
        """The heading, as it stands in names of files."""
        return self.heading.lower().replace(" ", "_").replace("-", "_")


def report_data(
    state: Mapping[str, Any],
    title: str,
    near: Specimens | None = None,
    known: Answered | None = None,
    answers: Answers | None = None,
) -> dict[str, Any]:
    """Return the answers to a state as a report holds them.

    Parameters
    ----------
    state : mapping
        Its cases, of columns.
    title : str
        Title of the report.
    near : Specimens, optional
        Tests to compare with.
    known : Answered, optional
        Column and result of the state, which then need not be computed.
    answers : Answers, optional
        Those that have the tests and the records of the state.

    Raises
    ------
    InputError
        With a line for everything that is wrong with a column or the loading.
    """
    answers, asked = answers or Answers(near), {"state": state}
    if known is not None:
        answers.keep(state["cases"][0], known)

    def ask(answer: Callable[..., dict[str, Any]], **more: Any) -> Any:
        return answer(asked | more, lambda: None)["columns"]

    found = ask(answers.loops)
    faults = [fault["text"] for loop in found for fault in loop["faults"]]
    if faults:
        raise InputError("\n".join(dict.fromkeys(faults)))
    data: dict[str, Any] = {
        "title": title,
        "version": _core.version(),
        "state": {"cases": state["cases"]},
        "loops": [{**loop, "seconds": 0} for loop in found],
        "sections": {code: ask(answers.sections, code=code) for code in ("aci318", "ec2")},
        "bands": ask(answers.bands),
        "scales": ask(answers.scales) if any(loop.get("dynamic") for loop in found) else None,
        "own": ask(answers.own),
        "near": None if answers.near is None else answers.nearest(asked, lambda: None),
        "exports": {},
    }
    for form in ("namelist", "python"):
        text = answers.export(asked | {"form": form}, lambda: None)["text"]
        # A long history would be most of the report; the case that it is made from has it.
        if len(text) < _MOST_TEXT:
            data["exports"][form] = {"text": text, "name": "column"}
    return data


def write_report(
    path: str | os.PathLike[str],
    state: Mapping[str, Any],
    title: str,
    near: Specimens | None = None,
    *,
    author: str = "",
    project: str = "",
    answers: Answers | None = None,
) -> Path:
    """Write a report of a state of the page, whole or not at all.

    Parameters
    ----------
    path : path-like
        File to write.
    state, title, near
        As for `report_data`.
    author, project : str, optional
        For its head.
    answers : Answers, optional
        Those that have the tests and the records of the state.
    """
    data = report_data(state, title, near, answers=answers)
    return _write(path, one_file(title, data, sheets=(_head(title, author, project, None), "")))


def _write(path: str | os.PathLike[str], page: str) -> Path:
    target = Path(path)
    with atomic_write(target) as file:
        file.write(page.encode("utf-8"))
    return target


# ---- reports of records --------------------------------------------------------------------------


def report(
    record: Any,
    path: str | os.PathLike[str],
    *,
    title: str = "",
    author: str = "",
    project: str = "",
    date: str | None = None,
    units: tuple[str, str] = ("mm", "kN"),
    **asked: Any,
) -> Path:
    """Write a report as one html file that opens offline and prints on A4.

    It has the inputs with their units and meanings, drawings and figures, limit states, values of
    codes, and tables. All tables as csv and the case, ``case.nml``, are in a folder beside it,
    NAME_files. A column made from its drawing has its section, moment-curvature and interaction,
    too.

    Parameters
    ----------
    record : Result, FrameResult, Assessment, Section, Ensemble or IDA
        What it is about.
    path : path-like
        File to write. In the folder beside it the files of an earlier report are replaced; a file
        that rbsdem did not write there is refused, not written over.
    title, author, project, date : str, optional
        For its head; the date is that of today.
    units : tuple of str, optional
        Of lengths and forces in figures and tables, as for `rbsdem.plot.units`. Tables as csv, and
        the page inside the report of a column, have their own.
    **asked
        Of a section: the `axial_load` [N], and the `length` of its column for the values of codes
        [m]. Of an IDA: the `limits` of its fragility curves, as for `IDA.fragilities`. Of an
        assessment: the `target` that it was made at, and the `check` of that by records.

    Returns
    -------
    Path
        The file.
    """
    return write_record(
        record, path, title=title, author=author, project=project, date=date, units=units, **asked
    )[0]


def write_record(
    record: Any,
    path: str | os.PathLike[str],
    *,
    title: str | None = "",
    author: str | None = "",
    project: str | None = "",
    date: str | None = None,
    units: tuple[str, str] = ("mm", "kN"),
    **asked: Any,
) -> list[Path]:
    """Write a report as `report` does; return all of its files."""
    for name, text in (("title", title), ("author", author), ("project", project), ("date", date)):
        if not isinstance(text, str | None):
            raise InputError(f"report: {name} = {_arguments.shown(text)} must be a text")
    if not (isinstance(units, (tuple, list)) and len(units) == 2):
        raise InputError(
            f"report: units = {_arguments.shown(units)} must be a length and a force, as "
            '("in", "kip")'
        )
    case = case_of(record) if isinstance(record, Result | FrameResult) else None
    target = Path(path)
    title = title or (case.title if case else "") or target.stem
    data = _column_data(record, case, title) if case and isinstance(record, Result) else None
    with paper_units(*units):
        sheets = list(sheets_of(record, **asked))
        front = _head(title, author or "", project or "", date) + _html(sheets[0])
        # Sheets whose table alone is beside the report have nothing to show.
        behind = "".join(_html(sheet) for sheet in sheets[1:] if sheet.figures or not sheet.beside)
    page = one_file(title, data, REPORT if data else (), (front, behind))
    tables = {f"{sheet.name}.csv": sheet.table for sheet in sheets if sheet.table is not None}
    names = [*tables, *(["case.nml"] if case else [])]
    files = claim_folder(target.with_name(f"{target.stem}_files"), names, anew=True)
    for table, file in zip(tables.values(), files, strict=False):
        save_frame(table, file)
    if case is not None:
        _write(files[-1], case.to_namelist())
    return [_write(target, page), *files]


def report_of_page(answers: Answers, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the report of a state of the page as the text of one file."""
    cases = state_of(asked)
    if not is_frame(cases[0]):
        title = " and ".join(map(title_of, cases))
        try:
            data = report_data({"cases": cases}, f"Column {title}", answers=answers)
        except InputError as error:
            return {"faults": [{"field": "", "text": str(error)}]}
        head = _head(data["title"], "", "", None)
        return {"text": one_file(data["title"], data, sheets=(head, "")), "name": "report"}
    found = answers.solved(cases[0])
    if found.case is None or found.result is None:
        return {"faults": found.faults}
    title = title_of(cases[0]) or "Frame"
    with paper_units(*_OF_PAGE.get(str(asked.get("units")), ("mm", "kN"))):
        made: list[Sheet] = []
        with suppress(RbsdemError):
            outcome = judged(found.case, found.result)
            for assessment in outcome.assessments[:1]:
                made = list(_of_assessment(assessment, outcome.target))
        shown = [one for one in made or sheets_of(found.result) if one.figures or not one.beside]
        html = _head(title, "", "", None) + "".join(map(_html, shown))
    page = one_file(title, None, (), (html, ""))
    return {"text": page, "name": "report"}


def _head(title: str, author: str, project: str, date: str | None) -> str:
    about = {
        "Project": project,
        "Author": author,
        "Date": datetime.date.today().isoformat() if date is None else date,
        "Program": f"rbsdem {_core.version()}, Python {platform.python_version()}, "
        f"numpy {np.__version__}",
    }
    lines = "<br>".join(plain(f"{name}: {text}") for name, text in about.items() if text)
    return f"<section><h1>{plain(title)}</h1><p>{lines}</p></section>"


def _column_data(result: Result, case: Case, title: str) -> dict[str, Any]:
    """Return the answers about a result; one without the openings of its hinge is run again.

    Strains of layers, from which most limit states follow, need them.
    """
    text = case.to_namelist()
    state = {"cases": [text]}
    column, drawn = result.column, None
    if isinstance(column, LayeredColumn) and column.drawing is not None:
        drawn = Drawn(column, column.drawing.section, column.drawing.height, 1.0)
    try:
        result.limit_states()
    except InputError:
        return report_data(state, title)
    return report_data(state, title, known=Answered(result, drawn, case))


def _html(sheet: Sheet) -> str:
    text = f"<p>{plain(sheet.text)}</p>" if sheet.text else ""
    drawn = "".join(map(_image, sheet.figures))
    figures = f'<div class="figures">{drawn}</div>' if drawn else ""
    table = "" if sheet.table is None or sheet.beside else _table(sheet.table)
    kind = plain(sheet.name)
    return (
        f'<section class="sheet-{kind}"><h2>{plain(sheet.heading)}</h2>{text}{figures}{table}'
        "</section>\n"
    )


def _image(draw: Callable[[], Any]) -> str:
    """Return a figure as an image of lines, which prints sharply."""
    import matplotlib.pyplot as plt  # noqa: PLC0415

    drawn = draw()
    with style():
        packed = base64.b64encode(figure_bytes(drawn, "svg")).decode()
    plt.close(np.ravel(drawn)[0].figure)
    return f'<img alt="" src="data:image/svg+xml;base64,{packed}">'


def _table(frame: DataFrame) -> str:
    columns = cells(frame)
    kinds = ["" if numbers else ' class="text"' for _, numbers, _ in columns]

    def line(tag: str, texts: Iterable[str]) -> str:
        cells = (f"{kind}>{plain(text)}</" for kind, text in zip(kinds, texts, strict=True))
        return f"<tr>{''.join(f'<{tag}{cell}{tag[:2]}>' for cell in cells)}</tr>"

    head = line('th scope="col"', (heading for heading, *_ in columns))
    rows = zip(*(texts for *_, texts in columns), strict=True)
    body = "".join(line("td", row) for row in rows)
    return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"


# ---- sheets --------------------------------------------------------------------------------------


def inputs(statement: _core.Statement) -> DataFrame:
    """Return a row for each value of the groups of a case, with its unit and its meaning.

    Parameters
    ----------
    statement : Statement
        The groups.
    """
    known, rows, on_paper = _core.keys(), [], scales()
    for group, given in _core.groups(statement):
        own = [*known["groups"].get(group, []), *known["section"].get(given.get("shape"), [])]
        own += known["rules"].get(given.get("rule"), {}).get("keys", [])
        keys = {key["name"]: key for key in own}
        for name, value in given.items():
            if name in _NUMBERS:
                continue
            key = keys.get(name, {})
            # The sizes of a shape are lengths.
            unit = key.get("unit", "" if key or group != "section" else "m")
            unit = _OF_RULES[group == "flexure"].get(unit, unit)
            scale, unit = (1.0, unit) if unit == "N/m" else on_paper.get(unit, (1.0, unit))
            values = ", ".join(
                each if isinstance(each, str) else f"{scale * each:.6g}"
                for each in (value if isinstance(value, list) else [value])
            )
            if key.get("kind") == "logical":
                values = "yes" if value else "no"
            rows.append((group, name, values, unit, key.get("meaning", "").split(":")[0]))
    return data_frame(rows, ["group", "key", "value", "in", "meaning"])


@singledispatch
def sheets_of(record: Any) -> Iterator[Sheet]:
    """Yield the sheets of a record.

    Parameters
    ----------
    record : Result, FrameResult, Section or IDA
        The record.
    """
    raise InputError(f"report: there is none of a {type(record).__name__}")


@sheets_of.register
def _of_result(result: Result) -> Iterator[Sheet]:
    yield _of_structure(result.column)
    yield Sheet("Summary", str(result.error_estimate), table=_summary(result.summary))
    if result.dynamic:
        yield Sheet("Base shear in time", figures=(partial(history, result, "base_shear"),))
    elif len(cycles := result.half_cycles()):
        yield Sheet("Half-cycles", table=cycles.to_pandas())
    with suppress(InputError):
        yield Sheet("Limit states", table=result.limit_states().to_pandas(), beside=True)
    yield from _walls(result)
    yield Sheet("Rows", table=result.to_pandas(), beside=True)


@sheets_of.register
def _of_frame(result: FrameResult) -> Iterator[Sheet]:
    yield _of_structure(result.frame)
    largest = int(np.abs(result.displacement).argmax())
    whole = "Displacements, hinges and forces at the largest displacement of the top."
    shapes = (
        partial(frames.frame, result, row=largest),
        partial(frames.member_forces, result, row=largest),
        partial(frames.member_forces, result, "axial", row=largest),
    )
    yield Sheet("Frame", f"{result.scope_note} {whole}", shapes)
    drawn: list[Callable[[], Any]] = [partial(frames.pushover, result)]
    if result.frame.storey_heights:
        drawn.append(partial(frames.storey_drift, result))
    yield Sheet("Response", figures=tuple(drawn), table=_summary(result.summary))
    if result.events:
        yield Sheet("Limit states", table=result.events.to_pandas(), beside=True)
    members = [result.member(name) for name in result.frame.parts.members]
    rows = {
        "member": [member.name for member in members],
        "largest_axial_N": [member.axial.max() for member in members],
        "least_axial_N": [member.axial.min() for member in members],
        "largest_moment_Nm": [np.abs(member.moment).max() for member in members],
        "largest_shear_N": [np.abs(member.shear).max() for member in members],
        "ductility": [np.fmax.reduce([np.nan, *member.ductility]) for member in members],
    }
    yield Sheet("Members", table=data_frame(rows), beside=len(members) > _MOST_MEMBERS)
    if result.frame.infilled:
        yield Sheet("Infills", CHECK_NOTE, table=infills(result))
    yield from _walls(result)
    yield Sheet("Rows", table=result.to_pandas(), beside=True)


def _walls(result: Result | FrameResult) -> Iterator[Sheet]:
    """Yield what tests say of the accuracy of drawn walls."""
    told = "; ".join(f"{name}: {one}" for name, one in result.wall_accuracy().items())
    if told:
        yield Sheet("Accuracy of walls", f"{told}.")


@sheets_of.register
def _of_assessment(
    found: Assessment, target: Target | None = None, check: Any = None
) -> Iterator[Sheet]:
    result = found.result
    yield _of_structure(result.frame)
    curves: list[Callable[[], Any]] = [partial(frames.pushover, result)]
    text = repr(found)
    if target is not None:
        curves.append(partial(frames.target, target))
        end = () if target.reached else ("The push-over ends before the target.",)
        text = " ".join((f"{target.source}.", *end, *target.warnings))
    table = None if target is None else target.to_pandas()
    yield Sheet("Target displacement", text, tuple(curves), table)
    if check is not None:
        words = (
            f"The same frame under {len(check.record)} records scaled to the spectrum, "
            f"{int(check.collapsed.sum())} of which collapse: their median over the estimate, the "
            "scatter of the logarithm, and the range."
        )
        yield Sheet("Error of the target", words, table=check.to_pandas())
    row = -1
    if found.displacement is not None:
        away = np.abs(result.displacement - found.displacement)
        row = int(away.argmin())
    if result.frame.storey_heights:
        yield Sheet("Storeys", _STOREYS, table=_storeys(found))
    drawn: list[Callable[[], Any]] = [partial(frames.frame, result, row=row)]
    if result.frame.storey_heights and found.displacement is None:
        drawn.append(partial(frames.storey_drift, result))
    drawn.append(partial(frames.assessment, found))
    counts = ", ".join(f"{name}: {number}" for name, number in found.counts().items())
    told = "What exceeds its strength in shear has the colour of the last level."
    text = f"{found.source}: ends and joints that exceed each level: {counts}."
    text = " ".join((text, told, *found.warnings, "The ten largest ratios follow."))
    yield Sheet("Members", text, tuple(drawn), found.worst(10))
    yield Sheet("All members", table=found.to_pandas(), beside=True)
    yield Sheet("Assumed", f"{found.assumed} {result.scope_note} {_LEFT_OUT}")


def _storeys(found: Assessment) -> DataFrame:
    """Return drifts, shears and P-Delta coefficients of the storeys, largest of the rows judged."""
    result = found.result
    _, rows = rows_at(result, found.displacement)
    drift, shear, theta = (
        np.abs(between(rows, values)).max(axis=0)
        for values in (result.storey_drift, result.storey_shear, result.stability_coefficient)
    )
    storeys = np.arange(1, drift.size + 1)
    return data_frame({"storey": storeys, "drift_drift": drift, "shear_N": shear, "theta": theta})


@sheets_of.register
def _of_section(
    drawing: Section, axial_load: float | None = None, length: float | None = None
) -> Iterator[Sheet]:
    if axial_load is None:
        raise InputError(
            "report: axial_load is missing; give it in N, as report(section, path, axial_load=1e6)"
        )
    load = _core.group("column", {"axial_load": axial_load, "height": length})
    yield _drawn(drawing, load)
    found = diagram(drawing, axial_load)
    lines = [found.idealise("caltrans"), found.idealise("priestley")]
    drawn = (partial(section.moment_curvature, found, idealise="caltrans"),)
    told = [found, *lines, *(line.capacity(length) for line in lines if length is not None)]
    yield Sheet("Moment and curvature", "; ".join(map(str, told)), drawn)
    yield Sheet("Moment-curvature points", table=found.to_pandas(), beside=True)
    strengths = {code: interaction(drawing, code) for code in get_args(Code)}
    for code, strength in strengths.items():
        (arm, of_moment), (scale, of_force) = paper("N m"), paper("N")
        moment, design = (arm * strength.moment_at(axial_load, design=one) for one in (False, True))
        words = (
            f"Moment with N {scale * axial_load:.4g} {of_force}: nominal {moment:.4g} "
            f"{of_moment}, design {design:.4g} {of_moment}."
        )
        drawn = (partial(section.interaction, strength),)
        yield Sheet(f"Interaction {code}", words, drawn, strength.to_pandas(), beside=True)
    if length is not None:
        yield Sheet("Codes", table=code_values(drawing, length, axial_load).to_pandas())


@sheets_of.register
def _of_ensemble(found: Ensemble) -> Iterator[Sheet]:
    yield _of_structure(next(iter(found.columns.values())))
    table = found.to_pandas()
    states = {"status": list(found.counts), "runs": list(found.counts.values())}
    yield Sheet("Runs", str(found), table=data_frame(states))
    noted = table[["warnings", "error"]].melt(var_name="kind", value_name="text")
    noted = noted[noted["text"] != ""].value_counts().rename("runs").reset_index()
    if len(noted):
        yield Sheet("Warnings and errors", table=noted.head(20))
    names = list(found.measures)
    measured = table.assign(**table[names].abs()).groupby("column", observed=True)[names]
    shares = measured.quantile([0.0, 0.16, 0.5, 0.84, 1.0]).stack().unstack(1)
    shares.columns = ["least", "16 %", "median", "84 %", "largest"]
    words = "Their sizes over motions and scales, in SI; without runs that failed."
    yield Sheet("Measures", words, table=shares.rename_axis(["column", "measure"]).reset_index())
    yield Sheet("All runs", table=table, beside=True)


@sheets_of.register
def _of_ida(found: IDA, limits: Mapping[str, Any] | None = None) -> Iterator[Sheet]:
    structure = next(iter(found.runs.columns.values()))
    yield _of_structure(structure)
    states = ", ".join(limits or {"collapse": None})
    about = {"intensity": found.runs.measure.label, "limit states": states} | found.settings
    about = {name: str(value) for name, value in about.items()}
    given = {"setting": list(about), "value": list(about.values())}
    yield Sheet("Analysis", _damped(structure), table=data_frame(given))
    motions = found.runs.motions
    records = {
        "record": list(motions),
        "points": [one.acceleration.size for one in motions.values()],
        "step_s": [one.dt for one in motions.values()],
        "peak_m/s2": [one.pga for one in motions.values()],
    }
    if len(found.runs.columns) == 1:
        records["collapse_m/s2"] = np.ravel(found.collapse_intensity)
    yield Sheet("Records", table=data_frame(records))
    yield Sheet("Curves", str(found), (partial(many.ida, found),))
    level, fractiles = found.fractiles()
    names = (f"fractile_{share}_drift" for share in (16, 50, 84))
    rows = {"intensity_m/s2": level} | dict(zip(names, fractiles, strict=True))
    yield Sheet("Fractiles", table=data_frame(rows), beside=True)
    try:
        curves = found.fragilities(limits or {"collapse": ("collapse", None)})
    except InputError as error:
        yield Sheet("Fragility", str(error))
        curves = {}
    fitted = [
        {"limit_state": name, "theta_m/s2": curve.theta, "beta": curve.beta}
        for name, curve in curves.items()
    ]
    if curves:
        yield Sheet("Fragility", _FITTED, (partial(many.fragilities, curves),), data_frame(fitted))
    table = found.to_pandas()
    ended = table["status"].value_counts().rename("runs").reset_index()
    yield Sheet("How the runs ended", table=ended)
    yield Sheet("Runs", table=table, beside=True)
    scope = f"{SCOPE_NOTE} " if isinstance(structure, Frame) else ""
    yield Sheet("Assumed", f"{scope}{_LEFT_OUT}")


def _damped(structure: Structure) -> str:
    damping = structure.damping
    return f"Damping: {damping if damping is not None else 'none but that of the springs'}."


def _of_structure(structure: Structure) -> Sheet:
    if isinstance(structure, LayeredColumn) and structure.drawing is not None:
        (own,) = (given for name, given in _core.groups(structure._groups()) if name == "column")
        shown = ("height", "axial_load", "mass", "top_mass", "kinematics")
        return _drawn(structure.drawing.section, _core.group("column", {n: own[n] for n in shown}))
    if not isinstance(structure, Frame):
        return Sheet("Inputs", table=inputs(structure._groups()))
    given = inputs(structure._statement)
    drawings = list(_drawings(structure).items())[:_MOST_SECTIONS]
    drawn = [partial(_titled, *one) for one in drawings]
    # Layers and springs of drawn members fill pages.
    return Sheet(
        "Inputs",
        _described(structure),
        (partial(frames.frame, structure), *drawn),
        given,
        beside=len(given) > 60,
    )


def _drawings(frame: Frame) -> dict[Section, str]:
    """Return the different sections of the members of a frame, and the names of these."""
    found: dict[Section, list[str]] = {}
    for name, kind in frame.kinds.items():
        for one in dict.fromkeys(kind.sections or ()):
            found.setdefault(one, []).append(name)
    more = {one: f" and {len(names) - 1} more" for one, names in found.items() if len(names) > 1}
    return {one: names[0] + more.get(one, "") for one, names in found.items()}


def _titled(drawing: Section, title: str) -> Any:
    drawn = section.section(drawing)
    drawn.set_title(title, fontsize=9)
    return drawn


def _described(frame: Frame) -> str:
    """Return a frame in words: sizes, masses, loads, periods, and its sections."""
    parts = frame.parts
    storeys, bays = (tuple(getattr(frame, name) or ()) for name in ("storeys", "bays"))
    sizes = [
        ", ".join(f"{one:g}" for one in (several[:1] if len(set(several)) == 1 else several))
        for several in (storeys, bays)
    ]
    scale, of_force = paper("N")
    loads = ", ".join(f"{scale * load:.4g}" for load in np.atleast_1d(np.asarray(frame.beam_load)))
    words = [
        f"{len(storeys)} storeys of {sizes[0]} m and {len(bays)} bays of {sizes[1]} m"
        if storeys
        else f"{len(parts.nodes)} nodes and {len(parts.members)} members",
        f"mass {parts.mass / 1e3:.4g} t",
        f"load of the beams {loads} {of_force}/m",
        f"{'with' if frame.kinematics == 'pdelta' else 'without'} second-order work of the loads",
    ]
    if parts.mass > 0:
        first = modes(frame, min(3, len(parts.nodes))).period
        words.append(f"elastic periods {', '.join(f'{t:.3g}' for t in first)} s")
    drawn = [f"\n{names}: {one}." for one, names in _drawings(frame).items()]
    return "; ".join(words) + "." + "".join(drawn)


def _drawn(drawing: Section, values: _core.Statement) -> Sheet:
    drawn = (partial(section.section, drawing),)
    return Sheet("Inputs", str(drawing), drawn, inputs(values + drawing.drawing()))


#: Units of figures of a summary that are not called like a channel of the rows.
_UNITS = {"displacement_at_peak_force": "m", "time_step": "s", "stable_step": "s"}


def _unit(name: str) -> str:
    """Return the unit of a figure of a summary: that of the channel which its name ends with."""
    if name in _UNITS or name.startswith("relative"):
        return _UNITS.get(name, "")
    if "energy" in name:
        return "J"
    units = _core.units()
    return next((unit for channel, unit in units.items() if f"_{name}".endswith(f"_{channel}")), "")


def _summary(summary: Mapping[str, Any]) -> DataFrame:
    """Return the figures of an analysis, a row for each; what does not apply is left out."""
    rows = []
    for name, value in summary.items():
        unit = _unit(name)
        scale, unit = paper(unit)
        text = f"{scale * value:.4g}" if isinstance(value, int | float) else str(value)
        if text:
            rows.append((name.replace("_", " "), text, unit))
    return data_frame(rows, ["figure", "value", "in"])
