"""The Takeda rule once more: an independent method for the tests of ``rbsdem``.

Written from the statement of the rules (the trilinear Takeda spring with B0 and B1, sections 2a to
2c), not from the Fortran. Everything is done event by event in plain floats: a spring stands on a
branch, the branch has a line and an end, and a move either stays on the line or goes to the end and
asks the rules what comes next. Nothing is tuned for speed and nothing is bounded in size: the stack
of inner peaks is a list.

Letters follow the rules: branch E (uncracked), C (cracked backbone), P (yielded backbone),
O (outer unloading), R (reloading), I (inner unloading); side ``s`` is +1 or -1, the sign of the
force; ``um`` the backbone peak of a side; ``z`` the zero crossing from which an excursion came.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

Inner = Literal["kc", "kr", "one"]
BranchName = Literal["E", "C", "P", "O", "R", "I"]


@dataclass(frozen=True)
class Point:
    """A point (deformation, force)."""

    d: float
    f: float


@dataclass(frozen=True)
class Line:
    """A straight line through an anchor that is fixed when the branch is entered."""

    d: float
    f: float
    k: float

    def force(self, d: float) -> float:
        """Force at deformation ``d``; never a running sum of increments."""
        return self.f + self.k * (d - self.d)

    @property
    def zero(self) -> float:
        """Deformation at which the line has no force."""
        return self.d - self.f / self.k


@dataclass(frozen=True)
class Branch:
    """A branch of the rules: its name, side and line; ``target`` and ``z`` belong to R alone."""

    name: BranchName
    side: int
    line: Line
    target: Point | InnerPeak | None = None
    z: float = 0.0


@dataclass(frozen=True, eq=False)
class InnerPeak:
    """A reversal on a reloading line: the point, and the R branch that was left there."""

    d: float
    f: float
    left: Branch


class Takeda:
    """Trilinear backbone with Takeda rules, B0, B1 and an unlimited memory of inner peaks."""

    def __init__(
        self,
        k_c: float,
        d_c: float,
        k_y: float,
        d_y: float,
        k_u: float,
        b0: float = 0.4,
        b1: float = 1.0,
        inner: Inner = "kc",
    ) -> None:
        self.k_c, self.d_c, self.k_y = float(k_c), float(d_c), float(k_y)
        self.d_y, self.k_u = float(d_y), float(k_u)
        self.b0, self.b1, self.inner = float(b0), float(b1), inner
        self.f_c = self.k_c * self.d_c
        self.f_y = self.f_c + self.k_y * (self.d_y - self.d_c)
        self.k_0 = (self.f_c + self.f_y) / (self.d_c + self.d_y)
        self.start()

    def start(self) -> None:
        """Go back to the virgin state."""
        self.d = self.f = 0.0
        self.branch = Branch("E", 0, Line(0.0, 0.0, self.k_c))
        self.um: dict[int, Point] = {}  # no entry: that side is uncracked
        self.k_r: dict[int, float] = {}  # no entry: never unloaded from that backbone
        self.stack: list[InnerPeak] = []

    @property
    def tangent(self) -> float:
        """Stiffness of the present branch."""
        return self.branch.line.k

    @property
    def zero(self) -> float:
        """Deformation at which the line of the present branch has no force (k_u = 0 on P: none)."""
        return self.branch.line.zero if self.branch.line.k > 0 else self.d

    def response(self, deformations: Iterable[float]) -> list[float]:
        """Forces along a path that starts at zero in the virgin state."""
        self.start()
        return [self.move(float(d)) for d in deformations]

    def move(self, d: float) -> float:
        """Move to ``d`` and return the force there."""
        if d == self.d:
            return self.f
        way = 1 if d > self.d else -1
        self._turn(way)
        while self._reaches(d, way):
            self._pass_end(way)
        self.d, self.f = d, self.branch.line.force(d)
        return self.f

    def _turn(self, way: int) -> None:
        """Apply the rules for "turning back" at the present point. E, O and I run both ways."""
        branch = self.branch
        if way != -branch.side:
            return
        if branch.name in ("C", "P"):
            self._leave_backbone()
        elif branch.name == "R":
            self._leave_reloading()

    def _reaches(self, d: float, way: int) -> bool:
        """Whether a move to ``d`` arrives at the end of the branch (F = 0: goes beyond it)."""
        end = self._end(way)
        if end is None:
            return False
        beyond = way * (d - end)
        return beyond > 0 if self._ends_at_zero_force(way) else beyond >= 0

    def _ends_at_zero_force(self, way: int) -> bool:
        name, side = self.branch.name, self.branch.side
        return way == -side and (name == "I" or (name == "O" and -side in self.um))

    def _end(self, way: int) -> float | None:
        """Deformation of the end of the present branch in the direction ``way``."""
        branch, side = self.branch, self.branch.side
        if self._ends_at_zero_force(way):
            return branch.line.zero
        end: float | None = None  # P has none
        if branch.name == "E":
            end = way * self.d_c
        elif branch.name == "C":
            end = side * self.d_y
        elif branch.name == "O":
            end = self.um[side].d if way == side else self._first_cracking(side)
        elif branch.name == "I":
            end = self.stack[-1].d
        elif branch.target is not None:
            end = branch.target.d
        return end

    def _pass_end(self, way: int) -> None:
        """Go to the end of the present branch and on to the next one."""
        name, side = self.branch.name, self.branch.side
        end = self._end(way)
        assert end is not None
        at_zero = self._ends_at_zero_force(way)
        self.d, self.f = end, 0.0 if at_zero else self.branch.line.force(end)
        if name == "E":
            self._enter_backbone(way)
        elif name == "C":
            self._enter_backbone(side)
        elif at_zero and name == "O":
            self._redirect_to_yield(-side)
            self._enter_reloading(-side, self.um[-side])
        elif at_zero:
            self._enter_reloading(-side, self._latest_target(-side))
        elif name == "O" and way == side:
            self._enter_backbone(side)
        elif name == "O":
            self._crack_other_side(side)
        elif name == "I":
            self.branch = self.stack.pop().left
        else:
            self._reach_target()

    def _enter_backbone(self, side: int) -> None:
        """C up to and P from the yield point; the yield point itself belongs to P."""
        self.stack.clear()
        if side * self.d >= self.d_y:
            line = Line(side * self.d_y, side * self.f_y, self.k_u)
            self.branch = Branch("P", side, line)
        else:
            line = Line(side * self.d_c, side * self.f_c, self.k_y)
            self.branch = Branch("C", side, line)

    def _leave_backbone(self) -> None:
        """Rule 1: outer unloading, with the peak of the own side."""
        side = self.branch.side
        peak = Point(self.d, self.f)
        d_m, f_m = abs(peak.d), abs(peak.f)
        if d_m <= self.d_y:
            k_r = (f_m + self.f_c) / (d_m + self.d_c)
        else:
            k_r = self.k_0 * (self.d_y / d_m) ** self.b0
        k_r = max(k_r, f_m / d_m)
        self.um[side] = peak
        self.k_r[side] = k_r
        self.branch = Branch("O", side, Line(peak.d, peak.f, k_r))

    def _first_cracking(self, side: int) -> float:
        """Where the O line of ``side`` arrives at the cracking force of the other, virgin side."""
        peak = self.um[side]
        if abs(peak.d) <= self.d_y:
            return -side * self.d_c  # by construction of K_r, and so without round-off
        return peak.d - (peak.f + side * self.f_c) / self.k_r[side]

    def _crack_other_side(self, side: int) -> None:
        """Rule 2: first loading of the other side."""
        other = -side
        if abs(self.um[side].d) <= self.d_y:
            self._enter_backbone(other)
            return
        k_r = self.k_r[side]
        z = self.branch.line.zero
        run = other * (other * self.d_y - self.d)  # positive: the yield point lies ahead
        rise = self.f_y - self.f_c
        if run <= 0 or rise > k_r * run:
            # Extreme parameters: K_r goes on to its meeting with P(other). Measured from here
            # along the side ``other``: F_c + K_r x = F_y + K_u (x - run).
            x = (rise - self.k_u * run) / (k_r - self.k_u)
            peak = Point(self.d + other * x, other * (self.f_c + k_r * x))
        else:
            peak = Point(other * self.d_y, other * self.f_y)
        self.um[other] = peak
        self._enter_reloading(other, peak, z)

    def _redirect_to_yield(self, side: int) -> None:
        """Rule 3: a side not yet yielded is loaded toward its yield point if that is steeper."""
        peak = self.um[side]
        if abs(peak.d) >= self.d_y:
            return
        to_peak = (peak.f - self.f) / (peak.d - self.d)
        to_yield = (side * self.f_y - self.f) / (side * self.d_y - self.d)
        if to_yield > to_peak:
            self.um[side] = Point(side * self.d_y, side * self.f_y)

    def _latest_target(self, side: int) -> Point | InnerPeak:
        """Rule 4: the latest inner peak of ``side`` in the stack, else its backbone peak."""
        for peak in reversed(self.stack):
            if peak.left.side == side:
                return peak
        return self.um[side]

    def _enter_reloading(
        self, side: int, target: Point | InnerPeak, z: float | None = None
    ) -> None:
        """R from the present point; rule 5: ``z`` is this point unless it is given."""
        run = target.d - self.d
        slope = (target.f - self.f) / run if run != 0 else self.k_c  # no run: arrived already
        line = Line(self.d, self.f, slope)
        self.branch = Branch("R", side, line, target, self.d if z is None else z)

    def _reach_target(self) -> None:
        """End of R: an inner loop is closed, or the backbone is reached."""
        target = self.branch.target
        if not isinstance(target, InnerPeak):
            self._enter_backbone(self.branch.side)
            return
        while self.stack.pop() is not target:
            pass
        self.branch = target.left

    def _leave_reloading(self) -> None:
        """Turning back on R: a new inner peak, unless there is no force to unload."""
        branch, side = self.branch, self.branch.side
        if abs(self.f) <= 1e-12 * self.f_y:
            self._enter_reloading(-side, self._latest_target(-side))
            return
        peak = InnerPeak(self.d, self.f, branch)
        self.stack.append(peak)
        self.branch = Branch("I", side, Line(peak.d, peak.f, self._inner_stiffness(peak)))

    def _inner_stiffness(self, peak: InnerPeak) -> float:
        """K_in of section 2b: B1 Kc, B1 K_r or K_r, with K_r above and the secant below."""
        side = peak.left.side
        k_r = self.k_r[side] if side in self.k_r else self.k_r[-side]
        wished = {"kc": self.b1 * self.k_c, "kr": self.b1 * k_r, "one": k_r}[self.inner]
        secant = peak.f / (peak.d - peak.left.z)
        return max(min(wished, k_r), secant)
