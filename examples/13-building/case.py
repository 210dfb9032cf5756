"""A house of four storeys from its drawings to the acceptance of its members, and a report.

python examples/13-building/case.py [--no-plot]
"""

import sys

import rbsdem
from rbsdem import plot
from rbsdem.codes import DesignSpectrum, assess, target

house = rbsdem.examples.house()  # print(inspect.getsource(rbsdem.examples.house)) shows its drawing
period = rbsdem.modes(house, 1).period[0]
print(f"mass {house.parts.mass / 1e3:.0f} t, first period {period:.2f} s")

# Pushed to a roof drift of 2.5 %, and what an earthquake of the code asks of it.
push = rbsdem.pushover(house, drift=0.025)
demand = target(push, DesignSpectrum.en_1998(0.25, "C"), "en_1998")
print(f"largest base shear {push.base_shear.max() / 1e3:.0f} kN; {demand}")

# Every end of every member at the target displacement, by two codes.
for code in ("en_1998_3", "asce_41"):
    checked = assess(push, code, at=demand)
    print(checked)
    print(plot.table(checked.worst(3)))

# The estimate of the code beside the building under records that are scaled to its spectrum.
print(rbsdem.codes.check_target(demand, rbsdem.motions.synthetic(8)))

if "--no-plot" not in sys.argv:
    figures = {
        "drawing": plot.frame(house),
        "hinges": plot.frame(push),
        "pushover": plot.pushover(push),
        "target": plot.target(demand),
        "members": plot.assessment(checked),
    }
    for name, axes in figures.items():
        for path in plot.save(axes, f"building_{name}.png"):
            print(f"wrote {path}")
    print(f"wrote {rbsdem.report(checked, 'building.html', title='House', target=demand)}")
