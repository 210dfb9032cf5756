"""Texts that leave the page and come back: case files, Python, csv.

A case file has the springs of the column and the whole path, so that the executable computes the
same loop. Its first lines are comments with the drawing, from which the page comes back.
"""

from __future__ import annotations

import json
import re
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rbsdem import _arguments
from rbsdem._files import whole_file
from rbsdem.errors import InputError
from rbsdem.results.case import Case, read_case
from rbsdem.results.result import Result
from rbsdem.web.state import ENDS, SIZES

if TYPE_CHECKING:
    from rbsdem.web.compute import Answered

__all__ = [
    "case_of_result",
    "case_of_text",
    "csv_of",
    "drawing_in",
    "exported",
    "namelist",
    "python",
]

_MARK = "! rbsdem explore: "
#: Letters of the drawing on a line of its comment.
_LINE = 90


def namelist(case: Case, drawing: Mapping[str, Any] | None) -> str:
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
    head = "! The column of a drawing; its springs follow. rbsdem explore opens it again.\n"
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


def case_of_text(text: object) -> Case:
    """Read the text of a case file that names no other file.

    Raises
    ------
    InputError
        As `read_case`; also if the text names a file, which a page must not reach.
    """
    if not isinstance(text, str):
        raise InputError("case: give the text of a case file")
    _refuse_files(text)
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        path = Path(folder) / "case.nml"
        with whole_file(path) as file:
            file.write(text.encode("utf-8"))
        try:
            return read_case(path)
        except InputError as error:
            raise InputError(
                str(error).replace(f"{path}: ", "").replace(str(path), "case")
            ) from None


def _refuse_files(text: str) -> None:
    """Refuse the key `file` outside of texts and comments, which end with their line."""
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
        if re.search(r"\bfile\b", "".join(bare), re.IGNORECASE):
            raise InputError(
                f"line {number}: file = names a file, which a page does not read; start "
                "rbsdem explore CASE.nml, which puts the history into the case"
            )


def case_of_result(result: Result, title: str) -> Case:
    """Return the case of a result, as `read_case` would."""
    call = dict(result.call)
    loads = {
        name: call.pop(name, None)
        for name in (
            "displacement",
            "force",
            "ground_acceleration",
            "vertical_acceleration",
            "axial_load",
        )
    }
    time = call.pop("time", None)
    method = call.pop("method", "auto") if result.dynamic else "static"
    first = next(values for values in loads.values() if values is not None)
    if time is None:
        time = _arguments.vector(range(len(first)), "time")
    return Case(
        title=title,
        column=result.column,
        method=method,
        time=time,
        **{name: None if v is None else _arguments.vector(v, name) for name, v in loads.items()},
        settings={name: value for name, value in call.items() if value is not None},
    )


