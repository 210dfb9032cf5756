"""The section of a specimen, as it would be drawn.

What the table does not report is filled in by rules, each named in `DrawnSpecimen.assumed`:

- bars of a face stand at equal distances between the corner bars; if the faces do not add up to the
  number of bars, the areas of the intermediate bars make up for it (bundled bars);
- bars of a round section stand at equal angles, one on the axis of loading; an odd number stands
  half as drawn and half mirrored, so that both directions of loading are equal;
- an octagon is taken as the circle of its depth (5 % less concrete, the same core);
- ultimate stress not reported: 1.5 times the yield stress (the table has none for spirals);
- yield stress not reported: 420 MPa (Grade 60) of longitudinal bars, theirs for transverse bars;
- cover not reported: 0.05 times the depth; across the loading: that along it;
- transverse bars without diameter or spacing: there are none.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from typing import Any, Literal, TypeAlias, get_args, overload

from rbsdem import _arguments
from rbsdem.errors import InputError, warn
from rbsdem.measured.specimens import Specimen
from rbsdem.model.column import Column
from rbsdem.model.materials import Concrete, Spiral, Steel, Ties
from rbsdem.model.shape import CircularSection, RectangularSection, Section
from rbsdem.section.columns import DEFAULT, MODELS, Model
from rbsdem.section.columns import column as column_of
from rbsdem.section.layered import LayeredColumn

ULTIMATE_OVER_YIELD = 1.5
"""Ultimate over yield stress where it is not reported."""

DEFAULT_YIELD_STRESS = 420e6
"""Yield stress of longitudinal bars where it is not reported [Pa]."""

_COVER_SHARE = 0.05


#: A longitudinal bar, or several at the same depth: depth from the middle in the direction of
#: loading [m], area [m2], and yield and ultimate stress [Pa].
_Bar: TypeAlias = tuple[float, float, tuple[float, float]]


@dataclass(frozen=True)
class DrawnSpecimen:
    """The section of a specimen, and what the table says of its bars besides.

    Attributes
    ----------
    section : rbsdem.model.shape.Section
        Laws by the strengths. The table has the legs of hoops in the direction of loading only;
        those across are taken as the same. A square section with a spiral has it as hoops.
    restrained : int
        Longitudinal bars that are held in a corner or by a tie, of those around the perimeter.
    round_core : bool
        Whether a rectangular section has a spiral.
    assumed : tuple of str
        Properties that the table did not report, and the values assumed.
    """

    section: Section
    restrained: int
    round_core: bool
    assumed: tuple[str, ...] = ()


@dataclass
class _Sheet:
    """A specimen and the assumptions made while its section is drawn."""

    specimen: Specimen
    assumed: list[str] = field(default_factory=list)

    def known(self, name: str, otherwise: float, said: str) -> float:
        """Return a property, or what is assumed for it."""
        value = getattr(self.specimen, name)
        if value is not None:
            return float(value)
        self.assumed.append(f"{name}: {said}")
        return otherwise

    def guessed(self, name: str, otherwise: float, said: str) -> float:
        """Return a property that a prediction depends on much, or what is assumed, with a warning.

        Parameters
        ----------
        name, otherwise, said
            As for `known`.
        """
        if getattr(self.specimen, name) is None:
            self.warn(f"{name} is not given; taken as {said}")
        return self.known(name, otherwise, said)

    def warn(self, what: str) -> None:
        """Warn of an assumption."""
        warn(f"{self.specimen.name}: {what}")


def draw(specimen: Specimen) -> DrawnSpecimen:
    """Draw the section of a specimen.

    Parameters
    ----------
    specimen : Specimen
        The test.

    Returns
    -------
    DrawnSpecimen
        The section, and what was assumed.

    Raises
    ------
    InputError
        If the shape is not known, a value is not plausible in SI units, the numbers of bars
        contradict each other, the bars have no diameter or do not fit, or the section is refused.

    Warns
    -----
    AccuracyWarning
        If a yield stress is not reported, and where bars beyond those of the faces are taken as
        bundled.
    """
    _check(specimen)
    _check_bars(specimen)
    sheet = _Sheet(specimen)
    round_core = specimen.section == "square(spiral table)"
    circular = specimen.section in ("circular", "octagonal")
    if not (circular or round_core or specimen.section == "rectangular"):
        raise InputError(
            f"{specimen.name}: section = {specimen.section!r} is not known; there are rectangular, "
            "circular, octagonal and square(spiral table)"
        )
    tie = specimen.transverse_diameter if specimen.transverse_spacing else None
    if tie is None:
        sheet.assumed.append("no transverse bars: no diameter or spacing")
    cover = sheet.known("cover", _COVER_SHARE * specimen.depth, "0.05 of the depth")
    side_cover = specimen.cover_perpendicular or cover
    if circular or round_core:
        # For a spiral the table gives the cover to its centre.
        cover = side_cover = max(cover - (tie or 0.0) / 2, 0.0)
    diameter = specimen.corner_diameter or specimen.intermediate_diameter
    if diameter is None:
        raise InputError(f"{specimen.name}: no diameter of the longitudinal bars; it is needed")
    corner, intermediate = _steels(sheet)
    if circular or round_core:
        bars = _round(specimen, cover + (tie or 0.0), diameter, corner)
    else:
        bars = _rectangle(sheet, cover + (tie or 0.0), diameter, corner, intermediate)
    steels = {stresses: _steel(*stresses) for _, _, stresses in bars}
    given: dict[str, Any] = {
        "concrete": Concrete(specimen.concrete_strength),
        "bars": [(y, area, steels[stresses]) for y, area, stresses in bars],
        "cover": cover,
        "bar_diameter": diameter,
    }
    hoops: dict[str, Any] = {}
    if tie:
        said = "that of longitudinal bars"
        hoop_yield = sheet.guessed("transverse_yield_stress", corner[0], said)
        ultimate = specimen.transverse_ultimate_stress or ULTIMATE_OVER_YIELD * hoop_yield
        hoops = {"diameter": tie, "spacing": specimen.transverse_spacing}
        hoops["steel"] = _steel(hoop_yield, ultimate)
    section: Section
    if circular:
        spiral = Spiral(**hoops) if hoops else None
        section = CircularSection(specimen.depth, **given, spiral=spiral)
    else:
        legs = specimen.shear_legs or 2.0
        ties = Ties(**hoops, legs=legs, legs_across=legs) if hoops else None
        size = specimen.width, specimen.depth
        section = RectangularSection(*size, **given, ties=ties, side_cover=side_cover)
    return DrawnSpecimen(section, _restrained(specimen), round_core, tuple(sheet.assumed))


def _check_bars(specimen: Specimen) -> None:
    """Refuse numbers of bars that contradict each other, as fewer in all than on the faces."""
    whole = specimen.longitudinal_number
    counts = {
        "longitudinal_number": whole,
        "intermediate_perpendicular": specimen.intermediate_perpendicular,
        "intermediate_parallel": specimen.intermediate_parallel,
    }
    for name, count in counts.items():
        if count is not None and (count != round(count) or count < 0):
            raise InputError(
                f"{specimen.name}: {name} = {count:g} bars must be a whole number, 0 or more"
            )
    if specimen.section != "rectangular":
        return
    across, along = specimen.intermediate_perpendicular, specimen.intermediate_parallel
    if across is None or along is None:
        if whole < 4:
            raise InputError(
                f"{specimen.name}: longitudinal_number = {whole} bars, but a rectangular section "
                "has one in each of its four corners; count all of them"
            )
        return
    # More bars than there are places stand in bundles.
    drawn = 4 + 2 * (across + along)
    if whole < drawn or (whole > drawn == 4):
        raise InputError(
            f"{specimen.name}: longitudinal_number = {whole} contradicts the bars of the faces: "
            f"4 in the corners, 2 x {across} (intermediate_perpendicular) and 2 x {along} "
            f"(intermediate_parallel) are {drawn}; correct one of them"
        )


# Plausible ranges in SI units, with a hint for values in other units.
_YIELDS = [f"{bar}_yield_stress" for bar in ("corner", "intermediate", "transverse")]
_RANGES = {
    "length": (0.05, 100.0, "m", "1600 mm is 1.6"),
    "width": (0.02, 20.0, "m", "400 mm is 0.4"),
    "depth": (0.02, 20.0, "m", "400 mm is 0.4"),
    "concrete_strength": (2e6, 300e6, "Pa", "40 MPa is 40e6"),
    "axial_load": (-1e9, 1e9, "N", "700 kN is 700e3"),
    **dict.fromkeys(_YIELDS, (50e6, 3e9, "Pa", "450 MPa is 450e6")),
    "longitudinal_ultimate_stress": (50e6, 4e9, "Pa", "600 MPa is 600e6"),
    "transverse_diameter": (1e-3, 0.1, "m", "10 mm is 0.010"),
    "transverse_spacing": (2e-3, 10.0, "m", "80 mm is 0.080"),
    "longitudinal_number": (1, 10000, "bars", "count all of them"),
    "corner_diameter": (1e-3, 0.1, "m", "16 mm is 0.016"),
    "intermediate_diameter": (1e-3, 0.1, "m", "16 mm is 0.016"),
    "cover": (0.0, 1.0, "m", "20 mm is 0.020"),
    "cover_perpendicular": (0.0, 1.0, "m", "20 mm is 0.020"),
    "shear_legs": (0.0, 1000.0, "bars", "count those that cross the section along the loading"),
}


def _check(specimen: Specimen) -> None:
    """Refuse values outside their plausible ranges, all of them at once."""
    faults = []
    for name, (low, high, unit, remedy) in _RANGES.items():
        value = getattr(specimen, name)
        if value is not None and not low <= value <= high:
            faults.append(
                f"{specimen.name}: {name} = {value:g} {unit} must be between {low:g} and {high:g}; "
                f"{remedy}"
            )
    _arguments.raise_faults(faults)


def _steel(yield_stress: float, ultimate_stress: float) -> Steel:
    """Return a steel; a very strong one has no plateau."""
    hardens = max(Steel.eps_sh, 1.001 * yield_stress / Steel.es)
    return Steel(yield_stress, ultimate_stress, eps_sh=hardens)


def _steels(sheet: _Sheet) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return yield and ultimate stress of corner and intermediate bars."""
    specimen = sheet.specimen
    corner = sheet.guessed("corner_yield_stress", DEFAULT_YIELD_STRESS, "Grade 60, 420 MPa")
    intermediate = specimen.intermediate_yield_stress or corner
    ultimate = specimen.longitudinal_ultimate_stress
    if ultimate is None or ultimate <= corner:
        sheet.assumed.append("longitudinal_ultimate_stress: 1.5 times the yield stress")
        ultimate = ULTIMATE_OVER_YIELD * corner
    # The table has only the ultimate stress of the corner bars.
    return (corner, ultimate), (intermediate, max(ultimate * intermediate / corner, intermediate))


