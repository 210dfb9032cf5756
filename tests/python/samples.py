"""Drawings, columns and records that several tests share."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console

import rbsdem
from rbsdem import peer, plot

STEEL = rbsdem.Steel(450e6, 650e6)
#: 400 x 400 mm of 40 MPa, 8 bars of 20 mm, three legs of 10 mm at 80 mm.
SECTION = rbsdem.RectangularSection(
    0.4,
    0.4,
    rbsdem.Concrete(40e6),
    layout=rbsdem.Layout(8, 0.02, STEEL),
    ties=rbsdem.Ties(0.01, 0.08, rbsdem.Steel(400e6), legs=3),
    cover=0.02,
)
#: 500 x 500 mm of 35 MPa, 8 bars of 25 mm of 460 MPa at 62.5 mm from the faces, three legs.
MILD = rbsdem.Steel(460e6, 575e6, es=200e9)
BAR = np.pi / 4 * 0.025**2
EIGHT_BARS = rbsdem.RectangularSection(
    0.5,
    0.5,
    rbsdem.Concrete(35e6),
    bars=[(0.1875, 3 * BAR, MILD), (0.0, 2 * BAR, MILD), (-0.1875, 3 * BAR, MILD)],
    bar_diameter=0.025,
    ties=rbsdem.Ties(0.01, 0.1, MILD, legs=3),
    cover=0.04,
)
TWELVE_BARS = rbsdem.CircularSection(
    0.6,
    rbsdem.Concrete(30e6),
    layout=rbsdem.Layout(12, 0.025, MILD),
    spiral=rbsdem.Spiral(0.01, 0.08, MILD),
    cover=0.03,
)
#: Sections of the ready house: 400 x 400 mm with 8 bars of 18 mm; 300 x 500 mm with rows of bars.
HOUSE = rbsdem.examples.house(1, 1).drawing
UPRIGHT, BEAM = HOUSE.columns[0, 0], HOUSE.beams[0, 0]
#: SECTION in a column of 1.6 m as a row of the table of tests.
SPECIMEN = peer.Specimen(
    name="Square",
    section="rectangular",
    length=1.6,
    width=0.4,
    depth=0.4,
    concrete_strength=40e6,
    axial_load=1.2e6,
    longitudinal_number=8,
    cover=0.02,
    corner_diameter=0.02,
    intermediate_diameter=0.02,
    intermediate_perpendicular=1,
    intermediate_parallel=1,
    corner_yield_stress=450e6,
    longitudinal_ultimate_stress=650e6,
    transverse_yield_stress=400e6,
    transverse_diameter=0.01,
    transverse_spacing=0.08,
    shear_legs=3.0,
)
#: The same as the file has it; a row changes what differs.
ROW = {
    "peer_id": "1", "file": "a.csv", "name": "Me 1990 No. 1", "author": "Me", "year": "1990",
    "section": "rectangular", "L_mm": "1600", "b_mm": "400", "h_mm": "400", "cover_mm": "20",
    "fc_MPa": "40", "axial_kN": "1200", "n_long": "8", "db_corner_mm": "20", "db_interm_mm": "20",
    "n_interm_perp": "1", "n_interm_par": "1", "fy_long_MPa": "450", "fu_long_MPa": "650",
    "fy_trans_MPa": "400", "db_trans_mm": "10", "s_trans_mm": "80", "legs_Nv": "3",
    "failure_mode": "Flexure", "pdelta_code": "2",
}  # fmt: skip


def write_table(folder: Path, rows: list[dict[str, str]]) -> peer.Specimens:
    """Write a table of tests, each of the row above with changes, and read it."""
    folder.mkdir(exist_ok=True)
    names = list(dict.fromkeys([*ROW, *(name for row in rows for name in row)]))
    with (folder / "specimens.csv").open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names)
        writer.writeheader()
        for number, row in enumerate(rows, 1):
            writer.writerow(ROW | {"peer_id": f"{number}", "name": f"Me 1990 No. {number}"} | row)
    return peer.read_specimens(folder)


def write_history(path: Path, displacement: np.ndarray, force: np.ndarray) -> None:
    """Write displacement [m] and force [N] as a history of the table, in mm and kN."""
    path.parent.mkdir(parents=True, exist_ok=True)
    rows = np.column_stack((1e3 * displacement, 1e-3 * force))
    header = "displacement_mm,force_kN"
    np.savetxt(path, rows, "%.17g", delimiter=",", header=header, comments="")


def read_rows(path: Path) -> list[dict[str, str]]:
    """Return the rows of a csv by the names of their columns."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def printed(thing: Any) -> str:
    """Return a record as the terminal shows its table."""
    text = io.StringIO()
    shown = plot.table(thing) if hasattr(thing, "to_pandas") else thing
    Console(file=text, width=200).print(shown)
    return text.getvalue()
