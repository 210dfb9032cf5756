"""A column as one hinge at its foot, for OpenSees and other programs.

    python examples/12-lumped-hinge/case.py [--no-plot]

Backbones of ASCE 41 and of Ibarra, Medina and Krawinkler go into hinge.csv, the text of a
cantilever with a fitted material into hinge.tcl. `lumped.py` beside this file does the work.
"""

import sys
from pathlib import Path

from lumped import draw, lumped_hinge

import rbsdem

HEIGHT = 2.5
steel = rbsdem.Steel(450e6)
section = rbsdem.RectangularSection(
    0.5,
    0.5,
    rbsdem.Concrete(35e6),
    layout=rbsdem.Layout(12, 0.02, steel),
    ties=rbsdem.Ties(0.01, 0.1, steel, legs=4),
    cover=0.03,
)
column = rbsdem.section.column(section, HEIGHT, axial_load=1.2e6)
path = HEIGHT * rbsdem.protocol([0.0025, 0.005, 0.01, 0.015, 0.02, 0.03, 0.04], cycles=2)
hinge = lumped_hinge(rbsdem.cyclic(column, displacement=path))
print(rbsdem.plot.table(hinge))
for material in ("Hysteretic", "IMKPeakOriented"):
    print(f"{material}: nrmse {hinge.nrmse(material):.3f}")
hinge.to_csv("hinge.csv")
Path("hinge.tcl").write_text(hinge.opensees("Hysteretic", "tcl"), encoding="utf-8")
print("wrote hinge.csv, hinge.tcl")

if "--no-plot" not in sys.argv:
    rbsdem.plot.save(draw(hinge), "hinge.png")
    print("wrote hinge.png")
