"""Joint springs: a rule and its parameters; and the strains of the layers of a joint.

Deformation and force are slip [m] and shear [N], or rotation [rad] and moment [N m]; the units
below are those of a shear spring.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import MISSING, dataclass, fields, replace
from functools import cache, cached_property
from typing import Any, ClassVar, Literal, NamedTuple, TypeAlias, TypeVar, get_args

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._files import atomic_write, data_frame
from rbsdem._types import Array, ArrayLike, Self
from rbsdem.errors import InputError

AnySpring = TypeVar("AnySpring", bound="Spring")

#: Name and values of a group of a case file.
Group: TypeAlias = tuple[str, Mapping[str, Any]]

#: Classes of springs by the name of their rule.
SPRINGS: dict[str, type[Spring]] = {}

LandmarkName = Literal[
    "cracking", "yield", "web_yield", "spalling", "crushing", "bar_buckling", "bar_fracture",
    "cap", "residual",
]  # fmt: skip

#: A deformation that no spring reaches [m or rad].
_NEVER = 1e30


class Landmark(NamedTuple):
    """A point of the virgin curve of a spring that limit states are told by.

    Attributes
    ----------
    name : str
        "cracking", where the first line ends before yield; "yield"; "cap", from which on the force
        falls; or "residual", where that ends.
    side : int
        1, or -1 for negative deformations.
    deformation : float
        In size, above 0 [m or rad].
    source : str
        The parameters that it follows from.
    """

    name: LandmarkName
    side: Literal[1, -1]
    deformation: float
    source: str


@dataclass(frozen=True)
class Spring:
    """Base of all springs."""

    #: Name of the rule in the Fortran part.
    rule: ClassVar[str] = ""
    #: Parameters at which the virgin spring cracks, yields and caps, and on which sides; a rule
    #: without them neither cracks nor yields, or where it does depends on its axial load.
    turns: ClassVar[Mapping[LandmarkName, str]] = {}
    sides: ClassVar[tuple[Literal[1, -1], ...]] = (1, -1)

    def __init_subclass__(cls) -> None:
        """Enter the class in the list of springs under its rule."""
        SPRINGS[cls.rule] = cls

    def __post_init__(self) -> None:
        if not self.rule:
            raise TypeError(f"Spring is the base of {', '.join(classes_for(''))}; use one of them")
        _arguments.convert(self, f"{self.rule} spring")
        self._check()

    def _check(self) -> None:
        """Raise `InputError` if the rule does not allow the parameters."""
        _core.evaluate("check_spring", self.statement("flexure"), axial_load=0.0)

    def landmarks(self) -> list[Landmark]:
        """Return where the virgin spring cracks, yields and caps, by the table of its rule."""
        points: list[Landmark] = []
        for name, key in self.turns.items():
            for side in filter(self._carries, self.sides):
                # A side without values of its own has those of the other.
                negative = f"{key}_neg"
                known = negative if side < 0 and getattr(self, negative, None) is not None else key
                # A key is a parameter, or the quotient of two, as "f_y/k".
                above, _, below = known.partition("/")
                at = getattr(self, above) / (getattr(self, below) if below else 1.0)
                if at > 0:
                    points.append(Landmark(name, side, at, known))
        return points

    def _carries(self, side: int) -> bool:
        """Whether a side has any strength."""
        return side in self.sides

    def statement(self, group: str, **place: Any) -> _core.Statement:
        """Return the keys of the spring as a group of a case.

        Parameters
        ----------
        group : str
            "shear", "flexure", "axial_spring" or "layer_spring".
        **place
            Keys that place the spring: `joint` or `id`.
        """
        (names, words, values), own = _parameters(self.rule), vars(self)
        text, numbers = _core.group(group, place)
        numbers += [
            _core.UNSET if (value := own[name]) is None or type(value) is str else value
            for name in names
        ]
        chosen = "".join([f"\t{name}={_core.word(own[name])}" for name in words])
        return _core.Statement(f"{text}\trule={self.rule}{values}{chosen}", numbers)

    def split(self, n: int) -> Self:
        """Return one of n equal springs that in series are equivalent to this one.

        Parameters
        ----------
        n : int
            Number of springs; each has n times the stiffness and 1/n of the deformations.

        Raises
        ------
        InputError
            If `n` is not a whole number of 1 or more.
        """
        _arguments.integer(n, "split: n", least=1)
        return self.scaled(n)

    def scaled(self, parts: float) -> Self:
        """Return the spring of a part of the length: `parts` times as stiff, 1/`parts` as far."""
        keys = _core.keys()["rules"][self.rule]["keys"]
        changes: dict[str, Any] = {}
        for key in keys:
            value = getattr(self, key["name"])
            if value is not None and key.get("unit") == "stiffness":
                changes[key["name"]] = value * parts
            elif value is not None and key.get("unit") == "deformation":
                changes[key["name"]] = value / parts
        return replace(self, **changes)

    def mirrored(self) -> Self:
        """Return the spring that does for negative deformations what this one does for positive.

        Raises
        ------
        InputError
            If its rule has no such spring.
        """
        sides = [part.name for part in fields(self) if part.name.endswith("_neg")]
        negative = {name: getattr(self, name) for name in sides}
        if all(value is None for value in negative.values()):
            return self
        changes: dict[str, Any] = {}
        for name, value in negative.items():
            plain = name.removesuffix("_neg")
            changes[name] = getattr(self, plain)
            if value is not None:
                changes[plain] = value
        if changes["d_u_neg"] is None and "d_u" in changes:
            # A value that is not given would be that of the positive side, which has an end now.
            changes["d_u_neg"] = _NEVER
        return replace(self, **changes)

    def response(self, deformation: ArrayLike) -> Array:
        """Return the force along a path of deformation.

        The path starts at the virgin state (zero) and goes straight from point to point; the force
        at a point does not depend on points in between.

        Parameters
        ----------
        deformation : array_like, shape (m,)
            Deformations in sequence [m or rad].

        Returns
        -------
        ndarray, shape (m,)
            Forces [N or N m].

        Raises
        ------
        InputError
            If the array does not have one dimension, or contains a value that is not finite.
        """
        path = _arguments.finite_vector(deformation, "deformation")
        if path.size == 0:
            return np.empty(0)
        return _response(self.statement("flexure"), path, 0.0)


def for_whole_column(spring: AnySpring, place: str) -> AnySpring:
    """Mark a new spring as the one of a whole column, which several joints have to share.

    Parameters
    ----------
    spring : Spring
        The spring; those made from it by `Spring.split` or ``dataclasses.replace`` are unmarked.
    place : str
        "shear" or "flexure".

    Returns
    -------
    Spring
        The same spring.
    """
    _arguments.put(spring, _whole_column=place)
    return spring


def whole_column(spring: Spring) -> str:
    """Return the place of a spring that is for a whole column; empty for the spring of a joint."""
    return str(spring.__dict__.get("_whole_column", ""))


def classes_for(place: str) -> list[str]:
    """Return the names of the classes whose springs may stand in a place.

    Parameters
    ----------
    place : str
        "shear", "flexure", "axial" or "layer"; empty: anywhere.
    """
    rules = _core.keys()["rules"]
    return [
        kind.__name__
        for rule, kind in SPRINGS.items()
        if not place or place in rules[rule]["places"].split()
    ]


def checked_spring(spring: object, name: str, place: str, more: str = "") -> Spring:
    """Return a spring, or raise `InputError` with those that may stand in a place."""
    if isinstance(spring, Spring):
        return spring
    names = ", ".join(classes_for(place.removesuffix("_spring")))
    told = _arguments.shown(spring)
    raise InputError(f"{name} = {told} must be a spring ({names}){more}")


@cache
def _parameters(rule: str) -> tuple[list[str], list[str], str]:
    """Return the names of the parameters of a rule, those of words, and the key of their values."""
    keys = _core.keys()["rules"][rule]["keys"]
    words = [key["name"] for key in keys if key["kind"] == "word"]
    return [key["name"] for key in keys], words, f"\tvalues:{len(keys)}" if keys else ""


@cache
def _defaults(rule: str) -> dict[str, Any]:
    """Return the parameters of a rule that have a default."""
    known = fields(SPRINGS[rule])
    return {field.name: field.default for field in known if field.default is not MISSING}


def unchecked(kind: type[AnySpring], **values: Any) -> AnySpring:
    """Make a spring without checking it: a model makes twenty, and their column checks them all.

    Parameters
    ----------
    kind : type
        A class of springs without `inner`.
    **values
        Its parameters; those without a default must be there.

    Returns
    -------
    Spring
        The spring. Whoever makes it has to check it, see `check_springs`.
    """
    spring = object.__new__(kind)
    spring.__dict__.update(_defaults(kind.rule), **values)
    return spring


def check_springs(springs: Iterable[Spring]) -> None:
    """Raise `InputError` for the first spring, or layer of one, that its rule does not allow."""
    for spring in dict.fromkeys(springs):
        if isinstance(spring, Layered):
            check_springs(layer for _, layer in spring.layers)
        spring._check()


@dataclass(frozen=True)
class Elastic(Spring):
    """Spring on one straight line.

    Parameters
    ----------
    k : float
        Stiffness [N/m].
    """

    rule: ClassVar[str] = "elastic"
    k: float


@dataclass(frozen=True)
class Bilinear(Spring):
    """Bilinear spring with kinematic hardening (paper, table 1).

    Parameters
    ----------
    k : float
        Initial stiffness [N/m].
    d_y : float
        Yield deformation [m].
    k_post : float
        Stiffness after yield [N/m], from 0 to below `k`.

    Raises
    ------
    InputError
        If a parameter is outside the rule.
    """

    rule: ClassVar[str] = "bilinear"
    turns: ClassVar[Mapping[LandmarkName, str]] = {"yield": "d_y"}
    k: float
    d_y: float
    k_post: float


@dataclass(frozen=True)
class Takeda(Spring):
    """Trilinear Takeda spring with degradation factors (paper, table 1 and eq 7).

    Parameters
    ----------
    k_c : float
        Uncracked stiffness [N/m].
    d_c : float
        Cracking deformation [m].
    k_y : float
        Cracked stiffness [N/m], below `k_c`.
    d_y : float
        Yield deformation [m], above `d_c`.
    k_u : float
        Stiffness after yield [N/m], from 0 to `k_y`.
    b0 : float, optional
        Exponent of the outer unloading stiffness K_r = K_0 (d_y/|D_m|)^b0.
    b1 : float, optional
        Factor of the inner unloading stiffness. With the default of 1 it is K_r (Takeda 1970).
    inner : {"kc", "kr", "one"}, optional
        Inner unloading stiffness: b1 k_c, b1 K_r, or K_r. It is always kept between the secant to
        the zero crossing of the excursion and K_r.

    Raises
    ------
    InputError
        If a parameter is outside the rule.
    """

    rule: ClassVar[str] = "takeda"
    turns: ClassVar[Mapping[LandmarkName, str]] = {"cracking": "d_c", "yield": "d_y"}
    k_c: float
    d_c: float
    k_y: float
    d_y: float
    k_u: float
    b0: float = 0.4
    b1: float = 1.0
    inner: Literal["kc", "kr", "one"] = "kc"


@dataclass(frozen=True)
class PeakOriented(Spring):
    """Spring with a capped backbone, peak-oriented reloading and cyclic deterioration.

    Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34, 1489-1511), with a cracking
    point and an unloading stiffness that may decrease with ductility. ``docs/rules.md`` describes
    its lines.

    Parameters
    ----------
    d_y, f_y : float
        Yield point [m], [N]. A side whose `f_y` is 0 carries nothing: a strut that only touches
        has ``f_y=0`` and its strength in `f_y_neg`.
    d_cap, f_cap : float
        Capping point, the largest force [m], [N]; from `d_y`, `f_y` on.
    d_pc : float
        Deformation from the cap to where the softening line reaches zero force [m].
    f_res : float, optional
        Residual force, at which softening ends [N]; from 0 to below `f_y`.
    d_u : float, optional
        Deformation beyond which the force falls to zero with the slope -16/15 f_y/d_y [m]. By
        default it never does.
    d_c, f_c : float, optional
        Cracking point [m], [N]. With the default of 0 the spring is elastic up to yield.
    b0 : float, optional
        Exponent of the unloading stiffness K_0 (d_y/|D_m|)^b0, K_0 = (f_c + f_y)/(d_c + d_y).
    lambda_s, lambda_c, lambda_k, lambda_a : float, optional
        Dissipated energy at which deterioration is complete, over f_y d_y (mean of both sides): of
        the strength, of the softening line, of the unloading stiffness, of the target of reloading.
        0 means no deterioration.
    c : float, optional
        Exponent of deterioration: of the quantity 1 - (E/(lambda f_y d_y))^c is left, E the energy
        that all excursions so far have dissipated.
    lambda_h, s_min : float, optional
        For shear springs: the strength falls to the share s_min + (1 - s_min)/(1 + W/(lambda_h f_y
        d_y)), W the work of the flexural spring of the same joint since cracking. 0 means that it
        does not.
    fade : float, optional
        How the strength falls with the energy share x = (E/(lambda_s f_y d_y))^c: its rate is minus
        its power `fade`. 0: evenly, to nothing at x = 1; 1: exp(-x); 2: 1/(1 + x).
    d_y_neg, f_y_neg, d_cap_neg, f_cap_neg, d_pc_neg, f_res_neg, d_u_neg, d_c_neg, f_c_neg : float
        The backbone of the negative side, as positive numbers. A value that is not given is that of
        the positive side.

    Raises
    ------
    InputError
        If a parameter is outside the rule.
    """

    rule: ClassVar[str] = "peak_oriented"
    turns: ClassVar[Mapping[LandmarkName, str]] = {
        "cracking": "d_c", "yield": "d_y", "cap": "d_cap"
    }  # fmt: skip
    d_y: float
    f_y: float
    d_cap: float
    f_cap: float
    d_pc: float
    f_res: float = 0.0
    d_u: float | None = None
    d_c: float = 0.0
    f_c: float = 0.0
    b0: float = 0.0
    lambda_s: float = 0.0
    lambda_c: float = 0.0
    lambda_k: float = 0.0
    lambda_a: float = 0.0
    c: float = 1.0
    d_y_neg: float | None = None
    f_y_neg: float | None = None
    d_cap_neg: float | None = None
    f_cap_neg: float | None = None
    d_pc_neg: float | None = None
    f_res_neg: float | None = None
    d_u_neg: float | None = None
    d_c_neg: float | None = None
    f_c_neg: float | None = None
    lambda_h: float = 0.0
    s_min: float = 0.0
    fade: float = 0.0

    def _carries(self, side: int) -> bool:
        """Whether a side has any strength: a side without values has those of the other."""
        other = side < 0 and self.f_y_neg is not None
        return bool((self.f_y_neg if other else self.f_y) > 0)  # type: ignore[operator]


@dataclass(frozen=True, kw_only=True)
class Pinching(PeakOriented):
    """Peak-oriented spring with pinched reloading, for shear cracks and slip of bars.

    Parameters
    ----------
    kappa_f : float
        Force at the break of the reloading line, over that of the straight line to the peak there;
        above 0, up to 1.
    kappa_d : float
        The break is at the deformation (1 - kappa_d) times the permanent deformation of the peak;
        above 0, up to 1.
    d_y, f_y, d_cap, f_cap, d_pc, f_res, d_u, d_c, f_c, b0 : float
        As for `PeakOriented`, by keyword.
    lambda_s, lambda_c, lambda_k, lambda_a, c, lambda_h, s_min, fade : float, optional
        As for `PeakOriented`.
    d_y_neg, f_y_neg, d_cap_neg, f_cap_neg, d_pc_neg, f_res_neg, d_u_neg, d_c_neg, f_c_neg : float
        As for `PeakOriented`.

    Raises
    ------
    InputError
        If a parameter is outside the rule.
    """

    rule: ClassVar[str] = "pinching"
    kappa_f: float
    kappa_d: float


@dataclass(frozen=True)
class Compression(Spring):
    """Axial spring that carries compression only: an open joint without tension.

    Parameters
    ----------
    k : float
        Stiffness in compression [N/m]. Opening and tension are positive: the force is k (w + gap)
        for w < -gap and 0 otherwise.
    gap : float, optional
        Closing before the faces touch [m].

    Raises
    ------
    InputError
        If the stiffness is not positive, or the gap is negative.
    """

    rule: ClassVar[str] = "compression"
    k: float
    gap: float = 0.0


@dataclass(frozen=True)
class ConcreteSpring(Spring):
    """Concrete across a joint: crushes in compression, opens without tension, closes gradually.

    For axial springs and the layers of `Layered`. Opening and tension are positive, so compression
    is at negative deformations; the parameters are given as positive numbers.

    Parameters
    ----------
    k : float
        Initial stiffness [N/m].
    f_peak, d_peak : float
        Largest compression [N] and the closing there [m]. The curve up to it is that of Popovics
        (1973), so `f_peak` must be below k d_peak.
    k_soft : float
        Slope of softening beyond the peak [N/m], as a positive number.
    f_res : float, optional
        Residual force after softening [N].
    plastic : float, optional
        Factor of the plastic closing of Karsan and Jirsa (1969).
    contact : float, optional
        Share of the force at unloading at which a closing crack is fully closed, below 1.
    misfit : float, optional
        Share of the widest opening at which the faces of a closing crack touch, below 1.
    wear : float, optional
        Share of the strength that a wide opening of the crack takes, if the closing has reached
        2 `d_peak`, and less in proportion before; below 1.
    friction : float, optional
        Share of the force by which the path of opening is below that of closing, once the spring
        was closed by `d_peak` or more; below 1.

    Raises
    ------
    InputError
        If a parameter is outside the rule.
    """

    rule: ClassVar[str] = "concrete"
    turns: ClassVar[Mapping[LandmarkName, str]] = {"cap": "d_peak"}
    sides: ClassVar[tuple[Literal[1, -1], ...]] = (-1,)
    k: float
    f_peak: float
    d_peak: float
    k_soft: float
    f_res: float = 0.0
    plastic: float = 1.0
    contact: float = 0.0
    misfit: float = 0.0
    wear: float = 0.0
    friction: float = 0.0


@dataclass(frozen=True)
class SteelSpring(Spring):
    """Steel whose curve is round: parallel elements, each of which slips at a limit of its own.

    Iwan 1966, with limits that follow the plastic reach and the roundness of Menegotto and Pinto
    (1973). It depends continuously on its path, and closed loops do not create energy.
    ``docs/rules.md`` has its lines. Below, d_y = f_y/k, and the plastic reach is the range of the
    deformation so far, which is at least that from -d_y to d_y, less 2 d_y.

    Parameters
    ----------
    k : float
        Elastic stiffness [N/m].
    f_y : float
        Yield force [N].
    k_post : float
        Stiffness of hardening [N/m], from 0 to below `k`.
    r0, cr1, cr2 : float, optional
        Roundness R = r0 (1 - cr1 q/(cr2 + q)) of branches, q the plastic reach over d_y; cr1 is
        below 1. The virgin curve is sharp.
    isotropic_hardening, hardening_reach : float, optional
        The strength grows by the share isotropic_hardening (q/(2 hardening_reach))^0.8, on the
        virgin curve too.
    f_u : float, optional
        Force at which hardening ends [N], not below `f_y`. The default is none.
    plateau : float, optional
        Length of the yield plateau over d_y; needs `f_u`.
    endurance : float, optional
        Sum of plastic deformations over d_y, without those that set a new maximum or minimum, after
        which the bar has half of its strength; 0: it stays. Not below the widest limit of an
        element, about 10.
    d_buckle : float, optional
        Tensile deformation from which on the bar bows when it is compressed again [m].
    buckling : float, optional
        Compression after an elongation d beyond `d_buckle` counts 1 + buckling (d/d_buckle - 1)
        times in `endurance`.

    Raises
    ------
    InputError
        If a parameter is outside the rule.
    """

    rule: ClassVar[str] = "steel"
    turns: ClassVar[Mapping[LandmarkName, str]] = {"yield": "f_y/k"}
    k: float
    f_y: float
    k_post: float
    r0: float = 20.0
    cr1: float = 0.925
    cr2: float = 0.15
    isotropic_hardening: float = 0.0
    hardening_reach: float = 1.0
    f_u: float | None = None
    plateau: float = 0.0
    endurance: float = 0.0
    d_buckle: float | None = None
    buckling: float = 0.0

    def mirrored(self) -> Self:
        """Return the same spring, unless it buckles on one side only, which is refused."""
        if self.d_buckle is not None:
            raise InputError(
                "double_curvature: a flexural SteelSpring with d_buckle buckles on one side only, "
                "and cannot be mirrored; give it no d_buckle"
            )
        return self


@dataclass(frozen=True, repr=False)
class Layered(Spring):
    """A joint made of layers: normal springs across it that share the axial load of the column.

    For flexural springs. Layer i opens by w + y_i theta; the opening w at the middle of the section
    follows from the equilibrium of the axial load. Positive rotation opens layers at positive y.

    Parameters
    ----------
    layers : sequence of (float, Spring)
        Distance of each layer from the middle of the section [m] and its spring, one of a rule that
        suits layers: `ConcreteSpring`, `SteelSpring`, `Elastic` and others. At least two.

    Raises
    ------
    InputError
        If a layer is outside its rule.
    """

    rule: ClassVar[str] = "layered"
    layers: Sequence[tuple[float, Spring]]

    def __post_init__(self) -> None:
        try:
            pairs = [(y, spring) for y, spring in self.layers]
        except (TypeError, ValueError):
            raise InputError(
                "layered spring: layers must be a sequence of pairs of a distance [m] and a spring"
            ) from None
        layers = []
        for number, (y, spring) in enumerate(pairs, 1):
            place = _arguments.number(y, f"layered spring: y of layer {number}")
            layer = checked_spring(spring, f"layered spring: layer {number}", "layer")
            layers.append((place, layer))
        _arguments.put(self, layers=tuple(layers))
        super().__post_init__()

    def __repr__(self) -> str:
        return f"Layered({len(self.layers)} layers)"

    def __hash__(self) -> int:
        # Of the first and the last spring alone: those of all layers take long.
        return hash((*(y for y, _ in self.layers), self.layers[0][1], self.layers[-1][1]))

    def _check(self) -> None:
        """Raise `InputError` if a layer is not allowed in a joint."""
        # The column checks whether the layers can carry its axial load.
        _core.evaluate("check_spring", self._alone(), axial_load=0.0)

    def _alone(self) -> _core.Statement:
        """Return the spring with its layers, as a case of one joint."""
        return _core.joined(placed([("flexure", {}, self)]))

    def layers_group(self, ids: dict[Spring, int], place: Mapping[str, Any]) -> Group:
        """Return the layers as a group of a case; new springs of layers are added to the ids."""
        # Most layers have one and the same spring: what it is equal to is asked once.
        different = {id(spring): spring for _, spring in self.layers}
        known = {own: ids.setdefault(spring, len(ids) + 1) for own, spring in different.items()}
        numbers = [known[id(spring)] for _, spring in self.layers]
        return "layers", {**place, "y": [y for y, _ in self.layers], "spring": numbers}

    @cached_property
    def points(self) -> list[tuple[float, list[Landmark]]]:
        """Where layers yield in tension, and outer layers of concrete spall, by their places."""
        outer = min(y for y, _ in self.layers), max(y for y, _ in self.layers)
        known: dict[int, list[Landmark]] = {}
        layers = []
        for y, layer in self.layers:
            if isinstance(layer, ConcreteSpring) and y in outer:
                gone = layer.d_peak + (layer.f_peak - layer.f_res) / layer.k_soft
                points = [Landmark("spalling", -1, gone, "d_peak + (f_peak - f_res)/k_soft")]
            else:
                if id(layer) not in known:
                    marks = layer.landmarks()
                    known[id(layer)] = [m for m in marks if m.name == "yield" and m.side > 0]
                points = known[id(layer)]
            if points:
                layers.append((y, points))
        return layers

    def split(self, n: int) -> Self:
        """Return one of n equal springs in series: the layers are split and keep their places."""
        return replace(self, layers=tuple((y, spring.split(n)) for y, spring in self.layers))

    def mirrored(self) -> Self:
        """Return the joint upside down: layers at y are at -y."""
        return replace(self, layers=tuple((-y, layer) for y, layer in self.layers))

    def response(self, deformation: ArrayLike, axial_load: float = 0.0) -> Array:
        """Return the moment along a path of rotation under a constant axial load.

        Parameters
        ----------
        deformation : array_like, shape (m,)
            Rotations in sequence [rad].
        axial_load : float, optional
            Axial load that the layers share, compression positive [N].

        Returns
        -------
        ndarray, shape (m,)
            Moments [N m]; NaN from where the layers can no longer carry the axial load.

        Raises
        ------
        InputError
            If the layers cannot carry the axial load, or a rotation is not finite.
        """
        path = _arguments.finite_vector(deformation, "deformation")
        return _response(self._alone(), path, _arguments.number(axial_load, "axial_load"))


def _response(spring: _core.Statement, path: Array, axial_load: float) -> Array:
    """Return the force of a spring along a path of deformation, under an axial load [N]."""
    histories = {"axial_load": axial_load, "deformation": path}
    return _core.evaluate("spring_response", spring, **histories).values


def placed(
    entries: Iterable[Group | tuple[str, Mapping[str, Any], Spring]],
) -> list[Group | _core.Statement]:
    """Return groups of a case, with the keys of the springs that stand in some, and their layers.

    Parameters
    ----------
    entries : iterable
        Groups: name and values, and the spring that stands there. Springs of layers follow at the
        end, each once, with their ids.
    """
    groups: list[Group | _core.Statement] = []
    ids: dict[Spring, int] = {}
    for name, place, *springs in entries:
        groups += [spring.statement(name, **place) for spring in springs] or [(name, place)]
        groups += [each.layers_group(ids, place) for each in springs if isinstance(each, Layered)]
    return groups + [spring.statement("layer_spring", id=i) for spring, i in ids.items()]


#: Parts that a layer stands for: a bar, concrete inside the ties, concrete outside.
Part = Literal["bar", "core", "cover"]
_PARTS = get_args(Part)


@dataclass(frozen=True)
class Gauge:
    """Parts that the layers of a joint stand for, in the order of `Layered.layers`.

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
        _arguments.put(self, part=tuple(parts))
        lengths = _arguments.vector(self.length, "gauge: length")
        _arguments.put(self, length=tuple(lengths.tolist()))
        if len(self.part) != len(self.length):
            raise InputError(
                f"gauge: {len(self.part)} parts and {len(self.length)} lengths; give one of each "
                "for each layer"
            )
        for number, (part, length) in enumerate(zip(self.part, self.length, strict=True), 1):
            if not (isinstance(part, str) and part in _PARTS):
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
        """Return the largest strain of a part, in tension (`side` = 1) or compression (-1)."""
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
        path : path-like
            The file; it is written whole or not at all.
        layers : bool, optional
            Whether to write a column for each layer, as ``bar_-0.16``.
        """
        table = self.columns
        if layers:
            table = {"time": self.time} | {
                f"{number}_{part}_{y:g}": self.value[:, number - 1]
                for number, (part, y) in enumerate(zip(self.part, self.position, strict=True), 1)
            }
        with atomic_write(path) as file:
            data_frame(table).to_csv(file, index=False, lineterminator="\n")

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
    places, part, length = np.array(position, float), np.array(gauge.part), np.array(gauge.length)
    return Strains(joint, time, places, part, length, np.asarray(deformation / length))
