"""Random frames of all rules: energy, the same numbers in parts of a path, no silent answer.

    python studies/random_frames.py [FRAMES] [SEED]

Frames of 1 to 6 storeys and 1 to 4 bays follow a cyclic path of five turning points. It prints what
the balance of energies lacks; how many have the turning points of the whole path, to the last bit,
where each of its ways is cut into 7 and into 1000 parts; and how the paths end. Then as many frames
of springs with a cap are pushed until they have lost their strength: a path goes to its end with
its energies in balance, or ends with a message that names the member and the spring.
"""

from __future__ import annotations

import re
import sys
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

import rbsdem
from rbsdem.frames import Frame

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))

from strategies import between
from strategies_frames import RULES, frame

#: No part of a way ends where an earlier turning point is passed: there springs stand on the ends
#: of their lines but for the round-off of the point that is given.
TURNS = np.array([1.0, -1.0, 1.53, -0.7, 2.0, 0.0])
#: Every so many frames are followed in 1000 parts: these take the time of a thousand paths.
SPARSE = 10


def followed(structure: Frame, path: Any, **more: Any) -> tuple[Any, str]:
    """Return the path as far as it goes, and why it ends there."""
    try:
        return rbsdem.cyclic(structure, displacement=path, **more), ""
    except rbsdem.SolveError as error:
        return error.result, str(error)


def parts_of(structure: Frame, path: Any, parts: int) -> Any:
    """Return a path with each of its ways in equal parts, from where the dead load has put it."""
    begin = followed(structure, path[:1], corners=True)[0].displacement[0]
    starts = np.concatenate([[begin], path[:-1]])
    return np.concatenate(
        [np.linspace(a, b, parts + 1)[1:] for a, b in zip(starts, path, strict=True)]
    )


def in_parts(structure: Frame, path: Any, whole: Any, parts: int) -> float:
    """Return the largest difference of the turning points over the largest force."""
    fine, _ = followed(structure, parts_of(structure, path, parts))
    rows = min(whole.force.size, fine.force.size // parts)
    if whole.summary["status"] != "completed":
        rows = min(rows, whole.force.size - 1)  # its last row is where it ends
    if not rows:
        return 0.0
    away = np.abs(fine.force[parts - 1 :: parts][:rows] - whole.force[:rows]).max()
    return float(away / np.abs(whole.force).max())


def reason(text: str) -> str:
    """Return a message without its numbers and names."""
    text = re.sub(r"\b[CB]-\d+-\d+\b", "M", re.split(r"; |\. ", text)[0])
    return re.sub(r"-?\d[\d.e+-]*", "#", text)[:110]


def cyclic(frames: int, rng: np.random.Generator) -> None:
    """Print energies, parts and ends of cyclic paths."""
    residuals, ends = [], Counter[str]()
    different: dict[int, list[tuple[int, float]]] = {7: [], 1000: []}
    for i in range(frames):
        structure = frame(rng)
        path = between(rng, 0.005, 0.04) * structure.height * TURNS
        whole, told = followed(structure, path)
        ends[reason(told) or "completed"] += 1
        residuals.append(whole.summary["relative_energy_residual"])
        for parts in different if i % SPARSE == 0 else (7,):
            if away := in_parts(structure, path, whole, parts):
                different[parts].append((i, away))
    print(f"{frames} frames, {len(RULES)} rules and sections that yield")
    worst = np.array(residuals)
    print(f"energy residual: median {np.median(worst):.1e}, largest {worst.max():.1e}")
    print(f"above 1e-10: {np.flatnonzero(worst > 1e-10).tolist()}")
    for parts, found in different.items():
        tried = frames if parts == 7 else -(-frames // SPARSE)
        print(f"{parts} parts: {tried - len(found)} of {tried} the same to the last bit")
        for i, away in found:
            print(f"    frame {i}: {away:.1e} of the largest force")
    for text, number in ends.most_common():
        print(f"{number:6d}  {text}")


def capped(frames: int, rng: np.random.Generator) -> None:
    """Print how frames of springs with a cap end; none does so silently."""
    ends, silent, unnamed, residual = Counter[str](), 0, 0, 0.0
    for _ in range(frames):
        structure = frame(rng, "capped")
        path = between(rng, 0.05, 0.2) * structure.height * np.arange(1, 21) / 20
        push, told = followed(structure, path, corners=True)
        ends[reason(told) or "completed"] += 1
        balance = push.summary["relative_energy_residual"] if push.time.size else 0.0
        residual = max(residual, balance)
        sound = np.isfinite(push.force).all() and np.isfinite(push.x).all() and balance < 1e-9
        silent += not told and not sound
        unnamed += bool(told) and not re.search(r"\b[CB]-\d+-\d+\b", told)
    print(f"\n{frames} frames of springs with a cap, pushed to drifts of 5 to 20 %")
    print(f"silent: {silent}; messages without a member: {unnamed}; energy residual {residual:.1e}")
    for text, number in ends.most_common():
        print(f"{number:6d}  {text}")


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 1000
    generator = np.random.default_rng(int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    cyclic(count, generator)
    capped(count, generator)
