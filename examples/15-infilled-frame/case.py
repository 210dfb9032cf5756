"""A frame of 1970 with masonry in all storeys but the lowest: pushed, shaken, to its collapse.

python examples/15-infilled-frame/case.py [--no-plot]
"""

import sys

import numpy as np

import rbsdem
from rbsdem import Bars, Concrete, Layout, RectangularSection, Steel, Ties, plot
from rbsdem.frames import Frame, Infill, infills

steel, concrete = Steel(fy=420e6), Concrete(20e6)
hoops = Ties(0.008, 0.125, steel)
column = RectangularSection(
    0.35, 0.35, concrete, layout=Layout(8, 0.016, steel), ties=hoops, cover=0.025
)
beam = RectangularSection(
    0.3, 0.5, concrete, top=Bars(4, 0.016), bottom=Bars(3, 0.016), steel=steel, ties=hoops,
    cover=0.025,
)  # fmt: skip
brick, window = Infill(0.2, fm=2.5e6), Infill(0.2, fm=2.5e6, opening=(1.4, 1.3))
# Shops below: the ground storey is open.
panels = {
    "bare": None,
    "open ground storey": {(0, 0): brick, (2, 0): window, (0, 1): None},
    "infilled": {(0, 0): brick, (2, 0): window},
}
frames = {
    name: Frame.grid(
        [3.2] * 3, [4.8] * 3, columns=column, beams=beam, infills=cells,
        dead_load=25e3, live_load=8e3, self_weight=True, mass="from_loads",
        kinematics="pdelta", damping=0.05,
    )
    for name, cells in panels.items()
}  # fmt: skip

# Pushed to a roof drift of 3 %. A storey that drifts by 10 % has collapsed.
pushes = {name: rbsdem.pushover(frame, drift=0.03) for name, frame in frames.items()}
print("                     period (s)   largest force (kN)   storey drifts at 1 % (%)")
for name, push in pushes.items():
    row = int(np.searchsorted(push.drift, 0.01))
    drifts = "  ".join(f"{100 * drift:.2f}" for drift in push.storey_drift[row])
    period = rbsdem.modes(frames[name], 1).period[0]
    print(f"{name:20s}{period:11.2f}{push.base_shear.max() / 1e3:21.0f}{'':6s}{drifts:>20s}")

# What the panels of the infilled frame do, and a check of the columns beside them.
print(f"\n{infills(pushes['infilled']).round(2).to_string(index=False)}")
print(pushes["infilled"].scope_note)

# One record, until the storeys with masonry stand on columns that do not.
motion = rbsdem.motions.synthetic(3)[2]
print("\nfactor of the record   largest storey drifts (%), roof last")
for factor in (1.0, 3.0, 5.0, 8.0):
    for name in ("open ground storey", "infilled"):
        quake = rbsdem.time_history(
            frames[name], ground_acceleration=motion.scaled(factor), method="newmark", dt=0.01,
            collapse_drift=0.1,
        )  # fmt: skip
        drifts = "  ".join(
            f"{100 * drift:5.2f}" for drift in np.abs(quake.storey_drift).max(axis=0)
        )
        print(f"{factor:4.1f}  {name:20s}{drifts}  {quake.summary['status']}")
        if name == "open ground storey" and quake.summary["status"] == "collapsed":
            collapse = quake
    if quake.summary["status"] == "collapsed":
        break

if "--no-plot" not in sys.argv:
    figures = {
        "model": plot.frame(frames["open ground storey"]),
        "pushover": plot.pushover(pushes["infilled"]),
        "infilled": plot.frame(pushes["infilled"]),
        "open": plot.frame(pushes["open ground storey"]),
        "drifts": plot.storey_drift(collapse),
    }
    for name, axes in figures.items():
        for path in plot.save(axes, f"{name}.png"):
            print(f"wrote {path}")
