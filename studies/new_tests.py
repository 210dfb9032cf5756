"""Shear strength by publications left out, and tests without histories: tables of docs/evidence.md.

    python studies/new_tests.py FILE FOLDER

FILE is a table of columns in SI units without histories (drawings, largest force, drift at 80 % of
it, drift of axial failure; drifts in per cent of the shear span), of which no fit has seen a
number. FOLDER holds the tests of the fit.

**Shear strength.** Largest force of tests over the smaller of shear strength and force in bending
(the model with a shear spring of twenty times the strength), joined smoothly; tests that failed in
shear, or whose force in bending is above the strength of the theory of sections, without laps. Each
publication, of both tables, is left out of the factor of a law once.

**New tests.** The column goes through two cycles at each drift of `DRIFTS`, or one way where the
test did: the protocol of the others is not known, nor whether the force is net or the moment over
the height; the net force of the model is held against it. In about a third of the tests the drift
at 80 % is the end of the test; those with a later point (25 % of the force, axial failure) have
surely lost a fifth, and stand beside all of them.
"""

from __future__ import annotations

import argparse
import csv
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import doubts
import numpy as np
from spread_quantiles import weights

from rbsdem import peer
from rbsdem.curves.envelope import strength_loss
from rbsdem.errors import AccuracyWarning
from rbsdem.run.bands import path_force
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.strength import (
    arch_factor,
    axial_failure_drift,
    axial_strut,
    column_shear_strength,
    nominal_moment,
    shear_strength_mcft,
    truss,
)

#: Drifts of the cycles, per cent.
DRIFTS = (0.1, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0)
CYCLES, POINTS = 2, 12
#: Two tests were pushed one way.
ONE_WAY = ("N-18M", "N-27M")


@dataclass(frozen=True)
class NewTest:
    """A column with what was measured: force [N], drifts as ratios, NaN where not reported."""

    specimen: peer.Specimen
    series: str
    peak: float
    drift_at_peak: float
    drift_at_loss: float
    drift_at_axial_failure: float
    lapped: bool
    one_way: bool
    surely_lost: bool


def _specimen(row: dict[str, str]) -> peer.Specimen:
    def number(name: str) -> float:
        return float(row[name] or 0.0)

    circular = row["section"] == "Circular"
    face, rows = int(number("bars_face_perpendicular_or_all")), int(number("bars_middle_parallel"))
    return peer.Specimen(
        name=f"{row['series']}, {row['specimen']}",
        author=row["series"],
        section="circular" if circular else "rectangular",
        length=number("shear_span_m"),
        width=number("width_m"),
        depth=number("depth_m"),
        concrete_strength=number("fc_Pa"),
        axial_load=number("axial_load_N"),
        longitudinal_number=face if circular else 2 * face + 2 * rows,
        # Of a spiral the cover is measured to its centre.
        cover=number("clear_cover_to_hoops_m") + (0.5 * number("tie_m") if circular else 0.0),
        cover_perpendicular=number("clear_cover_to_hoops_m"),
        corner_diameter=number("bar_1_m"),
        intermediate_diameter=number("bar_middle_m") or number("bar_1_m"),
        intermediate_perpendicular=None if circular else face - 2,
        intermediate_parallel=None if circular else rows,
        corner_yield_stress=number("bar_fy_Pa"),
        transverse_yield_stress=number("tie_fy_Pa"),
        transverse_diameter=number("tie_m"),
        transverse_spacing=number("tie_spacing_m"),
        shear_legs=number("legs_parallel") or 2.0,
        pdelta_code=2,
    )


def read(path: str | Path) -> list[NewTest]:
    """Return the tests of a table."""
    tests = []
    with Path(path).open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):

            def drift(name: str, row: dict[str, str] = row) -> float:
                return float(row[name]) / 100 if float(row[name] or 0) > 0 else math.nan

            tests.append(
                NewTest(
                    _specimen(row),
                    row["series"],
                    float(row["largest_force_N"]),
                    drift("drift_at_largest_force_pc"),
                    drift("drift_at_80_pc"),
                    drift("drift_at_axial_failure_pc"),
                    row["lapped"] == "1",
                    row["specimen"] in ONE_WAY,
                    max(float(row[f"drift_at_{name}_pc"] or 0) for name in ("25", "axial_failure"))
                    > float(row["drift_at_80_pc"]),
                )
            )
    return tests


def path(test: NewTest) -> np.ndarray:
    """Return the displacements through which a column goes [m]."""
    length = test.specimen.length
    if test.one_way:
        return np.linspace(0.0, 0.1 * length, 201)
    turns = [0.0, *(side * d for d in DRIFTS for _ in range(CYCLES) for side in (1, -1)), 0.0]
    ways = [np.linspace(a, b, POINTS + 1)[1:] for a, b in pairwise(turns)]
    return np.concatenate([[0.0], *ways]) * length / 100


