"""What an analysis returns."""

from __future__ import annotations

import math
import os
import zipfile
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any, Protocol, TypeVar, runtime_checkable

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._types import Array
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.model.springs import Gauge, Layered, Strains, strains_of

#: Names of the energies.
ENERGIES = ("input", "kinetic", "spring", "damping", "axial", "residual")

#: First line of a file with a state.
STATE_HEAD = "# rbsdem state"
_NO_ROWS = ("state", "reached")
_CHANNELS = ("displacement", "force", "slip", "rotation", "shear", "moment")

R = TypeVar("R", bound="Response")


class Recorded(Protocol):
    """The case of which a response is: `rbsdem.run.case.Case`."""

    @property
    def title(self) -> str:
        """Title of the case."""

    def to_namelist(self) -> str:
        """Return the text of the case file."""


@runtime_checkable
class Ended(Protocol):
    """What an analysis can begin from: the result of another one."""

    @property
    def state(self) -> Array | None:
        """State at the end."""

    @property
    def summary(self) -> dict[str, Any]:
        """What was done."""


@dataclass(frozen=True, repr=False, eq=False)
class Response:
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
        What holds the column at the ground: horizontal force [N], and moment about the lowest joint
        [N m]. Those of the springs of that joint and, in time, of the damping, which may also act
        between the bodies and the ground (``docs/theory.md``). In a static analysis the shear is
        `force`.
    energy : dict of ndarray, shape (steps,)
        Energies [J]: "input" (work of lateral force and ground motion), "kinetic", "spring"
        (stored and dissipated), "damping", "axial" (potential of axial load and weight), and
        "residual", which is input + energy at the start minus the other energies.
    summary : dict
        What was done: "analysis" ("static" or "dynamic"), "driven" (static), "kinematics", the
        "method" that was used and, if the program chose it, the "reason"; "status": "completed",
        "collapsed" (`collapse_drift` was reached) or "failed" (the result of a `SolveError`).
        Values: steps, rows, events (how often a spring left its line), time_step and stable_step
        [s], peak_displacement [m], peak_force [N] and displacement_at_peak_force [m] (static, where
        the force has the sign of the displacement; in time of a lateral force, if there is one),
        peak_base_shear [N], peak_rotation (largest absolute rotation of a body [rad]), energies at
        the end [J], energy_residual [J] and relative_energy_residual (the largest), cut_steps
        (steps cut at an event, for accuracy, or because they did not converge); where members of a
        frame jumped to another equilibrium, snaps (in how many steps), snap_energy (lost in them
        [J]), snap_member and snap_time [s] (number of the one that lost most, and when); where a
        member carries its load no more, fallen_member; where a static path snaps back, snap_backs
        and released_energy (by a test that holds the top [J]). Whatever rows are
        kept, they are those of all points or steps, the residual that of all points or times of the
        loading; "rk45" and located events resolve peaks within a step.
    opening : ndarray, shape (steps, n)
        Opening of the joints at the middle of the section [m]: of axial springs, and, if the
        analysis was called with ``openings=True``, of layered joints. Zero for other joints.
    axial_force : ndarray, shape (steps, n), or None
        Forces of the axial springs, tension positive [N]; None if joints do not open.
    top : ndarray, shape (steps, 2)
        Position (x, y) of the top relative to the ground [m].
    column : Column
        The column.
    call : dict
        The loading and the settings that were given, as keywords of `cyclic` or `time_history`.
    channels : tuple of str
        Names of the quantities that the rows hold, in the order of the executable's csv.
    case : rbsdem.run.case.Case or None
        The case that was run; None if the analysis was called for the column.
    state : ndarray or None
        The state at the end, in numbers whose meaning is the program's own: what the springs
        remember, where the column is and how it moves. ``initial=result`` begins another analysis
        from it. None after a failure, and where a joint has lost its axial load.
    motion : ndarray, shape (steps, 3), or None
        Velocity [m/s] and acceleration [m/s2] of the top relative to the ground, and acceleration
        of the ground [m/s2]; None if they were not kept (``motion=True``).
    rest : ndarray, shape (steps, n), or None
        Rotations of layered joints under their first axial load, from which `rotation` counts
        [rad]; zero but for unsymmetric sections. None if the openings were not kept.
    reached : ndarray, shape (criteria, 2), or None
        Of an analysis in time: when each criterion of `limit_states` that could be looked at was
        met first [s], and the displacement of the top then [m]; NaN where it was not. All steps
        count, whatever rows are kept.
    """

    time: Array
    displacement: Array
    force: Array
    slip: Array
    rotation: Array
    shear: Array
    moment: Array
    base_shear: Array
    base_moment: Array
    energy: dict[str, Array]
    summary: dict[str, Any]
    opening: Array
    axial_force: Array | None
    top: Array
    column: Column
    call: dict[str, Any]
    channels: tuple[str, ...]
    case: Recorded | None = None
    rest: Array | None = None
    state: Array | None = None
    motion: Array | None = None
    reached: Array | None = None

    @property
    def path(self: R) -> R:
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
        if "_path" not in known:
            known["_path"] = self._follow_corners()
        path: R = known["_path"]
        return path

    def _follow_corners(self: R) -> R:
        """Return a row for every corner, from the same analysis once more."""
        call = self.call
        by_force = self.summary["driven"] == "force"
        run = _core.cyclic(
            self.column._statement
            + settings_of(None, True, collapse_drift=call.get("collapse_drift")),
            by_force,
            call["force" if by_force else "displacement"],
            call.get("axial_load"),
            state_of(call["initial"], "cyclic") if "initial" in call else None,
            corners=True,
        )
        # Where the path broke off, the result has been told of it.
        path = response_of(type(self), run[0], self.column, self.summary, call, self.state)
        vars(path)["_is_path"] = True
        return path

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the path: it is found again."""
        return {name: value for name, value in vars(self).items() if name != "_path"}

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
        at = self.column.place_of(joint)
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
        spring = self.column.joints("flexure")[self.column.place_of(joint)]
        assert isinstance(spring, Layered)
        return strains_of(joint, self.time, [y for y, _ in spring.layers], known, deformation)

    def _check_openings(self) -> None:
        layered = any(isinstance(spring, Layered) for spring in self.column.joints("flexure"))
        if self.rest is None and layered:
            raise InputError(
                "the openings of layered joints were not kept; run the analysis with openings=True"
            )

    @property
    def dynamic(self) -> bool:
        """Whether it is a response in time."""
        return bool(self.summary["analysis"] == "dynamic")

    @property
    def loop_force(self) -> Array:
        """Force of the loop [N], shape (steps,): `force`, in time `base_shear`."""
        return self.base_shear if self.dynamic else self.force

    @property
    def velocity(self) -> Array:
        """Velocity of the top relative to the ground [m/s], shape (steps,).

        Raises
        ------
        InputError
            For a static path, and if the motion was not kept (``motion=True``).
        """
        return self._motion("velocity")[:, 0]

    @property
    def acceleration(self) -> Array:
        """Acceleration of the top relative to the ground [m/s2], shape (steps,).

        What the equation of motion gives for the state of each row.

        Raises
        ------
        InputError
            For a static path, and if the motion was not kept (``motion=True``).
        """
        return self._motion("acceleration")[:, 1]

    @property
    def absolute_acceleration(self) -> Array:
        """Acceleration of the top in space [m/s2], that of a floor there, shape (steps,).

        Raises
        ------
        InputError
            For a static path, and if the motion was not kept (``motion=True``).
        """
        motion = self._motion("absolute_acceleration")
        return np.asarray(motion[:, 1] + motion[:, 2])

    def _motion(self, name: str) -> Array:
        if not self.dynamic:
            raise InputError(f"{name}: nothing moves in a static path; use time_history")
        if self.motion is None:
            raise InputError(f"{name} was not kept; run the analysis with motion=True")
        return self.motion

    @property
    def drift(self) -> Array:
        """Drift ratio, displacement of the top over the height, shape (steps,)."""
        return self.displacement / self.column.height

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

    def at(self, time: float) -> dict[str, Any]:
        """Return the state at a time, or at a point of a static path, linear between rows.

        The rows are those of `path`, which of a static path has the events between the points too.

        Parameters
        ----------
        time : float
            Within `time` [s]; in a static analysis the number of the point, which may lie between
            two.

        Returns
        -------
        dict
            Every array of the result by name, its value or its values of the joints; "energy" is a
            dict of the energies.

        Raises
        ------
        InputError
            If the time is outside of the rows.
        """
        at = _arguments.number(time, "time")
        path, times = self.path, self.path.time
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

        arrays = {name: value for name, value in vars(path).items() if name not in _NO_ROWS}
        state: dict[str, Any] = {
            name: between(value) for name, value in arrays.items() if isinstance(value, np.ndarray)
        }
        return state | {"energy": between(path.energy), "time": at}

    def __repr__(self) -> str:
        about, key = self.summary, "peak_base_shear" if self.dynamic else "peak_force"
        return (
            f"{type(self).__name__}({about['method']}, {self.time.size} rows, {about['status']}, "
            f"peak displacement {about['peak_displacement']:.4g} m, "
            f"{key.replace('_', ' ')} {about[key]:.4g} N)"
        )

    def __eq__(self, other: object) -> bool:
        """Return whether another result has the same column, rows and summary, bit for bit."""
        if not isinstance(other, Response):
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


