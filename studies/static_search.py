"""Random search for static paths with finite rotations that end where the column could go on.

    python studies/static_search.py [paths] [seed]

A path that ends is followed again: with its targets moved by shares of 1e-9, 1e-7 and 1e-5, and
with more targets on the way. A limit of the column itself (the top snaps back, the force is beyond
the capacity) stands in the same place for all of them; where a neighbour comes farther, the end was
a fault of the search for the path. A path that is complete is followed with more targets too: the
same rows must come out, unless they differ for no neighbour (a target that is a former peak to the
last digits, where Takeda's rule jumps). Uses the installed package alone and two processors; prints
the failures, then one line of counts.
"""

from __future__ import annotations

import itertools
import multiprocessing
import sys
import warnings

import numpy as np

import rbsdem
from rbsdem.springs import Bilinear, Elastic, PeakOriented, Spring, Takeda

Generator = np.random.Generator

#: How far beyond the end of a path a neighbour may come, as a share of all that was driven.
SAME_END = 1e-3

#: Difference of two answers to the same question, in shares of the largest value.
SAME_ANSWER = 1e-6


def spring(rng: Generator, force: float, yielding: float, *, softens: bool) -> Spring:
    """Return a spring of some rule that yields near a force and a deformation."""
    kind = rng.integers(5 if softens else 4)
    k = force / yielding
    post = k * 10 ** rng.uniform(-3, -0.5)
    if kind == 0:
        return Elastic(k)
    if kind == 1:
        return Bilinear(k, yielding, post)
    if kind in (2, 3):
        crack = yielding * rng.uniform(0.05, 0.5)
        k_y = k * rng.uniform(0.3, 1.0)
        return Takeda(
            k_c=k * rng.uniform(1.05, 3.0),
            d_c=crack,
            k_y=k_y,
            d_y=yielding,
            k_u=k_y * 10 ** rng.uniform(-3, -0.5),
            b0=rng.choice([0.0, 0.4]),
            b1=rng.uniform(0.5, 1.0),
            inner=str(rng.choice(["kc", "kr", "one"])),
        )
    cap = yielding * rng.uniform(3, 10)
    top = force * rng.uniform(1.01, 1.3)
    return PeakOriented(
        yielding, force, cap, top, cap * rng.uniform(3, 20), top * rng.uniform(0.05, 0.4)
    )


def problem(rng: Generator) -> tuple[rbsdem.Column, bool, list[float]]:
    """Return a column, whether its force is driven, and the targets."""
    n = int(rng.choice([1, 1, 2, 2, 3, 5]))
    height = rng.uniform(1.0, 4.0)
    moment = 10 ** rng.uniform(4.5, 6)
    softens = bool(rng.random() < 0.2)
    shear = [
        spring(
            rng, moment / height * rng.uniform(0.7, 3), 10 ** rng.uniform(-4, -2), softens=softens
        )
        for _ in range(n)
    ]
    flexure = [
        spring(
            rng,
            moment * (1 - 0.8 * i / n) * rng.uniform(0.7, 2.0),
            10 ** rng.uniform(-3.5, -2),
            softens=softens,
        )
        for i in range(n)
    ]
    if rng.random() < 0.4:
        shear, flexure = [shear[0]] * n, [flexure[0]] * n
    more = {}
    if rng.random() < 0.15:
        more["axial_spring"] = [Elastic(10 ** rng.uniform(8, 9.5)) for _ in range(n)]
    load = rng.choice([0.0, 0.0, rng.uniform(0, 0.1), rng.uniform(0, 0.6)])
    column = rbsdem.Column(
        height, 600.0, shear, flexure, n=n, kinematics="finite",
        axial_load=float(load) * moment / height * 10,
        self_weight=bool(rng.random() < 0.2), **more,
    )  # fmt: skip
    by_force = bool(rng.random() < 0.3)
    if by_force:
        largest = moment / height * 10 ** rng.uniform(-1, 0.3)
    else:
        largest = height * 10 ** rng.uniform(-3, -0.7)
    return column, by_force, targets(rng, largest)


def targets(rng: Generator, largest: float) -> list[float]:
    """Return targets, many of them where the path has been before."""
    found = [largest * rng.uniform(0.1, 1)]
    for _ in range(rng.integers(3, 14)):
        old = found[rng.integers(len(found))]
        kind = rng.integers(7)
        found.append(
            [
                largest * rng.uniform(-1, 1),
                old,
                -old,
                0.0,
                old * rng.uniform(0.2, 1.2),
                found[-1] * (1 + 10.0 ** rng.uniform(-14, -1)),
                round(found[-1] * rng.uniform(-1.5, 1.5), 3),
            ][kind]
        )
    return [float(x) for x in found]


