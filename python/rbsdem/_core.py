"""The only importer of the compiled extension.

Names and values go in; arrays, a status and a message come back. Here a status becomes an
exception.
"""

from __future__ import annotations

import json
import math
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import cache
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from rbsdem import _arguments, _rbsdem
from rbsdem._arguments import (  # noqa: F401  for those that take these from here
    BEYOND_MEANING,
    Array,
    finite_vector,
    number,
    switch,
    vector,
    whole,
)
from rbsdem.errors import InputError, SolveError

#: Stands for a whole number that is not given (the constant `unset_integer` of the Fortran part).
UNSET_INTEGER = -int(np.iinfo(np.int32).max)

#: A number that was not given.
UNSET = -float(np.finfo(np.float64).max)

#: Whole numbers below this are exact as a float.
_EXACT = 1 << 53

_ANALYSIS_FAILED = 1
_LITTLE_ROOM = 3
_LONG_RUN = 4

#: Summary values that are whole numbers.
_COUNTS = ("steps", "rows", "events", "cut_steps")

#: Length of the name of a method; the reason for the program's choice follows it.
_METHOD_LENGTH = 20


def version() -> str:
    """Return the version of the compiled part."""
    return _text(_rbsdem.rbs_version_text())


def methods() -> list[dict[str, str]]:
    """Return the facts of the methods of analysis, a mapping from names to texts for each."""
    names, *rows = (line.split() for line in _text(_rbsdem.rbs_methods_text()).splitlines())
    return [dict(zip(names, row, strict=True)) for row in rows]


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
    the next number, ``key:5`` for the next five, ``key=word`` for a text (the module
    `rbs_bindings_statements`).
    """

    text: str
    numbers: list[float]

    def __add__(self, other: Statement) -> Statement:  # type: ignore[override]
        """Return the groups of both."""
        if not other.text:
            return self
        return Statement(f"{self.text}\n{other.text}", self.numbers + other.numbers)


def group(name: str, values: Mapping[str, Any]) -> Statement:
    """Return the statement of one group: names and values; None and empty lists are left out."""
    words, numbers = [name], list[float]()
    for key, value in values.items():
        if type(value) is float:
            words.append(key)
            numbers.append(value)
        elif value is None:
            continue
        elif isinstance(value, str):
            text = _one_line(value) if isinstance(value, Text) else word(value)
            words.append(f"{key}={text}")
        elif isinstance(value, (tuple, list)) or (isinstance(value, np.ndarray) and value.ndim):
            plain = all(type(i) is float or (type(i) is int and abs(i) < _EXACT) for i in value)
            items = value if plain else vector(value, f"{name}: {key}").tolist()
            if len(items):
                words.append(f"{key}:{len(items)}")
                numbers.extend(items)
        else:
            words.append(key)
            numbers.append(_number_or_switch(value, f"{name}: {key}"))
    return Statement("\t".join(words), numbers)


def _number_or_switch(value: Any, name: str) -> float:
    """Return what a key takes that is no word."""
    if isinstance(value, (bool, np.bool_)):
        return value
    try:
        return number(value, name)
    except InputError:
        given = _arguments.shown(value)
        raise InputError(f"{name} = {given} is neither a number nor a word") from None


def _one_line(text: str) -> str:
    """Return a text without the characters that separate keys and groups of a statement."""
    return "".join(character if character.isprintable() else " " for character in text)


def _crossing(statement: Statement) -> tuple[bytes, list[float]]:
    """Return a statement for f2py, which takes bytes but no characters beyond ASCII."""
    return statement.text.encode("utf-8", "replace"), statement.numbers


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
            elif mark == ":":
                values[key] = list(islice(numbers, int(rest)))
            else:
                values[key] = next(numbers)
        yield name, values


def typed(group: str, given: Mapping[str, Any]) -> dict[str, Any]:
    """Return values in the types of their keys; whole numbers and switches arrive as floats."""
    types = {"integer": int, "logical": bool}
    found = dict(given)
    for key in keys()["groups"][group]:
        name = key["name"]
        if name in found and key.get("values", 1) > 1:
            found[name] = several(found[name])
        elif name in found and key["kind"] in types:
            found[name] = types[key["kind"]](found[name])
    return found


def several(value: float | list[float]) -> list[float]:
    """Return a value of `groups` as a list; a list of one arrives as a number."""
    return value if isinstance(value, list) else [value]


def _split_item(item: str) -> tuple[str, str, str]:
    for mark in ("=", ":"):
        key, found, rest = item.partition(mark)
        if found and key.isidentifier():
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
    room = 1 << 16
    while True:
        text, length = _rbsdem.rbs_keys(room)
        if length <= room:
            found: dict[str, Any] = json.loads(text[:length])
            return found
        room = length


@cache
def quantities(
    opens: bool, with_base: bool = False, with_openings: bool = False, with_motion: bool = False
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names of the values of a row (joints: with an asterisk) and of a summary.

    `with_base`: whether the row has the forces at the base, as in time with damping;
    `with_openings`: whether it has the openings of layered joints; `with_motion`: whether it has
    the motion of the top.
    """
    rows, figures = _rbsdem.rbs_quantities(
        int(opens), int(with_base), int(with_openings), int(with_motion)
    )
    return tuple(_text(rows).split()), tuple(_text(figures).split())


