"""What an analysis returns."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, Any

import numpy as np

from rbsdem import _core
from rbsdem._core import Array
from rbsdem.column import Column

if TYPE_CHECKING:
    from rbsdem.case import Case

#: Names of the energies.
ENERGIES = ("input", "kinetic", "spring", "damping", "axial", "residual")


@dataclass(frozen=True, repr=False, eq=False)
class Result:
    """Rows of an analysis: arrays with a row for each kept step and a column for each joint.

    Attributes
    ----------
    time : ndarray, shape (steps,)
        Time [s]; in a static analysis the number of the point.
    displacement : ndarray, shape (steps,)
        Displacement of the top relative to the ground [m].
    force : ndarray, shape (steps,)
        Lateral force at the top [N].
    slip, rotation : ndarray, shape (steps, n)
        Slip [m] and relative rotation [rad] of the joints, from the ground up.
    shear, moment : ndarray, shape (steps, n)
        Forces [N] and moments [N m] of their springs.
    base_shear, base_moment : ndarray, shape (steps,)
        What holds the column at the ground: horizontal force [N], and moment about the lowest joint
        [N m]. Those of the springs of that joint and, in time, of the damping, which may also act
        between the bodies and the ground (``docs/theory.md``). In a static analysis the shear is
        `force`.
    energy : dict of ndarray, shape (steps,)
        Energies [J]: "input" (work of lateral force and ground motion), "kinetic", "spring"
        (stored and dissipated), "damping", "axial" (potential of axial load and weight), and
        "residual", which is input + energy at the start minus the other energies.
    summary : dict
        What was done: "analysis" ("static" or "dynamic"), "driven" (static), "kinematics", the
        "method" that was used and, if the program chose it, the "reason"; "status": "completed",
        "collapsed" (`collapse_drift` was reached) or "failed" (the result of a `SolveError`).
        Values: steps, rows, events (how often a spring left its line), time_step and stable_step
        [s], peak_displacement [m], peak_force [N], displacement_at_peak_force [m], peak_base_shear
        [N] (in time of the kept rows), energies at the end [J], energy_residual [J] and
        relative_energy_residual (largest of the kept rows),
        peak_rotation (largest absolute rotation of a body in the kept rows [rad]), cut_steps
        (steps cut at an event, for accuracy, or because they did not converge).
    opening : ndarray, shape (steps, n)
        Opening of the joints [m]; zero if they do not open.
    axial_force : ndarray, shape (steps, n), or None
        Forces of the axial springs, tension positive [N]; None if joints do not open.
    top : ndarray, shape (steps, 2)
        Position (x, y) of the top relative to the ground [m].
    column : Column
        The column.
    case : Case or None
        The case that was run; None if the analysis was called for the column.
    """

    time: Array
    displacement: Array
    force: Array
    slip: Array
    rotation: Array
    shear: Array
    moment: Array
    base_shear: Array
    base_moment: Array
    energy: dict[str, Array]
    summary: dict[str, Any]
    opening: Array
    axial_force: Array | None
    top: Array
    column: Column
    case: Case | None = None

    @property
    def dynamic(self) -> bool:
        """Whether it is a response in time."""
        return bool(self.summary["analysis"] == "dynamic")

    def __repr__(self) -> str:
        about = self.summary
        return (
            f"Result({about['method']}, {self.time.size} rows, {about['status']}, "
            f"peak displacement {about['peak_displacement']:.4g} m, "
            f"peak force {about['peak_force']:.4g} N)"
        )

    def __eq__(self, other: object) -> bool:
        """Return whether another result has the same column, rows and summary, bit for bit."""
        if not isinstance(other, Result):
            return NotImplemented
        return all(
            _same(getattr(self, field.name), getattr(other, field.name)) for field in fields(self)
        )

    __hash__ = None  # type: ignore[assignment]


def _same(one: Any, other: Any) -> bool:
    """Return whether two values are equal; arrays by all elements, with NaN equal to NaN."""
    if isinstance(one, np.ndarray) or isinstance(other, np.ndarray):
        return np.array_equal(one, other, equal_nan=True)
    if isinstance(one, dict) and isinstance(other, dict):
        return one.keys() == other.keys() and all(_same(one[key], other[key]) for key in one)
    if isinstance(one, float) and isinstance(other, float):
        return one == other or (math.isnan(one) and math.isnan(other))
    return bool(one == other)


def result_from_rows(rows: Array, column: Column, summary: dict[str, Any]) -> Result:
    """Return the result whose arrays are views of rows of the Fortran part."""
    values: dict[str, Array] = {}
    at = 0
    with_base = column.damped and summary["analysis"] == "dynamic"
    for name in _core.quantities(column.opens, with_base)[0]:
        if name.endswith("*"):
            values[name[:-1]] = rows[:, at : at + column.n]
            at += column.n
        else:
            values[name] = rows[:, at]
            at += 1
    return Result(
        time=values["time"],
        displacement=values["displacement"],
        force=values["force"],
        slip=values["slip"],
        rotation=values["rotation"],
        shear=values["shear"],
        moment=values["moment"],
        base_shear=values.get("base_shear", values["shear"][:, 0]),
        base_moment=values.get("base_moment", values["moment"][:, 0]),
        energy={name: values[name] for name in ENERGIES},
        summary=summary,
        opening=values.get("opening", np.zeros(values["slip"].shape)),
        axial_force=values.get("axial_force"),
        top=np.column_stack((values["displacement"], values["top_height"])),
        column=column,
    )
