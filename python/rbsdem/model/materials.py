"""Concrete and reinforcing steel under a monotonic uniaxial strain."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Literal

from numpy.typing import ArrayLike

from rbsdem import _arguments, _core
from rbsdem._arguments import Array, Derived, given

Tension = Literal["ts", "bare", "zero"]
"""Tension laws of concrete: with tension stiffening beyond f_t; up to f_t only; no tension."""


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
        _arguments.convert(self, "concrete")
        self.stress(0.0)

    def statement(self) -> _core.Statement:
        """Return the keys of the concrete with their values."""
        return _core.group("concrete", {f.name: getattr(self, f.name) for f in fields(self)})

    def stress(self, strain: ArrayLike, tension: Tension = "ts") -> Array:
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
        strains = _arguments.finite_vector(strain, "strain", shape="any")
        law = self.statement() + _core.group("diagram", {"tension": tension})
        stress = _core.evaluate("concrete_response", law, strain=strains).values
        return stress.reshape(strains.shape)[()]


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
        _arguments.convert(self, "steel")
        if given(self.fu) is None:
            object.__setattr__(self, "fu", Derived(1.5 * self.fy))
        self.stress(0.0)

    def statement(self, number: int | None = None) -> _core.Statement:
        """Return the keys of the steel with their values; `number` is what bars refer to."""
        values = {f.name: given(getattr(self, f.name)) for f in fields(self)}
        return _core.group("steel", {"id": number} | values)

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
        strains = _arguments.finite_vector(strain, "strain", shape="any")
        stress = _core.evaluate("steel_response", self.statement(), strain=strains).values
        return stress.reshape(strains.shape)[()]
