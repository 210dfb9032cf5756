"""The joint at the foot of a column as layers of concrete and steel, from its drawing.

The layers of concrete act over the length of the hinge; those of steel over that length and the
length of yielding in the footing, so that the bars slip out of it. The column above is elastic.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rbsdem.springs import ConcreteSpring, Layered, SteelSpring

if TYPE_CHECKING:
    from rbsdem.peer.drawing import Drawing

__all__ = ["Hinge", "confinement", "hinge_joint"]

_ES = 200e9
_STRIPS = 14
_UNCONFINED_PEAK = 0.002


@dataclass(frozen=True)
class Hinge:
    """Numbers of the layered hinge that are the same for all columns.

    The defaults are fitted to the rectangular flexural tests of the PEER Structural Performance
    Database (docs/peer.md says how); the forms are published relations.

    Attributes
    ----------
    steel_strength : float
        Yield and ultimate stress over the measured ones.
    hardening : float
        Factor of the slope from the yield stress to the ultimate stress at 8 % strain.
    roundness, roundness_loss, roundness_reach : float
        R0, cR1, cR2 of Menegotto and Pinto (1973).
    roundness_axial : float
        Exponent by which R0 grows with the axial load ratio over 0.2.
    fatigue, fatigue_axial : float
        1 over the plastic work, over f_y d_y, that halves the strength of a bar; its exponent with
        the axial load ratio.
    concrete_strength, concrete_size : float
        In-place over cylinder strength at 40 MPa; exponent of its fall with the strength.
    confinement : float
        Factor of the confining stress of Mander, Priestley and Park (1988).
    core_fall, cover_fall : float
        Factors of the slopes behind the peak: to 80 % at Mander's ultimate strain; to 20 % over
        0.004.
    residual : float
        Share of the core's strength that is left.
    hinge_length, hinge_axial, hinge_depth : float
        Factor of 0.08 L + 0.022 f_y d_b (Paulay and Priestley 1992), exponent with the axial load
        ratio, share of the depth added.
    compression_length : float
        Hinge length of the concrete over that of the steel.
    slip_length : float
        Length of yielding in the footing over f_y d_b [1/MPa].
    stiffness, stiffness_axial : float
        Flexural stiffness of the column above over E_c I_g: at no axial load, and its growth with
        the axial load ratio.
    shear_stiffness : float
        Shear stiffness of the column over the uncracked one.
    plastic, misfit, contact, contact_axial, wear : float
        Of the concrete layers, see `rbsdem.ConcreteSpring`; exponent of `contact` with the axial
        load ratio.
    """

    steel_strength: float = 1.062
    hardening: float = 1.127
    roundness: float = 7.89
    roundness_loss: float = 0.834
    roundness_reach: float = 0.420
    roundness_axial: float = 1.78
    fatigue: float = 0.00105
    fatigue_axial: float = 1.99
    concrete_strength: float = 0.765
    concrete_size: float = 0.120
    confinement: float = 0.826
    core_fall: float = 0.0697
    cover_fall: float = 0.163
    residual: float = 0.368
    hinge_length: float = 0.633
    hinge_axial: float = -0.376
    hinge_depth: float = 0.0535
    compression_length: float = 1.334
    slip_length: float = 0.0175
    stiffness: float = 0.819
    stiffness_axial: float = 1.50
    shear_stiffness: float = 0.5
    plastic: float = 1.318
    misfit: float = 0.432
    contact: float = 0.417
    contact_axial: float = -1.33
    wear: float = 0.0368

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
        Length of the hinge [m].
    flexural_stiffness : float
        E I of the column above [N m2].
    shear_stiffness : float
        G A of the column [N].
    """

    spring: Layered
    length: float
    flexural_stiffness: float
    shear_stiffness: float


def confinement(drawing: Drawing, core_width: float, core_depth: float) -> tuple[float, float]:
    """Return the effective confining stress [Pa] and the volume ratio of the ties.

    Mander, Priestley and Park (1988): effectiveness by the parabolas between the bars around the
    perimeter and between the ties.
    """
    if not drawing.tie_diameter or not drawing.tie_spacing:
        return 0.0, 0.0
    ratio = drawing.legs * math.pi / 4 * drawing.tie_diameter**2
    ratio /= drawing.tie_spacing * core_width
    area = core_width * core_depth
    if drawing.legs <= 2:
        clear = core_width - drawing.bar_diameter, core_depth - drawing.bar_diameter
        parabolas = 2 * (clear[0] ** 2 + clear[1] ** 2) / 6
    else:
        bars = max(4, drawing.restrained)
        clear_one = max(0.0, 2 * (core_width + core_depth) / bars - drawing.bar_diameter)
        parabolas = bars * clear_one**2 / 6
    gap = drawing.tie_spacing - drawing.tie_diameter
    steel = min(0.08, sum(bar.area for bar in drawing.bars) / area)
    effective = max(0.0, 1 - parabolas / area) / (1 - steel)
    effective *= max(0.0, 1 - gap / (2 * core_width)) * max(0.0, 1 - gap / (2 * core_depth))
    return effective * ratio * drawing.tie_yield_stress, 2 * ratio