# ---- shear strength ------------------------------------------------------------------------------

Law = Callable[..., float]


def _theory(section: object, length: float, load: float) -> float:
    return shear_strength_mcft(section, length, load)  # type: ignore[arg-type]


def _arch(*hinge: object) -> float:
    return shear_strength_mcft(*hinge, arch=arch_factor(*hinge))  # type: ignore[arg-type]


def _strut(*hinge: object) -> float:
    return shear_strength_mcft(
        *hinge,
        arch=arch_factor(*hinge),
        strut=axial_strut(*hinge),  # type: ignore[arg-type]
    )


def _truss(*hinge: object) -> float:
    return shear_strength_mcft(
        *hinge,
        arch=arch_factor(*hinge),
        ties=truss(hinge[0]),  # type: ignore[arg-type]
    )


#: The laws of the table.
LAWS: dict[str, Law] = {
    "theory of sections": _theory,
    "with the arch": _arch,
    "arch, ties at 45 degrees": _truss,
    "arch, strut of the axial load": _strut,
    "arch, ties at 45 degrees, strut": column_shear_strength,
}


class Strong(NamedTuple):
    """A test near its shear strength: largest force, that in bending, and by the laws [N]."""

    publication: str
    group: str
    force: float
    bending: float
    laws: list[float]


def _bending(column: LayeredColumn, d: np.ndarray) -> float:
    """Return the largest force of a column that does not fail in shear."""
    strong = column.with_parameters(shear_strength=20.0)
    return float(np.max(np.abs(path_force(strong, d))))


def strong_tests(news: list[NewTest], olds: list[peer.Specimen]) -> list[Strong]:
    """Return the tests near their shear strength."""
    found = []
    for old in (*news, *olds):
        new = isinstance(old, NewTest)
        s = old.specimen if new else old
        if (new and old.lapped) or (not new and s.failure_mode == "Flexure"):
            continue
        column = peer.column(s)
        hinge = column.drawing.section, s.length, s.axial_load
        over = nominal_moment(hinge[0], s.axial_load) / s.length / _theory(*hinge)
        if over < (1.0 if new else 0.85):
            continue
        d = path(old) if new else s.test().displacement
        force = old.peak if new else float(np.max(np.abs(s.test().force)))
        kind = "rectangular" if s.section == "rectangular" else "round"
        group = f"{kind}, new" if new else f"{kind}, {s.failure_mode}"
        name = old.series if new else s.series
        laws = [law(*hinge) for law in LAWS.values()]
        found.append(Strong(name.split()[0], group, force, _bending(column, d), laws))
    return found


def _logs(force: np.ndarray, bending: np.ndarray, law: np.ndarray) -> np.ndarray:
    return np.log(force * (law**-12.0 + bending**-12.0) ** (1 / 12))


def _factor(weight: np.ndarray, *forces: np.ndarray) -> float:
    """Return the factor of a law with which the mean logarithm is zero."""
    *others, law = forces
    factor = 1.0
    for _ in range(20):
        factor *= math.exp(np.average(_logs(*others, factor * law), weights=weight))
    return factor


def strength_table(tests: list[Strong]) -> list[str]:
    """Return test over law by groups, the factor found without the publication."""
    names = np.array([test.publication for test in tests])
    groups = np.array([test.group for test in tests])
    weight = np.array([1 / math.sqrt(np.sum(names == name)) for name in names])
    force, bending = (np.array([test[i] for test in tests]) for i in (2, 3))
    order = sorted(set(groups.tolist()))
    counts = " | ".join(f"{group} ({np.sum(groups == group)})" for group in order)
    lines = [
        f"| test over law, left out: mean, sd of ln | {counts} | all: rms of ln |",
        "| --- |" + " ---: |" * (len(order) + 1),
    ]
    for number, name in enumerate(LAWS):
        law = np.array([test.laws[number] for test in tests])
        out = np.empty(len(tests))
        for one in sorted(set(names.tolist())):
            own = names == one
            factor = _factor(weight[~own], force[~own], bending[~own], law[~own])
            out[own] = _logs(force[own], bending[own], factor * law[own])
        cells = [
            f"{math.exp(out[groups == g].mean()):.2f}, {out[groups == g].std():.3f}" for g in order
        ]
        rms = math.sqrt(np.average(out**2, weights=weight))
        lines.append(f"| {name} | {' | '.join(cells)} | {rms:.3f} |")
    return lines


# ---- new tests -----------------------------------------------------------------------------------


class Row(NamedTuple):
    """A new test beside the model."""

    test: NewTest
    over: float
    peak: float
    drift: float
    inside: tuple[bool, bool]
    #: Whether a loss at the drift of the test or later agrees with the interval.
    later: bool
    axial: float


