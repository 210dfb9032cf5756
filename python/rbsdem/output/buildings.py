"""Figures of buildings: their plan with the motion of a floor, and their frames in space."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import _arguments
from rbsdem._types import Array
from rbsdem.errors import InputError
from rbsdem.model.shape import Section
from rbsdem.model.wall import WallSection
from rbsdem.output.frames import (
    HINGE,
    MEMBER,
    STATES,
    UNDEFORMED,
    deformed,
    hinge_points,
    row_of,
    scale_of,
    spring_rotations,
)
from rbsdem.output.style import MODEL_LINE, axes_or_new, new_axes, style, style_of
from rbsdem.run.building_result import BuildingResult
from rbsdem.section.plan import Building, Plane

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Size of what has no section in plan [m].
_MARK = 0.3


def plan(
    shown: Building | BuildingResult,
    *,
    floor: int | None = None,
    row: int = -1,
    scale: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a building in plan: its frames, columns and walls, and the centre of mass of a floor.

    Of a result the floor is drawn where it has moved, with the path of its centre.

    Parameters
    ----------
    shown : Building or BuildingResult
        The building, or the result of an analysis.
    floor : int, optional
        Which floor, from 1; by default the roof.
    row : int, optional
        Row of the result, the last one by default.
    scale : float, optional
        Factor of the displacements; by default such that the largest is a tenth of the building.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in m.

    Raises
    ------
    InputError
        If there is no such row or floor.
    """
    building, result = _building_of(shown, "plot.plan")
    floors = len(building.storey_heights)
    number = floors if floor is None else floor
    at = _arguments.integer(number, "plot.plan: floor", least=1, most=floors) - 1
    lines: list[Array] = []
    moving: list[Array] = []
    for plane in building.planes:
        parts = plane.frame.parts
        x = parts.x[np.unique(parts.ends)], parts.x[parts.floor == at + 1]
        for found, along in zip((lines, moving), map(np.unique, x), strict=True):
            found.append(_in_space(plane, np.column_stack((along, 0.0 * along)))[:, :2])
    places = np.vstack(lines)
    wide, high = np.ptp(places, axis=0)
    size = (4.6, float(np.clip(4.6 * high / max(wide, 1e-3) + 0.5, 2.0, 6.0)))
    with axes_or_new(ax, size) as drawn:
        for plane, line in zip(building.planes, lines, strict=True):
            drawn.plot(*line.T, color="0.6", linewidth=0.7, linestyle=(0, (6, 2, 1, 2)), zorder=1)
            cosine, sine = plane.direction
            start = line[0] - 0.06 * max(wide, high) * np.array([cosine, sine])
            drawn.annotate(
                plane.name,
                tuple(start),
                ha="center",
                va="center",
                fontsize=7.5,
                zorder=5,
                bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.8},
            )
            for corner in _uprights(plane, at + 1):
                drawn.fill(*corner.T, facecolor="0.3", edgecolor="black", linewidth=0.4, zorder=3)
        centre = building.centres[at]
        drawn.plot(*centre, marker="+", color="black", markersize=9.0, zorder=4)
        if result is not None:
            row = row_of(result, row)
            path = np.column_stack((result.floor_x[:, at], result.floor_y[:, at]))
            moved = np.array([result.moved(place)[row, at] for place in places])
            scale = scale_of(scale, np.hypot(*moved.T), max(wide, high), "plot.plan")
            drawn.plot(*(centre + scale * path).T, **MODEL_LINE | {"color": "#c0392b", "zorder": 4})
            # Where the building steps back a floor ends before the line.
            for line in (own for own in moving if own.size):
                ends = np.array([result.moved(end)[row, at] for end in line[[0, -1]]])
                drawn.plot(*(line[[0, -1]] + scale * ends).T, **MEMBER)
        drawn.set_title(f"Floor {at + 1}" + (f", displacements × {scale:g}" if result else ""))
        drawn.set_aspect("equal")
        drawn.margins(0.12)
        drawn.set(xlabel="$x$ (m)", ylabel="$y$ (m)")
    return drawn


