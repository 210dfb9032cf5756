"""All values of codes and regressions for one column."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from rbsdem import _package
from rbsdem.checks import formulas
from rbsdem.checks.formulas import Quantities, quantities
from rbsdem.errors import InputError
from rbsdem.model.shape import Section
from rbsdem.section.axial_moment import nominal_moment
from rbsdem.section.strength import (
    axial_failure_drift,
    shear_failure_drift,
    shear_strength_sezen,
)

if TYPE_CHECKING:
    import pandas as pd


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
    c = _Drawn(section, quantities(section, height, axial_load))
    found = []
    for row in _package.rows("code_values.csv"):
        if not _COVERS[row["covers"]](c.q):
            continue
        value = _FORMULAS[row["name"]](c)
        if math.isfinite(value):
            source = (c.q.round and row["source_of_circles"]) or row["source"]
            names = row["name"], row["meaning"]
            confirmed = row["confirmed"] == "1"
            found.append(CodeValue(*names, value, row["unit"], source, confirmed))
    return CodeValues(found, c.q)


@dataclass(frozen=True)
class _Drawn:
    """A column as the formulas take it."""

    section: Section
    q: Quantities

    @cached_property
    def moment(self) -> float:
        """Moment at which the backbones of codes yield [N mm].

        The closed form is for rectangles; circles yield at their nominal moment, as codes have it.
        """
        if self.q.round:
            return 1e3 * nominal_moment(self.section, self.q.load)
        return self.yielding[1]

    @cached_property
    def yielding(self) -> tuple[float, float, float]:
        """Curvature [1/mm], moment [N mm] and relative depth of the neutral axis at yield."""
        return formulas.yield_point(self.q)

    @property
    def force(self) -> float:
        """Shear force at yield [N]."""
        return self.moment / self.q.span

    @cached_property
    def rotations(self) -> formulas.Rotations:
        """Plastic rotations of ASCE 41."""
        q, ratio = self.q, self.force / formulas.asce_41_shear_strength(self.q)
        given = q.axial_load_ratio, q.tie_ratio, ratio, q.fc, q.fyt
        return formulas.asce_41_rotations(*given, circle=q.round)

    @cached_property
    def haselton(self) -> formulas.Haselton:
        """The backbone of Haselton."""
        return formulas.Haselton(self.q)


#: What the values cover.
_COVERS: dict[str, Callable[[Quantities], bool]] = {
    "": lambda q: True,
    "rectangle": lambda q: not q.round,
    "ties": lambda q: q.tie_ratio >= 0.0005,
    "hoops": lambda q: q.hoop_ratio > 0,
    "round hoops": lambda q: q.hoop_ratio > 0 and q.round,
}

_FORMULAS: dict[str, Callable[[_Drawn], float]] = {
    "yield.moment": lambda c: 1e-3 * c.moment,
    "yield.shear": lambda c: c.force,
    "yield.curvature": lambda c: 1e3 * c.yielding[0],
    "hinge.priestley": lambda c: 1e-3 * formulas.hinge_length_priestley(c.q),
    "hinge.paulay": lambda c: 1e-3 * formulas.hinge_length_paulay(c.q),
    "asce_41.stiffness": lambda c: formulas.asce_41_stiffness(c.q.axial_load_ratio),
    "asce_41.shear": lambda c: formulas.asce_41_shear_strength(c.q),
    "asce_41.a": lambda c: c.rotations.a,
    "asce_41.b": lambda c: c.rotations.b,
    "asce_41.c": lambda c: c.rotations.c,
    "asce_41.io": lambda c: c.rotations.io,
    "asce_41.ls": lambda c: c.rotations.ls,
    "asce_41.cp": lambda c: c.rotations.cp,
    "ec_8.yield": lambda c: formulas.ec_8_yield_rotation(
        c.q, cracked=formulas.ec_8_cracks_in_shear(c.q)
    ),
    "ec_8.ultimate": lambda c: formulas.ec_8_ultimate_rotation(c.q),
    "ec_8.plastic": lambda c: formulas.ec_8_plastic_rotation(c.q),
    "ec_8.shear": lambda c: formulas.ec_8_shear_resistance(c.q),
    "ec_8.shear_after_yield": lambda c: formulas.ec_8_shear_resistance(c.q, 5.0),
    "elwood.stiffness": lambda c: formulas.elwood_eberhard_stiffness(c.q),
    "elwood.shear_drift": lambda c: shear_failure_drift(c.section, c.force, c.q.load),
    "elwood.axial_drift": lambda c: axial_failure_drift(c.section, c.q.load),
    "sezen.shear": lambda c: shear_strength_sezen(c.section, 1e-3 * c.q.span, c.q.load),
    "haselton.cap": lambda c: c.haselton.capping_rotation,
    "haselton.post_cap": lambda c: c.haselton.post_capping_rotation,
    "haselton.hardening": lambda c: c.haselton.hardening,
    "haselton.stiffness": lambda c: c.haselton.yield_stiffness,
    "haselton.initial": lambda c: c.haselton.initial_stiffness,
    "berry.spalling": lambda c: formulas.berry_spalling_drift(c.q),
    "berry.buckling": lambda c: formulas.berry_buckling_drift(c.q),
    "berry.rotation": lambda c: formulas.berry_buckling_rotation(c.q),
    "goodnight.strain": lambda c: formulas.goodnight_buckling_strain(c.q),
    "goodnight.drift": lambda c: formulas.goodnight_buckling_drift(c.q),
}
