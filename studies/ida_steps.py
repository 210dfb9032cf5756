"""What method and step cost and how far they move the collapse intensity.

    python studies/ida_steps.py [RECORDS [COLUMN ...]]

Three columns are hunted to their collapse under synthetic records at steps of 0.01 s, with each
method and step: a softening hinge under a heavy storey (capped, peak-oriented), column 1 of the
paper under a storey (Takeda), and a column predicted from its drawing (layered). The reference is
"rk45" with a tolerance of 1e-8, for the predicted column "newmark" at 0.00025 s. Printed are, for
each setting, its processor time over that of the reference, the change of the median collapse
intensity, and the median and the largest change over the records, in %. Brackets are narrowed to
0.05 %, so that they do not hide the changes.
"""

from __future__ import annotations

import sys
import time
import warnings
from dataclasses import replace

import numpy as np

import rbsdem
from rbsdem import fragility, motions
from rbsdem.springs import Elastic, PeakOriented

HUNT = fragility.CollapseSearch(resolution=5e-4, points=1)
SETTINGS = [
    ("newmark", 0.01),
    ("newmark", 0.005),
    ("newmark", 0.0025),
    ("newmark", 0.001),
    ("hht", 0.01),
    ("hht", 0.0025),
    ("newmark", None),
    ("rk4", None),
    ("auto", None),
]


def softening() -> rbsdem.Column:
    """Return the column of example 08."""
    hinge = PeakOriented(d_y=0.004, f_y=2e5, d_cap=0.03, f_cap=2.4e5, d_pc=0.06)
    return rbsdem.Column(
        3.0,
        1e3,
        Elastic(5e8),
        hinge,
        top_mass=5e4,
        axial_load=4.9e5,
        kinematics="pdelta",
        damping=0.05,
    )


def paper() -> rbsdem.Column:
    """Return column 1 of the paper under the mass that its axial load is the weight of."""
    column = rbsdem.peer.paper_columns()["soesianawati_1"]
    return replace(column, top_mass=75e3, kinematics="pdelta", damping=0.05)


def predicted() -> rbsdem.Column:
    """Return a column from its drawing, under the mass that its axial load is the weight of."""
    section = rbsdem.RectangularSection(
        0.4,
        0.4,
        rbsdem.Concrete(46.5e6),
        layout=rbsdem.Layout(12, 0.016, rbsdem.Steel(446e6, 702e6)),
        ties=rbsdem.Ties(0.007, 0.085, rbsdem.Steel(364e6), legs=4),
        cover=0.013,
    )
    return replace(
        rbsdem.section.column(section, 1.6, axial_load=744e3), top_mass=75e3, damping=0.05
    )


def collapses(column: rbsdem.Column, records, **settings) -> tuple[np.ndarray, float]:
    """Return the collapse intensities of the records, and the time of the processors."""
    start = time.process_time()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", rbsdem.errors.AccuracyWarning)
        found = rbsdem.ida(column, records, levels=HUNT, measures=("peak_drift",), **settings)
    return found.collapse_intensity[0], time.process_time() - start


EXPLICIT = {"method": "rk45", "dt": None, "tolerance": 1e-8}
COLUMNS = {
    "softening": (softening, EXPLICIT),
    "paper": (paper, EXPLICIT),
    "predicted": (predicted, {"method": "newmark", "dt": 0.00025}),
}


def main(number: int, names: list[str]) -> None:
    """Print a table for each column."""
    records = motions.synthetic(number)
    for name in names:
        make, reference = COLUMNS[name]
        column = make()
        period = 1 / rbsdem.modes(column).frequency[0]
        exact, longest = collapses(column, records, **reference)
        print(f"\n{name}: first period {period:.3f} s, {number} records at 0.01 s")
        print(
            f"reference {reference['method']}: median {np.median(exact):.4g} m/s2, {longest:.1f} s"
        )
        print("method     step (s)   time    median  each: median    largest")
        for method, dt in SETTINGS:
            if name == "predicted" and method in ("rk4", "auto"):
                continue
            found, seconds = collapses(column, records, method=method, dt=dt)
            size = np.abs(100 * (found / exact - 1))
            middle = 100 * (np.median(found) / np.median(exact) - 1)
            step = "own" if dt is None else f"{dt:g}"
            print(
                f"{method:10s} {step:8s} {seconds / longest:6.3f} {middle:+7.2f} % "
                f"{np.median(size):8.2f} % {size.max():8.2f} %",
                flush=True,
            )


if __name__ == "__main__":
    words = sys.argv[1:]
    main(int(words[0]) if words else 20, words[1:] or list(COLUMNS))
