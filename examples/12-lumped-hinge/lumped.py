"""A column as one hinge at its foot for other programs: backbone and materials of OpenSees.

Backbone and peak-oriented rule: Ibarra, Medina, Krawinkler 2005 (Earthquake Eng. Struct. Dyn. 34,
1489-1511), PEER/ATC 72-1 (2010). "Hysteretic" has three lines with pinching, damage by energy and
an unloading stiffness that falls with ductility; Pinching4 (Lowes, Mitra, Altoontash, PEER
2003/10) goes beyond it by damage of each kind, which a loop alone does not tell apart.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, get_args

import numpy as np

import rbsdem
from rbsdem import _arguments, plot
from rbsdem._files import Tabular, data_frame
from rbsdem._package import unwarned
from rbsdem._types import Array, Axes, DataFrame
from rbsdem.curves.envelope import Envelope, envelope
from rbsdem.errors import InputError, SolveError
from rbsdem.run.column_result import ColumnResult
from rbsdem.springs import PeakOriented

Material = Literal["Hysteretic", "IMKPeakOriented"]
Language = Literal["tcl", "py"]

MATERIALS: tuple[Material, ...] = get_args(Material)

#: The monotonic push goes so far beyond the largest displacement of the loop.
_BEYOND = 1.5
_PUSH_POINTS = 300
#: Steps of a material over the largest rotation.
_STEPS = 60
#: A softening line that takes longer than this over the rotation at the cap is none; its length
#: stands in the materials, which need one.
_FLAT = 100.0
#: The column above the hinge is so much stiffer, so that the hinge has all of its flexibility.
_RIGID = 1e3
#: Room for sides that differ, above the least Lambda of one.
_SIDES = 1.3
_ULTIMATE = 1.0  # rad: OpenSees cuts the moment there


@dataclass(frozen=True)
class HingeBackbone:
    """Three lines of moment over chord rotation to one side; numbers are unsigned.

    Attributes
    ----------
    kind : str
        "cyclic": of the envelope of the loop, as ASCE 41 takes it; "monotonic": of a push to one
        side, as the model of Ibarra, Medina and Krawinkler takes it.
    method : str
        "asce_41": the first line by ASCE 41-17, 7.4.3.2.4, secant to 0.6 M_y, equal areas up to the
        peak; "park" where there are no such lines: secant to 0.75 of the peak.
    side : {1, -1}
        The side of the rotation.
    stiffness : float
        K_e, slope of the first line [N m/rad].
    yield_moment, cap_moment : float
        M_y and M_c, the largest moment [N m].
    theta_p, theta_pc : float
        Rotation from yield to the cap, and from the cap to where the softening line is at zero, a
        line of least squares from the cap; infinite if the moment does not fall [rad].
    theta_u : float
        Largest rotation that was followed [rad].
    """

    kind: str
    method: str
    side: int
    stiffness: float
    yield_moment: float
    cap_moment: float
    theta_p: float
    theta_pc: float
    theta_u: float

    @property
    def theta_y(self) -> float:
        """Rotation at yield [rad]."""
        return self.yield_moment / self.stiffness

    @property
    def theta_c(self) -> float:
        """Rotation at the cap [rad]."""
        return self.theta_y + self.theta_p

    @property
    def hardening(self) -> float:
        """M_c/M_y."""
        return self.cap_moment / self.yield_moment

    @property
    def softening_length(self) -> float:
        """`theta_pc`, or a length so large that the line is flat."""
        return min(self.theta_pc, _FLAT * self.theta_c)


@dataclass(frozen=True, repr=False, eq=False)
class LumpedHinge(Tabular):
    """A column as a hinge at its foot that has all of its flexibility, fitted to a loop.

    Its rotation is the chord rotation, displacement over height; its moment that at the base, with
    the part of the axial load: the other program takes P-Delta into account. `to_pandas` and
    `to_csv` have the backbones: K_e, M_y, M_c/M_y, theta_p, theta_pc.

    Attributes
    ----------
    rotation, moment : ndarray, shape (steps,)
        The loop it was fitted to [rad, N m].
    height, axial_load : float
        Of the column [m, N].
    backbones : tuple of HingeBackbone
        Cyclic and monotonic, each of the positive and the negative side.
    pinch_rotation, pinch_moment, damage, unloading : float
        `pinchX`, `pinchY`, `damage2` (energy) and `beta` of "Hysteretic", of least squares.
    endurance : float
        Lambda of "IMKPeakOriented" for all four kinds of deterioration, of least squares [rad].
    peak_oriented_backbone : {"cyclic", "monotonic"}
        Backbone of that material, whichever of the two follows the loop more closely with its
        Lambda (options 3 and 1 of PEER/ATC 72-1, 2.2.5).
    """

    rotation: Array
    moment: Array
    height: float
    axial_load: float
    backbones: tuple[HingeBackbone, ...]
    pinch_rotation: float
    pinch_moment: float
    damage: float
    unloading: float
    endurance: float
    peak_oriented_backbone: str

    def response(self, material: Material, rotation: Any = None) -> Array:
        """Return the moments of a material along a path of rotation [N m].

        "Hysteretic" is that of OpenSees, step by step; "IMKPeakOriented" the `PeakOriented`
        spring with the same backbone and Lambda, whose rule differs in the details of
        deterioration.

        Parameters
        ----------
        material : {"Hysteretic", "IMKPeakOriented"}
            Name of the material.
        rotation : array_like, shape (m,), optional
            Rotations in sequence, from zero [rad]; by default those of the loop.
        """
        material = _arguments.choice(material, "material", MATERIALS)
        path = self.rotation
        if rotation is not None:
            path = _arguments.finite_vector(rotation, "rotation")
        if material == "Hysteretic":
            own = (self.pinch_rotation, self.pinch_moment, self.damage, self.unloading)
            return _hysteretic(self._points, own, path)
        return _peak_oriented(self._of_peak_oriented, self.endurance).response(path)

    def nrmse(self, material: Material) -> float:
        """Return the root mean square error of a material's moments over the largest moment."""
        off = self.response(material) - self.moment
        return float(np.sqrt(np.mean(off**2)) / np.abs(self.moment).max())

    @property
    def _points(self) -> list[tuple[float, float]]:
        """The three points of "Hysteretic" on the cyclic backbone, of either side: (M, theta)."""
        return [point for each in self.backbones[:2] for point in _three_points(each)]

    @property
    def _of_peak_oriented(self) -> list[HingeBackbone]:
        return [each for each in self.backbones if each.kind == self.peak_oriented_backbone]

    def opensees(self, material: Material = "Hysteretic", language: Language = "tcl") -> str:
        """Return the column as a cantilever of OpenSees: N, m and rad.

        A rotational spring at the foot and an elastic column 1000 times as stiff, with P-Delta and
        the axial load in place.

        Parameters
        ----------
        material : {"Hysteretic", "IMKPeakOriented"}, optional
            Material of the spring.
        language : {"tcl", "py"}, optional
            For OpenSees, or for OpenSeesPy.
        """
        material = _arguments.choice(material, "material", MATERIALS)
        language = _arguments.choice(language, "language", get_args(Language))
        named = self._arguments(material)
        stiff = _RIGID * max(each.stiffness for each in self.backbones) * self.height / 3.0
        area, modulus = 1.0, 3e10
        commands: list[tuple[Any, ...]] = [
            ("model", "basic", "-ndm", 2, "-ndf", 3),
            ("node", 1, 0.0, 0.0),
            ("node", 2, 0.0, 0.0),
            ("node", 3, 0.0, self.height),
            ("fix", 1, 1, 1, 1),
            ("equalDOF", 1, 2, 1, 2),
            ("uniaxialMaterial", material, 1, *(value for _, value, _ in named)),
            # From the column to the ground: positive where the top moves to the right.
            ("element", "zeroLength", 1, 2, 1, "-mat", 1, "-dir", 6),
            ("geomTransf", "PDelta", 1),
            ("element", "elasticBeamColumn", 2, 2, 3, area, modulus, stiff / modulus, 1),
            ("timeSeries", "Constant", 1),
            ("pattern", "Plain", 1, 1),
            ("load", 3, 0.0, -self.axial_load, 0.0),
        ]
        label = f"nrmse {self.nrmse(material):.3f} of the loop that it was fitted to"
        lines = [
            f"# A column of {self.height:g} m under {self.axial_load:g} N as one hinge; N, m, rad.",
            f"# {material}: {label}.",
            *(f"#   {name} = {_number(value)} {unit}".rstrip() for name, value, unit in named),
        ]
        if language == "py":
            lines += ["import openseespy.opensees as ops", "", "ops.wipe()"]
            lines += [f"ops.{name}({', '.join(map(_literal, rest))})" for name, *rest in commands]
        else:
            lines += ["wipe"]
            for name, *rest in commands:
                line = " ".join((name, *map(_number, rest)))
                if name == "pattern":
                    line += " {"
                lines.append("    " + line + "\n}" if name == "load" else line)
        return "\n".join(lines) + "\n"

    def _arguments(self, material: Material) -> list[tuple[str, float, str]]:
        """Return names, values and units of the arguments of a material in OpenSees."""
        if material == "Hysteretic":
            sides = (1, 1, 1, -1, -1, -1)
            found = []
            for i, ((m, t), sign) in enumerate(zip(self._points, sides, strict=True)):
                name = f"{i % 3 + 1}{'p' if sign > 0 else 'n'}"
                found += [(f"s{name}", sign * m, "N m"), (f"e{name}", sign * t, "rad")]
            own = {"pinchX": self.pinch_rotation, "pinchY": self.pinch_moment, "damage1": 0.0}
            own |= {"damage2": self.damage, "beta": self.unloading}
            return [*found, *((name, value, "") for name, value in own.items())]
        plus, minus = self._of_peak_oriented
        found = [("Ke", 0.5 * (plus.stiffness + minus.stiffness), "N m/rad")]
        for name, each in (("pos", plus), ("neg", minus)):
            found += [
                (f"theta_p_{name}", each.theta_p, "rad"),
                (f"theta_pc_{name}", each.softening_length, "rad"),
                (f"theta_u_{name}", _ULTIMATE, "rad"),
                (f"My_{name}", each.yield_moment, "N m"),
                (f"Mc/My_{name}", each.hardening, ""),
                (f"Mres/My_{name}", 0.0, ""),
            ]
        found += [(f"Lambda_{kind}", self.endurance, "rad") for kind in "SCAK"]
        found += [(f"c_{kind}", 1.0, "") for kind in "SCAK"]
        return [*found, ("D_pos", 1.0, ""), ("D_neg", 1.0, "")]

    def to_pandas(self) -> DataFrame:
        """Return a DataFrame, a row for each backbone."""
        names = {"backbone": "kind", "method": "method", "side": "side"}
        names |= {"K_e_N_m/rad": "stiffness", "M_y_N_m": "yield_moment", "M_c/M_y": "hardening"}
        names |= {f"{name}_rad": name for name in ("theta_y", "theta_p", "theta_pc", "theta_u")}
        each = ({name: getattr(one, key) for name, key in names.items()} for one in self.backbones)
        return data_frame(list(each))

    def __repr__(self) -> str:
        first = self.backbones[2]
        fits = ", ".join(f"{name} nrmse {self.nrmse(name):.3f}" for name in MATERIALS)
        return (
            f"LumpedHinge(M_y {first.yield_moment:.4g} N m, M_c/M_y {first.hardening:.3f}, theta_p "
            f"{first.theta_p:.4g}, theta_pc {first.theta_pc:.4g}; {fits})"
        )


