"""Two storeys with a wall in one corner: torsion, a push in any direction, a record in two.

python examples/16-building-in-plan/case.py [--no-plot]
"""

import sys

import numpy as np

import rbsdem
from rbsdem import (
    Bars,
    Building,
    Concrete,
    Curtain,
    Layout,
    RectangularSection,
    Steel,
    Ties,
    WallSection,
    codes,
    plot,
)  # fmt: skip

steel, concrete = Steel(fy=420e6), Concrete(25e6)
hoops = Ties(0.008, 0.1, steel)
column = RectangularSection(
    0.4, 0.4, concrete, layout=Layout(8, 0.018, steel), ties=hoops, cover=0.025
)
beam = RectangularSection(
    0.3, 0.5, concrete, top=Bars(4, 0.016), bottom=Bars(3, 0.016), steel=steel, ties=hoops,
    cover=0.025,
)  # fmt: skip
mesh = Curtain(0.01, 0.2, steel)
wall = WallSection(2.0, 0.2, concrete=concrete, vertical=mesh, horizontal=mesh)
house = Building.grid(
    storeys=[3.2] * 2, bays_x=[5.6] * 2, bays_y=[5.0], columns=column, beams_x=beam, beams_y=beam,
    walls={("x", 1, 3): wall}, floor_load=7e3, live_load=2e3, edge_load=4e3, self_weight=True,
    mass="from_loads", eccentricity=(0.0, 0.05), kinematics="pdelta", damping=0.05,
)  # fmt: skip
print(rbsdem.modes(house, 3))

# Along x the line without the wall moves further: the floors turn.
push = rbsdem.pushover(house, drift=0.015, points=20)
print(f"largest base shear {push.base_shear.max() / 1e3:.0f} kN")
for name in ("x-1", "x-2"):
    print(f"{name}: storey drifts (%) {(100 * push.frame(name).storey_drift[-1]).round(2)}")
target = codes.target(push, codes.DesignSpectrum.en_1998(0.25, "C"), "en_1998")
print(target)
factors = ", ".join(f"{name} {factor:.2f}" for name, factor in target.torsion.items())
print(f"amplified for torsion: {factors}")
assessment = codes.assess(push, "en_1998_3", at=target, limits={"x-1:C-3-*": (0.004, 0.01, 0.015)})
print(assessment)

# One record along x and another along y.
ew, ns = (motion.scaled(2.0) for motion in rbsdem.motions.synthetic(2))
quake = rbsdem.time_history(house, (ew, ns), method="newmark", dt=0.01)
drifts = 100 * np.abs(quake.corner_drift).max(axis=0)
print(f"largest drifts of any corner (%): {drifts.round(2)}")

if "--no-plot" not in sys.argv:
    figures = {
        "plan": plot.plan(push),
        "building": plot.building(push),
        "line": plot.frame(push.frame("x-2")),
        "drifts": plot.storey_drift(quake.frame("y-1")),
    }
    for name, axes in figures.items():
        for path in plot.save(axes, f"{name}.png"):
            print(f"wrote {path}")
