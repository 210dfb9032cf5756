"""Results of columns and frames: loops, tables, states, and one file that describes itself.

Works to cite for a result are those of its rules, methods and fitted relations, and rbsdem.
"""

from __future__ import annotations

import json
import math
import os
import re
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Literal, Protocol, overload, runtime_checkable

import numpy as np

from rbsdem import _arguments, _core, _package
from rbsdem._files import Tabular, atomic_write, data_frame, text_table
from rbsdem._types import Array, DataFrame, Self
from rbsdem.curves.envelope import Envelope, Idealisation, Method, strength_loss
from rbsdem.curves.envelope import envelope as curve_envelope
from rbsdem.curves.metrics import HalfCycles, half_cycles, loop_pair
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.model.frame import Frame, Structure
from rbsdem.model.springs import Gauge, Layered, Strains, strains_of

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
    found = {"all", f"method:{method}"}
    for _, given in _core.groups(structure._groups()):
        if "rule" in given:
            found.add(f"rule:{given['rule']}")
    if isinstance(structure, Frame):
        found |= {f"rule:{spring.rule}" for spring in structure.parts.springs}
        for name in ("shear_drift", "failure_drift"):
            if any(getattr(kind, name) is not None for kind in structure.kinds.values()):
                found.add(name)
        drawn = any(kind.sections is not None for kind in structure.kinds.values())
    else:
        drawn = getattr(structure, "drawing", None) is not None
    return found | ({"drawn"} if drawn else set())


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

#: First line of a file with a state.
STATE_HEAD = "# rbsdem state"

FORMAT = "rbsdem result"
FORMAT_VERSION = 2
#: Fields that a file holds as they are.
SAVED = ("channels", "summary", "call", "state", "reached")


AXIAL_FAILURE_FACTORS = (0.5, 2.5)
"""Ends of the 80 % interval of a measured drift at axial failure over that of Elwood and Moehle.

Of rectangular columns of publications that the law has not seen (twins with one drawing differ by a
factor of up to 2.9); `studies/new_tests.py` prints the scatter of the given ones.
"""


@dataclass(frozen=True)
class LimitState:
    """One limit state, where it is reached first.

    Attributes
    ----------
    name : str
        Of `limit_states()`: "cracking", "first_yield", "nominal_moment", "hoop_yield", "spalling",
        "bar_buckling", "hoop_fracture", "bar_fracture", "cap", "shear_cracking", "shear_yield",
        "shear_failure", "strength_loss", "collapse" or "axial_failure"; of a frame
        "infill_cracking", "infill_peak" and "infill_residual" too. Of the `events` of a frame
        "cracking", "yield", "spalling", "cap", "shear_failure" or, of an infill, "residual" of a
        spring; of a member "shear_failure", where its drift reaches that of it before a spring
        does, "lost" where it carries its axial load no more, "snap" where its inside jumps to
        another equilibrium (the jump that loses most energy), or "fall" where it has none any more.
    row : int
        First row of the result at or behind it.
    time : float
        Time [s], linear between two rows; or point of a static path, between two with the share of
        the way (`Result.path`).
    displacement, drift : float
        Of the top there [m], and over the height.
    force : float
        Of the loop there [N], see `Result.loop_force`.
    threshold : float
        The value reached: a strain, a rotation [rad], a slip [m] or a share; NaN of a frame.
    source : str
        Where the threshold comes from.
    member, group : str
        Of a frame, name of the member, and which of its springs: "flexure", "shear",
        "axial_spring" or "infill", a strut of one; or name of the node, and "panel"; "member" where
        it is lost as a whole.
    end : str
        "start", "end", or the place between them in shares of the clear length; "" in a panel.
    side : int
        1 or -1; 0 of a member as a whole.
    lower, upper : float
        Ends of the 80 % interval of tests about the drift of the structure, or of the member, where
        the state is a loss of the axial load; NaN of others.
    """

    name: str
    row: int
    time: float
    displacement: float
    drift: float
    force: float
    threshold: float = math.nan
    source: str = ""
    member: str = ""
    group: str = ""
    end: str = ""
    side: int = 0
    lower: float = math.nan
    upper: float = math.nan


