"""Cases of the executable, read into Python by the same reader."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np

from rbsdem import _core
from rbsdem._core import UNSET, UNSET_INTEGER, Array
from rbsdem.analysis import cyclic, time_history
from rbsdem.column import Column
from rbsdem.damping import Damping
from rbsdem.results import Result
from rbsdem.springs import (
    Bilinear,
    Compression,
    ConcreteSpring,
    Elastic,
    Layered,
    PeakOriented,
    Pinching,
    Spring,
    SteelSpring,
    Takeda,
)

_SPRINGS = (
    *(Elastic, Bilinear, Takeda, Compression, PeakOriented, Pinching),
    *(ConcreteSpring, SteelSpring, Layered),
)
_DRIVES = ("displacement", "force", "ground_acceleration", "vertical_acceleration", "axial_load")
_SETTINGS = ("dt", "tolerance", "rho_infinity", "collapse_drift")


@dataclass(frozen=True)
class Case:
    """A case file: a column, its loading and its analysis.

    Attributes
    ----------
    title : str
        Title of the case.
    column : Column
        The column.
    method : str
        "static", or a method of `time_history`.
    time : ndarray, shape (m,)
        Times of all loadings [s]; the number of the point in a static analysis.
    displacement, force : ndarray, shape (m,), or None
        Displacement of the top [m] or lateral force [N].
    ground_acceleration, vertical_acceleration : ndarray, shape (m,), or None
        Acceleration of the ground to +x and upward [m/s2].
    axial_load : ndarray, shape (m,), or None
        Axial load besides that of the column [N].
    settings : dict
        The settings of the analysis that were given, as keywords of `cyclic` or `time_history`: dt,
        events, tolerance, rho_infinity, collapse_drift, allow_unstable, every.
    """

    title: str
    column: Column
    method: str
    time: Array
    displacement: Array | None
    force: Array | None
    ground_acceleration: Array | None
    vertical_acceleration: Array | None
    axial_load: Array | None
    settings: dict[str, Any]

    def run(self, column: Column | None = None, **changes: Any) -> Result:
        """Solve the case as the executable does.

        Parameters
        ----------
        column : Column, optional
            Another column in place of the case's.
        **changes
            Keywords of `cyclic` or `time_history` that replace or add to `settings`.

        Returns
        -------
        Result
            Of `cyclic` or `time_history`, with their exceptions.
        """
        column = self.column if column is None else column
        loads = {name: getattr(self, name) for name in _DRIVES if getattr(self, name) is not None}
        if self.method == "static":
            return cyclic(column, **loads, **(self.settings | changes))
        keywords = {"method": self.method} | self.settings | changes
        return time_history(column, self.time, **loads, **keywords)


def read_case(path: str | os.PathLike[str]) -> Case:
    """Read a case of the executable, its histories included.

    Loadings at different times come on common ones, by straight lines between their points.

    Parameters
    ----------
    path : str or path
        Path of the namelist file; paths of histories start from its folder.

    Raises
    ------
    InputError
        With a line for everything that is wrong, as `rbsdem check` finds it.
    """
    answer = _core.read_case(os.fspath(path))
    codes, numbers, kinematics, title, method, events, settings, every, time, values, acting = (
        answer
    )
    found: dict[str, Any] = {
        name: float(value)
        for name, value in zip(_SETTINGS, settings, strict=False)
        if value != UNSET
    }
    if events:
        found["events"] = events
    if settings[-1]:
        found["allow_unstable"] = True
    if every != UNSET_INTEGER:
        found["every"] = int(every)
    loads = (np.ascontiguousarray(values[:, i]) if acting[i] else None for i in range(len(_DRIVES)))
    return Case(title, _column(codes, numbers, kinematics), method, time, *loads, found)


def _column(codes: Array, numbers: Array, kinematics: str) -> Column:
    """Return the column that two arrays hold; the inverse of `Column._pack`."""
    n, weight, axial_follows, force_follows, tangent, *rest = codes.tolist()
    sizes, rules = rest[:7], iter(rest[7:])
    values = iter(numbers.tolist())
    height, mass, load, gravity, top_mass, top_inertia, depth, *damping = islice(values, 9)
    lengths, masses, rotary_inertia, modal = (list(islice(values, size)) for size in sizes[:4])
    springs = [
        [_spring(next(rules), next(rules), next(rules), values) for _ in range(size)]
        for size in sizes[4:]
    ]
    shear, flexure, axial = (group[0] if len(group) == 1 else group for group in springs)
    damped = Damping(*damping, bool(tangent), (modal[0] if len(modal) == 1 else modal) or None)
    return Column(
        height,
        None if mass == UNSET else mass,
        shear,
        flexure,
        n=n,
        axial_load=load,
        kinematics=kinematics,
        lengths=lengths or None,
        masses=masses or None,
        self_weight=bool(weight),
        gravity=gravity,
        axial=axial or None,
        top_mass=top_mass,
        top_inertia=top_inertia,
        depth=depth,
        rotary_inertia=rotary_inertia or None,
        axial_follows=bool(axial_follows),
        force_follows=bool(force_follows),
        damping=None if damped == Damping() else damped,
    )


def _spring(rule: int, inner: int, layers: int, values: Iterator[float]) -> Spring:
    """Return the spring of a rule by its place, from the next numbers."""
    kind = _SPRINGS[rule - 1]
    numbers = islice(values, len(_core.SPRING_NUMBERS))
    given = {
        name: value
        for name, value in zip(_core.SPRING_NUMBERS, list(numbers), strict=True)
        if name in kind.__dataclass_fields__ and value != UNSET
    }
    if kind is Takeda:
        given["inner"] = _core.INNER[inner - 1]
    if kind is Layered:
        given["layers"] = [
            (next(values), _spring(int(next(values)), 1, 0, values)) for _ in range(layers)
        ]
    return kind(**given)
