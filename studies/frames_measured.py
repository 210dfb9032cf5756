"""Frames from their drawings against tested frames: tables and figures of docs/evidence.md.

    python studies/frames_measured.py [FOLDER] [--ends 0|1|asce] [--entries] [--figures FOLDER]

FOLDER, by default that of the environment variable RBSDEM_FRAMES_DIR, holds `portals.csv` (the 23
bare portals of the FRESCO database), `vecchio_emara.csv`, `park_ruitong_peaks.csv` and
`park_ruitong_unloading.csv`; the drawings of Vecchio and Emara 1992 and of Park and Dai Ruitong
1988 stand here, and without a folder the first of them is pushed alone. A `Drawing` is stated once,
and a program is a function that follows a path on it: that of rbsdem stands here, that of OpenSees
in `frames_measured_opensees.py`.

Members are those of `rbsdem.section.member`. Nothing is fitted. Taken where the database is silent:
the load on each column, two legs of ties, no panels. Its heights go from the base to the top of the
beam and its lengths from outside to outside of the columns; of the bars between the corners of a
column "top" and "bot" stand on the sides along the frame and "mid" on the sides across it, as its
own model of a frame places them. The model is pushed as far as the test. `--ends` is the rigid
share of the nodes, by default by the rule of ASCE 41-17.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import re
import time
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogLocator, NullFormatter

import rbsdem
from rbsdem.frames import Frame, FrameMember, FrameNode, JointPanel, Member
from rbsdem.output import style
from rbsdem.springs import Elastic

#: Beam bars differ at the ends or cannot be read: see the comments of the database.
DOUBTFUL = {82, 84, 104, 160, 180, 186}
#: Tests that stop at 1 % drift, before their peak.
STOPPED = {96, 97, 98, 99}
#: Stiffnesses that are those of no concrete frame of this size, by factors of 30 and more.
OTHER_UNITS = {31, 154}
#: Points of a push, and of each way between two reversals.
PUSH, WAY = 800, 40
#: Drifts at which secants stand.
DRIFTS = (0.001, 0.002, 0.005)


@dataclass(frozen=True)
class Part:
    """A member of a drawing, from axis to axis.

    Attributes
    ----------
    name, start, end : str
        Its name and those of its nodes.
    section : RectangularSection
        y > 0 is up in a beam that goes to the right.
    load : float
        Compression under the dead load [N].
    rigid : tuple of float
        Rigid lengths at its start and its end [m].
    bends : tuple of bool
        Whether its start and its end bend; one that ends in a pin has its hinge at the other end.
    """

    name: str
    start: str
    end: str
    section: rbsdem.RectangularSection
    load: float = 0.0
    rigid: tuple[float, float] = (0.0, 0.0)
    bends: tuple[bool, bool] = (True, True)


@dataclass(frozen=True)
class Drawing:
    """A tested frame.

    Attributes
    ----------
    nodes : tuple of FrameNode
        Places, supports, dead loads, shares of the push, springs of panels.
    parts : tuple of Part
        Columns and beams.
    control : str
        The node whose displacement is prescribed.
    tied : bool
        Whether the dead loads are those of tie rods, which do no second-order work.
    watched : str
        The member whose first yield is asked for.
    """

    nodes: tuple[FrameNode, ...]
    parts: tuple[Part, ...]
    control: str
    tied: bool = False
    watched: str = ""


@dataclass(frozen=True)
class Curve:
    """What a program says of a drawing: rows as far as it followed the path.

    Attributes
    ----------
    displacement, force : ndarray, shape (rows,)
        Of the control node [m], and lateral force [N].
    panel : ndarray, shape (rows,)
        Rotation of the panel [rad], 0 without one.
    yielded : tuple of float
        Displacement and force where the first bar of the watched member yields; NaN if none does.
    seconds : float
        Processor time of the run.
    """

    displacement: np.ndarray
    force: np.ndarray
    panel: np.ndarray
    yielded: tuple[float, float]
    seconds: float


#: Follows the displacements [m], and unloads from there if asked for.
Program = Callable[[Drawing, np.ndarray, bool], Curve]


def inner(
    ends: str, column: rbsdem.RectangularSection, columns: int, beam: rbsdem.RectangularSection,
    load: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the rigid lengths of columns and beams in a node [m]."""
    share = "asce" if ends == "asce" else float(ends)
    return rbsdem.section.rigid_ends([column] * columns, [beam], axial_load=load, share=share)


# ---- drawings ----------------------------------------------------------------------------------


def bars_of(text: str) -> tuple[int, float]:
    """Return number and diameter [m] of '4#12'."""
    number, diameter = text.split("#")
    return int(number or 2), 1e-3 * float(diameter)


def number_of(text: str) -> float | None:
    """Return the first number of a text, None without one above zero."""
    found = re.search(r"[\d.]+", text)
    return float(found[0]) or None if found else None


