"""All values of codes and regressions for one column, and a response beside them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np

from rbsdem import _arguments, _package
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame
from rbsdem.checks import aci_318, asce_41, formulas
from rbsdem.curves.envelope import envelope, strength_loss
from rbsdem.curves.metrics import Curve, loop_pair, summarise
from rbsdem.errors import InputError
from rbsdem.model.column import Column
from rbsdem.model.shape import Section
from rbsdem.run.column_result import ColumnResult
from rbsdem.run.limit_states import limit_states
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.quantities import Quantities, goodnight_buckling_strain, quantities
from rbsdem.section.strength import (
    axial_failure_drift,
    nominal_moment,
    nominal_point,
    shear_failure_drift,
    shear_strength_sezen,
)


@dataclass(frozen=True)
class CodeValue:
    """One value.

    Attributes
    ----------
    name : str
        Its name, as "asce_41.a".
    meaning : str
        What it is.
    value : float
        In SI: N, N m, m, rad; a drift or ratio without unit.
    unit : str
        "N", "N m", "m", "1/m", "rad", "drift" or "".
    source : str
        Code or paper, with its clause or equation.
    confirmed : bool
        Whether the formula was confirmed by a second source; others are from memory of the field.
    """

    name: str
    meaning: str
    value: float
    unit: str
    source: str
    confirmed: bool = True


class CodeValues(Tabular):
    """The values of a column, by name and in the order of their sources.

    Parameters
    ----------
    values : list of CodeValue
        The values.
    quantities : Quantities
        What the formulas used.
    """

    def __init__(self, values: list[CodeValue], quantities: Quantities) -> None:
        self.quantities = quantities
        self._values = {value.name: value for value in values}

    def __getitem__(self, name: str) -> float:
        """Return the value of a name."""
        if name not in self._values:
            raise InputError(
                f"code values: {name!r} is not known; it is one of {', '.join(self._values)}"
            )
        return self._values[name].value

    def __iter__(self) -> Iterator[CodeValue]:
        return iter(self._values.values())

    def __len__(self) -> int:
        return len(self._values)

    def names(self) -> list[str]:
        """Return the names."""
        return list(self._values)

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each value with its unit, meaning and source."""
        return data_frame([asdict(value) for value in self])

    def __repr__(self) -> str:
        return f"CodeValues({len(self)} values: {', '.join(self._values)})"


def code_values(section: Section, height: float, axial_load: float) -> CodeValues:
    """Return the values of codes and regressions for a column with a section.

    Stiffness, strengths, chord and plastic rotations, drifts at failures: ASCE 41-17 (ACI 369.1),
    EN 1998-3, Panagiotakos and Fardis, Elwood and Eberhard, Elwood and Moehle, Sezen and Moehle,
    Haselton, Berry and Eberhard, Goodnight; each with its source, and whether its formula is
    confirmed. Those that were made for rectangles are left out for circles; walls have shear
    strength and drift capacity of ACI 318-19 alone.

    Parameters
    ----------
    section : Section
        The section.
    height : float
        Shear span, from the foot to the point without moment [m].
    axial_load : float
        Compression positive [N].

    Returns
    -------
    CodeValues
        The values by name.

    Raises
    ------
    InputError
        If the section has no bars near both faces, or a number is refused.
    """
    c = _Drawn(section, quantities(section, height, axial_load))
    rows = []
    for row in _package.rows("code_values.csv"):
        walls = section.shape == "wall"
        if (row["covers"] == "wall") != walls or not _COVERS[row["covers"]](c.q):
            continue
        value = _FORMULAS[row["name"]](c)
        if math.isfinite(value):
            source = (c.q.round and row["source_of_circles"]) or row["source"]
            known = row["unit"], source, row["confirmed"] == "1"
            rows.append(CodeValue(row["name"], row["meaning"], value, *known))
    return CodeValues(rows, c.q)