def _rectangle(
    sheet: _Sheet,
    to_bars: float,
    diameter: float,
    corner: tuple[float, float],
    intermediate: tuple[float, float],
) -> list[_Bar]:
    specimen = sheet.specimen
    across, along = specimen.intermediate_perpendicular, specimen.intermediate_parallel
    if across is None or along is None:
        sheet.assumed.append("bars of the faces: as equal as possible")
        along = max(specimen.longitudinal_number - 4, 0) // 4
        across = max(specimen.longitudinal_number - 4 - 2 * along, 0) // 2
    inner = specimen.intermediate_diameter or diameter
    between = 2 * (across + along)
    share = (specimen.longitudinal_number - 4) / between if between else 0.0
    if between and specimen.longitudinal_number != 4 + between:
        said = f"areas of the {between} bars between the corners: times {share:.4g}"
        sheet.assumed.append(said)
        sheet.warn(
            f"longitudinal_number = {specimen.longitudinal_number} with bundled bars; {said}"
        )
    area = max(share, 0.0) * math.pi / 4 * inner**2
    edge = specimen.depth / 2 - to_bars
    y_corner, y_inner = edge - diameter / 2, edge - inner / 2
    _check_room(min(y_corner, y_inner), specimen, to_bars, diameter)
    corner_area = math.pi / 4 * diameter**2
    bars = [(y, 2 * corner_area, corner) for y in (-y_corner, y_corner)]
    if across:
        bars += [(y, across * area, intermediate) for y in (-y_inner, y_inner)]
    step = 2 * y_corner / (along + 1)
    bars += [(-y_corner + (i + 1) * step, 2 * area, intermediate) for i in range(along)]
    return sorted(bars, key=lambda bar: bar[0])