def lumped_hinge(result: ColumnResult) -> LumpedHinge:
    """Return the column of a static path as one hinge at its foot; see `Result.lumped_hinge`."""
    column = result.column
    if result.dynamic or "axial_load" in result.call:
        raise InputError(
            "lumped_hinge: the loop must be a static path under a constant axial load; cyclic "
            "makes one"
        )
    if column.top == "fixed" or column.footing is not None:
        raise InputError(
            "lumped_hinge: the column must be a cantilever on rigid ground; take that of half the "
            "height in place of double curvature"
        )
    rotation, moment = _loop(result)
    backbones = [_backbone("cyclic", envelope((rotation, moment), side)) for side in (1, -1)]
    reach = _BEYOND * column.height * float(np.abs(rotation).max())
    for side in (1, -1):
        run = _push(column, side * reach)
        path = run.displacement / column.height, run.base_moment
        backbones.append(_backbone("monotonic", envelope(path, side)))
    points = [point for each in backbones[:2] for point in _three_points(each)]
    own = _fitted(
        partial(_hysteretic, points),
        ((0.8, 0.2, 0.0, 0.3), (0.5, 0.5, 0.05, 0.5), (0.9, 0.9, 0.02, 0.0)),
        ((0.01, 0.01, 0.0, 0.0), (1.0, 1.0, 1.0, 1.0)),
        rotation,
        moment,
    )
    kinds = {"cyclic": backbones[:2], "monotonic": backbones[2:]}
    tried = {kind: _endurance(pair, rotation, moment) for kind, pair in kinds.items()}
    kind = min(tried, key=lambda name: tried[name][1])
    loop = rotation, moment, column.height, column.axial_load
    return LumpedHinge(*loop, tuple(backbones), *own, tried[kind][0], kind)


