"""The joint at the foot of a column as layers of concrete and steel, from its drawing.

The layers of concrete act over the length of the hinge; those of steel over that length and the
length of yielding in the footing, so that the bars slip out of it. The column above is elastic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from rbsdem.errors import InputError
from rbsdem.peer.strips import cut
from rbsdem.springs import ConcreteSpring, Layered, SteelSpring

if TYPE_CHECKING:
    from rbsdem.peer.drawing import Drawing
    from rbsdem.section import Section

__all__ = ["Hinge", "HingeJoint", "hinge_joint"]

_ES = 200e9
_STRIPS = 14
# The hinge is lumped at the foot, where it turns the whole length, not that above its middle: the
# column above makes up for it.
_STIFFEST = 2.0


@dataclass(frozen=True)
class Hinge:
    """Numbers of the layered hinge that are the same for all columns.

    The defaults are fitted to the rectangular flexural tests of the PEER Structural Performance
    Database (``studies/fit_hinge.py``); the forms are published relations. With n the axial load
    ratio, `..._axial` is the exponent e of a factor exp(e (n - 0.2)).

    Attributes
    ----------
    steel_strength : float
        Yield and ultimate stress over the measured ones.
    hardening : float
        Factor of the slope from the yield stress to the ultimate stress at 8 % strain.
    roundness, roundness_axial : float
        R0 of Menegotto and Pinto (1973).
    roundness_loss, roundness_reach : float
        Their cR1 and cR2.
    growth : float
        Share by which the strength of a bar has grown when its strains reached both yield strains
        (Filippou, Popov and Bertero 1983).
    fatigue : float
        1 over the plastic work, over f_y d_y, that halves the strength of a bar.
    concrete_strength, concrete_size : float
        In-place over cylinder strength at 40 MPa; exponent of its fall with the strength.
    peak_strain : float
        Strain at the strength of unconfined concrete over 0.002.
    confinement : float
        Factor of the confining stress of Mander, Priestley and Park (1988).
    core_fall, cover_fall : float
        Factors of the slopes behind the peak: to 80 % at Mander's ultimate strain; to 20 % over
        0.004.
    residual : float
        Share of the core's strength that is left.
    hinge_length, hinge_axial, hinge_depth : float
        Factor of 0.08 L + 0.022 f_y d_b (Paulay and Priestley 1992), share of the depth added.
    compression_length : float
        Hinge length of the concrete over that of the steel.
    slip_length, slip_axial : float
        Length of yielding in the footing over f_y d_b [1/MPa].
    stiffness, stiffness_axial : float
        Flexural stiffness of the column above over that of the uncracked section, up to 2: above 1
        it makes up for the hinge, which is lumped at the foot.
    shear_stiffness : float
        Shear stiffness of the column over the uncracked one.
    plastic, misfit, contact, contact_axial, wear : float
        Of the concrete layers, see `rbsdem.ConcreteSpring`.
    """

    steel_strength: float = 1.11
    hardening: float = 1.01
    roundness: float = 11.8
    roundness_axial: float = 1.01
    roundness_loss: float = 0.902
    roundness_reach: float = 0.326
    growth: float = 0.0839
    fatigue: float = 0.00426
    concrete_strength: float = 0.947
    concrete_size: float = 0.0984
    peak_strain: float = 1.05
    confinement: float = 0.81
    core_fall: float = 1.03
    cover_fall: float = 1.28
    residual: float = 0.297
    hinge_length: float = 0.976
    hinge_axial: float = -0.535
    hinge_depth: float = 0.078
    compression_length: float = 1.77
    slip_length: float = 0.0133
    slip_axial: float = -1.35
    stiffness: float = 0.981
    stiffness_axial: float = 1.37
    shear_stiffness: float = 0.698
    plastic: float = 1.83
    misfit: float = 0.31
    contact: float = 0.287
    contact_axial: float = -0.573
    wear: float = 0.0476

    def with_numbers(self, **numbers: float) -> Hinge:
        """Return the hinge with other numbers."""
        return replace(self, **numbers)


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
    """

    spring: Layered
    length: float
    flexural_stiffness: float
    shear_stiffness: float