def section_of(
    row: dict[str, str], which: str, width: float, depth: float
) -> rbsdem.RectangularSection:
    """Return the section of the columns or the beams of a portal, at their ends."""
    fy, fu = 1e6 * float(row["fy"]), number_of(row["fu"])
    steel = rbsdem.Steel(fy, 1e6 * fu if fu else None, es=1e9 * (number_of(row["Ey"]) or 200.0))
    cover = 1e-3 * float(row[f"{which}_cover"])
    hinge = "crit_bot" if which == "col" else "crit_left"
    hoops = (row[f"{which}_trans_{place}_reinf"] for place in (hinge, "mid"))
    tie, spacing = next(
        (1e-3 * float(diameter), 1e-3 * float(gap))
        for diameter, gap in (hoop.partition("#")[2].split("@") for hoop in hoops)
        if float(gap)
    )
    edge = 0.5 * depth - cover - tie
    bars, areas = [], []
    for place in ("corner", "top", "mid", "bot"):
        number, diameter = bars_of(row[f"{which}_long_reinf_{place}"])
        if not number:
            continue
        y = edge - 0.5 * diameter
        # The sides across the bending have rows at one depth, those along it bars between them.
        if place == "corner" or (which, place) == ("col", "mid"):
            where = [y, -y]
        elif which == "bm" and place != "mid":
            where = [-y if place == "top" else y]
        else:
            each = number // 2 if place == "mid" else number
            where = [y - 2.0 * y * (i + 1) / (each + 1) for i in range(each)]
        area = number * math.pi * diameter**2 / 4
        bars += [(at, area / len(where), steel) for at in where]
        areas.append((number, diameter))
    mean = sum(n * d for n, d in areas) / sum(n for n, _ in areas)
    return rbsdem.RectangularSection(
        width, depth, rbsdem.Concrete(1e6 * float(row["fc"])), bars=bars, bar_diameter=mean,
        ties=rbsdem.Ties(tie, spacing, steel), cover=cover,
    )  # fmt: skip


def portal(row: dict[str, str], ends: str, tied: bool) -> Drawing:
    """Return a portal of the database."""
    sizes = {name: 1e-3 * float(row[name]) for name in (
        "frm_h", "frm_l", "col_h", "col_d", "bm_h", "bm_t")}  # fmt: skip
    column = section_of(row, "col", sizes["col_d"], sizes["col_h"])
    beam = section_of(row, "bm", sizes["bm_t"], sizes["bm_h"])
    load = 1e3 * float(row["inp_column_vertical_load"] or 0)
    height, span = sizes["frm_h"] - 0.5 * sizes["bm_h"], sizes["frm_l"] - sizes["col_h"]
    up, side = inner(ends, column, 1, beam, load)
    nodes, parts = [], []
    for line, x in ((1, 0.0), (2, span)):
        foot, head = f"N-{line}-0", f"N-{line}-1"
        nodes.append(FrameNode(foot, x, 0.0, "fixed"))
        nodes.append(FrameNode(head, x, height, load_y=-load, push_x=0.5))
        parts.append(Part(f"C-{line}-1", foot, head, column, load, (0.0, up)))
    parts.append(Part("B-1-1", "N-1-1", "N-2-1", beam, 0.0, (side, side)))
    return Drawing(tuple(nodes), tuple(parts), "N-1-1", tied)


def two_storeys(ends: str) -> Drawing:
    """Return the two storeys of Vecchio and Emara 1992."""
    steel = rbsdem.Steel(418e6, 596e6, es=192.5e9, eps_sh=9.5e-3, eps_u=9.5e-3 + 178 / 3100)
    ties = rbsdem.Ties(0.0113, 0.125, rbsdem.Steel(454e6))
    bar = 4 * 300e-6

    def section(cover: float) -> rbsdem.RectangularSection:
        y = 0.2 - cover
        return rbsdem.RectangularSection(
            0.3, 0.4, rbsdem.Concrete(30e6),
            bars=[(y, bar, steel), (-y, bar, steel)],
            bar_diameter=0.0195, ties=ties, cover=cover - 0.0098 - 0.0113,
        )  # fmt: skip

    column, beam, load = section(0.051), section(0.041), 700e3
    # Two columns meet below the roof.
    up, side = inner(ends, column, 2, beam, load)
    nodes, parts = [], []
    for line, x in ((1, 0.0), (2, 3.5)):
        names = [f"N-{line}-{floor}" for floor in range(3)]
        nodes.append(FrameNode(names[0], x, 0.0, "fixed"))
        nodes.append(FrameNode(names[1], x, 2.0))
        nodes.append(FrameNode(names[2], x, 4.0, load_y=-load, push_x=0.5))
        for storey in (1, 2):
            rigid = (up if storey == 2 else 0.0, up)
            parts.append(
                Part(f"C-{line}-{storey}", *names[storey - 1 : storey + 1], column, load, rigid)
            )
    for floor in (1, 2):
        parts.append(Part(f"B-1-{floor}", f"N-1-{floor}", f"N-2-{floor}", beam, 0.0, (side, side)))
    return Drawing(tuple(nodes), tuple(parts), "N-1-2", watched="B-1-1")


