"""Texts that leave the page and come back: case files, Python, csv.

A case file has the springs of the column and the whole path, so that the executable computes the
same loop. Its first lines are comments with the drawing, from which the page comes back.
"""

from __future__ import annotations

import dataclasses
import json
import re
import tempfile
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from rbsdem._files import whole_file
from rbsdem.errors import InputError
from rbsdem.results.case import Case, read_case
from rbsdem.results.result import Result
from rbsdem.web.state import ENDS, SHAPES, Faults, RefusedError, drawn_case, state_of

__all__ = ["case_of_text", "drawing_in", "exported", "opened", "text_file"]

_MARK = "! rbsdem explore: "
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


@contextmanager
def text_file(text: str, name: str, shown: str) -> Iterator[Path]:
    """Put a text into a file for a reader; errors have another name for it."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        path = Path(folder) / name
        with whole_file(path) as file:
            file.write(text.encode("utf-8"))
        try:
            yield path
        except InputError as error:
            raise InputError(str(error).replace(str(path), shown)) from None


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
    with text_file(text, "case.nml", "case") as path:
        return read_case(path)


def opened(text: object) -> dict[str, Any]:
    """Return the state of the text of a case file, from its drawing or as the case that it is."""
    try:
        with warnings.catch_warnings():
            # What there is to say of it stands beside its loop.
            warnings.simplefilter("ignore")
            case = case_of_text(text)
    except InputError as error:
        return {"faults": [{"field": "case", "text": str(error)}]}
    drawing, note = drawing_in(str(text)), ""
    if drawing is not None:
        with suppress(RefusedError):
            state = state_of({"state": drawing})
            drawn, _, _ = drawn_case(state["columns"][0], state["loading"], {}, Faults())
            if drawn is not None:
                drawn = dataclasses.replace(drawn, title=case.title)
                if drawn.to_namelist() == case.to_namelist():
                    return {"state": state}
        note = "the file was changed after it was drawn: it is shown as it is, without its drawing"
    column = {"name": "A", "case": text}
    return {"state": {"columns": [column], "loading": {"kind": "own"}}, "note": note}


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
    form: str,
    case: Case,
    result: Result,
    given: Mapping[str, Any],
    loading: Mapping[str, Any],
) -> str:
    """Return a column that was solved as "namelist", "python" or "csv".

    Parameters
    ----------
    form : str
        Which.
    case, result
        The column as a case, and its result.
    given, loading : mapping
        Column and loading of the state that it was made from.
    """
    if form == "csv":
        with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
            rows = Path(folder) / "rows.csv"
            result.to_csv(rows)
            return rows.read_text(encoding="utf-8")
    if form == "python" and "case" not in given:
        return _python(given, loading)
    if form == "python":
        return (
            'import rbsdem\n\ncase = rbsdem.read_case("case.nml")\n'
            "result = case.run()\nprint(result)\n"
        )
    # A record that was opened is in the case itself, not in its drawing.
    known = "case" not in given and loading.get("kind") != "record"
    return _namelist(case, {"columns": [given], "loading": loading} if known else None)


def _python(given: Mapping[str, Any], loading: Mapping[str, Any]) -> str:
    """Return a program that computes the loop of a drawn column.

    Parameters
    ----------
    given, loading : mapping
        A column and the loading of a state that was computed without an error.
    """
    shape = given["section"]["shape"]
    round_ = "circle" in shape
    made, names = SHAPES[shape]
    kind = made.__name__
    hoops = "Spiral" if round_ else "Ties"
    bars, ties, frame = given["bars"], given["ties"], given["column"]
    sizes = [f"{name}={given['section'][name]!r}" for name in names]
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
