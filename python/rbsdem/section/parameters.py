"""Parameters of the layered model, the same for all columns, and their versions.

A version never changes: a new fit is a new entry of `VERSIONS`, and the older ones stay.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from difflib import get_close_matches

from rbsdem import _core
from rbsdem.errors import InputError

__all__ = [
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
    cr1, cr2 : float
        Their cR1 and cR2.
    isotropic_hardening : float
        Share by which the strength of a bar has grown when its strains reached both yield strains
        (Filippou, Popov and Bertero 1983).
    fatigue : float
        1 over the plastic work, over f_y d_y, that halves the strength of a bar.
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
    shear_stiffness : float
        Shear stiffness of the column over the uncracked one.
    plastic, misfit, contact, contact_axial, wear : float
        Of the concrete layers, see `rbsdem.ConcreteSpring`; the contact is 0.9 at most.
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
        `kappa_f` and `kappa_d` of `rbsdem.Pinching`.
    """

    strength: float
    hardening: float
    cap: float
    softening: float
    residual: float
    endurance: float
    pinch_force: float
    pinch_slip: float

    def __post_init__(self) -> None:
        _take(self, "shear spring")


#: Names of parameters of the shear spring begin with this where both kinds stand together.
_SHEAR = "shear_"

_HINGE_NAMES = tuple(field.name for field in fields(HingeParameters))
_SHEAR_NAMES = tuple(field.name for field in fields(ShearParameters))

#: Names before 2026.
_OLD = {
    "roundness": "r0",
    "roundness_axial": "r0_axial",
    "roundness_loss": "cr1",
    "roundness_reach": "cr2",
    "growth": "isotropic_hardening",
    "core_fall": "core_softening",
    "cover_fall": "cover_softening",
    "shear_fall": "shear_softening",
}


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
        """The version, as "2026.1", or "2026.1 changed" where parameters differ from it."""
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
            Names as in `values`, such as ``steel_strength=1.0`` or ``shear_strength=1.1``.

        Raises
        ------
        InputError
            If a name is not known, or a value is not a finite number.
        """
        hinge, shear = {}, {}
        for name, value in values.items():
            if name in _HINGE_NAMES:
                hinge[name] = value
            elif name.startswith(_SHEAR) and name[len(_SHEAR) :] in _SHEAR_NAMES:
                shear[name[len(_SHEAR) :]] = value
            else:
                raise _unknown(name, list(self.values))
        return replace(self, hinge=replace(self.hinge, **hinge), shear=replace(self.shear, **shear))


def _take(given: HingeParameters | ShearParameters, what: str) -> None:
    """Make every value a float."""
    for field in fields(given):
        value = _core.number(getattr(given, field.name), f"{what}: {field.name}")
        if value - value != 0:
            raise InputError(f"{what}: {field.name} = {value} must be a finite number")
        object.__setattr__(given, field.name, value)


def _unknown(name: str, known: list[str]) -> InputError:
    if name in _OLD:
        return InputError(f"parameters: {name} is now {_OLD[name]}")
    (near,) = get_close_matches(name, known, n=1, cutoff=0.0)
    return InputError(f"parameters: {name!r} is not known; did you mean {near!r}?")


# The first version is fitted to 217 tests of the PEER Structural Performance Database: the hinge to
# the rectangular flexural ones (studies/fit_hinge.py), the shear spring to those that failed in
# shear or in shear after flexure (studies/fit_shear.py).
VERSIONS: dict[str, ModelParameters] = {
    "2026.1": ModelParameters(
        version="2026.1",
        hinge=HingeParameters(
            steel_strength=1.11,
            hardening=1.01,
            r0=11.8,
            r0_axial=1.01,
            cr1=0.902,
            cr2=0.326,
            isotropic_hardening=0.0839,
            fatigue=0.00426,
            concrete_strength=0.947,
            concrete_size=0.0984,
            peak_strain=1.05,
            confinement=0.81,
            core_softening=1.03,
            cover_softening=1.28,
            residual=0.297,
            hinge_length=0.976,
            hinge_axial=-0.535,
            hinge_depth=0.078,
            compression_length=1.77,
            slip_length=0.0133,
            slip_axial=-1.35,
            stiffness=0.981,
            stiffness_axial=1.37,
            shear_stiffness=0.698,
            plastic=1.83,
            misfit=0.31,
            contact=0.287,
            contact_axial=-0.573,
            wear=0.0476,
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
}
"""Parameters by version, the oldest first."""


def versions() -> tuple[str, ...]:
    """Return the known versions of the parameters, the oldest first."""
    return tuple(VERSIONS)


def parameters(version: str | None = None) -> ModelParameters:
    """Return the parameters of the layered model.

    Parameters
    ----------
    version : str, optional
        As "2026.1"; the newest one by default.

    Raises
    ------
    InputError
        If there is no such version.
    """
    if version is None:
        return next(reversed(VERSIONS.values()))
    if version not in VERSIONS:
        raise InputError(
            f"version = {version!r} of the layered model is not known; there are "
            f"{', '.join(VERSIONS)}"
        )
    return VERSIONS[version]
