"""Springs from the drawing of a section."""

import sys

import numpy as np

import rbsdem
from rbsdem import CircularSection, Concrete, Layout, RectangularSection, Spiral, Steel, Ties

# 400 x 400 mm, 12 bars of 16 mm, four-legged ties of 7 mm at 85 mm (Soesianawati No 1).
section = RectangularSection(
    0.4,
    0.4,
    Concrete(46.5e6),
    layout=Layout(12, 0.016, Steel(446e6, 702e6)),
    ties=Ties(0.007, 0.085, Steel(364e6, 521e6), legs=4),
    cover=0.013,
)
length, axial_load = 1.6, 744e3

springs = rbsdem.section.springs(section, length, axial_load)
print(springs.report)
assert springs.shear is not None  # it is None with shear="none" alone

column = rbsdem.Column(
    length,
    mass=614.4,
    shear=springs.shear,
    flexure=springs.flexure,
    axial_load=axial_load,
    kinematics="pdelta",
)
loop = rbsdem.cyclic(column, displacement=length * rbsdem.protocol([0.005, 0.01, 0.02], cycles=2))
print(f"\npeak force of the column {loop.summary['peak_force'] / 1e3:.0f} kN")

confined = rbsdem.section.diagram(section, axial_load, ultimate="mander")
core, ultimate = section.confinement, confined.events.ultimate
assert core is not None  # it has ties
assert ultimate is not None  # they fracture
print(f"core {core.fcc / 1e6:.1f} MPa, hoop fracture at a strain of {core.eps_cu:.4f}")
print(f"ultimate curvature {1e3 * ultimate.curvature:.0f} mrad/m, confined")
lines = confined.idealise("caltrans")
print(lines, lines.capacity(length), sep="\n")

# Bars one by one, and a circle: a pier of 900 mm with a spiral.
pier = CircularSection(
    0.9,
    Concrete(35e6),
    bars=[(0.39 * np.cos(a), 804e-6, Steel(500e6, 650e6)) for a in np.arange(16) * np.pi / 8],
    spiral=Spiral(0.014, 0.08, Steel(480e6)),
    cover=0.03,
)
curvature = np.linspace(0.0, 0.05, 6)
moment = rbsdem.section.moment_curvature(pier, 2.5e6, curvature, confined=True)
print("pier, kN m at 0, 10, ... 50 mrad/m:", *(f"{value / 1e3:.0f}" for value in moment))

if "--no-plot" not in sys.argv:
    rbsdem.plot.save(rbsdem.plot.section(section), "section.png")
    rbsdem.plot.save(rbsdem.plot.section_springs(springs), "springs.png")
    rbsdem.plot.save(rbsdem.plot.moment_curvature(confined, idealise="caltrans"), "confined.png")
    print("wrote section.png, springs.png, confined.png")
