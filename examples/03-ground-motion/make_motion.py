"""Write ground.csv: a synthetic ground motion, a modulated sweep from 0.5 to 4 Hz, peak 0.2 g."""

from pathlib import Path

import numpy as np

time = np.arange(0.0, 12.0 + 1e-9, 0.02)
phase = 2 * np.pi * (0.5 * time + (4.0 - 0.5) / (2 * time[-1]) * time**2)
envelope = (time / 4.0) ** 2 * np.exp(2 * (1 - time / 4.0))
motion = envelope * np.sin(phase)
motion *= 0.2 / np.abs(motion).max()
np.savetxt(
    Path(__file__).with_name("ground.csv"),
    np.column_stack([time, motion]),
    fmt=["%.2f", "%.6f"],
    delimiter=",",
    header="# synthetic motion, made by make_motion.py\ntime_s,acceleration_g",
    comments="",
)
