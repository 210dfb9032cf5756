"""The joint at the foot of a column as layers of concrete and steel, from its section.

The layers of concrete act over the length of the hinge; those of steel over that length and the
length of yielding in the footing, so that the bars slip out of it. The column above is elastic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from rbsdem.errors import InputError
from rbsdem.model.materials import Steel
from rbsdem.model.springs import ConcreteSpring, Layered, SteelSpring, unchecked
from rbsdem.model.strains import Gauge

if TYPE_CHECKING:
    from rbsdem.model.section import Section
    from rbsdem.section.parameters import HingeParameters

__all__ = ["HingeJoint", "hinge_joint"]

_STRIPS = 14
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
    confinement : float
        Confining stress over the cylinder strength.
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
    confinement: float
    gauge: Gauge
    limits: dict[str, tuple[float, float]]


def hinge_joint(
    section: Section,
    length: float,
    axial_load: float,
    hinge: HingeParameters,
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
    hinge : HingeParameters
        Parameters of the model.
    restrained, round_core
        As for `rbsdem.RectangularSection.cut`.

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
    depth, cylinder = section.depth, section.concrete.fc
    strips = section.cut(_STRIPS, restrained=restrained, round_core=round_core)
    modulus = section.concrete_law["ec"]
    strength = hinge.concrete_strength * cylinder * (cylinder / 40e6) ** -hinge.concrete_size
    peak = 0.002 * hinge.peak_strain
    relative = hinge.confinement * strips.confining_stress / cylinder
    gain = -1.254 + 2.254 * math.sqrt(1 + 7.94 * relative) - 2 * relative
    core = gain * strength
    # Beyond what the section carries the exponentials below have no meaning.
    bars = sum(hinge.steel_strength * steel.fy * area for _, area, steel in section.bars)
    of_core = core * sum(strip.area for strip in strips.core)
    of_cover = strength * sum(strip.area for strip in strips.cover)
    _check(axial_load, bars, bars + of_core + of_cover)
    ratio = axial_load / (cylinder * strips.area)

    def by_axial(value: float, exponent: float) -> float:
        return value * math.exp(exponent * (ratio - 0.2))

    core_peak = peak * (1 + 5 * (gain - 1))
    tie_yield = section.ties.steel.fy if section.ties else 0.0
    core_ultimate = 0.004 + 0.14 * strips.tie_ratio * tie_yield / core
    yield_stress = max(steel.fy for _, _, steel in section.bars)
    bond = yield_stress / 1e6 * section.bar_diameter
    one_length = by_axial(1.0, hinge.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = by_axial(hinge.hinge_length, hinge.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = min(steel_length + hinge.hinge_depth * depth, _LONGEST_STEEL * length)
    concrete_length = min(hinge.compression_length * steel_length, _LONGEST_CONCRETE * length)
    contact = min(_LARGEST_CONTACT, by_axial(hinge.contact, hinge.contact_axial))

    # Most strips are alike, and so are most bars: what is the same to 1e-6 mm2 is made once.
    @cache
    def concrete(
        area: float, stress: float, strain: float, softening: float, rest: float
    ) -> ConcreteSpring:
        secant = 1.3 * stress / strain
        return unchecked(
            ConcreteSpring,
            k=max(modulus, secant) * area / concrete_length,
            f_peak=stress * area,
            d_peak=strain * concrete_length,
            k_soft=max(softening, _LEAST_SOFTENING) * area / concrete_length,
            f_res=rest * area,
            plastic=hinge.plastic,
            contact=contact,
            misfit=hinge.misfit,
            wear=hinge.wear,
            friction=hinge.friction,
            seating=hinge.seating,
        )

    layers: list[tuple[float, ConcreteSpring | SteelSpring]] = []
    core_slope = 0.2 * core / max(core_ultimate - core_peak, 0.002)
    softening = hinge.core_softening * core_slope
    for strip in strips.core:
        spring = concrete(round(strip.area, 12), core, core_peak, softening, hinge.residual * core)
        layers.append((strip.y, spring))
    cover_slope = 0.8 * strength / 0.004
    softening = hinge.cover_softening * cover_slope
    for strip in strips.cover:
        layers.append((strip.y, concrete(round(strip.area, 12), strength, peak, softening, 0.0)))
    slip = by_axial(hinge.slip_length, hinge.slip_axial) * bond
    stress = min(axial_load / strips.area / 40e6, 1.5)
    anchored = _bond_demand(bond, cylinder, length)
    by_stress = math.exp(hinge.r0_stress * (stress - 0.15)) * anchored**-hinge.r0_bond
    buckles = hinge.buckling > 0 and hinge.fatigue > 0
    bows = _buckling_strain(strips.tie_ratio * tie_yield, ratio) * hinge.buckling_strain
    bows *= steel_length + slip

    @cache
    def bar(area: float, steel: Steel) -> SteelSpring:
        fy, fu = hinge.steel_strength * steel.fy, hinge.steel_strength * steel.fu
        stiffness = steel.es * area / (steel_length + slip)
        return unchecked(
            SteelSpring,
            k=stiffness,
            f_y=fy * area,
            k_post=stiffness * max(_LEAST_HARDENING, hinge.hardening * (fu - fy) / 0.08 / steel.es),
            r0=by_axial(hinge.r0, hinge.r0_axial) * by_stress,
            cr1=hinge.cr1,
            cr2=hinge.cr2,
            isotropic_hardening=hinge.isotropic_hardening * anchored**hinge.isotropic_bond,
            endurance=max(1 / hinge.fatigue, _LEAST_ENDURANCE) if hinge.fatigue > 0 else 0.0,
            d_buckle=bows if buckles else None,
            buckling=hinge.buckling if buckles else 0.0,
        )

    layers += [(y, bar(area, steel)) for y, area, steel in section.bars]
    of_bars = sum(steel.es * (area * y**2) for y, area, steel in section.bars)
    moment = _yield_moment(section, axial_load, ratio, yield_stress)
    return HingeJoint(
        unchecked(Layered, layers=tuple(layers)),
        concrete_length,
        min(_STIFFEST, by_axial(hinge.stiffness, hinge.stiffness_axial))
        * (modulus * strips.inertia + of_bars),
        hinge.shear_stiffness * modulus / 2.4 * strips.shear_area,
        moment,
        moment * _yield_curvature(section, yield_stress) * (steel_length + slip),
        strips.confining_stress / cylinder,
        Gauge(
            ("core",) * len(strips.core)
            + ("cover",) * len(strips.cover)
            + ("bar",) * len(section.bars),
            (concrete_length,) * (len(strips.core) + len(strips.cover))
            + (steel_length + slip,) * len(section.bars),
        ),
        {
            "hinge_length": (
                0.0,
                (_LONGEST_STEEL * length - hinge.hinge_depth * depth) / one_length,
            ),
            "hinge_depth": (
                -math.inf,
                (_LONGEST_STEEL * length - hinge.hinge_length * one_length) / depth,
            ),
            "compression_length": (0.0, _LONGEST_CONCRETE * length / steel_length),
            "stiffness": (0.0, _STIFFEST / by_axial(1.0, hinge.stiffness_axial)),
            "contact": (0.0, _LARGEST_CONTACT / by_axial(1.0, hinge.contact_axial)),
            "core_softening": (_LEAST_SOFTENING / core_slope, math.inf),
            "cover_softening": (_LEAST_SOFTENING / cover_slope, math.inf),
            "hardening": (_least_hardening(section, hinge), math.inf),
            "fatigue": (0.0, 1 / _LEAST_ENDURANCE),
        },
    )


def _buckling_strain(confinement: float, ratio: float) -> float:
    """Return the strain from which on bars buckle when they are compressed again.

    Goodnight, Kowalsky and Nau (2013); `confinement` is rho_s f_yh [Pa], `ratio` that of the load.
    """
    return max(0.01, 0.03 + 700 * confinement / _ES - 0.1 * ratio)


def _bond_demand(force: float, cylinder: float, length: float) -> float:
    """Return the length that anchors a bar over that of the column, over 0.12 as usual in tests.

    `force` is f_y d_b [MPa m]; the bond stress is 2.5 sqrt(f'c) (MPa).
    """
    return max(force / (10 * math.sqrt(cylinder / 1e6) * length * 0.12), 1e-3)


def _yield_moment(section: Section, axial_load: float, ratio: float, stress: float) -> float:
    """Return the moment at yield (AIJ 1999) [N m]."""
    pressed = max(0.0, 0.5 * axial_load * section.depth * (1 - ratio))
    return 0.4 * stress * section.steel_area * section.depth + pressed


def _yield_curvature(section: Section, stress: float) -> float:
    """Return the curvature at yield, about, the mean of both directions [1/m]."""
    depth = 0.5 * (section.effective_depth + section.turned.effective_depth)
    return stress / _ES / (0.65 * depth)


def _least_hardening(section: Section, hinge: HingeParameters) -> float:
    """Return the factor below which no bar hardens less."""
    rises = [hinge.steel_strength * (steel.fu - steel.fy) / steel.es for *_, steel in section.bars]
    return _LEAST_HARDENING * 0.08 / max(rises) if max(rises) > 0 else math.inf


def _check(axial_load: float, bars: float, whole: float) -> None:
    """Refuse what only hardening bars would carry, beyond the bars alone and the whole section."""
    if not -bars < axial_load < whole:
        kind = "compression" if axial_load > 0.0 else "tension"
        raise InputError(
            f"axial_load = {axial_load:g} N is more {kind} than bars at yield and concrete of the "
            f"joint carry; compression is positive: give {-bars:g} to {whole:g} N"
        )