def _loop(result: ColumnResult) -> tuple[Array, Array]:
    """Return rotation and moment in equal steps from corner to corner, whatever rows were kept."""
    theta = result.path.displacement / result.column.height
    moment = result.path.base_moment
    largest = np.abs(theta).max() / _STEPS
    counts = np.maximum(1, np.ceil(np.abs(np.diff(theta, prepend=0.0)) / largest)).astype(int)
    ends = np.concatenate(([0], np.cumsum(counts)))
    at = np.arange(1, ends[-1] + 1)
    theta, moment = (np.concatenate(([0.0], values)) for values in (theta, moment))
    return np.interp(at, ends, theta), np.interp(at, ends, moment)


def _push(column: Any, reach: float) -> ColumnResult:
    """Return the push to one side, up to where it can be followed."""
    with unwarned():
        try:
            run: Any = rbsdem.cyclic(
                column, displacement=np.linspace(0, reach, _PUSH_POINTS + 1)[1:]
            )
            # With its corners.
            run = run.path
        except SolveError as error:
            if error.result is None:
                raise
            run = error.result
    found: ColumnResult = run
    return found


def _backbone(kind: str, curve: Envelope) -> HingeBackbone:
    try:
        lines = curve.idealise("asce_41")
    except InputError:
        lines = curve.idealise("park")
    theta, moment = curve.displacement, curve.force
    at = curve.displacement_at_peak
    # A yield point at the cap itself would leave no second line.
    theta_y = min(lines.yield_displacement, 0.98 * at)
    behind = theta > at
    x, y = theta[behind] - at, curve.peak_force - moment[behind]
    x, y = np.concatenate(([0.0], x)), np.concatenate(([0.0], y))
    width = np.diff(x)
    over, under = (float(np.sum(0.5 * (v[1:] + v[:-1]) * width)) for v in (x * y, x**2))
    slope = over / under if under > 0 else 0.0
    lost = slope * _FLAT * at > curve.peak_force
    moments = min(lines.yield_force, curve.peak_force), curve.peak_force
    after = curve.peak_force / slope if lost else math.inf
    turns = at - theta_y, after, curve.largest_displacement
    stiffness = lines.yield_force / theta_y
    return HingeBackbone(kind, lines.method, curve.side, stiffness, *moments, *turns)