@dataclass(frozen=True)
class _Drawn:
    """A column as the formulas take it."""

    section: Section
    q: Quantities

    @cached_property
    def moment(self) -> float:
        """Moment at which the backbones of codes yield [N mm].

        The closed form is for rectangles; circles yield at their nominal moment, as codes have it.
        """
        if self.q.round:
            return 1e3 * nominal_moment(self.section, self.q.load)
        return self.yielding[1]

    @cached_property
    def yielding(self) -> tuple[float, float, float]:
        """Curvature [1/mm], moment [N mm] and relative depth of the neutral axis at yield."""
        return formulas.yield_point(self.q)

    @property
    def force(self) -> float:
        """Shear force at yield [N]."""
        return self.moment / self.q.span

    @cached_property
    def rotations(self) -> asce_41.Rotations:
        """Plastic rotations of ASCE 41."""
        q, ratio = self.q, self.force / formulas.asce_41_shear_strength(self.q)
        given = q.axial_load_ratio, q.tie_ratio, ratio, q.fc, q.fyt
        return asce_41.column_rotations(*given, circle=q.round)

    @property
    def wall_shear(self) -> float:
        """Nominal shear strength of a wall by ACI 318-19 [N]."""
        q = self.q
        ties = q.tie_ratio, q.fyt
        return aci_318.wall_shear(q.fc, q.width * q.depth, q.span / q.depth, *ties)

    def least_of_wall(self, drift: Callable[[float, float, float, float], float]) -> float:
        """Return the lesser drift of both directions.

        `drift` is a function of length, width of the zone in compression and depth of the neutral
        axis [m], and of the moment [N m].
        """
        drifts = []
        for section in (self.section, self.section.mirrored):
            # The zone in compression is at y < 0.
            edge = section.part(1e-3 * section.depth)[0] / (1e-3 * section.depth)
            drifts.append(drift(section.depth, edge, *nominal_point(section, self.q.load)))
        return min(drifts)

    def wall_drift(self, length: float, width: float, axis: float, moment: float) -> float:
        """Return the drift capacity of a wall by ACI 318-19."""
        shear = min(1e3 * moment / self.q.span, self.wall_shear)
        stress = shear / (self.q.width * self.q.depth)
        return aci_318.wall_drift(length, width, axis, stress, self.q.fc)

    @cached_property
    def haselton(self) -> formulas.Haselton:
        """The backbone of Haselton."""
        return formulas.Haselton(self.q)


#: What the values cover.
_COVERS: dict[str, Callable[[Quantities], bool]] = {
    "": lambda q: True,
    "rectangle": lambda q: not q.round,
    "wall": lambda q: True,
    "ties": lambda q: q.tie_ratio >= 0.0005,
    "hoops": lambda q: q.hoop_ratio > 0,
    "round hoops": lambda q: q.hoop_ratio > 0 and q.round,
}

