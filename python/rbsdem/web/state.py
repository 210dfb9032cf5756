"""The state of the page as cases; what is wrong goes beside its field.

A case is the list of the groups of a case file, each a name and its values by their keys in SI, or
the text of a file that the page does not draw. It is written as such a file and read by the reader
of all cases, so that keys, bounds and messages are those of files. A file that comes back is drawn
again; a column whose springs are none that are drawn stays a text.
"""

from __future__ import annotations

import json
import math
import re
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np

from rbsdem import _arguments
from rbsdem._package import recorded, unwarned
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, NDArray
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.examples import house
from rbsdem.model.column import Column
from rbsdem.model.shape import Section
from rbsdem.motions.motion import GroundMotion, synthetic
from rbsdem.run.case import Case, case_of_text, groups_of_text
from rbsdem.run.groups import section_of
from rbsdem.run.solver import COLLAPSE_DRIFT
from rbsdem.section.frame import Frame
from rbsdem.section.parameters import VERSION

Group: TypeAlias = tuple[str, dict[str, Any]]
Groups: TypeAlias = Sequence[Group]

_DRIFTS = [0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06]
_DRAWN = {"version": VERSION}
_STATIC = ("analysis", {"method": "static"})

# fmt: off
#: The column that the page begins with: test No 1 of Soesianawati and others (1986).
DEFAULT: dict[str, Any] = {"cases": [[
    ["case", {"title": "A"}],
    ["column", {"height": 1.6, "axial_load": 744e3, "top": "free"}],
    ["drawing", _DRAWN],
    ["section", {"shape": "rectangle", "width": 0.4, "depth": 0.4, "cover": 0.013}],
    ["concrete", {"fc": 46.5e6}],
    ["steel", {"id": 1, "fy": 446e6, "fu": 702e6}],
    ["steel", {"id": 2, "fy": 364e6}],
    ["layout", {"number": 12, "diameter": 0.016, "steel": 1}],
    ["ties", {"diameter": 0.007, "spacing": 0.085, "steel": 2, "legs": 4}],
    ["loading", {"drive": "displacement", "unit": "drift", "amplitudes": _DRIFTS, "cycles": [2]}],
]]}
# fmt: on

#: Columns side by side; cycles of a path; values of a record that a page shows; storeys and bays.
_MOST_CASES, _MOST_CYCLES, MOST_VALUES, _MOST_CELLS = 2, 200, 60_000, 12
#: Rows of a response in an answer; a figure shows no more.
_ROWS = 8000
#: Keys that name files, which a page must not reach; texts and comments of a line.
_FILES = ("file", "initial", "state", "path")
_TEXTS = re.compile(r"'[^']*'|\"[^\"]*\"|!.*")
_WORD = re.compile(r"[a-z]\w{0,31}", re.ASCII)
_SYNTHETIC = re.compile(r"synthetic ([0-9]{1,9})")
#: Where a message is from, and the drawing that it is about; the group that it begins with.
_PLACE = re.compile(
    r"(?:case(?:\.nml)?:? )?(?:(?:case(?:\.nml)? )?line (\d+): ?)?(?:drawing '([^']*)': )?"
)
_OWNER = re.compile(r"(\w+)(?: \w+)*: ")
_STATED = re.compile(r"(\w+)(?:\(\d+\))? = (-?[\d.]+(?:e[-+]?\d+)?)(?![\w.])")
#: Groups that a drawing has, each after the group of its name.
_OF_DRAWING = (
    *("section", "concrete", "steel", "bars", "row", "layout", "inner_layout", "ties", "spiral"),
    *("boundary", "curtain", "lap", "parameter"),
)
#: Groups of springs, which are made again where they are those of the drawing.
_SPRINGS = ("shear", "flexure", "axial_spring", "layer_spring", "layers")
#: Keys of a column and of its drawing that are made with its springs.
_MADE = {
    "column": ("n", "mass", "lengths", "depth", "rotary_inertia", "kinematics", "model"),
    "drawing": ("height", "axial_load", "n"),
}
#: Keys of the page that objects of the program call otherwise.
_OWNERS = {"bars": "row", "footing": "column"}


