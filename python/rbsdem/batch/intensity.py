"""Intensity measures of ground motions, each in proportion to the scale of the motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.motions.motion import GroundMotion, checked_motion
from rbsdem.solve.analysis import modes

Name = Literal["sa_t1", "pga", "sa_avg"]
NAMES: tuple[Name, ...] = ("sa_t1", "pga", "sa_avg")

#: Periods of the mean spectral acceleration as parts of the first one (Eads et al. 2015), and how
#: many there are, evenly spaced.
_AVERAGE = (0.2, 3.0, 10)


@dataclass(frozen=True)
class Intensity:
    """An intensity measure.

    Attributes
    ----------
    name : {"sa_t1", "pga", "sa_avg"}
        Pseudo-spectral acceleration at a period, peak ground acceleration, or geometric mean of
        the spectral accelerations at ten periods from 0.2 to 3 times that period [m/s2].
    period : float
        The period [s]; 0 for "pga".
    damping : float
        Damping ratio of the spectrum.
    """

    name: Name
    period: float
    damping: float

    def of(self, motion: GroundMotion) -> float:
        """Return the intensity of a motion at scale 1 [m/s2]."""
        if self.name == "pga":
            return motion.pga
        if self.name == "sa_t1":
            return motion.sa(self.period, self.damping)
        return motion.sa_avg(self.period * np.linspace(*_AVERAGE), self.damping)

    @property
    def label(self) -> str:
        """Name with unit, for figures and tables."""
        if self.name == "pga":
            return "PGA (m/s²)"
        mean = "Sa,avg" if self.name == "sa_avg" else "Sa"
        return f"{mean}({self.period:.3g} s, {100 * self.damping:g} %) (m/s²)"


def make_intensity(name: str, column: Column, period: float | None, damping: float) -> Intensity:
    """Return an intensity measure; its period is that of the column unless one is given."""
    _arguments.choice(name, "intensity", NAMES)
    if name == "pga":
        if period is not None:
            raise InputError("intensity: 'pga' has no period; leave period out, or take 'sa_t1'")
        return Intensity("pga", 0.0, 0.0)
    at = 1 / float(modes(column).frequency[0]) if period is None else period
    at, ratio = _arguments.number(at, "period"), _arguments.number(damping, "damping")
    if not 0 < at < 100:
        raise InputError(f"period = {at:g} s must be above 0 and below 100")
    return Intensity("sa_t1" if name == "sa_t1" else "sa_avg", at, ratio)


def motions_by_name(motions: Any) -> dict[str, GroundMotion]:
    """Return motions under their names, or raise `InputError` with all that is wrong."""
    if isinstance(motions, GroundMotion):
        motions = [motions]
    items: Iterable[tuple[str, Any]]
    if isinstance(motions, Mapping):
        items = [(str(name), motion) for name, motion in motions.items()]
    else:
        try:
            given = list(motions)
        except TypeError:
            raise InputError(
                f"motions = {type(motions).__name__} must be a GroundMotion, or several of them"
            ) from None
        items = [(getattr(m, "name", "") or str(i), m) for i, m in enumerate(given)]
    found: dict[str, GroundMotion] = {}
    faults = []
    for name, motion in items:
        try:
            checked_motion(motion, f"motion {name}: ")
        except InputError as error:
            faults.append(str(error))
            continue
        if name in found:
            faults.append(f"motions: two are called {name!r}; give a mapping {{name: motion}}")
        elif motion.pga == 0:
            faults.append(f"motion {name}: has no acceleration")
        found[name] = motion
    if not found and not faults:
        faults.append("motions is empty; give at least one GroundMotion")
    if faults:
        raise InputError("\n".join(faults))
    return found


def checked_levels(levels: Any) -> Array:
    """Return levels of intensity, ascending."""
    found = np.unique(_arguments.finite_vector(levels, "levels", shape="1 or m"))
    if found.size == 0 or found[0] <= 0:
        raise InputError("levels must be intensities above 0, in m/s2; give at least one")
    return found
