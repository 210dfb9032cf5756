"""The layered model of a column: how its springs are made, and the column that remembers it.

The model stands on the section alone; no number of a test at hand enters.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any

from rbsdem import _arguments, _core
from rbsdem.errors import InputError, warn
from rbsdem.model.column import Column, Parameter, notes_off
from rbsdem.model.shape import Section
from rbsdem.model.springs import (
    Elastic,
    Gauge,
    Layered,
    Pinching,
    Spring,
    Takeda,
    check_springs,
    unchecked,
)
from rbsdem.section.curvature import axial_load_note, range_warnings
from rbsdem.section.hinge import HingeJoint, hinge_joint
from rbsdem.section.parameters import FACTORS, ModelParameters, table
from rbsdem.section.shear import shear_spring
from rbsdem.section.strength import InteractionDiagram, joint_interaction

#: Strain at which all concrete is crushed.
_CRUSHED = 0.02


def body_lengths(height: float, hinge_length: float, n: int) -> tuple[tuple[float, ...], float]:
    """Return the lengths of the bodies, and of the parts that the joints above the hinge are for.

    The joints are in the middles of n - 1 equal parts of the column above the hinge.
    """
    part = (height - hinge_length) / (n - 1)
    heights = [0.0, *(hinge_length + (i + 0.5) * part for i in range(n - 1)), height]
    return tuple(high - low for low, high in pairwise(heights)), part


def lumping(n: int) -> float:
    """Return the deflection of the top by n - 1 joints over that of the continuous column.

    1 - 1/(4 m^2) with m joints in the middles of m parts and the moment of a force at the top.
    """
    return 1 - 0.25 / (n - 1) ** 2


def area_of_rest(area: float, modulus: float, length: float, joints: Iterable[Any]) -> float:
    """Return the area by which joints of layers and the rest of a member have E A in series [m2].

    A column in two planes is the same with the joints of both (`join_rests` of the solver).
    """
    closes: float = sum(
        modulus * area / sum(layer.k for _, layer in joint.layers) for joint in joints
    )
    return area * length / max(length - closes, 0.1 * length)


@dataclass(frozen=True)
class LayeredModel:
    """The section, sizes and parameters that a layered column is made from.

    Attributes
    ----------
    section : Section
        Its section.
    height : float
        From the foot to the lateral load [m].
    axial_load : float
        Axial load for which its springs are made, compression positive [N].
    n : int
        Number of bodies.
    parameters : ModelParameters
        Parameters of the model with their version.
    restrained, round_core
        As for `rbsdem.section.column`.
    shear_span : float, optional
        Moment over shear at the foot, for which springs of a wall are made, where it is not the
        height [m].
    """

    section: Section
    height: float
    axial_load: float
    n: int
    parameters: ModelParameters
    restrained: int | None = None
    round_core: bool = False
    shear_span: float | None = None

    @property
    def span(self) -> float:
        """Moment over shear at the foot [m]."""
        return self.shear_span or self.height

    @cached_property
    def joint(self) -> HingeJoint:
        """The hinge at the foot."""
        hinge = self.section, self.span, self.axial_load
        hoops: Any = {"restrained": self.restrained, "round_core": self.round_core}
        return hinge_joint(*hinge, self.parameters, **hoops)

    @cached_property
    def shear(self) -> tuple[Pinching, dict[str, tuple[float, float]]]:
        """The shear spring of the foot, and the limits of the parameters that make it."""
        hinge, joint = (self.section, self.span, self.axial_load), self.joint
        return shear_spring(*hinge, joint.shear_stiffness, self.parameters, joint)

    @cached_property
    def limits(self) -> dict[str, tuple[float, float]]:
        """Least and largest values of parameters that would change nothing beyond them."""
        return self.joint.limits | self.shear[1]

    def statement(self) -> _core.Statement:
        """Return the keys of the drawing, as groups of a case file."""
        keys = {
            "version": _core.Text(self.parameters.version),
            "height": self.height,
            "axial_load": self.axial_load,
            "shear_span": self.shear_span,
            "n": self.n,
            "restrained": self.restrained,
            "round_core": self.round_core or None,
        }
        statement = _core.group("drawing", keys) + self.section.drawing()
        values = self.parameters.values
        for name in self.parameters.own:
            change = {"name": _core.Text(name), "value": values[name]}
            statement += _core.group("parameter", change)
        return statement

    def fields_for(self, top: str) -> dict[str, Any]:
        """Return `made` for a cantilever, or for a column whose top is fixed.

        Parameters
        ----------
        top : {"free", "fixed"}
            "fixed" is double curvature; the drawing is then its lower half.
        """
        return self.made if top == "free" else self._made_twice

    @cached_property
    def _made_twice(self) -> dict[str, Any]:
        """The arguments of `rbsdem.Column` for a fixed top: the half, and the half turned over."""
        with notes_off():
            half = Column(self.height, 1.0, n=self.n, axial_load=self.axial_load, **self.made)
            whole = half.double_curvature(prismatic=not self.section.symmetric)
        return {name: getattr(whole, name) for name in self.made}

    def check(self, names: Iterable[str]) -> None:
        """Refuse values of some parameters beyond what they can change.

        Parameters
        ----------
        names : iterable of str
            Names of the parameters that a user gave.

        Raises
        ------
        InputError
            If one of them is beyond its limits.
        """
        values, names = self.parameters.values, tuple(names)
        # Limits of the shear spring take time: they are found only where it changes.
        of_shear = any(_spring_of(name) == "shear" for name in names)
        limits = self.limits if of_shear else self.joint.limits
        for name in names:
            least, most = limits.get(name, (-math.inf, math.inf))
            slack = 1e-9 * abs(values[name])
            if least - slack <= values[name] <= most + slack:
                continue
            side = f"above {most:.4g}" if values[name] > most else f"below {least:.4g}"
            raise InputError(
                f"parameters: {name} = {values[name]:g} is {side}, beyond which it changes nothing "
                "in this column"
            )

    @cached_property
    def bending(self) -> tuple[tuple[Spring, ...], tuple[float, ...]]:
        """Springs of the joints from the foot up, and the lengths of the bodies.

        Joints that may crack stand at the middles of n - 1 equal parts above the hinge.
        """
        joint, n = self.joint, self.n
        lengths, part = body_lengths(self.height, joint.length, n)
        # Flexible as the continuous column, whatever n is.
        stiffness = joint.flexural_stiffness / part * lumping(n)
        return (joint.spring, *(self.above(stiffness, n - 1 - i) for i in range(n - 1))), lengths

    @cached_property
    def no_slip(self) -> Elastic:
        """The shear spring of the joints above the foot.

        All slip is at the foot: where the column fails in shear is where it bends most.
        """
        return unchecked(Elastic, k=1e3 * self.joint.shear_stiffness / self.height)

    @cached_property
    def made(self) -> dict[str, Any]:
        """The arguments of `rbsdem.Column` that the model makes: shear, flexure, lengths, model."""
        slips = part_of_height(self.shear[0], self.height / self.span)
        flexure, lengths = self.bending
        return {
            "shear": (slips, *[self.no_slip] * (self.n - 1)),
            "flexure": flexure,
            "lengths": lengths,
            "model": f"layered {self.parameters.label}",
        }

    @property
    def notes(self) -> tuple[str, ...]:
        """Warnings: an odd axial load, and values outside the range of the tests of the fit."""
        note = axial_load_note(self.axial_load, self.section)
        return (*filter(None, [note]), *range_warnings(self.section, self.span, self.axial_load))

    def above(self, stiffness: float, low: float, high: float | None = None) -> Spring:
        """Return the spring of a joint above the hinge.

        The joint stands for the part from `low` to `high` below the point without moment, counted
        in parts; by default for one part. The column cracks at the moment of a tensile stress of
        0.6 sqrt(f'c) (MPa), and stays below yield. Its curvature grows with what the moment is
        above the cracking moment. Over a part from a to b that has cracked all along, the joint in
        the middle turns as much as the part does if the joint cracks at
        3/4 (a + b)^2/(a^2 + a b + b^2) of the cracking moment. If the two faces are unlike, the one
        further from the centroid counts for both.
        """
        cracked = self.parameters.cracked_above
        if not cracked > 0.0:
            return unchecked(Elastic, k=stiffness)
        section = self.section
        tensile = 0.6e6 * math.sqrt(section.concrete.fc / 1e6)
        # Under tension the least moment keeps the lines of the spring apart.
        stress = max(tensile + self.axial_load / section.gross_area, 0.1 * tensile)
        high = low - 1 if high is None else high
        share = 0.75 * (low + high) ** 2 / (low**2 + low * high + high**2)
        m_c = share * stress * section.inertia / (0.5 * section.depth + abs(section.centroid))
        d_c, k_y = m_c / stiffness, cracked * stiffness
        # More than the hinge carries, so that the joint never yields.
        most = 2.0 * max(self.joint.yield_moment, m_c)
        first: Any = {"k_c": stiffness, "d_c": d_c, "k_y": k_y, "d_y": d_c + (most - m_c) / k_y}
        return unchecked(Takeda, **first, k_u=0.9 * k_y, b0=0.0)


def part_of_height(spring: Pinching, share: float) -> Pinching:
    """Return the shear spring of a part of the height that one was made for, or of more than it.

    Deformations are in proportion to the height, but for the fall of the force after the peak: the
    crack that fails is within one storey.
    """
    return (
        spring
        if share == 1.0
        else replace(spring.scaled(1.0 / share), d_pc=spring.d_pc, d_pc_neg=spring.d_pc_neg)
    )


#: Bounds of factors on several parameters.
_TOGETHER = {"strength": (0.7, 1.5), "lengths": (0.2, 4.0), "softening": (0.1, 20.0)}


@dataclass(frozen=True, repr=False)
class LayeredColumn(Column):
    """A column on a layered hinge that knows how it was made.

    Attributes
    ----------
    drawing : LayeredModel
        Section and parameters that its springs are made from. Change parameters by
        `with_parameters`, which makes the springs anew.
    """

    drawing: LayeredModel | None = None

    def __post_init__(self) -> None:
        if not isinstance(self.drawing, LayeredModel):
            raise InputError(
                "a LayeredColumn is made by rbsdem.section.column or rbsdem.peer.column"
            )
        self._check_size()
        load = _arguments.number(self.axial_load, "column: axial_load")
        if load != self.drawing.axial_load:
            self._draw_again(load)
        try:
            super().__post_init__()
        except InputError:
            # What a spring of the model says, which was not asked before, is nearer the fault.
            for name in ("flexure", "shear"):
                check_springs(self.drawing.made[name])
            raise

    def _check_size(self) -> None:
        """Refuse another height or number of bodies for springs that are made for those."""
        made, halves = self._drawing, 2 if self.top == "fixed" else 1
        sizes = {"height": (made.height, 2 * made.height), "n": (made.n, 2 * made.n - 1)}
        for name, known in sizes.items():
            value = getattr(self, name)
            if value not in known[:halves] and not self._is_other:
                raise InputError(
                    f"column: {name} = {value!r}: the springs of this layered column are made for "
                    f"{name} = {known[0]:g}; make the column anew with rbsdem.section.column, "
                    "or give it shear and flexure of your own"
                )

    def _draw_again(self, axial_load: float) -> None:
        """Make the springs of the model anew for another axial load; others stay."""
        if self._is_other:
            return
        before, now = self._drawing, replace(self._drawing, axial_load=axial_load)
        for name, value in before.fields_for(self.top).items():
            if getattr(self, name) == value:
                _arguments.put(self, **{name: now.fields_for(self.top)[name]})
        _arguments.put(self, drawing=now)
        if notes := now.notes:
            warn("; ".join(notes))

    @property
    def _is_other(self) -> bool:
        """Whether springs of shear and flexure are both not those of the model."""
        made = self._drawing.made
        return not any(
            spring in _listed(made[name])
            for name in ("shear", "flexure")
            for spring in _listed(getattr(self, name))
        )

    def __repr__(self) -> str:
        return (
            f"LayeredColumn(height={self.height:g}, n={self.n}, axial_load={self.axial_load:g}, "
            f"model={self.model!r})"
        )

    @property
    def version(self) -> str:
        """Version of the parameters, as "2026.8", or "2026.8 changed"."""
        return self._drawing.parameters.label

    @property
    def parameters(self) -> dict[str, Parameter]:
        """Parameters that `rbsdem.calibrate` may fit, the most telling first; `shear_...` last.

        The bounds end where a value beyond them would change nothing.
        """
        values, limits = self._drawing.parameters.values, self._drawing.limits
        offers = {}
        for name, (_, what) in FACTORS.items():
            offers[name] = Parameter(1.0, *_TOGETHER[name], "-", f"factor of {what}")
        offered = [row for row in table().values() if row.rank]
        for row in sorted(offered, key=lambda row: row.rank):
            least, most = limits.get(row.name, (0.0, math.inf))
            value = min(max(values[row.name], least), most)
            ends = max(row.low * value, least), min(row.high * value, most)
            offers[row.name] = Parameter(value, *ends, row.unit, row.meaning)
        replaced = self.replaced
        return {name: offer for name, offer in offers.items() if _spring_of(name) not in replaced}

    def with_parameters(self, **values: float) -> LayeredColumn:
        """Return the column with other parameters of its model; all else stays as it is.

        Parameters
        ----------
        **values
            Any of `ModelParameters.values`, or a factor on several of them as in `parameters`.

        Raises
        ------
        InputError
            If a name is not known, a value is refused or so large that it changes nothing, or if
            the springs it belongs to were replaced by others.
        """
        drawing = replace(self._drawing, parameters=self._drawing.parameters.with_values(**values))
        for name in values:
            if self._kept(_spring_of(name)):
                raise InputError(
                    f"parameters: {name} belongs to springs that were replaced: "
                    f"{_spring_of(name)} of this column is not that of its model"
                )
        # What a factor makes of several is limited, not refused.
        several = {name: FACTORS[name][0] for name in values if name in FACTORS}
        drawing.check(set(values).difference(several, *several.values()))
        fields = drawing.fields_for(self.top)
        made = {name: value for name, value in fields.items() if not self._kept(name)}
        return replace(self, drawing=drawing, **made)

    def gauge(self, joint: int) -> Gauge | None:
        """Return parts and lengths of the layers; None unless it is the hinge of the model."""
        hinge = self._drawing.joint
        numbers, springs = self.joint_numbers, self.joints("flexure")
        foot = joint == 1 and springs[numbers.index(1)] == hinge.spring
        at_top = joint == self.n + 1 and self.top == "fixed"
        head = at_top and springs[-1] in (hinge.spring, hinge.spring.mirrored())
        return hinge.gauge if foot or head else None

    def interaction(self, *, points: int = 60, rotation: float = 0.05) -> InteractionDiagram:
        """Return the interaction diagram of axial load and moment of the joint at the foot.

        It differs from that of its section, `rbsdem.section.interaction`: the layers have the
        fitted strengths of the model, and bars harden as long as the joint turns. In cycles they
        harden a little more.

        Parameters
        ----------
        points : int, optional
            Number of axial loads, from bars that yield in tension to the largest one carried.
        rotation : float, optional
            Rotation of the joint up to which the largest moment is looked for, y > 0 in tension
            [rad].

        Returns
        -------
        InteractionDiagram
            With `code` "joint". The springs are those for the axial load of the column.

        Raises
        ------
        InputError
            If the foot has no layers of steel, or an argument is refused.
        """
        foot = self.joints("flexure")[self.joint_numbers.index(1)]
        if not isinstance(foot, Layered):
            raise InputError(f"interaction: the joint at the foot is a {type(foot).__name__}")
        return joint_interaction(foot, _CRUSHED * self._drawing.joint.length, rotation, points)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Where the column is outside the range of the tests that the model was fitted to."""
        # The drawing knows the shear span, whatever the ends of the column are.
        return range_warnings(self._drawing.section, self._drawing.span, self.axial_load)

    @property
    def replaced(self) -> tuple[str, ...]:
        """Those of "shear" and "flexure" whose springs are not those of the model."""
        return tuple(name for name in ("shear", "flexure") if self._kept(name))

    @property
    def _prismatic(self) -> bool:
        """Whether its section, not being symmetric, stays the same way up over both halves."""
        return not self._drawing.section.symmetric

    def _kept(self, field: str) -> bool:
        """Whether what the model made was replaced by something else."""
        return bool(getattr(self, field) != self._drawing.fields_for(self.top)[field])

    def _groups(self) -> _core.Statement:
        return self._statement + self._drawing.statement()

    @property
    def _drawing(self) -> LayeredModel:
        """The drawing, which is never None once the column is made."""
        assert self.drawing is not None
        return self.drawing


def _listed(springs: Any) -> tuple[Any, ...]:
    """Return springs as a tuple, where there may be one for all joints."""
    return tuple(springs) if isinstance(springs, (list, tuple)) else (springs,)


def _spring_of(name: str) -> str:
    """Return the field of the column with the springs that a parameter belongs to."""
    of_shear = name.startswith("shear_") and name != "shear_stiffness"
    return "shear" if of_shear else "flexure"