def cruciform(ends: str) -> Drawing:
    """Return the cruciform of Park and Dai Ruitong 1988, Unit 1.

    Without the 55 kN at 848 mm of each beam, whose moments in the node are in balance.
    """
    concrete = rbsdem.Concrete(45.9e6)
    tie, hd = rbsdem.Steel(282e6, 366e6), rbsdem.Steel(498e6)
    deformed = rbsdem.Steel(
        294e6, 434e6, es=210.4e9, eps_sh=0.0255, eps_u=0.0255 + 140 / 3580
    )  # fmt: skip
    bar = math.pi * 0.016**2 / 4
    column = rbsdem.RectangularSection(
        0.305, 0.406, concrete, bar_diameter=0.016, ties=rbsdem.Ties(0.006, 0.06, tie, legs=3),
        bars=[(0.16, 3 * bar, hd), (0.0, 2 * bar, hd), (-0.16, 3 * bar, hd)], cover=0.029,
    )  # fmt: skip
    beam = rbsdem.RectangularSection(
        0.229, 0.457, concrete, bar_diameter=0.016, ties=rbsdem.Ties(0.006, 0.08, tie),
        bars=[
            (0.1865, 3 * bar, deformed), (0.1535, 2 * bar, deformed), (-0.1865, 2 * bar, deformed)
        ],
        cover=0.028,
    )  # fmt: skip
    # R12 and R8, five sets at 75 mm: two legs of each as three of 12 mm, nearly.
    hoops = rbsdem.Ties(0.012, 0.075, rbsdem.Steel(283e6), legs=2 + 2 * (8 / 12) ** 2)
    panel = JointPanel(column, beam, hoops=hoops, beam_length=2.119, column_height=2.473)
    up, side = inner(ends, column, 1, beam, 0.0)
    nodes = (
        FrameNode("foot", 0.0, -1.2365, "pinned"),
        FrameNode("head", 0.0, 1.2365, "free", push_x=1.0),
        FrameNode("left", -2.119, 0.0, "roller"),
        FrameNode("right", 2.119, 0.0, "roller"),
        FrameNode("node", 0.0, 0.0, panel=panel.spring()),
    )
    to, off = (False, True), (True, False)
    parts = (
        Part("lower", "foot", "node", column, 0.0, (0.0, up), to),
        Part("upper", "node", "head", column, 0.0, (up, 0.0), off),
        Part("west", "left", "node", beam, 0.0, (0.0, side), to),
        Part("east", "node", "right", beam, 0.0, (side, 0.0), off),
    )
    return Drawing(nodes, parts, "head", tied=True)


# ---- the program -------------------------------------------------------------------------------


def kind(part: Part, length: float, **values: float) -> FrameMember:
    """Return the kind of a member with a clear length, with other values of model parameters."""
    usual = {} if part.load else {"isotropic_hardening": 0.0, "fatigue": 0.0}
    changed = rbsdem.section.parameters().with_values(**usual | values) if values else None

    def member(clear: float) -> FrameMember:
        return rbsdem.section.member(
            part.section, clear, axial_load=part.load, model_parameters=changed
        )

    if all(part.bends):
        return member(length)
    whole, end = member(2.0 * length), float(part.bends[1])

    def half(springs: tuple[tuple[float, rbsdem.springs.Spring], ...]) -> dict:
        return {abs(end - 2 * at): spring for at, spring in springs if at < 0.5}

    return replace(whole, flexure=half(whole.flexure), shear=half(whole.shear), length=length)


def model(drawing: Drawing, make: Callable[[Part, float], FrameMember] = kind) -> Frame:
    """Return the frame of a drawing."""
    place = {node.name: np.array((node.x, node.y)) for node in drawing.nodes}
    members = []
    for part in drawing.parts:
        whole = float(np.linalg.norm(place[part.end] - place[part.start]))
        of_part = make(part, whole - sum(part.rigid))
        members.append(Member(part.name, part.start, part.end, of_part, part.rigid))
    return Frame(
        nodes=drawing.nodes, members=members, pattern="nodes", control_node=drawing.control,
        kinematics="small" if drawing.tied else "pdelta",
    )  # fmt: skip


def followed(
    drawing: Drawing,
    path: np.ndarray,
    unload: bool,
    make: Callable[[Part, float], FrameMember] = kind,
) -> Curve:
    """Follow a path with rbsdem."""
    begin = time.process_time()
    frame = model(drawing, make)
    try:
        run = rbsdem.cyclic(frame, displacement=path)
    except rbsdem.SolveError as error:
        run = error.result
    rows = [run]
    if unload and run.state is not None:
        rows.append(rbsdem.cyclic(frame, force=np.linspace(run.force[-1], 0, 50), initial=run))
    seconds = time.process_time() - begin
    moved = np.concatenate([one.displacement for one in rows])
    yields = (e for e in run.events if e.member == drawing.watched and e.name == "yield")
    first = next(((event.displacement, event.force) for event in yields), (math.nan, math.nan))
    turns = any(node.panel for node in drawing.nodes)
    panel = run.springs["rotation"][:, -1] if turns else np.zeros(moved.size)
    return Curve(moved, np.concatenate([one.force for one in rows]), panel, first, seconds)


