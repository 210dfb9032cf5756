"""Six directions in the space of the parameters, along which columns are calibrated best.

    python studies/calibration_directions.py DIR STATE [--rounds 7] [--every 2] [--jobs 2] [--write]

A calibration with six numbers need not take six parameters: here each number moves many parameters
together, by a factor to an exponent of its own for each. The directions are found on the flexural
rectangular tests of DIR on which `studies/calibration_choice.py` chooses, every second, or one of
`--every` of these; `studies/calibration_table.py --every 2 --first 1` judges them on the others.

In turns: each test is fitted along the present directions (Levenberg-Marquardt with wide
differences, as the error has kinks); at each fit the slopes of the error by all parameters are
taken; and directions and places of the tests along them are found anew for the linear errors, by
alternating least squares. A test counts by the logarithm of its error, and going far from where the
slopes were taken is paid for. It begins at the six parameters of `calibration_choice.py`. STATE
keeps the directions between starts, also for other tests.

`--write` puts the exponents into data/layered_directions.csv. A unit of a direction is a
standard deviation of its places over the tests, so that the factor e is a usual one.
"""

from __future__ import annotations

import argparse
import math
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import calibration_choice as choice
import numpy as np
from calibration_choice import TOGETHER

from rbsdem.errors import RbsdemError
from rbsdem.run.analysis import reached_force
from rbsdem.section.parameters import table

ROOT = Path(__file__).resolve().parents[1]
ROWS = {name: row for name, row in table().items() if row.low == row.low}
NAMES = list(ROWS)
#: Where the search begins.
START = ("strength", "lengths", "softening", "r0", "core_softening", "plastic")
LOW, HIGH = (np.log([getattr(row, side) for row in ROWS.values()]) for side in ("low", "high"))
#: What a parameter counts in: a sixth of its range, as logarithms, or less.
UNIT = np.minimum((HIGH - LOW) / 6, 0.5)
EVERY = 4
#: Differences for slopes, in units.
STEP = 0.15
#: What a unit away from where the slopes were taken costs, over the squared error.
FAR = 3e-3
#: Exponents below this are left out.
LEAST = 0.05


def error(number: int, places: np.ndarray) -> np.ndarray:
    """Return the error of a test along its path, for places of all parameters."""
    column, target = choice._cases[number]
    factors = np.exp(np.clip(places * UNIT, LOW, HIGH)).tolist()
    try:
        moved = choice.made(column, dict(zip(NAMES, factors, strict=True)))
        whole = target.error(reached_force(moved, target.displacement)[0])
    except RbsdemError:
        whole = np.full(2000, 1.0)
    return whole[::EVERY] / math.sqrt(len(whole[::EVERY]))


def fit(task: tuple[int, np.ndarray, np.ndarray, int]) -> tuple[np.ndarray, np.ndarray]:
    """Fit a test along directions from a place; return where it ended, and the error."""
    number, directions, at, steps = task
    here, damping = error(number, directions @ at), 0.02
    for _ in range(steps):
        slopes = np.column_stack(
            [
                (error(number, directions @ (at + STEP * one)) - here) / STEP
                for one in np.eye(len(at))
            ]
        )
        normal, gradient = slopes.T @ slopes, slopes.T @ here
        for _ in range(5):
            size = np.diag(np.diag(normal) + 1e-5)
            step = -np.linalg.solve(normal + damping * size, gradient)
            step *= min(1.0, 2.0 / float(np.linalg.norm(step)))
            there = error(number, directions @ (at + step))
            if there @ there < here @ here:
                break
            damping = max(5 * damping, 1e-3)
        else:
            break
        gain = 1 - (there @ there) / (here @ here)
        at, here, damping = at + step, there, max(damping / 5, 1e-4)
        if gain < 2e-3:
            break
    return at, here


