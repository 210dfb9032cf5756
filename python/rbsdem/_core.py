"""The only importer of the compiled extension.

Names and values go in; arrays, a status and a message come back. Here a status becomes an
exception.
"""

from __future__ import annotations

import atexit
import json
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cache
from itertools import islice
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from rbsdem import _arguments, _rbsdem
from rbsdem._arguments import boolean, number, vector
from rbsdem._progress import bar_of_run
from rbsdem._types import Array, NDArray
from rbsdem.errors import InputError, SolveError

if TYPE_CHECKING:
    import socket

#: A number that was not given.
UNSET = -float(np.finfo(np.float64).max)

#: Whole numbers below this are exact as a float.
_EXACT = 1 << 53
_PLAIN = {float, int}

_ANALYSIS_FAILED = 1
_LONG_RUN = 3

#: Summary values that are whole numbers.
_COUNTS = (
    *("steps", "rows", "events", "cut_steps", "lost_joint"),
    *("snaps", "snap_member", "fallen_member", "snap_backs"),
)


def word(value: Any) -> str:
    """Return a name for the Fortran part, which knows valid names and refuses all others.

    Repeated blanks are removed, as Fortran reads only the start of a long word. Characters that
    f2py does not take are replaced.
    """
    return " ".join(str(value).split()).encode("ascii", "replace").decode()


class Text(str):
    """A text of the user, passed on unchanged; other strings are words known to Fortran."""


class Statement(NamedTuple):
    """Groups of keys with their values, on their way to or from Fortran.

    `text` has a line for each group: its name, then its keys, separated by tabs. ``key`` stands for
    the next number, ``key:5`` for the next five, ``key=word`` for a text, ``values:5`` for the
    parameters of the rule of a spring (the module `rbs_bindings_statements`).
    """

    text: str
    numbers: list[float]

    def __add__(self, other: Statement) -> Statement:  # type: ignore[override]
        """Return the groups of both."""
        if not other.text:
            return self
        return Statement(f"{self.text}\n{other.text}", self.numbers + other.numbers)


def joined(parts: Iterable[Statement | tuple[str, Mapping[str, Any]]]) -> Statement:
    """Return the groups of all parts: statements, and names of groups with their values."""
    made = [part if isinstance(part, Statement) else group(*part) for part in parts]
    filled = [part for part in made if part.text]
    numbers = [number for part in filled for number in part.numbers]
    return Statement("\n".join([part.text for part in filled]), numbers)


def group(name: str, values: Mapping[str, Any]) -> Statement:
    """Return the statement of one group: names and values; None and empty lists are left out."""
    words: list[str] = [name]
    numbers: list[float] = []
    for key, value in values.items():
        if type(value) is float or (type(value) is int and abs(value) < _EXACT):
            words.append(key)
            numbers.append(float(value))
        elif value is None:
            continue
        elif isinstance(value, str):
            text: str = value
            if not isinstance(value, Text):
                text = word(value)
            elif not value.isprintable():
                text = _arguments.one_line(value)
            words.append(f"{key}={text}")
        elif isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim):
            kinds = set(map(type, value))
            plain = kinds <= _PLAIN and (int not in kinds or max(map(abs, value)) < _EXACT)
            items = value if plain else vector(value, f"{name}: {key}").tolist()
            if len(items):
                words.append(f"{key}:{len(items)}")
                numbers.extend(items)
        else:
            words.append(key)
            numbers.append(_number_or_switch(value, f"{name}: {key}"))
    return Statement("\t".join(words), numbers)


def _number_or_switch(value: Any, name: str) -> float:
    """Return the number of a value that is no word."""
    if isinstance(value, (bool, np.bool_)):
        return float(value)
    try:
        return number(value, name)
    except InputError:
        told = _arguments.shown(value)
        raise InputError(f"{name} = {told} is neither a number nor a word") from None


class Answer(NamedTuple):
    """An answer of Fortran: text, values and rows, each of which may be empty, and a status.

    `kept` is what it holds beyond its text and values.
    """

    text: str
    values: Array
    rows: Array
    status: int
    kept: _Kept | None


_FLOAT = np.dtype(float).str


