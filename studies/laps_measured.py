"""Columns with laps at their feet against tests: table of docs/existing.md.

    python studies/laps_measured.py [FOLDER]

FOLDER, by default that of the environment variable RBSDEM_ACI369_DIR, holds `columns.csv`: columns
of the ACI 369 database. Its lapped columns are the six cantilevers of Melek and Wallace 2004, of
one section and one lap length. They are pushed to 5 % with continuous bars and with their laps, as
the model has them and with shear springs that neither crack nor fail.
"""

from __future__ import annotations

import argparse
import csv
import os
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

import rbsdem
from rbsdem import Concrete, Lap, Layout, RectangularSection, Steel, Ties
from rbsdem.springs import Elastic


def section_of(row: dict[str, str]) -> RectangularSection:
    """Return the drawing of a column with bars of one diameter along its faces."""
    value = {name: float(number) for name, number in row.items() if name.endswith(("_m", "_Pa"))}
    number = 2 * int(row["bars_face_perpendicular_or_all"]) + 2 * int(row["bars_middle_parallel"])
    return RectangularSection(
        value["width_m"], value["depth_m"], Concrete(value["fc_Pa"]),
        layout=Layout(number, value["bar_1_m"], Steel(value["bar_fy_Pa"])),
        ties=Ties(value["tie_m"], value["tie_spacing_m"], Steel(value["tie_fy_Pa"]),
                  legs=float(row["legs_parallel"])),
        cover=value["clear_cover_to_hoops_m"], lap=Lap(value["lap_length_m"]),
    )  # fmt: skip


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    default = os.environ.get("RBSDEM_ACI369_DIR", ".")
    parser.add_argument("folder", nargs="?", default=default, type=Path)
    asked = parser.parse_args()
    warnings.simplefilter("ignore")
    file = asked.folder / "columns.csv"
    if not file.exists():
        raise SystemExit(f"{asked.folder}: no columns.csv; name its folder")
    with file.open(encoding="utf-8", newline="") as lines:
        rows = [r for r in csv.DictReader(lines) if r["lapped"] == "1" and float(r["lap_length_m"])]
    head = "column; f_s/f_y; peak, continuous bars; with its lap; by bending alone, continuous bars"
    head += "; with its lap; drift at 80 %, with its lap"
    print("| " + " | ".join(head.split("; ")) + " |")
    print("|" + " --- |" * 7)
    found = []
    for row in rows:
        lapped, test = section_of(row), float(row["largest_force_N"])
        share = lapped.lapped(lapped.bars[0][2])
        ratios, bent, drift = [], [], np.nan
        for section in (replace(lapped, lap=None), lapped):
            span, load = float(row["shear_span_m"]), float(row["axial_load_N"])
            column = rbsdem.section.column(section, span, axial_load=load)
            push = rbsdem.pushover(column, drift=0.05)
            ratios.append(test / push.force.max())
            stiff = [Elastic(s.response([1e-9])[0] / 1e-9) for s in column.joints("shear")]
            bends = rbsdem.pushover(replace(column, shear=stiff), drift=0.05)
            bent.append(test / bends.force.max())
            if "strength_loss" in push.limit_states():
                drift = (
                    float(row["drift_at_80_pc"]) / 100 / push.limit_states()["strength_loss"].drift
                )
        found.append([*ratios, *bent, drift])
        cells = [row["specimen"], f"{share:.2f}", *(f"{one:.2f}" for one in found[-1])]
        print("| " + " | ".join(cells) + " |")
    logs = np.log(np.array(found))
    cells = [
        f"{np.exp(np.nanmedian(column)):.2f}, {np.nanstd(column, ddof=1):.2f}" for column in logs.T
    ]
    print("| median, sd of ln | | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
