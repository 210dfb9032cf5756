"""The response of a column."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.model.springs import Gauge, Layered, Strains, strains_of
from rbsdem.run.limit_states import Hinge
from rbsdem.run.limit_states import hinge as hinge_of
from rbsdem.run.rows import Result


@dataclass(frozen=True, repr=False, eq=False)
class ColumnResult(Result):
    """The result of an analysis of a column: a row for each kept step, a column for each joint.

    Summary, structure, call and others are those of `rbsdem.Result`.

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
    opening : ndarray, shape (steps, n)
        Opening of the joints at the middle of the section [m]: of axial springs, and, if the
        analysis was called with ``openings=True``, of layered joints. Zero for other joints.
    axial_force : ndarray, shape (steps, n), or None
        Forces of the axial springs, tension positive [N]; None if joints do not open.
    top : ndarray, shape (steps, 2)
        Position (x, y) of the top relative to the ground [m].
    rest : ndarray, shape (steps, n), or None
        Rotations of layered joints under their first axial load, from which `rotation` counts
        [rad]; zero but for unsymmetric sections. None if the openings were not kept.
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
    def base_action(self) -> Array:
        """Moment of the lowest joint, by which results are compared [N m]."""
        return self.moment[:, 0]

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

        Negative values are a shortening. The height that the top loses as the bodies turn is not
        part of it, but of `top`.

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
            Part that each layer stands for, and the length over which it deforms. Not needed for
            the hinge of a column that was made from its drawing.

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
        """Raise `InputError` if there are layered joints, and their openings were not kept."""
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
        """Return a channel of the motion of the top; messages call it `name`."""
        if not self.dynamic:
            raise InputError(f"{name}: nothing moves in a static path; use time_history")
        if channel not in self.channels:
            raise InputError(f"{name} was not kept; run the analysis with motion=True")
        return self.channels[channel]

    @property
    def residual_drift(self) -> float:
        """Drift ratio that is left at the end.

        Of a response in time it is the drift in the last row, as in the table of an ensemble: let
        the motion end with rest, so that the swing has died away. Of a static path it is the drift
        at the last zero of the force, NaN if the force never returns to zero.
        """
        if not self.displacement.size:
            return math.nan
        if self.dynamic:
            return float(self.displacement[-1]) / self.column.height
        return _last_zero(self.path.displacement, self.path.force) / self.column.height

    def hinge(self, joint: int = 1, *, length: float | None = None) -> Hinge:
        """Return rotation, plastic rotation and curvature of a hinge.

        Parameters
        ----------
        joint : int, optional
            The joint, from 1 at the ground to n.
        length : float, optional
            Length of the hinge for its curvature [m]. Known of the hinge of a column that was made
            from its drawing by the layered model.

        Raises
        ------
        InputError
            If there is no such joint, or the openings of a layered hinge were not kept in time.
        """
        return hinge_of(self, joint, length)

    def _owners(self, channel: str) -> Sequence[object]:
        return self.column.joint_numbers


def _last_zero(displacement: Array, force: Array) -> float:
    """Return the displacement at the last zero of the force [m], NaN if it never returns to it."""
    if force[-1] == 0:
        return float(displacement[-1])
    changes = np.flatnonzero(force[1:] * force[:-1] <= 0)
    # No return begins in a row without force: at the start, or at a zero found from the row before.
    changes = changes[force[changes] != 0]
    if changes.size == 0:
        return math.nan
    row = int(changes[-1])
    share = force[row] / (force[row] - force[row + 1])
    return float(displacement[row] + share * (displacement[row + 1] - displacement[row]))
