"""Random frames of all rules: relations that hold for any of them, and how push-overs end.

    python studies/random_frames.py [--cases N] [--seed S] [--kind KIND ...] [--seconds T]

KIND is a relation of `tests/python/test_invariants_frames.py` or a set of work:

- `paths`: cycles in another order of nodes and members, in a mirror, with targets larger by a last
  bit, and in units of powers of two;
- `buildings`: cycles of drawn buildings in another order, in a mirror and with such targets;
- `records`: undamped records, of which the energy that snaps of springs put in is compared;
- `relations`: all relations;
- `pushes`: push-overs to a drift of 5 %, which get there or end with a message that names a member;
- `leaps`: pushes to a drift of 3 % and cycles to 1 and 2 % by `method="newton"`, whose errors and
  times are compared with those of paths from event to event;
- `doors`: cycles of drawn frames and buildings with walls, infills and laps, by hand, by a case
  file, saved and read again, and cut and resumed: each has the same bits;
- `kernels`: rows of cycles, for another kernel of OpenBLAS: run it with `--write FILE`, then with
  another value of OPENBLAS_CORETYPE and `--against FILE`.

It prints how many cases differ by more than the bar of their relation, with their numbers: `--kind
RELATION --case NUMBER` runs one of them. A case that takes more than T seconds is named.
"""

from __future__ import annotations

import argparse
import json
import os
import pickle
import re
import resource
import signal
import sys
import tempfile
import time
import warnings
import zlib
from collections import Counter
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "python"))

SETS = {
    "paths": (
        "test_names_order_and_place", "test_mirror", "test_last_bit_of_targets",
        "test_powers_of_two",
    ),
    "buildings": ("test_buildings_go_one_way",),
    "records": ("test_snaps_set_energy_free",),
    "relations": (),
    "pushes": (),
    "leaps": (),
    "doors": (),
    "kernels": (),
}  # fmt: skip


