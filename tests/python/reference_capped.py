"""The capped rules once more: an independent method for the tests of ``rbsdem``.

Written from ``docs/rules.md``, not from the Fortran, and built another way: a spring has a polyline
*ahead* of it, the points that loading will pass from here to the end of the backbone, and while it
unloads it has that polyline waiting. The backbone is a function, the least of what hardening and
softening allow; its corners are found by asking the function at all places where lines meet.

Work is summed move by move. Nothing is tuned for speed.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass

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
        rupture, top = self.f_y / self.d_y, whole(self.d_u)

        def torn(d: float) -> float:
            return whole(d) if d <= self.d_u else max(top - rupture * (d - self.d_u), 0.0)

        return torn, [*bends, self.d_u, self.d_u + top / rupture]


class Capped:
    """A spring of the rules ``peak_oriented`` and ``pinching`` (with `kappa_f` and `kappa_d`)."""

    def __init__(self, kappa_f: float | None = None, kappa_d: float | None = None, **given) -> None:
        sides = {+1: {}, -1: {}}
        for name in SIDE:
            value = given.pop(name, None)
            other = given.pop(f"{name}_neg", None)
            if value is not None:
                sides[+1][name] = sides[-1][name] = value
            if other is not None:
                sides[-1][name] = other
        self.given = {s: Backbone(**numbers) for s, numbers in sides.items()}
        self.kappa = None if kappa_f is None else (kappa_f, kappa_d)
        self.b0 = given.pop("b0", 0.0)
        self.c = given.pop("c", 1.0)
        size = sum(0.5 * b.f_y * b.d_y for b in self.given.values())
        self.capacity = {x: given.pop(f"lambda_{x}", 0.0) * size for x in "scka"}
        assert not given, given

        self.d = self.f = self.work = 0.0
        self.left = {s: dict.fromkeys("sc", 1.0) for s in (1, -1)}
        self.peak = {s: b.d_c for s, b in self.given.items()}
        self.last: dict[int, tuple[float, float] | None] = {1: None, -1: None}
        self.loaded: set[int] = set()
        self.k_left, self.k_next = 1.0, 1.0
        self.spent = 0.0
        self.is_virgin, self.is_dead, self.has_yielded = True, False, False
        self.s = 0
        self.zero, self.at_zero = 0.0, 0.0  # the crossing, and the work there
        self.ahead: list[tuple[float, float]] = []
        self.unloads: tuple[float, float, float] | None = (
            None  # from where, and the zero it goes to
        )
        self.loads_backbone = False
        self.corners: list[float] = [0.0]
        self.spent_at: list[float] = []

    # ---- the backbone ----

    def force_of(self, s: int) -> tuple[Callable[[float], float], list[float]]:
        """Return the present backbone of a side and its bends in order."""
        b = self.given[s]
        self.left[s]["s"] = max(self.left[s]["s"], b.f_res / b.f_y)
        function, bends = b.function(self.left[s]["s"], self.left[s]["c"])
        return function, sorted({x for x in bends if x > 0})

    def beyond(self, s: int, d: float) -> list[tuple[float, float]]:
        """Return the points of the backbone beyond a deformation."""
        function, bends = self.force_of(s)
        points = [(x, function(x)) for x in bends if x > d]
        far = points[-1][1] if points else function(d)
        return [*points, (FAR, far)]

    # ---- deterioration ----

    def share(self, kind: str, energy: float) -> float:
        """Return beta of an excursion."""
        if not self.capacity[kind] or energy <= 0:
            return 0.0
        rest = self.capacity[kind] - self.spent - energy
        return min(1.0, (energy / rest) ** self.c) if rest > 0 else 1.0

    def stiffness(self, s: int) -> float:
        """Return the unloading stiffness of a side."""
        own, other = self.given[s], self.given[-s]
        d = max(self.peak[s], own.d_c)
        if d >= own.d_y:
            k = (own.f_y + other.f_c) / (own.d_y + other.d_c) * (d / own.d_y) ** -self.b0
        elif d > 0:
            f = own.f_c + (d - own.d_c) * (own.f_y - own.f_c) / (own.d_y - own.d_c)
            k = (f + other.f_c) / (d + other.d_c)
        else:
            k = own.slope
        return k * self.k_left

    # ---- the path ----

    def go(self, d: float, f: float) -> None:
        """Move along a straight line."""
        self.work += 0.5 * (f + self.f) * (d - self.d)
        self.d, self.f = d, f
        if d != self.corners[-1]:
            self.corners.append(d)

    def move(self, to: float) -> float:
        """Go to a deformation and return the force there."""
        while self.d != to:
            if self.is_dead:
                self.f = 0.0
                self.go(to, 0.0)
            elif self.is_virgin:
                self.move_virgin(to)
            elif self.unloads:
                self.move_unloading(to)
            elif (to - self.d) * self.s > 0:
                self.move_loading(to)
            else:
                self.turn_back()
        return self.f

    def move_virgin(self, to: float) -> None:
        s = 1 if to > self.d else -1
        if self.d * s < 0:
            end = 0.0 if to * s > 0 else to
            self.go(end, self.given[-s].slope * end)
            return
        function, _ = self.force_of(s)
        first = self.given[s].d_c or self.given[s].d_y
        if to * s < first:
            self.go(to, self.given[s].slope * to)
            return
        self.go(s * first, s * function(first))
        self.is_virgin = False
        self.s = s
        self.ahead = self.beyond(s, first)
        self.loads_backbone = True

    def move_loading(self, to: float) -> None:
        s = self.s
        d, f = self.ahead[0]
        if to * s < d:
            part = (to * s - self.d * s) / (d - self.d * s)
            self.go(to, self.f + part * (s * f - self.f))
            return
        self.go(s * d, s * f)
        self.ahead.pop(0)
        if d == self.peak[s] or self.loads_backbone:
            self.loads_backbone = True
            if f <= 1e-14 * self.given[s].f_y:
                self.is_dead = True

    def turn_back(self) -> None:
        s, d, f = self.s, self.d * self.s, self.f * self.s
        if f <= 1e-12 * self.given[s].f_y:
            self.aim(-s)
            return
        if self.loads_backbone:
            self.peak[s] = d
            self.loaded.add(s)
            self.has_yielded |= d > self.given[s].d_y
        self.last[s] = None if self.loads_backbone else (d, f)
        k, put_in = self.stiffness(s), self.work - self.at_zero
        self.k_next = self.k_left
        if self.has_yielded:
            keep = 1 - self.share("k", put_in - f * f / (2 * k))
            keep = max(keep, 1e-6 / self.k_left)
            self.k_next, k = self.k_left * keep, k * keep
        k = max(k, f / (d - self.zero * s), f * f / (2 * put_in))
        k = min(k, max(b.slope for b in self.given.values()))
        self.unloads = (self.d, self.f, self.d - self.f / k)

    def move_unloading(self, to: float) -> None:
        d, f, zero = self.unloads
        s = self.s
        if to * s >= d * s:
            self.go(d, f)
            self.unloads = None
        elif to * s >= zero * s:
            self.go(to, f * (to - zero) / (d - zero))
        else:
            self.go(zero, 0.0)
            self.unloads = None
            self.k_left = self.k_next
            if self.has_yielded and self.pay(-s):
                self.is_dead = True
            else:
                self.aim(-s)

    def pay(self, s: int) -> bool:
        """Charge a side for the excursion that is over; return whether nothing is left."""
        energy = max(self.work - self.at_zero, 0.0)
        shares = {x: self.share(x, energy) for x in "sca"}
        self.spent += energy
        self.spent_at.append(self.spent)
        if max(shares.values()) >= 1:
            return True
        for x in "sc":
            self.left[s][x] *= 1 - shares[x]
        self.force_of(s)  # the strength is not below the residual
        peak, b = self.peak[s], self.given[s]
        if s in self.loaded:
            self.peak[s] = min(peak * (1 + shares["a"]), max(peak, b.d_u))
        else:
            self.peak[s] = self.left[s]["s"] * b.d_c
        return False

    def aim(self, s: int) -> None:
        """Lay the way to the largest peak of a side, and beyond it."""
        self.s, self.zero, self.at_zero, self.loads_backbone = s, self.d, self.work, False
        z = self.d * s
        function, _ = self.force_of(s)
        d, f = self.peak[s], function(self.peak[s])
        d_y = self.left[s]["s"] * self.given[s].d_y
        if d < d_y and (d <= z or function(d_y) / (d_y - z) >= f / (d - z)):
            d, f = d_y, function(d_y)
        if self.peak[s] < d_y:
            d, f = self.not_steeper(s, z, d, f)
        self.peak[s] = d
        if f <= 0:
            self.is_dead = True
            return
        self.ahead = [(d, f), *self.beyond(s, d)]
        if self.kappa:
            permanent = d - f / self.stiffness(s)
            at = (1 - self.kappa[1]) * max(permanent, 0.0)
            if at > z:
                self.ahead.insert(0, (at, self.kappa[0] * f * (at - z) / (d - z)))
        elif self.last[s]:
            d_last, f_last = self.last[s]
            if z < d_last < d and f_last < f and f_last / (d_last - z) > f / (d - z):
                self.ahead.insert(0, (d_last, f_last))

    def not_steeper(self, s: int, z: float, d: float, f: float) -> tuple[float, float]:
        """Return the target, or where the stiffest line meets the backbone beyond it."""
        k = max(b.slope for b in self.given.values())
        function, _ = self.force_of(s)
        above = f - k * (d - z)
        if above <= 0:
            return d, f
        for d_next, f_next in self.beyond(s, d):
            left = f_next - k * (d_next - z)
            if left < 0:
                d += (d_next - d) * above / (above - left)
                return d, function(d)
            d, above = d_next, left
        return d, function(d)

    def response(self, path: Iterable[float]) -> list[float]:
        """Return the forces along a path."""
        return [self.move(float(d)) for d in path]