# ---- scores ------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Portal:
    """What test and model say of a portal; NaN for what the database does not have.

    Attributes
    ----------
    peak, alike, first, secant, drift : tuple of float
        Of test and model: peak [N]; that of the test and the force of the model at its drift;
        stiffness [N/m] (that of the test is in both) at the first point and at 70 % of the peak;
        drift at the peak.
    secants : list of tuple of float
        That of the test at its first point, and secants of the model at `DRIFTS` [N/m].
    stopped : bool
        Whether the model ended before the test.
    """

    peak: tuple[float, float]
    alike: tuple[float, float]
    first: tuple[float, float]
    secant: tuple[float, float]
    drift: tuple[float, float]
    secants: list[tuple[float, float]]
    stopped: bool


@dataclass(frozen=True)
class Answers:
    """What a program says of all tests.

    Attributes
    ----------
    portals : dict
        By whether the loads are tied, then by number.
    vecchio_emara, park_ruitong : Curve
        The two others.
    seconds : tuple of float
        Processor time of a portal in the median, of Vecchio and Emara, of Park and Dai Ruitong.
    """

    portals: dict[bool, dict[int, Portal]]
    vecchio_emara: Curve
    park_ruitong: Curve
    seconds: tuple[float, float, float]


def rows_of(file: Path) -> list[dict[str, str]]:
    """Return the rows of a file of the folder."""
    with file.open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(line for line in lines if not line.startswith("#")))


def reversals(folder: Path) -> np.ndarray:
    """Return displacements [m] and forces [N] at the reversals of Park and Dai Ruitong."""
    rows = rows_of(folder / "park_ruitong_peaks.csv")
    return np.array([[1e-3 * float(row["delta_mm"]), 1e3 * float(row["V_kN"])] for row in rows])


def push_path() -> np.ndarray:
    """Return the path of Vecchio and Emara [m]."""
    return np.linspace(0, 0.155, PUSH + 1)[1:]


def ways(folder: Path) -> np.ndarray:
    """Return the path of Park and Dai Ruitong from reversal to reversal [m]."""
    turns = pairwise(np.r_[0.0, reversals(folder)[:, 0]])
    return np.concatenate([np.linspace(a, b, WAY + 1)[1:] for a, b in turns])


def portal_answer(row: dict[str, str], drawing: Drawing, curve: Curve, drift: float) -> Portal:
    """Compare the curve of a portal with the test."""
    height = max(node.y or 0.0 for node in drawing.nodes)
    test = [float(row[f"glb_{name}"] or 0) or math.nan for name in (
        "initial_stiffness", "peak_lateral_load", "drift_at_peak_lateral_load")]  # fmt: skip
    force, moved = curve.force, curve.displacement
    top = int(force.argmax())
    early = int(np.argmax(force >= 0.7 * force[top]))
    return Portal(
        (1e3 * test[1], float(force[top])),
        (1e3 * test[1], float(np.interp(test[2] * height, moved, force, right=math.nan))),
        (1e3 * test[0], float(force[0] / moved[0])),
        (1e3 * test[0], float(force[early] / moved[early])),
        (test[2], float(moved[top] / height)),
        [
            (1e3 * test[0], float(np.interp(at * height, moved, force) / (at * height)))
            for at in DRIFTS
        ],
        bool(moved[-1] < 0.999 * drift * height),
    )


def answers(folder: Path, ends: str, program: Program) -> Answers:
    """Run a program on all drawings."""
    rows = rows_of(folder / "portals.csv")[1:]
    found: dict[bool, dict[int, Portal]] = {False: {}, True: {}}
    seconds = []
    for row in rows:
        for tied, into in found.items():
            drawing = portal(row, ends, tied)
            height = max(node.y or 0.0 for node in drawing.nodes)
            drift = float(row["glb_peak_lateral_drift"])
            path = np.linspace(0, drift * height, PUSH + 1)[1:]
            curve = program(drawing, path, False)
            seconds.append(curve.seconds)
            into[int(row["entry_id"])] = portal_answer(row, drawing, curve, drift)
    push = program(two_storeys(ends), push_path(), True)
    loops = program(cruciform(ends), ways(folder), False)
    times = float(np.median(seconds)), push.seconds, loops.seconds
    return Answers(found, push, loops, times)


def scores(ratios: list[float], spread: float = 1.5) -> tuple[int, str]:
    """Return number, and median of test over model, sd of ln, share within a factor."""
    kept = np.array([ratio for ratio in ratios if math.isfinite(ratio) and ratio > 0])
    logs = np.log(kept)
    near, sd = 100 * np.mean(np.abs(logs) < math.log(spread)), np.std(logs, ddof=1)
    return kept.size, f"{np.median(kept):.2f}, {sd:.2f}, {near:.0f} %"


def table(head: str, programs: list[str], rows: list[list[str]]) -> None:
    """Print a table with a column for each program."""
    print("\n| " + " | ".join([*head.split("; "), *programs]) + " |")
    print("|" + " --- |" * len(rows[0]))
    for row in rows:
        print("| " + " | ".join(row) + " |")


