"""Whether two builds give the same answers: random cases through both executables, row by row.

    python scripts/same_answers.py OTHER [cases] [--own EXECUTABLE]

OTHER is the executable of another version (build/.../src/app/rbsdem of an older commit). The cases
are columns of all rules, kinematics, methods and ends of `tests/python/strategies.py`, static paths
under a constant axial load and under one that varies, layered joints, motions, and the cases of
tests/regression. Prints how many give the same bytes, differ by round-off (1e-12 of the largest
number of their kind and unit), or by more, and names the latter.
"""

from __future__ import annotations

import argparse
import csv
import re
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "python"))
import strategies  # noqa: E402

import rbsdem  # noqa: E402
from rbsdem.__main__ import executable  # noqa: E402
from rbsdem.run.case import Case  # noqa: E402

#: Kinds of cases with their shares.
KINDS = {"static": 0.35, "layered": 0.15, "varying": 0.15, "time": 0.35}


def case(kind: str, seed: int) -> Case | None:
    """Return a case of a kind; None where the seed gives none."""
    rng = np.random.default_rng([sum(map(ord, kind)), seed])
    moves = kind == "time" or (kind == "layered" and seed % 3 == 0)
    fixed: dict[str, Any] = {}
    if kind == "layered" or (kind == "varying" and rng.random() < 0.6):
        fixed["flexure"] = ["layered"]
    column = strategies.any_column(rng, in_time=moves, **fixed)
    loads: dict[str, Any] = dict.fromkeys(
        ("displacement", "force", "ground_acceleration", "vertical_acceleration", "axial_load")
    )
    settings: dict[str, Any] = {"openings": True} if rng.random() < 0.3 else {}
    if moves:
        if (drawn := strategies.motion(rng, column)) is None:
            return None
        loads |= drawn[0]
        settings |= drawn[1]
        time = loads.pop("time")
        if rng.random() < 0.15 and strategies.may_vary(column, settings):
            loads["vertical_acceleration"] = 3 * strategies.waves(rng, len(time))
        if rng.random() < 0.3:
            settings["motion"] = True
    else:
        path = strategies.static_path(rng, column)
        loads |= path
        time = np.arange(1.0, len(next(iter(path.values()))) + 1)
        if kind == "varying":
            axial = column.axial_load or 1e5
            loads["axial_load"] = axial * (1 + 0.5 * strategies.waves(rng, len(time)))
    method = settings.pop("method", "static")
    return Case(title="", column=column, method=method, time=time, settings=settings, **loads)


def cases(count: int, folder: Path) -> Iterator[Path]:
    """Yield the files of the regression cases and of random ones."""
    yield from sorted((ROOT / "tests" / "regression").glob("*.nml"))
    for kind, share in KINDS.items():
        done = seed = 0
        while done < share * count:
            seed += 1
            try:
                with warnings.catch_warnings():
                    warnings.simplefilter("ignore")
                    made = case(kind, seed)
            except rbsdem.errors.RbsdemError:
                continue
            if made is None:
                continue
            done += 1
            path = folder / f"{kind}-{seed}.nml"
            path.write_text(made.to_namelist())
            yield path


def run(program: str, path: Path) -> tuple[int, str]:
    """Return the exit code of a case and its rows as text."""
    done = subprocess.run(
        [program, "run", path, "-q", "-o", "-"],
        capture_output=True,
        text=True,
        timeout=600,
        cwd=path.parent,
        check=False,
    )
    return done.returncode, done.stdout


def difference(one: str, two: str) -> float:
    """Return the largest difference of two tables over the largest number of its kind and unit."""
    tables = [
        list(csv.reader(line for line in text.splitlines() if not line.startswith("#")))
        for text in (one, two)
    ]
    if [len(table) for table in tables].count(len(tables[0])) < 2 or not tables[0]:
        return np.inf
    if tables[0][0] != tables[1][0]:
        return np.inf
    names = ["J" if n.endswith("_J") else re.sub(r"_\d+_", "_", n) for n in tables[0][0]]
    first, second = (np.array(table[1:], float) for table in tables)
    worst = 0.0
    for name in set(names):
        at = [i for i, other in enumerate(names) if other == name]
        largest = np.abs(first[:, at]).max(initial=0) or 1.0
        worst = max(worst, float(np.abs(first[:, at] - second[:, at]).max(initial=0) / largest))
    return worst


def main() -> None:
    """Compare two executables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("other")
    parser.add_argument("cases", nargs="?", type=int, default=1000)
    parser.add_argument("--own", default=str(executable()))
    given = parser.parse_args()
    found: Counter[tuple[str, str]] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        for path in cases(given.cases, Path(folder)):
            (code, rows), (other_code, other_rows) = run(given.own, path), run(given.other, path)
            kind = path.stem.split("-")[0] if path.parent == Path(folder) else "regression"
            if code != other_code:
                print(f"{path.stem}: exit code {code} in place of {other_code}")
                found[kind, "other end"] += 1
            elif rows == other_rows:
                found[kind, "same bytes"] += 1
            else:
                worst = difference(other_rows, rows)
                found[kind, "round-off" if worst <= 1e-12 else "more"] += 1
                if worst > 1e-12:
                    print(f"{path.stem}: {worst:.1e}")
    for (kind, what), number in sorted(found.items()):
        print(f"{kind:12} {what:12} {number}")


if __name__ == "__main__":
    main()