@cache
def building() -> dict[str, Any]:
    """Return the state that a building begins with: the ready house, pushed, beside a code."""
    text = house(3).to_namelist().replace("section-1", "C1").replace("section-2", "B1")
    text = text.replace("0.016 /", "0.016, steel = 1 /") + (
        "&loading drive = 'displacement', values = 0.288 /\n"
        "&target method = 'en_1998', spectrum = 'en_1998', ag = 0.25, soil = 'C' /\n"
        "&assess code = 'en_1998_3' /"
    )
    return {"cases": [groups_drawn(text)]}


def groups_drawn(text: str) -> list[Any]:
    """Return the groups of a text as the page has them, without what it has no need to say."""
    read = [group for group in groups_of_text(text) if group != _STATIC and group[0] != "units"]
    for _, values in read:
        values.pop("source", None)
    return [[*group] for group in read]


class RefusedError(Exception):
    """A request that is not answered: status and a text for who wrote the client."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class Faults:
    """The messages on one case.

    Parameters
    ----------
    groups : sequence of (str, dict)
        The groups of the case.

    Attributes
    ----------
    listed : list of dict
        The messages: "field" as "3.width", the number of the group and the key, or ""; "text"; "of"
        is the drawing that it is about.
    lines : list of int
        The lines at which the groups begin in the text that is read.
    """

    def __init__(self, groups: Groups = ()) -> None:
        self.listed: list[dict[str, str]] = []
        self.groups = groups
        self.lines: list[int] = []

    def add(self, field: str, text: str, drawing: str = "") -> None:
        """Add a message, once."""
        fault = {"field": field, "text": text, "of": drawing}
        if fault not in self.listed:
            self.listed.append(fault)

    @contextmanager
    def kept(self) -> Iterator[None]:
        """Keep the errors of the program, each line beside the field that it names."""
        try:
            yield
        except InputError as error:
            for name, line in error.faults:
                place = _PLACE.match(line)
                number, drawing = place.groups() if place else (None, None)
                text = line[place.end() :] if place else line
                self.add(self._field(name, text, number, drawing), text, drawing or "")

    def _field(self, name: str, text: str, line: str | None, drawing: str | None) -> str:
        """Return the group and the key that a message is about."""
        owner, _, key = name.rpartition(".")
        if not owner and (begins := _OWNER.match(text)):
            owner = begins[1]
        # Of "flexure spring of joint 0" the group
        owner = _OWNERS.get(owner, owner.partition(" ")[0])
        # The fault is in the group at its line, a row of bars at its face, or groups of its name.
        block = _block(self.groups, drawing)
        if line is not None and self.lines:
            places = [max(bisect_right(self.lines, int(line)) - 1, 0)]
        elif row := re.match(r"section: (top|bottom|side): ", text):
            places, key = [i for i in block if self.groups[i][1].get("face") == row[1]], "number"
        else:
            places = [i for i in block if self.groups[i][0] == owner]
            places = places or [i for i in block if key and key in self.groups[i][1]]
        # Of them the one whose value is missing, or the one that the message states.
        stated = _STATED.search(text)
        for i in places:
            value = self.groups[i][1].get(key)
            if (value is None and "is missing" in text) or (
                stated is not None and stated[1] == key and _is(value, float(stated[2]))
            ):
                return f"{i}.{key}"
        # Else the key that it names, or the first word of it that is one.
        words = [*([stated[1]] if stated else []), key, *re.findall(r"\w+", text)]
        for i in places:
            for word in words:
                if word in self.groups[i][1]:
                    return f"{i}.{word}"
        return f"{places[0]}.{key}" if places and key else ""


def _is(value: object, number: float) -> bool:
    """Return whether a value, or one of a list, is a number to six digits."""
    several = value if isinstance(value, list) else [value]
    return any(
        isinstance(one, int | float) and math.isclose(one, number, rel_tol=1e-5, abs_tol=0.0)
        for one in several
    )


def _block(groups: Groups, drawing: str | None) -> list[int]:
    """Return the numbers of the groups of a drawing, of all groups without one."""
    if drawing is None:
        return list(range(len(groups)))
    return next((block for name, block in drawings(groups) if name == drawing), [])


def drawings(groups: Groups) -> Iterator[tuple[str, list[int]]]:
    """Yield the name of each drawing and the numbers of its groups."""
    starts = [i for i, (name, _) in enumerate(groups) if name == "drawing"]
    for begin, end in pairwise([*starts, len(groups)]):
        block = [i for i in range(begin + 1, end) if groups[i][0] in _OF_DRAWING]
        yield str(groups[begin][1].get("name", "")), [begin, *block]


def key_of(value: object) -> str:
    """Return a text that is the same for the same state."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"))


