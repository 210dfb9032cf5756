"""Results of columns and frames: loops, tables, states, and one file that describes itself.

Works to cite for a result are those of its rules, methods and fitted relations, and rbsdem.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal

import numpy as np

from rbsdem import _arguments, _core, _package
from rbsdem._files import atomic_write, data_frame
from rbsdem._types import Array, DataFrame, Self
from rbsdem.curves.envelope import Envelope, Idealisation, Method, strength_loss
from rbsdem.curves.envelope import envelope as curve_envelope
from rbsdem.curves.metrics import HalfCycles, half_cycles, loop_pair
from rbsdem.errors import InputError, SolveError
from rbsdem.model.column import Column
from rbsdem.run.accuracy import ErrorEstimate, Errors, refined_error
from rbsdem.run.limit_states import LimitStates
from rbsdem.run.limit_states import limit_states as find_limit_states
from rbsdem.run.solve import STATE_HEAD, follow, last_state
from rbsdem.run.solver import METHODS
from rbsdem.run.walls import WallAccuracy, wall_accuracy
from rbsdem.section.frame import Frame, Structure

#: Where a work has appeared, by its kind; of articles with volume and pages.
_FIELDS = {"techreport": "institution", "inproceedings": "booktitle", "misc": "note"}
_ARTICLE = re.compile(r"(?P<journal>.*) (?P<volume>\d+), (?P<pages>\d+--\d+)")


def parts_of(structure: Structure, method: str) -> set[str]:
    """Return the parts of an analysis that works stand behind, as `data/references.csv` names them.

    Parameters
    ----------
    structure : Column or Frame
        The structure.
    method : str
        The method that solved it.
    """
    parts = {"all", f"method:{method}"}
    for _, values in _core.groups(structure._groups()):
        if "rule" in values:
            parts.add(f"rule:{values['rule']}")
    if isinstance(structure, Frame):
        parts |= {f"rule:{spring.rule}" for spring in structure.parts.springs}
        for name in ("shear_drift", "failure_drift"):
            if any(getattr(kind, name) is not None for kind in structure.kinds.values()):
                parts.add(name)
        drawn = any(kind.sections is not None for kind in structure.kinds.values())
    else:
        drawn = getattr(structure, "drawing", None) is not None
    return parts | ({"drawn"} if drawn else set())


def bibtex(parts: Iterable[str]) -> str:
    """Return the works behind parts of analyses as BibTeX, in the order of their table."""
    wanted, entries = set(parts), []
    for row in _package.rows("references.csv"):
        if not wanted & set(row["of"].split()):
            continue
        fields = {name: row[name] for name in ("author", "title", "year")}
        article = _ARTICLE.fullmatch(row["source"])
        if article:
            fields |= article.groupdict()
        elif row["source"]:
            fields[_FIELDS[row["kind"]]] = row["source"]
        if row["key"] == "rbsdem":
            fields["version"] = _core.version()
        # Double braces keep the capitals of a title.
        fields["title"] = f"{{{fields['title']}}}"
        lines = [f"  {name} = {{{text}}}" for name, text in fields.items() if text]
        entries.append(f"@{row['kind']}{{{row['key']},\n" + ",\n".join(lines) + "\n}\n")
    return "\n".join(entries)


#: Names of the energies.
ENERGIES = ("input", "kinetic", "spring", "damping", "axial", "residual")

#: Most steps times bodies of a run that is short enough to be done once more.
_SHORT = 50_000

FORMAT = "rbsdem result"
FORMAT_VERSION = 2
#: Fields that a file holds as they are.
SAVED = ("channels", "summary", "call", "state", "reached")


class _Channels:
    """The channels of a result are its attributes too; None where some were not kept."""

    channels: dict[str, Array]
    displacement: Array
    force: Array
    rotation: Array
    moment: Array
    shear: Array
    slip: Array
    axial_force: Array | None
    rest: Array | None
    x: Array
    y: Array
    node_rotation: Array
    member_axial: Array
    moment_from: Array
    moment_to: Array
    lost: Array | None

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            """Return a channel, and keep it as an attribute."""
            own = self.__dict__
            channels = own.get("channels", {})
            if name in channels or name in _OPTIONAL:
                return own.setdefault(name, channels.get(name))
            raise AttributeError(f"a {type(self).__name__} has no {name!r}")


#: Channels that are None where they were not kept, or do not belong to the structure.
_OPTIONAL = ("axial_force", "rest", "lost")


@dataclass(frozen=True, repr=False, eq=False)
class Result(_Channels):
    """The result of an analysis, row by row: what those of columns, frames and buildings share.

    Attributes
    ----------
    channels : dict of ndarray
        Quantities that were kept, by name, as the columns of the executable's csv: one number a
        row, or one for each joint, node, member or spring.
    summary : dict
        Figures of the analysis: "analysis" ("static" or "dynamic"), "driven" (static),
        "kinematics", the "method" that was used and, if the program chose it, the "reason";
        "status": "completed", "collapsed" (`collapse_drift` was reached), "stopped" (`max_seconds`
        were over), "ended" (a push-over that goes no farther, and why as "reason") or "failed" (the
        result of a `SolveError`). Values: steps, rows, events (how often a spring left its line),
        time_step and stable_step [s], peak_displacement [m], peak_force [N] and
        displacement_at_peak_force [m] (static, where the force has the sign of the displacement; in
        time of a lateral force, if there is one), peak_base_shear [N], peak_rotation (largest
        absolute rotation of a body [rad]), energies at the end [J], energy_residual [J] and
        relative_energy_residual (the largest), cut_steps (steps cut at an event, for accuracy, or
        because they did not converge); of leaps leap_error (what springs that turn in them may
        change, the sum, as a share of the largest force); where members of a frame jumped to
        another equilibrium, snaps (in how many steps), snap_energy (lost in them [J]), snap_member
        and snap_time [s] (number of the one that lost most, and when); where a member carries its
        load no more, fallen_member; where a static path snaps back, snap_backs and released_energy
        (by a test that holds the top [J]). Whatever rows are kept, they are those of all points or
        steps, the residual that of all points or times of the loading; "rk45" and located events
        resolve peaks within a step.
    structure : Column or Frame
        The structure.
    call : dict
        The loading and the settings that were given, as keywords of `cyclic` or `time_history`.
    case : rbsdem.run.case.Case or None
        The case that was run; None if the analysis was called for the structure.
    state : ndarray or None
        The state at the end, in numbers whose meaning is the program's own: memory of the springs,
        place and motion of the structure. ``initial=result`` begins another analysis from it. None
        after a failure, and where a joint has lost its axial load.
    reached : ndarray, shape (criteria, 2), or None
        Of an analysis in time: when each criterion of `limit_states` that could be looked at was
        met first [s], and the displacement of the top then [m]; NaN where it was not. All steps
        count, whatever rows are kept.
    """

    channels: dict[str, Array]
    summary: dict[str, Any]
    structure: Any
    call: dict[str, Any]
    state: Array | None = None
    reached: Array | None = None
    case: Any = None
    #: Values of a state besides the channels.
    _derived: ClassVar[tuple[str, ...]] = ("energy",)

    @property
    def column(self) -> Any:
        """The structure, whatever it is."""
        return self.structure

    @property
    def time(self) -> Array:
        """Time [s]; on a static path the number of the point."""
        return self.channels["time" if "time" in self.channels else "step"]

    @property
    def base_shear(self) -> Array:
        """Horizontal force of the ground on the structure [N]."""
        return self.channels["base_shear"] if "base_shear" in self.channels else self.shear[:, 0]

    @property
    def base_action(self) -> Array:
        """Base moment of a column [N m] or base shear of a frame [N], as results are compared."""
        return self.base_shear

    @property
    def energy(self) -> dict[str, Array]:
        """Energies by name [J]."""
        return {name: self.channels[name] for name in ENERGIES}

    def citation(self) -> str:
        """Return the works behind this result as BibTeX.

        They are the works of the rules of its springs, of its method, of the relations and tests
        that drawn columns and members were fitted to, and rbsdem itself. Values of codes name their
        sources.
        """
        return bibtex(parts_of(self.structure, str(self.summary["method"])))

    def columns(self) -> dict[str, Array]:
        """Return the columns of the table, the unit of each in its name."""
        columns = {}
        for name, values in self.channels.items():
            unit = f"_{_core.units()[name]}".replace(" ", "").rstrip("_")
            if values.ndim == 1:
                columns[name + unit] = values
            else:
                for owner, column in zip(self._owners(name), values.T, strict=True):
                    columns[f"{name}_{owner}{unit}"] = column
        return columns

    def _owners(self, channel: str) -> Sequence[object]:
        """Return the numbers or names of what a channel has columns for."""
        raise NotImplementedError

    @property
    def path(self) -> Self:
        """A static path from corner to corner: the rows of all points, and of the events between.

        Between two rows a static path is straight with small rotations under a constant axial load;
        with exact rotations, or a load that varies, it is a piece of curve. The `time` 3.5 of a
        row is half way between points 3 and 4. If the path begins before its first point, its
        beginning is the first row, at time -1. Quantities of a path are measured here, so that they
        depend neither on `every` nor on points put on the way. The openings are kept. The analysis
        is run once more when the path is first asked for. A response in time is its own path.
        """
        known = vars(self)
        if self.dynamic or "_is_path" in known:
            return self
        if self.call.get("corners") and not (self._is_column or self.call.get("every")):
            return self
        if "_path" not in known:
            known["_path"] = self._follow_corners()
        path: Self = known["_path"]
        return path

    def _follow_corners(self) -> Self:
        """Return a row for every corner, from the same analysis once more."""
        run = follow(self.structure, self.call, openings=self._is_column, corners=True)
        # An error that ended the analysis was raised when the result was made.
        path = replace(self, channels=run[0])
        vars(path)["_is_path"] = True
        return path

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the path and channels by name: they are found again."""
        left_out = {"_path", "_springs", "_springs_in", "_reached", *self.channels, *_OPTIONAL}
        return {name: value for name, value in vars(self).items() if name not in left_out}

    @property
    def _is_column(self) -> bool:
        return isinstance(self.structure, Column)

    def limit_states(self) -> LimitStates:
        """Return the limit states that the response reaches, with row, drift and source.

        A layered hinge that knows its drawing: cracking, first yield, nominal moment, yield of the
        hoops, spalling, the tensile strain before bars buckle, fracture of hoops and bars, by the
        strains of its layers (in time the analysis needs ``openings=True``); other layered joints:
        where a layer yields in tension. Other springs: their `Spring.landmarks`, cracking, yield
        and cap.
        All: the same of shear springs, loss of 20 % of the strength, collapse, loss of the axial
        load. Of a frame: the first of its `events` of each kind, with the spring as source.
        Nothing of the response is changed.

        Raises
        ------
        InputError
            If the openings of a layered hinge were not kept in time.
        """
        return find_limit_states(self)

    def wall_accuracy(self) -> dict[str, WallAccuracy]:
        """Return how far the model was off on tested walls like those of the structure.

        Returns
        -------
        dict of str to rbsdem.run.walls.WallAccuracy
            By the member at the foot of each drawn wall of a frame, of a wall that stands alone by
            "wall"; printed it is a sentence. Empty without drawn walls.
        """
        return wall_accuracy(self.structure)

    @property
    def error_estimate(self) -> ErrorEstimate:
        """Estimate of the error: measured in leaps or in about 0.1 s, else by its method."""
        about = self.summary
        method = METHODS[about["method"]]
        short = self.dynamic and about["steps"] * self.structure.n <= _SHORT
        measured = float(about.get("leap_error", math.nan))
        if short and about["status"] == "completed":
            with contextlib.suppress(SolveError):
                measured = self.refined_error().largest
        usual = method.usual_error, method.largest_error, method.responses
        own = not {"dt", "tolerance", "rho_infinity"} & set(self.call)
        energy = about["relative_energy_residual"]
        return ErrorEstimate(method.name, measured, *usual, own, energy)

    def refined_error(self) -> Errors:
        """Solve once more by the next finer setting and return the distance to it.

        The finer setting is half the step, or a hundredth of the tolerance, or half of the
        increments of a static path, by the same method. If the error falls with the setting, as it
        does unless the response is chaotic, it is about as large as this distance. With a tolerance
        that cannot be made much sharper, the distance is that to a tolerance a hundred times as
        large, which is more than the error. Nothing is below the last digits of the numbers,
        2.2e-16 times the root of the number of rows.

        Returns
        -------
        rbsdem.run.accuracy.Errors
            Relative differences of the response (rms and largest), of the base moment, the energy
            and the peak; `largest` is the largest of them.

        Raises
        ------
        SolveError
            If the finer setting does not solve the case.
        """
        return refined_error(self)

    @property
    def dynamic(self) -> bool:
        """Whether it is a response in time."""
        return bool(self.summary["analysis"] == "dynamic")

    @property
    def loop_force(self) -> Array:
        """Force of the loop [N], shape (steps,): `force`, in time `base_shear`."""
        return self.base_shear if self.dynamic else self.force

    @property
    def drift(self) -> Array:
        """Displacement of the top over the height, shape (rows,)."""
        return np.asarray(self.displacement / self.structure.height)

    def at(
        self, time: float | Literal["peak"] | None = None, *, drift: float | None = None
    ) -> dict[str, Any]:
        """Return the state at a time, at a drift, or at the largest force, linear between rows.

        The rows are those of `path`, which of a static path has the events between the points too.

        Parameters
        ----------
        time : float or "peak", optional
            Within `time` [s]; in a static analysis the number of the point, which may lie between
            two. "peak": where the force of the loop is largest in size.
        drift : float, optional
            Where the drift of the top reaches this value first; in place of `time`.

        Returns
        -------
        dict
            Every array of the result by name: its value, or its values of joints, nodes or members;
            "energy" and, of a frame, "springs" are dicts.

        Raises
        ------
        InputError
            If the time is outside of the rows, or the drift is not reached.
        """
        if (time is None) == (drift is None):
            raise InputError('at: give exactly one of time (or "peak") and drift')
        path, times = self.path, self.path.time
        if isinstance(time, str):
            _arguments.choice(time, "time", ("peak",))
            at = float(times[np.abs(path.loop_force).argmax()])
        elif drift is None:
            at = _arguments.number(time, "time")
        else:
            at = path._time_of(_arguments.number(drift, "drift"))
        if not times.size or not times[0] <= at <= times[-1]:
            span = f"{times[0]:g} to {times[-1]:g}" if times.size else "nothing"
            raise InputError(f"time = {at:g} is outside of the rows, which hold {span}")
        row = int(np.searchsorted(times, at, side="right")) - 1
        after = min(row + 1, times.size - 1)
        length = times[after] - times[row]
        share = (at - times[row]) / length if length > 0 else 0.0

        def between(values: Any) -> Any:
            """Return values at `share` of the way from `row` to the row after."""
            if isinstance(values, dict):
                return {name: between(value) for name, value in values.items()}
            mixed = values[row] if share == 0 else (1 - share) * values[row] + share * values[after]
            return float(mixed) if np.ndim(mixed) == 0 else np.array(mixed)

        names = [n for n in (*path.channels, *path._derived) if n not in (*ENERGIES, "step")]
        values = {name: getattr(path, name) for name in names}
        state = {name: between(value) for name, value in values.items() if value is not None}
        return state | {"time": at}

    def _time_of(self, drift: float) -> float:
        """Return the time at which the drift of the top reaches a value first."""
        beyond = self.drift - drift
        # Rows that are not on the side of the first row.
        crossed = np.flatnonzero(beyond * beyond[:1] <= 0)
        if not crossed.size:
            low, high = float(self.drift.min()), float(self.drift.max())
            raise InputError(
                f"drift = {drift:g} is not reached; the rows go from {low:g} to {high:g}"
            )
        last = int(crossed[0])
        first = max(last - 1, 0)
        moved = beyond[first] - beyond[last]
        share = beyond[first] / moved if moved else 0.0
        return float(self.time[first] + share * (self.time[last] - self.time[first]))

    def envelope(self, side: Literal[1, -1] = 1) -> Envelope:
        """Return the envelope of the loop to one side; see `rbsdem.curves.envelope`."""
        return curve_envelope(self, side)

    def idealise(
        self, method: Method = "asce_41", side: Literal[1, -1] = 1, *, end: float | None = None
    ) -> Idealisation:
        """Replace the envelope of a side by two straight lines; see `Envelope.idealise`."""
        return self.envelope(side).idealise(method, end=end)

    def half_cycles(self) -> HalfCycles:
        """Return energy, stiffness and damping of each half-cycle.

        See `rbsdem.curves.half_cycles`. The energy of a frame is the work of the force over the
        displacement of the top, as the loop shows it.
        """
        # Of a static path of a column the exact work of the solver.
        done = self.path.energy["input"] if self._is_column and not self.dynamic else None
        return half_cycles(*loop_pair(self, "result"), done=done)

    def strength_loss(self, share: float = 0.2) -> float:
        """Return the displacement at which a share of the strength is lost [m]; NaN if it is not.

        See `rbsdem.curves.strength_loss`.
        """
        return strength_loss(*loop_pair(self, "result"), share=share)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each of the result, with units in the names.

        Of a column the names are those of the executable's csv, of a frame those of nodes and
        members stand in them.
        """
        frame = data_frame(self.columns())
        frame.attrs["summary"] = dict(self.summary)
        return frame

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Write the rows as csv with all digits, whole or not at all, as the executable does.

        Parameters
        ----------
        path : path-like
            File to write.
        """
        table, about, case = self.columns(), self.summary, self.case
        head = [
            f"# rbsdem {_core.version()}",
            f"# case: {case.title if case is not None else ''}".rstrip(),
            f"# units: SI, in the names of the columns; method: {about['method']}, "
            f"kinematics: {about['kinematics']}",
            ",".join(table),
        ]
        with atomic_write(path) as file:
            file.write(("\n".join(head) + "\n").encode())
            np.savetxt(file, np.column_stack(list(table.values())), fmt="%.17g", delimiter=",")

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the whole result into one file, which `rbsdem.read_result` reads back bit for bit.

        It holds the arrays, the column and the case as text, the summary, the settings, units and
        version. It is written whole or not at all. A column that a section made comes back as the
        plain `Column` that was solved.

        Parameters
        ----------
        path : path-like
            File to write, ``.npz``.

        Raises
        ------
        InputError
            For another ending.
        """
        check_ending(path)
        about, arrays = _parts(self)
        with atomic_write(path) as file:
            np.savez_compressed(file, about=np.array(json.dumps(about)), **arrays)

    def save_state(self, path: str | os.PathLike[str]) -> None:
        """Write the state at the end as text, for ``initial=path`` and the executable.

        Parameters
        ----------
        path : path-like
            File to write, whole or not at all.

        Raises
        ------
        InputError
            If the result has no state, as after a failure.
        """
        state = last_state(self)
        head = f"{STATE_HEAD}\n# version: {_core.version()}\n{state.size}\n"
        with atomic_write(path) as file:
            file.write((head + "\n".join(map(_text, state)) + "\n").encode())

    def __repr__(self) -> str:
        about = self.summary
        key = "peak_force" if self._is_column and not self.dynamic else "peak_base_shear"
        return (
            f"{type(self).__name__}({about['method']}, {self.time.size} rows, {about['status']}, "
            f"peak displacement {about['peak_displacement']:.4g} m, "
            f"{key.replace('_', ' ')} {about[key]:.4g} N)"
        )

    def __eq__(self, other: object) -> bool:
        """Return whether another result has the same structure, rows and summary, bit for bit."""
        if not isinstance(other, Result):
            return NotImplemented
        return all(
            same(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)
        )

    __hash__ = None  # type: ignore[assignment]


def same(first: Any, second: Any) -> bool:
    """Return whether two values are equal; arrays by all elements, with NaN equal to NaN."""
    if isinstance(first, np.ndarray) or isinstance(second, np.ndarray):
        return np.array_equal(first, second, equal_nan=True)
    if isinstance(first, dict) and isinstance(second, dict):
        return first.keys() == second.keys() and all(same(first[key], second[key]) for key in first)
    if isinstance(first, float) and isinstance(second, float):
        return first == second or (math.isnan(first) and math.isnan(second))
    return bool(first == second)


def _text(number: float) -> str:
    """Return a number as the executable writes it: all digits, three for the exponent."""
    digits, _, exponent = f"{number:.16E}".partition("E")
    return f"{digits}E{int(exponent):+04d}"


def check_ending(path: str | os.PathLike[str]) -> None:
    """Raise `InputError` if the name is not that of a saved result."""
    if _arguments.path(path).suffix.lower() != ".npz":
        raise InputError(f"{os.fspath(path)}: the name of a saved result ends in .npz")


def _parts(result: Any) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the fields that are written as text, and the arrays by name."""
    arrays: dict[str, Any] = {}
    about: dict[str, Any] = {"format": FORMAT, "format_version": FORMAT_VERSION}
    about |= {"version": _core.version(), "units": _core.units()}
    structure = result.structure
    plain = structure._statement if isinstance(structure, Frame) else structure._groups()
    about |= {
        "column": _core.evaluate("to_namelist", plain).text,
        # Springs stay as they were solved; sections come back where they still give these springs.
        "drawing": structure.to_namelist() if structure._groups() != plain else None,
        "case": None if result.case is None else result.case.to_namelist(),
    }
    return about | {name: _apart(name, getattr(result, name), arrays) for name in SAVED}, arrays


def _apart(name: str, value: Any, arrays: dict[str, Any]) -> Any:
    """Return a value for json; arrays in it are put aside under their names."""
    if isinstance(value, Mapping):
        return {key: _apart(f"{name}/{key}", each, arrays) for key, each in value.items()}
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    return value.item() if isinstance(value, np.generic) else value
