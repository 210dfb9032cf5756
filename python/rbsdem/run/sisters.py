"""Columns of a laboratory predicted with its other tests: a Bayes step with the scatter of tests.

Tests of one series (sisters) share a laboratory: its steel, its concrete, its rig. What may differ
from the model is the strength, the fitted numbers of the model, and two things of the rig: a force
against the motion beyond the friction of rigs, which makes loops wider, and the share of the axial
load's second-order force that the record has or lacks. Half of the variance of each is the
laboratory's; the other half two columns have in common the more, the more alike they are. Each
given test is followed along its path; linear in all of these, they give the posterior mean for
another column, and what is left of the scatter makes its band narrower.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rbsdem._types import Array
from rbsdem.run.bands import (
    Learned,
    changed_column,
    distance,
    features_of,
    forces_of_rig,
    path_force,
    scatter_of_tests,
)
from rbsdem.section.layered import LayeredColumn
from rbsdem.section.parameters import Row, table

#: Standard deviations: of the fitted numbers, in spreads of their priors; of the force against the
#: motion, over the largest; of the share of the second-order force.
_NUMBERS, _FRICTION, _SECOND_ORDER = 0.4, 0.07, 0.4
#: Error of a loop whose numbers are right, over its largest force, for all of the loop as one
#: number.
_ERROR = 0.02
#: Error of the shape of loops, that no number explains, likewise; it is in bands whatever is known.
_SHAPE = 0.12
#: Difference for slopes, in spreads; farthest that a number goes, in standard deviations.
_STEP, _FARTHEST = 0.5, 3.0


@dataclass(frozen=True)
class Loop:
    """A given test: its column, displacements [m] and forces [N]."""

    column: LayeredColumn
    displacement: Array
    force: Array


@dataclass(frozen=True)
class Told:
    """What a given test says.

    Attributes
    ----------
    features : tuple of float
        Properties by which its column is compared, see `rbsdem.run.bands.features_of`.
    information : ndarray, shape (k, k)
        About the logarithm of the strength, the fitted numbers, friction and second-order force.
    pull : ndarray, shape (k,)
        The information times their values.
    """

    features: tuple[float, ...]
    information: Array
    pull: Array


def learn(column: LayeredColumn, displacement: Array, given: Sequence[Told]) -> Learned:
    """Return a column as tests of its laboratory make it.

    Parameters
    ----------
    column : LayeredColumn
        The column.
    displacement : ndarray, shape (m,)
        The path along which it is to be predicted [m].
    given : sequence of Told
        What each test says.

    Notes
    -----
    Of the numbers x_i of column i with standard deviations s the prior has the covariance
    (1 + exp(-distance of i and j))/2 s^2. With A the information of the tests, b the pull, K the
    prior of the tests and k that of them with the column, the mean is k (1 + A K)^-1 b.
    """
    sizes = _sizes()
    features = _features(column)
    variance = np.diag(sizes**2)

    def alike(some: Sequence[tuple[float, ...]]) -> Array:
        """Return the correlations of columns, by their features, with the given tests."""
        return np.array(
            [[0.5 + 0.5 * math.exp(-distance(a, test.features)) for test in given] for a in some]
        )

    # Covariances of all numbers of the given tests, and of those of the column with them.
    number, size = len(given), sizes.size
    prior = np.kron(alike([test.features for test in given]), variance)
    with_column = np.kron(alike([features]), variance)
    blocks = np.zeros((number, size, number, size))
    for i, test in enumerate(given):
        blocks[i, :, i, :] = test.information
    information = blocks.reshape(prior.shape)
    pull = np.concatenate([test.pull for test in given])
    # First column: the posterior mean; the others: by what the covariance becomes smaller.
    known = np.column_stack([pull, information @ with_column.T])
    known = with_column @ np.linalg.solve(np.eye(len(prior)) + information @ prior, known)
    places = np.clip(known[:, 0], -_FARTHEST * sizes, _FARTHEST * sizes).tolist()
    force = path_force(column, displacement, rig=True)
    slopes = _slopes(column, displacement, force)
    about = slopes.T @ (_lengths(displacement)[:, None] * slopes)
    before = float(np.trace(about @ variance)) + (_SHAPE * float(np.max(np.abs(force)))) ** 2
    left = 1.0 - float(np.trace(about @ known[:, 1:])) / before
    return Learned(
        tests=number,
        column=_moved(column, places[1:-2]),
        strength=math.exp(places[0]),
        friction=places[-2],
        second_order=places[-1],
        left=math.sqrt(left),
    )


def told(loop: Loop) -> Told:
    """Return what a test says of its laboratory: the equations of least squares along its path.

    Parameters
    ----------
    loop : Loop
        The test.
    """
    column, d, scale = loop.column, loop.displacement, float(np.max(np.abs(loop.force)))
    force = path_force(column, d, rig=True)
    slopes = _slopes(column, d, force)
    weighted = slopes.T * (_lengths(d) / (scale * _ERROR) ** 2)
    return Told(_features(column), weighted @ slopes, weighted @ (loop.force - force))


def _fitted() -> list[Row]:
    """Return the rows of the parameters that were fitted to tests: those with a spread."""
    return [row for row in table().values() if row.spread > 0]


def _sizes() -> Array:
    """Return the standard deviations: strength, fitted numbers, friction, second-order force."""
    strength = math.hypot(*scatter_of_tests().strength)
    return np.array([strength, *[_NUMBERS] * len(_fitted()), _FRICTION, _SECOND_ORDER])


def _slopes(column: LayeredColumn, displacement: Array, force: Array) -> Array:
    """Return the changes of the force along a path with each number of `_sizes`, shape (m, k) [N].

    By the logarithm of the strength, by spreads of the fitted numbers, and by shares of the rig.
    """
    unit = _STEP * np.eye(len(_fitted()))
    moved = [path_force(_moved(column, places), displacement, rig=True) for places in unit.tolist()]
    by_numbers = [(other - force) / _STEP for other in moved]
    return np.column_stack([force, *by_numbers, *forces_of_rig(column, displacement, force)])


def _moved(column: LayeredColumn, places: Sequence[float]) -> LayeredColumn:
    """Return a column whose fitted numbers are off by `places` spreads of their priors.

    The spreads of positive numbers are those of their logarithms.
    """
    now, values = column._drawing.parameters.values, {}
    for row, place in zip(_fitted(), places, strict=True):
        way = row.spread * place
        values[row.name] = now[row.name] * math.exp(way) if row.prior > 0 else now[row.name] + way
    return changed_column(column, values)


def _lengths(displacement: Array) -> Array:
    """Return the share of each row in the length of the path."""
    length = np.gradient(np.concatenate([[0.0], np.cumsum(np.abs(np.diff(displacement)))]))
    return np.asarray(np.maximum(length, 0.0) / length.sum())


def _features(column: LayeredColumn) -> tuple[float, ...]:
    """Return the properties by which a column is compared, see `features_of`."""
    return features_of(column._drawing.section, column.height, column._drawing.axial_load)
