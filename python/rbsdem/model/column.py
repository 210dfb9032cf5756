"""The column: rigid bodies joined by springs, its footing, and parameters that may be fitted."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any, ClassVar, Literal, cast

from rbsdem import _arguments, _core
from rbsdem._tables import STANDARD_GRAVITY
from rbsdem._types import ArrayLike, Self
from rbsdem.errors import InputError, warn
from rbsdem.model.shape import Section
from rbsdem.model.springs import Gauge, Spring, checked_spring, placed, whole_column


@dataclass(frozen=True)
class Damping:
    """Damping in proportion to mass and stiffness, and of modes; the parts add up.

    Parameters
    ----------
    mass : float, optional
        Damping in proportion to the mass [1/s].
    stiffness : float, optional
        Damping in proportion to the stiffness of each joint [s].
    tangent : bool, optional
        Whether to use the present stiffness of the springs instead of the initial one. With the
        initial stiffness, a joint keeps its damping when it yields.
    modal : float or sequence of float, optional
        Damping ratios of the modes of the uncracked column: one for all modes, or one for each
        of the first modes. At most 500 bodies.

    Raises
    ------
    InputError
        If a value is not a number; its bounds are checked with the column that has the damping.
    """

    mass: float = 0.0
    stiffness: float = 0.0
    tangent: bool = False
    modal: float | Sequence[float] | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "damping")
        if self.modal is None:
            return
        ratios = _arguments.vector(self.modal, "damping: modal", shape="1 or m")
        if ratios.size == 0:
            raise InputError("damping: modal is empty; give a ratio, or None")
        # A single ratio is for all modes, whether it is in a list or not.
        modal = ratios.tolist()[0] if ratios.size == 1 else tuple(ratios.tolist())
        _arguments.put(self, modal=modal)

    @property
    def acts(self) -> bool:
        """Whether there is any damping."""
        return self.mass > 0 or self.stiffness > 0 or self.modal is not None

    @classmethod
    def rayleigh(
        cls, ratio: float, frequency_1: float, frequency_2: float, tangent: bool = False
    ) -> Damping:
        """Return damping by mass and stiffness that has a given ratio at two frequencies.

        Between these frequencies the ratio is smaller, outside them it is larger.

        Parameters
        ----------
        ratio : float
            Damping ratio, below 1.
        frequency_1, frequency_2 : float
            Two different frequencies [Hz].
        tangent : bool, optional
            As for `Damping`.

        Raises
        ------
        InputError
            If a frequency is not positive, or both are the same.
        """
        hint = " (critical damping)"
        ratio = _arguments.number(ratio, "damping: ratio", least=0, below=1, hint=hint)
        omega = []
        for name, value in (("frequency_1", frequency_1), ("frequency_2", frequency_2)):
            frequency = _arguments.number(value, f"damping: {name}", above=0, unit="Hz")
            omega.append(2.0 * math.pi * frequency)
        if omega[0] == omega[1]:
            raise InputError(
                f"damping: frequency_1 and frequency_2 are both {frequency_1} Hz; "
                "they must be different"
            )
        # ratio = mass / (2 omega) + stiffness omega / 2 at both frequencies.
        stiffness = 2.0 * ratio / (omega[0] + omega[1])
        return cls(mass=stiffness * omega[0] * omega[1], stiffness=stiffness, tangent=tangent)

    def statement(self) -> _core.Statement:
        """Return the keys of the damping, as a group of a case file."""
        modal = self.modal if self.modal is None or isinstance(self.modal, tuple) else (self.modal,)
        values = {"mass": self.mass, "stiffness": self.stiffness, "tangent": self.tangent or None}
        return _core.group("damping", values | {"modal": modal})


@dataclass(frozen=True, slots=True)
class Parameter:
    """A parameter with the range in which it has a meaning.

    If both bounds are positive, the parameter is searched on a logarithmic scale, on which half and
    twice the value are equally far away. This suits stiffnesses, strengths and lengths.

    Parameters
    ----------
    value : float
        Value to start from, within the bounds [unit].
    low, high : float
        Bounds [unit].
    unit : str, optional
        Unit, as in "N/m"; empty for a bare number.
    what : str, optional
        Its meaning, for reports.

    Raises
    ------
    InputError
        If a value or bound is not finite, the bounds are reversed, or the value is outside them.
    """

    value: float
    low: float
    high: float
    unit: str = ""
    what: str = ""

    def __post_init__(self) -> None:
        about = f"parameter{f' {self.what}' if self.what else ''}"
        _arguments.convert(self, about)
        for name in ("value", "low", "high"):
            _arguments.within(getattr(self, name), f"{about}: {name}")
        if not self.low < self.high:
            raise InputError(
                f"{about}: bounds {self.low:g} and {self.high:g} must be a lower and a higher one"
            )
        if not self.low <= self.value <= self.high:
            raise InputError(
                f"{about}: value = {self.value:g} is outside its bounds {self.low:g} to "
                f"{self.high:g}; move the bounds or the value"
            )

    @property
    def logarithmic(self) -> bool:
        """Whether the parameter is searched on a logarithmic scale."""
        return self.low > 0

    def fraction(self, value: float) -> float:
        """Return the fraction of the bounds at which a value is, from 0 to 1."""
        if self.logarithmic:
            return math.log(value / self.low) / math.log(self.high / self.low)
        return (value - self.low) / (self.high - self.low)

    def at(self, fraction: float) -> float:
        """Return the value at a fraction of the bounds."""
        if fraction <= 0 or fraction >= 1:
            return self.low if fraction <= 0 else self.high
        if self.logarithmic:
            value = self.low * math.pow(self.high / self.low, fraction)
        else:
            value = self.low + fraction * (self.high - self.low)
        return min(max(value, self.low), self.high)

    def per_fraction(self, value: float) -> float:
        """Return the derivative of the value with respect to its fraction [unit]."""
        if self.logarithmic:
            return value * math.log(self.high / self.low)
        return self.high - self.low


@dataclass(frozen=True)
class Footing:
    """A rigid footing on springs: the joint beneath it is joint 0 of the column.

    Parameters
    ----------
    shear, flexure : Spring
        Springs between the ground and the footing: against sliding, and against turning. A footing
        that rocks has a `Layered` spring of `Compression` layers.
    axial_spring : Spring, optional
        Spring against settling, opening and tension positive; needed where the joints of the column
        have axial springs, and only there.
    mass : float, optional
        Mass of the footing [kg]. A static path does not need it.
    inertia : float, optional
        Its rotary inertia about its centroid, at half its height [kg m2].
    height : float, optional
        Height of the footing [m]. Its springs are at its bottom, the column stands on its top.

    Raises
    ------
    InputError
        If a spring is missing or a number is not one. The column checks the rest.
    """

    shear: Spring
    flexure: Spring
    axial_spring: Spring | None = None
    mass: float = 0.0
    inertia: float = 0.0
    height: float = 0.0

    def __post_init__(self) -> None:
        for name in ("shear", "flexure", "axial_spring"):
            spring = getattr(self, name)
            if spring is not None or name != "axial_spring":
                checked_spring(spring, f"footing: {name}", name)
        _arguments.convert(self, "footing")

    def __repr__(self) -> str:
        parts = (
            f"{part.name}={getattr(self, part.name)!r}"
            for part in fields(self)
            if getattr(self, part.name) != part.default
        )
        return f"Footing({', '.join(parts)})"

    def keys(self) -> dict[str, Any]:
        """Return the keys of the column that state the footing."""
        return {f"footing_{name}": getattr(self, name) for name in ("mass", "inertia", "height")}


#: Levels of kinematics.
Kinematics = Literal["small", "pdelta", "finite"]

#: Supports of the top of a column.
Top = Literal["free", "fixed"]

#: Whether notes on new columns and on runs are told. A context variable: threads make them too.
NOTES_ON: ContextVar[bool] = ContextVar("NOTES_ON", default=True)

_KEYS = {key["name"]: key for key in _core.keys()["groups"]["column"]}
#: Bodies of a column at the most.
MOST_BODIES: int = _KEYS["n"]["most"]
SpringGroup = Literal["shear", "flexure", "axial_spring"]
SPRING_GROUPS: tuple[SpringGroup, ...] = ("shear", "flexure", "axial_spring")
_LISTS = ("lengths", "masses", "rotary_inertia")


@contextmanager
def notes_off() -> Iterator[None]:
    """Make and run columns without a word on them, where it is known or they are some of many."""
    token = NOTES_ON.set(False)
    try:
        yield
    finally:
        NOTES_ON.reset(token)


@dataclass(frozen=True, repr=False)
class Column:
    """A column of `n` rigid bodies on `n` joints; joint i is at the bottom of body i.

    Its ends may be others than a rigid ground and a free top. Where the top is fixed against
    rotation there is one joint more, n + 1, between the last body and what holds it. A footing
    stands on a joint of its own, joint 0.

    Parameters
    ----------
    height : float
        Height of the column [m].
    mass : float or None
        Mass of the column [kg], spread in proportion to the lengths; None if `masses` are given.
    shear, flexure : Spring or sequence of Spring
        Springs of the joints: one for every joint, or one for each from joint 1 up (n of them, or
        n + 1 with a fixed top).
    n : int, optional
        Number of bodies, up to 10000.
    axial_load : float, optional
        Axial load at the top, compression positive [N]. It acts with `kinematics` "pdelta" and
        "finite", and at every level on axial springs and layered joints.
    axial_force_ratio : float, optional
        How the axial load follows the lateral force F on a static path, N = axial_load + ratio F,
        as in an exterior column of a frame; positive where a push to +x compresses the column.
    axial_height : float, optional
        Height at which the axial load acts [m], by default that of the column. The load leans with
        the column: its second-order moments are in proportion to this height. `kinematics`
        "pdelta" only.
    kinematics : {"small", "pdelta", "finite"}, optional
        "small" is linear in slips and rotations (paper, eqs 1-3, 5); "pdelta" adds the second-order
        work of the axial load; "finite" has exact rotations (paper, eq 4 corrected, for any n).
    lengths, masses : array_like, shape (n,), optional
        Lengths [m], adding up to the height, and masses [kg] of the bodies.
    self_weight : bool, optional
        Whether the weight of the bodies acts too.
    gravity : float, optional
        Acceleration of gravity for the weight [m/s2].
    axial_spring : Spring or sequence of Spring, optional
        Axial springs of the joints, opening and tension positive: `Elastic`, `Bilinear`,
        `Compression`, `ConcreteSpring` or `SteelSpring`. Without them the joints do not open.
    top_mass, top_inertia : float, optional
        Mass lumped at the top [kg] and its rotary inertia about the top [kg m2]. Its weight must be
        part of `axial_load`.
    depth : float, optional
        Depth of the section [m]; it adds m depth^2/12 to the rotary inertia of every body.
    rotary_inertia : float or array_like, shape (n,), optional
        Rotary inertia of the bodies about their centroids [kg m2], one value for all or one for
        each, in place of m (l^2 + depth^2)/12.
    damping : float or Damping, optional
        Viscous damping; a number is the damping ratio of every mode.
    top : {"free", "fixed"}, optional
        "fixed" holds the top against rotation, while it moves along and down: a column in double
        curvature. `height` is then the whole length between the two ends, and a dynamic analysis
        needs a `top_mass`.
    footing : Footing, optional
        A footing on springs, between the ground and the column.
    model : str, optional
        The model that made the column and the version of its parameters ("layered 2026.8"). It has
        no effect on the analysis.

    Raises
    ------
    InputError
        With a line for everything that is wrong.

    Warns
    -----
    AccuracyWarning
        If the axial load or the weight does nothing with `kinematics` "small", or if a mass at the
        top has no weight because the axial load is zero.
    """

    height: float
    mass: float | None
    shear: Spring | Sequence[Spring]
    flexure: Spring | Sequence[Spring]
    n: int = 1
    axial_load: float = 0.0
    kinematics: Kinematics = "small"
    lengths: ArrayLike | None = None
    masses: ArrayLike | None = None
    self_weight: bool = False
    gravity: float = STANDARD_GRAVITY
    axial_spring: Spring | Sequence[Spring] | None = None
    top_mass: float = 0.0
    top_inertia: float = 0.0
    depth: float = 0.0
    rotary_inertia: ArrayLike | None = None
    damping: float | Damping | None = None
    axial_height: float | None = None
    axial_force_ratio: float = 0.0
    model: str = ""
    top: Top = "free"
    footing: Footing | None = None

    if TYPE_CHECKING:
        #: What Fortran has made of it.
        _made: ClassVar[_core.Made]

    def __post_init__(self) -> None:
        _arguments.convert(self, "column")
        for name in _LISTS:
            if getattr(self, name) is not None:
                _arguments.put(self, **{name: _parts(getattr(self, name), name)})
        joints = self.n + (self.top == "fixed")
        _arguments.put(self, shear=_springs(self.shear, "shear", joints))
        _arguments.put(self, flexure=_springs(self.flexure, "flexure", joints))
        if self.axial_spring is not None:
            _arguments.put(self, axial_spring=_springs(self.axial_spring, "axial_spring", joints))
        for name in ("shear", "flexure"):
            _refuse_whole(getattr(self, name), name, joints)
        if self.damping is not None and not isinstance(self.damping, Damping):
            _arguments.put(
                self, damping=Damping(modal=_arguments.number(self.damping, "column: damping"))
            )
        # Once for all analyses, as a frozen column does not change.
        _arguments.put(self, _made=_core.Made(self._state()))
        for note in self._made.text.splitlines() if NOTES_ON.get() else ():
            warn(note)

    def __repr__(self) -> str:
        kinds = [type(spring).__name__ for spring in dict.fromkeys(self.joints("flexure"))]
        return (
            f"Column(height={self.height:g}, n={self.n}, kinematics={self.kinematics!r}, "
            f"axial_load={self.axial_load:g}, flexure: {', '.join(dict.fromkeys(kinds))})"
        )

    @property
    def _statement(self) -> _core.Statement:
        """Its keys, as the groups of a case file."""
        return self._made.statement

    @property
    def unknowns(self) -> int:
        """Number of joint deformations: two a joint, or three where the joints open."""
        return (2 if self.axial_spring is None else 3) * len(self.joint_numbers)

    @property
    def joint_numbers(self) -> range:
        """Numbers of the joints from the ground up, as the columns of a result hold them.

        They are 1 to n; 0 comes before them where the column stands on a footing, n + 1 after them
        where the top is fixed.
        """
        return range(int(self.footing is None), self.n + 1 + (self.top == "fixed"))

    @property
    def _prismatic(self) -> bool:
        """Whether its sections are to stay the same way up at both ends of a double curvature."""
        return False

    @property
    def opens(self) -> bool:
        """Whether the joints have axial springs and open."""
        return self.axial_spring is not None

    @property
    def damped(self) -> bool:
        """Whether the column has viscous damping."""
        return isinstance(self.damping, Damping) and self.damping.acts

    def index_of(self, joint: int) -> int:
        """Return the column of a joint in the arrays of a result.

        Parameters
        ----------
        joint : int
            One of `joint_numbers`.

        Raises
        ------
        InputError
            If there is no such joint.
        """
        numbers = self.joint_numbers
        if _arguments.integer(joint, "joint") not in numbers:
            last = f"n = {self.n}" if self.top == "free" else f"n + 1 = {self.n + 1}"
            raise InputError(f"joint = {joint} must be from {numbers[0]} to {last}")
        return numbers.index(joint)

    def joints(self, name: SpringGroup) -> tuple[Spring, ...]:
        """Return the springs of one kind, one for each of `joint_numbers`.

        Parameters
        ----------
        name : {"shear", "flexure", "axial_spring"}
            Which springs. Without axial springs the result for them is empty.
        """
        springs = getattr(self, _arguments.choice(name, "joints: name", SPRING_GROUPS))
        if springs is None:
            return ()
        if isinstance(springs, Spring):
            springs = (springs,) * (self.n + (self.top == "fixed"))
        beneath = () if self.footing is None else (getattr(self.footing, name),)
        return (*beneath, *springs)

    def gauge(self, joint: int) -> Gauge | None:
        """Return parts and lengths of the layers of a joint; None if not known.

        It is known of the hinge of a column that was made from its drawing, a `LayeredColumn`.

        Parameters
        ----------
        joint : int
            The joint, from 1 at the ground to n.
        """
        return None

    def double_curvature(self, *, top_mass: float = 0.0, prismatic: bool | None = None) -> Self:
        """Return the column in double curvature whose lower half is this cantilever.

        The cantilever has a free top, no footing and no mass at its top. The upper half is the
        lower one turned about the middle, where the moment is zero: 2 n - 1 bodies of twice the
        height, on 2 n joints, the last one at a top that is fixed against rotation. At equal shear
        and axial load its top moves twice as far as that of the cantilever, as long as both halves
        do the same.

        Parameters
        ----------
        top_mass : float, optional
            Mass that moves with the top [kg]; a dynamic analysis needs it.
        prismatic : bool, optional
            Whether the sections of the upper half are not mirrored: the same face of the column is
            in tension at one end and in compression at the other. It matters for springs whose
            sides differ. The default is what a column knows that was made from a section that is
            not symmetric, else no.

        Returns
        -------
        Column
            Of the same class, with all that is not said above as it was.

        Raises
        ------
        InputError
            If the column is no such cantilever, or a spring cannot be mirrored.
        """
        if prismatic is None:
            prismatic = self._prismatic
        prismatic = _arguments.boolean(prismatic, "double_curvature: prismatic")
        refused = {
            "top": self.top != "free",
            "footing": self.footing is not None,
            "top_mass": bool(self.top_mass or self.top_inertia),
            "axial_height": self.axial_height is not None,
        }
        for name, value in refused.items():
            if value:
                raise InputError(
                    f"double_curvature: the column must be a plain cantilever, without {name}; "
                    "give the ends of the whole column afterwards, with dataclasses.replace"
                )
        n = 2 * self.n - 1
        lengths, masses, inertias = bodies(self)
        changes: dict[str, Any] = {"height": 2 * self.height, "n": n, "top": "fixed"}
        changes["lengths"] = _doubled(lengths)
        changes["top_mass"] = _arguments.number(top_mass, "double_curvature: top_mass")
        if self.mass is not None:
            changes["mass"] = 2 * self.mass
        if self.masses is not None:
            changes["masses"] = _doubled(masses)
        if self.rotary_inertia is not None:
            # Two halves side by side, each half its length from the middle of their body.
            middle = 2 * (inertias[-1] + masses[-1] * (lengths[-1] / 2) ** 2)
            changes["rotary_inertia"] = [*inertias[:-1], middle, *inertias[-2::-1]]
        for name in SPRING_GROUPS:
            # The spring of a whole cantilever is one of each half here.
            springs = [part.split(1) if whole_column(part) else part for part in self.joints(name)]
            if springs:
                # Turned about the middle, a slip keeps its sign, a rotation does not.
                of_the_half = name == ("shear" if prismatic else "flexure")
                upper = [part.mirrored() for part in springs] if of_the_half else springs
                changes[name] = (*springs, *reversed(upper))
        return replace(self, **changes)

    def to_namelist(self) -> str:
        """Return the column as groups of a case file, from which the same column comes back."""
        return _core.evaluate("to_namelist", self._groups()).text

    def _groups(self) -> _core.Statement:
        """Return all that a case file has of the column."""
        return self._statement

    def _state(self) -> _core.Statement:
        """Return the keys of the column, as the groups of a case file."""
        usual = {"model": "", "top": "free"}
        values = {name: getattr(self, name) for name in _OWN}
        values["model"] = _core.Text(self.model)
        own = {k: v for k, v in values.items() if v is not False and v != usual.get(k)}
        own |= self.footing.keys() if self.footing is not None else {}
        damping = [self.damping.statement()] if isinstance(self.damping, Damping) else []
        springs: list[tuple[str, dict[str, Any], Spring]] = []
        for name in SPRING_GROUPS:
            beneath = None if self.footing is None else getattr(self.footing, name)
            springs += _stated_springs(getattr(self, name), beneath, name)
        return _core.joined([("column", own), *damping, *placed(springs)])


#: Fields of a column that are neither springs nor records.
_PARTS = (*SPRING_GROUPS, "damping", "footing")
_OWN = tuple(field.name for field in fields(Column) if field.name not in _PARTS)


def bodies(column: Column) -> tuple[list[float], list[float], list[float]]:
    """Return lengths [m], masses [kg] and rotary inertias [kg m2] of the bodies from the ground up.

    Those of a column without mass are zero.
    """
    n, mass = column.n, column.mass or 0.0
    lists = (column.lengths, column.masses, column.rotary_inertia)
    lengths, masses, inertias = (list(cast("tuple[float, ...]", each or ())) for each in lists)
    lengths = lengths or [column.height / n] * n
    masses = masses or [mass * length / column.height for length in lengths]
    inertias = inertias or [
        m * (length**2 + column.depth**2) / 12 for m, length in zip(masses, lengths, strict=True)
    ]
    return lengths, masses, inertias * n if len(inertias) == 1 else inertias


def _doubled(parts: list[float]) -> list[float]:
    """Return the parts of both halves; the two at the middle are one."""
    return [*parts[:-1], 2 * parts[-1], *parts[-2::-1]]


def _stated_springs(
    springs: Spring | Sequence[Spring] | None, beneath: Spring | None, name: str
) -> list[tuple[str, dict[str, Any], Spring]]:
    """Return the springs of one kind, equal springs once, with the joints that have them."""
    stated: list[tuple[str, dict[str, Any], Spring]] = []
    if beneath is not None:
        stated.append((name, {"joint": [0]}, beneath))
    if isinstance(springs, Spring):
        stated.append((name, {}, springs))
    elif springs is not None:
        joints: dict[Spring, list[int]] = {}
        for number, spring in enumerate(springs, 1):
            joints.setdefault(spring, []).append(number)
        stated += [(name, {"joint": numbers}, spring) for spring, numbers in joints.items()]
    return stated


def _parts(values: ArrayLike, name: str) -> tuple[float, ...]:
    """Return one number for each body; for rotary inertia one number for all is allowed."""
    shape = "1 or m" if name == "rotary_inertia" else "m"
    parts = _arguments.vector(values, f"column: {name}", shape=shape)
    if parts.size == 0:
        raise InputError(f"column: {name} is empty; give one for each of the n bodies")
    return tuple(parts.tolist())


def _refuse_whole(springs: Spring | Sequence[Spring], name: str, n: int) -> None:
    """Refuse springs of a whole column in the wrong place, or in several joints."""
    joints = (springs,) if isinstance(springs, Spring) else springs
    places = [place for place in map(whole_column, joints) if place]
    number = len(places) * (n if isinstance(springs, Spring) else 1)
    for place in places:
        if place != name:
            raise InputError(
                f"column: {name} is the {place} spring of a section; give it as {place}="
            )
    if number > 1:
        split = f", or give {name}.split({n})" if name == "shear" else ""
        raise InputError(
            f"column: {name} is the spring of a whole column, from section.springs, but stands in "
            f"{number} joints; rbsdem.section.column(section, height, axial_load=..., "
            f"model='paper', n={n}) shares it among them{split}"
        )


def _springs(springs: Any, name: str, n: int) -> Spring | tuple[Spring, ...]:
    """Return one spring if all joints have equal ones, otherwise a tuple of springs."""
    if isinstance(springs, Spring):
        return springs
    try:
        several = (springs,) if isinstance(springs, str | bytes) else tuple(springs)
    except Exception:  # Classes of the caller raise anything.
        several = (springs,)
    for spring in several:
        checked_spring(spring, f"column: {name}", name, " or a sequence of them")
    if not several:
        raise InputError(f"column: {name} is empty; give one spring, or one for each joint")
    if len(several) != n and n > 0:
        raise InputError(
            f"column: {name} has {len(several)} springs for n = {n} joints; "
            "give one, or one for each joint"
        )
    same = all(spring == several[0] for spring in several[1:])
    return cast(Spring, several[0]) if same else several


def checked_column(column: object, who: str = "") -> Column:
    """Return a column, or raise `InputError` with what makes one.

    Parameters
    ----------
    column : object
        The argument.
    who : str, optional
        Beginning of the message.
    """
    remedy = ""
    if isinstance(column, Section):
        remedy = "rbsdem.section.column(section, height, axial_load=...) makes one"
    elif hasattr(column, "flexure") and hasattr(column, "shear"):
        remedy = "Column(height, mass, springs.shear, springs.flexure) makes one of springs"
    return _arguments.instance(column, f"{who}column", Column, remedy)