def state_of(asked: Mapping[str, Any]) -> list[Any]:
    """Return the cases of a request; their values are checked later.

    Raises
    ------
    RefusedError
        If they are none.
    """
    state = asked.get("state")
    cases = state.get("cases") if isinstance(state, dict) else None
    if not isinstance(cases, list) or not 1 <= len(cases) <= _MOST_CASES:
        raise RefusedError(400, "state: cases must be a list of one or two")
    if not all(isinstance(case, str) or _is_groups(case) for case in cases):
        raise RefusedError(
            400, "state: a case is a text, or a list of groups: [name, {key: value}]"
        )
    if len(cases) > 1 and any(map(is_frame, cases)):
        raise RefusedError(400, "state: a frame stands alone")
    return cases


def _is_groups(case: object) -> bool:
    """Return whether a case has the form of groups: a list of [name, {key: value}]."""
    return isinstance(case, list) and all(
        isinstance(group, list)
        and len(group) == 2
        and isinstance(group[0], str)
        and isinstance(group[1], dict)
        for group in case
    )


def is_frame(case: Any) -> bool:
    """Return whether a case is a frame that the page draws."""
    return not isinstance(case, str) and any(name == "frame" for name, _ in case)


def first(groups: Groups, name: str) -> dict[str, Any]:
    """Return the values of the first group of a name; none if there is no such group."""
    return next((values for group, values in groups if group == name), {})


def title_of(case: Any) -> str:
    """Return the title of a case, at most 80 letters."""
    return "" if isinstance(case, str) else str(first(case, "case").get("title", ""))[:80]


# ---- a case of the page -------------------------------------------------------------------------


def text_of(groups: Groups, records: Mapping[str, GroundMotion], faults: Faults) -> str:
    """Return the groups as the text of a case file, with the records that they name.

    Parameters
    ----------
    groups : sequence of (str, dict)
        The groups.
    records : mapping
        The records that were opened, by their names.
    faults : Faults
        What cannot be written is added here, and where each group stands.
    """
    lines: list[str] = []
    for i, (name, values) in enumerate(groups):
        faults.lines.append(len(lines) + 1)
        if _WORD.fullmatch(name) is None:
            faults.add(f"{i}.", f"the group {_arguments.shown(name)} is not known")
            continue
        parts = []
        for key, value in _with_record(name, values, records, faults, i):
            try:
                parts.append(_entry(key, value))
            except InputError as error:
                faults.add(f"{i}.{key}", f"{name}: {error}")
        lines += f"&{name} {', '.join(filter(None, parts))} /".split("\n")
    return "\n".join(lines) + "\n"


def _with_record(
    name: str, values: dict[str, Any], records: Mapping[str, GroundMotion], faults: Faults, i: int
) -> Iterator[tuple[str, Any]]:
    """Yield the values of a group, those of a record in place of its name."""
    for key, value in values.items():
        if key not in _FILES or value is None:
            yield key, value
        elif name != "loading" or key != "file":
            text = (
                f"{key} = names a file, which a page does not read; start rbsdem explore CASE.nml"
            )
            faults.add(f"{i}.{key}", f"{name}: {text}")
        elif (motion := _record(str(value), records)) is None:
            again = f"{str(value).partition('#')[0]} is not open here: choose its file again"
            faults.add(f"{i}.file", again if value else "choose a file")
        else:
            yield "interval", motion.dt
            yield "values", motion.acceleration.tolist()


