"""The response of a building: its floors in plan, and one frame of it at a time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.errors import InputError
from rbsdem.run.accuracy import ErrorEstimate, Errors
from rbsdem.run.frame_result import CHANNELS, OF_NODES, FrameResult, owners
from rbsdem.run.limit_states import LimitStates
from rbsdem.run.rows import Result
from rbsdem.section.plan import Building, Plane

#: Channels of the members and of the floors of a building.
_OF_MEMBERS = ("member_axial", "moment_from", "moment_to", "lost")
_OF_FLOORS = ("floor_x", "floor_y", "floor_rotation")
#: Figures of a run that name a member of the building by its number.
_OF_ONE_MEMBER = ("snap_member", "fallen_member", "snap_time")


@dataclass(frozen=True, repr=False, eq=False)
class FrameOfBuilding(FrameResult):
    """The response of a frame in a building; `building_result` is that of all of it."""

    building_result: ClassVar[Any]
    plane: ClassVar[Plane]

    @property
    def periods(self) -> dict[str, float]:
        """Refused: a frame of a building has no periods of its own."""
        raise InputError(
            "a frame of a building has no periods of its own; ask rbsdem.modes(building)"
        )

    @property
    def floor_displacement(self) -> Array:
        """Displacement of the floors from the base up along its axis [m]."""
        base = self.x[:, self.frame.parts.floor == 0]
        moved = self.building_result.moved(self.plane.places([0.0])[0]) @ self.plane.direction
        return np.column_stack((base.mean(axis=1) if base.size else 0.0 * self.time, moved))[
            :, : len(self._storeys()) + 1
        ]

    @property
    def error_estimate(self) -> ErrorEstimate:
        """Error estimate of the building."""
        estimate: ErrorEstimate = self.building_result.error_estimate
        return estimate

    def refined_error(self) -> Errors:
        """Return the errors of the building, measured by a finer setting."""
        errors: Errors = self.building_result.refined_error()
        return errors


@dataclass(frozen=True, repr=False, eq=False)
class BuildingResult(Result):
    """Rows of an analysis of a building: arrays with a row for each that was kept.

    Attributes
    ----------
    time, energy, summary, channels, state, call, case
        As those of `FrameResult`.
    displacement, force : ndarray, shape (rows,)
        Displacement of the centre of the roof along the direction of the lateral load [m], and the
        factor of this load [N].
    base_shear : ndarray, shape (rows,)
        Force of the ground in this direction [N].
    floor_x, floor_y, floor_rotation : ndarray, shape (rows, floors)
        Displacements of the centres of mass [m], and rotations of the floors, counterclockwise
        [rad].
    plane_shear : ndarray, shape (rows, frames)
        Force of the ground on each frame along its x axis [N], without forces of damping.
    structure : Building
        The building.
    """

    floor_x: ClassVar[Array]
    floor_y: ClassVar[Array]
    floor_rotation: ClassVar[Array]
    plane_shear: ClassVar[Array]

    @property
    def building(self) -> Building:
        """The building."""
        building: Building = self.structure
        return building

    @property
    def scope_note(self) -> str:
        """Scope of the results, printed with them."""
        return self.building.scope_note

    @property
    def base_shear_x(self) -> Array:
        """Force of the ground along x, without forces of damping, shape (rows,) [N]."""
        return self._of_planes(0)

    @property
    def base_shear_y(self) -> Array:
        """Force of the ground along y, without forces of damping, shape (rows,) [N]."""
        return self._of_planes(1)

    @property
    def base_torque(self) -> Array:
        """Moment of the ground about the origin in plan, counterclockwise, shape (rows,) [N m]."""
        return self._of_planes(2)

    def _of_planes(self, at: int) -> Array:
        """Return the sum of the planes' shears: along x (`at` = 0), along y (1), the torque (2)."""
        shares = [(*plane.direction, plane.arm)[at] for plane in self.building.planes]
        return np.asarray(self.plane_shear @ np.array(shares))

    def moved(self, place: Sequence[float]) -> Array:
        """Return the displacement of a place in plan on all floors, shape (rows, floors, 2) [m]."""
        at = _arguments.finite_vector(place, "building: place")
        if at.size != 2:
            raise InputError(f"building: place = {_arguments.shown(place)} must be x and y [m]")
        x, y = at
        centre = self.building.centres
        u = self.floor_x - self.floor_rotation * (y - centre[:, 1])
        v = self.floor_y + self.floor_rotation * (x - centre[:, 0])
        return np.stack((u, v), axis=-1)

    def drift_at(self, place: Sequence[float]) -> Array:
        """Return storey drifts along x and y at a place in plan, shape (rows, storeys, 2)."""
        moved = self.moved(place)
        below = np.concatenate((np.zeros_like(moved[:, :1]), moved[:, :-1]), axis=1)
        heights = np.array(self.building.storey_heights)[:, None]
        return np.asarray((moved - below) / heights)

    @property
    def storey_drift_x(self) -> Array:
        """Storey drifts along x at the centre of mass of the first floor, (rows, storeys)."""
        return np.asarray(self.drift_at(self.building.centres[0])[..., 0])

    @property
    def storey_drift_y(self) -> Array:
        """Storey drifts along y at the centre of mass of the first floor, (rows, storeys)."""
        return np.asarray(self.drift_at(self.building.centres[0])[..., 1])

    @property
    def corner_drift(self) -> Array:
        """Largest drift of any corner of the floor above, in any direction, (rows, storeys)."""
        sizes: dict[tuple[float, ...], Array] = {}
        largest = []
        for i in range(len(self.building.storey_heights)):
            corners = list(map(tuple, self.building.corners(i + 1).tolist()))
            for at in corners:
                if at not in sizes:
                    sizes[at] = np.hypot(*np.moveaxis(self.drift_at(at), -1, 0))
            largest.append(np.max([sizes[at][:, i] for at in corners], axis=0))
        return np.column_stack(largest)

    def frame(self, name: str) -> FrameResult:
        """Return the response of one frame, with all that a planar frame has.

        Its `displacement` is that of the building, its `base_shear` that of the frame.

        Parameters
        ----------
        name : str
            Of the frame: "x-1", or as it was given.

        Raises
        ------
        InputError
            If the building has no such frame.
        """
        known: dict[str, FrameResult] = vars(self).setdefault("_frames", {})
        if name not in known:
            known[name] = self._cut(self.building.plane(name))
        return known[name]

    @property
    def frames(self) -> dict[str, FrameResult]:
        """Responses of all frames, by their names."""
        return {plane.name: self.frame(plane.name) for plane in self.building.planes}

    def _cut(self, plane: Plane) -> FrameResult:
        """Return the response of a frame: the channels of its own nodes, members and springs."""
        building, parts = self.building, self.building.parts
        prefix, frame = f"{plane.name}:", self.building.frame_of(plane.name)
        channels = dict(self.channels)
        for name in (*_OF_FLOORS, "plane_shear", "ground_acceleration_y"):
            channels.pop(name, None)
        number = building.planes.index(plane)
        channels["base_shear"] = self.plane_shear[:, number]
        of_node = {node: i for i, node in enumerate(parts.nodes)}
        at = [of_node.get(prefix + node, -1) for node in frame.parts.nodes]
        for name in OF_NODES:
            if name in channels:
                # A foot without a column is no node of the building: its place -1 takes the zeros.
                padded = np.column_stack((channels[name], np.zeros(self.time.size)))
                channels[name] = padded[:, at]
        columns = [i for i, member in enumerate(parts.members) if member.startswith(prefix)]
        for name in _OF_MEMBERS:
            if name in channels:
                channels[name] = channels[name][:, columns]
        for group, pair in CHANNELS.items():
            springs = parts.springs_of(group)
            columns = [i for i, spring in enumerate(springs) if spring.member.startswith(prefix)]
            for name in pair:
                if name in channels and columns:
                    channels[name] = channels[name][:, columns]
                else:
                    channels.pop(name, None)
        if "ground_acceleration" in channels:
            across = self.channels["ground_acceleration_y"]
            cosine, sine = plane.direction
            channels["ground_acceleration"] = (
                cosine * channels["ground_acceleration"] + sine * across
            )
        summary = {k: v for k, v in self.summary.items() if k not in _OF_ONE_MEMBER}
        result = FrameOfBuilding(channels, summary, frame, self.call, None, None)
        vars(result).update(building_result=self, plane=plane)
        if not self.dynamic and self.path is not self:
            vars(result)["_path"] = self.path.frame(plane.name)
        else:
            vars(result)["_is_path"] = True
        return result

    def may_have_lost(self, displacement: float = np.inf) -> list[str]:
        """Return what `FrameResult.may_have_lost` finds in all frames, with the frame's name."""
        return [
            f"{name}:{member}"
            for name, result in self.frames.items()
            for member in result.may_have_lost(displacement)
        ]

    @cached_property
    def events(self) -> LimitStates:
        """Limit states of the springs of all frames, in the order in which they are reached."""
        states = [
            replace(event, member=f"{name}:{event.member}")
            for name, result in self.frames.items()
            for event in result.events
        ]
        return LimitStates(states, self)

    @cached_property
    def both_planes(self) -> dict[str, float]:
        """Columns that are beyond yield in both planes at once, each with the time of the first."""
        first_beyond: dict[str, float] = {}
        path = self.path
        shared = self.building.axial_of
        names = {column.split(":")[0] for pair in shared.items() for column in pair}
        beyond = {name: _beyond_yield(path.frame(name)) for name in names}
        for second, first in shared.items():
            (first_plane, c1), (second_plane, c2) = first.split(":"), second.split(":")
            sides = (
                [beyond[first_plane].get((c1, end)) for end in (0.0, 1.0)],
                [beyond[second_plane].get((c2, end)) for end in (0.0, 1.0)],
            )
            for a, b in zip(*sides, strict=True):
                both = np.zeros(1) if a is None or b is None else np.logical_and(a, b)
                if not both.any():
                    continue
                time = float(path.time[int(both.argmax())])
                first_beyond[first] = min(time, first_beyond.get(first, np.inf))
        return first_beyond

    def _owners(self, channel: str) -> Sequence[object]:
        """Return floors, planes, nodes, members or springs that a channel has columns for."""
        if channel in _OF_FLOORS:
            return range(1, len(self.building.storey_heights) + 1)
        if channel == "plane_shear":
            return [plane.name for plane in self.building.planes]
        return owners(self.building.parts, channel)

    def __getstate__(self) -> dict[str, Any]:
        """Leave out the frames: they are cut anew."""
        return {k: v for k, v in super().__getstate__().items() if k != "_frames"}