def hinge_joint(
    drawing: Drawing, section: Section, length: float, axial_load: float, hinge: Hinge
) -> HingeJoint:
    """Make the layered hinge of a section.

    Parameters
    ----------
    drawing : Drawing
        The section as drawn.
    section : rbsdem.section.Section
        That of the drawing, for analysis.
    length : float
        From the foot to the lateral load [m].
    axial_load : float
        Compression positive [N].
    hinge : Hinge
        Numbers of the model.

    Returns
    -------
    HingeJoint
        Spring of the foot and stiffness of the column above it.

    Raises
    ------
    InputError
        If concrete at its strength and bars at yield cannot carry the axial load.
    """
    depth, cylinder = drawing.depth, drawing.concrete_strength
    strips = cut(drawing, _STRIPS)
    ratio = axial_load / (cylinder * strips.area)

    def by_axial(value: float, exponent: float) -> float:
        return value * math.exp(exponent * (ratio - 0.2))

    modulus = section.concrete_law["ec"]
    strength = hinge.concrete_strength * cylinder * (cylinder / 40e6) ** -hinge.concrete_size
    peak = 0.002 * hinge.peak_strain
    relative = hinge.confinement * strips.confining_stress / cylinder
    gain = -1.254 + 2.254 * math.sqrt(1 + 7.94 * relative) - 2 * relative
    core = gain * strength
    core_peak = peak * (1 + 5 * (gain - 1))
    core_ultimate = 0.004 + 0.14 * strips.tie_ratio * drawing.tie_yield_stress / core
    yield_stress = max(bar.yield_stress for bar in drawing.bars)
    bond = yield_stress / 1e6 * drawing.bar_diameter
    steel_length = by_axial(hinge.hinge_length, hinge.hinge_axial) * (0.08 * length + 0.022 * bond)
    steel_length = min(steel_length + hinge.hinge_depth * depth, 0.4 * length)
    concrete_length = min(hinge.compression_length * steel_length, 0.8 * length)
    contact = min(0.9, by_axial(hinge.contact, hinge.contact_axial))

    # Most strips are alike, and so are most bars: what is the same to 1e-6 mm2 is made once.
    @cache
    def concrete(
        area: float, stress: float, strain: float, fall: float, rest: float
    ) -> ConcreteSpring:
        secant = 1.3 * stress / strain
        return ConcreteSpring(
            k=max(modulus, secant) * area / concrete_length,
            f_peak=stress * area,
            d_peak=strain * concrete_length,
            k_fall=max(fall, 1e6) * area / concrete_length,
            f_res=rest * area,
            plastic=hinge.plastic,
            contact=contact,
            misfit=hinge.misfit,
            wear=hinge.wear,
        )

    layers: list[tuple[float, ConcreteSpring | SteelSpring]] = []
    fall = hinge.core_fall * 0.2 * core / max(core_ultimate - core_peak, 0.002)
    for strip in strips.core:
        spring = concrete(round(strip.area, 12), core, core_peak, fall, hinge.residual * core)
        layers.append((strip.y, spring))
    fall = hinge.cover_fall * 0.8 * strength / 0.004
    for strip in strips.cover:
        layers.append((strip.y, concrete(round(strip.area, 12), strength, peak, fall, 0.0)))
    slip = by_axial(hinge.slip_length, hinge.slip_axial) * bond

    @cache
    def steel(area: float, yield_stress: float, ultimate_stress: float) -> SteelSpring:
        fy = hinge.steel_strength * yield_stress
        fu = hinge.steel_strength * ultimate_stress
        stiffness = _ES * area / (steel_length + slip)
        return SteelSpring(
            k=stiffness,
            f_y=fy * area,
            k_post=stiffness * max(0.0005, hinge.hardening * (fu - fy) / 0.08 / _ES),
            r0=by_axial(hinge.roundness, hinge.roundness_axial),
            r1=hinge.roundness_loss,
            r2=hinge.roundness_reach,
            growth=hinge.growth,
            endurance=1 / hinge.fatigue if hinge.fatigue > 0 else 0.0,
        )

    for bar in drawing.bars:
        layers.append((bar.y, steel(bar.area, bar.yield_stress, bar.ultimate_stress)))
    _check(axial_load, layers)
    uncracked = modulus * strips.inertia + _ES * sum(bar.area * bar.y**2 for bar in drawing.bars)
    return HingeJoint(
        Layered(axial_load, tuple(layers)),
        concrete_length,
        min(_STIFFEST, by_axial(hinge.stiffness, hinge.stiffness_axial)) * uncracked,
        hinge.shear_stiffness * modulus / 2.4 * strips.shear_area,
    )


def _check(axial_load: float, layers: list[tuple[float, ConcreteSpring | SteelSpring]]) -> None:
    """Refuse what only hardening bars would carry."""
    bars = sum(spring.f_y for _, spring in layers if isinstance(spring, SteelSpring))
    whole = bars + sum(spring.f_peak for _, spring in layers if isinstance(spring, ConcreteSpring))
    if not -bars < axial_load < whole:
        raise InputError(
            f"axial load = {axial_load / 1e3:g} kN is not between {-bars / 1e3:.0f} and "
            f"{whole / 1e3:.0f} kN, which bars and concrete of the section carry"
        )