def arguments() -> argparse.Namespace:
    """Return what the command line asks for."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n", 1)[0])
    parser.add_argument("--cases", type=int, default=100, metavar="N")
    parser.add_argument("--seed", type=int, default=0, metavar="S")
    parser.add_argument("--kind", nargs="+", default=["relations", "pushes"], metavar="KIND")
    parser.add_argument("--case", type=int, metavar="NUMBER")
    parser.add_argument("--seconds", type=int, default=20, metavar="T")
    parser.add_argument("--write", type=Path, metavar="FILE")
    parser.add_argument("--against", type=Path, metavar="FILE")
    return parser.parse_args()


ASKED = arguments()
os.environ |= {"RBSDEM_SEED": str(ASKED.seed), "RBSDEM_STOREYS": "6"}

import test_invariants_frames  # noqa: E402, F401
from relations import RELATIONS, Discard, ended, replay  # noqa: E402
from strategies_frames import FAMILIES, building, drifts, frame, house, plan  # noqa: E402

import rbsdem  # noqa: E402


class Late(Exception):  # noqa: N818
    """A case takes longer than it may."""


def capped(judge: Callable[[int], Any], case: int) -> Any:
    """Return what a case comes to in a process of its own, which has so much processor time."""
    reading, writing = os.pipe()
    child = os.fork()
    if not child:
        resource.setrlimit(resource.RLIMIT_CPU, (ASKED.seconds, ASKED.seconds + 1))
        try:
            answer = judge(case)
        except Discard as nothing:
            answer = nothing
        except Exception as error:  # with the number of the case
            answer = f"{type(error).__name__}: {error}"
        with os.fdopen(writing, "wb") as pipe:
            pickle.dump(answer, pipe)
        os._exit(0)
    os.close(writing)
    with os.fdopen(reading, "rb") as pipe:
        told = pipe.read()
    end = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    if end == -signal.SIGXCPU:
        raise Late
    answer = pickle.loads(told) if told else f"the process ended with {end}"
    if isinstance(answer, Discard):
        raise answer
    return answer


def tried(name: str, cases: range) -> None:
    """Print what the cases of a relation come to."""
    bar, distances, faults, late = RELATIONS[name].bar, [], [], []
    for case in cases:
        try:
            distance = capped(lambda case: replay(name, case) or 0.0, case)
        except Discard:
            continue
        except Late:
            late.append(case)
            continue
        if isinstance(distance, float):
            distances.append(distance)
        if not (isinstance(distance, float) and distance <= bar):
            faults.append(f"case {case}: {distance}")
    far = np.array(distances or [np.nan])
    print(
        f"{name.removeprefix('test_'):48}{len(cases):7} cases, {len(distances)} judged   "
        f"median {np.median(far):.0e}   largest {far.max():.0e}   bar {bar:.0e}   "
        f"above {len(faults)}   beyond {ASKED.seconds} s {len(late)}: {late}"
    )
    for fault in faults[:50]:
        print("    ", fault[:200].replace("\n", " "), flush=True)


def random_of(family: str, case: int) -> np.random.Generator:
    """Return the numbers that a case of a family draws."""
    return np.random.default_rng((zlib.crc32(family.encode()), ASKED.seed, case))


def pushed(family: str, cases: range) -> None:
    """Print how push-overs of a family end; none does so silently, or without naming a member."""

    def push(case: int) -> str:
        try:
            run = rbsdem.pushover(frame(random_of(family, case), family), drift=0.05)
        except rbsdem.SolveError as error:
            return f"raised: {error}"
        told = {"completed": "", "ended": run.summary["reason"]}.get(run.summary["status"])
        if told is None:
            return str(run.summary["status"])
        sound = np.isfinite(run.force).all() and run.summary["relative_energy_residual"] < 1e-9
        unnamed = told and not re.search(r"\b[CB]-\d+-\d+\b", told)
        text = re.sub(r"\b[CBN]-\d+-\d+\b", "M", re.split(r"; |\. ", told.split(": ", 1)[-1])[0])
        text = re.sub(r"-?\d[\d.e+-]*", "#", text or "completed")[:110]
        return text + ", silent" * (not (told or sound)) + ", without a member" * bool(unnamed)

    ends: dict[str, list[int]] = {}
    for case in cases:
        try:
            ends.setdefault(capped(push, case), []).append(case)
        except Late:
            ends.setdefault(f"beyond {ASKED.seconds} s", []).append(case)
    print(f"{len(cases)} push-overs of springs of family '{family}' to a drift of 5 %")
    for text, which in sorted(ends.items(), key=lambda item: -len(item[1])):
        few = which[:5] if len(which) < len(cases) / 4 else ""
        print(f"{len(which):6d}  {text}  {few}", flush=True)


def leapt(family: str, cases: range, points: int, *, cycles: bool) -> None:
    """Print errors by leaps, of forces and of rotations of joints over their peaks, and times."""
    drawings: dict[str, Callable[[np.random.Generator], Any]] = {
        "buildings": building,
        "plans": plan,
    }
    make = drawings.get(family, lambda rng: frame(rng, family))
    to = np.arange(1, points + 1) / points * 0.03
    if cycles:
        turns = np.array([0.0, 0.01, -0.01, 0.02]) * points
        to = np.interp(
            np.arange(1, points + 1),
            np.cumsum(np.abs(np.diff(turns, prepend=0.0))) / 0.06,
            turns / points,
        )

    def compare(case: int) -> tuple[float, float, float, float, bool]:
        made, paths, times = make(random_of(family, case)), [], []
        rbsdem.cyclic(made, displacement=[made.height * 1e-5])  # it is made
        for method in ("static", "newton"):
            run = partial(rbsdem.cyclic, made, displacement=made.height * to, method=method)
            begun = time.process_time()
            paths.append(ended(run))
            times.append(time.process_time() - begun)
        exact, leaps = (path.channels for path in paths)
        n = min(len(exact["force"]), len(leaps["force"]))
        if not n:
            raise Discard
        apart = [
            np.abs(exact[name][:n] - leaps[name][:n]).max() / np.abs(exact[name]).max()
            for name in ("force", "rotation" if "rotation" in exact else "force")
        ]
        return *apart, *times, len(exact["force"]) != len(leaps["force"])

    found, late = [], 0
    for case in cases:
        try:
            one = capped(compare, case)
            if isinstance(one, str):
                print(f"      case {case}: {one[:200]}")
            else:
                found.append(one)
        except Discard:
            continue
        except Late:
            late += 1
    force, rotation, by_events, by_leaps, unlike = np.array(found).T
    print(
        f"{family:10} {points:4} points, {'cycles' if cycles else 'push'}: {len(found)} judged, "
        f"force {np.median(force):.0e} in the median, {np.quantile(force, 0.95):.0e} in 95 %, "
        f"{force.max():.0e} at most, rotations {rotation.max():.0e}; "
        f"above 1e-3 {(force > 1e-3).sum()}; time {by_leaps.sum() / by_events.sum():.2f}; "
        f"other ends {unlike.sum():.0f}, late {late}",
        flush=True,
    )


def through_doors(cases: range) -> None:
    """Print which drawn frames and buildings have other rows by another way to the same path."""

    def unlike(run: Any, other: Any, at: int = 0) -> list[str]:
        """Return the channels of which rows from `at` on are not those of another run."""
        names = [name for name in run.channels if name != "step"]
        if run.summary["status"] != "completed":
            names = []  # of such a path the last row is that of its end
        return [n for n in names if not np.array_equal(run.channels[n][at:], other.channels[n])]

    def judge(case: int) -> str:
        rng = random_of("doors", case)
        try:
            made = house(rng)
            path = drifts(rng, made, 0.015)
        except (rbsdem.InputError, rbsdem.SolveError):
            raise Discard from None
        at, method = int(rng.integers(1, path.size)), str(rng.choice(["static", "newton"]))
        follow = partial(rbsdem.cyclic, made, method=method)
        run = ended(lambda: follow(displacement=path))
        values = ", ".join(map(repr, path.tolist()))
        analysis = f"&analysis method = '{method}' /\n"
        loading = f"&loading drive = 'displacement', values = {values} /\n"
        with tempfile.TemporaryDirectory() as folder:
            text, saved = Path(folder) / "case.nml", Path(folder) / "run.npz"
            text.write_text(made.to_namelist() + analysis + loading)
            read = rbsdem.read_case(text)
            found = {"by a case file": unlike(run, ended(read.run))}
            run.save(saved)
            found["read again"] = unlike(run, rbsdem.read_result(saved))
        if read.column != made:
            return "its case file is of another structure"
        first = ended(lambda: follow(displacement=path[:at]))
        if "completed" == first.summary["status"] == run.summary["status"]:
            rest = ended(lambda: follow(displacement=path[at:], initial=first))
            found[f"cut at {at} ({method})"] = unlike(run, rest, at)
        return "; ".join(f"{way}: {names}" for way, names in found.items() if names)

    judged = 0
    for case in cases:
        try:
            fault = capped(judge, case)
        except (Discard, Late):
            continue
        judged += 1
        if fault:
            print(f"      case {case}: {fault[:300]}", flush=True)
    print(f"{judged} of {len(cases)} drawn frames and buildings through all doors", flush=True)


def rows(family: str, cases: range) -> list[list[float] | str]:
    """Return the forces of cyclic paths in shares of the largest, or how a case failed."""

    def cycle(case: int) -> list[float]:
        rng = random_of(family, case)
        made = building(rng) if family == "buildings" else frame(rng, family)
        run = ended(lambda: rbsdem.cyclic(made, displacement=drifts(rng, made)))
        return [float(value) for value in run.force / np.abs(run.force).max(initial=1.0)]

    values: list[list[float] | str] = []
    for case in cases:
        try:
            values.append(capped(cycle, case))
        except (Late, Discard) as error:
            values.append(type(error).__name__)
    return values


def compared(values: dict[str, Any], other: dict[str, Any]) -> None:
    """Print how many paths depend on the kernel of OpenBLAS."""
    for family, paths in values.items():
        unlike = Counter[str]()
        for case, (path, again) in enumerate(zip(paths, other[family], strict=True)):
            if isinstance(path, str) or isinstance(again, str):
                unlike["beyond their time or discarded"] += 1
            elif len(path) != len(again) or np.abs(np.subtract(path, again)).max(initial=0) > 1e-6:
                unlike[f"case {case}"] += 1
        print(f"{len(paths)} cycles of family '{family}', unlike: {dict(unlike)}", flush=True)


def main() -> None:
    """Do the work asked for."""
    warnings.simplefilter("ignore")
    cases = range(ASKED.cases) if ASKED.case is None else range(ASKED.case, ASKED.case + 1)
    for kind in ASKED.kind:
        if kind == "pushes":
            for family in FAMILIES:
                pushed(family, cases)
        elif kind == "leaps":
            for family in (*FAMILIES, "buildings", "plans"):
                leapt(family, cases, 100, cycles=False)
                leapt(family, cases, 100, cycles=True)
            for points in (25, 50, 200, 400):
                leapt("buildings", cases, points, cycles=False)
        elif kind == "doors":
            through_doors(cases)
        elif kind == "kernels":
            values = {family: rows(family, cases) for family in (*FAMILIES, "buildings")}
            if ASKED.write:
                ASKED.write.write_text(json.dumps(values))
            if ASKED.against:
                compared(values, json.loads(ASKED.against.read_text()))
        else:
            names = (RELATIONS if kind == "relations" else SETS.get(kind)) or (kind,)
            for name in names:
                tried(name, cases)


if __name__ == "__main__":
    main()