def csv_of(result: Result) -> str:
    """Return the rows of a result as the executable writes them."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        rows = Path(folder) / "rows.csv"
        result.to_csv(rows)
        return rows.read_text(encoding="utf-8")


def exported(form: str, found: Answered, given: Mapping[str, Any], state: Mapping[str, Any]) -> str:
    """Return a column that was solved as "namelist", "python" or "csv".

    Parameters
    ----------
    form : str
        Which.
    found : Answered
        The column with its result.
    given, state : mapping
        Column and state that it was made from.
    """
    assert found.result is not None
    if form == "csv":
        return csv_of(found.result)
    loading = state["loading"]
    if form == "python":
        if found.case is None:
            return python(given, loading)
        return (
            'import rbsdem\n\ncase = rbsdem.read_case("case.nml")\n'
            "result = case.run()\nprint(result)\n"
        )
    if found.case is not None:
        return namelist(found.case, None)
    case = case_of_result(found.result, str(given.get("name", ""))[:80])
    # A record that was opened is in the case itself, not in its drawing.
    known = loading.get("kind") != "record"
    return namelist(case, {"columns": [given], "loading": loading} if known else None)


def python(given: Mapping[str, Any], loading: Mapping[str, Any]) -> str:
    """Return a program that computes the loop of a drawn column.

    Parameters
    ----------
    given, loading : mapping
        A column and the loading of a state that was computed without an error.
    """
    shape = given["section"]["shape"]
    round_ = "circle" in shape
    kind = "".join(part.capitalize() for part in shape.replace("circle", "circular").split("_"))
    kind = kind.replace("Rectangle", "Rectangular") + "Section"
    hoops = "Spiral" if round_ else "Ties"
    bars, ties, frame = given["bars"], given["ties"], given["column"]
    sizes = [f"{name}={given['section'][name]!r}" for name in SIZES[shape]]
    half = ENDS[frame.get("ends", "cantilever")]
    moved = loading["kind"] in ("synthetic", "record")
    lines = [
        *(["import dataclasses", ""] if moved and half == 1.0 else []),
        "import rbsdem",
        f"from rbsdem import Concrete, {kind}, Layout, Steel, {hoops}",
        "",
        f"bars = Layout({bars['number']!r}, {bars['diameter']!r}, {_steel(bars)}"
        + ("" if round_ or bars.get("face") is None else f", face={bars['face']!r}")
        + ")",
        f"{'spiral' if round_ else 'ties'} = {hoops}({ties['diameter']!r}, {ties['spacing']!r}, "
        f"{_steel(ties)}{_options(ties, ('hoops',) if round_ else ('legs', 'legs_across'))})",
        f"section = {kind}(",
        *[f"    {size}," for size in sizes],
        f"    concrete=Concrete({given['concrete']['fc']!r}),",
        "    layout=bars,",
        f"    {'spiral=spiral' if round_ else 'ties=ties'},",
        f"    cover={given['section']['cover']!r},",
        ")",
    ]
    height = repr(frame["height"])
    if half != 1.0:
        lines.append(
            "# The lower half of a column in double curvature"
            + ("." if moved else "; it moves by half of what the ends do.")
        )
        height += f" / {half:g}"
    lines.append(f"column = section.column({height}, axial_load={frame['axial_load']!r})")
    lines += _loaded(loading, frame, half)
    lines += ["print(result)", "print(result.limit_states())", ""]
    return "\n".join(lines)


def _loaded(loading: Mapping[str, Any], frame: Mapping[str, Any], half: float) -> list[str]:
    kind = loading["kind"]
    if kind in ("amplitudes", "named"):
        if kind == "amplitudes":
            asked = f"{loading['amplitudes']!r}, cycles={loading['cycles']!r}"
        else:
            asked = repr(loading["name"]) + _options(loading, ("reference", "largest"))
        return [
            f"drifts = rbsdem.protocol({asked})",
            "path = column.height * drifts",
            "result = rbsdem.cyclic(column, displacement=path)",
        ]
    mass = frame.get("top_mass")
    mass = f"{frame['axial_load']!r} / 9.80665" if mass is None else repr(mass)
    read = (
        f"rbsdem.motions.synthetic(1, seed={loading.get('seed', 1)!r})[0]"
        if kind == "synthetic"
        else f"rbsdem.motions.read_motion({loading.get('name')!r})"
    )
    return [
        f"motion = {read}.scaled({loading.get('scale', 1.0)!r})",
        f"column = dataclasses.replace(column, top_mass={mass})"
        if half == 1.0
        else f"column = rbsdem.double_curvature(column, top_mass={mass})",
        "result = rbsdem.time_history(",
        "    column,",
        "    motion.time,",
        "    ground_acceleration=motion.acceleration,",
        "    collapse_drift=0.2,",
        "    openings=True,",
        ")",
    ]


def _steel(given: Mapping[str, Any]) -> str:
    ultimate = "" if given.get("fu") is None else f", {given['fu']!r}"
    return f"Steel({given['fy']!r}{ultimate})"


def _options(given: Mapping[str, Any], names: tuple[str, ...]) -> str:
    return "".join(f", {name}={given[name]!r}" for name in names if given.get(name) is not None)