class LimitStates(Tabular):
    """Limit states in the order in which they are reached; `print` makes a short table.

    Parameters
    ----------
    states : iterable of LimitState
        Those that are reached.
    result : Result or FrameResult
        The response.
    """

    def __init__(self, states: Iterable[LimitState], result: Any) -> None:
        self.result = result
        self._states = sorted(states, key=lambda state: (state.time, state.row))

    def __iter__(self) -> Iterator[LimitState]:
        return iter(self._states)

    def __len__(self) -> int:
        return len(self._states)

    def __contains__(self, name: object) -> bool:
        """Return whether a limit state is reached."""
        return any(state.name == name for state in self)

    @overload
    def __getitem__(self, name: str | int) -> LimitState: ...
    @overload
    def __getitem__(self, name: slice) -> list[LimitState]: ...
    def __getitem__(self, name: str | int | slice) -> LimitState | list[LimitState]:
        """Return the first limit state of a name, `KeyError` if it is not reached; or by place."""
        if not isinstance(name, str):
            return self._states[name]
        for state in self:
            if state.name == name:
                return state
        raise KeyError(f"{name!r} is not reached; reached are {', '.join(self.names()) or 'none'}")

    def names(self) -> list[str]:
        """Return the names in the order in which they are reached."""
        return list(dict.fromkeys(state.name for state in self))

    def drift(self, name: str) -> float:
        """Return the drift, in size, at which a state is reached; NaN if it is not."""
        return abs(self[name].drift) if name in self else math.nan

    def to_pandas(self, *, cracking: bool = True) -> DataFrame:
        """Return a row for each state, those of cracking on request: what `LimitState` has."""
        rows = [asdict(state) for state in self if cracking or state.name != "cracking"]
        units = {"time": "time_s" if self.result.dynamic else "point"}
        units |= {"displacement": "displacement_m", "force": "force_N"}
        frame = data_frame(rows, [field.name for field in fields(LimitState)])
        if not any(math.isfinite(state.upper) for state in self):
            frame = frame.drop(columns=["lower", "upper"])
        if not any(state.member for state in self):
            frame = frame.drop(columns=["member", "group", "end", "side"])
        elif not any(state.source for state in self):
            frame = frame.drop(columns=["threshold", "source"])
        return frame.rename(columns=units)

    def __str__(self) -> str:
        # Of many springs those that crack hide the others.
        cracks = sum(state.name == "cracking" for state in self)
        table = text_table(self.to_pandas(cracking=cracks < 2))
        return table + (f"\nand {cracks} springs crack" if cracks > 1 else "")

    def __repr__(self) -> str:
        names = [state.name for state in self]
        if len(names) == len(set(names)):
            told = [f"{state.name} {100 * state.drift:.2f} %" for state in self]
        else:
            told = [f"{number} {name}" for name, number in Counter(names).items()]
        return f"LimitStates({', '.join(told)})"


