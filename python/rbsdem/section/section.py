"""What sections of reinforced concrete have in common, whatever their shape."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _core, _views
from rbsdem._core import Array
from rbsdem.errors import InputError
from rbsdem.section.diagram import Confinement, Diagram, make_diagram
from rbsdem.section.materials import Concrete, Steel, tension_place
from rbsdem.section.model import DEFAULT, Model, make_column
from rbsdem.section.reinforcement import Bar, Layout, Spiral, Ties
from rbsdem.section.shear_diagram import ShearDiagram, shear_diagram
from rbsdem.section.spring_fit import SectionSprings, fit_springs
from rbsdem.section.strength import shear_strength_mcft
from rbsdem.section.strips import Strips, cut

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from rbsdem.column import Column
    from rbsdem.section.parameters import ModelParameters

__all__ = ["Section"]

#: Shapes in the Fortran part, from 1.
_SHAPES = ("rectangle", "circle")

#: Kinds of transverse reinforcement in the Fortran part, from 0.
_KINDS = ("none", "ties", "spiral", "hoops")

_NO_STEEL = (1.0, 1.0, 1.0, 1.0, 1.0)


@dataclass(frozen=True)
class Section(ABC):
    """What all sections share; `RectangularSection` and `CircularSection` know their shape."""

    #: Name of the shape.
    shape: ClassVar[str]
    #: The transverse bars that this shape takes, for messages.
    hoops: ClassVar[str]

    @abstractmethod
    def _lay_out(self, layout: Layout, inset: float) -> list[Bar]:
        """Return the bars of a layout; `inset` is from the face to the edge of the bars [m]."""

    @property
    @abstractmethod
    def gross_area(self) -> float:
        """Area of the concrete outline [m2]."""

    @property
    @abstractmethod
    def effective_depth(self) -> float:
        """From the compression face to the centre of the bars in the half in tension [m]."""

    @abstractmethod
    def outline(self) -> Array:
        """Return the outline of the concrete, a point a row: x and y [m]."""

    @abstractmethod
    def hoop_line(self, inset: float, bend: float) -> Array:
        """Return the closed line at `inset` inside the outer edge of the transverse bars [m]."""

    @abstractmethod
    def inner_legs(self) -> list[Array]:
        """Return the corners of each leg of the ties between the outer ones [m]."""

    @abstractmethod
    def place_bars(self, bars: Sequence[tuple[float, float]]) -> list[tuple[float, float, float]]:
        """Return x, y and diameter of bars of which y and diameter are given [m]."""

    def _put(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def _finish(
        self, width: float, depth: float, side_cover: float, transverse: Ties | Spiral | None
    ) -> None:
        """Set bars and bar diameter, and pack all of it for the Fortran part, which checks it."""
        concrete, cover = self.concrete, self.cover
        if not isinstance(concrete, Concrete):
            raise InputError(f"section: concrete = {concrete!r} must be a Concrete")
        if not (isinstance(self.strips, int) and 10 <= self.strips <= 100_000):
            raise InputError(f"section: strips = {self.strips!r} must be from 10 to 100000")
        self._take_bars(cover, transverse)
        bars = self.bars
        steels = list(dict.fromkeys(steel for _, _, steel in bars))
        kind, tie_numbers = _transverse_numbers(transverse)
        places = [steels.index(steel) + 1 for _, _, steel in bars]
        codes = [_SHAPES.index(self.shape) + 1, kind, self.strips, len(steels), len(bars), *places]
        numbers = [width, depth, cover, side_cover, self.bar_diameter or 0.0]
        numbers += concrete.numbers() + tie_numbers
        for steel in steels:
            numbers += steel.numbers()
        numbers += [y for y, _, _ in bars] + [area for _, area, _ in bars]
        self._put("_codes", np.array(codes, dtype=np.int32))
        self._put("_numbers", np.array(numbers, dtype=np.float64))
        self._put("_figures", _core.check_section(self._packed))

    def _take_bars(self, cover: float, transverse: Ties | Spiral | None) -> None:
        """Set the bars, from list or layout, and the diameter of the outermost one in tension."""
        if self.layout is not None:
            if len(self.bars) > 0:
                raise InputError("section: give bars or layout, not both")
            if not isinstance(self.layout, Layout):
                raise InputError(f"section: layout = {self.layout!r} must be a Layout")
            inset = cover + (transverse.diameter if transverse else 0.0)
            self._put("bars", tuple(self._lay_out(self.layout, inset)))
            if self.bar_diameter is None:
                self._put("bar_diameter", self.layout.diameter)
        else:
            self._put("bars", tuple(_bar(bar, i) for i, bar in enumerate(self.bars, 1)))
        if self.bar_diameter is not None:
            value = _core.number(self.bar_diameter, "section: bar_diameter")
            self._put("bar_diameter", value)
        elif self.bars:
            area = max(self.bars, key=lambda bar: bar[0])[1]
            self._put("bar_diameter", math.sqrt(4.0 * max(area, 0.0) / math.pi))

    @property
    def _packed(self) -> tuple[Any, Any]:
        return self._codes, self._numbers

    @property
    def steel_area(self) -> float:
        """Area of all longitudinal bars [m2]."""
        return sum(area for _, area, _ in self.bars)

    @property
    def steel_ratio(self) -> float:
        """Area of the longitudinal bars over the gross area."""
        return self.steel_area / self.gross_area

    @property
    def axial_capacity(self) -> tuple[float, float]:
        """Least (tension, negative) and largest axial load without bending or confinement [N]."""
        return _core.axial_capacity(self._packed)

    @property
    def concrete_law(self) -> dict[str, float]:
        """Numbers of the unconfined concrete in force: fc, ft, ec [Pa], eps0, n, decay."""
        names = ("fc", "ft", "ec", "eps0", "n", "decay")
        return dict(zip(names, self._figures[:6].tolist(), strict=True))

    @property
    def confinement(self) -> Confinement | None:
        """What the ties make of the core (Mander, Priestley, Park 1988); None without ties."""
        if self.ties is None:
            return None
        return Confinement(*self._figures[6:15].tolist())

    def moment_curvature(
        self,
        axial_load: float,
        curvature: ArrayLike,
        tension: str = "ts",
        confined: bool = False,
    ) -> Array:
        """Return the moments that go with curvatures under a constant axial load.

        Parameters
        ----------
        axial_load : float
            Compression positive [N].
        curvature : array_like
            Curvatures, in any order [1/m]; a positive one puts y > 0 in tension. Each is reached
            from zero, so its moment does not depend on the others.
        tension : {"ts", "bare", "zero"}, optional
            Tension law of the concrete: with tension stiffening, up to f_t only, none.
        confined : bool, optional
            Whether the core inside the ties is confined, and the cover falls off.

        Returns
        -------
        ndarray, shape of `curvature`
            Moments about mid-depth [N m].

        Raises
        ------
        InputError
            If the section cannot carry the axial load, or a value is refused.
        SolveError
            If the axial load can no longer be carried at one of the curvatures.
        """
        return self.strains(axial_load, curvature, tension, confined)[0]

    def strains(
        self,
        axial_load: float,
        curvature: ArrayLike,
        tension: str = "ts",
        confined: bool = False,
    ) -> tuple[Array, Array]:
        """Return moments and strains at mid-depth; as `moment_curvature`.

        Parameters
        ----------
        axial_load, curvature, tension, confined
            As for `moment_curvature`.

        Returns
        -------
        moment, strain : ndarray, shape of `curvature`
            Moments about mid-depth [N m]; strains at mid-depth, compression positive. The strain
            at y is strain - curvature y.

        Raises
        ------
        InputError, SolveError
            As for `moment_curvature`.
        """
        shape = np.shape(curvature)
        flat = _core.finite_vector(np.ravel(np.asarray(curvature)), "curvature")
        over = np.flatnonzero(np.abs(flat) * self.depth > 1.0)
        if over.size:
            raise InputError(
                f"curvature: {flat[over[0]]} 1/m makes strains of {flat[over[0]] * self.depth:.3g} "
                f"over the depth; curvatures are in 1/m: 10 mrad/m is 0.01"
            )
        load = self._load(axial_load)
        confined = self._confined(confined)
        moment = np.empty_like(flat)
        strain = np.empty_like(flat)
        for side in (flat >= 0.0, flat < 0.0):
            places = np.flatnonzero(side)
            if places.size:
                places = places[np.argsort(np.abs(flat[places]), kind="stable")]
                moment[places], strain[places] = _core.moment_curvature(
                    self._packed, load, tension_place(tension), confined, flat[places]
                )
        return moment.reshape(shape)[()], strain.reshape(shape)[()]

    def diagram(
        self,
        axial_load: float,
        *,
        tension: str = "ts",
        confined: bool = False,
        yielding: str = "tension",
        ultimate: str = "cover",
        eps_yield: float = 0.002,
        eps_cover: float = 0.003,
        points: int = 100,
        furthest: float | None = None,
    ) -> Diagram:
        """Return the moment-curvature diagram with its events.

        Parameters
        ----------
        axial_load : float
            Compression positive [N].
        tension, confined
            As for `moment_curvature`.
        yielding : {"tension", "first"}, optional
            Yield is where the first bar in tension yields; or that or the strain `eps_yield` of
            the extreme fibre in compression, whichever comes first (Priestley, Calvi, Kowalsky
            2007).
        ultimate : {"cover", "mander", "steel", "drop"}, optional
            Ultimate is where the extreme fibre is at `eps_cover`; the edge of the core is at the
            strain of hoop fracture (needs `confined`); the first bar breaks; the moment has fallen
            by 20 per cent of its peak.
        eps_yield, eps_cover : float, optional
            Strains of the extreme fibre, compression positive.
        points : int, optional
            Points of the diagram besides its events.
        furthest : float, optional
            Last curvature of the diagram [1/m]; by default 1.15 times the ultimate one, or its end
            if that comes first.

        Returns
        -------
        Diagram
            Curvatures, moments, strains, events; `plot` draws it.

        Raises
        ------
        InputError, SolveError
            As for `moment_curvature`; if a rule is not known or does not apply.
        """
        return make_diagram(
            self,
            self._load(axial_load),
            tension,
            self._confined(confined),
            (yielding, ultimate),
            (eps_yield, eps_cover),
            points,
            furthest,
        )

    def springs(self, length: float, axial_load: float, **options: Any) -> SectionSprings:
        """Return the springs of a column with this section, from its base to the lateral load.

        Parameters
        ----------
        length : float
            From the base to the point of contraflexure, or the lateral load [m].
        axial_load : float
            Compression positive [N].
        **options
            As for `rbsdem.section.spring_fit.fit_springs`: hinge_length, yield_rule, ultimate,
            confined, moment_factor, b0, b1, d_m, ...

        Returns
        -------
        SectionSprings
            `flexure` (`rbsdem.Takeda`), `shear` (`rbsdem.Bilinear`), `events`, `report`.

        Raises
        ------
        InputError
            If a value is refused, or the section has no trilinear line (controlled by compression,
            cracked by the axial load, lightly reinforced).
        """
        return fit_springs(self, length, self._load(axial_load), **options)

    def cut(
        self, number: int, *, restrained: int | None = None, round_core: bool = False
    ) -> Strips:
        """Cut the section into strips of equal thickness across the direction of loading.

        Parameters
        ----------
        number : int
            Number of strips.
        restrained : int, optional
            Longitudinal bars that are held in a corner of a hoop or by a tie. By default the four
            corners, and four more for each leg beyond two, up to the number of bars.
        round_core : bool, optional
            Whether the ties stand for a spiral around a round core.

        Returns
        -------
        Strips
            In order of y; in each strip core and cover have centroids of their own.
        """
        return cut(self, number, restrained, round_core)

    def column(
        self,
        height: float,
        *,
        axial_load: float,
        mass: float | None = None,
        n: int | None = None,
        model: Model = DEFAULT,
        version: str | None = None,
        model_parameters: ModelParameters | None = None,
        axial_height: float | None = None,
        restrained: int | None = None,
        round_core: bool = False,
    ) -> Column:
        """Return the column with this section, with second-order effects of the axial load.

        Parameters
        ----------
        height : float
            From the foot to the lateral load [m].
        axial_load : float
            Compression positive [N].
        mass : float, optional
            Mass of the column [kg]; by default that of its volume and
            `rbsdem.section.model.CONCRETE_DENSITY`.
        n : int, optional
            Number of bodies, by default 1 in "paper" and 2 in "layered", which needs as many.
        model : {"layered", "paper"}, optional
            "layered": a hinge of concrete and steel layers with bar slip at the foot, elastic
            joints above it (`rbsdem.section.hinge`), in series a shear spring that cracks, fails
            and pinches (`rbsdem.section.shear_model`). "paper": one component with trilinear Takeda
            flexure and bilinear shear by the section analysis, as the paper has them; with `n`
            above 1, joints with the section's springs of their tributary lengths above that hinge.
        version : str, optional
            Version of the parameters of the layered model, as "2026.1"; the newest by default
            (`rbsdem.section.versions` lists them).
        model_parameters : ModelParameters, optional
            Parameters in place of those of a version, as of `rbsdem.section.parameters`.
        axial_height : float, optional
            Height at which the axial load acts, from the foot [m]; by default that of the column.
            The sections carry `axial_load`, and the column has its second-order moment at this
            height.
        restrained : int, optional
            Longitudinal bars held in a corner of a hoop or by a tie, for the confinement in the
            layered model. By default the four corners, and four more for each leg beyond two.
        round_core : bool, optional
            Whether the ties of a rectangular section stand for a spiral around a round core.

        Returns
        -------
        Column
            A `LayeredColumn`, which knows its section and the version of its parameters, or for
            "paper" a plain `rbsdem.Column`.

        Raises
        ------
        InputError
            If a value is refused, or the section cannot carry the axial load.

        Examples
        --------
        >>> bars = Layout(12, 0.016, Steel(446e6, 702e6))
        >>> ties = Ties(0.007, 0.085, Steel(364e6, 521e6), legs=4)
        >>> section = RectangularSection(
        ...     0.4, 0.4, Concrete(46.5e6), layout=bars, ties=ties, cover=0.013
        ... )
        >>> column = section.column(1.6, axial_load=744e3)
        >>> column.n, column.version
        (2, '2026.1')
        """
        return make_column(
            self,
            height,
            axial_load=axial_load,
            mass=mass,
            n=n,
            model=model,
            version=version,
            model_parameters=model_parameters,
            axial_height=axial_height,
            restrained=restrained,
            round_core=round_core,
        )

    def shear_diagram(
        self,
        length: float,
        axial_load: float,
        curvature: ArrayLike | None = None,
        **options: Any,
    ) -> ShearDiagram:
        """Return shear force against shear strain, with V = M/length.

        Parameters
        ----------
        length : float
            Shear span [m].
        axial_load : float
            Compression positive [N].
        curvature : array_like, optional
            Rising positive curvatures [1/m].
        **options
            As for `rbsdem.section.shear_diagram.shear_diagram`: furthest, points, tension,
            confined, layers, knee.

        Returns
        -------
        ShearDiagram
            Forces, strains, the knee; `plot` draws it.

        Raises
        ------
        InputError
            If a value is refused, or the section cannot carry the axial load.
        """
        return shear_diagram(self, length, self._load(axial_load), curvature, **options)

    def shear_strength(self, length: float, axial_load: float) -> float:
        """Return the shear strength of the simplified modified compression field theory.

        Parameters
        ----------
        length : float
            Shear span [m].
        axial_load : float
            Compression positive [N].

        Returns
        -------
        float
            Strength V_n [N]; see `rbsdem.section.strength` for this and other relations.

        Raises
        ------
        InputError
            If a value is refused.
        """
        return shear_strength_mcft(self, length, self._load(axial_load))

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draw the section with its bars and ties.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw; a new figure without it.

        Returns
        -------
        matplotlib.axes.Axes
            The axes, in mm, the tension face below.
        """
        return _views.view(self, "plot", ax)

    def _load(self, axial_load: Any) -> float:
        value = _core.number(axial_load, "axial_load")
        if not math.isfinite(value):
            raise InputError(f"axial_load = {value} N must be a finite number")
        return value

    def _confined(self, confined: Any) -> bool:
        wanted = _core.switch(confined, "confined")
        if wanted and self.ties is None:
            raise InputError(
                f"confined = True needs transverse bars that confine: give the section {self.hoops}"
            )
        return wanted


def _bar(bar: Any, number: int) -> Bar:
    """Return an entry of `bars` with its numbers checked as such."""
    try:
        y, area, steel = bar
    except (TypeError, ValueError):
        raise InputError(f"section: bar {number} = {bar!r} must be (y, area, steel)") from None
    if not isinstance(steel, Steel):
        raise InputError(f"section: steel of bar {number} = {steel!r} must be a Steel")
    return (
        _core.number(y, f"section: y of bar {number}"),
        _core.number(area, f"section: area of bar {number}"),
        steel,
    )


def _transverse_numbers(ties: Ties | Spiral | None) -> tuple[int, list[float]]:
    """Return kind and numbers of the transverse bars."""
    if ties is None:
        return _KINDS.index("none"), [0.0, 0.0, 0.0, 0.0, *_NO_STEEL]
    sizes = [ties.diameter, ties.spacing, ties.legs, float(ties.legs_across or 0.0)]
    return _KINDS.index(ties.kind), sizes + ties.steel.numbers()
