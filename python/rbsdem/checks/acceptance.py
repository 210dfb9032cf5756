"""Acceptance of the members and joints of a frame: their demands over the limits of a code.

ASCE 41-17: plastic rotations of beams (table 10-7, row i or ii) and columns (tables 10-8, 10-9),
and shear. EN 1998-3:2005: chord rotations (A.1, A.10b), shear (A.12), and shear of joints. Where a
code does not cover a member, its row says why.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from functools import partial
from typing import Any, Literal, NamedTuple, Protocol, get_args

import numpy as np

from rbsdem import _arguments
from rbsdem._files import Tabular, data_frame
from rbsdem._types import Array, DataFrame
from rbsdem.checks import aci_318, asce_41, en_1998, formulas
from rbsdem.errors import InputError
from rbsdem.model.frame import MemberGeometry
from rbsdem.model.shape import RectangularSection, Section, TeeSection
from rbsdem.run.building_result import BuildingResult
from rbsdem.run.frame_result import FAILS, FrameResult
from rbsdem.section.frame import Frame
from rbsdem.section.quantities import quantities
from rbsdem.section.strength import nominal_moment

AcceptanceCode = Literal["asce_41", "en_1998_3"]

#: Levels of each code, from the strictest.
LEVELS: dict[str, tuple[str, ...]] = {
    "asce_41": ("IO", "LS", "CP"),
    "en_1998_3": ("DL", "SD", "NC"),
}

#: gamma_el of primary members: of (A.1) and of (A.12).
_PRIMARY = (1.5, 1.15)


class HasTarget(Protocol):
    """A record with a displacement in the rows of a push-over, as `rbsdem.codes.Target`."""

    @property
    def signed(self) -> float:
        """Displacement of the control node [m]."""

    @property
    def reached(self) -> bool:
        """Whether the push-over goes as far."""


class _Demand(NamedTuple):
    """Forces and rotation of an end of a member, or of a joint of a column and a beam."""

    member: str
    end: str
    face: str
    kind: Literal["column", "beam", "interior joint", "exterior joint"]
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

    Those of the joints follow.

    Parameters
    ----------
    result : FrameResult
        The result.
    rows : ndarray of float
        Rows; 3.5 is half way between rows 3 and 4.
    """
    frame, of = result.frame, partial(between, rows)
    demands_of_ends = []
    for i, (name, member) in enumerate(frame.geometry.items()):
        sections, length = frame.kinds[name].sections, member.clear
        if sections is None:
            continue
        axial, turned = of(result.member_axial[:, i])[:, 0], of(result.chord_rotation[:, i])
        ends = of(np.column_stack((result.moment_from[:, i], result.moment_to[:, i]))).T
        sway = ends.sum(axis=0) / length
        for j, moments in enumerate(ends):
            rotation, shear = turned[:, j], np.abs(member.shear(ends[0], ends[1], float(j)))
            for side in (1.0, -1.0):
                row = int((side * rotation).argmax())
                if side * rotation[row] <= 0:
                    continue
                # Clockwise at the start stretches the right side, at the end the left one.
                left = (side > 0) == bool(j)
                across = member.axis[::-1] * (-1, 1) * (1 if left else -1)
                near = sections[j] if left else sections[j].mirrored
                far = sections[1 - j].mirrored if left else sections[1 - j]
                most = max(1.5 * near.depth, 1e-9)
                moved = abs(float(moments[row])) / max(abs(float(sway[row])), 1e-9)
                demands_of_ends.append(
                    _Demand(
                        name, ("start", "end")[j], _face(across, member.upright),
                        "column" if member.upright else "beam", length, near, far,
                        float(axial[row]), abs(float(moments[row])), float(shear.max()),
                        abs(float(rotation[row])), min(max(moved, most), max(length, most)),
                    )
                )  # fmt: skip
    return [*demands_of_ends, *_joints(result, rows)]


def _face(way: Array, upright: bool) -> str:
    """Return the face of a member that lies in a direction `way`, along x and upward."""
    if upright:
        return "right" if way[0] > 0 else "left"
    return "top" if way[1] > 0 else "bottom"


def between(rows: Array, values: Array) -> Array:
    """Return the columns of an array in some rows; row 3.5 is half way between rows 3 and 4.

    Parameters
    ----------
    rows : ndarray of float
        The rows.
    values : ndarray, shape (rows,) or (rows, columns)
        The array.
    """
    at = np.arange(len(values))
    return np.column_stack([np.interp(rows, at, column) for column in np.atleast_2d(values.T)])


