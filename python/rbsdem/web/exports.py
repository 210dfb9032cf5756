"""Texts that leave the page and come back: case files, Python, csv.

A case file has the springs of the column and the whole path, so that the executable computes the
same loop. Its first lines are comments with the drawing, from which the page comes back.
"""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import re
import tempfile
from collections.abc import Mapping, Sequence
from contextlib import suppress
from importlib import resources
from pathlib import Path
from typing import Any

from rbsdem._arguments import Derived
from rbsdem._package import unwarned
from rbsdem.errors import InputError
from rbsdem.model.springs import Spring
from rbsdem.run.case import Case, case_of, case_of_text
from rbsdem.run.column_result import Result
from rbsdem.run.frame_result import FrameResult
from rbsdem.run.solver import COLLAPSE_DRIFT
from rbsdem.web import frames
from rbsdem.web.state import Drawn, Faults, RefusedError, drawn_case, state_of

_MARK = "! rbsdem explore: "
_PROGRAM = 'import rbsdem\n\ncase = rbsdem.read_case("{}")\nresult = case.run()\nprint(result)\n'
#: Letters of the drawing on a line of its comment.
_LINE = 90


def _namelist(case: Case, drawing: Mapping[str, Any] | None) -> str:
    """Return a case file, with a drawing in comments in front of it.

    Parameters
    ----------
    case : Case
        The case.
    drawing : mapping or None
        The state of the page that it was made from.
    """
    text = case.to_namelist()
    if drawing is None:
        return text
    packed = json.dumps(drawing, separators=(",", ":"))
    lines = [_MARK + packed[i : i + _LINE] for i in range(0, len(packed), _LINE)]
    head = "! What was drawn; its springs follow. rbsdem explore opens it again.\n"
    return head + "\n".join(lines) + "\n" + text


def drawing_in(text: str) -> dict[str, Any] | None:
    """Return the drawing in the comments of a case file, or None if there is none to be read."""
    packed = "".join(
        line[len(_MARK) :].rstrip("\r") for line in text.split("\n") if line.startswith(_MARK)
    )
    try:
        found = json.loads(packed) if packed else None
    except ValueError:
        return None
    return found if isinstance(found, dict) else None


def own_case(text: object) -> Case:
    """Read the text of a case file that names no other file.

    Raises
    ------
    InputError
        As `read_case`; also if the text names a file, which a page must not reach.
    """
    if not isinstance(text, str):
        raise InputError("case: give the text of a case file")
    _refuse_files(text)
    return case_of_text(text)


def opened(text: object) -> dict[str, Any]:
    """Return the state of the text of a case file, from its drawing or as the case that it is."""
    try:
        with unwarned(Warning):
            # Notes on it stand beside its loop.
            case = own_case(text)
    except InputError as error:
        return {"faults": [{"field": "case", "text": str(error)}]}
    drawing, note = drawing_in(str(text)), ""
    if drawing is not None:
        with suppress(RefusedError):
            state = state_of({"state": drawing}, frames=True)
            with unwarned(Warning):
                drawn = _drawn_again(state)
            if drawn is not None:
                drawn = dataclasses.replace(drawn, title=case.title)
                if drawn.to_namelist() == case.to_namelist():
                    return {"state": state}
        note = "the file was changed after it was drawn: it is shown as it is, without its drawing"
    column = {"name": "A", "case": text}
    return {"state": {"columns": [column], "loading": {"kind": "own"}}, "note": note}


def _drawn_again(state: Mapping[str, Any]) -> Case | None:
    """Return the case of a drawing; None if it has faults."""
    if "frame" not in state:
        return drawn_case(state["columns"][0], state["loading"], {}, Faults())[0]
    result = frames.solved(state, {}, Faults()).result
    return None if result is None else case_of(result)


