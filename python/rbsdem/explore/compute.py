"""What the page shows of a state: loops with limit states, diagrams, code values, bands.

Answers are what JSON holds, in SI, with six digits. The functions are those that everybody calls;
columns and results that were just made are kept, as several answers stand on them.
"""

from __future__ import annotations

import math
import time
import warnings
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.analysis import cyclic, time_history
from rbsdem.case import Case
from rbsdem.errors import InputError, RbsdemError, SolveError
from rbsdem.explore.state import (
    Drawn,
    Faults,
    Loading,
    column_of,
    key_of,
    loading_of,
    section_of,
    with_top_mass,
)
from rbsdem.explore.texts import case_of_text
from rbsdem.motions.motion import GroundMotion
from rbsdem.result import Result
from rbsdem.section.model import LayeredColumn
from rbsdem.section.section import Section

__all__ = ["Answered", "Answers", "numbers"]

#: Results that are kept: those of two columns, before and after a few undos.
_KEPT = 12
#: Rows of a response in an answer; a figure shows no more.
_ROWS = 8000


@dataclass(frozen=True)
class Answered:
    """A column with its result.

    Attributes
    ----------
    result : Result or None
        The response; None if the input is wrong.
    drawn : Drawn or None
        The drawn column; None for a case.
    case : Case or None
        The case, if the column is one.
    faults : list
        Messages with their fields.
    notes : list of str
        What the program remarks.
    stopped : str
        Why the analysis ended early.
    seconds : float
        Time for column, path and limit states.
    """

    result: Result | None
    drawn: Drawn | None
    case: Case | None
    faults: list[dict[str, str]]
    notes: list[str]
    stopped: str = ""
    seconds: float = 0.0


class Answers:
    """Answers to states; one of them is computed at a time.

    Parameters
    ----------
    records : dict
        Records of ground motions that were opened, by their digests.
    """

    def __init__(self, records: dict[str, GroundMotion] | None = None) -> None:
        self.records = {} if records is None else records
        self._kept: OrderedDict[str, Answered] = OrderedDict()

    # ---- loops ----------------------------------------------------------------------------------

    def solved(self, given: Mapping[str, Any], loading: Mapping[str, Any]) -> Answered:
        """Return a column of the state with its response."""
        key = key_of([given, loading])
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        begun = time.perf_counter()
        answered = self._solve(given, loading)
        answered = replace(answered, seconds=time.perf_counter() - begun)
        # What was refused may be right later: a record may be opened meanwhile.
        if answered.result is not None:
            self._kept[key] = answered
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return answered

    def _solve(self, given: Mapping[str, Any], loading: Mapping[str, Any]) -> Answered:
        faults, drawn, case = Faults(), None, None
        notes: list[str] = []
        run: Callable[[], Result]
        if "case" in given:
            try:
                case = case_of_text(given["case"])
                run = case.run
            except RbsdemError as error:
                return Answered(None, None, None, [{"field": "case", "text": str(error)}], [])
        else:
            drawn, notes = column_of(given, faults)
            loads = loading_of(loading, self.records, faults)
            if drawn is not None and loads is not None and loads.motion is not None:
                drawn = with_top_mass(drawn, given, faults)
            if drawn is None or loads is None or faults:
                return Answered(None, None, None, faults.listed(), notes)
            run = _run_of(drawn, loads)
        stopped, result = "", None
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            try:
                result = run()
            except SolveError as error:
                stopped, result = str(error), error.result
            except RbsdemError as error:
                field = "case" if case is not None else "loading.kind"
                return Answered(None, None, None, [{"field": field, "text": str(error)}], notes)
        notes = [*notes, *dict.fromkeys(str(one.message) for one in told)]
        return Answered(result, drawn, case, [], notes, stopped)

    def loops(self, state: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return the loop of each column with its limit states and the figure of its section."""
        return [self._loop(given, state["loading"]) for given in state["columns"]]

    def _loop(self, given: Mapping[str, Any], loading: Mapping[str, Any]) -> dict[str, Any]:
        begun = time.perf_counter()
        found = self.solved(given, loading)
        answer: dict[str, Any] = {"faults": found.faults, "notes": found.notes}
        if found.drawn is not None:
            answer["figure"] = figure_of(found.drawn.section)
            answer["model"] = found.drawn.column.model
        elif "case" not in given:
            # The section may be drawn although the column is refused.
            section = section_of(given, Faults())
            answer["figure"] = None if section is None else figure_of(section)
        if found.result is not None:
            answer |= _response(found)
        answer["seconds"] = round(max(found.seconds, time.perf_counter() - begun), 4)
        return answer

    # ---- the section ----------------------------------------------------------------------------

    def sections(self, state: Mapping[str, Any], code: str) -> list[dict[str, Any]]:
        """Return moment-curvature, interaction and code values of each column."""
        return [self._section(given, state["loading"], code) for given in state["columns"]]

    def _section(
        self, given: Mapping[str, Any], loading: Mapping[str, Any], code: str
    ) -> dict[str, Any]:
        drawn = self.solved(given, loading).drawn
        if drawn is None:
            return {}
        section, load = drawn.section, drawn.column.axial_load
        span = drawn.height / drawn.factor
        return {
            "curvature": [
                _tried(lambda confined=confined: _curvature(section, load, confined))
                for confined in (False, True)
            ],
            "code": _tried(lambda: _interaction(section, code)),
            "codes": _tried(lambda: _codes(section, span, load)),
            "facts": _tried(lambda: _facts(section, span, load)),
        }

    def own_interaction(self, state: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return the interaction diagram of each column by its own laws, which takes long."""
        found = []
        for given in state["columns"]:
            drawn = self.solved(given, state["loading"]).drawn
            section = None if drawn is None else drawn.section
            found.append({} if section is None else _tried(lambda s=section: _interaction(s, None)))
        return found

    # ---- how far it may be off ------------------------------------------------------------------

    def band(self, given: Mapping[str, Any], loading: Mapping[str, Any]) -> dict[str, Any]:
        """Return the band that holds 80 % of the points of left-out tests, for a column's path."""
        found = self.solved(given, loading)
        drawn, result = found.drawn, found.result
        if drawn is None or result is None or result.dynamic:
            return {"none": "a band is for a drawn column on a path"}
        column = drawn.column
        if not isinstance(column, LayeredColumn):
            return {"none": "a band is for the layered model"}
        path = result.displacement
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            try:
                spread = column.spread(path)
            except InputError as error:
                return {"none": str(error)}
        return {
            "lower": numbers(spread.lower),
            "upper": numbers(spread.upper),
            "samples": len(spread.samples),
            "peak_force": _interval(spread.peak_force),
            "drift_at_loss": _interval(spread.drift_at_loss),
            "energy": _interval(spread.energy, drawn.factor),
        }

    def scaled(
        self,
        given: Mapping[str, Any],
        loading: Mapping[str, Any],
        pause: Callable[[int], None],
        scales: Sequence[float] = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0),
    ) -> dict[str, Any]:
        """Return the peak drift of a motion by its scale, times that of the state."""
        found = self.solved(given, loading)
        if found.drawn is None or found.result is None or not found.result.dynamic:
            return {"none": "scales are for a motion of the ground"}
        now = _core.number(loading.get("scale", 1.0), "scale")
        rows = []
        for i, scale in enumerate(scales):
            other = self._solve(given, {**loading, "scale": scale * now})
            if other.result is not None:
                peak = float(np.max(np.abs(other.result.displacement), initial=0.0))
                rows.append(
                    {
                        "scale": scale * now,
                        "drift": _number(peak / other.result.column.height),
                        "status": other.result.summary["status"],
                    }
                )
            pause(i + 1)
        return {"scales": rows}


