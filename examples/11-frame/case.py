"""A frame of three storeys and three bays: dead load, modes, push-over, one record.

python examples/11-frame/case.py [--no-plot]
"""

import sys

import numpy as np

import rbsdem
from rbsdem import FrameMember, plot

column = FrameMember(
    30e9, area=0.16, inertia=2.1e-3, yield_moment=250e3, hardening=0.01, rigid_end=0.25
)
beam = FrameMember(
    30e9, area=0.15, inertia=2.0e-3, yield_moment=200e3, hardening=0.01, rigid_end=0.20
)
frame = rbsdem.Frame.grid(
    storeys=[3.2] * 3,
    bays=[6.0] * 3,
    columns=column,
    beams=beam,
    floor_mass=80e3,
    beam_load=25e3,
    kinematics="pdelta",
    damping=rbsdem.Damping.rayleigh(0.03, 1.5, 10.0),
)

# What stands before anything is pushed.
parts = frame.parts
print("axial forces of the first storey under dead load (kN):", end="")
for name, force in zip(parts.members, parts.compression, strict=True):
    if name.startswith("C") and name.endswith("-1"):
        print(f"  {name} {force / 1e3:.0f}", end="")
modes = rbsdem.modes(frame, 3)
print("\nperiods (s):", "  ".join(f"{period:.3f}" for period in modes.period))
print("shares of the mass:", "  ".join(f"{share:.2f}" for share in modes.participation))

# Pushed to a roof drift of 3 %: the hinges in their order.
push = rbsdem.pushover(frame, drift=0.03)
print(f"\nbase shear at the end {push.base_shear[-1] / 1e3:.0f} kN; hinges in their order:")
for event in push.events:
    where = f"{event.member} {event.end:5s} {event.name}"
    print(f"{where} at a roof drift of {100 * event.drift:.2f} %, {event.force / 1e3:.0f} kN")

# One record, half as strong again.
motion = rbsdem.motions.synthetic(1)[0].scaled(1.5)
quake = rbsdem.time_history(
    frame, ground_acceleration=motion, method="newmark", dt=0.005, motion=True
)
print("\nstorey   largest drift (%)   at the end (%)   largest acceleration (m/s2)")
largest = np.abs(quake.storey_drift).max(axis=0)
floors = np.abs(quake.floor_acceleration).max(axis=0)
for i, values in enumerate(zip(largest, quake.residual_drift, floors, strict=True), 1):
    print(f"{i:6d}{100 * values[0]:16.2f}{100 * values[1]:17.2f}{values[2]:20.1f}")
print(quake.scope_note)

if "--no-plot" not in sys.argv:
    figures = {
        "model": plot.frame(frame),
        "pushover": plot.pushover(push),
        "hinges": plot.frame(push),
        "moments": plot.member_forces(push),
        "drifts": plot.storey_drift(quake),
    }
    for name, axes in figures.items():
        for path in plot.save(axes, f"{name}.png"):
            print(f"wrote {path}")
