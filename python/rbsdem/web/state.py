"""What the page sends, as sections, columns and loadings; what is wrong goes beside its field.

A state is what JSON holds: dicts, lists, numbers in SI. Nothing is checked here that the program
checks itself: its `InputError` is caught and put beside the field whose value it names.
"""

from __future__ import annotations

import dataclasses
import json
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import AccuracyWarning, InputError, RbsdemError
from rbsdem.model.circular import CircularSection
from rbsdem.model.column import STANDARD_GRAVITY, Column
from rbsdem.model.ends import double_curvature
from rbsdem.model.hollow import HollowCircularSection, HollowRectangularSection
from rbsdem.model.materials import Concrete, Steel
from rbsdem.model.rectangular import RectangularSection
from rbsdem.model.reinforcement import Layout, Spiral, Ties
from rbsdem.model.section import Section
from rbsdem.motions.motion import GroundMotion
from rbsdem.motions.synthetic import synthetic
from rbsdem.section.ranges import column_length
from rbsdem.solve.protocol import protocol

__all__ = [
    "DEFAULT",
    "ENDS",
    "Fault",
    "Faults",
    "Loading",
    "column_of",
    "in_motion",
    "key_of",
    "loading_of",
]

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

#: What one looks at on a page: cycles of a path, values of a record.
MOST_CYCLES, MOST_VALUES = 200, 60_000

#: Shapes with the names of their sizes.
SIZES = {
    "rectangle": ("width", "depth"),
    "hollow_rectangle": ("width", "depth", "wall"),
    "circle": ("diameter",),
    "hollow_circle": ("diameter", "wall"),
}

#: The fields that a message of each part may name, by the word that it uses.
_FIELDS = {
    "concrete": {"fc": "concrete.fc"},
    "bar_steel": {"fy": "bars.fy", "fu": "bars.fu"},
    "tie_steel": {"fy": "ties.fy", "fu": "ties.fu"},
    "layout": {name: f"bars.{name}" for name in ("number", "diameter", "face")},
    "ties": {name: f"ties.{name}" for name in ("diameter", "spacing", "legs", "legs_across")},
    "section": {name: f"section.{name}" for name in ("width", "depth", "diameter", "wall", "cover")}
    | {"spacing": "ties.spacing", "face": "bars.face", "number": "bars.number"}
    | {"legs": "ties.legs", "legs_across": "ties.legs_across"},
    "column": {"height": "column.height", "axial_load": "column.axial_load"},
    "top_mass": {},
    "loading": {
        name: f"loading.{name}"
        for name in ("amplitudes", "cycles", "reference", "largest", "name", "scale", "seed")
    },
}
#: What a message of a section is about, if it names none of them.
_ABOUT = {"layout": "bars.number", "bar": "bars.diameter", "bars": "bars.number"} | dict.fromkeys(
    ("ties", "spiral"), "ties.diameter"
)
#: The field of a message that names nothing.
_OTHERWISE = {
    "concrete": "concrete.fc",
    "bar_steel": "bars.fy",
    "tie_steel": "ties.fy",
    "layout": "bars.number",
    "ties": "ties.diameter",
    "section": "section.cover",
    "column": "column.axial_load",
    "top_mass": "column.top_mass",
    "loading": "loading.kind",
}


@dataclasses.dataclass(frozen=True)
class Fault:
    """One message and the field that it belongs to, as "bars.number"."""

    field: str
    text: str


class Faults:
    """The messages of one column or loading."""

    def __init__(self) -> None:
        self.found: list[Fault] = []

    @contextmanager
    def of(self, part: str) -> Iterator[None]:
        """Keep the errors of a part of the drawing, each line beside the field that it names."""
        try:
            yield
        except RbsdemError as error:
            for line in str(error).splitlines():
                words = re.findall(r"[a-z_]+", line)
                known = [_FIELDS[part]] + [_ABOUT] * (part == "section")
                fields = (names[word] for names in known for word in words if word in names)
                self.found.append(Fault(next(fields, _OTHERWISE[part]), line))

    def __bool__(self) -> bool:
        return bool(self.found)

    def listed(self) -> list[dict[str, str]]:
        """Return the messages as JSON takes them."""
        return [dataclasses.asdict(fault) for fault in self.found]