def _record(name: str, records: Mapping[str, GroundMotion]) -> GroundMotion | None:
    """Return the motion of a name: one that was opened, or "synthetic 3"."""
    made = _SYNTHETIC.fullmatch(name)
    return records.get(name) if made is None else synthetic(1, int(made[1]), dt=0.01)[0]


def _entry(key: str, value: Any) -> str:
    """Return a key and its value as a case file has them; nothing for one that is missing."""
    if value is None:
        return ""
    if _WORD.fullmatch(key) is None:
        raise InputError(f"{_arguments.shown(key)} is not known")
    if not isinstance(value, list):
        return f"{key} = {_written(key, value)}"
    if not value:
        raise InputError(f"{key} must not be empty")
    words = [_written(key, entry) for entry in value]
    rows = [", ".join(words[i : i + 16]) for i in range(0, len(words), 16)]
    return f"{key} = " + ",\n   ".join(rows)


def _written(key: str, value: Any) -> str:
    """Return one value as a case file has it; `key` is for messages."""
    if isinstance(value, bool):
        return ".true." if value else ".false."
    if isinstance(value, int | float):
        return repr(value).removesuffix(".0")
    if not isinstance(value, str):
        raise InputError(f"{key} = {_arguments.shown(value)} must be a number or a text")
    quoted = "".join(c if c.isprintable() else " " for c in value[:500]).replace("'", "''")
    return f"'{quoted}'"


def completed(groups: Groups) -> list[Group]:
    """Return the groups with what an earthquake needs: mass at the top, method, collapse."""
    made = [(str(name), dict(values)) for name, values in groups]
    loading = first(made, "loading")
    if loading.get("drive") != "ground_acceleration":
        return made
    frame, column = is_frame(made), first(made, "column")
    load = column.get("axial_load")
    if column and column.get("top_mass") is None and isinstance(load, int | float):
        column["top_mass"] = max(load, 0.0) / STANDARD_GRAVITY
    if not first(made, "analysis"):
        # A step that follows the record; the largest drift that is of interest.
        method = {"method": "newmark", "dt": 0.01} if frame else {"method": "auto"}
        made.append(("analysis", {**method, "collapse_drift": COLLAPSE_DRIFT}))
    return made


def case_of(
    case: Any, records: Mapping[str, GroundMotion], faults: Faults
) -> tuple[Case | None, list[str]]:
    """Return a case of the state, None if something is wrong with it, and the notes of the program.

    Parameters
    ----------
    case : list or str
        Its groups, or a text.
    records : mapping
        The records that were opened, by their names.
    faults : Faults
        What is wrong is added here.
    """
    made, notes = None, list[str]()
    with recorded() as told, faults.kept():
        if isinstance(case, str):
            refuse_files(case)
            made = case_of_text(case)
        else:
            groups = completed(case)
            text = text_of(groups, records, faults)
            _check_sizes(groups, faults)
            if not faults.listed:
                made = case_of_text(text)
    kinds = (AccuracyWarning,) if isinstance(made and made.column, Column) else (Warning,)
    notes = [str(one.message) for one in told if issubclass(one.category, kinds)]
    return made, list(dict.fromkeys(notes))


def _check_sizes(groups: Groups, faults: Faults) -> None:
    """Add faults for grids and numbers of cycles that a page is too small for."""
    for i, (_, values) in enumerate(groups):
        several = {key: value for key, value in values.items() if isinstance(value, list)}
        for key in ("storeys", "bays", "bays_x", "bays_y"):
            if len(several.get(key, ())) > _MOST_CELLS:
                faults.add(f"{i}.{key}", f"give at most {_MOST_CELLS} of them")
        # A single number of cycles is that at each amplitude.
        counts = several.get("cycles") or [values.get("cycles", 1)]
        each = len(several.get("amplitudes", ())) if len(counts) == 1 else 1
        many = each * sum(one for one in counts if isinstance(one, int | float))
        if many > _MOST_CYCLES:
            text = f"{many} cycles are too many here; at most {_MOST_CYCLES}"
            faults.add(f"{i}.cycles", f"cycles = {counts[0]}: {text}")