_FORMULAS: dict[str, Callable[[_Drawn], float]] = {
    "yield.moment": lambda c: 1e-3 * c.moment,
    "yield.shear": lambda c: c.force,
    "yield.curvature": lambda c: 1e3 * c.yielding[0],
    "hinge.priestley": lambda c: 1e-3 * formulas.hinge_length_priestley(c.q),
    "hinge.paulay": lambda c: 1e-3 * formulas.hinge_length_paulay(c.q),
    "asce_41.stiffness": lambda c: asce_41.column_stiffness(c.q.axial_load_ratio),
    "asce_41.shear": lambda c: formulas.asce_41_shear_strength(c.q),
    "asce_41.a": lambda c: c.rotations.a,
    "asce_41.b": lambda c: c.rotations.b,
    "asce_41.c": lambda c: c.rotations.c,
    "asce_41.io": lambda c: c.rotations.io,
    "asce_41.ls": lambda c: c.rotations.ls,
    "asce_41.cp": lambda c: c.rotations.cp,
    "aci_318.wall_shear": lambda c: c.wall_shear,
    "aci_318.wall_drift": lambda c: c.least_of_wall(c.wall_drift),
    "walls.drift": lambda c: c.least_of_wall(lambda *s: formulas.wall_drift_at_loss(*s[:3])),
    "ec_8.yield": lambda c: formulas.ec_8_yield_rotation(
        c.q, cracked=formulas.ec_8_cracks_in_shear(c.q)
    ),
    "ec_8.ultimate": lambda c: formulas.ec_8_ultimate_rotation(c.q),
    "ec_8.plastic": lambda c: formulas.ec_8_plastic_rotation(c.q),
    "ec_8.shear": lambda c: formulas.ec_8_shear_resistance(c.q),
    "ec_8.shear_after_yield": lambda c: formulas.ec_8_shear_resistance(c.q, 5.0),
    "elwood.stiffness": lambda c: formulas.elwood_eberhard_stiffness(c.q),
    "elwood.shear_drift": lambda c: shear_failure_drift(c.section, c.force, c.q.load),
    "elwood.axial_drift": lambda c: axial_failure_drift(c.section, c.q.load),
    "sezen.shear": lambda c: shear_strength_sezen(c.section, 1e-3 * c.q.span, c.q.load),
    "haselton.cap": lambda c: c.haselton.capping_rotation,
    "haselton.post_cap": lambda c: c.haselton.post_capping_rotation,
    "haselton.hardening": lambda c: c.haselton.hardening,
    "haselton.stiffness": lambda c: c.haselton.yield_stiffness,
    "haselton.initial": lambda c: c.haselton.initial_stiffness,
    "berry.spalling": lambda c: formulas.berry_spalling_drift(c.q),
    "berry.buckling": lambda c: formulas.berry_buckling_drift(c.q),
    "berry.rotation": lambda c: formulas.berry_buckling_rotation(c.q),
    "goodnight.strain": lambda c: goodnight_buckling_strain(c.q),
    "goodnight.drift": lambda c: formulas.goodnight_buckling_drift(c.q),
}


# ---- drifts and backbones of a cantilever that follow from code values ---------------------------


def yield_drift(values: CodeValues, stiffness: str) -> float:
    """Return the drift at yield of a cantilever with a share of its gross stiffness.

    M_y L/(3 E I) with E = 4700 sqrt(f'c) and I of the gross section.

    Parameters
    ----------
    values : CodeValues
        The column.
    stiffness : str
        Name of the share, as "asce_41.stiffness".
    """
    q = values.quantities
    inertia = math.pi * q.depth**4 / 64 if q.round else q.width * q.depth**3 / 12
    modulus = 4700.0 * math.sqrt(q.fc)
    return values["yield.moment"] * 1e3 * q.span / (3.0 * values[stiffness] * modulus * inertia)


def _yield_and(values: CodeValues, stiffness: str, rotation: str) -> float:
    """Return the drift at yield plus a plastic rotation, both by their names in `values`."""
    return yield_drift(values, stiffness) + values[rotation]


def _haselton(values: CodeValues, cap: float, post_cap: float) -> float:
    """Return the drift at which a fifth of the strength is lost behind the cap."""
    turned = cap * values["haselton.cap"] + 0.2 * post_cap * values["haselton.post_cap"]
    return yield_drift(values, "haselton.stiffness") + turned


#: Drift at a loss of 20 % of the strength by each source.
DRIFTS_AT_LOSS: dict[str, Callable[[CodeValues], float]] = {
    "ASCE 41-17, yield + a": lambda values: _yield_and(values, "asce_41.stiffness", "asce_41.a"),
    "EN 1998-3, theta_um (A.1)": lambda values: values["ec_8.ultimate"],
    "EN 1998-3, theta_y + theta_um,pl (A.3)": lambda values: (
        values["ec_8.yield"] + values["ec_8.plastic"]
    ),
    "Haselton, one push: cap + 0.2 post-cap": lambda values: _haselton(values, 1.0, 1.0),
    # 2016, eqs 12 and 13
    "Haselton, cyclic envelope": lambda values: _haselton(values, 0.7, 0.5),
    "Elwood, Moehle 2005, shear": lambda values: values["elwood.shear_drift"],
    # Drifts at bar buckling, which come later.
    "Berry, Eberhard 2005, yield + buckling": lambda values: _yield_and(
        values, "elwood.stiffness", "berry.rotation"
    ),
    "Berry, Eberhard 2003, buckling": lambda values: values["berry.buckling"],
}


