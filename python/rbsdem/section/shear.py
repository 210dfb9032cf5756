"""Shear of a section and of a column: the diagram of a section, and both kinds of shear spring.

The diagram: the section bends under a constant axial load with V = M/L; each of its layers is a
cracked membrane of the modified compression field theory (Vecchio and Collins 1986). It has a knee
where the secant has fallen to 0.48 of the uncracked stiffness (E_c/2) A.

The bilinear spring of the paper goes through that knee and through an end point at the ultimate
curvature of the flexural spring (`fit_shear_spring`).

The spring of the layered model cracks, yields its ties, fails and pinches (`shear_spring`). Its
lines up to the largest force are published relations; what comes behind them, and the pinching, are
parameters fitted to tests (`ModelParameters`). It needs no decision whether a column is critical in
shear: one that yields in flexure first never leaves the lines before yield.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import Tabular
from rbsdem._package import unwarned
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.model.materials import Tension
from rbsdem.model.shape import Section, checked_section
from rbsdem.model.springs import Bilinear, Pinching, unchecked
from rbsdem.section.curvature import checked_furthest, checked_load, column_length, is_confined
from rbsdem.section.hinge import HingeJoint
from rbsdem.section.parameters import ModelParameters
from rbsdem.section.strength import (
    SQUAT,
    axial_failure_drift,
    axial_strut,
    bond_demand,
    column_shear_strength,
    shear_sizes,
    shear_strength_mcft,
    shear_strength_sezen,
    wall_shear_strength,
)

KNEE = 0.48
"""Share of (E_c/2) A of the secant at the knee: calibrated on the four columns of table 3 of the
paper, whose shear springs have 0.41 to 0.53."""

#: Last curvature of a diagram by default, as strain over the depth.
_FURTHEST = 0.012


#: Points of a diagram; each is a state of all layers.
MOST_POINTS = 100_000


@dataclass(frozen=True, slots=True)
class ShearPoint:
    """A point of the diagram.

    Attributes
    ----------
    curvature : float
        [1/m].
    moment : float
        About mid-depth [N m].
    force : float
        Shear force, moment over length [N].
    strain : float
        Mean shear strain of the section.
    """

    curvature: float
    moment: float
    force: float
    strain: float


@dataclass(frozen=True, slots=True, eq=False)
class ShearLayers:
    """State of the layers at the last point of a diagram, from the compression face on.

    Attributes
    ----------
    y : ndarray, shape (n,)
        From mid-depth [m].
    eps_x, eps_z : ndarray, shape (n,)
        Longitudinal and transverse strain, tension positive.
    tau : ndarray, shape (n,)
        Shear stress [Pa].
    gamma : ndarray, shape (n,)
        Shear strain.
    """

    y: Array
    eps_x: Array
    tau: Array
    gamma: Array
    eps_z: Array


@dataclass(frozen=True, repr=False, eq=False)
class ShearDiagram(Tabular):
    """Shear force against mean shear strain under a constant axial load.

    Attributes
    ----------
    section : Section
        The section.
    length : float
        Shear span M/V [m].
    axial_load : float
        Compression positive [N].
    curvature, moment, force, strain : ndarray, shape (n,)
        The points: curvature [1/m], moment [N m], shear force [N], shear strain.
    knee : ShearPoint or None
        Where the secant has fallen to the given share; None if it stays above.
    end : ShearPoint
        The last point.
    sheared : bool
        Whether the diagram ends because a layer no longer carries the shear.
    lost : bool
        Whether it ends because the section no longer carries the axial load.
    layers : ShearLayers
        The layers at the last point.
    """

    _columns = ("strain", "force N", "curvature 1/m", "moment Nm")

    section: Section
    length: float
    axial_load: float
    curvature: Array
    moment: Array
    force: Array
    strain: Array
    knee: ShearPoint | None
    end: ShearPoint
    sheared: bool
    lost: bool
    layers: ShearLayers = field(repr=False)

    @property
    def stiffness(self) -> float:
        """Shear force over strain of the uncracked concrete, (E_c/2) A [N]."""
        return 0.5 * self.section.concrete_law["ec"] * self.section.gross_area


def shear_diagram(
    section: Section,
    length: float,
    axial_load: float,
    curvature: ArrayLike | None = None,
    *,
    furthest: float | None = None,
    points: int = 60,
    tension: Tension = "ts",
    confined: bool = False,
    coupled: bool = False,
    layers: int = 80,
    knee: float = KNEE,
) -> ShearDiagram:
    """Return shear force and shear strain of a section that bends with V = M/length.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span M/V: from the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    curvature : array_like, shape (n,), optional
        Positive, increasing curvatures [1/m]. By default `points` curvatures up to `furthest`,
        closer together at the beginning.
    furthest : float, optional
        Last curvature [1/m]; by default 0.012 over the depth.
    points : int, optional
        Number of points if no curvatures are given.
    tension : {"ts", "bare", "zero"}, optional
        Tension law of the concrete.
    confined : bool, optional
        Whether the core is confined.
    coupled : bool, optional
        Whether the shear changes the longitudinal stresses and so the moment: layers, axial load
        and shear are then solved together. Otherwise the moment is that of the section in flexure.
    layers : int, optional
        Layers over the depth.
    knee : float, optional
        Share of (E_c/2) A at the knee, between 0 and 1.

    Returns
    -------
    ShearDiagram
        The diagram, as far as the section carries axial load and shear.

    Raises
    ------
    InputError
        If a value is refused, or the section has a flange or cannot carry the axial load.
    """
    if checked_section(section).shape == "tee":
        raise InputError("shear diagram: the wings of a flange carry no shear; give the web alone")
    if curvature is None:
        points = _arguments.integer(points, "points", least=2, most=MOST_POINTS)
        last = _FURTHEST / section.depth
        if furthest is not None:
            last = checked_furthest(furthest, section)
        path = last * np.linspace(0.0, 1.0, points + 1)[1:] ** 2
    else:
        path = _arguments.finite_vector(curvature, "curvature")
        if path.size and np.max(path) * section.depth > 1.0:
            raise InputError(
                f"curvature: {np.max(path)} 1/m makes strains above 1 over the depth; curvatures "
                f"are in 1/m: 10 mrad/m is 0.01"
            )
    load = checked_load(section, axial_load)
    span = column_length(length, "length")
    settings = {
        "length": span,
        "axial_load": load,
        "tension": tension,
        "confined": is_confined(section, confined),
        "coupled": _arguments.boolean(coupled, "coupled"),
        "layers": _arguments.integer(layers, "layers"),
        "knee": _arguments.number(knee, "knee"),
    }
    asked = section._statement + _core.group("shear", settings)
    answer = _core.evaluate("section_shear", asked, curvature=path)
    *rows, at_knee, at_end = (_core.named("shear", row) for row in answer.rows)
    knee, sheared, lost = (bool(event) for event in answer.values[:3])
    names = _core.section_quantities()["profile"]
    profile = answer.values[3:].reshape(len(names), -1)
    cut = ShearLayers(**dict(zip(names, profile, strict=True)))
    curves: Any = {name: np.array([row[name] for row in rows]) for name in at_end}
    curves |= {"knee": ShearPoint(**at_knee) if knee else None, "end": ShearPoint(**at_end)}
    return ShearDiagram(section, span, load, **curves, sheared=sheared, lost=lost, layers=cut)


# ---- the bilinear spring of the paper ----------------------------------------------------------

CLOSED_FORM_FORCE = 1.86
"""Force at the knee over that of flexural cracking, M_c/L: calibrated on the four columns of
table 3 of the paper."""

#: If the force at the end of the diagram is below this share of the peak, the peak is taken.
_FALLEN = 0.95


@dataclass(frozen=True)
class ShearSpring:
    """The bilinear shear spring of a column, with the points that it was fitted to.

    Attributes
    ----------
    spring : Bilinear
        Stiffness [N/m], yield slip [m], stiffness after yield [N/m].
    knee, end : ShearPoint
        The two points of the diagram through which its lines pass.
    strength : float
        Shear strength V_n by the simplified modified compression field theory [N].
    k_post_found : float
        Stiffness after yield before it was raised to zero or held below the first one [N/m].
    governs : bool
        Whether shear fails before the end point in flexure.
    warnings : tuple of str
        Remarks that a user should know.
    """

    spring: Bilinear
    knee: ShearPoint
    end: ShearPoint
    strength: float
    k_post_found: float
    governs: bool
    warnings: tuple[str, ...]


def fit_shear_spring(
    section: Section, length: float, axial_load: float, ultimate_curvature: float, **options: Any
) -> ShearSpring:
    """Fit the bilinear shear spring of a column with V = M/length.

    Slip is shear strain times length. The line passes through the knee of the diagram and through
    its point at the ultimate curvature, or at the shear strength if that is reached before, or at
    the peak if the moment has fallen by more than 5 per cent: beyond that the shear flow of the
    layers is no longer meaningful.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the lateral load [m].
    axial_load : float
        Compression positive [N].
    ultimate_curvature : float
        Curvature of the ultimate point of the flexural spring [1/m].
    **options
        As for `shear_diagram`: points, tension, confined, coupled, layers, knee.

    Returns
    -------
    ShearSpring
        The spring, its points, and remarks.

    Raises
    ------
    InputError
        If a value is refused, or the section carries no shear.
    """
    with unwarned():
        # Who asks for springs is told of an odd axial load once.
        diagram = shear_diagram(section, length, axial_load, furthest=ultimate_curvature, **options)
    strength = shear_strength_mcft(section, length, axial_load)
    warnings = []
    end = _at_force(diagram, strength)
    governs = end is not None or diagram.sheared
    if end is not None:
        warnings.append(
            f"shear governs: its strength of {strength:.4g} N is below the "
            f"{diagram.force.max():.4g} N of flexure; the spring goes through it"
        )
    elif diagram.sheared:
        warnings.append(
            f"shear governs: a layer carries no more at {diagram.end.force:.4g} N, before the "
            f"ultimate curvature"
        )
    elif diagram.lost:
        warnings.append("shear spring: the axial load is lost before the ultimate curvature")
    end = end or _last_useful(diagram)
    if not end.strain > 0.0:
        raise InputError(
            "shear spring: the section carries no shear; check its concrete, the axial load and "
            "the length"
        )
    knee = diagram.knee
    if knee is None or knee.strain >= end.strain:
        warnings.append(
            "shear spring: no knee before its end point; one line to there, and no stiffness beyond"
        )
        knee, k_post = end, 0.0
    else:
        k_post = (end.force - knee.force) / ((end.strain - knee.strain) * length)
    k = knee.force / (knee.strain * length)
    if k_post < 0.0:
        warnings.append(
            f"shear spring: the stiffness after yield, {k_post:.4g} N/m, is negative; zero is taken"
        )
    spring = Bilinear(k=k, d_y=knee.strain * length, k_post=min(max(k_post, 0.0), 0.99 * k))
    return ShearSpring(spring, knee, end, strength, k_post, governs, tuple(warnings))


def closed_form_shear(
    section: Section, length: float, cracking_moment: float, knee: float = KNEE
) -> tuple[float, float]:
    """Return stiffness and yield slip of the shear spring without an analysis in shear.

    K_y = knee E_c A/(2 L), V_y = 1.86 M_c/L; both constants are calibrated on the four columns of
    the paper only. The stiffness after yield has no such closed form.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the lateral load [m].
    cracking_moment : float
        Of the section under its axial load [N m].
    knee : float, optional
        Share of (E_c/2) A.

    Returns
    -------
    k : float
        Stiffness [N/m].
    d_y : float
        Yield slip [m].

    Raises
    ------
    InputError
        If a value is not positive.
    """
    for name, value in (("length", length), ("cracking_moment", cracking_moment), ("knee", knee)):
        _arguments.number(value, f"closed form of shear: {name}", above=0)
    k = knee * 0.5 * section.concrete_law["ec"] * section.gross_area / length
    return k, CLOSED_FORM_FORCE * cracking_moment / length / k


def _last_useful(diagram: ShearDiagram) -> ShearPoint:
    """Return the end of the diagram, or its peak if the force has fallen well below that."""
    if not diagram.force.size or diagram.end.force >= _FALLEN * diagram.force.max():
        return diagram.end
    peak = int(np.argmax(diagram.force))
    return ShearPoint(*_rows(diagram)[:, peak].tolist())


def _rows(diagram: ShearDiagram) -> Array:
    """Return the values of `ShearPoint` along a diagram, in its order, shape (4, points)."""
    return np.vstack([getattr(diagram, name) for name in ShearPoint.__dataclass_fields__])


def _at_force(diagram: ShearDiagram, force: float) -> ShearPoint | None:
    """Return the first point of the diagram at a force; None if it stays below."""
    reached = np.flatnonzero(diagram.force >= force)
    if not reached.size:
        return None
    i = int(reached[0])
    rows = _rows(diagram)
    first = np.zeros(4) if i == 0 else rows[:, i - 1]
    share = (force - first[2]) / (rows[2, i] - first[2])
    return ShearPoint(*(first + share * (rows[:, i] - first)).tolist())


# ---- the spring of the layered model -----------------------------------------------------------

_ES = 200e9

# Cracked stiffness without ties, and cracking force under tension: shares of the uncracked
# stiffness and of the yield force that keep the lines of the spring apart.
_LEAST = 0.01

# Ties of a circle over those of a rectangle: pi/4 cot 30 (Kowalsky and Priestley 2000).
_CIRCLE = 0.25 * math.pi * math.sqrt(3.0)
# Twice the ties over the strength, below which fewer of them change nothing more.
_FEWEST = 0.1
# Bond demand that is usual in tests, and the least share of it that counts.
_USUAL_BOND, _LEAST_BOND = 0.12, 0.2
# Largest force over that at yield: on a level line with second-order effects nothing would hold.
_RISES = 1.02
# Slip from the largest force to none: over the length, and at least this times what the elastic
# column above springs back by; what falls faster than that has no equilibrium.
_SHORTEST_FALL, _LONGEST_FALL, _SPRINGS_BACK = 0.05, 20.0, 2.0


def cracked_shear_stiffness(section: Section) -> float:
    """Return the shear stiffness of the truss of ties and concrete struts at 45 degrees.

    Parameters
    ----------
    section : Section
        The section.

    Returns
    -------
    float
        rho_v/(1 + 4 n rho_v) E_s b d, shear force over shear strain [N].

    Notes
    -----
    Park and Paulay (1975), Reinforced Concrete Structures, 7.5.
    """
    sizes = shear_sizes(section)
    ratio = sizes.tie_ratio
    modular = _ES / section.concrete_law["ec"]
    return ratio / (1 + 4 * modular * ratio) * _ES * sizes.width * sizes.d


def shear_spring(
    section: Section,
    length: float,
    axial_load: float,
    stiffness: float,
    model: ModelParameters,
    joint: HingeJoint | None = None,
    *,
    spans: tuple[float, float] | None = None,
) -> tuple[Pinching, dict[str, tuple[float, float]]]:
    """Make the shear spring of a column.

    Parameters
    ----------
    section : Section
        The section at the foot.
    length : float
        From the foot to the lateral load [m].
    axial_load : float
        Compression positive [N].
    stiffness : float
        Shear stiffness before cracking, force over strain [N].
    model : ModelParameters
        Parameters of the model.
    joint : HingeJoint, optional
        The hinge, with whose work the strength decays; without it the strength does not.
    spans : tuple of float, optional
        Shear spans M/V with y > 0 in tension and in compression [m]; by default `length`.

    Returns
    -------
    Pinching
        Of the slip of the whole length: cracks at the share V_c of the concrete by Sezen and Moehle
        (2004), which is that of a principal tension; then has `cracked_shear_stiffness`, of a
        column for what the strut of the axial load does not carry; yields
        near `rbsdem.section.strength.column_shear_strength`, of a wall near
        `rbsdem.section.strength.wall_shear_strength`; loses its force by the drift at axial
        failure of Elwood and Moehle (2005). A section that is not symmetric
        has a negative side of its own, that of the section upside down.
    dict of str to (float, float)
        Least and largest values of parameters, beyond which they would change nothing.

    Raises
    ------
    InputError
        If the length is not positive.
    """
    first, second = spans or (length, length)
    drawn = [(section, first)]
    if first != second or not section.symmetric:
        drawn = [(section, first), (section.mirrored, second)]
    sides = [_side(each, length, span, axial_load, stiffness, model) for each, span in drawn]
    span = 0.5 * (first + second)
    lines = {**sides[0].line}
    for side in sides[1:]:
        lines |= {f"{name}_neg": value for name, value in side.line.items()}
    # Wear is the same for both sides: it is that of their means, in units of f_y d_y.
    unit = sum(side.line["f_y"] * side.line["d_y"] for side in sides) / len(sides)
    f_y = sum(side.line["f_y"] for side in sides) / len(sides)
    ties = sum(side.ties for side in sides) / len(sides)
    lambda_s = 0.0
    if model.shear_endurance > 0.0:
        # Few ties do not hold a crack together, and bars that slip split the cover.
        lasts = min(1.0, max(2.0 * ties / f_y, _FEWEST) ** 2)
        lasts /= max(bond_demand(section, span) / _USUAL_BOND, _LEAST_BOND)
        soonest = max(side.fastest for side in sides) / (stiffness / length * unit)
        # In the slip that the ties would have if they carried the strut, too.
        lasts *= sum(side.worn for side in sides) / sum(side.line["d_y"] for side in sides)
        lambda_s = least_endurance(model.shear_endurance * lasts, soonest)
    lambda_h = s_min = 0.0
    if joint is not None and model.shear_decay > 0.0:
        lambda_h = joint.yield_work / model.shear_decay / unit
        strut = sum(side.strut for side in sides) / len(sides)
        crushed = model.shear_decay_strut * sum(side.crushed for side in sides) / len(sides)
        s_min = min(0.95, (model.shear_decay_ties * ties + strut) / f_y, crushed / f_y)
    limits = {
        name: (min(s.limits[name][0] for s in sides), max(s.limits[name][1] for s in sides))
        for name in sides[0].limits
    }
    spring = unchecked(
        Pinching,
        **lines,
        lambda_s=lambda_s,
        lambda_h=lambda_h,
        s_min=s_min,
        fade=2.0,
        b0=model.shear_b0,
        kappa_f=min(model.shear_pinch_force, 1.0),
        kappa_d=model.shear_pinch_slip,
    )
    return spring, limits


def least_endurance(endurance: float, soonest: float) -> float:
    """Return the energy that halves a strength, not less than the rule of the spring takes.

    Parameters
    ----------
    endurance : float
        Over yield force times yield deformation.
    soonest : float
        f_cap^2 (1 + d_cap/d_pc) over initial stiffness, likewise: below it the strength would fall
        faster than the spring is stiff.
    """
    return max(endurance, 1.01 * soonest)


@dataclass(frozen=True)
class _Side:
    """The spring in one direction of loading.

    Attributes
    ----------
    line : dict of str to float
        The backbone, by the names of `Pinching`.
    ties, strut, crushed : float
        What the ties carry, and the strut of the axial load; f'c b d [N].
    worn : float
        Slip at yield if the ties carried the strut, too [m].
    fastest : float
        f_cap^2 (1 + d_cap/d_pc) [N2], which bounds how fast the strength may fall.
    limits : dict of str to (float, float)
        Least and largest values of parameters.
    """

    line: dict[str, float]
    ties: float
    strut: float
    crushed: float
    worn: float
    fastest: float
    limits: dict[str, tuple[float, float]]


def _side(
    section: Section,
    length: float,
    span: float,
    axial_load: float,
    stiffness: float,
    model: ModelParameters,
) -> _Side:
    """Return the shear spring of a length with y > 0 in tension; `span` is M/V for its strength."""
    sizes = shear_sizes(section)
    wall = section.shape == "wall"
    strut = axial_strut(section, span, axial_load, shortest=0.0 if wall else SQUAT)
    if wall:
        constants = {"begins": model.shear_wall_arch, "strut": model.shear_wall_strut}
        by_theory = wall_shear_strength(section, span, axial_load, **constants)
    else:
        by_theory = column_shear_strength(section, span, axial_load)
    # A section without bars in tension, which has no strength, still needs a spring with one.
    least = 1e-4 * sizes.fc * sizes.gross_area
    f_y = max(model.shear_strength * by_theory, least)
    by_ties = sizes.tie_area * sizes.tie_yield * sizes.d / sizes.spacing
    by_concrete = shear_strength_sezen(section, span, axial_load) - by_ties
    f_c = min(max(by_concrete, _LEAST * f_y), 0.9 * f_y)
    whole = stiffness / length
    cracked = cracked_shear_stiffness(section) / length
    cracked = min(max(cracked, _LEAST * whole), 0.9 * whole)
    d_c = f_c / whole
    # Cracks open with what the ties carry; in a column the strut of the axial load needs none.
    rise, strutted = f_y - f_c, 0.0 if wall else model.shear_strength * strut
    slip = max((rise - strutted) / cracked, rise / (0.9 * whole))
    d_y = d_c + slip
    f_cap = _RISES * f_y
    # Behind yield it may not go up steeper than before.
    least_rise = 1.01 * (f_cap - f_y) / rise * slip
    d_cap = d_y + max(model.shear_cap * length, least_rise)
    # No force is left where the column loses its axial load, and with it the friction in the crack.
    lost = axial_failure_drift(section, axial_load) * length
    above = f_cap * length**3 / (3 * section.concrete_law["ec"] * section.inertia)
    shortest = max(_SHORTEST_FALL * length, _SPRINGS_BACK * above)
    d_pc = min(max(lost - d_cap, shortest), max(_LONGEST_FALL * length, shortest))
    line = {"d_c": d_c, "f_c": f_c, "d_y": d_y, "f_y": f_y, "d_cap": d_cap, "f_cap": f_cap}
    is_round = section.ties is not None and section.ties.is_round
    return _Side(
        line=line | {"d_pc": d_pc},
        ties=(_CIRCLE if is_round else 1.0) * by_ties,
        strut=strut,
        crushed=sizes.fc * sizes.width * sizes.d,
        worn=d_c + rise / cracked,
        fastest=f_cap**2 * (1.0 + d_cap / d_pc),
        limits={
            "shear_strength": (least / by_theory if by_theory > 0.0 else 0.0, math.inf),
            "shear_cap": (least_rise / length, math.inf),
            "shear_endurance": (0.0, math.inf),
            "shear_pinch_force": (0.0, 1.0),
        },
    )
