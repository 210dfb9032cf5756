"""Shear strength of a column, and the drift at which shear and axial load are lost.

Published relations with their sources; SI throughout. The empirical ones are written by their
authors in MPa, N and mm. Depth d is from the compression face to the centre of the bars in the half
in tension, and 0.8 of the diameter for circles (ACI 318-19, 22.5.2.2).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from rbsdem.errors import InputError
from rbsdem.model.shape import Section
from rbsdem.section.curvature import carried_load, checked_load, column_length

_MPA = 1.0e6
# Share of the least ties from which on the crack spacing goes over to that of tied sections.
_NEARLY = 0.9
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
        whole = width * depth if section.shape == "tee" else section.gross_area
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
    return shear_strength_mcft(section, length, load)


def shear_strength_mcft(
    section: Section, length: float, axial_load: float, aggregate: float = 0.019, arch: float = 1.0
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

    Returns
    -------
    float
        V_n [N], at most 0.25 f'c b z.

    Raises
    ------
    InputError
        If the length is not positive.

    Notes
    -----
    Bentz, Vecchio, Collins 2006 (ACI Structural Journal 103(4)). With ties of at least
    0.06 sqrt(f'c)/f_yt the crack spacing s_ze is 300 mm, else 35 z/(16 + aggregate) >= 0.85 z (mm);
    from 0.9 of those ties on it goes from one to the other in a straight line.
    """
    sizes = shear_sizes(section)
    span = column_length(length, "length")
    if not section.bars:
        return 0.0
    z = 0.9 * sizes.d
    root = min(math.sqrt(sizes.fc / _MPA), 8.0)
    least = _least_ties(sizes)
    s_ze = max(35.0 * z * 1e3 / (16.0 + aggregate * 1e3), 0.85 * z * 1e3)
    tied = min(max((sizes.tie_ratio / least - _NEARLY) / (1.0 - _NEARLY), 0.0), 1.0)
    s_ze += tied * (300.0 - s_ze)
    arm = max(span - sizes.d, sizes.d)
    d, width, pressed = sizes.d, sizes.width, 0.5 * axial_load
    # The strength has a limit where bars in tension vanish.
    steel = 2.0 * _ES * max(sizes.tension_steel, 1e-9 * sizes.gross_area)
    size, turn = 1000.0 + s_ze, 0.88 + s_ze / 2500.0
    pull, spacing = sizes.tie_area * sizes.tie_yield * z, sizes.spacing
    crushed = 0.25 * sizes.fc * width * z

    def strength(v: float) -> float:
        eps_x = max((v * arm / d + v - pressed) / steel, 0.0)
        beta = 0.4 / (1.0 + 1500.0 * eps_x) * 1300.0 / size
        theta = math.radians(min((29.0 + 7000.0 * eps_x) * turn, 75.0))
        v_c = arch * beta * root * _MPA * width * z
        return min(v_c + pull / (math.tan(theta) * spacing), crushed)

    # More shear opens the cracks: strength(v) falls, so there is one v that equals it.
    return _crossing(strength, strength(0.0))


def _least_ties(sizes: ShearSizes) -> float:
    """Return the least ratio of ties, 0.06 sqrt(f'c)/f_yt (MPa), sqrt(f'c) up to 8 MPa."""
    if not sizes.tie_yield > 0.0:
        return math.inf
    return 0.06 * min(math.sqrt(sizes.fc / _MPA), 8.0) * _MPA / sizes.tie_yield


def arch_factor(section: Section, length: float, axial_load: float) -> float:
    """Return by how much the concrete of a squat column carries more than a theory of sections has.

    1 + (k - 1) k_n k_t with k = 4 d/a from 1 to 4: part of the force goes straight to the support
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

    Returns
    -------
    float
        1 to 4.

    Notes
    -----
    d/a as in the V_c of Sezen and Moehle (2004), down to a = d; the strengths of struts with and
    without ties are those of ACI 318-19, table 23.4.3. k_n was chosen on the tests of the fit:
    squat columns with axial load are as strong as by the theory of sections.
    """
    sizes = shear_sizes(section)
    squat = min(max(4.0 * sizes.d / length, 1.0), 4.0)
    free = min(max(1.0 - 2.0 * axial_load / (sizes.fc * sizes.gross_area), 0.0), 1.0)
    tied = min(sizes.tie_ratio / _least_ties(sizes), 1.0)
    return 1.0 + (squat - 1.0) * free * (_SPLITS + (1.0 - _SPLITS) * tied)


def axial_strut(section: Section, length: float, axial_load: float) -> float:
    """Return the shear that the axial load carries, by its strut from the load to the foot [N].

    P (h - c)/(2 a), c = (0.2 + 0.65 n) h the depth of the compression zone, about.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        Shear span a [m].
    axial_load : float
        Compression positive [N]; none under tension.

    Notes
    -----
    Priestley, Verma and Xiao 1994; Kowalsky and Priestley 2000: neither ductility nor cycles take
    it away.
    """
    ratio = axial_load / (section.concrete_law["fc"] * section.gross_area)
    arm = section.depth * max(0.8 - 0.65 * ratio, 0.0)
    return max(axial_load, 0.0) * arm / (2.0 * length)


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
    stress = max(steel.fy for _, _, steel in section.bars) / _MPA
    root = math.sqrt(section.concrete.fc / _MPA)
    return stress * (section.bar_diameter or 0.0) / (10.0 * root * length)


def _crossing(falling: Callable[[float], float], most: float) -> float:
    """Return where a falling function equals its argument, from 0 to `most`, to the last digit."""
    low, high = 0.0, most
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
        If the length is not positive or the ductility negative.

    Notes
    -----
    Sezen, Moehle 2004 (ASCE Journal of Structural Engineering 130(11)).
    """
    sizes = shear_sizes(section)
    span = column_length(length, "length")
    if not ductility >= 0.0:
        raise InputError(f"shear strength: ductility = {ductility} must not be negative")
    tensile = 0.5 * math.sqrt(sizes.fc / _MPA) * _MPA
    slender = min(max(span / sizes.d, 2.0), 4.0)
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


def axial_failure_law(section: Section, angle: float = 65.0) -> tuple[float, float]:
    """Return `axial_failure_drift` without axial load, and the load [N] that halves it."""
    if not 0.0 < angle < 90.0:
        raise InputError(f"axial failure: angle = {angle} must be between 0 and 90 degrees")
    sizes = shear_sizes(section)
    tangent = math.tan(math.radians(angle))
    ties = sizes.tie_area * sizes.tie_yield * sizes.core_depth / sizes.spacing
    return 0.04 * (1.0 + tangent**2) / tangent, ties * tangent**2
