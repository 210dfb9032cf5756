"""Write data/reversals_<key>.csv and data/measured_loops.csv from the full histories.

    python scripts/extract_reversals.py FOLDER [--out data]

FOLDER holds the histories of the PEER Structural Performance Database, as csv or as the database's
own text files. A reversal point is a row at which the displacement turns back by more than 2 % of
its largest absolute value; the first and the last row of the history go with them. Numbers are
written with the digits of the file.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

import numpy as np

from rbsdem.curves.metrics import summarise, turning_points
from rbsdem.errors import RbsdemError
from rbsdem.measured.tests import HISTORY_FILES
from rbsdem.peer import find_history
from rbsdem.section.paper import paper_sections

THRESHOLD = 0.02

REPORTS = {
    "soesianawati_1": (
        "Soesianawati, M. T., Park, R., Priestley, M. J. N. (1986).",
        "Limited ductility design of reinforced concrete columns. Research Report 86-10,",
    ),
    "tanaka_park_1": (
        "Tanaka, H., Park, R. (1990).",
        "Effect of lateral confining reinforcement on the ductile behaviour of reinforced "
        "concrete columns. Research Report 90-2,",
    ),
    "zahn_7": (
        "Zahn, F. A., Park, R., Priestley, M. J. N. (1986).",
        "Design of reinforced concrete bridge columns for strength and ductility. "
        "Research Report 86-7,",
    ),
}
REPORTS["tanaka_park_5"] = REPORTS["tanaka_park_1"]
DEPARTMENT = "Department of Civil Engineering, University of Canterbury, New Zealand."
DATABASE = (
    "Berry, M., Parrish, M., Eberhard, M. (2004). PEER Structural Performance Database,",
    "Pacific Earthquake Engineering Research Center, University of California, Berkeley.",
)


def read_rows(path: Path) -> tuple[list[tuple[str, str]], np.ndarray]:
    """Return the pairs of a history as printed and as numbers; other lines are headers."""
    printed, numbers = [], []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
        parts = [part.strip() for part in line.replace("\t", ",").split(",")]
        # The second line of the database's text files is the number of pairs, never a pair.
        if path.suffix == ".txt" and number <= 2:
            continue
        try:
            pair = float(parts[0]), float(parts[1])
        except (ValueError, IndexError):
            continue
        printed.append((parts[0], parts[1]))
        numbers.append(pair)
    return printed, np.array(numbers)


def header(key: str, name: str, path: Path, rows: int) -> list[str]:
    """Return the source note of one file of reversal points."""
    author, title = REPORTS[key]
    return [
        f"# {name}: reversal points of the measured force-displacement history.",
        f"# First row, every row at which the displacement turns back by more than "
        f"{100 * THRESHOLD:g} % of its largest",
        f"# absolute value, last row; {rows} rows in the full history, which is not here "
        f"(data/README.md).",
        "# Units: mm (top of the equivalent cantilever) and kN (net horizontal force), digits as",
        f"# in the file ({HISTORY_FILES[key][1]} in the database).",
        f"# Test report: {author}",
        f"#   {title}",
        f"#   {DEPARTMENT}",
        f"# Database: {DATABASE[0]}",
        f"#   {DATABASE[1]}",
        "displacement_mm,force_kN",
    ]


def main() -> int:
    """Write the files; return the exit code."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path, help="folder of the full histories")
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(__file__).resolve().parent.parent / "data",
        help="where to write (default: the data folder of this checkout)",
    )
    arguments = parser.parse_args()
    sections = paper_sections()
    summary = [
        "# What the full measured histories of the four tests amount to, in the definitions of",
        "# rbsdem.curves: largest absolute force and the displacement at it, largest absolute",
        "# displacement, work of the force over the whole history, secant stiffness at 70 % of the",
        "# largest force. Written by scripts/extract_reversals.py; sources in data/README.md.",
        "key,rows,peak_force_kN,displacement_at_peak_mm,peak_displacement_mm,energy_kJ,"
        "stiffness_kN_per_mm",
    ]
    for key in HISTORY_FILES:
        path = find_history(key, arguments.folder)
        if path is None:
            print(f"{key}: no {' or '.join(HISTORY_FILES[key])} in {arguments.folder}")
            return 1
        printed, values = read_rows(path)
        d, f = values.T
        picked = [0, *turning_points(d, share=THRESHOLD), len(d) - 1]
        lines = header(key, sections[key].specimen, path, len(d))
        lines += [",".join(printed[i]) for i in picked]
        target = arguments.out / f"reversals_{key}.csv"
        target.write_text("\n".join(lines) + "\n", encoding="utf-8")
        loop = summarise(d, f)
        summary.append(
            f"{key},{len(d)},{loop.peak_force:.6g},{loop.displacement_at_peak:.6g},"
            f"{loop.peak_displacement:.6g},{loop.energy / 1000:.6g},{loop.stiffness:.6g}"
        )
        print(f"{target.name}: {len(picked)} of {len(d)} rows")
    (arguments.out / "measured_loops.csv").write_text("\n".join(summary) + "\n", encoding="utf-8")
    return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except (RbsdemError, OSError) as error:
        sys.exit(f"extract_reversals: {error}")
