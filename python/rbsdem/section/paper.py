"""The paper: springs of a section by its rules, and the tables of its four tested columns.

The values are read from `data/paper_table_2.csv` and `data/paper_table_3.csv`, which have them as
printed, and are converted to SI.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from rbsdem import _arguments, _core, _package
from rbsdem._files import data_frame, text_table
from rbsdem.errors import InputError, warn
from rbsdem.model.column import Column, Kinematics, notes_off
from rbsdem.model.materials import CONCRETE_DENSITY, Concrete, Layout, Steel, Ties
from rbsdem.model.shape import RectangularSection, Section, checked_section
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
    warnings : tuple of str
        Remarks that a user should know.
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
    warnings: tuple[str, ...]

    @property
    def report(self) -> str:
        """Springs, points and the data behind them as a text."""
        load, length, f = self.axial_load, self.length, self.flexure
        share = load / (self.section.concrete_law["fc"] * self.section.gross_area)
        hinge, axial = f"hinge {1e3 * self.hinge_length:.0f} mm", f"axial load {load / 1e3:.0f} kN"
        points = {name: getattr(self.events, name) for name in Events.__dataclass_fields__}
        rows = [
            (name, 1e3 * p.curvature, p.moment / 1e3, 1e3 * p.curvature * self.hinge_length)
            for name, p in points.items()
            if p is not None and math.isfinite(p.moment)
        ]
        names = ("point", "curvature mrad/m", "moment kN m", "rotation mrad")
        lines = [
            str(self.section),
            f"length {1e3 * length:.0f} mm, {axial} ({share:.3f} of f'c A), {hinge}",
            f"\n{text_table(data_frame(rows, names))}\n",
            f"flexure  K_c {f.k_c:.4e}  D_c {f.d_c:.4e}  K_y {f.k_y:.4e}  D_y {f.d_y:.4e}  "
            f"K_u {f.k_u:.4e}  (N m/rad, rad)",
            f"         B_0 {f.b0:.3f}  B_1 {f.b1:.3f} (eq 7 at {1e3 * self.d_m:.2f} mrad)",
        ]
        if (v := self.shear) is not None:
            lines.append(f"shear    K_y {v.k:.4e}  D_y {v.d_y:.4e}  K_u {v.k_post:.4e}  (N/m, m)")
        if self.shear_fit is not None and self.events.ultimate is not None:
            of_flexure = self.events.ultimate.moment / length / 1e3
            strength = self.shear_fit.strength / 1e3
            lines.append(f"         strength {strength:.0f} kN, flexure {of_flexure:.0f} kN")
        return "\n".join([*lines, *(f"note: {warning}" for warning in self.warnings)])


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
    warnings = []
    warning = axial_load_note(axial_load, section)
    if warning:
        warnings.append(f"springs: {warning}")
    if not section.symmetric:
        warnings.append(
            "springs: the section is not symmetric; both directions have the springs of y > 0 in "
            "tension (`section.mirrored` has those of the other)"
        )
    if found["k_u_found"] < 0.0:
        warnings.append(
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
        warnings += shear_fit.warnings
    elif shear == "closed":
        assert cracking is not None
        spring = Bilinear(*closed_form_shear(section, length, cracking.moment), k_post=0.0)
    if spring is not None:
        for_whole_column(spring, "shear")
    for warning in warnings:
        warn(warning)
    parts = flexure, spring, shear_fit, events
    sizes = found["hinge_length"], length, axial_load, found["d_m"]
    return SectionSprings(section, confined, *parts, *sizes, tuple(warnings))


KEYS = ("soesianawati_1", "tanaka_park_1", "tanaka_park_5", "zahn_7")
"""The four columns of the paper, in its order."""

# Whole numbers to divide or multiply by, so that 400 mm gives exactly 0.4 m.
_DIVISOR = {"-": 1, "mm": 1000, "mm2": 1000**2}
_FACTOR = {"kN": 1000, "MPa": 1000**2}


@dataclass(frozen=True, slots=True)
class PaperSection:
    """One column of table 2, in SI.

    Attributes
    ----------
    specimen : str
        Name as printed.
    span_depth_ratio : float
        Length over depth.
    length : float
        From the base to the lateral load, of the equivalent cantilever [m].
    axial_load : float
        Compression positive [N].
    concrete_strength : float
        Cylinder strength [Pa].
    width, depth : float
        Of the section, depth in the direction of loading [m].
    cover : float
        Clear cover to the outer edge of the stirrups [m].
    longitudinal_number : int
        Number of longitudinal bars.
    longitudinal_diameter : float
        Of one bar [m].
    longitudinal_yield_stress, longitudinal_ultimate_stress : float
        Of the steel [Pa].
    longitudinal_area : float
        Of one bar [m2].
    transverse_yield_stress, transverse_ultimate_stress : float
        Of the steel [Pa].
    transverse_diameter : float
        Of one stirrup bar [m].
    transverse_spacing : float
        Of the stirrups near the base [m].
    transverse_area : float
        Of one stirrup bar [m2].
    transverse_type : str
        As printed.
    shear_legs : int
        Stirrup bars that cross the section.
    """

    specimen: str
    span_depth_ratio: float
    length: float
    axial_load: float
    concrete_strength: float
    width: float
    depth: float
    cover: float
    longitudinal_number: int
    longitudinal_diameter: float
    longitudinal_yield_stress: float
    longitudinal_ultimate_stress: float
    longitudinal_area: float
    transverse_yield_stress: float
    transverse_ultimate_stress: float
    transverse_diameter: float
    transverse_spacing: float
    transverse_area: float
    transverse_type: str
    shear_legs: int

    @property
    def gross_area(self) -> float:
        """Area of the concrete section [m2]."""
        return self.width * self.depth

    @property
    def mass(self) -> float:
        """Mass of the column from its gross volume and 2400 kg/m3 [kg]."""
        return self.gross_area * self.length * CONCRETE_DENSITY

    @property
    def axial_load_ratio(self) -> float:
        """Axial load over gross area times concrete strength."""
        return self.axial_load / (self.gross_area * self.concrete_strength)

    @property
    def section(self) -> RectangularSection:
        """The section with its bars along the ties, as many on every face."""
        steel = Steel(self.longitudinal_yield_stress, self.longitudinal_ultimate_stress)
        layout = Layout(self.longitudinal_number, self.longitudinal_diameter, steel)
        steel = Steel(self.transverse_yield_stress, self.transverse_ultimate_stress)
        sizes = self.transverse_diameter, self.transverse_spacing
        ties, cover = Ties(*sizes, steel, legs=self.shear_legs), self.cover
        concrete = Concrete(self.concrete_strength)
        return RectangularSection(
            self.width, self.depth, concrete, layout=layout, ties=ties, cover=cover
        )


def paper_sections() -> dict[str, PaperSection]:
    """Read table 2 of the paper.

    Returns
    -------
    dict of str to PaperSection
        The four columns by key, SI units: soesianawati_1, tanaka_park_1, tanaka_park_5, zahn_7.

    Examples
    --------
    >>> paper_sections()["zahn_7"].axial_load
    1010000.0
    """
    fields: dict[str, dict[str, Any]] = {key: {} for key in KEYS}
    for row in _package.rows("paper_table_2.csv"):
        name = row["property"]
        if row["group"] != "column" and name != "shear_legs":
            name = f"{row['group']}_{name}"
        for key in KEYS:
            fields[key][name] = _si(name, row[key], row["unit"])
    return {key: PaperSection(**fields[key]) for key in KEYS}


def paper_columns(kinematics: Kinematics = "small", **changes: Any) -> dict[str, Column]:
    """Build the one-component columns of table 3 of the paper.

    Height and axial load are those of table 2, the mass is the gross volume times 2400 kg/m3. The
    shear spring is bilinear, the flexural one trilinear Takeda. The paper estimates B_1 as a ratio
    to the initial stiffness, so it multiplies K_c here (`inner="kc"`).

    Parameters
    ----------
    kinematics : {"small", "pdelta", "finite"}, default "small"
        Level of kinematics; the axial load acts from "pdelta" on.
    **changes
        Other fields of `rbsdem.Column` to set on all four, as in ``axial_load=0.0``.

    Returns
    -------
    dict of str to Column
        The four columns by key: soesianawati_1, tanaka_park_1, tanaka_park_5, zahn_7.

    Raises
    ------
    InputError
        If a change names no field of `rbsdem.Column`, or its value is refused there.

    Examples
    --------
    The columns of equation 4 of the paper, which has no axial load:

    >>> columns = paper_columns("finite", axial_load=0.0)
    >>> columns["tanaka_park_5"].height
    1.65
    """
    springs: dict[str, dict[tuple[str, str], float]] = {key: {} for key in KEYS}
    for row in _package.rows("paper_table_3.csv"):
        for key in KEYS:
            springs[key][row["spring"], row["parameter"]] = float(row[key])
    sections = paper_sections()
    # The axial load waits for other kinematics.
    with notes_off():
        columns = {key: _column(sections[key], springs[key], kinematics) for key in KEYS}
        try:
            return {key: replace(column, **changes) for key, column in columns.items()}
        except TypeError as error:
            raise InputError(f"paper_columns: {error}") from error


def _column(
    section: PaperSection, s: dict[tuple[str, str], float], kinematics: Kinematics
) -> Column:
    """Return a column of table 3; `s` has its values by spring and parameter."""
    names = ("K_c", "D_c", "K_y", "D_y", "K_u")
    flexure: Any = {name.lower(): s["flexure", name] for name in names}
    flexure |= {"b0": s["flexure", "B_0"], "b1": s["flexure", "B_1"], "inner": "kc"}
    return Column(
        height=section.length,
        mass=section.mass,
        shear=Bilinear(k=s["shear", "K_y"], d_y=s["shear", "D_y"], k_post=s["shear", "K_u"]),
        flexure=Takeda(**flexure),
        axial_load=section.axial_load,
        kinematics=kinematics,
    )


def _si(name: str, text: str, unit: str) -> float | int | str:
    """Return one entry of table 2 in SI, with the type of the attribute `name`."""
    kind = PaperSection.__annotations__[name]
    if kind == "str":
        return text
    if kind == "int":
        return int(text)
    return float(text) / _DIVISOR[unit] if unit in _DIVISOR else float(text) * _FACTOR[unit]
