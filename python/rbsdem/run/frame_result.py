"""The response of a frame."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, Literal

import numpy as np

from rbsdem import _core
from rbsdem._files import data_frame, text_table
from rbsdem._types import Array
from rbsdem.curves.envelope import Envelope
from rbsdem.errors import InputError
from rbsdem.model.frame import FrameParts, FrameSpring, MemberGeometry, index_of
from rbsdem.model.springs import Landmark, LandmarkName
from rbsdem.run.limit_states import LimitState, LimitStates
from rbsdem.run.rows import Result
from rbsdem.section.criteria import Criterion, joint_criteria
from rbsdem.section.frame import Frame
from rbsdem.section.strength import AXIAL_FAILURE_FACTORS

#: Channels of nodes, and those of the springs' deformations and forces by group.
OF_NODES = ("x", "y", "node_rotation", "node_acceleration")
CHANNELS = {
    "flexure": ("rotation", "moment"),
    "shear": ("slip", "shear"),
    "axial_spring": ("opening", "axial_force"),
}

#: Shares of the strength in shear, of members and of walls, from which a note tells of an end with
#: another M/V; the relative difference of M/V that is told.
_TELLING, _TELLING_OF_WALLS, _OFF_SPAN = 0.5, 0.1, 0.2

#: Name of the event where a member has reached its strength in shear, beyond which its force falls,
#: and the rules of shear springs whose force falls there.
FAILS, _FALLING = "shear_failure", ("peak_oriented", "pinching")

#: Names of criteria of layers among those of springs.
_NAMES = {"first_yield": "yield"}

#: A threshold counts as reached within round-off: a path stands on it exactly.
_REACHED = 1.0 - 1e-9


@dataclass(frozen=True, repr=False)
class MemberHistory:
    """The history of a member: arrays with a row for each row of the result.

    Attributes
    ----------
    name : str
        The member.
    axial : ndarray, shape (rows,)
        Axial force, compression positive [N].
    moment : ndarray, shape (rows, 2)
        Moments at the ends of its clear length, clockwise on the member positive [N m].
    shear : ndarray, shape (rows, 2)
        Shear forces at the ends, (M_a + M_b)/L with the share of a load on the member [N].
    chord_rotation, plastic_rotation : ndarray, shape (rows, 2)
        Clockwise rotations of the faces of the ends against the chord of the clear length [rad],
        and what is beyond that at which the end yielded first to the side.
    geometry : MemberGeometry
        Where it is; its `moment` and `shear` give forces between the ends.
    springs : tuple of FrameSpring
        Its springs.
    deformation, force : ndarray, shape (rows, springs)
        Of the springs [rad, N m; m, N].
    ductility : ndarray, shape (springs,)
        Largest deformation over that at yield, NaN for springs that do not yield; of a member that
        is lost, before that.
    """

    name: str
    axial: Array
    moment: Array
    shear: Array
    chord_rotation: Array
    plastic_rotation: Array
    geometry: MemberGeometry
    springs: tuple[FrameSpring, ...]
    deformation: Array
    force: Array
    ductility: Array

    def __str__(self) -> str:
        ends = {
            "moment_Nm": self.moment,
            "shear_N": self.shear,
            "chord_rotation_rad": self.chord_rotation,
            "plastic_rotation_rad": self.plastic_rotation,
        }
        rows = {name: np.abs(values).max(axis=0) for name, values in ends.items()}
        axial = f"axial force {self.axial.min():.4g} to {self.axial.max():.4g} N"
        table = text_table(data_frame({"end": ["start", "end"]} | rows))
        return f"{self.name}, {axial}; largest at its ends:\n{table}"

    def __repr__(self) -> str:
        return f"MemberHistory({self.name}, {self.axial.size} rows)"


@dataclass(frozen=True, repr=False, eq=False)
class FrameResult(Result):
    """The result of an analysis of a frame: arrays with a row for each that was kept.

    Attributes
    ----------
    time : ndarray, shape (rows,)
        Time [s]; on a static path the number of the point.
    displacement : ndarray, shape (rows,)
        Displacement of the top (`Frame.control_node`) [m], counted from the frame without load.
    force : ndarray, shape (rows,)
        Factor of the lateral load [N]: its sum, unless ``pattern="nodes"``.
    base_shear : ndarray, shape (rows,)
        Force of supports and springs of the ground along x [N]; in time with
        damping by mass.
    energy : dict of ndarray
        Energies [J] as those of `ColumnResult`; "axial" is the potential of dead load, of
        second-order work and of what is elastic.
    x, y, node_rotation : ndarray, shape (rows, nodes)
        Displacements of the nodes along x and upward [m], clockwise rotations [rad].
    member_axial, moment_from, moment_to : ndarray, shape (rows, members)
        Axial forces, compression positive [N], and moments of the ends [N m].
    springs : dict of ndarray, shape (rows, springs)
        Deformations and forces of the springs in members: rotation and moment, slip and shear,
        opening and axial_force, in the order of `Frame.parts`.
    summary, channels, reached, case
        As those of `rbsdem.Result`.
    frame, structure : Frame
        The frame.
    call : dict
        The loading and the settings that were given.
    acceleration : ndarray, shape (rows, nodes), or None
        Accelerations of the nodes along x in space [m/s2], if they were kept (``motion=True``);
        NaN where a node has no mass along x.
    state : ndarray or None
        The state at the end, for ``initial=``.
    lost : ndarray, shape (rows, members), or None
        1 from where a member carries nothing any more, else 0; None if none may be lost
        (`FrameMember.failure_drift`, `Frame.losses`).
    """

    _derived: ClassVar[tuple[str, ...]] = ("energy", "springs", "acceleration")

    @property
    def frame(self) -> Frame:
        """The frame."""
        frame: Frame = self.structure
        return frame

    @property
    def scope_note(self) -> str:
        """Scope of the results, printed with them."""
        return self.frame.scope_note

    @property
    def springs(self) -> dict[str, Array]:
        """Deformations and forces of the springs, by the names of their channels."""
        names = [name for pair in CHANNELS.values() for name in pair]
        return {name: self.channels[name] for name in names if name in self.channels}

    @property
    def acceleration(self) -> Array | None:
        """Accelerations of the nodes along x in space [m/s2], if they were kept."""
        if "node_acceleration" not in self.channels:
            return None
        ground = self.channels["ground_acceleration"][:, None]
        return np.asarray(self.channels["node_acceleration"] + ground)

    @property
    def storey_drift(self) -> Array:
        """Drift ratio of each storey, shape (rows, storeys).

        Difference of the displacements of the floors, mean of their nodes, over the height.
        """
        heights, floors = np.array(self._storeys()), self.floor_displacement
        return np.asarray(np.diff(floors, axis=1) / heights)

    @property
    def floor_displacement(self) -> Array:
        """Displacement of the floors from the base up, mean of their nodes [m]."""
        count = len(self._storeys()) + 1
        floor = self.frame.parts.floor
        return np.column_stack([self.x[:, floor == i].mean(axis=1) for i in range(count)])

    @property
    def floor_acceleration(self) -> Array:
        """Accelerations of the floors in space, mean of their nodes [m/s2]; needs motion=True."""
        if self.acceleration is None:
            raise InputError("accelerations were not kept; run the analysis with motion=True")
        count = len(self._storeys()) + 1
        floor = self.frame.parts.floor
        return np.column_stack(
            [self.acceleration[:, floor == i].mean(axis=1) for i in range(1, count)]
        )

    @property
    def residual_drift(self) -> Array:
        """Storey drifts in the last row, shape (storeys,)."""
        return np.asarray(self.storey_drift[-1])

    @cached_property
    def chord_rotation(self) -> Array:
        """Rotations of members' ends against the chord, shape (rows, members, 2) [rad].

        Clockwise rotations of the faces against the line between the ends of the clear length.
        """
        parts = self.frame.parts
        rotations = np.empty((self.time.size, len(parts.members), 2))
        # Rotations of nodes are those of their columns.
        panels = {
            spring.member: self.springs["rotation"][:, i]
            for i, spring in enumerate(parts.springs_of("flexure"))
            if spring.group == "panel"
        }
        for i, member in enumerate(self.frame.geometry.values()):
            for j, node in enumerate((member.start, member.end)):
                beside = 0.0 if member.upright else panels.get(parts.nodes[node], 0.0)
                rotations[:, i, j] = self.node_rotation[:, node] - beside
            rotations[:, i] -= self._chord(member, rotations[:, i])[:, None]
        return rotations

    def _chord(self, member: MemberGeometry, turned: Array | None = None) -> Array:
        """Return the clockwise rotation of the chord of a member [rad], shape (rows,).

        The chord joins the ends of the clear length, which lie off the nodes by the rigid lengths.
        `turned` are the rotations of these lengths [rad], by default those of the nodes.
        """
        nodes = [member.start, member.end]
        turned = self.node_rotation[:, nodes] if turned is None else turned
        across = self.x[:, nodes] * member.normal[0] + self.y[:, nodes] * member.normal[1]
        return np.asarray((np.diff(across)[:, 0] - turned @ np.array(member.rigid)) / member.clear)

    def _end_forces(self, member: MemberGeometry, at: int) -> tuple[Array, Array]:
        """Return the forces of a member on the nodes at its two ends, each shape (rows, 3).

        Along x and upward [N], and clockwise [N m], in equilibrium with the loads on the member,
        with the second-order work of its axial force under the dead load.
        """
        ends = self.moment_from[:, at], self.moment_to[:, at]
        lean = np.zeros(self.time.size)
        if self.frame.kinematics == "pdelta":
            # What a lost member carried leans with the frame still.
            lean = self.frame.parts.compression[at] * self._chord(member)
        forces = []
        for j, sign in enumerate((1.0, -1.0)):
            across = -sign * (self.end_shear[:, at, j] + lean)
            # The load of the rigid length is carried by the node.
            node = (
                self.member_axial[:, at, None] * (-sign * member.axis)
                + across[:, None] * member.normal
            )
            node[:, 1] -= member.load * abs(member.axis[0]) * member.rigid[j]
            forces.append(np.column_stack((node, -ends[j] + across * member.rigid[j] * sign)))
        return forces[0], forces[1]

    @cached_property
    def reactions(self) -> dict[str, Array]:
        """Forces of supports and springs of the ground on the nodes, each shape (rows, 3).

        Along x and upward [N], and clockwise [N m], by the forces of the members that end in a
        node and its loads; in time without forces of damping.
        """
        frame, parts = self.frame, self.frame.parts
        reactions = {name: np.zeros((self.time.size, 3)) for name in frame.supports}
        nodes = {node.name: node for node in frame.nodes}
        for name in reactions.keys() & nodes.keys():
            node = nodes[name]
            reactions[name] -= np.array([node.load_x, node.load_y, node.load_moment])
        for at, member in enumerate(frame.geometry.values()):
            for i, force in zip(
                (member.start, member.end), self._end_forces(member, at), strict=True
            ):
                if parts.nodes[i] in reactions:
                    reactions[parts.nodes[i]] -= force
        return reactions

    @cached_property
    def base_moment(self) -> Array:
        """Overturning moment of the reactions, clockwise on the ground, shape (rows,) [N m].

        About the ground below the resultant of the dead load, with the second-order moment.
        """
        parts, nodes = self.frame.parts, {node.name: node for node in self.frame.nodes}
        weights = [
            (member.load * abs(parts.x[member.end] - parts.x[member.start]), member)
            for member in self.frame.geometry.values()
        ]
        loads = [(w, 0.5 * (parts.x[member.start] + parts.x[member.end])) for w, member in weights]
        loads += [
            (-nodes[n].load_y, x) for n, x in zip(parts.nodes, parts.x, strict=True) if n in nodes
        ]
        total = sum(load for load, _ in loads)
        about = sum(load * x for load, x in loads) / total if total else float(parts.x.mean())
        low, moment = float(parts.y.min()), np.zeros(self.time.size)
        for name, force in self.reactions.items():
            i = parts.nodes.index(name)
            moment -= force[:, 2] - (parts.x[i] - about) * force[:, 1]
            moment -= (parts.y[i] - low) * force[:, 0]
        return moment

    @cached_property
    def periods(self) -> dict[str, float]:
        """Periods of the first mode [s]: "uncracked", and "secant at yield" of a push-over.

        The latter is T_e of ASCE 41: that of the mass which the first mode moves on K_e, the first
        of the two lines up to the largest force.
        """
        answer = _core.evaluate("modes", made=self.frame._made, count=1)
        # values: the stable step, then omega; rows: x, y and rotations of the n nodes, then masses.
        periods = {"uncracked": 2 * np.pi / float(answer.values[1])}
        if not self.dynamic:
            u, v = self.displacement - self.displacement[0], self.base_shear - self.base_shear[0]
            lines = Envelope(1, np.abs(u), np.abs(v)).idealise("asce_41")
            mass = float(answer.rows[0, 3 * self.frame.n])
            periods["secant at yield"] = 2 * np.pi * float(np.sqrt(mass / lines.stiffness))
        return periods

    @cached_property
    def storey_shear(self) -> Array:
        """Shear of the members just above each floor along x, shape (rows, storeys) [N].

        With the second-order work of their axial forces: on a static path the sum of the lateral
        loads above.
        """
        return self._above_floors()[0]

    @property
    def stability_coefficient(self) -> Array:
        """P-Delta coefficients of the storeys, theta = P d/(V h), shape (rows, storeys).

        P is the dead load above, d/h the storey drift, V the storey shear (EN 1998-1, 4.4.2.2).
        """
        shear, weight = self._above_floors()
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.asarray(weight * self.storey_drift / shear)

    @cached_property
    def infill_shear(self) -> Array:
        """Part of `storey_shear` that struts of infills carry, shape (rows, storeys) [N]."""
        return self._above_floors(set(self.frame.struts))[0]

    def _above_floors(self, names: Collection[str] | None = None) -> tuple[Array, Array]:
        """Return storey shears, (rows, storeys), and dead loads above, (storeys,) [N].

        Of all members, or of those in `names`.
        """
        count, parts = len(self._storeys()), self.frame.parts
        level = self.frame.floor_levels
        cuts = level[:-1] + 1e-3 * np.diff(level)
        shear, weight = np.zeros((self.time.size, count)), np.zeros(count)
        for at, member in enumerate(self.frame.geometry.values()):
            if names is not None and member.name not in names:
                continue
            upward = parts.y[member.start] < parts.y[member.end]
            low, high = sorted((parts.y[member.start], parts.y[member.end]))
            through = (low < cuts) & (cuts < high)
            if through.any():
                lower = self._end_forces(member, at)[0 if upward else 1]
                shear[:, through] += lower[:, :1]
                weight[through] += parts.compression[at] * abs(member.axis[1])
        return shear, weight

    def _storeys(self) -> tuple[float, ...]:
        """Return the heights of the storeys [m], or raise `InputError` if there are none."""
        if not self.frame.storey_heights:
            raise InputError(
                "the frame has no storeys; give it a grid, or its nodes their floors "
                "(FrameNode(floor=...)), or look at `x` of its nodes"
            )
        return self.frame.storey_heights

    def node(self, name: str) -> Array:
        """Return displacement along x and upward [m] and rotation [rad] of a node, (rows, 3)."""
        at = index_of(name, self.frame.parts.nodes, "node")
        return np.column_stack((self.x[:, at], self.y[:, at], self.node_rotation[:, at]))

    def member(self, name: str) -> MemberHistory:
        """Return the history of a member.

        Parameters
        ----------
        name : str
            Its name: C-line-storey, B-bay-storey, or its own.

        Raises
        ------
        InputError
            If there is no such member; the message names the nearest.
        """
        at = index_of(name, self.frame.parts.members, "member")
        numbers, tracks = self._springs_in.get(name, []), self._springs
        deformation = [tracks[i][1] for i in numbers]
        path, ductility = self._measured, []
        for i in numbers:
            kept = path._springs[i][1][: path._lost_at.get(name)]
            yields = [
                landmark.deformation for landmark, _ in path._reached[i] if landmark.name == "yield"
            ]
            largest = float(np.abs(kept).max(initial=0.0))
            ductility.append(largest / min(yields) if yields else np.nan)
        rows = (self.time.size, 0)
        return MemberHistory(
            name,
            self.member_axial[:, at],
            np.column_stack((self.moment_from[:, at], self.moment_to[:, at])),
            self.end_shear[:, at],
            self.chord_rotation[:, at],
            self._plastic(name, self.chord_rotation[:, at]),
            self.frame.geometry[name],
            tuple(tracks[i][0] for i in numbers),
            np.column_stack(deformation) if numbers else np.empty(rows),
            np.column_stack([tracks[i][2] for i in numbers]) if numbers else np.empty(rows),
            np.array(ductility),
        )

    @cached_property
    def end_shear(self) -> Array:
        """Shear forces at the ends of members, shape (rows, members, 2) [N]."""
        where = self.frame.geometry.values()
        clear, load = np.array([(member.clear, member.across_load) for member in where]).T
        sway = (self.moment_from + self.moment_to) / clear
        return np.asarray(np.stack([sway + load * clear * s for s in (-0.5, 0.5)], axis=2))

    def _plastic(self, name: str, turned: Array) -> Array:
        """Return the chord rotations beyond those at the first yield of an end to each side [rad].

        `turned` are the chord rotations of the two ends, shape (rows, 2).
        """
        plastic, path = np.zeros_like(turned), self._measured
        at = self.frame.parts.members.index(name)
        for i in self._springs_in.get(name, []):
            spring = path._springs[i][0]
            if spring.group != "flexure" or spring.position not in (0.0, 1.0):
                continue
            for point, row in path._reached[i]:
                if point.name == "yield" and row is not None:
                    end = int(spring.position)
                    first = _at(row, path.chord_rotation[:, at, end])
                    way = np.sign(first)
                    beyond = np.maximum(way * (turned[:, end] - first), 0.0)
                    beyond[self.time < _at(row, path.time)] = 0.0
                    plastic[:, end] += way * beyond
        return plastic

    @property
    def _measured(self) -> FrameResult:
        """The rows in which limit states are looked for: all corners of a static path."""
        path: FrameResult = self.path
        return path

    @cached_property
    def _springs(self) -> list[tuple[FrameSpring, Array, Array]]:
        """Springs with their deformations and forces, in the order of the groups."""
        springs = self.springs
        return [
            (spring, springs[deformation][:, i], springs[force][:, i])
            for group, (deformation, force) in CHANNELS.items()
            for i, spring in enumerate(self.frame.parts.springs_of(group))
        ]

    @cached_property
    def _springs_in(self) -> dict[str, list[int]]:
        """Places of the springs of each member in the list `_springs`; panels belong to nodes."""
        numbers: dict[str, list[int]] = {}
        for i, (spring, _, _) in enumerate(self._springs):
            if spring.group != "panel":
                numbers.setdefault(spring.member, []).append(i)
        return numbers

    @cached_property
    def _reached(self) -> list[list[tuple[Landmark, float | None]]]:
        """Landmarks of each spring of the list `_springs`, and the row where each is reached first.

        Row 3.5 is half way between rows 3 and 4; None if the landmark is not reached while the
        member still carries load.
        """
        openings = {
            (spring.member, spring.position): values
            for spring, values, _ in self._springs
            if spring.rule == "layered" and spring.group == "axial_spring"
        }
        joints, landmarks, lost = self.frame.joints, self.frame.landmarks, self._lost_at
        watched: dict[int, list[Criterion]] = {}
        first_rows = []
        for spring, whole, _ in self._springs:
            values = whole[: lost.get(spring.member)]
            reached = [
                (point, _first_row(point.side * values / point.deformation))
                for point in landmarks[spring]
            ]
            if spring in joints:
                made = joints[spring]
                # Equal members share their joints.
                if id(made) not in watched:
                    kind = self.frame.kinds[spring.member]
                    watched[id(made)] = joint_criteria(kind, spring.position, made)
                opening = openings[spring.member, spring.position][: values.size]
                reached += _rows_of_layers(watched[id(made)], opening, values)
            first_rows.append(reached)
        return first_rows

    @cached_property
    def events(self) -> LimitStates:
        """Limit states of the springs, in the order in which they are reached first.

        Cracking, yield and cap of each side, "shear_failure" where a shear spring that loses its
        strength behind it has reached that; of drawn members spalling, where an outer layer of
        concrete has lost its strength, of drawn walls spalling at 0.004, "web_yield", "crushing",
        "bar_buckling" and "bar_fracture" as of a single wall; of the struts of infills
        (group "infill") cracking, cap and residual; failures of members. A static path is looked
        at in all of its corners, whichever of its rows were kept (`path`); a response in time in
        its rows.
        """
        path = self._measured
        reached = path._found_events()
        times, own_times, kept = np.array([at for _, at, _ in reached]), path.time, self.time
        # The first kept row at or after each event.
        rows = np.searchsorted(kept, times - 1e-12 * np.abs(times))
        rows = np.minimum(rows, kept.size - 1)
        columns = (path.displacement, path.drift, path.loop_force)
        there = zip(*(np.interp(times, own_times, each).tolist() for each in columns), strict=True)
        return LimitStates(
            [
                LimitState(name, row, at, *values, **where)
                for (name, at, where), row, values in zip(
                    reached, rows.tolist(), there, strict=True
                )
            ],
            self,
        )

    def _found_events(self) -> list[tuple[str, float, dict[str, Any]]]:
        """Return name, time and place (fields of `LimitState`) of states that the rows reach."""
        reached_states: list[tuple[str, float, dict[str, Any]]] = []
        times, struts = self.time, self.frame.struts
        for (spring, _, _), reached in zip(self._springs, self._reached, strict=True):
            rows = [(point, row) for point, row in reached if row is not None]
            if not rows:
                continue
            group = "infill" if spring.member in struts else spring.group
            end = "" if group == "infill" else spring.end
            where = {"member": spring.member, "group": group, "end": end}
            reached_states += [
                (_event_name(spring, point), _at(row, times), where | {"side": point.side})
                for point, row in rows
            ]
        sheared = {
            where["member"]: at for what, at, where in reversed(reached_states) if what == FAILS
        }
        wholes = [(name, "lost", float(self.time[row])) for name, row in self._lost_at.items()]
        # A shear failure by drift is told only if the spring of the member has not failed before.
        wholes += [
            (name, what, at)
            for name, what, at in self._failures()
            if what != FAILS or at < sheared.get(name, np.inf)
        ]
        for what in ("snap", "fall"):
            member = self.summary.get("snap_member" if what == "snap" else "fallen_member")
            if member:
                at = self.summary["snap_time"] if what == "snap" else float(self.time[-1])
                wholes.append((self.frame.parts.members[member - 1], what, at))
        for name, what, at in wholes:
            about: dict[str, Any] = {"member": name, "group": "member"}
            if what == "lost" and self.frame.kinds[name].failure_drift is not None:
                row = min(int(np.searchsorted(self.time, at * (1 - 1e-12))), self.time.size - 1)
                drift = abs(float(self._chord(self.frame.geometry[name])[row]))
                low, high = AXIAL_FAILURE_FACTORS
                about |= {"lower": low * drift, "upper": high * drift}
            reached_states.append((what, at, about))
        return reached_states

    def _failures(self, factor: float = 1.0) -> list[tuple[str, str, float]]:
        """Return member, event and time of shear failures, and of axial failures on a static path.

        With a `factor` on the drift at axial failure, members that would lose their axial load at
        that drift are returned, of a response in time too.
        """
        failures, lost, times, landmarks = [], self._lost_at, self.time, self.frame.landmarks
        for at, (name, kind) in enumerate(self.frame.kinds.items()):
            if kind.failure_drift is None or kind.failure_load is None:
                continue
            drift = np.abs(self._chord(self.frame.geometry[name]))
            failed = drift >= (np.inf if kind.shear_drift is None else kind.shear_drift)
            for spring, values, _ in (self._springs[i] for i in self._springs_in.get(name, [])):
                for point in landmarks[spring] if spring.group == "shear" else ():
                    if point.name == "yield":
                        failed |= point.side * values >= _REACHED * point.deformation
            rows = np.flatnonzero(failed[: lost.get(name)])
            if rows.size:
                failures.append((name, FAILS, float(times[rows[0]])))
            load = np.maximum(self.member_axial[:, at], 0.0)
            limit = factor * kind.failure_drift
            # The drift at axial failure, failure_drift/(1 + N/failure_load), falls with the load.
            falls = (load > 0) & (drift * (1 + load / kind.failure_load) >= limit)
            fallen = np.flatnonzero(falls & np.logical_or.accumulate(failed))
            if fallen.size and (factor != 1.0 or not self.dynamic):
                failures.append((name, "lost", float(times[fallen[0]])))
        return failures

    def may_have_lost(self, most: float = math.inf) -> list[str]:
        """Return members beyond the lower end of the interval of their drift at axial failure.

        They have failed in shear, and carry their axial load in the model.

        Parameters
        ----------
        most : float, optional
            Displacement of the control node up to which a path is looked at [m].
        """
        gone = {event.member for event in self.events if event.name == "lost"}
        moved = np.abs(self.displacement) <= most
        return [
            name
            for name, what, at in self._failures(AXIAL_FAILURE_FACTORS[0])
            if what == "lost" and name not in gone and moved[np.searchsorted(self.time, at)]
        ]

    @cached_property
    def _lost_at(self) -> dict[str, int]:
        """Members that are lost, and the first row in which they are."""
        if self.lost is None:
            return {}
        return {
            name: int(column.argmax())
            for name, column in zip(self.frame.parts.members, self.lost.T, strict=True)
            if column.any()
        }

    def _owners(self, channel: str) -> Sequence[object]:
        return owners(self.frame.parts, channel)


def owners(parts: FrameParts, channel: str) -> Sequence[object]:
    """Return the names of the nodes, members or springs that a channel has columns for."""
    if channel in OF_NODES:
        return parts.nodes
    groups = [group for group, pair in CHANNELS.items() if channel in pair]
    springs = parts.springs_of(groups[0]) if groups else []
    return [f"{one.member}_{one.position:g}" for one in springs] if groups else parts.members


def _first_row(beyond: Array) -> float | None:
    """Return where a deformation over its limit first comes to 1: a row, or between two a share."""
    rows = np.flatnonzero(beyond >= _REACHED)
    if not rows.size:
        return None
    row = int(rows[0])
    # A static path has a corner at the limit: the row stands on it, up to round-off.
    if not row or beyond[row] <= 2.0 - _REACHED:
        return float(row)
    before, there = beyond[row - 1 : row + 1].tolist()
    return float(row - (there - 1.0) / (there - before))


def _rows_of_layers(
    watched: Sequence[Criterion], opening: Array, rotation: Array
) -> list[tuple[Landmark, float | None]]:
    """Return where layers of a joint reach their criteria, for each way that it turns."""
    first: dict[tuple[LandmarkName, Literal[1, -1]], float] = {}
    for each in watched:
        row = _first_row((each.rotation * rotation + each.opening * opening) / each.threshold)
        if row is not None:
            side: Literal[1, -1] = 1 if _at(row, rotation) >= 0 else -1
            name: Any = _NAMES.get(each.name, each.name)
            first[name, side] = min(first.get((name, side), row), row)
    return [
        (Landmark(name, side, abs(_at(row, rotation)), "first layer"), row)
        for (name, side), row in first.items()
    ]


def _at(row: float, values: Array) -> float:
    """Return a value in a row, or between two."""
    return float(np.interp(row, np.arange(values.size), values))


def _event_name(spring: FrameSpring, point: Landmark) -> str:
    """Return the name of an event; the yield of a shear spring that falls there is a failure."""
    fails = spring.group == "shear" and spring.rule in _FALLING and point.name == "yield"
    return FAILS if fails else point.name


def shear_span_note(result: FrameResult) -> str:
    """Return a note on ends whose M/V is not that which their strength in shear was found for.

    M/V is taken at the largest shear force of each direction, if this force is more than half of
    the strength, of a wall a tenth: the joint at the foot of a wall was made for that M/V too.
    """
    frame, off_spans = result.frame, []
    moments = np.stack((result.moment_from, result.moment_to), axis=2)
    for at, (name, kind) in enumerate(frame.kinds.items()):
        if kind.shear_spans is None:
            continue
        springs = dict(kind.shear or ())  # type: ignore[arg-type]
        walls = kind.sections is not None and kind.sections[0].shape == "wall"
        for j, (end, position) in enumerate((("start", 0.0), ("end", 1.0))):
            spring: Any = springs.get(position)
            if not hasattr(spring, "f_y"):
                continue
            # Forces of springs are positive with y > 0 in tension at the start of a member.
            for side, made in zip((2 * j - 1, 1 - 2 * j), kind.shear_spans[j], strict=True):
                shear = side * result.end_shear[:, at, j]
                row = int(shear.argmax())
                strength = spring.f_y if side < 0 else getattr(spring, "f_y_neg", None)
                span = side * float(moments[row, at, j]) / float(shear[row] or 1.0)
                telling = _TELLING_OF_WALLS if walls else _TELLING
                if shear[row] > telling * (strength or spring.f_y) and span > 0:
                    off = span / made
                    if abs(off - 1.0) > _OFF_SPAN:
                        off_spans.append((abs(math.log(off)), name, end, span, made, walls))
    if not off_spans:
        return ""
    _, name, end, span, made, walls = max(off_spans)
    if walls:
        return (
            f"member {name}: at the largest shear force M/V at the foot of the wall is "
            f"{span:.3g} m, and its springs were made for {made:.3g} m; give wall_spans = "
            f"{span:.3g} (shear_span of section.wall_members)"
        )
    more = f", and {len(off_spans) - 1} more are off by a fifth" if len(off_spans) > 1 else ""
    return (
        f"member {name}: at the largest shear force of its {end} M/V is {span:.3g} m, and its "
        f"strength in shear was found for {made:.3g} m{more}; section.member with shear_spans "
        "makes it anew, and a grid takes that in place of the section"
    )
