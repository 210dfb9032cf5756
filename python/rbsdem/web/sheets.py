"""The sheets of a report of each record: headings, texts, figures and tables."""

from __future__ import annotations

import base64
import datetime
import os
import platform
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import partial, singledispatch
from pathlib import Path
from typing import Any, get_args

import numpy as np

from rbsdem import _core
from rbsdem._files import atomic_write, data_frame, figure_bytes
from rbsdem._types import DataFrame
from rbsdem.checks.acceptance import Assessment, between, rows_at
from rbsdem.checks.code_values import code_values
from rbsdem.checks.infills import CHECK_NOTE, infills
from rbsdem.checks.target import Target
from rbsdem.errors import InputError
from rbsdem.many.ensemble import Ensemble
from rbsdem.many.ida import IDA
from rbsdem.model.shape import Section
from rbsdem.motions.motion import components
from rbsdem.output import buildings, frames, many, section
from rbsdem.output.loops import history
from rbsdem.output.style import style
from rbsdem.output.tables import cells
from rbsdem.output.units import paper, scales
from rbsdem.run.analysis import modes
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.frame_result import FrameResult
from rbsdem.section.curvature import diagram
from rbsdem.section.frame import Frame, Structure
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.plan import Building
from rbsdem.section.strength import Code, interaction
from rbsdem.web.pages import plain

#: Keys that only number things, or say how finely the program divides.
_NUMBERS = ("id", "steel", "strips", "spring", "joint")
#: Units of what the keys of a rule are, for springs that turn and for those that do not.
_OF_RULES = {
    True: {"stiffness": "N m/rad", "deformation": "rad", "force": "N m"},
    False: {"stiffness": "N/m", "deformation": "m", "force": "N"},
}
#: Members and sections that a report shows; more are in its tables.
_MOST_MEMBERS, _MOST_SECTIONS = 40, 6
_LEFT_OUT = (
    "the ground, splices that were not named, factors of force-controlled actions, of joints all "
    "but the strut (EN 1998) or limits that were given (ASCE 41). Tested frames were 10 to 20 % "
    "off in their peaks in the median, and a factor of 1.5 in the drift at the peak."
)
_STOREYS = (
    "Drift, shear, and the part theta = P d/(V h) of it that the dead load P makes (EN 1998-1, "
    "4.4.2.2)."
)
_FITTED = "theta is the median of the fitted curve, beta its dispersion; sample medians differ."


@dataclass(frozen=True)
class Sheet:
    """A part of a report.

    Attributes
    ----------
    heading, text : str
        Its heading and what stands below it.
    figures : tuple of callables
        Each draws, and returns axes.
    table : DataFrame or None
        Its table, which is written beside the report, too.
    beside : bool
        Whether the table is in the folder of tables only, as long ones are.
    """

    heading: str
    text: str = ""
    figures: tuple[Callable[[], Any], ...] = ()
    table: DataFrame | None = None
    beside: bool = False

    @property
    def name(self) -> str:
        """The heading, as it stands in names of files."""
        return self.heading.lower().replace(" ", "_").replace("-", "_")


def write(path: str | os.PathLike[str], page: str) -> Path:
    """Write a page, whole or not at all."""
    target = Path(path)
    with atomic_write(target) as file:
        file.write(page.encode("utf-8"))
    return target


# ---- reports of records --------------------------------------------------------------------------


def head(title: str, author: str, project: str, date: str | None) -> str:
    """Return the head of a report as html."""
    about = {
        "Project": project,
        "Author": author,
        "Date": datetime.date.today().isoformat() if date is None else date,
        "Program": f"rbsdem {_core.version()}, Python {platform.python_version()}, "
        f"numpy {np.__version__}",
    }
    lines = "<br>".join(plain(f"{name}: {text}") for name, text in about.items() if text)
    return f"<section><h1>{plain(title)}</h1><p>{lines}</p></section>"


def html_of(sheet: Sheet) -> str:
    """Return a sheet as html."""
    text = f"<p>{plain(sheet.text)}</p>" if sheet.text else ""
    drawn = "".join(map(_image, sheet.figures))
    figures = f'<div class="figures">{drawn}</div>' if drawn else ""
    table = "" if sheet.table is None or sheet.beside else _table(sheet.table)
    kind = plain(sheet.name)
    return (
        f'<section class="sheet-{kind}"><h2>{plain(sheet.heading)}</h2>{text}{figures}{table}'
        "</section>\n"
    )


