"""Independent references for the regression cases: matrices and integrators written out in numpy.

Nothing here is taken from the program: the linear chain is built from the rows of its kinematics,
the chain with exact rotations from a recursion of accelerations (theory, section 2).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.linalg import eigh

G = 9.80665

Array = np.ndarray


@dataclass(frozen=True)
class Linear:
    """Small rotations: matrices in (slips, relative rotations)."""

    mass: Array
    stiffness: Array
    ground: Array  # inertia load per acceleration of the ground
    top: Array  # displacement of the top


def linear_chain(
    lengths: Array,
    masses: Array,
    inertias: Array,
    springs: tuple[Array, Array],
    *,
    lumped: tuple[float, float] = (0.0, 0.0),
    load: float | None = None,
) -> Linear:
    """Matrices of a chain; with an axial `load` the second-order work of load and weight too."""
    n = len(lengths)
    below = np.tril(np.ones((n, n)))
    joints = np.concatenate([[0.0], np.cumsum(lengths)[:-1]])
    centres = joints + lengths / 2
    rows = np.hstack([below, below * (centres[:, None] - joints)])
    turns = np.hstack([np.zeros((n, n)), below])
    top = np.concatenate([np.ones(n), lengths.sum() - joints])
    mass = rows.T * masses @ rows + turns.T * inertias @ turns
    mass += lumped[0] * np.outer(top, top) + lumped[1] * np.outer(turns[-1], turns[-1])
    stiffness = np.diag(np.concatenate(springs))
    if load is not None:
        above = np.append(np.cumsum(masses[::-1])[::-1], 0.0)
        turning = (load + G * (masses / 2 + above[1:])) * lengths
        stiffness -= turns.T * turning @ turns
        for i in range(1, n):
            slip = np.eye(2 * n)[i]
            cross = np.outer(slip, turns[i - 1]) * (load + G * above[i])
            stiffness -= cross + cross.T
    return Linear(mass, stiffness, masses @ rows + lumped[0] * top, top)


def modal_damping(chain: Linear, ratios: list[float]) -> Array:
    """Damping that has its ratios in the first modes and none in the others."""
    squares, shapes = eigh(chain.stiffness, chain.mass)
    omega = np.sqrt(squares)
    values = np.zeros_like(omega)
    values[: len(ratios)] = 2 * np.array(ratios) * omega[: len(ratios)]
    return chain.mass @ shapes * values @ shapes.T @ chain.mass


def alpha_method(
    chain: Linear, damping: Array, loads: Array, step: float, rho: float | None = None
) -> Array:
    """Deformations by generalised-alpha (Chung and Hulbert 1993), one row for each row of loads.

    Without rho: average acceleration (Newmark 1959).
    """
    alpha_m, alpha_f = (0.0, 0.0) if rho is None else ((2 * rho - 1) / (rho + 1), rho / (rho + 1))
    gamma = 0.5 - alpha_m + alpha_f
    beta = (1 - alpha_m + alpha_f) ** 2 / 4
    q, v = np.zeros(len(chain.mass)), np.zeros(len(chain.mass))
    a = np.linalg.solve(chain.mass, loads[0])
    matrix = (1 - alpha_m) * chain.mass + (1 - alpha_f) * (
        gamma * step * damping + beta * step**2 * chain.stiffness
    )
    rows = [q]
    for before, after in pairwise(loads):
        q_free = q + step * v + step**2 * (0.5 - beta) * a
        v_free = v + step * (1 - gamma) * a
        right = (1 - alpha_f) * after + alpha_f * before - alpha_m * chain.mass @ a
        right -= chain.stiffness @ ((1 - alpha_f) * q_free + alpha_f * q)
        right -= damping @ ((1 - alpha_f) * v_free + alpha_f * v)
        a = np.linalg.solve(matrix, right)
        q, v = q_free + beta * step**2 * a, v_free + gamma * step * a
        rows.append(q)
    return np.array(rows)


@dataclass(frozen=True)
class Finite:
    """A chain with exact rotations; the last centre is the lumped mass at the top."""

    lengths: Array
    masses: Array
    lumped: float

    def motion(self, q: Array, v: Array) -> tuple[Array, Array, Array, float]:
        """Return velocities and accelerations with q'' = 0 of the centres, of shape (n + 1, 2).

        Also the absolute rates of rotation (n), and the rotation of the top.
        """
        n = len(self.lengths)
        velocity, acceleration, rates = [], [], []
        speed, change = np.zeros(2), np.zeros(2)  # of the top of the body below
        turn = rate = 0.0
        for i in range(n):
            axis, normal = directions(turn)
            speed = speed + v[i] * normal - q[i] * rate * axis
            change = change - 2 * v[i] * rate * axis - q[i] * rate**2 * normal
            turn, rate = turn + q[n + i], rate + v[n + i]
            axis, normal = directions(turn)
            half = self.lengths[i] / 2
            velocity.append(speed + half * rate * normal)
            acceleration.append(change - half * rate**2 * axis)
            speed = speed + self.lengths[i] * rate * normal
            change = change - self.lengths[i] * rate**2 * axis
            rates.append(rate)
        velocity.append(speed)
        acceleration.append(change)
        return np.array(velocity), np.array(acceleration), np.array(rates), turn

    def acceleration(
        self, q: Array, v: Array, forces: Array, springs: Array, damping: float
    ) -> Array:
        """Return q'' for forces on the centres (n + 1, 2), springs and damping of the mass."""
        m = np.append(self.masses, self.lumped)
        inertia = self.masses * self.lengths**2 / 12
        unit = [self.motion(q, row)[::2] for row in np.eye(len(q))]
        jacobian = np.array([velocity for velocity, _ in unit])  # (unknowns, n + 1, 2)
        turns = np.array([rates for _, rates in unit])  # (unknowns, n)
        mass = np.einsum("ikx,k,jkx->ij", jacobian, m, jacobian) + turns * inertia @ turns.T
        _, drift, _, _ = self.motion(q, v)
        load = np.einsum("ikx,kx->i", jacobian, forces - m[:, None] * drift)
        return np.linalg.solve(mass, load - springs * q - damping * mass @ v)


def directions(turn: float) -> tuple[Array, Array]:
    """Return axis and normal of a body."""
    s, c = np.sin(turn), np.cos(turn)
    return np.array([s, c]), np.array([c, -s])


def until(
    solve: Callable[[float, float, Array], Array], stops: Array, state: Array
) -> dict[float, Array]:
    """Go from stop to stop; return the state at each."""
    states = {float(stops[0]): state}
    for begin, end in pairwise(stops):
        state = solve(begin, end, state)
        states[float(end)] = state
    return states
