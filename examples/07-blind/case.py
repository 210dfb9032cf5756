"""A column predicted from its drawing, with the layered model, over the turning points of its test.

    python examples/07-blind/case.py [--no-plot]

The full history is taken from the folder that RBSDEM_PEER_DIR names; without it, the reversal
points that come with rbsdem drive the column and represent the test.
"""

import sys

import numpy as np

import rbsdem
from rbsdem import peer

KEY = "tanaka_park_5"

# What the drawing shows, in SI units.
specimen = peer.Specimen(
    name="Tanaka and Park 1990, No. 5",
    section="rectangular",
    length=1.65,
    width=0.55,
    depth=0.55,
    cover=0.040,
    concrete_strength=32e6,
    axial_load=968e3,
    longitudinal_number=12,
    corner_diameter=0.020,
    intermediate_diameter=0.020,
    intermediate_perpendicular=2,
    intermediate_parallel=2,
    corner_yield_stress=511e6,
    longitudinal_ultimate_stress=675e6,
    transverse_diameter=0.012,
    transverse_spacing=0.110,
    transverse_yield_stress=325e6,
    shear_legs=4,
)
column = peer.column(specimen)
foot = column.joints("flexure")[0]
assert isinstance(foot, rbsdem.springs.Layered)
print(f"{len(foot.layers)} layers of concrete and steel at the foot\n")

history = peer.find_history(KEY)
test = peer.read_peer(history) if history else peer.shipped_reversals(KEY)
result = rbsdem.cyclic(column, displacement=test.displacement)
step = max(1, len(test.force) // 20)
rows = zip(test.displacement, test.force, result.force, strict=True)
for d, measured, computed in list(rows)[::step]:
    print(f"{1e3 * d:7.1f} mm   test {1e-3 * measured:7.1f} kN   model {1e-3 * computed:7.1f} kN")

# Effect of the number of bodies, and of one parameter of the model, on the largest force.
print()
for n in (2, 4, 8):
    again = rbsdem.cyclic(peer.column(specimen, n=n), displacement=test.displacement)
    print(f"{n} bodies: largest force {again.summary['peak_force'] * 1e-3:.1f} kN")
weaker = rbsdem.cyclic(column.with_parameters(steel_strength=1.0), displacement=test.displacement)
print(f"bars as strong as measured: {weaker.summary['peak_force'] * 1e-3:.1f} kN")

if "--no-plot" not in sys.argv:
    # Points between the turning points, so that the loop is drawn smoothly.
    path = np.interp(
        np.linspace(0, 1, 4000), np.linspace(0, 1, len(result.force)), test.displacement
    )
    ax = rbsdem.plot.loops_over_test(
        rbsdem.cyclic(column, displacement=path),
        test,
        title=specimen.name,
        height=specimen.length,
        test_points=history is None,
    )
    rbsdem.plot.save(ax, "blind.png")
    print("wrote blind.png")
