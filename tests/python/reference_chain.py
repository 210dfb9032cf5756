"""The elastic chain of rigid bodies once more, for tests: linear, and with exact rotations.

`Linear` is built from the rows of the kinematics and the second derivatives of the height of the
loads (theory, sections 2 and 3); its motion is exact by the matrix exponential.

`Chain` knows the energies alone. Kinetic energy T(q, q') and potential U(q) are written down from
the positions of the bodies. Then p = dT/dq' and p' = d(T - U)/dq + Q. No force of a joint, no
acceleration and no matrix of the program appears. Complex steps differentiate without
cancellation, so this is good to the last digits.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh, expm

import rbsdem
from rbsdem.springs import Elastic

STEP = 1e-30


def chain(lengths, masses, shear, flexure, **options) -> rbsdem.Column:
    """Return a column with these elastic springs."""
    springs = ([Elastic(float(k)) for k in values] for values in (shear, flexure))
    return rbsdem.Column(
        float(np.sum(lengths)), None, *springs, n=len(lengths), lengths=list(lengths),
        masses=list(masses), **options,
    )  # fmt: skip


def bodies_of(c: rbsdem.Column) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return lengths, masses and rotary inertias of the bodies."""
    ones = np.ones(c.n)
    length = ones * c.height / c.n if c.lengths is None else np.array(c.lengths)
    mass = ones * c.mass * length / c.height if c.masses is None else np.array(c.masses)
    inertia = mass * (length**2 + c.depth**2) / 12
    return length, mass, inertia if c.rotary_inertia is None else ones * c.rotary_inertia


def deformations(run: rbsdem.Result) -> np.ndarray:
    """Return slips, rotations and, if there are any, openings: a row for each row of a result."""
    return np.hstack([run.slip, run.rotation] + [run.opening] * (run.axial_force is not None))


