"""The capped rules once more: an independent method for the tests of ``rbsdem``.

Written from ``docs/rules.md``, not from the Fortran, and built another way, for full cycles of
growing amplitude: each half-cycle is one polyline. The backbone is a function, the least of what
hardening and softening allow; its corners are found by asking the function at all places where
lines meet.
Inner loops are proved in the Fortran suites.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

FAR = 1e30
SIDE = ("d_c", "f_c", "d_y", "f_y", "d_cap", "f_cap", "d_pc", "f_res", "d_u")


@dataclass(frozen=True)
class Backbone:
    """The backbone of one side all numbers positive; without rupture `d_u` is infinite."""

    d_y: float
    f_y: float
    d_cap: float
    f_cap: float
    d_pc: float
    f_res: float = 0.0
    d_u: float = math.inf
    d_c: float = 0.0
    f_c: float = 0.0

    @property
    def slope(self) -> float:
        """Elastic stiffness."""
        return self.f_c / self.d_c if self.d_c else self.f_y / self.d_y

    def function(self, strength: float, softening: float) -> tuple[Callable[[float], float], list]:
        """Return force as a function of deformation, and the deformations where it may bend."""
        hardening = 0.0
        if self.d_cap > self.d_y:
            hardening = strength * (self.f_cap - self.f_y) / (self.d_cap - self.d_y)
        yielding = (strength * self.d_y, strength * self.f_y)
        cracking = (strength * self.d_c, strength * self.f_c)
        falling = -self.f_cap / self.d_pc
        # Lines of the way up: a point, a slope, from where to where it counts.
        rising = [(yielding, hardening)]
        if self.d_c:
            slope = (self.f_y - self.f_c) / (self.d_y - self.d_c)
            rising = [((0.0, 0.0), self.slope), (cracking, slope), *rising]
        else:
            rising = [((0.0, 0.0), self.slope), *rising]
        at_zero = softening * self.f_cap * (1 + self.d_cap / self.d_pc)

        def up(d: float) -> float:
            return min(f + k * (d - at) for (at, f), k in rising)  # the way up is concave

        def whole(d: float) -> float:
            return max(min(up(d), max(at_zero + falling * d, self.f_res)), 0.0)

        bends = [yielding[0], cracking[0], (at_zero - self.f_res) / -falling]
        for (at, f), k in rising:
            bends.append((at_zero - f + k * at) / (k - falling))
            if k > 0:
                bends.append(at + (self.f_res - f) / k)
        if math.isinf(self.d_u):
            return whole, bends
        rupture, top = 16 / 15 * self.f_y / self.d_y, whole(self.d_u)

        def torn(d: float) -> float:
            return whole(d) if d <= self.d_u else max(top - rupture * (d - self.d_u), 0.0)

        return torn, [*bends, self.d_u, self.d_u + top / rupture]


class Part:
    """One of the two parts of a spring, along full cycles of growing amplitude.

    Each half-cycle is one polyline: from the turn to zero force, to where reloading starts, to its
    goal, along the backbone to the next turn.
    """

    def __init__(
        self, given: dict[int, Backbone], b0: float, c: float, capacity: dict, slip: float | None
    ) -> None:
        self.given, self.b0, self.c, self.capacity, self.slip = given, b0, c, capacity, slip
        self.k_0 = max(side.slope for side in given.values())
        self.d = self.f = 0.0
        self.peak = {s: side.d_c or side.d_y for s, side in given.items()}
        self.start = {1: 0.0, -1: 0.0}
        self.target = {1: 1.0, -1: 1.0}
        self.spent = {1: 0.0, -1: 0.0}
        self.worn, self.has_yielded = 0.0, False

    def left(self, kind: str, energy: float) -> float:
        """Return what an energy leaves."""
        if not self.capacity[kind]:
            return 1.0
        return 1 - min(1.0, max(energy, 0.0) / self.capacity[kind]) ** self.c

    def unloading(self, s: int, d: float) -> float:
        """Return the stiffness of unloading without deterioration."""
        own, other = self.given[s], self.given[-s]
        if d <= own.d_c or (d < own.d_y and not own.d_c):
            return own.slope
        beyond = other.f_c / own.slope
        if d < own.d_y:
            f = float(np.interp(d, [own.d_c, own.d_y], [own.f_c, own.f_y]))
            return (f + other.f_c) / (d + beyond)
        return (own.f_y + other.f_c) / (own.d_y + beyond) * (d / own.d_y) ** -self.b0

    def turn_stiffness(self, s: int) -> float:
        """Return the stiffness of unloading from the present turn on side s."""
        d, f = s * self.d, s * self.f
        k = self.unloading(s, self.peak[s]) * max(self.left("k", self.worn), 1e-6)
        return min(max(k, f / (d - self.start[s])), self.k_0)

    def half_cycle(self, s: int, to: float) -> tuple[list[float], list[float]]:
        """Go to a deformation on side s; return the polyline."""
        points = [(self.d, self.f)]
        zero = s * self.d
        if self.f:
            zero = s * (self.d - self.f / self.turn_stiffness(-s))
            points.append((s * zero, 0.0))
        if self.has_yielded:
            self.spent[-s] += self.now - 0.5 * self.f * (self.d - s * zero)
        strength = max(self.left("s", self.spent[-s]), self.given[s].f_res / self.given[s].f_y)
        function, bends = self.given[s].function(strength, self.left("c", self.spent[-s]))
        bends = sorted({x for x in bends if x > 0})
        left = self.left("a", self.spent[-s])
        if left < self.target[s]:
            moved = self.peak[s] * self.target[s] / left if left else FAR
            self.peak[s] = min(moved, max(self.peak[s], self.given[s].d_u))
            self.target[s] = left
        start = zero
        if self.slip is not None:
            k = self.unloading(s, self.peak[s]) * max(self.left("k", self.worn), 1e-6)
            start = max(start, self.slip * (self.peak[s] - function(self.peak[s]) / k))
            start = max(start, 0.0) if zero < 0 else start
            points.append((s * start, 0.0))
        goals = [x for x in (self.peak[s], *bends) if x >= self.peak[s] and x > start]
        goal = max(goals, key=lambda x: function(x) / (x - start))
        way = [x for x in (goal, *bends) if goal <= x < to]
        end = function(to) if to >= goal else function(goal) * (to - start) / (goal - start)
        points += [(s * x, s * function(x)) for x in sorted(set(way))] + [(s * to, s * end)]
        self.account(s, points, strength * self.given[s].d_y)
        self.start[s], self.peak[s] = start, max(self.peak[s], to)
        self.d, self.f = points[-1]
        self.worn = max(self.worn, self.dissipated(s))
        d, f = zip(*(points if s > 0 else points[::-1]), strict=True)
        return list(d), list(f)

    def account(self, s: int, points: list, d_y: float) -> None:
        """Find the work of the excursion that counts: without what was dissipated before yield."""
        d = np.array([s * x for x, _ in points])
        f = np.array([s * y for _, y in points])
        first = int(np.argmax(f > 0)) - 1
        d, f = d[first:], f[first:]
        self.now = float(np.sum(0.5 * np.diff(d) * (f[1:] + f[:-1])))
        if self.has_yielded or d[-1] < d_y:
            return
        self.has_yielded = True
        inside = d <= d_y
        before = float(np.sum(0.5 * np.diff(d[inside]) * (f[inside][1:] + f[inside][:-1])))
        top = float(f[inside][-1])
        k = self.unloading(s, d_y)
        self.start[s] = float(d[0])
        k = min(max(k, top / (d_y - self.start[s])), self.k_0)
        self.now -= before - 0.5 * top**2 / k

    def dissipated(self, s: int) -> float:
        """Return the energy that counts for the stiffness at a turn."""
        if not self.has_yielded:
            return 0.0
        return sum(self.spent.values()) + self.now - 0.5 * self.f**2 / self.k_0


class Capped:
    """A spring of the rules ``peak_oriented`` and ``pinching`` (with `kappa_f` and `kappa_d`)."""

    def __init__(self, kappa_f: float = 1.0, kappa_d: float = 1.0, **given) -> None:
        sides = {+1: {}, -1: {}}
        for name in SIDE:
            value = given.pop(name, None)
            other = given.pop(f"{name}_neg", None)
            if value is not None:
                sides[+1][name] = sides[-1][name] = value
            if other is not None:
                sides[-1][name] = other
        self.given = {s: Backbone(**numbers) for s, numbers in sides.items()}
        b0, c = given.pop("b0", 0.0), given.pop("c", 1.0)
        size = sum(0.5 * b.f_y * b.d_y for b in self.given.values())
        capacity = {x: given.pop(f"lambda_{x}", 0.0) * size for x in "scka"}
        assert not given, given
        self.parts = [
            (kappa_f, Part(self.given, b0, c, capacity, None)),
            (1 - kappa_f, Part(self.given, b0, c, capacity, 1 - kappa_d)),
        ]

    def response(self, path: Iterable[float]) -> list[float]:
        """Return the forces along full cycles; the last half-cycle may be broken off."""
        points = np.array([0.0, *path])
        way = np.sign(np.diff(points))
        turns = [i + 1 for i in range(len(way) - 1) if way[i + 1] != way[i]]
        begin, forces = 0, []
        for end in [*turns, len(points) - 1]:
            s = int(way[end - 1])
            to = s * points[end] if end in turns else max(s * points[end], 1e6)
            run = sum(
                share * np.interp(points[begin + 1 : end + 1], *part.half_cycle(s, float(to)))
                for share, part in self.parts
            )
            forces += np.asarray(run).tolist()
            begin = end
        return forces
