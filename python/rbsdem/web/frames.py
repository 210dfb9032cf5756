"""The frame of the page: storeys and bays of drawn members, pushed, moved to and fro, or shaken.

A state is what JSON holds, in SI: storeys from the ground up, each with its height and the drawings
of its columns and beams; widths of the bays; loads; members that are removed; and the demand of a
code. A fault is shown beside its field, as for columns.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from rbsdem import _arguments
from rbsdem._package import unwarned
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array
from rbsdem.checks.acceptance import AcceptanceCode, Assessment, assess
from rbsdem.checks.target import Target, target
from rbsdem.errors import InputError, RbsdemError, SolveError
from rbsdem.model.shape import Section
from rbsdem.motions.design import DesignSpectrum
from rbsdem.motions.motion import GroundMotion
from rbsdem.output.frames import deformed, spring_rotations
from rbsdem.run.analysis import modes
from rbsdem.run.frame_result import FrameResult
from rbsdem.run.response import cyclic, pushover, time_history
from rbsdem.run.solver import COLLAPSE_DRIFT
from rbsdem.section.frame import Frame
from rbsdem.web.state import (
    Faults,
    group,
    key_of,
    loading_of,
    number,
    numbers,
    section_of,
    shown_rows,
)

#: The frame that the page begins with.
DEFAULT: dict[str, Any] = {
    "frame": {
        "storeys": [
            {
                "height": 3.2,
                "column": {
                    "section": {"shape": "rectangle", "width": 0.4, "depth": 0.4, "cover": 0.03},
                    "bars": {"number": 8, "diameter": 0.02},
                    "ties": {"diameter": 0.008, "spacing": 0.1},
                },
                "beam": {
                    "section": {"shape": "beam", "width": 0.3, "depth": 0.5, "cover": 0.03},
                    "top": {"number": 4, "diameter": 0.016},
                    "bottom": {"number": 3, "diameter": 0.016},
                    "ties": {"diameter": 0.008, "spacing": 0.15},
                },
            }
            for _ in range(3)
        ],
        "bays": [6.0, 6.0],
        "concrete": {"fc": 30e6},
        "bars": {"fy": 450e6},
        "ties": {"fy": 400e6},
        "dead_load": 20e3,
        "live_load": 8e3,
        "live_share": 0.3,
        "self_weight": True,
        "kinematics": "pdelta",
        "damping": 0.05,
        "removed": [],
        "demand": {"code": "en_1998_3", "ag": 0.25, "soil": "C", "s_xs": 1.0, "s_x1": 0.6},
    },
    "loading": {"kind": "push", "drift": 0.03},
}

#: Storeys and bays that a page shows; pictures of the frame on its way; points between peaks.
_MOST, _PICTURES, _ON_THE_WAY = 6, 40, 160
#: Rows of a curve, and seconds that a response in time may take.
_ROWS, _SECONDS = 1200, 60.0
#: Where along a member its deformed shape is drawn.
_SHARES = np.linspace(0.0, 1.0, 7)
#: Fields of materials, which are those of all members.
_SHARED = {"concrete": ("fc",), "bars": ("fy", "fu"), "ties": ("fy", "fu")}
_MEMBER = re.compile(r"([CB])-([1-9])-([1-9])")

#: Bounds of the numbers of a state.
_BOUNDS: dict[str, dict[str, Any]] = {
    "height": {"least": 1.0, "most": 20.0, "unit": "m"},
    "bay": {"least": 1.0, "most": 50.0, "unit": "m"},
    "dead_load": {"least": 0.0, "unit": "N/m"},
    "live_load": {"least": 0.0, "unit": "N/m"},
    "live_share": {"least": 0.0, "most": 1.0},
    "damping": {"least": 0.0, "most": 0.5},
    "drift": {"least": 0.001, "most": 0.2},
}


def frame_of(state: Mapping[str, Any], faults: Faults) -> tuple[Frame | None, list[Any]]:
    """Make the frame of a state, None if something is wrong with it, and its sections."""

    def read(given: Any, name: str, field: str, where: str = "") -> float:
        if given is None:  # JSON has no other word for what is beyond its numbers.
            faults.add(field, f"{name} is missing, or too large for a number{where}")
            return 1.0
        try:
            return _arguments.number(given, name, **_BOUNDS[name])
        except InputError as error:
            faults.add(field, f"{error}{where}")
            return 1.0

    made: dict[str, Section | None] = {}

    def section(storey: Mapping[str, Any], what: str, level: int) -> Section | None:
        drawing = dict(group(storey, what))
        for name, keys in _SHARED.items():
            drawing[name] = dict(group(drawing, name)) | {
                key: group(state, name)[key] for key in keys
            }
        key = key_of([what, drawing])
        if key not in made:
            own = Faults()
            made[key] = section_of(drawing, own)
            for fault in own.listed:
                name, _, value = fault["field"].partition(".")
                place = "frame" if value in _SHARED.get(name, ()) else what
                text = fault["text"] + (f" (storey {level})" if place == what else "")
                faults.add(f"{place}.{fault['field']}", text)
        return made[key]

    names = ("dead_load", "live_load", "live_share", "damping")
    values = {name: read(state.get(name), name, f"frame.{name}") for name in names}
    bays = [read(bay, "bay", "frame.bays") for bay in _listed(state, "bays", faults)]
    heights: list[float] = []
    sections: list[Any] = []
    for level, given in enumerate(_listed(state, "storeys", faults), 1):
        storey, where = given if isinstance(given, Mapping) else {}, f" (storey {level})"
        heights.append(read(storey.get("height"), "height", "frame.storeys", where))
        sections.append(tuple(section(storey, what, level) for what in ("column", "beam")))
    if faults.listed:
        return None, sections
    cells: list[dict[tuple[int, int], Any]] = [
        {(0, level): one[i] for level, one in enumerate(sections, 1)} for i in (0, 1)
    ]
    removed = state.get("removed")
    for name in removed if isinstance(removed, list) else ():
        found = _MEMBER.fullmatch(str(name))
        if found is None:
            continue
        at, level = int(found[2]), int(found[3])
        if at <= len(bays) + (found[1] == "C") and level <= len(heights):
            cells[found[1] == "B"][at, level] = None
    kinematics: Any = state.get("kinematics")
    frame = None
    try:
        with faults.of("frame", "dead_load"):
            frame = Frame.grid(
                heights, bays, columns=cells[0], beams=cells[1],
                dead_load=values["dead_load"], live_load=values["live_load"],
                live_share=values["live_share"], self_weight=bool(state.get("self_weight")),
                mass="from_loads", damping=values["damping"] or None, kinematics=kinematics,
            )  # fmt: skip
    except SolveError as error:  # its dead load
        faults.add("frame.dead_load", str(error))
    return frame, sections


def _listed(state: Mapping[str, Any], name: str, faults: Faults) -> list[Any]:
    given = state.get(name)
    if isinstance(given, list) and 1 <= len(given) <= _MOST:
        return given
    # In words: the page shows numbers in the unit of the field.
    faults.add(f"frame.{name}", "give one to six of them")
    return []


class Solved(NamedTuple):
    """A frame of the page under its loading.

    Attributes
    ----------
    result : FrameResult or None
        The response; None if the input is wrong.
    sections : list of (Section or None, Section or None)
        Those of the columns and of the beams of each storey.
    stopped : str
        Why the analysis ended early.
    """

    result: FrameResult | None
    sections: list[Any]
    stopped: str = ""


def solved(state: Mapping[str, Any], records: Mapping[str, GroundMotion], faults: Faults) -> Solved:
    """Return the frame of a state under its loading; what is wrong is added to the faults."""
    loading = state["loading"]
    push = loading.get("kind") == "push"
    frame, sections = frame_of(state["frame"], faults)
    load = None
    if push:
        with faults.of("loading", "drift"):
            drift = _arguments.number(loading.get("drift"), "drift", **_BOUNDS["drift"])
    else:
        load = loading_of(loading, records, faults)
    if frame is None or faults.listed:
        return Solved(None, sections)
    try:
        result: Any
        if push:
            result = pushover(frame, drift=drift, points=_PICTURES)
        elif isinstance(load, GroundMotion):
            result = time_history(
                frame, ground_acceleration=load, method="newmark", dt=min(load.dt, 0.01),
                collapse_drift=COLLAPSE_DRIFT, max_seconds=_SECONDS,
            )  # fmt: skip
        else:
            result = cyclic(frame, displacement=frame.height * _on_the_way(np.asarray(load)))
    except SolveError as error:
        if error.result is None or not len(error.result.time):
            faults.add("frame.dead_load", str(error))
            return Solved(None, sections)
        return Solved(error.result, sections, str(error))
    except InputError as error:
        faults.add("loading.kind", str(error))
        return Solved(None, sections)
    about = result.summary
    early = about["status"] not in ("completed", "collapsed")
    return Solved(result, sections, about["reason"] if early else "")


def _on_the_way(peaks: Array) -> Array:
    """Return the points of a path with points between its peaks, in proportion to their way."""
    path = [0.0, *peaks.tolist()]
    whole = max(float(np.abs(np.diff(path)).sum()), 1e-12)
    parts = [
        np.linspace(a, b, 1 + max(1, round(_ON_THE_WAY * abs(b - a) / whole)))[1:]
        for a, b in pairwise(path)
        if a != b
    ]
    return np.concatenate(parts) if parts else np.zeros(1)


def to_json(result: FrameResult) -> dict[str, Any]:
    """Return a response as the page draws it: curve, pictures on the way, hinges."""
    frame, parts = result.frame, result.frame.parts
    whole = np.arange(result.time.size)
    pictures = whole if result.dynamic else np.flatnonzero(result.time == np.rint(result.time))
    if pictures.size > _ON_THE_WAY:
        pictures = pictures[np.linspace(0, pictures.size - 1, _ON_THE_WAY).astype(int)]
    rows = np.union1d(shown_rows(result.displacement, result.base_shear, _ROWS), pictures)
    nodes = np.column_stack((parts.x, parts.y))
    moved_nodes = nodes + np.stack((result.x[pictures], result.y[pictures]), axis=-1)
    still: list[Array] = []
    moved: list[Array] = []
    for found, at, scale in ((still, nodes[None], 0.0), (moved, moved_nodes, 1.0)):
        shown = pictures[: len(at)]
        turns = spring_rotations(result, shown)
        for one in frame.geometry.values():
            line = deformed(result, one, shown, scale, turns, _SHARES)
            found.append(np.concatenate((at[:, [one.start]], line, at[:, [one.end]]), axis=1))
    with unwarned(Warning):
        period = float(modes(frame, 1).period[0]) if parts.mass > 0.0 else None
    ends = result.moment_from[pictures], result.moment_to[pictures]
    shears = [
        np.maximum(*(np.abs(one.shear(ends[0][:, i], ends[1][:, i], end)) for end in (0.0, 1.0)))
        for i, one in enumerate(frame.geometry.values())
    ]
    forces = (result.member_axial[pictures], *ends, np.column_stack(shears))
    return {
        "status": result.summary["status"],
        "dynamic": result.dynamic,
        "height": frame.height,
        "weight": parts.mass * STANDARD_GRAVITY,
        "period": period,
        "time": numbers(result.time[rows]),
        "displacement": rounded(result.displacement[rows]),
        "base_shear": rounded(result.base_shear[rows]),
        "storey_drift": rounded(result.storey_drift[rows]),
        "storey_shear": rounded(result.storey_shear[rows]),
        "peak": {
            "base_shear": number(float(np.abs(result.base_shear).max())),
            "drift": number(float(np.abs(result.displacement).max()) / frame.height),
            "storey_drift": numbers(np.abs(result.storey_drift).max(axis=0)),
            "storey_shear": numbers(np.abs(result.storey_shear).max(axis=0)),
            "residual": number(float(np.abs(result.residual_drift).max())),
        },
        "pictures": np.searchsorted(rows, pictures).tolist(),
        "members": list(parts.members),
        "still": rounded(np.array(still)[:, 0]),
        "moved": rounded(np.swapaxes(np.array(moved) - still, 0, 1)),
        "forces": rounded(np.stack(forces, axis=-1), 4),
        "events": [
            {name: getattr(event, name) for name in ("member", "end", "group", "name")}
            | {name: number(getattr(event, name)) for name in ("time", "drift", "force")}
            | {"dead": bool(event.time <= result.time[0])}
            for event in result.events
        ],
    }


def judged(
    result: FrameResult, state: Mapping[str, Any]
) -> tuple[Assessment, Target | None, dict[str, Any]]:
    """Return the members of a frame beside the limits of its code, and its target displacement.

    At the target displacement of a push-over that reaches it; else they are judged by the envelope.
    The last part says why there is no target, with the field that is wrong.
    """
    demand, none = group(state["frame"], "demand"), {}
    code: AcceptanceCode = _arguments.choice(demand["code"], "code", ("en_1998_3", "asce_41"))
    point: Target | None = None
    if state["loading"].get("kind") == "push":
        try:
            if code == "asce_41":
                spectrum = DesignSpectrum.asce_41(demand["s_xs"], demand["s_x1"])
            else:
                spectrum = DesignSpectrum.en_1998(demand["ag"], demand["soil"])
            point = target(result, spectrum, "asce_41" if code == "asce_41" else "en_1998")
        except InputError as error:
            place = error.field.rpartition(".")[2] or "code"
            none = {"field": f"frame.demand.{place}", "text": str(error)}
    reached = point is not None and point.reached
    return assess(result, code, at=point if reached else None), point, none


def checked(result: FrameResult, state: Mapping[str, Any]) -> dict[str, Any]:
    """Return the outcome of `judged` as the page draws it."""
    try:
        with unwarned(Warning):
            made, point, none = judged(result, state)
    except RbsdemError as error:
        return {"faults": [{"field": "frame.demand.code", "text": str(error)}]}
    found: dict[str, Any] = {"faults": [none] if none else [], "code": made.code}
    found |= {"levels": made.levels, "at_target": made.displacement is not None}
    found |= {"ends": _ends(made), "notes": made.warnings}
    if point is not None:
        lines = point.lines
        found["target"] = {
            "spectrum": point.spectrum.name,
            "reached": point.reached,
            "storey_drift": numbers(point.storey_drift) if point.reached else None,
            "lines": [
                numbers(np.array([0.0, lines.yield_displacement, lines.end_displacement])),
                numbers(np.array([0.0, lines.yield_force, lines.end_force])),
            ],
            **{
                name: number(getattr(point, name))
                for name in ("displacement", "signed", "base_shear", "period", "ductility")
            },
        }
    return found


def _ends(made: Assessment) -> list[dict[str, Any]]:
    """Return the worse side of each end: its ratio, what governs, and the levels passed."""
    states, last = made.states(), f"ratio_{made.levels[-1]}"
    found: dict[tuple[str, str], dict[str, Any]] = {}
    for row in made.rows:
        at = row["member"], row["end"]
        ratio = float(np.nan_to_num(max(row[last], row["ratio_shear"])))
        if at not in found or ratio > found[at]["ratio"]:
            about = {name: row[name] for name in ("governed_by", "status")}
            found[at] = {
                "member": at[0],
                "end": at[1],
                "ratio": ratio,
                "passed": states[at],
                **about,
            }
    return [one | {"ratio": number(one["ratio"])} for one in found.values()]


def rounded(values: Array, digits: int = 5) -> Any:
    """Return an array for JSON with some digits of its largest value."""
    values = np.asarray(values)
    largest = float(np.max(np.abs(values), initial=0.0))
    places = digits - 1 - int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    return np.round(values, places).tolist()