def _joints(result: FrameResult, rows: Array) -> Iterator[_Demand]:
    """Yield the demands of the nodes in which drawn columns and beams meet.

    The shear is that of the beams' moments at the faces of the column over 0.9 d, less that of the
    column above; the rotation is that of a panel beyond its yield.
    """
    frame, parts, of = result.frame, result.frame.parts, partial(between, rows)
    springs = parts.springs_of("flexure")
    panels = [spring.member if spring.group == "panel" else "" for spring in springs]
    for node, name in enumerate(parts.nodes):
        columns: list[tuple[int, int, MemberGeometry, Section]] = []
        beams: list[tuple[int, int, MemberGeometry, Section]] = []
        for i, (member, geometry) in enumerate(frame.geometry.items()):
            for j, section in enumerate(frame.kinds[member].sections or ()):
                if (geometry.start, geometry.end)[j] == node:
                    (columns if geometry.upright else beams).append((i, j, geometry, section))
        if not columns or not beams:
            continue
        column = max((column[3] for column in columns), key=lambda drawn: drawn.depth)
        thrust, moment = np.zeros(rows.size), np.zeros(rows.size)
        for i, j, geometry, section in beams:
            ends = of(result.moment_from[:, i])[:, 0], of(result.moment_to[:, i])[:, 0]
            share = max(0.5 * column.depth - geometry.rigid[j], 0.0) / geometry.clear
            faced = geometry.moment(*ends, abs(j - share)) * (1.0 - 2.0 * j)
            arm = 0.9 * min(section.effective_depth, section.mirrored.effective_depth)
            thrust, moment = thrust + faced / arm, moment + faced
        axial = np.zeros(rows.size)
        for i, _, geometry, _ in columns:
            if max(parts.y[geometry.start], parts.y[geometry.end]) > parts.y[node]:
                ends = of(result.moment_from[:, i])[:, 0], of(result.moment_to[:, i])[:, 0]
                thrust, axial = (
                    thrust + geometry.shear(*ends, 0.5),
                    of(result.member_axial[:, i])[:, 0],
                )
        turned = math.nan
        if name in panels:
            turns = of(result.springs["rotation"][:, panels.index(name)])[:, 0]
            spring = parts.springs_of("flexure")[panels.index(name)]
            yields = [m.deformation for m in frame.landmarks[spring] if m.name == "yield"]
            turned = max(float(np.abs(turns).max()) - min(yields, default=0.0), 0.0)
        beam = max((beam[3] for beam in beams), key=lambda drawn: drawn.depth)
        row = int(np.abs(thrust).argmax())
        yield _Demand(
            name, "panel" if name in panels else "joint", "",
            "interior joint" if len(beams) > 1 else "exterior joint", math.nan, column, beam,
            float(axial[row]), abs(float(moment[row])), abs(float(thrust[row])), turned, math.nan,
        )  # fmt: skip


@dataclass(frozen=True)
class _Limits:
    """Limits of an end: total or plastic rotations by level, and the strength in shear."""

    demand: float
    yielding: float
    rotations: tuple[float, ...]
    shear: float
    source: str


