"""Concrete and reinforcing steel, bars by rows or a regular layout, and ties or a spiral."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, Literal

import numpy as np

from rbsdem import _arguments, _core
from rbsdem._arguments import Derived, given
from rbsdem._types import Array, ArrayLike
from rbsdem.errors import InputError

Tension = Literal["ts", "bare", "zero"]
"""Tension laws of concrete: with tension stiffening beyond f_t; up to f_t only; no tension."""


#: Density of reinforced concrete for the mass of a column [kg/m3].
CONCRETE_DENSITY = 2400.0


@dataclass(frozen=True)
class Concrete:
    """Concrete; values that are not given follow from the strength.

    Compression follows Popovics' curve with n = 0.8 + f'c/17 and the faster decay of strong
    concrete past its peak (Collins and Mitchell 1991, the default of Response-2000).

    Parameters
    ----------
    fc : float
        Cylinder strength f'c [Pa], from 5e6 to 200e6.
    ft : float, optional
        Tensile strength [Pa]; 0.45 f'c^0.4 (MPa).
    ec : float, optional
        Modulus of elasticity [Pa]; 3320 sqrt(f'c) + 6900 (MPa).
    eps0 : float, optional
        Strain at the peak; f'c/E_c n/(n - 1). If given, n follows from it, so that E_c stays the
        initial slope.
    eps_spall : float, optional
        Strain at which the cover has spalled; used only with a confined core.

    Raises
    ------
    InputError
        If a number is refused.
    """

    fc: float
    ft: float | None = None
    ec: float | None = None
    eps0: float | None = None
    eps_spall: float = 0.006

    def __post_init__(self) -> None:
        _arguments.convert(self, "concrete")
        _check_law(self)

    def statement(self) -> _core.Statement:
        """Return the keys of the concrete with their values."""
        return _core.group("concrete", vars(self))

    def stress(self, strain: ArrayLike, tension: Tension = "ts") -> Array:
        """Return the stress of the unconfined concrete.

        Parameters
        ----------
        strain : array_like
            Strains, compression positive.
        tension : {"ts", "bare", "zero"}, optional
            Tension law.

        Returns
        -------
        ndarray, shape of `strain`
            Stresses [Pa], compression positive.

        Raises
        ------
        InputError
            If a strain is not a finite number.
        """
        strains = _arguments.finite_vector(strain, "strain", shape="any")
        law = self.statement() + _core.group("diagram", {"tension": tension})
        stress = _core.evaluate("concrete_response", law, strain=strains).values
        return stress.reshape(strains.shape)[()]


@dataclass(frozen=True)
class Steel:
    """Reinforcing steel: elastic, then a yield plateau, a parabola to the largest stress, rupture.

    The same in tension and compression (Response-2000, manual table 2-2).

    Parameters
    ----------
    fy : float
        Yield stress [Pa].
    fu : float, optional
        Largest stress [Pa]; by default 1.5 `fy`.
    es : float, optional
        Modulus of elasticity [Pa].
    eps_sh : float, optional
        Strain at which hardening begins; by default 0.007, or the yield strain where it is larger.
    eps_u : float, optional
        Strain of the largest stress, and of rupture.

    Raises
    ------
    InputError
        If a number is refused.
    """

    fy: float
    fu: float | None = None
    es: float = 200e9
    eps_sh: float | None = None
    eps_u: float = 0.1

    def __post_init__(self) -> None:
        _arguments.convert(self, "steel")
        if given(self.fu) is None:
            _arguments.put(self, fu=Derived(1.5 * self.fy))
        if given(self.eps_sh) is None:
            # A modulus that is not positive is refused below.
            strain = self.fy / self.es if self.es > 0.0 else 0.0
            _arguments.put(self, eps_sh=Derived(max(0.007, strain)))
        _check_law(self)

    def statement(self, number: int | None = None) -> _core.Statement:
        """Return the keys of the steel with their values; `number` is what bars refer to."""
        values = {name: given(value) for name, value in vars(self).items()}
        return _core.group("steel", {"id": number} | values)

    def stress(self, strain: ArrayLike) -> Array:
        """Return the stress.

        Parameters
        ----------
        strain : array_like
            Strains.

        Returns
        -------
        ndarray, shape of `strain`
            Stresses [Pa], with the sign of the strain.

        Raises
        ------
        InputError
            If a strain is not a finite number.
        """
        strains = _arguments.finite_vector(strain, "strain", shape="any")
        stress = _core.evaluate("steel_response", self.statement(), strain=strains).values
        return stress.reshape(strains.shape)[()]


@lru_cache(maxsize=1024)
def _check_law(law: Concrete | Steel) -> None:
    """Refuse a law that is not allowed; the same ones come often."""
    law.stress(0.0)


#: Diameter of the thickest bar [m], as in the Fortran part.
THICKEST = 0.075
#: Bars of a layout; more are a mistake, and fill the memory.
_MOST_BARS = 1000
#: Between rows of bars [m].
_LEAST_CLEAR = 0.025

Bar = tuple[float, float, Steel]
"""One bar: distance from mid-depth [m], y > 0 up in a beam; area [m2]; steel."""


@dataclass(frozen=True)
class Layout:
    """Bars along the ties: on the four faces of a rectangle, or around a circle.

    Parameters
    ----------
    number : int
        Number of bars.
    diameter : float
        Their diameter [m].
    steel : Steel
        Their steel.
    face : int, optional
        Bars on the tension face, its corners included, and as many on the opposite face; the rest
        is on the two sides. The default is number/4 + 1: the same on all four. Rectangles only.
    between_diameter : float, optional
        Diameter of the bars between the corners, if it differs [m]. Rectangles only.
    between_steel : Steel, optional
        Steel of the bars between the corners, if it differs. Rectangles only.

    Raises
    ------
    InputError
        If the numbers of bars do not fit together.
    """

    number: int
    diameter: float
    steel: Steel
    face: int | None = None
    between_diameter: float | None = None
    between_steel: Steel | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "layout")
        if self.number > _MOST_BARS:
            raise InputError(f"layout: number = {self.number} must not be above {_MOST_BARS}")
        _check_sizes(self, "layout", diameter="m", between_diameter="m")

    @property
    def steels(self) -> list[Steel]:
        """The steels of its bars."""
        return [steel for steel in (self.steel, self.between_steel) if steel is not None]

    def statement(self, name: str, numbers: Mapping[Steel, int]) -> _core.Statement:
        """Return the keys of the layout with their values.

        Parameters
        ----------
        name : str
            Of the group.
        numbers : mapping
            The numbers of the steels.
        """
        steels = {k: numbers[value] for k, value in vars(self).items() if isinstance(value, Steel)}
        return _core.group(name, vars(self) | steels)

    def bars(self, shape: str, depth: float, inset: float) -> list[Bar]:
        """Return the bars in a "rectangle" or a "circle" of a depth; see the two functions."""
        return (self.circular if shape == "circle" else self.rectangular)(depth, inset)

    def rectangular(self, depth: float, inset: float) -> list[Bar]:
        """Return the bars of a rectangle.

        Parameters
        ----------
        depth : float
            Of the section [m].
        inset : float
            From the faces to the outer edge of the bars: cover and tie [m].

        Returns
        -------
        list of (y, area, steel)
            The bars in rows, from the tension face on.
        """
        face = self.face
        if face is None:
            if self.number < 4 or self.number % 4:
                raise InputError(
                    f"layout: number = {self.number} does not spread over four equal faces; "
                    f"give a multiple of 4, or `face`, the bars on the tension face"
                )
            face = self.number // 4 + 1
        side = self.number - 2 * face
        if face < 2 or side < 0 or side % 2:
            raise InputError(
                f"layout: {face} bars on each face leave {side} of {self.number} for the two "
                f"sides; face must be 2 or more, and an even number must be left",
                "layout.face",
            )
        edge = self._edge(depth, inset)
        corner = (_area(self.diameter), self.steel)
        inner = self.between_diameter or self.diameter
        between = (_area(inner), self.between_steel or self.steel)
        step = -2.0 * edge / (side // 2 + 1)
        rows = [*(i * step + edge for i in range(side // 2 + 1)), -edge]
        bars: list[Bar] = []
        for place, y in enumerate(rows):
            if place in (0, len(rows) - 1):
                # Thinner bars between the corners touch the tie as well.
                shift = 0.5 * (self.diameter - inner)
                bars += [(y, *corner)] * 2
                bars += [(y + math.copysign(shift, y), *between)] * (face - 2)
            else:
                bars += [(y, *between)] * 2
        return bars

    def _edge(self, depth: float, inset: float) -> float:
        """Return the distance of the outermost bars from the middle [m]."""
        edge = 0.5 * depth - inset - 0.5 * self.diameter
        if not edge > 0.0:
            raise InputError(
                f"section: cover and hoops of {inset:g} m and bars of {self.diameter:g} m leave no "
                f"core in a section of {depth:g} m",
                "section.cover",
            )
        return edge

    def circular(self, diameter: float, inset: float) -> list[Bar]:
        """Return the bars of a circle, the first at the tension face.

        Parameters
        ----------
        diameter : float
            Of the section [m].
        inset : float
            From the surface to the outer edge of the bars: cover and spiral [m].

        Returns
        -------
        list of (y, area, steel)
            The bars.
        """
        for name in ("face", "between_diameter", "between_steel"):
            if getattr(self, name) is not None:
                raise InputError(f"layout: {name} is for rectangular sections; remove it")
        if self.number < 1:
            raise InputError(f"layout: number = {self.number} must be one or more")
        radius = self._edge(diameter, inset)
        angles = 2.0 * math.pi * np.arange(self.number) / self.number
        area = _area(self.diameter)
        return [(float(y), area, self.steel) for y in radius * np.cos(angles)]


@dataclass(frozen=True)
class Bars:
    """A row of equal bars along a face, as drawings have it: 4 bars of 16 mm.

    Parameters
    ----------
    number : int
        Number of bars; of `side` bars those of each side.
    diameter : float
        Their diameter [m].
    steel : Steel, optional
        Their steel, if it is another one than that of the section.
    clear : float, optional
        Clear distance to the row before it, towards the face [m]; by default the diameter of the
        thicker bars, 25 mm at least (ACI 318-19, 25.2.2). The first row lies on the ties.

    Raises
    ------
    InputError
        If a number is refused.

    Examples
    --------
    >>> steel = Steel(450e6, 600e6)
    >>> beam = RectangularSection(
    ...     0.3,
    ...     0.5,
    ...     Concrete(25e6),
    ...     top=[Bars(4, 0.016), Bars(2, 0.016)],
    ...     bottom=Bars(3, 0.016),
    ...     steel=steel,
    ...     ties=Ties(0.008, 0.15, Steel(400e6)),
    ...     cover=0.03,
    ... )
    >>> sorted({round(y, 3) for y, _, _ in beam.bars})
    [-0.204, 0.163, 0.204]
    """

    number: int
    diameter: float
    steel: Steel | None = None
    clear: float | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "Bars")
        _arguments.within(self.number, "Bars: number", least=1, most=_MOST_BARS)
        _check_sizes(self, "Bars", diameter="m")
        if self.clear is not None:
            _arguments.within(self.clear, "Bars: clear", least=0.0, most=1.0, unit="m")

    def at(self, y: float, steel: Steel | None) -> list[Bar]:
        """Return the bars at a distance from mid-depth [m], of a steel if they have none."""
        return [(y, _area(self.diameter), self.steel or steel)] * self.number  # type: ignore[list-item]

    def statement(self, face: str, numbers: Mapping[Steel, int]) -> _core.Statement:
        """Return the keys of the row at a face, with the numbers of the steels."""
        steel = None if self.steel is None else numbers[self.steel]
        values = {"number": self.number, "diameter": self.diameter, "clear": self.clear}
        return _core.group("row", {"face": face, **values, "steel": steel})


def rows_of_bars(
    rows: Sequence[Bars], face: float, inset: float, steel: Steel | None
) -> tuple[list[Bar], list[float]]:
    """Return the bars of rows from a face inwards, and where the rows lie [m].

    Parameters
    ----------
    rows : sequence of Bars
        The rows, the outer first.
    face : float
        Where the face is, from mid-depth [m].
    inset : float
        From the face to the outer edge of the bars: cover and tie [m].
    steel : Steel
        Of rows that have none of their own.
    """
    bars: list[Bar] = []
    places: list[float] = []
    depth, before = inset, 0.0
    for row in rows:
        if before:
            usual = max(before, row.diameter, _LEAST_CLEAR)
            depth += usual if row.clear is None else row.clear
        places.append(face - math.copysign(depth + 0.5 * row.diameter, face))
        bars += row.at(places[-1], steel)
        depth, before = depth + row.diameter, row.diameter
    return bars, places


@dataclass(frozen=True)
class Ties:
    """Rectangular hoops and ties.

    Parameters
    ----------
    diameter : float
        Of the bar [m].
    spacing : float
        From hoop to hoop along the column [m].
    steel : Steel
        Its `eps_u` is the strain of hoop fracture.
    legs : float, optional
        Bars that cross the section in the direction of its depth (the loading); a diagonal tie
        counts with its component.
    legs_across : float, optional
        Bars in the direction of the width; as many as `legs` if not given.

    Raises
    ------
    InputError
        If a number is refused.
    """

    #: Whether the hoops are round.
    is_round: ClassVar[bool] = False

    diameter: float
    spacing: float
    steel: Steel
    legs: float = 2.0
    legs_across: float | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "ties")
        if given(self.legs_across) is None:
            _arguments.put(self, legs_across=Derived(self.legs))
        _check_sizes(self, "ties", diameter="m", spacing="m", legs="", legs_across="")

    def statement(self, steel: int) -> _core.Statement:
        """Return the keys of the ties with their values; `steel` is the number of their steel."""
        names = ("diameter", "spacing", "legs", "legs_across")
        return _core.group("ties", {"steel": steel} | {n: given(getattr(self, n)) for n in names})


@dataclass(frozen=True)
class Lap:
    """Bars that are lapped with short ones at the foot of a column.

    In tension they reach f_s = 1.25 (l_b/l_d)^(2/3) f_y, at most f_y, and do not harden beyond it:
    the form of ASCE 41-17, 10.3.5, from memory; check it with your code. That the lap loses its
    strength after that is not modelled. Bars in compression are limited alike.

    Parameters
    ----------
    length : float
        l_b, of the lap [m].
    development_length : float, optional
        l_d of your code [m]. By default that of ACI 318-19, 25.4.2.4, without hoops (K_tr = 0) and
        for bars at the bottom (from memory, too): f_y psi_s/(1.1 sqrt f'c min(c_b/d_b, 2.5)) d_b in
        MPa, c_b from the surface to the axis of the bar, psi_s = 0.8 up to 19 mm.

    Raises
    ------
    InputError
        If a number is refused.
    """

    length: float
    development_length: float | None = None

    def __post_init__(self) -> None:
        _arguments.convert(self, "lap")
        _check_sizes(self, "lap", length="m", development_length="m")

    def developed(self, yield_stress: float, fc: float, diameter: float, axis: float) -> float:
        """Return l_b/l_d, the length of the lap over the development length.

        Parameters
        ----------
        yield_stress, fc : float
            Of bars and concrete [Pa].
        diameter : float
            Of the bars [m].
        axis : float
            From the surface of the concrete to the axis of a bar [m].
        """
        needed = self.development_length
        if needed is None:
            size = 0.8 if diameter <= 0.0195 else 1.0
            cover = min(axis / diameter, 2.5)
            needed = 1e-6 * yield_stress * size / (1.1 * (1e-6 * fc) ** 0.5 * cover) * diameter
        return self.length / needed

    def statement(self) -> _core.Statement:
        """Return the keys of the lap with their values."""
        names = ("length", "development_length")
        return _core.group("lap", {name: getattr(self, name) for name in names})


@dataclass(frozen=True)
class Spiral:
    """A spiral, or circular hoops.

    Parameters
    ----------
    diameter : float
        Of the bar [m].
    spacing : float
        Pitch of the spiral, or distance between hoops, along the column [m].
    steel : Steel
        Its `eps_u` is the strain of fracture.
    hoops : bool, optional
        Whether these are single hoops, which confine less than a spiral.

    Raises
    ------
    InputError
        If a number is refused.
    """

    #: Bars that cross the section, along the depth and across it: both sides of a turn.
    legs: ClassVar[float] = 2.0
    legs_across: ClassVar[float] = 2.0
    #: Whether the hoops are round.
    is_round: ClassVar[bool] = True

    diameter: float
    spacing: float
    steel: Steel
    hoops: bool = False

    def __post_init__(self) -> None:
        _arguments.convert(self, "spiral")
        _check_sizes(self, "spiral", diameter="m", spacing="m")

    def statement(self, steel: int) -> _core.Statement:
        """Return the keys of the spiral with their values; `steel` is the number of its steel."""
        names = ("diameter", "spacing", "hoops")
        return _core.group("spiral", {"steel": steel} | {n: getattr(self, n) for n in names})


def _area(diameter: float) -> float:
    """Return the area of a bar [m2]."""
    # A power of a huge number raises; the section refuses an area without end.
    return 0.25 * math.pi * diameter * diameter


def _check_sizes(record: object, who: str, **units: str) -> None:
    """Refuse sizes of bars that are not above zero, and diameters that no bar has."""
    for name, unit in units.items():
        value = getattr(record, name)
        if value is not None and not 0 < value < math.inf:
            told = f"{who}: {name} = {value} {unit}".rstrip()
            raise InputError(f"{told} must be finite and above zero")
        # Else every bar would be reported as outside the section.
        if value is not None and name.endswith("diameter") and value > THICKEST:
            raise InputError(
                f"{who}: {name} = {value:.6g} m must not be above {THICKEST} (20 mm is 0.02)"
            )
