"""Shear strength of nodes with hoops against tests: table of docs/frames.md.

    python studies/joints.py [FOLDER]

FOLDER, by default that of the environment variable RBSDEM_FRAMES_DIR, holds `joints.csv`: 98
beam-column joints with hoops under cycles (H. Salem 2022, Mendeley Data 10.17632/rbhfnz32sy.1,
CC BY 4.0) with their shear stress at the peak. The file has no names of papers and no classes: here
are the programmes that names and sizes of its rows point to, from memory, and the class of each. It
does not say which tests had transverse beams; they count as none, but for the programme whose
specimens had beams on four sides. Many tests ended by yielding of the beams: the stress of these is
less than the strength.
"""

from __future__ import annotations

import argparse
import csv
import os
from pathlib import Path

import numpy as np

from rbsdem.section.panel import panel_strength

#: Rows of each programme, in order; class; beams on four sides.
PROGRAMMES = (
    (3, "Burak, Wight 2008, 1-S and 3-S", "interior"),
    (2, "Burak, Wight 2008, 2-N and 3-N", "exterior"),
    (2, "JC", "interior"),
    (3, "Durrani, Wight 1985", "interior"),
    (11, "Ehsani, Alameddine 1991", "exterior"),
    (6, "Ehsani, Wight 1985", "exterior"),
    (4, "Fujii, Morita 1991, A", "interior"),
    (4, "Fujii, Morita 1991, B", "exterior"),
    (4, "Gentry, Wight 1994", "exterior"),
    (4, "Guimaraes, Kreger, Jirsa 1992", "interior, beams on four sides"),
    (18, "Kaku, Asakusa 1991", "exterior"),
    (4, "Kitayama, Otani, Aoyama 1991", "interior"),
    (4, "LaFave, Wight 1999", "exterior"),
    (5, "Lee, Ko 2007", "exterior"),
    (2, "Oka, Shiohara 1992", "interior"),
    (3, "Quintero-Febres, Wight 2001", "interior"),
    (4, "Raffaelle, Wight 1995", "interior"),
    (4, "Shin, LaFave 2004", "interior"),
    (5, "Teng, Zhou 2003", "interior"),
    (3, "EJ", "exterior"),
    (3, "IJ", "interior"),
)


def row(name: str, ratios: np.ndarray) -> str:
    """Return a row: tests, median of test over calculated, standard deviation of its logarithm."""
    spread = np.std(np.log(ratios), ddof=1)
    return (
        f"| {name} | {ratios.size} | {np.median(ratios):.2f} | {spread:.2f} | "
        f"{ratios.min():.2f} to {ratios.max():.2f} |"
    )


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", 1)[0])
    parser.add_argument("folder", nargs="?", default=os.environ.get("RBSDEM_FRAMES_DIR", "."))
    parser.add_argument("--programmes", action="store_true", help="a row for each programme")
    options = parser.parse_args()
    with (Path(options.folder) / "joints.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    labels = [(name, at) for count, name, at in PROGRAMMES for _ in range(count)]
    ratios = np.array([
        1e6 * float(test["joint_shear_strength_MPa"]) / panel_strength(
            1e6 * float(test["fc_MPa"]), at.split(",")[0], transverse_beams="," in at
        )
        for test, (_, at) in zip(rows, labels, strict=True)
    ])  # fmt: skip
    print("| class | tests | median | sd of ln | from, to |")
    print("| --- | --- | --- | --- | --- |")
    names = np.array([at for _, at in labels])
    for at in dict.fromkeys(names):
        print(row(at, ratios[names == at]))
    print(row("all", ratios))
    if options.programmes:
        names = np.array([name for name, _ in labels])
        for name in dict.fromkeys(names):
            if (names == name).sum() > 1:
                print(row(name, ratios[names == name]))


if __name__ == "__main__":
    main()