def _asce_41(d: _Demand, knowledge: float) -> _Limits:
    """Return the limits of an end by chapter 10 of ASCE 41-17; `knowledge` is its factor kappa.

    The clauses take sizes in mm and stresses in MPa.
    """
    if "joint" in d.kind:
        raise InputError("table 10-11 is not built in; give limits of the node")
    load = max(d.axial, 0.0)
    section = d.section
    moment = nominal_moment(section, load if d.kind == "column" else 0.0)
    opposite = nominal_moment(d.other, load if d.kind == "column" else 0.0)
    law, fc = section.concrete_law, section.concrete.fc / 1e6
    gross, ties = section.gross_area, section.ties
    ratio = load / (gross * section.concrete.fc)
    stiffness = asce_41.column_stiffness(ratio) if d.kind == "column" else 0.3
    yielding = moment * d.length / (6.0 * stiffness * law["ec"] * section.inertia)
    plastic = max(d.rotation - yielding, 0.0)
    # The shear force at which both ends have their nominal moments.
    at_yield = (moment + opposite) / d.length
    width, depth = 1e3 * section.web_width, 1e3 * section.effective_depth
    legs = ties.legs * math.pi * (1e3 * ties.diameter) ** 2 / 4.0 if ties else 0.0
    spacing = 1e3 * ties.spacing if ties else math.inf
    hoops = aci_318.stirrups(legs, ties.steel.fy / 1e6 if ties else 0.0, depth, spacing)
    if d.kind == "column":
        if isinstance(section, TeeSection):
            raise InputError("columns with a flange are not in tables 10-8 and 10-9")
        q = quantities(section, d.span, load)
        if q.tie_ratio < 0.0005:
            raise InputError(f"rho_t = {q.tie_ratio:.2g} is below 0.0005, where table 10-8 begins")
        strength = formulas.asce_41_shear_strength(q)
        turned = asce_41.column_rotations(
            q.axial_load_ratio, q.tie_ratio, at_yield / strength, q.fc, q.fyt, circle=q.round
        )
        mu = d.rotation / yielding
        strength = formulas.asce_41_shear_strength(q, mu)
        limits: tuple[float, ...] = (turned.io, turned.ls, turned.cp)
        source = f"table {'10-9' if q.round else '10-8'}"
    else:
        strength = aci_318.one_way_shear(fc, width, depth) + hoops
        if at_yield > strength:
            limits = asce_41.shear_controlled_rotations(spacing / depth)
            source = "table 10-7 ii"
        else:
            steel = section.bars[0][2]
            pulled, pressed = section.tension_steel, section.mirrored.tension_steel
            balanced = aci_318.balanced_ratio(fc, steel.fy / 1e6, steel.es / 1e6)
            bars = 1e6 * (pulled - pressed) / (width * depth) / balanced
            stress = at_yield / (width * depth * math.sqrt(fc))
            sound = spacing <= depth / 3.0 and hoops >= 0.75 * at_yield
            a, b, io, _ = asce_41.beam_rotations(bars, stress, conforming=sound)
            limits, source = (io, a, b), f"table 10-7 i {'C' if sound else 'NC'}"
    return _Limits(
        plastic,
        yielding,
        tuple(knowledge * limit for limit in limits),
        knowledge * strength,
        source,
    )


def _en_1998_3(d: _Demand, primary: bool, detailing: float = 1.0) -> _Limits:
    """Return the limits of an end by annex A of EN 1998-3.

    `primary`: whether gamma_el is that of primary members; `detailing`: a factor of the ultimate
    rotation for members without seismic detailing.
    """
    if "joint" in d.kind:
        return _ec_8_joint(d)
    if d.section.shape != "rectangle":
        raise InputError(f"annex A has no relations for this section ({d.section.shape})")
    turned, sheared = _PRIMARY if primary else (1.0, 1.0)
    load = max(d.axial, 0.0) if d.kind == "column" else 0.0
    q = quantities(d.section, d.span, load)
    cracked = formulas.ec_8_cracks_in_shear(q)
    yielding = formulas.ec_8_yield_rotation(q, cracked=cracked)
    ultimate = detailing * formulas.ec_8_ultimate_rotation(q) / turned
    beyond = max(d.rotation / yielding - 1.0, 0.0)
    strength = formulas.ec_8_shear_resistance(q, beyond) / sheared
    limits = (yielding, 0.75 * ultimate, ultimate)
    source = "A.1, A.10b, A.12" if detailing == 1.0 else f"A.1 x {detailing:g}, A.10b, A.12"
    return _Limits(d.rotation, yielding, limits, strength, source)


def _ec_8_joint(d: _Demand) -> _Limits:
    """Return the strength in shear of a joint (EN 1998-1, 5.5.3.3); it has no limit of rotation."""
    column, beam = d.section, d.other
    if not isinstance(column, RectangularSection):
        raise InputError(f"5.5.3.3 has no strength for this column ({column.shape})")
    places, fc = [y for y, _, _ in column.bars], column.concrete.fc
    # (5.34): the wider of column and beam, up to half the depth of the column beyond the other.
    narrow, wide = sorted((column.width, beam.web_width))
    strength = en_1998.joint_strength(
        fc / 1e6, 1e3 * min(wide, narrow + 0.5 * column.depth), 1e3 * (max(places) - min(places)),
        max(d.axial, 0.0) / (column.gross_area * fc), exterior=d.kind == "exterior joint",
    )  # fmt: skip
    return _Limits(d.rotation, math.nan, (math.nan,) * 3, strength, "EN 1998-1, 5.5.3.3, strut")


