"""The column: rigid bodies joined by springs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core
from rbsdem._core import UNSET
from rbsdem.damping import Damping
from rbsdem.errors import InputError
from rbsdem.springs import Spring

#: Standard acceleration of gravity [m/s2].
STANDARD_GRAVITY = 9.80665

_NUMBERS = (
    "height",
    "axial_load",
    "gravity",
    "top_mass",
    "top_inertia",
    "depth",
    "mass_damping",
    "stiffness_damping",
)
_SWITCHES = ("self_weight", "axial_follows", "force_follows")


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
        Number of bodies, up to 10000.
    axial_load : float, optional
        Axial load at the top, compression positive [N]. It takes part with `kinematics` "pdelta"
        and "finite", and where the joints open.
    kinematics : {"small", "pdelta", "finite"}, optional
        Linear in slips and rotations (paper, eqs 1-3, 5); the same with the second-order work of
        the axial load; exact rotations (paper, eq 4 corrected, for any n).
    lengths, masses : array_like, shape (n,), optional
        Lengths [m], adding up to the height, and masses [kg] of the bodies.
    self_weight : bool, optional
        Whether the weight of the bodies acts too.
    gravity : float, optional
        Acceleration of gravity for the weight [m/s2].
    mass_damping, stiffness_damping : float, optional
        Damping in proportion to the mass [1/s] and to the initial stiffness of each joint [s]; in
        place of `damping`.
    axial : Spring or sequence of n Spring, optional
        Axial springs of the joints, opening and tension positive: `Elastic`, `Bilinear` or
        `Compression`. Without them joints do not open.
    top_mass, top_inertia : float, optional
        Mass lumped at the top [kg] and its rotary inertia about the top [kg m2]. Its weight belongs
        to `axial_load`.
    depth : float, optional
        Depth of the section [m]; it adds m depth^2/12 to the rotary inertia of every body.
    rotary_inertia : float or array_like, shape (n,), optional
        Rotary inertia of the bodies about their centroids [kg m2], one for all or for each, in
        place of m (l^2 + depth^2)/12.
    axial_follows, force_follows : bool, optional
        Whether the axial load, and the lateral force, turn with the top body; `kinematics` "finite"
        only.
    damping : float or Damping, optional
        Viscous damping; a number is the damping ratio of every mode.

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
    axial: Spring | Sequence[Spring] | None = None
    top_mass: float = 0.0
    top_inertia: float = 0.0
    depth: float = 0.0
    rotary_inertia: ArrayLike | None = None
    axial_follows: bool = False
    force_follows: bool = False
    damping: float | Damping | None = None

    def __post_init__(self) -> None:
        def put(name: str, value: Any) -> None:
            object.__setattr__(self, name, value)

        put("n", _core.whole(self.n, "column: n"))
        for name in _NUMBERS:
            put(name, _core.number(getattr(self, name), f"column: {name}"))
        for name in _SWITCHES:
            put(name, _core.switch(getattr(self, name), f"column: {name}"))
        if self.mass is not None:
            put("mass", _core.number(self.mass, "column: mass"))
        for name in ("lengths", "masses", "rotary_inertia"):
            if getattr(self, name) is not None:
                put(name, _parts(getattr(self, name), name))
        put("shear", _springs(self.shear, "shear"))
        put("flexure", _springs(self.flexure, "flexure"))
        if self.axial is not None:
            put("axial", _springs(self.axial, "axial"))
        put("damping", self._damping())
        # Once for all analyses: what is frozen does not change.
        put("_packed", self._pack())
        _core.check_column(self._packed)

    @property
    def unknowns(self) -> int:
        """Number of joint deformations: 2n, or 3n where the joints open."""
        return (2 if self.axial is None else 3) * self.n

    def _damping(self) -> Damping | None:
        if self.damping is None:
            return None
        if self.mass_damping or self.stiffness_damping:
            raise InputError(
                "column: both damping and mass_damping or stiffness_damping are given; "
                "keep the one that is meant (Damping has both)"
            )
        if isinstance(self.damping, Damping):
            return self.damping
        return Damping(modal=_core.number(self.damping, "column: damping"))

    def _pack(self) -> _core.Packed:
        """Return the column as two arrays and a word, in the order of `rbs_flat_pack`."""
        damping = self.damping or Damping(self.mass_damping, self.stiffness_damping)
        lists = [self.lengths, self.masses, self.rotary_inertia, damping.ratios()]
        springs = [_sequence(springs) for springs in (self.shear, self.flexure, self.axial)]
        codes = [self.n, *(getattr(self, name) for name in _SWITCHES), damping.tangent]
        codes += [len(part or ()) for part in (*lists, *springs)]
        numbers = [
            self.height,
            UNSET if self.mass is None else self.mass,
            self.axial_load,
            self.gravity,
            self.top_mass,
            self.top_inertia,
            self.depth,
            damping.mass,
            damping.stiffness,
        ]
        for part in lists:
            numbers += part or ()
        for several in springs:
            for spring in several:
                codes += spring.codes()
                numbers += spring.numbers().tolist()
        return np.array(codes, dtype=np.int32), np.array(numbers), _core.word(self.kinematics)


def _parts(values: ArrayLike, name: str) -> tuple[float, ...]:
    """Return one number for each body; one for all of them is allowed for rotary inertia."""
    parts = _core.vector(
        np.atleast_1d(values) if name == "rotary_inertia" else values, f"column: {name}"
    )
    if parts.size == 0:
        raise InputError(f"column: {name} is empty; give one for each of the n bodies")
    return tuple(parts.tolist())


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
                f"column: {name} = {spring!r} must be a spring (Elastic, Bilinear, Takeda, "
                "PeakOriented, Pinching, for axial also Compression) or a sequence of them"
            )
    if not several:
        raise InputError(f"column: {name} is empty; give one spring, or one for each joint")
    return several


def _sequence(springs: Spring | Sequence[Spring] | None) -> Sequence[Spring]:
    if springs is None:
        return ()
    return (springs,) if isinstance(springs, Spring) else springs
