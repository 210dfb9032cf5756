"""A column with a storey on top under a ground motion: the same as case.nml, in Python."""

import sys
from pathlib import Path

import numpy as np

import rbsdem

(hinge,) = rbsdem.peer.paper_columns()["soesianawati_1"].joints("flexure")
elastic = rbsdem.springs.Elastic(3.0e8)
column = rbsdem.Column(
    height=1.6,
    mass=None,
    shear=rbsdem.springs.Elastic(2.1e9),
    flexure=[hinge, elastic, elastic],
    n=3,
    lengths=[0.35, 0.6, 0.65],
    masses=[134.4, 230.4, 76115.0],
    kinematics="pdelta",
    self_weight=True,
    damping=rbsdem.Damping(mass=0.3, stiffness=2e-6),
)
motion = Path(__file__).with_name("ground.csv")
time, acceleration = np.loadtxt(motion, delimiter=",", skiprows=2, unpack=True)

modes = rbsdem.modes(column)
result = rbsdem.time_history(column, time, ground_acceleration=9.80665 * acceleration, method="rk4")

print(f"first period           {1 / modes.frequency[0]:8.3f} s")
print(f"peak drift             {100 * np.abs(result.displacement).max() / column.height:8.2f} %")
print(f"peak base moment       {np.abs(result.moment[:, 0]).max() / 1e3:8.1f} kN m")
print(f"steps of RK4           {result.summary['steps']:8d}")
print(f"energy residual        {result.summary['relative_energy_residual']:8.0e}")

if "--no-plot" not in sys.argv:
    from rbsdem import plot

    upper, lower = plot.new_axes(2, 1, (5.2, 5.0))
    plot.history(result, ax=upper)
    plot.loop(result.rotation[:, 0], result.moment[:, 0], ax=lower)
    # The loop is that of the hinge: rotations in mrad, moments in kN m.
    lower.set(xlabel="Rotation of the hinge (mrad)", ylabel="Base moment (kN m)")
    plot.save(upper, "ground_motion.png")
    print("wrote ground_motion.png")