def drift_at_loss(values: CodeValues, name: str) -> float:
    """Return a drift of `DRIFTS_AT_LOSS`; NaN where the source does not cover the column."""
    try:
        return DRIFTS_AT_LOSS[name](values)
    except ValueError:
        return math.nan


@dataclass(frozen=True, eq=False)
class Backbone:
    """A backbone of one source, from zero.

    Attributes
    ----------
    name, source : str
        Short name, and where it comes from.
    drift, moment : ndarray, shape (k,)
        Drift ratios, and moments at the foot [N m].
    """

    name: str
    source: str
    drift: Array
    moment: Array

    def force(self, span: float, axial_load: float) -> Array:
        """Return the lateral force [N]: moment over span less the second-order force.

        Parameters
        ----------
        span : float
            From the foot to the lateral force [m].
        axial_load : float
            What leans with the column [N]; 0 without second-order effects.
        """
        return self.moment / span - axial_load * self.drift


def backbones(values: CodeValues) -> list[Backbone]:
    """Return the backbones of the sources that cover a column.

    All yield at "yield.moment", as none of them is about strength. ASCE 41: flat over a, down to
    c, which lasts to b. EN 1998-3: flat up to theta_um, where a fifth is lost. Elwood: flat up to
    shear failure, then down to axial failure; left out where that comes first. Haselton: to the
    cap, then down to zero, under one push.
    """
    names = set(values.names())
    if "yield.moment" not in names:
        return []
    moment = values["yield.moment"]

    def line(name: str, source: str, *points: tuple[float, float]) -> Backbone:
        """Return a backbone from zero through points of drift and share of the yield moment."""
        drift, share = np.array([(0.0, 0.0), *points]).T
        return Backbone(name, source, drift, moment * share)

    lines = []
    if "asce_41.a" in names:
        at, c = yield_drift(values, "asce_41.stiffness"), values["asce_41.c"]
        a, b = at + values["asce_41.a"], at + values["asce_41.b"]
        points = [(at, 1.0), (a, 1.0), (a, c), (b, c), (b, 0.0)]
        lines.append(line("ASCE 41", "ASCE 41-17, chapter 10 (ACI 369.1)", *points))
    if "ec_8.ultimate" in names:
        at, end = values["ec_8.yield"], values["ec_8.ultimate"]
        lines.append(
            line("EC 8-3", "EN 1998-3:2005, A.10b, A.1", (at, 1.0), (end, 1.0), (end, 0.8))
        )
    if "elwood.shear_drift" in names:
        at = yield_drift(values, "elwood.stiffness")
        shear, axial = values["elwood.shear_drift"], values["elwood.axial_drift"]
        if at < shear < axial:
            points = [(at, 1.0), (shear, 1.0), (axial, 0.0)]
            source = "Elwood, Eberhard 2009; Elwood, Moehle 2005"
            lines.append(line("Elwood", source, *points))
    if "haselton.cap" in names:
        at = yield_drift(values, "haselton.stiffness")
        cap, hard = at + values["haselton.cap"], values["haselton.hardening"]
        end = cap + values["haselton.post_cap"]
        source = "Haselton 2008, 2016, one push"
        lines.append(line("Haselton", source, (at, 1.0), (cap, hard), (end, 0.0)))
    return lines


# ---- the comparison ------------------------------------------------------------------------------