def portal_table(found: dict[str, Answers]) -> None:
    """Print the scores of the portals."""
    whats = (
        ("peak, all", "peak", set()),
        ("peak, without doubtful entries", "peak", DOUBTFUL),
        ("the same without 154", "peak", DOUBTFUL | {154}),
        ("peak over the force at its drift, without doubtful entries", "alike", DOUBTFUL),
        ("initial stiffness over the first one", "first", DOUBTFUL | OTHER_UNITS),
        ("initial stiffness over that at 70 % of the peak", "secant", DOUBTFUL | OTHER_UNITS),
        ("drift at peak", "drift", DOUBTFUL | STOPPED),
    )
    rows = []
    for name, what, without in whats:
        for tied, held in ((False, "weights"), (True, "tie rods")):
            cells = []
            for one in found.values():
                pairs = (getattr(p, what) for n, p in one.portals[tied].items() if n not in without)
                count, cell = scores([test / own for test, own in pairs])
                cells.append(cell)
            rows.append([f"{name}; {held}", f"{count}", *cells])
    table("portals, test over model: median, sd of ln, within 1.5; tests", list(found), rows)


def wear_tables(found: dict[str, Answers], folder: Path) -> None:
    """Print stiffnesses at small drifts, and what the second cycle at a displacement loses."""
    rows = []
    for number, drift in enumerate(DRIFTS):
        cells = []
        for one in found.values():
            held = one.portals[True].items()
            pairs = [p.secants[number] for n, p in held if n not in DOUBTFUL | OTHER_UNITS]
            count, cell = scores([test / own for test, own in pairs])
            cells.append(cell)
        rows.append([f"portals, tie rods: first stiffness over the secant at {100 * drift:g} %",
                     f"{count}", *cells])  # fmt: skip
    table("stiffness, test over model: median, sd of ln, within 1.5; tests", list(found), rows)
    runs = rows_of(folder / "park_ruitong_peaks.csv")
    # Both readings of the two cycles at a displacement; in the digitised one most share a tip.
    tests = [np.abs([float(row[name]) for row in runs]) for name in ("v1_V_kN", "V_kN")]
    models = [np.abs(one.park_ruitong.force[WAY - 1 :: WAY]) for one in found.values()]
    pairs = [(i, i + 2) for i in range(2, len(runs) - 2) if i % 4 in (2, 3)]

    def losses(forces: np.ndarray) -> np.ndarray:
        lost = [100 * (1 - forces[j] / forces[i]) for i, j in pairs if j < forces.size]
        return np.array([*lost, *[math.nan] * (len(pairs) - len(lost)), np.mean(lost)])

    cells = [[f"{lost:.1f}" for lost in losses(one)] for one in (*tests, *models)]
    names = [f"{float(runs[i]['delta_mm']):.0f} mm" for i, _ in pairs] + ["mean"]
    rows = [
        [name, f"{hand}; {digitised}", *by_model]
        for name, hand, digitised, *by_model in zip(names, *cells, strict=True)
    ]
    table("Park and Dai Ruitong, loss to the second cycle, %; test, by hand and digitised",
          list(found), rows)  # fmt: skip


def weak_panel() -> None:
    """Print what three cycles take from the cruciform with a panel without hoops, and its wear."""
    drawing = cruciform("asce")
    column, beam = drawing.parts[0].section, drawing.parts[2].section
    weak = rbsdem.Concrete(20e6)
    column, beam = replace(column, concrete=weak), replace(beam, concrete=weak)
    panel = JointPanel(column, beam, beam_length=2.119, column_height=2.473).spring()
    turns = np.array([s * d for d in (0.01, 0.02, 0.03) for _ in range(3) for s in (1, -1)])
    path = np.concatenate(
        [np.linspace(a, b, WAY + 1)[1:] for a, b in pairwise(2.473 * np.r_[0.0, turns])]
    )
    rows = []
    for name, spring in (("as it is", panel), ("without wear", replace(panel, lambda_s=0.0))):
        nodes = tuple(replace(n, panel=spring) if n.panel else n for n in drawing.nodes)
        parts = tuple(
            replace(part, section=beam if part.name in ("west", "east") else column)
            for part in drawing.parts
        )
        curve = followed(replace(drawing, nodes=nodes, parts=parts), path, False)
        force = np.abs(curve.force[WAY - 1 :: WAY])
        losses = (100 * (1 - force[i + 4 : i + 6].mean() / force[i : i + 2].mean())
                  for i in (0, 6, 12) if force.size >= i + 6)  # fmt: skip
        rows.append([name, "; ".join(f"{loss:.0f}" for loss in losses)])
    table("the same cruciform without hoops in the node, f'c 20 MPa",
          ["loss to the third cycle at 1, 2, 3 % drift, %"], rows)  # fmt: skip


def energy(curve: Curve, rows: int | None = None) -> float:
    """Return the work of the force in the first rows, or in all of them [J]."""
    force, moved = (np.r_[0.0, one[:rows]] for one in (curve.force, curve.displacement))
    return float(np.trapezoid(force, moved))


def work_of_push(push: Curve) -> str:
    """Return the work of the push [kN m], or where the path ends."""
    far = push.displacement[min(PUSH, push.displacement.size) - 1]
    if far < 0.1549:
        return f"the path ends at {1e3 * far:.0f} mm"
    return f"{energy(push, PUSH) / 1e3:.1f}"


