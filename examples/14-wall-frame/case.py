"""A building of six storeys with a wall, from its drawings to the target of a code.

python examples/14-wall-frame/case.py [--no-plot]
"""

import sys

import rbsdem
from rbsdem import Bars, Boundary, Concrete, Curtain, Hoops, Layout, Steel, Ties, plot
from rbsdem.codes import DesignSpectrum, target

concrete, steel = Concrete(30e6), Steel(500e6, 600e6)
column = rbsdem.RectangularSection(
    0.5, 0.5, concrete, layout=Layout(12, 0.020, steel), ties=Ties(0.010, 0.1, steel, legs=4),
    cover=0.03,
)  # fmt: skip
beam = rbsdem.RectangularSection(
    0.3, 0.55, concrete, top=Bars(4, 0.020), bottom=Bars(3, 0.020), steel=steel,
    ties=Ties(0.008, 0.15, steel), cover=0.03,
)  # fmt: skip
wall = rbsdem.WallSection(
    4.0, 0.25, concrete,
    boundary=Boundary(0.5, Bars(8, 0.020, steel), Hoops(0.010, 0.1, steel, 2, 4)),
    vertical=Curtain(0.010, 0.2, steel), horizontal=Curtain(0.010, 0.2, steel),
)  # fmt: skip
house = rbsdem.Frame.grid(
    [3.0] * 6, [6.0] * 3, columns=column, beams=beam, walls={2: wall}, dead_load=25e3,
    live_load=10e3, self_weight=True, mass="from_loads", kinematics="pdelta",
)  # fmt: skip
print(f"first period {rbsdem.modes(house, 1).period[0]:.2f} s")

push = rbsdem.pushover(house, drift=0.02)
demand = target(push, DesignSpectrum.en_1998(0.25, "C"), "en_1998")
print(f"largest base shear {push.base_shear.max() / 1e3:.0f} kN; {demand}")

if "--no-plot" not in sys.argv:
    figures = {
        "wall": plot.section(wall),
        "hinges": plot.frame(push),
        "pushover": plot.pushover(push),
    }
    for name, axes in figures.items():
        for path in plot.save(axes, f"wall_frame_{name}.png"):
            print(f"wrote {path}")
