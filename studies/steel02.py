"""The rule `steel` against Steel02 of OpenSees: the table of docs/rules.md.

    pip install openseespy
    python studies/steel02.py

Both with b = 0.01, R0 = 20, cR1 = 0.925, cR2 = 0.15 and without isotropic hardening. Differences
are over the yield force, deformations over the yield deformation.
"""

from __future__ import annotations

import numpy as np
import openseespy.opensees as ops
from numpy.typing import NDArray

from rbsdem.springs import SteelSpring

Array = NDArray[np.float64]

B, R0, CR1, CR2 = 0.01, 20.0, 0.925, 0.15
AMPLITUDES = (2.5, 5.0, 10.0, 20.0)
# Points in a unit of deformation.
FINENESS = 100


def along(turns: list[float]) -> Array:
    """Return a path through turns, from zero, in small steps."""
    legs, here = [], 0.0
    for turn in turns:
        steps = max(2, round(FINENESS * abs(turn - here)))
        legs.append(np.linspace(here, turn, steps + 1)[1:])
        here = turn
    return np.concatenate(legs)


def cycles(amplitude: float, low: float | None = None) -> list[float]:
    """Return three cycles."""
    return [amplitude, -amplitude if low is None else low] * 3


def partial(amplitude: float) -> list[float]:
    """Return a cycle with loops of a quarter of its width on the way, up and down."""
    part = amplitude / 2
    up = [-part, -2 * part, 0.0, -part, part, 0.0, 2 * part]
    return [amplitude, -amplitude, *up, *(-turn for turn in up)]


PATHS = {
    **{f"three cycles at {a:g}": cycles(a) for a in AMPLITUDES},
    "growing, three each": [turn for a in AMPLITUDES for turn in cycles(a)],
    "shrinking, three each": [turn for a in reversed(AMPLITUDES) for turn in cycles(a)],
    "one-sided, 0 to 10, three": cycles(10.0, 0.0),
    "partial loops within 5": partial(5.0),
    "partial loops within 10": partial(10.0),
    "unloading by 0.1, five times": [
        -10.0,
        *(x for d in (0, 2, 4, 6, 8) for x in (d, d - 0.1)),
        10,
    ],
}


def steel02(path: Array) -> Array:
    """Return the forces of Steel02 along a path."""
    ops.wipe()
    ops.uniaxialMaterial("Steel02", 1, 1.0, 1.0, B, R0, CR1, CR2)
    ops.testUniaxialMaterial(1)
    forces = []
    for d in path.tolist():
        ops.setStrain(d)
        forces.append(ops.getStress())
    return np.array(forces)


def ours(path: Array) -> Array:
    """Return the forces of `SteelSpring`."""
    return SteelSpring(1.0, 1.0, B, R0, CR1, CR2).response(path)


def largest_change(response, histories: int, size: float) -> float:
    """Return the largest change of a later force by a detour, over its size."""
    rng, largest = np.random.default_rng(1), 0.0
    for _ in range(histories):
        turns = (rng.uniform(-10, 10, 8) * 10 ** rng.uniform(-1, 0, 8)).tolist()
        place = int(rng.integers(1, 7))
        at = turns[place] + size * rng.choice([-1, 1])
        path = along(turns)
        first = along(turns[: place + 1]).size
        detour = np.concatenate([path[:first], [at], path[first - 1 :]])
        change = response(detour)[first + 1 :] - response(path)[first - 1 :]
        largest = max(largest, float(np.max(np.abs(change))) / size)
    return largest


def main() -> None:
    """Print the tables."""
    print("| path | rms of the difference | largest |")
    print("| --- | ---: | ---: |")
    for name, turns in PATHS.items():
        path = along(turns)
        gap = ours(path) - steel02(path)
        print(f"| {name} | {np.sqrt(np.mean(gap**2)):.3f} | {np.max(np.abs(gap)):.3f} |")
    rng, rows = np.random.default_rng(1), []
    for _ in range(100):
        path = along(rng.uniform(-10, 10, 10).tolist())
        gap = ours(path) - steel02(path)
        rows.append((float(np.sqrt(np.mean(gap**2))), float(np.max(np.abs(gap)))))
    rms, most = np.array(rows).T
    print(
        f"| 100 random paths: mean; worst | {rms.mean():.3f}; {rms.max():.3f} | {most.max():.3f} |"
    )
    print("\n| detour of length e | largest change of a later force over k e: `steel` | Steel02 |")
    print("| --- | ---: | ---: |")
    for size in (1e-3, 1e-6):
        changes = [largest_change(law, 200, size) for law in (ours, steel02)]
        print(f"| {size:.0e} | {changes[0]:.1f} | {changes[1]:.1e} |")


if __name__ == "__main__":
    main()
