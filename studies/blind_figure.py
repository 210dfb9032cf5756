"""Draw docs/blind_columns.png: the four columns of the paper, predicted from their drawings.

python studies/blind_figure.py FOLDER
"""

from __future__ import annotations

import argparse
from pathlib import Path

import rbsdem
from rbsdem import peer

DOCS = Path(__file__).resolve().parents[1] / "docs"


def main() -> None:
    """Predict and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    given = parser.parse_args()

    tests = peer.read_specimens(given.folder).with_history()
    panels = []
    for names in peer.HISTORY_FILES.values():
        specimen = next(row for row in tests if row.path and row.path.name in names)
        test = specimen.test()
        result = rbsdem.cyclic(peer.column(specimen), displacement=test.displacement)
        score = rbsdem.compare(result, test).nrmse
        author, number = specimen.name.rsplit(", ", 1)
        title = f"{author}\n{number}\nnrmse {score:.3f}"
        panels.append(rbsdem.plot.Panel(title, result, test, specimen.length))
    figure = rbsdem.plot.four_panels(panels)
    figure.savefig(DOCS / "blind_columns.png", dpi=110)


if __name__ == "__main__":
    main()
