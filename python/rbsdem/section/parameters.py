"""Parameters of the layered model, the same for all columns, and their versions.

A version never changes: a new fit is a new entry of `VERSIONS`, and the older ones stay for as long
as the laws that they were fitted with are there.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from difflib import get_close_matches

from rbsdem import _arguments
from rbsdem.errors import InputError
from rbsdem.section.directions import DIRECTIONS, factors

__all__ = [
    "FACTORS",
    "VERSIONS",
    "HingeParameters",
    "ModelParameters",
    "ShearParameters",
    "parameters",
    "versions",
]


@dataclass(frozen=True, kw_only=True)
class HingeParameters:
    """Parameters of the layered hinge that are the same for all columns.

    The forms are published relations. With n the axial load ratio, `..._axial` is the exponent e of
    a factor exp(e (n - 0.2)).

    Attributes
    ----------
    steel_strength : float
        Yield and ultimate stress over the measured ones.
    hardening : float
        Factor of the slope from the yield stress to the ultimate stress at 8 % strain.
    r0, r0_axial : float
        R0 of Menegotto and Pinto (1973).
    r0_stress : float
        Exponent e of a factor exp(e (min(P/(40 MPa A_g), 1.5) - 0.15)) of R0: branches are the less
        round the larger the axial stress.
    r0_bond : float
        Exponent e of a factor (B/0.12)^-e of R0, B = f_y d_b/(10 sqrt(f'c) L) in MPa: the length
        that anchors a bar over that of the column. Bars that slip in their bond are rounder.
    cr1, cr2 : float
        Their cR1 and cR2.
    isotropic_hardening : float
        Share by which the strength of a bar has grown when the range of its strains was twice that
        between its yield strains (Filippou, Popov and Bertero 1983).
    isotropic_bond : float
        Exponent e of a factor (B/0.12)^e of it, B as for `r0_bond`.
    fatigue : float
        1 over the plastic deformation inside the reach, over d_y, that halves the strength of a
        bar: 1 over the `endurance` of `rbsdem.springs.SteelSpring`.
    concrete_strength, concrete_size : float
        In-place over cylinder strength at 40 MPa; exponent of its decrease with the strength.
    peak_strain : float
        Strain at the strength of unconfined concrete over 0.002.
    confinement : float
        Factor of the confining stress of Mander, Priestley and Park (1988).
    core_softening, cover_softening : float
        Factors of the slopes behind the peak: to 80 % at Mander's ultimate strain; to 20 % over
        0.004.
    residual : float
        Share of the core's strength that is left.
    hinge_length, hinge_axial, hinge_depth : float
        Factor of 0.08 L + 0.022 f_y d_b (Paulay and Priestley 1992), share of the depth added. The
        hinge is no longer than 0.4 L.
    compression_length : float
        Hinge length of the concrete over that of the steel; it is no longer than 0.8 L.
    slip_length, slip_axial : float
        Length of yielding in the footing over f_y d_b [1/MPa].
    stiffness, stiffness_axial : float
        Flexural stiffness of the column above over that of the uncracked section, up to 2: above 1
        it makes up for the hinge, which is lumped at the foot.
    cracked_above : float
        Bending stiffness of the column above after it has cracked over that before; 0: it does not
        crack.
    shear_stiffness : float
        Shear stiffness of the column over the uncracked one.
    buckling, buckling_strain : float
        By how much more compression wears bars that were stretched to twice the strain e from which
        on they buckle; factor of e = 0.03 + 700 rho_s f_yh/E_s - 0.1 P/(f'c A_g) >= 0.01
        (Goodnight, Kowalsky and Nau 2013).
    friction, seating : float
        Of the concrete layers, see `springs.ConcreteSpring`: share of the force by which opening is
        below closing, and of the early touch that it does not follow.
    plastic, misfit, contact, contact_axial, wear : float
        Of the concrete layers, see `rbsdem.springs.ConcreteSpring`; the contact is 0.9 at most.
    """

    steel_strength: float
    hardening: float
    r0: float
    r0_axial: float
    cr1: float
    cr2: float
    isotropic_hardening: float
    fatigue: float
    concrete_strength: float
    concrete_size: float
    peak_strain: float
    confinement: float
    core_softening: float
    cover_softening: float
    residual: float
    hinge_length: float
    hinge_axial: float
    hinge_depth: float
    compression_length: float
    slip_length: float
    slip_axial: float
    stiffness: float
    stiffness_axial: float
    shear_stiffness: float
    plastic: float
    misfit: float
    contact: float
    contact_axial: float
    wear: float
    r0_stress: float = 0.0
    buckling: float = 0.0
    buckling_strain: float = 1.0
    friction: float = 0.0
    r0_bond: float = 0.0
    isotropic_bond: float = 0.0
    cracked_above: float = 0.0
    seating: float = 0.0

    def __post_init__(self) -> None:
        _take(self, "hinge")


@dataclass(frozen=True, kw_only=True)
class ShearParameters:
    """Parameters of the shear spring that are the same for all columns.

    Attributes
    ----------
    strength : float
        Force at which the ties yield over the shear strength of the simplified modified compression
        field theory (Bentz, Vecchio, Collins 2006).
    round_strength : float
        Factor of that of columns with spirals or round hoops.
    hardening : float
        Largest force over that at yield, 1 or more.
    cap : float
        Slip from there to the largest force, over the length of the column.
    softening : float
        Slip from the largest force to where the softening line has none left, over the length.
    residual : float
        Residual over largest force.
    endurance : float
        Energy that the strength lasts for, over yield force times yield slip; 0: for ever.
    pinch_force, pinch_slip : float
        `kappa_f`, at an axial load ratio of 0.1, and `kappa_d` of `rbsdem.springs.Pinching`.
    pinch_axial : float
        Exponent e of a factor exp(e (n - 0.1)) of `kappa_f`: compression closes cracks.
    cracked : float
        Factor of the stiffness of the cracked truss.
    b0 : float
        Exponent of the unloading stiffness over ductility.
    decay : float
        Share of the strength that can decay which is left after the hinge has worked M_y theta_y/a:
        the factor a of D = a W/(M_y theta_y), to which the strength falls by 1/(1 + D).
    decay_shelter : float
        Confining stress over f'c that divides a by e.
    decay_ties, decay_strut : float
        What stays: the share V_s/V_y of the ties at 45 degrees times the first, or f'c b d/V_y
        times the second if that is less; 0.95 at most.
    round_ties : float
        Ties that spirals and round hoops are worth, against those of rectangles, in what stays and
        in `endurance_ties`.
    fade : float
        `fade` of `rbsdem.springs.Pinching`: how the strength falls with its own energy.
    endurance_ties : float
        Exponent of V_s/(0.5 V_y), 1 at most, in a factor of `endurance`: without ties the strength
        does not last.
    snap_back : float
        Steepest softening over the stiffness 3 E I/L^3 of the column above; 0: no limit.
    """

    strength: float
    hardening: float
    cap: float
    softening: float
    residual: float
    endurance: float
    pinch_force: float
    pinch_slip: float
    decay: float = 0.0
    decay_shelter: float = 0.02
    decay_ties: float = 1.0
    decay_strut: float = 0.1
    snap_back: float = 0.0
    endurance_ties: float = 0.0
    round_strength: float = 1.0
    pinch_axial: float = 0.0
    cracked: float = 1.0
    b0: float = 0.0
    round_ties: float = 2.5
    fade: float = 0.0

    def __post_init__(self) -> None:
        _take(self, "shear spring")


#: Names of parameters of the shear spring begin with this where both kinds stand together.
_SHEAR = "shear_"

_HINGE_NAMES = tuple(field.name for field in fields(HingeParameters))
_SHEAR_NAMES = tuple(field.name for field in fields(ShearParameters))

FACTORS: dict[str, tuple[tuple[str, ...], str]] = {
    "strength": (("steel_strength", "concrete_strength"), "strengths of steel and concrete"),
    "lengths": (
        ("hinge_length", "slip_length"),
        "lengths of hinge and slip: rotations of all bars",
    ),
    "softening": (
        ("core_softening", "cover_softening", "fatigue"),
        "slopes of core and cover behind the peak, fatigue of the bars",
    ),
}
"""Names that stand for a factor on several parameters: which, and what they are."""


@dataclass(frozen=True)
class ModelParameters:
    """All parameters of the layered model.

    Attributes
    ----------
    version : str
        Version that they are, or that they were changed from.
    hinge : HingeParameters
        Those of the hinge.
    shear : ShearParameters
        Those of the shear spring.
    """

    version: str
    hinge: HingeParameters
    shear: ShearParameters

    @property
    def changed(self) -> bool:
        """Whether a parameter differs from that of the version."""
        return VERSIONS.get(self.version) != self

    @property
    def own(self) -> tuple[str, ...]:
        """Names of the parameters that differ from those of the version; all if it has none."""
        known = VERSIONS.get(self.version)
        of_version = known.values if known else {}
        return tuple(name for name, value in self.values.items() if of_version.get(name) != value)

    @property
    def label(self) -> str:
        """The version, as "2026.2", or "2026.2 changed" where parameters differ from it."""
        return f"{self.version} changed" if self.changed else self.version

    @property
    def values(self) -> dict[str, float]:
        """All values by name; the names of the shear spring begin with ``shear_``."""
        return {name: getattr(self.hinge, name) for name in _HINGE_NAMES} | {
            _SHEAR + name: getattr(self.shear, name) for name in _SHEAR_NAMES
        }

    def with_values(self, **values: float) -> ModelParameters:
        """Return the parameters with other values of some.

        Parameters
        ----------
        **values
            Names as in `values`, such as ``steel_strength=1.0`` or ``shear_strength=1.1``; or one
            of `FACTORS` or `DIRECTIONS`, by which several are multiplied.

        Raises
        ------
        InputError
            If a name is not known, or a value is not a finite number.
        """
        hinge, shear = {}, {}
        for name in [name for name in FACTORS if name in values]:
            factor = _arguments.number(values.pop(name), f"parameters: {name}")
            for one in FACTORS[name][0]:
                values[one] = factor * values.get(one, getattr(self.hinge, one))
        along = {name: _above_zero(values.pop(name), name) for name in DIRECTIONS if name in values}
        now = self.values if along else {}
        for one, factor in factors(along).items():
            values[one] = factor * values.get(one, now[one])
        for name, value in values.items():
            if name in _HINGE_NAMES:
                hinge[name] = value
            elif name.startswith(_SHEAR) and name[len(_SHEAR) :] in _SHEAR_NAMES:
                shear[name[len(_SHEAR) :]] = value
            else:
                raise _unknown(name, [*self.values, *FACTORS, *DIRECTIONS])
        return replace(self, hinge=replace(self.hinge, **hinge), shear=replace(self.shear, **shear))


def _above_zero(value: float, name: str) -> float:
    factor = _arguments.number(value, f"parameters: {name}")
    if not 0 < factor < math.inf:
        raise InputError(f"parameters: {name} = {factor:g} is a factor; it must be above zero")
    return factor


def _take(given: HingeParameters | ShearParameters, what: str) -> None:
    """Make every value a float."""
    for field in fields(given):
        value = _arguments.number(getattr(given, field.name), f"{what}: {field.name}")
        if value - value != 0:
            raise InputError(f"{what}: {field.name} = {value} must be a finite number")
        object.__setattr__(given, field.name, value)


def _unknown(name: str, known: list[str]) -> InputError:
    (near,) = get_close_matches(name, known, n=1, cutoff=0.0)
    return InputError(f"parameters: {name!r} is not known; did you mean {near!r}?")


# Fitted to 217 tests of the PEER Structural Performance Database: the hinge to the rectangular
# flexural ones (studies/fit_hinge.py --fitted-before), the shear spring to those that failed in
# shear or in shear after flexure (studies/fit_shear.py).
VERSIONS: dict[str, ModelParameters] = {
    "2026.2": ModelParameters(
        version="2026.2",
        hinge=HingeParameters(
            steel_strength=1.06,
            hardening=0.784,
            r0=13.4,
            r0_axial=1.21,
            cr1=0.928,
            cr2=0.377,
            isotropic_hardening=0.113,
            fatigue=0.00441,
            concrete_strength=0.961,
            concrete_size=0.124,
            peak_strain=1.07,
            confinement=0.782,
            core_softening=1.16,
            cover_softening=1.52,
            residual=0.301,
            hinge_length=1.02,
            hinge_axial=-0.928,
            hinge_depth=0.0969,
            compression_length=1.98,
            slip_length=0.0151,
            slip_axial=-1.28,
            stiffness=1.04,
            stiffness_axial=1.31,
            shear_stiffness=0.774,
            plastic=2.21,
            misfit=0.312,
            contact=0.28,
            contact_axial=0.305,
            wear=0.0734,
        ),
        shear=ShearParameters(
            strength=0.965,
            hardening=1.11,
            cap=0.0234,
            softening=0.0941,
            residual=0.05,
            endurance=217.0,
            pinch_force=0.288,
            pinch_slip=0.741,
        ),
    ),
    # Fitted to 268 tests at once, doubtful labels mended (studies/fit_model.py): 18 parameters, the
    # others fixed there.
    "2026.3": ModelParameters(
        version="2026.3",
        hinge=HingeParameters(
            steel_strength=1.05,
            hardening=0.75,
            r0=13.0,
            r0_axial=0.0,
            cr1=0.93,
            cr2=0.4,
            isotropic_hardening=0.116,
            fatigue=0.00455,
            concrete_strength=0.971,
            concrete_size=0.11,
            peak_strain=1.1,
            confinement=0.8,
            core_softening=1.0,
            cover_softening=1.59,
            residual=0.3,
            hinge_length=1.0,
            hinge_axial=-1.06,
            hinge_depth=0.1,
            compression_length=2.09,
            slip_length=0.015,
            slip_axial=-0.99,
            stiffness=1.0,
            stiffness_axial=1.3,
            shear_stiffness=0.75,
            plastic=1.85,
            misfit=0.302,
            contact=0.3,
            contact_axial=0.0,
            wear=0.0828,
            r0_stress=1.39,
            buckling=5.0,
            buckling_strain=1.0,
            friction=0.4,
        ),
        shear=ShearParameters(
            strength=0.981,
            hardening=1.1,
            cap=0.023,
            softening=0.0829,
            residual=0.05,
            endurance=222.0,
            pinch_force=0.322,
            pinch_slip=0.75,
            decay=0.266,
            decay_shelter=0.03,
            decay_ties=1.07,
            decay_strut=0.1,
            snap_back=0.5,
            endurance_ties=2.0,
        ),
    ),
    # Fitted to the same tests, with four more mechanisms: 27 parameters (studies/fit_model.py).
    "2026.4": ModelParameters(
        version="2026.4",
        hinge=HingeParameters(
            steel_strength=1.05,
            hardening=0.75,
            r0=13.0,
            r0_axial=0.0,
            cr1=0.93,
            cr2=0.4,
            isotropic_hardening=0.122,
            fatigue=0.00477,
            concrete_strength=0.979,
            concrete_size=0.112,
            peak_strain=1.1,
            confinement=0.8,
            core_softening=1.0,
            cover_softening=1.62,
            residual=0.3,
            hinge_length=1.0,
            hinge_axial=-1.05,
            hinge_depth=0.113,
            compression_length=2.13,
            slip_length=0.015,
            slip_axial=-0.979,
            stiffness=1.0,
            stiffness_axial=1.3,
            shear_stiffness=0.75,
            plastic=1.86,
            misfit=0.307,
            contact=0.3,
            contact_axial=0.0,
            wear=0.0849,
            r0_stress=1.54,
            buckling=5.0,
            buckling_strain=1.0,
            friction=0.4,
            r0_bond=0.0815,
            isotropic_bond=0.0934,
            cracked_above=0.361,
        ),
        shear=ShearParameters(
            strength=1.0,
            hardening=1.1,
            cap=0.023,
            softening=0.0709,
            residual=0.05,
            endurance=137.0,
            pinch_force=0.395,
            pinch_slip=0.75,
            decay=0.456,
            decay_shelter=0.03,
            decay_ties=1.51,
            decay_strut=0.1,
            snap_back=0.5,
            endurance_ties=2.65,
            round_strength=1.06,
            pinch_axial=0.568,
            cracked=1.04,
            b0=0.522,
        ),
    ),
    # Fitted to the same tests: round columns are stronger in shear and lose it faster, strength in
    # shear fades, faces that were pressed together fit; 31 parameters (studies/fit_model.py).
    "2026.5": ModelParameters(
        version="2026.5",
        hinge=HingeParameters(
            steel_strength=1.05,
            hardening=0.75,
            r0=11.1,
            r0_axial=0.0,
            cr1=0.93,
            cr2=0.4,
            isotropic_hardening=0.126,
            fatigue=0.00493,
            concrete_strength=0.979,
            concrete_size=0.112,
            peak_strain=1.1,
            confinement=0.8,
            core_softening=1.0,
            cover_softening=1.62,
            residual=0.3,
            hinge_length=1.0,
            hinge_axial=-1.03,
            hinge_depth=0.115,
            compression_length=2.13,
            slip_length=0.0174,
            slip_axial=-0.991,
            stiffness=1.0,
            stiffness_axial=1.3,
            shear_stiffness=0.75,
            plastic=1.86,
            misfit=0.307,
            contact=0.3,
            contact_axial=0.0,
            wear=0.0849,
            r0_stress=1.59,
            buckling=5.0,
            buckling_strain=1.0,
            friction=0.4,
            r0_bond=0.121,
            isotropic_bond=0.124,
            cracked_above=0.361,
            seating=1.0,
        ),
        shear=ShearParameters(
            strength=1.02,
            hardening=1.1,
            cap=0.023,
            softening=0.0691,
            residual=0.05,
            endurance=46.9,
            pinch_force=0.391,
            pinch_slip=0.75,
            decay=0.527,
            decay_shelter=0.0952,
            decay_ties=1.67,
            decay_strut=0.1,
            snap_back=0.5,
            endurance_ties=3.0,
            round_strength=1.37,
            pinch_axial=0.916,
            cracked=1.0,
            b0=0.522,
            round_ties=1.28,
            fade=2.0,
        ),
    ),
}
"""Parameters by version, the oldest first."""

#: Versions that were fitted with laws that are gone, and what to do.
_GONE = {"2026.1": "it was fitted with an earlier law of steel; take 2026.2"}


def versions() -> tuple[str, ...]:
    """Return the known versions of the parameters, the oldest first."""
    return tuple(VERSIONS)


def parameters(version: str | None = None) -> ModelParameters:
    """Return the parameters of the layered model.

    Parameters
    ----------
    version : str, optional
        As "2026.2"; the newest one by default.

    Raises
    ------
    InputError
        If there is no such version, or not any more.
    """
    if version is None:
        return next(reversed(VERSIONS.values()))
    if _arguments.text(version, "version") in _GONE:
        raise InputError(f"version = {version!r} of the layered model is gone: {_GONE[version]}")
    if version not in VERSIONS:
        raise InputError(
            f"version = {version!r} of the layered model is not known; there are "
            f"{', '.join(VERSIONS)}"
        )
    return VERSIONS[version]