def _three_points(each: HingeBackbone) -> list[tuple[float, float]]:
    """Return yield, cap and a point of the softening line, as (moment, rotation)."""
    end = max(each.theta_u, 1.02 * each.theta_c)
    last = each.cap_moment * (1.0 - (end - each.theta_c) / each.softening_length)
    least = 0.02 * each.cap_moment
    if last < least:
        end = each.theta_c + (1.0 - 0.02) * each.softening_length
    return [
        (each.yield_moment, each.theta_y),
        # "Hysteretic" needs a second line.
        (max(each.cap_moment, 1.0001 * each.yield_moment), each.theta_c),
        (max(last, least), end),
    ]


def _fitted(
    make: Callable[[Sequence[float], Array], Array],
    starts: Sequence[Sequence[float]],
    bounds: tuple[Sequence[float], Sequence[float]],
    rotation: Array,
    moment: Array,
) -> tuple[float, float, float, float]:
    """Return the numbers of least squares, of the best of several starts."""
    from scipy import optimize  # noqa: PLC0415

    largest = np.abs(moment).max()
    how: Any = {"bounds": bounds, "diff_step": 1e-3, "max_nfev": 30, "ftol": 1e-4}

    def off(x: Sequence[float]) -> Array:
        return np.asarray((make(x, rotation) - moment) / largest)

    found = [optimize.least_squares(off, start, **how) for start in starts]
    pinch_x, pinch_y, damage, beta = min(found, key=lambda each: float(each.cost)).x.tolist()
    return pinch_x, pinch_y, damage, beta


