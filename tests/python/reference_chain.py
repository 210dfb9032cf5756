"""The chain from its energies alone, for tests: Hamilton's equations, derivatives by complex steps.

Kinetic energy T(q, q') and potential U(q) are written down from the positions of the bodies
(theory, section 2). Then p = dT/dq' and p' = d(T - U)/dq + Q. No force of a joint, no acceleration
and no matrix of the program appears. Complex steps differentiate without cancellation, so this is
good to the last digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

import rbsdem

STEP = 1e-30


def no_load(_time: float) -> tuple[float, float, float, float]:
    return 0.0, 0.0, 0.0, 0.0


@dataclass
class Chain:
    """A column with elastic springs and exact rotations.

    `loads(t)` returns lateral force, horizontal and vertical acceleration of the ground and the
    axial load besides the constant one, as the keywords of `rbsdem.time_history`.
    """

    column: rbsdem.Column
    loads: Callable[[float], tuple[float, float, float, float]] = no_load

    def __post_init__(self) -> None:
        c, n = self.column, self.column.n
        ones = np.ones(n)
        self.length = ones * c.height / n if c.lengths is None else np.array(c.lengths)
        own = ones * c.mass * self.length / c.height if c.masses is None else np.array(c.masses)
        self.weight = own * c.gravity * c.self_weight
        inertia = own * (self.length**2 + c.depth**2) / 12
        if c.rotary_inertia is not None:
            inertia = ones * c.rotary_inertia
        # A mass at the top is one more body without length.
        self.own, self.inertia = own, inertia
        springs = [one for name in ("shear", "flexure", "axial_spring") for one in c.joints(name)]
        self.k = np.array([one.k for one in springs])
        self.damping = c.damping or rbsdem.Damping()
        self.size = self.k.size

    def bodies(self, q, v):
        """Centroids, tops of all bodies, rotations, and all their velocities.

        `q` and `v` may have leading axes; the last one is that of the unknowns.
        """
        n = self.column.n
        shape = np.broadcast_shapes(q.shape, v.shape)[:-1]
        kind = np.result_type(q, v)
        top, fast = np.zeros((2, *shape), kind), np.zeros((2, *shape), kind)
        turn, spin = np.zeros(shape, kind), np.zeros(shape, kind)
        rows = []
        for i in range(n):
            e, t = np.array([np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), -np.sin(turn)])
            slide, move = q[..., i], v[..., i]
            bottom = top + slide * t
            rate = fast + move * t - slide * spin * e
            if self.size > 2 * n:
                open_, opens = q[..., 2 * n + i], v[..., 2 * n + i]
                bottom = bottom + open_ * e
                rate = rate + opens * e + open_ * spin * t
            turn, spin = turn + q[..., n + i], spin + v[..., n + i]
            e, t = np.array([np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), -np.sin(turn)])
            half = self.length[i] / 2
            centre, centre_fast = bottom + half * e, rate + half * spin * t
            top, fast = bottom + 2 * half * e, rate + 2 * half * spin * t
            rows.append((centre, centre_fast, turn, spin))
        return rows, (top, fast, turn, spin)

    def kinetic(self, q, v):
        """Kinetic energy relative to the ground [J]."""
        rows, (_, fast, _, spin) = self.bodies(q, v)
        energy = sum(
            m * np.sum(rate**2, axis=0) + inertia * omega**2
            for (_, rate, _, omega), m, inertia in zip(rows, self.own, self.inertia, strict=True)
        )
        c = self.column
        return 0.5 * (energy + c.top_mass * np.sum(fast**2, axis=0) + c.top_inertia * spin**2)

    def potential(self, q):
        """Energy of springs, weight and the constant dead load [J]."""
        rows, (top, *_) = self.bodies(q, np.zeros(self.size))
        energy = 0.5 * np.sum(self.k * q**2, axis=-1)
        energy = energy + sum(g * row[0][1] for g, row in zip(self.weight, rows, strict=True))
        return energy + (not self.column.axial_follows) * self.column.axial_load * top[1]

    def mass(self, q):
        """Mass matrix, the second derivatives of T by the velocities."""
        unit = np.eye(self.size)
        single = self.kinetic(q, unit)
        pair = self.kinetic(q, unit[:, None, :] + unit[None, :, :])
        return pair - single[:, None] - single[None, :]

    def push(self, q, time):
        """Generalised forces of the loads that have no potential here."""
        c = self.column
        lateral, along, upward, axial = self.loads(time)
        rows, (_, fast, turn, _) = self.bodies(q, np.eye(self.size))
        e, t = np.array([np.sin(turn), np.cos(turn)]), np.array([np.cos(turn), -np.sin(turn)])
        across = t if c.force_follows else np.array([[1.0], [0.0]])
        down = -e if c.axial_follows else np.array([[0.0], [-1.0]])
        load = lateral * across + (axial + c.axial_follows * c.axial_load) * down
        ground = np.array([[along], [upward]])
        force = np.sum((load - c.top_mass * ground) * fast, axis=0)
        for (_, rate, *_), m in zip(rows, self.own, strict=True):
            force = force - np.sum(m * ground * rate, axis=0)
        return force

    def slope(self, q, v):
        """d(T - U)/dq at constant velocities."""
        bent = q + 1j * STEP * np.eye(self.size)
        return (self.kinetic(bent, v.astype(complex)) - self.potential(bent)).imag / STEP

    def rates(self, time, state):
        q, p = state[: self.size], state[self.size :]
        v = np.linalg.solve(self.mass(q), p)
        viscous = self.damping.stiffness * self.k * v + self.damping.mass * p
        return np.concatenate([v, self.slope(q, v) + self.push(q, time) - viscous])

    def solve(self, times, q, v, tolerance=1e-11):
        """Deformations at the times, shape (m, unknowns)."""
        q, v = np.asarray(q, dtype=float), np.asarray(v, dtype=float)
        state = np.concatenate([q, self.mass(q) @ v])
        scale = np.max(np.abs(state[self.size :])) + 1e-300
        loose = tolerance * np.concatenate(
            [np.ones(self.size), np.full(self.size, max(scale, 1.0))]
        )
        done = solve_ivp(
            self.rates, (times[0], times[-1]), state, method="DOP853", t_eval=times,
            rtol=tolerance, atol=loose,
        )  # fmt: skip
        assert done.success, done.message
        return done.y[: self.size].T
