"""What the page shows of a state: loops with limit states, diagrams, code values, bands.

Answers are what JSON holds, in SI, with six digits. The functions are those that everybody calls;
columns and results that were just made are kept, as several answers stand on them.
"""

from __future__ import annotations

import time
import warnings
from collections import OrderedDict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError, RbsdemError, SolveError
from rbsdem.motions.motion import GroundMotion
from rbsdem.results.case import Case
from rbsdem.results.result import Result, cyclic, time_history
from rbsdem.section.model import LayeredColumn
from rbsdem.web.diagrams import defect, figure_of, number, numbers, own_laws, section_answer
from rbsdem.web.state import (
    Drawn,
    Faults,
    Loading,
    column_of,
    in_motion,
    key_of,
    loading_of,
    section_of,
)
from rbsdem.web.texts import case_of_text

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
        try:
            answered = self._solve(given, loading)
        except Exception as error:
            answered = Answered(None, None, None, [{"field": "", "text": defect(error)}], [])
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
                with warnings.catch_warnings(record=True) as told:
                    warnings.simplefilter("always")
                    case = case_of_text(given["case"])
            except RbsdemError as error:
                return Answered(None, None, None, [{"field": "case", "text": str(error)}], [])
            notes = [str(one.message) for one in told]
            column = case.column
            if isinstance(column, LayeredColumn) and column.recipe is not None:
                drawn = Drawn(column, column.recipe.section, column.recipe.height, 1.0)
            # The strains of a layered hinge follow from its openings.
            run = partial(case.run, openings=True)
        else:
            drawn, notes = column_of(given, faults)
            loads = loading_of(loading, self.records, faults)
            if drawn is not None and loads is not None and loads.motion is not None:
                drawn = in_motion(drawn, given, faults)
            if drawn is None or loads is None or faults:
                return Answered(None, None, None, faults.listed(), notes)
            run = _run_of(drawn, loads)
        stopped, result = "", None
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            try:
                result = run()
            except RbsdemError as error:
                result = error.result if isinstance(error, SolveError) else None
                if result is None:
                    field = "case" if case is not None else "loading.kind"
                    return Answered(None, None, None, [{"field": field, "text": str(error)}], notes)
                stopped = str(error)
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
        return self._of_drawn(state, lambda drawn: section_answer(drawn, code))

    def own_interaction(self, state: Mapping[str, Any]) -> list[dict[str, Any]]:
        """Return the interaction diagrams of each column by own laws, of section and joint."""
        return self._of_drawn(state, own_laws)

    def _of_drawn(
        self, state: Mapping[str, Any], answer: Callable[[Drawn], dict[str, Any]]
    ) -> list[dict[str, Any]]:
        """Return an answer for each drawn column; nothing for a case or refused input."""
        drawn = (self.solved(given, state["loading"]).drawn for given in state["columns"])
        return [{} if one is None else answer(one) for one in drawn]

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
        now = _arguments.number(loading.get("scale", 1.0), "scale")
        rows = []
        for i, scale in enumerate(scales):
            other = self._solve(given, {**loading, "scale": scale * now})
            if other.result is not None:
                peak = float(np.max(np.abs(other.result.displacement), initial=0.0))
                rows.append(
                    {
                        "scale": scale * now,
                        "drift": number(peak / other.result.column.height),
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
    return lambda: time_history(
        column,
        motion.time,
        ground_acceleration=motion.acceleration,
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
                "displacement": number(factor * state.displacement),
                "force": number(state.force),
                "drift": number(state.drift),
                "threshold": number(state.threshold),
                "source": state.source,
            }
            for state in result.limit_states()
        ],
        "figures": {
            "peak_force": number(float(np.max(np.abs(force), initial=0.0))),
            "peak_moment": number(float(np.max(np.abs(result.base_moment), initial=0.0))),
            "peak_drift": number(float(np.max(np.abs(result.drift), initial=0.0))),
            "drift_at_loss": number(abs(result.strength_loss()) / result.column.height)
            if not result.dynamic
            else None,
            "residual_drift": number(result.residual_drift),
            "energy": number(factor * float(result.energy["spring"][-1]))
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


def _interval(interval: Any, factor: float = 1.0) -> list[float | None]:
    return [number(factor * getattr(interval, end)) for end in ("lower", "value", "upper")]
