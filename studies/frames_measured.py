"""Frames from their drawings against tested frames: tables of docs/frames.md.

    python studies/frames_measured.py [FOLDER] [--ends 0|1|asce] [--follow] [--entries]

FOLDER, by default that of the environment variable RBSDEM_FRAMES_DIR, holds `portals.csv` (the 23
bare portals of the FRESCO database), and `park_ruitong_peaks.csv`; the drawings of Vecchio and
Emara 1992 and of Park and Dai Ruitong 1988 stand here.

Members are those of `rbsdem.section.member`. Nothing is fitted. Taken where the database is silent:
heights and spans between axes, the load on each column, two legs of ties, no panels. The model is
pushed as far as the test. `--ends` is the rigid share of the nodes, by default by the rule of ASCE
41-17; with `--follow` the loads on columns do no second-order work, as those of tie rods.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import re
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

import rbsdem
from rbsdem.frames import Frame, FrameMember, FrameNode, Member, Panel

#: Beam bars differ at the ends or cannot be read: see the comments of the database.
DOUBTFUL = {82, 84, 104, 160, 180, 186}
#: Tests that stop at 1 % drift, before their peak.
STOPPED = {96, 97, 98, 99}
#: Stiffnesses that are those of no concrete frame of this size, by factors of 30 and more.
OTHER_UNITS = {31, 154}


def kind(
    section: rbsdem.RectangularSection, length: float, load: float = 0.0, panel: float = 0.0
) -> FrameMember:
    """Return the kind of members with a section; where they turn forward its top is in tension."""
    return rbsdem.section.member(section.mirrored, length, axial_load=load, panel=panel)


def strength(section: rbsdem.RectangularSection, load: float) -> float:
    """Return the largest moment of a section [N m]."""
    return rbsdem.section.diagram(section, load).events.peak.moment


def shares(ends: str, column: float, beam: float) -> tuple[float, float]:
    """Return the rigid shares of columns and beams; moments [N m] for the rule of ASCE 41-17.

    Columns stronger than 1.2 times the beams are rigid in the node, weaker than 0.8 times the beams
    are, and both by half between (10.4.2.2.1).
    """
    if ends != "asce":
        return float(ends), float(ends)
    ratio = column / beam
    return (1.0, 0.0) if ratio > 1.2 else (0.0, 1.0) if ratio < 0.8 else (0.5, 0.5)


def bars_of(text: str) -> tuple[int, float]:
    """Return number and diameter [m] of '4#12'."""
    number, diameter = text.split("#")
    return int(number or 2), 1e-3 * float(diameter)


def section_of(
    row: dict[str, str], which: str, width: float, depth: float
) -> rbsdem.RectangularSection:
    """Return the section of the columns or the beams of a portal."""
    fy = 1e6 * float(row["fy"])
    steel = rbsdem.Steel(fy, es=1e9 * float(row["Ey"]) if float(row["Ey"] or 0) else 200e9)
    cover = 1e-3 * float(row[f"{which}_cover"])
    hoop = re.fullmatch(r"\d*#([\d.]+)@([\d.]+)", row[f"{which}_trans_mid_reinf"])
    tie, spacing = (1e-3 * float(value) for value in hoop.groups())
    bars, areas = [], []
    for place in ("corner", "top", "mid", "bot"):
        number, diameter = bars_of(row[f"{which}_long_reinf_{place}"])
        if not number:
            continue
        y = 0.5 * depth - cover - tie - 0.5 * diameter
        area = number * math.pi * diameter**2 / 4
        rows = {
            "corner": [(y, area / 2), (-y, area / 2)], "top": [(-y, area)], "bot": [(y, area)],
            "mid": [(0.0, area)],
        }  # fmt: skip
        bars += [(at, each, steel) for at, each in rows[place]]
        areas.append((number, diameter))
    mean = sum(n * d for n, d in areas) / sum(n for n, _ in areas)
    return rbsdem.RectangularSection(
        width, depth, rbsdem.Concrete(1e6 * float(row["fc"])), bars=bars, bar_diameter=mean,
        ties=rbsdem.Ties(tie, spacing, steel), cover=cover,
    )  # fmt: skip


def followed(frame: Frame, path: np.ndarray) -> rbsdem.frames.FrameResult:
    """Follow displacements as far as the path goes; say where it ends."""
    try:
        return rbsdem.cyclic(frame, displacement=path)
    except rbsdem.SolveError as error:
        rows = error.result.displacement
        print(f"(the path ends at row {rows.size} of {len(path)}, {1e3 * rows[-1]:.0f} mm)")
        return error.result


def pushed(frame: Frame, drift: float) -> rbsdem.frames.FrameResult:
    """Push to a drift."""
    return followed(frame, np.linspace(0, drift * frame.height, 801)[1:])


def portal(row: dict[str, str], ends: str, follow: bool) -> tuple[float, float, float, float]:
    """Return the first stiffness and that at 70 % of the peak [N/m], peak [N] and drift there."""
    sizes = {name: 1e-3 * float(row[name]) for name in (
        "frm_h", "frm_l", "col_h", "col_d", "bm_h", "bm_t")}  # fmt: skip
    column = section_of(row, "col", sizes["col_d"], sizes["col_h"])
    beam = section_of(row, "bm", sizes["bm_t"], sizes["bm_h"])
    load = 1e3 * float(row["inp_column_vertical_load"] or 0)
    span, height = sizes["frm_l"], sizes["frm_h"]
    rigid = shares(ends, strength(column, load), strength(beam, 0.0))
    inner = (0.5 * rigid[0] * sizes["bm_h"], 0.5 * rigid[1] * sizes["col_h"])

    frame = Frame.grid(
        [height], [span],
        columns=kind(column, height - inner[0], load, inner[0]),
        beams=kind(beam, span - 2.0 * inner[1], 0.0, inner[1]),
        kinematics="small" if follow else "pdelta", pattern="uniform",
        nodes=[FrameNode(f"N-{line}-1", load_y=-load) for line in (1, 2)],
    )  # fmt: skip
    push = pushed(frame, float(row["glb_peak_lateral_drift"]))
    top = int(push.force.argmax())
    early = int(np.argmax(push.force >= 0.7 * push.force[top]))
    return (
        float(push.force[0] / push.displacement[0]),
        float(push.force[early] / push.displacement[early]),
        float(push.force[top]),
        float(push.drift[top]),
    )


def scores(name: str, ratios: list[float], spread: float = 1.5) -> str:
    """Return a row: number, median of test over model, sd of ln, share within a factor."""
    found = np.array([ratio for ratio in ratios if math.isfinite(ratio) and ratio > 0])
    logs = np.log(found)
    near, sd = 100 * np.mean(np.abs(logs) < math.log(spread)), np.std(logs, ddof=1)
    return f"| {name} | {found.size} | {np.median(found):.2f} | {sd:.2f} | {near:.0f} % |"


def portals(folder: Path, ends: str, follow: bool, entries: bool) -> None:
    """Print the table of the portals."""
    with (folder / "portals.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))[1:]
    found = {}
    for row in rows:
        number = int(row["entry_id"])
        uncracked, stiffness, peak, drift = portal(row, ends, follow)
        names = ("initial_stiffness", "peak_lateral_load", "drift_at_peak_lateral_load")
        test = [float(row[f"glb_{name}"] or 0) for name in names]
        strength = 1e3 * test[1] / peak
        stiff = [1e3 * test[0] / one for one in (uncracked, stiffness)]
        found[number] = (*stiff, strength, test[2] / drift)
        if entries:
            ratios = " ".join(f"{ratio:6.2f}" for ratio in found[number])
            print(f"{number:4d} {ratios}   {peak / 1e3:.0f} kN at {100 * drift:.1f} %")
    sure = [one for number, one in found.items() if number not in DOUBTFUL]
    last = [one for number, one in found.items() if number not in DOUBTFUL | STOPPED]
    stiff = [one for number, one in found.items() if number not in DOUBTFUL | OTHER_UNITS]
    print("| portals, test over model | tests | median | sd of ln | within 1.5 |")
    print("| --- | --- | --- | --- | --- |")
    print(scores("peak, all", [one[2] for one in found.values()]))
    print(scores("peak, without doubtful entries", [one[2] for one in sure]))
    print(scores("initial stiffness over the first one", [one[0] for one in stiff]))
    print(scores("initial stiffness over that at 70 % of the peak", [one[1] for one in stiff]))
    print(scores("drift at peak", [one[3] for one in last]))


def vecchio_emara(ends: str) -> None:
    """Print peak, stiffness and energy of the two storeys of Vecchio and Emara 1992."""
    steel = rbsdem.Steel(418e6, 596e6, es=192.5e9)
    ties = rbsdem.Ties(0.0113, 0.125, rbsdem.Steel(454e6))
    bar = 4 * 300e-6

    def section(cover: float) -> rbsdem.RectangularSection:
        y = 0.2 - cover
        return rbsdem.RectangularSection(
            0.3, 0.4, rbsdem.Concrete(30e6), bars=[(y, bar, steel), (-y, bar, steel)],
            bar_diameter=0.0195, ties=ties, cover=cover - 0.0098 - 0.0113,
        )  # fmt: skip

    column, beam = section(0.051), section(0.041)
    strong = strength(column, 700e3), strength(beam, 0.0)
    # Two columns meet below the roof.
    rigid = shares(ends, 2 * strong[0], strong[1])
    inner = [0.2 * share for share in rigid]
    frame = Frame.grid(
        [2.0, 2.0], [3.5],
        columns={
            (0, 1): kind(column, 2.0 - inner[0], 700e3, inner[0]),
            (0, 2): kind(column, 2.0 - 2 * inner[0], 700e3, inner[0]),
        },
        beams=kind(beam, 3.5 - 2 * inner[1], 0.0, inner[1]),
        kinematics="pdelta", pattern="nodes",
        nodes=[FrameNode(f"N-{line}-2", load_y=-700e3, push_x=0.5) for line in (1, 2)],
    )  # fmt: skip
    push = pushed(frame, 0.155 / 4.0)
    back = rbsdem.cyclic(frame, force=np.linspace(push.force[-1], 0, 50), initial=push)
    force = np.concatenate([[0.0], push.force, back.force])
    moved = np.concatenate([[0.0], push.displacement, back.displacement])
    energy = float(np.trapezoid(force, moved))
    top = int(push.force.argmax())
    # The first hinge is told to be that of the lower beam.
    beam_events = [event for event in push.events if event.member == "B-1-1"]
    first = next(event for event in beam_events if event.what == "yield")
    peak, at = push.force[top] / 1e3, 1e3 * push.displacement[top]
    secant = first.force / first.displacement / 1e6
    print(
        f"Vecchio, Emara: peak {peak:.0f} kN at {at:.0f} mm (330 at 50), secant where the "
        f"lower beam yields {secant:.1f} kN/mm (6.1), energy {energy / 1e3:.1f} kN m (44.4)"
    )


def park_ruitong(folder: Path, ends: str) -> None:
    """Print forces at the reversals of the cruciform of Park and Dai Ruitong 1988, Unit 1."""
    concrete = rbsdem.Concrete(45.9e6)
    tie, hd = rbsdem.Steel(282e6, 366e6), rbsdem.Steel(498e6)
    deformed = rbsdem.Steel(294e6, 434e6, es=210.4e9)
    bar = math.pi * 0.016**2 / 4
    column = rbsdem.RectangularSection(
        0.305, 0.406, concrete, bar_diameter=0.016, ties=rbsdem.Ties(0.006, 0.06, tie, legs=3),
        bars=[(0.16, 3 * bar, hd), (0.0, 2 * bar, hd), (-0.16, 3 * bar, hd)], cover=0.029,
    )  # fmt: skip
    beam = rbsdem.RectangularSection(
        0.229, 0.457, concrete, bar_diameter=0.016, ties=rbsdem.Ties(0.006, 0.08, tie),
        bars=[
            (-0.1865, 3 * bar, deformed), (-0.1535, 2 * bar, deformed), (0.1865, 2 * bar, deformed)
        ],
        cover=0.028,
    )  # fmt: skip
    # R12 and R8, five sets at 75 mm: two legs of each as three of 12 mm, nearly.
    hoops = rbsdem.Ties(0.012, 0.075, rbsdem.Steel(283e6), legs=2 + 2 * (8 / 12) ** 2)
    panel = Panel(column, beam, hoops=hoops, beam_length=2.119, column_height=2.473)
    strong = strength(column, 0.0), strength(beam, 0.0)
    rigid = shares(ends, *strong)
    up, side = 0.2285 * rigid[0], 0.203 * rigid[1]
    post = kind(column, 2 * (1.2365 - up), 0.0)
    arm = kind(beam, 2 * (2.119 - side), 0.0)

    def at_node(member: FrameMember, end: float) -> FrameMember:
        """Return the half of a member whose hinge is at its start or its end."""

        def on_half(springs: tuple[tuple[float, rbsdem.springs.Spring], ...]) -> dict:
            return {abs(end - 2 * at): spring for at, spring in springs if at < 0.5}

        return replace(
            member, flexure=on_half(member.flexure), shear=on_half(member.shear), area=member.area
        )

    places = {
        "foot": (0.0, -1.2365),
        "head": (0.0, 1.2365),
        "left": (-2.119, 0.0),
        "right": (2.119, 0.0),
    }
    supports = {"foot": "pinned", "head": "free", "left": "roller", "right": "roller"}
    nodes = [
        FrameNode(name, *place, supports[name], push_x=float(name == "head"))
        for name, place in places.items()
    ]
    # Without the 55 kN at 848 mm of each beam, whose moments in the node are in balance.
    members = [
        Member("lower", "foot", "node", at_node(post, 1.0), (0.0, up)),
        Member("upper", "node", "head", at_node(post, 0.0), (up, 0.0)),
        Member("west", "left", "node", at_node(arm, 1.0), (0.0, side)),
        Member("east", "node", "right", at_node(arm, 0.0), (side, 0.0)),
    ]
    with (folder / "park_ruitong_peaks.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    path = [1e-3 * float(row["delta_mm"]) for row in rows]
    test = np.array([float(row["V_kN"]) for row in rows])
    middle = FrameNode("node", 0.0, 0.0, panel=panel.spring())
    frame = Frame(nodes=[*nodes, middle], members=members, pattern="nodes", control_node="head")
    run = followed(frame, path)
    rows = run.force.size
    ratios = test[:rows] / (1e-3 * run.force)
    share = 100 * np.abs(run.springs["rotation"][:, -1] * 2.473 / run.displacement)
    least, most = ratios.min(), ratios.max()
    print(
        f"Park, Dai Ruitong: peaks, test over model {least:.2f} to {most:.2f}, median "
        f"{np.median(ratios):.2f}; node {share.min():.0f} to {share.max():.0f} % of the "
        f"displacement (9 to 14); its panel reaches {1e-3 * panel.moment / 2.473:.0f} kN"
    )


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("folder", nargs="?", default=os.environ.get("RBSDEM_FRAMES_DIR", "."))
    parser.add_argument("--ends", choices=("0", "1", "asce"), default="asce")
    parser.add_argument("--follow", action="store_true")
    parser.add_argument("--entries", action="store_true", help="a line for each portal")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    folder = Path(options.folder)
    portals(folder, options.ends, options.follow, options.entries)
    vecchio_emara(options.ends)
    park_ruitong(folder, options.ends)


if __name__ == "__main__":
    main()
