"""Answers to the page about its cases: loops with limit states, diagrams, codes, bands, tests.

Answers are what JSON holds, in SI, with six digits. The functions are those that everybody calls;
columns and results that were just made are kept, as several answers stand on them.
"""

from __future__ import annotations

import hashlib
import math
import re
import tempfile
import time
import traceback
from collections import OrderedDict
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._package import recorded, unwarned
from rbsdem._types import Array
from rbsdem.checks.code_values import code_values
from rbsdem.errors import InputError, RbsdemError, SolveError
from rbsdem.measured.predict import Prediction, nearest, predict
from rbsdem.measured.specimens import Specimen, Specimens, read_specimens
from rbsdem.model.shape import Section
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.read import read_motion
from rbsdem.output.section import hoop_lines
from rbsdem.run.bands import band as band_of
from rbsdem.run.case import Case
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.frame_result import FrameResult
from rbsdem.section.curvature import diagram as diagram_of
from rbsdem.section.layered import LayeredColumn, LayeredModel
from rbsdem.section.strength import InteractionDiagram, interaction
from rbsdem.web import frames
from rbsdem.web.state import (
    MOST_VALUES,
    Faults,
    RefusedError,
    case_of,
    first,
    is_frame,
    key_of,
    namelist,
    number,
    numbers,
    opened,
    sections_of,
    shown_rows,
    state_of,
)

#: Results that are kept: those of two columns, before and after a few undos; records that are kept.
_KEPT, _RECORDS = 12, 16
#: Points of an interaction diagram that takes long.
_POINTS = 24
#: Figures of which a band has an interval.
_INTERVALS = ("peak_force", "drift_at_loss", "energy")
#: Factors of a motion for which the peak drift is shown.
_SCALES = (0.5, 0.75, 1.0, 1.5, 2.0, 3.0)

Asked = Mapping[str, Any]
Pause = Callable[[], None]


@dataclass(frozen=True)
class Answered:
    """A case of the page with its response.

    Attributes
    ----------
    result : Result or FrameResult, or None
        The response; None if the input is wrong.
    case : Case or None
        The case as it is read from its groups.
    faults : list
        Messages with their fields.
    notes : list of str
        Notes of the program.
    stopped : str
        Why the analysis ended early.
    seconds : float
        Time for structure, path and limit states.
    sections : dict
        Sections by the names of their drawings.
    """

    result: Any = None
    case: Case | None = None
    faults: list[dict[str, str]] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    stopped: str = ""
    seconds: float = 0.0
    sections: dict[str, Any] = field(default_factory=dict)

    @property
    def drawing(self) -> LayeredModel | None:
        """The drawing of the column that was computed; None of what has none."""
        return getattr(getattr(self.result, "column", None), "drawing", None)