def check_spring(statement: Statement, axial_load: float) -> None:
    """Raise `InputError` for parameters that the rule does not allow."""
    _raise(*_rbsdem.rbs_check_spring(*_crossing(statement), axial_load))


def spring_response(statement: Statement, axial_load: float, deformation: Array) -> Array:
    """Return the forces of a virgin spring along a path."""
    force, status, message = _rbsdem.rbs_spring_response(
        *_crossing(statement), axial_load, deformation
    )
    _raise(status, message)
    return force


#: Rows, the state at the end (None after a failure), summary values, the error that ended a run
#: early, and a note on its accuracy.
Run = tuple[Array, Array | None, dict[str, Any], SolveError | None, str]

#: Number of bodies, and what the rows hold: openings of axial springs, forces at the base, openings
#: of layered joints, motion of the top.
Shape = tuple[int, bool, bool, bool, bool]


def check_column(column: Statement) -> list[str]:
    """Raise `InputError` for everything wrong with a column; return notes on what is allowed."""
    status, message = _rbsdem.rbs_check_column(*_crossing(column))
    _raise(status, message)
    return [] if message.startswith(b" ") else _text(message).splitlines()


def to_namelist(statement: Statement) -> str:
    """Return the text of a case file."""
    room = 200 + 2 * len(statement.text) + 30 * len(statement.numbers)
    while True:
        text, length, status, message = _rbsdem.rbs_to_namelist(*_crossing(statement), room)
        _raise(status, message)
        if length <= room:
            return text[:length].decode("utf-8")
        room = length


def modes(column: Statement, unknowns: int, count: int) -> tuple[Array, Array, float, str]:
    """Return circular frequencies, shapes (one in each column), the stable step of RK4, a note."""
    omega, shapes, stable_step, status, message = _rbsdem.rbs_modes(
        *_crossing(column), unknowns, count
    )
    _raise(status, message)
    return omega, shapes, stable_step, _text(message)


def mass_matrix(column: Statement, unknowns: int, paper: bool) -> Array:
    """Return the mass matrix in the paper's or in the symmetric form."""
    mass, status, message = _rbsdem.rbs_mass_matrix(*_crossing(column), unknowns, int(paper))
    _raise(status, message)
    return mass


def cyclic(
    column: Statement,
    shape: Shape,
    by_force: bool,
    values: Array,
    axial_load: Array,
    before: Array,
    room: int,
    every: int | None,
    corners: int = 0,
) -> Run:
    """Follow a static path.

    `column` holds the settings of the analysis too; an empty `axial_load` is a constant one,
    an empty `before` a virgin column; `room` is the expected size of the state at the end;
    `shape` is the number of bodies, whether joints open, and whether the rows have the forces at
    the base and the openings of layered joints. With `corners`, their expected number, there are
    rows between the values too, where a spring leaves its line.
    """
    wanted = _rbsdem.rbs_kept_rows(values.size, UNSET_INTEGER if every is None else every) + corners
    figures = len(quantities(False)[1])
    while True:
        rows, after = _empty_rows(shape, wanted), np.empty(room)
        kept, ended, *rest = _rbsdem.rbs_cyclic(
            *_crossing(column),
            int(by_force),
            values,
            axial_load,
            before,
            int(corners > 0),
            rows,
            after,
            figures,
        )
        if ended <= room and kept <= wanted:
            return _finish(rows, kept, after[:ended], *rest)
        room, wanted = max(room, ended), max(wanted, kept)