def hinge_joint(drawing: Drawing, length: float, axial_load: float, hinge: Hinge) -> HingeJoint:
    """Make the layered hinge of a rectangular section.

    Parameters
    ----------
    drawing : Drawing
        The section.
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
        If the layers cannot carry the axial load.
    """
    width, depth = drawing.width, drawing.depth
    cylinder = drawing.concrete_strength
    ratio = axial_load / (cylinder * width * depth)
    modulus = (3320 * math.sqrt(cylinder / 1e6) + 6900) * 1e6
    strength = hinge.concrete_strength * cylinder * (cylinder / 40e6) ** -hinge.concrete_size
    core_width = width - 2 * drawing.side_cover - drawing.tie_diameter
    core_depth = depth - 2 * drawing.cover - drawing.tie_diameter
    stress, ties = confinement(drawing, core_width, core_depth)
    relative = hinge.confinement * stress / cylinder
    gain = -1.254 + 2.254 * math.sqrt(1 + 7.94 * relative) - 2 * relative
    core = gain * strength
    core_peak = _UNCONFINED_PEAK * (1 + 5 * (gain - 1))
    core_ultimate = 0.004 + 0.14 * ties * drawing.tie_yield_stress / core
    yield_stress = max(bar.yield_stress for bar in drawing.bars)
    bond = yield_stress / 1e6 * drawing.bar_diameter
    steel_length = hinge.hinge_length * (0.08 * length + 0.022 * bond)
    steel_length *= math.exp(hinge.hinge_axial * (ratio - 0.2))
    steel_length = min(steel_length + hinge.hinge_depth * depth, 0.8 * length)
    concrete_length = hinge.compression_length * steel_length
    contact = min(0.9, hinge.contact * math.exp(hinge.contact_axial * (ratio - 0.2)))

    def concrete(
        area: float, peak: float, strain: float, fall: float, rest: float
    ) -> ConcreteSpring:
        secant = 1.3 * peak / strain
        return ConcreteSpring(
            k=max(modulus, secant) * area / concrete_length,
            f_peak=peak * area,
            d_peak=strain * concrete_length,
            k_fall=max(fall, 1e6) * area / concrete_length,
            f_res=rest * area,
            plastic=hinge.plastic,
            contact=contact,
            misfit=hinge.misfit,
            wear=hinge.wear,
        )

    layers: list[tuple[float, ConcreteSpring | SteelSpring]] = []
    strip = depth / _STRIPS
    for i in range(_STRIPS):
        y = (i + 0.5) * strip - depth / 2
        inside = min(y + strip / 2, core_depth / 2) - max(y - strip / 2, -core_depth / 2)
        core_area = max(0.0, inside) * core_width
        cover_area = strip * width - core_area
        if core_area > 0:
            fall = hinge.core_fall * 0.2 * core / max(core_ultimate - core_peak, 0.002)
            layers.append((y, concrete(core_area, core, core_peak, fall, hinge.residual * core)))
        if cover_area > 0:
            fall = hinge.cover_fall * 0.8 * strength / 0.004
            layers.append((y, concrete(cover_area, strength, _UNCONFINED_PEAK, fall, 0.0)))
    fatigue = hinge.fatigue * math.exp(hinge.fatigue_axial * (ratio - 0.2))
    for bar in drawing.bars:
        fy = hinge.steel_strength * bar.yield_stress
        fu = hinge.steel_strength * bar.ultimate_stress
        stiffness = _ES * bar.area / (steel_length + hinge.slip_length * bond)
        spring = SteelSpring(
            k=stiffness,
            f_y=fy * bar.area,
            k_post=stiffness * max(0.0005, hinge.hardening * (fu - fy) / 0.08 / _ES),
            r0=hinge.roundness * math.exp(hinge.roundness_axial * (ratio - 0.2)),
            r1=hinge.roundness_loss,
            r2=hinge.roundness_reach,
            endurance=1 / fatigue if fatigue > 0 else 0.0,
        )
        layers.append((bar.y, spring))
    share = min(1.0, hinge.stiffness + hinge.stiffness_axial * max(ratio, -0.1))
    return HingeJoint(
        Layered(axial_load, tuple(layers)),
        steel_length,
        share * modulus * width * depth**3 / 12,
        hinge.shear_stiffness * modulus / 2.4 * width * depth * 5 / 6,
    )