def _beyond_yield(result: FrameResult) -> dict[tuple[str, float], Array]:
    """Return in which rows an end of a member is turned beyond its yield, by member and end."""
    beyond: dict[tuple[str, float], Array] = {}
    for (spring, values, _), reached in zip(result._springs, result._reached, strict=True):
        if spring.group != "flexure" or spring.position not in (0.0, 1.0):
            continue
        marks = [(mark.side, mark.deformation) for mark, _ in reached if mark.name == "yield"]
        there = np.zeros(values.size, bool)
        for side, turned in marks:
            there |= side * values >= abs(turned) * (1.0 - 1e-9)
        beyond[spring.member, spring.position] = there
    return beyond


def both_planes_note(result: BuildingResult) -> str:
    """Return a note on columns that yield in both planes at once; empty without."""
    columns = result.both_planes
    if not columns:
        return ""
    name = min(columns, key=lambda column: columns[column])
    more = f", and {len(columns) - 1} more columns" if len(columns) > 1 else ""
    when = f"{columns[name]:.4g} s" if result.dynamic else f"point {columns[name]:.4g}"
    return (
        f"column {name}{more}: both of its planes are beyond yield at once, first at {when}; "
        "planar hinges do not know of each other, and on a diagonal they carry 1.2 to 1.7 times "
        "what the column does"
    )
