"""What a measured loop says about its own labels, without a model of the column.

The force column of a test is net, or it is the base moment over the length; a label says which. A
loop whose base moment stays as it is has an envelope that falls by P/L if the force is net, and
that stays level if it is not.
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np

from rbsdem._arguments import Array
from rbsdem.errors import AccuracyWarning, RbsdemError
from rbsdem.measured.drawing import draw
from rbsdem.measured.measured import MeasuredTest
from rbsdem.measured.specimen import Specimen
from rbsdem.section.curvature import diagram

__all__ = ["Indicators", "indicators"]

#: Share of the largest drift beyond which the growth of the base moment is taken.
_OUTER = 0.4
#: Least part of a side's drift that must lie behind the largest force for a slope there.
_BEHIND = 0.3
#: Share of the largest force at which the first stiffness is taken.
_STIFFNESS_LEVEL = 0.5


@dataclass(frozen=True, slots=True)
class Indicators:
    """Numbers of one test that need no model; NaN where the test does not give them.

    Attributes
    ----------
    specimen : Specimen
        The test.
    second_order_share : float
        Moment of the axial load at the largest displacement over that of the force, both as in the
        file: below 0.2 it tells nothing about what the force is.
    slope : float
        Of the envelope of the force column behind its peak, in units of P (L + L_top)/L^2: about -1
        for a net force on a ductile column, about 0 for its base moment over the length.
    growth_labelled, growth_net, growth_effective : float
        Growth of the base moment over the outer 60 % of the drift, over the largest moment: by the
        label, with the force column as net, and as base moment over the length.
    strength : float
        Largest base moment by the label over the moment strength of the section.
    stiffness : float
        Secant at half the largest force over that of the uncracked gross cantilever.
    symmetry : float
        Largest force of the stronger side over that of the other.
    """

    specimen: Specimen
    second_order_share: float
    slope: float
    growth_labelled: float
    growth_net: float
    growth_effective: float
    strength: float
    stiffness: float
    symmetry: float


def indicators(specimen: Specimen) -> Indicators:
    """Return the indicators of a test.

    Parameters
    ----------
    specimen : Specimen
        A test with a history.

    Returns
    -------
    Indicators
        Means of both sides, where both have them.

    Raises
    ------
    InputError
        If the test has no history, or its section is refused.
    """
    with warnings.catch_warnings():
        # What a drawing assumes is said where a column is made.
        warnings.simplefilter("ignore", AccuracyWarning)
        return _indicators(specimen)


def _indicators(specimen: Specimen) -> Indicators:
    test = specimen.test()
    load = specimen.second_order_load
    length = specimen.length
    moments = {
        "labelled": test.base_moment,
        "net": test.measured_force * length + load * test.displacement,
        "effective": test.measured_force * length,
    }
    shares, slopes = [], []
    growths: dict[str, list[float]] = {name: [] for name in moments}
    for side in (1, -1):
        drift, force = _envelope(test.displacement, test.measured_force, side)
        if drift.size < 4 or not np.max(force) > 0:
            continue
        shares.append(load * drift[-1] / (float(np.max(force)) * length))
        if load > 0:
            slopes.append(_slope_behind_peak(drift, force) * length / load)
        for name, moment in moments.items():
            growths[name].append(_growth(*_envelope(test.displacement, moment, side)))
    return Indicators(
        specimen=specimen,
        second_order_share=_mean(shares),
        slope=_mean(slopes),
        growth_labelled=_mean(growths["labelled"]),
        growth_net=_mean(growths["net"]),
        growth_effective=_mean(growths["effective"]),
        strength=_strength(specimen, test),
        stiffness=_stiffness(specimen, test),
        symmetry=_symmetry(test),
    )


def _envelope(displacement: Array, force: Array, side: int) -> tuple[Array, Array]:
    """Return drift and force of a side, both positive, where the drift is larger than ever."""
    d, f = side * displacement, side * force
    before = np.maximum.accumulate(np.concatenate(([0.0], d)))[:-1]
    new = d > before
    return d[new], f[new]


def _slope_behind_peak(d: Array, f: Array) -> float:
    """Return the slope behind the largest force, every part of the drift alike."""
    peak = int(np.argmax(f))
    x, y = d[peak:], f[peak:]
    if x.size < 3 or x[-1] - x[0] < _BEHIND * x[-1]:
        return math.nan
    return _fitted_slope(x, y)


def _growth(d: Array, moment: Array) -> float:
    """Return the growth of the moment over the outer part of the drift, over its largest value."""
    largest = float(np.max(moment)) if moment.size else 0.0
    if d.size < 2 or not largest > 0:
        return math.nan
    return _fitted_slope(d, moment, _OUTER * d[-1]) * (1 - _OUTER) * float(d[-1]) / largest


def _fitted_slope(d: Array, f: Array, begin: float | None = None) -> float:
    """Return the slope of the line that fits a curve best between two drifts."""
    x = np.linspace(d[0] if begin is None else begin, d[-1], 50)
    return float(np.polyfit(x, np.interp(x, d, f), 1)[0])


def _mean(values: list[float]) -> float:
    known = [value for value in values if math.isfinite(value)]
    return float(np.mean(known)) if known else math.nan


def _strength(specimen: Specimen, test: MeasuredTest) -> float:
    """Return the largest base moment over the strength of the section, both sides alike."""
    try:
        section = draw(specimen).section
        peak = diagram(section, specimen.axial_load).events.peak
    except RbsdemError:
        return math.nan
    if peak is None or not peak.moment > 0:
        return math.nan
    return float(np.max(np.abs(test.base_moment))) / peak.moment


def _stiffness(specimen: Specimen, test: MeasuredTest) -> float:
    """Return the first secant at half the largest force over that of the gross cantilever."""
    force = np.abs(test.force)
    row = int(np.argmax(force >= _STIFFNESS_LEVEL * np.max(force)))
    d, f = float(test.displacement[row]), float(test.force[row])
    if not d * f > 0:
        return math.nan
    section = draw(specimen).section
    gross = 3 * section.concrete_law["ec"] * section.inertia / specimen.length**3
    return f / d / gross


def _symmetry(test: MeasuredTest) -> float:
    """Return the force of the stronger side over that of the other, if both were pushed as far."""
    up, down = float(np.max(test.displacement)), -float(np.min(test.displacement))
    # A side that was hardly loaded has not shown its strength.
    if not 0.5 < up / max(down, 1e-300) < 2.0:
        return math.nan
    strong, weak = float(np.max(test.force)), -float(np.min(test.force))
    strong, weak = max(strong, weak), min(strong, weak)
    return strong / weak if weak > 0 else math.nan