class _Kept:
    """An answer that Fortran keeps; the last object that refers to it releases it.

    Of its rows it is an array for numpy.
    """

    def __init__(
        self, answer: NDArray[np.int32], address: NDArray[np.int32], shape: tuple[int, int]
    ) -> None:
        self.answer = answer
        if shape[0]:
            self.__array_interface__ = {
                "shape": shape,
                "typestr": _FLOAT,
                "data": (int(address.view(np.intp)[0]), False),
                "version": 3,
            }

    def __del__(self, release: Callable[[NDArray[np.int32]], None] = _rbsdem.rbs_release) -> None:
        release(self.answer)


_NOTHING = np.empty(0)
_NO_CONTROL = np.zeros(2, np.int32)
_NO_STRUCTURE = np.zeros(2, np.int32)

#: Control words of runs that Ctrl-C ends.
_RUNNING: list[NDArray[np.int32]] = []


@cache
def _waker(_process: int) -> socket.socket:
    """Return the end of a socket pair that Python writes signals to, also while Fortran runs.

    A thread reads the other end, and ends the runs. A fork, with another number of process, gets
    a pair and a thread of its own.
    """
    import socket  # noqa: PLC0415

    read, write = socket.socketpair()
    write.setblocking(False)

    def watch() -> None:
        """End all runs when the number of SIGINT arrives."""
        with read:
            while number := read.recv(1):
                for control in _RUNNING:
                    if number[0] == signal.SIGINT:
                        control[0] = 1

    atexit.register(write.close)
    threading.Thread(target=watch, name="rbsdem interrupts", daemon=True).start()
    return write


@contextmanager
def _interruptible() -> Iterator[NDArray[np.int32]]:
    """Give a run its control word: Ctrl-C sets it, the run ends, and Python handles the signal.

    Signals reach the main thread alone. A program that has set a wakeup descriptor keeps it.
    """
    control = np.zeros(2, np.int32)
    if threading.current_thread() is not threading.main_thread():
        yield control
        return
    before = signal.set_wakeup_fd(_waker(os.getpid()).fileno(), warn_on_full_buffer=False)
    if before >= 0:
        signal.set_wakeup_fd(before)
    _RUNNING.append(control)
    try:
        with bar_of_run(control):
            yield control
    finally:
        _RUNNING.pop()
        signal.set_wakeup_fd(before)


def _ask(
    what: str,
    statement: Statement | str = "",
    control: NDArray[np.int32] = _NO_CONTROL,
    made: Made | None = None,
    **arrays: Any,
) -> Answer:
    """Return an answer of the Fortran part; its module `rbs_bindings_evaluate` lists all.

    Numbers, switches and arrays go under their names; None is left out. `made` is the structure
    that is asked about.
    """
    text, numbers = statement if isinstance(statement, Statement) else (statement, [])
    named = {k: np.asarray(v, float).ravel() for k, v in arrays.items() if v is not None}
    pieces = list(named.values())
    answer, address, sizes = _rbsdem.rbs_evaluate(
        what,
        # As bytes: f2py takes no characters beyond ASCII.
        text.encode("utf-8", "replace"),
        numbers,
        " ".join([f"{name}:{piece.size}" for name, piece in named.items()]),
        np.concatenate(pieces) if len(pieces) > 1 else pieces[0] if pieces else _NOTHING,
        _NO_STRUCTURE if made is None else made.address,
        control,
    )
    # Sizes of text, values and rows (`kept` rows of a width); whether a structure is kept too.
    status, length, count, width, kept, holds = sizes.tolist()
    # An answer without rows or structure is released when it has been read, an empty one at once.
    there = length or count or kept or holds
    raw, values = _rbsdem.rbs_read(answer, length, count) if there else (b"", _NOTHING)
    whole = _Kept(answer, address, (kept, width)) if kept or holds else None
    rows = np.asarray(whole) if kept else np.empty((0, width))
    return Answer(raw[:length].decode("utf-8", "replace"), values, rows, status, whole)


def evaluate(what: str, statement: Statement | str = "", **named: Any) -> Answer:
    """Return an answer; raise the exception that its status stands for."""
    answer = _ask(what, statement, **named)
    if answer.status:
        error = SolveError if answer.status == _ANALYSIS_FAILED else InputError
        raise error(answer.text)
    return answer


