"""How a wall fails, by its drawing, and how far the model was off on tested walls like it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal, get_args

from rbsdem import _package
from rbsdem.model.wall import WallSection
from rbsdem.section.frame import Frame, Structure
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.strength import nominal_moment

Failure = Literal["flexure", "mixed", "shear"]
FAILURES: tuple[Failure, ...] = get_args(Failure)

#: Stress of bars that have yielded and harden over their yield stress, as the probable moment of
#: ACI 318-19 has it (21.2.1 and 18.10.3; from memory).
HARDENED = 1.25


@dataclass(frozen=True)
class WallAccuracy:
    """Test over model of the tested walls that fail in one way, by their drawings.

    Attributes
    ----------
    failure : {"flexure", "mixed", "shear"}
        How they fail, see `failure_of`.
    walls : int
        How many were tested.
    strength, stiffness, drift : (float, float)
        Median and standard deviation of the logarithm of test over model: largest force, secant
        stiffness at yield, drift at the loss of 15 % of the force or more in one push.
    lower, upper : float
        Of their largest forces 80 % are between these times the model's.
    """

    failure: Failure
    walls: int
    strength: tuple[float, float]
    stiffness: tuple[float, float]
    drift: tuple[float, float]
    lower: float
    upper: float

    def __str__(self) -> str:
        how = {"flexure": "bending", "mixed": "shear after bending", "shear": "shear"}
        numbers = (
            f"{what} {median:.2f} / {scatter:.2f}"
            for what, (median, scatter) in (
                ("largest force", self.strength),
                ("first stiffness", self.stiffness),
                ("drift at loss", self.drift),
            )
        )
        return (
            f"a wall that fails in {how[self.failure]} by its drawing; {self.walls} such walls "
            f"were tested, with test over model (median / scatter of its logarithm) "
            f"{', '.join(numbers)}; 80 % of their forces are {self.lower:.2f} to {self.upper:.2f} "
            "of the model's; for the drift at loss walls.drift of rbsdem.codes is better"
        )


def failure_of(
    section: WallSection, shear_span: float, axial_load: float, shear_strength: float
) -> Failure:
    """Return how a wall fails, by its strengths in shear and in bending.

    In shear, if its shear strength is below the force V_n of its nominal moment; in shear after
    bending ("mixed"), if it is below 1.25 V_n, which bars that harden come to; else in bending. A
    wall that does not carry the axial load without reaching its block strength fails in bending.

    Parameters
    ----------
    section : WallSection
        The section at the foot.
    shear_span : float
        Moment over shear at the foot [m].
    axial_load : float
        Compression positive [N].
    shear_strength : float
        Of the shear spring [N].
    """
    force = nominal_moment(section, axial_load) / shear_span
    if not section.symmetric:
        force = min(force, nominal_moment(section.mirrored, axial_load) / shear_span)
    if shear_strength < force:
        return "shear"
    return "mixed" if shear_strength < HARDENED * force else "flexure"


@cache
def _table() -> dict[Failure, WallAccuracy]:
    """Return the accuracy by the way of failure; `studies/walls_measured.py` finds it."""
    made = {}
    for row in _package.rows("wall_accuracy.csv"):
        way: Any = row.pop("failure")
        number = {name: float(value) for name, value in row.items()}
        made[way] = WallAccuracy(
            way,
            int(number["walls"]),
            (number["strength_median"], number["strength_scatter"]),
            (number["stiffness_median"], number["stiffness_scatter"]),
            (number["drift_median"], number["drift_scatter"]),
            number["lower"],
            number["upper"],
        )
    return made


def wall_accuracy(structure: Structure) -> dict[str, WallAccuracy]:
    """Return how far the model was off on tested walls like those of a structure.

    Parameters
    ----------
    structure : Column or Frame
        The structure.

    Returns
    -------
    dict of str to WallAccuracy
        By the member at the foot of each wall of a frame, for a wall that stands alone by "wall";
        empty without walls that were drawn.
    """
    ways: dict[str, Failure] = {}
    if isinstance(structure, Frame):
        loads = dict(zip(structure.parts.members, structure.parts.compression, strict=True))
        for name, kind in structure.kinds.items():
            if kind.sections is None or kind.shear_spans is None:
                continue
            section = kind.sections[0]
            if isinstance(section, WallSection):
                strength = _weaker(kind.at("shear", 0.0))
                made = section, kind.shear_spans[0][0], float(loads[name])
                ways[name] = failure_of(*made, strength)
    elif isinstance(structure, LayeredColumn):
        drawing = structure._drawing
        if isinstance(drawing.section, WallSection):
            strength = _weaker(structure.joints("shear")[0])
            made = drawing.section, drawing.span, structure.axial_load
            ways["wall"] = failure_of(*made, strength)
    return {name: _table()[way] for name, way in ways.items()}


def _weaker(spring: Any) -> float:
    """Return the strength of the weaker side of a shear spring [N]; infinite if it has none."""
    strength = getattr(spring, "f_y", math.inf)
    return float(min(strength, getattr(spring, "f_y_neg", None) or strength))
