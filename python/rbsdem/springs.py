"""Joint springs: a rule and its numbers.

Deformation and force are slip [m] and shear [N], or rotation [rad] and moment [N m]; the units
below are those of a shear spring.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.errors import InputError


@dataclass(frozen=True)
class Spring:
    """What all springs share."""

    #: Name of the rule in the Fortran part.
    rule: ClassVar[str] = ""

    def __post_init__(self) -> None:
        if not self.rule:
            raise TypeError(
                "Spring is the base of Elastic, Bilinear, Takeda, PeakOriented, Pinching, "
                "Compression, ConcreteSpring, SteelSpring and Layered; use one of them"
            )
        for field in fields(self):
            given = getattr(self, field.name)
            if field.name in ("inner", "layers"):
                continue
            if not (given is None and field.default is None):
                name = f"{self.rule} spring: {field.name}"
                value = _core.number(given, name)
                object.__setattr__(self, field.name, value)
        _core.check_spring(self.rule, self.numbers(), self._inner())

    def _inner(self) -> str:
        return str(getattr(self, "inner", "kc"))

    def numbers(self) -> Array:
        """Return the numbers in the order of the Fortran part, `UNSET` for those without."""
        given = (getattr(self, name, None) for name in _core.SPRING_NUMBERS)
        return np.array([_core.UNSET if value is None else value for value in given])

    def codes(self) -> tuple[int, int, int]:
        """Return the places (from 1) of rule and inner rule, and the number of layers."""
        layers = len(getattr(self, "layers", ()))
        return _core.RULES.index(self.rule) + 1, _core.INNER.index(self._inner()) + 1, layers

    def response(self, deformation: ArrayLike) -> Array:
        """Return the force along a path of deformation.

        The path begins at the virgin state (zero) and runs straight from point to point; the force
        at a point is exact and does not depend on further points in between.

        Parameters
        ----------
        deformation : array_like, shape (m,)
            Deformations, one after the other [m or rad].

        Returns
        -------
        ndarray, shape (m,)
            Forces [N or N m].

        Raises
        ------
        InputError
            If the array has not one dimension or holds a value that is not finite.
        """
        path = _core.finite_vector(deformation, "deformation")
        if path.size == 0:
            return np.empty(0)
        return _core.spring_response(self.rule, self.numbers(), self._inner(), path)


@dataclass(frozen=True)
class Elastic(Spring):
    """Spring on one straight line.

    Parameters
    ----------
    k : float
        Stiffness [N/m].
    """

    rule: ClassVar[str] = "elastic"
    k: float


@dataclass(frozen=True)
class Bilinear(Spring):
    """Bilinear spring with kinematic hardening (paper, table 1).

    Parameters
    ----------
    k : float
        Initial stiffness [N/m].
    d_y : float
        Yield deformation [m].
    k_post : float
        Stiffness after yield [N/m], from 0 to below `k`.

    Raises
    ------
    InputError
        If a number is outside the rule.
    """

    rule: ClassVar[str] = "bilinear"
    k: float
    d_y: float
    k_post: float


@dataclass(frozen=True)
class Takeda(Spring):
    """Trilinear Takeda spring with degradation factors (paper, table 1 and eq 7).

    Parameters
    ----------
    k_c : float
        Uncracked stiffness [N/m].
    d_c : float
        Cracking deformation [m].
    k_y : float
        Cracked stiffness [N/m], below `k_c`.
    d_y : float
        Yield deformation [m], above `d_c`.
    k_u : float
        Stiffness after yield [N/m], from 0 to `k_y`.
    b0 : float, optional
        Exponent of the outer unloading stiffness K_r = K_0 (d_y/|D_m|)^b0.
    b1 : float, optional
        Factor of the inner unloading stiffness. The default of 1 leaves K_r (Takeda 1970).
    inner : {"kc", "kr", "one"}, optional
        Inner unloading stiffness: b1 k_c, b1 K_r, or K_r. Always between the secant to the zero
        crossing of the excursion and K_r.

    Raises
    ------
    InputError
        If a number is outside the rule.
    """

    rule: ClassVar[str] = "takeda"
    k_c: float
    d_c: float
    k_y: float
    d_y: float
    k_u: float
    b0: float = 0.4
    b1: float = 1.0
    inner: str = "kc"


@dataclass(frozen=True)
class PeakOriented(Spring):
    """Spring with a capped backbone, peak-oriented reloading and cyclic deterioration.

    Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, 1489-1511), with a cracking
    point and an unloading stiffness that may fall with ductility. ``docs/rules.md`` has its lines.

    Parameters
    ----------
    d_y, f_y : float
        Yield point [m], [N].
    d_cap, f_cap : float
        Capping point, the largest force [m], [N]; from `d_y`, `f_y` on.
    d_pc : float
        From the cap along the softening line to where it would have no force left [m].
    f_res : float, optional
        Residual force, which softening does not fall below [N]; from 0 to below `f_y`.
    d_u : float, optional
        Deformation beyond which the force falls to zero [m]. The default is none.
    d_c, f_c : float, optional
        Cracking point [m], [N]. The default of 0 is elastic up to yield.
    b0 : float, optional
        Exponent of the unloading stiffness K_0 (d_y/|D_m|)^b0, K_0 = (f_c + f_y)/(d_c + d_y).
    lambda_s, lambda_c, lambda_k, lambda_a : float, optional
        Energy that deterioration lasts for, over f_y d_y (mean of both sides): of the strength, of
        the softening line, of the unloading stiffness, of the target of reloading. 0: none.
    c : float, optional
        Exponent of deterioration: an excursion that dissipates E takes the share
        (E/(lambda f_y d_y - sum E))^c.
    d_y_neg, f_y_neg, d_cap_neg, f_cap_neg, d_pc_neg, f_res_neg, d_u_neg, d_c_neg, f_c_neg : float
        The backbone of the negative side, as positive numbers. What is not given is as on the
        positive side.

    Raises
    ------
    InputError
        If a number is outside the rule.
    """

    rule: ClassVar[str] = "peak_oriented"
    d_y: float
    f_y: float
    d_cap: float
    f_cap: float
    d_pc: float
    f_res: float = 0.0
    d_u: float | None = None
    d_c: float = 0.0
    f_c: float = 0.0
    b0: float = 0.0
    lambda_s: float = 0.0
    lambda_c: float = 0.0
    lambda_k: float = 0.0
    lambda_a: float = 0.0
    c: float = 1.0
    d_y_neg: float | None = None
    f_y_neg: float | None = None
    d_cap_neg: float | None = None
    f_cap_neg: float | None = None
    d_pc_neg: float | None = None
    f_res_neg: float | None = None
    d_u_neg: float | None = None
    d_c_neg: float | None = None
    f_c_neg: float | None = None


@dataclass(frozen=True, kw_only=True)
class Pinching(PeakOriented):
    """The peak-oriented spring with pinched reloading, for shear cracks and slip of bars.

    Parameters
    ----------
    kappa_f : float
        Force at the break of the reloading line, over that of the straight line to the peak there;
        above 0, up to 1.
    kappa_d : float
        The break is at the deformation (1 - kappa_d) times the permanent deformation of the peak;
        above 0, up to 1.
    d_y, f_y, d_cap, f_cap, d_pc, f_res, d_u, d_c, f_c, b0 : float
        As of `PeakOriented`, by name.
    lambda_s, lambda_c, lambda_k, lambda_a, c : float, optional
        As of `PeakOriented`.
    d_y_neg, f_y_neg, d_cap_neg, f_cap_neg, d_pc_neg, f_res_neg, d_u_neg, d_c_neg, f_c_neg : float
        As of `PeakOriented`.

    Raises
    ------
    InputError
        If a number is outside the rule.
    """

    rule: ClassVar[str] = "pinching"
    kappa_f: float
    kappa_d: float


@dataclass(frozen=True)
class Compression(Spring):
    """Axial spring that carries compression only: an open joint without tension.

    Parameters
    ----------
    k : float
        Stiffness in compression [N/m]. Opening and tension are positive: the force is k w for
        w < 0, else 0.

    Raises
    ------
    InputError
        If the stiffness is not positive.
    """

    rule: ClassVar[str] = "compression"
    k: float


@dataclass(frozen=True)
class ConcreteSpring(Spring):
    """Concrete across a joint: crushes in compression, opens without tension, closes gradually.

    For axial springs and the layers of `Layered`. Opening and tension are positive, so that it
    works at negative deformations; the numbers here are positive.

    Parameters
    ----------
    k : float
        Stiffness at first [N/m].
    f_peak, d_peak : float
        Largest compression [N] and the closing there [m]; the curve up to it is that of Popovics
        (1973), so `f_peak` is below k d_peak.
    k_fall : float
        How fast the force falls behind the peak [N/m], positive.
    f_res : float, optional
        Force that is left [N].
    plastic : float, optional
        Factor of the plastic closing of Karsan and Jirsa (1969).
    contact : float, optional
        Share of the force at unloading at which a closing crack is fully closed, below 1.
    misfit : float, optional
        Share of the widest opening at which the faces of a closing crack touch, below 1.
    wear : float, optional
        Share of the strength that is lost each time the crack closes and opens again, below 1.

    Raises
    ------
    InputError
        If a number is outside the rule.
    """

    rule: ClassVar[str] = "concrete"
    k: float
    f_peak: float
    d_peak: float
    k_fall: float
    f_res: float = 0.0
    plastic: float = 1.0
    contact: float = 0.0
    misfit: float = 0.0
    wear: float = 0.0


@dataclass(frozen=True)
class SteelSpring(Spring):
    """Steel that yields round: the curve of Menegotto and Pinto (1973) as straight lines.

    Parameters
    ----------
    k : float
        Elastic stiffness [N/m].
    f_y : float
        Yield force [N].
    k_post : float
        Stiffness of hardening [N/m], from 0 to below `k`.
    r0, r1, r2 : float, optional
        Roundness R = r0 (1 - r1 xi/(r2 + xi)) of a branch, xi the plastic excursion over the yield
        deformation; r1 is below 1.
    growth : float, optional
        Share by which the strength has grown when the deformation has reached from -d_y to d_y
        (Filippou, Popov and Bertero 1983); with the power 0.8 of the reach.
    endurance : float, optional
        Plastic work over f_y d_y at which the strength of new branches is half; 0: it stays.

    Raises
    ------
    InputError
        If a number is outside the rule.
    """

    rule: ClassVar[str] = "steel"
    k: float
    f_y: float
    k_post: float
    r0: float = 20.0
    r1: float = 0.925
    r2: float = 0.15
    growth: float = 0.0
    endurance: float = 0.0


@dataclass(frozen=True)
class Layered(Spring):
    """A joint as layers: normal springs across it that share a constant axial load.

    For flexural springs. Layer i opens by w + y_i theta; the opening w at the middle of the section
    follows from the equilibrium of the axial load. Positive rotation opens layers at positive y.

    Parameters
    ----------
    axial_load : float
        Axial load that the layers share, compression positive [N]; it stays constant.
    layers : sequence of (float, Spring)
        Distance of each layer from the middle of the section [m] and its spring: `ConcreteSpring`,
        `SteelSpring`, `Elastic`, `Bilinear` or `Compression`. At least two.

    Raises
    ------
    InputError
        If a layer is outside its rule, or the layers cannot carry the axial load.
    """

    rule: ClassVar[str] = "layered"
    axial_load: float
    layers: tuple[tuple[float, Spring], ...]

    def __post_init__(self) -> None:
        try:
            layers = tuple((y, spring) for y, spring in self.layers)
        except (TypeError, ValueError):
            raise InputError(
                "layered spring: layers must be a sequence of pairs of a distance [m] and a spring"
            ) from None
        for number, (_, spring) in enumerate(layers, 1):
            if not isinstance(spring, Spring):
                raise InputError(
                    f"layered spring: layer {number} has {spring!r}; it must be a spring "
                    "(ConcreteSpring, SteelSpring, Elastic, Bilinear, Compression)"
                )
        layers = tuple(
            (_core.number(y, f"layered spring: y of layer {number}"), spring)
            for number, (y, spring) in enumerate(layers, 1)
        )
        object.__setattr__(self, "layers", layers)
        super().__post_init__()

    def numbers(self) -> Array:
        """Return the numbers, and behind them place, rule and numbers of each layer."""
        parts = [super().numbers()]
        for y, spring in self.layers:
            parts += [np.array([y, spring.codes()[0]]), spring.numbers()]
        return np.concatenate(parts)