class Made:
    """A structure that Fortran has checked, and keeps for all analyses of it.

    Attributes
    ----------
    statement : Statement
        Its keys, as the groups of a case file.
    text : str
        Parts of a frame, and notes on the structure, a line each.
    values : ndarray
        Numbers of these parts.
    is_part : bool
        Whether it is a frame that others in its building may hold: it is laid out, and neither
        checked as a whole nor solved under its dead load until it is asked for alone.
    """

    def __init__(self, statement: Statement, is_part: bool = False) -> None:
        self.statement, self.is_part = statement, is_part
        what = "lay_out" if is_part else "check_structure"
        self.text, self.values, _, _, self._kept = evaluate(what, statement)

    @property
    def address(self) -> NDArray[np.int32]:
        """Number by which Fortran finds the structure; a part is first checked as a whole."""
        if self.is_part:
            vars(self).update(vars(Made(self.statement)))
        assert self._kept is not None
        return self._kept.answer

    def __reduce__(self) -> tuple[type[Made], tuple[Statement, bool]]:
        """Make it anew in another process."""
        return Made, (self.statement, self.is_part)


def version() -> str:
    """Return the version of the compiled part."""
    return evaluate("version").text


def methods() -> list[dict[str, str]]:
    """Return the facts of the methods of analysis, a mapping from names to texts for each."""
    names, *rows = (line.split() for line in evaluate("methods").text.splitlines())
    return [dict(zip(names, row, strict=True)) for row in rows]


