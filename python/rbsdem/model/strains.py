"""Strains of the layers of a joint: deformations over the lengths that the layers stand for."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._arguments import Array
from rbsdem._files import whole_file
from rbsdem.errors import InputError

#: What a layer stands for: a bar, concrete inside the ties, concrete outside.
Part = Literal["bar", "core", "cover"]
_PARTS = get_args(Part)


@dataclass(frozen=True)
class Gauge:
    """What the layers of a joint stand for, in the order of `Layered.layers`.

    Attributes
    ----------
    part : tuple of str
        "bar", "core" or "cover" for each layer.
    length : tuple of float
        Length over which each layer deforms [m]: for concrete that of the hinge, for bars with the
        length over which they slip in the footing.

    Raises
    ------
    InputError
        If there are not as many parts as lengths, or one is not valid.
    """

    part: tuple[Part, ...]
    length: tuple[float, ...]

    def __post_init__(self) -> None:
        parts = _arguments.several(self.part, "gauge: part", "words")
        object.__setattr__(self, "part", tuple(parts))
        lengths = _arguments.vector(self.length, "gauge: length")
        object.__setattr__(self, "length", tuple(lengths.tolist()))
        if len(self.part) != len(self.length):
            raise InputError(
                f"gauge: {len(self.part)} parts and {len(self.length)} lengths; give one of each "
                "for each layer"
            )
        for number, (part, length) in enumerate(zip(self.part, self.length, strict=True), 1):
            if not _arguments.is_one_of(part, _PARTS):
                raise InputError(
                    f"gauge: part of layer {number} is {part!r}; it is one of {', '.join(_PARTS)}"
                )
            if not 0 < length < float("inf"):
                raise InputError(f"gauge: length = {length:g} m of layer {number} must be above 0")


@dataclass(frozen=True, eq=False, repr=False)
class Strains:
    """Strains of the layers of one joint in each row of a result.

    Attributes
    ----------
    joint : int
        The joint, from 1 at the ground.
    time : ndarray, shape (rows,)
        As in the result.
    position : ndarray, shape (layers,)
        Distances from the middle of the section [m]; a positive rotation opens positive ones.
    part : ndarray of str, shape (layers,)
        "bar", "core" or "cover".
    length : ndarray, shape (layers,)
        Lengths over which the layers deform [m].
    value : ndarray, shape (rows, layers)
        Strains, elongation positive.
    """

    joint: int
    time: Array
    position: Array
    part: Array
    length: Array
    value: Array

    def of(self, part: Part) -> Array:
        """Return the strains of the layers of a part, shape (rows, layers of that part)."""
        return np.asarray(self.value[:, self.part == part])

    @property
    def bar_tension(self) -> Array:
        """Largest tensile strain of a bar in each row, shape (rows,); 0 if all are compressed."""
        return self._extreme("bar", 1)

    @property
    def bar_compression(self) -> Array:
        """Largest compressive strain of a bar in each row, positive, shape (rows,)."""
        return self._extreme("bar", -1)

    @property
    def core_compression(self) -> Array:
        """Largest compressive strain of the core in each row, positive, shape (rows,)."""
        return self._extreme("core", -1)

    @property
    def cover_compression(self) -> Array:
        """Largest compressive strain of the cover in each row, positive, shape (rows,)."""
        return self._extreme("cover", -1)

    def _extreme(self, part: Part, side: int) -> Array:
        return np.asarray((side * self.of(part)).max(axis=1, initial=0.0))

    @property
    def columns(self) -> dict[str, Array]:
        """The extremes by the names that they have in a csv file: time, then one for each kind."""
        names = ("bar_tension", "bar_compression", "core_compression", "cover_compression")
        return {"time": self.time} | {f"{name}_{self.joint}": getattr(self, name) for name in names}

    def to_csv(self, path: str | os.PathLike[str], *, layers: bool = False) -> None:
        """Write the extremes, or with ``layers=True`` the strains of all layers, as a csv file.

        Parameters
        ----------
        path : path
            The file; it is written whole or not at all.
        layers : bool, optional
            Whether to write a column for each layer, as ``bar_-0.16``.
        """
        found = self.columns
        if layers:
            found = {"time": self.time} | {
                f"{number}_{part}_{y:g}": self.value[:, number - 1]
                for number, (part, y) in enumerate(zip(self.part, self.position, strict=True), 1)
            }
        text = io.StringIO(newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(found)
        writer.writerows(zip(*(column.tolist() for column in found.values()), strict=True))
        with whole_file(path) as file:
            file.write(text.getvalue().encode())

    def __repr__(self) -> str:
        return (
            f"Strains(joint {self.joint}, {self.value.shape[0]} rows, {self.part.size} layers, "
            f"bars up to {self.bar_tension.max(initial=0.0):.4f}, "
            f"core {self.core_compression.max(initial=0.0):.4f}, "
            f"cover {self.cover_compression.max(initial=0.0):.4f})"
        )


def strains_of(
    joint: int, time: Array, position: Sequence[float], gauge: Gauge, deformation: Array
) -> Strains:
    """Return the strains that follow from deformations of layers.

    Parameters
    ----------
    joint : int
        The joint.
    time : ndarray, shape (rows,)
        Of the rows.
    position : sequence of float
        Places of the layers [m].
    gauge : Gauge
        What they stand for.
    deformation : ndarray, shape (rows, layers)
        Opening positive [m].

    Raises
    ------
    InputError
        If the gauge is for another number of layers.
    """
    if len(gauge.length) != deformation.shape[1]:
        raise InputError(
            f"gauge: {len(gauge.length)} lengths for the {deformation.shape[1]} layers of joint "
            f"{joint}; give one for each"
        )
    length = np.array(gauge.length)
    return Strains(
        joint,
        time,
        np.array(position, dtype=float),
        np.array(gauge.part),
        length,
        np.asarray(deformation / length),
    )