def time_history(
    column: Statement,
    shape: Shape,
    time: Array,
    loads: Mapping[str, Array],
    initial: Array,
    opening_given: bool,
    before: Array,
    watches: Array,
    room: int,
    every: int | None,
    tell: Callable[[str], None],
) -> tuple[Run, Array]:
    """March through time; return the run, and where each watch is reached, shape (watches, 2).

    Only the Fortran part knows the number of rows, after it has planned the steps. Without `every`
    there is one row for each of `time`, unless the step does not divide the intervals. Where there
    is not enough room, the first call returns the number of rows and a second one computes them.
    `tell` is called with a note before a long run starts. `watches` are of shape (watches, 6), see
    `run_ensemble`; of each the time [s] and the displacement of the top [m] are returned, NaN where
    it is not reached.
    """
    for name, values in loads.items():
        if values.size != time.size:
            raise InputError(
                f"{name}: {values.size} values for {time.size} times; give one for each"
            )
    load = np.empty((time.size, len(loads)), order="F")
    for place, values in enumerate(loads.values()):
        load[:, place] = values
    figures = len(quantities(False)[1])
    wanted = time.size if every is None else 0
    told = False
    while True:
        rows, after = _empty_rows(shape, wanted), np.empty(room)
        wanted, ended, reached, *rest = _rbsdem.rbs_time_history(
            *_crossing(column),
            time,
            " ".join(loads),
            load,
            initial,
            int(opening_given),
            before,
            watches.T,
            int(told),
            rows,
            after,
            figures,
        )
        status, message = rest[2:]
        if status == _LONG_RUN:
            tell(_text(message))
            told, wanted = True, rows.shape[1]
        elif ended > room:
            room, wanted = ended, rows.shape[1]
        elif status != _LITTLE_ROOM:
            run = _finish(rows, wanted, after[:ended], *rest)
            if "force" not in loads:
                for name in ("peak_force", "displacement_at_peak_force"):
                    del run[2][name]
            return run, reached.T


def settings(given: Mapping[str, Any]) -> Statement:
    """Return the settings of an analysis as a statement, each as its key takes it."""
    kinds = {key["name"]: key["kind"] for key in keys()["groups"]["analysis"]}
    values: dict[str, Any] = {}
    for name, value in given.items():
        if kinds[name] == "logical":
            values[name] = int(switch(value, name))
        else:
            values[name] = str(value) if kinds[name] == "word" else number(value, name)
    return group("analysis", values)


@cache
def measures() -> tuple[str, ...]:
    """Return the names of the measures of a run of an ensemble."""
    return tuple(_text(_rbsdem.rbs_measures()).split())


#: Motions of the ground: times [s] and accelerations [m/s2].
Motions = Sequence[tuple[Array, Array]]

_AFTER, _AFTER_NUMBER = "\x1e", "\x1f"


def plan_ensemble(
    columns: Sequence[Statement],
    settings: Statement,
    watches: Sequence[Array],
    before: Sequence[Array],
    motions: Motions,
) -> tuple[Array, NDArray[np.int32], list[tuple[int, str]]]:
    """Return the seconds that a run is expected to take, whether lanes take it, and faults.

    The first two have shape (motions, columns). A fault is the number of a column, from 0, and a
    message; `watches` are those of each column, of shape (watches, 6): number of the limit state,
    joint, factors of slip, rotation and opening, threshold; at least one. `before` are the states
    that the runs of each column begin in; an empty one is at rest.
    """
    room = 1 << 16
    while True:
        seconds, in_lanes, text, length = _rbsdem.rbs_plan_ensemble(
            *_columns_crossing(columns, settings, watches, before),
            *_motions_crossing(motions),
            room,
        )
        if length <= room:
            return seconds, in_lanes, list(_numbered(text[:length]))
        room = length


