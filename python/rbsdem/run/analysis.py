"""Analyses of a column."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Literal, overload

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular, text_table
from rbsdem._types import Array
from rbsdem.errors import warn
from rbsdem.model.column import Column
from rbsdem.section.frame import Frame, Structure, checked_structure
from rbsdem.section.plan import Building


@dataclass(frozen=True)
class Modes:
    """Natural modes of the uncracked column.

    Attributes
    ----------
    omega, frequency : ndarray, shape (count,)
        Circular frequencies [rad/s] and frequencies [Hz], ascending.
    shapes : ndarray, shape (2n, count), or (3n, count) where the joints open
        Shapes in (slip 1..n, relative rotation 1..n, opening 1..n), one in each column, with
        shape' M shape = 1.
    stable_step : float
        Longest step for which RK4 is stable, damping included [s].
    """

    omega: Array
    frequency: Array
    shapes: Array
    stable_step: float


@dataclass(frozen=True)
class Matrices:
    """Matrices of the uncracked column for small rotations, M q'' + C q' + (K + K_G) q = p.

    Attributes
    ----------
    unknowns : tuple of str
        Order of the unknowns: slip_1, ..., rotation_1, ... (relative to the body below), and
        opening_1, ... where the joints open. In the paper's form theta_1, ... are absolute
        rotations. The last rotation is no unknown where the top is fixed. Of a frame x_, y_ and
        t_ (rotation) with the names of the nodes, b_ for the rotation of beams behind a panel.
    mass, stiffness, geometric, damping : ndarray, shape (unknowns, unknowns)
        In N, m, kg, s and rad. `geometric` holds the second-order work of the axial forces, zero
        with kinematics "small"; of a frame that on chords, what elastic members bend off their
        chords under these forces being part of their `stiffness`.
    """

    unknowns: tuple[str, ...]
    mass: Array
    stiffness: Array
    geometric: Array
    damping: Array


@dataclass(frozen=True, repr=False, eq=False)
class FrameModes(Tabular):
    """Natural modes of a frame before anything yields, under its dead load; `print` makes a table.

    Attributes
    ----------
    omega, frequency, period : ndarray, shape (count,)
        Circular frequencies [rad/s], frequencies [Hz] and periods [s], the lowest first.
    x, y, node_rotation : ndarray, shape (nodes, count)
        Shapes: displacements of the nodes along x and upward, clockwise rotations, with unit modal
        mass.
    mass : ndarray, shape (count,)
        Modal mass that a motion of the ground along x moves [kg].
    participation : ndarray, shape (count,)
        Its share of the mass of the frame.
    frame : Frame
        The frame.
    """

    omega: Array
    frequency: Array
    period: Array
    x: Array
    y: Array
    node_rotation: Array
    mass: Array
    participation: Array
    frame: Frame
    _columns: ClassVar[tuple[str, ...]] = ("frequency Hz", "period s", "mass kg", "participation")

    def __str__(self) -> str:
        return text_table(self.to_pandas())


@dataclass(frozen=True, repr=False, eq=False)
class BuildingModes(Tabular):
    """Natural modes of a building before anything yields, under its dead load.

    Attributes
    ----------
    omega, frequency, period : ndarray, shape (count,)
        Circular frequencies [rad/s], frequencies [Hz] and periods [s], the lowest first.
    floor_x, floor_y, floor_rotation : ndarray, shape (floors, count)
        Shapes of the floors at their centres of mass, with unit modal mass.
    x, y, node_rotation : ndarray, shape (nodes, count)
        Shapes of the nodes in their planes.
    participation_x, participation_y, participation_rotation : ndarray, shape (count,)
        Shares of the masses, and of the rotary inertia, of the floors.
    building : Building
        The building.
    """

    omega: Array
    frequency: Array
    period: Array
    floor_x: Array
    floor_y: Array
    floor_rotation: Array
    x: Array
    y: Array
    node_rotation: Array
    participation_x: Array
    participation_y: Array
    participation_rotation: Array
    building: Building
    _columns: ClassVar[tuple[str, ...]] = (
        *("frequency Hz", "period s", "participation_x", "participation_y"),
        "participation_rotation",
    )

    def __str__(self) -> str:
        return text_table(self.to_pandas())


def _building_modes(building: Building, count: int | None) -> BuildingModes:
    """Return the modes of a building; participations are shares of its mass or inertia."""
    answer = _core.evaluate("modes", made=building._made, count=count)
    omega, floors = answer.values[1:], len(building.storey_heights)
    x, y, rotation, mass, moved = np.split(answer.rows.T, np.cumsum([building.n] * 3 + [3]))
    whole = building.plan_mass.sum() + sum(node.mass for node in building.nodes if node.floor)
    along_x, along_y, turning = (
        own / (total or 1.0)
        for own, total in zip(mass, (whole, whole, building.inertia.sum()), strict=True)
    )
    # U, V and Theta of each floor
    u, v, turned = moved.reshape(floors, 3, -1).transpose(1, 0, 2)
    return BuildingModes(
        omega,
        omega / (2 * np.pi),
        2 * np.pi / omega,
        *(u, v, turned),
        *(x, y, rotation),
        *(along_x, along_y, turning),
        building,
    )


def _frame_modes(frame: Frame, count: int | None) -> FrameModes:
    """Return the modes of a frame; a participation is the share of its mass that moves along x."""
    answer = _core.evaluate("modes", made=frame._made, count=count)
    omega = answer.values[1:]
    x, y, rotation, mass = np.split(answer.rows.T, np.arange(1, 4) * frame.n)
    share = mass[0] / (frame.parts.mass or 1.0)  # 1: no mass moves along x
    return FrameModes(
        omega, omega / (2 * np.pi), 2 * np.pi / omega, x, y, rotation, mass[0].copy(), share, frame
    )


@overload
def modes(column: Column, count: int | None = None) -> Modes: ...
@overload
def modes(  # type: ignore[overload-overlap]
    column: Building, count: int | None = None
) -> BuildingModes: ...
@overload
def modes(column: Frame, count: int | None = None) -> FrameModes: ...
def modes(column: Structure, count: int | None = None) -> Modes | FrameModes | BuildingModes:
    """Return natural frequencies, mode shapes and the stable step of RK4.

    Parameters
    ----------
    column : Column or Frame
        The axial load takes part with `kinematics` "pdelta" and "finite".
    count : int, optional
        How many modes, the lowest first; each takes a time in proportion to the number of bodies.
        Without it all of them, up to 1506 modes.

    Raises
    ------
    InputError
        If the axial load is above the critical one; the message gives it.

    Warns
    -----
    AccuracyWarning
        If the axial load is so close to the critical one that low frequencies depend on its last
        digits.
    """
    if count is not None:
        count = _arguments.integer(count, "count")
    if isinstance(column, Building):
        return _building_modes(column, count)
    if isinstance(column, Frame):
        return _frame_modes(column, count)
    answer = _core.evaluate("modes", made=checked_structure(column)._made, count=count)
    if answer.text:
        warn(answer.text)
    stable_step, omega = float(answer.values[0]), answer.values[1:]
    return Modes(omega, omega / (2 * np.pi), answer.rows.T, stable_step)


def matrices(column: Structure, form: Literal["symmetric", "paper"] = "symmetric") -> Matrices:
    """Return the matrices of mass, stiffness, geometric stiffness and damping, in full.

    Parameters
    ----------
    column : Column or Frame
        The structure; a frame has the displacements of its nodes as unknowns, x_N-1-1 and so on.
    form : {"symmetric", "paper"}
        In (slip, relative rotation), or in the paper's (slip, absolute rotation) with the rows of
        its eqs 1 and 2 and the mass matrix [A B; C D] of eq 3, its misprints corrected.
        M_symmetric = M_paper T with theta = cumulative sum of phi, and so for the others.
    """
    form = _arguments.choice(form, "form", ("symmetric", "paper"))
    answer = _core.evaluate("matrices", made=checked_structure(column)._made, paper=form == "paper")
    unknowns = tuple(answer.text.splitlines())
    return Matrices(unknowns, *(matrix.copy() for matrix in np.split(answer.rows, 4)))
