"""Concrete, steel and the joint of layers once more, from ``docs/rules.md`` and another way.

Small steps instead of lines: the steel follows the smooth curve, not its chords; the joint finds
its opening from the axial force at every step, not by straight lines between events. Springs are
values: `step` gives the force and the spring as it is then, and leaves the one it began from.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import brentq

CHORDS = np.array([0.0, 0.25, 0.5, 0.75, 1.0])


@dataclass(frozen=True)
class Concrete:
    """Section 9; closing is positive inside."""

    k: float
    f_peak: float
    d_peak: float
    k_soft: float
    f_res: float = 0.0
    plastic: float = 1.0
    contact: float = 0.0
    misfit: float = 0.0
    wear: float = 0.0
    virgin: bool = True
    largest: float = 0.0  # closing so far
    rest: float = 0.0  # plastic closing
    touch: float = 0.0
    widest: float = 0.0
    strength: float = 1.0
    closed: bool = True

    def envelope(self, c: float) -> float:
        r = self.k / (self.k - self.f_peak / self.d_peak)
        if c <= self.d_peak:
            rising = self.f_peak * CHORDS * r / (r - 1 + CHORDS**r)
            return float(np.interp(c / self.d_peak, CHORDS, rising))
        return max(self.f_peak - self.k_soft * (c - self.d_peak), self.f_res)

    def step(self, d: float) -> tuple[float, Concrete]:
        c = -d
        if self.virgin and 0 <= c < 0.25 * self.d_peak:
            return -self.envelope(c), self
        new = replace(self, virgin=False)
        if c >= self.largest:
            force = self.strength * self.envelope(c)
            x = c / self.d_peak
            share = 0.145 * x**2 + 0.13 * x if x <= 2 else 0.84 + 0.834 * (x - 2)
            rest = max(0.0, min(self.plastic * share * self.d_peak, c - force / self.k))
            return -force, replace(
                new, largest=c, rest=rest, touch=min(self.touch, rest), closed=True
            )
        top = self.strength * self.envelope(self.largest)
        points = [(self.rest, 0.0), (self.largest, top)]
        if self.touch < self.rest:
            middle = self.rest + self.contact * (self.largest - self.rest)
            points = [(self.touch, 0.0), (middle, self.contact * top), (self.largest, top)]
        if c > self.touch:
            places, forces = zip(*points, strict=True)
            return -float(np.interp(c, places, forces)), replace(new, closed=True)
        if self.closed and self.largest > 0:
            loss = self.wear * min(1.0, 0.5 * self.largest / self.d_peak)
            new = replace(new, strength=self.strength * (1 - loss), closed=False)
        widest = max(self.widest, self.rest - c)
        return 0.0, replace(new, widest=widest, touch=self.rest - self.misfit * widest)


@dataclass(frozen=True)
class Branch:
    """Curve of Menegotto and Pinto from one point of reversal."""

    way: int
    d: float
    f: float
    d_a: float
    f_a: float
    r: float
    k: float
    ratio: float

    def force(self, d: float) -> float:
        x = (d - self.d) / (self.d_a - self.d)
        if x <= 0:
            return self.f + self.k * (d - self.d)
        # Far out the curve is its asymptote; the power would overflow.
        bend = x / (1 + x**self.r) ** (1 / self.r) if self.r * np.log(x) < 500 else 1.0
        return self.f + (self.ratio * x + (1 - self.ratio) * bend) * (self.f_a - self.f)

    def meets(self, old: Branch) -> bool:
        """Whether it comes up to an older one where it still bends."""
        if self.way * (self.f - old.force(self.d)) > 1e-9 * abs(self.f_a):
            return False
        x = np.linspace(1e-6, 1, 200) * 30 ** (1 / self.r)
        places = self.d + x * (self.d_a - self.d)
        return any(self.way * (self.force(d) - old.force(d)) >= 0 for d in places)


@dataclass(frozen=True)
class Steel:
    """Section 10."""

    k: float
    f_y: float
    k_post: float
    r0: float = 20.0
    cr1: float = 0.925
    cr2: float = 0.15
    isotropic_hardening: float = 0.0
    half_strength_work: float = 0.0
    d: float = 0.0
    f: float = 0.0
    work: float = 0.0
    highest: float = 0.0
    lowest: float = 0.0
    branches: tuple[Branch, ...] = ()

    def begin(self, way: int) -> tuple[Branch, ...]:
        """Return the branches when the motion goes on in a direction."""
        d_y, branches = self.f_y / self.k, list(self.branches)
        if not branches:
            ends = way * d_y, way * self.f_y
            return (Branch(way, 0.0, 0.0, *ends, self.r0, self.k, self.k_post / self.k),)
        while len(branches) >= 2 and way * (self.d - branches[-2].d) <= 0:
            if len(branches) >= 3 and branches[-1].meets(branches[-3]):
                del branches[-2:]
            else:
                del branches[-3 if len(branches) >= 3 else -2 : -1]
        high, low = max(self.highest, self.d), min(self.lowest, self.d)
        strength = 1 + self.isotropic_hardening * ((high - low) / 2 / d_y) ** 0.8
        if self.half_strength_work:
            spent = max(0.0, self.work - self.f**2 / 2 / self.k) / (self.f_y * d_y)
            strength /= 1 + (spent / self.half_strength_work) ** 2
        # Where the elastic line through here meets the line of hardening of the other side.
        line = way * (strength * self.f_y - self.k_post * d_y)
        d_a = (line - self.f + self.k * self.d) / (self.k - self.k_post)
        xi = abs((high if way > 0 else low) - d_a) / d_y
        r = max(0.8, self.r0 * (1 - self.cr1 * xi / (self.cr2 + xi)))
        f_a = self.f + self.k * (d_a - self.d)
        new = Branch(way, self.d, self.f, d_a, f_a, r, self.k, self.k_post / self.k)
        return (*branches, new)

    def step(self, d: float) -> tuple[float, Steel]:
        if d == self.d:
            return self.f, self
        way, branches = (1 if d > self.d else -1), self.branches
        d_y = self.f_y / self.k
        if not branches and abs(d) <= 0.03 ** (1 / self.r0) * d_y:
            # The first chord leads both ways.
            force = self.k * d * (1 + 0.03) ** (-1 / self.r0)
            work = self.work + (force + self.f) / 2 * (d - self.d)
            return force, replace(self, d=d, f=force, work=work)
        high, low = self.highest, self.lowest
        if not branches or branches[-1].way != way:
            if branches:
                high, low = max(high, self.d), min(low, self.d)
            branches = self.begin(way)
        force = branches[-1].force(d)
        while len(branches) >= 3:
            new, old = branches[-1], branches[-3]
            if new.way * (new.f - old.force(new.d)) > 1e-9 * self.f_y:
                break
            if way * (force - old.force(d)) < 0:
                break
            branches = branches[:-2]
            force = old.force(d)
        work = self.work + (force + self.f) / 2 * (d - self.d)
        return force, replace(
            self, d=d, f=force, work=work, highest=high, lowest=low, branches=branches
        )


def response(axial_load: float, layers: list[tuple[float, Any]], path: Any, steps: int) -> Any:
    """Return the moments at the points of a path of rotations, with steps between them.

    For sections that are symmetric, so that the axial load alone does not turn them.
    """
    ys = [y for y, _ in layers]
    springs = [spring for _, spring in layers]
    opening, before, moments = 0.0, 0.0, []

    def forces(w: float, turn: float) -> list[float]:
        return [s.step(w + y * turn)[0] for y, s in zip(ys, springs, strict=True)]

    reach = max(map(abs, ys))
    corners = np.concatenate([[0.0], path])
    turns = np.interp(np.arange(steps * len(path) + 1) / steps, np.arange(corners.size), corners)
    for turn in turns:
        room = 2 * reach * abs(turn - before) + 1e-9

        def excess(w: float, turn: float = turn) -> float:
            return sum(forces(w, turn)) + axial_load

        while excess(opening - room) > 0 or excess(opening + room) < 0:
            room *= 2
            if room > 1.0:
                raise ArithmeticError("the layers do not carry the axial load")
        opening = brentq(excess, opening - room, opening + room, xtol=1e-15, rtol=1e-12)
        states = [s.step(opening + y * turn) for y, s in zip(ys, springs, strict=True)]
        springs = [state for _, state in states]
        moments.append(sum(y * f for y, (f, _) in zip(ys, states, strict=True)))
        before = turn
    return np.array(moments[steps::steps])