def refuse_files(text: str) -> None:
    """Refuse keys that name files, outside of texts and comments, which end with their line."""
    for number, line in enumerate(text.splitlines(), 1):
        bare = _TEXTS.sub("", line)
        if quote := re.search("['\"]", bare):
            raise InputError(f"line {number}: a text is not closed; put {quote[0]} at its end")
        if key := re.search(rf"\b({'|'.join(_FILES)})\b", bare, re.IGNORECASE):
            raise InputError(
                f"line {number}: {key[0].lower()} = names a file, which a page does not read; "
                "start rbsdem explore CASE.nml, which puts histories into the case"
            )


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
            groups = _drawn_again(groups_drawn(text), case_of_text(text).column)
    except InputError as error:
        return {"faults": [{"field": "", "text": str(error)}]}
    # A loading that the page has no fields for leaves the case a text.
    fields = all(_keep_record(values, keep) for name, values in groups if name == "loading")
    return {"state": {"cases": [groups if groups and fields else text]}}


def _keep_record(values: dict[str, Any], keep: Callable[[GroundMotion, str], str]) -> bool:
    """Put the name of a record in place of its values; return whether the page can show it."""
    if not values["drive"].startswith("ground_acceleration"):
        return bool(values["drive"] == "displacement")
    steps = np.diff(values.pop("time", [0.0, values.pop("interval", 0.0)]))
    if "values" not in values or values.get("unit", "m/s2") != "m/s2":
        return False
    if not steps[0] > 0.0 or not np.allclose(steps, steps[0], rtol=1e-6, atol=0.0):
        return False
    motion = GroundMotion(np.array(values.pop("values")), float(steps[0]))
    values["file"] = keep(motion, "record of the file")
    return True


def _drawn_again(groups: list[Any], column: Column | Frame) -> list[Any]:
    """Return the groups that the page draws; none of a column that is not as it would be drawn."""
    if isinstance(column, Frame):
        return groups if first(groups, "frame").get("storeys") else []
    if not first(groups, "drawing") or sum(name == "loading" for name, _ in groups) != 1:
        return []
    made: list[Any] = []
    for name, values in groups:
        if name not in _SPRINGS or values.get("joint") in (0, [0]):
            own = {key: one for key, one in values.items() if key not in _MADE.get(name, ())}
            made.append([name, {"top": "free"} | own if name == "column" else own])
    try:
        return made if case_of_text(text_of(made, {}, Faults(made))).column == column else []
    except InputError:
        return []


def sections_of(case: Any) -> dict[str, Section | None]:
    """Return the sections of a case by the names of their drawings; None for a wrong one."""
    sections: dict[str, Section | None] = {}
    parts: dict[str, list[dict[str, Any]]] = {}
    for name, block in drawings(case):
        # Materials are those of the drawing before it where it has none.
        named = {case[i][0] for i in block}
        parts = {n: parts[n] for n in ("concrete", "steel") if n in parts and n not in named}
        for i in block:
            values = {key: value for key, value in case[i][1].items() if value is not None}
            parts.setdefault(case[i][0], []).append(values)
        try:
            with recorded():
                sections[name] = section_of(parts)
        except (InputError, TypeError, ValueError, KeyError, AttributeError, OverflowError):
            # What is wrong is told by the reader of the case.
            sections[name] = None
    return sections


# ---- numbers for JSON ---------------------------------------------------------------------------


def numbers(values: Array) -> list[float | None]:
    """Return an array for JSON with six digits; None where it is not finite."""
    return [number(value) for value in np.asarray(values, dtype=np.float64).tolist()]


def number(value: float) -> float | None:
    """Return a number for JSON, as `numbers`."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


def shown_rows(displacement: Array, force: Array, most: int = _ROWS) -> NDArray[np.intp]:
    """Return the rows of a response that a figure needs: all, or the extremes of equal parts."""
    size = displacement.size
    if size <= most:
        return np.arange(size)
    kept = [0, size - 1]
    for part in np.array_split(np.arange(size), most // 4):
        for values in (displacement[part], force[part]):
            kept += [int(part[np.argmin(values)]), int(part[np.argmax(values)])]
    return np.unique(kept)