def _image(draw: Callable[[], Any]) -> str:
    """Return a figure as an image of lines, which prints sharply."""
    import matplotlib.pyplot as plt  # noqa: PLC0415

    drawn = draw()
    with style():
        packed = base64.b64encode(figure_bytes(drawn, "svg")).decode()
    plt.close(np.ravel(drawn)[0].figure)
    return f'<img alt="" src="data:image/svg+xml;base64,{packed}">'


def _table(frame: DataFrame) -> str:
    """Return a table as html."""
    columns = cells(frame)
    kinds = ["" if numbers else ' class="text"' for _, numbers, _ in columns]

    def line(tag: str, texts: Iterable[str]) -> str:
        cells = (f"{kind}>{plain(text)}</" for kind, text in zip(kinds, texts, strict=True))
        return f"<tr>{''.join(f'<{tag}{cell}{tag[:2]}>' for cell in cells)}</tr>"

    head = line('th scope="col"', (heading for heading, *_ in columns))
    rows = zip(*(texts for *_, texts in columns), strict=True)
    body = "".join(line("td", row) for row in rows)
    return f"<table><thead>{head}</thead><tbody>{body}</tbody></table>"


# ---- sheets --------------------------------------------------------------------------------------


def inputs(statement: _core.Statement) -> DataFrame:
    """Return a row for each value of the groups of a case, with its unit and its meaning.

    Parameters
    ----------
    statement : Statement
        The groups.
    """
    known, rows, on_paper = _core.keys(), [], scales()
    for group, stated in _core.groups(statement):
        listed = [*known["groups"].get(group, []), *known["section"].get(stated.get("shape"), [])]
        listed += known["rules"].get(stated.get("rule"), {}).get("keys", [])
        keys = {key["name"]: key for key in listed}
        for name, value in stated.items():
            if name in _NUMBERS:
                continue
            key = keys.get(name, {})
            # The sizes of a shape are lengths.
            unit = key.get("unit", "" if key or group != "section" else "m")
            unit = _OF_RULES[group == "flexure"].get(unit, unit)
            scale, unit = (1.0, unit) if unit == "N/m" else on_paper.get(unit, (1.0, unit))
            values = ", ".join(
                each if isinstance(each, str) else f"{scale * each:.6g}"
                for each in (value if isinstance(value, list) else [value])
            )
            if key.get("kind") == "logical":
                values = "yes" if value else "no"
            rows.append((group, name, values, unit, key.get("meaning", "").split(":")[0]))
    return data_frame(rows, ["group", "key", "value", "in", "meaning"])


@singledispatch
def sheets_of(record: Any) -> Iterator[Sheet]:
    """Yield the sheets of a record.

    Parameters
    ----------
    record : Result, FrameResult, Section or IDA
        The record.
    """
    raise InputError(f"report: there is none of a {type(record).__name__}")


@sheets_of.register
def _of_result(result: ColumnResult) -> Iterator[Sheet]:
    """Yield the sheets of a response of a column."""
    yield _of_structure(result.column)
    yield Sheet("Summary", str(result.error_estimate), table=_summary(result.summary))
    if result.dynamic:
        yield Sheet("Base shear in time", figures=(partial(history, result, "base_shear"),))
    elif len(cycles := result.half_cycles()):
        yield Sheet("Half-cycles", table=cycles.to_pandas())
    with suppress(InputError):
        yield Sheet("Limit states", table=result.limit_states().to_pandas(), beside=True)
    yield from _walls(result)
    yield Sheet("Rows", table=result.to_pandas(), beside=True)


@sheets_of.register
def _of_building(result: BuildingResult) -> Iterator[Sheet]:
    """Yield the sheets of a response of a building, then those of its frames."""
    yield _of_plan(result.building)
    largest = int(np.abs(result.displacement).argmax())
    shapes = (
        partial(buildings.plan, result, row=largest),
        partial(buildings.building, result, row=largest),
    )
    whole = "At the largest displacement of the roof."
    yield Sheet("Building", f"{result.scope_note} {whole}", shapes, _summary(result.summary))
    for name, frame in result.frames.items():
        # The last sheet of a frame has its rows, which are among those of the building.
        for sheet in list(_of_response(frame))[:-1]:
            yield replace(sheet, heading=f"{name} {sheet.heading}")
    yield Sheet("Rows", table=result.to_pandas(), beside=True)


