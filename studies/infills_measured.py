"""Infilled frames from their drawings against tested frames: tables of docs/existing.md.

    python studies/infills_measured.py [FOLDER] [--entries]

FOLDER, by default that of the environment variable RBSDEM_INFILLS_DIR, holds `fresco_infilled.csv`:
infilled frames of the FRESCO database. Frames are drawn as in `frames_measured.py`, their panels as
`rbsdem.frames.Infill` of one thickness, all wythes together. Left out are frames of several storeys
or bays, those without a strength of the masonry, and those that were stopped as they cracked. A
publication is never in the fit of the constant, nor in the choice of the law, that it is scored by.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import re
import sys
import warnings
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

import rbsdem
from rbsdem.frames import Frame, FrameMember, Infill, Member
from rbsdem.motions import synthetic
from rbsdem.section.infill import STRESS, InfilledBay
from rbsdem.springs import Elastic

sys.path.insert(0, str(Path(__file__).parent))
import frames_measured

#: Frames with more storeys or bays than one; those that were stopped as they cracked (Angel).
SEVERAL, STOPPED = {8, 9, 49, 51, *range(75, 82)}, set(range(10, 17))
#: Strengths of masonry that are printed wrong: that of the same masonry in other tests [MPa].
CORRECTED = {91: 5.2, 92: 4.6, 93: 5.2, 94: 4.6, 95: 5.2}
#: Two wythes, whose thickness in the table is that of one.
ONE_OF_TWO = {1}
#: Openings that the table leaves to be read from a drawing.
UNREAD = {86, 93}
#: Least initial stiffness that is that of an infilled frame [N/m]; some are in other units.
STIFF = 5e6
#: Factors by which a constant is tried.
LADDER = np.array([0.4, 0.6, 0.8, 1.0, 1.25, 1.6, 2.0])
POINTS = 300


@dataclass(frozen=True)
class Test:
    """A tested frame with its infill; stresses in MPa."""

    row: dict[str, str]
    number: int
    thickness: float
    fm: float
    opening: tuple[float, float] | None

    def value(self, name: str) -> float:
        """Return a number of the table, 0 without one."""
        try:
            return float(self.row[name] or 0)
        except ValueError:
            return 0.0

    @property
    def publication(self) -> str:
        """Its title."""
        return self.row["title"]

    @property
    def peak(self) -> float:
        """Largest force [N]."""
        return 1e3 * self.value("glb_peak_lateral_load")

    @property
    def diagonal(self) -> float:
        """Measured strength of the masonry in diagonal compression, 0 without one [MPa]."""
        return self.value("inf_assembly_compressive_strength_diagonal")

    @cached_property
    def bare(self) -> Frame:
        """The frame without its infill."""
        return frames_measured.model(frames_measured.portal(self.row, "asce", tied=False))

    @cached_property
    def sizes(self) -> tuple[float, float, float, float]:
        """Length and height of the panel, and those between the axes [m]."""
        width, depth = 1e-3 * self.value("col_h"), 1e-3 * self.value("bm_h")
        run, rise = 1e-3 * self.value("frm_l") - width, 1e-3 * self.value("frm_h") - 0.5 * depth
        return run - width, rise - 0.5 * depth, run, rise

    def infilled(self, infill: Infill) -> Frame:
        """Return the frame with an infill."""
        bay = InfilledBay(infill, 1, 1, *self.sizes)
        return replace(self.bare, members=(*self.bare.members, *bay.members()))

    @property
    def infill(self) -> Infill:
        """The infill of the program."""
        return Infill(self.thickness, 1e6 * self.fm, self.opening)

    @property
    def drift(self) -> float:
        """How far it is pushed: as the test, and no less than 2 %."""
        names = ("glb_peak_lateral_drift", "glb_drift_at_peak_lateral_load")
        return max(0.02, *(self.value(name) for name in names))

    @cached_property
    def diagonals(self) -> tuple[float, float, float]:
        """Angle and length of the panel's diagonal, and Bertoldi's lambda H."""
        length, height, _, rise = self.sizes
        theta, across = math.atan(height / length), math.hypot(length, height)
        column = 1e-3 * self.value("col_h")
        inertia = 1e-3 * self.value("col_d") * column**3 / 12
        beside = 4 * 4700e6 * math.sqrt(self.value("fc")) * inertia * height
        pressed = 550e6 * self.fm * self.thickness * math.sin(2 * theta)
        return theta, across, rise * (pressed / beside) ** 0.25

    def bertoldi(self) -> tuple[list[float], float]:
        """Return four strengths [N] and the stiffness [N/m] of Bertoldi, Decanini, Gavarini 1993.

        With E_m = 550 f_m; the diagonal strength is 0.285 sqrt f_m where it was not measured, and
        that of the bed joints 0.6 of it.
        """
        theta, across, far = self.diagonals
        k1, k2 = next(
            pair for most, *pair in
            ((3.14, 1.3, -0.178), (7.85, 0.707, 0.010), (math.inf, 0.470, 0.040)) if far <= most
        )  # fmt: skip
        wide, sin, cos = k1 / far + k2, math.sin(theta), math.cos(theta)
        along = self.diagonal or 0.285 * math.sqrt(self.fm)
        stresses = (
            1.16 * self.fm * math.tan(theta) / (k1 + k2 * far),
            1.12 * self.fm * sin * cos / (k1 * far**-0.12 + k2 * far**0.88),
            0.6 * along * (1.2 * sin + 0.45 * cos) / wide,
            0.6 * along / wide,
        )
        area = 1e6 * self.thickness * wide * across * cos
        return [s * area for s in stresses], 550 * self.fm * area * cos / across


#: Forces of laws without their constants [N]; f_ws is measured, or 0.285 sqrt f_m.
LAWS = {
    "Bertoldi": lambda t: min(t.bertoldi()[0]),
    "f_ws t l": lambda t: _area(t) * (t.diagonal or 0.285 * math.sqrt(t.fm)),
    "sqrt f_ws t l": lambda t: _area(t) * math.sqrt(t.diagonal or 0.285 * math.sqrt(t.fm)),
    "t l": lambda t: _area(t) * 1.0,
    "f_m^0.25 t l": lambda t: _area(t) * t.fm**0.25,
    "sqrt f_m t l": lambda t: _area(t) * math.sqrt(t.fm),
}
#: Where the constant of a law is searched.
ABOUT = {"Bertoldi": 1.6, "f_ws t l": 1.0, "sqrt f_ws t l": 0.8, "t l": 0.6,
         "f_m^0.25 t l": 0.42, "sqrt f_m t l": 0.3}  # fmt: skip


def _area(test: Test) -> float:
    return 1e6 * test.thickness * test.sizes[0]


def tests_of(folder: Path) -> list[Test]:
    """Return the frames of one storey and one bay whose masonry has a strength."""
    with (folder / "fresco_infilled.csv").open(encoding="utf-8", newline="") as lines:
        rows = list(csv.DictReader(lines))
    found = []
    for row in rows:
        number = int(row["entry_id"])
        plain = Test(row, number, 0.0, 0.0, None)
        fm = CORRECTED.get(number, plain.value("inf_assembly_compressive_strength_height"))
        if number in SEVERAL | UNREAD or not fm:
            continue
        names = ("inf_win_h", "inf_door_h"), ("inf_win_v", "inf_door_v")
        length, height = (1e-3 * max(map(plain.value, pair)) for pair in names)
        thickness = 1e-3 * plain.value("inf_ut") * (2 if number in ONE_OF_TWO else 1)
        opening = (length, height) if length else None
        found.append(Test(row, number, thickness, fm, opening))
    return found


def pushed(frame: Frame, drift: float) -> rbsdem.frames.FrameResult:
    """Return the push to a drift, as far as it goes."""
    try:
        return rbsdem.cyclic(frame, displacement=np.linspace(0, drift * frame.height, POINTS)[1:])
    except rbsdem.SolveError as error:
        return error.result


def largest(test: Test, force: float) -> float:
    """Return the peak of a frame whose panel has a strength [N]."""
    push = pushed(test.infilled(Infill(test.thickness, strength=force)), test.drift)
    return float(push.force.max())


class Fit:
    """Peaks of the model for a law, as its constant goes."""

    def __init__(self, tests: list[Test], law: str) -> None:
        self.tests, self.law = tests, law
        self.peak = np.array([one.peak for one in tests])
        self.logs = np.log([
            [largest(one, LAWS[law](one) * ABOUT[law] * factor) for factor in LADDER]
            for one in tests
        ])  # fmt: skip

    def errors(self, factor: float) -> np.ndarray:
        """Return ln of test over model."""
        model = [np.interp(math.log(factor), np.log(LADDER), line) for line in self.logs]
        return np.asarray(np.log(self.peak) - model)

    def factor(self, of: np.ndarray) -> float:
        """Return the factor with which some tests have a median of 1."""
        return float(brentq(lambda x: np.median(self.errors(x)[of]), LADDER[0], LADDER[-1]))


def left_out(fit: Fit, groups: np.ndarray, among: np.ndarray) -> tuple[np.ndarray, list[float]]:
    """Return the errors of tests whose publication is not in the fit, and the constants."""
    found, constants = np.full(groups.size, np.nan), []
    for group in sorted(set(groups[among])):
        own = groups == group
        factor = fit.factor(among & ~own)
        constants.append(factor * ABOUT[fit.law])
        found[own] = fit.errors(factor)[own]
    return found, constants


def scores(errors: np.ndarray) -> str:
    """Return median of test over model and sd of ln."""
    kept = errors[np.isfinite(errors)]
    return f"{np.exp(np.median(kept)):.2f}, {np.std(kept, ddof=1):.2f} ({kept.size})"


def table(head: str, rows: list[list[str]]) -> None:
    """Print a table."""
    print("\n| " + " | ".join(head.split("; ")) + " |\n|" + " --- |" * len(rows[0]))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def laws(tests: list[Test]) -> None:
    """Print the laws, each scored with its constant from the other publications."""
    groups = np.array([one.publication for one in tests])
    measured = np.array([one.diagonal > 0 for one in tests])
    everyone = np.ones(groups.size, bool)
    fits = {law: Fit(tests, law) for law in LAWS}
    rows = []
    for law, fit in fits.items():
        errors, constants = left_out(fit, groups, everyone)
        rows.append([
            law, f"{min(constants):.2f} to {max(constants):.2f}", scores(errors),
            scores(errors[measured]),
        ])  # fmt: skip
    chosen, errors = [], np.empty(groups.size)
    for group in sorted(set(groups)):
        own = groups == group
        spread = {law: np.nanstd(left_out(fit, groups, ~own)[0][~own]) for law, fit in fits.items()}
        best = min(spread, key=spread.__getitem__)
        chosen.append(best)
        errors[own] = fits[best].errors(fits[best].factor(~own))[own]
    names = "; ".join(f"{chosen.count(law)} x {law}" for law in dict.fromkeys(chosen))
    rows.append(["the best of the others' publications", names, scores(errors),
                 scores(errors[measured])])  # fmt: skip
    table("law; constant; peak, publication left out; of these with measured diagonal strength",
          rows)  # fmt: skip
    print(f"program: {1e-6 * STRESS:.2f} f_m^0.25 t l; {len(set(groups))} publications")


def backbones(tests: list[Test]) -> None:
    """Print drift at the peak, first stiffness and last point, by the drift of the panel's peak."""
    rows = []
    reached = np.array([one.value("glb_peak_lateral_drift") for one in tests])
    at_peak = np.array([one.value("glb_drift_at_peak_lateral_load") for one in tests])
    stiff = 1e3 * np.array([one.value("glb_initial_stiffness") for one in tests])
    last = 1e3 * np.array([one.value("glb_load_at_peak_lateral_drift") for one in tests])
    peak = np.array([one.peak for one in tests])
    for name in ("0.3 %", "0.5 %", "0.7 %", "1 %", "V/K of Bertoldi"):
        found = []
        for one in tests:
            drift = 0.01 * float(name[:-1]) if name.endswith("%") else 0.0
            if not drift:
                force = one.infill.force(*one.sizes[:2])
                drift = min(force / one.bertoldi()[1] / one.sizes[1], 0.025)
            push = pushed(one.infilled(replace(one.infill, peak_drift=drift)), one.drift)
            force, moved = push.force, push.displacement - push.displacement[0]
            top = int(force.argmax())
            done = push.displacement[-1] > 0.97 * one.drift * push.frame.height
            found.append((
                force[top], moved[top] / push.frame.height, (force[1] - force[0]) / moved[1],
                force[-1] if done else np.nan,
            ))  # fmt: skip
        model = np.array(found)
        with np.errstate(divide="ignore"):
            cells = [
                np.log(peak / model[:, 0]),
                np.where(reached > 1.05 * at_peak, np.log(at_peak / model[:, 1]), np.nan),
                np.where(stiff > STIFF, np.log(stiff / model[:, 2]), np.nan),
                np.where(reached > 1.3 * at_peak, np.log(last / peak * model[:, 0] / model[:, 3]),
                         np.nan),
            ]  # fmt: skip
        rows.append([name, *map(scores, cells)])
    table("drift of the panel at its peak; peak; drift at the peak; initial stiffness; what is "
          "left of the peak at the end of the test", rows)  # fmt: skip