def groups(statement: Statement) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield name and values of each group: a number, a list of numbers, or a text for each key."""
    numbers = iter(statement.numbers)
    for line in statement.text.splitlines():
        name, *items = line.split("\t")
        values: dict[str, Any] = {}
        for item in items:
            key, mark, rest = _split_item(item)
            if mark == "=":
                values[key] = rest
            elif key == "values" and "rule" in values:
                # Those of a spring; a loading has values of another kind.
                names = [each["name"] for each in keys()["rules"][values["rule"]]["keys"]]
                listed = zip(names, islice(numbers, int(rest)), strict=True)
                values |= {name: number for name, number in listed if number != UNSET}
            elif mark == ":":
                values[key] = list(islice(numbers, int(rest)))
            else:
                values[key] = next(numbers)
        yield name, values


def typed(group: str, raw: Mapping[str, Any]) -> dict[str, Any]:
    """Return values in the types of their keys; whole numbers and switches arrive as floats."""
    types = {"integer": int, "logical": bool}
    values = dict(raw)
    for key in keys()["groups"][group]:
        name = key["name"]
        if name in values and key.get("values", 1) > 1:
            values[name] = list(map(types.get(key["kind"], float), several(values[name])))
        elif name in values and key["kind"] in types:
            values[name] = types[key["kind"]](values[name])
    return values


def several(value: float | list[float]) -> list[float]:
    """Return a value of `groups` as a list; a list of one arrives as a number."""
    return value if isinstance(value, list) else [value]


def _split_item(item: str) -> tuple[str, str, str]:
    """Return key, mark ("=" or ":" or none) and rest of an item of a `Statement`."""
    for mark in ("=", ":"):
        key, there, rest = item.partition(mark)
        if there and key.isidentifier():
            return key, mark, rest
    return item, "", ""


@cache
def keys() -> dict[str, Any]:
    """Return the list of all keys, as ``rbsdem keys --json`` prints it.

    "groups" has a list of keys for each group of a case file; "rules" has "places" (where a spring
    of the rule may stand) and "keys" (its parameters) for each rule. A key has "name", "kind",
    "meaning" and, where they apply, "unit", "least", "least_open", "most", "most_open", "choices",
    "default", "optional" and "values" (how many there may be at most).
    """
    listed: dict[str, Any] = json.loads(evaluate("keys").text)
    return listed


@cache
def _quantities() -> Answer:
    """Return the names of what comes back, a line for each kind of it, and the limits of notes."""
    return evaluate("quantities")


def _names() -> list[str]:
    """Return lines of names: channels with units, measures, then the kinds of section values."""
    return _quantities().text.splitlines()


def note_limits() -> tuple[float, float, float]:
    """Return beyond what notes are given: rotation [rad], missed energy, ground peak [m/s2]."""
    rotation, energy, ground = _quantities().values.tolist()
    return rotation, energy, ground


@cache
def units() -> dict[str, str]:
    """Return the units of all values that a row may hold, by name."""
    pairs = (channel.partition(" ") for channel in _names()[0].rstrip(";").split(";"))
    return {name: unit for name, _, unit in pairs}


#: Arrays by name in the order of the channels, the state at the end (None after a failure), summary
#: values, the error that ended a run early, and a note on its accuracy.
Run = tuple[dict[str, Array], Array | None, dict[str, Any], SolveError | None, str]


def cyclic(
    structure: Made,
    settings: Statement,
    by_force: bool,
    target: Array,
    axial_load: Array | None,
    before: Array | None,
    corners: bool = False,
    with_end: bool = True,
) -> Run:
    """Follow a static path through displacements or forces.

    Without `axial_load` it is constant, without `before` the column is virgin. With `corners` there
    are rows between the targets too, where a spring leaves its line. Without `with_end` there is no
    state at the end.
    """
    inputs: dict[str, Any] = {"by_force": by_force, "target": target, "axial_load": axial_load}
    inputs |= {"before": before, "corners": corners, "without_end": not with_end}
    with _interruptible() as control:
        answer = _ask("cyclic", settings, control, structure, **inputs)
    return _finish(answer, answer.values)


def time_history(
    structure: Made,
    settings: Statement,
    time: Array,
    loads: Mapping[str, Array],
    initial: Array | None,
    opening_given: bool,
    before: Array | None,
    thresholds: Array,
    tell: Callable[[str], None],
) -> tuple[Run, Array]:
    """March through time; return the run, and where thresholds are reached, shape (m, 2).

    `tell` is called with a note before a long run starts. `thresholds` are of shape (m, 6), see
    `batch`; of each the time [s] and the displacement of the top [m] are returned, NaN where
    it is not reached.
    """
    inputs: dict[str, Any] = {"time": time, "watches": thresholds, "initial": initial}
    inputs |= {"opening_given": opening_given, "before": before, **loads}
    # The solver returns at once from a run that will be long, unless the user was told of it.
    told = False
    while True:
        with _interruptible() as control:
            answer = _ask("time_history", settings, control, structure, told=told, **inputs)
        if answer.status != _LONG_RUN:
            break
        tell(answer.text)
        told = True
    count = len(thresholds)
    run = _finish(answer, answer.values[2 * count :])
    return run, answer.values[: 2 * count].reshape(2, count).T


def settings(keywords: Mapping[str, Any]) -> Statement:
    """Return the settings of an analysis as a statement, each as its key takes it."""
    kinds = {key["name"]: key["kind"] for key in keys()["groups"]["analysis"]}
    values: dict[str, Any] = {}
    for name, value in keywords.items():
        if kinds[name] == "logical":
            values[name] = int(boolean(value, name))
        else:
            values[name] = str(value) if kinds[name] == "word" else number(value, name)
    return group("analysis", values)


@cache
def measures() -> tuple[str, ...]:
    """Return the names of the measures of a run of an ensemble."""
    return tuple(_names()[1].split())


#: Motions of the ground: times [s] and accelerations along x and y [m/s2].
Motions = Sequence[tuple[Array, Array, Array]]

_AFTER, _AFTER_NUMBER = "\x1e", "\x1f"


def batch(
    columns: Sequence[Statement],
    settings: Statement,
    thresholds: Sequence[Array],
    before: Sequence[Array],
    motions: Motions,
) -> dict[str, Any]:
    """Return columns and motions in one: all statements, and how many of everything each has.

    `thresholds` are those of each column, of shape (m, 6): number of the limit state, joint,
    factors of slip, rotation and opening, threshold; at least one. `before` are the states that the
    runs of each column begin in; an empty one is at rest. `motions` are times and accelerations
    along x and y, those along y empty if there are none.
    """
    statements = [column + settings for column in columns]
    sizes = zip(statements, thresholds, before, strict=True)
    return {
        "statement": Statement(
            "".join(statement.text + _AFTER for statement in statements),
            [number for statement in statements for number in statement.numbers],
        ),
        "counts": [
            (len(statement.numbers), len(watch), len(state)) for statement, watch, state in sizes
        ],
        "watches": np.concatenate(thresholds),
        "before": np.concatenate(before),
        "time": np.concatenate([time for time, *_ in motions]),
        "acceleration": np.concatenate([along_x for _, along_x, _ in motions]),
        "across": np.concatenate([along_y for *_, along_y in motions]),
        "points": [(time.size, along_y.size) for time, _, along_y in motions],
    }


def plan_ensemble(
    batch: Mapping[str, Any],
) -> tuple[Array, NDArray[np.int32], list[tuple[int, str]]]:
    """Return the seconds that a run will take about, whether lanes take it, and faults.

    The first two have shape (motions, columns). A fault is the number of a column, from 0, and a
    message.
    """
    answer = _ask("plan_ensemble", **batch)
    seconds, in_lanes = np.split(answer.rows.T, 2)
    return seconds, in_lanes.astype(np.int32), list(_numbered(answer.text))


def run_ensemble(
    batch: Mapping[str, Any], control: NDArray[np.int32], **runs: Any
) -> tuple[NDArray[np.int32], Array, dict[int, str]]:
    """Run columns under motions; return fates, measures (measures, runs) and errors by run.

    Of each run `columns` and `motions` are the places, from 1, and `scales` the scale; `measures`
    and `storeys` say how much is measured: after the measures come the largest drifts of so many
    storeys, and those at the end. `control` is shared: set its first number to stop, read in its
    second how many runs are done. `level` is 0 for the fastest lanes that the processor has, 1 to 3
    for those of no higher level, -1 for none.
    """
    answer = _ask("run_ensemble", control=control, **runs, **batch)
    values = answer.rows.T
    return values[0].astype(np.int32), values[1:], dict(_numbered(answer.text))


def _numbered(text: str) -> Iterator[tuple[int, str]]:
    """Yield number, from 0, and text of each message."""
    for line in text.split(_AFTER)[:-1]:
        count, _, message = line.partition(_AFTER_NUMBER)
        yield int(count) - 1, message


def read_case(path: str | os.PathLike[str]) -> tuple[Statement, Array, Array, NDArray[np.int32]]:
    """Return a case file as statement, times, values of the five drives, and which of them act."""
    path = _arguments.file(path)
    text, numbers, rows, *_ = evaluate("read_case", os.fsdecode(path))
    acting = rows[1:, 0].astype(np.int32)
    return Statement(text, numbers.tolist()), rows[0, 1:].copy(), rows[1:, 1:].T, acting


def read_groups(path: str | os.PathLike[str]) -> Statement:
    """Return the groups of a case file, in SI, with its loadings as they are given."""
    text, numbers, *_ = evaluate("read_groups", os.fsdecode(_arguments.file(path)))
    return Statement(text, numbers.tolist())


@cache
def section_quantities() -> dict[str, tuple[str, ...]]:
    """Return the names of the values that come back, by what they belong to.

    "section" and "spring" have figures; "point" and "shear" the values of a point of a
    moment-curvature and of a shear diagram; "profile" those of layers.
    """
    kinds = ("section", "spring", "point", "shear", "profile")
    return {kind: tuple(text.split(", ")) for kind, text in zip(kinds, _names()[2:], strict=True)}


def named(kind: str, values: Array) -> dict[str, float]:
    """Return values of a section by their names in `section_quantities`."""
    return dict(zip(section_quantities()[kind], values.tolist(), strict=True))


def axial_capacity(
    section: Statement, *, tension: str, confined: bool
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return least (tension) and largest axial load without curvature, and their moments."""
    statement = section + group("diagram", {"tension": tension, "confined": confined})
    least, most, at_least, at_most = evaluate("axial_capacity", statement).values.tolist()
    return (least, most), (at_least, at_most)


def _finish(answer: Answer, values: Array) -> Run:
    """Name arrays and figures of a run; raise wrong input, return a failed analysis as an error."""
    if answer.status not in (0, _ANALYSIS_FAILED):
        raise InputError(answer.text)
    method, reason, status, channels, figures, note = answer.text.split("\n", 5)
    words = channels.split()
    arrays, at = dict[str, Array](), 0
    for name, joints in zip(words[::2], map(int, words[1::2]), strict=True):
        arrays[name] = answer.rows[:, at : at + joints] if joints else answer.rows[:, at]
        at += max(joints, 1)
    error = SolveError(note) if answer.status else None
    names = figures.split()
    summary: dict[str, Any] = dict(zip(names, values.tolist(), strict=False))
    summary |= {name: int(summary[name]) for name in _COUNTS if name in summary}
    summary |= {"method": method, "reason": reason, "status": "failed" if error else status}
    after = values[len(names) :]
    state = None if error or not after.size else after.copy()
    return arrays, state, summary, error, "" if error else note
