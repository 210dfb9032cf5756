"""Figures of frames: shape, hinges, push-over, storey drifts, forces; target and acceptance."""

from __future__ import annotations

from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from rbsdem import _arguments
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, NDArray
from rbsdem.checks.acceptance import Assessment
from rbsdem.checks.target import Target
from rbsdem.errors import InputError
from rbsdem.model.frame import MemberGeometry
from rbsdem.output.style import (
    MODEL_LINE,
    TEST_LINE,
    ZERO_LINE,
    axes_or_new,
    drift_axis,
    line_of,
)
from rbsdem.output.units import factor, labelled, paper
from rbsdem.run.analysis import FrameModes
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.frame_result import FAILS, FrameResult
from rbsdem.run.rows import Result
from rbsdem.section.frame import Frame

if TYPE_CHECKING:
    from matplotlib.axes import Axes


#: Limit states in their order: what a hinge is then, and its fill; what it does, and the marker of
#: that on a path with its fill. Of infills, and of members that are lost, there is no hinge.
_LOOKS = {
    "cracking": ("cracked", "0.7", "cracks", "v", "white"),
    "yield": ("yielded", "black", "yields", "o", "white"),
    "web_yield": ("web yielded", "0.35", "yields in its web", "o", "0.35"),
    "spalling": ("cover spalled", "#e67e22", "spalls", "^", "#e67e22"),
    "crushing": ("core crushed", "#d35400", "is crushed", "^", "#d35400"),
    "bar_buckling": ("bars buckle", "#2e86c1", "has bars that buckle", "d", "#2e86c1"),
    "bar_fracture": ("bar broken", "#1b2631", "has a broken bar", "X", "#1b2631"),
    "cap": ("beyond its cap", "#c0392b", "reaches its cap", "D", "#c0392b"),
    "residual": ("", "", "is at its residual strength", "v", "#a04a26"),
    FAILS: ("failed in shear", "#8e44ad", "fails in shear", "s", "#8e44ad"),
    "lost": ("", "", "is lost", "X", "#c0392b"),
}
#: Labels and fills of hinges.
STATES = {"": ("not reached", "white")} | {
    name: (label, fill) for name, (label, fill, *_) in _LOOKS.items() if label
}
HINGE: dict[str, Any] = {
    "linestyle": "none",
    "marker": "o",
    "markersize": 4.0,
    "markeredgecolor": "black",
    "markeredgewidth": 0.5,
    "zorder": 5,
}
UNDEFORMED: dict[str, Any] = {"color": "0.75", "linewidth": 0.6, "zorder": 1}
MEMBER: dict[str, Any] = {"color": "black", "linewidth": 1.1, "zorder": 3}
_LOST = {"linestyle": ":", "color": "#c0392b"}
_NODE: dict[str, Any] = {
    "linestyle": "none",
    "marker": "s",
    "markersize": 2.6,
    "color": "black",
    "zorder": 4,
}
_SUPPORT: dict[str, Any] = {"color": "black", "linewidth": 0.7, "zorder": 2}

#: Markers of the limit states on a path.
_MARKS: dict[str, dict[str, Any]] = {
    name: {"marker": marker, "markerfacecolor": fill, "markersize": 6.0 if name == "lost" else 4.0}
    for name, (*_, marker, fill) in _LOOKS.items()
}
#: States of infills, their names in a legend and their fills, and how panels are drawn.
_PANELS = {
    "": ("infill", "#f3e3da"),
    "cracking": ("infill cracked", "#e3b9a3"),
    "cap": ("infill beyond its peak", "#cf7f5a"),
    "residual": ("infill at its residual", "#a04a26"),
}
_PANEL: dict[str, Any] = {"edgecolor": "#b08a76", "linewidth": 0.5, "zorder": 0.5}

#: Size of a support and place of a hinge beside its node, in shares of the larger dimension.
_SYMBOL = 0.022
_BESIDE = 0.016

#: Forces along members, and titles of their figures.
_FORCES = {
    "moment": ("Moments", "N m"),
    "shear": ("Shear forces", "N"),
    "axial": ("Axial forces", "N"),
}
#: Points at which a member is drawn, in shares of its clear length.
_SHARES = np.linspace(0, 1, 25)
#: Most members whose names and forces are written.
_NAMED = 60


