"""The column: rigid bodies joined by springs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import UNSET
from rbsdem.errors import InputError
from rbsdem.springs import Spring

#: Standard acceleration of gravity [m/s2].
STANDARD_GRAVITY = 9.80665


@dataclass(frozen=True)
class Column:
    """A column of `n` rigid bodies on `n` joints; joint i is at the bottom of body i.

    Parameters
    ----------
    height : float
        Height of the column [m].
    mass : float or None
        Mass of the column [kg], spread in proportion to the lengths; None if `masses` are given.
    shear, flexure : Spring or sequence of n Spring
        Springs of the joints: one for every joint, or one for each from the ground up.
    n : int, optional
        Number of bodies.
    axial_load : float, optional
        Axial load at the top, compression positive [N]. It takes part with `kinematics` "pdelta"
        and "finite" only.
    kinematics : {"small", "pdelta", "finite"}, optional
        Linear in slips and rotations (paper, eqs 1-3, 5); the same with the second-order work of
        the axial load; exact rotations (paper, eq 4 corrected, for n = 1).
    lengths, masses : array_like, shape (n,), optional
        Lengths [m], adding up to the height, and masses [kg] of the bodies.
    self_weight : bool, optional
        Whether the weight of the bodies acts too.
    gravity : float, optional
        Acceleration of gravity for the weight [m/s2].
    mass_damping, stiffness_damping : float, optional
        Damping in proportion to the mass [1/s] and to the initial stiffness of each joint [s].

    Raises
    ------
    InputError
        With a line for everything that is wrong.
    """

    height: float
    mass: float | None
    shear: Spring | Sequence[Spring]
    flexure: Spring | Sequence[Spring]
    n: int = 1
    axial_load: float = 0.0
    kinematics: str = "small"
    lengths: ArrayLike | None = None
    masses: ArrayLike | None = None
    self_weight: bool = False
    gravity: float = STANDARD_GRAVITY
    mass_damping: float = 0.0
    stiffness_damping: float = 0.0

    def __post_init__(self) -> None:
        def put(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        put("n", _core.whole(self.n, "column: n"))
        for name in ("height", "axial_load", "gravity", "mass_damping", "stiffness_damping"):
            put(name, _core.number(getattr(self, name), f"column: {name}"))
        if self.mass is not None:
            put("mass", _core.number(self.mass, "column: mass"))
        for name in ("lengths", "masses"):
            if getattr(self, name) is not None:
                parts = _core.vector(getattr(self, name), f"column: {name}")
                if parts.size == 0:
                    raise InputError(f"column: {name} is empty; give one for each of the n bodies")
                put(name, tuple(parts.tolist()))
        for name in ("shear", "flexure"):
            put(name, _springs(getattr(self, name), name))
        _core.check_column(self._flat())

    def _flat(self) -> dict[str, Any]:
        """Return the column as the arguments that every flat procedure begins with."""
        shear, flexure = _sequence(self.shear), _sequence(self.flexure)
        return {
            "n": self.n,
            # Without runs of blanks: the Fortran part reads the first letters of a long word.
            "kinematics": " ".join(str(self.kinematics).split()),
            "numbers": np.array(
                [
                    self.height,
                    UNSET if self.mass is None else self.mass,
                    self.axial_load,
                    float(bool(self.self_weight)),
                    self.gravity,
                    self.mass_damping,
                    self.stiffness_damping,
                ]
            ),
            "lengths": np.array([UNSET] if self.lengths is None else self.lengths, dtype=float),
            "masses": np.array([UNSET] if self.masses is None else self.masses, dtype=float),
            "shear": np.array([spring.numbers() for spring in shear]).T.copy(order="F"),
            "codes_shear": _codes(shear),
            "flexure": np.array([spring.numbers() for spring in flexure]).T.copy(order="F"),
            "codes_flexure": _codes(flexure),
        }


def _springs(springs: Any, name: str) -> Spring | tuple[Spring, ...]:
    """Return one spring, or a tuple of them."""
    if isinstance(springs, Spring):
        return springs
    try:
        several = tuple(springs)
    except TypeError:
        several = (springs,)
    for spring in several:
        if not isinstance(spring, Spring):
            raise InputError(
                f"column: {name} = {spring!r} must be a spring (Elastic, Bilinear, Takeda) "
                "or a sequence of them"
            )
    if not several:
        raise InputError(f"column: {name} is empty; give one spring, or one for each joint")
    return several


def _sequence(springs: Spring | Sequence[Spring]) -> Sequence[Spring]:
    return (springs,) if isinstance(springs, Spring) else springs


def _codes(springs: Sequence[Spring]) -> np.ndarray:
    return np.array([spring.codes() for spring in springs], dtype=np.int32).T.copy(order="F")