def _of_plan(building: Building) -> Sheet:
    """Return the sheet of the inputs of a building."""
    about = f"{building!r}: mass {building.parts.mass / 1e3:.4g} t"
    if building.parts.mass > 0:
        about += f"; elastic periods {', '.join(f'{t:.3g}' for t in modes(building, 3).period)} s"
    drawn = [partial(_titled, *pair) for pair in list(_drawings(building).items())[:_MOST_SECTIONS]]
    shown = (partial(buildings.plan, building), *drawn)
    return Sheet("Inputs", f"{about}.", shown, inputs(building._groups()), True)


@sheets_of.register
def _of_frame(result: FrameResult) -> Iterator[Sheet]:
    """Yield the sheets of a response of a frame."""
    yield _of_structure(result.frame)
    yield from _of_response(result)


def _of_response(result: FrameResult) -> Iterator[Sheet]:
    """Yield the sheets of a frame's response without its inputs; the last has the rows."""
    largest = int(np.abs(result.displacement).argmax())
    whole = "Displacements, hinges and forces at the largest displacement of the top."
    shapes = (
        partial(frames.frame, result, row=largest),
        partial(frames.member_forces, result, row=largest),
        partial(frames.member_forces, result, "axial", row=largest),
    )
    yield Sheet("Frame", f"{result.scope_note} {whole}", shapes)
    drawn: list[Callable[[], Any]] = [partial(frames.pushover, result)]
    if result.frame.storey_heights:
        drawn.append(partial(frames.storey_drift, result))
    yield Sheet("Response", figures=tuple(drawn), table=_summary(result.summary))
    if result.events:
        yield Sheet("Limit states", table=result.events.to_pandas(), beside=True)
    members = [result.member(name) for name in result.frame.parts.members]
    rows = {
        "member": [member.name for member in members],
        "largest_axial_N": [member.axial.max() for member in members],
        "least_axial_N": [member.axial.min() for member in members],
        "largest_moment_Nm": [np.abs(member.moment).max() for member in members],
        "largest_shear_N": [np.abs(member.shear).max() for member in members],
        "ductility": [np.fmax.reduce([np.nan, *member.ductility]) for member in members],
    }
    yield Sheet("Members", table=data_frame(rows), beside=len(members) > _MOST_MEMBERS)
    if result.frame.infilled:
        yield Sheet("Infills", CHECK_NOTE, table=infills(result))
    yield from _walls(result)
    yield Sheet("Rows", table=result.to_pandas(), beside=True)


def _walls(result: ColumnResult | FrameResult) -> Iterator[Sheet]:
    """Yield what tests say of the accuracy of drawn walls."""
    told = "; ".join(f"{name}: {accuracy}" for name, accuracy in result.wall_accuracy().items())
    if told:
        yield Sheet("Accuracy of walls", f"{told}.")