def run_ensemble(
    columns: Sequence[Statement],
    settings: Statement,
    watches: Sequence[Array],
    before: Sequence[Array],
    motions: Motions,
    runs: tuple[NDArray[np.int32], NDArray[np.int32], Array],
    control: NDArray[np.int32],
    measures: int,
    kernel: int = 0,
) -> tuple[NDArray[np.int32], Array, dict[int, str]]:
    """Run columns under motions; return fates, measures (measures, runs) and errors by run.

    `runs` are the places of columns and motions, from 0, and the scales. `control` is shared: set
    its first number to stop, read in its second how many runs are done. `kernel` is 0 for the
    fastest lanes that the processor has, 1 to 3 for those of no higher level, -1 for none.
    """
    column, motion, scale = runs
    room = (1 << 16) + 300 * scale.size
    fates, values, text, length = _rbsdem.rbs_run_ensemble(
        *_columns_crossing(columns, settings, watches, before),
        *_motions_crossing(motions),
        column + np.int32(1),
        motion + np.int32(1),
        scale,
        kernel,
        control,
        measures,
        room,
    )
    return fates, values, dict(_numbered(text[: min(length, room)]))


def _columns_crossing(
    columns: Sequence[Statement],
    settings: Statement,
    watches: Sequence[Array],
    before: Sequence[Array],
) -> tuple[bytes, Array, NDArray[np.int32], Array, Array]:
    """Return statements, numbers, how many of all each column has, the watches, the states."""
    statements = [column + settings for column in columns]
    return (
        "".join(statement.text + _AFTER for statement in statements).encode("utf-8", "replace"),
        np.array([number for statement in statements for number in statement.numbers]),
        np.array(
            [
                (len(statement.numbers), len(watch), len(state))
                for statement, watch, state in zip(statements, watches, before, strict=True)
            ],
            dtype=np.int32,
        ).T,
        np.concatenate(watches).T,
        np.concatenate(before),
    )


def _motions_crossing(motions: Motions) -> tuple[Array, Array, NDArray[np.int32]]:
    return (
        np.concatenate([time for time, _ in motions]),
        np.concatenate([acceleration for _, acceleration in motions]),
        np.array([time.size for time, _ in motions], dtype=np.int32),
    )


def _numbered(text: bytes) -> Iterator[tuple[int, str]]:
    """Yield number, from 0, and text of each message."""
    for line in text.decode("utf-8", errors="replace").split(_AFTER)[:-1]:
        count, _, message = line.partition(_AFTER_NUMBER)
        yield int(count) - 1, message