def _endurance(
    backbones: Sequence[HingeBackbone], rotation: Array, moment: Array
) -> tuple[float, float]:
    """Return Lambda of least squares [rad], and the sum of the squares."""
    from scipy import optimize  # noqa: PLC0415

    def error(log: float) -> float:
        off = _peak_oriented(backbones, math.exp(log)).response(rotation) - moment
        return float((off**2).sum())

    # With less the moment would fall faster than the spring is stiff.
    least = 1.1 * max(
        each.hardening**2 * (1.0 + each.theta_c / each.softening_length) * each.theta_y
        for each in backbones
    )
    tried = math.log(_SIDES * least) + np.linspace(0.0, 9.0, 19)
    best = float(min(tried, key=error))
    ends = max(best - 0.5, float(tried[0])), best + 0.5
    found = optimize.minimize_scalar(error, bounds=ends, method="bounded")
    return math.exp(float(found.x)), float(found.fun)


def _peak_oriented(backbones: Sequence[HingeBackbone], endurance: float) -> PeakOriented:
    """Return the spring with the monotonic backbone; its stiffness is the mean of both sides."""
    plus, minus = backbones
    stiffness = 0.5 * (plus.stiffness + minus.stiffness)
    d_y, d_n = (each.yield_moment / stiffness for each in (plus, minus))
    ratio = endurance * (plus.yield_moment + minus.yield_moment)
    ratio /= plus.yield_moment * d_y + minus.yield_moment * d_n
    given: dict[str, Any] = {f"lambda_{kind}": ratio for kind in "scka"}
    for end, each, at in (("", plus, d_y), ("_neg", minus, d_n)):
        given |= {f"d_y{end}": at, f"f_y{end}": each.yield_moment}
        given |= {f"d_cap{end}": at + each.theta_p, f"f_cap{end}": each.cap_moment}
        given[f"d_pc{end}"] = each.softening_length
    return PeakOriented(**given)


#: Yield, cap and a point of the softening line: (moment, rotation).
def _hysteretic(
    points: Sequence[tuple[float, float]], own: Sequence[float], rotation: Array
) -> Array:
    """Return the moments of "Hysteretic" of OpenSees along a path, in steps of its size."""
    spring, largest = _Hysteretic(points, own), np.abs(rotation).max() / _STEPS
    found = np.empty(rotation.size)
    for i, target in enumerate(rotation.tolist()):
        begin, count = spring.strain, max(1, math.ceil(abs(target - spring.strain) / largest))
        for k in range(1, count + 1):
            spring.step(begin + (target - begin) * k / count)
        found[i] = spring.moment
    return found