def building(
    shown: Building | BuildingResult,
    *,
    row: int = -1,
    scale: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the frames of a building in space; of a result their shape, and hinges by their state.

    Parameters
    ----------
    shown : Building or BuildingResult
        The building, or the result of an analysis.
    row : int, optional
        Row of the result, the last one by default.
    scale : float, optional
        Factor of the displacements; by default such that the largest is a tenth of the building.
    ax : matplotlib axes with three axes, optional
        Where to draw (``projection="3d"``); a new figure without it.

    Returns
    -------
    matplotlib axes
        The axes, in m.

    Raises
    ------
    InputError
        If there is no such row, or the axes are plane.
    """
    structure, result = _building_of(shown, "plot.building")
    if ax is not None and not hasattr(ax, "get_zlim"):
        raise InputError('plot.building: ax must be axes in space, of projection="3d"')
    drawn: Any = ax
    if ax is None:
        with style():
            drawn = new_axes(1, 1, (5.0, 4.2), subplot_kw={"projection": "3d"})[0]
    corners = structure.corners(1)
    size = float(max(np.ptp(corners, axis=0).max(), structure.parts.y.max()))
    if result is not None:
        row = row_of(result, row)
        moved = np.array([result.moved(corner)[row] for corner in corners])
        scale = scale_of(scale, np.hypot(*np.moveaxis(moved, -1, 0)), size, "plot.building")
    points: dict[str, list[Array]] = {state: [] for state in STATES}
    with style_of(drawn):
        for plane in structure.planes:
            for state, at in _draw_frame(drawn, structure, plane, result, row, scale or 1.0):
                points[state].append(at)
        for state, (label, fill) in STATES.items():
            if points[state]:
                drawn.plot(*np.array(points[state]).T, **HINGE, markerfacecolor=fill, label=label)
        if any(points.values()):
            drawn.legend(
                loc="upper center", bbox_to_anchor=(0.5, -0.04), ncols=4, handletextpad=0.0
            )
        if result is not None:
            drawn.set_title(f"Displacements × {scale:g}")
        drawn.set(xlabel="$x$ (m)", ylabel="$y$ (m)", zlabel="Height (m)")
        drawn.set_aspect("equal")
        drawn.grid(False)
    return drawn  # type: ignore[no-any-return]


def _draw_frame(
    drawn: Any,
    structure: Building,
    plane: Plane,
    result: BuildingResult | None,
    row: int,
    scale: float,
) -> Iterator[tuple[str, Array]]:
    """Draw a frame in space; yield the states and places of its hinges."""
    frame = structure.frame_of(plane.name)
    nodes = np.column_stack((frame.parts.x, frame.parts.y))
    for ends in frame.parts.ends:
        drawn.plot(*_in_space(plane, nodes[ends]).T, **(UNDEFORMED if result else MEMBER))
    if result is None:
        return
    of_frame = result.frame(plane.name)
    turns = spring_rotations(of_frame, row)
    moved = nodes + scale * np.column_stack((of_frame.x[row], of_frame.y[row]))
    for member in frame.geometry.values():
        kind = frame.kinds[member.name]
        # The post of a wall is drawn with the wall.
        if member.name in frame.struts or (kind.ends == "pinned" and kind.axial_spring is None):
            continue
        bent = deformed(of_frame, member, row, scale, turns)
        start, end = nodes[[member.start, member.end]]
        still = start + np.linspace(0.0, 1.0, len(bent))[:, None] * (end - start)
        bent = np.vstack((moved[member.start], bent, moved[member.end]))
        across = scale * _across(result, plane, row, np.vstack((start, still, end)))
        drawn.plot(*_in_space(plane, bent, across).T, **MEMBER)
    for state, places in hinge_points(frame, of_frame, row, scale).items():
        for before, after in places:
            across = scale * _across(result, plane, row, np.reshape(before, (1, 2)))
            yield state, _in_space(plane, np.reshape(after, (1, 2)), across)[0]


def _building_of(
    shown: Building | BuildingResult, who: str
) -> tuple[Building, BuildingResult | None]:
    """Return a building and its result, None if only the building is shown."""
    if isinstance(shown, BuildingResult):
        return shown.building, shown
    remedy = "or the result of one"
    return _arguments.instance(shown, who, Building, remedy), None


def _in_space(plane: Plane, points: Array, across: Array | float = 0.0) -> Array:
    """Return points of a frame in space, shape (points, 3), moved across its plane."""
    cosine, sine = plane.direction
    # Without a place along its axis it begins at the foot of the perpendicular.
    places = replace(plane, along=plane.along or 0.0).places(points[:, 0])
    places = places + np.outer(np.broadcast_to(across, len(points)), [-sine, cosine])
    return np.column_stack((places, points[:, 1]))


def _across(result: BuildingResult, plane: Plane, row: int, points: Array) -> Array:
    """Return how far points of a frame move across its plane, between floors linearly [m]."""
    building = result.building
    levels = building.floor_levels
    cosine, sine = plane.direction
    x, y = _in_space(plane, points)[:, :2].T[:, :, None] - building.centres.T[:, None, :]
    turned = result.floor_rotation[row]
    moved = cosine * (result.floor_y[row] + turned * x) - sine * (result.floor_x[row] - turned * y)
    return np.array(
        [
            np.interp(z, levels, [0.0, *motion])
            for z, motion in zip(points[:, 1], moved, strict=True)
        ]
    )


def _uprights(plane: Plane, storey: int) -> list[Array]:
    """Return the corners of the columns and walls of a frame in plan, below a floor."""
    frame, corners_of = plane.frame, []
    cosine, sine = plane.direction
    axes = np.array([[cosine, sine], [-sine, cosine]])
    for name, member in frame.geometry.items():
        kind = frame.kinds[name]
        floors = frame.parts.floor[[member.start, member.end]]
        if not member.upright or storey not in floors or floors.max() != storey:
            continue
        if kind.ends == "pinned" and kind.sections is None:
            continue
        section: Section | None = kind.sections[0] if kind.sections else None
        depth, width = (section.depth, section.width) if section else (_MARK, _MARK)
        if isinstance(section, WallSection):
            width = section.web_width
        centre = _in_space(plane, np.array([[frame.parts.x[member.start], 0.0]]))[0, :2]
        corners = 0.5 * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * (depth, width)
        corners_of.append(centre + corners @ axes)
    return corners_of