def row(test: NewTest) -> Row:
    """Predict a new test."""
    s, d = test.specimen, path(test)
    column = peer.column(s)
    section = column.drawing.section
    band = peer.band(column, d, samples=8, rig=True)
    force = band.force
    axial = axial_failure_drift(section, s.axial_load)
    return Row(
        test,
        nominal_moment(section, s.axial_load) / s.length / _theory(section, s.length, s.axial_load),
        test.peak / float(np.max(np.abs(force))),
        test.drift_at_loss / (strength_loss(d, force) / s.length),
        (band.peak_force.holds(test.peak), band.drift_at_loss.holds(test.drift_at_loss)),
        test.drift_at_loss <= band.drift_at_loss.upper,
        test.drift_at_axial_failure / axial,
    )


def _cell(values: list[float]) -> str:
    known = np.log([value for value in values if np.isfinite(value)])
    return f"{math.exp(known.mean()):.2f}, {known.std():.2f}" if known.size else ""


def new_table(rows: list[Row]) -> list[str]:
    """Return the tables of peaks, drifts and axial failures."""
    groups: dict[str, Callable[[Row], bool]] = {
        "rectangular, bending over shear above 1": lambda r: (
            r.test.specimen.section == "rectangular" and r.over > 1
        ),
        "- of these without lap": lambda r: (
            r.test.specimen.section == "rectangular" and r.over > 1 and not r.test.lapped
        ),
        "- and n from 0.2": lambda r: (
            r.test.specimen.section == "rectangular"
            and r.over > 1
            and not r.test.lapped
            and r.test.specimen.axial_load_ratio >= 0.199
        ),
        "rectangular, below 1": lambda r: r.test.specimen.section == "rectangular" and r.over <= 1,
        "all": lambda r: True,
    }
    lines = [
        "| new tests, over the model: mean, sd of ln | tests | peak | in its interval "
        "| drift at 80 % | in its interval | surely lost, tests | axial failure, tests |",
        "| --- |" + " ---: |" * 7,
    ]
    for name, belongs in groups.items():
        own = [r for r in rows if belongs(r)]
        axial = [r.axial for r in own if np.isfinite(r.axial)]
        held = [sum(r.inside[i] for r in own) / len(own) for i in (0, 1)]
        lost = [r.inside[1] for r in own if r.test.surely_lost]
        lines.append(
            f"| {name} | {len(own)} | {_cell([r.peak for r in own])} | {held[0]:.2f} "
            f"| {_cell([r.drift for r in own])} | {held[1]:.2f} | {np.mean(lost):.2f}, {len(lost)} "
            f"| {_cell(axial)}, {len(axial)} |"
        )
    held = np.array([r.inside[1] for r in rows])
    bound = np.array([r.inside[1] if r.test.surely_lost else r.later for r in rows])
    weight = weights(np.array([r.test.series for r in rows]))
    shares = [f"{np.mean(v):.2f}, {np.average(v, weights=weight):.2f}" for v in (held, bound)]
    return [
        *lines,
        "",
        "interval of the drift, every test alike, and weighted as where intervals are set: "
        f"{shares[0]}; where not surely lost, a lower bound: {shares[1]}",
    ]


def one_push(rows: list[Row]) -> list[str]:
    """Return drifts at a loss of 20 % in one push and in cycles, of columns that fail in shear."""
    ways: list[tuple[float, float]] = []
    for r in rows:
        s = r.test.specimen
        if s.section != "rectangular" or r.over <= 1 or r.test.lapped:
            continue
        column = peer.column(s)
        found = []
        for d in (np.linspace(0.0, 0.1 * s.length, 201), path(r.test)):
            found.append(strength_loss(d, path_force(column, d)) / s.length)
        ways.append((found[0], found[1]))
        if r.test.one_way:
            ways[-1] = (found[0], math.nan)
            print(f"{s.name}, pushed one way: {r.test.drift_at_loss:.4f}, model {found[0]:.4f}")
    push, cycles = np.array(ways).T
    ratio = np.nanmedian(push / cycles)
    return [
        f"one push, {len(ways)} columns: loss of 20 % at {np.nanmedian(push):.4f} (median), "
        f"{ratio:.2f} times that of cycles"
    ]


def main() -> None:
    """Predict, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("file")
    parser.add_argument("folder")
    given = parser.parse_args()
    warnings.simplefilter("ignore", AccuracyWarning)
    news = read(given.file)
    tests = peer.read_specimens(given.folder).with_history()
    olds = list(doubts.check(tests).corrected())
    print("\n".join(strength_table(strong_tests(news, olds))), "\n")
    rows = [row(test) for test in news]
    print("\n".join(new_table(rows)), "\n")
    print("\n".join(one_push(rows)))


if __name__ == "__main__":
    main()
