"""Concrete and reinforcing steel under a monotonic uniaxial strain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import UNSET, Array
from rbsdem.errors import InputError

__all__ = ["TENSION", "Concrete", "Steel", "tension_place"]

TENSION = ("zero", "bare", "ts")
"""Tension laws of concrete: no tension; up to f_t only; with tension stiffening beyond f_t."""


def tension_place(tension: str) -> int:
    """Return the place of a tension law in the Fortran list, from 1."""
    if tension not in TENSION:
        raise InputError(f"tension = {tension!r} is not known; it is one of {', '.join(TENSION)}")
    return TENSION.index(tension) + 1


@dataclass(frozen=True)
class Concrete:
    """Concrete; values that are not given follow from the strength.

    Compression follows Popovics' curve with n = 0.8 + f'c/17 and the faster decay of strong
    concrete past its peak (Collins and Mitchell 1991, the default of Response-2000).

    Parameters
    ----------
    fc : float
        Cylinder strength f'c [Pa], from 5e6 to 200e6.
    ft : float, optional
        Tensile strength [Pa]; 0.45 f'c^0.4 (MPa).
    ec : float, optional
        Modulus of elasticity [Pa]; 3320 sqrt(f'c) + 6900 (MPa).
    eps0 : float, optional
        Strain at the peak; f'c/E_c n/(n - 1). If given, n follows from it, so that E_c stays the
        initial slope.
    eps_spall : float, optional
        Strain at which the cover has spalled; used only with a confined core.

    Raises
    ------
    InputError
        If a number is refused.
    """

    fc: float
    ft: float | None = None
    ec: float | None = None
    eps0: float | None = None
    eps_spall: float = 0.006

    def __post_init__(self) -> None:
        for name in ("fc", "eps_spall"):
            object.__setattr__(self, name, _core.number(getattr(self, name), f"concrete: {name}"))
        for name in ("ft", "ec", "eps0"):
            if getattr(self, name) is not None:
                value = _core.number(getattr(self, name), f"concrete: {name}")
                object.__setattr__(self, name, value)
        _core.concrete_response(self.numbers(), 1, np.zeros(1))

    def numbers(self) -> list[float]:
        """Return the numbers in the order of the Fortran part."""
        given = (self.fc, self.ft, self.ec, self.eps0, self.eps_spall)
        return [UNSET if value is None else value for value in given]

    def stress(self, strain: ArrayLike, tension: str = "ts") -> Array:
        """Return the stress of the unconfined concrete.

        Parameters
        ----------
        strain : array_like
            Strains, compression positive.
        tension : {"ts", "bare", "zero"}, optional
            Tension law.

        Returns
        -------
        ndarray, shape of `strain`
            Stresses [Pa], compression positive.

        Raises
        ------
        InputError
            If a strain is not a finite number.
        """
        strain = np.asarray(strain)
        flat = _core.finite_vector(strain.ravel(), "strain")
        stress = _core.concrete_response(self.numbers(), tension_place(tension), flat)
        return stress.reshape(strain.shape)[()]


@dataclass(frozen=True)
class Steel:
    """Reinforcing steel: elastic, then a yield plateau, a parabola to the largest stress, rupture.

    The same in tension and compression (Response-2000, manual table 2-2).

    Parameters
    ----------
    fy : float
        Yield stress [Pa].
    fu : float, optional
        Largest stress [Pa]; by default 1.5 `fy`.
    es : float, optional
        Modulus of elasticity [Pa].
    eps_sh : float, optional
        Strain at which hardening begins.
    eps_u : float, optional
        Strain of the largest stress, and of rupture.

    Raises
    ------
    InputError
        If a number is refused.
    """

    fy: float
    fu: float | None = None
    es: float = 200e9
    eps_sh: float = 0.007
    eps_u: float = 0.1

    def __post_init__(self) -> None:
        if self.fu is None:
            object.__setattr__(self, "fu", 1.5 * _core.number(self.fy, "steel: fy"))
        for name in ("fy", "fu", "es", "eps_sh", "eps_u"):
            object.__setattr__(self, name, _core.number(getattr(self, name), f"steel: {name}"))
        _core.steel_response(self.numbers(), np.zeros(1))

    def numbers(self) -> list[float]:
        """Return the numbers in the order of the Fortran part."""
        return [self.fy, float(self.fu or 0.0), self.es, self.eps_sh, self.eps_u]

    def stress(self, strain: ArrayLike) -> Array:
        """Return the stress.

        Parameters
        ----------
        strain : array_like
            Strains.

        Returns
        -------
        ndarray, shape of `strain`
            Stresses [Pa], with the sign of the strain.

        Raises
        ------
        InputError
            If a strain is not a finite number.
        """
        strain = np.asarray(strain)
        flat = _core.finite_vector(strain.ravel(), "strain")
        return _core.steel_response(self.numbers(), flat).reshape(strain.shape)[()]