def others(tests: list[Test], apart: list[Test], entries: bool) -> None:
    """Print the peaks of the program, of the bare frames, and of tests that were left out."""

    def error(one: Test, infill: Infill | None) -> float:
        frame = one.bare if infill is None else one.infilled(infill)
        return math.log(one.peak / pushed(frame, one.drift).force.max())

    own = {one.number: error(one, one.infill) for one in tests + apart}
    if entries:
        for one in tests + apart:
            print(f"{one.number:4d} {math.exp(own[one.number]):5.2f} {one.publication[:60]}")
    rows = [
        ["bare frames", scores(np.array([error(one, None) for one in tests]))],
        ["with infills", scores(np.array([own[one.number] for one in tests]))],
    ]
    for one in apart:
        if one.opening is not None:
            solid = [t for t in tests + apart if t.publication == one.publication
                     and t.opening is None]  # fmt: skip
            whole = np.exp(np.median([own[t.number] for t in solid]))
            without = math.exp(error(one, replace(one.infill, opening=None)))
            name = f"{one.number}, opening: over its solid ones with the factor, without it"
            rows.append([name, f"{math.exp(own[one.number]) / whole:.2f}, {without / whole:.2f}"])
        else:
            rows.append([f"{one.number}, {one.row['inf_type']}, {one.publication[:30]}",
                         f"{math.exp(own[one.number]):.2f}"])  # fmt: skip
    table("frames; test over model: median, sd of ln (tests)", rows)


