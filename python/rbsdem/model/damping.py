"""Viscous damping of a column."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from rbsdem import _arguments, _core
from rbsdem.errors import InputError


@dataclass(frozen=True)
class Damping:
    """Damping in proportion to mass and stiffness, and of modes; the parts add up.

    Parameters
    ----------
    mass : float, optional
        Damping in proportion to the mass [1/s].
    stiffness : float, optional
        Damping in proportion to the stiffness of each joint [s].
    tangent : bool, optional
        Whether to use the present stiffness of the springs instead of the initial one. With the
        initial stiffness, a joint keeps its damping when it yields.
    modal : float or sequence of float, optional
        Damping ratios of the modes of the uncracked column: one for all modes, or one for each
        of the first modes. At most 500 bodies.

    Raises
    ------
    InputError
        If a value is not a number; its bounds are checked with the column that has the damping.
    """

    mass: float = 0.0
    stiffness: float = 0.0
    tangent: bool = False
    modal: float | Sequence[float] | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "damping")
        if self.modal is None:
            return
        ratios = _arguments.vector(self.modal, "damping: modal", shape="1 or m")
        if ratios.size == 0:
            raise InputError("damping: modal is empty; give a ratio, or None")
        # A single ratio is for all modes, whether it is in a list or not.
        modal = ratios.tolist()[0] if ratios.size == 1 else tuple(ratios.tolist())
        object.__setattr__(self, "modal", modal)

    @property
    def acts(self) -> bool:
        """Whether there is any damping."""
        return self.mass > 0 or self.stiffness > 0 or self.modal is not None

    @classmethod
    def rayleigh(
        cls, ratio: float, frequency_1: float, frequency_2: float, tangent: bool = False
    ) -> Damping:
        """Return damping by mass and stiffness that has a given ratio at two frequencies.

        Between these frequencies the ratio is smaller, outside them it is larger.

        Parameters
        ----------
        ratio : float
            Damping ratio, below 1.
        frequency_1, frequency_2 : float
            Two different frequencies [Hz].
        tangent : bool, optional
            As for `Damping`.

        Raises
        ------
        InputError
            If a frequency is not positive, or both are the same.
        """
        why = " (critical damping)"
        ratio = _arguments.number(ratio, "damping: ratio", least=0, below=1, why=why)
        omega = []
        for name, value in (("frequency_1", frequency_1), ("frequency_2", frequency_2)):
            frequency = _arguments.number(value, f"damping: {name}", above=0, unit="Hz")
            omega.append(2.0 * math.pi * frequency)
        if omega[0] == omega[1]:
            raise InputError(
                f"damping: frequency_1 and frequency_2 are both {frequency_1} Hz; "
                "they must be different"
            )
        # ratio = mass / (2 omega) + stiffness omega / 2 at both frequencies.
        stiffness = 2.0 * ratio / (omega[0] + omega[1])
        return cls(mass=stiffness * omega[0] * omega[1], stiffness=stiffness, tangent=tangent)

    def statement(self) -> _core.Statement:
        """Return the keys of the damping, as a group of a case file."""
        modal = self.modal if self.modal is None or isinstance(self.modal, tuple) else (self.modal,)
        values = {"mass": self.mass, "stiffness": self.stiffness, "tangent": self.tangent or None}
        return _core.group("damping", values | {"modal": modal})
