"""Strengths of a section: axial load with moment, shear, and drifts at the loss of both.

A section fails where its extreme fibre in compression reaches the strain of the code. Each neutral
axis then gives one axial load and one moment, from bars that all yield in tension to uniform
compression. Bars displace the concrete of the block that they stand in.

A layered joint of a column is another thing than its section: its layers have the fitted strengths
and lengths of the model.

Strengths in shear are published relations with their sources; SI throughout. The empirical ones are
written by their authors in MPa, N and mm. Depth d is from the compression face to the centre of the
bars in the half in tension, and 0.8 of the diameter for circles (ACI 318-19, 22.5.2.2).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache, partial
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.model.materials import Spiral, Steel
from rbsdem.model.shape import CircularSection, Section, checked_section
from rbsdem.model.springs import Layered, SteelSpring
from rbsdem.section.curvature import (
    carried_load,
    checked_load,
    column_length,
    is_confined,
    largest_moment,
)

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
    upside_down : InteractionDiagram or None
        That of the section upside down, for moments with y < 0 in tension; None: the same.
    """

    _columns = ("axial_load N", "moment Nm", "neutral_axis m", "tension_strain")

    code: Code | Literal["joint"] | None
    axial_load: Array
    moment: Array
    design_axial_load: Array
    design_moment: Array
    neutral_axis: Array
    tension_strain: Array
    upside_down: InteractionDiagram | None = None

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

    def moment_range(self, axial_load: ArrayLike, *, design: bool = False) -> tuple[Array, Array]:
        """Return least and largest moment with an axial load, y > 0 in tension positive [N m]."""
        other = self.upside_down or self
        least = -other.moment_at(axial_load, design=design)
        return least, self.moment_at(axial_load, design=design)

    def utilisation(
        self, axial_load: ArrayLike, moment: ArrayLike, *, design: bool = True
    ) -> Array:
        """Return a moment over the strength of its side that goes with its axial load.

        Parameters
        ----------
        axial_load, moment : array_like
            Demands [N, N m]; moments with y > 0 in tension are positive.
        design : bool, optional
            Against the design strength, as by default, or the nominal one.

        Returns
        -------
        ndarray, shape of the demands
            Above 1 where the section fails; infinite for axial loads that it does not carry. Where
            it carries an axial load only with a moment, as near its strength in tension with bars
            on one side, the distance from the middle of these moments over half of their range.
        """
        least, most = self.moment_range(axial_load, design=design)
        demand = np.asarray(moment, dtype=np.float64)
        around = (least < 0) & (most > 0)
        with np.errstate(divide="ignore", invalid="ignore"):
            side = demand / np.where(demand < 0, least, most)
            middle = np.abs(demand - 0.5 * (least + most)) / (0.5 * (most - least))
        found = np.where(around, side, np.where(most > least, middle, np.inf))
        return np.where(np.isfinite(least + most), found, np.inf)[()]

    def _curve(self, design: bool) -> tuple[Array, Array]:
        """Return axial loads [N] and moments [N m], of design or nominal."""
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
    moments, opposite = (
        np.array([np.nanmax(each.response(path, load)) for load in loads.tolist()])
        for each in (joint, joint.mirrored())
    )
    unknown = np.full(count, np.nan)
    made, other = (
        InteractionDiagram("joint", loads, each, loads, each, unknown, unknown)
        for each in (moments, opposite)
    )
    alike = np.allclose(moments, opposite, rtol=1e-9, atol=1e-9 * np.abs(moments).max())
    return made if alike else replace(made, upside_down=other)


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
    """Return the checked number of points of a diagram."""
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
        return _both_sides(partial(_own, confined=confined), section, count)
    code = _arguments.choice(code, "interaction: code", get_args(Code))
    if confined:
        raise InputError("interaction: the blocks of codes are those of unconfined concrete")
    if not section.bars:
        raise InputError("interaction: the section has no bars; give it some")
    return _both_sides(_aci_318 if code == "aci318" else _ec_2, section, count)


def _both_sides(
    make: Callable[[Section, int], InteractionDiagram], section: Section, count: int
) -> InteractionDiagram:
    """Return a diagram that knows that of the section upside down, if this differs."""
    made = make(section, count)
    return made if section.symmetric else replace(made, upside_down=make(section.mirrored, count))


