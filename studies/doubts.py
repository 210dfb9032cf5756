"""Which measured tests are doubtful, by rules that know no model of the column.

    python studies/doubts.py FOLDER [FILE.csv]

FOLDER holds the table and the histories. Prints the doubts; the csv has the indicators too.

The force column of a test is net, or it is the base moment over the length; a label says which. A
loop whose base moment stays as it is has an envelope that falls by P/L if the force is net, and
that stays level if it is not.

A rule is sure or it is a hint. Sure doubts are corrected, or the test is set aside, where scores
are given a second time; hints are for a reader. The error of a model decides nothing.

**What the force is** (sure; by series, because a laboratory treats its tests alike). Where the
axial load weighs, its moment 0.3 of that of the force or more, the medians of these tests decide:

- labelled as not net (codes 1 and 3), but the envelope falls by 0.95 P/L or more, and over the
  outer 60 % of the drift the base moment loses 0.3 or more by the label and less than 0.2 as net:
  the code is 2;
- labelled as net (2, or none), but the envelope falls by less than half of P/L, the base moment
  grows by more than 0.15 by the label, and as effective it does not fall by more than 0.1: it is 1.

Single tests that do, from a share of 0.2 on, have a hint; for those labelled as net it is enough
that the envelope falls by less than 0.9 P/L, and that the moment falls by less than 0.1 as labelled
and by less than 0.35 as effective.

**The same history twice** (sure): the database gives one history to two tests.

**Twins** (sure if there are three or more): flexural tests of a series with the same sizes, length,
bars, ties and axial load ratio, whose strength over that of their section is more than 15 % from
their median. Of two that differ nobody knows which is right: a hint.

**Strength** (hint): base moment of a flexural test below 0.75 or above 1.5 of the section's.
**Stiffness** (hint): at half the force stiffer than 1.3 times the uncracked gross cantilever, which
cannot be, or softer than a tenth. **Symmetry** (hint): one side 1.25 times the other.
"""

from __future__ import annotations

import math
import statistics
import sys
from collections.abc import Iterable
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from rbsdem import plot
from rbsdem._files import Tabular, data_frame, save_frame
from rbsdem._package import unwarned
from rbsdem._types import Array, DataFrame
from rbsdem.errors import RbsdemError
from rbsdem.measured.specimens import Specimen, Specimens, checked_specimen, draw, read_specimens
from rbsdem.measured.tests import MeasuredTest
from rbsdem.section.curvature import diagram

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


_NUMBERS = tuple(field.name for field in fields(Indicators) if field.name != "specimen")


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
    with unwarned():
        # What a drawing assumes is said where a column is made.
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
    figures = [_mean(values) for values in (shares, slopes, *growths.values())]
    figures += [_strength(specimen, test), _stiffness(specimen, test), _symmetry(test)]
    return Indicators(specimen, *figures)


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
        peak = diagram(section, specimen.axial_load, confined=False).events.peak
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


#: Share of the second-order moment from which the force tells what it is: surely, as a hint.
_WEIGHS, _HINTS = 0.3, 0.2
#: Largest difference of twins, and of what makes them twins: sizes, axial load ratio.
_TWINS, _ALIKE, _ALIKE_LOAD = 0.15, 0.02, 0.02
_SAME = ("length", "width", "depth", "corner_diameter", "intermediate_diameter")
_SAME_TIES = ("transverse_diameter", "transverse_spacing", "shear_legs")
_STRENGTH = (0.75, 1.5)
_STIFFNESS = (0.1, 1.3)
_SYMMETRY = 1.25


@dataclass(frozen=True, slots=True)
class Doubt:
    """One doubt about one test.

    Attributes
    ----------
    specimen : Specimen
        The test.
    about : str
        "force", "history", "twins", "strength", "stiffness" or "symmetry".
    sure : bool
        Whether it counts in the second score.
    why : str
        Values and limits.
    code : int or None
        The P-Delta code that mends it; None where nothing does.
    """

    specimen: Specimen
    about: str
    sure: bool
    why: str
    code: int | None = None


