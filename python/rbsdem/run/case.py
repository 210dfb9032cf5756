"""Case files of the executable, read into Python by the same reader, and saved results."""

from __future__ import annotations

import contextlib
import json
import os
import tempfile
import zipfile
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from pathlib import Path
from typing import Any, cast

import numpy as np

from rbsdem import _core
from rbsdem._types import Array
from rbsdem.errors import InputError, SolveError
from rbsdem.model.column import SPRING_GROUPS, Column, Damping, Footing, notes_off
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.frame_result import FrameResult
from rbsdem.run.groups import (
    building_in_plan,
    building_of,
    drawing_of,
    drawn_column,
    frame_of,
    layered_column,
    springs_of_joints,
)
from rbsdem.run.response import cyclic, time_history
from rbsdem.run.rows import FORMAT, FORMAT_VERSION, SAVED, Result, check_ending, same
from rbsdem.run.solver import STATIC, Solver
from rbsdem.section.frame import Frame, Structure
from rbsdem.section.plan import Building

#: Arguments of analyses that no case file has.
_NO_SETTINGS = ("initial", "corners", "progress")
_DRIVES = (
    *("displacement", "force", "ground_acceleration", "vertical_acceleration", "axial_load"),
    "ground_acceleration_y",
)


@dataclass(frozen=True, eq=False)
class Case:
    """A case file: a column, its loading and its analysis.

    Attributes
    ----------
    title : str
        Title of the case.
    column : Column or Frame
        The structure.
    method : str
        "static" or "newton", or a method of `time_history`.
    names_method : bool
        Whether the file names it, or it follows from the loading.
    time : ndarray, shape (m,)
        Times of all loadings [s]; in a static analysis the numbers of the points. Empty for a case
        without a loading.
    displacement, force : ndarray, shape (m,), or None
        Displacement of the top [m] or lateral force [N].
    ground_acceleration, vertical_acceleration : ndarray, shape (m,), or None
        Acceleration of the ground to +x and upward [m/s2].
    axial_load : ndarray, shape (m,), or None
        Axial load at the top in place of that of the column [N].
    ground_acceleration_y : ndarray, shape (m,), or None
        Acceleration of the ground along y of a building [m/s2].
    settings : dict
        The settings of the analysis that were given, as keywords of `cyclic` or `time_history`: dt,
        events, tolerance, rho_infinity, collapse_drift, allow_unstable, max_seconds, every,
        openings, motion, initial (path of a state).
    target, records : dict
        The values of `&target` and `&records`, by their keys; empty without them.
    assess, limit : list of dict
        Those of each `&assess` and `&limit`. `rbsdem.codes.judge` does what they ask for.
    files : dict
        Paths of `&output`, from the folder of the case: "file", "state".
    """

    title: str
    column: Any  # as the file has it, so that type checkers let it pass as either
    method: str
    time: Array
    displacement: Array | None
    force: Array | None
    ground_acceleration: Array | None
    vertical_acceleration: Array | None
    axial_load: Array | None
    settings: dict[str, Any]
    target: dict[str, Any] = field(default_factory=dict)
    records: dict[str, Any] = field(default_factory=dict)
    assess: list[dict[str, Any]] = field(default_factory=list)
    limit: list[dict[str, Any]] = field(default_factory=list)
    files: dict[str, str] = field(default_factory=dict)
    ground_acceleration_y: Array | None = None
    names_method: bool = True

    @property
    def dynamic(self) -> bool:
        """Whether the analysis is one in time."""
        return self.method not in STATIC

    @property
    def solver(self) -> Solver:
        """The method in time and its settings that were given; nothing for a static case."""
        if not self.dynamic:
            return Solver()
        settings = {"method": self.method} | self.settings
        return cast(
            Solver, {name: settings[name] for name in Solver.__annotations__ if name in settings}
        )

    @property
    def loads(self) -> dict[str, Array]:
        """The loadings that are there, by the names of the attributes."""
        histories = {name: getattr(self, name) for name in _DRIVES}
        return {name: values for name, values in histories.items() if values is not None}

    def run(
        self, column: Structure | None = None, **changes: Any
    ) -> ColumnResult | FrameResult | BuildingResult:
        """Solve the case as the executable does.

        Parameters
        ----------
        column : Column, optional
            Another column in place of the case's.
        **changes
            Keywords of `cyclic` or `time_history` that replace or add to `settings`.

        Returns
        -------
        Result
            The result of `cyclic` or `time_history`; their exceptions are raised too.
        """
        column = self.column if column is None else column
        if not self.time.size:
            raise InputError(
                "the case has no loading; give it a group &loading, or run its column: "
                "rbsdem.cyclic(case.column, ...), rbsdem.time_history(case.column, ...)"
            )
        keywords: dict[str, Any] = self.loads | self.settings
        try:
            keywords["method"] = self.method
            result: ColumnResult | FrameResult | BuildingResult
            if self.dynamic:
                result = time_history(column, **(keywords | {"time": self.time} | changes))
            else:
                result = cyclic(column, **(keywords | changes))
        except SolveError as error:
            if error.result is not None:
                error.result = replace(error.result, case=self)
            raise
        return replace(result, case=self)

    def plain_column(self, what: str) -> Column:
        """Return the column; `InputError` for a frame, which an analysis does not take."""
        if isinstance(self.column, Frame):
            raise InputError(f"{what} is for columns, and the case has a frame; give it a &column")
        column: Column = self.column
        return column

    def to_namelist(self, *, springs: bool = False) -> str:
        """Return the text of a case file, from which the same case comes back.

        Histories are written into the text itself, with all their digits.

        Parameters
        ----------
        springs : bool, optional
            Whether a frame that was drawn is written with all its springs, as the executable takes
            it; else by its sections.
        """
        head = {"title": _core.Text(self.title) if self.title else None}
        structure = self.column._statement if springs else self.column._groups()
        parts = [_core.group("case", head), structure]
        time = self.time if self.dynamic else None
        for name, values in self.loads.items():
            parts.append(_core.group("loading", {"drive": name, "time": time, "values": values}))
        settings = dict(self.settings)
        output = {name: settings.pop(name, None) for name in ("every", "openings", "motion")}
        if "initial" in settings:
            settings["initial"] = _core.Text(os.fspath(settings["initial"]))
        method = self.method if self.names_method else None
        parts.append(_core.group("analysis", {"method": method} | settings))
        for name, given in (("target", self.target), ("records", self.records)):
            parts.append(_core.group(name, _texts(given)))
        for name, several in (("assess", self.assess), ("limit", self.limit)):
            parts += [_core.group(name, _texts(given)) for given in several]
        parts.append(_core.group("output", output | _texts(self.files)))
        return _core.evaluate("to_namelist", _core.joined(parts)).text

    def __eq__(self, other: object) -> bool:
        """Return whether another case has the same column, histories and settings, bit for bit."""
        if not isinstance(other, Case):
            return NotImplemented
        names = [field.name for field in fields(self)]
        return all(same(getattr(self, name), getattr(other, name)) for name in names)

    __hash__ = None  # type: ignore[assignment]


