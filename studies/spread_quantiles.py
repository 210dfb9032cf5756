"""Quantiles of left-out tests.

Used by `studies/spread_table.py`, which says what they are for.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from rbsdem.run.bands import Features
from rbsdem.run.bands import between as features_between

#: What bands and intervals are to hold.
LEVEL = 0.8


class Numbers(NamedTuple):
    """A left-out test against its prediction.

    Attributes
    ----------
    near : Features
        How near the model is to its shear strength, and how slender the column is.
    logs : dict of str to float
        ln of test over model. Of a drift at loss that the model does not come to along the path,
        the largest drift stands for it; NaN where the test did not come to it.
    beyond : bool
        Whether the model does not lose its strength along the path, so that there is no upper end.
    """

    near: Features
    logs: dict[str, float]
    beyond: bool


def quantile(values: np.ndarray, weight: np.ndarray, share: float) -> float:
    """Return the value with a share of the weight below."""
    order = np.argsort(values, kind="stable")
    below = np.cumsum(weight[order])
    return float(values[order][np.searchsorted(below, share * below[-1], side="left")])


def parts(near: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return which tests are far from the shear strength, and at it which are squat or slender."""
    at, tall = near[:, 0] >= 0.5, near[:, 1] >= 0.5
    return ~at, at & ~tall, at & tall


def between(ends: np.ndarray, near: np.ndarray) -> np.ndarray:
    """Return numbers between those of the three parts, shape (tests, ...)."""
    one = (-1, *(1 for _ in ends.shape[1:]))
    return features_between(ends, Features(near[:, 0].reshape(one), near[:, 1].reshape(one)))


def weights(series: np.ndarray) -> np.ndarray:
    """Return what each test counts."""
    return np.array([1 / math.sqrt(np.sum(series == name)) for name in series])


class Tests:
    """Left-out tests with what is needed for quantiles: of a number, or of the band."""

    def __init__(self, series: np.ndarray, group: np.ndarray, near: np.ndarray) -> None:
        self.group, self.near = group, near
        self.weight = weights(series)

    def ends(self, chosen: np.ndarray, tail: np.ndarray) -> np.ndarray:
        """Return the ends of the three parts."""
        raise NotImplementedError

    def held(self, ends: np.ndarray) -> np.ndarray:
        """Return the share of each test that is within the ends; NaN if it does not count."""
        raise NotImplementedError

    def tail(self, chosen: np.ndarray) -> np.ndarray:
        """Return the tails of the parts with which chosen groups, each left out, hold 80 %."""
        groups = sorted(set(self.group[chosen].tolist()))
        share, found = 1 - LEVEL, np.full(3, np.nan)
        while np.any(np.isnan(found)):
            held = np.full(len(self.near), np.nan)
            for one in groups:
                own = chosen & (self.group == one)
                held[own] = self.held(self.ends(chosen & ~own, np.full(3, share)))[own]
            for number, part in enumerate(parts(self.near)):
                known = part & np.isfinite(held)
                enough = np.average(held[known], weights=self.weight[known]) >= LEVEL
                if np.isnan(found[number]) and (enough or share <= 0.02):
                    found[number] = share
            share -= 0.005
        return found


class Ratios(Tests):
    """A number: ends are those of ln of test over model."""

    def __init__(self, rows: list[Numbers], name: str, *about: np.ndarray) -> None:
        super().__init__(*about)
        self.log = np.array([row.logs[name] for row in rows])
        self.beyond = np.array([row.beyond and name == "drift" for row in rows])
        self.drift = name == "drift"

    def ends(self, chosen: np.ndarray, tail: np.ndarray) -> np.ndarray:
        """Return the quantiles; a model without a loss tells nothing of the upper one."""
        found = []
        for place, share in zip(parts(self.near), tail, strict=True):
            low = chosen & place & np.isfinite(self.log)
            high = low & ~self.beyond
            found.append(
                (
                    quantile(self.log[low], self.weight[low], share / 2),
                    -quantile(-self.log[high], self.weight[high], share / 2),
                )
            )
        return np.array(found)

    def held(self, ends: np.ndarray) -> np.ndarray:
        """Return which tests are within; one without a loss is, where there is no upper end."""
        low, high = between(ends, self.near).T
        # Beyond the path no more is said than that the loss comes after a part of it.
        low = np.where(self.beyond, np.minimum(low, 0.0), low)
        inside = (low <= self.log) & ((self.log <= high) | self.beyond)
        held = np.where(np.isfinite(self.log), inside, np.nan)
        return np.where(np.isnan(self.log) & self.drift, self.beyond, held)


class Points(Tests):
    """The force along the path: the end is what the band is widened by."""

    def __init__(self, scores: np.ndarray, *about: np.ndarray) -> None:
        super().__init__(*about)
        #: Distances over the half band.
        self.scores = scores

    def ends(self, chosen: np.ndarray, tail: np.ndarray) -> np.ndarray:
        """Return the distance over the half band below which the points are."""
        found = []
        for place, share in zip(parts(self.near), tail, strict=True):
            part = self.scores[chosen & place]
            weight = np.repeat(self.weight[chosen & place], part.shape[1])
            found.append(quantile(part.ravel(), weight, 1 - share))
        return np.array(found)

    def held(self, ends: np.ndarray) -> np.ndarray:
        """Return the share of the points of each test within the band."""
        return np.mean(self.scores <= between(ends, self.near)[:, None], axis=1)
