"""The joint at the foot of a column as layers of concrete and steel, from its section.

The layers of concrete act over the length of the hinge; those of steel over that length and the
length of yielding in the footing, so that the bars slip out of it. The column above is elastic.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, cast

from rbsdem import _core
from rbsdem.errors import InputError
from rbsdem.model.materials import Steel
from rbsdem.model.shape import Section
from rbsdem.model.springs import (
    ConcreteSpring,
    Gauge,
    Layered,
    Part,
    Spring,
    SteelSpring,
    unchecked,
)
from rbsdem.section.parameters import ModelParameters

_STRIPS = 10
# The hinge is lumped at the foot, where it turns the whole length, not that above its middle: the
# column above makes up for it.
_STIFFEST = 2.0
# Longest hinges over the length of the column, and the largest contact.
_LONGEST_STEEL, _LONGEST_CONCRETE = 0.4, 0.8
_LARGEST_CONTACT = 0.9
# Axial load ratio of a wall from which on its bars grow stronger with their range of strain as
# those of columns do; those of members without axial load do not (`rbsdem.section.member`).
_GROWS_FROM = 0.05
# Least slope of softening concrete [Pa], and least hardening of bars over their modulus.
_LEAST_SOFTENING, _LEAST_HARDENING = 1e6, 0.0005
# Bars endure at least as much as the widest limit of their elements may be (docs/rules.md).
_LEAST_ENDURANCE = 103.4
# Modulus of steel in the relations for buckling and yield [Pa].
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
    confining_stress : tuple of float
        Effective, as the transverse bars yield, of the core at y < 0 and at y > 0 [Pa].
    hoop_pressure : tuple of float
        Volume of transverse bars over that of the core, times their yield stress, likewise [Pa].
    """

    core: tuple[Strip, ...]
    cover: tuple[Strip, ...]
    confining_stress: tuple[float, float]
    hoop_pressure: tuple[float, float]


@lru_cache(maxsize=1024)
def strips_of(
    section: Section, number: int, *, restrained: int | None = None, round_core: bool = False
) -> Strips:
    """Cut a section into strips of equal thickness across the direction of loading.

    The strips, and the confinement of Mander, Priestley and Park (1988) in the form that the layers
    take, are those of the Fortran part (`src/section/cross_section.f90`, `confinement.f90`).

    Parameters
    ----------
    section : Section
        The section.
    number : int
        Number of strips; the boundary elements of a wall cut them further.
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
    held = _restrained(section) if restrained is None else restrained
    given: Any = {"round_core": round_core, "number": number, "held": float(held)}
    answer = _core.evaluate("section_strips", section._statement, **given)
    # A row is y and the area of the core of a strip, then y and the area of its cover. Slivers
    # along the rim of the core are round-off.
    least = 1e-9 * section.gross_area
    strips, (left, right, *pressures) = answer.rows, answer.values.tolist()
    return Strips(
        core=tuple(Strip(y, part) for y, part in strips[:, :2].tolist() if part > least),
        cover=tuple(Strip(y, part) for y, part in strips[:, 2:].tolist() if part > least),
        confining_stress=(left, right),
        hoop_pressure=(pressures[0], pressures[1]),
    )


def _restrained(section: Section) -> float:
    """Return how many bars the legs hold: the corners, and four for each leg beyond two.

    A diagonal leg is a part of one, and holds that part of four bars.
    """
    if section.ties is None:
        return 4
    if section.layout is not None:
        number: float = section.layout.number
    elif section.laid_out:
        number = len(section.bars)
    elif not section.bars:
        number = 0
    else:
        # An entry of `bars` may be a row of them.
        number = section.steel_area / (math.pi / 4 * cast(float, section.bar_diameter) ** 2)
    return max(4, min(number, 4 + 4 * (section.ties.legs - 2)))


@dataclass(frozen=True)
class HingeJoint:
    """The layered hinge of a column, and the stiffness of the column above it.

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
    parts : dict of str to (int, float)
        Number of the layers of each part, in their order, and the length over which they deform
        [m].
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
    parts: dict[Part, tuple[int, float]]
    limits: dict[str, tuple[float, float]]

    @cached_property
    def gauge(self) -> Gauge:
        """Part that each layer stands for, and the length over which it deforms."""
        parts = [part for part, (number, _) in self.parts.items() for _ in range(number)]
        return Gauge(tuple(parts), tuple(self.parts[part][1] for part in parts))


