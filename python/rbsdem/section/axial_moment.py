"""Interaction of axial load and moment: of a section, by material laws or a code, and of a joint.

A section fails where its extreme fibre in compression reaches the strain of the code. Each neutral
axis then gives one axial load and one moment, from bars that all yield in tension to uniform
compression. Bars displace the concrete of the block that they stand in.

A layered joint of a column is another thing than its section: its layers have the fitted strengths
and lengths of the model.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.model.materials import Spiral, Steel
from rbsdem.model.shape import Section, checked_section
from rbsdem.model.springs import Layered, SteelSpring
from rbsdem.section.curvature import is_confined, largest_moment

Code = Literal["aci318", "ec2"]

_MPA = 1.0e6


@dataclass(frozen=True, repr=False, eq=False)
class InteractionDiagram(Tabular):
    """Axial loads that a section carries with their moments, from tension to compression.

    Attributes
    ----------
    code : {"aci318", "ec2", "joint"} or None
        Whose stress block; "joint": the layers of a joint; None: the material laws of the section.
    axial_load, moment : ndarray, shape (k,)
        Nominal strength: axial load [N], ascending, compression positive; moment about mid-depth
        [N m] with y > 0 in tension.
    design_axial_load, design_moment : ndarray, shape (m,)
        Strength with the factors of the code, and its limit of the axial load. Equal to the nominal
        one for material laws and joints.
    neutral_axis : ndarray, shape (k,)
        Its distance from the extreme fibre in compression [m]; infinite in uniform compression, 0
        in tension; NaN for material laws and joints.
    tension_strain : ndarray, shape (k,)
        Strain of the outermost bar in tension, elongation positive; NaN likewise.
    """

    _columns = ("axial_load N", "moment Nm", "neutral_axis m", "tension_strain")

    code: Code | Literal["joint"] | None
    axial_load: Array
    moment: Array
    design_axial_load: Array
    design_moment: Array
    neutral_axis: Array
    tension_strain: Array

    def moment_at(self, axial_load: ArrayLike, *, design: bool = False) -> Array:
        """Return the moment that the section carries with an axial load [N m].

        Parameters
        ----------
        axial_load : array_like
            Compression positive [N].
        design : bool, optional
            The design strength in place of the nominal one.

        Returns
        -------
        ndarray, shape of `axial_load`
            Linear between points of the diagram; NaN for axial loads that it does not carry.
        """
        load, moment = self._curve(design)
        at = np.asarray(axial_load, dtype=np.float64)
        # The factors of a code can turn the curve back: the outermost of its lines counts.
        before, after = at[..., None] - load[:-1], load[1:] - at[..., None]
        step = np.diff(load)
        share = np.where(step == 0, 1.0, before / np.where(step == 0, 1.0, step))
        found = moment[:-1] + share * np.diff(moment)
        found = np.where(before * after >= 0, found, -np.inf).max(axis=-1)
        return np.where(np.isfinite(found), found, np.nan)[()]

    def utilisation(
        self, axial_load: ArrayLike, moment: ArrayLike, *, design: bool = True
    ) -> Array:
        """Return a moment over the strength that goes with its axial load.

        Parameters
        ----------
        axial_load, moment : array_like
            Demands [N, N m]; the sign of the moment does not count.
        design : bool, optional
            Against the design strength, as by default, or the nominal one.

        Returns
        -------
        ndarray, shape of the demands
            Above 1 where the section fails; infinite for axial loads that it does not carry.
        """
        strength = self.moment_at(axial_load, design=design)
        carried = np.isfinite(strength) & (strength > 0)
        demand = np.abs(np.asarray(moment, dtype=np.float64))
        return np.where(carried, demand / np.where(carried, strength, 1.0), np.inf)[()]

    def _curve(self, design: bool) -> tuple[Array, Array]:
        if design:
            return self.design_axial_load, self.design_moment
        return self.axial_load, self.moment

    def __repr__(self) -> str:
        return (
            f"InteractionDiagram({self.code or 'material laws'}, N {self.axial_load[0] / 1e3:.4g} "
            f"to {self.axial_load[-1] / 1e3:.4g} kN, "
            f"largest moment {self.moment.max() / 1e3:.4g} kN m)"
        )


def joint_interaction(
    joint: Layered, closing: float, rotation: float, points: int
) -> InteractionDiagram:
    """Return the largest moments of a layered joint that turns for the first time.

    Parameters
    ----------
    joint : Layered
        The joint, with bars among its layers.
    closing : float
        Of all layers, within which they carry their largest axial load [m].
    rotation : float
        Up to which it turns, y > 0 in tension [rad].
    points : int
        Number of axial loads, from bars that yield in tension to that largest load.

    Returns
    -------
    InteractionDiagram
        With `code` "joint".
    """
    count = _points(points)
    turned = _arguments.number(rotation, "interaction: rotation", above=0, most=1, unit="rad")
    loads = np.linspace(*joint_loads(joint, closing), count)
    path = np.concatenate(([0.0], np.geomspace(1e-4, 1.0, 100) * turned))
    moments = np.array([np.nanmax(joint.response(path, load)) for load in loads.tolist()])
    unknown = np.full(count, np.nan)
    return InteractionDiagram("joint", loads, moments, loads, moments, unknown, unknown)


def joint_loads(joint: Layered, closing: float) -> tuple[float, float]:
    """Return the axial loads of a joint without rotation: bars yield in tension, and the largest.

    Parameters
    ----------
    joint, closing
        As for `joint_interaction`.
    """
    bars = [spring for _, spring in joint.layers if isinstance(spring, SteelSpring)]
    if not bars:
        raise InputError("interaction: the joint has no layers of steel")
    apart = max(bar.f_y / bar.k for bar in bars)
    together = -closing * np.linspace(0.0, 1.0, 400)
    numbers = Counter(spring for _, spring in joint.layers)
    least = -sum(n * layer.response([apart])[0] for layer, n in numbers.items())
    forces = sum((n * layer.response(together) for layer, n in numbers.items()), np.zeros(400))
    most = -forces.min()
    return float(least), float(most)


#: Points of a diagram at the most.
_MOST_POINTS = 10_000


def _points(points: int) -> int:
    return _arguments.integer(points, "interaction: points", least=5, most=_MOST_POINTS)


def interaction(
    section: Section, code: Code | None = None, *, points: int = 60, confined: bool = False
) -> InteractionDiagram:
    """Return the interaction diagram of axial load and moment, y > 0 in tension.

    Parameters
    ----------
    section : Section
        The section.
    code : {"aci318", "ec2"}, optional
        "aci318": ACI 318-19 with its factors phi and its limit of the axial load. "ec2":
        EN 1992-1-1 with gamma_c = 1.5, gamma_s = 1.15 and alpha_cc = 1, without a least
        eccentricity. None: the largest moments of `moment_curvature` at each axial load, with a
        confined core until its hoops break.
    points : int, optional
        About how many points.
    confined : bool, optional
        For the material laws of the section: whether the core is confined and the cover spalls.

    Returns
    -------
    InteractionDiagram
        Nominal and design strength; `rbsdem.plot.interaction` draws them with
        demands.

    Raises
    ------
    InputError
        If the code is not known or does not cover the section.
    """
    checked_section(section)
    count, confined = _points(points), is_confined(section, confined)
    if code is None:
        return _own(section, count, confined)
    code = _arguments.choice(code, "interaction: code", get_args(Code))
    if confined:
        raise InputError("interaction: the blocks of codes are those of unconfined concrete")
    if not section.bars:
        raise InputError("interaction: the section has no bars; give it some")
    return _aci_318(section, count) if code == "aci318" else _ec_2(section, count)


def _own(section: Section, count: int, confined: bool) -> InteractionDiagram:
    """Return the largest moment of the moment-curvature diagram at each axial load.

    At the ends the section has one strain all over.
    """
    ends, at_ends = _core.axial_capacity(section._statement, tension="ts", confined=confined)
    loads = np.linspace(*ends, count)
    inner = [largest_moment(section, load, confined) for load in loads[1:-1].tolist()]
    moments = np.array([at_ends[0], *inner, at_ends[1]])
    unknown = np.full(count, np.nan)
    return InteractionDiagram(None, loads, moments, loads, moments, unknown, unknown)


@dataclass(frozen=True)
class _Block:
    """The block of a code: uniform stress over a part of the depth in compression, in Pa."""

    section: Section
    stress: float
    share: float
    steel_factor: float = 1.0

    def point(self, axis: float, strains: Callable[[Array], Array]) -> tuple[float, float]:
        """Return axial load and moment for a neutral axis; strains of bars by their places."""
        deep = min(self.share * axis, self.section.depth)
        area, first = self.section.part(deep)
        load, moment = self.stress * area, -self.stress * first
        for y, bar, steel in self.section.bars:
            limit = self.steel_factor * steel.fy
            stress = min(max(float(strains(np.array([y]))[0]) * steel.es, -limit), limit)
            if y + 0.5 * self.section.depth <= deep and stress > 0:
                stress -= self.stress
            load += stress * bar
            moment -= stress * bar * y
        return load, moment

    def ends(self, strain: float) -> tuple[tuple[float, float], tuple[float, float]]:
        """Return the points of bars that all yield in tension, and of uniform compression."""
        pulled = self.point(0.0, lambda y: np.full(y.shape, -math.inf))
        pressed = self.point(math.inf, lambda y: np.full(y.shape, strain))
        return pulled, pressed


def _axes(section: Section, ultimate: float, count: int, strains: list[float]) -> Array:
    """Return neutral axes, ascending, with those at which the outermost bar has given strains."""
    outermost = max(y for y, _, _ in section.bars) + 0.5 * section.depth
    # A bar at the face has no depth: the section is then in compression from the start.
    depth = max(outermost, 0.05 * section.depth)
    yielded = np.geomspace(0.15, 1e-4, count // 2)
    by_strain = depth * ultimate / (ultimate + np.concatenate((yielded, strains)))
    beyond = depth * np.linspace(1.0, 4.0, count - count // 2)
    return np.unique(np.concatenate((by_strain, beyond, [section.depth])))


def _outermost(section: Section) -> tuple[float, Steel]:
    """Return the place of the outermost bars in tension, and their steel that yields last."""
    y, _, steel = max(section.bars, key=lambda bar: (bar[0], bar[2].fy / bar[2].es))
    return y, steel


_ACI_STRAIN = 0.003


def _aci_block(section: Section) -> _Block:
    """Return the block of ACI 318-19, 22.2.2.4."""
    fc = section.concrete_law["fc"]
    share = min(max(0.85 - 0.05 * (fc / _MPA - 28.0) / 7.0, 0.65), 0.85)
    return _Block(section, 0.85 * fc, share)


def _aci_strains(section: Section, axis: float) -> Callable[[Array], Array]:
    return lambda y: _ACI_STRAIN * (1.0 - (y + 0.5 * section.depth) / axis)


def nominal_moment(section: Section, axial_load: float) -> float:
    """Return the moment of ACI 318-19, without phi, that goes with an axial load [N m].

    A point of `interaction`, to the last digits. NaN for an axial load that the block does
    not carry.

    Parameters
    ----------
    section : Section
        The section, with bars.
    axial_load : float
        Compression positive [N].
    """
    block = _aci_block(section)

    def at(axis: float) -> tuple[float, float]:
        return block.point(axis, _aci_strains(section, axis))

    low, high = 1e-6 * section.depth, 1e6 * section.depth
    if not at(low)[0] <= axial_load <= at(high)[0]:
        return math.nan
    while high - low > 1e-14 * high:
        # The axis goes over twelve powers of ten: halved by its logarithm first.
        middle = math.sqrt(low * high) if high > 2.0 * low else 0.5 * (low + high)
        low, high = (middle, high) if at(middle)[0] < axial_load else (low, middle)
    return at(high)[1]


def _aci_318(section: Section, count: int) -> InteractionDiagram:
    """ACI 318-19: 22.2.2.4 (block), 21.2.2 (phi), 22.4.2.1 (limit of the axial load)."""
    block, ultimate = _aci_block(section), _ACI_STRAIN
    outermost, steel = _outermost(section)
    yields = steel.fy / steel.es
    axes = _axes(section, ultimate, count, [0.0, yields, yields + 0.003, 0.005])
    rows = [block.point(axis, _aci_strains(section, axis)) for axis in axes]
    pulled, pressed = block.ends(math.inf)
    load, moment = np.array([pulled, *rows, pressed]).T
    inner = [-_aci_strains(section, axis)(np.array([outermost]))[0] for axis in axes]
    tension = np.array([math.inf, *inner, -ultimate])
    spiral = isinstance(section.ties, Spiral) and not section.ties.hoops
    pressed_factor, cap = (0.75, 0.85) if spiral else (0.65, 0.80)
    factor = pressed_factor + (0.9 - pressed_factor) * np.clip((tension - yields) / 0.003, 0.0, 1.0)
    design = _capped(factor * load, factor * moment, pressed_factor * cap * load[-1])
    axis = np.concatenate(([0.0], axes, [math.inf]))
    return InteractionDiagram("aci318", load, moment, *design, axis, tension)


def _ec_2(section: Section, count: int) -> InteractionDiagram:
    """EN 1992-1-1: 3.1.7(3) (block), table 3.1 (strains), 2.4.2.4 (partial factors).

    gamma_c = 1.5, gamma_s = 1.15, alpha_cc = 1. Wholly in compression, strains turn about the fibre
    that stays at eps_c3 (figure 6.1).
    """
    fc = section.concrete_law["fc"]
    high = max(fc / _MPA - 50.0, 0.0)
    if high > 40.0:
        raise InputError(f"interaction: fc = {fc / _MPA:g} MPa is beyond the 90 MPa of EN 1992-1-1")
    ultimate, plateau = 0.0035, 0.00175
    if high > 0.0:
        ultimate = (2.6 + 35.0 * ((90.0 - fc / _MPA) / 100.0) ** 4) / 1e3
        plateau = (1.75 + 0.55 * high / 40.0) / 1e3
    share, strength = 0.8 - high / 400.0, 1.0 - high / 200.0
    if section.narrows:
        # 3.1.7(3): where the width falls towards the extreme fibre.
        strength *= 0.9
    depth, half = section.depth, 0.5 * section.depth
    outermost, steel = _outermost(section)
    axes = _axes(section, ultimate, count, [0.0, steel.fy / steel.es])
    fixed = (1.0 - plateau / ultimate) * depth

    def strains(axis: float) -> Callable[[Array], Array]:
        face = ultimate if axis <= depth else plateau * axis / (axis - fixed)
        return lambda y: face * (1.0 - (y + half) / axis)

    curves = []
    for concrete_factor, steel_factor in ((1.0, 1.0), (1.0 / 1.5, 1.0 / 1.15)):
        block = _Block(section, concrete_factor * strength * fc, share, steel_factor)
        pulled, pressed = block.ends(plateau)
        curves.append(np.array([pulled, *(block.point(x, strains(x)) for x in axes), pressed]).T)
    inner = [-strains(x)(np.array([outermost]))[0] for x in axes]
    tension = np.array([math.inf, *inner, -plateau])
    axis = np.concatenate(([0.0], axes, [math.inf]))
    (load, moment), (design_load, design_moment) = curves
    return InteractionDiagram("ec2", load, moment, design_load, design_moment, axis, tension)


def _capped(load: Array, moment: Array, most: float) -> tuple[Array, Array]:
    """Return a curve up to an axial load, closed by the line there."""
    over = np.flatnonzero(load > most)
    if over.size == 0:
        return load, moment
    at = int(over[0])
    share = (most - load[at - 1]) / (load[at] - load[at - 1])
    edge = moment[at - 1] + share * (moment[at] - moment[at - 1])
    return np.append(load[:at], [most, most]), np.append(moment[:at], [edge, 0.0])
