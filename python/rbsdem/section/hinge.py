"""The joint at the foot of a column as layers of concrete and steel, from its section.

The layers of concrete act over the length of the hinge; those of steel over that length and the
length of yielding in the footing, so that the bars slip out of it. The column above is elastic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import cast

from rbsdem import _core
from rbsdem.errors import InputError
from rbsdem.model.materials import Steel
from rbsdem.model.shape import Section
from rbsdem.model.springs import ConcreteSpring, Gauge, Layered, Part, SteelSpring, unchecked
from rbsdem.section.parameters import ModelParameters

_STRIPS = 10
# The hinge is lumped at the foot, where it turns the whole length, not that above its middle: the
# column above makes up for it.
_STIFFEST = 2.0
# Longest hinges over the length of the column, and the largest contact.
_LONGEST_STEEL, _LONGEST_CONCRETE = 0.4, 0.8
_LARGEST_CONTACT = 0.9
# Least slope of softening concrete [Pa], and least hardening of bars over their modulus.
_LEAST_SOFTENING, _LEAST_HARDENING = 1e6, 0.0005
# Bars endure at least as much as the widest limit of their elements may be (docs/rules.md).
_LEAST_ENDURANCE = 103.4
_ES = 200e9


@dataclass(frozen=True, slots=True)
class Strip:
    """Concrete at one depth.

    Attributes
    ----------
    y : float
        Of its centroid from mid-depth [m].
    area : float
        [m2].
    """

    y: float
    area: float


@dataclass(frozen=True, slots=True)
class Strips:
    """A section in strips.

    Attributes
    ----------
    core, cover : tuple of Strip
        Concrete within the centre lines of the transverse bars, and around them; bars are not
        deducted.
    confining_stress : float
        Effective, along and across the loading alike, as the transverse bars yield [Pa].
    tie_ratio : float
        Volume of transverse bars over that of the core.
    """

    core: tuple[Strip, ...]
    cover: tuple[Strip, ...]
    confining_stress: float
    tie_ratio: float


def strips_of(
    section: Section, number: int, *, restrained: int | None = None, round_core: bool = False
) -> Strips:
    """Cut a section into strips of equal thickness across the direction of loading.

    The strips are those of the Fortran part (`src/section/cross_section.f90`). The confinement is
    that of Mander, Priestley and Park (1988), ASCE Journal of Structural Engineering 114(8), as the
    layered hinge takes it: the confining stress of the direction of loading alone, and the bars
    that the legs hold spread evenly around the core. `src/section/section_build.f90`, which the
    moment-curvature diagram uses, takes the mean of both directions and the arches between the bars
    of each face. For a spiral the two differ only in the cap on the share of the bars (8 % here,
    50 % there), and single round hoops count as a spiral here. They stay apart because the
    parameters of the hinge are fitted with the form used here.

    Parameters
    ----------
    section : Section
        The section.
    number : int
        Number of strips.
    restrained : int, optional
        Longitudinal bars that are held in a corner of a hoop or by a tie. By default the four
        corners, and four more for each leg beyond two (in proportion for a part of one), up to the
        number of bars.
    round_core : bool, optional
        Whether the ties stand for a spiral around a round core.

    Returns
    -------
    Strips
        In order of y; in each strip core and cover have centroids of their own.
    """
    tie = section.ties.diameter if section.ties else 0.0
    # By how much the core, between the centre lines of the hoops, is smaller than the outline.
    less = [2 * float(section.side_cover or 0.0) + tie, 2 * section.cover + tie]
    round_core = round_core or (section.ties is not None and section.ties.is_round)
    given = {"round_core": round_core, "number": number}
    strips = _core.evaluate("section_strips", section._statement, **given).rows
    if round_core:
        confinement = _spiral(section, section.depth - less[1])
    else:
        confinement = _hoops(section, section.width - less[0], section.depth - less[1], restrained)
    if section.hollow:
        # The inner hoops bow into the void.
        confinement = 0.0, confinement[1]
    # Slivers along the rim of the core are round-off.
    least = 1e-9 * section.gross_area
    return Strips(
        core=tuple(Strip(y, part) for y, part in strips[:, :2].tolist() if part > least),
        cover=tuple(Strip(y, part) for y, part in strips[:, 2:].tolist() if part > least),
        confining_stress=confinement[0],
        tie_ratio=confinement[1],
    )


def _hoops(
    section: Section, core_width: float, core_depth: float, restrained: int | None
) -> tuple[float, float]:
    """Return the confining stress of rectangular hoops [Pa] and their volume ratio.

    Effectiveness by the parabolas between the bars around the perimeter and between the hoops.
    """
    ties, bar = section.ties, section.bar_diameter or 0.0
    if ties is None:
        return 0.0, 0.0
    ratio = ties.legs * math.pi / 4 * ties.diameter**2
    ratio /= ties.spacing * core_width
    area = core_width * core_depth
    # With two legs the four corners alone are held; from three on the bars stand for all of them.
    corners = min(max(3.0 - ties.legs, 0.0), 1.0)
    clear = core_width - bar, core_depth - bar
    parabolas = corners * 2 * (clear[0] ** 2 + clear[1] ** 2) / 6
    bars = max(4, _restrained(section, ties.legs) if restrained is None else restrained)
    clear_one = max(0.0, 2 * (core_width + core_depth) / bars - bar)
    parabolas += (1 - corners) * bars * clear_one**2 / 6
    gap = ties.spacing - ties.diameter
    effective = max(0.0, 1 - parabolas / area) / (1 - _bars(section, area))
    effective *= max(0.0, 1 - gap / (2 * core_width)) * max(0.0, 1 - gap / (2 * core_depth))
    return effective * ratio * ties.steel.fy, 2 * ratio


def _restrained(section: Section, legs: float) -> float:
    """Return how many bars the legs hold: the corners, and four for each leg beyond two.

    A diagonal leg is a part of one, and holds that part of four bars.
    """
    if section.layout is not None:
        number: float = section.layout.number
    elif section.laid_out:
        number = len(section.bars)
    elif not section.bars:
        number = 0
    else:
        # An entry of `bars` may be a row of them.
        number = section.steel_area / (math.pi / 4 * cast(float, section.bar_diameter) ** 2)
    return min(number, 4 + 4 * (legs - 2))


def _spiral(section: Section, diameter: float) -> tuple[float, float]:
    """Return the confining stress of a spiral [Pa] and its volume ratio.

    Effectiveness by the parabola between two turns: (1 - s'/(2 d_s))/(1 - rho_cc).
    """
    ties = section.ties
    if ties is None:
        return 0.0, 0.0
    ratio = math.pi * ties.diameter**2 / (diameter * ties.spacing)
    gap = ties.spacing - ties.diameter
    effective = max(0.0, 1 - gap / (2 * diameter))
    effective /= 1 - _bars(section, math.pi / 4 * diameter**2)
    return 0.5 * effective * ratio * ties.steel.fy, ratio


def _bars(section: Section, core_area: float) -> float:
    """Return the share of longitudinal bars in the core, up to the 8 % that codes allow."""
    return min(0.08, section.steel_area / core_area)


@dataclass(frozen=True)
class HingeJoint:
    """What the layered hinge gives a column.

    Attributes
    ----------
    spring : Layered
        Flexural spring of the foot.
    length : float
        Of the hinge, over which its concrete acts [m]: the column above it begins there.
    flexural_stiffness : float
        E I of the column above [N m2].
    shear_stiffness : float
        G A of the column [N].
    yield_moment : float
        Moment at yield, about [N m].
    yield_work : float
        The same times the rotation of the hinge there [J].
    gauge : Gauge
        What the layers stand for, and over which lengths they deform.
    limits : dict of str to (float, float)
        Least and largest values of the parameters that have them for this column: beyond them they
        would change nothing.
    """

    spring: Layered
    length: float
    flexural_stiffness: float
    shear_stiffness: float
    yield_moment: float
    yield_work: float
    gauge: Gauge
    limits: dict[str, tuple[float, float]]


def hinge_joint(
    section: Section,
    length: float,
    axial_load: float,
    given: ModelParameters,
    *,
    restrained: int | None = None,
    round_core: bool = False,
) -> HingeJoint:
    """Make the layered hinge of a section.

    Parameters
    ----------
    section : Section
        The section at the foot.
    length : float
        From the foot to the lateral load [m].
    axial_load : float
        Compression positive [N].
    given : ModelParameters
        Parameters of the model.
    restrained, round_core
        As for `cut`.

    Returns
    -------
    HingeJoint
        Spring of the foot and stiffness of the column above it.

    Raises
    ------
    InputError
        If the section has no bars, or if concrete at its strength and bars at yield cannot carry
        the axial load.
    """
    if not section.bars:
        raise InputError("the layered model needs a section with longitudinal bars; give bars")
    depth, cylinder, longest = section.depth, section.concrete.fc, _LONGEST_STEEL * length
    strips = strips_of(section, _STRIPS, restrained=restrained, round_core=round_core)
    modulus = section.concrete_law["ec"]
    strength = given.concrete_strength * cylinder * (cylinder / 40e6) ** -given.concrete_size
    peak = 0.002 * given.peak_strain
    relative = given.confinement * strips.confining_stress / cylinder
    gain = -1.254 + 2.254 * math.sqrt(1 + 7.94 * relative) - 2 * relative
    core = gain * strength
    # Beyond what the section carries the exponentials below have no meaning.
    bars = sum(given.steel_strength * steel.fy * area for _, area, steel in section.bars)
    of_core = core * sum(strip.area for strip in strips.core)
    of_cover = strength * sum(strip.area for strip in strips.cover)
    _check(axial_load, bars, bars + of_core + of_cover)
    ratio = axial_load / (cylinder * section.gross_area)

    def by_axial(value: float, exponent: float) -> float:
        return value * math.exp(exponent * (ratio - 0.2))

    core_peak = peak * (1 + 5 * (gain - 1))
    tie_yield = section.ties.steel.fy if section.ties else 0.0
    core_ultimate = 0.004 + 0.14 * strips.tie_ratio * tie_yield / core
    yield_stress = max(steel.fy for _, _, steel in section.bars)
    bond = yield_stress / 1e6 * cast(float, section.bar_diameter)
    one_length = by_axial(1.0, given.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = by_axial(given.hinge_length, given.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = min(steel_length + given.hinge_depth * depth, longest)
    concrete_length = min(given.compression_length * steel_length, _LONGEST_CONCRETE * length)

    # Most strips are alike, and so are most bars: what is the same to 1e-6 mm2 is made once.
    @cache
    def concrete(area: float, stress: float, strain: float, softening: float) -> ConcreteSpring:
        # The spring of a strip with a strength and the strain at it.
        secant = 1.3 * stress / strain
        return unchecked(
            ConcreteSpring,
            k=max(modulus, secant) * area / concrete_length,
            f_peak=stress * area,
            d_peak=strain * concrete_length,
            k_soft=max(softening, _LEAST_SOFTENING) * area / concrete_length,
            contact=min(_LARGEST_CONTACT, given.contact),
            **{name: getattr(given, name) for name in ("plastic", "misfit", "wear", "friction")},
        )

    layers: list[tuple[float, ConcreteSpring | SteelSpring]] = []
    core_slope = 0.2 * core / max(core_ultimate - core_peak, 0.002)
    softening = given.core_softening * core_slope
    for strip in strips.core:
        layers.append((strip.y, concrete(round(strip.area, 12), core, core_peak, softening)))
    cover_slope = 0.8 * strength / 0.004
    softening = given.cover_softening * cover_slope
    for strip in strips.cover:
        layers.append((strip.y, concrete(round(strip.area, 12), strength, peak, softening)))
    slip = given.slip_length * bond
    high = min(axial_load / section.gross_area / 40e6, 1.5)
    buckles = given.buckling > 0 and given.fatigue > 0
    bows = _buckling_strain(strips.tie_ratio * tie_yield, ratio) * (steel_length + slip)

    @cache
    def bar(area: float, steel: Steel) -> SteelSpring:
        fy, fu = (given.steel_strength * stress for stress in (steel.fy, cast(float, steel.fu)))
        stiffness = steel.es * area / (steel_length + slip)
        return unchecked(
            SteelSpring,
            k=stiffness,
            f_y=fy * area,
            k_post=stiffness * max(_LEAST_HARDENING, given.hardening * (fu - fy) / 0.08 / steel.es),
            r0=given.r0 * math.exp(given.r0_stress * (high - 0.15)),
            **{name: getattr(given, name) for name in ("cr1", "cr2", "isotropic_hardening")},
            endurance=max(1 / given.fatigue, _LEAST_ENDURANCE) if given.fatigue > 0 else 0.0,
            d_buckle=bows if buckles else None,
            buckling=given.buckling if buckles else 0.0,
        )

    layers += [(y, bar(area, steel)) for y, area, steel in section.bars]
    centre = section.centroid
    of_bars = sum(steel.es * (area * (y - centre) ** 2) for y, area, steel in section.bars)
    moment = _yield_moment(section, axial_load, ratio, yield_stress)
    lengths = {"core": concrete_length, "cover": concrete_length, "bar": steel_length + slip}
    numbers: dict[Part, int] = {
        "core": len(strips.core), "cover": len(strips.cover), "bar": len(section.bars)
    }  # fmt: skip
    parts = [part for part, number in numbers.items() for _ in range(number)]
    stiffness = min(_STIFFEST, by_axial(given.stiffness, given.stiffness_axial))
    return HingeJoint(
        unchecked(Layered, layers=tuple(layers)),
        concrete_length,
        stiffness * (modulus * section.inertia + of_bars),
        given.shear_stiffness * modulus / 2.4 * section.shear_area,
        moment,
        moment * _yield_curvature(section, yield_stress) * (steel_length + slip),
        Gauge(tuple(parts), tuple(lengths[part] for part in parts)),
        {
            "hinge_length": (0.0, (longest - given.hinge_depth * depth) / one_length),
            "hinge_depth": (-math.inf, (longest - given.hinge_length * one_length) / depth),
            "compression_length": (0.0, _LONGEST_CONCRETE * length / steel_length),
            "stiffness": (0.0, _STIFFEST / by_axial(1.0, given.stiffness_axial)),
            "contact": (0.0, _LARGEST_CONTACT),
            "core_softening": (_LEAST_SOFTENING / core_slope, math.inf),
            "cover_softening": (_LEAST_SOFTENING / cover_slope, math.inf),
            "hardening": (_least_hardening(section, given), math.inf),
            "fatigue": (0.0, 1 / _LEAST_ENDURANCE),
        },
    )


def _buckling_strain(confinement: float, ratio: float) -> float:
    """Return the strain from which on bars buckle when they are compressed again.

    Goodnight, Kowalsky and Nau (2013); `confinement` is rho_s f_yh [Pa], `ratio` that of the load.
    """
    return max(0.01, 0.03 + 700 * confinement / _ES - 0.1 * ratio)


def _yield_moment(section: Section, axial_load: float, ratio: float, stress: float) -> float:
    """Return the moment at yield (AIJ 1999) [N m]."""
    pressed = max(0.0, 0.5 * axial_load * section.depth * (1 - ratio))
    return 0.4 * stress * section.steel_area * section.depth + pressed


def _yield_curvature(section: Section, stress: float) -> float:
    """Return the curvature at yield, about, the mean of both directions [1/m]."""
    depth = 0.5 * (section.effective_depth + section.mirrored.effective_depth)
    return stress / _ES / (0.65 * depth)


def _least_hardening(section: Section, given: ModelParameters) -> float:
    """Return the factor below which no bar hardens less."""
    rise = max((cast(float, steel.fu) - steel.fy) / steel.es for *_, steel in section.bars)
    rise *= given.steel_strength
    return _LEAST_HARDENING * 0.08 / rise if rise > 0 else math.inf


def _check(axial_load: float, bars: float, whole: float) -> None:
    """Refuse what only hardening bars would carry, beyond the bars alone and the whole section."""
    if not -bars < axial_load < whole:
        kind = "compression" if axial_load > 0.0 else "tension"
        raise InputError(
            f"axial_load = {axial_load:g} N is more {kind} than bars at yield and concrete of the "
            f"joint carry; compression is positive: give {-bars:g} to {whole:g} N"
        )
