"""Random frames of all rules: relations that hold for any of them, and how push-overs end.

    python studies/random_frames.py [CASES] [SEED] [RELATION ...]

Each relation of `tests/python/test_invariants_frames.py` is tried in CASES cases (by default
10 000). It prints how many of them say something, the median and the largest distance, the bar,
and the cases above it. Then CASES/20 frames of each family of springs
are pushed to a drift of 5 %: they get there, or end with a message that names the member. Where the
LAPACK is OpenBLAS, as many are cycled with each of three kernels, whose sums have other round-off:
`python studies/random_frames.py CASES SEED kernels` does that alone.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))
CASES = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
os.environ["RBSDEM_SEED"] = sys.argv[2] if len(sys.argv) > 2 else "0"

import test_invariants_frames  # noqa: E402, F401
from relations import RELATIONS, SEED, Outcome, ended  # noqa: E402
from strategies_frames import FAMILIES, drifts, frame  # noqa: E402

import rbsdem  # noqa: E402


def tried(name: str, cases: int) -> None:
    """Print what the cases of a relation come to."""
    found = Outcome(RELATIONS[name].judge, RELATIONS[name].bar)
    for case in range(cases):
        found.take(case)
    far = np.array(found.distances or [np.nan])
    print(
        f"{name.removeprefix('test_'):55}{far.size:7} of {cases}   median {np.median(far):.0e}   "
        f"largest {far.max():.0e}   bar {found.bar:.0e}   above {len(found.faults)}"
    )
    for fault in found.faults[:20]:
        print("    ", fault[:200].replace("\n", " "), flush=True)


def pushed(family: str, frames: int) -> None:
    """Print how push-overs of a family end; none does so silently, or without naming a member."""
    rng = np.random.default_rng((SEED, list(FAMILIES).index(family)))
    ends = Counter[str]()
    for _ in range(frames):
        run = rbsdem.pushover(frame(rng, family), drift=0.05)
        told = "" if run.summary["status"] == "completed" else run.summary["reason"]
        sound = np.isfinite(run.force).all() and run.summary["relative_energy_residual"] < 1e-9
        unnamed = told and not re.search(r"\b[CB]-\d+-\d+\b", told)
        text = re.sub(r"\b[CBN]-\d+-\d+\b", "M", re.split(r"; |\. ", told.split(": ", 1)[-1])[0])
        text = text or "completed"
        text = re.sub(r"-?\d[\d.e+-]*", "#", text)[:110]
        silent = not (told or sound)
        ends[text + ", silent" * silent + ", without a member" * bool(unnamed)] += 1
    print(f"\n{frames} push-overs of springs of family '{family}' to a drift of 5 %")
    for text, number in ends.most_common():
        print(f"{number:6d}  {text}")


KERNELS = ("Prescott", "Haswell", "SkylakeX")


def cycled(family: str, frames: int) -> None:
    """Print the forces of cyclic paths in shares of the largest: a line for each frame."""
    rng = np.random.default_rng((SEED, list(FAMILIES).index(family)))
    for _ in range(frames):
        made = frame(rng, family)
        run = ended(lambda made=made: rbsdem.cyclic(made, displacement=drifts(rng, made)))
        size = np.abs(run.force).max(initial=1.0)
        print(*(f"{value:.6f}" for value in run.force / size + 0.0))


def kernels(frames: int) -> None:
    """Print how many paths depend on the kernel of OpenBLAS that the processor has."""
    for family in FAMILIES:
        answers = []
        for kernel in KERNELS:
            words = (sys.executable, __file__, str(frames), str(SEED), "cycled", family)
            told = subprocess.run(
                words, env=os.environ | {"OPENBLAS_CORETYPE": kernel}, capture_output=True,
                text=True, check=True,
            )  # fmt: skip
            answers.append(told.stdout.splitlines())
        rows = [
            [np.array(line.split(), float) for line in paths]
            for paths in zip(*answers, strict=True)
        ]
        unlike = sum(
            len({one.size for one in paths}) > 1 or np.ptp(np.array(paths), axis=0).max() > 3e-6
            for paths in rows
        )
        print(f"{frames} cycles of family '{family}': {unlike} depend on the kernel", flush=True)


if __name__ == "__main__" and sys.argv[3:4] == ["cycled"]:
    warnings.simplefilter("ignore")
    cycled(sys.argv[4], CASES)
elif __name__ == "__main__" and sys.argv[3:] == ["kernels"]:
    kernels(CASES)
elif __name__ == "__main__":
    warnings.simplefilter("ignore")
    for relation in sys.argv[3:] or RELATIONS:
        tried(relation, CASES)
    for springs in FAMILIES if not sys.argv[3:] else ():
        pushed(springs, max(CASES // 20, 1))
    if not sys.argv[3:]:
        kernels(max(CASES // 20, 1))