def read_case(path: str | os.PathLike[str]) -> Case:
    """Read a case file of the executable, with its histories.

    A case without a loading has a column and settings to be used, as for `rbsdem.ensemble`.
    Loadings given at different times are interpolated linearly to common times.

    Parameters
    ----------
    path : str or path-like
        Path of the namelist file; paths of histories are relative to its folder.

    Raises
    ------
    InputError
        With a line for each error, as `rbsdem check` reports them.
    """
    statement, time, values, acting = _core.read_case(path)
    groups: dict[str, list[dict[str, Any]]] = {}
    drawings: list[dict[str, list[dict[str, Any]]]] = []
    for name, values_of in _core.groups(statement):
        groups.setdefault(name, []).append(values_of)
        # Groups of a drawing follow it.
        drawings += [{}] if name == "drawing" else []
        if drawings:
            drawings[-1].setdefault(name, []).append(values_of)
    # Springs and parts of a drawing stand several times, and are read from `groups`.
    last_of = {name: values_of[-1] for name, values_of in groups.items()}
    settings = _core.typed("analysis", last_of.get("analysis", {}))
    settings |= _core.typed("output", last_of.get("output", {}))
    # The histories already end at the duration.
    settings.pop("duration", None)
    more: dict[str, Any] = {
        "target": _core.typed("target", last_of.get("target", {})),
        "records": _core.typed("records", last_of.get("records", {})),
        **{
            name: [_core.typed(name, values_of) for values_of in groups.get(name, [])]
            for name in ("assess", "limit")
        },
        "files": {name: settings.pop(name) for name in ("file", "state") if name in settings},
    }
    if "path" in more["records"]:
        folder = os.path.dirname(os.fspath(path))
        more["records"]["path"] = os.path.join(folder, more["records"]["path"])
    if "initial" in settings:
        settings["initial"] = os.path.join(os.path.dirname(os.fspath(path)), settings["initial"])
    if "frame" in groups:
        in_plan = "bays_x" in groups["frame"][-1]
        make = building_in_plan if in_plan else building_of if "plane" in groups else frame_of
        frame: Frame = make(groups, drawings)
        return _case_of(frame, last_of, settings, time, values, acting, more)
    column = _core.typed("column", last_of["column"])
    column |= springs_of_joints(groups, column.get("n", 1) + (column.get("top") == "fixed"))
    # Joint 0 is beneath a footing.
    beneath = {name: column.pop(f"{name}_0", None) for name in SPRING_GROUPS}
    footing = {
        name: column.pop(f"footing_{name}")
        for name in ("mass", "inertia", "height")
        if f"footing_{name}" in column
    }
    if beneath["shear"] is not None:
        column["footing"] = Footing(**beneath, **footing)
    if "damping" in last_of:
        column["damping"] = Damping(**_core.typed("damping", last_of["damping"]))
    column = {"mass": None} | column
    made: Column
    if "drawing" not in groups:
        made = Column(**column)
    elif "flexure" not in column:
        made = drawn_column(groups, column)
    else:
        made = layered_column(drawing_of(groups), column)
    return _case_of(made, last_of, settings, time, values, acting, more)