def hinge_joint(
    section: Section,
    length: float,
    axial_load: float,
    model: ModelParameters,
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
    model : ModelParameters
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
    strength = model.concrete_strength * cylinder * (cylinder / 40e6) ** -model.concrete_size
    peak = 0.002 * model.peak_strain
    gains = [_gain(model.confinement * stress / cylinder) for stress in strips.confining_stress]
    # Beyond what the section carries the exponentials below have no meaning.
    bars = sum(model.steel_strength * steel.fy * area for _, area, steel in section.bars)
    of_core = sum(gains[strip.y > 0] * strength * strip.area for strip in strips.core)
    of_cover = strength * sum(strip.area for strip in strips.cover)
    _check(axial_load, bars, bars + of_core + of_cover)
    ratio = axial_load / (cylinder * section.gross_area)

    def by_axial(value: float, exponent: float) -> float:
        """Return a parameter, which is stated for an axial load ratio of 0.2, at this ratio."""
        return value * math.exp(exponent * (ratio - 0.2))

    bond = section.yield_stress / 1e6 * cast(float, section.bar_diameter)
    one_length = by_axial(1.0, model.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = by_axial(model.hinge_length, model.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = min(steel_length + model.hinge_depth * depth, longest)
    concrete_length = min(model.compression_length * steel_length, _LONGEST_CONCRETE * length)

    def concrete(area: float, law: tuple[float, float, float]) -> ConcreteSpring:
        """Return the spring of a strip by strength [Pa], strain there, and slope beyond [Pa]."""
        stress, strain, softening = law
        secant = 1.3 * stress / strain
        return unchecked(
            ConcreteSpring,
            k=max(modulus, secant) * area / concrete_length,
            f_peak=stress * area,
            d_peak=strain * concrete_length,
            k_soft=max(softening, _LEAST_SOFTENING) * area / concrete_length,
            plastic=model.plastic,
            contact=min(_LARGEST_CONTACT, model.contact),
            misfit=model.misfit,
            wear=model.wear,
            friction=model.friction,
        )

    core_slopes = []
    for gain, pressure in zip(gains, strips.hoop_pressure, strict=True):
        ultimate = 0.004 + 0.14 * pressure / (gain * strength)
        core_slopes.append(
            0.2 * gain * strength / max(ultimate - peak * (1 + 5 * (gain - 1)), 0.002)
        )
    confined = [
        (gain * strength, peak * (1 + 5 * (gain - 1)), model.core_softening * slope)
        for gain, slope in zip(gains, core_slopes, strict=True)
    ]
    cover_slope = 0.8 * strength / 0.004
    plain = strength, peak, model.cover_softening * cover_slope
    # Most strips are alike, and so are most bars: what is the same to 1e-6 mm2 is made once.
    made: dict[Any, Spring] = {}
    layers = [
        (strip.y, _once(made, concrete, round(strip.area, 12), confined[strip.y > 0]))
        for strip in strips.core
    ]
    layers += [
        (strip.y, _once(made, concrete, round(strip.area, 12), plain)) for strip in strips.cover
    ]
    high = min(axial_load / section.gross_area / 40e6, 1.5)
    slip, growth = model.slip_length * bond, model.isotropic_hardening * _growing(section, ratio)
    buckles = model.buckling > 0 and model.fatigue > 0

    def bar(area: float, steel: Steel, pressure: float) -> SteelSpring:
        """Return the spring of a bar; `pressure` is rho_s f_yh of the hoops that hold it [Pa]."""
        fy, fu, hardens = _strength_of(section, steel, model)
        stiffness = steel.es * area / (steel_length + slip)
        return unchecked(
            SteelSpring,
            k=stiffness,
            f_y=fy * area,
            k_post=stiffness * max(_LEAST_HARDENING, model.hardening * (fu - fy) / 0.08 / steel.es),
            r0=model.r0 * math.exp(model.r0_stress * (high - 0.15)),
            cr1=model.cr1,
            cr2=model.cr2,
            isotropic_hardening=growth if hardens else 0.0,
            endurance=max(1 / model.fatigue, _LEAST_ENDURANCE) if model.fatigue > 0 else 0.0,
            d_buckle=_buckling_strain(pressure, ratio) * (steel_length + slip) if buckles else None,
            buckling=model.buckling if buckles else 0.0,
        )

    for y, area, steel in section.bars:
        hooped = abs(y) >= 0.5 * depth - section.hooped[y > 0]
        pressure = strips.hoop_pressure[y > 0] if hooped else 0.0
        layers.append((y, _once(made, bar, area, steel, pressure)))
    centre = section.centroid
    of_bars = sum(steel.es * (area * (y - centre) ** 2) for y, area, steel in section.bars)
    moment = _yield_moment(section, axial_load, ratio)
    parts: dict[Part, tuple[int, float]] = {
        "core": (len(strips.core), concrete_length),
        "cover": (len(strips.cover), concrete_length),
        "bar": (len(section.bars), steel_length + slip),
    }
    stiffness = min(_STIFFEST, by_axial(model.stiffness, model.stiffness_axial))
    walls = model.wall_stiffness if section.shape == "wall" else 1.0
    return HingeJoint(
        unchecked(Layered, layers=tuple(layers)),
        concrete_length,
        walls * stiffness * (modulus * section.inertia + of_bars),
        walls * model.shear_stiffness * modulus / 2.4 * section.shear_area,
        moment,
        moment * _yield_curvature(section) * (steel_length + slip),
        parts,
        {
            "hinge_length": (0.0, (longest - model.hinge_depth * depth) / one_length),
            "hinge_depth": (-math.inf, (longest - model.hinge_length * one_length) / depth),
            "compression_length": (0.0, _LONGEST_CONCRETE * length / steel_length),
            "stiffness": (0.0, _STIFFEST / by_axial(1.0, model.stiffness_axial)),
            "contact": (0.0, _LARGEST_CONTACT),
            "core_softening": (_LEAST_SOFTENING / max(core_slopes), math.inf),
            "cover_softening": (_LEAST_SOFTENING / cover_slope, math.inf),
            "hardening": (_least_hardening(section, model), math.inf),
            "fatigue": (0.0, 1 / _LEAST_ENDURANCE),
        },
    )


def _once(made: dict[Any, Spring], make: Callable[..., Spring], *values: Any) -> Spring:
    """Return the spring of some values, which is made once."""
    if values not in made:
        made[values] = make(*values)
    return made[values]


def _gain(stress: float) -> float:
    """Return the strength of confined concrete over that of plain concrete (Mander 1988).

    `stress` is the confining stress over that strength.
    """
    return -1.254 + 2.254 * math.sqrt(1 + 7.94 * stress) - 2 * stress


def _buckling_strain(confinement: float, ratio: float) -> float:
    """Return the strain from which on bars buckle when they are compressed again.

    Goodnight, Kowalsky and Nau (2013); `confinement` is rho_s f_yh [Pa], `ratio` that of the load.
    """
    return max(0.01, 0.03 + 700 * confinement / _ES - 0.1 * ratio)


def _strength_of(
    section: Section, steel: Steel, model: ModelParameters
) -> tuple[float, float, bool]:
    """Return f_y and f_u of bars [Pa], and whether they harden: those in a short lap do not."""
    fy, fu = (model.steel_strength * stress for stress in (steel.fy, cast(float, steel.fu)))
    lapped = section.lapped(steel)
    return (fy, fu, True) if lapped == 1.0 else (lapped * fy, lapped * fy, False)


def _growing(section: Section, ratio: float) -> float:
    """Return the share of their growth by their range of strain that bars have.

    Those of a wall under little load are stretched much farther than those of the columns that it
    was fitted to.
    """
    return min(max(ratio / _GROWS_FROM, 0.0), 1.0) if section.shape == "wall" else 1.0


def _yield_moment(section: Section, axial_load: float, ratio: float) -> float:
    """Return the moment at yield (AIJ 1999) [N m]."""
    pressed = max(0.0, 0.5 * axial_load * section.depth * (1 - ratio))
    return 0.4 * section.yield_stress * section.steel_area * section.depth + pressed


def _yield_curvature(section: Section) -> float:
    """Return the curvature at yield, about, the mean of both directions [1/m]."""
    depth = 0.5 * (section.effective_depth + section.mirrored.effective_depth)
    return section.yield_stress / _ES / (0.65 * depth)


def _least_hardening(section: Section, model: ModelParameters) -> float:
    """Return the factor below which no bar hardens less."""
    rise = max((cast(float, steel.fu) - steel.fy) / steel.es for *_, steel in section.bars)
    rise *= model.steel_strength
    return _LEAST_HARDENING * 0.08 / rise if rise > 0 else math.inf


def _check(axial_load: float, bars: float, whole: float) -> None:
    """Refuse what only hardening bars would carry, beyond the bars alone and the whole section."""
    if not -bars < axial_load < whole:
        kind = "compression" if axial_load > 0.0 else "tension"
        raise InputError(
            f"axial_load = {axial_load:g} N is more {kind} than bars at yield and concrete of the "
            f"joint carry; compression is positive: give {-bars:g} to {whole:g} N"
        )