def frame(
    shown: Frame | FrameResult,
    *,
    row: int = -1,
    scale: float | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a frame with its supports; of a result its deformed shape and the state of its hinges.

    Members bend as cubic lines between the displacements and rotations of their ends; rotations of
    hinges at the ends are those beyond yield, or the whole of springs that were given one by one.
    A hinge has the furthest limit state of those that it has reached up to the row. Members that
    are lost are dotted.

    Parameters
    ----------
    shown : Frame or FrameResult
        The frame, or the result of an analysis.
    row : int, optional
        Row of the result, the last one by default.
    scale : float, optional
        Factor of the displacements; by default such that the largest is a tenth of the frame.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in m.

    Raises
    ------
    InputError
        If there is no such row.
    """
    if isinstance(shown, FrameResult):
        result, structure = shown, shown.frame
    else:
        result, structure = None, _arguments.instance(shown, "plot.frame", Frame)
    size = _size(structure)
    if result is not None:
        row = row_of(result, row)
        scale = scale_of(scale, np.hypot(result.x[row], result.y[row]), size, "plot.frame")
    with axes_or_new(ax, _figure_size(structure)) as drawn:
        _draw_supports(drawn, structure, size)
        moved = _undeformed(drawn, structure, result is None)
        if result is not None:
            assert scale is not None
            moved = moved + scale * np.column_stack((result.x[row], result.y[row]))
            turns = spring_rotations(result, row)
            for i, member in enumerate(structure.geometry.values()):
                if member.name in structure.struts:
                    continue
                bent = deformed(result, member, row, scale, turns)
                lost = result.lost is not None and result.lost[row, i] > 0
                line = MEMBER | (_LOST if lost else {})
                drawn.plot(*bent.T, **line)
                for node, end in ((member.start, bent[0]), (member.end, bent[-1])):
                    drawn.plot(*np.vstack((moved[node], end)).T, **line)
            drawn.set_title(_heading(result, row, f"Displacements × {scale:g}"))
        drawn.plot(*moved[np.unique(structure.parts.ends)].T, **_NODE)
        _draw_infills(drawn, structure, result, row, moved)
        _draw_hinges(drawn, structure, result, row, 0.0 if scale is None else scale)
        if result is None and len(structure.parts.members) <= _NAMED:
            _write_names(drawn, structure, size)
        _dress(drawn, structure)
    return drawn


def mode(modes: FrameModes, number: int = 1, *, ax: Axes | None = None) -> Axes:
    """Draw the shape of a natural mode of a frame, its largest displacement a tenth of the frame.

    Parameters
    ----------
    modes : FrameModes
        The modes, as `rbsdem.modes` returns them for a frame.
    number : int, optional
        Which mode, from 1, the one with the longest period.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in m.
    """
    _arguments.instance(modes, "plot.mode", FrameModes, "as of rbsdem.modes(frame)")
    count = modes.period.size
    at = _arguments.integer(number, "plot.mode: number") - 1
    if not 0 <= at < count:
        raise InputError(f"plot.mode: number = {number}: there are {count} modes, from 1")
    structure, row = modes.frame, at
    scale = 0.1 * _size(structure) / float(np.hypot(modes.x[:, at], modes.y[:, at]).max())
    still = SpringRotations({name: np.zeros(2) for name in structure.geometry}, {})
    shapes: Any = SimpleNamespace(
        frame=structure, x=modes.x.T, y=modes.y.T, node_rotation=modes.node_rotation.T
    )
    with axes_or_new(ax, _figure_size(structure)) as drawn:
        _draw_supports(drawn, structure, _size(structure))
        moved = _undeformed(drawn, structure, False)
        moved = moved + scale * np.column_stack((modes.x[:, at], modes.y[:, at]))
        for member in structure.geometry.values():
            bent = deformed(shapes, member, row, scale, still)
            nodes = moved[[member.start, member.end]]
            drawn.plot(*np.vstack((nodes[:1], bent, nodes[1:])).T, **MEMBER)
        share = 100 * modes.participation[at]
        drawn.set_title(f"Mode {number}: {modes.period[at]:.3g} s, {share:.0f} % of the mass")
        _dress(drawn, structure)
    return drawn


def pushover(result: FrameResult | BuildingResult, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw base shear over the displacement of the roof, with the limit states of the hinges.

    Parameters
    ----------
    result : FrameResult or BuildingResult
        The push-over, as `rbsdem.pushover` returns it; other results are drawn as loops.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes. The legend names the first hinge of each limit state, and how many follow it.
    """
    if not isinstance(result, BuildingResult):
        result = _arguments.instance(result, "plot.pushover", FrameResult)
    with axes_or_new(ax, (4.6, 3.2)) as drawn:
        way = factor("m") * result.displacement, factor("N") * result.base_shear
        drawn.plot(*way, **line_of(MODEL_LINE, line))
        for what, mark in _MARKS.items():
            events = [event for event in result.events if event.name == what]
            if not events:
                continue
            rows = np.searchsorted(result.time, [event.time for event in events])
            first = events[0]
            more = f", then {len(events) - 1} more" if len(events) > 1 else ""
            end = f"at {float(first.end):.2f}" if first.end[:1].isdigit() else first.end
            drawn.plot(
                *(values[rows] for values in way),
                **HINGE | mark,
                label=", ".join(filter(None, (first.member, end, _LOOKS[what][2]))) + more,
            )
        if result.events:
            drawn.legend(loc="best", handletextpad=0.2)
        drawn.margins(x=0.03, y=0.06)
        if all(
            values.min() > -0.01 * values.max()
            for values in (result.displacement, result.base_shear)
        ):
            drawn.set_xlim(left=0.0, auto=True)
            drawn.set_ylim(bottom=0.0, auto=True)
        else:
            drawn.axhline(0.0, **ZERO_LINE)
            drawn.axvline(0.0, **ZERO_LINE)
        drawn.set(xlabel=labelled("Roof displacement", "m"), ylabel=labelled("Base shear", "N"))
        drawn.tick_params(right=True)
        drift_axis(drawn, result.structure.height)
    return drawn


def storey_drift(result: FrameResult, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw the largest drifts of the storeys to both sides over the height.

    Parameters
    ----------
    result : FrameResult
        Response of a frame with storeys. In time the drifts at the end are drawn dashed.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the line, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.

    Raises
    ------
    InputError
        If the frame has no storeys.
    """
    _arguments.instance(result, "plot.storey_drift", FrameResult)
    drifts = 100 * result.storey_drift
    floors = result.frame.floor_levels

    def steps(values: Array) -> tuple[Array, Array]:
        return np.repeat(values, 2), np.column_stack((floors[:-1], floors[1:])).ravel()

    with axes_or_new(ax, (2.8, 3.2)) as drawn:
        for height in floors[1:-1]:
            drawn.axhline(height, **ZERO_LINE)
        for extreme in (drifts.max(axis=0), drifts.min(axis=0)):
            # A side that is never reached has no line.
            if np.any(extreme):
                drawn.plot(*steps(extreme), **line_of({**MODEL_LINE, "label": "largest"}, line))
        if result.dynamic:
            drawn.plot(*steps(100 * result.residual_drift), **TEST_LINE, label="at the end")
            handles, labels = drawn.get_legend_handles_labels()
            named = dict(zip(labels, handles, strict=True))
            drawn.legend(
                named.values(),
                named.keys(),
                loc="lower center",
                bbox_to_anchor=(0.5, 1.0),
                ncols=2,
                handlelength=2.2,
                columnspacing=1.4,
            )
        drawn.axvline(0.0, **ZERO_LINE)
        reach = 1.12 * float(np.abs(drifts).max()) or 1.0
        both = drifts.min() < -0.02 * reach and drifts.max() > 0.02 * reach
        low, high = (-reach, reach) if both else (min(0.0, drifts.min()), max(0.0, drifts.max()))
        drawn.set_xlim(1.12 * low if not both else low, 1.12 * high if not both else high)
        drawn.set_ylim(floors[0], floors[-1])
        drawn.set_yticks(floors, [f"{height:.4g}" for height in floors])
        drawn.set(xlabel="Storey drift (%)", ylabel="Height (m)")
        drawn.tick_params(right=True, top=True)
    return drawn


def member_forces(
    result: FrameResult,
    force: Literal["moment", "shear", "axial"] = "moment",
    *,
    row: int = -1,
    ax: Axes | None = None,
) -> Axes:
    """Draw moments, shear forces or axial forces of the members along their axes.

    Parameters
    ----------
    result : FrameResult
        Response of a frame.
    force : {"moment", "shear", "axial"}, optional
        Moments are on the side in tension: those of the ends, and between them the parabola of
        a load on the member. Shear of a beam is above where it turns the beam clockwise.
        Compression is filled, tension is not.
    row : int, optional
        Row of the result, the last one by default.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in m. Numbers are at all ends and at the largest moment between them; of frames
        with more than 60 members only the largest of a column and of a beam.

    Raises
    ------
    InputError
        If there is no such row.
    """
    _arguments.instance(result, "plot.member_forces", FrameResult)
    force = _arguments.choice(force, "plot.member_forces: force", tuple(_FORCES))
    row = row_of(result, row)
    structure, (name, unit) = result.frame, _FORCES[force]
    members = list(structure.geometry.values())
    values = [_forces(result, i, members[i], force, row) for i in range(len(members))]
    largest = max(float(np.abs(value).max()) for value in values) or 1.0
    reach = 0.22 * float(np.median([member.clear for member in members])) / largest
    # Room for the numbers.
    wide, high = _figure_size(structure)
    with axes_or_new(ax, (1.25 * wide, 1.25 * high)) as drawn:
        _draw_supports(drawn, structure, _size(structure))
        for member, value in zip(members, values, strict=True):
            axis = member.foot + np.linspace(0, member.clear, value.size)[:, None] * member.axis
            off = axis + reach * value[:, None] * member.normal
            outline = np.vstack((axis[:1], off, axis[-1:]))
            face = "white" if force == "axial" and value[0] < 0 else "0.85"
            drawn.fill(*outline.T, facecolor=face, edgecolor="none", zorder=1.5)
            drawn.plot(*outline.T, color="black", linewidth=0.5, zorder=2)
        written = [
            (members[i], at, _write_force(drawn, members[i], values[i], at, (reach, factor(unit))))
            for i, at in _numbered(members, values, force)
        ]
        _undeformed(drawn, structure, True)
        drawn.set_title(_heading(result, row, labelled(name, unit)))
        _dress(drawn, structure)
        _part(written)
    return drawn


def _numbered(
    members: list[MemberGeometry], values: list[Array], force: str
) -> list[tuple[int, int]]:
    """Return the members and places at which numbers are written."""
    places_of = []
    if len(members) > _NAMED:
        for upright in (True, False):
            alike = [i for i, member in enumerate(members) if member.upright is upright]
            i = max(alike, key=lambda i: float(np.abs(values[i]).max()), default=-1)
            places_of += [(i, int(np.abs(values[i]).argmax()))] if alike else []
        return places_of
    nothing = 1e-9 * max(float(np.abs(value).max()) for value in values)  # round-off of open struts
    for i, value in enumerate(values):
        places = {0, value.size - 1}
        if np.ptp(value) <= 1e-9 * abs(value[0]):
            places = {value.size // 2}
        elif force == "moment":
            turns = int(value.argmax()), int(value.argmin())
            places |= {at for at in turns if 2 < at < value.size - 3}
        places_of += [(i, at) for at in sorted(places) if abs(value[at]) > nothing]
    return places_of


def row_of(result: Result, row: int) -> int:
    """Return the number of a row, from 0."""
    row, count = _arguments.integer(row, "row"), result.time.size
    if not -count <= row < count:
        raise InputError(f"row = {row}: the result has {count} rows; give {-count} to {count - 1}")
    return row % count


def _size(structure: Frame) -> float:
    """Return the larger dimension of a frame [m]."""
    return float(max(np.ptp(structure.parts.x), np.ptp(structure.parts.y)))


def _figure_size(structure: Frame) -> tuple[float, float]:
    """Return the size of a figure of a frame in its proportions [in]."""
    wide, high = np.ptp(structure.parts.x), np.ptp(structure.parts.y)
    width = float(np.clip(5.2 * wide / max(wide, 1.2 * high), 2.4, 5.2))
    return width, float(np.clip(0.9 + 0.85 * width * high / max(wide, 0.3 * high), 1.8, 6.5))


def scale_of(scale: float | None, moved: Array, size: float, who: str) -> float:
    """Return the factor of displacements: that given, or the largest is a tenth of a size [m]."""
    if scale is not None:
        return _arguments.number(scale, f"{who}: scale")
    largest = float(np.max(moved))
    return _rounded(0.1 * size / largest) if largest > 0 else 1.0


def _rounded(value: float) -> float:
    """Return the nearest of 1, 2, 5, 10 and so on."""
    power = 10.0 ** np.floor(np.log10(value))
    return float(min((1, 2, 5, 10), key=lambda digit: abs(np.log(digit * power / value))) * power)


class SpringRotations(NamedTuple):
    """Rotations of springs in a row of a result, or in several.

    Attributes
    ----------
    hinges : dict of str to ndarray, shape (..., 2)
        Of the hinges at the ends of a member, clockwise on what follows: of sections that yield
        those beyond their elastic ones, of springs that were given one by one the whole.
    panels : dict of str to ndarray, shape (...)
        Of the columns against the beams of a node.
    """

    hinges: dict[str, Array]
    panels: dict[str, Array]


def spring_rotations(result: FrameResult, row: int | NDArray[np.intp]) -> SpringRotations:
    """Return the rotations of hinges at members' ends, by member, and of panels, by node [rad].

    Members with a `yield_moment` have elastic springs: of these only the part beyond is a hinge.
    """
    structure = result.frame
    turns = SpringRotations(
        {name: np.zeros((*np.shape(row), 2)) for name in structure.parts.members}, {}
    )
    if "rotation" not in result.springs:
        return turns
    turned, moments = result.springs["rotation"][row], result.springs["moment"][row]
    for i, spring in enumerate(structure.parts.springs_of("flexure")):
        if spring.group == "panel":
            turns.panels[spring.member] = turned[..., i]
        elif spring.position in (0.0, 1.0):
            elastic = structure.kinds[spring.member].yield_moment is not None
            turn = turned[..., i] - (moments[..., i] / spring.stiffness if elastic else 0.0)
            turns.hinges[spring.member][..., int(spring.position)] = turn
    return turns


def cubic(across: Array, slopes: Array, shares: Array) -> Array:
    """Return cubic lines at shares of their lengths, shape (..., points) [m].

    Displacements across the lines, and slopes times lengths, are those of both ends: (..., 2).
    """
    s = shares
    return np.asarray(
        np.multiply.outer(across[..., 0], 1 - 3 * s**2 + 2 * s**3)
        + np.multiply.outer(slopes[..., 0], s - 2 * s**2 + s**3)
        + np.multiply.outer(across[..., 1], 3 * s**2 - 2 * s**3)
        + np.multiply.outer(slopes[..., 1], s**3 - s**2)
    )


def deformed(
    result: FrameResult,
    member: MemberGeometry,
    row: int | NDArray[np.intp],
    scale: float,
    turns: SpringRotations,
    shares: Array = _SHARES,
) -> Array:
    """Return points along a member with its displacements times a factor, (..., points, 2) [m].

    The first axis is that of the rows, if there are several.
    """
    nodes = [member.start, member.end]
    turn = result.node_rotation[row][..., nodes]
    if turns.panels and abs(member.axis[0]) > abs(member.axis[1]):
        # Rotations of nodes are those of their columns.
        names, still = result.frame.parts.nodes, np.zeros(np.shape(row))
        beside = [turns.panels.get(names[node], still) for node in nodes]
        turn = turn - np.stack(beside, axis=-1)
    moved = np.stack((result.x[row][..., nodes], result.y[row][..., nodes]), axis=-1)
    # The rigid lengths turn with their nodes.
    moved = moved + (turn * (member.rigid[0], -member.rigid[1]))[..., None] * member.normal
    along, across = moved @ member.axis, moved @ member.normal
    slopes = member.clear * (turn + turns.hinges[member.name] * (1, -1))
    bent = cubic(across, slopes, shares)
    way = shares * member.clear + scale * (along[..., :1] + shares * np.diff(along))
    drawn = member.foot + way[..., None] * member.axis
    return np.asarray(drawn + scale * bent[..., None] * member.normal)


def hinge_points(
    structure: Frame, result: FrameResult | None, row: int, scale: float
) -> dict[str, list[tuple[Array, Array]]]:
    """Return where springs with limit states are, by the furthest state that they have reached.

    Each with its place before and after the displacements [m].
    """
    reached: dict[tuple[str, str, str], str] = {}
    order = list(STATES)
    for event in () if result is None else result.events:
        if event.group not in ("member", "infill") and event.time <= result.time[row]:  # type: ignore[union-attr]
            key = event.member, event.group, event.end
            reached[key] = max(reached.get(key, ""), event.name, key=order.index)
    turns = None if result is None else spring_rotations(result, row)
    beside = _BESIDE * _size(structure)
    points: dict[str, list[tuple[Array, Array]]] = {state: [] for state in STATES}
    for spring in structure.parts.springs:
        layered = (spring.rule, spring.group) == ("layered", "flexure")
        if spring.member in structure.struts or not (layered or structure.landmarks[spring]):
            continue
        if spring.group == "panel":
            node = structure.parts.nodes.index(spring.member)
            here = still = np.array([structure.parts.x[node], structure.parts.y[node]])
            if result is not None:
                here = here + scale * np.array([result.x[row, node], result.y[row, node]])
            points[reached.get((spring.member, "panel", ""), "")].append((still, here))
            continue
        member = structure.geometry[spring.member]
        end = {0.0: "start", 1.0: "end"}.get(spring.position, f"{spring.position:g}")
        state = reached.get((spring.member, spring.group, end), "")
        # Between the ends only what has been reached: sections there seldom are.
        if not state and 0.0 < spring.position < 1.0 and spring.group == "flexure":
            continue
        aside = min(beside / member.clear, 0.3)
        share = np.array([np.clip(spring.position, aside, 1 - aside)])
        at = still = member.foot + share * member.clear * member.axis
        if result is not None and turns is not None:
            at = deformed(result, member, row, scale, turns, share)[0]
        points[state].append((still, at))
    return points


def _draw_hinges(
    ax: Axes, structure: Frame, result: FrameResult | None, row: int, scale: float
) -> None:
    """Draw springs that have limit states, filled by the furthest that they have reached."""
    points = hinge_points(structure, result, row, scale)
    turns = None if result is None else spring_rotations(result, row)
    _mark_members(ax, result, row, scale, turns)
    for state, (label, fill) in STATES.items():
        if points[state]:
            name = label if result is not None else "hinge"
            ax.plot(
                *np.array([at for _, at in points[state]]).T,
                **HINGE,
                markerfacecolor=fill,
                label=name,
            )
    if any(points.values()):
        wide, high = _figure_size(structure)
        ax.legend(
            loc="upper center",
            bbox_to_anchor=(0.5, -0.16 / max(high / 3, 0.6)),
            ncols=round(wide / 1.7),
            handletextpad=0.3,
            columnspacing=1.2,
        )


def _draw_infills(
    ax: Axes, structure: Frame, result: FrameResult | None, row: int, moved: Array
) -> None:
    """Draw infills between their nodes, filled by the furthest state that they have reached."""
    names, states = structure.parts.nodes, list(_PANELS)
    reached: dict[str, str] = {}
    for event in () if result is None else result.events:
        if event.group == "infill" and event.time <= result.time[row]:  # type: ignore[union-attr]
            reached[event.member] = max(reached.get(event.member, ""), event.name, key=states.index)
    drawn = set()
    for infill in structure.infilled:
        at = [
            names.index(f"N-{line}-{floor}")
            for line, floor in (
                (infill.bay, infill.storey - 1), (infill.bay + 1, infill.storey - 1),
                (infill.bay + 1, infill.storey), (infill.bay, infill.storey),
            )
        ]  # fmt: skip
        middle = moved[at].mean(axis=0)
        shares = np.array([infill.length / infill.run, infill.height / infill.rise])
        corners = middle + shares * (moved[at] - middle)
        state = max((reached.get(strut, "") for strut in infill.struts), key=states.index)
        label, fill = _PANELS[state]
        ax.fill(*corners.T, facecolor=fill, label="_" if state in drawn else label, **_PANEL)
        drawn.add(state)


def _mark_members(
    ax: Axes, result: FrameResult | None, row: int, scale: float, turns: SpringRotations | None
) -> None:
    """Mark the middle of members that have failed in shear, or are lost, up to a row."""
    if result is None or turns is None:
        return
    failed = {
        event.member: event.name
        for name in (FAILS, "lost")
        for event in result.events
        if event.name == name and event.time <= result.time[row] and event.group != "panel"
    }
    for name, label in ((FAILS, "member failed in shear"), ("lost", "member lost")):
        members = [member for member, state in failed.items() if state == name]
        if members:
            places = [
                deformed(result, result.frame.geometry[each], row, scale, turns, np.array([0.5]))[0]
                for each in members
            ]
            mark = HINGE | {"markersize": 6.5} | _MARKS[name]
            ax.plot(*np.array(places).T, **mark, label=label)


def _undeformed(ax: Axes, structure: Frame, strong: bool) -> Array:
    """Draw the members where nothing acts on them; return the places of the nodes."""
    parts = structure.parts
    nodes = np.column_stack((parts.x, parts.y))
    for name, ends in zip(parts.members, parts.ends, strict=True):
        if name in structure.struts:
            continue
        ax.plot(*nodes[ends].T, **(MEMBER if strong else UNDEFORMED))
    for member in structure.geometry.values() if strong else ():
        # Rigid lengths are thick.
        for node, length in ((member.start, member.rigid[0]), (member.end, -member.rigid[1])):
            if length:
                away = nodes[node] + length * member.axis
                ax.plot(*np.vstack((nodes[node], away)).T, **MEMBER | {"linewidth": 2.6})
    return nodes


def _draw_supports(ax: Axes, structure: Frame, size: float) -> None:
    """Draw what holds the nodes: a line, a triangle, one on wheels, a square for springs."""
    parts = structure.parts
    h = _SYMBOL * size
    for name, x, y in zip(parts.nodes, parts.x, parts.y, strict=True):
        support = structure.supports.get(name, "free")
        ground = y
        if support in ("pinned", "roller"):
            ax.fill(
                [x, x - 0.8 * h, x + 0.8 * h], [y, y - 1.3 * h, y - 1.3 * h],
                facecolor="white", edgecolor="black", linewidth=0.7, zorder=2,
            )  # fmt: skip
            ground = y - 1.3 * h
        elif support == "springs":
            ax.plot(x, y, linestyle="none", marker="s", markersize=7.0, markerfacecolor="white",
                    markeredgecolor="black", markeredgewidth=0.6, zorder=2)  # fmt: skip
            continue
        elif support == "free":
            continue
        if support == "roller":
            ax.plot([x - 1.2 * h, x + 1.2 * h], 2 * [ground - 0.45 * h], **_SUPPORT)
            continue
        ax.plot([x - 1.2 * h, x + 1.2 * h], [ground, ground], **_SUPPORT)
        for at in np.linspace(-0.9, 1.2, 4) * h:
            ax.plot([x + at, x + at - 0.6 * h], [ground, ground - 0.7 * h], **_SUPPORT)


def _write_names(ax: Axes, structure: Frame, size: float) -> None:
    """Write the names of members beside their middles; `size` is that of the frame [m]."""
    for member in structure.geometry.values():
        if member.name in structure.struts:
            continue
        at = member.foot + 0.5 * member.clear * member.axis
        upright = member.upright
        side = np.array([-1.0, 0.0]) if upright else np.array([0.0, 1.0])
        ax.annotate(
            member.name,
            tuple(at + 0.012 * size * side),
            ha="center",
            va="center" if upright else "bottom",
            rotation=90.0 if upright else 0.0,
            fontsize=6.5,
            color="0.35",
            xytext=(-3.0, 0.0) if upright else (0.0, 0.0),
            textcoords="offset points",
        )


def _forces(result: FrameResult, i: int, member: MemberGeometry, force: str, row: int) -> Array:
    """Return a force along a member: moments positive with tension on the side of `normal`."""
    if force == "axial":
        return np.repeat(result.member_axial[row, i], 3)
    along = member.moment if force == "moment" else member.shear
    ends = result.moment_from[row, i], result.moment_to[row, i]
    return along(*ends, np.linspace(0, 1, 21))


def _write_force(
    ax: Axes, member: MemberGeometry, values: Array, at: int, scales: tuple[float, float]
) -> Any:
    """Write a force of a member beside it; scales are those of the line and of the number."""
    reach, on_paper = scales
    share, value = at / (values.size - 1), float(values[at])
    tip = member.foot + share * member.clear * member.axis + reach * value * member.normal
    outward, axial = np.sign(value) * member.normal, values.size == 3
    # Above and below a beam towards its middle, away from the column.
    side = "left" if (outward[0] > 0.5 if member.upright else share < 0.5) else "right"
    inside = 0.3 < share < 0.7 and not member.upright
    return ax.annotate(
        f"{_short(abs(on_paper * value))}{', tension' if axial and value < 0 else ''}",
        tuple(tip),
        xytext=3.0 * outward + (6.0 * (1 - 2 * share) * member.axis if member.upright else 0.0),
        textcoords="offset points",
        ha="center" if inside else side,
        va="bottom" if outward[1] > 0.5 else "top" if outward[1] < -0.5 else "center",
        fontsize=6.0,
        bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.2, "alpha": 0.7},
        zorder=6,
    )


def _part(written: list[tuple[MemberGeometry, int, Any]]) -> None:
    """Move numbers of columns towards their middle, off those that are written already."""
    if not written:
        return
    written[0][2].axes.apply_aspect()
    taken: list[Any] = []
    for member, at, text in sorted(written, key=lambda each: each[0].upright):
        box = text.get_window_extent()
        for _ in range(8 if member.upright else 0):
            if not any(map(box.overlaps, taken)):
                break
            text.xyann = text.xyann + (-3.0 if at else 3.0) * member.axis
            box = text.get_window_extent()
        taken.append(box)


def _short(value: float) -> str:
    """Return a number with two digits, or all before the point."""
    return f"{value:.0f}" if value >= 9.5 else f"{value:.2g}"


def _heading(result: FrameResult, row: int, what: str) -> str:
    """Return the title of a figure: what is drawn, and time and roof drift of the row."""
    drift = 100 * result.displacement[row] / result.frame.height
    when = f"{result.time[row]:.4g} s, " if result.dynamic else ""
    return f"{what}, {when}roof drift {drift:.2f} %"


def _dress(ax: Axes, structure: Frame) -> None:
    """Give axes equal scales, ticks at the lines of columns and at the floors, and no box."""
    parts = structure.parts
    for places, put in ((parts.x, ax.set_xticks), (parts.y, ax.set_yticks)):
        ticks = np.unique(np.round(places, 6))
        if ticks.size <= 15:
            put(ticks, [f"{tick:.4g}" for tick in ticks])
    ax.set_aspect("equal", adjustable="datalim")
    ax.margins(0.04)
    for side in ("top", "right", "left", "bottom"):
        ax.spines[side].set_visible(False)
    ax.tick_params(length=0.0)
    ax.set(xlabel="Distance (m)", ylabel="Height (m)")


_NAMES = {"asce_41": "ASCE 41-17", "en_1998": "EN 1998-1, N2", "capacity_spectrum": "FEMA 440"}
#: Fills of ends by the levels that they exceed, and of those that are not covered.
_EXCEEDED = ("white", "#f4d35e", "#ee964b", "#c0392b")
_NOT_COVERED = "0.75"
_POINT: dict[str, Any] = {"marker": "o", "markersize": 4.5, "color": "#c0392b", "zorder": 5}


def target(goal: Target, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw a target displacement: curve, its two lines and the spectrum as those of one mass.

    Parameters
    ----------
    goal : Target
        What `rbsdem.codes.target` returned.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the curve, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        Acceleration over displacement of the equivalent mass: base shear over the effective mass,
        displacement over the participation of the first mode.
    """
    _arguments.instance(goal, "plot.target", Target, "as of rbsdem.codes.target")
    curve, lines, gamma = goal.curve, goal.lines, goal.curve.gamma
    per_g = 1.0 / (gamma * curve.modal_mass * STANDARD_GRAVITY)
    at = goal.displacement / gamma
    periods = goal.spectrum.period
    periods = np.concatenate((np.linspace(0.0, periods[1], 20), periods[2:]))
    inside = [period for period in periods if _inside(goal, period)]
    sa = np.array([goal.spectrum.sa(period) for period in inside]) / STANDARD_GRAVITY
    sd = np.array([goal.spectrum.sd(period) for period in inside])
    with axes_or_new(ax, (4.2, 3.2)) as drawn:
        drawn.plot(
            factor("m") * sd, sa, **{**TEST_LINE, "linestyle": "-"}, label=goal.spectrum.name
        )
        shown = line_of({**MODEL_LINE, "label": "push-over"}, line)
        drawn.plot(factor("m") * curve.displacement / gamma, curve.force * per_g, **shown)
        corners = np.array([0.0, lines.yield_displacement, lines.end_displacement])
        forces = np.array([0.0, lines.yield_force, lines.end_force])
        look: dict[str, Any] = {"color": "#c0392b", "linewidth": 0.8, "zorder": 4}
        drawn.plot(factor("m") * corners / gamma, forces * per_g, **look, label="two lines")
        top = 1.08 * max(float(sa.max()), float(curve.force.max()) * per_g)
        # The capacity spectrum has its point on the secant.
        shown_period = goal.factors.get("T_sec", goal.period)
        slope = (2.0 * np.pi / shown_period) ** 2 / STANDARD_GRAVITY
        drawn.plot([0.0, factor("m") * top / slope], [0.0, top], **{**ZERO_LINE, "color": "0.6"})
        name = _NAMES[goal.method]
        if goal.reached:
            height = goal.base_shear * per_g
            drawn.vlines(factor("m") * at, 0.0, height, **{**look, "linestyle": ":"})
            scale, unit = paper("m")
            words = f"{name}: roof {_short(scale * goal.displacement)} {unit}"
            drawn.plot([factor("m") * at], [height], **_POINT, linestyle="none", label=words)
        else:
            drawn.plot([], [], linestyle="none", label=f"{name}: beyond the end of the curve")
        drawn.set_xlim(0.0, 1.25e3 * max(at, min(curve.largest / gamma, 1.5 * at)))
        drawn.set_ylim(0.0, top)
        drawn.set(xlabel=labelled("Spectral displacement", "m"), ylabel="Spectral acceleration (g)")
        look = {"frameon": True, "framealpha": 0.85, "edgecolor": "none"}
        drawn.legend(loc="upper right", handlelength=1.6, **look)
        drawn.tick_params(right=True, top=True)
    return drawn


def _inside(goal: Target, period: float) -> bool:
    """Return whether a spectrum of points has a period."""
    try:
        goal.spectrum.sa(period)
    except InputError:
        return False
    return True


def assessment(assessed: Assessment, *, ax: Axes | None = None, **line: Any) -> Axes:
    """Draw a frame with ends of members and joints in the colours of the levels that they exceed.

    Parameters
    ----------
    assessed : Assessment
        What `rbsdem.codes.assess` returned.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.
    **line
        Properties of the marks, as for ``Axes.plot``.

    Returns
    -------
    matplotlib.axes.Axes
        The axes, in m. Members that exceed their shear strength have the colour of the last level.
    """
    _arguments.instance(assessed, "plot.assessment", Assessment, "as of rbsdem.codes.assess")
    if isinstance(assessed.result, BuildingResult):
        name = assessed.result.building.planes[0].name
        raise InputError(
            "plot.assessment: it is of a building; give that of one of its frames, as "
            f"assessment.frame({name!r})"
        )
    structure, states = assessed.result.frame, assessed.states()
    names = ["no level exceeded", *(f"{name} exceeded" for name in assessed.levels)]
    names[-1] += ", or shear strength" if assessed.counts()["shear"] else ""
    with axes_or_new(ax, _figure_size(structure)) as drawn:
        _draw_supports(drawn, structure, _size(structure))
        _undeformed(drawn, structure, True)
        places: dict[int, list[Any]] = {}
        for member in structure.geometry.values():
            for end, share in (("start", 0.06), ("end", 0.94)):
                if (member.name, end) in states:
                    at = member.foot + share * member.clear * member.axis
                    places.setdefault(states[member.name, end], []).append(at)
        nodes = dict(
            zip(
                structure.parts.nodes,
                np.column_stack((structure.parts.x, structure.parts.y)),
                strict=True,
            )
        )
        for (name, _), exceeded in states.items():
            if name in nodes:
                places.setdefault(exceeded, []).append(nodes[name])
        for exceeded, points in sorted(places.items()):
            face = _NOT_COVERED if exceeded < 0 else _EXCEEDED[exceeded]
            name = "not covered" if exceeded < 0 else names[exceeded]
            mark = {"linestyle": "none", "marker": "o", "markersize": 5.0, "zorder": 5}
            mark |= {"markeredgecolor": "black", "markeredgewidth": 0.5, "markerfacecolor": face}
            words = f"{name} ({len(points)})"
            drawn.plot(*np.array(points).T, **line_of({**mark, "label": words}, line))
        drawn.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, handletextpad=0.2)
        _dress(drawn, structure)
    return drawn