@runtime_checkable
class HasEndState(Protocol):
    """A result in whose end another analysis can begin."""

    @property
    def state(self) -> Array | None:
        """State at the end."""

    @property
    def summary(self) -> dict[str, Any]:
        """Figures of the analysis."""


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
class Rows(_Channels):
    """The result of an analysis of a column or a frame: a path or a response, row by row.

    Attributes
    ----------
    channels : dict of ndarray
        Quantities that were kept, by name, as the columns of the executable's csv: one number a
        row, or one for each joint, node, member or spring.
    summary, call, state, case
        As those of `rbsdem.Result`.
    structure : Column or Frame
        The structure.
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
    def time(self) -> Array:
        """Time [s]; on a static path the number of the point."""
        return self.channels["time" if "time" in self.channels else "step"]

    @property
    def base_shear(self) -> Array:
        """Horizontal force of the ground on the structure [N]."""
        return self.channels["base_shear"] if "base_shear" in self.channels else self.shear[:, 0]

    @property
    def energy(self) -> dict[str, Array]:
        """Energies by name [J]."""
        return {name: self.channels[name] for name in ENERGIES}

    def citation(self) -> str:
        """Return the works behind this result as BibTeX.

        Those of the rules of its springs, of its method, of the relations and tests that drawn
        columns and members were fitted to, and rbsdem itself. Values of codes name their sources.
        """
        return bibtex(parts_of(self.structure, str(self.summary["method"])))

    def columns(self) -> dict[str, Array]:
        """Return the columns of the table, the unit of each in its name."""
        found = {}
        for name, values in self.channels.items():
            unit = f"_{_core.units()[name]}".replace(" ", "").rstrip("_")
            if values.ndim == 1:
                found[name + unit] = values
            else:
                for owner, one in zip(self._owners(name), values.T, strict=True):
                    found[f"{name}_{owner}{unit}"] = one
        return found

    def _owners(self, channel: str) -> Sequence[object]:
        """Return the numbers or names of what a channel has columns for."""
        raise NotImplementedError

    @property
    def path(self) -> Self:
        """A static path from corner to corner: the rows of all points, and of the events between.

        Between two rows a static path is straight with small rotations under a constant axial load;
        with exact rotations, or a load that varies, it is a piece of curve. `time` of a row between
        two points holds the share of the way. If the first point is not where the path begins, its
        beginning is the first row, at time -1. What is measured on a path is measured here, so that
        it depends neither on `every` nor on points put on the way. The openings are kept. It is
        found by the same analysis once more, when it is first asked for. A response in time is its
        own path.
        """
        known = vars(self)
        if self.dynamic or "_is_path" in known:
            return self
        if self.call.get("corners") and not self._is_column:
            return self
        if "_path" not in known:
            known["_path"] = self._follow_corners()
        path: Self = known["_path"]
        return path

    def _follow_corners(self) -> Self:
        """Return a row for every corner, from the same analysis once more."""
        call = self.call
        by_force = self.summary["driven"] == "force"
        run = _core.cyclic(
            self.structure._made,
            settings_of(None, self._is_column, collapse_drift=call.get("collapse_drift")),
            by_force,
            call["force" if by_force else "displacement"],
            call.get("axial_load"),
            state_of(call["initial"], "cyclic") if "initial" in call else None,
            corners=True,
        )
        # Where the path broke off, the result has been told of it.
        path = replace(self, channels=run[0])
        vars(path)["_is_path"] = True
        return path

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the path and channels by name: they are found again."""
        left_out = {"_path", "_springs", "_openings", "_of_layers", *self.channels, *_OPTIONAL}
        return {name: value for name, value in vars(self).items() if name not in left_out}

    @property
    def _is_column(self) -> bool:
        return isinstance(self.structure, Column)

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
        about, key = self.summary, "peak_base_shear" if self.dynamic else "peak_force"
        return (
            f"{type(self).__name__}({about['method']}, {self.time.size} rows, {about['status']}, "
            f"peak displacement {about['peak_displacement']:.4g} m, "
            f"{key.replace('_', ' ')} {about[key]:.4g} N)"
        )

    def __eq__(self, other: object) -> bool:
        """Return whether another result has the same structure, rows and summary, bit for bit."""
        if not isinstance(other, Rows):
            return NotImplemented
        return all(
            same(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)
        )

    __hash__ = None  # type: ignore[assignment]


