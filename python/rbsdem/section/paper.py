"""Tables 2 and 3 of the paper: the four tested columns and their springs.

The values are read from `data/paper_table_2.csv` and `data/paper_table_3.csv`, which have them as
printed, and are converted to SI.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from rbsdem import _package
from rbsdem.errors import InputError
from rbsdem.model.column import Column, Kinematics, notes_off
from rbsdem.model.materials import Concrete, Layout, Steel, Ties
from rbsdem.model.shape import RectangularSection
from rbsdem.model.springs import Bilinear, Takeda
from rbsdem.section.columns import CONCRETE_DENSITY

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
