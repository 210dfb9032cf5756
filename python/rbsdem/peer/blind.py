"""Columns from the properties of a specimen alone: no number of the test at hand."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any

from rbsdem import _core
from rbsdem.calibration.parameter import Parameter
from rbsdem.column import Column
from rbsdem.errors import InputError
from rbsdem.peer.drawing import draw
from rbsdem.peer.layers import Hinge, hinge_joint
from rbsdem.peer.shear import ShearNumbers, shear_spring
from rbsdem.peer.specimen import Specimen
from rbsdem.springs import Bilinear, Elastic

__all__ = ["DEFAULT", "MODELS", "LayeredColumn", "column"]

DEFAULT = "best"
"""The model that is taken if none is named."""


def column(specimen: Specimen, model: str = DEFAULT, **options: Any) -> Column:
    """Make the column of a specimen.

    Parameters
    ----------
    specimen : Specimen
        The test; only its properties are looked at.
    model : {"paper", "best"}, optional
        "paper": one component, trilinear Takeda flexure and bilinear shear by the section analysis,
        as the paper has them; with n above 1, joints with the section's springs of their tributary
        lengths above that hinge. "best": a hinge of concrete and steel layers with bar slip at the
        foot, elastic joints above it (`rbsdem.peer.layers`); in series a shear spring that cracks,
        fails and pinches (`rbsdem.peer.shear`).
    **options
        ``n`` : number of bodies, 1 by default in "paper", 2 in "best", which needs as many.
        ``hinge``, ``shear_numbers`` : `Hinge` and `ShearNumbers` of "best", else the fitted ones.

    Returns
    -------
    Column
        With second-order effects of the axial load.

    Raises
    ------
    InputError
        If the model is not known, or if the section cannot be analysed.
    """
    if model not in MODELS:
        raise InputError(f"model = {model!r} is not known; there are {', '.join(MODELS)}")
    return MODELS[model](specimen, **options)


def _paper(specimen: Specimen, n: int = 1) -> Column:
    n = _count(n, least=1)
    section = draw(specimen).section()
    length, load = specimen.length, specimen.axial_load
    # Columns of high axial load are controlled by compression: they yield there.
    springs = section.springs(length, load, yield_rule="first")
    shear = springs.shear
    if shear is None:
        # Knee of the shear diagram in closed form: 0.48 of the uncracked stiffness.
        stiffness = 0.48 * section.concrete_law["ec"] / 2 * section.gross_area
        shear = Elastic(stiffness / length)
    flexure = [springs.flexure]
    lengths = None
    if n > 1:
        # Each joint has its share of the slip, and the curvature of its part.
        shear = _share(shear, n)
        lengths, part = _parts(length, springs.hinge_length, n)
        above = section.springs(
            length, load, yield_rule="first", hinge_length=part / _lumping(n), shear="none"
        )
        flexure += [above.flexure] * (n - 1)
    return Column(
        length,
        specimen.mass,
        shear,
        flexure,
        n=n,
        lengths=lengths,
        axial_load=specimen.second_order_load,
        kinematics="pdelta",
    )


def _count(n: int, least: int) -> int:
    n = _core.whole(n, "n")
    if n < least:
        more = ": the layered model needs a joint above the hinge" if least == 2 else ""
        raise InputError(f"n = {n}{more}; give {least} or more")
    return n


def _parts(length: float, hinge_length: float, n: int) -> tuple[list[float], float]:
    """Return the lengths of the bodies, and of the parts that the joints above the hinge are for.

    The joints are in the middles of n - 1 equal parts of the column above the hinge.
    """
    part = (length - hinge_length) / (n - 1)
    heights = [0.0, *(hinge_length + (i + 0.5) * part for i in range(n - 1)), length]
    return [high - low for low, high in pairwise(heights)], part


def _lumping(n: int) -> float:
    """Return the deflection of the top by n - 1 joints over that of the continuous column.

    1 - 1/(4 m^2) with m joints in the middles of m parts and the moment of a force at the top.
    """
    return 1 - 0.25 / (n - 1) ** 2


def _share(spring: Bilinear | Elastic, n: int) -> Bilinear | Elastic:
    """Return the spring of which n in a row are the given one."""
    if isinstance(spring, Elastic):
        return Elastic(n * spring.k)
    return replace(spring, k=n * spring.k, d_y=spring.d_y / n, k_post=n * spring.k_post)


#: What names of numbers of the shear spring begin with.
_SHEAR = "shear_"

#: Numbers of the layered hinge that may be calibrated; bounds are factors of their values.
_FREE = {
    "steel_strength": (0.7, 1.5, "-", "yield and ultimate stress over the measured ones"),
    "concrete_strength": (0.6, 1.7, "-", "strength in place over that of cylinders"),
    "hinge_length": (0.2, 4.0, "-", "factor of the hinge length"),
    "compression_length": (0.3, 3.0, "-", "hinge length of the concrete over that of the steel"),
    "wear": (0.05, 8.0, "-", "strength of the concrete lost by a cycle"),
    "roundness": (0.3, 3.0, "-", "R0 of the steel"),
    "stiffness": (0.2, 4.0, "-", "flexural stiffness above the hinge over the gross one"),
    "fatigue": (0.05, 50.0, "-", "1 over the plastic work that halves the strength"),
    "slip_length": (0.1, 5.0, "1/MPa", "length of yielding in the footing"),
    "confinement": (0.1, 5.0, "-", "factor of the confining stress"),
    "cover_fall": (0.2, 20.0, "-", "factor of the slope behind the peak of the cover"),
    "core_fall": (0.1, 50.0, "-", "factor of the slope behind the peak of the core"),
    "contact": (0.1, 2.0, "-", "share of the force at which a crack is closed"),
}

#: The same of its shear spring.
_FREE_SHEAR = {
    "strength": (0.5, 2.0, "-", "shear force at yield of the ties over the shear strength"),
    "endurance": (0.02, 50.0, "-", "energy that the shear strength lasts for"),
    "pinch_force": (0.1, 3.0, "-", "force at the break of pinched reloading"),
}


@dataclass(frozen=True)
class LayeredColumn(Column):
    """A column on a layered hinge that remembers how it was made.

    Attributes
    ----------
    specimen : Specimen
        Its properties.
    hinge : Hinge
        Numbers of the hinge.
    shear_numbers : ShearNumbers
        Numbers of the shear spring.
    """

    specimen: Specimen | None = None
    hinge: Hinge = field(default_factory=Hinge)
    shear_numbers: ShearNumbers = field(default_factory=ShearNumbers)

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Numbers that `rbsdem.calibrate` may fit, the most telling first; `shear_...` last."""
        found = {}
        for numbers, names, prefix in (
            (self.hinge, _FREE, ""),
            (self.shear_numbers, _FREE_SHEAR, _SHEAR),
        ):
            for name, (low, high, unit, what) in names.items():
                value = getattr(numbers, name)
                found[prefix + name] = Parameter(value, low * value, high * value, unit, what)
        return found

    def with_parameters(self, **values: float) -> LayeredColumn:
        """Return the column with other numbers of its model."""
        shear = {name: values.pop(_SHEAR + name) for name in _FREE_SHEAR if _SHEAR + name in values}
        return _best(
            self.specimen,
            n=self.n,
            hinge=self.hinge.with_numbers(**values),
            shear_numbers=self.shear_numbers.with_numbers(**shear),
        )