def _run_of(drawn: Drawn, loads: Loading) -> Callable[[], Result]:
    column = drawn.column
    if loads.drifts is not None:
        path = column.height * loads.drifts
        return lambda: cyclic(column, displacement=path, openings=True)
    motion = loads.motion
    assert motion is not None
    # Half of the acceleration where half of the column is computed.
    ground = motion.acceleration / drawn.factor
    return lambda: time_history(
        column,
        motion.time,
        ground_acceleration=ground,
        collapse_drift=0.2,
        openings=True,
    )


def _response(found: Answered) -> dict[str, Any]:
    """Return the response as the page draws it: between the ends of the column."""
    result = found.result
    assert result is not None
    factor = 1.0 if found.drawn is None else found.drawn.factor
    force = result.base_shear if result.dynamic else result.force
    rows = shown_rows(result.displacement, force)
    answer: dict[str, Any] = {
        "displacement": numbers(factor * result.displacement[rows]),
        "force": numbers(force[rows]),
        "height": factor * result.column.height,
        "status": result.summary["status"],
        "stopped": found.stopped,
        "method": result.summary["method"],
        "dynamic": result.dynamic,
        "title": found.case.title if found.case is not None else "",
        "states": [
            {
                "name": state.name,
                "displacement": _number(factor * state.displacement),
                "force": _number(_at(force, result, state.time)),
                "drift": _number(state.drift),
                "threshold": _number(state.threshold),
                "source": state.source,
            }
            for state in _states(result)
        ],
        "figures": {
            "peak_force": _number(float(np.max(np.abs(force), initial=0.0))),
            "peak_moment": _number(float(np.max(np.abs(result.base_moment), initial=0.0))),
            "peak_drift": _number(float(np.max(np.abs(result.drift), initial=0.0))),
            "drift_at_loss": _number(abs(result.strength_loss()) / result.column.height)
            if not result.dynamic
            else None,
            "residual_drift": _number(result.residual_drift),
            "energy": _number(factor * float(result.energy["spring"][-1]))
            if result.time.size
            else None,
        },
    }
    if result.dynamic:
        answer["time"] = numbers(result.time[rows])
    return answer