class Answers:
    """Answers to requests of the page; one of them is computed at a time.

    Each method takes a request, a mapping with the state, and a function that it calls between
    parts that take long.

    Parameters
    ----------
    near : Specimens, optional
        Tests to compare with, which have histories.
    """

    def __init__(self, near: Specimens | None = None) -> None:
        self.near = near
        self.records: dict[str, GroundMotion] = {}
        self._kept: OrderedDict[str, Answered] = OrderedDict()

    # ---- loops ----------------------------------------------------------------------------------

    def solved(self, case: Any) -> Answered:
        """Return a case of the state with its response, solved once and kept."""
        key = key_of(case)
        if key in self._kept:
            self._kept.move_to_end(key)
            return self._kept[key]
        begun = time.perf_counter()
        try:
            answered = self._solve(case)
        except Exception as error:
            answered = Answered(faults=[{"field": "", "text": defect(error)}])
        answered = replace(answered, seconds=time.perf_counter() - begun)
        # A refused input may be right later: a record may be opened meanwhile.
        if answered.result is not None:
            self.keep(case, answered)
            while len(self._kept) > _KEPT:
                self._kept.popitem(last=False)
        return answered

    def keep(self, case: Any, known: Answered) -> None:
        """Keep a case with its response that was computed elsewhere."""
        self._kept[key_of(case)] = known

    def _solve(self, stated: Any) -> Answered:
        """Return the answer of the program to the groups or the text of a case."""
        faults = Faults([] if isinstance(stated, str) else stated)
        # A section may be drawn although the case is refused.
        sections = {} if isinstance(stated, str) else sections_of(stated)
        case, notes = case_of(stated, self.records, faults)
        about: dict[str, Any] = {"sections": sections, "faults": faults.listed}
        if case is None:
            return Answered(notes=notes, **about)
        result: Any = None
        stopped = ""
        with recorded() as told, faults.kept():
            try:
                if is_frame(stated):
                    result, stopped = frames.solved(case)
                else:
                    # The strains of a layered hinge follow from its openings.
                    result = case.run(case.plain_column("the page"), openings=True)
            except SolveError as error:
                result, stopped = error.result, str(error)
                if result is None or not result.time.size:
                    result = None
                    faults.add("", stopped)
        notes = [*notes, *(str(warning.message) for warning in told)]
        return Answered(result, case, notes=list(dict.fromkeys(notes)), stopped=stopped, **about)

    def _columns(
        self, asked: Asked, pause: Pause, answer: Callable[[Any, Answered], dict[str, Any]]
    ) -> dict[str, Any]:
        """Return the answer about each column of the state with its response."""
        cases = state_of(asked)
        if any(map(is_frame, cases)):
            raise RefusedError(400, "state: this is asked of columns")
        columns = []
        for case, answered in [(case, self.solved(case)) for case in cases]:
            pause()
            columns.append(answer(case, answered))
        return {"columns": columns}

    def loops(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return the loop of each column, or of a frame, with limit states and its sections."""
        cases = state_of(asked)
        if is_frame(cases[0]):
            return {"frame": self._loop(cases[0])}
        return {"columns": [self._loop(case) for case in cases]}

    def _loop(self, case: Any) -> dict[str, Any]:
        """Return what the page draws of a response."""
        begun = time.perf_counter()
        answered = self.solved(case)
        drawing, result = answered.drawing, answered.result
        answer: dict[str, Any] = {"faults": answered.faults, "notes": answered.notes}
        figures = {n: s and _figure(s) for n, s in answered.sections.items()}
        if is_frame(case):
            answer |= {"stopped": answered.stopped, "sections": figures}
            answer |= {} if result is None else frames.to_json(result)
        else:
            answer["figure"] = next(iter(figures.values()), None)
            if drawing is not None:
                answer |= {"figure": _figure(drawing.section), "model": result.column.model}
            if result is not None:
                title = answered.case.title if answered.case else ""
                answer |= to_json(result) | {"stopped": answered.stopped, "title": title}
        return answer | {"seconds": round(max(answered.seconds, time.perf_counter() - begun), 4)}

    def checks(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return the target displacement of a frame, and its members beside their limits."""
        (case, *_) = state_of(asked)
        answered = self.solved(case) if is_frame(case) else Answered()
        if answered.case is None or answered.result is None:
            return {}
        return frames.checked(answered.case, answered.result, Faults(case))

    # ---- the section ----------------------------------------------------------------------------

    def sections(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return moment-curvature, interaction and code values of each drawn column."""
        code = asked.get("code", "aci318")
        if code not in ("aci318", "ec2"):
            raise RefusedError(400, "code must be aci318 or ec2")

        def answer(_: Any, answered: Answered) -> dict[str, Any]:
            drawing = answered.drawing
            if drawing is None:
                return {}
            section, load = drawing.section, drawing.axial_load
            return {
                "curvature": [_tried(_curvature, section, load, c) for c in (False, True)],
                "code": _tried(_interaction, section, code),
                "codes": _tried(_codes, section, drawing.height, load),
                "axial_load": number(load),
            }

        return self._columns(asked, pause, answer)

    def own(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return interaction diagrams by material laws, of section and joint; they take long."""

        def answer(_: Any, answered: Answered) -> dict[str, Any]:
            if answered.drawing is None:
                return {}
            return {
                "section": _tried(_interaction, answered.drawing.section, None),
                "joint": _tried(_joint, answered.result.column),
            }

        return self._columns(asked, pause, answer)

    # ---- uncertainty ----------------------------------------------------------------------------

    def bands(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return for each path the band that holds 80 % of the points of left-out tests."""
        return self._columns(asked, pause, lambda _, answered: _band(answered))

    def scales(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return the peak drift under a motion by its scale, times that of the state."""

        def answer(case: Any, answered: Answered) -> dict[str, Any]:
            drawn = answered.drawing is not None and not isinstance(case, str)
            if not drawn or not answered.result.dynamic:
                return {"none": "scales are for a motion of the ground"}
            now = _arguments.number(first(case, "loading").get("scale", 1.0), "scale")
            rows = []
            for scale in _SCALES:
                scaled = [
                    [name, {**values, "scale": scale * now} if name == "loading" else values]
                    for name, values in case
                ]
                result = self._solve(scaled).result
                if result is not None:
                    status = result.summary["status"]
                    rows.append(
                        {"scale": scale * now, "drift": _peak(result.drift), "status": status}
                    )
                pause()
            return {"scales": rows}

        return self._columns(asked, pause, answer)

    def nearest(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return the tests that are most like each column."""
        tests = self.near
        if tests is None:
            return {"none": "rbsdem explore --tests FOLDER shows the tests that are most like it"}

        def answer(case: Any, answered: Answered) -> dict[str, Any]:
            drawing = None if isinstance(case, str) else answered.drawing
            if drawing is None or drawing.section.hollow:
                return {"none": "the folder has no tests of such columns"}
            try:
                near = nearest(drawing.section, drawing.height, drawing.axial_load, tests, _TESTS)
            except (RbsdemError, ValueError) as error:
                return {"none": str(error)}
            rows = []
            for neighbour in near:
                pause()
                rows.append(
                    _card(_predicted(neighbour.specimen))
                    | {"distance": round(neighbour.distance, 3)}
                )
            return {"tests": rows}

        return self._columns(asked, pause, answer) | {"tests": len(tests)}

    # ---- texts ----------------------------------------------------------------------------------

    def export(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return a column or a frame as a case file, or its rows as csv."""
        cases, form, which = state_of(asked), asked.get("form"), asked.get("column", 0)
        if form not in ("namelist", "csv"):
            raise RefusedError(400, "form must be namelist or csv")
        if type(which) is not int or not 0 <= which < len(cases):
            raise RefusedError(400, "column must be the number of a column")
        case = cases[which]
        answered = self.solved(case)
        if answered.result is None:
            return {"faults": answered.faults}
        csv = form == "csv"
        return {
            "text": _csv_of(answered.result) if csv else namelist(case, self.records),
            "name": "frame" if is_frame(case) else f"column_{'ab'[which]}",
        }

    def open(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Return the state of the text of a case file."""
        return opened(asked.get("text"), self.keep_record)

    def keep_record(self, motion: GroundMotion, name: str) -> str:
        """Keep a record; return the name by which a loading asks for it."""
        digest = hashlib.sha256(motion.acceleration.tobytes() + repr(motion.dt).encode())
        key = f"{name.replace('#', '')}#{digest.hexdigest()[:12]}"
        self.records[key] = motion
        while len(self.records) > _RECORDS:
            self.records.pop(next(iter(self.records)))
        return key

    def record(self, asked: Asked, pause: Pause) -> dict[str, Any]:
        """Keep the record of a text; return the name by which a loading asks for it."""
        text, name = asked.get("text"), asked.get("name")
        if not isinstance(text, str) or not isinstance(name, str):
            raise RefusedError(400, "name and text must be texts")
        shown = name[:80]
        try:
            # A text of more than one line is no path.
            motion = read_motion(f"{text}\n\n", asked.get("units"), asked.get("dt"))
            if motion.acceleration.size > MOST_VALUES:
                raise InputError(
                    f"{shown}: {motion.acceleration.size} values are too many here; at most "
                    f"{MOST_VALUES}: cut the record or take larger steps"
                )
        except RbsdemError as error:
            told = re.sub(r"^text\b", lambda _: shown, str(error))
            return {"faults": [{"field": "loading.file", "text": told}]}
        return {"file": self.keep_record(motion, shown)}


#: Questions, by the last part of the path.
ONCE = ("export", "open", "record", "report")
LANES = ("loops", "checks", "sections", "own", "bands", "scales", "nearest", *ONCE)


def _csv_of(result: ColumnResult | FrameResult) -> str:
    """Return the rows of a result as the executable writes them."""
    with tempfile.TemporaryDirectory(prefix="rbsdem-") as folder:
        rows = Path(folder) / "rows.csv"
        result.to_csv(rows)
        return rows.read_text(encoding="utf-8")


# ---- a response as JSON -------------------------------------------------------------------------


def to_json(result: ColumnResult) -> dict[str, Any]:
    """Return the response of a column as the page draws it."""
    force = result.base_shear if result.dynamic else result.force
    rows = shown_rows(result.displacement, force)
    height, spring = result.column.height, result.energy["spring"]
    footing, loss = result.column.footing is not None, None
    if not result.dynamic:
        loss = number(abs(result.strength_loss()) / height)
    numbered = ("displacement", "force", "drift")
    answer: dict[str, Any] = {
        "displacement": numbers(result.displacement[rows]),
        "force": numbers(force[rows]),
        "height": height,
        "status": result.summary["status"],
        "method": result.summary["method"],
        "dynamic": result.dynamic,
        "states": [
            {"name": state.name, "source": state.source}
            | {name: number(getattr(state, name)) for name in numbered}
            for state in result.limit_states()
        ],
        "figures": {
            "peak_force": _peak(force),
            # That of the column, not of the ground beneath its footing.
            "peak_moment": _peak(result.moment[:, 1] if footing else result.base_moment),
            "peak_drift": _peak(result.drift),
            "drift_at_loss": loss,
            "residual_drift": number(result.residual_drift),
            "energy": number(spring[-1]) if spring.size else None,
        },
    }
    return answer | ({"time": numbers(result.time[rows])} if result.dynamic else {})


def _peak(values: Array) -> float | None:
    """Return the largest absolute value for JSON, 0 without values."""
    return number(float(np.max(np.abs(values), initial=0.0)))


def _band(answered: Answered) -> dict[str, Any]:
    """Return the band of a prediction."""
    result = answered.result
    if answered.drawing is None or result.dynamic:
        return {"none": "a band is for a drawn column on a path"}
    with unwarned(Warning):
        try:
            band = band_of(result.column, result.displacement)
        except InputError as error:
            return {"none": str(error)}
    return {
        "lower": numbers(band.lower),
        "upper": numbers(band.upper),
        **{name: _interval(getattr(band, name)) for name in _INTERVALS},
    }


def _interval(interval: Any) -> list[float | None]:
    """Return the lower end, the value and the upper end of an interval for JSON."""
    return [number(getattr(interval, end)) for end in ("lower", "value", "upper")]


# ---- a section as JSON --------------------------------------------------------------------------


def defect(error: Exception) -> str:
    """Return the text of an error that is no `InputError`; its traceback is printed."""
    traceback.print_exception(error)
    return (
        f"A defect of rbsdem, not of the input ({type(error).__name__}: {error}). Please report it "
        "with the input; the terminal has more."
    )


def _tried(make: Callable[..., Any], *arguments: Any) -> Any:
    """Return the value of a function, or the text of its error."""
    with unwarned(Warning):
        try:
            return make(*arguments)
        except RbsdemError as error:
            return {"fault": str(error)}
        except Exception as error:
            # One panel says so; the others still stand.
            return {"fault": defect(error)}


def _figure(section: Section) -> dict[str, Any]:
    """Return the lines of a section as the program has them, y upward in tension."""
    bars = [(y, 2.0 * math.sqrt(area / math.pi)) for y, area, _ in section.bars]
    return {
        "outline": _points(section.outline()),
        "void": _points(section.void()),
        "bars": [numbers(np.array(bar)) for bar in section.place_bars(bars)],
        "hoops": [_points(line) for line in hoop_lines(section)],
        "legs": [_points(leg) for leg in section.inner_legs()],
    }


def _curvature(section: Section, load: float, confined: bool) -> dict[str, Any]:
    """Return a moment-curvature diagram with its events for JSON."""
    options: dict[str, Any] = {"ultimate": "mander"} if confined else {}
    diagram = diagram_of(section, load, confined=confined, **options)
    corners = asdict(diagram.events).items()
    events = {name: [number(p["curvature"]), number(p["moment"])] for name, p in corners if p}
    points = {"curvature": numbers(diagram.curvature), "moment": numbers(diagram.moment)}
    return points | {"events": events}


def _interaction(section: Section, code: str | None) -> dict[str, Any]:
    """Return an interaction diagram for JSON: of a code, or by material laws."""
    points = _POINTS if code is None else 60
    diagram = interaction(section, code, points=points)  # type: ignore[arg-type]
    curves = _curve(diagram) | {"code": code}
    if code is not None:
        curves["design_axial_load"] = numbers(diagram.design_axial_load)
        curves["design_moment"] = numbers(diagram.design_moment)
    return curves


def _joint(column: LayeredColumn) -> dict[str, Any]:
    """Return the interaction diagram of the joint at the foot for JSON."""
    return _curve(column.interaction(points=_POINTS))


def _curve(diagram: InteractionDiagram) -> dict[str, Any]:
    """Return axial loads and moments of a diagram for JSON."""
    return {"axial_load": numbers(diagram.axial_load), "moment": numbers(diagram.moment)}


def _codes(section: Section, span: float, load: float) -> list[dict[str, Any]]:
    """Return the values of codes for JSON."""
    return [
        asdict(value) | {"value": number(value.value)} for value in code_values(section, span, load)
    ]


def _points(line: Array) -> list[list[float | None]]:
    """Return the points of a line for JSON."""
    return [numbers(point) for point in np.asarray(line)]


# ---- measured tests ------------------------------------------------------------------------------


#: Scores of a test that is shown.
_SCORES = ("nrmse", "peak_ratio", "energy_ratio", "stiffness_ratio", "end_ratio")
#: Tests that stand beside a column, and the most points of their lines.
_TESTS, _POINTS_OF_TEST = 4, 600
#: How far a model is drawn beyond its test: of the largest force that is in the box.
_BEYOND = 1.08
#: Largest force in the box over that of the test: beyond, nothing would be seen of the test.
_LARGEST = 2.0


def tests_of(folder: Path) -> Specimens:
    """Return the tests of a folder that have a history, for `Answers`."""
    tests = read_specimens(folder).with_history()
    if not tests:
        raise InputError(f"{folder} has no history of any test of its table")
    return tests


@lru_cache(maxsize=256)
def _predicted(test: Specimen) -> Prediction:
    """Return the prediction of a test, which is kept for the next column."""
    with unwarned(Warning):
        return predict([test])[0]


def _card(row: Prediction) -> dict[str, Any]:
    """Return a test for JSON; without a comparison it has no lines."""
    specimen, c = row.specimen, row.comparison
    card: dict[str, Any] = {
        "name": specimen.name,
        "failure": specimen.failure_mode or "not known",
        "section": specimen.section,
        "axial_load_ratio": number(specimen.axial_load_ratio),
        "span_depth_ratio": number(specimen.span_depth_ratio),
        "status": row.status,
        "error": row.error,
        "scores": {name: number(row.score(name)) for name in _SCORES},
    }
    if c is None:
        return card
    model = c.model_force[: c.rows]
    displacement = float(np.max(np.abs(c.displacement))) or 1.0
    test = float(np.max(np.abs(c.test_force))) or 1.0
    force = min(max(test, float(np.max(np.abs(model), initial=0.0))), _LARGEST * test)
    lines = {"test": c.test_force / force, "model": np.clip(model / force, -_BEYOND, _BEYOND)}
    card |= {"displacement": displacement, "force": force, "height": c.height}
    for name, values in lines.items():
        rows = shown_rows(c.displacement[: values.size], values, _POINTS_OF_TEST)
        line = np.column_stack((c.displacement[rows] / displacement, values[rows]))
        card[name] = np.rint(1e3 * line).astype(np.int64).ravel().tolist()
    return card
