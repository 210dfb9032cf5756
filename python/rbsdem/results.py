"""What an analysis returns."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.column import Column

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
        What was done: "analysis" ("static" or "dynamic"), "driven" (static), "kinematics",
        "method" that was used and, if the program chose it, the "reason"; "status": "completed",
        "collapsed" (`collapse_drift` was reached) or "failed" (the result of a `SolveError`).
        Figures of the run: steps, rows, events (lines of springs left), time_step and stable_step
        [s], peak_displacement [m], peak_force [N], displacement_at_peak_force [m], energies at the
        end [J], energy_residual [J] and relative_energy_residual (largest over the rows kept),
        peak_rotation (largest absolute rotation of a body over the rows kept [rad]), cut_steps
        (cut at an event, for accuracy, or because they did not converge).
    opening : ndarray, shape (steps, n)
        Opening of the joints [m]; zero where they do not open.
    axial_force : ndarray, shape (steps, n), or None
        Forces of the axial springs, tension positive [N]; None where joints do not open.
    top : ndarray, shape (steps, 2)
        Position (x, y) of the top relative to the ground [m].
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
    opening: Array
    axial_force: Array | None
    top: Array


def result_from_rows(rows: Array, column: Column, summary: dict[str, Any]) -> Result:
    """Return the result that rows of the Fortran part (`rbs_output_row`) hold, as views."""
    first, n = _core.ROW_JOINTS, column.n
    joints = [rows[:, first + i * n : first + (i + 1) * n] for i in range(2 * column.unknowns // n)]
    if column.axial is None:
        slip, rotation, shear, moment = joints
        opening, axial_force = np.zeros(slip.shape), None
    else:
        slip, rotation, opening, shear, moment, axial_force = joints
    energy = {name: rows[:, 3 + i] for i, name in enumerate(ENERGIES)}
    # Displacement and height of the top are the values 1 and 9 of a row.
    top = rows[:, 1:10:8]
    return Result(
        rows[:, 0],
        rows[:, 1],
        rows[:, 2],
        slip,
        rotation,
        shear,
        moment,
        energy,
        summary,
        opening,
        axial_force,
        top,
    )