def shown_rows(displacement: Array, force: Array, most: int = _ROWS) -> NDArray[np.intp]:
    """Return the rows of a response that a figure needs: all, or the extremes of equal parts."""
    size = displacement.size
    if size <= most:
        return np.arange(size)
    kept = [0, size - 1]
    for part in np.array_split(np.arange(size), most // 4):
        for values in (displacement[part], force[part]):
            kept += [int(part[np.argmin(values)]), int(part[np.argmax(values)])]
    return np.unique(kept)


def _states(result: Result) -> list[Any]:
    try:
        return list(result.limit_states())
    except InputError:
        return []


def _at(values: Array, result: Result, when: float) -> float:
    return float(np.interp(when, result.time, values))


def figure_of(section: Section) -> dict[str, Any]:
    """Return the lines of a section as the program has them, y upward in tension."""
    figure: dict[str, Any] = {
        "outline": _points(section.outline()),
        "void": _points(section.void()),
        "bars": [
            [_number(x), _number(y), _number(d)]
            for x, y, d in section.place_bars(
                [(y, 2.0 * math.sqrt(area / math.pi)) for y, area, _ in section.bars]
            )
        ],
        "hoops": [],
        "legs": [],
        "steel_ratio": _number(section.steel_ratio),
    }
    ties = section.ties
    if ties is not None:
        bend = 0.5 * float(section.bar_diameter or 0.0)
        figure["hoops"] = [
            _points(section.hoop_line(inset, bend + ties.diameter - inset))
            for inset in (0.0, ties.diameter)
        ]
        if section.hollow:
            figure["hoops"] += [
                _points(section.void(section.cover + inset)) for inset in (ties.diameter, 0.0)
            ]
        figure["legs"] = [_points(leg) for leg in section.inner_legs()]
    return figure


def _curvature(section: Section, load: float, confined: bool) -> dict[str, Any]:
    options: dict[str, Any] = {"ultimate": "mander"} if confined else {}
    diagram = section.diagram(load, confined=confined, **options)
    events = {
        name: [_number(point.curvature), _number(point.moment)]
        for name in ("cracking", "yielding", "peak", "ultimate")
        if (point := getattr(diagram.events, name)) is not None
    }
    return {
        "curvature": numbers(diagram.curvature),
        "moment": numbers(diagram.moment),
        "events": events,
    }


def _interaction(section: Section, code: str | None) -> dict[str, Any]:
    points = 24 if code is None else 60
    diagram = section.interaction(code, points=points)  # type: ignore[arg-type]
    found = {
        "code": code,
        "axial_load": numbers(diagram.axial_load),
        "moment": numbers(diagram.moment),
    }
    if code is not None:
        found["design_axial_load"] = numbers(diagram.design_axial_load)
        found["design_moment"] = numbers(diagram.design_moment)
    return found


def _codes(section: Section, span: float, load: float) -> list[dict[str, Any]]:
    return [
        {
            "name": value.name,
            "meaning": value.meaning,
            "value": _number(value.value),
            "unit": value.unit,
            "source": value.source,
            "confirmed": value.confirmed,
        }
        for value in section.code_values(span, load)
    ]


def _facts(section: Section, span: float, load: float) -> dict[str, Any]:
    confined = section.confinement
    least, most = section.axial_capacity
    return {
        "axial_load_ratio": _number(load / (section.gross_area * section.concrete.fc)),
        "steel_ratio": _number(section.steel_ratio),
        "span_depth_ratio": _number(span / section.depth),
        "tie_ratio": None if confined is None else _number(confined.ratio),
        "confined_strength": None if confined is None else _number(confined.fcc),
        "axial_capacity": [_number(least), _number(most)],
    }


def _interval(interval: Any, factor: float = 1.0) -> list[float | None]:
    return [_number(factor * getattr(interval, end)) for end in ("lower", "value", "upper")]


def _tried(make: Callable[[], Any]) -> Any:
    """Return what a function makes, or the text of its error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return make()
        except RbsdemError as error:
            return {"fault": str(error)}


def numbers(values: Array) -> list[float | None]:
    """Return an array for JSON with six digits; None where it is not finite."""
    return [_number(value) for value in np.asarray(values, dtype=np.float64).tolist()]


def _number(value: float) -> float | None:
    return float(f"{value:.6g}") if math.isfinite(value) else None


def _points(line: Array) -> list[list[float | None]]:
    return [numbers(point) for point in np.asarray(line)]