def _own(section: Section, count: int, *, confined: bool) -> InteractionDiagram:
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

    @cached_property
    def _bars(self) -> Array:
        """Places, areas, modulus and yield stress of the bars, a row each."""
        rows = [(y, area, steel.es, steel.fy) for y, area, steel in self.section.bars]
        return np.array(rows).reshape(-1, 4).T[:, :, None]

    def curve(self, axes: Array, strains: Callable[[Array, Array], Array]) -> Array:
        """Return axial loads and moments for neutral axes, shape (2, axes).

        `strains` are those of bars by neutral axes and places, shape (bars, axes).
        """
        depth, (y, bar, modulus, yields) = self.section.depth, self._bars
        limit, deep = self.steel_factor * yields, np.minimum(self.share * axes, depth)
        area, first = self.section.part(deep)
        force = np.clip(strains(axes, y) * modulus, -limit, limit)
        # A bar displaces the concrete of the block.
        force = bar * (force - self.stress * ((y + 0.5 * depth <= deep) & (force > 0.0)))
        load = self.stress * area + force.sum(axis=0)
        return np.array([load, -self.stress * first - (force * y).sum(axis=0)])

    def whole_curve(
        self, axes: Array, strains: Callable[[Array, Array], Array], strain: float
    ) -> Array:
        """Return the curve between bars that all yield in tension and uniform compression."""
        pulled = self.curve(np.zeros(1), lambda _, y: np.full_like(y, -math.inf))
        pressed = self.curve(np.full(1, math.inf), lambda _, y: np.full_like(y, strain))
        return np.hstack([pulled, self.curve(axes, strains), pressed])


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


#: Strain of the extreme fibre in compression (ACI 318-19, 22.2.2.1).
_ACI_STRAIN = 0.003


def block_share(fc: float) -> float:
    """Return beta_1, the depth of the block over that of the neutral axis (22.2.2.4.3).

    Parameters
    ----------
    fc : float
        Strength of the concrete [MPa].
    """
    return min(max(0.85 - 0.05 * (fc - 28.0) / 7.0, 0.65), 0.85)


def _aci_block(section: Section) -> _Block:
    """Return the block of ACI 318-19, 22.2.2.4."""
    fc = section.concrete_law["fc"]
    return _Block(section, 0.85 * fc, block_share(fc / _MPA))


def _aci_strains(section: Section) -> Callable[[Array, Array], Array]:
    """Return the strain as a function of neutral axis and place y [m], 0.003 at the face."""
    half = 0.5 * section.depth
    return lambda axis, y: np.asarray(_ACI_STRAIN * (1.0 - (y + half) / axis))


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
    return nominal_point(section, axial_load)[1]


@lru_cache(maxsize=1024)
def nominal_point(section: Section, axial_load: float) -> tuple[float, float]:
    """Return the neutral axis [m] and the moment of `nominal_moment` [N m].

    Parameters
    ----------
    section : Section
        The section, with bars.
    axial_load : float
        Compression positive [N].
    """
    block, strains = _aci_block(section), _aci_strains(section)
    # The axis goes over twelve powers of ten; then its range is cut into parts, again and again.
    axes = section.depth * np.geomspace(1e-6, 1e6, 513)
    load, moment = block.curve(axes, strains)
    if not load[0] <= axial_load <= load[-1]:
        return math.nan, math.nan
    while True:
        at = max(int(np.argmax(load >= axial_load)), 1)
        low, high = axes[at - 1 : at + 1].tolist()
        if high - low <= 1e-14 * high:
            return high, float(moment[at])
        axes = np.linspace(low, high, 513)
        load, moment = block.curve(axes, strains)


