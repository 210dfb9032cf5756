"""Print the springs of table 3 of the paper beside those computed from table 2.

    python studies/section_table.py [--sensitivity]

The reference values are those of an independent program with the same laws. With --sensitivity:
what other choices would give.
"""

from __future__ import annotations

import sys
import warnings
from typing import Any

import numpy as np

import rbsdem
from rbsdem.errors import AccuracyWarning
from rbsdem.section.paper import PaperSection, SectionSprings, paper_columns, paper_sections

# K_c, D_c, K_y, D_y, K_u, B_1 of the flexural spring; K_y, D_y, K_u of the shear spring.
REFERENCE = {
    "soesianawati_1": "2.5108e8 3.0723e-4 7.2997e7 2.7202e-3 7.3730e6 2.6373e-1 "
    "7.0806e8 1.2895e-4 1.8737e7",
    "tanaka_park_1": "1.6605e8 4.4627e-4 4.3916e7 4.4219e-3 4.0341e6 3.3141e-1 "
    "5.6768e8 1.5171e-4 4.0512e7",
    "tanaka_park_5": "6.0637e8 2.4026e-4 1.4567e8 2.9170e-3 1.4838e7 2.3938e-1 "
    "1.1286e9 1.4929e-4 4.7981e7",
    "zahn_7": "2.1163e8 4.3067e-4 6.7329e7 3.0846e-3 9.1183e6 3.7334e-1 "
    "5.8831e8 1.7618e-4 3.5179e7",
}

ROWS = (
    "flexure K_c",
    "flexure D_c",
    "flexure K_y",
    "flexure D_y",
    "flexure K_u",
    "flexure B_1",
    "shear K_y",
    "shear D_y",
    "shear K_u",
)


def numbers(springs: Any) -> list[float]:
    """Return the numbers of both springs in the order of `ROWS`."""
    f, v = springs.flexure, springs.shear
    return [f.k_c, f.d_c, f.k_y, f.d_y, f.k_u, f.b1, v.k, v.d_y, v.k_post]


def of_paper(paper: PaperSection, **options: Any) -> SectionSprings:
    """Return the springs of a column of table 2, of its own length and axial load."""
    return rbsdem.section.springs(paper.section, paper.length, paper.axial_load, **options)


def table() -> None:
    """Print every number of every column."""
    printed = paper_columns()
    print("| parameter | column | table 3 | computed | over table 3 | over the reference |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    found = {key: numbers(of_paper(paper)) for key, paper in paper_sections().items()}
    for i, row in enumerate(ROWS):
        for key, paper in paper_sections().items():
            value = found[key][i]
            was = numbers(printed[key])[i]
            other = float(REFERENCE[key].split()[i])
            print(
                f"| {row} | {paper.specimen} | {was:.4e} | {value:.4e} | {value / was:.3f} | "
                f"{value / other:.4f} |"
            )


def sensitivity() -> None:
    """Print the range over the four columns of ratios to table 3 for other choices."""
    printed = paper_columns()
    choices: dict[str, dict[str, Any]] = {
        "A": {},
        "A, moments times 0.95": {"moment_factor": 0.95},
        "B": {"yield_rule": "B"},
        "B, moments times 0.95": {"yield_rule": "B", "moment_factor": 0.95},
        "A, confined core": {"confined": True},
        "A, confined, ultimate mander": {"confined": True, "ultimate": "mander"},
        "A, ultimate drop": {"ultimate": "drop"},
    }
    print("| choice | D_y | M_y | K_y | K_u |")
    print("| --- | --- | --- | --- | --- |")
    for name, options in choices.items():
        ratios = []
        for key, paper in paper_sections().items():
            springs = [
                of_paper(paper, shear="none", **options).flexure,
                printed[key].flexure,
            ]
            m_y = [s.k_c * s.d_c + s.k_y * (s.d_y - s.d_c) for s in springs]
            f, t = springs
            ratios.append((f.d_y / t.d_y, m_y[0] / m_y[1], f.k_y / t.k_y, f.k_u / t.k_u))
        spread = np.array(ratios).T
        cells = [f"{row.min():.2f}-{row.max():.2f}" for row in spread[:3]]
        cells.append(" ".join(f"{value:.2f}" for value in spread[3]))
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    with warnings.catch_warnings():
        # A spring whose moment falls after yield gets K_u = 0, which the table shows.
        warnings.simplefilter("ignore", AccuracyWarning)
        sensitivity() if "--sensitivity" in sys.argv else table()
