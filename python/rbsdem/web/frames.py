"""The frame of the page: pushed, moved to and fro, or shaken, and its members beside a code."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from rbsdem._package import unwarned
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array
from rbsdem.checks.acceptance import Assessment
from rbsdem.errors import RbsdemError
from rbsdem.many.judgement import Judgement, judge, response
from rbsdem.output.frames import deformed, spring_rotations
from rbsdem.run.analysis import modes
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.case import Case
from rbsdem.run.frame_result import FrameResult
from rbsdem.web.state import Faults, number, numbers, shown_rows

#: Pictures of the frame on its way, rows of a curve, and seconds that a response in time may take.
_PICTURES, _ROWS, _SECONDS = 60, 1200, 60.0
#: Where along a member its deformed shape is drawn.
_SHARES = np.linspace(0.0, 1.0, 7)


def is_push(case: Case) -> bool:
    """Return whether a case goes to one displacement, and there alone."""
    return case.displacement is not None and len(np.unique(case.displacement[1:])) <= 1


def solved(case: Case) -> tuple[FrameResult | BuildingResult, str]:
    """Return the response of a frame and why it ended early.

    One displacement is a push-over to there; several are a path.
    """
    path = case.displacement is not None and not is_push(case)
    result: Any = case.run() if path else response(case, max_seconds=_SECONDS)
    early = result.summary["status"] not in ("completed", "collapsed")
    return result, result.summary["reason"] if early else ""


#: What the page is told of each frame of a building.
_OF_ONE_FRAME = (
    *("storey_drift", "storey_shear", "peak", "members", "still", "moved", "forces", "events"),
)


def to_json(result: FrameResult | BuildingResult) -> dict[str, Any]:
    """Return a response as the page draws it: curve, pictures on the way, hinges.

    That of a building has its plan, and its frames by their names.
    """
    if not isinstance(result, BuildingResult):
        return _of_frame(result, result)
    made = {name: _of_frame(frame, result) for name, frame in result.frames.items()}
    whole = dict(next(iter(made.values())))
    frames = {
        name: {key: of_frame[key] for key in _OF_ONE_FRAME} for name, of_frame in made.items()
    }
    pictures = np.searchsorted(result.time, np.array(whole["time"])[whole["pictures"]] - 1e-9)
    roof = (result.floor_x, result.floor_y, result.floor_rotation)
    lines = []
    for plane in result.building.planes:
        ends = plane.places(np.array([plane.frame.parts.x.min(), plane.frame.parts.x.max()]))
        lines.append({"name": plane.name, "from": ends[0].tolist(), "to": ends[1].tolist()})
    plan = {
        "lines": lines,
        "centre": result.building.centres[-1].tolist(),
        "roof": rounded(np.column_stack([of_frame[pictures, -1] for of_frame in roof]), 6),
    }
    return whole | {"frames": frames, "plan": plan}


def _of_frame(result: FrameResult, whole: FrameResult | BuildingResult) -> dict[str, Any]:
    """Return the response of a frame, with base shear, height and period of what it is part of."""
    frame, parts = result.frame, result.frame.parts
    every = np.arange(result.time.size)
    pictures = every if result.dynamic else np.flatnonzero(result.time == np.rint(result.time))
    # A push-over has rows at its events too.
    many = 3 * _PICTURES if pictures.size == every.size else _PICTURES
    if pictures.size > many:
        pictures = pictures[np.linspace(0, pictures.size - 1, many).astype(int)]
    rows = np.union1d(shown_rows(result.displacement, whole.base_shear, _ROWS), pictures)
    nodes = np.column_stack((parts.x, parts.y))
    moved_nodes = nodes + np.stack((result.x[pictures], result.y[pictures]), axis=-1)
    still: list[Array] = []
    moved: list[Array] = []
    for lines, at, scale in ((still, nodes[None], 0.0), (moved, moved_nodes, 1.0)):
        shown = pictures[: len(at)]
        turns = spring_rotations(result, shown)
        for member in frame.geometry.values():
            line = deformed(result, member, shown, scale, turns, _SHARES)
            lines.append(np.concatenate((at[:, [member.start]], line, at[:, [member.end]]), axis=1))
    with unwarned(Warning):
        period = float(modes(whole.structure, 1).period[0]) if parts.mass > 0.0 else None
    ends = result.moment_from[pictures], result.moment_to[pictures]
    shears = np.abs(result.end_shear[pictures]).max(axis=2)
    forces = (result.member_axial[pictures], *ends, shears)
    return {
        "status": result.summary["status"],
        "dynamic": result.dynamic,
        "height": whole.structure.height,
        "weight": parts.mass * STANDARD_GRAVITY,
        "period": period,
        "time": numbers(result.time[rows]),
        "displacement": rounded(result.displacement[rows]),
        "base_shear": rounded(whole.base_shear[rows]),
        "storey_drift": rounded(result.storey_drift[rows]),
        "storey_shear": rounded(result.storey_shear[rows]),
        "peak": {
            "base_shear": number(float(np.abs(whole.base_shear).max())),
            "drift": number(float(np.abs(result.displacement).max()) / whole.structure.height),
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
            | {name: number(getattr(event, name)) for name in ("time", "drift")}
            | {"force": number(event.force if whole is result else _shear_at(whole, event.time))}
            | {"dead": bool(event.time <= result.time[0])}
            for event in result.events
        ],
    }


def _shear_at(result: BuildingResult | FrameResult, time: float) -> float:
    """Return the base shear at a time [N]."""
    return float(np.interp(time, result.time, result.base_shear))


def judged(case: Case, result: FrameResult | BuildingResult) -> Judgement:
    """Return what a case asks for beside its response, as `rbsdem.codes.judge` finds it.

    A target displacement is that of a push-over; without one members are judged by the envelope.
    """
    if not is_push(case):
        case = replace(case, target={}, records={})
    return judge(replace(case, records={}), result=result)


def checked(case: Case, result: FrameResult | BuildingResult, faults: Faults) -> dict[str, Any]:
    """Return the outcome of `judged` as the page draws it."""
    made = None
    # The target stands without limits, as those of walls, which no code has.
    for asked in (case, replace(case, assess=[])):
        try:
            with unwarned(Warning), faults.kept():
                made = made or judged(asked, result)
        except RbsdemError as error:
            faults.add("", str(error))
    answer: dict[str, Any] = {"faults": faults.listed}
    if made is None:
        return answer
    for assessment in made.assessments[:1]:
        answer |= {"limits_of": assessment.source, "levels": assessment.levels}
        answer |= {"level": made.levels[0], "accepted": assessment.accepted(made.levels[0])}
        answer |= {"counts": assessment.counts()}
        answer |= {"at_target": assessment.displacement is not None}
        answer |= {"ends": _ends(assessment), "notes": assessment.warnings}
    point = made.target
    if point is not None:
        lines = point.lines
        answer["target"] = {
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
    return answer


def _ends(made: Assessment) -> list[dict[str, Any]]:
    """Return the worse side of each end: its ratio, what governs, how many levels it exceeds."""
    states, last = made.states(), f"ratio_{made.levels[-1]}"
    worst: dict[tuple[str, str], dict[str, Any]] = {}
    for row in made.rows:
        at = row["member"], row["end"]
        ratio = float(np.nan_to_num(max(row[last], row["ratio_shear"])))
        if at not in worst or ratio > worst[at]["ratio"]:
            about = {name: row[name] for name in ("member", "end", "governed_by", "status")}
            worst[at] = {**about, "ratio": ratio, "exceeded": states[at]}
    return [end | {"ratio": number(end["ratio"])} for end in worst.values()]


def rounded(values: Array, digits: int = 5) -> Any:
    """Return an array for JSON with some digits of its largest value."""
    values = np.asarray(values)
    largest = float(np.max(np.abs(values), initial=0.0))
    places = digits - 1 - int(np.floor(np.log10(largest))) if largest > 0.0 else 0
    return np.round(values, places).tolist()
