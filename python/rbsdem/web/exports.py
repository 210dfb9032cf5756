"""Texts that leave the page and come back: case files, Python, csv.

A case file has the groups of the page, with the values of a record in place of its name. One that
comes back is drawn again; a column whose springs are none that are drawn stays a text.
"""

from __future__ import annotations

import base64
import dataclasses
import hashlib
import json
import re
import tempfile
from collections.abc import Callable, Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem._arguments import Derived
from rbsdem._package import unwarned
from rbsdem.errors import InputError
from rbsdem.model.springs import Spring
from rbsdem.motions.motion import GroundMotion
from rbsdem.run.case import Case, case_of_text, groups_of_text
from rbsdem.run.column_result import Result
from rbsdem.run.frame_result import FrameResult
from rbsdem.run.solver import COLLAPSE_DRIFT
from rbsdem.section.frame import Frame
from rbsdem.web.state import (
    Drawn,
    Faults,
    Group,
    completed,
    first,
    is_frame,
    refuse_files,
    text_of,
)

_PROGRAM = 'import rbsdem\n\ncase = rbsdem.read_case("{}")\nresult = case.run()\nprint(result)\n'
#: Groups of springs, which are made again where they are those of the drawing.
_SPRINGS = ("shear", "flexure", "axial_spring", "layer_spring", "layers")
#: Keys of a column and of its drawing that are made with its springs.
_MADE = {
    "column": ("n", "mass", "lengths", "depth", "rotary_inertia", "kinematics", "model"),
    "drawing": ("height", "axial_load", "n"),
}


def namelist(case: Any, records: Mapping[str, GroundMotion]) -> str:
    """Return a case of the page as the text of a case file."""
    return case if isinstance(case, str) else text_of(completed(case), records, Faults(case))


def opened(text: object, keep: Callable[[GroundMotion, str], str]) -> dict[str, Any]:
    """Return the state of the text of a case file.

    Parameters
    ----------
    text : str
        The text.
    keep : callable
        Keeps a record that is in it, and returns its name.
    """
    try:
        if not isinstance(text, str):
            raise InputError("case: give the text of a case file")
        refuse_files(text)
        with unwarned(Warning):
            # Notes on it stand beside its loop.
            case = case_of_text(text)
            groups = _drawn_again(groups_of_text(text), case)
    except InputError as error:
        return {"faults": [{"field": "", "text": str(error)}]}
    if groups is None:
        return {"state": {"cases": [text]}}
    for name, values in groups:
        if name == "loading" and not _keep_record(values, keep):
            return {"state": {"cases": [text]}}
    return {"state": {"cases": [[list(one) for one in groups]]}}


def _keep_record(values: dict[str, Any], keep: Callable[[GroundMotion, str], str]) -> bool:
    """Put the name of a record in place of its values; return whether the page can show it."""
    values.pop("source", None)
    if values.get("drive") != "ground_acceleration":
        return values.get("drive") == "displacement"
    steps = np.diff(values.pop("time", [0.0, values.get("interval", 0.0)]))
    if "values" not in values or values.get("unit", "m/s2") != "m/s2":
        return False
    if not steps[0] > 0.0 or not np.allclose(steps, steps[0], rtol=1e-6, atol=0.0):
        return False
    motion = GroundMotion(np.array(values.pop("values")), float(steps[0]))
    values.pop("interval", None)
    values["file"] = keep(motion, "record of the file")
    return True


def _drawn_again(groups: list[Group], case: Case) -> list[Group] | None:
    """Return the groups that the page draws; None for a column that is not as it would be drawn."""
    static = ("analysis", {"method": "static"})
    groups = [one for one in groups if one != static and one[0] != "units"]
    if isinstance(case.column, Frame):
        return groups if first(groups, "frame").get("storeys") else None
    if not first(groups, "drawing") or sum(name == "loading" for name, _ in groups) != 1:
        return None
    made: list[Group] = []
    for name, values in groups:
        if name not in _SPRINGS or values.get("joint") in (0, [0]):
            own = {key: one for key, one in values.items() if key not in _MADE.get(name, ())}
            made.append((name, {"top": "free"} | own if name == "column" else own))
    try:
        again = case_of_text(text_of(made, {}, Faults(made)))
    except InputError:
        return None
    return made if again.column == case.column else None