def push_table(found: dict[str, Curve]) -> None:
    """Print the scores of Vecchio and Emara."""
    names = (
        ("push to 155 mm", "peak 330 kN at 50 mm"),
        ("first yield of the lower beam", ""),
        ("secant stiffness there; at 50 mm", "6.1 kN/mm"),
        ("work of the push; less that of unloading", "44.4 kN m"),
    )
    cells = []
    for push in found.values():
        top, (moved, force) = int(push.force.argmax()), push.yielded
        far = float(np.interp(0.05, push.displacement[:PUSH], push.force[:PUSH]))
        cells.append((
            f"peak {push.force[top] / 1e3:.0f} kN at {1e3 * push.displacement[top]:.0f} mm",
            f"{force / 1e3:.0f} kN at {1e3 * moved:.0f} mm",
            f"{force / moved / 1e6:.1f}; {far / 0.05 / 1e6:.1f}",
            f"{work_of_push(push)}; energy {energy(push) / 1e3:.1f} kN m",
        ))  # fmt: skip
    rows = [[*name, *row] for name, row in zip(names, zip(*cells, strict=True), strict=True)]
    table("Vecchio and Emara 1992; test", list(found), rows)


def vecchio_emara(ends: str, program: Program = followed) -> None:
    """Push the frame of Vecchio and Emara, for which no folder is needed, and print its scores."""
    push_table({"model": program(two_storeys(ends), push_path(), True)})


def loop_table(found: dict[str, Answers], folder: Path) -> None:
    """Print the scores of Park and Dai Ruitong."""
    test = reversals(folder)
    rows = [
        ["reversals followed", f"{len(test)}"],
        ["force of test over model: median, from, to", ""],
        ["the same at the first two; at those of 15 to 29 mm; beyond", ""],
        ["share of the node in the displacement", "9 to 14 %"],
    ]
    of_test = rows_of(folder / "park_ruitong_unloading.csv")
    for row in of_test:
        bounds = f"{row['k_80_20']} ({row['k_low']} to {row['k_high']})"
        rows.append([f"unloading from reversal {row['run']}, chord 80 to 20 %, kN/mm", bounds])
    for one in found.values():
        loops = one.park_ruitong
        at = np.arange(WAY - 1, loops.force.size, WAY)
        ratios = test[: at.size, 1] / loops.force[at]
        share = 100 * np.abs(loops.panel[at] * 2.473 / loops.displacement[at])
        thirds = (np.median(part) for part in (ratios[:2], ratios[2:6], ratios[6:]))
        cells = [
            f"{at.size}",
            f"{np.median(ratios):.2f}, {ratios.min():.2f}, {ratios.max():.2f}",
            "; ".join(f"{part:.2f}" for part in thirds),
            f"{share.min():.0f} to {share.max():.0f} %",
            *chords(loops, [int(row["run"]) for row in of_test]),
        ]
        for row, cell in zip(rows, cells, strict=True):
            row.append(cell)
    table("Park and Dai Ruitong 1988, Unit 1; test", list(found), rows)
    panel = cruciform("0").nodes[-1].panel
    print(f"its panel cracks at {panel.f_c / 2473:.0f} kN and reaches {panel.f_y / 2473:.0f} kN")


def report(found: dict[str, Answers], folder: Path, entries: bool) -> None:
    """Print the tables."""
    for who, one in found.items():
        times = " / ".join(f"{1e3 * seconds:.0f}" for seconds in one.seconds)
        print(f"{who}: {times} ms a portal / Vecchio and Emara / Park and Dai Ruitong")
        for number in one.portals[False] if entries else ():
            line = f"{number:4d}"
            for of in one.portals.values():
                p = of[number]
                pairs = (p.first, p.secant, p.peak, p.alike, p.drift)
                line += " |" + "".join(f"{test / own:7.2f}" for test, own in pairs)
                line += f" {p.peak[1] / 1e3:5.0f} kN at {100 * p.drift[1]:.1f} %"
                line += " stopped" if p.stopped else ""
            print(line)
    portal_table(found)
    names = {"frm_h": "height", "col_h": "depth of columns"}
    for key, name in names.items():
        rows = [
            r for r in rows_of(folder / "portals.csv")[1:] if int(r["entry_id"]) not in DOUBTFUL
        ]
        size = 1e-3 * np.quantile([float(row[key]) for row in rows], (0, 0.5, 1))
        print("{} of the portals: {:.2f} to {:.2f} m, median {:.2f}".format(
            name, *size[[0, 2, 1]]))  # fmt: skip
    push_table({who: one.vecchio_emara for who, one in found.items()})
    loop_table(found, folder)
    wear_tables(found, folder)


def chords(loops: Curve, runs: list[int]) -> Iterator[str]:
    """Yield chord stiffnesses from 80 to 20 % of the force, unloading from reversals [kN/mm]."""
    for run in runs:
        top = run * WAY - 1
        force, moved = loops.force[top : top + WAY + 1], loops.displacement[top : top + WAY + 1]
        if force.size < 2:
            yield "not followed"
            continue
        high, low = (float(np.interp(-share, -force / force[0], moved)) for share in (0.8, 0.2))
        yield f"{0.6 * abs(force[0]) / abs(high - low) / 1e6:.1f}"


# ---- a column that fails in shear --------------------------------------------------------------