def columns_beside(tests: list[Test]) -> None:
    """Print the check of the columns, of tests that name a shear failure of columns and others."""
    named: dict[bool, list[float]] = {True: [], False: []}
    for one in tests:
        text = f"{one.row['glb_failure_mode']}. {one.row['lcl_failure_mechanism']}".lower()
        says = re.search(r"shear[^.;]{0,40}column|column[^.;]{0,40}shear", text)
        springs = [s for member in one.bare.members[:2] for _, s in member.kind.shear or ()]
        weakest = min(getattr(spring, "f_cap", math.inf) for spring in springs)
        named[bool(says)].append(one.infill.force(*one.sizes[:2]) / weakest)
    above = np.mean([a > b for a in named[True] for b in named[False]])
    rows = [
        [f"{len(values)} that {'name it' if says else 'do not'}",
         f"{np.median(values):.2f}", f"{np.mean(np.array(values) > 1):.0%}"]
        for says, values in named.items()
    ]  # fmt: skip
    table("shear failure of columns in the text of the test; force of the strut over the shear "
          "strength of a column: median; above 1", rows)  # fmt: skip
    print(f"one that names it is above one that does not in {above:.0%} of the pairs")


def finished(tests: list[Test]) -> None:
    """Print how many frames finish pushes, cycles and records, and why others do not."""
    ends: dict[str, list[str]] = {}
    for one in tests:
        frame = one.infilled(one.infill)
        push = pushed(frame, 0.03)
        turns = np.repeat([0.0025, 0.005, 0.01, 0.02, 0.03], 2) * frame.height
        path = np.concatenate([np.linspace(-a, a, 40) for a in turns])
        runs = {"push to 3 %": push}
        try:
            runs["cycles to 3 %"] = rbsdem.cyclic(frame, displacement=path)
        except rbsdem.SolveError as error:
            runs["cycles to 3 %"] = error.result
        mass = one.peak / (0.4 * 9.81)
        nodes = [replace(n, mass=mass / 2) if n.push_x else n for n in frame.nodes]
        heavy = replace(frame, nodes=nodes, damping=0.03)
        for motion in synthetic(3, seed=1):
            try:
                run = rbsdem.time_history(
                    heavy, ground_acceleration=motion, method="newmark", dt=0.005,
                    collapse_drift=0.1,
                )  # fmt: skip
            except rbsdem.SolveError as error:
                run = error.result
            runs[f"record {motion.name}"] = run
        for name, run in runs.items():
            kind = "records" if name.startswith("record") else name
            status = run.summary["status"] if run is not None else "failed"
            told = ends.setdefault(kind, [])
            why = run.summary.get("reason", "") if run is not None else ""
            told.append("" if status in ("completed", "collapsed") else f"{one.number}: {why}")
    rows = [[kind, f"{told.count('')} of {len(told)}", "; ".join(filter(None, told))[:400]]
            for kind, told in ends.items()]  # fmt: skip
    table("run; finished; the others", rows)


