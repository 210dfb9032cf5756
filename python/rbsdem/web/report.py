"""A report: one html file that needs no network, with a folder of its tables as csv.

Sheets have a heading, a text, figures and a table. A column has besides, between its sheets, the
page with its results inside: only then the modules of the page are loaded.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rbsdem import _arguments, _core
from rbsdem._files import claim_folder, refuse_other_page, save_frame
from rbsdem.errors import InputError, RbsdemError
from rbsdem.output.units import units as paper_units
from rbsdem.run.case import Case, case_of
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.frame_result import FrameResult
from rbsdem.web.pages import REPORT, one_file
from rbsdem.web.sheets import Sheet, head, html_of, of_assessment, sheets_of, write

if TYPE_CHECKING:
    from rbsdem.measured.specimens import Specimens
    from rbsdem.web.answers import Answered, Answers

#: Units of the page, by their names there.
_OF_PAGE = {"mm": ("mm", "kN"), "m": ("m", "kN"), "si": ("m", "N"), "in": ("in", "kip")}
#: Letters of a text that a report takes with it.
_MOST_TEXT = 400_000


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
    from rbsdem.web.answers import Answers  # noqa: PLC0415

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
    export = answers.export(asked | {"form": "namelist"}, lambda: None)
    # A long history would be most of the report; the case that it is made from has it.
    if len(export["text"]) < _MOST_TEXT:
        data["exports"]["namelist"] = export
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
    refuse_other_page(Path(path))
    data = report_data(state, title, near, answers=answers)
    return write(path, one_file(title, data, sheets=(head(title, author, project, None), "")))


def report_of_page(answers: Answers, asked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the report of a state of the page: "text" and "name" of one file, or "faults"."""
    from rbsdem.web.frames import judged  # noqa: PLC0415
    from rbsdem.web.state import is_frame, state_of, title_of  # noqa: PLC0415

    cases = state_of(asked)
    if not is_frame(cases[0]):
        title = " and ".join(map(title_of, cases))
        try:
            data = report_data({"cases": cases}, f"Column {title}", answers=answers)
        except InputError as error:
            return {"faults": [{"field": "", "text": str(error)}]}
        front = head(data["title"], "", "", None)
        return {"text": one_file(data["title"], data, sheets=(front, "")), "name": "report"}
    answered = answers.solved(cases[0])
    if answered.case is None or answered.result is None:
        return {"faults": answered.faults}
    title = title_of(cases[0]) or "Frame"
    with paper_units(*_OF_PAGE.get(str(asked.get("units")), ("mm", "kN"))):
        made: list[Sheet] = []
        # What cannot be judged is reported by the sheets of its response alone.
        with suppress(RbsdemError):
            outcome = judged(answered.case, answered.result)
            for assessment in outcome.assessments[:1]:
                made = list(of_assessment(assessment, outcome.target))
        shown = [
            sheet
            for sheet in made or sheets_of(answered.result)
            if sheet.figures or not sheet.beside
        ]
        html = head(title, "", "", None) + "".join(map(html_of, shown))
    page = one_file(title, None, (), (html, ""))
    return {"text": page, "name": "report"}


def _column_data(result: ColumnResult, case: Case, title: str) -> dict[str, Any]:
    """Return the answers about a result; one without the openings of its hinge is run again.

    Strains of layers, from which most limit states follow, need them.
    """
    from rbsdem.web.answers import Answered  # noqa: PLC0415

    text = case.to_namelist()
    try:
        result.limit_states()
    except InputError:
        return report_data({"cases": [text]}, title)
    return report_data({"cases": [text]}, title, known=Answered(result, case))


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
    record : Result, FrameResult, BuildingResult, Assessment, Section, Ensemble or IDA
        What it is about.
    path : path-like
        File to write. It and the files of the folder beside it replace those of an earlier report;
        a file that rbsdem did not write is refused, not written over.
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
    about = {"title": title, "author": author, "project": project, "date": date}
    return write_record(record, path, about, units, **asked)[0]


def write_record(
    record: Any,
    path: str | os.PathLike[str],
    about: Mapping[str, str | None],
    units: tuple[str, str] = ("mm", "kN"),
    **asked: Any,
) -> list[Path]:
    """Write a report as `report` does, with title, author, project, date; return all its files."""
    for name, text in about.items():
        if not isinstance(text, str | None):
            raise InputError(f"report: {name} = {_arguments.shown(text)} must be a text")
    if not (isinstance(units, (tuple, list)) and len(units) == 2):
        raise InputError(
            f"report: units = {_arguments.shown(units)} must be a length and a force, as "
            '("in", "kip")'
        )
    case = case_of(record) if isinstance(record, ColumnResult | FrameResult) else None
    target = Path(path)
    refuse_other_page(target)
    title = about.get("title") or (case.title if case else "") or target.stem
    data = _column_data(record, case, title) if case and isinstance(record, ColumnResult) else None
    with paper_units(*units):
        sheets = list(sheets_of(record, **asked))
        author, project = (about.get(name) or "" for name in ("author", "project"))
        front = head(title, author, project, about.get("date")) + html_of(sheets[0])
        # Sheets whose table alone is beside the report have nothing to show.
        behind = "".join(
            html_of(sheet) for sheet in sheets[1:] if sheet.figures or not sheet.beside
        )
    page = one_file(title, data, REPORT if data else (), (front, behind))
    tables = {f"{sheet.name}.csv": sheet.table for sheet in sheets if sheet.table is not None}
    names = [*tables, *(["case.nml"] if case else [])]
    files = claim_folder(target.with_name(f"{target.stem}_files"), names, anew=True)
    for table, file in zip(tables.values(), files, strict=False):
        save_frame(table, file)
    if case is not None:
        write(files[-1], case.to_namelist())
    return [write(target, page), *files]
