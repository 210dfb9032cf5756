"""The envelope of a cyclic curve to one side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from rbsdem._arguments import Array
from rbsdem.curves.curve import Curve, columns, loop_pair
from rbsdem.curves.idealise import Idealisation, Method, crossing, idealise
from rbsdem.curves.strength import beyond
from rbsdem.errors import InputError

__all__ = ["Envelope", "envelope"]


@dataclass(frozen=True, eq=False)
class Envelope:
    """The envelope of a curve to one side, from zero; displacements and forces are unsigned.

    Attributes
    ----------
    side : {1, -1}
        The side of the displacement.
    displacement : ndarray, shape (k,)
        Ascending from 0 [m]; twice the same where the force falls from one cycle to the next.
    force : ndarray, shape (k,)
        Forces there [N].
    """

    side: int
    displacement: Array
    force: Array

    @property
    def peak_force(self) -> float:
        """Largest force [N]."""
        return float(self.force.max())

    @property
    def displacement_at_peak(self) -> float:
        """Displacement at the largest force [m]."""
        return float(self.displacement[self.force.argmax()])

    @property
    def largest_displacement(self) -> float:
        """Displacement of the last point [m]."""
        return float(self.displacement[-1])

    def force_at(self, displacement: float) -> float:
        """Return the force at a displacement [N], linear between points.

        Parameters
        ----------
        displacement : float
            From 0 to that of the last point [m].

        Raises
        ------
        InputError
            If it is beyond the envelope.
        """
        if not 0 <= displacement <= self.largest_displacement:
            raise InputError(
                f"displacement = {displacement:g} m must be from 0 to the end of the envelope, "
                f"{self.largest_displacement:g} m"
            )
        return float(np.interp(displacement, self.displacement, self.force))

    def displacement_at(self, share: float, *, falling: bool = False) -> float:
        """Return where the force reaches a share of its peak [m].

        Parameters
        ----------
        share : float
            Share of the peak force, above 0 and up to 1.
        falling : bool, optional
            Behind the peak, where the force is down to the share, instead of before it.

        Returns
        -------
        float
            The displacement; NaN if the force does not fall so far.
        """
        if not 0 < share <= 1:
            raise InputError(f"share = {share} must be above 0 and up to 1")
        return crossing(self.displacement, self.force, share * self.peak_force, falling=falling)

    def idealise(self, method: Method = "asce_41", *, end: float | None = None) -> Idealisation:
        """Replace the envelope by two straight lines.

        Parameters
        ----------
        method : {"asce_41", "ec_8", "park", "equal_energy"}, optional
            "asce_41": ASCE 41-17, 7.4.3.2.4: initial line through 0.6 of the yield force, equal
            areas up to `end`; of several such yield forces, none above the largest force, the
            highest. "ec_8": EN 1998-1:2004, B.3: elastic and perfectly plastic, the force
            at `end`, equal areas. "park": Park 1988: secant through 0.75 of the peak force,
            extended to it. "equal_energy": ASTM E2126: secant through 0.4 of the peak force, equal
            areas up to a loss of 20 %.
        end : float, optional
            Displacement up to which areas are equal [m], for "asce_41" and "ec_8"; by default that
            of the peak force.

        Returns
        -------
        Idealisation
            Yield point, stiffness, end and ductility.

        Raises
        ------
        InputError
            If the method is not known, or the envelope has no such lines.
        """
        return idealise(self.displacement, self.force, method, end)

    def __repr__(self) -> str:
        return (
            f"Envelope({'+' if self.side > 0 else '-'}, peak {self.peak_force:.4g} N at "
            f"{self.displacement_at_peak:.4g} m, up to {self.largest_displacement:.4g} m)"
        )


def envelope(curve: Curve, side: Literal[1, -1] = 1) -> Envelope:
    """Return the envelope of a cyclic curve to one side.

    Of the curve those parts are kept that go beyond the largest displacement so far, from where
    they cross it; of a test with noise these are many points, of a static path its corners.

    Parameters
    ----------
    curve : Result, PeerTest or pair of arrays
        Displacement [m] and force [N]. Of a response in time the base shear is taken.
    side : {1, -1}, optional
        The side of the displacement.

    Raises
    ------
    InputError
        If the curve has no displacement with a force to that side.
    """
    d, f = columns(("displacement", "force"), *loop_pair(curve, "the curve"))
    _, x, y = beyond(d, f, side)
    if x.size == 0 or not y.max() > 0:
        way = "positive" if side > 0 else "negative"
        raise InputError(
            f"the curve has no force against a {way} displacement; an envelope needs one to that "
            f"side, so give side = {-side} or another curve"
        )
    return Envelope(side, np.concatenate(([0.0], x)), np.concatenate(([0.0], y)))
