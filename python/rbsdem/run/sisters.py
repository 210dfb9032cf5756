"""Columns of a laboratory predicted with its other tests: a Bayes step with the scatter of bands.

Tests of one series (sisters) share a laboratory: its steel, its concrete, its rig. `Scatter` has
how far the strength, the stiffness and the degradation of a laboratory are off, and how far those
of a test in it. Each given test is followed along its path; the loop, linear in the logarithms of
three factors, tells them with some information, and the posterior mean of the laboratory moves the
prediction of another column. The scatter that remains is smaller, and so the band is narrower.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rbsdem._types import Array
from rbsdem.run.bands import Scatter, factored_force
from rbsdem.section.layered import LayeredColumn

#: Error of a loop whose factors are right, over its largest force, for all of the loop as one
#: number.
_ERROR = 0.02
#: Gauss-Newton steps, and the difference for slopes in standard deviations.
_STEPS, _STEP = 3, 0.5
#: Farthest that a factor goes, in standard deviations.
_FARTHEST = 3.0


@dataclass(frozen=True)
class Loop:
    """A given test: its column, displacements [m] and forces [N]."""

    column: LayeredColumn
    displacement: Array
    force: Array


@dataclass(frozen=True)
class Learned:
    """Factors of a laboratory, learned from its tests.

    Attributes
    ----------
    tests : int
        Number of given tests.
    logs : ndarray, shape (3,)
        Logarithms of its factors of strength, stiffness and degradation.
    left : ndarray, shape (3,)
        Standard deviations of them that are left.
    """

    tests: int
    logs: Array
    left: Array


def learn(loops: Sequence[Loop], scatter: Scatter) -> Learned:
    """Return what tests of a laboratory say of it.

    Parameters
    ----------
    loops : sequence of Loop
        The tests.
    scatter : Scatter
        Scatter from laboratory to laboratory, and within one.

    Notes
    -----
    Of test j with the information A_j = J'J/e^2 about its factors x_j = u + v_j, v_j of the scatter
    S within a laboratory, the laboratory has the information (1 + A_j S)^-1 A_j; T of laboratories
    is the prior of u.
    """
    return learn_from([told(loop, scatter) for loop in loops], scatter)


def told(loop: Loop, scatter: Scatter) -> tuple[Array, Array]:
    """Return the information of a loop about the logarithms of its factors, and times them.

    Parameters
    ----------
    loop : Loop
        A test.
    scatter : Scatter
        Scatter from laboratory to laboratory, and within one.
    """
    sizes = np.array([scatter.strength, scatter.stiffness, scatter.degradation])
    return _information(loop, np.maximum(np.hypot(*sizes.T), 1e-6))


def learn_from(tests: Sequence[tuple[Array, Array]], scatter: Scatter) -> Learned:
    """Return what tests say of their laboratory, each as `told` has it.

    Parameters
    ----------
    tests : sequence of (ndarray, ndarray)
        Information about the three logarithms, shape (3, 3), and times them, shape (3,).
    scatter : Scatter
        Scatter from laboratory to laboratory, and within one.
    """
    between, within = np.array([scatter.strength, scatter.stiffness, scatter.degradation]).T
    # Without any scatter nothing can be learned.
    information = np.diag(1.0 / np.maximum(between, 1e-6) ** 2)
    weighted = np.zeros(3)
    for own, pull in tests:
        share = np.linalg.inv(np.eye(3) + own @ np.diag(within**2))
        information = information + share @ own
        weighted = weighted + share @ pull
    covariance = np.linalg.inv(information)
    return Learned(len(tests), covariance @ weighted, np.sqrt(np.diag(covariance)))


def _information(loop: Loop, spread: Array) -> tuple[Array, Array]:
    """Return the information of a loop about the logarithms of its factors, and times them."""
    d, scale = loop.displacement, float(np.max(np.abs(loop.force)))
    # Each part of the path counts by its length.
    length = np.gradient(np.concatenate([[0.0], np.cumsum(np.abs(np.diff(d)))]))
    weight = np.sqrt(np.maximum(length, 0.0) / length.sum()) / (scale * _ERROR)
    logs = np.zeros(3)
    for _ in range(_STEPS):
        force = factored_force(loop.column, d, logs)
        slopes = np.empty((d.size, 3))
        for k, size in enumerate(spread):
            moved = logs + _STEP * size * np.eye(3)[k]
            slopes[:, k] = (factored_force(loop.column, d, moved) - force) / (_STEP * size)
        slopes *= weight[:, None]
        matrix, pull = slopes.T @ slopes, slopes.T @ (weight * (loop.force - force))
        linear = matrix @ logs + pull
        logs = np.linalg.solve(matrix + np.diag(spread**-2.0), linear)
        logs = np.clip(logs, -_FARTHEST * spread, _FARTHEST * spread)
    return matrix, linear