def _aci_318(section: Section, count: int) -> InteractionDiagram:
    """ACI 318-19: 22.2.2.4 (block), 21.2.2 (phi), 22.4.2.1 (limit of the axial load)."""
    block, ultimate = _aci_block(section), _ACI_STRAIN
    outermost, steel = _outermost(section)
    yields = steel.fy / steel.es
    axes = _axes(section, ultimate, count, [0.0, yields, yields + 0.003, 0.005])
    strains = _aci_strains(section)
    load, moment = block.whole_curve(axes, strains, math.inf)
    inner = -strains(axes, np.array(outermost))
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

    def strains(axis: Array, y: Array) -> Array:
        """Return strains: the face is at `ultimate`, or further on the `fixed` fibre at eps_c3."""
        beyond = plateau * axis / np.where(axis > depth, axis - fixed, axis)
        face = np.where(axis <= depth, ultimate, beyond)
        return np.asarray(face * (1.0 - (y + half) / axis))

    curves = []
    for concrete_factor, steel_factor in ((1.0, 1.0), (1.0 / 1.5, 1.0 / 1.15)):
        block = _Block(section, concrete_factor * strength * fc, share, steel_factor)
        curves.append(block.whole_curve(axes, strains, plateau))
    inner = -strains(axes, np.array(outermost))
    tension = np.array([math.inf, *inner, -plateau])
    axis = np.concatenate(([0.0], axes, [math.inf]))
    (load, moment), (design_load, design_moment) = curves
    return InteractionDiagram("ec2", load, moment, design_load, design_moment, axis, tension)


def _capped(load: Array, moment: Array, most: float) -> tuple[Array, Array]:
    """Return a curve up to an axial load, and from there level to no moment."""
    over = np.flatnonzero(load > most)
    if over.size == 0:
        return load, moment
    at = int(over[0])
    share = (most - load[at - 1]) / (load[at] - load[at - 1])
    edge = moment[at - 1] + share * (moment[at] - moment[at - 1])
    return np.append(load[:at], [most, most]), np.append(moment[:at], [edge, 0.0])


# Share of the least ties from which on the crack spacing goes over to that of tied sections.
_NEARLY = 0.9
#: Shear span of columns over effective depth, below which an arch carries.
SQUAT = 4.0
# Strength of a strut without ties over that of one with them.
_SPLITS = 0.4 / 0.75
_ES = 200.0e9


@dataclass(frozen=True, slots=True)
class ShearSizes:
    """Sizes of a section that the relations use.

    Attributes
    ----------
    fc : float
        Cylinder strength [Pa].
    width, depth, d : float
        Width, that of the webs of a hollow section, whole depth and effective depth [m].
    gross_area : float
        Of the concrete [m2].
    tension_steel : float
        Bars in the half in tension [m2]; a bar at mid-depth counts half, and bars within a
        twentieth of the depth from there in proportion.
    tie_area : float
        Legs times area of a bar, in the direction of the shear [m2]; 0 without ties.
    spacing : float
        Of the ties [m]; infinite without.
    tie_yield : float
        Their yield stress [Pa]; 0 without.
    core_depth : float
        Between centre lines of the ties [m]; the whole depth without.
    """

    fc: float
    width: float
    depth: float
    d: float
    gross_area: float
    tension_steel: float
    tie_area: float
    spacing: float
    tie_yield: float
    core_depth: float

    @property
    def tie_ratio(self) -> float:
        """Ties over width times spacing, rho''."""
        return self.tie_area / (self.width * self.spacing)


def shear_sizes(section: Section) -> ShearSizes:
    """Return the sizes of a section that the relations use.

    Parameters
    ----------
    section : Section
        The section.

    Returns
    -------
    ShearSizes
        Its sizes.
    """
    known, ties = section.__dict__, section.ties
    if "_shear_sizes" not in known:
        fc, width, depth = section.concrete_law["fc"], section.web_width, section.depth
        held = 0.0, math.inf, 0.0, depth
        if ties is not None:
            area = ties.legs * 0.25 * math.pi * ties.diameter**2
            core = depth - 2.0 * section.cover - ties.diameter
            held = area, ties.spacing, ties.steel.fy, core
        # Wings of a flange carry no shear along the depth.
        whole = width * depth if section.shape in ("tee", "wall") else section.gross_area
        steel = whole, section.tension_steel
        known["_shear_sizes"] = ShearSizes(fc, width, depth, section.effective_depth, *steel, *held)
    sizes: ShearSizes = known["_shear_sizes"]
    return sizes


def shear_strength(section: Section, length: float, axial_load: float) -> float:
    """Return the shear strength of the simplified modified compression field theory [N].

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span [m].
    axial_load : float
        Compression positive, within the capacity of the section [N].

    Raises
    ------
    InputError
        If a value is refused.
    """
    load = carried_load(checked_load(section, axial_load), section)
    return shear_strength_mcft(section, column_length(length, "length"), load)