def _case_of(
    structure: Column | Frame,
    groups: dict[str, dict[str, Any]],
    settings: dict[str, Any],
    time: Array,
    values: Array,
    acting: Any,
    more: dict[str, Any],
) -> Case:
    """Return the case of a structure and of the loadings that act.

    `values` has a column for each name in `_DRIVES`; `acting` says which of them act. `groups` has
    the values of the last group of each name, `more` the other fields of `Case`.
    """
    loads: dict[str, Any] = {
        name: np.ascontiguousarray(values[:, i]) if acting[i] else None
        for i, name in enumerate(_DRIVES)
    }
    title, method = groups.get("case", {}).get("title", ""), settings.pop("method", None)
    more["names_method"] = method is not None
    return Case(title, structure, method or "static", time, **loads, settings=settings, **more)


def _texts(values: dict[str, Any]) -> dict[str, Any]:
    """Return values whose texts are passed on unchanged."""
    return {k: _core.Text(v) if isinstance(v, str) else v for k, v in values.items()}


def case_of_text(text: str) -> Case:
    """Return the case of a text, which its reader takes from a file; see `read_case`."""
    with _as_file(text) as path:
        return read_case(path)


def groups_of_text(text: str) -> list[tuple[str, dict[str, Any]]]:
    """Return the groups of the text of a case in SI, with its loadings as they are given.

    Raises
    ------
    InputError
        As `read_case`.
    """
    with _as_file(text) as path:
        return [
            (name, _core.typed(name, values))
            for name, values in _core.groups(_core.read_groups(path))
        ]