def _round(
    specimen: Specimen, to_bars: float, diameter: float, steel: tuple[float, float]
) -> list[_Bar]:
    radius = specimen.depth / 2 - to_bars - diameter / 2
    _check_room(radius, specimen, to_bars, diameter)
    n = specimen.longitudinal_number
    area = math.pi / 4 * diameter**2
    ys = [radius * math.cos(2 * math.pi * i / n) for i in range(n)]
    if n % 2:
        ys, area = [*ys, *(-y for y in ys)], area / 2
    return sorted((y, area, steel) for y in ys)


def _check_room(left: float, specimen: Specimen, to_bars: float, diameter: float) -> None:
    if left <= 0:
        raise InputError(
            f"{specimen.name}: bars of {diameter * 1e3:g} mm behind a cover of "
            f"{to_bars * 1e3:g} mm do not fit into a depth of {specimen.depth * 1e3:g} mm"
        )


def _restrained(specimen: Specimen) -> int:
    """Return how many bars are held: all in a spiral; else corners and those at inner legs."""
    n = specimen.longitudinal_number
    if specimen.section != "rectangular" or not specimen.shear_legs:
        return n if specimen.section != "rectangular" else min(4, n)
    # Each leg beyond two holds a bar on both faces, along and across.
    return min(n, 4 + 4 * round(specimen.shear_legs - 2))