def lines(tests: list[Test]) -> None:
    """Print the statements that an infill adds to a case, and its struts under dead load."""
    one = next(test for test in tests if test.number == 32)
    column = one.bare.members[0].kind.sections[0]
    beam = one.bare.members[-1].kind.sections[0]
    given = {"columns": column, "beams": beam, "node_load": 159e3}
    _, _, run, rise = one.sizes
    bare = Frame.grid([rise], [run], **given)
    frame = Frame.grid([rise], [run], infills=one.infill, **given)
    more = [
        len(re.findall(r"^&", text, re.MULTILINE))
        for text in (frame.to_namelist(), bare.to_namelist(), frame.to_namelist(springs=True))
    ]
    before = one.infilled(one.infill)
    strut = FrameMember.strut(Elastic(before.parts.springs[-1].stiffness))
    early = replace(before, members=tuple(
        Member(m.name, m.start, m.end, strut) if m.name.startswith("I-") else m
        for m in before.members
    ))  # fmt: skip
    rows = [
        ["groups of a case more than the bare frame's", f"{more[0] - more[1]}"],
        ["groups with all springs", f"{more[2]}"],
        ["axial force of a strut under dead load, kN", f"{before.parts.compression[-1] / 1e3:.1f}"],
        ["the same of a strut that is built before, kN",
         f"{early.parts.compression[-1] / 1e3:.1f}"],
    ]  # fmt: skip
    table("frame 32; value", rows)


def main() -> None:
    """Print all tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    default = os.environ.get("RBSDEM_INFILLS_DIR", ".")
    parser.add_argument("folder", nargs="?", default=default, type=Path)
    parser.add_argument("--entries", action="store_true", help="a line for each frame")
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    if not (asked.folder / "fresco_infilled.csv").exists():
        raise SystemExit(f"{asked.folder}: no fresco_infilled.csv; name its folder")
    every = tests_of(asked.folder)
    plain = [t for t in every if t.opening is None and t.row["inf_type"] == "one_wythe"
             and t.number not in STOPPED]  # fmt: skip
    apart = [t for t in every if t not in plain and t.number not in STOPPED]
    laws(plain)
    backbones(plain)
    others(plain, apart, asked.entries)
    columns_beside(plain)
    finished(plain)
    lines(plain)


if __name__ == "__main__":
    main()