def shear_strength_mcft(
    section: Section,
    length: float,
    axial_load: float,
    aggregate: float = 0.019,
    arch: float = 1.0,
    ties: float | None = None,
    strut: float = 0.0,
) -> float:
    """Return the shear strength of the simplified modified compression field theory.

    V_n = beta sqrt(f'c) b z + A_v f_yt z cot(theta)/s, z = 0.9 d, with
    beta = 0.4/(1 + 1500 eps_x) 1300/(1000 + s_ze), theta = (29 + 7000 eps_x)(0.88 + s_ze/2500) up
    to 75 degrees, and eps_x = (M/d + V - N/2)/(2 E_s A_s) >= 0 the strain at mid-depth. M and V are
    those at d from the base when V_n is reached, M at least V d.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    aggregate : float, optional
        Largest grain of the concrete [m]; it matters only with fewer ties than the minimum.
    arch : float, optional
        Factor of the concrete's share, see `arch_factor`.
    ties : float, optional
        What the ties carry [N]; by default that of the theory.
    strut : float, optional
        What the strut of the axial load carries besides [N], see `axial_strut`.

    Returns
    -------
    float
        V_n [N], at most 0.25 f'c b z.

    Notes
    -----
    Bentz, Vecchio, Collins 2006 (ACI Structural Journal 103(4)). With ties of at least
    0.06 sqrt(f'c)/f_yt the crack spacing s_ze is 300 mm, else 35 z/(16 + aggregate) >= 0.85 z (mm);
    from 0.9 of those ties on it goes from one to the other in a straight line.
    """
    sizes = shear_sizes(section)
    if not section.bars:
        return 0.0
    z = 0.9 * sizes.d
    root = min(math.sqrt(sizes.fc / _MPA), 8.0)
    least = _least_ties(sizes)
    s_ze = max(35.0 * z * 1e3 / (16.0 + aggregate * 1e3), 0.85 * z * 1e3)
    tied = min(max((sizes.tie_ratio / least - _NEARLY) / (1.0 - _NEARLY), 0.0), 1.0)
    s_ze += tied * (300.0 - s_ze)
    arm = max(length - sizes.d, sizes.d)
    d, width, pressed = sizes.d, sizes.width, 0.5 * axial_load
    # The strength has a limit where bars in tension vanish.
    steel = 2.0 * _ES * max(sizes.tension_steel, 1e-9 * sizes.gross_area)
    size, turn = 1000.0 + s_ze, 0.88 + s_ze / 2500.0
    pull, spacing = sizes.tie_area * sizes.tie_yield * z, sizes.spacing
    crushed = 0.25 * sizes.fc * width * z

    def strength(v: float) -> float:
        """Return the strength [N] at the strain at mid-depth under a shear force v [N]."""
        eps_x = max((v * arm / d + v - pressed) / steel, 0.0)
        beta = 0.4 / (1.0 + 1500.0 * eps_x) * 1300.0 / size
        theta = math.radians(min((29.0 + 7000.0 * eps_x) * turn, 75.0))
        v_c = arch * beta * root * _MPA * width * z
        v_s = pull / (math.tan(theta) * spacing) if ties is None else ties
        return min(v_c + v_s + strut, crushed)

    # More shear opens the cracks: strength(v) falls, so there is one v that equals it.
    return _crossing(strength, strength(0.0))


def _least_ties(sizes: ShearSizes) -> float:
    """Return the least ratio of ties, 0.06 sqrt(f'c)/f_yt (MPa), sqrt(f'c) up to 8 MPa."""
    if not sizes.tie_yield > 0.0:
        return math.inf
    return 0.06 * min(math.sqrt(sizes.fc / _MPA), 8.0) * _MPA / sizes.tie_yield