def slopes_of(task: tuple[int, np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Return the error of a test, and its slopes by all parameters."""
    number, places = task
    here, columns = error(number, places), []
    for i in range(len(places)):
        moved = places.copy()
        step = STEP if (places[i] + STEP) * UNIT[i] <= HIGH[i] else -STEP
        moved[i] += step
        columns.append((error(number, moved) - here) / step)
    return here, np.column_stack(columns)


def improved(
    directions: np.ndarray, at: np.ndarray, known: list[tuple[np.ndarray, np.ndarray]]
) -> tuple[np.ndarray, np.ndarray]:
    """Return directions and places for which the linear errors of all tests are least."""
    m, k = directions.shape
    normal, right, weight = [], [], []
    for (here, slopes), place in zip(known, at @ directions.T, strict=True):
        far = FAR * (here @ here) * np.eye(m)
        normal.append(slopes.T @ slopes + far)
        right.append(slopes.T @ (slopes @ place - here) + far @ place)
        weight.append(1 / (here @ here))
    at = at.copy()
    for _ in range(25):
        whole, sums = np.zeros((m * k, m * k)), np.zeros(m * k)
        for t, (a, b, w) in enumerate(zip(normal, right, weight, strict=True)):
            small = directions.T @ a @ directions + 1e-9 * np.eye(k)
            at[t] = np.linalg.solve(small, directions.T @ b)
            whole += w * np.kron(a, np.outer(at[t], at[t]))
            sums += w * np.kron(b, at[t])
        whole += 1e-6 * np.trace(whole) / len(whole) * np.eye(len(whole))
        found = np.linalg.solve(whole, sums).reshape(m, k)
        directions, sizes, turn = np.linalg.svd(found, full_matrices=False)
        at = at @ (np.diag(sizes) @ turn).T
    return directions, at


def start() -> np.ndarray:
    """Return the directions of six parameters, shape (parameters, 6)."""
    found = np.zeros((len(NAMES), len(START)))
    for k, name in enumerate(START):
        for one, way in TOGETHER.get(name, {name: 1}).items():
            found[NAMES.index(one), k] = way / UNIT[NAMES.index(one)]
    return found / np.linalg.norm(found, axis=0)


def exponents(directions: np.ndarray, at: np.ndarray) -> list[dict[str, float]]:
    """Return the exponents of each direction for a unit of one standard deviation."""
    sizes = directions * UNIT[:, None] * np.std(at, axis=0)
    order = np.argsort(-np.linalg.norm(sizes, axis=0))
    return [
        {
            name: round(float(size), 2)
            for name, size in zip(NAMES, sizes[:, k], strict=True)
            if abs(size) >= LEAST
        }
        for k in order
    ]


def write(found: list[dict[str, float]]) -> None:
    """Put the exponents into their table."""
    path = ROOT / "data/layered_directions.csv"
    kept = [line for line in path.read_text("utf-8").splitlines() if line.startswith("#")]
    rows = [["parameter", *(f"direction_{k}" for k in range(1, len(found) + 1))]]
    for name in NAMES:
        if any(name in one for one in found):
            rows.append([name, *(str(one.get(name, "")) for one in found)])
    text = "\n".join([*kept, *(",".join(row) for row in rows)]) + "\n"
    path.write_text(text, "utf-8")


def main() -> None:
    """Fit, find directions anew, print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("state", type=Path)
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--every", type=int, default=2)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--write", action="store_true")
    given = parser.parse_args()
    source = given.folder, slice(0, None, 2 * given.every)
    choice.begin(*source)
    tests = range(len(choice._cases))
    directions, at = start(), np.zeros((len(tests), len(START)))
    if given.state.exists():
        kept = np.load(given.state)
        directions = kept["directions"]
        at = kept["at"] if len(kept["at"]) == len(tests) else at
    began = time.perf_counter()
    best, found = np.inf, (directions, at)
    with ProcessPoolExecutor(given.jobs, initializer=choice.begin, initargs=source) as pool:
        for number in range(given.rounds):
            steps = 8 if not at.any() else 4
            fits = list(pool.map(fit, [(i, directions, at[i], steps) for i in tests]))
            at = np.array([place for place, _ in fits])
            sizes = [float(np.linalg.norm(row)) for _, row in fits]
            print(
                f"round {number + 1}: geometric mean {choice.score(sizes):.4f}, median "
                f"{np.median(sizes):.4f}, {time.perf_counter() - began:.0f} s",
                flush=True,
            )
            # The errors are not linear: a round may lose a little again.
            if choice.score(sizes) < best:
                best, found = choice.score(sizes), (directions, at)
                with given.state.open("wb") as file:
                    np.savez(file, directions=directions, at=at)
            if number < given.rounds - 1:
                tasks = [(i, directions @ at[i]) for i in tests]
                directions, at = improved(directions, at, list(pool.map(slopes_of, tasks)))
    table = exponents(*found)
    for number, one in enumerate(table, 1):
        order = sorted(one, key=lambda name: -abs(one[name]))
        print(f"direction_{number}: " + ", ".join(f"{name}^{one[name]:g}" for name in order))
    if given.write:
        write(table)


if __name__ == "__main__":
    main()