def read_case(path: str | os.PathLike[str]) -> tuple[Statement, Array, Array, NDArray[np.int32]]:
    """Return a case file as statement, times, values of the five drives, and which of them act."""
    path = _arguments.file(path)
    raw = os.fsencode(path)
    size = os.path.getsize(path) if os.path.isfile(path) else 0
    # Enough room for most cases; if not, a second call has the room that the first one asked for.
    sizes = (4 * size + 1024, size // 2 + 64, size // 4 + 4096)
    while True:
        text, numbers, time, values, acting, wanted, status, message = _rbsdem.rbs_read_case(
            raw, *sizes
        )
        _raise(status, message)
        length, count, rows = (int(number) for number in wanted)
        if length <= sizes[0] and count <= sizes[1] and rows <= sizes[2]:
            statement = Statement(text[:length].decode("utf-8"), numbers[:count].tolist())
            return statement, time[:rows].copy(), values[:rows], acting
        sizes = (length, count, rows)


def named_protocol(
    name: str, reference: float | None, largest: float | None
) -> tuple[Array, NDArray[np.int32]]:
    """Return amplitudes and cycles of a protocol of the literature."""
    numbers = (UNSET if value is None else value for value in (reference, largest))
    steps, amplitudes, cycles, status, message = _rbsdem.rbs_named_protocol(name, *numbers)
    _raise(status, message)
    return amplitudes[:steps].copy(), cycles[:steps].copy()


def protocol(
    amplitudes: Array, negative: Array, cycles: NDArray[np.int32], repeats: int, points: int
) -> Array:
    """Return the points of a cyclic protocol; `negative` may be empty."""
    steps = int(cycles.sum()) if cycles.size > 1 else int(cycles[0]) * amplitudes.size
    size = max(4 * points * steps * repeats + 1, 1)
    if size > np.iinfo(np.int32).max:
        raise InputError(f"protocol: {size} points are too many; reduce cycles, repeats or points")
    values, status, message = _rbsdem.rbs_protocol(
        amplitudes, negative, cycles, repeats, points, size
    )
    _raise(status, message)
    return values


def spectrum(acceleration: Array, dt: float, period: Array, damping: float) -> Array:
    """Return peaks of relative displacement, relative velocity, absolute acceleration, a row each.

    Values that are not finite must not come here.
    """
    peaks: Array = _rbsdem.rbs_spectrum(acceleration, dt, period, damping)
    return np.ascontiguousarray(peaks)


def read_history(
    path: str | os.PathLike[str],
    length: str,
    force: str,
    layout: tuple[str, str, int] | None = None,
    columns: tuple[int, int] = (1, 2),
) -> tuple[str, Array, Array]:
    """Return name, displacements [m] and forces [N] of a history file.

    `length` and `force` are the units of the file; empty strings mean those given in the file. With
    a layout, which is separator, decimal point and the number of lines before the first row, the
    columns are taken by their numbers; else the file says what it has.
    """
    path = _arguments.file(path)
    # No row is shorter than two digits, a separator and an end of line.
    most = os.path.getsize(path) // 4 + 1 if os.path.isfile(path) else 1
    if most > np.iinfo(np.int32).max:
        raise InputError(f"{path}: the file is too large")
    # As bytes: f2py takes no characters beyond ASCII.
    separator, decimal, skip = layout or (",", ".", -1)
    marks = ord(separator), ord(decimal), skip
    answer = _rbsdem.rbs_read_history(
        os.fsencode(path), word(length), word(force), *marks, columns, most
    )
    rows, name, displacement, force, status, message = answer
    _raise(status, message)
    return _text(name), displacement[:rows].copy(), force[:rows].copy()


@cache
def section_quantities() -> dict[str, tuple[str, ...]]:
    """Return the names of the values that come back, by what they belong to.

    "section" and "spring" have figures; "point" and "shear" the values of a point of a
    moment-curvature and of a shear diagram; "profile" and "layer" those of layers.
    """
    kinds = ("section", "spring", "point", "shear", "profile", "layer")
    texts = _rbsdem.rbs_section_quantities()
    return {kind: tuple(_text(text).split(", ")) for kind, text in zip(kinds, texts, strict=True)}


def _named(kind: str, values: Array) -> dict[str, float]:
    return dict(zip(section_quantities()[kind], values.tolist(), strict=True))


def _named_rows(kind: str, rows: Array) -> dict[str, Array]:
    return {name: row.copy() for name, row in zip(section_quantities()[kind], rows, strict=True)}


def check_section(section: Statement) -> dict[str, float]:
    """Return figures of a section, or raise `InputError` for everything wrong with it."""
    names = section_quantities()["section"]
    figures, status, message = _rbsdem.rbs_check_section(*section, len(names))
    _raise(status, message)
    return _named("section", figures)


def axial_capacity(
    section: Statement, *, tension: str, confined: bool
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return least (tension) and largest axial load without curvature, and their moments."""
    statement = section + group("diagram", {"tension": tension, "confined": confined})
    load, moment, status, message = _rbsdem.rbs_axial_capacity(*statement)
    _raise(status, message)
    return tuple(load.tolist()), tuple(moment.tolist())


def concrete_response(concrete: Statement, tension: str, strain: Array) -> Array:
    """Return the stresses of unconfined concrete, compression positive."""
    statement = concrete + group("diagram", {"tension": tension})
    stress, status, message = _rbsdem.rbs_concrete_response(*statement, strain)
    _raise(status, message)
    return stress


def steel_response(steel: Statement, strain: Array) -> Array:
    """Return the stresses of steel."""
    stress, status, message = _rbsdem.rbs_steel_response(*steel, strain)
    _raise(status, message)
    return stress


def moment_curvature(
    section: Statement, settings: Mapping[str, Any], curvature: Array
) -> tuple[Array, Array]:
    """Return moments and strains for curvatures of one sign and increasing magnitude."""
    statement = section + group("diagram", settings)
    moment, strain, status, message = _rbsdem.rbs_moment_curvature(*statement, curvature)
    _raise(status, message)
    return moment, strain


def section_events(
    section: Statement, settings: Mapping[str, Any]
) -> tuple[list[dict[str, float]], bool]:
    """Return cracking, yield, peak, ultimate and the end, and whether the axial load was lost."""
    statement = section + group("diagram", settings)
    points, lost, status, message = _rbsdem.rbs_section_events(*statement)
    _raise(status, message)
    return [_named("point", column) for column in points.T], bool(lost)


def section_flexure(
    section: Statement, settings: Mapping[str, Any]
) -> tuple[list[dict[str, float]], dict[str, float]]:
    """Return cracking, yield, peak and ultimate, and the figures of the flexural spring."""
    statement = section + group("springs", settings)
    names = section_quantities()["spring"]
    points, figures, status, message = _rbsdem.rbs_section_flexure(*statement, len(names))
    _raise(status, message)
    return [_named("point", column) for column in points.T], _named("spring", figures)


class ShearRun(NamedTuple):
    """A shear diagram: its points, the layers at the last one, the knee if it is found, the end."""

    points: dict[str, Array]
    profile: dict[str, Array]
    knee: dict[str, float] | None
    end: dict[str, float]
    sheared: bool
    lost: bool


def section_shear(section: Statement, settings: Mapping[str, Any], curvature: Array) -> ShearRun:
    """Follow a shear diagram; `settings` has the number of layers."""
    statement = section + group("shear", settings)
    points, profile, kept, events, ends, status, message = _rbsdem.rbs_section_shear(
        *statement, max(1, settings["layers"]), curvature
    )
    _raise(status, message)
    found, sheared, lost = (bool(event) for event in events)
    return ShearRun(
        _named_rows("shear", points[:, :kept]),
        _named_rows("profile", profile),
        _named("shear", ends[:, 0]) if found else None,
        _named("shear", ends[:, 1]),
        sheared,
        lost,
    )


def section_strips(section: Statement, round_core: bool, number: int) -> tuple[Array, Array]:
    """Return centroids and areas of core and of cover in strips, a strip a column."""
    core, cover, status, message = _rbsdem.rbs_section_strips(*section, int(round_core), number)
    _raise(status, message)
    return core, cover


def layer_response(
    concrete: Statement, steel: Statement, settings: Mapping[str, Any], path: Array
) -> tuple[Array, Array]:
    """Return states of a layer along a path (a column each), and whether they carry the stress."""
    statement = concrete + steel + group("layer", settings)
    states, carried, status, message = _rbsdem.rbs_layer_response(*statement, path)
    _raise(status, message)
    return states, carried


def _empty_rows(shape: Shape, rows: int) -> Array:
    """Return the array that Fortran fills; each column is a row of the result."""
    bodies, *has = shape
    names = quantities(*has)[0]
    joints = sum(name.endswith("*") for name in names)
    return np.empty((len(names) + (bodies - 1) * joints, rows), order="F")


def _finish(
    rows: Array,
    kept: int,
    after: Array,
    figures: Array,
    method: bytes,
    status: int,
    message: bytes,
) -> Run:
    """Keep the rows that were filled; raise wrong input, return a failed analysis as an error."""
    error, note = None, ""
    if status == _ANALYSIS_FAILED:
        error = SolveError(_text(message))
    elif status:
        _raise(status, message)
    elif not message.startswith(b" "):
        note = _text(message)
    named: dict[str, Any] = dict(zip(quantities(False)[1], figures.tolist(), strict=True))
    for name in _COUNTS:
        named[name] = int(named[name])
    status = "collapsed" if named.pop("collapsed") else "completed"
    lost_joint = int(named.pop("lost_joint"))
    if lost_joint:
        status = "axial_failure"
        named["lost_joint"] = lost_joint
    else:
        for name in ("lost_axial_load", "axial_capacity", "fall", "fall_energy"):
            del named[name]
    if math.isnan(named["peak_floor_acceleration"]):
        del named["peak_floor_acceleration"]
    named["method"] = _text(method[:_METHOD_LENGTH])
    named["reason"] = _text(method[_METHOD_LENGTH:])
    named["status"] = "failed" if error else status
    state = None if error or not after.size else after.copy()
    return rows[:, :kept].T, state, named, error, note


def _raise(status: int, message: bytes) -> None:
    """Raise the exception that a status stands for."""
    if status == 0:
        return
    raise (SolveError if status == _ANALYSIS_FAILED else InputError)(_text(message))


def _text(message: bytes) -> str:
    """Return a message of Fortran without its padding."""
    return message.decode("utf-8", errors="replace").rstrip()