@dataclasses.dataclass(frozen=True)
class Drawn:
    """A column of the page that was made.

    Attributes
    ----------
    column : Column
        The column that is computed: along a path the lower half of one in double curvature.
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


@dataclasses.dataclass(frozen=True)
class Loading:
    """A loading: drifts of a path, or a motion of the ground."""

    drifts: Array | None = None
    motion: GroundMotion | None = None


def key_of(value: object) -> str:
    """Return a text that is the same for the same state."""
    return json.dumps(value, sort_keys=True, separators=(",", ":"))


def column_of(given: Mapping[str, Any], faults: Faults) -> tuple[Drawn | None, list[str]]:
    """Make a column; return it with the notes of the program.

    Parameters
    ----------
    given : mapping
        A column of the state.
    faults : Faults
        What is wrong is added here; then there is no column.
    """
    section = section_of(given, faults)
    frame = _group(given, "column")
    ends = frame.get("ends", "cantilever")
    if not isinstance(ends, str) or ends not in ENDS:
        faults.found.append(
            Fault("column.ends", f"ends = {ends!r} is not known; there are {', '.join(ENDS)}")
        )
        return None, []
    notes: list[str] = []
    made = None
    with faults.of("column"):
        height = column_length(frame.get("height"), "height")
        load = _arguments.number(frame.get("axial_load"), "axial_load")
        if section is None:
            return None, []
        with warnings.catch_warnings(record=True) as told:
            warnings.simplefilter("always")
            column: Column = section.column(height / ENDS[ends], axial_load=load)
        notes = [str(one.message) for one in told if issubclass(one.category, AccuracyWarning)]
        made = Drawn(column, section, column.height, ENDS[ends])
    return made, notes


def in_motion(drawn: Drawn, given: Mapping[str, Any], faults: Faults) -> Drawn | None:
    """Return the column with the mass that an earthquake moves; by default that of its axial load.

    A column in double curvature is then computed whole: with mass of their own its halves do not
    move alike.
    """
    frame = _group(given, "column")
    found = None
    with faults.of("top_mass"):
        mass = frame.get("top_mass")
        if mass is None:
            mass = max(drawn.column.axial_load, 0.0) / STANDARD_GRAVITY
        mass = _arguments.number(mass, "top_mass")
        if drawn.factor == 1.0:
            column = dataclasses.replace(drawn.column, top_mass=mass)
        else:
            column = double_curvature(drawn.column, top_mass=mass)
        found = dataclasses.replace(drawn, column=column, factor=1.0)
    return found


def section_of(given: Mapping[str, Any], faults: Faults) -> Section | None:
    """Make the section of a column of the state; None if something is wrong with it."""
    parts: dict[str, Any] = {}
    shape = _group(given, "section").get("shape")
    if not isinstance(shape, str) or shape not in SIZES:
        text = f"shape = {shape!r} is not known; there are {', '.join(SIZES)}"
        faults.found.append(Fault("section.shape", text))
        return None
    round_ = "circle" in shape
    bars, ties = _group(given, "bars"), _group(given, "ties")
    before = len(faults.found)
    with faults.of("concrete"):
        parts["concrete"] = Concrete(_group(given, "concrete").get("fc"))  # type: ignore[arg-type]
    with faults.of("bar_steel"):
        steel = Steel(bars.get("fy"), bars.get("fu"))  # type: ignore[arg-type]
        with faults.of("layout"):
            face = {} if round_ else {"face": bars.get("face")}
            parts["layout"] = Layout(
                bars.get("number"),  # type: ignore[arg-type]
                bars.get("diameter"),  # type: ignore[arg-type]
                steel,
                **face,
            )
    with faults.of("tie_steel"):
        steel = Steel(ties.get("fy"), ties.get("fu"))  # type: ignore[arg-type]
        with faults.of("ties"):
            parts["spiral" if round_ else "ties"] = _hoops(ties, steel, round_)
    if len(faults.found) > before:
        return None
    sizes = _group(given, "section")
    kinds: dict[str, Callable[..., Section]] = {
        "rectangle": RectangularSection,
        "circle": CircularSection,
        "hollow_rectangle": HollowRectangularSection,
        "hollow_circle": HollowCircularSection,
    }
    with faults.of("section"):
        return kinds[shape](
            **{name: sizes.get(name) for name in SIZES[shape]},
            cover=sizes.get("cover"),
            **parts,
        )
    return None


def _hoops(ties: Mapping[str, Any], steel: Steel, round_: bool) -> Ties | Spiral:
    size = {name: ties.get(name) for name in ("diameter", "spacing")}
    if round_:
        return Spiral(**size, steel=steel, hoops=bool(ties.get("hoops", False)))  # type: ignore[arg-type]
    legs = {name: ties[name] for name in ("legs", "legs_across") if ties.get(name) is not None}
    return Ties(**size, steel=steel, **legs)  # type: ignore[arg-type]


def loading_of(
    given: Mapping[str, Any], records: Mapping[str, GroundMotion], faults: Faults
) -> Loading | None:
    """Make the loading of the state.

    Parameters
    ----------
    given : mapping
        The loading of the state.
    records : mapping
        The records that were opened, by their digests.
    faults : Faults
        What is wrong is added here; then there is no loading.
    """
    kind = given.get("kind")
    with faults.of("loading"):
        if kind == "amplitudes":
            steps, cycles = given.get("amplitudes", ()), given.get("cycles")
            many = _arguments.whole(cycles, "cycles") * len(_arguments.vector(steps, "amplitudes"))
            if many > MOST_CYCLES:
                raise InputError(
                    f"cycles = {cycles}: {many} cycles are too many here; at most {MOST_CYCLES}"
                )
            return Loading(protocol(steps, cycles))
        if kind == "named":
            name = given.get("name")
            if not isinstance(name, str):
                raise InputError(f"name = {name!r} must be the name of a protocol")
            return Loading(protocol(name, **_drifts(given)))
        if kind == "synthetic":
            seed = _arguments.whole(given.get("seed", 1), "seed")
            motion = synthetic(1, seed, dt=0.01)[0]
            return Loading(motion=motion.scaled(factor(given)))
        if kind == "record":
            found = records.get(str(given.get("id")))
            if found is None:
                raise InputError(
                    f"name = {given.get('name')!r}: the record is not open here; open its file"
                )
            return Loading(motion=found.scaled(factor(given)))
        raise InputError(
            f"kind = {kind!r} is not known; there are amplitudes, named, synthetic, record"
        )
    return None


def _drifts(given: Mapping[str, Any]) -> dict[str, float | None]:
    """Return reference and largest drift of a protocol of the literature, of a size to look at."""
    found: dict[str, float | None] = {}
    for name in ("reference", "largest"):
        found[name] = None
        if given.get(name) is not None:
            drift = found[name] = _arguments.number(given[name], name)
            if not 1e-4 <= drift <= 1.0:
                raise InputError(f"{name} = {drift:g} must be a drift from 0.0001 to 1")
    return found


def factor(given: Mapping[str, Any]) -> float:
    """Return the factor of a motion."""
    number = _arguments.number(given.get("scale", 1.0), "scale")
    if not (np.isfinite(number) and 0 < number <= 1e3):
        raise InputError(f"scale = {number:g} must be above 0 and at most 1000")
    return float(number)


def _group(given: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """Return a group of a column; what is none has no values, which the program then misses."""
    found = given.get(name)
    return found if isinstance(found, Mapping) else {}