@contextlib.contextmanager
def _as_file(text: str) -> Iterator[Path]:
    """Give the path of a file with a text; errors do not name it."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        path = Path(folder) / "case.nml"
        path.write_bytes(text.encode())
        try:
            yield path
        except InputError as error:
            if str(path) not in str(error):
                raise
            raise InputError(str(error).replace(str(path), "case")) from None


def case_of(result: Result) -> Case:
    """Return the case of a result: what was run, or its structure, loading and settings.

    Parameters
    ----------
    result : Result or FrameResult
        The result. The state that it began in is no part of its case.
    """
    if isinstance(result.case, Case):
        return result.case
    settings = {name: value for name, value in result.call.items() if name not in _NO_SETTINGS}
    loads = {name: settings.pop(name, None) for name in _DRIVES}
    size = next(values.size for values in loads.values() if values is not None)
    method = settings.pop("method", "auto" if result.dynamic else "static")
    time = settings.pop("time", np.arange(float(size)))
    return Case("", result.structure, method, time, **loads, settings=settings)


#: Errors that readers of damaged archives raise.
_DAMAGED = (
    OSError, ValueError, KeyError, TypeError, EOFError, NotImplementedError, zipfile.BadZipFile,
    zlib.error,
)  # fmt: skip


def read_result(path: str | os.PathLike[str]) -> ColumnResult | FrameResult | BuildingResult:
    """Read a result that `Result.save` or `FrameResult.save` wrote.

    Parameters
    ----------
    path : path-like
        The file.

    Returns
    -------
    Result or FrameResult
        Equal to the one that was saved, bit for bit.

    Raises
    ------
    InputError
        If the file is not there, is none of these, is damaged, or was written by a later version.
    """
    check_ending(path)
    if not Path(path).is_file():
        raise InputError(f"{os.fspath(path)}: there is no such file; check the path")
    try:
        about, arrays = _read_npz(path)
        known = about["format"] == FORMAT
    except _DAMAGED as error:
        raise InputError(
            f"{os.fspath(path)}: this is no saved result, or it is damaged ({error}); "
            "Result.save writes one"
        ) from error
    if not known:
        raise InputError(f"{os.fspath(path)}: this is no saved result; Result.save writes one")
    if about["format_version"] > FORMAT_VERSION:
        raise InputError(
            f"{os.fspath(path)}: written by rbsdem {about['version']} in a later format; "
            f"this is rbsdem {_core.version()}, so update it"
        )
    try:
        return _result(about, arrays)
    except (KeyError, TypeError) as error:
        raise InputError(f"{os.fspath(path)}: the file is damaged; {error} is missing") from error


def _together(value: Any, arrays: dict[str, Any]) -> Any:
    """Return a value with its arrays, which the saving of a result has put aside by their names."""
    if not isinstance(value, dict):
        return value
    if set(value) == {"array"}:
        return arrays[value["array"]]
    return {key: _together(each, arrays) for key, each in value.items()}


def _read_npz(path: str | os.PathLike[str]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the record of a saved result (json in the array "about"), and its other arrays."""
    with open(path, "rb") as opened, np.load(opened, allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    about: dict[str, Any] = json.loads(str(arrays.pop("about")))
    return about, arrays


def _result(
    about: dict[str, Any], arrays: dict[str, Any]
) -> ColumnResult | FrameResult | BuildingResult:
    """Return a result from the texts and arrays of its file."""
    with notes_off():
        # Losses at a time are refused in a static case.
        method = "auto" if about["summary"]["analysis"] == "dynamic" else "static"
        analysis = f"\n&analysis method = '{method}' /\n"
        structure = case_of_text(about["column"] + analysis).column
        case = None if about["case"] is None else case_of_text(about["case"])
        if about.get("drawing"):
            with contextlib.suppress(InputError):
                drawn = case_of_text(about["drawing"] + analysis).column
                structure = drawn if drawn == structure else structure
    saved = {name: _together(about[name], arrays) for name in SAVED}
    kind: Any = FrameResult if isinstance(structure, Frame) else ColumnResult
    kind = BuildingResult if isinstance(structure, Building) else kind
    return kind(structure=structure, case=case, **saved)  # type: ignore[no-any-return]
