"""Drifts and backbones of a cantilever that follow from code values: one definition of each."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rbsdem._arguments import Array
from rbsdem.checks.code_values import CodeValues

__all__ = ["DRIFTS_AT_LOSS", "Backbone", "backbones", "drift_at_loss", "yield_drift"]


def yield_drift(values: CodeValues, stiffness: str) -> float:
    """Return the drift at yield of a cantilever with a share of its gross stiffness.

    M_y L/(3 E I) with E = 4700 sqrt(f'c) and I of the gross section.

    Parameters
    ----------
    values : CodeValues
        The column.
    stiffness : str
        Name of the share, as "asce_41.stiffness".
    """
    q = values.quantities
    inertia = math.pi * q.depth**4 / 64 if q.round else q.width * q.depth**3 / 12
    modulus = 4700.0 * math.sqrt(q.fc)
    return values["yield.moment"] * 1e3 * q.span / (3.0 * values[stiffness] * modulus * inertia)


def _haselton(values: CodeValues, cap: float, post_cap: float) -> float:
    """Return the drift at which a fifth of the strength is lost behind the cap."""
    turned = cap * values["haselton.cap"] + 0.2 * post_cap * values["haselton.post_cap"]
    return yield_drift(values, "haselton.stiffness") + turned


#: Drift at a loss of 20 % of the strength by each source.
DRIFTS_AT_LOSS: dict[str, Callable[[CodeValues], float]] = {
    "ASCE 41-17, yield + a": lambda values: (
        yield_drift(values, "asce_41.stiffness") + values["asce_41.a"]
    ),
    "EN 1998-3, theta_um (A.1)": lambda values: values["ec_8.ultimate"],
    "EN 1998-3, theta_y + theta_um,pl (A.3)": lambda values: (
        values["ec_8.yield"] + values["ec_8.plastic"]
    ),
    "Haselton, one push: cap + 0.2 post-cap": lambda values: _haselton(values, 1.0, 1.0),
    # 2016, eqs 12 and 13
    "Haselton, cyclic envelope": lambda values: _haselton(values, 0.7, 0.5),
    "Elwood, Moehle 2005, shear": lambda values: values["elwood.shear_drift"],
    # Drifts at bar buckling, which come later.
    "Berry, Eberhard 2005, yield + buckling": lambda values: (
        yield_drift(values, "elwood.stiffness") + values["berry.rotation"]
    ),
    "Berry, Eberhard 2003, buckling": lambda values: values["berry.buckling"],
}


def drift_at_loss(values: CodeValues, name: str) -> float:
    """Return a drift of `DRIFTS_AT_LOSS`; NaN where the source does not cover the column."""
    try:
        return DRIFTS_AT_LOSS[name](values)
    except ValueError:
        return math.nan


@dataclass(frozen=True, eq=False)
class Backbone:
    """A backbone of one source, from zero.

    Attributes
    ----------
    name, source : str
        Short name, and where it comes from.
    drift, moment : ndarray, shape (k,)
        Drift ratios, and moments at the foot [N m].
    """

    name: str
    source: str
    drift: Array
    moment: Array

    def force(self, span: float, axial_load: float) -> Array:
        """Return the lateral force [N]: moment over span less the second-order force.

        Parameters
        ----------
        span : float
            From the foot to the lateral force [m].
        axial_load : float
            What leans with the column [N]; 0 without second-order effects.
        """
        return self.moment / span - axial_load * self.drift


def backbones(values: CodeValues) -> list[Backbone]:
    """Return the backbones of the sources that cover a column.

    All yield at "yield.moment", as none of them is about strength. ASCE 41: flat over a, down to
    c, which lasts to b. EN 1998-3: flat up to theta_um, where a fifth is lost. Elwood: flat up to
    shear failure, then down to axial failure; left out where that comes first. Haselton: to the
    cap, then down to zero, under one push.
    """
    names = set(values.names())
    if "yield.moment" not in names:
        return []
    moment = values["yield.moment"]

    def line(name: str, source: str, *points: tuple[float, float]) -> Backbone:
        drift, share = np.array([(0.0, 0.0), *points]).T
        return Backbone(name, source, drift, moment * share)

    found = []
    if "asce_41.a" in names:
        at, c = yield_drift(values, "asce_41.stiffness"), values["asce_41.c"]
        a, b = at + values["asce_41.a"], at + values["asce_41.b"]
        points = [(at, 1.0), (a, 1.0), (a, c), (b, c), (b, 0.0)]
        found.append(line("ASCE 41", "ASCE 41-17, chapter 10 (ACI 369.1)", *points))
    if "ec_8.ultimate" in names:
        at, end = values["ec_8.yield"], values["ec_8.ultimate"]
        found.append(
            line("EC 8-3", "EN 1998-3:2005, A.10b, A.1", (at, 1.0), (end, 1.0), (end, 0.8))
        )
    if "elwood.shear_drift" in names:
        at = yield_drift(values, "elwood.stiffness")
        shear, axial = values["elwood.shear_drift"], values["elwood.axial_drift"]
        if at < shear < axial:
            points = [(at, 1.0), (shear, 1.0), (axial, 0.0)]
            source = "Elwood, Eberhard 2009; Elwood, Moehle 2005"
            found.append(line("Elwood", source, *points))
    if "haselton.cap" in names:
        at = yield_drift(values, "haselton.stiffness")
        cap, hard = at + values["haselton.cap"], values["haselton.hardening"]
        end = cap + values["haselton.post_cap"]
        source = "Haselton 2008, 2016, one push"
        found.append(line("Haselton", source, (at, 1.0), (cap, hard), (end, 0.0)))
    return found