@sheets_of.register
def of_assessment(
    assessment: Assessment, target: Target | None = None, check: Any = None
) -> Iterator[Sheet]:
    """Yield the sheets of an assessment, with the target that it was made at and its check."""
    result = assessment.result
    parts = {"": assessment}
    if isinstance(result, BuildingResult):
        yield _of_plan(result.building)
        parts = {f"{name} ": assessment.frame(name) for name in result.frames}
    else:
        yield _of_structure(result.frame)
    curves: list[Callable[[], Any]] = [partial(frames.pushover, result)]
    text = repr(assessment)
    if target is not None:
        curves.append(partial(frames.target, target))
        end = () if target.reached else ("The push-over ends before the target.",)
        text = " ".join((f"{target.source}.", *end, *target.warnings))
    table = None if target is None else target.to_pandas()
    yield Sheet("Target displacement", text, tuple(curves), table)
    if check is not None:
        words = (
            f"The same frame under {len(check.record)} records scaled to the spectrum, "
            f"{int(check.collapsed.sum())} of which collapse: their median over the estimate, the "
            "scatter of the logarithm, and the range."
        )
        yield Sheet("Error of the target", words, table=check.to_pandas())
    row = -1
    if assessment.displacement is not None:
        away = np.abs(result.displacement - assessment.displacement)
        row = int(away.argmin())
    if isinstance(result, BuildingResult):
        shapes = (partial(draw, result, row=row) for draw in (buildings.plan, buildings.building))
        yield Sheet("Building", _judged(assessment), tuple(shapes), assessment.worst(10))
    for name, part in parts.items():
        response = part.result
        if response.frame.storey_heights:
            yield Sheet(f"{name}Storeys", _STOREYS, table=_storeys(part))
        drawn: list[Callable[[], Any]] = [partial(frames.frame, response, row=row)]
        if response.frame.storey_heights and assessment.displacement is None:
            drawn.append(partial(frames.storey_drift, response))
        drawn.append(partial(frames.assessment, part))
        yield Sheet(f"{name}Members", _judged(part), tuple(drawn), part.worst(10))
    yield Sheet("All members", table=assessment.to_pandas(), beside=True)
    words = f"{assessment.assumed} {result.scope_note} {_left_out(result.structure)}"
    yield Sheet("Assumed", words)


def _judged(assessment: Assessment) -> str:
    """Return how many ends exceed each level, in words before the largest ratios."""
    counts = ", ".join(f"{name}: {number}" for name, number in assessment.counts().items())
    told = "What exceeds its strength in shear has the colour of the last level."
    text = f"{assessment.source}: ends and joints that exceed each level: {counts}."
    return " ".join((text, told, *assessment.warnings, "The ten largest ratios follow."))


def _storeys(assessment: Assessment) -> DataFrame:
    """Return drifts, shears and P-Delta coefficients of the storeys, largest of the rows judged."""
    result = assessment.result
    _, rows = rows_at(result, assessment.displacement)
    drift, shear, theta = (
        np.abs(between(rows, values)).max(axis=0)
        for values in (result.storey_drift, result.storey_shear, result.stability_coefficient)
    )
    storeys = np.arange(1, drift.size + 1)
    return data_frame({"storey": storeys, "drift_drift": drift, "shear_N": shear, "theta": theta})


@sheets_of.register
def _of_section(
    drawing: Section, axial_load: float | None = None, length: float | None = None
) -> Iterator[Sheet]:
    """Yield the sheets of a section under an axial load."""
    if axial_load is None:
        raise InputError(
            "report: axial_load is missing; give it in N, as report(section, path, axial_load=1e6)"
        )
    load = _core.group("column", {"axial_load": axial_load, "height": length})
    yield _drawn(drawing, load)
    curve = diagram(drawing, axial_load)
    lines = [curve.idealise("caltrans"), curve.idealise("priestley")]
    drawn = (partial(section.moment_curvature, curve, idealise="caltrans"),)
    told = [curve, *lines, *(line.capacity(length) for line in lines if length is not None)]
    yield Sheet("Moment and curvature", "; ".join(map(str, told)), drawn)
    yield Sheet("Moment-curvature points", table=curve.to_pandas(), beside=True)
    strengths = {code: interaction(drawing, code) for code in get_args(Code)}
    for code, strength in strengths.items():
        (arm, of_moment), (scale, of_force) = paper("N m"), paper("N")
        moment, design = (
            arm * strength.moment_at(axial_load, design=reduced) for reduced in (False, True)
        )
        words = (
            f"Moment with N {scale * axial_load:.4g} {of_force}: nominal {moment:.4g} "
            f"{of_moment}, design {design:.4g} {of_moment}."
        )
        drawn = (partial(section.interaction, strength),)
        yield Sheet(f"Interaction {code}", words, drawn, strength.to_pandas(), beside=True)
    if length is not None:
        yield Sheet("Codes", table=code_values(drawing, length, axial_load).to_pandas())


