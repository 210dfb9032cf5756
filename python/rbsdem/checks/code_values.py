"""All values of codes and regressions for one column."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING

from rbsdem import _arguments
from rbsdem.checks import asce_41, ec_8, flexure, regressions
from rbsdem.checks.code_drawing import Quantities, quantities
from rbsdem.errors import InputError
from rbsdem.model.shape import Section
from rbsdem.section import strength
from rbsdem.section.axial_moment import nominal_moment

if TYPE_CHECKING:
    import pandas as pd

    pass

__all__ = ["CodeValue", "CodeValues", "code_values"]


@dataclass(frozen=True)
class CodeValue:
    """One value.

    Attributes
    ----------
    name : str
        Its name, as "asce_41.a".
    meaning : str
        What it is.
    value : float
        In SI: N, N m, m, rad; a drift or ratio without unit.
    unit : str
        "N", "N m", "m", "1/m", "rad", "drift" or "".
    source : str
        Code or paper, with its clause or equation.
    confirmed : bool
        Whether the formula was confirmed by a second source; others are from memory of the field.
    """

    name: str
    meaning: str
    value: float
    unit: str
    source: str
    confirmed: bool = True


class CodeValues:
    """The values of a column, by name and in the order of their sources.

    Parameters
    ----------
    values : list of CodeValue
        The values.
    quantities : Quantities
        What the formulas used.
    """

    def __init__(self, values: list[CodeValue], quantities: Quantities) -> None:
        self.quantities = quantities
        self._values = {value.name: value for value in values}

    def __getitem__(self, name: str) -> float:
        """Return the value of a name."""
        if name not in self._values:
            raise InputError(
                f"code values: {name!r} is not known; it is one of {', '.join(self._values)}"
            )
        return self._values[name].value

    def __iter__(self) -> Iterator[CodeValue]:
        return iter(self._values.values())

    def __len__(self) -> int:
        return len(self._values)

    def names(self) -> list[str]:
        """Return the names."""
        return list(self._values)

    def to_frame(self) -> pd.DataFrame:
        """Return a DataFrame, a row for each value with its unit, meaning and source."""
        import pandas  # noqa: PLC0415

        return pandas.DataFrame([asdict(value) for value in self])

    def __repr__(self) -> str:
        return f"CodeValues({len(self)} values: {', '.join(self._values)})"


def code_values(section: Section, height: float, axial_load: float) -> CodeValues:
    """Return what codes and regressions say of a column with a section.

    Stiffness, strengths, chord and plastic rotations, drifts at failures: ASCE 41-17 (ACI 369.1),
    EN 1998-3, Panagiotakos and Fardis, Elwood and Eberhard, Elwood and Moehle, Sezen and Moehle,
    Haselton, Berry and Eberhard, Goodnight; each with its source, and whether its formula is
    confirmed. Those that were made for rectangles are left out for circles.

    Parameters
    ----------
    section : Section
        The section.
    height : float
        Shear span, from the foot to the point without moment [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    CodeValues
        The values by name.

    Raises
    ------
    InputError
        If the section has no bars near both faces, or a number is refused.
    """
    _arguments.instance(section, "code_values: section", Section)
    q = quantities(section, height, axial_load)
    moment, source = _moment(section, q)
    found = [*_yield(q, moment, source), *_asce_41(q, moment)]
    if not q.round:
        found += _ec_8(q)
    found += _regressions(section, q, moment)
    return CodeValues([value for value in found if math.isfinite(value.value)], q)


def _moment(section: Section, q: Quantities) -> tuple[float, str]:
    """Return the moment at which the backbones of codes yield [N mm], and its source.

    The closed form is for rectangles; circles yield at their nominal moment, as codes have it.
    """
    if q.round:
        return 1e3 * nominal_moment(section, q.load), "ACI 318-19, 22.2, nominal moment"
    return flexure.yield_point(q)[1], "Panagiotakos, Fardis 2001, eqs 1-6"


def _yield(q: Quantities, moment: float, source: str) -> list[CodeValue]:
    found = [
        CodeValue("yield.moment", "moment at yield", 1e-3 * moment, "N m", source),
        CodeValue("yield.shear", "its shear force", moment / q.span, "N", source),
    ]
    if not q.round:
        curvature = 1e3 * flexure.yield_point(q)[0]
        found.append(CodeValue("yield.curvature", "curvature at yield", curvature, "1/m", source))
    length = 1e-3 * flexure.hinge_length_priestley(q)
    source = "Priestley, Calvi, Kowalsky 2007"
    found.append(CodeValue("hinge.priestley", "length of the hinge", length, "m", source))
    length = 1e-3 * flexure.hinge_length_paulay(q)
    source = "Paulay, Priestley 1992"
    return [*found, CodeValue("hinge.paulay", "length of the hinge", length, "m", source)]


def _asce_41(q: Quantities, moment: float) -> list[CodeValue]:
    strength_ = asce_41.shear_strength(q)
    found = [
        CodeValue(
            "asce_41.stiffness",
            "E I_eff/(E_c I_g)",
            asce_41.stiffness_ratio(q.axial_load_ratio),
            "",
            "ASCE 41-17, table 10-5",
        ),
        CodeValue("asce_41.shear", "shear strength", strength_, "N", "ASCE 41-17, 10.4.2.3.1"),
    ]
    if q.tie_ratio < 0.0005:
        return found
    ratio = moment / q.span / strength_
    turned = asce_41.rotations(q.axial_load_ratio, q.tie_ratio, ratio, q.fc, q.fyt, circle=q.round)
    table = "ASCE 41-17, table 10-9" if q.round else "ASCE 41-17, table 10-8"
    for name, meaning, value, unit in (
        ("a", "plastic rotation up to the loss of strength", turned.a, "rad"),
        ("b", "plastic rotation up to the loss of axial load", turned.b, "rad"),
        ("c", "residual strength ratio", turned.c, ""),
        ("io", "immediate occupancy", turned.io, "rad"),
        ("ls", "life safety", turned.ls, "rad"),
        ("cp", "collapse prevention", turned.cp, "rad"),
    ):
        found.append(CodeValue(f"asce_41.{name}", meaning, value, unit, table))
    return found


def _ec_8(q: Quantities) -> list[CodeValue]:
    cracked = ec_8.cracks_in_shear(q)
    rows = (
        ("yield", "chord rotation at yield", ec_8.yield_rotation(q, cracked=cracked), "A.10b"),
        ("ultimate", "chord rotation capacity, mean", ec_8.ultimate_rotation(q), "A.1"),
        ("plastic", "its plastic part, mean", ec_8.plastic_rotation(q), "A.3"),
    )
    found = [
        CodeValue(f"ec_8.{name}", meaning, value, "rad", f"EN 1998-3:2005, ({equation})")
        for name, meaning, value, equation in rows
    ]
    for name, ductility in (("shear", 0.0), ("shear_after_yield", 5.0)):
        meaning = "shear strength, mean" + (", after yield" if ductility else "")
        value = ec_8.shear_resistance(q, ductility)
        found.append(CodeValue(f"ec_8.{name}", meaning, value, "N", "EN 1998-3:2005, (A.12)"))
    return found


def _regressions(section: Section, q: Quantities, moment: float) -> list[CodeValue]:
    haselton = regressions.Haselton(q)
    force = moment / q.span
    rows: list[tuple[str, str, float, str, str, bool]] = [
        (
            "elwood.stiffness",
            "E I_eff/(E I_g)",
            regressions.elwood_eberhard_stiffness(q),
            "",
            "Elwood, Eberhard 2009, eq 18",
            True,
        ),
        (
            "sezen.shear",
            "shear strength",
            strength.shear_strength_sezen(section, 1e-3 * q.span, q.load),
            "N",
            "Sezen, Moehle 2004",
            True,
        ),
    ]
    if not q.round:
        rows += [
            (
                "elwood.shear_drift",
                "drift at shear failure after yield",
                strength.shear_failure_drift(section, force, q.load),
                "drift",
                "Elwood, Moehle 2005",
                False,
            ),
            (
                "elwood.axial_drift",
                "drift at axial failure after shear failure",
                strength.axial_failure_drift(section, q.load),
                "drift",
                "Elwood, Moehle 2005",
                True,
            ),
        ]
        for name, meaning, value, unit, equation in (
            (
                "cap",
                "plastic rotation up to the cap",
                haselton.capping_rotation,
                "rad",
                "2016, eq 5",
            ),
            ("post_cap", "rotation behind it", haselton.post_capping_rotation, "rad", "2016, eq 8"),
            ("hardening", "M_c/M_y", haselton.hardening, "", "2008, eq 3.17"),
            ("stiffness", "E I_y/(E I_g)", haselton.yield_stiffness, "", "2016"),
            ("initial", "E I at 40 % of yield", haselton.initial_stiffness, "", "2016"),
        ):
            rows.append((f"haselton.{name}", meaning, value, unit, f"Haselton {equation}", True))
    if q.hoop_ratio > 0:
        rows += _buckling(q)
    return [CodeValue(*row) for row in rows]


def _buckling(q: Quantities) -> list[tuple[str, str, float, str, str, bool]]:
    berry = "Berry, Eberhard"
    rows: list[tuple[str, str, float, str, str, bool]] = [
        (
            "berry.spalling",
            "drift at spalling",
            regressions.berry_spalling_drift(q),
            "drift",
            f"{berry} 2003",
            False,
        ),
        (
            "berry.buckling",
            "drift at bar buckling",
            regressions.berry_buckling_drift(q),
            "drift",
            f"{berry} 2003",
            False,
        ),
        (
            "berry.rotation",
            "plastic rotation at bar buckling",
            regressions.berry_buckling_rotation(q),
            "rad",
            f"{berry} 2005",
            True,
        ),
        (
            "goodnight.strain",
            "tensile strain before bar buckling",
            regressions.goodnight_buckling_strain(q),
            "",
            "Goodnight, Kowalsky, Nau 2016",
            True,
        ),
    ]
    if q.round:
        rows.append(
            (
                "goodnight.drift",
                "drift before bar buckling",
                regressions.goodnight_buckling_drift(q),
                "drift",
                "Goodnight, Kowalsky, Nau 2016",
                True,
            )
        )
    return rows
