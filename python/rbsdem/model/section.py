"""What a section of any shape can be asked: diagrams, springs, strengths, its column."""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Literal, get_args, overload

import numpy as np
from numpy.typing import ArrayLike

from rbsdem import _arguments, _core
from rbsdem._arguments import Array
from rbsdem.errors import AccuracyWarning, InputError
from rbsdem.model.column import MOST_BODIES, Top
from rbsdem.model.drawn import DrawnSection
from rbsdem.model.ends import double_curvature
from rbsdem.model.footing import Footing
from rbsdem.model.materials import Tension
from rbsdem.section.diagram import Diagram, make_diagram
from rbsdem.section.interaction import Code, InteractionDiagram, interaction_diagram
from rbsdem.section.model import DEFAULT, LayeredColumn, Model, make_column
from rbsdem.section.parameters import ModelParameters
from rbsdem.section.ranges import axial_load_note, carried_load, column_length
from rbsdem.section.shear_diagram import ShearDiagram, shear_diagram
from rbsdem.section.spring_fit import SectionSprings, fit_springs
from rbsdem.section.strength import shear_strength_mcft

if TYPE_CHECKING:
    from rbsdem.model.column import Column

__all__ = ["Section"]


@dataclass(frozen=True)
class Section(DrawnSection):
    """What all sections share; `RectangularSection` and `CircularSection` know their shape."""

    def moment_curvature(
        self,
        axial_load: float,
        curvature: ArrayLike,
        tension: Tension = "ts",
        confined: bool = False,
    ) -> Array:
        """Return the moment of each curvature under a constant axial load.

        Parameters
        ----------
        axial_load : float
            Compression positive [N].
        curvature : array_like
            Curvatures, in any order [1/m]; a positive one puts y > 0 in tension. Each is reached
            from zero, so its moment does not depend on the others.
        tension : {"ts", "bare", "zero"}, optional
            Tension law of the concrete: with tension stiffening, up to f_t only, no tension.
        confined : bool, optional
            Whether the core inside the ties is confined and the cover spalls.

        Returns
        -------
        ndarray, shape of `curvature`
            Moments about mid-depth [N m].

        Raises
        ------
        InputError
            If the section cannot carry the axial load, or a value is refused.
        SolveError
            If the section no longer carries the axial load at one of the curvatures.
        """
        load = self._load(axial_load)
        return self._strains(load, curvature, tension, self._confined(confined))[0]

    def strains(
        self,
        axial_load: float,
        curvature: ArrayLike,
        tension: Tension = "ts",
        confined: bool = False,
    ) -> tuple[Array, Array]:
        """Return the moments of `moment_curvature` with the strains at mid-depth.

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
        return self._strains(self._load(axial_load), curvature, tension, self._confined(confined))

    def _strains(
        self, axial_load: float, curvature: ArrayLike, tension: Tension, confined: bool
    ) -> tuple[Array, Array]:
        given = _arguments.finite_vector(curvature, "curvature", shape="any")
        shape, flat = given.shape, given.ravel()
        over = np.flatnonzero(np.abs(flat) * self.depth > 1.0)
        if over.size:
            raise InputError(
                f"curvature: {flat[over[0]]} 1/m makes strains of {flat[over[0]] * self.depth:.3g} "
                f"over the depth; curvatures are in 1/m: 10 mrad/m is 0.01"
            )
        settings = {
            "axial_load": axial_load,
            "tension": tension,
            "confined": confined,
        }
        moment = np.empty_like(flat)
        strain = np.empty_like(flat)
        for side in (flat >= 0.0, flat < 0.0):
            places = np.flatnonzero(side)
            if places.size:
                places = places[np.argsort(np.abs(flat[places]), kind="stable")]
                moment[places], strain[places] = _core.moment_curvature(
                    self._statement, settings, flat[places]
                )
        return moment.reshape(shape)[()], strain.reshape(shape)[()]

    def diagram(
        self,
        axial_load: float,
        *,
        tension: Tension = "ts",
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
            by 20 per cent of its peak, once concrete is crushed or a bar has broken.
        eps_yield, eps_cover : float, optional
            Strains of the extreme fibre, compression positive.
        points : int, optional
            Number of points of the diagram, besides its events.
        furthest : float, optional
            Last curvature of the diagram [1/m]; by default 1.15 times the ultimate one, or the end
            of the diagram if that comes first.

        Returns
        -------
        Diagram
            Curvatures, moments, strains and events; its method `plot` draws them.

        Raises
        ------
        InputError, SolveError
            As for `moment_curvature`; `InputError` also if a rule is not known or does not apply.
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

    def interaction(
        self, code: Code | None = None, *, points: int = 60, confined: bool = False
    ) -> InteractionDiagram:
        """Return the interaction diagram of axial load and moment, y > 0 in tension.

        Parameters
        ----------
        code : {"aci318", "ec2"}, optional
            "aci318": ACI 318-19 with its factors phi and its limit of the axial load. "ec2":
            EN 1992-1-1 with gamma_c = 1.5, gamma_s = 1.15 and alpha_cc = 1, without a least
            eccentricity. None: the largest moments of `moment_curvature` at each axial load, with a
            confined core until its hoops break.
        points : int, optional
            About how many points.
        confined : bool, optional
            For the section's own laws: whether the core is confined and the cover spalls.

        Returns
        -------
        InteractionDiagram
            Nominal and design strength; its method `plot` draws them with demands.

        Raises
        ------
        InputError
            If the code is not known or does not cover the section.
        """
        return interaction_diagram(self, code, points, self._confined(confined))

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
            `flexure` (`springs.Takeda`), `shear` (`springs.Bilinear`), `events`, `report`.

        Raises
        ------
        InputError
            If a value is refused, or the section has no trilinear line (controlled by compression,
            cracked by the axial load, lightly reinforced).
        """
        hinge = options.get("hinge_length")
        if hinge is not None and _arguments.number(hinge, "springs: hinge_length") > length:
            raise InputError(
                f"springs: hinge_length = {hinge:g} m is longer than the column, length = "
                f"{length:g} m"
            )
        return fit_springs(self, length, _arguments.number(axial_load, "axial_load"), **options)

    @overload
    def column(
        self,
        height: float,
        *,
        axial_load: float,
        mass: float | None = None,
        n: int | None = None,
        model: Literal["layered"] = "layered",
        version: str | None = None,
        model_parameters: ModelParameters | None = None,
        axial_height: float | None = None,
        restrained: int | None = None,
        round_core: bool = False,
        top: Top = "free",
        footing: Footing | None = None,
    ) -> LayeredColumn: ...
    @overload
    def column(
        self,
        height: float,
        *,
        axial_load: float,
        mass: float | None = None,
        n: int | None = None,
        model: Literal["paper"],
        axial_height: float | None = None,
        top: Top = "free",
        footing: Footing | None = None,
    ) -> Column: ...
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
        top: Top = "free",
        footing: Footing | None = None,
    ) -> Column:
        """Return the column with this section, with second-order effects of the axial load.

        Parameters
        ----------
        height : float
            From the foot to the lateral load [m]; with a fixed top the clear height between both
            ends.
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
            Version of the parameters of the layered model, as "2026.2"; the newest by default
            (`rbsdem.section.parameters.versions` lists them).
        model_parameters : ModelParameters, optional
            Parameters in place of those of a version, as of `rbsdem.section.parameters.parameters`.
        axial_height : float, optional
            Height at which the axial load acts, from the foot [m]; by default that of the column.
            The sections carry `axial_load`, and the column has its second-order moment at this
            height.
        restrained : int, optional
            Longitudinal bars held in a corner of a hoop or by a tie, for the confinement in the
            layered model. By default the four corners, and four more for each leg beyond two,
            in proportion for a part of a leg.
        round_core : bool, optional
            Whether the ties of a rectangular section stand for a spiral around a round core.
        top : {"free", "fixed"}, optional
            "fixed": double curvature, with the hinge and the shear spring of half the height at
            both ends (`rbsdem.double_curvature`, prismatic); `n` is then the number of bodies of
            each half.
        footing : Footing, optional
            A footing on springs that the column stands on.

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
        (2, '2026.5')
        """
        if restrained is not None:
            restrained = _arguments.whole(restrained, "restrained")
        round_core = bool(_arguments.switch(round_core, "round_core"))
        if version is not None and not isinstance(version, str):
            raise InputError(f'version = {version!r} must be a text, as "2026.1"')
        if model_parameters is not None and not isinstance(model_parameters, ModelParameters):
            raise InputError(
                f"model_parameters = {model_parameters!r} must be ModelParameters, as of "
                "rbsdem.section.parameters.parameters()"
            )
        if n is not None and not 1 <= _arguments.whole(n, "n") <= MOST_BODIES:
            raise InputError(f"n = {n} must be from 1 to {MOST_BODIES}")
        if axial_height is not None:
            axial_height = _arguments.number(axial_height, "axial_height")
        _arguments.choice(top, "top", get_args(Top))
        parts = 2 if top == "fixed" else 1
        column = make_column(
            self,
            column_length(height, "height") / parts,
            axial_load=axial_load,
            mass=None if mass is None else _arguments.number(mass, "mass") / parts,
            n=n,
            model=model,
            version=version,
            model_parameters=model_parameters,
            axial_height=axial_height,
            restrained=restrained,
            round_core=round_core,
        )
        if top == "fixed":
            column = double_curvature(column)
        return column if footing is None else replace(column, footing=footing)

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
            Positive, increasing curvatures [1/m].
        **options
            As for `rbsdem.section.shear_diagram.shear_diagram`: furthest, points, tension,
            confined, layers, knee.

        Returns
        -------
        ShearDiagram
            Forces, strains and the knee; its method `plot` draws them.

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
        return shear_strength_mcft(self, length, carried_load(self._load(axial_load), self))

    def _load(self, axial_load: Any) -> float:
        """Return an axial load; say so if it is hardly meant."""
        value = _arguments.number(axial_load, "axial_load")
        if not math.isfinite(value):
            raise InputError(f"axial_load = {value} N must be a finite number")
        note = axial_load_note(value, self)
        if note:
            warnings.warn(note, AccuracyWarning, stacklevel=3)
        return value

    def _confined(self, confined: Any) -> bool:
        wanted = _arguments.switch(confined, "confined")
        if wanted and self.ties is None:
            raise InputError(
                f"confined = True needs transverse bars that confine: give the section {self.hoops}"
            )
        return wanted
