"""Springs of a column from its section: bilinear in shear, trilinear in flexure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from rbsdem import _arguments, _core
from rbsdem.errors import InputError, warn
from rbsdem.model.shape import Section, checked_section
from rbsdem.model.springs import Bilinear, Takeda, for_whole_column
from rbsdem.section.curvature import Events, axial_load_note, column_length, is_confined, make_point
from rbsdem.section.shear import ShearSpring, closed_form_shear, fit_shear_spring

SHEAR = ("mcft", "closed", "none")
"""Sources of the shear spring."""


@dataclass(frozen=True)
class SectionSprings:
    """Springs of a column, with the points that they were fitted to.

    They are those of a whole column, for one body. `rbsdem.section.column` shares them among the
    joints of several bodies; `rbsdem.Column` refuses them in more than one joint.

    Attributes
    ----------
    section : Section
        The section.
    confined : bool
        Whether its core is confined.
    flexure : rbsdem.springs.Takeda
        Trilinear spring of the hinge.
    shear : rbsdem.springs.Bilinear or None
        Shear spring of the whole length of the column.
    shear_fit : ShearSpring or None
        Points, strength and warnings of the shear spring, if it was read from a shear diagram.
    events : Events
        Cracking (from the diagram with tension stiffening); yielding, peak and ultimate (from that
        without).
    hinge_length : float
        Length that turns a curvature into a rotation [m].
    length, axial_load : float
        Of the column [m], [N].
    d_m : float
        Rotation at which eq 7 of the paper was taken for B_1 [rad].
    notes : tuple of str
        Remarks that a user should know.
    report : str
        These values as a table, in mm, kN and MPa.
    """

    section: Section
    confined: bool
    flexure: Takeda
    shear: Bilinear | None
    shear_fit: ShearSpring | None
    events: Events
    hinge_length: float
    length: float
    axial_load: float
    d_m: float
    notes: tuple[str, ...]
    report: str


def springs(
    section: Section,
    length: float,
    axial_load: float,
    *,
    hinge_length: float | None = None,
    yield_rule: str = "A",
    ultimate: str = "cover",
    eps_yield: float = 0.002,
    eps_cover: float = 0.003,
    confined: bool = False,
    moment_factor: float = 1.0,
    b0: float = 0.4,
    b1: float | None = None,
    d_m: float | None = None,
    shear: str = "mcft",
) -> SectionSprings:
    """Return the springs of a column with this section, from its base to the lateral load.

    Parameters
    ----------
    section : Section
        The section.
    length : float
        From the base to the point of contraflexure, or the lateral load [m].
    axial_load : float
        Compression positive [N].
    hinge_length : float, optional
        Length of the hinge [m]; by default 0.08 L + 0.022 f_y d_b (MPa; Paulay and Priestley 1992,
        without their lower bound).
    yield_rule : {"A", "B", "first"}, optional
        Yield where the first bar in tension yields, without tension stiffening ("A"); with that
        moment, but the curvature at which the diagram with tension stiffening reaches it ("B");
        as "A", or where the extreme fibre in compression is at `eps_yield`, whichever comes first
        ("first"; Priestley, Calvi, Kowalsky 2007): for sections controlled by compression.
    ultimate : {"cover", "mander", "steel", "drop"}, optional
        Ultimate point, see `rbsdem.section.curvature`.
    eps_yield, eps_cover : float, optional
        Strains of the extreme fibre, compression positive.
    confined : bool, optional
        Whether the core is confined and the cover spalls.
    moment_factor : float, optional
        Factor of M_y and M_u for the shear that acts with the moment; a coupled analysis of the
        paper's columns gives 0.95.
    b0 : float, optional
        Exponent B_0 of the unloading stiffness.
    b1 : float, optional
        Factor B_1 of the inner unloading stiffness, a share of K_c. By default from eq 7 of the
        paper at the rotation `d_m`.
    d_m : float, optional
        Rotation for eq 7 [rad]; by default the ultimate one.
    shear : {"mcft", "closed", "none"}, optional
        Shear spring from the shear diagram of the section with V = M/L (modified compression field
        theory), from the closed form (without stiffness after yield), or none.

    Returns
    -------
    SectionSprings
        The springs, the events, a report.

    Raises
    ------
    InputError
        If a value is refused, or the section has no trilinear line.

    Warns
    -----
    AccuracyWarning
        If the moment falls after yield (K_u is then zero), shear governs, or the section is not
        symmetric.
    """
    checked_section(section)
    shear = _arguments.choice(shear, "springs: shear", SHEAR)
    confined = is_confined(section, confined)
    axial_load = _arguments.number(axial_load, "axial_load")
    hinge = hinge_length
    if hinge is not None and _arguments.number(hinge, "springs: hinge_length") > length:
        raise InputError(
            f"springs: hinge_length = {hinge:g} m is longer than the column, length = {length:g} m"
        )
    length = column_length(length, "springs: length")
    numbers = {"length": length, "axial_load": axial_load, "hinge_length": hinge_length}
    numbers |= {"moment_factor": moment_factor, "b0": b0, "d_m": d_m}
    numbers |= {"eps_yield": eps_yield, "eps_cover": eps_cover}
    settings = {
        name: None if value is None else _arguments.number(value, f"springs: {name}")
        for name, value in numbers.items()
    }
    words = {"yield_rule": yield_rule, "ultimate": ultimate}
    given = _core.group("springs", settings | words | {"confined": confined})
    answer = _core.evaluate("section_flexure", section._statement + given)
    found = _core.named("spring", answer.values)
    notes = []
    note = axial_load_note(axial_load, section)
    if note:
        notes.append(f"springs: {note}")
    if not section.symmetric:
        notes.append(
            "springs: the section is not symmetric; both directions have the springs of y > 0 in "
            "tension (`section.mirrored` has those of the other)"
        )
    if found["k_u_found"] < 0.0:
        notes.append(
            f"K_u = {found['k_u_found']:.4g} N m/rad: the moment falls from yield to the ultimate "
            "point; the spring has K_u = 0"
        )
    values: Any = {name: found[name] for name in ("k_c", "d_c", "k_y", "d_y", "k_u", "b0")}
    values["b1"] = found["b1"] if b1 is None else b1
    flexure = for_whole_column(Takeda(**values), "flexure")
    events = Events(*map(make_point, answer.rows))
    cracking, end = events.cracking, events.ultimate
    spring, shear_fit = None, None
    if shear == "mcft":
        assert end is not None
        shear_fit = fit_shear_spring(section, length, axial_load, end.curvature, confined=confined)
        spring = shear_fit.spring
        notes += shear_fit.notes
    elif shear == "closed":
        assert cracking is not None
        spring = Bilinear(*closed_form_shear(section, length, cracking.moment), k_post=0.0)
    if spring is not None:
        for_whole_column(spring, "shear")
    for note in notes:
        warn(note)
    parts = flexure, spring, shear_fit, events
    sizes = found["hinge_length"], length, axial_load, found["d_m"]
    made = SectionSprings(section, confined, *parts, *sizes, tuple(notes), "")
    object.__setattr__(made, "report", _report(section, made))
    return made


def _report(section: Section, springs: SectionSprings) -> str:
    """Return the table of the springs, of their points and of the data behind them."""
    law = section.concrete_law
    load, f = springs.axial_load, springs.flexure
    share = load / (law["fc"] * section.gross_area)
    lines = [
        f"{section.shape} {1e3 * section.width:.0f} x {1e3 * section.depth:.0f} mm, "
        f"{len(section.bars)} bars ({100 * section.steel_ratio:.2f} %), "
        f"f'c {law['fc'] / 1e6:.1f} MPa",
        f"length {1e3 * springs.length:.0f} mm, axial load {load / 1e3:.0f} kN "
        f"({share:.3f} of f'c A), hinge {1e3 * springs.hinge_length:.0f} mm",
        "",
        f"{'point':<12}{'curvature':>14}{'moment':>12}{'rotation':>12}",
        f"{'':<12}{'mrad/m':>14}{'kN m':>12}{'mrad':>12}",
    ]
    for name in ("cracking", "yielding", "peak", "ultimate"):
        point = getattr(springs.events, name)
        if point is None or not math.isfinite(point.moment):
            continue
        rotation = 1e3 * point.curvature * springs.hinge_length
        lines.append(
            f"{name:<12}{1e3 * point.curvature:>14.3f}{point.moment / 1e3:>12.1f}{rotation:>12.3f}"
        )
    lines += [
        "",
        f"flexure  K_c {f.k_c:.4e}  D_c {f.d_c:.4e}  K_y {f.k_y:.4e}  D_y {f.d_y:.4e}  "
        f"K_u {f.k_u:.4e}  (N m/rad, rad)",
        f"         B_0 {f.b0:.3f}  B_1 {f.b1:.3f} (eq 7 at {1e3 * springs.d_m:.2f} mrad)",
    ]
    if springs.shear is not None:
        v = springs.shear
        lines.append(f"shear    K_y {v.k:.4e}  D_y {v.d_y:.4e}  K_u {v.k_post:.4e}  (N/m, m)")
    if springs.shear_fit is not None and springs.events.ultimate is not None:
        lines.append(
            f"         strength {springs.shear_fit.strength / 1e3:.0f} kN, flexure "
            f"{springs.events.ultimate.moment / springs.length / 1e3:.0f} kN"
        )
    lines += [f"note: {note}" for note in springs.notes]
    return "\n".join(lines)
