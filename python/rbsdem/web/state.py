"""The state of the page as sections, columns and loadings; what is wrong goes beside its field.

A state is what JSON holds: dicts, lists, numbers in SI. Nothing is checked here that the program
checks itself: the fields of its `InputError` become the fields of the form.
"""

from __future__ import annotations

import dataclasses
import json
import math
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._package import recorded
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, NDArray
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.model.column import Column, Footing
from rbsdem.model.materials import CONCRETE_DENSITY, Bars, Concrete, Layout, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection, Section, TeeSection
from rbsdem.model.springs import Elastic
from rbsdem.motions.motion import GroundMotion, synthetic
from rbsdem.run.case import Case
from rbsdem.run.protocol import protocol
from rbsdem.run.solver import COLLAPSE_DRIFT
from rbsdem.section import columns
from rbsdem.section.curvature import column_length

#: The column that the page begins with: test No 1 of Soesianawati and others (1986).
DEFAULT: dict[str, Any] = {
    "columns": [
        {
            "name": "A",
            "section": {"shape": "rectangle", "width": 0.4, "depth": 0.4, "cover": 0.013},
            "concrete": {"fc": 46.5e6},
            "bars": {"number": 12, "diameter": 0.016, "fy": 446e6, "fu": 702e6},
            "ties": {"diameter": 0.007, "spacing": 0.085, "fy": 364e6, "legs": 4},
            "column": {"height": 1.6, "ends": "cantilever", "axial_load": 744e3},
        }
    ],
    "loading": {
        "kind": "amplitudes",
        "amplitudes": [0.0025, 0.005, 0.0075, 0.01, 0.015, 0.02, 0.03, 0.04, 0.05, 0.06],
        "cycles": 2,
    },
}

#: How a column is held, and its height over the distance from an end to where its moment is zero.
ENDS = {"cantilever": 1.0, "double": 2.0}

#: Columns side by side, cycles of a path and values of a record that a page shows.
_MOST_COLUMNS, _MOST_CYCLES, MOST_VALUES = 2, 200, 60_000
_MOST_BARS = 50

#: Rows of a response in an answer; a figure shows no more.
_ROWS = 8000

#: Shapes with the names of their sizes.
SHAPES: dict[str, tuple[Callable[..., Section], tuple[str, ...]]] = {
    "rectangle": (RectangularSection, ("width", "depth")),
    "hollow_rectangle": (RectangularSection, ("width", "depth", "wall")),
    "circle": (CircularSection, ("diameter",)),
    "hollow_circle": (CircularSection, ("diameter", "wall")),
}

#: Groups of the form by the objects that errors name; others belong to the part that is made.
_GROUPS = {"layout": "bars", "spiral": "ties"} | {n: n for n in ("ties", "section", "footing")}
#: Fields of the form that errors name otherwise.
_FIELDS = {
    "section.bar_diameter": "bars.diameter",
    "section.flange_width": "section.flange",
    "section.flange_thickness": "section.slab",
    "loading.protocol": "loading.name",
}
#: The ground beneath a column: none but the column's own foot, or a footing on springs.
_GROUND = ("none", "springs")


class RefusedError(Exception):
    """A request that is not answered: status and a text for who wrote the client."""

    def __init__(self, status: int, text: str) -> None:
        super().__init__(text)
        self.status = status


class Faults:
    """The messages of one column or loading, as "field" and "text".

    Attributes
    ----------
    listed : list of dict
        The messages; a field is a field of the form, as "bars.number".
    """

    def __init__(self) -> None:
        self.listed: list[dict[str, str]] = []

    def add(self, field: str, text: str) -> None:
        """Add a message."""
        self.listed.append({"field": field, "text": text})

    @contextmanager
    def of(self, group: str, otherwise: str) -> Iterator[None]:
        """Keep the errors of a part of the drawing, each line beside the field that it names.

        Parameters
        ----------
        group : str
            Group of the form that the part belongs to.
        otherwise : str
            Its field for messages that name none.
        """
        try:
            yield
        except InputError as error:
            for name, line in error.faults:
                owner, _, value = name.rpartition(".")
                field = f"{_GROUPS.get(owner, group)}.{value or otherwise}"
                self.add(_FIELDS.get(field, field), line)


