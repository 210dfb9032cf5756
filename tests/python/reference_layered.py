"""Concrete, steel and the joint of layers once more, from ``docs/rules.md`` and another way.

Small steps instead of lines: the elements of the steel are put back on their limits after each
step, which is exact but for wear, and of first order in the step with it; the joint finds its
opening from the axial force at every step, not by straight lines between events. Springs are
values: `step` gives the force and the spring as it is then, and leaves the one it began from.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
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
    largest: float = 0.0  # closing so far
    top: float = 0.0  # force there without wear
    strongest: float = 0.0  # largest force so far without wear
    rest: float = 0.0  # plastic closing
    gap: float = 0.0  # from there back to the touch
    widest: float = 0.0
    strength: float = 1.0
    c: float = 0.0

    def envelope(self, c: float) -> float:
        r = self.k / (self.k - self.f_peak / self.d_peak)
        if c <= self.d_peak:
            rising = self.f_peak * CHORDS * r / (r - 1 + CHORDS**r)
            return float(np.interp(c / self.d_peak, CHORDS, rising))
        return max(self.f_peak - self.k_soft * (c - self.d_peak), self.f_res)

    def plastic_closing(self, c: float, force: float) -> float:
        def share(x: float) -> float:
            return 0.145 * x**2 + 0.13 * x if x <= 2 else 0.84 + 0.834 * (x - 2)

        plastic = self.plastic * (share(c / self.d_peak) - share(0.25)) * self.d_peak
        return max(0.0, min(plastic, c - force / self.k))

    def step(self, d: float) -> tuple[float, Concrete]:
        c = -d
        new = replace(self, c=c)
        if c >= self.largest:
            top = self.envelope(c)
            # On the way there the force was largest at the peak of the envelope.
            strongest = max(self.strongest, self.f_peak if c >= self.d_peak else top)
            gap = self.gap * (self.strongest / strongest if strongest else 1.0)
            rest = self.plastic_closing(c, top)
            return -self.strength * top, replace(
                new, largest=c, top=top, strongest=strongest, rest=rest, gap=gap
            )
        touch = self.rest - self.gap
        if c > touch:
            shares = [0.0, self.contact, 1.0] if self.gap else [0.0, 1.0]
            full = [self.rest + part * (self.largest - self.rest) for part in shares]
            places = [touch, *full[1:]] if self.gap else full
            force = np.interp(c, places, shares) * self.strength * self.top
            return -float(force), new
        start, width = self.rest - min(self.c, touch), self.rest - c
        if width <= start:
            return 0.0, new

        def way(w: float) -> float:
            """Integral of dw/(widest so far + d_peak)."""
            inside = min(w, self.widest) / (self.widest + self.d_peak)
            return inside + np.log(
                (max(w, self.widest) + self.d_peak) / (self.widest + self.d_peak)
            )

        part = (way(width) - way(start)) * min(1.0, 0.5 * self.largest / self.d_peak)
        return 0.0, replace(
            new,
            strength=self.strength * (1 - self.wear) ** part,
            gap=max(self.gap, self.misfit * width),
            widest=max(self.widest, width),
        )


SLOPES = np.array([1, 0.94, 0.75, 0.5, 0.25, 0.08, 0.015, 0])
SHARES = SLOPES[:-1] - SLOPES[1:]


@cache
def limits(  # one argument for each parameter that shapes the table
    r0: float,
    cr1: float,
    cr2: float,
    hardening: float,
    reach: float,
    plateau: float,
    last: float | None,
) -> tuple[Any, Any]:
    """Rows of the plastic reach, and the limits of the elements in them."""
    rows = np.array([0.0, *(0.1 * 2**i for i in range(11))])
    if last is not None and plateau:
        for corner in (plateau, plateau + last - 1):
            near = np.argmin(np.abs(rows - corner))
            if abs(rows[near] - corner) <= 1e-6 * max(1, corner):
                rows[near] = corner
            else:
                rows = np.sort([*rows, corner])
    table = [np.ones(7)]
    for q, way in zip(rows[1:], np.diff(rows), strict=True):
        reached = min(q, 102.4)
        r = max(0.8, r0 * (1 - cr1 * reached / (cr2 + reached)))
        p = r / (r + 1)
        c = (1 - 0.03 / r) * (1 - SLOPES**p) ** (1 / p)
        c[0], c[-1] = 0, 1
        before = table[-1]
        strength = 1 + hardening * (reached / 2 / reach) ** 0.8
        strength = min(strength, SHARES @ before + 0.9 * way)
        wanted = strength * np.diff(c) / SHARES
        low, high = np.maximum(before - way, 0), before + way

        def row(shift: float, wanted: Any = wanted, low: Any = low, high: Any = high) -> Any:
            return np.clip(wanted + shift, low, high)

        def excess(shift: float, row: Any = row, strength: float = strength) -> float:
            return SHARES @ row(shift) - strength

        table.append(row(brentq(excess, -1e3, 1e3, xtol=1e-15, rtol=1e-14)))
    hardest = np.full(rows.size, np.inf if last is None else last)
    if last is not None and plateau:
        hardest = 1 + np.clip(rows - plateau, 0, last - 1)
    return rows, np.column_stack([np.array(table), hardest])


@dataclass(frozen=True)
class Steel:
    """Section 10: elements that are put back on their limits after every step."""

    k: float
    f_y: float
    k_post: float
    r0: float = 20.0
    cr1: float = 0.925
    cr2: float = 0.15
    isotropic_hardening: float = 0.0
    hardening_reach: float = 1.0
    f_u: float | None = None
    plateau: float = 0.0
    endurance: float = 0.0
    d: float = 0.0
    f: float = 0.0
    elements: tuple[float, ...] = (0.0,) * 8
    highest: float = 0.0
    lowest: float = 0.0
    worn: float = 0.0

    def step(self, d: float) -> tuple[float, Steel]:
        d_y, b = self.f_y / self.k, self.k_post / self.k
        last = None if self.f_u is None else (self.f_u / self.f_y - (1 - b)) / b
        rows, table = limits(
            self.r0,
            self.cr1,
            self.cr2,
            self.isotropic_hardening,
            self.hardening_reach,
            self.plateau,
            last,
        )
        high, low = max(self.highest, d_y, d), min(self.lowest, -d_y, d)
        q = (high - low) / d_y - 2
        stiffness = np.append((self.k - self.k_post) * SHARES, self.k_post)
        left = 1.0
        if self.endurance:
            left = max(0.0, 1 - self.worn / (2 * self.endurance * d_y))
        reach = np.array([np.interp(q, rows, column) for column in table.T[:7]])
        reach = np.append(reach, np.inf if last is None else np.interp(q, rows, table.T[7]))
        bound = np.where(np.isinf(reach), np.inf, 1.0) * left * stiffness * d_y
        bound = bound * np.where(np.isinf(reach), 1.0, reach)
        bound[np.isnan(bound)] = np.inf
        elements = np.clip(np.array(self.elements) + stiffness * (d - self.d), -bound, bound)
        force, worn = float(elements.sum()), self.worn
        if self.endurance and self.lowest < d < self.highest:
            worn += abs((d - self.d) - (force - self.f) / self.k)
        return force, replace(
            self,
            d=d,
            f=force,
            elements=tuple(elements),
            highest=max(self.highest, d_y, d),
            lowest=min(self.lowest, -d_y, d),
            worn=worn,
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