@sheets_of.register
def _of_ensemble(ensemble: Ensemble) -> Iterator[Sheet]:
    """Yield the sheets of an ensemble."""
    yield _of_structure(next(iter(ensemble.columns.values())))
    table = ensemble.to_pandas()
    states = {"status": list(ensemble.counts), "runs": list(ensemble.counts.values())}
    yield Sheet("Runs", str(ensemble), table=data_frame(states))
    noted = table[["warnings", "error"]].melt(var_name="kind", value_name="text")
    noted = noted[noted["text"] != ""].value_counts().rename("runs").reset_index()
    if len(noted):
        yield Sheet("Warnings and errors", table=noted.head(20))
    names = list(ensemble.measures)
    measured = table.assign(**table[names].abs()).groupby("column", observed=True)[names]
    shares = measured.quantile([0.0, 0.16, 0.5, 0.84, 1.0]).stack().unstack(1)
    shares.columns = ["least", "16 %", "median", "84 %", "largest"]
    words = "Their sizes over motions and scales, in SI; without runs that failed."
    yield Sheet("Measures", words, table=shares.rename_axis(["column", "measure"]).reset_index())
    yield Sheet("All runs", table=table, beside=True)


@sheets_of.register
def _of_ida(analysis: IDA, limits: Mapping[str, Any] | None = None) -> Iterator[Sheet]:
    """Yield the sheets of an incremental dynamic analysis."""
    structure = next(iter(analysis.runs.columns.values()))
    yield _of_structure(structure)
    states = ", ".join(limits or {"collapse": None})
    about = {"intensity": analysis.runs.measure.label, "limit states": states} | analysis.settings
    about = {name: str(value) for name, value in about.items()}
    settings = {"setting": list(about), "value": list(about.values())}
    yield Sheet("Analysis", _damped(structure), table=data_frame(settings))
    motions = {name: components(record) for name, record in analysis.runs.motions.items()}
    records = {
        "record": list(motions),
        "points": [max(each.acceleration.size for each in parts) for parts in motions.values()],
        "step_s": [parts[0].dt for parts in motions.values()],
        "peak_m/s2": [max(each.pga for each in parts) for parts in motions.values()],
    }
    if len(analysis.runs.columns) == 1:
        records["collapse_m/s2"] = np.ravel(analysis.collapse_intensity)
    yield Sheet("Records", table=data_frame(records))
    yield Sheet("Curves", str(analysis), (partial(many.ida, analysis),))
    level, fractiles = analysis.fractiles()
    names = (f"fractile_{share}_drift" for share in (16, 50, 84))
    rows = {"intensity_m/s2": level} | dict(zip(names, fractiles, strict=True))
    yield Sheet("Fractiles", table=data_frame(rows), beside=True)
    try:
        curves = analysis.fragilities(limits or {"collapse": ("collapse", None)})
    except InputError as error:
        yield Sheet("Fragility", str(error))
        curves = {}
    fitted = [
        {"limit_state": name, "theta_m/s2": curve.theta, "beta": curve.beta}
        for name, curve in curves.items()
    ]
    if curves:
        yield Sheet("Fragility", _FITTED, (partial(many.fragilities, curves),), data_frame(fitted))
    table = analysis.to_pandas()
    ended = table["status"].value_counts().rename("runs").reset_index()
    yield Sheet("How the runs ended", table=ended)
    yield Sheet("Runs", table=table, beside=True)
    scope = f"{structure.scope_note} " if isinstance(structure, Frame) else ""
    yield Sheet("Assumed", f"{scope}{_left_out(structure)}")


def _left_out(structure: Structure) -> str:
    """Return what neither the model of a structure nor its limits have in them."""
    parts: list[Any] = [structure]
    across = "torsion and motion across the frame, "
    if isinstance(structure, Building):
        parts, across = [plane.frame for plane in structure.planes], ""
    infilled = any(getattr(part, "infilled", ()) for part in parts)
    masonry = "" if infilled else "infills, "
    return f"Strengths are those of the drawings. Left out: {across}{masonry}{_LEFT_OUT}"


def _damped(structure: Structure) -> str:
    """Return the damping of a structure in a sentence."""
    damping = structure.damping
    return f"Damping: {damping if damping is not None else 'none but that of the springs'}."