def shear_column() -> Frame:
    """Return the centre column of the shaken frame of Elwood and Moehle 2002, specimen 2.

    Both ends do not turn; what beams carry after its loss is a spring of 99.9 kip/in, as in the
    model of its authors. The ties are wires of 3/16 in whose spacing and strength are those of
    rho'' = 0.0018 and A_st f_yt d_c/s = 11.87 kip.
    """
    inch, kip = 0.0254, 4448.22
    ksi = kip / inch**2
    steel, side, wire = rbsdem.Steel(69.5 * ksi), 9.0, 3 / 16
    legs = 2 * math.pi * wire**2 / 4
    spacing = legs / (0.0018 * side)
    bars = [(3.25, 0.40), (3.187, 0.31), (0.0, 0.62), (-3.187, 0.31), (-3.25, 0.40)]
    cover = side / 2 - 3.25 - 0.25 - wire

    def drawn(tie_yield: float) -> rbsdem.RectangularSection:
        return rbsdem.RectangularSection(
            side * inch, side * inch, rbsdem.Concrete(3.517 * ksi), cover=cover * inch,
            bars=[(y * inch, area * inch**2, steel) for y, area in bars], bar_diameter=0.56 * inch,
            ties=rbsdem.Ties(wire * inch, spacing * inch, rbsdem.Steel(tie_yield)),
        )  # fmt: skip

    core = side - 2 * cover - wire
    section = drawn(11.87 * ksi * spacing / (legs * core))
    top = FrameNode(
        "top", 0.0, 58 * inch, load_y=-70 * kip, push_x=1.0, mass=0.1813 * kip / inch,
        flexure=Elastic(1e11), axial_spring=Elastic(99.9 * kip / inch),
    )  # fmt: skip
    column = rbsdem.section.member(section, 58 * inch, axial_load=70 * kip)
    return Frame(
        nodes=[FrameNode("foot", 0.0, 0.0, "fixed"), top], pattern="nodes", kinematics="pdelta",
        members=[Member("C", "foot", "top", column)], damping=rbsdem.Damping(mass=2.0),
    )  # fmt: skip


def elwood_moehle() -> None:
    """Print where the column fails in shear and loses its axial load, and who carries it then."""
    frame = shear_column()
    kind = frame.members[0].kind
    push = rbsdem.pushover(frame, drift=0.08)
    t = np.arange(0, 30, 0.005)
    ground = np.where(t < 10, 0.8 * t, 0.0) * np.sin(9 * t)
    quake = rbsdem.time_history(frame, t, ground_acceleration=ground, method="newmark", dt=0.005)
    lost = next(event for event in quake.events if event.name == "lost")
    row = int(np.flatnonzero(quake.time == lost.time)[0])
    down, weight = -quake.y[:, 1] * 99.9 * 4448.22 / 0.0254, 70 * 4448.22
    rows = [
        ["drift at shear failure", "2.1 %", f"{100 * kind.shear_drift:.1f} %"],
        ["largest force", "", f"{push.force.max() / 1e3:.0f} kN"],
        ["drift at axial failure, pushed", "4.6 % by its formula", f"{100 * push.drift[-1]:.1f} %"],
        ["the same, shaken", "5.2 % in its authors' model", f"{100 * abs(lost.drift):.1f} %"],
        ["the beams carry before, at most after, at rest", "",
         "; ".join(f"{x / weight:.2f}" for x in (down[row - 1], down[row:].max(), down[-1]))
         + " of the load"],
    ]  # fmt: skip
    table("Elwood and Moehle 2002, specimen 2, centre column; source", ["rbsdem"], rows)


# ---- figures -----------------------------------------------------------------------------------


def save(figure: Figure, target: Path) -> None:
    """Write a figure at the resolution of a page."""
    with style.style():
        figure.savefig(target, dpi=130)


def draw(found: dict[str, Answers], folder: Path, target: Path) -> None:
    """Write a figure of each test, with one or two programs in it."""
    looks = [
        {"color": "black", "linewidth": 0.9},
        {"color": "0.45", "linewidth": 0.9, "linestyle": (0, (4, 1.5))},
    ]
    looks = dict(zip(found, looks, strict=False))
    draw_portals(found, target / "frames_portals.png")
    axes = style.new_axes(1, 1, (4.6, 3.0))
    with style.style_of(axes[0]):
        draw_push(axes[0], found, looks, folder)
        save(axes[0].figure, target / "frames_vecchio_emara.png")
    axes = style.new_axes(1, len(found), (3.4 * len(found), 3.0), sharey=True)
    test = reversals(folder)
    for ax, (who, one) in zip(axes, found.items(), strict=True):
        with style.style_of(ax):
            draw_loops(ax, one.park_ruitong, who, test, folder)
    axes[0].set_ylabel("Force (kN)")
    save(axes[0].figure, target / "frames_park_ruitong.png")