def response_of(
    kind: type[R],
    arrays: dict[str, Array],
    column: Column,
    summary: dict[str, Any],
    call: dict[str, Any],
    state: Array | None = None,
    reached: Array | None = None,
) -> R:
    """Return the response of the arrays of a run."""
    channels: Any = {name: arrays[name] for name in _CHANNELS}
    motion = None
    if "velocity" in arrays:
        names = ("velocity", "acceleration", "ground_acceleration")
        motion = np.column_stack([arrays[name] for name in names])
    return kind(
        time=arrays["time" if "time" in arrays else "step"],
        **channels,
        base_shear=arrays.get("base_shear", arrays["shear"][:, 0]),
        base_moment=arrays.get("base_moment", arrays["moment"][:, 0]),
        energy={name: arrays[name] for name in ENERGIES},
        summary=summary,
        opening=arrays.get("opening", np.zeros(arrays["slip"].shape)),
        axial_force=arrays.get("axial_force"),
        rest=arrays.get("rest"),
        top=np.column_stack((arrays["displacement"], arrays["top_height"])),
        column=column,
        call=call,
        channels=tuple(arrays),
        state=state,
        motion=motion,
        reached=reached,
    )


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
    initial : Response or path
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
    if isinstance(initial, Ended):
        return last_state(initial)
    if isinstance(initial, np.ndarray):
        # The state of a result, as `Result.call` keeps it.
        return _arguments.vector(initial, "initial")
    a_dict = " or a dict, as {'slip': [0.001]}" if call == "time_history" else ""
    raise InputError(
        f"{call}: initial = {_arguments.shown(initial)} must be a Result of this column, the path "
        f"of a state{a_dict}"
    )


def last_state(response: Ended) -> Array:
    """Return the state that an analysis ended in; `InputError` if it has none."""
    if response.state is None:
        why = {
            "failed": "the analysis failed on its way; end it before the failure",
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
