"""What the page shows of a section: figure, diagrams and values of codes, as JSON holds them."""

from __future__ import annotations

import math
import traceback
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np

from rbsdem._arguments import Array
from rbsdem.errors import RbsdemError
from rbsdem.model.section import Section
from rbsdem.section.interaction import InteractionDiagram
from rbsdem.section.model import LayeredColumn
from rbsdem.web.state import Drawn

__all__ = ["defect", "figure_of", "number", "numbers", "own_laws", "section_answer"]

#: Points of an interaction diagram that takes long.
_POINTS = 24


def section_answer(drawn: Drawn, code: str) -> dict[str, Any]:
    """Return moment-curvature, interaction by a code and code values of a drawn column."""
    section, load, span = drawn.section, drawn.column.axial_load, drawn.span
    return {
        "curvature": [
            _tried(lambda confined=confined: _curvature(section, load, confined))
            for confined in (False, True)
        ],
        "code": _tried(lambda: _interaction(section, code)),
        "codes": _tried(lambda: _codes(section, span, load)),
        "axial_load": number(load),
    }


def own_laws(drawn: Drawn) -> dict[str, Any]:
    """Return the interaction diagrams by own laws, of section and joint, which take long."""
    found = {"section": _tried(lambda: _interaction(drawn.section, None))}
    column = drawn.column
    if isinstance(column, LayeredColumn):
        found["joint"] = _tried(lambda: _curve(column.interaction(points=_POINTS)))
    return found


def defect(error: Exception) -> str:
    """Return what is said of an error that is no `InputError`; its traceback is printed."""
    traceback.print_exception(error)
    return (
        f"A defect of rbsdem, not of the input ({type(error).__name__}: {error}). Please report it "
        "with the input; the terminal has more."
    )


def _tried(make: Callable[[], Any]) -> Any:
    """Return what a function makes, or the text of its error."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            return make()
        except RbsdemError as error:
            return {"fault": str(error)}
        except Exception as error:
            # One panel says so; the others still stand.
            return {"fault": defect(error)}


def figure_of(section: Section) -> dict[str, Any]:
    """Return the lines of a section as the program has them, y upward in tension."""
    figure: dict[str, Any] = {
        "outline": _points(section.outline()),
        "void": _points(section.void()),
        "bars": [
            [number(x), number(y), number(d)]
            for x, y, d in section.place_bars(
                [(y, 2.0 * math.sqrt(area / math.pi)) for y, area, _ in section.bars]
            )
        ],
        "hoops": [],
        "legs": [],
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
        name: [number(point.curvature), number(point.moment)]
        for name in ("cracking", "yielding", "peak", "ultimate")
        if (point := getattr(diagram.events, name)) is not None
    }
    return {
        "curvature": numbers(diagram.curvature),
        "moment": numbers(diagram.moment),
        "events": events,
    }


def _interaction(section: Section, code: str | None) -> dict[str, Any]:
    points = _POINTS if code is None else 60
    diagram = section.interaction(code, points=points)  # type: ignore[arg-type]
    found = _curve(diagram) | {"code": code}
    if code is not None:
        found["design_axial_load"] = numbers(diagram.design_axial_load)
        found["design_moment"] = numbers(diagram.design_moment)
    return found


def _curve(diagram: InteractionDiagram) -> dict[str, Any]:
    return {"axial_load": numbers(diagram.axial_load), "moment": numbers(diagram.moment)}


def _codes(section: Section, span: float, load: float) -> list[dict[str, Any]]:
    return [
        {
            "name": value.name,
            "meaning": value.meaning,
            "value": number(value.value),
            "unit": value.unit,
            "source": value.source,
            "confirmed": value.confirmed,
        }
        for value in section.code_values(span, load)
    ]


def numbers(values: Array) -> list[float | None]:
    """Return an array for JSON with six digits; None where it is not finite."""
    return [number(value) for value in np.asarray(values, dtype=np.float64).tolist()]


def number(value: float) -> float | None:
    """Return a number for JSON, as `numbers`."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


def _points(line: Array) -> list[list[float | None]]:
    return [numbers(point) for point in np.asarray(line)]
