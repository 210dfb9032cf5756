"""The frame of the page: storeys and bays of rectangular members, pushed under its dead load.

A state is what JSON holds, in SI: storeys from the ground up, each with its height, columns and
beams; widths of the bays; and the loads. What is wrong goes beside its field, as for columns.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._package import recorded
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, NDArray
from rbsdem.errors import InputError, RbsdemError
from rbsdem.model.frame import FrameMember
from rbsdem.model.frame_result import FrameResult
from rbsdem.output.frames import cubic
from rbsdem.run.analysis import modes
from rbsdem.run.result import pushover
from rbsdem.section.building import Frame
from rbsdem.web.state import Faults, group

#: The frame that the page begins with.
DEFAULT: dict[str, Any] = {
    "storeys": [
        {
            "height": 3.2,
            "column": {"width": 0.4, "depth": 0.4, "moment": 250e3},
            "beam": {"width": 0.3, "depth": 0.5, "moment": 200e3},
        }
        for _ in range(3)
    ],
    "bays": [6.0, 6.0, 6.0],
    "modulus": 30e9,
    "column_share": 0.7,
    "beam_share": 0.35,
    "hardening": 0.01,
    "beam_load": 25e3,
    "drift": 0.03,
}

#: Storeys and bays that a page shows, and pictures of the frame on its way.
_MOST, _PICTURES = 6, 40
#: Where along a member its deformed shape is drawn.
_SHARES = np.linspace(0.0, 1.0, 7)


#: Bounds of the numbers of a state.
_BOUNDS: dict[str, dict[str, Any]] = {
    "height": {"least": 1.0, "most": 20.0, "unit": "m"},
    "bay": {"least": 1.0, "most": 50.0, "unit": "m"},
    **{key: {"least": 0.05, "most": 5.0, "unit": "m"} for key in ("width", "depth")},
    "moment": {"above": 0.0, "unit": "N m"},
    "modulus": {"least": 1e9, "most": 1e12, "unit": "Pa"},
    **{key: {"above": 0.0, "most": 1.0} for key in ("column_share", "beam_share")},
    "hardening": {"least": 0.0, "most": 0.5},
    "beam_load": {"least": 0.0, "unit": "N/m"},
    "drift": {"least": 0.001, "most": 0.2},
}


def frame_of(state: Mapping[str, Any], faults: Faults) -> Frame | None:
    """Make the frame of a state; None if something is wrong with it."""

    def read(given: Any, name: str, field: str, where: str = "") -> float:
        if given is None:  # JSON has no other word for what is beyond its numbers.
            faults.add(field, f"{name} is missing, or too large for a number{where}")
            return 1.0
        try:
            return _arguments.number(given, name, **_BOUNDS[name])
        except InputError as error:
            faults.add(field, f"{error}{where}")
            return 1.0

    def member(storey: Any, what: str, where: str) -> FrameMember:
        given = group(storey, what)
        width, depth, moment = (
            read(given[name], name, f"{what}.{name}", where)
            for name in ("width", "depth", "moment")
        )
        return FrameMember(
            values["modulus"],
            width * depth,
            values[f"{what}_share"] * width * depth**3 / 12.0,
            yield_moment=moment,
            hardening=values["hardening"],
        )

    values = {
        name: read(state.get(name), name, f"frame.{name}")
        for name in ("modulus", "column_share", "beam_share", "hardening", "beam_load", "drift")
    }
    bays = [read(bay, "bay", "frame.bays") for bay in _listed(state, "bays", faults)]
    heights = []
    columns, beams = {}, {}
    for level, given in enumerate(_listed(state, "storeys", faults), 1):
        storey, where = given if isinstance(given, Mapping) else {}, f" (storey {level})"
        heights.append(read(storey.get("height"), "height", "frame.storeys", where))
        columns[0, level] = member(storey, "column", where)
        beams[0, level] = member(storey, "beam", where)
    if faults.listed:
        return None
    load = values["beam_load"]
    with faults.of("frame", "beam_load"):
        return Frame.grid(
            heights,
            bays,
            columns=columns,
            beams=beams,
            beam_load=load,
            floor_mass=load * sum(bays) / STANDARD_GRAVITY,
            kinematics="pdelta" if load > 0.0 else "small",
        )
    return None


def _listed(state: Mapping[str, Any], name: str, faults: Faults) -> list[Any]:
    given = state.get(name)
    if isinstance(given, list) and 1 <= len(given) <= _MOST:
        return given
    # In words: the page shows numbers in the unit of the field.
    faults.add(f"frame.{name}", "give one to six of them")
    return []


def pushover_json(state: Mapping[str, Any]) -> dict[str, Any]:
    """Return the push-over of a state, pushed to one side: curve, pictures on the way, hinges."""
    faults, stopped = Faults(), ""
    try:
        with recorded() as told:
            made = frame_of(state, faults)
            if made is None:
                return {"faults": faults.listed}
            result = pushover(made, drift=state["drift"], points=_PICTURES)
    except RbsdemError as error:
        member = re.search(r"of member ([\w-]+)", str(error))
        text = f"the frame does not carry its dead load{f' ({member[1]})' if member else ''}: "
        text += "give less load, or larger yield moments"
        return {"faults": [{"field": "frame.beam_load", "text": text}]}
    if result.summary["status"] == "ended":
        stopped = result.summary["reason"]
    frame, parts = result.frame, result.frame.parts
    springs = parts.springs_of("flexure")
    rows = np.flatnonzero(result.time == np.rint(result.time))
    targets = np.linspace(0.0, state["drift"] * frame.height, _PICTURES + 1)[1:]
    values = ", ".join(f"{target:.10g}" for target in targets)
    loading = f"&loading drive = 'displacement', values = {values} /\n"
    return {
        "faults": [],
        "notes": [str(one.message) for one in told],
        "stopped": stopped,
        "height": frame.height,
        "weight": parts.mass * STANDARD_GRAVITY,
        "period": float(modes(frame, 1).period[0]) if parts.mass > 0.0 else None,
        "displacement": _rounded(result.displacement),
        "base_shear": _rounded(result.base_shear),
        "pictures": rows.tolist(),
        "members": list(parts.members),
        "still": _rounded(_undeformed(frame)),
        "moved": _rounded(_deformed(result, rows)),
        "ductility": _ductility(result, rows).tolist(),
        "springs": [[parts.members.index(one.member), one.place] for one in springs],
        "storey_drift": _rounded(np.asarray(result.storey_drift)[rows], 4),
        "events": [
            {name: getattr(event, name) for name in ("member", "end", "drift", "force")}
            | {"dead": bool(event.step <= result.time[0])}
            for event in result.events
        ],
        "case": frame.to_namelist() + loading,
    }


def _undeformed(frame: Frame) -> Array:
    """Return points along the members, shape (members, points, 2) [m]."""
    ends = np.column_stack((frame.parts.x, frame.parts.y))[frame.parts.ends]
    return np.asarray(ends[:, :1] + np.einsum("p,mj->mpj", _SHARES, ends[:, 1] - ends[:, 0]))


def _deformed(result: FrameResult, rows: NDArray[np.intp]) -> Array:
    """Return the displacements of points along the members, shape (rows, members, points, 2) [m].

    A member is the cubic line between the rotations of its ends; in sections that yield the
    rotation beyond the elastic one is a kink at the node.
    """
    parts = result.frame.parts
    nodes = np.column_stack((parts.x, parts.y))[parts.ends]
    length = np.hypot(*(nodes[:, 1] - nodes[:, 0]).T)
    axis = (nodes[:, 1] - nodes[:, 0]) / length[:, None]
    normal = np.column_stack((axis[:, 1], -axis[:, 0]))
    moved = np.stack((result.x[rows], result.y[rows]), axis=-1)[:, parts.ends]
    springs = parts.springs_of("flexure")
    stiffness = np.array([spring.stiffness for spring in springs])
    plastic = result.springs["rotation"][rows] - result.springs["moment"][rows] / stiffness
    # Three sections a member: at its start, in the middle, at its end.
    kinks = plastic.reshape(len(rows), len(parts.members), 3)[:, :, ::2]
    slopes = length[:, None] * (result.turn[rows][:, parts.ends] + kinks * (1, -1))
    along, across = (np.einsum("rmej,mj->rme", moved, way) for way in (axis, normal))
    bent = cubic(across, slopes, _SHARES)
    stretched = np.multiply.outer(along[..., 0], 1 - _SHARES)
    stretched += np.multiply.outer(along[..., 1], _SHARES)
    return np.asarray(stretched[..., None] * axis[:, None] + bent[..., None] * normal[:, None])


def _ductility(result: FrameResult, rows: NDArray[np.intp]) -> Array:
    """Return the largest rotation of each section so far over that at yield, rounded down."""
    frame = result.frame
    springs = frame.parts.springs_of("flexure")
    moments = [frame.kind_of(spring.member).yield_moment or np.inf for spring in springs]
    yields = np.array(moments) / [spring.stiffness for spring in springs]
    reached = np.maximum.accumulate(np.abs(result.springs["rotation"]), axis=0)
    return np.asarray(np.floor(1e3 * reached[rows] / yields + 1e-6) / 1e3)


def _rounded(values: Array, digits: int = 5) -> Any:
    """Return an array for JSON with some digits of its largest value."""
    largest = float(np.max(np.abs(values), initial=0.0))
    places = digits - 1 - int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    return np.round(values, places).tolist()
