"""Acceptance of the members of a frame: demands at their ends over the limits of a code.

ASCE 41-17: plastic rotations of beams (table 10-7, row i or ii) and columns (tables 10-8, 10-9),
and shear. EN 1998-3:2005: chord rotations (A.1, A.10b) and shear (A.12). Where a code does not
cover a member, its row says why.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple, Protocol, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame
from rbsdem.checks import formulas
from rbsdem.errors import InputError
from rbsdem.model.frame_result import FrameResult
from rbsdem.model.shape import Section, TeeSection
from rbsdem.section.axial_moment import nominal_moment

AcceptanceCode = Literal["asce_41", "en_1998_3"]

#: Levels of each code, from the strictest.
LEVELS: dict[str, tuple[str, ...]] = {
    "asce_41": ("IO", "LS", "CP"),
    "en_1998_3": ("DL", "SD", "NC"),
}

#: Table 10-7, row i: a, b, IO by detailing ("C" or not), (rho - rho')/rho_bal (up to 0, from 0.5)
#: and shear (up to 0.25, from 0.5 sqrt(f'c) MPa). LS = a and CP = b.
_FLEXURE = {
    True: (
        ((0.025, 0.05, 0.010), (0.02, 0.04, 0.005)),
        ((0.02, 0.03, 0.005), (0.015, 0.02, 0.005)),
    ),
    False: (
        ((0.02, 0.03, 0.005), (0.01, 0.015, 0.0015)),
        ((0.01, 0.015, 0.005), (0.005, 0.01, 0.0015)),
    ),
}
#: Row ii, members controlled by shear: IO, LS, CP by stirrups at d/2 or closer.
_SHEAR = {True: (0.0015, 0.01, 0.02), False: (0.0015, 0.005, 0.01)}
#: gamma_el of primary members: of (A.1) and of (A.12).
_PRIMARY = (1.5, 1.15)


class HasTarget(Protocol):
    """What has a displacement in the rows of a push-over, as `rbsdem.codes.Target`."""

    @property
    def signed(self) -> float:
        """Displacement of the control node [m]."""

    @property
    def reached(self) -> bool:
        """Whether the push-over goes as far."""


def beam_rotations(
    bars: float, shear: float, *, conforming: bool
) -> tuple[float, float, float, float]:
    """Return a, b, IO and c of beams controlled by flexure (ASCE 41-17, table 10-7, row i).

    Parameters
    ----------
    bars : float
        (rho - rho')/rho_bal.
    shear : float
        V/(b_w d sqrt(f'c)) [sqrt(MPa)].
    conforming : bool
        Whether hoops in the hinge stand at d/3 or closer and carry 3/4 of the shear.
    """
    table = np.array(_FLEXURE[conforming])
    u, w = min(max(bars / 0.5, 0.0), 1.0), min(max((shear - 0.25) / 0.25, 0.0), 1.0)
    a, b, io = (1 - u) * ((1 - w) * table[0, 0] + w * table[0, 1]) + u * (
        (1 - w) * table[1, 0] + w * table[1, 1]
    )
    return float(a), float(b), float(io), 0.2


class _Demand(NamedTuple):
    """What an end of a member undergoes."""

    member: str
    end: str
    column: bool
    length: float
    section: Section
    other: Section
    axial: float
    moment: float
    shear: float
    rotation: float
    span: float


def demands(result: FrameResult, rows: Array) -> list[_Demand]:
    """Return the demands of all ends that have a section, largest to each side of some rows.

    Parameters
    ----------
    result : FrameResult
        The result.
    rows : ndarray of float
        Rows; between two of them with the share of the way.
    """
    at, frame = np.arange(result.time.size), result.frame

    def of(values: Array) -> Array:
        """Return what a member has in the rows."""
        return np.column_stack([np.interp(rows, at, one) for one in np.atleast_2d(values.T)])

    found = []
    for i, (name, one) in enumerate(frame.geometry.items()):
        sections, length = frame.kinds[name].sections, one.clear
        if sections is None:
            continue
        axial, turned = of(result.member_axial[:, i])[:, 0], of(result.chord_rotation[:, i])
        ends = of(np.column_stack((result.moment_from[:, i], result.moment_to[:, i]))).T
        sway = ends.sum(axis=0) / length
        for j, moments in enumerate(ends):
            rotation, shear = turned[:, j], np.abs(one.shear(ends[0], ends[1], float(j)))
            for side in (1.0, -1.0):
                row = int((side * rotation).argmax())
                if side * rotation[row] <= 0:
                    continue
                # Clockwise at the start stretches the right side, at the end the left one.
                left = (side > 0) == bool(j)
                near = sections[j] if left else sections[j].mirrored
                far = sections[1 - j].mirrored if left else sections[1 - j]
                most = max(1.5 * near.depth, 1e-9)
                moved = abs(float(moments[row])) / max(abs(float(sway[row])), 1e-9)
                found.append(
                    _Demand(
                        name, ("start", "end")[j], one.upright, length, near, far,
                        float(axial[row]), abs(float(moments[row])), float(shear.max()),
                        abs(float(rotation[row])), min(max(moved, most), max(length, most)),
                    )
                )  # fmt: skip
    return found


@dataclass(frozen=True)
class _Limits:
    """Limits of an end: total or plastic rotations by level, and the strength in shear."""

    demand: float
    yielding: float
    rotations: tuple[float, ...]
    shear: float
    source: str


def _asce_41(d: _Demand, knowledge: float) -> _Limits:
    load = max(d.axial, 0.0)
    section = d.section
    moment = nominal_moment(section, load if d.column else 0.0)
    opposite = nominal_moment(d.other, load if d.column else 0.0)
    law, fc = section.concrete_law, section.concrete.fc / 1e6
    gross, ties = section.gross_area, section.ties
    ratio = load / (gross * section.concrete.fc)
    stiffness = formulas.asce_41_stiffness(ratio) if d.column else 0.3
    yielding = moment * d.length / (6.0 * stiffness * law["ec"] * section.inertia)
    plastic = max(d.rotation - yielding, 0.0)
    at_yield = (moment + opposite) / d.length
    width, depth = 1e3 * section.web_width, 1e3 * section.effective_depth
    legs = ties.legs * math.pi * (1e3 * ties.diameter) ** 2 / 4.0 if ties else 0.0
    spacing = 1e3 * ties.spacing if ties else math.inf
    hoops = legs * (ties.steel.fy / 1e6 if ties else 0.0) * depth / spacing
    if d.column:
        if isinstance(section, TeeSection):
            raise InputError("columns with a flange are not in tables 10-8 and 10-9")
        q = formulas.quantities(section, d.span, load)
        if q.tie_ratio < 0.0005:
            raise InputError(f"rho_t = {q.tie_ratio:.2g} is below 0.0005, where table 10-8 begins")
        strength = formulas.asce_41_shear_strength(q)
        turned = formulas.asce_41_rotations(
            q.axial_load_ratio, q.tie_ratio, at_yield / strength, q.fc, q.fyt, circle=q.round
        )
        mu = d.rotation / yielding
        strength = formulas.asce_41_shear_strength(q, mu)
        limits: tuple[float, ...] = (turned.io, turned.ls, turned.cp)
        source = f"table {'10-9' if q.round else '10-8'}"
    else:
        # ACI 318-19, 22.5.5.1 with the least concrete term of members with stirrups.
        strength = 0.17 * math.sqrt(fc) * width * depth + hoops
        if at_yield > strength:
            limits, source = _SHEAR[spacing <= 0.5 * depth], "table 10-7 ii"
        else:
            steel = section.bars[0][2]
            pulled, pressed = section.tension_steel, section.mirrored.tension_steel
            beta = min(max(0.85 - 0.05 * (fc - 28.0) / 7.0, 0.65), 0.85)
            fy = steel.fy / 1e6
            balanced = 0.85 * beta * fc / fy * 0.003 / (0.003 + steel.fy / steel.es)
            bars = 1e6 * (pulled - pressed) / (width * depth) / balanced
            stress = at_yield / (width * depth * math.sqrt(fc))
            sound = spacing <= depth / 3.0 and hoops >= 0.75 * at_yield
            a, b, io, _ = beam_rotations(bars, stress, conforming=sound)
            limits, source = (io, a, b), f"table 10-7 i {'C' if sound else 'NC'}"
    return _Limits(
        plastic, yielding, tuple(knowledge * one for one in limits), knowledge * strength, source
    )


def _en_1998_3(d: _Demand, primary: bool) -> _Limits:
    if d.section.shape != "rectangle":
        raise InputError(f"annex A has no relations for this section ({d.section.shape})")
    turned, sheared = _PRIMARY if primary else (1.0, 1.0)
    q = formulas.quantities(d.section, d.span, max(d.axial, 0.0))
    cracked = formulas.ec_8_cracks_in_shear(q)
    yielding = formulas.ec_8_yield_rotation(q, cracked=cracked)
    ultimate = formulas.ec_8_ultimate_rotation(q) / turned
    beyond = max(d.rotation / yielding - 1.0, 0.0)
    strength = formulas.ec_8_shear_resistance(q, beyond) / sheared
    limits = (yielding, 0.75 * ultimate, ultimate)
    return _Limits(d.rotation, yielding, limits, strength, "A.1, A.10b, A.12")


@dataclass(frozen=True, repr=False, eq=False)
class Assessment(Tabular):
    """Members of a frame beside the limits of a code.

    Attributes
    ----------
    code : str
        "asce_41" or "en_1998_3".
    levels : tuple of str
        Its levels, from the strictest.
    result : FrameResult
        What was assessed.
    displacement : float or None
        Displacement of the control node there [m]; None: the envelope of all rows.
    rows : list of dict
        A row for each end and side; see `to_pandas`.
    """

    code: str
    levels: tuple[str, ...]
    result: FrameResult
    displacement: float | None
    rows: list[dict[str, Any]]

    def to_pandas(self) -> DataFrame:
        """Return a row for each end and each side that it turned to.

        Demand (plastic or chord rotation), rotation at yield, limits, and ratios of rotation and of
        shear; `status` is "evaluated", or why the code does not cover the end. NaN is no ratio.
        """
        return data_frame(self.rows)

    def worst(self, count: int = 10, level: str | None = None) -> DataFrame:
        """Return the ends with the largest ratios.

        Parameters
        ----------
        count : int, optional
            How many.
        level : str, optional
            The level, by default the last.
        """
        name = self._level(level)
        frame = self.to_pandas()
        frame["ratio"] = frame[[f"ratio_{name}", "ratio_shear"]].max(axis=1)
        columns = [
            "member",
            "end",
            "demand_rad",
            f"limit_{name}_rad",
            f"ratio_{name}",
            "ratio_shear",
        ]
        columns = [*columns, "ratio", "governed_by"]
        return (
            frame.sort_values("ratio", ascending=False)[columns].head(count).reset_index(drop=True)
        )

    def counts(self) -> dict[str, int]:
        """Return how many ends are beyond each level, beyond their shear, and not covered."""
        frame = self.to_pandas()
        found = {name: int((frame[f"ratio_{name}"] > 1.0).sum()) for name in self.levels}
        found["shear"] = int((frame["ratio_shear"] > 1.0).sum())
        found["not evaluated"] = int((frame["status"] != "evaluated").sum())
        return found

    def accepted(self, level: str | None = None) -> bool:
        """Return whether all ends are evaluated and within a level and their shear strength."""
        name, counts = self._level(level), self.counts()
        return not (counts[name] or counts["shear"] or counts["not evaluated"])

    def states(self) -> dict[tuple[str, str], int]:
        """Return the number of levels that each end has passed; -1: not covered."""
        found: dict[tuple[str, str], int] = {}
        for row in self.rows:
            passed = sum(row[f"ratio_{name}"] > 1.0 for name in self.levels)
            if row["ratio_shear"] > 1.0:
                passed = len(self.levels)
            passed = passed if row["status"] == "evaluated" else -1
            at = row["member"], row["end"]
            found[at] = max(found.get(at, -1), passed)
        return found

    def _level(self, level: str | None) -> str:
        name = self.levels[-1] if level is None else level
        return str(_arguments.choice(name, "level", self.levels))

    def __repr__(self) -> str:
        told = ", ".join(
            f"{number} beyond {name}" for name, number in self.counts().items() if number
        )
        where = "envelope" if self.displacement is None else f"{self.displacement:.4g} m"
        return f"Assessment({self.code}, {where}, {len(self.rows)} ends: {told or 'all within'})"


def assess(
    result: FrameResult,
    code: AcceptanceCode = "asce_41",
    *,
    at: float | HasTarget | None = None,
    knowledge: float = 1.0,
    primary: bool = True,
    limits: Mapping[str, Sequence[float]] | None = None,
) -> Assessment:
    """Return the ends of the members of a frame beside the limits of a code.

    Parameters
    ----------
    result : FrameResult
        A push-over or a response in time of a frame from sections.
    code : {"asce_41", "en_1998_3"}, optional
        ASCE 41-17: IO, LS and CP. EN 1998-3:2005, annex A: DL, SD and NC.
    at : Target or float, optional
        Target displacement, or displacement of the control node [m], of a push-over; without it,
        and in time, each end is judged by its envelope.
    knowledge : float, optional
        kappa of ASCE 41, by which its limits are multiplied.
    primary : bool, optional
        Whether members are primary ones of EN 1998-3: gamma_el of 1.5 and 1.15, else 1.
    limits : mapping, optional
        Rotations [rad], one for each level, by names of members, in place of those of the code:
        for members that it does not cover, or with splices.

    Returns
    -------
    Assessment
        A row for each end and side.

    Raises
    ------
    InputError
        If the frame has no sections, or the curve ends before the target.

    Notes
    -----
    The rotation of an end is that of its face against the chord of the clear length; the shear span
    is M/V of the end moments, from 1.5 h to the clear length. ASCE 41: plastic rotation beyond
    M_y L/(6 E I) with the nominal moment and the stiffness of table 10-5; a beam whose shear at
    yield is above its strength is one of row ii; splices and embedment (rows iii, iv), the factors
    of force-controlled actions and plastic strains of nodes are left out. Strengths are those of
    the drawing: give expected ones.
    """
    result = _arguments.instance(result, "assess", FrameResult, "as of rbsdem.pushover")
    code = _arguments.choice(code, "assess: code", get_args(AcceptanceCode))
    kappa = _arguments.number(knowledge, "assess: knowledge", above=0.0, most=1.0)
    first = _arguments.boolean(primary, "assess: primary")
    place, rows = _place(result, at)
    found = demands(result, rows)
    if not found:
        raise InputError(
            "assess: the members of the frame have no sections; make it of them, as by "
            "rbsdem.Frame.grid(columns=section, ...)"
        )
    levels, own = LEVELS[code], dict(limits or {})
    for name, values in own.items():
        if name not in result.frame.parts.members or len(tuple(values)) != len(levels):
            raise InputError(
                f"assess: limits of {name!r}: give {len(levels)} rotations of a member of the frame"
            )
    made = []
    for d in found:
        status = "evaluated"
        bound = _Limits(d.rotation, math.nan, (math.nan,) * len(levels), math.nan, "")
        try:
            bound = _asce_41(d, kappa) if code == "asce_41" else _en_1998_3(d, first)
        except InputError as error:
            status = str(error)
        if d.member in own:
            given = tuple(float(one) for one in own[d.member])
            bound = _Limits(
                bound.demand, bound.yielding, given, bound.shear, "limits that were given"
            )
            status = "evaluated"
        ratios = [math.inf if one == 0 else bound.demand / one for one in bound.rotations]
        sheared = d.shear / bound.shear
        made.append(
            {
                "member": d.member,
                "end": d.end,
                "axial_N": d.axial,
                "moment_Nm": d.moment,
                "shear_N": d.shear,
                "shear_span_m": d.span,
                "rotation_rad": d.rotation,
                "yield_rad": bound.yielding,
                "demand_rad": bound.demand,
                **{f"limit_{n}_rad": one for n, one in zip(levels, bound.rotations, strict=True)},
                **{f"ratio_{n}": one for n, one in zip(levels, ratios, strict=True)},
                "shear_strength_N": bound.shear,
                "ratio_shear": sheared,
                "governed_by": "shear" if sheared > np.nan_to_num(ratios[-1]) else "rotation",
                "source": bound.source,
                "status": status,
            }
        )
    return Assessment(code, levels, result, place, made)


def _place(result: FrameResult, at: Any) -> tuple[float | None, Array]:
    """Return the displacement that is judged, and its row, or all rows."""
    every = np.arange(float(result.time.size))
    if at is None:
        return None, every
    if result.dynamic:
        raise InputError("assess: a response in time is judged by its envelope; leave out at")
    if not getattr(at, "reached", True):
        raise InputError("assess: the curve ends before the target; push further")
    wanted = _arguments.number(getattr(at, "signed", at), "assess: at")
    x = result.displacement
    side = 1.0 if x[-1] >= x[0] else -1.0
    beyond = np.flatnonzero(side * x >= side * wanted)
    if not beyond.size:
        raise InputError(
            f"assess: at = {wanted:g} m is beyond the end of the push-over, {x[-1]:.4g} m"
        )
    row = int(beyond[0])
    if row and x[row] != x[row - 1]:
        return wanted, np.array([row - 1 + (wanted - x[row - 1]) / (x[row] - x[row - 1])])
    return wanted, np.array([float(row)])
