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


@dataclass(frozen=True)
class Spring:
    """What all springs share."""

    #: Name of the rule in the Fortran part.
    rule: ClassVar[str] = ""

    def __post_init__(self) -> None:
        if not self.rule:
            raise TypeError(
                "Spring is the base of Elastic, Bilinear, Takeda and Compression; use one of them"
            )
        for field in fields(self):
            if field.name != "inner":
                name = f"{self.rule} spring: {field.name}"
                value = _core.number(getattr(self, field.name), name)
                object.__setattr__(self, field.name, value)
        _core.check_spring(self.rule, self.numbers(), self._inner())

    def _inner(self) -> str:
        return str(getattr(self, "inner", "kc"))

    def numbers(self) -> Array:
        """Return the numbers in the order of the Fortran part, shape (9,)."""
        return np.array([getattr(self, name, _core.UNSET) for name in _core.SPRING_NUMBERS])

    def codes(self) -> tuple[int, int]:
        """Return the places (from 1) of rule and inner rule in the Fortran lists."""
        return _core.RULES.index(self.rule) + 1, _core.INNER.index(self._inner()) + 1

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