def draw_portals(found: dict[str, Answers], target: Path) -> None:
    """Draw test over model of the portals, sure entries full and doubtful ones open."""
    axes = style.new_axes(1, 3, (7.2, 2.6))
    whats = (
        ("peak", "Peak (kN)", 1e-3, set()),
        ("first", "First stiffness (kN/mm)", 1e-6, OTHER_UNITS),
        ("drift", "Drift at peak (%)", 100.0, STOPPED),
    )
    marks, faces = (
        dict(zip(found, "os", strict=False)),
        dict(zip(found, ("0.3", "0.8"), strict=False)),
    )
    for ax, (what, label, unit, without) in zip(axes, whats, strict=True):
        values = []
        with style.style_of(ax):
            for who, one in found.items():
                for number, held in one.portals[True].items():
                    test, own = (unit * value for value in getattr(held, what))
                    if number in without or not math.isfinite(test):
                        continue
                    face = "white" if number in DOUBTFUL else faces[who]
                    ax.plot(own, test, marks[who], ms=4, mfc=face, mec="0.2", mew=0.6)
                    values += [own, test]
            least, most = 0.7 * min(values), 1.4 * max(values)
            for factor, dash in ((1.0, "-"), (1.5, ":"), (1 / 1.5, ":")):
                ax.plot([least, most], [factor * least, factor * most], dash, c="0.6", lw=0.6)
            ax.set(xscale="log", yscale="log", xlim=(least, most), ylim=(least, most))
            for axis in (ax.xaxis, ax.yaxis):
                axis.set_major_locator(LogLocator(subs=(1, 2, 5), numticks=99))
                axis.set_major_formatter("{x:g}")
                axis.set_minor_formatter(NullFormatter())
            ax.set(xlabel=f"{label}, model", ylabel="test")
    with style.style_of(axes[0]):
        handles = [
            Line2D([], [], ls="none", marker=marks[who], ms=4, mfc=faces[who], mec="0.2", label=who)
            for who in found
        ]
        axes[0].legend(handles=handles, loc="upper left", handletextpad=0.2)
    save(axes[0].figure, target)


def draw_push(ax: Axes, found: dict[str, Answers], looks: dict, folder: Path) -> None:
    """Draw the push of Vecchio and Emara with the printed values of the test."""
    for who, one in found.items():
        push, look = one.vecchio_emara, looks[who]
        moved, force = (np.r_[0.0, values] for values in (push.displacement, push.force))
        ax.plot(1e3 * moved, 1e-3 * force, label=who, **look)
        first, at = push.yielded
        ax.plot(1e3 * first, 1e-3 * at, "v", ms=4, c=look["color"], label="_")
    value = {row["quantity"]: float(row["value"]) for row in rows_of(folder / "vecchio_emara.csv")}
    at, secant = value["displacement at peak"], value["secant stiffness at yield"]
    ax.plot([at], [value["peak lateral load"]], label="test: peak", **style.TEST_POINTS)
    ax.plot([0, at], [0, at * secant], label="test: secant", **style.TEST_LINE)
    ax.set(xlabel="Displacement of the roof (mm)", ylabel="Force (kN)")
    ax.set(xlim=(0, 160), ylim=(0, None))
    handles, labels = ax.get_legend_handles_labels()
    handles.append(Line2D([], [], ls="none", marker="v", ms=4, c="black"))
    labels.append("lower beam yields")
    ax.legend(handles, labels, loc="lower center", bbox_to_anchor=(0.42, 0.0))


def draw_loops(ax: Axes, loops: Curve, who: str, test: np.ndarray, folder: Path) -> None:
    """Draw the loops of the cruciform with reversals and unloading of the test."""
    ax.axhline(0.0, **style.ZERO_LINE)
    moved, force = (np.concatenate([[0.0], v]) for v in (loops.displacement, loops.force))
    ax.plot(1e3 * moved, 1e-3 * force, label=who, **style.MODEL_LINE)
    ax.plot(1e3 * test[:, 0], 1e-3 * test[:, 1], label="test: reversals", **style.TEST_POINTS)
    for row in rows_of(folder / "park_ruitong_unloading.csv"):
        top, zero = test[int(row["run"]) - 1], float(row["zero_force_mm"])
        line = ax.plot([1e3 * top[0], zero], [1e-3 * top[1], 0.0], **style.TEST_LINE)
    line[0].set_label("test: unloading")
    ax.set(xlabel="Displacement (mm)")
    ax.legend(loc="upper left", fontsize=8)


def options() -> argparse.Namespace:
    """Return what was asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    default = os.environ.get("RBSDEM_FRAMES_DIR", ".")
    parser.add_argument("folder", nargs="?", default=default, type=Path)
    parser.add_argument("--ends", choices=("0", "1", "asce"), default="asce")
    parser.add_argument("--entries", action="store_true", help="a line for each portal")
    parser.add_argument("--figures", type=Path, help="folder to draw into")
    return parser.parse_args()


def study(programs: dict[str, Program]) -> None:
    """Run programs, print their tables, draw their figures."""
    asked = options()
    warnings.simplefilter("ignore")
    if not (asked.folder / "portals.csv").exists():
        for program in programs.values():
            vecchio_emara(asked.ends, program)
        return
    found = {who: answers(asked.folder, asked.ends, one) for who, one in programs.items()}
    report(found, asked.folder, asked.entries)
    weak_panel()
    elwood_moehle()
    if asked.figures:
        draw(found, asked.folder, asked.figures)


if __name__ == "__main__":
    study({"rbsdem": followed})