def column_shear_strength(section: Section, length: float, axial_load: float) -> float:
    """Return the shear strength of a column [N]: concrete, ties, and the strut of the axial load.

    V_n = k V_c + V_s + V_p: V_c of the simplified modified compression field theory, at the strain
    at mid-depth when V_n is reached (`shear_strength_mcft`), k the `arch_factor` of a squat column;
    V_s of the `truss`; V_p of the `axial_strut`.

    Parameters
    ----------
    section : Section
        The section at the foot.
    length : float
        Shear span a [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    float
        V_n [N], at most 0.25 f'c b z.

    Notes
    -----
    The parts are published laws, see there. Their sum was chosen on the largest forces of tests
    with and without histories, each publication left out once (`studies/new_tests.py`).
    """
    hinge = section, length, axial_load
    arch, strut = arch_factor(*hinge), axial_strut(*hinge)
    return shear_strength_mcft(*hinge, arch=arch, ties=truss(section), strut=strut)


def wall_shear_strength(
    section: Section,
    length: float,
    axial_load: float,
    *,
    begins: float,
    strut: float,
    most: float = 4.0,
) -> float:
    """Return the shear strength of a wall [N]: theory of sections with an arch, and the strut.

    V_n = V_MCFT(k) + V_p: `shear_strength_mcft` with the `arch_factor` k of a wall without axial
    load, and the `axial_strut`, as steep as it comes.

    Parameters
    ----------
    section : Section
        The section at the foot.
    length : float
        Shear span a [m].
    axial_load : float
        Compression positive [N].
    begins, most : float
        Shear span over d below which there is an arch, and its largest factor.
    strut : float
        Factor of the strut.
    """
    arch = arch_factor(section, length, 0.0, begins=begins, most=most)
    of_load = axial_strut(section, length, axial_load, shortest=0.0)
    return shear_strength_mcft(section, length, axial_load, arch=arch) + strut * of_load


def truss(section: Section) -> float:
    """Return the shear that the ties carry in a truss of struts at 45 degrees [N].

    alpha A_v f_yt d/s with alpha = 1 up to s = 0.75 d and 0 from s = d on, where a crack at 45
    degrees can pass between the ties (ASCE 41-17, 10.4.2.3).

    Parameters
    ----------
    section : Section
        The section.
    """
    sizes = shear_sizes(section)
    share = min(max((1.0 - sizes.spacing / sizes.d) / 0.25, 0.0), 1.0)
    return share * sizes.tie_area * sizes.tie_yield * sizes.d / sizes.spacing


def arch_factor(
    section: Section,
    length: float,
    axial_load: float,
    *,
    begins: float = SQUAT,
    most: float = 2.0,
) -> float:
    """Return by how much the concrete of a squat column carries more than a theory of sections has.

    1 + (k - 1) k_n k_t with k = 4 d/a from 1 to 2: part of the force goes straight to the support
    where the shear span a is short. k_n = 1 - 2 n, not below 0: the strut that the axial load needs
    is not there for the shear, n = P/(A_g f'c). k_t: without ties the strut splits along itself and
    has 0.4/0.75 of the strength that it has with the least ties of `shear_strength_mcft`.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span a [m].
    axial_load : float
        Compression positive [N].
    begins, most : float, optional
        Shear span over d below which there is an arch, and its largest k: 4 and 2 of columns.

    Returns
    -------
    float
        1 to `most`.

    Notes
    -----
    d/a as in the V_c of Sezen and Moehle (2004), from a = 4 d to 2 d; the strengths of struts with
    and without ties are those of ACI 318-19, table 23.4.3. k_n was chosen on tests.
    """
    sizes = shear_sizes(section)
    squat = min(max(begins * sizes.d / length, 1.0), most)
    free = min(max(1.0 - 2.0 * axial_load / (sizes.fc * sizes.gross_area), 0.0), 1.0)
    tied = min(sizes.tie_ratio / _least_ties(sizes), 1.0)
    return 1.0 + (squat - 1.0) * free * (_SPLITS + (1.0 - _SPLITS) * tied)


def axial_strut(
    section: Section, length: float, axial_load: float, *, shortest: float = SQUAT
) -> float:
    """Return the shear that the axial load carries, by its strut from the load to the foot [N].

    P (h - c)/(2 a), c = (0.2 + 0.65 n) h the depth of the compression zone, about. In columns
    squatter than a = 4 d it is that of a = 4 d: there the compression zone is that of the arch.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span a [m].
    axial_load : float
        Compression positive [N]; none under tension.
    shortest : float, optional
        Shear span over d of the steepest strut: 4 of columns; 0 lets it be as steep as it comes.

    Notes
    -----
    Priestley, Verma and Xiao 1994; Kowalsky and Priestley 2000: neither ductility nor cycles take
    it away.
    """
    sizes = shear_sizes(section)
    ratio = axial_load / (sizes.fc * sizes.gross_area)
    arm = section.depth * max(0.8 - 0.65 * ratio, 0.0)
    return max(axial_load, 0.0) * arm / (2.0 * max(length, shortest * sizes.d))