@dataclass(frozen=True, repr=False, eq=False)
class CodeComparison(Tabular):
    """A response, perhaps a test, and the values of codes and regressions for the same column.

    Attributes
    ----------
    values : CodeValues
        Of the codes.
    result : Result
        The response.
    test : (ndarray, ndarray) or None
        Displacements [m] and forces [N] of a measured loop.
    """

    values: CodeValues
    result: ColumnResult
    test: tuple[Array, Array] | None = None

    @cached_property
    def backbones(self) -> list[Backbone]:
        """Backbones of the sources that cover the column."""
        return backbones(self.values)

    @property
    def span(self) -> float:
        """Shear span of the codes [m]."""
        return 1e-3 * self.values.quantities.span

    @property
    def leaning(self) -> float:
        """Axial load that leans with the column [N]; 0 without second-order effects."""
        return 0.0 if self.result.column.kinematics == "small" else self.values.quantities.load

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame in SI: a row a quantity, a column each for test, model and sources."""
        measured = _measured(self)
        rows = [
            {"quantity": name, "unit": unit, **measured.get(name, {}), **_stated(self, value, keys)}
            for name, (unit, value, keys) in _QUANTITIES.items()
        ]
        return data_frame(rows).set_index("quantity").dropna(axis="columns", how="all")

    def __repr__(self) -> str:
        return f"CodeComparison({', '.join(b.name for b in self.backbones)} beside {self.result})"


def compare(values: CodeValues, result: ColumnResult, test: Curve | None = None) -> CodeComparison:
    """Hold a response, and a test if there is one, against the values of codes.

    Parameters
    ----------
    values : CodeValues
        What `code_values` returns for the same column.
    result : Result
        Of the same column; with a fixed top its shear span is half of its height. The table of a
        layered hinge in time needs its openings (``openings=True``).
    test : Result, PeerTest or pair of arrays, optional
        The measured loop [m, N].

    Returns
    -------
    CodeComparison
        Stiffness, yield, strength and drifts by source.

    Raises
    ------
    InputError
        If the column has another span, axial load or section, or the test is no loop.
    """
    _arguments.instance(values, "compare: values", CodeValues)
    _check_same(values.quantities, result.column)
    return CodeComparison(values, result, None if test is None else _loop(test))


def _check_same(q: Quantities, column: Column) -> None:
    """Refuse a response of another column: span, axial load, and section where it is known."""
    span = column.height / (2 if column.top == "fixed" else 1)
    load = column.axial_load
    if column.kinematics == "small" and load == 0:
        load = q.load  # It does nothing there, and need not be stated.
    drawn = replace(q, span=1e3 * span, load=load)
    if isinstance(column, LayeredColumn) and column.drawing is not None:
        drawn = quantities(column.drawing.section, span, load)
    other = [
        f"{name} = {theirs:g}, here {ours:g}"
        for name, ours in vars(q).items()
        if not (ours == (theirs := getattr(drawn, name)) or _near(ours, theirs))
    ]
    if other:
        raise InputError(
            "compare: the response is of another column (N, mm, MPa): "
            f"{'; '.join(other)}; take code_values of its section, shear span and axial load"
        )


def _near(first: float, other: float) -> bool:
    return math.isclose(first, other, rel_tol=1e-9) or (math.isnan(first) and math.isnan(other))


def _loop(curve: Curve) -> tuple[Array, Array]:
    """Return displacements [m] and forces [N] of a test, all finite."""
    d, f = loop_pair(curve, "the test")
    return _arguments.finite_vector(d, "displacement"), _arguments.finite_vector(f, "force")


def _stated(
    comparison: CodeComparison, value: Callable[[CodeComparison, str], float], keys: dict[str, str]
) -> dict[str, float]:
    """Return a quantity by the sources that cover the column."""
    stated = {}
    for source, key in keys.items():
        with suppress(InputError):
            stated[source] = value(comparison, key)
    return stated


def _measured(comparison: CodeComparison) -> dict[str, dict[str, float]]:
    """Return the quantities of the test and of the model."""
    result, height = comparison.result, comparison.result.column.height
    loops = {} if comparison.test is None else {"test": comparison.test}
    loops["model"] = loop_pair(result, "the model")
    names = ("stiffness", "yield_drift", "largest_force", "strength_loss")
    rows: dict[str, dict[str, float]] = {name: {} for name in names}
    for source, (d, f) in loops.items():
        loop = summarise(d, f)
        rows["stiffness"][source] = loop.stiffness
        rows["largest_force"][source] = loop.peak_force
        rows["strength_loss"][source] = strength_loss(d, f) / height
        rows["yield_drift"][source] = _idealised(d, f) / height
    states = limit_states(result)
    for name in ("spalling", "bar_buckling", "axial_failure"):
        rows[name] = {"model": states.drift(name)}
    return rows


def _idealised(d: Array, f: Array) -> float:
    """Return the displacement at yield of the side that came to it first, else the other [m].

    The secant at 0.75 of the largest force (Park 1988). Equal areas (ASCE 41) are at the mercy of
    the first rows of a measured loop: model over test scatters twice as much by them.
    """
    first = np.argmax(np.abs(f) >= 0.75 * np.max(np.abs(f)))
    sides: tuple[Literal[1, -1], ...] = (1, -1) if f[first] > 0 else (-1, 1)
    for side in sides:
        try:
            return envelope((d, f), side).idealise("park").yield_displacement
        except InputError:  # The loop has no such envelope.
            continue
    return math.nan


def _at_yield(comparison: CodeComparison, name: str) -> float:
    """Return the drift at yield, by a value or by a share of the gross stiffness."""
    return yield_drift(comparison.values, name) if "stiffness" in name else comparison.values[name]


def _secant(comparison: CodeComparison, name: str) -> float:
    """Return the secant stiffness to yield [N/m]."""
    drift = _at_yield(comparison, name)
    force = comparison.values["yield.shear"] - comparison.leaning * drift
    return force / (drift * comparison.result.column.height)


def _largest(comparison: CodeComparison, name: str) -> float:
    """Return the largest force of the backbone of a source [N]; NaN if there is none."""
    line = next((each for each in comparison.backbones if each.name == name), None)
    return (
        math.nan if line is None else float(line.force(comparison.span, comparison.leaning).max())
    )


def _axial_failure(comparison: CodeComparison, name: str) -> float:
    """Return the drift at axial failure; the b of ASCE 41 is plastic, and yield is added to it."""
    turned = yield_drift(comparison.values, "asce_41.stiffness") if name == "asce_41.b" else 0.0
    return turned + comparison.values[name]


_YIELD = {
    "ASCE 41": "asce_41.stiffness",
    "EC 8-3": "ec_8.yield",
    "Elwood": "elwood.stiffness",
    "Haselton": "haselton.stiffness",
}
_SHEAR = {"ASCE 41": "asce_41.shear", "EC 8-3": "ec_8.shear", "Elwood": "sezen.shear"}
_BUCKLING = {"Berry": "berry.buckling", "Goodnight": "goodnight.drift"}
_LOSS = {
    "ASCE 41": "ASCE 41-17, yield + a",
    "EC 8-3": "EN 1998-3, theta_um (A.1)",
    "Elwood": "Elwood, Moehle 2005, shear",
    "Haselton": "Haselton, one push: cap + 0.2 post-cap",
}
_AXIAL = {"ASCE 41": "asce_41.b", "Elwood": "elwood.axial_drift"}

#: Unit, function, and by source the key that the function takes.
_QUANTITIES: dict[str, tuple[str, Callable[[CodeComparison, str], float], dict[str, str]]] = {
    "stiffness": ("N/m", _secant, _YIELD),
    "yield_drift": ("drift", _at_yield, _YIELD),
    "largest_force": ("N", _largest, {name: name for name in _YIELD}),
    "shear_strength": ("N", lambda c, key: c.values[key], _SHEAR),
    "spalling": ("drift", lambda c, key: c.values[key], {"Berry": "berry.spalling"}),
    "bar_buckling": ("drift", lambda c, key: c.values[key], _BUCKLING),
    "strength_loss": ("drift", lambda c, key: drift_at_loss(c.values, key), _LOSS),
    "axial_failure": ("drift", _axial_failure, _AXIAL),
}
