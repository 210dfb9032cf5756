"""Measured histories in the text format of the PEER database, or as csv."""

from __future__ import annotations

import os
from dataclasses import dataclass
from typing import Literal

from rbsdem import _arguments, _core
from rbsdem._arguments import Array


@dataclass(frozen=True)
class PeerTest:
    """A measured force-displacement history.

    Attributes
    ----------
    name : str
        Name of the test, from the first line of a PEER file; the file's name for a csv.
    displacement : ndarray, shape (m,)
        Displacement of the top of the equivalent cantilever [m].
    force : ndarray, shape (m,)
        Force column of the file [N]; the P-Delta code of the test says what it means.
    """

    name: str
    displacement: Array
    force: Array


def read_peer(
    path: str | os.PathLike[str],
    *,
    length: Literal["m", "mm", "cm", "in"] | None = None,
    force: Literal["N", "kN", "MN", "kip"] | None = None,
) -> PeerTest:
    """Read a history: the PEER text format (millimetres, kilonewtons), or a csv with a header.

    Parameters
    ----------
    path : path-like
        File with columns displacement [mm] and force [kN]; a csv may name other units, such as
        `displacement_m,force_N`.
    length, force : str, optional
        Units of the displacements and forces in the file: "m", "mm", "cm", "in" and "N", "kN",
        "MN", "kip". The default is what the file says, else millimetres and kilonewtons for the
        PEER format and SI for a csv.

    Returns
    -------
    PeerTest
        In SI units, every row of the file in its order.

    Raises
    ------
    InputError
        If the file cannot be read; the message names file, line and remedy.
    """
    units = (
        "" if unit is None else _arguments.text(unit, name)
        for name, unit in (("length", length), ("force", force))
    )
    return PeerTest(*_core.read_history(path, *units))