def bond_demand(section: Section, length: float) -> float:
    """Return the length that anchors a bar over the shear span, f_y d_b/(10 sqrt(f'c) a) (MPa).

    The bond stress is 2.5 sqrt(f'c). Where bars cannot change from tension to compression within
    the span, the cover splits along them (AIJ 1999).

    Parameters
    ----------
    section : Section
        The section, with bars.
    length : float
        Shear span a [m].
    """
    root = math.sqrt(section.concrete.fc / _MPA)
    return section.yield_stress / _MPA * (section.bar_diameter or 0.0) / (10.0 * root * length)


def _crossing(falling: Callable[[float], float], most: float) -> float:
    """Return where a falling function equals its argument, from 0 to `most`, to the last digit."""
    low, high, before, at_before, v = 0.0, most, 0.0, most, 0.5 * most
    # Secants come near; the last digits are halved.
    for _ in range(12):
        at = falling(v) - v
        if abs(v - before) <= 1e-9 * v or at == at_before:
            break
        before, at_before, v = v, at, v - at * (v - before) / (at - at_before)
    for end in (v * (1.0 - 8e-15), v * (1.0 + 8e-15)):
        if low < end < high:
            low, high = (end, high) if falling(end) > end else (low, end)
    while low < (v := 0.5 * (low + high)) < high:
        low, high = (v, high) if falling(v) > v else (low, v)
    return v


def shear_strength_sezen(
    section: Section, length: float, axial_load: float, ductility: float = 1.0
) -> float:
    """Return the shear strength of Sezen and Moehle, which falls with ductility.

    V_n = k (V_c + V_s), V_s = A_v f_yt d/s,
    V_c = 0.5 sqrt(f'c)/(a/d) sqrt(1 + P/(0.5 sqrt(f'c) A_g)) 0.8 A_g with a/d from 2 to 4, and k
    from 1 at displacement ductilities up to 2 to 0.7 from 6 on.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span a [m].
    axial_load : float
        Compression positive [N]; in large tension the root is zero.
    ductility : float, optional
        Displacement over yield displacement.

    Returns
    -------
    float
        V_n [N].

    Raises
    ------
    InputError
        If the ductility is negative.

    Notes
    -----
    Sezen, Moehle 2004 (ASCE Journal of Structural Engineering 130(11)).
    """
    sizes = shear_sizes(section)
    if not ductility >= 0.0:
        raise InputError(f"shear strength: ductility = {ductility} must not be negative")
    tensile = 0.5 * math.sqrt(sizes.fc / _MPA) * _MPA
    slender = min(max(length / sizes.d, 2.0), 4.0)
    pressed = math.sqrt(max(1.0 + axial_load / (tensile * sizes.gross_area), 0.0))
    v_c = tensile / slender * pressed * 0.8 * sizes.gross_area
    v_s = sizes.tie_area * sizes.tie_yield * sizes.d / sizes.spacing
    return min(max(1.15 - 0.075 * ductility, 0.7), 1.0) * (v_c + v_s)


def shear_failure_drift(section: Section, shear_force: float, axial_load: float) -> float:
    """Return the drift ratio at which a column that has yielded loses its shear strength.

    3/100 + 4 rho'' - v/(40 sqrt(f'c)) - P/(40 A_g f'c) (MPa), not below 1/100, v = V/(b d).

    Parameters
    ----------
    section : Section
        The section.
    shear_force : float
        Largest shear force [N].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    float
        Drift over length.

    Notes
    -----
    Elwood, Moehle 2005 (Earthquake Spectra 21(1)); fitted to rectangular columns with light ties
    that yield in flexure and then fail in shear.
    """
    sizes = shear_sizes(section)
    stress = abs(shear_force) / (sizes.width * sizes.d)
    drift = (
        0.03
        + 4.0 * sizes.tie_ratio
        - stress / _MPA / (40.0 * math.sqrt(sizes.fc / _MPA))
        - axial_load / (40.0 * sizes.gross_area * sizes.fc)
    )
    return max(drift, 0.01)