@dataclass(frozen=True, repr=False)
class Checked(Tabular):
    """Tests with their indicators and doubts.

    Attributes
    ----------
    indicators : tuple of Indicators
        One for each test that has a history that can be read, in their order.
    doubts : tuple of Doubt
        In the order of the tests.
    """

    indicators: tuple[Indicators, ...]
    doubts: tuple[Doubt, ...]

    def of(self, specimen: Specimen) -> tuple[Doubt, ...]:
        """Return the doubts about a test.

        Parameters
        ----------
        specimen : Specimen
            The test.
        """
        return tuple(doubt for doubt in self.doubts if doubt.specimen is specimen)

    def corrected(self) -> Specimens:
        """Return the tests with what is surely wrong mended, without those that nothing mends."""
        kept = []
        for one in self.indicators:
            sure = [doubt for doubt in self.of(one.specimen) if doubt.sure]
            if any(doubt.code is None for doubt in sure):
                continue
            codes = [doubt.code for doubt in sure]
            kept.append(replace(one.specimen, pdelta_code=codes[0]) if codes else one.specimen)
        return Specimens(kept)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each doubt, the sure ones first."""
        rows = [
            {
                "test": doubt.specimen.name,
                "about": doubt.about,
                "certainty": "sure" if doubt.sure else "hint",
                "why": doubt.why,
                "for_the_second_score": _remedy(doubt),
            }
            for doubt in sorted(self.doubts, key=lambda doubt: not doubt.sure)
        ]
        return data_frame(rows, ["test", "about", "certainty", "why", "for_the_second_score"])

    def by_test(self) -> DataFrame:
        """Return a DataFrame, a row for each test: its indicators and its doubts."""
        rows = []
        for one in self.indicators:
            s, doubts = one.specimen, self.of(one.specimen)
            rows.append(
                {
                    "name": s.name,
                    "file": s.file or "",
                    "series": s.series,
                    "pdelta_code": s.pdelta_code,
                    **{name: getattr(one, name) for name in _NUMBERS},
                    "sure": "; ".join(doubt.why for doubt in doubts if doubt.sure),
                    "hints": "; ".join(doubt.why for doubt in doubts if not doubt.sure),
                    "code_instead": next((d.code for d in doubts if d.sure and d.code), None),
                }
            )
        return data_frame(rows)


def _remedy(doubt: Doubt) -> str:
    if not doubt.sure:
        return "-"
    return "set aside" if doubt.code is None else f"code {doubt.code}"


def check(specimens: Iterable[Specimen]) -> Checked:
    """Look for tests whose labels contradict their loops; no model of a column enters.

    Parameters
    ----------
    specimens : iterable of Specimen
        The tests, as from `rbsdem.peer.read_specimens`; those without a history are left out.
        Rules by series and by twins see only these.

    Returns
    -------
    Checked
        Indicators and doubts. `Checked.corrected` returns the tests for the second score.
    """
    found = []
    for specimen in specimens:
        try:
            found.append(indicators(checked_specimen(specimen)))
        except RbsdemError:
            continue
    doubts: dict[int, list[Doubt]] = {id(one): [] for one in found}
    _force(found, doubts)
    _twins(found, doubts)
    for one in found:
        doubts[id(one)] += _alone(one)
    return Checked(tuple(found), tuple(doubt for one in found for doubt in doubts[id(one)]))


def _not_net(one: Indicators) -> bool:
    """Whether a force that is labelled as not net is net."""
    return one.slope <= -0.95 and one.growth_labelled <= -0.3 and one.growth_net >= -0.2


def _is_net(one: Indicators) -> bool:
    """Whether a force that is labelled as net is not."""
    return one.slope >= -0.5 and one.growth_labelled > 0.15 and one.growth_effective >= -0.1


def _force(found: list[Indicators], doubts: dict[int, list[Doubt]]) -> None:
    """Find series whose force is not what their label says."""
    groups: dict[tuple[str, bool], list[Indicators]] = {}
    for one in found:
        code = one.specimen.pdelta_code
        if code != 4:
            groups.setdefault((one.specimen.series, code in (1, 3)), []).append(one)
    for (_, effective), members in groups.items():
        wrong = _not_net if effective else _is_net
        perhaps = _not_net if effective else _is_net_perhaps
        telling = [one for one in members if one.second_order_share >= _WEIGHS]
        sure = bool(telling) and wrong(_middle(telling))
        for one in members:
            if sure or (one.second_order_share >= _HINTS and perhaps(_middle([one]))):
                doubts[id(one)].append(_doubt_of_force(one, effective, sure=sure))


def _middle(members: list[Indicators]) -> Indicators:
    """Return the medians of some tests; comparisons with NaN are false."""
    medians: dict[str, Any] = {}
    for name in _NUMBERS:
        known = [v for one in members if math.isfinite(v := getattr(one, name))]
        medians[name] = statistics.median(known) if known else math.nan
    return replace(members[0], **medians)


def _is_net_perhaps(one: Indicators) -> bool:
    return one.slope >= -0.9 and one.growth_labelled > -0.1 and one.growth_effective > -0.35


def _doubt_of_force(one: Indicators, effective: bool, *, sure: bool) -> Doubt:
    code = one.specimen.pdelta_code
    label = "no P-Delta code" if code is None else f"P-Delta code {code}"
    instead, growth = (2, one.growth_net) if effective else (1, one.growth_effective)
    return Doubt(
        one.specimen,
        "force",
        sure,
        f"{label}, but the envelope falls by {-one.slope:.2f} P/L and the base moment changes by "
        f"{one.growth_labelled:+.2f}; with code {instead} by {growth:+.2f}",
        instead,
    )


def _twins(found: list[Indicators], doubts: dict[int, list[Doubt]]) -> None:
    """Find tests that are stronger or weaker than others that are alike."""
    for one in found:
        if not one.strength > 0:
            continue
        others = [
            other.strength
            for other in found
            if other is not one and other.strength > 0 and _alike(one.specimen, other.specimen)
        ]
        if not others:
            continue
        # With three or more the test is one of those that say what is usual.
        usual = others if len(others) == 1 else [one.strength, *others]
        factor = one.strength / statistics.median(usual)
        if 1 / (1 + _TWINS) <= factor <= 1 + _TWINS:
            continue
        number = f"the median of {len(usual)} twins" if len(others) > 1 else "its twin"
        why = f"{factor:.2f} times as strong as {number}, relative to their sections"
        doubts[id(one)].append(Doubt(one.specimen, "twins", len(others) > 1, why))


def _alike(one: Specimen, other: Specimen) -> bool:
    """Whether two tests are twins."""
    if one.series != other.series or one.section != other.section:
        return False
    if one.failure_mode != "Flexure" or other.failure_mode != "Flexure":
        return False
    if one.longitudinal_number != other.longitudinal_number:
        return False
    if abs(one.axial_load_ratio - other.axial_load_ratio) > _ALIKE_LOAD:
        return False
    pairs = [(getattr(one, name), getattr(other, name)) for name in (*_SAME, *_SAME_TIES)]
    return all(a == b or (a and b and abs(a - b) <= _ALIKE * abs(a)) for a, b in pairs)


def _alone(one: Indicators) -> list[Doubt]:
    """Return the doubts about a test that need no other."""
    s, doubts = one.specimen, []
    if s.duplicate_of is not None:
        why = f"its history is that of test {s.duplicate_of} of the database"
        doubts.append(Doubt(s, "history", True, why))
    low, high = _STRENGTH
    if s.failure_mode == "Flexure" and (one.strength < low or one.strength > high):
        why = f"base moment {one.strength:.2f} of the section's, not {low:g} to {high:g}"
        doubts.append(Doubt(s, "strength", False, why))
    low, high = _STIFFNESS
    if one.stiffness < low or one.stiffness > high:
        why = f"{one.stiffness:.2f} times as stiff as the uncracked column, not {low:g} to {high:g}"
        doubts.append(Doubt(s, "stiffness", False, why))
    if one.symmetry > _SYMMETRY:
        why = f"one side {one.symmetry:.2f} times as strong as the other"
        doubts.append(Doubt(s, "symmetry", False, why))
    return doubts


def main() -> None:
    """Print which tests of a folder are doubtful."""
    checked = check(read_specimens(sys.argv[1]).with_history())
    print(plot.table(checked))
    print(f"{len(checked.indicators)} tests with a history, {len(checked.doubts)} doubts")
    if sys.argv[2:]:
        save_frame(checked.by_test(), sys.argv[2])


if __name__ == "__main__":
    main()