@dataclasses.dataclass(frozen=True)
class Drawn:
    """A column of the page that was made.

    Attributes
    ----------
    column : Column
        The column that is computed: along a path the lower half of one in double curvature, unless
        a footing makes its ends unlike.
    section : Section
        Its section.
    span : float
        From an end to where the moment is zero [m].
    factor : float
        Displacement between the ends over that of the column that is computed.
    """

    column: Column
    section: Section
    span: float
    factor: float


def key_of(value: object) -> str:
    """Return a text that is the same for the same state."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"))


def state_of(asked: Mapping[str, Any], frames: bool = False) -> dict[str, Any]:
    """Return the state of a request: columns or a frame, and a loading.

    Their values are checked later.

    Raises
    ------
    RefusedError
        If the request has none.
    """
    state = asked.get("state")
    if not isinstance(state, dict):
        raise RefusedError(400, "state must be an object")
    columns, loading = state.get("columns"), state.get("loading")
    if frames and "frame" in state:
        if not isinstance(state["frame"], dict) or not isinstance(loading, dict):
            raise RefusedError(400, "state: frame and loading must be objects")
        return {"frame": state["frame"], "loading": loading}
    if not isinstance(columns, list) or not 1 <= len(columns) <= _MOST_COLUMNS:
        raise RefusedError(400, "state: columns must be a list of one or two")
    if not all(isinstance(column, dict) for column in columns) or not isinstance(loading, dict):
        raise RefusedError(400, "state: each column and the loading must be objects")
    return {"columns": columns, "loading": loading}


def drawn_case(
    given: Mapping[str, Any],
    loading: Mapping[str, Any],
    records: Mapping[str, GroundMotion],
    faults: Faults,
) -> tuple[Case | None, Drawn | None, list[str]]:
    """Return a drawn column under its loading as a case, and the notes of the program.

    Parameters
    ----------
    given, loading : mapping
        A column and the loading of the state.
    records : mapping
        The records that were opened, by their digests.
    faults : Faults
        What is wrong is added here; then there is no case.
    """
    load = loading_of(loading, records, faults)
    drawn, notes = column_of(given, faults, whole=isinstance(load, GroundMotion))
    if drawn is not None and isinstance(load, GroundMotion):
        drawn = _in_motion(drawn, given, faults)
    if drawn is None or load is None or faults.listed:
        return None, None, notes
    title = str(given.get("name", ""))[:80]
    # Displacement, force, horizontal and vertical ground acceleration, axial load.
    if isinstance(load, GroundMotion):
        loads = (None, None, load.acceleration, None, None)
        settings = {"collapse_drift": COLLAPSE_DRIFT}
        case = Case(title, drawn.column, "auto", load.time, *loads, settings)
    else:
        path = drawn.column.height * load
        points = np.arange(float(path.size))
        case = Case(title, drawn.column, "static", points, path, None, None, None, None, {})
    return case, drawn, notes


def column_of(
    given: Mapping[str, Any], faults: Faults, whole: bool = False
) -> tuple[Drawn | None, list[str]]:
    """Make a column, with the notes of the program.

    Parameters
    ----------
    given : mapping
        A column of the state.
    faults : Faults
        What is wrong is added here; then there is no column.
    whole : bool, optional
        Whether a column in double curvature is made with both its halves, also without a footing.
    """
    section = section_of(given, faults)
    frame = group(given, "column")
    ends = "cantilever" if frame["ends"] is None else frame["ends"]
    if not _arguments.is_one_of(ends, ENDS):
        faults.add("column.ends", f"ends = {ends!r} is not known; there are {', '.join(ENDS)}")
        return None, []
    before = len(faults.listed)
    footing = _footing_of(group(given, "footing"), faults)
    with faults.of("column", "axial_load"):
        height = column_length(frame["height"], "height")
        load = _arguments.number(frame["axial_load"], "axial_load")
        if section is None or len(faults.listed) > before:
            return None, []
        part = 1.0 if whole or footing else ENDS[ends]
        with recorded() as told:
            given_ends: Any = {"top": "fixed" if part < ENDS[ends] else "free", "footing": footing}
            column = columns.column(section, height / part, axial_load=load, **given_ends)
        notes = [str(one.message) for one in told if issubclass(one.category, AccuracyWarning)]
        return Drawn(column, section, height / ENDS[ends], part), notes
    return None, []


def _footing_of(given: Mapping[str, Any], faults: Faults) -> Footing | None:
    """Make the footing of a column of the state; None if there is none, or if it is wrong."""
    kind = given["kind"]
    if kind is None or kind == "none":
        return None
    if not _arguments.is_one_of(kind, _GROUND):
        faults.add("footing.kind", f"kind = {kind!r} is not known; there are {', '.join(_GROUND)}")
        return None
    with faults.of("footing", "rotation"):
        names = ("rotation", "sliding", "height")
        values = {name: _arguments.number(given[name], name, above=0.0) for name in names}
        mass = _arguments.number(given["mass"], "mass", above=0.0) if given["mass"] else 0.0
        # A block of concrete with a square plan.
        square = mass / (CONCRETE_DENSITY * values["height"])
        inertia = mass * (square + values["height"] ** 2) / 12.0
        sliding, rotation = Elastic(values["sliding"]), Elastic(values["rotation"])
        return Footing(sliding, rotation, None, mass, inertia, values["height"])
    return None


def _in_motion(drawn: Drawn, given: Mapping[str, Any], faults: Faults) -> Drawn | None:
    """Return the column with the mass that an earthquake moves; by default that of its axial load.

    With mass of their own the halves of a column in double curvature do not move alike, so `drawn`
    has both.
    """
    with faults.of("column", "top_mass"):
        mass = group(given, "column")["top_mass"]
        if mass is None:
            mass = max(drawn.column.axial_load, 0.0) / STANDARD_GRAVITY
        mass = _arguments.number(mass, "top_mass")
        footing = drawn.column.footing
        if footing is not None and not footing.mass:
            raise InputError("mass: a footing that moves needs one", "footing.mass")
        return dataclasses.replace(drawn, column=dataclasses.replace(drawn.column, top_mass=mass))
    return None


def section_of(given: Mapping[str, Any], faults: Faults) -> Section | None:
    """Make the section of a column or beam of the state; None if something is wrong with it."""
    sizes, bars, ties = (group(given, name) for name in ("section", "bars", "ties"))
    shape = sizes["shape"]
    if shape == "beam":
        return _beam_of(given, faults)
    if not _arguments.is_one_of(shape, SHAPES):
        text = f"shape = {shape!r} is not known; there are {', '.join(SHAPES)}"
        faults.add("section.shape", text)
        return None
    kind, names = SHAPES[shape]
    round_ = "circle" in shape
    parts: dict[str, Any] = {}
    before = len(faults.listed)
    with faults.of("concrete", "fc"):
        parts["concrete"] = Concrete(group(given, "concrete")["fc"])
    with faults.of("bars", "number"):
        face = {} if round_ else {"face": bars["face"]}
        steel = Steel(bars["fy"], bars["fu"])
        parts["layout"] = Layout(bars["number"], bars["diameter"], steel, **face)
    with faults.of("ties", "diameter"):
        steel = Steel(ties["fy"], ties["fu"])
        if round_:
            hoops = bool(ties["hoops"])
            parts["spiral"] = Spiral(ties["diameter"], ties["spacing"], steel, hoops=hoops)
        else:
            legs = {n: ties[n] for n in ("legs", "legs_across") if ties[n] is not None}
            parts["ties"] = Ties(ties["diameter"], ties["spacing"], steel, **legs)
    if len(faults.listed) > before:
        return None
    with faults.of("section", "cover"):
        return kind(**{name: sizes[name] for name in (*names, "cover")}, **parts)
    return None


def _beam_of(given: Mapping[str, Any], faults: Faults) -> Section | None:
    """Make the section of a beam: bars above and below, hoops, and a slab if it has a thickness."""
    sizes, bars, ties = (group(given, name) for name in ("section", "bars", "ties"))
    parts: dict[str, Any] = {}
    before = len(faults.listed)
    with faults.of("concrete", "fc"):
        parts["concrete"] = Concrete(group(given, "concrete")["fc"])
    with faults.of("bars", "fy"):
        parts["steel"] = Steel(bars["fy"], bars["fu"])
    with faults.of("ties", "diameter"):
        legs = {} if ties["legs"] is None else {"legs": ties["legs"]}
        hoop = Steel(ties["fy"], ties["fu"])
        parts["ties"] = Ties(ties["diameter"], ties["spacing"], hoop, **legs)
    with faults.of("section", "cover"):
        for name, least in (("width", 0.0), ("depth", 0.0), ("cover", -1.0)):
            parts[name] = _arguments.number(sizes[name], name, above=least, unit="m")
    for name in ("top", "bottom"):
        with faults.of(name, "number"):
            row = group(given, name)
            number = _arguments.integer(row["number"], "number", least=1, most=_MOST_BARS)
            size = _arguments.number(row["diameter"], "diameter", above=0.0, unit="m")
            parts[name] = Bars(number, size)
    if len(faults.listed) > before:
        return None
    with faults.of("section", "cover"):
        if sizes["slab"] is None:
            return RectangularSection(**parts)
        flange = {"flange_width": sizes["flange"], "flange_thickness": sizes["slab"]}
        return TeeSection(**parts, **flange)
    return None


def loading_of(
    given: Mapping[str, Any], records: Mapping[str, GroundMotion], faults: Faults
) -> Array | GroundMotion | None:
    """Make the loading of the state: drifts of a path, or a motion of the ground."""
    kind = given.get("kind")
    with faults.of("loading", "kind"):
        if kind == "amplitudes":
            steps, cycles = given.get("amplitudes", ()), given.get("cycles")
            number = _arguments.integer(cycles, "cycles")
            many = number * len(_arguments.vector(steps, "amplitudes"))
            if many > _MOST_CYCLES:
                raise InputError(
                    f"cycles = {cycles}: {many} cycles are too many here; at most {_MOST_CYCLES}"
                )
            return protocol(steps, cycles)
        if kind == "named":
            name = _arguments.text(given.get("name"), "name")
            reference, largest = (_drift(given, drift) for drift in ("reference", "largest"))
            return protocol(name, reference=reference, largest=largest)
        if kind == "synthetic":
            seed = _arguments.integer(given.get("seed", 1), "seed")
            return synthetic(1, seed, dt=0.01)[0].scaled(_factor(given))
        if kind == "record":
            record = records.get(str(given.get("id")))
            if record is None:
                file = given.get("name")
                again = f"{file} is not open here: choose its file again"
                raise InputError(again if file else "choose a file", "record")
            return record.scaled(_factor(given))
        raise InputError(
            f"kind = {kind!r} is not known; there are amplitudes, named, synthetic, record"
        )
    return None


def _drift(given: Mapping[str, Any], name: str) -> float | None:
    """Return a drift of a protocol of the literature, of a size to look at."""
    if given.get(name) is None:
        return None
    return _arguments.number(given[name], name, least=1e-4, most=1.0, hint=", a drift")


def _factor(given: Mapping[str, Any]) -> float:
    """Return the factor of a motion."""
    return _arguments.number(given.get("scale", 1.0), "scale", above=0, most=1e3)


def group(given: Mapping[str, Any], name: str) -> dict[str, Any]:
    """Return a group of a column; values that are missing are None, which the program refuses."""
    group = given.get(name)
    return defaultdict(lambda: None, group if isinstance(group, Mapping) else {})


# ---- numbers for JSON ---------------------------------------------------------------------------


def numbers(values: Array) -> list[float | None]:
    """Return an array for JSON with six digits; None where it is not finite."""
    return [number(value) for value in np.asarray(values, dtype=np.float64).tolist()]


def number(value: float) -> float | None:
    """Return a number for JSON, as `numbers`."""
    return float(f"{value:.6g}") if math.isfinite(value) else None


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