def as_initial(q: np.ndarray, v: np.ndarray | None = None, n: int = 1) -> dict[str, np.ndarray]:
    """Return deformations and velocities as the keyword `initial`."""
    names = ("slip", "rotation", "opening")[: len(q) // n]
    parts = dict(zip(names, np.split(q, len(names)), strict=True))
    if v is not None:
        names = tuple(f"{name}_velocity" for name in names)
        parts |= dict(zip(names, np.split(v, len(names)), strict=True))
    return parts


class Linear:
    """A column with elastic springs and small rotations in slips and relative rotations q.

    mass q'' + damping q' + stiffness q = arm F - ground a, stiffness with the second-order work of
    axial load and weight unless the kinematics are "small".
    """

    def __init__(self, column: rbsdem.Column) -> None:
        n = column.n
        self.column = column
        self.length, masses, inertia = bodies_of(column)
        joint = np.concatenate([[0.0], np.cumsum(self.length)[:-1]])
        below = np.tril(np.ones((n, n)))
        centre = np.hstack([below, below * (joint[:, None] + self.length[:, None] / 2 - joint)])
        self.turn = np.hstack([np.zeros((n, n)), below])
        self.arm = np.concatenate([np.ones(n), self.length.sum() - joint])
        self.mass = centre.T * masses @ centre + self.turn.T * inertia @ self.turn
        self.mass += column.top_mass * np.outer(self.arm, self.arm)
        self.mass += column.top_inertia * np.outer(self.turn[-1], self.turn[-1])
        self.ground = centre.T @ masses + column.top_mass * self.arm
        self.k = np.array([s.k for s in (*column.joints("shear"), *column.joints("flexure"))])
        self.stiffness = np.diag(self.k)
        if column.kinematics != "small":
            weights = masses * column.gravity * column.self_weight
            self.stiffness = self.stiffness - self.leaning(column.axial_load, weights)
        given = column.damping or rbsdem.Damping()
        self.damping = given.mass * self.mass + given.stiffness * np.diag(self.k)
        if given.modal is not None:
            squares, shapes = eigh(self.stiffness, self.mass)
            rates = 2 * np.sqrt(squares) * np.resize(given.modal, 2 * n)
            if np.size(given.modal) > 1:
                rates[np.size(given.modal) :] = 0.0
            carried = self.mass @ shapes
            self.damping = self.damping + carried * rates @ carried.T

    def leaning(self, load: float, weights: np.ndarray) -> np.ndarray:
        """Return second derivatives of how far load and weights come down, times each of them.

        A height is the sum of l_k (1 - th_k^2/2) over the lengths below it, less u_k th_{k-1}.
        """
        n = len(self.length)
        above = load + np.append(np.cumsum(weights[::-1])[::-1], 0.0)
        turning = (above[1:] + weights / 2) * self.length
        total = self.turn.T * turning @ self.turn
        for k in range(1, n):
            cross = np.outer(np.eye(2 * n)[k], self.turn[k - 1]) * above[k]
            total += cross + cross.T
        return total

    def critical_load(self) -> float:
        """Return the least compression that takes the stiffness away."""
        root = np.sqrt(self.k)
        second = self.leaning(1.0, np.zeros(len(self.length)))
        return 1.0 / eigh(second / root / root[:, None], eigvals_only=True)[-1]

    @cached_property
    def matrix(self) -> np.ndarray:
        """Of the equation of motion as a system of first order."""
        solved = np.linalg.solve(self.mass, np.hstack([-self.stiffness, -self.damping]))
        size = len(self.k)
        return np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), solved])

    def solve(self, times, loads, start=None) -> np.ndarray:
        """Return rows (q, q') at times; `loads` are rows (F, a), linear between them. Exact."""
        size = 2 * len(self.k)
        block = np.zeros((size + 4, size + 4))
        block[:size, :size] = self.matrix
        pushes = np.column_stack([self.arm, -self.ground])
        block[size // 2 : size, size : size + 2] = np.linalg.solve(self.mass, pushes)
        block[size : size + 2, size + 2 :] = np.eye(2)
        carried: dict[float, np.ndarray] = {}
        rows = [np.zeros(size) if start is None else np.asarray(start, dtype=float)]
        spacings = np.round(np.diff(times), 15).tolist()
        for spacing, (now, then) in zip(spacings, pairwise(loads), strict=True):
            if spacing not in carried:
                carried[spacing] = expm(block * spacing)[:size]
            state = np.concatenate([rows[-1], now, (np.asarray(then) - now) / spacing])
            rows.append(carried[spacing] @ state)
        return np.array(rows)

    def distance(self, run: rbsdem.Result, rows: np.ndarray) -> float:
        """Return the largest distance of the deformations by their energy, relative."""
        expected = rows[:, : len(self.k)]
        wrong = np.sqrt((deformations(run) - expected) ** 2 @ self.k)
        return float(wrong.max() / np.sqrt(expected**2 @ self.k).max())

    def steps(self, method: str, loads, step: float, rho: float = 1.0, start=None) -> np.ndarray:
        """Return rows q by a method in steps of one length, a row for each row (F, a) of loads.

        `rk4`, or Newmark (1959), Hilber, Hughes and Taylor (1977), Chung and Hulbert (1993).
        """
        size = len(self.k)
        pushes = np.linalg.solve(self.mass, np.column_stack([self.arm, -self.ground])) @ loads.T
        q, v = np.split(np.zeros(2 * size) if start is None else np.asarray(start), 2)
        damping, stiffness = -self.matrix[size:, size:], -self.matrix[size:, :size]
        rows = [q]
        if method == "rk4":
            z, push = np.concatenate([q, v]), np.vstack([0 * pushes, pushes]).T
            for before, after in pairwise(push):
                k_1 = self.matrix @ z + before
                k_2 = self.matrix @ (z + step / 2 * k_1) + (before + after) / 2
                k_3 = self.matrix @ (z + step / 2 * k_2) + (before + after) / 2
                k_4 = self.matrix @ (z + step * k_3) + after
                z = z + step / 6 * (k_1 + 2 * k_2 + 2 * k_3 + k_4)
                rows.append(z[:size])
            return np.array(rows)
        alpha_m, alpha_f = {
            "newmark": (0.0, 0.0),
            "hht": (0.0, (1 - rho) / (1 + rho)),
            "generalised_alpha": ((2 * rho - 1) / (rho + 1), rho / (rho + 1)),
        }[method]
        gamma, beta = 0.5 - alpha_m + alpha_f, (1 - alpha_m + alpha_f) ** 2 / 4
        a = pushes[:, 0] - damping @ v - stiffness @ q
        matrix = (1 - alpha_m) * np.eye(size) + (1 - alpha_f) * (
            gamma * step * damping + beta * step**2 * stiffness
        )
        for before, after in pairwise(pushes.T):
            q_free = q + step * v + step**2 * (0.5 - beta) * a
            v_free = v + step * (1 - gamma) * a
            right = (1 - alpha_f) * after + alpha_f * before - alpha_m * a
            right -= stiffness @ ((1 - alpha_f) * q_free + alpha_f * q)
            right -= damping @ ((1 - alpha_f) * v_free + alpha_f * v)
            a = np.linalg.solve(matrix, right)
            q, v = q_free + beta * step**2 * a, v_free + gamma * step * a
            rows.append(q)
        return np.array(rows)


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
        c = self.column
        self.length, self.own, self.inertia = bodies_of(c)
        self.weight = self.own * c.gravity * c.self_weight
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
        return energy + self.column.axial_load * top[1]

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
        rows, (_, fast, _, _) = self.bodies(q, np.eye(self.size))
        load = np.array([[lateral], [-axial]])
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
