"""A column from its drawing on the engineer's desk: limit states, hinge, codes beside the loop.

python examples/10-desk/case.py [--no-plot]
"""

import sys

import numpy as np

import rbsdem
from rbsdem import Concrete, Layout, RectangularSection, Steel, Ties, codes, plot

HEIGHT, LOAD = 1.8, 900e3

section = RectangularSection(
    0.45,
    0.45,
    Concrete(35e6),
    layout=Layout(12, 0.020, Steel(460e6, 600e6)),
    ties=Ties(0.010, 0.100, Steel(420e6), legs=4),
    cover=0.030,
)
column = rbsdem.section.column(section, HEIGHT, axial_load=LOAD)
drifts = rbsdem.protocol([0.0025, 0.005, 0.01, 0.02, 0.03, 0.045, 0.06, 0.075], cycles=2)
result = rbsdem.cyclic(column, displacement=HEIGHT * drifts, openings=True)

# Where the loop first reaches what engineers name.
states = result.limit_states()
for state in states:
    print(f"{state.name:15s} {100 * state.drift:6.2f} %   {state.source}")

# The hinge: what is plastic of its rotation, and the curvature over its length.
hinge = result.hinge()
print(f"\nplastic rotation {np.abs(hinge.plastic_rotation).max():.4f} rad, ", end="")
print(f"curvature {np.abs(hinge.curvature).max():.3f} 1/m, ductility {hinge.ductility:.1f}")

# The same column by codes and regressions.
beside = codes.compare(codes.code_values(section, HEIGHT, LOAD), result)
print("\ndrift at a loss of 20 %")
for source, drift in beside.to_pandas().loc["strength_loss"].drop("unit").dropna().items():
    print(f"{source:9s} {100 * drift:5.2f} %")

# What the section carries, and what the code asks for.
strength = rbsdem.section.interaction(section, "aci318")
demand = abs(result.base_moment).max()
print(
    f"\nlargest moment {1e-3 * demand:.0f} kNm, nominal {1e-3 * strength.moment_at(LOAD):.0f} kNm"
)

if "--no-plot" not in sys.argv:
    row = int(np.argmax(result.displacement))
    figures = {
        "states": plot.limit_states(states),
        "section_state": plot.section_state(result, float(result.time[row])),
        "codes": plot.code_comparison(beside),
        "interaction": plot.interaction(strength, demand=[(LOAD, demand)]),
        "envelope": plot.envelope(result.envelope(), method="asce_41"),
    }
    for name, figure in figures.items():
        for path in plot.save(figure, f"{name}.png"):
            print(f"wrote {path}")