class _Hysteretic:
    """The material "Hysteretic" of OpenSees.

    After its source (HystereticMaterial.cpp, M. Scott and F. Filippou), `damage1` left out. The
    negative side is followed as the positive one of the mirrored material.
    """

    def __init__(self, points: Sequence[tuple[float, float]], own: Sequence[float]) -> None:
        self.pinch_x, self.pinch_y, self.damage, self.beta = map(float, own)
        self.curves = points[:3], points[3:]
        self.first = [side[0][0] / side[0][1] for side in self.curves]
        self.energy_a = sum(
            0.5 * (t1 - t0) * (m1 + m0)
            for side in self.curves
            for (m0, t0), (m1, t1) in zip(((0.0, 0.0), *side[:2]), side, strict=True)
        )
        # Largest rotation and where unloading ends, of either side and counted to it.
        self.reached, self.zero = [0.0, 0.0], [0.0, 0.0]
        self.strain = self.moment = self.energy = 0.0
        self.heading = -1

    def step(self, new: float) -> None:
        """Go to a rotation."""
        step = new - self.strain
        if step == 0.0:
            return
        side, sign = (0, 1.0) if step > 0 else (1, -1.0)
        at, force, go = sign * new, sign * self.moment, abs(step)
        if at >= self.reached[side]:
            self.reached[side], value = at, self._stress(side, at)
        else:
            value = self._inside(side, at, force, go)
        self.heading = side
        self.energy += 0.5 * (force + value) * go
        self.strain, self.moment = new, sign * value

    def _stress(self, side: int, strain: float) -> float:
        (m1, t1), (m2, t2), (m3, t3) = self.curves[side]
        if strain <= 0.0:
            return 0.0
        if strain <= t1:
            return m1 / t1 * strain
        if strain <= t2:
            return m1 + (m2 - m1) / (t2 - t1) * (strain - t1)
        return m2 + (m3 - m2) / (t3 - t2) * (strain - t2) if strain <= t3 else m3

    def _inside(self, side: int, at: float, force: float, go: float) -> float:
        """Return the moment of a step to a side inside of the envelopes, counted to that side."""
        reached, zero, other, first = self.reached, self.zero, 1 - side, self.first
        yields = [each[0][1] for each in self.curves]
        soft = [max(1.0, math.pow(reached[each] / yields[each], self.beta)) for each in (0, 1)]
        unload, load = first[other] / soft[other], first[side] / soft[side]
        if self.heading == other and force <= 0.0:
            zero[side] = at - go - force / unload
            lost = 0.0
            if reached[other] > yields[other]:
                lost = self.damage * (self.energy - 0.5 * force / unload * force) / self.energy_a
            reached[side] *= 1.0 + lost
        reached[side] = max(reached[side], yields[side])
        top, pinch_y = self._stress(side, reached[side]), self.pinch_y
        start = max(zero[side], -self._limit(other))
        corner = reached[side] - (1.0 - pinch_y) * top / load
        corner = start + (corner - start) * self.pinch_x
        if at < zero[side]:
            return min(force + unload * go, 0.0)
        if at < corner:
            if at <= start:
                return 0.0
            return min(force + load * go, (at - start) * top * pinch_y / (corner - start))
        slope = (1.0 - pinch_y) * top / (reached[side] - corner)
        return min(force + load * go, pinch_y * top + (at - corner) * slope)

    def _limit(self, side: int) -> float:
        """Return where the softening line of a side is at zero, infinity if it is not beyond it."""
        (_, t1), (m2, t2), (m3, t3) = self.curves[side]
        slope, strain = (m3 - m2) / (t3 - t2), self.reached[side]
        if strain <= t1 or strain <= t2 or slope >= 0.0:
            return math.inf
        zero = t2 - m2 / slope
        return math.inf if self._stress(side, zero) > 0.0 else zero


def _number(value: object) -> str:
    return f"{value:.8g}" if isinstance(value, float) else str(value)


def _literal(value: object) -> str:
    return repr(float(_number(value))) if isinstance(value, float) else repr(value)


def draw(hinge: LumpedHinge, material: Material = "Hysteretic", *, ax: Axes | None = None) -> Axes:
    """Draw the loop of a column, and dashed that of the hinge of OpenSees fitted to it.

    Parameters
    ----------
    hinge : LumpedHinge
        What `lumped_hinge` returns.
    material : {"Hysteretic", "IMKPeakOriented"}, optional
        The material of the hinge.
    ax : matplotlib Axes, optional
        Where to draw; a new figure without it.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    fitted = hinge.response(material)
    with plot.axes_or_new(ax) as drawn:
        x = np.concatenate(([0.0], hinge.rotation)) * 1e3
        for moment, line, label in (
            (hinge.moment, plot.MODEL_LINE, "column"),
            (fitted, plot.TEST_LINE, f"{material}, nrmse {hinge.nrmse(material):.3f}"),
        ):
            drawn.plot(x, np.concatenate(([0.0], moment)) * 1e-3, **line, label=label)
        drawn.legend(loc="lower right")
        drawn.set(xlabel="Chord rotation (mrad)", ylabel="Moment at the base (kN m)")
    return drawn