_OPTIONS = ("n", "model_parameters", "restrained", "round_core", "ends", "footing")

#: The equivalent cantilever of the table, or the form of the test.
Ends = Literal["equivalent", "tested"]


@overload
def column(
    specimen: Specimen, model: Literal["layered"] = "layered", **options: Any
) -> LayeredColumn: ...
@overload
def column(specimen: Specimen, model: Literal["paper"], **options: Any) -> Column: ...
def column(specimen: Specimen, model: Model = DEFAULT, **options: Any) -> Column:
    """Make the column of a specimen.

    Parameters
    ----------
    specimen : Specimen
        The test; only its properties are looked at.
    model : {"layered", "paper"}, optional
        As for `rbsdem.section.column`.
    **options
        As there: ``n``, ``model_parameters``. ``ends="tested"`` makes a double
        curvature specimen (config DC) what it is, twice as long with a hinge at each end: its top
        moves twice as far as the displacement of the test. The default, ``"equivalent"``, is the
        cantilever that all lengths and displacements of the table belong to and the model was
        fitted to: the same within 1e-5 and half the work, until shear softens. Then all further
        slip of the whole specimen is at one end, which its equal halves cannot tell (docs/peer.md).
        ``footing`` is what the column stands on.

    Returns
    -------
    Column
        With second-order effects of the axial load at the height where it acts.

    Raises
    ------
    InputError
        If the model is not known, if the section cannot be analysed, or if the table does not say
        enough of the ends of the test.
    """
    model = _arguments.choice(model, "model", MODELS)
    checked_specimen(specimen)
    check_options(options)
    tested = _tested(specimen, options.pop("ends", "equivalent"), options.get("footing"))
    drawn = draw(specimen)
    if model == "layered":
        options = {"restrained": drawn.restrained, "round_core": drawn.round_core} | options
    halves = 2 if tested and specimen.config == "DC" else 1
    options |= {"model": model, "axial_load": specimen.axial_load, "mass": halves * specimen.mass}
    options["axial_height"] = None if halves == 2 else specimen.axial_height
    options["top"] = "fixed" if halves == 2 else "free"
    made: Column = column_of(drawn.section, halves * specimen.length, **options)
    return made


def _tested(specimen: Specimen, ends: str, footing: object) -> bool:
    """Return whether the ends are to be those of the test; refuse what the table does not give."""
    if ends not in get_args(Ends):
        raise InputError(f"ends = {ends!r} is not known; it is one of {', '.join(get_args(Ends))}")
    if ends == "equivalent":
        return False
    if specimen.config == "CFB" and footing is None:
        raise InputError(
            f"{specimen.name}: the stiffness of its flexible base is not in the table; give "
            "footing=, or take ends='equivalent'"
        )
    if specimen.config == "DC" and specimen.axial_height != specimen.length:
        raise InputError(
            f"{specimen.name}: its axial load acts at {specimen.axial_height:g} m, not at the "
            f"length of {specimen.length:g} m; take ends='equivalent', which has that lever"
        )
    return True


def checked_specimen(specimen: object) -> Specimen:
    """Return a specimen, or raise `InputError` for anything else."""
    remedy = "rbsdem.peer.read_specimens reads them from a table"
    if isinstance(specimen, Section):
        maker = "rbsdem.section.column(section, height, axial_load=...)"
        remedy = f"of a section, {maker} makes a column"
    return _arguments.instance(specimen, "specimen", Specimen, remedy)


def check_options(options: Mapping[str, object]) -> None:
    """Raise `InputError` for options that `rbsdem.section.column` does not have."""
    for name in options:
        if name not in _OPTIONS:
            near = get_close_matches(name, _OPTIONS, 1)
            hint = f"; did you mean {near[0]}?" if near else ""
            known = ", ".join(_OPTIONS)
            raise InputError(f"the option {name} is not known; there are {known}{hint}")