def follow(column: rbsdem.Column, by_force: bool, values: list[float]) -> tuple[np.ndarray, str]:
    """Return the rows that were found, displacement and force, and the message if it failed."""
    drive = {"force" if by_force else "displacement": values}
    message = ""
    try:
        result = rbsdem.cyclic(column, **drive)
    except rbsdem.SolveError as error:
        message = str(error)
        if error.result is None:
            return np.zeros((0, 2)), message
        result = error.result
    return np.column_stack([result.displacement, result.force]), message


def divided(values: list[float], parts: int) -> list[float]:
    """Return the targets with others between them."""
    ends = zip([0.0, *values[:-1]], values, strict=True)
    return [
        b if j == parts else a + (b - a) * j / parts for a, b in ends for j in range(1, parts + 1)
    ]


def travelled(rows: np.ndarray, by_force: bool) -> float:
    """Return the length of the path, as what is driven."""
    return float(np.sum(np.abs(np.diff(rows[:, int(by_force)], prepend=0.0))))


def distance(rows: np.ndarray, others: np.ndarray) -> float:
    """Return the largest difference of two answers, in shares of the largest value."""
    return float(np.max(np.abs(others - rows) / np.max(np.abs(rows), axis=0, initial=1e-300)))


def judge(seed: tuple[int, int]) -> tuple[str, str]:
    """Follow one path; return its class and what is to be said of it."""
    rng = np.random.default_rng(seed)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            column, by_force, values = problem(rng)
        except rbsdem.InputError:
            return "no column", ""
        rows, message = follow(column, by_force, values)
        if message:
            kind = "end"
            if ends_wrongly(rng, column, by_force, values, travelled(rows, by_force)):
                kind = "WRONG END"
        else:
            values = divided(values, 3)
            fine, message = follow(column, by_force, values)
            if message:
                kind = "WRONG END"
            elif distance(rows, fine[2::3]) <= SAME_ANSWER:
                kind = "complete"
            else:
                kind = "at a former peak"
                if jumps(rng, column, by_force, values[2::3]):
                    kind = "TWO ANSWERS"
                message = f"{distance(rows, fine[2::3]):.1e}"
    text = f"n={column.n} {by_force=} {values}\n    {message}" if kind.isupper() else ""
    return kind, text


def ends_wrongly(
    rng: Generator, column: rbsdem.Column, by_force: bool, values: list[float], end: float
) -> bool:
    """Return whether a neighbour of a path comes farther than its end."""
    others = [divided(values, 2), divided(values, 7)]
    for size in (1e-9, 1e-7, 1e-5):
        moved = [x * (1 + size * rng.uniform(-1, 1)) for x in values]
        others += [moved, divided(moved, 3)]
    whole = float(np.sum(np.abs(np.diff(values, prepend=0.0))))
    return any(
        len(far) and travelled(far, by_force) > end + SAME_END * whole
        for far, _ in (follow(column, by_force, other) for other in others)
    )


def jumps(rng: Generator, column: rbsdem.Column, by_force: bool, values: list[float]) -> bool:
    """Return whether neighbours of a path too have another answer with more targets."""
    for size in (1e-9, 1e-8, 1e-7):
        moved = [x * (1 + size * rng.uniform(-1, 1)) for x in values]
        rows, _ = follow(column, by_force, moved)
        fine, _ = follow(column, by_force, divided(moved, 3))
        if rows.shape != fine[2::3].shape or distance(rows, fine[2::3]) > SAME_ANSWER:
            return True
    return False


def main(count: int = 100_000, first: int = 1) -> None:
    """Follow the paths and print what was found."""
    seeds = list(zip(itertools.repeat(first), range(count), strict=False))
    classes: dict[str, int] = {}
    with multiprocessing.get_context("fork").Pool(2) as pool:
        for seed, (kind, text) in zip(seeds, pool.imap(judge, seeds, chunksize=50), strict=True):
            classes[kind] = classes.get(kind, 0) + 1
            if text:
                print(seed, kind, text, flush=True)
    print(", ".join(f"{kind} {number}" for kind, number in sorted(classes.items())))


if __name__ == "__main__":
    main(*(int(word) for word in sys.argv[1:]))
