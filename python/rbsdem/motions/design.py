"""Elastic spectra of codes, of tables and of records, as demands of a building."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError
from rbsdem.motions.motion import GroundMotion, checked_motion

Soil = Literal["A", "B", "C", "D", "E"]

#: S, T_B, T_C, T_D of the two types of spectra (EN 1998-1:2004, tables 3.2 and 3.3).
_SOILS: dict[int, dict[str, tuple[float, float, float, float]]] = {
    1: {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.20, 0.6, 2.0),
        "D": (1.35, 0.20, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    2: {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.10, 0.25, 1.2),
        "D": (1.8, 0.10, 0.30, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
}
#: Periods of tables and of means of records [s].
_PERIODS = np.concatenate(([0.0], np.geomspace(0.02, 10.0, 200)))
_USUAL = 0.05


def damping_factor(damping: float) -> float:
    """Return B = 4/(5.6 - ln(100 damping)), by which a spectrum of 5 % is divided.

    Parameters
    ----------
    damping : float
        Damping ratio. At 5 % the formula gives 1.0024.

    Notes
    -----
    FEMA 440, 6.3; ASCE 41-17, equation 2-11.
    """
    return 4.0 / (5.6 - math.log(100.0 * damping))


@dataclass(frozen=True, repr=False, eq=False)
class DesignSpectrum(Tabular):
    """An elastic spectrum of pseudo-acceleration; the class methods make one.

    Attributes
    ----------
    name : str
        Its source and parameters.
    corner : float
        T_C, the period at which its constant acceleration ends [s].
    """

    name: str
    corner: float
    _law: Callable[[Array], Array] = field(repr=False)

    @property
    def period(self) -> Array:
        """Periods of its table [s]."""
        return _PERIODS

    @property
    def acceleration(self) -> Array:
        """Pseudo-acceleration at these periods [m/s2]."""
        return self._law(_PERIODS)

    _columns = ("period s", "acceleration m/s2")

    def sa(self, period: float) -> float:
        """Return the pseudo-acceleration at a period [m/s2]."""
        period = _arguments.number(period, "period", least=0.0, unit="s")
        return float(self._law(np.array([period]))[0])

    def sd(self, period: float) -> float:
        """Return the displacement of an elastic oscillator of a period [m]."""
        return self.sa(period) * (period / (2.0 * math.pi)) ** 2

    def __repr__(self) -> str:
        return f"DesignSpectrum({self.name})"

    @classmethod
    def en_1998(
        cls, ag: float, soil: Soil = "B", *, kind: Literal[1, 2] = 1, damping: float = _USUAL
    ) -> DesignSpectrum:
        """Return the horizontal elastic spectrum of EN 1998-1:2004, 3.2.2.2.

        Parameters
        ----------
        ag : float
            Acceleration of the ground of type A, as a part of g.
        soil : {"A", "B", "C", "D", "E"}, optional
            Type of the ground.
        kind : {1, 2}, optional
            Type of the spectrum.
        damping : float, optional
            Damping ratio.
        """
        _arguments.choice(soil, "soil", get_args(Soil))
        if _arguments.integer(kind, "kind") not in _SOILS:
            raise InputError(f"kind = {kind} must be 1 or 2")
        ground = _part_of_g(ag, "ag")
        ratio = _ratio(damping)
        corners = _SOILS[kind][soil]
        eta = max(math.sqrt(10.0 / (5.0 + 100.0 * ratio)), 0.55)
        name = f"EN 1998-1 type {kind}, soil {soil}, a_g {ag:g} g, damping {100 * ratio:g} %"
        law = partial(_en_1998, ground * STANDARD_GRAVITY, corners, eta)
        return cls(name, corners[2], law)

    @classmethod
    def asce_41(
        cls, s_xs: float, s_x1: float, *, long_period: float = 8.0, damping: float = _USUAL
    ) -> DesignSpectrum:
        """Return the general spectrum of ASCE 41-17, 2.4.1.7, that of ASCE 7 at 5 %.

        Parameters
        ----------
        s_xs, s_x1 : float
            Accelerations at short periods and at 1 s, as parts of g.
        long_period : float, optional
            T_L [s].
        damping : float, optional
            Damping ratio; at 5 % B_1 is 1.
        """
        short, at_1_s = _part_of_g(s_xs, "s_xs"), _part_of_g(s_x1, "s_x1")
        ratio, last = _ratio(damping), _arguments.number(long_period, "long_period", above=0.0)
        corner = at_1_s / short
        if not corner < last:
            raise InputError(
                f"s_x1/s_xs = {corner:g} s must be below long_period = {last:g} s; is s_xs in g?"
            )
        factor = 1.0 if ratio == _USUAL else damping_factor(ratio)
        law = partial(_asce_41, short * STANDARD_GRAVITY, corner, last, factor)
        name = f"ASCE 41 S_XS {short:g}, S_X1 {at_1_s:g}, damping {100 * ratio:g} %"
        return cls(name, corner, law)

    @classmethod
    def table(
        cls,
        period: ArrayLike,
        acceleration: ArrayLike,
        *,
        corner: float | None = None,
        name: str = "table",
    ) -> DesignSpectrum:
        """Return a spectrum of points, linear between them.

        Parameters
        ----------
        period : array_like, shape (n,)
            Ascending from 0 or more [s].
        acceleration : array_like, shape (n,)
            Pseudo-accelerations [m/s2].
        corner : float, optional
            T_C [s]; without it 2 pi times the largest pseudo-velocity over the largest
            acceleration.
        name : str, optional
            Its name.
        """
        t = _arguments.finite_vector(period, "spectrum: period")
        a = _arguments.finite_vector(acceleration, "spectrum: acceleration")
        if t.size != a.size or t.size < 2:
            raise InputError(f"spectrum: {t.size} periods for {a.size} accelerations; give a pair")
        if t[0] < 0 or not (np.diff(t) > 0).all() or not (a > 0).all():
            raise InputError("spectrum: periods must ascend from 0, and accelerations be above 0")
        if corner is None:
            corner = 2.0 * math.pi * float((t * a).max() / (2.0 * math.pi) / a.max())
        corner = _arguments.number(corner, "spectrum: corner", above=0.0)
        return cls(_arguments.text(name, "spectrum: name"), corner, partial(_points, t, a))

    @classmethod
    def mean_of(cls, records: Sequence[GroundMotion], *, damping: float = _USUAL) -> DesignSpectrum:
        """Return the mean of the spectra of records, as they are scaled.

        Parameters
        ----------
        records : sequence of GroundMotion
            The records.
        damping : float, optional
            Damping ratio.
        """
        motions = [
            checked_motion(motion) for motion in _arguments.several(records, "records", "records")
        ]
        if not motions:
            raise InputError("records is empty; give at least one")
        spectra = [motion.spectrum(_PERIODS, damping).pseudo_acceleration for motion in motions]
        mean = np.mean(spectra, axis=0)
        return cls.table(_PERIODS, mean, name=f"mean of {len(motions)} records")


#: Largest accelerations that maps of hazard have, as parts of g.
_MOST_OF_G = {"ag": 2.0, "s_xs": 5.0, "s_x1": 3.0}


def _part_of_g(value: float, name: str) -> float:
    """Return a checked acceleration as a part of g."""
    hint = "; it is a part of g, as 0.3, and 2.45 m/s2 is 0.25"
    return _arguments.number(
        value, f"spectrum: {name}", above=0.0, most=_MOST_OF_G[name], hint=hint
    )


def _ratio(damping: float) -> float:
    """Return a checked ratio of damping."""
    hint = "; it is a ratio, not a percentage"
    return _arguments.number(damping, "spectrum: damping", above=0.0, most=0.5, hint=hint)


def _en_1998(
    ground: float, corners: tuple[float, float, float, float], eta: float, t: Array
) -> Array:
    """Return S_e of EN 1998-1, 3.2.2.2 at periods t [s]; `corners` are S, T_B, T_C, T_D [m/s2]."""
    soil, t_b, t_c, t_d = corners
    rise = 1.0 + t / t_b * (2.5 * eta - 1.0)
    held = np.maximum(t, t_c)
    fall = 2.5 * eta * t_c / held * np.minimum(t_d / held, 1.0)
    return np.asarray(ground * soil * np.where(t < t_b, rise, fall))


def _asce_41(short: float, corner: float, last: float, factor: float, t: Array) -> Array:
    """Return S_a of ASCE 41-17, 2.4.1.7 at periods t [s], divided by the factor of damping."""
    rise = (5.0 / factor - 2.0) * t / corner + 0.4
    held = np.maximum(t, corner)
    fall = corner / held / factor * np.minimum(last / held, 1.0)
    return np.asarray(short * np.where(t < 0.2 * corner, rise, fall))


def _points(period: Array, acceleration: Array, t: Array) -> Array:
    """Return a spectrum of points at periods t [s], linear between them."""
    outside = (t < period[0]) | (t > period[-1])
    if outside.any():
        raise InputError(
            f"spectrum: a period of {t[outside][0]:.3g} s is outside of its points, "
            f"{period[0]:g} to {period[-1]:g} s; give more of them"
        )
    return np.interp(t, period, acceleration)