def python(case: Any, drawn: Drawn | None, name: str) -> str:
    """Return a program that computes the response of a case of the page.

    Parameters
    ----------
    case : list or str
        The case.
    drawn : Drawn or None
        Its column as it was drawn.
    name : str
        The case file that a program without a drawing reads.
    """
    if drawn is None or isinstance(case, str) or is_frame(case):
        return _PROGRAM.format(name)
    return _python(drawn, first(completed(case), "column"), first(case, "loading"))


def csv_of(result: Result | FrameResult) -> str:
    """Return the rows of a result as the executable writes them."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        rows = Path(folder) / "rows.csv"
        result.to_csv(rows)
        return rows.read_text(encoding="utf-8")


def _python(drawn: Drawn, column: Mapping[str, Any], loading: Mapping[str, Any]) -> str:
    """Return a program that computes the loop of a drawn column."""
    section, made = drawn.section, drawn.column
    lines = [
        f"section = {type(section).__name__}(",
        *(f"    {name}={_code(value)}," for name, value in _stated(section)),
        ")",
    ]
    height, more = repr(column["height"]), ""
    if drawn.factor != 1.0:
        lines.append(
            "# The lower half of a column in double curvature moves by half of what the ends do."
        )
        height += f" / {drawn.factor:g}"
    if made.top == "fixed":
        more += ', top="fixed"'
    if made.footing is not None:
        lines.append(f"footing = {_code(made.footing)}")
        more += ", footing=footing"
    load = repr(made.axial_load)
    lines.append(f"column = rbsdem.section.column(section, {height}, axial_load={load}{more})")
    if loading["drive"] == "ground_acceleration":
        file = loading["file"]
        record = f"read_motion({file.partition('#')[0]!r})"
        if file.startswith("synthetic "):
            record = f"synthetic(1, seed={file.split()[1]}, dt=0.01)[0]"
        lines += [
            f"motion = rbsdem.motions.{record}.scaled({loading.get('scale', 1.0)!r})",
            f"column = dataclasses.replace(column, top_mass={column['top_mass']!r})",
            "result = rbsdem.time_history(",
            "    column, ground_acceleration=motion, openings=True,",
            f"    collapse_drift={COLLAPSE_DRIFT},",
            ")",
        ]
    elif "values" in loading:
        share = "" if drawn.factor == 1.0 else f" / {drawn.factor:g}"
        lines += [
            f"path = np.array({loading['values']!r}){share}",
            "result = rbsdem.cyclic(column, displacement=path)",
        ]
    else:
        names = ("protocol", "amplitudes", "cycles", "reference", "largest")
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
    head += "import numpy as np\n" if "np." in text else ""
    return f"{head}import rbsdem\nfrom rbsdem import {classes}\n\n{text}"


def _code(value: Any) -> str:
    """Return a record as Python, with the values that were given."""
    if isinstance(value, tuple):
        return f"({', '.join(map(_code, value))},)"
    if not dataclasses.is_dataclass(value):
        return repr(value)
    given = ", ".join(f"{name}={_code(part)}" for name, part in _stated(value))
    module = "rbsdem.springs." if isinstance(value, Spring) else ""
    return f"{module}{type(value).__name__}({given})"


def _stated(record: Any) -> list[tuple[str, Any]]:
    """Return the values of a record that do not follow from others."""
    given = {field.name: getattr(record, field.name) for field in dataclasses.fields(record)}
    if any(given.get(name) for name in ("layout", "top", "bottom", "side")):
        given.pop("bars", None)  # of a section, which follow from its layout or its rows
    default = {field.name: field.default for field in dataclasses.fields(record)}
    return [
        (name, value)
        for name, value in given.items()
        if value is not None and value != default[name] and not isinstance(value, Derived)
    ]


#: Modules that pages and reports share, each after those that it imports.
_SHARED = (
    "units.js", "chart.js", "fields.js", "section.js", "drawing.js", "panels.js", "history.js",
    "answers.js", "machine.js", "columns.js",
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