def same(one: Any, other: Any) -> bool:
    """Return whether two values are equal; arrays by all elements, with NaN equal to NaN."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(same(one[key], other[key]) for key in one)
    if isinstance(one, float) and isinstance(other, float):
        return one == other or (math.isnan(one) and math.isnan(other))
    return bool(one == other)


def settings_of(
    every: int | None, openings: bool, motion: bool = False, **given: Any
) -> _core.Statement:
    """Return the groups analysis and output with the settings that are given."""
    statement = _core.settings({name: v for name, v in given.items() if v is not None})
    if every is None and not openings and not motion:
        return statement
    if every is not None:
        _arguments.integer(every, "every", least=1)
    return statement + _core.group(
        "output", {"every": every, "openings": int(openings) or None, "motion": int(motion) or None}
    )


def state_of(initial: Any, call: str) -> Array:
    """Return the state that an analysis begins in, from a response or a path.

    Parameters
    ----------
    initial : Response or path-like
        As the user gave it.
    call : str
        Name of the analysis, for messages.

    Raises
    ------
    InputError
        If it is neither, has no state, or the file is damaged.
    """
    if isinstance(initial, (str, os.PathLike)):
        return _read_state(_arguments.file(initial, f"{call}: initial"))
    if isinstance(initial, HasEndState):
        return last_state(initial)
    if isinstance(initial, np.ndarray):
        # The state of a result, as `Result.call` keeps it.
        return _arguments.vector(initial, "initial")
    a_dict = " or a dict, as {'slip': [0.001]}" if call == "time_history" else ""
    raise InputError(
        f"{call}: initial = {_arguments.shown(initial)} must be a Result of this column, the path "
        f"of a state{a_dict}"
    )


def last_state(response: HasEndState) -> Array:
    """Return the state that an analysis ended in; `InputError` if it has none."""
    if response.state is None:
        why = {
            "failed": "the analysis failed on its way; end it before the failure",
            "ended": "the push-over ended on its way; end it before that",
            "axial_failure": "the column has lost its axial load, and nothing can follow",
        }.get(response.summary["status"], "run the analysis again")
        raise InputError(f"initial: the result has no state at its end: {why}")
    return response.state


def _read_state(path: str) -> Array:
    if not Path(path).is_file():
        raise InputError(f"initial: {path}: there is no such file; check the path")
    if zipfile.is_zipfile(path):
        raise InputError(
            f"initial: {path} is a saved result and no state; give "
            f"initial=rbsdem.read_result({path!r})"
        )
    try:
        lines = Path(path).read_text(encoding="ascii").splitlines()
        if lines[0] != STATE_HEAD:
            raise ValueError("another kind of file")
        numbers = [line for line in lines if not line.startswith("#")]
        state = np.array(numbers[1:], dtype=np.float64)
        if state.size != int(numbers[0]):
            raise ValueError(f"{state.size} numbers of {numbers[0]}")
    except (OSError, ValueError, IndexError) as error:
        raise InputError(
            f"initial: {path} is no state of rbsdem, or it is damaged ({error}); "
            "Result.save_state and the key state of the group output write one"
        ) from error
    return state


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


@dataclass(frozen=True, repr=False, eq=False)
class Response(Rows):
    """Rows of an analysis: arrays with a row for each kept step and a column for each joint.

    Attributes
    ----------
    time : ndarray, shape (steps,)
        Time [s]; in a static analysis the number of the point.
    displacement : ndarray, shape (steps,)
        Displacement of the top relative to the ground [m].
    force : ndarray, shape (steps,)
        Lateral force at the top [N].
    slip, rotation : ndarray, shape (steps, joints)
        Slip [m] and relative rotation [rad] of the joints from the ground up, in the order of
        `column.joint_numbers`: joints 1 to n; beneath a footing joint 0 comes first, at a fixed
        top joint n + 1 last.
    shear, moment : ndarray, shape (steps, joints)
        Forces [N] and moments [N m] of their springs.
    base_shear, base_moment : ndarray, shape (steps,)
        Reaction of the ground: horizontal force [N], and moment about the lowest joint
        [N m]. Those of the springs of that joint and, in time, of the damping, which may also act
        between the bodies and the ground (``docs/theory.md``). In a static analysis the shear is
        `force`.
    energy : dict of ndarray, shape (steps,)
        Energies [J]: "input" (work of lateral force and ground motion), "kinetic", "spring"
        (stored and dissipated), "damping", "axial" (potential of axial load and weight), and
        "residual", which is input + energy at the start minus the other energies.
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
        because they did not converge); where members of a frame jumped to another equilibrium,
        snaps (in how many steps), snap_energy (lost in them [J]), snap_member and snap_time [s]
        (number of the one that lost most, and when); where a member carries its load no more,
        fallen_member; where a static path snaps back, snap_backs and released_energy (by a test
        that holds the top [J]). Whatever rows are kept, they are those of all points or steps, the
        residual that of all points or times of the loading; "rk45" and located events resolve peaks
        within a step.
    opening : ndarray, shape (steps, n)
        Opening of the joints at the middle of the section [m]: of axial springs, and, if the
        analysis was called with ``openings=True``, of layered joints. Zero for other joints.
    axial_force : ndarray, shape (steps, n), or None
        Forces of the axial springs, tension positive [N]; None if joints do not open.
    top : ndarray, shape (steps, 2)
        Position (x, y) of the top relative to the ground [m].
    column, structure : Column
        The column.
    call : dict
        The loading and the settings that were given, as keywords of `cyclic` or `time_history`.
    channels : dict of ndarray
        The quantities that the rows hold, by name, in the order of the executable's csv.
    case : rbsdem.run.case.Case or None
        The case that was run; None if the analysis was called for the column.
    state : ndarray or None
        The state at the end, in numbers whose meaning is the program's own: what the springs
        remember, where the column is and how it moves. ``initial=result`` begins another analysis
        from it. None after a failure, and where a joint has lost its axial load.
    rest : ndarray, shape (steps, n), or None
        Rotations of layered joints under their first axial load, from which `rotation` counts
        [rad]; zero but for unsymmetric sections. None if the openings were not kept.
    reached : ndarray, shape (criteria, 2), or None
        Of an analysis in time: when each criterion of `limit_states` that could be looked at was
        met first [s], and the displacement of the top then [m]; NaN where it was not. All steps
        count, whatever rows are kept.
    """

    _derived: ClassVar[tuple[str, ...]] = ("energy", "base_shear", "base_moment", "opening", "top")

    @property
    def column(self) -> Column:
        """The column."""
        column: Column = self.structure
        return column

    @property
    def base_moment(self) -> Array:
        """Moment of the ground on the column about the lowest joint [N m]."""
        return self.channels.get("base_moment", self.moment[:, 0])

    @property
    def opening(self) -> Array:
        """Openings of the joints at the middle of the section [m]."""
        return self.channels["opening"] if "opening" in self.channels else np.zeros(self.slip.shape)

    @property
    def top(self) -> Array:
        """Position (x, y) of the top relative to the ground [m]."""
        return np.column_stack((self.displacement, self.channels["top_height"]))

    @property
    def elongation(self) -> Array:
        """Growth of the column's axis from the openings of its joints [m], shape (steps,).

        Negative values are a shortening. It does not hold what the turning of the bodies takes from
        the height of the top, which is in `top`.

        Raises
        ------
        InputError
            If the openings of layered joints were not kept.
        """
        self._check_openings()
        return np.asarray(self.opening.sum(axis=1))

    def layer_deformation(self, joint: int = 1) -> Array:
        """Return the deformations of the layers of a joint [m], shape (steps, layers).

        Opening is positive. Over the length that a layer stands for it is the strain.

        Parameters
        ----------
        joint : int, optional
            The joint, from 1 at the ground to n; its spring is `Layered`, whose `layers` give the
            order.

        Raises
        ------
        InputError
            If the joint has no layers, or the openings were not kept.
        """
        at = self.column.index_of(joint)
        spring = self.column.joints("flexure")[at]
        if not isinstance(spring, Layered):
            raise InputError(f"joint {joint} has no layers; its spring is {type(spring).__name__}")
        self._check_openings()
        assert self.rest is not None
        turned = self.rotation[:, at] + self.rest[:, at]
        places = np.array([y for y, _ in spring.layers])
        return np.asarray(self.opening[:, at, None] + turned[:, None] * places)

    def strains(self, joint: int = 1, *, gauge: Gauge | None = None) -> Strains:
        """Return the strains of the layers of a joint: bars, core and cover in each row.

        Parameters
        ----------
        joint : int, optional
            The joint, from 1 at the ground to n.
        gauge : Gauge, optional
            What the layers stand for and over which lengths they deform. Not needed for the hinge
            of a column that was made from its drawing.

        Raises
        ------
        InputError
            If the joint has no layers, the openings were not kept (``openings=True``), or nothing
            is known of the lengths of the layers.
        """
        deformation = self.layer_deformation(joint)
        if gauge is not None:
            _arguments.instance(gauge, "gauge", Gauge)
        known = gauge or self.column.gauge(joint)
        if known is None:
            raise InputError(
                f"joint {joint} was not made from a section, and over which lengths its layers "
                "deform is not known; give gauge=rbsdem.springs.Gauge(part=..., length=...)"
            )
        spring = self.column.joints("flexure")[self.column.index_of(joint)]
        assert isinstance(spring, Layered)
        return strains_of(joint, self.time, [y for y, _ in spring.layers], known, deformation)

    def _check_openings(self) -> None:
        layered = any(isinstance(spring, Layered) for spring in self.column.joints("flexure"))
        if self.rest is None and layered:
            raise InputError(
                "the openings of layered joints were not kept; run the analysis with openings=True"
            )

    @property
    def velocity(self) -> Array:
        """Velocity of the top relative to the ground [m/s], shape (steps,).

        Raises
        ------
        InputError
            For a static path, and if the motion was not kept (``motion=True``).
        """
        return self._kept("velocity", "velocity")

    @property
    def acceleration(self) -> Array:
        """Acceleration of the top relative to the ground [m/s2], shape (steps,).

        It follows from the equation of motion in the state of each row.

        Raises
        ------
        InputError
            For a static path, and if the motion was not kept (``motion=True``).
        """
        return self._kept("acceleration", "acceleration")

    @property
    def absolute_acceleration(self) -> Array:
        """Acceleration of the top in space [m/s2], that of a floor there, shape (steps,).

        Raises
        ------
        InputError
            For a static path, and if the motion was not kept (``motion=True``).
        """
        moved = self._kept("acceleration", "absolute_acceleration")
        return np.asarray(moved + self.channels["ground_acceleration"])

    def _kept(self, channel: str, name: str) -> Array:
        if not self.dynamic:
            raise InputError(f"{name}: nothing moves in a static path; use time_history")
        if channel not in self.channels:
            raise InputError(f"{name} was not kept; run the analysis with motion=True")
        return self.channels[channel]

    @property
    def residual_drift(self) -> float:
        """Drift ratio that is left at the end.

        In time that of the last row, as in the table of an ensemble: let the motion end with rest,
        so that the swing has died away. Of a static path the one at the last zero of the force, NaN
        if the force never returns to zero.
        """
        if not self.displacement.size:
            return math.nan
        if self.dynamic:
            return float(self.displacement[-1]) / self.column.height
        return _last_zero(self.path.displacement, self.path.force) / self.column.height

    def _owners(self, channel: str) -> Sequence[object]:
        return self.column.joint_numbers


def _last_zero(displacement: Array, force: Array) -> float:
    """Return the displacement at the last zero of the force [m], NaN if it never returns to it."""
    if force[-1] == 0:
        return float(displacement[-1])
    changes = np.flatnonzero(force[1:] * force[:-1] <= 0)
    # The start has no force either, and is no return.
    changes = changes[force[changes] != 0]
    if changes.size == 0:
        return math.nan
    row = int(changes[-1])
    share = force[row] / (force[row] - force[row + 1])
    return float(displacement[row] + share * (displacement[row + 1] - displacement[row]))