def _of_structure(structure: Structure) -> Sheet:
    """Return the sheet of what was given of a structure."""
    if isinstance(structure, Building):
        return _of_plan(structure)
    if isinstance(structure, LayeredColumn) and structure.drawing is not None:
        (keys,) = (values for name, values in _core.groups(structure._groups()) if name == "column")
        shown = ("height", "axial_load", "mass", "top_mass", "kinematics")
        return _drawn(structure.drawing.section, _core.group("column", {n: keys[n] for n in shown}))
    if not isinstance(structure, Frame):
        return Sheet("Inputs", table=inputs(structure._groups()))
    table = inputs(structure._statement)
    drawings = list(_drawings(structure).items())[:_MOST_SECTIONS]
    drawn = [partial(_titled, *pair) for pair in drawings]
    # Layers and springs of drawn members fill pages.
    return Sheet(
        "Inputs",
        _described(structure),
        (partial(frames.frame, structure), *drawn),
        table,
        beside=len(table) > 60,
    )


def _drawings(frame: Frame) -> dict[Section, str]:
    """Return the different sections of the members of a frame, and the names of these."""
    names_of: dict[Section, list[str]] = {}
    for name, kind in frame.kinds.items():
        drawings = dict.fromkeys(kind.sections or ())
        # The half of a column without the lap at its foot is the same drawing.
        for drawing in [each for each in drawings if getattr(each, "lap", None) is not None]:
            drawings.pop(replace(drawing, lap=None), None)  # type: ignore[call-arg]
        for drawing in drawings:
            names_of.setdefault(drawing, []).append(name)
    return {
        drawing: names[0] + (f" and {len(names) - 1} more" if len(names) > 1 else "")
        for drawing, names in names_of.items()
    }


def _titled(drawing: Section, title: str) -> Any:
    """Draw a section under a title."""
    drawn = section.section(drawing)
    drawn.set_title(title, fontsize=9)
    return drawn


def _described(frame: Frame) -> str:
    """Return a frame in words: sizes, masses, loads, periods, and its sections."""
    parts = frame.parts
    storeys, bays = (tuple(getattr(frame, name) or ()) for name in ("storeys", "bays"))
    sizes = [
        ", ".join(f"{length:g}" for length in (several[:1] if len(set(several)) == 1 else several))
        for several in (storeys, bays)
    ]
    scale, of_force = paper("N")
    beams: Any = frame.beam_load
    loads = ", ".join(f"{scale * load:.4g}" for floor in beams for load in np.atleast_1d(floor))
    words = [
        f"{len(storeys)} storeys of {sizes[0]} m and {len(bays)} bays of {sizes[1]} m"
        if storeys
        else f"{len(parts.nodes)} nodes and {len(parts.members)} members",
        f"mass {parts.mass / 1e3:.4g} t",
        f"load of the beams {loads} {of_force}/m",
        f"{'with' if frame.kinematics == 'pdelta' else 'without'} second-order work of the loads",
    ]
    if parts.mass > 0:
        first = modes(frame, min(3, len(parts.nodes))).period
        words.append(f"elastic periods {', '.join(f'{t:.3g}' for t in first)} s")
    drawn = [f"\n{names}: {section}." for section, names in _drawings(frame).items()]
    return "; ".join(words) + "." + "".join(drawn)


def _drawn(drawing: Section, values: _core.Statement) -> Sheet:
    """Return the sheet of the inputs of a section, with values that go before its own."""
    drawn = (partial(section.section, drawing),)
    return Sheet("Inputs", str(drawing), drawn, inputs(values + drawing.drawing()))


#: Units of figures of a summary that are not called like a channel of the rows.
_UNITS = {"displacement_at_peak_force": "m", "time_step": "s", "stable_step": "s"}


def _unit(name: str) -> str:
    """Return the unit of a figure of a summary: that of the channel which its name ends with."""
    if name in _UNITS or name.startswith("relative"):
        return _UNITS.get(name, "")
    if "energy" in name:
        return "J"
    units = _core.units()
    return next((unit for channel, unit in units.items() if f"_{name}".endswith(f"_{channel}")), "")


def _summary(summary: Mapping[str, Any]) -> DataFrame:
    """Return the figures of an analysis, a row for each; what does not apply is left out."""
    rows = []
    for name, value in summary.items():
        if name == "stable_step" and not value:  # of explicit methods
            continue
        unit = _unit(name)
        scale, unit = paper(unit)
        text = f"{scale * value:.4g}" if isinstance(value, int | float) else str(value)
        if text:
            rows.append((name.replace("_", " "), text, unit))
    return data_frame(rows, ["figure", "value", "in"])