def axial_failure_drift(section: Section, axial_load: float, angle: float = 65.0) -> float:
    """Return the drift ratio at which a column that has failed in shear loses its axial load.

    Measured drifts are 0.5 to 2.5 times this in eight of ten tests (`axial_failure_interval`).
    (4/100) (1 + tan^2)/(tan + P s/(A_v f_yt d_c tan)) with the tangent of the angle of the shear
    crack and the depth d_c of the core between centre lines of the ties.

    Parameters
    ----------
    section : Section
        The section; without ties the drift is zero under any compression.
    axial_load : float
        Compression positive [N]; tension counts as zero.
    angle : float, optional
        Inclination of the crack to the horizontal [degrees].

    Returns
    -------
    float
        Drift over length.

    Raises
    ------
    InputError
        If the angle is not between 0 and 90 degrees.

    Notes
    -----
    Elwood, Moehle 2005 (ACI Structural Journal 102(4)): friction along the crack.
    """
    drift, halves = axial_failure_law(section, angle)
    load = max(axial_load, 0.0)
    if not halves > 0.0:
        return 0.0 if load > 0.0 else drift
    return drift / (1.0 + load / halves)


AXIAL_FAILURE_FACTORS = (0.5, 2.5)
"""Ends of the 80 % interval of a measured drift at axial failure over that of Elwood and Moehle.

Of rectangular columns of publications that the law has not seen (twins with one drawing differ by a
factor of up to 2.9); `studies/new_tests.py` prints the scatter of the given ones.
"""


def axial_failure_interval(section: Section, axial_load: float) -> tuple[float, float]:
    """Return the ends of the 80 % interval of the drift ratio at axial failure.

    Parameters
    ----------
    section : Section
        The section.
    axial_load : float
        Compression positive [N].

    Returns
    -------
    tuple of float
        `axial_failure_drift` times `AXIAL_FAILURE_FACTORS`.
    """
    drift = axial_failure_drift(section, axial_load)
    low, high = AXIAL_FAILURE_FACTORS
    return low * drift, high * drift


#: Ends of the 80 % interval of the drift at axial failure of round columns over that of ASCE 41,
#: which is a safe one: 1.3 in the mean, 0.2 the standard deviation of the logarithm.
ROUND_AXIAL_FAILURE_FACTORS = (1.0, 1.7)


def round_axial_failure_drift(section: Section, axial_load: float) -> float:
    """Return the drift ratio at which a round column loses its axial load, whatever fails first.

    That at yield and b of ASCE 41-17, table 10-9, 0.65/(5 + P/(0.8 A_g rho f_yt)) - 0.01; with one
    hundredth at yield 0.13/(1 + P/(4 A_g rho f_yt)), P at least 0.1 f'c A_g and
    rho at most 0.0175.

    Parameters
    ----------
    section : Section
        The section.
    axial_load : float
        Compression positive [N].

    Returns
    -------
    float
        Drift over length; infinite without an axial load, for other sections than circles, and with
        ties of less than 0.0005 b s, for which the table does not apply.
    """
    sizes = shear_sizes(section)
    if not isinstance(section, CircularSection) or not axial_load > 0.0 or sizes.tie_ratio < 0.0005:
        return math.inf
    load = max(axial_load, 0.1 * sizes.fc * sizes.gross_area)
    hoops = min(sizes.tie_ratio, 0.0175) * sizes.tie_yield
    return 0.13 / (1.0 + load / (4.0 * sizes.gross_area * hoops))


def axial_failure_law(section: Section, angle: float = 65.0) -> tuple[float, float]:
    """Return `axial_failure_drift` without axial load, and the load [N] that halves it."""
    if not 0.0 < angle < 90.0:
        raise InputError(f"axial failure: angle = {angle} must be between 0 and 90 degrees")
    sizes = shear_sizes(section)
    tangent = math.tan(math.radians(angle))
    ties = sizes.tie_area * sizes.tie_yield * sizes.core_depth / sizes.spacing
    return 0.04 * (1.0 + tangent**2) / tangent, ties * tangent**2