def _refuse_files(text: str) -> None:
    """Refuse keys that name files, outside of texts and comments, which end with their line."""
    for number, line in enumerate(text.splitlines(), 1):
        bare, quote = [], ""
        for letter in line:
            if not quote and letter == "!":
                break
            if not quote and letter in "'\"":
                quote = letter
            elif letter == quote:
                quote = ""
            elif not quote:
                bare.append(letter)
        if quote:
            raise InputError(f"line {number}: a text is not closed; put {quote} at its end")
        key = re.search(r"\b(file|initial|state)\b", "".join(bare), re.IGNORECASE)
        if key:
            raise InputError(
                f"line {number}: {key[0].lower()} = names a file, which a page does not read; "
                "start rbsdem explore CASE.nml, which puts histories into the case"
            )


def exported(
    form: str, case: Case, drawn: Drawn | None, given: Mapping[str, Any], loading: Mapping[str, Any]
) -> str:
    """Return a column as a case file ("namelist") or as a program ("python").

    Parameters
    ----------
    form : str
        Which.
    case, drawn
        The column as a case, and as it was drawn.
    given, loading : mapping
        Column and loading of the state that it was made from.
    """
    if form == "python" and drawn is not None and "case" not in given:
        return _python(drawn, given["column"], loading)
    if form == "python":
        return _PROGRAM.format("case.nml")
    # A record that was opened is in the case itself, not in its drawing.
    known = "case" not in given and loading.get("kind") != "record"
    return _namelist(case, {"columns": [given], "loading": loading} if known else None)


def of_frame(form: str, result: FrameResult, state: Mapping[str, Any]) -> str:
    """Return a frame with its loading in a form, as `exported`, or its rows ("csv")."""
    if form == "csv":
        return csv_of(result)
    if form == "python":
        return _PROGRAM.format("frame.nml")
    known = state["loading"].get("kind") != "record"
    return _namelist(case_of(result), state if known else None)


