"""What an analysis returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rbsdem._core import Array

#: Names of the energies in the order of a row.
ENERGIES = ("input", "kinetic", "spring", "damping", "axial", "residual")


@dataclass(frozen=True)
class Result:
    """Rows of an analysis; arrays of `steps` rows and, per joint, n columns.

    Attributes
    ----------
    time : ndarray, shape (steps,)
        Time [s]; the number of the row in a static analysis.
    displacement : ndarray, shape (steps,)
        Displacement of the top relative to the ground [m].
    force : ndarray, shape (steps,)
        Lateral force at the top [N].
    slip, rotation : ndarray, shape (steps, n)
        Slip [m] and relative rotation [rad] of the joints, from the ground up.
    shear, moment : ndarray, shape (steps, n)
        Forces [N] and moments [N m] of their springs.
    energy : dict of ndarray, shape (steps,)
        Energies [J]: "input" (work of lateral force and ground motion), "kinetic", "spring"
        (stored and dissipated), "damping", "axial" (potential of axial load and weight), and
        "residual", what is left of input + energy at the begin - all others.
    summary : dict
        Figures of the run: steps, rows, events (lines of springs left), time_step and stable_step
        [s], peak_displacement [m], peak_force [N], displacement_at_peak_force [m], energies at the
        end [J], energy_residual [J] and relative_energy_residual (largest over the rows kept).
    """

    time: Array
    displacement: Array
    force: Array
    slip: Array
    rotation: Array
    shear: Array
    moment: Array
    energy: dict[str, Array]
    summary: dict[str, Any]


def result_from_rows(rows: Array, summary: dict[str, Any]) -> Result:
    """Return the result that rows (steps, 9 + 4 n) of the Fortran part hold; arrays are views."""
    joints = np.split(rows[:, 9:], 4, axis=1)
    energy = {name: rows[:, 3 + i] for i, name in enumerate(ENERGIES)}
    return Result(rows[:, 0], rows[:, 1], rows[:, 2], *joints, energy, summary)