def _best(
    specimen: Specimen,
    n: int = 2,
    hinge: Hinge | None = None,
    shear_numbers: ShearNumbers | None = None,
) -> LayeredColumn:
    """Layered hinge at the foot, elastic joints at the middles of n - 1 equal parts above it.

    All slip is at the foot: where it fails in shear is where it bends most.
    """
    n = _count(n, least=2)
    drawing = draw(specimen)
    section = drawing.section()
    hinge, shear_numbers = hinge or Hinge(), shear_numbers or ShearNumbers()
    length = specimen.length
    joint = hinge_joint(drawing, section, length, specimen.axial_load, hinge)
    lengths, part = _parts(length, joint.length, n)
    # Flexible as the continuous column, whatever n is.
    stiffness = joint.flexural_stiffness / part * _lumping(n)
    foot = shear_spring(section, length, specimen.axial_load, joint.shear_stiffness, shear_numbers)
    rigid = Elastic(1e3 * joint.shear_stiffness / length)
    return LayeredColumn(
        length,
        specimen.mass,
        [foot] + [rigid] * (n - 1),
        [joint.spring] + [Elastic(stiffness)] * (n - 1),
        n=n,
        lengths=lengths,
        axial_load=specimen.second_order_load,
        kinematics="pdelta",
        specimen=specimen,
        hinge=hinge,
        shear_numbers=shear_numbers,
    )


MODELS = {"paper": _paper, "best": _best}
"""Models by name."""