def csv_of(result: Result | FrameResult) -> str:
    """Return the rows of a result as the executable writes them."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        rows = Path(folder) / "rows.csv"
        result.to_csv(rows)
        return rows.read_text(encoding="utf-8")


def _python(drawn: Drawn, frame: Mapping[str, Any], loading: Mapping[str, Any]) -> str:
    """Return a program that computes the loop of a drawn column."""
    section, column = drawn.section, drawn.column
    lines = [
        f"section = {type(section).__name__}(",
        *(f"    {name}={_code(value)}," for name, value in _stated(section)),
        ")",
    ]
    moved = loading["kind"] in ("synthetic", "record")
    height, more = repr(frame["height"]), ""
    if drawn.factor != 1.0:
        lines.append(
            "# The lower half of a column in double curvature moves by half of what the ends do."
        )
        height += f" / {drawn.factor:g}"
    if column.top == "fixed":
        more += ', top="fixed"'
    if column.footing is not None:
        lines.append(f"footing = {_code(column.footing)}")
        more += ", footing=footing"
    load = repr(frame["axial_load"])
    lines.append(f"column = rbsdem.section.column(section, {height}, axial_load={load}{more})")
    if moved:
        mass = frame.get("top_mass")
        mass = f"{frame['axial_load']!r} / 9.80665" if mass is None else repr(mass)
        record = f"read_motion({loading.get('name')!r})"
        if loading["kind"] == "synthetic":
            record = f"synthetic(1, seed={loading.get('seed', 1)!r}, dt=0.01)[0]"
        lines += [
            f"motion = rbsdem.motions.{record}.scaled({loading.get('scale', 1.0)!r})",
            f"column = dataclasses.replace(column, top_mass={mass})",
            "result = rbsdem.time_history(",
            "    column, ground_acceleration=motion, openings=True,",
            f"    collapse_drift={COLLAPSE_DRIFT},",
            ")",
        ]
    else:
        names = ("name", "amplitudes", "cycles", "reference", "largest")
        values = [(n, loading[n]) for n in names if loading.get(n) is not None]
        asked = [f"{n}={v!r}" if i else repr(v) for i, (n, v) in enumerate(values)]
        lines += [
            f"drifts = rbsdem.protocol({', '.join(asked)})",
            "result = rbsdem.cyclic(column, displacement=column.height * drifts)",
        ]
    lines += ["print(result)", "print(result.limit_states())", ""]
    text = "\n".join(lines)
    classes = ", ".join(sorted(set(re.findall(r"(?<!\.)\b([A-Z]\w+)\(", text))))
    head = "import dataclasses\n\n" if "dataclasses." in text else ""
    return f"{head}import rbsdem\nfrom rbsdem import {classes}\n\n{text}"


def _code(value: Any) -> str:
    """Return a record as Python, with the values that were given."""
    if not dataclasses.is_dataclass(value):
        return repr(value)
    given = ", ".join(f"{name}={_code(part)}" for name, part in _stated(value))
    module = "rbsdem.springs." if isinstance(value, Spring) else ""
    return f"{module}{type(value).__name__}({given})"


def _stated(record: Any) -> list[tuple[str, Any]]:
    """Return the values of a record that do not follow from others."""
    values = [(field, getattr(record, field.name)) for field in dataclasses.fields(record)]
    return [
        (field.name, value)
        for field, value in values
        # The bars of a section follow from its layout.
        if value is not None and value != field.default and not isinstance(value, Derived | tuple)
    ]


#: Modules that pages and reports share, each after those that it imports.
_SHARED = (
    "units.js", "chart.js", "fields.js", "drawing.js", "panels.js", "history.js", "answers.js",
    "machine.js", "columns.js",
)  # fmt: skip
#: Modules of the page, and of a report of columns.
PAGE, REPORT = (*_SHARED, "frame.js", "main.js"), (*_SHARED, "report.js")

_KINDS = {"html": "html", "css": "css", "js": "javascript"}
TYPES = {ending: f"text/{kind}; charset=utf-8" for ending, kind in _KINDS.items()}

_IMPORT = re.compile(r"^import \{[^}]*\} from \"\./[a-z]+\.js\";\n", re.MULTILINE)
_EXPORT = re.compile(r"^export ", re.MULTILINE)


def parts(page: str = "index.html", modules: Sequence[str] = PAGE) -> dict[str, bytes]:
    """Return the files of a page by their names."""
    folder = resources.files("rbsdem.web").joinpath("page")
    return {name: folder.joinpath(name).read_bytes() for name in (page, "page.css", *modules)}


def one_file(
    title: str,
    data: Mapping[str, Any] | None,
    modules: Sequence[str] = REPORT,
    sheets: tuple[str, str] = ("", ""),
) -> str:
    """Return a page with its style, its modules and its results inside.

    It uses no network: its policy allows only the script and the style that are in it.

    Parameters
    ----------
    title : str
        Title of the document.
    data : mapping or None
        Answers of the server that the page needs.
    modules : sequence of str, optional
        `REPORT`, or none for a page of sheets.
    sheets : tuple of str, optional
        Html that stands before and behind what the modules draw.
    """
    name = "index.html" if modules else "report.html"
    files = {key: raw.decode("utf-8") for key, raw in parts(name, modules).items()}
    script = "\n".join(_EXPORT.sub("", _IMPORT.sub("", files[module])) for module in modules)
    style = files["page.css"]
    policy = (
        f"default-src 'none'; script-src '{_digest(script)}'; style-src '{_digest(style)}'; "
        "img-src data: blob:; base-uri 'none'; form-action 'none'"
    )
    # In JSON "<" stands only in texts, where it can be written so that no tag ends.
    packed = json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")
    page = files[name]
    before, behind = (f'<div class="sheets">{html}</div>\n' if html else "" for html in sheets)
    for old, new in (
        ("<main", f"{before}<main"),
        ("</main>\n", f"</main>\n{behind}"),
        ("<title>rbsdem</title>", f"<title>{plain(title)}</title>"),
        (
            '<link rel="stylesheet" href="page.css">',
            f'<meta http-equiv="Content-Security-Policy" content="{policy}">\n'
            f"<style>{style}</style>",
        ),
        (
            '<script type="module" src="main.js"></script>',
            f'<script type="application/json" id="report">{packed}</script>\n'
            f'<script type="module">{script}</script>',
        ),
    ):
        if page.count(old) != 1:
            raise AssertionError(old)
        page = page.replace(old, new)
    return page


def _digest(text: str) -> str:
    return "sha256-" + base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()


def plain(text: str) -> str:
    """Return a text for html."""
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