@dataclass(frozen=True, repr=False, eq=False)
class Assessment(Tabular):
    """Members and joints of a frame beside the limits of a code.

    Attributes
    ----------
    code : str
        "asce_41" or "en_1998_3".
    levels : tuple of str
        Its levels, from the strictest.
    result : FrameResult or BuildingResult
        What was assessed.
    displacement : float or None
        Displacement of the control node there [m]; None: the envelope of all rows.
    rows : list of dict
        A row for each end and side; see `to_pandas`.
    detailing : float
        Factor of the ultimate rotations of EN 1998-3.
    """

    code: str
    levels: tuple[str, ...]
    result: Any
    displacement: float | None
    rows: list[dict[str, Any]]
    detailing: float = 1.0

    @property
    def assumed(self) -> str:
        """Assumptions of the limits, in a sentence."""
        if self.code == "asce_41":
            return "Splices and anchorages are sound (table 10-7, rows iii and iv, are not judged)."
        if self.detailing == 1.0:
            return (
                "Members have seismic detailing and ribbed bars; EN 1998-3 lowers the rotations of "
                "others (detailing= takes the factor)."
            )
        return f"Ultimate rotations are {self.detailing:g} times those of detailed members."

    def to_pandas(self) -> DataFrame:
        """Return a row for each end and each face that was in tension, and one for each joint.

        Demand (plastic or chord rotation), rotation at yield, limits, and ratios of rotation and of
        shear; `status` is "evaluated", or why the code does not cover the end. NaN is no ratio.
        """
        return data_frame(self.rows)

    def worst(self, count: int = 10, level: str | None = None) -> DataFrame:
        """Return the ends and joints with the largest ratios.

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
            "face",
            "demand_rad",
            f"limit_{name}_rad",
            f"ratio_{name}",
            "shear_N",
            "shear_strength_N",
            "ratio_shear",
            "ratio",
            "governed_by",
        ]
        return (
            frame.sort_values("ratio", ascending=False)[columns].head(count).reset_index(drop=True)
        )

    def counts(self) -> dict[str, int]:
        """Return how many ends and joints exceed each level and their shear strength.

        The last number is that of those which the code does not cover. An end counts once, whatever
        its two sides and their rows are.
        """

        def number(exceeds: Callable[[dict[str, Any]], bool]) -> int:
            return len({(row["member"], row["end"]) for row in self.rows if exceeds(row)})

        numbers = {
            name: number(lambda row, key=f"ratio_{name}": row[key] > 1.0)  # type: ignore[misc]
            for name in self.levels
        }
        numbers["shear"] = number(lambda row: row["ratio_shear"] > 1.0)
        numbers["not evaluated"] = number(lambda row: row["status"] != "evaluated")
        return numbers

    def accepted(self, level: str | None = None) -> bool:
        """Return whether all ends are evaluated, and none exceeds a level or its shear strength."""
        name, counts = self._level(level), self.counts()
        return not (counts[name] or counts["shear"] or counts["not evaluated"])

    def states(self) -> dict[tuple[str, str], int]:
        """Return the number of levels that each end exceeds; -1: not covered.

        An end that exceeds its shear strength exceeds all levels.
        """
        highest: dict[tuple[str, str], int] = {}
        for row in self.rows:
            exceeded = sum(row[f"ratio_{name}"] > 1.0 for name in self.levels)
            if row["ratio_shear"] > 1.0:
                exceeded = len(self.levels)
            exceeded = exceeded if row["status"] == "evaluated" else -1
            at = row["member"], row["end"]
            highest[at] = max(highest.get(at, -1), exceeded)
        return highest

    def frame(self, name: str) -> Assessment:
        """Return what was found of one frame of a building, for the figures of frames.

        Columns that stand in two planes have only the row of this plane.

        Parameters
        ----------
        name : str
            Of the frame: "x-1", or as it was given.

        Raises
        ------
        InputError
            If there is no such frame.
        """
        if not isinstance(self.result, BuildingResult):
            raise InputError("assess: it is of a frame, not of a building; take it as it is")
        start, result = f"{name}:", self.result.frame(name)
        rows = [
            row | {"member": row["member"].removeprefix(start)}
            for row in self.rows
            if row["member"].startswith(start) and row["face"] != BOTH
        ]
        return replace(self, result=result, rows=rows)

    @property
    def warnings(self) -> tuple[str, ...]:
        """Explanations that a reader needs: of axial failure, and of strength in shear."""
        return (*self._axial_failures(), *self._sheared())

    def _axial_failures(self) -> tuple[str, ...]:
        """Return a warning of members that may have lost their axial load by the judged rows."""
        most = math.inf if self.displacement is None else abs(self.displacement)
        doubtful = self.result.may_have_lost(most)
        if not doubtful:
            return ()
        return (
            f"{', '.join(doubtful)}: failed in shear, and beyond the lower end of the interval of "
            "the drift at axial failure: at least one test of ten has lost its axial load there.",
        )

    def _sheared(self) -> tuple[str, ...]:
        """Return a note on shear beyond its strength where no spring fails."""
        sheared = {
            (row["member"], row["end"])
            for row in self.rows
            if row["ratio_shear"] > 1.0 and row["end"] in ("start", "end")
        }
        ends = len(sheared)
        most = math.inf if self.displacement is None else abs(self.displacement)
        failures = (failure for failure in self.result.events if failure.name == FAILS)
        if not ends or any(abs(failure.displacement) <= most for failure in failures):
            return ()
        annex = " (A.12: over gamma_el, with a fifth of the concrete from L_V = 5 h on)"
        annex = "" if self.code == "asce_41" else annex
        return (
            f"Shear exceeds its strength at {ends} ends, and no spring fails in shear: the code "
            f"has a lower bound that falls with ductility{annex}, the springs the mean of tests.",
        )

    @property
    def source(self) -> str:
        """Name of the code."""
        return {"asce_41": "ASCE 41-17", "en_1998_3": "EN 1998-3:2005"}[self.code]

    def _level(self, level: str | None) -> str:
        """Return the checked name of a level; None is the last one, nearest to collapse."""
        name = self.levels[-1] if level is None else level
        return str(_arguments.choice(name, "level", self.levels))

    def __repr__(self) -> str:
        told = ", ".join(
            (f"{number} {name}" if name == "not evaluated" else f"{number} exceed {name}")
            for name, number in self.counts().items()
            if number
        )
        where = "envelope"
        if self.displacement is not None:
            # As targets do, from where the dead load stands.
            moved = abs(self.displacement - float(self.result.displacement[0]))
            where = f"{moved:.4g} m beyond the dead load"
        parts = {(row["member"], row["end"]) for row in self.rows}
        ends = sum(end in ("start", "end") for _, end in parts)
        joints = f" and {len(parts) - ends} joints" if len(parts) > ends else ""
        return (
            f"Assessment({self.code}, {where}, {ends} ends{joints}: {told or 'no level exceeded'})"
        )

    def __str__(self) -> str:
        return "\n".join((repr(self), *self.warnings))


#: The plane of a row that judges a column by both of its planes.
BOTH = "both planes"


def assess(
    result: FrameResult | BuildingResult,
    code: AcceptanceCode = "asce_41",
    *,
    at: float | HasTarget | None = None,
    knowledge: float = 1.0,
    primary: bool = True,
    detailing: float = 1.0,
    limits: Mapping[str, Sequence[float]] | None = None,
) -> Assessment:
    """Return the ends of the members of a frame, or a building, beside the limits of a code.

    Parameters
    ----------
    result : FrameResult or BuildingResult
        A push-over or a response in time of a frame from sections. The frames of a building are
        judged each, and the ends of its columns in two planes by both in addition.
    code : {"asce_41", "en_1998_3"}, optional
        ASCE 41-17: IO, LS and CP. EN 1998-3:2005, annex A: DL, SD and NC.
    at : Target or float, optional
        Target displacement, or displacement of the control node [m], of a push-over; without it,
        and in time, each end is judged by its envelope.
    knowledge : float, optional
        kappa of ASCE 41, by which its limits are multiplied.
    primary : bool, optional
        Whether members are primary ones of EN 1998-3: gamma_el of 1.5 and 1.15, else 1.
    detailing : float, optional
        Factor of the ultimate chord rotations of EN 1998-3, as for members without seismic
        detailing or with smooth bars; 1 takes them as detailed, with ribbed bars.
    limits : mapping, optional
        Rotations [rad], one for each level, by names of members and nodes or patterns of them (the
        last that fits counts), in place of those of the code: for members that it does not cover,
        with splices, and for panels of nodes.

    Returns
    -------
    Assessment
        A row for each end and side.

    Raises
    ------
    InputError
        If the frame has no sections, the curve ends before the target, or the limits of a wall are
        not given.

    Notes
    -----
    The rotation of an end is that of its face against the chord of the clear length; the shear span
    is M/V of the end moments, from 1.5 h to the clear length. Beams count as without axial force:
    the compression of beams that grow between columns is not that of a load. ASCE 41: plastic
    rotation beyond M_y L/(6 E I) with the nominal moment and the stiffness of table 10-5; a beam
    whose shear at yield is above its strength is one of row ii; splices and embedment (rows iii,
    iv), the factors of force-controlled actions and the limits of joints (table 10-11) are left
    out: panels of nodes have rows whose limits are to be given, rigid nodes have none. EN 1998-3:
    the shear of each joint beside its strut (EN 1998-1, 5.5.3.3), not its hoops. Strengths are
    those of the drawing: give expected ones. Columns of a building have a row of both planes at
    each end, by the resultant of the ratios, the root of the sum of the squares of the largest of
    each plane: the ellipse that ASCE 41-17 has for moments in two planes, whose largest values in
    time need not come at once. 100 + 30 per cent of them would be less for equal ratios. At a
    target the rotations of its frames are multiplied by `Target.torsion`.
    """
    if not isinstance(result, BuildingResult):
        result = _arguments.instance(result, "assess", FrameResult, "as of rbsdem.pushover")
    code = _arguments.choice(code, "assess: code", get_args(AcceptanceCode))
    kappa = _arguments.number(knowledge, "assess: knowledge", above=0.0, most=1.0)
    first = _arguments.boolean(primary, "assess: primary")
    detailed = _arguments.number(detailing, "assess: detailing", above=0.0, most=1.0)
    if detailed != 1.0 and code != "en_1998_3":
        raise InputError("assess: detailing is for 'en_1998_3'; leave it out")
    place, rows = rows_at(result, at)
    levels, stated = LEVELS[code], limits_given(result.column, code, limits)
    walls = _walls_of(result.column)
    frames = result.frames if isinstance(result, BuildingResult) else {"": result}
    factors = getattr(at, "torsion", {})
    ends = [
        d._replace(member=f"{name}:{d.member}", rotation=d.rotation * factors.get(name, 1.0))
        if name
        else d
        for name, frame in frames.items()
        for d in demands(frame, rows)
    ]
    if code == "asce_41":
        # Joints are judged by their rotation, and a rigid one has none.
        ends = [d for d in ends if d.end != "joint"]
    made = []
    for d in ends:
        status = "evaluated"
        bound = _Limits(d.rotation, math.nan, (math.nan,) * len(levels), math.nan, "")
        try:
            if d.member not in walls:
                bound = _asce_41(d, kappa) if code == "asce_41" else _en_1998_3(d, first, detailed)
        except InputError as error:
            status = str(error)
        if d.member in stated:
            bound = replace(bound, rotations=stated[d.member], source="limits that were given")
            status = "evaluated"
        ratios = [math.inf if limit == 0 else bound.demand / limit for limit in bound.rotations]
        sheared = d.shear / bound.shear
        made.append(
            {
                "member": d.member,
                "end": d.end,
                "face": d.face,
                "axial_N": d.axial,
                "moment_Nm": d.moment,
                "shear_N": d.shear,
                "shear_span_m": d.span,
                "rotation_rad": d.rotation,
                "yield_rad": bound.yielding,
                "demand_rad": bound.demand,
                **{
                    f"limit_{n}_rad": limit
                    for n, limit in zip(levels, bound.rotations, strict=True)
                },
                **{f"ratio_{n}": ratio for n, ratio in zip(levels, ratios, strict=True)},
                "shear_strength_N": bound.shear,
                "ratio_shear": sheared,
                "governed_by": "shear" if sheared > np.nan_to_num(ratios[-1]) else "rotation",
                "source": bound.source,
                "status": status,
            }
        )
    if isinstance(result, BuildingResult):
        made += _both_planes(made, result.building.axial_of, levels)
    return Assessment(code, levels, result, place, made, detailed)


def _walls_of(frame: Frame) -> set[str]:
    """Return the names of the members that are walls."""
    drawn = ((name, kind.sections or ()) for name, kind in frame.kinds.items())
    return {name for name, sections in drawn if any(one.shape == "wall" for one in sections)}


def _both_planes(
    rows: Sequence[dict[str, Any]], axial_of: Mapping[str, str], levels: tuple[str, ...]
) -> Iterator[dict[str, Any]]:
    """Yield a row for each end of a column in two planes: the resultant of their ratios."""
    ratios = ("ratio_shear", *(f"ratio_{name}" for name in levels))
    by_end: dict[tuple[str, str], list[dict[str, Any]]] = {}
    for row in rows:
        by_end.setdefault((row["member"], row["end"]), []).append(row)
    for second, first in axial_of.items():
        for end in ("start", "end"):
            planes = [by_end.get((member, end), []) for member in (first, second)]
            if not all(planes):
                continue
            both: dict[str, Any] = dict.fromkeys(planes[0][0], math.nan)
            for name in ratios:
                # A plane in which no side has a ratio leaves the end without one.
                largest = [np.fmax.reduce([row[name] for row in own]) for own in planes]
                both[name] = float(np.hypot(*largest))
            bad = [row["status"] for own in planes for row in own if row["status"] != "evaluated"]
            sheared = both["ratio_shear"] > np.nan_to_num(both[ratios[-1]])
            both |= {"member": first, "end": end, "face": BOTH, "source": "resultant of the ratios"}
            both |= {"governed_by": "shear" if sheared else "rotation"}
            yield both | {"status": bad[0] if bad else "evaluated"}


def limits_given(frame: Frame, code: AcceptanceCode, limits: Any) -> dict[str, tuple[float, ...]]:
    """Return the limits that were given, by names of members and nodes.

    Parameters
    ----------
    frame, code, limits
        The frame, and the arguments of `assess`.

    Raises
    ------
    InputError
        If the frame has no sections, a limit is wrong or of no member, or a wall has none.
    """
    levels = LEVELS[code]
    known = [name for name, kind in frame.kinds.items() if kind.sections is not None]
    if not known:
        raise InputError(
            "assess: the members of the frame have no sections; make it of them, as by "
            "rbsdem.Frame.grid(columns=section, ...)"
        )
    # A rigid node has no rotation.
    known += [spring.member for spring in frame.parts.springs if spring.group == "panel"]
    stated: dict[str, tuple[float, ...]] = {}
    if not isinstance(limits or {}, Mapping):
        raise InputError(f"assess: limits = {_arguments.shown(limits)} must be a mapping of names")
    for name, values in (limits or {}).items():
        rotations = _arguments.finite_vector(values, f"assess: limits of {name!r}")
        if rotations.size != len(levels) or (np.diff(rotations, prepend=0.0) < 0.0).any():
            raise InputError(
                f"assess: limits of {name!r} = {_arguments.shown(values)} must be "
                f"{len(levels)} ascending rotations [rad], of {', '.join(levels)}"
            )
        matching = [part for part in known if fnmatchcase(part, str(name))]
        if not matching:
            raise InputError(
                f"assess: limits of {name!r}: no member with sections and no node with a panel has "
                "this name; give one, or a pattern, as 'C-*-1' for the columns of a storey"
            )
        stated |= dict.fromkeys(matching, tuple(rotations.tolist()))
    without = sorted(_walls_of(frame) - set(stated))
    if without:
        raise InputError(
            f"assess: {', '.join(without)}: no limits of walls are known here that a public source "
            f"confirms; give limits={{{without[0]!r}: rotations of {', '.join(levels)}}} [rad]"
        )
    return stated


def pushed_over(result: FrameResult | BuildingResult, name: str) -> None:
    """Refuse a path that has no row of its start and its events, or that turns back."""
    call = result.call
    way = np.diff(np.atleast_1d(call.get("displacement", call.get("force", 0.0))))
    if not call.get("corners") or ((way > 0.0).any() and (way < 0.0).any()):
        raise InputError(
            f"{name}: the path keeps its given points alone, or turns back, so that it passes a "
            "displacement never or several times; give what rbsdem.pushover returned"
        )


def rows_at(result: FrameResult | BuildingResult, at: Any) -> tuple[float | None, Array]:
    """Return the displacement that is judged, and its row, or all rows.

    Parameters
    ----------
    result : FrameResult or BuildingResult
        The result.
    at : Target, float or None
        As for `assess`.
    """
    every = np.arange(float(result.time.size))
    if at is None:
        return None, every
    if result.dynamic:
        raise InputError("assess: a response in time is judged by its envelope; leave out at")
    pushed_over(result, "assess: at")
    if not getattr(at, "reached", True):
        raise InputError("the push-over ends before the target; push further")
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
